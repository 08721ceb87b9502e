/* One bond that softens, on prescribed paths (src/kernels/law_softening.h). */
#ifndef SOFTENING_BOND_H
#define SOFTENING_BOND_H

#include "kernels/law.h"
#include "kernels/softening.h"
#include "run_helpers.h"

/* Two spheres of 1 mm along x. A step moves them along x or across, so that the motion is exact to
 * rounding. k_n = 1e7 N/m, k_t = 4e6 N/m, R_n = 20 N, C = 12 N, area (2 mm)^2. */
typedef struct bond {
    gn_scene scene;
    gn_material material;
    gn_particles p;
    gn_contacts k;
    gn_contact_args args;
    gn_contact_kernel *kernel;
    gn_contact_sums sums;                      /* sums of the last step */
    double lost, damage, breaking, plasticity; /* J, of all */
    double work;                               /* J, trapezoidal */
    double force[3], u;
    bool started;
} bond;

static const double kn = 1e7, kt = 4e6, rn = 20.0, cohesion = 12.0, area = 4e-6, dt = 1e-6;
static const double radius = 1e-3;

static const gn_material concrete = {.normal_stiffness = 1e7,
                                     .kratio = 2.5,
                                     .friction = 0.3,
                                     .bond_tension_limit = 20.0,
                                     .bond_shear_limit = 12.0,
                                     .bond_friction = 0.8,
                                     .fracture_energy = 15.0,        /* u_f = 6 um, u_l = 2 um */
                                     .shear_fracture_energy = 13.5}; /* u_s = 9 um, of 3 um */

static bond *make_of(const gn_material *material, gn_effects law) {
    bond *t = calloc(1, sizeof *t);
    gn_effects fx = GN_FX_SPACE | GN_FX_SHEAR | GN_FX_FRICTION | GN_FX_ENERGY | GN_FX_BONDS |
                    GN_FX_CONTACT_FORCES | GN_FX_MOHR | law;
    t->scene = (gn_scene){
        .stiffness = GN_STIFFNESS_UNIFORM, .softening = GN_SOFTENING_ENERGY, .dimension = 3};
    t->material = *material;
    assert_int_equal(gn_soa_create(&gn_particle_record, &t->p, 2, fx, NULL), GNEISS_OK);
    assert_int_equal(gn_soa_create(&gn_contact_record, &t->k, 1, fx, NULL), GNEISS_OK);
    gn_particles_set_null(&t->p, 1.0);
    gn_contacts_pad(&t->k, &t->p);
    t->k.j[0] = 1;
    t->p.pos[3] = t->p.pos[7] = radius;
    t->p.pos[4] = 2.0 * radius;
    t->p.vel[3] = t->p.vel[7] = 1.0;
    t->k.length0[0] = 2.0 * radius;
    gn_law_model model = {.scene = &t->scene};
    gn_law_pair pair = {.a = &t->material, .b = &t->material, .ri = radius, .rj = radius};
    gn_law_of(fx)->set(&model, &pair, &t->k, 0);
    t->args = (gn_contact_args){.pos = t->p.pos,
                                .vel = t->p.vel,
                                .contacts = &t->k,
                                .dt = dt,
                                .arm_factor = 0.5,
                                .measure = true};
    t->kernel = gn_kernel_set_at(0)->contact[gn_contact_variant(fx)];
    assert_non_null(t->kernel);
    return t;
}

static bond *make(const gn_material *material, gn_effects more) {
    return make_of(material, GN_FX_SOFTENING | more);
}

static void end(bond *t) {
    gn_soa_destroy(&gn_particle_record, &t->p);
    gn_soa_destroy(&gn_contact_record, &t->k);
    free(t);
}

/* Moves to the stretch `u`, or across by y and z. */
static void move(bond *t, double u, double y, double z) {
    double to = 2.0 * radius + u, before[3];
    double path[3] = {to - t->p.pos[4], y, z};
    memcpy(before, t->force, sizeof before);
    for (int a = 0; a < 3; a++) t->p.vel[4 + a] = path[a] / dt;
    t->p.pos[4] = to;
    t->sums = (gn_contact_sums){0};
    t->kernel(&t->args, 0, 1, &t->sums);
    memcpy(t->force, gn_contacts_row(&t->k), sizeof before);
    t->u = t->p.pos[4] - 2.0 * radius;
    for (int a = 0; a < 3; a++) t->work += 0.5 * (before[a] + t->force[a]) * path[a];
    t->damage += t->sums.damage;
    t->breaking += t->sums.bond_breaking;
    t->plasticity += t->sums.plasticity;
    t->lost += t->sums.damage + t->sums.bond_breaking + t->sums.plasticity + t->sums.friction;
}

/* Rounding of positions (2 mm: 4e-19 m) over all stretches. */
static const double force_rounding = 2e-11; /* N */
/* Rounding of sums of some 1e-5 J (under pressure: 1e-3 J). */
static const double energy_rounding = 1e-18;

static void set_again(bond *t, gn_softening softening) {
    t->scene.softening = softening;
    gn_law_model model = {.scene = &t->scene};
    gn_law_pair pair = {.a = &t->material, .b = &t->material, .ri = radius, .rj = radius};
    gn_law_of(t->k.soa.effects)->set(&model, &pair, &t->k, 0);
}

/* One bond by the law's function alone: in a kernel tangential motion also rotates the normal. */
typedef struct pure {
    gn_softening_bond b;
    gn_cause cause;
    double u, f, t, work; /* normal and tangential force, trapezoidal work */
} pure;

static void go(pure *p, double u, double slip) {
    gn_softening_way way = {{p->u, u}, {{p->t, 0.0, 0.0}, {p->t + kt * slip, 0.0, 0.0}}};
    double t[3], f = kn * u, was = p->f, before = p->t;
    if (u > 0.0) f *= p->b.soft;
    p->cause = gn_soften(&p->b, &way, &f, t);
    p->f = p->cause ? 0.0 : f;
    p->t = p->cause ? 0.0 : t[0];
    p->work += 0.5 * (was + p->f) * (u - p->u) + 0.5 * (before + p->t) * slip;
    p->u = u;
}

#endif
