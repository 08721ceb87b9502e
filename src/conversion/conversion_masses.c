/* Invariants of a conversion. The particles of an element differ from it in mass, centre of mass
 * and inertia (masses lumped at the nodes have a larger inertia). The masses of particles whose
 * weight changes are therefore multiplied by a polynomial of position that restores these three;
 * the momenta and the energy of a rigid motion are then unchanged too. For any other motion,
 * changes of velocities restore the rest (conversion_momentum.c). */
#include "base/error.h"
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "scene/scene.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* --- sums --- */

/* Number of second moments of positions that enter the moments of inertia; in 2D only that about z.
 */
enum { SECOND_MOST = 6, BASIS_MOST = GN_BASIS_MOST };
static size_t second_count(size_t dimension) {
    return dimension == 3 ? 6 : 1;
}

/* Second moment of a point, m2. It includes the inertia of the point about itself over its mass. In
 * space half of this is added to each axis, because the moment of inertia about an axis is the sum
 * of the second moments along the other two. */
static void second_of(size_t dimension, const double r[3], double own, double out[SECOND_MOST]) {
    if (dimension == 2) {
        out[0] = r[0] * r[0] + r[1] * r[1] + own;
        return;
    }
    for (int a = 0; a < 3; a++) {
        out[a] = r[a] * r[a] + 0.5 * own;
        out[3 + a] = r[a] * r[(a + 1) % 3];
    }
}

static void add(gn_tally *tally, size_t dimension, double mass, const double *x, const double *v) {
    double second[SECOND_MOST], turning[3];
    tally->mass += mass;
    gn_cross3(x, v, turning);
    second_of(dimension, x, 0.0, second);
    for (int a = 0; a < 3; a++) {
        tally->moment[a] += mass * x[a];
        tally->momentum[a] += mass * v[a];
        tally->turning[a] += mass * turning[a];
    }
    for (size_t k = 0; k < second_count(dimension); k++) tally->second[k] += mass * second[k];
    tally->energy += 0.5 * mass * gn_dot3(v, v);
}

static void add_spin(gn_tally *tally, size_t dimension, double inertia, const double *spin) {
    double second[SECOND_MOST];
    second_of(dimension, (const double[3]){0.0}, inertia, second);
    for (size_t k = 0; k < second_count(dimension); k++) tally->second[k] += second[k];
    for (int a = 0; a < 3; a++) tally->turning[a] += inertia * spin[a];
    tally->energy += 0.5 * inertia * gn_dot3(spin, spin);
}

static const gn_coupled *coupled_of(const gn_conversion *conversion) {
    return conversion->model->zones->coupled;
}

/* Marks the particles that follow nodes. */
static void mark_tied(const gn_conversion *conversion) {
    const gn_dem *d = conversion->model->dem;
    const gn_ties *ties = &coupled_of(conversion)->ties;
    memset(conversion->tied, 0, d->particles.soa.count);
    for (size_t k = 0; k < ties->count; k++)
        if (d->index_of_id[ties->tie[k].id] >= 0)
            conversion->tied[d->index_of_id[ties->tie[k].id]] = 1;
}

/* Returns the moment of inertia of a particle, kg m2; 0: its rotation is prescribed by elements. */
static double inertia_of(const gn_conversion *conversion, size_t p) {
    const gn_particles *q = &conversion->model->dem->particles;
    return q->spin && (!conversion->tied[p] || !coupled_of(conversion)->turn)
               ? 1.0 / q->spin[4 * p + 3]
               : 0.0;
}

gn_tally gn_conversion_tally(const gn_conversion *conversion) {
    const gn_convertible *model = conversion->model;
    const gn_particles *q = &model->dem->particles,
                       *nodes = &gn_coupled_solid(model->solids)->nodes;
    const size_t d = (size_t)model->ctx->scene.dimension;
    gn_tally t = {0};
    mark_tied(conversion);
    for (size_t n = 0; n < nodes->soa.count; n++)
        if (gn_particle_is_active(nodes, n))
            add(&t, d, 1.0 / nodes->vel[4 * n + 3], nodes->pos + 4 * n, nodes->vel + 4 * n);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_particle_is_active(q, p)) continue;
        if (!conversion->tied[p])
            add(&t, d, 1.0 / q->vel[4 * p + 3], q->pos + 4 * p, q->vel + 4 * p);
        if (q->spin) add_spin(&t, d, inertia_of(conversion, p), q->spin + 4 * p);
    }
    return t;
}

gn_tally gn_tally_less(const gn_tally *now, const gn_tally *before) {
    gn_tally t = {.mass = now->mass - before->mass, .energy = now->energy - before->energy};
    for (int k = 0; k < 3; k++) {
        t.moment[k] = now->moment[k] - before->moment[k];
        t.momentum[k] = now->momentum[k] - before->momentum[k];
        t.turning[k] = now->turning[k] - before->turning[k];
    }
    for (int k = 0; k < SECOND_MOST; k++) t.second[k] = now->second[k] - before->second[k];
    return t;
}

gn_tally gn_tally_about(const gn_tally *of, size_t dimension, const double x[3]) {
    const double *m = of->moment, mass = of->mass;
    double lever[3];
    gn_tally t = *of;
    gn_cross3(x, of->momentum, lever);
    for (int a = 0; a < 3; a++) {
        t.moment[a] -= mass * x[a];
        t.turning[a] -= lever[a];
    }
    if (dimension == 2)
        t.second[0] += mass * (x[0] * x[0] + x[1] * x[1]) - 2.0 * (x[0] * m[0] + x[1] * m[1]);
    for (size_t k = 0; dimension == 3 && k < SECOND_MOST; k++) {
        const size_t a = k % 3, e = k < 3 ? a : (a + 1) % 3;
        t.second[k] += mass * x[a] * x[e] - x[a] * m[e] - x[e] * m[a];
    }
    return t;
}

bool gn_solve_positive(size_t n, double m[GN_BASIS_MOST][GN_BASIS_MOST], double *f) {
    double largest = 0.0;
    for (size_t a = 0; a < n; a++) largest = fmax(largest, m[a][a]);
    for (size_t k = 0; k < n; k++) {
        if (!(m[k][k] > 1e-6 * largest)) return false;
        for (size_t r = k + 1; r < n; r++) {
            const double factor = m[r][k] / m[k][k];
            for (size_t a = k; a < n; a++) m[r][a] -= factor * m[k][a];
            f[r] -= factor * f[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t a = k + 1; a < n; a++) f[k] -= m[k][a] * f[a];
        f[k] /= m[k][k];
    }
    return true;
}

/* --- masses --- */

bool gn_conversion_scales(const gn_conversion *conversion, gn_scaled scaled, size_t p) {
    const gn_particles *q = &conversion->model->dem->particles;
    if (!gn_particle_is_active(q, p)) return false;
    return scaled == GN_SCALED_TIED ? conversion->tied[p]
                                    : q->blend[2 * p + 1] != conversion->part[2 * p + 1];
}

/* Mass, centre and size of the particles whose masses are scaled. */
typedef struct spread {
    double mass, centre[3], size; /* kg, m; m, root mean square distance from the centre */
} spread;

static spread spread_of(const gn_conversion *conversion, gn_scaled scaled) {
    const gn_particles *q = &conversion->model->dem->particles;
    double square = 0.0;
    spread s = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_conversion_scales(conversion, scaled, p)) continue;
        s.mass += 1.0 / q->vel[4 * p + 3];
        for (size_t a = 0; a < 3; a++) s.centre[a] += q->pos[4 * p + a] / q->vel[4 * p + 3];
    }
    for (int a = 0; s.mass > 0.0 && a < 3; a++) s.centre[a] /= s.mass;
    for (size_t p = 0; p < q->soa.count; p++)
        for (size_t a = 0; gn_conversion_scales(conversion, scaled, p) && a < 3; a++)
            square += pow(q->pos[4 * p + a] - s.centre[a], 2.0) / q->vel[4 * p + 3];
    s.size = s.mass > 0.0 ? sqrt(square / s.mass) : 0.0;
    return s;
}

static void second_about(const gn_conversion *conversion, const double centre[3], const double *x,
                         double own, double out[SECOND_MOST]) {
    double r[3];
    for (int a = 0; a < 3; a++) r[a] = x[a] - centre[a];
    second_of((size_t)conversion->model->ctx->scene.dimension, r, own, out);
}

/* Computes the basis of a particle: 1, the position and the second moments about the centre, in
 * units of the size, per unit of its mass; for a particle of a zone, those of its nodes. */
static void basis_at(const gn_conversion *conversion, const spread *s, size_t p,
                     double b[BASIS_MOST]) {
    const gn_particles *q = &conversion->model->dem->particles,
                       *nodes = &gn_coupled_solid(conversion->model->solids)->nodes;
    const size_t d = (size_t)conversion->model->ctx->scene.dimension, seconds = second_count(d);
    const double *x = q->pos + 4 * p, own = inertia_of(conversion, p) * q->vel[4 * p + 3];
    double second[SECOND_MOST];
    b[0] = 1.0;
    for (size_t a = 0; a < d; a++) b[1 + a] = (x[a] - s->centre[a]) / s->size;
    if (!conversion->tied[p]) {
        second_about(conversion, s->centre, x, own, second);
        for (size_t k = 0; k < seconds; k++) b[1 + d + k] = second[k] / (s->size * s->size);
        return;
    }
    const gn_tie *tie = gn_coupled_tie(coupled_of(conversion), q->id[p]);
    for (size_t k = 0; k < seconds; k++) b[1 + d + k] = 0.0;
    for (size_t a = 0; a <= d; a++) {
        second_about(conversion, s->centre, nodes->pos + 4 * (size_t)tie->node[a], own, second);
        for (size_t k = 0; k < seconds; k++)
            b[1 + d + k] += tie->shape[a] * second[k] / (s->size * s->size);
    }
}

/* Expresses the missing mass and moments in this basis. */
static void missing_about(const gn_conversion *conversion, const spread *s, const gn_tally *missing,
                          double b[BASIS_MOST]) {
    const size_t d = (size_t)conversion->model->ctx->scene.dimension;
    const gn_tally about = gn_tally_about(missing, d, s->centre);
    b[0] = about.mass;
    for (size_t a = 0; a < d; a++) b[1 + a] = about.moment[a] / s->size;
    for (size_t k = 0; k < second_count(d); k++)
        b[1 + d + k] = about.second[k] / (s->size * s->size);
}

static double factor_at(const double *f, const double *b, size_t n) {
    double sum = 0.0;
    for (size_t k = 0; k < n; k++) sum += f[k] * b[k];
    return sum;
}

/* Finds the factors f of the first `n` basis functions with which as many of the missing moments as
 * possible are restored; returns false if a mass would be out of range. */
static bool polynomial(const gn_conversion *conversion, gn_scaled scaled, const spread *s,
                       const gn_tally *missing, size_t n, double f[BASIS_MOST]) {
    const gn_particles *q = &conversion->model->dem->particles;
    double m[BASIS_MOST][BASIS_MOST] = {{0.0}}, b[BASIS_MOST], largest = 0.0;
    missing_about(conversion, s, missing, f);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_conversion_scales(conversion, scaled, p)) continue;
        basis_at(conversion, s, p, b);
        for (size_t k = 0; k < n; k++)
            for (size_t l = 0; l < n; l++) m[k][l] += b[k] * b[l] / q->vel[4 * p + 3];
    }
    if (!gn_solve_positive(n, m, f)) return false;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_conversion_scales(conversion, scaled, p)) continue;
        basis_at(conversion, s, p, b);
        largest = fmax(largest, fabs(factor_at(f, b, n)));
    }
    return largest <= GN_MASS_SCALED_MOST;
}

/* Scales masses so that mass, centre of mass and inertia are restored, or mass and centre, or mass
 * alone; returns false if none of these is possible. */
static bool scale_masses(const gn_conversion *conversion, gn_scaled scaled,
                         const gn_tally *missing) {
    gn_particles *q = &conversion->model->dem->particles;
    const size_t d = (size_t)conversion->model->ctx->scene.dimension;
    const size_t counts[] = {1 + d + second_count(d), 1 + d, 1};
    const spread s = spread_of(conversion, scaled);
    double f[BASIS_MOST], b[BASIS_MOST];
    size_t k = 0;
    if (!(fabs(missing->mass) <= GN_MASS_SCALED_MOST * s.mass) || !(s.mass > 0.0)) return false;
    while (k < 2 && !polynomial(conversion, scaled, &s, missing, counts[k], f)) k++;
    if (k == 2) f[0] = missing->mass / s.mass;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_conversion_scales(conversion, scaled, p)) continue;
        basis_at(conversion, &s, p, b);
        const double factor = 1.0 + factor_at(f, b, counts[k]);
        q->vel[4 * p + 3] /= factor;
        if (q->spin) q->spin[4 * p + 3] /= factor;
    }
    return true;
}

/* --- restoring the invariants --- */

/* Checks that the mass is restored; if only few particles change their weight, they cannot make up
 * for the mass of the elements. */
static gneiss_status check_mass(const gn_conversion *conversion, const gn_tally *before,
                                gneiss_error *error) {
    const double now = gn_conversion_tally(conversion).mass;
    if (fabs(now - before->mass) <= 1e-12 * before->mass) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "%s: expected a zone that is wide enough for its mass to be kept (three elements "
        "and six particles across), found one with which a conversion would change that "
        "of %.6g kg by %.2g kg",
        gn_scene_at(&conversion->model->ctx->scene,
                    conversion->model->ctx->scene.couple.convert.where, "couple.convert.width")
            .text,
        before->mass, now - before->mass);
}

gneiss_status gn_conversion_keep_invariants(const gn_conversion *conversion, const gn_tally *before,
                                            gneiss_error *error) {
    const gn_tally now = gn_conversion_tally(conversion), missing = gn_tally_less(before, &now);
    gn_scaled scaled = GN_SCALED_CHANGED;
    bool taken = scale_masses(conversion, scaled, &missing);
    if (!taken) taken = scale_masses(conversion, scaled = GN_SCALED_TIED, &missing);
    GN_TRY(gn_coupled_weigh(conversion->model->dem, conversion->model->solids,
                            conversion->model->zones, error));
    if (!taken) GN_TRY(check_mass(conversion, before, error));
    gn_conversion_keep_momentum(conversion, before, scaled);
    return GNEISS_OK;
}
