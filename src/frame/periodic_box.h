/* State of a periodic box whose sides may move (drive/box.h moves them). */
#ifndef GN_FRAME_PERIODIC_BOX_H
#define GN_FRAME_PERIODIC_BOX_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>

/* State of a servo from step to step (drive/servo.c); doubles only. */
typedef struct gn_servo_state {
    double base;     /* speed to which the correction is added, m/s or 1/s */
    double expected; /* N or J: value expected at the next instant if the servo closes its share of
                        the difference */
} gn_servo_state;

struct gn_periodic_box {
    double start[3];   /* m: lengths at the start */
    double flow[3];    /* 1/s: rate of growth in the last interval over the present lengths */
    double spring[3];  /* J: upper bound of the stiffness of listed contacts against a strain along
                          an axis, with the other sides fixed: sum of (k_n + k_t) l^2 n_a^2 */
    double dashpot[3]; /* J s, the same sums over dashpots */
    gn_servo_state servo[3];
    double reach; /* m: the longest branch in the lists */
    double path;  /* m: the largest shortening of a listed branch since the lists were made */
};

/* Tell whether the sides of the box move in the present scene, and did so in the last step. */
bool gn_box_moves(const gn_step_context *ctx, const gn_periodic_box *box);
bool gn_box_moved(const gn_periodic_box *box);

/* Returns the largest speed, m/s, at which the box moved the ends of a listed contact apart in the
 * last step. */
double gn_box_speed(const gn_periodic_box *box);
/* Returns the status of a search for neighbours in a box that may be too narrow for it: this is an
 * error of the scene at the start, later one of the motion of the sides. */
gneiss_status gn_box_narrowed(const gn_step_context *ctx, const gn_periodic_box *box,
                              gneiss_status found, gneiss_error *error);
/* Returns the section across the open axis of the box, m2 (2D: m x 1 m). */
double gn_box_section(const gn_step_context *ctx);
/* Returns the strain along an axis since the start, over the initial length. */
double gn_box_strain(const gn_step_context *ctx, const gn_periodic_box *box, int axis);

#endif
