/* Allocations that report their failure, and blocks that are freed at the end of their scope. */
#ifndef GN_BASE_NEW_H
#define GN_BASE_NEW_H

#include "base/error.h"
#include "base/memory.h"

#include <stdbool.h>

/* Allocates `count` zeroed items for the pointer at `place`: GN_TRY(gn_new(&row, n, "rows",
 * error)). `what` names the items in the message. *place is NULL after a failure. */
#define gn_new(place, count, what, error)                                                          \
    gn_new_array((place), (count), sizeof **(place), (what), (error))
gneiss_status gn_new_array(void *place, size_t count, size_t size, const char *what,
                           gneiss_error *error);

/* Makes room for `need` items in the block of *capacity items at `place`, of which the first `used`
 * are kept; those behind are zeroed. */
#define gn_grow(place, used, need, capacity, what, error)                                          \
    gn_grow_array((place), (used), (need), (capacity), sizeof **(place), (what), (error))
gneiss_status gn_grow_array(void *place, size_t used, size_t need, size_t *capacity, size_t size,
                            const char *what, gneiss_error *error);
/* As gn_grow to a given capacity, for blocks that share one; false: no memory. */
bool gn_widen(void *place, size_t used, size_t capacity, size_t size);

/* A local pointer whose block is freed when its scope ends: GN_FREED double *row = NULL; */
#define GN_FREED __attribute__((cleanup(gn_free_at)))
void gn_free_at(void *place);

/* A local object that `function` frees when its scope ends. */
#define GN_FREED_BY(function) __attribute__((cleanup(function)))

/* Returns the error of a function that signals lack of memory for an object by NULL. */
gneiss_status gn_no_memory(gneiss_error *error, const char *what);

#endif
