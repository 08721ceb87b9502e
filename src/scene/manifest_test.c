/* Keys of the sections `test`, `membrane`, `time`, `stages` and `output`. */
#include "scene/manifest_keys.h"
#include "scene/stages.h"
#include "scene/units.h"

const gn_choice gn_axes_or_none[] = {{"none", -1}, {"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};
#define X(NAME, name, text) {#name, GN_TEST_##NAME},
static const gn_choice test_kinds[] = {GN_TEST_KIND_LIST(X){NULL, 0}};
#undef X
#define KIND_TEXT(NAME, name, text) text
#define KINDS_TEXT                  GN_TEST_KIND_LIST(KIND_TEXT)

static const gn_key opening_keys[] = {
    CHOICE("axis", gn_opening, axis, gn_axes, REQUIRED, "axis along which the opening is read"),
    ARRAY("lower", NAMES, gn_opening, lower.name, lower.count, .required = true,
          .text = "wall, body, set or motion of elements on the lower side"),
    ARRAY("upper", NAMES, gn_opening, upper.name, upper.count, .required = true,
          .text = "wall, body, set or motion of elements on the upper side"),
};
TABLE_OF(opening);

static const gn_key control_keys[] = {
    REAL("opening", gn_scene, test.control.opening, "m/s", "(0, 1e9]", OR("none", 0),
         "target rate of the opening of the gauge; this or lateral_strain"),
    REAL("lateral_strain", gn_scene, test.control.lateral_strain, "1/s", "(0, 1e9]", OR("none", 0),
         "target rate of the average strain across the axis, extension positive; this or opening"),
    REAL("response", gn_scene, test.control.response, "s", "(0, 1e9]", REQUIRED,
         "response time of the control: several transit times of waves through the specimen"),
    REAL("reverse", gn_scene, test.control.reverse, "1", "[0, 10]", BY("1"),
         "largest reverse velocity of the ends over their prescribed one; 0: they stop"),
};
TABLE_OF(control);

static const gn_key test_keys[] = {
    CHOICE("kind", gn_scene, test.kind, test_kinds, REQUIRED,
           "kind of test, which decides the definitions of stress and strain and the "
           "readings" KINDS_TEXT),
    CHOICE("axis", gn_scene, test.axis, gn_axes_or_none, BY("none"),
           "direction of loading, or of the motion of the tool (cutting); needed by all but "
           "hydrostatic"),
    ARRAY("lower", NAMES, gn_scene, test.lower.name, test.lower.count,
          PRESENT(COUNT, gn_scene, test.lower.count), PLACED(gn_scene, test.lower.where),
          .text = "wall, body, set or motion of elements at the lower end; forces of several add "
                  "up; needed by all but hydrostatic, polyaxial and cutting"),
    ARRAY("upper", NAMES, gn_scene, test.upper.name, test.upper.count,
          PRESENT(COUNT, gn_scene, test.upper.count), PLACED(gn_scene, test.upper.where),
          .text = "wall, body, set or motion of elements at the upper end; forces of several add "
                  "up; needed by all but hydrostatic, polyaxial and cutting"),
    CHOICE("normal", gn_scene, test.normal, gn_axes_or_none, BY("none"),
           "shear and simple_shear: axis normal to the sheared plane; cutting: to the surface of "
           "the rock"),
    TEXT("tool", gn_scene, test.tool, BY(""), "cutting: the body that cuts"),
    REAL("depth", gn_scene, test.given.depth, "m", GN_LENGTHS, OR("none", 0),
         "cutting: depth of the cut, to which energies and predictions refer"),
    REAL("spacing", gn_scene, test.given.spacing, "m", GN_LENGTHS, OR("none", 0),
         "cutting: distance between neighbouring cuts"),
    REAL("run_in", gn_scene, test.given.run_in, "m", "[0, 1e9]", OR("none", 0),
         "cutting: path of the tool before means are taken; length is the path of the means"),
    INTEGER("blocks", gn_scene, test.blocks, "[1, 10000]", BY("5"),
            "cutting: number of parts of the path of the means, whose scatter is a reading"),
    REAL("peak_window", gn_scene, test.given.peak_window, "m", GN_LENGTHS, OR("auto", 0),
         "cutting: path over which a peak force is averaged; auto: a quarter of the depth"),
    REAL("compressive_strength", gn_scene, test.given.compressive_strength, "Pa", GN_STRENGTHS,
         OR("none", 0), "cutting: uniaxial strength of the rock, used for predicted forces only"),
    REAL("tensile_strength", gn_scene, test.given.tensile_strength, "Pa", GN_STRENGTHS,
         OR("none", 0), "cutting: Brazilian strength of the rock, used for predicted forces only"),
    REAL(
        "pressure_exponent", gn_scene, test.pressure_exponent, "1", "[-0.2, 0.2]", BY("0"),
        "cutting: exponent psi of the pressure along the rim in the predicted forces, 0.2 of sharp "
        "to -0.2 of wide tips"),
    REAL("length", gn_scene, test.given.length, "m", GN_LENGTHS, OR("auto", 0),
         "length of the specimen; auto: its extent along the axis, in shear the free distance "
         "between the ends along the normal; cutting: path of the means, auto: until the tool "
         "leaves the rock, or comes near held particles"),
    REAL("area", gn_scene, test.given.area, "m2", GN_AREAS, OR("auto", 0),
         "area of the section of the specimen; auto: from the diameter, else the specimen's volume "
         "over the length "
         "(in shear its height)"),
    REAL("diameter", gn_scene, test.given.diameter, "m", GN_LENGTHS, OR("none", 0),
         "diameter of a cylinder; brazilian: of the disc, none: its extent along the axis"),
    REAL("thickness", gn_scene, test.given.thickness, "m", GN_LENGTHS, OR("auto", 0),
         "thickness of the disc of a brazilian test, or of the beam of a bending test; auto: its "
         "extent, in 2D 1 m"),
    REAL("span", gn_scene, test.given.span, "m", GN_LENGTHS, OR("none", 0),
         "bending: distance of the supports"),
    REAL("load_span", gn_scene, test.given.load_span, "m", GN_LENGTHS, OR("none", 0),
         "bending: distance of two loads (four points); none: one load at mid-span"),
    REAL("height", gn_scene, test.given.height, "m", GN_LENGTHS, OR("auto", 0),
         "bending: height of the beam; auto: its extent along the axis"),
    REAL("notch", gn_scene, test.given.notch, "m", GN_LENGTHS, OR("none", 0),
         "bending: depth of the notch at mid-span"),
    REAL("centre", gn_scene, test.centre, "1", "(0, 1]", BY("0.2"),
         "brazilian: radius, over that of the disc, of the region around its centre whose mean "
         "stress is read"),
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
const gn_section gn_test_section = {KEYS_OF(test), 0, offsetof(gn_scene, test.where)};

/* ---- membrane ---- */

static const gn_choice faces[] = {{"all", GN_FACES_ALL}, {"sides", GN_FACES_SIDES}, {NULL, 0}};
static const gn_choice surfaces[] = {
    {"shape", GN_SURFACE_SHAPE}, {"particles", GN_SURFACE_PARTICLES}, {NULL, 0}};
static const gn_choice axes_or_test[] = {{"test", -1}, {"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};

static const gn_key membrane_keys[] = {
    TABLE("pressure", gn_scene, membrane.pressure, "Pa", GN_PRESSURES, REQUIRED,
          "pressure along the inward normal; constant or a table in time"),
    REAL("ramp", gn_scene, membrane.ramp, "s", "[0, inf)", BY("0"),
         "time over which the pressure rises linearly from 0; in a stage that changes the "
         "membrane, from the present pressure since the start of the stage"),
    CHOICE("surface", gn_scene, membrane.surface, surfaces, BY("shape"),
           "surface that is loaded. shape: that of the specimen's shape; particles: that of the "
           "particles, which lies inside it, as for specimens without a shape"),
    CHOICE(
        "faces", gn_scene, membrane.faces, faces, BY("all"),
        "all of the surface, as in a pressure cell; or only the sides, which face across the axis"),
    CHOICE("axis", gn_scene, membrane.axis, axes_or_test, BY("test"),
           "axis that the sides face across; test: the axis of the test"),
    CHOICE(
        "follow", gn_scene, membrane.follow, gn_booleans, BY("true"),
        "areas and normals rotate and stretch with the particles around them, so that the pressure "
        "is maintained; false: they stay as at the start, and an unsupported specimen turns over"),
};
const gn_section gn_membrane_section = {KEYS_OF(membrane), 0, offsetof(gn_scene, membrane.where)};

/* ---- keys of `time` ---- */

static const gn_choice estimates[] = {
    {"sharp", GN_STEP_SHARP}, {"bound", GN_STEP_BOUND}, {NULL, 0}};
static const gn_choice starts[] = {
    {"rest", GN_START_REST}, {"first_break", GN_START_FIRST_BREAK}, {NULL, 0}};
static const gn_choice scaled_gravities[] = {
    {"refuse", GN_GRAVITY_REFUSED}, {"own_mass", GN_GRAVITY_OWN}, {NULL, 0}};
static const gn_choice policies[] = {{"stop", GN_POLICY_STOP}, {"warn", GN_POLICY_WARN}, {NULL, 0}};

static const gn_key stop_keys[] = {
    REAL("peak_drop", gn_scene, stop_peak_drop, "1", "(0, 1)", BY("auto"),
         "stop once stress has fallen by this fraction of its peak; auto: the default of the kind "
         "of test, together with other conditions; this default also holds if no condition of stop "
         "is given",
         .other_word = "auto", .other_value = -1, .word = "off"),
    REAL("strain", gn_scene, stop_strain, GN_STRAIN, "(0, inf)", OR("off", 0),
         "stop at this strain"),
    REAL("unbalanced", gn_scene, stop_unbalanced, "1", "(0, inf)", OR("off", 0),
         "stop once the unbalanced force ratio is below this, after 20 rows, while some contacts "
         "carry load and no particle falls freely"),
};
TABLE_OF(stop);

static const gn_key mass_scaling_keys[] = {
    REAL("step", gn_scene, scaled_step, "s", "(0, inf)", OR("none", 0),
         "target time step, safety included"),
    REAL("factor", gn_scene, scaled_factor, "1", "[1, 1000]", OR("none", 0),
         "target time step over the step without added mass; step or factor"),
    CHOICE("gravity", gn_scene, scaled_gravity, scaled_gravities, BY("refuse"),
           "own_mass: particles keep their weight, and so fall more slowly; needed in a scene with "
           "gravity"),
};
static const gn_section mass_scaling_section = {KEYS_OF(mass_scaling), 0,
                                                offsetof(gn_scene, scaling_where)};

static const gn_key time_keys[] = {
    REAL("step", gn_scene, step, "s", "(0, inf)", OR("auto", 0),
         "time step; auto: safety times the stability limit"),
    REAL("safety", gn_scene, safety, "1", "(0, 1]", BY("0.9"),
         "automatic step as a fraction of the stability limit 2/w_max"),
    REAL("contact_steps", gn_scene, contact_steps, GN_PLAIN_NUMBER, "(0, inf)", OR("auto", 0),
         "least number of steps in the shortest collision of unbonded particles, for an automatic "
         "step; auto: 10, with hertz 12, which keeps restitution within 1 %"),
    CHOICE("estimate", gn_scene, estimate, estimates, BY("sharp"),
           "estimate of the stability limit: sharp by iteration, or a rigorous bound per particle"),
    SECTION("mass_scaling", mass_scaling_section, PRESENT(BOOL, gn_scene, has_mass_scaling),
            .text = "for quasi-static runs: mass and moment of inertia are raised for particles "
                    "that would need a smaller step; none are lowered"),
    CHOICE("on_unstable", gn_scene, on_unstable, policies, BY("stop"),
           "reaction to a step above the stability limit"),
    REAL("end", gn_scene, end, "s", "(0, inf)", REQUIRED, "time at which the run ends"),
    CHOICE("start", gn_scene, start, starts, BY("rest"),
           "initial state: at rest; or first_break, the equilibrium shortly before the first bond "
           "breaks, found by statics",
           PLACED(gn_scene, start_where)),
    REAL("start_fraction", gn_scene, start_fraction, "1", "(0, 1)", BY("0.9"),
         "with first_break: initial time as a fraction of the time of the first break"),
    SECTION("stop", stop_section, .word = "none",
            .text = "conditions that end the run earlier; none: the run lasts to its end"),
};
const gn_section gn_time_section = {KEYS_OF(time), 0, offsetof(gn_scene, time_where)};

/* ---- keys of `stages` ---- */

#define NONE(TEXT) .word = "none", .fallback = "none", .text = TEXT

static const gn_key end_keys[] = {
    KEY("time", REAL, gn_stage, time, .unit = "s", .range = "[0, inf)", .word_value = -1,
        NONE("the stage ends after this time since its start")),
    KEY("steps", INTEGER, gn_stage, steps, .range = "[0, 1e15]", .word_value = -1,
        NONE("the stage ends after this number of steps; 0: its changes take effect, and the next "
             "stage begins")),
    KEY("strain", REAL, gn_stage, strain, .unit = GN_STRAIN, .range = "(0, inf)",
        NONE("the stage ends once the strain of the test has grown by this since its start")),
    KEY("stress", REAL, gn_stage, stress, .unit = "Pa", .range = GN_STRENGTHS,
        NONE("the stage ends once the stress of the test is at least this")),
    KEY("peak_drop", REAL, gn_stage, peak_drop, .unit = "1", .range = "(0, 1)",
        NONE("the stage ends once stress has fallen by this fraction of its peak in the stage")),
    KEY("unbalanced", REAL, gn_stage, unbalanced, .unit = "1", .range = "(0, inf)",
        NONE("the stage ends once the unbalanced force ratio is below this, after 20 rows, while "
             "some contacts carry load and no particle falls freely")),
    KEY("held", REAL, gn_stage, held, .unit = "1", .range = "(0, 1)",
        NONE("the stage ends once every servo, of walls and of a periodic box, has been within "
             "this fraction of its force or stress for ten rows of the history; without servos, "
             "the mean stress within this fraction of the pressure of the membrane (always true at "
             "zero pressure)")),
};
TABLE_OF(end);

static const gn_key stage_keys[] = {
    NAME("name", gn_stage, name, REQUIRED, "name of the stage"),
    SECTION("end", end_section,
            .text = "conditions that end the stage, whichever comes first; the last stage may omit "
                    "them and ends at time.end"),
    ARRAY("*", CHANGES, gn_stage, changes, change_size, PRESENT(COUNT, gn_stage, change_size),
          .unit = "keys of the scene",
          .text = "keys of the scene that change when the stage begins and keep their new values: "
                  "gravity, damping, friction, motions, forces, servos, the pressure of the "
                  "membrane, loads, steps, rows and snapshots; elements of lists by name, as "
                  "walls: {top: {motion: {vz: 0.1}}}"),
};
const gn_section gn_stage_section = {KEYS_OF(stage), sizeof(gn_stage), offsetof(gn_stage, where)};

/* ---- keys of `output` ---- */

static const gn_key structure_keys[] = {
    VECTOR("min", gn_scene, structure_min, "m", GN_PLACES, REQUIRED, "lower corner of the box"),
    VECTOR("max", gn_scene, structure_max, "m", GN_PLACES, REQUIRED, "upper corner of the box"),
};
TABLE_OF(structure);

static const gn_key output_keys[] = {
    TEXT("directory", gn_scene, output_directory, BY(""),
         "folder of the results; left out: runs/ and the name of the scene"),
    INTEGER("history_rows", gn_scene, history_rows, "[0, 10000000]", BY("1000"),
            "rows of the history up to time.end; up to twice as many if a test ends before"),
    SECTION("structure", structure_section, PRESENT(BOOL, gn_scene, has_structure),
            .text =
                "box in which porosity, coordination, fabric and sliding contacts of the history "
                "are measured; left out: the whole specimen"),
    INTEGER("snapshots", gn_scene, snapshots, "[0, 1000000]", BY("10"),
            "snapshots up to the end, besides those at the peak of a test and at half of it; 0: "
            "only the last state"),
    REAL("checkpoint", gn_scene, checkpoint_wall, "s", "[0, inf)", BY("5 min"),
         "wall time between checkpoints; off: only on a signal and at the end", .word = "off"),
    CHOICE("energy", gn_scene, energy, gn_switches, BY("auto"), "energy ledger; auto: on"),
    CHOICE("orientation", gn_scene, orientation, gn_switches, BY("auto"),
           "rotations of particles since the start, in snapshots and results.h5, if they rotate; "
           "auto: off"),
    CHOICE("events", gn_scene, events, gn_switches, BY("auto"),
           "list of the times and places at which bonds broke, began to soften or to yield, in "
           "results.h5; auto: on"),
    CHOICE("contacts", gn_scene, contact_rows, gn_switches, BY("auto"),
           "all acting contacts, including unbonded ones and those with walls and bodies, in "
           "snapshots and results.h5; auto: off"),
    REAL("burst_reach", gn_scene, burst_reach, "1", "[0, 1e6]", BY("5"),
         "breaks belong to one burst if they are at most this many mean diameters of bonded "
         "particles apart, and in time at most what a wave takes over that distance"),
    ARRAY("fields", NAMES, gn_scene, fields, field_count, PRESENT(COUNT, gn_scene, field_count),
          .text =
              "further quantities of particles and bonds in snapshots and results.h5: spin, group, "
              "material, skin, total_force, total_moment, damping_force, damping_moment, fragment, "
              "fragment_size, area, shear_stress (docs/quantities.md)"),
};
const gn_section gn_output_section = {KEYS_OF(output), 0, GN_NO_WHERE};
