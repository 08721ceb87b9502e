/* State of the zones that particles and elements share. */
#ifndef GN_ZONES_ZONE_STATE_H
#define GN_ZONES_ZONE_STATE_H

#include "frame/parts.h"
#include "zones/zones.h"

#include <stdint.h>

/* The element that came nearest to a limit of couple.convert so far: the fraction of the limit, the
 * time, and the position at the start, relative to the origin. It does not affect the motion. */
struct gn_most_loaded {
    double share, time, place[3];
    int32_t element;
};

/* All members are doubles, as in checkpoints. */
typedef struct gn_zone_state {
    double frequency; /* rad/s, largest frequency of the particles, from which the springs of zones
                         follow */
    double rate[2]; /* 1/s: contributions of springs to the rates 1/dt of particles and elements */
    double turned;  /* contribution of slaved spins, over the square of the particles' frequency */
    double stress[9]; /* Pa: contribution of elements to the mean stress over the particles' volume,
                         at the last measured instant */
} gn_zone_state;

struct gn_zones {
    struct gn_coupled *coupled; /* ties and masses (zones/zones.h); NULL: none */
    const gn_dem *dem; /* with springs: the particles that they connect, borrowed (gn_holder) */
    const gn_solids *solids;
    gn_zone_state state;
};

#endif
