#include "sim/fragments.h"

#include "base/ball.h"
#include "base/memory.h"

#include <math.h>

/* The first of its piece, with the path to it halved on the way. */
static int32_t root_of(int32_t *parent, int32_t p) {
    while (parent[p] != p) {
        parent[p] = parent[parent[p]];
        p = parent[p];
    }
    return p;
}

static void join(const gn_contacts *bonds, int32_t *parent) {
    for (size_t c = 0; c < bonds->soa.count; c++) {
        if (!gn_contact_bonded(bonds, c)) continue;
        int32_t a = root_of(parent, bonds->i[c]), b = root_of(parent, bonds->j[c]);
        if (a != b) parent[a > b ? a : b] = a < b ? a : b;
    }
}

static gn_fragments measure(const gn_world *w, int32_t *parent, double *volume, int32_t *members) {
    const gn_particles *q = &w->dem.particles;
    gn_fragments found = {0, 0};
    double all = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
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

gn_fragments gn_world_fragments(const gn_world *w) {
    const size_t n = w->dem.particles.soa.count;
    gn_fragments found = {NAN, NAN};
    if (!(w->effects & GN_FX_BONDS) || !n) return found;
    int32_t *parent = gn_alloc_array(n, sizeof *parent),
            *members = gn_alloc_array(n, sizeof *members);
    double *volume = gn_alloc_array(n, sizeof *volume);
    for (size_t p = 0; parent && p < n; p++) parent[p] = (int32_t)p;
    if (parent && members && volume) {
        join(&w->dem.bonds, parent);
        found = measure(w, parent, volume, members);
    }
    gn_free(parent);
    gn_free(members);
    gn_free(volume);
    return found;
}
