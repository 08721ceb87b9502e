/* Final values of the quantities that the history has of each body or motion, in their groups of
 * results.h5. */
#include "run/parts.h"
#include "run/quantities.h"

#include <stdio.h>
#include <stdlib.h>

/* Reads the components in space, which all arrays of results.h5 have; returns their number. */
static size_t read_parts(const gn_world *w, const gn_quantity *q, size_t owner, double *to) {
    gn_shape_component part[GN_SHAPE_MOST];
    size_t parts = gn_shape_components(q->shape, 3, part);
    double value[9];
    q->read(w, owner, value);
    gn_shape_take(value, part, parts, to);
    return parts;
}

/* Writes GROUP/<quantity>, a row for every owner. */
static gneiss_status put_rows(const gn_world *w, const gn_quantity_group *g, const gn_quantity *q,
                              gn_h5 *file, gneiss_error *error) {
    char path[160];
    size_t owners = g->count(w), parts = 1;
    double *rows = calloc(owners + 1, GN_SHAPE_MOST * sizeof *rows);
    if (!rows) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s/%s", g->ends, q->name);
    for (size_t k = 0; k < owners; k++) parts = read_parts(w, q, k, rows + parts * k);
    snprintf(path, sizeof path, "%s/%s", g->ends, q->name);
    gneiss_status status =
        gn_h5_put(file, path, GN_F64, owners, parts, 0, rows, q->unit, q->text, error);
    free(rows);
    return status;
}

/* Writes GROUP/<owner>/<quantity>. */
static gneiss_status put_each(const gn_world *w, const gn_quantity_group *g, const gn_quantity *q,
                              gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < g->count(w); k++) {
        char path[160];
        double value[GN_SHAPE_MOST];
        if (!gn_condition_holds(q->when, w, k)) continue;
        size_t parts = read_parts(w, q, k, value);
        snprintf(path, sizeof path, "%s/%s/%s", g->ends, g->owner(w, k), q->name);
        GN_TRY(gn_h5_put(file, path, GN_F64, parts, 1, 0, value, q->unit, q->text, error));
    }
    return GNEISS_OK;
}

gneiss_status gn_owners_results(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < GN_QUANTITY_GROUPS; k++) {
        const gn_quantity_group *g = &gn_quantity_groups[k];
        if (!g->ends || !g->count(w)) continue;
        for (size_t i = 0; i < g->quantity_count; i++)
            GN_TRY((g->in_rows ? put_rows : put_each)(w, g, &g->quantities[i], file, error));
    }
    return GNEISS_OK;
}
