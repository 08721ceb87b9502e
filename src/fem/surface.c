/* Contact facets of a solid. */
#include "base/memory.h"
#include "fem/internal.h"

#include <string.h>

static gneiss_status no_memory(gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the surface of a solid");
}

static gneiss_status facets_of_group(const gn_fem_solid *solid, const char *group, int32_t **corner,
                                     size_t *count, gneiss_error *error) {
    gn_mesh mesh = solid->mesh;
    const gn_mesh_elements *list = gn_fem_elements_of(&mesh, solid->dimension - 1);
    const gn_mesh_group *found = gn_fem_find_group(&mesh, group, solid->dimension - 1);
    size_t nodes = (size_t)solid->dimension;
    if (!found) return gn_fem_no_group(solid->name, &mesh, group, solid->dimension - 1, error);
    uint8_t *in = gn_alloc_array(list->count + 1, sizeof *in);
    *corner = gn_alloc_array(nodes * list->count + 1, sizeof **corner);
    if (in && *corner) {
        gn_fem_mark_group(list, found->tag, in);
        for (size_t f = 0; f < list->count; f++)
            if (in[f])
                memcpy(*corner + nodes * (*count)++, list->node + nodes * f,
                       nodes * sizeof **corner);
    }
    gneiss_status status = in && *corner ? GNEISS_OK : no_memory(error);
    gn_free(in);
    if (status == GNEISS_OK && !*count)
        return gn_fem_no_group(solid->name, &solid->mesh, group, solid->dimension - 1, error);
    return status;
}

/* gn_mesh_boundary replaces the listed facets, so that it works on a copy. */
static gneiss_status all_facets(const gn_fem_solid *solid, int32_t **corner, size_t *count,
                                gneiss_error *error) {
    gn_mesh from = solid->mesh, mesh = {0};
    int dimension = solid->dimension;
    const gn_mesh_elements *solids = gn_fem_elements_of(&from, dimension);
    gn_mesh_elements *copy = gn_fem_elements_of(&mesh, dimension);
    size_t nodes = (size_t)dimension + 1, bytes = nodes * solids->count * sizeof *solids->node;
    mesh.lines.nodes = 2;
    mesh.triangles.nodes = 3;
    mesh.tetrahedra.nodes = 4;
    mesh.node_count = from.node_count;
    mesh.node = gn_alloc_array(from.node_count + 1, 3 * sizeof *mesh.node);
    copy->count = solids->count;
    copy->node = gn_alloc(bytes);
    copy->group = gn_alloc_array(solids->count + 1, sizeof *copy->group);
    gneiss_status status = mesh.node && copy->node && copy->group ? GNEISS_OK : no_memory(error);
    if (status == GNEISS_OK) {
        memcpy(mesh.node, from.node, 3 * from.node_count * sizeof *mesh.node);
        memcpy(copy->node, solids->node, bytes);
        status = gn_mesh_boundary(&mesh, dimension, solid->name, error);
    }
    if (status == GNEISS_OK) {
        gn_mesh_elements *facets = gn_fem_elements_of(&mesh, dimension - 1);
        *corner = facets->node;
        *count = facets->count;
        facets->node = NULL;
    }
    gn_mesh_free(&mesh);
    return status;
}

gneiss_status gn_fem_surface(const gn_fem_solid *solid, const char *group, int32_t **corner,
                             size_t *count, gneiss_error *error) {
    *corner = NULL;
    *count = 0;
    return group ? facets_of_group(solid, group, corner, count, error)
                 : all_facets(solid, corner, count, error);
}
