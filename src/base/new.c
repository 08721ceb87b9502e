#include "base/new.h"

#include <string.h>

gneiss_status gn_no_memory(gneiss_error *error, const char *what) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s", what);
}

gneiss_status gn_new_array(void *place, size_t count, size_t size, const char *what,
                           gneiss_error *error) {
    void *block = gn_alloc_array(count, size);
    memcpy(place, &block, sizeof block);
    if (block) return GNEISS_OK;
    if (count == 1) return gn_no_memory(error, what);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu %s", count, what);
}

bool gn_widen(void *place, size_t used, size_t capacity, size_t size) {
    void *old, *wider = gn_alloc_array(capacity, size);
    if (!wider) return false;
    memcpy(&old, place, sizeof old);
    if (used) memcpy(wider, old, used * size);
    gn_free(old);
    memcpy(place, &wider, sizeof wider);
    return true;
}

gneiss_status gn_grow_array(void *place, size_t used, size_t need, size_t *capacity, size_t size,
                            const char *what, gneiss_error *error) {
    if (need <= *capacity) return GNEISS_OK;
    size_t more = 2 * *capacity > need ? 2 * *capacity : need;
    if (more < 64) more = 64;
    if (!gn_widen(place, used, more, size))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu %s", more, what);
    *capacity = more;
    return GNEISS_OK;
}

void gn_free_at(void *place) {
    void *block;
    memcpy(&block, place, sizeof block);
    gn_free(block);
}
