#include "particles/fragments.h"

#include "base/ball.h"
#include "base/error.h"
#include "base/new.h"
#include "base/union_find.h"
#include "frame/frame.h"
#include "particles/dormant.h"
#include "particles/particles.h"
#include "soa/bond_causes.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Joins what intact bonds and intact joints hold together. */
static void join(const gn_dem *dem, int32_t *parent) {
    const gn_contacts *lists[] = {&dem->bonds.contacts, &dem->joints.contacts};
    for (int l = 0; l < 2; l++)
        for (size_t c = 0; c < lists[l]->soa.count; c++)
            if (gn_contact_bonded(lists[l], c))
                gn_set_unite(parent, lists[l]->i[c], lists[l]->j[c]);
}

static void join_touching(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                          int32_t *parent) {
    const double *pos = dem->particles.pos;
    double d[3];
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = (size_t)list->i[c], j = (size_t)list->j[c];
        double free = list->length0 ? list->length0[c] : pos[4 * i + 3] + pos[4 * j + 3];
        if (gn_contact_bonded(list, c) || gn_branch(ctx, pos + 4 * i, pos + 4 * j, d) < free * free)
            gn_set_unite(parent, (int32_t)i, (int32_t)j);
    }
}

static gn_fragments measure(const gn_step_context *ctx, const gn_dem *dem, int32_t *parent,
                            double *volume, int32_t *members) {
    const gn_particles *q = &dem->particles;
    gn_fragments found = {0, 0};
    double all = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (gn_is_dormant(dem, p)) continue; /* the particle is not a part of the body yet */
        size_t root = (size_t)gn_set_root(parent, (int32_t)p);
        double own = gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
        volume[root] += own;
        members[root]++;
        all += own;
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        found.count += members[p] > 1;
        found.largest = fmax(found.largest, volume[p] / all);
    }
    return found;
}

gneiss_status gn_pieces_create(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    const size_t n = dem->particles.soa.count + 1;
    gn_pieces *q = &dem->pieces;
    if (!(ctx->effects & GN_FX_BONDS)) return GNEISS_OK;
    q->parent = gn_alloc_array(n, sizeof *q->parent);
    q->members = gn_alloc_array(n, sizeof *q->members);
    q->volume = gn_alloc_array(n, sizeof *q->volume);
    if (q->parent && q->members && q->volume) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the fragments of %zu particles", n);
}

static void start(const gn_pieces *pieces, size_t n) {
    for (size_t p = 0; p < n; p++) {
        pieces->parent[p] = (int32_t)p;
        pieces->members[p] = 0;
        pieces->volume[p] = 0.0;
    }
}

const int32_t *gn_dem_body_sizes(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *p = &dem->particles;
    const gn_pieces *q = &dem->pieces;
    if (!(ctx->effects & GN_FX_BONDS)) return NULL;
    start(q, p->soa.count);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        join_touching(ctx, dem, &dem->list[l].contacts, q->parent);
    for (size_t k = 0; k < p->soa.count; k++)
        if (gn_particle_is_active(p, k)) q->members[gn_set_root(q->parent, (int32_t)k)]++;
    for (size_t k = p->soa.count;
         k-- > 0;) /* processed last, so that the first particle of a body sets its values */
        q->members[k] =
            gn_particle_is_active(p, k) ? q->members[gn_set_root(q->parent, (int32_t)k)] : 0;
    return q->members;
}

bool gn_dem_has_loosened(const gn_dem *dem) {
    const gn_dem *d = dem;
    if (d->broken_tension + d->broken_shear + d->lost > 0) return true;
    for (size_t c = 0; c < d->bonds.contacts.soa.count; c++)
        if (d->bonds.contacts.cause[c] == GN_BOND_DISSOLVED) return true;
    return false;
}

size_t gn_dem_body_groups(const gn_step_context *ctx, const gn_dem *dem, int32_t chip,
                          int32_t *group) {
    const size_t n = dem->particles.soa.count;
    int32_t *parent = dem->pieces.parent, lead = 0;
    size_t groups = 0;
    memset(group, 0, n * sizeof *group);
    if (!parent || !dem->bonds.contacts.soa.count) return 1;
    const int32_t *members = gn_dem_body_sizes(ctx, dem);
    for (size_t p = 0; p < n; p++)
        if (members[p] > members[lead]) lead = (int32_t)p;
    for (size_t p = 0; p < n; p++) {
        bool large = (int64_t)chip * members[p] >= members[lead];
        group[p] = gn_set_root(parent, large ? (int32_t)p : lead);
        groups += group[p] == (int32_t)p;
    }
    return groups;
}

gn_fragments gn_dem_fragments(const gn_step_context *ctx, const gn_dem *dem) {
    const size_t n = dem->particles.soa.count;
    const gn_pieces *q = &dem->pieces;
    if (!(ctx->effects & GN_FX_BONDS) || !n) return (gn_fragments){NAN, NAN};
    start(q, n);
    join(dem, q->parent);
    return measure(ctx, dem, q->parent, q->volume, q->members);
}

/* --- anchored fragments --- */

static bool is_anchor(const gn_dem *dem, size_t p) {
    const gn_particles *q = &dem->particles;
    const int32_t slot = dem->prescribed.count ? q->slot[p] : -1;
    return (slot >= 0 && dem->prescribed.mask[slot] & 7) || (q->blend && q->blend[2 * p] < 1.0);
}

/* Volumes of fragments, m3. */
typedef struct anchorage {
    double anchored, dormant, largest;
    bool any; /* there are anchored ones */
} anchorage;

/* Sums the volumes of fragments; those of anchored ones then are 0 in the scratch of fragments. */
static anchorage find_anchored(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const gn_pieces *pieces = &dem->pieces;
    anchorage found = {0};
    (void)gn_dem_fragments(ctx, dem);
    for (size_t p = 0; p < q->soa.count; p++) {
        found.largest = fmax(found.largest, pieces->volume[p]);
        if (gn_is_dormant(dem, p))
            found.dormant += gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
        else if (is_anchor(dem, p)) {
            const size_t root = (size_t)gn_set_root(pieces->parent, (int32_t)p);
            found.anchored += pieces->volume[root];
            pieces->volume[root] = 0.0; /* the volume of a piece is added only once */
            found.any = true;
        }
    }
    return found;
}

double gn_dem_anchored_volume(const gn_step_context *ctx, const gn_dem *dem) {
    if (!(ctx->effects & GN_FX_BONDS) || !dem->particles.soa.count) return 0.0;
    const anchorage found = find_anchored(ctx, dem);
    return found.dormant + (found.any ? found.anchored : found.largest);
}

double gn_dem_loose_volume_outside(const gn_step_context *ctx, const gn_dem *dem, int axis,
                                   double low, double high) {
    const gn_particles *q = &dem->particles;
    const gn_pieces *pieces = &dem->pieces;
    double sum = 0.0;
    if (!(ctx->effects & GN_FX_BONDS) || !q->soa.count) return 0.0;
    const anchorage found = find_anchored(ctx, dem);
    for (size_t p = 0; p < q->soa.count; p++) {
        const double place = q->start[4 * p + (size_t)axis],
                     piece = pieces->volume[gn_set_root(pieces->parent, (int32_t)p)];
        const bool held = piece == 0.0 || (!found.any && piece == found.largest);
        if (gn_is_dormant(dem, p) || (place >= low && place <= high)) continue;
        if (held && gn_particle_is_active(q, p)) continue;
        sum += gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
    }
    return sum;
}

/* --- list of fragments --- */

static bool is_there(const gn_dem *dem, size_t p) {
    return gn_particle_is_active(&dem->particles, p) && !gn_is_dormant(dem, p);
}

/* `at`: the first particle of the fragment by id, next to which images are taken. */
static void add_particle(const gn_step_context *ctx, const gn_dem *dem, gn_fragment *fragment,
                         size_t at, size_t p) {
    const gn_particles *q = &dem->particles;
    const double mass = gn_own_share(q, p) / q->vel[4 * p + 3];
    double d[3];
    gn_branch(ctx, q->pos + 4 * at, q->pos + 4 * p, d);
    for (size_t a = 0; a < 3; a++) {
        fragment->centre[a] += mass * d[a];
        fragment->velocity[a] += mass * q->vel[4 * p + a];
    }
    fragment->mass += mass;
    fragment->volume += gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
    fragment->particles++;
}

static void finish(const gn_step_context *ctx, const gn_dem *dem, gn_fragment *fragment,
                   size_t at) {
    double centre[3];
    for (size_t a = 0; a < 3; a++) {
        centre[a] = dem->particles.pos[4 * at + a] + fragment->centre[a] / fragment->mass;
        fragment->velocity[a] /= fragment->mass;
    }
    gn_user_point(ctx, centre, fragment->centre);
}

static int by_volume(const void *a, const void *b) {
    const gn_fragment *x = a, *y = b;
    if (x->volume != y->volume) return x->volume > y->volume ? -1 : 1;
    return (x->first > y->first) - (x->first < y->first);
}

/* Sums over the particles of each fragment in the order of ids, with fragments in the order of
 * their smallest ids, so that sums do not depend on the sorting of particles. *place: index of each
 * fragment by its first particle's id. */
static void sum_pieces(const gn_step_context *ctx, const gn_dem *dem, gn_fragment_list *list,
                       int32_t *piece) {
    const gn_dem *d = dem;
    for (int64_t id = 0; id < d->ids; id++) {
        const int32_t p = d->index_of_id[id];
        if (p < 0 || !is_there(dem, (size_t)p)) continue;
        const int32_t root = gn_set_root(d->pieces.parent, p);
        if (piece[root] < 0) {
            piece[root] = (int32_t)list->count;
            list->row[list->count++].first = (int32_t)id;
        }
        gn_fragment *f = &list->row[piece[root]];
        add_particle(ctx, dem, f, (size_t)d->index_of_id[f->first], (size_t)p);
    }
    for (size_t k = 0; k < list->count; k++)
        finish(ctx, dem, &list->row[k], (size_t)d->index_of_id[list->row[k].first]);
}

gneiss_status gn_fragments_list(const gn_step_context *ctx, const gn_dem *dem,
                                gn_fragment_list *list, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    const gn_pieces *q = &dem->pieces;
    *list = (gn_fragment_list){0};
    if (!(ctx->effects & GN_FX_BONDS) || !n) return GNEISS_OK;
    GN_TRY(gn_new(&list->row, n + 1, "the fragments of particles", error));
    GN_TRY(gn_new(&list->of, n + 1, "the fragments of particles", error));
    start(q, n);
    join(dem, q->parent);
    memset(list->of, -1, n * sizeof *list->of);
    sum_pieces(ctx, dem, list, list->of);
    qsort(list->row, list->count, sizeof *list->row, by_volume);
    memset(q->members, -1, n * sizeof *q->members);
    for (size_t k = 0; k < list->count; k++)
        q->members[gn_set_root(q->parent, dem->index_of_id[list->row[k].first])] = (int32_t)k;
    for (size_t p = 0; p < n; p++)
        list->of[p] = is_there(dem, p) ? q->members[gn_set_root(q->parent, (int32_t)p)] : -1;
    return GNEISS_OK;
}

void gn_fragments_free(gn_fragment_list *list) {
    gn_free(list->row);
    gn_free(list->of);
    *list = (gn_fragment_list){0};
}
