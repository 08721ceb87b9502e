/* One aligned allocator: 64-byte lines, 2 MB pages for large blocks, zeroed. */
#ifndef GN_BASE_MEMORY_H
#define GN_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

enum { GN_ALIGNMENT = 64 };

/* Zeroed, 64-byte aligned. NULL when the memory is not to be had. A size of 0 gives a valid block.
 */
void *gn_alloc(size_t bytes);

/* `count` items of `size` bytes; NULL also when the product overflows. */
void *gn_alloc_array(size_t count, size_t size);

/* The same with whatever is in it: for what is written before it is read, by the threads that will
 * use it. */
void *gn_alloc_array_raw(size_t count, size_t size);

void gn_free(void *block);

/* Tells whether any of these calls has been refused since the program began: what is not a number
 * since then may be so for want of memory. */
bool gn_alloc_was_refused(void);

#endif
