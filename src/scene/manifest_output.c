/* Keys of `output`. */
#include "scene/manifest_keys.h"

static const gn_choice switches[] = {
    {"auto", GN_SWITCH_AUTO}, {"on", GN_SWITCH_ON},  {"off", GN_SWITCH_OFF}, {"true", GN_SWITCH_ON},
    {"false", GN_SWITCH_OFF}, {"yes", GN_SWITCH_ON}, {"no", GN_SWITCH_OFF},  {NULL, 0}};

static const gn_key output_keys[] = {
    KEY("directory", TEXT, gn_scene, output_directory, .fallback = "",
        .text = "folder of the results; left out: runs/ and the name of the scene"),
    KEY("history_rows", INTEGER, gn_scene, history_rows, .range = "[0, 10000000]",
        .fallback = "1000",
        .text = "rows of the history up to time.end; up to twice as many if a test ends before"),
    KEY("snapshots", INTEGER, gn_scene, snapshots, .range = "[0, 1000000]", .fallback = "10",
        .text =
            "snapshots up to the end, besides those at the peak of a test and at half of it; 0: "
            "only the last state"),
    KEY("checkpoint", REAL, gn_scene, checkpoint_wall, .unit = "s", .range = "[0, inf)",
        .word = "off", .fallback = "5 min",
        .text = "wall time between checkpoints; off: only on a signal and at the end"),
    KEY("energy", CHOICE, gn_scene, energy, .choices = switches, .fallback = "auto",
        .text = "energy ledger; auto: on"),
    KEY("orientation", CHOICE, gn_scene, orientation, .choices = switches, .fallback = "auto",
        .text = "rotations of particles since the start, in snapshots and results.h5, if they "
                "rotate; auto: off"),
    KEY("events", CHOICE, gn_scene, events, .choices = switches, .fallback = "auto",
        .text = "list of the times and places at which bonds broke, began to soften or to yield, "
                "in results.h5; auto: on"),
    KEY("contacts", CHOICE, gn_scene, contact_rows, .choices = switches, .fallback = "auto",
        .text = "all acting contacts, including unbonded ones and those with walls and bodies, in "
                "snapshots and results.h5; auto: off"),
    KEY("burst_reach", REAL, gn_scene, burst_reach, .unit = "1", .range = "[0, 1e6]",
        .fallback = "5",
        .text = "breaks belong to one burst if they are at most this many mean diameters of bonded "
                "particles apart, and in time at most what a wave takes over that distance"),
    ARRAY("fields", NAMES, gn_scene, fields, field_count, PRESENT(COUNT, gn_scene, field_count),
          .text =
              "what particles and bonds have in snapshots and results.h5 besides: spin, group, "
              "material, skin, total_force, total_moment, damping_force, damping_moment, fragment, "
              "fragment_size, area, shear_stress (docs/quantities.md)"),
};
const gn_section gn_output_section = {output_keys, sizeof output_keys / sizeof(gn_key), 0,
                                      GN_NO_WHERE};
