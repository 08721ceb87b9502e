#include "pack/boundary.h"

#include "base/new.h"
#include "base/vec3.h"
#include "pack/shape.h"

#include <math.h>
#include <string.h>

/* Output of the functions that cut; *held becomes false without memory. */
typedef struct cutter {
    gn_boundary_pieces *pieces;
    double size;
    bool held;
} cutter;

static void add(cutter *output, const double point[3], const double area[3]) {
    gn_boundary_pieces *p = output->pieces;
    if (!output->held) return;
    output->held =
        gn_grow(&p->piece, p->count, p->count + 1, &p->capacity, "pieces", NULL) == GNEISS_OK;
    if (!output->held) return;
    gn_piece_of_boundary *piece = &p->piece[p->count++];
    memcpy(piece->point, point, sizeof piece->point);
    memcpy(piece->area, area, sizeof piece->area);
}

static int64_t parts(const cutter *output, double length) {
    return (int64_t)fmax(1.0, ceil(length / output->size));
}

static double length3(const double v[3]) {
    return sqrt(gn_dot3(v, v));
}

/* Adds a parallelogram with the sides u and v; u x v points outward. */
static void add_face(cutter *output, const double corner[3], const double u[3], const double v[3]) {
    const int64_t n = parts(output, length3(u)), m = parts(output, length3(v));
    double area[3], point[3];
    gn_cross3(u, v, area);
    for (int a = 0; a < 3; a++) area[a] /= (double)n * (double)m;
    for (int64_t j = 0; j < m; j++)
        for (int64_t i = 0; i < n; i++) {
            double s = ((double)i + 0.5) / (double)n, t = ((double)j + 0.5) / (double)m;
            for (int a = 0; a < 3; a++) point[a] = corner[a] + s * u[a] + t * v[a];
            add(output, point, area);
        }
}

/* Adds an edge from one point to another, with the body on its left. */
static void add_edge(cutter *output, const double from[2], const double to[2]) {
    double u[2] = {to[0] - from[0], to[1] - from[1]};
    const int64_t n = parts(output, hypot(u[0], u[1]));
    for (int64_t k = 0; k < n; k++) {
        double s = ((double)k + 0.5) / (double)n;
        add(output, (const double[3]){from[0] + s * u[0], from[1] + s * u[1], 0.0},
            (const double[3]){u[1] / (double)n, -u[0] / (double)n, 0.0});
    }
}

/* Adds a triangle, counter-clockwise about the outward normal, divided into m^2 equal ones. */
static void add_triangle(cutter *output, const double *x[3]) {
    double u[3], v[3], area[3], point[3];
    for (int a = 0; a < 3; a++) {
        u[a] = x[1][a] - x[0][a];
        v[a] = x[2][a] - x[0][a];
    }
    const int64_t m = parts(output, fmax(length3(u), length3(v)));
    gn_cross3(u, v, area);
    for (int a = 0; a < 3; a++) area[a] *= 0.5 / ((double)m * (double)m);
    for (int64_t i = 0; i < m; i++)
        for (int64_t j = 0; i + j < m; j++)
            for (int flip = 0; flip < (i + j + 1 < m ? 2 : 1); flip++) {
                double s = ((double)i + (flip ? 2.0 : 1.0) / 3.0) / (double)m;
                double t = ((double)j + (flip ? 2.0 : 1.0) / 3.0) / (double)m;
                for (int a = 0; a < 3; a++) point[a] = x[0][a] + s * u[a] + t * v[a];
                add(output, point, area);
            }
}

/* ---- shapes ---- */

static void cut_box(cutter *output, const gn_pack_def *def) {
    for (int axis = 0; axis < 3; axis++) {
        int a = (axis + 1) % 3, b = (axis + 2) % 3;
        double u[3] = {0}, v[3] = {0}, upper[3];
        u[a] = def->size[a];
        v[b] = def->size[b];
        memcpy(upper, def->origin, sizeof upper);
        upper[axis] += def->size[axis];
        add_face(output, upper, u, v);
        add_face(output, def->origin, v, u);
    }
}

static void cut_rectangle(cutter *output, const gn_pack_def *def) {
    const double *o = def->origin, *s = def->size;
    const double corner[4][2] = {
        {o[0], o[1]}, {o[0] + s[0], o[1]}, {o[0] + s[0], o[1] + s[1]}, {o[0], o[1] + s[1]}};
    for (int k = 0; k < 4; k++) add_edge(output, corner[k], corner[(k + 1) % 4]);
}

static void cut_polygon(cutter *output, const gn_pack_def *def) {
    const double *x = def->corners;
    const size_t n = def->corner_count;
    double area = 0.0;
    for (size_t k = 0; k < n; k++) {
        size_t next = (k + 1) % n;
        area += x[2 * k] * x[2 * next + 1] - x[2 * k + 1] * x[2 * next];
    }
    for (size_t k = 0; k < n; k++) {
        const double *from = x + 2 * k, *to = x + 2 * ((k + 1) % n);
        add_edge(output, area > 0.0 ? from : to, area > 0.0 ? to : from);
    }
}

/* Cuts the rim of a circle at a height, with an extent along z; the areas of its pieces add up to
 * those of arcs. */
static void cut_round(cutter *output, const double centre[3], double radius, double height,
                      double rise, int64_t m) {
    const int64_t n = parts(output, 2.0 * M_PI * radius);
    const double each = 2.0 * M_PI * radius * height / ((double)n * (double)m);
    for (int64_t j = 0; j < m; j++)
        for (int64_t k = 0; k < n; k++) {
            double angle = 2.0 * M_PI * ((double)k + 0.5) / (double)n;
            double normal[3] = {cos(angle), sin(angle), 0.0}, point[3], area[3];
            for (int a = 0; a < 3; a++) {
                point[a] = centre[a] + radius * normal[a];
                area[a] = each * normal[a];
            }
            point[2] += rise * ((double)j + 0.5) / (double)m;
            add(output, point, area);
        }
}

/* Cuts a flat circle at the height z into rings, facing up (+1) or down. */
static void cut_end(cutter *output, const gn_pack_def *def, double z, double facing) {
    const double radius = 0.5 * def->diameter;
    const int64_t rings = parts(output, radius);
    for (int64_t j = 0; j < rings; j++) {
        double inner = radius * (double)j / (double)rings,
               outer = radius * (double)(j + 1) / (double)rings, at = 0.5 * (inner + outer);
        const int64_t n = 3 + parts(output, 2.0 * M_PI * at);
        double each = M_PI * (outer * outer - inner * inner) / (double)n;
        for (int64_t k = 0; k < n; k++) {
            double angle = 2.0 * M_PI * ((double)k + 0.5) / (double)n;
            add(output,
                (const double[3]){def->origin[0] + at * cos(angle),
                                  def->origin[1] + at * sin(angle), z},
                (const double[3]){0.0, 0.0, facing * each});
        }
    }
}

static void cut_cylinder(cutter *output, const gn_pack_def *def) {
    cut_round(output, def->origin, 0.5 * def->diameter, def->height, def->height,
              parts(output, def->height));
    cut_end(output, def, def->origin[2], -1.0);
    cut_end(output, def, def->origin[2] + def->height, 1.0);
}

static gneiss_status cut_facets(cutter *output, const gn_scene *scene, gneiss_error *error) {
    gn_mesh mesh;
    GN_TRY(gn_pack_shape_facets(scene, &mesh, error));
    const gn_mesh_elements *t = &mesh.triangles, *l = &mesh.lines;
    for (size_t k = 0; scene->dimension == 3 && k < t->count; k++) {
        const double *x[3];
        for (int a = 0; a < 3; a++) x[a] = mesh.node + 3 * (size_t)t->node[3 * k + (size_t)a];
        add_triangle(output, x);
    }
    for (size_t k = 0; scene->dimension == 2 && k < l->count; k++)
        add_edge(output, mesh.node + 3 * (size_t)l->node[2 * k],
                 mesh.node + 3 * (size_t)l->node[2 * k + 1]);
    gn_mesh_free(&mesh);
    return GNEISS_OK;
}

static gneiss_status cut(cutter *output, const gn_scene *scene, gneiss_error *error) {
    const gn_pack_def *def = &scene->specimen.pack;
    switch (def->shape) {
    case GN_SHAPE_RECTANGLE:
        cut_rectangle(output, def);
        break;
    case GN_SHAPE_DISC:
        cut_round(output, def->origin, 0.5 * def->diameter, 1.0, 0.0, 1);
        break;
    case GN_SHAPE_POLYGON:
        cut_polygon(output, def);
        break;
    case GN_SHAPE_BOX:
        cut_box(output, def);
        break;
    case GN_SHAPE_CYLINDER:
        cut_cylinder(output, def);
        break;
    case GN_SHAPE_SURFACE:
    case GN_SHAPE_MESH:
        return cut_facets(output, scene, error);
    case GN_SHAPE_NONE:
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "no shape that has a boundary");
    }
    return GNEISS_OK;
}

gneiss_status gn_boundary_pieces_make(const gn_scene *scene, double size,
                                      gn_boundary_pieces *pieces, gneiss_error *error) {
    cutter c = {.pieces = pieces, .size = size, .held = true};
    *pieces = (gn_boundary_pieces){0};
    gneiss_status status = cut(&c, scene, error);
    if (status == GNEISS_OK && !c.held)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the pieces of a boundary");
    if (status != GNEISS_OK) gn_boundary_pieces_free(pieces);
    return status;
}

void gn_boundary_pieces_free(gn_boundary_pieces *pieces) {
    gn_free(pieces->piece);
    *pieces = (gn_boundary_pieces){0};
}
