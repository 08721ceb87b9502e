#include "cli/plan_accuracy.h"

#include "base/new.h"
#include "base/printable.h"
#include "cli/log.h"
#include "cli/progress.h"
#include "io/io.h"
#include "plan/setting.h"
#include "run/folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- words --- */

static void print_estimate(const gn_plan *plan, const gn_world *world) {
    const gn_estimate *estimate = &plan->estimate;
    printf("estimated from the specimen, by the study's case '%s'\n", estimate->study);
    if (estimate->elements) {
        printf("  closing          %.4g m/s over %.3g %% of strain\n", estimate->closing_velocity,
               100.0 * estimate->path_strain);
        return;
    }
    printf("  E                %.4g GPa (%.4g in uniform strain), wave speed %.4g m/s\n",
           estimate->modulus / 1e9, estimate->uniform_modulus / 1e9, estimate->wave_speed);
    if (isfinite(estimate->strain))
        printf("  peak             %.4g MPa at %.3g %% between the ends\n",
               estimate->strength / 1e6, 100.0 * estimate->strain);
    else
        printf("  peak             none: there are no breakable bonds\n");
    printf("  closing          %.4g m/s, over wave speed and strain: %.2g\n",
           estimate->closing_velocity, estimate->speed);
    printf("  across           %.3g of %zu particles\n", estimate->across,
           world->dem.particles.soa.count);
}

static void print_settings(const gn_plan *plan, const gn_proposal *proposal) {
    double closing = plan->estimate.closing_velocity * proposal->pace;
    printf("  loading          %.4g m/s, sum of both ends", closing);
    if (proposal->pace != 1.0) printf(" (%.3g of the scene's)", proposal->pace);
    printf("\n");
    if (plan->groups.mesh)
        printf("  cells            %.3g of the scene's\n", proposal->cell);
    else
        printf("  particles        %.0f%s\n", proposal->particles,
               proposal->particles == plan->groups.particles
                   ? ""
                   : ", with contacts calibrated for them");
    if (proposal->packings > 1)
        printf("  packings         %d, of which the mean is taken (gneiss run --seeds %d)\n",
               proposal->packings, proposal->packings);
    printf("  safety           %.3g\n", proposal->safety);
    printf("  precision        %s\n", proposal->mixed ? "mixed" : "double");
    if (!plan->groups.mesh) {
        printf("  start            %s\n", proposal->first_break ? "first_break" : "rest");
        printf("  mass scaling     %s", proposal->step_ratio > 1.0 ? "" : "none\n");
        if (proposal->step_ratio > 1.0)
            printf("%.3g of the step without, %.6g %% more mass\n", proposal->step_ratio,
                   gn_two_digits(100.0 * proposal->added_mass));
    }
}

/* Writes an error in percent. A scaling law extrapolated to a reading of zero gives no number. */
static const char *percent(double error, char *text, size_t size) {
    if (error > 1.0)
        snprintf(text, size, "above 100");
    else
        snprintf(text, size, "%.6g", gn_two_digits(100.0 * error));
    return text;
}

static void print_causes(const gn_proposal *proposal) {
    char text[32];
    printf("  error            %s %%", percent(proposal->error, text, sizeof text));
    for (size_t k = 0; k < proposal->causes.count; k++)
        printf("%s%s %s", k ? ", " : ": ", proposal->causes.cause[k].name,
               percent(proposal->causes.cause[k].error, text, sizeof text));
    printf("\n");
    for (size_t k = 0; k < proposal->causes.note_count; k++)
        printf("  note: %s\n", proposal->causes.note[k]);
}

static void print_seconds(const gn_proposal *proposal) {
    char text[32];
    printf("  steps            %.0f%s\n", proposal->steps,
           proposal->packings > 1 ? " in each run" : "");
    printf("  seconds          %s of one processor\n",
           gn_format_seconds(proposal->seconds, text, sizeof text));
}

static void print_proposal(const char *title, const gn_plan *plan, const gn_proposal *proposal) {
    printf("%s\n", title);
    print_settings(plan, proposal);
    print_causes(proposal);
    print_seconds(proposal);
}

/* Prints the cause that dominates the remaining error. */
static void print_floor(const gn_plan *plan, const gn_world *world) {
    const gn_error_cause *most = plan->best.causes.cause;
    for (size_t k = 0; k < plan->best.causes.count; k++)
        if (plan->best.causes.cause[k].error > most->error) most = &plan->best.causes.cause[k];
    char text[32];
    printf("%.3g %% cannot be reached: the least is about %s %%, mostly from %s\n",
           100.0 * plan->wanted.error, percent(plan->best.error / 1.1, text, sizeof text),
           most->name);
    bool shape = world->ctx.given.specimen.pack.shape != GN_SHAPE_NONE;
    if (strcmp(most->name, "packing") != 0 || shape) return;
    double packings = ceil(pow(most->error / plan->wanted.error, 2.0) * 1.2);
    printf("  one packing is one specimen: the mean of about %.0f of them (a shape instead of "
           "specimen.file, and run --seeds) would be within it\n",
           packings);
}

static void print_plan(const gn_plan *plan, const gn_world *world) {
    print_estimate(plan, world);
    print_proposal("as the scene is", plan, &plan->current);
    if (!plan->reached) print_floor(plan, world);
    char title[96];
    snprintf(title, sizeof title, "proposed for the %s within %.3g %%, at 95 %% confidence",
             plan->wanted.reading, 100.0 * (plan->reached ? plan->wanted.error : plan->best.error));
    if (plan->best.error <= 1.0) print_proposal(title, plan, &plan->best);
    if (plan->statics_refusal && !plan->groups.mesh)
        printf("  note: start: first_break expects %s\n", plan->statics_refusal);
}

/* --- JSON --- */

static void json_proposal(gn_json *json, const char *key, const gn_plan *plan,
                          const gn_proposal *proposal) {
    gn_json_object(json, key);
    GN_JSON_NUMBERS(json, {"pace", proposal->pace},
                    {"closing", plan->estimate.closing_velocity * proposal->pace});
    if (!plan->groups.mesh) gn_json_number(json, "particles", proposal->particles);
    gn_json_integer(json, "packings", proposal->packings);
    if (plan->groups.mesh) gn_json_number(json, "cell", proposal->cell);
    gn_json_number(json, "safety", proposal->safety);
    gn_json_text(json, "precision", proposal->mixed ? "mixed" : "double");
    gn_json_text(json, "start", proposal->first_break ? "first_break" : "rest");
    GN_JSON_NUMBERS(json, {"mass_scaling", proposal->step_ratio},
                    {"added_mass", proposal->added_mass}, {"error", proposal->error});
    gn_json_object(json, "causes");
    for (size_t k = 0; k < proposal->causes.count; k++)
        gn_json_number(json, proposal->causes.cause[k].name, proposal->causes.cause[k].error);
    gn_json_end(json);
    gn_json_array(json, "notes");
    for (size_t k = 0; k < proposal->causes.note_count; k++)
        gn_json_text(json, NULL, proposal->causes.note[k]);
    gn_json_end(json);
    GN_JSON_NUMBERS(json, {"steps", proposal->steps}, {"seconds", proposal->seconds});
    gn_json_end(json);
}

static void json_estimate(gn_json *json, const gn_estimate *estimate) {
    gn_json_object(json, "estimate");
    gn_json_text(json, "study", estimate->study);
    GN_JSON_NUMBERS(json, {"closing", estimate->closing_velocity}, {"path", estimate->path_strain},
                    {"end", estimate->end_strain}, {"uniform_modulus", estimate->uniform_modulus},
                    {"uniform_poisson", estimate->poisson},
                    {"breaking_strain", estimate->breaking_strain}, {"modulus", estimate->modulus},
                    {"wave", estimate->wave_speed}, {"strength", estimate->strength},
                    {"strain", estimate->strain}, {"compliance", estimate->compliance},
                    {"speed", estimate->speed}, {"across", estimate->across});
    gn_json_end(json);
}

static void json_plan(const gn_plan *plan, const gn_world *world) {
    gn_json *json = gn_json_begin();
    gn_json_number(json, "wanted", plan->wanted.error);
    gn_json_text(json, "reading", plan->wanted.reading);
    gn_json_bool(json, "reached", plan->reached);
    GN_JSON_NUMBERS(json, {"dt", world->ctx.dt},
                    {"particles", (double)world->dem.particles.soa.count},
                    {"contacts", (double)gn_lists_count(&world->dem)});
    gn_json_object(json, "cost");
    GN_JSON_NUMBERS(json, {"particle", plan->cost[0].particle}, {"contact", plan->cost[0].contact},
                    {"element", plan->cost[0].element}, {"row", plan->cost[0].row},
                    {"setup", plan->setup});
    gn_json_end(json);
    json_estimate(json, &plan->estimate);
    json_proposal(json, "as_is", plan, &plan->current);
    json_proposal(json, "proposed", plan, &plan->best);
    gn_print_object("result", gn_json_finish(json, false));
}

/* --- the scene --- */

/* Collects the settings of the new scene: overrides of the command line, then the proposed
 * settings. */
static gneiss_status all_settings(const gn_options *options, const gn_plan *plan,
                                  const gn_world *world, gn_settings *settings,
                                  gneiss_error *error) {
    for (size_t k = 0; k < options->override_count; k++)
        GN_TRY(gn_settings_add(settings, options->overrides[k].key, options->overrides[k].value,
                               error));
    return gn_settings_make(&world->ctx, plan, &plan->best, settings, error);
}

/* Corrects the number of cells and the step that they allow, by making the cells. */
static gneiss_status correct(const gn_options *options, const gn_settings *settings, gn_plan *plan,
                             gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    GN_FREED_BY(gn_world_delete) gn_world *world = NULL;
    if (!plan->groups.mesh) return GNEISS_OK;
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    GN_TRY(gn_new(&world, 1, "a model", error));
    GN_TRY(gn_scene_load(options->target, settings->setting, settings->count, scene, error));
    scene->allow_gmsh = options->allow_gmsh;
    GN_TRY(gn_world_create(scene, world, error));
    gn_plan_correct(&world->ctx, &world->solids, plan, &plan->best);
    return GNEISS_OK;
}

/* Prints a text of any length into a comment, whose lines all begin with "#". */
static void put_comment(FILE *out, const char *text) {
    for (; *text; text++)
        if (*text == '\n')
            fputs("\n# ", out);
        else if (*text == '\'')
            fputs("'\\''", out); /* an apostrophe inside quotation marks, as a shell reads it */
        else
            fputc((unsigned char)*text < ' ' ? '?' : *text, out);
}

/* Returns the text of the scene with the settings filled in, after a list of the settings as a
 * comment. */
static gneiss_status scene_text(const gn_options *options, const gn_settings *settings,
                                const gn_scene *scene, char **text, gneiss_error *error) {
    GN_FREED char *resolved = gn_scene_write(scene);
    char shown[GN_PATH_SIZE];
    size_t size;
    FILE *out;
    if (!resolved) return gn_no_memory(error, "the text of the scene");
    GN_TRY(gn_text_open(text, &size, &out, "the text of the scene", error));
    fprintf(out, "# %s%s\n", gn_printable(options->target, shown, sizeof shown),
            settings->count ? " with" : "");
    for (size_t k = 0; k < settings->count; k++) {
        fputs("#   --set '", out);
        put_comment(out, settings->setting[k].key);
        fputc('=', out);
        put_comment(out, settings->setting[k].value);
        fputs("'\n", out);
    }
    fprintf(out, "%s", resolved);
    return gn_text_close(out, "the text of the scene", error);
}

static bool is_same_file(const char *one, const char *other) {
    struct stat a, b;
    return stat(one, &a) == 0 && stat(other, &b) == 0 && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

bool gn_plan_wrote(const char *path, const char *target) {
    char first[GN_PATH_SIZE + 8] = "";
    FILE *file = fopen(path, "r");
    const bool read = file && fgets(first, sizeof first, file) && strncmp(first, "# ", 2) == 0;
    if (file) (void)fclose(file);
    if (!read) return false;
    first[strcspn(first, "\n")] = '\0';
    const size_t length = strlen(first), ending = strlen(" with");
    if (length > ending && strcmp(first + length - ending, " with") == 0)
        first[length - ending] = '\0';
    return is_same_file(first + 2, target);
}

static gneiss_status write_scene(const gn_options *options, const gn_settings *settings,
                                 gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    GN_FREED char *text = NULL;
    if (!options->write) return GNEISS_OK;
    if (!options->force && access(options->write, F_OK) == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.300s: expected no file, found one: --force replaces it", options->write);
    if (is_same_file(options->write, options->target))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.300s: expected another file than the scene, whose comments would be lost",
                       options->write);
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    GN_TRY(gn_scene_load(options->target, settings->setting, settings->count, scene, error));
    GN_TRY(scene_text(options, settings, scene, &text, error));
    GN_TRY(gn_write_text_file(options->write, text, GN_DURABLE, error));
    if (!options->json && !options->quiet)
        printf("written: %s, resolved; its first lines give the settings for --set\n",
               options->write);
    return GNEISS_OK;
}

static gneiss_status tell(const gn_options *options, const gn_world *world, gn_plan *plan,
                          gneiss_error *error) {
    GN_FREED_BY(gn_settings_free) gn_settings settings = {0};
    GN_TRY(all_settings(options, plan, world, &settings, error));
    GN_TRY(correct(options, &settings, plan, error));
    if (options->json)
        json_plan(plan, world);
    else if (!options->quiet || strcmp(options->command, "plan") == 0)
        print_plan(plan, world);
    return write_scene(options, &settings, error);
}

/* Checks the folder for results of a planned run, which is named after its scene file, before the
 * scene of earlier results is replaced. */
static gneiss_status check_folder_of_runs(const gn_options *options, int packings,
                                          gneiss_error *error) {
    char folder[GN_PATH_SIZE];
    snprintf(folder, sizeof folder, "%.*s", (int)(strlen(options->write) - strlen(".yaml")),
             options->write);
    return gn_folder_check_use(folder, packings > 1 ? GN_FOLDER_OF_RUNS : GN_FOLDER_OF_RUN, error);
}

const char *gn_planned_reading(const gn_options *options, const gn_scene *scene) {
    if (options->reading) return options->reading;
    return scene->has_specimen ? "strength" : "stiffness";
}

gneiss_status gn_plan_accuracy(const gn_options *options, const gn_world *world, double setup,
                               int *packings, gneiss_error *error) {
    gn_wanted wanted = {.error = options->error,
                        .any_particles = options->any_particles,
                        .reading = gn_planned_reading(options, &world->ctx.scene)};
    GN_FREED gn_plan *plan = NULL;
    if (world->ctx.scene.joint_count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: --error: no plan: the errors of joints are not known", options->target);
    GN_TRY(gn_new(&plan, 1, "a plan", error));
    GN_TRY(gn_plan_make(world, &wanted, setup, plan, error));
    if (plan->absent)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: --error: no plan: %s", options->target,
                       plan->absent);
    if (packings && !plan->reached)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: --error: %.3g %% cannot be reached, the least is about %.2g %%: gneiss "
                       "plan prints its causes",
                       options->target, 100.0 * wanted.error, 100.0 * plan->best.error / 1.1);
    if (packings) {
        *packings = plan->best.packings;
        GN_TRY(check_folder_of_runs(options, *packings, error));
    }
    return tell(options, world, plan, error);
}
