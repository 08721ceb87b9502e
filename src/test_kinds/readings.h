/* Quantities that are read off the curves of a laboratory test. Tension is positive in average
 * stresses and strains; readings are positive in the sense of the test, as is usual in
 * laboratories. */
#ifndef GN_TEST_KINDS_READINGS_H
#define GN_TEST_KINDS_READINGS_H

#include "test_kinds/cut.h"
#include "test_kinds/history.h"
#include "test_kinds/test_kind.h"

/* Final readings, SI: X(name, unit, text). */
#define GN_READINGS(X)                                                                             \
    X(young_modulus, "Pa",                                                                         \
      "slope of stress over platen strain, least squares, from 1 % of the largest stress to "      \
      "elastic_stress")                                                                            \
    X(young_modulus_average, "Pa",                                                                 \
      "slope of stress over the average (Bagi) axial strain, least squares, from 1 % of the "      \
      "largest stress to elastic_stress")                                                          \
    X(poisson_ratio, "1", "lateral over axial average strain, slopes over the same range")         \
    X(elastic_stress, "Pa",                                                                        \
      "stress up to which elastic constants are read: that at which bonds begin to break, yield "  \
      "or soften, at most 50 % of the largest")                                                    \
    X(peak_stress, "Pa",                                                                           \
      "strength: largest axial stress, after which it fell; positive in the sense of the test")    \
    X(peak_strain, "1", "platen strain at the peak, positive in the sense of the test")            \
    X(largest_stress, "Pa", "largest axial stress so far, also without a peak")                    \
    X(largest_strain, "1", "platen strain at the largest stress")                                  \
    X(plane_young_modulus, "Pa", "2D: E = E'(1 - nu^2), the plane-strain correction")              \
    X(plane_poisson_ratio, "1", "2D: nu = nu'/(1 + nu'), the plane-strain correction")             \
    X(end_imbalance, "1",                                                                          \
      "difference of the forces of both ends over their mean, each summed up to the largest "      \
      "stress, so that waves between the ends cancel")                                             \
    X(indirect_tensile_strength, "Pa", "2 P/(pi D t) at the peak of the load P (ISRM 1978)")       \
    X(centre_tension, "Pa",                                                                        \
      "mean stress across the load about the middle of the disc at the peak, tension positive")    \
    X(centre_ratio, "1",                                                                           \
      "centre_tension over 2 P/(pi D t): slope from 1 % of the largest load to elastic_stress; 1 " \
      "between line loads")                                                                        \
    X(centre_compression_ratio, "1",                                                               \
      "stress along the load in the middle of the disc, compression positive, over 2 P/(pi D t): " \
      "3 between line loads (Hondros 1959)")                                                       \
    X(flexural_strength, "Pa",                                                                     \
      "stress in the fibre below mid-span at the peak by beam theory, 3 F a/(b h^2): h above the " \
      "notch, a from a support to the load next to it")                                            \
    X(flexural_modulus, "Pa",                                                                      \
      "slope of the stress over the strain of that fibre by beam theory, from 1 % of the largest " \
      "stress to elastic_stress; includes shear and the compliance of supports")                   \
    X(peak_force, "N", "largest mean of both ends' force, after which it fell")                    \
    X(stiffness, "N/m",                                                                            \
      "slope of the mean of both ends' force over the deflection, from 1 % of the largest stress " \
      "to elastic_stress")                                                                         \
    X(opening_at_peak, "m", "opening of the gauge at the peak")                                    \
    X(fracture_energy, "J/m2",                                                                     \
      "area under force over deflection, over the failed section (Hillerborg 1985, RILEM TC "      \
      "50-FMC); includes damping")                                                                 \
    X(confinement, "Pa", "pressure of the membrane at the peak")                                   \
    X(axial_strength, "Pa", "largest axial stress: the deviator at the peak and the confinement")  \
    X(volumetric_strain_at_peak, "1", "volumetric_strain at the peak, compression positive")       \
    X(lateral_strain_at_peak, "1", "average lateral strain at the peak, compression positive")     \
    X(bulk_modulus, "Pa",                                                                          \
      "slope of the mean pressure over the loss of volume, from 1 % of the largest to "            \
      "elastic_stress; 2D: of area")                                                               \
    X(oedometric_modulus, "Pa",                                                                    \
      "slope of stress over platen strain between fixed sides, from 1 % of the largest to "        \
      "elastic_stress")                                                                            \
    X(lateral_stress_ratio, "1",                                                                   \
      "mean lateral over axial stress of the specimen, slopes over the same range (K_0)")          \
    X(shear_strength, "Pa", "largest shear stress, after which it fell")                           \
    X(normal_stress_at_peak, "Pa",                                                                 \
      "stress across the sheared plane at the peak, compression positive")                         \
    X(shear_modulus, "Pa",                                                                         \
      "slope of shear stress over the displacement of the ends over the length, from 1 % of the "  \
      "largest to elastic_stress")                                                                 \
    X(dilation_at_peak, "m", "displacement across the sheared plane at the peak")                  \
    X(friction_angle, "deg",                                                                       \
      "angle of friction at the largest stress, without cohesion: sin of it is (s1 - s3)/(s1 + "   \
      "s3) with the largest and the smallest principal stress; of a sheared plane, tan of it is "  \
      "the shear over the normal stress")                                                          \
    X(least_stress, "Pa",                                                                          \
      "smallest principal stress at the largest deviator, compression positive")                   \
    X(mean_stress, "Pa", "mean of the principal stresses there, compression positive")             \
    X(tangent_modulus, "Pa",                                                                       \
      "slope of stress over platen strain, 40 to 60 % of the largest stress (ISRM 1979: at half "  \
      "the strength)")                                                                             \
    X(secant_modulus, "Pa",                                                                        \
      "stress over strain of the test from the first row with 1 % of the largest stress to that "  \
      "with 50 % of it (ISRM 1979), including any failure or yield between them")                  \
    X(secant_poisson_ratio, "1",                                                                   \
      "lateral over axial average strain between the rows with 1 % and 50 % of the largest "       \
      "stress")                                                                                    \
    X(average_modulus, "Pa",                                                                       \
      "slope of stress over platen strain, 20 to 80 % of the largest stress, the approximately "   \
      "straight part (ISRM 1979)")                                                                 \
    X(crack_initiation_stress, "Pa",                                                               \
      "stress at which 1 % of the bonds that are broken at the peak have broken (Potyondy & "      \
      "Cundall 2004)")                                                                             \
    X(crack_damage_stress, "Pa",                                                                   \
      "stress at which the specimen ceases to lose volume before the peak (Martin & Chandler "     \
      "1994)")                                                                                     \
    X(brittleness, "1",                                                                            \
      "fraction of the peak that the stress lost by the end of the run (Bishop 1967), at most 1")  \
    X(events, "1",                                                                                 \
      "bursts of breaking bonds: failures close to each other in space and time "                  \
      "(output.burst_reach)")                                                                      \
    X(b_value, "1",                                                                                \
      "slope of log N over log10 of the broken bonds of a burst, N counting bursts of at least "   \
      "that size: maximum likelihood of a discrete power law (Aki 1965, Clauset et al. 2009)")     \
    X(fragments, "1", "fragments of two or more bonded particles at the end")                      \
    X(largest_fragment, "1", "fraction of the particles' volume in the largest fragment")          \
    X(normal_force, "N",                                                                           \
      "mean force on the tool out of the rock, over the path of the means (run_in, length)")       \
    X(rolling_force, "N", "mean force on the tool against its motion, over the same path")         \
    X(side_force, "N",                                                                             \
      "mean sideways force on the tool, along the vector product of normal and motion")            \
    X(normal_force_deviation, "N",                                                                 \
      "standard deviation of the means of normal_force over the blocks of that path")              \
    X(rolling_force_deviation, "N",                                                                \
      "standard deviation of the means of rolling_force over the blocks of that path")             \
    X(side_force_deviation, "N",                                                                   \
      "standard deviation of the means of side_force over the blocks of that path")                \
    X(cutting_coefficient, "1", "rolling_force over normal_force")                                 \
    X(contact_area, "m2",                                                                          \
      "mean over that path of the sum of cross-sections of the particles that press on the tool")  \
    X(peak_normal_force, "N", "largest mean of the normal force over a path of peak_window")       \
    X(peak_rolling_force, "N", "largest mean of the rolling force over a path of peak_window")     \
    X(peak_side_force, "N",                                                                        \
      "mean of the side force over a path of peak_window, the largest in magnitude")               \
    X(specific_energy, "J/m3",                                                                     \
      "rolling_force over depth times spacing (without a spacing times the width of the tool)")    \
    X(removed_volume, "m3",                                                                        \
      "volume of rock removed along that path: particles that intact bonds no longer connect to "  \
      "the held part, over 1 - porosity")                                                          \
    X(removed_beside, "m3",                                                                        \
      "part of removed_volume that began beside the track of the tool: chips between passes")      \
    X(specific_energy_removed, "J/m3",                                                             \
      "work of the rolling force along that path over removed_volume")                             \
    X(damage_depth, "m",                                                                           \
      "depth below the surface of the rock above which 95 % of the broken bonds lie")              \
    X(predicted_coefficient, "1",                                                                  \
      "rolling over normal force of a disc cutter, tan(arc/2) (Rostami 1997)")                     \
    X(predicted_normal_force, "N",                                                                 \
      "normal force of a disc cutter by the model of the Colorado School of Mines (Rostami 1997)") \
    X(predicted_rolling_force, "N", "rolling force of a disc cutter by that model")                \
    X(predicted_peak_evans, "N",                                                                   \
      "peak force along the cut of a chisel (Evans 1962) or a conical pick (Evans 1984)")          \
    X(predicted_peak_goktan, "N", "peak force along the cut of a conical pick (Goktan 1997)")      \
    X(returned_energy, "1",                                                                        \
      "energy of plane waves that travel away from the particles of the first zone, in elements "  \
      "outside of zones at the end, over the initial energy and the energy supplied")

#define X(name, unit, text) GN_READING_##name,
typedef enum gn_reading { GN_READINGS(X) GN_READING_COUNT } gn_reading;
#undef X

enum { GN_REASON_SIZE = 160 };

typedef struct gn_readings {
#define X(name, unit, text) double name;
    GN_READINGS(X)
#undef X
    char reason[GN_READING_COUNT]
               [GN_REASON_SIZE]; /* reason for the absence of a reading (NaN); "": it is present */
    /* Relative increase of the largest stress over that of the row before, at most 1; strains of
     * the rows before and after it. */
    double peak_rise, peak_strain_least, peak_strain_most;
    /* Largest relative difference of the slopes over the first and the second half of the rows from
     * the slope over all of them; 0: not known. */
    double nonlinearity[GN_READING_COUNT];
    double peak_fall;      /* relative fall of the last row from the largest stress */
    double initial_stress; /* Pa, stress at the ends before they moved; 0: they never moved */
    double initial_fall;   /* Pa, part of that stress that vanished before the test began
                              (beginning.h) */
} gn_readings;

const char *gn_reading_name(gn_reading which);

/* True if a reading belongs to tests of a kind, in a scene with zones or without; results and
 * summaries contain only those that do. */
bool gn_reading_belongs(gn_reading which, gn_test_kind kind, bool zones);

/* The test of which readings are computed. */
typedef struct gn_tested {
    gn_test_kind kind;
    int dimension, axis;    /* axis 0 1 2 */
    int sign;               /* -1 compression, +1 tension */
    bool elastic;           /* no part of the specimen can fail */
    bool one_sided;         /* by definition, the force of one end is that of the other */
    bool notched;           /* a beam with a notch */
    bool under_gravity;     /* gravity acts on the specimen */
    bool attracts;          /* its contacts attract each other without bonds */
    bool conversion_halted; /* conversion ended the run */
    double section;         /* m2, area of the section that breaks */
    double fragments, largest_fragment; /* computed elsewhere; NaN: there are no bonds */
    const int32_t *bursts; /* [burst_count] number of bonds that broke in each burst, found
                              elsewhere; NULL: there are no readings */
    size_t burst_count;
    const char *no_bursts; /* reason for the absence of these readings */
    /* Ratio of Young's modulus to the slope of stress over the strain of the test, and over the
     * mean strain, if the section varies; 0 stands for 1; NaN: no modulus follows. */
    double by_ends, by_mean;
    gn_cut cut;             /* properties of the cut, for cutting tests */
    bool zones;             /* particles and elements share a part of the body */
    double returned_energy; /* computed elsewhere at the end; NaN: there is no value */
} gn_tested;

/* Computes the readings from history columns: `strain`, `stress`, `stress_lower`, `stress_upper`
 * (positive in the sense of the test), `strain_xx` .. and `stress_xx` .. (averages, tension
 * positive), `broken_tension`, `broken_shear`, `broken_joints`, and others that tests of the kind
 * have; absent columns are ignored. In 2D the lateral strain is that along the other in-plane axis.
 * A reading that the curves cannot give is NaN and has a reason. */
void gn_readings_compute(const gn_history *history, const gn_tested *tested, gn_readings *readings);

#endif
