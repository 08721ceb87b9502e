/* The dashpot of a contact that rebounds with a restitution coefficient. */
#ifndef GN_KERNELS_DASHPOT_H
#define GN_KERNELS_DASHPOT_H

#include <math.h>

/* Returns the c_n in N s/m with which an isolated pair of bodies rebounds as the oscillator of
 * damping fraction `alpha` does, in steps of `dt` (0: none yet, 2 alpha sqrt(m k)).
 *
 * The force of a step uses the velocity of half a step before. A free oscillator so stepped obeys
 *     u(+) - (2 - q - y^2) u + (1 - q) u(-) = 0,   y = w dt, q = c_n dt/m, w^2 = k/m,
 * whose solutions decay by exp(-zeta) and rotate by theta in a step, with exp(-2 zeta) = 1 - q and
 * y = |1 - exp(-zeta + i theta)|. The rebound is right if zeta/theta has its value for small steps,
 * alpha/sqrt(1 - alpha^2): with zeta = alpha psi and theta = sqrt(1 - alpha^2) psi the last
 * equation gives psi(y) as the series below (next term of order y^4), and q = 1 - exp(-2 alpha
 * psi), with a quotient for tanh(alpha psi), which is the same on every machine. Otherwise c_n
 * would be too large by the factor 1 + alpha y/2: 3 % at ten steps per contact and c_r = 0.5.
 * The stiffness and bodies at rest are not affected. */
static inline double gn_dashpot(double stiffness, double inverse_mass, double alpha, double dt) {
    if (!(alpha > 0.0) || !(inverse_mass > 0.0)) return 0.0;
    double c = 2.0 * alpha * sqrt(stiffness / inverse_mass);
    double y = dt * sqrt(stiffness * inverse_mass);
    if (!(y > 0.0) || isinf(y)) return c;
    double psi = y * (1.0 + y * (0.5 * alpha + y * (7.0 * alpha * alpha + 1.0) / 24.0));
    double h = alpha * psi, tangent = h * (15.0 + h * h) / (15.0 + 6.0 * h * h);
    double q = 2.0 * tangent / (1.0 + tangent);
    double most = (q < 1.0 ? q : 1.0) / (dt * inverse_mass);
    return most < c ? most : c;
}

/* The least number of steps per half period pi/w of a free collision, w^2 = k/m, for an automatic
 * step. The restitution is then within 1 % (below one half: within 0.01) wherever in a step the
 * collision begins; this requires 3.5 steps at a restitution of 1, 4.5 at 0.9, 5.5 at 0.8, 7.5 at
 * 0.6, 9.5 at 0.5 and fewer again below (worst phases, measured). Without dashpots, where the
 * energy errors of all collisions add up, ten steps keep the energy of a bed that bounces for ever
 * within 1 % for thousands of collisions; five do not. */
enum { GN_STEPS_PER_CONTACT = 10 };

/* The least number of steps by Hertz's law, with w^2 = S_n/m at the largest overlap. The
 * restitution is within 1 % from five steps on, but the elastic work of a damped collision has an
 * error of (w dt)^2/6 of the dashpot's work while the spring is stiff: at ten steps up to 1.5 % of
 * all its energy (worst phases, at a restitution of one half), which the ledger shows. */
enum { GN_STEPS_PER_HERTZ = 12 };

#endif
