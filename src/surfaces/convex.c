#include "surfaces/convex.h"

#include "base/memory.h"
#include "base/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Tolerances of the distance of a vertex from the plane of its face, over the size of the body: for
 * coordinates as computed, and for those stored with six digits or in single precision, possibly
 * far from the origin. */
static const double exact = 1e-12, rounded = 3e-5;
/* Ratio of height to longest side above which a triangle determines its plane by itself. */
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

/* Gives vertices at the same position the same number. */
static void weld(const gn_facet_set *set, size_t vertices, welded *vertices_by_place,
                 int32_t *number) {
    for (size_t v = 0; v < vertices; v++) {
        for (int k = 0; k < 3; k++) vertices_by_place[v].x[k] = set->pos[4 * v + (size_t)k] + 0.0;
        vertices_by_place[v].vertex = (int32_t)v;
    }
    qsort(vertices_by_place, vertices, sizeof *vertices_by_place, by_place);
    for (size_t v = 0; v < vertices; v++) {
        bool same = v > 0;
        for (int k = 0; same && k < 3; k++)
            same = vertices_by_place[v].x[k] == vertices_by_place[v - 1].x[k];
        number[vertices_by_place[v].vertex] =
            same ? number[vertices_by_place[v - 1].vertex] : vertices_by_place[v].vertex;
    }
}

/* Tells whether every edge (in 2D: corner) belongs to two facets. */
static bool is_closed(const gn_facet_set *set, size_t vertices, const int32_t *number,
                      int64_t *edge) {
    size_t count = set->count * (size_t)set->corners;
    for (size_t f = 0; f < set->count; f++)
        for (int c = 0; c < set->corners; c++) {
            const int32_t *corner = set->corner + (size_t)set->corners * f;
            int64_t a = number[corner[c]], b = number[corner[(c + 1) % set->corners]];
            bool plane = set->corners == 2;
            edge[f * (size_t)set->corners + (size_t)c] =
                plane ? a : (a < b ? a : b) * (int64_t)vertices + (a < b ? b : a);
        }
    qsort(edge, count, sizeof *edge, by_value);
    for (size_t k = 0; k < count; k += 2)
        if (k + 1 == count || edge[k] != edge[k + 1] || (k > 1 && edge[k] == edge[k - 1]))
            return false;
    return count > 0;
}

static gneiss_status look_whether_closed(const gn_facet_set *set, size_t vertices, bool *closed,
                                         gneiss_error *error) {
    welded *w = gn_alloc_array(vertices + 1, sizeof *w);
    int32_t *number = gn_alloc_array(vertices + 1, sizeof *number);
    int64_t *edge = gn_alloc_array(set->count * (size_t)set->corners + 1, sizeof *edge);
    bool held = w && number && edge;
    if (held) {
        weld(set, vertices, w, number);
        *closed = is_closed(set, vertices, number, edge);
    }
    gn_free(w);
    gn_free(number);
    gn_free(edge);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets",
                          set->count);
}

/* --- convex --- */

static const double *corner_of(const gn_facet_set *set, size_t facet, int c) {
    return set->pos + 4 * (int64_t)set->corner[(size_t)set->corners * facet + (size_t)c];
}

/* Computes the unit normal of a facet; returns whether it is reliable. */
static bool normal_of(const gn_facet_set *set, size_t facet, double n[3]) {
    const double *a = corner_of(set, facet, 0), *b = corner_of(set, facet, 1);
    double u[3], v[3] = {0, 0, 1}, longest = 0.0;
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k];
    longest = gn_dot3(u, u);
    if (set->corners == 3) {
        const double *c = corner_of(set, facet, 2);
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
    return set->corners == 2 || size > slender * longest;
}

/* Context of the search for planes; `off`, m, is the tolerance of the distance of a vertex from its
 * plane. */
typedef struct search {
    const gn_facet_set *set;
    size_t vertices;
    double off;
} search;

/* Moves a plane with the normal of a facet so that all vertices are on one side; returns false if
 * they are on both sides of the facet. */
static bool supports(const search *state, size_t facet, double plane[4]) {
    double at = gn_dot3(plane, corner_of(state->set, facet, 0)), low = 0.0, high = 0.0;
    for (size_t v = 0; v < state->vertices; v++) {
        double d = gn_dot3(plane, state->set->pos + 4 * v) - at;
        low = fmin(low, d);
        high = fmax(high, d);
        if (low < -state->off && high > state->off) return false;
    }
    if (high > -low)
        for (int k = 0; k < 3; k++) plane[k] = -plane[k];
    plane[3] = high > -low ? -at - low : at + high;
    return true;
}

static bool lies_on(const gn_facet_set *set, size_t facet, const double plane[4], double off) {
    for (int c = 0; c < set->corners; c++)
        if (!(fabs(gn_dot3(plane, corner_of(set, facet, c)) - plane[3]) <= off)) return false;
    return true;
}

/* Averages the normals of all facets that lie nearly in the plane of this one. The error of a small
 * facet's normal is the error of its corners over its height; that of the mean is the same error
 * over the size of all facets. */
static void mean_normal(const search *state, size_t facet, double n[3]) {
    double near[4], sum[3] = {0, 0, 0}, size;
    normal_of(state->set, facet, near);
    near[3] = gn_dot3(near, corner_of(state->set, facet, 0));
    for (size_t f = 0; f < state->set->count; f++) {
        double u[3], v[3] = {0, 0, 1}, area[3], one[3];
        const double *x = corner_of(state->set, f, 0), *y = corner_of(state->set, f, 1);
        if (!normal_of(state->set, f, one) || !(fabs(gn_dot3(one, near)) > 0.99)) continue;
        if (!lies_on(state->set, f, near, 30.0 * state->off)) continue;
        for (int k = 0; k < 3; k++) {
            u[k] = y[k] - x[k];
            if (state->set->corners == 3) v[k] = corner_of(state->set, f, 2)[k] - x[k];
        }
        gn_cross3(u, v, area);
        double sign = gn_dot3(area, near) < 0.0 ? -1.0 : 1.0;
        for (int k = 0; k < 3; k++) sum[k] += sign * area[k];
    }
    size = sqrt(gn_dot3(sum, sum));
    for (int k = 0; k < 3; k++) n[k] = size > 0.0 ? sum[k] / size : near[k];
}

/* Finds the plane of a facet: a known one that contains it, or a new one. */
static bool find_plane(const search *state, size_t facet, gn_convex *convex) {
    double plane[4];
    for (size_t k = 0; k < convex->planes; k++)
        if (lies_on(state->set, facet, convex->plane + 4 * k, state->off)) {
            convex->on[facet] = (int32_t)k;
            return true;
        }
    normal_of(state->set, facet, plane);
    if (!supports(state, facet, plane)) {
        mean_normal(state, facet, plane);
        if (!supports(state, facet, plane)) return false;
    }
    memcpy(convex->plane + 4 * convex->planes, plane, sizeof plane);
    convex->on[facet] = (int32_t)convex->planes++;
    return true;
}

static double size_of(const gn_facet_set *set, size_t vertices) {
    double size = 0.0;
    for (size_t v = 0; v < vertices; v++)
        for (size_t k = 0; k < 3; k++) size = fmax(size, fabs(set->pos[4 * v + k] - set->pos[k]));
    return size;
}

/* Finds all planes; slender facets come last, because others define their planes. */
static bool find_planes(const search *state, gn_convex *convex) {
    double n[3];
    convex->planes = 0;
    for (int slim = 0; slim < 2; slim++)
        for (size_t f = 0; f < state->set->count; f++)
            if (normal_of(state->set, f, n) != slim && !find_plane(state, f, convex)) return false;
    return convex->planes > (size_t)state->set->corners;
}

static void put_corners(const gn_facet_set *set, gn_convex *convex) {
    for (size_t f = 0; f < set->count; f++) {
        double *to = convex->corner + 3 * (size_t)convex->corners * f;
        for (int k = 0; k < convex->corners; k++) {
            memcpy(to + 3 * k, corner_of(set, f, set->corners == 3 ? k : (k == 1 || k == 2)),
                   3 * sizeof *to);
            if (set->corners == 2) to[3 * k + 2] = k < 2 ? -0.5 : 0.5;
        }
    }
}

/* --- faces of planes --- */

/* Places a square on a plane around the first vertex; in 2D a strip between both ends. */
static void put_square(const gn_facet_set *set, const double plane[4], double half, double *to) {
    double e[2][3] = {{0}}, off = plane[3] - gn_dot3(plane, set->pos);
    int least = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(plane[a]) < fabs(plane[least])) least = a;
    e[0][set->corners == 2 ? 2 : least] = 1.0;
    gn_cross3(plane, e[0], e[1]);
    gn_cross3(e[1], plane, e[0]);
    for (int k = 0; k < 2; k++) {
        double size = sqrt(gn_dot3(e[k], e[k]));
        for (int a = 0; a < 3; a++) e[k][a] *= (k == 0 && set->corners == 2 ? 0.5 : half) / size;
    }
    for (int c = 0; c < 4; c++)
        for (int a = 0; a < 3; a++)
            to[3 * c + a] = set->pos[a] + off * plane[a] +
                            (c == 0 || c == 3 ? -1.0 : 1.0) * e[0][a] +
                            (c < 2 ? -1.0 : 1.0) * e[1][a];
}

/* Cuts the face on a plane by all other planes, in one of two buffers; returns its number of
 * corners. */
static size_t face_of(const gn_facet_set *set, const gn_convex *convex, size_t plane, double half,
                      double *buffer[2], int *in) {
    size_t count = 4;
    *in = 0;
    put_square(set, convex->plane + 4 * plane, half, buffer[0]);
    for (size_t k = 0; k < convex->planes && count; k++) {
        if (k == plane) continue;
        const double *q = convex->plane + 4 * k;
        count = gn_polygon_cut(buffer[*in], count, q, q[3], buffer[1 - *in]);
        *in = 1 - *in;
    }
    return count;
}

/* Replaces the facets by those of the body that its planes bound, so that they lie on the planes
 * exactly. Without `convex->corner` they are only counted. Returns false if the planes bound no
 * body. */
static bool cut_faces(const gn_facet_set *set, double size, double *memory, gn_convex *convex) {
    double *buffer[2] = {memory, memory + 3 * (convex->planes + 8)};
    convex->polygons = 0;
    for (size_t p = 0; p < convex->planes; p++) {
        int in;
        size_t count = face_of(set, convex, p, 8.0 * size, buffer, &in);
        const double *x = buffer[in];
        for (size_t k = 0; k < 3 * count; k++)
            if (!(k % 3 == 2 && set->corners == 2) && !(fabs(x[k] - set->pos[k % 3]) < 4.0 * size))
                return false;
        for (size_t k = set->corners == 2 ? 3 : 2; k < count; k++, convex->polygons++) {
            if (!convex->corner) continue;
            double *to = convex->corner + 3 * (size_t)convex->corners * convex->polygons;
            memcpy(to, x, 3 * sizeof *to);
            if (set->corners == 2)
                memcpy(to + 3, x + 3, 9 * sizeof *to);
            else
                memcpy(to + 3, x + 3 * (k - 1), 6 * sizeof *to);
            convex->on[convex->polygons] = (int32_t)p;
        }
    }
    return convex->polygons > 0;
}

static gneiss_status make_faces(const gn_facet_set *set, double size, gn_convex *convex,
                                gneiss_error *error) {
    double *memory = gn_alloc_array(2 * (convex->planes + 8), 3 * sizeof *memory);
    bool held = memory, bound = false;
    gn_free(convex->corner);
    gn_free(convex->on);
    convex->corner = NULL;
    convex->on = NULL;
    if (memory && cut_faces(set, size, memory, convex)) {
        convex->corner =
            gn_alloc_array(convex->polygons, 3 * (size_t)convex->corners * sizeof *convex->corner);
        convex->on = gn_alloc_array(convex->polygons, sizeof *convex->on);
        held = convex->corner && convex->on;
        bound = held && cut_faces(set, size, memory, convex);
    }
    gn_free(memory);
    if (!bound) gn_convex_free(convex);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets",
                          set->count);
}

gneiss_status gn_convex_make(const gn_facet_set *set, size_t vertices, gn_convex *convex,
                             gneiss_error *error) {
    bool closed = false;
    *convex = (gn_convex){.corners = set->corners == 3 ? 3 : 4};
    GN_TRY(look_whether_closed(set, vertices, &closed, error));
    if (!closed) return GNEISS_OK;
    convex->plane = gn_alloc_array(set->count, 4 * sizeof *convex->plane);
    convex->corner =
        gn_alloc_array(set->count, 3 * (size_t)convex->corners * sizeof *convex->corner);
    convex->on = gn_alloc_array(set->count, sizeof *convex->on);
    if (!convex->plane || !convex->corner || !convex->on) {
        gn_convex_free(convex);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a body of %zu facets",
                       set->count);
    }
    double size = size_of(set, vertices);
    if (find_planes(&(search){set, vertices, exact * size}, convex)) {
        convex->polygons = set->count;
        put_corners(set, convex);
    } else if (find_planes(&(search){set, vertices, rounded * size}, convex)) {
        GN_TRY(make_faces(set, size, convex, error));
    } else {
        gn_convex_free(convex);
    }
    return GNEISS_OK;
}

void gn_convex_free(gn_convex *convex) {
    gn_free(convex->plane);
    gn_free(convex->corner);
    gn_free(convex->on);
    *convex = (gn_convex){0};
}
