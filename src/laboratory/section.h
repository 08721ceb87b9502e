/* How the section of a specimen varies along the axis of its test. */
#ifndef GN_LABORATORY_SECTION_H
#define GN_LABORATORY_SECTION_H

#include "frame/parts.h"

/* Sections across the axis of a test, of what its ends strain (section.c). 0 where it is even. */
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

#endif
