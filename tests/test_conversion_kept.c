/* What conversions keep, and the step that they leave. */
#include "conversion_helpers.h"

/* --- the step --- */

/* Elements of the size of a particle, with which slaved spins weigh most. */
static const block spinning = {.cells = {10, 6, 0}, .finer = 2, .couple = ", spins: slaved"};

static gn_world *spun(const char *time) {
    const double flat = 0.0;
    block s = spinning;
    s.time = time;
    gn_world *w = block_of(&s);
    convert(w, 8e-3, 10e-3, 0.0, 1.0);
    set_elements(w, stir, &flat);
    set_field(&w->dem.particles, stir, &flat);
    run_steps(w, 1);
    return w;
}

/* The energy after so many steps over that at the start; INFINITY when the run has gone bad. */
static double energy_after(gn_world *w, int steps) {
    gneiss_error error = {0};
    gn_energy e = measured_step(w);
    const double start = gn_energy_stored(&e);
    double grown = 0.0;
    for (int k = 0; k < steps && isfinite(grown); k++)
        if (gn_world_step(w, k == steps - 1, &error) != GNEISS_OK) grown = INFINITY;
    if (isfinite(grown)) grown = gn_energy_stored(&w->reading) / start;
    world_end(w);
    return grown;
}

/* They bring springs without inertia: with what particles and elements hold each by itself the
 * model is unstable. */
static void slaved_spins_of_new_zones_are_in_the_step(void **state) {
    (void)state;
    char time[96];
    gn_world *w = spun(NULL);
    const double stable = w->stable, sides = fmin(w->dem.stable, gn_elements_stable(w));
    assert_true(stable < 0.5 * sides);
    assert_near(w->dt, w->scene.safety * stable, 1e-12 * stable);
    assert_near(energy_after(w, 2000), 1.0, 1e-4);
    snprintf(time, sizeof time, ", step: %.17g, on_unstable: warn", 0.99 * stable);
    assert_near(energy_after(spun(time), 2000), 1.0, 1e-4);
    snprintf(time, sizeof time, ", step: %.17g, on_unstable: warn", 0.9 * sides);
    assert_true(energy_after(spun(time), 2000) > 10.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slaved_spins_of_new_zones_are_in_the_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
