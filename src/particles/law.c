/* Contact laws (kernels/law.h) applied to the particles of a world. */
#include "particles/law.h"
#include "base/error.h"
#include "base/new.h"
#include "frame/frame.h"
#include "neigh/neigh.h"
#include "particles/body_springs.h"
#include "particles/bond_sections.h"
#include "particles/expected_overlap.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "scene/sides.h"
#include "soa/field.h"
#include "soa/records.h"

#include <math.h>

double gn_restitution_fraction(double restitution) {
    if (restitution >= 1.0) return 0.0;
    if (restitution == 0.0)
        return 1.0; /* critical damping: the contact closes and does not rebound */
    double l = log(restitution);
    return -l / sqrt(M_PI * M_PI + l * l);
}

double gn_contact_damping_fraction(const gn_scene *scene) {
    return scene->restitution < 0.0 ? scene->damping_fraction
                                    : gn_restitution_fraction(scene->restitution);
}

gneiss_status gn_hertz_renew(const gn_step_context *ctx, gn_dem *dem, gn_hertz_pair **before,
                             gneiss_error *error) {
    *before = dem->hertz;
    dem->hertz = NULL;
    dem->damping_fraction = gn_contact_damping_fraction(&ctx->scene);
    return gn_hertz_prepare(ctx, dem, error);
}

/* Computes the parameters of all pairs of materials that may come into contact. */
gneiss_status gn_hertz_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    size_t sides = gn_scene_sides(s), count = s->material_count;
    dem->damping_least = dem->damping_fraction;
    if (!(ctx->effects & GN_FX_HERTZ)) return GNEISS_OK;
    gn_free(dem->hertz);
    GN_TRY(gn_new(&dem->hertz, count * sides, "walls", error));
    double most = 0.0, least = INFINITY;
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < count + sides; b++) {
            gn_scene_surface side = {.material = ""};
            if (b >= count) side = gn_scene_surface_at(s, b - count);
            const gn_material *m = &s->materials[a], *other = b < count ? &s->materials[b] : NULL;
            if (*side.material) other = &s->materials[gn_scene_find_material(s, side.material)];
            gn_hertz_pair pair =
                gn_hertz_pair_of(s, m, other, other ? gn_scene_find_contact(s, m, other) : NULL);
            if (!other) pair.friction = side.friction;
            if (b >= count) dem->hertz[a * sides + b - count] = pair;
            most = fmax(most, pair.damping);
            least = fmin(least, pair.damping);
        }
    dem->damping_fraction = fmax(0.5 * most, gn_body_damping_most(s));
    dem->damping_least = 0.5 * least;
    return GNEISS_OK;
}

double gn_inverse_mass_along(const gn_dem *dem, size_t p, const double n[3]) {
    double inverse = dem->particles.vel[4 * p + 3];
    int32_t slot = dem->prescribed.count ? dem->particles.slot[p] : -1;
    return slot < 0 ? inverse : gn_free_share(dem->prescribed.mask[slot], n) * inverse;
}

/* Returns the inverse mass of a particle. If elements share its mass, its whole mass counts,
 * because its contacts are weighted as a whole. */
static double own_inverse_along(const gn_dem *dem, size_t p, const double n[3]) {
    const double *blend = dem->particles.blend;
    return gn_inverse_mass_along(dem, p, n) * (blend ? blend[2 * p + 1] : 1.0);
}

/* Returns the inverse mass of a pair along the present line between its centres. */
static double pair_inverse_mass(const gn_step_context *ctx, const gn_dem *dem, int32_t i,
                                int32_t j) {
    const double *pos = dem->particles.pos;
    double n[3], length2 = gn_branch(ctx, pos + 4 * (int64_t)i, pos + 4 * (int64_t)j, n);
    double scale = length2 > 0.0 ? 1.0 / sqrt(length2) : 0.0;
    for (int a = 0; a < 3; a++) n[a] *= scale;
    return own_inverse_along(dem, (size_t)i, n) + own_inverse_along(dem, (size_t)j, n);
}

static gn_law_model model_of(const gn_step_context *ctx, const gn_dem *dem) {
    return (gn_law_model){&ctx->scene, dem->derived, dem->damping_fraction, ctx->dt};
}

static gn_law_pair pair_of(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j) {
    const gn_particles *q = &dem->particles;
    const gn_material *a = &ctx->scene.materials[q->material[i]],
                      *b = &ctx->scene.materials[q->material[j]];
    return (gn_law_pair){
        .a = a,
        .b = b,
        .ri = q->pos[4 * (int64_t)i + 3],
        .rj = q->pos[4 * (int64_t)j + 3],
        .inverse_mass = dem->damping_fraction > 0.0 ? pair_inverse_mass(ctx, dem, i, j) : 0.0,
        .own = ctx->scene.contact_count ? gn_scene_find_contact(&ctx->scene, a, b) : NULL};
}

/* Returns the random seed of a bond, from the ids of its ends, so that neither the order nor the
 * number of threads matters. */
static uint64_t seed_of(const gn_dem *dem, int32_t i, int32_t j) {
    uint64_t a = (uint64_t)dem->particles.id[i], b = (uint64_t)dem->particles.id[j];
    return 1 + (a < b ? a << 32 | b : b << 32 | a);
}

static gn_law_pair pair_of_contact(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_contacts *list, size_t c) {
    gn_law_pair pair = pair_of(ctx, dem, list->i[c], list->j[c]);
    if (!list->rn) return pair;
    pair.area = list->area ? list->area[c] : 0.0;
    pair.length = list->length0[c];
    pair.draw_id = seed_of(dem, list->i[c], list->j[c]);
    return pair;
}

/* Returns the weight of a contact where elements occupy the same space: the mean of the weights of
 * both ends. A bond between two particles of weight zero keeps a tiny weight, so that it remains a
 * bond. */
static double part_of(const gn_dem *dem, const gn_contacts *list, size_t c) {
    const double *blend = dem->particles.blend;
    if (!blend) return 1.0;
    return fmax(0.5 * (blend[2 * (size_t)list->i[c]] + blend[2 * (size_t)list->j[c]]), 1e-9);
}

void gn_contact_set(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list, size_t c) {
    gn_law_model model = model_of(ctx, dem);
    gn_law_pair pair = pair_of_contact(ctx, dem, list, c);
    const gn_law *law = gn_law_of(list->soa.effects);
    const double part = part_of(dem, list, c);
    law->set(&model, &pair, list, c);
    if (part != 1.0) law->weigh(list, c, part);
}

/* Returns the given area of a contact; without one, laws by area use that of an unbonded pair. */
static double area_of(const gn_step_context *ctx, const gn_dem *dem, const gn_law *law,
                      const gn_law_pair *pair, double overlap) {
    gn_law_model model = model_of(ctx, dem);
    return law->area ? law->area(pair, overlap) : gn_linear_section(&model, pair);
}

double gn_contact_area(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c, double overlap) {
    gn_law_pair pair = pair_of_contact(ctx, dem, list, c);
    return area_of(ctx, dem, gn_law_of(list->soa.effects), &pair, overlap);
}

double gn_touch_area(const gn_step_context *ctx, const gn_dem *dem, size_t particle,
                     double overlap) {
    const gn_law *law = gn_law_of(gn_contact_list_effects(ctx->effects, false));
    gn_law_pair pair = pair_of(ctx, dem, (int32_t)particle, (int32_t)particle);
    if (law->area) pair.rj = INFINITY;
    return area_of(ctx, dem, law, &pair, overlap);
}

/* A plane with normal e cuts the area sum A L |n.e|/V of bonds per area of the plane; the mean of
 * |n.e| over all directions is 1/2, in 2D 2/pi. */
double gn_law_cut(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_contacts *b = &dem->bonds.contacts;
    gn_law_model model = model_of(ctx, dem);
    double sum = 0.0;
    for (size_t c = 0; c < b->soa.count; c++) {
        if (b->cause[c] != GN_INTACT) continue;
        gn_law_pair pair = pair_of_contact(ctx, dem, b, c);
        sum += gn_linear_section(&model, &pair) * b->length0[c];
    }
    return sum / ctx->volume * (ctx->effects & GN_FX_SPACE ? 0.5 : 2.0 / M_PI);
}

void gn_contacts_set_dashpots(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list) {
    const gn_law *law = gn_law_of(list->soa.effects);
    gn_law_model model = model_of(ctx, dem);
    for (size_t c = 0; c < list->soa.count; c++) {
        gn_law_pair pair = pair_of_contact(ctx, dem, list, c);
        law->set_dashpot(&model, &pair, list, c);
        if (dem->particles.blend && list->cn) list->cn[c] *= part_of(dem, list, c);
        if (dem->particles.blend && list->cn_f) list->cn_f[c] = (float)list->cn[c];
    }
}

/* Takes new parameters except damage, which also reduces the strengths of a bond; those of a broken
 * bond are negative. */
static void take(gn_contacts *list, const gn_contacts *now, size_t c) {
    if (list->mu) list->mu[c] = now->mu[c];
    if (list->adhesion) list->adhesion[c] = now->adhesion[c];
    if (list->span) list->span[c] = now->span[c];
    if (list->rolling) list->rolling[c] = now->rolling[c];
    if (list->twisting) list->twisting[c] = now->twisting[c];
    if (list->cause && !(list->kn[c] > 0.0)) return; /* released with a removed particle */
    list->kn[c] = now->kn[c];
    if (list->kt) list->kt[c] = now->kt[c];
    if (list->kappa) { /* strengths are those of the former materials, reduced by damage */
        double kappa = list->kappa[c], last = list->mu ? list->mu[c] : 0.0;
        list->mu1[c] = (1.0 - kappa) * now->mu1[c] + kappa * last;
        return;
    }
    if (list->mu1) list->mu1[c] = now->mu1[c];
    if (list->rt) list->rt[c] = now->rt[c];
    if (list->rn) list->rn[c] = copysign(now->rn[c], list->rn[c]);
}

gneiss_status gn_contacts_take_materials(const gn_step_context *ctx, const gn_dem *dem,
                                         gn_contacts *list, gneiss_error *error) {
    gn_contacts now = {0};
    GN_TRY(gn_soa_copy(&gn_contact_record, &now, list, list->soa.effects, error));
    for (size_t c = 0; c < list->soa.count; c++) {
        gn_contact_set(ctx, dem, &now, c);
        take(list, &now, c);
    }
    gn_soa_destroy(&gn_contact_record, &now);
    return GNEISS_OK;
}

gn_law_spring gn_pair_spring(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j) {
    gn_law_model model = model_of(ctx, dem);
    gn_law_pair pair = pair_of(ctx, dem, i, j);
    const gn_law *law = gn_law_of(gn_contact_list_effects(ctx->effects, false));
    double reach = dem->verlet.skin;
    if (ctx->effects & GN_FX_HERTZ) {
        const gn_hertz_pair p = gn_hertz_pair_of(&ctx->scene, pair.a, pair.b, pair.own);
        reach = gn_pressed_meeting(
            ctx, dem, (size_t)i, (size_t)j, law->meeting(&model, &pair, 1.0).kn,
            gn_sudden_pull(p.cohesion, p.adhesion, pair.ri * pair.rj / (pair.ri + pair.rj)));
    }
    return law->meeting(&model, &pair, reach); // cppcheck-suppress returnDanglingLifetime
}

gn_law_spring gn_contact_spring(const gn_dem *dem, const gn_contacts *list, size_t c) {
    return gn_law_of(list->soa.effects)->spring(list, c, dem->verlet.skin);
}

gneiss_status gn_law_derive(const gn_step_context *ctx, gn_dem *dem, const gn_pair_list *pairs,
                            gneiss_error *error) {
    const int32_t(*pair)[2] = (const int32_t(*)[2])pairs->pair;
    if (gn_law_of(ctx->effects)
            ->derive(&ctx->scene, &dem->particles, pair, pairs->count, &dem->derived))
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected contacts to average over, found none between the "
                   "particles of the specimen",
                   gn_scene_at(&ctx->scene, ctx->scene.law_where, "law.stiffness").text);
}
