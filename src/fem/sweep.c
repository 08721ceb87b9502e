/* The parallel part of a step: elements and nodes. sched/deal.h describes the work distribution. */
#include "base/timer.h"
#include "fem/internal.h"

#include <string.h>

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
    /* Single precision forces replace those with which the energy was measured, so that a run does
     * not depend on how often it is measured. */
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

/* --- all of it --- */

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

void gn_fem_sweep(gn_fem_solid *solid, double dt, bool measure) {
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

void gn_fem_sweep_held(gn_fem_solid *solid, double dt, bool measure) {
    const size_t held = solid->hold.count;
    if (!held) return;
    work k = prepare(solid, dt, measure);
    k.motion.pass = GN_PASS_MOVE;
#pragma omp parallel for schedule(static) num_threads(solid->deal.team)
    for (size_t h = 0; h < held; h++) move(&k, (size_t)solid->hold.block[h]);
}
