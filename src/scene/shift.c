/* Points of a scene relative to its origin. Every key that is a point in space has its line here,
 * but for the boxes that select particles and nodes. */
#include "scene/scene.h"

static void shift(const gn_scene *s, double *point) {
    for (int64_t a = 0; a < s->dimension; a++) point[a] -= s->origin[a];
}

static void shift_rows(const gn_scene *s, double *rows, size_t count, size_t width) {
    for (size_t k = 0; rows && k < count; k++)
        for (size_t a = 0; a < (size_t)s->dimension; a++) rows[width * k + a] -= s->origin[a];
}

static void shift_specimen(gn_scene *s) {
    gn_specimen *p = &s->specimen;
    shift(s, p->lattice.origin);
    shift_rows(s, p->particles, p->particle_count, 4);
    if (p->pack.shape == GN_SHAPE_NONE) return;
    shift_rows(s, p->pack.corners, p->pack.corner_count, 2);
    if (p->pack.shape != GN_SHAPE_POLYGON) shift(s, p->pack.origin);
    for (size_t k = 0; k < p->pack.refinement_count; k++) {
        if (!p->pack.refinements[k].has_region) continue;
        shift(s, p->pack.refinements[k].lower);
        shift(s, p->pack.refinements[k].upper);
    }
}

/* The points of a body's shape are relative to the body's own origin. */
static void shift_bodies(gn_scene *s) {
    for (size_t k = 0; k < s->body_count; k++) {
        shift(s, s->bodies[k].origin);
        if (s->bodies[k].has_reference) shift(s, s->bodies[k].reference);
    }
}

static void shift_region(const gn_scene *s, gn_flow_region *r) {
    shift_rows(s, r->corners, r->corner_count, 2);
    if (!r->corner_count) shift(s, r->origin);
}

static void shift_flow(gn_scene *s) {
    for (size_t k = 0; k < s->source_count; k++) shift_region(s, &s->sources[k].region);
    for (size_t k = 0; k < s->sink_count; k++) {
        shift_region(s, &s->sinks[k].region);
        if (s->sinks[k].has_plane) shift(s, s->sinks[k].point);
    }
}

void gn_scene_shift(gn_scene *s) {
    if (s->has_specimen) shift_specimen(s);
    shift_flow(s);
    if (s->has_elements) {
        shift(s, s->elements.origin);
        shift(s, s->elements.beam.origin);
    }
    for (size_t z = 0; z < s->couple.zone_count; z++)
        for (size_t e = 0; e < s->couple.zones[z].edge_count; e++) {
            shift(s, s->couple.zones[z].edges[e].from);
            shift(s, s->couple.zones[z].edges[e].to);
        }
    if (s->has_pulse) shift(s, s->pulse.centre);
    if (s->has_periodic) {
        shift(s, s->periodic_min);
        shift(s, s->periodic_max);
    }
    if (s->has_domain) {
        shift(s, s->domain_min);
        shift(s, s->domain_max);
    }
    for (size_t k = 0; k < s->wall_count; k++) shift(s, s->walls[k].point);
    shift_bodies(s);
}
