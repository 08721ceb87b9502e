/* Convex rigid bodies that meet each other. */
#include "surface_helpers.h"

#include "run/run.h"
#include "sim/body_pairs.h"
#include "surfaces/body_shape.h"

/* One far particle, so that there is a specimen; it is held. */
static const char head3[] =
    "dimension: 3\nspecimen: {particles: [[0, 50, 0.05, 0.02]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
    "law: {stiffness: uniform}\nsets: [{name: far, select: {all: true}, motion: {vx: 0, vy: 0, vz: "
    "0, wx: 0, wy: 0, wz: 0}}]\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n";
static const char head2[] =
    "dimension: 2\nspecimen: {particles: [[50, 0.05, 0.02]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
    "law: {stiffness: uniform}\nsets: [{name: far, select: {all: true}, motion: {vx: 0, vy: 0, wz: "
    "0}}]\ndomain: {min: [-99, -99], max: [99, 99]}\n";

#define assert_ok(call, error)                                                                     \
    do {                                                                                           \
        if ((call) != GNEISS_OK) fail_msg("%s", (error)->message);                                 \
    } while (0)

static gn_rigid *body(gn_world *w, size_t k) {
    return &w->boundary.bodies[k];
}

/* Steps, all measured, up to a time; the largest residual. */
static double run_to(gn_world *w, double time) {
    double worst = 0.0;
    while (w->time < time) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    return worst;
}

/* Linear and angular momentum about the origin of all bodies, at the half step. */
static void momentum_of(const gn_world *w, double p[3], double l[3]) {
    for (int a = 0; a < 3; a++) p[a] = l[a] = 0.0;
    for (size_t k = 0; k < w->scene.body_count; k++) {
        const gn_rigid *b = &w->boundary.bodies[k];
        double turn[3];
        cross3(b->position, b->velocity, turn);
        for (int a = 0; a < 3; a++) {
            p[a] += b->mass * b->velocity[a];
            l[a] += b->mass * turn[a] + b->momentum[a];
        }
    }
}

/* A box about a centre, turned by a vector, as a line of the scene. */
static const char *box(const char *name, const double size[3], const double centre[3],
                       const double turn[3], const char *more) {
    static char lines[8][1024];
    static int next;
    char *line = lines[next++ % 8];
    double m[9], at[3];
    gn_rotation_matrix(turn, m);
    for (int a = 0; a < 3; a++) at[a] = centre[a] - 0.5 * dot3(m + 3 * a, size);
    snprintf(line, sizeof lines[0],
             "  - {name: %s, box: {size: [%.17g, %.17g, %.17g]}, origin: [%.17g, %.17g, %.17g], "
             "rotation: [%.17g, %.17g, %.17g], %s}\n",
             name, size[0], size[1], size[2], at[0], at[1], at[2], turn[0], turn[1], turn[2], more);
    return line;
}

/* --- head on --- */

static const double flat[3] = {0, 0, 0}, aside[3] = {0, 0, 0.3};
/* The diagonal of a cube along z, and an edge downward. */
static const double on_a_corner[3] = {0.675510858856, -0.675510858856, 0};
static const double on_an_edge[3] = {0.785398163397448, 0, 0};
static const double on_other_edge[3] = {0, 0.785398163397448, 0};

/* A cube of 2 kg flies down at 1 m/s onto another one of half the side and 1 kg. */
static gn_world *head_on(const double upper[3], const double lower[3], double restitution) {
    const double large[3] = {0.1, 0.1, 0.1}, small[3] = {0.05, 0.05, 0.05};
    return world_of("%sdamping: {contact: {restitution: %g}}\nbodies:\n%s%stime: {end: 1}\n", head3,
                    restitution,
                    box("a", large, (const double[3]){0.01, 0.02, 0.3}, upper,
                        "stiffness: 2e6, free: true, density: 2000, initial_velocity: [0, 0, -1]"),
                    box("b", small, (const double[3]){0.01, 0.02, 0.0}, lower,
                        "stiffness: 2e6, free: true, density: 8000"));
}

static void cubes_rebound_with_the_restitution(void **state) {
    (void)state;
    const double *const turns[][2] = {{flat, aside},
                                      {on_a_corner, flat},
                                      {flat, on_a_corner},
                                      {on_an_edge, on_other_edge},
                                      {on_a_corner, on_a_corner}};
    const double wanted[] = {1.0, 0.8, 0.5};
    for (size_t k = 0; k < 3 * sizeof turns / sizeof *turns; k++) {
        double e = wanted[k % 3], p[3], l[3];
        gn_world *w = head_on(turns[k / 3][0], turns[k / 3][1], e);
        double worst = run_to(w, 0.4), apart = body(w, 0)->velocity[2] - body(w, 1)->velocity[2];
        momentum_of(w, p, l);
        print_message("# %zu: e %.4f (%.1f), residual %.2g, spin %.2g, dt %.3g\n", k / 3, apart, e, worst,
                      length3(body(w, 0)->spin), w->dt);
        assert_near(apart, e, 0.01);
        assert_near(p[2], -2.0, 1e-12);
        assert_true(worst < 1e-3);
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_rebound_with_the_restitution),
    };
    (void)head2;
    (void)momentum_of;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
