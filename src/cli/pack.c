#include "cli/pack.h"

#include "base/new.h"
#include "base/point.h"
#include "base/printable.h"
#include "base/threads.h"
#include "base/timer.h"
#include "cli/line.h"
#include "cli/log.h"
#include "cli/progress.h"
#include "cli/signals.h"
#include "io/io.h"
#include "io/listing.h"
#include "pack/shape.h"
#include "pack/sizes.h"
#include "pack/store.h"
#include "run/folder.h"
#include "world/origin.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- progress ---- */

typedef struct pack_display {
    const gn_options *options;
    double start, next; /* s */
    bool shown;
} pack_display;

static void print_line(const pack_display *display, const gn_pack_progress *progress) {
    char eta[32], pairs[32];
    double seconds = gn_now() - display->start;
    gn_line line = {0};
    gn_line_brief(gn_line_add(&line, 0, "packing %zu particles:", progress->particles), "packing:");
    gn_line_add(&line, 0, "%-10s", gn_pack_stage_name(progress->stage));
    gn_line_brief(gn_line_add(&line, 1, "iteration %d", progress->state.iteration), "iter. %d",
                  progress->state.iteration);
    gn_line_add(&line, 3, "gap %.2e", progress->state.gap_rms);
    gn_line_brief(
        gn_line_add(&line, 2, "largest overlap %.2f %%", 100.0 * progress->state.overlap_max),
        "overlap %.2f %%", 100.0 * progress->state.overlap_max);
    gn_line_add(&line, 4, "%s pairs",
                gn_format_count((double)progress->state.pairs, pairs, sizeof pairs));
    gn_line_add(&line, 1, "at most %s more",
                gn_format_seconds(seconds / progress->fraction - seconds, eta, sizeof eta));
    gn_line_show(&line, false);
}

static void print_json(const gn_pack_progress *progress) {
    gn_json *json = gn_json_begin();
    gn_json_text(json, "packing", gn_pack_stage_name(progress->stage));
    GN_JSON_NUMBERS(json, {"particles", (double)progress->particles},
                    {"iteration", (double)progress->state.iteration},
                    {"fraction", progress->fraction}, {"gap_rms", progress->state.gap_rms},
                    {"overlap_max", progress->state.overlap_max});
    gn_print_object("progress", gn_json_finish(json, false));
}

static bool show(void *context, const gn_pack_progress *progress) {
    pack_display *display = context;
    if (display->options->quiet || gn_now() < display->next) return true;
    display->next = gn_now() + (isatty(STDERR_FILENO) || display->options->json ? 0.5 : 5.0);
    display->shown = true;
    if (display->options->json)
        print_json(progress);
    else
        print_line(display, progress);
    return true;
}

static gneiss_status obtain(const gn_options *options, const gn_scene *scene,
                            gn_pack_result *result, gneiss_error *error) {
    char note[512];
    pack_display d = {.options = options, .start = gn_now()};
    d.next = d.start + 0.5;
    gneiss_status status = gn_pack_obtain(scene, show, &d, result, note, sizeof note, error);
    if (d.shown && !options->json && isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
    if (*note) fprintf(stderr, "gneiss: warning: %s\n", note);
    if (status == GNEISS_OK && *result->changes)
        fprintf(stderr, "gneiss: note: specimen: %s\n", result->changes);
    return status;
}

/* Packs the scene in coordinates relative to its origin, so that the packing does not depend on the
 * origin. */
static gneiss_status obtain_shifted(const gn_options *options, gn_scene *scene, gn_scene *shifted,
                                    gn_pack_result *result, gneiss_error *error) {
    GN_TRY(gn_origin_choose(scene, NULL, error));
    GN_TRY(gn_scene_copy(scene, shifted, error));
    gn_scene_shift(shifted);
    gneiss_status status = obtain(options, shifted, result, error);
    if (status != GNEISS_OK) gn_scene_free(shifted);
    return status;
}

gneiss_status gn_pack_ahead(const gn_options *options, gn_scene *scene, gneiss_error *error) {
    if (scene->specimen.pack.shape == GN_SHAPE_NONE) return GNEISS_OK;
    gn_pack_result result;
    GN_FREED_BY(gn_scene_delete) gn_scene *shifted = NULL;
    GN_TRY(gn_new(&shifted, 1, "a scene", error));
    GN_TRY(obtain_shifted(options, scene, shifted, &result, error));
    if (!options->quiet && !options->json)
        printf("specimen: %zu particles %s\n", result.packing.count,
               result.from_cache ? "packed before (from the cache)" : "packed");
    scene->specimen.packed = result.packing.sphere;
    scene->specimen.packed_count = result.packing.count;
    scene->specimen.packed_volume = result.volume;
    result.packing = (gn_packing){0};
    gn_pack_result_free(&result);
    return GNEISS_OK;
}

/* ---- the command ---- */

static const char interrupted[] = "gneiss: interrupted: packing interrupted\n";

static void print_quality(const gn_scene *scene, const gn_pack_result *result,
                          const gn_pack_quality *quality) {
    const bool plane = scene->dimension == 2;
    const char *who = plane ? "discs" : "spheres";
    printf("%zu %s in %.6g %s, %s %.1f s, %zu iterations%s\n", result->packing.count, who,
           result->volume, plane ? "m2" : "m3",
           result->from_cache ? "from the cache; made in" : "packed in", result->seconds,
           result->trace_count,
           result->in_time ? "" : " (cut short by packing.time: depends on the machine)");
    printf("  porosity         %.2f %% (overlaps counted twice), %.2f %% (once)\n",
           100.0 * quality->porosity, 100.0 * quality->porosity_net);
    printf("  coordination     %.2f at gaps up to 0.1 %% of r_i + r_j, %.2f up to 1 %%, %.2f up to "
           "5 %%\n",
           quality->coordination_01, quality->coordination_1, quality->coordination_5);
    printf("  floating         %.2f %% of the particles have fewer than %d contacts\n",
           100.0 * quality->floating, plane ? 3 : 4);
    printf("  radii            %.4g to %.4g m, mean %.4g m, ratio %.2f (%.2f without the outer "
           "1 %%), variation %.3f\n",
           quality->radius_min, quality->radius_max, quality->radius_mean, quality->radius_ratio,
           quality->radius_ratio_98, quality->radius_variation);
    if (plane)
        printf("  fabric           xx %.4f yy %.4f xy %.4f", quality->fabric[0], quality->fabric[4],
               quality->fabric[1]);
    else
        printf("  fabric           xx %.4f yy %.4f zz %.4f", quality->fabric[0], quality->fabric[4],
               quality->fabric[8]);
    printf("; eigenvalues within %.2f %% of isotropic\n", 100.0 * quality->anisotropy);
    printf("  overlaps         median %.2f %%, largest %.2f %% of r_i + r_j, %.2f per particle\n",
           100.0 * quality->overlap_median, 100.0 * quality->overlap_max, quality->overlaps);
    printf("  boundary         %.1f %% of the particles touch it (gap %.2f %% of the radius rms), "
           "largest protrusion %.2f %%\n",
           100.0 * quality->wall_contacts, 100.0 * quality->wall_gap_rms,
           100.0 * quality->wall_protrusion);
}

/* Prints the requested and the actual sizes. Sizes vary in space in a refined packing or a packing
 * on a mesh. */
static void print_sizes(const gn_scene *scene, const gn_pack_result *result,
                        const gn_pack_quality *quality) {
    const gn_pack_def *def = &scene->specimen.pack;
    const gn_sizes sizes = {def->sizes,       def->size_ratio, def->size_variation,
                            def->sieve_count, def->sieve,      (int)scene->dimension};
    double least, most, at = 0.0, *radius = NULL;
    if (def->sizes == GN_SIZES_FITTED) return;
    gn_sizes_range(&sizes, &least, &most);
    printf("  sizes            requested 1 to %.4g, found 1 to %.4g", most / least,
           quality->radius_ratio);
    if (!def->refinement_count && def->shape != GN_SHAPE_MESH)
        radius = gn_alloc_array(result->packing.count, sizeof *radius);
    for (size_t k = 0; radius && k < result->packing.count; k++)
        radius[k] = result->packing.sphere[4 * k + 3];
    if (radius) {
        const double off = gn_sizes_off(&sizes, radius, result->packing.count, &at);
        printf("; shares by %s off by at most %.1f %%, at %.2f of the largest",
               def->sizes == GN_SIZES_SIEVE ? "mass" : "number", 100.0 * off, at);
    }
    printf("\n");
    gn_free(radius);
}

static void warn_of_sizes(const gn_scene *scene, const gn_pack_result *result,
                          const gn_pack_quality *quality) {
    char text[GNEISS_MESSAGE_SIZE];
    if (gn_pack_is_narrow(scene, quality->radius_min, quality->radius_max, result->packing.count,
                          text, sizeof text))
        fprintf(stderr, "gneiss: warning: %s\n", text);
}

static void print_quality_json(const gn_pack_result *result, const gn_pack_quality *quality) {
    gn_json *json = gn_json_begin();
    GN_JSON_NUMBERS(json, {"particles", (double)result->packing.count}, {"volume", result->volume},
                    {"seconds", result->seconds});
    gn_json_bool(json, "from_cache", result->from_cache);
    gn_json_bool(json, "in_time", result->in_time);
    gn_json_integer(json, "iterations", (int64_t)result->trace_count);
#define PUT(name, unit, text) gn_json_number(json, #name, quality->name);
    GN_PACK_FIGURES(PUT)
#undef PUT
    gn_print_object("result", gn_json_finish(json, false));
}

/* Measures the quality of a packing. A packing from the cache has no body; it is made again here.
 */
static gneiss_status measure(const gn_scene *scene, const gn_pack_result *result,
                             gn_pack_quality *quality, gneiss_error *error) {
    gn_pack_shape body = {0};
    int threads = gn_threads_of(scene->threads);
    if (!result->domain) GN_TRY(gn_pack_shape_create(scene, &body, error));
    gneiss_status status = gn_pack_measure(&result->packing, (int)scene->dimension,
                                           result->domain ? result->domain : body.domain,
                                           result->volume, threads, quality, error);
    gn_pack_shape_free(&body);
    return status;
}

/* Shifts particles to the user's coordinates, in which files are written. */
static void move_out(const gn_scene *scene, gn_packing *packing) {
    for (size_t k = 0; k < packing->count; k++)
        for (size_t a = 0; a < 3; a++)
            packing->sphere[4 * k + a] = gn_point_out(scene->origin[a], packing->sphere[4 * k + a]);
}

/* Warns of an unusual scale, by the size alone, because a packing has no velocities and densities.
 */
static void note_scale(const gn_scene *scene, const gn_pack_result *result) {
    const double large = 5.0; /* m */
    const gn_specimen *specimen = &scene->specimen;
    const bool surface = specimen->pack.shape == GN_SHAPE_SURFACE;
    double longest = 0.0;
    if (specimen->scale_given || !(surface || specimen->pack.shape == GN_SHAPE_MESH)) return;
    for (size_t a = 0; a < (size_t)scene->dimension; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < result->packing.count; k++) {
            low = fmin(low, result->packing.sphere[4 * k + a] - result->packing.sphere[4 * k + 3]);
            high =
                fmax(high, result->packing.sphere[4 * k + a] + result->packing.sphere[4 * k + 3]);
        }
        longest = fmax(longest, high - low);
    }
    if (longest >= large)
        printf("note: %s: %.4g m long with lengths of the file taken as metres, as no scale is "
               "given; scale: 0.001 if they are millimetres, scale: 1 if they are metres\n",
               surface ? "specimen.surface" : "specimen.mesh", longest);
}

static gneiss_status pack_into(const gn_options *options, gn_scene *scene, const char *folder,
                               gneiss_error *error) {
    char shown[GN_PATH_SIZE];
    gn_pack_result result;
    gn_pack_quality quality;
    gn_scene *shifted = gn_alloc(sizeof *shifted);
    if (!shifted) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a scene");
    gneiss_status status = obtain_shifted(options, scene, shifted, &result, error);
    bool obtained = status == GNEISS_OK;
    if (obtained) status = measure(shifted, &result, &quality, error);
    if (obtained) gn_scene_free(shifted);
    gn_free(shifted);
    if (!obtained) return status;
    move_out(scene, &result.packing);
    if (status == GNEISS_OK) {
        (void)gn_signals_set_flag(); /* writing takes little time and is completed */
        status = gn_pack_write_folder(folder, scene, &result, &quality, error);
        if (status == GNEISS_OK) warn_of_sizes(scene, &result, &quality);
        if (status == GNEISS_OK && options->json) print_quality_json(&result, &quality);
        if (status == GNEISS_OK && !options->json) {
            print_quality(scene, &result, &quality);
            print_sizes(scene, &result, &quality);
            note_scale(scene, &result);
        }
        if (status == GNEISS_OK && !options->json && !options->quiet)
            printf("written to %s: packing.txt, packing.h5, particles.hdf.series\n",
                   gn_printable(folder, shown, sizeof shown));
        gn_pack_quality_free(&quality);
    }
    gn_pack_result_free(&result);
    return status;
}

/* Packs the scene. The folder is created first, so that an unwritable folder fails before packing;
 * a new folder is removed if it stays empty. */
static gneiss_status pack_scene(const gn_options *options, gn_scene *scene, gneiss_error *error) {
    char folder[GN_PATH_SIZE];
    int lock = 0;
    GN_TRY(gn_folder_choose(scene, options->out, folder, error));
    bool there = access(folder, F_OK) == 0;
    GN_TRY(gn_make_directory(folder, error));
    GN_TRY(gn_folder_lock(folder, &lock, error));
    gneiss_status status = gn_folder_check_use(folder, GN_FOLDER_OF_PACKING, error);
    if (status == GNEISS_OK && !options->force) status = gn_folder_check_packing(folder, error);
    gn_signals_end_at_once(interrupted, there ? NULL : folder);
    if (status == GNEISS_OK) status = pack_into(options, scene, folder, error);
    gn_signals_end_at_once(interrupted, NULL);
    if (status != GNEISS_OK && !there) rmdir(folder);
    if (lock > 0) close(lock);
    return status;
}

gneiss_status gn_command_pack(const gn_options *options, gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL; /* too large for a small stack */
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    gn_signals_end_at_once(interrupted, NULL);
    GN_TRY(gn_scene_load_specimen(options->target, options->overrides, options->override_count,
                                  scene, error));
    scene->allow_gmsh = options->allow_gmsh;
    return pack_scene(options, scene, error);
}
