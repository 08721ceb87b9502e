/* A thin layer over HDF5: files written to a temporary name and renamed, arrays with units,
 * readable errors. Results, snapshots and checkpoints use it. */
#ifndef GN_IO_H5_H
#define GN_IO_H5_H

#include "io/atomic_file.h"
#include "soa/field.h"

typedef struct gn_h5 gn_h5;

/* Creates `path` + ".tmp" next to the target. `path` is not changed before gn_h5_commit; the
 * contents are in memory until then. */
gneiss_status gn_h5_create(const char *path, gn_h5 **out, gneiss_error *error);
/* Makes a small file in memory and discards it, so that the library has allocated what it needs
 * for any file. */
void gn_h5_load(void);
/* Omits the digests, for files that other programs read. */
void gn_h5_omit_digests(gn_h5 *file);
/* Opens a file for reading. Truncated or foreign files give GNEISS_ERROR_INPUT with the path, a
 * file that cannot be opened (missing, no permission) gives GNEISS_ERROR_IO. Only the format of
 * HDF5 1.10, which gn_h5_create writes, is accepted, because its headers have checksums. */
gneiss_status gn_h5_open(const char *path, gn_h5 **out, gneiss_error *error);
/* Does the same as gn_h5_open, but first reads the whole file into memory by plain read calls: an
 * error of the disk is then GNEISS_ERROR_IO, and any later error in the contents means that the
 * file is damaged. */
gneiss_status gn_h5_open_whole(const char *path, gn_h5 **out, gneiss_error *error);
/* Flushes, syncs, renames to the final name, syncs the folder, closes and frees. On failure (disk
 * full) the temporary file is removed, an old file under `path` is unchanged, and the handle is
 * freed. *file is NULL afterwards. */
gneiss_status gn_h5_commit(gn_h5 **handle, gn_durability durability, gneiss_error *error);
/* Closes the file; one that is being created is removed. NULL is allowed. */
void gn_h5_close(gn_h5 *file);
void gn_h5_close_at(gn_h5 **file); /* for GN_FREED_BY */

/* Writes data set `name` ("history/strain"; groups are created as needed) of shape [rows]
 * (components 1) or [rows][components], from memory with `stride` bytes between rows (0: packed).
 * `unit` and `text` become attributes, NULL: none. Data sets of more than a few hundred bytes are
 * chunked with a Fletcher32 checksum, so that damage is detected. */
gneiss_status gn_h5_put(gn_h5 *file, const char *name, gn_type type, size_t rows, size_t components,
                        size_t stride, const void *data, const char *unit, const char *text,
                        gneiss_error *error);
gneiss_status gn_h5_put_text(gn_h5 *file, const char *name, const char *text, gneiss_error *error);
/* Makes gn_h5_put (GNEISS_ERROR_UNSTABLE) and gn_h5_get (GNEISS_ERROR_INPUT) refuse real numbers
 * that are not finite, or accept them again, which is the default. Returns the previous setting. */
bool gn_h5_demand_finite(gn_h5 *file, bool demanded);
/* Writes attributes of the group or data set `object` ("/" is the root; groups are created as
 * needed). */
gneiss_status gn_h5_attribute_text(gn_h5 *file, const char *object, const char *name,
                                   const char *text, gneiss_error *error);
gneiss_status gn_h5_attribute_f64(gn_h5 *file, const char *object, const char *name,
                                  const double *values, size_t count, gneiss_error *error);
gneiss_status gn_h5_attribute_i64(gn_h5 *file, const char *object, const char *name,
                                  const int64_t *values, size_t count, gneiss_error *error);

/* An attribute in a list, with one of the three kinds of values. */
typedef struct gn_h5_attribute {
    const char *name, *text;
    const double *number;
    const int64_t *whole;
    size_t count; /* length of `number` or `whole`; 0: a single value */
} gn_h5_attribute;
gneiss_status gn_h5_attributes(gn_h5 *file, const char *object, const gn_h5_attribute *list,
                               size_t count, gneiss_error *error);

/* Checks by digests that the file has exactly the objects and attributes that were written; values
 * are checked when they are read. A file of an earlier version has no digests; it is refused if
 * they are `demanded`, and otherwise accepted. */
gneiss_status gn_h5_check_names(gn_h5 *file, bool demanded, gneiss_error *error);
bool gn_h5_has_digests(const gn_h5 *file);
/* Checks the values of all data sets as well. */
gneiss_status gn_h5_check_values(const gn_h5 *file, gneiss_error *error);

/* Functions for reading compare shapes with the expected ones; a mismatch is GNEISS_ERROR_INPUT. */
/* Tells whether the file itself has the object; links to other files do not count. */
bool gn_h5_has(const gn_h5 *file, const char *name);
gneiss_status gn_h5_rows(const gn_h5 *file, const char *name, size_t *rows, gneiss_error *error);
/* Fills `data` (stride as in gn_h5_put); rows, components and type must match. */
gneiss_status gn_h5_get(const gn_h5 *file, const char *name, gn_type type, size_t rows,
                        size_t components, size_t stride, void *data, gneiss_error *error);
/* Reads a text; *text is malloc'ed. */
gneiss_status gn_h5_get_text(const gn_h5 *file, const char *name, char **text, gneiss_error *error);

/* Read attributes; their number and type must match. *text is malloc'ed. */
gneiss_status gn_h5_get_attribute_text(const gn_h5 *file, const char *object, const char *name,
                                       char **text, gneiss_error *error);
/* Reads a text attribute of a file that is not open; *text is NULL on failure. */
gneiss_status gn_h5_peek_text(const char *path, const char *object, const char *name, char **text,
                              gneiss_error *error);
gneiss_status gn_h5_get_attribute_f64(const gn_h5 *file, const char *object, const char *name,
                                      double *values, size_t count, gneiss_error *error);
gneiss_status gn_h5_get_attribute_i64(const gn_h5 *file, const char *object, const char *name,
                                      int64_t *values, size_t count, gneiss_error *error);

/* Writes all active STATE and SAVED fields of a record under group `name` with attribute `count`;
 * COLUMNS fields are stored as [components][count]. */
gneiss_status gn_h5_put_record(gn_h5 *file, const char *name, const gn_record *record,
                               const void *soa, gneiss_error *error);
/* Creates the record (gn_soa_create with `effects`) and fills it. GNEISS_ERROR_INPUT if the effects
 * in the file differ, or a field is missing or has another shape; there is then nothing to destroy.
 * The padding after `count` is zero; the caller calls gn_particles_set_null and gn_contacts_pad. */
gneiss_status gn_h5_get_record(const gn_h5 *file, const char *name, const gn_record *record,
                               void *soa, gn_effects effects, gneiss_error *error);

#endif
