/* Readings of zones during a run. */
#include "base/ball.h"
#include "base/error.h"
#include "base/memory.h"
#include "couple/zone.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/dormant.h"
#include "particles/particles.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>

/* Adds the stress of dormant particles, which elements carry completely. */
static bool add_to_dormant(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                           const double (*stress)[6], double *sigma) {
    const bool space = ctx->scene.dimension == 3;
    int32_t *place = gn_element_places(ctx, solids);
    for (size_t p = 0; place && p < dem->particles.soa.count; p++)
        for (int c = 0; c < 6 && gn_is_dormant(dem, p); c++)
            if (space || c < 2 || c == 3)
                sigma[6 * p + (size_t)c] = stress[place[gn_dormant_element(dem, p)]][c];
    const bool held = place || !gn_converts(ctx);
    gn_free(place);
    return held;
}

/* The contacts of a particle in a zone carry its share of the body's stress, and elements carry the
 * rest. In plane strain elements have an out-of-plane stress, contacts do not. */
gneiss_status gn_coupled_add_stress(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_zones *zones, double *sigma,
                                    gneiss_error *error) {
    const gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    if (!q) return GNEISS_OK;
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const bool space = b->dimension == 3;
    double(*stress)[6] = gn_alloc_array(b->elements.soa.count + 1, sizeof *stress);
    if (!stress)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stress of %zu elements",
                       b->elements.soa.count);
    gn_fem_element_stress(b, stress);
    for (size_t k = 0; k < q->ties.count; k++) {
        if (q->place[k] < 0) continue;
        const size_t p = (size_t)q->place[k];
        const double share = 1.0 - dem->particles.blend[2 * p];
        for (int c = 0; c < 6; c++)
            if (space || c < 2 || c == 3)
                sigma[6 * p + (size_t)c] += share * stress[q->ties.tie[k].element][c];
    }
    const bool held = add_to_dormant(ctx, dem, solids, (const double(*)[6])stress, sigma);
    gn_free(stress);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stress of particles");
}

/* Returns for each particle the index of the element that contains it, among the remaining
 * elements; -1: none. */
static int32_t *elements_of(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_zones *zones) {
    const gn_coupled *q = zones->coupled;
    const size_t n = dem->particles.soa.count;
    int32_t *place = gn_element_places(ctx, solids);
    int32_t *element = gn_alloc_array(n + 1, sizeof *element);
    if (element && (place || !gn_converts(ctx))) {
        for (size_t p = 0; p < n; p++) element[p] = place ? place[gn_dormant_element(dem, p)] : -1;
        for (size_t k = 0; k < q->ties.count; k++)
            if (q->place[k] >= 0) element[q->place[k]] = q->ties.tie[k].element;
    } else {
        gn_free(element);
        element = NULL;
    }
    gn_free(place);
    return element;
}

gneiss_status gn_coupled_mean_stress(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_solids *solids, const gn_zones *zones,
                                     double sigma[9], gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const int row[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    int32_t *element = elements_of(ctx, dem, solids, zones);
    double(*stress)[6] = gn_alloc_array(b->elements.soa.count + 1, sizeof *stress);
    double volume = 0.0;
    const bool held = element && stress;
    for (int k = 0; k < 9; k++) sigma[k] = 0.0;
    if (held) gn_fem_element_stress(b, stress);
    for (size_t p = 0; held && p < q->soa.count; p++) {
        const double own = gn_ball_volume(b->dimension, q->pos[4 * p + 3]);
        volume += own;
        if (element[p] < 0) continue;
        for (int a = 0; a < b->dimension; a++)
            for (int c = 0; c < b->dimension; c++)
                sigma[3 * a + c] += (1.0 - q->blend[2 * p]) * own * stress[element[p]][row[a][c]];
    }
    for (int k = 0; held && k < 9; k++) sigma[k] /= volume;
    gn_free(element);
    gn_free(stress);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the mean stress of elements");
}

size_t gn_coupled_removed_count(const gn_step_context *ctx, const gn_zones *zones) {
    const gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    size_t count = 0;
    for (size_t k = 0; q && k < q->ties.count; k++) count += q->place[k] < 0;
    return count;
}

/* Returns the energy in an element, J. Displacements are evaluated half a step earlier, at the
 * instant of the velocities; velocities are weighted means over the nodes at the point where the
 * strain along n is evaluated. */
static double returned(const gn_fem_solid *b, size_t e, const double n[3], double back) {
    const gn_elements *q = &b->elements;
    double speed = 0.0, strain = 0.0, slope[4] = {0.0}, size = 0.0;
    for (int a = 1; a <= b->dimension; a++)
        for (int k = 0; k < b->dimension; k++) slope[a] += gn_elements_gradient(q, a, k)[e] * n[k];
    for (int a = 1; a <= b->dimension; a++) slope[0] -= slope[a];
    for (int a = 0; a <= b->dimension; a++) size += fabs(slope[a]);
    for (int a = 0; a <= b->dimension; a++) {
        const size_t at = 4 * (size_t)gn_elements_node(q, a)[e];
        for (size_t k = 0; k < (size_t)b->dimension; k++) {
            double v = b->nodes.vel[at + k];
            speed += fabs(slope[a]) / size * v * n[k];
            strain += slope[a] * (b->nodes.pos[at + k] - b->nodes.start[at + k] - back * v) * n[k];
        }
    }
    double density = b->density[q->material[e]];
    double c = sqrt((q->lambda[e] + 2.0 * q->mu[e]) / density), wave = 0.5 * (speed + c * strain);
    return density * q->volume[e] * wave * wave;
}

double gn_coupled_returned(const gn_step_context *ctx, const gn_solids *solids, size_t k) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    double n[3], sum = 0.0;
    gn_zone_direction(&ctx->scene.couple.zones[k], b->dimension, n);
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        bool whole = true;
        for (int a = 0; a <= b->dimension; a++) {
            const double *x = b->nodes.start + 4 * (size_t)gn_elements_node(&b->elements, a)[e];
            whole = whole && gn_zones_share(&ctx->scene, x) >= 1.0 - GN_ZONE_ROUNDING;
        }
        if (whole) sum += returned(b, e, n, 0.5 * ctx->dt_past);
    }
    return sum;
}

double gn_coupled_returned_share(const gn_step_context *ctx, const gn_solids *solids,
                                 const gn_ledger *ledger, size_t k) {
    const gn_energy *e = &ledger->reading;
    const double there = e->stored_at_start + fabs(e->work_prescribed) + fabs(e->work_applied) +
                         fabs(e->work_gravity) + fabs(e->work_walls);
    const double least = 1e-3 * e->passed; /* far above rounding */
    return there > least ? gn_coupled_returned(ctx, solids, k) / there : NAN;
}
