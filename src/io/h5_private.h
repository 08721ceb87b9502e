/* Declarations shared by the parts of the HDF5 layer. */
#ifndef GN_IO_H5_PRIVATE_H
#define GN_IO_H5_PRIVATE_H

#include "io/atomic_file.h"
#include "io/h5.h"

#include <hdf5.h>

/* The bytes of a file that is being created. HDF5 enlarges them through callbacks and does not free
 * them when it closes the file. */
typedef struct gn_h5_image {
    void *data;
    size_t size, capacity;
    bool exhausted; /* memory ran out */
} gn_h5_image;

struct gn_h5 {
    hid_t id;
    char *path;
    bool writing;
    bool finite; /* refuses real numbers that are not finite, in writing and reading */
    bool failed; /* a write has failed, so that the file must not be committed */
    /* the file has digests or will get them; data are checked against them when they are read */
    bool digested;
    gn_atomic_file target;
    gn_h5_image image;
};

typedef struct gn_h5_shape {
    int rank; /* 1 or 2 */
    hsize_t size[2];
} gn_h5_shape;

/* Return how a type is stored (little-endian on every machine), and its type in memory. */
hid_t gn_h5_file_type(gn_type type);
hid_t gn_h5_memory_type(gn_type type);
/* Returns [rows] for one component, else [rows][components]. */
gn_h5_shape gn_h5_table(size_t rows, size_t components);
/* Computes the bytes of a row and of all rows; returns false if they exceed a size_t. */
bool gn_h5_shape_bytes(gn_type type, gn_h5_shape shape, size_t *row, size_t *all);
/* Copies `rows` rows of `row` bytes between two strides. */
void gn_h5_move_rows(void *to, size_t to_stride, const void *from, size_t from_stride, size_t row,
                     size_t rows);

/* Returns a property list of a file, group or data set that stores no times. By default HDF5 stores
 * the second in which each object was made, so that equal data would give unequal files. */
hid_t gn_h5_untimed(hid_t class);

/* Suppresses HDF5's error output, a setting per thread; every function of this layer calls it. */
void gn_h5_quiet(void);

/* Calls gn_fail with the path before the text, and the innermost error of HDF5 after it. */
gneiss_status gn_h5_fail(const gn_h5 *file, gneiss_error *error, gneiss_status status,
                         const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Do the same as gn_h5_put and gn_h5_get, for any shape. */
gneiss_status gn_h5_put_shape(gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                              size_t stride, const void *data, const char *unit, const char *text,
                              gneiss_error *error);
gneiss_status gn_h5_get_shape(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                              size_t stride, void *data, gneiss_error *error);

/* Reads without regard to gn_h5_demand_finite. */
gneiss_status gn_h5_get_any(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                            size_t stride, void *data, gneiss_error *error);
gneiss_status gn_h5_check_finite(const gn_h5 *file, const char *name, gn_type type,
                                 gn_h5_shape shape, size_t bytes, const void *data,
                                 gneiss_error *error);

/* Checks that the data set exists, has this type and shape, and that all its bytes are in the
 * file. */
gneiss_status gn_h5_check(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                          gneiss_error *error);

/* Write the digest of a data set that was just written, and check that of one that was just read.
 */
gneiss_status gn_h5_put_digest(gn_h5 *file, const char *name, hid_t set, const void *bytes,
                               size_t size, gneiss_error *error);
gneiss_status gn_h5_check_digest(const gn_h5 *file, const char *name, hid_t set, const void *bytes,
                                 size_t size, gneiss_error *error);
gneiss_status gn_h5_check_attributes(const gn_h5 *file, const char *object, gneiss_error *error);
/* Writes the digests of attributes and names, after everything else is written. */
gneiss_status gn_h5_seal(gn_h5 *file, gneiss_error *error);
bool gn_h5_is_sealed(hid_t file);

#endif
