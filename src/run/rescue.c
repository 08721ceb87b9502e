/* Handling of an output of a run that could not be written. */
#include "io/listing.h"
#include "run/run.h"

#include <string.h>

/* Appends to the error message which checkpoint a resumed run would continue from. */
static gneiss_status say_where(const gn_run *run, const gneiss_error *first, const char *tried,
                               gneiss_error *error) {
    int64_t step = -1;
    size_t count = 0;
    gneiss_error second = {0};
    if (gn_checkpoint_list(run->directory, &step, 1, &count, &second) != GNEISS_OK)
        return gn_fail(error, first->status, "%.1000s\n  at step %lld%.500s", first->message,
                       (long long)run->world.ctx.step, tried);
    if (count == 0)
        return gn_fail(error, first->status,
                       "%.1000s\n  at step %lld%.500s; there is no checkpoint", first->message,
                       (long long)run->world.ctx.step, tried);
    return gn_fail(
        error, first->status,
        "%.1000s\n  at step %lld%.300s; the checkpoint of step %lld remains: gneiss resume %.300s",
        first->message, (long long)run->world.ctx.step, tried, (long long)step, run->directory);
}

gneiss_status gn_run_rescue(gn_run *run, bool save, gneiss_status status, gneiss_error *error) {
    bool output = status == GNEISS_ERROR_IO || status == GNEISS_ERROR_MEMORY;
    if (!output || !run->directory[0] || !error) return status;
    gneiss_error first = *error, second = {0};
    char tried[512] = "";
    if (save && gn_checkpoint_save(run, &second) != GNEISS_OK)
        snprintf(tried, sizeof tried, " (no checkpoint of it: %.400s)", second.message);
    return say_where(run, &first, tried, error);
}
