#include "cli/budget_show.h"

#include "cli/shown.h"
#include "run/budget.h"

#include <math.h>
#include <string.h>

static void print_one(const gn_readings *readings, const char *name, const char *unit, double value,
                      const gn_error_causes *causes) {
    char text[512];
    const gn_shown shown = gn_shown_unit(readings, name, unit, value);
    printf("    %-22s %.4g%s%s +- %.6g %s\n", name, value / shown.factor, *shown.unit ? " " : "",
           shown.unit, gn_two_digits(fabs(value) / shown.factor * gn_causes_total(causes)),
           gn_budget_text(causes, value / shown.factor, text, sizeof text));
}

/* The causes that no sum includes are the same for most readings, and are printed once. */
static void print_notes(const gn_budget *budget) {
    const gn_error_causes *causes = &budget->of[GN_READING_peak_stress];
    if (!causes->count) causes = &budget->of[GN_READING_young_modulus_average];
    for (size_t k = 0; k < causes->note_count; k++) printf("    note: %s\n", causes->note[k]);
}

gneiss_status gn_print_budget(const gn_run *run, gneiss_error *error) {
    const gn_readings *readings;
    const gn_budget *budget;
    if (!gn_scene_tested(&run->world.ctx.scene)) return GNEISS_OK;
    GN_TRY(gn_run_readings(run, &readings, error));
    GN_TRY(gn_run_budget(run, &budget, error));
    if (budget->absent[0]) {
        printf("  error budget           %10s   %s\n", "-", budget->absent);
        return GNEISS_OK;
    }
    printf("  error budget, 95 of 100\n");
#define X(name, unit, text)                                                                        \
    if (budget->of[GN_READING_##name].count)                                                       \
        print_one(readings, #name, unit, readings->name, &budget->of[GN_READING_##name]);
    GN_READINGS(X)
#undef X
    print_notes(budget);
    return GNEISS_OK;
}
