/* Bonds at the start: which pairs are glued and how strong. */
#include "sim/areas.h"
#include "sim/internal.h"

#include <math.h>
#include <string.h>

static bool bondable(const gn_world *w, int32_t i, int32_t j, double *distance) {
    const gn_particles *q = &w->dem.particles;
    const double *a = q->pos + 4 * (int64_t)i, *b = q->pos + 4 * (int64_t)j;
    double d[3];
    *distance = sqrt(gn_branch(w, a, b, d));
    double sum = a[3] + b[3];
    return q->group[i] != 0 && q->group[i] == q->group[j] &&
           *distance <= sum * (1.0 + w->scene.interaction_range) &&
           *distance >= sum * (1.0 - w->scene.overlap_range);
}

/* Of the smaller radius. A bond turns with the line of its centres: where these are hardly farther
 * apart than what it is stretched and sheared before it breaks (some thousandths of a radius), the
 * line turns by large angles in a step and the energy goes wrong. */
static const double bond_least = 0.01;

static gneiss_status check_bonded(const gn_world *w, int32_t i, int32_t j, double distance,
                                  gneiss_error *error) {
    const double *pos = w->dem.particles.pos;
    double radius = fmin(pos[4 * (int64_t)i + 3], pos[4 * (int64_t)j + 3]);
    if (distance >= bond_least * radius) return GNEISS_OK;
    int32_t a = w->dem.particles.id[i], b = w->dem.particles.id[j];
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s:%d:%d: specimen: expected centres of bonded particles at least %g of the smaller "
        "radius apart, found particles %d and %d (radius %g m) %g m apart; "
        "bonds.overlap_range leaves pairs that overlap much without a bond",
        w->scene.source, w->scene.specimen.where.line, w->scene.specimen.where.column, bond_least,
        a < b ? a : b, a < b ? b : a, radius, distance);
}

/* Particles at the same place have no direction of contact, bonded or not. */
static gneiss_status check_distinct(const gn_world *w, const gn_pair_list *pairs,
                                    gneiss_error *error) {
    for (size_t c = 0; c < pairs->count; c++) {
        int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        double distance;
        bool bonded = bondable(w, i, j, &distance) && w->effects & GN_FX_BONDS;
        if (distance > 0.0 && bonded) GN_TRY(check_bonded(w, i, j, distance, error));
        if (distance > 0.0) continue;
        int32_t a = w->dem.particles.id[i], b = w->dem.particles.id[j];
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s:%d:%d: specimen: expected distinct centres, found particles %d and %d "
                       "at the same place",
                       w->scene.source, w->scene.specimen.where.line,
                       w->scene.specimen.where.column, a < b ? a : b, a < b ? b : a);
    }
    return GNEISS_OK;
}

static void keep_bondable(const gn_world *w, gn_pair_list *pairs) {
    size_t kept = 0;
    for (size_t c = 0; c < pairs->count; c++) {
        int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        double distance;
        if (!bondable(w, i, j, &distance)) continue;
        memmove(pairs->pair[kept++], pairs->pair[c], sizeof *pairs->pair);
    }
    pairs->count = kept;
}

static void set_bond(gn_world *w, size_t c, int32_t i, int32_t j) {
    gn_contacts *b = &w->dem.bonds;
    const double *pos = w->dem.particles.pos;
    double distance;
    bondable(w, i, j, &distance);
    b->i[c] = i;
    b->j[c] = j;
    b->length0[c] =
        w->scene.passive_gaps ? distance : pos[4 * (int64_t)i + 3] + pos[4 * (int64_t)j + 3];
    w->dem.particles.bonds0[i]++;
    w->dem.particles.bonds0[j]++;
}

gneiss_status gn_bonds_form(gn_world *w, gneiss_error *error) {
    gn_pair_query query = {&w->dem.particles,
                           (int)w->scene.dimension,
                           0.0,
                           w->scene.interaction_range,
                           w->effects & GN_FX_PERIODIC,
                           {w->period[0], w->period[1], w->period[2]},
                           w->threads};
    gn_pair_list pairs = {0};
    gneiss_status status = gn_pairs_find(&query, &pairs, error);
    bool bonds = w->effects & GN_FX_BONDS;
    if (status == GNEISS_OK) status = check_distinct(w, &pairs, error);
    if (status == GNEISS_OK && bonds) keep_bondable(w, &pairs);
    if (status == GNEISS_OK) status = gn_law_derive(w, &pairs, error);
    if (status == GNEISS_OK)
        status = gn_soa_create(&gn_contact_record, &w->dem.bonds, bonds ? pairs.count : 0,
                               gn_contact_list_effects(w->effects, true), error);
    if (status == GNEISS_OK && bonds)
        for (size_t c = 0; c < pairs.count; c++) set_bond(w, c, pairs.pair[c][0], pairs.pair[c][1]);
    if (status == GNEISS_OK) status = gn_areas_find(w, error);
    gn_pair_list_free(&pairs);
    if (status != GNEISS_OK) return status;
    if (w->scene.fracture_energy_of == GN_FRACTURE_BODY) w->dem.derived.cut = gn_law_cut(w);
    for (size_t c = 0; c < w->dem.bonds.soa.count; c++) gn_contact_set(w, &w->dem.bonds, c);
    w->dem.bonds_at_start = (int64_t)w->dem.bonds.soa.count;
    gn_contacts_pad(&w->dem.bonds, &w->dem.particles);
    return gn_partials_build(&w->dem.bonds, w->dem.particles.soa.count, w->threads,
                             &w->dem.bond_partials, error);
}
