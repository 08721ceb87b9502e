/* Particles and bonds in files: the view from which the fields of their tables are read. */
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
    double *normal, *shear;                 /* N, per bond of the view */
    double *total, *damping;                /* N and N m, [particles][6]; NULL unless requested */
    gn_fragment_list fragments;             /* empty unless requested */
    int32_t *row;                           /* [particles] row in files, which are sorted by id */
    int32_t
        *places; /* elements in which dormant particles are; NULL: there are no dormant particles */
} gn_output_view;

gneiss_status gn_output_view_make(const gn_world *world, const gn_observed *seen,
                                  gn_output_view *view, gneiss_error *error);
void gn_output_view_free(gn_output_view *view);

/* Sources of the tables of particles, in the order of the specimen file, and of bonds. */
gn_output_source gn_output_particles(const gn_output_view *view);
gn_output_source gn_output_bonds(const gn_output_view *view);

/* The position of a particle in the user's coordinates, m. */
void gn_output_place(const gn_output_view *view, size_t particle, double place[3]);
/* The value of the field `state`. */
int32_t gn_output_bond_state(const gn_contacts *bonds, size_t bond);
/* The ends of a bond as rows of particles, the smaller one first. */
void gn_output_bond_ends(const gn_output_view *view, size_t bond, int32_t ends[2]);

#endif
