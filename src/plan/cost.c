#include "plan/cost.h"

#include "base/memory.h"
#include "base/timer.h"
#include "run/history_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Particles of a lattice: as many as the scene has, as what does not fit into a cache is slower,
 * but not so many that setting it up takes long. */
static const double lattice_least = 200.0, lattice_most = 20000.0;

typedef struct timed {
    double step, row; /* s of a processor */
    double particles, contacts, elements;
} timed;

/* --- what is timed --- */

/* Plain ends, so that the history has what it has of a test. */
static void put_ends(gn_scene *s, gn_wall_def wall[2], char names[2][GN_NAME_SIZE],
                     const double upper[3]) {
    int axis = (int)s->dimension - 1;
    for (int k = 0; k < 2; k++) {
        wall[k] = (gn_wall_def){.stiffness = 1e6, .passive = true};
        snprintf(wall[k].name, sizeof wall[k].name, "%s", k ? "upper" : "lower");
        snprintf(names[k], GN_NAME_SIZE, "%s", wall[k].name);
        wall[k].normal[axis] = k ? -1.0 : 1.0;
        wall[k].point[axis] = k ? upper[axis] : 0.0;
    }
    s->walls = wall;
    s->wall_count = 2;
    s->test = (gn_test){.kind = GN_TEST_COMPRESSION,
                        .axis = axis,
                        .lower = {.count = 1, .name = names},
                        .upper = {.count = 1, .name = names + 1},
                        .centre = s->test.centre,
                        .normal = -1};
}

/* Nothing but what a step costs is left of the scene; `s` borrows from it. */
static void strip(gn_scene *s, bool mixed) {
    s->has_origin = s->has_periodic = s->has_domain = s->has_mass_scaling = false;
    s->has_membrane = s->has_couple = s->has_pulse = false;
    s->stage_count = 0;
    memset(s->gravity, 0, sizeof s->gravity);
    s->random_velocity = 0.0;
    s->set_count = s->wall_count = s->body_count = 0;
    s->start = GN_START_REST;
    s->start_fraction = 0.9;
    s->step = s->scaled_step = s->scaled_factor = 0.0;
    s->estimate = GN_STEP_BOUND;
    s->threads = 1; /* waiting for each other is no work */
    s->stop_peak_drop = s->stop_strain = s->stop_unbalanced = 0.0;
    s->precision = mixed ? GN_PRECISION_MIXED : GN_PRECISION_DOUBLE;
}

/* `close`: as many neighbours as there can be, else half of that. */
static void put_lattice(const gn_dem *dem, bool close, gn_scene *s, double upper[3]) {
    const gn_particles *q = &dem->particles;
    double count = fmin(fmax((double)q->soa.count, lattice_least), lattice_most), radius = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) radius += q->pos[4 * p + 3] / (double)q->soa.count;
    bool space = s->dimension == 3;
    double each = space ? (close ? 4.0 : 1.0) : (close ? 2.0 : 1.0);
    double edge = 2.0 * radius * (space && close ? sqrt(2.0) : 1.0);
    int64_t cells = (int64_t)ceil(space ? cbrt(count / each) : sqrt(count / each));
    s->specimen.file[0] = s->specimen.path[0] = 0;
    s->specimen.from[0] = s->specimen.from_path[0] = 0;
    s->specimen.particle_count = s->specimen.packed_count = 0;
    s->specimen.pack = (gn_pack_def){.shape = GN_SHAPE_NONE};
    s->specimen.scale = 1.0;
    s->specimen.scale_given = false;
    s->specimen.density_basis = GN_DENSITY_PARTICLE;
    s->specimen.lattice = (gn_lattice){
        .kind = space ? (close ? GN_LATTICE_FCC : GN_LATTICE_CUBIC)
                      : (close ? GN_LATTICE_HEXAGONAL : GN_LATTICE_SQUARE),
        .radius = radius,
        .cells = {cells, cells, cells},
        .spacing = 1.0,
    };
    for (int a = 0; a < 3; a++)
        upper[a] = (double)cells * edge * (a == 1 && close && !space ? sqrt(3.0) : 1.0);
}

/* A rectangle or a box of as many elements. */
static void put_grid(const gn_solids *solids, gn_scene *s) {
    gn_element_def *e = &s->elements;
    bool space = s->dimension == 3;
    double count =
        fmin(fmax((double)gn_elements_totals(solids).elements, lattice_least), lattice_most);
    int64_t cells = (int64_t)ceil(space ? cbrt(count / 6.0) : sqrt(count / 2.0));
    e->mesh[0] = e->mesh_path[0] = 0;
    e->has_beam = false;
    e->has_rectangle = !space;
    e->has_box = space;
    e->distortion = 0.0;
    e->motion_count = e->load_count = 0;
    e->has_contact = false;
    e->material_count = 1; /* the first is for all elements, or for some that the grid has not */
    for (int a = 0; a < 3; a++) {
        e->size[a] = a < s->dimension ? 1.0 : 0.0;
        e->origin[a] = 0.0;
        e->cells[a] = a < s->dimension ? cells : 1;
    }
}

/* --- timing --- */

/* The median of a few short spells: what others do to the machine comes in bursts. */
static int by_size(const void *a, const void *b) {
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

enum { SPELLS = 9, WARM_UP = 20 };

static gneiss_status take_steps(gn_world *w, gn_history *h, int count, gneiss_error *error) {
    for (int k = 0; k < count; k++) {
        if (h)
            GN_TRY(gn_history_step(w, h, error));
        else
            GN_TRY(gn_world_step(w, false, error));
    }
    return GNEISS_OK;
}

/* Each spell takes `spell` seconds. */
static gneiss_status time_spells(gn_world *w, gn_history *h, double spell, double *seconds,
                                 gneiss_error *error) {
    double each[SPELLS], start = gn_process_time();
    GN_TRY(take_steps(w, h, WARM_UP, error));
    double once = (gn_process_time() - start) / WARM_UP;
    int steps = (int)fmin(fmax(spell / once, 2.0), 1e6);
    for (int k = 0; k < SPELLS; k++) {
        start = gn_process_time();
        GN_TRY(take_steps(w, h, steps, error));
        each[k] = (gn_process_time() - start) / steps;
    }
    qsort(each, SPELLS, sizeof *each, by_size);
    *seconds = each[SPELLS / 2];
    return GNEISS_OK;
}

static gneiss_status time_world(gn_world *w, timed *found, gneiss_error *error) {
    gn_history history;
    double with_row = 0.0;
    GN_TRY(gn_history_begin(w, &history, error));
    gneiss_status status = time_spells(w, NULL, 5e-3, &found->step, error);
    if (status == GNEISS_OK) status = time_spells(w, &history, 2e-3, &with_row, error);
    gn_history_free(&history);
    found->row = fmax(0.0, with_row - found->step);
    found->particles = (double)w->dem.particles.soa.count;
    found->contacts = (double)(w->dem.bonds.soa.count + w->dem.pairs.soa.count);
    found->elements = (double)gn_elements_totals(&w->solids).elements;
    return status;
}

/* The stripped scene goes through its text, so that it shares nothing with the one that it is of.
 */
static gneiss_status time_scene(const gn_scene *s, timed *found, gneiss_error *error) {
    char *text = gn_scene_write(s);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the scene text");
    gn_scene *own = gn_alloc(sizeof *own);
    gn_world *w = gn_alloc(sizeof *w);
    gneiss_status status = own && w ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    if (status == GNEISS_OK) status = gn_scene_parse_saved(text, "lattice", NULL, 0, own, error);
    free(text);
    if (status == GNEISS_OK) status = gn_world_create(own, w, error);
    if (status == GNEISS_OK) {
        status = time_world(w, found, error);
        gn_world_free(w);
    }
    gn_free(w);
    gn_free(own);
    return status;
}

static gneiss_status time_lattice(const gn_step_context *ctx, const gn_dem *dem, bool mixed,
                                  bool close, timed *found, gneiss_error *error) {
    gn_scene *s = gn_alloc(sizeof *s);
    gn_wall_def wall[2];
    char names[2][GN_NAME_SIZE];
    double upper[3];
    if (!s) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    *s = ctx->given;
    strip(s, mixed);
    s->end = 1e13 * ctx->dt; /* never */
    s->has_elements = false;
    put_lattice(dem, close, s, upper);
    put_ends(s, wall, names, upper);
    gneiss_status status = time_scene(s, found, error);
    gn_free(s);
    return status;
}

static gneiss_status time_grid(const gn_step_context *ctx, const gn_solids *solids, bool mixed,
                               timed *found, gneiss_error *error) {
    gn_scene *s = gn_alloc(sizeof *s);
    gn_element_material material;
    if (!s) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    *s = ctx->given;
    strip(s, mixed);
    s->end = 1e13 * ctx->dt; /* never */
    s->has_specimen = false;
    s->test = (gn_test){.kind = GN_TEST_NONE};
    put_grid(solids, s);
    material = s->elements.materials[0];
    material.group[0] = 0;
    s->elements.materials = &material;
    gneiss_status status = time_scene(s, found, error);
    gn_free(s);
    return status;
}

/* Two lattices with different numbers of neighbours tell particles and contacts apart; where noise
 * makes one of them cost nothing, the other costs all. */
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
