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

void gn_free_at(void *place) {
    void *block;
    memcpy(&block, place, sizeof block);
    gn_free(block);
}
