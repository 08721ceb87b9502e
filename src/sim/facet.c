#include "sim/facet.h"

#include "sim/touch.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Distances of one point reckoned from two facets differ by rounding. */
static const double same = 1e-10;

/* --- nearest point
 * ---------------------------------------------------------------------------------- */

static void set_point(gn_facet_near *near, const double p[3], unsigned feature) {
    memcpy(near->away, p, 3 * sizeof *p);
    near->distance = sqrt(gn_dot3(p, p));
    near->feature = feature;
}

/* On the side from corner i to corner j, given relative to the centre; ends included. */
static void on_side(const double a[3], const double b[3], int i, int j, gn_facet_near *near) {
    double side[3], p[3];
    for (int k = 0; k < 3; k++) side[k] = b[k] - a[k];
    double t = -gn_dot3(a, side) / gn_dot3(side, side);
    unsigned feature = (1U << i) | (1U << j);
    if (!(t > 0.0)) {
        t = 0.0;
        feature = 1U << i;
    } else if (t >= 1.0) {
        t = 1.0;
        feature = 1U << j;
    }
    for (int k = 0; k < 3; k++) p[k] = t < 1.0 ? a[k] + t * side[k] : b[k];
    near->weight[0] = near->weight[1] = near->weight[2] = 0.0;
    near->weight[i] = 1.0 - t;
    near->weight[j] = t;
    set_point(near, p, feature);
}

/* Inside a triangle the point is taken along the normal, so that a slender triangle does not tilt
 * it. Barycentric coordinates by areas; where one is not positive, the nearest of those sides. */
static void on_triangle(double x[3][3], gn_facet_near *near) {
    double e1[3], e2[3], normal[3], part[3], weight[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = x[1][k] - x[0][k];
        e2[k] = x[2][k] - x[0][k];
    }
    gn_cross3(e1, e2, normal);
    double area2 = gn_dot3(normal, normal);
    bool inside = area2 > 0.0;
    for (int k = 0; k < 3; k++) {
        gn_cross3(x[(k + 1) % 3], x[(k + 2) % 3], part);
        weight[k] = gn_dot3(part, normal);
        inside = inside && weight[k] > 0.0;
    }
    if (inside) {
        double along = gn_dot3(x[0], normal) / area2, p[3];
        for (int k = 0; k < 3; k++) p[k] = along * normal[k];
        double sum = weight[0] + weight[1] + weight[2];
        for (int k = 0; k < 3; k++) near->weight[k] = weight[k] / sum;
        set_point(near, p, 7U);
        return;
    }
    gn_facet_near best = {.distance = INFINITY}, side;
    for (int k = 0; k < 3; k++) {
        if (area2 > 0.0 && weight[k] > 0.0) continue;
        on_side(x[(k + 1) % 3], x[(k + 2) % 3], (k + 1) % 3, (k + 2) % 3, &side);
        if (side.distance < best.distance) best = side;
    }
    memcpy(near->away, best.away, sizeof best.away);
    memcpy(near->weight, best.weight, sizeof best.weight);
    near->distance = best.distance;
    near->feature = best.feature;
}

void gn_facet_nearest(int corners, const double *const x[3], const double centre[3],
                      gn_facet_near *near) {
    double y[3][3] = {{0.0}};
    for (int c = 0; c < corners; c++)
        for (int k = 0; k < 3; k++) y[c][k] = x[c][k] - centre[k];
    if (corners == 3)
        on_triangle(y, near);
    else
        on_side(y[0], y[1], 0, 1, near);
}

void gn_facet_add(gn_facet_near *list, size_t *count, const gn_facet_near *item) {
    if (*count < GN_FACET_TOUCHES) {
        list[(*count)++] = *item;
        return;
    }
    /* Whatever suppresses a minimum is at least as near: the farthest can go. */
    size_t worst = 0;
    for (size_t k = 1; k < *count; k++)
        if (list[k].distance > list[worst].distance) worst = k;
    if (item->distance < list[worst].distance) list[worst] = *item;
}

/* --- minima
 * ----------------------------------------------------------------------------------------- */

static int size_of(unsigned feature) {
    return __builtin_popcount(feature);
}

/* Whether all corners of a's feature are corners of b. */
static bool holds(const gn_facet_near *b, const gn_facet_near *a) {
    for (int k = 0; k < 3; k++) {
        if (!(a->feature >> k & 1)) continue;
        bool found = false;
        for (int m = 0; m < 3; m++) found = found || b->corner[m] == a->corner[k];
        if (!found) return false;
    }
    return true;
}

/* Whether b, which has a's feature, comes nearer, or counts for it at the same point. */
static bool suppresses(const gn_facet_near *b, const gn_facet_near *a, bool b_first) {
    if (!holds(b, a)) return false;
    if (b->distance < a->distance * (1.0 - same)) return true;
    if (b->distance > a->distance * (1.0 + same)) return false;
    int more = size_of(b->feature) - size_of(a->feature);
    return more > 0 || (more == 0 && b_first);
}

size_t gn_facet_minima(gn_facet_near *list, size_t count) {
    if (count < 2) return count;
    bool keep[GN_FACET_TOUCHES];
    for (size_t a = 0; a < count; a++) {
        keep[a] = true;
        for (size_t b = 0; b < count && keep[a]; b++)
            keep[a] = b == a || !suppresses(&list[b], &list[a], b < a);
    }
    size_t kept = 0;
    for (size_t a = 0; a < count; a++) {
        if (!keep[a]) continue;
        gn_facet_near item = list[a];
        size_t at = kept++;
        for (; at > 0 && list[at - 1].distance > item.distance; at--) list[at] = list[at - 1];
        list[at] = item;
    }
    return kept;
}

/* --- joining
 * ---------------------------------------------------------------------------------------- */

/* Half spaces n . u >= depth. */
typedef struct cluster {
    size_t count;
    size_t place[GN_FACET_TOUCHES];
    double n[GN_FACET_TOUCHES][3], depth[GN_FACET_TOUCHES]; /* n from the surface to the centre */
    double slack;
} cluster;

static bool resolves(const cluster *c, const double u[3]) {
    for (size_t k = 0; k < c->count; k++)
        if (gn_dot3(c->n[k], u) < c->depth[k] - c->slack) return false;
    return true;
}

/* u = lambda_i n_i + lambda_j n_j that just meets both; false when one of them would pull. */
static bool meet_two(const cluster *c, size_t i, size_t j, double u[3], double share[3]) {
    double across[3], side[3];
    gn_cross3(c->n[i], c->n[j], across);
    double sine = sqrt(gn_dot3(across, across)), cosine = gn_dot3(c->n[i], c->n[j]);
    if (!(sine > 1e-9)) return false;
    double beta = (c->depth[j] - cosine * c->depth[i]) / sine;
    share[1] = beta / sine;
    share[0] = c->depth[i] - cosine * share[1];
    if (!(share[0] >= 0.0 && share[1] >= 0.0)) return false;
    for (int a = 0; a < 3; a++) {
        side[a] = (c->n[j][a] - cosine * c->n[i][a]) / sine;
        u[a] = c->depth[i] * c->n[i][a] + beta * side[a];
    }
    return true;
}

static bool meet_three(const cluster *c, const size_t at[3], double u[3], double share[3]) {
    double across[3][3];
    for (int k = 0; k < 3; k++) gn_cross3(c->n[at[(k + 1) % 3]], c->n[at[(k + 2) % 3]], across[k]);
    double det = gn_dot3(c->n[at[0]], across[0]);
    if (!(fabs(det) > 1e-12)) return false;
    for (int a = 0; a < 3; a++) {
        u[a] = 0.0;
        for (int k = 0; k < 3; k++) u[a] += c->depth[at[k]] * across[k][a] / det;
    }
    for (int k = 0; k < 3; k++) {
        share[k] = gn_dot3(u, across[k]) / det;
        if (!(share[k] >= 0.0)) return false;
    }
    return true;
}

/* The shortest u that resolves all: one, two or three of them hold it. Places in `at`. */
static int shortest(const cluster *c, double u[3], size_t at[3], double share[3]) {
    at[0] = 0;
    share[0] = 1.0;
    for (int a = 0; a < 3; a++) u[a] = c->depth[0] * c->n[0][a];
    if (resolves(c, u)) return 1;
    for (at[0] = 0; at[0] < c->count; at[0]++)
        for (at[1] = at[0] + 1; at[1] < c->count; at[1]++)
            if (meet_two(c, at[0], at[1], u, share) && resolves(c, u)) return 2;
    for (at[0] = 0; at[0] < c->count; at[0]++)
        for (at[1] = at[0] + 1; at[1] < c->count; at[1]++)
            for (at[2] = at[1] + 1; at[2] < c->count; at[2]++)
                if (meet_three(c, at, u, share) && resolves(c, u)) return 3;
    /* Only rounding leads here: the deepest stands for all. */
    at[0] = 0;
    share[0] = 1.0;
    for (int a = 0; a < 3; a++) u[a] = c->depth[0] * c->n[0][a];
    return 1;
}

void gn_facet_single(const gn_facet_near *minima, size_t k, double radius, gn_facet_contact *out) {
    const gn_facet_near *m = &minima[k];
    *out = (gn_facet_contact){.overlap = m->distance - radius, .members = 1};
    out->member[0] = (int)k;
    out->share[0] = 1.0;
    for (int a = 0; a < 3; a++) {
        out->n[a] = m->away[a] / m->distance;
        out->arm[a] = m->away[a];
    }
}

static void join(const gn_facet_near *minima, const cluster *c, double radius,
                 gn_facet_contact *out) {
    double u[3], share[3], sum = 0.0;
    size_t at[3];
    int members = shortest(c, u, at, share);
    if (members == 1) {
        gn_facet_single(minima, c->place[at[0]], radius, out);
        return;
    }
    double size = sqrt(gn_dot3(u, u));
    *out = (gn_facet_contact){.overlap = -size, .members = members};
    for (int k = 0; k < members; k++) sum += share[k];
    for (int k = 0; k < members; k++) {
        out->share[k] = share[k] / sum;
        out->member[k] = (int)c->place[at[k]];
        for (int a = 0; a < 3; a++) out->arm[a] += out->share[k] * minima[out->member[k]].away[a];
    }
    for (int a = 0; a < 3; a++) out->n[a] = -u[a] / size;
}

size_t gn_facet_contacts(const gn_facet_near *minima, size_t count, double radius,
                         gn_facet_contact *contacts) {
    bool taken[GN_FACET_TOUCHES] = {false};
    size_t found = 0;
    for (size_t first = 0; first < count; first++) {
        const double *d = minima[first].away;
        if (taken[first] || !(minima[first].distance > 0.0)) continue;
        cluster c;
        c.count = 0;
        c.slack = 1e-12 * (radius - minima[first].distance) + 8.0 * DBL_EPSILON * radius;
        for (size_t k = first; k < count; k++) {
            const gn_facet_near *m = &minima[k];
            double cosine = gn_dot3(m->away, d) / (m->distance * minima[first].distance);
            if (taken[k] || (k > first && !(cosine > GN_FACET_JOIN))) continue;
            taken[k] = true;
            for (int a = 0; a < 3; a++) c.n[c.count][a] = -m->away[a] / m->distance;
            c.depth[c.count] = radius - m->distance;
            c.place[c.count++] = k;
        }
        join(minima, &c, radius, &contacts[found++]);
    }
    return found;
}
