#include "plan/cost.h"

#include "base/new.h"
#include "base/sort.h"
#include "base/timer.h"
#include "run/history_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bounds of the number of particles in the timed lattice. It is that of the scene, because data
 * beyond the cache are slower, but within these bounds, which keep the set-up short. */
static const double lattice_least = 200.0, lattice_most = 20000.0;

typedef struct timed {
    double step, row; /* s of processor time */
    double particles, contacts, elements;
} timed;

/* --- timed scenes --- */

/* Adds plain ends, so that the history has the columns of a test. */
static void put_ends(gn_scene *scene, gn_wall_def wall[2], char names[2][GN_NAME_SIZE],
                     const double upper[3]) {
    int axis = (int)scene->dimension - 1;
    for (int k = 0; k < 2; k++) {
        wall[k] = (gn_wall_def){.stiffness = 1e6, .passive = true};
        snprintf(wall[k].name, sizeof wall[k].name, "%s", k ? "upper" : "lower");
        snprintf(names[k], GN_NAME_SIZE, "%s", wall[k].name);
        wall[k].normal[axis] = k ? -1.0 : 1.0;
        wall[k].point[axis] = k ? upper[axis] : 0.0;
    }
    scene->walls = wall;
    scene->wall_count = 2;
    scene->test = (gn_test){.kind = GN_TEST_COMPRESSION,
                            .axis = axis,
                            .lower = {.count = 1, .name = names},
                            .upper = {.count = 1, .name = names + 1},
                            .centre = scene->test.centre,
                            .blocks = scene->test.blocks,
                            .normal = -1};
}

/* Removes parts of the scene that do not affect the cost of a step; the result borrows from it. */
static void strip(gn_scene *scene, bool mixed) {
    scene->has_origin = scene->has_periodic = scene->has_domain = scene->has_mass_scaling = false;
    scene->has_membrane = scene->has_couple = scene->has_pulse = false;
    scene->stage_count = 0;
    memset(scene->gravity, 0, sizeof scene->gravity);
    memset(scene->gravity_over_time, 0, sizeof scene->gravity_over_time);
    scene->loads_vary = false;
    scene->formulas = NULL;
    scene->random_velocity = 0.0;
    scene->set_count = scene->wall_count = scene->body_count = 0;
    scene->start = GN_START_REST;
    scene->start_fraction = 0.9;
    scene->step = scene->scaled_step = scene->scaled_factor = 0.0;
    scene->estimate = GN_STEP_BOUND;
    scene->threads = 1; /* times that threads wait are not counted */
    scene->stop_peak_drop = scene->stop_strain = scene->stop_unbalanced = 0.0;
    scene->precision = mixed ? GN_PRECISION_MIXED : GN_PRECISION_DOUBLE;
}

/* Adds a lattice; `close`: with the largest number of neighbours, else with half of it. */
static void put_lattice(const gn_dem *dem, bool close, gn_scene *scene, double upper[3]) {
    const gn_particles *q = &dem->particles;
    double count = fmin(fmax((double)q->soa.count, lattice_least), lattice_most), radius = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) radius += q->pos[4 * p + 3] / (double)q->soa.count;
    bool space = scene->dimension == 3;
    double each = space ? (close ? 4.0 : 1.0) : (close ? 2.0 : 1.0);
    double edge = 2.0 * radius * (space && close ? sqrt(2.0) : 1.0);
    int64_t cells = (int64_t)ceil(space ? cbrt(count / each) : sqrt(count / each));
    scene->specimen.file[0] = scene->specimen.path[0] = 0;
    scene->specimen.from[0] = scene->specimen.from_path[0] = 0;
    scene->specimen.particle_count = scene->specimen.packed_count = 0;
    scene->specimen.pack = (gn_pack_def){.shape = GN_SHAPE_NONE};
    scene->specimen.scale = 1.0;
    scene->specimen.scale_given = false;
    scene->specimen.density_basis = GN_DENSITY_PARTICLE;
    scene->specimen.lattice = (gn_lattice){
        .kind = space ? (close ? GN_LATTICE_FCC : GN_LATTICE_CUBIC)
                      : (close ? GN_LATTICE_HEXAGONAL : GN_LATTICE_SQUARE),
        .radius = radius,
        .cells = {cells, cells, cells},
        .spacing = 1.0,
    };
    for (int a = 0; a < 3; a++)
        upper[a] = (double)cells * edge * (a == 1 && close && !space ? sqrt(3.0) : 1.0);
}

/* Makes a rectangle or box with the same number of elements. */
static void put_grid(const gn_solids *solids, gn_scene *scene) {
    gn_element_def *elements = &scene->elements;
    bool space = scene->dimension == 3;
    double count =
        fmin(fmax((double)gn_elements_totals(solids).elements, lattice_least), lattice_most);
    int64_t cells = (int64_t)ceil(space ? cbrt(count / 6.0) : sqrt(count / 2.0));
    elements->mesh[0] = elements->mesh_path[0] = 0;
    elements->has_beam = false;
    elements->has_rectangle = !space;
    elements->has_box = space;
    elements->distortion = 0.0;
    elements->motion_count = elements->load_count = 0;
    elements->has_contact = false;
    elements->material_count =
        1; /* the first material applies to all elements, or to a group that the grid lacks */
    for (int a = 0; a < 3; a++) {
        elements->size[a] = a < scene->dimension ? 1.0 : 0.0;
        elements->origin[a] = 0.0;
        elements->cells[a] = a < scene->dimension ? cells : 1;
    }
}

/* --- timing --- */

/* Takes the median of a few short intervals, because disturbances on the machine come in bursts. */
enum { SPELLS = 9, WARM_UP = 20 };

static gneiss_status take_steps(gn_world *world, gn_history *history, int count,
                                gneiss_error *error) {
    for (int k = 0; k < count; k++) {
        if (history)
            GN_TRY(gn_history_record_step(world, history, error));
        else
            GN_TRY(gn_world_step(world, false, error));
    }
    return GNEISS_OK;
}

/* Measures intervals of `spell` seconds each. */
static gneiss_status time_spells(gn_world *world, gn_history *history, double spell,
                                 double *seconds, gneiss_error *error) {
    double each[SPELLS], start = gn_process_time();
    GN_TRY(take_steps(world, history, WARM_UP, error));
    double once = (gn_process_time() - start) / WARM_UP;
    int steps = (int)fmin(fmax(spell / once, 2.0), 1e6);
    for (int k = 0; k < SPELLS; k++) {
        start = gn_process_time();
        GN_TRY(take_steps(world, history, steps, error));
        each[k] = (gn_process_time() - start) / steps;
    }
    gn_sort_numbers(each, SPELLS);
    *seconds = each[SPELLS / 2];
    return GNEISS_OK;
}

static gneiss_status time_world(gn_world *world, timed *found, gneiss_error *error) {
    gn_history history;
    double with_row = 0.0;
    GN_TRY(gn_history_create_columns(world, &history, error));
    gneiss_status status = time_spells(world, NULL, 5e-3, &found->step, error);
    if (status == GNEISS_OK) status = time_spells(world, &history, 2e-3, &with_row, error);
    gn_history_free(&history);
    found->row = fmax(0.0, with_row - found->step);
    found->particles = (double)world->dem.particles.soa.count;
    found->contacts = (double)gn_lists_count(&world->dem);
    found->elements = (double)gn_elements_totals(&world->solids).elements;
    return status;
}

/* The stripped scene is written and read as text, so that it shares nothing with the original. */
static gneiss_status time_scene(const gn_scene *scene, timed *found, gneiss_error *error) {
    GN_FREED char *text = gn_scene_write(scene);
    GN_FREED gn_scene *own = NULL;
    GN_FREED_BY(gn_world_delete) gn_world *world = NULL;
    if (!text) return gn_no_memory(error, "the text of the scene");
    GN_TRY(gn_new(&own, 1, "a scene", error));
    GN_TRY(gn_new(&world, 1, "a model", error));
    GN_TRY(gn_scene_parse_saved(text, "lattice", NULL, 0, own, error));
    GN_TRY(gn_world_create(own, world, error));
    return time_world(world, found, error);
}

static gneiss_status time_lattice(const gn_step_context *ctx, const gn_dem *dem, bool mixed,
                                  bool close, timed *found, gneiss_error *error) {
    GN_FREED gn_scene *scene = NULL;
    gn_wall_def wall[2];
    char names[2][GN_NAME_SIZE];
    double upper[3];
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    *scene = ctx->given;
    strip(scene, mixed);
    scene->end = 1e13 * ctx->dt; /* beyond any trial */
    scene->has_elements = false;
    put_lattice(dem, close, scene, upper);
    put_ends(scene, wall, names, upper);
    return time_scene(scene, found, error);
}

static gneiss_status time_grid(const gn_step_context *ctx, const gn_solids *solids, bool mixed,
                               timed *found, gneiss_error *error) {
    GN_FREED gn_scene *scene = NULL;
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    *scene = ctx->given;
    strip(scene, mixed);
    scene->end = 1e13 * ctx->dt; /* beyond any trial */
    scene->has_specimen = false;
    scene->test = (gn_test){.kind = GN_TEST_NONE};
    put_grid(solids, scene);
    gn_element_material material = scene->elements.materials[0];
    material.group[0] = 0;
    scene->elements.materials = &material;
    return time_scene(scene, found, error);
}

/* Attributes the cost of a step to particles and contacts by two lattices with different numbers of
 * neighbours; if by noise one of them would be zero or negative, the whole cost is attributed to
 * the other. */
static void divide(const timed *few, const timed *many, gn_cost *cost) {
    double p = few->particles, c = few->contacts, q = many->particles, d = many->contacts;
    double determinant = p * d - q * c;
    cost->particle = (few->step * d - many->step * c) / determinant;
    cost->contact = (many->step * p - few->step * q) / determinant;
    if (!(cost->contact > 0.0)) {
        cost->contact = 0.0;
        cost->particle = 0.5 * (few->step / p + many->step / q);
    } else if (!(cost->particle > 0.0)) {
        cost->particle = 0.0;
        cost->contact = 0.5 * (few->step / c + many->step / d);
    }
    cost->row = 0.5 * (few->row / p + many->row / q);
}

gneiss_status gn_cost_measure(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_solids *solids, bool mixed, gn_cost *cost,
                              gneiss_error *error) {
    timed few, many;
    *cost = (gn_cost){0};
    if (!ctx->scene.has_specimen) {
        GN_TRY(time_grid(ctx, solids, mixed, &many, error));
        cost->element = many.step / many.elements;
        cost->row = many.row / many.elements;
        return GNEISS_OK;
    }
    GN_TRY(time_lattice(ctx, dem, mixed, false, &few, error));
    GN_TRY(time_lattice(ctx, dem, mixed, true, &many, error));
    divide(&few, &many, cost);
    return GNEISS_OK;
}
