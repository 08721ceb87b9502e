/* What a run is to go through in time, as far as it can be foretold: the stages of the scene, or
 * all of it, each with the motions and loads of its scene (load_course.c). */
#ifndef GN_CONVERSION_LOAD_COURSE_H
#define GN_CONVERSION_LOAD_COURSE_H

#include "base/error.h"
#include "frame/parts.h"
#include "scene/scene.h"
#include "scene/stages.h"

#include <stdbool.h>
#include <stddef.h>

/* Who waits for rest is taken to wait for so many times what waves take along the body. */
#define GN_SETTLING 20.0

typedef struct gn_course_part {
    gn_scene *scene;   /* of the stage, its tables in times of the run; the world's in the first */
    double begin, end; /* s */
    double dt;         /* s: of a step of elements alone, */
    double later;      /* and with what has converted; 0: not tried */
    bool open;    /* it has an end that nothing tells beforehand: it may come before this one */
    bool guessed; /* only such: it is taken for over where waves have come to rest */
} gn_course_part;

typedef struct gn_course {
    size_t count;
    gn_course_part *part;
} gn_course;

/* Of a world that has not begun. `settle`, s: how long who waits for rest is taken to wait. */
gneiss_status gn_course_make(gn_world *world, double settle, gn_course *course,
                             gneiss_error *error);
void gn_course_free(gn_course *course);
/* s: of the last part. */
double gn_course_end(const gn_course *course);
/* m: of a component of a motion of elements, from the start to a time in a part. */
double gn_course_path(const gn_course *course, size_t part, size_t motion, size_t component,
                      double time);
/* The same of a wall that moves; one with a servo stays where it is. */
double gn_course_wall_path(const gn_course *course, size_t part, size_t wall, size_t component,
                           double time);
/* m/s: the most that a component of a motion changes by within a time, from rest. */
double gn_course_jump(const gn_course *course, double within);

#endif
