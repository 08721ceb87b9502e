/* The memory that this process has in use, and whether there is more. */
#ifndef GN_BASE_RESIDENT_H
#define GN_BASE_RESIDENT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_resident {
    double peak, now; /* bytes */
} gn_resident;

/* False where the system does not say (it has no /proc). */
bool gn_resident_read(gn_resident *resident);

/* Tells whether so many bytes more can be had now. Libraries that crash without memory are called
 * only then. */
bool gn_memory_is_left(size_t bytes);

#endif
