/* Bursts of breaking bonds, which correspond to acoustic emissions in a laboratory. */
#ifndef GN_PARTICLES_BURSTS_H
#define GN_PARTICLES_BURSTS_H

#include "frame/parts.h"

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_burst {
    double time, duration; /* s, time of its first break; time from that to its last one */
    double place[3];       /* m, mean position of its breaks in the user's coordinates */
    double energy;         /* J, energy released by its breaks; NaN: without the ledger */
    int32_t size, tension; /* number of breaks, and of breaks in tension */
    int64_t first;         /* index of its first break in the list of events */
} gn_burst;

typedef struct gn_bursts {
    gn_burst *row; /* bursts in the order of their first breaks */
    size_t count;
    int32_t *of;          /* [events] burst of a break, -1: no break */
    double reach, window; /* m, s */
} gn_bursts;

/* Groups breaks into bursts: two breaks belong together if they are at most `reach` apart and at
 * most `window` apart in time, and so do all breaks that are linked through others. Reach is a
 * multiple of the mean diameter of bonded particles (output.burst_reach), the window the time in
 * which a wave travels it along bonds (Hazzard & Young 2000; both as in Caulk 2018). The result
 * follows from the list of events, whatever the rows of the history. The caller frees it, also on
 * failure. */
gneiss_status gn_bursts_find(const gn_step_context *ctx, const gn_dem *dem, gn_bursts *bursts,
                             gneiss_error *error);
void gn_bursts_free(gn_bursts *bursts);

/* Returns the magnitude of a burst, (log10 of its energy in J)/1.5 - 3.2 (Scholz 2003); NaN without
 * an energy. */
double gn_burst_magnitude(const gn_burst *burst);

#endif
