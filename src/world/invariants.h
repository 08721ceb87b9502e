/* Invariants of a world between two steps, checked in builds with assertions. */
#ifndef GN_WORLD_INVARIANTS_H
#define GN_WORLD_INVARIANTS_H

#include "frame/parts.h"

#ifdef NDEBUG
static inline void gn_world_assert_lists(const gn_step_context *ctx, const gn_dem *dem,
                                         const gn_boundary *boundary) {
    (void)ctx;
    (void)dem;
    (void)boundary;
}
#else
/* Checks lists that were just made or read: numbers, order, padding, partial sums, and that no
 * contact is missing. */
void gn_world_assert_lists(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary);
#endif

#endif
