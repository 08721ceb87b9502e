#include "run/record_parts.h"

#include "base/memory.h"
#include "base/timer.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char axes[] = "xyz";
static const int components[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};

static bool in_plane(const gn_world *w, int component) {
    return w->effects & GN_FX_SPACE ||
           (components[component][0] < 2 && components[component][1] < 2);
}

/* --- columns
 * --------------------------------------------------------------------------------------- */

typedef struct fixed_column {
    const char *name, *unit, *text;
} fixed_column;

static gneiss_status add(gn_history *h, const fixed_column *columns, size_t count,
                         gneiss_error *error) {
    for (size_t k = 0; k < count; k++)
        GN_TRY(gn_history_add_column(h, columns[k].name, columns[k].unit, columns[k].text, error));
    return GNEISS_OK;
}

gneiss_status gn_record_add_tensor(const gn_world *w, gn_history *h, const char *what,
                                   const char *unit, const char *text, gneiss_error *error) {
    for (int c = 0; c < 6; c++) {
        char name[32];
        if (!in_plane(w, c)) continue;
        snprintf(name, sizeof name, "%s_%c%c", what, axes[components[c][0]],
                 axes[components[c][1]]);
        GN_TRY(gn_history_add_column(h, name, unit, text, error));
    }
    return GNEISS_OK;
}

gneiss_status gn_record_add_vector(const gn_world *w, gn_history *h, const char *kind,
                                   const char *owner, const char *what, const char *unit,
                                   const char *text, gneiss_error *error) {
    for (int a = 0; a < (int)w->scene.dimension; a++) {
        char name[GN_COLUMN_NAME_SIZE];
        snprintf(name, sizeof name, "%s_%s_%s_%c", kind, owner, what, axes[a]);
        GN_TRY(gn_history_add_column(h, name, unit, text, error));
    }
    return GNEISS_OK;
}

static bool set_moves(const gn_set_def *s) {
    size_t points = 0;
    for (int a = 0; a < 3; a++) points += s->motion.velocity[a].count + s->motion.spin[a].count;
    return points > 0;
}

/* In the plane moments have the one component z. */
static gneiss_status add_body(const gn_world *w, gn_history *h, size_t k, gneiss_error *error) {
    const char *name = w->scene.bodies[k].name;
    char column[GN_COLUMN_NAME_SIZE];
    GN_TRY(gn_record_add_vector(w, h, "body", name, "force", "N",
                                "force of the particles on the body", error));
    for (int a = w->scene.dimension == 3 ? 0 : 2; a < 3; a++) {
        snprintf(column, sizeof column, "body_%s_moment_%c", name, axes[a]);
        GN_TRY(gn_history_add_column(h, column, "N m",
                                     "their moment about the reference point of the body", error));
    }
    GN_TRY(gn_record_add_vector(w, h, "body", name, "displacement", "m",
                                "path of the reference point from its start", error));
    return gn_record_add_vector(w, h, "body", name, "velocity", "m/s",
                                "velocity of the reference point at the last half step", error);
}

static gneiss_status add_owners(const gn_world *w, gn_history *h, gneiss_error *error) {
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        const char *name = w->scene.walls[k].name;
        GN_TRY(gn_record_add_vector(w, h, "wall", name, "force", "N",
                                    "force of the particles on the wall", error));
        GN_TRY(gn_record_add_vector(w, h, "wall", name, "displacement", "m",
                                    "path of the wall from its start", error));
    }
    for (size_t k = 0; k < w->scene.body_count; k++) GN_TRY(add_body(w, h, k, error));
    for (size_t k = 0; k < w->scene.set_count; k++)
        if (set_moves(&w->scene.sets[k]))
            GN_TRY(gn_record_add_vector(w, h, "set", w->scene.sets[k].name, "reaction", "N",
                                        "force that the prescribed motion supplies to the set",
                                        error));
    return GNEISS_OK;
}

gneiss_status gn_record_create(const gn_world *w, gn_history *h, gneiss_error *error) {
    static const fixed_column first[] = {{"step", "1", "steps done"}, {"time", "s", "time"}};
    static const fixed_column test[] = {
        {"strain", "1",
         "change of the distance of the ends over the length, positive in the test's sense"},
        {"stress", "Pa", "mean of both ends' force over the area, positive in the test's sense"},
        {"stress_lower", "Pa", "force on the lower end over the area"},
        {"stress_upper", "Pa", "force on the upper end over the area"},
        {"force", "N", "mean of both ends' force, positive in the test's sense"},
        {"deflection", "m", "change of the distance of the ends, positive in the test's sense"}};
    static const fixed_column state[] = {
        {"unbalanced", "1", "mean resultant on a particle over the mean contact force"}};
    static const fixed_column bonds[] = {{"bonds_intact", "1", "intact bonds"},
                                         {"broken_tension", "1", "bonds broken in tension"},
                                         {"broken_shear", "1", "bonds broken in shear"},
                                         {"damage", "1", "broken bonds over bonds at the start"}};
    *h = (gn_history){0};
    GN_TRY(add(h, first, 2, error));
    if (w->scene.test.kind != GN_TEST_NONE) GN_TRY(add(h, test, sizeof test / sizeof *test, error));
    size_t strains = h->column_count;
    GN_TRY(gn_record_add_tensor(w, h, "strain", "1",
                                "average strain of the specimen, tension positive", error));
    /* Too few particles, or all on a plane, have no average strain. */
    for (size_t c = strains; c < h->column_count; c++)
        h->columns[c].absent = w->scene.has_specimen && !w->gauge.count;
    GN_TRY(gn_record_add_tensor(w, h, "stress", "Pa",
                                "average stress of the specimen, tension positive", error));
    GN_TRY(add(h, state, 1, error));
    if (w->effects & GN_FX_BONDS) GN_TRY(add(h, bonds, 4, error));
    if (w->effects & GN_FX_ENERGY) {
#define X(name, kind, text) GN_TRY(gn_history_add_column(h, "energy_" #name, "J", text, error));
        GN_ENERGY_TERMS(X)
#undef X
        GN_TRY(gn_history_add_column(
            h, "energy_residual", "1",
            "what the ledger does not explain, over the energy that has gone through", error));
    }
    GN_TRY(add_owners(w, h, error));
    return gn_elements_add_columns(w, h, error);
}

/* --- rows
 * ------------------------------------------------------------------------------------------ */

typedef struct before_step {
    double step, time, deflection, gradient[9];
} before_step;

/* `elements` as gn_elements_before_size wants it. */
static before_step read_positions(const gn_world *w, double *elements) {
    before_step b = {.step = (double)w->step, .time = w->time};
    if (w->scene.test.kind != GN_TEST_NONE) b.deflection = gn_record_deflection(w);
    gn_strain_gauge_read(&w->gauge, &w->particles, w->index_of_id, b.gradient);
    gn_elements_read_before(w, elements);
    if (w->elements && !w->scene.has_specimen) memcpy(b.gradient, elements, sizeof b.gradient);
    return b;
}

double *gn_record_put_tensor(const gn_world *w, double *row, const double t[9]) {
    for (int c = 0; c < 6; c++) {
        int a = components[c][0], b = components[c][1];
        if (in_plane(w, c)) *row++ = 0.5 * (t[3 * a + b] + t[3 * b + a]);
    }
    return row;
}

/* What a row shows of the positions before the step: paths of walls, then paths and velocities of
 * bodies. */
static size_t owner_values(const gn_world *w) {
    return 3 * w->scene.wall_count + 6 * w->scene.body_count;
}

static void read_owners(const gn_world *w, double *out) {
    for (size_t k = 0; k < w->scene.wall_count; k++)
        for (int a = 0; a < 3; a++) *out++ = w->walls[k].point[a] - w->walls[k].start[a];
    for (size_t k = 0; k < w->scene.body_count; k++) {
        const gn_rigid *b = &w->bodies[k];
        for (int a = 0; a < 3; a++) *out++ = b->position[a] - b->start[a];
        for (int a = 0; a < 3; a++) *out++ = b->velocity[a];
    }
}

static double *put_bodies(const gn_world *w, double *row, const double *before) {
    int dimension = (int)w->scene.dimension;
    for (size_t k = 0; k < w->scene.body_count; k++, before += 6) {
        const gn_rigid *b = &w->bodies[k];
        for (int a = 0; a < dimension; a++) *row++ = b->force[a];
        for (int a = dimension == 3 ? 0 : 2; a < 3; a++) *row++ = b->moment[a];
        for (int a = 0; a < dimension; a++) *row++ = before[a];
        for (int a = 0; a < dimension; a++) *row++ = before[3 + a];
    }
    return row;
}

static double *put_owners(const gn_world *w, double *row, const double *displacement) {
    int dimension = (int)w->scene.dimension;
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        for (int a = 0; a < dimension; a++) *row++ = w->walls[k].force[a];
        for (int a = 0; a < dimension; a++) *row++ = displacement[3 * k + (size_t)a];
    }
    row = put_bodies(w, row, displacement + 3 * w->scene.wall_count);
    for (size_t k = 0; k < w->scene.set_count; k++)
        for (int a = 0; set_moves(&w->scene.sets[k]) && a < dimension; a++)
            *row++ = w->set_reaction[6 * k + (size_t)a];
    return row;
}

static double *put_energy(const gn_world *w, double *row) {
    if (!(w->effects & GN_FX_ENERGY)) return row;
#define X(name, kind, text) *row++ = w->reading.name;
    GN_ENERGY_TERMS(X)
#undef X
    *row++ = gn_energy_residual(&w->reading);
    return row;
}

static void fill_row(const gn_world *w, const before_step *b, const double *displacement,
                     const double *elements, double *row) {
    *row++ = b->step;
    *row++ = b->time;
    if (w->scene.test.kind != GN_TEST_NONE) {
        double lower, upper;
        gn_record_end_forces(w, &lower, &upper);
        *row++ = b->deflection / w->test_length;
        double area = w->test_area;
        *row++ = 0.5 * (lower / area + upper / area);
        *row++ = lower / area;
        *row++ = upper / area;
        *row++ = 0.5 * (lower + upper);
        *row++ = b->deflection;
    }
    row = gn_record_put_tensor(w, row, b->gradient);
    row = gn_record_put_tensor(w, row, w->stress);
    *row++ = w->unbalanced;
    if (w->effects & GN_FX_BONDS) {
        double broken = (double)(w->broken_tension + w->broken_shear),
               all = (double)w->bonds_at_start;
        *row++ = all - broken;
        *row++ = (double)w->broken_tension;
        *row++ = (double)w->broken_shear;
        *row++ = all > 0.0 ? broken / all : 0.0;
    }
    row = put_energy(w, row);
    row = put_owners(w, row, displacement);
    gn_elements_put(w, elements, row);
}

/* Energy that the rounding of coordinates makes by itself, generously: all mass moving by a hundred
 * ulps of the extent in a step (1e-8 m/s in a specimen of 5 cm at 0.1 us). In a scene at rest there
 * is nothing else (touching particles of a hexagonal lattice press by an ulp), and a residual
 * relative to that would mean nothing. */
static double rounding_energy(const gn_world *w) {
    double extent = 0.0;
    for (int a = 0; a < (int)w->scene.dimension; a++)
        extent = fmax(extent, w->upper[a] - w->lower[a]);
    double speed = 100.0 * DBL_EPSILON * extent / w->dt;
    return gn_world_mass(w) * speed * speed;
}

/* The scale of the residual never falls. Elements are in the reading only. */
static void note_passed(gn_world *w) {
    double passed = fmax(gn_energy_passed(&w->reading), rounding_energy(w));
    w->energy.passed = w->reading.passed = fmax(w->energy.passed, passed);
}

/* What a row must not hold is found in the row in which it first stands. */
static gneiss_status check_row(const gn_history *h, const double *row, gneiss_error *error) {
    for (size_t c = 0; c < h->column_count; c++)
        if (!h->columns[c].absent && !isfinite(row[c]))
            return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                           "step %.0f, t = %g s: history column %s: expected a finite number, "
                           "found %g",
                           row[0], row[1], h->columns[c].name, row[c]);
    return GNEISS_OK;
}

gneiss_status gn_record_step(gn_world *w, gn_history *h, gneiss_error *error) {
    double start = gn_now();
    size_t owners = owner_values(w), elements = gn_elements_before_size(w);
    double *displacement = calloc(owners + elements + h->column_count + 1, sizeof *displacement);
    if (!displacement) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a history row");
    double *read = displacement + owners, *row = read + elements;
    before_step before = read_positions(w, read);
    read_owners(w, displacement);
    w->seconds[GN_PHASE_measure] += gn_now() - start;
    gneiss_status status = gn_world_step(w, true, error);
    start = gn_now();
    if (status == GNEISS_OK) {
        note_passed(w);
        fill_row(w, &before, displacement, read, row);
        status = check_row(h, row, error);
        if (status == GNEISS_OK) status = gn_history_append(h, row, error);
    }
    free(displacement);
    w->seconds[GN_PHASE_measure] += gn_now() - start;
    return status;
}

gn_readings gn_record_readings(const gn_world *w, const gn_history *h) {
    const gn_test *t = &w->scene.test;
    gn_readings r;
    gn_tested tested = {.dimension = (int)w->scene.dimension,
                        .axis = (int)t->axis,
                        .sign = t->kind == GN_TEST_COMPRESSION ? -1 : 1,
                        .elastic = !w->scene.has_specimen,
                        .watched = !gn_scene_end_drives(&w->scene, &t->lower) ||
                                   !gn_scene_end_drives(&w->scene, &t->upper)};
    gn_readings_compute(h, &tested, &r);
    /* A quotient by nothing is no reading either. */
#define X(name, unit, text)                                                                        \
    if (!isfinite(r.name)) r.name = NAN;
    GN_READINGS(X)
#undef X
    return r;
}
