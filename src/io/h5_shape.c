/* Types and shapes, in files and in memory. */
#include "io/h5_private.h"

#include <string.h>

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
