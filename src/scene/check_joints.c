/* Cross-key checks of `joints`. */
#include "scene/check.h"

#include <math.h>
#include <string.h>

/* Refuses none and more than one of the keys that give the place. */
static gneiss_status check_place(const check *section, const gn_joint_def *joint) {
    const struct {
        bool given;
        const char *key;
    } places[] = {{joint->has_point, "point"},
                  {joint->trace_count > 0, "trace"},
                  {*joint->surface, "surface"},
                  {*joint->discs, "discs"},
                  {joint->network.given, "network"}};
    const char *found = NULL;
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        if (!places[k].given) continue;
        if (found)
            return gn_check_fail(section, places[k].key,
                                 "expected one of point, trace, surface, discs and network, found "
                                 "it beside %s",
                                 found);
        found = places[k].key;
    }
    if (found) return GNEISS_OK;
    return gn_check_fail(section, "",
                         "expected one of point, trace, surface, discs and network, found none");
}

/* Writes the normal that dip and dip direction give, or normalises the given one. */
static gneiss_status find_normal(const check *section, const gn_scene *scene, gn_joint_def *joint) {
    const bool wanted = joint->has_point || joint->network.given, dips = joint->dip >= 0.0;
    if (!wanted && (dips || joint->has_normal))
        return gn_check_fail(section, dips ? "dip" : "normal",
                             "expected point or network beside it, found neither");
    if (!wanted) return GNEISS_OK;
    if (dips == joint->has_normal)
        return gn_check_fail(section, dips ? "dip" : "", "expected normal or dip, found %s",
                             dips ? "both" : "neither");
    const double steep = sin(joint->dip), along = joint->dip_direction;
    if (dips && scene->dimension == 2)
        memcpy(joint->normal, (double[3]){steep, cos(joint->dip), 0.0}, sizeof joint->normal);
    else if (dips)
        memcpy(joint->normal, (double[3]){steep * sin(along), steep * cos(along), cos(joint->dip)},
               sizeof joint->normal);
    if (gn_check_direction(joint->normal)) return GNEISS_OK;
    return gn_check_fail(section, "normal", "expected a direction, found [0, 0, 0]");
}

static gneiss_status check_edge(const check *section, const gn_joint_def *joint) {
    const gn_joint_network *network = &joint->network;
    if (joint->radius > 0.0 && !joint->has_point && !network->given)
        return gn_check_fail(section, "radius", "expected point or network beside it");
    if (joint->corner_count && (!joint->has_point || joint->radius > 0.0))
        return gn_check_fail(section, "polygon", "expected point beside it, and no radius");
    if (!network->given) return GNEISS_OK;
    if (!(joint->radius > 0.0))
        return gn_check_fail(section, "network", "expected radius beside it, found none");
    if (network->radius_max > 0.0 && network->radius_max < joint->radius)
        return gn_check_fail(section, "network.radius_max",
                             "expected at least radius, %g m, found "
                             "%g m",
                             joint->radius, network->radius_max);
    return GNEISS_OK;
}

/* Returns the sign of the turn from a to b to c: 1 to the left, -1 to the right, 0 straight on. */
static int turn_of(const double *a, const double *b, const double *c) {
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    return (area > 0.0) - (area < 0.0);
}

/* Tells whether the sides a b and c d meet elsewhere than at corners that they share. */
static bool sides_cross(const double *a, const double *b, const double *c, const double *d) {
    const int turn[4] = {turn_of(a, b, c), turn_of(a, b, d), turn_of(c, d, a), turn_of(c, d, b)};
    const int zeros = !turn[0] + !turn[1] + !turn[2] + !turn[3];
    return turn[0] * turn[1] <= 0 && turn[2] * turn[3] <= 0 && zeros < 2;
}

/* Refuses a polygon that crosses itself, whose area has no sign. */
static gneiss_status check_sides(const check *section, const gn_joint_def *joint) {
    const size_t count = joint->corner_count;
    const double *x = joint->corners;
    for (size_t k = 0; k < count; k++)
        for (size_t l = k + 1; l < count; l++)
            if (sides_cross(x + 2 * k, x + 2 * ((k + 1) % count), x + 2 * l,
                            x + 2 * ((l + 1) % count)))
                return gn_check_fail(section, "polygon",
                                     "expected sides that do not cross, found that sides %zu and "
                                     "%zu do",
                                     k + 1, l + 1);
    return GNEISS_OK;
}

/* Refuses more dilation than friction: the work against the pressure, P tan(psi) ds, would exceed
 * the work of friction, mu P ds, so that a slip would create energy. */
static gneiss_status check_dilation(const check *section, const gn_joint_def *joint) {
    if (joint->dilation <= joint->friction) return GNEISS_OK;
    return gn_check_fail(section, "dilation",
                         "expected at most friction, %g, without which a slip would create "
                         "energy, found %g",
                         joint->friction, joint->dilation);
}

static gneiss_status check_joint(const check *section, const gn_scene *scene, size_t index) {
    gn_joint_def *joint = &scene->joints[index];
    for (size_t k = 0; k < index; k++)
        GN_TRY(
            gn_check_name(section, strcmp(scene->joints[k].name, joint->name) == 0, joint->name));
    GN_TRY(check_place(section, joint));
    GN_TRY(find_normal(section, scene, joint));
    GN_TRY(check_sides(section, joint));
    GN_TRY(check_dilation(section, joint));
    return check_edge(section, joint);
}

/* Refuses what has no kernel or no meaning beside joints. */
static gneiss_status check_beside(const check *section, const gn_scene *scene) {
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->has_periodic, "periodic"},
                  {scene->has_couple, "couple"},
                  {scene->source_count > 0, "sources"},
                  {scene->precision == GN_PRECISION_MIXED, "run.precision: mixed"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, "joints",
                                 "expected a scene without %s, found one with it", others[k].what);
    if (scene->specimen_given) return GNEISS_OK;
    return gn_check_fail(section, "joints", "expected a specimen beside it, found none");
}

gneiss_status gn_check_joints(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    const check scene = {.reader = reader, .map = root};
    if (!s->joint_count) return GNEISS_OK;
    GN_TRY(gn_check_list(&scene, "joints", s->joint_count, check_joint));
    if (!gn_check_is_valid(&scene, "joints") || !gn_check_is_valid(&scene, "specimen"))
        return GNEISS_OK;
    return gn_check_keep_problem(&scene, check_beside(&scene, s));
}
