/* How radii are to be distributed. */
#ifndef GN_SCENE_SIZE_DEF_H
#define GN_SCENE_SIZE_DEF_H

typedef enum gn_pack_sizes {
    GN_SIZES_FITTED,  /* of packings alone: whatever fits best, log-normal at the start */
    GN_SIZES_UNIFORM, /* by number, between the smallest and the largest */
    GN_SIZES_NORMAL,  /* by number, cut there */
    GN_SIZES_SIEVE    /* by a curve of shares of the mass that pass */
} gn_pack_sizes;

#endif
