/* Strength over confinement, of the triaxial tests of a sweep.
 *
 * Coulomb: s1 = C + K s3 with K = (1 + sin phi)/(1 - sin phi), C = 2 c sqrt(K). Hoek & Brown
 * (1980), intact rock: s1 = s3 + sqrt(m_i s_ci s3 + s_ci^2), so that (s1 - s3)^2 is a line over s3.
 * Both by least squares over all runs. */
#ifndef GN_SWEEP_ENVELOPE_H
#define GN_SWEEP_ENVELOPE_H

#include "sweep/summary.h"

/* X(name, unit, text) */
#define GN_ENVELOPE_READINGS(X)                                                                    \
    X(friction_angle, "degree", "of Coulomb's line through axial strength over confinement")       \
    X(cohesion, "Pa", "of Coulomb's line")                                                         \
    X(hoek_brown_mi, "1", "m_i of Hoek and Brown's curve for intact rock")                         \
    X(hoek_brown_strength, "Pa", "its strength without confinement")

/* How many confinements have to differ: a line through two has nothing to be held against. */
enum { GN_ENVELOPE_LEAST = 3 };

typedef struct gn_envelope {
    bool there; /* axial strengths at confinements that differ */
#define X(name, unit, text) double name;
    GN_ENVELOPE_READINGS(X) /* NaN: absent */
#undef X
    char no_coulomb[160], no_hoek_brown[160]; /* why they are absent; "" */
} gn_envelope;

gn_envelope gn_envelope_of(const gn_summary *m);
/* The same of numbers; those that are not finite are left out. */
gn_envelope gn_envelope_fit(const double *confinement, const double *axial, size_t count,
                            size_t stride);

#endif
