/* The working set of mixed precision: fields ending in _f of particles, contacts, elements. */
#ifndef GN_SOA_SINGLE_H
#define GN_SOA_SINGLE_H

#include "soa/records.h"

/* Fills travel_f, vel_f and spin_f from the double state. `origin` [n][4] are the positions from
 * which displacements are measured. */
void gn_particles_to_single(const gn_particles *particles, const double *origin, int threads);

/* Fills the single precision columns that exist beside a double one. */
void gn_elements_to_single(gn_elements *elements);

/* Fills the single precision columns of contacts, and branch_f and stretch_f from the particles'
 * `ref`. `period` per axis (0: none); nearest images are used. */
void gn_contacts_to_single(gn_contacts *contacts, const gn_particles *particles,
                           const double period[3], int threads);

/* Converts columns that replace a double one back, for a copy of a list without GN_FX_MIXED. */
void gn_contacts_from_single(gn_contacts *to, const gn_contacts *from);

#endif
