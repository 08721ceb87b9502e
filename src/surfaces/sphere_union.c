#include "surfaces/sphere_union.h"

#include "base/new.h"
#include "base/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Moments of a section: area, x, y, xx, yy, xy; and of the body: 1, x, y, z, xx, yy, zz, xy, yz,
 * zx. */
enum { SECTION = 6, BODY = 10 };

/* The spheres in units of their extent about a point inside, and storage for one section. */
typedef struct balls {
    size_t count;
    double *ball; /* [count][4] */
    double *disc; /* [discs][3] x y r of the spheres that the present section meets */
    size_t discs;
    double (*cover)[2]; /* [2 count] angles of a circle that other discs cover */
    double *height;     /* [heights] where the pattern changes */
    size_t heights, room;
    double error;
} balls;

/* --- sections: unions of discs --- */

/* Adds the integrals along the arc of a circle about (x, y) from angle a to b, counterclockwise:
 * area = 1/2 (x dy - y dx), and 1/2 x2 dy, -1/2 y2 dx, 1/3 x3 dy, -1/3 y3 dx, 1/2 x2 y dy. */
static void add_arc(const double disc[3], double a, double b, double sum[SECTION]) {
    const double x = disc[0], y = disc[1], r = disc[2];
    const double s[2] = {sin(a), sin(b)}, c[2] = {cos(a), cos(b)};
    const double sc = s[1] * c[1] - s[0] * c[0], turn = b - a;
    const double cube[2] = {c[1] * c[1] * c[1] - c[0] * c[0] * c[0],
                            s[1] * s[1] * s[1] - s[0] * s[0] * s[0]};
    const double lead[2] = {s[1] * c[1] * c[1] * c[1] - s[0] * c[0] * c[0] * c[0],
                            c[1] * s[1] * s[1] * s[1] - c[0] * s[0] * s[0] * s[0]};
    /* Integrals of powers of the cosine and the sine. */
    const double c1 = s[1] - s[0], c2 = 0.5 * (turn + sc), c3 = c1 - cube[1] / 3.0,
                 c4 = 0.25 * lead[0] + 0.75 * c2;
    const double s1 = c[0] - c[1], s2 = 0.5 * (turn - sc), s3 = s1 + cube[0] / 3.0,
                 s4 = -0.25 * lead[1] + 0.75 * s2;
    const double cs = 0.5 * (s[1] * s[1] - s[0] * s[0]), ccs = -cube[0] / 3.0,
                 cccs = -0.25 * (c[1] * c[1] * c[1] * c[1] - c[0] * c[0] * c[0] * c[0]);
    sum[0] += 0.5 * r * (x * c1 + y * s1 + r * turn);
    const double xx = x * x * c1 + 2.0 * x * r * c2 + r * r * c3;
    sum[1] += 0.5 * r * xx;
    sum[2] += 0.5 * r * (y * y * s1 + 2.0 * y * r * s2 + r * r * s3);
    sum[3] += r / 3.0 * (x * x * x * c1 + 3.0 * x * r * (x * c2 + r * c3) + r * r * r * c4);
    sum[4] += r / 3.0 * (y * y * y * s1 + 3.0 * y * r * (y * s2 + r * s3) + r * r * r * s4);
    sum[5] += 0.5 * r * (y * xx + r * (x * x * cs + 2.0 * x * r * ccs + r * r * cccs));
}

static int by_angle(const void *a, const void *b) {
    const double *x = a, *y = b;
    return (x[0] > y[0]) - (x[0] < y[0]);
}

/* Stores the angles of circle i that disc j covers; returns whether it covers the whole circle. Of
 * two equal discs the first one counts. */
static bool cover_by(balls *q, size_t i, size_t j, size_t *covers) {
    const double *a = q->disc + 3 * i, *b = q->disc + 3 * j;
    const double x = b[0] - a[0], y = b[1] - a[1], d2 = x * x + y * y, d = sqrt(d2);
    if (d >= a[2] + b[2]) return false;
    if (d <= b[2] - a[2]) return d > 0.0 || b[2] > a[2] || j < i;
    if (d <= a[2] - b[2]) return false;
    const double cosine = (d2 + (a[2] - b[2]) * (a[2] + b[2])) / (2.0 * d * a[2]);
    const double half = acos(fmax(-1.0, fmin(1.0, cosine)));
    double low = atan2(y, x) - half, high = low + 2.0 * half;
    while (low < 0.0) low += 2.0 * pi, high += 2.0 * pi;
    q->cover[*covers][0] = low;
    q->cover[(*covers)++][1] = fmin(high, 2.0 * pi);
    if (high <= 2.0 * pi) return false;
    q->cover[*covers][0] = 0.0;
    q->cover[(*covers)++][1] = high - 2.0 * pi;
    return false;
}

static void add_circle(balls *q, size_t i, double sum[SECTION]) {
    size_t covers = 0;
    double free = 0.0;
    for (size_t j = 0; j < q->discs; j++)
        if (j != i && cover_by(q, i, j, &covers)) return;
    qsort(q->cover, covers, sizeof *q->cover, by_angle);
    for (size_t k = 0; k < covers; k++) {
        if (q->cover[k][0] > free) add_arc(q->disc + 3 * i, free, q->cover[k][0], sum);
        free = fmax(free, q->cover[k][1]);
    }
    if (free < 2.0 * pi) add_arc(q->disc + 3 * i, free, 2.0 * pi, sum);
}

static void measure_section(balls *q, double sum[SECTION]) {
    memset(sum, 0, SECTION * sizeof *sum);
    for (size_t i = 0; i < q->discs; i++) add_circle(q, i, sum);
}

static void cut(balls *q, double z) {
    q->discs = 0;
    for (size_t k = 0; k < q->count; k++) {
        const double *b = q->ball + 4 * k, off = z - b[2], r2 = (b[3] - off) * (b[3] + off);
        if (!(r2 > 0.0)) continue;
        double *disc = q->disc + 3 * q->discs++;
        disc[0] = b[0];
        disc[1] = b[1];
        disc[2] = sqrt(r2);
    }
}

/* --- heights where the pattern of arcs changes --- */

/* Tells whether a point is within a sphere, clear of rounding, so that it is not on the boundary.
 */
static bool is_buried(const balls *q, const double x[3]) {
    const double clear = 1e-9;
    for (size_t k = 0; k < q->count; k++) {
        const double *b = q->ball + 4 * k, d[3] = {x[0] - b[0], x[1] - b[1], x[2] - b[2]},
                     least = b[3] - clear;
        if (least > 0.0 && gn_dot3(d, d) < least * least) return true;
    }
    return false;
}

/* Notes the height of a point unless it is buried. */
static gneiss_status note(balls *q, const double x[3], gneiss_error *error) {
    if (is_buried(q, x)) return GNEISS_OK;
    GN_TRY(gn_grow(&q->height, q->heights, q->heights + 1, &q->room, "heights", error));
    q->height[q->heights++] = x[2];
    return GNEISS_OK;
}

/* Computes the circle in which two spheres meet: its centre, its unit normal, its radius. */
static bool meet(const double *a, const double *b, double centre[3], double n[3], double *radius) {
    for (int k = 0; k < 3; k++) n[k] = b[k] - a[k];
    const double d = sqrt(gn_dot3(n, n));
    if (d >= a[3] + b[3] || d <= fabs(a[3] - b[3])) return false;
    const double along = (d * d + (a[3] - b[3]) * (a[3] + b[3])) / (2.0 * d);
    for (int k = 0; k < 3; k++) {
        n[k] /= d;
        centre[k] = a[k] + along * n[k];
    }
    *radius = sqrt(fmax(0.0, (a[3] - along) * (a[3] + along)));
    return true;
}

/* Notes the points of the circle of two spheres that are on a third one. */
static gneiss_status note_corners(balls *q, const double centre[3], const double n[3],
                                  double radius, const double *c, gneiss_error *error) {
    double to[3], flat[3], up[3];
    for (int k = 0; k < 3; k++) to[k] = c[k] - centre[k];
    const double off = gn_dot3(to, n);
    for (int k = 0; k < 3; k++) flat[k] = to[k] - off * n[k];
    const double d = sqrt(gn_dot3(flat, flat)), r = sqrt(fmax(0.0, (c[3] - off) * (c[3] + off)));
    if (!(r > 0.0) || !(d > 0.0) || d >= radius + r || d <= fabs(radius - r)) return GNEISS_OK;
    const double along = (d * d + (radius - r) * (radius + r)) / (2.0 * d);
    const double across = sqrt(fmax(0.0, (radius - along) * (radius + along)));
    for (int k = 0; k < 3; k++) flat[k] /= d;
    gn_cross3(n, flat, up);
    for (int side = -1; side <= 1; side += 2) {
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = centre[k] + along * flat[k] + side * across * up[k];
        GN_TRY(note(q, x, error));
    }
    return GNEISS_OK;
}

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Notes the lowest and the highest point of the circle of two spheres; all points of a level circle
 * have its height. */
static gneiss_status note_poles(balls *q, const double centre[3], const double n[3], double radius,
                                gneiss_error *error) {
    const double flat = sqrt(n[0] * n[0] + n[1] * n[1]), level = 1e-6;
    if (flat < level) {
        GN_TRY(gn_grow(&q->height, q->heights, q->heights + 2, &q->room, "heights", error));
        q->height[q->heights++] = centre[2] - radius * flat;
        q->height[q->heights++] = centre[2] + radius * flat;
        return GNEISS_OK;
    }
    for (int side = -1; side <= 1; side += 2) {
        const double by = side * radius / flat;
        const double x[3] = {centre[0] - by * n[0] * n[2], centre[1] - by * n[1] * n[2],
                             centre[2] + side * radius * flat};
        GN_TRY(note(q, x, error));
    }
    return GNEISS_OK;
}

static gneiss_status find_heights(balls *q, gneiss_error *error) {
    for (size_t i = 0; i < q->count; i++) {
        const double *a = q->ball + 4 * i;
        GN_TRY(note(q, (const double[3]){a[0], a[1], a[2] - a[3]}, error));
        GN_TRY(note(q, (const double[3]){a[0], a[1], a[2] + a[3]}, error));
        for (size_t j = i + 1; j < q->count; j++) {
            double centre[3], n[3], radius;
            if (!meet(a, q->ball + 4 * j, centre, n, &radius)) continue;
            GN_TRY(note_poles(q, centre, n, radius, error));
            for (size_t k = j + 1; k < q->count; k++)
                GN_TRY(note_corners(q, centre, n, radius, q->ball + 4 * k, error));
        }
    }
    qsort(q->height, q->heights, sizeof *q->height, by_value);
    return GNEISS_OK;
}

/* --- integration over the height --- */

enum { COARSE = 12, FINE = 20, DEEPEST = 30 };

typedef struct rule {
    int count;
    double at[FINE], weight[FINE]; /* on [-1, 1] */
} rule;

/* Computes the points of Gauss and Legendre by Newton's method. */
static rule gauss(int count) {
    rule g = {.count = count};
    for (int k = 0; k < count; k++) {
        double x = cos(pi * (k + 0.75) / (count + 0.5)), slope = 1.0;
        for (int turn = 0; turn < 50; turn++) {
            double p[2] = {1.0, x};
            for (int n = 2; n <= count; n++) {
                const double next = ((2 * n - 1) * x * p[1] - (n - 1) * p[0]) / n;
                p[0] = p[1];
                p[1] = next;
            }
            slope = count * (x * p[1] - p[0]) / (x * x - 1.0);
            const double change = p[1] / slope;
            x -= change;
            if (fabs(change) < 1e-16) break;
        }
        g.at[k] = x;
        g.weight[k] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
    return g;
}

/* Integrates over [low, high] with z = middle + half sin(pi t/2). */
static void panel(balls *q, const rule *g, double low, double high, double sum[BODY]) {
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    memset(sum, 0, BODY * sizeof *sum);
    for (int k = 0; k < g->count; k++) {
        const double z = middle + half * sin(0.5 * pi * g->at[k]),
                     w = 0.5 * pi * half * cos(0.5 * pi * g->at[k]) * g->weight[k];
        double f[SECTION];
        cut(q, z);
        measure_section(q, f);
        const double all[BODY] = {f[0], f[1],         f[2], z * f[0], f[3],
                                  f[4], z * z * f[0], f[5], z * f[2], z * f[1]};
        for (int m = 0; m < BODY; m++) sum[m] += w * all[m];
    }
}

static void integrate(balls *q, const rule g[2], double low, double high, int depth,
                      double sum[BODY]) {
    double first[BODY], second[BODY], change = 0.0;
    panel(q, &g[0], low, high, first);
    panel(q, &g[1], low, high, second);
    for (int m = 0; m < BODY; m++) change = fmax(change, fabs(second[m] - first[m]));
    if (change > 1e-13 * fmax(high - low, 1e-3) && depth < DEEPEST) {
        const double middle = 0.5 * (low + high);
        integrate(q, g, low, middle, depth + 1, sum);
        integrate(q, g, middle, high, depth + 1, sum);
        return;
    }
    for (int m = 0; m < BODY; m++) sum[m] += second[m];
    q->error += change;
}

static gneiss_status integrate_all(balls *q, double sum[BODY], gneiss_error *error) {
    const rule g[2] = {gauss(COARSE), gauss(FINE)};
    GN_TRY(find_heights(q, error));
    for (size_t k = 1; k < q->heights; k++)
        if (q->height[k] - q->height[k - 1] > 1e-15)
            integrate(q, g, q->height[k - 1], q->height[k], 0, sum);
    return GNEISS_OK;
}

/* --- the union --- */

static gneiss_status prepare(balls *q, const double *sphere, size_t count, double middle[3],
                             double *size, gneiss_error *error) {
    q->count = count;
    GN_TRY(gn_new(&q->ball, 4 * count, "spheres", error));
    GN_TRY(gn_new(&q->disc, 3 * count, "spheres", error));
    GN_TRY(gn_new(&q->cover, 2 * count, "spheres", error));
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < count; k++) {
            low = fmin(low, sphere[4 * k + (size_t)a] - sphere[4 * k + 3]);
            high = fmax(high, sphere[4 * k + (size_t)a] + sphere[4 * k + 3]);
        }
        middle[a] = 0.5 * (low + high);
        *size = fmax(*size, high - low);
    }
    for (size_t k = 0; k < 4 * count; k++)
        q->ball[k] = (sphere[k] - (k % 4 < 3 ? middle[k % 4] : 0.0)) / *size;
    return GNEISS_OK;
}

static void finish(const double sum[BODY], const double middle[3], double size, int dimension,
                   gn_sphere_union *out) {
    static const int product[9] = {4, 7, 9, 7, 5, 8, 9, 8, 6};
    const double cube = pow(size, dimension);
    double second[9], trace = 0.0;
    for (int a = 0; a < 9; a++) {
        second[a] = sum[product[a]] - sum[1 + a / 3] * sum[1 + a % 3] / sum[0];
        if (a % 4 == 0) trace += second[a];
    }
    out->volume = cube * sum[0];
    for (int a = 0; a < 3; a++) out->centre[a] = middle[a] + size * sum[1 + a] / sum[0];
    for (int a = 0; a < 9; a++)
        out->moment[a] = cube * size * size * ((a % 4 == 0 ? trace : 0.0) - second[a]);
}

gneiss_status gn_sphere_union_measure(const double *sphere, size_t count, int dimension,
                                      gn_sphere_union *out, gneiss_error *error) {
    balls q = {0};
    double middle[3], size = 0.0, sum[BODY] = {0}, f[SECTION];
    gneiss_status status = prepare(&q, sphere, count, middle, &size, error);
    *out = (gn_sphere_union){0};
    if (status == GNEISS_OK && dimension == 3) status = integrate_all(&q, sum, error);
    if (status == GNEISS_OK && dimension == 2) {
        for (size_t k = 0; k < count; k++) q.ball[4 * k + 2] = 0.0;
        cut(&q, 0.0);
        measure_section(&q, f);
        const double all[BODY] = {f[0], f[1], f[2], 0.0, f[3], f[4], 0.0, f[5], 0.0, 0.0};
        memcpy(sum, all, sizeof sum);
    }
    if (status == GNEISS_OK) finish(sum, middle, size, dimension, out);
    out->error = q.error;
    void *blocks[] = {q.ball, q.disc, q.cover, q.height};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    return status;
}
