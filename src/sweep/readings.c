/* Names that readings of a sweep may have. */
#include "test_kinds/readings.h"
#include "base/names.h"
#include "measure/energy.h"
#include "run/quantities.h"
#include "sweep/sweep.h"

#include <string.h>

static const char *const fixed[] = {
#define X(name, unit, text) #name,
    GN_READINGS(X)
#undef X
#define X(name, kind, text) "energy." #name,
        GN_ENERGY_TERMS(X)
#undef X
            "energy.stored_at_start",
    "energy.residual"};

/* Columns of the whole model; names are borrowed for advice. */
enum { COLUMNS_MOST = 256 };
typedef struct columns {
    size_t count;
    char name[COLUMNS_MOST][GN_COLUMN_NAME_SIZE];
} columns;

static bool is_ending(const char *name, const char *ending) {
    size_t length = strlen(name), behind = strlen(ending);
    return length > behind && strcmp(name + length - behind, ending) == 0;
}

/* True for columns of a wall, a set, ...: <kind>_<any name>_<quantity>. Only the runs know the
 * names. */
static bool is_of_an_owner(const char *column, const gn_quantity_group *group) {
    size_t length = strlen(group->kind);
    if (strncmp(column, group->kind, length) != 0 || column[length] != '_') return false;
    for (size_t q = 0; q < group->quantity_count; q++) {
        char ending[GN_COLUMN_NAME_SIZE];
        gn_shape_component part[GN_SHAPE_MOST];
        size_t parts = gn_shape_components(group->quantities[q].shape, 3, part);
        for (size_t c = 0; c < parts; c++) {
            snprintf(ending, sizeof ending, "_%s%s", group->quantities[q].name, part[c].suffix);
            if (is_ending(column + length + 1, ending)) return true;
        }
    }
    return false;
}

/* A planar scene has a subset of the columns of a 3D scene. */
static void add_columns(columns *all, const gn_quantity *quantity) {
    gn_shape_component part[GN_SHAPE_MOST];
    size_t parts = gn_shape_components(quantity->shape, 3, part);
    for (size_t c = 0; c < parts && all->count < COLUMNS_MOST; c++)
        snprintf(all->name[all->count++], GN_COLUMN_NAME_SIZE, "history.%s%s", quantity->name,
                 part[c].suffix);
}

static bool is_column(const char *name, columns *all) {
    const char *column = strncmp(name, "history.", 8) == 0 ? name + 8 : "";
    for (size_t k = 0; k < GN_QUANTITY_GROUPS; k++) {
        const gn_quantity_group *group = &gn_quantity_groups[k];
        if (group->kind && is_of_an_owner(column, group)) return true;
        for (size_t q = 0; !group->kind && q < group->quantity_count; q++)
            add_columns(all, &group->quantities[q]);
    }
    for (size_t k = 0; k < all->count; k++)
        if (strcmp(name, all->name[k]) == 0) return true;
    return false;
}

bool gn_reading_known(const char *name, char *advice, size_t size) {
    columns all = {0};
    gn_names names = gn_names_for(name);
    for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++) {
        if (strcmp(name, fixed[k]) == 0) return true;
        gn_names_add(&names, fixed[k]);
    }
    if (is_column(name, &all)) return true;
    for (size_t k = 0; k < all.count; k++) gn_names_add(&names, all.name[k]);
    gn_names_advice(&names, advice, size);
    return false;
}
