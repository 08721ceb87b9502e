#include "scene/check.h"
#include "scene/sides.h"

#include "base/names.h"
#include "scene/acts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

check gn_check_element(const gn_reader *reader, const gn_node *root, const char *list,
                       size_t index) {
    check c = {.reader = reader, .map = gn_node_item(gn_node_find(root, list), index)};
    snprintf(c.prefix, sizeof c.prefix, "%s[%zu].", list, index);
    return c;
}

gneiss_status gn_check_fail(const check *section, const char *key, const char *format, ...) {
    char text[1024], path[GN_KEY_PATH_SIZE], up[GN_KEY_PATH_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    snprintf(path, sizeof path, "%s%s", section->prefix, key);
    if (!*key && *path) path[strlen(path) - 1] = '\0'; /* the element itself */
    snprintf(up, sizeof up, "%s", key);
    const gn_node *node = gn_node_find(section->map, up);
    bool value =
        node && node->kind != GN_NODE_MAP; /* a section is reported at the place of its key */
    while (!node) {
        char *dot = strrchr(up, '.');
        if (dot) *dot = '\0';
        node = dot ? gn_node_find(section->map, up) : section->map;
    }
    return gn_read_fail(section->reader, node, value ? node->where : node->key_where, path, "%s",
                        text);
}

gneiss_status gn_check_needs(const check *section, const char *key, const char *found,
                             const char *format, ...) {
    char needed[512];
    va_list args;
    va_start(args, format);
    vsnprintf(needed, sizeof needed, format, args);
    va_end(args);
    return gn_check_fail(section, key, "needs %s; found %s", needed, found);
}

gneiss_status gn_check_name(const check *section, bool taken, const char *name) {
    return taken ? gn_check_fail(section, "name",
                                 "expected a unique name, found '%s' a second time", name)
                 : GNEISS_OK;
}

bool gn_check_given(const check *section, const char *key) {
    return gn_node_find(section->map, key) != NULL;
}

gneiss_status gn_check_keep_problem(const check *section, gneiss_status status) {
    return gn_read_keep_problem(section->reader, status);
}

bool gn_check_is_valid(const check *section, const char *path) {
    return !gn_problem_near(section->reader->problems, path);
}

bool gn_check_names_are_valid(const check *section, const char *list) {
    return !gn_problem_names(section->reader->problems, list);
}

bool gn_check_element_is_valid(const check *section) {
    char path[sizeof section->prefix];
    snprintf(path, sizeof path, "%.*s", (int)strlen(section->prefix) - 1, section->prefix);
    return gn_check_is_valid(section, path);
}

gneiss_status gn_check_material_name(const check *section, const gn_scene *scene, const char *key,
                                     const char *name) {
    char advice[GN_ADVICE_SIZE];
    gn_names names = gn_names_for(name);
    if (!gn_check_names_are_valid(section, "materials") || gn_scene_find_material(scene, name) >= 0)
        return GNEISS_OK;
    for (size_t k = 0; k < scene->material_count; k++)
        gn_names_add(&names, scene->materials[k].name);
    return gn_check_fail(section, key, "expected the name of a material, found '%s'%s", name,
                         gn_names_advice(&names, advice, sizeof advice));
}

/* ---- specimen ---- */

enum { SOURCES_SIZE = 128 };

static void add_source(char sources[SOURCES_SIZE], const char *name) {
    size_t used = strlen(sources);
    snprintf(sources + used, SOURCES_SIZE - used, "%s%s", used ? ", " : "", name);
}

/* Checks that exactly one source is given, writes its name to `source`, and sets the kind of the
 * shape. */
static gneiss_status check_source(const check *section, gn_specimen *specimen, int64_t dimension,
                                  char source[SOURCES_SIZE]) {
    char path[GN_KEY_PATH_SIZE], shapes[GN_SHAPE_NAMES_SIZE];
    source[0] = '\0';
    if (*specimen->file) add_source(source, "file");
    if (*specimen->from) add_source(source, "from");
    if (specimen->particle_count) add_source(source, "a list of particles");
    if (specimen->lattice.kind != GN_LATTICE_NONE) add_source(source, "lattice");
    for (size_t k = 0; k < gn_specimen_section.key_count; k++) {
        const gn_key *key = &gn_specimen_section.keys[k];
        snprintf(path, sizeof path, "specimen.%s", key->name);
        if (!key->shape || !gn_check_given(section, path)) continue;
        specimen->pack.shape = key->shape;
        add_source(source, key->name);
    }
    if (*source && !strchr(source, ',')) return GNEISS_OK;
    gn_shape_names(dimension, shapes);
    if (section->reader->specimen_only)
        return gn_check_fail(section, "specimen", "expected one of %s, found %s", shapes,
                             *source ? source : "none");
    return gn_check_fail(section, "specimen",
                         "expected one of file, a list of particles, lattice, %s, found %s", shapes,
                         *source                ? source
                         : specimen->pack.count ? "a number of particles only"
                                                : "none");
}

static bool is_zero(const double vector[3]) {
    return vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
}

/* Refuses keys that only shapes have. */
static gneiss_status check_no_shape(const check *section, gn_specimen *specimen, int64_t dimension,
                                    const char *source) {
    char shapes[GN_SHAPE_NAMES_SIZE];
    gn_shape_names(dimension, shapes);
    const char *key = section->reader->specimen_only                ? "specimen"
                      : specimen->pack.count                        ? "specimen.particles"
                      : specimen->pack.mean_radius > 0              ? "specimen.mean_radius"
                      : !is_zero(specimen->pack.origin)             ? "specimen.origin"
                      : gn_check_given(section, "specimen.packing") ? "specimen.packing"
                                                                    : NULL;
    /* The origin is not written to files, where the sign of a zero would be lost. */
    if (!key) memset(specimen->pack.origin, 0, sizeof specimen->pack.origin);
    if (!key) return GNEISS_OK;
    if (section->reader->specimen_only)
        return gn_check_fail(section, key, "expected one of %s, found %s", shapes, source);
    return gn_check_needs(section, key, source, "one of %s", shapes);
}

static gneiss_status check_refinement(const check *section, const gn_refinement *refinement) {
    if (gn_check_given(section, "from") != gn_check_given(section, "to"))
        return gn_check_given(section, "from")
                   ? gn_check_fail(section, "to", "required beside from, but not given")
                   : gn_check_fail(section, "from", "required beside to, but not given");
    if (refinement->has_region == refinement->boundary)
        return gn_check_fail(section, "boundary",
                             "expected from and to, or boundary: true, found %s",
                             refinement->boundary ? "both" : "none");
    const double *low = refinement->lower, *high = refinement->upper;
    for (int k = 0; k < 3; k++)
        if (low[k] > high[k])
            return gn_check_fail(section, "to",
                                 "expected a corner not below from, found %c: %g to %g", "xyz"[k],
                                 low[k], high[k]);
    return GNEISS_OK;
}

/* Checks that the particles are given by their number, by their size, or by the nodes of a mesh. */
static gneiss_status check_amount(const check *section, const gn_pack_def *pack,
                                  const char *shape) {
    const char *key = pack->count ? "specimen.particles" : "specimen.mean_radius";
    bool some = pack->count || pack->mean_radius > 0;
    if (pack->start == GN_START_NODES) {
        if (pack->shape != GN_SHAPE_MESH)
            return gn_check_fail(section, "specimen.packing.start",
                                 "expected mesh beside nodes, found %s", shape);
        if (!some) return GNEISS_OK;
        return gn_check_fail(
            section, key,
            "expected to be left out beside packing.start nodes (each inner node of the "
            "mesh becomes a particle), found it given");
    }
    if (!some)
        return gn_check_fail(section, "specimen",
                             "expected particles (a number) or mean_radius beside %s, found none",
                             shape);
    if (pack->count && pack->mean_radius > 0)
        return gn_check_fail(section, "specimen.mean_radius",
                             "expected particles or mean_radius, found both");
    return GNEISS_OK;
}

static gneiss_status check_pack(const check *section, const gn_pack_def *pack, const char *shape) {
    bool fixed = pack->shape == GN_SHAPE_POLYGON || pack->shape == GN_SHAPE_SURFACE ||
                 pack->shape == GN_SHAPE_MESH;
    if (fixed && !is_zero(pack->origin))
        return gn_check_needs(section, "specimen.origin", shape,
                              "rectangle, disc, box or cylinder");
    GN_TRY(check_amount(section, pack, shape));
    GN_TRY(gn_check_sieve(section, "specimen.packing.", pack->sizes == GN_SIZES_SIEVE, pack->sieve,
                          pack->sieve_count));
    if (pack->sizes == GN_SIZES_SIEVE && gn_check_given(section, "specimen.packing.size_ratio"))
        return gn_check_needs(section, "specimen.packing.size_ratio",
                              "sieve, whose first row has the smallest size",
                              "sizes: fitted, uniform or normal");
    if (pack->size_variation >= 0 &&
        (pack->sizes == GN_SIZES_UNIFORM || pack->sizes == GN_SIZES_SIEVE))
        return gn_check_needs(section, "specimen.packing.size_variation",
                              pack->sizes == GN_SIZES_UNIFORM ? "uniform, which implies its own"
                                                              : "sieve, which implies its own",
                              "sizes: fitted or normal");
    if (pack->overlap == GN_OVERLAP_NONE && pack->overlap_size >= 0)
        return gn_check_needs(section, "specimen.packing.overlap_size", "none", "overlap passive");
    for (size_t k = 0; k < pack->refinement_count; k++) {
        check element =
            gn_check_element(section->reader, section->map, "specimen.packing.refine", k);
        GN_TRY(check_refinement(&element, &pack->refinements[k]));
    }
    return GNEISS_OK;
}

/* Cuts the body to the region. The bits of a body inside the region stay the same, so that a scene
 * that was written is read back unchanged. */
static gneiss_status clip(const check *section, gn_pack_def *pack, int dimension,
                          const char *shape) {
    const double *low = pack->region_min, *high = pack->region_max;
    if (!pack->has_region) return GNEISS_OK;
    if (pack->shape != GN_SHAPE_RECTANGLE && pack->shape != GN_SHAPE_BOX)
        return gn_check_needs(
            section, "specimen.packing.region", shape,
            "a rectangle or box, of which it is a part (pack a smaller body instead)");
    for (int a = 0; a < dimension; a++) {
        const double upper = pack->origin[a] + pack->size[a], rounding = 1e-12 * pack->size[a];
        if (!(low[a] < high[a]) || !(fmax(low[a], pack->origin[a]) < fmin(high[a], upper)))
            return gn_check_fail(section, "specimen.packing.region",
                                 "expected a box that contains a part of the body, %c from %g to "
                                 "%g m, found %g to %g m",
                                 "xyz"[a], pack -> origin[a], upper, low[a], high[a]);
        const bool below = low[a] > pack->origin[a] + rounding, above = high[a] < upper - rounding;
        if (below) pack->origin[a] = low[a];
        if (below || above) pack->size[a] = (above ? high[a] : upper) - pack->origin[a];
    }
    return GNEISS_OK;
}

/* Checks that `scale` comes with a file whose lengths it scales. */
static gneiss_status check_scale(const check *section, const gn_specimen *specimen,
                                 const char *source) {
    const gn_shape_kind shape = specimen->pack.shape;
    if (specimen->scale == 1.0 || *specimen->file || shape == GN_SHAPE_SURFACE ||
        shape == GN_SHAPE_MESH)
        return GNEISS_OK;
    return gn_check_needs(section, "specimen.scale", source,
                          "file, surface or mesh, whose lengths it scales");
}

static gneiss_status check_particles(const check *section, gn_scene *scene) {
    gn_specimen *specimen = &scene->specimen;
    char source[SOURCES_SIZE];
    GN_TRY(check_source(section, specimen, scene->dimension, source));
    GN_TRY(check_scale(section, specimen, source));
    if (specimen->pack.shape == GN_SHAPE_NONE)
        GN_TRY(check_no_shape(section, specimen, scene->dimension, source));
    else
        GN_TRY(check_pack(section, &specimen->pack, source));
    GN_TRY(clip(section, &specimen->pack, (int)scene->dimension, source));
    bool plane = specimen->lattice.kind == GN_LATTICE_SQUARE ||
                 specimen->lattice.kind == GN_LATTICE_HEXAGONAL;
    if (specimen->lattice.kind != GN_LATTICE_NONE && plane != (scene->dimension == 2))
        return gn_check_fail(section, "specimen.lattice.kind",
                             "expected a lattice of a %dD scene: %s", (int)scene->dimension,
                             scene->dimension == 2 ? "square, hexagonal" : "cubic, fcc, hcp");
    if (specimen->porosity >= 0 && specimen->density_basis != GN_DENSITY_BULK)
        return gn_check_needs(section, "specimen.porosity", "particle", "density_basis bulk");
    return GNEISS_OK;
}

static gneiss_status not_given(const check *section, const char *key) {
    return gn_check_fail(section, key, "required, but not given");
}

static gneiss_status check_specimen(const check *section, gn_scene *scene) {
    gn_specimen *specimen = &scene->specimen;
    if (!scene->has_specimen)
        return gn_check_fail(section, "specimen",
                             "required, but not given; expected a specimen, sources, "
                             "elements or several of them");
    if (!scene->material_count && gn_check_is_valid(section, "materials"))
        GN_TRY(gn_check_keep_problem(section, not_given(section, "materials")));
    if (!scene->has_law && gn_check_is_valid(section, "law"))
        GN_TRY(gn_check_keep_problem(section, not_given(section, "law")));
    if (!scene->specimen_given) return GNEISS_OK; /* sources or clumps supply all particles */
    GN_TRY(gn_check_keep_problem(section, check_particles(section, scene)));
    if (!*specimen->material && scene->material_count == 1)
        memcpy(specimen->material, scene->materials[0].name, sizeof specimen->material);
    if (!*specimen->material && *specimen->file) return GNEISS_OK; /* a column may name them */
    return gn_check_material_name(section, scene, "specimen.material", specimen->material);
}

gneiss_status gn_check_shape(gn_reader *reader, const gn_node *root) {
    check c = {.reader = reader, .map = root};
    if (!gn_check_is_valid(&c, "specimen")) return GNEISS_OK;
    reader->scene->has_specimen = reader->scene->specimen_given;
    return gn_check_keep_problem(&c, reader->scene->has_specimen
                                         ? check_particles(&c, reader->scene)
                                         : not_given(&c, "specimen"));
}

/* ---- materials and bonds ---- */

gneiss_status gn_check_required(const check *section, double value, const char *key,
                                const char *reason) {
    if (value > 0) return GNEISS_OK;
    return gn_check_keep_problem(section,
                                 gn_check_fail(section, key, "required %s, but not given", reason));
}

/* Checks that resistance to rolling has a tangential spring, from which its stiffness follows. */
static gneiss_status check_rolls(const check *section, const gn_material *material, bool area) {
    bool rolls = material->rolling_friction > 0 || material->twisting_friction > 0;
    if (!rolls || (area ? material->beta : material->kratio) != 0) return GNEISS_OK;
    return gn_check_needs(
        section, material->rolling_friction > 0 ? "rolling_friction" : "twisting_friction", "0",
        "%s above 0, which its stiffness follows from", area ? "beta" : "kratio");
}

static gneiss_status check_law_values(const check *section, const gn_scene *scene,
                                      const gn_material *material) {
    bool bonds = scene->bonds == GN_SWITCH_ON, area = gn_scene_by_area(scene);
    if (material->kratio > 0 && material->kratio < 1e-6)
        return gn_check_fail(section, "kratio",
                             "expected 0 (no tangential spring) or at least 1e-6, found %g",
                             material->kratio);
    if (gn_scene_hertz(scene)) return gn_check_hertz_material(section, material);
    if (material->restitution >= 0)
        return gn_check_needs(section, "restitution",
                              "another (all others have damping.contact.restitution)",
                              "law.stiffness hertz");
    if (!area)
        GN_TRY(
            gn_check_required(section, material->kratio + 1.0, "kratio", "by this law.stiffness"));
    GN_TRY(check_rolls(section, material, area));
    if (area || material->kratio >= 0) GN_TRY(gn_check_grip(section, scene, material));
    if (bonds) GN_TRY(gn_check_bonds_of(section, scene, material));
    if (scene->stiffness == GN_STIFFNESS_UNIFORM) {
        GN_TRY(gn_check_required(section, material->normal_stiffness, "normal_stiffness",
                                 "by the uniform law"));
        if (!bonds) return GNEISS_OK;
        GN_TRY(gn_check_required(section, material->bond_tension_limit, "bond_tension_limit",
                                 "by bonds of the uniform law"));
        return gn_check_required(section, material->bond_shear_limit, "bond_shear_limit",
                                 "by bonds of the uniform law");
    }
    if (area) GN_TRY(gn_check_required(section, material->young, "young", "by laws by area"));
    if (area)
        GN_TRY(gn_check_required(section, material->poisson + 1.0, "poisson", "by laws by area"));
    if (!area)
        GN_TRY(gn_check_required(section, material->contact_modulus, "contact_modulus",
                                 "by this law.stiffness"));
    if (!bonds) return GNEISS_OK;
    GN_TRY(gn_check_required(section, material->tensile_strength, "tensile_strength",
                             "by bonds of this law.stiffness"));
    return gn_check_required(section, material->shear_strength, "shear_strength",
                             "by bonds of this law.stiffness");
}

static gneiss_status check_material(const check *section, const gn_scene *scene, size_t index) {
    const gn_material *material = &scene->materials[index];
    GN_TRY(gn_check_name(section, gn_scene_find_material(scene, material->name) != (int)index,
                         material->name));
    GN_TRY(gn_check_scatter(section, "strength_scatter", &material->strength_scatter));
    GN_TRY(gn_check_scatter(section, "stiffness_scatter", &material->stiffness_scatter));
    return check_law_values(section, scene, material);
}

/* ---- damping ---- */

/* Checks the coefficient, which is a rate or a fraction depending on the model. */
static gneiss_status check_background(const check *section, const gn_scene *scene, const char *key,
                                      double coefficient) {
    double value;
    const gn_node *node = gn_node_find(section->map, key);
    if (node && scene->background != GN_BACKGROUND_NONE && coefficient >= 0) {
        const char *unit = scene->background == GN_BACKGROUND_VISCOUS ? "1/s" : "1";
        char reason[96];
        if (!gn_units_read(section->reader->units, node->text, unit, &value, reason, sizeof reason))
            return gn_check_fail(section, key, "expected %s for this model, found '%.60s'%s",
                                 gn_unit_text(unit), node->text, reason);
    }
    if (scene->background > GN_BACKGROUND_VISCOUS && coefficient >= 1)
        return gn_check_fail(section, key, "expected a fraction in [0, 1), found %g", coefficient);
    return GNEISS_OK;
}

static gneiss_status check_damping(const check *section, const gn_scene *scene) {
    const char *key = "damping.background.coefficient", *spin = "damping.background.rotation";
    if (scene->background == GN_BACKGROUND_NONE && scene->background_coefficient > 0)
        return gn_check_needs(section, key, "none", "a model");
    if (scene->background == GN_BACKGROUND_NONE && scene->background_spin > 0)
        return gn_check_needs(section, spin, "none", "a model");
    if (scene->background != GN_BACKGROUND_NONE && !gn_check_given(section, key))
        return gn_check_fail(section, key, "required by the model, but not given");
    GN_TRY(check_background(section, scene, key, scene->background_coefficient));
    GN_TRY(check_background(section, scene, spin, scene->background_spin));
    if (scene->background_spin >= 0 && scene->rotation == GN_SWITCH_OFF)
        return gn_check_needs(section, spin, "off", "law.rotation on");
    if (scene->background != GN_BACKGROUND_NONVISCOUS_COMPONENT &&
        scene->background_velocity == GN_VELOCITY_INSTANT)
        return gn_check_fail(section, "damping.background.velocity",
                             "instant needs the model nonviscous_component, found another one");
    if (scene->restitution >= 0 && scene->damping_fraction > 0)
        return gn_check_fail(section, "damping.contact.fraction",
                             "expected restitution or fraction, found both");
    return GNEISS_OK;
}

/* ---- boxes ---- */

gneiss_status gn_check_box(const check *section, const gn_scene *scene, const char *key,
                           const double *low, const double *high) {
    for (int64_t k = 0; k < scene->dimension; k++)
        if (!(low[k] < high[k]))
            return gn_check_fail(
                section, key, "expected a corner above min in every direction, found %c: %g to %g",
                "xyz"[k], low[k], high[k]);
    return GNEISS_OK;
}

static gneiss_status check_surroundings(const check *section, const gn_scene *scene) {
    GN_TRY(gn_check_box_sides(section, scene));
    if (!scene->has_domain) return GNEISS_OK;
    if (!gn_check_given(section, "domain.min"))
        return gn_check_fail(section, "domain.min", "required beside max, but not given");
    if (!gn_check_given(section, "domain.max"))
        return gn_check_fail(section, "domain.max", "required beside min, but not given");
    return gn_check_box(section, scene, "domain.max", scene->domain_min, scene->domain_max);
}

/* ---- sets and walls ---- */

gneiss_status gn_check_plane_motion(const check *section, const gn_scene *scene,
                                    const gn_motion *motion) {
    if (scene->dimension != 2) return GNEISS_OK;
    const char *key = motion->velocity[2].count ? "motion.vz"
                      : motion->spin[0].count   ? "motion.wx"
                      : motion->spin[1].count   ? "motion.wy"
                                                : NULL;
    if (!key) return GNEISS_OK;
    return gn_check_fail(section, key,
                         "expected no motion out of the plane of a 2D scene: only vx, vy and wz");
}

static gneiss_status check_spin(const check *section, const gn_scene *scene,
                                const gn_set_def *set) {
    if (scene->rotation != GN_SWITCH_OFF) return GNEISS_OK;
    static const char *const keys[] = {"motion.wx", "motion.wy", "motion.wz"};
    for (int k = 0; k < 3; k++)
        if (set->motion.spin[k].count)
            return gn_check_fail(section, keys[k],
                                 "expected law.rotation on beside a spin, found off");
    if (set->has_initial_spin)
        return gn_check_fail(section, "initial_spin",
                             "expected law.rotation on beside a spin, found off");
    return GNEISS_OK;
}

/* Refuses an initial velocity that contradicts a velocity prescribed from the start. */
static gneiss_status check_start(const check *section, const gn_table given[3],
                                 const double start[3], const char *key, const char *axis) {
    for (int a = 0; a < 3; a++) {
        double first = given[a].count ? gn_table_at(&given[a], 0.0) : start[a];
        if (start[a] != 0.0 && start[a] != first)
            return gn_check_fail(section, key,
                                 "expected 0 or the prescribed %g in the component that "
                                 "motion.%s%c gives, found %g",
                                 first, axis, "xyz"[a], start[a]);
    }
    return GNEISS_OK;
}

static gneiss_status check_set(const check *section, const gn_scene *scene, size_t index) {
    const gn_set_def *set = &scene->sets[index];
    GN_TRY(gn_check_name(section,
                         gn_scene_find_set(scene, set->name) != (int)index ||
                             gn_scene_find_wall(scene, set->name) >= 0,
                         set->name));
    if (!set->all && !set->has_box && !set->id_count && set->end_axis < 0)
        return gn_check_fail(section, "select", "expected all, box, ids or end, found none");
    if (set->has_box)
        GN_TRY(gn_check_box(section, scene, "select.box.max", set->box_min, set->box_max));
    if (set->end_axis >= scene->dimension)
        return gn_check_fail(section, "select.end.axis", "expected x or y in a 2D scene, found z");
    if (*set->material) GN_TRY(gn_check_material_name(section, scene, "material", set->material));
    if (gn_check_is_valid(section, "law.rotation")) GN_TRY(check_spin(section, scene, set));
    GN_TRY(
        check_start(section, set->motion.velocity, set->initial_velocity, "initial_velocity", "v"));
    GN_TRY(check_start(section, set->motion.spin, set->initial_spin, "initial_spin", "w"));
    return gn_check_plane_motion(section, scene, &set->motion);
}

/* A unit vector stays as it is, so that no bit of a scene changes when it is written and read
 * again. */
bool gn_check_direction(double vector[3]) {
    double largest = fmax(fabs(vector[0]), fmax(fabs(vector[1]), fabs(vector[2])));
    if (!(largest > 0)) return false;
    double square = vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2];
    if (fabs(square - 1) <= 8 * DBL_EPSILON) return true;
    /* Scaling by a power of two near the largest component is exact and keeps squares from
     * overflowing. */
    int exponent;
    frexp(largest, &exponent);
    for (int k = 0; k < 3; k++) vector[k] = ldexp(vector[k], -exponent);
    double length = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    for (int k = 0; k < 3; k++) vector[k] /= length;
    return true;
}

static bool moves(const gn_motion *motion) {
    return motion->velocity[0].count || motion->velocity[1].count || motion->velocity[2].count;
}

static gneiss_status check_wall(const check *section, const gn_scene *scene, size_t index) {
    gn_wall_def *wall = &scene->walls[index];
    GN_TRY(gn_check_name(section, gn_scene_find_wall(scene, wall->name) != (int)index, wall->name));
    if (!gn_check_direction(wall->normal))
        return gn_check_fail(section, "normal", "expected a direction, found [0, 0, 0]");
    GN_TRY(gn_check_side(section, scene, "",
                         (gn_side_keys){wall->stiffness, wall->kratio, wall->friction,
                                        wall->rolling_friction, wall->twisting_friction,
                                        wall->material, false}));
    if (wall->servo.active && moves(&wall->motion))
        return gn_check_fail(section, "servo", "expected motion or servo, found both");
    return gn_check_plane_motion(section, scene, &wall->motion);
}

/* Checks that a wall which holds the mean stress is one of a box of walls along the axes. */
static gneiss_status check_mean(const check *section, const gn_scene *scene, size_t index) {
    bool belongs = false, closed = true;
    for (int a = 0; a < (int)scene->dimension; a++)
        for (int sense = -1; sense <= 1; sense += 2) {
            const int wall = gn_scene_wall_facing(scene, a, sense);
            belongs = belongs || wall == (int)index;
            closed = closed && wall >= 0;
        }
    if (!scene->walls[index].servo.stress.count)
        return gn_check_fail(section, "servo.stress_of", "expected stress beside it, found force");
    for (size_t k = 0; k < index; k++)
        if (scene->walls[k].servo.of_mean &&
            !gn_targets_agree(&scene->walls[k].servo.stress, &scene->walls[index].servo.stress))
            return gn_check_fail(section, "servo.stress",
                                 "expected the stress of wall '%s', because both hold the mean "
                                 "(stress_of), found another",
                                 scene->walls[k].name);
    if (belongs && closed) return GNEISS_OK;
    return gn_check_fail(section, "servo.stress_of",
                         "expected a wall of a box: two walls across every axis that face each "
                         "other, of which it is the first in its direction, found %s",
                         closed ? "a further wall" : "an axis without");
}

static gneiss_status check_servo(const check *section, const gn_scene *scene, size_t index) {
    const gn_servo *servo = &scene->walls[index].servo;
    gn_facing facing;
    if (!servo->active) return GNEISS_OK;
    if (!servo->force.count == !servo->stress.count)
        return gn_check_fail(section, "servo", "expected force or stress, found %s",
                             servo->force.count ? "both" : "none");
    if (servo->of_mean) GN_TRY(check_mean(section, scene, index));
    if (servo->area > 0 && servo->force.count)
        return gn_check_needs(section, "servo.area", "force", "stress");
    if (servo->force.count || servo->area > 0 || gn_wall_covers_open_axis(scene, index) ||
        gn_facing_find(scene, index, &facing))
        return GNEISS_OK;
    return gn_check_fail(section, "servo.area",
                         "required beside stress without %s that face each other across this one, "
                         "but not given",
                         scene->dimension == 2 ? "two walls" : "two pairs of walls");
}

/* Refuses keys that require particles. */
static gneiss_status check_no_specimen(const check *section, const gn_scene *scene) {
    const struct {
        bool found;
        const char *key;
    } keys[] = {{scene->material_count > 0, "materials"},
                {scene->contact_count > 0, "contacts"},
                {scene->has_law, "law"},
                {scene->bonds == GN_SWITCH_ON, "bonds"},
                {scene->set_count > 0, "sets"},
                {scene->wall_count > 0, "walls"},
                {scene->has_periodic, "periodic"},
                {scene->has_domain, "domain"},
                {scene->random_velocity > 0, "initial.random_velocity"}};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (keys[k].found)
            return gn_check_needs(
                section, keys[k].key,
                "elements only (their materials, motions and loads belong under elements)",
                "a specimen");
    return GNEISS_OK;
}

gneiss_status gn_check_list(const check *section, const char *list, size_t count,
                            gn_check_one *one) {
    for (size_t k = 0; k < count; k++) {
        check element = gn_check_element(section->reader, section->map, list, k);
        if (!gn_check_element_is_valid(&element)) continue;
        GN_TRY(gn_check_keep_problem(section, one(&element, section->reader->scene, k)));
    }
    return GNEISS_OK;
}

static gneiss_status check_matter(const check *section, gn_scene *scene) {
    if (!gn_check_is_valid(section, "specimen") || !gn_check_is_valid(section, "elements"))
        return GNEISS_OK;
    if (scene->has_specimen || !scene->has_elements)
        return gn_check_keep_problem(section, check_specimen(section, scene));
    return gn_check_keep_problem(section, check_no_specimen(section, scene));
}

static gneiss_status check_from(const check *section, const gn_scene *scene) {
    if (!scene->specimen.from_bonds) return GNEISS_OK;
    if (!scene->specimen.from[0])
        return gn_check_fail(section, "specimen.from_bonds",
                             "expected none without specimen.from, found keep");
    if (scene->bonds == GN_SWITCH_ON || scene->stage_count)
        return GNEISS_OK; /* check_stages.c checks scenes with stages */
    return gn_check_fail(
        section, "specimen.from_bonds",
        "expected the section bonds beside keep, which defines their behaviour, found none");
}

gneiss_status gn_check_scene(gn_reader *reader, const gn_node *root) {
    gn_scene *scene = reader->scene;
    check c = {.reader = reader, .map = root};
    if (!gn_check_is_valid(&c, "dimension")) return GNEISS_OK;
    scene->has_specimen = scene->specimen_given || scene->source_count > 0 || scene->has_clumps;
    if (scene->bonds == GN_SWITCH_AUTO)
        scene->bonds = gn_check_given(&c, "bonds") ? GN_SWITCH_ON : GN_SWITCH_OFF;
    /* A scene that gives one stop condition gives all of them: in addition to it no other applies,
     * so that `auto` becomes 0. */
    if (scene->stop_peak_drop < 0 && (scene->stop_strain > 0 || scene->stop_unbalanced > 0) &&
        !gn_check_given(&c, "time.stop.peak_drop"))
        scene->stop_peak_drop = 0;
    GN_TRY(check_matter(&c, scene));
    GN_TRY(gn_check_keep_problem(&c, check_from(&c, scene)));
    if (scene->has_elements) GN_TRY(gn_check_elements(reader, root));
    GN_TRY(gn_check_couple(reader, root));
    if (scene->has_specimen && gn_check_is_valid(&c, "law.stiffness"))
        GN_TRY(gn_check_list(&c, "materials", scene->material_count, check_material));
    if (scene->has_specimen && gn_check_is_valid(&c, "law"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_gamma(&c, scene)));
    GN_TRY(gn_check_list(&c, "contacts", scene->contact_count, gn_check_contact));
    if (gn_check_is_valid(&c, "bonds") && gn_check_is_valid(&c, "law"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_hertz(&c, scene)));
    if (gn_check_is_valid(&c, "bonds") && gn_check_is_valid(&c, "law"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_moments(&c, scene)));
    if (gn_check_is_valid(&c, "law") && gn_check_is_valid(&c, "materials"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_coupling(&c, scene)));
    if (gn_check_is_valid(&c, "damping"))
        GN_TRY(gn_check_keep_problem(&c, check_damping(&c, scene)));
    if (gn_check_is_valid(&c, "periodic") && gn_check_is_valid(&c, "domain"))
        GN_TRY(gn_check_keep_problem(&c, check_surroundings(&c, scene)));
    GN_TRY(gn_check_list(&c, "sets", scene->set_count, check_set));
    GN_TRY(gn_check_list(&c, "walls", scene->wall_count, check_wall));
    if (gn_check_is_valid(&c, "walls"))
        GN_TRY(gn_check_list(&c, "walls", scene->wall_count, check_servo));
    GN_TRY(gn_check_bodies(reader, root));
    GN_TRY(gn_check_flow(reader, root));
    GN_TRY(gn_check_joints(reader, root));
    GN_TRY(gn_check_clumps(reader, root));
    if (gn_check_is_valid(&c, "membrane") && gn_check_is_valid(&c, "test") &&
        gn_check_is_valid(&c, "specimen"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_membrane(&c, scene)));
    if (gn_check_is_valid(&c, "test") && gn_check_is_valid(&c, "time.stop"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_test(&c, scene)));
    if (gn_check_is_valid(&c, "output"))
        GN_TRY(gn_check_keep_problem(&c, gn_check_output(&c, scene)));
    if (gn_check_is_valid(&c, "time")) GN_TRY(gn_check_time(&c, scene));
    if (!reader->problems->count) gn_note_idle_keys(reader, root);
    return GNEISS_OK;
}
