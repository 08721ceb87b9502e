/* What a conversion keeps. The particles of an element do not weigh quite what it does, nor have
 * they its centre of mass and its inertia, which lumped masses at the nodes have more of: masses of
 * who has another weight than before are scaled by a polynomial of the place, so that these are
 * kept; a rigid motion then keeps its momenta and its energy by itself. What is left of any other
 * is made up by a rigid motion, v + w x r, of who moves by itself from now on and of the nodes that
 * have another part than before (an element smaller than a particle frees none): of all that could
 * be added that is what has the least kinetic energy. */
#include "sim/conversion_internal.h"

#include <math.h>
#include <string.h>

/* --- sums --- */

/* Second moments that a rotation needs, of a place: in the plane that about the axis alone. */
enum { SECOND_MOST = 6, BASIS_MOST = 10 };
static size_t second_count(size_t dimension) {
    return dimension == 3 ? 6 : 1;
}

/* m2. What a point has by its own inertia over its mass, m2, goes along: 1/2 of it along each axis
 * in space, as the inertia about one is the sum of the other two. */
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

static void add(gn_tally *t, size_t dimension, double mass, const double *x, const double *v) {
    double second[SECOND_MOST], turning[3];
    t->mass += mass;
    gn_cross3(x, v, turning);
    second_of(dimension, x, 0.0, second);
    for (int a = 0; a < 3; a++) {
        t->moment[a] += mass * x[a];
        t->momentum[a] += mass * v[a];
        t->turning[a] += mass * turning[a];
    }
    for (size_t k = 0; k < second_count(dimension); k++) t->second[k] += mass * second[k];
    t->energy += 0.5 * mass * gn_dot3(v, v);
}

static void add_spin(gn_tally *t, size_t dimension, double inertia, const double *spin) {
    double second[SECOND_MOST];
    second_of(dimension, (const double[3]){0.0}, inertia, second);
    for (size_t k = 0; k < second_count(dimension); k++) t->second[k] += second[k];
    for (int a = 0; a < 3; a++) t->turning[a] += inertia * spin[a];
    t->energy += 0.5 * inertia * gn_dot3(spin, spin);
}

static const gn_coupled *coupled_of(const gn_conversion *c) {
    return c->world->exchange[0].context;
}

/* Who does not move by itself. */
static void mark_tied(const gn_conversion *c) {
    const gn_dem *d = &c->world->dem;
    const gn_ties *ties = &coupled_of(c)->ties;
    memset(c->tied, 0, d->particles.soa.count);
    for (size_t k = 0; k < ties->count; k++)
        if (d->index_of_id[ties->tie[k].id] >= 0) c->tied[d->index_of_id[ties->tie[k].id]] = 1;
}

/* kg m2, of a particle that turns by itself; slaved spins have none. */
static double inertia_of(const gn_conversion *c, size_t p) {
    const gn_particles *q = &c->world->dem.particles;
    return q->spin && (!c->tied[p] || !coupled_of(c)->turn) ? 1.0 / q->spin[4 * p + 3] : 0.0;
}

gn_tally gn_conversion_tally(const gn_conversion *c) {
    const gn_world *w = c->world;
    const gn_particles *q = &w->dem.particles, *nodes = &gn_coupled_solid(w)->nodes;
    const size_t d = (size_t)w->scene.dimension;
    gn_tally t = {0};
    mark_tied(c);
    for (size_t n = 0; n < nodes->soa.count; n++)
        if (nodes->vel[4 * n + 3] > 0.0)
            add(&t, d, 1.0 / nodes->vel[4 * n + 3], nodes->pos + 4 * n, nodes->vel + 4 * n);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        if (!c->tied[p]) add(&t, d, 1.0 / q->vel[4 * p + 3], q->pos + 4 * p, q->vel + 4 * p);
        if (q->spin) add_spin(&t, d, inertia_of(c, p), q->spin + 4 * p);
    }
    return t;
}

/* x of m x = f for a symmetric positive m [n][n]; false: it is as good as singular. */
static bool solve(size_t n, double m[BASIS_MOST][BASIS_MOST], double *f) {
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
    double mass, centre[3], size; /* kg, m; m, of the mean square from the centre */
} spread;

static spread spread_of(const gn_conversion *c, takers who) {
    const gn_particles *q = &c->world->dem.particles;
    double square = 0.0;
    spread s = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        s.mass += 1.0 / q->vel[4 * p + 3];
        for (size_t a = 0; a < 3; a++) s.centre[a] += q->pos[4 * p + a] / q->vel[4 * p + 3];
    }
    for (int a = 0; s.mass > 0.0 && a < 3; a++) s.centre[a] /= s.mass;
    for (size_t p = 0; p < q->soa.count; p++)
        for (size_t a = 0; takes(c, who, p) && a < 3; a++)
            square += pow(q->pos[4 * p + a] - s.centre[a], 2.0) / q->vel[4 * p + 3];
    s.size = s.mass > 0.0 ? sqrt(square / s.mass) : 0.0;
    return s;
}

/* Largest change of a mass that is taken for a packing's scatter. */
static const double most_scaled = 0.5;

static void second_about(const gn_conversion *c, const double centre[3], const double *x,
                         double own, double out[SECOND_MOST]) {
    double r[3];
    for (int a = 0; a < 3; a++) r[a] = x[a] - centre[a];
    second_of((size_t)c->world->scene.dimension, r, own, out);
}

/* 1, the place and the second moments about the centre, over the size, that a unit of the mass of a
 * particle has: at the nodes, where it is in a zone. */
static void basis_at(const gn_conversion *c, const spread *s, size_t p, double b[BASIS_MOST]) {
    const gn_particles *q = &c->world->dem.particles, *nodes = &gn_coupled_solid(c->world)->nodes;
    const size_t d = (size_t)c->world->scene.dimension, seconds = second_count(d);
    const double *x = q->pos + 4 * p, own = inertia_of(c, p) * q->vel[4 * p + 3];
    double second[SECOND_MOST];
    b[0] = 1.0;
    for (size_t a = 0; a < d; a++) b[1 + a] = (x[a] - s->centre[a]) / s->size;
    if (!c->tied[p]) {
        second_about(c, s->centre, x, own, second);
        for (size_t k = 0; k < seconds; k++) b[1 + d + k] = second[k] / (s->size * s->size);
        return;
    }
    const gn_tie *tie = gn_coupled_tie(coupled_of(c), q->id[p]);
    for (size_t k = 0; k < seconds; k++) b[1 + d + k] = 0.0;
    for (size_t a = 0; a <= d; a++) {
        second_about(c, s->centre, nodes->pos + 4 * (size_t)tie->node[a], own, second);
        for (size_t k = 0; k < seconds; k++)
            b[1 + d + k] += tie->shape[a] * second[k] / (s->size * s->size);
    }
}

/* The same of what is missing. */
static void missing_about(const gn_conversion *c, const spread *s, const gn_tally *missing,
                          double b[BASIS_MOST]) {
    const size_t d = (size_t)c->world->scene.dimension;
    const double *x = s->centre, *m = missing->moment, mass = missing->mass;
    const double square = s->size * s->size;
    b[0] = mass;
    for (size_t a = 0; a < d; a++) b[1 + a] = (m[a] - mass * x[a]) / s->size;
    if (d == 2) {
        b[3] = (missing->second[0] - 2.0 * (x[0] * m[0] + x[1] * m[1]) +
                mass * (x[0] * x[0] + x[1] * x[1])) /
               square;
        return;
    }
    for (size_t k = 0; k < 6; k++) {
        const size_t a = k % 3, e = k < 3 ? a : (a + 1) % 3;
        b[4 + k] = (missing->second[k] - x[a] * m[e] - x[e] * m[a] + mass * x[a] * x[e]) / square;
    }
}

static double factor_at(const double *f, const double *b, size_t n) {
    double sum = 0.0;
    for (size_t k = 0; k < n; k++) sum += f[k] * b[k];
    return sum;
}

/* The first `n` of the basis, with factors f that make up for as much of what is missing; false:
 * that says too much. */
static bool polynomial(const gn_conversion *c, takers who, const spread *s, const gn_tally *missing,
                       size_t n, double f[BASIS_MOST]) {
    const gn_particles *q = &c->world->dem.particles;
    double m[BASIS_MOST][BASIS_MOST] = {{0.0}}, b[BASIS_MOST], largest = 0.0;
    missing_about(c, s, missing, f);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        basis_at(c, s, p, b);
        for (size_t k = 0; k < n; k++)
            for (size_t l = 0; l < n; l++) m[k][l] += b[k] * b[l] / q->vel[4 * p + 3];
    }
    if (!solve(n, m, f)) return false;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        basis_at(c, s, p, b);
        largest = fmax(largest, fabs(factor_at(f, b, n)));
    }
    return largest <= most_scaled;
}

/* Whether those could take it: mass, its centre and inertia; or without the last, or the last two.
 */
static bool scale_masses(const gn_conversion *c, takers who, const gn_tally *missing) {
    gn_particles *q = &c->world->dem.particles;
    const size_t d = (size_t)c->world->scene.dimension;
    const size_t counts[] = {1 + d + second_count(d), 1 + d, 1};
    const spread s = spread_of(c, who);
    double f[BASIS_MOST], b[BASIS_MOST];
    size_t k = 0;
    if (!(fabs(missing->mass) <= most_scaled * s.mass) || !(s.mass > 0.0)) return false;
    while (k < 2 && !polynomial(c, who, &s, missing, counts[k], f)) k++;
    if (k == 2) f[0] = missing->mass / s.mass;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, who, p)) continue;
        basis_at(c, &s, p, b);
        const double factor = 1.0 + factor_at(f, b, counts[k]);
        q->vel[4 * p + 3] /= factor;
        if (q->spin) q->spin[4 * p + 3] /= factor;
    }
    return true;
}

/* --- momentum --- */

/* Whether a component of a node is free to have another velocity. All elements at a node with
 * another part than before are touched, so that the ledger sees what this does to them. */
static bool node_takes(const gn_conversion *c, size_t n, size_t a) {
    const gn_fem_solid *b = gn_coupled_solid(c->world);
    const int32_t slot = b->prescribed.count ? b->nodes.slot[n] : -1;
    return b->nodes.vel[4 * n + 3] > 0.0 && b->nodes.blend[2 * n] != c->node_part[2 * n] &&
           !(slot >= 0 && b->prescribed.mask[slot] >> a & 1);
}

/* kg that take a component of the momentum that is missing. */
static double taking_mass(const gn_conversion *c, size_t a) {
    const gn_particles *q = &c->world->dem.particles, *nodes = &gn_coupled_solid(c->world)->nodes;
    double mass = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (c->freed[p]) mass += 1.0 / q->vel[4 * p + 3];
    for (size_t n = 0; n < nodes->soa.count; n++)
        if (node_takes(c, n, a)) mass += 1.0 / nodes->vel[4 * n + 3];
    return mass;
}

/* A rigid motion of those who take: velocity of the centre and spin times the size, as many as the
 * dimension has. */
typedef struct rigid {
    size_t dimension, count;
    double centre[3], size; /* m */
    double motion[6];       /* m/s */
} rigid;

/* What each of these is at a place, of a component. */
static void share_of(const rigid *r, const double *x, size_t a, double b[6]) {
    const size_t d = r->dimension, next = (a + 1) % 3, last = (a + 2) % 3;
    double from[3];
    for (size_t k = 0; k < 3; k++) from[k] = (x[k] - r->centre[k]) / r->size;
    for (size_t k = 0; k < 6; k++) b[k] = k == a ? 1.0 : 0.0;
    if (d == 2) {
        b[2] = a == 0 ? -from[1] : from[0];
        return;
    }
    b[3 + next] = from[last];
    b[3 + last] = -from[next];
}

/* The component of a taker: its part of the masses, or the motion added to it. */
static void visit(const rigid *r, const double *x, size_t a, double *v, double mass,
                  double m[BASIS_MOST][BASIS_MOST]) {
    double b[6];
    share_of(r, x, a, b);
    for (size_t k = 0; m && k < r->count; k++)
        for (size_t l = 0; l < r->count; l++) m[k][l] += mass * b[k] * b[l];
    for (size_t k = 0; !m && k < r->count; k++) v[a] += r->motion[k] * b[k];
}

static void visit_takers(const gn_conversion *c, const rigid *r, double m[BASIS_MOST][BASIS_MOST]) {
    gn_particles *q = &c->world->dem.particles, *nodes = &gn_coupled_solid(c->world)->nodes;
    for (size_t a = 0; a < r->dimension; a++) {
        for (size_t p = 0; p < q->soa.count; p++)
            if (c->freed[p])
                visit(r, q->pos + 4 * p, a, q->vel + 4 * p, 1.0 / q->vel[4 * p + 3], m);
        for (size_t n = 0; n < nodes->soa.count; n++)
            if (node_takes(c, n, a))
                visit(r, nodes->pos + 4 * n, a, nodes->vel + 4 * n, 1.0 / nodes->vel[4 * n + 3], m);
    }
    for (size_t p = 0; q->spin && p < q->soa.count; p++)
        for (size_t k = r->dimension; c->freed[p] && k < r->count; k++) {
            const size_t axis = r->dimension == 3 ? k - 3 : 2;
            if (m)
                m[k][k] += 1.0 / (q->spin[4 * p + 3] * r->size * r->size);
            else
                q->spin[4 * p + axis] += r->motion[k] / r->size;
        }
}

/* About where most of those are who take, whatever holds them. */
static rigid rigid_of(const gn_conversion *c) {
    const gn_particles *q = &c->world->dem.particles, *nodes = &gn_coupled_solid(c->world)->nodes;
    rigid r = {.dimension = (size_t)c->world->scene.dimension};
    const gn_particles *all[2] = {q, nodes};
    double mass = 0.0, sum[3] = {0.0}, square = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < 2; k++)
            for (size_t p = 0; p < all[k]->soa.count; p++) {
                const double *x = all[k]->pos + 4 * p, inverse = all[k]->vel[4 * p + 3];
                if (k ? !node_takes(c, p, 0) && !node_takes(c, p, 1) : !c->freed[p]) continue;
                for (int a = 0; a < 3; a++)
                    pass ? (square += pow(x[a] - r.centre[a], 2.0) / inverse)
                         : (sum[a] += x[a] / inverse);
                mass += pass ? 0.0 : 1.0 / inverse;
            }
        for (int a = 0; !pass && mass > 0.0 && a < 3; a++) r.centre[a] = sum[a] / mass;
    }
    r.size = mass > 0.0 ? sqrt(square / mass) : 0.0;
    r.count = r.dimension == 3 ? 6 : 3;
    return r;
}

/* The mean spin of who weighs something else than before, rad/s: of a rigid motion its own. */
static void mean_spin(const gn_conversion *c, double spin[3]) {
    const gn_particles *q = &c->world->dem.particles;
    double mass = 0.0;
    spin[0] = spin[1] = spin[2] = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!takes(c, GN_TAKERS_CHANGED, p)) continue;
        mass += 1.0 / q->vel[4 * p + 3];
        for (size_t a = 0; a < 3; a++) spin[a] += q->spin[4 * p + a] / q->vel[4 * p + 3];
    }
    for (int a = 0; mass > 0.0 && a < 3; a++) spin[a] /= mass;
}

/* kg m2/s: what a rotation has more with the inertia of before, where masses could not keep it. To
 * make up for that as well would have a body that turns rigidly turn otherwise where it converts.
 */
static void turning_of_inertia(const gn_conversion *c, const gn_tally *before, const gn_tally *now,
                               double out[3]) {
    double spin[3], s[6], trace = 0.0;
    mean_spin(c, spin);
    for (int k = 0; k < 6; k++) s[k] = before->second[k] - now->second[k];
    out[0] = out[1] = 0.0;
    out[2] = s[0] * spin[2];
    if (c->world->scene.dimension == 2) return;
    trace = s[0] + s[1] + s[2];
    for (size_t a = 0; a < 3; a++) /* xy, yz and zx follow the squares */
        out[a] = (trace - s[a]) * spin[a] - s[3 + a] * spin[(a + 1) % 3] -
                 s[3 + (a + 2) % 3] * spin[(a + 2) % 3];
}

/* Nothing, where sums over the whole model have no more digits: size is the most that it could be.
 */
static double beyond_rounding(double missing, double size) {
    return fabs(missing) > 1e-14 * size ? missing : 0.0;
}

/* What is missing, as a rigid motion has it: of momentum and, about its centre, of angular
 * momentum. */
static void missing_of(const gn_conversion *c, const rigid *r, const gn_tally *before,
                       double f[6]) {
    const gn_tally now = gn_conversion_tally(c);
    const double trace = now.second[0] + (r->dimension == 3 ? now.second[1] + now.second[2] : 0.0);
    double lever[3], missing[3], stays[3];
    turning_of_inertia(c, before, &now, stays);
    for (int a = 0; a < 3; a++)
        missing[a] = beyond_rounding(before->momentum[a] - now.momentum[a],
                                     sqrt(2.0 * now.mass * now.energy));
    gn_cross3(r->centre, missing, lever);
    for (size_t a = 0; a < r->dimension; a++) f[a] = missing[a];
    for (size_t k = r->dimension; k < r->count; k++) {
        const size_t a = r->dimension == 3 ? k - 3 : 2;
        f[k] = beyond_rounding(before->turning[a] - now.turning[a] - stays[a],
                               sqrt(2.0 * trace * now.energy)) -
               lever[a];
        f[k] /= r->size;
    }
}

/* False: those who take are too few to turn, or in a line. */
static bool add_rigid_motion(const gn_conversion *c, const gn_tally *before) {
    double m[BASIS_MOST][BASIS_MOST] = {{0.0}};
    rigid r = rigid_of(c);
    if (!(r.size > 0.0) || !c->world->dem.particles.spin) return false;
    missing_of(c, &r, before, r.motion);
    visit_takers(c, &r, m);
    if (!solve(r.count, m, r.motion)) return false;
    visit_takers(c, &r, NULL);
    return true;
}

static void add_velocity(const gn_conversion *c, const gn_tally *before) {
    gn_particles *q = &c->world->dem.particles, *nodes = &gn_coupled_solid(c->world)->nodes;
    const gn_tally now = gn_conversion_tally(c);
    for (size_t a = 0; a < (size_t)c->world->scene.dimension; a++) {
        const double mass = taking_mass(c, a);
        if (!(mass > 0.0)) continue;
        const double more = (before->momentum[a] - now.momentum[a]) / mass;
        for (size_t p = 0; p < q->soa.count; p++)
            if (c->freed[p]) q->vel[4 * p + a] += more;
        for (size_t n = 0; n < nodes->soa.count; n++)
            if (node_takes(c, n, a)) nodes->vel[4 * n + a] += more;
    }
}

/* Particles of zones have no momentum of their own, and go where nodes take them. */
static void keep_momentum(const gn_conversion *c, const gn_tally *before) {
    gn_world *w = c->world;
    if (!add_rigid_motion(c, before)) add_velocity(c, before);
    gn_fem_to_single(gn_coupled_solid(w));
    gn_coupled_follow(w);
}

/* Where few have another weight they cannot make up for what elements weighed. */
static gneiss_status check_mass(const gn_conversion *c, const gn_tally *before,
                                gneiss_error *error) {
    const double now = gn_conversion_tally(c).mass;
    if (fabs(now - before->mass) <= 1e-12 * before->mass) return GNEISS_OK;
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
    for (int k = 0; k < SECOND_MOST; k++) missing.second[k] = before->second[k] - missing.second[k];
    const bool taken =
        scale_masses(c, GN_TAKERS_CHANGED, &missing) || scale_masses(c, GN_TAKERS_TIED, &missing);
    GN_TRY(gn_coupled_weigh(c->world, error));
    if (!taken) GN_TRY(check_mass(c, before, error));
    keep_momentum(c, before);
    return GNEISS_OK;
}
