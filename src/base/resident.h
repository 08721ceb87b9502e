/* The memory that this process has in use. */
#ifndef GN_BASE_RESIDENT_H
#define GN_BASE_RESIDENT_H

#include <stdbool.h>

typedef struct gn_resident {
    double peak, now; /* bytes */
} gn_resident;

/* False where the system does not say (it has no /proc). */
bool gn_resident_read(gn_resident *resident);

#endif
