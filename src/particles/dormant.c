#include "particles/dormant.h"

#include "base/error.h"
#include "base/memory.h"

#include <string.h>

gneiss_status gn_dormant_find_blocks(gn_dem *dem, gneiss_error *error) {
    gn_dem *d = dem;
    if (!d->still) d->still = gn_alloc(d->motion_blocks + 1);
    if (!d->still) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for dormant blocks");
    memset(d->still, 1, d->motion_blocks);
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (!gn_is_dormant(dem, p)) d->still[p / GN_PARTICLE_BLOCK] = 0;
    return GNEISS_OK;
}

size_t gn_dormant_count(const gn_dem *dem) {
    size_t count = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++) count += gn_is_dormant(dem, p);
    return count;
}
