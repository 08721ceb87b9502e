#include "fem/structured.h"
#include "base/new.h"
#include "base/random.h"
#include "fem/internal.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Tags of groups. That of the upper or lower side across axis k is GN_GRID_SIDE + 2 k + upper. */
enum { GN_GRID_BODY = 1, GN_GRID_SIDE = 2, GN_GRID_HOLE = 8, GN_GRID_GROUPS_MAX = 16 };

typedef struct gn_grid {
    int dimension;
    size_t nodes[3];                     /* cells per direction; 1 along z in 2D */
    size_t hole_lower[3], hole_upper[3]; /* cells [lower, upper) are omitted */
    bool parallel;                       /* all diagonals have one direction */
    size_t turn; /* parallel: index of the first mirrored cell along x; 0: none is */
} gn_grid;

static size_t node_at(const gn_grid *grid, const size_t at[3]) {
    return (at[2] * grid->nodes[1] + at[1]) * grid->nodes[0] + at[0];
}

static gneiss_status check(const gn_structured *spec, int dimension, gneiss_error *error) {
    double cells = 1.0, most = dimension == 3 ? 1.0 / 6.0 : 0.25;
    for (int k = 0; k < dimension; k++) {
        if (spec->cells[k] < 1 || !(spec->size[k] > 0.0))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "structured mesh: expected a size > 0 and at least one cell along %c, "
                           "found %g m, %d cells",
                           "xyz"[k], spec -> size[k], spec -> cells[k]);
        cells *= spec->cells[k] + 1.0;
    }
    if (!(spec->distortion >= 0.0 && spec->distortion < most))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "structured mesh: expected a distortion from 0 to below %g, found %g", most,
                       spec->distortion);
    if (cells * 6.0 > INT32_MAX)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "structured mesh: expected less than 2^31/6 nodes, found %g", cells);
    return GNEISS_OK;
}

static void place_nodes(const gn_grid *grid, const gn_structured *spec, gn_mesh *mesh) {
    size_t at[3];
    for (at[2] = 0; at[2] < grid->nodes[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->nodes[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->nodes[0]; at[0]++) {
                size_t n = node_at(grid, at);
                for (size_t k = 0; k < (size_t)grid->dimension; k++) {
                    double cells = spec->cells[k], place = (double)at[k] / cells;
                    if (spec->distortion > 0.0 && at[k] > 0 && at[k] + 1 < grid->nodes[k])
                        place +=
                            spec->distortion * gn_random_symmetric(spec->seed, 3 * n + k) / cells;
                    mesh->node[3 * n + k] = spec->lower[k] + spec->size[k] * place;
                }
            }
}

/* Tells whether a cell is mirrored: every second cell is; with parallel diagonals, those beyond
 * `turn` are. */
static bool is_mirrored(const gn_grid *grid, const size_t cell[3]) {
    if (grid->parallel) return grid->turn > 0 && cell[0] >= grid->turn;
    return (cell[0] + cell[1] + cell[2]) % 2;
}

/* Returns corner c of a cell; bit k of c is the position along direction k. In mirrored cells the
 * numbering of the corners is mirrored along x. */
static int32_t corner(const gn_grid *grid, const size_t cell[3], int c) {
    size_t at[3];
    for (size_t k = 0; k < 3; k++) at[k] = cell[k] + ((size_t)c >> k & 1);
    if (is_mirrored(grid, cell)) at[0] = cell[0] + 1 - ((size_t)c & 1);
    return (int32_t)node_at(grid, at);
}

static void add(gn_mesh_elements *list, const gn_grid *grid, const size_t cell[3],
                const int *corners, bool mirror, int32_t tag) {
    int32_t *node = list->node + (size_t)list->nodes * list->count;
    for (int k = 0; k < list->nodes; k++) node[k] = corner(grid, cell, corners[k]);
    if (mirror) {
        int32_t first = node[0];
        node[0] = node[1];
        node[1] = first;
    }
    list->group[list->count++] = tag;
}

static const int triangle[2][3] = {{0, 1, 3}, {0, 3, 2}};

/* The split of a cell in 3D: its tetrahedra, and the two triangles on side `direction`, lower or
 * upper. */
typedef struct split {
    int count, tetrahedron[6][4], side[3][2][2][3];
} split;

/* Five tetrahedra: one in the middle between four of the corners, and one at each of the other
 * corners. */
static const split five = {
    5,
    {{0, 1, 3, 5}, {0, 3, 2, 6}, {0, 4, 5, 6}, {3, 6, 5, 7}, {0, 5, 3, 6}},
    {{{{0, 4, 6}, {0, 6, 2}}, {{1, 3, 5}, {3, 7, 5}}},
     {{{0, 1, 5}, {0, 5, 4}}, {{2, 6, 3}, {3, 6, 7}}},
     {{{0, 3, 1}, {0, 2, 3}}, {{4, 5, 6}, {5, 7, 6}}}},
};
/* Six tetrahedra: one for each path along three edges from corner 0 to corner 7 (Kuhn 1960). These
 * two corners belong to six tetrahedra each and the others to two. The sum over the four corners of
 * any side is the same, so that node masses are equal where cells are mirrored, too. */
static const split six = {
    6,
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}},
    {{{{0, 4, 6}, {0, 6, 2}}, {{1, 3, 7}, {1, 7, 5}}},
     {{{0, 1, 5}, {0, 5, 4}}, {{2, 6, 7}, {2, 7, 3}}},
     {{{0, 3, 1}, {0, 2, 3}}, {{4, 5, 7}, {4, 7, 6}}}},
};

static const split *split_of(const gn_grid *grid) {
    return grid->parallel ? &six : &five;
}

static const int side_line[2][2][2] = {{{2, 0}, {1, 3}}, {{0, 1}, {3, 2}}};

/* Tells whether a cell of the grid is omitted. */
static bool in_hole(const gn_grid *grid, const size_t cell[3]) {
    for (int k = 0; k < grid->dimension; k++)
        if (cell[k] < grid->hole_lower[k] || cell[k] >= grid->hole_upper[k]) return false;
    return true;
}

/* Returns the group of a side of a cell; 0: another cell follows. */
static int32_t side_tag(const gn_grid *grid, const size_t cell[3], int k, int upper) {
    size_t other[3] = {cell[0], cell[1], cell[2]};
    if (cell[k] == (upper ? grid->nodes[k] - 2 : 0)) return GN_GRID_SIDE + 2 * k + upper;
    other[k] = upper ? cell[k] + 1 : cell[k] - 1;
    return in_hole(grid, other) ? GN_GRID_HOLE : 0;
}

static void add_sides(const gn_grid *grid, gn_mesh *mesh, const size_t cell[3], bool mirror) {
    for (int k = 0; k < grid->dimension; k++)
        for (int upper = 0; upper < 2; upper++) {
            int32_t tag = side_tag(grid, cell, k, upper);
            if (!tag) continue;
            int side =
                k == 0 && mirror ? 1 - upper : upper; /* the side in the mirrored numbering */
            for (int f = 0; grid->dimension == 3 && f < 2; f++)
                add(&mesh->triangles, grid, cell, split_of(grid)->side[k][side][f], mirror, tag);
            if (grid->dimension == 2)
                add(&mesh->lines, grid, cell, side_line[k][side], mirror, tag);
        }
}

/* Fills in elements and facets; nodes inside the hole have no element. */
static void grid_fill(const gn_grid *grid, gn_mesh *mesh) {
    const split *solid = split_of(grid);
    size_t cell[3], layers = grid->dimension == 3 ? grid->nodes[2] - 1 : 1;
    for (cell[2] = 0; cell[2] < layers; cell[2]++)
        for (cell[1] = 0; cell[1] + 1 < grid->nodes[1]; cell[1]++)
            for (cell[0] = 0; cell[0] + 1 < grid->nodes[0]; cell[0]++) {
                if (in_hole(grid, cell)) continue;
                bool mirror = is_mirrored(grid, cell);
                for (int e = 0; grid->dimension == 3 && e < solid->count; e++)
                    add(&mesh->tetrahedra, grid, cell, solid->tetrahedron[e], mirror, GN_GRID_BODY);
                for (int e = 0; grid->dimension == 2 && e < 2; e++)
                    add(&mesh->triangles, grid, cell, triangle[e], mirror, GN_GRID_BODY);
                add_sides(grid, mesh, cell, mirror);
            }
}

/* Names the groups "x_lower" ... and "body". */
static void grid_name_groups(const gn_grid *grid, gn_mesh *mesh) {
    gn_mesh_group *group = mesh->groups;
    for (int k = 0; k < 2 * grid->dimension; k++, group++) {
        *group = (gn_mesh_group){.dimension = grid->dimension - 1, .tag = GN_GRID_SIDE + k};
        snprintf(group->name, sizeof group->name, "%c_%s", "xyz"[k / 2], k % 2 ? "upper" : "lower");
    }
    *group = (gn_mesh_group){.dimension = grid->dimension, .tag = GN_GRID_BODY, .name = "body"};
    mesh->group_count = 2 * (size_t)grid->dimension + 1;
}

static bool allocate_list(gn_mesh_elements *list, int nodes, size_t count) {
    list->nodes = nodes;
    list->node = gn_alloc_array(count + 1, (size_t)nodes * sizeof *list->node);
    list->group = gn_alloc_array(count + 1, sizeof *list->group);
    return list->node && list->group;
}

/* Allocates the nodes, elements, sides and groups of the grid. On failure *mesh is empty. */
static gneiss_status grid_allocate(const gn_grid *grid, gn_mesh *mesh, gneiss_error *error) {
    size_t cells = 1, sides = 0;
    for (int k = 0; k < grid->dimension; k++) cells *= grid->nodes[k] - 1;
    for (int k = 0; k < grid->dimension; k++) {
        sides += 2 * (cells / (grid->nodes[k] - 1));
        sides += 2 * (grid->hole_upper[k] > 0 ? cells / (grid->nodes[k] - 1) : 0);
    }
    memset(mesh, 0, sizeof *mesh);
    mesh->node_count = grid->nodes[0] * grid->nodes[1] * grid->nodes[2];
    mesh->node = gn_alloc_array(mesh->node_count, 3 * sizeof *mesh->node);
    mesh->groups = gn_alloc_array(GN_GRID_GROUPS_MAX, sizeof *mesh->groups);
    bool solid = grid->dimension == 3;
    bool held = mesh->node && mesh->groups && allocate_list(&mesh->points, 1, 0);
    held = held && allocate_list(&mesh->lines, 2, solid ? 0 : sides);
    held = held && allocate_list(&mesh->triangles, 3, solid ? 2 * sides : 2 * cells);
    size_t solids = solid ? (size_t)split_of(grid)->count * cells : 0;
    held = held && allocate_list(&mesh->tetrahedra, 4, solids);
    if (held) return GNEISS_OK;
    gn_mesh_free(mesh);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mesh of %zu cells", cells);
}

static gneiss_status make(const gn_structured *spec, int dimension, gn_mesh *mesh,
                          gneiss_error *error) {
    gn_grid g = {.dimension = dimension, .nodes = {1, 1, 1}, .parallel = spec->parallel};
    memset(mesh, 0, sizeof *mesh);
    GN_TRY(check(spec, dimension, error));
    for (int k = 0; k < dimension; k++) g.nodes[k] = (size_t)spec->cells[k] + 1;
    GN_TRY(grid_allocate(&g, mesh, error));
    place_nodes(&g, spec, mesh);
    grid_fill(&g, mesh);
    grid_name_groups(&g, mesh);
    return GNEISS_OK;
}

gneiss_status gn_mesh_rectangle(const gn_structured *spec, gn_mesh *mesh, gneiss_error *error) {
    return make(spec, 2, mesh, error);
}

gneiss_status gn_mesh_box(const gn_structured *spec, gn_mesh *mesh, gneiss_error *error) {
    return make(spec, 3, mesh, error);
}

/* ---- the built-in mesh of a beam for three-point bending ---- */

/* Positions along one direction, ascending. */
typedef struct places {
    size_t count, capacity;
    double *at;
} places;

/* Size of cells at a distance from the finest ones: least + (growth - 1) x distance, at most
 * `most`. */
typedef struct grading {
    double least, slope, most;
} grading;

/* --- grading --- */

/* Returns the distance at which the size reaches `most`. */
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

/* Divides the range between two distances and appends the positions; the first of them is stored
 * already. */
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

/* Makes the positions along x: the right half from mid-span, then its mirror image. */
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
    for (size_t k = inside; k < half.count; k++)
        half.at[k] += face; /* distances are measured from the middle */
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

static size_t beam_node_at(const beam *shape, size_t x, size_t y, size_t z) {
    return (z * shape->y.count + y) * shape->x.count + x;
}

static void place_beam_nodes(const beam *shape, gn_mesh *mesh) {
    for (size_t z = 0; z < shape->z.count; z++)
        for (size_t y = 0; y < shape->y.count; y++)
            for (size_t x = 0; x < shape->x.count; x++) {
                double *at = mesh->node + 3 * beam_node_at(shape, x, y, z);
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
        node[0] = (int32_t)beam_node_at(shape, x, y, z);
        if (solid) node[1] = (int32_t)beam_node_at(shape, x, y, z + 1);
        list->group[list->count++] = tag;
    }
}

enum { SUPPORT_LEFT = GN_GRID_HOLE + 1, SUPPORT_RIGHT, LOAD, MOUTH_LEFT, MOUTH_RIGHT, SUPPORTS };

static gneiss_status add_marks(const beam *shape, gn_mesh *mesh, gneiss_error *error) {
    gn_mesh_elements *list = shape->z.count > 1 ? &mesh->lines : &mesh->points;
    const size_t most = 5 * shape->z.count;
    gn_free(list->node);
    gn_free(list->group);
    GN_TRY(gn_new(&list->node, most * (size_t)list->nodes, "nodes of groups", error));
    GN_TRY(gn_new(&list->group, most, "elements of groups", error));
    GN_TRY(gn_new(&list->also, most, "elements of groups", error));
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

/* Drops the nodes that only cells of the notch used. */
static gneiss_status drop_unused(int dimension, gn_mesh *mesh, gneiss_error *error) {
    const gn_mesh_elements *solids = gn_fem_elements_of(mesh, dimension);
    int32_t kept = 0;
    GN_FREED int32_t *place = NULL;
    GN_TRY(gn_new(&place, mesh->node_count, "nodes of a mesh", error));
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
    return GNEISS_OK;
}

static gneiss_status check_beam(const gn_structured_beam *spec, gneiss_error *error) {
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

static gneiss_status make_beam(beam *shape, gn_mesh *mesh, gneiss_error *error) {
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
    GN_TRY(grid_allocate(&g, mesh, error));
    place_beam_nodes(shape, mesh);
    grid_fill(&g, mesh);
    grid_name_groups(&g, mesh);
    add_names(shape, g.dimension, mesh);
    gneiss_status status = add_marks(shape, mesh, error);
    if (status == GNEISS_OK) status = drop_unused(g.dimension, mesh, error);
    if (status != GNEISS_OK) gn_mesh_free(mesh);
    return status;
}

gneiss_status gn_mesh_beam(const gn_structured_beam *spec, gn_mesh *mesh, gneiss_error *error) {
    beam b = {.spec = spec};
    memset(mesh, 0, sizeof *mesh);
    GN_TRY(check_beam(spec, error));
    gneiss_status status = make_beam(&b, mesh, error);
    free(b.x.at);
    free(b.y.at);
    free(b.z.at);
    return status;
}
