/* Members of a struct, doubles or 64-bit integers, as data sets of one group: the contents of a
 * checkpoint other than records and arrays. */
#ifndef GN_IO_H5_PIECES_H
#define GN_IO_H5_PIECES_H

#include "io/h5.h"

#include <stddef.h>

typedef struct gn_piece {
    const char *name; /* path of the member, whose data set has underscores instead of dots */
    gn_type type;     /* GN_F64 or GN_I64 */
    size_t offset, count;
    bool any; /* may be infinite or NaN in a file that demands finite numbers */
} gn_piece;

/* Describe a member of TYPE: a double, or an array or struct of doubles; limits, which are infinite
 * if unset; 64-bit integers. In the file the path of the member follows PREFIX. */
#define GN_PIECE_DOUBLES(PREFIX, TYPE, member)                                                     \
    { PREFIX #member, GN_F64, offsetof(TYPE, member), sizeof(((TYPE *)0)->member) / 8, false }
#define GN_PIECE_ANY(PREFIX, TYPE, member)                                                         \
    { PREFIX #member, GN_F64, offsetof(TYPE, member), sizeof(((TYPE *)0)->member) / 8, true }
#define GN_PIECE_INTEGER(PREFIX, TYPE, member)                                                     \
    { PREFIX #member, GN_I64, offsetof(TYPE, member), 1, false }

/* Write and read the `count` pieces of the struct at `base`, in `group`. */
gneiss_status gn_h5_put_pieces(gn_h5 *file, const char *group, const gn_piece *pieces, size_t count,
                               const void *base, gneiss_error *error);
gneiss_status gn_h5_get_pieces(const gn_h5 *file, const char *group, const gn_piece *pieces,
                               size_t count, void *base, gneiss_error *error);

#endif
