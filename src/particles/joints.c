/* The list of contacts across joints (law_joint.h). */
#include "particles/joints.h"

#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "kernels/law.h"
#include "particles/contact_lists.h"
#include "particles/joint_faces.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/bond_causes.h"
#include "soa/field.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

static double distance_of(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j,
                          double *sum) {
    const double *x = dem->particles.pos + 4 * (int64_t)i, *y = dem->particles.pos + 4 * (int64_t)j;
    double d[3];
    *sum = x[3] + y[3];
    return sqrt(gn_branch(ctx, x, y, d));
}

/* Tells whether two particles are near enough for a contact across a face, whatever its opening is:
 * as bonds form, and once they have slid by a radius up to the reach of the patch. */
static bool is_close(const gn_step_context *ctx, const gn_dem *dem, int32_t face, int32_t i,
                     int32_t j, gn_joint_shift shift) {
    const gn_joint_faces *f = dem->joint_faces;
    const gn_joint_face *at = &f->face[face];
    const double *x = dem->particles.pos + 4 * (int64_t)i, *y = dem->particles.pos + 4 * (int64_t)j;
    const double sense = gn_joint_sense(dem, at, i, j), least = 1.0 + ctx->scene.interaction_range;
    const double slid = fmin(1.0, shift.slid / fmin(x[3], y[3]));
    const double reach = least + slid * (f->patch[at->patch].reach - least);
    double d[3];
    gn_branch(ctx, x, y, d);
    for (int a = 0; a < 3; a++) d[a] -= sense * shift.gap * at->normal[a];
    return sqrt(gn_dot3(d, d)) <= reach * (x[3] + y[3]);
}

void gn_joints_drop(const gn_dem *dem, gn_pair_list *pairs) {
    size_t kept = 0;
    gn_joint_shift shift;
    if (!dem->joint_faces) return;
    for (size_t c = 0; c < pairs->count; c++) {
        if (gn_joint_between(dem, pairs->pair[c][0], pairs->pair[c][1], &shift) >= 0) continue;
        memmove(pairs->pair[kept++], pairs->pair[c], sizeof *pairs->pair);
    }
    pairs->count = kept;
}

/* --- parameters --- */

/* Returns the weight of a contact in the area of its patch. */
static double weight_of(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j) {
    const double *pos = dem->particles.pos,
                 least = fmin(pos[4 * (int64_t)i + 3], pos[4 * (int64_t)j + 3]);
    return ctx->scene.dimension == 3 ? least * least : least;
}

/* Sets the parameters of a contact with a joint, whose ends and face are known. A joint with
 * cohesion alone breaks under any tension. */
static void set_contact(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list,
                        size_t c) {
    const gn_joint_face *face = &dem->joint_faces->face[list->joint[c]];
    const gn_joint_def *def = &ctx->scene.joints[face->joint];
    const double sense = gn_joint_sense(dem, face, list->i[c], list->j[c]), least = 1e-30;
    const double area = list->patch[c];
    double sum;
    list->length0[c] = distance_of(ctx, dem, list->i[c], list->j[c], &sum);
    list->kn[c] = def->normal_stiffness * area;
    list->kt[c] = def->shear_stiffness * area;
    list->mu[c] = def->friction;
    list->mu1[c] = def->bond_friction < 0.0 ? def->friction : def->bond_friction;
    list->rn[c] = fmax(def->tensile_strength * area, least);
    list->rt[c] = def->cohesion * area;
    list->dilation[c] = def->dilation;
    list->dilation[c + list->soa.capacity] = def->dilation_end;
    for (size_t a = 0; a < 3; a++)
        list->plane[c + a * list->soa.capacity] = sense * face->normal[a];
    if (def->cohesion > 0.0 || def->tensile_strength > 0.0) return;
    list->rn[c] = -least;
    list->cause[c] = GN_BOND_NEVER;
}

/* --- at the start --- */

static gn_pair_query query_of(const gn_step_context *ctx, const gn_dem *dem) {
    return (gn_pair_query){
        .particles = &dem->particles,
        .dimension = (int)ctx->scene.dimension,
        .range = ctx->scene.interaction_range,
        .threads = ctx->threads,
    };
}

/* Keeps the pairs across joints and writes their faces. */
static void keep_crossing(const gn_dem *dem, gn_pair_list *pairs, int32_t *face) {
    size_t kept = 0;
    gn_joint_shift shift;
    for (size_t c = 0; c < pairs->count; c++) {
        face[kept] = gn_joint_between(dem, pairs->pair[c][0], pairs->pair[c][1], &shift);
        if (face[kept] < 0) continue;
        memmove(pairs->pair[kept++], pairs->pair[c], sizeof *pairs->pair);
    }
    pairs->count = kept;
}

/* Refuses a joint of the scene that no contact crosses. */
static gneiss_status check_crossed(const gn_step_context *ctx, const gn_dem *dem,
                                   gneiss_error *error) {
    const gn_contacts *list = &dem->joints.contacts;
    for (size_t k = 0; k < ctx->scene.joint_count; k++) {
        bool crossed = false;
        for (size_t c = 0; c < list->soa.count; c++)
            crossed |= dem->joint_faces->face[list->joint[c]].joint == (int32_t)k;
        if (!crossed)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected a joint that contacts between particles cross, found "
                           "none of joint '%s'",
                           gn_scene_at(&ctx->scene, ctx->scene.joints[k].where, "joints").text,
                           ctx->scene.joints[k].name);
    }
    return GNEISS_OK;
}

/* Divides the area of each patch among its contacts, so that stiffness and strength of a joint are
 * exact in any packing. */
static void share_out_areas(const gn_step_context *ctx, gn_dem *dem) {
    gn_contacts *list = &dem->joints.contacts;
    gn_joint_faces *f = dem->joint_faces;
    for (size_t c = 0; c < list->soa.count; c++) {
        gn_joint_patch *patch = &f->patch[f->face[list->joint[c]].patch];
        patch->share += weight_of(ctx, dem, list->i[c], list->j[c]);
        patch->contacts += 1.0;
        patch->shared += gn_joint_between_several(dem, list->i[c], list->j[c]);
    }
    for (size_t k = 0; k < f->patch_count; k++)
        if (f->patch[k].share > 0.0) f->patch[k].share = f->patch[k].area / f->patch[k].share;
    for (size_t c = 0; c < list->soa.count; c++)
        list->patch[c] = f->patch[f->face[list->joint[c]].patch].share *
                         weight_of(ctx, dem, list->i[c], list->j[c]);
}

/* Finds how far apart two particles form a contact once the sides have slid. Particles that faced
 * each other at the start were neighbours in a packing; later both sides are independent. With
 * lambda particles per volume, lambda^2 integral of s A(s) ds pairs per area are less than R apart,
 * A(s) the section of the ball of radius R at the distance s: lambda^2 pi R^4/4, in 2D
 * lambda^2 2 R^3/3. R is such that they are as many as at the start, so that the stiffness of the
 * joint stays. */
static void find_reach(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    gn_joint_faces *f = dem->joint_faces;
    const bool space = ctx->scene.dimension == 3;
    const double count = (double)q->soa.count, lambda = count / ctx->volume;
    double m[5] = {0}, area = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int k = 1; k < 5; k++) m[k] += pow(q->pos[4 * p + 3], k) / count;
    for (size_t k = 0; k < f->patch_count; k++)
        if (f->patch[k].share > 0.0) area += f->patch[k].area;
    const double sums =
        space ? 2.0 * m[4] + 8.0 * m[3] * m[1] + 6.0 * m[2] * m[2] : 2.0 * m[3] + 6.0 * m[2] * m[1];
    const double pairs = lambda * lambda * sums * (space ? 0.25 * M_PI : 2.0 / 3.0);
    const double crossing = (double)dem->joints.contacts.soa.count / fmax(area, 1e-300);
    const double wanted = pow(crossing / pairs, space ? 0.25 : 1.0 / 3.0);
    const double least = 1.0 + ctx->scene.interaction_range;
    for (size_t k = 0; k < f->patch_count; k++) f->patch[k].reach = fmax(least, fmin(1.5, wanted));
}

static gn_effects joint_effects(gn_effects scene_effects) {
    const gn_effects kept = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_ENERGY | GN_FX_CONTACT_FORCES;
    return (scene_effects & kept) | GN_FX_BONDS | GN_FX_SHEAR | GN_FX_FRICTION | GN_FX_MOHR |
           GN_FX_JOINTS;
}

static gneiss_status form_joints(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_contacts *list = &dem->joints.contacts;
    GN_FREED_BY(gn_pair_list_free) gn_pair_list pairs = {0};
    GN_FREED int32_t *face = NULL;
    const gn_pair_query query = query_of(ctx, dem);
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    GN_TRY(gn_new(&face, pairs.count + 1, "contacts across joints", error));
    keep_crossing(dem, &pairs, face);
    GN_TRY(
        gn_soa_create(&gn_contact_record, list, pairs.count, joint_effects(ctx->effects), error));
    for (size_t c = 0; c < pairs.count; c++) {
        list->i[c] = pairs.pair[c][0];
        list->j[c] = pairs.pair[c][1];
        list->joint[c] = face[c];
    }
    share_out_areas(ctx, dem);
    find_reach(ctx, dem);
    for (size_t c = 0; c < pairs.count; c++) set_contact(ctx, dem, list, c);
    GN_TRY(check_crossed(ctx, dem, error));
    return gn_joint_faces_list_near(ctx, dem, error);
}

static bool has_joints(const gn_scene *scene) {
    return scene->joint_count > 0;
}

const gn_list_kind gn_list_kind_joints = {.record = "joints",
                                          .persistent = true,
                                          .used = has_joints,
                                          .effects_of = joint_effects,
                                          .form = form_joints};

/* --- contacts that form and end while sides slide --- */

/* Computes the path by which the second end moved away from the first at their contact in the last
 * step, m; as the kernel does, to first order of the step. */
static void path_of(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                    size_t c, double path[3]) {
    const gn_particles *q = &dem->particles;
    const size_t i = 4 * (size_t)list->i[c], j = 4 * (size_t)list->j[c];
    double n[3], turn[3] = {0}, carried[3];
    const double length = sqrt(gn_branch(ctx, q->pos + i, q->pos + j, n));
    const double half = ctx->scene.contact_arm == GN_ARM_MIDPOINT
                            ? 0.5 * (length - q->pos[i + 3] - q->pos[j + 3])
                            : 0.0;
    for (size_t a = 0; a < 3; a++) {
        n[a] /= length;
        if (q->spin)
            turn[a] =
                (q->pos[i + 3] + half) * q->spin[i + a] + (q->pos[j + 3] + half) * q->spin[j + a];
    }
    gn_cross3(turn, n, carried);
    for (size_t a = 0; a < 3; a++)
        path[a] = ctx->dt_past * (q->vel[j + a] - q->vel[i + a] - carried[a]);
}

/* Returns the energy that a contact which begins brings in, and one that ends takes away: that
 * before the last path, and the work over its first half, whose other half has been booked. */
static double energy_of(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                        size_t c) {
    const gn_law_held held = gn_law_joint.held(list, c, 0.0, 0.0);
    double path[3], power = 0.0;
    path_of(ctx, dem, list, c, path);
    for (size_t a = 0; a < 3; a++)
        power += path[a] * (held.normal * list->plane[c + a * list->soa.capacity] + held.shear[a]);
    return held.stored + 0.5 * power;
}

/* Mean shear forces per area of the broken contacts of each patch, on the side against the
 * normals of its faces. */
static gneiss_status mean_shears(const gn_dem *dem, double **mean, gneiss_error *error) {
    const gn_contacts *list = &dem->joints.contacts;
    const gn_joint_faces *f = dem->joint_faces;
    GN_TRY(gn_new(mean, 4 * f->patch_count + 1, "joints", error));
    for (size_t c = 0; c < list->soa.count; c++) {
        const gn_joint_face *face = &f->face[list->joint[c]];
        double *sum = *mean + 4 * face->patch, along = 0.0;
        if (gn_contact_bonded(list, c) || !(list->apart[c] < 0.0)) continue;
        for (size_t a = 0; a < 3; a++)
            along += list->plane[c + a * list->soa.capacity] * face->normal[a];
        for (size_t a = 0; a < 3; a++)
            sum[a] += (along > 0.0 ? 1.0 : -1.0) * list->shear[c + a * list->soa.capacity];
        sum[3] += list->patch[c];
    }
    for (size_t k = 0; k < f->patch_count; k++)
        for (size_t a = 0; a < 3; a++) (*mean)[4 * k + a] /= fmax((*mean)[4 * k + 3], 1e-300);
    return GNEISS_OK;
}

/* Gives a contact that begins the state of its neighbours on the joint: the gap and the slip are
 * those of its two particles since the start, the shear force is the mean of the patch within the
 * limit of friction. */
static void begin_contact(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list,
                          size_t c, gn_joint_shift shift, const double *mean) {
    const gn_joint_face *face = &dem->joint_faces->face[list->joint[c]];
    const size_t room = list->soa.capacity;
    list->patch[c] =
        dem->joint_faces->patch[face->patch].share * weight_of(ctx, dem, list->i[c], list->j[c]);
    set_contact(ctx, dem, list, c);
    if (list->cause[c] == GN_INTACT) list->rn[c] = -list->rn[c];
    list->cause[c] = GN_BOND_NEVER;
    double path[3], n[3], along = 0.0, size2 = 0.0;
    path_of(ctx, dem, list, c, path);
    for (size_t a = 0; a < 3; a++) {
        n[a] = list->plane[c + a * room];
        along += n[a] * face->normal[a];
    }
    list->slip[c] = shift.slid;
    list->apart[c] = shift.gap - gn_dot3(path, n) - gn_joint_dilation(dem, face, shift.slid);
    for (size_t a = 0; a < 3; a++) {
        list->shear[c + a * room] = (along > 0.0 ? 1.0 : -1.0) * list->patch[c] * mean[a];
        size2 += list->shear[c + a * room] * list->shear[c + a * room];
    }
    const double limit = list->mu[c] * list->kn[c] * fmax(0.0, -list->apart[c]);
    const double factor = size2 > limit * limit ? limit / sqrt(size2) : 1.0;
    for (size_t a = 0; a < 3; a++) list->shear[c + a * room] *= factor;
}

static bool is_listed(const gn_contacts *list, int32_t i, int32_t j) {
    const size_t at = gn_contacts_from(list, i, j);
    return at < list->soa.count && list->i[at] == i && list->j[at] == j;
}

/* Tells whether two particles meet by the law of a joint; `face` lies between them (-1: none).
 * Sides that a joint has parted meet as spheres, for example where a piece has turned. While they
 * overlap the law stays as it is, so that no energy appears. */
static bool meets_by_joint(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j,
                           int32_t face, gn_joint_shift shift) {
    double sum;
    const bool overlap = distance_of(ctx, dem, i, j, &sum) < sum;
    if (overlap && is_listed(&dem->joints.contacts, i, j)) return true;
    if (face < 0) return false;
    if (overlap && is_listed(&dem->pairs.contacts, i, j)) return false;
    return overlap || !shift.parted;
}

static bool has_ended(const gn_step_context *ctx, const gn_dem *dem, size_t c) {
    const gn_contacts *list = &dem->joints.contacts;
    const int32_t i = list->i[c], j = list->j[c];
    gn_joint_shift shift;
    if (!(list->kn[c] > 0.0)) return true; /* released with a removed particle */
    if (gn_contact_bonded(list, c)) return false;
    const int32_t face = gn_joint_between(dem, i, j, &shift);
    return !meets_by_joint(ctx, dem, i, j, face, shift) ||
           (face >= 0 && !is_close(ctx, dem, face, i, j, shift));
}

/* Pairs that begin, sorted. */
typedef struct fresh {
    size_t count, room;
    int32_t (*pair)[2], *face;
    gn_joint_shift *shift;
} fresh;

static void fresh_free(fresh *f) {
    gn_free(f->pair);
    gn_free(f->face);
    gn_free(f->shift);
}

/* Divides the pairs found: those across joints into listed ones, which are dropped, and fresh
 * ones. */
static gneiss_status divide(const gn_step_context *ctx, const gn_dem *dem, gn_pair_list *found,
                            fresh *begin, gneiss_error *error) {
    size_t kept = 0;
    for (size_t c = 0; c < found->count; c++) {
        const int32_t i = found->pair[c][0], j = found->pair[c][1];
        gn_joint_shift shift;
        double sum;
        const int32_t face = gn_joint_between(dem, i, j, &shift);
        const bool listed = is_listed(&dem->joints.contacts, i, j);
        const size_t at = gn_contacts_from(&dem->joints.contacts, i, j);
        const bool holds = listed && gn_contact_bonded(&dem->joints.contacts, at);
        if (is_listed(&dem->bonds.contacts, i, j) ||
            (!holds && !meets_by_joint(ctx, dem, i, j, face, shift))) {
            if (distance_of(ctx, dem, i, j, &sum) - sum <= dem->verlet.skin)
                memmove(found->pair[kept++], found->pair[c], sizeof *found->pair);
            continue;
        }
        if (listed || face < 0 || !is_close(ctx, dem, face, i, j, shift)) continue;
        if (begin->count == begin->room) {
            const size_t room = 2 * begin->room + 64;
            if (!gn_widen(&begin->pair, begin->count, room, sizeof *begin->pair) ||
                !gn_widen(&begin->face, begin->count, room, sizeof *begin->face) ||
                !gn_widen(&begin->shift, begin->count, room, sizeof *begin->shift))
                return gn_no_memory(error, "contacts across joints");
            begin->room = room;
        }
        begin->pair[begin->count][0] = i;
        begin->pair[begin->count][1] = j;
        begin->face[begin->count] = face;
        begin->shift[begin->count++] = shift;
    }
    found->count = kept;
    return GNEISS_OK;
}

/* Makes the list of the contacts that go on and those that begin. */
static gneiss_status merge(const gn_step_context *ctx, gn_dem *dem, const uint8_t *ended,
                           size_t count, const fresh *begin, gneiss_error *error) {
    gn_contacts *old = &dem->joints.contacts, now = {0};
    GN_FREED double *mean = NULL;
    size_t at = 0, next = 0;
    GN_TRY(mean_shears(dem, &mean, error));
    GN_TRY(gn_soa_create(&gn_contact_record, &now, count, old->soa.effects, error));
    for (size_t c = 0; c < count; c++) {
        while (at < old->soa.count && ended[at]) at++;
        const bool more = next < begin->count, left = at < old->soa.count;
        const bool first =
            left && (!more || old->i[at] < begin->pair[next][0] ||
                     (old->i[at] == begin->pair[next][0] && old->j[at] < begin->pair[next][1]));
        int32_t from = first ? (int32_t)at : -1;
        now.i[c] = first ? old->i[at] : begin->pair[next][0];
        now.j[c] = first ? old->j[at] : begin->pair[next][1];
        gn_soa_keep(&gn_contact_record, &now, c, 1, old, &from);
        if (!first) {
            now.joint[c] = begin->face[next];
            begin_contact(ctx, dem, &now, c, begin->shift[next],
                          mean + 4 * dem->joint_faces->face[now.joint[c]].patch);
            dem->joint_change += energy_of(ctx, dem, &now, c);
        }
        at += first;
        next += !first;
    }
    gn_soa_destroy(&gn_contact_record, old);
    *old = now;
    return gn_list_changed(ctx, dem, &dem->joints, error);
}

gneiss_status gn_joints_renew(const gn_step_context *ctx, gn_dem *dem, gn_pair_list *found,
                              gneiss_error *error) {
    const gn_contacts *list = &dem->joints.contacts;
    GN_FREED_BY(fresh_free) fresh begin = {0};
    GN_FREED uint8_t *ended = NULL;
    size_t left = list->soa.count;
    if (!dem->joint_faces) return GNEISS_OK;
    GN_TRY(gn_new(&ended, left + 1, "contacts across joints", error));
    GN_TRY(divide(ctx, dem, found, &begin, error));
    for (size_t c = 0; c < list->soa.count; c++) {
        ended[c] = has_ended(ctx, dem, c);
        left -= ended[c];
        if (ended[c]) dem->joint_change -= energy_of(ctx, dem, list, c);
    }
    if (left == list->soa.count && !begin.count) return GNEISS_OK;
    return merge(ctx, dem, ended, left + begin.count, &begin, error);
}

double gn_joints_take_change(gn_dem *dem) {
    const double change = dem->joint_change;
    dem->joint_change = 0.0;
    return change;
}

/* --- readings --- */

/* Tells whether a contact slides: its shear force is at the limit of friction up to rounding. */
static bool slides(const gn_contacts *list, size_t c, const gn_law_held *held) {
    const double size = sqrt(gn_dot3(held->shear, held->shear));
    return !gn_contact_bonded(list, c) && held->normal < 0.0 &&
           size >= list->mu[c] * -held->normal * (1.0 - 1e-6);
}

gn_joint_reading gn_joint_read(const gn_dem *dem, size_t joint) {
    const gn_contacts *list = &dem->joints.contacts;
    gn_joint_reading sum = {0};
    double shear[3] = {0};
    for (size_t c = 0; c < list->soa.count; c++) {
        const gn_joint_face *face = &dem->joint_faces->face[list->joint[c]];
        if (face->joint != (int32_t)joint || list->cause[c] == GN_BOND_LEFT) continue;
        const gn_law_held held = gn_law_joint.held(list, c, 0.0, 0.0);
        const double area = list->patch[c];
        const double opened = list->apart[c] + gn_joint_dilation(dem, face, list->slip[c]);
        double along = 0.0;
        for (size_t a = 0; a < 3; a++)
            along += list->plane[c + a * list->soa.capacity] * face->normal[a];
        for (size_t a = 0; a < 3; a++) shear[a] += (along > 0.0 ? 1.0 : -1.0) * held.shear[a];
        sum.area += area;
        if (!gn_contact_bonded(list, c)) sum.broken += area;
        if (!gn_contact_bonded(list, c) && !(held.normal < 0.0)) sum.opened += area;
        if (slides(list, c, &held)) sum.sliding += area;
        sum.normal -= held.normal;
        sum.gap += area * opened;
        sum.slip += area * list->slip[c];
    }
    sum.shear = sqrt(gn_dot3(shear, shear));
    sum.gap /= fmax(sum.area, 1e-300);
    sum.slip /= fmax(sum.area, 1e-300);
    return sum;
}
