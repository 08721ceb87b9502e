/* The specimen of a test: lengths, areas, sections, and the stress in its middle. */
#ifndef GN_LABORATORY_LABORATORY_H
#define GN_LABORATORY_LABORATORY_H

#include "base/error.h"
#include "frame/parts.h"
#include "test_kinds/test_kind.h"

#include <stdbool.h>
#include <stddef.h>

/* Returns the shape of the test from the scene; sizes that the scene does not give follow from the
 * extent and the volume of the specimen in the world. */
gn_tested_shape gn_test_shape(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids);

/* Returns how the area was determined, as text; "": it is given in the scene, or there is none. */
const char *gn_test_area_source(const gn_step_context *ctx);

/* Computes the mean stress, Pa, of a disc's region about its centre (test.centre): the sum over
 * contacts of f_a l_b over the volume of the region, with l the part of the branch inside it, at
 * the present positions, with the tangential forces of the last step. */
void gn_test_centre_stress(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids,
                           const gn_periodic_box *box, double sigma[9]);

/* Tells whether length, area, diameter or thickness of a test differ by more than a tenth from
 * those of the specimen at the start, or those of a beam by more than a hundredth. `text` then
 * states each with both values, else it is "". */
bool gn_geometry_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, char *text, size_t size);

/* Returns GNEISS_ERROR_INPUT if the sizes that the scene gives for a disc, or for a specimen
 * between platens under a pressure or in an oedometer, are less than half or more than twice those
 * of the specimen. Call after all parts are made. */
gneiss_status gn_geometry_check(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids,
                                gneiss_error *error);

/* Computes the extent, m, of the specimen at the start: of the particles, radii included, and of
 * elements that belong to the same body (`couple`), which the particles may fill in part. */
void gn_tested_extent(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                      double upper[3]);

double gn_tested_side(const gn_step_context *ctx, const gn_solids *solids, int axis);

/* Sections across the axis of the strained part of a specimen (laboratory.c). 0: uniform. */
struct gn_bar_section {
    double mean, narrowest; /* m2 */
    double uneven;          /* mean of A times mean of 1/A */
    double length;          /* m, strained length */
    double waist;           /* 1: the bar is narrower at some section than on both sides of it */
    double guessed;         /* 1: volume and areas are not given by a shape */
    double spread;          /* share by which a bar taken as slender is too stiff */
};

/* Computes the sections, at the start, of a prism whose modulus is read. Call after all parts are
 * made. */
gn_bar_section gn_section_of(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids);

/* Return the ratio of Young's modulus to a slope of the test's stress: over its strain
 * (gn_section_by_ends), and over the mean strain of the specimen (gn_section_by_mean). 1: the
 * section does not vary; NaN: no modulus follows from that slope. */
double gn_section_by_ends(const gn_step_context *ctx, const gn_bar_section *section);
double gn_section_by_mean(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          const gn_bar_section *section);

/* Tells whether span, load_span, height, notch or thickness of a bending test differ by more than a
 * hundredth from the scene: they are compared with the positions where supports and loads hold the
 * specimen at the start, and with its extent. `text` then states each with both values, else it is
 * "". */
bool gn_bending_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, char *text, size_t size);

/* Tells whether the whole upper end is beside the whole lower one along the beam, so that no
 * support, or no load, is between. False if a wall belongs to an end. */
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
/* Returns the source as text: "the shape", "the convex hull of the particles", ... */
const char *gn_volume_source_text(const gn_step_context *ctx, gn_volume_source source);

#endif
