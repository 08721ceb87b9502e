/* Evaluates the contacts at the present positions, for output. */
#include "particles/observe.h"
#include "base/ball.h"
#include "base/effects.h"
#include "base/error.h"
#include "frame/frame.h"
#include "kernels/dispatch.h"
#include "kernels/partials.h"
#include "particles/active_pairs.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "soa/field.h"
#include "soa/records.h"
#include "soa/single.h"

gneiss_status gn_contacts_evaluate(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_periodic_box *box, const gn_contacts *list,
                                   const gn_partials *partials, gn_contacts *copy,
                                   gneiss_error *error) {
    gn_active_pairs_settle(ctx, dem);
    gn_effects effects = (list->soa.effects & ~(gn_effects)GN_FX_MIXED) | GN_FX_CONTACT_FORCES;
    gn_contact_kernel *kernel;
    GN_TRY(gn_contact_kernel_choose(ctx->kernels, effects, &kernel, error));
    GN_TRY(gn_soa_copy(&gn_contact_record, copy, list, effects, error));
    gn_contacts_from_single(copy, list);
    gn_contacts_pad(copy, &dem->particles);
    /* The pressure depends on all bonds; for a subset that of the last step is used. */
    if (list == &dem->bonds.contacts) gn_dem_confine(ctx, dem, copy);
    gn_contact_list alone = {.contacts = *copy};
    gn_contact_args args = gn_dem_contact_args(ctx, dem, box, &alone, false);
    args.contacts = copy;
    args.partials = partials;
    args.dt = 0.0;
    /* Without partial sums any division into blocks is valid. */
    size_t count = copy->soa.count, length = partials ? partials->length : GN_CONTACT_BLOCK;
#pragma omp parallel for schedule(static) num_threads(ctx->threads)
    for (size_t c = 0; c < count; c += length) {
        gn_contact_sums sums = {0};
        kernel(&args, c, c + length < count ? c + length : count, &sums);
    }
    return GNEISS_OK;
}

gneiss_status gn_contacts_observe(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_periodic_box *box, const gn_contacts *list,
                                  const int32_t *chosen, size_t count, gn_contacts *seen,
                                  gneiss_error *error) {
    gn_contacts part;
    *seen = (gn_contacts){0};
    gn_active_pairs_settle(ctx, dem);
    GN_TRY(gn_soa_create(&gn_contact_record, &part, count, list->soa.effects, error));
    gn_soa_permute(&gn_contact_record, &part, list, chosen);
    gneiss_status status = gn_contacts_evaluate(ctx, dem, box, &part, NULL, seen, error);
    gn_soa_destroy(&gn_contact_record, &part);
    return status;
}

gneiss_status gn_dem_observe(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_periodic_box *box, gn_observed *observed,
                             gneiss_error *error) {
    *observed = (gn_observed){0};
    gneiss_status status = GNEISS_OK;
    for (int l = 0; status == GNEISS_OK && l < GN_LIST_COUNT; l++)
        if (dem->list[l].contacts.soa.capacity)
            status = gn_contacts_evaluate(ctx, dem, box, &dem->list[l].contacts, NULL,
                                          &observed->list[l], error);
    if (status != GNEISS_OK) gn_observed_free(observed);
    return status;
}

void gn_observed_free(gn_observed *observed) {
    for (int l = 0; l < GN_LIST_COUNT; l++) gn_soa_destroy(&gn_contact_record, &observed->list[l]);
}

double gn_dem_mean_radius(const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) sum += q->pos[4 * p + 3];
    return sum / (double)q->soa.count;
}

double gn_dem_porosity(const gn_step_context *ctx, const gn_dem *dem) {
    double solid = 0.0;
    if (ctx->scene.has_specimen && !gn_scene_starts_filled(&ctx->scene) &&
        !(ctx->effects & GN_FX_PERIODIC))
        return 0.0; /* no volume is known besides that of the grains */
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        if (!gn_clump_of(dem, p))
            solid += gn_ball_volume((int)ctx->scene.dimension, dem->particles.pos[4 * p + 3]);
    for (size_t k = 0; k < dem->clumps.count; k++) {
        const gn_clump *c = &dem->clumps.clump[k];
        const size_t material = (size_t)dem->clumps.member[(size_t)c->first].material;
        solid += c->mass / ctx->scene.materials[material].density;
    }
    return 1.0 - solid / ctx->volume;
}
