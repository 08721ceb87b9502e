/* Memory use of this process, and whether more is available. */
#ifndef GN_BASE_RESIDENT_H
#define GN_BASE_RESIDENT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_resident {
    double peak, now; /* bytes */
} gn_resident;

/* Reads both sizes; returns false where the system has no /proc. */
bool gn_resident_read(gn_resident *resident);

/* Tells whether that many more bytes are available now. Libraries that crash without memory are
 * called only if so. */
bool gn_memory_is_left(size_t bytes);

#endif
