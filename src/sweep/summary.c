#include "sweep/summary.h"

#include "base/new.h"
#include "base/printable.h"
#include "io/h5.h"
#include "io/io.h"
#include "io/listing.h"
#include "measure/energy.h"
#include "run/folder.h"
#include "sweep/sweep.h"
#include "test_kinds/readings.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- outcome of a run, read from its folder, so that a sweep can be killed at any time ---- */

static const char *const names[] = {"new", "interrupted", "done", "failed"};

const char *gn_run_state_name(gn_run_state state) {
    return names[state];
}

bool gn_run_folder(const char *directory, uint64_t hash, char folder[GN_PATH_SIZE]) {
    int length = snprintf(folder, GN_PATH_SIZE, "%s/%016" PRIx64, directory, hash);
    return length > 0 && length < GN_PATH_SIZE - 64;
}

static void outcome_path(const char *folder, char *path, size_t size) {
    snprintf(path, size, "%s/outcome.json", folder);
}

/* Parses outcome.json as YAML, which includes JSON. *results (malloc'ed, NULL: missing) is the
 * digest of the results at the end of the run. */
static bool parse(const char *text, const char *path, gn_outcome *outcome, char **results) {
    gn_tree *tree = NULL;
    if (gn_tree_read(text, strlen(text), path, &tree, NULL) != GNEISS_OK) return false;
    const gn_node *root = gn_tree_root(tree), *state = gn_node_child(root, "status"),
                  *code = gn_node_child(root, "code"), *message = gn_node_child(root, "message"),
                  *digest = gn_node_child(root, "results");
    bool known = state && code && state->kind == GN_NODE_SCALAR && code->kind == GN_NODE_SCALAR;
    bool done = known && strcmp(state->text, names[GN_RUN_DONE]) == 0;
    known = done || (known && strcmp(state->text, names[GN_RUN_FAILED]) == 0);
    if (known) {
        outcome->state = done ? GN_RUN_DONE : GN_RUN_FAILED;
        outcome->code = (int)strtol(code->text, NULL, 10);
        if (message && message->kind == GN_NODE_SCALAR)
            snprintf(outcome->message, sizeof outcome->message, "%s", message->text);
        gn_make_printable(outcome->message);
        if (digest && digest->kind == GN_NODE_SCALAR) *results = strdup(digest->text);
    }
    gn_tree_free(tree);
    return known;
}

/* True if the end of the scene's path, FOLDER/scene.yaml, is that of the run's folder. */
static bool of_folder(const char *scene_file, const char *folder) {
    const char *slash = strrchr(folder, '/'), *own = slash ? slash + 1 : folder;
    char tail[GN_PATH_SIZE];
    snprintf(tail, sizeof tail, "%.200s/scene.yaml", own);
    size_t length = strlen(scene_file), behind = strlen(tail);
    if (length < behind || strcmp(scene_file + length - behind, tail) != 0) return false;
    return length == behind || scene_file[length - behind - 1] == '/';
}

static gneiss_status check_owner(const gn_h5 *file, const char *path, const char *folder,
                                 gneiss_error *error) {
    char *scene = NULL;
    GN_TRY(gn_h5_get_attribute_text(file, "/", "scene_file", &scene, error));
    gneiss_status status = of_folder(scene, folder)
                               ? GNEISS_OK
                               : gn_fail(error, GNEISS_ERROR_INPUT,
                                         "%.200s: it belongs to another run (%.200s)", path, scene);
    free(scene);
    return status;
}

/* Reads the digest of the results; "": a version that wrote no digests made them. */
static gneiss_status digest_of_results(const gn_h5 *file, char digest[24], gneiss_error *error) {
    int64_t value = 0;
    digest[0] = '\0';
    if (!gn_h5_has_digests(file)) return GNEISS_OK;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "digest_of_names", &value, 1, error));
    snprintf(digest, 24, "%016" PRIx64, (uint64_t)value);
    return GNEISS_OK;
}

/* Checks all contents, including those that no summary reads, because they count as results of the
 * run. */
static gneiss_status check_contents(gn_h5 *file, const char *path, const char *folder,
                                    const char *results, bool *replaced, gneiss_error *error) {
    char *hash = NULL, digest[24];
    GN_TRY(gn_h5_check_names(file, false, error));
    GN_TRY(gn_h5_get_attribute_text(file, "/", "state_hash", &hash, error));
    free(hash);
    GN_TRY(check_owner(file, path, folder, error));
    GN_TRY(gn_h5_check_values(file, error));
    GN_TRY(digest_of_results(file, digest, error));
    *replaced = strcmp(results ? results : "", digest) != 0;
    if (!*replaced) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.200s: they differ from the results at the end of the run%s", path,
                   results ? "" : ", which outcome.json does not name");
}

/* Tells whether a folder has the results of its run. They may be missing or different if the disk
 * was full, the file was removed or replaced, or a copy was truncated. */
static bool has_results(const char *folder, const char *results, bool *replaced,
                        gneiss_error *trouble) {
    char path[GN_PATH_SIZE + 32];
    GN_FREED_BY(gn_h5_close_at) gn_h5 *file = NULL;
    snprintf(path, sizeof path, "%s/results.h5", folder);
    return gn_h5_open(path, &file, trouble) == GNEISS_OK &&
           check_contents(file, path, folder, results, replaced, trouble) == GNEISS_OK;
}

/* Marks the results as unusable: the run is computed again, from its last checkpoint if there is
 * one. */
static void mark_lost(gn_outcome *outcome, const char *what, const gneiss_error *trouble) {
    *outcome = (gn_outcome){.lost = true};
    snprintf(outcome->message, sizeof outcome->message, "its %s cannot be read: %.500s", what,
             trouble->message);
}

/* Tells whether a checkpoint is of another run; an unreadable one is left to `resume`. */
static bool is_foreign(const char *folder, int64_t step, gneiss_error *trouble) {
    char *path = NULL, *scene = NULL;
    if (gn_checkpoint_path(folder, step, &path, NULL) != GNEISS_OK) return false;
    bool read = gn_h5_peek_text(path, "/", "scene_file", &scene, NULL) == GNEISS_OK;
    bool foreign = read && !of_folder(scene, folder);
    if (foreign)
        gn_fail(trouble, GNEISS_ERROR_INPUT, "%.200s: it belongs to another run (%.200s)", path,
                scene);
    free(scene);
    free(path);
    return foreign;
}

enum { CHECKPOINTS_MOST = 16 };

gneiss_status gn_outcome_rename_foreign(const char *folder, gneiss_error *error) {
    int64_t step[CHECKPOINTS_MOST];
    size_t count = 0;
    gneiss_error trouble;
    GN_TRY(gn_checkpoint_list(folder, step, CHECKPOINTS_MOST, &count, error));
    for (size_t k = 0; k < count; k++)
        if (is_foreign(folder, step[k], &trouble))
            GN_TRY(gn_checkpoint_set_aside(folder, step[k], error));
    return GNEISS_OK;
}

/* Sets the state depending on whether there is a checkpoint from which to resume; checkpoints of
 * another run do not count. */
static gneiss_status look_for_checkpoints(const char *folder, gn_outcome *outcome,
                                          gneiss_error *error) {
    int64_t step[CHECKPOINTS_MOST];
    size_t count = 0;
    gneiss_error trouble = {0};
    if (access(folder, F_OK) != 0) return GNEISS_OK;
    GN_TRY(gn_checkpoint_list(folder, step, CHECKPOINTS_MOST, &count, error));
    for (size_t k = 0; k < count; k++) {
        if (!is_foreign(folder, step[k], &trouble))
            outcome->state = GN_RUN_INTERRUPTED;
        else if (!outcome->lost)
            mark_lost(outcome, "checkpoint", &trouble);
    }
    return GNEISS_OK;
}

/* Reads outcome.json. If it exists and cannot be read, *known is false and outcome->lost is true.
 */
static void read_outcome(const char *folder, gn_outcome *outcome, char **results, bool *known) {
    char path[GN_PATH_SIZE + 32], *text = NULL;
    gneiss_error trouble = {0};
    outcome_path(folder, path, sizeof path);
    *known = false;
    if (access(path, F_OK) != 0) return;
    if (gn_read_text_file(path, 1 << 16, &text, &trouble) == GNEISS_OK)
        *known = parse(text, path, outcome, results);
    if (!*known && text)
        gn_fail(&trouble, GNEISS_ERROR_INPUT,
                "%.300s: expected status (done, failed) and code, found others", path);
    free(text);
    if (!*known) mark_lost(outcome, "outcome", &trouble);
}

gneiss_status gn_outcome_read(const char *folder, gn_outcome *outcome, gneiss_error *error) {
    char *results = NULL;
    bool known, replaced = false;
    gneiss_error trouble = {0};
    *outcome = (gn_outcome){0};
    read_outcome(folder, outcome, &results, &known);
    bool whole = known && (outcome->state != GN_RUN_DONE ||
                           has_results(folder, results, &replaced, &trouble));
    free(results);
    if (whole) return GNEISS_OK;
    if (known) mark_lost(outcome, "results", &trouble);
    outcome->replaced = replaced;
    return replaced ? GNEISS_OK : look_for_checkpoints(folder, outcome, error);
}

/* Reads the digest of the results in a folder; "" if they cannot be read, which the next call will
 * find. */
static void digest_in_folder(const char *folder, char digest[24]) {
    char path[GN_PATH_SIZE + 32];
    gn_h5 *file = NULL;
    digest[0] = '\0';
    snprintf(path, sizeof path, "%s/results.h5", folder);
    if (gn_h5_open(path, &file, NULL) != GNEISS_OK) return;
    if (digest_of_results(file, digest, NULL) != GNEISS_OK) digest[0] = '\0';
    gn_h5_close(file);
}

/* The file is not synced: if a power failure loses it, the run is resumed from its last checkpoint,
 * which is at its end. */
gneiss_status gn_outcome_write(const char *folder, const gn_outcome *outcome, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32], digest[24] = "";
    if (outcome->state == GN_RUN_DONE) digest_in_folder(folder, digest);
    gn_json *json = gn_json_begin();
    gn_json_text(json, "status", names[outcome->state]);
    gn_json_integer(json, "code", outcome->code);
    gn_json_text(json, "message", outcome->message);
    if (*digest) gn_json_text(json, "results", digest);
    GN_FREED char *text = gn_json_finish(json, true);
    if (!text) return gn_no_memory(error, "outcome.json");
    outcome_path(folder, path, sizeof path);
    return gn_write_text_file(path, text, GN_RENAMED, error);
}

void gn_outcome_remove(const char *folder, bool lost) {
    char path[GN_PATH_SIZE + 32];
    outcome_path(folder, path, sizeof path);
    (void)unlink(path);
    snprintf(path, sizeof path, "%s/results.h5", folder);
    if (lost) (void)unlink(path);
}

bool gn_outcome_is_final(const gn_outcome *outcome) {
    return outcome->state == GN_RUN_DONE ||
           (outcome->state == GN_RUN_FAILED && outcome->code == GNEISS_ERROR_UNSTABLE);
}

/* ---- statistics over several runs of one kind ---- */

static const double pi = 3.14159265358979323846;

/* Returns the probability that Student's t lies within +- t, for `freedom` degrees of freedom
 * (Abramowitz & Stegun 26.7.3 and 26.7.4). */
static double gn_student_within(double t, size_t freedom) {
    double angle = atan2(t, sqrt((double)freedom)), c = cos(angle), c2 = c * c;
    bool odd = freedom % 2 == 1;
    /* odd: cos + 2/3 cos^3 + 2.4/(3.5) cos^5 + ...; even: 1 + 1/2 cos^2 + 1.3/(2.4) cos^4 + ... */
    double term = odd ? c : 1.0, sum = freedom == 1 ? 0.0 : term;
    for (size_t k = odd ? 3 : 2; k + 2 <= freedom; k += 2) {
        term *= c2 * (double)(k - 1) / (double)k;
        sum += term;
    }
    return odd ? 2.0 / pi * (angle + sin(angle) * sum) : sin(angle) * sum;
}

/* Bisection from an upper bound; the probability increases with t. */
double gn_student_quantile(double within, size_t freedom) {
    double low = 0.0, high = 1.0;
    while (gn_student_within(high, freedom) < within && high < 1e300) high *= 2.0;
    for (int k = 0; k < 200 && high - low > 4e-16 * high; k++) {
        double middle = 0.5 * (low + high);
        if (gn_student_within(middle, freedom) < within)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

gn_statistics gn_statistics_of(const double *values, size_t count, size_t stride) {
    gn_statistics s = {0, NAN, NAN, NAN};
    double sum = 0.0, squares = 0.0;
    for (size_t k = 0; k < count; k++) {
        if (!isfinite(values[k * stride])) continue;
        sum += values[k * stride];
        s.count++;
    }
    if (s.count == 0) return s;
    s.mean = sum / (double)s.count;
    for (size_t k = 0; k < count; k++) {
        double off = values[k * stride] - s.mean;
        if (isfinite(off)) squares += off * off;
    }
    if (s.count < 2) return s;
    s.deviation = sqrt(squares / (double)(s.count - 1));
    s.interval = gn_student_quantile(0.95, s.count - 1) * s.deviation / sqrt((double)s.count);
    return s;
}

/* ---- choice of readings ---- */

static void describe(gn_summary_reading *reading, const char *name, const char *unit,
                     const char *text) {
    snprintf(reading->name, sizeof reading->name, "%s", name);
    snprintf(reading->unit, sizeof reading->unit, "%s", unit);
    snprintf(reading->text, sizeof reading->text, "%s", text);
}

/* Describes a reading; descriptions of history columns are in the files of the runs. */
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
    const size_t count = summary->reading_count;
    GN_TRY(gn_new(&summary->readings, count, "readings", error));
    GN_TRY(gn_new(&summary->value, sweep->run_count * count, "values", error));
    GN_TRY(gn_new(&summary->rest, sweep->run_count * count, "errors", error));
    GN_TRY(gn_new(&summary->runs, sweep->run_count, "runs", error));
    GN_TRY(gn_new(&summary->statistics, sweep->combination_count * count, "means", error));
    for (size_t k = 0; k < count; k++) {
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
    GN_FREED double *column = NULL;
    *last = NAN;
    GN_TRY(gn_h5_rows(file, set, &rows, error));
    if (rows == 0) return GNEISS_OK;
    GN_TRY(gn_new(&column, rows, "rows", error));
    GN_TRY(gn_h5_get(file, set, GN_F64, rows, 1, 0, column, error));
    *last = column[rows - 1];
    return GNEISS_OK;
}

/* Reads a reading and its `rest`; NaN: the file has none. A value that cannot be read is an error
 * and not an absent reading. */
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
    GN_FREED_BY(gn_h5_close_at) gn_h5 *file = NULL;
    GN_FREED char *hash = NULL, *build = NULL;
    snprintf(path, sizeof path, "%s/results.h5", folder);
    GN_TRY(gn_h5_open(path, &file, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "seconds", &run->seconds, 1, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "dt", &run->dt, 1, error));
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "steps", &run->steps, 1, error));
    GN_TRY(gn_h5_get_attribute_text(file, "/", "state_hash", &hash, error));
    GN_TRY(gn_h5_get_attribute_text(file, "/", "build", &build, error));
    snprintf(run->state_hash, sizeof run->state_hash, "%s", hash);
    snprintf(run->build, sizeof run->build, "%s", build);
    read_warnings(file, run->outcome.message, sizeof run->outcome.message);
    for (size_t r = 0; r < summary->reading_count; r++) {
        const size_t place = k * summary->reading_count + r;
        GN_TRY(read_reading(file, &summary->readings[r], &summary->value[place],
                            &summary->rest[place], error));
    }
    return GNEISS_OK;
}

/* Reads a run; one with unreadable results counts as not completed, with the reason. */
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

/* Removes readings that no run has, unless they were requested. */
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
            summary->rest[k * summary->reading_count + reading]); /* no number is less than NaN */
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
    GN_TRY(gn_folder_check_use(directory, GN_FOLDER_OF_RUNS, error));
    snprintf(path, sizeof path, "%s/sweep.h5", directory);
    if (access(path, F_OK) == 0) {
        gneiss_status status = gn_h5_peek_text(path, "/", "kind", &kind, NULL);
        bool ours =
            status == GNEISS_OK ? strcmp(kind, "sweep") == 0 : gn_folder_holds_sweep(directory);
        free(kind);
        if (ours)
            return GNEISS_OK; /* ours may be damaged: it is rewritten from the folders of the runs
                               */
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
