/* Cross-key checks of finite elements. */
#include "scene/check.h"

#include <math.h>
#include <string.h>

/* ---- mesh ---- */

static gneiss_status check_block(const check *section, const gn_scene *scene, const char *kind) {
    const gn_element_def *elements = &scene->elements;
    char key[64];
    for (int64_t k = 0; k < scene->dimension; k++) {
        snprintf(key, sizeof key, "elements.%s.size", kind);
        if (!gn_range_holds(GN_LENGTHS, elements->size[k]))
            return gn_check_fail(section, key, "expected lengths in %s m, found %g m along %c",
                                 GN_LENGTHS, elements->size[k], "xyz"[k]);
    }
    snprintf(key, sizeof key, "elements.%s.distortion", kind);
    if (scene->dimension == 3 && elements->distortion >= 1.0 / 6.0)
        return gn_check_fail(section, key, "expected a value below 1/6 in 3D, found %g",
                             elements->distortion);
    return GNEISS_OK;
}

static gneiss_status check_notch(const check *section, const gn_beam_def *beam) {
    if (!(beam->notch_depth > 0)) {
        if (beam->notch_width > 0)
            return gn_check_fail(section, "elements.beam.notch_width",
                                 "expected notch_depth beside it, found none");
        return GNEISS_OK;
    }
    if (!(beam->notch_width > 0))
        return gn_check_fail(section, "elements.beam.notch_width",
                             "required by notch_depth, but not given");
    if (beam->notch_depth >= beam->height)
        return gn_check_fail(section, "elements.beam.notch_depth",
                             "expected a depth below the height of %g m, found %g m", beam->height,
                             beam->notch_depth);
    double span = beam->span > 0 ? beam->span : beam->length;
    if (beam->notch_width < span) return GNEISS_OK;
    return gn_check_fail(section, "elements.beam.notch_width",
                         "expected a width below the distance of the supports, %g m, found %g m",
                         span, beam->notch_width);
}

static gneiss_status check_beam(const check *section, const gn_scene *scene) {
    const gn_beam_def *beam = &scene->elements.beam;
    if (scene->dimension == 3 && !(beam->thickness > 0))
        return gn_check_fail(section, "elements.beam.thickness",
                             "required in a 3D scene, but not given");
    if (scene->dimension == 2 && beam->thickness > 0)
        return gn_check_fail(section, "elements.beam.thickness",
                             "expected none in a 2D scene, which is 1 m thick, found %g m",
                             beam->thickness);
    if (beam->span > beam->length)
        return gn_check_fail(section, "elements.beam.span",
                             "expected at most the length of %g m, found %g m", beam->length,
                             beam->span);
    double cells = beam->length / beam->cell * (beam->height / beam->cell);
    if (scene->dimension == 3) cells *= fmax(1.0, beam->thickness / beam->cell);
    if (cells > 1e8)
        return gn_check_fail(section, "elements.beam.cell",
                             "expected a size that gives at most 1e8 cells, found %g m",
                             beam->cell);
    return check_notch(section, beam);
}

static gneiss_status check_mesh(const check *section, const gn_scene *scene) {
    const gn_element_def *elements = &scene->elements;
    int sources =
        (elements->mesh[0] != 0) + elements->has_rectangle + elements->has_box + elements->has_beam;
    if (sources != 1)
        return gn_check_fail(section, "elements", "expected one of mesh, %s, beam, found %s",
                             scene->dimension == 2 ? "rectangle" : "box",
                             sources ? "several" : "none");
    if (elements->scale != 1 && !elements->mesh[0])
        return gn_check_fail(section, "elements.scale",
                             "expected a mesh file beside it, found none");
    if (elements->has_beam) return check_beam(section, scene);
    return elements->mesh[0] ? GNEISS_OK
                             : check_block(section, scene, elements->has_box ? "box" : "rectangle");
}

/* ---- materials, motions, loads ---- */

static gneiss_status check_poisson(const check *section, const gn_element_material *material) {
    if (material->poisson < 0.5) return GNEISS_OK;
    return gn_check_fail(section, "poisson",
                         "expected a value below 0.5, because an explicit scheme has no stable "
                         "step for an incompressible material, found %g; try 0.49",
                         material->poisson);
}

static gneiss_status check_region(const check *section, const gn_scene *scene,
                                  const gn_region *region) {
    if (!*region->group == !region->has_box)
        return gn_check_fail(section, "group", "expected group or box, found %s",
                             region->has_box ? "both" : "none");
    if (!region->has_box) return GNEISS_OK;
    for (int64_t k = 0; k < scene->dimension; k++)
        if (!(region->box_min[k] <= region->box_max[k]))
            return gn_check_fail(section, "box.max",
                                 "expected a corner not below min, found %c: %g to %g", "xyz"[k],
                                 region -> box_min[k], region -> box_max[k]);
    return GNEISS_OK;
}

static gneiss_status check_motion(const check *section, const gn_scene *scene, size_t index) {
    const gn_element_motion *motion = &scene->elements.motions[index];
    if (gn_scene_find_element_motion(scene, motion->name) != (int)index ||
        gn_scene_find_set(scene, motion->name) >= 0 ||
        gn_scene_find_wall(scene, motion->name) >= 0 ||
        gn_scene_find_body(scene, motion->name) >= 0)
        return gn_check_fail(section, "name", "expected a unique name, found '%s' a second time",
                             motion->name);
    GN_TRY(check_region(section, scene, &motion->region));
    return gn_check_plane_motion(section, scene, &motion->motion);
}

static gneiss_status check_load(const check *section, const gn_scene *scene,
                                const gn_element_load *load) {
    GN_TRY(check_region(section, scene, &load->region));
    if (load->has_traction == load->has_force)
        return gn_check_fail(section, "force", "expected traction or force, found %s",
                             load->has_force ? "both" : "none");
    const gn_table *value = load->has_force ? load->force : load->traction;
    if (scene->dimension == 2 && value[2].count)
        return gn_check_fail(section, load->has_force ? "force.fz" : "traction.tz",
                             "expected nothing out of the plane of a 2D scene");
    if (value[0].count || value[1].count || value[2].count) return GNEISS_OK;
    return gn_check_fail(section, load->has_force ? "force" : "traction",
                         "expected at least one component, found none");
}

/* Checks the keys outside lists. */
static gneiss_status check_whole(const check *section, const gn_scene *scene) {
    const gn_element_def *elements = &scene->elements;
    GN_TRY(check_mesh(section, scene));
    if (elements->has_contact)
        GN_TRY(gn_check_side(section, scene, "elements.contact.",
                             (gn_side_keys){elements->contact.stiffness, elements->contact.kratio,
                                            elements->contact.friction, 0.0, 0.0,
                                            elements->contact.material, false}));
    if (elements->has_contact && scene->has_periodic)
        return gn_check_fail(section, "elements.contact",
                             "expected no periodic box beside it, found one");
    return GNEISS_OK;
}

gneiss_status gn_check_elements(const gn_reader *reader, const gn_node *root) {
    const gn_scene *scene = reader->scene;
    const gn_element_def *elements = &scene->elements;
    check c = {.reader = reader, .map = root};
    if (gn_check_is_valid(&c, "elements"))
        GN_TRY(gn_check_keep_problem(&c, check_whole(&c, scene)));
    for (size_t k = 0; k < elements->material_count; k++) {
        check element = gn_check_element(reader, root, "elements.materials", k);
        if (gn_check_element_is_valid(&element))
            GN_TRY(gn_check_keep_problem(&c, check_poisson(&element, &elements->materials[k])));
    }
    for (size_t k = 0; k < elements->motion_count; k++) {
        check element = gn_check_element(reader, root, "elements.motions", k);
        if (gn_check_element_is_valid(&element))
            GN_TRY(gn_check_keep_problem(&c, check_motion(&element, scene, k)));
    }
    for (size_t k = 0; k < elements->load_count; k++) {
        check element = gn_check_element(reader, root, "elements.loads", k);
        if (gn_check_element_is_valid(&element))
            GN_TRY(gn_check_keep_problem(&c, check_load(&element, scene, &elements->loads[k])));
    }
    return GNEISS_OK;
}
