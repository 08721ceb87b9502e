#include "scene/stops.h"

#include <stdio.h>

gn_stops gn_scene_stops(const gn_scene *scene) {
    gn_stops stops = {.peak_drop = scene->stop_peak_drop > 0.0 ? scene->stop_peak_drop : 0.0,
                      .strain = scene->stop_strain};
    /* Conditions are evaluated in rows of the history, so that none holds without a history. A
     * controlled test continues past its peak. */
    if (scene->stop_peak_drop >= 0.0 || scene->stage_count || !scene->history_rows ||
        scene->test.has_control)
        return stops;
    const gn_test_descriptor *by_kind = gn_scene_test(scene);
    const bool said = scene->stop_strain > 0.0 || scene->stop_unbalanced > 0.0;
    stops.peak_drop = by_kind->peak_drop;
    if (!said) stops.strain = by_kind->strain;
    stops.by_kind = by_kind->peak_drop > 0.0;
    stops.strain_by_kind = !said && by_kind->strain > 0.0;
    return stops;
}

double gn_scene_peak_drop(const gn_scene *scene) {
    const double asked = gn_scene_stops(scene).peak_drop, by_kind = gn_scene_test(scene)->peak_drop;
    return asked > 0.0 ? asked : by_kind > 0.0 ? by_kind : 0.5;
}

const char *gn_stops_text(const gn_scene *scene, char *text, size_t size) {
    const gn_stops stops = gn_scene_stops(scene);
    const bool said = scene->stop_strain > 0.0 || scene->stop_unbalanced > 0.0;
    int used = 0;
    *text = '\0';
    if (stops.peak_drop > 0.0)
        used = snprintf(text, size, "stress %g below its peak", stops.peak_drop);
    if (stops.by_kind && said && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, ", as %s tests end,",
                         gn_scene_test(scene)->name);
    if (stops.strain > 0.0 && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sstrain %g", used ? " or " : "",
                         stops.strain);
    if (scene->stop_unbalanced > 0.0 && !scene->stage_count && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sunbalanced < %g", used ? " or " : "",
                         scene->stop_unbalanced);
    if (stops.by_kind && !said && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, " (as %s tests end; time.stop says otherwise)",
                 gn_scene_test(scene)->name);
    return text;
}
