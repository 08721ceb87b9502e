/* Conditions that end a run of one stage before time.end (stops.c). */
#ifndef GN_SCENE_STOPS_H
#define GN_SCENE_STOPS_H

#include "scene/scene.h"

typedef struct gn_stops {
    double peak_drop;    /* relative fall of stress from its peak; 0: no condition */
    double strain;       /* strain reached; 0: no condition */
    bool by_kind;        /* the kind of test gives peak_drop, because time.stop does not */
    bool strain_by_kind; /* the kind of test gives the strain */
} gn_stops;

/* Returns the conditions of time.stop; without time.stop, those of the kind of test; with
 * stop.peak_drop: auto, the fall of stress of the kind of test beside the other given conditions.
 * Scenes with stages have none, as each stage has its own end, and controlled tests continue past
 * their peak. */
gn_stops gn_scene_stops(const gn_scene *scene);

/* Returns the relative fall of stress from its peak that ends a test: that of gn_scene_stops; if
 * there is none, that of the kind of test, or 0.5. */
double gn_scene_peak_drop(const gn_scene *scene);

/* Writes "stress 0.5 below its peak or strain 0.2 (as shear tests end)"; "": none. */
const char *gn_stops_text(const gn_scene *scene, char *text, size_t size);

#endif
