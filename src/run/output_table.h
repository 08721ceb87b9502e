/* Tables of the fields that files show of every particle, bond, node and so on. Snapshots,
 * results.h5 and docs/quantities.md are made from these tables. */
#ifndef GN_RUN_OUTPUT_TABLE_H
#define GN_RUN_OUTPUT_TABLE_H

#include "base/asked.h"
#include "io/h5.h"
#include "io/io.h"
#include "io/snapshot.h"
#include "run/run.h"

enum { GN_IN_RESULTS = 1, GN_IN_SNAPSHOT = 2, GN_ASKED_SHIFT = 2 };
/* The field is in results.h5 and in snapshots if the scene requests it (base/asked.h); in a file
 * whose flag is added it is without request. */
#define GN_ON_REQUEST(name) (GN_ASKED(name) << GN_ASKED_SHIFT)

typedef struct gn_output_field {
    const char *name, *unit, *text;
    unsigned where;  /* GN_IN_RESULTS, GN_IN_SNAPSHOT, GN_ON_REQUEST(name) */
    gn_type type;    /* type in results.h5; snapshots hold doubles */
    bool may_be_nan; /* NaN: the item has no value */
    size_t components;
    void (*read)(const void *view, size_t item, double *value);
    gn_effects needs; /* effects that the field requires; 0: none */
} gn_output_field;

typedef struct gn_output_table {
    const char *group; /* group of results.h5 */
    const gn_output_field *fields;
    size_t count;
} gn_output_table;
enum { GN_OUTPUT_FIELDS_MOST = 28 };

extern const gn_output_table gn_particle_outputs, gn_bond_outputs; /* output_fields.c */
extern const gn_output_table gn_contact_outputs;                   /* output_contacts.c */
extern const gn_output_table gn_event_outputs, gn_burst_outputs;   /* events.c */
extern const gn_output_table gn_rim_outputs;                       /* output_cutting.c */
extern const gn_output_table gn_fragment_outputs;                  /* output_fragments.c */
extern const gn_output_table gn_node_outputs, gn_element_outputs;  /* output_elements.c */
extern const gn_output_table gn_body_outputs, gn_vertex_outputs,
    gn_facet_outputs; /* output_bodies.c */

/* The data from which the fields of a table are read. */
typedef struct gn_output_source {
    const gn_output_table *table;
    const void *view; /* argument of the table's functions */
    gn_effects effects;
    size_t count;
    const int32_t *row; /* [count] row of an item in files; NULL: the item's index */
    const char *prefix; /* prefix of the group; NULL: none */
    unsigned asked;     /* fields that the scene requests */
} gn_output_source;

/* Writes GROUP/<field> of results.h5. */
gneiss_status gn_output_put(const gn_output_source *source, gn_h5 *file, gneiss_error *error);

/* Returns field number `index` of those in a table that results.h5 contains with these effects and
 * requests; NULL: there are fewer fields. */
const gn_output_field *gn_output_field_at(const gn_output_table *table, gn_effects effects,
                                          unsigned asked, size_t index);
/* Reads one field, [count][components]. */
void gn_output_read(const gn_output_source *source, const gn_output_field *field, double *values);

/* Fields in the form of a snapshot. */
typedef struct gn_output_arrays {
    size_t count;
    gn_snapshot_array of[GN_OUTPUT_FIELDS_MOST];
    double *data[GN_OUTPUT_FIELDS_MOST];
} gn_output_arrays;
gneiss_status gn_output_arrays_read(const gn_output_source *source, gn_output_arrays *arrays,
                                    gneiss_error *error);
void gn_output_arrays_free(gn_output_arrays *arrays);

/* Writes lost/<field> of results.h5 if particles left the domain. */
gneiss_status gn_output_lost(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* Writes the objects `sources` and `sinks` of summary.json. */
void gn_output_flow(const gn_run *run, gn_json *json);

#endif
