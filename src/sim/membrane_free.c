/* The skin of particles that came without a shape: those that a ball of the mean radius can touch
 * from outside. Where its centre can be is a closed surface of pieces of spheres (Lee & Richards
 * 1971, J. Mol. Biol. 55, 379-400), whose normals go through the particles: its areas hold each
 * other in balance as they are. It lies a radius of the ball too far out; each component is scaled
 * such that the mean stress of the specimen's volume is the pressure. Bodies between which the ball
 * passes have surfaces, and volumes, of their own; a particle by itself is pressed from all sides
 * alike, which is not at all, and so are particles in a row or (in space) in one layer, whose shape
 * tells nothing of how it turns and stretches. */
#include "sim/membrane.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "measure/measure.h"
#include "neigh/pairs.h"
#include "pack/spheres.h"
#include "sim/internal.h"

#include <math.h>
#include <string.h>

/* Directions that are looked at from each particle, by bits. */
enum { WORDS = 8, DIRECTIONS = 64 * WORDS };

typedef struct view {
    const gn_world *w;
    double probe; /* m: radius of the ball */
    double direction[DIRECTIONS][3];
    uint64_t *hidden; /* [particles][WORDS] */
    int32_t *body;    /* [particles] one that stands for what the ball does not pass between */
    int32_t *members; /* [particles] of the body that one stands for */
    size_t bodies;
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

static int32_t standing_for(int32_t *body, int32_t p) {
    while (body[p] != p) p = body[p] = body[body[p]];
    return p;
}

static void join(view *v, int32_t i, int32_t j) {
    const int32_t a = standing_for(v->body, i), b = standing_for(v->body, j);
    v->body[a > b ? a : b] = a > b ? b : a;
}

static void count_bodies(view *v) {
    const size_t n = v->w->dem.particles.soa.count;
    for (size_t p = 0; p < n; p++) v->members[v->body[p] = standing_for(v->body, (int32_t)p)]++;
    for (size_t p = 0; p < n; p++) v->bodies += v->members[p] > 0;
}

static gneiss_status look(view *v, gneiss_error *error) {
    const gn_particles *q = &v->w->dem.particles;
    gn_pair_query query = {.particles = q,
                           .dimension = (int)v->w->scene.dimension,
                           .margin = 2.0 * v->probe,
                           .threads = v->w->threads};
    gn_pair_list pairs = {0};
    v->hidden = gn_alloc_array(q->soa.count + 1, WORDS * sizeof *v->hidden);
    v->body = gn_alloc_array(q->soa.count + 1, sizeof *v->body);
    v->members = gn_alloc_array(q->soa.count + 1, sizeof *v->members);
    if (!v->hidden || !v->body || !v->members)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a skin");
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    for (size_t p = 0; p < q->soa.count; p++) v->body[p] = (int32_t)p;
    for (size_t c = 0; c < pairs.count; c++) {
        hide(v, (size_t)pairs.pair[c][0], (size_t)pairs.pair[c][1]);
        hide(v, (size_t)pairs.pair[c][1], (size_t)pairs.pair[c][0]);
        join(v, pairs.pair[c][0], pairs.pair[c][1]);
    }
    gn_pair_list_free(&pairs);
    count_bodies(v);
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
static void close_surface(gn_particles *q, gn_skin_body body) {
    double left[3] = {0}, size = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_of(body, p)) continue;
        size += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) left[a] += q->skin[4 * p + a];
    }
    for (size_t p = 0; p < q->soa.count && size > 0.0; p++)
        for (int a = 0; a < 3 && gn_is_of(body, p); a++)
            q->skin[4 * p + a] -= q->skin[4 * p + 3] / size * left[a];
}

/* Such that sum a x = V along each axis, x where the areas act: the mean stress is the pressure. */
static void scale(gn_world *w, gn_skin_body body, double volume, double (*arms)[9]) {
    gn_particles *q = &w->dem.particles;
    double factor[3] = {1, 1, 1}, *most = &w->dem.membrane->hull;
    for (int a = 0; a < (int)w->scene.dimension; a++) {
        double sum = 0.0;
        for (size_t p = 0; p < q->soa.count; p++)
            if (gn_is_of(body, p)) sum += arms[p][4 * a] + q->skin[4 * p + a] * q->pos[4 * p + a];
        factor[a] = volume / sum;
        *most = fmax(*most, factor[a]);
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        double *s = q->skin + 4 * p;
        if (!gn_is_of(body, p)) continue;
        for (int a = 0; a < 9; a++) arms[p][a] *= factor[a / 3];
        for (int a = 0; a < 3; a++) s[a] *= factor[a];
        s[3] = s[3] > 0.0 ? sqrt(gn_dot3(s, s)) : 0.0;
    }
}

/* Of one of several bodies: that of its own hull. */
static gneiss_status volume_of(const gn_world *w, gn_skin_body body, size_t members, double *volume,
                               gneiss_error *error) {
    const gn_particles *q = &w->dem.particles;
    gn_particles own;
    double lower[3], upper[3], *row = gn_alloc_array(members + 1, 4 * sizeof *row);
    size_t count = 0;
    if (!row) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of a skin");
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_is_of(body, p)) memcpy(row + 4 * count++, q->pos + 4 * p, 4 * sizeof *row);
    gneiss_status status = gn_particles_of_spheres(row, members, &own, error);
    gn_free(row);
    GN_TRY(status);
    status = gn_packing_hull(&own, (int)w->scene.dimension, volume, lower, upper, error);
    gn_soa_destroy(&gn_particle_record, &own);
    return status;
}

static gneiss_status finish(gn_world *w, gn_skin_body body, size_t members, double (*arms)[9],
                            gneiss_error *error) {
    const double none[3] = {0};
    const double *place = w->dem.particles.start;
    double volume = w->volume;
    if (body.group) GN_TRY(volume_of(w, body, members, &volume, error));
    close_surface(&w->dem.particles, body);
    gn_membrane_balance(w, body, place, none);
    scale(w, body, volume, arms);
    gn_membrane_balance(w, body, place, none); /* of what unlike factors bring back */
    return GNEISS_OK;
}

/* Whether the places of a body lie in more than a row (2D) or a layer (3D). */
static bool spans(const gn_world *w, gn_skin_body body) {
    const gn_particles *q = &w->dem.particles;
    const int d = (int)w->scene.dimension;
    double count = 0.0, mean[3] = {0}, second[9] = {0}, values[3], vectors[9];
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_of(body, p)) continue;
        for (int a = 0; a < d; a++) mean[a] += q->start[4 * p + a];
        count += 1.0;
    }
    for (size_t p = 0; p < q->soa.count; p++)
        for (int k = 0; k < d * d && gn_is_of(body, p); k++)
            second[k] += (q->start[4 * p + k / d] - mean[k / d] / count) *
                         (q->start[4 * p + k % d] - mean[k % d] / count);
    gn_eigen_symmetric(d, second, values, vectors);
    return values[d - 1] > 1e-6 * values[0];
}

static void leave_unpressed(gn_world *w, gn_skin_body body, double (*arms)[9]) {
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_of(body, p)) continue;
        memset(q->skin + 4 * p, 0, 4 * sizeof *q->skin);
        memset(arms[p], 0, sizeof arms[p]);
    }
}

static gneiss_status finish_all(gn_world *w, const view *v, double (*arms)[9],
                                gneiss_error *error) {
    const size_t n = w->dem.particles.soa.count;
    bool pressed = false;
    for (size_t p = 0; p < n; p++) {
        const gn_skin_body body = {v->bodies == 1 ? NULL : v->body, (int32_t)p};
        if (!v->members[p]) continue;
        if (spans(w, body)) {
            GN_TRY(finish(w, body, (size_t)v->members[p], arms, error));
            pressed = true;
        } else {
            leave_unpressed(w, body, arms);
        }
    }
    if (pressed || !n) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected particles that enclose a volume, found %s",
                   gn_scene_at(&w->scene, w->scene.membrane.where, "membrane").text,
                   w->scene.dimension == 3 ? "none but such by themselves, in rows or in one layer"
                                           : "none but such by themselves or in rows");
}

gneiss_status gn_membrane_free_skin(gn_world *w, double probe, double (*arms)[9],
                                    gneiss_error *error) {
    view v = {.w = w, .probe = probe};
    set_directions(&v);
    gneiss_status status = look(&v, error);
    if (status == GNEISS_OK) {
        collect(w, &v, arms);
        status = finish_all(w, &v, arms, error);
    }
    gn_free(v.hidden);
    gn_free(v.body);
    gn_free(v.members);
    return status;
}
