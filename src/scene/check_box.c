/* Checks that the sides of a periodic box can move as the scene states. */
#include "scene/check.h"

#include <math.h>

/* Refuses what the convention of a moving box excludes: only particles follow its deformation. */
static gneiss_status check_company(const check *section, const gn_scene *scene) {
    bool prescribed = false;
    for (size_t k = 0; k < scene->set_count; k++)
        for (int a = 0; a < 3; a++)
            prescribed |=
                scene->sets[k].motion.velocity[a].count || scene->sets[k].motion.spin[a].count;
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->wall_count > 0, "walls"},
                  {scene->has_elements, "finite elements"},
                  {prescribed, "a set whose motion is prescribed"},
                  {scene->has_pulse, "initial.pulse"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, "periodic",
                                 "expected only particles in a box whose sides move, found %s",
                                 others[k].what);
    if (scene->precision != GN_PRECISION_MIXED) return GNEISS_OK;
    return gn_check_fail(section, "run.precision",
                         "expected double beside a periodic box whose sides move, found mixed");
}

/* Corners along an open axis are not checked. */
static gneiss_status check_corners(const check *section, const gn_scene *scene) {
    double high[3];
    for (int a = 0; a < 3; a++)
        high[a] = a == scene->periodic_open ? INFINITY : scene->periodic_max[a];
    if (scene->has_periodic)
        GN_TRY(gn_check_box(section, scene, "periodic.max", scene->periodic_min, high));
    if (!gn_scene_half_periodic(scene)) return GNEISS_OK;
    if (scene->periodic_open >= scene->dimension)
        return gn_check_fail(section, "periodic.open", "expected x or y in a 2D scene, found z");
    if (gn_scene_box_moves(scene))
        return gn_check_fail(section, "periodic.open",
                             "expected none in a box whose sides move, found %c",
                             "xyz"[scene->periodic_open]);
    return GNEISS_OK;
}

/* Refuses keys that only a servo reads, and sides without a motion. */
static gneiss_status check_idle(const check *section, const gn_box_side *side, const char *key) {
    const gn_node *given = gn_node_find(section->map, key);
    const char *idle = side->max_rate > 0 ? "max_rate" : side->relaxation > 0 ? "relaxation" : NULL;
    char more[48];
    if (given && given->kind == GN_NODE_MAP && !given->count)
        return gn_check_fail(section, key, "expected stress or rate, found neither");
    if (side->stress.count || !idle) return GNEISS_OK;
    snprintf(more, sizeof more, "%s.%s", key, idle);
    return gn_check_fail(section, more, "expected a stress beside it, found %s",
                         side->rate.count ? "a rate" : "none");
}

gneiss_status gn_check_box_sides(const check *section, const gn_scene *scene) {
    GN_TRY(check_corners(section, scene));
    for (int a = 0; a < 3; a++) {
        const gn_box_side *side = &scene->box[a];
        char key[32], more[48];
        snprintf(key, sizeof key, "periodic.%c", "xyz"[a]);
        snprintf(more, sizeof more, "%s.max_rate", key);
        GN_TRY(check_idle(section, side, key));
        if (!side->stress.count && !side->rate.count) continue;
        if (a >= scene->dimension)
            return gn_check_fail(section, key, "expected x or y in a 2D scene, found z");
        if (side->stress.count && side->rate.count)
            return gn_check_fail(section, key, "expected stress or rate, found both");
        if (side->stress.count && !(side->max_rate > 0))
            return gn_check_fail(section, more, "required beside stress, but not given");
    }
    return gn_scene_box_moves(scene) ? check_company(section, scene) : GNEISS_OK;
}
