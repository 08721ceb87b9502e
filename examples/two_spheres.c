/* Draws two bonded spheres apart until the bond breaks: the public API from one end to the other.
 *
 *     cc two_spheres.c $(pkg-config --cflags --libs gneiss) -o two_spheres
 *     ./two_spheres [SCENE [CHECKPOINT]]
 *
 * SCENE: two_spheres.yaml in the working folder by default; the checkpoint is removed
 * again. Exit code: the gneiss_status of what failed, 0 when all is well. */
#include <gneiss/gneiss.h>

#include <inttypes.h>
#include <stdio.h>

static gneiss_status report(gneiss_status status, const gneiss_error *error) {
    if (status != GNEISS_OK)
        fprintf(stderr, "%s: %s\n", gneiss_status_name(status), error->message);
    return status;
}

/* Fields are looked at where they lie: no copies. */
static gneiss_status print_particles(const gneiss_world *world, gneiss_error *error) {
    gneiss_view id, pos;
    gneiss_status status = gneiss_world_field(world, GNEISS_PARTICLES, "id", &id, error);
    if (status == GNEISS_OK)
        status = gneiss_world_field(world, GNEISS_PARTICLES, "pos", &pos, error);
    if (status != GNEISS_OK) return status;
    for (size_t k = 0; k < pos.count; k++) {
        const double *row = (const double *)((const char *)pos.data + k * pos.item_stride);
        printf("  particle %g: x = %.6f mm, radius %g mm\n", gneiss_view_value(&id, k, 0),
               1e3 * row[0], 1e3 * row[3]);
    }
    return GNEISS_OK;
}

static gneiss_status print_reading(const gneiss_world *world, const char *name,
                                   gneiss_error *error) {
    gneiss_quantity reading;
    gneiss_status status = gneiss_world_reading(world, name, &reading, error);
    if (status == GNEISS_OK)
        printf("  %s = %g %s (%s)\n", reading.name, reading.value, reading.unit,
               reading.description);
    return status;
}

/* Runs to the end and says what came out. */
static gneiss_status finish(gneiss_world *world, gneiss_error *error) {
    gneiss_progress progress;
    gneiss_status status = gneiss_world_run(world, error);
    if (status == GNEISS_OK) status = gneiss_world_progress(world, &progress, error);
    if (status != GNEISS_OK) return status;
    printf("step %" PRId64 ", t = %g s: %s\n", progress.step, progress.time, progress.stop_reason);
    status = print_particles(world, error);
    if (status == GNEISS_OK) status = print_reading(world, "young_modulus", error);
    if (status == GNEISS_OK) status = print_reading(world, "peak_stress", error);
    printf("  state %016" PRIx64 "\n", gneiss_world_hash(world));
    return status;
}

/* A hundred steps, saved; the first world runs on, and so does one made from the file. */
static gneiss_status save_and_resume(gneiss_world *first, const char *checkpoint,
                                     gneiss_error *error) {
    gneiss_world *second = NULL;
    gneiss_status status = gneiss_world_step(first, 100, error);
    if (status == GNEISS_OK) status = gneiss_world_save(first, checkpoint, error);
    if (status == GNEISS_OK) status = finish(first, error);
    if (status == GNEISS_OK) status = gneiss_world_load(checkpoint, NULL, 0, &second, error);
    remove(checkpoint);
    if (status == GNEISS_OK) printf("resumed from step %" PRId64 "\n", gneiss_world_steps(second));
    if (status == GNEISS_OK) status = finish(second, error);
    if (status == GNEISS_OK && gneiss_world_hash(first) != gneiss_world_hash(second)) {
        snprintf(error->message, sizeof error->message, "the resumed world went elsewhere");
        status = GNEISS_ERROR_INTERNAL;
    }
    gneiss_world_free(second);
    return status;
}

int main(int argc, char **argv) {
    const char *path = argc > 1 ? argv[1] : "two_spheres.yaml";
    const char *checkpoint = argc > 2 ? argv[2] : "two_spheres.h5";
    const char *const overrides[] = {"run.threads=1"};
    gneiss_error error = {GNEISS_OK, ""};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    printf("gneiss %s\n", gneiss_version());
    gneiss_status status = gneiss_scene_load(path, overrides, 1, &scene, &error);
    if (status == GNEISS_OK) status = gneiss_world_create(scene, NULL, &world, &error);
    if (status == GNEISS_OK) status = save_and_resume(world, checkpoint, &error);
    gneiss_world_free(world);
    gneiss_scene_free(scene);
    return report(status, &error);
}
