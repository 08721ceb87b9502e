#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static const size_t huge_page = (size_t)2 << 20;

void *gn_alloc(size_t bytes) {
    /* Transparent 2 MB pages save TLB misses on the random reads of particle rows. */
    size_t alignment = bytes >= huge_page ? huge_page : GN_ALIGNMENT;
    if (bytes > SIZE_MAX - alignment) return NULL;
    size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    if (rounded == 0) rounded = GN_ALIGNMENT;
    void *block = aligned_alloc(alignment, rounded);
    if (!block) return NULL;
    if (alignment == huge_page) (void)madvise(block, rounded, MADV_HUGEPAGE);
    memset(block, 0, rounded);
    return block;
}

void *gn_alloc_array(size_t count, size_t size) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes)) return NULL;
    return gn_alloc(bytes);
}

void gn_free(void *block) {
    free(block);
}
