/* The list of events (particles/events.h) and their bursts (particles/bursts.h) in results.h5, and
 * events in checkpoints. */
#define GN_EVERY_EFFECT /* the tables state what fields require, independent of the build */
#include "particles/bursts.h"
#include "run/checkpoint_internal.h"
#include "run/output_table.h"
#include "run/part_files.h"

#include "base/error.h"
#include "base/new.h"
#include "particles/events.h"
#include "soa/field.h"
#include "world/world.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* --- results.h5 --- */

typedef struct gn_events_view {
    const gn_events *events;
    const gn_bursts *bursts;
} gn_events_view;

#define READ(name, expression)                                                                     \
    static void read_##name(const void *view, size_t k, double *value) {                           \
        const gn_event *e = &((const gn_events_view *)view)->events->rows[k];                      \
        *value = (expression);                                                                     \
    }
READ(step, (double)e->step)
READ(time, e->time)
READ(first, e->i)
READ(second, e->j)
READ(x, e->place[0])
READ(y, e->place[1])
READ(z, e->place[2])
READ(cause, e->cause)
READ(energy, e->energy)

static void read_burst(const void *view, size_t k, double *value) {
    *value = ((const gn_events_view *)view)->bursts->of[k];
}

static const gn_output_field of_events[] = {
    {"step", "1", "steps done before the step of the event", GN_IN_RESULTS, GN_F64, false, 1,
     read_step, 0},
    {"time", "s", "instant of the forces of that step", GN_IN_RESULTS, GN_F64, false, 1, read_time,
     0},
    {"i", "1", "first particle of the bond, base 0, order of the specimen file", GN_IN_RESULTS,
     GN_I32, false, 1, read_first, 0},
    {"j", "1", "second particle", GN_IN_RESULTS, GN_I32, false, 1, read_second, 0},
    {"x", "m", "position of the contact", GN_IN_RESULTS, GN_F64, false, 1, read_x, 0},
    {"y", "m", "the same", GN_IN_RESULTS, GN_F64, false, 1, read_y, 0},
    {"z", "m", "the same", GN_IN_RESULTS, GN_F64, false, 1, read_z, 0},
    {"cause", "1",
     "1 broken in tension, 2 broken in shear; for the first time: 4 softened, 5 yielded",
     GN_IN_RESULTS, GN_U8, false, 1, read_cause, 0},
    {"energy", "J",
     "energy released by the break, with the ledger; the sum over all breaks is `bond_breaking`",
     GN_IN_RESULTS, GN_F64, false, 1, read_energy, GN_FX_ENERGY},
    {"burst", "1", "row of the burst of a break; -1: no break", GN_IN_RESULTS, GN_I32, false, 1,
     read_burst, 0},
};
const gn_output_table gn_event_outputs = {"events", of_events, COUNT(of_events)};

#undef READ
#define READ(name, expression)                                                                     \
    static void read_burst_##name(const void *view, size_t k, double *value) {                     \
        const gn_burst *b = &((const gn_bursts *)view)->row[k];                                    \
        *value = (expression);                                                                     \
    }
READ(time, b->time)
READ(duration, b->duration)
READ(size, b->size)
READ(tension, b->tension)
READ(x, b->place[0])
READ(y, b->place[1])
READ(z, b->place[2])
READ(energy, b->energy)
READ(magnitude, gn_burst_magnitude(b))

static const gn_output_field of_bursts[] = {
    {"time", "s", "instant of its first break", GN_IN_RESULTS, GN_F64, false, 1, read_burst_time,
     0},
    {"duration", "s", "time from its first to its last break", GN_IN_RESULTS, GN_F64, false, 1,
     read_burst_duration, 0},
    {"size", "1", "bonds broken in the burst", GN_IN_RESULTS, GN_I32, false, 1, read_burst_size, 0},
    {"tension", "1", "bonds broken in the burst in tension", GN_IN_RESULTS, GN_I32, false, 1,
     read_burst_tension, 0},
    {"x", "m", "mean position of its breaks", GN_IN_RESULTS, GN_F64, false, 1, read_burst_x, 0},
    {"y", "m", "the same", GN_IN_RESULTS, GN_F64, false, 1, read_burst_y, 0},
    {"z", "m", "the same", GN_IN_RESULTS, GN_F64, false, 1, read_burst_z, 0},
    {"energy", "J", "energy released by its breaks, with the ledger", GN_IN_RESULTS, GN_F64, false,
     1, read_burst_energy, GN_FX_ENERGY},
    {"magnitude", "1",
     "2/3 log10 of that energy over 1 J, less 3.2 (Scholz 2003); NaN: no energy released",
     GN_IN_RESULTS, GN_F64, true, 1, read_burst_magnitude, GN_FX_ENERGY},
};
const gn_output_table gn_burst_outputs = {"bursts", of_bursts, COUNT(of_bursts)};

gneiss_status gn_events_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_bursts bursts;
    if (!(world->ctx.effects & GN_FX_EVENTS)) return GNEISS_OK;
    gneiss_status status = gn_bursts_find(&world->ctx, &world->dem, &bursts, error);
    const gn_events_view view = {&world->dem.events, &bursts};
    const gn_output_source events = {
        &gn_event_outputs, &view, world->ctx.effects, world->dem.events.count, NULL, NULL, 0};
    const gn_output_source heard = {
        &gn_burst_outputs, &bursts, world->ctx.effects, bursts.count, NULL, NULL, 0};
    const gn_h5_attribute said[] = {{"reach", .number = &bursts.reach},
                                    {"window", .number = &bursts.window}};
    if (status == GNEISS_OK) status = gn_output_put(&events, file, error);
    if (status == GNEISS_OK) status = gn_output_put(&heard, file, error);
    if (status == GNEISS_OK) status = gn_h5_attributes(file, "bursts", said, COUNT(said), error);
    gn_bursts_free(&bursts);
    return status;
}

/* --- checkpoints --- */

static const struct {
    const char *name;
    gn_type type;
    size_t offset, components;
} columns[] = {
    {"events/step", GN_I64, offsetof(gn_event, step), 1},
    {"events/time", GN_F64, offsetof(gn_event, time), 1},
    {"events/place", GN_F64, offsetof(gn_event, place), 3},
    {"events/energy", GN_F64, offsetof(gn_event, energy), 1},
    {"events/i", GN_I32, offsetof(gn_event, i), 1},
    {"events/j", GN_I32, offsetof(gn_event, j), 1},
    {"events/cause", GN_I32, offsetof(gn_event, cause), 1},
};

gneiss_status gn_checkpoint_put_events(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    const gn_events *list = &world->dem.events;
    const gn_event none = {0};
    const char *rows = list->count ? (const char *)list->rows : (const char *)&none;
    for (size_t k = 0; world->ctx.effects & GN_FX_EVENTS && k < COUNT(columns); k++)
        GN_TRY(gn_h5_put(file, columns[k].name, columns[k].type, list->count, columns[k].components,
                         sizeof none, rows + columns[k].offset, NULL, NULL, error));
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_get_events(gn_world *world, const gn_h5 *file, const char *path,
                                       gneiss_error *error) {
    gn_events *list = &world->dem.events;
    if (!(world->ctx.effects & GN_FX_EVENTS)) return GNEISS_OK;
    size_t count = 0;
    GN_TRY(gn_h5_rows(file, columns[0].name, &count, error));
    GN_TRY(gn_new(&list->rows, count, "events", error));
    list->count = list->capacity = count;
    for (size_t k = 0; k < COUNT(columns); k++)
        GN_TRY(gn_h5_get(file, columns[k].name, columns[k].type, count, columns[k].components,
                         sizeof *list->rows, (char *)list->rows + columns[k].offset, error));
    for (size_t k = 0; k < count; k++)
        if (list->rows[k].cause < 0 || list->rows[k].cause > GN_EVENT_YIELD)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: events/cause: expected 0 to %d, found %d in row %zu", path,
                           GN_EVENT_YIELD, (int)list->rows[k].cause, k);
    return GNEISS_OK;
}
