/* The energy of a world, and the readings taken from it. */
#ifndef GN_FRAME_LEDGER_H
#define GN_FRAME_LEDGER_H

#include "frame/balance.h"
#include "frame/parts.h"
#include "measure/energy.h"

#include <stdint.h>

/* X(name, text): results of the last measured step that cannot be recomputed from the state;
 * checkpoints contain them. */
#define GN_MEASURED(X) X(unbalanced, "mean resultant over mean contact force")

struct gn_ledger {
    gn_energy energy;  /* running totals */
    gn_energy reading; /* the ledger at the last measured instant */
    /* Pa, average over the specimen at the last measured step, tension positive */
    double stress[9];
#define X(name, text) double name;
    GN_MEASURED(X)
#undef X
    gn_balance balance; /* balance at the last measured step; not a part of the state */
    /* Number and time (s) of the last measured step; 0: none in this process. Not part of the
     * state. */
    int64_t measured_step;
    double measured_time;
};

#endif
