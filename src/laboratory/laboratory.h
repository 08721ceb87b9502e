/* The specimen as a test sees it: lengths, areas, and the stress in its middle. */
#ifndef GN_LABORATORY_LABORATORY_H
#define GN_LABORATORY_LABORATORY_H

#include "base/error.h"
#include "frame/parts.h"
#include "test_kinds/test_kind.h"

#include <stdbool.h>
#include <stddef.h>

/* From the scene, and where it does not say from the extent and the volume of the specimen, which
 * the world has. */
gn_tested_shape gn_test_shape(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids);

/* Where its area comes from, in words; "": the scene gives it, or there is none. */
const char *gn_test_area_source(const gn_step_context *ctx);

/* Mean stress, Pa, of a disc's region about its centre (test.centre): sum over contacts of f_a l_b
 * over the volume of the region, l the part of the branch that lies in it. At the present places,
 * with the tangential forces of the last step. */
void gn_test_centre_stress(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids,
                           const gn_periodic_box *box, double sigma[9]);

/* Whether length, area, diameter or thickness of a test are off by more than a tenth of what the
 * specimen has at the start, or a beam by a hundredth (laboratory/bending.h). `text` then has each
 * with both numbers, else it is "". */
bool gn_geometry_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, char *text, size_t size);

/* GNEISS_ERROR_INPUT where a disc, or a specimen between platens under a pressure or in an
 * oedometer, has nothing like them: less than half or more than twice. After all parts are made. */
gneiss_status gn_geometry_check(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids,
                                gneiss_error *error);

/* m: extent at the start of what is tested: of the particles, radii included, and of the elements
 * that are one body with them (`couple`), which may be packed in a part of it alone. */
void gn_world_body(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                   double upper[3]);

double gn_world_side(const gn_step_context *ctx, const gn_solids *solids, int axis);

/* Sections across the axis of a test, of what its ends strain (laboratory.c). 0 where it is even.
 */
struct gn_bar_section {
    double mean, narrowest; /* m2 */
    double uneven;          /* mean of A times mean of 1/A */
    double length;          /* m, that is strained */
    double waist;           /* 1: narrower than before and behind it */
    double guessed;         /* 1: no shape measures its volume and areas */
    double spread;          /* share by which a slender bar is stiffer */
};

/* The section of a prism whose modulus is read, at the start; after all parts are made. */
gn_bar_section gn_section_of(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_solids *solids);

/* Young's modulus over the slope of the stress of the test over its strain, and over the mean
 * strain of the specimen. 1: the section does not vary; NaN: no modulus follows from that slope. */
double gn_section_by_ends(const gn_step_context *ctx, const gn_bar_section *section);
double gn_section_by_mean(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          const gn_bar_section *section);

/* Whether span, load_span, height, notch or thickness of a bending test are off by more than a
 * hundredth of what the scene shows: where supports and loads hold the specimen at the start, and
 * its extent. `text` then has each with both numbers, else it is "". */
bool gn_bending_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, char *text, size_t size);

/* Whether all of the upper end is beside all of the lower one along the beam: no support, or no
 * load, is between. False where a wall is among them. */
bool gn_bending_outside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids);

#endif
