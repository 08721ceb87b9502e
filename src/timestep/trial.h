/* The world tried at other states than those that steps lead to: paths in which what is prescribed
 * moves and all else is put somewhere, with the forces of the real contacts at their end. For who
 * looks for equilibrium (src/static). */
#ifndef GN_TIMESTEP_TRIAL_H
#define GN_TIMESTEP_TRIAL_H

#include "base/error.h"
#include "frame/parts.h"
#include "limit/equilibrium.h"
#include "particles/contact_lists.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Paths are [particles][6], m and rad: x y z and turns, from the state gone out from. */
typedef struct gn_trial {
    gn_world *world; /* borrowed */
    size_t count;    /* particles */

    /* The state gone out from. */
    double *pos; /* [count][4] */
    gn_contacts contacts[GN_LIST_COUNT];
    gn_wall_contacts touches;
    double (*wall)[4];       /* [walls] point, travel */
    double (*wall_force)[3]; /* [walls] N */
    double *supplied;        /* [prescribed][6] N, N m: what the prescription supplies */
    double stored;           /* J, at the start of the world */

    gn_preconditioner made; /* of the tangent, while the lists stand */

    /* Of the last path. */
    double *load;                     /* [count][6] N, N m; 0 in prescribed components */
    double rate;                      /* 1/s: of its displacements, 0: at rest */
    double friction, contact_damping; /* J */
    int64_t broken;
    /* N: per free particle (moments over the radius), the largest; per contact that carries */
    double mean_load, most_load, mean_force;
    int32_t worst; /* id of the particle with the largest load */

    double shortfall; /* J, by how much trapezoidal sums of the works have missed so far */
} gn_trial;

/* With all forces, as the world stands, at rest or not; the ledger begins. */
gneiss_status gn_trial_begin(gn_world *world, gn_trial *trial, gneiss_error *error);
void gn_trial_free(gn_trial *trial);

/* What is prescribed, in a path of `span` s from the state gone out from. */
void gn_trial_prescribe(const gn_trial *trial, double span, double *path);

/* Puts the world at the end of a path of `span` s and finds the loads there. `loads`: it is one of
 * dead loads, at no velocities and with everything prescribed at rest; `span` is then only what
 * dashpots see. Bonds may break: trial->broken. */
void gn_trial_go(gn_trial *trial, const double *path, double span, bool loads);

/* Adds to the path what brings the linearised system into equilibrium. */
gneiss_status gn_trial_correct(gn_trial *trial, double tolerance, double *path,
                               gn_equilibrium *found, gneiss_error *error);

/* The state of the last path is the one gone out from now: time, turns, ledger (works of what is
 * prescribed close it), lists. */
gneiss_status gn_trial_take(gn_trial *trial, const double *path, double span, bool loads,
                            gneiss_error *error);

/* With velocities path/span and all as gn_world_step wants it: the next step takes the forces of
 * this state. `step`: its number. */
gneiss_status gn_trial_leave(gn_trial *trial, const double *path, double span, gneiss_error *error);

/* Of bond c: its force along the normal, tension positive, and across it, N; false: it does not
 * hold. */
bool gn_trial_bond(const gn_trial *trial, size_t c, double *normal, double shear[3]);

#endif
