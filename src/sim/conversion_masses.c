/* What a conversion keeps. The particles of an element do not weigh quite what it does, nor have
 * they its centre of mass: masses of who has another weight than before are scaled by 1 + a + b.(x
 * - x0), so that both are kept; a rigid motion then keeps its momentum by itself. What is left of
 * any other is made up by a uniform velocity of who moves by itself from now on. */
#include "kernels/law.h"
#include "sim/conversion_internal.h"

#include <math.h>

/* Whether a particle moves by itself. */
static bool is_free(const gn_world *w, size_t p) {
    return w->dem.particles.vel[4 * p + 3] > 0.0 &&
           !gn_coupled_has(w->exchange[0].context, w->dem.particles.id[p]);
}

static void add(gn_tally *t, double mass, const double *x, const double *v) {
    t->mass += mass;
    for (int a = 0; a < 3; a++) {
        t->moment[a] += mass * x[a];
        t->momentum[a] += mass * v[a];
    }
    t->energy += 0.5 * mass * gn_dot3(v, v);
}

/* --- energy ---
 * What leap-frog conserves is 1/2 v(-) M v(+) and what springs hold at the instant: 1/2 v(-) M v(-)
 * and half a step of the power of their forces at v(-). Tangential forces between two steps are
 * those of the instant before; the step to come adds what the last interval did. That power at
 * nodes that are driven is no part of what is conserved, but the work of their reactions, of which
 * the interval that led here has the mean of its two ends, takes the one after the conversion for
 * that end: what it misses is half a step of the power of what the reactions jump by. */

/* N, of a contact across n, of the instant; the rate at which its ends part, m/s. */
static void advance_shear(const gn_world *w, const gn_contacts *list, size_t c, double length,
                          const double n[3], const double shear[3], double now[3], double rate[3]) {
    gn_contact_rate(w, list->i[c], list->j[c], length, n, rate);
    const double kt = list->kt ? list->kt[c] : 0.0, along = gn_dot3(rate, n);
    for (int a = 0; a < 3; a++) now[a] = shear[a] + kt * w->dt_past * (rate[a] - along * n[a]);
}

static double contact_energy(const gn_world *w, const gn_contacts *list, size_t c) {
    const double *a = w->dem.particles.pos + 4 * (size_t)list->i[c],
                 *b = w->dem.particles.pos + 4 * (size_t)list->j[c];
    double n[3], shear[3], rate[3], length = sqrt(gn_branch(w, a, b, n));
    const double rest = list->length0 ? list->length0[c] : a[3] + b[3];
    for (int k = 0; k < 3; k++) n[k] /= length;
    const gn_law_held h = gn_law_of(list->soa.effects)->held(list, c, length, length - rest);
    advance_shear(w, list, c, length, n, h.shear, shear, rate);
    double stored = h.stored, power = h.normal * gn_dot3(rate, n) + gn_dot3(shear, rate);
    if (list->kt && list->kt[c] > 0.0)
        stored += (gn_dot3(shear, shear) - gn_dot3(h.shear, h.shear)) / (2.0 * list->kt[c]);
    return stored - 0.5 * w->dt_past * power;
}

static double contacts_energy(const gn_world *w, const gn_contacts *list) {
    double sum = 0.0;
    for (size_t c = 0; c < list->soa.count; c++) {
        const bool bond = list == &w->dem.bonds;
        const size_t at = bond ? 0 : gn_contacts_from(&w->dem.bonds, list->i[c], list->j[c]);
        const gn_contacts *bonds = &w->dem.bonds;
        const bool known = !bond && at < bonds->soa.count && bonds->i[at] == list->i[c] &&
                           bonds->j[at] == list->j[c];
        if (!known) sum += contact_energy(w, list, c);
    }
    return sum;
}

/* As gn_fem_stored, and half a step of the power, which the difference of two energies gives. */
static double elements_energy(const gn_world *w) {
    const gn_fem_solid *b = gn_coupled_solid(w);
    const double half = 0.5 * w->dt_past;
    return gn_fem_stored(b, 0.0) + 0.5 * (gn_fem_stored(b, -half) - gn_fem_stored(b, half));
}

gn_tally gn_conversion_tally(const gn_world *w, bool energy) {
    const gn_particles *q = &w->dem.particles, *nodes = &gn_coupled_solid(w)->nodes;
    const gn_coupled *coupled = w->exchange[0].context;
    gn_tally t = {0};
    if (energy)
        t.energy = elements_energy(w) + contacts_energy(w, &w->dem.bonds) +
                   contacts_energy(w, &w->dem.pairs);
    for (size_t n = 0; n < nodes->soa.count; n++)
        if (nodes->vel[4 * n + 3] > 0.0)
            add(&t, 1.0 / nodes->vel[4 * n + 3], nodes->pos + 4 * n, nodes->vel + 4 * n);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        const bool moves = is_free(w, p);
        if (moves) add(&t, 1.0 / q->vel[4 * p + 3], q->pos + 4 * p, q->vel + 4 * p);
        if (q->spin && (moves || !coupled->turn))
            t.energy += 0.5 * gn_dot3(q->spin + 4 * p, q->spin + 4 * p) / q->spin[4 * p + 3];
    }
    return t;
}

/* --- masses --- */

static bool has_changed(const gn_conversion *c, size_t p) {
    const gn_particles *q = &c->world->dem.particles;
    return q->vel[4 * p + 3] > 0.0 && q->blend[2 * p + 1] != c->part[2 * p + 1];
}

/* Of those whose masses may be scaled. */
typedef struct spread {
    double mass, centre[3], second[3][3]; /* kg, m, kg m2 about the centre */
} spread;

static spread spread_of(const gn_conversion *c) {
    const gn_particles *q = &c->world->dem.particles;
    spread s = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!has_changed(c, p)) continue;
        s.mass += 1.0 / q->vel[4 * p + 3];
        for (size_t a = 0; a < 3; a++) s.centre[a] += q->pos[4 * p + a] / q->vel[4 * p + 3];
    }
    for (int a = 0; s.mass > 0.0 && a < 3; a++) s.centre[a] /= s.mass;
    for (size_t p = 0; p < q->soa.count; p++)
        for (size_t a = 0; a < 3 && has_changed(c, p); a++)
            for (size_t b = 0; b < 3; b++)
                s.second[a][b] += (q->pos[4 * p + a] - s.centre[a]) *
                                  (q->pos[4 * p + b] - s.centre[b]) / q->vel[4 * p + 3];
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
static double linear_scale(const gn_conversion *c, const spread *s, const gn_tally *missing,
                           double b[3]) {
    const gn_particles *q = &c->world->dem.particles;
    const int d = (int)c->world->scene.dimension;
    const double a = missing->mass / s->mass;
    double m[3][3], largest = 0.0;
    for (int k = 0; k < 9; k++) m[k / 3][k % 3] = s->second[k / 3][k % 3];
    for (int k = 0; k < 3; k++)
        b[k] = k < d ? missing->moment[k] - missing->mass * s->centre[k] : 0.0;
    bool fine = solve(d, m, b);
    for (size_t p = 0; fine && p < q->soa.count; p++)
        if (has_changed(c, p)) largest = fmax(largest, fabs(factor_at(s, a, b, q->pos + 4 * p)));
    if (!fine || largest > most_scaled) b[0] = b[1] = b[2] = 0.0;
    return fabs(a) > most_scaled ? 0.0 : a;
}

static void scale_masses(const gn_conversion *c, const gn_tally *missing) {
    gn_particles *q = &c->world->dem.particles;
    const spread s = spread_of(c);
    double b[3];
    if (!(s.mass > 0.0)) return;
    const double a = linear_scale(c, &s, missing, b);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!has_changed(c, p)) continue;
        const double factor = 1.0 + factor_at(&s, a, b, q->pos + 4 * p);
        q->vel[4 * p + 3] /= factor;
        if (q->spin) q->spin[4 * p + 3] /= factor;
    }
}

static void keep_momentum(const gn_conversion *c, const gn_tally *before) {
    gn_particles *q = &c->world->dem.particles;
    const gn_tally now = gn_conversion_tally(c->world, false);
    double mass = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (c->freed[p]) mass += 1.0 / q->vel[4 * p + 3];
    for (size_t p = 0; mass > 0.0 && p < q->soa.count; p++)
        for (size_t a = 0; c->freed[p] && a < (size_t)c->world->scene.dimension; a++)
            q->vel[4 * p + a] += (before->momentum[a] - now.momentum[a]) / mass;
}

gneiss_status gn_conversion_keep(const gn_conversion *c, const gn_tally *before,
                                 gneiss_error *error) {
    gn_tally missing = gn_conversion_tally(c->world, false);
    missing.mass = before->mass - missing.mass;
    for (int a = 0; a < 3; a++) missing.moment[a] = before->moment[a] - missing.moment[a];
    scale_masses(c, &missing);
    GN_TRY(gn_coupled_weigh(c->world, error));
    keep_momentum(c, before);
    return GNEISS_OK;
}
