/* The working set of mixed precision: fields ending in _f of particles, contacts, elements. */
#ifndef GN_SOA_SINGLE_H
#define GN_SOA_SINGLE_H

#include "soa/records.h"

/* Fills travel_f, vel_f and spin_f from the double state; `origin`: rows [n][4] that the travel is
 * counted from. */
void gn_particles_to_single(const gn_particles *particles, const double *origin, int threads);

/* Fills the columns that are beside one in double. */
void gn_elements_to_single(gn_elements *elements);

/* The same, and branch_f and stretch_f from the particles' `ref`. `period` per axis (0: none),
 * nearest images. */
void gn_contacts_to_single(gn_contacts *contacts, const gn_particles *particles,
                           const double period[3], int threads);

/* The other way, for a copy of a list without GN_FX_MIXED: what took the place of a double. */
void gn_contacts_from_single(gn_contacts *to, const gn_contacts *from);

#endif
