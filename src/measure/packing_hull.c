/* The convex hull of a packing, and its extent. */
#include "base/eigen.h"
#include "base/memory.h"
#include "measure/assembly.h"
#include "measure/delaunay.h"
#include "soa/particle_state.h"

#include <string.h>

/* --- extent --- */

static void packing_extent(const gn_particles *particles, double lower[3], double upper[3]) {
    bool any = false;
    for (int a = 0; a < 3; a++) lower[a] = upper[a] = NAN;
    for (size_t p = 0; p < particles->soa.count; p++) {
        if (!gn_particle_is_active(particles, p)) continue;
        const double *x = particles->pos + 4 * p;
        for (int a = 0; a < 3; a++) {
            lower[a] = any ? fmin(lower[a], x[a] - x[3]) : x[a] - x[3];
            upper[a] = any ? fmax(upper[a], x[a] + x[3]) : x[a] + x[3];
        }
        any = true;
    }
}

/* --- exclusion of inner particles --- */

/* Qhull takes seconds for the points of 1e5 spheres, nearly all of which are well inside the hull.
 * Half-spaces n.x <= offset whose intersection lies in the hull exclude these beforehand. */
enum { LOOKS = 96, FACES_MOST = 2 * LOOKS, BLOCK = 256 };

typedef struct half_spaces {
    size_t count;
    double normal[FACES_MOST][3], offset[FACES_MOST];
} half_spaces;

/* Computes direction k of an evenly distributed set: a spiral over the sphere (Gonzalez 2010,
 * lattice of Fibonacci), or equal angles. */
static void look(int dimension, int k, double direction[3]) {
    const double golden = M_PI * (3 - sqrt(5));
    double turn = dimension == 3 ? golden * k : 2 * M_PI * k / LOOKS;
    double z = dimension == 3 ? 1 - (2 * k + 1.0) / LOOKS : 0, across = sqrt(1 - z * z);
    direction[0] = across * cos(turn);
    direction[1] = across * sin(turn);
    direction[2] = z;
}

/* Returns the particle that is farthest out in a direction. */
static size_t farthest(const gn_particles *particles, const double n[3]) {
    size_t found = 0;
    double most = -INFINITY;
    for (size_t p = 0; p < particles->soa.count; p++) {
        const double *x = particles->pos + 4 * p;
        double reach = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
        if (reach > most && gn_particle_is_active(particles, p)) most = reach, found = p;
    }
    return found;
}

/* Computes the centres of outer particles, each moved towards the middle by a different small
 * amount, so that no four of them lie in a plane, as they do in a lattice. */
static void outer_points(const gn_particles *particles, int dimension, const double middle[3],
                         double *points) {
    const double most = 1e-2, golden = 0.6180339887498949;
    for (int k = 0; k < LOOKS; k++) {
        double direction[3], whole, part = most * (0.1 + modf(golden * (k + 1), &whole));
        look(dimension, k, direction);
        const double *x = particles->pos + 4 * farthest(particles, direction);
        for (int a = 0; a < dimension; a++)
            points[k * dimension + a] = x[a] + part * (middle[a] - x[a]);
    }
}

/* Computes the half-space of the face through these corners, which contains the middle; returns
 * false if the face has no area. */
static bool half_space_of(const double *points, const int32_t *corner, int dimension,
                          const double middle[3], half_spaces *spaces) {
    const double *x = points + corner[0] * dimension, *y = points + corner[1] * dimension;
    double *n = spaces->normal[spaces->count], e[3] = {0}, f[3] = {0, 0, 1};
    for (int a = 0; a < dimension; a++) {
        e[a] = y[a] - x[a];
        if (dimension == 3) f[a] = points[corner[2] * dimension + a] - x[a];
    }
    double offset = 0, height = 0, length;
    for (int a = 0; a < 3; a++)
        n[a] = e[(a + 1) % 3] * f[(a + 2) % 3] - e[(a + 2) % 3] * f[(a + 1) % 3];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return false;
    for (int a = 0; a < 3; a++) n[a] /= length;
    for (int a = 0; a < dimension; a++) {
        offset += n[a] * x[a];
        height += n[a] * (x[a] - middle[a]);
    }
    for (int a = 0; a < 3; a++) n[a] = height < 0 ? -n[a] : n[a];
    spaces->offset[spaces->count++] = height < 0 ? -offset : offset;
    return true;
}

/* Computes a body inside the hull; none if there are too few particles for it to matter, or if no
 * body is found. */
static void inner_body(const gn_particles *particles, int dimension, const double lower[3],
                       const double upper[3], half_spaces *spaces) {
    const size_t few = 1000;
    double points[LOOKS * 3], middle[3], volume;
    gn_triangulation faces;
    spaces->count = 0;
    if (particles->soa.count < few) return;
    for (int a = 0; a < 3; a++) middle[a] = 0.5 * (lower[a] + upper[a]);
    outer_points(particles, dimension, middle, points);
    if (gn_hull_faces(points, LOOKS, dimension, &faces, &volume, NULL) != GNEISS_OK) return;
    bool whole = faces.count > 0 && faces.count <= FACES_MOST;
    for (size_t f = 0; whole && f < faces.count; f++)
        whole =
            half_space_of(points, faces.vertex + f * (size_t)dimension, dimension, middle, spaces);
    if (!whole) spaces->count = 0;
    gn_triangulation_free(&faces);
}

/* Finds which of up to BLOCK particles lie entirely inside the body; a NaN does not. */
static void find_inside(const double *pos, size_t count, const half_spaces *spaces, double margin,
                        int32_t inside[BLOCK]) {
    double x[4][BLOCK];
    for (size_t p = 0; p < count; p++) {
        for (int a = 0; a < 4; a++) x[a][p] = pos[4 * p + a];
        inside[p] = spaces->count > 0;
    }
    for (size_t f = 0; f < spaces->count; f++) {
        const double *n = spaces->normal[f], limit = spaces->offset[f] - margin;
        for (size_t p = 0; p < count; p++)
            inside[p] &= n[0] * x[0][p] + n[1] * x[1][p] + n[2] * x[2][p] + x[3][p] <= limit;
    }
}

/* --- the core of the hull --- */

/* Returns the [count] particles that may touch the hull; NULL: no memory. */
static int32_t *outer_particles(const gn_particles *particles, int dimension, const double lower[3],
                                const double upper[3], size_t *count) {
    const double rounding = 1e-9;
    int32_t inside[BLOCK], *outer = gn_alloc_array(particles->soa.count + 1, sizeof *outer);
    half_spaces s;
    double extent = 0;
    *count = 0;
    if (!outer) return NULL;
    for (int a = 0; a < 3; a++) extent = fmax(extent, fmax(fabs(lower[a]), fabs(upper[a])));
    inner_body(particles, dimension, lower, upper, &s);
    for (size_t first = 0; first < particles->soa.count; first += BLOCK) {
        size_t n = particles->soa.count - first < BLOCK ? particles->soa.count - first : BLOCK;
        find_inside(particles->pos + 4 * first, n, &s, rounding * extent, inside);
        for (size_t p = 0; p < n; p++)
            if (!inside[p] && gn_particle_is_active(particles, first + p))
                outer[(*count)++] = (int32_t)(first + p);
    }
    return outer;
}

/* Outer particles, with radii reduced by the smallest one, r. The hull of the balls is the
 * Minkowski sum of their hull and a ball of radius r, and Steiner's formula gives its volume,
 *
 *   V = V' + S' r + M' r^2 + 4/3 pi r^3,     in 2D  A = A' + L' r + pi r^2,
 *
 * with S' the surface and M' the integral of the mean curvature, which is that of the reach h'(n) =
 * max(n.x + r_i - r) over all directions n (Schneider 2014, Convex Bodies, 4.2 and 5.3). For equal
 * radii the reduced hull is a polytope. */
typedef struct core {
    size_t count;
    double radius; /* r */
    double middle[3];
    double *x[3], *rest; /* [count] from the middle; r_i - r */
} core;

static void core_free(core *inner) {
    for (int a = 0; a < 3; a++) gn_free(inner->x[a]);
    gn_free(inner->rest);
}

static gneiss_status make_core(const gn_particles *particles, const int32_t *outer, size_t count,
                               const double lower[3], const double upper[3], core *inner,
                               gneiss_error *error) {
    *inner = (core){
        .count = count, .radius = INFINITY, .rest = gn_alloc_array(count + 1, sizeof(double))};
    bool held = inner->rest;
    for (int a = 0; a < 3; a++) {
        inner->middle[a] = 0.5 * (lower[a] + upper[a]);
        inner->x[a] = gn_alloc_array(count + 1, sizeof *inner->x[a]);
        held = held && inner->x[a];
    }
    if (!held)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the hull of %zu particles",
                       count);
    for (size_t o = 0; o < count; o++)
        inner->radius = fmin(inner->radius, particles->pos[4 * (size_t)outer[o] + 3]);
    for (size_t o = 0; o < count; o++) {
        const double *x = particles->pos + 4 * (size_t)outer[o];
        for (int a = 0; a < 3; a++) inner->x[a][o] = x[a] - inner->middle[a];
        inner->rest[o] = x[3] - inner->radius;
    }
    return GNEISS_OK;
}

/* Computes h'(n), and h'(-n) if it is requested. */
static double reach_of(const core *inner, const double n[3], double *back) {
    double most = -INFINITY, behind = -INFINITY;
    for (size_t k = 0; k < inner->count; k++) {
        const double d = n[0] * inner->x[0][k] + n[1] * inner->x[1][k] + n[2] * inner->x[2][k];
        most = d + inner->rest[k] > most ? d + inner->rest[k] : most;
        behind = inner->rest[k] - d > behind ? inner->rest[k] - d : behind;
    }
    if (back) *back = behind;
    return most;
}

enum { AXES = 2048 };

/* Returns the integral of h' over all directions, which is exact for centrally symmetric bodies and
 * for translations. */
static double curvature_of(const core *inner) {
    const double golden = M_PI * (3 - sqrt(5));
    double sum = 0;
    for (int k = 0; k < AXES; k++) {
        const double z = (k + 0.5) / AXES, across = sqrt(1 - z * z), turn = golden * k;
        const double n[3] = {across * cos(turn), across * sin(turn), z};
        double back, most = reach_of(inner, n, &back);
        sum += most + back;
    }
    return 4 * M_PI * sum / (2 * AXES);
}

/* --- hull of the core --- */

typedef struct cloud {
    double *x; /* [room][dimension] */
    size_t count, room;
} cloud;

static gneiss_status add_point(cloud *points, const double x[3], int dimension,
                               gneiss_error *error) {
    if (points->count == points->room) {
        const size_t room = 2 * points->room + 64, width = (size_t)dimension * sizeof *points->x;
        double *more = gn_alloc_array(room, width);
        if (!more) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu points", room);
        if (points->count) memcpy(more, points->x, points->count * width);
        gn_free(points->x);
        points->x = more;
        points->room = room;
    }
    memcpy(points->x + points->count++ * (size_t)dimension, x, (size_t)dimension * sizeof *x);
    return GNEISS_OK;
}

/* Adds the point of the core that is farthest out in a direction. */
static gneiss_status add_farthest(const core *inner, const double n[3], int dimension,
                                  cloud *points, gneiss_error *error) {
    const double reach = reach_of(inner, n, NULL);
    size_t at = 0;
    while (at + 1 < inner->count && n[0] * inner->x[0][at] + n[1] * inner->x[1][at] +
                                            n[2] * inner->x[2][at] + inner->rest[at] <
                                        reach)
        at++;
    const double x[3] = {inner->x[0][at] + inner->rest[at] * n[0],
                         inner->x[1][at] + inner->rest[at] * n[1],
                         inner->x[2][at] + inner->rest[at] * n[2]};
    return add_point(points, x, dimension, error);
}

/* Computes the area (2D: length) and outward normal of a face; `inside` is a point in the hull. */
static double face_of(const double *points, const int32_t *corner, int dimension,
                      const double inside[3], double n[3], double *offset) {
    const double *x = points + corner[0] * dimension, *y = points + corner[1] * dimension;
    double e[3] = {0}, f[3] = {0, 0, 1}, height = 0;
    for (int a = 0; a < dimension; a++) {
        e[a] = y[a] - x[a];
        if (dimension == 3) f[a] = points[corner[2] * dimension + a] - x[a];
    }
    for (int a = 0; a < 3; a++)
        n[a] = e[(a + 1) % 3] * f[(a + 2) % 3] - e[(a + 2) % 3] * f[(a + 1) % 3];
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(size > 0)) return 0;
    for (int a = 0; a < dimension; a++) height += n[a] * (x[a] - inside[a]);
    *offset = 0;
    for (int a = 0; a < 3; a++) n[a] *= (height < 0 ? -1 : 1) / size;
    for (int a = 0; a < dimension; a++) *offset += n[a] * x[a];
    return dimension == 3 ? 0.5 * size : size;
}

/* Adds the farthest points beyond faces that the core exceeds by more than `gap`; *missing: sum of
 * areas times these distances. */
static gneiss_status refine(const core *inner, int dimension, double gap,
                            const gn_triangulation *faces, cloud *points, bool *more,
                            double *missing, gneiss_error *error) {
    const size_t known = points->count;
    *missing = 0;
    double inside[3] = {0};
    for (size_t k = 0; k < known; k++)
        for (int a = 0; a < dimension; a++)
            inside[a] += points->x[k * (size_t)dimension + (size_t)a] / (double)known;
    *more = false;
    for (size_t f = 0; f < faces->count; f++) {
        double n[3], offset;
        const int32_t *corner = faces->vertex + f * (size_t)dimension;
        const double area = face_of(points->x, corner, dimension, inside, n, &offset);
        const double out = area > 0 ? reach_of(inner, n, NULL) - offset : 0;
        *missing += area * fmax(out, 0);
        if (!(out > gap)) continue;
        GN_TRY(add_farthest(inner, n, dimension, points, error));
        *more = true;
    }
    return GNEISS_OK;
}

/* Measures a flat core, which has two sides. Its normal is the direction in which its extent is
 * smallest. */
static gneiss_status measure_flat(const core *inner, int dimension, double *surface,
                                  gneiss_error *error) {
    double matrix[9] = {0}, mean[3] = {0}, values[3], axes[9], area = 0;
    double *flat = gn_alloc_array(inner->count + 1, 2 * sizeof *flat);
    if (!flat) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a flat hull");
    for (size_t k = 0; k < inner->count; k++)
        for (int a = 0; a < 3; a++) mean[a] += inner->x[a][k] / (double)inner->count;
    for (size_t k = 0; k < inner->count; k++)
        for (int a = 0; a < 9; a++)
            matrix[a] += (inner->x[a / 3][k] - mean[a / 3]) * (inner->x[a % 3][k] - mean[a % 3]);
    gn_eigen_symmetric(3, matrix, values, axes);
    for (size_t k = 0; k < inner->count; k++)
        for (int b = 0; b < 2; b++) {
            flat[2 * k + (size_t)b] = 0;
            for (int a = 0; a < 3; a++) flat[2 * k + (size_t)b] += axes[3 * b + a] * inner->x[a][k];
        }
    double back, along = reach_of(inner, axes, &back);
    gneiss_status status = GNEISS_OK;
    if (dimension == 3) status = gn_hull_volume(flat, inner->count, 2, &area, error);
    *surface = dimension == 3 ? 2 * area : 2 * (along + back);
    gn_free(flat);
    return status;
}

/* Tolerances relative to the volume, for balls and for a polytope, of the sum of faces times the
 * distance by which the core exceeds them. The volume between faces and a ball is 3/4 of that for
 * equilateral triangles and 2/3 on a cylinder (and in 2D); it is added. */
static const double of_balls = 5e-4, of_polytope = 1e-7, between = 2.0 / 3.0;
enum { ROUNDS = 12, POINTS_MOST = 200000 };

/* Computes the hull of points of the core. It grows until the core exceeds no face by more than the
 * distance that the tolerance of the volume allows over the whole surface. */
static gneiss_status measure_core(const core *inner, int dimension, cloud *points, double *volume,
                                  double *surface, gneiss_error *error) {
    const double r = inner->radius;
    double most = 0;
    bool more = true;
    for (size_t k = 0; k < inner->count; k++) most = fmax(most, inner->rest[k]);
    const double wanted = most > 1e-9 * r ? of_balls : of_polytope;
    for (int k = 0; k < LOOKS; k++) {
        double n[3];
        look(dimension, k, n);
        GN_TRY(add_farthest(inner, n, dimension, points, error));
    }
    for (int round = 0; more; round++) {
        gn_triangulation faces;
        double missing = 0;
        GN_TRY(
            gn_hull_measure(points->x, points->count, dimension, &faces, volume, surface, error));
        const double all = *volume + *surface * r, rounded = 1e-9 * (r + cbrt(*volume));
        const double gap = *surface > 0 ? fmax(wanted * all / *surface, rounded) : 0;
        gneiss_status status =
            refine(inner, dimension, gap, &faces, points, &more, &missing, error);
        gn_triangulation_free(&faces);
        GN_TRY(status);
        more = more && round < ROUNDS && points->count < POINTS_MOST;
        if (!more) *volume += most > 0 ? between * missing : 0;
    }
    return *volume > 0 ? GNEISS_OK : measure_flat(inner, dimension, surface, error);
}

static gneiss_status measure_hull(const core *inner, int dimension, double *volume,
                                  gneiss_error *error) {
    cloud points = {0};
    const double r = inner->radius;
    double surface = 0;
    *volume = 0;
    if (!inner->count) return GNEISS_OK;
    gneiss_status status = measure_core(inner, dimension, &points, volume, &surface, error);
    gn_free(points.x);
    if (dimension == 3)
        *volume += r * (surface + r * (curvature_of(inner) + 4.0 / 3.0 * M_PI * r));
    else
        *volume += r * (surface + M_PI * r);
    return status;
}

gneiss_status gn_packing_hull(const gn_particles *particles, int dimension, double *volume,
                              double lower[3], double upper[3], gneiss_error *error) {
    size_t many;
    core c = {0};
    *volume = 0;
    packing_extent(particles, lower, upper);
    int32_t *outer = outer_particles(particles, dimension, lower, upper, &many);
    gneiss_status status =
        outer ? make_core(particles, outer, many, lower, upper, &c, error)
              : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the hull of %zu particles",
                        particles->soa.count);
    if (status == GNEISS_OK) status = measure_hull(&c, dimension, volume, error);
    core_free(&c);
    gn_free(outer);
    if (status != GNEISS_OK) gn_fail_context(error, "hull of the packing: ");
    return status;
}
