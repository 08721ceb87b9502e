/* Stages: a run goes through them one after the other. A stage says what it changes, with the keys
 * of the scene, and when it ends. Each is the scene with all changes laid over it up to its own,
 * read and checked like any other scene (stages.c). */
#ifndef GN_SCENE_STAGES_H
#define GN_SCENE_STAGES_H

#include "scene/scene.h"

typedef struct gn_stage {
    char name[GN_NAME_SIZE];
    double time;       /* s since it began; negative: no condition */
    int64_t steps;     /* the same; negative: none */
    double strain;     /* of the test, since it began; 0: none */
    double stress;     /* of the test, Pa; 0: none */
    double peak_drop;  /* fraction of the stage's peak of stress; 0: none */
    double unbalanced; /* ratio to fall below; 0: none */
    double held;       /* share of the wanted force that no servo misses by more; 0: none */
    size_t change_size;
    char *changes; /* [change_size] what it changes, as YAML, a key a line; with its NUL */
    gn_scene_place where;
} gn_stage;

/* Whether it names a condition; the last one need not, time.end is its end. */
static inline bool gn_stage_has_end(const gn_stage *stage) {
    return stage->time >= 0 || stage->steps >= 0 || stage->strain > 0 || stage->stress > 0 ||
           stage->peak_drop > 0 || stage->unbalanced > 0 || stage->held > 0;
}

/* The scene of a stage, base 0, from one that gn_scene_parse or gn_scene_write gave: of its tables
 * those that stages give count from their own start (gn_table.stage). Places in it are that of the
 * stage. */
gneiss_status gn_scene_stage(const gn_scene *scene, size_t stage, gn_scene *out,
                             gneiss_error *error);

/* The condition of the first stage that never comes true unless contacts begin with a force, as
 * nothing acts but ends that stand or part, and why, `why` [size]; NULL: it is not so. `scene`: of
 * that stage. */
const char *gn_stage_waits(const gn_scene *scene, size_t stage, char *why, size_t size);

/* Calls `visit` for every table of the scene. */
void gn_scene_tables(gn_scene *scene, void (*visit)(void *context, gn_table *table), void *context);

#endif
