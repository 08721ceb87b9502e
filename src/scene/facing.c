/* The section of a box of walls, by which a servo that holds a stress knows its force. */
#include "scene/facing.h"

#include "base/vec3.h"

#include <math.h>

/* Cosine of what counts as a right angle, and what opposite normals may miss. */
static const double slack = 1e-6;

static bool across(const double *a, const double *b) {
    return fabs(gn_dot3(a, b)) < slack;
}

/* Two walls that face each other across the direction of `normal` and, if given, of `other`. */
static bool find_pair(const gn_scene *s, const double *normal, const double *other, gn_facing *f) {
    for (size_t i = 0; i < s->wall_count; i++) {
        const double *n = s->walls[i].normal;
        if (!across(n, normal) || (other && !across(n, other))) continue;
        for (size_t j = i + 1; j < s->wall_count; j++) {
            if (gn_dot3(n, s->walls[j].normal) > -1.0 + slack) continue;
            f->pair[f->count][0] = i;
            f->pair[f->count++][1] = j;
            return true;
        }
    }
    return false;
}

bool gn_wall_closes_box(const gn_scene *s, size_t wall) {
    const double *n = s->walls[wall].normal;
    return gn_scene_half_periodic(s) && fabs(n[s->periodic_open]) > 1.0 - slack;
}

bool gn_facing_find(const gn_scene *s, size_t wall, gn_facing *f) {
    const double *normal = s->walls[wall].normal;
    *f = (gn_facing){0};
    if (!find_pair(s, normal, NULL, f)) return false;
    return s->dimension == 2 || find_pair(s, normal, s->walls[f->pair[0][0]].normal, f);
}
