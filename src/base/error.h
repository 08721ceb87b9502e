/* Errors with a message. Every fallible function returns a gneiss_status and takes a
 * gneiss_error. */
#ifndef GN_BASE_ERROR_H
#define GN_BASE_ERROR_H

#include "gneiss/status.h"

#include <stdarg.h>

/* Fills `error` (may be NULL) and returns `status`, so that callers write `return gn_fail(...)`. */
gneiss_status gn_fail(gneiss_error *error, gneiss_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prepends text to an existing message, by which the caller adds where the error occurred. */
gneiss_status gn_fail_context(gneiss_error *error, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Returns the short name of a status: "input error", "file error", ... */
const char *gn_status_name(gneiss_status status);

/* Returns early with the status of a failed call. */
#define GN_TRY(call)                                                                               \
    do {                                                                                           \
        gneiss_status gn_try_status = (call);                                                      \
        if (gn_try_status != GNEISS_OK) return gn_try_status;                                      \
    } while (0)

#endif
