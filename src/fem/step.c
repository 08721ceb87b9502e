/* One step: the sweep, sums in block order, and checks of the state. */
#include "fem/internal.h"

#include "base/timer.h"

#include <math.h>
#include <string.h>

/* ---- the parallel part of a step: elements and nodes. sched/deal.h describes the work
 * distribution ---- */

typedef struct work {
    gn_fem_solid *solid;
    gn_dilation_args dilation;
    gn_element_args elements;
    gn_motion_args motion;
    gn_pressure_args pressure;
    bool measure;
} work;

/* A range of blocks [begin, end). */
typedef struct range {
    size_t begin, end;
} range;

static range items_of(size_t block, size_t length, size_t count) {
    size_t end = (block + 1) * length;
    return (range){block * length, end < count ? end : count};
}
static range elements_of(const work *context_work, size_t block) {
    return items_of(block, context_work->solid->partials.length,
                    context_work->solid->elements.soa.count);
}
static range nodes_of(const work *context_work, size_t block) {
    return items_of(block, GN_PARTICLE_BLOCK, context_work->solid->nodes.soa.count);
}

/* --- one block --- */

static void find_growth(void *context, int list, size_t block) {
    const work *k = context;
    (void)list;
    const range r = elements_of(k, block);
    k->solid->dilation_kernel(&k->dilation, r.begin, r.end);
}

static void find_pressures(void *context, size_t block) {
    const work *k = context;
    const range r = nodes_of(k, block);
    k->solid->pressure_sums[block] = (gn_pressure_sums){0};
    k->solid->pressure_kernel[0](&k->pressure, r.begin, r.end, &k->solid->pressure_sums[block]);
}

static void find_forces(void *context, int list, size_t block) {
    const work *k = context;
    (void)list;
    const range r = elements_of(k, block);
    gn_element_sums *sums = &k->solid->element_sums[block];
    const gn_fem_solid *solid = k->solid;
    *sums = GN_ELEMENT_SUMS_ZERO;
    if (k->measure) solid->element_kernel[1](&k->elements, r.begin, r.end, sums);
    /* The measured forces are replaced by single precision ones, so that a run does not depend on
     * how often it is measured. */
    if (!k->measure || solid->single) solid->element_kernel[0](&k->elements, r.begin, r.end, sums);
}

static void move(void *context, size_t block) {
    const work *k = context;
    const range r = nodes_of(k, block);
    gn_fem_solid *solid = k->solid;
    solid->motion_sums[block] = (gn_motion_sums){.bad = -1};
    solid->motion_kernel(&k->motion, r.begin, r.end, &solid->motion_sums[block]);
    bool waits = k->motion.hold && k->motion.hold->slot[block] >= 0;
    if (waits && k->motion.pass == GN_PASS_GATHER) return;
    if (solid->form == GN_FEM_PRESSURE)
        solid->pressure_kernel[1](&k->pressure, r.begin, r.end, &solid->pressure_sums[block]);
}

/* --- all blocks --- */

static work prepare(gn_fem_solid *solid, double dt, bool measure) {
    work k = {.solid = solid, .measure = measure};
    const double *place = solid->nodes.pos;
    if (solid->form == GN_FEM_PRESSURE) {
        k.dilation = gn_fem_dilation_args(solid);
        k.pressure = gn_fem_pressure_args(solid, dt, measure);
        place = solid->nodes.placed_p;
    }
    k.elements = (gn_element_args){.pos = place,
                                   .elements = &solid->elements,
                                   .uniform = solid->uniform,
                                   .partials = &solid->partials,
                                   .slope_row = solid->slope_row,
                                   .travel = solid->nodes.travel_f};
    k.motion = (gn_motion_args){.particles = &solid->nodes,
                                .origin = solid->nodes.start,
                                .lists = 1,
                                .partials = {&solid->partials},
                                .wall_contacts = solid->contacts,
                                .wall_first = solid->contact_first,
                                .prescribed = solid->prescribed.count ? &solid->prescribed : NULL,
                                .dt_past = solid->dt_past,
                                .dt = dt,
                                .hold = solid->hold.count ? &solid->hold : NULL,
                                .damping = solid->damping_coefficient,
                                .measure = measure};
    memcpy(k.motion.gravity, solid->gravity, sizeof solid->gravity);
    return k;
}

/* Computes the present forces, and moves nodes (with the stabilising pressure) over the coming
 * interval; leaves the sums of all blocks. */
static void sweep_all(gn_fem_solid *solid, double dt, bool measure) {
    static const gn_deal_work growth = {find_growth, find_pressures, NULL},
                              forces = {find_forces, move, NULL};
    work k = prepare(solid, dt, measure);
    const double begin = gn_now();
    const int sweeps = solid->form == GN_FEM_PRESSURE ? 2 : 1;
    gn_deal_begin(&solid->deal);
#pragma omp parallel num_threads(solid->deal.team)
    {
        if (sweeps == 2) {
            gn_deal_sweep(&solid->deal, 0, &growth, &k);
#pragma omp barrier
        }
        gn_deal_sweep(&solid->deal, sweeps - 1, &forces, &k);
    }
    gn_deal_end(&solid->deal, sweeps, gn_now() - begin);
}

/* Moves the nodes that sweep_all held back. */
static void sweep_held(gn_fem_solid *solid, double dt, bool measure) {
    const size_t held = solid->hold.count;
    if (!held) return;
    work k = prepare(solid, dt, measure);
    k.motion.pass = GN_PASS_MOVE;
#pragma omp parallel for schedule(static) num_threads(solid->deal.team)
    for (size_t h = 0; h < held; h++) move(&k, (size_t)solid->hold.block[h]);
}

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

/* Merges the sums of the motion. First halves of works belong to the past interval, second halves
 * to the coming one; the reading lies between them. */
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
    sweep_all(solid, dt, solid->measured);
}

gneiss_status gn_fem_step(gn_fem_solid *solid, double dt, bool measure, gneiss_error *error) {
    gn_fem_forces(solid, dt, measure);
    return gn_fem_move(solid, dt, error);
}

gneiss_status gn_fem_move(gn_fem_solid *solid, double dt, gneiss_error *error) {
    const bool measure = solid->measured;
    double speed2;
    sweep_held(solid, dt, measure);
    int64_t bad = merge_motion(solid, measure, &speed2);
    if (measure && solid->elastic.least <= 0.0) return inside_out(solid, error);
    if (bad >= 0) return not_finite(solid, (size_t)bad, error);
    solid->path = (measure ? 0.0 : solid->path) + dt * sqrt(speed2);
    solid->dt_past = dt;
    solid->time += dt;
    solid->step++;
    return GNEISS_OK;
}
