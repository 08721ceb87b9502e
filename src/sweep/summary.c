#include "sweep/summary.h"

#include "base/memory.h"
#include "base/printable.h"
#include "io/checkpoint_files.h"
#include "io/h5.h"
#include "measure/energy.h"
#include "run/folder.h"
#include "test_kinds/readings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- choice of readings ---- */

static void describe(gn_summary_reading *reading, const char *name, const char *unit,
                     const char *text) {
    snprintf(reading->name, sizeof reading->name, "%s", name);
    snprintf(reading->unit, sizeof reading->unit, "%s", unit);
    snprintf(reading->text, sizeof reading->text, "%s", text);
}

/* Descriptions of history columns are in the files of the runs. */
static void describe_known(gn_summary_reading *reading) {
#define X(name_, unit_, text_)                                                                     \
    if (strcmp(reading->name, #name_) == 0) describe(reading, #name_, unit_, text_);
    GN_READINGS(X)
#undef X
#define X(name_, kind_, text_)                                                                     \
    if (strcmp(reading->name, "energy." #name_) == 0)                                              \
        describe(reading, "energy." #name_, "J", text_);
    GN_ENERGY_TERMS(X)
#undef X
    if (strcmp(reading->name, "energy.stored_at_start") == 0)
        describe(reading, "energy.stored_at_start", "J", "energy stored at the start");
    if (strcmp(reading->name, "energy.residual") == 0)
        describe(reading, "energy.residual", "1", GN_ENERGY_RESIDUAL_TEXT);
}

static const char *const usual[] = {
#define X(name, unit, text) #name,
    GN_READINGS(X)
#undef X
        "energy.residual",
    "history.broken_tension", "history.broken_shear"};
enum { USUAL = sizeof usual / sizeof *usual };

static gneiss_status choose_readings(gn_summary *summary, gneiss_error *error) {
    const gn_sweep *sweep = summary->sweep;
    summary->reading_count = sweep->reading_count ? sweep->reading_count : USUAL;
    summary->readings = gn_alloc_array(summary->reading_count, sizeof *summary->readings);
    summary->value =
        gn_alloc_array(sweep->run_count * summary->reading_count, sizeof *summary->value);
    summary->rest =
        gn_alloc_array(sweep->run_count * summary->reading_count, sizeof *summary->rest);
    summary->runs = gn_alloc_array(sweep->run_count, sizeof *summary->runs);
    summary->statistics = gn_alloc_array(sweep->combination_count * summary->reading_count,
                                         sizeof *summary->statistics);
    if (!summary->readings || !summary->value || !summary->rest || !summary->runs ||
        !summary->statistics)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the summary of %zu runs",
                       sweep->run_count);
    for (size_t k = 0; k < summary->reading_count; k++) {
        gn_summary_reading *reading = &summary->readings[k];
        snprintf(reading->name, sizeof reading->name, "%s",
                 sweep->reading_count ? sweep->readings[k] : usual[k]);
        describe_known(reading);
    }
    return GNEISS_OK;
}

/* ---- one run ---- */

static void read_label(const gn_h5 *file, const char *set, const char *name, char *text,
                       size_t size) {
    char *found = NULL;
    if (text[0] || gn_h5_get_attribute_text(file, set, name, &found, NULL) != GNEISS_OK) return;
    snprintf(text, size, "%s", found);
    gn_make_printable(text);
    free(found);
}

/* Returns the last number of a column; NaN: it has no rows. */
static gneiss_status read_last(const gn_h5 *file, const char *set, double *last,
                               gneiss_error *error) {
    size_t rows = 0;
    *last = NAN;
    GN_TRY(gn_h5_rows(file, set, &rows, error));
    if (rows == 0) return GNEISS_OK;
    double *column = gn_alloc_array(rows, sizeof *column);
    if (!column) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu rows", rows);
    gneiss_status status = gn_h5_get(file, set, GN_F64, rows, 1, 0, column, error);
    if (status == GNEISS_OK) *last = column[rows - 1];
    gn_free(column);
    return status;
}

/* Reads a reading and its `rest`; NaN: the file has none. An unreadable value is an error, not an
 * absent reading. */
static gneiss_status read_reading(const gn_h5 *file, gn_summary_reading *reading, double *value,
                                  double *rest, gneiss_error *error) {
    char set[GN_NAME_SIZE + 32];
    bool of_energy = strncmp(reading->name, "energy.", 7) == 0,
         of_history = strncmp(reading->name, "history.", 8) == 0;
    snprintf(set, sizeof set, "%s/%s",
             of_energy    ? "energy"
             : of_history ? "history"
                          : "readings",
             reading->name + (of_energy    ? 7
                              : of_history ? 8
                                           : 0));
    if (!gn_h5_has(file, set)) return GNEISS_OK;
    read_label(file, set, "unit", reading->unit, sizeof reading->unit);
    read_label(file, set, "description", reading->text, sizeof reading->text);
    double besides;
    if (!of_energy && !of_history &&
        gn_h5_get_attribute_f64(file, set, "error_besides_scatter", &besides, 1, NULL) == GNEISS_OK)
        *rest = besides;
    return read_last(file, set, value, error);
}

/* Joins the warnings of a completed run into one line. */
static void read_warnings(const gn_h5 *file, char *text, size_t size) {
    text[0] = '\0';
    read_label(file, "/", "warnings", text, size);
    for (char *c = gn_make_printable(text); *c; c++)
        if (*c == '\n') *c = ';';
}

static gneiss_status read_run(gn_summary *summary, size_t k, const char *folder,
                              gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    gn_summary_run *run = &summary->runs[k];
    gn_h5 *file = NULL;
    char *hash = NULL, *build = NULL;
    snprintf(path, sizeof path, "%s/results.h5", folder);
    gneiss_status status = gn_h5_open(path, &file, error);
    if (status == GNEISS_OK)
        status = gn_h5_get_attribute_f64(file, "/", "seconds", &run->seconds, 1, error);
    if (status == GNEISS_OK) status = gn_h5_get_attribute_f64(file, "/", "dt", &run->dt, 1, error);
    if (status == GNEISS_OK)
        status = gn_h5_get_attribute_i64(file, "/", "steps", &run->steps, 1, error);
    if (status == GNEISS_OK)
        status = gn_h5_get_attribute_text(file, "/", "state_hash", &hash, error);
    if (status == GNEISS_OK) status = gn_h5_get_attribute_text(file, "/", "build", &build, error);
    if (status == GNEISS_OK) {
        snprintf(run->state_hash, sizeof run->state_hash, "%s", hash);
        snprintf(run->build, sizeof run->build, "%s", build);
        read_warnings(file, run->outcome.message, sizeof run->outcome.message);
    }
    for (size_t r = 0; status == GNEISS_OK && r < summary->reading_count; r++) {
        size_t place = k * summary->reading_count + r;
        status = read_reading(file, &summary->readings[r], &summary->value[place],
                              &summary->rest[place], error);
    }
    free(hash);
    free(build);
    gn_h5_close(file);
    return status;
}

/* A run with unreadable results counts as not completed, with the reason. */
static gneiss_status take_run(gn_summary *summary, size_t k, gneiss_error *error) {
    const gn_sweep *sweep = summary->sweep;
    gn_summary_run *run = &summary->runs[k];
    size_t original = sweep->runs[k].original, width = summary->reading_count;
    char folder[GN_PATH_SIZE];
    gneiss_error trouble = {0};
    if (original != k) {
        *run = summary->runs[original];
        memcpy(summary->value + k * width, summary->value + original * width,
               width * sizeof *summary->value);
        memcpy(summary->rest + k * width, summary->rest + original * width,
               width * sizeof *summary->rest);
        return GNEISS_OK;
    }
    run->seconds = run->dt = NAN;
    for (size_t r = 0; r < width; r++)
        summary->value[k * width + r] = summary->rest[k * width + r] = NAN;
    if (!gn_run_folder(summary->directory, sweep->runs[k].hash, folder))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%.200s...: the path is too long",
                       summary->directory);
    GN_TRY(gn_outcome_read(folder, &run->outcome, error));
    if (run->outcome.state != GN_RUN_DONE) return GNEISS_OK;
    gneiss_status status = read_run(summary, k, folder, &trouble);
    if (status == GNEISS_OK) return GNEISS_OK;
    run->outcome = (gn_outcome){.state = GN_RUN_FAILED, .code = (int)status};
    snprintf(run->outcome.message, sizeof run->outcome.message,
             "its results cannot be read: %.500s", trouble.message);
    return GNEISS_OK;
}

/* ---- all runs ---- */

/* Leaves out readings that no run has, unless they were requested. */
static void leave_out_absent(gn_summary *summary) {
    size_t width = summary->reading_count, kept = 0;
    bool keep[USUAL];
    if (summary->sweep->reading_count || summary->done == 0) return;
    for (size_t r = 0; r < width; r++) {
        keep[r] = false;
        for (size_t k = 0; k < summary->sweep->run_count; k++)
            keep[r] |= !isnan(summary->value[k * width + r]);
        if (keep[r]) summary->readings[kept++] = summary->readings[r];
    }
    for (size_t k = 0; k < summary->sweep->run_count; k++)
        for (size_t r = 0, to = 0; r < width; r++) {
            if (!keep[r]) continue;
            summary->value[k * kept + to] = summary->value[k * width + r];
            summary->rest[k * kept + to++] = summary->rest[k * width + r];
        }
    summary->reading_count = kept;
}

double gn_summary_rest(const gn_summary *summary, size_t combination, size_t reading) {
    size_t each = summary->sweep->run_count / summary->sweep->combination_count;
    double most = NAN;
    for (size_t k = combination * each; k < (combination + 1) * each; k++)
        most = fmax(
            most,
            summary->rest[k * summary->reading_count + reading]); /* NaN is less than any number */
    return most;
}

static void compute_statistics(gn_summary *summary) {
    size_t width = summary->reading_count,
           each = summary->sweep->run_count / summary->sweep->combination_count;
    for (size_t c = 0; c < summary->sweep->combination_count; c++)
        for (size_t r = 0; r < width; r++)
            summary->statistics[c * width + r] =
                gn_statistics_of(summary->value + c * each * width + r, each, width);
}

gneiss_status gn_summary_make(const gn_sweep *sweep, const char *directory, gn_summary *summary,
                              gneiss_error *error) {
    const char *build = NULL;
    *summary = (gn_summary){.sweep = sweep, .directory = directory};
    gneiss_status status = choose_readings(summary, error);
    for (size_t k = 0; status == GNEISS_OK && k < sweep->run_count; k++) {
        status = take_run(summary, k, error);
        bool done = summary->runs[k].outcome.state == GN_RUN_DONE;
        summary->done += done;
        summary->failed += summary->runs[k].outcome.state == GN_RUN_FAILED;
        if (done && build) summary->several_builds |= strcmp(build, summary->runs[k].build) != 0;
        if (done) build = summary->runs[k].build;
    }
    if (status != GNEISS_OK) {
        gn_summary_free(summary);
        return status;
    }
    leave_out_absent(summary);
    compute_statistics(summary);
    return GNEISS_OK;
}

void gn_summary_free(gn_summary *summary) {
    gn_free(summary->readings);
    gn_free(summary->value);
    gn_free(summary->rest);
    gn_free(summary->runs);
    gn_free(summary->statistics);
    *summary = (gn_summary){0};
}

/* ---- ownership of folders ---- */

gneiss_status gn_summary_check_folder(const char *directory, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32], *kind = NULL;
    static const char *const own[] = {"sweep.csv", "sweep-means.csv"};
    size_t checkpoints = 0;
    int64_t step;
    if (access(directory, F_OK) != 0) return GNEISS_OK;
    snprintf(path, sizeof path, "%s/results.h5", directory);
    if (access(path, F_OK) != 0)
        GN_TRY(gn_checkpoint_list(directory, &step, 1, &checkpoints, error));
    if (checkpoints || access(path, F_OK) == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.300s: expected a folder for a sweep, found a run in it: choose another "
                       "with --out",
                       directory);
    snprintf(path, sizeof path, "%s/sweep.h5", directory);
    if (access(path, F_OK) == 0) {
        gneiss_status status = gn_h5_peek_text(path, "/", "kind", &kind, NULL);
        bool ours =
            status == GNEISS_OK ? strcmp(kind, "sweep") == 0 : gn_folder_holds_sweep(directory);
        free(kind);
        if (ours) return GNEISS_OK; /* a damaged one is rewritten from the folders of the runs */
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.300s: expected no file or that of a sweep: choose another folder with "
                       "--out, or --force replaces it",
                       path);
    }
    for (size_t k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/%s", directory, own[k]);
        if (access(path, F_OK) != 0) continue;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.300s: a file of another program, without sweep.h5 beside it: choose "
                       "another folder with --out, or --force replaces it",
                       path);
    }
    return GNEISS_OK;
}
