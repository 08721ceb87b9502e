#include "surfaces/body_shape.h"

#include "base/memory.h"
#include "base/new.h"
#include "base/vec3.h"
#include "mesh/mesh.h"
#include "surfaces/tool_shape.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static gn_place_text place_of(const gn_scene *scene, size_t index) {
    char path[32];
    snprintf(path, sizeof path, "bodies[%zu]", index);
    return gn_scene_at(scene, scene->bodies[index].where, path);
}

/* --- shapes as meshes --- */

static gneiss_status allocate(gn_mesh *mesh, size_t nodes, size_t triangles, gneiss_error *error) {
    *mesh = (gn_mesh){.triangles.nodes = 3};
    mesh->node = gn_alloc_array(nodes, 3 * sizeof *mesh->node);
    mesh->triangles.node = gn_alloc_array(triangles, 3 * sizeof *mesh->triangles.node);
    mesh->triangles.group = gn_alloc_array(triangles, sizeof *mesh->triangles.group);
    if (!mesh->node || !mesh->triangles.node || !mesh->triangles.group) {
        gn_mesh_free(mesh);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets", triangles);
    }
    mesh->node_count = nodes;
    return GNEISS_OK;
}

static void add_triangle(gn_mesh *mesh, int32_t a, int32_t b, int32_t c) {
    int32_t *t = mesh->triangles.node + 3 * mesh->triangles.count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static gneiss_status make_box(const double size[3], gn_mesh *mesh, gneiss_error *error) {
    static const int32_t side[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    GN_TRY(allocate(mesh, 8, 12, error));
    for (int k = 0; k < 8; k++)
        for (int a = 0; a < 3; a++) mesh->node[3 * k + a] = (k >> a & 1) * size[a];
    for (int k = 0; k < 6; k++) {
        add_triangle(mesh, side[k][0], side[k][1], side[k][2]);
        add_triangle(mesh, side[k][0], side[k][2], side[k][3]);
    }
    return GNEISS_OK;
}

/* Makes a cylinder: two rings of corners, and end faces that are fans about their centres. */
static gneiss_status make_cylinder(const gn_body_cylinder *cylinder, gn_mesh *mesh,
                                   gneiss_error *error) {
    int32_t n = (int32_t)cylinder->sides;
    GN_TRY(allocate(mesh, 2 * (size_t)n + 2, 4 * (size_t)n, error));
    double upper = cylinder->upper_diameter > 0.0 ? cylinder->upper_diameter : cylinder->diameter;
    for (int32_t k = 0; k < n; k++) {
        double angle = 2.0 * pi * k / n;
        for (int end = 0; end < 2; end++) {
            double *x = mesh->node + 3 * (end * n + k),
                   radius = 0.5 * (end ? upper : cylinder->diameter);
            x[0] = radius * cos(angle);
            x[1] = radius * sin(angle);
            x[2] = end ? cylinder->height : 0.0;
        }
    }
    mesh->node[3 * (2 * n + 1) + 2] = cylinder->height;
    if (cylinder->open) mesh->node_count -= 2;
    for (int32_t k = 0; k < n; k++) {
        int32_t next = (k + 1) % n;
        add_triangle(mesh, k, next, n + next);
        add_triangle(mesh, k, n + next, n + k);
        if (cylinder->open) continue;
        add_triangle(mesh, 2 * n, next, k);
        add_triangle(mesh, 2 * n + 1, n + k, n + next);
    }
    return GNEISS_OK;
}

static gneiss_status make_mesh(const gn_scene *scene, size_t index, gn_mesh *mesh,
                               gneiss_error *error) {
    const gn_body_def *def = &scene->bodies[index];
    gneiss_status status;
    if (def->has_box)
        status = make_box(def->box_size, mesh, error);
    else if (def->has_cylinder)
        status = make_cylinder(&def->cylinder, mesh, error);
    else if (gn_body_tool(def))
        status = gn_tool_mesh(gn_body_tool(def), &def->tool, mesh, error);
    else
        status = gn_mesh_read_surface(def->surface_path, 1.0, mesh, error);
    double volume;
    if (status == GNEISS_OK && gn_body_mass_is_from_surface(def))
        status = gn_mesh_close_surface(mesh, "surface", &volume, error);
    if (status == GNEISS_OK) return status;
    gn_mesh_free(mesh);
    gn_fail_context(error, "%s (%s): ", place_of(scene, index).text, def->name);
    return status;
}

/* --- into place --- */

void gn_rotation_matrix(const double v[3], double m[9]) {
    double angle = sqrt(gn_dot3(v, v)), axis[3] = {0, 0, 0};
    for (int a = 0; angle > 0.0 && a < 3; a++) axis[a] = v[a] / angle;
    double c = cos(angle), s = sin(angle);
    const double skew[9] = {0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            m[3 * a + b] = (a == b ? c : 0.0) + (1.0 - c) * axis[a] * axis[b] + s * skew[3 * a + b];
}

static void place(const gn_body_def *def, const double *local, double *x) {
    double m[9], scaled[3];
    gn_rotation_matrix(def->rotation, m);
    for (int a = 0; a < 3; a++) scaled[a] = def->scale * local[a];
    for (int a = 0; a < 3; a++)
        x[a] = def->origin[a] + (def->has_rotation ? gn_dot3(m + 3 * a, scaled) : scaled[a]);
}

/* Tells whether a facet is degenerate: the height of a triangle is below the rounding of its
 * longest side, or a segment has no length. */
static bool is_degenerate(const gn_body_shape *shape, const int32_t *corner, int corners) {
    const double *x[3] = {0};
    double e[3][3], normal[3], longest = 0.0;
    for (int c = 0; c < corners; c++) x[c] = shape->vertex + 4 * (int64_t)corner[c];
    for (int c = 0; c < corners; c++) {
        for (int a = 0; a < 3; a++) e[c][a] = x[(c + 1) % corners][a] - x[c][a];
        longest = fmax(longest, gn_dot3(e[c], e[c]));
    }
    if (corners == 2) return !(longest > 0.0);
    gn_cross3(e[0], e[1], normal);
    return !(sqrt(gn_dot3(normal, normal)) > 1e-10 * longest);
}

static void drop_degenerate(gn_body_shape *shape, int corners) {
    size_t kept = 0;
    for (size_t f = 0; f < shape->facets; f++) {
        int32_t *from = shape->corner + (size_t)corners * f;
        if (is_degenerate(shape, from, corners)) continue;
        memmove(shape->corner + (size_t)corners * kept++, from, (size_t)corners * sizeof *from);
    }
    shape->dropped += shape->facets - kept;
    shape->facets = kept;
}

static gneiss_status from_mesh(const gn_body_def *def, const gn_mesh *mesh, gn_body_shape *shape,
                               gneiss_error *error) {
    shape->vertices = mesh->node_count;
    shape->facets = mesh->triangles.count;
    shape->cavities = mesh->cavities;
    shape->dropped = mesh->changes.degenerate;
    shape->vertex = gn_alloc_array(shape->vertices + 1, 4 * sizeof *shape->vertex);
    shape->corner = gn_alloc_array(shape->facets + 1, 3 * sizeof *shape->corner);
    if (!shape->vertex || !shape->corner)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets",
                       shape->facets);
    for (size_t v = 0; v < shape->vertices; v++)
        place(def, mesh->node + 3 * v, shape->vertex + 4 * v);
    memcpy(shape->corner, mesh->triangles.node, 3 * shape->facets * sizeof *shape->corner);
    return GNEISS_OK;
}

static gneiss_status from_line(const gn_body_def *def, gn_body_shape *shape, gneiss_error *error) {
    const gn_tool_kind tool = gn_body_tool(def);
    bool closed = def->polygon_count > 0 || tool;
    size_t n = def->polygon_count ? def->polygon_count : def->polyline_count;
    const double *point = def->polygon_count ? def->polygon : def->polyline;
    GN_FREED double *outline = NULL;
    if (tool) GN_TRY(gn_tool_outline(tool, &def->tool, &outline, &n, error));
    if (tool) point = outline;
    shape->vertices = n;
    shape->facets = closed ? n : n - 1;
    shape->vertex = gn_alloc_array(n, 4 * sizeof *shape->vertex);
    shape->corner = gn_alloc_array(n, 2 * sizeof *shape->corner);
    if (!shape->vertex || !shape->corner)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a line of %zu points", n);
    for (size_t v = 0; v < n; v++) {
        const double local[3] = {point[2 * v], point[2 * v + 1], 0.0};
        place(def, local, shape->vertex + 4 * v);
        shape->vertex[4 * v + 2] = 0.0;
    }
    for (size_t f = 0; f < shape->facets; f++) {
        shape->corner[2 * f] = (int32_t)f;
        shape->corner[2 * f + 1] = f + 1 < n ? (int32_t)(f + 1) : 0;
    }
    return GNEISS_OK;
}

/* --- mass --- */

/* Sums over cones from a point near the body to its facets: exact integrals of 1, x and x x^T
 * (Tonon 2004, J. Math. Stat. 1, 8-11). */
typedef struct integrals {
    double volume, first[3], second[9];
} integrals;

static void add_cone(const double x[3][3], int corners, integrals *sum) {
    double across[3], part, total[3] = {0, 0, 0};
    if (corners == 3) {
        gn_cross3(x[1], x[2], across);
        part = gn_dot3(x[0], across) / 6.0;
    } else {
        part = 0.5 * (x[0][0] * x[1][1] - x[0][1] * x[1][0]);
    }
    for (int c = 0; c < corners; c++)
        for (int a = 0; a < 3; a++) total[a] += x[c][a];
    double n = corners + 1.0; /* the corners of the cone include its tip, the origin */
    sum->volume += part;
    for (int a = 0; a < 3; a++) sum->first[a] += part * total[a] / n;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double products = total[a] * total[b];
            for (int c = 0; c < corners; c++) products += x[c][a] * x[c][b];
            sum->second[3 * a + b] += part * products / (n * (n + 1.0));
        }
}

static gneiss_status weigh(gn_body_shape *shape, int corners, gneiss_error *error) {
    double tip[3] = {0, 0, 0}, size = 0.0;
    integrals sum = {0};
    for (size_t v = 0; v < shape->vertices; v++)
        for (int a = 0; a < 3; a++)
            tip[a] += shape->vertex[4 * v + (size_t)a] / (double)shape->vertices;
    for (size_t f = 0; f < shape->facets; f++) {
        double x[3][3];
        for (int c = 0; c < corners; c++)
            for (int a = 0; a < 3; a++) {
                x[c][a] =
                    shape->vertex[4 * (int64_t)shape->corner[(size_t)corners * f + (size_t)c] + a] -
                    tip[a];
                size = fmax(size, fabs(x[c][a]));
            }
        add_cone((const double(*)[3])x, corners, &sum);
    }
    /* The volume is negative for a polygon of opposite orientation. */
    double sign = sum.volume < 0.0 ? -1.0 : 1.0;
    shape->volume = sign * sum.volume;
    if (!(shape->volume > 1e-12 * pow(size, corners)))
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected a body with a volume, found %g m3",
                       shape->volume);
    double off[3], trace = 0.0, second[9];
    for (int a = 0; a < 3; a++) off[a] = sum.first[a] / sum.volume;
    for (int a = 0; a < 9; a++)
        second[a] = sign * (sum.second[a] - sum.volume * off[a / 3] * off[a % 3]);
    for (int a = 0; a < 3; a++) {
        shape->centre[a] = tip[a] + off[a];
        trace += second[4 * a];
    }
    for (int a = 0; a < 9; a++) shape->moment[a] = (a % 4 == 0 ? trace : 0.0) - second[a];
    return GNEISS_OK;
}

/* Checks coordinates, because a valid file and a valid scale may give some that no key may have. */
static gneiss_status check_places(const gn_body_shape *shape, gneiss_error *error) {
    for (size_t v = 0; v < shape->vertices; v++) {
        const double *x = shape->vertex + 4 * v;
        if (fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))) <= GN_PLACE_MOST) continue;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected coordinates up to %g m, found a vertex at (%g, %g, %g) m",
                       GN_PLACE_MOST, x[0], x[1], x[2]);
    }
    return GNEISS_OK;
}

gneiss_status gn_body_shape_make(const gn_scene *scene, size_t index, gn_body_shape *shape,
                                 gneiss_error *error) {
    const gn_body_def *def = &scene->bodies[index];
    int corners = (int)scene->dimension;
    gn_mesh mesh = {0};
    gneiss_status status;
    *shape = (gn_body_shape){0};
    if (corners == 3) GN_TRY(make_mesh(scene, index, &mesh, error));
    status = corners == 3 ? from_mesh(def, &mesh, shape, error) : from_line(def, shape, error);
    gn_mesh_free(&mesh);
    if (status == GNEISS_OK) {
        status = check_places(shape, error);
        if (status == GNEISS_OK && gn_body_mass_is_from_surface(def))
            status = weigh(shape, corners, error);
        if (status != GNEISS_OK)
            gn_fail_context(error, "%s (%s): ", place_of(scene, index).text, def->name);
    }
    if (status == GNEISS_OK) {
        drop_degenerate(shape, corners);
        if (!shape->facets)
            status = gn_fail(error, GNEISS_ERROR_INPUT,
                             "%s (%s): expected facets, found none but %zu without area",
                             place_of(scene, index).text, def->name, shape->dropped);
    }
    if (status != GNEISS_OK) gn_body_shape_free(shape);
    return status;
}

gneiss_status gn_body_shape_of_mesh(const gn_mesh *mesh, gn_body_shape *shape,
                                    gneiss_error *error) {
    const gn_body_def unplaced = {.scale = 1.0};
    *shape = (gn_body_shape){0};
    gneiss_status status = from_mesh(&unplaced, mesh, shape, error);
    return status == GNEISS_OK ? weigh(shape, 3, error) : status;
}

void gn_body_shape_free(gn_body_shape *shape) {
    gn_free(shape->vertex);
    gn_free(shape->corner);
    *shape = (gn_body_shape){0};
}
