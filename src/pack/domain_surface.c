/* The boundary near a point, for bodies bounded by facets. */
#include "base/new.h"
#include "pack/domain_facets.h"

#include <math.h>

/* ---- signed distance from the boundary ---- */

/* Approximate number of cells of the grid of known depths. */
enum { KNOWN_CELLS = 1 << 16 };

/* Returns the squared distance of p from edge k of f. */
static double edge_distance2(const gn_facet *facet, int k, const double p[3]) {
    double edge[3], v[3];
    gn_minus(facet->corner[gn_next(k)], facet->corner[k], edge);
    gn_minus(p, facet->corner[k], v);
    double t = gn_dot(v, edge) / gn_dot(edge, edge);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int i = 0; i < 3; i++) v[i] -= t * edge[i];
    return gn_dot(v, v);
}

/* Finds the facet on the other side of an edge at p, skipping needles, which have no area. */
static const gn_facet *facet_across(const gn_facets *surface, int32_t half, const double p[3]) {
    for (int hops = 0; hops < 16 && (surface->facet[half >> 2].flags & GN_FACET_NEEDLE); hops++) {
        const gn_facet *needle = &surface->facet[half >> 2];
        int a = gn_next(half & 3), b = gn_next(a);
        half =
            needle->neighbour[edge_distance2(needle, a, p) <= edge_distance2(needle, b, p) ? a : b];
    }
    return &surface->facet[half >> 2];
}

/* Tells whether x is inside, by the solid angle of all facets (Van Oosterom & Strackee 1983, eq. 8)
 * or the angle of all segments. This is slow, but requires no topology. */
static bool winds_round(const gn_facets *surface, const double x[3]) {
    double sum = 0;
    for (size_t i = 0; i < surface->count; i++) {
        double v[3][3], cross[3], r[3] = {0, 0, 0};
        for (int c = 0; c < surface->corners; c++) {
            gn_minus(surface->facet[i].corner[c], x, v[c]);
            r[c] = sqrt(gn_dot(v[c], v[c]));
        }
        gn_cross(v[0], v[1], cross);
        if (surface->corners == 2) {
            sum += atan2(cross[2], gn_dot(v[0], v[1]));
            continue;
        }
        double below = r[0] * r[1] * r[2] + gn_dot(v[0], v[1]) * r[2] + gn_dot(v[1], v[2]) * r[0] +
                       gn_dot(v[2], v[0]) * r[1];
        sum += 2 * atan2(gn_dot(cross, v[2]), below);
    }
    double whole = acos(-1.0) * (surface->corners == 2 ? 2 : 4);
    return sum > 0.5 * whole;
}

/* Returns the distance of x from the foot, positive inside. */
static double facets_signed(const gn_facets *surface, const double x[3], const gn_foot *foot) {
    const gn_facet *f = &surface->facet[foot->facet];
    double v[3], side, distance = sqrt(foot->distance2);
    gn_minus(x, foot->at, v);
    if (foot->feature == 0) {
        /* The foot is a projection: if x is close to the facet, its offset from x is round-off. */
        gn_minus(x, f->corner[0], v);
        side = gn_dot(v, f->normal);
    } else if (foot->feature < 4) {
        const gn_facet *g = facet_across(surface, f->neighbour[foot->feature - 1], foot->at);
        side = gn_dot(v, f->normal) + gn_dot(v, g->normal);
    } else {
        int corner = foot->feature - 4;
        if (f->flags & ((uint32_t)GN_FACET_PINCHED_0 << corner))
            return winds_round(surface, x) ? distance : -distance;
        side = gn_dot(v, surface->node_normal + 3 * f->node[corner]);
    }
    return side > 0 ? -distance : distance;
}

/* Looks up the depth at the centre of the cell that contains x, and the distance to that centre;
 * returns false outside of the grid. */
static bool facets_known(const gn_facets *surface, const double x[3], double *depth,
                         double *offset) {
    if (!surface->known) return false;
    size_t index = 0;
    double sum = 0;
    for (int k = surface->corners - 1; k >= 0; k--) {
        double place = (x[k] - surface->origin[k]) / surface->cell;
        if (!(place >= 0 && place < surface->cells[k])) return false;
        int i = (int)place;
        index = index * (size_t)surface->cells[k] + (size_t)i;
        double off = (place - i - 0.5) * surface->cell;
        sum += off * off;
    }
    *depth = (double)surface->known[index];
    /* The added term covers the rounding of the stored depth. */
    *offset = sqrt(sum) + 1e-6 * surface->size;
    return true;
}

gneiss_status gn_facets_know(gn_facets *surface, gneiss_error *error) {
    int dimension = surface->corners;
    double product = 1;
    for (int k = 0; k < dimension; k++)
        product *= fmax(surface->upper[k] - surface->lower[k], 1e-3 * surface->size);
    double cell = pow(product / KNOWN_CELLS, 1.0 / dimension);
    size_t count = 1;
    for (int k = 0; k < 3; k++) {
        surface->cells[k] =
            k < dimension ? (int)ceil((surface->upper[k] - surface->lower[k]) / cell + 0.01) : 1;
        double middle = 0.5 * (surface->lower[k] + surface->upper[k]);
        surface->origin[k] = middle - 0.5 * cell * surface->cells[k];
        count *= (size_t)surface->cells[k];
    }
    float *known = NULL;
    GN_TRY(gn_new(&known, count, "a grid of depths", error));
    double last = 0;
    for (size_t i = 0; i < count; i++) {
        size_t row = i / (size_t)surface->cells[0];
        size_t place[3] = {i % (size_t)surface->cells[0], row % (size_t)surface->cells[1],
                           row / (size_t)surface->cells[1]};
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = surface->origin[k] + ((double)place[k] + 0.5) * cell;
        if (dimension == 2) x[2] = 0;
        /* The previous centre is one cell away, so that the boundary is farther by at most that
         * distance. */
        double limit = place[0] ? fabs(last) + 1.001 * cell : INFINITY;
        gn_foot foot = gn_tree_nearest(surface, x, limit);
        last = facets_signed(surface, x, &foot);
        known[i] = (float)last;
    }
    surface->cell = cell;
    surface->known = known;
    return GNEISS_OK;
}

/* ---- detection of intersecting facets, which do not define an inside ---- */

/* Tolerances relative to the extent. Edges of a polygon may not touch; triangles may, up to the
 * tolerance of welding. */
static const double touch_tolerance = 1e-12, cut_tolerance = 1e-6;

typedef struct cut_search {
    int32_t facet, other; /* index of the other facet, the result */
    double tolerance, at[3];
} cut_search;

static int shared_nodes(const gn_facet *a, const gn_facet *b, int corners) {
    int shared = 0;
    for (int i = 0; i < corners; i++)
        for (int j = 0; j < corners; j++) shared += a->node[i] == b->node[j];
    return shared;
}

/* Tells whether p is within `tolerance` of the segment; if so, copies it to `at`. */
static bool on_segment(const gn_facet *facet, const double p[3], double tolerance, double at[3]) {
    double edge[3], v[3];
    gn_minus(facet->corner[1], facet->corner[0], edge);
    gn_minus(p, facet->corner[0], v);
    double t = gn_dot(v, edge) / gn_dot(edge, edge);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 3; k++) {
        v[k] -= t * edge[k];
        at[k] = p[k];
    }
    return gn_dot(v, v) <= tolerance * tolerance;
}

/* Returns the z component of (b - a) x (p - a), whose sign tells on which side of the segment p is.
 */
static double side_of(const gn_facet *facet, const double p[3]) {
    const double *a = facet->corner[0], *b = facet->corner[1];
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

static bool segments_meet(const gn_facet *a, const gn_facet *b, double tolerance, double at[3]) {
    int shared = shared_nodes(a, b, 2);
    for (int c = 0; c < 2; c++) {
        bool free_b = b->node[c] != a->node[0] && b->node[c] != a->node[1];
        bool free_a = a->node[c] != b->node[0] && a->node[c] != b->node[1];
        if (free_b && on_segment(a, b->corner[c], tolerance, at)) return true;
        if (free_a && on_segment(b, a->corner[c], tolerance, at)) return true;
    }
    if (shared) return shared == 2 && on_segment(a, b->corner[0], tolerance, at);
    double a0 = side_of(b, a->corner[0]), a1 = side_of(b, a->corner[1]);
    double b0 = side_of(a, b->corner[0]), b1 = side_of(a, b->corner[1]);
    if ((a0 > 0) == (a1 > 0) || (b0 > 0) == (b1 > 0)) return false;
    double t = a0 / (a0 - a1);
    for (int k = 0; k < 3; k++) at[k] = a->corner[0][k] + t * (a->corner[1][k] - a->corner[0][k]);
    return true;
}

/* Tells whether the axis separates the triangles, or shows that they only touch within the
 * tolerance. A short axis (a product of nearly parallel edges; `scale` is the product of their
 * lengths) proves nothing. */
static bool apart(const double axis[3], double scale, const gn_facet *a, const gn_facet *b,
                  double tolerance) {
    double length = sqrt(gn_dot(axis, axis)), low[2], high[2];
    if (length <= 1e-9 * scale) return false;
    for (int t = 0; t < 2; t++) {
        low[t] = INFINITY, high[t] = -INFINITY;
        for (int c = 0; c < 3; c++) {
            double v[3];
            gn_minus((t ? b : a)->corner[c], a->corner[0], v);
            low[t] = fmin(low[t], gn_dot(axis, v));
            high[t] = fmax(high[t], gn_dot(axis, v));
        }
    }
    /* The displacement along the axis that separates both triangles; a triangle has no width along
     * its normal. */
    return fmin(high[0] - low[1], high[1] - low[0]) <= tolerance * length;
}

static bool coplanar(const gn_facet *a, const gn_facet *b, double tolerance) {
    for (int c = 0; c < 3; c++) {
        double v[3];
        gn_minus(b->corner[c], a->corner[0], v);
        if (fabs(gn_dot(v, a->normal)) > tolerance) return false;
    }
    return true;
}

/* Tells whether triangles intersect, by separating axes (Gottschalk, Lin & Manocha 1996): convex
 * bodies are separate if one of the normals or one of the products of edges separates them; in a
 * common plane, one of the normals of edges. */
static bool triangles_cut(const gn_facet *a, const gn_facet *b, double tolerance) {
    double edge[2][3][3], axis[3];
    bool flat = coplanar(a, b, tolerance) || coplanar(b, a, tolerance);
    for (int c = 0; c < 3; c++) {
        gn_minus(a->corner[gn_next(c)], a->corner[c], edge[0][c]);
        gn_minus(b->corner[gn_next(c)], b->corner[c], edge[1][c]);
    }
    if (!flat && (apart(a->normal, 1, a, b, tolerance) || apart(b->normal, 1, a, b, tolerance)))
        return false;
    for (int i = 0; i < 6 && flat; i++) {
        const double *along = edge[i / 3][i % 3];
        gn_cross(a->normal, along, axis);
        if (apart(axis, sqrt(gn_dot(along, along)), a, b, tolerance)) return false;
    }
    for (int i = 0; i < 9 && !flat; i++) {
        const double *u = edge[0][i / 3], *v = edge[1][i % 3];
        gn_cross(u, v, axis);
        if (apart(axis, sqrt(gn_dot(u, u) * gn_dot(v, v)), a, b, tolerance)) return false;
    }
    return true;
}

/* Finds a point of the intersection: where an edge of one triangle passes through the other, or, in
 * a common plane, the centre of the common part of both boxes. */
static void cut_point(const gn_facet *a, const gn_facet *b, double tolerance, double at[3]) {
    for (int i = 0; i < 6; i++) {
        const gn_facet *f = i < 3 ? a : b, *g = i < 3 ? b : a;
        const double *p = f->corner[i % 3], *q = f->corner[gn_next(i % 3)];
        double u[3], v[3];
        gn_minus(p, g->corner[0], u);
        gn_minus(q, g->corner[0], v);
        double before = gn_dot(u, g->normal), after = gn_dot(v, g->normal);
        if ((before > 0) == (after > 0)) continue;
        double t = before / (before - after);
        for (int k = 0; k < 3; k++) at[k] = p[k] + t * (q[k] - p[k]);
        if (gn_facet_faces(g, 3, at, tolerance)) return;
    }
    for (int k = 0; k < 3; k++) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int c = 0; c < 6; c++) {
            double value = (c < 3 ? a : b)->corner[c % 3][k];
            low[c / 3] = fmin(low[c / 3], value);
            high[c / 3] = fmax(high[c / 3], value);
        }
        at[k] = 0.5 * (fmax(low[0], low[1]) + fmin(high[0], high[1]));
    }
}

static bool visit(const gn_facets *facets, int32_t first, int32_t count, void *context) {
    cut_search *search = context;
    const gn_facet *a = &facets->facet[search->facet];
    for (int32_t i = first; i < first + count; i++) {
        const gn_facet *b = &facets->facet[i];
        if (i <= search->facet) continue;
        bool found;
        if (facets->corners == 2) {
            found = segments_meet(a, b, search->tolerance, search->at);
        } else {
            /* A needle has no interior; its neighbours are tested instead. */
            found = !((a->flags | b->flags) & GN_FACET_NEEDLE) && !shared_nodes(a, b, 3) &&
                    triangles_cut(a, b, search->tolerance);
            if (found) cut_point(a, b, search->tolerance, search->at);
        }
        if (!found) continue;
        search->other = i;
        return true;
    }
    return false;
}

static gneiss_status refuse(const gn_facets *facets, const cut_search *search, const char *name,
                            gneiss_error *error) {
    const gn_facet *a = &facets->facet[search->facet], *b = &facets->facet[search->other];
    if (a->id > b->id) {
        const gn_facet *swap = a;
        a = b;
        b = swap;
    }
    if (facets->corners == 3)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a surface that does not cut itself; triangles %d and %d (of "
                       "%zu) meet at (%g, %g, %g)",
                       name, a->id + 1, b->id + 1, facets->count, search->at[0], search->at[1],
                       search->at[2]);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a boundary that does not cross or touch itself; edge %d from (%g, "
                   "%g) to (%g, %g) and edge %d from (%g, %g) to (%g, %g) meet at (%g, %g)",
                   name, a->id + 1, a->corner[0][0], a->corner[0][1], a->corner[1][0],
                   a->corner[1][1], b->id + 1, b->corner[0][0], b->corner[0][1], b->corner[1][0],
                   b->corner[1][1], search->at[0], search->at[1]);
}

gneiss_status gn_facets_check_cuts(const gn_facets *facets, const char *name, gneiss_error *error) {
    cut_search search = {.tolerance = facets->size *
                                      (facets->corners == 2 ? touch_tolerance : cut_tolerance)};
    for (size_t i = 0; i < facets->count; i++) {
        const gn_facet *f = &facets->facet[i];
        double lower[3], upper[3];
        for (int k = 0; k < 3; k++) {
            lower[k] = INFINITY, upper[k] = -INFINITY;
            for (int c = 0; c < facets->corners; c++) {
                lower[k] = fmin(lower[k], f->corner[c][k]);
                upper[k] = fmax(upper[k], f->corner[c][k]);
            }
        }
        search.facet = (int32_t)i;
        if (gn_tree_within(facets, lower, upper, 2 * search.tolerance, visit, &search))
            return refuse(facets, &search, name, error);
    }
    return GNEISS_OK;
}

/* Tolerances relative to the extent. A foot that round-off places beside its facet still counts;
 * planes that differ by less in depth (and by less than 1e-3 in direction) count as one. */
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
 * Just before a foot that is visible from inside, the line must be in the body; an entry into the
 * body on the way means that it left it before. */
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

/* Keeps the nearest planes in order; of two equal planes the nearer or the earlier one stays. */
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
 * it, because the direction from the foot would be round-off. */
static void take_point(const gn_facets *facets, gathering *gathered, const double away[3]) {
    double distance = sqrt(gn_dot(away, away));
    if (distance > gathered->reach || distance <= foot_slack * facets->size) return;
    gn_domain_plane plane = {.depth = distance};
    for (int k = 0; k < 3; k++) plane.normal[k] = away[k] / distance;
    take(facets, gathered, plane);
}

/* Adds an edge if neither of its facets comes nearer to x away from the edge. */
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

/* Adds a node if no edge from it comes nearer to x; then no facet does either. */
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
    if (facets_known(facets, x, &depth, &offset)) limit = 1.001 * (fabs(depth) + offset);
    return gn_tree_nearest(facets, x, limit);
}

double gn_facets_depth(const gn_facets *facets, const double x[3]) {
    double at[3] = {x[0], x[1], facets->corners == 2 ? 0 : x[2]};
    gn_foot foot = nearest(facets, at);
    if (foot.facet < 0) return -INFINITY;
    return facets_signed(facets, at, &foot);
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
    if (facets_known(facets, x, &known, &offset) && known - offset > reach) return 0;
    gn_foot foot = nearest(facets, x);
    if (foot.facet < 0) return 0;
    double depth = facets_signed(facets, x, &foot);
    if (depth > reach) return 0;
    if (depth < 0) {
        planes[0] = nearest_plane(facets, x, &foot, depth);
        return 1;
    }
    gathering g = {.x = x, .reach = reach, .nearest = depth, .planes = planes};
    /* The search reaches a little farther, so that rounding of the distance of a box does not lose
     * a foot exactly at `reach`. */
    gn_tree_within(facets, x, x, reach + foot_slack * facets->size, visit_gather, &g);
    /* If round-off lost the foot between facets, the nearest point is still known. */
    if (!g.count) planes[g.count++] = nearest_plane(facets, x, &foot, depth);
    return g.count;
}
