#include "measure/delaunay.h"

#include "base/new.h"

#include <libqhull_r/qhull_ra.h>

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Qt splits the cells of points on a common sphere into simplices, Qbb scales the lifted
 * coordinate, Qc excludes points on a facet from the hull, Qz adds a point at infinity so that
 * points that are all on one sphere (a single lattice cell) do not lift to a plane, Q12 accepts the
 * wide merged facets of lattices. Qhull only provides topology: volumes are computed from the
 * points themselves. */
static char delaunay_command[] = "qhull d Qt Qbb Qc Qz Q12";
static char hull_command[] = "qhull FA";
/* Qc keeps the points that lie on a facet, within the tolerance of option U. */
static char faces_command[] = "qhull FA Qc U1e-9";
/* The command for any triangles that cover the hull. */
static char triangles_command[] = "qhull FA Qt";
static const double clear_of_faces = 1e-9;

/* Ratio of height to extent below which points count as lying on a plane; Qhull's own limit is
 * round-off. */
static const double flat_tolerance = 1e-9;

/* One run of Qhull, whose messages are stored instead of printed. */
typedef struct qhull_run {
    qhT *qh;
    FILE *messages;
    char *text;
    size_t text_size;
} qhull_run;

static gneiss_status qhull_open(qhull_run *run, gneiss_error *error) {
    *run = (qhull_run){.qh = gn_alloc(sizeof(qhT))};
    if (run->qh) run->messages = open_memstream(&run->text, &run->text_size);
    if (run->messages) return GNEISS_OK;
    gn_free(run->qh);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a run of Qhull");
}

static void qhull_close(qhull_run *run) {
    int kept, kept_bytes;
    qh_freeqhull(run->qh, !qh_ALL);
    qh_memfreeshort(run->qh, &kept, &kept_bytes);
    fclose(run->messages);
    free(run->text);
    gn_free(run->qh);
}

/* Runs `command`. Qhull fails by longjmp into qh_new_qhull, which turns errors into a code. */
static gneiss_status qhull_run_command(qhull_run *run, char *command, const double *points,
                                       size_t count, int dimension, gneiss_error *error) {
    qh_zero(run->qh, run->messages);
    /* The points are read only: no option used here scales or rotates them in place. */
    int code = qh_new_qhull(run->qh, dimension, (int)count, (coordT *)points, False, command, NULL,
                            run->messages);
    if (code == qh_ERRnone) return GNEISS_OK;
    fflush(run->messages);
    const char *text = run->text ? run->text : "";
    while (*text == '\n') text++;
    gneiss_status status = code == qh_ERRmem ? GNEISS_ERROR_MEMORY : GNEISS_ERROR_INPUT;
    return gn_fail(error, status, "%s of %zu points in %dD failed with code %d: %.*s", command,
                   count, dimension, code, (int)strcspn(text, "\n"), text);
}

/* --- points without volume --- */

/* Removes from `x` the components along `rank` unit directions; returns the norm of the rest. */
static double remainder_of(double x[3], int dimension, double direction[][3], int rank) {
    for (int k = 0; k < rank; k++) {
        double along = 0;
        for (int a = 0; a < dimension; a++) along += x[a] * direction[k][a];
        for (int a = 0; a < dimension; a++) x[a] -= along * direction[k][a];
    }
    double square = 0;
    for (int a = 0; a < dimension; a++) square += x[a] * x[a];
    return sqrt(square);
}

/* Tells whether points are flat: Gram-Schmidt is applied to the point farthest from the plane found
 * so far. */
static bool is_flat(const double *points, size_t count, int dimension) {
    if (count < (size_t)dimension + 1) return true;
    double direction[3][3], extent = 0;
    for (int rank = 0; rank < dimension; rank++) {
        double largest = 0, x[3];
        for (size_t k = 1; k < count; k++) {
            for (int a = 0; a < dimension; a++) x[a] = points[k * dimension + a] - points[a];
            double height = remainder_of(x, dimension, direction, rank);
            if (height <= largest) continue;
            largest = height;
            for (int a = 0; a < dimension; a++) direction[rank][a] = x[a] / height;
        }
        if (rank == 0) extent = largest;
        if (largest <= flat_tolerance * extent) return true;
    }
    return false;
}

/* Copies the points in units of their extent, with the first one as origin, because lifting squares
 * coordinates. */
static gneiss_status normalised(const double *points, size_t count, int dimension, double **copy,
                                double *unit, gneiss_error *error) {
    double extent = 0;
    for (size_t k = 0; k < count * dimension; k++) {
        double x = points[k] - points[k % dimension];
        if (!isfinite(x))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "coordinate %zu of point %zu: expected a finite number, found %g",
                           k % dimension, k / dimension, points[k]);
        extent = fmax(extent, fabs(x));
    }
    if (count > INT_MAX / 4)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected at most %d points, found %zu",
                       INT_MAX / 4, count);
    *copy = gn_alloc_array(count * dimension, sizeof(double));
    if (!*copy) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu points", count);
    *unit = extent > 0 ? extent : 1;
    for (size_t k = 0; k < count * dimension; k++)
        (*copy)[k] = (points[k] - points[k % dimension]) / *unit;
    return GNEISS_OK;
}

/* --- triangulation --- */

static gneiss_status take_simplices(qhT *qh, int dimension, gn_triangulation *triangulation,
                                    gneiss_error *error) {
    facetT *facet;
    vertexT *vertex, **vertexp;
    size_t corners = (size_t)dimension + 1, count = 0;
    FORALLfacets count += !facet->upperdelaunay;
    GN_TRY(gn_new(&triangulation->vertex, count * corners, "simplices", error));
    FORALLfacets {
        if (facet->upperdelaunay) continue;
        int32_t *corner = triangulation->vertex + triangulation->count * corners;
        if (!facet->simplicial || qh_setsize(qh, facet->vertices) != dimension + 1)
            return gn_fail(error, GNEISS_ERROR_INTERNAL, "Qhull left a cell that is no simplex");
        size_t k = 0;
        FOREACHvertex_(facet->vertices) corner[k++] = qh_pointid(qh, vertex->point);
        if (facet->toporient ^ qh_ORIENTclock) {
            int32_t first = corner[0];
            corner[0] = corner[1];
            corner[1] = first;
        }
        triangulation->count++;
    }
    return GNEISS_OK;
}

gneiss_status gn_delaunay(const double *points, size_t count, int dimension,
                          gn_triangulation *triangulation, gneiss_error *error) {
    *triangulation = (gn_triangulation){.dimension = dimension};
    double *copy = NULL, unit;
    GN_TRY(normalised(points, count, dimension, &copy, &unit, error));
    qhull_run s;
    gneiss_status status = GNEISS_OK;
    if (!is_flat(copy, count, dimension)) {
        status = qhull_open(&s, error);
        if (status == GNEISS_OK) {
            status = qhull_run_command(&s, delaunay_command, copy, count, dimension, error);
            if (status == GNEISS_OK) status = take_simplices(s.qh, dimension, triangulation, error);
            qhull_close(&s);
        }
    }
    gn_free(copy);
    if (status != GNEISS_OK) gn_triangulation_free(triangulation);
    return status;
}

void gn_triangulation_free(gn_triangulation *triangulation) {
    gn_free(triangulation->vertex);
    *triangulation = (gn_triangulation){.dimension = triangulation->dimension};
}

/* --- hulls --- */

/* Tells whether a facet's neighbour is clearly outside of the facet's plane. */
static bool falls_off(qhT *qh, facetT *facet, const facetT *neighbor) {
    vertexT *vertex, **vertexp;
    realT above = -1.0;
    FOREACHvertex_(neighbor->vertices) {
        if (qh_setin(facet->vertices, vertex)) continue;
        qh_distplane(qh, vertex->point, facet, &above);
        if (!(above < -clear_of_faces)) return false;
    }
    return true;
}

/* Tells whether a facet is a simplex, no other point lies on it, and its neighbours are not in its
 * plane. */
static bool is_clear(qhT *qh, facetT *facet, int dimension) {
    facetT *neighbor = NULL, **neighborp;
    bool clear = true;
    if (!facet->simplicial || facet->coplanarset) return false;
    if (qh_setsize(qh, facet->vertices) != dimension) return false;
    FOREACHneighbor_(facet) clear = clear && falls_off(qh, facet, neighbor);
    return clear;
}

static gneiss_status take_faces(qhT *qh, int dimension, bool any, gn_triangulation *triangulation,
                                gneiss_error *error) {
    facetT *facet;
    vertexT *vertex, **vertexp;
    size_t count = 0, clear = 0;
    FORALLfacets {
        count++;
        clear +=
            any ? qh_setsize(qh, facet->vertices) == dimension : is_clear(qh, facet, dimension);
    }
    if (clear < count) return GNEISS_OK;
    GN_TRY(gn_new(&triangulation->vertex, count * (size_t)dimension, "faces", error));
    FORALLfacets {
        int32_t *corner = triangulation->vertex + triangulation->count++ * (size_t)dimension;
        FOREACHvertex_(facet->vertices) *corner++ = qh_pointid(qh, vertex->point);
    }
    return GNEISS_OK;
}

/* Computes the volume or area of the hull, m3 or m2, and that of its surface, m2 or m (may be
 * NULL), 0 for points on a plane or line; its faces too if they are requested. */
static gneiss_status hull_of(const double *points, size_t count, int dimension, char *command,
                             gn_triangulation *faces, double *volume, double *surface,
                             gneiss_error *error) {
    *volume = 0;
    if (surface) *surface = 0;
    double *copy = NULL, unit;
    GN_TRY(normalised(points, count, dimension, &copy, &unit, error));
    qhull_run s;
    gneiss_status status = GNEISS_OK;
    if (!is_flat(copy, count, dimension)) {
        status = qhull_open(&s, error);
        if (status == GNEISS_OK) {
            status = qhull_run_command(&s, command, copy, count, dimension, error);
            if (status == GNEISS_OK)
                *volume = s.qh->totvol * (dimension == 3 ? unit * unit * unit : unit * unit);
            if (status == GNEISS_OK && surface)
                *surface = s.qh->totarea * (dimension == 3 ? unit * unit : unit);
            if (status == GNEISS_OK && faces)
                status = take_faces(s.qh, dimension, command == triangles_command, faces, error);
            qhull_close(&s);
        }
    }
    gn_free(copy);
    return status;
}

gneiss_status gn_hull_faces(const double *points, size_t count, int dimension,
                            gn_triangulation *faces, double *volume, gneiss_error *error) {
    *faces = (gn_triangulation){.dimension = dimension};
    gneiss_status status =
        hull_of(points, count, dimension, faces_command, faces, volume, NULL, error);
    if (status != GNEISS_OK) gn_triangulation_free(faces);
    return status;
}

gneiss_status gn_hull_measure(const double *points, size_t count, int dimension,
                              gn_triangulation *faces, double *volume, double *surface,
                              gneiss_error *error) {
    *faces = (gn_triangulation){.dimension = dimension};
    gneiss_status status =
        hull_of(points, count, dimension, triangles_command, faces, volume, surface, error);
    if (status != GNEISS_OK) gn_triangulation_free(faces);
    return status;
}

gneiss_status gn_hull_triangles(const double *points, size_t count, int dimension,
                                gn_triangulation *faces, gneiss_error *error) {
    double volume;
    return gn_hull_measure(points, count, dimension, faces, &volume, NULL, error);
}

gneiss_status gn_hull_volume(const double *points, size_t count, int dimension, double *volume,
                             gneiss_error *error) {
    return hull_of(points, count, dimension, hull_command, NULL, volume, NULL, error);
}
