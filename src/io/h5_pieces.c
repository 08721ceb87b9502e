#include "io/h5_pieces.h"

#include <stdio.h>

enum { PATH_SIZE = 128 };

/* Data set names cannot hold the dots of a member path. */
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

gneiss_status gn_h5_get_pieces(const gn_h5 *file, const char *group, const gn_piece *pieces,
                               size_t count, void *base, gneiss_error *error) {
    for (size_t k = 0; k < count; k++) {
        char path[PATH_SIZE];
        path_of(group, &pieces[k], path);
        GN_TRY(gn_h5_get(file, path, pieces[k].type, pieces[k].count, 1, 0,
                         (char *)base + pieces[k].offset, error));
    }
    return GNEISS_OK;
}
