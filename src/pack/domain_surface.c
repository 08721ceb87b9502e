/* The boundary near a point, for bodies bounded by facets. */
#include "pack/domain_facets.h"

#include <math.h>

/* Relative to the extent. Feet that round-off places beside their facet still count; planes that
 * differ less in depth (and less than 1e-3 in direction) are one. */
static const double foot_slack = 1e-10, same_depth = 1e-6, same_direction = 5e-7;

typedef struct gathering {
    const double *x;
    double reach, nearest; /* m; nearest: distance of the boundary */
    gn_domain_plane *planes;
    int count;
} gathering;

typedef struct sight {
    const double *from, *to;
    double slack;
} sight;

/* Tells whether the line of sight enters the body through one of these facets. */
static bool visit_sight(const gn_facets *facets, int32_t first, int32_t count, void *context) {
    const sight *line = context;
    for (int32_t i = first; i < first + count; i++) {
        const gn_facet *f = &facets->facet[i];
        double u[3], v[3], at[3];
        gn_minus(line->from, f->corner[0], u);
        gn_minus(line->to, f->corner[0], v);
        double before = gn_dot(u, f->normal), after = gn_dot(v, f->normal);
        if (!(before > line->slack && after < -line->slack) || (f->flags & GN_FACET_NEEDLE))
            continue;
        double t = before / (before - after);
        for (int k = 0; k < 3; k++) at[k] = line->from[k] + t * (line->to[k] - line->from[k]);
        if (gn_facet_faces(f, facets->corners, at, line->slack)) return true;
    }
    return false;
}

/* Tells whether another part of the boundary lies between x and the foot (a slot, a second lobe).
 * The last crossing before a foot that is approached from inside enters the body. */
static bool hidden(const gn_facets *facets, const double x[3], const double foot[3]) {
    sight line = {x, foot, foot_slack * facets->size};
    double lower[3], upper[3];
    for (int k = 0; k < 3; k++) {
        lower[k] = fmin(x[k], foot[k]);
        upper[k] = fmax(x[k], foot[k]);
    }
    return gn_tree_within(facets, lower, upper, line.slack, visit_sight, &line);
}

static bool same_plane(const gn_facets *facets, const gn_domain_plane *a,
                       const gn_domain_plane *b) {
    return fabs(a->depth - b->depth) <= same_depth * facets->size &&
           gn_dot(a->normal, b->normal) > 1 - same_direction;
}

/* Keeps the nearest planes in order; of two equal ones, the nearer or the earlier. */
static void take(const gn_facets *facets, gathering *gathered, gn_domain_plane plane) {
    int at = 0;
    for (int i = 0; i < gathered->count; i++) {
        if (!same_plane(facets, &gathered->planes[i], &plane)) continue;
        if (gathered->planes[i].depth <= plane.depth) return;
        gathered->count--;
        for (int j = i; j < gathered->count; j++) gathered->planes[j] = gathered->planes[j + 1];
        break;
    }
    while (at < gathered->count && gathered->planes[at].depth <= plane.depth) at++;
    if (at == GN_DOMAIN_PLANES) return;
    if (plane.depth > gathered->nearest + foot_slack * facets->size) {
        double foot[3];
        for (int k = 0; k < 3; k++) foot[k] = gathered->x[k] - plane.depth * plane.normal[k];
        if (hidden(facets, gathered->x, foot)) return;
    }
    if (gathered->count < GN_DOMAIN_PLANES) gathered->count++;
    for (int j = gathered->count - 1; j > at; j--) gathered->planes[j] = gathered->planes[j - 1];
    gathered->planes[at] = plane;
}

/* Adds the point `foot` of a re-entrant edge or corner. If x is on it, the adjacent facets replace
 * it, since the direction from the foot would be round-off. */
static void take_point(const gn_facets *facets, gathering *gathered, const double away[3]) {
    double distance = sqrt(gn_dot(away, away));
    if (distance > gathered->reach || distance <= foot_slack * facets->size) return;
    gn_domain_plane plane = {.depth = distance};
    for (int k = 0; k < 3; k++) plane.normal[k] = away[k] / distance;
    take(facets, gathered, plane);
}

/* Adds an edge if the distance to neither of its facets decreases away from it. */
static void try_crease(const gn_facets *facets, gathering *gathered, const gn_facet *facet,
                       int edge) {
    const gn_facet *sides[2] = {facet, &facets->facet[facet->neighbour[edge] >> 2]};
    const double *a = facet->corner[edge], *b = facet->corner[gn_next(edge)];
    double along[3], away[3], inward[3], slack = foot_slack * facets->size;
    gn_minus(b, a, along);
    gn_minus(gathered->x, a, away);
    double length2 = gn_dot(along, along), length = sqrt(length2), t = gn_dot(away, along);
    if (t < -slack * length || t > length2 + slack * length) return;
    t = fmin(fmax(t / length2, 0), 1);
    for (int k = 0; k < 3; k++) away[k] -= t * along[k];
    for (int i = 0; i < 2; i++) {
        gn_cross(sides[i]->normal, along, inward);
        double towards = gn_dot(inward, away);
        if ((i ? -towards : towards) > slack * length) return;
    }
    take_point(facets, gathered, away);
}

/* Adds a node if the distance along no edge from it decreases; then that along no facet does. */
static void try_tip(const gn_facets *facets, gathering *gathered, const gn_facet *facet,
                    int corner) {
    const double *tip = facet->corner[corner];
    int32_t node = facet->node[corner];
    double away[3], edge[3];
    gn_minus(gathered->x, tip, away);
    bool pinched = facet->flags & ((uint32_t)GN_FACET_PINCHED_0 << corner);
    if (!pinched && gn_dot(away, facets->node_normal + 3 * (size_t)node) > 0) return;
    for (int32_t i = facets->star_first[node]; i < facets->star_first[node + 1]; i++) {
        const gn_facet *beside = &facets->facet[facets->star[i] >> 2];
        int here = facets->star[i] & 3, there = facets->corners == 2 ? 1 - here : gn_next(here);
        gn_minus(beside->corner[there], tip, edge);
        double towards = gn_dot(edge, away);
        if (towards > foot_slack * facets->size * sqrt(gn_dot(edge, edge))) return;
    }
    take_point(facets, gathered, away);
}

static bool visit_gather(const gn_facets *facets, int32_t first, int32_t count, void *context) {
    gathering *g = context;
    for (int32_t i = first; i < first + count; i++) {
        const gn_facet *f = &facets->facet[i];
        double v[3];
        gn_minus(f->corner[0], g->x, v);
        double depth = gn_dot(v, f->normal);
        if (depth >= 0 && depth <= g->reach && !(f->flags & GN_FACET_NEEDLE) &&
            gn_facet_faces(f, facets->corners, g->x, foot_slack * facets->size))
            take(facets, g,
                 (gn_domain_plane){{-f->normal[0], -f->normal[1], -f->normal[2]}, depth});
        uint32_t flags = f->flags;
        if (!(flags & 63)) continue;
        for (int k = 0; k < 3; k++) {
            if (flags & ((uint32_t)GN_FACET_CREASE_0 << k)) try_crease(facets, g, f, k);
            if (flags & ((uint32_t)GN_FACET_TIP_0 << k)) try_tip(facets, g, f, k);
        }
    }
    return false;
}

static gn_foot nearest(const gn_facets *facets, const double x[3]) {
    double depth, offset, limit = INFINITY;
    if (gn_facets_known(facets, x, &depth, &offset)) limit = 1.001 * (fabs(depth) + offset);
    return gn_tree_nearest(facets, x, limit);
}

double gn_facets_depth(const gn_facets *facets, const double x[3]) {
    double at[3] = {x[0], x[1], facets->corners == 2 ? 0 : x[2]};
    gn_foot foot = nearest(facets, at);
    if (foot.facet < 0) return -INFINITY;
    return gn_facets_signed(facets, at, &foot);
}

/* Returns the plane of the nearest point alone. */
static gn_domain_plane nearest_plane(const gn_facets *facets, const double x[3],
                                     const gn_foot *foot, double depth) {
    const gn_facet *f = &facets->facet[foot->facet];
    gn_domain_plane plane = {.depth = depth};
    bool on = foot->feature == 0 || fabs(depth) <= foot_slack * facets->size;
    for (int k = 0; k < 3; k++) plane.normal[k] = on ? -f->normal[k] : (x[k] - foot->at[k]) / depth;
    return plane;
}

int gn_facets_planes(const gn_facets *facets, const double point[3], double reach,
                     gn_domain_plane planes[GN_DOMAIN_PLANES]) {
    double x[3] = {point[0], point[1], facets->corners == 2 ? 0 : point[2]};
    double known, offset;
    if (gn_facets_known(facets, x, &known, &offset) && known - offset > reach) return 0;
    gn_foot foot = nearest(facets, x);
    if (foot.facet < 0) return 0;
    double depth = gn_facets_signed(facets, x, &foot);
    if (depth > reach) return 0;
    if (depth < 0) {
        planes[0] = nearest_plane(facets, x, &foot, depth);
        return 1;
    }
    gathering g = {.x = x, .reach = reach, .nearest = depth, .planes = planes};
    /* A foot exactly at the reach must not be lost by the rounding of its box's distance. */
    gn_tree_within(facets, x, x, reach + foot_slack * facets->size, visit_gather, &g);
    /* If round-off lost the foot between facets, the nearest point is still known. */
    if (!g.count) planes[g.count++] = nearest_plane(facets, x, &foot, depth);
    return g.count;
}
