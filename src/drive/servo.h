/* What servos of walls and of the sides of a periodic box have in common.
 *
 * A servo makes up a share rho of what is missing in each step, by the stiffness K that it finds.
 * By itself that leaves droop: against what goes on moving at V it misses V dt K/rho for ever. So
 * the speed has a second part u, to which b times the first is added in each step: at a constant V
 * u comes to V and nothing is missing. To what it presses the servo is a dashpot K dt/rho behind
 * which, through u, a mass M = K dt^2/(rho b) is pushed: both passive, so that no gain makes it
 * unstable with springs and masses in front of it. With its path in a step over the missing force,
 * y = rho/K (1/(z - 1) + b/(z - 1)^2), on the unit circle z = exp(i t): Im y = -rho/(2 K) (1 - b)
 * cot(t/2), which keeps its sign for b < 1, so that the loop can cross the circle at z = -1 only,
 * and there y = -rho/(2 K) (1 - b/2) is less than without u: what bounds rho (gn_servo_share) is
 * enough.
 *
 * With a = rho S/K, S the slow answer of all that is pressed, what is missing goes as s^2 + a s + a
 * b = 0 a step; b = a/2. What is wanted anew is not what droop is: by the share alone the force f
 * follows the wanted one f* as f' = a (f* - f). The second part is held against that and not
 * against f*, so that a force that is asked for is come to without overshoot, at the same pace as
 * without it. S is bounded by uniform strain (the same on all branches); packings have a quarter to
 * two thirds of that, and a is for a quarter. Where S is more, f is ahead of what was expected, and
 * nothing is added. Once the wanted force stands, all of this is linear. */
#ifndef GN_DRIVE_SERVO_H
#define GN_DRIVE_SERVO_H

#include "frame/parts.h"
#include "frame/periodic_box.h"

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* A step: what is wanted and found, N or J; the speed that makes up the share of a unit of what is
 * missing; a; and the most that the speed may be. */
typedef struct gn_servo_look {
    double wanted, found, pace, answer, most;
} gn_servo_look;

/* Sums over the contacts that act, or over all that are listed, as pressed as they may come to be,
 * along each of `count` unit vectors n: J, (k_n + k_t) (l n)^2, the most that springs answer a
 * strain along n with, sides held too; J s, c_n (l n)^2. */
void gn_servo_answers(const gn_step_context *ctx, const gn_dem *dem, bool all, size_t count,
                      const double (*n)[3], double *spring, double *dashpot);

/* a of a servo that makes up `share`, with uniform strain's S over K. */
double gn_servo_answer(double share, double uniform);

/* The speed of the step. Where its bound cuts it nothing is added, so that nothing winds up. */
double gn_servo_speed(gn_servo_state *state, const gn_servo_look *look);

/* The share of what is missing that a servo may make up in a step (walls.c). */
double gn_servo_share(const gn_step_context *ctx, const gn_dem *dem);

#endif
