/* The sharp limit of many particles by the few that can set it. Inside src/limit. */
#ifndef GN_LIMIT_LOCAL_H
#define GN_LIMIT_LOCAL_H

#include "limit/springs.h"

/* Sets what Lanczos on all particles would set, to the same relative tolerance, and `found`; both
 * stay as they are, false, where more than a quarter of the particles could set it. `limit` has the
 * rigorous bound, `first` is the particle that sets that. Deterministic for any number of threads.
 */
gneiss_status gn_springs_local_limit(gn_springs *y, size_t first, double tolerance,
                                     gn_step_limit *limit, bool *found, gneiss_error *error);

#endif
