#include "run/output_flow.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- lost particles --- */

gneiss_status gn_output_lost(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    const gn_flow *f = &w->dem.flow;
    const size_t row = sizeof(gn_lost);
    if (!f->lost_count) return GNEISS_OK;
    GN_TRY(gn_h5_put(file, "lost/id", GN_F64, f->lost_count, 1, row, &f->lost->id, "1",
                     "particle that left the domain, base 0", error));
    GN_TRY(gn_h5_put(file, "lost/time", GN_F64, f->lost_count, 1, row, &f->lost->time, "s",
                     "time at which that was detected", error));
    GN_TRY(gn_h5_put(file, "lost/position", GN_F64, f->lost_count, 3, row, f->lost->place, "m",
                     "centre then", error));
    return gn_h5_put(file, "lost/velocity", GN_F64, f->lost_count, 3, row, f->lost->velocity, "m/s",
                     "velocity then", error);
}

/* --- flow through sources and sinks --- */

/* Returns the slope of a straight line through rows [begin, end). */
static double slope(const double *t, const double *m, size_t begin, size_t end) {
    double n = (double)(end - begin), st = 0.0, sm = 0.0, stt = 0.0, stm = 0.0;
    for (size_t r = begin; r < end; r++) {
        st += t[r] / n;
        sm += m[r] / n;
    }
    for (size_t r = begin; r < end; r++) {
        stt += (t[r] - st) * (t[r] - st);
        stm += (t[r] - st) * (m[r] - sm);
    }
    return stm / stt;
}

/* The first quarter contains the onset, the last one the end of the supply. */
double gn_sink_steady_rate(const gn_history *h, const char *sink) {
    enum { ROWS_LEAST = 5 };
    char name[192];
    snprintf(name, sizeof name, "sink_%s_mass", sink);
    const double *mass = gn_history_column(h, name), *time = gn_history_column(h, "time");
    size_t begin = 0, end = h->row_count;
    if (!mass || !time || end == 0) return NAN;
    double all = mass[end - 1];
    while (begin < end && mass[begin] < 0.25 * all) begin++;
    while (end > begin && mass[end - 1] > 0.75 * all) end--;
    if (!(all > 0.0) || end < begin + ROWS_LEAST) return NAN;
    return slope(time, mass, begin, end);
}

/* Writes the keys that sources and sinks share; the entry stays open. */
static void begin_entry(gn_json *j, const char *name, double number, double mass, double energy) {
    gn_json_object(j, NULL);
    gn_json_text(j, "name", name);
    gn_json_integer(j, "number", (int64_t)number);
    gn_json_number(j, "mass", mass);
    gn_json_number(j, "energy", energy);
}

void gn_output_flow(const gn_run *run, gn_json *j) {
    const gn_world *w = &run->world;
    if (!gn_scene_has_flow(&w->ctx.scene)) return;
    gn_json_array(j, "sources");
    for (size_t k = 0; k < w->ctx.scene.source_count; k++) {
        const gn_source_state *s = &w->dem.flow.sources[k];
        begin_entry(j, w->ctx.scene.sources[k].name, s->number, s->mass, s->energy);
        gn_json_number(j, "behind", gn_flow_behind(&w->ctx, &w->dem, k));
        gn_json_integer(j, "without_room", (int64_t)s->full);
        gn_json_end(j);
    }
    gn_json_end(j);
    gn_json_array(j, "sinks");
    for (size_t k = 0; k < w->ctx.scene.sink_count; k++) {
        const gn_sink_state *s = &w->dem.flow.sinks[k];
        begin_entry(j, w->ctx.scene.sinks[k].name, s->number, s->mass, s->energy);
        gn_json_number(j, "steady_rate",
                       gn_sink_steady_rate(&run->history, w->ctx.scene.sinks[k].name));
        gn_json_end(j);
    }
    gn_json_end(j);
}
