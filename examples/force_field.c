/* A magnet passes over a heap of iron grains and lifts them: a field of force of one's own, whose
 * work is a term of the energy ledger, and a function that is called at given times.
 *
 *     cc force_field.c $(pkg-config --cflags --libs gneiss) -o force_field
 *     ./force_field
 *
 * Exit code: the gneiss_status of what failed, 0 when all is well. */
#include <gneiss/gneiss.h>

#include <stdio.h>

static const char grains[] =
    "dimension: 2\n"
    "specimen: {lattice: {kind: hexagonal, radius: 1 mm, cells: [14, 3], jitter: 0.05}}\n"
    "materials: [{name: iron, density: 7800 kg/m3, normal_stiffness: 0.1 MN/m, kratio: 3, "
    "friction: 0.4}]\n"
    "law: {stiffness: uniform}\n"
    "damping: {contact: {restitution: 0.3}}\n"
    "gravity: [0, -9.81]\n"
    "walls: [{name: table, point: [0, 0], normal: [0, 1], stiffness: 0.1 MN/m, kratio: 3, "
    "friction: 0.4}]\n"
    "domain: {min: [-1, -1], max: [1, 1]}\n"
    "time: {end: 0.1 s}\n"
    "run: {threads: 1}\n";

/* Grains are drawn to the magnet with F = m C/(r^2 + a^2)^2, as small magnetisable bodies are far
 * from a pole. */
static int magnet(void *context, const gneiss_points *points) {
    const double pole[2] = {-0.01 + 0.5 * points->time, 0.025}, strength = 1.5e-4, near = 5e-3;
    (void)context;
    for (size_t k = 0; k < points->count; k++) {
        const double *position = points->position + 4 * k, inverse = points->velocity[4 * k + 3];
        const double x = pole[0] - position[0], y = pole[1] - position[1];
        const double r2 = x * x + y * y + near * near;
        if (!(inverse > 0.0)) continue; /* a removed grain has no mass */
        points->force[3 * k] = strength * x / (r2 * r2 * inverse);
        points->force[3 * k + 1] = strength * y / (r2 * r2 * inverse);
    }
    return 0;
}

static int print_highest(void *context, gneiss_world *world) {
    double *highest = context, now = 0.0;
    gneiss_view pos;
    if (gneiss_world_field(world, GNEISS_PARTICLES, "pos", &pos, NULL) != GNEISS_OK) return 1;
    for (size_t k = 0; k < pos.count; k++) {
        const double y = gneiss_view_value(&pos, k, 1);
        if (y > now) now = y;
    }
    printf("t = %.3f s: highest grain at %.1f mm\n", gneiss_world_time(world), 1e3 * now);
    if (now > *highest) *highest = now;
    return 0;
}

static gneiss_status print_energy(const gneiss_world *world, const char *name,
                                  gneiss_error *error) {
    gneiss_quantity term;
    gneiss_status status = gneiss_world_energy(world, name, &term, error);
    if (status == GNEISS_OK)
        printf("  %s %.3g %s (%s)\n", term.name, term.value, term.unit, term.description);
    return status;
}

static gneiss_status lift(gneiss_world *world, double *highest, gneiss_error *error) {
    static const double times[] = {0.02, 0.04, 0.06, 0.08, 0.1};
    static const char *const terms[] = {"work_user", "work_gravity", "friction", "residual"};
    int64_t field, call;
    gneiss_status status =
        gneiss_world_add_force(world, GNEISS_PARTICLES, 0.0, magnet, NULL, &field, error);
    if (status == GNEISS_OK)
        status = gneiss_world_add_call(world, 0, times, 5, print_highest, highest, &call, error);
    if (status == GNEISS_OK) status = gneiss_world_run(world, error);
    for (size_t k = 0; status == GNEISS_OK && k < sizeof terms / sizeof *terms; k++)
        status = print_energy(world, terms[k], error);
    return status;
}

int main(void) {
    gneiss_error error = {GNEISS_OK, ""};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    double highest = 0.0; /* m */
    gneiss_status status = gneiss_scene_parse(grains, "force_field", NULL, NULL, 0, &scene, &error);
    if (status == GNEISS_OK) status = gneiss_world_create(scene, NULL, &world, &error);
    if (status == GNEISS_OK) status = lift(world, &highest, &error);
    if (status == GNEISS_OK && highest < 0.02) {
        snprintf(error.message, sizeof error.message, "the magnet lifted no grain");
        status = GNEISS_ERROR_INTERNAL;
    }
    gneiss_world_free(world);
    gneiss_scene_free(scene);
    if (status != GNEISS_OK) fprintf(stderr, "%s: %s\n", gneiss_status_name(status), error.message);
    return status;
}
