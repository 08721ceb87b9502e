#include "pack/shape.h"

#include "base/new.h"
#include "base/point.h"
#include "mesh/gmsh.h"
#include "mesh/joints.h"

#include <math.h>
#include <string.h>

/* ---- mesh ---- */

static const gn_mesh_elements *elements_of(const gn_mesh *mesh, int dimension) {
    return dimension == 3 ? &mesh->tetrahedra : &mesh->triangles;
}

/* Computes mean edge lengths; an edge counts once for each of its elements, which is accurate
 * enough. */
static gneiss_status measure_nodes(gn_pack_shape *shape, int dimension, gneiss_error *error) {
    const gn_mesh *mesh = &shape->mesh;
    const gn_mesh_elements *e = elements_of(mesh, dimension);
    GN_FREED double *edges = NULL;
    GN_TRY(gn_new(&shape->node_size, mesh->node_count, "nodes of a mesh", error));
    GN_TRY(gn_new(&edges, mesh->node_count, "nodes of a mesh", error));
    for (size_t k = 0; k < e->count; k++)
        for (int a = 0; a < e->nodes; a++)
            for (int b = 0; b < e->nodes; b++) {
                if (a == b) continue;
                int32_t from = e->node[k * e->nodes + a], to = e->node[k * e->nodes + b];
                const double *x = mesh->node + 3 * from, *y = mesh->node + 3 * to;
                shape->node_size[from] += hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]);
                edges[from] += 1.0;
            }
    for (size_t k = 0; k < mesh->node_count; k++)
        if (edges[k] > 0.0) shape->node_size[k] /= edges[k];
    return GNEISS_OK;
}

/* Scales and moves a file's coordinates to the scene's origin. */
static void place(const gn_pack_def *def, gn_mesh *mesh) {
    for (size_t k = 0; k < 3 * mesh->node_count; k++)
        mesh->node[k] = gn_point_out(def->origin[k % 3], mesh->node[k]);
}

gneiss_status gn_pack_check_geometry(const gn_scene *scene, gneiss_error *error) {
    const gn_pack_def *def = &scene->specimen.pack;
    char command[GN_PATH_SIZE + 128];
    if (scene->allow_gmsh || def->shape != GN_SHAPE_MESH || !gn_is_geometry(def->mesh_path))
        return GNEISS_OK;
    gn_mesh_geometry_command(def->mesh_path, (int)scene->dimension, command, sizeof command);
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected a mesh (.msh), or --allow-gmsh on the command line "
        "(gneiss_scene_allow_gmsh in C), found the geometry '%.300s': gmsh would have to "
        "mesh it, and a geometry can make gmsh execute any command. With the permission "
        "this is run: %.700s, with Mesh.ElementOrder = 1; in LINEAR.geo",
        gn_scene_at(scene, scene->specimen.where, "specimen.mesh").text, def->mesh, command);
}

/* Reads the elements of a file and makes their boundary. */
static gneiss_status read_mesh(const gn_scene *scene, gn_mesh *mesh, gneiss_error *error) {
    const gn_pack_def *def = &scene->specimen.pack;
    int dimension = (int)scene->dimension;
    double scale = scene->specimen.scale;
    GN_TRY(gn_pack_check_geometry(scene, error));
    GN_TRY(gn_is_geometry(def->mesh_path)
               ? gn_mesh_geometry(def->mesh_path, dimension, scale, mesh, error)
               : gn_mesh_read_msh(def->mesh_path, scale, mesh, error));
    place(def, mesh);
    GN_TRY(gn_mesh_boundary(mesh, dimension, def->mesh_path, error));
    return gn_mesh_check_overlap(mesh, dimension, (const double[3]){0, 0, 0}, def->mesh_path,
                                 error);
}

/* Reads a closed surface and orients it outward. */
static gneiss_status read_surface(const gn_scene *scene, gn_mesh *surface, gneiss_error *error) {
    const gn_pack_def *def = &scene->specimen.pack;
    double volume;
    GN_TRY(gn_mesh_read_surface(def->surface_path, scene->specimen.scale, surface, error));
    place(def, surface);
    return gn_mesh_close_surface(surface, def->surface_path, &volume, error);
}

gneiss_status gn_pack_shape_facets(const gn_scene *scene, gn_mesh *mesh, gneiss_error *error) {
    *mesh = (gn_mesh){0};
    gneiss_status status = scene->specimen.pack.shape == GN_SHAPE_MESH
                               ? read_mesh(scene, mesh, error)
                               : read_surface(scene, mesh, error);
    if (status != GNEISS_OK) gn_mesh_free(mesh);
    return status;
}

static gneiss_status from_mesh(const gn_scene *scene, gn_pack_shape *shape, gneiss_error *error) {
    int dimension = (int)scene->dimension;
    GN_TRY(read_mesh(scene, &shape->mesh, error));
    gn_mesh_changed(&shape->mesh, shape->changes, sizeof shape->changes);
    GN_TRY(gn_domain_surface(&shape->mesh, dimension, scene->specimen.pack.mesh_path,
                             &shape->domain, error));
    return measure_nodes(shape, dimension, error);
}

static gneiss_status from_surface(const gn_scene *scene, gn_pack_shape *shape,
                                  gneiss_error *error) {
    gn_mesh surface = {0};
    gneiss_status status = read_surface(scene, &surface, error);
    gn_mesh_changed(&surface, shape->changes, sizeof shape->changes);
    if (status == GNEISS_OK)
        status = gn_domain_surface(&surface, 3, scene->specimen.pack.surface_path, &shape->domain,
                                   error);
    gn_mesh_free(&surface);
    return status;
}

static gneiss_status from_shape(const gn_scene *scene, gn_pack_shape *shape, gneiss_error *error) {
    const gn_pack_def *def = &scene->specimen.pack;
    double upper[3];
    for (int a = 0; a < 3; a++) upper[a] = def->origin[a] + def->size[a];
    switch (def->shape) {
    case GN_SHAPE_RECTANGLE:
        return gn_domain_rectangle(def->origin, upper, &shape->domain, error);
    case GN_SHAPE_DISC:
        return gn_domain_disc(def->origin, def->diameter / 2.0, &shape->domain, error);
    case GN_SHAPE_POLYGON:
        return gn_domain_polygon(def->corners, def->corner_count, &shape->domain, error);
    case GN_SHAPE_BOX:
        return gn_domain_box(def->origin, upper, &shape->domain, error);
    case GN_SHAPE_CYLINDER:
        return gn_domain_cylinder(def->origin, def->diameter / 2.0, def->height, &shape->domain,
                                  error);
    case GN_SHAPE_SURFACE:
        return from_surface(scene, shape, error);
    case GN_SHAPE_MESH:
        return from_mesh(scene, shape, error);
    case GN_SHAPE_NONE:
        break;
    }
    return gn_fail(error, GNEISS_ERROR_INTERNAL, "no shape to pack");
}

gneiss_status gn_pack_shape_create(const gn_scene *scene, gn_pack_shape *shape,
                                   gneiss_error *error) {
    *shape = (gn_pack_shape){.refinements = scene->specimen.pack.refinements,
                             .refinement_count = scene->specimen.pack.refinement_count};
    gneiss_status status = from_shape(scene, shape, error);
    if (status != GNEISS_OK) gn_pack_shape_free(shape);
    return status;
}

void gn_pack_shape_free(gn_pack_shape *shape) {
    gn_domain_free(shape->domain);
    gn_mesh_free(&shape->mesh);
    gn_free(shape->node_size);
    *shape = (gn_pack_shape){0};
}

/* ---- size of particles ---- */

static double box_distance(const gn_refinement *refinement, const double x[3]) {
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        double d = fmax(fmax(refinement->lower[a] - x[a], x[a] - refinement->upper[a]), 0.0);
        square += d * d;
    }
    return sqrt(square);
}

double gn_pack_shape_size(const gn_pack_shape *shape, const double x[3]) {
    double size = 1.0;
    for (size_t k = 0; k < shape->refinement_count; k++) {
        const gn_refinement *r = &shape->refinements[k];
        double away =
            r->boundary ? fmax(gn_domain_depth(shape->domain, x), 0.0) : box_distance(r, x);
        size = fmin(size, r->size + (1.0 - r->size) * fmin(away / r->distance, 1.0));
    }
    return size;
}
