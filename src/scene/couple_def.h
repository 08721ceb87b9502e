/* What a scene says of zones that particles and elements share, and of a wave at its start. */
#ifndef GN_SCENE_COUPLE_DEF_H
#define GN_SCENE_COUPLE_DEF_H

#include "scene/place.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A plane wave at the start: u = size/2 (1 + cos(2 pi s/length)) along its direction where |s| <
 * length/2, s being the distance from its crest, and v = -speed du/ds. */
typedef struct gn_pulse {
    double direction[3];        /* of any length */
    double centre[3];           /* m, a point of the crest */
    double length, size, speed; /* m, m, m/s */
} gn_pulse;

/* Where elements end among particles and particles among elements: two parallel planes (2D: lines).
 */
typedef struct gn_couple_edge {
    double from[3], to[3]; /* m: a point of the plane where elements end, and the one across from it
                            * on the plane where particles end */
    gn_scene_place where;
} gn_couple_edge;

/* A part of the body that both share. Particles fill what lies before all of its edges. */
typedef struct gn_couple_zone {
    size_t edge_count;
    gn_couple_edge *edges;
    gn_scene_place where;
} gn_couple_zone;

typedef enum gn_couple_constraint {
    GN_COUPLE_LUMPED,
    GN_COUPLE_CONSISTENT,
    GN_COUPLE_PENALTY
} gn_couple_constraint;
typedef enum gn_couple_spins { GN_COUPLE_FREE, GN_COUPLE_SLAVED } gn_couple_spins;

/* Whose stresses are held against limits. */
typedef enum gn_convert_by { GN_CONVERT_ELEMENTS, GN_CONVERT_NODES } gn_convert_by;

/* Elements that turn into particles while the run goes on. */
typedef struct gn_convert_def {
    bool has_box;                  /* else that of specimen.packing.region */
    double box_min[3], box_max[3]; /* m: prepared are elements of which all nodes start in it */
    double width;                  /* m, of the zone between both */
    double stress;                 /* Pa, largest principal; 0: no such limit */
    bool has_mohr;
    double cohesion, friction; /* Pa, tan(phi), with has_mohr */
    gn_convert_by by;
    int64_t every; /* steps between looks */
    double most;   /* share of the prepared elements that convert by a limit at one look */
    double relax;  /* mean load over mean contact force; 0: not at all */
    int64_t relax_iterations; /* at most */
    gn_scene_place where;
} gn_convert_def;

/* Particles and elements as one body. */
typedef struct gn_couple_def {
    size_t zone_count;
    gn_couple_zone *zones;
    gn_couple_constraint constraint;
    gn_couple_spins spins;
    double penalty, penalty_damping; /* over what masses and the step make of it; of critical */
    bool has_convert;
    gn_convert_def convert;
    gn_scene_place where;
} gn_couple_def;

#endif
