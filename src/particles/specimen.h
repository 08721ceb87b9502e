/* Particles of the specimen of a scene. */
#ifndef GN_PARTICLES_SPECIMEN_H
#define GN_PARTICLES_SPECIMEN_H

#include "base/error.h"
#include "frame/parts.h"
#include "io/packing.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Particles of the scene's specimen, from whichever source (specimen.c); of a file those in
 * specimen.packed. `volume`: of the shape that they fill, m3 (2D: m2); 0 when they come without
 * one. */
gneiss_status gn_specimen_make(const gn_scene *scene, gn_packing *packing, double *volume,
                               gneiss_error *error);
/* A box about points. */
typedef struct gn_extent {
    double lower[3], upper[3]; /* m */
} gn_extent;
#define GN_EXTENT_NONE                                                                             \
    {                                                                                              \
        {INFINITY, INFINITY, INFINITY}, {                                                          \
            -INFINITY, -INFINITY, -INFINITY                                                        \
        }                                                                                          \
    }
void gn_extent_add(gn_extent *extent, const double point[3], double radius);
/* About where the specimen will be. Nothing is added for a geometry that gmsh has to mesh first,
 * nor for a file that cannot be read: packing it will tell why. */
void gn_specimen_extent(const gn_scene *scene, gn_extent *extent);
/* Has the preparation of the scene change the particles that were just created, and checks what it
 * leaves. GNEISS_ERROR_INPUT: particle, value. */
gneiss_status gn_specimen_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* specimen.c: whether the radii of a packing came out narrower than they were asked for; `text`
 * then says so. Without sources and sinks, so that it is said of the specimen. */
bool gn_specimen_is_narrow(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);

#endif
