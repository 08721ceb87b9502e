/* VTKHDF 1.0, "UnstructuredGrid" (VTK file formats, https://docs.vtk.org). */
#include "io/snapshot.h"

#include "base/new.h"
#include "io/atomic_file.h"
#include "io/h5.h"
#include "io/io.h"
#include "io/listing.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { VTK_VERTEX = 1, VTK_LINE = 3, VTK_TRIANGLE = 5, VTK_TETRA = 10 };

/* A grid of lines may be empty (all bonds broken); its line arrays identify it. */
static bool is_lines(const gn_snapshot *snapshot) {
    return snapshot->line_count > 0 || snapshot->line_array_count > 0;
}

/* Returns the points of a cell. */
static size_t cell_points(const gn_snapshot *snapshot) {
    if (!is_lines(snapshot)) return 1;
    return snapshot->line_points ? snapshot->line_points : 2;
}

static gneiss_status check_lines(const gn_snapshot *snapshot, gneiss_error *error) {
    size_t points = cell_points(snapshot);
    if (points > 4)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "expected cells of 2 to 4 points, found %zu",
                       points);
    for (size_t k = 0; k < points * snapshot->line_count; k++)
        if (snapshot->lines[k] < 0 || (size_t)snapshot->lines[k] >= snapshot->point_count)
            return gn_fail(error, GNEISS_ERROR_INTERNAL,
                           "line %zu: expected a point below %zu, found %d", k / points,
                           snapshot->point_count, (int)snapshot->lines[k]);
    return GNEISS_OK;
}

static gneiss_status put_number(gn_h5 *file, const char *name, size_t value, gneiss_error *error) {
    int64_t number = (int64_t)value;
    return gn_h5_put(file, name, GN_I64, 1, 1, 0, &number, NULL, NULL, error);
}

/* Writes connectivity, offsets and types in sequence; `work` has room for each. */
static gneiss_status put_topology(gn_h5 *file, const gn_snapshot *snapshot, size_t cells,
                                  int64_t *work, gneiss_error *error) {
    static const int types[] = {0, VTK_VERTEX, VTK_LINE, VTK_TRIANGLE, VTK_TETRA};
    size_t per_cell = cell_points(snapshot), ids = per_cell * cells;
    for (size_t k = 0; k < ids; k++) work[k] = is_lines(snapshot) ? snapshot->lines[k] : (int64_t)k;
    GN_TRY(gn_h5_put(file, "VTKHDF/Connectivity", GN_I64, ids, 1, 0, work, NULL, NULL, error));
    for (size_t k = 0; k <= cells; k++) work[k] = (int64_t)(per_cell * k);
    GN_TRY(gn_h5_put(file, "VTKHDF/Offsets", GN_I64, cells + 1, 1, 0, work, NULL, NULL, error));
    memset(work, types[per_cell], cells);
    GN_TRY(gn_h5_put(file, "VTKHDF/Types", GN_U8, cells, 1, 0, work, NULL, NULL, error));
    GN_TRY(put_number(file, "VTKHDF/NumberOfPoints", snapshot->point_count, error));
    GN_TRY(put_number(file, "VTKHDF/NumberOfCells", cells, error));
    return put_number(file, "VTKHDF/NumberOfConnectivityIds", ids, error);
}

static gneiss_status put_cells(gn_h5 *file, const gn_snapshot *snapshot, gneiss_error *error) {
    size_t cells = is_lines(snapshot) ? snapshot->line_count : snapshot->point_count;
    GN_FREED int64_t *work = NULL;
    GN_TRY(gn_new(&work, cell_points(snapshot) * cells + 1, "corners of cells", error));
    return put_topology(file, snapshot, cells, work, error);
}

static gneiss_status put_arrays(gn_h5 *file, const char *group, const gn_snapshot_array *arrays,
                                size_t array_count, size_t rows, gneiss_error *error) {
    for (size_t a = 0; a < array_count; a++) {
        char name[256];
        int length = snprintf(name, sizeof name, "%s/%s", group, arrays[a].name);
        if (length >= (int)sizeof name || strchr(arrays[a].name, '/') || !arrays[a].name[0])
            return gn_fail(error, GNEISS_ERROR_INTERNAL,
                           "expected the name of an array, found '%s'", arrays[a].name);
        const bool demanded = gn_h5_demand_finite(file, false);
        gn_h5_demand_finite(file, demanded && !arrays[a].may_be_nan);
        GN_TRY(gn_h5_put(file, name, GN_F64, rows, arrays[a].components, 0, arrays[a].data,
                         arrays[a].unit, NULL, error));
        gn_h5_demand_finite(file, demanded);
    }
    return GNEISS_OK;
}

static const char on_points[] = "arrays on points";

static gneiss_status put_grid(gn_h5 *file, const gn_snapshot *snapshot, gneiss_error *error) {
    const int64_t version[2] = {1, 0};
    GN_TRY(gn_h5_attribute_i64(file, "VTKHDF", "Version", version, 2, error));
    GN_TRY(gn_h5_attribute_text(file, "VTKHDF", "Type", "UnstructuredGrid", error));
    GN_TRY(put_cells(file, snapshot, error));
    GN_TRY(gn_h5_put(file, "VTKHDF/Points", GN_F64, snapshot->point_count, 3, 0, snapshot->points,
                     "m", NULL, error));
    /* An attribute creates the group, which the reader requires even if it is empty. */
    GN_TRY(gn_h5_attribute_text(file, "VTKHDF/PointData", "text", on_points, error));
    GN_TRY(gn_h5_attribute_text(file, "VTKHDF/CellData", "text", "arrays on cells", error));
    GN_TRY(put_arrays(file, "VTKHDF/PointData", snapshot->point_arrays, snapshot->point_array_count,
                      snapshot->point_count, error));
    GN_TRY(put_arrays(file, "VTKHDF/CellData", snapshot->line_arrays, snapshot->line_array_count,
                      snapshot->line_count, error));
    GN_TRY(gn_h5_put(file, "VTKHDF/FieldData/TimeValue", GN_F64, 1, 1, 0, &snapshot->time, "s",
                     NULL, error));
    return gn_h5_put(file, "VTKHDF/FieldData/Step", GN_I64, 1, 1, 0, &snapshot->step, NULL, NULL,
                     error);
}

gneiss_status gn_snapshot_write(const char *directory, const char *name,
                                const gn_snapshot *snapshot, gneiss_error *error) {
    GN_FREED_BY(gn_h5_close_at) gn_h5 *file = NULL;
    if (snapshot->step < 0 || strchr(name, '/') || !name[0])
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "snapshot '%s' of step %" PRId64, name,
                       snapshot->step);
    GN_TRY(check_lines(snapshot, error));
    GN_FREED char *path = gn_step_path(directory, name, snapshot->step, ".hdf");
    if (!path) return gn_no_memory(error, "a name");
    GN_TRY(gn_h5_create(path, &file, error));
    gn_h5_omit_digests(file);
    gn_h5_demand_finite(file, !snapshot->bad);
    GN_TRY(put_grid(file, snapshot, error));
    return gn_h5_commit(&file, GN_SYNCED, error);
}

gneiss_status gn_snapshot_is_own(const char *path, bool *own, gneiss_error *error) {
    char *text;
    gneiss_error reading = {0};
    gneiss_status status = gn_h5_peek_text(path, "VTKHDF/PointData", "text", &text, &reading);
    *own = status == GNEISS_OK && strcmp(text, on_points) == 0;
    free(text);
    return status == GNEISS_ERROR_IO || status == GNEISS_ERROR_MEMORY
               ? gn_fail(error, status, "%s", reading.message)
               : GNEISS_OK;
}

/* --- the series --- */

/* Returns the place of a step, or the place at which to insert it. */
static size_t place_of(const gn_snapshot_times *times, int64_t step) {
    size_t low = 0, high = times->count;
    while (low < high) {
        size_t mid = (low + high) / 2;
        if (times->step[mid] < step)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

gneiss_status gn_snapshot_times_add(gn_snapshot_times *times, int64_t step, double time,
                                    gneiss_error *error) {
    size_t at = place_of(times, step);
    if (at < times->count && times->step[at] == step) {
        times->time[at] = time;
        return GNEISS_OK;
    }
    if (times->count == times->capacity) {
        size_t capacity = times->capacity ? 2 * times->capacity : 64;
        int64_t *steps = realloc(times->step, capacity * sizeof *steps);
        if (steps) times->step = steps;
        double *values = realloc(times->time, capacity * sizeof *values);
        if (values) times->time = values;
        if (!steps || !values)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the times of snapshots");
        times->capacity = capacity;
    }
    memmove(times->step + at + 1, times->step + at, (times->count - at) * sizeof *times->step);
    memmove(times->time + at + 1, times->time + at, (times->count - at) * sizeof *times->time);
    times->step[at] = step;
    times->time[at] = time;
    times->count++;
    return GNEISS_OK;
}

void gn_snapshot_times_free(gn_snapshot_times *times) {
    free(times->step);
    free(times->time);
    *times = (gn_snapshot_times){0};
}

static gneiss_status read_time(const char *path, double *time, gneiss_error *error) {
    gn_h5 *file;
    GN_TRY(gn_h5_open(path, &file, error));
    gneiss_status status =
        gn_h5_get(file, "VTKHDF/FieldData/TimeValue", GN_F64, 1, 1, 0, time, error);
    gn_h5_close(file);
    return status;
}

/* Adds an entry to the series, or removes a file that is later than the series. */
static gneiss_status add_to_series(gn_json *json, const char *path, int64_t step, bool later,
                                   gn_snapshot_times *times, gneiss_error *error) {
    if (later) {
        if (unlink(path) == 0 || errno == ENOENT) return GNEISS_OK;
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be removed: %s", path, strerror(errno));
    }
    size_t at = place_of(times, step);
    if (at == times->count || times->step[at] != step) {
        double time;
        GN_TRY(read_time(path, &time, error));
        GN_TRY(gn_snapshot_times_add(times, step, time, error));
    }
    gn_json_object(json, NULL);
    gn_json_text(json, "name", strrchr(path, '/') + 1);
    gn_json_number(json, "time", times->time[at]);
    gn_json_end(json);
    return GNEISS_OK;
}

static gneiss_status build_series(gn_json *json, const char *directory, const char *name,
                                  int64_t last_step, gn_snapshot_times *times,
                                  gneiss_error *error) {
    int64_t *steps;
    size_t count;
    GN_TRY(gn_step_list(directory, name, ".hdf", &steps, &count, error));
    gneiss_status status = GNEISS_OK;
    gn_json_text(json, "file-series-version", "1.0");
    gn_json_array(json, "files");
    for (size_t k = 0; k < count && status == GNEISS_OK; k++) {
        char *path = gn_step_path(directory, name, steps[k], ".hdf");
        status = path ? add_to_series(json, path, steps[k], steps[k] > last_step, times, error)
                      : gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for a name", directory);
        free(path);
    }
    free(steps);
    return status;
}

gneiss_status gn_snapshot_series(const char *directory, const char *name, int64_t last_step,
                                 gn_snapshot_times *times, gneiss_error *error) {
    gn_json *json = gn_json_begin();
    gneiss_status status = build_series(json, directory, name, last_step, times, error);
    char *text = gn_json_finish(json, true);
    char *path = gn_text_format("%s/%s.hdf.series", directory, name);
    if (status == GNEISS_OK && (!text || !path))
        status =
            gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for the series %s", directory, name);
    if (status == GNEISS_OK) status = gn_write_text_file(path, text, GN_RENAMED, error);
    free(path);
    free(text);
    return status;
}
