/* Bodies of finite elements and long-hand mechanics, for the tests. */
#ifndef GN_TESTS_FEM_HELPERS_H
#define GN_TESTS_FEM_HELPERS_H

#include "world_helpers.h"

#include "fem/fem.h"
#include "fem/structured.h"

static const gn_fem_material rock = {.young = 30e9, .poisson = 0.2, .density = 2600.0};

/* A rectangle (cells[2] = 0) or box with one corner at the origin. */
static inline gn_mesh split_mesh_of(const double size[3], const int cells[3], double distortion,
                                    bool parallel) {
    gn_structured s = {.distortion = distortion, .seed = 7, .parallel = parallel};
    gn_mesh mesh;
    gneiss_error error = {0};
    for (int k = 0; k < 3; k++) {
        s.size[k] = size[k];
        s.cells[k] = cells[k];
    }
    gneiss_status status =
        cells[2] ? gn_mesh_box(&s, &mesh, &error) : gn_mesh_rectangle(&s, &mesh, &error);
    if (status != GNEISS_OK) fail_msg("%s", error.message);
    return mesh;
}

static inline gn_mesh mesh_of(const double size[3], const int cells[3], double distortion) {
    return split_mesh_of(size, cells, distortion, false);
}

static inline gn_fem_spec spec_of(int dimension, const gn_fem_material *material) {
    return (gn_fem_spec){.name = "test mesh",
                         .dimension = dimension,
                         .materials = material,
                         .material_count = 1,
                         .threads = 1};
}

static inline gn_fem_solid *body_of(const gn_fem_spec *spec, gn_mesh mesh) {
    gn_fem_solid *solid = calloc(1, sizeof *solid);
    gneiss_error error = {0};
    if (gn_fem_solid_create(spec, &mesh, solid, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return solid;
}

static inline void body_end(gn_fem_solid *solid) {
    gn_fem_solid_free(solid);
    free(solid);
}

/* Loads the facets of a group with a traction, Pa. */
static inline gneiss_status set_traction(gn_fem_solid *solid, const char *group,
                                         const double traction[3], gneiss_error *error) {
    gn_fem_load load;
    GN_TRY(gn_fem_load_on_facets(solid, group, NULL, NULL, &load, error));
    gn_fem_set_loads(solid, &load, (const double(*)[3])traction, 1);
    gn_fem_load_free(&load);
    return GNEISS_OK;
}

static inline void fem_step(gn_fem_solid *solid, double dt, bool measure) {
    gneiss_error error = {0};
    if (gn_fem_step(solid, dt, measure, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

/* Forces and readings of the present positions; nothing moves in an interval of no length. */
static inline void fem_evaluate(gn_fem_solid *solid) {
    gn_fem_positions_changed(solid);
    fem_step(solid, 0.0, true);
}

static inline gn_fem_limit fem_limits(gn_fem_solid *solid) {
    gn_fem_limit limit;
    gneiss_error error = {0};
    if (gn_fem_limits(solid, 1e-6, &limit, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return limit;
}

/* Sums the force of the elements on a node from the partial sums. */
static inline void fem_force(const gn_partials *q, int32_t node, double force[3]) {
    size_t block = (size_t)node / GN_PARTICLE_BLOCK;
    for (int k = 0; k < 3; k++) force[k] = 0.0;
    for (int32_t s = q->start[block]; s < q->start[block + 1]; s++)
        for (int k = 0; q->share[s].particle == node && k < 3; k++)
            force[k] += q->row[4 * (size_t)q->share[s].row + (size_t)k];
}

/* out = a b */
static inline void multiply(double a[3][3], double b[3][3], double out[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[i][k] = a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k];
}

static inline double determinant(double f[3][3]) {
    return f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) -
           f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
           f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
}

static inline void invert(double a[3][3], double out[3][3]) {
    double det = determinant(a);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            int r = (k + 1) % 3, s = (k + 2) % 3, p = (i + 1) % 3, q = (i + 2) % 3;
            out[i][k] = (a[r][p] * a[s][q] - a[r][q] * a[s][p]) / det;
        }
}

/* St Venant-Kirchhoff: second Piola-Kirchhoff stress and energy density. */
static inline double kirchhoff(double f[3][3], double lambda, double mu, double s[3][3]) {
    double e[3][3], trace = 0.0, square = 0.0;
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
            double c = 0.0;
            for (int i = 0; i < 3; i++) c += f[i][k] * f[i][l];
            e[k][l] = 0.5 * (c - (k == l ? 1.0 : 0.0));
            square += e[k][l] * e[k][l];
        }
    for (int k = 0; k < 3; k++) trace += e[k][k];
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) s[k][l] = 2.0 * mu * e[k][l] + (k == l ? lambda * trace : 0.0);
    return 0.5 * lambda * trace * trace + mu * square;
}

/* Cauchy stress F S F^T/det F. */
static inline void cauchy(double f[3][3], double lambda, double mu, double sigma[3][3]) {
    double s[3][3], p[3][3];
    kirchhoff(f, lambda, mu, s);
    multiply(f, s, p);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            sigma[i][k] =
                (p[i][0] * f[k][0] + p[i][1] * f[k][1] + p[i][2] * f[k][2]) / determinant(f);
}

/* Rodrigues' rotation about `axis` (any length but zero). */
static inline void rotation(const double axis[3], double angle, double r[3][3]) {
    double size = sqrt(dot3(axis, axis)), c = cos(angle), s = sin(angle), n[3];
    for (int k = 0; k < 3; k++) n[k] = axis[k] / size;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r[i][k] = (1.0 - c) * n[i] * n[k] + (i == k ? c : 0.0);
    for (int k = 0; k < 3; k++) {
        r[(k + 1) % 3][k] += s * n[(k + 2) % 3];
        r[k][(k + 1) % 3] -= s * n[(k + 2) % 3];
    }
}

static inline double lame_mu(const gn_fem_material *m) {
    return 0.5 * m->young / (1.0 + m->poisson);
}
static inline double lame_lambda(const gn_fem_material *m) {
    return m->young * m->poisson / ((1.0 + m->poisson) * (1.0 - 2.0 * m->poisson));
}
/* lambda + 2 mu: stiffness without lateral strain. */
static inline double confined(const gn_fem_material *m) {
    return lame_lambda(m) + 2.0 * lame_mu(m);
}

/* Random velocities up to `speed` in every direction. */
static inline void stir(gn_fem_solid *solid, double speed) {
    uint64_t at = 3;
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        for (int k = 0; k < solid->dimension; k++)
            solid->nodes.vel[4 * n + (size_t)k] = speed * uniform(&at, -1.0, 1.0);
}

/* Returns the stored energy minus its initial value and the work done, plus the dissipation, of a
 * reading, J. */
static inline double energy_residual(const gn_fem_energy *energy) {
    return energy->kinetic + energy->elastic - energy->stored_at_start -
           (energy->work_prescribed + energy->work_applied + energy->work_gravity) +
           energy->damping;
}

#endif
