#include "base/memory.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Without memory results are not finite; only this flag distinguishes this from an unstable run. */
static atomic_bool was_refused;

static const size_t huge_page = (size_t)2 << 20;

static size_t rounded(size_t bytes, size_t alignment) {
    return bytes ? (bytes + alignment - 1) / alignment * alignment : GN_ALIGNMENT;
}

static size_t alignment_of(size_t bytes) {
    /* Transparent 2 MB pages avoid TLB misses in random reads of particle rows. */
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

/* A block that readers outside of the engine use. */
typedef struct pinned {
    const void *block;
    size_t readers;
    bool released; /* the engine has released the block, and its last reader frees it */
    struct pinned *next;
} pinned;

static pthread_mutex_t pins_lock = PTHREAD_MUTEX_INITIALIZER;
static pinned *pins;
static atomic_size_t pin_count; /* 0: blocks are freed without a search for readers */

static pinned **pin_of(const void *block) {
    pinned **at = &pins;
    while (*at && (*at)->block != block) at = &(*at)->next;
    return at;
}

bool gn_pin(const void *block) {
    pthread_mutex_lock(&pins_lock);
    pinned *pin = *pin_of(block);
    if (!pin && (pin = calloc(1, sizeof *pin))) {
        *pin = (pinned){block, 0, false, pins};
        pins = pin;
        atomic_fetch_add(&pin_count, 1);
    }
    if (pin) pin->readers++;
    pthread_mutex_unlock(&pins_lock);
    return pin != NULL;
}

void gn_unpin(const void *block) {
    pthread_mutex_lock(&pins_lock);
    pinned **at = pin_of(block), *pin = *at;
    if (pin && --pin->readers == 0) {
        *at = pin->next;
        if (pin->released) free((void *)(uintptr_t)block);
        free(pin);
        atomic_fetch_sub(&pin_count, 1);
    }
    pthread_mutex_unlock(&pins_lock);
}

/* Tells whether a block has to wait for its readers before it is freed. */
static bool is_read(const void *block) {
    if (!block || atomic_load(&pin_count) == 0) return false;
    pthread_mutex_lock(&pins_lock);
    pinned *pin = *pin_of(block);
    if (pin) pin->released = true;
    pthread_mutex_unlock(&pins_lock);
    return pin != NULL;
}

void gn_free(void *block) {
    if (!is_read(block)) free(block);
}

bool gn_alloc_was_refused(void) {
    return atomic_load(&was_refused);
}
