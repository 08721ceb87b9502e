/* Cook's membrane (Cook 1974) in plane strain: a tapered panel, clamped at the left, loaded by a
 * traction along its right side. */
#ifndef GN_TESTS_COOK_H
#define GN_TESTS_COOK_H

#include "fem_helpers.h"

/* Corners (0, 0), (48, 44), (48, 60), (0, 44). `scale`: part of the load of 100 N per metre of
 * thickness, so that strains stay in the range where all laws are the linear one. */
typedef struct cook {
    gn_fem_form form;
    double poisson, scale;
    int cells;    /* along each side */
    bool slanted; /* all cells are cut along the same diagonal, the long one */
} cook;

enum { COOK_YOUNG_MILLI = 240565 };

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
    const int32_t across = c->cells + 1;
    for (int32_t k = 0; c->slanted && k < c->cells * c->cells; k++) {
        int32_t first = k / c->cells * across + k % c->cells, *node = mesh.triangles.node + 6 * k;
        const int32_t cut[6] = {first, first + 1,          first + across + 1,
                                first, first + across + 1, first + across};
        memcpy(node, cut, sizeof cut);
    }
    return mesh;
}

/* Node of the upper right corner. */
static inline size_t cook_tip(const gn_fem_body *body) {
    size_t tip = 0;
    for (size_t n = 0; n < body->nodes.soa.count; n++) {
        const double *x = body->nodes.start + 4 * n, *best = body->nodes.start + 4 * tip;
        if (x[0] + x[1] > best[0] + best[1]) tip = n;
    }
    return tip;
}

/* The loaded panel before its first step. */
static inline gn_fem_body *cook_body(const cook *c) {
    const gn_fem_material m = {
        .young = 1e-3 * COOK_YOUNG_MILLI, .poisson = c->poisson, .density = 1.0};
    const double rest[3] = {0.0}, traction[3] = {0.0, 6.25 * c->scale, 0.0};
    gn_fem_spec spec = spec_of(2, &m);
    spec.form = c->form;
    spec.damping = GN_FX_VISCOUS;
    spec.damping_coefficient = 0.4; /* 1/s: about critical for the first mode */
    gn_fem_body *body = body_of(&spec, cook_mesh(c));
    gn_fem_set set;
    int32_t motion;
    assert_int_equal(gn_fem_nodes_of_group(body, "x_lower", &set, NULL), GNEISS_OK);
    assert_int_equal(gn_fem_prescribe(body, &set, 3, rest, &motion, NULL), GNEISS_OK);
    gn_fem_set_free(&set);
    assert_int_equal(gn_fem_add_traction(body, "x_upper", traction, NULL), GNEISS_OK);
    return body;
}

/* At rest under its load. */
static inline gn_fem_body *cook_at_rest(const cook *c) {
    gn_fem_body *body = cook_body(c);
    const size_t tip = cook_tip(body);
    const double dt = 0.95 * fem_limits(body).sharp, *y = body->nodes.pos + 4 * tip + 1;
    double before = *y;
    /* Changes of a quarter of a period or so. */
    for (int quiet = 0; quiet < 4;) {
        for (double t = 0.0; t < 5.0; t += dt) fem_step(body, dt, false);
        double moved = fabs(*y - before), all = fabs(*y - body->nodes.start[4 * tip + 1]);
        quiet = moved < 1e-6 * all ? quiet + 1 : 0;
        before = *y;
        if (!(all < 100.0)) fail_msg("the panel does not come to rest");
    }
    return body;
}

/* Vertical displacement of the tip under the whole load. */
static inline double cook_deflection(const gn_fem_body *body, const cook *c) {
    const size_t tip = 4 * cook_tip(body) + 1;
    return (body->nodes.pos[tip] - body->nodes.start[tip]) / c->scale;
}

#endif
