#include "cli/sweep_show.h"

#include "base/printable.h"
#include "base/timer.h"
#include "cli/line.h"
#include "cli/log.h"
#include "cli/progress.h"
#include "io/io.h"
#include "sweep/envelope.h"

#include <inttypes.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LABEL = 400 };

/* ---- progress ---- */

static void json_progress(const gn_sweep_display *display, const gn_sweep_progress *progress) {
    char folder[24], label[LABEL];
    gn_json *json = gn_json_begin();
    gn_json_text(json, "sweep", progress->what ? progress->what : "progress");
    if (progress->what) {
        snprintf(folder, sizeof folder, "%016" PRIx64, display->sweep->runs[progress->last].hash);
        gn_json_integer(json, "run", (int64_t)progress->last + 1);
        gn_json_text(json, "folder", folder);
        gn_json_text(json, "label",
                     gn_sweep_label(display->sweep, progress->last, true, label, sizeof label));
    }
    if (progress->outcome) {
        gn_json_integer(json, "code", progress->outcome->code);
        gn_json_text(json, "message", progress->outcome->message);
    }
    GN_JSON_NUMBERS(json, {"total", (double)progress->total}, {"done", (double)progress->done},
                    {"failed", (double)progress->failed}, {"running", (double)progress->running},
                    {"seconds", progress->seconds}, {"eta", progress->eta});
    gn_print_object("progress", gn_json_finish(json, false));
}

static void text_progress(gn_sweep_display *display, const gn_sweep_progress *progress) {
    char eta[32], label[LABEL];
    bool over = progress->done + progress->failed == progress->total;
    gn_line line = {0};
    gn_line_add(&line, 0, "%zu/%zu runs done", progress->done, progress->total);
    if (progress->failed) gn_line_add(&line, 1, "%zu failed", progress->failed);
    if (progress->running) gn_line_add(&line, 2, "%zu running", progress->running);
    if (!over && isfinite(progress->eta))
        gn_line_add(&line, 1, "ETA %s", gn_format_seconds(progress->eta, eta, sizeof eta));
    if (!isatty(STDERR_FILENO) && progress->what)
        gn_line_add(&line, 3, "%s: %.80s", progress->what,
                    gn_sweep_label(display->sweep, progress->last, true, label, sizeof label));
    gn_line_show(&line, over);
    display->shown = !over && isatty(STDERR_FILENO);
}

static void watch(void *context, const gn_sweep_progress *progress) {
    gn_sweep_display *display = context;
    const gn_options *options = display->options;
    char label[LABEL];
    bool ended = progress->what && progress->outcome, terminal = isatty(STDERR_FILENO);
    if (ended && strcmp(progress->what, "done") != 0) {
        fprintf(stderr, "%sgneiss: warning: run %zu (%s) %s: %s\n",
                display->shown ? "\r\033[K" : "", progress->last + 1,
                gn_sweep_label(display->sweep, progress->last, true, label, sizeof label),
                progress->what, progress->outcome->message);
        display->shown = false;
    }
    if (options->quiet) return;
    /* If the output is no terminal, prints a line for each event; on a terminal, and while waiting,
     * updates the time. */
    bool due = gn_now() >= display->next;
    if (options->json ? !progress->what && !due : terminal ? !due && !ended : !ended) return;
    display->next = gn_now() + (options->json ? 5.0 : 0.5);
    if (options->json)
        json_progress(display, progress);
    else
        text_progress(display, progress);
}

static size_t count_mine(const gn_sweep *sweep, const gn_sweep_way *way) {
    size_t count = 0;
    for (size_t k = 0; k < sweep->run_count; k++) count += gn_sweep_run_in_shard(sweep, way, k);
    return count;
}

static void print_heading(const gn_sweep *sweep, const gn_sweep_way *way) {
    size_t mine = count_mine(sweep, way);
    printf("%s%s%zu run%s", sweep->title, *sweep->title ? ": " : "", sweep->run_count,
           sweep->run_count == 1 ? "" : "s");
    if (sweep->seed_count)
        printf(" (%zu combination%s, %zu seed%s)", sweep->combination_count,
               sweep->combination_count == 1 ? "" : "s", sweep->seed_count,
               sweep->seed_count == 1 ? "" : "s");
    if (way->shards)
        printf(", %zu of them in shard %zu of %zu", mine, way->shard + 1, way->shards);
    else if (mine != sweep->run_count)
        printf(", %zu of them different", mine);
    char shown[GN_PATH_SIZE];
    printf("\noutput: %s\n", gn_printable(way->directory, shown, sizeof shown));
    fflush(stdout);
}

void gn_sweep_display_begin(gn_sweep_display *display, const gn_options *options,
                            const gn_sweep *sweep, gn_sweep_way *way) {
    *display = (gn_sweep_display){.options = options, .sweep = sweep, .next = gn_now() + 0.5};
    way->watch = watch;
    way->context = display;
    if (!options->quiet && !options->json) print_heading(sweep, way);
}

void gn_sweep_display_end(gn_sweep_display *display) {
    if (display->shown) fputc('\n', stderr);
}

/* ---- the summary ---- */

/* Returns a unit with a prefix that keeps numbers near 1; strains remain unchanged. */
static const char *scaled(const char *unit, double size, double *factor, char *text, size_t bytes) {
    static const struct {
        double factor;
        const char *prefix;
    } prefixes[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}};
    *factor = 1.0;
    snprintf(text, bytes, "%s", strcmp(unit, "1") ? unit : "");
    if (strcmp(unit, "Pa") != 0 && strcmp(unit, "N") != 0 && strcmp(unit, "J") != 0) return text;
    for (size_t k = 0; k < 3; k++)
        if (fabs(size) >= prefixes[k].factor) {
            *factor = prefixes[k].factor;
            snprintf(text, bytes, "%s%s", prefixes[k].prefix, unit);
            break;
        }
    return text;
}

/* Returns the number of digits to print: two, or all of a whole number. */
static int digits(double value) {
    return fabs(value) >= 1000.0 ? 4 : fabs(value) >= 100.0 ? 3 : 2;
}

static void print_reading(const gn_summary_reading *reading, const gn_statistics *statistics,
                          double rest) {
    char unit[GN_NAME_SIZE + 2];
    double factor;
    if (!statistics->count) {
        printf("  %-26s %10s\n", reading->name, "-");
        return;
    }
    scaled(reading->unit, statistics->mean, &factor, unit, sizeof unit);
    printf("  %-26s %10.4g", reading->name, statistics->mean / factor);
    if (statistics->count > 1)
        printf(" +- %.*g%s%s   (95 %%, %zu runs; deviation %.*g)",
               digits(statistics->interval / factor), statistics->interval / factor,
               *unit ? " " : "", unit, statistics->count, digits(statistics->deviation / factor),
               statistics->deviation / factor);
    else
        printf("%s%s", *unit ? " " : "", unit);
    /* Several seeds show the scatter over packings and by rounding, but not the errors that all
     * packings share. */
    if (statistics->count > 1 && !isnan(rest))
        printf("; it includes packing and round-off, the rest of the error is estimated as %.*g",
               digits(rest / factor), rest / factor);
    printf("\n");
}

/* Prints a combination of parameters without the seed, such as "friction = 0.3". */
static void print_combination(const gn_summary *summary, size_t c) {
    const gn_sweep *sweep = summary->sweep;
    char label[LABEL];
    size_t each = sweep->run_count / sweep->combination_count, done = 0;
    for (size_t k = c * each; k < (c + 1) * each; k++)
        done += summary->runs[k].outcome.state == GN_RUN_DONE;
    gn_sweep_label(sweep, c * each, false, label, sizeof label);
    printf("%s%s%zu of %zu run%s done\n", label, *label ? ": " : "", done, each,
           each == 1 ? "" : "s");
    if (!done) return;
    for (size_t r = 0; r < summary->reading_count; r++)
        print_reading(&summary->readings[r], &summary->statistics[c * summary->reading_count + r],
                      gn_summary_rest(summary, c, r));
}

static void print_envelope_reading(const char *name, const char *unit, double value,
                                   const char *reason) {
    char shown[GN_NAME_SIZE + 2];
    double factor;
    if (isnan(value)) {
        printf("  %-26s %10s   %s\n", name, "-", reason);
        return;
    }
    scaled(unit, value, &factor, shown, sizeof shown);
    printf("  %-26s %10.4g%s%s\n", name, value / factor, *shown ? " " : "", shown);
}

static void print_fit(const gn_envelope *envelope) {
    const char *reason = envelope->no_coulomb;
#define X(name, unit, text)                                                                        \
    if (strncmp(#name, "hoek", 4) == 0) reason = envelope->no_hoek_brown;                          \
    print_envelope_reading(#name, unit, envelope->name, reason);
    GN_ENVELOPE_READINGS(X)
#undef X
}

enum { SHOWN_ENVELOPES = 12 };

/* Prints the fit over confinements for each combination of the other parameters. */
static void print_envelopes(const gn_summary *summary, const gn_envelopes *envelopes) {
    char label[LABEL];
    if (envelopes->confined && !envelopes->count)
        printf("strength over confinement: no envelope, as no runs differ in their confinement "
               "alone\n");
    for (size_t k = 0; k < envelopes->count && k < SHOWN_ENVELOPES; k++) {
        gn_envelope_label(summary, envelopes, k, label, sizeof label);
        printf("strength over confinement, %s\n", *label ? label : "all runs");
        print_fit(&envelopes->of[k]);
    }
    if (envelopes->count > SHOWN_ENVELOPES)
        printf("and %zu more envelopes: see sweep.h5\n", envelopes->count - SHOWN_ENVELOPES);
}

static void json_envelopes(gn_json *json, const gn_summary *summary,
                           const gn_envelopes *envelopes) {
    char label[LABEL];
    if (!envelopes->count) return;
    gn_json_array(json, "envelopes");
    for (size_t k = 0; k < envelopes->count; k++) {
        gn_json_object(json, NULL);
        gn_json_text(json, "of", gn_envelope_label(summary, envelopes, k, label, sizeof label));
#define X(name, unit, text) gn_json_number(json, #name, envelopes->of[k].name);
        GN_ENVELOPE_READINGS(X)
#undef X
        gn_json_end(json);
    }
    gn_json_end(json);
}

static void json_summary(const gn_summary *summary, const gn_envelopes *envelopes) {
    gn_json *json = gn_json_begin();
    gn_json_text(json, "sweep", "summary");
    gn_json_text(json, "directory", summary->directory);
    GN_JSON_NUMBERS(json, {"runs", (double)summary->sweep->run_count},
                    {"done", (double)summary->done}, {"failed", (double)summary->failed});
    gn_json_array(json, "combinations");
    for (size_t c = 0; c < summary->sweep->combination_count; c++) {
        gn_json_object(json, NULL);
        for (size_t r = 0; r < summary->reading_count; r++) {
            const gn_statistics *statistics = &summary->statistics[c * summary->reading_count + r];
            gn_json_object(json, summary->readings[r].name);
            GN_JSON_NUMBERS(json, {"count", (double)statistics->count}, {"mean", statistics->mean},
                            {"deviation", statistics->deviation},
                            {"rest", gn_summary_rest(summary, c, r)},
                            {"interval", statistics->interval});
            gn_json_end(json);
        }
        gn_json_end(json);
    }
    gn_json_end(json);
    json_envelopes(json, summary, envelopes);
    gn_print_object("result", gn_json_finish(json, false));
}

static void print_failed(const gn_summary *summary) {
    char label[LABEL];
    for (size_t k = 0; k < summary->sweep->run_count; k++) {
        const gn_outcome *outcome = &summary->runs[k].outcome;
        if (outcome->state != GN_RUN_FAILED && !outcome->lost) continue;
        printf("%s: run %zu (%s): %s\n", outcome->lost ? "lost" : "failed", k + 1,
               gn_sweep_label(summary->sweep, k, true, label, sizeof label), outcome->message);
    }
}

/* Warns of parameters whose walls or sets do not exist, which is known once a run has been made. */
static void warn_of_absent(const gn_summary *summary) {
    for (size_t r = 0;
         summary->done > 0 && summary->sweep->reading_count && r < summary->reading_count; r++) {
        size_t found = 0;
        for (size_t c = 0; c < summary->sweep->combination_count; c++)
            found += summary->statistics[c * summary->reading_count + r].count;
        if (!found)
            fprintf(stderr, "gneiss: warning: readings: no completed run has a number for %s\n",
                    summary->readings[r].name);
    }
}

/* Prints whether the error is as requested. The scatter, and the error that all packings share, are
 * independent. */
static void print_reached(const gn_options *options, const gn_summary *summary) {
    if (!(options->reached > 0.0)) return;
    for (const char *const *name = gn_planned_names(options->reading); *name; name++)
        for (size_t r = 0; r < summary->reading_count; r++) {
            const gn_statistics *found = &summary->statistics[r];
            const double rest = gn_summary_rest(summary, 0, r);
            if (strcmp(summary->readings[r].name, *name) != 0 || found->count < 2 || isnan(rest))
                continue;
            gn_print_reached(options, *name, hypot(found->interval, rest) / fabs(found->mean), "");
            return;
        }
    gn_print_reached(options, NULL, NAN, "");
}

static void print_summary(const gn_options *options, const gn_summary *summary,
                          const gn_envelopes *envelopes) {
    enum { SHOWN = 10 };
    for (size_t c = 0; c < summary->sweep->combination_count && c < SHOWN; c++)
        print_combination(summary, c);
    if (summary->sweep->combination_count > SHOWN)
        printf("and %zu more combinations\n", summary->sweep->combination_count - SHOWN);
    print_envelopes(summary, envelopes);
    print_failed(summary);
    if (!options->quiet) {
        char shown[GN_PATH_SIZE];
        (void)gn_printable(summary->directory, shown, sizeof shown);
        printf("written to %s: sweep.csv, sweep-means.csv, sweep.h5 (gneiss report %s draws it)\n",
               shown, shown);
    }
    print_reached(options, summary);
}

void gn_sweep_print_summary(const gn_options *options, const gn_summary *summary) {
    if (summary->several_builds)
        fprintf(stderr, "gneiss: warning: some runs were made by a differently compiled program: "
                        "--force computes them again\n");
    warn_of_absent(summary);
    gn_envelopes envelopes;
    if (gn_envelopes_make(summary, &envelopes, NULL) != GNEISS_OK)
        fprintf(stderr, "gneiss: warning: no memory for the envelopes of strength\n");
    if (options->json)
        json_summary(summary, &envelopes);
    else
        print_summary(options, summary, &envelopes);
    gn_envelopes_free(&envelopes);
}

/* ---- --dry-run ---- */

void gn_sweep_print_plan(const gn_sweep *sweep, const gn_summary *summary, const gn_sweep_way *way,
                         const double *seconds) {
    char text[32], label[LABEL];
    double known = 0.0;
    size_t counted = 0, left = 0;
    int cores = way->threads > 0 ? way->threads : omp_get_num_procs();
    print_heading(sweep, way);
    printf("%6s  %-16s  %-11s  %-12s  %s\n", "run", "folder", "state", "one thread", "parameters");
    for (size_t k = 0; k < sweep->run_count; k++) {
        const gn_outcome *outcome = &summary->runs[k].outcome;
        if (!gn_sweep_run_in_shard(sweep, way, k)) continue;
        printf("%6zu  %016" PRIx64 "  %-11s  %-12s  %s\n", k + 1, sweep->runs[k].hash,
               gn_run_state_name(outcome->state), gn_format_seconds(seconds[k], text, sizeof text),
               gn_sweep_label(sweep, k, true, label, sizeof label));
        bool wanted = way->force || !gn_outcome_is_final(outcome);
        left += wanted;
        if (!isfinite(seconds[k])) continue;
        known += seconds[k];
        counted++;
    }
    printf("%zu to do", left);
    if (counted)
        printf(": about %s on %d processor%s, if none ends early",
               gn_format_seconds(known / (double)counted * (double)left / cores, text, sizeof text),
               cores, cores == 1 ? "" : "s");
    printf("\n");
}
