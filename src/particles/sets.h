/* Sets of particles. */
#ifndef GN_PARTICLES_SETS_H
#define GN_PARTICLES_SETS_H

#include "base/error.h"
#include "base/point.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

static inline bool gn_set_end_holds(const gn_step_context *ctx, const gn_set_def *set_def,
                                    const double *x) {
    int axis = (int)set_def->end_axis;
    double r = set_def->end_by_surface ? x[3] : 0.0;
    return set_def->end_upper ? x[axis] + r >= ctx->upper[axis] - set_def->end_depth
                              : x[axis] - r <= ctx->lower[axis] + set_def->end_depth;
}

static inline bool gn_set_ids_hold(const gn_set_def *set_def, int32_t id) {
    for (size_t k = 0; k < set_def->id_count; k++)
        if (set_def->ids[k] == id) return true;
    return false;
}

/* Tells whether a set selects a particle at a position. */
static inline bool gn_set_selects(const gn_step_context *ctx, const gn_set_def *set_def,
                                  const double *x, int32_t id) {
    if (set_def->has_box)
        for (int a = 0; a < (int)ctx->scene.dimension; a++) {
            double seen = gn_point_out(ctx->scene.origin[a], x[a]);
            if (seen < set_def->box_min[a] || seen > set_def->box_max[a]) return false;
        }
    if (set_def->end_axis >= 0 && !gn_set_end_holds(ctx, set_def, x)) return false;
    return !set_def->id_count || gn_set_ids_hold(set_def, id);
}

/* gn_set_selected for a periodic box, which has moved particles by whole periods since the start.
 */
bool gn_set_selected_in_box(const gn_step_context *ctx, const gn_dem *dem, size_t set,
                            size_t particle);

/* Tells whether a set contains a particle, by its position at the start. */
static inline bool gn_set_selected(const gn_step_context *ctx, const gn_dem *dem, size_t set,
                                   size_t particle) {
    const gn_particles *q = &dem->particles;
    if (ctx->step > 0 && ctx->scene.has_periodic)
        return gn_set_selected_in_box(ctx, dem, set, particle);
    return gn_set_selects(ctx, &ctx->scene.sets[set], q->start + 4 * particle, q->id[particle]);
}

/* gn_sets_assign sets the materials and groups of the particles of each set; gn_sets_apply, called
 * when masses are known, sets their motions and forces. */
gneiss_status gn_sets_assign(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gneiss_status gn_sets_apply(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Updates motions and forces of sets from the scene of another stage. */
gneiss_status gn_sets_enter(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Distributes the forces of sets to their particles. */
void gn_sets_push(const gn_step_context *ctx, gn_dem *dem);
/* gn_prescription_update sets the velocities of prescribed particles; gn_reactions_sum adds up the
 * reactions of sets. */
void gn_prescription_update(const gn_step_context *ctx, gn_dem *dem, double time);
void gn_reactions_sum(const gn_step_context *ctx, gn_dem *dem);

#endif
