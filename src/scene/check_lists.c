/* Cross-key checks of `sources` and `sinks`. */
#include "scene/check.h"

#include "base/asked.h"
#include "base/names.h"

#include <math.h>
#include <string.h>

/* Returns the key of the last given shape, "" if there is none. */
static const char *region_key(const gn_flow_region *region) {
    return region->has_cylinder   ? "cylinder"
           : region->has_box      ? "box"
           : region->corner_count ? "polygon"
           : region->has_disc     ? "disc"
                                  : (region->has_rectangle ? "rectangle" : "");
}

/* Checks that exactly one shape is given; for a sink, exactly one shape or a plane. */
static gneiss_status check_region(const check *section, const gn_scene *scene,
                                  const gn_flow_region *region, const gn_sink_def *sink) {
    static const char *const names[] = {"plane", "rectangle", "disc", "polygon", "box", "cylinder"};
    const bool plane = sink && sink->has_plane;
    const bool has[] = {
        plane,           region->has_rectangle, region->has_disc, region->corner_count > 0,
        region->has_box, region->has_cylinder};
    char found[80] = "";
    for (int k = 0; k < 6; k++) {
        size_t used = strlen(found);
        if (has[k]) snprintf(found + used, sizeof found - used, "%s%s", used ? ", " : "", names[k]);
    }
    bool moved = region->origin[0] != 0 || region->origin[1] != 0 || region->origin[2] != 0;
    if (!*found || strchr(found, ','))
        return gn_check_fail(section, region_key(region), "expected one of %s%s in it, found %s",
                             sink ? "plane, " : "",
                             scene->dimension == 2 ? "rectangle, disc, polygon" : "box, cylinder",
                             *found ? found : "none");
    if (moved && (plane || region->corner_count))
        return gn_check_needs(section, "origin", found, "%s",
                              scene->dimension == 2 ? "rectangle or disc" : "box or cylinder");
    return GNEISS_OK;
}

/* Computes the bounding box of the region, m. */
static void bounds(const gn_flow_region *region, double lower[3], double upper[3]) {
    const bool round = region->has_disc || region->has_cylinder;
    for (size_t a = 0; a < 3; a++) {
        lower[a] = region->origin[a] - (round && a < 2 ? 0.5 * region->diameter : 0.0);
        upper[a] = region->origin[a] +
                   (round ? (a < 2 ? 0.5 * region->diameter : region->height) : region->size[a]);
        if (!region->corner_count || a == 2) continue;
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
        for (size_t k = 0; k < region->corner_count; k++) {
            lower[a] = fmin(lower[a], region->corners[2 * k + a]);
            upper[a] = fmax(upper[a], region->corners[2 * k + a]);
        }
    }
}

/* Checks that particles are created inside the domain and the periodic box. */
static gneiss_status check_place(const check *section, const gn_scene *scene,
                                 const gn_flow_region *region) {
    double lower[3], upper[3];
    bounds(region, lower, upper);
    for (int a = 0; a < (int)scene->dimension; a++) {
        const char *what = scene->has_domain ? "domain" : "periodic box";
        double least = scene->has_domain ? scene->domain_min[a] : scene->periodic_min[a];
        double most = scene->has_domain ? scene->domain_max[a] : scene->periodic_max[a];
        if (!scene->has_domain && !gn_scene_periodic_along(scene, a)) continue;
        if (lower[a] >= least && upper[a] <= most) continue;
        return gn_check_fail(section, region_key(region),
                             "expected a region inside the %s, found %g to %g m along %c, outside "
                             "of %g to %g m",
                             what, lower[a], upper[a], "xyz"[a], least, most);
    }
    return GNEISS_OK;
}

gneiss_status gn_check_sieve(const check *checked, const char *section, bool wanted,
                             const double *row, size_t count) {
    char sieve[48], sizes[48];
    snprintf(sieve, sizeof sieve, "%ssieve", section);
    snprintf(sizes, sizeof sizes, "%ssizes", section);
    if (wanted != (count > 0))
        return count ? gn_check_needs(checked, sieve, "others", "sizes: sieve")
                     : gn_check_needs(checked, sizes, "none", "a key sieve with sizes and shares");
    for (size_t k = 1; k < count; k++)
        if (!(row[2 * k] > row[2 * k - 2]) || row[2 * k + 1] < row[2 * k - 1])
            return gn_check_fail(checked, sieve,
                                 "expected increasing sizes and shares that do not decrease, found "
                                 "[%g, %g] after [%g, %g]",
                                 row[2 * k], row[2 * k + 1], row[2 * k - 2], row[2 * k - 1]);
    if (count &&
        (!(row[0] > 0) || row[1] != 0 || row[2 * count - 2] != 1 || row[2 * count - 1] != 1))
        return gn_check_fail(checked, sieve,
                             "expected a first row [size, 0], size above 0, and a last row [1, 1], "
                             "found [%g, %g] and [%g, %g]",
                             row[0], row[1], row[2 * count - 2], row[2 * count - 1]);
    return GNEISS_OK;
}

static gneiss_status check_sizes(const check *section, const gn_source_def *source) {
    GN_TRY(gn_check_sieve(section, "", source->sizes == GN_SIZES_SIEVE, source->sieve,
                          source->sieve_count));
    if (source->sizes == GN_SIZES_SIEVE && gn_check_given(section, "size_ratio"))
        return gn_check_needs(section, "size_ratio", "sieve, whose first row has the smallest size",
                              "sizes: uniform or normal");
    if (source->size_variation >= 0 && source->sizes != GN_SIZES_NORMAL)
        return gn_check_needs(section, "size_variation", "another", "sizes: normal");
    if (source->sizes == GN_SIZES_NORMAL && source->size_ratio == 1.0)
        return gn_check_fail(section, "size_ratio",
                             "expected more than 1 beside sizes: normal, which is truncated at the "
                             "smallest and the largest size, found 1");
    return GNEISS_OK;
}

static gneiss_status check_source(const check *section, const gn_scene *scene, size_t index) {
    gn_source_def *source = &scene->sources[index];
    for (size_t k = 0; k < index; k++)
        GN_TRY(gn_check_name(section, strcmp(scene->sources[k].name, source->name) == 0,
                             source->name));
    GN_TRY(check_region(section, scene, &source->region, NULL));
    if ((source->rate > 0) == (source->mass_rate > 0))
        return gn_check_fail(section, source->rate > 0 ? "mass_rate" : "rate",
                             "expected either rate or mass_rate, found %s",
                             source->rate > 0 ? "both" : "none");
    if (source->end > 0 && !(source->end > source->start))
        return gn_check_fail(section, "end", "expected an end after the start, %g s, found %g s",
                             source->start, source->end);
    GN_TRY(check_sizes(section, source));
    if (!*source->material && scene->material_count == 1)
        memcpy(source->material, scene->materials[0].name, sizeof source->material);
    GN_TRY(gn_check_material_name(section, scene, "material", source->material));
    return gn_check_is_valid(section, "domain") ? check_place(section, scene, &source->region)
                                                : GNEISS_OK;
}

static gneiss_status check_sink(const check *section, const gn_scene *scene, size_t index) {
    gn_sink_def *sink = &scene->sinks[index];
    for (size_t k = 0; k < index; k++)
        GN_TRY(gn_check_name(section, strcmp(scene->sinks[k].name, sink->name) == 0, sink->name));
    GN_TRY(check_region(section, scene, &sink->region, sink));
    if (!sink->remove && !sink->has_plane)
        return gn_check_fail(section, "remove", "expected plane beside false, found a region");
    if (sink->has_plane && !gn_check_direction(sink->normal))
        return gn_check_fail(section, "plane.normal", "expected a direction, found [0, 0, 0]");
    return GNEISS_OK;
}

/* Refuses keys that require the same particles from start to end. */
static gneiss_status check_beside(const check *section, const gn_scene *scene) {
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->has_membrane, "membrane"},
                  {scene->has_couple, "couple"},
                  {scene->has_mass_scaling, "time.mass_scaling"},
                  {scene->start == GN_START_FIRST_BREAK, "time.start: first_break"}};
    const char *list = scene->source_count ? "sources" : "sinks";
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, list, "expected a scene without %s, found one with it",
                                 others[k].what);
    if (!scene->has_specimen) return gn_check_needs(section, list, "none", "a specimen or sources");
    if (scene->set_count && !scene->specimen_given)
        return gn_check_needs(section, "sets", "sources alone",
                              "a specimen, whose particles sets select");
    for (size_t k = 0; k < scene->source_count && !gn_scene_starts_filled(scene); k++)
        if (scene->sources[k].start == 0) return GNEISS_OK;
    if (gn_scene_starts_filled(scene)) return GNEISS_OK;
    return gn_check_fail(section, list,
                         "expected a specimen, or a source with start 0, found neither: the scene "
                         "starts without particles");
}

gneiss_status gn_check_flow(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    const check scene = {.reader = reader, .map = root};
    GN_TRY(gn_check_list(&scene, "sources", s->source_count, check_source));
    GN_TRY(gn_check_list(&scene, "sinks", s->sink_count, check_sink));
    if (!s->source_count && !s->sink_count) return GNEISS_OK;
    if (!gn_check_is_valid(&scene, "sources") || !gn_check_is_valid(&scene, "specimen"))
        return GNEISS_OK;
    return gn_check_keep_problem(&scene, check_beside(&scene, s));
}

/* ---- cross-key checks of `bodies` ---- */

/* Checks that exactly one of the shapes is given. */
static gneiss_status check_body_shape(const check *section, const gn_scene *scene,
                                      const gn_body_def *body) {
    static const char *const names[] = {"surface",     "box",    "cylinder", "polygon", "polyline",
                                        "disc_cutter", "chisel", "wedge",    "pick"};
    const bool has[] = {*body->surface != '\0',
                        body->has_box,
                        body->has_cylinder,
                        body->polygon_count > 0,
                        body->polyline_count > 0,
                        body->has_disc_cutter,
                        body->has_chisel,
                        body->has_wedge,
                        body->has_pick};
    char found[120] = "";
    for (size_t k = 0; k < sizeof has / sizeof *has; k++) {
        size_t used = strlen(found);
        if (has[k]) snprintf(found + used, sizeof found - used, "%s%s", used ? ", " : "", names[k]);
    }
    if (*found && !strchr(found, ',')) {
        const gn_tool_kind tool = gn_body_tool(body);
        if (scene->dimension == 2 || body->tool.width > 0 ||
            (tool != GN_TOOL_CHISEL && tool != GN_TOOL_WEDGE))
            return GNEISS_OK;
        return gn_check_fail(section, tool == GN_TOOL_CHISEL ? "chisel.width" : "wedge.width",
                             "required in a 3D scene, but not given");
    }
    return gn_check_fail(section, "", "expected one of %s in it, found %s",
                         scene->dimension == 2
                             ? "polygon, polyline, chisel, wedge"
                             : "surface, box, cylinder, disc_cutter, chisel, wedge, pick",
                         *found ? found : "none");
}

/* Checks that either density or mass is given, and that the inertia is physically possible. */
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

/* Checks bodies whose mass does not follow from a closed surface: a body without one, or one that
 * rotates about another point than the centre of the enclosed volume, must give all values that
 * would follow from it. */
static gneiss_status check_centre(const check *section, const gn_body_def *body) {
    if (body->has_reference) {
        if (body->mass > 0 && body->has_inertia) return GNEISS_OK;
        return gn_check_needs(section, "reference", body->has_inertia ? "no mass" : "no inertia",
                              "mass and inertia, as it is the centre of mass of a free body");
    }
    static const char whole[] =
        "needs %s, or mass, inertia and reference (the centre of mass); found none";
    if (body->polyline_count)
        return gn_check_fail(section, "free", whole, "a polygon (a polyline has no inside)");
    if (body->has_cylinder && body->cylinder.open)
        return gn_check_fail(section, "free", whole, "a closed cylinder");
    return GNEISS_OK;
}

/* Checks that spin components prescribed by the motion have no initial value. */
static gneiss_status check_spins(const check *section, const gn_scene *scene,
                                 const gn_body_def *body) {
    static const char *const keys[] = {"motion.wx", "motion.wy", "motion.wz"};
    const gn_table *spin = body->motion.spin;
    if (gn_body_spin_kind(scene, body) != GN_SPINS_SOME) {
        if (body->has_initial_spin && gn_body_spin_kind(scene, body) == GN_SPINS_PRESCRIBED)
            return gn_check_needs(section, "initial_spin", "one in motion",
                                  "a body without a prescribed spin");
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
    const bool has[] = {body->density > 0,          body->mass > 0,         body->has_inertia,
                        body->has_initial_velocity, body->has_initial_spin, body->has_force};
    static const char *const only[] = {"density",          "mass",         "inertia",
                                       "initial_velocity", "initial_spin", "force"};
    for (int a = 0; body->free && a < 3; a++)
        if (body->force[a] != 0 && body->motion.velocity[a].count)
            return gn_check_fail(section, "force",
                                 "expected 0 along %c, where motion prescribes the velocity, found "
                                 "%g N",
                                 "xyz"[a], body -> force[a]);
    if (body->free) {
        GN_TRY(check_weight(section, scene, body));
        GN_TRY(check_centre(section, body));
        return check_spins(section, scene, body);
    }
    for (int k = 0; k < 6; k++)
        if (has[k]) return gn_check_needs(section, only[k], "false", "free true");
    return GNEISS_OK;
}

static gneiss_status check_body(const check *section, const gn_scene *scene, size_t index) {
    gn_body_def *body = &scene->bodies[index];
    GN_TRY(gn_check_name(section,
                         gn_scene_find_body(scene, body->name) != (int)index ||
                             gn_scene_find_wall(scene, body->name) >= 0 ||
                             gn_scene_find_set(scene, body->name) >= 0,
                         body->name));
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
    const check c = {.reader = reader, .map = root};
    return gn_check_list(&c, "bodies", reader->scene->body_count, check_body);
}

/* ---- checks of fields that files hold on request ---- */

#define X(name, needs, lacks) {#name, needs, lacks},
static const struct {
    const char *name;
    gn_effects needs;
    const char *lacks;
} fields[GN_ASKED_COUNT] = {GN_ASKED_FIELDS(X)};
#undef X

static int find(const char *name) {
    for (int k = 0; k < GN_ASKED_COUNT; k++)
        if (strcmp(fields[k].name, name) == 0) return k;
    return -1;
}

static gneiss_status unknown(const check *section, const char *name) {
    char advice[GN_ADVICE_SIZE];
    gn_names names = gn_names_for(name);
    for (int k = 0; k < GN_ASKED_COUNT; k++) gn_names_add(&names, fields[k].name);
    return gn_check_fail(section, "output.fields", "expected the name of a field, found '%s'%s",
                         name, gn_names_advice(&names, advice, sizeof advice));
}

gneiss_status gn_check_output(const check *section, gn_scene *scene) {
    scene->asked = 0;
    if (scene->contact_rows == GN_SWITCH_ON && !scene->has_specimen)
        return gn_check_needs(section, "output.contacts", "elements only",
                              "a specimen, whose particles have contacts");
    if (scene->has_structure && !scene->has_specimen)
        return gn_check_needs(section, "output.structure", "elements only",
                              "a specimen, whose particles are measured");
    if (scene->has_structure)
        GN_TRY(gn_check_box(section, scene, "output.structure.max", scene->structure_min,
                            scene->structure_max));
    if (scene->field_count && !scene->has_specimen)
        return gn_check_needs(section, "output.fields", "elements only",
                              "a specimen, whose particles and bonds have them");
    for (size_t k = 0; k < scene->field_count; k++) {
        int f = find(scene->fields[k]);
        if (f < 0) return unknown(section, scene->fields[k]);
        if (scene->asked >> f & 1)
            return gn_check_fail(section, "output.fields",
                                 "expected every name once, found '%s' again", fields[f].name);
        scene->asked |= 1u << f;
    }
    return scene->stage_count ? GNEISS_OK : gn_check_requested_fields(section, scene);
}

gneiss_status gn_check_requested_fields(const check *section, const gn_scene *scene) {
    const gn_effects has = gn_scene_effects(scene);
    for (int f = 0; f < GN_ASKED_COUNT; f++)
        if (scene->asked >> f & 1 && (has & fields[f].needs) != fields[f].needs)
            return gn_check_fail(section, "output.fields", "expected %s beside '%s', found none%s",
                                 fields[f].lacks, fields[f].name,
                                 scene->stage_count ? " in any stage" : "");
    return GNEISS_OK;
}

/* ---- checks of steps, of mass scaling, and of the start of steps ---- */

static gneiss_status check_step(const check *section, const gn_scene *scene) {
    if (scene->step <= scene->end) return GNEISS_OK;
    return gn_check_fail(section, "time.step", "expected a step below the end, found %g s and %g s",
                         scene->step, scene->end);
}

static gneiss_status check_mass_scaling(const check *section, const gn_scene *scene) {
    const bool falls = gn_scene_has_gravity(scene);
    if (!scene->has_mass_scaling || !gn_check_is_valid(section, "gravity")) return GNEISS_OK;
    if ((scene->scaled_step > 0.0) == (scene->scaled_factor > 0.0))
        return gn_check_fail(section, "time.mass_scaling",
                             "expected either step or factor, found %s",
                             scene->scaled_step > 0.0 ? "both" : "neither");
    if (scene->step > 0.0)
        return gn_check_fail(section, "time.mass_scaling",
                             "expected time.step: auto, which takes the target step of mass "
                             "scaling, found a step of %g s",
                             scene->step);
    if (!scene->has_specimen)
        return gn_check_fail(section, "time.mass_scaling",
                             "expected a specimen: the masses of finite elements are not raised, "
                             "found elements only");
    if (scene->scaled_step >= scene->end)
        return gn_check_fail(section, "time.mass_scaling.step",
                             "expected a step below the end, found %g s and %g s",
                             scene->scaled_step, scene->end);
    if (falls && scene->scaled_gravity == GN_GRAVITY_REFUSED)
        return gn_check_fail(
            section, "time.mass_scaling",
            "expected no gravity, as scaled masses would change weights, or gravity: own_mass, "
            "which keeps each weight and lets particles fall more slowly, found gravity and %s",
            gn_check_given(section, "time.mass_scaling.gravity") ? "gravity: refuse"
                                                                 : "no such key");
    return GNEISS_OK;
}

/* Tells whether a load changes with time. The static analysis assumes that loads are linear in
 * time, and would miss a load that reverses between two states. */
static bool changes(const gn_table *table) {
    for (size_t k = 1; k < table->count; k++)
        if (table->value[k] != table->value[0]) return true;
    return false;
}

static bool motion_changes(const gn_motion *motion) {
    bool found = false;
    for (int a = 0; a < 3; a++)
        found = found || changes(&motion->velocity[a]) || changes(&motion->spin[a]);
    return found;
}

const char *gn_scene_loading_refusal(const gn_scene *scene) {
    if (!scene->has_specimen || scene->bonds != GN_SWITCH_ON) return "bonded particles, found none";
    if (scene->has_elements) return "particles alone, found elements";
    if (scene->loads_vary) return "constant gravity and forces, found some that vary over time";
    if (scene->body_count) return "walls and sets, found bodies";
    if (scene->has_membrane) return "walls and sets, found a membrane";
    if (scene->joint_count) return "a specimen without joints, found joints";
    if (gn_scene_box_moves(scene)) return "a fixed periodic box, found sides that move";
    if (scene->background == GN_BACKGROUND_VISCOUS &&
        gn_scene_spin_damping(scene) != scene->background_coefficient &&
        scene->rotation != GN_SWITCH_OFF)
        return "equal damping of spins and velocities, found damping.background.rotation";
    if (scene->random_velocity > 0) return "a specimen at rest, found initial.random_velocity";
    if (scene->has_pulse) return "a specimen at rest, found initial.pulse";
    for (size_t k = 0; k < scene->wall_count; k++)
        if (scene->walls[k].servo.active) return "walls with prescribed motion, found a servo";
    for (size_t k = 0; k < scene->set_count; k++)
        for (int a = 0; a < 3; a++) {
            const gn_set_def *set = &scene->sets[k];
            bool moves = set->initial_velocity[a] != 0 && !set->motion.velocity[a].count;
            bool spins = set->initial_spin[a] != 0 && !set->motion.spin[a].count;
            if (moves || spins) return "a specimen at rest, found a set with an initial velocity";
        }
    return NULL;
}

const char *gn_scene_statics_refusal(const gn_scene *scene) {
    const char *reason = gn_scene_loading_refusal(scene);
    if (reason) return reason;
    if (scene->bond_radius_multiplier > 0)
        return "bonds without moments, found bonds.radius_multiplier";
    if (scene->softening != GN_SOFTENING_NONE)
        return "bonds that break at once, found law.softening";
    for (size_t k = 0; k < scene->material_count; k++)
        if (scene->materials[k].yield_stress[0] > 0)
            return "bonds that break at once, found a material with yield_stress_1";
    for (size_t k = 0; k < scene->wall_count; k++)
        if (motion_changes(&scene->walls[k].motion))
            return "motions at constant velocity, found a wall whose velocity changes";
    for (size_t k = 0; k < scene->set_count; k++)
        if (motion_changes(&scene->sets[k].motion))
            return "motions at constant velocity, found a set whose velocity changes";
    if (scene->stop_unbalanced > 0)
        return "conditions that count from the start of steps, found time.stop.unbalanced";
    return NULL;
}

static gneiss_status check_start_of_steps(const check *section, const gn_scene *scene) {
    const char *reason =
        scene->start == GN_START_FIRST_BREAK ? gn_scene_statics_refusal(scene) : NULL;
    if (reason) return gn_check_fail(section, "time.start", "first_break: expected %s", reason);
    /* A scene that was written contains the default of every key. */
    if (scene->start == GN_START_REST && scene->start_fraction != 0.9)
        return gn_check_needs(section, "time.start_fraction", "rest", "time.start: first_break");
    return GNEISS_OK;
}

const char *gn_check_stop(const gn_scene *scene) {
    return scene->stop_peak_drop > 0    ? "time.stop.peak_drop"
           : scene->stop_strain > 0     ? "time.stop.strain"
           : scene->stop_unbalanced > 0 ? "time.stop.unbalanced"
                                        : NULL;
}

/* Checks stop conditions, which are evaluated in rows of the history; a single row is that of the
 * start. */
static gneiss_status check_stops(const check *section, const gn_scene *scene) {
    const char *stop = gn_check_stop(scene);
    if (!stop || scene->history_rows > 1 || !gn_check_is_valid(section, "output.history_rows"))
        return GNEISS_OK;
    return gn_check_fail(section, stop,
                         "expected output.history_rows above 1, as it is evaluated in rows of the "
                         "history, found %lld: it would never stop the run",
                         (long long)scene->history_rows);
}

gneiss_status gn_check_time(const check *section, const gn_scene *scene) {
    GN_TRY(gn_check_keep_problem(section, check_stops(section, scene)));
    GN_TRY(gn_check_keep_problem(section, check_start_of_steps(section, scene)));
    GN_TRY(gn_check_keep_problem(section, check_step(section, scene)));
    return gn_check_keep_problem(section, check_mass_scaling(section, scene));
}
