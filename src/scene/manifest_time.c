/* Keys of `time`. */
#include "scene/manifest_keys.h"
#include "scene/units.h"

static const gn_choice estimates[] = {
    {"sharp", GN_STEP_SHARP}, {"bound", GN_STEP_BOUND}, {NULL, 0}};
static const gn_choice starts[] = {
    {"rest", GN_START_REST}, {"first_break", GN_START_FIRST_BREAK}, {NULL, 0}};
static const gn_choice scaled_gravities[] = {
    {"refuse", GN_GRAVITY_REFUSED}, {"own_mass", GN_GRAVITY_OWN}, {NULL, 0}};
static const gn_choice policies[] = {{"stop", GN_POLICY_STOP}, {"warn", GN_POLICY_WARN}, {NULL, 0}};

static const gn_key stop_keys[] = {
    KEY("peak_drop", REAL, gn_scene, stop_peak_drop, .unit = "1", .range = "(0, 1)", .word = "off",
        .other_word = "auto", .other_value = -1, .fallback = "auto",
        .text = "stop once stress has fallen by this fraction of its peak; auto: the default of "
                "the kind of test, together with other conditions; this default also holds if no "
                "condition of stop is given"),
    KEY("strain", REAL, gn_scene, stop_strain, .unit = GN_STRAIN, .range = "(0, inf)",
        .word = "off", .fallback = "off", .text = "stop at this strain"),
    KEY("unbalanced", REAL, gn_scene, stop_unbalanced, .unit = "1", .range = "(0, inf)",
        .word = "off", .fallback = "off",
        .text = "stop once the unbalanced force ratio is below this, after 20 rows, while some "
                "contacts carry load and no particle falls freely"),
};
TABLE_OF(stop);

static const gn_key mass_scaling_keys[] = {
    KEY("step", REAL, gn_scene, scaled_step, .unit = "s", .range = "(0, inf)", .word = "none",
        .fallback = "none", .text = "target time step, safety included"),
    KEY("factor", REAL, gn_scene, scaled_factor, .unit = "1", .range = "[1, 1000]", .word = "none",
        .fallback = "none",
        .text = "target time step over the step without added mass; step or factor"),
    KEY("gravity", CHOICE, gn_scene, scaled_gravity, .choices = scaled_gravities,
        .fallback = "refuse",
        .text = "own_mass: particles keep their weight, and so fall more slowly; needed in a scene "
                "with gravity"),
};
static const gn_section mass_scaling_section = {mass_scaling_keys,
                                                sizeof mass_scaling_keys / sizeof(gn_key), 0,
                                                offsetof(gn_scene, scaling_where)};

static const gn_key time_keys[] = {
    KEY("step", REAL, gn_scene, step, .unit = "s", .range = "(0, inf)", .word = "auto",
        .fallback = "auto", .text = "time step; auto: safety times the stability limit"),
    KEY("safety", REAL, gn_scene, safety, .unit = "1", .range = "(0, 1]", .fallback = "0.9",
        .text = "automatic step as a fraction of the stability limit 2/w_max"),
    KEY("contact_steps", REAL, gn_scene, contact_steps, .unit = GN_PLAIN_NUMBER,
        .range = "(0, inf)", .word = "auto", .fallback = "auto",
        .text = "least number of steps in the shortest collision of unbonded particles, for an "
                "automatic step; auto: 10, with hertz 12, which keeps restitution within 1 %"),
    KEY("estimate", CHOICE, gn_scene, estimate, .choices = estimates, .fallback = "sharp",
        .text = "estimate of the stability limit: sharp by iteration, or a rigorous bound per "
                "particle"),
    SECTION("mass_scaling", mass_scaling_section, PRESENT(BOOL, gn_scene, has_mass_scaling),
            .text = "for quasi-static runs: mass and moment of inertia are raised for particles "
                    "that would need a smaller step; none are lowered"),
    KEY("on_unstable", CHOICE, gn_scene, on_unstable, .choices = policies, .fallback = "stop",
        .text = "reaction to a step above the stability limit"),
    KEY("end", REAL, gn_scene, end, .unit = "s", .range = "(0, inf)", .required = true,
        .text = "time at which the run ends"),
    KEY("start", CHOICE, gn_scene, start, .choices = starts, .fallback = "rest",
        PLACED(gn_scene, start_where),
        .text = "initial state: at rest; or first_break, the equilibrium shortly before the first "
                "bond breaks, found by statics"),
    KEY("start_fraction", REAL, gn_scene, start_fraction, .unit = "1", .range = "(0, 1)",
        .fallback = "0.9",
        .text = "with first_break: initial time as a fraction of the time of the first break"),
    SECTION("stop", stop_section, .word = "none",
            .text = "conditions that end the run earlier; none: the run lasts to its end"),
};
const gn_section gn_time_section = {time_keys, sizeof time_keys / sizeof(gn_key), 0,
                                    offsetof(gn_scene, time_where)};
