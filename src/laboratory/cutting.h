/* The tool of a cutting test: its path, its forces, and the volume that it has cut. */
#ifndef GN_LABORATORY_CUTTING_H
#define GN_LABORATORY_CUTTING_H

#include "base/error.h"
#include "frame/parts.h"
#include "test_kinds/cut.h"

#include <stdbool.h>
#include <stddef.h>

/* Number of bins over the rim of a disc cutter, 20 of them over the arc in the rock: the bins
 * extend from half an arc behind the lowest point to half an arc beyond the surface. */
enum { GN_RIM_BINS = 40, GN_RIM_BINS_OF_ARC = 20 };

/* Components of a force in the axes of the tool: out of the rock, against the motion, and sideways,
 * along the vector product of normal and motion. */
enum { GN_CUT_NORMAL, GN_CUT_ROLLING, GN_CUT_SIDE, GN_CUT_AXES };

/* State of a cutting test. It consists of doubles only, because checkpoints store it as it is. */
struct gn_cutting {
    double direction;      /* +1, -1: sense of the motion along the axis; 0: it never moves */
    double moves;          /* 1: the present stage or an earlier one moves it */
    double outward;        /* +1, -1: sense of the outward normal of the rock's surface */
    double surface;        /* m: position of that surface along the normal at the start */
    double elements[2][3]; /* m: lower and upper corner of elements at the start; 0: none */
    double begin, end;     /* m: positions along the path where the means begin and end */
    double loose; /* m3, volume of particles that were not connected to the held part when the tool
                     began to move */
    double solid; /* m3, volume of all particles at the start */
    double reached;    /* 1: the tool has reached the path of the means, 2: its end */
    double removed[2]; /* m3, volume of removed rock at the start and at the end of that path */
    double beside[2];  /* m3, part of removed[] that began beside the track */
    double track[2];   /* m, positions across the cut between which the tool is in the rock at the
                          depth of the test */
    double impulse[GN_CUT_AXES]; /* N s, impulse up to now, including the half step after the last
                                    instant */
    double seen[GN_CUT_AXES];    /* N s, impulse up to the last instant */
    double rim[GN_RIM_BINS][GN_CUT_AXES]; /* N, sums over the samples, by bin */
    double
        touched; /* m2, sum over the samples: cross sections of the particles that touch the tool */
    double samples;
};

/* Finds the axes of the tool and the path of the means, and sets the length of the test.
 * GNEISS_ERROR_INPUT if particles are inside the tool, it is below the rock, or leaves it before
 * the path ends. Call after all parts are made. */
gneiss_status gn_cutting_begin(gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                               const gn_solids *solids, gn_cutting *cutting, gneiss_error *error);
/* Adds the forces of the present instant; called when the work up to it has been added. */
void gn_cutting_add(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    gn_cutting *cutting);

/* Returns the path of the tool along the cut since the start, m. */
double gn_cutting_path(const gn_step_context *ctx, const gn_boundary *boundary,
                       const gn_cutting *cutting);
/* Returns the present force on the tool, N, in its axes. */
void gn_cutting_force(const gn_step_context *ctx, const gn_boundary *boundary,
                      const gn_cutting *cutting, double force[GN_CUT_AXES]);
/* Returns the volume of rock, including its pores, that is no longer connected to the held part, m3
 * (2D: m2 x 1 m). */
double gn_cutting_removed(const gn_step_context *ctx, const gn_dem *dem, const gn_cutting *cutting);
/* Returns the part of that volume whose particles began beside the track of the tool, m3; 0 in 2D.
 */
double gn_cutting_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_cutting *cutting);
/* Number of depths of cut before held particles at which the path of the means ends unless the
 * scene gives it: nearer to them rock between them and the tool cannot move away. */
#define GN_CUT_DEPTHS_TO_HELD 2.0

/* Finds the track of the tool. */
void gn_cutting_find_track(const gn_step_context *ctx, const gn_boundary *boundary,
                           gn_cutting *cutting);
/* Returns the path of the tool after which its part in the rock reaches particles whose velocity
 * along the cut sets prescribe, m; infinite: none is in its way. It needs the track. */
double gn_cutting_path_to_held(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_cutting *cutting);
/* Describes the cut for its readings. */
gn_cut gn_cutting_describe(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_cutting *cutting);
/* Returns the depth of the tool below the surface of the rock at its start, m; negative: above the
 * surface. */
double gn_cutting_depth_at_start(const gn_step_context *ctx, const gn_boundary *boundary,
                                 const gn_cutting *cutting);
/* Tells whether the depth of the tool (m) where the means begin or end differs from test.depth by
 * more than a twentieth; `text` then states the depths with the place of the test. NaN counts as no
 * difference. */
bool gn_cutting_depth_differs(const gn_step_context *ctx, const double depth[2], char *text,
                              size_t size);

/* Problems of a cutting test that are known before it runs. */
typedef enum gn_cutting_doubt {
    GN_CUT_LOCKED,    /* a disc cutter that cannot turn */
    GN_CUT_SKEW,      /* a disc cutter whose axis is not across the cut */
    GN_CUT_BESIDE,    /* the tool passes beside the rock */
    GN_CUT_WIDE,      /* the tool or the spacing is wider than the rock */
    GN_CUT_HELD,      /* the path ends close before held particles */
    GN_CUT_VALUES,    /* strengths in the wrong order, a window longer than the path */
    GN_CUT_PARTICLES, /* too few particles over the depth */
    GN_CUT_RESERVE,   /* elements around the tool cannot convert along the whole path */
    GN_CUT_DEPTH,     /* the prescribed motion gives another depth than the test */
    GN_CUT_SHORT,     /* time.end is before the end of the path */
    GN_CUT_DOUBTS
} gn_cutting_doubt;
/* Tells whether the problem exists; `text` then states it with its place. */
bool gn_cutting_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_cutting *cutting, gn_cutting_doubt doubt, char *text, size_t size);

#endif
