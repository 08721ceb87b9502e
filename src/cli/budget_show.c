#include "cli/budget_show.h"

#include "cli/shown.h"
#include "run/budget.h"

#include <math.h>
#include <string.h>

static void print_one(const gn_readings *r, const char *name, const char *unit, double value,
                      const gn_error_causes *c) {
    char text[512];
    const gn_shown shown = gn_shown_unit(r, name, unit, value);
    printf("    %-22s %.4g%s%s +- %.6g %s\n", name, value / shown.factor, *shown.unit ? " " : "",
           shown.unit, gn_two_digits(fabs(value) / shown.factor * gn_causes_total(c)),
           gn_budget_text(c, value / shown.factor, text, sizeof text));
}

/* What is in no sum is the same for most readings, and told once. */
static void print_notes(const gn_budget *b) {
    const gn_error_causes *c = &b->of[GN_READING_peak_stress];
    if (!c->count) c = &b->of[GN_READING_young_modulus_average];
    for (size_t k = 0; k < c->note_count; k++) printf("    note: %s\n", c->note[k]);
}

gneiss_status gn_print_budget(const gn_run *run, gneiss_error *error) {
    const gn_readings *r;
    const gn_budget *b;
    if (!gn_scene_tested(&run->world.ctx.scene)) return GNEISS_OK;
    GN_TRY(gn_run_readings(run, &r, error));
    GN_TRY(gn_run_budget(run, &b, error));
    if (b->absent[0]) {
        printf("  error budget           %10s   %s\n", "-", b->absent);
        return GNEISS_OK;
    }
    printf("  error budget, 95 of 100\n");
#define X(name, unit, text)                                                                        \
    if (b->of[GN_READING_##name].count)                                                            \
        print_one(r, #name, unit, r->name, &b->of[GN_READING_##name]);
    GN_READINGS(X)
#undef X
    print_notes(b);
    return GNEISS_OK;
}
