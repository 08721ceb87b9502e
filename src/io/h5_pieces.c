#include "io/h5_pieces.h"

#include "io/h5_private.h"

#include <stdio.h>

enum { PATH_SIZE = 128 };

/* Writes the path of a data set, whose name cannot contain the dots of a member path. */
static void path_of(const char *group, const gn_piece *piece, char path[PATH_SIZE]) {
    int name = snprintf(path, PATH_SIZE, "%s/", group);
    snprintf(path + name, PATH_SIZE - (size_t)name, "%s", piece->name);
    for (char *c = path + name; *c; c++)
        if (*c == '.') *c = '_';
}

gneiss_status gn_h5_put_pieces(gn_h5 *file, const char *group, const gn_piece *pieces, size_t count,
                               const void *base, gneiss_error *error) {
    for (size_t k = 0; k < count; k++) {
        char path[PATH_SIZE];
        path_of(group, &pieces[k], path);
        bool demanded = pieces[k].any && gn_h5_demand_finite(file, false);
        gneiss_status status = gn_h5_put(file, path, pieces[k].type, pieces[k].count, 1, 0,
                                         (const char *)base + pieces[k].offset, NULL, NULL, error);
        if (demanded) gn_h5_demand_finite(file, true);
        GN_TRY(status);
    }
    return GNEISS_OK;
}

/* Checks counts, steps and numbers of items: negative ones stand for wall indices or none, and all
 * must be exactly representable as doubles. Values that may be infinite or NaN are bounds and never
 * negative. */
static gneiss_status check_range(const gn_h5 *file, const char *path, const gn_piece *piece,
                                 const void *data, gneiss_error *error) {
    const int64_t most = (int64_t)1 << 53;
    for (size_t k = 0; k < piece->count; k++) {
        if (piece->type == GN_I64) {
            int64_t value = ((const int64_t *)data)[k];
            if (value < INT32_MIN || value > most)
                return gn_fail(error, GNEISS_ERROR_INPUT,
                               "%s: %s: expected a whole number in [-2^31, 2^53], found %lld",
                               file->path, path, (long long)value);
        } else if (piece->any && ((const double *)data)[k] < 0.0) {
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s: expected a number >= 0, found %g",
                           file->path, path, ((const double *)data)[k]);
        }
    }
    return GNEISS_OK;
}

gneiss_status gn_h5_get_pieces(const gn_h5 *file, const char *group, const gn_piece *pieces,
                               size_t count, void *base, gneiss_error *error) {
    for (size_t k = 0; k < count; k++) {
        char path[PATH_SIZE];
        void *data = (char *)base + pieces[k].offset;
        path_of(group, &pieces[k], path);
        gn_h5_shape shape = gn_h5_table(pieces[k].count, 1);
        GN_TRY((pieces[k].any ? gn_h5_get_any : gn_h5_get_shape)(file, path, pieces[k].type, shape,
                                                                 0, data, error));
        GN_TRY(check_range(file, path, &pieces[k], data, error));
    }
    return GNEISS_OK;
}
