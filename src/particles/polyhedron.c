#include "particles/polyhedron.h"

#include "base/random.h"
#include "base/vec3.h"

#include <math.h>
#include <stdlib.h>

/* --- ratio --- */

/* Exact for the regular solids, linear in n between them, and 1 + c/n beyond the icosahedron. This
 * is the table of the source except for its misprints at 11 and 16. */
static double ratio_in_space(double n) {
    const double faces[] = {4.0, 6.0, 8.0, 12.0, 20.0}, root5 = sqrt(5.0), root3 = sqrt(3.0);
    /* surface over the square of the inner radius */
    const double surface[] = {24.0 * root3, 24.0, 12.0 * root3,
                              12.0 * sqrt(25.0 + 10.0 * root5) / (2.5 + 1.1 * root5),
                              240.0 * root3 / ((3.0 + root5) * (3.0 + root5))};
    if (n <= faces[0]) return surface[0] / (4.0 * M_PI);
    for (int k = 1; k < 5; k++) {
        if (n > faces[k]) continue;
        double s = (n - faces[k - 1]) / (faces[k] - faces[k - 1]);
        return ((1.0 - s) * surface[k - 1] + s * surface[k]) / (4.0 * M_PI);
    }
    return 1.0 + (surface[4] / (4.0 * M_PI) - 1.0) * faces[4] / n;
}

double gn_polyhedron_ratio(int dimension, double n) {
    if (dimension == 3) return ratio_in_space(n);
    n = fmax(n, 3.0);
    return n * tan(M_PI / n) / M_PI;
}

/* --- missing faces --- */

/* Half angle of a cone without neighbours from which it counts as a hole. The faces of a
 * tetrahedron leave 71 degrees between their directions, those of a triangle 60; a flat surface
 * leaves 90. */
static const double hole = 75.0 * M_PI / 180.0;

/* The part of all directions that neighbours cover, by triangles (2D: arcs) between neighbours. A
 * neighbour counts with the share of its full angle that these triangles take. */
typedef struct cover {
    double neighbours, parts;
    bool open;
} cover;

static int by_angle(const void *a, const void *b) {
    const double *x = a, *y = b;
    double ax = atan2(x[1], x[0]), ay = atan2(y[1], y[0]);
    return (ax > ay) - (ax < ay);
}

/* Sets `whole` to the number of neighbours that there would be if they were as dense in all
 * directions as in the covered ones. */
static gn_polyhedron about_in_plane(size_t n, double (*d)[3]) {
    double covered = 0.0;
    size_t arcs = 0;
    qsort(d, n, sizeof *d, by_angle);
    for (size_t k = 0; k < n; k++) {
        const double *a = d[k], *b = d[(k + 1) % n];
        double arc = atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
        if (arc <= 0.0) arc += 2.0 * M_PI;
        if (arc > 2.0 * hole) continue;
        covered += arc;
        arcs++;
    }
    if (arcs == n) return (gn_polyhedron){(double)n, false};
    if (!arcs) return (gn_polyhedron){fmax((double)n, 4.0), true};
    return (gn_polyhedron){fmax((double)n, 2.0 * M_PI * (double)arcs / covered), true};
}

/* Returns n.(k - a), with n along the normal of the triangle a b c. */
static double above(const double a[3], const double b[3], const double c[3], const double k[3],
                    double n[3]) {
    double ab[3], ac[3], ak[3];
    for (int x = 0; x < 3; x++) {
        ab[x] = b[x] - a[x];
        ac[x] = c[x] - a[x];
        ak[x] = k[x] - a[x];
    }
    gn_cross3(ab, ac, n);
    return gn_dot3(n, ak);
}

/* Returns the third corner of the triangle to the left of the edge from a to b of the hull. */
static size_t third(size_t n, double (*d)[3], size_t a, size_t b) {
    size_t c = n;
    double normal[3];
    for (size_t k = 0; k < n; k++) {
        if (k == a || k == b) continue;
        if (c == n || above(d[a], d[b], d[c], d[k], normal) > 0.0) c = k;
    }
    return c;
}

/* Returns the angle at a between the arcs to b and c. */
static double corner(const double a[3], const double b[3], const double c[3]) {
    double side[3];
    gn_cross3(b, c, side);
    double along = gn_dot3(b, c) - gn_dot3(a, b) * gn_dot3(a, c);
    return atan2(fabs(gn_dot3(a, side)), along);
}

/* Visits the triangles at neighbour a of the convex hull of all directions, which is their Delaunay
 * triangulation on the sphere. It starts with the nearest neighbour of a, which always shares an
 * edge of the hull with a. */
static void go_round(size_t n, double (*d)[3], size_t a, cover *found) {
    size_t first = a ? 0 : 1;
    for (size_t k = 0; k < n; k++)
        if (k != a && gn_dot3(d[a], d[k]) > gn_dot3(d[a], d[first])) first = k;
    size_t b = first, c = n;
    for (size_t turns = 0; turns < n && c != first; turns++, b = c) {
        double normal[3];
        c = third(n, d, a, b);
        above(d[a], d[b], d[c], d[a], normal);
        double centre = gn_dot3(normal, d[a]) / sqrt(gn_dot3(normal, normal));
        if (centre < cos(hole)) {
            found->open = true;
            continue;
        }
        found->neighbours += corner(d[a], d[b], d[c]) / (2.0 * M_PI);
        found->parts += 1.0 / 3.0;
    }
}

/* Shifts directions slightly, because on lattices four or more neighbours lie on one circle: the
 * shifts select one triangulation. */
static void shift(size_t n, double (*d)[3]) {
    for (size_t k = 0; k < n; k++) {
        for (size_t a = 0; a < 3; a++) d[k][a] += 1e-8 * gn_random_symmetric(1, 3 * k + a);
        double length = sqrt(gn_dot3(d[k], d[k]));
        for (int a = 0; a < 3; a++) d[k][a] /= length;
    }
}

/* The area of a spherical triangle is the sum of its angles less pi. */
static gn_polyhedron about_in_space(size_t n, double (*d)[3]) {
    cover found = {.open = n < 3};
    shift(n, d);
    for (size_t a = 0; a < n && n >= 3; a++) go_round(n, d, a, &found);
    if (!found.open) return (gn_polyhedron){(double)n, false};
    double covered = 2.0 * found.neighbours - found.parts; /* in units of pi */
    if (!(covered > 1e-6)) return (gn_polyhedron){fmax((double)n, 6.0), true};
    return (gn_polyhedron){fmax((double)n, 4.0 * found.neighbours / covered), true};
}

gn_polyhedron gn_polyhedron_about(int dimension, size_t count, double (*direction)[3]) {
    return dimension == 3 ? about_in_space(count, direction) : about_in_plane(count, direction);
}
