#include "cli/stiffness.h"

#include "base/new.h"
#include "base/timer.h"
#include "cli/log.h"
#include "cli/pack.h"
#include "cli/progress.h"
#include "io/io.h"
#include "laboratory/laboratory.h"
#include "plan/estimate.h"
#include "run/history_rows.h"
#include "run/run.h"
#include "scene/laboratory.h"
#include "scene/stages.h"
#include "scene/units.h"
#include "static/first_break.h"
#include "static/network.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Default strain of a test between ends that hold the specimen: far below failure, far above
 * rounding. `strain_most` is the largest strain that --strain accepts. */
static const double default_strain = 1e-5, strain_most = 0.1;
/* Number of particles of a specimen below which one thread is used, unless the scene gives the
 * number of threads. */
static const size_t particles_shared = 50000;
enum { STATES = 20 }; /* number of states; readings use those up to half of the largest stress */

/* Readings of a test that are elastic constants. */
#define CONSTANTS(X)                                                                               \
    X(young_modulus)                                                                               \
    X(young_modulus_average)                                                                       \
    X(poisson_ratio)                                                                               \
    X(plane_young_modulus)                                                                         \
    X(plane_poisson_ratio)                                                                         \
    X(bulk_modulus)                                                                                \
    X(oedometric_modulus)                                                                          \
    X(shear_modulus)                                                                               \
    X(flexural_modulus)                                                                            \
    X(stiffness)

static bool has_constant(const gn_scene *scene, gn_reading which) {
    const bool plane =
        which == GN_READING_plane_young_modulus || which == GN_READING_plane_poisson_ratio;
    return gn_reading_belongs(which, scene->test.kind, false) && !(plane && scene->dimension == 3);
}

typedef struct outcome {
    gn_network network;
    double strain; /* strain of the test */
    bool unseated; /* walls load the specimen, and the strain at the peak is unknown */
    const gn_readings *readings; /* readings, owned by the run; NULL: no test */
    char absent[GNEISS_MESSAGE_SIZE];
    int64_t solutions, iterations; /* of both computations */
    double start;                  /* gn_now() */
} outcome;

/* --- the scene --- */

static gneiss_status read_strain(const gn_options *options, double *strain, gneiss_error *error) {
    char reason[256];
    *strain = 0.0; /* the strain is chosen later */
    if (!options->strain) return GNEISS_OK;
    gn_units *units = gn_units_new();
    if (!units) return gn_no_memory(error, "units");
    const bool read =
        gn_units_read(units, options->strain, GN_STRAIN, strain, reason, sizeof reason);
    gn_units_free(units);
    if (read && *strain > 0.0 && *strain < strain_most) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "--strain: expected a strain in (0, 0.1), such as 1e-5 or 0.1 %%, found '%s'",
                   options->strain);
}

static gneiss_status check_scene(const gn_options *options, const gn_scene *scene,
                                 gneiss_error *error) {
    const char *found = scene->has_elements                                    ? "finite elements"
                        : scene->joint_count                                   ? "joints"
                        : !scene->has_specimen || scene->bonds != GN_SWITCH_ON ? "no bonds"
                                                                               : NULL;
    if (!found) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.1000s: stiffness: expected bonded particles alone at the start, found %s",
                   options->target, found);
}

static void drop_stages(gn_scene *scene) {
    for (size_t k = 0; k < scene->stage_count; k++) gn_free(scene->stages[k].changes);
    gn_free(scene->stages);
    scene->stages = NULL;
    scene->stage_count = scene->bonds_stage = scene->membrane_stage = 0;
}

/* Removes the stages of the scene: the loads become those of the last stage, and the specimen
 * remains that of the start. */
static gneiss_status load_scene(const gn_options *options, gn_scene **scene, gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *whole = NULL;
    GN_TRY(gn_new(&whole, 1, "a scene", error));
    GN_TRY(gn_new(scene, 1, "a scene", error));
    GN_TRY(
        gn_scene_load(options->target, options->overrides, options->override_count, whole, error));
    gn_print_notes(&whole->notes);
    GN_TRY(check_scene(options, whole, error));
    if (!whole->stage_count) {
        **scene = *whole;
        memset(whole, 0, sizeof *whole);
    } else {
        GN_TRY(gn_scene_stage(whole, whole->stage_count - 1, *scene, error));
        drop_stages(*scene);
    }
    (*scene)->allow_gmsh = options->allow_gmsh;
    gn_options packing = *options; /* standard output gets the JSON object only */
    packing.quiet = packing.quiet || options->json;
    packing.json = false;
    GN_TRY(gn_pack_ahead(&packing, *scene, error));
    /* Solutions for few particles are too short for several threads. */
    if (!(*scene)->threads && (*scene)->specimen.packed_count < particles_shared)
        (*scene)->threads = 1;
    /* The pressure of a membrane is constant and therefore has no increment. */
    (*scene)->has_membrane = false;
    (*scene)->history_rows = STATES;
    return GNEISS_OK;
}

/* --- the test --- */

static gneiss_status note_state(void *context, const gn_first_break *so_far, gneiss_error *error) {
    gn_run *run = context;
    (void)so_far;
    return gn_history_record_state(&run->world, &run->history, error);
}

static const char *test_refusal(const gn_scene *scene) {
    if (!gn_scene_tested(scene)) return "the scene has no test";
    bool constants = false;
#define X(name) constants = constants || has_constant(scene, GN_READING_##name);
    CONSTANTS(X)
#undef X
    if (!gn_scene_test(scene)->ends || !constants) return "such a test gives no elastic constants";
    if (scene->test.has_control) return "expected ends with prescribed motion, found test.control";
    return gn_scene_loading_refusal(scene);
}

/* Returns the largest displacement, up to the end of the scene, of the wall or set that is an end
 * of the specimen, m. */
static double end_path(const gn_scene *scene, const gn_test_end *end) {
    double most = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(scene, end->name[k]),
                  set = gn_scene_find_set(scene, end->name[k]);
        const gn_motion *motion = wall >= 0  ? &scene->walls[wall].motion
                                  : set >= 0 ? &scene->sets[set].motion
                                             : NULL;
        if (motion)
            most = fmax(
                most, fabs(gn_table_between(&motion->velocity[scene->test.axis], 0.0, scene->end)));
    }
    return most;
}

/* Returns the sum of the displacements of both ends over the larger one. */
static double sides(const gn_scene *scene) {
    const double lower = end_path(scene, &scene->test.lower),
                 upper = end_path(scene, &scene->test.upper);
    return lower + upper > 0.0 ? (lower + upper) / fmax(lower, upper) : 1.0;
}

static bool has_walls(const gn_scene *scene) {
    const gn_test_end *ends[] = {&scene->test.lower, &scene->test.upper};
    for (size_t k = 0; k < 2; k++)
        for (size_t n = 0; n < ends[k]->count; n++)
            if (gn_scene_find_wall(scene, ends[k]->name[n]) >= 0) return true;
    return false;
}

/* Chooses the strain of the test. Platens come into contact gradually. At the strain of the
 * predicted peak, readings are taken over the same part of the curve as in a run. Otherwise the
 * curve is straight. */
static gneiss_status choose_strain(const gn_world *w, double *strain, bool *unseated,
                                   gneiss_error *error) {
    gn_estimate estimate = {0};
    if (*strain > 0.0) return GNEISS_OK;
    *strain = default_strain;
    if (!has_walls(&w->ctx.scene)) return GNEISS_OK;
    GN_TRY(gn_estimate_make(&w->ctx, &w->dem, &w->solids, &estimate, error));
    if (!estimate.absent && estimate.strain > default_strain && estimate.strain < strain_most)
        *strain = estimate.strain;
    else
        *unseated = true;
    return GNEISS_OK;
}

static gneiss_status load_test(gn_run *run, outcome *found, gneiss_error *error) {
    const gn_world *w = &run->world;
    const gn_tested_shape shape = gn_test_shape(&w->ctx, &w->dem, &w->boundary, &w->solids);
    gn_first_break path;
    GN_TRY(choose_strain(w, &found->strain, &found->unseated, error));
    gneiss_status status =
        gn_static_loading(&run->world, found->strain * shape.length / sides(&w->ctx.scene), STATES,
                          &(gn_first_break_watch){note_state, run}, &path, error);
    found->solutions += path.solutions;
    found->iterations += path.iterations;
    if (status != GNEISS_OK) return status;
    return gn_run_readings(run, &found->readings, error);
}

/* Runs the test. If the test is not possible without time steps, only the elastic constants of the
 * network are found. */
static gneiss_status find_test(gn_run *run, outcome *found, gneiss_error *error) {
    const char *reason = test_refusal(&run->world.ctx.scene);
    if (reason) {
        const bool expects = gn_scene_loading_refusal(&run->world.ctx.scene) == reason;
        snprintf(found->absent, sizeof found->absent, "%s%s", expects ? "expected " : "", reason);
        return GNEISS_OK;
    }
    gneiss_status status = load_test(run, found, error);
    if (status != GNEISS_ERROR_INPUT && status != GNEISS_ERROR_UNSTABLE) return status;
    snprintf(found->absent, sizeof found->absent, "%s", error->message);
    *error = (gneiss_error){0};
    return GNEISS_OK;
}

/* --- JSON --- */

static void put_matrix(gn_json *json, const char *key, const double *c, int n) {
    gn_json_array(json, key);
    for (int a = 0; a < n; a++) {
        gn_json_array(json, NULL);
        for (int b = 0; b < n; b++) gn_json_number(json, NULL, c[n * a + b]);
        gn_json_end(json);
    }
    gn_json_end(json);
}

static void put_tensor(gn_json *json, const char *key, const gn_elastic *tensor) {
    const gn_isotropic iso = gn_isotropic_of(tensor);
    gn_json_object(json, key);
    GN_JSON_NUMBERS(json, {"young_modulus", iso.young}, {"poisson_ratio", iso.poisson});
    put_matrix(json, "tensor", tensor->c, gn_voigt_size(tensor->dimension));
    gn_json_number(json, "anisotropy", iso.anisotropy);
    gn_json_end(json);
}

static void put_fabric(gn_json *json, const gn_network *x) {
    const gn_bond_fabric *f = &x->fabric;
    const int d = x->network.dimension;
    double second[9];
    for (int a = 0; a < d * d; a++) second[a] = f->second[3 * (a / d) + a % d];
    gn_json_object(json, "fabric");
    put_matrix(json, "second", second, d);
    put_matrix(json, "fourth", f->fourth, gn_voigt_size(d));
    GN_JSON_NUMBERS(json, {"coordination", 2.0 * (double)f->bonds / (double)x->particles},
                    {"porosity", 1.0 - x->solid / x->volume}, {"volume", x->volume},
                    {"mean_length", f->length}, {"mean_square_length", f->square},
                    {"mean_square_radius", x->radius_square}, {"mean_cube_radius", x->radius_cube},
                    {"mean_normal_stiffness", f->kn}, {"mean_shear_stiffness", f->kt},
                    {"modulus", f->modulus});
    gn_json_end(json);
}

static void put_test(gn_json *json, const gn_scene *scene, const outcome *found) {
    const gn_readings *r = found->readings;
    if (!r) {
        gn_json_text(json, "test", NULL);
        gn_json_text(json, "test_absent", found->absent);
        return;
    }
    gn_json_object(json, "test");
    gn_json_text(json, "kind", gn_scene_test(scene)->name);
    gn_json_number(json, "strain", found->strain);
#define X(name)                                                                                    \
    if (has_constant(scene, GN_READING_##name)) gn_json_number(json, #name, r->name);
    CONSTANTS(X)
#undef X
    gn_json_object(json, "absent");
#define X(name)                                                                                    \
    if (has_constant(scene, GN_READING_##name) && isnan(r->name))                                  \
        gn_json_text(json, #name, r->reason[GN_READING_##name]);
    CONSTANTS(X)
#undef X
    gn_json_end(json);
    gn_json_end(json);
}

static gneiss_status print_json(const gn_options *options, const gn_scene *scene,
                                const outcome *found, gneiss_error *error) {
    const gn_network *x = &found->network;
    gn_json *json = gn_json_begin();
    put_test(json, scene, found);
    put_tensor(json, "network", &x->network);
    put_tensor(json, "uniform_strain", &x->strained);
    if (x->has_stressed)
        put_tensor(json, "uniform_stress", &x->stressed);
    else
        gn_json_text(json, "uniform_stress", NULL);
    put_fabric(json, x);
    gn_json_integer(json, "particles", (int64_t)x->particles);
    gn_json_integer(json, "boundary_particles", (int64_t)x->boundary);
    gn_json_integer(json, "bonds", (int64_t)x->fabric.bonds);
    gn_json_integer(json, "solutions", found->solutions);
    gn_json_integer(json, "iterations", found->iterations);
    GN_JSON_NUMBERS(json, {"residual", x->residual}, {"seconds", gn_now() - found->start});
    char *text = gn_json_finish(json, false);
    if (!text) return gn_no_memory(error, "the text of the results");
    if (options->log) {
        gn_print_object("result", text);
        return GNEISS_OK;
    }
    puts(text);
    free(text);
    return GNEISS_OK;
}

/* --- words --- */

static const char *modulus_text(double value, char *text, size_t size) {
    static const struct {
        double factor;
        const char *unit;
    } units[] = {{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}, {1.0, "Pa"}};
    size_t k = 0;
    while (k < 3 && !(fabs(value) >= 0.1 * units[k].factor)) k++;
    snprintf(text, size, "%.5g %s", value / units[k].factor, units[k].unit);
    return text;
}

static void print_reading(const gn_readings *r, const char *name, gn_reading which, double value,
                          const char *unit) {
    char text[32];
    if (isnan(value))
        printf("  %-22s -   %s\n", name, r->reason[which]);
    else if (strcmp(unit, "Pa") == 0)
        printf("  %-22s %s\n", name, modulus_text(value, text, sizeof text));
    else
        printf("  %-22s %.5g%s%s\n", name, value, strcmp(unit, "1") == 0 ? "" : " ",
               strcmp(unit, "1") == 0 ? "" : unit);
}

static const char *unit_of(gn_reading which) {
#define X(name, unit, text) unit,
    static const char *const units[] = {GN_READINGS(X)};
#undef X
    return units[which];
}

static void print_test(const gn_scene *scene, const outcome *found) {
    const gn_readings *r = found->readings;
    if (!r) {
        printf("test: none: %s\n", found->absent);
        return;
    }
    printf("test: %s up to a strain of %.3g, by equilibria\n", gn_scene_test(scene)->name,
           found->strain);
#define X(name)                                                                                    \
    if (has_constant(scene, GN_READING_##name))                                                    \
        print_reading(r, #name, GN_READING_##name, r->name, unit_of(GN_READING_##name));
    CONSTANTS(X)
#undef X
}

static void note_unseated(const outcome *found) {
    if (found->readings && found->unseated)
        fprintf(stderr,
                "gneiss: note: no strain at the peak is predicted for this test, and platens are "
                "seated by the load: E at a strain of %.3g may be too low by a tenth or more "
                "(--strain gives another)\n",
                found->strain);
}

static void print_tensor(const char *name, const gn_elastic *tensor) {
    const gn_isotropic iso = gn_isotropic_of(tensor);
    char text[32];
    printf("  %-22s %-14s %8.4f   %8.4f\n", name, modulus_text(iso.young, text, sizeof text),
           iso.poisson, iso.anisotropy);
}

static void print_matrix(const gn_elastic *tensor) {
    const int n = gn_voigt_size(tensor->dimension);
    const double round_off =
        1e-6; /* relative to the largest entry: the tolerance of the solutions */
    double most = 0.0;
    for (int a = 0; a < n; a++) most = fmax(most, tensor->c[(n + 1) * a]);
    const double unit = most >= 1e8 ? 1e9 : most >= 1e5 ? 1e6 : 1.0;
    printf("stiffness of the network, %s, rows and columns %s\n",
           unit == 1e9   ? "GPa"
           : unit == 1e6 ? "MPa"
                         : "Pa",
           n == 6 ? "xx yy zz xy yz xz" : "xx yy xy");
    for (int a = 0; a < n; a++) {
        for (int b = 0; b < n; b++) {
            const double c = tensor->c[n * a + b];
            printf(" %10.4g", fabs(c) < round_off * most ? 0.0 : c / unit);
        }
        printf("\n");
    }
}

static void print_text(const gn_scene *scene, const outcome *found) {
    const gn_network *x = &found->network;
    const int d = x->network.dimension;
    printf("%zu particles, %zu bonds, %.2f per particle, in %.5g %s\n", x->particles,
           x->fabric.bonds, 2.0 * (double)x->fabric.bonds / (double)x->particles, x->volume,
           d == 3 ? "m3" : "m2");
    printf("fabric                   ");
    for (int a = 0; a < d; a++)
        printf("%c%c %.4f  ", "xyz"[a], "xyz"[a], x -> fabric.second[4 * a]);
    printf("\n");
    print_test(scene, found);
    printf("packing                  E                   nu   anisotropy%s\n",
           d == 2 ? "   (plane strain)" : "");
    print_tensor("network", &x->network);
    print_tensor("uniform strain, above", &x->strained);
    if (x->has_stressed)
        print_tensor("uniform stress", &x->stressed);
    else
        printf("  %-22s -   some bonds lack a stiffness\n", "uniform stress");
    print_matrix(&x->network);
    if (x->boundary)
        printf("boundary: %zu particles within %.3g m of the hull follow the strain\n", x->boundary,
               x->depth);
    else
        printf("boundary: none, the box is periodic\n");
    printf("%lld linear systems, %lld iterations, residual loads %.1g, %.2f s\n",
           (long long)found->solutions, (long long)found->iterations, x->residual,
           gn_now() - found->start);
}

/* --- the command --- */

static gneiss_status solve(const gn_options *options, gn_run *run, outcome *found,
                           gneiss_error *error) {
    gneiss_error reason = {0};
    gneiss_status status = gn_network_stiffness(&run->world, &found->network, &reason);
    if (status != GNEISS_OK)
        return gn_fail(error, status, "%.1000s: %.1000s", options->target, reason.message);
    found->solutions = found->network.solutions;
    found->iterations = found->network.iterations;
    return find_test(run, found, error);
}

gneiss_status gn_command_stiffness(const gn_options *options, gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    GN_FREED gn_run *run = NULL;
    GN_FREED outcome *found = NULL;
    GN_TRY(gn_new(&run, 1, "a run", error));
    GN_TRY(gn_new(&found, 1, "elastic constants", error));
    found->start = gn_now();
    GN_TRY(read_strain(options, &found->strain, error));
    GN_TRY(load_scene(options, &scene, error));
    GN_TRY(gn_run_create(scene, run, error));
    gneiss_status status = solve(options, run, found, error);
    if (status == GNEISS_OK && options->json)
        status = print_json(options, &run->world.ctx.scene, found, error);
    else if (status == GNEISS_OK)
        print_text(&run->world.ctx.scene, found);
    if (status == GNEISS_OK && !options->quiet) note_unseated(found);
    gn_run_free(run);
    return status;
}
