/* The list of contacts across joints, and their readings. */
#ifndef GN_PARTICLES_JOINTS_H
#define GN_PARTICLES_JOINTS_H

#include "base/error.h"
#include "frame/parts.h"
#include "neigh/neigh.h"

#include <stdbool.h>
#include <stddef.h>

/* Removes the pairs between which a joint lies. */
void gn_joints_drop(const gn_dem *dem, gn_pair_list *pairs);

/* Takes over from `found`, the pairs within reach of the new lists, those that cross a joint:
 * contacts that have come close enough are added to the list of joints, broken ones that have left
 * are removed from it, and of other pairs those farther apart than `skin` m are dropped. The change
 * of the stored energy is added to dem->joint_change. */
gneiss_status gn_joints_renew(const gn_step_context *ctx, gn_dem *dem, gn_pair_list *found,
                              gneiss_error *error);

/* Returns that change, J, and sets it to 0. */
double gn_joints_take_change(gn_dem *dem);

/* Sums over the contacts of one joint of a scene. */
typedef struct gn_joint_reading {
    double area;          /* m2 of its contacts (2D: m x 1 m) */
    double broken;        /* m2, of contacts that do not hold any more, or never held */
    double opened;        /* m2, without force */
    double sliding;       /* m2, slid in the last step */
    double normal, shear; /* N: pressure positive; magnitude of the sum of the shear forces */
    double gap, slip;     /* m, means over the area: opening, path of sliding */
} gn_joint_reading;
gn_joint_reading gn_joint_read(const gn_dem *dem, size_t joint);

/* A joint of a scene at the start. */
typedef struct gn_joint_start {
    double wanted, reached;  /* m2 (2D: m x 1 m) in the specimen, and of it where contacts cross */
    double contacts, shared; /* those that cross it, and of these those that cross another too */
} gn_joint_start;
gn_joint_start gn_joint_at_start(const gn_dem *dem, size_t joint);

/* Tells whether joints are closer to each other than particles, or crossed by so few contacts that
 * a part of their area is missing, and writes a text about it. */
bool gn_joints_are_close(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);
bool gn_joints_lack_area(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);

#endif
