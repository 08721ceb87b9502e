/* Files of the summary. */
#include "base/new.h"
#include "base/version.h"
#include "io/h5.h"
#include "io/io.h"
#include "sweep/envelope.h"
#include "sweep/range.h"
#include "sweep/summary.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- CSV ---- */

/* Writes a cell as RFC 4180 requires. */
static void put_cell(FILE *out, const char *text) {
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"') fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

/* Writes a number; an absent one is an empty cell. */
static void put_number(FILE *out, double value) {
    char text[40];
    if (isnan(value)) return;
    gn_number_text(value, text, sizeof text);
    fputs(text, out);
}

/* Writes "peak_stress [Pa]", "peak_stress mean [Pa]". */
static void put_head(FILE *out, const char *name, const char *what, const char *unit) {
    char text[512];
    bool shown = unit[0] && strcmp(unit, "1") != 0;
    snprintf(text, sizeof text, "%s%s%s%s%s%s", name, *what ? " " : "", what, shown ? " [" : "",
             shown ? unit : "", shown ? "]" : "");
    put_cell(out, text);
}

static void put_parameter_heads(FILE *out, const gn_sweep *sweep) {
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        put_head(out, sweep->parameters[p].key, "", sweep->parameters[p].unit);
        fputc(',', out);
    }
}

static void put_parameters(FILE *out, const gn_sweep *sweep, size_t run) {
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        const gn_sweep_value *value = gn_sweep_value_of(sweep, run, p);
        if (sweep->parameters[p].numeric)
            put_number(out, value->number);
        else
            put_cell(out, value->text);
        fputc(',', out);
    }
}

static void put_row(FILE *out, const gn_summary *summary, size_t k) {
    const gn_sweep *sweep = summary->sweep;
    const gn_summary_run *run = &summary->runs[k];
    fprintf(out, "%zu,%zu,", k + 1, sweep->runs[k].combination + 1);
    put_parameters(out, sweep, k);
    fprintf(out, "%" PRIu64 ",", sweep->runs[k].seed);
    for (size_t r = 0; r < summary->reading_count; r++) {
        put_number(out, summary->value[k * summary->reading_count + r]);
        fputc(',', out);
    }
    fprintf(out, "%s,", gn_run_state_name(run->outcome.state));
    put_number(out, run->seconds);
    fputc(',', out);
    if (run->outcome.state == GN_RUN_DONE) fprintf(out, "%" PRId64, run->steps);
    fputc(',', out);
    put_number(out, run->dt);
    fprintf(out, ",%s,%016" PRIx64 ",", run->state_hash, sweep->runs[k].hash);
    put_cell(out, run->outcome.message);
    fputs("\r\n", out);
}

static void write_runs(FILE *out, const gn_summary *summary) {
    fputs("run,combination,", out);
    put_parameter_heads(out, summary->sweep);
    fputs("seed,", out);
    for (size_t r = 0; r < summary->reading_count; r++) {
        put_head(out, summary->readings[r].name, "", summary->readings[r].unit);
        fputc(',', out);
    }
    fputs("status,seconds [s],steps,dt [s],state_hash,folder,message\r\n", out);
    for (size_t k = 0; k < summary->sweep->run_count; k++) put_row(out, summary, k);
}

static void write_means(FILE *out, const gn_summary *summary) {
    const gn_sweep *sweep = summary->sweep;
    size_t width = summary->reading_count, each = sweep->run_count / sweep->combination_count;
    fputs("combination,", out);
    put_parameter_heads(out, sweep);
    fputs("runs", out);
    for (size_t r = 0; r < width; r++) {
        static const char *const what[] = {"mean", "deviation", "interval", "rest"};
        for (size_t k = 0; k < 4; k++) {
            fputc(',', out);
            put_head(out, summary->readings[r].name, what[k], summary->readings[r].unit);
        }
        fputc(',', out);
        put_head(out, summary->readings[r].name, "count", "");
    }
    fputs("\r\n", out);
    for (size_t c = 0; c < sweep->combination_count; c++) {
        size_t done = 0;
        for (size_t k = c * each; k < (c + 1) * each; k++)
            done += summary->runs[k].outcome.state == GN_RUN_DONE;
        fprintf(out, "%zu,", c + 1);
        put_parameters(out, sweep, c * each);
        fprintf(out, "%zu", done);
        for (size_t r = 0; r < width; r++) {
            const gn_statistics *statistics = &summary->statistics[c * width + r];
            const double shown[] = {statistics->mean, statistics->deviation, statistics->interval,
                                    gn_summary_rest(summary, c, r)};
            for (size_t k = 0; k < 4; k++) {
                fputc(',', out);
                put_number(out, shown[k]);
            }
            fprintf(out, ",%zu", statistics->count);
        }
        fputs("\r\n", out);
    }
}

static gneiss_status write_table(const gn_summary *summary, const char *name,
                                 void (*write)(FILE *out, const gn_summary *summary),
                                 gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    GN_FREED char *text = NULL;
    size_t size;
    FILE *out;
    GN_TRY(gn_text_open(&text, &size, &out, name, error));
    write(out, summary);
    GN_TRY(gn_text_close(out, name, error));
    snprintf(path, sizeof path, "%s/%s", summary->directory, name);
    return gn_write_text_file(path, text, GN_RENAMED, error);
}

/* ---- HDF5 ---- */

/* Writes texts, one per line. */
static gneiss_status put_lines(gn_h5 *file, const char *name, const gn_summary *summary,
                               void (*line)(FILE *out, const gn_summary *summary, size_t k),
                               size_t count, gneiss_error *error) {
    GN_FREED char *text = NULL;
    size_t size;
    FILE *out;
    GN_TRY(gn_text_open(&text, &size, &out, name, error));
    for (size_t k = 0; k < count; k++) {
        if (k) fputc('\n', out);
        line(out, summary, k);
    }
    GN_TRY(gn_text_close(out, name, error));
    return gn_h5_put_text(file, name, text, error);
}

static void hash_line(FILE *out, const gn_summary *summary, size_t k) {
    fputs(summary->runs[k].state_hash, out);
}

static void folder_line(FILE *out, const gn_summary *summary, size_t k) {
    fprintf(out, "%016" PRIx64, summary->sweep->runs[k].hash);
}

static void message_line(FILE *out, const gn_summary *summary, size_t k) {
    for (const char *c = summary->runs[k].outcome.message; *c; c++)
        fputc(*c == '\n' ? ' ' : *c, out);
}

static gneiss_status put_header(gn_h5 *file, const gn_summary *summary, gneiss_error *error) {
    const gn_sweep *sweep = summary->sweep;
    const char *texts[][2] = {{"kind", "sweep"},
                              {"title", sweep->title},
                              {"sweep_file", sweep->source},
                              {"scene_file", sweep->scene},
                              {"version", gn_version()},
                              {"build", gn_build()}};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        GN_TRY(gn_h5_attribute_text(file, "/", texts[k][0], texts[k][1], error));
    const int64_t counts[] = {(int64_t)sweep->run_count, (int64_t)sweep->combination_count,
                              (int64_t)sweep->seed_count, (int64_t)summary->done,
                              (int64_t)summary->failed};
    static const char *const names[] = {"runs", "combinations", "seeds", "done", "failed"};
    for (size_t k = 0; k < 5; k++)
        GN_TRY(gn_h5_attribute_i64(file, "/", names[k], &counts[k], 1, error));
    GN_TRY(gn_h5_put_text(file, "sweep", sweep->text ? sweep->text : "", error));
    return gn_h5_put_text(file, "scene", sweep->scene_text, error);
}

/* Writes numbers in SI; other values as their index among the texts of the attribute `values`. */
static gneiss_status put_parameter(gn_h5 *file, const gn_summary *summary, size_t p, double *column,
                                   gneiss_error *error) {
    const gn_sweep *sweep = summary->sweep;
    const gn_sweep_parameter *parameter = &sweep->parameters[p];
    char name[GN_KEY_PATH_SIZE + 32];
    GN_FREED char *text = NULL;
    size_t size;
    FILE *out;
    snprintf(name, sizeof name, "parameters/%s", parameter->key);
    for (char *c = name + strlen("parameters/"); *c; c++)
        if (*c == '/') *c = '_';
    for (size_t k = 0; k < sweep->run_count; k++)
        column[k] = parameter->numeric ? gn_sweep_value_of(sweep, k, p)->number
                                       : (double)sweep->chosen[sweep->runs[k].first_value + p];
    GN_TRY(gn_h5_put(file, name, GN_F64, sweep->run_count, 1, 0, column,
                     *parameter->unit ? parameter->unit : "1", parameter->meant->text, error));
    int64_t sampled = parameter->sampled;
    GN_TRY(gn_h5_attribute_i64(file, name, "sampled", &sampled, 1, error));
    if (parameter->numeric) return GNEISS_OK;
    GN_TRY(gn_text_open(&text, &size, &out, name, error));
    for (size_t k = 0; k < parameter->count; k++)
        fprintf(out, "%s%s", k ? "\n" : "", parameter->values[k].text);
    GN_TRY(gn_text_close(out, name, error));
    return gn_h5_attribute_text(file, name, "values", text, error);
}

static gneiss_status put_reading(gn_h5 *file, const gn_summary *summary, size_t r, double *column,
                                 gneiss_error *error) {
    static const char *const what[] = {"count", "mean", "deviation", "interval", "rest"};
    static const char *const texts[] = {"runs that have the reading", "mean over these runs",
                                        "standard deviation of one run",
                                        "half the width of the 95 % interval of the mean",
                                        "largest error of a run that more runs do not reduce"};
    const gn_sweep *sweep = summary->sweep;
    const gn_summary_reading *reading = &summary->readings[r];
    size_t width = summary->reading_count;
    char name[GN_NAME_SIZE + 64];
    snprintf(name, sizeof name, "readings/%s", reading->name);
    for (size_t k = 0; k < sweep->run_count; k++) column[k] = summary->value[k * width + r];
    GN_TRY(gn_h5_put(file, name, GN_F64, sweep->run_count, 1, 0, column, reading->unit,
                     reading->text, error));
    for (size_t q = 0; q < 5; q++) {
        for (size_t c = 0; c < sweep->combination_count; c++) {
            const gn_statistics *statistics = &summary->statistics[c * width + r];
            const double shown[] = {(double)statistics->count, statistics->mean,
                                    statistics->deviation, statistics->interval,
                                    gn_summary_rest(summary, c, r)};
            column[c] = shown[q];
        }
        snprintf(name, sizeof name, "statistics/%s/%s", reading->name, what[q]);
        GN_TRY(gn_h5_put(file, name, GN_F64, sweep->combination_count, 1, 0, column,
                         q ? reading->unit : "1", texts[q], error));
    }
    return GNEISS_OK;
}

static gneiss_status put_runs(gn_h5 *file, const gn_summary *summary, double *column,
                              gneiss_error *error) {
    static const struct {
        const char *name, *unit, *text;
    } columns[] = {{"runs/combination", "1", "base 0; its runs differ in the seed"},
                   {"runs/seed", "1", "run.seed"},
                   {"runs/status", "1", "0 new, 1 interrupted, 2 done, 3 failed"},
                   {"runs/steps", "1", "steps taken"},
                   {"runs/seconds", "s", "of computing"},
                   {"runs/dt", "s", "time step"}};
    for (size_t q = 0; q < sizeof columns / sizeof *columns; q++) {
        for (size_t k = 0; k < summary->sweep->run_count; k++) {
            const gn_sweep_run *run = &summary->sweep->runs[k];
            const double shown[] = {(double)run->combination,
                                    (double)run->seed,
                                    (double)summary->runs[k].outcome.state,
                                    (double)summary->runs[k].steps,
                                    summary->runs[k].seconds,
                                    summary->runs[k].dt};
            column[k] = shown[q];
        }
        GN_TRY(gn_h5_put(file, columns[q].name, GN_F64, summary->sweep->run_count, 1, 0, column,
                         columns[q].unit, columns[q].text, error));
    }
    GN_TRY(
        put_lines(file, "runs/state_hash", summary, hash_line, summary->sweep->run_count, error));
    GN_TRY(put_lines(file, "runs/folder", summary, folder_line, summary->sweep->run_count, error));
    return put_lines(file, "runs/message", summary, message_line, summary->sweep->run_count, error);
}

/* Writes a reading of every envelope; `absent` has the reasons for missing numbers, one per line.
 */
static gneiss_status put_envelope_reading(gn_h5 *file, const gn_envelopes *envelopes, size_t offset,
                                          bool coulomb, const char *labels[3], double *column,
                                          gneiss_error *error) {
    char path[GN_NAME_SIZE + 16];
    GN_FREED char *reasons = NULL;
    bool absent = false;
    size_t size;
    FILE *out;
    GN_TRY(gn_text_open(&reasons, &size, &out, labels[0], error));
    for (size_t k = 0; k < envelopes->count; k++) {
        memcpy(&column[k], (const char *)&envelopes->of[k] + offset, sizeof column[k]);
        if (k) fputc('\n', out);
        if (isnan(column[k]))
            fputs(coulomb ? envelopes->of[k].no_coulomb : envelopes->of[k].no_hoek_brown, out);
        absent |= isnan(column[k]);
    }
    GN_TRY(gn_text_close(out, labels[0], error));
    snprintf(path, sizeof path, "envelope/%s", labels[0]);
    GN_TRY(
        gn_h5_put(file, path, GN_F64, envelopes->count, 1, 0, column, labels[1], labels[2], error));
    return absent ? gn_h5_attribute_text(file, path, "absent", reasons, error) : GNEISS_OK;
}

/* Writes the parameters and the runs of each envelope. */
static gneiss_status put_envelope_runs(gn_h5 *file, const gn_summary *summary,
                                       const gn_envelopes *envelopes, double *column,
                                       gneiss_error *error) {
    char label[512];
    GN_FREED char *text = NULL;
    size_t size;
    FILE *out;
    for (size_t k = 0; k < summary->sweep->run_count; k++) column[k] = (double)envelopes->of_run[k];
    GN_TRY(gn_h5_put(file, "runs/envelope", GN_F64, summary->sweep->run_count, 1, 0, column, "1",
                     "place in the data sets of /envelope, base 0; -1: in none", error));
    GN_TRY(gn_text_open(&text, &size, &out, "the envelopes", error));
    for (size_t k = 0; k < envelopes->count; k++)
        fprintf(out, "%s%s", k ? "\n" : "",
                gn_envelope_label(summary, envelopes, k, label, sizeof label));
    GN_TRY(gn_text_close(out, "the envelopes", error));
    return gn_h5_put_text(file, "envelope/of", text, error);
}

static gneiss_status put_envelopes(gn_h5 *file, const gn_summary *summary, double *column,
                                   gneiss_error *error) {
    GN_FREED_BY(gn_envelopes_free) gn_envelopes e = {0};
    GN_TRY(gn_envelopes_make(summary, &e, error));
    if (!e.count) return GNEISS_OK;
#define X(name, unit, text)                                                                        \
    GN_TRY(put_envelope_reading(file, &e, offsetof(gn_envelope, name),                             \
                                strncmp(#name, "hoek", 4) != 0,                                    \
                                (const char *[]){#name, unit, text}, column, error));
    GN_ENVELOPE_READINGS(X)
#undef X
    return put_envelope_runs(file, summary, &e, column, error);
}

static gneiss_status write_h5(const gn_summary *summary, double *column, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    GN_FREED_BY(gn_h5_close_at) gn_h5 *file = NULL;
    snprintf(path, sizeof path, "%s/sweep.h5", summary->directory);
    GN_TRY(gn_h5_create(path, &file, error));
    GN_TRY(put_header(file, summary, error));
    GN_TRY(put_runs(file, summary, column, error));
    for (size_t p = 0; p < summary->sweep->parameter_count; p++)
        GN_TRY(put_parameter(file, summary, p, column, error));
    for (size_t r = 0; r < summary->reading_count; r++)
        GN_TRY(put_reading(file, summary, r, column, error));
    GN_TRY(put_envelopes(file, summary, column, error));
    return gn_h5_commit(&file, GN_SYNCED, error);
}

gneiss_status gn_summary_write(const gn_summary *summary, gneiss_error *error) {
    GN_FREED double *column = NULL;
    GN_TRY(gn_new(&column, summary->sweep->run_count, "runs", error));
    GN_TRY(write_h5(summary, column, error));
    GN_TRY(write_table(summary, "sweep.csv", write_runs, error));
    return write_table(summary, "sweep-means.csv", write_means, error);
}
