/* Cross-key checks of `clumps`. */
#include "scene/check.h"

#include "base/names.h"

#include <string.h>

int gn_scene_find_clump_shape(const gn_scene *scene, const char *name) {
    for (size_t k = 0; k < scene->clumps.shape_count; k++)
        if (strcmp(scene->clumps.shapes[k].name, name) == 0) return (int)k;
    return -1;
}

static gneiss_status check_shape_name(const check *section, const gn_scene *scene, const char *key,
                                      const char *name) {
    char advice[GN_ADVICE_SIZE];
    gn_names names = gn_names_for(name);
    if (gn_scene_find_clump_shape(scene, name) >= 0) return GNEISS_OK;
    for (size_t k = 0; k < scene->clumps.shape_count; k++)
        gn_names_add(&names, scene->clumps.shapes[k].name);
    return gn_check_fail(section, key, "expected the name of a shape of clumps, found '%s'%s", name,
                         gn_names_advice(&names, advice, sizeof advice));
}

/* Refuses spheres about one centre, of which the smaller one would have no effect. */
static gneiss_status check_centres(const check *section, const gn_clump_shape_def *shape) {
    const double *x = shape->spheres;
    for (size_t k = 1; k < shape->sphere_count; k++)
        for (size_t i = 0; i < k; i++)
            if (x[4 * i] == x[4 * k] && x[4 * i + 1] == x[4 * k + 1] &&
                x[4 * i + 2] == x[4 * k + 2])
                return gn_check_fail(section, "spheres",
                                     "expected distinct centres, found rows %zu and %zu (base 0) "
                                     "about one centre",
                                     i, k);
    return GNEISS_OK;
}

static gneiss_status check_shape(const check *section, const gn_scene *scene, size_t index) {
    gn_clump_shape_def *shape = &scene->clumps.shapes[index];
    GN_TRY(gn_check_name(section, gn_scene_find_clump_shape(scene, shape->name) != (int)index,
                         shape->name));
    if (*shape->surface && shape->sphere_count)
        return gn_check_fail(section, "spheres",
                             "expected the number of spheres beside surface, found rows");
    if (*shape->surface && !shape->fill)
        return gn_check_fail(section, "spheres", "required beside surface, but not given");
    if (!*shape->surface && !shape->sphere_count)
        return gn_check_fail(section, "spheres",
                             "expected rows of spheres, or a surface beside their number, found %s",
                             shape->fill ? "the number alone" : "none");
    GN_TRY(check_centres(section, shape));
    if (!*shape->material && scene->material_count == 1)
        memcpy(shape->material, scene->materials[0].name, sizeof shape->material);
    if (!*shape->material && scene->material_count > 1)
        return gn_check_fail(section, "material",
                             "required beside several materials, but not given");
    return gn_check_material_name(section, scene, "material", shape->material);
}

static gneiss_status check_placed(const check *section, const gn_scene *scene, size_t index) {
    return check_shape_name(section, scene, "shape", scene->clumps.placed[index].shape);
}

static gneiss_status check_filled(const check *section, const gn_scene *scene, size_t index) {
    const gn_filled_clumps_def *filled = &scene->clumps.filled[index];
    for (size_t k = 0; k < filled->shape_count; k++)
        GN_TRY(check_shape_name(section, scene, "shapes", filled->shapes[k]));
    return gn_check_box(section, scene, "box.max", filled->box_min, filled->box_max);
}

/* Refuses what clumps cannot be combined with. */
static gneiss_status check_beside(const check *section, const gn_scene *scene) {
    const struct {
        bool found;
        const char *what;
    } others[] = {
        {scene->has_elements, "elements"},
        {scene->has_membrane, "membrane"},
        {gn_scene_tested(scene), "test"},
        {scene->joint_count > 0, "joints"},
        {scene->sink_count > 0, "sinks"},
        {scene->set_count > 0, "sets"},
        {gn_scene_box_moves(scene), "a periodic box that moves"},
        {scene->has_mass_scaling, "time.mass_scaling"},
        {scene->start == GN_START_FIRST_BREAK, "time.start: first_break"},
        {scene->has_pulse, "initial.pulse"},
        {scene->random_velocity > 0, "initial.random_velocity"},
        {scene->rotation == GN_SWITCH_OFF, "law.rotation: off"},
        {*scene->specimen.from != '\0', "specimen.from"},
        {scene->specimen.density_basis == GN_DENSITY_BULK, "specimen.density_basis: bulk"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, "clumps",
                                 "expected a scene without %s, found one with it", others[k].what);
    if (scene->clumps.placed_count || scene->clumps.filled_count || *scene->clumps.file)
        return GNEISS_OK;
    return gn_check_fail(section, "clumps", "expected placed, filled or file in it, found none");
}

gneiss_status gn_check_clumps(const gn_reader *reader, const gn_node *root) {
    const gn_scene *scene = reader->scene;
    const check c = {.reader = reader, .map = root};
    if (!scene->has_clumps) return GNEISS_OK;
    GN_TRY(gn_check_list(&c, "clumps.shapes", scene->clumps.shape_count, check_shape));
    if (gn_check_names_are_valid(&c, "clumps.shapes")) {
        GN_TRY(gn_check_list(&c, "clumps.placed", scene->clumps.placed_count, check_placed));
        GN_TRY(gn_check_list(&c, "clumps.filled", scene->clumps.filled_count, check_filled));
    }
    if (!gn_check_is_valid(&c, "clumps")) return GNEISS_OK;
    return gn_check_keep_problem(&c, check_beside(&c, scene));
}
