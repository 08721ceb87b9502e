#include "pack/pack.h"

#include "base/new.h"
#include "base/point.h"
#include "base/threads.h"
#include "base/timer.h"
#include "neigh/neigh.h"
#include "pack/seeds.h"
#include "pack/sizes.h"
#include "pack/spheres.h"

#include <math.h>
#include <string.h>

const char *gn_pack_stage_name(gn_pack_stage stage) {
    static const char *const names[GN_PACK_STAGES] = {"spread", "compress", "decompress", "close",
                                                      "separate"};
    return names[stage];
}

/* ---- the schedule ---- */

/* Parameters of the stages: volume of the particles over that of the body at the start, and the
 * volume ratio at which the springs would be free of force (both measured: docs/packing.md). */
typedef struct schedule {
    double loose, wanted;
    double stiffness; /* stiffness of the springs while compressing */
    double release;   /* factor on the stiffness per decompression step */
    int releases;
    double last;                     /* factor on the stiffness for the last stages */
    bool hold;                       /* all contacts of the compressed state are held */
    double overlap, gap, pull, most; /* gn_fit_law of the last stages */
} schedule;

/* In 2D a compressed packing is a triangulation already, and all of its contacts can be kept
 * (Koebe: every planar triangulation has a packing of touching discs). In space a maximum of the
 * volume has 8 contacts per particle; the pressure is therefore released first, and small gaps are
 * then closed. */
static schedule schedule_of(const gn_pack_def *def, int dimension) {
    schedule s = {.loose = 0.5,
                  .wanted = 2.0,
                  .stiffness = 3.0,
                  .release = 0.2,
                  .releases = 3,
                  .last = 0.01,
                  .overlap = 0.0,
                  .gap = 0.03,
                  .pull = 0.3};
    if (dimension == 2) {
        s.loose = 0.7;
        s.releases = 0;
        s.last = 1e-5;
        s.hold = true;
        s.pull = 1.0;
    }
    if (def->overlap == GN_OVERLAP_PASSIVE) {
        s.overlap = def->overlap_size >= 0.0 ? def->overlap_size : 0.03;
        s.gap = fmax(s.gap, 4.0 * s.overlap);
        s.pull = 2.0;
        s.most = 2.0 * s.overlap;
    }
    if (def->gap >= 0.0) s.gap = def->gap;
    return s;
}

static gn_fit_goal goal_of(gn_pack_stage stage, int dimension) {
    switch (stage) {
    case GN_PACK_SPREAD:
        return (gn_fit_goal){30, 20, 0.1, 1e-3, 0.5, 3};
    case GN_PACK_COMPRESS:
        return (gn_fit_goal){100, 30, 0.05, dimension == 3 ? 1e-4 : 1e-3, 0.3, 4};
    case GN_PACK_DECOMPRESS:
        return (gn_fit_goal){60, 30, 0.05, 3e-4, 0.3, 6};
    case GN_PACK_CLOSE:
        if (dimension == 2) return (gn_fit_goal){30, 200, 0.01, 1e-2, 0.5, 5};
        return (gn_fit_goal){60, 60, 0.01, 1e-3, 0.2, 5};
    case GN_PACK_SEPARATE:
    case GN_PACK_STAGES:
        break;
    }
    return (gn_fit_goal){40, 60, 0.01, 1e-2, 0.1, 5};
}

/* ---- running ---- */

typedef struct job {
    const gn_scene *scene;
    const gn_pack_def *def;
    int dimension, threads;
    const gn_domain *domain;
    gn_seeds seeds;
    double *wanted, *least, *most;
    gn_fit *fit;
    schedule plan;
    gn_pack_stage stage;
    int planned; /* limit of all iterations */
    size_t trace_capacity;
    double begin;
    bool out_of_time, enough, given_up, no_memory;
    gn_pack_watch *watch;
    void *context;
    gn_pack_result *result;
} job;

static bool push_trace(job *run, const gn_fit_state *state) {
    gn_pack_result *r = run->result;
    if (gn_grow(&r->trace, r->trace_count, r->trace_count + 1, &run->trace_capacity, "iterations",
                NULL) != GNEISS_OK)
        return false;
    r->trace[r->trace_count++] = (gn_pack_trace){run->stage, *state};
    return true;
}

/* The limits that the user sets end the search, but not the removal of overlaps after it. */
static bool watch_fit(void *context, const gn_fit_state *state) {
    job *j = context;
    if (!push_trace(j, state)) j->no_memory = true;
    if (j->watch) {
        double fraction = fmin((double)state->iteration / j->planned, 1.0);
        gn_pack_progress p = {j->stage, fraction, *state, j->seeds.count};
        if (!j->watch(j->context, &p)) j->given_up = true;
    }
    if (j->given_up || j->no_memory) return false;
    if (j->stage == GN_PACK_SEPARATE) return true;
    if (j->def->time_limit > 0.0 && gn_now() - j->begin > j->def->time_limit) j->out_of_time = true;
    if (j->def->iterations > 0 && state->iteration >= j->def->iterations) j->enough = true;
    if (j->stage == GN_PACK_CLOSE && state->gap_rms < j->def->residual) j->enough = true;
    return !j->out_of_time && !j->enough;
}

static gneiss_status run_stage(job *run, gn_pack_stage stage, const gn_fit_law *law,
                               gneiss_error *error) {
    if (stage != GN_PACK_SEPARATE && (run->out_of_time || run->enough)) return GNEISS_OK;
    gn_fit_goal goal = goal_of(stage, run->dimension);
    bool go_on = true;
    run->stage = stage;
    GN_TRY(gn_fit_run(run->fit, law, &goal, watch_fit, run, &go_on, error));
    if (run->no_memory) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to pack");
    if (run->given_up) return gn_fail(error, GNEISS_INTERRUPTED, "packing interrupted");
    return GNEISS_OK;
}

/* Largest relative change of a radius of a requested distribution, and largest further change by
 * the removal of the last overlaps. */
static const double kept = 0.1, last_of_it = 2e-3;

/* Computes for every radius the factor that would remove the remaining overlaps, from the largest
 * overlap of the particle. */
static gneiss_status find_factors(const job *run, const double *sphere, double *factor,
                                  gneiss_error *error) {
    const size_t n = run->seeds.count;
    gn_particles q;
    gn_pair_list pairs = {0};
    GN_TRY(gn_particles_of_spheres(sphere, n, &q, error));
    for (size_t k = 0; k < n; k++) {
        const double *x = sphere + 4 * k;
        factor[k] = fmin(1.0, gn_domain_depth(run->domain, x) / x[3]);
    }
    gn_pair_query query = {.particles = &q, .dimension = run->dimension, .threads = run->threads};
    gneiss_status status = gn_pairs_find(&query, &pairs, error);
    for (size_t k = 0; k < pairs.count; k++) {
        const double *a = q.pos + 4 * pairs.pair[k][0], *b = q.pos + 4 * pairs.pair[k][1];
        double u[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        double share = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) / (a[3] + b[3]);
        for (int side = 0; side < 2; side++)
            factor[pairs.pair[k][side]] = fmin(factor[pairs.pair[k][side]], share);
    }
    gn_pair_list_free(&pairs);
    gn_soa_destroy(&gn_particle_record, &q);
    return status;
}

/* Tells whether a radius would have to shrink by more than is allowed. */
static gneiss_status is_crowded(const job *run, double *factor, bool *crowded,
                                gneiss_error *error) {
    const double *row = gn_fit_rows(run->fit);
    GN_TRY(find_factors(run, row, factor, error));
    *crowded = false;
    for (size_t k = 0; k < run->seeds.count; k++)
        *crowded = *crowded || row[4 * k + 3] * factor[k] < (1.0 - last_of_it) * run->least[k];
    return GNEISS_OK;
}

/* Only the ratios of requested sizes are prescribed: if there is no room for some particle, all of
 * them shrink a little and are separated again. */
static gneiss_status make_room(job *run, const gn_fit_law *law, gneiss_error *error) {
    enum { TIMES = 40 };
    const double smaller = 0.99;
    GN_FREED double *factor = NULL;
    bool crowded = true;
    GN_TRY(gn_new(&factor, run->seeds.count, "particles", error));
    GN_TRY(is_crowded(run, factor, &crowded, error));
    for (int k = 0; k < TIMES && crowded; k++) {
        for (size_t p = 0; p < run->seeds.count; p++) {
            run->wanted[p] *= smaller;
            run->least[p] *= smaller;
            run->most[p] *= smaller;
        }
        GN_TRY(run_stage(run, GN_PACK_SEPARATE, law, error));
        GN_TRY(is_crowded(run, factor, &crowded, error));
    }
    return GNEISS_OK;
}

static gneiss_status run_stages(job *run, gneiss_error *error) {
    const schedule *s = &run->plan;
    gn_fit_law law = {.fixed_radii = true};
    GN_TRY(run_stage(run, GN_PACK_SPREAD, &law, error));
    law = (gn_fit_law){.stiffness = s->stiffness};
    GN_TRY(run_stage(run, GN_PACK_COMPRESS, &law, error));
    for (int k = 0; k < s->releases; k++) {
        law.stiffness *= s->release;
        GN_TRY(run_stage(run, GN_PACK_DECOMPRESS, &law, error));
    }
    law.stiffness *= s->last;
    if (s->hold) {
        GN_TRY(gn_fit_hold(run->fit, error));
        law.pull = s->pull;
        GN_TRY(run_stage(run, GN_PACK_CLOSE, &law, error));
        gn_fit_release(run->fit);
    }
    law.overlap = s->overlap;
    law.gap = s->gap;
    law.pull = s->pull;
    law.most = s->most;
    GN_TRY(run_stage(run, GN_PACK_CLOSE, &law, error));
    if (run->def->overlap == GN_OVERLAP_PASSIVE) return GNEISS_OK;
    law.stiffness *= 0.1;
    law.pull *= 0.1; /* enough to keep contacts while overlaps are removed */
    law.gap = fmin(law.gap, 0.015);
    GN_TRY(run_stage(run, GN_PACK_SEPARATE, &law, error));
    return run->def->sizes == GN_SIZES_FITTED ? GNEISS_OK : make_room(run, &law, error);
}

/* ---- before and after ---- */

static gneiss_status prepare(job *run, gneiss_error *error) {
    size_t n = run->seeds.count;
    double packed = gn_packed_fraction(run->dimension);
    double loose = pow(run->plan.loose / packed, 1.0 / run->dimension);
    double wanted = pow(run->plan.wanted / packed, 1.0 / run->dimension);
    const bool asked = run->def->sizes != GN_SIZES_FITTED;
    run->wanted = gn_alloc_array(n, sizeof(double));
    run->least = gn_alloc_array(n, sizeof(double));
    run->most = gn_alloc_array(n, sizeof(double));
    if (!run->wanted || !run->least || !run->most)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to pack %zu particles", n);
    for (size_t k = 0; k < n; k++) {
        double nominal = run->seeds.row[4 * k + 3];
        run->wanted[k] = wanted * nominal;
        run->least[k] = asked ? (1.0 - kept) * nominal : 0.2 * nominal;
        run->most[k] = asked ? (1.0 + kept) * nominal : 5.0 * nominal;
        run->seeds.row[4 * k + 3] = loose * nominal;
    }
    return gn_fit_create(run->domain, n, run->seeds.row, run->wanted, run->least, run->most,
                         run->threads, &run->fit, error);
}

/* Removes the remaining overlaps by shrinking particles. */
static gneiss_status shrink(job *run, gneiss_error *error) {
    gn_packing *p = &run->result->packing;
    double *factor = run->least; /* reused; `least` is no longer needed */
    gneiss_status status = find_factors(run, p->sphere, factor, error);
    for (size_t k = 0; k < p->count && status == GNEISS_OK; k++) p->sphere[4 * k + 3] *= factor[k];
    return status;
}

static gneiss_status take_result(job *run, gneiss_error *error) {
    gn_packing *p = &run->result->packing;
    p->count = run->seeds.count;
    GN_TRY(gn_new(&p->sphere, 4 * p->count, "coordinates of particles", error));
    memcpy(p->sphere, gn_fit_rows(run->fit), p->count * 4 * sizeof *p->sphere);
    run->result->in_time = !run->out_of_time;
    if (run->def->overlap == GN_OVERLAP_PASSIVE) return GNEISS_OK;
    return shrink(run, error);
}

static int planned_iterations(const job *run) {
    int sum = 0;
    for (int k = 0; k < GN_PACK_STAGES; k++) {
        int times = k == GN_PACK_DECOMPRESS ? run->plan.releases : 1;
        sum += times * goal_of((gn_pack_stage)k, run->dimension).iterations;
    }
    return sum;
}

static gneiss_status make(job *run, const gn_pack_shape *body, gneiss_error *error) {
    GN_TRY(gn_threads_find(run->scene->threads, &run->threads, error));
    run->domain = body->domain;
    run->plan = schedule_of(run->def, run->dimension);
    run->planned = planned_iterations(run);
    GN_TRY(gn_seeds_create(run->scene, body, &run->seeds, error));
    GN_TRY(prepare(run, error));
    GN_TRY(run_stages(run, error));
    return take_result(run, error);
}

static gneiss_status pack(const gn_scene *scene, gn_pack_watch *watch, void *context,
                          gn_pack_result *result, gneiss_error *error) {
    *result = (gn_pack_result){0};
    job j = {.scene = scene,
             .def = &scene->specimen.pack,
             .dimension = (int)scene->dimension,
             .begin = gn_now(),
             .watch = watch,
             .context = context,
             .result = result};
    gn_pack_shape body;
    GN_TRY(gn_pack_shape_create(scene, &body, error));
    result->volume = gn_domain_volume(body.domain);
    memcpy(result->changes, body.changes, sizeof result->changes);
    gneiss_status status = make(&j, &body, error);
    result->seconds = gn_now() - j.begin;
    gn_fit_free(j.fit);
    gn_seeds_free(&j.seeds);
    gn_free(j.wanted);
    gn_free(j.least);
    gn_free(j.most);
    if (status == GNEISS_OK) {
        result->domain = body.domain;
        body.domain = NULL;
    }
    gn_pack_shape_free(&body);
    if (status != GNEISS_OK) gn_pack_result_free(result);
    return status;
}

/* Writes the specimen's name before an error message. */
static gneiss_status name_specimen(const gn_scene *scene, gneiss_status status,
                                   gneiss_error *error) {
    if (status == GNEISS_OK || status == GNEISS_INTERRUPTED) return status;
    char at[GN_POINT_SIZE], from[GN_POINT_SIZE + 40] = "";
    const double *o = scene->origin;
    if (o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0)
        snprintf(from, sizeof from, "(places are from the origin %s m) ",
                 gn_point_text(o, (const double[3]){0, 0, 0}, at));
    return gn_fail_context(error, "%s: %s",
                           gn_scene_at(scene, scene->specimen.where, "specimen").text, from);
}

gneiss_status gn_pack_make(const gn_scene *scene, gn_pack_watch *watch, void *context,
                           gn_pack_result *result, gneiss_error *error) {
    return name_specimen(scene, pack(scene, watch, context, result, error), error);
}

bool gn_pack_is_narrow(const gn_scene *scene, double least, double most, size_t particles,
                       char *text, size_t size) {
    const gn_pack_def *def = &scene->specimen.pack;
    const gn_sizes sizes = {def->sizes,       def->size_ratio, def->size_variation,
                            def->sieve_count, def->sieve,      (int)scene->dimension};
    const bool uniform = def->sizes == GN_SIZES_UNIFORM, curve = def->sizes == GN_SIZES_SIEVE;
    double smallest, largest;
    char above[64] = "";
    text[0] = '\0';
    if (def->shape == GN_SHAPE_NONE || (!uniform && !curve)) return false;
    gn_sizes_range(&sizes, &smallest, &largest);
    const double asked = largest / smallest, found = most / least;
    if (found >= asked * (1.0 - kept) / (1.0 + kept)) return false;
    if (curve)
        snprintf(above, sizeof above, ", and %.0f %% of the mass should be in larger ones",
                 100.0 * (1.0 - gn_sizes_share(&sizes, found * smallest)));
    const char *key = uniform ? "specimen.packing.size_ratio" : "specimen.packing.sieve";
    snprintf(text, size,
             "%s asks for radii of 1 to %.4g, and the %zu particles have 1 to %.4g%s: too few to "
             "have one of each size; more of them, or a narrower range",
             gn_scene_at(scene, scene->specimen.where, key).text, asked, particles, found, above);
    return true;
}

void gn_pack_result_free(gn_pack_result *result) {
    gn_packing_free(&result->packing);
    gn_domain_free(result->domain);
    gn_free(result->trace);
    *result = (gn_pack_result){0};
}
