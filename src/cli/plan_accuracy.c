#include "cli/plan_accuracy.h"

#include "base/memory.h"
#include "cli/progress.h"
#include "cli/shown.h"
#include "io/files.h"
#include "plan/rewrite.h"
#include "plan/setting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

gneiss_status gn_plan_read_error(const char *text, double *wanted, gneiss_error *error) {
    char *rest;
    *wanted = strtod(text, &rest);
    bool number = rest != text;
    rest += strspn(rest, " ");
    if (*rest == '%') {
        *wanted /= 100.0;
        rest++;
    }
    if (number && !*rest && *wanted > 0.0 && *wanted <= 1.0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "--error: expected a share in (0, 1] or (0, 100] %% such as 5%%, found '%s'",
                   text);
}

/* --- words --- */

static void print_estimate(const gn_plan *plan, const gn_world *w) {
    const gn_estimate *e = &plan->estimate;
    printf("estimated from the specimen, by the study's case '%s'\n", e->study);
    if (e->elements) {
        printf("  closing          %.4g m/s over %.3g %% of strain\n", e->closing, 100.0 * e->path);
        return;
    }
    printf("  E                %.4g GPa (%.4g in uniform strain), wave speed %.4g m/s\n",
           e->modulus / 1e9, e->uniform / 1e9, e->wave);
    if (isfinite(e->strain))
        printf("  peak             %.4g MPa at %.3g %% between the ends\n", e->strength / 1e6,
               100.0 * e->strain);
    else
        printf("  peak             none: nothing can break\n");
    printf("  closing          %.4g m/s, over wave speed and strain: %.2g\n", e->closing, e->speed);
    printf("  across           %.3g of %zu particles\n", e->across, w->dem.particles.soa.count);
}

static void print_settings(const gn_plan *plan, const gn_proposal *p) {
    double closing = plan->estimate.closing * p->pace;
    printf("  loading          %.4g m/s, both ends together", closing);
    if (p->pace != 1.0) printf(" (%.3g of the scene's)", p->pace);
    printf("\n");
    if (plan->groups.mesh)
        printf("  cells            %.3g of the scene's\n", p->cell);
    else
        printf("  particles        %.0f%s\n", p->particles,
               p->particles == plan->groups.particles ? "" : ", with contacts calibrated for them");
    if (p->packings > 1)
        printf("  packings         %d, and the mean of them (gneiss run --seeds %d)\n", p->packings,
               p->packings);
    printf("  safety           %.3g\n", p->safety);
    printf("  precision        %s\n", p->mixed ? "mixed" : "double");
    if (!plan->groups.mesh) {
        printf("  start            %s\n", p->first_break ? "first_break" : "rest");
        printf("  mass scaling     %s", p->masses > 1.0 ? "" : "none\n");
        if (p->masses > 1.0)
            printf("%.3g of the step without, %.6g %% more mass\n", p->masses,
                   gn_two_digits(100.0 * p->added));
    }
}

/* A law that is followed to where nothing is left of the reading has no number to give. */
static const char *percent(double error, char *text, size_t size) {
    if (error > 1.0)
        snprintf(text, size, "above 100");
    else
        snprintf(text, size, "%.6g", gn_two_digits(100.0 * error));
    return text;
}

static void print_causes(const gn_proposal *p) {
    char text[32];
    printf("  error            %s %%", percent(p->error, text, sizeof text));
    for (size_t k = 0; k < p->causes.count; k++)
        printf("%s%s %s", k ? ", " : ": ", p->causes.cause[k].name,
               percent(p->causes.cause[k].error, text, sizeof text));
    printf("\n");
    for (size_t k = 0; k < p->causes.note_count; k++) printf("  note: %s\n", p->causes.note[k]);
}

static void print_seconds(const gn_proposal *p) {
    char text[32];
    printf("  steps            %.0f%s\n", p->steps, p->packings > 1 ? " in each run" : "");
    printf("  seconds          %s of one processor\n",
           gn_format_seconds(p->seconds, text, sizeof text));
}

static void print_proposal(const char *title, const gn_plan *plan, const gn_proposal *p) {
    printf("%s\n", title);
    print_settings(plan, p);
    print_causes(p);
    print_seconds(p);
}

/* What keeps the error up when nothing else is in the way. */
static void print_floor(const gn_plan *plan, const gn_world *w) {
    const gn_error_cause *most = plan->best.causes.cause;
    for (size_t k = 0; k < plan->best.causes.count; k++)
        if (plan->best.causes.cause[k].error > most->error) most = &plan->best.causes.cause[k];
    char text[32];
    printf("%.3g %% cannot be reached: the least is about %s %%, most of it by %s\n",
           100.0 * plan->wanted.error, percent(plan->best.error / 1.1, text, sizeof text),
           most->name);
    bool shape = w->ctx.given.specimen.pack.shape != GN_SHAPE_NONE;
    if (strcmp(most->name, "packing") != 0 || shape) return;
    double packings = ceil(pow(most->error / plan->wanted.error, 2.0) * 1.2);
    printf(
        "  one packing is one specimen: about %.0f of them (a shape instead of specimen.file, and "
        "run --seeds) would have their mean within it\n",
        packings);
}

static void print_plan(const gn_plan *plan, const gn_world *w) {
    print_estimate(plan, w);
    print_proposal("as the scene is", plan, &plan->as_is);
    if (!plan->reached) print_floor(plan, w);
    char title[96];
    snprintf(title, sizeof title, "proposed for the %s within %.3g %%, 95 times of 100",
             plan->wanted.reading, 100.0 * (plan->reached ? plan->wanted.error : plan->best.error));
    if (plan->best.error <= 1.0) print_proposal(title, plan, &plan->best);
    if (plan->no_statics && !plan->groups.mesh)
        printf("  note: start: first_break expects %s\n", plan->no_statics);
}

/* --- JSON --- */

static void json_proposal(gn_json *j, const char *key, const gn_plan *plan, const gn_proposal *p) {
    gn_json_object(j, key);
    gn_json_number(j, "pace", p->pace);
    gn_json_number(j, "closing", plan->estimate.closing * p->pace);
    if (!plan->groups.mesh) gn_json_number(j, "particles", p->particles);
    gn_json_integer(j, "packings", p->packings);
    if (plan->groups.mesh) gn_json_number(j, "cell", p->cell);
    gn_json_number(j, "safety", p->safety);
    gn_json_text(j, "precision", p->mixed ? "mixed" : "double");
    gn_json_text(j, "start", p->first_break ? "first_break" : "rest");
    gn_json_number(j, "mass_scaling", p->masses);
    gn_json_number(j, "added_mass", p->added);
    gn_json_number(j, "error", p->error);
    gn_json_object(j, "causes");
    for (size_t k = 0; k < p->causes.count; k++)
        gn_json_number(j, p->causes.cause[k].name, p->causes.cause[k].error);
    gn_json_end(j);
    gn_json_array(j, "notes");
    for (size_t k = 0; k < p->causes.note_count; k++) gn_json_text(j, NULL, p->causes.note[k]);
    gn_json_end(j);
    gn_json_number(j, "steps", p->steps);
    gn_json_number(j, "seconds", p->seconds);
    gn_json_end(j);
}

static void json_estimate(gn_json *j, const gn_estimate *e) {
    gn_json_object(j, "estimate");
    gn_json_text(j, "study", e->study);
    gn_json_number(j, "closing", e->closing);
    gn_json_number(j, "path", e->path);
    gn_json_number(j, "end", e->end);
    gn_json_number(j, "uniform_modulus", e->uniform);
    gn_json_number(j, "uniform_poisson", e->poisson);
    gn_json_number(j, "breaking_strain", e->breaking);
    gn_json_number(j, "modulus", e->modulus);
    gn_json_number(j, "wave", e->wave);
    gn_json_number(j, "strength", e->strength);
    gn_json_number(j, "strain", e->strain);
    gn_json_number(j, "compliance", e->compliance);
    gn_json_number(j, "speed", e->speed);
    gn_json_number(j, "across", e->across);
    gn_json_end(j);
}

static void json_plan(const gn_plan *plan, const gn_world *w) {
    gn_json *j = gn_json_begin();
    gn_json_number(j, "wanted", plan->wanted.error);
    gn_json_text(j, "reading", plan->wanted.reading);
    gn_json_bool(j, "reached", plan->reached);
    gn_json_number(j, "dt", w->ctx.dt);
    gn_json_integer(j, "particles", (int64_t)w->dem.particles.soa.count);
    gn_json_integer(j, "contacts", (int64_t)(w->dem.bonds.soa.count + w->dem.pairs.soa.count));
    gn_json_object(j, "cost");
    gn_json_number(j, "particle", plan->cost[0].particle);
    gn_json_number(j, "contact", plan->cost[0].contact);
    gn_json_number(j, "element", plan->cost[0].element);
    gn_json_number(j, "row", plan->cost[0].row);
    gn_json_number(j, "setup", plan->setup);
    gn_json_end(j);
    json_estimate(j, &plan->estimate);
    json_proposal(j, "as_is", plan, &plan->as_is);
    json_proposal(j, "proposed", plan, &plan->best);
    char *text = gn_json_finish(j, false);
    if (text) puts(text);
    free(text);
}

/* --- the scene --- */

/* What the command line overrides is in the new scene as well, before what is proposed. */
static gneiss_status all_settings(const gn_options *o, const gn_plan *plan, const gn_world *w,
                                  gn_settings *settings, gneiss_error *error) {
    for (size_t k = 0; k < o->override_count; k++)
        GN_TRY(gn_settings_add(settings, o->overrides[k].key, o->overrides[k].value, error));
    return gn_settings_make(&w->ctx, plan, &plan->best, settings, error);
}

/* How many cells there are, and which step they take, is seen by making them. */
static gneiss_status correct(const gn_options *o, const gn_settings *settings, gn_plan *plan,
                             gneiss_error *error) {
    if (!plan->groups.mesh) return GNEISS_OK;
    gn_scene *scene = gn_alloc(sizeof *scene);
    gn_world *w = gn_alloc(sizeof *w);
    gneiss_status status =
        scene && w ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    if (status == GNEISS_OK)
        status = gn_scene_load(o->target, settings->setting, settings->count, scene, error);
    if (status == GNEISS_OK) scene->allow_gmsh = o->allow_gmsh;
    if (status == GNEISS_OK) status = gn_world_create(scene, w, error);
    if (status == GNEISS_OK) {
        gn_plan_correct(&w->ctx, &w->solids, plan, &plan->best);
        gn_world_free(w);
    }
    gn_free(scene);
    gn_free(w);
    return status;
}

static gneiss_status write_scene(const gn_options *o, const gn_settings *settings,
                                 gneiss_error *error) {
    bool plain = false;
    if (!o->write) return GNEISS_OK;
    GN_TRY(gn_scene_rewrite(o->target, settings->setting, settings->count, o->write, o->force,
                            &plain, error));
    if (!o->json)
        printf("written: %s%s\n", o->write,
               plain ? " (resolved, without comments: the way the scene is written cannot be kept)"
                     : "");
    return GNEISS_OK;
}

static gneiss_status tell(const gn_options *o, const gn_world *w, gn_plan *plan,
                          gneiss_error *error) {
    gn_settings settings = {0};
    gneiss_status status = all_settings(o, plan, w, &settings, error);
    if (status == GNEISS_OK) status = correct(o, &settings, plan, error);
    if (status == GNEISS_OK && o->json) json_plan(plan, w);
    if (status == GNEISS_OK && !o->json) print_plan(plan, w);
    if (status == GNEISS_OK) status = write_scene(o, &settings, error);
    gn_settings_free(&settings);
    return status;
}

gneiss_status gn_plan_accuracy(const gn_options *o, const gn_world *w, double setup,
                               gneiss_error *error) {
    gn_plan *plan = gn_alloc(sizeof *plan);
    if (!plan) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    gn_wanted wanted = {.reading = o->reading ? o->reading : "strength"};
    wanted.any_particles = o->any_particles;
    gneiss_status status = gn_plan_read_error(o->error, &wanted.error, error);
    if (status == GNEISS_OK && !w->ctx.scene.has_specimen && !o->reading)
        wanted.reading = "stiffness";
    if (status == GNEISS_OK) status = gn_plan_make(w, &wanted, setup, plan, error);
    if (status == GNEISS_OK && plan->absent)
        status =
            gn_fail(error, GNEISS_ERROR_INPUT, "%s: --error: no plan: %s", o->target, plan->absent);
    if (status == GNEISS_OK) status = tell(o, w, plan, error);
    gn_free(plan);
    return status;
}
