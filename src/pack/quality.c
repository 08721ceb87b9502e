#include "pack/quality.h"

#include "base/ball.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "neigh/pairs.h"
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
    /* p and q can exceed 1 by rounding if one touches the other from inside. */
    double turn_a = acos(fmax(fmin(p, 1.0), -1.0)), turn_b = acos(fmax(fmin(q, 1.0), -1.0));
    return a * a * turn_a + b * b * turn_b - 0.5 * sqrt(fmax(kite, 0.0));
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* ---- radii ---- */

static void count_radii(const double *sorted, size_t count, gn_pack_quality *q) {
    double low = sorted[0], high = sorted[count - 1];
    for (int k = 0; k <= GN_PACK_RADIUS_BINS; k++)
        q->radius_edge[k] = low + (high - low) * k / GN_PACK_RADIUS_BINS;
    for (size_t k = 0; k < count; k++) {
        double place = high > low ? (sorted[k] - low) / (high - low) * GN_PACK_RADIUS_BINS : 0.0;
        q->radius_count[place < GN_PACK_RADIUS_BINS ? (int)place : GN_PACK_RADIUS_BINS - 1]++;
    }
}

static double median(const double *sorted, size_t n) {
    return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
}

/* The shape of the distribution is 0 if all particles are alike. */
static void measure_shape(const double *sorted, size_t count, gn_pack_quality *q) {
    double squares = 0.0, cubes = 0.0, fourths = 0.0, n = (double)count;
    for (size_t k = 0; k < count; k++) {
        double d = sorted[k] - q->radius_mean, d2 = d * d;
        squares += d2;
        cubes += d2 * d;
        fourths += d2 * d2;
    }
    double variance = squares / n;
    bool varies = variance > 1e-24 * q->radius_mean * q->radius_mean;
    q->radius_deviation = sqrt(variance);
    q->radius_variation = q->radius_deviation / q->radius_mean;
    q->radius_median = median(sorted, count);
    q->radius_skewness = varies ? cubes / n / (variance * q->radius_deviation) : 0.0;
    q->radius_kurtosis = varies ? fourths / n / (variance * variance) : 0.0;
}

static gneiss_status measure_radii(const gn_packing *p, int dimension, double volume,
                                   gn_pack_quality *q, gneiss_error *error) {
    double *sorted = gn_alloc_array(p->count + 1, sizeof *sorted);
    if (!sorted) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu radii", p->count);
    double sum = 0.0, volumes = 0.0, n = (double)p->count;
    for (size_t k = 0; k < p->count; k++) {
        sorted[k] = p->sphere[4 * k + 3];
        sum += sorted[k];
        volumes += gn_ball_volume(dimension, sorted[k]);
    }
    qsort(sorted, p->count, sizeof *sorted, ascending);
    q->radius_mean = sum / n;
    measure_shape(sorted, p->count, q);
    q->radius_volume = pow(volumes / n / gn_ball_volume(dimension, 1.0), 1.0 / dimension);
    q->radius_min = sorted[0];
    q->radius_max = sorted[p->count - 1];
    q->radius_ratio = q->radius_max / q->radius_min;
    size_t hundredth = p->count / 100;
    q->radius_ratio_98 = sorted[p->count - 1 - hundredth] / sorted[hundredth];
    q->porosity = 1.0 - volumes / volume;
    count_radii(sorted, p->count, q);
    gn_free(sorted);
    return GNEISS_OK;
}

/* ---- contacts ---- */

typedef struct tally {
    double lenses, overlap_sum, distance_sum;
    size_t at_01, at_1, at_5, overlaps;
    double *overlap;   /* [pairs] those that overlap, in order */
    int32_t *contacts; /* [particles] at 1 % */
} tally;

static void count_direction(const double n[3], gn_pack_quality *q) {
    for (int a = 0; a < 9; a++) q->fabric[a] += n[a / 3] * n[a % 3];
    double turn = atan2(n[1], n[0]) / (2.0 * M_PI);
    for (int way = 0; way < 2; way++) {
        double at = turn + 0.5 * way;
        int bin = (int)((at - floor(at)) * GN_PACK_ANGLE_BINS);
        q->angle_count[bin < GN_PACK_ANGLE_BINS ? bin : 0]++;
    }
    int bin = (int)(fabs(n[2]) * GN_PACK_ANGLE_BINS);
    q->polar_count[bin < GN_PACK_ANGLE_BINS ? bin : GN_PACK_ANGLE_BINS - 1] += 2;
}

static void count_pair(const gn_packing *p, int dimension, size_t k, gn_pack_quality *q, tally *t) {
    const double *a = p->sphere + 4 * q->pair[k][0], *b = p->sphere + 4 * q->pair[k][1];
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), reach = a[3] + b[3];
    double gap = (length - reach) / reach;
    q->gap[k] = gap;
    t->at_01 += gap <= 0.001;
    t->at_5++;
    t->distance_sum += length / reach;
    if (gap <= 0.01) {
        t->at_1++;
        t->contacts[q->pair[k][0]]++;
        t->contacts[q->pair[k][1]]++;
        if (length > 0.0) {
            double n[3] = {u[0] / length, u[1] / length, u[2] / length};
            count_direction(n, q);
        }
    }
    if (gap >= -1e-9) return;
    t->overlap[t->overlaps++] = -gap;
    t->overlap_sum -= gap;
    t->lenses += lens(dimension, a[3], b[3], length);
}

static void measure_fabric(int dimension, const tally *t, gn_pack_quality *q) {
    double m[9], values[3], vectors[9];
    for (int a = 0; a < 9; a++) q->fabric[a] /= t->at_1 ? (double)t->at_1 : 1.0;
    for (int a = 0; a < dimension; a++)
        for (int b = 0; b < dimension; b++) m[dimension * a + b] = q->fabric[3 * a + b];
    gn_eigen_symmetric(dimension, m, values, vectors);
    q->fabric_max = values[0];
    q->fabric_min = values[dimension - 1];
    q->anisotropy =
        fmax(fabs(dimension * q->fabric_max - 1.0), fabs(dimension * q->fabric_min - 1.0));
}

static void measure_contacts(const gn_packing *p, int dimension, double volume, tally *t,
                             gn_pack_quality *q) {
    double n = (double)p->count;
    for (size_t k = 0; k < q->pair_count; k++) count_pair(p, dimension, k, q, t);
    q->coordination_01 = 2.0 * (double)t->at_01 / n;
    q->coordination_1 = 2.0 * (double)t->at_1 / n;
    q->coordination_5 = 2.0 * (double)t->at_5 / n;
    q->distance_mean = t->at_5 ? t->distance_sum / (double)t->at_5 : NAN;
    q->overlaps = (double)t->overlaps / n;
    qsort(t->overlap, t->overlaps, sizeof *t->overlap, ascending);
    if (t->overlaps) {
        q->overlap_median = t->overlap[t->overlaps / 2];
        q->overlap_mean = t->overlap_sum / (double)t->overlaps;
        q->overlap_max = t->overlap[t->overlaps - 1];
    }
    q->porosity_net = q->porosity + t->lenses / volume;
    q->void_ratio = q->porosity / (1.0 - q->porosity);
    measure_fabric(dimension, t, q);
}

/* ---- boundary ---- */

static void measure_walls(const gn_packing *p, const gn_domain *domain, tally *t,
                          gn_pack_quality *q) {
    double squares = 0.0;
    size_t touching = 0;
    for (size_t k = 0; k < p->count; k++) {
        const double *x = p->sphere + 4 * k;
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        int count = gn_domain_planes(domain, x, 1.05 * x[3], plane);
        if (count == 0) continue;
        double gap = (plane[0].depth - x[3]) / x[3];
        q->wall_protrusion = fmax(q->wall_protrusion, -gap);
        squares += gap * gap;
        touching++;
        for (int c = 0; c < count; c++) t->contacts[k] += plane[c].depth < 1.01 * x[3];
    }
    q->wall_contacts = (double)touching / (double)p->count;
    q->wall_gap_rms = touching ? sqrt(squares / (double)touching) : 0.0;
}

static gneiss_status find_pairs(const gn_packing *p, int dimension, int threads, gn_pack_quality *q,
                                gneiss_error *error) {
    gn_particles particles;
    gn_pair_list list = {0};
    GN_TRY(gn_particles_of_spheres(p->sphere, p->count, &particles, error));
    gn_pair_query query = {
        .particles = &particles, .dimension = dimension, .range = 0.05, .threads = threads};
    gneiss_status status = gn_pairs_find(&query, &list, error);
    q->pair = list.pair;
    q->pair_count = list.count;
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
