/* Trial states of a world, for searches of equilibrium (src/static). On a path prescribed parts
 * move as prescribed and all others are displaced as given; at its end the forces of the real
 * contacts are computed. No step is made. */
#ifndef GN_STATIC_TRIAL_H
#define GN_STATIC_TRIAL_H

#include "base/error.h"
#include "frame/parts.h"
#include "limit/equilibrium.h"
#include "particles/contact_lists.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Paths are [particles][6], m and rad: displacements and rotations from the reference state. */
typedef struct gn_trial {
    gn_world *world; /* borrowed */
    size_t count;    /* particles */

    /* The reference state. */
    double *pos; /* [count][4] */
    gn_contacts contacts[GN_LIST_COUNT];
    gn_wall_contacts touches;
    double (*wall)[4];       /* [walls] point, travel */
    double (*wall_force)[3]; /* [walls] N */
    double *supplied;        /* [prescribed][6] N, N m: loads that the prescription supplies */
    double stored;           /* J, stored energy at the start of the world */

    gn_preconditioner made; /* preconditioner of the tangent, valid as long as the lists */

    /* State of the last increment. */
    double *load;                     /* [count][6] N, N m; 0 in prescribed components */
    double rate;                      /* 1/s: rate of its displacements; 0: at rest */
    double friction, contact_damping; /* J */
    int64_t broken;
    /* N: mean over free particles (moments are divided by the radius), largest, and mean over
     * contacts with a force */
    double mean_load, most_load, mean_force;
    int32_t worst; /* id of the particle with the largest load */

    double shortfall; /* J, sum of the errors of trapezoidal works so far */
} gn_trial;

/* Starts from the present state of the world, at rest or not, with all forces; the ledger
 * begins. */
gneiss_status gn_trial_begin(gn_world *world, gn_trial *trial, gneiss_error *error);
void gn_trial_free(gn_trial *trial);

/* Writes the prescribed components of a path of `span` s from the reference state. */
void gn_trial_prescribe(const gn_trial *trial, double span, double *path);

/* Moves the world to the end of a path of `span` s and finds the loads there. `loads`: on the path
 * dead loads are applied, at zero velocity and with all prescribed parts at rest; `span` is then
 * used for dashpots only. Bonds may break: trial->broken. */
void gn_trial_go(gn_trial *trial, const double *path, double span, bool loads);

/* Adds to the path the displacements that bring the linearised system into equilibrium. */
gneiss_status gn_trial_correct(gn_trial *trial, double tolerance, double *path,
                               gn_equilibrium *found, gneiss_error *error);

/* Makes the end of the last path the reference state: time, rotations, lists, and the ledger, which
 * works of prescribed motions close. */
gneiss_status gn_trial_take(gn_trial *trial, const double *path, double span, bool loads,
                            gneiss_error *error);

/* Leaves the world ready for gn_world_step, with velocities path/span: the next step uses the
 * forces of this state. `step`: its number. */
gneiss_status gn_trial_leave(gn_trial *trial, const double *path, double span, gneiss_error *error);

/* Computes the force of bond c along the normal, tension positive, and across it, N; returns false
 * if the bond is broken. */
bool gn_trial_bond(const gn_trial *trial, size_t c, double *normal, double shear[3]);

#endif
