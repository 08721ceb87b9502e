/* A tool that moves along the surface of a rock at a depth (linear cutting test). Its force has
 * three parts: normal, out of the rock; rolling, against the motion; side, along normal x motion.
 * Means follow from impulses and are therefore exact for any number of rows. The strain of the test
 * is the path over its length. The stress is the rolling force over the section of the cut, which
 * is the energy per volume for a cut of that section. */
#include "test_kinds/curves.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* --- closed forms --- */

gn_csm gn_csm_of(const gn_cut *c) {
    const double arc = acos(fmax(-1.0, 1.0 - c->depth / c->radius));
    gn_csm f = {.arc = arc, .coefficient = tan(0.5 * arc)};
    f.pressure = 2.12 * cbrt(c->compressive * c->compressive * c->tensile * c->spacing /
                             (arc * sqrt(c->radius * c->tip_width)));
    f.total = c->tip_width * c->radius * arc * f.pressure / (1.0 + c->exponent);
    f.normal = f.total * cos(0.5 * arc);
    f.rolling = f.total * sin(0.5 * arc);
    return f;
}

/* Largest force along the cut, N. Chisel of width w and rake a (Evans 1962): 2 sigma_t d w sin q/(1
 * - sin q), q = (pi/2 - a)/2. Conical pick of semi-angle q (Evans 1984): 16 pi sigma_t^2
 * d^2/(sigma_c cos^2 q). */
static double evans_force(const gn_cut *c) {
    if (c->tool == GN_CUT_PICK)
        return 16.0 * pi * c->tensile * c->tensile * c->depth * c->depth /
               (c->compressive * cos(c->half_angle) * cos(c->half_angle));
    const double sine = sin(0.5 * (0.5 * pi - c->rake));
    return 2.0 * c->tensile * c->depth * c->width * sine / (1.0 - sine);
}

/* Conical pick (Goktan 1997): 4 pi d^2 sigma_t sin^2(q + f)/cos(q + f), f the angle of friction. */
static double goktan_force(const gn_cut *c) {
    const double angle = c->half_angle + c->friction;
    return 4.0 * pi * c->depth * c->depth * c->tensile * sin(angle) * sin(angle) / cos(angle);
}

/* --- curves over the path --- */

/* The rows of a cut: path, time, and the impulses of the three forces. */
typedef struct course {
    size_t rows;
    const double *path, *time, *impulse[3];
    double begin, end; /* m, range of the means; end <= begin: the tool has not come so far */
} course;

/* Returns a column at a place of the path, linear between rows; the path never decreases. */
static double at_path(const course *c, const double *column, double path) {
    size_t low = 0, high = c->rows - 1;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        *(c->path[middle] <= path ? &low : &high) = middle;
    }
    const double length = c->path[high] - c->path[low];
    const double share = length > 0.0 ? (path - c->path[low]) / length : 0.0;
    return column[low] + fmin(1.0, fmax(0.0, share)) * (column[high] - column[low]);
}

static double mean_force(const course *c, int k, double from, double to) {
    return (at_path(c, c->impulse[k], to) - at_path(c, c->impulse[k], from)) /
           (at_path(c, c->time, to) - at_path(c, c->time, from));
}

static double deviation(const course *c, int k, int blocks, double mean) {
    const double length = (c->end - c->begin) / blocks;
    double squares = 0.0;
    for (int b = 0; b < blocks; b++) {
        const double off =
            mean_force(c, k, c->begin + b * length, c->begin + (b + 1) * length) - mean;
        squares += off * off;
    }
    return blocks > 1 ? sqrt(squares / (blocks - 1)) : NAN;
}

/* Returns the largest mean over a window that begins or ends in a row. */
static double peak_force(const course *c, int k, double window) {
    const double wide = fmin(window, c->end - c->begin);
    double most = -INFINITY;
    for (size_t r = 0; r < c->rows; r++)
        for (int end = 0; end < 2; end++) {
            const double from = c->path[r] - end * wide;
            if (from < c->begin || from + wide > c->end) continue;
            const double mean = mean_force(c, k, from, from + wide);
            if (k == 2 ? fabs(mean) > fabs(most) || isinf(most) : mean > most) most = mean;
        }
    return isinf(most) ? NAN : most;
}

/* Returns the work of the rolling force, J. */
static double work_of(const course *c) {
    double sum = 0.0, past = c->begin;
    for (size_t r = 0; r <= c->rows; r++) {
        const double now = r < c->rows ? fmin(c->path[r], c->end) : c->end;
        if (!(now > past)) continue;
        sum += mean_force(c, 1, past, now) * (now - past);
        past = now;
    }
    return sum;
}

static bool find_course(const gn_curves *curves, course *c, gn_readings *readings) {
    static const char *const names[3] = {"normal_impulse", "rolling_impulse", "side_impulse"};
    const gn_cut *cut = &curves->tested->cut;
    *c = (course){.rows = curves->history->row_count,
                  .path = gn_history_column(curves->history, "cut_path"),
                  .time = curves->time,
                  .begin = cut->begin};
    bool known = c->path && c->time;
    for (int k = 0; k < 3; k++) {
        c->impulse[k] = gn_history_column(curves->history, names[k]);
        known = known && c->impulse[k];
    }
    if (!known || !c->rows) return false;
    const double reached = c->path[c->rows - 1];
    c->end = fmin(cut->end, reached);
    if (c->end - c->begin > 0.1 * (cut->end - cut->begin)) return true;
    for (int k = GN_READING_normal_force; k <= GN_READING_specific_energy_removed; k++)
        gn_reading_absent(readings, (gn_reading)k,
                          "the tool came %.4g m far, means are taken from %.4g m to %.4g m",
                          reached, cut->begin, cut->end);
    return false;
}

/* --- readings --- */

static void read_forces(const gn_curves *curves, const course *c, gn_readings *r) {
    const gn_cut *cut = &curves->tested->cut;
    double *const mean[3] = {&r->normal_force, &r->rolling_force, &r->side_force},
                  *const scatter[3] = {&r->normal_force_deviation, &r->rolling_force_deviation,
                                       &r->side_force_deviation},
                  *const peak[3] = {&r->peak_normal_force, &r->peak_rolling_force,
                                    &r->peak_side_force};
    for (int k = 0; k < (curves->tested->dimension == 2 ? 2 : 3); k++) {
        *mean[k] = mean_force(c, k, c->begin, c->end);
        *scatter[k] = deviation(c, k, cut->blocks, *mean[k]);
        *peak[k] = peak_force(c, k, cut->window);
    }
    const gn_reading side[] = {GN_READING_side_force, GN_READING_side_force_deviation,
                               GN_READING_peak_side_force};
    for (int k = 0; curves->tested->dimension == 2 && k < 3; k++)
        gn_reading_absent(r, side[k], "a 2D scene has no side force");
    r->cutting_coefficient = r->rolling_force / r->normal_force;
    r->contact_area = cut->contact_area;
}

static void read_energies(const gn_curves *curves, const course *c, gn_readings *r) {
    const gn_cut *cut = &curves->tested->cut;
    const double width = cut->spacing > 0.0 ? cut->spacing : cut->width;
    r->specific_energy = r->rolling_force / (cut->depth * width);
    if (!(width > 0.0))
        gn_reading_absent(r, GN_READING_specific_energy, "the cut has no width: give test.spacing");
    if (!gn_history_column(curves->history, "removed_volume")) {
        gn_reading_absent(r, GN_READING_removed_volume, "the scene has no bonds");
        gn_reading_absent(r, GN_READING_removed_beside, "the scene has no bonds");
        gn_reading_absent(r, GN_READING_specific_energy_removed, "the scene has no bonds");
        return;
    }
    r->removed_volume = cut->removed;
    r->removed_beside = cut->removed_beside;
    if (curves->tested->dimension == 2)
        gn_reading_absent(r, GN_READING_removed_beside, "a 2D scene has no side");
    r->specific_energy_removed = work_of(c) / r->removed_volume;
    if (!(r->removed_volume > 0.0))
        gn_reading_absent(r, GN_READING_specific_energy_removed,
                          "nothing came off along the path of the means");
}

static void need_strengths(const gn_cut *cut, bool compressive, gn_reading which, gn_readings *r) {
    if (!(cut->tensile > 0.0)) gn_reading_absent(r, which, "it needs test.tensile_strength");
    if (compressive && !(cut->compressive > 0.0))
        gn_reading_absent(r, which, "it needs test.compressive_strength");
}

static void read_disc(const gn_cut *cut, gn_readings *r) {
    const gn_csm csm = gn_csm_of(cut);
    const gn_reading forces[] = {GN_READING_predicted_normal_force,
                                 GN_READING_predicted_rolling_force};
    r->predicted_coefficient = csm.coefficient;
    r->predicted_normal_force = csm.normal;
    r->predicted_rolling_force = csm.rolling;
    for (int k = 0; k < 2; k++) {
        need_strengths(cut, true, forces[k], r);
        if (!(cut->spacing > 0.0)) gn_reading_absent(r, forces[k], "the model needs test.spacing");
    }
}

static void read_predictions(const gn_cut *cut, gn_readings *r) {
    static const char other[] = "no closed form is known for such a tool";
    const bool disc = cut->tool == GN_CUT_DISC, pick = cut->tool == GN_CUT_PICK;
    for (int k = GN_READING_predicted_coefficient; k <= GN_READING_predicted_rolling_force; k++)
        if (!disc) gn_reading_absent(r, (gn_reading)k, "%s", other);
    if (disc) read_disc(cut, r);
    r->predicted_peak_evans = evans_force(cut);
    r->predicted_peak_goktan = goktan_force(cut);
    if (disc || cut->tool == GN_CUT_OTHER)
        gn_reading_absent(r, GN_READING_predicted_peak_evans, "%s", other);
    if (!pick) gn_reading_absent(r, GN_READING_predicted_peak_goktan, "%s", other);
    need_strengths(cut, pick, GN_READING_predicted_peak_evans, r);
    need_strengths(cut, false, GN_READING_predicted_peak_goktan, r);
}

static void read_cutting(const gn_curves *curves, gn_readings *readings) {
    course c;
    if (find_course(curves, &c, readings)) {
        read_forces(curves, &c, readings);
        read_energies(curves, &c, readings);
    }
    readings->damage_depth = curves->tested->cut.damage_depth;
    if (isnan(readings->damage_depth))
        gn_reading_absent(readings, GN_READING_damage_depth, "no bond is broken");
    read_predictions(&curves->tested->cut, readings);
}

/* Returns the shape of the cut. Energies refer to its section as well; a pick, or a disc without a
 * spacing, has none, and the square of the depth replaces it. */
static gn_tested_shape cut_shape(const gn_test_sizes *t, const gn_tested_specimen *x) {
    const double width = t->spacing > 0.0      ? t->spacing
                         : x->dimension == 2   ? 1.0
                         : x->tool_width > 0.0 ? x->tool_width
                                               : t->depth;
    gn_tested_shape s = {0};
    s.length = t->length > 0.0 ? t->run_in + t->length : x->side[x->axis];
    s.area = s.section = width * t->depth;
    return s;
}

const gn_test_descriptor gn_test_cutting = {
    .name = "cutting",
    .tool = true,
    .sign = 1,
    .takes = GN_TAKES(length) | GN_TAKES(normal) | GN_TAKES(tool) | GN_TAKES(depth) |
             GN_TAKES(spacing) | GN_TAKES(run_in) | GN_TAKES(peak_window) | GN_TAKES(blocks) |
             GN_TAKES(compressive_strength) | GN_TAKES(tensile_strength) |
             GN_TAKES(pressure_exponent),
    .needs = GN_TAKES(normal) | GN_TAKES(tool) | GN_TAKES(depth),
    .strain = 1.0,
    .shape = cut_shape,
    .area_source = "depth times spacing (without one times the width of a chisel, or the depth)",
    .readings = GN_READS(events) | GN_READS(b_value) | GN_READS(fragments) |
                GN_READS(largest_fragment) | GN_READS(normal_force) | GN_READS(rolling_force) |
                GN_READS(side_force) | GN_READS(normal_force_deviation) |
                GN_READS(rolling_force_deviation) | GN_READS(side_force_deviation) |
                GN_READS(cutting_coefficient) | GN_READS(peak_normal_force) |
                GN_READS(peak_rolling_force) | GN_READS(peak_side_force) |
                GN_READS(specific_energy) | GN_READS(removed_volume) | GN_READS(removed_beside) |
                GN_READS(specific_energy_removed) | GN_READS(contact_area) |
                GN_READS(damage_depth) | GN_READS(predicted_coefficient) |
                GN_READS(predicted_normal_force) | GN_READS(predicted_rolling_force) |
                GN_READS(predicted_peak_evans) | GN_READS(predicted_peak_goktan),
    .read = read_cutting,
    .strain_name = "path over its length",
    .stress_name = "rolling force over the section of the cut",
    .figures = {{GN_READING_normal_force, "normal force"},
                {GN_READING_rolling_force, "rolling force"},
                {GN_READING_cutting_coefficient, "cutting coefficient"},
                {GN_READING_specific_energy, "specific energy"}},
};
