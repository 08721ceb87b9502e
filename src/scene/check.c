#include "scene/check.h"
#include "scene/sides.h"

#include "base/names.h"
#include "scene/facing.h"

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

gneiss_status gn_check_fail(const check *c, const char *key, const char *format, ...) {
    char text[1024], path[GN_KEY_PATH_SIZE], up[GN_KEY_PATH_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    snprintf(path, sizeof path, "%s%s", c->prefix, key);
    if (!*key && *path) path[strlen(path) - 1] = '\0'; /* the element itself */
    snprintf(up, sizeof up, "%s", key);
    const gn_node *node = gn_node_find(c->map, up);
    bool value = node && node->kind != GN_NODE_MAP; /* of a section the key is the place */
    while (!node) {
        char *dot = strrchr(up, '.');
        if (dot) *dot = '\0';
        node = dot ? gn_node_find(c->map, up) : c->map;
    }
    return gn_read_fail(c->reader, node, value ? node->where : node->key_where, path, "%s", text);
}

bool gn_check_given(const check *c, const char *key) {
    return gn_node_find(c->map, key) != NULL;
}

gneiss_status gn_check_keep(const check *c, gneiss_status status) {
    return gn_read_keep(c->reader, status);
}

bool gn_check_sound(const check *c, const char *path) {
    return !gn_problem_near(c->reader->problems, path);
}

bool gn_check_named(const check *c, const char *list) {
    return !gn_problem_names(c->reader->problems, list);
}

bool gn_check_element_sound(const check *c) {
    char path[sizeof c->prefix];
    snprintf(path, sizeof path, "%.*s", (int)strlen(c->prefix) - 1, c->prefix);
    return gn_check_sound(c, path);
}

gneiss_status gn_check_material_name(const check *c, const gn_scene *s, const char *key,
                                     const char *name) {
    char advice[GN_ADVICE_SIZE];
    gn_names names = gn_names_for(name);
    if (!gn_check_named(c, "materials") || gn_scene_find_material(s, name) >= 0) return GNEISS_OK;
    for (size_t k = 0; k < s->material_count; k++) gn_names_add(&names, s->materials[k].name);
    return gn_check_fail(c, key, "expected the name of a material, found '%s'%s", name,
                         gn_names_advice(&names, advice, sizeof advice));
}

/* ---- specimen ---- */

enum { SOURCES_SIZE = 128 };

static void add_source(char sources[SOURCES_SIZE], const char *name) {
    size_t used = strlen(sources);
    snprintf(sources + used, SOURCES_SIZE - used, "%s%s", used ? ", " : "", name);
}

/* Exactly one of them is given; `source` is its name. Sets the kind of the shape. */
static gneiss_status check_source(const check *c, gn_specimen *specimen, int64_t dimension,
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
        if (!key->shape || !gn_check_given(c, path)) continue;
        specimen->pack.shape = key->shape;
        add_source(source, key->name);
    }
    if (*source && !strchr(source, ',')) return GNEISS_OK;
    gn_shape_names(dimension, shapes);
    if (c->reader->specimen_only)
        return gn_check_fail(c, "specimen", "expected one of %s, found %s", shapes,
                             *source ? source : "none");
    return gn_check_fail(c, "specimen",
                         "expected one of file, a list of particles, lattice, %s, found %s", shapes,
                         *source                ? source
                         : specimen->pack.count ? "a number of particles only"
                                                : "none");
}

static bool is_zero(const double v[3]) {
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* What only a shape has a use for. */
static gneiss_status check_no_shape(const check *c, gn_specimen *specimen, int64_t dimension,
                                    const char *source) {
    char shapes[GN_SHAPE_NAMES_SIZE];
    gn_shape_names(dimension, shapes);
    const char *key = c->reader->specimen_only                ? "specimen"
                      : specimen->pack.count                  ? "specimen.particles"
                      : specimen->pack.mean_radius > 0        ? "specimen.mean_radius"
                      : !is_zero(specimen->pack.origin)       ? "specimen.origin"
                      : gn_check_given(c, "specimen.packing") ? "specimen.packing"
                                                              : NULL;
    /* It is not written; a zero with a sign would not come back. */
    if (!key) memset(specimen->pack.origin, 0, sizeof specimen->pack.origin);
    if (!key) return GNEISS_OK;
    if (c->reader->specimen_only)
        return gn_check_fail(c, key, "expected one of %s, found %s", shapes, source);
    return gn_check_fail(c, key, "expected one of %s beside it, found %s", shapes, source);
}

static gneiss_status check_refinement(const check *c, const gn_refinement *r) {
    if (gn_check_given(c, "from") != gn_check_given(c, "to"))
        return gn_check_given(c, "from")
                   ? gn_check_fail(c, "to", "required beside from, but not given")
                   : gn_check_fail(c, "from", "required beside to, but not given");
    if (r->has_region == r->boundary)
        return gn_check_fail(c, "boundary", "expected from and to, or boundary true, found %s",
                             r->boundary ? "both" : "none");
    const double *low = r->lower, *high = r->upper;
    for (int k = 0; k < 3; k++)
        if (low[k] > high[k])
            return gn_check_fail(c, "to", "expected a corner not below from, found %c: %g to %g",
                                 "xyz"[k], low[k], high[k]);
    return GNEISS_OK;
}

/* Particles come by their number or their size, or from the nodes of a mesh. */
static gneiss_status check_amount(const check *c, const gn_pack_def *pack, const char *shape) {
    const char *key = pack->count ? "specimen.particles" : "specimen.mean_radius";
    bool some = pack->count || pack->mean_radius > 0;
    if (pack->start == GN_START_NODES) {
        if (pack->shape != GN_SHAPE_MESH)
            return gn_check_fail(c, "specimen.packing.start",
                                 "expected mesh beside nodes, found %s", shape);
        if (!some) return GNEISS_OK;
        return gn_check_fail(
            c, key,
            "expected to be left out beside packing.start nodes (each inner node of the "
            "mesh becomes a particle), found it given");
    }
    if (!some)
        return gn_check_fail(c, "specimen",
                             "expected particles (how many) or mean_radius beside %s, found none",
                             shape);
    if (pack->count && pack->mean_radius > 0)
        return gn_check_fail(c, "specimen.mean_radius",
                             "expected particles or mean_radius, found both");
    return GNEISS_OK;
}

static gneiss_status check_pack(const check *c, const gn_pack_def *pack, const char *shape) {
    bool fixed = pack->shape == GN_SHAPE_POLYGON || pack->shape == GN_SHAPE_SURFACE ||
                 pack->shape == GN_SHAPE_MESH;
    if (fixed && !is_zero(pack->origin))
        return gn_check_fail(c, "specimen.origin",
                             "expected rectangle, disc, box or cylinder beside it, found %s",
                             shape);
    GN_TRY(check_amount(c, pack, shape));
    GN_TRY(gn_check_sieve(c, "specimen.packing.", pack->sizes == GN_SIZES_SIEVE, pack->sieve,
                          pack->sieve_count));
    if (pack->sizes == GN_SIZES_SIEVE && gn_check_given(c, "specimen.packing.size_ratio"))
        return gn_check_fail(c, "specimen.packing.size_ratio",
                             "expected sizes: fitted, uniform or normal beside it, found sieve, "
                             "whose first row has the smallest size");
    if (pack->size_variation >= 0 &&
        (pack->sizes == GN_SIZES_UNIFORM || pack->sizes == GN_SIZES_SIEVE))
        return gn_check_fail(c, "specimen.packing.size_variation",
                             "expected sizes: fitted or normal beside it, found %s, which has its "
                             "own",
                             pack->sizes == GN_SIZES_UNIFORM ? "uniform" : "sieve");
    if (pack->overlap == GN_OVERLAP_NONE && pack->overlap_size >= 0)
        return gn_check_fail(c, "specimen.packing.overlap_size",
                             "expected overlap passive beside it, found none");
    for (size_t k = 0; k < pack->refinement_count; k++) {
        check element = gn_check_element(c->reader, c->map, "specimen.packing.refine", k);
        GN_TRY(check_refinement(&element, &pack->refinements[k]));
    }
    return GNEISS_OK;
}

/* Cuts the body to the region; what is in it already stays as it is to the bit, so that a scene
 * that was written is read as it was. */
static gneiss_status clip(const check *c, gn_pack_def *pack, int dimension, const char *shape) {
    const double *low = pack->region_min, *high = pack->region_max;
    if (!pack->has_region) return GNEISS_OK;
    if (pack->shape != GN_SHAPE_RECTANGLE && pack->shape != GN_SHAPE_BOX)
        return gn_check_fail(c, "specimen.packing.region",
                             "expected a rectangle or box beside it, of which it is a part, found "
                             "%s (pack a smaller body instead)",
                             shape);
    for (int a = 0; a < dimension; a++) {
        const double upper = pack->origin[a] + pack->size[a], rounding = 1e-12 * pack->size[a];
        if (!(low[a] < high[a]) || !(fmax(low[a], pack->origin[a]) < fmin(high[a], upper)))
            return gn_check_fail(c, "specimen.packing.region",
                                 "expected a box that has a part of the body, %c from %g to %g m, "
                                 "found %g to %g m",
                                 "xyz"[a], pack -> origin[a], upper, low[a], high[a]);
        const bool below = low[a] > pack->origin[a] + rounding, above = high[a] < upper - rounding;
        if (below) pack->origin[a] = low[a];
        if (below || above) pack->size[a] = (above ? high[a] : upper) - pack->origin[a];
    }
    return GNEISS_OK;
}

/* It is of lengths in files. */
static gneiss_status check_scale(const check *c, const gn_specimen *specimen, const char *source) {
    const gn_shape_kind shape = specimen->pack.shape;
    if (specimen->scale == 1.0 || *specimen->file || shape == GN_SHAPE_SURFACE ||
        shape == GN_SHAPE_MESH)
        return GNEISS_OK;
    return gn_check_fail(c, "specimen.scale",
                         "expected file, surface or mesh beside it, whose lengths it is of, found "
                         "%s",
                         source);
}

static gneiss_status check_particles(const check *c, gn_scene *s) {
    gn_specimen *specimen = &s->specimen;
    char source[SOURCES_SIZE];
    GN_TRY(check_source(c, specimen, s->dimension, source));
    GN_TRY(check_scale(c, specimen, source));
    if (specimen->pack.shape == GN_SHAPE_NONE)
        GN_TRY(check_no_shape(c, specimen, s->dimension, source));
    else
        GN_TRY(check_pack(c, &specimen->pack, source));
    GN_TRY(clip(c, &specimen->pack, (int)s->dimension, source));
    bool plane = specimen->lattice.kind == GN_LATTICE_SQUARE ||
                 specimen->lattice.kind == GN_LATTICE_HEXAGONAL;
    if (specimen->lattice.kind != GN_LATTICE_NONE && plane != (s->dimension == 2))
        return gn_check_fail(c, "specimen.lattice.kind", "expected a lattice of a %dD scene: %s",
                             (int)s->dimension,
                             s->dimension == 2 ? "square, hexagonal" : "cubic, fcc, hcp");
    if (specimen->porosity >= 0 && specimen->density_basis != GN_DENSITY_BULK)
        return gn_check_fail(c, "specimen.porosity",
                             "expected density_basis bulk beside it, found particle");
    return GNEISS_OK;
}

static gneiss_status not_given(const check *c, const char *key) {
    return gn_check_fail(c, key, "required, but not given");
}

static gneiss_status check_specimen(const check *c, gn_scene *s) {
    gn_specimen *specimen = &s->specimen;
    if (!s->has_specimen)
        return gn_check_fail(c, "specimen",
                             "required, but not given; expected a specimen, sources, "
                             "elements or several of them");
    if (!s->material_count && gn_check_sound(c, "materials"))
        GN_TRY(gn_check_keep(c, not_given(c, "materials")));
    if (!s->has_law && gn_check_sound(c, "law")) GN_TRY(gn_check_keep(c, not_given(c, "law")));
    if (!s->specimen_given) return GNEISS_OK; /* sources bring all */
    GN_TRY(gn_check_keep(c, check_particles(c, s)));
    if (!*specimen->material && s->material_count == 1)
        memcpy(specimen->material, s->materials[0].name, sizeof specimen->material);
    return gn_check_material_name(c, s, "specimen.material", specimen->material);
}

gneiss_status gn_check_shape(gn_reader *reader, const gn_node *root) {
    check c = {.reader = reader, .map = root};
    if (!gn_check_sound(&c, "specimen")) return GNEISS_OK;
    reader->scene->has_specimen = reader->scene->specimen_given;
    return gn_check_keep(&c, reader->scene->has_specimen ? check_particles(&c, reader->scene)
                                                         : not_given(&c, "specimen"));
}

/* ---- materials and bonds ---- */

gneiss_status gn_check_need(const check *c, double value, const char *key, const char *reason) {
    if (value > 0) return GNEISS_OK;
    return gn_check_fail(c, key, "required %s, but not given", reason);
}

/* What resists rolling is as stiff as the tangential spring lets it be. */
static gneiss_status check_rolls(const check *c, const gn_material *m, bool area) {
    bool rolls = m->rolling_friction > 0 || m->twisting_friction > 0;
    if (!rolls || (area ? m->beta : m->kratio) != 0) return GNEISS_OK;
    return gn_check_fail(c, m->rolling_friction > 0 ? "rolling_friction" : "twisting_friction",
                         "expected %s above 0 beside it, which its stiffness follows from, found 0",
                         area ? "beta" : "kratio");
}

static gneiss_status check_law_values(const check *c, const gn_scene *s, const gn_material *m) {
    bool bonds = s->bonds == GN_SWITCH_ON, area = gn_scene_by_area(s);
    if (m->kratio > 0 && m->kratio < 1e-6)
        return gn_check_fail(
            c, "kratio", "expected 0 (no tangential spring) or at least 1e-6, found %g", m->kratio);
    if (gn_scene_hertz(s)) return gn_check_hertz_material(c, m);
    if (m->restitution >= 0)
        return gn_check_fail(c, "restitution",
                             "expected law.stiffness hertz beside it, found another (all others "
                             "have damping.contact.restitution)");
    if (!area) GN_TRY(gn_check_need(c, m->kratio + 1.0, "kratio", "by this law.stiffness"));
    GN_TRY(check_rolls(c, m, area));
    GN_TRY(gn_check_grip(c, s, m));
    if (bonds) GN_TRY(gn_check_bonds_of(c, s, m));
    if (s->stiffness == GN_STIFFNESS_UNIFORM) {
        GN_TRY(gn_check_need(c, m->normal_stiffness, "normal_stiffness", "by the uniform law"));
        if (!bonds) return GNEISS_OK;
        GN_TRY(gn_check_need(c, m->bond_tension_limit, "bond_tension_limit",
                             "by bonds of the uniform law"));
        return gn_check_need(c, m->bond_shear_limit, "bond_shear_limit",
                             "by bonds of the uniform law");
    }
    if (area) GN_TRY(gn_check_need(c, m->young, "young", "by laws by area"));
    if (area) GN_TRY(gn_check_need(c, m->poisson + 1.0, "poisson", "by laws by area"));
    if (!area)
        GN_TRY(gn_check_need(c, m->contact_modulus, "contact_modulus", "by this law.stiffness"));
    if (!bonds) return GNEISS_OK;
    GN_TRY(gn_check_need(c, m->tensile_strength, "tensile_strength",
                         "by bonds of this law.stiffness"));
    return gn_check_need(c, m->shear_strength, "shear_strength", "by bonds of this law.stiffness");
}

static gneiss_status check_material(const check *c, const gn_scene *s, size_t index) {
    const gn_material *m = &s->materials[index];
    if (gn_scene_find_material(s, m->name) != (int)index)
        return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                             m->name);
    GN_TRY(gn_check_scatter(c, "strength_scatter", &m->strength_scatter));
    GN_TRY(gn_check_scatter(c, "stiffness_scatter", &m->stiffness_scatter));
    return check_law_values(c, s, m);
}

/* ---- damping ---- */

/* A rate or a fraction, as the model has it. */
static gneiss_status check_background(const check *c, const gn_scene *s, const char *key,
                                      double a) {
    double value;
    const gn_node *node = gn_node_find(c->map, key);
    if (node && s->background != GN_BACKGROUND_NONE && a >= 0) {
        const char *unit = s->background == GN_BACKGROUND_VISCOUS ? "1/s" : "1";
        char reason[96];
        if (!gn_units_read(c->reader->units, node->text, unit, &value, reason, sizeof reason))
            return gn_check_fail(c, key, "expected %s for this model, found '%.60s'%s",
                                 gn_unit_text(unit), node->text, reason);
    }
    if (s->background > GN_BACKGROUND_VISCOUS && a >= 1)
        return gn_check_fail(c, key, "expected a fraction in [0, 1), found %g", a);
    return GNEISS_OK;
}

static gneiss_status check_damping(const check *c, const gn_scene *s) {
    const char *key = "damping.background.coefficient", *spin = "damping.background.rotation";
    if (s->background == GN_BACKGROUND_NONE && s->background_coefficient > 0)
        return gn_check_fail(c, key, "expected a model beside it, found none");
    if (s->background == GN_BACKGROUND_NONE && s->background_spin > 0)
        return gn_check_fail(c, spin, "expected a model beside it, found none");
    if (s->background != GN_BACKGROUND_NONE && !gn_check_given(c, key))
        return gn_check_fail(c, key, "required by the model, but not given");
    GN_TRY(check_background(c, s, key, s->background_coefficient));
    GN_TRY(check_background(c, s, spin, s->background_spin));
    if (s->background_spin >= 0 && s->rotation == GN_SWITCH_OFF)
        return gn_check_fail(c, spin, "expected law.rotation on beside it, found off");
    if (s->background != GN_BACKGROUND_NONVISCOUS_COMPONENT &&
        s->background_velocity == GN_VELOCITY_INSTANT)
        return gn_check_fail(c, "damping.background.velocity",
                             "instant needs the model nonviscous_component, found another one");
    if (s->restitution >= 0 && s->damping_fraction > 0)
        return gn_check_fail(c, "damping.contact.fraction",
                             "expected restitution or fraction, found both");
    return GNEISS_OK;
}

/* ---- boxes ---- */

gneiss_status gn_check_box(const check *c, const gn_scene *s, const char *key, const double *low,
                           const double *high) {
    for (int64_t k = 0; k < s->dimension; k++)
        if (!(low[k] < high[k]))
            return gn_check_fail(
                c, key, "expected a corner above min in every direction, found %c: %g to %g",
                "xyz"[k], low[k], high[k]);
    return GNEISS_OK;
}

static gneiss_status check_surroundings(const check *c, const gn_scene *s) {
    GN_TRY(gn_check_box_sides(c, s));
    if (!s->has_domain) return GNEISS_OK;
    if (!gn_check_given(c, "domain.min"))
        return gn_check_fail(c, "domain.min", "required beside max, but not given");
    if (!gn_check_given(c, "domain.max"))
        return gn_check_fail(c, "domain.max", "required beside min, but not given");
    return gn_check_box(c, s, "domain.max", s->domain_min, s->domain_max);
}

/* ---- sets and walls ---- */

gneiss_status gn_check_plane_motion(const check *c, const gn_scene *s, const gn_motion *motion) {
    if (s->dimension != 2) return GNEISS_OK;
    const char *key = motion->velocity[2].count ? "motion.vz"
                      : motion->spin[0].count   ? "motion.wx"
                      : motion->spin[1].count   ? "motion.wy"
                                                : NULL;
    if (!key) return GNEISS_OK;
    return gn_check_fail(
        c, key, "expected nothing out of the plane of a 2D scene: only vx, vy and wz move");
}

static gneiss_status check_spin(const check *c, const gn_scene *s, const gn_set_def *set) {
    if (s->rotation != GN_SWITCH_OFF) return GNEISS_OK;
    static const char *const keys[] = {"motion.wx", "motion.wy", "motion.wz"};
    for (int k = 0; k < 3; k++)
        if (set->motion.spin[k].count)
            return gn_check_fail(c, keys[k], "expected law.rotation on beside a spin, found off");
    if (set->has_initial_spin)
        return gn_check_fail(c, "initial_spin",
                             "expected law.rotation on beside a spin, found off");
    return GNEISS_OK;
}

/* What is prescribed from the start has no other velocity there. */
static gneiss_status check_start(const check *c, const gn_table given[3], const double start[3],
                                 const char *key, const char *axis) {
    for (int a = 0; a < 3; a++) {
        double first = given[a].count ? gn_table_at(&given[a], 0.0) : start[a];
        if (start[a] != 0.0 && start[a] != first)
            return gn_check_fail(c, key,
                                 "expected 0 or the prescribed %g in the component that "
                                 "motion.%s%c gives, found %g",
                                 first, axis, "xyz"[a], start[a]);
    }
    return GNEISS_OK;
}

static gneiss_status check_set(const check *c, const gn_scene *s, size_t index) {
    const gn_set_def *set = &s->sets[index];
    if (gn_scene_find_set(s, set->name) != (int)index || gn_scene_find_wall(s, set->name) >= 0)
        return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                             set->name);
    if (!set->all && !set->has_box && !set->id_count && set->end_axis < 0)
        return gn_check_fail(c, "select", "expected all, box, ids or end, found none");
    if (set->has_box) GN_TRY(gn_check_box(c, s, "select.box.max", set->box_min, set->box_max));
    if (set->end_axis >= s->dimension)
        return gn_check_fail(c, "select.end.axis", "expected x or y in a 2D scene, found z");
    if (*set->material) GN_TRY(gn_check_material_name(c, s, "material", set->material));
    if (gn_check_sound(c, "law.rotation")) GN_TRY(check_spin(c, s, set));
    GN_TRY(check_start(c, set->motion.velocity, set->initial_velocity, "initial_velocity", "v"));
    GN_TRY(check_start(c, set->motion.spin, set->initial_spin, "initial_spin", "w"));
    return gn_check_plane_motion(c, s, &set->motion);
}

/* A unit vector stays as it is, so that a scene written out and read again keeps every bit. */
bool gn_check_direction(double v[3]) {
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0)) return false;
    double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (fabs(square - 1) <= 8 * DBL_EPSILON) return true;
    /* A power of two near the largest component rounds nothing and keeps squares from overflowing.
     */
    int exponent;
    frexp(largest, &exponent);
    for (int k = 0; k < 3; k++) v[k] = ldexp(v[k], -exponent);
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) v[k] /= length;
    return true;
}

static bool moves(const gn_motion *motion) {
    return motion->velocity[0].count || motion->velocity[1].count || motion->velocity[2].count;
}

static gneiss_status check_wall(const check *c, const gn_scene *s, size_t index) {
    gn_wall_def *wall = &s->walls[index];
    if (gn_scene_find_wall(s, wall->name) != (int)index)
        return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                             wall->name);
    if (!gn_check_direction(wall->normal))
        return gn_check_fail(c, "normal", "expected a direction, found [0, 0, 0]");
    GN_TRY(gn_check_side(c, s, "",
                         (gn_side_keys){wall->stiffness, wall->kratio, wall->friction,
                                        wall->rolling_friction, wall->twisting_friction,
                                        wall->material, false}));
    if (wall->servo.active && moves(&wall->motion))
        return gn_check_fail(c, "servo", "expected motion or servo, found both");
    return gn_check_plane_motion(c, s, &wall->motion);
}

static gneiss_status check_servo(const check *c, const gn_scene *s, size_t index) {
    const gn_servo *servo = &s->walls[index].servo;
    gn_facing facing;
    if (!servo->active) return GNEISS_OK;
    if (!servo->force.count == !servo->stress.count)
        return gn_check_fail(c, "servo", "expected force or stress, found %s",
                             servo->force.count ? "both" : "none");
    if (servo->area > 0 && servo->force.count)
        return gn_check_fail(c, "servo.area", "expected stress beside it, found force");
    if (servo->force.count || servo->area > 0 || gn_wall_closes_box(s, index) ||
        gn_facing_find(s, index, &facing))
        return GNEISS_OK;
    return gn_check_fail(c, "servo.area",
                         "required beside stress without %s that face each other across this one, "
                         "but not given",
                         s->dimension == 2 ? "two walls" : "two pairs of walls");
}

/* What only particles have a use for. */
static gneiss_status check_no_specimen(const check *c, const gn_scene *s) {
    const struct {
        bool found;
        const char *key;
    } keys[] = {{s->material_count > 0, "materials"},
                {s->contact_count > 0, "contacts"},
                {s->has_law, "law"},
                {s->bonds == GN_SWITCH_ON, "bonds"},
                {s->set_count > 0, "sets"},
                {s->wall_count > 0, "walls"},
                {s->has_periodic, "periodic"},
                {s->has_domain, "domain"},
                {s->random_velocity > 0, "initial.random_velocity"}};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (keys[k].found)
            return gn_check_fail(c, keys[k].key,
                                 "expected a specimen beside it, found elements only (their "
                                 "materials, motions and loads stand under elements)");
    return GNEISS_OK;
}

/* Element by element. */
typedef gneiss_status check_one(const check *c, const gn_scene *s, size_t index);

static gneiss_status check_list(const check *c, const char *list, size_t count, check_one *one) {
    for (size_t k = 0; k < count; k++) {
        check element = gn_check_element(c->reader, c->map, list, k);
        if (!gn_check_element_sound(&element)) continue;
        GN_TRY(gn_check_keep(c, one(&element, c->reader->scene, k)));
    }
    return GNEISS_OK;
}

static gneiss_status check_matter(const check *c, gn_scene *s) {
    if (!gn_check_sound(c, "specimen") || !gn_check_sound(c, "elements")) return GNEISS_OK;
    if (s->has_specimen || !s->has_elements) return gn_check_keep(c, check_specimen(c, s));
    return gn_check_keep(c, check_no_specimen(c, s));
}

static gneiss_status check_from(const check *c, const gn_scene *s) {
    if (!s->specimen.from_bonds) return GNEISS_OK;
    if (!s->specimen.from[0])
        return gn_check_fail(c, "specimen.from_bonds",
                             "expected none without another run that it comes from, found keep");
    if (s->bonds == GN_SWITCH_ON || s->stage_count) return GNEISS_OK; /* check_stages.c */
    return gn_check_fail(
        c, "specimen.from_bonds",
        "expected the section bonds beside keep, which says how they behave, found "
        "none");
}

gneiss_status gn_check_scene(gn_reader *reader, const gn_node *root) {
    gn_scene *s = reader->scene;
    check c = {.reader = reader, .map = root};
    if (!gn_check_sound(&c, "dimension")) return GNEISS_OK;
    s->has_specimen = s->specimen_given || s->source_count > 0;
    if (s->bonds == GN_SWITCH_AUTO)
        s->bonds = gn_check_given(&c, "bonds") ? GN_SWITCH_ON : GN_SWITCH_OFF;
    /* Who says something of the end says all of it, also if it is lifted later; auto, too. */
    if (s->stop_peak_drop < 0 && (s->stop_strain > 0 || s->stop_unbalanced > 0) &&
        !gn_check_given(&c, "time.stop.peak_drop"))
        s->stop_peak_drop = 0;
    GN_TRY(check_matter(&c, s));
    GN_TRY(gn_check_keep(&c, check_from(&c, s)));
    if (s->has_elements) GN_TRY(gn_check_elements(reader, root));
    GN_TRY(gn_check_couple(reader, root));
    if (s->has_specimen && gn_check_sound(&c, "law.stiffness"))
        GN_TRY(check_list(&c, "materials", s->material_count, check_material));
    if (s->has_specimen && gn_check_sound(&c, "law"))
        GN_TRY(gn_check_keep(&c, gn_check_gamma(&c, s)));
    GN_TRY(check_list(&c, "contacts", s->contact_count, gn_check_contact));
    if (gn_check_sound(&c, "bonds") && gn_check_sound(&c, "law"))
        GN_TRY(gn_check_keep(&c, gn_check_hertz(&c, s)));
    if (gn_check_sound(&c, "bonds") && gn_check_sound(&c, "law"))
        GN_TRY(gn_check_keep(&c, gn_check_moments(&c, s)));
    if (gn_check_sound(&c, "law") && gn_check_sound(&c, "materials"))
        GN_TRY(gn_check_keep(&c, gn_check_coupling(&c, s)));
    if (gn_check_sound(&c, "damping")) GN_TRY(gn_check_keep(&c, check_damping(&c, s)));
    if (gn_check_sound(&c, "periodic") && gn_check_sound(&c, "domain"))
        GN_TRY(gn_check_keep(&c, check_surroundings(&c, s)));
    GN_TRY(check_list(&c, "sets", s->set_count, check_set));
    GN_TRY(check_list(&c, "walls", s->wall_count, check_wall));
    if (gn_check_sound(&c, "walls")) GN_TRY(check_list(&c, "walls", s->wall_count, check_servo));
    GN_TRY(gn_check_bodies(reader, root));
    GN_TRY(gn_check_flow(reader, root));
    if (gn_check_sound(&c, "membrane") && gn_check_sound(&c, "test") &&
        gn_check_sound(&c, "specimen"))
        GN_TRY(gn_check_keep(&c, gn_check_membrane(&c, s)));
    if (gn_check_sound(&c, "test") && gn_check_sound(&c, "time.stop"))
        GN_TRY(gn_check_keep(&c, gn_check_test(&c, s)));
    if (gn_check_sound(&c, "output")) GN_TRY(gn_check_keep(&c, gn_check_output(&c, s)));
    if (gn_check_sound(&c, "time")) GN_TRY(gn_check_time(&c, s));
    if (!reader->problems->count) gn_note_idle_keys(reader, root);
    return GNEISS_OK;
}
