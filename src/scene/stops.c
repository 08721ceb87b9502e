#include "scene/stops.h"

#include <stdio.h>

gn_stops gn_scene_stops(const gn_scene *s) {
    gn_stops stops = {.peak_drop = s->stop_peak_drop > 0.0 ? s->stop_peak_drop : 0.0,
                      .strain = s->stop_strain};
    /* Read in rows of the history: without any nothing is. What is controlled is followed down. */
    if (s->stop_peak_drop >= 0.0 || s->stage_count || !s->history_rows || s->test.has_control)
        return stops;
    const gn_test_descriptor *by_kind = gn_scene_test(s);
    const bool said = s->stop_strain > 0.0 || s->stop_unbalanced > 0.0;
    stops.peak_drop = by_kind->peak_drop;
    if (!said) stops.strain = by_kind->strain;
    stops.by_kind = by_kind->peak_drop > 0.0;
    stops.strain_by_kind = !said && by_kind->strain > 0.0;
    return stops;
}

double gn_scene_peak_drop(const gn_scene *s) {
    const double asked = gn_scene_stops(s).peak_drop, by_kind = gn_scene_test(s)->peak_drop;
    return asked > 0.0 ? asked : by_kind > 0.0 ? by_kind : 0.5;
}

const char *gn_stops_text(const gn_scene *s, char *text, size_t size) {
    const gn_stops stops = gn_scene_stops(s);
    const bool said = s->stop_strain > 0.0 || s->stop_unbalanced > 0.0;
    int used = 0;
    *text = '\0';
    if (stops.peak_drop > 0.0)
        used = snprintf(text, size, "stress %g below its peak", stops.peak_drop);
    if (stops.by_kind && said && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, ", as %s tests end,",
                         gn_scene_test(s)->name);
    if (stops.strain > 0.0 && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sstrain %g", used ? " or " : "",
                         stops.strain);
    if (s->stop_unbalanced > 0.0 && !s->stage_count && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sunbalanced < %g", used ? " or " : "",
                         s->stop_unbalanced);
    if (stops.by_kind && !said && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, " (as %s tests end; time.stop says otherwise)",
                 gn_scene_test(s)->name);
    return text;
}
