/* Checkpoints: everything that decides the future, so that a resumed run gives the same bits. */
#include "base/memory.h"
#include "io/checkpoint_files.h"
#include "io/h5.h"
#include "io/h5_pieces.h"
#include "run/run.h"
#include "sim/origin.h"
#include "sim/parts.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { FORMAT = 5 };

#define DOUBLES(member)      GN_PIECE_DOUBLES(gn_run, member)
#define LIMIT(member)        GN_PIECE_ANY(gn_run, member)
#define INTEGER(member)      GN_PIECE_INTEGER(gn_run, member)
#define MEASURED(name, text) DOUBLES(world.name),

static const gn_piece pieces[] = {
    INTEGER(world.step),
    DOUBLES(world.time),
    DOUBLES(world.dt_past),
    DOUBLES(world.dt),
    LIMIT(world.dem.listed),
    LIMIT(world.dem.listed_holds),
    LIMIT(world.dem.resolution.step),
    LIMIT(world.dem.resolution.contact),
    INTEGER(world.dem.resolution.first),
    INTEGER(world.dem.resolution.second),
    LIMIT(world.stable),
    DOUBLES(world.boundary.surface_rate),
    DOUBLES(world.boundary.vertex_rate),
    LIMIT(world.dem.stable),
    LIMIT(world.dem.limit.bound),
    LIMIT(world.dem.limit.sharp),
    LIMIT(world.dem.limit.sharp_low),
    LIMIT(world.dem.limit.frequency),
    LIMIT(world.dem.limit.literature),
    INTEGER(world.dt_lowered),
    DOUBLES(world.energy),
    DOUBLES(world.reading),
    INTEGER(world.dem.broken_tension),
    INTEGER(world.dem.broken_shear),
    INTEGER(world.dem.bonds_at_start),
    GN_MEASURED(MEASURED) DOUBLES(world.stress),
    INTEGER(world.dem.lost),
    INTEGER(world.dem.contact_steps),
    DOUBLES(world.seconds),
    DOUBLES(world.dem.verlet.skin),
    DOUBLES(world.dem.verlet.skin_start),
    DOUBLES(world.dem.verlet.widened),
    DOUBLES(world.dem.verlet.drift),
    INTEGER(world.dem.verlet.rebuilds),
    INTEGER(world.dem.verlet.last_step),
    DOUBLES(world.dem.derived),
    DOUBLES(world.volume),
    DOUBLES(world.lower),
    DOUBLES(world.upper),
    DOUBLES(world.test_length),
    DOUBLES(world.test_area),
    LIMIT(world.dem.radius_min),
    DOUBLES(world.gauge.volume),
    INTEGER(history_interval),
    INTEGER(snapshot_interval),
    DOUBLES(peak),
    INTEGER(bad_since),
};
enum { PIECES = sizeof pieces / sizeof *pieces };

_Static_assert(sizeof(gn_energy) % 8 == 0 && sizeof(gn_wall) % 8 == 0 && sizeof(gn_rigid) % 8 == 0,
               "made of doubles only");
_Static_assert(sizeof(((gn_run *)0)->world.seconds) == GN_PHASE_COUNT * 8, "one double a phase");

/* --- variable-size arrays --- */

typedef struct array {
    const char *name;
    gn_type type;
    size_t rows, components;
    void **data;
} array;

enum { MAX_ARRAYS = 14 };

static size_t list_arrays(gn_run *run, array out[MAX_ARRAYS]) {
    gn_world *w = &run->world;
    size_t n = 0;
    out[n++] = (array){"walls", GN_F64, w->scene.wall_count, sizeof(gn_wall) / 8,
                       (void **)&w->boundary.walls};
    out[n++] = (array){"gauge_id", GN_I32, w->gauge.count, 1, (void **)&w->gauge.id};
    out[n++] = (array){"gauge_weight", GN_F64, w->gauge.count, 3, (void **)&w->gauge.weight};
    if (w->scene.body_count) {
        size_t bodies = w->scene.body_count;
        out[n++] =
            (array){"bodies", GN_F64, bodies, sizeof(gn_rigid) / 8, (void **)&w->boundary.bodies};
        out[n++] = (array){"body_shape", GN_I64, bodies, 3, (void **)&w->boundary.body_shape};
        out[n++] = (array){"body_vertex", GN_F64, w->boundary.body_vertex_count, 4,
                           (void **)&w->boundary.body_vertex};
        out[n++] = (array){"body_corner", GN_I32, w->boundary.body_corner_count, 1,
                           (void **)&w->boundary.body_corner};
    }
    if (!(w->effects & GN_FX_PRESCRIBED)) return n;
    gn_prescription *f = &w->dem.prescribed;
    out[n++] = (array){"prescribed_set", GN_I32, f->count, 1, (void **)&f->set};
    out[n++] = (array){"prescribed_mask", GN_U8, f->count, 1, (void **)&f->mask};
    out[n++] = (array){"prescribed_velocity", GN_F64, f->count, 6, (void **)&f->velocity};
    out[n++] = (array){"prescribed_load", GN_F64, f->count, 6, (void **)&f->load};
    out[n++] = (array){"channel_set", GN_I32, f->count, 6, (void **)&w->dem.channel_set};
    out[n++] =
        (array){"set_reaction", GN_F64, w->scene.set_count, 6, (void **)&w->dem.set_reaction};
    return n;
}

/* --- writing --- */

static gneiss_status put_pieces(gn_run *run, gn_h5 *file, gneiss_error *error) {
    GN_TRY(gn_h5_put_pieces(file, "run", pieces, PIECES, run, error));
    array arrays[MAX_ARRAYS];
    size_t count = list_arrays(run, arrays);
    for (size_t k = 0; k < count; k++) {
        char path[128];
        snprintf(path, sizeof path, "arrays/%s", arrays[k].name);
        GN_TRY(gn_h5_put(file, path, arrays[k].type, arrays[k].rows, arrays[k].components, 0,
                         *arrays[k].data, NULL, NULL, error));
    }
    return GNEISS_OK;
}

static gneiss_status put_history(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    for (size_t c = 0; c < run->history.column_count; c++) {
        const gn_column *column = &run->history.columns[c];
        char path[160];
        snprintf(path, sizeof path, "history/%s", column->name);
        gn_h5_demand_finite(file, !column->absent);
        GN_TRY(gn_h5_put(file, path, GN_F64, run->history.row_count, 1, 0, column->value, NULL,
                         NULL, error));
    }
    gn_h5_demand_finite(file, true);
    return GNEISS_OK;
}

static gneiss_status put_all(gn_run *run, gn_h5 *file, gneiss_error *error) {
    gn_world *w = &run->world;
    int64_t format = FORMAT, bonds = (int64_t)w->dem.bonds.soa.effects,
            pairs = (int64_t)w->dem.pairs.soa.effects;
    uint64_t hash = gn_world_hash(w);
    GN_TRY(gn_h5_attribute_i64(file, "/", "format", &format, 1, error));
    GN_TRY(gn_h5_attribute_i64(file, "/", "state_hash", (const int64_t *)&hash, 1, error));
    GN_TRY(gn_h5_attribute_i64(file, "/", "bond_effects", &bonds, 1, error));
    GN_TRY(gn_h5_attribute_i64(file, "/", "pair_effects", &pairs, 1, error));
    GN_TRY(gn_h5_attribute_text(file, "/", "version", gn_version(), error));
    GN_TRY(gn_h5_attribute_text(file, "/", "scene_file", w->scene.source, error));
    char *scene = gn_scene_write(&w->given);
    if (!scene) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the scene text");
    gneiss_status status = gn_h5_put_text(file, "scene", scene, error);
    free(scene);
    GN_TRY(status);
    double seconds = gn_run_progress(run).seconds;
    GN_TRY(gn_h5_attribute_f64(file, "/", "seconds", &seconds, 1, error));
    GN_TRY(gn_h5_put_record(file, "particles", &gn_particle_record, &w->dem.particles, error));
    GN_TRY(gn_h5_put_record(file, "bonds", &gn_contact_record, &w->dem.bonds, error));
    GN_TRY(gn_h5_put_record(file, "pairs", &gn_contact_record, &w->dem.pairs, error));
    if (w->effects & GN_FX_WALLS)
        GN_TRY(gn_h5_put_record(file, "wall_contacts", &gn_wall_contact_record,
                                &w->boundary.contacts, error));
    GN_TRY(put_pieces(run, file, error));
    GN_TRY(gn_elements_save(w, file, error));
    return put_history(run, file, error);
}

gneiss_status gn_checkpoint_write(const gn_run *const_run, const char *path, gneiss_error *error) {
    gn_run *run = (gn_run *)(uintptr_t)
        const_run; /* list_arrays hands out places to fill; here they are read */
    gn_h5 *file = NULL;
    GN_TRY(gn_h5_create(path, &file, error));
    gn_h5_demand_finite(file, true);
    gneiss_status status = put_all(run, file, error);
    if (status != GNEISS_OK) {
        gn_h5_close(file);
        return status;
    }
    return gn_h5_commit(file, GN_DURABLE, error);
}

gneiss_status gn_checkpoint_save(const gn_run *run, gneiss_error *error) {
    char *path = NULL;
    GN_TRY(gn_checkpoint_path(run->directory, run->world.step, &path, error));
    gneiss_status status = gn_checkpoint_write(run, path, error);
    free(path);
    GN_TRY(status);
    return gn_checkpoint_prune(run->directory, 2, error);
}

/* --- reading --- */

static gneiss_status get_arrays(gn_run *run, const gn_h5 *file, gneiss_error *error) {
    gn_world *w = &run->world;
    GN_TRY(gn_h5_rows(file, "arrays/gauge_id", &w->gauge.count, error));
    if (w->effects & GN_FX_PRESCRIBED)
        GN_TRY(gn_h5_rows(file, "arrays/prescribed_set", &w->dem.prescribed.count, error));
    if (w->scene.body_count) {
        GN_TRY(gn_h5_rows(file, "arrays/body_vertex", &w->boundary.body_vertex_count, error));
        GN_TRY(gn_h5_rows(file, "arrays/body_corner", &w->boundary.body_corner_count, error));
    }
    array arrays[MAX_ARRAYS];
    size_t count = list_arrays(run, arrays);
    for (size_t k = 0; k < count; k++) {
        char path[128];
        snprintf(path, sizeof path, "arrays/%s", arrays[k].name);
        size_t item = gn_type_size(arrays[k].type) * arrays[k].components;
        *arrays[k].data = gn_alloc_array(arrays[k].rows + 1, item);
        if (!*arrays[k].data)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s", arrays[k].name);
        GN_TRY(gn_h5_get(file, path, arrays[k].type, arrays[k].rows, arrays[k].components, 0,
                         *arrays[k].data, error));
    }
    w->boundary.wall_normals = gn_alloc_array(w->scene.wall_count + 1, 4 * sizeof(double));
    if (!w->boundary.wall_normals)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for walls");
    for (size_t k = 0; k < w->scene.wall_count; k++)
        memcpy(w->boundary.wall_normals + 4 * k, w->boundary.walls[k].normal, 3 * sizeof(double));
    return GNEISS_OK;
}

static gneiss_status get_history(gn_run *run, const gn_h5 *file, gneiss_error *error) {
    GN_TRY(gn_history_begin(&run->world, &run->history, error));
    gn_history *h = &run->history;
    size_t rows = 0;
    GN_TRY(gn_h5_rows(file, "history/step", &rows, error));
    double *table = calloc(rows * h->column_count + 1, sizeof *table);
    if (!table) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu history rows", rows);
    gneiss_status status = GNEISS_OK;
    for (size_t c = 0; status == GNEISS_OK && c < h->column_count; c++) {
        char path[160];
        snprintf(path, sizeof path, "history/%s", h->columns[c].name);
        status = gn_h5_get(file, path, GN_F64, rows, 1, h->column_count * sizeof *table, table + c,
                           error);
    }
    for (size_t r = 0; status == GNEISS_OK && r < rows; r++)
        status = gn_history_append(h, table + r * h->column_count, error);
    free(table);
    return status;
}

static gneiss_status check_format(const gn_h5 *file, const char *path, gneiss_error *error) {
    int64_t format = 0;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "format", &format, 1, error));
    if (format == FORMAT) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a checkpoint of format %d, found format %lld", path, FORMAT,
                   (long long)format);
}

/* Facets of each body lie within its vertices, and all of them in what is there. */
static bool good_bodies(const gn_world *w) {
    size_t corners = (size_t)w->scene.dimension, vertices = 0, facets = 0;
    for (size_t k = 0; k < w->scene.body_count; k++) {
        const int64_t *shape = w->boundary.body_shape[k];
        if (shape[0] < 0 || shape[0] > INT32_MAX || shape[1] < 1 || shape[1] > INT32_MAX)
            return false;
        size_t begin = corners * facets, end = begin + corners * (size_t)shape[1];
        vertices += (size_t)shape[0];
        facets += (size_t)shape[1];
        if (end > w->boundary.body_corner_count) return false;
        for (size_t c = begin; c < end; c++)
            if (w->boundary.body_corner[c] < 0 || w->boundary.body_corner[c] >= shape[0])
                return false;
    }
    return vertices == w->boundary.body_vertex_count &&
           corners * facets == w->boundary.body_corner_count;
}

/* Indices that kernels follow without looking must lie in range even if the file was tampered with.
 */
static gneiss_status check_indices(const gn_world *w, const char *path, gneiss_error *error) {
    size_t n = w->dem.particles.soa.count;
    const gn_contacts *lists[] = {&w->dem.bonds, &w->dem.pairs};
    bool good = good_bodies(w);
    for (size_t k = 0; k < 2; k++)
        for (size_t c = 0; c < lists[k]->soa.count; c++) {
            int32_t i = lists[k]->i[c], j = lists[k]->j[c];
            good = good && i >= 0 && i < j && (size_t)j < n;
        }
    for (size_t c = 0; c < w->boundary.contacts.soa.count; c++)
        good = good && w->boundary.contacts.i[c] >= 0 && (size_t)w->boundary.contacts.i[c] < n &&
               w->boundary.contacts.wall[c] >= 0; /* and below: check_facets */
    for (size_t p = 0; p < n; p++) {
        good = good && w->dem.particles.id[p] >= 0 && (size_t)w->dem.particles.id[p] < n &&
               w->dem.particles.material[p] >= 0 &&
               (size_t)w->dem.particles.material[p] < w->scene.material_count;
        if (w->dem.particles.slot)
            good = good && w->dem.particles.slot[p] < (int32_t)w->dem.prescribed.count;
    }
    for (size_t s = 0; s < w->dem.prescribed.count; s++) {
        good = good && w->dem.prescribed.set[s] >= 0 &&
               (size_t)w->dem.prescribed.set[s] < w->scene.set_count;
        for (size_t c = 6 * s; c < 6 * s + 6; c++)
            good = good && w->dem.channel_set[c] >= -1 &&
                   w->dem.channel_set[c] < (int64_t)w->scene.set_count;
    }
    for (size_t k = 0; k < w->gauge.count; k++)
        good = good && w->gauge.id[k] >= 0 && (size_t)w->gauge.id[k] < n;
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: expected particle numbers below %zu, found others", path, n);
}

static gneiss_status check_numbers(const gn_run *run, const char *path, gneiss_error *error) {
    const gn_world *w = &run->world;
    bool good = run->history_interval > 0 && run->snapshot_interval >= 0 && w->step >= 0 &&
                isfinite(w->time) && w->dt > 0.0 && isfinite(w->dt) && isfinite(w->dt_past) &&
                w->dem.verlet.skin > 0.0 && isfinite(w->dem.verlet.skin) &&
                isfinite(w->dem.verlet.drift);
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: expected positive steps and intervals, found others", path);
}

static gneiss_status get_records(gn_world *w, const gn_h5 *file, gneiss_error *error) {
    gn_effects bonds = gn_contact_list_effects(w->effects, true);
    gn_effects pairs = gn_contact_list_effects(w->effects, false);
    GN_TRY(gn_h5_get_record(file, "particles", &gn_particle_record, &w->dem.particles, w->effects,
                            error));
    GN_TRY(gn_h5_get_record(file, "bonds", &gn_contact_record, &w->dem.bonds, bonds, error));
    GN_TRY(gn_h5_get_record(file, "pairs", &gn_contact_record, &w->dem.pairs, pairs, error));
    if (!(w->effects & GN_FX_WALLS)) return GNEISS_OK;
    return gn_h5_get_record(file, "wall_contacts", &gn_wall_contact_record, &w->boundary.contacts,
                            w->effects, error);
}

/* Messages about the text name the checkpoint: its lines are not those of the scene file. */
static gneiss_status get_scene(gn_world *w, const gn_h5 *file, const char *path,
                               const gn_override *overrides, size_t count, gneiss_error *error) {
    char *text = NULL, *source = NULL;
    GN_TRY(gn_h5_get_text(file, "scene", &text, error));
    gneiss_status status = gn_h5_get_attribute_text(file, "/", "scene_file", &source, error);
    if (status == GNEISS_OK)
        status = gn_scene_parse_saved(text, path, overrides, count, &w->given, error);
    if (status == GNEISS_OK) snprintf(w->given.source, sizeof w->given.source, "%s", source);
    free(text);
    free(source);
    return status == GNEISS_OK ? gn_origin_shift(w, error) : status;
}

/* Once all surfaces are there. */
static gneiss_status check_facets(const gn_world *w, const char *path, gneiss_error *error) {
    size_t all = w->scene.wall_count;
    bool good = true;
    for (size_t k = 0; k < w->boundary.surface_count; k++)
        all += w->boundary.surfaces[k].facets.count;
    for (size_t c = 0; c < w->boundary.contacts.soa.count; c++)
        good = good && (size_t)w->boundary.contacts.wall[c] < all;
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: expected walls and facets below %zu, found others", path, all);
}

static gneiss_status load(gn_run *run, const gn_h5 *file, const char *path,
                          const gn_override *overrides, size_t count, gneiss_error *error) {
    gn_world *w = &run->world;
    GN_TRY(check_format(file, path, error));
    GN_TRY(get_scene(w, file, path, overrides, count, error));
    GN_TRY(gn_world_prepare(w, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "seconds", &run->wall_before, 1, error));
    GN_TRY(gn_h5_get_pieces(file, "run", pieces, PIECES, run, error));
    GN_TRY(get_arrays(run, file, error));
    GN_TRY(get_records(w, file, error));
    GN_TRY(gn_elements_load(w, file, path, error));
    GN_TRY(check_indices(w, path, error));
    GN_TRY(check_numbers(run, path, error));
    GN_TRY(get_history(run, file, error));
    GN_TRY(gn_bodies_surfaces(w, error));
    GN_TRY(gn_element_contact_create(w, error));
    GN_TRY(check_facets(w, path, error));
    GN_TRY(gn_world_restore(w, error));
    uint64_t hash = 0;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "state_hash", (int64_t *)&hash, 1, error));
    if (hash != gn_world_hash(w))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: the state does not have the hash it was saved with", path);
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_load(const char *path, const gn_override *overrides,
                                 size_t override_count, gn_run *run, gneiss_error *error) {
    gn_h5 *file = NULL;
    memset(run, 0, sizeof *run);
    GN_TRY(gn_h5_open_whole(path, &file, error));
    gneiss_status status = load(run, file, path, overrides, override_count, error);
    gn_h5_close(file);
    if (status != GNEISS_OK) gn_run_free(run);
    return status;
}
