#include "world/space.h"

#include "laboratory/ends.h"
#include "membrane/membrane.h"
#include "world/internal.h"

#include <math.h>

/* Distances of two walls, or of the sides of a periodic box, along an axis, m. */
typedef struct span {
    double lower, upper; /* where they are now */
    double now, start;   /* 0: there are none */
} span;

static int find_wall(const gn_scene *s, int axis, double sense) {
    for (size_t k = 0; k < s->wall_count; k++)
        if (sense * s->walls[k].normal[axis] > 0.999) return (int)k;
    return -1;
}

/* m: by which a wall is where it began. */
static double moved(const gn_world *w, int wall, int axis) {
    if (!w->boundary.walls) return 0.0;
    return w->boundary.walls[wall].point[axis] - w->boundary.walls[wall].start[axis];
}

static span span_along(const gn_world *w, int axis) {
    const gn_scene *s = &w->scene;
    if (gn_scene_periodic_along(s, axis))
        return (span){-INFINITY, INFINITY, w->period[axis], w->box.start[axis]};
    const int lower = find_wall(s, axis, 1.0), upper = find_wall(s, axis, -1.0);
    if (lower < 0 || upper < 0) return (span){0};
    const double low = s->walls[lower].point[axis], high = s->walls[upper].point[axis];
    span x = {low + moved(w, lower, axis), high + moved(w, upper, axis), 0.0, high - low};
    x.now = x.upper - x.lower;
    return x;
}

/* Of particles that move, radii included. */
static bool extent_along(const gn_world *w, int axis, double *lower, double *upper) {
    const gn_particles *q = &w->dem.particles;
    *lower = INFINITY;
    *upper = -INFINITY;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        const double *x = q->pos + 4 * p;
        *lower = fmin(*lower, x[axis] - x[3]);
        *upper = fmax(*upper, x[axis] + x[3]);
    }
    return *lower < *upper;
}

/* m: walls that are farther away than this have more than the specimen between them. Loose grains
 * may be as far from walls as from each other. */
static double allowed_gap(const gn_world *w, double between) {
    if (w->effects & GN_FX_BONDS) return gn_world_mean_radius(w);
    return pow(between / (double)gn_world_present(w), 1.0 / (double)w->scene.dimension);
}

bool gn_space_closed(const gn_world *w, double *now, double *start) {
    const int dimension = (int)w->scene.dimension;
    span side[3];
    *now = *start = 1.0;
    if (!w->scene.has_specimen || !gn_world_present(w)) return false;
    for (int a = 0; a < dimension; a++) {
        side[a] = span_along(w, a);
        if (!(side[a].now > 0.0 && side[a].start > 0.0)) return false;
        *now *= side[a].now;
        *start *= side[a].start;
    }
    const double allowed = allowed_gap(w, *now);
    for (int a = 0; a < dimension; a++) {
        double lower, upper;
        if (gn_scene_periodic_along(&w->scene, a)) continue;
        if (!extent_along(w, a, &lower, &upper)) return false;
        if (lower - side[a].lower > allowed || side[a].upper - upper > allowed) return false;
    }
    return true;
}

static bool is_periodic_all_round(const gn_world *w) {
    return w->effects & GN_FX_PERIODIC && !gn_scene_half_periodic(&w->scene);
}

/* How a membrane has changed what it encloses; several bodies under one move apart. */
static double membrane_growth(const gn_world *w) {
    const double *f = w->dem.membrane->gradient;
    double cofactor[9];
    if (w->dem.membrane->bodies != 1.0) return 1.0;
    gn_cofactor3(f, cofactor);
    const double growth = gn_dot3(f, cofactor);
    return growth > 0.0 ? growth : 1.0;
}

double gn_space_volume(const gn_world *w) {
    double now, start;
    if (w->dem.membrane) return gn_membrane_volume(w) * membrane_growth(w);
    if (is_periodic_all_round(w) || !w->scene.has_specimen) return w->volume;
    if (gn_space_closed(w, &now, &start))
        return w->effects & GN_FX_BONDS ? w->volume * now / start : now;
    if (gn_scene_test(&w->scene)->sides_stand)
        return w->volume * (1.0 - gn_ends_shortening(w) / w->test_length);
    return w->volume;
}

double gn_space_area(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    const gn_test_descriptor *d = gn_scene_test(&w->scene);
    double now, start;
    if (d->periodic_sides) return gn_box_section(w);
    if (!d->prism || t->given.area > 0.0 || t->given.diameter > 0.0) return w->test_area;
    if (w->dem.membrane || !gn_space_closed(w, &now, &start)) return w->test_area;
    const span along = span_along(w, (int)t->axis);
    if (!(w->effects & GN_FX_BONDS)) return now / along.now;
    return w->test_area * (now / along.now) / (start / along.start);
}
