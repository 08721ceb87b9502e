/* What the first conversion will make of the step, before a step is made: where and when the body
 * comes to a limit first if it follows its motions and loads at rest, K u = f(t), and what the step
 * is once the elements have gone that are loaded most there, by the conversion that a run makes. */
#include "base/eigen.h"
#include "base/memory.h"
#include "couple/front.h"
#include "fem/linear.h"
#include "scene/stages.h"
#include "scene/table.h"
#include "sim/conversion_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- at rest --- */

typedef struct rest {
    gn_world *w;
    gn_fem_linear linear;
    size_t count;   /* [nodes][dimension] */
    double inertia; /* 1/s2, which holds what nothing else holds */
    double *u;      /* m, over scale where it is free */
    double *load;   /* N, times scale */
    double *weight; /* preconditioner */
    double *residual, *search, *image, *better;
} rest;

static void rest_free(rest *r) {
    void *blocks[] = {r->u, r->load, r->weight, r->residual, r->search, r->image, r->better};
    gn_fem_linear_free(&r->linear);
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
}

/* The time of a run is long beside its waves; where it is not, inertia is what holds. */
static gneiss_status rest_make(gn_world *w, rest *r, gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(w);
    const size_t d = (size_t)b->dimension, nodes = b->nodes.soa.count;
    *r = (rest){.w = w, .count = d * nodes, .inertia = 1.0 / (w->scene.end * w->scene.end)};
    GN_TRY(gn_fem_linear_make(b, true, &r->linear, error));
    double **blocks[] = {&r->u,      &r->load,  &r->weight, &r->residual,
                         &r->search, &r->image, &r->better};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) {
        *blocks[k] = gn_alloc_array(r->count + 1, sizeof **blocks[k]);
        if (!*blocks[k])
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes at rest", nodes);
    }
    for (size_t k = 0; k < r->count; k++) {
        const double s = r->linear.scale[k];
        r->weight[k] =
            s > 0.0 ? 1.0 / (s * s * r->linear.stiffness[k / d] / (double)d + r->inertia) : 0.0;
    }
    return GNEISS_OK;
}

/* m: of a component that a motion drives, up to a time. */
static double path_of(const gn_element_model *q, int32_t motion, size_t a, double time) {
    for (size_t k = 0; k < q->def->motion_count; k++)
        if (q->motion[k] == motion)
            return gn_table_between(&q->def->motions[k].motion.velocity[a], 0.0, time);
    return 0.0;
}

/* [count] m of what is driven, 0 of what is free. */
static void set_paths(const rest *r, double time, double *path) {
    const gn_element_model *q = r->w->elements[0];
    const gn_fem_solid *b = &q->solid;
    const size_t d = (size_t)b->dimension;
    memset(path, 0, r->count * sizeof *path);
    for (size_t n = 0; b->prescribed.count && n < b->nodes.soa.count; n++) {
        const int32_t slot = b->nodes.slot[n];
        for (size_t a = 0; slot >= 0 && a < d; a++)
            if (b->channel[slot][a] >= 0)
                path[d * n + a] = path_of(q, b->channel[slot][a], a, time);
    }
}

/* What loads, gravity and driven nodes do to those that are free. */
static void set_load(rest *r, double time) {
    gn_fem_solid *b = gn_coupled_solid(r->w);
    double *scale = r->linear.scale;
    const size_t d = (size_t)b->dimension;
    gn_elements_set_loads(r->w->elements[0], time);
    set_paths(r, time, r->search);
    /* Those that cannot move have no unknowns: for once they have. */
    for (size_t k = 0; k < r->count; k++) r->better[k] = scale[k];
    for (size_t k = 0; k < r->count; k++) {
        if (scale[k] > 0.0) continue;
        scale[k] = r->search[k] != 0.0 ? 1.0 : 0.0;
    }
    gn_fem_linear_apply(&r->linear, r->search, r->image);
    memcpy(scale, r->better, r->count * sizeof *scale);
    for (size_t n = 0; n < b->nodes.soa.count; n++)
        for (size_t a = 0; a < d; a++) {
            const size_t k = d * n + a;
            const double force =
                b->nodes.applied[4 * n + a] + b->gravity[a] / b->nodes.vel[4 * n + 3];
            r->load[k] = scale[k] > 0.0 ? scale[k] * force - r->image[k] : 0.0;
        }
    gn_elements_set_loads(r->w->elements[0], r->w->time);
}

static double dot(const rest *r, const double *x, const double *y) {
    return gn_eigen_dot(r->count, x, y, r->w->threads);
}

static void apply(const rest *r, const double *x, double *out) {
    gn_fem_linear_apply(&r->linear, x, out);
    for (size_t k = 0; k < r->count; k++) out[k] += r->inertia * x[k];
}

/* Conjugate gradients from the multiple of the last solution that is nearest, which is the solution
 * where loads only grow. A thousandth is enough to see where stresses are largest. */
static void solve(rest *r) {
    enum { MOST = 3000 };
    double *x = r->u, *residual = r->residual, *p = r->search, *Ap = r->image;
    apply(r, x, Ap);
    const double own = dot(r, x, Ap), all = sqrt(dot(r, r->load, r->load));
    const double share = own > 0.0 ? dot(r, x, r->load) / own : 0.0;
    for (size_t k = 0; k < r->count; k++) {
        x[k] *= share;
        residual[k] = r->load[k] - share * Ap[k];
        p[k] = r->better[k] = r->weight[k] * residual[k];
    }
    double rz = dot(r, residual, r->better);
    for (int round = 0; round < MOST && sqrt(dot(r, residual, residual)) > 1e-3 * all; round++) {
        apply(r, p, Ap);
        const double step = rz / dot(r, p, Ap), before = rz;
        for (size_t k = 0; k < r->count; k++) {
            x[k] += step * p[k];
            residual[k] -= step * Ap[k];
            r->better[k] = r->weight[k] * residual[k];
        }
        rz = dot(r, residual, r->better);
        for (size_t k = 0; k < r->count; k++) p[k] = r->better[k] + rz / before * p[k];
    }
}

/* Puts nodes where the solution has them, so many times as far; whether any moves. */
static bool put(const rest *r, double time, double times) {
    gn_fem_solid *b = gn_coupled_solid(r->w);
    const size_t d = (size_t)b->dimension;
    bool any = false;
    set_paths(r, time, r->search);
    for (size_t n = 0; n < b->nodes.soa.count; n++)
        for (size_t a = 0; a < d; a++) {
            const size_t k = d * n + a;
            const double s = r->linear.scale[k];
            const double u = s > 0.0 ? s * r->u[k] : r->search[k];
            any = any || u != 0.0;
            b->nodes.pos[4 * n + a] = b->nodes.start[4 * n + a] + times * u;
        }
    gn_fem_moved(b);
    return any;
}

static double largest(const gn_world *w, const double *excess, size_t *at) {
    *at = 0;
    for (size_t e = 1; e < gn_conversion_elements(w); e++)
        if (excess[e] > excess[*at]) *at = e;
    return gn_conversion_elements(w) ? excess[*at] : 0.0;
}

/* Of displacements, so that turns are small as well. */
static const double small_part = 1e-6;

/* How many times the limit the body is loaded at a time. */
static gneiss_status find_load(rest *r, double time, double *times, gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    size_t at;
    set_load(r, time);
    solve(r);
    const bool any = put(r, time, small_part);
    gneiss_status status = gn_conversion_look_around(r->w, &kind, &excess, error);
    *times = 0.0;
    if (status == GNEISS_OK && any) *times = largest(r->w, excess, &at) / small_part;
    gn_free(kind);
    gn_free(excess);
    return status;
}

/* s: up to when the motions and loads are those of the scene of now. */
static double end_of(const gn_world *w) {
    const gn_stage *e = w->scene.stage_count ? &w->scene.stages[w->stage] : NULL;
    return e && e->time >= 0.0 ? fmin(e->time, w->scene.end) : w->scene.end;
}

/* *time: when a limit is reached first, to a hundredth; INFINITY: not before the end. *at, *times:
 * a time that nodes are solved for, and how many times the limit they are loaded then. */
static gneiss_status find_time(rest *r, double *time, double *at, double *times,
                               gneiss_error *error) {
    enum { LOOKS = 8, HALVINGS = 20 };
    const double end = end_of(r->w);
    double low = 0.0, high = INFINITY;
    for (int k = 0; k <= LOOKS && high == INFINITY; k++) {
        GN_TRY(find_load(r, *at = end * k / LOOKS, times, error));
        *(*times >= 1.0 ? &high : &low) = *at;
    }
    for (int k = 0; k < HALVINGS && high < INFINITY && high - low > 0.01 * high; k++) {
        GN_TRY(find_load(r, *at = 0.5 * (low + high), times, error));
        *(*times >= 1.0 ? &high : &low) = *at;
    }
    *time = high;
    return GNEISS_OK;
}

/* --- what a conversion makes of the step --- */

/* Elements that are loaded to `share` of the most or more go. */
static gneiss_status convert(gn_world *w, double share, gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    size_t at;
    gneiss_status status = gn_conversion_look_around(w, &kind, &excess, error);
    const double most = status == GNEISS_OK ? largest(w, excess, &at) : 0.0;
    for (size_t e = 0; most > 0.0 && e < gn_conversion_elements(w); e++)
        if (kind[e] == GN_FRONT_READY && excess[e] >= share * most) kind[e] = GN_FRONT_LEAVING;
    if (most > 0.0) status = gn_conversion_convert(w, kind, error);
    gn_free(kind);
    gn_free(excess);
    return status;
}

static bool is_near(double a, double b) {
    return a < INFINITY && b < INFINITY && fabs(a - b) <= 1e-3 * b;
}

static const char by_collisions[] = "collisions";

static const char *side_of(const gn_world *w) {
    const double share = gn_world_nonviscous_share(w), elements = gn_elements_stable(w);
    const int32_t p = w->dem.limit.sharp_id;
    if (is_near(w->dt, w->dem.resolution.step)) return by_collisions;
    if (is_near(w->dt, 0.98 * w->dem.listed)) return "contacts that may close";
    if (w->stable < 0.9 * share * fmin(elements, w->dem.stable)) return "slaved spins of the zone";
    if (elements <= w->dem.stable) return "elements that are left, by their rigorous bound";
    return p >= 0 && gn_coupled_has(w->exchange[0].context, p) ? "particles of the zone"
                                                               : "particles";
}

static gneiss_status keep_places(const gn_world *w, gn_foreseen *f, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(w);
    const size_t size = 4 * b->nodes.soa.count;
    f->place = gn_alloc_array_raw(size + 1, sizeof *f->place);
    if (!f->place) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for places of nodes");
    memcpy(f->place, b->nodes.pos, size * sizeof *f->place);
    return GNEISS_OK;
}

/* Of all particles, as if they were awake. */
static gneiss_status find_all(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    gn_resolution collision;
    GN_TRY(gn_conversion_limit(w, &f->all, error));
    gn_conversion_turn_over(w);
    gneiss_status status = gn_resolution_listed(w, &collision, error);
    gn_conversion_turn_over(w);
    f->collision = collision.step;
    return status;
}

gneiss_status gn_conversion_foresee(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    rest r;
    double at = 0.0, times = 0.0;
    *f = (gn_foreseen){.time = INFINITY};
    GN_TRY(find_all(w, f, error));
    gneiss_status status = rest_make(w, &r, error);
    if (status == GNEISS_OK) status = find_time(&r, &f->time, &at, &times, error);
    if (status == GNEISS_OK && times > 0.0)
        put(&r, at, f->time < INFINITY ? 1.001 / times : small_part);
    if (status == GNEISS_OK && times > 0.0) status = keep_places(w, f, error);
    if (status == GNEISS_OK) put(&r, 0.0, 0.0);
    rest_free(&r);
    return status;
}

static void note(const gn_world *w, gn_foreseen_step *s) {
    *s = (gn_foreseen_step){.dt = w->dt, .elements = gn_conversion_elements(w), .side = side_of(w)};
}

/* What a crack wakes on its way are more particles, of which any may be the fastest. */
static void note_grown(const gn_world *w, gn_foreseen *f) {
    const double all = gn_world_nonviscous_share(w) * w->scene.safety * f->all.sharp;
    note(w, &f->grown);
    if (f->grown.dt > f->first.dt) f->grown = f->first; /* it never rises while a run goes on */
    if (w->scene.step > 0.0 || fmin(all, f->collision) >= f->grown.dt) return;
    f->grown.dt = fmin(all, f->collision);
    f->grown.side = all <= f->collision ? "particles" : by_collisions;
}

/* *halt: why the run would end there. A given step that particles do not bear is such a reason. */
static gneiss_status try_first(gn_world *w, const gn_foreseen *f, char *halt, size_t size,
                               gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(w);
    /* Waves may have been faster. */
    if (gn_conversion_begun(w)) return GNEISS_OK;
    memcpy(b->nodes.pos, f->place, 4 * b->nodes.soa.count * sizeof *f->place);
    gn_fem_moved(b);
    gn_fem_to_single(b);
    w->most_loaded.share = 0.0; /* all is to be looked at, however little it is loaded */
    const gneiss_status status = convert(w, 1.0, error);
    snprintf(halt, size, "%.400s", status == GNEISS_ERROR_UNSTABLE ? error->message : w->halt);
    return status == GNEISS_ERROR_UNSTABLE ? GNEISS_OK : status;
}

gneiss_status gn_conversion_try(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    const double more = 0.7;
    GN_TRY(try_first(w, f, f->halt, sizeof f->halt, error));
    if (*f->halt) return GNEISS_OK;
    note(w, &f->first);
    GN_TRY(convert(w, more, error));
    note_grown(w, f);
    *w->halt = '\0';
    return GNEISS_OK;
}

void gn_foreseen_free(gn_foreseen *f) {
    gn_free(f->place);
    f->place = NULL;
}
