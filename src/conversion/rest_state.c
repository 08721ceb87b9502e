#include "conversion/rest_state.h"

#include "base/eigen.h"
#include "base/error.h"
#include "base/memory.h"
#include "conversion/conversion.h"
#include "conversion/load_course.h"
#include "couple/front.h"
#include "fem/linear.h"
#include "fem/solid.h"
#include "scene/couple_def.h"
#include "scene/scene.h"
#include "solids/elements.h"
#include "world/world.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

void gn_rest_free(gn_rest *r) {
    void *blocks[] = {r->u, r->load, r->weight, r->residual, r->search, r->image, r->better};
    gn_fem_linear_free(&r->linear);
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
}

/* The time of a run is long beside its waves; where it is not, inertia is what holds. */
gneiss_status gn_rest_make(gn_world *w, const gn_course *course, gn_rest *r, gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(&w->solids);
    const size_t d = (size_t)b->dimension, nodes = b->nodes.soa.count;
    *r = (gn_rest){.w = w,
                   .course = *course,
                   .count = d * nodes,
                   .inertia = 1.0 / (w->ctx.scene.end * w->ctx.scene.end)};
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
static double path_of(const gn_rest *r, int32_t motion, size_t a, size_t part, double time) {
    const gn_element_model *q = r->w->solids.elements[0];
    for (size_t k = 0; k < q->def->motion_count; k++)
        if (q->motion[k] == motion) return gn_course_path(&r->course, part, k, a, time);
    return 0.0;
}

/* [count] m of what is driven, 0 of what is free. */
static void set_paths(const gn_rest *r, size_t part, double time, double *path) {
    const gn_fem_solid *b = &r->w->solids.elements[0]->solid;
    const size_t d = (size_t)b->dimension;
    memset(path, 0, r->count * sizeof *path);
    for (size_t n = 0; b->prescribed.count && n < b->nodes.soa.count; n++) {
        const int32_t slot = b->nodes.slot[n];
        for (size_t a = 0; slot >= 0 && a < d; a++)
            if (b->channel[slot][a] >= 0)
                path[d * n + a] = path_of(r, b->channel[slot][a], a, part, time);
    }
}

/* Loads of a part on the nodes, which the world has of its own stage and time. */
static void set_applied(const gn_rest *r, size_t part, double time) {
    gn_element_model *q = r->w->solids.elements[0];
    const gn_element_def *own = q->def;
    q->def = &r->course.part[part].scene->elements;
    gn_elements_set_loads(q, time);
    q->def = own;
}

/* What loads, gravity and driven nodes do to those that are free. */
static void set_load(gn_rest *r, size_t part, double time) {
    gn_fem_solid *b = gn_coupled_solid(&r->w->solids);
    double *scale = r->linear.scale;
    const size_t d = (size_t)b->dimension;
    const double *gravity = r->course.part[part].scene->gravity;
    set_applied(r, part, time);
    set_paths(r, part, time, r->search);
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
                r->unloaded ? 0.0
                            : b->nodes.applied[4 * n + a] + gravity[a] / b->nodes.vel[4 * n + 3];
            r->load[k] = scale[k] > 0.0 ? scale[k] * force - r->image[k] : 0.0;
        }
    gn_elements_set_loads(r->w->solids.elements[0], r->w->ctx.time);
}

static double dot(const gn_rest *r, const double *x, const double *y) {
    return gn_eigen_dot(r->count, x, y, r->w->ctx.threads);
}

static void apply(const gn_rest *r, const double *x, double *out) {
    gn_fem_linear_apply(&r->linear, x, out);
    for (size_t k = 0; k < r->count; k++) out[k] += r->inertia * x[k];
}

/* Conjugate gradients from the multiple of the last solution that is nearest, which is the solution
 * where loads only grow, until what is left is a part of the load. */
static void solve(gn_rest *r, double left) {
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
    for (int round = 0; round < MOST && sqrt(dot(r, residual, residual)) > left * all; round++) {
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
bool gn_rest_put(const gn_rest *r, double times) {
    gn_fem_solid *b = gn_coupled_solid(&r->w->solids);
    const size_t d = (size_t)b->dimension;
    bool any = false;
    set_paths(r, r->at, r->time, r->search);
    for (size_t n = 0; n < b->nodes.soa.count; n++)
        for (size_t a = 0; a < d; a++) {
            const size_t k = d * n + a;
            const double s = r->linear.scale[k];
            const double u = s > 0.0 ? s * r->u[k] : r->search[k];
            any = any || u != 0.0;
            b->nodes.pos[4 * n + a] = b->nodes.start[4 * n + a] + times * u;
        }
    gn_fem_positions_changed(b);
    return any;
}

void gn_rest_find(gn_rest *r, size_t part, double time) {
    r->at = part;
    r->time = time;
    set_load(r, part, time);
    solve(r, 1e-3); /* enough to see where stresses are largest */
}

/* --- waves --- */

double gn_wave_travel(const gn_step_context *ctx, const gn_solids *solids) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    double slow2 = INFINITY;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        const double l = b->elements.lambda[e], m = b->elements.mu[e];
        slow2 =
            fmin(slow2, m * (3.0 * l + 2.0 * m) / (l + m) / b->density[b->elements.material[e]]);
    }
    return gn_elements_longest_side(ctx, solids) / sqrt(slow2);
}

double gn_rest_period(gn_rest *r) {
    const double pi = 3.14159265358979323846;
    double rate2 = 0.0;
    for (int round = 0; round < 3; round++) {
        const double size = sqrt(dot(r, r->u, r->u));
        if (!(size > 0.0)) return 0.0;
        for (size_t k = 0; k < r->count; k++) r->load[k] = r->u[k] / size;
        solve(r, 1e-3);
        rate2 = dot(r, r->u, r->load) / dot(r, r->u, r->u) - r->inertia;
    }
    return rate2 > 3.0 * r->inertia ? 2.0 * pi / sqrt(rate2)
                                    : 2.0 * gn_wave_travel(&r->w->ctx, &r->w->solids);
}

gneiss_status gn_rest_burst(const gn_rest *r, double *times, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(&r->w->solids);
    const double speed = gn_course_jump(&r->course, gn_wave_travel(&r->w->ctx, &r->w->solids));
    uint8_t *kind = gn_alloc(b->elements.soa.count + 1);
    *times = 0.0;
    if (!kind) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at elements");
    gneiss_status status = gn_conversion_kinds(&r->w->ctx, &r->w->solids, kind, error);
    for (size_t e = 0; status == GNEISS_OK && e < b->elements.soa.count; e++) {
        const double l = b->elements.lambda[e], confined = l + 2.0 * b->elements.mu[e];
        const double stress = sqrt(confined * b->density[b->elements.material[e]]) * speed;
        const double across = l / confined * stress;
        const double pull[6] = {stress, across, across}, press[6] = {-stress, -across, -across};
        const gn_convert_def *def = &r->w->ctx.scene.couple.convert;
        if (kind[e] != GN_FRONT_READY) continue;
        *times = fmax(*times, gn_front_excess_above(def, pull, 0.0));
        *times = fmax(*times, gn_front_excess_above(def, press, 0.0));
    }
    gn_free(kind);
    return status;
}
