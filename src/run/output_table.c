#include "run/output_table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool there(gn_effects effects, unsigned asked, const gn_output_field *field,
                  unsigned where) {
    return field->where & (where | asked << GN_ASKED_SHIFT) &&
           (effects & field->needs) == field->needs;
}

const gn_output_field *gn_output_field_at(const gn_output_table *table, gn_effects effects,
                                          unsigned asked, size_t index) {
    for (size_t k = 0; k < table->count; k++)
        if (there(effects, asked, &table->fields[k], GN_IN_RESULTS) && index-- == 0)
            return &table->fields[k];
    return NULL;
}

void gn_output_read(const gn_output_source *source, const gn_output_field *field, double *values) {
    for (size_t k = 0; k < source->count; k++)
        field->read(source->view, k,
                    values + field->components * (source->row ? (size_t)source->row[k] : k));
}

/* Allocates and reads [count][components]. */
static gneiss_status read_field(const gn_output_source *source, const gn_output_field *field,
                                double **data, gneiss_error *error) {
    *data = calloc(source->count + 1, field->components * sizeof **data);
    if (!*data)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %s/%s",
                       source->table->group, field->name);
    gn_output_read(source, field, *data);
    return GNEISS_OK;
}

/* Converts numbers in place from double to a smaller type. */
static void narrow(void *data, gn_type type, size_t count) {
    const double *from = data;
    for (size_t k = 0; k < count; k++) {
        double value = from[k];
        if (type == GN_I32) memcpy((int32_t *)data + k, &(int32_t){(int32_t)value}, 4);
        if (type == GN_U8) memcpy((uint8_t *)data + k, &(uint8_t){(uint8_t)value}, 1);
    }
}

gneiss_status gn_output_put(const gn_output_source *source, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < source->table->count; k++) {
        const gn_output_field *f = &source->table->fields[k];
        char path[160];
        double *data;
        if (!there(source->effects, source->asked, f, GN_IN_RESULTS)) continue;
        GN_TRY(read_field(source, f, &data, error));
        narrow(data, f->type, source->count * f->components);
        snprintf(path, sizeof path, "%s%s/%s", source->prefix ? source->prefix : "",
                 source->table->group, f->name);
        bool demanded = gn_h5_demand_finite(file, false);
        gn_h5_demand_finite(file, demanded && !f->may_be_nan);
        gneiss_status status = gn_h5_put(file, path, f->type, source->count, f->components, 0, data,
                                         f->unit, f->text, error);
        gn_h5_demand_finite(file, demanded);
        free(data);
        GN_TRY(status);
    }
    return GNEISS_OK;
}

gneiss_status gn_output_arrays_read(const gn_output_source *source, gn_output_arrays *arrays,
                                    gneiss_error *error) {
    *arrays = (gn_output_arrays){0};
    for (size_t k = 0; k < source->table->count; k++) {
        const gn_output_field *f = &source->table->fields[k];
        if (!there(source->effects, source->asked, f, GN_IN_SNAPSHOT)) continue;
        double **data = &arrays->data[arrays->count];
        gneiss_status status = read_field(source, f, data, error);
        if (status != GNEISS_OK) gn_output_arrays_free(arrays);
        GN_TRY(status);
        arrays->of[arrays->count++] =
            (gn_snapshot_array){f->name, f->unit, f->components, *data, f->may_be_nan};
    }
    return GNEISS_OK;
}

void gn_output_arrays_free(gn_output_arrays *arrays) {
    for (size_t k = 0; k < arrays->count; k++) free(arrays->data[k]);
    *arrays = (gn_output_arrays){0};
}
