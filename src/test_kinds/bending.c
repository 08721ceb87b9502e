/* A beam of width b on supports S apart, under one load F at mid-span, or two loads that share it
 * and are s apart. Let a = (S - s)/2 be the distance from a support to the nearest load. The stress
 * in the fibre below mid-span is M (h/2)/I = 3 F a/(b h^2), with the height that a notch leaves.
 * Without a notch a displacement d of the loads causes the strain 3 h d/(a (3 S - 4 a)) there. With
 * one load these are 3 F S/(2 b h^2) and 6 h d/S^2. */
#include "test_kinds/curves.h"

#include <math.h>

/* Returns the shorter one of the two sides across the load. */
static double least_side(const gn_tested_specimen *x) {
    return fmin(x->side[(x->axis + 1) % 3], x->side[(x->axis + 2) % 3]);
}

static gn_tested_shape beam(const gn_test_sizes *t, const gn_tested_specimen *x) {
    gn_tested_shape s = {0};
    s.height = t->height > 0.0 ? t->height : x->side[x->axis];
    s.thickness = x->dimension == 2 ? 1.0 : t->thickness > 0.0 ? t->thickness : least_side(x);
    const double arm = 0.5 * (t->span - t->load_span), left = s.height - t->notch;
    s.length = arm * (3.0 * t->span - 4.0 * arm) / (3.0 * s.height);
    s.area = s.thickness * left * left / (3.0 * arm);
    s.section = s.thickness * left;
    return s;
}

static void read_bending(const gn_curves *curves, gn_readings *readings) {
    const gn_reading modulus = GN_READING_flexural_modulus, opening = GN_READING_opening_at_peak;
    gn_line_fit f = gn_line(curves, curves->strain, curves->stress, curves->elastic);
    const double *gauge = gn_history_column(curves->history, "opening");
    const double *force = gn_history_column(curves->history, "force"),
                 *way = gn_history_column(curves->history, "deflection");
    gn_read_at_peak(curves, GN_READING_flexural_strength, curves->stress, 1.0,
                    &readings->flexural_strength, readings);
    gn_read_at_peak(curves, GN_READING_peak_force, force, 1.0, &readings->peak_force, readings);
    gn_need_elastic_rows(curves, GN_READING_stiffness, readings);
    if (force && way) {
        gn_line_fit s = gn_line(curves, way, force, curves->elastic);
        readings->stiffness = s.slope;
        gn_need_modulus(s, GN_READING_stiffness, readings);
    }
    readings->flexural_modulus = f.slope;
    gn_need_elastic_rows(curves, modulus, readings);
    gn_need_modulus(f, modulus, readings);
    if (curves->tested->notched)
        gn_reading_absent(readings, modulus,
                          "a notch: the strain of the fibre above it is not known");
    if (!gauge) gn_reading_absent(readings, opening, "the test has no gauge (test.opening)");
    gn_read_at_peak(curves, opening, gauge, 1.0, &readings->opening_at_peak, readings);
    gn_read_fracture_energy(curves, readings);
}

const gn_test_descriptor gn_test_bending = {
    .name = "bending",
    .ends = true,
    .beam = true,
    .sign = -1,
    .takes = GN_TAKES(thickness) | GN_TAKES(span) | GN_TAKES(load_span) | GN_TAKES(height) |
             GN_TAKES(notch),
    .needs = GN_TAKES(span),
    .peak_drop = 0.95, /* the fracture energy requires it, as in tension */
    .shape = beam,
    .area_source = "the force over it is the stress in the fibre below mid-span",
    .readings = GN_READS_LOADED | GN_READS(flexural_strength) | GN_READS(flexural_modulus) |
                GN_READS(peak_force) | GN_READS(stiffness) | GN_READS(opening_at_peak) |
                GN_READS(fracture_energy) | GN_READS(secant_modulus) | GN_READS(brittleness),
    .read = read_bending,
    .strain_name = "strain of the fibre by beam theory",
    .stress_name = "stress in the fibre by beam theory",
    .figures = {{GN_READING_flexural_strength, "flexural strength"},
                {GN_READING_flexural_modulus, "flexural modulus"},
                {GN_READING_fracture_energy, "fracture energy"},
                {GN_READING_opening_at_peak, "opening at the peak"}},
};
