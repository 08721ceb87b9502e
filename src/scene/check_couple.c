/* What `couple` must hold together. */
#include "scene/check.h"

#include <math.h>

static gneiss_status check_zone(const check *c, const gn_scene *s, size_t index) {
    const gn_couple_zone *z = &s->couple.zones[index];
    if (!z->edge_count) return gn_check_fail(c, "edges", "expected one at least, found none");
    for (size_t e = 0; e < z->edge_count; e++) {
        double width2 = 0.0;
        char key[32];
        for (int a = 0; a < (int)s->dimension; a++) {
            double d = z->edges[e].to[a] - z->edges[e].from[a];
            width2 += d * d;
        }
        snprintf(key, sizeof key, "edges[%zu].to", e);
        if (!gn_range_holds(GN_LENGTHS, sqrt(width2)))
            return gn_check_fail(c, key, "expected a point %s m from `from`, found %g m",
                                 GN_LENGTHS, sqrt(width2));
    }
    return GNEISS_OK;
}

static bool same_edges(const gn_scene *s, const gn_couple_zone *a, const gn_couple_zone *b) {
    bool same = a->edge_count == b->edge_count;
    for (size_t e = 0; same && e < a->edge_count; e++)
        for (int k = 0; k < (int)s->dimension; k++)
            same = same && a->edges[e].from[k] == b->edges[e].from[k] &&
                   a->edges[e].to[k] == b->edges[e].to[k];
    return same;
}

/* A zone that is there twice is one by mistake: the second changes nothing. */
static gneiss_status check_other(const check *c, const gn_scene *s, size_t index) {
    for (size_t k = 0; k < index; k++)
        if (same_edges(s, &s->couple.zones[k], &s->couple.zones[index]))
            return gn_check_fail(c, "edges",
                                 "expected edges of no other zone, found those of "
                                 "couple.zones[%zu]",
                                 k);
    return GNEISS_OK;
}

/* What a zone does not go with. */
static gneiss_status check_beside(const check *c, const gn_scene *s) {
    if (!s->has_specimen || !s->has_elements)
        return gn_check_fail(c, "couple", "expected a specimen and elements beside it, found %s",
                             s->has_elements ? "elements only" : "a specimen only");
    const struct {
        bool found;
        const char *what;
    } others[] = {{s->elements.has_contact, "elements.contact"},
                  {s->has_periodic, "periodic box"},
                  {s->has_mass_scaling, "time.mass_scaling"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(c, "couple", "expected no %s beside it, found one",
                                 others[k].what);
    return GNEISS_OK;
}

/* ---- a wave at the start ---- */

static gneiss_status check_pulse(const check *c, const gn_scene *s) {
    double size2 = 0.0;
    for (int a = 0; a < (int)s->dimension; a++)
        size2 += s->pulse.direction[a] * s->pulse.direction[a];
    if (!(size2 > 0.0))
        return gn_check_fail(c, "initial.pulse.direction", "expected a direction, found none");
    return GNEISS_OK;
}

/* Springs tie places, not spins; non-viscous damping goes by the resultant on each mass by itself,
 * which consistent ones are not. */
static gneiss_status check_constraint(const check *c, const gn_scene *s) {
    if (s->couple.constraint == GN_COUPLE_CONSISTENT && s->background != GN_BACKGROUND_NONE &&
        s->background != GN_BACKGROUND_VISCOUS && gn_check_sound(c, "damping"))
        return gn_check_fail(c, "couple.constraint",
                             "expected lumped or penalty beside background damping that is not "
                             "viscous, found consistent");
    /* Scenes that were written have all keys: those that say nothing are let pass. */
    const char *springs = s->couple.penalty != 1.0           ? "couple.penalty"
                          : s->couple.penalty_damping != 0.0 ? "couple.penalty_damping"
                                                             : NULL;
    if (springs && s->couple.constraint != GN_COUPLE_PENALTY)
        return gn_check_fail(c, springs, "expected constraint: penalty beside it, found %s",
                             s->couple.constraint == GN_COUPLE_LUMPED ? "lumped" : "consistent");
    if (s->couple.constraint != GN_COUPLE_PENALTY || s->couple.spins == GN_COUPLE_FREE)
        return GNEISS_OK;
    return gn_check_fail(c, "couple.spins", "expected free beside penalty, found slaved");
}

/* ---- conversion ---- */

/* Sets that are only watched, as the sides of a notch's mouth, do nothing to who sleeps. */
static gneiss_status check_convert_set(const check *c, const gn_set_def *set) {
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
                   ? gn_check_fail(c, acts[k].key,
                                   "expected no sets that move, hold or push beside "
                                   "couple.convert, as particles sleep and follow elements (%s do "
                                   "it), found set '%s'",
                                   acts[k].instead, set->name)
                   : gn_check_fail(c, acts[k].key,
                                   "expected none beside couple.convert, as particles sleep and "
                                   "wake with the motion of their elements, which start at rest, "
                                   "found that of set '%s'",
                                   set->name);
    }
    return GNEISS_OK;
}

/* Elements do not press on walls: these stop what has come off. */
static gneiss_status check_convert_walls(const check *c, const gn_scene *s) {
    const gn_test_end *ends[] = {&s->test.lower, &s->test.upper};
    for (size_t k = 0; k < s->wall_count; k++)
        if (s->walls[k].servo.active)
            return gn_check_fail(c, "walls",
                                 "expected no servo of walls beside couple.convert, as elements do "
                                 "not press on them, found that of '%s'",
                                 s->walls[k].name);
    for (size_t e = 0; gn_scene_tested(s) && e < 2; e++)
        for (size_t k = 0; k < ends[e]->count; k++)
            if (gn_scene_find_wall(s, ends[e]->name[k]) >= 0)
                return gn_check_fail(c, e ? "test.upper" : "test.lower",
                                     "expected motions of elements beside couple.convert, as "
                                     "elements do not press on walls, found wall '%s'",
                                     ends[e]->name[k]);
    return GNEISS_OK;
}

/* What it does not go with, at the key that says so. */
static gneiss_status check_convert_beside(const check *c, const gn_scene *s, const gn_node *root) {
    const struct {
        bool found;
        const char *key, *expected, *instead;
    } others[] = {
        {s->couple.zone_count > 0, "couple.zones", "no couple.zones", "some"},
        {s->couple.constraint != GN_COUPLE_LUMPED, "couple.constraint",
         "no couple.constraint but lumped",
         s->couple.constraint == GN_COUPLE_PENALTY ? "penalty" : "consistent"},
        {s->body_count > 0, "bodies", "no bodies", "some"},
        {s->has_membrane, "membrane", "no membrane", "one"},
        {s->has_pulse, "initial.pulse", "no initial.pulse", "one"},
        {s->random_velocity > 0.0, "initial.random_velocity", "no initial.random_velocity", "some"},
        {s->elements.formulation == GN_FORMULATION_PRESSURE, "elements.formulation",
         "no mixed form", "mixed"},
        {s->bonds == GN_SWITCH_OFF, "bonds", "bonds that are on", "off"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(c, others[k].key, "expected %s beside couple.convert, found %s",
                                 others[k].expected, others[k].instead);
    GN_TRY(check_convert_walls(c, s));
    for (size_t k = 0; k < s->set_count; k++) {
        const check element = gn_check_element(c->reader, root, "sets", k);
        if (gn_check_element_sound(&element)) GN_TRY(check_convert_set(&element, &s->sets[k]));
    }
    return GNEISS_OK;
}

/* Without a box it is the region that was packed, with what rounding does to nodes on its sides. */
static gneiss_status set_box(const check *c, gn_scene *s) {
    gn_convert_def *q = &s->couple.convert;
    const gn_pack_def *pack = &s->specimen.pack;
    if (q->has_box) return GNEISS_OK;
    if (!pack->has_region)
        return gn_check_fail(c, "couple.convert.box",
                             "required where no specimen.packing.region is given, not given");
    for (int a = 0; a < (int)s->dimension; a++) {
        const double low = pack->region_min[a], high = pack->region_max[a];
        const double rounding = 1e-12 * fmax(fabs(low), fabs(high));
        q->box_min[a] = low - rounding;
        q->box_max[a] = high + rounding;
    }
    q->has_box = true;
    return GNEISS_OK;
}

static gneiss_status check_convert(const check *c, gn_scene *s, const gn_node *root) {
    const gn_convert_def *q = &s->couple.convert;
    GN_TRY(check_convert_beside(c, s, root));
    GN_TRY(set_box(c, s));
    if (!(q->stress > 0.0) && !q->has_mohr)
        return gn_check_fail(c, "couple.convert",
                             "expected a limit, stress or mohr_coulomb, found none");
    return gn_check_box(c, s, "couple.convert.box.max", q->box_min, q->box_max);
}

gneiss_status gn_check_couple(const gn_reader *reader, const gn_node *root) {
    gn_scene *s = reader->scene;
    check c = {.reader = reader, .map = root};
    if (s->has_pulse && gn_check_sound(&c, "initial.pulse"))
        GN_TRY(gn_check_keep(&c, check_pulse(&c, s)));
    if (!s->has_couple) return GNEISS_OK;
    GN_TRY(gn_check_keep(&c, check_beside(&c, s)));
    if (gn_check_sound(&c, "couple")) GN_TRY(gn_check_keep(&c, check_constraint(&c, s)));
    if (s->couple.has_convert && gn_check_sound(&c, "couple"))
        GN_TRY(gn_check_keep(&c, check_convert(&c, s, root)));
    if (!s->couple.zone_count && !s->couple.has_convert)
        return gn_check_fail(&c, "couple.zones", "expected one at least, found none");
    for (size_t k = 0; k < s->couple.zone_count; k++) {
        check element = gn_check_element(reader, root, "couple.zones", k);
        if (!gn_check_element_sound(&element)) continue;
        GN_TRY(gn_check_keep(&c, check_zone(&element, s, k)));
        GN_TRY(gn_check_keep(&c, check_other(&element, s, k)));
    }
    return GNEISS_OK;
}
