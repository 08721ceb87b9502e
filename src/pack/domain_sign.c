/* Signed distance from the boundary. */
#include "base/memory.h"
#include "pack/domain_facets.h"

#include <math.h>

/* Approximate number of cells of the grid of known depths. */
enum { KNOWN_CELLS = 1 << 16 };

/* Returns the squared distance of p from edge k of f. */
static double edge_distance2(const gn_facet *f, int k, const double p[3]) {
    double edge[3], v[3];
    gn_minus(f->corner[gn_next(k)], f->corner[k], edge);
    gn_minus(p, f->corner[k], v);
    double t = gn_dot(v, edge) / gn_dot(edge, edge);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int i = 0; i < 3; i++) v[i] -= t * edge[i];
    return gn_dot(v, v);
}

/* Finds the facet with area on the other side of an edge at p, past needles. */
static const gn_facet *facet_across(const gn_facets *s, int32_t half, const double p[3]) {
    for (int hops = 0; hops < 16 && (s->facet[half >> 2].flags & GN_FACET_NEEDLE); hops++) {
        const gn_facet *needle = &s->facet[half >> 2];
        int a = gn_next(half & 3), b = gn_next(a);
        half =
            needle->neighbour[edge_distance2(needle, a, p) <= edge_distance2(needle, b, p) ? a : b];
    }
    return &s->facet[half >> 2];
}

/* Tells whether x is inside by the solid angle of all facets (Van Oosterom & Strackee 1983, eq. 8)
 * or the angle of all segments. This is slow, but needs no topology. */
static bool winds_round(const gn_facets *s, const double x[3]) {
    double sum = 0;
    for (size_t i = 0; i < s->count; i++) {
        double v[3][3], cross[3], r[3] = {0, 0, 0};
        for (int c = 0; c < s->corners; c++) {
            gn_minus(s->facet[i].corner[c], x, v[c]);
            r[c] = sqrt(gn_dot(v[c], v[c]));
        }
        gn_cross(v[0], v[1], cross);
        if (s->corners == 2) {
            sum += atan2(cross[2], gn_dot(v[0], v[1]));
            continue;
        }
        double below = r[0] * r[1] * r[2] + gn_dot(v[0], v[1]) * r[2] + gn_dot(v[1], v[2]) * r[0] +
                       gn_dot(v[2], v[0]) * r[1];
        sum += 2 * atan2(gn_dot(cross, v[2]), below);
    }
    double whole = acos(-1.0) * (s->corners == 2 ? 2 : 4);
    return sum > 0.5 * whole;
}

double gn_facets_signed(const gn_facets *s, const double x[3], const gn_foot *foot) {
    const gn_facet *f = &s->facet[foot->facet];
    double v[3], side, distance = sqrt(foot->distance2);
    gn_minus(x, foot->at, v);
    if (foot->feature == 0) {
        /* The foot is a projection: its offset is round-off if x is close to the facet. */
        gn_minus(x, f->corner[0], v);
        side = gn_dot(v, f->normal);
    } else if (foot->feature < 4) {
        const gn_facet *g = facet_across(s, f->neighbour[foot->feature - 1], foot->at);
        side = gn_dot(v, f->normal) + gn_dot(v, g->normal);
    } else {
        int corner = foot->feature - 4;
        if (f->flags & ((uint32_t)GN_FACET_PINCHED_0 << corner))
            return winds_round(s, x) ? distance : -distance;
        side = gn_dot(v, s->node_normal + 3 * f->node[corner]);
    }
    return side > 0 ? -distance : distance;
}

bool gn_facets_known(const gn_facets *s, const double x[3], double *depth, double *offset) {
    if (!s->known) return false;
    size_t index = 0;
    double sum = 0;
    for (int k = s->corners - 1; k >= 0; k--) {
        double place = (x[k] - s->origin[k]) / s->cell;
        if (!(place >= 0 && place < s->cells[k])) return false;
        int i = (int)place;
        index = index * (size_t)s->cells[k] + (size_t)i;
        double off = (place - i - 0.5) * s->cell;
        sum += off * off;
    }
    *depth = (double)s->known[index];
    /* The addition covers the rounding of the stored depth. */
    *offset = sqrt(sum) + 1e-6 * s->size;
    return true;
}

gneiss_status gn_facets_know(gn_facets *s, gneiss_error *error) {
    int dimension = s->corners;
    double product = 1;
    for (int k = 0; k < dimension; k++) product *= fmax(s->upper[k] - s->lower[k], 1e-3 * s->size);
    double cell = pow(product / KNOWN_CELLS, 1.0 / dimension);
    size_t count = 1;
    for (int k = 0; k < 3; k++) {
        s->cells[k] = k < dimension ? (int)ceil((s->upper[k] - s->lower[k]) / cell + 0.01) : 1;
        double middle = 0.5 * (s->lower[k] + s->upper[k]);
        s->origin[k] = middle - 0.5 * cell * s->cells[k];
        count *= (size_t)s->cells[k];
    }
    float *known = gn_alloc_array(count, sizeof *known);
    if (!known)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a grid of %zu depths", count);
    double last = 0;
    for (size_t i = 0; i < count; i++) {
        size_t row = i / (size_t)s->cells[0];
        size_t place[3] = {i % (size_t)s->cells[0], row % (size_t)s->cells[1],
                           row / (size_t)s->cells[1]};
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = s->origin[k] + ((double)place[k] + 0.5) * cell;
        if (dimension == 2) x[2] = 0;
        /* The previous centre is one cell away, so that the boundary is at most that much
         * farther. */
        double limit = place[0] ? fabs(last) + 1.001 * cell : INFINITY;
        gn_foot foot = gn_tree_nearest(s, x, limit);
        last = gn_facets_signed(s, x, &foot);
        known[i] = (float)last;
    }
    s->cell = cell;
    s->known = known;
    return GNEISS_OK;
}
