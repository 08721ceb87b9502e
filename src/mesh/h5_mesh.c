#include "mesh/h5_mesh.h"

#include "base/new.h"

#include <stdio.h>
#include <string.h>

static const char *const kinds[] = {"points", "lines", "triangles", "tetrahedra"};

static gn_mesh_elements *list_of(gn_mesh *mesh, int dimension) {
    gn_mesh_elements *lists[] = {&mesh->points, &mesh->lines, &mesh->triangles, &mesh->tetrahedra};
    return lists[dimension];
}

/* --- writing --- */

static gneiss_status put(gn_h5 *file, const char *group, const char *kind, const char *what,
                         gn_type type, size_t rows, size_t components, size_t stride,
                         const void *data, gneiss_error *error) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s%s%s", group, kind, *kind ? "_" : "", what);
    return gn_h5_put(file, path, type, rows, components, stride, data, NULL, NULL, error);
}

static gneiss_status put_list(gn_h5 *file, const char *name, const char *kind,
                              const gn_mesh_elements *list, gneiss_error *error) {
    GN_FREED int64_t *also = NULL;
    if (!list->count) return GNEISS_OK;
    GN_TRY(gn_new(&also, 2 * list->also_count, "elements of a mesh", error));
    for (size_t k = 0; k < list->also_count; k++) {
        also[2 * k] = (int64_t)list->also[k].element;
        also[2 * k + 1] = list->also[k].group;
    }
    GN_TRY(put(file, name, kind, "node", GN_I32, list->count, (size_t)list->nodes, 0, list->node,
               error));
    GN_TRY(put(file, name, kind, "group", GN_I32, list->count, 1, 0, list->group, error));
    return put(file, name, kind, "also", GN_I64, list->also_count, 2, 0, also, error);
}

gneiss_status gn_h5_put_mesh(gn_h5 *file, const char *name, const gn_mesh *from,
                             gneiss_error *error) {
    gn_mesh mesh = *from;
    GN_FREED int32_t *group = NULL;
    GN_TRY(put(file, name, "", "node", GN_F64, mesh.node_count, 3, 0, mesh.node, error));
    for (int d = 0; d <= 3; d++) GN_TRY(put_list(file, name, kinds[d], list_of(&mesh, d), error));
    GN_TRY(gn_new(&group, 2 * mesh.group_count, "groups of a mesh", error));
    for (size_t k = 0; k < mesh.group_count; k++) {
        group[2 * k] = mesh.groups[k].dimension;
        group[2 * k + 1] = mesh.groups[k].tag;
    }
    GN_TRY(put(file, name, "", "groups", GN_I32, mesh.group_count, 2, 0, group, error));
    return put(file, name, "", "group_names", GN_U8, mesh.group_count, GN_MESH_NAME_SIZE,
               sizeof *mesh.groups, mesh.group_count ? mesh.groups->name : NULL, error);
}

/* --- reading --- */

/* Reads an array of the file and the number of its rows. */
static gneiss_status get(const gn_h5 *file, const char *group, const char *kind, const char *what,
                         gn_type type, size_t components, size_t *rows, void **data,
                         gneiss_error *error) {
    char path[160];
    *data = NULL;
    snprintf(path, sizeof path, "%s/%s%s%s", group, kind, *kind ? "_" : "", what);
    GN_TRY(gn_h5_rows(file, path, rows, error));
    *data = gn_alloc_array(*rows + 1, components * gn_type_size(type));
    if (!*data) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s", path);
    return gn_h5_get(file, path, type, *rows, components, 0, *data, error);
}

static gneiss_status get_memberships(const gn_h5 *file, const char *name, const char *kind,
                                     gn_mesh_elements *list, gneiss_error *error) {
    GN_FREED void *data = NULL;
    GN_TRY(get(file, name, kind, "also", GN_I64, 2, &list->also_count, &data, error));
    const int64_t *also = data;
    GN_TRY(gn_new(&list->also, list->also_count, "elements of a mesh", error));
    for (size_t k = 0; k < list->also_count; k++) {
        if (also[2 * k] < 0 || (size_t)also[2 * k] >= list->count)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s/%s_also: expected elements below %zu, found %lld", name, kind,
                           list->count, (long long)also[2 * k]);
        list->also[k] = (gn_mesh_membership){(size_t)also[2 * k], (int32_t)also[2 * k + 1]};
    }
    return GNEISS_OK;
}

static gneiss_status get_list(const gn_h5 *file, const char *name, int dimension, gn_mesh *mesh,
                              gneiss_error *error) {
    gn_mesh_elements *list = list_of(mesh, dimension);
    const char *kind = kinds[dimension];
    char path[160];
    void *data = NULL;
    size_t rows;
    list->nodes = dimension + 1;
    snprintf(path, sizeof path, "%s/%s_node", name, kind);
    if (!gn_h5_has(file, path)) return GNEISS_OK;
    gneiss_status status =
        get(file, name, kind, "node", GN_I32, (size_t)list->nodes, &list->count, &data, error);
    list->node = data;
    GN_TRY(status);
    for (size_t k = 0; k < list->count * (size_t)list->nodes; k++)
        if (list->node[k] < 0 || (size_t)list->node[k] >= mesh->node_count)
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected nodes below %zu, found %d",
                           path, mesh->node_count, list->node[k]);
    status = get(file, name, kind, "group", GN_I32, 1, &rows, &data, error);
    list->group = data;
    GN_TRY(status);
    if (rows != list->count)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected %zu groups, found %zu", path,
                       list->count, rows);
    return get_memberships(file, name, kind, list, error);
}

static gneiss_status get_groups(const gn_h5 *file, const char *name, gn_mesh *mesh,
                                gneiss_error *error) {
    GN_FREED void *group = NULL, *names = NULL;
    size_t rows = 0, count = 0;
    GN_TRY(get(file, name, "", "groups", GN_I32, 2, &count, &group, error));
    GN_TRY(get(file, name, "", "group_names", GN_U8, GN_MESH_NAME_SIZE, &rows, &names, error));
    if (rows != count)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected %zu names of groups, found %zu",
                       name, count, rows);
    GN_TRY(gn_new(&mesh->groups, count, "groups of a mesh", error));
    for (size_t k = 0; k < count; k++) {
        const int32_t *g = (const int32_t *)group + 2 * k;
        mesh->groups[k] = (gn_mesh_group){.dimension = g[0], .tag = g[1]};
        memcpy(mesh->groups[k].name, (const char *)names + GN_MESH_NAME_SIZE * k,
               GN_MESH_NAME_SIZE - 1);
        mesh->group_count = k + 1;
        if (g[0] < 0 || g[0] > 3)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected groups of dimension 0 to 3, found %d", name, g[0]);
    }
    return GNEISS_OK;
}

gneiss_status gn_h5_get_mesh(const gn_h5 *file, const char *name, gn_mesh *mesh,
                             gneiss_error *error) {
    *mesh = (gn_mesh){0};
    void *data = NULL;
    gneiss_status status = get(file, name, "", "node", GN_F64, 3, &mesh->node_count, &data, error);
    mesh->node = data;
    for (int d = 0; d <= 3 && status == GNEISS_OK; d++)
        status = get_list(file, name, d, mesh, error);
    if (status == GNEISS_OK) status = get_groups(file, name, mesh, error);
    if (status != GNEISS_OK) gn_mesh_free(mesh);
    return status;
}
