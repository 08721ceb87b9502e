/* A list of the first problems of a scene, reported together. */
#ifndef GN_SCENE_PROBLEMS_H
#define GN_SCENE_PROBLEMS_H

#include "scene/tree.h"

#include <stdbool.h>

enum { GN_PROBLEMS_MAX = 12, GN_KEY_PATH_SIZE = 256 };

typedef struct gn_problem {
    gn_scene_place where;        /* line INT_MAX: it concerns an override */
    char path[GN_KEY_PATH_SIZE]; /* path of the key; for an unknown key, of the key that was
                                    probably intended */
    char text[GNEISS_MESSAGE_SIZE];
} gn_problem;

/* Zeroed initially. `at` is the place of the current message. */
typedef struct gn_problems {
    size_t count; /* number of all problems; the first GN_PROBLEMS_MAX are kept */
    gn_problem problem[GN_PROBLEMS_MAX];
    gn_scene_place at;
    char path[GN_KEY_PATH_SIZE];
} gn_problems;

/* Sets the place of the next message. */
void gn_problem_place(gn_problems *problems, gn_scene_place where, const char *path);

/* Joins all messages, ordered by place in the file, into one in `error`; GNEISS_OK if there are
 * none. */
gneiss_status gn_problems_status(gn_problems *problems, gneiss_error *error);

/* gn_problem_at: true if a problem concerns exactly this key; gn_problem_near: this key, or one
 * above or below it; gn_problem_names: the names in a list. If there were more problems than are
 * stored, the functions return true for every key. */
bool gn_problem_at(const gn_problems *problems, const char *path);
bool gn_problem_near(const gn_problems *problems, const char *path);
bool gn_problem_names(const gn_problems *problems, const char *list);

#endif
