/* The part of a checkpoint that sources, sinks and lost particles have. */
#include "run/checkpoint_internal.h"

#include <stdint.h>

enum { ARRAYS_MOST = 4 };

_Static_assert(sizeof(gn_source_state) % 8 == 0 && sizeof(gn_sink_state) % 8 == 0 &&
                   sizeof(gn_lost) % 8 == 0,
               "made of doubles only");

/* Those that left the domain are there whether the scene has sinks or not. */
static size_t list_arrays(gn_world *w, gn_checkpoint_array out[ARRAYS_MOST]) {
    gn_flow *f = &w->dem.flow;
    size_t n = 0;
    out[n++] = (gn_checkpoint_array){"lost", GN_F64, f->lost_count, sizeof(gn_lost) / 8,
                                     (void **)&f->lost};
    if (!gn_scene_flows(&w->scene)) return n;
    out[n++] = (gn_checkpoint_array){"sources", GN_F64, w->scene.source_count,
                                     sizeof(gn_source_state) / 8, (void **)&f->sources};
    out[n++] = (gn_checkpoint_array){"sinks", GN_F64, w->scene.sink_count,
                                     sizeof(gn_sink_state) / 8, (void **)&f->sinks};
    /* Found of particles of which some are gone. */
    out[n++] = (gn_checkpoint_array){"loose", GN_U8, (size_t)w->dem.ids, 1, (void **)&w->dem.loose};
    return n;
}

gneiss_status gn_checkpoint_put_flow(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_world *w = (gn_world *)(uintptr_t)world; /* list_arrays hands out places to fill */
    gn_checkpoint_array arrays[ARRAYS_MOST];
    return gn_checkpoint_put_arrays(file, arrays, list_arrays(w, arrays), error);
}

gneiss_status gn_checkpoint_get_flow(gn_world *w, const gn_h5 *file, gneiss_error *error) {
    gn_checkpoint_array arrays[ARRAYS_MOST];
    GN_TRY(gn_h5_rows(file, "arrays/lost", &w->dem.flow.lost_count, error));
    w->dem.flow.lost_room = w->dem.flow.lost_count;
    return gn_checkpoint_get_arrays(file, arrays, list_arrays(w, arrays), error);
}
