/* A press with a limit switch: a function between steps reads the history and sets the motion of a
 * wall; before that, another one changes the packing, and the grains get velocities.
 *
 *     cc limit_switch.c $(pkg-config --cflags --libs gneiss) -o limit_switch
 *     ./limit_switch
 *
 * Exit code: the gneiss_status of what failed, 0 when all is well. */
#include <gneiss/gneiss.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char block[] =
    "dimension: 2\n"
    "specimen: {lattice: {kind: square, radius: 1 mm, cells: [8, 8]}}\n"
    "materials: [{name: rock, density: 2600 kg/m3, contact_modulus: 1 GPa, kratio: 2, "
    "friction: 0.4, tensile_strength: 10 MPa, shear_strength: 10 MPa}]\n"
    "law: {stiffness: harmonic}\n"
    "bonds: {interaction_range: 0.05}\n"
    "damping: {background: {model: nonviscous_component, coefficient: 0.3}}\n"
    "walls:\n"
    "- {name: bottom, point: [0, 0], normal: [0, 1], stiffness: 10 MN/m}\n"
    "- {name: top, point: [0, 16 mm], normal: [0, -1], stiffness: 10 MN/m, motion: {vy: -0.1 "
    "m/s}}\n"
    "domain: {min: [-1, -1], max: [1, 1]}\n"
    "time: {end: 4 ms}\n"
    "output: {history_rows: 400}\n"
    "run: {threads: 1}\n";

/* Makes every grain up to 2 % smaller, before masses and bonds are made. */
static int wear(void *context, gneiss_specimen *specimen) {
    unsigned *seed = context;
    for (size_t k = 0; k < specimen->count; k++) {
        *seed = 1664525u * *seed + 1013904223u; /* Knuth, linear congruence */
        specimen->position[4 * k + 3] *= 1.0 - 0.02 * (double)*seed / 4294967296.0;
    }
    return 0;
}

typedef struct limit_switch {
    double limit;           /* N */
    double force, position; /* N, m: of the upper wall when it was stopped */
} limit_switch;

static double last_of(const gneiss_world *world, const char *column) {
    gneiss_view view;
    if (gneiss_world_history(world, column, &view, NULL) != GNEISS_OK || !view.count) return NAN;
    return gneiss_view_value(&view, view.count - 1, 0);
}

/* Stops the upper wall once its force has reached the limit. */
static int watch(void *context, gneiss_world *world) {
    limit_switch *s = context;
    const double force = fabs(last_of(world, "wall_top_force_y"));
    if (s->force > 0.0 || !(force > s->limit)) return 0;
    s->force = force;
    s->position = last_of(world, "wall_top_displacement_y");
    printf("t = %.3f ms: stopped at %.1f N\n", 1e3 * gneiss_world_time(world), force);
    return gneiss_world_set_motion(world, "top", 1, 0.0, NULL) != GNEISS_OK;
}

/* Lets all grains fall towards the lower wall at the same speed. */
static gneiss_status push(gneiss_world *world, gneiss_error *error) {
    gneiss_counts counts;
    gneiss_status status = gneiss_world_counts(world, &counts, error);
    double *velocity = calloc((size_t)counts.particles * 3 + 1, sizeof *velocity);
    if (!velocity) return GNEISS_ERROR_MEMORY;
    for (int64_t k = 0; k < counts.particles; k++) velocity[3 * k + 1] = -0.05;
    if (status == GNEISS_OK)
        status =
            gneiss_world_set_velocities(world, velocity, NULL, (size_t)counts.particles, error);
    free(velocity);
    return status;
}

static gneiss_status press(gneiss_world *world, gneiss_error *error) {
    limit_switch s = {.limit = 2000.0};
    gneiss_quantity residual;
    int64_t call;
    gneiss_status status = push(world, error);
    if (status == GNEISS_OK)
        status = gneiss_world_add_call(world, 10, NULL, 0, watch, &s, &call, error);
    if (status == GNEISS_OK) status = gneiss_world_run(world, error);
    if (status == GNEISS_OK) status = gneiss_world_energy(world, "residual", &residual, error);
    if (status != GNEISS_OK) return status;
    const double moved = last_of(world, "wall_top_displacement_y") - s.position;
    printf("moved by %.2g um after that; energy residual %.1e\n", 1e6 * moved, residual.value);
    /* The last row before the stop is up to 10 us old, in which the wall moves by 1 um. */
    if (s.force > 0.0 && fabs(moved) < 1e-6 && fabs(residual.value) < 0.01) return GNEISS_OK;
    snprintf(error->message, sizeof error->message, "the switch did not stop the press");
    return GNEISS_ERROR_INTERNAL;
}

int main(void) {
    gneiss_error error = {GNEISS_OK, ""};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    unsigned seed = 1;
    gneiss_status status = gneiss_scene_parse(block, "limit_switch", NULL, NULL, 0, &scene, &error);
    gneiss_scene_prepare(scene, wear, &seed);
    if (status == GNEISS_OK) status = gneiss_world_create(scene, NULL, &world, &error);
    if (status == GNEISS_OK) status = press(world, &error);
    gneiss_world_free(world);
    gneiss_scene_free(scene);
    if (status != GNEISS_OK) fprintf(stderr, "%s: %s\n", gneiss_status_name(status), error.message);
    return status;
}
