/* The skin of particles that came without a shape: those that a ball of the mean radius can touch
 * from outside. Where its centre can be is a closed surface of pieces of spheres (Lee & Richards
 * 1971, J. Mol. Biol. 55, 379-400), whose normals go through the particles: its areas hold each
 * other in balance as they are. It lies a radius of the ball too far out; each component is scaled
 * such that the mean stress of the specimen's volume is the pressure. */
#include "sim/membrane.h"

#include "base/memory.h"
#include "neigh/pairs.h"
#include "sim/internal.h"

#include <math.h>

/* Directions that are looked at from each particle, by bits. */
enum { WORDS = 8, DIRECTIONS = 64 * WORDS };

typedef struct view {
    const gn_world *w;
    double probe; /* m: radius of the ball */
    double direction[DIRECTIONS][3];
    uint64_t *hidden; /* [particles][WORDS] */
} view;

/* Evenly over the sphere (Fibonacci's spiral) or the circle. */
static void set_directions(view *v) {
    const double golden = M_PI * (3.0 - sqrt(5.0));
    for (int k = 0; k < DIRECTIONS; k++) {
        double z = 1.0 - (2.0 * k + 1.0) / DIRECTIONS, angle = golden * k, rho = sqrt(1.0 - z * z);
        if (v->w->scene.dimension == 2) {
            z = 0.0;
            rho = 1.0;
            angle = 2.0 * M_PI * (k + 0.5) / DIRECTIONS;
        }
        v->direction[k][0] = rho * cos(angle);
        v->direction[k][1] = rho * sin(angle);
        v->direction[k][2] = z;
    }
}

/* The ball that touches i in a direction d would be in j: |s d - l| < t, s and t the distances at
 * which it touches them, l the way from i to j. */
static void hide(view *v, size_t i, size_t j) {
    const double *x = v->w->dem.particles.pos + 4 * i, *y = v->w->dem.particles.pos + 4 * j;
    double l[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]}, s = x[3] + v->probe, t = y[3] + v->probe;
    double limit = (s * s + gn_dot3(l, l) - t * t) / (2.0 * s);
    for (int k = 0; k < DIRECTIONS; k++)
        if (gn_dot3(v->direction[k], l) > limit)
            v->hidden[WORDS * i + (size_t)k / 64] |= UINT64_C(1) << (k % 64);
}

static gneiss_status look(view *v, gneiss_error *error) {
    const gn_particles *q = &v->w->dem.particles;
    gn_pair_query query = {.particles = q,
                           .dimension = (int)v->w->scene.dimension,
                           .margin = 2.0 * v->probe,
                           .threads = v->w->threads};
    gn_pair_list pairs = {0};
    v->hidden = gn_alloc_array(q->soa.count + 1, WORDS * sizeof *v->hidden);
    if (!v->hidden) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a skin");
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    for (size_t c = 0; c < pairs.count; c++) {
        hide(v, (size_t)pairs.pair[c][0], (size_t)pairs.pair[c][1]);
        hide(v, (size_t)pairs.pair[c][1], (size_t)pairs.pair[c][0]);
    }
    gn_pair_list_free(&pairs);
    return GNEISS_OK;
}

/* Areas of the free directions, and arms that end on the particles. */
static void collect(gn_world *w, const view *v, double (*arms)[9]) {
    gn_particles *q = &w->dem.particles;
    const bool space = w->scene.dimension == 3;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double radius = q->pos[4 * p + 3], reach = radius + v->probe;
        const double each = (space ? 4.0 * M_PI * reach * reach : 2.0 * M_PI * reach) / DIRECTIONS;
        for (int k = 0; k < DIRECTIONS; k++) {
            if (v->hidden[WORDS * p + (size_t)k / 64] >> (k % 64) & 1) continue;
            const double *d = v->direction[k];
            for (int a = 0; a < 3; a++) q->skin[4 * p + a] += each * d[a];
            q->skin[4 * p + 3] += each;
            for (int a = 0; a < 9; a++) arms[p][a] += each * radius * d[a / 3] * d[a % 3];
        }
    }
}

/* What a sum over directions leaves of the sum over the closed surface. */
static void close_surface(gn_particles *q) {
    double left[3] = {0}, size = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        size += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) left[a] += q->skin[4 * p + a];
    }
    for (size_t p = 0; p < q->soa.count && size > 0.0; p++)
        for (int a = 0; a < 3; a++) q->skin[4 * p + a] -= q->skin[4 * p + 3] / size * left[a];
}

/* Such that sum a x = V along each axis, x where the areas act: the mean stress is the pressure. */
static void scale(gn_world *w, double (*arms)[9]) {
    gn_particles *q = &w->dem.particles;
    double factor[3] = {1, 1, 1}, *most = &w->dem.membrane->hull;
    for (int a = 0; a < (int)w->scene.dimension; a++) {
        double sum = 0.0;
        for (size_t p = 0; p < q->soa.count; p++)
            sum += arms[p][4 * a] + q->skin[4 * p + a] * q->pos[4 * p + a];
        factor[a] = w->volume / sum;
        *most = fmax(*most, factor[a]);
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        double *s = q->skin + 4 * p;
        for (int a = 0; a < 9; a++) arms[p][a] *= factor[a / 3];
        for (int a = 0; a < 3; a++) s[a] *= factor[a];
        s[3] = s[3] > 0.0 ? sqrt(gn_dot3(s, s)) : 0.0;
    }
}

gneiss_status gn_membrane_free_skin(gn_world *w, double probe, double (*arms)[9],
                                    gneiss_error *error) {
    view v = {.w = w, .probe = probe};
    set_directions(&v);
    gneiss_status status = look(&v, error);
    if (status == GNEISS_OK) {
        collect(w, &v, arms);
        const double none[3] = {0};
        close_surface(&w->dem.particles);
        gn_membrane_balance(w, (gn_skin_body){0}, w->dem.particles.start, none);
        scale(w, arms);
        gn_membrane_balance(w, (gn_skin_body){0}, w->dem.particles.start,
                            none); /* of what unlike factors of the axes bring back */
    }
    gn_free(v.hidden);
    return status;
}
