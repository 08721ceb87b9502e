/* Partial sums of forces from contacts to particles (and from elements to nodes). A block of
 * contacts sums its forces in rows of its own, one for each particle that it touches; a particle
 * then adds up its rows in block order. Blocks follow the order of the contacts and not the
 * threads, so that sums are the same for any number of threads, and a block's rows stay in the
 * cache of the core that processes it. */
#ifndef GN_KERNELS_PARTIALS_H
#define GN_KERNELS_PARTIALS_H

#include <stddef.h>
#include <stdint.h>

/* Contacts are processed in blocks of at most this many (shorter in short lists). Sums (forces,
 * energies, broken bonds) are kept per block and merged in block order, so that they do not depend
 * on the number of threads. */
enum { GN_CONTACT_BLOCK = 1024, GN_CONTACT_BLOCK_LEAST = 64 };

/* Particles are processed in blocks of this many. */
enum { GN_PARTICLE_BLOCK = 128 };

/* A particle's row in some block. */
typedef struct gn_share {
    int32_t particle, row;
} gn_share;

/* Partial sums of a list of contacts, or of finite elements, whose nodes are its particles. Rows
 * are force xyz, 0, moment xyz, 0 (width 8: rotation in space) or force xyz, 0 (width 4); in 2D
 * force xy, moment z, 0. */
typedef struct gn_partials {
    int width;
    size_t blocks, length; /* contacts per block, a multiple of GN_LANES_MAX */
    int32_t *first;        /* [blocks + 1] first row of a block */
    /* [first[blocks] + GN_LANES_MAX] particle of each row, in the order in which the block first
     * refers to them */
    int32_t *particle;
    /* [contacts][2] starts of the rows of a contact's two particles, in numbers from the block's
     * first row; for elements [elements][nodes of an element] */
    uint16_t *place;
    double *row;         /* [first[blocks]][width]; NULL for contacts in mixed precision */
    float *row_f;        /* rows in mixed precision; NULL otherwise */
    int32_t *start;      /* [particle blocks + 1] first share of a block of particles */
    gn_share *share;     /* [first[blocks]] sorted by particle, then row */
    int32_t *touched[2]; /* [particle blocks] first and last block with a row for one of its
                            particles; INT32_MAX and -1: none */
} gn_partials;

static inline size_t gn_partials_row_bytes(const gn_partials *partials) {
    const gn_partials *q = partials;
    return (size_t)q->width * (q->row_f ? sizeof *q->row_f : sizeof *q->row);
}

#endif
