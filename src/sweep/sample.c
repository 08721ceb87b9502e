#include "sweep/sample.h"

#include "base/random.h"

#include <math.h>

/* Returns the seed of the random numbers of a coordinate. */
static uint64_t stream(uint64_t seed, size_t dimension) {
    return gn_random_bits(seed ^ UINT64_C(0x73776565700000), dimension);
}

/* Returns a number in the open interval (0, 1). */
static double fraction(uint64_t bits) {
    return ((double)(bits >> 12) + 0.5) * 0x1p-52;
}

/* ---- Latin hypercube ---- */

/* The strata are shuffled from the end (Fisher & Yates) by numbers 0 to count - 1 of the stream;
 * later numbers give the positions inside the strata. */
void gn_sample_latin(uint64_t seed, size_t dimension, size_t count, double *points) {
    uint64_t own = stream(seed, dimension);
    for (size_t k = 0; k < count; k++) points[k] = (double)k;
    for (size_t k = count; k-- > 1;) {
        size_t other = (size_t)(fraction(gn_random_bits(own, k)) * (double)(k + 1));
        double kept = points[k];
        points[k] = points[other];
        points[other] = kept;
    }
    for (size_t k = 0; k < count; k++) {
        double inside = fraction(gn_random_bits(own, count + k));
        double low = points[k] / (double)count, high = (points[k] + 1.0) / (double)count;
        double point = (points[k] + inside) / (double)count;
        points[k] = point > low && point < high ? point : 0.5 * (low + high);
    }
}

/* ---- Sobol's sequence ---- */

/* Primitive polynomials and first direction numbers of dimensions 2 to 21, from the table
 * new-joe-kuo-6.21201 (Joe & Kuo 2008, SIAM J. Sci. Comput. 30, 2635): degree, inner coefficients
 * as bits, m_1 .. m_degree. */
enum { DEGREE_MOST = 7 };
static const struct {
    uint8_t degree, inner, m[DEGREE_MOST];
} directions[GN_SOBOL_DIMENSIONS - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
};

/* Computes v_1 .. v_32, v_k = m_k 2^(32 - k); the recurrence is eq. 2.2 of Joe & Kuo. */
static void make_directions(size_t dimension, uint32_t v[32]) {
    if (dimension == 0) {
        for (int k = 0; k < 32; k++) v[k] = UINT32_C(1) << (31 - k);
        return;
    }
    int s = directions[dimension - 1].degree;
    unsigned inner = directions[dimension - 1].inner;
    for (int k = 0; k < s; k++) v[k] = (uint32_t)directions[dimension - 1].m[k] << (31 - k);
    for (int k = s; k < 32; k++) {
        v[k] = v[k - s] ^ (v[k - s] >> s);
        for (int j = 1; j < s; j++)
            if (inner >> (s - 1 - j) & 1U) v[k] ^= v[k - j];
    }
}

/* Returns a point's bits in the order of the Gray code (Antonov & Saleev 1979), as in published
 * sequences. */
static uint32_t bits_of(const uint32_t v[32], uint32_t index) {
    uint32_t gray = index ^ (index >> 1), bits = 0;
    for (int k = 0; gray; k++, gray >>= 1)
        if (gray & 1U) bits ^= v[k];
    return bits;
}

uint32_t gn_sobol_bits(size_t dimension, uint32_t index) {
    uint32_t v[32];
    make_directions(dimension, v);
    return bits_of(v, index);
}

void gn_sample_sobol(uint64_t seed, size_t dimension, size_t count, double *points) {
    uint32_t v[32], shift = (uint32_t)(stream(seed, dimension) >> 32);
    make_directions(dimension, v);
    for (size_t k = 0; k < count; k++)
        points[k] = ((double)(bits_of(v, (uint32_t)k) ^ shift) + 0.5) * 0x1p-32;
}

/* ---- the normal distribution ---- */

/* Newton's method is applied to the probability of the nearer tail, which preserves all digits.
 * Q(x) is at most exp(-x^2/2)/2, so that the start is farther out, where the tail is convex: the
 * first step overshoots, and all others approach from that side. */
double gn_normal_quantile(double p) {
    double tail = p < 0.5 ? p : 1.0 - p;
    double x = sqrt(fmax(-2.0 * log(2.0 * tail), 0.0));
    for (int k = 0; k < 100; k++) {
        double density = 0.3989422804014327 * exp(-0.5 * x * x);
        double step = (0.5 * erfc(x * 0.7071067811865476) - tail) / density;
        x += step;
        if (fabs(step) <= 1e-15 * fabs(x) || step == 0.0) break;
    }
    return p < 0.5 ? -x : x;
}
