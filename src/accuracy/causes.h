/* What a reading may be off by, cause by cause, from the laws of the study of accuracy. */
#ifndef GN_ACCURACY_CAUSES_H
#define GN_ACCURACY_CAUSES_H

#include "accuracy/slopes.h"

enum { GN_CAUSES_MAX = 10, GN_CAUSE_NOTES_MAX = 6, GN_CAUSE_NOTE_SIZE = 256 };

/* A test in the groups that the study's laws are over. */
typedef struct gn_test_groups {
    const char *study;  /* the case whose laws hold: compression, tension, notched-elements, ... */
    const char *floors; /* the case whose scatter holds: in the plane another one */
    const char *bonds;  /* the law of stiffness whose scatter holds; NULL: that of the study */
    double speed;       /* closing speed over wave speed and strain at the peak */
    double safety;      /* time.safety */
    bool mixed;
    double particles, packings; /* of one packing; how many the reading is the mean of */
    double across;              /* particles across the specimen */
    double cell;                /* elements: the group of the law of the mesh; 0: none of these */
    double tip;                 /* 1 over the cells over half a notch; 0: there is none */
    const char *mesh;           /* elements: the effect of that law */
    double masses;              /* the step over that without added mass; 1: none was added */
    bool first_break;           /* steps begin at the first break */
    double damping;             /* coefficient of the non-viscous damping; negative: another kind */
} gn_test_groups;

/* Relative errors, each as wide as 95 of 100 tests would have it: a bias with two standard errors
 * of its law beside it, two standard deviations of a scatter. */
typedef struct gn_error_cause {
    const char *name;
    double error;
    bool measured; /* in this run; else estimated by the study's law */
    double bias;   /* what of the error has a sense: positive, read too large; 0: none of it */
} gn_error_cause;

typedef struct gn_error_causes {
    size_t count, note_count;
    gn_error_cause cause[GN_CAUSES_MAX];
    char note[GN_CAUSE_NOTES_MAX][GN_CAUSE_NOTE_SIZE]; /* what is not in the sum, and why */
} gn_error_causes;

/* The readings that have laws: "strength", "E", "nu", "strain at the peak", "stiffness". false: the
 * study has none for this reading. */
bool gn_causes_predict(const gn_test_groups *test, const char *reading, gn_error_causes *causes);
void gn_causes_add(gn_error_causes *causes, const char *name, double error, bool measured);
__attribute__((format(printf, 2, 3))) void gn_causes_note(gn_error_causes *causes,
                                                          const char *format, ...);
gn_error_cause *gn_causes_find(gn_error_causes *causes, const char *name);
/* Biases of one sense add up, those of the other may be absent; what has no sense, which has
 * nothing to do with each other, adds up as squares. */
double gn_causes_total(const gn_error_causes *causes);
/* Of all but packing and round-off: what the mean over several packings leaves. */
double gn_causes_without_scatter(const gn_error_causes *causes);

#endif
