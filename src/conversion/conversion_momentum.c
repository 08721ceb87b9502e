/* Momentum and angular momentum that scaled masses (conversion_masses.c) do not restore are
 * restored by a rigid motion v + w x r, the addition with the least kinetic energy. It is given to
 * released particles and to nodes whose weight changes (an element smaller than a particle releases
 * none), as long as it is small relative to the motion of the body; a few nodes in a line can take
 * hardly any angular momentum. Otherwise all nodes of the zones receive it, or else everything that
 * is free to move.
 *
 * A rigid motion continues as one, in any frame. Where masses could not restore the centre of mass
 * and the inertia, the angular momentum of the scaled particles differs by d x v + J w, with their
 * mean velocity v and spin w, and d and J the missing moment and inertia about their centre: this
 * jump is not compensated. Neither is a part that no set can receive with small changes. */
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "fem/fem.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* Largest change of a velocity, as a fraction of the mean velocity of deformation. */
static const double most_changed = 0.1;
/* Changes below this fraction of all velocities are rounding. */
static const double least_changed = 1e-10;

typedef enum takers { TAKERS_CHANGED, TAKERS_ZONE, TAKERS_ALL, TAKERS } takers;

/* A rigid motion of the receiving set: velocity of its centre and spin times its size, with as many
 * components as the dimension has. */
typedef struct rigid {
    const gn_conversion *c;
    takers chosen;
    size_t dimension, count;
    double centre[3], size; /* m */
    double motion[6];       /* m/s */
} rigid;

/* --- receivers --- */

/* Tells whether a velocity component of a node may change. All elements at a node whose weight
 * changes have been marked, so that the ledger contains the effect. */
static bool node_takes(const rigid *r, size_t n, size_t a) {
    const gn_conversion *c = r->c;
    const gn_fem_solid *b = gn_coupled_solid(c->model->solids);
    const int32_t slot = b->prescribed.count ? b->nodes.slot[n] : -1;
    const double part = b->nodes.blend[2 * n];
    if (!gn_particle_is_active(&b->nodes, n) || (slot >= 0 && b->prescribed.mask[slot] >> a & 1))
        return false;
    return r->chosen == TAKERS_ALL || part != c->node_part[2 * n] ||
           (r->chosen == TAKERS_ZONE && part < 1.0);
}

static bool particle_takes(const rigid *r, size_t p) {
    const gn_dem *d = r->c->model->dem;
    if (r->c->freed[p]) return true;
    return r->chosen == TAKERS_ALL && gn_particle_is_active(&d->particles, p) && !r->c->tied[p] &&
           !(d->prescribed.count && d->particles.slot[p] >= 0);
}

/* Returns the motion of the receivers, zero so far. Its centre is that of the mass of all
 * receivers, held ones included. */
static rigid rigid_of(const gn_conversion *conversion, takers chosen) {
    const gn_particles *q = &conversion->model->dem->particles,
                       *nodes = &gn_coupled_solid(conversion->model->solids)->nodes;
    const size_t d = (size_t)conversion->model->ctx->scene.dimension;
    rigid r = {.c = conversion, .chosen = chosen, .dimension = d, .count = d == 3 ? 6 : 3};
    const gn_particles *all[2] = {q, nodes};
    double mass = 0.0, sum[3] = {0.0}, square = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < 2; k++)
            for (size_t p = 0; p < all[k]->soa.count; p++) {
                const double *x = all[k]->pos + 4 * p, inverse = all[k]->vel[4 * p + 3];
                if (k ? !node_takes(&r, p, 0) && !node_takes(&r, p, 1) : !particle_takes(&r, p))
                    continue;
                for (int a = 0; a < 3; a++)
                    pass ? (square += pow(x[a] - r.centre[a], 2.0) / inverse)
                         : (sum[a] += x[a] / inverse);
                mass += pass ? 0.0 : 1.0 / inverse;
            }
        for (int a = 0; !pass && mass > 0.0 && a < 3; a++) r.centre[a] = sum[a] / mass;
    }
    r.size = mass > 0.0 ? sqrt(square / mass) : 0.0;
    return r;
}

/* --- effect of the rigid motion --- */

/* Computes the velocity of a position along axis a per unit of each component of the rigid motion.
 */
static void share_of(const rigid *r, const double *x, size_t a, double b[6]) {
    const size_t d = r->dimension, next = (a + 1) % 3, last = (a + 2) % 3;
    double from[3];
    for (size_t k = 0; k < 6; k++) b[k] = k == a ? 1.0 : 0.0;
    if (r->count == d) return;
    for (size_t k = 0; k < 3; k++) from[k] = (x[k] - r->centre[k]) / r->size;
    if (d == 2) {
        b[2] = a == 0 ? -from[1] : from[0];
        return;
    }
    b[3 + next] = from[last];
    b[3 + last] = -from[next];
}

static double change_at(const rigid *r, const double *x, size_t a) {
    double b[6], sum = 0.0;
    share_of(r, x, a, b);
    for (size_t k = 0; k < r->count; k++) sum += r->motion[k] * b[k];
    return sum;
}

static void add_mass(const rigid *r, const double *x, size_t a, double mass,
                     double m[GN_BASIS_MOST][GN_BASIS_MOST]) {
    double b[6];
    share_of(r, x, a, b);
    for (size_t k = 0; k < r->count; k++)
        for (size_t l = 0; l < r->count; l++) m[k][l] += mass * b[k] * b[l];
}

/* Computes the mass matrix of the receiving particles and nodes for the components of the rigid
 * motion. */
static void find_masses(const rigid *r, double m[GN_BASIS_MOST][GN_BASIS_MOST]) {
    const gn_particles *q = &r->c->model->dem->particles,
                       *nodes = &gn_coupled_solid(r->c->model->solids)->nodes;
    for (size_t a = 0; a < r->dimension; a++) {
        for (size_t p = 0; p < q->soa.count; p++)
            if (particle_takes(r, p)) add_mass(r, q->pos + 4 * p, a, 1.0 / q->vel[4 * p + 3], m);
        for (size_t n = 0; n < nodes->soa.count; n++)
            if (node_takes(r, n, a))
                add_mass(r, nodes->pos + 4 * n, a, 1.0 / nodes->vel[4 * n + 3], m);
    }
    for (size_t p = 0; q->spin && p < q->soa.count; p++)
        for (size_t k = r->dimension; k < r->count && particle_takes(r, p); k++)
            m[k][k] += 1.0 / (q->spin[4 * p + 3] * r->size * r->size);
}

/* Returns the largest change of a velocity component, m/s. */
static double most_change(const rigid *r) {
    const gn_particles *q = &r->c->model->dem->particles,
                       *nodes = &gn_coupled_solid(r->c->model->solids)->nodes;
    double most = 0.0;
    for (size_t a = 0; a < r->dimension; a++) {
        for (size_t p = 0; p < q->soa.count; p++)
            if (particle_takes(r, p)) most = fmax(most, fabs(change_at(r, q->pos + 4 * p, a)));
        for (size_t n = 0; n < nodes->soa.count; n++)
            if (node_takes(r, n, a)) most = fmax(most, fabs(change_at(r, nodes->pos + 4 * n, a)));
    }
    return most;
}

static void change(const rigid *r) {
    gn_particles *q = &r->c->model->dem->particles,
                 *nodes = &gn_coupled_solid(r->c->model->solids)->nodes;
    for (size_t a = 0; a < r->dimension; a++) {
        for (size_t p = 0; p < q->soa.count; p++)
            if (particle_takes(r, p)) q->vel[4 * p + a] += change_at(r, q->pos + 4 * p, a);
        for (size_t n = 0; n < nodes->soa.count; n++)
            if (node_takes(r, n, a)) nodes->vel[4 * n + a] += change_at(r, nodes->pos + 4 * n, a);
    }
    for (size_t p = 0; q->spin && p < q->soa.count; p++)
        for (size_t k = r->dimension; k < r->count && particle_takes(r, p); k++)
            q->spin[4 * p + (r->dimension == 3 ? k - 3 : 2)] += r->motion[k] / r->size;
}

/* --- missing momentum --- */

/* Missing momentum. Of the angular momentum about the origin, only the part that is not due to the
 * rigid motion of the particles with scaled masses is restored, together with the corresponding
 * part of the momentum. */
typedef struct lack {
    double momentum[3], beside[3], turning[3]; /* kg m/s, kg m2/s */
    double most;                               /* m/s: largest change of a velocity */
} lack;

/* Computes J w from the second moments s of J and the spin w. */
static void turning_of(size_t dimension, const double s[6], const double spin[3], double out[3]) {
    const double trace = s[0] + s[1] + s[2];
    out[0] = out[1] = 0.0;
    out[2] = s[0] * spin[2];
    for (size_t a = 0; dimension == 3 && a < 3; a++) /* xy, yz and zx follow the squares */
        out[a] = (trace - s[a]) * spin[a] - s[3 + a] * spin[(a + 1) % 3] -
                 s[3 + (a + 2) % 3] * spin[(a + 2) % 3];
}

/* Means over the particles with scaled masses: the velocity and spin of their rigid motion. */
typedef struct means {
    double centre[3], velocity[3], spin[3]; /* m, m/s, rad/s */
} means;

static means means_of(const gn_conversion *conversion, gn_scaled scaled) {
    const gn_particles *q = &conversion->model->dem->particles;
    double mass = 0.0;
    means m = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_conversion_scales(conversion, scaled, p)) continue;
        const double own = 1.0 / q->vel[4 * p + 3];
        mass += own;
        for (size_t a = 0; a < 3; a++) {
            m.centre[a] += own * q->pos[4 * p + a];
            m.velocity[a] += own * q->vel[4 * p + a];
            m.spin[a] += q->spin ? own * q->spin[4 * p + a] : 0.0;
        }
    }
    for (int a = 0; mass > 0.0 && a < 3; a++) {
        m.centre[a] /= mass;
        m.velocity[a] /= mass;
        m.spin[a] /= mass;
    }
    return m;
}

/* Returns the root mean square velocity without the rigid motion of the body, m/s. */
static double speed_of(size_t dimension, const gn_tally *tally) {
    double centre[3], v[3], m[GN_BASIS_MOST][GN_BASIS_MOST] = {{0.0}}, spin[3],
                            energy = tally->energy;
    for (int a = 0; a < 3; a++) {
        centre[a] = tally->moment[a] / tally->mass;
        v[a] = tally->momentum[a] / tally->mass;
        energy -= 0.5 * tally->mass * v[a] * v[a];
    }
    const gn_tally own = gn_tally_about(tally, dimension, centre);
    const size_t axes = dimension == 3 ? 3 : 1;
    for (size_t k = 0; k < axes; k++) {
        double unit[3] = {0.0}, column[3];
        unit[axes == 3 ? k : 2] = 1.0;
        turning_of(dimension, own.second, unit, column);
        for (size_t l = 0; l < axes; l++) m[l][k] = column[axes == 3 ? l : 2];
        spin[k] = own.turning[axes == 3 ? k : 2];
    }
    if (gn_solve_positive(axes, m, spin))
        for (size_t k = 0; k < axes; k++) energy -= 0.5 * spin[k] * own.turning[axes == 3 ? k : 2];
    return sqrt(fmax(2.0 * energy / tally->mass, 0.0));
}

/* Returns a missing quantity, or zero if it is below the rounding of sums over the whole model;
 * `size`: largest possible value of the quantity. */
static double beyond_rounding(double missing, double size) {
    return fabs(missing) > 1e-14 * size ? missing : 0.0;
}

static lack lack_of(const gn_conversion *conversion, const gn_tally *before, gn_scaled scaled) {
    const size_t d = (size_t)conversion->model->ctx->scene.dimension;
    const gn_tally now = gn_conversion_tally(conversion), missing = gn_tally_less(before, &now);
    const means m = means_of(conversion, scaled);
    const gn_tally about = gn_tally_about(&missing, d, m.centre);
    const double trace = now.second[0] + (d == 3 ? now.second[1] + now.second[2] : 0.0);
    const double size = sqrt(2.0 * now.mass * now.energy), turns = sqrt(2.0 * trace * now.energy);
    double of_centre[3], of_inertia[3], turns_on[3], lever[3];
    lack l = {.most = most_changed * speed_of(d, &now) + least_changed * size / now.mass};
    gn_cross3(about.moment, m.velocity, of_centre);
    turning_of(d, about.second, m.spin, of_inertia);
    gn_cross3(m.spin, about.moment, turns_on);
    gn_cross3(m.centre, turns_on, lever);
    for (int a = 0; a < 3; a++) {
        const double stays = of_centre[a] + of_inertia[a] + lever[a];
        l.momentum[a] = beyond_rounding(missing.momentum[a], size);
        l.beside[a] = beyond_rounding(missing.momentum[a] - turns_on[a], size);
        l.turning[a] = beyond_rounding(missing.turning[a] - stays, turns);
    }
    return l;
}

/* --- restoring the momentum --- */

/* Finds the rigid motion that has the missing momentum and the fraction `part` of the angular
 * momentum; returns false if the receivers are too few, in a line, or held. */
static bool find_motion(rigid *r, const lack *l, double part) {
    double m[GN_BASIS_MOST][GN_BASIS_MOST] = {{0.0}}, lever[3];
    if (r->count > r->dimension && (!(r->size > 0.0) || !r->c->model->dem->particles.spin))
        return false;
    gn_cross3(r->centre, l->beside, lever);
    for (size_t k = 0; k < r->count; k++) {
        const size_t a = r->dimension == 3 ? k - 3 : 2;
        r->motion[k] =
            k < r->dimension ? l->momentum[k] : part * (l->turning[a] - lever[a]) / r->size;
    }
    find_masses(r, m);
    return gn_solve_positive(r->count, m, r->motion);
}

/* Finds the first set of receivers for which small changes are enough. */
static bool find_takers(const gn_conversion *conversion, const lack *l, bool turn, rigid *r) {
    for (int k = 0; k < TAKERS; k++) {
        *r = rigid_of(conversion, (takers)k);
        if (!turn) r->count = r->dimension;
        if (find_motion(r, l, 1.0) && most_change(r) <= l->most) return true;
    }
    return false;
}

/* Finds the velocity that restores the momentum; components that are prescribed for all receivers
 * are left out. */
static void find_velocity(rigid *r, const lack *l) {
    double m[GN_BASIS_MOST][GN_BASIS_MOST] = {{0.0}};
    r->count = r->dimension;
    find_masses(r, m);
    for (size_t a = 0; a < r->dimension; a++)
        r->motion[a] = m[a][a] > 0.0 ? l->momentum[a] / m[a][a] : 0.0;
}

/* Finds a motion with as much of the angular momentum as the receivers can take, or with the
 * momentum alone; returns the fraction of the angular momentum. */
static double find_rest(const gn_conversion *conversion, const lack *l, rigid *r) {
    double part = 0.0;
    if (find_motion(r, l, 1.0)) part = fmin(l->most / most_change(r), 1.0);
    if (part > 0.0 && find_motion(r, l, part)) return part;
    if (!find_takers(conversion, l, false, r)) find_velocity(r, l);
    return 0.0;
}

void gn_conversion_keep_momentum(const gn_conversion *conversion, const gn_tally *before,
                                 gn_scaled scaled) {
    const gn_convertible *model = conversion->model;
    gn_corrections *all = &model->converted->corrected;
    const lack l = lack_of(conversion, before, scaled);
    rigid r;
    const bool taken = find_takers(conversion, &l, true, &r);
    const double part = taken ? 1.0 : find_rest(conversion, &l, &r);
    const bool wider = r.chosen != TAKERS_CHANGED;
    const double beside = wider ? gn_conversion_held_beside(conversion) : 0.0;
    change(&r);
    gn_fem_to_single(gn_coupled_solid(model->solids));
    gn_coupled_follow(model->ctx, model->dem, model->solids,
                      model->zones); /* particles of zones follow their nodes */
    if (wider) {
        const double more = beside - gn_conversion_held_beside(conversion);
        model->ledger->energy.conversion += more;
        model->converted->parts.step += more;
    }
    if (!taken) all->least = all->missed > 0.0 ? fmin(all->least, part) : part;
    all->count += 1.0;
    all->wider += wider;
    all->missed += !taken;
}

/* --- remaining changes --- */

/* Returns the polar moment of inertia, kg m2. */
static double polar_of(size_t dimension, const gn_tally *own) {
    return own->second[0] + (dimension == 3 ? own->second[1] + own->second[2] : 0.0);
}

/* Returns the tally about its own centre of mass. */
static gn_tally about_own(const gn_tally *tally, size_t dimension, double centre[3]) {
    for (int a = 0; a < 3; a++) centre[a] = tally->moment[a] / tally->mass;
    return gn_tally_about(tally, dimension, centre);
}

/* Returns the scale for changes of the angular momentum about the centre of mass, kg m2/s: the
 * larger one of the body's own angular momentum and m v r of its vibration, with v the root mean
 * square velocity without the rigid motion, and r from the polar moment. It is the same in any
 * inertial frame. */
static double tally_turns(const gn_tally *tally, size_t dimension) {
    double centre[3];
    const gn_tally own = about_own(tally, dimension, centre);
    const double r = sqrt(polar_of(dimension, &own) / tally->mass);
    const double least = least_changed * sqrt(2.0 * tally->mass * tally->energy);
    return fmax(sqrt(gn_dot3(own.turning, own.turning)),
                r * (tally->mass * speed_of(dimension, tally) + least));
}

/* Between conversions, the motion of a free body does not alter the changes of angular momentum and
 * centre of mass that the earlier ones caused, so that these add up as vectors. */
void gn_conversion_note_jumps(const gn_conversion *conversion, const gn_tally *before,
                              const gn_tally *now) {
    const size_t d = (size_t)conversion->model->ctx->scene.dimension;
    gn_corrections *all = &conversion->model->converted->corrected;
    double from[3], to[3];
    const gn_tally was = about_own(before, d, from), is = about_own(now, d, to);
    for (int a = 0; a < 3; a++) {
        all->turned[a] += is.turning[a] - was.turning[a];
        all->centre[a] += to[a] - from[a];
    }
    all->inertia += polar_of(d, &is) / polar_of(d, &was) - 1.0;
    all->most = fmax(all->most, sqrt(gn_dot3(all->turned, all->turned)));
    all->scale = fmax(all->scale, tally_turns(before, d));
}
