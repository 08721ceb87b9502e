/* Numbering of particles and contacts when lists are made. */
#ifndef GN_PARTICLES_LISTS_H
#define GN_PARTICLES_LISTS_H

#include "base/error.h"
#include "frame/parts.h"
#include "kernels/contact.h"
#include "soa/field.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* gn_dem_null_particles sets the null particles after the last one; gn_dem_number_ids sets
 * index_of_id; gn_contacts_rename gives the ends of contacts new indices, place[old] (NULL:
 * unchanged), and sorts the contacts again. */
void gn_dem_null_particles(const gn_step_context *ctx, gn_dem *dem);
void gn_dem_number_ids(gn_dem *dem);
gneiss_status gn_contacts_rename(gn_contacts *list, const int32_t *place, gneiss_error *error);
/* Updates everything that depends on masses after they have changed; gn_dem_sum_masses only adds
 * them up. */
void gn_dem_sum_masses(gn_dem *dem);
void gn_dem_masses_changed(const gn_step_context *ctx, gn_dem *dem);
/* Key of a contact whose particles have new indices: these indices and its former place in the
 * list. gn_sort_renamed sorts the keys and writes the items of *list in their order to *now; *list
 * is freed (lists.c). */
typedef struct gn_renamed {
    int32_t i, j, place;
    bool swapped;
} gn_renamed;
gneiss_status gn_sort_renamed(const gn_record *record, void *list, void *now, gn_renamed *keys,
                              gneiss_error *error);
/* Returns the first contact of a sorted list that does not precede (i, j). */
size_t gn_contacts_from(const gn_contacts *list, int32_t i, int32_t j);
size_t gn_blocks(size_t count, size_t block);

/* Finds the unbonded pairs within reach and fills their list; a pair that was listed keeps its
 * history. */
gneiss_status gn_pairs_make(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                            gneiss_error *error);
/* Returns masks of the columns whose contacts all have one value. */
gn_uniform gn_list_find_uniform(const gn_contacts *contacts);

#endif
