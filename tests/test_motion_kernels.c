/* The motion kernels: every variant of every instruction set against the scalar one, and the scalar
 * one against an independent computation in plain doubles. */
#include "partials_help.h"
#include "world_helpers.h"

enum { PARTICLES = 2 * GN_PARTICLE_BLOCK + 93, LINKS = 9 * PARTICLES, SUPPORTS = PARTICLES / 3 };

/* Particles with bonds, pairs, wall contacts whose rows hold random forces; some particles
 * prescribed. */
typedef struct herd {
    gn_particles p;
    gn_contacts lists[2];
    gn_partials sums[2];
    gn_wall_contacts walls;
    int32_t *wall_first;
    gn_prescription prescribed;
    gn_motion_args args;
} herd;

/* Contacts with random partial sums: the sums of a block's row must reach its particle. */
static void make_list(gn_contacts *k, gn_partials *sums, gn_effects effects, uint64_t *at) {
    assert_int_equal(gn_soa_create(&gn_contact_record, k, LINKS, effects, NULL), GNEISS_OK);
    for (size_t c = 0; c < LINKS; c++) { /* sorted by the first end, as the engine keeps them */
        k->i[c] = (int32_t)(c / 5 % (PARTICLES - 12));
        k->j[c] = k->i[c] + 1 + (int32_t)(c % 5) * 2;
    }
    assert_int_equal(gn_partials_build(k, PARTICLES, 2, sums, NULL), GNEISS_OK);
    assert_true(sums->blocks > 1);
    for (int32_t r = 0; r < sums->first[sums->blocks]; r++)
        for (int a = 0; a < sums->width; a++)
            set_partial_sum(sums, (size_t)sums->width * (size_t)r + (size_t)a,
                            a % 4 < 3 ? uniform(at, -3.0, 3.0) : 0.0);
}

static void make_supports(herd *h, gn_effects effects, uint64_t *at) {
    assert_int_equal(gn_soa_create(&gn_wall_contact_record, &h->walls, SUPPORTS, effects, NULL),
                     GNEISS_OK);
    h->wall_first = calloc(PARTICLES + 2, sizeof *h->wall_first);
    for (size_t c = 0; c < SUPPORTS; c++) {
        h->walls.i[c] = (int32_t)(3 * c);
        for (int a = 0; a < 8; a++)
            h->walls.row[8 * c + (size_t)a] =
                a < 2 || a == 6 || effects & GN_FX_SPACE ? uniform(at, -3.0, 3.0) : 0.0;
        h->walls.row[8 * c + 3] = h->walls.row[8 * c + 7] = 0.0;
    }
    for (int p = 0; p <= PARTICLES; p++) h->wall_first[p] = p / 3 + (p % 3 > 0 ? 1 : 0);
    h->wall_first[PARTICLES] = SUPPORTS;
}

static void make_particle(herd *h, size_t p, int space, uint64_t *at) {
    for (int a = 0; a < 3; a++) {
        bool there = a < 2 || space;
        h->p.pos[4 * p + a] = there ? uniform(at, -0.1, 0.1) : 0.0;
        h->p.vel[4 * p + a] =
            there && p % 11 ? uniform(at, -2.0, 2.0) : 0.0; /* some particles are at rest */
        h->p.applied[4 * p + a] = there ? uniform(at, -1.0, 1.0) : 0.0;
        if (h->p.spin)
            h->p.spin[4 * p + a] = (space || a == 2) && p % 13 ? uniform(at, -90.0, 90.0) : 0.0;
    }
    double r = h->p.pos[4 * p + 3] = uniform(at, 0.5e-3, 2e-3), m = sphere_mass(2650.0, r);
    h->p.vel[4 * p + 3] = p % 37 == 36 ? 0.0 : 1.0 / m; /* some particles have been removed */
    if (h->p.spin) h->p.spin[4 * p + 3] = p % 37 == 36 ? 0.0 : 1.0 / (0.4 * m * r * r);
    if (h->p.orientation) h->p.orientation[4 * p] = 1.0;
    h->p.slot[p] = -1;
    if (p % 7 != 3) return;
    gn_prescription *q = &h->prescribed;
    size_t slot = q->count++;
    h->p.slot[p] = (int32_t)slot;
    q->mask[slot] = (uint8_t)(1 + p % 63);
    for (size_t k = 0; k < 6; k++) q->velocity[6 * slot + k] = uniform(at, -1.0, 1.0);
}

static herd make_herd(gn_effects effects, double dt_past, uint64_t seed) {
    herd h = {0};
    uint64_t at = seed;
    effects |= GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_WALLS;
    if (effects & GN_FX_ROTATION) effects |= GN_FX_ORIENTATION;
    assert_int_equal(gn_soa_create(&gn_particle_record, &h.p, PARTICLES, effects, NULL), GNEISS_OK);
    h.prescribed.set = calloc(PARTICLES, sizeof *h.prescribed.set);
    h.prescribed.mask = calloc(PARTICLES, 1);
    h.prescribed.velocity = calloc(PARTICLES, 6 * sizeof(double));
    h.prescribed.load = calloc(PARTICLES, 6 * sizeof(double));
    for (size_t p = 0; p < PARTICLES; p++) make_particle(&h, p, effects & GN_FX_SPACE ? 1 : 0, &at);
    gn_particles_set_null(&h.p, 1.0);
    make_list(&h.lists[0], &h.sums[0], effects, &at);
    make_list(&h.lists[1], &h.sums[1], effects | GN_FX_MIXED, &at); /* rows in single precision */
    make_supports(&h, effects, &at);
    h.args = (gn_motion_args){.dt_past = dt_past,
                              .dt = 1e-6,
                              .gravity = {0.3, -9.81, 0.0},
                              .damping = 0.6,
                              .damping_spin = 0.4,
                              .measure = true};
    if (effects & GN_FX_SPACE) h.args.gravity[2] = 1.7;
    if (effects & GN_FX_VISCOUS) h.args.damping = 5000.0, h.args.damping_spin = 3000.0;
    return h;
}

static void free_herd(herd *h) {
    gn_soa_destroy(&gn_particle_record, &h->p);
    for (int k = 0; k < 2; k++) gn_soa_destroy(&gn_contact_record, &h->lists[k]);
    for (int k = 0; k < 2; k++) gn_partials_free(&h->sums[k]);
    gn_soa_destroy(&gn_wall_contact_record, &h->walls);
    free(h->wall_first);
    free(h->prescribed.set);
    free(h->prescribed.mask);
    free(h->prescribed.velocity);
    free(h->prescribed.load);
}

static gn_motion_sums move(herd *h, gn_motion_kernel *kernel) {
    gn_motion_sums total = {.bad = -1};
    h->args.particles = &h->p;
    h->args.lists = 2;
    for (int l = 0; l < 2; l++) h->args.partials[l] = &h->sums[l];
    h->args.wall_contacts = &h->walls;
    h->args.wall_first = h->wall_first;
    h->args.prescribed = &h->prescribed;
    for (size_t p = 0; p < PARTICLES; p += GN_PARTICLE_BLOCK) {
        gn_motion_sums s = {.bad = -1};
        kernel(&h->args, p, p + GN_PARTICLE_BLOCK < PARTICLES ? p + GN_PARTICLE_BLOCK : PARTICLES,
               &s);
        total.kinetic += s.kinetic;
        total.rotational += s.rotational;
        total.resultant += s.resultant;
        for (int k = 0; k < 2; k++) {
            total.damping[k] += s.damping[k];
            total.gravity[k] += s.gravity[k];
            total.applied[k] += s.applied[k];
            total.prescribed[k] += s.prescribed[k];
        }
        total.speed2 = fmax(total.speed2, s.speed2);
        total.spin2 = fmax(total.spin2, s.spin2);
        if (total.bad < 0) total.bad = s.bad;
    }
    return total;
}

/* Force and moment on every particle, [n][6]. The rows of a block are numbered by its contacts. */
static double *gathered(const herd *h, gn_effects effects) {
    double *f = calloc(PARTICLES, 6 * sizeof *f);
    int space = effects & GN_FX_SPACE ? 1 : 0;
    for (int l = 0; l < 2; l++) {
        const gn_partials *q = &h->sums[l];
        bool *taken = calloc((size_t)q->first[q->blocks], sizeof *taken);
        for (size_t c = 0; c < 2 * LINKS; c++) {
            int32_t r = q->first[c / 2 / q->length] + q->place[c] / q->width;
            int32_t p = c % 2 ? h->lists[l].j[c / 2] : h->lists[l].i[c / 2];
            assert_int_equal(q->particle[r], p);
            if (taken[r]) continue;
            taken[r] = true;
            double row[8];
            partial_row(q, (size_t)r, row);
            for (int a = 0; a < 2 + space; a++) f[6 * p + a] += row[a];
            if (!(effects & GN_FX_ROTATION)) continue;
            for (int a = 0; space && a < 3; a++) f[6 * p + 3 + a] += row[4 + a];
            if (!space) f[6 * p + 5] += row[2];
        }
        free(taken);
    }
    for (size_t c = 0; c < SUPPORTS; c++)
        for (int a = 0; a < 3; a++) {
            f[6 * h->walls.i[c] + a] += h->walls.row[8 * c + (size_t)a];
            f[6 * h->walls.i[c] + 3 + a] += h->walls.row[8 * c + 4 + (size_t)a];
        }
    return f;
}

typedef struct ledger {
    double kinetic[2], damping[2], gravity[2], applied[2], prescribed[2], resultant;
} ledger;

/* One particle, translation (first 0) or rotation (first 3); v in, v out. */
static void expect_kick(const herd *h, gn_effects fx, size_t p, int first, const double *f,
                        double *v, ledger *sum) {
    double inverse = first ? h->p.spin[4 * p + 3] : h->p.vel[4 * p + 3],
           a = first ? h->args.damping_spin : h->args.damping;
    double mass = inverse > 0.0 ? 1.0 / inverse : 0.0, total[3], d[3] = {0}, v_new[3], before = 0.0;
    double span = 0.5 * (h->args.dt_past + h->args.dt), resultant = 0.0;
    for (int k = 0; k < 3; k++) {
        double weight = fx & GN_FX_GRAVITY ? mass * h->args.gravity[k] : 0.0;
        total[k] = f[first + k] + (first ? 0.0 : weight + h->p.applied[4 * p + k]);
    }
    /* damping acts against the velocity of the components that are not driven */
    int32_t slot = h->p.slot[p];
    double part[2][3] = {{0}};
    for (int k = 0; k < 3; k++) {
        if (slot >= 0 && h->prescribed.mask[slot] >> (first + k) & 1) continue;
        part[0][k] = total[k];
        part[1][k] = v[k];
    }
    double size = sqrt(dot3(part[0], part[0])), speed = sqrt(dot3(part[1], part[1]));
    for (int k = 0; k < 3; k++) {
        if (fx & GN_FX_NONVISCOUS_VECTOR) d[k] = speed > 0.0 ? -a * size * v[k] / speed : 0.0;
        double sign = v[k] + h->args.damping_lead * span * inverse * total[k];
        if (fx & GN_FX_NONVISCOUS_COMPONENT)
            d[k] = -a * fabs(total[k]) * ((sign > 0.0) - (sign < 0.0));
        v_new[k] = v[k] + span * inverse * (total[k] + d[k]);
        if (fx & GN_FX_VISCOUS) { /* F - a m (v + v')/2 */
            v_new[k] =
                (v[k] + span * (inverse * total[k] - 0.5 * a * v[k])) / (1.0 + 0.5 * a * span);
            d[k] = -a * mass * 0.5 * (v[k] + v_new[k]);
        }
    }
    for (int k = 0; k < 3; k++)
        if (slot >= 0 && h->prescribed.mask[slot] >> (first + k) & 1) {
            d[k] = 0.0;
            v_new[k] = h->prescribed.velocity[6 * slot + first + k];
            double inertia =
                inverse > 0.0 && h->args.dt_past > 0.0 ? mass * (v_new[k] - v[k]) / span : 0.0;
            sum->prescribed[0] += 0.5 * h->args.dt_past * (inertia - total[k]) * v[k];
            sum->prescribed[1] += 0.5 * h->args.dt * (inertia - total[k]) * v_new[k];
        }
    for (int k = 0; k < 3; k++) {
        double weight = fx & GN_FX_GRAVITY && !first ? mass * h->args.gravity[k] : 0.0;
        double applied = first ? 0.0 : h->p.applied[4 * p + k];
        for (int half = 0; half < 2; half++) {
            double path = 0.5 * (half ? h->args.dt * v_new[k] : h->args.dt_past * v[k]);
            sum->damping[half] -= d[k] * path;
            sum->gravity[half] += weight * path;
            sum->applied[half] += applied * path;
        }
        before = h->args.dt_past > 0.0 ? v[k] : 2.0 * v[k] - v_new[k];
        sum->kinetic[first / 3] += 0.5 * mass * before * v_new[k];
        resultant += total[k] * total[k];
    }
    if (!first && slot < 0) sum->resultant += sqrt(resultant);
    memcpy(v, v_new, sizeof v_new);
}

static void check_herd(unsigned v, double dt_past, double lead) {
    gn_effects fx = gn_motion_variant_effects(v);
    char name[160];
    gn_motion_variant_name(v, name, sizeof name);
    herd h = make_herd(fx, dt_past, 50 * v);
    h.args.damping_lead = lead;
    double *f = gathered(&h, fx), *want = calloc(PARTICLES, 6 * sizeof *want);
    ledger sum = {0};
    for (size_t p = 0; p < PARTICLES; p++) {
        memcpy(want + 6 * p, h.p.vel + 4 * p, 3 * sizeof *want);
        expect_kick(&h, fx, p, 0, f + 6 * p, want + 6 * p, &sum);
        if (!h.p.spin) continue;
        memcpy(want + 6 * p + 3, h.p.spin + 4 * p, 3 * sizeof *want);
        expect_kick(&h, fx, p, 3, f + 6 * p, want + 6 * p + 3, &sum);
    }
    double *start = calloc(PARTICLES, 4 * sizeof *start);
    memcpy(start, h.p.pos, PARTICLES * 4 * sizeof *start);
    gn_motion_sums got = move(&h, gn_motion_table_scalar[v]);
    assert_int_equal(got.bad, -1);
    for (size_t p = 0; p < PARTICLES; p++)
        for (size_t k = 0; k < 6; k++) {
            double inverse = k < 3 ? h.p.vel[4 * p + 3] : h.p.spin ? h.p.spin[4 * p + 3] : 0.0;
            double load = k < 3 ? 30.0 : 30.0 * 2e-3; /* sums of some thirty numbers up to 3 */
            double allowed = 1e-13 * (load * h.args.dt * inverse + (k < 3 ? 2.0 : 90.0));
            double now = k < 3      ? h.p.vel[4 * p + k]
                         : h.p.spin ? h.p.spin[4 * p + k - 3]
                                    : want[6 * p + k];
            if (!(fabs(now - want[6 * p + k]) <= allowed))
                fail_msg("%s, particle %zu, component %zu: %.17g, expected %.17g", name, p, k, now,
                         want[6 * p + k]);
            if (k < 3)
                assert_near(h.p.pos[4 * p + k], start[4 * p + k] + h.args.dt * want[6 * p + k],
                            1e-16);
        }
    assert_close(got.kinetic, sum.kinetic[0], 1e-12);
    assert_close(got.resultant, sum.resultant, 1e-12);
    if (h.p.spin) assert_close(got.rotational, sum.kinetic[1], 1e-12);
    for (int half = 0; half < 2; half++) {
        double size = PARTICLES * 30.0 * 2.0 * 1e-6; /* N, m/s, s */
        assert_near(got.prescribed[half], sum.prescribed[half],
                    1e-12 * size * 100.0); /* inertia: m v/dt */
        if (!(fx & GN_FX_ENERGY)) continue;
        assert_near(got.damping[half], sum.damping[half], 1e-12 * (size + fabs(sum.damping[half])));
        assert_near(got.gravity[half], sum.gravity[half], 1e-12 * size);
        assert_near(got.applied[half], sum.applied[half], 1e-12 * size);
    }
    free(start);
    free(want);
    free(f);
    free_herd(&h);
}

static void scalar_motion_kernel_follows_the_formulas(void **state) {
    (void)state;
    for (unsigned v = 0; v < GN_MOTION_VARIANTS; v++) {
        if (!gn_motion_table_scalar[v]) continue;
        check_herd(v, 0.8e-6, 0.0);
        check_herd(v, 0.0, 0.0); /* the half kick at the start */
    }
}

/* The velocity of the instant decides the sign; forces here change the sign of some components. */
static void component_damping_may_use_the_velocity_of_the_instant(void **state) {
    (void)state;
    for (unsigned v = 0; v < GN_MOTION_VARIANTS; v++) {
        if (!gn_motion_table_scalar[v] ||
            !(gn_motion_variant_effects(v) & GN_FX_NONVISCOUS_COMPONENT))
            continue;
        check_herd(v, 0.8e-6, 0.5);
        check_herd(v, 0.0, 0.5);
    }
}

static void check_motion_set(const gn_kernel_set *set, unsigned v) {
    gn_effects fx = gn_motion_variant_effects(v);
    herd a = make_herd(fx, 0.8e-6, 50 * v), b = make_herd(fx, 0.8e-6, 50 * v);
    gn_motion_sums want = move(&a, gn_motion_table_scalar[v]), got = move(&b, set->motion[v]);
    for (size_t f = 0; f < gn_particle_record.field_count; f++) {
        const gn_field *field = &gn_particle_record.fields[f];
        const char *x = gn_field_data(field, &a.p), *y = gn_field_data(field, &b.p);
        size_t item = gn_type_size(field->type) * (size_t)field->components;
        for (size_t p = 0; x && p < PARTICLES; p++)
            if (memcmp(x + item * p, y + item * p, item) != 0)
                fail_msg("%s, motion variant %u: %s of particle %zu", set->name, v, field->name, p);
    }
    assert_memory_equal(a.prescribed.load, b.prescribed.load,
                        a.prescribed.count * 6 * sizeof(double));
    assert_close(want.kinetic, got.kinetic, 1e-12);
    assert_close(want.rotational, got.rotational, 1e-12);
    assert_close(want.resultant, got.resultant, 1e-12);
    assert_true(want.speed2 == got.speed2);
    assert_true(want.spin2 == got.spin2);
    assert_true((fx & GN_FX_ROTATION) == 0 || got.spin2 > 0.0);
    assert_int_equal(want.bad, got.bad);
    for (int k = 0; k < 2; k++) {
        double size = 1e-12 * PARTICLES * 30.0 * 2.0 * 1e-6;
        assert_near(want.damping[k], got.damping[k], size + 1e-12 * fabs(want.damping[k]));
        assert_near(want.gravity[k], got.gravity[k], size);
        assert_near(want.applied[k], got.applied[k], size);
        assert_near(want.prescribed[k], got.prescribed[k], 100.0 * size);
    }
    free_herd(&a);
    free_herd(&b);
}

static void every_motion_kernel_has_the_bits_of_the_scalar_one(void **state) {
    (void)state;
    for (int s = 1; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!runs_here(set)) continue;
        for (unsigned v = 0; v < GN_MOTION_VARIANTS; v++) {
            assert_true(!set->motion[v] == !gn_motion_table_scalar[v]);
            if (set->motion[v]) check_motion_set(set, v);
        }
    }
}

static void a_velocity_that_is_not_finite_is_named(void **state) {
    (void)state;
    gn_effects fx = GN_FX_SPACE | GN_FX_ROTATION;
    for (int s = 0; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!gn_kernel_set_supported(set)) continue;
        herd h = make_herd(fx, 1e-6, 3);
        h.p.applied[4 * 200] = NAN;
        h.p.applied[4 * 301 + 1] = INFINITY;
        assert_int_equal(move(&h, set->motion[gn_motion_variant(fx)]).bad, 200);
        free_herd(&h);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scalar_motion_kernel_follows_the_formulas),
        cmocka_unit_test(component_damping_may_use_the_velocity_of_the_instant),
        cmocka_unit_test(every_motion_kernel_has_the_bits_of_the_scalar_one),
        cmocka_unit_test(a_velocity_that_is_not_finite_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
