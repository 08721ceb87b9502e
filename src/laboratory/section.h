/* How the section of a specimen varies along the axis of its test. */
#ifndef GN_LABORATORY_SECTION_H
#define GN_LABORATORY_SECTION_H

#include "drive/control.h"
#include "frame/parts.h"

/* The section of a prism whose modulus is read, at the start; after all parts are made. */
gn_bar_section gn_section_of(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids);

/* Young's modulus over the slope of the stress of the test over its strain, and over the mean
 * strain of the specimen. 1: the section does not vary; NaN: no modulus follows from that slope. */
double gn_section_by_ends(const gn_step_context *ctx, const gn_bar_section *section);
double gn_section_by_mean(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          const gn_bar_section *section);

#endif
