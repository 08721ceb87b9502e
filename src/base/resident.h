/* Memory use of this process. */
#ifndef GN_BASE_RESIDENT_H
#define GN_BASE_RESIDENT_H

#include <stdbool.h>

typedef struct gn_resident {
    double peak, now; /* bytes */
} gn_resident;

/* Reads both sizes; returns false where the system has no /proc. */
bool gn_resident_read(gn_resident *resident);

#endif
