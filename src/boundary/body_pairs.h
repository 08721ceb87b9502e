/* Contacts between convex rigid bodies. Two bodies have one contact: its overlap is the mean depth
 * h of their common volume (surfaces/convex.h), its spring has the potential k h^2/2 and pushes
 * along the gradient of h. Spring, dashpot and crossings are those of the linear law along h, with
 * the inverse mass along the gradient; friction acts at the point through which the line of the
 * normal force passes. */
#ifndef GN_BOUNDARY_BODY_PAIRS_H
#define GN_BOUNDARY_BODY_PAIRS_H

#include "frame/parts.h"

#include "base/error.h"
#include "kernels/contact.h"
#include "surfaces/convex.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A listed pair; all members are doubles, as in checkpoints. Forces and moments are those of the
 * last step on the first body. */
typedef struct gn_body_pair {
    double first, second;      /* indices of the bodies, the smaller one first */
    double depth;              /* m, depth h; 0: the bodies are apart */
    double along[3], about[3]; /* gradients of h, see gn_convex_overlap */
    double point[3];   /* m, point of the force relative to the first body's reference point */
    double viscous;    /* N, force of the dashpot along h */
    double shear[3];   /* N */
    double rocking[3]; /* N m, moment of the dashpot against rocking */
    double twisting, twisting_spring; /* N m about the normal, N m/rad */
} gn_body_pair;

/* The largest value over all pairs of bodies, and these two bodies; 0: none. All members are
 * doubles. */
typedef struct gn_bodies_worst {
    double value, first, second;
} gn_bodies_worst;

typedef struct gn_body_pairs {
    size_t bodies;
    gn_convex *convex; /* [bodies]; NULL: no two bodies can touch each other */
    gn_convex_room room;
    size_t count, most;
    gn_body_pair *pair; /* listed pairs, sorted by (first, second) */
    gn_contact_sums sums;
    gn_bodies_worst
        deepest; /* largest ratio so far of h to the smaller thickness of both along the push */
    gn_bodies_worst pushed; /* N, largest force at the start beyond that of bodies at rest */
} gn_body_pairs;

/* Computes the properties of the shapes that contacts require, once at the start. */
gneiss_status gn_body_pairs_prepare(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error);
void gn_body_pairs_free(gn_body_pairs *pairs);
/* Checks that no centre of mass is in another body. */
gneiss_status gn_body_pairs_check(const gn_step_context *ctx, const gn_boundary *boundary,
                                  gneiss_error *error);
/* gn_bodies_meet tells whether two bodies can come into contact; the second function tells whether
 * a body has no contacts because of its shape. */
bool gn_bodies_meet(const gn_step_context *ctx, const gn_boundary *boundary, size_t a, size_t b);
bool gn_body_misses_bodies(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);
/* Tells whether a body that can touch no other because of its shape is, or was at the start, within
 * reach of one. */
bool gn_body_passes_bodies(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);

/* Tells whether a free body has no spring to walls or bodies that are, or were at the start, within
 * its reach: by Hertz's law it has none without a stiffness. */
bool gn_body_lacks_stiffness(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);

/* Lists the pairs within reach. `first`: at the start, where overlapping bodies do not count as
 * newly touching. */
gneiss_status gn_body_pairs_find(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, bool first, gneiss_error *error);
/* Adds the forces of the pairs to those of particles and walls. */
void gn_body_pairs_work(const gn_step_context *ctx, gn_boundary *boundary);

/* Computes upper bounds over the listed pairs of a body, with all of them in contact: of the
 * squared frequency, 1/s2, that they add, of the rate of their dashpots, 1/s, and of the squared
 * frequency of a single pair. */
void gn_body_pairs_rates(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                         double *stiff, double *damp);
double gn_body_pair_square(const gn_step_context *ctx, const gn_boundary *boundary, size_t a,
                           size_t b);
/* Returns the largest squared frequency of any two bodies that can touch. */
double gn_body_pairs_bound(const gn_step_context *ctx, const gn_boundary *boundary);

/* Overlap of two bodies; depth 0: there is none. `rest`: the largest force of bodies placed without
 * an overlap, twice their weight. */
typedef struct gn_bodies_overlap {
    double depth, force, rest; /* m, N, N */
} gn_bodies_overlap;
gneiss_status gn_bodies_overlap_of(const gn_step_context *ctx, const gn_boundary *boundary,
                                   size_t a, size_t b, gn_bodies_overlap *to, gneiss_error *error);

uint64_t gn_body_pairs_hash(const gn_body_pairs *pairs, uint64_t h);

#endif
