/* A thin layer over HDF5: files written to a temporary name and renamed, arrays with units,
 * readable errors. Results, snapshots and checkpoints are all written through it. */
#ifndef GN_IO_H5_H
#define GN_IO_H5_H

#include "io/atomic_file.h"
#include "soa/field.h"

typedef struct gn_h5 gn_h5;

/* Creates `path` + ".tmp" next to the target. Nothing is seen under `path` before gn_h5_commit. The
 * contents are held in memory until then. */
gneiss_status gn_h5_create(const char *path, gn_h5 **out, gneiss_error *error);
/* Makes a small file in memory and drops it: the library then has in use what it has for any. */
void gn_h5_load(void);
/* Leaves out the digests of the file (h5_digest.c): of one that programs of others read. */
void gn_h5_omit_digests(gn_h5 *file);
/* Opens for reading; truncated or foreign files give GNEISS_ERROR_INPUT with the path, a file that
 * cannot be opened (not there, no permission) GNEISS_ERROR_IO. Only the format of HDF5 1.10, which
 * gn_h5_create writes, is taken: its headers have checksums. */
gneiss_status gn_h5_open(const char *path, gn_h5 **out, gneiss_error *error);
/* The same, with the whole file read into memory first by plain read calls: an error of the disk is
 * GNEISS_ERROR_IO, and whatever is wrong with the contents afterwards is damage of the file. */
gneiss_status gn_h5_open_whole(const char *path, gn_h5 **out, gneiss_error *error);
/* Flushes, fsyncs, renames to the final name, fsyncs the folder, closes and frees. On failure (disk
 * full) the temporary file is removed, the old file under `path` is untouched, and the handle is
 * freed. */
gneiss_status gn_h5_commit(gn_h5 *file, gn_durability durability, gneiss_error *error);
/* Closes; a file being created is removed. NULL is allowed. */
void gn_h5_close(gn_h5 *file);

/* Data set `name` ("history/strain"; groups are made as needed) of shape [rows] (components 1) or
 * [rows][components], from memory with `stride` bytes between rows (0: packed). `unit` and `text`
 * become attributes, NULL: none. Data sets of more than a few hundred bytes are chunked with a
 * Fletcher32 checksum, so that a damaged file is noticed. */
gneiss_status gn_h5_put(gn_h5 *file, const char *name, gn_type type, size_t rows, size_t components,
                        size_t stride, const void *data, const char *unit, const char *text,
                        gneiss_error *error);
gneiss_status gn_h5_put_text(gn_h5 *file, const char *name, const char *text, gneiss_error *error);
/* From now on gn_h5_put (GNEISS_ERROR_UNSTABLE) and gn_h5_get (GNEISS_ERROR_INPUT) refuse real
 * numbers that are not finite, or take any again, as at the beginning. Returns what held before. */
bool gn_h5_demand_finite(gn_h5 *file, bool demanded);
/* Attributes of the group or data set `object` ("/" is the root; groups are made as needed). */
gneiss_status gn_h5_attribute_text(gn_h5 *file, const char *object, const char *name,
                                   const char *text, gneiss_error *error);
gneiss_status gn_h5_attribute_f64(gn_h5 *file, const char *object, const char *name,
                                  const double *values, size_t count, gneiss_error *error);
gneiss_status gn_h5_attribute_i64(gn_h5 *file, const char *object, const char *name,
                                  const int64_t *values, size_t count, gneiss_error *error);

/* Several at once, each with one of the three. */
typedef struct gn_h5_attribute {
    const char *name, *text;
    const double *number;
    const int64_t *whole;
    size_t count; /* of numbers; 0: one */
} gn_h5_attribute;
gneiss_status gn_h5_attributes(gn_h5 *file, const char *object, const gn_h5_attribute *list,
                               size_t count, gneiss_error *error);

/* That the file has the objects and attributes that were written, no more and no less, by their
 * digests; values are held against theirs when they are read. A file of an earlier version has no
 * digests: refused if they are `demanded`, otherwise taken as it is. */
gneiss_status gn_h5_check_names(gn_h5 *file, bool demanded, gneiss_error *error);
bool gn_h5_has_digests(const gn_h5 *file);
/* The values of all data sets as well. */
gneiss_status gn_h5_check_values(const gn_h5 *file, gneiss_error *error);

/* Reading. Shapes are checked against what is expected and mismatches are GNEISS_ERROR_INPUT. */
/* Tells whether the file itself has it: a link to elsewhere counts as nothing. */
bool gn_h5_has(const gn_h5 *file, const char *name);
gneiss_status gn_h5_rows(const gn_h5 *file, const char *name, size_t *rows, gneiss_error *error);
/* Fills `data` (stride as in gn_h5_put); rows, components and type must match. */
gneiss_status gn_h5_get(const gn_h5 *file, const char *name, gn_type type, size_t rows,
                        size_t components, size_t stride, void *data, gneiss_error *error);
/* *text is malloc'ed. */
gneiss_status gn_h5_get_text(const gn_h5 *file, const char *name, char **text, gneiss_error *error);

/* Attributes; their number and type must match. *text is malloc'ed. */
gneiss_status gn_h5_get_attribute_text(const gn_h5 *file, const char *object, const char *name,
                                       char **text, gneiss_error *error);
/* The same of a file that is not open; *text is NULL on failure. */
gneiss_status gn_h5_peek_text(const char *path, const char *object, const char *name, char **text,
                              gneiss_error *error);
gneiss_status gn_h5_get_attribute_f64(const gn_h5 *file, const char *object, const char *name,
                                      double *values, size_t count, gneiss_error *error);
gneiss_status gn_h5_get_attribute_i64(const gn_h5 *file, const char *object, const char *name,
                                      int64_t *values, size_t count, gneiss_error *error);

/* All active STATE and SAVED fields of a record under group `name` with attribute `count`; COLUMNS
 * fields are stored as [components][count]. */
gneiss_status gn_h5_put_record(gn_h5 *file, const char *name, const gn_record *record,
                               const void *soa, gneiss_error *error);
/* Creates the record (gn_soa_create with `effects`) and fills it. GNEISS_ERROR_INPUT when the
 * effects in the file differ, or a field is missing or has another shape; then there is nothing to
 * destroy. The padding behind `count` is zero: gn_particles_set_null and gn_contacts_pad are the
 * caller's. */
gneiss_status gn_h5_get_record(const gn_h5 *file, const char *name, const gn_record *record,
                               void *soa, gn_effects effects, gneiss_error *error);

#endif
