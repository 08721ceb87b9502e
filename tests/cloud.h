/* Points, lattices and particles made of them for the tests of the measures. */
#ifndef GN_TESTS_CLOUD_H
#define GN_TESTS_CLOUD_H

#include "measure/measure.h"

enum { POINTS_MAX = 4000 };

/* Points to be made into particles: x y z radius. */
typedef struct cloud {
    size_t count;
    double row[POINTS_MAX][4];
} cloud;

static cloud points; /* too large for the stack of a test; every test resets it */

static void cloud_add(double x, double y, double z, double r) {
    assert_true(points.count < POINTS_MAX);
    double row[4] = {x, y, z, r};
    memcpy(points.row[points.count++], row, sizeof row);
}

static double random_unit(void) {
    return rand() / (RAND_MAX + 1.0);
}

static void cloud_random(size_t count, int dimension) {
    points.count = 0;
    srand(12);
    for (size_t k = 0; k < count; k++) {
        double x = random_unit(), y = random_unit(), z = random_unit();
        cloud_add(0.3 + 0.02 * x, -0.1 + 0.03 * y, dimension == 3 ? 0.05 * z : 0,
                  1e-3 * (0.5 + random_unit()));
    }
}

typedef struct lattice {
    const char *name;
    int dimension, cells;
    double cell[3]; /* edges of a rectangular cell, relative to a = 1 */
    int basis_count;
    double basis[4][3];
    double radius, coordination, solid; /* spheres that touch; solid volume fraction */
} lattice;

static const lattice lattices[] = {
    {"simple cubic", 3, 4, {1, 1, 1}, 1, {{0, 0, 0}}, 0.5, 6, M_PI / 6},
    {"body-centred cubic",
     3,
     4,
     {1, 1, 1},
     2,
     {{0, 0, 0}, {.5, .5, .5}},
     0.43301270189221932,
     8,
     M_PI * 0.21650635094610966},
    {"face-centred cubic",
     3,
     3,
     {1, 1, 1},
     4,
     {{0, 0, 0}, {.5, .5, 0}, {.5, 0, .5}, {0, .5, .5}},
     0.35355339059327376,
     12,
     M_PI * 0.23570226039551584},
    {"square", 2, 4, {1, 1, 1}, 1, {{0, 0, 0}}, 0.5, 4, M_PI / 4},
    {"hexagonal",
     2,
     4,
     {1, 1.7320508075688773, 1},
     2,
     {{0, 0, 0}, {.5, .5, 0}},
     0.5,
     6,
     M_PI * 0.28867513459481288},
};
enum { LATTICES = sizeof lattices / sizeof *lattices };

/* `scale` is the edge of a cell; `closed` adds the points on the far faces. */
static inline void cloud_lattice(const lattice *l, double scale, bool closed) {
    int n = l->cells + closed;
    points.count = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < (l->dimension == 3 ? n : 1); k++)
                for (int b = 0; b < l->basis_count; b++) {
                    double x[3] = {l->cell[0] * (i + l->basis[b][0]),
                                   l->cell[1] * (j + l->basis[b][1]),
                                   l->cell[2] * (k + l->basis[b][2])};
                    bool inside = true;
                    for (int a = 0; a < l->dimension; a++)
                        inside = inside && x[a] <= l->cell[a] * l->cells + 1e-9;
                    if (inside)
                        cloud_add(scale * x[0], scale * x[1], scale * x[2], scale * l->radius);
                }
}

static const gn_effects all_effects = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_BONDS | GN_FX_SHEAR;

/* Particles of the cloud, not in the order of their ids; unit mass. */
static inline gn_particles particles_of_cloud(gn_effects effects, bool shuffle) {
    gn_particles p = {0};
    assert_int_equal(gn_soa_create(&gn_particle_record, &p, points.count, effects, NULL), 0);
    for (size_t k = 0; k < points.count; k++) p.id[k] = (int32_t)k;
    srand(3);
    for (size_t k = points.count; shuffle && k > 1; k--) {
        size_t other = (size_t)rand() % k;
        int32_t id = p.id[k - 1];
        p.id[k - 1] = p.id[other];
        p.id[other] = id;
    }
    for (size_t k = 0; k < points.count; k++) {
        memcpy(p.pos + 4 * k, points.row[p.id[k]], 4 * sizeof(double));
        memcpy(p.start + 4 * k, points.row[p.id[k]], 4 * sizeof(double));
        p.vel[4 * k + 3] = 1;
    }
    return p;
}

static inline void particles_free(gn_particles *p) {
    gn_soa_destroy(&gn_particle_record, p);
}

static int32_t index_of_id[POINTS_MAX];

static inline void find_indices(const gn_particles *p) {
    for (size_t k = 0; k < p->soa.count; k++) index_of_id[p->id[k]] = (int32_t)k;
}

/* Makes a gauge of the particles that count initially. */
static inline gneiss_status create_gauge(const gn_particles *p, int dimension,
                                         gn_strain_gauge *gauge, gneiss_error *error) {
    uint8_t *counts = calloc(p->soa.count + 1, sizeof *counts);
    gn_strain_gauge_select(p, dimension, counts);
    gneiss_status status = gn_strain_gauge_of(p, counts, dimension, gauge, error);
    free(counts);
    return status;
}

static inline gn_strain_gauge gauge_of(const gn_particles *p, int dimension) {
    gn_strain_gauge gauge;
    gneiss_error error = {0};
    if (create_gauge(p, dimension, &gauge, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return gauge;
}

/* A gradient with shear and a rotation, not symmetric. */
static const double gradient3[9] = {-0.011, 0.4, 0.03, -0.3, 0.02, 0.07, 0.005, -0.21, 0.013};
static const double gradient2[9] = {-0.011, 0.4, 0, -0.3, 0.02, 0, 0, 0, 0};

static inline void displace(gn_particles *p, const double g[9]) {
    for (size_t k = 0; k < p->soa.count; k++)
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) p->pos[4 * k + a] += g[3 * a + b] * p->start[4 * k + b];
}

static inline void assert_near(double found, double expected, double tolerance, const char *what,
                               int k) {
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s [%d]: expected %.17g, found %.17g", what, k, expected, found);
}

#endif
