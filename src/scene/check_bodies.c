/* Cross-key checks of `bodies`. */
#include "scene/check.h"

#include <string.h>

/* Checks that exactly one of the shapes is given. */
static gneiss_status check_body_shape(const check *section, const gn_scene *scene,
                                      const gn_body_def *body) {
    static const char *const names[] = {"surface", "box", "cylinder", "polygon", "polyline"};
    const bool has[] = {*body->surface != '\0', body->has_box, body->has_cylinder,
                        body->polygon_count > 0, body->polyline_count > 0};
    char found[80] = "";
    for (int k = 0; k < 5; k++) {
        size_t used = strlen(found);
        if (has[k]) snprintf(found + used, sizeof found - used, "%s%s", used ? ", " : "", names[k]);
    }
    if (*found && !strchr(found, ',')) return GNEISS_OK;
    return gn_check_fail(section, "", "expected one of %s in it, found %s",
                         scene->dimension == 2 ? "polygon, polyline" : "surface, box, cylinder",
                         *found ? found : "none");
}

/* Checks that one of density and mass is given, and that the inertia is physically possible. */
static gneiss_status check_weight(const check *section, const gn_scene *scene,
                                  const gn_body_def *body) {
    if (!(body->density > 0) && !(body->mass > 0))
        return gn_check_fail(section, "density",
                             "required by a free body (or its mass), but not given");
    if (body->density > 0 && body->mass > 0)
        return gn_check_fail(section, "mass", "expected either mass or density, found both");
    if (!body->has_inertia || scene->dimension == 2) return GNEISS_OK;
    for (int a = 0; a < 3; a++) {
        double own = body->inertia[a],
               others = body->inertia[(a + 1) % 3] + body->inertia[(a + 2) % 3];
        if (own > (1 + 1e-9) * others)
            return gn_check_fail(section, "inertia",
                                 "expected no moment of inertia above the sum of the two others, "
                                 "found %g above %g: this is impossible",
                                 own, others);
    }
    return GNEISS_OK;
}

/* A body without a closed surface, or turning about another point than the centre of the enclosed
 * volume, must state all that follows from a closed surface. */
static gneiss_status check_centre(const check *section, const gn_body_def *body) {
    if (body->has_reference) {
        if (body->mass > 0 && body->has_inertia) return GNEISS_OK;
        return gn_check_fail(section, "reference",
                             "expected mass and inertia beside it, as it is the centre of mass of "
                             "a free body, found no %s",
                             body->has_inertia ? "mass" : "inertia");
    }
    static const char whole[] =
        "%s beside it, or mass, inertia and reference (the centre of mass), found none";
    if (body->polyline_count)
        return gn_check_fail(section, "free", whole,
                             "expected a polygon (a polyline has no inside)");
    if (body->has_cylinder && body->cylinder.open)
        return gn_check_fail(section, "free", whole, "expected a closed cylinder");
    return GNEISS_OK;
}

/* Checks that spin components prescribed by the motion have no initial value. */
static gneiss_status check_spins(const check *section, const gn_scene *scene,
                                 const gn_body_def *body) {
    static const char *const keys[] = {"motion.wx", "motion.wy", "motion.wz"};
    const gn_table *spin = body->motion.spin;
    if (gn_body_spin_kind(scene, body) != GN_SPINS_SOME) {
        if (body->has_initial_spin && gn_body_spin_kind(scene, body) == GN_SPINS_PRESCRIBED)
            return gn_check_fail(section, "initial_spin",
                                 "expected no prescribed spin beside it, found one in motion");
        return GNEISS_OK;
    }
    for (int a = 0; a < 3; a++) {
        if (spin[a].count && body->has_initial_spin && body->initial_spin[a] != 0)
            return gn_check_fail(section, "initial_spin",
                                 "expected 0 where motion prescribes the spin (%s), found %g rad/s",
                                 keys[a], body->initial_spin[a]);
    }
    return GNEISS_OK;
}

static gneiss_status check_free(const check *section, const gn_scene *scene,
                                const gn_body_def *body) {
    const bool has[] = {body->density > 0, body->mass > 0, body->has_inertia,
                        body->has_initial_velocity, body->has_initial_spin};
    static const char *const only[] = {"density", "mass", "inertia", "initial_velocity",
                                       "initial_spin"};
    if (body->free) {
        GN_TRY(check_weight(section, scene, body));
        GN_TRY(check_centre(section, body));
        return check_spins(section, scene, body);
    }
    for (int k = 0; k < 5; k++)
        if (has[k])
            return gn_check_fail(section, only[k], "expected free true beside it, found false");
    return GNEISS_OK;
}

static gneiss_status check_body(const check *section, const gn_scene *scene, size_t index) {
    gn_body_def *body = &scene->bodies[index];
    if (gn_scene_find_body(scene, body->name) != (int)index ||
        gn_scene_find_wall(scene, body->name) >= 0 || gn_scene_find_set(scene, body->name) >= 0)
        return gn_check_fail(section, "name", "expected a unique name, found '%s' a second time",
                             body->name);
    if (scene->has_periodic)
        return gn_check_fail(section, "name", "expected no periodic box beside a body, found one");
    GN_TRY(check_body_shape(section, scene, body));
    GN_TRY(gn_check_side(section, scene, "",
                         (gn_side_keys){body->stiffness, body->kratio, body->friction,
                                        body->rolling_friction, body->twisting_friction,
                                        body->material, true}));
    GN_TRY(check_free(section, scene, body));
    return gn_check_plane_motion(section, scene, &body->motion);
}

gneiss_status gn_check_bodies(const gn_reader *reader, const gn_node *root) {
    const gn_scene *scene = reader->scene;
    for (size_t k = 0; k < scene->body_count; k++) {
        check element = gn_check_element(reader, root, "bodies", k);
        if (!gn_check_element_is_valid(&element)) continue;
        GN_TRY(gn_check_keep_problem(&element, check_body(&element, scene, k)));
    }
    return GNEISS_OK;
}
