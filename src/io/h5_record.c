/* Records in HDF5 files, field by field from their manifest. */
#include "base/new.h"
#include "io/h5_private.h"

#include <string.h>

static bool is_kept(const gn_field *field, gn_effects effects) {
    return field->role != GN_SCRATCH && gn_field_active(field, effects);
}

static gn_h5_shape field_shape(const gn_field *field, size_t count) {
    size_t components = (size_t)field->components;
    if (components == 1) return (gn_h5_shape){1, {count, 1}};
    if (field->layout == GN_ROWS) return (gn_h5_shape){2, {count, components}};
    return (gn_h5_shape){2, {components, count}};
}

static size_t field_stride(const gn_field *field, const gn_soa *soa) {
    if (field->layout == GN_ROWS || field->components == 1) return 0;
    return soa->capacity * gn_type_size(field->type);
}

static gneiss_status put_field(gn_h5 *file, const char *group, const gn_field *field,
                               const void *soa, gneiss_error *error) {
    const gn_soa *head = soa;
    GN_FREED char *name = gn_text_format("%s/%s", group, field->name);
    if (!name) return gn_no_memory(error, "a name");
    return gn_h5_put_shape(file, name, field->type, field_shape(field, head->count),
                           field_stride(field, head), gn_field_data(field, soa), field->unit,
                           field->text, error);
}

gneiss_status gn_h5_put_record(gn_h5 *file, const char *name, const gn_record *record,
                               const void *soa, gneiss_error *error) {
    const gn_soa *head = soa;
    int64_t count = (int64_t)head->count;
    GN_TRY(gn_h5_attribute_i64(file, name, "count", &count, 1, error));
    char effects[GN_EFFECT_NAMES_SIZE]; /* names and not bits, since the list may grow */
    GN_TRY(gn_h5_attribute_text(file, name, "effects", gn_effect_names(head->effects, ",", effects),
                                error));
    for (size_t f = 0; f < record->field_count; f++)
        if (is_kept(&record->fields[f], head->effects))
            GN_TRY(put_field(file, name, &record->fields[f], soa, error));
    return GNEISS_OK;
}

static gneiss_status check_effects(const gn_h5 *file, const char *group, gn_effects effects,
                                   gneiss_error *error) {
    char expected[GN_EFFECT_NAMES_SIZE];
    GN_FREED char *found = NULL;
    gn_effect_names(effects, ",", expected);
    GN_TRY(gn_h5_get_attribute_text(file, group, "effects", &found, error));
    if (strcmp(found, expected) == 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s: expected the effects %s, found %s",
                   file->path, group, *expected ? expected : "(none)", *found ? found : "(none)");
}

/* Reads a field; with `soa` NULL only checks that it exists as expected. */
static gneiss_status get_field(const gn_h5 *file, const char *group, const gn_field *field,
                               size_t count, void *soa, gneiss_error *error) {
    GN_FREED char *name = gn_text_format("%s/%s", group, field->name);
    const gn_h5_shape shape = field_shape(field, count);
    if (!name) return gn_no_memory(error, "a name");
    return soa ? gn_h5_get_shape(file, name, field->type, shape, field_stride(field, soa),
                                 gn_field_data(field, soa), error)
               : gn_h5_check(file, name, field->type, shape, error);
}

static gneiss_status get_fields(const gn_h5 *file, const char *group, const gn_record *record,
                                size_t count, gn_effects effects, void *soa, gneiss_error *error) {
    for (size_t f = 0; f < record->field_count; f++)
        if (is_kept(&record->fields[f], effects))
            GN_TRY(get_field(file, group, &record->fields[f], count, soa, error));
    return GNEISS_OK;
}

gneiss_status gn_h5_get_record(const gn_h5 *file, const char *name, const gn_record *record,
                               void *soa, gn_effects effects, gneiss_error *error) {
    int64_t count = 0;
    GN_TRY(gn_h5_get_attribute_i64(file, name, "count", &count, 1, error));
    GN_TRY(check_effects(file, name, effects, error));
    if (count < 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: attribute count of %s: expected >= 0, found %lld", file->path, name,
                       (long long)count);
    /* All fields are checked before memory is allocated, because a wrong count must not demand more
     * than there is. */
    GN_TRY(get_fields(file, name, record, (size_t)count, effects, NULL, error));
    GN_TRY(gn_soa_create(record, soa, (size_t)count, effects, error));
    gneiss_status status = get_fields(file, name, record, (size_t)count, effects, soa, error);
    if (status != GNEISS_OK) gn_soa_destroy(record, soa);
    return status;
}
