/* The phases of a run whose times are booked separately. */
#ifndef GN_FRAME_PHASES_H
#define GN_FRAME_PHASES_H

/* X(name, text): phases under which the seconds of a run are booked. */
#define GN_PHASES(X)                                                                               \
    X(bonds, "bond kernels")                                                                       \
    X(pairs, "unbonded contact kernels")                                                           \
    X(walls, "wall contacts and wall motion")                                                      \
    X(motion, "gather, damping, integration")                                                      \
    X(waiting, "waiting for the other threads")                                                    \
    X(elements, "finite elements: forces, motion, readings")                                       \
    X(exchange, "zones of particles and elements")                                                 \
    X(lists, "neighbour search and lists")                                                         \
    X(step_limit, "stability limit")                                                               \
    X(conversion, "elements that turn into particles")                                             \
    X(measure, "readings and history")                                                             \
    X(output, "snapshots, checkpoints, results")                                                   \
    X(setup, "specimen, bonds, first lists and limit")

typedef enum gn_phase {
#define X(name, text) GN_PHASE_##name,
    GN_PHASES(X)
#undef X
        GN_PHASE_COUNT
} gn_phase;

const char *gn_phase_name(gn_phase phase);

const char *gn_phase_text(gn_phase phase);

#endif
