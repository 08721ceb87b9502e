/* Average strain of a particle assembly over a Delaunay triangulation: Bagi, K. (1996), Stress and
 * strain in granular assemblies, Mechanics of Materials 22, 165-177; used for bonded specimens by
 * Rojek et al. (2012) and Labra et al. (2012).
 *
 * In a simplex with corners p the displacement is linear and du_a/dx_b = sum_p u_a(p) dN_p/dx_b,
 * with V dN_p/dx = -A_p/d, A_p the outward area vector of the face opposite to p and d the
 * dimension. The sum of the outward area vectors of a simplex is zero, so that -A_p is the sum of
 * the other ones: V <du_a/dx_b> = sum over faces f of A_f,b times the mean of u_a over the corners
 * of f. A face between two simplices appears twice with opposite signs. Cancelling such pairs
 * before adding anything leaves the outer faces, and only particles on the outside get a weight. */
#include "base/new.h"
#include "measure/measure.h"

#include "base/eigen.h"
#include "base/random.h"
#include "measure/delaunay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative tolerance between the volume of the simplices and that of the hull: far above round-off,
 * and far below what would affect a strain. */
static const double tiling_tolerance = 1e-9;

typedef struct face {
    int32_t corner[3]; /* ascending; in 2D the third is 0 */
    int32_t sign;      /* +1: ascending corners are oriented outward, -1: inward */
} face;

typedef struct numbered {
    int32_t id, index;
} numbered;

static int compare_ids(const void *a, const void *b) {
    const numbered *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

static int compare_faces(const void *a, const void *b) {
    const face *x = a, *y = b;
    for (int k = 0; k < 3; k++)
        if (x->corner[k] != y->corner[k]) return x->corner[k] > y->corner[k] ? 1 : -1;
    return (x->sign > y->sign) - (x->sign < y->sign);
}

/* Tells whether a particle is held firmly. On two bonds it swings like a pendulum: its motion is no
 * strain of the body, but on the surface it would count like its neighbours. If particles on three
 * bonds are also excluded, Poisson's ratio of similar specimens scatters by 1 % instead of 10 %
 * (docs/evidence/packing.md). */
static bool is_held(const gn_particles *particles, size_t p, int dimension) {
    return !particles->bonds0 || particles->bonds0[p] > dimension;
}

void gn_strain_gauge_select(const gn_particles *particles, int dimension, uint8_t *counts) {
    const size_t count = particles->soa.count;
    size_t held = 0;
    for (size_t p = 0; p < count; p++) {
        counts[p] = is_held(particles, p, dimension);
        held += counts[p];
    }
    if (2 * held < count) memset(counts, 1, count); /* the body has almost no bonds */
}

/* Collects the initial centres in the order of the ids, relative to the first one, because the
 * triangulation of a lattice depends on the order of its points, and the order of particles on the
 * history of the run. */
static gneiss_status reference_points(const gn_particles *particles, const uint8_t *counts,
                                      int dimension, double **points, numbered **order,
                                      size_t *used, gneiss_error *error) {
    size_t count = particles->soa.count;
    *used = 0;
    *order = gn_alloc_array(count, sizeof **order);
    *points = gn_alloc_array(count * (size_t)dimension, sizeof **points);
    if (!*order || !*points)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a strain gauge of %zu particles",
                       count);
    for (size_t p = 0; p < count; p++)
        if (counts[p]) (*order)[(*used)++] = (numbered){particles->id[p], (int32_t)p};
    qsort(*order, *used, sizeof **order, compare_ids);
    for (size_t k = 0; k < *used; k++)
        for (int a = 0; a < dimension; a++)
            (*points)[k * dimension + a] = particles->start[4 * (size_t)(*order)[k].index + a] -
                                           particles->start[4 * (size_t)(*order)[0].index + a];
    return GNEISS_OK;
}

/* Returns d! times the signed volume of a simplex. */
static double simplex_volume(const double *points, const int32_t *corner, int dimension) {
    double e[3][3];
    for (int k = 0; k < dimension; k++)
        for (int a = 0; a < dimension; a++)
            e[k][a] = points[(size_t)corner[k + 1] * dimension + a] -
                      points[(size_t)corner[0] * dimension + a];
    if (dimension == 2) return e[0][0] * e[1][1] - e[0][1] * e[1][0];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
           e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* Computes the area vector of a face, towards the side from which its corners are
 * counter-clockwise; 2D: the edge rotated by -90 degrees, outward for a counter-clockwise outline.
 */
static void area_vector(const double *points, const int32_t *corner, int dimension,
                        double area[3]) {
    const double *p = points + (size_t)corner[0] * dimension;
    const double *q = points + (size_t)corner[1] * dimension;
    if (dimension == 2) {
        area[0] = q[1] - p[1];
        area[1] = p[0] - q[0];
        area[2] = 0;
        return;
    }
    const double *r = points + (size_t)corner[2] * dimension;
    double u[3], v[3];
    for (int a = 0; a < 3; a++) u[a] = q[a] - p[a], v[a] = r[a] - p[a];
    area[0] = 0.5 * (u[1] * v[2] - u[2] * v[1]);
    area[1] = 0.5 * (u[2] * v[0] - u[0] * v[2]);
    area[2] = 0.5 * (u[0] * v[1] - u[1] * v[0]);
}

/* Sorts the corners of a face; its sign changes with every exchange. */
static face sorted_face(const int32_t *corner, int dimension, int32_t sign) {
    face f = {.sign = sign};
    for (int k = 0; k < dimension; k++) f.corner[k] = corner[k];
    for (int k = 1; k < dimension; k++)
        for (int m = k; m > 0 && f.corner[m - 1] > f.corner[m]; m--) {
            int32_t other = f.corner[m];
            f.corner[m] = f.corner[m - 1];
            f.corner[m - 1] = other;
            f.sign = -f.sign;
        }
    return f;
}

/* Computes where the faces with each lowest corner start after sorting, [points + 1]. */
static void count_faces(const face *list, size_t all, size_t points, size_t *start) {
    memset(start, 0, (points + 1) * sizeof *start);
    for (size_t f = 0; f < all; f++) start[list[f].corner[0] + 1]++;
    for (size_t p = 0; p < points; p++) start[p + 1] += start[p];
}

/* Sorts faces into `sorted`: by their lowest corner with counters, then the few faces of each
 * corner by insertion. */
static void sort_faces(const face *list, size_t all, size_t points, size_t *start, face *sorted) {
    count_faces(list, all, points, start);
    for (size_t f = 0; f < all; f++) sorted[start[list[f].corner[0]]++] = list[f];
    for (size_t p = 0, begin = 0; p < points; begin = start[p++]) /* start[p] is now the end */
        qsort(sorted + begin, start[p] - begin, sizeof *sorted, compare_faces);
}

/* Removes pairs of opposite sign; returns the number of the rest. */
static size_t cancel_faces(face *list, size_t all) {
    size_t kept = 0;
    for (size_t f = 0; f < all; f++) {
        bool same = kept > 0;
        for (int a = 0; same && a < 3; a++) same = list[kept - 1].corner[a] == list[f].corner[a];
        if (same && list[kept - 1].sign == -list[f].sign)
            kept--;
        else
            list[kept++] = list[f];
    }
    return kept;
}

/* Lists all faces of all simplices. `turn` is their common orientation. The face of a positive
 * simplex 0..d opposite to corner k has the remaining corners, in their order, oriented outward by
 * (-1)^k. */
static void list_faces(const gn_triangulation *triangulation, int32_t turn, face *list) {
    size_t corners = (size_t)triangulation->dimension + 1;
    for (size_t s = 0; s < triangulation->count; s++)
        for (size_t k = 0; k < corners; k++) {
            int32_t rest[3] = {0}, n = 0;
            for (size_t m = 0; m < corners; m++)
                if (m != k) rest[n++] = triangulation->vertex[s * corners + m];
            int32_t outward = k % 2 ? -1 : 1;
            list[s * corners + k] = sorted_face(rest, triangulation->dimension, outward * turn);
        }
}

/* Lists the faces of simplices over `points` points, sorted, without pairs of opposite sign;
 * `count` of them remain. */
static gneiss_status outer_faces(const gn_triangulation *triangulation, size_t points, int32_t turn,
                                 face **faces, size_t *count, gneiss_error *error) {
    size_t all = triangulation->count * ((size_t)triangulation->dimension + 1);
    face *list = gn_alloc_array(all, sizeof *list), *sorted = gn_alloc_array(all, sizeof *sorted);
    size_t *start = gn_alloc_array(points + 1, sizeof *start);
    bool room = list && sorted && start;
    if (room) {
        list_faces(triangulation, turn, list);
        sort_faces(list, all, points, start, sorted);
        *count = cancel_faces(sorted, all);
        *faces = sorted;
    }
    gn_free(start);
    gn_free(list);
    if (room) return GNEISS_OK;
    gn_free(sorted);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu faces", all);
}

/* Adds the faces to the weights [points][3]; returns the volume they enclose by the divergence
 * theorem. */
static double add_faces(const face *faces, size_t count, const double *points, int dimension,
                        double *weight) {
    double volume = 0;
    for (size_t f = 0; f < count; f++) {
        double area[3], centre[3] = {0};
        area_vector(points, faces[f].corner, dimension, area);
        for (int k = 0; k < dimension; k++) {
            size_t p = (size_t)faces[f].corner[k];
            for (int a = 0; a < dimension; a++) {
                weight[3 * p + a] += faces[f].sign * area[a] / dimension;
                centre[a] += points[p * dimension + a] / dimension;
            }
        }
        for (int a = 0; a < dimension; a++)
            volume += faces[f].sign * area[a] * centre[a] / dimension;
    }
    return volume;
}

/* Checks that the simplices fill the hull exactly once, without holes and overlaps. */
static gneiss_status check_tiling(const gn_triangulation *triangulation, const double *points,
                                  size_t count, double enclosed, gneiss_error *error) {
    double hull, filled = 0;
    GN_TRY(gn_hull_volume(points, count, triangulation->dimension, &hull, error));
    for (size_t s = 0; s < triangulation->count; s++)
        filled += fabs(simplex_volume(
                      points, triangulation->vertex + s * (size_t)(triangulation->dimension + 1),
                      triangulation->dimension)) /
                  (triangulation->dimension == 3 ? 6 : 2);
    if (fabs(filled - hull) <= tiling_tolerance * hull &&
        fabs(enclosed - hull) <= tiling_tolerance * hull)
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INTERNAL,
                   "the %zu simplices of %zu points should fill their hull of %.17g: their volumes "
                   "add up to %.17g and their outside encloses %.17g",
                   triangulation->count, count, hull, filled, enclosed);
}

static gneiss_status take_weights(const double *weight, size_t count, const numbered *order,
                                  gn_strain_gauge *gauge, gneiss_error *error) {
    size_t used = 0;
    for (size_t k = 0; k < count; k++)
        used += weight[3 * k] != 0 || weight[3 * k + 1] != 0 || weight[3 * k + 2] != 0;
    GN_TRY(gn_new(&gauge->id, used, "a strain gauge of particles", error));
    GN_TRY(gn_new(&gauge->weight, 3 * used, "a strain gauge of particles", error));
    for (size_t k = 0; k < count; k++) {
        const double *w = weight + 3 * k;
        if (w[0] == 0 && w[1] == 0 && w[2] == 0) continue;
        gauge->id[gauge->count] = order[k].id;
        for (int a = 0; a < 3; a++) gauge->weight[3 * gauge->count + a] = w[a] / gauge->volume;
        gauge->count++;
    }
    return GNEISS_OK;
}

/* Returns the sign of the summed volume, +1 or -1, which is common to all simplices. */
static int32_t common_turn(const gn_triangulation *triangulation, const double *points) {
    double sum = 0;
    for (size_t s = 0; s < triangulation->count; s++)
        sum += simplex_volume(points,
                              triangulation->vertex + s * (size_t)(triangulation->dimension + 1),
                              triangulation->dimension);
    return sum < 0 ? -1 : 1;
}

static gneiss_status gauge_fill(const gn_triangulation *triangulation, const double *points,
                                size_t count, const numbered *order, gn_strain_gauge *gauge,
                                gneiss_error *error) {
    face *faces = NULL;
    size_t face_count = 0;
    GN_TRY(outer_faces(triangulation, count, common_turn(triangulation, points), &faces,
                       &face_count, error));
    double *weight = gn_alloc_array(3 * count, sizeof *weight);
    gneiss_status status = GNEISS_OK;
    if (!weight)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu weights", 3 * count);
    else
        gauge->volume = add_faces(faces, face_count, points, triangulation->dimension, weight);
    if (status == GNEISS_OK)
        status = check_tiling(triangulation, points, count, gauge->volume, error);
    if (status == GNEISS_OK) status = take_weights(weight, count, order, gauge, error);
    gn_free(weight);
    gn_free(faces);
    return status;
}

/* --- by the hull --- */

/* Returns the orientation of a face as seen from outside; `inside` is a point of the hull. */
static int32_t outward(const double *points, const int32_t *corner, int dimension,
                       const double inside[3]) {
    double area[3], along = 0.0;
    area_vector(points, corner, dimension, area);
    for (int a = 0; a < dimension; a++)
        along += area[a] * (points[(size_t)corner[0] * dimension + a] - inside[a]);
    return along < 0.0 ? -1 : 1;
}

/* Computes the weights of the faces of the hull of `shown`, with the original positions of the
 * points, in the same order as those of a triangulation. */
static gneiss_status weigh_hull(const gn_triangulation *hull, const double *shown,
                                const double *points, size_t count, double *weight, double *volume,
                                gneiss_error *error) {
    const int dimension = hull->dimension;
    double inside[3] = {0};
    face *faces = NULL;
    GN_TRY(gn_new(&faces, hull->count, "faces", error));
    for (size_t k = 0; k < count * (size_t)dimension; k++)
        inside[k % (size_t)dimension] += shown[k] / (double)count;
    for (size_t f = 0; f < hull->count; f++) {
        const int32_t *corner = hull->vertex + f * (size_t)dimension;
        faces[f] = sorted_face(corner, dimension, outward(shown, corner, dimension, inside));
    }
    qsort(faces, hull->count, sizeof *faces, compare_faces);
    *volume = add_faces(faces, hull->count, points, dimension, weight);
    gn_free(faces);
    return GNEISS_OK;
}

/* Makes the gauge by the hull. If the outside of the triangulation is certainly the hull, its faces
 * give the same weights in a small fraction of the time. *found tells whether it is; otherwise a
 * triangulation is needed. */
static gneiss_status gauge_by_hull(const double *points, size_t count, int dimension,
                                   const numbered *order, gn_strain_gauge *gauge, bool *found,
                                   gneiss_error *error) {
    gn_triangulation hull;
    gneiss_error why;
    double volume = 0.0;
    gneiss_status status = gn_hull_faces(points, count, dimension, &hull, &volume, &why);
    *found = false;
    if (status == GNEISS_ERROR_MEMORY) return gn_fail(error, status, "%s", why.message);
    if (status != GNEISS_OK || !hull.count) return GNEISS_OK;
    double *weight = gn_alloc_array(3 * count, sizeof *weight);
    status = weight ? weigh_hull(&hull, points, points, count, weight, &gauge->volume, error)
                    : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu weights", 3 * count);
    *found = fabs(gauge->volume - volume) <= tiling_tolerance * volume;
    if (status == GNEISS_OK && *found) status = take_weights(weight, count, order, gauge, error);
    gn_free(weight);
    gn_triangulation_free(&hull);
    return status;
}

/* Points on flat faces are moved inward by this fraction of their squared distance from the middle
 * over the extent. Such a face is then vaulted like a paraboloid: all of its points are corners of
 * the hull, in the triangles of a Delaunay triangulation of the face. A further random fraction
 * resolves the ambiguity of lattices. */
static const double vault = 0.01, vault_random = 1e-6;

static double *vaulted(const double *points, size_t count, int dimension, const numbered *order) {
    const size_t d = (size_t)dimension;
    double middle[3] = {0}, extent2 = 0.0, *shown = gn_alloc_array(count * d, sizeof *shown);
    for (size_t k = 0; k < count * d; k++) middle[k % d] += points[k] / (double)count;
    for (size_t pass = 0; shown && pass < 2; pass++)
        for (size_t k = 0; k < count; k++) {
            double way2 = 0.0;
            for (size_t a = 0; a < d; a++) {
                const double way = points[k * d + a] - middle[a];
                way2 += way * way;
            }
            extent2 = fmax(extent2, way2);
            const double random = gn_random_symmetric(1, (uint64_t)order[k].id);
            const double left = 1.0 - vault * way2 / extent2 - vault_random * random;
            for (size_t a = 0; pass == 1 && a < d; a++)
                shown[k * d + a] = left * (points[k * d + a] - middle[a]);
        }
    return shown;
}

/* Tells whether a surface is closed: the areas of its faces add up to zero. */
static bool is_closed(const double *weight, size_t count) {
    double sum[3] = {0}, size = 0.0;
    for (size_t k = 0; k < 3 * count; k++) {
        sum[k % 3] += weight[k];
        size += fabs(weight[k]);
    }
    return fabs(sum[0]) + fabs(sum[1]) + fabs(sum[2]) <= tiling_tolerance * size;
}

/* Makes a gauge by the hull of the points with flat faces vaulted, which also works for lattices
 * and takes a tenth of the time of a triangulation; any closed surface with particles as corners
 * serves. *found tells whether there is one. */
static gneiss_status gauge_by_vault(const double *points, size_t count, int dimension,
                                    const numbered *order, gn_strain_gauge *gauge, bool *found,
                                    gneiss_error *error) {
    gn_triangulation hull = {0};
    gneiss_error why;
    double *shown = vaulted(points, count, dimension, order);
    double *weight = gn_alloc_array(3 * count, sizeof *weight);
    gneiss_status status = shown && weight ? GNEISS_OK
                                           : gn_fail(error, GNEISS_ERROR_MEMORY,
                                                     "no memory for %zu weights", 3 * count);
    *found = false;
    if (status == GNEISS_OK)
        *found = gn_hull_triangles(shown, count, dimension, &hull, &why) == GNEISS_OK && hull.count;
    if (*found) status = weigh_hull(&hull, shown, points, count, weight, &gauge->volume, error);
    *found = *found && status == GNEISS_OK && gauge->volume > 0.0 && is_closed(weight, count);
    if (*found) status = take_weights(weight, count, order, gauge, error);
    gn_free(weight);
    gn_free(shown);
    gn_triangulation_free(&hull);
    return status;
}

/* Largest number of particles of a lattice that is triangulated. */
static const size_t triangulated_most = 50000;

static gneiss_status gauge_of(const gn_particles *particles, const uint8_t *counts, int dimension,
                              bool soon, gn_strain_gauge *gauge, gneiss_error *error) {
    *gauge = (gn_strain_gauge){0};
    if (particles->soa.count < (size_t)dimension + 1) return GNEISS_OK;
    gn_triangulation triangulation = {0};
    double *points = NULL;
    numbered *order = NULL;
    size_t count;
    gneiss_status status =
        reference_points(particles, counts, dimension, &points, &order, &count, error);
    bool found = false;
    if (status == GNEISS_OK)
        status = gauge_by_hull(points, count, dimension, order, gauge, &found, error);
    /* A triangulation takes 1.9 kB and 0.1 ms per particle. */
    if (status == GNEISS_OK && !found && (soon || count > triangulated_most))
        status = gauge_by_vault(points, count, dimension, order, gauge, &found, error);
    if (status == GNEISS_OK && !found)
        status = gn_delaunay(points, count, dimension, &triangulation, error);
    if (status == GNEISS_OK && triangulation.count > 0)
        status = gauge_fill(&triangulation, points, count, order, gauge, error);
    gn_triangulation_free(&triangulation);
    gn_free(points);
    gn_free(order);
    if (status != GNEISS_OK) {
        gn_strain_gauge_free(gauge);
        gn_fail_context(error, "strain gauge: ");
    }
    return status;
}

gneiss_status gn_strain_gauge_of(const gn_particles *particles, const uint8_t *counts,
                                 int dimension, gn_strain_gauge *gauge, gneiss_error *error) {
    return gauge_of(particles, counts, dimension, false, gauge, error);
}

gneiss_status gn_strain_gauge_fast(const gn_particles *particles, const uint8_t *counts,
                                   int dimension, gn_strain_gauge *gauge, gneiss_error *error) {
    return gauge_of(particles, counts, dimension, true, gauge, error);
}

void gn_strain_gauge_free(gn_strain_gauge *gauge) {
    gn_free(gauge->id);
    gn_free(gauge->weight);
    *gauge = (gn_strain_gauge){0};
}

void gn_strain_gauge_read(const gn_strain_gauge *gauge, const gn_particles *particles,
                          const int32_t *index_of_id, double gradient[9]) {
    for (int k = 0; k < 9; k++) gradient[k] = gauge->count ? 0 : NAN;
    for (size_t k = 0; k < gauge->count; k++) {
        int32_t p = index_of_id[gauge->id[k]];
        if (p < 0) continue;
        for (int a = 0; a < 3; a++) {
            double u = particles->pos[4 * (size_t)p + a] - particles->start[4 * (size_t)p + a];
            for (int b = 0; b < 3; b++) gradient[3 * a + b] += u * gauge->weight[3 * k + b];
        }
    }
}

/* Uses the eigenvalues e of F^T F - 1 = g + g^T + g^T g, so that small strains lose no digits:
 * those of U - 1 are e/(1 + sqrt(1 + e)). */
void gn_strain_of(const double g[9], double strain[9]) {
    double twice[9], value[3], vector[9];
    for (int k = 0; k < 9; k++) strain[k] = isfinite(g[k]) ? 0.0 : NAN;
    for (int k = 0; k < 9; k++)
        if (isnan(strain[k])) return;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            twice[3 * a + b] = g[3 * a + b] + g[3 * b + a];
            for (int c = 0; c < 3; c++) twice[3 * a + b] += g[3 * c + a] * g[3 * c + b];
        }
    gn_eigen_symmetric(3, twice, value, vector);
    for (int e = 0; e < 3; e++) {
        double share = value[e] / (1.0 + sqrt(fmax(1.0 + value[e], 0.0)));
        for (int k = 0; k < 9; k++)
            strain[k] += share * vector[3 * e + k / 3] * vector[3 * e + k % 3];
    }
}
