/* Snapshots for ParaView 5.11: one static VTKHDF 1.0 UnstructuredGrid per instant (vertices for
 * particles, lines for bonds, triangles or tetrahedra for finite elements) and a `.hdf.series` JSON
 * with the times. */
#ifndef GN_IO_SNAPSHOT_H
#define GN_IO_SNAPSHOT_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_snapshot_array {
    const char *name, *unit;
    size_t components;  /* 1, 3, 4, 6 or 9 */
    const double *data; /* [count][components] */
    bool may_be_nan;    /* NaN: an item has no value */
} gn_snapshot_array;

typedef struct gn_snapshot {
    bool bad;    /* the run is unstable: only then may numbers be infinite or NaN */
    double time; /* s */
    int64_t step;
    size_t point_count;
    const double *points; /* [point_count][3], m */
    size_t line_count;
    const int32_t *lines; /* [line_count][line_points] point indices */
    size_t line_points;   /* 0 or 2: lines, 3: triangles, 4: tetrahedra */
    size_t point_array_count, line_array_count;
    const gn_snapshot_array *point_arrays; /* [point_count], written as PointData */
    const gn_snapshot_array *line_arrays;  /* [line_count], written as CellData */
} gn_snapshot;

/* Writes DIR/NAME_<step, 10 digits>.hdf atomically. Particles and bonds are separate files so that
 * each is a plain grid: `particles` (vertices) and `bonds` (lines) result from two calls with the
 * other part empty. With lines or line arrays the cells are the lines (possibly none), otherwise
 * every point is a vertex. All points are written in either case. Tensors: 9 components by rows, or
 * 6 as xx yy zz xy yz xz. */
gneiss_status gn_snapshot_write(const char *directory, const char *name,
                                const gn_snapshot *snapshot, gneiss_error *error);

/* Tells whether a file was written by gn_snapshot_write; unreadable files were not. */
gneiss_status gn_snapshot_is_own(const char *path, bool *own, gneiss_error *error);

/* Times of snapshots written or read before, by ascending steps, so that a series does not open
 * every file again. Initially zeroed. */
typedef struct gn_snapshot_times {
    size_t count, capacity;
    int64_t *step;
    double *time; /* s */
} gn_snapshot_times;

gneiss_status gn_snapshot_times_add(gn_snapshot_times *times, int64_t step, double time,
                                    gneiss_error *error);
void gn_snapshot_times_free(gn_snapshot_times *times);

/* Rewrites DIR/NAME.hdf.series from the snapshots on disk up to `last_step`, atomically; snapshots
 * of later steps (left by a killed run that was resumed from before them) are removed. Times that
 * are not in `times` are read from the files and added; an unreadable one is GNEISS_ERROR_INPUT.
 * Temporary files of a killed run are removed. */
gneiss_status gn_snapshot_series(const char *directory, const char *name, int64_t last_step,
                                 gn_snapshot_times *times, gneiss_error *error);

#endif
