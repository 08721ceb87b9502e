/* The part of a checkpoint for sources, sinks and lost particles. */
#include "run/checkpoint_internal.h"

#include <stdint.h>

enum { ARRAYS_MOST = 4 };

_Static_assert(sizeof(gn_source_state) % 8 == 0 && sizeof(gn_sink_state) % 8 == 0 &&
                   sizeof(gn_lost) % 8 == 0,
               "made of doubles only");

/* Lists the arrays; particles that left the domain are recorded with or without sinks. */
static size_t list_arrays(gn_world *world, gn_checkpoint_array out[ARRAYS_MOST]) {
    gn_flow *f = &world->dem.flow;
    size_t n = 0;
    out[n++] = GN_CHECKPOINT_ARRAY("lost", GN_F64, f->lost_count, sizeof(gn_lost) / 8, &f->lost);
    if (!gn_scene_has_flow(&world->ctx.scene)) return n;
    out[n++] = GN_CHECKPOINT_ARRAY("sources", GN_F64, world->ctx.scene.source_count,
                                   sizeof(gn_source_state) / 8, &f->sources);
    out[n++] = GN_CHECKPOINT_ARRAY("sinks", GN_F64, world->ctx.scene.sink_count,
                                   sizeof(gn_sink_state) / 8, &f->sinks);
    /* arrays by id, because some of these particles have been removed */
    out[n++] = GN_CHECKPOINT_ARRAY("loose", GN_U8, (size_t)world->dem.ids, 1, &world->dem.loose);
    return n;
}

gneiss_status gn_checkpoint_put_flow(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_world *w =
        (gn_world *)(uintptr_t)world; /* list_arrays returns pointers that are not const */
    gn_checkpoint_array arrays[ARRAYS_MOST];
    return gn_checkpoint_put_arrays(file, arrays, list_arrays(w, arrays), error);
}

static bool is_count(double value) {
    return value >= 0.0 && value <= 0x1p53;
}

static gneiss_status check_flow(const gn_world *world, const char *path, gneiss_error *error) {
    const gn_flow *f = &world->dem.flow;
    bool good = true, flows = gn_scene_has_flow(&world->ctx.scene);
    for (size_t k = 0; k < f->lost_count; k++)
        good = good && f->lost[k].id >= 0.0 && f->lost[k].id < (double)world->dem.ids;
    for (size_t k = 0; flows && k < world->ctx.scene.source_count; k++) {
        const gn_source_state *s = &f->sources[k];
        good = good && is_count(s->number) && is_count(s->sizes) && is_count(s->places) &&
               is_count(s->full) && s->mass >= 0.0 && s->radius >= 0.0;
    }
    for (size_t k = 0; flows && k < world->ctx.scene.sink_count; k++)
        good = good && is_count(f->sinks[k].number) && f->sinks[k].mass >= 0.0;
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: arrays/lost, sources, sinks: expected numbers of particles, found "
                          "others",
                          path);
}

gneiss_status gn_checkpoint_get_flow(gn_world *world, const gn_h5 *file, const char *path,
                                     gneiss_error *error) {
    gn_checkpoint_array arrays[ARRAYS_MOST];
    GN_TRY(gn_h5_rows(file, "arrays/lost", &world->dem.flow.lost_count, error));
    GN_TRY(gn_checkpoint_get_arrays(file, arrays, list_arrays(world, arrays), error));
    return check_flow(world, path, error);
}
