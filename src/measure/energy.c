#include "measure/energy.h"

#include <math.h>
#include <string.h>

/* Sum over the terms of one kind, which the kind's name in the manifest selects. */
#define PICK_STORED_STORED(value) +(value)
#define PICK_STORED_INPUT(value)
#define PICK_STORED_LOST(value)
#define PICK_INPUT_STORED(value)
#define PICK_INPUT_INPUT(value) +(value)
#define PICK_INPUT_LOST(value)
#define PICK_LOST_STORED(value)
#define PICK_LOST_INPUT(value)
#define PICK_LOST_LOST(value) +(value)

double gn_energy_stored(const gn_energy *energy) {
#define X(name, kind, text) PICK_STORED_##kind(energy->name)
    return 0 GN_ENERGY_TERMS(X);
#undef X
}

double gn_energy_throughput(const gn_energy *energy) {
#define X(name, kind, text) PICK_INPUT_##kind(fabs(energy->name))
    double input = 0 GN_ENERGY_TERMS(X);
#undef X
#define X(name, kind, text) PICK_STORED_##kind(fabs(energy->name))
    double stored = 0 GN_ENERGY_TERMS(X);
#undef X
#define X(name, kind, text) PICK_LOST_##kind(fabs(energy->name))
    double lost = 0 GN_ENERGY_TERMS(X);
#undef X
    return fmax(fmax(input, energy->stored_at_start), fmax(stored, lost));
}

double gn_energy_scale(const gn_energy *energy) {
    return fmax(energy->passed, gn_energy_throughput(energy));
}

double gn_energy_residual(const gn_energy *energy) {
#define X(name, kind, text) PICK_INPUT_##kind(energy->name)
    double input = 0 GN_ENERGY_TERMS(X);
#undef X
#define X(name, kind, text) PICK_LOST_##kind(energy->name)
    double lost = 0 GN_ENERGY_TERMS(X);
#undef X
    double scale = gn_energy_scale(energy);
    double unaccounted = gn_energy_stored(energy) - energy->stored_at_start - input + lost;
    return scale > 0 ? unaccounted / scale : 0;
}

void gn_energy_figures(const gn_energy *energy, gn_energy_figure figures[GN_ENERGY_FIGURES]) {
    static const char STORED[] = "stored", INPUT[] = "input", LOST[] = "lost";
#define X(name, kind, text) {#name, "J", text, kind, energy->name},
    const gn_energy_figure all[] = {
        GN_ENERGY_TERMS(X){"stored_at_start", "J", "stored energy at the start", NULL,
                           energy->stored_at_start},
        {"residual", "1", GN_ENERGY_RESIDUAL_TEXT, NULL, gn_energy_residual(energy)}};
#undef X
    _Static_assert(sizeof all / sizeof *all == GN_ENERGY_FIGURES, "all of them");
    memcpy(figures, all, sizeof all);
}
