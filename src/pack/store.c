#include "pack/store.h"

#include "base/new.h"
#include "base/version.h"
#include "io/atomic_file.h"
#include "io/io.h"
#include "io/snapshot.h"
#include "pack/shape.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
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

/* Writes the iterations of the fit as group `trace`. */
static gneiss_status put_trace(gn_h5 *file, const gn_pack_result *result, gneiss_error *error) {
    const size_t n = result->trace_count, stride = sizeof *result->trace;
    const gn_pack_trace empty = {0}, *t = n ? result->trace : &empty;
    const struct {
        const char *name, *text;
        const double *values; /* NULL: the next column of `whole` */
    } columns[] = {{"trace/iteration", "iterations of the fit", NULL},
                   {"trace/stage", "0 spread, 1 compress, 2 decompress, 3 close, 4 separate", NULL},
                   {"trace/pairs", "pairs that count in the sum of squares", NULL},
                   {"trace/energy", "sum of squares, relative", &t->state.energy},
                   {"trace/gap_rms", "root mean square gap of the pairs that count, over r_i + r_j",
                    &t->state.gap_rms},
                   {"trace/overlap_max", "largest overlap over r_i + r_j", &t->state.overlap_max}};
    GN_FREED int64_t *whole = NULL;
    GN_TRY(gn_new(&whole, 3 * n, "iterations", error));
    for (size_t k = 0; k < n; k++) {
        whole[k] = result->trace[k].state.iteration;
        whole[n + k] = result->trace[k].stage;
        whole[2 * n + k] = (int64_t)result->trace[k].state.pairs;
    }
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
        if (columns[k].values)
            GN_TRY(gn_h5_put(file, columns[k].name, GN_F64, n, 1, stride, columns[k].values, "1",
                             columns[k].text, error));
        else
            GN_TRY(gn_h5_put(file, columns[k].name, GN_I64, n, 1, 0, whole + k * n, "1",
                             columns[k].text, error));
    return GNEISS_OK;
}

static gneiss_status put_request(gn_h5 *file, const gn_scene *scene, gneiss_error *error) {
    GN_FREED char *text = gn_scene_write_specimen(scene);
    return text ? gn_h5_put_text(file, "request", text, error) : gn_no_memory(error, "the request");
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
    return put_trace(file, result, error);
}

/* Writes packing.h5 (docs/packing.md has its layout) completely or not at all. */
static gneiss_status write_packing(const char *path, const gn_scene *scene,
                                   const gn_pack_result *result, const gn_pack_quality *quality,
                                   gneiss_error *error) {
    gn_h5 *file = NULL;
    GN_TRY(gn_h5_create(path, &file, error));
    gneiss_status status = put_all(file, scene, result, quality, error);
    if (status == GNEISS_OK) return gn_h5_commit(&file, GN_DURABLE, error);
    gn_h5_close(file);
    return status;
}

/* ---- the folder ---- */

static gneiss_status write_snapshot(const char *directory, const gn_packing *packing,
                                    gneiss_error *error) {
    GN_FREED double *block = NULL;
    GN_FREED_BY(gn_snapshot_times_free) gn_snapshot_times times = {0};
    GN_TRY(gn_new(&block, 4 * packing->count, "coordinates of particles", error));
    double *radius = block + 3 * packing->count;
    for (size_t k = 0; k < packing->count; k++) {
        memcpy(block + 3 * k, packing->sphere + 4 * k, 3 * sizeof *block);
        radius[k] = packing->sphere[4 * k + 3];
    }
    gn_snapshot_array array = {"radius", "m", 1, radius, false};
    gn_snapshot snapshot = {.point_count = packing->count,
                            .points = block,
                            .point_array_count = 1,
                            .point_arrays = &array};
    GN_TRY(gn_snapshot_write(directory, "particles", &snapshot, error));
    return gn_snapshot_series(directory, "particles", 0, &times, error);
}

/* packing.h5 marks the folder as complete: an earlier one is removed first and the new one is
 * written last, so that an interrupted call leaves no mixture of two packings. */
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

/* ---- the cache of packings, by a hash of the request ---- */

/* Versions, to be incremented whenever the same request results in another packing. */
enum { METHOD_VERSION = 1, METHOD_OF_SIZES = 2 };

/* ---- the key ---- */

static gneiss_status hash_file(const char *path, uint64_t *hash, gneiss_error *error) {
    FILE *file = fopen(path, "rbe");
    if (!file) return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be opened", path);
    char buffer[1 << 12];
    size_t length;
    *hash = GN_HASH_SEED;
    while ((length = fread(buffer, 1, sizeof buffer, file)) > 0)
        *hash = gn_hash_bytes(buffer, length, *hash);
    bool failed = ferror(file) != 0;
    fclose(file);
    return failed ? gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be read", path) : GNEISS_OK;
}

/* Writes the request as text without the keys that do not change the packing. */
static char *key_text(const gn_scene *scene, uint64_t contents) {
    gn_scene *plain = malloc(sizeof *plain); /* too large for a small stack */
    if (!plain) return NULL;
    *plain = *scene; /* shares the arrays, which are not freed */
    gn_specimen *s = &plain->specimen;
    s->material[0] = '\0';
    s->group = 1;
    s->density_basis = GN_DENSITY_PARTICLE;
    s->porosity = -1.0;
    s->pack.time_limit = 0.0;
    s->pack.surface_path[0] = s->pack.mesh_path[0] = '\0';
    /* Requested size distributions without overlap have a later version of the method. */
    const bool sizes = s->pack.sizes != GN_SIZES_FITTED && s->pack.overlap == GN_OVERLAP_NONE;
    char *request = gn_scene_write_specimen(plain);
    char *key = request
                    ? gn_text_format("method: %d\nfile: %016" PRIx64 "\n%s",
                                     sizes ? METHOD_OF_SIZES : METHOD_VERSION, contents, request)
                    : NULL;
    free(request);
    free(plain);
    return key;
}

static gneiss_status make_key(const gn_scene *scene, char **key, gneiss_error *error) {
    const gn_pack_def *def = &scene->specimen.pack;
    uint64_t contents = 0;
    const char *path = def->shape == GN_SHAPE_MESH      ? def->mesh_path
                       : def->shape == GN_SHAPE_SURFACE ? def->surface_path
                                                        : NULL;
    if (path) GN_TRY(hash_file(path, &contents, error));
    *key = key_text(scene, contents);
    return *key ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a key");
}

/* Returns the file's path; NULL: the cache is off, or has no folder. */
static char *cache_path(const char *key) {
    const char *own = getenv("GNEISS_CACHE"), *xdg = getenv("XDG_CACHE_HOME"),
               *home = getenv("HOME");
    uint64_t hash = gn_hash_bytes(key, strlen(key), GN_HASH_SEED);
    if (own && *own)
        return strcmp(own, "off") == 0 ? NULL
                                       : gn_text_format("%s/packing-%016" PRIx64 ".h5", own, hash);
    if (xdg && *xdg == '/') return gn_text_format("%s/gneiss/packing-%016" PRIx64 ".h5", xdg, hash);
    if (home && *home == '/')
        return gn_text_format("%s/.cache/gneiss/packing-%016" PRIx64 ".h5", home, hash);
    return NULL;
}

/* ---- reading ---- */

static gneiss_status get_trace(const gn_h5 *file, gn_pack_result *result, gneiss_error *error) {
    static const char *const names[] = {"trace/iteration", "trace/stage", "trace/pairs"};
    size_t n;
    GN_FREED int64_t *whole = NULL;
    GN_TRY(gn_h5_rows(file, "trace/iteration", &n, error));
    GN_TRY(gn_new(&result->trace, n, "iterations", error));
    GN_TRY(gn_new(&whole, 3 * n, "iterations", error));
    for (size_t k = 0; k < 3; k++)
        GN_TRY(gn_h5_get(file, names[k], GN_I64, n, 1, 0, whole + k * n, error));
    for (size_t k = 0; k < n; k++) {
        if (whole[n + k] < 0 || whole[n + k] >= GN_PACK_STAGES)
            return gn_fail(error, GNEISS_ERROR_INPUT, "trace/stage: %" PRId64, whole[n + k]);
        result->trace[k].state.iteration = (int)whole[k];
        result->trace[k].stage = (gn_pack_stage)whole[n + k];
        result->trace[k].state.pairs = (size_t)whole[2 * n + k];
    }
    result->trace_count = n;
    if (n == 0) return GNEISS_OK;
    size_t stride = sizeof *result->trace;
    gn_fit_state *s = &result->trace->state;
    GN_TRY(gn_h5_get(file, "trace/energy", GN_F64, n, 1, stride, &s->energy, error));
    GN_TRY(gn_h5_get(file, "trace/gap_rms", GN_F64, n, 1, stride, &s->gap_rms, error));
    return gn_h5_get(file, "trace/overlap_max", GN_F64, n, 1, stride, &s->overlap_max, error);
}

static gneiss_status check_spheres(const gn_pack_result *result, gneiss_error *error) {
    if (!(result->packing.count > 0 && result->packing.count <= INT32_MAX && result->volume > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected particles in a volume, found %zu in %g m3", result->packing.count,
                       result->volume);
    for (size_t k = 0; k < result->packing.count; k++) {
        const double *sphere = result->packing.sphere + 4 * k;
        if (!(sphere[3] > 0.0 && sphere[3] < 1e30 && fabs(sphere[0]) < 1e30 &&
              fabs(sphere[1]) < 1e30 && fabs(sphere[2]) < 1e30))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "data set sphere: expected a place and a radius > 0, below 1e30 m, "
                           "found %g %g %g %g "
                           "in row %zu",
                           sphere[0], sphere[1], sphere[2], sphere[3], k);
    }
    return GNEISS_OK;
}

/* Files that older versions wrote have no changes. */
static gneiss_status get_changes(const gn_h5 *file, gn_pack_result *result, gneiss_error *error) {
    GN_FREED char *changes = NULL;
    if (!gn_h5_has(file, "changes")) return GNEISS_OK;
    GN_TRY(gn_h5_get_text(file, "changes", &changes, error));
    snprintf(result->changes, sizeof result->changes, "%s", changes);
    return GNEISS_OK;
}

static gneiss_status get_packing(const gn_h5 *file, const char *key, gn_pack_result *result,
                                 gneiss_error *error) {
    GN_FREED char *found = NULL;
    gn_packing *p = &result->packing;
    GN_TRY(gn_h5_get_text(file, "key", &found, error));
    if (strcmp(found, key) != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "it holds another packing");
    GN_TRY(gn_h5_rows(file, "sphere", &p->count, error));
    GN_TRY(gn_new(&p->sphere, 4 * p->count, "coordinates of particles", error));
    GN_TRY(gn_h5_get(file, "sphere", GN_F64, p->count, 4, 0, p->sphere, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "volume", &result->volume, 1, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "seconds", &result->seconds, 1, error));
    GN_TRY(get_changes(file, result, error));
    result->in_time = result->from_cache = true;
    GN_TRY(check_spheres(result, error));
    return get_trace(file, result, error);
}

/* ---- writing ---- */

static gneiss_status put_packing(gn_h5 *file, const char *key, const gn_pack_result *result,
                                 gneiss_error *error) {
    GN_TRY(gn_h5_put_text(file, "key", key, error));
    if (*result->changes) GN_TRY(gn_h5_put_text(file, "changes", result->changes, error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "volume", &result->volume, 1, error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "seconds", &result->seconds, 1, error));
    GN_TRY(gn_h5_put(file, "sphere", GN_F64, result->packing.count, 4, 0, result->packing.sphere,
                     "m", "x y z r", error));
    return put_trace(file, result, error);
}

static gneiss_status keep(const char *path, const char *key, const gn_pack_result *result,
                          gneiss_error *error) {
    GN_FREED char *folder = strdup(path);
    GN_FREED_BY(gn_h5_close_at) gn_h5 *file = NULL;
    if (!folder) return gn_no_memory(error, "a name");
    *strrchr(folder, '/') = '\0';
    GN_TRY(gn_make_directory(folder, error)); /* NOLINT(clang-analyzer-unix.Malloc): GN_FREED */
    GN_TRY(gn_h5_create(path, &file, error));
    GN_TRY(put_packing(file, key, result, error));
    return gn_h5_commit(&file, GN_DURABLE, error);
}

static bool look_up(const char *path, const char *key, gn_pack_result *result, char *note,
                    size_t size) {
    gneiss_error error = {0};
    gn_h5 *file = NULL;
    *result = (gn_pack_result){0};
    if (access(path, F_OK) != 0) return false;
    gneiss_status status = gn_h5_open(path, &file, &error);
    if (status == GNEISS_OK) status = gn_h5_check_names(file, true, &error);
    if (status == GNEISS_OK) gn_h5_demand_finite(file, true);
    if (status == GNEISS_OK) status = get_packing(file, key, result, &error);
    gn_h5_close(file);
    if (status == GNEISS_OK) return true;
    gn_pack_result_free(result);
    snprintf(note, size, "%s: not used: %.300s", path, error.message);
    return false;
}

gneiss_status gn_pack_obtain(const gn_scene *scene, gn_pack_watch *watch, void *context,
                             gn_pack_result *result, char *note, size_t size, gneiss_error *error) {
    char *key = NULL;
    gneiss_error trouble = {0};
    *note = '\0';
    GN_TRY(gn_pack_check_geometry(scene, error)); /* required even if the cache has the packing */
    GN_TRY(make_key(scene, &key, error));
    char *path = cache_path(key);
    gneiss_status status = GNEISS_OK;
    if (!path || !look_up(path, key, result, note, size)) {
        status = gn_pack_make(scene, watch, context, result, error);
        if (status == GNEISS_OK && path && result->in_time &&
            keep(path, key, result, &trouble) != GNEISS_OK)
            snprintf(note, size, "packing not cached: %.300s", trouble.message);
    }
    free(path);
    free(key);
    return status;
}
