/* What a conversion keeps. The particles of an element do not weigh quite what it does, nor have
 * they its centre of mass: masses of who has another weight than before are scaled by 1 + a + b.(x
 * - x0), so that both are kept; a rigid motion then keeps its momentum by itself. What is left of
 * any other is made up by a uniform velocity of who moves by itself from now on. */
#include "sim/conversion_internal.h"

#include <math.h>
#include <string.h>

static void add(gn_tally *t, double mass, const double *x, const double *v) {
    t->mass += mass;
    for (int a = 0; a < 3; a++) {
        t->moment[a] += mass * x[a];
        t->momentum[a] += mass * v[a];
    }
    t->energy += 0.5 * mass * gn_dot3(v, v);
}

/* Who does not move by itself. */
static void mark_tied(const gn_conversion *c) {
    const gn_dem *d = &c->world->dem;
    const gn_ties *ties = &((const gn_coupled *)c->world->exchange[0].context)->ties;
    memset(c->tied, 0, d->particles.soa.count);
    for (size_t k = 0; k < ties->count; k++)
        if (d->index_of_id[ties->tie[k].id] >= 0) c->tied[d->index_of_id[ties->tie[k].id]] = 1;
}

gn_tally gn_conversion_tally(const gn_conversion *c) {
    const gn_world *w = c->world;
    const gn_particles *q = &w->dem.particles, *nodes = &gn_coupled_solid(w)->nodes;
    const gn_coupled *coupled = w->exchange[0].context;
    gn_tally t = {0};
    mark_tied(c);
    for (size_t n = 0; n < nodes->soa.count; n++)
        if (nodes->vel[4 * n + 3] > 0.0)
            add(&t, 1.0 / nodes->vel[4 * n + 3], nodes->pos + 4 * n, nodes->vel + 4 * n);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        const bool moves = !c->tied[p];
        if (moves) add(&t, 1.0 / q->vel[4 * p + 3], q->pos + 4 * p, q->vel + 4 * p);
        if (q->spin && (moves || !coupled->turn))
            t.energy += 0.5 * gn_dot3(q->spin + 4 * p, q->spin + 4 * p) / q->spin[4 * p + 3];
    }
    return t;
}

/* --- masses --- */

/* Whose masses may be scaled: who has another weight than before; who is in a zone where these are
 * too few, as of an element at the edge that holds no particle. */
typedef enum takers { GN_TAKERS_CHANGED, GN_TAKERS_TIED } takers;

static bool takes(const gn_conversion *c, takers who, size_t p) {
    const gn_particles *q = &c->world->dem.particles;
    if (!(q->vel[4 * p + 3] > 0.0)) return false;
    return who == GN_TAKERS_TIED ? c->tied[p] : q->blend[2 * p + 1] != c->part[2 * p + 1];
}

/* Of those who take. */
typedef struct spread {
    double mass, centre[3], second[3][3]; /* kg, m, kg m2 about the centre */
} spread;

static spread spread_of(const gn_conversion *c, takers who) {
    const gn_particles *q = &c->world->dem.particles;
    spread s = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        s.mass += 1.0 / q->vel[4 * p + 3];
        for (size_t a = 0; a < 3; a++) s.centre[a] += q->pos[4 * p + a] / q->vel[4 * p + 3];
    }
    for (int a = 0; s.mass > 0.0 && a < 3; a++) s.centre[a] /= s.mass;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        for (size_t a = 0; a < 3; a++)
            for (size_t b = 0; b < 3; b++)
                s.second[a][b] += (q->pos[4 * p + a] - s.centre[a]) *
                                  (q->pos[4 * p + b] - s.centre[b]) / q->vel[4 * p + 3];
    }
    return s;
}

/* x of m x = f for a symmetric positive m [d][d]; false: it is as good as singular. */
static bool solve(int d, double m[3][3], double *f) {
    double largest = 0.0;
    for (int a = 0; a < d; a++) largest = fmax(largest, m[a][a]);
    for (int k = 0; k < d; k++) {
        if (!(m[k][k] > 1e-6 * largest)) return false;
        for (int r = k + 1; r < d; r++) {
            const double factor = m[r][k] / m[k][k];
            for (int a = k; a < d; a++) m[r][a] -= factor * m[k][a];
            f[r] -= factor * f[k];
        }
    }
    for (int k = d - 1; k >= 0; k--) {
        for (int a = k + 1; a < d; a++) f[k] -= m[k][a] * f[a];
        f[k] /= m[k][k];
    }
    return true;
}

/* Largest change of a mass that is taken for a packing's scatter. */
static const double most_scaled = 0.5;

static double factor_at(const spread *s, double a, const double b[3], const double *x) {
    double f = a;
    for (int k = 0; k < 3; k++) f += b[k] * (x[k] - s->centre[k]);
    return f;
}

/* 1 + a + b.(x - x0) that makes up for what is missing; without b where that says too much. */
static double linear_scale(const gn_conversion *c, takers who, const spread *s,
                           const gn_tally *missing, double b[3]) {
    const gn_particles *q = &c->world->dem.particles;
    const int d = (int)c->world->scene.dimension;
    const double a = missing->mass / s->mass;
    double m[3][3], largest = 0.0;
    for (int k = 0; k < 9; k++) m[k / 3][k % 3] = s->second[k / 3][k % 3];
    for (int k = 0; k < 3; k++)
        b[k] = k < d ? missing->moment[k] - missing->mass * s->centre[k] : 0.0;
    bool fine = solve(d, m, b);
    for (size_t p = 0; fine && p < q->soa.count; p++)
        if (takes(c, who, p)) largest = fmax(largest, fabs(factor_at(s, a, b, q->pos + 4 * p)));
    if (!fine || largest > most_scaled) b[0] = b[1] = b[2] = 0.0;
    return a;
}

/* Whether those could take it. */
static bool scale_masses(const gn_conversion *c, takers who, const gn_tally *missing) {
    gn_particles *q = &c->world->dem.particles;
    const spread s = spread_of(c, who);
    double b[3];
    if (!(fabs(missing->mass) <= most_scaled * s.mass) || !(s.mass > 0.0)) return false;
    const double a = linear_scale(c, who, &s, missing, b);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        const double factor = 1.0 + factor_at(&s, a, b, q->pos + 4 * p);
        q->vel[4 * p + 3] /= factor;
        if (q->spin) q->spin[4 * p + 3] /= factor;
    }
    return true;
}

static void keep_momentum(const gn_conversion *c, const gn_tally *before) {
    gn_particles *q = &c->world->dem.particles;
    const gn_tally now = gn_conversion_tally(c);
    double mass = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (c->freed[p]) mass += 1.0 / q->vel[4 * p + 3];
    for (size_t p = 0; mass > 0.0 && p < q->soa.count; p++)
        for (size_t a = 0; c->freed[p] && a < (size_t)c->world->scene.dimension; a++)
            q->vel[4 * p + a] += (before->momentum[a] - now.momentum[a]) / mass;
}

/* Where few have another weight they cannot make up for what elements weighed. */
static gneiss_status check_mass(const gn_conversion *c, const gn_tally *before,
                                gneiss_error *error) {
    const double now = gn_conversion_tally(c).mass;
    if (fabs(now - before->mass) <= 1e-9 * before->mass) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "%s: expected a zone that is wide enough for its mass to be kept (three elements "
        "and six particles across), found one with which a conversion would change that "
        "of %.6g kg by %.2g kg",
        gn_scene_at(&c->world->scene, c->world->scene.couple.convert.where, "couple.convert.width")
            .text,
        before->mass, now - before->mass);
}

gneiss_status gn_conversion_keep(const gn_conversion *c, const gn_tally *before,
                                 gneiss_error *error) {
    gn_tally missing = gn_conversion_tally(c);
    missing.mass = before->mass - missing.mass;
    for (int a = 0; a < 3; a++) missing.moment[a] = before->moment[a] - missing.moment[a];
    if (!scale_masses(c, GN_TAKERS_CHANGED, &missing)) scale_masses(c, GN_TAKERS_TIED, &missing);
    GN_TRY(gn_coupled_weigh(c->world, error));
    GN_TRY(check_mass(c, before, error));
    keep_momentum(c, before);
    return GNEISS_OK;
}
