/* Orientations as quaternions w x y z and as matrices (rows), and the rotation of a free rigid
 * body.
 */
#ifndef GN_BASE_ROTATION_H
#define GN_BASE_ROTATION_H

#include <stdbool.h>
#include <stddef.h>

/* Computes the rotation matrix of a unit quaternion. */
void gn_turn_axes(const double turn[4], double axes[9]);
/* Computes the product of two quaternions: the rotation `b` followed by `a`. */
void gn_turn_product(const double a[4], const double b[4], double out[4]);
/* Normalises the quaternion q, so that rounding cannot accumulate, and computes its matrix; the
 * unit quaternion of a body that does not rotate is unchanged. */
void gn_turn_settle(double q[4], double axes[9]);
/* Computes the quaternion q of a rotation matrix m (Shepperd 1978). */
void gn_turn_of_matrix(const double m[9], double q[4]);
/* Computes the quaternion of a rotation vector, axis times angle in rad. */
void gn_turn_of_vector(const double vector[3], double turn[4]);

/* Converts a direction from the frame of the axes to space, and back. */
static inline void gn_axes_direct(const double axes[9], const double local[3], double out[3]) {
    for (int a = 0; a < 3; a++)
        out[a] = axes[3 * a] * local[0] + axes[3 * a + 1] * local[1] + axes[3 * a + 2] * local[2];
}
static inline void gn_axes_local(const double axes[9], const double direction[3], double out[3]) {
    for (int a = 0; a < 3; a++)
        out[a] = axes[a] * direction[0] + axes[3 + a] * direction[1] + axes[6 + a] * direction[2];
}

/* Finds the principal axes of an inertia, kg m2 (or any symmetric second moment): its values and
 * the right-handed rotation from the frame of the axes. `space`: false in 2D, where the axes stay
 * those of space. */
void gn_principal_axes(const double inertia[9], bool space, double values[3], double turn[4]);

/* A rigid body that rotates freely about its centre of mass. */
typedef struct gn_rotor {
    double *turn, *axes;           /* [4], [9] from the principal frame, now */
    const double *momentum;        /* [3] N m s, in space */
    const double *inverse_inertia; /* [3] 1/(kg m2) about the principal axes */
} gn_rotor;

/* Computes the spin, rad/s, that belongs to the momentum at the present orientation. */
void gn_rotor_spin(const gn_rotor *rotor, double spin[3]);

/* Rotates the body over dt without a moment. `turn`: about the angle, rad, of the step, which
 * selects the order of the scheme; `space`: false in 2D. The angular momentum in space is kept, and
 * the body rotates about its principal axes in turn; each rotation is exact: about x y z y x for
 * half, half, whole, half, half of the step (Dullweber, Leimkuhler and McLachlan 1997, J. Chem.
 * Phys. 107, 5840). This keeps the momentum exactly and the energy without drift; it is symplectic,
 * reversible and of second order, in steps with large rotations of fourth order. */
void gn_rotor_advance(const gn_rotor *rotor, double turn, double dt, bool space);
/* The largest rotation of a step of second order, rad. */
extern const double GN_TURN_PLAIN;

/* Up to GN_ROTORS bodies side by side, as columns. */
enum { GN_ROTORS = 64 };
typedef struct gn_rotors {
    double turn[4][GN_ROTORS], axes[9][GN_ROTORS], momentum[3][GN_ROTORS];
    double inverse_inertia[3][GN_ROTORS], spin[3][GN_ROTORS];
} gn_rotors;

/* Does the same as gn_rotor_advance in space for `count` bodies that turn by at most GN_TURN_PLAIN,
 * and computes their spins at the end. The momentum turns back in the frame of the body, sines and
 * cosines are series, and the matrix is computed once; the result differs by rounding. Values of
 * momentum are those in space. */
void gn_rotors_advance(gn_rotors *rotors, size_t count, double dt);

#endif
