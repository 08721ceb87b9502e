/* Contacts with the forces of the present positions. */
#ifndef GN_PARTICLES_OBSERVE_H
#define GN_PARTICLES_OBSERVE_H

#include "base/error.h"
#include "frame/parts.h"
#include "kernels/partials.h"
#include "particles/contact_lists.h"
#include "soa/records.h"

#include <stddef.h>
#include <stdint.h>

/* Copies the contacts `chosen` of a list, with the forces at the present positions in their rows;
 * the caller owns the copy, also on failure. */
gneiss_status gn_contacts_observe(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_periodic_box *box, const gn_contacts *list,
                                  const int32_t *chosen, size_t count, gn_contacts *seen,
                                  gneiss_error *error);
/* Copies of all lists with the forces at the present positions in their rows (by the velocities and
 * tangential forces of the last step), for output. The world is not changed; the caller frees the
 * copies. */
typedef struct gn_observed {
    gn_contacts list[GN_LIST_COUNT];
} gn_observed;
gneiss_status gn_dem_observe(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_periodic_box *box, gn_observed *observed,
                             gneiss_error *error);
void gn_observed_free(gn_observed *observed);

/* Returns 1 - volume of the particles (overlaps counted twice) over that of the specimen. */
double gn_dem_porosity(const gn_step_context *ctx, const gn_dem *dem);

/* Performs a step of zero length on a copy of a list, in double precision: failures of bonds affect
 * the copy alone. The caller owns it, also on failure. `partials`: the partial sums of the list,
 * with rows of doubles; NULL: forces are in the rows of the copy alone. */
gneiss_status gn_contacts_evaluate(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_periodic_box *box, const gn_contacts *list,
                                   const gn_partials *partials, gn_contacts *copy,
                                   gneiss_error *error);

#endif
