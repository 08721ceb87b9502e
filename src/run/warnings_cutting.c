/* Warnings about a cutting test. */
#include "laboratory/cutting.h"
#include "run/run.h"
#include "run/warnings.h"

#include <math.h>
#include <string.h>

/* Returns the value of a column of the history where the tool has travelled `path`, linear between
 * rows. */
static double at_path(const gn_run *run, const double *path, const double *column, double place) {
    const size_t rows = run->history.row_count;
    size_t r = 1;
    while (r + 1 < rows && path[r] < place) r++;
    const double length = path[r] - path[r - 1],
                 share = length > 0.0 ? (place - path[r - 1]) / length : 0.0;
    return column[r - 1] + fmin(1.0, fmax(0.0, share)) * (column[r] - column[r - 1]);
}

/* Warns of means that cover only a part of the path. */
static void warn_of_path(const gn_run *run, const double *path, gn_warnings *list) {
    const gn_cutting *c = &run->world.cutting;
    const double came = path[run->history.row_count - 1];
    if (!run->finished || came > (1.0 - 1e-3) * c->end) return;
    gn_warn(list, "cutting_path",
            "the run ended when the tool had come %.4g m: means are over %.4g m of the %.4g m from "
            "%.4g m to %.4g m of its path, %.0f %% (below a tenth they are absent); a later "
            "time.end completes it",
            came, fmax(0.0, came - c->begin), c->end - c->begin, c->begin, c->end,
            100.0 * fmax(0.0, came - c->begin) / (c->end - c->begin));
}

/* Warns of a depth of cut other than the nominal one, from the motion of the tool. */
static void warn_of_depth(const gn_run *run, const double *path, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_cutting *c = &w->cutting;
    char name[GN_COLUMN_NAME_SIZE], text[GNEISS_MESSAGE_SIZE];
    snprintf(name, sizeof name, "body_%s_displacement_%c", w->ctx.scene.test.tool,
             "xyz"[w->ctx.scene.test.normal]);
    const double *moved = gn_history_column(&run->history, name),
                 start = gn_cutting_depth_at_start(&w->ctx, &w->boundary, c);
    if (!moved) return;
    const double depth[2] = {start - c->outward * at_path(run, path, moved, c->begin),
                             start - c->outward * at_path(run, path, moved, c->end)};
    if (gn_cutting_depth_differs(&w->ctx, depth, text, sizeof text))
        gn_warn(list, "cutting_depth", "%s", text);
}

/* Returns the extent of the block along an axis at the start, elements included, m. */
static double block_side(const gn_world *w, int axis) {
    double low = w->ctx.lower[axis], high = w->ctx.upper[axis];
    if (w->ctx.scene.has_couple) {
        low = fmin(low, w->cutting.elements[0][axis]);
        high = fmax(high, w->cutting.elements[1][axis]);
    }
    return high - low;
}

/* Warns of a block that the cut broke as a whole: damage through more than three quarters of its
 * height, or as much removed rock as a layer of its width that is as thick as the cut is deep. */
static void warn_of_block(const gn_run *run, const double *path, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_cutting *c = &w->cutting;
    const gn_cut cut = gn_cutting_describe(&w->ctx, &w->dem, c);
    const int axis = (int)w->ctx.scene.test.axis, normal = (int)w->ctx.scene.test.normal;
    const double height = block_side(w, normal), width = block_side(w, 3 - axis - normal),
                 length = fmin(c->end, path[run->history.row_count - 1]) - c->begin,
                 cut_width =
                     length > 0.1 * (c->end - c->begin) ? cut.removed / (length * cut.depth) : 0.0;
    if (cut.damage_depth > 0.75 * height)
        gn_warn(list, "cutting_block",
                "bonds are broken down to %.4g m below the surface of the rock, which is %.4g m "
                "high: the block broke as a whole, and forces depend on its size",
                cut.damage_depth, height);
    else if (w->ctx.scene.dimension == 3 && cut_width >= width)
        gn_warn(list, "cutting_block",
                "the section of the removed rock is %.4g m2, depth times %.4g m, and the rock is "
                "%.4g m wide: the block broke as a whole, and forces depend on its size",
                cut_width * cut.depth, cut_width, width);
}

void gn_warn_of_cut(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const double *path = gn_history_column(&run->history, "cut_path");
    char text[GNEISS_MESSAGE_SIZE];
    if (!gn_scene_test(&w->ctx.scene)->tool) return;
    if (path && run->history.row_count > 1 && w->cutting.direction != 0.0) {
        warn_of_path(run, path, list);
        warn_of_depth(run, path, list);
        warn_of_block(run, path, list);
    }
    for (gn_cutting_doubt d = GN_CUT_LOCKED; d < GN_CUT_DEPTH; d++) {
        if (!gn_cutting_doubts(&w->ctx, &w->dem, &w->boundary, &w->cutting, d, text, sizeof text))
            continue;
        if (d == GN_CUT_PARTICLES)
            gn_warn(list, "cutting_particles", "%s", text);
        else
            gn_warn(list, "cutting_tool", "%s", text);
    }
}

void gn_no_force_text(const gn_run *run, char *text, size_t size) {
    const gn_cutting *c = &run->world.cutting;
    const char *tool = run->world.ctx.scene.test.tool;
    bool met = false;
    for (int a = 0; a < GN_CUT_AXES; a++) met = met || c->seen[a] != 0.0;
    if (!met)
        snprintf(text, size, "the tool '%s' never touched the rock", tool);
    else if (c->seen[GN_CUT_ROLLING] > 0.0)
        snprintf(text, size,
                 "none of the %zu rows of the history has a force against the motion of '%s', "
                 "which was touched between them: more output.history_rows show it",
                 run->history.row_count, tool);
    else
        snprintf(text, size, "the force on '%s' never was against its motion", tool);
}
