/* The contact kernels: every variant of every instruction set against the scalar one, and the
 * scalar one against an independent computation in plain doubles. */
#include "kernels/law_scalar.h"
#include "neigh/neigh.h"
#include "partials_help.h"
#include "soa/single.h"
#include "world_helpers.h"

#include "kernels/cohesion.h"

#include <float.h>

enum { CONTACTS = 1211 }; /* a part of a block, and a part of a vector */

/* --- a list of contacts in every state --- */

typedef struct bench {
    gn_particles p;
    gn_contacts k;
    gn_partials sums;
    gn_contact_args args;
    int space;
} bench;

static void random_direction(uint64_t *at, int space, double n[3]) {
    double size;
    do {
        for (int a = 0; a < 3; a++) n[a] = a < 2 || space ? uniform(at, -1.0, 1.0) : 0.0;
        size = sqrt(dot3(n, n));
    } while (size > 1.0 || size < 0.1);
    for (int a = 0; a < 3; a++) n[a] /= size;
}

/* Two spheres of about 1 mm; the distance changes by at most 1e-3 of the radii, the normal and the
 * spins rotate by some 1e-5 in a step: the size of a real step. */
static void place_contact(bench *b, size_t c, uint64_t *at) {
    double *xi = b->p.pos + 4 * b->k.i[c], *xj = b->p.pos + 4 * b->k.j[c], n[3];
    random_direction(at, b->space, n);
    xi[3] = uniform(at, 0.5e-3, 2e-3);
    xj[3] = uniform(at, 0.5e-3, 2e-3);
    double sum = xi[3] + xj[3], distance = sum * (1.0 + uniform(at, -2e-3, 1e-3));
    if (c % 97 == 13) distance = 0.0; /* coincident centres */
    for (int a = 0; a < 2 + b->space; a++) {
        xi[a] = uniform(at, -0.02, 0.02);
        xj[a] = xi[a] + distance * n[a];
        if (b->args.period[a] > 0.0 && distance > 0.0 && c % 3 == 0)
            xj[a] += b->args.period[a] * (c % 2 ? 1.0 : -1.0);
    }
    for (int a = 0; a < 3; a++) {
        bool moves = (a < 2 || b->space) && c % 31 != 5; /* some particles are at rest */
        b->p.vel[4 * b->k.i[c] + a] = moves ? uniform(at, -0.05, 0.05) : 0.0;
        b->p.vel[4 * b->k.j[c] + a] = moves ? uniform(at, -0.05, 0.05) : 0.0;
        bool spins = (a == 2 || b->space) && c % 29 != 7;
        if (b->p.spin) b->p.spin[4 * b->k.i[c] + a] = spins ? uniform(at, -50.0, 50.0) : 0.0;
        if (b->p.spin) b->p.spin[4 * b->k.j[c] + a] = spins ? uniform(at, -50.0, 50.0) : 0.0;
    }
}

/* Vector from i to j (nearest image), now and one step ago. */
static void separation(const bench *b, size_t c, double now[3], double before[3]) {
    const double *xi = b->p.pos + 4 * b->k.i[c], *xj = b->p.pos + 4 * b->k.j[c];
    for (int a = 0; a < 3; a++) {
        double period = b->k.soa.effects & GN_FX_PERIODIC ? b->args.period[a] : 0.0;
        now[a] = xj[a] - xi[a];
        if (a == 2 && !b->space)
            now[a] = 0.0;
        else if (period > 0.0)
            now[a] -= period * floor(now[a] / period + 0.5);
        before[a] =
            now[a] - b->args.dt * (b->p.vel[4 * b->k.j[c] + a] - b->p.vel[4 * b->k.i[c] + a]);
    }
}

/* Bonds that carry moments: some that are bent and twisted beyond their strength, most below. */
static void set_beam(bench *b, size_t c, double scale, uint64_t *at) {
    gn_contacts *k = &b->k;
    double ri = b->p.pos[4 * k->i[c] + 3], rj = b->p.pos[4 * k->j[c] + 3];
    k->beam[c] = fmin(ri, rj) * uniform(at, 0.5, 1.5);
    k->share[c] = uniform(at, 0.0, 1.0);
    for (size_t a = 0; a < 3; a++) {
        double m = scale * k->beam[c] * uniform(at, -0.2, 0.2);
        if ((a < 2 && !b->space) || (k->rn[c] < 0.0)) m = 0.0;
        if (k->moment) k->moment[c + a * k->soa.capacity] = m;
        if (k->moment_f) k->moment_f[c + a * k->soa.capacity] = (float)m;
    }
}

/* Bonds in any state of softening, of laws that have it. */
static void set_softening(gn_contacts *k, size_t c, double scale, uint64_t *at) {
    const size_t n = k->soa.capacity;
    double kn = k->kn[c], strength = fabs(k->rn[c]), limit = strength / kn;
    double end = limit * uniform(at, 2.5, 5.0), slope = strength / (end - limit);
    double far = limit + (c % 2 ? 0.8 * (end - limit) * uniform(at, 0.0, 1.0) : 0.0);
    double d = 1.0 - slope * (end - far) / (kn * far), mu2 = k->mu ? k->mu[c] : 0.0;
    k->kappa[c] = c % 3 ? uniform(at, 0.0, 0.9) : 0.0;
    double worst = fmax(d, k->kappa[c]);
    double most = k->rt[c] + fmax(0.0, k->mu1[c] - mu2) * 3.0 * scale; /* H is at most k_t/2 */
    const double fade[] = {slope, end, k->rt[c], most / k->kt[c] * uniform(at, 2.0, 4.0),
                           k->mu1[c]};
    for (size_t x = 0; x < 5; x++) k->fade[c + x * n] = fade[x];
    k->soft[c] = 1.0 - d;
    k->rn[c] = copysign(slope * (end - far), k->rn[c]);
    k->rt[c] *= 1.0 - worst;
    k->mu1[c] = (1.0 - k->kappa[c]) * k->mu1[c] + k->kappa[c] * mu2;
    if (!k->crush) return;
    for (size_t x = 0; x < 3; x++) {
        k->crush[c + x * n] = scale * (0.4 + 0.4 * (double)x);
        k->crush[c + (x + 3) * n] = 0.25;
    }
    double path = scale * uniform(at, 0.0, 1.0),
           lost = 0.25 * fmax(0.0, path - 0.4 * scale) + 0.25 * fmax(0.0, path - 0.8 * scale);
    double yields = fmax(path - lost, 0.4 * scale);
    if (k->plastic) k->plastic[c] = -lost / kn;
    if (k->plastic_f) k->plastic_f[c] = (float)(-lost / kn);
    if (k->yields) k->yields[c] = yields;
    if (k->yields_f) k->yields_f[c] = (float)yields;
}

/* Hertz contacts, as stiff as the others at an overlap of 1e-3; some with the same overlap in the
 * last step, some with more, some with less, and some beyond the overlap for which the step was
 * checked. */
static void set_hertz(gn_contacts *k, size_t c, double kn, double sum, uint64_t *at) {
    double root = sqrt(1e-3 * sum), closeness = c % 5 == 4 ? 0.0 : uniform(at, 0.7, 1.5) / root;
    k->kn[c] = kn / root;
    if (k->kt) k->kt[c] = kn / root / uniform(at, 1.0, 1.5);
    if (k->cn) k->cn[c] /= sqrt(kn);
    if (k->lag) k->lag[c] = uniform(at, 0.0, 0.2) / sqrt(kn);
    if (k->closeness) k->closeness[c] = closeness;
    if (k->closeness_f) k->closeness_f[c] = (float)closeness;
    k->most[c] = uniform(at, 0.5e-3, 4e-3) * sum;
}

/* Attractive contacts: some adhere already, and some of these are pulled beyond the end of their
 * neck or bridge; with liquid some are dry, and some bridges have just formed. */
static void set_attraction(bench *b, size_t c, double scale, uint64_t *at) {
    gn_contacts *k = &b->k;
    double sum = b->p.pos[4 * k->i[c] + 3] + b->p.pos[4 * k->j[c] + 3];
    bool wet = b->args.cohesion == GN_COHESION_LIQUID;
    k->adhesion[c] = scale * uniform(at, 0.05, 0.5);
    k->span[c] = wet ? -0.5 * sum : uniform(at, 0.2e-3, 0.8e-3) * sum;
    if (b->args.cohesion == GN_COHESION_DMT) k->span[c] = 0.0;
    k->bridge[c] = c % 3 == 0 ? 0.0 : wet ? pow(uniform(at, 0.2e-3, 1.5e-3) * sum, 3.0) : 1.0;
    k->onset[c] = !wet ? 0.0 : c % 3 == 0 && c % 2 == 0 ? GN_BRIDGE_DRY : c % 7 == 0 ? 0.8 : 0.0;
}

/* Contacts that resist rolling, some at their limit. */
static void set_roll(bench *b, size_t c, double scale, uint64_t *at) {
    gn_contacts *k = &b->k;
    double ri = b->p.pos[4 * k->i[c] + 3], rj = b->p.pos[4 * k->j[c] + 3];
    k->reduced[c] = ri * rj / (ri + rj);
    k->rolling[c] = k->reduced[c] * uniform(at, 0.0, 0.5);
    k->twisting[c] = k->reduced[c] * uniform(at, 0.0, 0.5);
    for (size_t a = 0; a < 3; a++) {
        double m = a == 2 || b->space ? scale * k->reduced[c] * uniform(at, -0.2, 0.2) : 0.0;
        if (k->roll) k->roll[c + a * k->soa.capacity] = m;
        if (k->roll_f) k->roll_f[c + a * k->soa.capacity] = (float)m;
    }
}

/* Joints that are open or closed, and some that close, open or break in the step. */
static void set_joint(bench *b, size_t c, double scale, uint64_t *at) {
    gn_contacts *k = &b->k;
    double n[3] = {0}, size2 = 0.0;
    for (int a = 0; a < 2 + b->space; a++) {
        n[a] = uniform(at, -1.0, 1.0);
        size2 += n[a] * n[a];
    }
    for (size_t a = 0; a < 3; a++) k->plane[c + a * k->soa.capacity] = n[a] / sqrt(size2);
    k->apart[c] = scale / k->kn[c] * uniform(at, -1.0, 1.0) * (c % 3 ? 1.0 : 1e-4);
    k->slip[c] = uniform(at, 0.0, 2e-6);
    k->dilation[c] = uniform(at, 0.0, 0.4);
    k->dilation[c + k->soa.capacity] = 1e-6;
}

static void set_contact(bench *b, size_t c, uint64_t *at) {
    gn_contacts *k = &b->k;
    double ri = b->p.pos[4 * k->i[c] + 3], rj = b->p.pos[4 * k->j[c] + 3],
           kn = uniform(at, 1e6, 2e7);
    double scale = kn * 1e-3 * (ri + rj); /* size of the forces, N */
    k->kn[c] = kn;
    if (k->kt) k->kt[c] = kn / uniform(at, 1.0, 4.0);
    if (k->mu) k->mu[c] = uniform(at, 0.0, 0.8);
    if (k->cn) k->cn[c] = uniform(at, 0.0, 2.0);
    double fd = k->cn ? uniform(at, -0.1, 0.1) : 0.0;
    if (k->fd) k->fd[c] = fd;
    if (k->fd_f) k->fd_f[c] = (float)fd;
    if (k->length0) k->length0[c] = (ri + rj) * (1.0 + uniform(at, -1e-3, 1e-3));
    if (k->rn) k->rn[c] = scale * uniform(at, 0.1, 1.5) * (c % 4 == 3 ? -1.0 : 1.0);
    if (k->rt) k->rt[c] = scale * uniform(at, 0.1, 1.5);
    if (k->beam) set_beam(b, c, scale, at);
    if (k->mu1) k->mu1[c] = uniform(at, 0.0, 1.2);
    if (k->soft) set_softening(k, c, scale, at);
    if (k->most) set_hertz(k, c, kn, ri + rj, at);
    if (k->adhesion) set_attraction(b, c, scale, at);
    if (k->reduced) set_roll(b, c, scale, at);
    if (k->plane) set_joint(b, c, scale, at);
    if (!k->kt || c % 5 == 4) return;
    double d[3], old[3], t[3];
    separation(b, c, d, old);
    for (int a = 0; a < 3; a++) t[a] = a < 2 || b->space ? scale * uniform(at, -0.6, 0.6) : 0.0;
    double share = dot3(t, old) / fmax(dot3(old, old), 1e-30);
    for (size_t a = 0; a < 3; a++) {
        double now = t[a] - share * old[a];
        if (k->shear) k->shear[c + a * k->soa.capacity] = now;
        if (k->shear_f) k->shear_f[c + a * k->soa.capacity] = (float)now;
    }
}

/* Effects without variants of their own, in turn. */
static gn_effects with_options(gn_effects effects, uint64_t turn) {
    static const gn_effects couplings[] = {0, GN_FX_COUPLED_QUADRATIC, GN_FX_COUPLED_LINEAR};
    if (effects & GN_FX_HERTZ) return effects | (turn % 2 ? GN_FX_NO_PULL : 0);
    static const gn_effects inelastic[] = {0, GN_FX_YIELD, GN_FX_COUPLED_LINEAR | GN_FX_YIELD,
                                           GN_FX_COUPLED_QUADRATIC};
    if (effects & GN_FX_SOFTENING) return effects | inelastic[turn % 4];
    return effects & GN_FX_MOHR ? effects | couplings[turn % 3] : effects;
}

static bench make_bench(gn_effects effects, uint64_t seed) {
    bench b = {.space = effects & GN_FX_SPACE ? 1 : 0};
    effects = with_options(effects, seed / 1000);
    uint64_t at = seed;
    assert_int_equal(gn_soa_create(&gn_particle_record, &b.p, 2 * CONTACTS, effects, NULL),
                     GNEISS_OK);
    effects |= GN_FX_CONTACT_FORCES;
    assert_int_equal(gn_soa_create(&gn_contact_record, &b.k, CONTACTS, effects, NULL), GNEISS_OK);
    b.args = (gn_contact_args){.pos = b.p.pos,
                               .vel = b.p.vel,
                               .spin = b.p.spin,
                               .dt = 1e-6,
                               .arm_factor = 0.5,
                               .time = 0.25,
                               .cohesion = effects & GN_FX_COHESION ? (int)(1 + seed / 1000 % 3)
                                                                    : GN_COHESION_NONE,
                               .rupture = 1.3,
                               .measure = true};
    if (effects & GN_FX_PERIODIC)
        for (int a = 0; a < 3; a++) {
            b.args.period[a] = 0.05 + 0.01 * a;
            b.args.inverse_period[a] = 1.0 / b.args.period[a];
        }
    for (size_t c = 0; c < CONTACTS; c++) {
        b.k.i[c] =
            (int32_t)(c * 2 * 331 % (2 * CONTACTS)); /* scattered rows; 331 is coprime to 1211 */
        b.k.j[c] = b.k.i[c] + 1;
        place_contact(&b, c, &at);
        set_contact(&b, c, &at);
    }
    gn_particles_set_null(&b.p, 0.01);
    gn_contacts_pad(&b.k, &b.p);
    return b;
}

/* The working set of mixed precision: particles have travelled by up to 1 % of a radius since the
 * lists were made; coincident centres have not. */
static void make_single(bench *b, uint64_t seed) {
    uint64_t at = seed;
    for (size_t c = 0; c < CONTACTS; c++)
        for (int a = 0; a < 2 + b->space; a++) {
            bool travels = c % 97 != 13;
            size_t i = 4 * (size_t)b->k.i[c] + (size_t)a, j = 4 * (size_t)b->k.j[c] + (size_t)a;
            b->p.ref[i] = b->p.pos[i] - (travels ? uniform(&at, -1e-5, 1e-5) : 0.0);
            b->p.ref[j] = b->p.pos[j] - (travels ? uniform(&at, -1e-5, 1e-5) : 0.0);
        }
    gn_particles_to_single(&b->p, b->p.ref, 1);
    gn_contacts_to_single(&b->k, &b->p, b->args.period, 1);
    b->args.pos_f = b->p.travel_f;
    b->args.vel_f = b->p.vel_f;
    b->args.spin_f = b->p.spin_f;
}

static void free_bench(bench *b) {
    gn_partials_free(&b->sums);
    gn_soa_destroy(&gn_particle_record, &b->p);
    gn_soa_destroy(&gn_contact_record, &b->k);
}

static gn_contact_sums run(bench *b, gn_contact_kernel *kernel) {
    gn_contact_sums total = {0};
    b->args.contacts = &b->k;
    assert_int_equal(gn_partials_build(&b->k, 2 * CONTACTS, 1, &b->sums, NULL), GNEISS_OK);
    b->args.partials = &b->sums;
    assert_true(b->sums.blocks > 2);
    for (size_t c = 0; c < CONTACTS; c += b->sums.length) {
        gn_contact_sums s = {0};
        size_t end = c + b->sums.length < CONTACTS ? c + b->sums.length : CONTACTS;
        kernel(&b->args, c, end, &s);
        gn_contact_sums_add(&total, &s);
    }
    return total;
}

/* Every field, kernel output included, item by item over the valid contacts. */
static void assert_same_contacts(const gn_contacts *a, const gn_contacts *b, const char *name) {
    for (size_t f = 0; f < gn_contact_record.field_count; f++) {
        const gn_field *field = &gn_contact_record.fields[f];
        const char *x = gn_field_data(field, a), *y = gn_field_data(field, b);
        if (!x) continue;
        bool rows = field->layout == GN_ROWS;
        size_t item = gn_type_size(field->type) * (size_t)(rows ? field->components : 1);
        for (int s = 0; s < (rows ? 1 : field->components); s++) {
            size_t base = item * a->soa.capacity * (size_t)s;
            if (memcmp(x + base, y + base, item * a->soa.count) != 0)
                fail_msg("%s: field %s differs from the scalar kernel", name, field->name);
        }
    }
}

/* --- the formulas again --- */

typedef struct expected {
    double force[3], moment[3], shear[3], couple[3], fd, tolerance, couple_tolerance, pressed, root;
    int cause;
    bool open, slipping;
} expected;

typedef struct tally {
    double elastic_normal, elastic_shear, elastic_bending, friction, damping, breaking, rolling,
        cohesion, scale;
} tally;

/* Turns t by the angle between a and b, about a x b (Rodrigues). */
static void rotate_from_to(const double a[3], const double b[3], double t[3]) {
    double axis[3], side[3];
    cross3(a, b, axis);
    double sine = sqrt(dot3(axis, axis));
    if (sine == 0.0) return;
    double angle = asin(sine);
    for (int k = 0; k < 3; k++) axis[k] /= sine;
    cross3(axis, t, side);
    double along = dot3(axis, t) * 2.0 * sin(0.5 * angle) * sin(0.5 * angle);
    for (int k = 0; k < 3; k++) t[k] = t[k] * cos(angle) + side[k] * sine + axis[k] * along;
}

static void rotate_about(const double n[3], double angle, double t[3]) {
    double side[3];
    cross3(n, t, side);
    for (int k = 0; k < 3; k++) t[k] = t[k] * cos(angle) + side[k] * sin(angle);
}

/* An independent computation of the moments of a bond: their values after the step, their
 * contributions to the forces that are compared with the strength, and their energies. */
typedef struct bending {
    double moment[3], normal, shear, stored, released, size;
} bending;

static double along_and_across(double m[3], const double n[3]) {
    double along = dot3(m, n);
    for (int a = 0; a < 3; a++) m[a] -= along * n[a];
    return along;
}

static bending bend(const bench *b, size_t c, const double n_old[3], const double middle[3],
                    const double n[3], double twist_rate) {
    const gn_contacts *k = &b->k;
    bending r = {{0}, 0, 0, 0, 0, 0};
    if (!k->moment) return r;
    const double *wi = b->p.spin + 4 * k->i[c], *wj = b->p.spin + 4 * k->j[c], dt = b->args.dt;
    double r2 = k->beam[c] * k->beam[c], turn[3], old[3], twist = 0.0, twist_old = 0.0;
    double kb = k->kn[c] * r2 * (b->space ? 0.25 : 1.0 / 3.0),
           kw = b->space ? k->kt[c] * r2 / 2 : 0;
    for (int a = 0; a < 3; a++) {
        old[a] = k->moment[c + (size_t)a * k->soa.capacity];
        turn[a] = dt * (wj[a] - wi[a]);
    }
    double spun = dot3(turn, turn);
    if (b->space && dot3(n, n) > 0.0) { /* coincident centres have no normal */
        twist_old = along_and_across(old, n_old);
        rotate_from_to(n_old, n, old);
        rotate_about(n, dt * twist_rate, old);
        twist = twist_old + kw * along_and_across(turn, middle);
        rotate_from_to(middle, n, turn);
        rotate_about(n, 0.5 * dt * twist_rate, turn);
    }
    double work = 0.0, size2 = 0.0;
    for (int a = 0; a < 3; a++) {
        double now = old[a] + kb * turn[a];
        work += now * old[a] / kb;
        size2 += now * now;
        r.moment[a] = now + twist * n[a];
    }
    double z = k->share[c] / k->beam[c];
    r.normal = (b->space ? 4.0 : 3.0) * z * sqrt(size2);
    r.shear = 2.0 * z * fabs(twist);
    r.stored = 0.5 * size2 / kb + (kw > 0.0 ? 0.5 * twist * twist / kw : 0.0);
    r.released = 0.5 * work + (kw > 0.0 ? 0.5 * twist * twist_old / kw : 0.0);
    r.size = sqrt(dot3(r.moment, r.moment)) + (kb + kw) * sqrt(spun);
    return r;
}

/* Recomputes moments against rolling under the pressing force, with the tangential spring at `root`
 * of its stiffness (1 by the linear law). */
static void expect_roll(const bench *b, size_t c, const double n_old[3], const double middle[3],
                        const double n[3], double twist_rate, double pressed, double root,
                        expected *e, tally *sum) {
    const gn_contacts *k = &b->k;
    const double *wi = b->p.spin + 4 * k->i[c], *wj = b->p.spin + 4 * k->j[c], dt = b->args.dt;
    double kr = k->kt[c] * k->reduced[c] * k->reduced[c], old[3], turn[3];
    double past = k->closeness ? k->closeness[c] : 1.0, now = root > 0.0 ? 1.0 / root : 0.0;
    double shrunk = fmin(1.0, root * past), twist_old = 0.0, turned = 0.0, size2 = 0.0;
    for (int a = 0; a < 3; a++) {
        old[a] = k->roll[c + (size_t)a * k->soa.capacity];
        turn[a] = a == 2 || b->space ? dt * (wj[a] - wi[a]) : 0.0;
    }
    double spun = sqrt(dot3(turn, turn)), held = sqrt(dot3(old, old));
    if (b->space && dot3(n, n) > 0.0) {
        twist_old = along_and_across(old, n_old);
        rotate_from_to(n_old, n, old);
        rotate_about(n, dt * twist_rate, old);
        turned = along_and_across(turn, middle);
        rotate_from_to(middle, n, turn);
        rotate_about(n, 0.5 * dt * twist_rate, turn);
    }
    double limit = k->twisting[c] * pressed, m[3], work = 0.0;
    double twist = fmax(-limit, fmin(limit, shrunk * twist_old + kr * root * turned));
    for (int a = 0; a < 3; a++) m[a] = shrunk * old[a] + kr * root * turn[a];
    double size = sqrt(dot3(m, m)), most = k->rolling[c] * pressed;
    for (int a = 0; a < 3; a++) {
        if (size > most) m[a] *= most / size;
        work += 0.5 * (old[a] + m[a]) * turn[a];
        size2 += m[a] * m[a];
        e->couple[a] = m[a] + twist * n[a];
    }
    double before = 0.5 * (dot3(old, old) + twist_old * twist_old) * past / kr;
    double after = 0.5 * (size2 + twist * twist) * now / kr;
    work += 0.5 * (twist_old + twist) * turned;
    sum->rolling += before + work - after;
    sum->elastic_bending += after;
    sum->scale += before + after + fabs(work);
    e->couple_tolerance = 1e-12 * (held + kr * root * spun);
}

/* Returns the cause of a break, from the spring's force and the tangential force before any
 * limit. */
static int cause_of(const gn_contacts *k, size_t c, double normal, double shear) {
    gn_effects fx = k->soa.effects;
    double rn = k->rn[c], rt = k->rt ? k->rt[c] : INFINITY;
    if (normal >= rn) return GN_BROKEN_TENSION;
    if (k->mu1 && (normal < 0.0 || fx & GN_FX_COUPLED_LINEAR))
        rt = fmax(0.0, rt - k->mu1[c] * normal);
    if (k->mu1 && fx & GN_FX_COUPLED_QUADRATIC && normal > 0.0) {
        double a = normal / rn, b = shear / rt;
        if (a * a + b * b < 1.0) return GN_INTACT;
        return a >= b ? GN_BROKEN_TENSION : GN_BROKEN_SHEAR;
    }
    return shear >= rt ? GN_BROKEN_SHEAR : GN_INTACT;
}

/* Motion of a contact in the step: n now, the velocity along it, and that across the normal of the
 * middle, rotated to n; path: growth of the distance. */
typedef struct motion {
    double n[3], stretch, vn, vt[3], path, before[3];
} motion;

/* Allowed error of moments against rolling, N m: that of moments of bonds (see expect), and the
 * rounding of the pressing force. */
static double roll_slack(const bench *b, size_t c, double side2, double length, double twist,
                         double vn, const expected *e) {
    const gn_contacts *k = &b->k;
    if (!k->roll || !(length > 0.0)) return 0.0;
    double dt = b->args.dt, half2 = length < 1e-4 ? 0.0 : 0.25 * side2 / (length * length);
    double moment = 1e12 * e->couple_tolerance;
    return (half2 + 0.125 * pow(dt * twist, 2.0) + sqrt(half2) * fabs(dt * vn) / length) * moment +
           (k->rolling[c] + k->twisting[c]) * e->tolerance;
}

static double pot(const gn_contacts *k, size_t c, double overlap) {
    double root = sqrt(k->kn[c] * sqrt(overlap));
    return k->cn[c] * root / (1.0 + k->lag[c] * root);
}

/* The dashpot of Hertz's law: if the contact began or ended in the step, with the factor that makes
 * sums of u^(1/4) equal to integrals. */
static double hertz_viscous(const gn_contacts *k, size_t c, const motion *m, double normal) {
    double u = fmax(0.0, -m->stretch), past = m->path - m->stretch, way = fabs(m->path);
    bool pulls = !(k->soa.effects & GN_FX_NO_PULL);
    double coefficient = pot(k, c, u), s = u / way, a = past / way;
    if (u > 0.0 && past <= 0.0)
        coefficient = pot(k, c, way) * (0.32045 + s - 0.122 * s * (1.0 - s));
    if (u == 0.0 && past > 0.0)
        coefficient =
            pulls ? pot(k, c, way) * (0.32045 + a - 0.122 * a * (1.0 - a) - pow(a, 0.25)) : 0.0;
    return pulls ? coefficient * m->vn : fmin(coefficient * m->vn, -normal);
}

/* An independent computation of attraction; in `fn` and `stored` those of Hertz's spring. */
typedef struct pulled {
    bool grips;
    double fn, root, beside, stored, lost, steep; /* steep: N/m, for the tolerance */
} pulled;

/* Returns the part of the step's path beyond a jump, 0 to 1; without a path the force acts for the
 * whole step. */
static double beyond_jump(double path, double beyond) {
    return path != 0.0 ? fmin(fmax(beyond / fabs(path), 0.0), 1.0) : 0.5;
}

/* Returns the change of a share of A per length. */
static double steep_jump(double A, double path) {
    return path != 0.0 ? A / fabs(path) : 0.0;
}

static pulled expect_adhesion(const bench *b, size_t c, const motion *m, double u, pulled p) {
    const double A = b->k.adhesion[c], span = b->k.span[c], gap = m->stretch;
    const bool jkr = b->args.cohesion == GN_COHESION_JKR, before = b->k.bridge[c] > 0.0;
    p.grips = u > 0.0 || (before && gap < span);
    if (!p.grips) {
        p.root = 0.0;
        p.fn = before ? (jkr ? 5.0 / 9.0 : 1.0) * A * (0.5 - beyond_jump(m->path, gap - span)) : 0;
        p.lost = before ? 4.0 / 45.0 * A * span : 0.0;
        p.steep = before ? steep_jump(A, m->path) : 0.0;
        p.stored = 0.0;
        return p;
    }
    p.beside = jkr ? 2.0 * A : A;
    p.steep = before ? 0.0 : steep_jump(A, m->path);
    if (jkr) { /* the root of s^4 - 4 s - q by Ferrari and Cardano */
        double q = -3.0 * gap / span, w = 4.0 * q / 3.0;
        double y = cbrt(8.0 + sqrt(fmax(64.0 + w * w * w, 0.0))), z = y - w / y;
        double s = 0.5 * (sqrt(z) + sqrt(fmax(8.0 / sqrt(z) - z, 0.0)));
        for (int n = 0; n < 3 && s > 1.0 + 1e-4; n++)
            s -= (pow(s, 4.0) - 4.0 * s - q) / (4.0 * s * s * s - 4.0);
        p.fn = -A * (pow(s, 6.0) - 6.0 * s * s * s) / 9.0;
        p.stored = A * span / 36.0 *
                   (8.0 / 15.0 * pow(s, 10.0) - 16.0 / 3.0 * pow(s, 7.0) + 8.0 * pow(s, 4.0));
        p.root = s * s * sqrt(span / 3.0);
        /* Near the separation the force changes with the root of the stretch. */
        p.steep += A / span * (2.0 + 3.0 / fmax(s - 1.0, 1e-6)) * (1.0 + s * s);
    } else {
        p.fn += A;
        p.stored -= A * u;
    }
    if (before) return p;
    p.fn += (jkr ? 8.0 / 9.0 : 1.0) * A * (beyond_jump(m->path, u) - 0.5);
    p.lost = jkr ? 8.0 / 15.0 * cbrt(4.0) * A * span : 0.0;
    return p;
}

static pulled expect_bridge(const bench *b, size_t c, const motion *m, double u, pulled p) {
    const double A = b->k.adhesion[c], V = b->k.bridge[c], sphere = fabs(b->k.span[c]);
    const double gap = fmax(m->stretch, 0.0), far = cbrt(1.3 * V), x = 0.5 * gap / sqrt(V / sphere);
    const double end = 0.5 * far / sqrt(V / sphere);
    if (!(V > 0.0)) return p;
    if (gap > far) {
        p.fn += A / (1.0 + 2.1 * end + 10.0 * end * end) *
                (m->path > 0.0 ? 0.5 - beyond_jump(m->path, gap - far) : 0.0);
        p.steep = steep_jump(A, m->path);
        return p;
    }
    p.beside = A / (1.0 + 2.1 * x + 10.0 * x * x);
    p.fn += (1.0 + b->k.onset[c]) * p.beside;
    p.steep = 4.0 * A / sqrt(V / sphere);
    double sum = 0.0; /* the work to the rupture, by Simpson's rule */
    for (int n = 0; n <= 400; n++) {
        double at = x + (end - x) * n / 400.0;
        sum += (n == 0 || n == 400 ? 1.0 : n % 2 ? 4.0 : 2.0) / (1.0 + 2.1 * at + 10.0 * at * at);
    }
    p.stored -= A * (u + 2.0 * sqrt(V / sphere) * sum * (end - x) / 1200.0);
    return p;
}

/* An independent computation of Hertz-Mindlin contacts; `of`: m, rounding of the overlap. */
static expected expect_hertz(const bench *b, size_t c, const motion *m, double of, tally *sum) {
    const gn_contacts *k = &b->k;
    expected e = {0};
    double u = fmax(0.0, -m->stretch), dt = b->args.dt;
    double fn = -2.0 / 3.0 * k->kn[c] * pow(u, 1.5), kt = k->kt ? k->kt[c] : 0.0;
    double viscous = k->cn ? hertz_viscous(k, c, m, fn) : 0.0, t[3] = {0}, size = 0.0, limit = 0.0;
    pulled p = {.grips = u > 0.0, .fn = fn, .root = sqrt(u), .stored = -0.4 * fn * u};
    if (b->args.cohesion == GN_COHESION_LIQUID)
        p = expect_bridge(b, c, m, u, p);
    else if (k->adhesion)
        p = expect_adhesion(b, c, m, u, p);
    double root = p.root;
    fn = p.fn;
    double past = k->closeness ? k->closeness[c] : 0.0, shrunk = fmin(1.0, root * past);
    double held = 0.0, now = 0.0, work = 0.0;
    for (int a = 0; k->shear && a < 3; a++)
        t[a] = shrunk * m->before[a] + kt * root * dt * m->vt[a];
    size = sqrt(dot3(t, t));
    e.pressed = p.grips ? fmax(0.0, p.beside - (fn + viscous)) : 0.0;
    if (k->mu) limit = k->mu[c] * e.pressed;
    e.slipping = size > limit;
    for (int a = 0; a < 3; a++) {
        if (e.slipping) t[a] *= limit / size;
        e.force[a] = (fn + viscous) * m->n[a] + t[a];
        e.shear[a] = t[a];
        work += 0.5 * (m->before[a] + t[a]) * dt * m->vt[a];
    }
    if (kt > 0.0) held = 0.5 * dot3(m->before, m->before) * past / kt;
    if (kt > 0.0 && p.grips) now = 0.5 * dot3(t, t) / (kt * root);
    e.root = root;
    e.open = !p.grips;
    e.fd = viscous;
    if (k->shear && k->soa.effects & GN_FX_ROTATION) cross3(m->n, t, e.moment);
    e.tolerance = 1e-12 * sqrt(dot3(e.force, e.force)) + k->kn[c] * sqrt(u + of) * of;
    e.tolerance += p.steep * of;
    if (k->cn)
        e.tolerance += fabs(m->vn) * (pot(k, c, u + of) - pot(k, c, u)) +
                       3.0 * fabs(viscous) * of / fmax(fabs(m->path), of);
    sum->friction += held + work - now;
    sum->elastic_normal += p.stored;
    sum->cohesion += p.lost;
    sum->elastic_shear += now;
    if (k->fd) sum->damping += 0.5 * (k->fd[c] + viscous) * m->path;
    sum->scale += fabs(fn) * u + fabs(p.stored) + held + now + fabs(work) +
                  (fabs(viscous) + (k->fd ? fabs(k->fd[c]) : 0.0)) * fabs(m->vn) * dt;
    return e;
}

/* An independent computation of a joint; vr: velocity at the contact; n: normal of the branch;
 * slack: m, error of the path. */
static expected expect_joint(const bench *b, size_t c, const double vr[3], const double n[3],
                             double slack, tally *sum) {
    const gn_contacts *k = &b->k;
    expected e = {0};
    double plane[3], before[3], trial[3], t[3], dt = b->args.dt, kn = k->kn[c], kt = k->kt[c];
    for (size_t a = 0; a < 3; a++) plane[a] = k->plane[c + a * k->soa.capacity];
    for (size_t a = 0; a < 3; a++) before[a] = k->shear[c + a * k->soa.capacity];
    double path = dt * dot3(vr, plane), past = k->apart[c], u = past + path, mu = 0.0;
    for (int a = 0; a < 3; a++) t[a] = trial[a] = before[a] + kt * (dt * vr[a] - path * plane[a]);
    double size = sqrt(dot3(trial, trial)), fn = kn * u, way = u, ds = 0.0, opens = 0.0;
    bool bonded = k->rn[c] > 0.0;
    if (bonded) e.cause = cause_of(k, c, fn, size);
    bool intact = bonded && !e.cause, crosses = false;
    if (!intact && u >= 0.0) fn = 0.0;
    if (!bonded && u < 0.0 && past >= 0.0) {
        fn = 0.5 * kn * u * (1.0 + u / path);
        way = path;
        crosses = true;
    } else if (!bonded && u >= 0.0 && past < 0.0) {
        fn = -0.5 * kn * past * u / path;
        way = -path;
        crosses = true;
    }
    if (k->mu) mu = k->mu[c];
    double pressed = fmax(0.0, -fn), tangent = k->dilation[c];
    if (crosses || u >= 0.0 || k->slip[c] >= k->dilation[c + k->soa.capacity]) tangent = 0.0;
    e.slipping = !intact && size > mu * pressed;
    if (e.slipping) {
        ds = (size - mu * pressed) / (kt + mu * kn * tangent);
        opens = tangent * ds;
        for (int a = 0; a < 3; a++) t[a] = trial[a] * mu * (pressed + kn * opens) / size;
        fn -= kn * opens;
        if (!crosses) way = u - opens;
    }
    e.open = !intact && u >= 0.0;
    for (int a = 0; a < 3; a++) e.force[a] = fn * plane[a] + t[a];
    double along = dot3(e.force, n), across[3];
    for (int a = 0; a < 3; a++) across[a] = e.force[a] - along * n[a];
    for (int a = 0; a < 3; a++) e.shear[a] = t[a];
    if (k->soa.effects & GN_FX_ROTATION) cross3(n, across, e.moment);
    e.tolerance = 1e-12 * (kn * fabs(u) + size) + (kn + kt) * (slack + 1e-18);
    /* Work of the step by the trapezoidal rule, less the change of the springs' energies. */
    double work = 0.0, old = crosses && past >= 0.0 ? 0.0 : kn * past;
    for (int a = 0; a < 3; a++) work += 0.5 * (before[a] + t[a]) * (dt * vr[a] - path * plane[a]);
    double lost = work - 0.5 * (dot3(t, t) - dot3(before, before)) / kt;
    if (bonded || (!crosses && past < 0.0))
        lost += 0.5 * (old + fn) * path - 0.5 * fn * way + 0.5 * kn * past * past;
    if (e.cause)
        sum->breaking += lost;
    else if (e.slipping)
        sum->friction += lost;
    sum->elastic_normal += 0.5 * fn * way;
    sum->elastic_shear += 0.5 * dot3(t, t) / kt;
    sum->scale += kn * u * u + kn * past * past + dot3(trial, trial) / kt +
                  (kn * fabs(u) + size) * slack * 1e12;
    return e;
}

static expected expect(const bench *b, size_t c, tally *sum) {
    const gn_contacts *k = &b->k;
    gn_effects fx = k->soa.effects;
    double dt = b->args.dt, d[3], old[3], n[3] = {0}, n_old[3] = {0};
    separation(b, c, d, old);
    double length = sqrt(dot3(d, d)), length_old = sqrt(dot3(old, old));
    for (int a = 0; a < 3; a++) n[a] = length > 0.0 ? d[a] / length : 0.0;
    for (int a = 0; a < 3; a++) n_old[a] = length_old > 0.0 ? old[a] / length_old : 0.0;
    int32_t i = k->i[c], j = k->j[c];
    double ri = b->p.pos[4 * i + 3], rj = b->p.pos[4 * j + 3], gap = length - ri - rj;
    expected e = {0};

    /* Velocities act on the branch of the middle of the step: v_r = (v_j + w_j x l_j) - (v_i + w_i
     * x l_i), l towards the middle of the gap. */
    double v[3], middle[3], vr[3], twist = 0.0, li[3], lj[3], ti[3] = {0}, tj[3] = {0};
    for (int a = 0; a < 3; a++) v[a] = b->p.vel[4 * j + a] - b->p.vel[4 * i + a];
    for (int a = 0; a < 3; a++) middle[a] = d[a] - 0.5 * dt * v[a];
    double length_middle = sqrt(dot3(middle, middle)), gap_middle = length_middle - ri - rj;
    for (int a = 0; a < 3; a++) middle[a] = length > 0.0 ? middle[a] / length_middle : 0.0;
    for (int a = 0; a < 3; a++) li[a] = (ri + 0.5 * gap_middle) * middle[a];
    for (int a = 0; a < 3; a++) lj[a] = -(rj + 0.5 * gap_middle) * middle[a];
    if (fx & GN_FX_ROTATION) {
        const double *wi = b->p.spin + 4 * i, *wj = b->p.spin + 4 * j;
        cross3(wi, li, ti);
        cross3(wj, lj, tj);
        if (b->space) twist = 0.5 * (dot3(wi, middle) + dot3(wj, middle));
    }
    for (int a = 0; a < 3; a++) vr[a] = v[a] + tj[a] - ti[a];
    double vn = dot3(v, n), along = dot3(v, middle), vt[3];
    double side2 = dt * dt * fmax(dot3(v, v) - vn * vn, 0.0), left = length - dt * vn;
    double curved = length > 0.05 * (ri + rj) ? 0.5 * side2 / length : 0.0;
    double grown = dt * vn - side2 / (left + sqrt(left * left + side2));
    for (int a = 0; a < 3; a++) vt[a] = vr[a] - along * middle[a];

    if (k->plane) {
        double turning = sqrt(dot3(ti, ti)) + sqrt(dot3(tj, tj)), half = 0.0;
        if (length > 0.05 * (ri + rj)) half = 0.5 * sqrt(dt * dt * dot3(v, v)) / length;
        /* half^2/2 from the length of the middle branch, half^2/2 from the arms, and what follows
         * in higher orders */
        double slack = dt * turning * half * half * (1.0 + 4.0 * half);
        return expect_joint(b, c, vr, n, slack, sum);
    }
    double kn = k->kn[c], kt = k->kt ? k->kt[c] : 0.0;
    double u = fx & GN_FX_BONDS ? length - k->length0[c] : gap, u_old = u - grown;
    bool bonded = fx & GN_FX_BONDS && k->rn[c] > 0.0, touching = u < 0.0;
    double before[3] = {0}, trial[3] = {0}, t[3] = {0};
    if (k->shear) {
        for (int a = 0; a < 3; a++) before[a] = k->shear[c + (size_t)a * k->soa.capacity];
        rotate_from_to(n_old, n, before);
        rotate_about(n, dt * twist, before);
        rotate_from_to(middle, n, vt);
        rotate_about(n, 0.5 * dt * twist, vt);
        for (int a = 0; a < 3; a++) t[a] = trial[a] = before[a] + kt * dt * vt[a];
    }
    if (k->most) {
        motion q = {.stretch = u, .vn = vn, .path = dt * vn - curved};
        memcpy(q.n, n, sizeof n);
        memcpy(q.vt, vt, sizeof vt);
        memcpy(q.before, before, sizeof before);
        double most = fmax(b->args.period[0], fmax(b->args.period[1], b->args.period[2]));
        e = expect_hertz(b, c, &q, 8.0 * DBL_EPSILON * fmax(0.05, most), sum);
        double stiffness = kt * e.root;
        if (length > 0.05 * (ri + rj))
            e.tolerance += 0.125 * side2 / (length * length) * stiffness * dt * sqrt(dot3(vt, vt));
        e.tolerance += fabs(pow(dt * twist, 3.0)) / 6.0 * sqrt(dot3(before, before));
        if (k->roll) expect_roll(b, c, n_old, middle, n, twist, e.pressed, e.root, &e, sum);
        e.couple_tolerance += roll_slack(b, c, side2, length, twist, vn, &e);
        return e;
    }
    double size = sqrt(dot3(trial, trial));
    bending m = bend(b, c, n_old, middle, n, twist);
    if (bonded) e.cause = cause_of(k, c, kn * u + m.normal, size + m.shear);
    bool intact = bonded && !e.cause;
    double path = dt * vn - (intact && !k->cn ? 0.0 : curved);
    double fn = intact || touching ? kn * u : 0.0, share = intact || touching, way = u;
    double cut = u / grown, inverse = b->p.vel[4 * i + 3] + b->p.vel[4 * j + 3];
    double bend = fmin(0.25 * kn * inverse * dt * dt, 0.125) * cut * (1.0 - cut);
    if (touching && u_old > 0.0 && !bonded) { /* closed within the step */
        fn = 0.5 * kn * u * (1.0 + cut) * (1.0 - bend);
        share = 0.5 + cut;
        way = grown;
    } else if (!touching && u_old < 0.0 && !intact) { /* opened within the step */
        fn = -0.5 * kn * u_old * cut * (1.0 + bend);
        share = 0.5 - cut;
        way = -grown;
    }
    double viscous = k->cn ? share * k->cn[c] * (vn - (intact ? curved / dt : 0.0)) : 0.0;
    double limit = touching && k->mu ? k->mu[c] * fmax(0.0, -(fn + viscous)) : 0.0;
    e.slipping = !intact && size > limit;
    if (e.slipping)
        for (int a = 0; a < 3; a++) t[a] = trial[a] * (limit / size);
    e.open = !intact && !touching;
    for (int a = 0; a < 3; a++) e.force[a] = (fn + viscous) * n[a] + t[a];
    for (int a = 0; a < 3; a++) e.shear[a] = t[a];
    if (k->shear && fx & GN_FX_ROTATION) cross3(n, t, e.moment);
    for (int a = 0; intact && a < 3; a++) e.couple[a] = m.moment[a];
    e.fd = viscous;
    /* The stretch is a difference of lengths: its round-off is that of the lengths, and with images
     * that of the box. */
    double box = fmax(b->args.period[0], fmax(b->args.period[1], b->args.period[2]));
    e.tolerance = 1e-12 * sqrt(dot3(e.force, e.force)) + 8.0 * DBL_EPSILON * kn * fmax(0.05, box);
    /* Here tangential forces are rotated exactly. In the kernel the increment, rotated by half the
     * angle A of the step, is stretched by up to 1 + (A/2)^2/2 (gn_turn_with_normal), and the twist
     * is included to second order. */
    if (length > 0.05 * (ri + rj))
        e.tolerance += 0.125 * side2 / (length * length) * kt * dt * sqrt(dot3(vt, vt));
    e.tolerance += fabs(pow(dt * twist, 3.0)) / 6.0 * sqrt(dot3(before, before));
    double half2 = length > 0.05 * (ri + rj) ? 0.25 * side2 / (length * length) : 0.0;
    /* Increments in the plane of the turn, and of twist, are shortened by half2/2 (turn_rate), and
     * half of an increment before and half after the turn by B about n are turned by B/2 and
     * shortened by B^2/8. */
    double strain = length > 0.05 * (ri + rj) ? fabs(dt * vn) / length : 0.0;
    e.couple_tolerance = (1e-12 + half2 + 0.125 * pow(dt * twist, 2.0)) * m.size;
    /* The middle between two branches is no bisector if one is longer: the old normal has an error
     * of half the angle times the strain of the step. */
    e.couple_tolerance += sqrt(half2) * strain * m.size;
    if (k->roll) {
        double pressed = touching ? fmax(0.0, -(fn + viscous)) : 0.0;
        expect_roll(b, c, n_old, middle, n, twist, pressed, 1.0, &e, sum);
        e.couple_tolerance += roll_slack(b, c, side2, length, twist, vn, &e);
    }

    /* Work of the step by the trapezoidal rule, less the energy of the spring. */
    double work = 0.0, kept = 0.0, lost_shear = 0.0;
    for (int a = 0; a < 3; a++) work += 0.5 * (before[a] + t[a]) * dt * vt[a];
    if (kt > 0.0) lost_shear = work - 0.5 * (dot3(t, t) - dot3(before, before)) / kt;
    if (fn == kn * u || fn == 0.0)
        u_old = u - path;
    else
        path = grown;
    work = 0.5 * (kn * u_old + fn) * path;
    kept = 0.5 * fn * way - 0.5 * kn * u_old * u_old;
    if (intact) sum->elastic_bending += m.stored;
    sum->scale += m.stored;
    if (e.cause)
        sum->breaking += lost_shear + work - kept + m.released;
    else if (e.slipping)
        sum->friction += lost_shear;
    sum->elastic_normal += 0.5 * fn * way;
    sum->elastic_shear += kt > 0.0 ? 0.5 * dot3(t, t) / kt : 0.0;
    if (k->fd) sum->damping += 0.5 * (k->fd[c] + viscous) * path;
    sum->scale += kn * u * u + (kt > 0.0 ? dot3(trial, trial) / kt : 0.0) +
                  fabs(kn * u_old * path) +
                  (fabs(viscous) + (k->fd ? fabs(k->fd[c]) : 0.0)) * fabs(vn) * dt;
    return e;
}

static void check_row(const bench *b, size_t c, const expected *e, const char *name) {
    int width = gn_contacts_row_width(&b->k);
    const double *row = gn_contacts_row(&b->k) + (size_t)width * c;
    double f[3] = {row[0], row[1], b->space ? row[2] : 0.0}, m[3] = {0, 0, 0};
    if (width == 8)
        memcpy(m, row + 4, sizeof m);
    else if (!b->space)
        m[2] = row[2];
    double worst = 0.0;
    for (int a = 0; a < 3; a++) {
        worst = fmax(worst, fabs(f[a] - e->force[a]));
        worst = fmax(worst, fabs(m[a] - e->moment[a]));
        if (b->k.shear)
            worst = fmax(worst, fabs(b->k.shear[c + (size_t)a * b->k.soa.capacity] - e->shear[a]));
    }
    if (!(worst <= e->tolerance))
        fail_msg("%s, contact %zu: force off by %g N of %g N (allowed %g)", name, c, worst,
                 sqrt(dot3(e->force, e->force)), e->tolerance);
    const double *couple = b->k.roll ? b->k.roll : b->k.moment;
    for (int a = 0; couple && a < 3; a++)
        if (!(fabs(couple[c + (size_t)a * b->k.soa.capacity] - e->couple[a]) <=
              e->couple_tolerance))
            fail_msg("%s, contact %zu: moment %d is %.17g N m, expected %.17g (allowed %g)", name,
                     c, a, couple[c + (size_t)a * b->k.soa.capacity], e->couple[a],
                     e->couple_tolerance);
    if (b->k.cause && b->k.cause[c] != e->cause)
        fail_msg("%s, contact %zu: cause %d, expected %d", name, c, b->k.cause[c], e->cause);
}

static void scalar_contact_kernel_follows_the_formulas(void **state) {
    (void)state;
    size_t seen[4] = {0};
    for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
        gn_contact_kernel *kernel = gn_contact_table_scalar[v];
        if (!kernel) continue;
        if (gn_contact_variant_effects(v) & GN_FX_SOFTENING) continue; /* see test_softening.c */
        char name[160];
        gn_contact_variant_name(v, name, sizeof name);
        bench b = make_bench(gn_contact_variant_effects(v), 1000 * v);
        expected *e = calloc(CONTACTS, sizeof *e);
        tally sum = {0};
        for (size_t c = 0; c < CONTACTS; c++) e[c] = expect(&b, c, &sum);
        gn_contact_sums got = run(&b, kernel);
        int64_t broken[3] = {0};
        for (size_t c = 0; c < CONTACTS; c++) {
            check_row(&b, c, &e[c], name);
            broken[e[c].cause]++;
            seen[0] += e[c].open;
            seen[1] += e[c].slipping && !e[c].open;
        }
        assert_int_equal(got.broken_tension, broken[GN_BROKEN_TENSION]);
        assert_int_equal(got.broken_shear, broken[GN_BROKEN_SHEAR]);
        seen[2] += (size_t)got.broken_tension;
        seen[3] += (size_t)got.broken_shear;
        if (b.k.soa.effects & GN_FX_ENERGY) {
            double allowed = 1e-12 * sum.scale;
            if (b.k.soa.effects & GN_FX_PERIODIC)
                allowed *= 50.0; /* the lengths are of the size of the box, not of a pair */
            assert_near(got.elastic_normal, sum.elastic_normal, allowed);
            assert_near(got.elastic_shear, sum.elastic_shear, allowed);
            assert_near(got.elastic_bending, sum.elastic_bending, allowed);
            assert_near(got.friction, sum.friction, allowed);
            assert_near(got.contact_damping, sum.damping, allowed);
            assert_near(got.bond_breaking, sum.breaking, allowed);
            assert_near(got.rolling, sum.rolling, allowed);
            assert_near(got.cohesion, sum.cohesion, allowed);
        }
        free(e);
        free_bench(&b);
    }
    for (int k = 0; k < 4; k++)
        assert_true(seen[k] > 100); /* open, slipping, both kinds of breaking */
}

static void check_sums(const gn_contact_sums *a, const gn_contact_sums *b) {
    assert_close(a->elastic_normal, b->elastic_normal, 1e-12);
    assert_close(a->elastic_shear, b->elastic_shear, 1e-12);
    assert_close(a->elastic_bending, b->elastic_bending, 1e-12);
    assert_close(a->friction, b->friction, 1e-12);
    assert_close(a->bond_breaking, b->bond_breaking, 1e-12);
    /* These terms have both signs: against the sum of their sizes (0.1 N, 0.1 m/s, 1e-6 s). */
    assert_near(a->contact_damping, b->contact_damping, 1e-12 * CONTACTS * 0.1 * 0.1 * 1e-6);
    assert_int_equal(a->broken_tension, b->broken_tension);
    assert_int_equal(a->broken_shear, b->broken_shear);
}

static void every_contact_kernel_has_the_bits_of_the_scalar_one(void **state) {
    (void)state;
    for (int s = 1; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!runs_here(set)) continue;
        for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
            char name[200];
            int used = snprintf(name, sizeof name, "%s ", set->name);
            gn_contact_variant_name(v, name + used, sizeof name - (size_t)used);
            assert_true(!set->contact[v] == !gn_contact_table_scalar[v]);
            if (!set->contact[v]) continue;
            bench a = make_bench(gn_contact_variant_effects(v), 1000 * v);
            bench b = make_bench(gn_contact_variant_effects(v), 1000 * v);
            gn_contact_sums want = run(&a, gn_contact_table_scalar[v]);
            gn_contact_sums got = run(&b, set->contact[v]);
            assert_same_contacts(&a.k, &b.k, name);
            check_sums(&want, &got);
            free_bench(&a);
            free_bench(&b);
        }
    }
}

/* Every particle of the bench has one contact, and so one row of partial sums: [0, 1][x y z]. */
static void sums_at(const bench *b, size_t c, int end, double force[3], double moment[3]) {
    const gn_partials *q = &b->sums;
    const size_t first = (size_t)q->first[c / q->length];
    double row[8];
    partial_row(q, first + q->place[2 * c + (size_t)end] / (size_t)q->width, row);
    for (int a = 0; a < 3; a++) force[a] = a < 2 || b->space ? row[a] : 0.0;
    for (int a = 0; a < 3; a++) moment[a] = q->width == 8 ? row[4 + a] : 0.0;
    if (!b->space && b->k.soa.effects & GN_FX_ROTATION) moment[2] = row[2];
}

static void partial_sums_hold_force_and_moment_of_both_ends(void **state) {
    (void)state;
    for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
        if (!gn_contact_table_scalar[v]) continue;
        bench b = make_bench(gn_contact_variant_effects(v), 1000 * v);
        run(&b, gn_contact_table_scalar[v]);
        int width = gn_contacts_row_width(&b.k);
        bool turns = b.k.shear && b.k.soa.effects & GN_FX_ROTATION;
        for (size_t c = 0; c < CONTACTS; c++) {
            const double *row = gn_contacts_row(&b.k) + (size_t)width * c;
            double d[3], old[3], ri = b.p.pos[4 * b.k.i[c] + 3], rj = b.p.pos[4 * b.k.j[c] + 3];
            separation(&b, c, d, old);
            double half = 0.5 * (sqrt(dot3(d, d)) - ri - rj);
            for (int end = 0; end < 2; end++) {
                double f[3], m[3], arm = (end ? rj : ri) + half;
                sums_at(&b, c, end, f, m);
                for (int a = 0; a < 2 + b.space; a++) assert_true(f[a] == (end ? -row[a] : row[a]));
                for (int a = 0; turns && a < 3; a++) {
                    double turn = b.space ? row[4 + a] : a == 2 ? row[2] : 0.0;
                    const double *own = b.k.roll ? b.k.roll : b.k.moment;
                    double couple = own ? own[c + (size_t)a * b.k.soa.capacity] : 0.0;
                    assert_near(m[a], arm * turn + (end ? -couple : couple),
                                1e-15 * fabs(turn) + 2e-16 * fabs(couple));
                }
            }
        }
        free_bench(&b);
    }
}

/* --- mixed precision --- */

static bench make_pressure(unsigned v) {
    gn_effects effects = gn_contact_variant_effects(v) | GN_FX_MIXED;
    bench b = make_bench(effects, 1000 * v);
    make_single(&b, 7 + v);
    return b;
}

static void every_mixed_kernel_has_the_bits_of_the_scalar_one(void **state) {
    (void)state;
    for (int s = 1; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!gn_kernel_set_supported(set)) continue;
        for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
            char name[200];
            int used = snprintf(name, sizeof name, "%s mixed ", set->name);
            gn_contact_variant_name(v, name + used, sizeof name - (size_t)used);
            bool none =
                gn_contact_variant_effects(v) & (GN_FX_PERIODIC | GN_FX_JOINTS | GN_FX_COHESION);
            assert_true(!set->mixed[v] == (none || !gn_contact_table_scalar[v]));
            if (!set->mixed[v]) continue;
            bench a = make_pressure(v), b = make_pressure(v);
            gn_contact_sums want = run(&a, gn_contact_table_scalar_mixed[v]);
            gn_contact_sums got = run(&b, set->mixed[v]);
            assert_same_contacts(&a.k, &b.k, name);
            size_t size = (size_t)a.sums.first[a.sums.blocks] * (size_t)a.sums.width;
            for (size_t k = 0; k < size; k++)
                if (k % 4 != 3 && !(partial_sum(&a.sums, k) == partial_sum(&b.sums, k)))
                    fail_msg("%s: partial sum %zu differs from the scalar kernel", name, k);
            assert_near(got.friction, want.friction, 1e-5 * fabs(want.friction)); /* single */
            assert_near(got.bond_breaking, want.bond_breaking, 1e-5 * fabs(want.bond_breaking));
            assert_int_equal(got.broken_tension, want.broken_tension);
            assert_int_equal(got.broken_shear, want.broken_shear);
            free_bench(&a);
            free_bench(&b);
        }
    }
}

/* Contacts that may have begun within rounding of 0, beside others that close or open in the step:
 * the result must not depend on the other lanes of the vector. They move almost straight towards or
 * from each other, so that the effect of the motion across on their path is of the size of its
 * rounding in single precision, and all displacement was made in this step. */
static bench make_touching(unsigned v, bool mixed) {
    bench b = make_bench(gn_contact_variant_effects(v) | (mixed ? GN_FX_MIXED : 0), 1000 * v);
    uint64_t at = 31 + v;
    b.args.speed_most = 0.1;
    for (size_t c = 0; c < CONTACTS; c++) {
        double *xi = b.p.pos + 4 * b.k.i[c], *xj = b.p.pos + 4 * b.k.j[c], n[3];
        double *vi = b.p.vel + 4 * b.k.i[c], *vj = b.p.vel + 4 * b.k.j[c];
        double speed = uniform(&at, -0.05, 0.05), gap = 0.0;
        random_direction(&at, b.space, n);
        if (b.k.rn && c % 4) b.k.rn[c] = -fabs(b.k.rn[c]);
        if (c % 3 == 0) gap = -speed * b.args.dt * uniform(&at, 0.0, 1.0);
        double before = (b.k.length0 ? b.k.length0[c] : xi[3] + xj[3]) + gap;
        for (int a = 0; a < 3; a++) {
            vi[a] = a < 2 || b.space ? uniform(&at, -0.02, 0.02) : 0.0;
            vj[a] = vi[a] + speed * n[a];
            if (a < 2 || b.space) vj[a] += uniform(&at, -0.005, 0.005);
            b.p.ref[4 * b.k.i[c] + a] = xi[a];
            b.p.ref[4 * b.k.j[c] + a] = xi[a] + before * n[a];
            xj[a] = b.p.ref[4 * b.k.j[c] + a] + b.args.dt * vj[a];
            xi[a] += b.args.dt * vi[a];
        }
    }
    if (!mixed) return b;
    gn_particles_to_single(&b.p, b.p.ref, 1);
    gn_contacts_to_single(&b.k, &b.p, b.args.period, 1);
    b.args.pos_f = b.p.travel_f;
    b.args.vel_f = b.p.vel_f;
    b.args.spin_f = b.p.spin_f;
    return b;
}

static void contacts_that_begin_at_touch_do_not_depend_on_their_neighbours(void **state) {
    (void)state;
    for (int s = 2; s < 2 * GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s / 2);
        if (!gn_kernel_set_supported(set)) continue;
        for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
            gn_contact_kernel *kernel = s % 2 ? set->mixed[v] : set->contact[v];
            if (!kernel || gn_contact_variant_effects(v) & GN_FX_PERIODIC) continue;
            char name[200];
            int used = snprintf(name, sizeof name, "%s%s ", set->name, s % 2 ? " mixed" : "");
            gn_contact_variant_name(v, name + used, sizeof name - (size_t)used);
            bench a = make_touching(v, s % 2), b = make_touching(v, s % 2);
            run(&a, s % 2 ? gn_contact_table_scalar_mixed[v] : gn_contact_table_scalar[v]);
            run(&b, kernel);
            assert_same_contacts(&a.k, &b.k, name);
            size_t size = (size_t)a.sums.first[a.sums.blocks] * (size_t)a.sums.width;
            for (size_t k = 0; k < size; k++)
                if (k % 4 != 3 && !(partial_sum(&a.sums, k) == partial_sum(&b.sums, k)))
                    fail_msg("%s: partial sum %zu differs from the scalar kernel", name, k);
            free_bench(&a);
            free_bench(&b);
        }
    }
}

/* The difference from double precision, relative to the force of a stretch of 1e-3, at least 1e-6 m
 * here. Travel changes a distance by up to 4e-5 m; rounding that (6e-8), the stretch before it and
 * their sum is 7e-12 m: 7e-6. Positions in single precision would be off by 6e-8 x 0.02 m: 1e-3. A
 * bond that softens down a slope of at most half its stiffness doubles the error of its trial
 * force. */
static void mixed_forces_follow_the_double_ones(void **state) {
    (void)state;
    double worst = 0.0;
    size_t other_side = 0, contacts = 0;
    for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
        gn_effects fx = gn_contact_variant_effects(v);
        if (!gn_contact_table_scalar[v] || fx & (GN_FX_COHESION | GN_FX_JOINTS))
            continue; /* never mixed */
        double softens = fx & GN_FX_SOFTENING ? 2.0 : 1.0;
        bench a = make_bench(fx, 1000 * v), b = make_pressure(v);
        run(&a, gn_contact_table_scalar[v]);
        run(&b, gn_contact_table_scalar_mixed[v & ~16U]); /* images are in the branch */
        for (size_t c = 0; c < CONTACTS; c++) {
            contacts++;
            if (a.k.cause &&
                a.k.cause[c] != b.k.cause[c]) { /* the bond is within rounding of its strength */
                other_side++;
                continue;
            }
            double ri = a.p.pos[4 * a.k.i[c] + 3], rj = a.p.pos[4 * a.k.j[c] + 3];
            double scale = a.k.kn[c] * 1e-3 * (ri + rj);
            if (a.k.most)
                scale *= sqrt(2e-3 * (ri + rj)); /* the stiffness is that of the deepest contact */
            for (int end = 0; end < 2; end++) {
                double f[3], g[3], m[3], n[3];
                sums_at(&a, c, end, f, m);
                sums_at(&b, c, end, g, n);
                for (int k = 0; k < 3; k++) {
                    worst = fmax(worst, fabs(f[k] - g[k]) / scale / softens);
                    worst = fmax(worst, fabs(m[k] - n[k]) / (scale * (ri + rj)) / softens);
                }
            }
        }
        free_bench(&a);
        free_bench(&b);
    }
    print_message("# mixed: largest error %.2g of the force of a stretch of 1e-3\n", worst);
    assert_true(worst > 0.0 && worst < 7e-6);
    assert_true(other_side * 10000 < contacts);
}

/* Grains pressed into each other, with twelve contacts each, after their first three steps. */
static gn_world *pressed(const char *precision) {
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1e-3, cells: [5, 5, 5], spacing: "
        "0.99, jitter: 0.004}}\n"
        "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5}]\n"
        "law: {stiffness: harmonic}\n"
        "initial: {random_velocity: 0.1}\ntime: {end: 1}\nrun: {threads: 1, precision: %s}\n",
        precision);
    run_steps(w, 3);
    return w;
}

/* A sum adds up to twelve forces in single precision (6e-8 of the sum each); a force itself is off
 * by some roundings of its stretch and its increments. */
static void sums_of_many_mixed_contacts_follow_the_double_ones(void **state) {
    (void)state;
    gn_world *a = pressed("double"), *b = pressed("mixed");
    const gn_partials *p = &a->dem.pairs.partials, *q = &b->dem.pairs.partials;
    assert_true(p->row && q->row_f && p->width == 8);
    const size_t rows = (size_t)p->first[p->blocks];
    assert_true(a->dem.pairs.contacts.soa.count >
                3 * rows / 2); /* several contacts are in one sum */
    assert_int_equal(q->first[q->blocks], rows);
    double most[2] = {0.0, 0.0}, off[2] = {0.0, 0.0};
    for (size_t k = 0; k < 8 * rows; k++) {
        const int part = k % 8 / 4;
        most[part] = fmax(most[part], fabs(partial_sum(p, k)));
        off[part] = fmax(off[part], fabs(partial_sum(p, k) - partial_sum(q, k)));
    }
    print_message("# mixed: sums off by %.2g of the largest force, %.2g of the largest moment\n",
                  off[0] / most[0], off[1] / most[1]);
    for (int part = 0; part < 2; part++)
        assert_true(off[part] > 0.0 && off[part] < 2e-6 * most[part]);
    world_end(a);
    world_end(b);
}

static void exchanging_the_ends_mirrors_the_force(void **state) {
    (void)state;
    for (int s = 0; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!gn_kernel_set_supported(set)) continue;
        for (unsigned v = 0; v < GN_CONTACT_VARIANTS; v++) {
            if (!set->contact[v]) continue;
            bench a = make_bench(gn_contact_variant_effects(v), 1000 * v);
            bench b = make_bench(gn_contact_variant_effects(v), 1000 * v);
            for (size_t c = 0; c < CONTACTS; c++) {
                int32_t i = b.k.i[c];
                b.k.i[c] = b.k.j[c];
                b.k.j[c] = i;
                for (size_t x = 0; b.k.shear && x < 3; x++)
                    b.k.shear[c + x * b.k.soa.capacity] *= -1.0;
                for (size_t x = 0; b.k.moment && x < 3; x++)
                    b.k.moment[c + x * b.k.soa.capacity] *= -1.0;
                for (size_t x = 0; b.k.roll && x < 3; x++)
                    b.k.roll[c + x * b.k.soa.capacity] *= -1.0;
                for (size_t x = 0; b.k.plane && x < 3; x++)
                    b.k.plane[c + x * b.k.soa.capacity] *= -1.0;
            }
            run(&a, set->contact[v]);
            run(&b, set->contact[v]);
            int width = gn_contacts_row_width(&a.k), force = a.space ? 3 : 2;
            const double *ra = gn_contacts_row(&a.k), *rb = gn_contacts_row(&b.k);
            for (int k = 0; k < width * CONTACTS; k++) /* == : -0 is 0 */
                if (!(rb[k] == (k % width < force ? -ra[k] : ra[k])))
                    fail_msg("%s variant %u, contact %d, number %d", set->name, v, k / width,
                             k % width);
            for (size_t k = 0; a.k.moment && k < 3 * a.k.soa.capacity; k++)
                if (!(b.k.moment[k] == -a.k.moment[k]))
                    fail_msg("%s variant %u, number %zu of the moments", set->name, v, k);
            free_bench(&a);
            free_bench(&b);
        }
    }
}

/* --- turning with the body --- */

/* A bonded pair with a normal and a shear load turned rigidly by 360 degrees about `axis` in
 * `steps`; returns |F_t - F_t(0)|/|F_t(0)| at the end, and the change of |F_t|. */
static double full_turn(const double axis[3], int steps, double *change) {
    gn_effects fx = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_SHEAR | GN_FX_FRICTION | GN_FX_BONDS;
    bench b = {.space = 1};
    assert_int_equal(gn_soa_create(&gn_particle_record, &b.p, 2, fx, NULL), GNEISS_OK);
    assert_int_equal(gn_soa_create(&gn_contact_record, &b.k, 1, fx, NULL), GNEISS_OK);
    gn_particles_set_null(&b.p, 1.0);
    gn_contacts_pad(&b.k, &b.p);
    b.k.j[0] = 1;
    b.k.i[0] = 0;
    b.k.kn[0] = b.k.kt[0] = 1e7;
    b.k.rn[0] = b.k.rt[0] = 1e30;
    b.k.length0[0] = 2e-3 * (1.0 - 1e-3); /* stretched by 1e-3 */
    const double start[3] = {0, 3.0, 4.0};
    for (size_t a = 0; a < 3; a++) b.k.shear[a * b.k.soa.capacity] = start[a];
    double dt = 1e-6, angle = 2.0 * pi / steps, arm[3] = {1e-3, 0, 0};
    b.p.pos[3] = b.p.pos[7] = 1e-3;
    gn_contact_args args = {.pos = b.p.pos,
                            .vel = b.p.vel,
                            .spin = b.p.spin,
                            .contacts = &b.k,
                            .dt = dt,
                            .arm_factor = 0.5};
    const gn_kernel_set *set = gn_kernel_set_at(0);
    for (int step = 0; step < steps; step++) {
        double now[3];
        memcpy(now, arm, sizeof now);
        double side[3], along = dot3(axis, arm) * (1.0 - cos(angle));
        cross3(axis, arm, side);
        for (int a = 0; a < 3; a++)
            now[a] = arm[a] * cos(angle) + side[a] * sin(angle) + axis[a] * along;
        for (int a = 0; a < 3; a++) {
            b.p.pos[a] = -now[a];
            b.p.pos[4 + a] = now[a];
            b.p.vel[a] = -(now[a] - arm[a]) / dt;
            b.p.vel[4 + a] = (now[a] - arm[a]) / dt;
            b.p.spin[a] = b.p.spin[4 + a] = axis[a] * angle / dt;
        }
        memcpy(arm, now, sizeof arm);
        gn_contact_sums sums = {0};
        set->contact[gn_contact_variant(fx)](&args, 0, 1, &sums);
    }
    double off[3], end[3];
    for (size_t a = 0; a < 3; a++) {
        end[a] = b.k.shear[a * b.k.soa.capacity];
        off[a] = end[a] - start[a];
    }
    *change = fabs(sqrt(dot3(end, end)) - 5.0) / 5.0;
    free_bench(&b);
    return sqrt(dot3(off, off)) / 5.0;
}

/* Rotation about the normal: the direction has an error of a^3/6 per step, the magnitude of
 * a^4/8. */
static void shear_turns_with_a_spin_about_the_normal(void **state) {
    (void)state;
    const double axis[3] = {1, 0, 0};
    for (int steps = 500; steps <= 4000; steps *= 2) {
        double change, off = full_turn(axis, steps, &change), angle = 2.0 * pi / steps;
        assert_true(off <= 1.1 * 2.0 * pi * angle * angle / 6.0 + 1e-12);
        assert_true(change <= 1.1 * 2.0 * pi * pow(angle, 3) / 8.0 + 1e-12);
    }
}

/* The chord that the centres travel in a step is shorter than the arc of the spins, and the branch
 * vector at mid-step, to which both are related, is shorter than the distance: for a spin of a/dt
 * instead of 2 tan(a/2)/dt a slip of d (2 sin(a/2) - a cos(a/2)) = d a^3/12 per step is left, d (2
 * pi) a^2/12 per turn: second order in the step. */
static void shear_turns_with_a_rotation_across_the_normal(void **state) {
    (void)state;
    const double axis[3] = {0, 0, 1};
    double last = 0.0;
    for (int steps = 2000; steps <= 16000; steps *= 2) {
        double change, off = full_turn(axis, steps, &change), angle = 2.0 * pi / steps;
        double slip = 1e7 * 2e-3 / 5.0; /* k_t d / |F_t| */
        assert_true(off <= 1.1 * (slip + 1.0) * 2.0 * pi * angle * angle / 12.0);
        assert_true(change <= off);
        if (last > 0.0) assert_in_range((int)(100.0 * last / off), 380, 420);
        last = off;
    }
}

/* About an oblique axis the normal moves on a cone; chord and spins act on the normal at the middle
 * of the step, so that there is no first-order term. */
static void shear_turns_with_a_rotation_about_an_oblique_axis(void **state) {
    (void)state;
    const double axis[3] = {1 / sqrt(3.0), 1 / sqrt(3.0), 1 / sqrt(3.0)};
    double last = 0.0;
    for (int steps = 2000; steps <= 16000; steps *= 2) {
        double change, off = full_turn(axis, steps, &change), angle = 2.0 * pi / steps;
        double slip = 1e7 * 2e-3 / 5.0;
        assert_true(off <= 1.1 * (slip + 1.0) * 2.0 * pi * angle * angle / 12.0);
        if (last > 0.0) assert_in_range((int)(100.0 * last / off), 380, 420);
        last = off;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scalar_contact_kernel_follows_the_formulas),
        cmocka_unit_test(every_contact_kernel_has_the_bits_of_the_scalar_one),
        cmocka_unit_test(exchanging_the_ends_mirrors_the_force),
        cmocka_unit_test(partial_sums_hold_force_and_moment_of_both_ends),
        cmocka_unit_test(every_mixed_kernel_has_the_bits_of_the_scalar_one),
        cmocka_unit_test(contacts_that_begin_at_touch_do_not_depend_on_their_neighbours),
        cmocka_unit_test(mixed_forces_follow_the_double_ones),
        cmocka_unit_test(sums_of_many_mixed_contacts_follow_the_double_ones),
        cmocka_unit_test(shear_turns_with_a_spin_about_the_normal),
        cmocka_unit_test(shear_turns_with_a_rotation_across_the_normal),
        cmocka_unit_test(shear_turns_with_a_rotation_about_an_oblique_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
