/* Conditions under which conversion ends a run; checks that particles can take the mass of the
 * converting elements. */
#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "conversion/conversion.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/dormant.h"
#include "particles/particles.h"
#include "scene/couple_def.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "solids/solids.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

static const char outside[] = "is not in couple.convert.box";
static const char driven[] = "has nodes of a motion or a load";
static const char watched[] = "which is only watched";
static const char too_light[] = "too much to be made up for by the";
static const char bare[] = "conversion would leave ";

bool gn_conversion_ended_at_box(const gn_ending *outcome) {
    return strstr(outcome->halt, outside);
}

bool gn_conversion_reached_watched(const gn_ending *outcome) {
    return strstr(outcome->halt, watched);
}

bool gn_conversion_lacked_mass(const gn_ending *outcome) {
    return strstr(outcome->halt, too_light);
}

bool gn_conversion_left_light_nodes(const gn_ending *outcome) {
    return strstr(outcome->halt, bare);
}

/* Returns the first side of the box beyond which an element lies. */
static const char *side_beyond(const gn_conversion *conversion, int64_t e, char *text,
                               size_t size) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const gn_convert_def *def = &conversion->model->ctx->scene.couple.convert;
    for (int k = 0; k < b->dimension; k++)
        for (int a = 0; a <= b->dimension; a++) {
            const size_t n = (size_t)gn_elements_node(&b->elements, a)[e];
            const double seen = gn_point_out(b->origin[k], b->nodes.start[4 * n + (size_t)k]);
            if (seen >= def->box_min[k] && seen <= def->box_max[k]) continue;
            snprintf(text, size, "%s %c", seen < def->box_min[k] ? "lower" : "upper", "xyz"[k]);
            return text;
        }
    return "";
}

/* Computes the centre of an element at the start. */
void gn_conversion_centre(const gn_fem_solid *solid, size_t e, double centre[3]) {
    memset(centre, 0, 3 * sizeof *centre);
    for (int a = 0; a <= solid->dimension; a++)
        for (size_t k = 0; k < 3; k++)
            centre[k] +=
                solid->nodes.start[4 * (size_t)gn_elements_node(&solid->elements, a)[e] + k] /
                (solid->dimension + 1);
}

/* Tells whether a node of an element belongs to a motion that only records. */
static bool watches(const gn_element_model *q, size_t motion, size_t e) {
    const gn_fem_set *set = &q->motion_set[motion];
    bool any = false;
    for (int a = 0; a <= q->solid.dimension && q->motion[motion] < 0; a++)
        for (size_t n = 0; n < set->count && !any; n++)
            any = set->node[n] == gn_elements_node(&q->solid.elements, a)[e];
    return any;
}

/* Returns the strongest use of any node of an element. */
static gn_node_use use_of(const gn_fem_solid *solid, const uint8_t *use, size_t e) {
    uint8_t most = GN_NODE_FREE;
    for (int a = 0; a <= solid->dimension; a++) {
        const uint8_t here = use[gn_elements_node(&solid->elements, a)[e]];
        if (here > most) most = here;
    }
    return (gn_node_use)most;
}

/* Writes what prevents the conversion of an element: a driving motion or a load if there is one,
 * else a motion that only records. */
static const char *held_by(const gn_solids *solids, size_t e, char *text, size_t size) {
    const gn_element_model *q = solids->elements[0];
    uint8_t *use = gn_alloc(q->solid.nodes.soa.count + 1);
    const char *said = driven;
    if (!use) return said;
    gn_elements_driven(q, use);
    for (size_t k = 0; use_of(&q->solid, use, e) == GN_NODE_WATCHED && k < q->def->motion_count;
         k++) {
        if (!watches(q, k, e)) continue;
        snprintf(text, size, "has nodes of motion '%.30s', %s", q->def->motions[k].name, watched);
        said = text;
        break;
    }
    gn_free(use);
    return said;
}

/* Ends the run; the model keeps all elements. */
void gn_conversion_halt_at(const gn_conversion *conversion, int64_t e) {
    const gn_convertible *model = conversion->model;
    const gn_fem_solid *b = gn_coupled_solid(model->solids);
    double centre[3];
    char at[GN_POINT_SIZE], side[16], by[128];
    gn_conversion_centre(b, (size_t)e, centre);
    const int length_used =
        snprintf(model->outcome->halt, sizeof model->outcome->halt,
                 "conversion would have to go on to element %d at %.80s m, which ",
                 b->elements.id[e], gn_point_text(b->origin, centre, at));
    const size_t left = sizeof model->outcome->halt - (size_t)length_used;
    if (conversion->kind[e] != GN_FRONT_FIXED)
        snprintf(model->outcome->halt + length_used, left, "%s",
                 held_by(model->solids, (size_t)e, by, sizeof by));
    else
        snprintf(model->outcome->halt + length_used, left,
                 "%s but beyond its %s side (a larger box, with a packing that fills it)", outside,
                 side_beyond(conversion, e, side, sizeof side));
}

/* --- masses --- */

/* Returns the change of an element's mass, kg; *whole: its mass at full weight. */
static double element_change(const gn_conversion *conversion, size_t e, double *whole) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const double mass = b->density[b->elements.material[e]] * b->elements.volume[e];
    double before = 0.0, now = 0.0;
    for (int a = 0; a <= b->dimension; a++) {
        const size_t n = 2 * (size_t)gn_elements_node(&b->elements, a)[e];
        before += conversion->node_part[n];
        now += b->nodes.blend[n];
    }
    *whole += mass;
    if (!conversion->touched[e] || !(before > 0.0)) return 0.0;
    return conversion->kind[e] == GN_FRONT_LEAVING ? -mass : mass * (now / before - 1.0);
}

/* Returns the mass of a particle by its weight, kg. */
static double particle_mass(const gn_conversion *conversion, size_t p) {
    const double before = conversion->part[2 * p + 1];
    return before > 0.0 ? 1.0 / (conversion->model->dem->particles.vel[4 * p + 3] * before)
                        : 1.0 / gn_dormant_of(conversion->model->dem, p)->inverse_mass;
}

/* Returns the change of the mass of a particle, kg, and adds the masses that can compensate for
 * missing mass to takes[2]: those of particles whose weight changes, and of particles in a zone
 * (conversion_masses.c). */
static double particle_change(const gn_conversion *conversion, size_t p, double takes[2]) {
    const gn_particles *q = &conversion->model->dem->particles;
    const double part = q->blend[2 * p + 1], before = conversion->part[2 * p + 1];
    const int32_t e = gn_home_of(conversion, p);
    if (!(part > 0.0)) return 0.0;
    const double whole = particle_mass(conversion, p);
    if (part != before) takes[0] += part * whole;
    if (e >= 0 && conversion->kind[e] != GN_FRONT_LEAVING) takes[1] += part * whole;
    return (part - before) * whole;
}

bool gn_conversion_fits(const gn_conversion *conversion, double missing[2]) {
    const gn_convertible *model = conversion->model;
    double whole = 0.0, change = 0.0, takes[2] = {0.0};
    for (size_t e = 0; e < gn_elements_left_count(model->solids); e++)
        change += element_change(conversion, e, &whole);
    for (size_t p = 0; p < model->dem->particles.soa.count; p++)
        change += particle_change(conversion, p, takes);
    missing[0] = -change;
    missing[1] = fmax(takes[0], takes[1]);
    return fabs(change) <= fmax(GN_MASS_SCALED_MOST * missing[1], 1e-12 * whole);
}

bool gn_conversion_add_ring(const gn_conversion *conversion) {
    const gn_elements *q = &gn_coupled_solid(conversion->model->solids)->elements;
    const int corners = gn_coupled_solid(conversion->model->solids)->dimension + 1;
    uint8_t *at = conversion->reached;
    bool any = false;
    memset(at, 0, gn_coupled_solid(conversion->model->solids)->nodes.soa.count);
    for (size_t e = 0; e < q->soa.count; e++)
        for (int a = 0; a < corners && conversion->kind[e] == GN_FRONT_LEAVING; a++)
            at[gn_elements_node(q, a)[e]] = 1;
    for (size_t e = 0; e < q->soa.count; e++) {
        bool beside = false;
        for (int a = 0; a < corners; a++) beside = beside || at[gn_elements_node(q, a)[e]];
        if (!beside || conversion->kind[e] != GN_FRONT_READY) continue;
        conversion->kind[e] = GN_FRONT_LEAVING;
        any = true;
    }
    return any;
}

void gn_conversion_halt_without_mass(const gn_conversion *conversion, const double missing[2]) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    size_t e = 0;
    double centre[3];
    char at[GN_POINT_SIZE];
    while (e + 1 < b->elements.soa.count && conversion->kind[e] != GN_FRONT_LEAVING) e++;
    gn_conversion_centre(b, e, centre);
    snprintf(conversion->model->outcome->halt, sizeof conversion->model->outcome->halt,
             "conversion at element %d at %.80s m would change the mass of the body by %.2g kg, "
             "%s %.2g kg of particles there",
             b->elements.id[e], gn_point_text(b->origin, centre, at), -missing[0], too_light,
             missing[1]);
}

/* --- elements that may not convert --- */

/* Computes masses of nodes [nodes][2], kg: the mass that the remaining elements would contribute at
 * full weight, and the mass that they and the particles in them contribute with the weights found.
 */
static void weigh_nodes(const gn_conversion *conversion, double (*mass)[2]) {
    const gn_particles *q = &conversion->model->dem->particles;
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const int corners = b->dimension + 1;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double before = 0.0, now = 0.0;
        for (int a = 0; a < corners; a++) {
            const size_t n = 2 * (size_t)gn_elements_node(&b->elements, a)[e];
            before += conversion->node_part[n] / corners;
            now += b->nodes.blend[n] / corners;
        }
        const double whole =
            b->density[b->elements.material[e]] * b->elements.volume[e] / before / corners;
        for (int a = 0; a < corners && conversion->kind[e] != GN_FRONT_LEAVING; a++) {
            double *at = mass[gn_elements_node(&b->elements, a)[e]];
            at[0] += whole;
            at[1] += now * whole;
        }
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        const int32_t e = gn_home_of(conversion, p);
        if (!(q->blend[2 * p + 1] > 0.0) || e < 0 || conversion->kind[e] == GN_FRONT_LEAVING)
            continue;
        const gn_tie tie = gn_tie_at(b, e, q->start + 4 * p);
        for (int a = 0; a < corners; a++)
            mass[tie.node[a]][1] +=
                tie.shape[a] * q->blend[2 * p + 1] * particle_mass(conversion, p);
    }
}

/* Returns r/width with the mean radius r, which is the least mass weight in zones (find_parts). */
static double least_part(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) sum += q->pos[4 * p + 3];
    return fmin(1.0, sum / (double)q->soa.count / ctx->scene.couple.convert.width);
}

/* Tells whether elements that may not convert have a changed weight; in most conversions the front
 * is far from them. */
static bool holds_shared(const gn_conversion *conversion) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    for (size_t e = 0; e < b->elements.soa.count; e++)
        for (int a = 0; a <= b->dimension && conversion->kind[e] == GN_FRONT_HELD; a++)
            if (b->nodes.blend[2 * (size_t)gn_elements_node(&b->elements, a)[e]] < 1.0) return true;
    return false;
}

static void halt_at_light_node(const gn_conversion *conversion, size_t e, double share) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    double centre[3];
    char at[GN_POINT_SIZE], by[128];
    gn_conversion_centre(b, e, centre);
    snprintf(conversion->model->outcome->halt, sizeof conversion->model->outcome->halt,
             "%s%.2g of the body's mass at a node of element %d at %.80s m, which %s", bare, share,
             b->elements.id[e], gn_point_text(b->origin, centre, at),
             held_by(conversion->model->solids, e, by, sizeof by));
}

gneiss_status gn_conversion_find_light_nodes(const gn_conversion *conversion, bool *found,
                                             gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    *found = false;
    if (!holds_shared(conversion)) return GNEISS_OK;
    const double least = least_part(conversion->model->ctx, conversion->model->dem);
    double(*mass)[2] = gn_alloc_array(b->nodes.soa.count + 1, sizeof *mass), share = least;
    size_t at = 0;
    if (!mass) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to convert elements");
    weigh_nodes(conversion, mass);
    for (size_t e = 0; e < b->elements.soa.count; e++)
        for (int a = 0; a <= b->dimension && conversion->kind[e] == GN_FRONT_HELD; a++) {
            const double *of = mass[gn_elements_node(&b->elements, a)[e]];
            if (!(of[1] < share * of[0])) continue;
            share = of[1] / of[0];
            at = e;
        }
    gn_free(mass);
    *found = share < least;
    if (*found) halt_at_light_node(conversion, at, share);
    return GNEISS_OK;
}

/* --- motions that only record --- */

/* Marks the nodes [nodes] of elements that could convert if no motion recorded their displacements,
 * then these motions [motions]. */
static void find_watching(const gn_element_model *q, const uint8_t *kind, const uint8_t *use,
                          uint8_t *node, uint8_t *found) {
    const gn_elements *elements = &q->solid.elements;
    for (size_t e = 0; e < elements->soa.count; e++)
        if (kind[e] == GN_FRONT_HELD && use_of(&q->solid, use, e) == GN_NODE_WATCHED)
            for (int a = 0; a <= q->solid.dimension; a++)
                node[gn_elements_node(elements, a)[e]] = 1;
    for (size_t k = 0; k < q->def->motion_count; k++)
        for (size_t n = 0; n < q->motion_set[k].count && q->motion[k] < 0; n++)
            found[k] = found[k] || node[q->motion_set[k].node[n]];
}

static void describe_watching(const gn_element_model *q, const uint8_t *found, char *text,
                              size_t size) {
    enum { NAMED = 3 };
    char names[3 * 80] = "";
    size_t count = 0, used = 0;
    for (size_t k = 0; k < q->def->motion_count; k++) {
        if (!found[k] || count++ >= NAMED) continue;
        used += (size_t)snprintf(names + used, sizeof names - used, "%s'%.60s'", used ? ", " : "",
                                 q->def->motions[k].name);
    }
    if (!count) return;
    snprintf(text, size,
             "%s%s, which only watch%s (elements.motions), ha%s nodes in couple.convert.box: "
             "elements there stay, and conversion that comes to them ends the run; sets of "
             "particles, which may be dormant, can watch instead (sets: select without motion)",
             names, count > NAMED ? " and others" : "", count == 1 ? "es" : "",
             count == 1 ? "s" : "ve");
}

const char *gn_conversion_watches(const gn_step_context *ctx, const gn_solids *solids, char *text,
                                  size_t size) {
    const size_t elements = gn_converts(ctx) ? gn_elements_left_count(solids) : 0;
    *text = '\0';
    if (!elements) return text;
    const gn_element_model *q = solids->elements[0];
    const size_t nodes = q->solid.nodes.soa.count;
    uint8_t *kind = gn_alloc(elements + 1), *use = gn_alloc(2 * nodes + 1),
            *found = gn_alloc(q->def->motion_count + 1);
    if (kind && use && found && gn_conversion_kinds(ctx, solids, kind, NULL) == GNEISS_OK) {
        gn_elements_driven(q, use);
        find_watching(q, kind, use, use + nodes, found);
        describe_watching(q, found, text, size);
    }
    gn_free(kind);
    gn_free(use);
    gn_free(found);
    return text;
}
