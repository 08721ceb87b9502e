/* Cook's membrane (Cook 1974) in plane strain: a tapered panel, clamped at the left, loaded by a
 * traction along its right side. */
#ifndef GN_TESTS_COOK_H
#define GN_TESTS_COOK_H

#include "fem_helpers.h"

/* The diagonals of the cells: alternating as on a chess-board, all from the lower left to the upper
 * right, or all in the other direction. */
typedef enum cook_cut { COOK_CHESS, COOK_RISING, COOK_FALLING } cook_cut;

/* Corners (0, 0), (48, 44), (48, 60), (0, 44). */
typedef struct cook {
    gn_fem_form form;
    cook_cut cut;
    double poisson;
    int cells; /* along each side */
} cook;

/* Part of the load of 100 N per metre of thickness that is applied, so small that all laws are
 * linear; results are scaled to the whole load. */
static const double cook_scale = 1e-4;

static inline gn_mesh cook_mesh(const cook *c) {
    const double unit[3] = {1.0, 1.0, 0.0};
    const int cells[3] = {c->cells, c->cells, 0};
    gn_mesh mesh = mesh_of(unit, cells, 0.0);
    for (size_t n = 0; n < mesh.node_count; n++) {
        double *x = mesh.node + 3 * n, s = x[0], t = x[1];
        x[0] = 48.0 * s;
        x[1] = (1.0 - t) * 44.0 * s + t * (44.0 + 16.0 * s);
    }
    /* Cells in rows, two triangles each. */
    const int32_t row = c->cells + 1;
    for (int32_t k = 0; c->cut != COOK_CHESS && k < c->cells * c->cells; k++) {
        const int32_t a = k / c->cells * row + k % c->cells, b = a + 1, d = a + row;
        const int32_t cut[2][6] = {{a, b, d + 1, a, d + 1, d}, {a, b, d, b, d + 1, d}};
        memcpy(mesh.triangles.node + 6 * k, cut[c->cut == COOK_FALLING], sizeof *cut);
    }
    return mesh;
}

/* The node at (column, row) of the grid. */
static inline size_t cook_node(const gn_fem_solid *body, int cells, int column, int row) {
    for (size_t n = 0; n < body->nodes.soa.count; n++)
        if (body->nodes.id[n] == row * (cells + 1) + column) return n;
    fail_msg("no node at column %d, row %d", column, row);
    return 0;
}

/* The loaded panel before its first step. */
static inline gn_fem_solid *cook_body(const cook *c) {
    const gn_fem_material m = {.young = 240.565, .poisson = c->poisson, .density = 1.0};
    const double rest[3] = {0.0}, traction[3] = {0.0, 6.25 * cook_scale, 0.0};
    gn_fem_spec spec = spec_of(2, &m);
    spec.form = c->form;
    spec.damping = GN_FX_VISCOUS;
    spec.damping_coefficient = 0.4; /* 1/s: about critical for the first mode */
    gn_fem_solid *body = body_of(&spec, cook_mesh(c));
    gn_fem_set set;
    int32_t motion;
    assert_int_equal(gn_fem_nodes_of_group(body, "x_lower", &set, NULL), GNEISS_OK);
    assert_int_equal(gn_fem_prescribe(body, &set, 3, rest, &motion, NULL), GNEISS_OK);
    gn_fem_set_free(&set);
    assert_int_equal(set_traction(body, "x_upper", traction, NULL), GNEISS_OK);
    return body;
}

/* Vertical displacement of the upper right corner under the whole load. */
static inline double cook_deflection(const gn_fem_solid *body, const cook *c) {
    const size_t tip = 4 * cook_node(body, c->cells, c->cells, c->cells) + 1;
    return (body->nodes.pos[tip] - body->nodes.start[tip]) / cook_scale;
}

/* Lets the body come to rest under its load: the corner moves by less than 1e-6 of its displacement
 * in four intervals of 5 s, about a quarter of the first period each. */
static inline gn_fem_solid *cook_at_rest(const cook *c) {
    gn_fem_solid *body = cook_body(c);
    const double dt = 0.95 * fem_limits(body).sharp;
    double before = 0.0;
    for (int quiet = 0; quiet < 4;) {
        for (double t = 0.0; t < 5.0; t += dt) fem_step(body, dt, false);
        double now = cook_deflection(body, c);
        if (!(fabs(now) < 100.0)) fail_msg("the panel does not come to rest");
        quiet = fabs(now - before) < 1e-6 * fabs(now) ? quiet + 1 : 0;
        before = now;
    }
    return body;
}

/* Pressures at nodes under the whole load, in rows of the grid; to be freed. */
static inline double *cook_pressure(const gn_fem_solid *body) {
    const size_t nodes = body->nodes.soa.count;
    double *place = calloc(nodes, sizeof *place), *grid = calloc(nodes, sizeof *grid);
    assert_int_equal(gn_fem_nodal_pressure(body, place, NULL), GNEISS_OK);
    for (size_t n = 0; n < nodes; n++) grid[body->nodes.id[n]] = place[n] / cook_scale;
    free(place);
    return grid;
}

/* Root mean square, over inner nodes, of the highest frequency of the grid, which changes sign from
 * node to node along both directions, relative to that of the pressure. */
static inline double cook_checkerboard(const double *p, int cells) {
    const int row = cells + 1;
    double high = 0.0, all = 0.0;
    for (int k = 0; k < row * row; k++) all += p[k] * p[k] / (row * row);
    for (int j = 1; j < cells; j++)
        for (int i = 1; i < cells; i++) {
            double sum = 0.0;
            for (int dj = -1; dj <= 1; dj++)
                for (int di = -1; di <= 1; di++)
                    sum += (dj ? -1 : 2) * (di ? -1 : 2) * p[(j + dj) * row + i + di] / 16.0;
            high += sum * sum / ((cells - 1) * (cells - 1));
        }
    return sqrt(high / all);
}

#endif
