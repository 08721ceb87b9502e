#include "base/error.h"

#include "base/memory.h"
#include "base/printable.h"

#include <stdio.h>
#include <string.h>

/* A result that is not finite after an allocation was refused is reported as lack of memory, not as
 * instability. */
static gneiss_status cause_of(gneiss_status status) {
    return status == GNEISS_ERROR_UNSTABLE && gn_alloc_was_refused() ? GNEISS_ERROR_MEMORY : status;
}

gneiss_status gn_fail(gneiss_error *error, gneiss_status status, const char *format, ...) {
    status = cause_of(status);
    if (error) {
        va_list args;
        va_start(args, format);
        error->status = status;
        vsnprintf(error->message, sizeof error->message, format, args);
        va_end(args);
        gn_make_printable(error->message); /* it may quote text of a user's file */
    }
    return status;
}

gneiss_status gn_fail_context(gneiss_error *error, const char *format, ...) {
    if (!error) return GNEISS_ERROR_INTERNAL;
    char inner[GNEISS_MESSAGE_SIZE];
    memcpy(inner, error->message, sizeof inner);
    va_list args;
    va_start(args, format);
    int used = vsnprintf(error->message, sizeof error->message, format, args);
    va_end(args);
    if (used < 0) used = 0;
    if ((size_t)used < sizeof error->message)
        snprintf(error->message + used, sizeof error->message - (size_t)used, "%s", inner);
    gn_make_printable(error->message);
    return error->status;
}

const char *gn_status_name(gneiss_status status) {
    switch (status) {
    case GNEISS_OK:
        return "ok";
    case GNEISS_ERROR_INTERNAL:
        return "internal error";
    case GNEISS_ERROR_INPUT:
        return "input error";
    case GNEISS_ERROR_IO:
        return "file error";
    case GNEISS_ERROR_MEMORY:
        return "out of memory";
    case GNEISS_ERROR_UNSTABLE:
        return "unstable run";
    case GNEISS_INTERRUPTED:
        return "interrupted";
    }
    return "unknown status";
}
