#include "sweep/statistics.h"

#include <math.h>
#include <stdbool.h>

static const double pi = 3.14159265358979323846;

double gn_student_within(double t, size_t freedom) {
    double angle = atan2(t, sqrt((double)freedom)), c = cos(angle), c2 = c * c;
    bool odd = freedom % 2 == 1;
    /* odd: cos + 2/3 cos^3 + 2.4/(3.5) cos^5 ..; even: 1 + 1/2 cos^2 + 1.3/(2.4) cos^4 .. */
    double term = odd ? c : 1.0, sum = freedom == 1 ? 0.0 : term;
    for (size_t k = odd ? 3 : 2; k + 2 <= freedom; k += 2) {
        term *= c2 * (double)(k - 1) / (double)k;
        sum += term;
    }
    return odd ? 2.0 / pi * (angle + sin(angle) * sum) : sin(angle) * sum;
}

/* Bisection from an upper bound: the probability increases with t. */
double gn_student_quantile(double within, size_t freedom) {
    double low = 0.0, high = 1.0;
    while (gn_student_within(high, freedom) < within && high < 1e300) high *= 2.0;
    for (int k = 0; k < 200 && high - low > 4e-16 * high; k++) {
        double middle = 0.5 * (low + high);
        if (gn_student_within(middle, freedom) < within)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

gn_statistics gn_statistics_of(const double *values, size_t count, size_t stride) {
    gn_statistics s = {0, NAN, NAN, NAN};
    double sum = 0.0, squares = 0.0;
    for (size_t k = 0; k < count; k++) {
        if (!isfinite(values[k * stride])) continue;
        sum += values[k * stride];
        s.count++;
    }
    if (s.count == 0) return s;
    s.mean = sum / (double)s.count;
    for (size_t k = 0; k < count; k++) {
        double off = values[k * stride] - s.mean;
        if (isfinite(off)) squares += off * off;
    }
    if (s.count < 2) return s;
    s.deviation = sqrt(squares / (double)(s.count - 1));
    s.interval = gn_student_quantile(0.95, s.count - 1) * s.deviation / sqrt((double)s.count);
    return s;
}
