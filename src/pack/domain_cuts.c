/* Detection of intersecting facets, which do not define an inside. */
#include "pack/domain_facets.h"

#include <math.h>

/* Relative to the extent. Edges of a polygon may not touch; triangles may, up to the tolerance of
 * welding. */
static const double touch_tolerance = 1e-12, cut_tolerance = 1e-6;

typedef struct cut_search {
    int32_t facet, other; /* the result is the other's index */
    double tolerance, at[3];
} cut_search;

static int shared_nodes(const gn_facet *a, const gn_facet *b, int corners) {
    int shared = 0;
    for (int i = 0; i < corners; i++)
        for (int j = 0; j < corners; j++) shared += a->node[i] == b->node[j];
    return shared;
}

/* Tells whether p is within `tolerance` of the segment, and then copies it to `at`. */
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

/* Returns z of (b - a) x (p - a), whose sign is the side of the segment on which p is. */
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

/* Tells whether the axis separates the triangles, or shows them in touch within the tolerance. A
 * short axis (the product of parallel edges; `scale` is that of its factors) proves nothing. */
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
    /* The displacement that separates both; a triangle has no width along its normal. */
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

/* Separating axes (Gottschalk, Lin & Manocha 1996): convex bodies are separate if one of the
 * normals or products of edges separates them; in a common plane, one of the normals of edges. */
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

/* Finds a point of the intersection: where an edge of one triangle passes through the other, else
 * the centre of the boxes' common part (in a common plane). */
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
            /* A needle has no interior; its neighbours are tested in its place. */
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
