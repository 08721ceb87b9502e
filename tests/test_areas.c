/* Laws by area: sections of bonds, the stiffness and strength that follow, and the behaviour of a
 * body of such bonds. */
#include "particles/bond_sections.h"
#include "particles/polyhedron.h"

#include "particles/particles.h"
#include "world_helpers.h"

#include <string.h>

static const double young = 20e9, poisson = 0.2, alpha = 1.2, beta = 0.8, sigma = 5e6, tau = 9e6;

/* k_t/k_n. */
static double ratio_of_springs(void) {
    return beta / alpha / (2.0 * (1.0 + poisson));
}

static const char *const matter =
    "materials: [{name: m, density: 2500, young: 20e9, poisson: 0.2, alpha: 1.2, beta: 0.8, "
    "friction: 0.5, tensile_strength: 5e6, shear_strength: 9e6}]\n";

/* A bonded specimen with a law; `more`: further sections. */
static gn_world *made(int dimension, const char *specimen, const char *law, const char *more) {
    return world_of("dimension: %d\nspecimen: %s\n%slaw: %s\nbonds: {}\n%stime: {end: 1}\n"
                    "run: {threads: 1}\n",
                    dimension, specimen, matter, law, more);
}

static gn_area_check check_of(const gn_world *w) {
    gn_area_check check;
    assert_int_equal(gn_areas_check(&w->ctx, &w->dem, &check, NULL), GNEISS_OK);
    return check;
}

/* Lattices of radius 1 mm in a periodic box that continues them. */
static const struct lattice {
    int dimension;
    const char *specimen, *box;
    double section; /* section of every bond, m2; 2D: m x 1 m */
    double filled;
} lattices[] = {
    {2, "{lattice: {kind: square, radius: 1 mm, cells: [6, 5, 1]}}", "[12e-3, 10e-3]", 2e-3, 1.0},
    {2, "{lattice: {kind: hexagonal, radius: 1 mm, cells: [6, 4, 1]}}",
     "[12e-3, 0.01385640646055101895]", 1.15470053837925152902e-3, 1.0},
    {3, "{lattice: {kind: cubic, radius: 1 mm, cells: [6, 5, 5]}}", "[12e-3, 10e-3, 10e-3]", 4e-6,
     1.0},
    /* Twelve contacts are those of a dodecahedron, whose surface is 16.6509 r^2; the cell about a
     * sphere of this lattice has 12 sqrt(2) r^2. */
    {3, "{lattice: {kind: fcc, radius: 1 mm, cells: [4, 4, 4]}}",
     "[0.011313708498984760, 0.011313708498984760, 0.011313708498984760]",
     16.650873085546532 / 12.0 * 1e-6, 16.650873085546532 / 16.970562748477140},
};
enum { LATTICES = sizeof lattices / sizeof *lattices };

static gn_world *periodic(const struct lattice *l, const char *law) {
    char box[256];
    snprintf(box, sizeof box, "periodic: {min: [0, 0%s], max: %s}\n",
             l->dimension == 3 ? ", 0" : "", l->box);
    return made(l->dimension, l->specimen, law, box);
}

static void polyhedra_fill_lattices(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        gn_world *w = periodic(&lattices[k], "{stiffness: polyhedron}");
        gn_area_check check = check_of(w);
        assert_close(check.filled, lattices[k].filled, 1e-12);
        assert_true(fabs(check.free) < 1e-12 && check.open == 0);
        for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++)
            assert_close(w->dem.bonds.contacts.area[c], lattices[k].section, 1e-12);
        world_end(w);
    }
}

/* At the surface of a block the missing faces equal those of the lattice. */
static void sections_at_a_skin_are_those_inside(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k += 2) { /* square, cubic: their skins are faces of the cells */
        gn_world *w =
            made(lattices[k].dimension, lattices[k].specimen, "{stiffness: polyhedron}", "");
        for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++)
            assert_close(w->dem.bonds.contacts.area[c], lattices[k].section,
                         1e-6); /* the computation of cells shifts points by 1e-8 */
        double most = 0.0, side[2][3] = {{12e-3, 10e-3, 1.0}, {12e-3, 10e-3, 10e-3}};
        const double *s = side[lattices[k].dimension - 2];
        most = (double)lattices[k].dimension * s[0] * s[1] * s[2];
        /* Volumes of the cells; the volume of the world is a hull of points on the spheres. */
        gn_area_check check = check_of(w);
        double all = (check.filled + check.free) * lattices[k].dimension * w->ctx.volume;
        assert_close(all, most, 1e-6);
        world_end(w);
    }
}

static void dempacks_sections_fill_any_body_by_themselves(void **state) {
    (void)state;
    for (int k = 0; k < LATTICES; k++) {
        gn_world *w = periodic(&lattices[k], "{stiffness: dempack}");
        assert_close(check_of(w).filled, 1.0, 1e-13);
        world_end(w);
    }
}

static void gamma_of_the_source_is_forty_times_porosity_over_neighbours(void **state) {
    (void)state;
    gn_world *w = periodic(&lattices[2], "{stiffness: dempack, gamma_rule: porosity}");
    double e = 1.0 - pi / 6.0, gamma = 40.0 * e / 6.0;
    assert_close(w->dem.derived.gamma, gamma, 1e-12);
    assert_close(w->dem.bonds.contacts.area[0], gamma * pi * 1e-6, 1e-12);
    assert_close(check_of(w).dempack_gamma, gamma, 1e-12);
    world_end(w);
}

/* Table of the source (Santasusana 2013, 4.6.2) without its misprints. */
static void the_ratio_is_that_of_the_regular_solids(void **state) {
    (void)state;
    const double table[][2] = {{4, 3.308},  {6, 1.910},  {8, 1.654},  {11, 1.407},
                               {12, 1.325}, {16, 1.266}, {20, 1.207}, {40, 1.0 + 4.14 / 40.0}};
    for (size_t k = 0; k < sizeof table / sizeof *table; k++)
        assert_near(gn_polyhedron_ratio(3, table[k][0]), table[k][1], 6e-4);
    assert_true(gn_polyhedron_ratio(3, 2.0) == gn_polyhedron_ratio(3, 4.0));
    assert_close(gn_polyhedron_ratio(2, 4.0), 4.0 / pi, 1e-15);
    assert_close(gn_polyhedron_ratio(2, 6.0), 6.0 / sqrt(3.0) / pi, 1e-15);
    assert_true(gn_polyhedron_ratio(2, 1.0) == gn_polyhedron_ratio(2, 3.0));
}

/* --- missing faces --- */

/* Returns the neighbours on a lattice that are not above the plane through the particle. */
static size_t below(const double (*all)[3], size_t count, const double plane[3],
                    double (*kept)[3]) {
    size_t n = 0;
    for (size_t k = 0; k < count; k++)
        if (dot3(all[k], plane) < 1e-9) memcpy(kept[n++], all[k], sizeof *kept);
    return n;
}

static void a_flat_skin_misses_the_faces_that_the_lattice_had(void **state) {
    (void)state;
    const double h = sqrt(0.5);
    const double fcc[12][3] = {{h, h, 0}, {h, -h, 0}, {-h, h, 0}, {-h, -h, 0},
                               {h, 0, h}, {h, 0, -h}, {-h, 0, h}, {-h, 0, -h},
                               {0, h, h}, {0, h, -h}, {0, -h, h}, {0, -h, -h}};
    const double cubic[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    const double planes[][3] = {{0, 0, 1}, {1, 1, 1}};
    double kept[12][3];
    for (int k = 0; k < 2; k++) {
        size_t n = below(fcc, 12, planes[k], kept);
        assert_int_equal(n, k ? 9 : 8);
        gn_polyhedron p = gn_polyhedron_about(3, n, kept);
        assert_true(p.open);
        assert_near(p.whole, 12.0, 1e-5); /* the computation of cells shifts points by 1e-8 */
    }
    const double edges[][3] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}}; /* face, edge, corner */
    for (int k = 0; k < 3; k++) {
        size_t n = below(cubic, 6, edges[k], kept);
        assert_int_equal(n, 5 - k);
        assert_near(gn_polyhedron_about(3, n, kept).whole, 6.0, 1e-5);
    }
    double hexagon[6][3];
    for (int k = 0; k < 4; k++) {
        double angle = (k + 3) * pi / 3.0; /* a row on top of the others */
        hexagon[k][0] = cos(angle), hexagon[k][1] = sin(angle), hexagon[k][2] = 0.0;
    }
    gn_polyhedron p = gn_polyhedron_about(2, 4, hexagon);
    assert_true(p.open);
    assert_near(p.whole, 6.0, 1e-12);
}

/* Points distributed evenly over the sphere, except those in a cone. */
static void neighbours_around_a_large_hole_are_extrapolated(void **state) {
    (void)state;
    enum { MANY = 400 };
    static double all[MANY][3], kept[MANY][3];
    size_t n = 0;
    for (int k = 0; k < MANY; k++) {
        double z = 1.0 - (2.0 * k + 1.0) / MANY, angle = k * pi * (3.0 - sqrt(5.0));
        all[k][0] = sqrt(1.0 - z * z) * cos(angle), all[k][1] = sqrt(1.0 - z * z) * sin(angle);
        all[k][2] = z;
        if (z < 0.0) memcpy(kept[n++], all[k], sizeof *kept);
    }
    assert_false(gn_polyhedron_about(3, MANY, all).open);
    gn_polyhedron p = gn_polyhedron_about(3, n, kept);
    assert_true(p.open);
    assert_near(p.whole, MANY, 0.02 * MANY); /* the rim of the hole is uneven by half a spacing */
}

static void one_and_two_neighbours_are_those_of_a_column(void **state) {
    (void)state;
    double pair[2][3] = {{0, 1, 0}, {0, -1, 0}};
    for (size_t n = 1; n <= 2; n++) {
        assert_true(gn_polyhedron_about(3, n, pair).whole == 6.0);
        assert_true(gn_polyhedron_about(2, n, pair).whole == 4.0);
    }
}

/* --- two spheres --- */

static const double r1 = 1e-3, r2 = 2e-3, distance = 3.05e-3;

/* The second is driven by `motion`, with the spin `spin`, rad/s. */
static gn_world *driven_with(const char *sections, int dimension, const char *law,
                             const char *motion, double spin, double step) {
    bool space = dimension == 3;
    char more[1024];
    snprintf(more, sizeof more,
             "sets:\n  - {name: held, select: {ids: [0]}, motion: {vx: 0, vy: 0, %swz: 0}}\n"
             "  - {name: driven, select: {ids: [1]}, motion: {%s, %swz: %g}}\n",
             space ? "vz: 0, wx: 0, wy: 0, " : "", motion, space ? "vz: 0, wx: 0, wy: 0, " : "",
             spin);
    return world_of("dimension: %d\nspecimen: {particles: [[0, %s1e-3], [3.05e-3, %s2e-3]]}\n%s"
                    "law: %s\nbonds: {}\n%s%stime: {step: %.17g, end: 1, on_unstable: warn}\n"
                    "run: {threads: 1}\n",
                    dimension, space ? "0, 0, " : "0, ", space ? "0, 0, " : "0, ", matter, law,
                    more, sections, step);
}

static gn_world *driven(int dimension, const char *law, const char *motion, double spin,
                        double step) {
    return driven_with("", dimension, law, motion, spin, step);
}

static gn_world *couple(int dimension, const char *law, const char *motion, double step) {
    return driven(dimension, law, motion, 0.0, step);
}

/* Dempack's section, and the mean section for two square columns. */
static double pair_section(int dimension, bool polyhedron, double gamma) {
    double r = 2.0 * r1 * r2 / (r1 + r2);
    if (polyhedron)
        return dimension == 3 ? 0.5 * (4.0 * r1 * r1 + 4.0 * r2 * r2) : 0.5 * (2.0 * r1 + 2.0 * r2);
    return gamma * (dimension == 3 ? pi * r * r : 2.0 * r);
}

static void two_spheres_are_a_bar(void **state) {
    (void)state;
    const char *laws[] = {"{stiffness: dempack, gamma: 0.8}", "{stiffness: polyhedron}"};
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 2; k++) {
            gn_world *w = couple(dimension, laws[k], "vx: 0, vy: 0", 1e-9);
            double area = pair_section(dimension, k, 0.8);
            const gn_contacts *b = &w->dem.bonds.contacts;
            assert_int_equal(b->soa.count, 1);
            assert_close(b->area[0], area, 1e-14);
            assert_close(b->kn[0], alpha * young * area / distance, 1e-14);
            assert_close(b->kt[0], beta * young / 2.4 * area / distance, 1e-14);
            assert_close(b->rn[0], sigma * area, 1e-14);
            assert_close(b->rt[0], tau * area, 1e-14);
            world_end(w);
        }
}

/* The bond breaks in the first step whose force reaches the strength: at the strain sigma/(alpha
 * E), or in shear at tau/(beta G). */
static void a_bar_breaks_at_its_strain(void **state) {
    (void)state;
    const double dt = 1e-9, speed = 0.5, shear = young / 2.4;
    for (int way = 0; way < 2; way++) {
        gn_world *w = couple(3, "{stiffness: dempack, gamma: 1}",
                             way ? "vx: 0, vy: 0.5" : "vx: 0.5, vy: 0", dt);
        double strain = way ? tau / (beta * shear) : sigma / (alpha * young);
        double time = strain * distance / speed;
        while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.time < 2.0 * time)
            run_steps(w, 1);
        assert_int_equal(w->dem.bonds.contacts.cause[0], way ? GN_BROKEN_SHEAR : GN_BROKEN_TENSION);
        /* The rotation of the normal tilts the path by at most half of the strain, squared. */
        assert_near(w->dem.bonds.contacts.broken_time[0], time, 2.0 * dt + strain * strain * time);
        world_end(w);
    }
}

/* The second sphere rotates in place: the contact, half a gap off its surface, slides by its arm
 * times the angle. */
static void a_bar_breaks_when_one_end_turns(void **state) {
    (void)state;
    const double dt = 1e-9, spin = 300.0, arm = r2 + 0.5 * (distance - r1 - r2);
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_world *w = driven(dimension, "{stiffness: polyhedron}", "vx: 0, vy: 0", spin, dt);
        double time = tau / (beta * young / 2.4) * distance / (arm * spin);
        while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.time < 2.0 * time)
            run_steps(w, 1);
        assert_int_equal(w->dem.bonds.contacts.cause[0], GN_BROKEN_SHEAR);
        assert_near(w->dem.bonds.contacts.broken_time[0], time, 2.0 * dt);
        world_end(w);
    }
}

/* Plates and columns of spheres: neighbours in one plane, or in one line. */
static void plates_and_columns_have_square_sections(void **state) {
    (void)state;
    const char *cells[] = {"[5, 4, 1]", "[1, 5, 4]", "[1, 1, 5]", "[2, 2, 1]"};
    for (int k = 0; k < 4; k++) {
        char specimen[128];
        snprintf(specimen, sizeof specimen, "{lattice: {kind: cubic, radius: 1 mm, cells: %s}}",
                 cells[k]);
        gn_world *w = made(3, specimen, "{stiffness: polyhedron}", "");
        for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++)
            assert_close(w->dem.bonds.contacts.area[c], 4e-6,
                         1e-6); /* the computation of cells shifts points by 1e-8 */
        world_end(w);
    }
}

/* A bond compressed to ten times its tensile strength does not break, and breaks in shear at the
 * same force as without compression; with friction of the bond at tau + mu_1 times the pressure. */
static void a_pressed_bar_breaks_in_shear_by_its_strength_under_pressure(void **state) {
    (void)state;
    const double dt = 1e-9, shear = young / 2.4, friction[] = {0.0, 0.4};
    for (int k = 0; k < 2; k++) {
        char contacts[80];
        snprintf(contacts, sizeof contacts, "contacts: [{between: m, bond_friction: %g}]\n",
                 friction[k]);
        gn_world *w = driven_with(contacts, 3, "{stiffness: dempack, gamma: 1}",
                                  "vx: [[0, -1], [6.35e-6, -1], [6.351e-6, 0], [1, 0]], "
                                  "vy: [[0, 0], [6.35e-6, 0], [6.351e-6, 0.5], [1, 0.5]]",
                                  0.0, dt);
        double pressure = alpha * young * 6.3505e-6 / distance;
        double wait = (tau + friction[k] * pressure) / (beta * shear) * distance / 0.5;
        while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.time < 6.35e-6 + 2.0 * wait)
            run_steps(w, 1);
        assert_int_equal(w->dem.bonds.contacts.cause[0], GN_BROKEN_SHEAR);
        assert_near(w->dem.bonds.contacts.broken_time[0], 6.351e-6 + wait, 0.01 * wait);
        world_end(w);
    }
}

static void pairs_that_meet_later_have_dempacks_section(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        bool space = dimension == 3;
        gn_world *w =
            world_of("dimension: %d\nspecimen: {particles: [[0, %s1e-3], [3.05e-3, %s2e-3]]}\n%s"
                     "law: {stiffness: polyhedron, gamma: 0.7}\nneighbours: {skin: 1e-4}\n"
                     "time: {end: 1}\nrun: {threads: 1}\n",
                     dimension, space ? "0, 0, " : "0, ", space ? "0, 0, " : "0, ", matter);
        assert_int_equal(w->dem.pairs.contacts.soa.count, 1);
        double area = pair_section(dimension, false, 0.7);
        assert_close(w->dem.pairs.contacts.kn[0], alpha * young * area / (r1 + r2), 1e-14);
        assert_close(w->dem.pairs.contacts.kt[0], beta * young / 2.4 * area / (r1 + r2), 1e-14);
        world_end(w);
    }
}

/* Unbonded contacts at the start do not form a body. */
static void without_bonds_gamma_is_one(void **state) {
    (void)state;
    gn_world *w =
        world_of("specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [1, 0, 0, 1e-3]]}\n%s"
                 "law: {stiffness: dempack}\ntime: {end: 1}\nrun: {threads: 1}\n",
                 matter);
    assert_int_equal(w->dem.pairs.contacts.soa.count, 1);
    assert_close(w->dem.pairs.contacts.kn[0], alpha * young * pi * 1e-6 / 2e-3, 1e-14);
    world_end(w);
}

static void unlike_materials_are_in_series(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]], material: a}\n"
        "materials: [{name: a, density: 1, young: 1e9, poisson: 0, tensile_strength: 1, "
        "shear_strength: 4}, {name: b, density: 1, young: 3e9, poisson: 0.5, alpha: 3, beta: 2, "
        "tensile_strength: 2, shear_strength: 3}]\nlaw: {stiffness: dempack, gamma: 1}\n"
        "bonds: {}\nsets: [{name: s, select: {ids: [1]}, material: b}]\ntime: {end: 1}\n"
        "run: {threads: 1}\n");
    double area = pi * 1e-6, bar = area / 2e-3;
    assert_close(w->dem.bonds.contacts.kn[0], 1.5 * 1.5e9 * bar, 1e-14); /* alpha 1 and 3 */
    assert_close(w->dem.bonds.contacts.kt[0], (4.0 / 3.0) * (2.0 / 3.0) * 1e9 * bar,
                 1e-14); /* G .5, 1 */
    assert_close(w->dem.bonds.contacts.rn[0], area, 1e-14);
    assert_close(w->dem.bonds.contacts.rt[0], 3.0 * area, 1e-14);
    world_end(w);
}

/* --- bodies --- */

/* Stiffness of uniform strain along axes, Pa: c[a][b] = sigma_aa for a unit strain along b. */
static void stiffness_of(const gn_world *w, double volume, double c[3][3]) {
    memset(c, 0, 9 * sizeof(double));
    const gn_contacts *k = &w->dem.bonds.contacts;
    for (size_t m = 0; m < k->soa.count; m++) {
        double n[3], length = sqrt(gn_branch(&w->ctx, w->dem.particles.pos + 4 * (int64_t)k->i[m],
                                             w->dem.particles.pos + 4 * (int64_t)k->j[m], n));
        for (int a = 0; a < 3; a++) n[a] /= length;
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                double along = n[a] * n[a] * n[b] * n[b];
                c[a][b] += length * length / volume *
                           (k->kn[m] * along + k->kt[m] * ((a == b ? n[a] * n[a] : 0.0) - along));
            }
    }
}

/* In-plane constants of the hexagonal lattice of Tavarez and Plesha (2007, quoted in Santasusana
 * 2013, 5.5-5.6): k_n = E* t/(sqrt(3) (1 - nu*)), k_t = k_n (1 - 3 nu*)/(1 + nu*). */
static void the_hexagonal_lattice_is_that_of_tavarez_and_plesha(void **state) {
    (void)state;
    const char *laws[] = {"{stiffness: dempack}", "{stiffness: polyhedron}"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = periodic(&lattices[1], laws[k]);
        double c[3][3], rho = ratio_of_springs();
        stiffness_of(w, w->ctx.volume, c);
        assert_close(c[0][0], c[1][1], 1e-12);
        double nu = c[0][1] / c[0][0], e = c[0][0] * (1.0 - nu * nu);
        assert_close(w->dem.bonds.contacts.kn[0], e / (sqrt(3.0) * (1.0 - nu)), 1e-12);
        assert_close(w->dem.bonds.contacts.kt[0],
                     w->dem.bonds.contacts.kn[0] * (1.0 - 3.0 * nu) / (1.0 + nu), 1e-12);
        assert_close(e, 2.0 * alpha * young * (1.0 + rho) / (3.0 + rho), 1e-12);
        assert_close(nu, (1.0 - rho) / (3.0 + rho), 1e-12);
        world_end(w);
    }
}

/* Uniform contraction of a packing: the same stress alpha E times the strain in every bond, and a
 * bulk modulus alpha E/d times the part of the body that the sections fill. Measured as in a run:
 * particles are displaced, then one step is taken. */
static void a_contracted_packing_has_one_stress_in_every_bond(void **state) {
    (void)state;
    const char *shapes[] = {"{rectangle: {width: 0.02, height: 0.04}, particles: 300}",
                            "{box: {size: [0.02, 0.02, 0.02]}, particles: 300}"};
    const char *laws[] = {"{stiffness: dempack, gamma: 0.4}", "{stiffness: polyhedron}"};
    for (int k = 0; k < 4; k++) {
        int dimension = 2 + k / 2;
        const double strain = 1e-6;
        gn_world *w = made(dimension, shapes[k / 2], laws[k % 2], "");
        for (size_t p = 0; p < w->dem.particles.soa.count; p++)
            for (int a = 0; a < 3; a++) w->dem.particles.pos[4 * p + a] *= 1.0 - strain;
        double filled = check_of(w).filled, want = alpha * young * strain, trace = 0.0;
        measured_step(w);
        for (int a = 0; a < dimension; a++) trace -= w->ledger.stress[4 * a];
        assert_close(trace / dimension, want * filled, 1e-5); /* strains of 1e-6 are not small */
        for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++) {
            gn_law_held h =
                gn_law_linear.held(&w->dem.bonds.contacts, c, w->dem.bonds.contacts.length0[c],
                                   -strain * w->dem.bonds.contacts.length0[c]);
            assert_close(-h.normal / w->dem.bonds.contacts.area[c], want, 1e-12);
        }
        world_end(w);
    }
}

/* For n bonds in random directions the sum of n_z^4 scatters by 4/3/sqrt(n), so E along an axis by
 * about as much; the tolerance is three times that, for each of three axes. */
static void a_packing_has_the_modulus_of_uniform_strain_along_every_axis(void **state) {
    (void)state;
    gn_world *w =
        made(3, "{box: {size: [0.02, 0.02, 0.02]}, particles: 600}", "{stiffness: polyhedron}", "");
    double c[3][3], rho = ratio_of_springs(),
                    scatter = 4.0 / sqrt((double)w->dem.bonds.contacts.soa.count);
    double want = alpha * young * (2.0 + 3.0 * rho) / (4.0 + rho) * check_of(w).filled;
    stiffness_of(w, w->ctx.volume, c);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, d = (a + 2) % 3;
        double minor = c[b][b] * c[d][d] - c[b][d] * c[b][d];
        double det = c[a][a] * minor - c[a][b] * (c[a][b] * c[d][d] - c[b][d] * c[a][d]) +
                     c[a][d] * (c[a][b] * c[b][d] - c[b][b] * c[a][d]);
        assert_close(det / minor, want, scatter);
    }
    world_end(w);
}

static void polyhedra_and_their_free_faces_fill_a_packing(void **state) {
    (void)state;
    const char *shapes[] = {"{rectangle: {width: 0.02, height: 0.04}, particles: 500}",
                            "{box: {size: [0.02, 0.02, 0.02]}, particles: 1000}",
                            "{cylinder: {diameter: 0.02, height: 0.03}, particles: 1000}"};
    for (int k = 0; k < 3; k++) {
        gn_world *w = made(k ? 3 : 2, shapes[k], "{stiffness: polyhedron}", "");
        gn_area_check check = check_of(w);
        /* The source's sections of cuts are off by up to 3.3 %. */
        assert_near(check.filled + check.free, 1.0, 0.033);
        assert_true(check.open > 0 && check.free > 0.0);
        world_end(w);
    }
}

/* --- steps --- */

static double square_of(const gn_law_model *m, double ri, double rj, const gn_material *a,
                        bool most) {
    gn_law_pair pair = {.a = a, .b = a, .ri = ri, .rj = rj};
    gn_area_parameters p = most ? gn_area_meeting(m, &pair) : gn_area_parameters_of(m, &pair);
    int d = (int)m->scene->dimension;
    return p.kn * (1.0 / pow(ri, d) + 1.0 / pow(rj, d));
}

/* The limit examines pairs of the smallest and the largest radius: no pair in between may exceed
 * them. */
static void no_pair_exceeds_those_of_extreme_radii(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_scene scene = {.dimension = dimension, .stiffness = GN_STIFFNESS_DEMPACK};
        gn_law_model m = {.scene = &scene, .derived = {.gamma = 0.5}};
        const gn_material a = {.young = 1e9, .poisson = 0.2, .alpha = 1.0, .beta = 1.0};
        for (double ratio = 1.0; ratio < 100.0; ratio *= 1.3) {
            double most = 0.0;
            for (int k = 0; k < 4; k++)
                most = fmax(most, square_of(&m, k & 1 ? 1e-3 : ratio * 1e-3,
                                            k & 2 ? 1e-3 : ratio * 1e-3, &a, true));
            for (int i = 0; i <= 20; i++)
                for (int j = 0; j <= 20; j++) {
                    double ri = 1e-3 * pow(ratio, i / 20.0), rj = 1e-3 * pow(ratio, j / 20.0);
                    double now = square_of(&m, ri, rj, &a, false);
                    assert_true(now <= most * (1.0 + 1e-12));
                    assert_true(now <= square_of(&m, ri, rj, &a, true) * (1.0 + 1e-12));
                }
        }
    }
}

/* --- refusals --- */

static void refuse(const char *material, const char *law, const char *expected) {
    char scene[1024];
    gneiss_error error = {0};
    gn_world w;
    snprintf(scene, sizeof scene,
             "specimen: {particles: [[0, 0, 0, 1], [2, 0, 0, 1]]}\n"
             "materials: [{name: m, density: 1, %s}]\nlaw: %s\nbonds: {}\ntime: {end: 1}\n",
             material, law);
    assert_int_equal(world_try(&w, scene, NULL, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, expected)) fail_msg("%s", error.message);
}

static void missing_and_unread_keys_are_refused(void **state) {
    (void)state;
    const char *strong = "young: 1, poisson: 0, tensile_strength: 1, shear_strength: 1";
    refuse("poisson: 0.2", "{stiffness: dempack}",
           "s.yaml:2:13: materials[0].young: required by laws by area, but not given");
    refuse("young: 1", "{stiffness: polyhedron}",
           "materials[0].poisson: required by laws by area, but not given");
    refuse("young: 1, poisson: 0", "{stiffness: polyhedron}",
           "materials[0].tensile_strength: required by bonds of this law.stiffness");
    refuse("young: 1, poisson: 0.6", "{stiffness: polyhedron}",
           "materials[0].poisson: expected a value in (-1, 0.5] or 'none', found '0.6'");
    refuse(strong, "{stiffness: dempack, gamma: 0}",
           "s.yaml:3:34: law.gamma: expected a value in [1e-6, 1e6] or 'auto', found '0'");
    refuse(strong, "{stiffness: dempack, gamma: 1, gamma_rule: porosity}",
           "s.yaml:3:49: law.gamma_rule: needs gamma auto; found a number");
    refuse("kratio: 1, contact_modulus: 1, tensile_strength: 1, shear_strength: 1",
           "{stiffness: harmonic, gamma: 1}",
           "s.yaml:3:35: law.gamma: needs stiffness dempack or polyhedron");
}

/* Spheres that overlap so much that the volume has no pores. */
static void a_body_without_pores_has_no_gamma_by_porosity(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_world w;
    char scene[1024];
    snprintf(scene, sizeof scene,
             "specimen: {lattice: {kind: cubic, radius: 1, cells: [4, 4, 4], spacing: 0.6}}\n%s"
             "law: {stiffness: dempack, gamma_rule: porosity}\nbonds: {}\n"
             "periodic: {min: [0, 0, 0], max: [4.8, 4.8, 4.8]}\ntime: {end: 1}\n",
             matter);
    assert_int_equal(world_try(&w, scene, NULL, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, "law.gamma_rule: expected a specimen with pores"))
        fail_msg("%s", error.message);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polyhedra_fill_lattices),
        cmocka_unit_test(sections_at_a_skin_are_those_inside),
        cmocka_unit_test(dempacks_sections_fill_any_body_by_themselves),
        cmocka_unit_test(gamma_of_the_source_is_forty_times_porosity_over_neighbours),
        cmocka_unit_test(the_ratio_is_that_of_the_regular_solids),
        cmocka_unit_test(a_flat_skin_misses_the_faces_that_the_lattice_had),
        cmocka_unit_test(neighbours_around_a_large_hole_are_extrapolated),
        cmocka_unit_test(one_and_two_neighbours_are_those_of_a_column),
        cmocka_unit_test(two_spheres_are_a_bar),
        cmocka_unit_test(a_bar_breaks_at_its_strain),
        cmocka_unit_test(a_bar_breaks_when_one_end_turns),
        cmocka_unit_test(plates_and_columns_have_square_sections),
        cmocka_unit_test(a_pressed_bar_breaks_in_shear_by_its_strength_under_pressure),
        cmocka_unit_test(pairs_that_meet_later_have_dempacks_section),
        cmocka_unit_test(without_bonds_gamma_is_one),
        cmocka_unit_test(unlike_materials_are_in_series),
        cmocka_unit_test(the_hexagonal_lattice_is_that_of_tavarez_and_plesha),
        cmocka_unit_test(a_contracted_packing_has_one_stress_in_every_bond),
        cmocka_unit_test(a_packing_has_the_modulus_of_uniform_strain_along_every_axis),
        cmocka_unit_test(polyhedra_and_their_free_faces_fill_a_packing),
        cmocka_unit_test(no_pair_exceeds_those_of_extreme_radii),
        cmocka_unit_test(missing_and_unread_keys_are_refused),
        cmocka_unit_test(a_body_without_pores_has_no_gamma_by_porosity),
    };
    return cmocka_run_group_tests_name("areas", tests, NULL, NULL);
}
