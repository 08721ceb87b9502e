#include "pack/sizes.h"

#include "base/random.h"

#include <math.h>
#include <stdbool.h>

/* Uniform in [0, 1). */
static double draw(gn_drawn *drawn) {
    return 0.5 * (1.0 + gn_random_symmetric(drawn->seed, drawn->count++));
}

/* Share of the mass that passes -> size over the largest. */
static double sieve_size(const gn_sizes *s, double share) {
    size_t k = 1;
    while (k + 1 < s->sieve_count && s->sieve[2 * k + 1] < share) k++;
    const double *low = s->sieve + 2 * k - 2, *high = s->sieve + 2 * k;
    double rise = high[1] - low[1];
    return rise > 0.0 ? low[0] + (high[0] - low[0]) * fmin(1.0, (share - low[1]) / rise) : high[0];
}

/* Of a sieve curve, in which mass counts, a size is taken as often as r^-d, so that number counts.
 */
double gn_sizes_draw(const gn_sizes *s, gn_drawn *drawn) {
    const double ratio = s->ratio, mean = 0.5 * (1.0 + ratio);
    const double deviation = s->variation >= 0.0 ? s->variation * mean : (ratio - 1.0) / 6.0;
    if (s->kind == GN_SIZES_UNIFORM) return 1.0 + (ratio - 1.0) * draw(drawn);
    for (;;) {
        double u = 1.0 - draw(drawn), v = draw(drawn);
        if (s->kind == GN_SIZES_NORMAL) {
            double size = mean + deviation * sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
            if (size >= 1.0 && size <= ratio) return size;
        } else {
            double size = sieve_size(s, u);
            if (v < pow(s->sieve[0] / size, s->dimension)) return size;
        }
    }
}

void gn_sizes_range(const gn_sizes *s, double *least, double *most) {
    bool curve = s->kind == GN_SIZES_SIEVE;
    *least = curve ? s->sieve[0] : 1.0;
    *most = curve ? 1.0 : s->ratio;
}

double gn_sizes_share(const gn_sizes *s, double size) {
    size_t k = 1;
    while (k + 1 < s->sieve_count && s->sieve[2 * k] < size) k++;
    const double *low = s->sieve + 2 * k - 2, *high = s->sieve + 2 * k;
    double part = (size - low[0]) / (high[0] - low[0]);
    return low[1] + (high[1] - low[1]) * fmin(1.0, fmax(0.0, part));
}

/* Normal and uniform ones lie evenly about the middle. */
double gn_sizes_mean(const gn_sizes *s) {
    enum { DRAWN = 100000 };
    gn_drawn own = {UINT64_C(0x73697a6573), 0};
    double sum = 0.0;
    if (s->kind != GN_SIZES_SIEVE) return 0.5 * (1.0 + s->ratio);
    for (int k = 0; k < DRAWN; k++) sum += gn_sizes_draw(s, &own);
    return sum / DRAWN;
}
