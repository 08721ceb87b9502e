/* The aligned allocator: 64-byte alignment, 2 MB pages for large blocks, zeroed memory. */
#ifndef GN_BASE_MEMORY_H
#define GN_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

enum { GN_ALIGNMENT = 64 };

/* Returns zeroed memory with 64-byte alignment, NULL if none is available. A size of 0 gives a
 * valid block. */
void *gn_alloc(size_t bytes);

/* Allocates `count` items of `size` bytes; returns NULL also if the product overflows. */
void *gn_alloc_array(size_t count, size_t size);

/* Does the same as gn_alloc_array without initialisation, for arrays that are first written by the
 * threads which use them. */
void *gn_alloc_array_raw(size_t count, size_t size);

void gn_free(void *block);

/* Keeps a block readable after gn_free, for readers outside of the engine, until gn_unpin has been
 * called as often as gn_pin. Returns false without memory. */
bool gn_pin(const void *block);
void gn_unpin(const void *block);

/* Tells whether any allocation has been refused since the program began. If so, non-finite results
 * may be due to lack of memory. */
bool gn_alloc_was_refused(void);

#endif
