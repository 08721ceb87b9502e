/* The parallel part of a step: contacts, walls, motion, and who does what.
 *
 * Contacts are worked on in order, and each block of particles moves as soon as the last contact
 * that reads or loads it is done, while its partial sums are in the cache. Blocks of particles that
 * share contacts with another thread wait for the barrier. All sums are kept per block and merged
 * in block order, so that nothing depends on who does what and when: the cuts between the threads
 * may follow their measured pace. */
#include "base/timer.h"
#include "sim/parts.h"

#include <math.h>
#include <omp.h>

/* Blocks [begin, end) of one kind of work. */
typedef struct range {
    size_t begin, end;
} range;

typedef struct work {
    gn_world *w;
    const gn_contact_args *bonds, *pairs;
    const gn_motion_args *motion;
} work;

/* The first thread books time under the phases. */
typedef struct stopwatch {
    bool books;
    double mark;
} stopwatch;

static void book(gn_world *w, gn_phase phase, stopwatch *c) {
    if (!c->books) return;
    double now = gn_now();
    w->seconds[phase] += now - c->mark;
    c->mark = now;
}

/* --- cuts between threads
 * -------------------------------------------------------------------------------- */

static range equal_share(size_t count) {
    size_t t = (size_t)omp_get_thread_num(), of = (size_t)omp_get_num_threads();
    return (range){count * t / of, count * (t + 1) / of};
}

/* First block of a list whose first contact belongs to `particle` or a later one. */
static size_t block_at(const gn_contacts *list, const gn_partials *q, int32_t particle) {
    size_t low = 0, high = q->blocks;
    while (low < high) {
        size_t mid = (low + high) / 2;
        if (list->i[mid * q->length] < particle)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

/* Where thread t's share of a list begins: the longer list is cut by blocks, the shorter one at the
 * same particles, so that few particles have contacts on both sides. */
static size_t cut(const gn_world *w, bool of_bonds, int t, int threads) {
    const gn_partials *q = of_bonds ? &w->bond_partials : &w->pair_partials;
    if (t == 0 || t == threads) return t ? q->blocks : 0;
    bool bonds_lead = w->bonds.soa.count >= w->pairs.soa.count;
    const gn_partials *lead = bonds_lead ? &w->bond_partials : &w->pair_partials;
    size_t block = (size_t)lround(w->share[t] * (double)lead->blocks);
    if (of_bonds == bonds_lead) return block;
    if (block >= lead->blocks) return q->blocks;
    const gn_contacts *leading = bonds_lead ? &w->bonds : &w->pairs;
    return block_at(of_bonds ? &w->bonds : &w->pairs, q, leading->i[block * lead->length]);
}

static range my_share(const gn_world *w, bool of_bonds) {
    int t = omp_get_thread_num(), of = omp_get_num_threads();
    return (range){cut(w, of_bonds, t, of), cut(w, of_bonds, t + 1, of)};
}

void gn_sweep_prepare(gn_world *w) {
    for (int t = 0; t < GN_THREADS_MAX; t++) {
        w->share[t] = t < w->threads ? (double)t / w->threads : 1.0;
        w->busy[t].seconds = 0.0;
    }
    w->pace = gn_pace_start(w->threads, 32, 512, 32768);
}

/* --- the work
 * -------------------------------------------------------------------------------------------- */

/* Contact blocks of a list that are due up to and including `until`. */
static void advance(const work *k, bool of_bonds, int64_t until, range *due, stopwatch *c) {
    gn_world *w = k->w;
    const gn_contact_args *args = of_bonds ? k->bonds : k->pairs;
    gn_contact_kernel *kernel = of_bonds ? w->bond_kernel : w->pair_kernel;
    gn_contact_sums *sums = of_bonds ? w->bond_sums : w->pair_sums;
    size_t length = args->partials->length, count = args->contacts->soa.count;
    size_t end = until < (int64_t)due->end ? (size_t)(until + 1) : due->end;
    if (due->begin >= end) return;
    for (size_t b = due->begin; b < end; b++) {
        size_t last = (b + 1) * length < count ? (b + 1) * length : count;
        sums[b] = (gn_contact_sums){0};
        kernel(args, b * length, last, &sums[b]);
    }
    due->begin = end;
    book(w, of_bonds ? GN_PHASE_bonds : GN_PHASE_pairs, c);
}

/* Walls and motion of a block of particles, whose contacts are done. */
static void move(const work *k, size_t block, stopwatch *c) {
    gn_world *w = k->w;
    size_t first = block * GN_PARTICLE_BLOCK, last = first + GN_PARTICLE_BLOCK;
    if (last > w->particles.soa.count) last = w->particles.soa.count;
    if (w->effects & GN_FX_WALLS) {
        size_t begin = (size_t)w->wall_first[first], end = (size_t)w->wall_first[last];
        w->wall_sums[block] = (gn_contact_sums){0};
        gn_wall_contacts_work(w, begin, end, &w->wall_sums[block]);
        if (begin < end) book(w, GN_PHASE_walls, c);
    }
    w->motion_sums[block] = (gn_motion_sums){.bad = -1};
    w->motion_kernel(k->motion, first, last, &w->motion_sums[block]);
    book(w, GN_PHASE_motion, c);
}

/* Last block of contacts that touches a block of particles, -1: none. */
static int64_t last_touch(const gn_partials *q, size_t particles) {
    return q->blocks ? q->touched[1][particles] : -1;
}

/* Whether all contacts of a block of particles lie in the range. */
static bool within(const gn_partials *q, size_t particles, range mine) {
    int64_t last = last_touch(q, particles);
    return last < 0 || ((size_t)q->touched[0][particles] >= mine.begin && (size_t)last < mine.end);
}

static void sweep(const work *k, stopwatch *c) {
    gn_world *w = k->w;
    const gn_partials *bonds = &w->bond_partials, *pairs = &w->pair_partials;
    const range my_bonds = my_share(w, true), my_pairs = my_share(w, false),
                loose = equal_share(w->motion_blocks);
    range bonds_due = my_bonds, pairs_due = my_pairs;
    for (size_t p = 0; p < w->motion_blocks; p++) {
        int64_t bond = last_touch(bonds, p), pair = last_touch(pairs, p);
        bool mine = within(bonds, p, my_bonds) && within(pairs, p, my_pairs);
        if (bond < 0 && pair < 0) mine = p >= loose.begin && p < loose.end;
        if (!mine) continue;
        advance(k, true, bond, &bonds_due, c);
        advance(k, false, pair, &pairs_due, c);
        move(k, p, c);
        w->moved[p] = w->step;
    }
    advance(k, true, INT64_MAX - 1, &bonds_due, c);
    advance(k, false, INT64_MAX - 1, &pairs_due, c);
}

/* The blocks of particles that no thread could move alone, dealt out in turns. */
static void move_shared(const work *k, stopwatch *c) {
    size_t t = (size_t)omp_get_thread_num(), of = (size_t)omp_get_num_threads(), shared = 0;
    for (size_t p = 0; p < k->w->motion_blocks; p++)
        if (k->w->moved[p] != k->w->step && shared++ % of == t) move(k, p, c);
}

void gn_sweep(gn_world *w, const gn_contact_args *bonds, const gn_contact_args *pairs,
              const gn_motion_args *motion) {
    const work k = {w, bonds, pairs, motion};
    const int threads = gn_pace_threads(&w->pace);
    const double begin = gn_now();
#pragma omp parallel num_threads(threads)
    {
        stopwatch c = {omp_get_thread_num() == 0, gn_now()};
        double start = gn_now();
        sweep(&k, &c);
        w->busy[omp_get_thread_num()].seconds = gn_now() - start;
#pragma omp barrier
        book(w, GN_PHASE_motion, &c); /* waiting for the other threads */
        move_shared(&k, &c);
    }
    double seconds = gn_now() - begin, busy = 0.0;
    for (int t = 0; t < threads; t++) busy += w->busy[t].seconds / threads;
    if (threads > 1) gn_pace_follow(threads, w->busy, w->share);
    gn_pace_note(&w->pace, seconds, 1.0, 1.0 - busy / seconds);
}
