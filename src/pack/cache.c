/* The cache of packings, by a hash of the request. */
#include "base/memory.h"
#include "io/atomic_file.h"
#include "io/files.h"
#include "io/h5.h"
#include "pack/shape.h"
#include "pack/store.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* To be raised whenever the same request gives another packing. */
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
    size_t n;
    GN_TRY(gn_h5_rows(file, "trace/iteration", &n, error));
    result->trace = gn_alloc_array(n + 1, sizeof *result->trace);
    int64_t *whole = gn_alloc_array(3 * n + 1, sizeof *whole);
    gneiss_status status =
        result->trace && whole ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    static const char *const names[] = {"trace/iteration", "trace/stage", "trace/pairs"};
    for (size_t k = 0; k < 3 && status == GNEISS_OK; k++)
        status = gn_h5_get(file, names[k], GN_I64, n, 1, 0, whole + k * n, error);
    for (size_t k = 0; k < n && status == GNEISS_OK; k++) {
        result->trace[k].state.iteration = (int)whole[k];
        result->trace[k].state.pairs = (size_t)whole[2 * n + k];
        if (whole[n + k] < 0 || whole[n + k] >= GN_PACK_STAGES)
            status = gn_fail(error, GNEISS_ERROR_INPUT, "trace/stage: %" PRId64, whole[n + k]);
        else
            result->trace[k].stage = (gn_pack_stage)whole[n + k];
    }
    gn_free(whole);
    GN_TRY(status);
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

static gneiss_status get_packing(const gn_h5 *file, const char *key, gn_pack_result *result,
                                 gneiss_error *error) {
    char *found = NULL;
    GN_TRY(gn_h5_get_text(file, "key", &found, error));
    bool same = strcmp(found, key) == 0;
    free(found);
    if (!same) return gn_fail(error, GNEISS_ERROR_INPUT, "it holds another packing");
    gn_packing *p = &result->packing;
    GN_TRY(gn_h5_rows(file, "sphere", &p->count, error));
    p->sphere = gn_alloc_array(p->count + 1, 4 * sizeof *p->sphere);
    if (!p->sphere) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    GN_TRY(gn_h5_get(file, "sphere", GN_F64, p->count, 4, 0, p->sphere, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "volume", &result->volume, 1, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "seconds", &result->seconds, 1, error));
    result->in_time = result->from_cache = true;
    GN_TRY(check_spheres(result, error));
    return get_trace(file, result, error);
}

/* ---- writing ---- */

static gneiss_status put_packing(gn_h5 *file, const char *key, const gn_pack_result *result,
                                 gneiss_error *error) {
    GN_TRY(gn_h5_put_text(file, "key", key, error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "volume", &result->volume, 1, error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "seconds", &result->seconds, 1, error));
    GN_TRY(gn_h5_put(file, "sphere", GN_F64, result->packing.count, 4, 0, result->packing.sphere,
                     "m", "x y z r", error));
    return gn_pack_put_trace(file, result, error);
}

static gneiss_status keep(const char *path, const char *key, const gn_pack_result *result,
                          gneiss_error *error) {
    char *folder = strdup(path);
    if (!folder) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    *strrchr(folder, '/') = '\0';
    gneiss_status status = gn_make_directory(folder, error);
    free(folder);
    gn_h5 *file = NULL;
    if (status == GNEISS_OK) status = gn_h5_create(path, &file, error);
    if (status != GNEISS_OK) return status;
    status = put_packing(file, key, result, error);
    if (status == GNEISS_OK) return gn_h5_commit(file, GN_DURABLE, error);
    gn_h5_close(file);
    return status;
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
