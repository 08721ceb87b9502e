/* Rigid clumps: bodies of particles that may overlap. Their members are rows of the record of
 * particles and have contacts as all others, but not with each other; forces and moments of members
 * are summed up in a fixed order, the clump moves as a rigid body, and the members follow it. The
 * blocks of members wait for the sum (sched/hold.h), and the kernels of motion see members without
 * load and mass.
 *
 * The mass that the record states for a member is a share such that the quadratic form of the
 * shares in any rigid motion is at most that of the clump. By Rayleigh's principle a step that is
 * stable for free members is then stable for the clump. */
#ifndef GN_PARTICLES_CLUMPS_H
#define GN_PARTICLES_CLUMPS_H

#include "frame/parts.h"

#include "base/error.h"
#include "io/packing.h"
#include "kernels/motion.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A clump. Its frame has its origin at the centre of mass and its axes along the principal axes.
 * All members are doubles, as in checkpoints. */
typedef struct gn_clump {
    double position[3];            /* m, of the centre of mass */
    double velocity[3];            /* m/s, over the last interval */
    double mean_spin[3];           /* rad/s, mean over the last interval */
    double axes[9];                /* the orientation as a matrix, rows: x = position + axes X */
    double spin[3], momentum[3];   /* rad/s; N m s about the centre of mass */
    double turn[4], turn_start[4]; /* quaternions w x y z that rotate from the clump's frame, now
                                      and at the start */
    double mass, inverse_mass;     /* kg, 1/kg */
    double inertia[3];             /* kg m2 about the axes of the frame */
    double inverse_inertia[3];     /* 1/(kg m2); 0: it does not turn about the axis (2D) */
    double first, count;           /* members: index of the first one, number */
    double present;                /* 1; 0: removed */
} gn_clump;

/* A member. All members are doubles, as in checkpoints. */
typedef struct gn_clump_member {
    double local[3]; /* m, centre in the frame of the clump */
    double part;     /* share of the clump's mass in outputs; they add up to 1 */
    double inverse_mass, inverse_inertia; /* 1/kg, 1/(kg m2) in the record of particles */
    double id;                            /* of the particle */
    double material;                      /* number in the scene's list */
} gn_clump_member;

/* Sums of a step over clumps. */
typedef struct gn_clump_sums {
    gn_motion_sums motion;
    double step_change[2]; /* J, as those of gn_dem_sums */
    double stress[9];      /* J: arms of members times the forces on them, with `measure` */
} gn_clump_sums;

typedef struct gn_clumps {
    size_t count, member_count;
    gn_clump *clump;         /* [count] */
    gn_clump_member *member; /* [member_count] */
    int32_t *row;            /* [member_count] row of a member */
    int32_t *member_of_row;  /* [rows] -1: none */
    int32_t *apart;          /* [blocks] number of rows that move by themselves */
    gn_clump_sums *sums;     /* per group of clumps */
    gn_clump_sums done;      /* sums of the last step */
} gn_clumps;

/* Makes the clumps of the scene and appends the spheres of their members to a packing. */
gneiss_status gn_clumps_make(const gn_step_context *ctx, gn_packing *packing, gn_clumps *clumps,
                             gneiss_error *error);
/* Sets materials of members when the particles have been created, and their velocities and shares
 * of the mass when masses are set. */
void gn_clumps_enter(gn_dem *dem);
void gn_clumps_complete(gn_dem *dem);
void gn_clumps_free(gn_clumps *clumps);

/* Finds the rows of members after lists were made or read, and holds their blocks. */
gneiss_status gn_clumps_follow_rows(gn_dem *dem, gneiss_error *error);
/* Tells whether all rows of a block are members, which the kernel of motion need not move. */
static inline bool gn_clumps_fill(const gn_clumps *clumps, size_t block) {
    return clumps->count && clumps->apart[block] == 0;
}
/* Sums up the loads of members and moves the clumps; then gn_clumps_move_members moves members,
 * after the sweep of held blocks. */
void gn_clumps_move(const gn_step_context *ctx, gn_dem *dem, bool measure);
void gn_clumps_move_members(const gn_step_context *ctx, gn_dem *dem);

/* Marks all members of a clump as gone if one of them is; rows with 0 stay. */
void gn_clumps_leave_whole(const gn_dem *dem, int32_t *gone);
/* Removes a clump of which the row is a member, and returns the kinetic energy, J, that it takes
 * away: 0 if the clump was removed before. */
double gn_clumps_remove(gn_dem *dem, size_t row);

/* Tells whether two rows are members of one clump, which have no contact. */
bool gn_clump_binds(const gn_dem *dem, int32_t i, int32_t j);
/* Returns the clump of a row; NULL: none. */
const gn_clump *gn_clump_of(const gn_dem *dem, size_t row);
/* Returns the part of a clump's mass that outputs give to one of its rows, kg. */
double gn_clump_mass_of(const gn_dem *dem, size_t row);
/* Returns the number of members less that of clumps, which do not move by themselves. */
size_t gn_clumps_bound(const gn_clumps *clumps);

uint64_t gn_clumps_hash(const gn_clumps *clumps, uint64_t hash);

#endif
