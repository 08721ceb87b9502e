/* Contacts during a conversion. The weight and the force of present contacts increase. Bonds of
 * activated particles get the force that the strain of the elements causes. The normal force is
 * that of the distance, for any rotation. The tangential force is k_t times the displacement of the
 * second centre relative to the position to which the rotations of both ends would carry it. In a
 * uniform strain eps this displacement is the part of eps l across the normal, and in a rigid
 * motion it is zero. (If only displacements were used, each rotation would shear all bonds.) */
#include "base/error.h"
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "neigh/neigh.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/records.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* Returns the weight of a contact, with the lower bound of law.c. */
static double part_of(const double *part, int32_t i, int32_t j) {
    return fmax(0.5 * (part[2 * (size_t)i] + part[2 * (size_t)j]), 1e-9);
}

static void scale_shear(gn_contacts *list, size_t c, double factor) {
    for (size_t a = 0; a < 3; a++) {
        const size_t at = c + a * list->soa.capacity;
        if (list->shear) list->shear[at] *= factor;
        if (list->shear_f) list->shear_f[at] *= (float)factor;
    }
}

static void grow(const gn_conversion *conversion, gn_contacts *list) {
    const gn_law *law = gn_law_of(list->soa.effects);
    const double *now = conversion->model->dem->particles.blend;
    for (size_t k = 0; k < list->soa.count; k++) {
        const int32_t i = list->i[k], j = list->j[k];
        if (now[2 * i] == conversion->part[2 * i] && now[2 * j] == conversion->part[2 * j])
            continue;
        const double factor = part_of(now, i, j) / part_of(conversion->part, i, j);
        if (factor == 1.0) continue;
        law->weigh(list, k, factor);
        scale_shear(list, k, factor);
    }
}

/* Rotations at the particles of the last queries are stored, because a particle has many bonds,
 * which are adjacent in the list. */
enum { TURNS = 256 };
typedef struct turns {
    int32_t particle[TURNS]; /* [id modulo the size] particle; -1: none */
    double turn[TURNS][3][3];
} turns;

/* Computes the mean rotation of the elements at the position of a particle. */
static void find_turn(const gn_conversion *conversion, int32_t p, double turn[3][3]) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const gn_tie tie = gn_tie_at(b, gn_home_of(conversion, (size_t)p),
                                 conversion->model->dem->particles.start + 4 * (size_t)p);
    int32_t element[GN_AROUND_MOST];
    double one[3][3];
    const size_t count = gn_conversion_around(b, &tie, element);
    gn_fem_rotation(b, (size_t)element[0], turn);
    for (size_t e = 1; e < count; e++) {
        gn_fem_rotation(b, (size_t)element[e], one);
        for (int r = 0; r < 3; r++)
            for (int k = 0; k < 3; k++) turn[r][k] += one[r][k];
    }
    for (int r = 0; r < 3 && count > 1; r++)
        for (int k = 0; k < 3; k++) turn[r][k] /= (double)count;
}

/* Finds the rotation at a particle: that of the element that contains it, or that contained it
 * last; a free particle has no known rotation. */
static bool turn_of(const gn_conversion *conversion, turns *known, int32_t p, double turn[3][3]) {
    const int32_t at = p % TURNS;
    if (gn_home_of(conversion, (size_t)p) < 0) return false;
    if (known->particle[at] != p) find_turn(conversion, p, known->turn[at]);
    known->particle[at] = p;
    memcpy(turn, known->turn[at], sizeof known->turn[at]);
    return true;
}

/* Rotates a branch by the rotations of both ends; returns false if neither is known. */
static bool turned_branch(const gn_conversion *conversion, turns *known, int32_t i, int32_t j,
                          double branch[3]) {
    const gn_convertible *model = conversion->model;
    const gn_particles *q = &model->dem->particles;
    const double *a = q->start + 4 * (size_t)i, *b = q->start + 4 * (size_t)j;
    double l[3], turn[2][3][3];
    const double length = sqrt(gn_branch(model->ctx, a, b, l));
    const double half = model->ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    const double arm = (a[3] + half * (length - a[3] - b[3])) / length;
    bool first = turn_of(conversion, known, i, turn[0]),
         second = turn_of(conversion, known, j, turn[1]);
    if (!first && !second) return false;
    if (!first) memcpy(turn[0], turn[1], sizeof turn[0]);
    if (!second) memcpy(turn[1], turn[0], sizeof turn[1]);
    for (int r = 0; r < 3; r++) {
        branch[r] = 0.0;
        for (int k = 0; k < 3; k++)
            branch[r] += (arm * turn[0][r][k] + (1.0 - arm) * turn[1][r][k]) * l[k];
    }
    return true;
}

void gn_contact_rate(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j,
                     double length, const double n[3], double rate[3]) {
    const gn_particles *q = &dem->particles;
    const size_t a = 4 * (size_t)i, b = 4 * (size_t)j;
    const double half = ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    const double over = half * (length - q->pos[a + 3] - q->pos[b + 3]);
    double spin[3] = {0.0}, turning[3];
    for (size_t k = 0; q->spin && k < 3; k++)
        spin[k] = (q->pos[a + 3] + over) * q->spin[a + k] + (q->pos[b + 3] + over) * q->spin[b + k];
    gn_cross3(spin, n, turning);
    for (size_t k = 0; k < 3; k++) rate[k] = q->vel[b + k] - q->vel[a + k] - turning[k];
}

/* Sets the forces of a bond to those of the last instant; the coming step adds the increment of the
 * last interval. */
static void strain_bond(const gn_conversion *conversion, turns *known, gn_contacts *list,
                        size_t k) {
    const gn_particles *q = &conversion->model->dem->particles;
    double d[3], slip[3], rate[3], along = 0.0;
    const size_t i = 4 * (size_t)list->i[k], j = 4 * (size_t)list->j[k];
    if (!list->kt || !turned_branch(conversion, known, list->i[k], list->j[k], slip)) return;
    const double length = sqrt(gn_branch(conversion->model->ctx, q->pos + i, q->pos + j, d));
    for (int a = 0; a < 3; a++) d[a] /= length;
    gn_contact_rate(conversion->model->ctx, conversion->model->dem, list->i[k], list->j[k], length,
                    d, rate);
    for (int a = 0; a < 3; a++) {
        slip[a] = length * d[a] - slip[a] - conversion->model->ctx->dt_past * rate[a];
        along += slip[a] * d[a];
    }
    for (size_t a = 0; a < 3; a++) {
        const size_t at = k + a * list->soa.capacity;
        const double force = list->kt[k] * (slip[a] - along * d[a]);
        if (list->shear) list->shear[at] = force;
        if (list->shear_f) list->shear_f[at] = (float)force;
    }
}

enum { PART = 512 };

/* Some of the prepared bonds, and the rows of those that are in the list already. */
typedef struct part {
    size_t begin, count;                /* positions in the new list */
    int32_t from[PART], prepared[PART]; /* `from`: row in the last list, -1: it is new; `prepared`:
                                           -1: the list has it already */
} part;

/* Copies bonds that were in the last list; new ones are made from the prepared bonds. */
static void fill_part(const gn_conversion *conversion, turns *known, gn_contacts *now, part *q) {
    gn_dem *d = conversion->model->dem;
    gn_soa_keep(&gn_contact_record, now, q->begin, q->count, &d->bonds.contacts, q->from);
    gn_soa_keep(&gn_contact_record, now, q->begin, q->count, &d->prepared, q->prepared);
    for (size_t k = 0; k < q->count; k++) {
        const size_t at = q->begin + k;
        if (q->from[k] >= 0) continue;
        const double share = part_of(d->particles.blend, now->i[at], now->j[at]);
        if (share != 1.0) gn_law_of(now->soa.effects)->weigh(now, at, share);
        strain_bond(conversion, known, now, at);
    }
    q->begin += q->count;
    q->count = 0;
}

/* Fills the new list; both source lists are sorted in the same way. */
static void fill(const gn_conversion *conversion, gn_contacts *now) {
    const gn_contacts *all = &conversion->model->dem->prepared,
                      *last = &conversion->model->dem->bonds.contacts;
    turns turned;
    part q = {0};
    size_t old = 0;
    for (size_t k = 0; k < TURNS; k++) turned.particle[k] = -1;
    for (size_t k = 0; k < all->soa.count; k++) {
        if (!conversion->active[k]) continue;
        const bool known =
            old < last->soa.count && last->i[old] == all->i[k] && last->j[old] == all->j[k];
        now->i[q.begin + q.count] = all->i[k];
        now->j[q.begin + q.count] = all->j[k];
        q.from[q.count] = known ? (int32_t)old : -1;
        q.prepared[q.count++] = known ? -1 : (int32_t)k;
        old += known;
        if (q.count == PART) fill_part(conversion, &turned, now, &q);
    }
    fill_part(conversion, &turned, now, &q);
}

gneiss_status gn_conversion_activate_bonds(const gn_conversion *conversion, gneiss_error *error) {
    gn_dem *d = conversion->model->dem;
    gn_contacts now = {0};
    grow(conversion, &d->bonds.contacts);
    grow(conversion, &d->pairs.contacts);
    GN_TRY(gn_soa_create(&gn_contact_record, &now, conversion->acting, d->prepared.soa.effects,
                         error));
    fill(conversion, &now);
    return gn_dormant_take_bonds(conversion->model->ctx, d, &now, error);
}
