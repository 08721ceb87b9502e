/* The sharp limit of many particles from the few that can determine it. In a packing of unequal
 * spheres the fastest mode is around a small particle with stiff contacts: nearly all others are
 * slower by their own blocks, whatever the rest does. The remaining ones, with some layers around
 * them, are a system of its own. With weighted springs to the outside it is never slower than the
 * whole; its mode, at rest outside, has a quotient in the whole that is never faster. If both
 * agree, that is the limit of the whole; if not, as in lattices, where all particles are alike,
 * there is no result. */
#include "limit/local.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "limit/damped.h"

#include <math.h>
#include <string.h>

enum { LAYERS = 3, LAYERS_MORE = 2, ROUNDS = 3, SHARE = 4 };

typedef struct local_search {
    gn_springs *whole;
    gn_spring_operator of_whole;
    double tolerance;
    double *mode,
        *image; /* [particles][dofs] of the whole, 0 outside; and the operator's product */
    uint8_t *core, *inside;
    double low, high; /* 1/s: bounds of the rate of the whole */
} local_search;

static double quotient(local_search *local, double stiffness, double viscosity) {
    const size_t count = local->whole->particles * (size_t)local->whole->dofs;
    gn_springs_apply(&local->of_whole, stiffness, viscosity, local->mode, local->image);
    return gn_eigen_dot(count, local->mode, local->image, local->whole->threads);
}

/* Extends a mode of the members to the whole, with the same norm. */
static void spread_mode(local_search *local, const gn_springs *members, const double *x) {
    const size_t dofs = (size_t)members->dofs;
    memset(local->mode, 0, local->whole->particles * dofs * sizeof *local->mode);
    for (size_t p = 0; p < members->particles; p++)
        memcpy(local->mode + gn_springs_place(members, p) * dofs, x + p * dofs, dofs * sizeof *x);
}

static gneiss_status solve_members(local_search *local, const gn_springs *members,
                                   gn_step_limit *limit, gneiss_error *error) {
    double *x = gn_alloc_array(members->particles * (size_t)members->dofs + 1, sizeof *x);
    if (!x)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mode of %zu particles",
                       members->particles);
    gneiss_status status = gn_springs_mode(members, local->tolerance, x, limit, error);
    if (status == GNEISS_OK) {
        spread_mode(local, members, x);
        double a = quotient(local, 1.0, 0.0), b = members->damped ? quotient(local, 0.0, 1.0) : 0.0;
        local->low = fmax(local->low, gn_damped_rate(a, b));
    }
    gn_free(x);
    return status;
}

/* Solves for the core and `layers` layers around it. */
static gneiss_status solve_around(local_search *local, int layers, gn_step_limit *limit,
                                  gneiss_error *error) {
    gn_springs members = {0};
    memcpy(local->inside, local->core, local->whole->particles);
    for (int layer = 1; layer <= layers; layer++)
        gn_springs_mark_neighbours(local->whole->spectrum, (uint8_t)layer, local->inside);
    gneiss_status status = gn_springs_build_weighed(local->whole->spectrum, local->inside,
                                                    local->whole->weight, &members, error);
    if (status == GNEISS_OK) status = solve_members(local, &members, limit, error);
    gn_springs_free(&members);
    return status;
}

/* Keeps in the core those that no weights bring below `high`. */
static gneiss_status leave_unsettled(local_search *local, size_t *count, gneiss_error *error) {
    gn_springs *y = local->whole;
    const size_t n = y->particles;
    gn_springs_mark_above(y, local->high, local->core);
    memset(local->inside, 0, n);
    if (!gn_springs_find_weights(y, local->high, local->core, UINT8_MAX, local->inside))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the weights of %zu particles", n);
    for (size_t p = 0; p < n; p++) {
        local->core[p] = local->inside[p];
        if (local->core[p]) y->weight[p] = 1.0;
        *count += local->core[p];
    }
    return GNEISS_OK;
}

static gneiss_status search(local_search *local, size_t first, gn_step_limit *limit, bool *found,
                            gneiss_error *error) {
    size_t count = 0;
    memset(local->core, 0, local->whole->particles);
    local->core[first] = 1;
    GN_TRY(solve_around(local, LAYERS, limit, error)); /* accurate enough to exclude most others */
    local->high = local->low * (1.0 + 0.5 * local->tolerance);
    GN_TRY(leave_unsettled(local, &count, error));
    const double others = local->high;
    *found = count == 0; /* as for loose grains in single contacts: none may be faster */
    for (int round = 0; !*found && count <= local->whole->particles / SHARE && round < ROUNDS;
         round++) {
        gn_step_limit around = *limit;
        GN_TRY(solve_around(local, LAYERS + round * LAYERS_MORE, &around, error));
        local->high = fmax(others, 1.0 / around.sharp_low);
        *found = local->high <= local->low * (1.0 + local->tolerance);
        if (*found) *limit = around;
    }
    return GNEISS_OK;
}

gneiss_status gn_springs_local_limit(gn_springs *system, size_t first, double tolerance,
                                     gn_step_limit *limit, bool *found, gneiss_error *error) {
    local_search s = {.whole = system, .tolerance = tolerance};
    const size_t count = system->particles * (size_t)system->dofs + 1;
    gn_step_limit sharp = *limit;
    *found = false;
    GN_TRY(gn_spring_operator_make(system, &s.of_whole, error));
    s.mode = gn_alloc_array(count, sizeof *s.mode);
    s.image = gn_alloc_array(count, sizeof *s.image);
    s.core = gn_alloc(system->particles + 1);
    s.inside = gn_alloc(system->particles + 1);
    gneiss_status status =
        s.mode && s.image && s.core && s.inside
            ? search(&s, first, &sharp, found, error)
            : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mode of %zu particles",
                      system->particles);
    if (status == GNEISS_OK && *found) {
        *limit = sharp;
        limit->sharp = 1.0 / s.low;
        limit->sharp_low = fmax(limit->bound, 1.0 / s.high);
    }
    gn_free(s.mode);
    gn_free(s.image);
    gn_free(s.core);
    gn_free(s.inside);
    gn_spring_operator_free(&s.of_whole);
    return status;
}
