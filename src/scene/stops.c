#include "scene/stops.h"

#include "scene/manifest.h"

#include <stdio.h>

/* Half the peak suffices to read a strength. Fracture energy is read once a tenth of the load is
 * left, including the vibration of broken parts. A sheared specimen may keep most of its peak by
 * friction while it is loaded. Other tests have no peak that ends them. */
static gn_stops stops_of(gn_test_kind kind) {
    switch (kind) {
    case GN_TEST_COMPRESSION:
    case GN_TEST_BRAZILIAN:
    case GN_TEST_TRIAXIAL:
    case GN_TEST_BIAXIAL:
        return (gn_stops){.peak_drop = 0.5};
    case GN_TEST_TENSION:
    case GN_TEST_BENDING:
        return (gn_stops){.peak_drop = 0.95};
    case GN_TEST_SHEAR:
    case GN_TEST_SIMPLE_SHEAR:
        return (gn_stops){.peak_drop = 0.5, .strain = 0.2};
    case GN_TEST_NONE:
    case GN_TEST_HYDROSTATIC:
    case GN_TEST_OEDOMETER:
    case GN_TEST_KINDS:
        break;
    }
    return (gn_stops){0};
}

gn_stops gn_scene_stops(const gn_scene *scene) {
    gn_stops stops = {.peak_drop = scene->stop_peak_drop > 0.0 ? scene->stop_peak_drop : 0.0,
                      .strain = scene->stop_strain};
    /* Conditions are evaluated in rows of the history, so that none holds without a history. A
     * controlled test continues past its peak. */
    if (scene->stop_peak_drop >= 0.0 || scene->stage_count || !scene->history_rows ||
        scene->test.has_control)
        return stops;
    const gn_stops by_kind = stops_of(scene->test.kind);
    const bool said = scene->stop_strain > 0.0 || scene->stop_unbalanced > 0.0;
    stops.peak_drop = by_kind.peak_drop;
    if (!said) stops.strain = by_kind.strain;
    stops.by_kind = by_kind.peak_drop > 0.0;
    stops.strain_by_kind = !said && by_kind.strain > 0.0;
    return stops;
}

double gn_scene_peak_drop(const gn_scene *scene) {
    const double asked = gn_scene_stops(scene).peak_drop,
                 by_kind = stops_of(scene->test.kind).peak_drop;
    return asked > 0.0 ? asked : by_kind > 0.0 ? by_kind : 0.5;
}

static const char *name_of(const gn_scene *scene) {
    return gn_choice_name(gn_scene_key_at("test.kind")->choices, (int)scene->test.kind);
}

const char *gn_stops_text(const gn_scene *scene, char *text, size_t size) {
    const gn_stops stops = gn_scene_stops(scene);
    const bool said = scene->stop_strain > 0.0 || scene->stop_unbalanced > 0.0;
    int used = 0;
    *text = '\0';
    if (stops.peak_drop > 0.0)
        used = snprintf(text, size, "stress %g below its peak", stops.peak_drop);
    if (stops.by_kind && said && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, ", as %s tests end,", name_of(scene));
    if (stops.strain > 0.0 && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sstrain %g", used ? " or " : "",
                         stops.strain);
    if (scene->stop_unbalanced > 0.0 && !scene->stage_count && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sunbalanced < %g", used ? " or " : "",
                         scene->stop_unbalanced);
    if (stops.by_kind && !said && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, " (as %s tests end; time.stop says otherwise)",
                 name_of(scene));
    return text;
}
