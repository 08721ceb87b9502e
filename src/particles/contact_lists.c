#include "particles/contact_lists.h"

#include "base/memory.h"
#include "frame/frame.h"
#include "kernels/dispatch.h"
#include "kernels/motion.h"
#include "measure/measure.h"
#include "neigh/neigh.h"
#include "particles/joint_faces.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "sched/deal.h"

#include <stddef.h>

const gn_list_kind *const gn_list_kinds[GN_LIST_COUNT] = {
#define X(NAME, name) &gn_list_kind_##name,
    GN_CONTACT_LISTS(X)
#undef X
};

_Static_assert((int)GN_LIST_COUNT <= (int)GN_LISTS_MOST,
               "sweep, motion and measures have room for all lists");

bool gn_list_used(const gn_scene *scene, int list) {
    return !gn_list_kinds[list]->used || gn_list_kinds[list]->used(scene);
}

gneiss_status gn_list_create_empty(const gn_step_context *ctx, gn_dem *dem, int list,
                                   gneiss_error *error) {
    if (!gn_list_used(&ctx->scene, list)) return GNEISS_OK;
    return gn_soa_create(&gn_contact_record, &dem->list[list].contacts, 0,
                         gn_list_kinds[list]->effects_of(ctx->effects), error);
}

gneiss_status gn_list_changed(const gn_step_context *ctx, const gn_dem *dem, gn_contact_list *list,
                              gneiss_error *error) {
    gn_free(list->sums);
    list->sums = NULL;
    if (!list->contacts.soa.capacity) return GNEISS_OK;
    gn_contacts_pad(&list->contacts, &dem->particles);
    return gn_partials_build(&list->contacts, dem->particles.soa.count, ctx->threads,
                             &list->partials, error);
}

gneiss_status gn_lists_form(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    GN_TRY(gn_joint_faces_make(ctx, dem, error));
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        if (!gn_list_kinds[l]->form || !gn_list_used(&ctx->scene, l)) continue;
        GN_TRY(gn_list_kinds[l]->form(ctx, dem, error));
        GN_TRY(gn_list_changed(ctx, dem, &dem->list[l], error));
    }
    return GNEISS_OK;
}

gneiss_status gn_lists_follow_rows(const gn_step_context *ctx, gn_dem *dem, const int32_t *place,
                                   gneiss_error *error) {
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        gn_contact_list *list = &dem->list[l];
        if (!list->contacts.soa.capacity) continue;
        if (place) GN_TRY(gn_contacts_rename(&list->contacts, place, error));
        if (gn_list_kinds[l]->persistent)
            GN_TRY(gn_list_changed(ctx, dem, list, error));
        else
            gn_contacts_pad(&list->contacts, &dem->particles);
    }
    return GNEISS_OK;
}

gneiss_status gn_lists_choose_kernels(const gn_step_context *ctx, gn_dem *dem,
                                      gneiss_error *error) {
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_used(&ctx->scene, l))
            GN_TRY(gn_contact_kernel_choose(ctx->kernels,
                                            gn_list_kinds[l]->effects_of(ctx->effects),
                                            &dem->list[l].kernel, error));
    return GNEISS_OK;
}

void gn_lists_set_effects(const gn_step_context *ctx, gn_dem *dem) {
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_used(&ctx->scene, l))
            dem->list[l].contacts.soa.effects = gn_list_kinds[l]->effects_of(ctx->effects);
}

size_t gn_lists_count(const gn_dem *dem) {
    size_t count = 0;
    for (int l = 0; l < GN_LIST_COUNT; l++) count += dem->list[l].contacts.soa.count;
    return count;
}

void gn_contact_list_free(gn_contact_list *list) {
    gn_soa_destroy(&gn_contact_record, &list->contacts);
    gn_partials_free(&list->partials);
    gn_free(list->sums);
    *list = (gn_contact_list){0};
}
