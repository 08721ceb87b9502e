/* Formation of bonds: the bonded pairs and their strengths. */
#include "particles/bonds.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "neigh/neigh.h"
#include "particles/active_pairs.h"
#include "particles/bond_sections.h"
#include "particles/clumps.h"
#include "particles/from_run.h"
#include "particles/joints.h"
#include "particles/law.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/bond_causes.h"
#include "soa/field.h"
#include "soa/records.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool bondable(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j,
                     double *distance) {
    const gn_particles *q = &dem->particles;
    const double *a = q->pos + 4 * (int64_t)i, *b = q->pos + 4 * (int64_t)j;
    double d[3];
    *distance = sqrt(gn_branch(ctx, a, b, d));
    double sum = a[3] + b[3];
    return q->group[i] != 0 && q->group[i] == q->group[j] &&
           *distance <= sum * (1.0 + ctx->scene.interaction_range) &&
           *distance >= sum * (1.0 - ctx->scene.overlap_range);
}

/* Least length of a bond over the smaller radius. A bond rotates with the line between its centres.
 * If their distance is hardly larger than the deformation at which the bond breaks (some
 * thousandths of a radius), that line rotates by large angles in a step, and energy is not
 * conserved. */
static const double bond_least = 0.01;

static gneiss_status check_bonded(const gn_step_context *ctx, const gn_dem *dem, int32_t i,
                                  int32_t j, double distance, gneiss_error *error) {
    const double *pos = dem->particles.pos;
    double radius = fmin(pos[4 * (int64_t)i + 3], pos[4 * (int64_t)j + 3]);
    if (distance >= bond_least * radius) return GNEISS_OK;
    int32_t a = dem->particles.id[i], b = dem->particles.id[j];
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected centres of bonded particles at least %g of the smaller "
                   "radius apart, found particles %d and %d (radius %g m) %g m apart; "
                   "bonds.overlap_range leaves pairs that overlap much without a bond",
                   gn_scene_at(&ctx->scene, ctx->scene.specimen.where, "specimen").text, bond_least,
                   a < b ? a : b, a < b ? b : a, radius, distance);
}

/* Reports two clumps, or a clump and a particle, with a common centre. */
static gneiss_status refuse_clumps(const gn_step_context *ctx, const gn_dem *dem, int32_t i,
                                   int32_t j, gneiss_error *error) {
    const gn_clumps_def *def = &ctx->scene.clumps;
    const int32_t *clump = dem->particles.clump, c = clump[i] > clump[j] ? clump[i] : clump[j],
                  other = clump[i] + clump[j] - c, at = clump[i] == c ? i : j;
    const bool placed = (size_t)c < def->placed_count;
    const double *x = dem->particles.pos + 4 * (int64_t)at, *o = ctx->scene.origin;
    char path[48] = "clumps", found[48] = "a particle of the specimen";
    if (placed) snprintf(path, sizeof path, "clumps.placed[%d]", c);
    if (other >= 0) snprintf(found, sizeof found, "clump %d", other);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected distinct centres, found clump %d (base 0) with a sphere at the "
                   "place of one of %s, at (%.6g, %.6g, %.6g) m",
                   gn_scene_at(&ctx->scene, placed ? def->placed[c].where : def->where, path).text,
                   c, found, x[0] + o[0], x[1] + o[1], x[2] + o[2]);
}

/* Refuses particles at the same position, bonded or not, because their contact has no direction. */
static gneiss_status check_distinct(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_pair_list *pairs, gneiss_error *error) {
    for (size_t c = 0; c < pairs->count; c++) {
        int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        double distance;
        bool bonded = bondable(ctx, dem, i, j, &distance) && ctx->effects & GN_FX_BONDS &&
                      ctx->scene.bonds == GN_SWITCH_ON;
        if (distance > 0.0 && bonded) GN_TRY(check_bonded(ctx, dem, i, j, distance, error));
        if (distance > 0.0) continue;
        if (gn_clump_of(dem, (size_t)i) || gn_clump_of(dem, (size_t)j))
            return refuse_clumps(ctx, dem, i, j, error);
        int32_t a = dem->particles.id[i], b = dem->particles.id[j];
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected distinct centres, found particles %d and %d "
                       "at the same place",
                       gn_scene_at(&ctx->scene, ctx->scene.specimen.where, "specimen").text,
                       a < b ? a : b, a < b ? b : a);
    }
    return GNEISS_OK;
}

static void keep_bondable(const gn_step_context *ctx, const gn_dem *dem, gn_pair_list *pairs) {
    size_t kept = 0;
    for (size_t c = 0; c < pairs->count; c++) {
        int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        double distance;
        if (!bondable(ctx, dem, i, j, &distance)) continue;
        memmove(pairs->pair[kept++], pairs->pair[c], sizeof *pairs->pair);
    }
    pairs->count = kept;
}

static void set_bond(const gn_step_context *ctx, gn_dem *dem, size_t c, int32_t i, int32_t j) {
    gn_contacts *b = &dem->bonds.contacts;
    const double *pos = dem->particles.pos;
    double distance;
    bondable(ctx, dem, i, j, &distance);
    b->i[c] = i;
    b->j[c] = j;
    b->length0[c] =
        ctx->scene.passive_gaps ? distance : pos[4 * (int64_t)i + 3] + pos[4 * (int64_t)j + 3];
    dem->particles.bonds0[i]++;
    dem->particles.bonds0[j]++;
}

/* --- overlaps that are free of stress, without a bond --- */

/* Pairs without a bond that overlap, and their stress-free distances. */
typedef struct free_overlaps {
    gn_pair_list pairs;
    double *rest; /* [pairs.count] m */
} free_overlaps;

static void free_overlaps_free(free_overlaps *overlaps) {
    gn_pair_list_free(&overlaps->pairs);
    gn_free(overlaps->rest);
}

static gneiss_status make_room(free_overlaps *o, size_t count, gneiss_error *error) {
    *o = (free_overlaps){.pairs.pair = gn_alloc_array(count + 1, sizeof *o->pairs.pair),
                         .rest = gn_alloc_array(count + 1, sizeof *o->rest)};
    if (o->pairs.pair && o->rest) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu overlaps", count);
}

static void add_overlap(free_overlaps *overlaps, int32_t i, int32_t j, double rest) {
    overlaps->pairs.pair[overlaps->pairs.count][0] = i;
    overlaps->pairs.pair[overlaps->pairs.count][1] = j;
    overlaps->rest[overlaps->pairs.count++] = rest;
}

/* Overlaps below this share of r_i + r_j are due to rounding of positions. */
static const double overlap_least = 1e-9;

/* Tells whether overlaps at the start are due to packing and therefore free of stress, as bonds
 * take them. If a later stage forms the bonds, this holds for packings that were made with
 * overlaps. Elements that convert refuse overlaps without a bond (conversion/conversion_setup.c).
 */
static bool overlaps_are_free(const gn_step_context *ctx) {
    const gn_scene *s = &ctx->scene;
    const bool made = s->specimen.pack.overlap == GN_OVERLAP_PASSIVE || gn_scene_from_packing(s);
    const bool kept = s->specimen.from[0] && s->specimen.from_bonds;
    return ctx->effects & GN_FX_BONDS && s->passive_gaps && !gn_converts(ctx) && !kept &&
           (s->bonds == GN_SWITCH_ON || made);
}

/* Finds the pairs that overlap and will have no bond because they are of different groups, of none,
 * or overlap by more than bonds.overlap_range. */
static gneiss_status find_overlaps(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_pair_list *pairs, free_overlaps *overlaps,
                                   gneiss_error *error) {
    const bool bonds = ctx->scene.bonds == GN_SWITCH_ON;
    if (!overlaps_are_free(ctx)) return GNEISS_OK;
    GN_TRY(make_room(overlaps, pairs->count, error));
    for (size_t c = 0; c < pairs->count; c++) {
        const int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        const double *pos = dem->particles.pos,
                     sum = pos[4 * (int64_t)i + 3] + pos[4 * (int64_t)j + 3];
        double distance;
        if (bondable(ctx, dem, i, j, &distance) && bonds) continue;
        if (distance < sum * (1.0 - overlap_least)) add_overlap(overlaps, i, j, distance);
    }
    return GNEISS_OK;
}

typedef struct kept_bond {
    int32_t i, j;
    double rest;
    uint8_t holds;
} kept_bond;

static int by_ends(const void *a, const void *b) {
    const kept_bond *x = a, *y = b;
    if (x->i != y->i) return x->i < y->i ? -1 : 1;
    return (x->j > y->j) - (x->j < y->j);
}

/* Takes over the bonds of another run in the particle order of this one: the pairs, and their data
 * in from->rest_length. Broken bonds keep their stress-free distance. */
static gneiss_status take_bonds(const gn_step_context *ctx, const gn_dem *dem, gn_from_run *from,
                                gn_pair_list *pairs, free_overlaps *loose, gneiss_error *error) {
    GN_TRY(gn_from_run_read(&ctx->scene, from, error));
    GN_TRY(make_room(loose, from->bonds, error));
    kept_bond *kept = gn_alloc_array(from->bonds + 1, sizeof *kept);
    void *room = gn_alloc_array(from->bonds + 1, sizeof *pairs->pair);
    if (!kept || !room) {
        gn_free(kept);
        gn_free(room);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu bonds", from->bonds);
    }
    gn_free(pairs->pair);
    pairs->pair = room;
    pairs->count = 0;
    for (size_t c = 0; c < from->bonds; c++) {
        int32_t a = dem->index_of_id[from->bond[c][0]], b = dem->index_of_id[from->bond[c][1]];
        kept[c] = (kept_bond){a < b ? a : b, a < b ? b : a, from->rest_length[c], from->holds[c]};
    }
    qsort(kept, from->bonds, sizeof *kept, by_ends);
    for (size_t c = 0; c < from->bonds; c++) {
        if (!kept[c].holds) {
            add_overlap(loose, kept[c].i, kept[c].j, kept[c].rest);
            continue;
        }
        pairs->pair[pairs->count][0] = kept[c].i;
        pairs->pair[pairs->count][1] = kept[c].j;
        from->rest_length[pairs->count++] = kept[c].rest;
    }
    gn_free(kept);
    return GNEISS_OK;
}

/* Returns the query for pairs that are near enough for a bond. */
static gn_pair_query bond_query(const gn_step_context *ctx, const gn_dem *dem) {
    return (gn_pair_query){&dem->particles,
                           (int)ctx->scene.dimension,
                           0.0,
                           ctx->scene.interaction_range,
                           ctx->effects & GN_FX_PERIODIC,
                           {ctx->period[0], ctx->period[1], ctx->period[2]},
                           ctx->threads};
}

/* Distributes fracture energies of planes over the new bonds; those of earlier bonds do not change.
 */
static void share_out_energies(const gn_step_context *ctx, gn_dem *dem) {
    if (ctx->scene.fracture_energy_of == GN_FRACTURE_BODY) dem->derived.cut = gn_law_cut(ctx, dem);
}

static bool has_pair(const gn_contacts *list, int32_t i, int32_t j) {
    const size_t at = gn_contacts_from(list, i, j);
    return at < list->soa.count && list->i[at] == i && list->j[at] == j;
}

/* Returns the number of pairs that the list has already, as stress-free overlaps. */
static size_t count_known(const gn_contacts *list, const gn_pair_list *pairs) {
    size_t known = 0;
    for (size_t k = 0; k < pairs->count; k++)
        known += has_pair(list, pairs->pair[k][0], pairs->pair[k][1]);
    return known;
}

/* Merges two sorted lists; `fresh` [in all]: the bond is new, and replaces a stress-free overlap of
 * that pair. */
static gneiss_status merge(gn_dem *dem, const gn_pair_list *pairs, uint8_t *fresh,
                           gneiss_error *error) {
    gn_contacts *old = &dem->bonds.contacts, now = {0};
    size_t count = old->soa.count + pairs->count - count_known(old, pairs), at = 0, next = 0;
    GN_TRY(gn_soa_create(&gn_contact_record, &now, count, old->soa.effects, error));
    for (size_t c = 0; c < count; c++) {
        bool more = next < pairs->count;
        int32_t i = more ? pairs->pair[next][0] : 0, j = more ? pairs->pair[next][1] : 0;
        bool first =
            at < old->soa.count && (!more || old->i[at] < i || (old->i[at] == i && old->j[at] < j));
        bool known = !first && at < old->soa.count && old->i[at] == i && old->j[at] == j;
        int32_t from = first ? (int32_t)at : -1;
        now.i[c] = first ? old->i[at] : i;
        now.j[c] = first ? old->j[at] : j;
        gn_soa_keep(&gn_contact_record, &now, c, 1, old, &from);
        fresh[c] = !first;
        at += first || known;
        next += !first;
    }
    gn_soa_destroy(&gn_contact_record, old);
    dem->bonds.contacts = now;
    return GNEISS_OK;
}

/* Gives a contact the state of a broken bond: it presses below its stress-free distance, and never
 * pulls. */
static void set_overlap(const gn_step_context *ctx, gn_dem *dem, size_t c, double rest) {
    gn_contacts *b = &dem->bonds.contacts;
    b->length0[c] = rest;
    gn_contact_set(ctx, dem, b, c);
    if (b->area) b->area[c] = gn_contact_area(ctx, dem, b, c, 0.0);
    b->rn[c] = -fabs(b->rn[c]);
    b->cause[c] = GN_BOND_NEVER;
}

/* Stores overlaps that are free of stress in the list of bonds, which holds stress-free distances;
 * they do not count as bonds. */
static gneiss_status keep_overlaps(const gn_step_context *ctx, gn_dem *dem, const free_overlaps *o,
                                   gneiss_error *error) {
    const size_t most = dem->bonds.contacts.soa.count + o->pairs.count;
    if (!o->pairs.count) return GNEISS_OK;
    uint8_t *fresh = gn_alloc(most + 1);
    if (!fresh) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu overlaps", most);
    gneiss_status status = merge(dem, &o->pairs, fresh, error);
    for (size_t c = 0, next = 0; status == GNEISS_OK && c < dem->bonds.contacts.soa.count; c++)
        if (fresh[c]) set_overlap(ctx, dem, c, o->rest[next++]);
    gn_free(fresh);
    return status;
}

/* Finds the pairs that are bonded from the start, with their stress-free distances in `from` if
 * another run had them, and overlapping pairs without bonds. */
static gneiss_status find_bonds(const gn_step_context *ctx, const gn_dem *dem, gn_pair_list *pairs,
                                gn_from_run *from, free_overlaps *loose, gneiss_error *error) {
    const gn_pair_query query = bond_query(ctx, dem);
    const bool from_run = ctx->scene.specimen.from[0] && ctx->scene.specimen.from_bonds;
    /* A later stage may be the first with bonds. */
    const bool bonds = ctx->effects & GN_FX_BONDS && ctx->scene.bonds == GN_SWITCH_ON;
    GN_TRY(gn_pairs_find(&query, pairs, error));
    GN_TRY(check_distinct(ctx, dem, pairs, error));
    gn_joints_drop(dem, pairs);
    GN_TRY(find_overlaps(ctx, dem, pairs, loose, error));
    if (bonds && from_run) return take_bonds(ctx, dem, from, pairs, loose, error);
    if (bonds) keep_bondable(ctx, dem, pairs);
    return GNEISS_OK;
}

static gneiss_status make_bonds(const gn_step_context *ctx, gn_dem *dem, const gn_pair_list *pairs,
                                const gn_from_run *from, gneiss_error *error) {
    gn_contacts *b = &dem->bonds.contacts;
    const bool bonds = ctx->effects & GN_FX_BONDS && ctx->scene.bonds == GN_SWITCH_ON;
    GN_TRY(gn_law_derive(ctx, dem, pairs, error));
    GN_TRY(gn_soa_create(&gn_contact_record, b, bonds ? pairs->count : 0,
                         gn_contact_list_effects(ctx->effects, true), error));
    for (size_t c = 0; c < b->soa.count; c++) {
        set_bond(ctx, dem, c, pairs->pair[c][0], pairs->pair[c][1]);
        if (from->rest_length) b->length0[c] = from->rest_length[c];
    }
    GN_TRY(gn_areas_find(ctx, dem, error));
    share_out_energies(ctx, dem);
    for (size_t c = 0; c < b->soa.count; c++) gn_contact_set(ctx, dem, b, c);
    dem->bonds_at_start = (int64_t)b->soa.count;
    return GNEISS_OK;
}

static gneiss_status form_bonds(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_pair_list pairs = {0};
    gn_from_run from = {0};
    free_overlaps loose = {0};
    gneiss_status status = find_bonds(ctx, dem, &pairs, &from, &loose, error);
    if (status == GNEISS_OK) status = make_bonds(ctx, dem, &pairs, &from, error);
    if (status == GNEISS_OK) status = keep_overlaps(ctx, dem, &loose, error);
    gn_from_run_free(&from);
    gn_pair_list_free(&pairs);
    free_overlaps_free(&loose);
    return status;
}

/* --- in a later stage --- */

/* Returns the increase of the distance of the ends in the last step, m. */
static double last_path(const gn_step_context *ctx, const gn_dem *dem, const gn_periodic_box *box,
                        int32_t i, int32_t j, const double d[3], double length) {
    const double *a = dem->particles.vel + 4 * (int64_t)i, *b = dem->particles.vel + 4 * (int64_t)j;
    double before[3];
    for (int k = 0; k < 3; k++)
        before[k] = d[k] - ctx->dt_past * (b[k] - a[k] + box->flow[k] * d[k]);
    return length - sqrt(gn_dot3(before, before));
}

/* Returns the work, J, that the tangential force on particle i did in the last step; n points from
 * i to j. */
static double last_slide(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j,
                         const double n[3], double gap, const double force[3]) {
    const gn_particles *q = &dem->particles;
    const double *a = q->vel + 4 * (int64_t)i, *b = q->vel + 4 * (int64_t)j;
    const double half = ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 * gap : 0.0;
    double turn[3] = {0}, carried[3];
    for (int k = 0; q->spin && k < 3; k++)
        turn[k] = (q->pos[4 * (int64_t)i + 3] + half) * q->spin[4 * (int64_t)i + k] +
                  (q->pos[4 * (int64_t)j + 3] + half) * q->spin[4 * (int64_t)j + k];
    gn_cross3(turn, n, carried);
    double sum = 0.0;
    for (int k = 0; k < 3; k++) sum += force[k] * (b[k] - a[k] - carried[k]);
    return ctx->dt_past * sum;
}

/* Returns the energy, J, of the contacts of a list at the present positions, less the work of the
 * normal force over half of the last path: its first half was booked with the force of that
 * instant, its second half will be booked with the force that is computed next. A change of the law
 * then changes the energy by k u u' with the stretches u, u' before and after the path, for any
 * step. Tangential forces are still those before the path, and half of their work is not booked
 * yet. A pair that has become a bond remains in the list of pairs until the lists are made. */
static double stored_in(const gn_step_context *ctx, const gn_dem *dem, const gn_periodic_box *box,
                        const gn_contacts *list) {
    const gn_law *law = gn_law_of(list->soa.effects);
    double sum = 0.0;
    for (size_t c = 0; c < list->soa.count; c++) {
        if (list == &dem->pairs.contacts && has_pair(&dem->bonds.contacts, list->i[c], list->j[c]))
            continue;
        const double *a = dem->particles.pos + 4 * (int64_t)list->i[c],
                     *b = dem->particles.pos + 4 * (int64_t)list->j[c];
        double d[3], length = sqrt(gn_branch(ctx, a, b, d));
        double rest = list->length0 ? list->length0[c] : a[3] + b[3];
        gn_law_held held = law->held(list, c, length, length - rest);
        double path = last_path(ctx, dem, box, list->i[c], list->j[c], d, length);
        for (int k = 0; k < 3; k++) d[k] /= length;
        double slide =
            last_slide(ctx, dem, list->i[c], list->j[c], d, length - a[3] - b[3], held.shear);
        sum += held.stored - 0.5 * held.normal * path + 0.5 * slide;
        if (!law->moments || !gn_contact_bonded(list, c)) continue;
        sum += law->moments(list, c, d).stored;
    }
    return sum;
}

/* Tells whether the stored energy exceeds rounding and the residual overlaps of a fitted packing:
 * it does if the velocity that it could give to all particles together moves them by more than this
 * fraction of the smallest radius in the longest stable step. A wave crosses about one radius in
 * that step, so that the fraction is a strain. */
bool gn_stored_matters(const gn_step_context *ctx, const gn_dem *dem, double stored) {
    const double strain = 1e-5, speed = sqrt(2.0 * fmax(0.0, stored) / dem->mass);
    return isfinite(ctx->stable) && speed * ctx->stable > strain * dem->radius_min;
}

double gn_contacts_stored(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_periodic_box *box) {
    gn_active_pairs_settle(ctx, dem);
    double sum = 0.0;
    for (int l = 0; l < GN_LIST_COUNT; l++) sum += stored_in(ctx, dem, box, &dem->list[l].contacts);
    return sum;
}

/* Limits the tangential force of a dissolved bond to friction, which is zero in tension. The energy
 * of the excess is released with the bond and does no frictional work. */
static void leave_to_friction(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *contacts,
                              size_t c) {
    const double *x = dem->particles.pos + 4 * (int64_t)contacts->i[c],
                 *y = dem->particles.pos + 4 * (int64_t)contacts->j[c];
    double d[3], length = sqrt(gn_branch(ctx, x, y, d));
    gn_law_held held =
        gn_law_of(contacts->soa.effects)->held(contacts, c, length, length - contacts->length0[c]);
    double force = sqrt(gn_dot3(held.shear, held.shear));
    double most = contacts->mu ? contacts->mu[c] * fmax(-held.normal, 0.0) : 0.0;
    if (force <= most) return;
    for (size_t a = 0; a < 3; a++) {
        size_t at = c + a * contacts->soa.capacity;
        if (contacts->shear) contacts->shear[at] *= most / force;
        if (contacts->shear_f) contacts->shear_f[at] *= (float)(most / force);
    }
}

void gn_bonds_dissolve(const gn_step_context *ctx, gn_dem *dem) {
    gn_contacts *b = &dem->bonds.contacts;
    for (size_t c = 0; c < b->soa.count; c++) {
        if (!gn_contact_bonded(b, c)) continue;
        leave_to_friction(ctx, dem, b, c);
        b->rn[c] = -fabs(b->rn[c]);
        b->cause[c] = GN_BOND_DISSOLVED;
        b->broken_time[c] = ctx->time;
    }
}

void gn_bonds_strengthen(gn_dem *dem, double factor) {
    gn_contacts *b = &dem->bonds.contacts;
    for (size_t c = 0; c < b->soa.count; c++) {
        if (!gn_contact_bonded(b, c)) continue;
        b->rn[c] *= factor;
        if (b->rt) b->rt[c] *= factor;
        if (b->rn_f) b->rn_f[c] = (float)b->rn[c];
        if (b->rt_f) b->rt_f[c] = (float)b->rt[c];
    }
}

/* Keeps the pairs that neither are nor were bonds, in the same order. */
static void drop_known(const gn_dem *dem, gn_pair_list *pairs) {
    const gn_contacts *b = &dem->bonds.contacts;
    size_t kept = 0;
    for (size_t c = 0; c < pairs->count; c++) {
        const int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        if (has_pair(b, i, j) && b->cause[gn_contacts_from(b, i, j)] != GN_BOND_NEVER) continue;
        memmove(pairs->pair[kept++], pairs->pair[c], sizeof *pairs->pair);
    }
    pairs->count = kept;
}

/* Sets the tangential force of a new bond: zero if its stress-free distance is the present one,
 * else that of the contact which it replaces. */
static void take_shear(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *bonds,
                       size_t c) {
    const gn_contacts *pairs = &dem->pairs.contacts;
    size_t at = gn_contacts_from(pairs, bonds->i[c], bonds->j[c]);
    bool found =
        at < pairs->soa.count && pairs->i[at] == bonds->i[c] && pairs->j[at] == bonds->j[c];
    if (ctx->scene.passive_gaps || !found) return;
    for (size_t a = 0; a < 3; a++) {
        if (bonds->shear && pairs->shear)
            bonds->shear[c + a * bonds->soa.capacity] = pairs->shear[at + a * pairs->soa.capacity];
        if (bonds->shear_f && pairs->shear_f)
            bonds->shear_f[c + a * bonds->soa.capacity] =
                pairs->shear_f[at + a * pairs->soa.capacity];
    }
}

/* Computes sections from all bonds together; bonds that existed before keep theirs. */
static gneiss_status find_new_areas(const gn_step_context *ctx, gn_dem *dem, const uint8_t *fresh,
                                    gneiss_error *error) {
    gn_contacts *b = &dem->bonds.contacts;
    double *before = b->area ? gn_alloc_array(b->soa.count + 1, sizeof *before) : NULL;
    if (b->area && !before) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for sections");
    if (before) memcpy(before, b->area, b->soa.count * sizeof *before);
    gneiss_status status = gn_areas_find(ctx, dem, error);
    for (size_t c = 0; before && c < b->soa.count; c++)
        if (!fresh[c]) b->area[c] = before[c];
    gn_free(before);
    return status;
}

static gneiss_status add_bonds(const gn_step_context *ctx, gn_dem *dem, const gn_pair_list *pairs,
                               gneiss_error *error) {
    gn_dem *d = dem;
    uint8_t *fresh = gn_alloc(d->bonds.contacts.soa.count + pairs->count + 1);
    if (!fresh) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for bonds");
    gneiss_status status = merge(dem, pairs, fresh, error);
    for (size_t c = 0; status == GNEISS_OK && c < d->bonds.contacts.soa.count; c++)
        if (fresh[c]) set_bond(ctx, dem, c, d->bonds.contacts.i[c], d->bonds.contacts.j[c]);
    if (status == GNEISS_OK) status = find_new_areas(ctx, dem, fresh, error);
    if (status == GNEISS_OK) share_out_energies(ctx, dem);
    for (size_t c = 0; status == GNEISS_OK && c < d->bonds.contacts.soa.count; c++) {
        if (!fresh[c]) continue;
        gn_contact_set(ctx, dem, &d->bonds.contacts, c);
        take_shear(ctx, dem, &d->bonds.contacts, c);
    }
    gn_free(fresh);
    GN_TRY(status);
    d->bonds_at_start += (int64_t)pairs->count;
    gn_free(d->loose); /* these pairs are found again when lists are made */
    d->loose = NULL;
    return gn_list_changed(ctx, dem, &d->bonds, error);
}

gneiss_status gn_bonds_add(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    const gn_pair_query query = bond_query(ctx, dem);
    gn_pair_list pairs = {0};
    gneiss_status status = gn_pairs_find(&query, &pairs, error);
    if (status == GNEISS_OK) gn_joints_drop(dem, &pairs);
    if (status == GNEISS_OK) keep_bondable(ctx, dem, &pairs);
    if (status == GNEISS_OK) drop_known(dem, &pairs);
    for (size_t c = 0; status == GNEISS_OK && c < pairs.count; c++) {
        double distance;
        bondable(ctx, dem, pairs.pair[c][0], pairs.pair[c][1], &distance);
        status = check_bonded(ctx, dem, pairs.pair[c][0], pairs.pair[c][1], distance, error);
    }
    if (status == GNEISS_OK) status = add_bonds(ctx, dem, &pairs, error);
    gn_pair_list_free(&pairs);
    return status;
}

static gn_effects bond_effects(gn_effects scene_effects) {
    return gn_contact_list_effects(scene_effects, true);
}

const gn_list_kind gn_list_kind_bonds = {.record = "bonds",
                                         .persistent = true,
                                         .of_materials = true,
                                         .effects_of = bond_effects,
                                         .form = form_bonds};
