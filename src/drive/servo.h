/* Servos of walls and of the sides of a periodic box. A servo makes up a share rho of the missing
 * force in each step, by the stiffness K that it finds. Alone that leaves an offset: against a
 * steady motion V it misses V dt K/rho permanently. So the speed has a second part u, to which b
 * times the first is added in each step: at a constant V u converges to V and the offset vanishes.
 * To the material the servo is a dashpot K dt/rho with a mass M = K dt^2/(rho b) behind it, moved
 * by u: both passive, so that no gain makes it unstable with springs and masses. With its path in a
 * step over the missing force, y = rho/K (1/(z - 1) + b/(z - 1)^2), on the unit circle z = exp(i
 * t): Im y = -rho/(2 K) (1 - b) cot(t/2), which keeps its sign for b < 1, so that the loop can
 * cross the circle at z = -1 only, and there y = -rho/(2 K) (1 - b/2) is less than without u: the
 * bound of rho (gn_servo_share) suffices. With a = rho S/K, S the slow response of all pressed
 * contacts, the missing force evolves as s^2 + a s + a b = 0 per step; b = a/2. A change of the
 * target is not an offset: by the share alone the force f follows the target f* as f' = a (f* - f).
 * The second part is compared with that and not with f*, so that a new target is reached without
 * overshoot, at the same pace as without it. S is bounded by uniform strain (equal on all
 * branches); packings have a quarter to two thirds of that, and a is for a quarter. Where S is
 * larger, f is ahead of the expectation, and nothing is added. Once the target is constant, all of
 * this is linear. */
#ifndef GN_DRIVE_SERVO_H
#define GN_DRIVE_SERVO_H

#include "frame/parts.h"
#include "frame/periodic_box.h"

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* One step of a servo: target and present value, N or J; the speed that corrects the given share of
 * a difference of one unit; the rate a; and the largest speed. */
typedef struct gn_servo_look {
    double wanted, found, pace, answer, most;
} gn_servo_look;

/* Sums over the active contacts, or over all listed ones at their largest expected overlap, along
 * each of `count` unit vectors n: J, (k_n + k_t) (l n)^2, the largest response of springs to a
 * strain along n with fixed sides; J s, c_n (l n)^2. */
void gn_servo_answers(const gn_step_context *ctx, const gn_dem *dem, bool all, size_t count,
                      const double (*n)[3], double *spring, double *dashpot);

/* Returns a of a servo that makes up `share`, with S of uniform strain over K. */
double gn_servo_answer(double share, double uniform);

/* Returns the speed of the step. At its bound the integral does not grow, so that there is no
 * windup. */
double gn_servo_speed(gn_servo_state *state, const gn_servo_look *look);

/* Share of the missing force that a servo may make up in a step. */
double gn_servo_share(const gn_step_context *ctx, const gn_dem *dem);

#endif
