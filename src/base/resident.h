/* Memory and threads of this process, and whether more memory is available. */
#ifndef GN_BASE_RESIDENT_H
#define GN_BASE_RESIDENT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_resident {
    double peak, now; /* bytes */
    int threads;      /* number of existing threads */
} gn_resident;

/* Returns false and changes nothing if the system has no /proc or /proc does not state the sizes.
 * */
bool gn_resident_read(gn_resident *resident);

/* Tells whether that many more bytes are available now. Libraries that crash without memory are
 * called only if this is so. */
bool gn_memory_is_left(size_t bytes);

#endif
