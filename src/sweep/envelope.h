/* Strength over confinement, from the triaxial tests of a sweep. Coulomb: s1 = C + K s3 with K = (1
 * + sin phi)/(1 - sin phi), C = 2 c sqrt(K). Hoek & Brown (1980), intact rock: s1 = s3 + sqrt(m_i
 * s_ci s3 + s_ci^2), so that (s1 - s3)^2 is a line over s3. Both are fitted by least squares over
 * the runs that differ in confinement and seed alone. */
#ifndef GN_SWEEP_ENVELOPE_H
#define GN_SWEEP_ENVELOPE_H

#include "sweep/summary.h"

/* X(name, unit, text) */
#define GN_ENVELOPE_READINGS(X)                                                                    \
    X(friction_angle, "degree", "of Coulomb's line through axial strength over confinement")       \
    X(cohesion, "Pa", "of Coulomb's line")                                                         \
    X(hoek_brown_mi, "1", "m_i of Hoek and Brown's curve for intact rock")                         \
    X(hoek_brown_strength, "Pa", "its strength without confinement")

/* Least number of different confinements, because a line through two points always fits. */
enum { GN_ENVELOPE_LEAST = 3 };

typedef struct gn_envelope {
    bool there; /* there are axial strengths at different confinements */
#define X(name, unit, text) double name;
    GN_ENVELOPE_READINGS(X) /* NaN: absent */
#undef X
    char no_coulomb[160], no_hoek_brown[160]; /* reasons for the absence of values; "": present */
} gn_envelope;

/* Envelopes of a sweep, one for each combination of the other parameters. */
typedef struct gn_envelopes {
    bool confined;   /* some runs have axial strengths at different confinements */
    size_t count;    /* number of envelopes */
    gn_envelope *of; /* [count] */
    size_t *first;   /* [count] a run of each */
    int64_t *of_run; /* [run_count] envelope of a run; -1: none */
    bool *grouping;  /* [parameter_count] true: envelopes differ in the parameter */
} gn_envelopes;

gneiss_status gn_envelopes_make(const gn_summary *summary, gn_envelopes *envelopes,
                                gneiss_error *error);
void gn_envelopes_free(gn_envelopes *envelopes);
/* Returns the parameters in which an envelope differs from others, such as "friction = 0.3"; "". */
const char *gn_envelope_label(const gn_summary *summary, const gn_envelopes *envelopes,
                              size_t which, char *text, size_t size);

/* Fits an envelope to numbers; those that are not finite are ignored. */
gn_envelope gn_envelope_fit(const double *confinement, const double *axial, size_t count,
                            size_t stride);

#endif
