/* The hull about a packing, and its extent. */
#include "base/memory.h"
#include "measure/assembly.h"
#include "measure/delaunay.h"

#include <string.h>

/* --- points on the surfaces --- */

enum { DIRECTIONS_2D = 32, DIRECTIONS_3D = 26 };

/* 3D: to the faces, edges and corners of a cube; 2D: equal angles, the axes among them. */
static size_t surface_directions(int dimension, double direction[DIRECTIONS_2D][3]) {
    size_t count = 0;
    if (dimension == 2) {
        for (; count < DIRECTIONS_2D; count++) {
            double angle = 2 * M_PI * (double)count / DIRECTIONS_2D;
            direction[count][0] = cos(angle);
            direction[count][1] = sin(angle);
            direction[count][2] = 0;
        }
        return count;
    }
    for (int k = 0; k < 27; k++) {
        const int digit[3] = {k % 3, k / 3 % 3, k / 9};
        double x[3] = {digit[0] - 1.0, digit[1] - 1.0, digit[2] - 1.0};
        double length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        if (length == 0) continue;
        for (int a = 0; a < 3; a++) direction[count][a] = x[a] / length;
        count++;
    }
    return count;
}

/* --- extent --- */

static void packing_extent(const gn_particles *particles, double lower[3], double upper[3]) {
    bool any = false;
    for (int a = 0; a < 3; a++) lower[a] = upper[a] = NAN;
    for (size_t p = 0; p < particles->soa.count; p++) {
        if (gn_particle_removed(particles, p)) continue;
        const double *x = particles->pos + 4 * p;
        for (int a = 0; a < 3; a++) {
            lower[a] = any ? fmin(lower[a], x[a] - x[3]) : x[a] - x[3];
            upper[a] = any ? fmax(upper[a], x[a] + x[3]) : x[a] + x[3];
        }
        any = true;
    }
}

/* --- what lies inside --- */

/* Qhull takes seconds for the points of 1e5 spheres, nearly all of which are well inside:
 * half-spaces n.x <= offset whose intersection lies within the hull tell these beforehand. */
enum { LOOKS = 96, FACES_MOST = 2 * LOOKS, BLOCK = 256 };

typedef struct half_spaces {
    size_t count;
    double normal[FACES_MOST][3], offset[FACES_MOST];
} half_spaces;

/* Directions all about: a spiral over the sphere (Gonzalez 2010, lattice of Fibonacci), or equal
 * angles. */
static void look(int dimension, int k, double direction[3]) {
    const double golden = M_PI * (3 - sqrt(5));
    double turn = dimension == 3 ? golden * k : 2 * M_PI * k / LOOKS;
    double z = dimension == 3 ? 1 - (2 * k + 1.0) / LOOKS : 0, across = sqrt(1 - z * z);
    direction[0] = across * cos(turn);
    direction[1] = across * sin(turn);
    direction[2] = z;
}

/* The particle that is farthest in a direction. */
static size_t farthest(const gn_particles *q, const double n[3]) {
    size_t found = 0;
    double most = -INFINITY;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p;
        double reach = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
        if (reach > most && !gn_particle_removed(q, p)) most = reach, found = p;
    }
    return found;
}

/* Centres of outer particles, each drawn towards the middle by another small part, so that no four
 * of them lie in a plane, as those of a lattice do. */
static void outer_points(const gn_particles *q, int dimension, const double middle[3],
                         double *points) {
    const double most = 1e-2, golden = 0.6180339887498949;
    for (int k = 0; k < LOOKS; k++) {
        double direction[3], whole, part = most * (0.1 + modf(golden * (k + 1), &whole));
        look(dimension, k, direction);
        const double *x = q->pos + 4 * farthest(q, direction);
        for (int a = 0; a < dimension; a++)
            points[k * dimension + a] = x[a] + part * (middle[a] - x[a]);
    }
}

/* Of the face through these corners, away from the middle. False: it has no area. */
static bool half_space_of(const double *points, const int32_t *corner, int dimension,
                          const double middle[3], half_spaces *s) {
    const double *x = points + corner[0] * dimension, *y = points + corner[1] * dimension;
    double *n = s->normal[s->count], e[3] = {0}, f[3] = {0, 0, 1};
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
    s->offset[s->count++] = height < 0 ? -offset : offset;
    return true;
}

/* None where there are too few particles for it to matter, or where no body is found. */
static void inner_body(const gn_particles *q, int dimension, const double lower[3],
                       const double upper[3], half_spaces *s) {
    const size_t few = 1000;
    double points[LOOKS * 3], middle[3], volume;
    gn_triangulation faces;
    s->count = 0;
    if (q->soa.count < few) return;
    for (int a = 0; a < 3; a++) middle[a] = 0.5 * (lower[a] + upper[a]);
    outer_points(q, dimension, middle, points);
    if (gn_hull_faces(points, LOOKS, dimension, &faces, &volume, NULL) != GNEISS_OK) return;
    bool whole = faces.count > 0 && faces.count <= FACES_MOST;
    for (size_t f = 0; whole && f < faces.count; f++)
        whole = half_space_of(points, faces.vertex + f * (size_t)dimension, dimension, middle, s);
    if (!whole) s->count = 0;
    gn_triangulation_free(&faces);
}

/* Which of up to BLOCK particles lie with all of their surface inside. What is no number does not.
 */
static void find_inside(const double *pos, size_t count, const half_spaces *s, double margin,
                        int32_t inside[BLOCK]) {
    double x[4][BLOCK];
    for (size_t p = 0; p < count; p++) {
        for (int a = 0; a < 4; a++) x[a][p] = pos[4 * p + a];
        inside[p] = s->count > 0;
    }
    for (size_t f = 0; f < s->count; f++) {
        const double *n = s->normal[f], limit = s->offset[f] - margin;
        for (size_t p = 0; p < count; p++)
            inside[p] &= n[0] * x[0][p] + n[1] * x[1][p] + n[2] * x[2][p] + x[3][p] <= limit;
    }
}

/* --- hull --- */

/* [count] particles that may touch the hull; NULL: no memory. */
static int32_t *outer_particles(const gn_particles *q, int dimension, const double lower[3],
                                const double upper[3], size_t *count) {
    const double rounding = 1e-9;
    int32_t inside[BLOCK], *outer = gn_alloc_array(q->soa.count + 1, sizeof *outer);
    half_spaces s;
    double extent = 0;
    *count = 0;
    if (!outer) return NULL;
    for (int a = 0; a < 3; a++) extent = fmax(extent, fmax(fabs(lower[a]), fabs(upper[a])));
    inner_body(q, dimension, lower, upper, &s);
    for (size_t first = 0; first < q->soa.count; first += BLOCK) {
        size_t n = q->soa.count - first < BLOCK ? q->soa.count - first : BLOCK;
        find_inside(q->pos + 4 * first, n, &s, rounding * extent, inside);
        for (size_t p = 0; p < n; p++)
            if (!inside[p] && !gn_particle_removed(q, first + p))
                outer[(*count)++] = (int32_t)(first + p);
    }
    return outer;
}

gneiss_status gn_packing_hull(const gn_particles *particles, int dimension, double *volume,
                              double lower[3], double upper[3], gneiss_error *error) {
    double direction[DIRECTIONS_2D][3], *points = NULL;
    size_t directions = surface_directions(dimension, direction), count = 0, many;
    packing_extent(particles, lower, upper);
    int32_t *outer = outer_particles(particles, dimension, lower, upper, &many);
    if (outer) points = gn_alloc_array(many * directions * (size_t)dimension + 1, sizeof *points);
    gneiss_status status =
        points ? GNEISS_OK
               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the hull of %zu particles",
                         particles->soa.count);
    for (size_t o = 0; points && o < many; o++) {
        const double *x = particles->pos + 4 * (size_t)outer[o];
        for (size_t k = 0; k < directions; k++, count++)
            for (int a = 0; a < dimension; a++)
                points[count * dimension + a] = x[a] + x[3] * direction[k][a];
    }
    if (points) status = gn_hull_volume(points, count, dimension, volume, error);
    gn_free(points);
    gn_free(outer);
    if (status != GNEISS_OK) gn_fail_context(error, "hull of the packing: ");
    return status;
}
