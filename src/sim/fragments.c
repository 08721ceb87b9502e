#include "sim/fragments.h"

#include "base/ball.h"
#include "base/memory.h"
#include "sim/conversion.h"
#include "sim/internal.h"

#include <math.h>
#include <string.h>

/* The first of its piece, with the path to it halved on the way. */
static int32_t root_of(int32_t *parent, int32_t p) {
    while (parent[p] != p) {
        parent[p] = parent[parent[p]];
        p = parent[p];
    }
    return p;
}

static void unite(int32_t *parent, int32_t i, int32_t j) {
    int32_t a = root_of(parent, i), b = root_of(parent, j);
    if (a != b) parent[a > b ? a : b] = a < b ? a : b;
}

static void join(const gn_contacts *bonds, int32_t *parent) {
    for (size_t c = 0; c < bonds->soa.count; c++)
        if (gn_contact_bonded(bonds, c)) unite(parent, bonds->i[c], bonds->j[c]);
}

static void join_touching(const gn_world *w, const gn_contacts *list, int32_t *parent) {
    const double *pos = w->dem.particles.pos;
    double d[3];
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = (size_t)list->i[c], j = (size_t)list->j[c];
        double free = list->length0 ? list->length0[c] : pos[4 * i + 3] + pos[4 * j + 3];
        if (gn_contact_bonded(list, c) || gn_branch(w, pos + 4 * i, pos + 4 * j, d) < free * free)
            unite(parent, (int32_t)i, (int32_t)j);
    }
}

static gn_fragments measure(const gn_world *w, int32_t *parent, double *volume, int32_t *members) {
    const gn_particles *q = &w->dem.particles;
    gn_fragments found = {0, 0};
    double all = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (gn_is_asleep(w, p)) continue; /* no part of the body as yet */
        size_t root = (size_t)root_of(parent, (int32_t)p);
        double own = gn_ball_volume((int)w->scene.dimension, q->pos[4 * p + 3]);
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

gneiss_status gn_pieces_create(gn_world *w, gneiss_error *error) {
    const size_t n = w->dem.particles.soa.count + 1;
    gn_pieces *q = &w->dem.pieces;
    if (!(w->effects & GN_FX_BONDS)) return GNEISS_OK;
    q->parent = gn_alloc_array(n, sizeof *q->parent);
    q->members = gn_alloc_array(n, sizeof *q->members);
    q->volume = gn_alloc_array(n, sizeof *q->volume);
    if (q->parent && q->members && q->volume) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the fragments of %zu particles", n);
}

static void start(const gn_pieces *q, size_t n) {
    for (size_t p = 0; p < n; p++) {
        q->parent[p] = (int32_t)p;
        q->members[p] = 0;
        q->volume[p] = 0.0;
    }
}

const int32_t *gn_world_bodies(const gn_world *w) {
    const gn_particles *p = &w->dem.particles;
    const gn_pieces *q = &w->dem.pieces;
    if (!(w->effects & GN_FX_BONDS)) return NULL;
    start(q, p->soa.count);
    join_touching(w, &w->dem.bonds, q->parent);
    join_touching(w, &w->dem.pairs, q->parent);
    for (size_t k = 0; k < p->soa.count; k++)
        if (p->vel[4 * k + 3] > 0.0) q->members[root_of(q->parent, (int32_t)k)]++;
    for (size_t k = p->soa.count; k-- > 0;) /* the first of a body comes last */
        q->members[k] = p->vel[4 * k + 3] > 0.0 ? q->members[root_of(q->parent, (int32_t)k)] : 0;
    return q->members;
}

bool gn_world_has_loosened(const gn_world *w) {
    const gn_dem *d = &w->dem;
    if (d->broken_tension + d->broken_shear + d->lost > 0) return true;
    for (size_t c = 0; c < d->bonds.soa.count; c++)
        if (d->bonds.cause[c] == GN_BOND_DISSOLVED) return true;
    return false;
}

size_t gn_world_body_groups(const gn_world *w, int32_t chip, int32_t *group) {
    const size_t n = w->dem.particles.soa.count;
    int32_t *parent = w->dem.pieces.parent, lead = 0;
    size_t groups = 0;
    memset(group, 0, n * sizeof *group);
    if (!parent || !w->dem.bonds.soa.count) return 1;
    const int32_t *members = gn_world_bodies(w);
    for (size_t p = 0; p < n; p++)
        if (members[p] > members[lead]) lead = (int32_t)p;
    for (size_t p = 0; p < n; p++) {
        bool large = (int64_t)chip * members[p] >= members[lead];
        group[p] = root_of(parent, large ? (int32_t)p : lead);
        groups += group[p] == (int32_t)p;
    }
    return groups;
}

gn_fragments gn_world_fragments(const gn_world *w) {
    const size_t n = w->dem.particles.soa.count;
    const gn_pieces *q = &w->dem.pieces;
    if (!(w->effects & GN_FX_BONDS) || !n) return (gn_fragments){NAN, NAN};
    start(q, n);
    join(&w->dem.bonds, q->parent);
    return measure(w, q->parent, q->volume, q->members);
}
