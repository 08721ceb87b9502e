/* Motion of the sides of a periodic box, by a prescribed rate or towards a mean stress. By
 * convention (Andersen 1980; Parrinello & Rahman 1981) particles move with the box. In a step they
 * first move by their own velocities c. Then the box grows by the factor lambda along each axis and
 * carries all positions along, x <- x0 + lambda (x - x0) with x0 its lower corner, and c <-
 * c/lambda: a free particle keeps its speed in units of the box. c is the velocity relative to the
 * mean flow. Damping, kinetic energy and output use c; contacts use c and the growth of their
 * branch. A uniform strain therefore has no discontinuity at the sides, and does not depend on the
 * position of the corner. The work of the box, which is that of contact forces on growing branches
 * and of the change of c, is booked as that of walls. */
#ifndef GN_DRIVE_BOX_H
#define GN_DRIVE_BOX_H

#include "frame/parts.h"
#include "frame/periodic_box.h"

#include "base/error.h"
#include "drive/servo.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>

struct gn_contacts;

void gn_box_create(const gn_step_context *ctx, gn_periodic_box *box);
/* Updates the stiffness of the contacts after lists have been made. */
void gn_box_listed(const gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box);
/* Computes the sum of f_a l_b over contacts [begin, end) of a list, from the forces in its rows, in
 * their order. The sums of the kernels are formed lane by lane; values derived from these would
 * differ between instruction sets. */
void gn_box_sum_stress(const gn_step_context *ctx, const gn_dem *dem,
                       const struct gn_contacts *list, size_t begin, size_t end, double sum[9]);
/* Grows the box over the coming step and books the work: half of that of the last interval, at the
 * present forces, and half of that of the coming interval. */
void gn_box_book(const gn_step_context *ctx, const gn_dem *dem, gn_periodic_box *box,
                 gn_ledger *ledger);
gneiss_status gn_box_move(gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box,
                          gn_ledger *ledger, gneiss_error *error);

#endif
