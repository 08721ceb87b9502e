/* Bursts of breaking bonds, as acoustic emission is heard in a laboratory. */
#ifndef GN_PARTICLES_BURSTS_H
#define GN_PARTICLES_BURSTS_H

#include "frame/parts.h"

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_burst {
    double time, duration; /* s, of its first break; to its last */
    double place[3];       /* m, mean of its breaks, as the user sees it */
    double energy;         /* J, that its breaks released; NaN: without the ledger */
    int32_t size, tension; /* breaks, and those of them in tension */
    int64_t first;         /* place in the list of events of its first break */
} gn_burst;

typedef struct gn_bursts {
    gn_burst *row; /* in the order of their first breaks */
    size_t count;
    int32_t *of;          /* [events] which burst a break is of, -1: no break */
    double reach, window; /* m, s */
} gn_bursts;

/* Breaks no farther than `reach` and no longer than `window` apart belong together, and what
 * belongs to one of a burst to all of it. Reach is a number of mean diameters of the particles that
 * are bonded (output.burst_reach), the window the time in which a wave runs so far along bonds
 * (Hazzard & Young 2000; both as in Caulk 2018). Follows from the list of events, whatever rows a
 * history has. The caller frees, also on failure. */
gneiss_status gn_bursts_find(const gn_step_context *ctx, const gn_dem *dem, gn_bursts *bursts,
                             gneiss_error *error);
void gn_bursts_free(gn_bursts *bursts);

/* log10 of the energy in J over 1.5, less 3.2 (Scholz 2003); NaN without any. */
double gn_burst_magnitude(const gn_burst *burst);

#endif
