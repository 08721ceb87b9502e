/* Writing of data sets and attributes. */
#include "io/h5_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- types and shapes, in files and in memory ---- */

hid_t gn_h5_file_type(gn_type type) {
    switch (type) {
    case GN_F64:
        return H5T_IEEE_F64LE;
    case GN_I64:
        return H5T_STD_I64LE;
    case GN_I32:
        return H5T_STD_I32LE;
    case GN_U8:
        return H5T_STD_U8LE;
    case GN_F32:
        return H5T_IEEE_F32LE;
    }
    return -1;
}

hid_t gn_h5_memory_type(gn_type type) {
    switch (type) {
    case GN_F64:
        return H5T_NATIVE_DOUBLE;
    case GN_I64:
        return H5T_NATIVE_INT64;
    case GN_I32:
        return H5T_NATIVE_INT32;
    case GN_U8:
        return H5T_NATIVE_UINT8;
    case GN_F32:
        return H5T_NATIVE_FLOAT;
    }
    return -1;
}

gn_h5_shape gn_h5_table(size_t rows, size_t components) {
    return components == 1 ? (gn_h5_shape){1, {rows, 1}} : (gn_h5_shape){2, {rows, components}};
}

bool gn_h5_shape_bytes(gn_type type, gn_h5_shape shape, size_t *row, size_t *all) {
    size_t columns = shape.rank == 2 ? shape.size[1] : 1;
    return !__builtin_mul_overflow(columns, gn_type_size(type), row) &&
           !__builtin_mul_overflow(*row, (size_t)shape.size[0], all);
}

void gn_h5_move_rows(void *to, size_t to_stride, const void *from, size_t from_stride, size_t row,
                     size_t rows) {
    for (size_t k = 0; k < rows; k++)
        memcpy((char *)to + k * to_stride, (const char *)from + k * from_stride, row);
}

/* Up to COMPACT_LIMIT bytes, a data set is stored in its object header, which has a checksum. */
enum { COMPACT_LIMIT = 512, TEXT_COMPACT_LIMIT = 60000, CHUNK_BYTES = 1 << 18 };

static hsize_t at_most(hsize_t value, hsize_t limit) {
    if (limit < 1) limit = 1;
    if (value <= limit) return value;
    /* Chunks have equal sizes, so that the last one is not mostly empty. */
    hsize_t parts = (value + limit - 1) / limit;
    return (value + parts - 1) / parts;
}

static hid_t creation_list(gn_type type, gn_h5_shape shape, size_t bytes) {
    hid_t list = gn_h5_untimed(H5P_DATASET_CREATE);
    if (list < 0 || bytes == 0) return list;
    if (bytes <= COMPACT_LIMIT) {
        (void)H5Pset_layout(list, H5D_COMPACT);
        return list;
    }
    hsize_t item = gn_type_size(type), chunk[2] = {0, 1};
    if (shape.rank == 2) chunk[1] = at_most(shape.size[1], CHUNK_BYTES / item);
    /* If an item has no bytes, its size cannot be a divisor. */
    const hsize_t row = item * chunk[1];
    chunk[0] = at_most(shape.size[0], row ? CHUNK_BYTES / row : 1);
    if (H5Pset_chunk(list, shape.rank, chunk) >= 0 && H5Pset_fletcher32(list) >= 0) return list;
    H5Pclose(list);
    return -1;
}

/* Creates the missing groups of the path `name`. HDF5 can create them by itself
 * (H5Pset_create_intermediate_group), but would add times. */
static void make_groups(gn_h5 *file, const char *name) {
    char part[512];
    for (size_t k = 1; k < sizeof part && name[k - 1] && name[k]; k++) {
        if (name[k] != '/') continue;
        memcpy(part, name, k);
        part[k] = '\0';
        if (H5Lexists(file->id, part, H5P_DEFAULT) > 0) continue;
        hid_t creation = gn_h5_untimed(H5P_GROUP_CREATE);
        hid_t group = H5Gcreate2(file->id, part, H5P_DEFAULT, creation, H5P_DEFAULT);
        if (creation >= 0) H5Pclose(creation);
        if (group < 0) return; /* creating the object itself will fail */
        H5Gclose(group);
    }
}

static gneiss_status put_attribute(gn_h5 *file, hid_t object, const char *name, hid_t stored,
                                   hid_t memory, size_t count, const void *value,
                                   gneiss_error *error) {
    hsize_t size = count;
    hid_t space = count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, NULL);
    if (H5Aexists(object, name) > 0) (void)H5Adelete(object, name);
    hid_t attribute = H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT);
    gneiss_status status = GNEISS_OK;
    if (attribute < 0 || (count > 0 && H5Awrite(attribute, memory, value) < 0)) {
        file->failed = true;
        status =
            gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL, "attribute %s cannot be written", name);
    }
    if (attribute >= 0) H5Aclose(attribute);
    if (space >= 0) H5Sclose(space);
    return status;
}

/* Returns the type of a text, which has a fixed length: strings of variable length are stored in a
 * heap without checksums, and the VTK reader only accepts fixed ones for `Type`. HDF5 has no
 * strings of length 0; a single zero byte is read as "". */
static hid_t text_type(const char *text) {
    size_t length = strlen(text);
    bool ascii = true;
    for (size_t k = 0; k < length; k++) ascii = ascii && (unsigned char)text[k] < 0x80;
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0) return type;
    (void)H5Tset_size(type, length ? length : 1);
    (void)H5Tset_strpad(type, H5T_STR_NULLPAD);
    (void)H5Tset_cset(type, ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
    return type;
}

static gneiss_status put_text_attribute(gn_h5 *file, hid_t object, const char *name,
                                        const char *text, gneiss_error *error) {
    hid_t type = text_type(text);
    gneiss_status status = put_attribute(file, object, name, type, type, 1, text, error);
    if (type >= 0) H5Tclose(type);
    return status;
}

static gneiss_status check_writing(const gn_h5 *file, const char *name, gneiss_error *error) {
    if (file->writing) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INTERNAL, "%s: %s not written: opened for reading",
                   file->path, name);
}

bool gn_h5_demand_finite(gn_h5 *file, bool demanded) {
    bool before = file->finite;
    file->finite = demanded;
    return before;
}

static double real_at(gn_type type, const void *data, size_t k) {
    return type == GN_F64 ? ((const double *)data)[k] : (double)((const float *)data)[k];
}

/* An undetected failure of a run must become neither a result nor a state from which a run
 * continues. */
gneiss_status gn_h5_check_finite(const gn_h5 *file, const char *name, gn_type type,
                                 gn_h5_shape shape, size_t bytes, const void *data,
                                 gneiss_error *error) {
    if (!file->finite || (type != GN_F64 && type != GN_F32)) return GNEISS_OK;
    size_t count = bytes / gn_type_size(type), columns = shape.rank == 2 ? shape.size[1] : 1;
    for (size_t k = 0; k < count; k++) {
        double value = real_at(type, data, k);
        if (!isfinite(value))
            return gn_fail(error, file->writing ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT,
                           "%s: %s: expected finite numbers, found %g in row %zu, column %zu (base "
                           "0)",
                           file->path, name, value, k / columns, k % columns);
    }
    return GNEISS_OK;
}

static gneiss_status put_packed(gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                                size_t bytes, const void *data, const char *unit, const char *text,
                                gneiss_error *error) {
    GN_TRY(gn_h5_check_finite(file, name, type, shape, bytes, data, error));
    hid_t space = H5Screate_simple(shape.rank, shape.size, NULL);
    hid_t creation = creation_list(type, shape, bytes);
    make_groups(file, name);
    hid_t set = H5Dcreate2(file->id, name, gn_h5_file_type(type), space, H5P_DEFAULT, creation,
                           H5P_DEFAULT);
    gneiss_status status = GNEISS_OK;
    if (set < 0 || (bytes > 0 && H5Dwrite(set, gn_h5_memory_type(type), H5S_ALL, H5S_ALL,
                                          H5P_DEFAULT, data) < 0)) {
        file->failed = true;
        status =
            gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL, "data set %s cannot be written", name);
    }
    if (status == GNEISS_OK) status = gn_h5_put_digest(file, name, set, data, bytes, error);
    if (status == GNEISS_OK && unit) status = put_text_attribute(file, set, "unit", unit, error);
    if (status == GNEISS_OK && text)
        status = put_text_attribute(file, set, "description", text, error);
    if (set >= 0) H5Dclose(set);
    if (creation >= 0) H5Pclose(creation);
    if (space >= 0) H5Sclose(space);
    return status;
}

gneiss_status gn_h5_put_shape(gn_h5 *file, const char *name, gn_type type, gn_h5_shape shape,
                              size_t stride, const void *data, const char *unit, const char *text,
                              gneiss_error *error) {
    gn_h5_quiet();
    GN_TRY(check_writing(file, name, error));
    size_t row, bytes;
    if (!gn_h5_shape_bytes(type, shape, &row, &bytes))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: data set %s is too large", file->path,
                       name);
    if (bytes == 0 || stride == 0 || stride == row || shape.size[0] == 1)
        return put_packed(file, name, type, shape, bytes, data, unit, text, error);
    void *packed = gn_alloc(bytes);
    if (!packed)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to write data set %s (%zu bytes)",
                       file->path, name, bytes);
    gn_h5_move_rows(packed, row, data, stride, row, shape.size[0]);
    gneiss_status status = put_packed(file, name, type, shape, bytes, packed, unit, text, error);
    gn_free(packed);
    return status;
}

gneiss_status gn_h5_put(gn_h5 *file, const char *name, gn_type type, size_t rows, size_t components,
                        size_t stride, const void *data, const char *unit, const char *text,
                        gneiss_error *error) {
    return gn_h5_put_shape(file, name, type, gn_h5_table(rows, components), stride, data, unit,
                           text, error);
}

gneiss_status gn_h5_put_text(gn_h5 *file, const char *name, const char *text, gneiss_error *error) {
    gn_h5_quiet();
    GN_TRY(check_writing(file, name, error));
    bool compact = strlen(text) <= TEXT_COMPACT_LIMIT;
    hid_t type = text_type(text), space = H5Screate(H5S_SCALAR);
    hid_t creation = gn_h5_untimed(H5P_DATASET_CREATE);
    if (compact) (void)H5Pset_layout(creation, H5D_COMPACT);
    make_groups(file, name);
    hid_t set = H5Dcreate2(file->id, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    gneiss_status status = GNEISS_OK;
    if (set < 0 || H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0) {
        file->failed = true;
        status = gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL, "text %s cannot be written", name);
    }
    size_t length = strlen(text);
    if (status == GNEISS_OK) /* HDF5 stores one zero byte for an empty text */
        status = gn_h5_put_digest(file, name, set, text, length ? length : 1, error);
    if (set >= 0) H5Dclose(set);
    if (creation >= 0) H5Pclose(creation);
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    return status;
}

/* Every link of the path is tested in turn, because H5Lexists fails if a group before it is
 * missing. Symbolic links and links to other files are not followed: by them, a file could disclose
 * any other file that its reader may read. */
bool gn_h5_has(const gn_h5 *file, const char *name) {
    gn_h5_quiet();
    char part[512];
    size_t length = strlen(name);
    if (strcmp(name, "/") == 0) return true;
    if (length >= sizeof part) return false;
    for (size_t k = 1; k <= length; k++) {
        if (name[k] != '/' && name[k] != '\0') continue;
        memcpy(part, name, k);
        part[k] = '\0';
        H5L_info_t link;
        if (H5Lexists(file->id, part, H5P_DEFAULT) <= 0) return false;
        if (H5Lget_info(file->id, part, &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)
            return false;
    }
    return true;
}

/* Opens the group or data set, creating the group if it does not exist. */
static hid_t open_or_make(gn_h5 *file, const char *object) {
    if (strcmp(object, "/") == 0 || gn_h5_has(file, object))
        return H5Oopen(file->id, object, H5P_DEFAULT);
    make_groups(file, object);
    hid_t creation = gn_h5_untimed(H5P_GROUP_CREATE);
    hid_t group = H5Gcreate2(file->id, object, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (creation >= 0) H5Pclose(creation);
    return group;
}

static gneiss_status put_named_attribute(gn_h5 *file, const char *object, const char *name,
                                         hid_t stored, hid_t memory, size_t count,
                                         const void *value, gneiss_error *error) {
    gn_h5_quiet();
    GN_TRY(check_writing(file, name, error));
    hid_t id = open_or_make(file, object);
    if (id < 0) {
        file->failed = true;
        return gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL, "%s cannot be opened or made",
                          object);
    }
    gneiss_status status = put_attribute(file, id, name, stored, memory, count, value, error);
    H5Oclose(id);
    return status;
}

gneiss_status gn_h5_attribute_text(gn_h5 *file, const char *object, const char *name,
                                   const char *text, gneiss_error *error) {
    gn_h5_quiet();
    hid_t type = text_type(text);
    gneiss_status status = put_named_attribute(file, object, name, type, type, 1, text, error);
    if (type >= 0) H5Tclose(type);
    return status;
}

gneiss_status gn_h5_attribute_f64(gn_h5 *file, const char *object, const char *name,
                                  const double *values, size_t count, gneiss_error *error) {
    return put_named_attribute(file, object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, count, values,
                               error);
}

gneiss_status gn_h5_attribute_i64(gn_h5 *file, const char *object, const char *name,
                                  const int64_t *values, size_t count, gneiss_error *error) {
    return put_named_attribute(file, object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, count, values,
                               error);
}

gneiss_status gn_h5_attributes(gn_h5 *file, const char *object, const gn_h5_attribute *list,
                               size_t count, gneiss_error *error) {
    for (size_t k = 0; k < count; k++) {
        const gn_h5_attribute *a = &list[k];
        const size_t numbers = a->count ? a->count : 1;
        if (a->text)
            GN_TRY(gn_h5_attribute_text(file, object, a->name, a->text, error));
        else if (a->number)
            GN_TRY(gn_h5_attribute_f64(file, object, a->name, a->number, numbers, error));
        else
            GN_TRY(gn_h5_attribute_i64(file, object, a->name, a->whole, numbers, error));
    }
    return GNEISS_OK;
}
