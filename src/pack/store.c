#include "pack/store.h"

#include "base/memory.h"
#include "base/version.h"
#include "io/atomic_file.h"
#include "io/files.h"
#include "io/h5.h"
#include "io/snapshot.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- packing.h5 ---- */

static gneiss_status put_attributes(gn_h5 *file, const gn_scene *scene,
                                    const gn_pack_result *result, gneiss_error *error) {
    const int64_t seed = (int64_t)scene->seed, count = (int64_t)result->packing.count,
                  in_time = result->in_time;
    const gn_h5_attribute list[] = {{"kind", .text = "packing"},
                                    {"version", .text = gn_version()},
                                    {"build", .text = gn_build()},
                                    {"title", .text = scene->title},
                                    {"dimension", .whole = &scene->dimension},
                                    {"seed", .whole = &seed},
                                    {"particles", .whole = &count},
                                    {"in_time", .whole = &in_time},
                                    {"volume", .number = &result->volume},
                                    {"seconds", .number = &result->seconds}};
    return gn_h5_attributes(file, "/", list, sizeof list / sizeof *list, error);
}

static gneiss_status put_particles(gn_h5 *file, const gn_packing *packing, gneiss_error *error) {
    GN_TRY(gn_h5_put(file, "particles/position", GN_F64, packing->count, 3, 4 * sizeof(double),
                     packing->sphere, "m", "centre x y z", error));
    return gn_h5_put(file, "particles/radius", GN_F64, packing->count, 1, 4 * sizeof(double),
                     packing->sphere + 3, "m", "radius", error);
}

static gneiss_status put_figures(gn_h5 *file, const gn_pack_quality *quality, gneiss_error *error) {
#define PUT(name, unit, text)                                                                      \
    GN_TRY(gn_h5_put(file, "quality/" #name, GN_F64, 1, 1, 0, &quality->name, unit, text, error));
    GN_PACK_FIGURES(PUT)
#undef PUT
    GN_TRY(gn_h5_put(file, "quality/fabric", GN_F64, 9, 1, 0, quality->fabric, "1",
                     "(1/N_c) sum n n over contacts at 1 %, by rows", error));
    GN_TRY(gn_h5_put(file, "histogram/radius_edge", GN_F64, GN_PACK_RADIUS_BINS + 1, 1, 0,
                     quality->radius_edge, "m", "bounds of the bins of radius_count", error));
    GN_TRY(gn_h5_put(file, "histogram/radius_count", GN_I64, GN_PACK_RADIUS_BINS, 1, 0,
                     quality->radius_count, "1", "particles", error));
    GN_TRY(gn_h5_put(
        file, "histogram/angle_count", GN_I64, GN_PACK_ANGLE_BINS, 1, 0, quality->angle_count, "1",
        "directions of contacts at 1 % in the xy plane, both ways, bins of 10 degrees", error));
    return gn_h5_put(file, "histogram/polar_count", GN_I64, GN_PACK_ANGLE_BINS, 1, 0,
                     quality->polar_count, "1",
                     "|cos| of their angle with z, 36 equal steps from 0 to 1", error);
}

static gneiss_status put_contacts(gn_h5 *file, const gn_pack_quality *quality,
                                  gneiss_error *error) {
    int64_t pairs = (int64_t)quality->pair_count;
    GN_TRY(gn_h5_attribute_i64(file, "/", "pairs", &pairs, 1, error));
    GN_TRY(gn_h5_put(file, "contacts/pair", GN_I32, quality->pair_count, 2, 0, quality->pair, "1",
                     "particles with a gap of at most 5 % of r_i + r_j, base 0", error));
    return gn_h5_put(file, "contacts/gap", GN_F64, quality->pair_count, 1, 0, quality->gap, "1",
                     "gap over r_i + r_j, negative: overlap", error);
}

gneiss_status gn_pack_put_trace(gn_h5 *file, const gn_pack_result *result, gneiss_error *error) {
    size_t n = result->trace_count, stride = sizeof *result->trace;
    int64_t *whole = gn_alloc_array(3 * n + 1, sizeof *whole);
    if (!whole) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu iterations", n);
    for (size_t k = 0; k < n; k++) {
        whole[k] = result->trace[k].state.iteration;
        whole[n + k] = result->trace[k].stage;
        whole[2 * n + k] = (int64_t)result->trace[k].state.pairs;
    }
    static const struct {
        const char *name, *text;
    } column[] = {{"trace/iteration", "iterations of the fit"},
                  {"trace/stage", "0 spread, 1 compress, 2 decompress, 3 close, 4 separate"},
                  {"trace/pairs", "pairs that count in the sum of squares"}};
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; k < 3 && status == GNEISS_OK; k++)
        status = gn_h5_put(file, column[k].name, GN_I64, n, 1, 0, whole + k * n, "1",
                           column[k].text, error);
    gn_free(whole);
    const gn_pack_trace empty = {0}, *t = n ? result->trace : &empty;
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "trace/energy", GN_F64, n, 1, stride, &t->state.energy, "1",
                           "sum of squares, relative", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "trace/gap_rms", GN_F64, n, 1, stride, &t->state.gap_rms, "1",
                           "root mean square gap of the pairs that count, over r_i + r_j", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "trace/overlap_max", GN_F64, n, 1, stride, &t->state.overlap_max,
                           "1", "largest overlap over r_i + r_j", error);
    return status;
}

static gneiss_status put_request(gn_h5 *file, const gn_scene *scene, gneiss_error *error) {
    char *text = gn_scene_write_specimen(scene);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the request");
    gneiss_status status = gn_h5_put_text(file, "request", text, error);
    free(text);
    return status;
}

static gneiss_status put_all(gn_h5 *file, const gn_scene *scene, const gn_pack_result *result,
                             const gn_pack_quality *quality, gneiss_error *error) {
    GN_TRY(put_attributes(file, scene, result, error));
    int64_t from_cache = result->from_cache;
    GN_TRY(gn_h5_attribute_i64(file, "/", "from_cache", &from_cache, 1, error));
    GN_TRY(put_request(file, scene, error));
    GN_TRY(put_particles(file, &result->packing, error));
    GN_TRY(put_figures(file, quality, error));
    GN_TRY(put_contacts(file, quality, error));
    return gn_pack_put_trace(file, result, error);
}

/* Writes packing.h5 (docs/packing.md has its layout) completely or not at all. */
static gneiss_status write_packing(const char *path, const gn_scene *scene,
                                   const gn_pack_result *result, const gn_pack_quality *quality,
                                   gneiss_error *error) {
    gn_h5 *file = NULL;
    GN_TRY(gn_h5_create(path, &file, error));
    gneiss_status status = put_all(file, scene, result, quality, error);
    if (status == GNEISS_OK) return gn_h5_commit(file, GN_DURABLE, error);
    gn_h5_close(file);
    return status;
}

/* ---- the folder ---- */

static gneiss_status write_snapshot(const char *directory, const gn_packing *packing,
                                    gneiss_error *error) {
    double *block = gn_alloc_array(packing->count + 1, 4 * sizeof *block);
    if (!block) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a snapshot");
    double *radius = block + 3 * packing->count;
    for (size_t k = 0; k < packing->count; k++) {
        memcpy(block + 3 * k, packing->sphere + 4 * k, 3 * sizeof *block);
        radius[k] = packing->sphere[4 * k + 3];
    }
    gn_snapshot_array array = {"radius", "m", 1, radius};
    gn_snapshot snapshot = {.point_count = packing->count,
                            .points = block,
                            .point_array_count = 1,
                            .point_arrays = &array};
    gneiss_status status = gn_snapshot_write(directory, "particles", &snapshot, error);
    gn_free(block);
    gn_snapshot_times times = {0};
    if (status == GNEISS_OK) status = gn_snapshot_series(directory, "particles", 0, &times, error);
    gn_snapshot_times_free(&times);
    return status;
}

/* packing.h5 marks the folder as complete: an earlier one is removed first and the new one is
 * written last, so that a killed call leaves no mixture of two packings. */
gneiss_status gn_pack_write_folder(const char *directory, const gn_scene *scene,
                                   const gn_pack_result *result, const gn_pack_quality *quality,
                                   gneiss_error *error) {
    char path[GN_PATH_SIZE + 32], header[256];
    snprintf(header, sizeof header,
             "%zu particles, porosity %.4f, %.2f contacts each at gaps up to 1 %%; gneiss %s",
             result->packing.count, quality->porosity, quality->coordination_1, gn_version());
    snprintf(path, sizeof path, "%s/packing.h5", directory);
    if (unlink(path) != 0 && errno != ENOENT)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be replaced: %s", path, strerror(errno));
    gn_sync_folder_of(path);
    snprintf(path, sizeof path, "%s/packing.txt", directory);
    GN_TRY(gn_packing_write(path, (int)scene->dimension, &result->packing, header, error));
    GN_TRY(write_snapshot(directory, &result->packing, error));
    snprintf(path, sizeof path, "%s/packing.h5", directory);
    return write_packing(path, scene, result, quality, error);
}
