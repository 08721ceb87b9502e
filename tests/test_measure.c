#include "test.h"

#include "base/ball.h"
#include "measure/delaunay.h"
#include "measure/measure.h"

#include "cloud.h"

/* --- strain --- */

static void assert_uniform_gradient_read(int dimension, const char *what) {
    gn_particles p = particles_of_cloud(all_effects, true);
    gn_strain_gauge gauge = gauge_of(&p, dimension);
    const double *g = dimension == 3 ? gradient3 : gradient2;
    double read[9];
    displace(&p, g);
    find_indices(&p);
    gn_strain_gauge_read(&gauge, &p, index_of_id, read);
    for (int k = 0; k < 9; k++) assert_near(read[k], g[k], 1e-12, what, k);
    gn_strain_gauge_free(&gauge);
    particles_free(&p);
}

static void a_uniform_gradient_on_random_points_is_read_back(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        cloud_random(700, dimension);
        assert_uniform_gradient_read(dimension, "random points");
    }
}

static void a_uniform_gradient_on_a_lattice_is_read_back(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        cloud_lattice(&lattices[k], 0.1, true);
        assert_uniform_gradient_read(lattices[k].dimension, lattices[k].name);
    }
}

/* The gauge of a lattice without a corner, an edge and a face particle reads the same as its
 * triangulation, by other triangles of the same faces. */
static void a_fast_gauge_reads_the_same_strain_as_a_triangulation(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        const int dimension = lattices[k].dimension;
        const double *g = dimension == 3 ? gradient3 : gradient2;
        uint8_t counts[POINTS_MAX];
        double read[9];
        gn_strain_gauge soon, whole;
        cloud_lattice(&lattices[k], 0.1, true);
        gn_particles p = particles_of_cloud(all_effects, true);
        for (size_t i = 0; i < points.count; i++) {
            const double *x = p.start + 4 * i;
            counts[i] = x[0] + x[1] > 0.15 && p.id[i] != 17;
        }
        assert_int_equal(gn_strain_gauge_of(&p, counts, dimension, &whole, NULL), GNEISS_OK);
        assert_int_equal(gn_strain_gauge_fast(&p, counts, dimension, &soon, NULL), GNEISS_OK);
        displace(&p, g);
        find_indices(&p);
        gn_strain_gauge_read(&soon, &p, index_of_id, read);
        for (int c = 0; c < 9; c++) assert_near(read[c], g[c], 1e-12, lattices[k].name, c);
        assert_close(soon.volume, whole.volume, 1e-12);
        assert_int_equal(soon.count, whole.count);
        gn_strain_gauge_free(&soon);
        gn_strain_gauge_free(&whole);
        particles_free(&p);
    }
}

static void simplices_of_a_closed_lattice_fill_its_box(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        const lattice *l = &lattices[k];
        cloud_lattice(l, 0.1, true);
        gn_particles p = particles_of_cloud(all_effects, true);
        gn_strain_gauge gauge = gauge_of(&p, l->dimension);
        double volume = 1;
        for (int a = 0; a < l->dimension; a++) volume *= 0.1 * l->cell[a] * l->cells;
        assert_close(gauge.volume, volume, 1e-12);
        gn_strain_gauge_free(&gauge);
        particles_free(&p);
    }
}

static void points_all_on_one_sphere_are_triangulated(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        lattice cell = lattices[k];
        cell.cells = cell.basis_count = 1; /* the corners of one box */
        cloud_lattice(&cell, 0.1, true);
        assert_int_equal(points.count, 1 << cell.dimension);
        assert_uniform_gradient_read(cell.dimension, cell.name);
    }
}

static void only_outer_particles_have_a_weight(void **state) {
    (void)state;
    cloud_lattice(&lattices[0], 0.1, true);
    gn_particles p = particles_of_cloud(all_effects, true);
    gn_strain_gauge gauge = gauge_of(&p, 3);
    assert_int_equal(gauge.count, 5 * 5 * 5 - 3 * 3 * 3);
    for (size_t k = 0; k < gauge.count; k++) {
        const double *x = points.row[gauge.id[k]];
        bool outer = false;
        for (int a = 0; a < 3; a++) outer = outer || x[a] < 0.01 || x[a] > 0.39;
        assert_true(outer);
    }
    gn_strain_gauge_free(&gauge);
    particles_free(&p);
}

/* Gradient in one tetrahedron by Cramer's rule: du = g dx for three edges. Returns 6 V. */
static double tetrahedron_gradient(double x[4][3], double u[4][3], double g[9]) {
    double e[3][3], d[3][3], det = 0;
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            e[k][a] = x[k + 1][a] - x[0][a], d[k][a] = u[k + 1][a] - u[0][a];
    double cof[3][3];
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) {
            int k1 = (k + 1) % 3, k2 = (k + 2) % 3, a1 = (a + 1) % 3, a2 = (a + 2) % 3;
            cof[k][a] = e[k1][a1] * e[k2][a2] - e[k1][a2] * e[k2][a1];
        }
    for (int a = 0; a < 3; a++) det += e[0][a] * cof[0][a];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            g[3 * a + b] = 0;
            for (int k = 0; k < 3; k++) g[3 * a + b] += d[k][a] * cof[k][b] / det;
        }
    return det;
}

static void a_reading_is_the_volume_weighted_mean_of_the_simplices(void **state) {
    (void)state;
    static double x[3 * 300], u[300][3];
    cloud_random(300, 3);
    for (size_t k = 0; k < 300; k++)
        for (int a = 0; a < 3; a++) x[3 * k + a] = points.row[k][a], u[k][a] = 1e-3 * random_unit();
    gn_triangulation t;
    assert_int_equal(gn_delaunay(x, 300, 3, &t, NULL), GNEISS_OK);
    double mean[9] = {0}, volume = 0, g[9];
    for (size_t s = 0; s < t.count; s++) {
        double corner[4][3], move[4][3];
        for (int k = 0; k < 4; k++) {
            memcpy(corner[k], x + 3 * t.vertex[4 * s + k], sizeof corner[k]);
            memcpy(move[k], u[t.vertex[4 * s + k]], sizeof move[k]);
        }
        double v = fabs(tetrahedron_gradient(corner, move, g));
        volume += v;
        for (int k = 0; k < 9; k++) mean[k] += v * g[k];
    }
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_strain_gauge gauge = gauge_of(&p, 3);
    for (size_t k = 0; k < 300; k++)
        for (int a = 0; a < 3; a++) p.pos[4 * k + a] += u[k][a];
    find_indices(&p);
    gn_strain_gauge_read(&gauge, &p, index_of_id, g);
    assert_close(gauge.volume, volume / 6, 1e-12);
    for (int k = 0; k < 9; k++) assert_near(g[k], mean[k] / volume, 1e-12, "mean gradient", k);
    gn_triangulation_free(&t);
    gn_strain_gauge_free(&gauge);
    particles_free(&p);
}

/* F = R U: whatever R, the strain is U - 1. Small strains keep their digits under large turns, to
 * the rounding of F. */
static void a_rotation_is_no_strain(void **state) {
    (void)state;
    const double stretches[2][9] = {{1.2, 0.1, 0, 0.1, 0.9, -0.05, 0, -0.05, 1.05},
                                    {1 + 1e-6, 2e-7, 0, 2e-7, 1 - 3e-6, 0, 0, 0, 1 + 4e-7}};
    const double axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    for (int s = 0; s < 2; s++)
        for (int k = 0; k < 7; k++) {
            double angle = 0.5 * k, turn[9], g[9], strain[9];
            const double c = cos(angle), d = sin(angle);
            const double cross[9] = {0,        -axis[2], axis[1], axis[2], 0,
                                     -axis[0], -axis[1], axis[0], 0};
            for (int a = 0; a < 9; a++)
                turn[a] = (a % 4 == 0 ? c : 0) + d * cross[a] + (1 - c) * axis[a / 3] * axis[a % 3];
            for (int a = 0; a < 9; a++) {
                g[a] = a % 4 == 0 ? -1 : 0;
                for (int b = 0; b < 3; b++)
                    g[a] += turn[3 * (a / 3) + b] * stretches[s][3 * b + a % 3];
            }
            gn_strain_of(g, strain);
            for (int a = 0; a < 9; a++)
                assert_near(strain[a], stretches[s][a] - (a % 4 == 0), 1e-14, "strain", a);
        }
}

/* A face of the triangulation that only one simplex has. */
static bool is_outer(const gn_triangulation *t, const int32_t *corner, int dimension) {
    int having = 0;
    for (size_t s = 0; s < t->count; s++) {
        int shared = 0;
        for (int a = 0; a < dimension; a++)
            for (int k = 0; k <= dimension; k++)
                shared += t->vertex[s * (size_t)(dimension + 1) + (size_t)k] == corner[a];
        having += shared == dimension;
    }
    return having == 1;
}

/* Points in general position: no face has points other than its corners. Each face of the hull is
 * one of the outside, and as both are closed there are no others: their number is that of Euler's
 * formula. */
static void faces_of_the_hull_are_the_outside_of_the_triangulation(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        static double x[3 * 400];
        double volume, hull_volume;
        size_t corners = 0, n = (size_t)dimension;
        cloud_random(400, dimension);
        for (size_t k = 0; k < 400; k++)
            for (size_t a = 0; a < n; a++) x[n * k + a] = points.row[k][a];
        gn_triangulation t, hull;
        assert_int_equal(gn_delaunay(x, 400, dimension, &t, NULL), GNEISS_OK);
        assert_int_equal(gn_hull_faces(x, 400, dimension, &hull, &volume, NULL), GNEISS_OK);
        assert_int_equal(gn_hull_volume(x, 400, dimension, &hull_volume, NULL), GNEISS_OK);
        assert_true(hull.count > n);
        assert_close(volume, hull_volume, 1e-12);
        for (size_t f = 0; f < hull.count; f++)
            assert_true(is_outer(&t, hull.vertex + n * f, dimension));
        for (int32_t p = 0; p < 400; p++) {
            bool on = false;
            for (size_t k = 0; k < n * hull.count; k++) on = on || hull.vertex[k] == p;
            corners += on;
        }
        assert_int_equal(hull.count, dimension == 3 ? 2 * corners - 4 : corners);
        gn_triangulation_free(&t);
        gn_triangulation_free(&hull);
    }
}

/* Without detection the particles on the faces of a block would not count. */
static void hulls_with_points_on_their_faces_are_detected(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        double volume;
        gn_triangulation hull;
        const int dimension = lattices[k].dimension;
        cloud_lattice(&lattices[k], 0.1, true);
        double *x = calloc(points.count, 3 * sizeof *x);
        for (size_t p = 0; p < points.count; p++)
            for (int a = 0; a < dimension; a++)
                x[p * (size_t)dimension + (size_t)a] = points.row[p][a];
        assert_int_equal(gn_hull_faces(x, points.count, dimension, &hull, &volume, NULL),
                         GNEISS_OK);
        assert_int_equal(hull.count, 0);
        free(x);
    }
}

static void the_gauge_does_not_depend_on_the_order_of_the_particles(void **state) {
    (void)state;
    cloud_lattice(&lattices[2], 0.1, true);
    gn_particles p = particles_of_cloud(all_effects, false),
                 q = particles_of_cloud(all_effects, true);
    gn_strain_gauge a = gauge_of(&p, 3), b = gauge_of(&q, 3);
    assert_int_not_equal(p.id[0], q.id[0]);
    assert_int_equal(a.count, b.count);
    assert_memory_equal(a.id, b.id, a.count * sizeof *a.id);
    assert_memory_equal(a.weight, b.weight, 3 * a.count * sizeof *a.weight);
    gn_strain_gauge_free(&a);
    gn_strain_gauge_free(&b);
    particles_free(&p);
    particles_free(&q);
}

static void assert_empty_gauge(int dimension) {
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_strain_gauge gauge = gauge_of(&p, dimension);
    double g[9];
    assert_int_equal(gauge.count, 0);
    find_indices(&p);
    gn_strain_gauge_read(&gauge, &p, index_of_id, g);
    for (int k = 0; k < 9; k++) assert_true(isnan(g[k]));
    gn_strain_gauge_free(&gauge);
    particles_free(&p);
}

static void particles_with_a_lost_bond_do_not_count_as_strain(void **state) {
    (void)state;
    const double gradient[9] = {1e-3, 2e-4, 0, -1e-4, 3e-3, 1e-4, 5e-4, 0, -2e-3};
    cloud_random(300, 3);
    gn_particles p = particles_of_cloud(all_effects, false);
    for (size_t k = 0; k < 300; k++) p.bonds0[k] = k % 10 ? 4 : 3;
    gn_strain_gauge held = gauge_of(&p, 3);
    displace(&p, gradient);
    for (size_t k = 0; k < 300; k += 10) p.pos[4 * k + 2] += 0.01;
    find_indices(&p);
    double g[9];
    gn_strain_gauge_read(&held, &p, index_of_id, g);
    for (int k = 0; k < 9; k++) assert_near(g[k], gradient[k], 1e-12, "held ones alone", k);
    for (size_t k = 0; k < held.count; k++) assert_int_not_equal(held.id[k] % 10, 0);
    gn_strain_gauge_free(&held);

    for (size_t k = 0; k < 300; k++)
        p.bonds0[k] = k % 10 ? 3 : 4; /* with these bonds the particles are not a bonded body */
    gn_strain_gauge all = gauge_of(&p, 3);
    bool loose = false;
    for (size_t k = 0; k < all.count; k++) loose = loose || all.id[k] % 10 != 0;
    assert_true(loose);
    gn_strain_gauge_free(&all);
    particles_free(&p);
}

static void points_on_a_plane_or_line_give_an_empty_gauge(void **state) {
    (void)state;
    cloud_random(200, 3);
    for (size_t k = 0; k < points.count; k++)
        points.row[k][2] = 0.7 * points.row[k][0] - 3 * points.row[k][1] + 0.1;
    assert_empty_gauge(3);
    for (size_t k = 0; k < points.count; k++) points.row[k][1] = 0.7 * points.row[k][0];
    assert_empty_gauge(2);
    for (size_t k = 0; k < points.count; k++) memcpy(points.row[k], points.row[0], 32);
    assert_empty_gauge(3);
}

static void too_few_points_give_an_empty_gauge(void **state) {
    (void)state;
    for (size_t count = 0; count < 4; count++) {
        cloud_random(count, 3);
        assert_empty_gauge(3);
    }
}

static void points_at_one_place_do_not_disturb_the_gauge(void **state) {
    (void)state;
    cloud_random(100, 3);
    for (size_t k = 0; k < 20; k++)
        cloud_add(points.row[k][0], points.row[k][1], points.row[k][2], points.row[k][3]);
    assert_uniform_gradient_read(3, "doubled points");
}

static void a_coordinate_that_is_no_number_is_refused(void **state) {
    (void)state;
    cloud_random(50, 3);
    points.row[7][1] = NAN;
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_strain_gauge gauge;
    gneiss_error error = {0};
    assert_int_equal(create_gauge(&p, 3, &gauge, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "strain gauge: coordinate 1 of point 7"));
    assert_int_equal(gauge.count, 0);
    particles_free(&p);
}

/* The hull scales with the thickness down to where round-off in the coordinates decides. */
static void a_thin_sheet_is_measured_until_it_counts_as_flat(void **state) {
    (void)state;
    double per_height = 0;
    for (double height = 1; height > 1e-14; height /= 10) {
        cloud_random(400, 3);
        for (size_t k = 0; k < points.count; k++) points.row[k][2] *= height;
        gn_particles p = particles_of_cloud(all_effects, false);
        gn_strain_gauge gauge = gauge_of(&p, 3);
        if (height == 1) per_height = gauge.volume;
        if (height > 1e-7) assert_true(gauge.count > 0);
        if (height < 1e-10) assert_int_equal(gauge.count, 0);
        if (gauge.count) assert_close(gauge.volume / height, per_height, 1e-9);
        gn_strain_gauge_free(&gauge);
        particles_free(&p);
    }
}

static void an_error_of_qhull_becomes_a_message(void **state) {
    (void)state;
    const double line[4] = {0, 1, 2, 4};
    double volume;
    gneiss_error error = {0};
    assert_int_equal(gn_hull_volume(line, 4, 1, &volume, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, "4 points in 1D failed") || !strstr(error.message, "QH6"))
        fail_msg("%s", error.message);
    assert_true(volume == 0);
}

static void a_removed_particle_counts_as_not_displaced(void **state) {
    (void)state;
    cloud_random(50, 3);
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_strain_gauge gauge = gauge_of(&p, 3);
    double with[9], without[9];
    displace(&p, gradient3);
    find_indices(&p);
    int32_t id = gauge.id[0];
    index_of_id[id] = -1;
    gn_strain_gauge_read(&gauge, &p, index_of_id, without);
    index_of_id[id] = id;
    memcpy(p.pos + 4 * id, p.start + 4 * id, 3 * sizeof(double));
    gn_strain_gauge_read(&gauge, &p, index_of_id, with);
    assert_true(fabs(with[1] - gradient3[1]) > 1e-6);
    assert_memory_equal(with, without, sizeof with);
    gn_strain_gauge_free(&gauge);
    particles_free(&p);
}

/* --- stress --- */

/* All touching pairs of the cloud; the nearest image with `period`. */
static gn_contacts contacts_of_cloud(const lattice *l, const double period[3], gn_effects effects,
                                     const double strain[3][3], double kn, double kt) {
    gn_contacts list = {0};
    assert_int_equal(gn_soa_create(&gn_contact_record, &list, 8 * points.count,
                                   effects | GN_FX_CONTACT_FORCES, NULL),
                     0);
    double *row = gn_contacts_row(&list);
    int width = gn_contacts_row_width(&list);
    size_t count = 0;
    for (size_t i = 0; i < points.count; i++)
        for (size_t j = i + 1; j < points.count; j++) {
            double x[3], d[3] = {0}, square = 0, normal = 0;
            for (int a = 0; a < 3; a++) {
                x[a] = points.row[j][a] - points.row[i][a];
                x[a] -= period[a] * round(x[a] / period[a]);
                square += x[a] * x[a];
            }
            double length = sqrt(square);
            if (length > 2.001 * points.row[0][3]) continue;
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++) d[a] += strain[a][b] * x[b];
            for (int a = 0; a < 3; a++) normal += d[a] * x[a] / length;
            for (int a = 0; a < l->dimension; a++) {
                double n = x[a] / length;
                row[count * width + a] = kn * normal * n + kt * (d[a] - normal * n);
            }
            list.i[count] = (int32_t)i;
            list.j[count++] = (int32_t)j;
        }
    assert_int_equal(count, (size_t)(l->coordination * points.count / 2));
    list.soa.count = count;
    return list;
}

/* Affine stiffness of a lattice with k_n, k_t: C_1111, C_1122 and 2 C_1212 (for symmetric strain),
 * per unit of the cell's edge, from the fourth moments of its contact directions. */
static void lattice_stiffness(const char *name, double kn, double kt, double c[3]) {
    if (strcmp(name, "simple cubic") == 0) {
        c[0] = kn, c[1] = 0, c[2] = kt; /* n along the axes */
    } else if (strcmp(name, "body-centred cubic") == 0) {
        /* 8 contacts a cell, l^2 = 3/4; <n_x^4> = <n_x^2 n_y^2> = 1/9: prefactor 6 */
        c[0] = 6 * ((kn - kt) / 9 + kt / 3), c[1] = 6 * (kn - kt) / 9;
        c[2] = 6 * (2 * (kn - kt) / 9 + kt / 3);
    } else if (strcmp(name, "face-centred cubic") == 0) {
        /* 24 contacts a cell, l^2 = 1/2; <n_x^4> = 1/6, <n_x^2 n_y^2> = 1/12: prefactor 12 */
        c[0] = 2 * (kn + kt), c[1] = kn - kt, c[2] = 2 * (kn - kt) + 4 * kt;
    } else if (strcmp(name, "square") == 0) {
        c[0] = kn, c[1] = 0, c[2] = kt;
    } else {
        /* hexagonal: 6 contacts a cell of sqrt(3), l = 1; <n_x^4> = 3/8, <n_x^2 n_y^2> = 1/8 */
        double f = 2 * sqrt(3);
        c[0] = f * (3 * (kn - kt) / 8 + kt / 2), c[1] = f * (kn - kt) / 8;
        c[2] = f * ((kn - kt) / 4 + kt / 2);
    }
}

/* Computes the symmetric mean stress over a volume from the stresses of particles. */
static void average_stress(const gn_assembly *assembly, double volume, double sigma[9]) {
    const double porosity = 0.3;
    const gn_particles *p = assembly->particles;
    const int component[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
    double(*each)[6] = calloc(p->soa.count, sizeof *each), sum[6] = {0};
    gn_stress_particles(assembly, porosity, each[0]);
    for (size_t k = 0; k < p->soa.count; k++)
        for (int c = 0; c < 6; c++)
            sum[c] += each[k][c] * gn_ball_volume(assembly->dimension, p->pos[4 * k + 3]);
    for (int c = 0; c < 9; c++) sigma[c] = sum[component[c]] / (1.0 - porosity) / volume;
    free(each);
}

static void assert_lattice_stress(const lattice *l, gn_effects effects) {
    const double strain3[3][3] = {{1e-3, 4e-4, -3e-4}, {4e-4, -2e-3, 7e-4}, {-3e-4, 7e-4, 5e-4}};
    const double kn = 3e6, kt = 7e5, edge = 0.01;
    double strain[3][3] = {{0}}, c[3], sigma[9], volume = 1, trace = 0;
    for (int a = 0; a < l->dimension; a++)
        for (int b = 0; b < l->dimension; b++) strain[a][b] = strain3[a][b];
    cloud_lattice(l, edge, false);
    gn_particles p = particles_of_cloud(effects, false);
    gn_assembly assembly = {.dimension = l->dimension, .particles = &p, .periodic = true};
    for (int a = 0; a < 3; a++) assembly.period[a] = edge * l->cell[a] * l->cells;
    for (int a = 0; a < l->dimension; a++) volume *= assembly.period[a], trace += strain[a][a];
    gn_contacts bonds = contacts_of_cloud(l, assembly.period, effects, strain, kn, kt);
    assembly.list[0] = &bonds;
    average_stress(&assembly, volume, sigma);
    lattice_stiffness(l->name, kn, kt, c);
    double per_edge = l->dimension == 3 ? 1 / edge : 1;
    for (int a = 0; a < l->dimension; a++)
        for (int b = 0; b < l->dimension; b++) {
            double expected =
                a == b ? c[0] * strain[a][a] + c[1] * (trace - strain[a][a]) : c[2] * strain[a][b];
            assert_near(sigma[3 * a + b], expected * per_edge, 1e-12 * kn * per_edge * 1e-3,
                        l->name, 3 * a + b);
        }
    gn_soa_destroy(&gn_contact_record, &bonds);
    particles_free(&p);
}

static void a_strained_lattice_has_the_stress_of_its_affine_stiffness(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        gn_effects space = lattices[k].dimension == 3 ? GN_FX_SPACE : 0;
        assert_lattice_stress(&lattices[k], GN_FX_BONDS | GN_FX_SHEAR | space);
        assert_lattice_stress(&lattices[k], GN_FX_BONDS | GN_FX_SHEAR | GN_FX_ROTATION | space);
    }
}

/* Two bonded spheres and an unbonded pair with gaps and overlaps, any forces, a wall. */
typedef struct scrap {
    gn_particles p;
    gn_contacts bonds, pairs;
    gn_wall_contacts walls;
    gn_assembly assembly;
} scrap;

static const double floor_normal[4] = {0, 0, 1, 0};

static void scrap_contact(gn_contacts *list, int32_t i, int32_t j, const double f[3]) {
    assert_int_equal(
        gn_soa_create(&gn_contact_record, list, 1, all_effects | GN_FX_CONTACT_FORCES, NULL), 0);
    list->i[0] = i;
    list->j[0] = j;
    memcpy(gn_contacts_row(list), f, 3 * sizeof *f);
}

static void scrap_make(scrap *s) {
    *s = (scrap){0};
    points.count = 0;
    cloud_add(0, 0, 1, 1);
    cloud_add(0.3, 1.2, 2.9, 1.5);
    cloud_add(3, 0.1, 2.2, 0.8);
    s->p = particles_of_cloud(all_effects, false);
    scrap_contact(&s->bonds, 0, 1, (double[3]){3, -2, 5});
    scrap_contact(&s->pairs, 1, 2, (double[3]){-1, 4, 0.5});
    assert_int_equal(gn_soa_create(&gn_wall_contact_record, &s->walls, 1, all_effects, NULL), 0);
    memcpy(s->walls.row, (double[3]){0.7, 0, 9}, 3 * sizeof(double));
    s->assembly =
        (gn_assembly){3, &s->p, {&s->bonds, &s->pairs}, &s->walls, floor_normal, false, {0}, 1};
}

static void scrap_free(scrap *s) {
    gn_soa_destroy(&gn_contact_record, &s->bonds);
    gn_soa_destroy(&gn_contact_record, &s->pairs);
    gn_soa_destroy(&gn_wall_contact_record, &s->walls);
    particles_free(&s->p);
}

static void bonds_pairs_and_walls_add_to_the_stress(void **state) {
    (void)state;
    scrap s;
    scrap_make(&s);
    double sigma[9];
    average_stress(&s.assembly, 2, sigma);
    /* Symmetric part of f l of the bond, of the pair, and of the wall: (0.7, 0, 9) on a sphere of
     * radius 1 over it. */
    assert_close(sigma[0], (3 * 0.3 - 1 * 2.7) / 2, 1e-13);
    const double xz = 3 * 1.9 + 1 * 0.7 - 0.7, zx = 5 * 0.3 + 0.5 * 2.7;
    assert_close(sigma[2], 0.5 * (xz + zx) / 2, 1e-13);
    assert_close(sigma[8], (5 * 1.9 - 0.5 * 0.7 - 9) / 2, 1e-13);
    scrap_free(&s);
}

static void a_squeezed_sphere_is_in_compression(void **state) {
    (void)state;
    const double normals[8] = {0, 0, 1, 0, 0, 0, -1, 0}, force = 50, r = 0.2;
    points.count = 0;
    cloud_add(0, 0, 0, r);
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_wall_contacts walls = {0};
    assert_int_equal(gn_soa_create(&gn_wall_contact_record, &walls, 2, all_effects, NULL), 0);
    walls.wall[1] = 1;
    walls.row[2] = force;
    walls.row[8 + 2] = -force;
    gn_assembly assembly = {.dimension = 3,
                            .particles = &p,
                            .wall_contacts = &walls,
                            .wall_normals = normals,
                            .wall_count = 2};
    double sigma[6];
    gn_stress_particles(&assembly, 0.25, sigma);
    assert_close(sigma[2], -force * 2 * r * 0.75 / (4.0 / 3 * M_PI * r * r * r), 1e-14);
    for (int k = 0; k < 6; k++)
        if (k != 2) assert_true(sigma[k] == 0);
    gn_soa_destroy(&gn_wall_contact_record, &walls);
    particles_free(&p);
}

/* --- packing --- */

static int32_t pair_list[2 * POINTS_MAX * 100];

static size_t all_pairs(size_t count) {
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++, pairs++) {
            assert_true(pairs < POINTS_MAX * 100);
            pair_list[2 * pairs] = (int32_t)i;
            pair_list[2 * pairs + 1] = (int32_t)j;
        }
    return pairs;
}

static void lattices_have_their_coordination_porosity_and_fabric(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        const lattice *l = &lattices[k];
        cloud_lattice(l, 0.1, false);
        gn_particles p = particles_of_cloud(all_effects, true);
        gn_assembly assembly = {.dimension = l->dimension, .particles = &p, .periodic = true};
        double volume = 1;
        for (int a = 0; a < 3; a++) assembly.period[a] = 0.1 * l->cell[a] * l->cells;
        for (int a = 0; a < l->dimension; a++) volume *= assembly.period[a];
        gn_packing_figures g;
        gn_packing_measure(&assembly, pair_list, all_pairs(points.count), 1e-9, volume, &g);
        assert_int_equal(g.particles, points.count);
        assert_close(g.coordination, l->coordination, 1e-15);
        assert_close(1 - g.porosity, l->solid, 1e-13);
        for (int a = 0; a < 9; a++) {
            bool diagonal = a % 4 == 0 && a / 4 < l->dimension;
            assert_near(g.fabric[a], diagonal ? 1.0 / l->dimension : 0, 1e-14, l->name, a);
        }
        assert_true(g.overlap_max < 1e-14);
        particles_free(&p);
    }
}

static void overlaps_name_the_worst_pair(void **state) {
    (void)state;
    points.count = 0;
    cloud_add(0, 0, 0, 1);
    cloud_add(0, 1.8, 0, 1);   /* overlap 0.1 with the first */
    cloud_add(0, 4.2, 0, 2);   /* 0.2 with the second */
    cloud_add(10, 0, 0, 1);    /* alone */
    cloud_add(10, 0, 2.08, 1); /* a gap of 0.04 to the fourth */
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_assembly assembly = {.dimension = 3, .particles = &p};
    gn_packing_figures g;
    gn_packing_measure(&assembly, pair_list, all_pairs(5), 0.03, 0, &g);
    assert_int_equal(g.contacts, 2);
    assert_close(g.overlap_max, 0.2, 1e-14);
    assert_close(g.overlap_mean, 0.15, 1e-14);
    assert_int_equal(g.overlap_i, 1);
    assert_int_equal(g.overlap_j, 2);
    assert_true(isnan(g.porosity));
    assert_close(g.radius_mean, 1.2, 1e-15);
    assert_true(g.radius_min == 1 && g.radius_max == 2);
    gn_packing_measure(&assembly, pair_list, all_pairs(5), 0.05, 0, &g);
    assert_int_equal(g.contacts, 3);
    assert_close(g.fabric[4], 2.0 / 3, 1e-15);
    assert_close(g.fabric[8], 1.0 / 3, 1e-15);
    particles_free(&p);
}

static void removed_particles_are_left_out_of_a_packing(void **state) {
    (void)state;
    points.count = 0;
    for (int k = 0; k < 4; k++) cloud_add(2 * k, 0, 0, 1);
    gn_particles p = particles_of_cloud(all_effects, false);
    p.vel[4 * 3 + 3] = 0;
    gn_assembly assembly = {.dimension = 3, .particles = &p};
    gn_packing_figures g;
    gn_packing_measure(&assembly, pair_list, all_pairs(4), 1e-9, 20, &g);
    assert_int_equal(g.particles, 3);
    assert_int_equal(g.contacts, 2);
    assert_close(g.solid_volume, 4 * M_PI, 1e-15);
    double volume, lower[3], upper[3];
    assert_int_equal(gn_packing_hull(&p, 3, &volume, lower, upper, NULL), GNEISS_OK);
    assert_close(upper[0], 5, 1e-15);
    particles_free(&p);
}

static void read_specimen(const char *name) {
    char path[512], line[256];
    snprintf(path, sizeof path, "%s/scenes/specimens/%s", test_source(), name);
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("cannot read %s", path);
    points.count = 0;
    while (fgets(line, sizeof line, file)) {
        double x, y, z, r;
        if (line[0] != '#' && sscanf(line, "%lf %lf %lf %lf", &x, &y, &z, &r) == 4)
            cloud_add(x, y, z, r);
    }
    fclose(file);
}

/* 2000 spheres in a cylinder of 23 mm. Some protrude, by up to 0.06 mm; between neighbours about
 * 2.2 mm apart the hull cuts off a chord of 0.05 mm, 0.5 % of the radius and 1 % of the volume. */
static void the_hull_of_a_cylinder_packing_is_close_to_the_cylinder(void **state) {
    (void)state;
    read_specimen("rock-b.txt");
    assert_int_equal(points.count, 2000);
    gn_particles p = particles_of_cloud(all_effects, true);
    double volume, lower[3], upper[3], cylinder = M_PI / 4 * 0.023 * 0.023 * 0.046;
    assert_int_equal(gn_packing_hull(&p, 3, &volume, lower, upper, NULL), GNEISS_OK);
    assert_close(volume, cylinder, 0.02);
    for (int a = 0; a < 2; a++) {
        assert_near(lower[a], -0.0115, 5e-5, "lower end of the cylinder", a);
        assert_near(upper[a], 0.0115, 5e-5, "upper end of the cylinder", a);
    }
    assert_near(lower[2], 0, 5e-5, "foot of the cylinder", 2);
    assert_near(upper[2], 0.046, 6e-5, "top of the cylinder", 2);
    particles_free(&p);
}

static void damage_is_the_share_of_bonds_lost(void **state) {
    (void)state;
    points.count = 0;
    for (int k = 0; k < 5; k++) cloud_add(k, 0, 0, 0.5);
    gn_particles p = particles_of_cloud(all_effects, false);
    gn_contacts bonds = {0};
    assert_int_equal(gn_soa_create(&gn_contact_record, &bonds, 4, all_effects, NULL), 0);
    const int32_t ends[4][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}};
    for (int c = 0; c < 4; c++) bonds.i[c] = ends[c][0], bonds.j[c] = ends[c][1];
    memcpy(p.bonds0, (int32_t[5]){4, 2, 2, 1, 0}, 5 * sizeof(int32_t));
    bonds.cause[1] = GN_BROKEN_SHEAR;
    bonds.cause[2] = GN_BROKEN_TENSION;
    double damage[5];
    const double expected[5] = {0.75, 0, 0.5, 1, 0};
    gn_damage_particles(&p, &bonds, damage);
    for (int k = 0; k < 5; k++) assert_true(damage[k] == expected[k]);
    gn_soa_destroy(&gn_contact_record, &bonds);
    particles_free(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_uniform_gradient_on_random_points_is_read_back),
        cmocka_unit_test(a_uniform_gradient_on_a_lattice_is_read_back),
        cmocka_unit_test(a_fast_gauge_reads_the_same_strain_as_a_triangulation),
        cmocka_unit_test(simplices_of_a_closed_lattice_fill_its_box),
        cmocka_unit_test(points_all_on_one_sphere_are_triangulated),
        cmocka_unit_test(only_outer_particles_have_a_weight),
        cmocka_unit_test(a_reading_is_the_volume_weighted_mean_of_the_simplices),
        cmocka_unit_test(a_rotation_is_no_strain),
        cmocka_unit_test(faces_of_the_hull_are_the_outside_of_the_triangulation),
        cmocka_unit_test(hulls_with_points_on_their_faces_are_detected),
        cmocka_unit_test(the_gauge_does_not_depend_on_the_order_of_the_particles),
        cmocka_unit_test(particles_with_a_lost_bond_do_not_count_as_strain),
        cmocka_unit_test(points_on_a_plane_or_line_give_an_empty_gauge),
        cmocka_unit_test(too_few_points_give_an_empty_gauge),
        cmocka_unit_test(points_at_one_place_do_not_disturb_the_gauge),
        cmocka_unit_test(a_coordinate_that_is_no_number_is_refused),
        cmocka_unit_test(a_thin_sheet_is_measured_until_it_counts_as_flat),
        cmocka_unit_test(an_error_of_qhull_becomes_a_message),
        cmocka_unit_test(a_removed_particle_counts_as_not_displaced),
        cmocka_unit_test(a_strained_lattice_has_the_stress_of_its_affine_stiffness),
        cmocka_unit_test(bonds_pairs_and_walls_add_to_the_stress),
        cmocka_unit_test(a_squeezed_sphere_is_in_compression),
        cmocka_unit_test(lattices_have_their_coordination_porosity_and_fabric),
        cmocka_unit_test(overlaps_name_the_worst_pair),
        cmocka_unit_test(removed_particles_are_left_out_of_a_packing),
        cmocka_unit_test(the_hull_of_a_cylinder_packing_is_close_to_the_cylinder),
        cmocka_unit_test(damage_is_the_share_of_bonds_lost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
