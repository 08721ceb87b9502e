/* Statuses and messages of the public API, for tests that use it alone. */
#ifndef GNEISS_TESTS_API_HELPERS_H
#define GNEISS_TESTS_API_HELPERS_H

#include "test.h"

#include <gneiss/gneiss.h>

static void must(gneiss_status status, const gneiss_error *error) {
    if (status != GNEISS_OK) fail_msg("status %d: %s", (int)status, error->message);
}

static void assert_message(const gneiss_error *error, gneiss_status status, const char *part) {
    assert_int_equal(error->status, status);
    if (!strstr(error->message, part))
        fail_msg("expected '%s' in the message '%s'", part, error->message);
}

#endif
