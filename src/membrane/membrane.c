/* The membrane in a step: the mean motion of its skin, and the forces. Everything follows from the
 * state, so that a resumed run has the same bits. */
#include "membrane/membrane.h"

#include "base/eigen.h"
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/laboratory.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* Number of steps between searches for detached particles, which are also updates of the local
 * motion of the skin. */
enum { LOOK_INTERVAL = 100, ALL = -1 };

double gn_membrane_pressure_now(const gn_step_context *ctx, const gn_membrane *membrane) {
    const gn_membrane_state *m = membrane->state;
    const double ramp = ctx->scene.membrane.ramp;
    if (!(ctx->effects & GN_FX_MEMBRANE)) return 0.0;
    const double past = ctx->time - m->since, share = past < ramp ? past / ramp : 1.0;
    return m->from + share * (gn_table_at(&ctx->scene.membrane.pressure, ctx->time) - m->from);
}

void gn_membrane_enter(const gn_step_context *ctx, gn_membrane *membrane, size_t stage,
                       double pressure) {
    if (!(ctx->effects & GN_FX_MEMBRANE) || ctx->scene.membrane_stage != stage + 1) return;
    membrane->state->from = pressure;
    membrane->state->since = ctx->time;
}

double gn_membrane_pressure(const gn_membrane *membrane) {
    return membrane->state ? membrane->state->pressure : 0.0;
}

int32_t gn_patch_bearer(const gn_dem *d, const gn_patch *patch) {
    return patch->owner >= 0 ? d->index_of_id[patch->owner] : -1;
}

double gn_membrane_area_of(const gn_dem *dem, gn_skin_body body) {
    const gn_particles *q = &dem->particles;
    double sum = 0.0;
    for (size_t p = 0; q->skin && p < q->soa.count; p++)
        if (gn_is_loaded_of(q, body, p)) sum += q->skin[4 * p + 3];
    return sum;
}

double gn_membrane_area(const gn_dem *dem) {
    return gn_membrane_area_of(dem, (gn_skin_body){0});
}

double gn_membrane_volume(const gn_step_context *ctx, const gn_membrane *membrane) {
    const double enclosed = membrane->state ? membrane->state->enclosed : 0.0;
    return enclosed > 0.0 ? enclosed : ctx->volume;
}

void gn_membrane_stress(const gn_step_context *ctx, const gn_membrane *membrane, double volume,
                        double stress[9]) {
    double turn[9], half[9], arms[9];
    if (!(ctx->effects & GN_FX_MEMBRANE)) return;
    const gn_membrane_state *m = membrane->state;
    gn_cofactor3(m->gradient, turn);
    gn_product3(turn, m->arms, half);
    gn_product3_bt(half, m->gradient, arms);
    for (int k = 0; k < 9; k++) stress[k] -= m->pressure * arms[k] / volume;
}

/* --- matrices --- */

void gn_cofactor3(const double a[9], double c[9]) {
    gn_cross3(a + 3, a + 6, c);
    gn_cross3(a + 6, a, c + 3);
    gn_cross3(a, a + 3, c + 6);
}

void gn_product3(const double a[9], const double b[9], double r[9]) {
    for (int k = 0; k < 9; k++) {
        const double *row = a + k / 3 * 3, *column = b + k % 3;
        r[k] = row[0] * column[0] + row[1] * column[3] + row[2] * column[6];
    }
}

void gn_product3_bt(const double a[9], const double b[9], double r[9]) {
    for (int k = 0; k < 9; k++) r[k] = gn_dot3(a + k / 3 * 3, b + k % 3 * 3);
}

void gn_product3_at(const double a[9], const double b[9], double r[9]) {
    const double turned[9] = {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
    gn_product3(turned, b, r);
}

/* --- the deformation --- */

void gn_gradient_add(gn_gradient_fit *f, double weight, const double from[3], const double to[3]) {
    f->sum += weight;
    for (int a = 0; a < 3; a++) {
        f->from[a] += weight * from[a];
        f->to[a] += weight * to[a];
        for (int b = 0; b < 3; b++) {
            f->moved[3 * a + b] += weight * to[a] * from[b];
            f->spread[3 * a + b] += weight * from[a] * from[b];
        }
    }
}

double gn_gradient_spread(const gn_gradient_fit *f) {
    double spread[9], values[3], vectors[9];
    const int d = f->dimension;
    if (!(f->sum > 0.0)) return 0.0;
    for (int k = 0; k < d * d; k++)
        spread[k] = f->spread[k / d * 3 + k % d] - f->from[k / d] * f->from[k % d] / f->sum;
    gn_eigen_symmetric(d, spread, values, vectors);
    return values[d - 1];
}

/* F = sum(x X) sum(X X)^-1, relative to the means. */
bool gn_gradient_of(const gn_gradient_fit *f, double gradient[9]) {
    double moved[9], spread[9], cofactor[9], size = 0.0;
    for (int k = 0; k < 9; k++) gradient[k] = k % 4 == 0;
    if (!(f->sum > 0.0)) return false;
    for (int k = 0; k < 9; k++) {
        moved[k] = f->moved[k] - f->to[k / 3] * f->from[k % 3] / f->sum;
        spread[k] = f->spread[k] - f->from[k / 3] * f->from[k % 3] / f->sum;
    }
    for (int a = 0; a < f->dimension; a++) size = fmax(size, spread[4 * a]);
    if (f->dimension == 2) {
        moved[8] = spread[8] = size;
        moved[2] = moved[5] = moved[6] = moved[7] = 0.0;
        spread[2] = spread[5] = spread[6] = spread[7] = 0.0;
    }
    gn_cofactor3(spread, cofactor);
    double det = gn_dot3(spread, cofactor);
    if (!(det > 1e-9 * size * size * size)) return false;
    gn_product3(moved, cofactor, gradient); /* symmetric, because `spread` is */
    for (int k = 0; k < 9; k++) gradient[k] /= det;
    return true;
}

/* Fits the deformation of a body, or of all bodies, relative to one particle of the skin, so that
 * no digits are lost if the origin is distant. */
static void fit_skin(const gn_step_context *ctx, const gn_dem *dem, const gn_membrane *membrane,
                     int32_t body, double gradient[9]) {
    const gn_particles *q = &dem->particles;
    gn_gradient_fit fit = {.dimension = (int)ctx->scene.dimension};
    const double *base = NULL, *start = NULL;
    for (size_t p = 0; p < q->soa.count; p++) {
        double from[3], to[3];
        if (!gn_is_loaded(q, p) || (body != ALL && membrane->skin_body[p] != body)) continue;
        if (!base) base = q->pos + 4 * p, start = q->start + 4 * p;
        for (int a = 0; a < 3; a++) {
            from[a] = q->start[4 * p + a] - start[a];
            to[a] = q->pos[4 * p + a] - base[a];
        }
        gn_gradient_add(&fit, 1.0, from, to);
    }
    gn_gradient_of(&fit, gradient);
}

/* Finds the body of each particle. Bodies are stored with the patches, whose order does not change.
 */
static gneiss_status list_bodies(gn_dem *dem, gn_membrane *membrane, size_t bodies,
                                 gneiss_error *error) {
    gn_dem *d = dem;
    gn_free(membrane->skin_gradient);
    gn_free(membrane->skin_body);
    GN_TRY(gn_new(&membrane->skin_gradient, bodies, "the bodies of a skin", error));
    GN_TRY(gn_new(&membrane->skin_body, d->particles.soa.count + 1, "the bodies of a skin", error));
    for (size_t k = 0; k < membrane->patch_count; k++) {
        const int32_t p = gn_patch_bearer(d, &membrane->patches[k]);
        if (p >= 0) membrane->skin_body[p] = membrane->patches[k].body;
    }
    return GNEISS_OK;
}

gneiss_status gn_membrane_fit_bodies(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                     gneiss_error *error) {
    const size_t bodies = (size_t)membrane->state->bodies;
    if (bodies < 2 || !ctx->scene.membrane.follow) return GNEISS_OK;
    GN_TRY(list_bodies(dem, membrane, bodies, error));
    for (size_t b = 0; b < bodies; b++)
        fit_skin(ctx, dem, membrane, (int32_t)b, membrane->skin_gradient[b]);
    return GNEISS_OK;
}

const double *gn_membrane_gradient_at(const gn_step_context *ctx, const gn_membrane *membrane,
                                      size_t p) {
    const bool several = membrane->state->bodies > 1 && ctx->scene.membrane.follow;
    return several ? membrane->skin_gradient[membrane->skin_body[p]] : membrane->state->gradient;
}

void gn_membrane_free(gn_membrane *membrane) {
    gn_free(membrane->state);
    gn_free(membrane->skin_gradient);
    gn_free(membrane->skin_body);
    gn_free(membrane->patches);
}

/* --- forces --- */

gneiss_status gn_membrane_apply(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                gneiss_error *error) {
    gn_particles *q = &dem->particles;
    const gn_membrane_def *m = &ctx->scene.membrane;
    double turn[9];
    if (!(ctx->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    const double pressure = gn_membrane_pressure_now(ctx, membrane);
    membrane->state->pressure = pressure;
    const bool look = ctx->step % LOOK_INTERVAL == 0;
    bool dropped = false;
    if (look) GN_TRY(gn_membrane_detach(ctx, dem, membrane, &dropped, error));
    /* Several bodies have no common deformation, so that they are updated separately. */
    if (m->follow && (look || membrane->state->bodies == 1))
        fit_skin(ctx, dem, membrane, ALL, membrane->state->gradient);
    if (look) GN_TRY(gn_membrane_update_areas(ctx, dem, membrane, dropped, error));
    if (!look) GN_TRY(gn_membrane_fit_bodies(ctx, dem, membrane, error));
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_loaded(q, p)) continue;
        gn_cofactor3(gn_membrane_gradient_at(ctx, membrane, p), turn);
        for (int a = 0; a < 3; a++) q->applied[4 * p + a] = gn_dot3(turn + 3 * a, q->skin + 4 * p);
    }
    /* Also needed between updates, because a motion that differs from the mean one would exert a
     * moment on the skin. */
    if (m->follow && membrane->state->bodies == 1)
        gn_membrane_rebalance(ctx, dem, membrane, q->applied);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3 && gn_is_loaded(q, p); a++)
            q->applied[4 * p + a] = q->load[4 * p + a] - pressure * q->applied[4 * p + a];
    return GNEISS_OK;
}
