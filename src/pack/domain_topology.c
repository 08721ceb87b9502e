/* From corners to a closed boundary: which facets are adjacent, orientation, re-entrant edges and
 * corners. */
#include "base/new.h"
#include "pack/domain_facets.h"

#include <math.h>
#include <stdlib.h>

/* Ratio of height to extent up to which a triangle is a needle: its normal would be round-off of
 * single precision, in which surfaces are often stored. */
static const double needle_height = 1e-7;
/* Sine of the bend from which an edge counts as re-entrant; on flatter edges the tolerance of feet
 * on the adjacent facets is enough. */
static const double crease_bend = 1e-10;

typedef struct half_edge {
    int32_t low, high; /* nodes */
    int32_t half;      /* 4 * facet + edge */
} half_edge;

static int compare_halves(const void *left, const void *right) {
    const half_edge *a = left, *b = right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return (a->half > b->half) - (a->half < b->half);
}

static gneiss_status read_facets(gn_facets *facets, const double *node, const int32_t *element,
                                 const char *name, gneiss_error *error) {
    const char *what = facets->corners == 2 ? "edge" : "triangle";
    for (size_t i = 0; i < facets->count; i++) {
        gn_facet *f = &facets->facet[i];
        f->id = (int32_t)i;
        for (int c = 0; c < facets->corners; c++) {
            int32_t n = element[i * (size_t)facets->corners + (size_t)c];
            if (n < 0 || (size_t)n >= facets->node_count)
                return gn_fail(error, GNEISS_ERROR_INPUT,
                               "%s: %s %zu has node %d (base 0) but there are %zu nodes", name,
                               what, i + 1, n, facets->node_count);
            f->node[c] = n;
            for (int k = 0; k < facets->corners; k++) {
                double value = node[3 * (size_t)n + (size_t)k];
                if (!isfinite(value))
                    return gn_fail(error, GNEISS_ERROR_INPUT,
                                   "%s: %s %zu: expected finite coordinates, found %g", name, what,
                                   i + 1, value);
                f->corner[c][k] = value;
                facets->lower[k] = fmin(facets->lower[k], value);
                facets->upper[k] = fmax(facets->upper[k], value);
            }
        }
    }
    for (int k = 0; k < facets->corners; k++)
        facets->size = fmax(facets->size, facets->upper[k] - facets->lower[k]);
    if (!(facets->size > 0) || !isfinite(facets->size))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a body of some finite size, found %g m", name, facets->size);
    if (facets->corners == 2) facets->lower[2] = facets->upper[2] = 0;
    return GNEISS_OK;
}

/* Computes unit normals, except those of needles. */
static gneiss_status set_normals(gn_facets *facets, const char *name, gneiss_error *error) {
    for (size_t i = 0; i < facets->count; i++) {
        gn_facet *f = &facets->facet[i];
        double edge[3][3], cross[3], longest2 = 0;
        for (int k = 0; k < facets->corners; k++) {
            gn_minus(f->corner[facets->corners == 2 ? 1 - k : gn_next(k)], f->corner[k], edge[k]);
            double length2 = gn_dot(edge[k], edge[k]);
            if (!(length2 > 0))
                return gn_fail(error, GNEISS_ERROR_INPUT,
                               "%s: two corners of %s %d coincide at (%g, %g, %g)", name,
                               facets->corners == 2 ? "edge" : "triangle", f->id + 1,
                               f->corner[k][0], f->corner[k][1], f->corner[k][2]);
            longest2 = fmax(longest2, length2);
        }
        if (facets->corners == 2) {
            cross[0] = edge[0][1], cross[1] = -edge[0][0], cross[2] = 0;
        } else {
            gn_cross(edge[0], edge[1], cross);
            if (gn_dot(cross, cross) <=
                needle_height * needle_height * facets->size * facets->size * longest2)
                f->flags |= GN_FACET_NEEDLE;
        }
        double length = sqrt(gn_dot(cross, cross));
        for (int k = 0; k < 3 && !(f->flags & GN_FACET_NEEDLE); k++)
            f->normal[k] = cross[k] / length;
    }
    return GNEISS_OK;
}

static int longest_edge(const gn_facet *facet) {
    int longest = 0;
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double edge[3];
        gn_minus(facet->corner[gn_next(k)], facet->corner[k], edge);
        if (gn_dot(edge, edge) > most) most = gn_dot(edge, edge), longest = k;
    }
    return longest;
}

static bool has_normal(const gn_facet *facet) {
    return gn_dot(facet->normal, facet->normal) > 0;
}

/* Gives degenerate facets (needles) the normal of a neighbour that has one: of the neighbour along
 * the longest edge or, with `any`, of the first one. Returns whether a normal was set; *left: a
 * needle that still has none. */
static bool lend_normals(gn_facets *facets, bool any, const gn_facet **left) {
    bool progress = false;
    *left = NULL;
    for (size_t i = 0; i < facets->count; i++) {
        gn_facet *f = &facets->facet[i];
        if (has_normal(f)) continue;
        int edge = longest_edge(f);
        for (int k = 0; any && k < 3; k++)
            if (has_normal(&facets->facet[f->neighbour[k] >> 2])) edge = k;
        const gn_facet *beside = &facets->facet[f->neighbour[edge] >> 2];
        for (int k = 0; k < 3; k++) f->normal[k] = beside->normal[k];
        if (has_normal(f))
            progress = true;
        else
            *left = f;
    }
    return progress;
}

/* A needle is the limit of a thin triangle in the plane of the facet along its longest edge.
 * Needles may be adjacent, so that this is repeated until all have a normal. */
static gneiss_status set_needle_normals(gn_facets *facets, const char *name, gneiss_error *error) {
    const gn_facet *left;
    do {
        bool progress = lend_normals(facets, false, &left);
        /* Two needles that share their longest edge depend on each other. */
        if (left && !progress && !lend_normals(facets, true, &left))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: triangle %d at (%g, %g, %g) and those along it have no area", name,
                           left->id + 1, left->corner[0][0], left->corner[0][1],
                           left->corner[0][2]);
    } while (left);
    return GNEISS_OK;
}

static gneiss_status open_edge(const gn_facets *facets, const half_edge *half, size_t uses,
                               const char *name, gneiss_error *error) {
    const gn_facet *f = &facets->facet[half->half >> 2];
    const double *a = f->corner[half->half & 3], *b = f->corner[gn_next(half->half & 3)];
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a closed surface whose triangles all turn the same way round; the "
                   "edge from (%g, %g, %g) to (%g, %g, %g) of triangle %d belongs to %zu triangle%s"
                   "%s",
                   name, a[0], a[1], a[2], b[0], b[1], b[2], f->id + 1, uses, uses == 1 ? "" : "s",
                   uses == 2 ? " that turn differently" : "");
}

/* Finds the two triangles of each edge. */
static gneiss_status pair_edges(gn_facets *facets, half_edge *halves, const char *name,
                                gneiss_error *error) {
    size_t count = 3 * facets->count;
    for (size_t i = 0; i < count; i++) {
        int32_t f = (int32_t)(i / 3), e = (int32_t)(i % 3);
        int32_t a = facets->facet[f].node[e], b = facets->facet[f].node[gn_next(e)];
        halves[i] = (half_edge){a < b ? a : b, a < b ? b : a, 4 * f + e};
    }
    qsort(halves, count, sizeof *halves, compare_halves);
    for (size_t i = 0; i < count;) {
        size_t end = i + 1;
        while (end < count && halves[end].low == halves[i].low &&
               halves[end].high == halves[i].high)
            end++;
        if (end - i != 2) return open_edge(facets, &halves[i], end - i, name, error);
        int32_t a = halves[i].half, b = halves[i + 1].half;
        if (facets->facet[a >> 2].node[a & 3] == facets->facet[b >> 2].node[b & 3])
            return open_edge(facets, &halves[i], 2, name, error);
        facets->facet[a >> 2].neighbour[a & 3] = b;
        facets->facet[b >> 2].neighbour[b & 3] = a;
        i = end;
    }
    return GNEISS_OK;
}

/* Lists the facets around each node, in the order of the facets. */
static void set_stars(gn_facets *facets) {
    for (size_t i = 0; i < facets->count; i++)
        for (int c = 0; c < facets->corners; c++)
            facets->star_first[facets->facet[i].node[c] + 1]++;
    for (size_t n = 0; n < facets->node_count; n++)
        facets->star_first[n + 1] += facets->star_first[n];
    for (size_t i = facets->count; i-- > 0;) {
        for (int c = 0; c < facets->corners; c++) {
            int32_t n = facets->facet[i].node[c];
            /* Lists are filled from their ends: star_first[n + 1] decreases to the start of n's
             * list. */
            facets->star[--facets->star_first[n + 1]] = 4 * (int32_t)i + c;
        }
    }
    for (size_t n = 0; n < facets->node_count; n++)
        facets->star_first[n] = facets->star_first[n + 1];
    facets->star_first[facets->node_count] = (int32_t)(facets->count * (size_t)facets->corners);
}

static gneiss_status check_loops(const gn_facets *facets, const char *name, gneiss_error *error) {
    for (size_t n = 0; n < facets->node_count; n++) {
        int starts = 0, ends = 0;
        for (int32_t i = facets->star_first[n]; i < facets->star_first[n + 1]; i++)
            *(facets->star[i] & 3 ? &ends : &starts) += 1;
        if (starts == ends) continue;
        const double *x = facets->facet[facets->star[facets->star_first[n]] >> 2]
                              .corner[facets->star[facets->star_first[n]] & 3];
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: expected closed loops with the body on their left; at (%g, %g) %d lines "
            "start and %d end",
            name, x[0], x[1], starts, ends);
    }
    return GNEISS_OK;
}

static gneiss_status link_facets(gn_facets *facets, const char *name, gneiss_error *error) {
    const size_t count = facets->count, nodes = facets->node_count;
    GN_FREED half_edge *halves = NULL;
    GN_TRY(gn_new(&facets->star_first, nodes + 1, "nodes", error));
    GN_TRY(gn_new(&facets->star, count * (size_t)facets->corners, "corners of facets", error));
    GN_TRY(gn_new(&facets->node_normal, 3 * nodes, "normals of nodes", error));
    GN_TRY(gn_new(&halves, 3 * count, "edges of facets", error));
    set_stars(facets);
    return facets->corners == 2 ? check_loops(facets, name, error)
                                : pair_edges(facets, halves, name, error);
}

/* Computes pseudonormals, which are weighted by angle (Baerentzen & Aanaes 2005, eq. 5). */
static void set_node_normals(gn_facets *facets) {
    for (size_t i = 0; i < facets->count; i++) {
        const gn_facet *f = &facets->facet[i];
        for (int c = 0; c < facets->corners; c++) {
            double angle = 1;
            if (facets->corners == 3) {
                double u[3], v[3], w[3];
                gn_minus(f->corner[gn_next(c)], f->corner[c], u);
                gn_minus(f->corner[gn_next(gn_next(c))], f->corner[c], v);
                gn_cross(u, v, w);
                angle = atan2(sqrt(gn_dot(w, w)), gn_dot(u, v));
            }
            for (int k = 0; k < 3; k++)
                facets->node_normal[3 * f->node[c] + k] += angle * f->normal[k];
        }
    }
}

/* Counts the facets around a node by crossing edges, starting from its first facet. */
static int32_t fan_size(const gn_facets *facets, int32_t start) {
    int32_t at = start, size = 0;
    do {
        /* In the neighbour the shared edge is reversed, so that the node is its end there. */
        int32_t half = facets->facet[at >> 2].neighbour[at & 3];
        at = (half & ~3) | gn_next(half & 3);
        size++;
    } while (at != start);
    return size;
}

static bool crease(const gn_facets *facets, const gn_facet *facet, int edge) {
    const gn_facet *g = &facets->facet[facet->neighbour[edge] >> 2];
    double along[3], inward[3];
    gn_minus(facet->corner[edge], facet->corner[gn_next(edge)], along);
    gn_cross(g->normal, along, inward);
    return gn_dot(facet->normal, inward) > crease_bend * sqrt(gn_dot(along, along));
}

static bool reentrant_corner(const gn_facets *facets, int32_t first, int32_t second) {
    const gn_facet *a = &facets->facet[first >> 2], *b = &facets->facet[second >> 2];
    const gn_facet *in = first & 3 ? a : b, *out = first & 3 ? b : a;
    return in->normal[0] * out->normal[1] - in->normal[1] * out->normal[0] < -crease_bend;
}

static void set_flags(gn_facets *facets) {
    for (size_t i = 0; facets->corners == 3 && i < facets->count; i++) {
        gn_facet *f = &facets->facet[i];
        for (int k = 0; k < 3; k++)
            if ((size_t)(f->neighbour[k] >> 2) > i && crease(facets, f, k))
                f->flags |= (uint32_t)GN_FACET_CREASE_0 << k;
    }
    for (size_t n = 0; n < facets->node_count; n++) {
        int32_t first = facets->star_first[n], count = facets->star_first[n + 1] - first;
        if (!count) continue;
        const int32_t *star = facets->star + first;
        bool tip = false, pinched = count != (facets->corners == 2 ? 2 : fan_size(facets, star[0]));
        for (int32_t i = 0; i < count && facets->corners == 3; i++) {
            const gn_facet *f = &facets->facet[star[i] >> 2];
            tip |= crease(facets, f, star[i] & 3);
        }
        if (facets->corners == 2) tip = pinched || reentrant_corner(facets, star[0], star[1]);
        if (tip) facets->facet[star[0] >> 2].flags |= (uint32_t)GN_FACET_TIP_0 << (star[0] & 3);
        for (int32_t i = 0; i < count && pinched; i++)
            facets->facet[star[i] >> 2].flags |= (uint32_t)GN_FACET_PINCHED_0 << (star[i] & 3);
    }
}

/* Computes the volume by the divergence theorem, from the centre of the bounding box. */
static gneiss_status set_volume(gn_facets *facets, const char *name, gneiss_error *error) {
    double middle[3], unit = pow(facets->size, facets->corners);
    for (int k = 0; k < 3; k++) middle[k] = 0.5 * (facets->lower[k] + facets->upper[k]);
    for (size_t i = 0; i < facets->count; i++) {
        double v[3][3], cross[3];
        for (int c = 0; c < facets->corners; c++)
            gn_minus(facets->facet[i].corner[c], middle, v[c]);
        gn_cross(v[0], v[1], cross);
        facets->volume += facets->corners == 2 ? cross[2] / 2 : gn_dot(cross, v[2]) / 6;
    }
    if (facets->volume > 1e-12 * unit && isfinite(facets->volume)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a boundary with outward normals that encloses %s, found %g %s",
                   name, facets->corners == 2 ? "an area" : "a volume", facets->volume,
                   facets->corners == 2 ? "m2" : "m3");
}

static gneiss_status build(gn_facets *facets, const double *node, const int32_t *element,
                           const char *name, gneiss_error *error) {
    GN_TRY(read_facets(facets, node, element, name, error));
    GN_TRY(set_normals(facets, name, error));
    GN_TRY(gn_tree_build(facets, error));
    GN_TRY(link_facets(facets, name, error));
    GN_TRY(set_needle_normals(facets, name, error));
    GN_TRY(gn_facets_check_cuts(facets, name, error));
    GN_TRY(set_volume(facets, name, error));
    set_node_normals(facets);
    set_flags(facets);
    return gn_facets_know(facets, error);
}

/* Allocates facets, to be filled by `read_facets`. */
static gneiss_status allocate(size_t node_count, size_t count, int corners, const char *name,
                              gn_facets **facets, gneiss_error *error) {
    size_t least = (size_t)corners + (corners == 3), most = INT32_MAX / 8;
    if (count < least || count > most || node_count > INT32_MAX / 4)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a boundary of %zu to %zu %s, found %zu", name, least, most,
                       corners == 2 ? "edges" : "triangles", count);
    gn_facets *s = gn_alloc(sizeof *s);
    if (s) s->facet = gn_alloc_array(count, sizeof *s->facet);
    if (!s || !s->facet) {
        gn_free(s);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu facets", name, count);
    }
    s->corners = corners;
    s->count = count;
    s->node_count = node_count;
    for (int k = 0; k < 3; k++) s->lower[k] = INFINITY, s->upper[k] = -INFINITY;
    *facets = s;
    return GNEISS_OK;
}

gneiss_status gn_facets_create(const double *node, size_t node_count, const int32_t *element,
                               size_t count, int corners, const char *name, gn_facets **facets,
                               gneiss_error *error) {
    gn_facets *s = NULL;
    GN_TRY(allocate(node_count, count, corners, name, &s, error));
    gneiss_status status = build(s, node, element, name, error);
    if (status == GNEISS_OK)
        *facets = s;
    else
        gn_facets_free(s);
    return status;
}

static void free_facets_at(gn_facets **facets) {
    gn_facets_free(*facets);
}

gneiss_status gn_domain_check_cuts(const double *node, size_t node_count, const int32_t *element,
                                   size_t count, int corners, const char *name,
                                   gneiss_error *error) {
    GN_FREED_BY(free_facets_at) gn_facets *s = NULL;
    GN_TRY(allocate(node_count, count, corners, name, &s, error));
    GN_TRY(read_facets(s, node, element, name, error));
    GN_TRY(set_normals(s, name, error));
    GN_TRY(gn_tree_build(s, error));
    return gn_facets_check_cuts(s, name, error);
}

void gn_facets_free(gn_facets *facets) {
    if (!facets) return;
    gn_free(facets->facet);
    gn_free(facets->tree);
    gn_free(facets->node_normal);
    gn_free(facets->star_first);
    gn_free(facets->star);
    gn_free(facets->known);
    gn_free(facets);
}
