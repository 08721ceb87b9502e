/* What contacts of particles with surfaces keep from one step to the next (surface_history.c), for
 * surfaces.c. */
#ifndef GN_BOUNDARY_SURFACE_CONTACTS_H
#define GN_BOUNDARY_SURFACE_CONTACTS_H

#include "soa/records.h"
#include "surfaces/facet.h"
#include "surfaces/patch.h"

#include <stdbool.h>
#include <stddef.h>

/* A contact of the last step. */
typedef struct gn_touch_memory {
    size_t row;
    double n[3], fd, closeness;
    double part;              /* of the stiffness that it had */
    double shear[3], roll[3]; /* where the contacts have them */
    bool taken, still;        /* still: shear and roll are 0 in every contact */
} gn_touch_memory;

/* Takes the histories out of the rows and empties them. `old` has room for one more than
 * GN_SURFACE_CONTACTS, where what is beyond them goes. */
size_t gn_touch_recall(gn_wall_contacts *rows, size_t begin, size_t end, gn_touch_memory *old);

/* Which contact of the last step a contact goes on from: the pairs whose normals agree best, one
 * after the other. -1: none within 60 degrees. */
void gn_touch_match(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                    size_t count, int *from);

/* Turns a force with the normal: the shortest rotation from one unit vector to the other. */
void gn_touch_follow(const double from[3], const double to[3], double force[3]);

/* Pressure over many facets: before[contacts], what each goes on from, turned to its normal. What
 * was handed over is marked as taken. */
void gn_touch_hand_over(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                        size_t count, gn_touch_memory *before);

/* One contact of those that were not taken and had about one direction, which are marked then;
 * false: there is none. */
bool gn_touch_gather(gn_touch_memory *old, size_t count, gn_touch_memory *sum);

#endif
