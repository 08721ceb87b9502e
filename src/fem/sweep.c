/* The parallel part of a step: elements and nodes. Who does what: sched/deal.h. */
#include "base/timer.h"
#include "fem/parts.h"

#include <string.h>

typedef struct work {
    gn_fem_body *body;
    gn_dilation_args dilation;
    gn_element_args elements;
    gn_motion_args motion;
    gn_pressure_args pressure;
    bool measure;
} work;

/* Blocks [begin, end). */
typedef struct range {
    size_t begin, end;
} range;

static range items_of(size_t block, size_t length, size_t count) {
    size_t end = (block + 1) * length;
    return (range){block * length, end < count ? end : count};
}
static range elements_of(const work *k, size_t block) {
    return items_of(block, k->body->partials.length, k->body->elements.soa.count);
}
static range nodes_of(const work *k, size_t block) {
    return items_of(block, GN_PARTICLE_BLOCK, k->body->nodes.soa.count);
}

/* --- one block --- */

static void find_growth(void *context, int list, size_t block) {
    const work *k = context;
    (void)list;
    const range r = elements_of(k, block);
    k->body->dilation_kernel(&k->dilation, r.begin, r.end);
}

static void find_pressures(void *context, size_t block) {
    const work *k = context;
    const range r = nodes_of(k, block);
    k->body->pressure_sums[block] = (gn_pressure_sums){0};
    k->body->pressure_kernel[0](&k->pressure, r.begin, r.end, &k->body->pressure_sums[block]);
}

static void find_forces(void *context, int list, size_t block) {
    const work *k = context;
    (void)list;
    const range r = elements_of(k, block);
    gn_element_sums *sums = &k->body->element_sums[block];
    const gn_fem_body *body = k->body;
    *sums = GN_ELEMENT_SUMS_ZERO;
    if (k->measure) body->element_kernel[1](&k->elements, r.begin, r.end, sums);
    /* Forces in single precision take the place of those that the energy was measured with: a run
     * must not depend on how often it is measured. */
    if (!k->measure || body->single) body->element_kernel[0](&k->elements, r.begin, r.end, sums);
}

static void move(void *context, size_t block) {
    const work *k = context;
    const range r = nodes_of(k, block);
    gn_fem_body *body = k->body;
    body->motion_sums[block] = (gn_motion_sums){.bad = -1};
    body->motion_kernel(&k->motion, r.begin, r.end, &body->motion_sums[block]);
    bool waits = k->motion.hold && k->motion.hold->slot[block] >= 0;
    if (waits && k->motion.pass == GN_PASS_GATHER) return;
    if (body->form == GN_FEM_PRESSURE)
        body->pressure_kernel[1](&k->pressure, r.begin, r.end, &body->pressure_sums[block]);
}

/* --- all of it --- */

static work prepare(gn_fem_body *body, double dt, bool measure) {
    work k = {.body = body, .measure = measure};
    const double *place = body->nodes.pos;
    if (body->form == GN_FEM_PRESSURE) {
        k.dilation = gn_fem_dilation_args(body);
        k.pressure = gn_fem_pressure_args(body, dt, measure);
        place = body->nodes.placed_p;
    }
    k.elements = (gn_element_args){.pos = place,
                                   .elements = &body->elements,
                                   .uniform = body->uniform,
                                   .partials = &body->partials,
                                   .slope_row = body->slope_row,
                                   .travel = body->nodes.travel_f};
    k.motion = (gn_motion_args){.particles = &body->nodes,
                                .origin = body->nodes.start,
                                .bonds = &body->partials,
                                .pairs = &body->none,
                                .wall_contacts = body->contacts,
                                .wall_first = body->contact_first,
                                .prescribed = body->prescribed.count ? &body->prescribed : NULL,
                                .dt_past = body->dt_past,
                                .dt = dt,
                                .hold = body->hold.count ? &body->hold : NULL,
                                .damping = body->damping_coefficient,
                                .measure = measure};
    memcpy(k.motion.gravity, body->gravity, sizeof body->gravity);
    return k;
}

void gn_fem_sweep(gn_fem_body *body, double dt, bool measure) {
    static const gn_deal_work growth = {find_growth, find_pressures}, forces = {find_forces, move};
    work k = prepare(body, dt, measure);
    const double begin = gn_now();
    const int sweeps = body->form == GN_FEM_PRESSURE ? 2 : 1;
    gn_deal_begin(&body->deal);
#pragma omp parallel num_threads(body->deal.team)
    {
        if (sweeps == 2) {
            gn_deal_sweep(&body->deal, 0, &growth, &k);
#pragma omp barrier
        }
        gn_deal_sweep(&body->deal, sweeps - 1, &forces, &k);
    }
    gn_deal_end(&body->deal, sweeps, gn_now() - begin);
}

void gn_fem_sweep_held(gn_fem_body *body, double dt, bool measure) {
    const size_t held = body->hold.count;
    if (!held) return;
    work k = prepare(body, dt, measure);
    k.motion.pass = GN_PASS_MOVE;
#pragma omp parallel for schedule(static) num_threads(body->deal.threads)
    for (size_t h = 0; h < held; h++) move(&k, (size_t)body->hold.block[h]);
}
