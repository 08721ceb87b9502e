/* Pressure on the surface of a packed specimen, as of a cell: loads on its skin particles that may
 * follow the deformation. */
#ifndef GN_MEMBRANE_MEMBRANE_H
#define GN_MEMBRANE_MEMBRANE_H

#include "base/error.h"
#include "frame/parts.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* State of a membrane, as checkpoints have it. Areas act where they are; tensors
 * are sums of areas times places or ways, m3. */
typedef struct gn_membrane_state {
    double pressure;    /* Pa, in the last step */
    double gradient[9]; /* of the skin in the last step: how it has moved as a whole; of several
                           bodies at the last look */
    double missing[3];  /* m2, that the patches do not have of the area of the surface */
    double rest[9];     /* what they do not have of its moment */
    double arms[9];     /* ways from the centres that bear the areas, turned back by the gradient */
    double enclosed; /* m3, by the surface of particles without a shape, at the start; 0: there is a
                        shape */
    double from;     /* Pa, that it comes from while its ramp lasts */
    double since;    /* s, when that began */
    double unlike;   /* share of it that followed it as a whole as what is around would have
                        stretched it out of all measure; the most at any look */
    int64_t bodies;  /* that the skin is of, at the last look; those that are not closed as one */
} gn_membrane_state;

/* A part of the surface that one particle bears, where things were at the start:
 * what it had of a side of the body, or a face of its cell that was bared. */
typedef struct gn_patch {
    double point[3]; /* m, its middle */
    double area[3];  /* m2, outward */
    double rest[9];  /* m3, sum of areas times ways from the middle */
    double size;     /* m2; 0: a face, whose size is that of its area */
    int32_t owner;   /* id of the particle that bears it; -1: none is left */
    int32_t body;    /* of those of the skin the one that it was of at the last look */
} gn_patch;

struct gn_membrane {
    gn_membrane_state *state;   /* NULL: there is no membrane */
    double (*skin_gradient)[9]; /* [bodies] of each in the last step */
    int32_t *skin_body;         /* [particles] of those of the skin, of several bodies */
    gn_patch *patches;          /* [patch_count] */
    size_t patch_count;
};

void gn_membrane_free(gn_membrane *membrane);

/* Cuts the surface into patches, one for each particle of the skin (skin.c). Call with
 * masses and sets applied. Does nothing without a membrane. */
gneiss_status gn_membrane_create(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 gneiss_error *error);

/* Shares the surface out again among those that the contacts of now hold (skin.c), if
 * others bear some of it; once something has come off it stays as it is. Call with bonds formed. */
gneiss_status gn_membrane_update_bearers(const gn_step_context *ctx, gn_dem *dem,
                                         gn_membrane *membrane, const gn_boundary *boundary,
                                         const gn_solids *solids, gneiss_error *error);

/* [particles] those that contacts hold against being pushed any way, of what has not come off;
 * without bonds, and where none is, all of that. */
gneiss_status gn_membrane_find_supported(const gn_step_context *ctx, const gn_dem *dem, bool *held,
                                         gneiss_error *error);

/* The skin of particles without a shape, over which a ball of the radius `ball` rolls
 * (free_surface.c). Areas go to q->skin; `arms` [particles] are the trace of areas times ways from
 * the centres, m3, and begin as 0. */
gneiss_status gn_membrane_free_skin(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    double ball, double *arms, gneiss_error *error);

/* Transfers the surface of detached particles to those beneath (detachment.c). *dropped: some were
 * detached. */
gneiss_status gn_membrane_detach(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                 bool *dropped, gneiss_error *error);

/* Tells whether the membrane covers a surface with this area vector. */
bool gn_membrane_covers(const gn_step_context *ctx, const double area[3]);

/* The particle that bears a patch; -1: none is left. */
int32_t gn_patch_bearer(const gn_dem *dem, const gn_patch *patch);

/* Areas of the skin from its patches, each as what is around it has moved, in balance as those of
 * the surface are (patches.c). At the start and at every look: then a part of the way, but
 * for those that are laid anew. */
gneiss_status gn_membrane_update_areas(const gn_step_context *ctx, gn_dem *dem,
                                       gn_membrane *membrane, bool anew, gneiss_error *error);

/* Finds how each of several bodies of the skin has moved as a whole; what that of a particle of the
 * skin has. */
gneiss_status gn_membrane_fit_bodies(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                     gneiss_error *error);
const double *gn_membrane_gradient_at(const gn_step_context *ctx, const gn_membrane *membrane,
                                      size_t p);

/* A body of those that the skin is of. */
typedef struct gn_skin_body {
    const int32_t *group; /* of each particle; NULL: all are one */
    int32_t is;
} gn_skin_body;

/* The least change of the areas (rows of 4, as q->skin) of a body after which their moment about 0,
 * with particles at `place` (rows of 4), is `moment`, m3. */
void gn_membrane_balance(const gn_step_context *ctx, const gn_dem *dem, gn_skin_body body,
                         const double *place, const double moment[3], double *area);
/* Balances the areas of all particles at present positions to the moment of the surface, which
 * follows the skin as a whole. */
void gn_membrane_rebalance(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_membrane *membrane, double *area);

/* Pa, of the instant: from what there was when it was given, over the ramp, to what is given. */
double gn_membrane_pressure_now(const gn_step_context *ctx, const gn_membrane *membrane);
/* The scene is that of the stage that begins; `pressure`, what was due before. */
void gn_membrane_enter(const gn_step_context *ctx, gn_membrane *membrane, size_t stage,
                       double pressure);

/* Applied forces of the instant; before the forces of a step. */
gneiss_status gn_membrane_apply(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                gneiss_error *error);

/* m3: that the mean stress of the specimen refers to; of particles without a shape what the
 * membrane encloses at the start. */
double gn_membrane_volume(const gn_step_context *ctx, const gn_membrane *membrane);

/* Pa: of the last step; what it adds to the mean stress of the specimen, between centres and
 * surface.
 */
double gn_membrane_pressure(const gn_membrane *membrane);
void gn_membrane_stress(const gn_step_context *ctx, const gn_membrane *membrane, double volume,
                        double stress[9]);

/* m2: what it covers, at the last look; of one body. */
double gn_membrane_area(const gn_dem *dem);
double gn_membrane_area_of(const gn_dem *dem, gn_skin_body body);

/* Tells whether the membrane loads a particle, and whether a particle is detached from the body. */
static inline bool gn_is_loaded(const gn_particles *particles, size_t p) {
    return particles->skin[4 * p + 3] > 0.0;
}
static inline bool gn_is_detached(const gn_particles *particles, size_t p) {
    return particles->skin[4 * p + 3] < 0.0;
}

static inline bool gn_is_in_body(gn_skin_body body, size_t p) {
    return !body.group || body.group[p] == body.is;
}
static inline bool gn_is_loaded_of(const gn_particles *particles, gn_skin_body body, size_t p) {
    return gn_is_loaded(particles, p) && gn_is_in_body(body, p);
}

/* x = F X by least squares of places that were at X and are at x, both from their means on. */
typedef struct gn_gradient_fit {
    int dimension;
    double sum, from[3], to[3]; /* of weights; of places times them */
    double moved[9], spread[9];
} gn_gradient_fit;
void gn_gradient_add(gn_gradient_fit *fit, double weight, const double from[3], const double to[3]);
/* m2: of weights times squares of ways from the mean, along the axis where it is least. */
double gn_gradient_spread(const gn_gradient_fit *fit);
/* False, and the identity, where the places do not span space. */
bool gn_gradient_of(const gn_gradient_fit *fit, double gradient[9]);

/* c = adj(a)^T: what turns and stretches areas as a does lengths (Nanson: J F^-T dA). */
void gn_cofactor3(const double a[9], double c[9]);
/* r = a b, r = a b^T, r = a^T b. */
void gn_product3(const double a[9], const double b[9], double r[9]);
void gn_product3_bt(const double a[9], const double b[9], double r[9]);
void gn_product3_at(const double a[9], const double b[9], double r[9]);

#endif
