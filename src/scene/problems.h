/* What is wrong with a scene, up to so many things at once. */
#ifndef GN_SCENE_PROBLEMS_H
#define GN_SCENE_PROBLEMS_H

#include "scene/tree.h"

#include <stdbool.h>

enum { GN_PROBLEMS_MAX = 12, GN_KEY_PATH_SIZE = 256 };

typedef struct gn_problem {
    gn_scene_place where;        /* line INT_MAX: of an override */
    char path[GN_KEY_PATH_SIZE]; /* of the key it is about; of an unknown one what it should be */
    char text[GNEISS_MESSAGE_SIZE];
} gn_problem;

/* Zeroed to begin with. `at` is where the message stands that is made now. */
typedef struct gn_problems {
    size_t count; /* all of them; the first GN_PROBLEMS_MAX are kept */
    gn_problem problem[GN_PROBLEMS_MAX];
    gn_scene_place at;
    char path[GN_KEY_PATH_SIZE];
} gn_problems;

/* Where the message stands that comes next. */
void gn_problem_place(gn_problems *problems, gn_scene_place where, const char *path);

/* Keeps the message in `error` if the status is GNEISS_ERROR_INPUT, so that reading can go on;
 * returns any other status as it is. */
gneiss_status gn_problem_keep(gn_problems *problems, gneiss_status status,
                              const gneiss_error *error);

/* All messages, by their places in the file, as one in `error`; GNEISS_OK when there are none. */
gneiss_status gn_problems_status(gn_problems *problems, gneiss_error *error);

/* Whether a problem is about the very key, or about anything at, above or below it; a list of
 * named elements has all its names. Where more problems came than are kept, anything may be wrong.
 */
bool gn_problem_at(const gn_problems *problems, const char *path);
bool gn_problem_near(const gn_problems *problems, const char *path);
bool gn_problem_names(const gn_problems *problems, const char *list);

#endif
