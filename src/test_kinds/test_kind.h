/* Laboratory tests that are known by name. A kind is one file of this folder, <kind>.c. Its
 * descriptor states which keys it takes, how its scenes are checked, how the length and the area
 * for strain and stress follow from the specimen, which readings follow from its curves, and what a
 * report shows. All other code uses the descriptor and names no kind. */
#ifndef GN_TEST_KINDS_TEST_KIND_H
#define GN_TEST_KINDS_TEST_KIND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* X(NAME, name, text): GN_TEST_<NAME>, the name in scene files, and the part of the text of
 * test.kind. The descriptor is gn_test_<name>. */
#define GN_TEST_KIND_LIST(X)                                                                       \
    X(COMPRESSION, compression, "")                                                                \
    X(TENSION, tension, "")                                                                        \
    X(BRAZILIAN, brazilian, "; brazilian: a disc across its diameter")                             \
    X(BENDING, bending, ", bending: a beam on two supports")                                       \
    X(TRIAXIAL, triaxial, ", triaxial (in 2D biaxial): under a membrane")                          \
    X(BIAXIAL, biaxial, "")                                                                        \
    X(HYDROSTATIC, hydrostatic, ", hydrostatic: without ends, under pressure from all sides")      \
    X(POLYAXIAL, polyaxial, ", polyaxial: without ends, a stress or motion on every side")         \
    X(OEDOMETER, oedometer, ", oedometer: between fixed sides")                                    \
    X(SHEAR, shear, ", shear: one half along the other")                                           \
    X(SIMPLE_SHEAR, simple_shear, ", simple_shear: between periodic sides")                        \
    X(CUTTING, cutting, ", cutting: a tool along the surface of a rock")

#define X(NAME, name, text) GN_TEST_##NAME,
typedef enum gn_test_kind { GN_TEST_NONE, GN_TEST_KIND_LIST(X) GN_TEST_KINDS } gn_test_kind;
#undef X

/* Lengths and areas that a scene gives as keys of the section `test`, m or m2; 0: not given. */
#define GN_TEST_SIZES(X)                                                                           \
    X(length)                                                                                      \
    X(area)                                                                                        \
    X(diameter)  /* diameter of a cylinder or a disc */                                            \
    X(thickness) /* thickness of a disc or a beam */                                               \
    X(span)      /* distance of the supports of a beam */                                          \
    X(load_span) /* distance between the two loads of a beam; 0: one load at mid-span */           \
    X(height)    /* height of a beam */                                                            \
    X(notch)     /* depth of its notch */                                                          \
    X(depth)     /* depth of a cut; the following keys also belong to cuts */                      \
    X(spacing)                                                                                     \
    X(run_in)                                                                                      \
    X(peak_window)                                                                                 \
    X(compressive_strength) /* Pa, of the rock */                                                  \
    X(tensile_strength)
typedef struct gn_test_sizes {
#define X(name) double name;
    GN_TEST_SIZES(X)
#undef X
} gn_test_sizes;

/* Keys of the section `test` that only some kinds have. */
#define GN_TEST_KEYS(X) GN_TEST_SIZES(X) X(centre) X(normal) X(tool) X(blocks) X(pressure_exponent)
#define X(name)         GN_TEST_KEY_##name,
typedef enum gn_test_key { GN_TEST_KEYS(X) GN_TEST_KEY_COUNT } gn_test_key;
#undef X
#define GN_TAKES(name)  (1u << GN_TEST_KEY_##name)
#define GN_TAKES_LENGTH (GN_TAKES(length) | GN_TAKES(area) | GN_TAKES(diameter))

/* A set of readings, one bit each (curves.h). */
__extension__ typedef unsigned __int128 gn_reading_set;

/* Sizes of the specimen at the start of a test. */
typedef struct gn_tested_specimen {
    int dimension, axis;
    double side[3];    /* m */
    double tool_width; /* m, of a chisel or a wedge; 0: the test has none, or in 2D */
    /* These are known for prisms and for sheared specimens. */
    double length;  /* m: the given length, otherwise that of the strained part */
    double height;  /* m: the given length, otherwise that of the whole specimen; times the section
                       it gives the volume */
    double section; /* m2: if not given, the mean section across the axis or the normal */
} gn_tested_specimen;

/* Sizes to which stress and strain refer. */
typedef struct gn_tested_shape {
    double length;  /* m: ratio of the closing of the ends to the strain of the test */
    double area;    /* m2: ratio of the force to the stress of the test */
    double section; /* m2: section that breaks: across the axis; of a disc along it; of a beam above
                       its notch */
    double volume;  /* m3, given by the scene for a body from a file; 0: not given */
    double diameter;  /* m, of a disc */
    double thickness; /* m, of a disc or a beam */
    double height;    /* m, of a beam */
} gn_tested_shape;

/* A reading that a report shows first, and its name in the test. */
typedef struct gn_test_figure {
    int reading;      /* gn_reading */
    const char *name; /* NULL: end of the list */
} gn_test_figure;

struct gn_curves;
struct gn_readings;

typedef struct gn_test_descriptor {
    const char *name;

    /* The specimen and how it is loaded. */
    bool ends;      /* two ends load the specimen along an axis */
    bool isotropic; /* the specimen is loaded equally from all sides and has no ends: stress is the
                       mean pressure, strain the loss of volume */
    bool enclosed; /* walls or a periodic box enclose the specimen, and there are no ends: stress is
                      that along the axis less the mean of the others, strain the shortening of the
                      enclosure along the axis */
    bool prism;   /* stress is the force of the ends over the section, strain their closing over the
                     length */
    bool disc;    /* the specimen is a disc with faces across z, loaded across its diameter */
    bool beam;    /* the specimen is a beam on two supports */
    bool tool;    /* the test has no ends: a body moves along the surface of the specimen; strain is
                     its path over the length, stress the force against its motion over the area */
    bool sheared; /* the ends move along a plane, whose normal is a key; strain is their
                     displacement over their distance along the normal */
    bool periodic_sides; /* the sides are periodic: the box is open along the normal, and its
                            section is the area */
    bool sides_stand;    /* sides stand beside the specimen along all other directions */
    bool confined;       /* the specimen is under a membrane, and stress is the deviator */
    bool general; /* scenes also use it for other bodies, such as beams clamped at one end or pulled
                     out of a block: the positions of its ends and its sizes are checked less
                     strictly */
    int sign; /* +1: the upper end moves along the axis if strain and stress are positive; -1: in
                 the opposite sense */

    /* The scene. */
    unsigned takes;           /* a set of GN_TAKES */
    unsigned needs;           /* keys that it requires; a subset of these */
    int dimension;            /* 2, 3; 0: either */
    const char *counterpart;  /* name of the same kind of test in the other dimension */
    double peak_drop, strain; /* default conditions that end a run: relative fall of stress from its
                                 peak; strain; 0: no such condition */
    const char *study;        /* tests of this kind in the study of accuracy; NULL: none */

    /* Stress and strain. */
    gn_tested_shape (*shape)(const gn_test_sizes *given, const gn_tested_specimen *specimen);
    const char *area_source; /* how the area is determined unless the scene gives it */

    /* Readings: the set of those that the kind has (curves.h), and the function for those that only
     * some kinds have; NULL: there are none. */
    gn_reading_set readings;
    void (*read)(const struct gn_curves *curves, struct gn_readings *readings);

    /* The report. */
    const char *strain_name, *stress_name; /* NULL: axial strain, axial stress */
    gn_test_figure figures[8];             /* the last one has no name */
} gn_test_descriptor;

/* GN_TEST_NONE has a descriptor without abilities; its readings are absent because the scene has no
 * test. */
extern const gn_test_descriptor *const gn_test_kinds[GN_TEST_KINDS];

static inline const gn_test_descriptor *gn_test_of(gn_test_kind kind) {
    return gn_test_kinds[kind];
}

/* Writes the kinds of a set, one bit each: "brazilian and bending". */
const char *gn_test_names(unsigned kinds, char *text, size_t size);

/* Returns the shape of prisms and of sheared specimens. */
gn_tested_shape gn_test_prism(const gn_test_sizes *given, const gn_tested_specimen *specimen);

#endif
