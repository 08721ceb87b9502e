#include "fem/grid.h"

#include "base/memory.h"
#include "base/random.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

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

/* Tells whether a cell is mirrored: every second one; with parallel diagonals, those beyond the
 * turn. */
static bool is_mirrored(const gn_grid *grid, const size_t cell[3]) {
    if (grid->parallel) return grid->turn > 0 && cell[0] >= grid->turn;
    return (cell[0] + cell[1] + cell[2]) % 2;
}

/* Returns corner c of a cell: bit k is the step along direction k. In mirrored cells the numbers of
 * the corners are mirrored along x. */
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

/* One tetrahedron in the middle with four of the corners, and one at each of the others. */
static const split five = {
    5,
    {{0, 1, 3, 5}, {0, 3, 2, 6}, {0, 4, 5, 6}, {3, 6, 5, 7}, {0, 5, 3, 6}},
    {{{{0, 4, 6}, {0, 6, 2}}, {{1, 3, 5}, {3, 7, 5}}},
     {{{0, 1, 5}, {0, 5, 4}}, {{2, 6, 3}, {3, 6, 7}}},
     {{{0, 3, 1}, {0, 2, 3}}, {{4, 5, 6}, {5, 7, 6}}}},
};
/* One tetrahedron for each path along three edges from corner 0 to corner 7 (Kuhn 1960). These two
 * corners belong to six tetrahedra each and the others to two: the sum over the four corners of any
 * side is the same, so that node masses are equal where cells are mirrored, too. */
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

/* Tells whether a cell of the grid is left out. */
static bool in_hole(const gn_grid *grid, const size_t cell[3]) {
    for (int k = 0; k < grid->dimension; k++)
        if (cell[k] < grid->hole_lower[k] || cell[k] >= grid->hole_upper[k]) return false;
    return true;
}

/* Returns the group of a side of a cell; 0 if a cell follows it. */
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
            int side = k == 0 && mirror ? 1 - upper : upper; /* in the mirrored numbering */
            for (int f = 0; grid->dimension == 3 && f < 2; f++)
                add(&mesh->triangles, grid, cell, split_of(grid)->side[k][side][f], mirror, tag);
            if (grid->dimension == 2)
                add(&mesh->lines, grid, cell, side_line[k][side], mirror, tag);
        }
}

void gn_grid_fill(const gn_grid *grid, gn_mesh *mesh) {
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

void gn_grid_name_groups(const gn_grid *grid, gn_mesh *mesh) {
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

gneiss_status gn_grid_allocate(const gn_grid *grid, gn_mesh *mesh, gneiss_error *error) {
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
    GN_TRY(gn_grid_allocate(&g, mesh, error));
    place_nodes(&g, spec, mesh);
    gn_grid_fill(&g, mesh);
    gn_grid_name_groups(&g, mesh);
    return GNEISS_OK;
}

gneiss_status gn_mesh_rectangle(const gn_structured *spec, gn_mesh *mesh, gneiss_error *error) {
    return make(spec, 2, mesh, error);
}

gneiss_status gn_mesh_box(const gn_structured *spec, gn_mesh *mesh, gneiss_error *error) {
    return make(spec, 3, mesh, error);
}
