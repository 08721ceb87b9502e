#include "base/memory.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Results are not finite without memory: only this flag distinguishes that from an unstable run. */
static atomic_bool was_refused;

static const size_t huge_page = (size_t)2 << 20;

static size_t rounded(size_t bytes, size_t alignment) {
    return bytes ? (bytes + alignment - 1) / alignment * alignment : GN_ALIGNMENT;
}

static size_t alignment_of(size_t bytes) {
    /* Transparent 2 MB pages save TLB misses on the random reads of particle rows. */
    return bytes >= huge_page ? huge_page : GN_ALIGNMENT;
}

static void *alloc_raw(size_t bytes) {
    const size_t alignment = alignment_of(bytes);
    if (bytes > SIZE_MAX - alignment) return NULL;
    const size_t size = rounded(bytes, alignment);
    void *block = aligned_alloc(alignment, size);
    if (!block) atomic_store(&was_refused, true);
    if (block && alignment == huge_page) (void)madvise(block, size, MADV_HUGEPAGE);
    return block;
}

void *gn_alloc(size_t bytes) {
    void *block = alloc_raw(bytes);
    return block ? memset(block, 0, rounded(bytes, alignment_of(bytes))) : NULL;
}

void *gn_alloc_array(size_t count, size_t size) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes)) return NULL;
    return gn_alloc(bytes);
}

void *gn_alloc_array_raw(size_t count, size_t size) {
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes)) return NULL;
    return alloc_raw(bytes);
}

void gn_free(void *block) {
    free(block);
}

bool gn_alloc_was_refused(void) {
    return atomic_load(&was_refused);
}
