#include "cli/progress.h"

#include "base/new.h"
#include "base/point.h"
#include "base/printable.h"
#include "boundary/overlap.h"
#include "cli/line.h"
#include "cli/log.h"
#include "cli/plan_parts.h"
#include "cli/plan_stages.h"
#include "io/io.h"
#include "particles/bonds.h"
#include "plan/estimate.h"
#include "run/budget.h"
#include "run/run.h"
#include "timestep/timestep.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- units of printed readings ---- */

static gn_shown pressure(double value, bool modulus) {
    static const gn_shown units[] = {{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}};
    /* Moduli from 0.1 GPa are printed in GPa and stresses from 0.1 MPa in MPa, as is usual for
     * rock. */
    for (size_t k = modulus ? 0 : 1; k < sizeof units / sizeof *units; k++)
        if (fabs(value) >= 0.1 * units[k].factor) return units[k];
    return (gn_shown){1.0, "Pa"};
}

static gn_shown shown_unit(const gn_readings *readings, const char *name, const char *unit,
                           double value) {
    if (strcmp(unit, "Pa") != 0) return (gn_shown){1.0, strcmp(unit, "1") == 0 ? "" : unit};
    const bool modulus = strstr(name, "modulus") != NULL;
    const double kin = modulus ? readings->young_modulus : readings->largest_stress;
    return pressure(isfinite(kin) && kin != 0.0 ? kin : value, modulus);
}

double gn_two_digits(double value) {
    if (!isfinite(value) || value == 0.0) return value;
    const double unit = pow(10.0, floor(log10(fabs(value))) - 1.0);
    return round(value / unit) * unit;
}

/* ---- output of the error budget at the end of a run ---- */

static void print_one(const gn_readings *readings, const char *name, const char *unit, double value,
                      const gn_error_causes *causes) {
    char text[512];
    const gn_shown shown = shown_unit(readings, name, unit, value);
    printf("    %-22s %.4g%s%s +- %.6g %s\n", name, value / shown.factor, *shown.unit ? " " : "",
           shown.unit, gn_two_digits(fabs(value) / shown.factor * gn_causes_total(causes)),
           gn_budget_text(causes, value / shown.factor, text, sizeof text));
}

/* Prints the causes that no sum includes; they are the same for most readings, and are printed
 * once. */
static void print_notes(const gn_budget *budget) {
    const gn_error_causes *causes = &budget->of[GN_READING_peak_stress];
    if (!causes->count) causes = &budget->of[GN_READING_young_modulus_average];
    for (size_t k = 0; k < causes->note_count; k++) printf("    note: %s\n", causes->note[k]);
}

/* Prints a line for each reading with an error budget; if there is a test but no budget, the
 * reason. */
static gneiss_status gn_print_budget(const gn_run *run, gneiss_error *error) {
    const gn_readings *readings;
    const gn_budget *budget;
    if (!gn_scene_tested(&run->world.ctx.scene)) return GNEISS_OK;
    GN_TRY(gn_run_readings(run, &readings, error));
    GN_TRY(gn_run_budget(run, &budget, error));
    if (budget->absent[0]) {
        printf("  error budget           %10s   %s\n", "-", budget->absent);
        return GNEISS_OK;
    }
    printf("  error budget, 95 of 100\n");
#define X(name, unit, text)                                                                        \
    if (budget->of[GN_READING_##name].count)                                                       \
        print_one(readings, #name, unit, readings->name, &budget->of[GN_READING_##name]);
    GN_READINGS(X)
#undef X
    print_notes(budget);
    return GNEISS_OK;
}

const char *gn_format_seconds(double seconds, char *text, size_t size) {
    if (!isfinite(seconds))
        snprintf(text, size, "?");
    else if (seconds < 100.0)
        snprintf(text, size, "%.1f s", seconds);
    else if (seconds < 6000.0)
        snprintf(text, size, "%d min %02d s", (int)(seconds / 60.0), (int)fmod(seconds, 60.0));
    else if (seconds < 100.0 * 86400.0)
        snprintf(text, size, "%d h %02d min", (int)(seconds / 3600.0),
                 (int)fmod(seconds / 60.0, 60.0));
    else if (seconds < 1000.0 * 86400.0)
        snprintf(text, size, "%.0f days", seconds / 86400.0);
    else
        snprintf(text, size, "%.3g years", seconds / (365.25 * 86400.0));
    return text;
}

const char *gn_format_count(double value, char *text, size_t size) {
    static const char *const suffix[] = {"", " k", " M", " G", " T"};
    int k = 0;
    while (fabs(value) >= 1000.0 && k < 4) {
        value /= 1000.0;
        k++;
    }
    snprintf(text, size, "%.3g%s", value, suffix[k]);
    return text;
}

static void progress_json(const gn_progress *progress) {
    gn_json *json = gn_json_begin();
    GN_JSON_NUMBERS(json, {"step", (double)progress->step}, {"time", progress->time},
                    {"end", progress->end});
    if (progress->stages) gn_json_text(json, "stage", progress->stage);
    GN_JSON_NUMBERS(json, {"seconds", progress->seconds},
                    {"particle_steps_per_second", progress->particle_steps_per_second},
                    {"contact_steps_per_second", progress->contact_steps_per_second});
    if (progress->element_steps_per_second > 0.0)
        gn_json_number(json, "element_steps_per_second", progress->element_steps_per_second);
    gn_json_number(json, "eta", progress->eta);
    gn_json_bool(json, "eta_at_most", progress->eta_at_most);
    GN_JSON_NUMBERS(json, {"unbalanced", progress->unbalanced},
                    {"broken", (double)progress->broken}, {"energy_residual", progress->residual},
                    {"stress", progress->stress}, {"strain", progress->strain});
    gn_json_bool(json, "finished", progress->finished);
    gn_print_object("progress", gn_json_finish(json, false));
}

gneiss_status gn_predict_end(const gn_options *options, gn_run *run, gneiss_error *error) {
    const gn_world *world = &run->world;
    gn_estimate estimate;
    if (options->quiet || world->ctx.step > 0 || world->ctx.scene.stage_count ||
        !gn_scene_tested(&world->ctx.scene))
        return GNEISS_OK;
    GN_TRY(gn_estimate_make(&world->ctx, &world->dem, &world->solids, &estimate, error));
    run->expected_end = gn_estimate_end(&world->ctx, &estimate);
    return GNEISS_OK;
}

void gn_print_progress(const gn_options *options, const gn_run *run) {
    if (options->quiet) return;
    gn_progress p = gn_run_progress(run);
    if (options->json) {
        progress_json(&p);
        return;
    }
    char rate[32], eta[32];
    bool particles = run->world.ctx.scene.has_specimen;
    gn_line line = {0};
    if (p.stages) gn_line_add(&line, 0, "%s %zu/%zu", p.stage, p.stage_index + 1, p.stages);
    gn_line_add(&line, 0, "step %lld", (long long)p.step);
    gn_line_brief(gn_line_add(&line, 0, "t %.4g/%.4g s", p.time, p.end), "%.3g %%",
                  100.0 * p.time / p.end);
    gn_format_count(particles ? p.particle_steps_per_second : p.element_steps_per_second, rate,
                    sizeof rate);
    gn_line_brief(gn_line_add(&line, 4, "%s %s-steps/s", rate, particles ? "particle" : "element"),
                  "%s/s", rate);
    gn_line_brief(gn_line_add(&line, 1, "ETA %s%s", p.eta_at_most ? "at most " : "",
                              gn_format_seconds(p.eta, eta, sizeof eta)),
                  "ETA %s%s", p.eta_at_most ? "< " : "", eta);
    gn_line_add(&line, 6, "unbalanced %.2g", p.unbalanced);
    if (particles) gn_line_add(&line, 3, "broken %lld", (long long)p.broken);
    if (!isnan(p.residual)) gn_line_add(&line, 5, "residual %.1e", p.residual);
    if (!isnan(p.stress))
        gn_line_brief(gn_line_add(&line, 2, "stress %.4g MPa  strain %.3g %%", p.stress / 1e6,
                                  p.strain * 100.0),
                      "%.4g MPa at %.3g %%", p.stress / 1e6, p.strain * 100.0);
    gn_line_show(&line, p.finished);
}

void gn_end_progress_line(const gn_options *options) {
    if (!options->quiet && !options->json && isatty(STDERR_FILENO)) fputc('\n', stderr);
}

/* Without contacts there are no springs, and no limits of springs to print. */
static void print_limits(const gn_world *world) {
    printf("step %.4g s", world->ctx.dt);
    if (world->ctx.stable == INFINITY) {
        printf(": nothing can %s that would limit it%s\n",
               isfinite(gn_bodies_step(&world->ctx, &world->dem, &world->boundary)) ? "touch"
                                                                                    : "move",
               isfinite(gn_bodies_step(&world->ctx, &world->dem, &world->boundary))
                   ? ", except for the motion of bodies per step"
                   : "");
        return;
    }
    printf(" = %.2f of the stability limit %.4g s (", world->ctx.dt / world->ctx.stable,
           world->ctx.stable);
    if (gn_timestep_sharp_limit(&world->ctx, &world->solids) == INFINITY)
        printf("of contacts to come: there are no contacts yet");
    else
        printf("undamped: sharp %.4g s, rigorous bound %.4g s",
               gn_timestep_sharp_limit(&world->ctx, &world->solids),
               gn_timestep_bound(&world->ctx, &world->dem, &world->solids, &world->zones));
    if (world->ctx.scene.has_specimen && world->ctx.choice.limit.literature < INFINITY)
        printf(", one-spring estimate of the literature %.4g s",
               world->ctx.choice.limit.literature);
    printf(")\n");
}

/* Warns of particles on the wrong side of a wall or inside a body, which are expelled within a few
 * steps. */
static void warn_of_inside(const char *where, const char *name, size_t count) {
    if (count)
        fprintf(stderr,
                "gneiss: warning: %zu particle%s centre %s '%s' at the start: gneiss check shows "
                "contacts and overlaps\n",
                count, count == 1 ? " has its" : "s have their", where, name);
}

/* Warns of clumps that overlap other particles, which contacts push apart at once. */
static void warn_of_clumps(const gn_world *world) {
    if (!world->dem.clumps.count) return;
    const double stored = gn_contacts_stored(&world->ctx, &world->dem, &world->box);
    if (gn_stored_matters(&world->ctx, &world->dem, stored))
        fprintf(stderr,
                "gneiss: warning: clumps or particles overlap each other at the start, where "
                "contacts store %.3g J and push them apart: gneiss check shows the overlaps\n",
                stored);
}

static gneiss_status warn_of_start(const gn_world *world, gneiss_error *error) {
    const gn_scene *scene = &world->ctx.scene;
    GN_FREED gn_overlap *overlaps = NULL;
    if (world->ctx.step > 0) return GNEISS_OK;
    warn_of_clumps(world);
    for (size_t k = 0; k < scene->wall_count; k++) /* a passive wall does not expel particles */
        if (!scene->walls[k].passive)
            warn_of_inside("behind wall", scene->walls[k].name,
                           gn_wall_overlap(&world->dem, &world->boundary, k).inside);
    GN_TRY(gn_new(&overlaps, world->boundary.surface_count, "surfaces", error));
    GN_TRY(gn_boundary_overlaps(&world->ctx, &world->dem, &world->boundary, overlaps, error));
    for (size_t k = 0; k < world->boundary.surface_count; k++)
        if (k < scene->body_count)
            warn_of_inside("inside body", scene->bodies[k].name, overlaps[k].inside);
        else
            warn_of_inside("inside", "elements", overlaps[k].inside);
    return GNEISS_OK;
}

gneiss_status gn_print_start(const gn_options *options, const gn_run *run, gneiss_error *error) {
    const gn_world *world = &run->world;
    if (world->ctx.scene.threads > world->ctx.threads)
        fprintf(stderr,
                "gneiss: warning: run.threads: %lld requested, the OpenMP library gives %d "
                "(OMP_THREAD_LIMIT): same results, longer time\n",
                (long long)world->ctx.scene.threads, world->ctx.threads);
    GN_TRY(warn_of_start(world, error));
    if (options->quiet || options->json) return GNEISS_OK;
    printf("%s\n", world->ctx.scene.title[0] ? world->ctx.scene.title : world->ctx.scene.source);
    if (world->ctx.scene.has_specimen)
        printf("%zu particles, %zu bonds, %zu other pairs in the lists; ",
               world->dem.particles.soa.count, (size_t)world->dem.bonds_at_start,
               world->dem.pairs.contacts.soa.count);
    gn_element_totals elements = gn_elements_totals(&world->solids);
    if (elements.elements) printf("%zu nodes, %zu elements; ", elements.nodes, elements.elements);
    printf("%d thread%s, %s\n", world->ctx.threads, world->ctx.threads == 1 ? "" : "s",
           world->ctx.kernels->name);
    gn_print_element_notes(world, "");
    print_limits(world);
    char shown[GN_PATH_SIZE];
    printf("output: %s\n", gn_printable(run->directory, shown, sizeof shown));
    fflush(stdout);
    return GNEISS_OK;
}

/* --- output before the first step --- */

static gneiss_status show_state(void *context, const gn_first_break *so_far, gneiss_error *error) {
    const gn_run *run = context;
    gn_line line = {0};
    (void)error;
    gn_line_add(&line, 0, "equilibrium at t = %.4g s", run->world.ctx.time);
    if (isfinite(so_far->time)) gn_line_add(&line, 0, "first break at %.4g s", so_far->time);
    gn_line_add(&line, 1, "%lld linear systems, %lld iterations", (long long)so_far->solutions,
                (long long)so_far->iterations);
    gn_line_show(&line, false);
    return GNEISS_OK;
}

void gn_print_first_break(const gn_world *world, const gn_first_break *first_break) {
    char at[GN_POINT_SIZE];
    const double none[3] = {0, 0, 0};
    printf("start: the first break is predicted at t = %.6g s, between particles %d and %d near %s "
           "m;\n  steps begin in the equilibrium at t = %.6g s = %.3f of that, which replaces %lld "
           "steps\n  (%lld states computed, %lld linear systems, %lld iterations; residual loads "
           "%.1g of the contact forces)\n",
           first_break->time, (int)first_break->i, (int)first_break->j,
           gn_point_text(none, first_break->place, at), world->ctx.time,
           world->ctx.time / first_break->time, (long long)first_break->steps,
           (long long)first_break->increments, (long long)first_break->solutions,
           (long long)first_break->iterations, first_break->unbalanced);
}

gneiss_status gn_print_initial_state(const gn_options *options, gn_run *run, gneiss_error *error) {
    const gn_world *world = &run->world;
    const bool speaks = !options->quiet && !options->json;
    if (world->ctx.scene.start != GN_START_FIRST_BREAK || world->ctx.step > 0) return GNEISS_OK;
    if (speaks) printf("time.start: first_break: computing the first break by statics\n");
    fflush(stdout);
    gneiss_status status =
        gn_run_begin(run, speaks ? &(gn_first_break_watch){show_state, run} : NULL, error);
    if (speaks) gn_end_progress_line(options);
    if (status == GNEISS_OK && speaks) gn_print_first_break(world, &run->first_break);
    fflush(stdout);
    return status;
}

/* Writes the name of a reading as words. */
static const char *words_of(const char *name, char *text, size_t size) {
    snprintf(text, size, "%s", name);
    for (char *c = text; *c; c++)
        if (*c == '_') *c = ' ';
    return text;
}

/* Prints a line with the value, or with the reason why there is none. */
static void print_reading(const char *label, double value, const char *unit, const char *note,
                          const char *reason) {
    if (*reason)
        printf("  %-22s %10s   %s\n", label, "-", reason);
    else
        printf("  %-22s %10.4g%s%s%s%s\n", label, value, *unit ? " " : "", unit, *note ? "   " : "",
               note);
}

static void print_scaled(const gn_readings *readings, const char *label, const char *name,
                         const char *unit, double value, const char *note, const char *reason) {
    const gn_shown shown = shown_unit(readings, name, unit, value);
    print_reading(label, value / shown.factor, shown.unit, note, reason);
}

/* Prints readings that only some kinds of tests have, and readings of zones. */
static void print_own_readings(const gn_run *run, const gn_readings *readings) {
    char label[64];
#define X(name, unit, text)                                                                        \
    if (!gn_reading_belongs(GN_READING_##name, GN_TEST_NONE, false) &&                             \
        gn_run_reads(run, GN_READING_##name))                                                      \
        print_scaled(readings, words_of(#name, label, sizeof label), #name, unit, readings->name,  \
                     "", readings->reason[GN_READING_##name]);
    GN_READINGS(X)
#undef X
}

static void print_test_readings(const gn_run *run, const gn_readings *readings) {
#define PRINT(label, name, factor, unit, note)                                                     \
    if (gn_run_reads(run, GN_READING_##name))                                                      \
    print_reading(label, readings->name *(factor), unit, note, readings->reason[GN_READING_##name])
#define SCALED(label, name, note)                                                                  \
    if (gn_run_reads(run, GN_READING_##name))                                                      \
    print_scaled(readings, label, #name, "Pa", readings->name, note,                               \
                 readings->reason[GN_READING_##name])
    SCALED("Young's modulus", young_modulus, "(before bonds break, platen strain)");
    SCALED("", young_modulus_average, "(over the average strain)");
    PRINT("Poisson's ratio", poisson_ratio, 1, "", "");
    if (run->world.ctx.scene.dimension == 2) {
        SCALED("plane strain, E", plane_young_modulus, "");
        PRINT("plane strain, nu", plane_poisson_ratio, 1, "", "");
    }
    SCALED("peak stress", peak_stress, "");
    PRINT("strain at the peak", peak_strain, 100, "%", "");
    if (isnan(readings->peak_stress)) {
        SCALED("largest stress so far", largest_stress, "");
        PRINT("strain there", largest_strain, 100, "%", "");
    }
    PRINT("imbalance of the ends", end_imbalance, 100, "%", "");
#undef PRINT
#undef SCALED
}

static gneiss_status print_readings(const gn_run *run, gneiss_error *error) {
    const gn_readings *readings;
    const bool tested = gn_scene_tested(&run->world.ctx.scene);
    if (!tested && !gn_run_reads(run, GN_READING_returned_energy)) return GNEISS_OK;
    GN_TRY(gn_run_readings(run, &readings, error));
    if (tested) print_test_readings(run, readings);
    print_own_readings(run, readings);
    return GNEISS_OK;
}

static void print_profile(const gn_run *run) {
    double total = gn_run_progress(run).seconds;
    char text[32];
    printf("\nprofile\n");
    for (int k = 0; k < GN_PHASE_COUNT; k++)
        if (run->world.ctx.seconds[k] > 0.0)
            printf("  %-36s %9.3f s %5.1f %%\n", gn_phase_text((gn_phase)k),
                   run->world.ctx.seconds[k], 100.0 * run->world.ctx.seconds[k] / total);
    printf("  %-36s %9.3f s\n", "total", total);
    gn_progress p = gn_run_progress(run);
    if (run->world.solids.count)
        printf("  %s element-steps/s\n",
               gn_format_count(p.element_steps_per_second, text, sizeof text));
    if (!run->world.ctx.scene.has_specimen) return;
    printf("  %s particle-steps/s",
           gn_format_count(p.particle_steps_per_second, text, sizeof text));
    printf(", %s contact-steps/s", gn_format_count(p.contact_steps_per_second, text, sizeof text));
    printf(", %lld list rebuilds\n", (long long)run->world.dem.verlet.rebuilds);
}

gneiss_status gn_print_warnings(const gn_run *run, gneiss_error *error) {
    gn_warnings list;
    GN_TRY(gn_run_warnings(run, &list, error));
    fflush(stdout);
    for (size_t k = 0; k < list.count; k++)
        fprintf(stderr, "gneiss: warning: %s: %s\n", list.warning[k].name, list.warning[k].text);
    return GNEISS_OK;
}

void gn_print_notes(const gn_scene_notes *notes) {
    for (size_t k = 0; k < notes->count; k++) fprintf(stderr, "gneiss: note: %s\n", notes->text[k]);
}

/* Prints particles that entered and left. */
static void print_flow(const gn_run *run) {
    const gn_world *world = &run->world;
    for (size_t k = 0; k < world->ctx.scene.source_count; k++)
        printf("  source %-16.60s%9.0f particles, %.4g kg entered\n",
               world->ctx.scene.sources[k].name, world->dem.flow.sources[k].number,
               world->dem.flow.sources[k].mass);
    for (size_t k = 0; k < world->ctx.scene.sink_count; k++) {
        double rate = gn_sink_steady_rate(&run->history, world->ctx.scene.sinks[k].name);
        printf("  sink %-18.60s%9.0f particles, %.4g kg left", world->ctx.scene.sinks[k].name,
               world->dem.flow.sinks[k].number, world->dem.flow.sinks[k].mass);
        if (isfinite(rate)) printf(", %.4g kg/s in steady flow", rate);
        printf("\n");
    }
}

/* Prints the results of the run. */
static gneiss_status print_outcome(const gn_run *run, gneiss_error *error) {
    const gn_world *world = &run->world;
    gn_print_stages_done(run);
    GN_TRY(print_readings(run, error));
    GN_TRY(gn_print_budget(run, error));
    if (world->ctx.effects & GN_FX_BONDS)
        printf("  bonds broken           %10lld in tension, %lld in shear, of %lld\n",
               (long long)world->dem.broken_tension, (long long)world->dem.broken_shear,
               (long long)world->dem.bonds_at_start);
    print_flow(run);
    if (world->dem.lost)
        printf("  left the domain        %10lld particles\n", (long long)world->dem.lost);
    if (world->ctx.effects & GN_FX_MASS_SCALING)
        printf("  added mass             %10.4g %% of the particles' own, for %.4g of the step "
               "without it\n",
               100.0 * world->dem.raised.added / world->dem.mass,
               world->ctx.dt / world->ctx.choice.scaling.unscaled);
    if (world->ctx.effects & GN_FX_ENERGY)
        printf("  energy residual        %10.2e   (of %.4g J)\n",
               gn_energy_residual(&world->ledger.reading), gn_energy_scale(&world->ledger.reading));
    printf("  state hash       %016llx\n",
           (unsigned long long)gn_world_hash(&world->ctx, &world->dem, &world->boundary,
                                             &world->solids, &world->box));
    return GNEISS_OK;
}

/* --- the error that was asked for --- */

const char *const *gn_planned_names(const char *reading) {
    static const char *const strength[] = {"peak_stress", NULL}, *const stiffness[] = {
                                                                     "young_modulus",
                                                                     "young_modulus_average",
                                                                     "largest_stress", NULL};
    return strcmp(reading, "strength") == 0 ? strength : stiffness;
}

void gn_print_reached(const gn_options *options, const char *name, double error,
                      const char *reason) {
    const double asked = 100.0 * options->reached;
    if (isnan(error))
        printf("error of %.3g %% asked for: not known: %s\n", asked,
               *reason ? reason : "no reading of the plan has an error budget");
    else
        printf("error of %.3g %% asked for: %s: %s within %.6g %%\n", asked,
               error <= options->reached ? "reached" : "not reached", name,
               gn_two_digits(100.0 * error));
}

static gneiss_status print_reached(const gn_options *options, const gn_run *run,
                                   gneiss_error *error) {
    const gn_budget *budget;
    if (!(options->reached > 0.0)) return GNEISS_OK;
    GN_TRY(gn_run_budget(run, &budget, error));
    for (const char *const *name = gn_planned_names(options->reading); *name; name++)
        for (int k = 0; k < GN_READING_COUNT; k++) {
            if (strcmp(gn_reading_name((gn_reading)k), *name) != 0 || !budget->of[k].count)
                continue;
            gn_print_reached(options, *name, gn_causes_total(&budget->of[k]), "");
            return GNEISS_OK;
        }
    gn_print_reached(options, NULL, NAN, budget->absent);
    return GNEISS_OK;
}

gneiss_status gn_print_summary(const gn_options *options, const gn_run *run, gneiss_error *error) {
    const gn_world *world = &run->world;
    if (options->json) return GNEISS_OK;
    if (!options->quiet)
        printf("\n%s after %lld steps (t = %.4g s)\n\n", run->stop_reason,
               (long long)world->ctx.step, world->ctx.time);
    GN_TRY(print_outcome(run, error));
    if (options->quiet) return print_reached(options, run, error);
    print_profile(run);
    char shown[GN_PATH_SIZE];
    printf("\nwritten to %s: results.h5, summary.json%s%s%s%s%s\n",
           gn_printable(run->directory, shown, sizeof shown),
           world->ctx.scene.has_specimen ? ", particles.hdf.series" : "",
           world->ctx.effects & GN_FX_BONDS ? ", bonds.hdf.series" : "",
           world->ctx.scene.contact_rows == GN_SWITCH_ON ? ", contacts.hdf.series" : "",
           world->solids.count ? ", elements.hdf.series" : "",
           world->ctx.scene.body_count ? ", bodies.hdf.series" : "");
    return print_reached(options, run, error);
}
