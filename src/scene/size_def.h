/* Distributions of radii. */
#ifndef GN_SCENE_SIZE_DEF_H
#define GN_SCENE_SIZE_DEF_H

typedef enum gn_pack_sizes {
    GN_SIZES_FITTED,  /* packings only: determined by the fit, log-normal at the start */
    GN_SIZES_UNIFORM, /* distribution by number, uniform between smallest and largest */
    GN_SIZES_NORMAL,  /* distribution by number, normal, truncated at smallest and largest */
    GN_SIZES_SIEVE    /* distribution by a curve of the mass fractions that pass */
} gn_pack_sizes;

#endif
