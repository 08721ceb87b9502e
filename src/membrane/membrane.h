/* Pressure on the surface of a packed specimen, as in a triaxial cell: loads on its outer particles
 * that may follow the deformation. */
#ifndef GN_MEMBRANE_MEMBRANE_H
#define GN_MEMBRANE_MEMBRANE_H

#include "base/error.h"
#include "frame/parts.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* State of a membrane, as checkpoints store it. Areas act at their present positions; tensors are
 * sums of areas times positions or arms, m3. */
typedef struct gn_membrane_state {
    double pressure;    /* Pa, pressure of the last step */
    double gradient[9]; /* mean displacement gradient of the skin in the last step; if it has
                           several bodies, at the last update */
    double missing[3];  /* m2, area of the surface minus that of the patches */
    double rest[9];     /* m3, moment of the surface minus that of the patches */
    double arms[9];     /* m3, areas times arms from the centres of the bearers, rotated back by the
                           gradient */
    double enclosed; /* m3, volume enclosed at the start by the surface of particles without a given
                        shape; 0: a shape is given */
    double from;     /* Pa, pressure at the start of a ramp */
    double since;    /* s, start of the ramp */
    double unlike;   /* largest share of the skin, over all updates, that followed the mean motion
                        because its surroundings would have stretched it excessively */
    int64_t bodies;  /* number of bodies of the skin at the last update; all bodies with an open
                        surface count as one */
} gn_membrane_state;

/* A part of the surface at the start that one particle carries: its share of a side of the body, or
 * an exposed face of its cell. */
typedef struct gn_patch {
    double point[3]; /* m, middle of the patch */
    double area[3];  /* m2, outward */
    double rest[9];  /* m3, sum of areas times arms from the middle */
    double size;     /* m2; 0: the patch is a face, whose size is the magnitude of its area */
    int32_t owner;   /* id of the particle that carries it; -1: no particle is left */
    int32_t body;    /* number, among the bodies of the skin at the last update, of the body of the
                        particle */
} gn_patch;

struct gn_membrane {
    gn_membrane_state *state;   /* NULL: there is no membrane */
    double (*skin_gradient)[9]; /* [bodies] displacement gradient of each body in the last step */
    int32_t *skin_body; /* [particles] number of the body of the skin; only if there are several */
    gn_patch *patches;  /* [patch_count] */
    size_t patch_count;
};

void gn_membrane_free(gn_membrane *membrane);

/* Divides the surface into patches, one for each particle of the skin (skin.c). Masses and sets
 * must be applied. Does nothing without a membrane. */
gneiss_status gn_membrane_create(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 gneiss_error *error);

/* Distributes the surface again if the present contacts support other particles than before
 * (skin.c); after a particle was detached the distribution stays. Must be called after bonds are
 * formed. */
gneiss_status gn_membrane_update_bearers(const gn_step_context *ctx, gn_dem *dem,
                                         gn_membrane *membrane, const gn_boundary *boundary,
                                         const gn_solids *solids, gneiss_error *error);

/* Marks [particles] those that contacts support against a push in any direction, except detached
 * ones. Without bonds, or if no particle is supported, marks all but the detached ones. */
gneiss_status gn_membrane_find_supported(const gn_step_context *ctx, const gn_dem *dem, bool *held,
                                         gneiss_error *error);

/* Makes the skin of particles without a given shape, over which a ball of radius `ball` rolls
 * (free_surface.c). Areas are written to q->skin, the traces of areas times arms from the centres,
 * m3, to `arms` [particles], which must be 0 initially. */
gneiss_status gn_membrane_free_skin(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    double ball, double *arms, gneiss_error *error);

/* Transfers the surface of detached particles to the particles beneath (detachment.c). *dropped:
 * some particles were detached. */
gneiss_status gn_membrane_detach(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                 bool *dropped, gneiss_error *error);

/* Tells whether the membrane covers a surface with this area vector. */
bool gn_membrane_covers(const gn_step_context *ctx, const double area[3]);

/* Returns the particle that carries a patch; -1: no particle is left. */
int32_t gn_patch_bearer(const gn_dem *dem, const gn_patch *patch);

/* Updates the areas of the skin from its patches, each deformed with its surroundings, and balances
 * them to the moment of the closed surface (patches.c). Called at the start and at every update.
 * Areas change only by a fraction of the difference, unless `anew`. */
gneiss_status gn_membrane_update_areas(const gn_step_context *ctx, gn_dem *dem,
                                       gn_membrane *membrane, bool anew, gneiss_error *error);

/* gn_membrane_fit_bodies finds the mean motion of each of several bodies of the skin;
 * gn_membrane_gradient_at returns the gradient of the body of a particle. */
gneiss_status gn_membrane_fit_bodies(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                     gneiss_error *error);
const double *gn_membrane_gradient_at(const gn_step_context *ctx, const gn_membrane *membrane,
                                      size_t p);

/* A body of the skin. */
typedef struct gn_skin_body {
    const int32_t *group; /* body of each particle; NULL: there is one body */
    int32_t is;
} gn_skin_body;

/* Changes the areas (rows of 4, as q->skin) of a body as little as possible, so that their moment
 * about 0, with particles at `place` (rows of 4), becomes `moment`, m3. */
void gn_membrane_balance(const gn_step_context *ctx, const gn_dem *dem, gn_skin_body body,
                         const double *place, const double moment[3], double *area);
/* Balances the areas of all particles at their present positions to the moment of the surface,
 * which follows the skin as a whole. */
void gn_membrane_rebalance(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_membrane *membrane, double *area);

/* Returns the present pressure, Pa, which ramps from the pressure when a new one was prescribed to
 * the prescribed one. */
double gn_membrane_pressure_now(const gn_step_context *ctx, const gn_membrane *membrane);
/* Takes over the scene of the stage that begins; `pressure`: the pressure prescribed until then. */
void gn_membrane_enter(const gn_step_context *ctx, gn_membrane *membrane, size_t stage,
                       double pressure);

/* Sets the forces that the membrane applies at the instant, before the forces of a step are
 * computed. */
gneiss_status gn_membrane_apply(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                gneiss_error *error);

/* Returns the volume to which the mean stress of the specimen refers, m3; without a given shape it
 * is the volume that the membrane enclosed at the start. */
double gn_membrane_volume(const gn_step_context *ctx, const gn_membrane *membrane);

/* gn_membrane_pressure returns the pressure of the last step, Pa; gn_membrane_stress adds the
 * stress between centres and surface to the mean stress of the specimen. */
double gn_membrane_pressure(const gn_membrane *membrane);
void gn_membrane_stress(const gn_step_context *ctx, const gn_membrane *membrane, double volume,
                        double stress[9]);

/* Return the area that the membrane covered at the last update, m2, of all bodies and
 * (gn_membrane_area_of) of one body. */
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

/* Least-squares fit x = F X of positions X and x, relative to their means. */
typedef struct gn_gradient_fit {
    int dimension;
    double sum, from[3], to[3]; /* sum of weights; weighted sums of positions */
    double moved[9], spread[9];
} gn_gradient_fit;
void gn_gradient_add(gn_gradient_fit *fit, double weight, const double from[3], const double to[3]);
/* Returns the weighted sum of squared distances from the mean, m2, along the axis on which it is
 * smallest. */
double gn_gradient_spread(const gn_gradient_fit *fit);
/* Computes the gradient; returns false, and the identity, if the positions do not span the space.
 */
bool gn_gradient_of(const gn_gradient_fit *fit, double gradient[9]);

/* Computes c = adj(a)^T, which maps area vectors if `a` maps lengths (Nanson: J F^-T dA). */
void gn_cofactor3(const double a[9], double c[9]);
/* Compute r = a b, r = a b^T and r = a^T b. */
void gn_product3(const double a[9], const double b[9], double r[9]);
void gn_product3_bt(const double a[9], const double b[9], double r[9]);
void gn_product3_at(const double a[9], const double b[9], double r[9]);

#endif
