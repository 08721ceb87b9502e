/* What files show of every particle and every bond: two tables, from which snapshots, results.h5
 * and docs/quantities.md follow. */
#ifndef GN_RUN_OUTPUT_FIELDS_H
#define GN_RUN_OUTPUT_FIELDS_H

#include "sim/world.h"

/* What fields are read from; gn_output_view_make. */
typedef struct gn_output_view {
    const gn_world *world;
    const gn_observed *seen;
    double *damage, *stress, *coordination; /* per particle; stress [particles][6] */
} gn_output_view;

enum { GN_IN_RESULTS = 1, GN_IN_SNAPSHOT = 2 };

typedef struct gn_output_field {
    const char *name, *unit, *text;
    int where;       /* GN_IN_RESULTS, GN_IN_SNAPSHOT */
    gn_type type;    /* in results.h5; snapshots have doubles */
    bool may_be_nan; /* says that there is none */
    size_t components;
    void (*read)(const gn_output_view *view, size_t item, double *value);
    gn_effects needs; /* there only with these effects; 0: always */
} gn_output_field;

typedef struct gn_output_table {
    const gn_output_field *fields;
    size_t count;
} gn_output_table;
enum { GN_OUTPUT_FIELDS_MOST = 16 };
extern const gn_output_table gn_particle_outputs, gn_bond_outputs;

gneiss_status gn_output_view_make(const gn_world *world, const gn_observed *seen,
                                  gn_output_view *view, gneiss_error *error);
/* Whether the files of a world have the field. */
static inline bool gn_output_has(const gn_world *world, const gn_output_field *field) {
    return (world->effects & field->needs) == field->needs;
}
void gn_output_view_free(gn_output_view *view);

/* The ends of a bond as ids, the smaller one first. */
void gn_output_bond_ends(const gn_world *world, size_t bond, int32_t ends[2]);

#endif
