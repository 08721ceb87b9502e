/* Warnings about a membrane. */
#include "run/warnings.h"

#include <math.h>

static void warn_of_ramp(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    if (!run->finished) return;
    const double past = w->ctx.time - w->dem.membrane->since;
    if (w->ctx.scene.membrane.ramp - past <= w->ctx.dt) return;
    gn_warning *to = gn_warnings_add(list, "membrane_ramp");
    snprintf(to->text, sizeof to->text,
             "the pressure had reached %.4g Pa, %.3g of its target, when the run ended after %.4g "
             "s: membrane.ramp is %.4g s",
             w->dem.membrane->pressure, past / w->ctx.scene.membrane.ramp, past,
             w->ctx.scene.membrane.ramp);
}

/* Warns of patches with a bounded stretch. */
static void warn_of_stretch(const gn_run *run, gn_warnings *list) {
    const double unlike = run->world.dem.membrane->unlike;
    if (!(unlike > 0.0)) return;
    gn_warning *to = gn_warnings_add(list, "membrane_stretch");
    snprintf(to->text, sizeof to->text,
             "on up to %.3g of the area of the membrane the particles have moved such that it "
             "would be stretched three times more or less than the whole; it was moved with the "
             "whole there, and the pressure is not at its target",
             unlike);
}

static double in_row(const gn_run *run, const char *column, size_t row) {
    const double *values = gn_history_column(&run->history, column);
    return values ? values[row] : 0.0;
}

/* Returns the last row with the full pressure and intact bonds, none of them broken so far;
 * SIZE_MAX: there is none. */
static size_t row_of_pressure(const gn_run *run) {
    const double *pressure = gn_history_column(&run->history, "membrane_pressure");
    double most = 0.0;
    size_t found = SIZE_MAX;
    for (size_t r = 0; pressure && r < run->history.row_count; r++) most = fmax(most, pressure[r]);
    for (size_t r = 0; most > 0.0 && r < run->history.row_count; r++) {
        const bool whole = in_row(run, "bonds_intact", r) > 0.0 &&
                           in_row(run, "broken_tension", r) + in_row(run, "broken_shear", r) == 0.0;
        if (pressure[r] >= 0.99 * most && whole) found = r;
    }
    return found;
}

static bool pushed_otherwise(const gn_scene *s) {
    for (size_t k = 0; k < s->set_count; k++)
        if (s->sets[k].has_force) return true;
    return false;
}

/* An intact specimen stores the work of the membrane, or half of it if the pressure is applied at
 * once; the work on grains that roll under the membrane is lost to background damping. */
static void warn_of_work(const gn_run *run, gn_warnings *list) {
    static const char *const takes_up[] = {
        "energy_elastic_normal", "energy_elastic_shear", "energy_elastic_bending",
        "energy_elastic_wall",   "energy_kinetic",       "energy_rotational",
        "energy_friction",       "energy_rolling",       "energy_damage",
        "energy_plasticity",     "energy_bond_breaking"};
    const double most = 3.0;
    const size_t row = row_of_pressure(run);
    double held = 0.0;
    if (row == SIZE_MAX || pushed_otherwise(&run->world.ctx.scene)) return;
    for (size_t k = 0; k < sizeof takes_up / sizeof *takes_up; k++)
        held += in_row(run, takes_up[k], row);
    const double work = in_row(run, "energy_work_applied", row);
    if (!(work > most * held)) return;
    gn_warning *to = gn_warnings_add(list, "membrane_work");
    snprintf(to->text, sizeof to->text,
             "the membrane has done %.3g J of work on an intact specimen at its pressure, of which "
             "%.3g J are stored or were dissipated in contacts: the rest was done on grains that "
             "roll or fly below the membrane, and the pressure on them is wrong",
             work, held);
}

void gn_warn_of_membrane(const gn_run *run, gn_warnings *list) {
    if (!(run->world.ctx.effects & GN_FX_MEMBRANE)) return;
    warn_of_ramp(run, list);
    warn_of_stretch(run, list);
    warn_of_work(run, list);
}
