#include "scene/stops.h"

#include "scene/manifest.h"

#include <stdio.h>

/* Half the peak is past what a strength is read off. Fracture energy is read once a tenth of the
 * load is left; with what rings in broken parts besides. What is sheared may hold most of its peak
 * by friction for as long as it is pressed. Others have no peak that they end at. */
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

gn_stops gn_scene_stops(const gn_scene *s) {
    const gn_stops given = {.peak_drop = s->stop_peak_drop > 0.0 ? s->stop_peak_drop : 0.0,
                            .strain = s->stop_strain};
    const bool said = s->stop_peak_drop >= 0.0 || s->stop_strain > 0.0 || s->stop_unbalanced > 0.0;
    /* Read in rows of the history: without any nothing is. What is controlled is followed down. */
    if (said || s->stage_count || !s->history_rows || s->test.has_control) return given;
    gn_stops stops = stops_of(s->test.kind);
    stops.by_kind = stops.peak_drop > 0.0 || stops.strain > 0.0;
    return stops;
}

const char *gn_stops_text(const gn_scene *s, char *text, size_t size) {
    const gn_stops stops = gn_scene_stops(s);
    int used = 0;
    *text = '\0';
    if (stops.peak_drop > 0.0)
        used = snprintf(text, size, "stress %g below its peak", stops.peak_drop);
    if (stops.strain > 0.0 && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sstrain %g", used ? " or " : "",
                         stops.strain);
    if (s->stop_unbalanced > 0.0 && !s->stage_count && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sunbalanced < %g", used ? " or " : "",
                         s->stop_unbalanced);
    if (stops.by_kind && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, " (as %s tests end; time.stop says otherwise)",
                 gn_choice_name(gn_scene_key_at("test.kind")->choices, (int)s->test.kind));
    return text;
}
