/* One step: the sweep, sums in block order, and what stops a run. */
#include "fem/parts.h"

#include <math.h>

/* --- merging, in block order --- */

static gn_element_sums merge_elements(const gn_fem_body *body) {
    gn_element_sums total = GN_ELEMENT_SUMS_ZERO;
    for (size_t b = 0; b < body->partials.blocks; b++) {
        const gn_element_sums *s = &body->element_sums[b];
        total.elastic += s->elastic;
        total.volume += s->volume;
        for (int k = 0; k < 9; k++) total.stress[k] += s->stress[k];
        if (s->least >= total.least) continue;
        total.least = s->least;
        total.element = s->element;
    }
    return total;
}

static gn_pressure_sums merge_pressure(const gn_fem_body *body) {
    gn_pressure_sums total = {0};
    for (size_t b = 0; body->pressure_sums && b < body->motion_blocks; b++) {
        total.elastic += body->pressure_sums[b].elastic;
        total.damping += body->pressure_sums[b].damping;
    }
    return total;
}

/* The first halves of the works close the interval that led here, the second ones are of the coming
 * interval; the reading lies between them. */
static int64_t merge_motion(gn_fem_body *body, bool measure, double *speed2) {
    gn_fem_energy *e = &body->energy;
    double kinetic = 0.0;
    *speed2 = 0.0;
    int64_t bad = -1;
    const gn_pressure_sums pressure = merge_pressure(body);
    e->damping += pressure.damping;
    for (int half = 0; half < 2; half++) {
        for (size_t b = 0; b < body->motion_blocks; b++) {
            const gn_motion_sums *s = &body->motion_sums[b];
            e->damping += s->damping[half];
            e->work_gravity += s->gravity[half];
            e->work_applied += s->applied[half];
            e->work_prescribed += s->prescribed[half];
            if (half == 0) kinetic += s->kinetic;
            if (bad < 0) bad = s->bad;
            *speed2 = fmax(*speed2, s->speed2);
        }
        if (half || !measure) continue;
        body->elastic = merge_elements(body);
        body->elastic.elastic += pressure.elastic;
        e->kinetic = kinetic;
        e->elastic = body->elastic.elastic;
        if (body->step == 0) e->stored_at_start = e->kinetic + e->elastic;
        body->reading = *e;
    }
    return bad;
}

double gn_fem_energy_residual(const gn_fem_energy *e) {
    return e->kinetic + e->elastic - e->stored_at_start -
           (e->work_prescribed + e->work_applied + e->work_gravity) + e->damping;
}

/* --- going bad --- */

static gneiss_status inside_out(const gn_fem_body *body, gneiss_error *error) {
    const gn_elements *q = &body->elements;
    size_t e = (size_t)body->elastic.element;
    double centre[3] = {0.0};
    char at[GN_POINT_SIZE];
    for (int a = 0; a <= body->dimension; a++)
        for (int k = 0; k < 3; k++)
            centre[k] += body->nodes.start[4 * (size_t)gn_elements_node(q, a)[e] + (size_t)k] /
                         (body->dimension + 1);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "%s: step %lld, t = %g s: %s %d (base 0), at the start at %s m, is turned inside "
        "out: det F = %g",
        body->name, (long long)body->step, body->time, gn_fem_kind(body->dimension), q->id[e],
        gn_point_text(body->origin, centre, at), body->elastic.least);
}

static gneiss_status not_finite(const gn_fem_body *body, size_t node, gneiss_error *error) {
    char at[GN_POINT_SIZE];
    gn_point_text(body->origin, body->nodes.start + 4 * node, at);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "%s: step %lld, t = %g s: node %d (base 0), at the start at %s m, has a velocity "
        "that is not finite",
        body->name, (long long)body->step, body->time, body->nodes.id[node], at);
}

void gn_fem_forces(gn_fem_body *body, double dt, bool measure) {
    body->measured =
        measure || body->step % GN_FEM_CHECK_EVERY == 0 || body->path > 0.1 * body->height;
    gn_fem_sweep(body, dt, body->measured);
}

gneiss_status gn_fem_step(gn_fem_body *body, double dt, bool measure, gneiss_error *error) {
    gn_fem_forces(body, dt, measure);
    return gn_fem_move(body, dt, error);
}

gneiss_status gn_fem_move(gn_fem_body *body, double dt, gneiss_error *error) {
    const bool measure = body->measured;
    double speed2;
    gn_fem_sweep_held(body, dt, measure);
    int64_t bad = merge_motion(body, measure, &speed2);
    if (measure && body->elastic.least <= 0.0) return inside_out(body, error);
    if (bad >= 0) return not_finite(body, (size_t)bad, error);
    body->path = (measure ? 0.0 : body->path) + dt * sqrt(speed2);
    body->dt_past = dt;
    body->time += dt;
    body->step++;
    return GNEISS_OK;
}
