/* What the keys of `bodies` must hold together. */
#include "scene/check.h"

#include <string.h>

/* Exactly one of the shapes is given. */
static gneiss_status check_body_shape(const check *c, const gn_scene *s, const gn_body_def *b) {
    static const char *const names[] = {"surface", "box", "cylinder", "polygon", "polyline"};
    const bool has[] = {*b->surface != '\0', b->has_box, b->has_cylinder, b->polygon_count > 0,
                        b->polyline_count > 0};
    char found[80] = "";
    for (int k = 0; k < 5; k++) {
        size_t used = strlen(found);
        if (has[k]) snprintf(found + used, sizeof found - used, "%s%s", used ? ", " : "", names[k]);
    }
    if (*found && !strchr(found, ',')) return GNEISS_OK;
    return gn_check_fail(c, "", "expected one of %s in it, found %s",
                         s->dimension == 2 ? "polygon, polyline" : "surface, box, cylinder",
                         *found ? found : "none");
}

static gneiss_status check_free(const check *c, const gn_body_def *b) {
    const bool has[] = {b->density > 0, b->has_initial_velocity, b->has_initial_spin};
    static const char *const only[] = {"density", "initial_velocity", "initial_spin"};
    if (b->free) {
        if (!(b->density > 0))
            return gn_check_fail(c, "density", "required by a free body, but not given");
        if (b->polyline_count)
            return gn_check_fail(c, "free",
                                 "expected a polygon beside it (a polyline has no inside)");
        if (b->has_cylinder && b->cylinder.open)
            return gn_check_fail(c, "free",
                                 "expected a closed cylinder beside it, found an open one");
        if (b->has_reference)
            return gn_check_fail(
                c, "reference",
                "expected none: the reference point of a free body is its centre of mass");
        const gn_table *spin = b->motion.spin;
        if (b->has_initial_spin && (spin[0].count || spin[1].count || spin[2].count))
            return gn_check_fail(c, "initial_spin",
                                 "expected no prescribed spin beside it, found one in motion");
        return GNEISS_OK;
    }
    for (int k = 0; k < 3; k++)
        if (has[k]) return gn_check_fail(c, only[k], "expected free true beside it, found false");
    return GNEISS_OK;
}

static gneiss_status check_body(const check *c, const gn_scene *s, size_t index) {
    gn_body_def *b = &s->bodies[index];
    if (gn_scene_find_body(s, b->name) != (int)index || gn_scene_find_wall(s, b->name) >= 0 ||
        gn_scene_find_set(s, b->name) >= 0)
        return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                             b->name);
    if (s->has_periodic)
        return gn_check_fail(c, "name", "expected no periodic box beside a body, found one");
    GN_TRY(check_body_shape(c, s, b));
    GN_TRY(gn_check_side(c, s, "",
                         (gn_side_keys){b->stiffness, b->kratio, b->friction, b->rolling_friction,
                                        b->twisting_friction, b->material}));
    GN_TRY(check_free(c, b));
    return gn_check_plane_motion(c, s, &b->motion);
}

gneiss_status gn_check_bodies(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    for (size_t k = 0; k < s->body_count; k++) {
        check element = gn_check_element(reader, root, "bodies", k);
        if (!gn_check_element_sound(&element)) continue;
        GN_TRY(gn_check_keep(&element, check_body(&element, s, k)));
    }
    return GNEISS_OK;
}
