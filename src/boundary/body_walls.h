/* Free rigid bodies on plane walls. Where a closed shape is deepest behind a plane, there are
 * vertices. Each of them is a contact with a constant part of the stiffness, so that the springs
 * have a potential. The part is the amount by which the angles of the facets around the vertex fall
 * short of a full turn, over 2 pi (in the plane the exterior angle of the outline, over pi). On a
 * convex shape the parts add up to 2, however its faces are divided into triangles, so that one
 * stiffness belongs to half of all directions in which the body can be pressed. A box on a face and
 * a prism on its end have all of it. */
#ifndef GN_BOUNDARY_BODY_WALLS_H
#define GN_BOUNDARY_BODY_WALLS_H

#include "base/effects.h"
#include "base/error.h"
#include "frame/frame.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Computes the parts of the stiffness of all vertices from their positions in the bodies' frames,
 * and stores them in boundary->vertex_part. */
gneiss_status gn_body_walls_prepare(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error);
/* Checks that no free body has its centre of mass behind a wall. */
gneiss_status gn_body_walls_check(const gn_step_context *ctx, const gn_boundary *boundary,
                                  gneiss_error *error);
/* Tells whether a free body that cannot touch walls, because by Hertz's law it has no stiffness of
 * its own, is or was at the start near one. */
bool gn_body_passes_walls(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);

/* Returns the effects whose columns these contacts have. */
static inline gn_effects gn_body_wall_effects(const gn_step_context *ctx) {
    return ctx->effects & ~(gn_effects)(GN_FX_FACETS | GN_FX_ROLLING | GN_FX_HERTZ);
}
/* Lists the vertices near walls, sorted by (body, wall, vertex), and keeps the history of those
 * that were listed. `first`: see gn_boundary_refresh. */
gneiss_status gn_body_walls_find(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, bool first, gneiss_error *error);
/* Adds the forces of vertices to those on walls and bodies, which already contain those of the
 * particles. */
void gn_body_walls_work(const gn_step_context *ctx, gn_boundary *boundary);

/* A listed contact. */
typedef struct gn_body_wall {
    size_t body, wall;
    double part;        /* fraction of the stiffness */
    double lever[3];    /* m, of the vertex from the body's reference point */
    gn_touch_side side; /* parameters for this fraction */
    double damping;     /* fraction of the critical damping */
} gn_body_wall;
gn_body_wall gn_body_wall_at(const gn_step_context *ctx, const gn_boundary *boundary, size_t row);

/* Returns an upper bound of the largest stiffness of any body on any wall, wherever they are. */
double gn_body_walls_bound(const gn_step_context *ctx, const gn_boundary *boundary);

/* Computes stiffnesses, N/m: of the contacts that press a wall, with the effect of their dashpots
 * in a step if `dashpots`; and of those that do not press it but would within a path of `path`, m.
 */
double gn_body_walls_pressing(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                              bool dashpots);
double gn_body_walls_within(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                            double path);

/* Overlap of a body with a wall. */
typedef struct gn_body_overlap {
    size_t vertices; /* number of vertices behind the plane */
    double deepest;  /* m */
    double force;    /* N, force of the springs */
} gn_body_overlap;
gn_body_overlap gn_body_walls_overlap(const gn_step_context *ctx, const gn_boundary *boundary,
                                      size_t body, size_t wall);

#endif
