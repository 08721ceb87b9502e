/* Ends of a test that move as fast as a reading is to grow: past a peak where the axial motion
 * alone would release more than breaking takes. */
#ifndef GN_DRIVE_CONTROL_H
#define GN_DRIVE_CONTROL_H

#include "frame/parts.h"
#include "frame/step_context.h"

#include <stddef.h>

/* Sections across the axis of a test, of what its ends strain (section.c). 0 where it is even. */
struct gn_bar_section {
    double mean, narrowest; /* m2 */
    double uneven;          /* mean of A times mean of 1/A */
    double length;          /* m, that is strained */
    double waist;           /* 1: narrower than before and behind it */
    double guessed;         /* 1: no shape measures its volume and areas */
    double spread;          /* share by which a slender bar is stiffer */
};

/* How the ends of a test come to its specimen (approach.c). */
struct gn_approach {
    double
        away[2]; /* 1: the lower (upper) end began away, and has not yet borne when the other did */
    double gap;  /* m, at the start, of the ends that were away */
    double way;  /* m, of both ends when the last of them touched it */
};

void gn_control_create(gn_step_context *ctx);
/* Looks at the reading every so many steps; before the forces of a step. */
void gn_control_look(gn_world *world);
/* By what the prescribed velocity of a wall, set, body or motion of elements along an axis is to be
 * multiplied: 1 for what is no end of a test that is controlled. */
double gn_control_of(const gn_step_context *ctx, const char *name, int axis);

#endif
