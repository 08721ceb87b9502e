/* Macros for the tables of keys, private to the files that hold them. */
#ifndef GN_SCENE_MANIFEST_KEYS_H
#define GN_SCENE_MANIFEST_KEYS_H

#include "scene/manifest.h"

/* Ranges of quantities in SI units. They are wide enough for every meaningful scene, detect errors
 * such as a missing unit or a too large exponent at the place of the key, and keep products far
 * from overflow. Limits (strengths, the velocity of a servo) may be so large that they have no
 * effect. */
#define GN_AREAS         "[1e-18, 1e18]"  /* m2 */
#define GN_SCALES        "[1e-12, 1e12]"  /* 1 */
#define GN_DENSITIES     "[1e-9, 1e15]"   /* kg/m3 */
#define GN_MASSES        "[1e-21, 1e21]"  /* kg */
#define GN_INERTIAS      "[1e-36, 1e36]"  /* kg m2 */
#define GN_SPRINGS       "[1e-15, 1e21]"  /* N/m */
#define GN_MODULI        "[1e-9, 1e18]"   /* Pa */
#define GN_STRENGTHS     "[1e-12, 1e100]" /* Pa */
#define GN_BREAKING      "[1e-30, 1e100]" /* N */
#define GN_TOUGHNESSES   "[1e-30, 1e100]" /* J/m2 */
#define GN_RATIOS        "[1e-6, 1e12]"   /* k_n/k_t */
#define GN_FRICTIONS     "[0, 1e30]"
#define GN_SPEEDS        "[-3e8, 3e8]"   /* m/s: up to the speed of light */
#define GN_SPINS         "[-1e12, 1e12]" /* rad/s */
#define GN_TURNS         "[-1e6, 1e6]"   /* rad */
#define GN_ACCELERATIONS "[-1e12, 1e12]" /* m/s2 */
#define GN_FORCES        "[-1e18, 1e18]" /* N */
#define GN_TRACTIONS     "[-1e18, 1e18]" /* Pa */
#define GN_PRESSURES     "[0, 1e18]"     /* Pa */

/* Words that several tables use. */
extern const gn_choice gn_booleans[], gn_switches[], gn_axes[], gn_axes_or_none[],
    gn_held_stresses[];

/* A key TYPE called NAME for the member FIELD of STRUCT. */
#define KEY(NAME, TYPE, STRUCT, FIELD, ...)                                                        \
    {                                                                                              \
        .name = NAME, .type = GN_KEY_##TYPE, .offset = offsetof(STRUCT, FIELD),                    \
        .size = sizeof(((STRUCT *)0)->FIELD), __VA_ARGS__                                          \
    }

/* Keys by type. DEFAULT is REQUIRED, BY("0.1") or OR("none", value): a word instead of a number,
 * which means `value` and is the default; or PRESENT. The text may be followed by further members.
 * */
#define REQUIRED        .required = true
#define BY(TEXT)        .fallback = TEXT
#define OR(WORD, VALUE) .word = WORD, .word_value = VALUE, .fallback = WORD
#define REAL(NAME, STRUCT, FIELD, UNIT, RANGE, DEFAULT, ...)                                       \
    KEY(NAME, REAL, STRUCT, FIELD, .unit = UNIT, .range = RANGE, DEFAULT, .text = __VA_ARGS__)
#define VECTOR(NAME, STRUCT, FIELD, UNIT, RANGE, DEFAULT, ...)                                     \
    KEY(NAME, VECTOR, STRUCT, FIELD, .unit = UNIT, .range = RANGE, DEFAULT, .text = __VA_ARGS__)
/* A vector whose components may be tables or formulas, which go to FIELD_over_time. */
#define VARYING(NAME, STRUCT, FIELD, UNIT, RANGE, DEFAULT, ...)                                    \
    KEY(NAME, VECTOR, STRUCT, FIELD, .second = offsetof(STRUCT, FIELD##_over_time), .unit = UNIT,  \
        .range = RANGE, DEFAULT, .text = __VA_ARGS__)
#define SPIN(NAME, STRUCT, FIELD, UNIT, RANGE, DEFAULT, ...)                                       \
    KEY(NAME, SPIN, STRUCT, FIELD, .unit = UNIT, .range = RANGE, DEFAULT, .text = __VA_ARGS__)
#define TABLE(NAME, STRUCT, FIELD, UNIT, RANGE, DEFAULT, ...)                                      \
    KEY(NAME, TABLE, STRUCT, FIELD, .unit = UNIT, .range = RANGE, DEFAULT, .text = __VA_ARGS__)
#define INTEGER(NAME, STRUCT, FIELD, RANGE, DEFAULT, ...)                                          \
    KEY(NAME, INTEGER, STRUCT, FIELD, .range = RANGE, DEFAULT, .text = __VA_ARGS__)
#define CELLS(NAME, STRUCT, FIELD, RANGE, DEFAULT, ...)                                            \
    KEY(NAME, CELLS, STRUCT, FIELD, .range = RANGE, DEFAULT, .text = __VA_ARGS__)
#define CHOICE(NAME, STRUCT, FIELD, CHOICES, DEFAULT, ...)                                         \
    KEY(NAME, CHOICE, STRUCT, FIELD, .choices = CHOICES, DEFAULT, .text = __VA_ARGS__)
#define NAME(KEY_NAME, STRUCT, FIELD, DEFAULT, ...)                                                \
    KEY(KEY_NAME, NAME, STRUCT, FIELD, DEFAULT, .text = __VA_ARGS__)
#define TEXT(KEY_NAME, STRUCT, FIELD, DEFAULT, ...)                                                \
    KEY(KEY_NAME, TEXT, STRUCT, FIELD, DEFAULT, .text = __VA_ARGS__)
/* An array to whose first element FIELD points, and whose count is COUNT. */
#define ARRAY(NAME, TYPE, STRUCT, FIELD, COUNT, ...)                                               \
    KEY(NAME, TYPE, STRUCT, FIELD, .second = offsetof(STRUCT, COUNT), __VA_ARGS__)
/* Keys one level below, whose members are in the same struct. */
#define SECTION(NAME, TABLE, ...)                                                                  \
    { .name = NAME, .type = GN_KEY_SECTION, .section = &TABLE, __VA_ARGS__ }
#define PRESENT(KIND, STRUCT, FIELD)                                                               \
    .presence = GN_PRESENT_##KIND, .present_at = offsetof(STRUCT, FIELD)
#define PLACED(STRUCT, FIELD) .place_at = offsetof(STRUCT, FIELD)
/* One of the shapes that can be packed. */
#define SHAPE(KIND, DIMENSION)                                                                     \
    .shape = GN_SHAPE_##KIND, .shape_dimension = (DIMENSION),                                      \
    PRESENT(SHAPE, gn_scene, specimen.pack.shape)
/* A component of a motion or a load: a number, a table of times, or a word for none, which is the
 * default. */
#define CHANNEL(STRUCT, NAME, FIELD, UNIT, RANGE, WORD, TEXT)                                      \
    KEY(NAME, TABLE, STRUCT, FIELD, .unit = UNIT, .range = RANGE, .word = WORD, .fallback = WORD,  \
        .text = TEXT)
/* The coefficients of friction of walls and bodies, which particles touch. */
#define SIDE_FRICTIONS(STRUCT)                                                                     \
    REAL("friction", STRUCT, friction, GN_SLOPE, GN_FRICTIONS, BY("0"),                            \
         "Coulomb friction coefficient"),                                                          \
        REAL("rolling_friction", STRUCT, rolling_friction, "1", GN_FRICTIONS, BY("0"),             \
             "mu_r, as for materials"),                                                            \
        REAL("twisting_friction", STRUCT, twisting_friction, "1", GN_FRICTIONS, BY("0"),           \
             "mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced "        \
             "radius; 0: no resistance")
/* The data of a section: its keys, the size of an element of a list, and the member that stores its
 * place in the file. */
#define KEYS_OF(NAME)  NAME##_keys, sizeof NAME##_keys / sizeof(gn_key)
#define TABLE_OF(NAME) static const gn_section NAME##_section = {KEYS_OF(NAME), 0, GN_NO_WHERE}
#define ELEMENTS_OF(NAME, STRUCT)                                                                  \
    static const gn_section NAME##_section = {KEYS_OF(NAME), sizeof(STRUCT),                       \
                                              offsetof(STRUCT, where)}

/* Sections of the scene that other files define; members of sections that are not lists are in
 * gn_scene. */
extern const gn_section gn_clumps_section, gn_couple_section, gn_elements_section, gn_joint_section,
    gn_membrane_section, gn_output_section, gn_sink_section, gn_source_section, gn_test_section,
    gn_time_section;

#endif
