/* The specimen as a test sees it: lengths, areas, and the stress in its middle. */
#ifndef GN_LABORATORY_LABORATORY_H
#define GN_LABORATORY_LABORATORY_H

#include "frame/parts.h"
#include "test_kinds/test_kind.h"

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

#endif
