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

/* One of density and mass; inertia that a body can have. */
static gneiss_status check_weight(const check *c, const gn_scene *s, const gn_body_def *b) {
    if (!(b->density > 0) && !(b->mass > 0))
        return gn_check_fail(c, "density", "required by a free body (or its mass), but not given");
    if (b->density > 0 && b->mass > 0)
        return gn_check_fail(c, "mass", "expected either mass or density, found both");
    if (!b->has_inertia || s->dimension == 2) return GNEISS_OK;
    for (int a = 0; a < 3; a++) {
        double own = b->inertia[a], others = b->inertia[(a + 1) % 3] + b->inertia[(a + 2) % 3];
        if (own > (1 + 1e-9) * others)
            return gn_check_fail(c, "inertia",
                                 "expected no moment of inertia above the sum of the two others, "
                                 "found %g beside %g: no body has that",
                                 own, others);
    }
    return GNEISS_OK;
}

/* Without a closed surface, and about another point than the centre of what it encloses, only with
 * all that the surface would say. */
static gneiss_status check_centre(const check *c, const gn_body_def *b) {
    if (b->has_reference) {
        if (b->mass > 0 && b->has_inertia) return GNEISS_OK;
        return gn_check_fail(c, "reference",
                             "expected mass and inertia beside it, as it says where the centre of "
                             "mass of a free body is, found no %s",
                             b->has_inertia ? "mass" : "inertia");
    }
    static const char whole[] =
        "%s beside it, or mass, inertia and reference (the centre of mass), found none";
    if (b->polyline_count)
        return gn_check_fail(c, "free", whole, "expected a polygon (a polyline has no inside)");
    if (b->has_cylinder && b->cylinder.open)
        return gn_check_fail(c, "free", whole, "expected a closed cylinder");
    return GNEISS_OK;
}

/* What is led has no spin of its own. */
static gneiss_status check_spins(const check *c, const gn_scene *s, const gn_body_def *b) {
    static const char *const keys[] = {"motion.wx", "motion.wy", "motion.wz"};
    const gn_table *spin = b->motion.spin;
    if (gn_body_spins(s, b) != GN_SPINS_SOME) {
        if (b->has_initial_spin && gn_body_spins(s, b) == GN_SPINS_LED)
            return gn_check_fail(c, "initial_spin",
                                 "expected no prescribed spin beside it, found one in motion");
        return GNEISS_OK;
    }
    for (int a = 0; a < 3; a++) {
        if (spin[a].count && b->has_initial_spin && b->initial_spin[a] != 0)
            return gn_check_fail(c, "initial_spin",
                                 "expected 0 where motion gives the spin (%s), found %g rad/s",
                                 keys[a], b->initial_spin[a]);
    }
    return GNEISS_OK;
}

static gneiss_status check_free(const check *c, const gn_scene *s, const gn_body_def *b) {
    const bool has[] = {b->density > 0, b->mass > 0, b->has_inertia, b->has_initial_velocity,
                        b->has_initial_spin};
    static const char *const only[] = {"density", "mass", "inertia", "initial_velocity",
                                       "initial_spin"};
    if (b->free) {
        GN_TRY(check_weight(c, s, b));
        GN_TRY(check_centre(c, b));
        return check_spins(c, s, b);
    }
    for (int k = 0; k < 5; k++)
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
                                        b->twisting_friction, b->material, true}));
    GN_TRY(check_free(c, s, b));
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
