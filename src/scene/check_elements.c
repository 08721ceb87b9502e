/* What keys of finite elements must hold together. */
#include "scene/check.h"

#include <math.h>
#include <string.h>

/* ---- mesh ---- */

static gneiss_status check_block(const check *c, const gn_scene *s, const char *kind) {
    const gn_element_def *e = &s->elements;
    char key[64];
    for (int64_t k = 0; k < s->dimension; k++) {
        snprintf(key, sizeof key, "elements.%s.size", kind);
        if (!gn_range_holds(GN_LENGTHS, e->size[k]))
            return gn_check_fail(c, key, "expected lengths in %s m, found %g m along %c",
                                 GN_LENGTHS, e->size[k], "xyz"[k]);
    }
    snprintf(key, sizeof key, "elements.%s.distortion", kind);
    if (s->dimension == 3 && e->distortion >= 1.0 / 6.0)
        return gn_check_fail(c, key, "expected a value below 1/6 in 3D, found %g", e->distortion);
    return GNEISS_OK;
}

static gneiss_status check_notch(const check *c, const gn_beam_def *b) {
    if (!(b->notch_depth > 0)) {
        if (b->notch_width > 0)
            return gn_check_fail(c, "elements.beam.notch_width",
                                 "expected notch_depth beside it, found none");
        return GNEISS_OK;
    }
    if (!(b->notch_width > 0))
        return gn_check_fail(c, "elements.beam.notch_width",
                             "required by notch_depth, but not given");
    if (b->notch_depth >= b->height)
        return gn_check_fail(c, "elements.beam.notch_depth",
                             "expected a notch below the height of %g m, found %g m", b->height,
                             b->notch_depth);
    double span = b->span > 0 ? b->span : b->length;
    if (b->notch_width < span) return GNEISS_OK;
    return gn_check_fail(c, "elements.beam.notch_width",
                         "expected a notch between the supports, %g m apart, found %g m", span,
                         b->notch_width);
}

static gneiss_status check_beam(const check *c, const gn_scene *s) {
    const gn_beam_def *b = &s->elements.beam;
    if (s->dimension == 3 && !(b->thickness > 0))
        return gn_check_fail(c, "elements.beam.thickness", "required in a 3D scene, but not given");
    if (s->dimension == 2 && b->thickness > 0)
        return gn_check_fail(c, "elements.beam.thickness",
                             "expected none in a 2D scene, which is 1 m thick, found %g m",
                             b->thickness);
    if (b->span > b->length)
        return gn_check_fail(c, "elements.beam.span",
                             "expected at most the length of %g m, found %g m", b->length, b->span);
    double cells = b->length / b->cell * (b->height / b->cell);
    if (s->dimension == 3) cells *= fmax(1.0, b->thickness / b->cell);
    if (cells > 1e8)
        return gn_check_fail(c, "elements.beam.cell",
                             "expected cells for at most 1e8 of them, found %g m", b->cell);
    return check_notch(c, b);
}

static gneiss_status check_mesh(const check *c, const gn_scene *s) {
    const gn_element_def *e = &s->elements;
    int sources = (e->mesh[0] != 0) + e->has_rectangle + e->has_box + e->has_beam;
    if (sources != 1)
        return gn_check_fail(c, "elements", "expected one of mesh, %s, beam, found %s",
                             s->dimension == 2 ? "rectangle" : "box", sources ? "several" : "none");
    if (e->scale != 1 && !e->mesh[0])
        return gn_check_fail(c, "elements.scale", "expected a mesh file beside it, found none");
    if (e->has_beam) return check_beam(c, s);
    return e->mesh[0] ? GNEISS_OK : check_block(c, s, e->has_box ? "box" : "rectangle");
}

/* ---- materials, motions, loads ---- */

static gneiss_status check_poisson(const check *c, const gn_element_material *m) {
    if (m->poisson < 0.5) return GNEISS_OK;
    return gn_check_fail(c, "poisson",
                         "expected a value below 0.5, because an explicit scheme has no stable "
                         "step for an incompressible material, found %g; try 0.49",
                         m->poisson);
}

static gneiss_status check_region(const check *c, const gn_scene *s, const gn_region *r) {
    if (!*r->group == !r->has_box)
        return gn_check_fail(c, "group", "expected group or box, found %s",
                             r->has_box ? "both" : "none");
    if (!r->has_box) return GNEISS_OK;
    for (int64_t k = 0; k < s->dimension; k++)
        if (!(r->box_min[k] <= r->box_max[k]))
            return gn_check_fail(c, "box.max",
                                 "expected a corner not below min, found %c: %g to %g", "xyz"[k],
                                 r -> box_min[k], r -> box_max[k]);
    return GNEISS_OK;
}

static gneiss_status check_motion(const check *c, const gn_scene *s, size_t index) {
    const gn_element_motion *m = &s->elements.motions[index];
    if (gn_scene_find_element_motion(s, m->name) != (int)index ||
        gn_scene_find_set(s, m->name) >= 0 || gn_scene_find_wall(s, m->name) >= 0 ||
        gn_scene_find_body(s, m->name) >= 0)
        return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                             m->name);
    GN_TRY(check_region(c, s, &m->region));
    return gn_check_plane_motion(c, s, &m->motion);
}

static gneiss_status check_load(const check *c, const gn_scene *s, const gn_element_load *l) {
    GN_TRY(check_region(c, s, &l->region));
    if (l->has_traction == l->has_force)
        return gn_check_fail(c, "force", "expected traction or force, found %s",
                             l->has_force ? "both" : "none");
    const gn_table *value = l->has_force ? l->force : l->traction;
    if (s->dimension == 2 && value[2].count)
        return gn_check_fail(c, l->has_force ? "force.fz" : "traction.tz",
                             "expected nothing out of the plane of a 2D scene");
    if (value[0].count || value[1].count || value[2].count) return GNEISS_OK;
    return gn_check_fail(c, l->has_force ? "force" : "traction",
                         "expected at least one component, found none");
}

/* What is not in a list. */
static gneiss_status check_whole(const check *c, const gn_scene *s) {
    const gn_element_def *e = &s->elements;
    GN_TRY(check_mesh(c, s));
    if (e->has_contact)
        GN_TRY(gn_check_side(c, s, "elements.contact.",
                             (gn_side_keys){e->contact.stiffness, e->contact.kratio,
                                            e->contact.friction, 0.0, 0.0, e->contact.material,
                                            false}));
    if (e->has_contact && s->has_periodic)
        return gn_check_fail(c, "elements.contact",
                             "expected no periodic box beside it, found one");
    return GNEISS_OK;
}

gneiss_status gn_check_elements(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    const gn_element_def *e = &s->elements;
    check c = {.reader = reader, .map = root};
    if (gn_check_sound(&c, "elements")) GN_TRY(gn_check_keep(&c, check_whole(&c, s)));
    for (size_t k = 0; k < e->material_count; k++) {
        check element = gn_check_element(reader, root, "elements.materials", k);
        if (gn_check_element_sound(&element))
            GN_TRY(gn_check_keep(&c, check_poisson(&element, &e->materials[k])));
    }
    for (size_t k = 0; k < e->motion_count; k++) {
        check element = gn_check_element(reader, root, "elements.motions", k);
        if (gn_check_element_sound(&element))
            GN_TRY(gn_check_keep(&c, check_motion(&element, s, k)));
    }
    for (size_t k = 0; k < e->load_count; k++) {
        check element = gn_check_element(reader, root, "elements.loads", k);
        if (gn_check_element_sound(&element))
            GN_TRY(gn_check_keep(&c, check_load(&element, s, &e->loads[k])));
    }
    return GNEISS_OK;
}
