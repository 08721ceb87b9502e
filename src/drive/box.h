/* The sides of a periodic box that move, by a prescribed rate or after a mean stress.
 *
 * Convention (Andersen 1980; Parrinello & Rahman 1981): particles ride on the box. A step first
 * moves them by their own velocities c, then the box grows by lambda along each axis and takes all
 * places along, x <- x0 + lambda (x - x0) with x0 its lower corner, while c <- c/lambda: what moves
 * freely keeps its speed in units of the box. c is the velocity beside the mean flow: damping,
 * kinetic energy and output are of c, contacts see c and the growth of their branch. So a uniform
 * strain has no seam, and does not depend on where the corner is. The work that this takes, of
 * contact forces on growing branches and of c, is booked as that of walls. */
#ifndef GN_DRIVE_BOX_H
#define GN_DRIVE_BOX_H

#include "frame/parts.h"

#include "base/error.h"
#include "drive/servo.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>

struct gn_contacts;

struct gn_periodic_box {
    double start[3];   /* m: lengths at the start */
    double flow[3];    /* 1/s: growth of the last interval over what the lengths are now */
    double spring[3];  /* J: most by which contacts that are listed answer a strain along an axis,
                          those across it held too: sum of (k_n + k_t) l^2 n_a^2 */
    double dashpot[3]; /* J s: the same of their dashpots */
    gn_servo_state servo[3];
    double reach; /* m: the longest branch that is listed */
    double path;  /* m: by how much such a branch may have shrunk since */
};

/* Of the scene as it stands: whether there is anything to do; 1 over what the lengths were. */
bool gn_box_moves(const gn_step_context *ctx, const gn_periodic_box *box);
bool gn_box_moved(const gn_periodic_box *box);

void gn_box_create(const gn_step_context *ctx, gn_periodic_box *box);
/* After lists have been made. */
void gn_box_listed(const gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box);
/* m/s: the most by which the ends of a listed contact came apart with it in the last step. */
double gn_box_speed(const gn_periodic_box *box);
/* Sum of f_a l_b over contacts [begin, end) of a list, whose forces stand in their rows, one by one
 * in their order: the kernels add them up lane by lane, so that what follows from their sum would
 * differ between instruction sets. */
void gn_box_sum_stress(const gn_step_context *ctx, const gn_dem *dem,
                       const struct gn_contacts *list, size_t begin, size_t end, double sum[9]);
/* Grows the box over the coming step, and books what that takes: the half of the work of the
 * interval that led here, at the forces there are, and the half of the coming one. */
void gn_box_book(const gn_step_context *ctx, const gn_dem *dem, gn_periodic_box *box,
                 gn_ledger *ledger);
gneiss_status gn_box_move(gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box,
                          gn_ledger *ledger, gneiss_error *error);
/* What a search for neighbours came to: that the box is too narrow for one is the fault of the
 * scene at the start, later of what moves its sides. */
gneiss_status gn_box_narrowed(const gn_step_context *ctx, const gn_periodic_box *box,
                              gneiss_status found, gneiss_error *error);
/* m2 (2D: m x 1 m): across the axis along which the box has no sides. */
double gn_box_section(const gn_step_context *ctx);
/* Strain along an axis since the start, over the length there. */
double gn_box_strain(const gn_step_context *ctx, const gn_periodic_box *box, int axis);

#endif
