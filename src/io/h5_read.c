/* Reading of data sets and attributes with full validation. */
#include "base/memory.h"
#include "io/h5_private.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const char *type_name(hid_t type, char out[32]) {
    size_t bits = 8 * H5Tget_size(type);
    switch (H5Tget_class(type)) {
    case H5T_FLOAT:
        snprintf(out, 32, "float%zu", bits);
        break;
    case H5T_INTEGER:
        snprintf(out, 32, "%sint%zu", H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "", bits);
        break;
    case H5T_STRING:
        snprintf(out, 32, "text");
        break;
    default:
        snprintf(out, 32, "another type");
    }
    return out;
}

static const char *shape_text(int rank, const hsize_t *size, char out[96]) {
    size_t used = 0;
    strcpy(out, rank == 0 ? "a single value" : "");
    for (int k = 0; k < rank && k < 4; k++)
        used += (size_t)snprintf(out + used, 96 - used, "[%llu]", (unsigned long long)size[k]);
    return out;
}

/* Checks that all values are in the file itself, and that HDF5 decodes them by its own code alone.
 */
static gneiss_status check_storage(const gn_h5 *file, const char *name, hid_t set,
                                   gneiss_error *error) {
    hid_t list = H5Dget_create_plist(set);
    bool own = list >= 0 && H5Pget_layout(list) != H5D_VIRTUAL && H5Pget_external_count(list) == 0;
    int filters = own ? H5Pget_nfilters(list) : 0;
    for (int k = 0; k < filters && own; k++) {
        size_t values = 0;
        unsigned flags, config;
        own = H5Pget_filter2(list, (unsigned)k, &flags, &values, NULL, 0, NULL, &config) <
              H5Z_FILTER_RESERVED;
    }
    if (list >= 0) H5Pclose(list);
    if (own) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: data set %s: expected values in the file itself, found them stored in "
                   "another file or by a filter of another program",
                   file->path, name);
}

static gneiss_status open_set(const gn_h5 *file, const char *name, hid_t *set,
                              gneiss_error *error) {
    *set = -1;
    if (file->writing)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "%s: %s not read: the file is being written",
                       file->path, name);
    if (!gn_h5_has(file, name))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: data set %s is missing", file->path, name);
    *set = H5Dopen2(file->id, name, H5P_DEFAULT);
    if (*set < 0)
        return gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "%s is not a readable data set", name);
    gneiss_status status = check_storage(file, name, *set, error);
    if (status != GNEISS_OK) H5Dclose(*set);
    return status;
}

static gneiss_status check_type(const gn_h5 *file, const char *name, hid_t set, gn_type expected,
                                gneiss_error *error) {
    char found[32], wanted[32];
    hid_t type = H5Dget_type(set);
    gneiss_status status = GNEISS_OK;
    if (type < 0 || H5Tequal(type, gn_h5_file_type(expected)) <= 0)
        status = gn_fail(error, GNEISS_ERROR_INPUT, "%s: data set %s: expected %s, found %s",
                         file->path, name, type_name(gn_h5_file_type(expected), wanted),
                         type < 0 ? "nothing readable" : type_name(type, found));
    if (type >= 0) H5Tclose(type);
    return status;
}

/* Reads rank and sizes of a data set; rank -1: they cannot be read. */
static int read_shape(hid_t set, hsize_t size[H5S_MAX_RANK]) {
    hid_t space = H5Dget_space(set);
    if (space < 0) return -1;
    int rank =
        H5Sget_simple_extent_type(space) == H5S_NULL ? -1 : H5Sget_simple_extent_ndims(space);
    if (rank > 0 && H5Sget_simple_extent_dims(space, size, NULL) < 0) rank = -1;
    H5Sclose(space);
    return rank;
}

static gneiss_status check_shape(const gn_h5 *file, const char *name, hid_t set, gn_type type,
                                 gn_h5_shape shape, gneiss_error *error) {
    hsize_t size[H5S_MAX_RANK] = {0};
    char wanted[96], found[96];
    int rank = read_shape(set, size);
    bool same =
        rank == shape.rank && size[0] == shape.size[0] && (rank == 1 || size[1] == shape.size[1]);
    if (!same)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: data set %s: expected shape %s, found %s",
                       file->path, name, shape_text(shape.rank, shape.size, wanted),
                       rank < 0 ? "nothing readable" : shape_text(rank, size, found));
    /* A chunk that is missing in the file would read as zeros, and a header may declare more data
     * than fit in memory. */
    size_t row, bytes;
    if (gn_h5_shape_bytes(type, shape, &row, &bytes) && H5Dget_storage_size(set) >= bytes)
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: data set %s: part of it is not in the file",
                   file->path, name);
}

static gneiss_status open_checked(const gn_h5 *file, const char *name, gn_type type,
                                  gn_h5_shape shape, hid_t *set, gneiss_error *error) {
    GN_TRY(open_set(file, name, set, error));
    gneiss_status status = check_type(file, name, *set, type, error);
    if (status == GNEISS_OK) status = check_shape(file, name, *set, type, shape, error);
    if (status != GNEISS_OK) H5Dclose(*set);
    return status;
}

gneiss_status gn_h5_check(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                          gneiss_error *error) {
    gn_h5_quiet();
    hid_t set;
    GN_TRY(open_checked(file, name, type, shape, &set, error));
    H5Dclose(set);
    return GNEISS_OK;
}

static gneiss_status read_set(const gn_h5 *file, const char *name, hid_t set, hid_t type,
                              void *data, gneiss_error *error) {
    if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0) return GNEISS_OK;
    return gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "data set %s is damaged", name);
}

static gneiss_status get_values(const gn_h5 *file, const char *name, gn_type type,
                                gn_h5_shape shape, size_t stride, void *data, bool any,
                                gneiss_error *error) {
    gn_h5_quiet();
    hid_t set;
    GN_TRY(open_checked(file, name, type, shape, &set, error));
    size_t row, bytes, rows = shape.size[0];
    (void)gn_h5_shape_bytes(type, shape, &row, &bytes); /* open_checked has verified the size */
    bool packed = stride == 0 || stride == row || rows <= 1;
    void *buffer = packed ? data : gn_alloc(bytes);
    gneiss_status status = GNEISS_OK;
    if (!buffer && bytes > 0)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read data set %s",
                         file->path, name);
    else if (bytes > 0)
        status = read_set(file, name, set, gn_h5_memory_type(type), buffer, error);
    if (status == GNEISS_OK) status = gn_h5_check_digest(file, name, set, buffer, bytes, error);
    if (status == GNEISS_OK && !any)
        status = gn_h5_check_finite(file, name, type, shape, bytes, buffer, error);
    if (!packed && status == GNEISS_OK) gn_h5_move_rows(data, stride, buffer, row, row, rows);
    if (!packed) gn_free(buffer);
    H5Dclose(set);
    return status;
}

gneiss_status gn_h5_get_shape(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                              size_t stride, void *data, gneiss_error *error) {
    return get_values(file, name, type, shape, stride, data, false, error);
}

gneiss_status gn_h5_get_any(const gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                            size_t stride, void *data, gneiss_error *error) {
    return get_values(file, name, type, shape, stride, data, true, error);
}

gneiss_status gn_h5_get(const gn_h5 *file, const char *name, gn_type type, size_t rows,
                        size_t components, size_t stride, void *data, gneiss_error *error) {
    return gn_h5_get_shape(file, name, type, gn_h5_table(rows, components), stride, data, error);
}

/* Reads a data set of any type and shape, as it is stored, to check its digest. */
static gneiss_status check_values(const gn_h5 *file, const char *name, gneiss_error *error) {
    hid_t set;
    GN_TRY(open_set(file, name, &set, error));
    hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    hssize_t points = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    size_t bytes = 0, item = type < 0 || H5Tis_variable_str(type) != 0 ? 0 : H5Tget_size(type);
    bool there = points >= 0 && item && !__builtin_mul_overflow((size_t)points, item, &bytes) &&
                 H5Dget_storage_size(set) >= bytes;
    void *buffer = there ? gn_alloc(bytes + 1) : NULL;
    gneiss_status status = GNEISS_OK;
    if (!there)
        status = gn_fail(error, GNEISS_ERROR_INPUT,
                         "%s: data set %s: part of it is not in the file", file->path, name);
    else if (!buffer)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read data set %s",
                         file->path, name);
    else if (bytes)
        status = read_set(file, name, set, type, buffer, error);
    if (status == GNEISS_OK) status = gn_h5_check_digest(file, name, set, buffer, bytes, error);
    gn_free(buffer);
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    H5Dclose(set);
    return status;
}

typedef struct looked {
    const gn_h5 *file;
    gneiss_status status;
    gneiss_error *error;
} looked;

static herr_t check_object(hid_t root, const char *name, const H5O_info_t *info, void *data) {
    (void)root;
    looked *l = data;
    if (info->type == H5O_TYPE_DATASET) l->status = check_values(l->file, name, l->error);
    return l->status == GNEISS_OK ? 0 : -1;
}

gneiss_status gn_h5_check_values(const gn_h5 *file, gneiss_error *error) {
    gn_h5_quiet();
    looked l = {.file = file, .error = error};
    herr_t ended =
        H5Ovisit2(file->id, H5_INDEX_NAME, H5_ITER_NATIVE, check_object, &l, H5O_INFO_BASIC);
    if (l.status != GNEISS_OK || ended >= 0) return l.status;
    return gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "its objects cannot be listed");
}

gneiss_status gn_h5_rows(const gn_h5 *file, const char *name, size_t *rows, gneiss_error *error) {
    gn_h5_quiet();
    hid_t set;
    GN_TRY(open_set(file, name, &set, error));
    hsize_t size[H5S_MAX_RANK] = {0};
    int rank = read_shape(set, size);
    H5Dclose(set);
    if (rank < 1)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: data set %s: expected rows, found %s",
                       file->path, name, rank == 0 ? "a single value" : "nothing readable");
    *rows = size[0];
    return GNEISS_OK;
}

/* Returns a malloc'ed buffer for a text of this type and a zero byte; NULL with a message. */
static char *text_buffer(const gn_h5 *file, const char *name, hid_t type, hsize_t values,
                         gneiss_error *error) {
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || values != 1) {
        gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s: expected one text of fixed length, found %s",
                file->path, name, H5Tget_class(type) == H5T_STRING ? "another text" : "numbers");
        return NULL;
    }
    char *text = calloc(H5Tget_size(type) + 1, 1);
    if (!text) gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read %s", file->path, name);
    return text;
}

/* Checks the attribute `fnv1a`, which earlier versions wrote for texts that HDF5 stores without a
 * checksum. */
static bool hash_agrees(hid_t set, const char *text) {
    if (H5Aexists(set, "fnv1a") <= 0) return true;
    int64_t stored = 0;
    hid_t attribute = H5Aopen(set, "fnv1a", H5P_DEFAULT);
    bool read = attribute >= 0 && H5Aread(attribute, H5T_NATIVE_INT64, &stored) >= 0;
    if (attribute >= 0) H5Aclose(attribute);
    return read && (uint64_t)stored == gn_hash_bytes(text, strlen(text), GN_HASH_SEED);
}

gneiss_status gn_h5_get_text(const gn_h5 *file, const char *name, char **text,
                             gneiss_error *error) {
    gn_h5_quiet();
    *text = NULL;
    hid_t set;
    GN_TRY(open_set(file, name, &set, error));
    hid_t type = H5Dget_type(set);
    hsize_t size[H5S_MAX_RANK] = {0};
    gneiss_status status = GNEISS_ERROR_INPUT;
    char *buffer = NULL;
    if (type < 0 || (H5Tis_variable_str(type) == 0 && H5Dget_storage_size(set) < H5Tget_size(type)))
        gn_fail(error, status, "%s: text %s: part of it is not in the file", file->path, name);
    else
        buffer = text_buffer(file, name, type, read_shape(set, size) == 0, error);
    if (!buffer && error) status = error->status;
    if (buffer) status = read_set(file, name, set, type, buffer, error);
    if (buffer && status == GNEISS_OK)
        status = gn_h5_check_digest(file, name, set, buffer, H5Tget_size(type), error);
    if (buffer && status == GNEISS_OK && !hash_agrees(set, buffer))
        status = gn_fail(error, GNEISS_ERROR_INPUT, "%s: text %s is damaged", file->path, name);
    if (type >= 0) H5Tclose(type);
    H5Dclose(set);
    if (status == GNEISS_OK)
        *text = buffer;
    else
        free(buffer);
    return status;
}

static gneiss_status open_attribute(const gn_h5 *file, const char *object, const char *name,
                                    hid_t *id, gneiss_error *error) {
    gn_h5_quiet();
    *id = -1;
    if (!gn_h5_has(file, object))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s is missing", file->path, object);
    if (H5Aexists_by_name(file->id, object, name, H5P_DEFAULT) == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: attribute %s of %s is missing", file->path,
                       name, object);
    GN_TRY(gn_h5_check_attributes(file, object, error));
    *id = H5Aopen_by_name(file->id, object, name, H5P_DEFAULT, H5P_DEFAULT);
    if (*id >= 0) return GNEISS_OK;
    return gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "attribute %s of %s cannot be read", name,
                      object);
}

static hsize_t attribute_values(hid_t attribute) {
    hid_t space = H5Aget_space(attribute);
    hssize_t values = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    if (space >= 0) H5Sclose(space);
    return values < 0 ? 0 : (hsize_t)values;
}

static gneiss_status get_attribute(const gn_h5 *file, const char *object, const char *name,
                                   gn_type expected, void *values, size_t count,
                                   gneiss_error *error) {
    hid_t id;
    GN_TRY(open_attribute(file, object, name, &id, error));
    hid_t type = H5Aget_type(id);
    hsize_t found = attribute_values(id);
    char wanted[32], seen[32] = "nothing readable";
    gneiss_status status = GNEISS_OK;
    if (type < 0 || H5Tequal(type, gn_h5_file_type(expected)) <= 0 || found != count)
        status = gn_fail(error, GNEISS_ERROR_INPUT,
                         "%s: attribute %s of %s: expected %zu x %s, found %llu x %s", file->path,
                         name, object, count, type_name(gn_h5_file_type(expected), wanted),
                         (unsigned long long)found, type < 0 ? seen : type_name(type, seen));
    else if (count > 0 && H5Aread(id, gn_h5_memory_type(expected), values) < 0)
        status = gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "attribute %s of %s is damaged", name,
                            object);
    if (type >= 0) H5Tclose(type);
    H5Aclose(id);
    return status;
}

gneiss_status gn_h5_get_attribute_f64(const gn_h5 *file, const char *object, const char *name,
                                      double *values, size_t count, gneiss_error *error) {
    return get_attribute(file, object, name, GN_F64, values, count, error);
}

gneiss_status gn_h5_get_attribute_i64(const gn_h5 *file, const char *object, const char *name,
                                      int64_t *values, size_t count, gneiss_error *error) {
    return get_attribute(file, object, name, GN_I64, values, count, error);
}

gneiss_status gn_h5_get_attribute_text(const gn_h5 *file, const char *object, const char *name,
                                       char **text, gneiss_error *error) {
    *text = NULL;
    hid_t id;
    GN_TRY(open_attribute(file, object, name, &id, error));
    hid_t type = H5Aget_type(id);
    char *buffer = text_buffer(file, name, type, attribute_values(id), error);
    gneiss_status status = buffer ? GNEISS_OK : GNEISS_ERROR_INPUT;
    if (buffer && H5Aread(id, type, buffer) < 0)
        status = gn_h5_fail(file, error, GNEISS_ERROR_INPUT, "attribute %s of %s is damaged", name,
                            object);
    if (type >= 0) H5Tclose(type);
    H5Aclose(id);
    if (status == GNEISS_OK)
        *text = buffer;
    else
        free(buffer);
    return status;
}

gneiss_status gn_h5_peek_text(const char *path, const char *object, const char *name, char **text,
                              gneiss_error *error) {
    gn_h5 *file = NULL;
    *text = NULL;
    gneiss_status status = gn_h5_open(path, &file, error);
    if (status == GNEISS_OK) status = gn_h5_get_attribute_text(file, object, name, text, error);
    gn_h5_close(file);
    return status;
}
