/* Definitions of coupling zones between particles and elements, and of an initial wave. */
#ifndef GN_SCENE_COUPLE_DEF_H
#define GN_SCENE_COUPLE_DEF_H

#include "scene/place.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* An initial plane wave: along its direction u = size/2 (1 + cos(2 pi s/length)) where |s| <
 * length/2, with the distance s from its crest, and v = -speed du/ds. */
typedef struct gn_pulse {
    double direction[3];        /* a vector of any length */
    double centre[3];           /* m, a point of the crest */
    double length, size, speed; /* m, m, m/s */
} gn_pulse;

/* Two parallel planes (2D: lines): elements end on one, particles on the other. */
typedef struct gn_couple_edge {
    double from[3], to[3]; /* m: a point on the plane where elements end, and the opposite point on
                              the plane where particles end */
    gn_scene_place where;
} gn_couple_edge;

/* A region that particles and elements share. Particles fill the space in front of all of its
 * edges. */
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

/* The stresses that are compared with the limits. */
typedef enum gn_convert_by { GN_CONVERT_ELEMENTS, GN_CONVERT_NODES } gn_convert_by;

/* Conversion of elements into particles during the run. */
typedef struct gn_convert_def {
    bool has_box;                  /* if not, specimen.packing.region applies */
    double box_min[3], box_max[3]; /* m: elements whose nodes all start in the box can convert */
    double width;                  /* m, width of the coupling zone */
    double stress;                 /* Pa, largest principal stress; 0: no such limit */
    bool has_mohr;
    double cohesion, friction; /* Pa, tan(phi), with has_mohr */
    double
        near_bodies; /* m, distance from a body within which elements convert; 0: no such limit */
    gn_convert_by by;
    int64_t every; /* number of steps between evaluations of the limits */
    double most;  /* largest share of the convertible elements that may convert in one evaluation */
    double relax; /* mean load over mean contact force; 0: no relaxation */
    int64_t relax_iterations; /* largest number of iterations */
    gn_scene_place where;
} gn_convert_def;

/* Coupling of particles and elements. */
typedef struct gn_couple_def {
    size_t zone_count;
    gn_couple_zone *zones;
    gn_couple_constraint constraint;
    gn_couple_spins spins;
    double penalty, penalty_damping; /* factor on the automatic penalty, which follows from masses
                                        and step; fraction of critical damping */
    bool has_convert;
    gn_convert_def convert;
    gn_scene_place where;
} gn_couple_def;

#endif
