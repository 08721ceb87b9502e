/* Stages of a run, executed one after the other. A stage consists of its changes, given by keys of
 * the scene, and of the conditions that end it. The scene of a stage is the base with all changes
 * up to this stage; it is read and checked like any other scene (stages.c). */
#ifndef GN_SCENE_STAGES_H
#define GN_SCENE_STAGES_H

#include "scene/scene.h"

#include <math.h>

typedef struct gn_stage {
    char name[GN_NAME_SIZE];
    double time;       /* s since the start of the stage; negative: no condition */
    int64_t steps;     /* steps since the start of the stage; negative: no condition */
    double strain;     /* strain of the test since the start of the stage; 0: no condition */
    double stress;     /* stress of the test, Pa; 0: no condition */
    double peak_drop;  /* fraction of the peak of stress in the stage; 0: no condition */
    double unbalanced; /* largest unbalanced force ratio; 0: no condition */
    double held; /* largest ratio of the force error of a servo to its target; 0: no condition */
    size_t change_size;
    char *changes; /* [change_size] changed keys as YAML, one per line, with the final NUL */
    gn_scene_place where;
} gn_stage;

/* True if the stage has a condition; the last stage needs none, because it ends at time.end. */
static inline bool gn_stage_has_end(const gn_stage *stage) {
    return stage->time >= 0 || stage->steps >= 0 || stage->strain > 0 || stage->stress > 0 ||
           stage->peak_drop > 0 || stage->unbalanced > 0 || stage->held > 0;
}

/* Returns the largest duration of a stage at a step, s; INFINITY: neither time nor steps bound it.
 */
static inline double gn_stage_length(const gn_stage *stage, double dt) {
    const double time = stage->time >= 0.0 ? stage->time : (double)INFINITY;
    return stage->steps >= 0 ? fmin(time, (double)stage->steps * dt) : time;
}

/* Makes the scene of a stage, index from 0, from a scene of gn_scene_parse or gn_scene_write.
 * Tables given in a stage count from its start (gn_table.stage). All places in the scene are that
 * of the stage. */
gneiss_status gn_scene_stage(const gn_scene *scene, size_t stage, gn_scene *out,
                             gneiss_error *error);

/* Returns the first condition of the stage that can never become true, because all ends are fixed
 * or separate, unless contacts have a force at the start; writes the reason to `why` [size]. NULL:
 * there is no such condition. `scene`: the scene of the stage. */
const char *gn_stage_never_ends(const gn_scene *scene, size_t stage, char *why, size_t size);

/* Calls `visit` for every table of the scene. */
void gn_scene_tables(gn_scene *scene, void (*visit)(void *context, gn_table *table), void *context);

/* gn_stage_may_change: true if a stage may change the key at a path such as walls.top.motion; a
 * star stands for any element. gn_stage_may_hold: also true if it may change a key below the path.
 */
bool gn_stage_may_change(const char *path);
bool gn_stage_may_hold(const char *path);

typedef struct gn_stops {
    double peak_drop; /* relative fall of stress from its peak; 0: no condition */
    double strain;    /* strain reached; 0: no condition */
    bool by_kind; /* peak_drop is that of the kind of test, because time.stop does not give one */
    bool strain_by_kind; /* strain is that of the kind of test */
} gn_stops;

/* Returns the conditions of time.stop; without time.stop, those of the kind of test; with
 * stop.peak_drop: auto, the fall of stress of the kind of test in addition to the other given
 * conditions. Scenes with stages have none, because each stage has its own end; neither have
 * controlled tests, which continue past their peak. */
gn_stops gn_scene_stops(const gn_scene *scene);

/* Tells whether a condition may end the run, or the stage if there are stages, before its time. */
bool gn_scene_may_end_early(const gn_scene *scene, size_t stage);

/* Returns the relative fall of stress from its peak that ends a test: that of gn_scene_stops,
 * otherwise that of the kind of test, otherwise 0.5. */
double gn_scene_peak_drop(const gn_scene *scene);

/* Writes "stress 0.5 below its peak or strain 0.2 (as shear tests end)"; "": none. */
const char *gn_stops_text(const gn_scene *scene, char *text, size_t size);

#endif
