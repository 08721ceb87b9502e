/* What the parts of the HDF5 layer share. */
#ifndef GN_IO_H5_PRIVATE_H
#define GN_IO_H5_PRIVATE_H

#include "io/atomic_file.h"
#include "io/h5.h"

#include <hdf5.h>

/* The bytes of a file being created. HDF5 grows them through callbacks and leaves them behind when
 * it closes. */
typedef struct gn_h5_image {
    void *data;
    size_t size, capacity;
    bool exhausted; /* memory ran out */
} gn_h5_image;

struct gn_h5 {
    hid_t id;
    char *path;
    bool writing;
    bool finite;   /* real numbers that are not are refused, written or read */
    bool failed;   /* a write failed: the file must not be committed */
    bool digested; /* has digests, or gets them; what is read is held against them */
    gn_atomic_file target;
    gn_h5_image image;
};

typedef struct gn_h5_shape {
    int rank; /* 1 or 2 */
    hsize_t size[2];
} gn_h5_shape;

/* How a type is stored (little-endian on every machine) and how it lies in memory. */
hid_t gn_h5_file_type(gn_type type);
hid_t gn_h5_memory_type(gn_type type);
/* [rows] for one component, else [rows][components]. */
gn_h5_shape gn_h5_table(size_t rows, size_t components);
/* Bytes of a row and of all; false: more than a size_t. */
bool gn_h5_shape_bytes(gn_type type, gn_h5_shape shape, size_t *row, size_t *all);
/* Copies `rows` rows of `row` bytes between two strides. */
void gn_h5_move_rows(void *to, size_t to_stride, const void *from, size_t from_stride, size_t row,
                     size_t rows);

/* HDF5 prints its errors by default, per thread; called on entry of every function of this layer.
 */
void gn_h5_quiet(void);

/* gn_fail with the path in front and the innermost error of HDF5 behind. */
gneiss_status gn_h5_fail(const gn_h5 *file, gneiss_error *error, gneiss_status status,
                         const char *format, ...) __attribute__((format(printf, 4, 5)));

/* As gn_h5_put and gn_h5_get, for any shape. */
gneiss_status gn_h5_put_shape(gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                              size_t stride, const void *data, const char *unit, const char *text,
                              gneiss_error *error);
gneiss_status gn_h5_get_shape(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                              size_t stride, void *data, gneiss_error *error);

/* As the last, whatever gn_h5_demand_finite asks for. */
gneiss_status gn_h5_get_any(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                            size_t stride, void *data, gneiss_error *error);
gneiss_status gn_h5_check_finite(const gn_h5 *file, const char *name, gn_type type,
                                 gn_h5_shape shape, size_t bytes, const void *data,
                                 gneiss_error *error);

/* That the data set is there, has this type and shape, and that all its bytes are in the file. */
gneiss_status gn_h5_check(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                          gneiss_error *error);

/* Digests (h5_digest.c). Of bytes; of the values of a data set, with its name, type and shape. */
uint64_t gn_h5_digest(const void *bytes, size_t size, uint64_t seed);
uint64_t gn_h5_digest_of_values(const char *name, hid_t set, const void *bytes, size_t size);
/* Writes that of a data set that was just written; holds one that was just read against its own. */
gneiss_status gn_h5_put_digest(gn_h5 *file, const char *name, hid_t set, const void *bytes,
                               size_t size, gneiss_error *error);
gneiss_status gn_h5_check_digest(const gn_h5 *file, const char *name, hid_t set, const void *bytes,
                                 size_t size, gneiss_error *error);
gneiss_status gn_h5_check_attributes(const gn_h5 *file, const char *object, gneiss_error *error);
/* Writes the digests of attributes and names, when all else is written. */
gneiss_status gn_h5_seal(gn_h5 *file, gneiss_error *error);
bool gn_h5_is_sealed(hid_t file);

#endif
