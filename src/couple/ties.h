/* Positions of the particles of coupling zones in the elements, found once from the initial
 * positions, and sums over them in an order that does not depend on the number of threads. */
#ifndef GN_COUPLE_TIES_H
#define GN_COUPLE_TIES_H

#include "fem/fem.h"

/* A particle in an element, with the shape functions at its initial position. */
typedef struct gn_tie {
    int32_t id;      /* id of the particle */
    int32_t element; /* index in the solid */
    int32_t node[4]; /* indices of its nodes in the solid */
    int32_t own[4];  /* index of each node among the nodes of ties */
    double shape[4];
} gn_tie;

/* An entry in the list of a node: a tie, and the corner of the tie at the node. */
typedef struct gn_tie_share {
    int32_t tie, corner;
} gn_tie_share;

typedef struct gn_ties {
    int corners;
    size_t count;
    gn_tie *tie;         /* [count] by id, ascending */
    size_t nodes;        /* number of nodes with at least one tie */
    int32_t *node;       /* [nodes] ascending */
    int32_t *first;      /* [nodes + 1] index into share */
    gn_tie_share *share; /* [nodes' entries] ties of each node, ascending */
} gn_ties;

/* Finds the particles that are initially in an element, boundaries included. */
gneiss_status gn_ties_find(const gn_fem_solid *solid, const gn_particles *particles, gn_ties *ties,
                           gneiss_error *error);
/* Returns a tie, without a particle, for a position in an element. */
gn_tie gn_tie_at(const gn_fem_solid *solid, int32_t element, const double *place);

/* Creates ties for particles whose element is given: `element` [particles] is the place of the
 * element in the record; -1: none. */
gneiss_status gn_ties_take(const gn_fem_solid *solid, const gn_particles *particles,
                           const int32_t *element, gn_ties *ties, gneiss_error *error);
void gn_ties_free(gn_ties *ties);

/* Computes the gradients of the shape functions of a tie's element at the present node positions,
 * 1/m. */
void gn_tie_gradients(const gn_ties *ties, size_t k, const gn_particles *nodes,
                      double gradient[4][3]);

/* Interpolates the first three components of rows [nodes][4] at a tie. */
static inline void gn_tie_mean(const gn_ties *ties, size_t k, const double *rows, double out[3]) {
    const gn_tie *t = &ties->tie[k];
    out[0] = out[1] = out[2] = 0.0;
    for (int a = 0; a < ties->corners; a++)
        for (int c = 0; c < 3; c++)
            out[c] += t->shape[a] * rows[4 * (size_t)t->node[a] + (size_t)c];
}

/* Interpolates the displacements from the start at a tie. */
static inline void gn_tie_travel(const gn_ties *ties, size_t k, const gn_particles *nodes,
                                 double out[3]) {
    const gn_tie *t = &ties->tie[k];
    out[0] = out[1] = out[2] = 0.0;
    for (int a = 0; a < ties->corners; a++)
        for (int c = 0; c < 3; c++) {
            size_t at = 4 * (size_t)t->node[a] + (size_t)c;
            out[c] += t->shape[a] * (nodes->pos[at] - nodes->start[at]);
        }
}

#endif
