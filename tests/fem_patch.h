/* Homogeneous deformations of solids of finite elements with distorted meshes. */
#ifndef GN_TESTS_FEM_PATCH_H
#define GN_TESTS_FEM_PATCH_H

#include "fem_helpers.h"

static const double sizes[2][3] = {{1.0, 0.7, 0.0}, {1.0, 0.7, 0.8}};
static const int cells[2][3] = {{9, 6, 0}, {5, 4, 4}};

static inline double distortion_of(int d) {
    return d == 3 ? 0.16 : 0.24;
}

/* Kinds of bodies: plane or in space, both forms, diagonals alternating or parallel. */
enum { SPACE = 1, MIXED = 2, PARALLEL = 4, BODY_KINDS = 8 };

static inline int dimension_of(int kind) {
    return kind & SPACE ? 3 : 2;
}

static inline gn_mesh distorted_mesh(int kind) {
    const int d = dimension_of(kind);
    return split_mesh_of(sizes[d - 2], cells[d - 2], distortion_of(d), (kind & PARALLEL) != 0);
}

static inline gn_fem_solid *distorted_kind(int kind) {
    gn_fem_spec spec = spec_of(dimension_of(kind), &rock);
    spec.form = kind & MIXED ? GN_FEM_PRESSURE : GN_FEM_DISPLACEMENT;
    return body_of(&spec, distorted_mesh(kind));
}

static inline gn_fem_solid *distorted_body(int d, gn_fem_form form) {
    return distorted_kind((d == 3 ? SPACE : 0) | (form == GN_FEM_PRESSURE ? MIXED : 0));
}

/* x = F X for all nodes. */
static inline void place(gn_fem_solid *solid, double f[3][3]) {
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        for (int k = 0; k < solid->dimension; k++)
            solid->nodes.pos[4 * n + (size_t)k] = dot3(f[k], solid->nodes.start + 4 * n);
    gn_fem_positions_changed(solid);
}

static inline bool on_boundary(const gn_fem_solid *solid, size_t n) {
    const double *x = solid->nodes.start + 4 * n, *size = sizes[solid->dimension - 2];
    bool on = false;
    for (int k = 0; k < solid->dimension; k++) on = on || x[k] == 0.0 || x[k] == size[k];
    return on;
}

/* A homogeneous deformation with strains of about 1e-3. */
static inline void small_deformation(int d, double f[3][3]) {
    uint64_t at = 40;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            bool there = d == 3 || (i < 2 && k < 2);
            f[i][k] = (i == k ? 1.0 : 0.0) + (there ? uniform(&at, -1e-3, 1e-3) : 0.0);
        }
}

/* Cauchy stress of a homogeneous deformation, and the density of its energy: F S F^T/det F, in the
 * pressure form of the deviator alone and K (det F - 1) beside it. */
static inline double law(gn_fem_form form, double f[3][3], double sigma[3][3]) {
    const double mu = lame_mu(&rock), bulk = lame_lambda(&rock) + 2.0 / 3.0 * mu;
    const double growth = determinant(f) - 1.0;
    double s[3][3], lambda = form == GN_FEM_PRESSURE ? -2.0 / 3.0 * mu : lame_lambda(&rock);
    cauchy(f, lambda, mu, sigma);
    for (int k = 0; form == GN_FEM_PRESSURE && k < 3; k++) sigma[k][k] += bulk * growth;
    return kirchhoff(f, lambda, mu, s) +
           (form == GN_FEM_PRESSURE ? 0.5 * bulk * growth * growth : 0.0);
}

/* Stresses of all elements against F S F^T/det F; allowed in parts of Young's modulus. */
static inline void assert_stress(const gn_fem_solid *solid, double f[3][3], double allowed) {
    static const int at[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
    double sigma[3][3], (*stress)[6] = calloc(solid->elements.soa.count, sizeof *stress);
    law(solid->form, f, sigma);
    gn_fem_element_stress(solid, stress);
    for (size_t e = 0; e < solid->elements.soa.count; e++)
        for (int c = 0; c < 6; c++)
            assert_near(stress[e][c], sigma[at[c][0]][at[c][1]], allowed * rock.young);
    free(stress);
}

/* Positions have an error of 2^-53 in the solid's unit length and strains of 2^-53 over the size of
 * an element; slender ones add up a few. */
enum { ROUND_OFF = 64, DRIVE = 200 };
static inline double strain_round_off(int d) {
    return ROUND_OFF * 0x1p-53 * (d == 3 ? 5.0 : 9.0);
}

/* A distorted mesh under the small deformation `f`. */
static inline gn_fem_solid *deformed_kind(int kind, double f[3][3]) {
    gn_fem_solid *solid = distorted_kind(kind);
    small_deformation(dimension_of(kind), f);
    place(solid, f);
    return solid;
}

/* Moves the boundary nodes to F X in the given number of steps. */
static inline void drive_boundary(gn_fem_solid *solid, double f[3][3], double dt, int steps) {
    gn_fem_set set = {.node = calloc(solid->nodes.soa.count, sizeof(int32_t))};
    const double rest[3] = {0.0};
    int32_t motion;
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        if (on_boundary(solid, n)) set.node[set.count++] = (int32_t)n;
    assert_int_equal(gn_fem_prescribe(solid, &set, 7, rest, &motion, NULL), GNEISS_OK);
    for (size_t s = 0; s < set.count; s++) {
        const size_t node = (size_t)set.node[s], slot = (size_t)solid->nodes.slot[node];
        const double *x = solid->nodes.start + 4 * node;
        for (int k = 0; k < solid->dimension; k++)
            solid->prescribed.velocity[6 * slot + (size_t)k] =
                (dot3(f[k], x) - x[k]) / (dt * steps);
    }
    for (int s = 0; s < steps; s++) fem_step(solid, dt, false);
    gn_fem_set_velocity(solid, motion, rest);
    free(set.node);
}

#endif
