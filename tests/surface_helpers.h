/* Surfaces for the tests of contact with facets. */
#ifndef GN_TESTS_SURFACE_HELPERS_H
#define GN_TESTS_SURFACE_HELPERS_H

#include "world_helpers.h"

#include <unistd.h>

#define assert_ok(call, error)                                                                     \
    do {                                                                                           \
        if ((call) != GNEISS_OK) fail_msg("%s", (error)->message);                                 \
    } while (0)

/* Triangles as corners. */
typedef struct soup {
    size_t count;
    double x[4096][3][3];
} soup;

static inline void add_corners(soup *s, const double *a, const double *b, const double *c) {
    assert_true(s->count < 4096);
    memcpy(s->x[s->count][0], a, 3 * sizeof *a);
    memcpy(s->x[s->count][1], b, 3 * sizeof *b);
    memcpy(s->x[s->count++][2], c, 3 * sizeof *c);
}

/* The square |x|, |y| <= half at z = 0: a grid of n x n cells whose inner corners are shifted at
 * random, diagonals at random, and some triangles split at a random point into slender ones. */
static inline void random_plane(soup *s, uint64_t seed, int n, double half) {
    enum { MOST = 17 };
    double grid[MOST][MOST][3];
    uint64_t at = 1000 * seed;
    double cell = 2.0 * half / n;
    s->count = 0;
    for (int i = 0; i <= n; i++)
        for (int j = 0; j <= n; j++) {
            bool inner = i > 0 && j > 0 && i < n && j < n;
            double dx = uniform(&at, -0.35, 0.35), dy = uniform(&at, -0.35, 0.35);
            grid[i][j][0] = -half + cell * (i + (inner ? dx : 0.0));
            grid[i][j][1] = -half + cell * (j + (inner ? dy : 0.0));
            grid[i][j][2] = 0.0;
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const double *c[4] = {grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]};
            int first = uniform(&at, 0.0, 1.0) < 0.5;
            for (int k = 0; k < 2; k++) {
                const double *t[3] = {c[first], c[(first + 1 + k) % 4], c[(first + 2 + k) % 4]};
                if (uniform(&at, 0.0, 1.0) < 0.6) {
                    add_corners(s, t[0], t[1], t[2]);
                    continue;
                }
                double p[3] = {0, 0, 0}, u = uniform(&at, 0.02, 0.9), v = uniform(&at, 0.02, 0.98);
                double weight[3] = {u, (1 - u) * v, (1 - u) * (1 - v)};
                for (int m = 0; m < 3; m++)
                    for (int a = 0; a < 2; a++) p[a] += weight[m] * t[m][a];
                for (int m = 0; m < 3; m++) add_corners(s, t[m], t[(m + 1) % 3], p);
            }
        }
}

/* An STL file of the triangles; `path` [32] gets its name. The caller unlinks it. */
static inline void write_soup(const soup *s, char path[32]) {
    strcpy(path, "/tmp/gneiss-surface-XXXXXX");
    int handle = mkstemp(path);
    assert_true(handle >= 0);
    FILE *file = fdopen(handle, "w");
    fputs("solid s\n", file);
    for (size_t k = 0; k < s->count; k++) {
        fputs("facet normal 0 0 0\nouter loop\n", file);
        for (int c = 0; c < 3; c++)
            fprintf(file, "vertex %.17g %.17g %.17g\n", s->x[k][c][0], s->x[k][c][1],
                    s->x[k][c][2]);
        fputs("endloop\nendfacet\n", file);
    }
    fputs("endsolid s\n", file);
    assert_int_equal(fclose(file), 0);
}

#endif
