/* From particles to material: average stress and strain, fabric, damage, laboratory readings.
 * Tension is positive in every stress and strain here; laboratory readings are positive in
 * compression tests (peak_stress, peak_strain) as reported in the field. */
#ifndef GN_MEASURE_MEASURE_H
#define GN_MEASURE_MEASURE_H

#include "base/test_kind.h"
#include "measure/history.h"
#include "soa/records.h"

#include <stdbool.h>

/* The force-carrying parts of a state. Any list may be empty (count 0); `walls` may be NULL. */
typedef struct gn_assembly {
    int dimension; /* 2 or 3 */
    const gn_particles *particles;
    const gn_contacts *bonds;              /* may be NULL */
    const gn_contacts *pairs;              /* may be NULL */
    const gn_wall_contacts *wall_contacts; /* may be NULL */
    const double *wall_normals;            /* [walls][4], unit, pointing to the particles */
    bool periodic;
    double period[3];  /* m, with `periodic` */
    size_t wall_count; /* larger values of gn_wall_contacts.wall are facets */
} gn_assembly;

/* --- strain (Bagi 1996) --- */

/* A strain gauge. The volume average of the displacement gradient over a Delaunay triangulation of
 * the reference centres is linear in the displacements: <du_a/dx_b> = sum_p u_a(p) w_b(p). The
 * weights of inner particles vanish (divergence theorem), so that a reading costs only the surface
 * particles. In a bonded body only particles with more initial bonds than dimensions count, unless
 * fewer than half of all have them. */
typedef struct gn_strain_gauge {
    size_t count;
    int32_t *id;    /* [count] particle ids with a non-zero weight */
    double *weight; /* [count][3], 1/m */
    double volume;  /* of the triangulation, m3 (m2 in 2D, per unit thickness) */
} gn_strain_gauge;

/* Selects the particles that count initially: counts[p] 1 or 0, [particles]. */
void gn_strain_gauge_select(const gn_particles *particles, int dimension, uint8_t *counts);

/* Triangulates `particles->start` of those that count. Fewer than dimension + 1 particles or all on
 * a plane (line): count 0 and GNEISS_OK, readings are then NaN. */
gneiss_status gn_strain_gauge_of(const gn_particles *particles, const uint8_t *counts,
                                 int dimension, gn_strain_gauge *gauge, gneiss_error *error);
/* Makes such a gauge in a tenth of the time where a triangulation would be needed, as for lattices:
 * by another surface through the outer particles, which reads a uniform gradient as exactly. */
gneiss_status gn_strain_gauge_fast(const gn_particles *particles, const uint8_t *counts,
                                   int dimension, gn_strain_gauge *gauge, gneiss_error *error);
/* Makes a gauge of the particles that count initially. */
gneiss_status gn_strain_gauge_create(const gn_particles *particles, int dimension,
                                     gn_strain_gauge *gauge, gneiss_error *error);
void gn_strain_gauge_free(gn_strain_gauge *gauge);

/* Computes the displacement gradient g[3*a + b] = <du_a/dx_b>, a, b = x y z; `index_of_id[id]` is
 * the particle's present place (negative: removed, its last displacement counts as zero). NaN with
 * an empty gauge. */
void gn_strain_gauge_read(const gn_strain_gauge *gauge, const gn_particles *particles,
                          const int32_t *index_of_id, double gradient[9]);

/* Computes the strain of a displacement gradient that is invariant to rotation: U - 1 with U^2 =
 * F^T F, F = 1 + g (Biot 1965). For small gradients it is the symmetric part. */
void gn_strain_of(const double gradient[9], double strain[9]);

/* --- stress --- */

/* sigma[3*a + b] = (1/V) sum_c f_a l_b, not symmetrised: f on the first particle, l = x_j - x_i,
 * and for walls from the particle's centre to the contact point. `volume` in m3 (m2 x unit
 * thickness in 2D). */
void gn_stress_average(const gn_assembly *assembly, double volume, double sigma[9]);

/* Computes the stress per particle: the sum over its contacts of the force on it times the vector
 * from its centre to the contact point, over V_p/(1 - porosity). `sigma` [count][6]: xx yy zz xy yz
 * xz, symmetric part, in the particles' present order. */
void gn_stress_particles(const gn_assembly *assembly, double porosity, double *sigma);

/* --- packing --- */

typedef struct gn_packing_figures {
    size_t particles;
    size_t contacts;     /* pairs with gap <= tolerance (r_i + r_j) */
    double coordination; /* 2 contacts/particles */
    double fabric[9];    /* (1/N_c) sum n n */
    double radius_min, radius_max, radius_mean;
    double solid_volume;          /* sum of particle volumes, m3 */
    double porosity;              /* 1 - solid/volume; NaN without a volume */
    double overlap_max;           /* largest overlap over r_i + r_j */
    double overlap_mean;          /* mean over overlapping pairs */
    int32_t overlap_i, overlap_j; /* ids of the pair with the largest overlap, -1: none */
} gn_packing_figures;

/* Computes packing figures. `pairs` [pair_count][2] are candidate pairs (present indices) that
 * include every pair within tolerance. `volume` 0: unknown. */
void gn_packing_measure(const gn_assembly *assembly, const int32_t *pairs, size_t pair_count,
                        double tolerance, double volume, gn_packing_figures *figures);

/* Computes the volume (2D: area) of the convex hull of the particles, spheres or discs, to some
 * 1e-4 for any rotation; it is the specimen's volume if the scene gives none. Also computes the
 * extent (largest and smallest coordinate including radii) along each axis. */
gneiss_status gn_packing_hull(const gn_particles *particles, int dimension, double *volume,
                              double lower[3], double upper[3], gneiss_error *error);

/* Computes damage D = 1 - bonds now / bonds at the start per particle (Rojek et al. 2012, eq. 60),
 * 0 for particles that had no bonds; bonds that left with removed particles count as intact.
 * `damage` [count]. */
void gn_damage_particles(const gn_particles *particles, const gn_contacts *bonds, double *damage);

/* --- laboratory readings --- */

/* Tests to which a reading belongs. Without a test the readings of prisms are absent, with that
 * reason. */
#define GN_OF_ANY (~0u)
#define GN_OF_PRISMS                                                                               \
    (GN_TESTS(NONE) | GN_TESTS(COMPRESSION) | GN_TESTS(TENSION) | GN_TESTS_CONFINED)
#define GN_OF_AXIAL   (GN_TESTS(COMPRESSION) | GN_TESTS(TENSION) | GN_TESTS_CONFINED)
#define GN_OF_PRESSED (GN_TESTS(COMPRESSION) | GN_TESTS_CONFINED)
/* Marks readings of coupling zones, independent of the test. */
#define GN_OF_ZONES (1u << 31)

/* Final readings, SI: Y(X, name, tests, unit, text). */
#define GN_READING_LIST(Y, X)                                                                      \
    Y(X, young_modulus, GN_OF_PRISMS, "Pa",                                                        \
      "slope of stress over platen strain, least squares, from 1 % of the largest stress to "      \
      "elastic_stress")                                                                            \
    Y(X, young_modulus_average, GN_OF_PRISMS, "Pa",                                                \
      "slope of stress over the average (Bagi) axial strain, least squares, from 1 % of the "      \
      "largest stress to elastic_stress")                                                          \
    Y(X, poisson_ratio, GN_OF_PRISMS, "1",                                                         \
      "lateral over axial average strain, slopes over the same range")                             \
    Y(X, elastic_stress, ~GN_TESTS(NONE), "Pa",                                                    \
      "stress up to which elastic constants are read: that at which bonds begin to break, yield "  \
      "or soften, at most 50 % of the largest")                                                    \
    Y(X, peak_stress, GN_OF_ANY, "Pa",                                                             \
      "strength: largest axial stress, after which it fell; positive in the sense of the test")    \
    Y(X, peak_strain, GN_OF_ANY, "1",                                                              \
      "platen strain at the peak, positive in the sense of the test")                              \
    Y(X, largest_stress, GN_OF_ANY, "Pa", "largest axial stress so far, also without a peak")      \
    Y(X, largest_strain, GN_OF_ANY, "1", "platen strain at the largest stress")                    \
    Y(X, plane_young_modulus, GN_OF_PRISMS, "Pa",                                                  \
      "2D: E = E'(1 - nu^2), the plane-strain correction")                                         \
    Y(X, plane_poisson_ratio, GN_OF_PRISMS, "1",                                                   \
      "2D: nu = nu'/(1 + nu'), the plane-strain correction")                                       \
    Y(X, end_imbalance, ~GN_TESTS(HYDROSTATIC), "1",                                               \
      "difference of the forces of both ends over their mean, each summed up to the largest "      \
      "stress, so that waves between the ends cancel")                                             \
    Y(X, indirect_tensile_strength, GN_TESTS(BRAZILIAN), "Pa",                                     \
      "2 P/(pi D t) at the peak of the load P (ISRM 1978)")                                        \
    Y(X, centre_tension, GN_TESTS(BRAZILIAN), "Pa",                                                \
      "mean stress across the load about the middle of the disc at the peak, tension positive")    \
    Y(X, centre_ratio, GN_TESTS(BRAZILIAN), "1",                                                   \
      "centre_tension over 2 P/(pi D t): slope from 1 % of the largest load to elastic_stress; 1 " \
      "between line loads")                                                                        \
    Y(X, centre_compression_ratio, GN_TESTS(BRAZILIAN), "1",                                       \
      "stress along the load in the middle of the disc, compression positive, over 2 P/(pi D t): " \
      "3 between line loads (Hondros 1959)")                                                       \
    Y(X, flexural_strength, GN_TESTS(BENDING), "Pa",                                               \
      "stress in the fibre below mid-span at the peak by beam theory, 3 F a/(b h^2): h above the " \
      "notch, a from a support to the load next to it")                                            \
    Y(X, flexural_modulus, GN_TESTS(BENDING), "Pa",                                                \
      "slope of the stress over the strain of that fibre by beam theory, from 1 % of the largest " \
      "stress to elastic_stress; includes shear and the compliance of supports")                   \
    Y(X, peak_force, GN_TESTS(BENDING), "N",                                                       \
      "largest mean of both ends' force, after which it fell")                                     \
    Y(X, stiffness, GN_TESTS(BENDING), "N/m",                                                      \
      "slope of the mean of both ends' force over the deflection, from 1 % of the largest stress " \
      "to elastic_stress")                                                                         \
    Y(X, opening_at_peak, GN_TESTS(BENDING), "m", "opening of the gauge at the peak")              \
    Y(X, fracture_energy, GN_TESTS(BENDING) | GN_TESTS(TENSION), "J/m2",                           \
      "area under force over deflection, over the failed section (Hillerborg 1985, RILEM TC "      \
      "50-FMC); includes damping")                                                                 \
    Y(X, confinement, GN_TESTS_CONFINED, "Pa", "pressure of the membrane at the peak")             \
    Y(X, axial_strength, GN_TESTS_CONFINED, "Pa",                                                  \
      "largest axial stress: the deviator at the peak and the confinement")                        \
    Y(X, volumetric_strain_at_peak, GN_TESTS_CONFINED, "1",                                        \
      "volumetric_strain at the peak: the trace of the average strain, compression positive")      \
    Y(X, lateral_strain_at_peak, GN_TESTS_CONFINED, "1",                                           \
      "average lateral strain at the peak, compression positive")                                  \
    Y(X, bulk_modulus, GN_TESTS(HYDROSTATIC), "Pa",                                                \
      "slope of the mean pressure over the loss of volume, from 1 % of the largest to "            \
      "elastic_stress; 2D: of area")                                                               \
    Y(X, oedometric_modulus, GN_TESTS(OEDOMETER), "Pa",                                            \
      "slope of stress over platen strain between fixed sides, from 1 % of the largest to "        \
      "elastic_stress")                                                                            \
    Y(X, lateral_stress_ratio, GN_TESTS(OEDOMETER), "1",                                           \
      "mean lateral over axial stress of the specimen, slopes over the same range (K_0)")          \
    Y(X, shear_strength, GN_TESTS_SHEARED, "Pa", "largest shear stress, after which it fell")      \
    Y(X, normal_stress_at_peak, GN_TESTS_SHEARED, "Pa",                                            \
      "stress across the sheared plane at the peak, compression positive")                         \
    Y(X, shear_modulus, GN_TESTS_SHEARED, "Pa",                                                    \
      "slope of shear stress over the displacement of the ends over the length, from 1 % of the "  \
      "largest to elastic_stress")                                                                 \
    Y(X, dilation_at_peak, GN_TESTS_SHEARED, "m",                                                  \
      "displacement across the sheared plane at the peak")                                         \
    Y(X, tangent_modulus, GN_OF_AXIAL, "Pa",                                                       \
      "slope of stress over platen strain, 40 to 60 % of the largest stress (ISRM 1979: at half "  \
      "the strength)")                                                                             \
    Y(X, secant_modulus, ~(GN_TESTS(NONE) | GN_TESTS(BRAZILIAN)), "Pa",                            \
      "stress over strain of the test from the first row with 1 % of the largest stress to that "  \
      "with 50 % of it (ISRM 1979), including any failure or yield between them")                  \
    Y(X, secant_poisson_ratio, GN_OF_AXIAL, "1",                                                   \
      "lateral over axial average strain between the rows with 1 % and 50 % of the largest "       \
      "stress")                                                                                    \
    Y(X, average_modulus, GN_OF_AXIAL, "Pa",                                                       \
      "slope of stress over platen strain, 20 to 80 % of the largest stress, the approximately "   \
      "straight part (ISRM 1979)")                                                                 \
    Y(X, crack_initiation_stress, GN_OF_AXIAL, "Pa",                                               \
      "stress at which 1 % of the bonds that are broken at the peak have broken (Potyondy & "      \
      "Cundall 2004)")                                                                             \
    Y(X, crack_damage_stress, GN_OF_PRESSED, "Pa",                                                 \
      "stress at which the specimen ceases to lose volume before the peak (Martin & Chandler "     \
      "1994)")                                                                                     \
    Y(X, brittleness, GN_OF_AXIAL | GN_TESTS(BRAZILIAN) | GN_TESTS(BENDING) | GN_TESTS_SHEARED,    \
      "1",                                                                                         \
      "fraction of the peak that the stress lost by the end of the run (Bishop 1967), at most 1")  \
    Y(X, events, ~GN_TESTS(NONE), "1",                                                             \
      "bursts of breaking bonds: failures close to each other in space and time "                  \
      "(output.burst_reach)")                                                                      \
    Y(X, b_value, ~GN_TESTS(NONE), "1",                                                            \
      "slope of log N over log10 of the broken bonds of a burst, N counting bursts of at least "   \
      "that size: maximum likelihood of a discrete power law (Aki 1965, Clauset et al. 2009)")     \
    Y(X, fragments, ~GN_TESTS(NONE), "1", "fragments of two or more bonded particles at the end")  \
    Y(X, largest_fragment, ~GN_TESTS(NONE), "1",                                                   \
      "fraction of the particles' volume in the largest fragment")                                 \
    Y(X, returned_energy, GN_OF_ZONES, "1",                                                        \
      "energy of plane waves in elements outside of zones that travel away from the particles of " \
      "the first zone at the end, over the energy that was there or has come in")

#define GN_READING_PLAIN(X, name, tests, unit, text) X(name, unit, text)
#define GN_READINGS(X)                               GN_READING_LIST(GN_READING_PLAIN, X)

#define X(name, unit, text) GN_READING_##name,
typedef enum gn_reading { GN_READINGS(X) GN_READING_COUNT } gn_reading;
#undef X

enum { GN_REASON_SIZE = 160 };

typedef struct gn_readings {
#define X(name, unit, text) double name;
    GN_READINGS(X)
#undef X
    /* reason why one is absent (NaN); "": it is present */
    char reason[GN_READING_COUNT][GN_REASON_SIZE];
    /* Relative increase of the stress from the previous row to the largest, at most 1; the strains
     * of the rows before and after it. */
    double peak_rise, peak_strain_least, peak_strain_most;
    /* Relative difference of a slope over the first and the second half of its rows from that over
     * all of them; 0: unknown. */
    double nonlinearity[GN_READING_COUNT];
    double peak_fall;      /* fraction of the largest stress by which the last row is below it */
    double initial_stress; /* Pa, at the ends before they moved; 0: they never did */
    double initial_fall;   /* Pa, decrease of that before the test began (beginning.h) */
} gn_readings;

/* Tells whether a reading belongs to tests of a kind, in a scene with zones or without: results and
 * summaries contain only those. */
bool gn_reading_belongs(gn_reading which, gn_test_kind kind, bool zones);

/* The tested specimen and its test. */
typedef struct gn_tested {
    gn_test_kind kind;
    int dimension, axis;                /* axis 0 1 2 */
    int sign;                           /* -1 compression, +1 tension */
    bool elastic;                       /* nothing in it can fail */
    bool one_sided;                     /* one end has the force of the other by definition */
    bool notched;                       /* a beam */
    bool under_gravity;                 /* under gravity */
    bool conversion_halted;             /* conversion ended the run */
    double section;                     /* m2, of the failing section */
    double fragments, largest_fragment; /* computed elsewhere; NaN: no bonds */
    /* [burst_count] number of broken bonds of each, computed elsewhere; NULL: */
    const int32_t *bursts;
    size_t burst_count;
    const char *no_bursts; /* reason why there are none */
    /* Young's modulus over the slope of stress over the strain of the test, and over mean strain,
     * for a varying section; 0: as 1; NaN: none follows from it. */
    double by_ends, by_mean;
    bool zones;             /* particles and elements share zones */
    double returned_energy; /* at the end, computed elsewhere; NaN: not defined */
} gn_tested;

/* Computes readings from the history columns `strain`, `stress`, `stress_lower`, `stress_upper`
 * (positive in the sense of the test), `strain_xx` .. and `stress_xx` .. (averages, tension
 * positive), `broken_tension`, `broken_shear`, and those of the test kind; missing columns are
 * ignored. In 2D the lateral strain is that of the one other in-plane axis. A reading that the
 * curves cannot give is NaN and has a reason. */
void gn_readings_compute(const gn_history *history, const gn_tested *tested, gn_readings *readings);

#endif
