/* Where the particles of zones are in the elements, found once from the places at the start, and
 * sums over them in an order that no number of threads changes. */
#ifndef GN_COUPLE_TIES_H
#define GN_COUPLE_TIES_H

#include "fem/solid.h"

/* A particle in an element: shape functions at its place at the start. */
typedef struct gn_tie {
    int32_t id;      /* of the particle */
    int32_t element; /* place in the solid */
    int32_t node[4]; /* places in the solid */
    int32_t own[4];  /* the same among the nodes of ties */
    double shape[4];
} gn_tie;

/* What a node has of a tie. */
typedef struct gn_tie_share {
    int32_t tie, corner;
} gn_tie_share;

typedef struct gn_ties {
    int corners;
    size_t count;
    gn_tie *tie;         /* [count] by id, ascending */
    size_t nodes;        /* that have a share in any */
    int32_t *node;       /* [nodes] ascending */
    int32_t *first;      /* [nodes + 1] into share */
    gn_tie_share *share; /* ties ascending for each node */
} gn_ties;

/* Of the particles whose places at the start are in an element, boundaries included. */
gneiss_status gn_ties_find(const gn_fem_solid *solid, const gn_particles *q, gn_ties *t,
                           gneiss_error *error);
/* A place in an element, as a tie without particle. */
gn_tie gn_tie_at(const gn_fem_solid *solid, int32_t element, const double *place);

/* Of the particles that are in the element [particles] given for them, by place; -1: of none. */
gneiss_status gn_ties_take(const gn_fem_solid *solid, const gn_particles *q, const int32_t *element,
                           gn_ties *t, gneiss_error *error);
void gn_ties_free(gn_ties *ties);

/* Gradients of the shape functions of a tie's element at the present places of its nodes, 1/m. */
void gn_tie_gradients(const gn_ties *ties, size_t k, const gn_particles *nodes,
                      double gradient[4][3]);

/* The mean of rows [nodes][4] at a tie, the first three components. */
static inline void gn_tie_mean(const gn_ties *ties, size_t k, const double *rows, double out[3]) {
    const gn_tie *t = &ties->tie[k];
    out[0] = out[1] = out[2] = 0.0;
    for (int a = 0; a < ties->corners; a++)
        for (int c = 0; c < 3; c++)
            out[c] += t->shape[a] * rows[4 * (size_t)t->node[a] + (size_t)c];
}

/* The same of displacements from the start. */
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
