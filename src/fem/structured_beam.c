/* The built-in mesh of a beam for three-point bending. */
#include "base/memory.h"
#include "fem/grid.h"
#include "fem/internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Positions along one direction, ascending. */
typedef struct places {
    size_t count, capacity;
    double *at;
} places;

/* The size of cells at a distance from the finest: least + (growth - 1) x distance, up to most. */
typedef struct grading {
    double least, slope, most;
} grading;

/* --- grading --- */

/* Returns the distance up to which cells grow. */
static double growing(const grading *sizes) {
    return (sizes->most - sizes->least) / sizes->slope;
}

/* Returns the number of cells between the finest position and a distance from it: the integral of
 * 1/size. */
static double cells_to(const grading *sizes, double distance) {
    double grown = fmin(distance, growing(sizes));
    return log1p(sizes->slope * grown / sizes->least) / sizes->slope +
           (distance - grown) / sizes->most;
}

static double distance_of(const grading *sizes, double cells) {
    double grown = cells_to(sizes, growing(sizes));
    if (cells > grown) return growing(sizes) + (cells - grown) * sizes->most;
    return expm1(sizes->slope * cells) * sizes->least / sizes->slope;
}

static bool append(places *list, double at) {
    if (list->count == list->capacity) {
        size_t more = list->capacity ? 2 * list->capacity : 64;
        double *wider = realloc(list->at, more * sizeof *wider);
        if (!wider) return false;
        list->at = wider;
        list->capacity = more;
    }
    list->at[list->count++] = at;
    return true;
}

/* Divides the range between two distances; both become positions, the first of which is already
 * there. */
static bool divide(const grading *sizes, double from, double to, places *list) {
    if (!(to - from > 1e-12 * to)) return true;
    double first = cells_to(sizes, from), last = cells_to(sizes, to);
    double parts = ceil(last - first - 1e-9);
    for (double k = 1.0; k < parts; k++)
        if (!append(list, distance_of(sizes, first + (last - first) * k / parts))) return false;
    return append(list, to);
}

/* --- lines of the grid --- */

typedef struct beam {
    const gn_structured_beam *spec;
    grading grading;
    places x, y, z;
    size_t middle, left, right, mouth_left, mouth_right; /* in x */
    size_t tip;                                          /* in y */
} beam;

static bool notched(const gn_structured_beam *spec) {
    return spec->notch_depth > 0.0;
}

/* Makes the right half from mid-span, then both. */
static bool make_x(beam *shape) {
    const gn_structured_beam *s = shape->spec;
    const grading *g = &shape->grading;
    const double face = notched(s) ? 0.5 * s->notch_width : 0.0;
    places half = {0};
    bool held = append(&half, 0.0);
    for (int64_t k = 1; held && face > 0.0 && k <= s->notch_cells; k++)
        held = append(&half, face * (double)k / (double)s->notch_cells);
    size_t mouth = half.count - 1, inside = half.count;
    held = held && divide(g, 0.0, 0.5 * s->span - face, &half);
    size_t support = half.count - 1;
    held = held && divide(g, 0.5 * s->span - face, 0.5 * s->length - face, &half);
    for (size_t k = inside; k < half.count; k++) half.at[k] += face; /* measured from the middle */
    shape->middle = half.count - 1;
    for (size_t k = half.count; held && k-- > 1;)
        held = append(&shape->x, s->lower[0] + (0.5 * s->length - half.at[k]));
    for (size_t k = 0; held && k < half.count; k++)
        held = append(&shape->x, s->lower[0] + (0.5 * s->length + half.at[k]));
    shape->left = shape->middle - support;
    shape->right = shape->middle + support;
    shape->mouth_left = shape->middle - mouth;
    shape->mouth_right = shape->middle + mouth;
    free(half.at);
    return held;
}

static bool make_y(beam *shape) {
    const gn_structured_beam *s = shape->spec;
    places down = {0};
    bool held = append(&down, 0.0) && divide(&shape->grading, 0.0, s->notch_depth, &down);
    for (size_t k = down.count; held && k-- > 0;)
        held = append(&shape->y, s->lower[1] + (s->notch_depth - down.at[k]));
    free(down.at);
    shape->tip = shape->y.count - 1;
    held = held && divide(&shape->grading, 0.0, s->height - s->notch_depth, &shape->y);
    for (size_t k = shape->tip + 1; held && k < shape->y.count; k++)
        shape->y.at[k] += s->lower[1] + s->notch_depth;
    return held;
}

static bool make_z(beam *shape) {
    const gn_structured_beam *s = shape->spec;
    double layers = ceil(s->thickness / s->cell - 1e-9);
    bool held = append(&shape->z, s->thickness > 0.0 ? s->lower[2] : 0.0);
    for (double k = 1.0; held && k <= layers; k++)
        held = append(&shape->z, s->lower[2] + s->thickness * k / layers);
    return held;
}

static gneiss_status make_lines(beam *shape, gneiss_error *error) {
    const gn_structured_beam *s = shape->spec;
    double finest = s->cell;
    if (notched(s)) finest = fmin(finest, 0.5 * s->notch_width / (double)s->notch_cells);
    shape->grading = (grading){finest, s->growth - 1.0, s->cell};
    if (!make_x(shape) || !make_y(shape) || !make_z(shape))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the mesh of a beam");
    double nodes = (double)shape->x.count * (double)shape->y.count * (double)shape->z.count;
    if (6.0 * nodes < INT32_MAX) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "beam: expected less than 2^31/6 nodes, found %g",
                   nodes);
}

/* --- mesh --- */

static size_t node_at(const beam *shape, size_t x, size_t y, size_t z) {
    return (z * shape->y.count + y) * shape->x.count + x;
}

static void place_nodes(const beam *shape, gn_mesh *mesh) {
    for (size_t z = 0; z < shape->z.count; z++)
        for (size_t y = 0; y < shape->y.count; y++)
            for (size_t x = 0; x < shape->x.count; x++) {
                double *at = mesh->node + 3 * node_at(shape, x, y, z);
                at[0] = shape->x.at[x];
                at[1] = shape->y.at[y];
                at[2] = shape->z.at[z];
            }
}

/* Adds a point, or a line along z, at a position of the section. */
static void add_mark(const beam *shape, gn_mesh *mesh, size_t x, size_t y, int32_t tag) {
    bool solid = shape->z.count > 1;
    gn_mesh_elements *list = solid ? &mesh->lines : &mesh->points;
    for (size_t z = 0; z + 1 < shape->z.count || z == 0; z++) {
        int32_t *node = list->node + (size_t)list->nodes * list->count;
        node[0] = (int32_t)node_at(shape, x, y, z);
        if (solid) node[1] = (int32_t)node_at(shape, x, y, z + 1);
        list->group[list->count++] = tag;
    }
}

enum { SUPPORT_LEFT = GN_GRID_HOLE + 1, SUPPORT_RIGHT, LOAD, MOUTH_LEFT, MOUTH_RIGHT, SUPPORTS };

static gneiss_status add_marks(const beam *shape, gn_mesh *mesh, gneiss_error *error) {
    gn_mesh_elements *list = shape->z.count > 1 ? &mesh->lines : &mesh->points;
    size_t most = 5 * shape->z.count;
    gn_free(list->node);
    gn_free(list->group);
    list->node = gn_alloc_array(most, (size_t)list->nodes * sizeof *list->node);
    list->group = gn_alloc_array(most, sizeof *list->group);
    list->also = gn_alloc_array(most, sizeof *list->also);
    if (!list->node || !list->group || !list->also)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the groups of a beam");
    add_mark(shape, mesh, shape->left, 0, SUPPORT_LEFT);
    add_mark(shape, mesh, shape->right, 0, SUPPORT_RIGHT);
    list->also_count = list->count;
    for (size_t k = 0; k < list->count; k++) list->also[k] = (gn_mesh_membership){k, SUPPORTS};
    add_mark(shape, mesh, shape->middle, shape->y.count - 1, LOAD);
    if (!notched(shape->spec)) return GNEISS_OK;
    add_mark(shape, mesh, shape->mouth_left, 0, MOUTH_LEFT);
    add_mark(shape, mesh, shape->mouth_right, 0, MOUTH_RIGHT);
    return GNEISS_OK;
}

static int by_dimension_and_tag(const void *a, const void *b) {
    const gn_mesh_group *p = a, *q = b;
    return p->dimension != q->dimension ? p->dimension - q->dimension : p->tag - q->tag;
}

static void add_names(const beam *shape, int dimension, gn_mesh *mesh) {
    const gn_mesh_group marks[] = {
        {dimension - 2, SUPPORT_LEFT, "support_left"},
        {dimension - 2, SUPPORT_RIGHT, "support_right"},
        {dimension - 2, LOAD, "load"},
        {dimension - 2, SUPPORTS, "supports"},
        {dimension - 1, GN_GRID_HOLE, "notch"},
        {dimension - 2, MOUTH_LEFT, "mouth_left"},
        {dimension - 2, MOUTH_RIGHT, "mouth_right"},
    };
    size_t count = notched(shape->spec) ? 7 : 4;
    memcpy(mesh->groups + mesh->group_count, marks, count * sizeof *marks);
    mesh->group_count += count;
    qsort(mesh->groups, mesh->group_count, sizeof *mesh->groups, by_dimension_and_tag);
}

/* Leaves out the nodes that only cells of the notch used. */
static gneiss_status drop_unused(int dimension, gn_mesh *mesh, gneiss_error *error) {
    const gn_mesh_elements *solids = gn_fem_elements_of(mesh, dimension);
    int32_t *place = gn_alloc_array(mesh->node_count + 1, sizeof *place), kept = 0;
    if (!place) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the mesh of a beam");
    for (size_t k = 0; k < solids->count * (size_t)solids->nodes; k++) place[solids->node[k]] = 1;
    for (size_t n = 0; n < mesh->node_count; n++) {
        if (!place[n]) continue;
        memmove(mesh->node + 3 * (size_t)kept, mesh->node + 3 * n, 3 * sizeof *mesh->node);
        place[n] = kept++;
    }
    mesh->node_count = (size_t)kept;
    for (int d = 0; d <= dimension; d++) {
        gn_mesh_elements *list = gn_fem_elements_of(mesh, d);
        for (size_t k = 0; k < list->count * (size_t)list->nodes; k++)
            list->node[k] = place[list->node[k]];
    }
    gn_free(place);
    return GNEISS_OK;
}

static gneiss_status check(const gn_structured_beam *spec, gneiss_error *error) {
    bool good = spec->length > 0.0 && spec->height > 0.0 && spec->thickness >= 0.0 &&
                spec->span > 0.0 && spec->span <= spec->length && spec->cell > 0.0 &&
                spec->growth > 1.0 && spec->notch_depth >= 0.0 && spec->notch_depth < spec->height;
    if (good && notched(spec))
        good = spec->notch_cells > 0 && spec->notch_width > 0.0 && spec->notch_width < spec->span;
    if (good) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "beam: expected lengths > 0, a span up to the length, growth > 1, a notch "
                   "inside the span and below the height; found length %g m, height %g m, span %g "
                   "m, cell %g m, growth %g, notch %g m wide and %g m deep",
                   spec->length, spec->height, spec->span, spec->cell, spec->growth,
                   spec->notch_width, spec->notch_depth);
}

static gneiss_status make(beam *shape, gn_mesh *mesh, gneiss_error *error) {
    const gn_structured_beam *s = shape->spec;
    GN_TRY(make_lines(shape, error));
    gn_grid g = {.dimension = s->thickness > 0.0 ? 3 : 2,
                 .nodes = {shape->x.count, shape->y.count, shape->z.count},
                 .parallel = s->parallel,
                 .turn = shape->middle};
    if (notched(s)) {
        g.hole_lower[0] = shape->mouth_left;
        g.hole_upper[0] = shape->mouth_right;
        g.hole_upper[1] = shape->tip;
        g.hole_upper[2] = shape->z.count;
    }
    GN_TRY(gn_grid_allocate(&g, mesh, error));
    place_nodes(shape, mesh);
    gn_grid_fill(&g, mesh);
    gn_grid_name_groups(&g, mesh);
    add_names(shape, g.dimension, mesh);
    gneiss_status status = add_marks(shape, mesh, error);
    if (status == GNEISS_OK) status = drop_unused(g.dimension, mesh, error);
    if (status != GNEISS_OK) gn_mesh_free(mesh);
    return status;
}

gneiss_status gn_mesh_beam(const gn_structured_beam *spec, gn_mesh *mesh, gneiss_error *error) {
    beam b = {.spec = spec};
    memset(mesh, 0, sizeof *mesh);
    GN_TRY(check(spec, error));
    gneiss_status status = make(&b, mesh, error);
    free(b.x.at);
    free(b.y.at);
    free(b.z.at);
    return status;
}
