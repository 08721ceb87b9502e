#include "surfaces/convex.h"

#include "base/memory.h"
#include "base/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What files in single precision make of a plane, over the size of the body. */
static const double flat = 1e-6;
/* Height over the longest side from which on a triangle says where its plane is. */
static const double slender = 1e-3;

/* --- closed --- */

typedef struct welded {
    double x[3];
    int32_t vertex;
} welded;

static int by_place(const void *a, const void *b) {
    const welded *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
    return p->vertex < q->vertex ? -1 : 1;
}

static int by_value(const void *a, const void *b) {
    const int64_t *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* Vertices at one place have one number. */
static void weld(const gn_facet_set *s, size_t vertices, welded *w, int32_t *number) {
    for (size_t v = 0; v < vertices; v++) {
        for (int k = 0; k < 3; k++) w[v].x[k] = s->pos[4 * v + (size_t)k] + 0.0;
        w[v].vertex = (int32_t)v;
    }
    qsort(w, vertices, sizeof *w, by_place);
    for (size_t v = 0; v < vertices; v++) {
        bool same = v > 0;
        for (int k = 0; same && k < 3; k++) same = w[v].x[k] == w[v - 1].x[k];
        number[w[v].vertex] = same ? number[w[v - 1].vertex] : w[v].vertex;
    }
}

/* Every edge (in the plane: corner) is that of two facets. */
static bool is_closed(const gn_facet_set *s, size_t vertices, const int32_t *number,
                      int64_t *edge) {
    size_t count = s->count * (size_t)s->corners;
    for (size_t f = 0; f < s->count; f++)
        for (int c = 0; c < s->corners; c++) {
            const int32_t *corner = s->corner + (size_t)s->corners * f;
            int64_t a = number[corner[c]], b = number[corner[(c + 1) % s->corners]];
            bool plane = s->corners == 2;
            edge[f * (size_t)s->corners + (size_t)c] =
                plane ? a : (a < b ? a : b) * (int64_t)vertices + (a < b ? b : a);
        }
    qsort(edge, count, sizeof *edge, by_value);
    for (size_t k = 0; k < count; k += 2)
        if (k + 1 == count || edge[k] != edge[k + 1] || (k > 1 && edge[k] == edge[k - 1]))
            return false;
    return count > 0;
}

static gneiss_status look_whether_closed(const gn_facet_set *s, size_t vertices, bool *closed,
                                         gneiss_error *error) {
    welded *w = gn_alloc_array(vertices + 1, sizeof *w);
    int32_t *number = gn_alloc_array(vertices + 1, sizeof *number);
    int64_t *edge = gn_alloc_array(s->count * (size_t)s->corners + 1, sizeof *edge);
    bool held = w && number && edge;
    if (held) {
        weld(s, vertices, w, number);
        *closed = is_closed(s, vertices, number, edge);
    }
    gn_free(w);
    gn_free(number);
    gn_free(edge);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets",
                          s->count);
}

/* --- convex --- */

static const double *corner_of(const gn_facet_set *s, size_t facet, int c) {
    return s->pos + 4 * (int64_t)s->corner[(size_t)s->corners * facet + (size_t)c];
}

/* Unit normal of a facet; whether it is a good one. */
static bool normal_of(const gn_facet_set *s, size_t facet, double n[3]) {
    const double *a = corner_of(s, facet, 0), *b = corner_of(s, facet, 1);
    double u[3], v[3] = {0, 0, 1}, longest = 0.0;
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k];
    longest = gn_dot3(u, u);
    if (s->corners == 3) {
        const double *c = corner_of(s, facet, 2);
        double third[3];
        for (int k = 0; k < 3; k++) {
            v[k] = c[k] - a[k];
            third[k] = c[k] - b[k];
        }
        longest = fmax(longest, fmax(gn_dot3(v, v), gn_dot3(third, third)));
    }
    gn_cross3(u, v, n);
    double size = sqrt(gn_dot3(n, n));
    if (!(size > 0.0)) return false;
    for (int k = 0; k < 3; k++) n[k] /= size;
    return s->corners == 2 || size > slender * longest;
}

/* A plane through a facet that has all vertices on one side. */
static bool supports(const gn_facet_set *s, size_t vertices, size_t facet, double size,
                     double plane[4]) {
    double at = gn_dot3(plane, corner_of(s, facet, 0)), low = 0.0, high = 0.0;
    for (size_t v = 0; v < vertices; v++) {
        double d = gn_dot3(plane, s->pos + 4 * v) - at;
        low = fmin(low, d);
        high = fmax(high, d);
        if (low < -flat * size && high > flat * size) return false;
    }
    if (high > -low)
        for (int k = 0; k < 3; k++) plane[k] = -plane[k];
    plane[3] = high > -low ? -at - low : at + high;
    return true;
}

static bool lies_on(const gn_facet_set *s, size_t facet, const double plane[4], double size) {
    for (int c = 0; c < s->corners; c++)
        if (!(fabs(gn_dot3(plane, corner_of(s, facet, c)) - plane[3]) <= flat * size)) return false;
    return true;
}

/* The plane of a facet that is not slender, or of any that lies on one which is known. */
static bool find_plane(const gn_facet_set *s, size_t vertices, size_t facet, double size, bool slim,
                       gn_convex *c) {
    double plane[4];
    for (size_t k = 0; k < c->planes; k++)
        if (lies_on(s, facet, c->plane + 4 * k, size)) {
            c->on[facet] = (int32_t)k;
            return true;
        }
    normal_of(s, facet, plane);
    if (slim || !supports(s, vertices, facet, size, plane)) return false;
    memcpy(c->plane + 4 * c->planes, plane, sizeof plane);
    c->on[facet] = (int32_t)c->planes++;
    return true;
}

static bool find_planes(const gn_facet_set *s, size_t vertices, gn_convex *c) {
    double size = 0.0, n[3];
    for (size_t v = 0; v < vertices; v++)
        for (size_t k = 0; k < 3; k++) size = fmax(size, fabs(s->pos[4 * v + k] - s->pos[k]));
    for (int slim = 0; slim < 2; slim++)
        for (size_t f = 0; f < s->count; f++)
            if (normal_of(s, f, n) != slim && !find_plane(s, vertices, f, size, slim, c))
                return false;
    return c->planes > (size_t)s->corners;
}

static void put_corners(const gn_facet_set *s, gn_convex *c) {
    for (size_t f = 0; f < s->count; f++) {
        double *to = c->corner + 3 * (size_t)c->corners * f;
        for (int k = 0; k < c->corners; k++) {
            memcpy(to + 3 * k, corner_of(s, f, s->corners == 3 ? k : (k == 1 || k == 2)),
                   3 * sizeof *to);
            if (s->corners == 2) to[3 * k + 2] = k < 2 ? -0.5 : 0.5;
        }
    }
}

gneiss_status gn_convex_make(const gn_facet_set *s, size_t vertices, gn_convex *c,
                             gneiss_error *error) {
    bool closed = false;
    *c = (gn_convex){.corners = s->corners == 3 ? 3 : 4};
    GN_TRY(look_whether_closed(s, vertices, &closed, error));
    if (!closed) return GNEISS_OK;
    c->plane = gn_alloc_array(s->count, 4 * sizeof *c->plane);
    c->corner = gn_alloc_array(s->count, 3 * (size_t)c->corners * sizeof *c->corner);
    c->on = gn_alloc_array(s->count, sizeof *c->on);
    if (!c->plane || !c->corner || !c->on) {
        gn_convex_free(c);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets", s->count);
    }
    if (!find_planes(s, vertices, c)) {
        gn_convex_free(c);
        return GNEISS_OK;
    }
    c->polygons = s->count;
    put_corners(s, c);
    return GNEISS_OK;
}

void gn_convex_free(gn_convex *c) {
    gn_free(c->plane);
    gn_free(c->corner);
    gn_free(c->on);
    *c = (gn_convex){0};
}
