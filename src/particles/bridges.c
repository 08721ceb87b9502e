/* Liquid bridges. A pair that touches takes from the film of each particle the share that the other
 * one covers, the cap within the cone that touches it (Shi and McCarthy 2008, Powder Technology
 * 184, 64-75): 1/2 (1 - sqrt(1 - r_j^2/(r_i + r_j)^2)). Kernels ask for bridges and report
 * ruptures; volumes change here, pair by pair in the order of the list, so that no liquid is taken
 * twice. */
#include "particles/bridges.h"

#include "base/ball.h"
#include "frame/frame.h"
#include "kernels/law_scalar.h"
#include "particles/active_pairs.h"
#include "particles/particles.h"

#include "kernels/cohesion.h"

#include <math.h>

double gn_bridge_rupture(const gn_scene *scene) {
    const double factor = 1.0 + 0.5 * scene->contact_angle;
    return factor * factor * factor;
}

static bool is_wet(const gn_step_context *ctx) {
    return ctx->effects & GN_FX_COHESION && ctx->scene.cohesion == GN_COHESION_LIQUID;
}

void gn_bridges_begin(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    if (!is_wet(ctx)) return;
    for (size_t p = 0; p < q->soa.count; p++)
        q->film[p] = ctx->scene.liquid_content *
                     gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
}

static double sum_of_radii(const gn_dem *dem, const gn_contacts *list, size_t c) {
    const double *pos = dem->particles.pos;
    return pos[4 * (size_t)list->i[c] + 3] + pos[4 * (size_t)list->j[c] + 3];
}

/* Covers the rounding of distances. */
static const double more = 1.0 + 1e-6;

static double reach_of(const gn_step_context *ctx, double volume, double radii) {
    return more * cbrt(gn_bridge_rupture(&ctx->scene) * volume) / radii;
}

double gn_bridges_reach(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_contacts *list = &dem->pairs.contacts;
    double most = 0.0;
    if (!(ctx->effects & GN_FX_COHESION)) return 0.0;
    for (size_t c = 0; c < list->soa.count; c++) {
        const double radii = sum_of_radii(dem, list, c);
        most = fmax(most, is_wet(ctx) ? reach_of(ctx, list->bridge[c], radii)
                                      : more * list->span[c] / radii);
    }
    return most;
}

/* Returns the share of the liquid of a particle that a contact takes. */
static double covered(double own, double other) {
    const double sine = other / (own + other);
    return 0.5 * (1.0 - sqrt(1.0 - sine * sine));
}

/* Forms the bridge of pair c; without liquid the pair is marked as dry. Returns the energy that is
 * lost, J. */
static double form(const gn_step_context *ctx, gn_dem *dem, const gn_contacts *list, size_t c,
                   double late) {
    const size_t i = (size_t)list->i[c], j = (size_t)list->j[c];
    const double *pos = dem->particles.pos, ri = pos[4 * i + 3], rj = pos[4 * j + 3];
    double *film = dem->particles.film;
    const double first = covered(ri, rj) * film[i], second = covered(rj, ri) * film[j];
    const double radius = ri * rj / (ri + rj), volume = first + second;
    list->onset[c] = GN_BRIDGE_DRY;
    if (!(volume > 0.0)) return 0.0;
    film[i] -= first;
    film[j] -= second;
    list->bridge[c] = volume;
    list->onset[c] = late;
    dem->verlet.reach = fmax(dem->verlet.reach, reach_of(ctx, volume, ri + rj));
    const double tension = ctx->scene.surface_tension * cos(ctx->scene.contact_angle);
    return -4.0 * M_PI * radius * tension *
           gn_bridge_energy(0.0, 2.0 * radius, volume, gn_bridge_rupture(&ctx->scene));
}

static void rupture(gn_dem *dem, const gn_contacts *list, size_t c) {
    double *film = dem->particles.film, half = 0.5 * list->bridge[c];
    film[list->i[c]] += half;
    film[list->j[c]] += half;
    list->bridge[c] = list->onset[c] = 0.0;
}

double gn_bridges_settle(const gn_step_context *ctx, gn_dem *dem) {
    double lost = 0.0;
    if (!is_wet(ctx) || !dem->done.contacts.wetting) return 0.0;
    for (size_t block = 0; block < dem->pairs.partials.blocks; block++) {
        if (!dem->pairs.sums[block].wetting) continue;
        const gn_contacts part = gn_active_pairs_block(dem, block);
        for (size_t c = 0; c < part.soa.count; c++) {
            const double onset = part.onset[c];
            if (onset == GN_BRIDGE_RUPTURED)
                rupture(dem, &part, c);
            else if (onset < 0.0)
                lost += form(ctx, dem, &part, c, -0.5 - onset);
        }
    }
    return lost;
}

double gn_bridges_form(const gn_step_context *ctx, gn_dem *dem) {
    const gn_contacts *list = &dem->pairs.contacts;
    const double *pos = dem->particles.pos;
    double lost = 0.0;
    if (!is_wet(ctx)) return 0.0;
    gn_active_pairs_repack(ctx, dem);
    for (size_t c = 0; c < list->soa.count; c++) {
        double n[3], radii = sum_of_radii(dem, list, c);
        if (list->bridge[c] > 0.0) continue;
        if (gn_branch(ctx, pos + 4 * (size_t)list->i[c], pos + 4 * (size_t)list->j[c], n) <
            radii * radii)
            lost += form(ctx, dem, list, c, 0.0);
    }
    return lost;
}

gn_liquid gn_bridges_sum(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_contacts *list = &dem->pairs.contacts;
    gn_liquid sum = {0};
    if (!is_wet(ctx)) return sum;
    gn_active_pairs_settle(ctx, dem);
    for (size_t c = 0; c < list->soa.count; c++) {
        sum.bridges += list->bridge[c] > 0.0;
        sum.bridged += list->bridge[c];
    }
    for (size_t p = 0; p < dem->particles.soa.count; p++) sum.films += dem->particles.film[p];
    return sum;
}
