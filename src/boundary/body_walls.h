/* Free rigid bodies on plane walls.
 *
 * The deepest points of a closed shape behind a plane are vertices: each of them is a contact of
 * its own, with a part of the stiffness that never changes, so that the springs have a potential.
 * The part is what the angles of the facets around the vertex lack of a full turn, over 2 pi (in
 * the plane the turn of the outline over pi). On a convex shape these add up to 2, however its
 * faces are cut into triangles: half of all directions in which a body can be pressed share one
 * stiffness. A box on a face and a prism on its end have it whole. */
#ifndef GN_BOUNDARY_BODY_WALLS_H
#define GN_BOUNDARY_BODY_WALLS_H

#include "base/effects.h"
#include "base/error.h"
#include "frame/parts.h"
#include "frame/step_context.h"
#include "kernels/law.h"
#include "particles/body_springs.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Parts of the stiffness of all vertices, from their places in the bodies' frames, into
 * world->boundary.vertex_part. */
gneiss_status gn_body_walls_prepare(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error);
/* That no free body has its centre of mass behind a wall. */
gneiss_status gn_body_walls_check(const gn_step_context *ctx, const gn_boundary *boundary,
                                  gneiss_error *error);
/* Whether a body can touch walls: it is free and, by Hertz's law, has a stiffness of its own; and
 * whether a free one cannot that was near one at the start, or is now. */
bool gn_body_meets_walls(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);
bool gn_body_passes_walls(const gn_step_context *ctx, const gn_boundary *boundary, size_t body);

/* Columns that these contacts have. */
static inline gn_effects gn_body_wall_effects(const gn_step_context *ctx) {
    return ctx->effects & ~(gn_effects)(GN_FX_FACETS | GN_FX_ROLLING | GN_FX_HERTZ);
}
/* Lists the vertices near walls, sorted by (body, wall, vertex), and takes over what those that
 * were listed hold. `first`: as gn_boundary_refresh. */
gneiss_status gn_body_walls_find(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, bool first, gneiss_error *error);
/* Adds the forces of these contacts to those on walls and bodies, which have those of the particles
 * already. */
void gn_body_walls_work(const gn_step_context *ctx, gn_boundary *boundary);

/* A contact that is listed. */
typedef struct gn_body_wall {
    size_t body, wall;
    double part;        /* of the stiffness */
    double lever[3];    /* m, of the vertex from the body's reference point */
    gn_touch_side side; /* of this part */
    double damping;     /* of critical */
} gn_body_wall;
gn_body_wall gn_body_wall_at(const gn_step_context *ctx, const gn_boundary *boundary, size_t row);

/* 1/s2: the largest square of a frequency of the body of a row on the springs of its wall, were all
 * that are listed pressed; goes on to the first row of another (surface_limit.c). */
double gn_body_walls_square(const gn_step_context *ctx, const gn_boundary *boundary, size_t *row);

/* The same, from above, of any body on any wall, wherever they are. */
double gn_body_walls_bound(const gn_step_context *ctx, const gn_boundary *boundary);

/* N/m, of the contacts that press a wall, with what their dashpots do in a step if `dashpots`; and
 * of those that do not, but would within `path` of it. */
double gn_body_walls_pressing(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                              bool dashpots);
double gn_body_walls_within(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                            double path);

/* How a body lies on a wall. */
typedef struct gn_body_overlap {
    size_t vertices; /* behind the plane */
    double deepest;  /* m */
    double force;    /* N, with which springs push it out */
} gn_body_overlap;
gn_body_overlap gn_body_walls_overlap(const gn_step_context *ctx, const gn_boundary *boundary,
                                      size_t body, size_t wall);

#endif
