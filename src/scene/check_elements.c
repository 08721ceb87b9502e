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
            return gn_check_needs(section, "elements.beam.notch_width", "none", "notch_depth");
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
        return gn_check_needs(section, "elements.scale", "none", "a mesh file");
    if (elements->has_beam) return check_beam(section, scene);
    return elements->mesh[0] ? GNEISS_OK
                             : check_block(section, scene, elements->has_box ? "box" : "rectangle");
}

/* ---- materials, motions, loads ---- */

static gneiss_status check_poisson(const check *section, const gn_scene *scene, size_t index) {
    const gn_element_material *material = &scene->elements.materials[index];
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
    GN_TRY(gn_check_name(section,
                         gn_scene_find_element_motion(scene, motion->name) != (int)index ||
                             gn_scene_find_set(scene, motion->name) >= 0 ||
                             gn_scene_find_wall(scene, motion->name) >= 0 ||
                             gn_scene_find_body(scene, motion->name) >= 0,
                         motion->name));
    GN_TRY(check_region(section, scene, &motion->region));
    return gn_check_plane_motion(section, scene, &motion->motion);
}

static gneiss_status check_load(const check *section, const gn_scene *scene, size_t index) {
    const gn_element_load *load = &scene->elements.loads[index];
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
        return gn_check_needs(section, "elements.contact", "one", "a scene without a periodic box");
    return GNEISS_OK;
}

gneiss_status gn_check_elements(const gn_reader *reader, const gn_node *root) {
    const gn_scene *scene = reader->scene;
    const gn_element_def *elements = &scene->elements;
    check c = {.reader = reader, .map = root};
    if (gn_check_is_valid(&c, "elements"))
        GN_TRY(gn_check_keep_problem(&c, check_whole(&c, scene)));
    GN_TRY(gn_check_list(&c, "elements.materials", elements->material_count, check_poisson));
    GN_TRY(gn_check_list(&c, "elements.motions", elements->motion_count, check_motion));
    return gn_check_list(&c, "elements.loads", elements->load_count, check_load);
}

/* ---- cross-key checks of `couple` ---- */

static gneiss_status check_edges(const check *section, const gn_scene *scene, size_t index) {
    const gn_couple_zone *zone = &scene->couple.zones[index];
    if (!zone->edge_count)
        return gn_check_fail(section, "edges", "expected at least one, found none");
    for (size_t e = 0; e < zone->edge_count; e++) {
        double width2 = 0.0;
        char key[32];
        for (int a = 0; a < (int)scene->dimension; a++) {
            double d = zone->edges[e].to[a] - zone->edges[e].from[a];
            width2 += d * d;
        }
        snprintf(key, sizeof key, "edges[%zu].to", e);
        if (!gn_range_holds(GN_LENGTHS, sqrt(width2)))
            return gn_check_fail(section, key, "expected a point %s m from `from`, found %g m",
                                 GN_LENGTHS, sqrt(width2));
    }
    return GNEISS_OK;
}

static bool same_edges(const gn_scene *scene, const gn_couple_zone *first,
                       const gn_couple_zone *second) {
    bool same = first->edge_count == second->edge_count;
    for (size_t e = 0; same && e < first->edge_count; e++)
        for (int k = 0; k < (int)scene->dimension; k++)
            same = same && first->edges[e].from[k] == second->edges[e].from[k] &&
                   first->edges[e].to[k] == second->edges[e].to[k];
    return same;
}

/* Refuses a zone that is given twice: the second changes nothing and is a mistake. */
static gneiss_status check_other(const check *section, const gn_scene *scene, size_t index) {
    for (size_t k = 0; k < index; k++)
        if (same_edges(scene, &scene->couple.zones[k], &scene->couple.zones[index]))
            return gn_check_fail(section, "edges",
                                 "expected edges of no other zone, found those of "
                                 "couple.zones[%zu]",
                                 k);
    return GNEISS_OK;
}

static gneiss_status check_zone(const check *section, const gn_scene *scene, size_t index) {
    GN_TRY(gn_check_keep_problem(section, check_edges(section, scene, index)));
    return check_other(section, scene, index);
}

/* Refuses keys that cannot be combined with coupling zones. */
static gneiss_status check_beside(const check *section, const gn_scene *scene) {
    if (!scene->has_specimen || !scene->has_elements)
        return gn_check_needs(section, "couple",
                              scene->has_elements ? "elements only" : "a specimen only",
                              "a specimen and elements");
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->elements.has_contact, "elements.contact"},
                  {scene->has_periodic, "periodic box"},
                  {scene->has_mass_scaling, "time.mass_scaling"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_needs(section, "couple", "one", "a scene without %s", others[k].what);
    return GNEISS_OK;
}

/* ---- initial wave ---- */

static gneiss_status check_pulse(const check *section, const gn_scene *scene) {
    double size2 = 0.0;
    for (int a = 0; a < (int)scene->dimension; a++)
        size2 += scene->pulse.direction[a] * scene->pulse.direction[a];
    if (!(size2 > 0.0))
        return gn_check_fail(section, "initial.pulse.direction",
                             "expected a direction, found none");
    return GNEISS_OK;
}

/* Checks the constraint of zones. Springs of zones act on positions, not on spins. Consistent
 * masses exclude non-viscous damping, which acts on the resultant at each mass separately. */
static gneiss_status check_constraint(const check *section, const gn_scene *scene) {
    if (scene->couple.constraint == GN_COUPLE_CONSISTENT &&
        scene->background != GN_BACKGROUND_NONE && scene->background != GN_BACKGROUND_VISCOUS &&
        gn_check_is_valid(section, "damping"))
        return gn_check_fail(section, "couple.constraint",
                             "expected lumped or penalty beside background damping that is not "
                             "viscous, found consistent");
    /* Scenes that were written contain all keys, so that keys at their default are accepted. */
    const char *springs = scene->couple.penalty != 1.0           ? "couple.penalty"
                          : scene->couple.penalty_damping != 0.0 ? "couple.penalty_damping"
                                                                 : NULL;
    if (springs && scene->couple.constraint != GN_COUPLE_PENALTY)
        return gn_check_needs(section, springs,
                              scene->couple.constraint == GN_COUPLE_LUMPED ? "lumped"
                                                                           : "consistent",
                              "constraint: penalty");
    if (scene->couple.constraint != GN_COUPLE_PENALTY || scene->couple.spins == GN_COUPLE_FREE)
        return GNEISS_OK;
    return gn_check_fail(section, "couple.spins", "expected free beside penalty, found slaved");
}

/* ---- conversion ---- */

/* Checks a set in a scene with conversion. Sets that are only observed, such as the sides of a
 * notch's mouth, have no effect on dormant particles. */
static gneiss_status check_convert_set(const check *section, const gn_set_def *set) {
    bool moves = false;
    for (int a = 0; a < 3; a++)
        moves = moves || set->motion.velocity[a].count || set->motion.spin[a].count;
    const struct {
        bool found;
        const char *key, *instead;
    } acts[] = {{moves, "motion", "elements.motions"},
                {set->has_force, "force", "elements.loads"},
                {set->has_initial_velocity, "initial_velocity", NULL},
                {set->has_initial_spin, "initial_spin", NULL}};
    for (size_t k = 0; k < sizeof acts / sizeof *acts; k++) {
        if (!acts[k].found) continue;
        return acts[k].instead
                   ? gn_check_fail(
                         section, acts[k].key,
                         "expected no sets with motion or force beside couple.convert, as dormant "
                         "particles follow the elements (use %s), found set '%s'",
                         acts[k].instead, set->name)
                   : gn_check_fail(
                         section, acts[k].key,
                         "expected none beside couple.convert, as released particles take the "
                         "velocity of their elements, which start at rest, found that of set '%s'",
                         set->name);
    }
    return GNEISS_OK;
}

/* Checks walls in a scene with conversion: elements do not press on walls, so that walls only stop
 * debris. */
static gneiss_status check_convert_walls(const check *section, const gn_scene *scene) {
    const gn_test_end *ends[] = {&scene->test.lower, &scene->test.upper};
    for (size_t k = 0; k < scene->wall_count; k++)
        if (scene->walls[k].servo.active)
            return gn_check_fail(section, "walls",
                                 "expected no servo of walls beside couple.convert, as elements do "
                                 "not press on them, found that of '%s'",
                                 scene->walls[k].name);
    for (size_t e = 0; gn_scene_tested(scene) && e < 2; e++)
        for (size_t k = 0; k < ends[e]->count; k++)
            if (gn_scene_find_wall(scene, ends[e]->name[k]) >= 0)
                return gn_check_fail(section, e ? "test.upper" : "test.lower",
                                     "expected motions of elements beside couple.convert, as "
                                     "elements do not press on walls, found wall '%s'",
                                     ends[e]->name[k]);
    return GNEISS_OK;
}

/* Refuses keys that cannot be combined with conversion, with a message at the key. */
static gneiss_status check_convert_beside(const check *section, const gn_scene *scene,
                                          const gn_node *root) {
    const struct {
        bool found;
        const char *key, *expected, *instead;
    } others[] = {{scene->couple.zone_count > 0, "couple.zones", "no couple.zones", "some"},
                  {scene->couple.constraint != GN_COUPLE_LUMPED, "couple.constraint",
                   "no couple.constraint but lumped",
                   scene->couple.constraint == GN_COUPLE_PENALTY ? "penalty" : "consistent"},
                  {scene->body_count > 0 && !(scene->couple.convert.near_bodies > 0.0), "bodies",
                   "no bodies, or couple.convert.bodies", "bodies without it"},
                  {!scene->body_count && scene->couple.convert.near_bodies > 0.0,
                   "couple.convert.bodies", "bodies", "none"},
                  {scene->has_membrane, "membrane", "no membrane", "one"},
                  {scene->has_pulse, "initial.pulse", "no initial.pulse", "one"},
                  {scene->random_velocity > 0.0, "initial.random_velocity",
                   "no initial.random_velocity", "some"},
                  {scene->elements.formulation == GN_FORMULATION_PRESSURE, "elements.formulation",
                   "no mixed form", "mixed"},
                  {scene->bonds == GN_SWITCH_OFF, "bonds", "bonds that are on", "off"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, others[k].key,
                                 "expected %s beside couple.convert, found %s", others[k].expected,
                                 others[k].instead);
    GN_TRY(check_convert_walls(section, scene));
    for (size_t k = 0; k < scene->set_count; k++) {
        const check element = gn_check_element(section->reader, root, "sets", k);
        if (gn_check_element_is_valid(&element))
            GN_TRY(check_convert_set(&element, &scene->sets[k]));
    }
    return GNEISS_OK;
}

/* Sets the box of conversion; by default it is the packed region, extended by the rounding of nodes
 * on its sides. */
static gneiss_status set_box(const check *section, gn_scene *scene) {
    gn_convert_def *q = &scene->couple.convert;
    const gn_pack_def *pack = &scene->specimen.pack;
    if (q->has_box) return GNEISS_OK;
    if (!pack->has_region)
        return gn_check_fail(section, "couple.convert.box",
                             "required where no specimen.packing.region is given, not given");
    for (int a = 0; a < (int)scene->dimension; a++) {
        const double low = pack->region_min[a], high = pack->region_max[a];
        const double rounding = 1e-12 * fmax(fabs(low), fabs(high));
        q->box_min[a] = low - rounding;
        q->box_max[a] = high + rounding;
    }
    q->has_box = true;
    return GNEISS_OK;
}

static gneiss_status check_convert(const check *section, gn_scene *scene, const gn_node *root) {
    const gn_convert_def *q = &scene->couple.convert;
    GN_TRY(check_convert_beside(section, scene, root));
    GN_TRY(set_box(section, scene));
    if (!(q->stress > 0.0) && !q->has_mohr && !(q->near_bodies > 0.0))
        return gn_check_fail(section, "couple.convert",
                             "expected a limit, stress or mohr_coulomb, found none");
    return gn_check_box(section, scene, "couple.convert.box.max", q->box_min, q->box_max);
}

gneiss_status gn_check_couple(const gn_reader *reader, const gn_node *root) {
    gn_scene *scene = reader->scene;
    check c = {.reader = reader, .map = root};
    if (scene->has_pulse && gn_check_is_valid(&c, "initial.pulse"))
        GN_TRY(gn_check_keep_problem(&c, check_pulse(&c, scene)));
    if (!scene->has_couple) return GNEISS_OK;
    GN_TRY(gn_check_keep_problem(&c, check_beside(&c, scene)));
    if (gn_check_is_valid(&c, "couple"))
        GN_TRY(gn_check_keep_problem(&c, check_constraint(&c, scene)));
    if (scene->couple.has_convert && gn_check_is_valid(&c, "couple"))
        GN_TRY(gn_check_keep_problem(&c, check_convert(&c, scene, root)));
    if (!scene->couple.zone_count && !scene->couple.has_convert)
        return gn_check_fail(&c, "couple.zones", "expected at least one, found none");
    return gn_check_list(&c, "couple.zones", scene->couple.zone_count, check_zone);
}
