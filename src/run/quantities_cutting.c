/* Columns of the history about the tool of a cutting test. */
#include "laboratory/cutting.h"
#include "run/quantities.h"

static bool has_bonds(const gn_world *world, size_t k) {
    (void)k;
    return world->ctx.effects & GN_FX_BONDS;
}
static bool has_tool(const gn_test_descriptor *kind) {
    return kind->tool;
}
static const gn_condition cut = {"in %s tests", NULL, has_tool},
                          chipped = {"in %s tests with bonds", has_bonds, has_tool};

#define READ(name, expression)                                                                     \
    static void read_##name(const gn_world *world, size_t k, double *value) {                      \
        (void)k;                                                                                   \
        *value = (expression);                                                                     \
    }

static double force_along(const gn_world *world, int k) {
    double force[GN_CUT_AXES];
    gn_cutting_force(&world->ctx, &world->boundary, &world->cutting, force);
    return force[k];
}
READ(path, gn_cutting_path(&world->ctx, &world->boundary, &world->cutting))
READ(normal, force_along(world, GN_CUT_NORMAL))
READ(rolling, force_along(world, GN_CUT_ROLLING))
READ(side, force_along(world, GN_CUT_SIDE))
READ(normal_impulse, world->cutting.seen[GN_CUT_NORMAL])
READ(rolling_impulse, world->cutting.seen[GN_CUT_ROLLING])
READ(side_impulse, world->cutting.seen[GN_CUT_SIDE])
READ(removed, gn_cutting_removed(&world->ctx, &world->dem, &world->cutting))

#define SCALAR(when, instant, name, unit, read, text)                                              \
    { name, unit, text, GN_SCALAR, instant, &when, read, NULL }

const gn_quantity gn_cut_quantities[GN_CUT_QUANTITIES] = {
    SCALAR(cut, GN_BEFORE_STEP, "cut_path", "m", read_path,
           "path of the tool along the cut from its start"),
    SCALAR(cut, GN_AFTER_STEP, "normal_force", "N", read_normal,
           "force on the tool out of the rock"),
    SCALAR(cut, GN_AFTER_STEP, "rolling_force", "N", read_rolling,
           "force on the tool against its motion"),
    SCALAR(cut, GN_AFTER_STEP, "side_force", "N", read_side,
           "sideways force on the tool, along the vector product of normal and motion"),
    SCALAR(cut, GN_AFTER_STEP, "normal_impulse", "N s", read_normal_impulse,
           "integral of normal_force over time: its growth over a time gives the mean force"),
    SCALAR(cut, GN_AFTER_STEP, "rolling_impulse", "N s", read_rolling_impulse,
           "the same integral of rolling_force"),
    SCALAR(cut, GN_AFTER_STEP, "side_impulse", "N s", read_side_impulse,
           "the same integral of side_force"),
    SCALAR(chipped, GN_AFTER_STEP, "removed_volume", "m3", read_removed,
           "rock, pores included, that intact bonds no longer connect to the held part")};
