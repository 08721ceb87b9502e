/* Particles and bonds as files show them: what the fields of their tables are read from. */
#ifndef GN_RUN_OUTPUT_FIELDS_H
#define GN_RUN_OUTPUT_FIELDS_H

#include "frame/parts.h"
#include "particles/fragments.h"
#include "particles/observe.h"
#include "run/output_table.h"
#include "soa/records.h"
#include "world/world.h"

typedef struct gn_output_view {
    const gn_world *world;
    const gn_observed *seen;
    double *damage, *stress, *coordination; /* per particle; stress [particles][6] */
    double *normal, *shear;                 /* N, per bond, of what is seen */
    double *total, *damping;    /* N and N m, [particles][6]; NULL unless they are asked for */
    gn_fragment_list fragments; /* empty unless they are asked for */
    int32_t *row;               /* [particles] in files, where they stand by id */
    int32_t *places;            /* of elements, where particles sleep in them; NULL: none do */
} gn_output_view;

gneiss_status gn_output_view_make(const gn_world *world, const gn_observed *seen,
                                  gn_output_view *view, gneiss_error *error);
void gn_output_view_free(gn_output_view *view);

/* Particles in the order of the specimen file, and bonds. */
gn_output_source gn_output_particles(const gn_output_view *view);
gn_output_source gn_output_bonds(const gn_output_view *view);

/* Where a particle is, as the user sees it, m. */
void gn_output_place(const gn_output_view *view, size_t particle, double place[3]);
/* As the field `state` says. */
int32_t gn_output_bond_state(const gn_contacts *bonds, size_t bond);
/* The ends of a bond as rows of particles, the smaller one first. */
void gn_output_bond_ends(const gn_output_view *view, size_t bond, int32_t ends[2]);

#endif
