/* Section of a box of walls, from which a servo that holds a stress gets its force. */
#include "scene/facing.h"

#include "base/vec3.h"

#include <math.h>

/* Tolerance on the cosine of a right angle, and on that of opposite normals. */
static const double slack = 1e-6;

static bool across(const double *first, const double *second) {
    return fabs(gn_dot3(first, second)) < slack;
}

/* Finds two walls that face each other and are orthogonal to `normal` and, if given, `other`. */
static bool find_pair(const gn_scene *scene, const double *normal, const double *other,
                      gn_facing *facing) {
    for (size_t i = 0; i < scene->wall_count; i++) {
        const double *n = scene->walls[i].normal;
        if (!across(n, normal) || (other && !across(n, other))) continue;
        for (size_t j = i + 1; j < scene->wall_count; j++) {
            if (gn_dot3(n, scene->walls[j].normal) > -1.0 + slack) continue;
            facing->pair[facing->count][0] = i;
            facing->pair[facing->count++][1] = j;
            return true;
        }
    }
    return false;
}

bool gn_wall_covers_open_axis(const gn_scene *scene, size_t wall) {
    const double *n = scene->walls[wall].normal;
    return gn_scene_half_periodic(scene) && fabs(n[scene->periodic_open]) > 1.0 - slack;
}

bool gn_facing_find(const gn_scene *scene, size_t wall, gn_facing *facing) {
    const double *normal = scene->walls[wall].normal;
    *facing = (gn_facing){0};
    if (!find_pair(scene, normal, NULL, facing)) return false;
    return scene->dimension == 2 ||
           find_pair(scene, normal, scene->walls[facing->pair[0][0]].normal, facing);
}
