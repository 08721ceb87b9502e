#include "pack/quality.h"

#include "base/ball.h"
#include "base/eigen.h"
#include "base/new.h"
#include "base/sort.h"
#include "neigh/neigh.h"
#include "pack/spheres.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns the common volume of two balls with distance d < a + b between their centres. */
static double lens(int dimension, double a, double b, double d) {
    if (d <= fabs(a - b)) return gn_ball_volume(dimension, fmin(a, b));
    if (dimension == 3) {
        double t = a + b - d;
        return M_PI * t * t * (d * d + 2.0 * d * (a + b) - 3.0 * (a - b) * (a - b)) / (12.0 * d);
    }
    double p = (d * d + a * a - b * b) / (2.0 * d * a), q = (d * d + b * b - a * a) / (2.0 * d * b);
    double kite = (-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b);
    /* By rounding, p and q can exceed 1 if one ball touches the other from inside. */
    double turn_a = acos(fmax(fmin(p, 1.0), -1.0)), turn_b = acos(fmax(fmin(q, 1.0), -1.0));
    return a * a * turn_a + b * b * turn_b - 0.5 * sqrt(fmax(kite, 0.0));
}

/* ---- radii ---- */

static void count_radii(const double *sorted, size_t count, gn_pack_quality *quality) {
    double low = sorted[0], high = sorted[count - 1];
    for (int k = 0; k <= GN_PACK_RADIUS_BINS; k++)
        quality->radius_edge[k] = low + (high - low) * k / GN_PACK_RADIUS_BINS;
    for (size_t k = 0; k < count; k++) {
        double place = high > low ? (sorted[k] - low) / (high - low) * GN_PACK_RADIUS_BINS : 0.0;
        quality->radius_count[place < GN_PACK_RADIUS_BINS ? (int)place : GN_PACK_RADIUS_BINS - 1]++;
    }
}

static double median(const double *sorted, size_t n) {
    return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
}

/* The shape of the distribution is 0 if all particles are alike. */
static void measure_shape(const double *sorted, size_t count, gn_pack_quality *quality) {
    double squares = 0.0, cubes = 0.0, fourths = 0.0, n = (double)count;
    for (size_t k = 0; k < count; k++) {
        double d = sorted[k] - quality->radius_mean, d2 = d * d;
        squares += d2;
        cubes += d2 * d;
        fourths += d2 * d2;
    }
    double variance = squares / n;
    bool varies = variance > 1e-24 * quality->radius_mean * quality->radius_mean;
    quality->radius_deviation = sqrt(variance);
    quality->radius_variation = quality->radius_deviation / quality->radius_mean;
    quality->radius_median = median(sorted, count);
    quality->radius_skewness = varies ? cubes / n / (variance * quality->radius_deviation) : 0.0;
    quality->radius_kurtosis = varies ? fourths / n / (variance * variance) : 0.0;
}

static gneiss_status measure_radii(const gn_packing *packing, int dimension, double volume,
                                   gn_pack_quality *quality, gneiss_error *error) {
    const size_t count = packing->count;
    double sum = 0.0, volumes = 0.0, n = (double)count;
    GN_FREED double *sorted = NULL;
    GN_TRY(gn_new(&sorted, count, "radii", error));
    for (size_t k = 0; k < count; k++) {
        sorted[k] = packing->sphere[4 * k + 3];
        sum += sorted[k];
        volumes += gn_ball_volume(dimension, sorted[k]);
    }
    gn_sort_numbers(sorted, count);
    quality->radius_mean = sum / n;
    measure_shape(sorted, count, quality);
    quality->radius_volume = pow(volumes / n / gn_ball_volume(dimension, 1.0), 1.0 / dimension);
    quality->radius_min = sorted[0];
    quality->radius_max = sorted[count - 1];
    quality->radius_ratio = quality->radius_max / quality->radius_min;
    quality->radius_ratio_98 = sorted[count - 1 - count / 100] / sorted[count / 100];
    quality->porosity = 1.0 - volumes / volume;
    count_radii(sorted, count, quality);
    return GNEISS_OK;
}

/* ---- contacts ---- */

typedef struct tally {
    double lenses, overlap_sum, distance_sum;
    size_t at_01, at_1, at_5, overlaps;
    double *overlap;   /* [pairs] of the pairs that overlap, in their order */
    int32_t *contacts; /* [particles] number of contacts at 1 % */
} tally;

static void count_direction(const double n[3], gn_pack_quality *quality) {
    for (int a = 0; a < 9; a++) quality->fabric[a] += n[a / 3] * n[a % 3];
    double turn = atan2(n[1], n[0]) / (2.0 * M_PI);
    for (int way = 0; way < 2; way++) {
        double at = turn + 0.5 * way;
        int bin = (int)((at - floor(at)) * GN_PACK_ANGLE_BINS);
        quality->angle_count[bin < GN_PACK_ANGLE_BINS ? bin : 0]++;
    }
    int bin = (int)(fabs(n[2]) * GN_PACK_ANGLE_BINS);
    quality->polar_count[bin < GN_PACK_ANGLE_BINS ? bin : GN_PACK_ANGLE_BINS - 1] += 2;
}

static void count_pair(const gn_packing *packing, int dimension, size_t k, gn_pack_quality *quality,
                       tally *counts) {
    const double *a = packing->sphere + 4 * quality->pair[k][0],
                 *b = packing->sphere + 4 * quality->pair[k][1];
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), reach = a[3] + b[3];
    double gap = (length - reach) / reach;
    quality->gap[k] = gap;
    counts->at_01 += gap <= 0.001;
    counts->at_5++;
    counts->distance_sum += length / reach;
    if (gap <= 0.01) {
        counts->at_1++;
        counts->contacts[quality->pair[k][0]]++;
        counts->contacts[quality->pair[k][1]]++;
        if (length > 0.0) {
            double n[3] = {u[0] / length, u[1] / length, u[2] / length};
            count_direction(n, quality);
        }
    }
    if (gap >= -1e-9) return;
    counts->overlap[counts->overlaps++] = -gap;
    counts->overlap_sum -= gap;
    counts->lenses += lens(dimension, a[3], b[3], length);
}

static void measure_fabric(int dimension, const tally *counts, gn_pack_quality *quality) {
    double m[9], values[3], vectors[9];
    for (int a = 0; a < 9; a++) quality->fabric[a] /= counts->at_1 ? (double)counts->at_1 : 1.0;
    for (int a = 0; a < dimension; a++)
        for (int b = 0; b < dimension; b++) m[dimension * a + b] = quality->fabric[3 * a + b];
    gn_eigen_symmetric(dimension, m, values, vectors);
    quality->fabric_max = values[0];
    quality->fabric_min = values[dimension - 1];
    quality->anisotropy = fmax(fabs(dimension * quality->fabric_max - 1.0),
                               fabs(dimension * quality->fabric_min - 1.0));
}

static void measure_contacts(const gn_packing *packing, int dimension, double volume, tally *counts,
                             gn_pack_quality *quality) {
    double n = (double)packing->count;
    for (size_t k = 0; k < quality->pair_count; k++)
        count_pair(packing, dimension, k, quality, counts);
    quality->coordination_01 = 2.0 * (double)counts->at_01 / n;
    quality->coordination_1 = 2.0 * (double)counts->at_1 / n;
    quality->coordination_5 = 2.0 * (double)counts->at_5 / n;
    quality->distance_mean = counts->at_5 ? counts->distance_sum / (double)counts->at_5 : NAN;
    quality->overlaps = (double)counts->overlaps / n;
    gn_sort_numbers(counts->overlap, counts->overlaps);
    if (counts->overlaps) {
        quality->overlap_median = counts->overlap[counts->overlaps / 2];
        quality->overlap_mean = counts->overlap_sum / (double)counts->overlaps;
        quality->overlap_max = counts->overlap[counts->overlaps - 1];
    }
    quality->porosity_net = quality->porosity + counts->lenses / volume;
    quality->void_ratio = quality->porosity / (1.0 - quality->porosity);
    measure_fabric(dimension, counts, quality);
}

/* ---- boundary ---- */

static void measure_walls(const gn_packing *packing, const gn_domain *domain, tally *counts,
                          gn_pack_quality *quality) {
    double squares = 0.0;
    size_t touching = 0;
    for (size_t k = 0; k < packing->count; k++) {
        const double *x = packing->sphere + 4 * k;
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        int count = gn_domain_planes(domain, x, 1.05 * x[3], plane);
        if (count == 0) continue;
        double gap = (plane[0].depth - x[3]) / x[3];
        quality->wall_protrusion = fmax(quality->wall_protrusion, -gap);
        squares += gap * gap;
        touching++;
        for (int c = 0; c < count; c++) counts->contacts[k] += plane[c].depth < 1.01 * x[3];
    }
    quality->wall_contacts = (double)touching / (double)packing->count;
    quality->wall_gap_rms = touching ? sqrt(squares / (double)touching) : 0.0;
}

static gneiss_status find_pairs(const gn_packing *packing, int dimension, int threads,
                                gn_pack_quality *quality, gneiss_error *error) {
    gn_particles particles;
    gn_pair_list list = {0};
    GN_TRY(gn_particles_of_spheres(packing->sphere, packing->count, &particles, error));
    gn_pair_query query = {
        .particles = &particles, .dimension = dimension, .range = 0.05, .threads = threads};
    gneiss_status status = gn_pairs_find(&query, &list, error);
    quality->pair = list.pair;
    quality->pair_count = list.count;
    gn_soa_destroy(&gn_particle_record, &particles);
    return status;
}

gneiss_status gn_pack_measure(const gn_packing *packing, int dimension, const gn_domain *domain,
                              double volume, int threads, gn_pack_quality *quality,
                              gneiss_error *error) {
    *quality = (gn_pack_quality){0};
    tally t = {.contacts = gn_alloc_array(packing->count + 1, sizeof *t.contacts)};
    gneiss_status status = find_pairs(packing, dimension, threads, quality, error);
    if (status == GNEISS_OK) status = measure_radii(packing, dimension, volume, quality, error);
    t.overlap = gn_alloc_array(quality->pair_count + 1, sizeof *t.overlap);
    quality->gap = gn_alloc_array(quality->pair_count + 1, sizeof *quality->gap);
    if (status == GNEISS_OK && !(t.overlap && t.contacts && quality->gap))
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to measure %zu particles",
                         packing->count);
    if (status == GNEISS_OK) {
        measure_contacts(packing, dimension, volume, &t, quality);
        if (domain) measure_walls(packing, domain, &t, quality);
        size_t floating = 0;
        for (size_t k = 0; k < packing->count; k++) floating += t.contacts[k] <= dimension;
        quality->floating = (double)floating / (double)packing->count;
    }
    gn_free(t.contacts);
    gn_free(t.overlap);
    if (status != GNEISS_OK) gn_pack_quality_free(quality);
    return status;
}

void gn_pack_quality_free(gn_pack_quality *quality) {
    gn_free(quality->pair);
    gn_free(quality->gap);
    *quality = (gn_pack_quality){0};
}
