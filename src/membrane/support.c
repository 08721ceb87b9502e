/* Which particles bear a membrane. Bonds without moments hold what they join at a point: a grain on
 * one of them (2D), on one or two (3D), pivots about its neighbours under a force that does not go
 * through them, and so do those that hang on it. Such grains, on edges and at corners, bear
 * nothing; what of the surface is nearest to them goes to what is nearest of those that are held.
 */
#include "membrane/support.h"

#include "base/eigen.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "frame/step_context.h"
#include "membrane/membrane.h"
#include "particles/dem.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* What the contacts of a particle with those that are held answer when it moves: sums over them, of
 * a normal stiffness of 1. */
typedef struct footing {
    double normal[3];   /* n */
    double straight[9]; /* n n^T */
    double count;
} footing;

/* Tangential over normal stiffness, as far as who is held goes; the least stiffness of a grain on
 * its contacts, over that of one, with which it is held. One contact has 0 across it, two in space
 * across their plane; the corner of a hexagonal lattice has 0.50, of a face-centred one 0.54, of a
 * square 1.0, of a cubic one 1.2. Narrow tripods have less. */
static const double slant = 0.4, least = 0.45;

static void add_contact(footing *f, const double n[3], double sign) {
    for (int a = 0; a < 3; a++) f->normal[a] += sign * n[a];
    for (int k = 0; k < 9; k++) f->straight[k] += n[k / 3] * n[k % 3];
    f->count += 1.0;
}

static void add_list(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                     const bool *held, footing *all) {
    const double *pos = dem->particles.pos;
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = (size_t)list->i[c], j = (size_t)list->j[c];
        double d[3];
        if (!held[i] && !held[j]) continue;
        const double far = sqrt(gn_branch(ctx, pos + 4 * i, pos + 4 * j, d));
        const double free = list->length0 ? list->length0[c] : pos[4 * i + 3] + pos[4 * j + 3];
        if (!gn_contact_bonded(list, c) && !(far < free)) continue;
        for (int a = 0; a < 3; a++) d[a] /= far;
        if (held[j]) add_contact(&all[i], d, 1.0);
        if (held[i]) add_contact(&all[j], d, -1.0);
    }
}

/* Of moments about the centre by turns, over the square of the radius: t (count I - n n^T). What a
 * push is answered with once the grain has turned as it likes: straight + t across - t^2 N^T
 * turn^-1 N, N the cross product with the sum of the normals. */
static void push_of(const footing *f, int dimension, double t, double push[9]) {
    double turn[9], inverse[9], half[9], cross[9] = {0};
    for (int k = 0; k < 9; k++) {
        const double across = (k % 4 == 0 ? f->count : 0.0) - f->straight[k];
        push[k] = f->straight[k] + t * across;
        turn[k] = across;
    }
    if (!(t > 0.0)) return;
    for (int a = 0; a < 3; a++) {
        cross[3 * a + (a + 1) % 3] = -f->normal[(a + 2) % 3];
        cross[3 * a + (a + 2) % 3] = f->normal[(a + 1) % 3];
    }
    if (dimension == 2) {
        for (int k = 0; k < 9; k++) inverse[k] = k == 8 ? 1.0 / f->count : 0.0;
    } else {
        /* A pivot about the axis through all contacts: none of it, but for rounding. */
        for (int a = 0; a < 3; a++) turn[4 * a] += 1e-9 * f->count;
        gn_cofactor3(turn, inverse);
        const double det = gn_dot3(turn, inverse);
        for (int k = 0; k < 9; k++) inverse[k] /= det;
    }
    gn_product3_at(cross, inverse, half);
    gn_product3(half, cross, inverse);
    for (int k = 0; k < 9; k++) push[k] -= t * inverse[k];
}

static bool stands(const gn_step_context *ctx, const footing *f) {
    const int d = (int)ctx->scene.dimension;
    double push[9], small[9], values[3], vectors[9];
    if (!(f->count > 0.0)) return false;
    const bool shear = ctx->effects & GN_FX_SHEAR, turns = ctx->effects & GN_FX_ROTATION;
    if (ctx->effects & GN_FX_BOND_MOMENTS || (shear && !turns)) return true;
    push_of(f, d, shear ? slant : 0.0, push);
    for (int k = 0; k < d * d; k++) small[k] = push[k / d * 3 + k % d];
    gn_eigen_symmetric(d, small, values, vectors);
    return values[d - 1] > least;
}

/* Whether a particle is of a body whose grains may hang loose. */
static bool may_pivot(const gn_dem *dem, size_t p) {
    return dem->particles.group[p] != 0;
}

/* One grain less takes its hold from others, so again and again; who is left does not depend on the
 * order. */
static void let_go(const gn_step_context *ctx, const gn_dem *dem, footing *all, bool *held) {
    const size_t n = dem->particles.soa.count;
    for (bool more = true; more;) {
        more = false;
        memset(all, 0, n * sizeof *all);
        for (int l = 0; l < GN_LIST_COUNT; l++)
            add_list(ctx, dem, &dem->list[l].contacts, held, all);
        for (size_t p = 0; p < n; p++) {
            if (!held[p] || !may_pivot(dem, p) || stands(ctx, &all[p])) continue;
            held[p] = false;
            more = true;
        }
    }
}

gneiss_status gn_membrane_held(const gn_step_context *ctx, const gn_dem *dem, bool *held,
                               gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const size_t n = q->soa.count;
    bool any = false;
    for (size_t p = 0; p < n; p++) held[p] = !gn_came_off(q, p);
    if (!(ctx->effects & GN_FX_BONDS) || !dem->bonds.contacts.soa.count) return GNEISS_OK;
    footing *all = gn_alloc_array(n + 1, sizeof *all);
    if (!all)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the skin of %zu particles", n);
    let_go(ctx, dem, all, held);
    gn_free(all);
    for (size_t p = 0; p < n; p++) any = any || held[p];
    for (size_t p = 0; p < n && !any; p++) held[p] = !gn_came_off(q, p);
    return GNEISS_OK;
}
