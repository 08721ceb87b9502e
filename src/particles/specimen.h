/* Particles of the specimen of a scene. */
#ifndef GN_PARTICLES_SPECIMEN_H
#define GN_PARTICLES_SPECIMEN_H

#include "base/error.h"
#include "frame/parts.h"
#include "io/packing.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Creates the particles of the scene's specimen from the source that the scene names (specimen.c);
 * particles that were packed before are in specimen.packed. `volume`: of the shape that they fill,
 * m3 (2D: m2); 0: there is no shape. */
gneiss_status gn_specimen_make(const gn_scene *scene, gn_packing *packing, double *volume,
                               gneiss_error *error);
/* A box that encloses points. */
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
/* Estimates the extent of the specimen. Nothing is added for a geometry that gmsh has to mesh
 * first, nor for a file that cannot be read: packing it will report the reason. */
void gn_specimen_extent(const gn_scene *scene, gn_extent *extent);
/* Calls the preparation of the scene, which may change the particles just created, and checks the
 * result. GNEISS_ERROR_INPUT names the particle and the value. */
gneiss_status gn_specimen_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Tells whether the radii of a packing cover a narrower range than requested, and writes a message
 * to `text`. Never with sources or sinks, because the message is about the specimen (specimen.c).
 */
bool gn_specimen_is_narrow(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);

#endif
