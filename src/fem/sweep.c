/* The parallel part of a step, in the manner of sim/sweep.c: elements are worked on in order, and
 * each block of nodes is worked on as soon as the last block of elements that reads or loads it is
 * done, while its partial sums are in the cache. Blocks of nodes that share elements with another
 * thread wait for the barrier. Nothing depends on who does what and when. */
#include "base/memory.h"
#include "base/timer.h"
#include "fem/parts.h"

#include <math.h>
#include <omp.h>
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

/* --- one block
 * ------------------------------------------------------------------------------------- */

typedef void work_on_block(const work *k, size_t block);

static void find_growth(const work *k, size_t block) {
    const range r = elements_of(k, block);
    k->body->dilation_kernel(&k->dilation, r.begin, r.end);
}

static void find_pressures(const work *k, size_t block) {
    const range r = nodes_of(k, block);
    k->body->pressure_sums[block] = (gn_pressure_sums){0};
    k->body->pressure_kernel[0](&k->pressure, r.begin, r.end, &k->body->pressure_sums[block]);
}

static void find_forces(const work *k, size_t block) {
    const range r = elements_of(k, block);
    gn_element_sums *sums = &k->body->element_sums[block];
    const gn_fem_body *body = k->body;
    *sums = GN_ELEMENT_SUMS_ZERO;
    if (k->measure) body->element_kernel[1](&k->elements, r.begin, r.end, sums);
    /* Forces in single precision take the place of those that the energy was measured with: a run
     * must not depend on how often it is measured. */
    if (!k->measure || body->single) body->element_kernel[0](&k->elements, r.begin, r.end, sums);
}

static void move(const work *k, size_t block) {
    const range r = nodes_of(k, block);
    gn_fem_body *body = k->body;
    body->motion_sums[block] = (gn_motion_sums){.bad = -1};
    body->motion_kernel(&k->motion, r.begin, r.end, &body->motion_sums[block]);
    if (body->form == GN_FEM_MIXED)
        body->pressure_kernel[1](&k->pressure, r.begin, r.end, &body->pressure_sums[block]);
}

/* --- a pass over elements and nodes
 * ------------------------------------------------------------------ */

static size_t cut(const gn_fem_body *body, int t, int threads) {
    const size_t blocks = body->partials.blocks;
    if (t == 0 || t == threads) return t ? blocks : 0;
    return (size_t)lround(body->share[t] * (double)blocks);
}

static void advance(const work *k, work_on_block *elements, size_t end, size_t *next) {
    for (; *next < end; ++*next) elements(k, *next);
}

/* A thread's own part. Every node has an element, so that every block of nodes is touched. */
static void pass_alone(const work *k, work_on_block *elements, work_on_block *nodes,
                       int64_t stamp) {
    gn_fem_body *body = k->body;
    const gn_partials *q = &body->partials;
    const int t = omp_get_thread_num(), threads = omp_get_num_threads();
    const size_t begin = cut(body, t, threads), end = cut(body, t + 1, threads);
    size_t next = begin;
    for (size_t n = 0; n < body->motion_blocks; n++) {
        const size_t first = (size_t)q->touched[0][n], last = (size_t)q->touched[1][n];
        if (first < begin || last >= end) continue;
        advance(k, elements, last + 1, &next);
        nodes(k, n);
        body->done[n] = stamp;
    }
    advance(k, elements, end, &next);
}

/* The blocks of nodes that no thread could work on alone, dealt out in turns. */
static void pass_shared(const work *k, work_on_block *nodes, int64_t stamp) {
    size_t t = (size_t)omp_get_thread_num(), of = (size_t)omp_get_num_threads(), shared = 0;
    for (size_t n = 0; n < k->body->motion_blocks; n++)
        if (k->body->done[n] != stamp && shared++ % of == t) nodes(k, n);
}

static void pass(const work *k, work_on_block *elements, work_on_block *nodes, int64_t stamp) {
    const double start = gn_now();
    pass_alone(k, elements, nodes, stamp);
    k->body->busy[omp_get_thread_num()].seconds += gn_now() - start;
#pragma omp barrier
    pass_shared(k, nodes, stamp);
}

/* --- all of it
 * -------------------------------------------------------------------------------------- */

static work prepare(gn_fem_body *body, double dt, bool measure) {
    work k = {.body = body, .measure = measure};
    const double *place = body->nodes.pos;
    if (body->form == GN_FEM_MIXED) {
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
                                .damping = body->damping_coefficient,
                                .measure = measure};
    memcpy(k.motion.gravity, body->gravity, sizeof body->gravity);
    return k;
}

static void note_pace(gn_fem_body *body, int threads, double seconds) {
    double busy = 0.0;
    for (int t = 0; t < threads; t++) busy += body->busy[t].seconds / threads;
    if (threads > 1) gn_pace_follow(threads, body->busy, body->share);
    gn_pace_note(&body->pace, seconds, 1.0, 1.0 - busy / seconds);
    for (int t = 0; t < threads; t++) body->busy[t].seconds = 0.0;
}

void gn_fem_sweep(gn_fem_body *body, double dt, bool measure) {
    const work k = prepare(body, dt, measure);
    const int threads = gn_pace_threads(&body->pace);
    const int64_t stamp = body->passes += 2; /* not the step: one that failed may be tried again */
    const double begin = gn_now();
#pragma omp parallel num_threads(threads)
    {
        if (body->form == GN_FEM_MIXED) {
            pass(&k, find_growth, find_pressures, stamp - 1);
#pragma omp barrier
        }
        pass(&k, find_forces, move, stamp);
    }
    note_pace(body, threads, gn_now() - begin);
}

gneiss_status gn_fem_sweep_prepare(gn_fem_body *body, gneiss_error *error) {
    const size_t threads = (size_t)body->threads;
    body->done = gn_alloc_array(body->motion_blocks + 1, sizeof *body->done);
    body->share = gn_alloc_array(threads, sizeof *body->share);
    body->busy = gn_alloc_array(threads, sizeof *body->busy);
    if (!body->done || !body->share || !body->busy)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu blocks of nodes",
                       body->name, body->motion_blocks);
    for (size_t t = 0; t < threads; t++) body->share[t] = (double)t / (double)threads;
    body->pace = gn_pace_start(body->threads, 32, 512, 32768);
    return GNEISS_OK;
}
