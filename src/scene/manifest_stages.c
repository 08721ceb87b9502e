/* Keys of `stages`. */
#include "scene/manifest_keys.h"
#include "scene/stages.h"
#include "scene/units.h"

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
    KEY("name", NAME, gn_stage, name, .required = true, .text = "name of the stage"),
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
const gn_section gn_stage_section = {stage_keys, sizeof stage_keys / sizeof(gn_key),
                                     sizeof(gn_stage), offsetof(gn_stage, where)};
