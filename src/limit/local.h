/* The sharp limit of many particles from the few that can determine it. Private to src/limit. */
#ifndef GN_LIMIT_LOCAL_H
#define GN_LIMIT_LOCAL_H

#include "limit/springs.h"

/* Computes what Lanczos on all particles would, to the same relative tolerance, and sets `found`;
 * both are unchanged, false, if more than a quarter of the particles could determine the limit.
 * `limit` has the rigorous bound, `first` is the particle that determines it. The result is the
 * same for any number of threads. */
gneiss_status gn_springs_local_limit(gn_springs *system, size_t first, double tolerance,
                                     gn_step_limit *limit, bool *found, gneiss_error *error);

#endif
