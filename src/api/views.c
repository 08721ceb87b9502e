/* Public API: fields, history, readings and energies of a world. */
#include "api/handles.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

/* Names for messages, as many as there is room for. */
typedef struct name_list {
    char text[1024];
    size_t used;
} name_list;

static void add_name(name_list *list, const char *name) {
    size_t length = strlen(name), gap = list->used ? 2 : 0;
    if (list->used + gap + length + sizeof ", ..." > sizeof list->text) return;
    memcpy(list->text + list->used, ", ", gap);
    memcpy(list->text + list->used + gap, name, length);
    list->used += gap + length;
}

/* --- fields --- */

/* A record of a world and its manifest. */
typedef struct record_place {
    const gn_record *record;
    const gn_soa *soa;
} record_place;

const char *gneiss_record_name(gneiss_record record) {
    static const char *const names[] = {"particles",     "bonds", "pairs",
                                        "wall_contacts", "nodes", "elements"};
    return (unsigned)record < 6 ? names[record] : NULL;
}

static record_place find_record(const gneiss_world *world, gneiss_record record) {
    static const gn_fem_solid none;
    const gn_world *inner = &world->run.world;
    const gn_fem_solid *body = inner->solids.count ? &inner->solids.elements[0]->solid : &none;
    switch (record) {
    case GNEISS_PARTICLES:
        return (record_place){&gn_particle_record, &inner->dem.particles.soa};
    case GNEISS_BONDS:
        return (record_place){&gn_contact_record, &inner->dem.bonds.contacts.soa};
    case GNEISS_PAIRS:
        gn_active_pairs_settle(&inner->ctx, &inner->dem);
        return (record_place){&gn_contact_record, &inner->dem.pairs.contacts.soa};
    case GNEISS_WALL_CONTACTS:
        return (record_place){&gn_wall_contact_record, &inner->boundary.contacts.soa};
    case GNEISS_NODES:
        return (record_place){&gn_particle_record, &body->nodes.soa};
    case GNEISS_ELEMENTS:
        return (record_place){&gn_element_record, &body->elements.soa};
    }
    return (record_place){NULL, NULL};
}

static gneiss_status require_record(const gneiss_world *world, gneiss_record record,
                                    record_place *out, gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    *out = find_record(world, record);
    if (out->record) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "argument record: expected one in [0, 5], found %d",
                   (int)record);
}

/* Returns an active field. All fields of an unused record are NULL, whatever its effects are. */
static const gn_field *active_field(record_place place, size_t index, size_t *count) {
    *count = 0;
    for (size_t f = 0; f < place.record->field_count; f++) {
        if (!gn_field_data(&place.record->fields[f], place.soa)) continue;
        if (*count == index) return &place.record->fields[f];
        ++*count;
    }
    return NULL;
}

static void fill_view(record_place place, const gn_field *field, gneiss_view *view) {
    size_t size = gn_type_size(field->type), width = size * (size_t)field->components;
    bool rows = field->layout == GN_ROWS;
    *view = (gneiss_view){
        .name = field->name,
        .unit = field->unit,
        .description = field->text,
        .type = (gneiss_type)field->type,
        .components = field->components,
        .count = place.soa->count,
        .item_stride = rows ? width : size,
        .component_stride = rows ? size : size * place.soa->capacity,
        .data = gn_field_data(field, place.soa),
    };
}

gneiss_status gneiss_world_origin(const gneiss_world *world, double origin[3],
                                  gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(origin, "origin", error));
    memcpy(origin, world->run.world.ctx.scene.origin, sizeof world->run.world.ctx.scene.origin);
    return GNEISS_OK;
}

size_t gneiss_world_field_count(const gneiss_world *world, gneiss_record record) {
    record_place p = world ? find_record(world, record) : (record_place){NULL, NULL};
    size_t count = 0;
    if (p.record) active_field(p, SIZE_MAX, &count);
    return count;
}

gneiss_status gneiss_world_field_at(const gneiss_world *world, gneiss_record record, size_t index,
                                    gneiss_view *view, gneiss_error *error) {
    record_place p;
    size_t count;
    GN_TRY(require_record(world, record, &p, error));
    GN_TRY(gn_api_require(view, "view", error));
    const gn_field *field = active_field(p, index, &count);
    if (!field)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument index: expected less than %zu, the fields of %s, found %zu", count,
                       gneiss_record_name(record), index);
    fill_view(p, field, view);
    return GNEISS_OK;
}

gneiss_status gneiss_world_field(const gneiss_world *world, gneiss_record record, const char *name,
                                 gneiss_view *view, gneiss_error *error) {
    record_place p;
    name_list names = {0};
    GN_TRY(require_record(world, record, &p, error));
    GN_TRY(gn_api_require(name, "name", error));
    GN_TRY(gn_api_require(view, "view", error));
    for (size_t f = 0; f < p.record->field_count; f++) {
        const gn_field *field = &p.record->fields[f];
        if (!gn_field_data(field, p.soa)) continue;
        if (strcmp(field->name, name) == 0) {
            fill_view(p, field, view);
            return GNEISS_OK;
        }
        add_name(&names, field->name);
    }
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected a field of %s in this scene (%s), found '%.80s'",
                   gneiss_record_name(record), names.used ? names.text : "it has none", name);
}

gneiss_status gneiss_view_pin(const gneiss_view *view, gneiss_error *error) {
    GN_TRY(gn_api_require(view, "view", error));
    GN_TRY(gn_api_require(view->data, "view->data", error));
    return gn_pin(view->data) ? GNEISS_OK
                              : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to pin a view");
}

void gneiss_view_unpin(const void *data) {
    gn_unpin(data);
}

double gneiss_view_value(const gneiss_view *view, size_t item, size_t component) {
    if (!view || !view->data || item >= view->count || component >= (size_t)view->components)
        return NAN;
    const char *at =
        (const char *)view->data + item * view->item_stride + component * view->component_stride;
    switch (view->type) {
    case GNEISS_F64:
        return *(const double *)at;
    case GNEISS_I64:
        return (double)*(const int64_t *)at;
    case GNEISS_I32:
        return *(const int32_t *)at;
    case GNEISS_U8:
        return *(const uint8_t *)at;
    case GNEISS_F32:
        return (double)*(const float *)at;
    }
    return NAN;
}

/* --- history --- */

size_t gneiss_world_history_count(const gneiss_world *world) {
    return world ? world->run.history.column_count : 0;
}

static void fill_column(const gn_history *history, const gn_column *column, gneiss_view *view) {
    *view = (gneiss_view){
        .name = column->name,
        .unit = column->unit,
        .description = column->text,
        .type = GNEISS_F64,
        .components = 1,
        .count = history->row_count,
        .item_stride = sizeof(double),
        .component_stride = sizeof(double),
        .data = column->value,
    };
}

gneiss_status gneiss_world_history_at(const gneiss_world *world, size_t index, gneiss_view *view,
                                      gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(view, "view", error));
    const gn_history *history = &world->run.history;
    if (index >= history->column_count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument index: expected less than %zu, the columns of the history, found "
                       "%zu",
                       history->column_count, index);
    fill_column(history, &history->columns[index], view);
    return GNEISS_OK;
}

gneiss_status gneiss_world_history(const gneiss_world *world, const char *name, gneiss_view *view,
                                   gneiss_error *error) {
    name_list names = {0};
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(name, "name", error));
    GN_TRY(gn_api_require(view, "view", error));
    const gn_history *history = &world->run.history;
    for (size_t c = 0; c < history->column_count; c++) {
        if (strcmp(history->columns[c].name, name) == 0) {
            fill_column(history, &history->columns[c], view);
            return GNEISS_OK;
        }
        add_name(&names, history->columns[c].name);
    }
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected a column of the history (%s), found '%.80s'", names.text, name);
}

/* --- readings and energies --- */

static gneiss_status pick_at(const gneiss_quantity *all, size_t count, size_t index,
                             gneiss_quantity *out, gneiss_error *error) {
    GN_TRY(gn_api_require(out, "quantity", error));
    if (index >= count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument index: expected less than %zu, found %zu", count, index);
    *out = all[index];
    return GNEISS_OK;
}

static gneiss_status pick(const gneiss_quantity *all, size_t count, const char *name,
                          gneiss_quantity *out, gneiss_error *error) {
    name_list names = {0};
    GN_TRY(gn_api_require(name, "name", error));
    GN_TRY(gn_api_require(out, "quantity", error));
    for (size_t k = 0; k < count; k++) {
        if (strcmp(all[k].name, name) == 0) {
            *out = all[k];
            return GNEISS_OK;
        }
        add_name(&names, all[k].name);
    }
    return gn_fail(error, GNEISS_ERROR_INPUT, "expected one of %s; found '%.80s'", names.text,
                   name);
}

enum { READINGS = GN_READING_COUNT, ENERGIES = GN_ENERGY_FIGURES };

static gneiss_status list_readings(const gneiss_world *world, gneiss_quantity out[READINGS],
                                   gneiss_error *error) {
    const gn_readings *readings;
    GN_TRY(gn_run_readings(&world->run, &readings, error));
#define X(name, unit, text) *out++ = (gneiss_quantity){#name, unit, text, readings->name};
    GN_READINGS(X)
#undef X
    return GNEISS_OK;
}

static bool has_energies(const gneiss_world *world) {
    return world->run.world.ctx.effects & GN_FX_ENERGY && world->run.history.row_count;
}

static void list_energies(const gneiss_world *world, gneiss_quantity out[ENERGIES]) {
    const gn_world *w = &world->run.world;
    const bool known = has_energies(world);
    gn_energy_figure figure[ENERGIES];
    gn_energy_figures(&w->ledger.reading, figure);
    for (int k = 0; k < ENERGIES; k++)
        out[k] = (gneiss_quantity){figure[k].name, figure[k].unit, figure[k].text,
                                   known ? figure[k].value : NAN};
}

size_t gneiss_reading_count(void) {
    return READINGS;
}

gneiss_status gneiss_world_reading(const gneiss_world *world, const char *name,
                                   gneiss_quantity *reading, gneiss_error *error) {
    gneiss_quantity all[READINGS];
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(list_readings(world, all, error));
    return pick(all, READINGS, name, reading, error);
}

gneiss_status gneiss_world_reading_at(const gneiss_world *world, size_t index,
                                      gneiss_quantity *reading, gneiss_error *error) {
    gneiss_quantity all[READINGS];
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(list_readings(world, all, error));
    return pick_at(all, READINGS, index, reading, error);
}

size_t gneiss_energy_count(void) {
    return ENERGIES;
}

gneiss_status gneiss_world_energy(const gneiss_world *world, const char *name,
                                  gneiss_quantity *term, gneiss_error *error) {
    gneiss_quantity all[ENERGIES];
    GN_TRY(gn_api_require(world, "world", error));
    list_energies(world, all);
    return pick(all, ENERGIES, name, term, error);
}

gneiss_status gneiss_world_energy_at(const gneiss_world *world, size_t index, gneiss_quantity *term,
                                     gneiss_error *error) {
    gneiss_quantity all[ENERGIES];
    GN_TRY(gn_api_require(world, "world", error));
    list_energies(world, all);
    return pick_at(all, ENERGIES, index, term, error);
}

/* A ledger that was not measured in this process belongs to the last row of the history, if both
 * have the same residual. */
gneiss_status gneiss_world_energy_instant(const gneiss_world *world, int64_t *step, double *time,
                                          gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(step, "step", error));
    GN_TRY(gn_api_require(time, "time", error));
    const gn_ledger *ledger = &world->run.world.ledger;
    const gn_history *history = &world->run.history;
    *step = -1;
    *time = NAN;
    if (!has_energies(world)) return GNEISS_OK;
    if (ledger->measured_step > 0) {
        *step = ledger->measured_step - 1;
        *time = ledger->measured_time;
        return GNEISS_OK;
    }
    const size_t last = history->row_count - 1;
    if (gn_history_column(history, "energy_residual")[last] != gn_energy_residual(&ledger->reading))
        return GNEISS_OK;
    *step = (int64_t)gn_history_column(history, "step")[last];
    *time = gn_history_column(history, "time")[last];
    return GNEISS_OK;
}
