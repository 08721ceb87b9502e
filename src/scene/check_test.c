/* Laboratory tests: their ends, and the keys of each kind. */
#include "scene/check.h"

#include "base/names.h"
#include "scene/acts.h"

#include <math.h>
#include <string.h>

/* ---- ends ---- */

/* Returns the names of all objects that can be an end. */
static gn_names names_of_ends(const gn_scene *s, const char *wanted) {
    gn_names names = gn_names_for(wanted);
    for (size_t k = 0; k < s->wall_count; k++) gn_names_add(&names, s->walls[k].name);
    for (size_t k = 0; k < s->body_count; k++) gn_names_add(&names, s->bodies[k].name);
    for (size_t k = 0; k < s->set_count; k++) gn_names_add(&names, s->sets[k].name);
    for (size_t k = 0; k < s->elements.motion_count; k++)
        gn_names_add(&names, s->elements.motions[k].name);
    return names;
}

static gneiss_status no_end(const check *c, const gn_scene *s, const char *key, const char *name) {
    char advice[GN_ADVICE_SIZE];
    gn_names names = names_of_ends(s, name);
    return gn_check_fail(c, key, "expected the name of a wall, a body or a set%s, found '%s'%s",
                         s->has_elements ? " or a motion of elements" : "", name,
                         gn_names_advice(&names, advice, sizeof advice));
}

static gneiss_status check_end(const check *c, const gn_scene *s, const char *key,
                               const gn_test_end *end) {
    for (size_t k = 0; k < end->count; k++) {
        const char *name = end->name[k];
        if (gn_scene_find_wall(s, name) < 0 && gn_scene_find_set(s, name) < 0 &&
            gn_scene_find_body(s, name) < 0 && gn_scene_find_element_motion(s, name) < 0)
            return no_end(c, s, key, name);
        if (gn_test_end_has(end, k, name))
            return gn_check_fail(c, key, "expected every name once, found '%s' again", name);
    }
    return GNEISS_OK;
}

/* Checks both sides of a test or a gauge. */
static gneiss_status check_sides(const check *c, const gn_scene *s, const char *lower_key,
                                 const gn_test_end *lower, const char *upper_key,
                                 const gn_test_end *upper) {
    GN_TRY(gn_check_keep_problem(c, check_end(c, s, lower_key, lower)));
    GN_TRY(gn_check_keep_problem(c, check_end(c, s, upper_key, upper)));
    for (size_t k = 0; k < upper->count; k++)
        if (gn_test_end_has(lower, lower->count, upper->name[k]))
            return gn_check_fail(c, upper_key, "expected another end than lower, found '%s'",
                                 upper->name[k]);
    return GNEISS_OK;
}

/* Cosine from which a wall counts as normal to a direction. */
static const double across = 0.9;

/* Checks two walls at different ends: they must face each other along `way`, the lower one first.
 * Other ends are at the positions of their particles, nodes and bodies, which are checked when the
 * world is created. */
static gneiss_status check_two_walls(const check *c, const gn_wall_def *lower,
                                     const gn_wall_def *upper, int way) {
    const double low = lower->normal[way], high = upper->normal[way];
    if (low * high > 1e-6)
        return gn_check_fail(c, "test.upper",
                             "expected a wall that faces the lower end along %c, found '%s', whose "
                             "normal has the sense of that of '%s': both ends are on one side",
                             "xyz"[way], upper -> name, lower -> name);
    const bool both = fabs(low) > across && fabs(high) > across;
    if (!both || upper->point[way] > lower->point[way]) return GNEISS_OK;
    return gn_check_fail(c, "test.upper",
                         "expected an end above the lower one along %c, found wall '%s' at %g m, "
                         "where '%s' is at %g m",
                         "xyz"[way], upper -> name, upper -> point[way], lower -> name,
                         lower -> point[way]);
}

/* Refuses a wall that is parallel to the direction of loading, because it carries no load. A
 * sheared specimen may be loaded by walls normal to either direction. */
static gneiss_status check_across(const check *c, const gn_scene *s, const char *key,
                                  const gn_test_end *end) {
    const int way = (int)s->test.axis;
    for (size_t k = 0; way >= 0 && k < end->count; k++) {
        const int wall = gn_scene_find_wall(s, end->name[k]);
        if (wall < 0 || fabs(s->walls[wall].normal[way]) > 0.1) continue;
        const char axis = "xyz"[way];
        return gn_check_fail(c, key,
                             "expected a wall that stands across the axis of the test, %c, found "
                             "'%s', which lies along it",
                             axis, end->name[k]);
    }
    return GNEISS_OK;
}

static gneiss_status check_walls_of_ends(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    const bool sheared = gn_scene_test(s)->sheared;
    const int way = (int)(sheared ? t->normal : t->axis);
    if (!sheared) {
        GN_TRY(check_across(c, s, "test.lower", &t->lower));
        GN_TRY(check_across(c, s, "test.upper", &t->upper));
    }
    for (size_t k = 0; way >= 0 && k < t->lower.count; k++)
        for (size_t m = 0; m < t->upper.count; m++) {
            int lower = gn_scene_find_wall(s, t->lower.name[k]),
                upper = gn_scene_find_wall(s, t->upper.name[m]);
            if (lower >= 0 && upper >= 0)
                GN_TRY(check_two_walls(c, &s->walls[lower], &s->walls[upper], way));
        }
    return GNEISS_OK;
}

/* Tells whether an end consists of walls that face the specimen, which can press on it but cannot
 * pull. */
static bool only_walls(const gn_scene *s, const gn_test_end *end, double sense) {
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(s, end->name[k]);
        if (wall < 0 || !(sense * s->walls[wall].normal[s->test.axis] > 0.0)) return false;
    }
    return true;
}

static gneiss_status check_pull(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    const gn_test_descriptor *d = gn_scene_test(s);
    if (d->sign < 0 || d->sheared || !only_walls(s, &t->lower, 1.0) ||
        !only_walls(s, &t->upper, -1.0))
        return GNEISS_OK;
    return gn_check_fail(c, "test.upper",
                         "expected ends that can pull (sets, motions of elements), found walls on "
                         "both sides, which only press");
}

static gneiss_status check_ends(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    const char *const lists[] = {"walls", "sets", "bodies", "elements.motions"};
    for (int k = 0; k < 4; k++)
        if (!gn_check_names_are_valid(c, lists[k])) return GNEISS_OK;
    GN_TRY(check_sides(c, s, "test.lower", &t->lower, "test.upper", &t->upper));
    if (t->has_opening)
        GN_TRY(check_sides(c, s, "test.opening.lower", &t->opening.lower, "test.opening.upper",
                           &t->opening.upper));
    for (int k = 0; k < 4; k++)
        if (!gn_check_is_valid(c, lists[k])) return GNEISS_OK;
    if (!gn_check_is_valid(c, "test")) return GNEISS_OK;
    GN_TRY(gn_check_keep_problem(c, check_walls_of_ends(c, s)));
    GN_TRY(check_pull(c, s));
    if (s->stage_count) return GNEISS_OK;
    GN_TRY(gn_check_separating_ends(c, s));
    if (gn_scene_end_drives(s, &t->lower) || gn_scene_end_drives(s, &t->upper)) return GNEISS_OK;
    return gn_check_fail(c, "test.upper",
                         "expected at least one end with a prescribed velocity along %c, which "
                         "has a reaction, found none",
                         "xyz"[t->axis]);
}

/* ---- keys of a kind ---- */

#define X(name) "test." #name,
static const char *const test_keys[] = {GN_TEST_KEYS(X)};
#undef X

/* Collects the values of keys; a value above 0 was given. */
static void get_values(const gn_test *t, double value[GN_TEST_KEY_COUNT]) {
#define X(name) value[GN_TEST_KEY_##name] = t->given.name;
    GN_TEST_SIZES(X)
#undef X
    value[GN_TEST_KEY_centre] = t->centre != 0.2 ? t->centre : 0.0;
    value[GN_TEST_KEY_normal] = (double)t->normal + 1.0;
    value[GN_TEST_KEY_tool] = *t->tool ? 1.0 : 0.0;
    value[GN_TEST_KEY_blocks] = t->blocks != 5 ? 1.0 : 0.0;
    value[GN_TEST_KEY_pressure_exponent] = t->pressure_exponent != 0 ? 1.0 : 0.0;
}

static gneiss_status check_keys(const check *c, const gn_scene *s) {
    const gn_test_descriptor *d = gn_scene_test(s);
    double value[GN_TEST_KEY_COUNT];
    char text[256];
    get_values(&s->test, value);
    for (size_t k = 0; k < GN_TEST_KEY_COUNT; k++) {
        unsigned kinds = 0;
        if (!(value[k] > 0) || d->takes >> k & 1) continue;
        for (unsigned n = 0; n < GN_TEST_KINDS; n++)
            kinds |= (gn_test_kinds[n]->takes >> k & 1) << n;
        return gn_check_fail(c, test_keys[k], "expected in tests of the kind %s, found %s",
                             gn_test_names(kinds, text, sizeof text), d->name);
    }
    return GNEISS_OK;
}

static gneiss_status check_needed_keys(const check *c, const gn_scene *s) {
    const gn_test_descriptor *d = gn_scene_test(s);
    double value[GN_TEST_KEY_COUNT];
    get_values(&s->test, value);
    for (size_t k = 0; k < GN_TEST_KEY_COUNT; k++)
        if (d->needs >> k & 1 && !(value[k] > 0))
            return gn_check_fail(c, test_keys[k], "required by a %s test, but not given", d->name);
    return GNEISS_OK;
}

/* Checks the sizes; one that is not given is 0 and passes. */
static gneiss_status check_sizes(const check *c, const gn_scene *s) {
    const gn_test_sizes *x = &s->test.given;
    if (x->area > 0 && x->diameter > 0)
        return gn_check_fail(c, "test.diameter", "expected area or diameter, found both");
    GN_TRY(check_needed_keys(c, s));
    if (x->load_span > 0 && x->load_span >= x->span)
        return gn_check_fail(c, "test.load_span", "expected less than the span of %g m, found %g m",
                             x->span, x->load_span);
    if (x->height > 0 && x->notch >= x->height)
        return gn_check_fail(c, "test.notch", "expected less than the height of %g m, found %g m",
                             x->height, x->notch);
    if (s->dimension != 2 || !(x->thickness > 0) || x->thickness == 1) return GNEISS_OK;
    return gn_check_fail(c, "test.thickness", "expected 1 m in a 2D scene, found %g m",
                         x->thickness);
}

/* Checks confined tests, whose deviator is the stress less the pressure of a membrane. */
static gneiss_status check_confined(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    if (!s->has_membrane)
        return gn_check_fail(c, "test.kind",
                             "expected a membrane, whose pressure confines the specimen, found "
                             "none");
    if (gn_scene_membrane_axis(s) != t->axis)
        return gn_check_fail(c, "membrane.axis", "expected that of the test, %c, found %c",
                             "xyz"[t->axis], "xyz"[gn_scene_membrane_axis(s)]);
    return GNEISS_OK;
}

/* Checks periodic sides of a shear test; any other sides along the shear would have to be kept
 * straight. */
static gneiss_status check_periodic_sides(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    if (!s->has_periodic)
        return gn_check_fail(c, "test.kind",
                             "expected a periodic box that is open along the normal, %c, whose "
                             "sides let the specimen shear, found none",
                             "xyz"[t->normal]);
    if (s->periodic_open == t->normal) return GNEISS_OK;
    return gn_check_fail(
        c, "periodic.open", "expected %c, the normal of the %s test, found %s", "xyz"[t->normal],
        gn_scene_test(s) -> name,
        gn_choice_name(gn_scene_key_at("periodic.open")->choices, (int)s->periodic_open));
}

static gneiss_status check_shear(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    if (t->normal >= s->dimension)
        return gn_check_fail(c, "test.normal", "expected x or y in a 2D scene, found z");
    if (t->normal == t->axis)
        return gn_check_fail(c, "test.normal", "expected another direction than axis, found %c",
                             "xyz"[t->normal]);
    return gn_scene_test(s)->periodic_sides ? check_periodic_sides(c, s) : GNEISS_OK;
}

/* Checks the sides of an oedometer: a specimen that is not held at both sides across the axis has
 * the stress of a compression test. */
static gneiss_status check_sides_stand(const check *c, const gn_scene *s) {
    const char *const lists[] = {"walls", "sets", "bodies", "elements", "periodic"};
    for (int k = 0; k < 5; k++)
        if (!gn_check_is_valid(c, lists[k])) return GNEISS_OK;
    for (int a = 0; a < (int)s->dimension; a++)
        if (a != s->test.axis && !gn_scene_is_held_along(s, a))
            return gn_check_fail(
                c, "test.kind",
                "expected sides of the specimen that stand along %c beside the ends of an "
                "%s test (walls that face each other, bodies, sets that are held there, a "
                "periodic box), found none",
                "xyz"[a], gn_scene_test(s) -> name);
    return GNEISS_OK;
}

static bool driven_by_servo(const gn_scene *s, const gn_test_end *end) {
    for (size_t k = 0; k < end->count; k++) {
        int wall = gn_scene_find_wall(s, end->name[k]);
        if (wall >= 0 && s->walls[wall].servo.active) return true;
    }
    return false;
}

/* Checks that a controlled test has an end that moves and a quantity to read. */
static gneiss_status check_control(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    if (!t->has_control) return GNEISS_OK;
    if (!(t->control.opening > 0) == !(t->control.lateral_strain > 0))
        return gn_check_fail(c, "test.control", "expected opening or lateral_strain, found %s",
                             t->control.opening > 0 ? "both" : "none");
    if (t->control.opening > 0 && !t->has_opening)
        return gn_check_needs(c, "test.control.opening", "none",
                              "test.opening, a gauge that is read");
    if (t->control.lateral_strain > 0 && (!s->has_specimen || s->has_periodic))
        return gn_check_fail(c, "test.control.lateral_strain",
                             "expected particles with a surface, whose mean strain is read, found "
                             "%s",
                             s->has_specimen ? "a periodic box" : "none");
    if (driven_by_servo(s, &t->lower) || driven_by_servo(s, &t->upper))
        return gn_check_fail(c, "test.control",
                             "expected ends that move as given, found a wall with a servo");
    if (!s->stage_count && !gn_scene_end_moves(s, &t->lower) && !gn_scene_end_moves(s, &t->upper))
        return gn_check_fail(c, "test.control",
                             "expected an end that is moved along %c, whose motion it scales, "
                             "found velocities of 0 alone",
                             "xyz"[t->axis]);
    if (s->start == GN_START_FIRST_BREAK)
        return gn_check_needs(c, "test.control", "first_break", "time.start: rest");
    return GNEISS_OK;
}

static gneiss_status check_kind(const check *c, const gn_scene *s) {
    const gn_test_descriptor *d = gn_scene_test(s);
    GN_TRY(check_keys(c, s));
    GN_TRY(check_control(c, s));
    GN_TRY(check_sizes(c, s));
    if (d->dimension && d->dimension != s->dimension)
        return gn_check_fail(c, "test.kind", "expected %s in a %dD scene, found %s", d->counterpart,
                             (int)s->dimension, d->name);
    if (d->disc && s->test.axis == 2)
        return gn_check_fail(c, "test.axis",
                             "expected x or y: the disc of a %s test stands across z, found z",
                             d->name);
    if (d->sheared) GN_TRY(check_shear(c, s));
    if (d->confined) GN_TRY(check_confined(c, s));
    return d->sides_stand ? check_sides_stand(c, s) : GNEISS_OK;
}

/* Least number of confinements of an envelope, see src/sweep/envelope.h. */
enum { LEAST_CONFINEMENTS = 3 };

/* Reads a pressure; an invalid one is reported later, when its run is prepared. */
static bool read_pressure(const check *c, const gn_node *item, double *pressure) {
    char reason[96];
    return item->kind == GN_NODE_SCALAR &&
           gn_read_quantity(c->reader, item->text, "Pa", pressure, reason, sizeof reason);
}

static gneiss_status check_different(const check *c, const gn_node *list) {
    double a, b;
    for (const gn_node *one = list->first; one; one = one->next)
        for (const gn_node *other = one->next; other; other = other->next)
            if (read_pressure(c, one, &a) && read_pressure(c, other, &b) && a == b)
                return gn_check_fail(c, "test.confinement",
                                     "expected pressures that differ, found %g Pa twice", a);
    return GNEISS_OK;
}

/* Checks the list and removes it from the scene; its values are read by the code that makes a run
 * for each. */
static gneiss_status check_confinements(const check *c, gn_scene *s) {
    const gn_node *list = s->test.confinement;
    s->test.has_confinement = false;
    s->test.confinement = NULL;
    if (!list) return GNEISS_OK;
    if (!gn_scene_test(s)->confined)
        return gn_check_needs(c, "test.confinement", "another", "a triaxial or biaxial test");
    if (list->kind != GN_NODE_LIST || list->count < LEAST_CONFINEMENTS)
        return gn_check_fail(c, "test.confinement",
                             "expected a list of at least %d pressures, which a friction angle "
                             "needs (a single one is membrane.pressure), found %zu",
                             LEAST_CONFINEMENTS,
                             list->kind == GN_NODE_LIST ? list->count : (size_t)1);
    return check_different(c, list);
}

gneiss_status gn_check_membrane(const check *section, const gn_scene *scene) {
    const gn_membrane_def *m = &scene->membrane;
    if (!scene->has_membrane) return GNEISS_OK;
    if (!scene->has_specimen)
        return gn_check_fail(section, "membrane", "expected a specimen that it covers, found none");
    if (m->faces == GN_FACES_SIDES && scene->specimen.pack.shape == GN_SHAPE_NONE)
        return gn_check_fail(section, "membrane.faces",
                             "expected all of the surface, or a specimen that is packed into a "
                             "shape, which has sides, found sides of another one");
    if (m->faces == GN_FACES_SIDES && m->surface == GN_SURFACE_PARTICLES)
        return gn_check_fail(section, "membrane.faces",
                             "expected all of the surface, or membrane.surface: shape, which has "
                             "sides, found sides of a surface of particles");
    if (scene->has_periodic)
        return gn_check_fail(section, "membrane",
                             "expected a specimen with a surface, found periodic");
    if (m->faces == GN_FACES_SIDES && m->axis < 0 &&
        (!gn_scene_tested(scene) || scene->test.axis < 0))
        return gn_check_fail(section, "membrane.axis",
                             "expected the axis that sides face across, or a test that has one, "
                             "found neither");
    if (m->axis >= scene->dimension)
        return gn_check_fail(section, "membrane.axis", "expected x or y in a 2D scene, found z");
    return GNEISS_OK;
}

static gneiss_status check_no_test(const check *c, const gn_scene *s) {
    if (s->stop_peak_drop > 0)
        return gn_check_fail(c, "time.stop.peak_drop",
                             "expected a test section that reads stress, found none");
    if (s->stop_strain > 0)
        return gn_check_fail(c, "time.stop.strain",
                             "expected a test section that reads strain, found none");
    return GNEISS_OK;
}

gneiss_status gn_check_hydrostatic_load(const check *section, bool presses) {
    const gn_test_descriptor *d = gn_scene_test(section->reader->scene);
    if (presses || !(d->isotropic || d->enclosed)) return GNEISS_OK;
    return gn_check_fail(
        section, "test.kind",
        "expected something that presses on the specimen of a %s test (a "
        "membrane with a pressure, a servo of walls or of a periodic box, walls or "
        "sides that come closer), found nothing",
        d->name);
}

/* Returns the key of an end, which tests without ends do not have; NULL: no end is given. */
static const char *end_key(const gn_test *t) {
    return t->lower.count   ? "test.lower"
           : t->upper.count ? "test.upper"
           : t->has_opening ? "test.opening"
           : t->has_control ? "test.control"
                            : NULL;
}

/* Checks tests whose stress and strain are measured in the specimen, so that they need no end. */
static gneiss_status check_endless(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    const bool along = gn_scene_test(s)->enclosed;
    const char *key = !along && t->axis >= 0 ? "test.axis" : end_key(t);
    if (along && t->axis < 0)
        return gn_check_is_valid(c, "test.axis")
                   ? gn_check_fail(c, "test.axis", "required, but not given")
                   : GNEISS_OK;
    if (along && t->axis >= s->dimension)
        return gn_check_fail(c, "test.axis", "expected x or y in a 2D scene, found z");
    if (key)
        return gn_check_fail(c, key, "expected none: a %s test has no ends",
                             gn_scene_test(s)->name);
    GN_TRY(gn_check_keep_problem(c, check_keys(c, s)));
    const char *const lists[] = {"walls", "sets", "bodies", "elements", "periodic", "membrane"};
    for (int k = 0; k < 6; k++)
        if (!gn_check_is_valid(c, lists[k])) return GNEISS_OK;
    return s->stage_count ? GNEISS_OK : gn_check_hydrostatic_load(c, gn_scene_may_compress(s));
}

/* ---- cutting ---- */

/* Checks that the tool is a body that moves along the cut by a prescribed velocity. In a scene with
 * stages it may begin to move later. */
static gneiss_status check_tool(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    char advice[GN_ADVICE_SIZE];
    const int body = gn_scene_find_body(s, t->tool);
    if (body < 0) {
        gn_names names = gn_names_for(t->tool);
        for (size_t k = 0; k < s->body_count; k++) gn_names_add(&names, s->bodies[k].name);
        return gn_check_fail(c, "test.tool", "expected the name of a body, found '%s'%s", t->tool,
                             gn_names_advice(&names, advice, sizeof advice));
    }
    const gn_table *along = &s->bodies[body].motion.velocity[t->axis];
    if (s->stage_count || gn_table_is_nonzero(along)) return GNEISS_OK;
    return gn_check_fail(c, "test.tool",
                         "expected a body whose motion prescribes a velocity along %c, the axis of "
                         "the cut, found '%s' without",
                         "xyz"[t->axis], t -> tool);
}

/* Checks a cutting test, which continues without chips that fly away. */
static gneiss_status check_cutting(const check *c, gn_scene *s) {
    const gn_test *t = &s->test;
    if (!gn_check_given(c, "domain.lost")) s->lost = GN_LOST_REMOVE;
    const char *key = end_key(t);
    if (key)
        return gn_check_fail(c, key, "expected none: a %s test has no ends, but a tool",
                             gn_scene_test(s)->name);
    GN_TRY(check_keys(c, s));
    if (s->dimension == 2 && t->given.spacing > 0)
        return gn_check_fail(c, "test.spacing",
                             "expected none in a 2D scene, whose cut is 1 m wide, found %g m",
                             t->given.spacing);
    if (t->axis < 0 && !gn_check_is_valid(c, "test.axis")) return GNEISS_OK;
    if (t->axis < 0) return gn_check_fail(c, "test.axis", "required, but not given");
    GN_TRY(check_needed_keys(c, s));
    if (t->axis >= s->dimension)
        return gn_check_fail(c, "test.axis", "expected x or y in a 2D scene, found z");
    GN_TRY(check_shear(c, s));
    if (!s->has_specimen)
        return gn_check_fail(c, "test.kind", "expected particles that the tool cuts, found none");
    return gn_check_is_valid(c, "bodies") ? check_tool(c, s) : GNEISS_OK;
}

gneiss_status gn_check_test(const check *section, gn_scene *scene) {
    const gn_test *t = &scene->test;
    GN_TRY(check_confinements(section, scene));
    if (!gn_scene_tested(scene)) return check_no_test(section, scene);
    const gn_test_descriptor *d = gn_scene_test(scene);
    if (d->isotropic || d->enclosed) return check_endless(section, scene);
    if (gn_scene_test(scene)->tool) return check_cutting(section, scene);
    const char *missing = t->axis < 0       ? "test.axis"
                          : !t->lower.count ? "test.lower"
                          : !t->upper.count ? "test.upper"
                                            : NULL;
    if (missing && gn_check_is_valid(section, missing))
        return gn_check_fail(section, missing, "required, but not given");
    if (missing) return GNEISS_OK;
    if (t->axis >= scene->dimension)
        return gn_check_fail(section, "test.axis", "expected x or y in a 2D scene, found z");
    if (t->has_opening && t->opening.axis >= scene->dimension)
        return gn_check_fail(section, "test.opening.axis",
                             "expected x or y in a 2D scene, found z");
    GN_TRY(check_ends(section, scene));
    return check_kind(section, scene);
}
