#include "run/history_rows.h"

#include "base/new.h"
#include "base/timer.h"
#include "base/vec3.h"
#include "laboratory/ends.h"
#include "run/quantities.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --- columns --- */

/* Adds columns, in the order in which put_row fills them. */
static gneiss_status add_columns(const gn_world *world, const gn_quantity_place *at,
                                 gn_history *history, gneiss_error *error) {
    const gn_quantity *q = at->quantity;
    const char *kind = at->group->kind;
    gn_shape_component part[GN_SHAPE_MOST];
    size_t parts = gn_shape_components(q->shape, (int)world->ctx.scene.dimension, part);
    for (size_t c = 0; c < parts; c++) {
        char name[GN_COLUMN_NAME_SIZE];
        snprintf(name, sizeof name, "%s%s%s%s%s%s", kind ? kind : "", kind ? "_" : "",
                 kind ? at->group->owner(world, at->owner) : "", kind ? "_" : "", q->name,
                 part[c].suffix);
        GN_TRY(gn_history_add_column(history, name, q->unit, q->text, error));
        history->columns[history->column_count - 1].absent = q->absent && q->absent(world);
    }
    return GNEISS_OK;
}

gneiss_status gn_history_create_columns(const gn_world *world, gn_history *history,
                                        gneiss_error *error) {
    gn_quantity_place at = {0};
    *history = (gn_history){0};
    while (gn_quantity_next(world, &at)) GN_TRY(add_columns(world, &at, history, error));
    return GNEISS_OK;
}

/* --- rows --- */

/* Writes the quantities of one instant to their columns of a row. */
static void put_row(const gn_world *world, gn_instant instant, double *row) {
    gn_quantity_place at = {0};
    gn_ranks_whole(world->ctx.ranks);
    while (gn_quantity_next(world, &at)) {
        const gn_quantity *q = at.quantity;
        gn_shape_component part[GN_SHAPE_MOST];
        size_t parts = gn_shape_components(q->shape, (int)world->ctx.scene.dimension, part);
        double value[9];
        if (q->instant == instant) {
            q->read(world, at.owner, value);
            gn_shape_take(value, part, parts, row);
        }
        row += parts;
    }
}

static double largest(const double x[3]) {
    return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

/* Returns the largest coordinate at the start, m. If the model is far from the origin, rounding of
 * positions is relative to this coordinate and not to the extent. */
static double largest_coordinate(const gn_world *world) {
    double most = fmax(largest(world->ctx.lower), largest(world->ctx.upper));
    double lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};
    gn_elements_extent(&world->solids, lower, upper);
    return fmax(most, fmax(largest(lower), largest(upper)));
}

/* Returns a generous bound of the energy that rounding of coordinates produces. A scene at rest has
 * no other energy (touching particles of a hexagonal lattice overlap by an ulp), and a residual
 * relative to such energy would be meaningless. With d = eps X, the ulp of the largest coordinate
 * X, the bound has three parts. (1) A constant: all mass moves by 100 d in a step. (2) A part that
 * grows with the number of steps: every step rounds each coordinate by d^2/12 in the mean square,
 * independently of the force, so that a spring k stores k d^2/24 more. In a stable step k of a
 * coordinate is below 4 m/dt^2, so that three coordinates gain at most m (d/dt)^2/2 in every step
 * (measured: a third of that). This should be a hundredth of the bound, which therefore grows by 50
 * m (d/dt)^2 in a step, 1/200 of the first part. For 5 cm at 20 ns the bound is that of the mass
 * moving at 5e-8 m/s, and after a million steps at 4e-6 m/s, far below the effect of any load. (3)
 * Creep under gravity: a particle at rest under its weight creeps by less than half an ulp in a
 * step, at a velocity with which gravity does work but which changes no coordinate: at most m g d/2
 * in every step (measured: a quarter of that), which should also be a hundredth of the bound. */
static double rounding_of(const gn_world *world, double mass, double coordinate) {
    const double d = DBL_EPSILON * coordinate, speed = 100.0 * d / world->ctx.dt,
                 *g = world->ctx.scene.gravity;
    const double steps = (double)world->ctx.step, weight = mass * sqrt(gn_dot3(g, g));
    return mass * speed * speed * (1.0 + steps / 200.0) + 50.0 * weight * d * steps;
}

/* Returns the bound for particles, elements and bodies; bodies may lie anywhere and travel far. */
static double rounding_energy(const gn_world *world) {
    double sum =
        rounding_of(world, gn_world_mass(&world->dem, &world->solids) + world->dem.raised.added,
                    largest_coordinate(world));
    for (size_t k = 0; k < world->ctx.scene.body_count; k++) {
        const gn_rigid *b = &world->boundary.bodies[k];
        sum += rounding_of(world, b->mass, largest(b->position) + b->reach);
    }
    return sum;
}

/* Reads the ledger and the scale of its residual, which never decreases. Elements are included in
 * the reading only. */
static void read_passed(gn_world *world) {
    double passed = fmax(gn_energy_throughput(&world->ledger.reading), rounding_energy(world));
    world->ledger.reading.passed = fmax(world->ledger.energy.passed, passed);
}

static void note_passed(gn_world *world) {
    read_passed(world);
    world->ledger.energy.passed = world->ledger.reading.passed;
}

/* Marks the columns that have no value in this row. */
static void note_absent(const gn_world *world, gn_history *history) {
    gn_quantity_place at = {0};
    gn_column *column = history->columns;
    while (gn_quantity_next(world, &at)) {
        gn_shape_component part[GN_SHAPE_MOST];
        const size_t parts =
            gn_shape_components(at.quantity->shape, (int)world->ctx.scene.dimension, part);
        const bool absent = at.quantity->absent && at.quantity->absent(world);
        for (size_t c = 0; c < parts; c++, column++) column->absent = column->absent || absent;
    }
}

/* Refuses the first row that has a value that is not finite. */
static gneiss_status check_row(const gn_world *world, gn_history *history, const double *row,
                               gneiss_error *error) {
    note_absent(world, history);
    for (size_t c = 0; c < history->column_count; c++)
        if (!history->columns[c].absent && !isfinite(row[c]))
            return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                           "step %.0f, t = %g s: history column %s: expected a finite number, "
                           "found %g",
                           row[0], row[1], history->columns[c].name, row[c]);
    return GNEISS_OK;
}

/* Takes a step with a row; with `last`, a run that is continued later must not depend on the row.
 */
static gneiss_status step_with_row(gn_world *world, gn_history *history, bool last,
                                   gneiss_error *error) {
    double start = gn_now();
    double *row = calloc(history->column_count + 1, sizeof *row);
    if (!row) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a history row");
    put_row(world, GN_BEFORE_STEP, row);
    world->ctx.seconds[GN_PHASE_measure] += gn_now() - start;
    gneiss_status status = gn_world_step(world, true, error);
    start = gn_now();
    if (status == GNEISS_OK) {
        (last ? read_passed : note_passed)(world);
        put_row(world, GN_AFTER_STEP, row);
        status = check_row(world, history, row, error);
        if (status == GNEISS_OK) status = gn_history_append(history, row, error);
        if (!last) gn_flow_row(&world->ctx, &world->dem);
    }
    free(row);
    world->ctx.seconds[GN_PHASE_measure] += gn_now() - start;
    return status;
}

gneiss_status gn_history_record_step(gn_world *world, gn_history *history, gneiss_error *error) {
    return step_with_row(world, history, false, error);
}

gneiss_status gn_history_record_last_step(gn_world *world, gn_history *history,
                                          gneiss_error *error) {
    if (history) return step_with_row(world, history, true, error);
    GN_TRY(gn_world_step(world, true, error));
    read_passed(world);
    return GNEISS_OK;
}

gneiss_status gn_history_record_state(gn_world *world, gn_history *history, gneiss_error *error) {
    GN_FREED double *row = NULL;
    GN_TRY(gn_new(&row, history->column_count, "columns of the history", error));
    note_passed(world);
    gn_ends_note_contact(&world->ctx, &world->dem, &world->boundary, &world->solids,
                         &world->approach, true);
    put_row(world, GN_BEFORE_STEP, row);
    put_row(world, GN_AFTER_STEP, row);
    GN_TRY(check_row(world, history, row, error));
    return gn_history_append(history, row, error);
}
