/* The features of a world (frame/feature.h): those that its scene uses, and those that were added.
 * They are not in checkpoints: the state of a scene's feature is a member of the world, and an
 * added feature must be added again after a resume. */
#ifndef GN_WORLD_FEATURES_H
#define GN_WORLD_FEATURES_H

#include "frame/feature.h"

#include <stddef.h>

struct gn_features {
    const gn_feature *used[GN_FEATURE_COUNT]; /* [used_count] */
    gn_feature *added;                        /* [added_count] */
    size_t used_count, added_count;
    bool holds; /* a used feature may hold blocks; the time of its hooks is booked as
                   GN_PHASE_exchange */
};

/* Adds a feature; the world may already have made steps. On failure the context still belongs to
 * the caller. */
gneiss_status gn_feature_add(gn_world *world, gn_feature feature, gneiss_error *error);

void gn_features_free(gn_features *features);

/* Finds which features the scene uses. */
void gn_features_choose(gn_world *world);
/* Called after lists were made: finds the features that the scene uses and holds their blocks. */
gneiss_status gn_features_follow_lists(gn_world *world, gneiss_error *error);
/* Calls the hooks at a place. */
gneiss_status gn_features_run(gn_world *world, gn_hook_place place, gneiss_error *error);

#endif
