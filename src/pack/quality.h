/* Quality measures of a packing (Labra 2012, ch. 3; defined in docs/evidence/packing.md). */
#ifndef GN_PACK_QUALITY_H
#define GN_PACK_QUALITY_H

#include "pack/domain.h"
#include "pack/pack.h"

/* Figures of a packing. Contacts are pairs with a gap of at most a tolerance times r_i + r_j. */
#define GN_PACK_FIGURES(X)                                                                         \
    X(porosity, "1", "1 - sum of the particles' volumes over the body's; overlaps count twice")    \
    X(porosity_net, "1", "porosity with the volume of overlap lenses counted once")                \
    X(void_ratio, "1", "voids over solids, e/(1 - e)")                                             \
    X(coordination_01, "1", "contacts per particle at a tolerance of 0.1 %, 2 N_c/N")              \
    X(coordination_1, "1", "contacts per particle at a tolerance of 1 %")                          \
    X(coordination_5, "1", "contacts per particle at a tolerance of 5 %")                          \
    X(floating, "1",                                                                               \
      "share of particles with fewer than dimension + 1 contacts at 1 %, walls "                   \
      "included: they are not held in place")                                                      \
    X(radius_mean, "m", "mean radius")                                                             \
    X(radius_volume, "m", "(mean of r^d)^(1/d), d dimensions")                                     \
    X(radius_min, "m", "smallest radius")                                                          \
    X(radius_max, "m", "largest radius")                                                           \
    X(radius_ratio, "1", "largest over smallest radius")                                           \
    X(radius_ratio_98, "1", "99 % over 1 % quantile of the radii")                                 \
    X(radius_variation, "1", "standard deviation of the radii over their mean")                    \
    X(radius_median, "m", "median radius")                                                         \
    X(radius_deviation, "m", "standard deviation of the radii")                                    \
    X(radius_skewness, "1", "third central moment of the radii over their deviation cubed")        \
    X(radius_kurtosis, "1",                                                                        \
      "fourth central moment over the fourth power of the deviation; normal: 3, uniform: 1.8")     \
    X(fabric_max, "1", "largest eigenvalue of (1/N_c) sum n n over contacts at 1 %")               \
    X(fabric_min, "1", "smallest eigenvalue of that tensor; isotropic: 1/dimension")               \
    X(anisotropy, "1", "largest deviation of an eigenvalue from 1/dimension, times dimension")     \
    X(distance_mean, "1", "mean of |x_i - x_j|/(r_i + r_j) over contacts at 5 %")                  \
    X(overlap_median, "1", "median overlap over r_i + r_j of the pairs that overlap")              \
    X(overlap_mean, "1", "mean overlap over r_i + r_j of the pairs that overlap")                  \
    X(overlap_max, "1", "largest overlap over r_i + r_j of the pairs that overlap")                \
    X(overlaps, "1", "pairs that overlap by more than 1e-9 of r_i + r_j, per particle")            \
    X(wall_contacts, "1", "particles within 5 % of their radius of the boundary, over all")        \
    X(wall_gap_rms, "1", "root mean square of their distance from touching it over their radius")  \
    X(wall_protrusion, "1", "largest protrusion of a particle from the body over its radius")

enum { GN_PACK_RADIUS_BINS = 24, GN_PACK_ANGLE_BINS = 36 };

typedef struct gn_pack_quality {
#define GN_PACK_MEMBER(name, unit, text) double name;
    GN_PACK_FIGURES(GN_PACK_MEMBER)
#undef GN_PACK_MEMBER
    double fabric[9];                            /* fabric of contacts at 1 % */
    double radius_edge[GN_PACK_RADIUS_BINS + 1]; /* m */
    int64_t radius_count[GN_PACK_RADIUS_BINS];
    /* Directions of contacts at 1 %, counted in both senses: angles in the xy plane, and in space
     * also |cos| of the angle with z in equal intervals, over which an isotropic packing is
     * uniform. */
    int64_t angle_count[GN_PACK_ANGLE_BINS];
    int64_t polar_count[GN_PACK_ANGLE_BINS];
    size_t pair_count; /* pairs within 5 % */
    int32_t (*pair)[2];
    double *gap; /* [pair_count] over r_i + r_j, negative: overlap */
} gn_pack_quality;

/* Measures a packing. Without a `domain` (NULL) the figures of walls are absent, and `volume` is
 * the volume of the body. */
gneiss_status gn_pack_measure(const gn_packing *packing, int dimension, const gn_domain *domain,
                              double volume, int threads, gn_pack_quality *quality,
                              gneiss_error *error);
void gn_pack_quality_free(gn_pack_quality *quality);

#endif
