/* When a run of one stage ends before its time (stops.c). */
#ifndef GN_SCENE_STOPS_H
#define GN_SCENE_STOPS_H

#include "scene/scene.h"

typedef struct gn_stops {
    double peak_drop;    /* share of its peak by which stress has fallen; 0: never by it */
    double strain;       /* reached; 0: never by it */
    bool by_kind;        /* the kind of the test says of the peak, which time.stop leaves to it */
    bool strain_by_kind; /* and of the strain */
} gn_stops;

/* What time.stop says of the test; where it says nothing at all, what tests of this kind end at;
 * where it says auto of the peak, their fall of stress beside what else it says.
 * Scenes with stages have none, each of which says when it ends,
 * and tests under control go on behind their peak. */
gn_stops gn_scene_stops(const gn_scene *scene);

/* By what share of its peak the stress has to fall for a test to be over: as gn_scene_stops says;
 * where it never ends by that, as tests of this kind do, or 0.5. */
double gn_scene_peak_drop(const gn_scene *scene);

/* "stress 0.5 below its peak or strain 0.2 (as shear tests end)"; "": none. */
const char *gn_stops_text(const gn_scene *scene, char *text, size_t size);

#endif
