#include "particles/dormant.h"

#include "base/error.h"
#include "base/new.h"
#include "particles/lists.h"
#include "soa/records.h"

#include <string.h>

gneiss_status gn_dormant_create(gn_dem *dem, gneiss_error *error) {
    const size_t count = dem->particles.soa.count;
    GN_TRY(gn_new(&dem->dormant, count + 1, "particles", error));
    for (size_t k = 0; k < count; k++) dem->dormant[k].element = -1;
    return GNEISS_OK;
}

static gneiss_status use_bonds(const gn_step_context *ctx, gn_dem *dem, const gn_contacts *bonds,
                               gneiss_error *error) {
    dem->bonds.contacts = *bonds;
    return gn_list_changed(ctx, dem, &dem->bonds, error);
}

gneiss_status gn_dormant_deactivate_all(const gn_step_context *ctx, gn_dem *dem,
                                        gneiss_error *error) {
    gn_particles *q = &dem->particles;
    gn_contacts none = {0};
    dem->prepared = dem->bonds.contacts;
    dem->bonds.contacts = none;
    GN_TRY(gn_soa_create(&gn_contact_record, &none, 0, dem->prepared.soa.effects, error));
    for (size_t p = 0; p < q->soa.count; p++) {
        gn_dormant_of(dem, p)->inverse_mass = q->vel[4 * p + 3];
        gn_dormant_of(dem, p)->inverse_inertia = q->spin ? q->spin[4 * p + 3] : 0.0;
        memset(q->vel + 4 * p, 0, 4 * sizeof *q->vel);
        if (q->spin) memset(q->spin + 4 * p, 0, 4 * sizeof *q->spin);
        q->blend[2 * p] = q->blend[2 * p + 1] = 0.0;
    }
    return use_bonds(ctx, dem, &none, error);
}

gneiss_status gn_dormant_take_bonds(const gn_step_context *ctx, gn_dem *dem, gn_contacts *bonds,
                                    gneiss_error *error) {
    gn_soa_destroy(&gn_contact_record, &dem->bonds.contacts);
    return use_bonds(ctx, dem, bonds, error);
}

static void swap(double *a, double *b) {
    const double before = *a;
    *a = *b;
    *b = before;
}

void gn_dormant_swap(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    const gn_contacts bonds = dem->bonds.contacts;
    if (!gn_converts(ctx)) return;
    for (size_t p = 0; p < q->soa.count; p++) {
        swap(q->vel + 4 * p + 3, &gn_dormant_of(dem, p)->inverse_mass);
        if (q->spin) swap(q->spin + 4 * p + 3, &gn_dormant_of(dem, p)->inverse_inertia);
    }
    dem->bonds.contacts = dem->prepared;
    dem->prepared = bonds;
}

gneiss_status gn_dormant_find_blocks(gn_dem *dem, gneiss_error *error) {
    gn_dem *d = dem;
    if (!d->still) d->still = gn_alloc(d->motion_blocks + 1);
    if (!d->still) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for dormant blocks");
    memset(d->still, 1, d->motion_blocks);
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (!gn_is_dormant(dem, p)) d->still[p / GN_PARTICLE_BLOCK] = 0;
    return GNEISS_OK;
}

size_t gn_dormant_count(const gn_dem *dem) {
    size_t count = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++) count += gn_is_dormant(dem, p);
    return count;
}
