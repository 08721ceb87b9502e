/* The entries of a contact law (kernels/law.h) agree with its kernels, for every law: the largest
 * spring of a contact, its stored energy, the strength of a bond, a contact with a wall. */
#include "kernels/law.h"

#include "world_helpers.h"

/* Two spheres of 1 mm along x, moved step by step, and their contact. */
typedef struct couple {
    gn_scene scene;
    gn_material material;
    gn_particles p;
    gn_contacts k;
    gn_contact_args args;
    gn_contact_kernel *kernel;
    const gn_law *law;
    gn_contact_sums sums;
    int64_t step;
} couple;

/* Values of materials for each law in the order of GN_LAWS. */
static const gn_material materials[] = {
    {.normal_stiffness = 1e7}, /* of a joint the values are those of set_joint */
    {.normal_stiffness = 1e7,
     .kratio = 2.5,
     .friction = 0.5,
     .bond_tension_limit = 20.0,
     .bond_shear_limit = 12.0,
     .bond_friction = 0.8,
     .fracture_energy = 15.0, /* over a section of (2 mm)^2: u_f = 6 um = 3 u_l */
     .shear_fracture_energy = 13.5,
     .yield_stress = {10e6, 11e6, 11.5e6},
     .yield_ratio = {3.0, 5.0, 9.0}},
    {.normal_stiffness = 1e7,
     .kratio = 2.5,
     .friction = 0.5,
     .bond_tension_limit = 20.0,
     .bond_shear_limit = 12.0},
    {.normal_stiffness = 1e7,
     .kratio = 2.5,
     .friction = 0.5,
     .bond_tension_limit = 20.0,
     .bond_shear_limit = 12.0,
     .bond_friction = 0.8},
    {.young = 5e9,
     .poisson = 0.3,
     .friction = 0.5,
     .restitution = 0.7,
     .rolling_friction = 0.1,
     .twisting_friction = 0.05,
     .adhesion = 50.0},
    {.young = 5e9, .poisson = 0.3, .friction = 0.5, .restitution = 0.7, .adhesion = 50.0},
    {.young = 5e9,
     .poisson = 0.3,
     .friction = 0.5,
     .restitution = 0.7,
     .rolling_friction = 0.1,
     .twisting_friction = 0.05},
    {.young = 5e9, .poisson = 0.3, .friction = 0.5, .restitution = 0.7},
    {.normal_stiffness = 1e7,
     .kratio = 2.5,
     .friction = 0.5,
     .rolling_friction = 0.1,
     .twisting_friction = 0.05},
    {.normal_stiffness = 1e7,
     .kratio = 2.5,
     .friction = 0.5,
     .bond_tension_limit = 20.0,
     .bond_shear_limit = 12.0},
};
#define X(name, effect, lists) effect,
static const gn_effects law_effects[] = {GN_LAWS(X)};
#undef X
#define X(name, effect, lists) lists,
static const int law_lists[] = {GN_LAWS(X)};
#undef X
enum { LAWS = sizeof materials / sizeof *materials };
_Static_assert(LAWS == sizeof law_effects / sizeof *law_effects, "a material for each law");

static const double radius = 1e-3, dt = 1e-8;

/* A joint across the line of the centres: 0.7 of the friction while it is intact. */
static void set_joint(gn_contacts *k) {
    k->plane[0] = 1.0;
    k->kn[0] = 1e7;
    k->kt[0] = 4e6;
    k->mu[0] = 0.5;
    k->mu1[0] = 0.7;
    k->rn[0] = 20.0;
    k->rt[0] = 12.0;
    k->dilation[k->soa.capacity] = 1.0;
}

static couple *make(int law, bool bonded) {
    couple *t = calloc(1, sizeof *t);
    gn_effects fx = GN_FX_SPACE | GN_FX_SHEAR | GN_FX_FRICTION | GN_FX_ENERGY |
                    GN_FX_CONTACT_FORCES | law_effects[law] | (bonded ? GN_FX_BONDS : 0U);
    t->scene = (gn_scene){.stiffness = GN_STIFFNESS_UNIFORM,
                          .softening = GN_SOFTENING_ENERGY,
                          .dimension = 3,
                          .bond_radius_multiplier = 0.8,
                          .bond_moment_share = 0.9,
                          .cohesion = law_effects[law] & GN_FX_COHESION ? GN_COHESION_DMT
                                                                        : GN_COHESION_NONE};
    if (law_effects[law] & GN_FX_SOFTENING) fx |= GN_FX_YIELD;
    if (law_effects[law] & GN_FX_ROLLING) fx |= GN_FX_ROTATION;
    t->material = materials[law];
    assert_int_equal(gn_soa_create(&gn_particle_record, &t->p, 2, fx, NULL), GNEISS_OK);
    assert_int_equal(gn_soa_create(&gn_contact_record, &t->k, 1, fx, NULL), GNEISS_OK);
    gn_particles_set_null(&t->p, 1.0);
    gn_contacts_pad(&t->k, &t->p);
    t->k.j[0] = 1;
    t->p.pos[3] = t->p.pos[7] = radius;
    t->p.vel[3] = t->p.vel[7] = 1e5;
    if (bonded) t->k.length0[0] = 2.0 * radius;
    t->law = gn_law_of(fx);
    gn_law_model model = {.scene = &t->scene};
    gn_law_pair pair = {.a = &t->material, .b = &t->material, .ri = radius, .rj = radius};
    t->law->set(&model, &pair, &t->k, 0);
    if (t->k.plane) set_joint(&t->k);
    t->args = (gn_contact_args){.pos = t->p.pos,
                                .vel = t->p.vel,
                                .spin = t->p.spin,
                                .contacts = &t->k,
                                .dt = dt,
                                .arm_factor = 0.5,
                                .cohesion = (int)t->scene.cohesion,
                                .measure = true};
    t->kernel = gn_kernel_set_at(0)->contact[gn_contact_variant(fx)];
    assert_non_null(t->kernel);
    return t;
}

static void end(couple *t) {
    gn_soa_destroy(&gn_particle_record, &t->p);
    gn_soa_destroy(&gn_contact_record, &t->k);
    free(t);
}

/* Moves to the stretch `x`, and across by `y` from the line of the last step; returns the force on
 * the first. */
static void move(couple *t, double x, double y, double force[3]) {
    double to = 2.0 * radius + x;
    t->p.vel[4] = t->step ? (to - t->p.pos[4]) / dt : 0.0;
    t->p.vel[5] =
        t->step ? y / dt : 0.0; /* the line rotates back: the transverse displacement stays */
    t->p.pos[4] = to;
    t->sums = (gn_contact_sums){0};
    t->kernel(&t->args, 0, 1, &t->sums);
    t->step++;
    memcpy(force, gn_contacts_row(&t->k), 3 * sizeof *force);
}

#define EACH_LIST(law, bonded)                                                                     \
    for (int law = 0; law < LAWS; law++)                                                           \
        for (int bonded = law_lists[law] == GN_LAW_OF_BONDS || law_lists[law] == GN_LAW_OF_JOINTS; \
             bonded < (law_lists[law] == GN_LAW_OF_PAIRS ? 1 : 2); bonded++)

enum { STEPS = 400 };

/* The bond is compressed, pulled until well after it has broken, and compressed again. */
static double way(int step) {
    return -8e-6 * sin(3.0 * pi * step / STEPS);
}

/* m, where a contact has no normal force. */
static double rest_of(const couple *t) {
    return t->k.plastic ? t->k.plastic[0] : 0.0;
}

static void no_contact_is_stiffer_than_its_law_says(void **state) {
    (void)state;
    EACH_LIST(law, bonded) {
        couple *t = make(law, bonded);
        double before[3] = {0}, now[3], last = 0.0;
        int checked = 0, jump = 0;
        for (int k = 0; k <= STEPS; k++) {
            double x = way(k), y = 1e-9 * (k % 3);
            bool whole = gn_contact_bonded(&t->k, 0);
            gn_law_spring most = t->law->spring(&t->k, 0, fmax(0.0, -fmin(x, last)));
            move(t, x, y, now);
            /* A break, and a contact that closes or opens within a step, are jumps: excluded in
             * both directions. */
            double rest = rest_of(t) - 1e-18; /* less is rounding, and no contact */
            bool jumps =
                whole != gn_contact_bonded(&t->k, 0) || (!whole && (x < rest) != (last < rest));
            jump = jumps ? 2 : jump - 1;
            if (k > 0 && jump <= 0) {
                /* Rounding of positions: two of 2e-19 m, and of their difference. */
                assert_true(fabs(now[0] - before[0]) <=
                            most.kn * (fabs(x - last) * (1.0 + 1e-9) + 1e-18));
                checked++;
            }
            memcpy(before, now, sizeof before);
            last = x;
        }
        assert_true(checked > STEPS - 10);
        end(t);
    }
}

static void force_and_energy_reported_by_the_law_are_those_of_the_kernel(void **state) {
    (void)state;
    EACH_LIST(law, bonded) {
        couple *t = make(law, bonded);
        double force[3];
        for (int k = 0; k <= STEPS; k++) {
            double x = way(k);
            move(t, x, 1e-9, force);
            bool jumps =
                !gn_contact_bonded(&t->k, 0) && fabs(x - rest_of(t)) < 1.5 * fabs(x - way(k - 1));
            if (k == 0 || jumps) continue;
            gn_law_held h = t->law->held(&t->k, 0, 2.0 * radius + x, t->p.pos[4] - 2.0 * radius);
            assert_near(h.normal, force[0], 1e-12 * (1.0 + fabs(force[0])));
            assert_near(h.shear[1], force[1], 1e-12 * (1.0 + fabs(force[1])));
            assert_near(h.stored, t->sums.elastic_normal + t->sums.elastic_shear,
                        1e-12 * (1e-6 + h.stored));
        }
        end(t);
    }
}

/* The bond is pulled and sheared by steps of a thousandth of the displacement at the break. */
static void a_bond_breaks_when_its_criterion_reaches_one(void **state) {
    (void)state;
    for (int law = 0; law < LAWS; law++)
        for (int sheared = 0; sheared < 2 && law_lists[law] != GN_LAW_OF_PAIRS; sheared++) {
            couple *t = make(law, true);
            double force[3], reached = 0.0, x = 0.0;
            int k = 0;
            for (; k < 100000 && gn_contact_bonded(&t->k, 0); k++) {
                if (k > 0)
                    reached =
                        fmax(reached, t->law->criterion(&t->k, 0, force[0], 0.0, fabs(force[1])));
                if (!sheared) x += 2e-9;
                move(t, x, sheared ? 3e-9 : 0.0, force);
            }
            assert_in_range(k, 100, 99999);
            assert_true(reached > 0.997 && reached < 1.0 + 1e-12);
            end(t);
        }
}

static void no_contact_with_a_wall_is_stiffer_than_its_law_says(void **state) {
    (void)state;
    const gn_touch_side side = {.stiffness = 1e7,
                                .kratio = 2.5,
                                .friction = 0.5,
                                .part = 0.75,
                                .radius = radius,
                                .hertz = {2.7e9, 0.6e9, 0.3, 0.5, 0.0, 0.0, GN_COHESION_NONE, 0.0}};
    const gn_touch_step step = {.dt = dt, .space = true, .pulls = true};
    for (int law = 0; law < LAWS; law++) {
        const gn_law *l = gn_law_of(law_effects[law]);
        double shear[3] = {0}, before = 0.0, t[3], last = 0.0, closeness = 0.0, bridge = 0.0;
        for (int k = 1; k <= STEPS; k++) {
            double gap = -5e-6 * sin(pi * k / STEPS) - 1e-9;
            gn_touch touch = {.n = {1.0, 0.0, 0.0},
                              .gap = gap,
                              .rounding = 1e-18,
                              .speed = (gap - last) / dt,
                              .relative = {0.0, 1e-10 / dt, 0.0},
                              .inverse_mass = 1e5,
                              .checked_overlap = 1.0,
                              .closeness = &closeness,
                              .bridge = &bridge};
            gn_contact_sums sums = {0};
            double turned = shear[1];
            gn_law_spring most = l->touch_spring(&side, 1e5, 0.0, fmax(-gap, -last));
            double force = l->touch(&step, &side, &touch, NULL, shear, 1, t, &sums);
            if (k > 1) {
                assert_true(fabs(force - before) <=
                            most.kn * fabs(gap - last) * (1.0 + 1e-9) + 1e-12);
                assert_true(t[1] - turned <= most.kt * 1e-10 * (1.0 + 1e-9) + 1e-12);
                assert_near(l->touch_stored(&side, force, t[1] * t[1]), sums.elastic_normal,
                            1e-12 * sums.elastic_normal);
            }
            before = force;
            last = gap;
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_contact_is_stiffer_than_its_law_says),
        cmocka_unit_test(force_and_energy_reported_by_the_law_are_those_of_the_kernel),
        cmocka_unit_test(a_bond_breaks_when_its_criterion_reaches_one),
        cmocka_unit_test(no_contact_with_a_wall_is_stiffer_than_its_law_says),
    };
    return cmocka_run_group_tests_name("law", tests, NULL, NULL);
}
