/* One step: element forces into the blocks' partial sums, then, after a barrier, nodes. */
#include "base/timer.h"
#include "fem/parts.h"

#include <math.h>
#include <string.h>

typedef struct work {
    gn_fem_body *body;
    gn_dilation_args dilation;
    gn_element_args elements;
    gn_motion_args motion;
    bool measure;
} work;

static void dilation_block(const work *k, size_t block) {
    const gn_partials *q = &k->body->partials;
    size_t begin = block * q->length, end = begin + q->length;
    if (end > k->body->elements.soa.count) end = k->body->elements.soa.count;
    k->body->dilation_kernel(&k->dilation, begin, end);
}

static void element_block(const work *k, size_t block) {
    const gn_partials *q = &k->body->partials;
    size_t begin = block * q->length, end = begin + q->length;
    if (end > k->body->elements.soa.count) end = k->body->elements.soa.count;
    gn_element_sums *sums = &k->body->element_sums[block];
    *sums = GN_ELEMENT_SUMS_ZERO;
    k->body->element_kernel[k->measure](&k->elements, begin, end, sums);
}

static void node_block(const work *k, size_t block) {
    size_t begin = block * GN_PARTICLE_BLOCK, end = begin + GN_PARTICLE_BLOCK;
    if (end > k->body->nodes.soa.count) end = k->body->nodes.soa.count;
    gn_motion_sums *sums = &k->body->motion_sums[block];
    *sums = (gn_motion_sums){.bad = -1};
    k->body->motion_kernel(&k->motion, begin, end, sums);
    if (k->body->form == GN_FEM_MIXED) gn_fem_smooth_block(k->body, block, k->motion.dt);
}

/* First passes of the mixed form: growth of the elements, pressures of the nodes. By all threads.
 */
static void find_pressures(const work *k) {
#pragma omp for schedule(static)
    for (size_t b = 0; b < k->body->partials.blocks; b++) dilation_block(k, b);
#pragma omp for schedule(static)
    for (size_t b = 0; b < k->body->motion_blocks; b++) gn_fem_pressure_block(k->body, b);
}

static void sweep(const work *k) {
    gn_fem_body *body = k->body;
    const double begin = gn_now();
#pragma omp parallel num_threads(gn_pace_threads(&body->pace))
    {
        if (body->form == GN_FEM_MIXED) find_pressures(k);
#pragma omp for schedule(static)
        for (size_t b = 0; b < body->partials.blocks; b++) element_block(k, b);
#pragma omp for schedule(static)
        for (size_t b = 0; b < body->motion_blocks; b++) node_block(k, b);
    }
    gn_pace_note(&body->pace, gn_now() - begin, 1.0, 1.0);
}

static work start(gn_fem_body *body, double dt, bool measure) {
    work k = {.body = body, .measure = measure};
    const double *place = body->nodes.pos;
    if (body->form == GN_FEM_MIXED) {
        k.dilation = gn_fem_dilation_args(body);
        place = body->nodes.placed_p;
    }
    k.elements = (gn_element_args){place, &body->elements, body->uniform, &body->partials,
                                   body->gradient_row};
    k.motion = (gn_motion_args){.particles = &body->nodes,
                                .bonds = &body->partials,
                                .pairs = &body->none,
                                .wall_contacts = body->contacts,
                                .wall_first = body->contact_first,
                                .prescribed = body->prescribed.count ? &body->prescribed : NULL,
                                .dt_past = body->dt_past,
                                .dt = dt,
                                .damping = body->damping_coefficient,
                                .measure = measure};
    memcpy(k.motion.gravity, body->gravity, sizeof body->gravity);
    return k;
}

/* --- merging, in block order
 * ----------------------------------------------------------------------- */

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

static gn_fem_pressure_sums merge_pressure(const gn_fem_body *body) {
    gn_fem_pressure_sums total = {0};
    for (size_t b = 0; body->pressure_sums && b < body->motion_blocks; b++) {
        total.elastic += body->pressure_sums[b].elastic;
        total.damping += body->pressure_sums[b].damping;
    }
    return total;
}

/* The first halves of the works close the interval that led here, the second ones are of the coming
 * interval; the reading lies between them. */
static int64_t merge_motion(gn_fem_body *body, bool measure) {
    gn_fem_energy *e = &body->energy;
    double kinetic = 0.0;
    int64_t bad = -1;
    const gn_fem_pressure_sums pressure = merge_pressure(body);
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

/* --- going bad
 * ------------------------------------------------------------------------------------- */

static gneiss_status inside_out(const gn_fem_body *body, gneiss_error *error) {
    const gn_elements *q = &body->elements;
    size_t e = (size_t)body->elastic.element;
    double centre[3] = {0.0};
    for (int a = 0; a <= body->dimension; a++)
        for (int k = 0; k < 3; k++)
            centre[k] += body->nodes.start[4 * (size_t)gn_elements_node(q, a)[e] + (size_t)k] /
                         (body->dimension + 1);
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "%s: step %lld, t = %g s: %s %d (base 0), at the start at (%g, %g, %g) m, is "
                   "turned inside out: det F = %g",
                   body->name, (long long)body->step, body->time, gn_fem_kind(body->dimension),
                   q->id[e], centre[0], centre[1], centre[2], body->elastic.least);
}

static gneiss_status not_finite(const gn_fem_body *body, size_t node, gneiss_error *error) {
    const double *x = body->nodes.start + 4 * node;
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "%s: step %lld, t = %g s: node %d (base 0), at the start at (%g, %g, %g) m, has "
                   "a velocity that is not finite",
                   body->name, (long long)body->step, body->time, body->nodes.id[node], x[0], x[1],
                   x[2]);
}

gneiss_status gn_fem_step(gn_fem_body *body, double dt, bool measure, gneiss_error *error) {
    measure = measure || body->step % GN_FEM_CHECK_EVERY == 0;
    const work k = start(body, dt, measure);
    sweep(&k);
    int64_t bad = merge_motion(body, measure);
    if (measure && body->elastic.least <= 0.0) return inside_out(body, error);
    if (bad >= 0) return not_finite(body, (size_t)bad, error);
    body->dt_past = dt;
    body->time += dt;
    body->step++;
    return GNEISS_OK;
}
