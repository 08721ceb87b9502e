/* Functions that the files of this folder share. */
#ifndef GN_RANKS_RANKS_PRIVATE_H
#define GN_RANKS_RANKS_PRIVATE_H

#include "ranks/ranks.h"

/* Messages between the same two ranks. */
enum { GN_TAG_ROWS, GN_TAG_PLACES, GN_TAG_SUMS, GN_TAG_FORCES };

void gn_ranks_free_share(const gn_ranks *ranks, gn_rank_share *share);

#endif
