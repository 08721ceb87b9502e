/* Ranges of the columns of a record that index, count or bound something. Kernels follow them
 * without a check, so a tampered file with a recomputed digest must be refused here. Real numbers
 * have been checked to be finite before (gn_h5_demand_finite). */
#include "base/new.h"
#include "run/checkpoint_internal.h"
#include "soa/bond_causes.h"

#include <math.h>
#include <string.h>

typedef struct range {
    const char *field;
    int component; /* -1: all */
    double least, most;
} range;

static const double light = 299792458.0; /* m/s: far above every speed of a scene */
#define FAR    1e30                      /* m: squares and cubes of such distances are finite */
#define GROUPS 1e6 /* the bound of specimen.group: arrays have an entry for each group */
#define ANY    INFINITY

static const range of_particles[] = {
    {"pos", 0, -FAR, FAR},       {"pos", 1, -FAR, FAR},     {"pos", 2, -FAR, FAR},
    {"pos", 3, 0.0, FAR},        {"vel", 0, -light, light}, {"vel", 1, -light, light},
    {"vel", 2, -light, light},   {"vel", 3, 0.0, ANY},      {"spin", 3, 0.0, ANY},
    {"start", 0, -FAR, FAR},     {"start", 1, -FAR, FAR},   {"start", 2, -FAR, FAR},
    {"ref", 0, -FAR, FAR},       {"ref", 1, -FAR, FAR},     {"ref", 2, -FAR, FAR},
    {"own_share", -1, 0.0, 1.0}, {"group", -1, 0, GROUPS},  {"bonds0", -1, 0, ANY},
    {"slot", -1, -1, ANY},       {"pressed", -1, 0.0, ANY}, {"orientation", -1, -2.0, 2.0},
    {"blend", 0, -1.0, 2.0},
};

static const range of_contacts[] = {
    {"kn", -1, 0.0, ANY},
    {"kt", -1, 0.0, ANY},
    {"mu", -1, 0.0, ANY},
    {"cn", -1, 0.0, ANY},
    {"length0", -1, 0.0, FAR},
    {"rt", -1, 0.0, ANY},
    {"section", -1, 0.0, ANY},
    {"soft", -1, 0.0, 1.0},
    {"kappa", -1, 0.0, 1.0},
    {"beam", -1, 0.0, FAR},
    {"share", -1, 0.0, ANY},
    {"closeness", -1, 0.0, ANY},
    {"reduced", -1, 0.0, FAR},
    {"rolling", -1, 0.0, FAR},
    {"twisting", -1, 0.0, FAR},
    {"most", -1, 0.0, FAR},
    {"cause", -1, 0, GN_BOND_NEVER},
    {"area", -1, 0.0, ANY},
    {"looked", -1, -2.0, 2.0},
    {"broken_time", -1, 0.0, ANY},
    {"plane", -1, -1.001, 1.001},
    {"dilation", -1, 0.0, FAR},
    {"slip", -1, 0.0, FAR},
    {"patch", -1, 0.0, ANY},
};

static const range of_elements[] = {
    {"volume", -1, 0.0, ANY}, {"mu", -1, 0.0, ANY}, {"material", -1, 0, ANY}, {"id", -1, 0, ANY}};

static double value_at(gn_type type, const void *data, size_t k) {
    switch (type) {
    case GN_F64:
        return ((const double *)data)[k];
    case GN_F32:
        return (double)((const float *)data)[k];
    case GN_I64:
        return (double)((const int64_t *)data)[k];
    case GN_I32:
        return ((const int32_t *)data)[k];
    case GN_U8:
        return ((const uint8_t *)data)[k];
    }
    return NAN;
}

static gneiss_status check_field(const char *group, const gn_field *field, const void *soa,
                                 const range *bounds, const char *path, gneiss_error *error) {
    const gn_soa *head = soa;
    const void *data = gn_field_data(field, soa);
    const size_t components = (size_t)field->components;
    for (size_t k = 0; data && k < head->count; k++)
        for (size_t c = 0; c < components; c++) {
            if (bounds->component >= 0 && c != (size_t)bounds->component) continue;
            size_t place = field->layout == GN_ROWS ? k * components + c : c * head->capacity + k;
            double value = value_at(field->type, data, place);
            if (value >= bounds->least && value <= bounds->most) continue;
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: %s/%s: expected values in [%g, %g], found %g in row %zu, column "
                           "%zu (base 0)",
                           path, group, field->name, bounds->least, bounds->most, value, k, c);
        }
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_check_record(const char *group, const gn_record *record,
                                         const void *soa, const char *path, gneiss_error *error) {
    const bool particles = record == &gn_particle_record, contacts = record == &gn_contact_record;
    const range *list = particles ? of_particles : contacts ? of_contacts : of_elements;
    const size_t count = particles  ? sizeof of_particles / sizeof *list
                         : contacts ? sizeof of_contacts / sizeof *list
                                    : sizeof of_elements / sizeof *list;
    for (size_t f = 0; f < record->field_count; f++)
        for (size_t k = 0; k < count && record->fields[f].role != GN_SCRATCH; k++)
            if (strcmp(record->fields[f].name, list[k].field) == 0)
                GN_TRY(check_field(group, &record->fields[f], soa, &list[k], path, error));
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_check_numbers(const char *group, const int32_t *number, size_t count,
                                          size_t most, const char *path, gneiss_error *error) {
    GN_FREED uint8_t *seen = NULL;
    GN_TRY(gn_new(&seen, most + 1, "marks", error));
    for (size_t k = 0; k < count; k++)
        if (number[k] < 0 || (size_t)number[k] >= most || seen[number[k]]++)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: %s/id: expected numbers below %zu, each once, found %d in row %zu "
                           "(base 0)",
                           path, group, most, number[k], k);
    return GNEISS_OK;
}
