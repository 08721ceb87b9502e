/* Servos of walls and of the sides of a periodic box. In each step a servo makes up the share rho
 * of the missing force, by the stiffness K that it finds. This alone leaves an offset: against a
 * steady motion V the force V dt K/rho is missing permanently. The speed therefore has a second
 * part u, to which b times the first part is added in each step. At a constant V, u converges to V,
 * and the offset vanishes. For the material the servo is a dashpot K dt/rho, and behind it a mass M
 * = K dt^2/(rho b) that moves with u. Both are passive, so that no gain makes the servo unstable
 * with springs and masses. Let y = rho/K (1/(z - 1) + b/(z - 1)^2) be its path in a step over the
 * missing force. On the unit circle z = exp(i t), Im y = -rho/(2 K) (1 - b) cot(t/2), which keeps
 * its sign for b < 1. The loop can therefore cross the circle at z = -1 only, where y = -rho/(2 K)
 * (1 - b/2) is less than without u, so that the bound of rho (gn_servo_share) suffices. With a =
 * rho S/K, where S is the slow response of all pressed contacts, the missing force evolves as s^2 +
 * a s + a b = 0 per step; b = a/2. A change of the target is not an offset: by the share alone, the
 * force f would follow the target f* as f' = a (f* - f). The second part is driven by the
 * difference to that expected f and not to f*; a new target is thus reached without overshoot, at
 * the same pace as without u. S is at most its value in uniform strain (equal on all branches);
 * packings have a quarter to two thirds of that, and a is computed with a quarter. Where S is
 * larger, f is ahead of the expected value, and nothing is added. Once the target is constant, all
 * of this is linear. */
#ifndef GN_DRIVE_SERVO_H
#define GN_DRIVE_SERVO_H

#include "frame/parts.h"
#include "frame/periodic_box.h"

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* One step of a servo: target and present value, N or J; the speed that corrects its share of a
 * difference of one unit; the rate a; and the largest speed. */
typedef struct gn_servo_look {
    double wanted, found, pace, answer, most;
} gn_servo_look;

/* Computes sums over the active contacts, or with `all` over all listed ones at their largest
 * expected overlap, along each of `count` unit vectors n: `spring`, J, of (k_n + k_t) (l n)^2, the
 * largest response of springs to a strain along n with fixed sides; `dashpot`, J s, of c_n (l n)^2.
 */
void gn_servo_answers(const gn_step_context *ctx, const gn_dem *dem, bool all, size_t count,
                      const double (*n)[3], double *spring, double *dashpot);

/* Returns the rate a of a servo that makes up `share`; `uniform`: S in uniform strain over K. */
double gn_servo_answer(double share, double uniform);

/* Returns the speed of the step. While the speed is at its bound, u does not grow, so that there is
 * no windup. */
double gn_servo_speed(gn_servo_state *state, const gn_servo_look *look);

/* Returns the largest stable share of the missing force that a servo may make up in a step. */
double gn_servo_share(const gn_step_context *ctx, const gn_dem *dem);

#endif
