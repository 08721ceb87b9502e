/* Keys of the sections `test`, laboratory tests by name, and `membrane`. */
#include "scene/manifest_keys.h"

static const gn_choice axes[] = {{"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};
static const gn_choice axes_or_none[] = {{"none", -1}, {"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};
#define X(NAME, name, text) {#name, GN_TEST_##NAME},
static const gn_choice test_kinds[] = {GN_TEST_KIND_LIST(X){NULL, 0}};
#undef X
#define KIND_TEXT(NAME, name, text) text
#define KINDS_TEXT                  GN_TEST_KIND_LIST(KIND_TEXT)

static const gn_key opening_keys[] = {
    KEY("axis", CHOICE, gn_opening, axis, .choices = axes, .required = true,
        .text = "axis along which the opening is read"),
    ARRAY("lower", NAMES, gn_opening, lower.name, lower.count, .required = true,
          .text = "wall, body, set or motion of elements on the lower side"),
    ARRAY("upper", NAMES, gn_opening, upper.name, upper.count, .required = true,
          .text = "wall, body, set or motion of elements on the upper side"),
};
TABLE_OF(opening);

static const gn_key control_keys[] = {
    KEY("opening", REAL, gn_scene, test.control.opening, .unit = "m/s", .range = "(0, 1e9]",
        .word = "none", .fallback = "none",
        .text = "target rate of the opening of the gauge; this or lateral_strain"),
    KEY("lateral_strain", REAL, gn_scene, test.control.lateral_strain, .unit = "1/s",
        .range = "(0, 1e9]", .word = "none", .fallback = "none",
        .text = "target rate of the average strain across the axis, extension positive; this or "
                "opening"),
    KEY("response", REAL, gn_scene, test.control.response, .unit = "s", .range = "(0, 1e9]",
        .required = true,
        .text =
            "response time of the control: several transit times of waves through the specimen"),
    KEY("reverse", REAL, gn_scene, test.control.reverse, .unit = "1", .range = "[0, 10]",
        .fallback = "1",
        .text = "largest reverse velocity of the ends over their prescribed one; 0: they stop"),
};
TABLE_OF(control);

static const gn_key test_keys[] = {
    KEY("kind", CHOICE, gn_scene, test.kind, .choices = test_kinds, .required = true,
        .text = "which test it is: how stress and strain are formed and what is read" KINDS_TEXT),
    KEY("axis", CHOICE, gn_scene, test.axis, .choices = axes_or_none, .fallback = "none",
        .text = "direction of loading; needed by all but hydrostatic"),
    ARRAY("lower", NAMES, gn_scene, test.lower.name, test.lower.count,
          PRESENT(COUNT, gn_scene, test.lower.count), PLACED(gn_scene, test.lower.where),
          .text = "wall, body, set or motion of elements at the lower end; forces of several add "
                  "up; needed by all but hydrostatic"),
    ARRAY("upper", NAMES, gn_scene, test.upper.name, test.upper.count,
          PRESENT(COUNT, gn_scene, test.upper.count), PLACED(gn_scene, test.upper.where),
          .text = "wall, body, set or motion of elements at the upper end; forces of several add "
                  "up; needed by all but hydrostatic"),
    KEY("normal", CHOICE, gn_scene, test.normal, .choices = axes_or_none, .fallback = "none",
        .text = "shear and simple_shear: axis normal to the sheared plane"),
    KEY("length", REAL, gn_scene, test.given.length, .unit = "m", .range = GN_LENGTHS,
        .word = "auto", .fallback = "auto",
        .text = "length of the specimen; auto: its extent along the axis, in shear the free "
                "distance between the ends along the normal"),
    KEY("area", REAL, gn_scene, test.given.area, .unit = "m2", .range = GN_AREAS, .word = "auto",
        .fallback = "auto",
        .text = "area of its section; auto: from the diameter, else the specimen's volume over the "
                "length (in shear its height)"),
    KEY("diameter", REAL, gn_scene, test.given.diameter, .unit = "m", .range = GN_LENGTHS,
        .word = "none", .fallback = "none",
        .text = "diameter of a cylinder; brazilian: of the disc, none: its extent along the axis"),
    KEY("thickness", REAL, gn_scene, test.given.thickness, .unit = "m", .range = GN_LENGTHS,
        .word = "auto", .fallback = "auto",
        .text = "thickness of the disc of a brazilian test, or of the beam of a bending test; "
                "auto: its extent, in 2D 1 m"),
    KEY("span", REAL, gn_scene, test.given.span, .unit = "m", .range = GN_LENGTHS, .word = "none",
        .fallback = "none", .text = "bending: distance of the supports"),
    KEY("load_span", REAL, gn_scene, test.given.load_span, .unit = "m", .range = GN_LENGTHS,
        .word = "none", .fallback = "none",
        .text = "bending: distance of two loads (four points); none: one load at mid-span"),
    KEY("height", REAL, gn_scene, test.given.height, .unit = "m", .range = GN_LENGTHS,
        .word = "auto", .fallback = "auto",
        .text = "bending: height of the beam; auto: its extent along the axis"),
    KEY("notch", REAL, gn_scene, test.given.notch, .unit = "m", .range = GN_LENGTHS, .word = "none",
        .fallback = "none", .text = "bending: depth of the notch at mid-span"),
    KEY("centre", REAL, gn_scene, test.centre, .unit = "1", .range = "(0, 1]", .fallback = "0.2",
        .text = "brazilian: radius, over that of the disc, of the region around its centre whose "
                "mean stress is read"),
    SECTION("control", control_section, PRESENT(BOOL, gn_scene, test.has_control),
            .text = "scales the prescribed motion of the ends along the axis, also to reverse it, "
                    "so that a reading grows at a given rate, past a peak with snap-back"),
    KEY("confinement", TREE, gn_scene, test.confinement, .unit = "list of pressures",
        PRESENT(BOOL, gn_scene, test.has_confinement),
        .text = "triaxial and biaxial, at least three different pressures: gneiss run makes a run "
                "with each as membrane.pressure, side by side, and fits friction angle, cohesion "
                "and Hoek-Brown's m_i"),
    SECTION("opening", opening_section, .offset = offsetof(gn_scene, test.opening),
            PRESENT(BOOL, gn_scene, test.has_opening),
            .text = "a gauge of the opening between two parts, such as the mouth of a notch"),
};
const gn_section gn_test_section = {test_keys, sizeof test_keys / sizeof(gn_key), 0,
                                    offsetof(gn_scene, test.where)};

/* ---- membrane ---- */

static const gn_choice booleans[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                                     {"yes", 1},  {"no", 0},    {NULL, 0}};
static const gn_choice faces[] = {{"all", GN_FACES_ALL}, {"sides", GN_FACES_SIDES}, {NULL, 0}};
static const gn_choice surfaces[] = {
    {"shape", GN_SURFACE_SHAPE}, {"particles", GN_SURFACE_PARTICLES}, {NULL, 0}};
static const gn_choice axes_or_test[] = {{"test", -1}, {"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};

static const gn_key membrane_keys[] = {
    KEY("pressure", TABLE, gn_scene, membrane.pressure, .unit = "Pa", .range = GN_PRESSURES,
        .required = true, .text = "pressure along the inward normal; constant or a table in time"),
    KEY("ramp", REAL, gn_scene, membrane.ramp, .unit = "s", .range = "[0, inf)", .fallback = "0",
        .text = "time over which the pressure rises linearly from 0; in a stage that changes the "
                "membrane, from the present pressure since the start of the stage"),
    KEY("surface", CHOICE, gn_scene, membrane.surface, .choices = surfaces, .fallback = "shape",
        .text = "of a specimen with a shape: its whole surface; or the particles that bear the "
                "pressure, inside it, as for specimens without a shape"),
    KEY("faces", CHOICE, gn_scene, membrane.faces, .choices = faces, .fallback = "all",
        .text = "all of the surface, as in a pressure cell; or only the sides, which face across "
                "the axis"),
    KEY("axis", CHOICE, gn_scene, membrane.axis, .choices = axes_or_test, .fallback = "test",
        .text = "axis that the sides face across; test: the axis of the test"),
    KEY("follow", CHOICE, gn_scene, membrane.follow, .choices = booleans, .fallback = "true",
        .text = "areas and normals rotate and stretch with the particles around them, so that the "
                "pressure is maintained; false: they stay as at the start, and an unsupported "
                "specimen turns over"),
};
const gn_section gn_membrane_section = {membrane_keys, sizeof membrane_keys / sizeof(gn_key), 0,
                                        offsetof(gn_scene, membrane.where)};
