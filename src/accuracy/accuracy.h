/* Errors of a reading by cause, from the laws of the study of accuracy. */
#ifndef GN_ACCURACY_ACCURACY_H
#define GN_ACCURACY_ACCURACY_H

#include "frame/parts.h"
#include "scene/scene.h"
#include "world/world.h"

#include <stdbool.h>
#include <stddef.h>

enum { GN_CAUSES_MAX = 10, GN_CAUSE_NOTES_MAX = 6, GN_CAUSE_NOTE_SIZE = 256 };

/* A test in the dimensionless groups of the study's laws. */
typedef struct gn_test_groups {
    const char *study;  /* case whose laws hold: compression, tension, notched-elements, ... */
    const char *floors; /* case whose scatter is used; planar tests have another one */
    const char *bonds;  /* law of stiffness whose scatter is used; NULL: that of the study */
    double speed;       /* closing velocity over wave speed and strain at the peak */
    double safety;      /* time.safety */
    bool mixed;
    double particles, packings; /* particles of one packing; number of packings that are averaged */
    double across;              /* particles across the specimen */
    double cell;                /* with elements: group of the mesh law; 0: none */
    double tip;                 /* reciprocal number of cells over half a notch; 0: no notch */
    const char *mesh;           /* with elements: effect of the mesh law */
    double step_ratio; /* ratio of the step to that without added mass; 1: none was added */
    bool first_break;  /* steps begin shortly before the first break */
    double damping; /* coefficient of the non-viscous damping; negative: another kind of damping */
} gn_test_groups;

/* A relative error at 95 % confidence: a bias plus two standard errors of its law, or two standard
 * deviations of a scatter. */
typedef struct gn_error_cause {
    const char *name;
    double error;
    bool measured; /* true: measured in this run; false: estimated by the study's law */
    double bias;   /* signed part of the error; positive: the reading is too large; 0: none */
} gn_error_cause;

typedef struct gn_error_causes {
    size_t count, note_count;
    gn_error_cause cause[GN_CAUSES_MAX];
    char note[GN_CAUSE_NOTES_MAX]
             [GN_CAUSE_NOTE_SIZE]; /* effects that are not in the sum, with the reasons */
} gn_error_causes;

/* Predicts the causes of error of a reading: "strength", "E", "nu", "strain at the peak",
 * "stiffness". Returns false if the study has no law for this reading. */
bool gn_causes_predict(const gn_test_groups *test, const char *reading, gn_error_causes *causes);
void gn_causes_add(gn_error_causes *causes, const char *name, double error, bool measured);
__attribute__((format(printf, 2, 3))) void gn_causes_note(gn_error_causes *causes,
                                                          const char *format, ...);
gn_error_cause *gn_causes_find(gn_error_causes *causes, const char *name);
/* Returns the total. Biases of one sign are added up; those of the opposite sign do not reduce the
 * sum, because they may be absent. Unsigned, independent errors are added as squares. */
double gn_causes_total(const gn_error_causes *causes);
/* Returns the total without packing and round-off: the error that remains in the mean over several
 * packings. */
double gn_causes_without_scatter(const gn_error_causes *causes);

typedef enum gn_slope_form {
    GN_SLOPE_POWER,       /* coefficient (group/reference)^exponent */
    GN_SLOPE_LINEAR,      /* coefficient (group - reference) */
    GN_SLOPE_EXPONENTIAL, /* coefficient exp(-group/reference) */
    GN_SLOPE_RATIO,       /* (group/reference)^exponent - 1 */
    GN_SLOPE_CONSTANT     /* coefficient */
} gn_slope_form;

/* A law of relative errors. A bias has a sign (positive: the reading is too large); a scatter is a
 * standard deviation. Missing numbers are NaN. */
typedef struct gn_slope {
    const char *study; /* case of the study: compression, tension, ... */
    const char *reading, *effect, *group;
    bool scatter;
    gn_slope_form form;
    double coefficient, coefficient_error, exponent, exponent_error, reference;
    double low, high; /* measured range of the group */
} gn_slope;
extern const gn_slope gn_slopes[];
extern const size_t gn_slope_count;

/* A ratio from the tests of the study that converts an estimated quantity to a predicted one. */
typedef struct gn_slope_base {
    const char *study, *quantity;
    double value;
} gn_slope_base;
extern const gn_slope_base gn_slope_bases[];
extern const size_t gn_slope_base_count;

/* Finds a law; NULL: the study has no such law. */
const gn_slope *gn_slope_find(const char *study, const char *reading, const char *effect,
                              bool scatter);

/* Return the error at a group, and its standard error. */
double gn_slope_at(const gn_slope *slope, double group);
double gn_slope_error_at(const gn_slope *slope, double group);

/* Returns a ratio; NaN: the study has no such ratio. */
double gn_slope_base_of(const char *study, const char *quantity);

/* Sets the groups that follow from the scene and its specimen; `speed` becomes NaN. Returns the
 * reason why the study does not cover the scene; NULL: it does. */
const char *gn_study_find_case(const gn_step_context *ctx, const gn_dem *dem,
                               gn_test_groups *groups);

/* Return the closing motion of the two ends of the test along its axis, in the sense of the test:
 * the velocity at a time, m/s, the largest velocity up to time.end, and the path up to a time, m.
 */
double gn_test_closing(const gn_scene *scene, double time);
double gn_test_fastest(const gn_scene *scene);
double gn_test_path(const gn_scene *scene, double time);

/* Returns the bulk density of the specimen, kg/m3. */
double gn_test_bulk_density(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids);

#endif
