/* Bodies of finite elements at rest: meshes, loads, reactions, and refused input. */
#include "fem_patch.h"

#include <unistd.h>

/* --- meshes --- */

static void structured_meshes_fill_their_box(void **state) {
    (void)state;
    for (int kind = 0; kind < BODY_KINDS; kind++) {
        const int d = dimension_of(kind);
        if (kind & MIXED) continue;
        gn_fem_solid *solid = distorted_kind(kind);
        double volume = sizes[d - 2][0] * sizes[d - 2][1] * (d == 3 ? sizes[1][2] : 1.0);
        assert_close(solid->volume, volume, 1e-13);
        assert_close(solid->mass, volume * rock.density, 1e-13);
        assert_int_equal(solid->turned_elements, 0);
        assert_int_equal(solid->unused_nodes, 0);
        double mass = 0.0;
        for (size_t n = 0; n < solid->nodes.soa.count; n++)
            mass += 1.0 / solid->nodes.vel[4 * n + 3];
        assert_close(mass, solid->mass, 1e-13);
        body_end(solid);
    }
}

/* Twice the area of a facet along direction k, positive outward. */
static double facet_along(const gn_mesh *m, const int32_t *node, int d, int k) {
    const double *x = m->node + 3 * node[0], *y = m->node + 3 * node[1], *z = m->node + 3 * node[2];
    if (d == 2) return k == 0 ? 2.0 * (y[1] - x[1]) : 2.0 * (x[0] - y[0]);
    const int p = (k + 1) % 3, q = (k + 2) % 3;
    return (y[p] - x[p]) * (z[q] - x[q]) - (y[q] - x[q]) * (z[p] - x[p]);
}

/* Facets of a side lie in it and have outward normals. */
static void check_sides(const gn_mesh *mesh, int d, const double size[3]) {
    const gn_mesh_elements *sides = d == 3 ? &mesh->triangles : &mesh->lines;
    for (size_t f = 0; f < sides->count; f++) {
        const int32_t *node = sides->node + (size_t)sides->nodes * f;
        const int side = sides->group[f] - 2, k = side / 2;
        if (sides->group[f] < 2) continue;
        assert_in_range(side, 0, 2 * d - 1);
        assert_true((side % 2 ? 1.0 : -1.0) * facet_along(mesh, node, d, k) > 0.0);
        for (int n = 0; n < sides->nodes; n++)
            assert_true(mesh->node[3 * node[n] + k] == (side % 2 ? size[k] : 0.0));
    }
}

/* The facets of the sides are those of the elements: the boundary of the mesh has no others; where
 * sides join they share whole faces. */
static void sides_of_structured_meshes_are_their_boundary(void **state) {
    (void)state;
    static const int many[][3] = {{9, 6, 0}, {1, 1, 0}, {5, 4, 4}, {1, 1, 1}, {1, 2, 1}, {3, 1, 1}};
    for (size_t v = 0; v < 2 * sizeof many / sizeof *many; v++) {
        const int *count_of = many[v / 2], d = count_of[2] ? 3 : 2;
        gn_mesh mesh = split_mesh_of(sizes[d - 2], count_of, 0.1, v % 2);
        gneiss_error error = {0};
        const gn_mesh_elements *sides = d == 3 ? &mesh.triangles : &mesh.lines;
        size_t count = sides->count, cell_sides = 0;
        for (int k = 0; k < d; k++)
            cell_sides += 2 * (size_t)(d == 3 ? count_of[(k + 1) % 3] * count_of[(k + 2) % 3]
                                              : count_of[1 - k]);
        assert_int_equal(count, d == 3 ? 2 * cell_sides : cell_sides);
        check_sides(&mesh, d, sizes[d - 2]);
        if (gn_mesh_boundary(&mesh, d, "box", &error) != GNEISS_OK) fail_msg("%s", error.message);
        assert_int_equal(sides->count, count);
        for (size_t f = 0; f < sides->count; f++) assert_in_range(sides->group[f], 2, 1 + 2 * d);
        gn_mesh_free(&mesh);
    }
}

static void a_cell_has_six_tetrahedra_round_its_diagonal(void **state) {
    (void)state;
    gn_mesh mesh = split_mesh_of((double[]){3.0, 2.0, 1.0}, (int[]){1, 1, 1}, 0.0, true);
    assert_int_equal(mesh.node_count, 8);
    assert_int_equal(mesh.tetrahedra.count, 6);
    for (size_t e = 0; e < 6; e++) {
        const int32_t *node = mesh.tetrahedra.node + 4 * e;
        double edge[3][3];
        int ends = 0;
        for (int a = 0; a < 4; a++) ends += node[a] == 0 || node[a] == 7;
        assert_int_equal(ends, 2);
        for (int a = 0; a < 3; a++)
            for (int k = 0; k < 3; k++)
                edge[a][k] = mesh.node[3 * node[a + 1] + k] - mesh.node[3 * node[0] + k];
        assert_close(determinant(edge), 3.0 * 2.0 * 1.0, 1e-15); /* six times a sixth */
    }
    gn_mesh_free(&mesh);
}

static void nodes_and_elements_lie_close_together(void **state) {
    (void)state;
    const double size[3] = {1.0, 1.0, 1.0};
    const int many[3] = {20, 20, 20};
    gn_fem_spec spec = spec_of(3, &rock);
    gn_fem_solid *solid = body_of(&spec, mesh_of(size, many, 0.0));
    /* A block of 1024 elements has about as many nodes as a cube of 205 cells, 7^3; along the curve
     * cubes are cut in pieces. */
    const gn_partials *q = &solid->partials;
    assert_true(q->length >= 512);
    assert_true((double)q->first[q->blocks] / (double)q->blocks < 0.55 * (double)q->length);
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        assert_memory_equal(solid->nodes.start + 4 * n, solid->mesh.node + 3 * n,
                            3 * sizeof(double));
    body_end(solid);
}

/* --- loads --- */

static void a_traction_gives_its_area_times_itself(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_solid *solid = distorted_body(d, GN_FEM_DISPLACEMENT);
        const double traction[3] = {3e4, -2e4, d == 3 ? 1e4 : 0.0};
        double area = sizes[d - 2][1] * (d == 3 ? sizes[1][2] : 1.0), sum[3] = {0.0}, moment = 0.0;
        assert_int_equal(set_traction(solid, "x_upper", traction, NULL), GNEISS_OK);
        for (size_t n = 0; n < solid->nodes.soa.count; n++) {
            const double *f = solid->nodes.applied + 4 * n, *x = solid->nodes.start + 4 * n;
            for (int k = 0; k < 3; k++) sum[k] += f[k];
            moment += x[1] * f[0];
            assert_true(f[0] == 0.0 || x[0] == sizes[d - 2][0]);
        }
        for (int k = 0; k < d; k++) assert_close(sum[k], traction[k] * area, 1e-13);
        assert_close(moment, 0.5 * sizes[d - 2][1] * traction[0] * area, 1e-13);
        body_end(solid);
    }
}

static void hold(gn_fem_solid *solid, const char *group, unsigned mask, int32_t *motion) {
    const double rest[3] = {0.0};
    gn_fem_set set;
    gneiss_error error = {0};
    if (gn_fem_nodes_of_group(solid, group, &set, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    assert_int_equal(gn_fem_prescribe(solid, &set, mask, rest, motion, &error), GNEISS_OK);
    gn_fem_set_free(&set);
}

/* A block on rollers under its weight and a load on top. */
static void reactions_carry_weight_and_loads(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_spec spec = spec_of(d, &rock);
        const double traction[3] = {0.0, -1e4, 0.0};
        int32_t below, left, back;
        double force[3], area = sizes[d - 2][0] * (d == 3 ? sizes[1][2] : 1.0);
        spec.gravity[1] = -9.81;
        spec.damping = GN_FX_VISCOUS;
        spec.damping_coefficient = 1e4;
        gn_fem_solid *solid = body_of(&spec, mesh_of(sizes[d - 2], cells[d - 2], 0.1));
        hold(solid, "y_lower", 2, &below);
        hold(solid, "x_lower", 1, &left);
        if (d == 3) hold(solid, "z_lower", 4, &back);
        assert_int_equal(set_traction(solid, "y_upper", traction, NULL), GNEISS_OK);
        double dt = 0.9 * fem_limits(solid).sharp;
        for (int s = 0; s < 6000; s++) fem_step(solid, dt, s == 0);
        fem_step(solid, dt, true);
        gn_fem_reaction(solid, below, force);
        assert_close(force[1], 9.81 * solid->mass + 1e4 * area, 1e-8);
        assert_true(force[0] ==
                    0.0); /* the facet belongs to the side, although it has a corner of the base */
        gn_fem_reaction(solid, left, force);
        assert_near(force[0], 0.0, 1e-8 * 1e4 * area);
        double scale = solid->reading.work_gravity + solid->reading.work_applied;
        /* The ledger is exact for a linear law; the residual here is of the size of strains. */
        assert_near(energy_residual(&solid->reading), 0.0, 1e-6 * scale);
        assert_true(solid->reading.damping > 0.1 * scale);
        body_end(solid);
    }
}

/* Uniaxial strain by moving sides: the reaction is the confined modulus, and its work is stored. */
static void prescribed_strain_gives_the_confined_stress(void **state) {
    (void)state;
    gn_fem_spec spec = spec_of(2, &rock);
    spec.damping = GN_FX_VISCOUS;
    spec.damping_coefficient = 1e4;
    gn_fem_solid *solid = body_of(&spec, mesh_of(sizes[0], cells[0], 0.1));
    int32_t left, below, above, right;
    hold(solid, "y_lower", 2, &below);
    hold(solid, "y_upper", 2, &above);
    hold(solid, "x_lower", 1, &left);
    hold(solid, "x_upper", 1, &right);
    double dt = 0.9 * fem_limits(solid).sharp, force[3];
    const double pull[3] = {1e-6 / (500.0 * dt), 0.0, 0.0}, rest[3] = {0.0};
    gn_fem_set_velocity(solid, right, pull);
    for (int s = 0; s < 500; s++) fem_step(solid, dt, s == 0);
    gn_fem_set_velocity(solid, right, rest);
    for (int s = 0; s < 6000; s++) fem_step(solid, dt, false);
    fem_step(solid, dt, true);
    gn_fem_reaction(solid, right, force);
    assert_close(force[0], confined(&rock) * 1e-6 * sizes[0][1],
                 1e-5); /* the strain is 1e-6, and the law is not linear */
    gn_fem_reaction(solid, left, force);
    assert_close(force[0], -confined(&rock) * 1e-6 * sizes[0][1], 1e-5);
    assert_near(energy_residual(&solid->reading), 0.0, 1e-6 * solid->reading.work_prescribed);
    body_end(solid);
}

static void two_materials_meet_with_the_same_stress(void **state) {
    (void)state;
    const double size[3] = {2.0, 1.0, 0.0};
    const int grid[3] = {8, 4, 0};
    gn_mesh mesh = mesh_of(size, grid, 0.0);
    const gn_fem_material both[2] = {{.young = 10e9, .poisson = 0.2, .density = 2000.0},
                                     {"hard", 30e9, 0.2, 2600.0}};
    /* The group of all elements is replaced by one of the right half. */
    snprintf(mesh.groups[mesh.group_count - 1].name, GN_MESH_NAME_SIZE, "hard");
    for (size_t e = 0; e < mesh.triangles.count; e++) {
        double x = 0.0;
        for (int a = 0; a < 3; a++)
            x += mesh.node[3 * mesh.triangles.node[3 * e + (size_t)a]] / 3.0;
        mesh.triangles.group[e] = x > 1.0 ? 1 : 99;
    }
    gn_fem_spec spec = spec_of(2, both);
    spec.material_count = 2;
    gn_fem_solid *solid = body_of(&spec, mesh);
    assert_close(solid->mass, 2000.0 + 2600.0, 1e-13);
    for (size_t e = 0; e < solid->elements.soa.count; e++) {
        double x = 0.0;
        for (int a = 0; a < 3; a++)
            x += solid->nodes.start[4 * (size_t)gn_elements_node(&solid->elements, a)[e]] / 3.0;
        assert_close(solid->elements.mu[e], lame_mu(&both[x > 1.0]), 1e-14);
    }
    /* Under uniaxial strain both halves carry the same stress when strains are inversely
     * proportional to moduli. */
    for (size_t n = 0; n < solid->nodes.soa.count; n++) {
        double *x = solid->nodes.pos + 4 * n;
        x[0] += 3e-7 * fmin(x[0], 1.0) + 1e-7 * fmax(x[0] - 1.0, 0.0);
    }
    fem_evaluate(solid);
    for (size_t n = 0; n < solid->nodes.soa.count; n++) {
        const double *x = solid->nodes.start + 4 * n;
        double force[3];
        fem_force(&solid->partials, (int32_t)n, force);
        if (x[0] > 0.0 && x[0] < 2.0)
            assert_near(force[0], 0.0, 1e-6 * confined(&both[0]) * 3e-7 * 0.25);
    }
    body_end(solid);
}

/* Two triangles of a unit square, the second one inverted, and a node without elements. */
static const char square_msh[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n2\n1 7 \"base\"\n2 9 \"rock\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n10 1 1 0\n20 0 0 0\n30 5 5 0\n40 1 0 0\n50 0 1 0\n$EndNodes\n"
    "$Elements\n3\n1 1 2 7 1 20 40\n2 2 2 9 1 20 40 10\n3 2 2 9 1 20 50 10\n$EndElements\n";

static void a_gmsh_file_becomes_a_body(void **state) {
    (void)state;
    char path[] = "/tmp/gneiss_fem_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && write(file, square_msh, strlen(square_msh)) > 0);
    close(file);
    gn_mesh mesh;
    gneiss_error error = {0};
    gneiss_status status = gn_mesh_read_msh(path, 2.0, &mesh, &error);
    remove(path);
    if (status != GNEISS_OK) fail_msg("%s", error.message);
    gn_fem_material m = rock;
    m.group = "rock";
    gn_fem_spec spec = spec_of(2, &m);
    gn_fem_solid *solid = body_of(&spec, mesh);
    int32_t motion;
    hold(solid, "base", 3, &motion);
    assert_int_equal(solid->prescribed.count, 2);
    assert_int_equal(solid->unused_nodes, 1);
    assert_int_equal(solid->turned_elements, 1);
    assert_close(solid->mass, 4.0 * rock.density, 1e-14);
    body_end(solid);
}

/* --- refused input --- */

static void assert_refused(gn_fem_spec spec, gn_mesh mesh, const char *part) {
    gn_fem_solid solid;
    gneiss_error error = {0};
    assert_int_equal(gn_fem_solid_create(&spec, &mesh, &solid, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, part)) fail_msg("'%s' is not in: %s", part, error.message);
    assert_null(solid.nodes.pos);
}

static gn_mesh plain_mesh(int d) {
    return mesh_of(sizes[d - 2], cells[d - 2], 0.0);
}

static void incompressible_material_is_refused(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_material m = rock;
        m.poisson = 0.5;
        assert_refused(spec_of(d, &m), plain_mesh(d),
                       "expected Poisson's ratio > -1 and < 0.5, because the explicit displacement "
                       "form has no stable step");
        m.poisson = NAN;
        assert_refused(spec_of(d, &m), plain_mesh(d), "found nan");
        gn_fem_spec mixed = spec_of(d, &m);
        mixed.form = GN_FEM_PRESSURE;
        m.poisson = 0.5;
        assert_refused(mixed, plain_mesh(d),
                       "expected Poisson's ratio > -1 and < 0.5, because the explicit mixed form "
                       "has no stable step");
        mixed.form = (gn_fem_form)7;
        assert_refused(mixed, plain_mesh(d), "found form 7");
    }
}

static void a_missing_group_is_named_with_those_there_are(void **state) {
    (void)state;
    gn_fem_material m = rock;
    m.group = "granite";
    assert_refused(spec_of(3, &m), plain_mesh(3),
                   "expected a physical group 'granite' of tetrahedron elements with elements, "
                   "found 'x_lower' (tag 2, 2D), 'x_upper' (tag 3, 2D)");
    gn_fem_solid *solid = distorted_body(2, GN_FEM_DISPLACEMENT);
    gn_fem_set set;
    gneiss_error error = {0};
    const double traction[3] = {1.0, 0.0, 0.0};
    assert_int_equal(gn_fem_nodes_of_group(solid, "lid", &set, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "expected a physical group 'lid'"));
    assert_int_equal(set_traction(solid, "body", traction, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "expected a physical group 'body' of line elements"));
    const double low[3] = {2.0, 2.0, 2.0}, high[3] = {3.0, 3.0, 3.0};
    assert_int_equal(gn_fem_nodes_in_box(solid, low, high, &set, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "expected nodes in the box from (2, 2, 2)"));
    body_end(solid);
}

static void elements_without_a_material_are_refused(void **state) {
    (void)state;
    gn_mesh mesh = plain_mesh(2);
    gn_fem_material m = rock;
    m.group = "body";
    mesh.triangles.group[17] = 0;
    assert_refused(spec_of(2, &m), mesh, "found none for number 17 (base 0)");
}

static void a_mesh_without_elements_is_refused(void **state) {
    (void)state;
    assert_refused(spec_of(1, &rock), plain_mesh(2), "expected dimension 2 or 3, found 1");
    assert_refused(spec_of(3, &rock), plain_mesh(2),
                   "expected a mesh with tetrahedron elements, found none");
}

static void elements_without_volume_are_refused_by_number(void **state) {
    (void)state;
    gn_mesh mesh = plain_mesh(3);
    mesh.tetrahedra.node[4 * 31 + 2] = mesh.tetrahedra.node[4 * 31 + 1];
    assert_refused(spec_of(3, &rock), mesh, "found tetrahedron 31 (base 0)");
}

static void a_bent_plane_is_refused(void **state) {
    (void)state;
    gn_mesh mesh = plain_mesh(2);
    mesh.node[3 * 5 + 2] = 0.01;
    assert_refused(spec_of(2, &rock), mesh,
                   "expected all nodes in one plane z = 0 m, found node 5");
}

static void wrong_order_of_nodes_is_corrected(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_mesh mesh = plain_mesh(d);
        gn_mesh_elements *list = d == 3 ? &mesh.tetrahedra : &mesh.triangles;
        for (size_t e = 0; e < list->count; e += 3) { /* turned inside out */
            int32_t *node = list->node + (size_t)(d + 1) * e, first = node[0];
            node[0] = node[1];
            node[1] = first;
        }
        gn_fem_spec spec = spec_of(d, &rock);
        gn_fem_solid *solid = body_of(&spec, mesh);
        double f[3][3];
        assert_int_equal(solid->turned_elements, (solid->elements.soa.count + 2) / 3);
        small_deformation(d, f);
        place(solid, f);
        assert_stress(solid, f, strain_round_off(d));
        body_end(solid);
    }
}

/* A mesh without its last row of cells: the upper nodes of these remain, and the lines of the sides
 * that need them. */
static void unused_nodes_are_dropped_and_counted(void **state) {
    (void)state;
    gn_mesh mesh = plain_mesh(2);
    gn_fem_spec spec = spec_of(2, &rock);
    size_t nodes = mesh.node_count, lines = mesh.lines.count;
    gn_mesh larger = mesh_of((double[3]){1.0, 0.7, 0.0}, (int[3]){9, 7, 0}, 0.0);
    larger.triangles.count -= 18;
    gn_fem_solid *solid = body_of(&spec, larger);
    assert_int_equal(solid->unused_nodes, 10);
    assert_int_equal(solid->nodes.soa.count, nodes);
    assert_int_equal(solid->mesh.node_count, nodes);
    assert_int_equal(solid->mesh.lines.count,
                     lines - 9); /* the upper side and two lines beside it */
    gn_fem_set set;
    gneiss_error error = {0};
    assert_int_equal(gn_fem_nodes_of_group(solid, "y_upper", &set, &error), GNEISS_ERROR_INPUT);
    assert_int_equal(gn_fem_nodes_of_group(solid, "x_lower", &set, &error), GNEISS_OK);
    assert_int_equal(set.count, 7);
    for (size_t k = 0; k < set.count; k++) assert_true(solid->nodes.start[4 * set.node[k]] == 0.0);
    gn_fem_set_free(&set);
    gn_mesh_free(&mesh);
    body_end(solid);
}

static void an_inverted_element_stops_the_run_with_its_number(void **state) {
    (void)state;
    for (int v = 0; v < 4; v++) {
        const int d = v & 1 ? 3 : 2;
        gn_fem_solid *solid = distorted_body(d, v & 2 ? GN_FEM_PRESSURE : GN_FEM_DISPLACEMENT);
        const size_t e = 37;
        size_t node = (size_t)gn_elements_node(&solid->elements, 1)[e];
        char number[64];
        gneiss_error error = {0};
        /* Inverts element 37 alone through its opposite face: moves its node 1 so that det F =
         * -1/2. */
        double g[3], size2 = 0.0;
        for (int k = 0; k < d; k++) {
            g[k] = gn_elements_gradient(&solid->elements, 1, k)[e];
            size2 += g[k] * g[k];
        }
        for (int k = 0; k < d; k++) solid->nodes.pos[4 * node + (size_t)k] -= 1.5 * g[k] / size2;
        gn_fem_positions_changed(solid);
        assert_int_equal(gn_fem_step(solid, 1e-9, true, &error), GNEISS_ERROR_UNSTABLE);
        snprintf(number, sizeof number, "%s %d (base 0)", d == 3 ? "tetrahedron" : "triangle",
                 solid->elements.id[solid->elastic.element]);
        assert_true(solid->elastic.least <= -0.5 + 1e-12);
        assert_non_null(strstr(error.message, number));
        assert_non_null(strstr(error.message, "turned inside out: det F = -"));
        body_end(solid);
    }
}

static void too_much_distortion_is_refused(void **state) {
    (void)state;
    gn_structured s = {.size = {1.0, 1.0, 1.0}, .cells = {2, 2, 2}, .distortion = 0.25};
    gn_mesh mesh;
    gneiss_error error = {0};
    assert_int_equal(gn_mesh_rectangle(&s, &mesh, &error), GNEISS_ERROR_INPUT);
    assert_non_null(
        strstr(error.message, "expected a distortion from 0 to below 0.25, found 0.25"));
    s.distortion = 0.0;
    s.cells[2] = 0;
    assert_int_equal(gn_mesh_box(&s, &mesh, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "at least one cell along z"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(structured_meshes_fill_their_box),
        cmocka_unit_test(sides_of_structured_meshes_are_their_boundary),
        cmocka_unit_test(a_cell_has_six_tetrahedra_round_its_diagonal),
        cmocka_unit_test(nodes_and_elements_lie_close_together),
        cmocka_unit_test(a_traction_gives_its_area_times_itself),
        cmocka_unit_test(reactions_carry_weight_and_loads),
        cmocka_unit_test(prescribed_strain_gives_the_confined_stress),
        cmocka_unit_test(two_materials_meet_with_the_same_stress),
        cmocka_unit_test(a_gmsh_file_becomes_a_body),
        cmocka_unit_test(incompressible_material_is_refused),
        cmocka_unit_test(a_missing_group_is_named_with_those_there_are),
        cmocka_unit_test(elements_without_a_material_are_refused),
        cmocka_unit_test(a_mesh_without_elements_is_refused),
        cmocka_unit_test(elements_without_volume_are_refused_by_number),
        cmocka_unit_test(a_bent_plane_is_refused),
        cmocka_unit_test(wrong_order_of_nodes_is_corrected),
        cmocka_unit_test(unused_nodes_are_dropped_and_counted),
        cmocka_unit_test(an_inverted_element_stops_the_run_with_its_number),
        cmocka_unit_test(too_much_distortion_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
