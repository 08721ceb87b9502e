/* One step: the sweep, sums in block order, and checks of the state. */
#include "fem/internal.h"

#include <math.h>

/* --- merging, in block order --- */

static gn_element_sums merge_elements(const gn_fem_solid *solid) {
    gn_element_sums total = GN_ELEMENT_SUMS_ZERO;
    for (size_t b = 0; b < solid->partials.blocks; b++) {
        const gn_element_sums *s = &solid->element_sums[b];
        total.elastic += s->elastic;
        total.volume += s->volume;
        for (int k = 0; k < 9; k++) total.stress[k] += s->stress[k];
        if (s->least >= total.least) continue;
        total.least = s->least;
        total.element = s->element;
    }
    return total;
}

static gn_pressure_sums merge_pressure(const gn_fem_solid *solid) {
    gn_pressure_sums total = {0};
    for (size_t b = 0; solid->pressure_sums && b < solid->motion_blocks; b++) {
        total.elastic += solid->pressure_sums[b].elastic;
        total.damping += solid->pressure_sums[b].damping;
    }
    return total;
}

/* Merges the sums of motion. The first halves of the works belong to the past interval, the second
 * halves to the coming one; the reading lies between them. */
static int64_t merge_motion(gn_fem_solid *solid, bool measure, double *speed2) {
    gn_fem_energy *e = &solid->energy;
    double kinetic = 0.0;
    *speed2 = 0.0;
    int64_t bad = -1;
    const gn_pressure_sums pressure = merge_pressure(solid);
    e->damping += pressure.damping;
    for (int half = 0; half < 2; half++) {
        for (size_t b = 0; b < solid->motion_blocks; b++) {
            const gn_motion_sums *s = &solid->motion_sums[b];
            e->damping += s->damping[half];
            e->work_gravity += s->gravity[half];
            e->work_applied += s->applied[half];
            e->work_prescribed += s->prescribed[half];
            if (half == 0) kinetic += s->kinetic;
            if (bad < 0) bad = s->bad;
            *speed2 = fmax(*speed2, s->speed2);
        }
        if (half || !measure) continue;
        solid->elastic = merge_elements(solid);
        solid->elastic.elastic += pressure.elastic;
        e->kinetic = kinetic;
        e->elastic = solid->elastic.elastic;
        if (solid->step == 0) e->stored_at_start = e->kinetic + e->elastic;
        solid->reading = *e;
    }
    return bad;
}

double gn_fem_energy_residual(const gn_fem_energy *energy) {
    return energy->kinetic + energy->elastic - energy->stored_at_start -
           (energy->work_prescribed + energy->work_applied + energy->work_gravity) +
           energy->damping;
}

/* --- checks --- */

static gneiss_status inside_out(const gn_fem_solid *solid, gneiss_error *error) {
    const gn_elements *q = &solid->elements;
    size_t e = (size_t)solid->elastic.element;
    double centre[3] = {0.0};
    char at[GN_POINT_SIZE];
    for (int a = 0; a <= solid->dimension; a++)
        for (int k = 0; k < 3; k++)
            centre[k] += solid->nodes.start[4 * (size_t)gn_elements_node(q, a)[e] + (size_t)k] /
                         (solid->dimension + 1);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "%s: step %lld, t = %g s: %s %d (base 0), at the start at %s m, is turned inside "
        "out: det F = %g",
        solid->name, (long long)solid->step, solid->time, gn_fem_kind(solid->dimension), q->id[e],
        gn_point_text(solid->origin, centre, at), solid->elastic.least);
}

static gneiss_status not_finite(const gn_fem_solid *solid, size_t node, gneiss_error *error) {
    char at[GN_POINT_SIZE];
    gn_point_text(solid->origin, solid->nodes.start + 4 * node, at);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "%s: step %lld, t = %g s: node %d (base 0), at the start at %s m, has a velocity "
        "that is not finite",
        solid->name, (long long)solid->step, solid->time, solid->nodes.id[node], at);
}

void gn_fem_forces(gn_fem_solid *solid, double dt, bool measure) {
    solid->measured =
        measure || solid->step % GN_FEM_CHECK_EVERY == 0 || solid->path > 0.1 * solid->height;
    gn_fem_sweep(solid, dt, solid->measured);
}

gneiss_status gn_fem_step(gn_fem_solid *solid, double dt, bool measure, gneiss_error *error) {
    gn_fem_forces(solid, dt, measure);
    return gn_fem_move(solid, dt, error);
}

gneiss_status gn_fem_move(gn_fem_solid *solid, double dt, gneiss_error *error) {
    const bool measure = solid->measured;
    double speed2;
    gn_fem_sweep_held(solid, dt, measure);
    int64_t bad = merge_motion(solid, measure, &speed2);
    if (measure && solid->elastic.least <= 0.0) return inside_out(solid, error);
    if (bad >= 0) return not_finite(solid, (size_t)bad, error);
    solid->path = (measure ? 0.0 : solid->path) + dt * sqrt(speed2);
    solid->dt_past = dt;
    solid->time += dt;
    solid->step++;
    return GNEISS_OK;
}
