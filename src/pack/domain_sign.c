/* Signed distance from the boundary. */
#include "base/memory.h"
#include "pack/domain_facets.h"

#include <math.h>

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

/* Finds the facet with area on the other side of an edge at p, past needles. */
static const gn_facet *facet_across(const gn_facets *surface, int32_t half, const double p[3]) {
    for (int hops = 0; hops < 16 && (surface->facet[half >> 2].flags & GN_FACET_NEEDLE); hops++) {
        const gn_facet *needle = &surface->facet[half >> 2];
        int a = gn_next(half & 3), b = gn_next(a);
        half =
            needle->neighbour[edge_distance2(needle, a, p) <= edge_distance2(needle, b, p) ? a : b];
    }
    return &surface->facet[half >> 2];
}

/* Tells whether x is inside by the solid angle of all facets (Van Oosterom & Strackee 1983, eq. 8)
 * or the angle of all segments. This is slow, but needs no topology. */
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

double gn_facets_signed(const gn_facets *surface, const double x[3], const gn_foot *foot) {
    const gn_facet *f = &surface->facet[foot->facet];
    double v[3], side, distance = sqrt(foot->distance2);
    gn_minus(x, foot->at, v);
    if (foot->feature == 0) {
        /* The foot is a projection: its offset is round-off if x is close to the facet. */
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

bool gn_facets_known(const gn_facets *surface, const double x[3], double *depth, double *offset) {
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
    /* The addition covers the rounding of the stored depth. */
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
    float *known = gn_alloc_array(count, sizeof *known);
    if (!known)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a grid of %zu depths", count);
    double last = 0;
    for (size_t i = 0; i < count; i++) {
        size_t row = i / (size_t)surface->cells[0];
        size_t place[3] = {i % (size_t)surface->cells[0], row % (size_t)surface->cells[1],
                           row / (size_t)surface->cells[1]};
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = surface->origin[k] + ((double)place[k] + 0.5) * cell;
        if (dimension == 2) x[2] = 0;
        /* The previous centre is one cell away, so that the boundary is at most that much
         * farther. */
        double limit = place[0] ? fabs(last) + 1.001 * cell : INFINITY;
        gn_foot foot = gn_tree_nearest(surface, x, limit);
        last = gn_facets_signed(surface, x, &foot);
        known[i] = (float)last;
    }
    surface->cell = cell;
    surface->known = known;
    return GNEISS_OK;
}
