#include "pack/sizes.h"

#include "base/random.h"
#include "base/sort.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* Returns a number uniformly distributed in [0, 1). */
static double draw(gn_drawn *drawn) {
    return 0.5 * (1.0 + gn_random_symmetric(drawn->seed, drawn->count++));
}

/* Returns the size over the largest at which a fraction of the mass passes. */
static double sieve_size(const gn_sizes *sizes, double share) {
    size_t k = 1;
    while (k + 1 < sizes->sieve_count && sizes->sieve[2 * k + 1] < share) k++;
    const double *low = sizes->sieve + 2 * k - 2, *high = sizes->sieve + 2 * k;
    double rise = high[1] - low[1];
    return rise > 0.0 ? low[0] + (high[0] - low[0]) * fmin(1.0, (share - low[1]) / rise) : high[0];
}

/* A sieve curve counts mass; sizes are drawn with a frequency proportional to r^-d, because
 * particles are drawn by number. */
double gn_sizes_draw(const gn_sizes *sizes, gn_drawn *drawn) {
    const double ratio = sizes->ratio, mean = 0.5 * (1.0 + ratio);
    const double deviation =
        sizes->variation >= 0.0 ? sizes->variation * mean : (ratio - 1.0) / 6.0;
    if (sizes->kind == GN_SIZES_UNIFORM) return 1.0 + (ratio - 1.0) * draw(drawn);
    for (;;) {
        double u = 1.0 - draw(drawn), v = draw(drawn);
        if (sizes->kind == GN_SIZES_NORMAL) {
            double size = mean + deviation * sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
            if (size >= 1.0 && size <= ratio) return size;
        } else {
            double size = sieve_size(sizes, u);
            if (v < pow(sizes->sieve[0] / size, sizes->dimension)) return size;
        }
    }
}

void gn_sizes_range(const gn_sizes *sizes, double *least, double *most) {
    bool curve = sizes->kind == GN_SIZES_SIEVE;
    *least = curve ? sizes->sieve[0] : 1.0;
    *most = curve ? 1.0 : sizes->ratio;
}

double gn_sizes_share(const gn_sizes *sizes, double size) {
    size_t k = 1;
    while (k + 1 < sizes->sieve_count && sizes->sieve[2 * k] < size) k++;
    const double *low = sizes->sieve + 2 * k - 2, *high = sizes->sieve + 2 * k;
    double part = (size - low[0]) / (high[0] - low[0]);
    return low[1] + (high[1] - low[1]) * fmin(1.0, fmax(0.0, part));
}

/* Normal and uniform distributions are symmetric about the middle. */
double gn_sizes_mean(const gn_sizes *sizes) {
    enum { DRAWN = 100000 };
    gn_drawn own = {UINT64_C(0x73697a6573), 0};
    double sum = 0.0;
    if (sizes->kind != GN_SIZES_SIEVE) return 0.5 * (1.0 + sizes->ratio);
    for (int k = 0; k < DRAWN; k++) sum += gn_sizes_draw(sizes, &own);
    return sum / DRAWN;
}

/* Returns the cumulative distribution function of the normal distribution. */
static double below(double deviations) {
    return 0.5 * erfc(-deviations / sqrt(2.0));
}

/* Returns the fraction that is no larger than a size in that unit: by number, for a sieve curve by
 * mass. */
static double sizes_below(const gn_sizes *sizes, double size) {
    double least, most;
    gn_sizes_range(sizes, &least, &most);
    const double x = fmin(fmax(size, least), most);
    if (sizes->kind == GN_SIZES_SIEVE) return gn_sizes_share(sizes, x);
    if (sizes->kind == GN_SIZES_UNIFORM || !(most > least))
        return most > least ? (x - least) / (most - least) : size >= least;
    const double mean = 0.5 * (least + most), deviation = sizes->variation >= 0.0
                                                              ? sizes->variation * mean
                                                              : (most - least) / 6.0;
    if (!(deviation > 0.0)) return size >= mean;
    const double low = below((least - mean) / deviation), high = below((most - mean) / deviation);
    return (below((x - mean) / deviation) - low) / (high - low);
}

/* Returns the largest deviation in a given unit of size, at the jumps of the cumulative sum. */
static double off_at(const gn_sizes *sizes, const double *radius, size_t count, double unit,
                     double sum, double *at) {
    const double power = sizes->kind == GN_SIZES_SIEVE ? sizes->dimension : 0.0;
    double most = 0.0, passed = 0.0;
    for (size_t k = 0; k < count; k++) {
        const double asked = sizes_below(sizes, radius[k] / unit), before = passed / sum;
        passed += pow(radius[k], power);
        const double off = fmax(fabs(asked - before), fabs(passed / sum - asked));
        if (off > most) *at = radius[k] / unit;
        most = fmax(most, off);
    }
    return most;
}

double gn_sizes_off(const gn_sizes *sizes, double *radius, size_t count, double *at) {
    enum { UNITS = 200 };
    const double power = sizes->kind == GN_SIZES_SIEVE ? sizes->dimension : 0.0;
    double least, most, sum = 0.0, found = 1.0;
    gn_sizes_range(sizes, &least, &most);
    gn_sort_numbers(radius, count);
    for (size_t k = 0; k < count; k++) sum += pow(radius[k], power);
    const double low = radius[0] / least, high = radius[count - 1] / most,
                 first = 0.8 * fmin(low, high), last = 1.25 * fmax(low, high);
    for (int k = 0; k <= UNITS; k++) {
        double here = 0.0;
        const double unit = first * pow(last / first, (double)k / UNITS),
                     off = off_at(sizes, radius, count, unit, sum, &here);
        if (off < found) *at = here / most;
        found = fmin(found, off);
    }
    return found;
}
