/* Convex rigid bodies on each other.
 *
 * Two bodies have one contact, whatever touches: its overlap is the mean depth h of the volume that
 * they share (surfaces/convex.h), its spring has the potential k h^2/2 and pushes along the
 * gradient of h. So spring, dashpot and crossings are those of the linear law along h, with the
 * mass that the gradient gives way by; friction acts at the point where the push goes through. */
#ifndef GN_BOUNDARY_BODY_PAIRS_H
#define GN_BOUNDARY_BODY_PAIRS_H

#include "frame/parts.h"

#include "base/error.h"
#include "kernels/contact.h"
#include "surfaces/convex.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A pair that is near. Doubles only: checkpoints store it as it is. Forces and moments are those on
 * the first body; of the last step, as are all others. */
typedef struct gn_body_pair {
    double first, second;             /* bodies, the first with the smaller number */
    double depth;                     /* m: h; 0: apart */
    double along[3], about[3];        /* of h, see gn_convex_overlap */
    double point[3];                  /* m, from the first body's reference point */
    double viscous;                   /* N, of the dashpot, along h */
    double shear[3];                  /* N */
    double rocking[3];                /* N m, of the dashpot against rocking */
    double twisting, twisting_spring; /* N m about the normal, N m/rad */
} gn_body_pair;

/* The largest of any two bodies, and which; 0: none. Doubles only, as well. */
typedef struct gn_bodies_worst {
    double value, first, second;
} gn_bodies_worst;

typedef struct gn_body_pairs {
    size_t bodies;
    gn_convex *convex; /* [bodies]; NULL: no two bodies meet */
    gn_convex_room room;
    size_t count, most;
    gn_body_pair *pair; /* that are near, sorted by (first, second) */
    gn_contact_sums sums;
    gn_bodies_worst deepest; /* h over the smaller of both thicknesses along the push, so far */
    gn_bodies_worst pushed; /* N, at the start, where that is more than bodies at rest press with */
} gn_body_pairs;

/* What there is to know of the shapes, once. */
gneiss_status gn_body_pairs_prepare(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error);
void gn_body_pairs_free(gn_body_pairs *pairs);
/* That no centre of mass is in another body. */
gneiss_status gn_body_pairs_check(const gn_step_context *ctx, const gn_boundary *boundary,
                                  gneiss_error *error);
/* Whether two bodies can meet; and whether one meets none because of its shape. */
bool gn_bodies_meet(const gn_step_context *ctx, const gn_boundary *boundary, size_t a, size_t b);
bool gn_body_misses_bodies(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);
/* The same, where one that it misses is, or was at the start, as near as both reach. */
bool gn_body_passes_bodies(const gn_world *world, size_t body);

/* Whether a free body has no spring, by Hertz's law without a stiffness, towards walls or bodies
 * that are, or were at the start, as near. */
bool gn_body_lacks_stiffness(const gn_world *world, size_t body);

/* Lists what is near. `first`: at the start, where what overlaps is not taken for what just met. */
gneiss_status gn_body_pairs_find(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, bool first, gneiss_error *error);
/* Adds the forces of these contacts to those of particles and walls. */
void gn_body_pairs_work(const gn_step_context *ctx, gn_boundary *boundary);

/* 1/s2, 1/s: what the pairs of a body that are near add to the square of its frequency, all in
 * touch, and its dashpots; the square of a pair. All from above. */
void gn_body_pairs_rates(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                         double *stiff, double *damp);
double gn_body_pair_square(const gn_step_context *ctx, const gn_boundary *boundary, size_t a,
                           size_t b);
/* The largest of any two bodies that can meet. */
double gn_body_pairs_bound(const gn_step_context *ctx, const gn_boundary *boundary);

/* How two bodies overlap: depth 0, not at all. Put down without an overlap they press with `rest`,
 * twice their weight, at most. */
typedef struct gn_bodies_overlap {
    double depth, force, rest; /* m, N, N */
} gn_bodies_overlap;
gneiss_status gn_bodies_overlap_of(const gn_step_context *ctx, const gn_boundary *boundary,
                                   size_t a, size_t b, gn_bodies_overlap *to, gneiss_error *error);

uint64_t gn_body_pairs_hash(const gn_body_pairs *pairs, uint64_t h);

#endif
