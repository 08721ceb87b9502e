/* The specimen of a test: lengths, areas, sections, and the stress in its middle. */
#ifndef GN_LABORATORY_LABORATORY_H
#define GN_LABORATORY_LABORATORY_H

#include "base/error.h"
#include "frame/parts.h"
#include "test_kinds/test_kind.h"

#include <stdbool.h>
#include <stddef.h>

/* Returns the shape of the test from the scene, or else from the extent and the volume of the
 * specimen in the world. */
gn_tested_shape gn_test_shape(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids);

/* Origin of the area, in words; "": it is given in the scene, or there is none. */
const char *gn_test_area_source(const gn_step_context *ctx);

/* Mean stress, Pa, of a disc's region about its centre (test.centre): sum over contacts of f_a l_b
 * over the volume of the region, l the part of the branch that lies in it. At the present places,
 * with the tangential forces of the last step. */
void gn_test_centre_stress(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids,
                           const gn_periodic_box *box, double sigma[9]);

/* Tells whether length, area, diameter or thickness of a test differ by more than a tenth from
 * those of the specimen at the start, or those of a beam by a hundredth. `text` then gives each
 * with both numbers, else it is "". */
bool gn_geometry_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, char *text, size_t size);

/* Returns GNEISS_ERROR_INPUT if the numbers of a disc, or of a specimen between platens under a
 * pressure or in an oedometer, are less than half or more than twice those of the specimen. Call
 * after all parts are made. */
gneiss_status gn_geometry_check(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids,
                                gneiss_error *error);

/* Computes the extent, m, of the specimen at the start: of the particles, radii included, and of
 * the elements of the same body (`couple`), which the particles may fill in part. */
void gn_tested_extent(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                      double upper[3]);

double gn_tested_side(const gn_step_context *ctx, const gn_solids *solids, int axis);

/* Sections across the axis of the strained part of a specimen (laboratory.c). 0: uniform. */
struct gn_bar_section {
    double mean, narrowest; /* m2 */
    double uneven;          /* mean of A times mean of 1/A */
    double length;          /* m, strained length */
    double waist;           /* 1: the bar is narrower there than on both sides */
    double guessed;         /* 1: volume and areas are not given by a shape */
    double spread;          /* share by which a slender bar is stiffer */
};

/* Finds the section of a prism whose modulus is read, at the start; after all parts are made. */
gn_bar_section gn_section_of(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids);

/* Young's modulus over the slope of the stress of the test over its strain, and over the mean
 * strain of the specimen. 1: the section does not vary; NaN: no modulus follows from that slope. */
double gn_section_by_ends(const gn_step_context *ctx, const gn_bar_section *section);
double gn_section_by_mean(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          const gn_bar_section *section);

/* Tells whether span, load_span, height, notch or thickness of a bending test differ by more than a
 * hundredth from the scene: the positions where supports and loads hold the specimen at the start,
 * and its extent. `text` then gives each with both numbers, else it is "". */
bool gn_bending_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, char *text, size_t size);

/* Tells whether the whole upper end is beside the whole lower one along the beam: no support, or no
 * load, is between. False if a wall is among them. */
bool gn_bending_outside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids);

/* How the volume of the specimen is determined. */
typedef enum gn_volume_source {
    GN_VOLUME_OF_ELEMENTS,
    GN_VOLUME_OF_BOX,
    GN_VOLUME_OF_SOURCES,
    GN_VOLUME_OF_SHAPE,
    GN_VOLUME_OF_PACKING,
    GN_VOLUME_OF_TEST,
    GN_VOLUME_OF_HULL
} gn_volume_source;

/* Returns how the volume of the specimen is determined. */
gn_volume_source gn_volume_source_of(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids);
/* Returns its name: "the shape", "the convex hull of the particles", ... */
const char *gn_volume_source_text(const gn_step_context *ctx, gn_volume_source source);

#endif
