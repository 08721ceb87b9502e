/* The forces along the rim of a disc cutter in results.h5. */
#include "laboratory/cutting.h"
#include "run/output_table.h"
#include "run/part_files.h"

#include <math.h>

/* The view of the table. */
typedef struct rim {
    const gn_cutting *cutting;
    double arc; /* rad */
} rim;

static double middle_of(size_t bin) {
    return ((double)bin + 0.5) / GN_RIM_BINS_OF_ARC - 0.5;
}

#define READ(name, expression)                                                                     \
    static void read_##name(const void *view, size_t k, double *value) {                           \
        const rim *r = view;                                                                       \
        *value = (expression);                                                                     \
    }
READ(share, r ? middle_of(k) : 0.0)
READ(angle, middle_of(k) * r->arc)
READ(normal, r->cutting->rim[k][GN_CUT_NORMAL] / r->cutting->samples)
READ(rolling, r->cutting->rim[k][GN_CUT_ROLLING] / r->cutting->samples)
READ(side, r->cutting->rim[k][GN_CUT_SIDE] / r->cutting->samples)

#define FIELD(name, unit, text)                                                                    \
    { #name, unit, text, GN_IN_RESULTS, GN_F64, false, 1, read_##name, 0 }
static const gn_output_field of_rim[] = {
    FIELD(share, "1",
          "middle of the bin over the arc in the rock: 0 below the axis, 1 at the surface ahead"),
    FIELD(angle, "rad", "the same as an angle, positive towards the motion"),
    FIELD(normal, "N", "mean force of the contacts in the bin on the tool, out of the rock"),
    FIELD(rolling, "N", "the same against the motion"),
    FIELD(side, "N", "the same sideways, along the vector product of normal and motion"),
};
const gn_output_table gn_rim_outputs = {"rim", of_rim, sizeof of_rim / sizeof *of_rim};

gneiss_status gn_rim_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    if (!gn_scene_test(&world->ctx.scene)->tool || !(world->cutting.samples > 0.0))
        return GNEISS_OK;
    const gn_cut cut = gn_cutting_describe(&world->ctx, &world->dem, &world->cutting);
    if (cut.tool != GN_CUT_DISC) return GNEISS_OK;
    const rim view = {&world->cutting, gn_csm_of(&cut).arc};
    const gn_output_source source = {&gn_rim_outputs, &view, 0, GN_RIM_BINS, NULL, NULL, 0};
    return gn_output_put(&source, file, error);
}
