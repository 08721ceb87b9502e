#include "measure/structure.h"

#include "base/ball.h"
#include "base/eigen.h"

#include <math.h>
#include <stdbool.h>

/* Returns the integral of sqrt(1 - x^2) from 0 to x. */
static double half_disc(double x) {
    return 0.5 * (asin(x) + x * sqrt(fmax(1.0 - x * x, 0.0)));
}

/* Returns the area of the part of the unit disc about 0 with x < a and y < b: the integral over x
 * of c + min(b, c), c = sqrt(1 - x^2), or 0 where b < -c. */
static double below(double a, double b) {
    if (a <= -1.0 || b <= -1.0) return 0.0;
    a = fmin(a, 1.0);
    b = fmin(b, 1.0);
    const double edge = sqrt(1.0 - b * b), end = fmin(a, edge);
    double area = end > -edge ? b * (end + edge) + half_disc(end) - half_disc(-edge) : 0.0;
    if (b <= 0.0) return area;
    area += 2.0 * (half_disc(fmin(a, -edge)) - half_disc(-1.0));
    return a > edge ? area + 2.0 * (half_disc(a) - half_disc(edge)) : area;
}

/* Returns the area of the part of a disc about 0 in a rectangle about that point. */
static double disc_in_box(double radius, const double low[2], const double high[2]) {
    if (!(radius > 0.0)) return 0.0;
    const double x0 = low[0] / radius, x1 = high[0] / radius, y0 = low[1] / radius,
                 y1 = high[1] / radius;
    return radius * radius * (below(x1, y1) - below(x0, y1) - below(x1, y0) + below(x0, y0));
}

/* Integrates discs across z over the angle p, z = r sin p, which is smooth at both poles. */
static double sphere_in_box(double radius, const double low[3], const double high[3]) {
    enum { SLICES = 400 };
    const double from = asin(fmax(-1.0, low[2] / radius)), to = asin(fmin(1.0, high[2] / radius)),
                 width = (to - from) / SLICES;
    double sum = 0.0;
    for (int k = 0; k < SLICES; k++) {
        const double across = radius * cos(from + (k + 0.5) * width);
        sum += disc_in_box(across, low, high) * across * width;
    }
    return sum;
}

double gn_ball_in_box(int dimension, const double centre[3], double radius, const double low[3],
                      const double high[3]) {
    double from[3], to[3], cut = 2.0 * radius;
    int faces = 0;
    for (int a = 0; a < dimension; a++) {
        from[a] = low[a] - centre[a];
        to[a] = high[a] - centre[a];
        if (from[a] >= radius || to[a] <= -radius) return 0.0;
        faces += (from[a] > -radius) + (to[a] < radius);
        cut = fmin(cut, fmin(to[a], -from[a]) + radius);
    }
    if (!faces) return gn_ball_volume(dimension, radius);
    if (dimension == 2) return disc_in_box(radius, from, to);
    if (faces == 1) return M_PI * cut * cut * (radius - cut / 3.0);
    return sphere_in_box(radius, from, to);
}

gn_anisotropy gn_fabric_anisotropy(int dimension, const double fabric[9]) {
    double matrix[9], value[3], vector[9];
    int lead = 0;
    gn_anisotropy r = {0};
    for (int a = 0; a < dimension; a++)
        for (int b = 0; b < dimension; b++) matrix[dimension * a + b] = fabric[3 * a + b];
    gn_eigen_symmetric(dimension, matrix, value, vector);
    r.degree = value[0] - value[dimension - 1];
    for (int a = 0; a < dimension; a++) {
        r.direction[a] = vector[a];
        if (fabs(vector[a]) > fabs(vector[lead]) * (1.0 + 1e-9)) lead = a;
    }
    if (r.direction[lead] < 0.0)
        for (int a = 0; a < dimension; a++) r.direction[a] = -r.direction[a];
    return r;
}
