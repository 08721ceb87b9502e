/* Patch test and rotation: solids of finite elements under homogeneous deformations, both forms. */
#include "fem_patch.h"

static void linear_displacements_leave_no_force_inside_and_exact_stress(void **state) {
    (void)state;
    for (int kind = 0; kind < BODY_KINDS; kind++) {
        const int d = dimension_of(kind);
        double f[3][3];
        gn_fem_solid *solid = deformed_kind(kind, f);
        fem_evaluate(solid);
        assert_stress(solid, f, strain_round_off(d));
        size_t inside = 0;
        for (size_t n = 0; n < solid->nodes.soa.count; n++) {
            double force[3], area = d == 3 ? 0.2 * 0.2 : 0.12;
            fem_force(&solid->partials, (int32_t)n, force);
            inside += !on_boundary(solid, n);
            for (int k = 0; k < d && !on_boundary(solid, n); k++)
                assert_near(force[k], 0.0, strain_round_off(d) * rock.young * area);
        }
        assert_int_equal(inside, d == 3 ? 4 * 3 * 3 : 8 * 5);
        body_end(solid);
    }
}

static void a_body_whose_boundary_moves_linearly_relaxes_to_linear_displacements(void **state) {
    (void)state;
    for (int kind = 0; kind < BODY_KINDS; kind++) {
        const int d = dimension_of(kind);
        gn_fem_spec spec = spec_of(d, &rock);
        spec.form = kind & MIXED ? GN_FEM_PRESSURE : GN_FEM_DISPLACEMENT;
        spec.damping = GN_FX_VISCOUS;
        spec.damping_coefficient = 2.0 * 4e3 * 3.14; /* 1/s, critical for waves of a metre or so */
        gn_fem_solid *solid = body_of(&spec, distorted_mesh(kind));
        double f[3][3], dt = 0.9 * fem_limits(solid).sharp;
        small_deformation(d, f);
        drive_boundary(solid, f, dt, DRIVE);
        for (int s = 0; s < 4000; s++) fem_step(solid, dt, false);
        const double off = DRIVE * 0x1p-53; /* number of roundings in the computed positions */
        for (size_t n = 0; n < solid->nodes.soa.count; n++)
            for (int k = 0; k < d; k++)
                assert_near(solid->nodes.pos[4 * n + (size_t)k],
                            dot3(f[k], solid->nodes.start + 4 * n), 2.0 * off);
        assert_stress(solid, f, 2.0 * strain_round_off(d) * DRIVE / ROUND_OFF);
        body_end(solid);
    }
}

static void large_homogeneous_deformation_gives_the_closed_form_of_the_material(void **state) {
    (void)state;
    for (int kind = 0; kind < BODY_KINDS; kind++) {
        const int d = dimension_of(kind);
        gn_fem_solid *solid = distorted_kind(kind);
        double f[3][3] = {{1.3, 0.4, 0.0}, {-0.2, 0.8, 0.0}, {0.0, 0.0, 1.0}}, s[3][3];
        if (d == 3) f[0][2] = 0.3;
        if (d == 3) f[2][1] = -0.25;
        place(solid, f);
        fem_evaluate(solid);
        assert_stress(solid, f, 4.0 * strain_round_off(d));
        double density = law(solid->form, f, s);
        assert_close(solid->reading.elastic, density * solid->volume, 1e-12);
        assert_close(solid->elastic.volume, determinant(f) * solid->volume, 1e-12);
        assert_close(solid->elastic.least, determinant(f), 1e-12);
        body_end(solid);
    }
}

static void a_full_turn_leaves_no_stress_at_any_angle(void **state) {
    (void)state;
    for (int kind = 0; kind < BODY_KINDS; kind++) {
        const int d = dimension_of(kind);
        gn_fem_solid *solid = distorted_kind(kind);
        const double axis[3] = {d == 3 ? 0.4 : 0.0, d == 3 ? -0.7 : 0.0, 1.0};
        double still[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}, r[3][3];
        for (int angle = 0; angle <= 360; angle += 15) {
            rotation(axis, angle * pi / 180.0, r);
            place(solid, r);
            fem_evaluate(solid);
            assert_stress(solid, still, strain_round_off(d));
            assert_near(solid->reading.elastic, 0.0,
                        rock.young * strain_round_off(d) * strain_round_off(d));
        }
        body_end(solid);
    }
}

static void nodal_stress_of_a_homogeneous_state_is_that_state(void **state) {
    (void)state;
    for (int kind = 0; kind < BODY_KINDS; kind++) {
        const int d = dimension_of(kind);
        double f[3][3];
        gn_fem_solid *solid = deformed_kind(kind, f);
        double(*element)[6] = calloc(solid->elements.soa.count, sizeof *element);
        double(*nodal)[6] = calloc(solid->nodes.soa.count, sizeof *nodal);
        gn_fem_element_stress(solid, element);
        assert_int_equal(gn_fem_nodal_stress(solid, (const double(*)[6])element, nodal, NULL),
                         GNEISS_OK);
        for (size_t n = 0; n < solid->nodes.soa.count; n++)
            for (int c = 0; c < 6; c++)
                assert_near(nodal[n][c], element[0][c], 2.0 * strain_round_off(d) * rock.young);
        free(element);
        free(nodal);
        body_end(solid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_displacements_leave_no_force_inside_and_exact_stress),
        cmocka_unit_test(a_body_whose_boundary_moves_linearly_relaxes_to_linear_displacements),
        cmocka_unit_test(large_homogeneous_deformation_gives_the_closed_form_of_the_material),
        cmocka_unit_test(a_full_turn_leaves_no_stress_at_any_angle),
        cmocka_unit_test(nodal_stress_of_a_homogeneous_state_is_that_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
