#include "cli/sweep_show.h"

#include "base/printable.h"
#include "base/timer.h"
#include "cli/line.h"
#include "cli/progress.h"
#include "io/files.h"
#include "sweep/envelope.h"

#include <inttypes.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LABEL = 400 };

static void print_json(gn_json *j) {
    char *text = gn_json_finish(j, false);
    if (text) puts(text);
    free(text);
    fflush(stdout);
}

/* ---- progress ---- */

static void json_progress(const gn_sweep_display *d, const gn_sweep_progress *p) {
    char folder[24], label[LABEL];
    gn_json *j = gn_json_begin();
    gn_json_text(j, "sweep", p->what ? p->what : "progress");
    if (p->what) {
        snprintf(folder, sizeof folder, "%016" PRIx64, d->sweep->runs[p->last].hash);
        gn_json_integer(j, "run", (int64_t)p->last + 1);
        gn_json_text(j, "folder", folder);
        gn_json_text(j, "label", gn_sweep_label(d->sweep, p->last, true, label, sizeof label));
    }
    if (p->outcome) {
        gn_json_integer(j, "code", p->outcome->code);
        gn_json_text(j, "message", p->outcome->message);
    }
    gn_json_integer(j, "total", (int64_t)p->total);
    gn_json_integer(j, "done", (int64_t)p->done);
    gn_json_integer(j, "failed", (int64_t)p->failed);
    gn_json_integer(j, "running", (int64_t)p->running);
    gn_json_number(j, "seconds", p->seconds);
    gn_json_number(j, "eta", p->eta);
    print_json(j);
}

static void text_progress(gn_sweep_display *d, const gn_sweep_progress *p) {
    char eta[32], label[LABEL];
    bool over = p->done + p->failed == p->total;
    gn_line line = {0};
    gn_line_add(&line, 0, "%zu/%zu runs done", p->done, p->total);
    if (p->failed) gn_line_add(&line, 1, "%zu failed", p->failed);
    if (p->running) gn_line_add(&line, 2, "%zu running", p->running);
    if (!over && isfinite(p->eta))
        gn_line_add(&line, 1, "ETA %s", gn_format_seconds(p->eta, eta, sizeof eta));
    if (!isatty(STDERR_FILENO) && p->what)
        gn_line_add(&line, 3, "%s: %.80s", p->what,
                    gn_sweep_label(d->sweep, p->last, true, label, sizeof label));
    gn_line_show(&line, over);
    d->shown = !over && isatty(STDERR_FILENO);
}

static void watch(void *context, const gn_sweep_progress *p) {
    gn_sweep_display *d = context;
    const gn_options *o = d->options;
    char label[LABEL];
    bool ended = p->what && p->outcome, terminal = isatty(STDERR_FILENO);
    if (ended && strcmp(p->what, "done") != 0) {
        fprintf(stderr, "%sgneiss: warning: run %zu (%s) %s: %s\n", d->shown ? "\r\033[K" : "",
                p->last + 1, gn_sweep_label(d->sweep, p->last, true, label, sizeof label), p->what,
                p->outcome->message);
        d->shown = false;
    }
    if (o->quiet) return;
    /* Each event is a line where lines stay; a terminal, and whoever waits, is told how time goes.
     */
    bool due = gn_now() >= d->next;
    if (o->json ? !p->what && !due : terminal ? !due && !ended : !ended) return;
    d->next = gn_now() + (o->json ? 5.0 : 0.5);
    if (o->json)
        json_progress(d, p);
    else
        text_progress(d, p);
}

static size_t count_mine(const gn_sweep *s, const gn_sweep_way *way) {
    size_t count = 0;
    for (size_t k = 0; k < s->run_count; k++) count += gn_sweep_mine(s, way, k);
    return count;
}

static void print_heading(const gn_sweep *s, const gn_sweep_way *way) {
    size_t mine = count_mine(s, way);
    printf("%s%s%zu run%s", s->title, *s->title ? ": " : "", s->run_count,
           s->run_count == 1 ? "" : "s");
    if (s->seed_count)
        printf(" (%zu combination%s, %zu seed%s)", s->combination_count,
               s->combination_count == 1 ? "" : "s", s->seed_count, s->seed_count == 1 ? "" : "s");
    if (way->shards)
        printf(", %zu of them in shard %zu of %zu", mine, way->shard + 1, way->shards);
    else if (mine != s->run_count)
        printf(", %zu of them different", mine);
    char shown[GN_PATH_SIZE];
    printf("\noutput: %s\n", gn_printable(way->directory, shown, sizeof shown));
    fflush(stdout);
}

void gn_sweep_display_begin(gn_sweep_display *d, const gn_options *o, const gn_sweep *s,
                            gn_sweep_way *way) {
    *d = (gn_sweep_display){.options = o, .sweep = s, .next = gn_now() + 0.5};
    way->watch = watch;
    way->context = d;
    if (!o->quiet && !o->json) print_heading(s, way);
}

void gn_sweep_display_end(gn_sweep_display *d) {
    if (d->shown) fputc('\n', stderr);
}

/* ---- the summary ---- */

/* A prefix that keeps numbers near 1; strains stay what they are. */
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

/* Two, and whole numbers as they are. */
static int digits(double value) {
    return fabs(value) >= 1000.0 ? 4 : fabs(value) >= 100.0 ? 3 : 2;
}

static void print_reading(const gn_summary_reading *r, const gn_statistics *t, double rest) {
    char unit[GN_NAME_SIZE + 2];
    double factor;
    if (!t->count) {
        printf("  %-26s %10s\n", r->name, "-");
        return;
    }
    scaled(r->unit, t->mean, &factor, unit, sizeof unit);
    printf("  %-26s %10.4g", r->name, t->mean / factor);
    if (t->count > 1)
        printf(" +- %.*g%s%s   (95 %%, %zu runs; deviation %.*g)", digits(t->interval / factor),
               t->interval / factor, *unit ? " " : "", unit, t->count,
               digits(t->deviation / factor), t->deviation / factor);
    else
        printf("%s%s", *unit ? " " : "", unit);
    /* Scatter over packings and by rounding is measured by the seeds; what all of them share is
     * not. */
    if (t->count > 1 && !isnan(rest))
        printf("; packing and round-off measured by it, the rest of the error estimated %.*g",
               digits(rest / factor), rest / factor);
    printf("\n");
}

/* "friction = 0.3", without the seed. */
static void print_combination(const gn_summary *m, size_t c) {
    const gn_sweep *s = m->sweep;
    char label[LABEL];
    size_t each = s->run_count / s->combination_count, done = 0;
    for (size_t k = c * each; k < (c + 1) * each; k++)
        done += m->runs[k].outcome.state == GN_RUN_DONE;
    gn_sweep_label(s, c * each, false, label, sizeof label);
    printf("%s%s%zu of %zu run%s done\n", label, *label ? ": " : "", done, each,
           each == 1 ? "" : "s");
    if (!done) return;
    for (size_t r = 0; r < m->reading_count; r++)
        print_reading(&m->readings[r], &m->statistics[c * m->reading_count + r],
                      gn_summary_rest(m, c, r));
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

static void print_fit(const gn_envelope *e) {
    const char *reason = e->no_coulomb;
#define X(name, unit, text)                                                                        \
    if (strncmp(#name, "hoek", 4) == 0) reason = e->no_hoek_brown;                                 \
    print_envelope_reading(#name, unit, e->name, reason);
    GN_ENVELOPE_READINGS(X)
#undef X
}

enum { SHOWN_ENVELOPES = 12 };

/* The line over confinements, of each combination of the other parameters. */
static void print_envelopes(const gn_summary *m, const gn_envelopes *e) {
    char label[LABEL];
    if (e->confined && !e->count)
        printf("strength over confinement: no envelope, since no runs differ in their confinement "
               "alone\n");
    for (size_t k = 0; k < e->count && k < SHOWN_ENVELOPES; k++) {
        gn_envelope_label(m, e, k, label, sizeof label);
        printf("strength over confinement, %s\n", *label ? label : "all runs");
        print_fit(&e->of[k]);
    }
    if (e->count > SHOWN_ENVELOPES)
        printf("and %zu more envelopes: see sweep.h5\n", e->count - SHOWN_ENVELOPES);
}

static void json_envelopes(gn_json *j, const gn_summary *m, const gn_envelopes *e) {
    char label[LABEL];
    if (!e->count) return;
    gn_json_array(j, "envelopes");
    for (size_t k = 0; k < e->count; k++) {
        gn_json_object(j, NULL);
        gn_json_text(j, "of", gn_envelope_label(m, e, k, label, sizeof label));
#define X(name, unit, text) gn_json_number(j, #name, e->of[k].name);
        GN_ENVELOPE_READINGS(X)
#undef X
        gn_json_end(j);
    }
    gn_json_end(j);
}

static void json_summary(const gn_summary *m, const gn_envelopes *e) {
    gn_json *j = gn_json_begin();
    gn_json_text(j, "sweep", "summary");
    gn_json_text(j, "directory", m->directory);
    gn_json_integer(j, "runs", (int64_t)m->sweep->run_count);
    gn_json_integer(j, "done", (int64_t)m->done);
    gn_json_integer(j, "failed", (int64_t)m->failed);
    gn_json_array(j, "combinations");
    for (size_t c = 0; c < m->sweep->combination_count; c++) {
        gn_json_object(j, NULL);
        for (size_t r = 0; r < m->reading_count; r++) {
            const gn_statistics *t = &m->statistics[c * m->reading_count + r];
            gn_json_object(j, m->readings[r].name);
            gn_json_integer(j, "count", (int64_t)t->count);
            gn_json_number(j, "mean", t->mean);
            gn_json_number(j, "deviation", t->deviation);
            gn_json_number(j, "rest", gn_summary_rest(m, c, r));
            gn_json_number(j, "interval", t->interval);
            gn_json_end(j);
        }
        gn_json_end(j);
    }
    gn_json_end(j);
    json_envelopes(j, m, e);
    print_json(j);
}

static void print_failed(const gn_summary *m) {
    char label[LABEL];
    for (size_t k = 0; k < m->sweep->run_count; k++) {
        const gn_outcome *o = &m->runs[k].outcome;
        if (o->state != GN_RUN_FAILED && !o->lost) continue;
        printf("%s: run %zu (%s): %s\n", o->lost ? "lost" : "failed", k + 1,
               gn_sweep_label(m->sweep, k, true, label, sizeof label), o->message);
    }
}

/* Which walls and sets there are is known when a run has been made. */
static void warn_of_absent(const gn_summary *m) {
    for (size_t r = 0; m->done > 0 && m->sweep->reading_count && r < m->reading_count; r++) {
        size_t found = 0;
        for (size_t c = 0; c < m->sweep->combination_count; c++)
            found += m->statistics[c * m->reading_count + r].count;
        if (!found)
            fprintf(stderr, "gneiss: warning: readings: no run that is done has a number for %s\n",
                    m->readings[r].name);
    }
}

static void print_summary(const gn_options *o, const gn_summary *summary,
                          const gn_envelopes *envelopes) {
    enum { SHOWN = 10 };
    for (size_t c = 0; c < summary->sweep->combination_count && c < SHOWN; c++)
        print_combination(summary, c);
    if (summary->sweep->combination_count > SHOWN)
        printf("and %zu more combinations\n", summary->sweep->combination_count - SHOWN);
    print_envelopes(summary, envelopes);
    print_failed(summary);
    if (o->quiet) return;
    char shown[GN_PATH_SIZE];
    (void)gn_printable(summary->directory, shown, sizeof shown);
    printf("written to %s: sweep.csv, sweep-means.csv, sweep.h5 (gneiss report %s draws it)\n",
           shown, shown);
}

void gn_sweep_print_summary(const gn_options *o, const gn_summary *summary) {
    if (summary->several_builds)
        fprintf(stderr, "gneiss: warning: some runs are of a program that was compiled otherwise: "
                        "--force computes them again\n");
    warn_of_absent(summary);
    gn_envelopes envelopes;
    if (gn_envelopes_make(summary, &envelopes, NULL) != GNEISS_OK)
        fprintf(stderr, "gneiss: warning: no memory for the envelopes of strength\n");
    if (o->json)
        json_summary(summary, &envelopes);
    else
        print_summary(o, summary, &envelopes);
    gn_envelopes_free(&envelopes);
}

/* ---- --dry-run ---- */

void gn_sweep_print_plan(const gn_sweep *s, const gn_summary *summary, const gn_sweep_way *way,
                         const double *seconds) {
    char text[32], label[LABEL];
    double known = 0.0;
    size_t counted = 0, left = 0;
    int cores = way->threads > 0 ? way->threads : omp_get_num_procs();
    print_heading(s, way);
    printf("%6s  %-16s  %-11s  %-12s  %s\n", "run", "folder", "state", "one thread", "parameters");
    for (size_t k = 0; k < s->run_count; k++) {
        const gn_outcome *outcome = &summary->runs[k].outcome;
        if (!gn_sweep_mine(s, way, k)) continue;
        printf("%6zu  %016" PRIx64 "  %-11s  %-12s  %s\n", k + 1, s->runs[k].hash,
               gn_run_state_name(outcome->state), gn_format_seconds(seconds[k], text, sizeof text),
               gn_sweep_label(s, k, true, label, sizeof label));
        bool wanted = way->force || !gn_outcome_stands(outcome);
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
