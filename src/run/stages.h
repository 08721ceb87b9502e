/* Stages of a run (scene/stages.h): their ends and the change from one to the next. */
#ifndef GN_RUN_STAGES_H
#define GN_RUN_STAGES_H

#include "run/run.h"
#include "scene/stages.h"

/* The cause that ended a stage; gn_stage_state.ended. */
typedef enum gn_stage_cause {
    GN_STAGE_RUNS,
    GN_STAGE_TIME,
    GN_STAGE_STEPS,
    GN_STAGE_STRAIN,
    GN_STAGE_STRESS,
    GN_STAGE_PEAK_DROP,
    GN_STAGE_UNBALANCED,
    GN_STAGE_HELD,
    GN_STAGE_PRESSED,
    GN_STAGE_ASKED
} gn_stage_cause;

bool gn_run_staged(const gn_run *run);

/* Tells whether the largest stress so far may count as a peak. It may not while the pressure of a
 * cell is applied, when platens are touched now and then without a peak of the deviator; nor while
 * a normal stress is applied, because the shear stress then fluctuates: spheres without friction
 * still carry a tenth of it. */
bool gn_run_loaded(const gn_run *run, double peak);
/* Tells whether stages are left, or the last one has not reached the end that it specifies. */
bool gn_run_stages_left(const gn_run *run);

/* gn_run_stage_row evaluates the end of the stage after a row of the history, gn_run_stage_time
 * after a step; the end of the last stage ends the run. */
void gn_run_stage_row(gn_run *run);
void gn_run_stage_time(gn_run *run);
/* Ends the present stage at the request of a program, unless it has ended. */
void gn_run_end_stage(gn_run *run);
/* Enters the next stage, before a step, when the present one has ended, and skips stages without
 * steps. */
gneiss_status gn_run_stages_go(gn_run *run, bool *entered, gneiss_error *error);

/* Number of samples at which a stage with the end `held` compares a servo with its target. */
enum { GN_ROWS_HELD = 10 };
typedef struct gn_servo_row {
    double found, wanted;
} gn_servo_row;
gn_servo_row gn_run_wall_servo(const gn_run *run, size_t wall, size_t row);
gn_servo_row gn_run_side_servo(const gn_run *run, int axis, size_t row);

/* Returns the longest duration of the stage, s. */
double gn_run_stage_duration(const gn_run *run);
/* Returns the time to the latest end of the run, s. */
double gn_run_time_left(const gn_run *run);
/* Ends the run because time.end was reached, in any stage. */
void gn_run_out_of_time(gn_run *run);

/* Tells whether forces are in balance in the last row of `rows`: some contact carries a load,
 * nothing falls freely, the unbalanced force ratio is below `limit`, and there are at least 20
 * rows. With `limit` 0 the answer is no. */
bool gn_run_balanced(const gn_run *run, size_t rows, double limit);
/* Writes the reason as text: "unbalanced force ratio fell below 0.01". */
const char *gn_stage_reason(const gn_stage *stage, gn_stage_cause cause, char *text, size_t size);
/* Computes the readings of a stage from its rows alone; strain is counted from its start. */
gneiss_status gn_run_stage_readings(const gn_run *run, size_t stage, gn_readings *readings,
                                    gneiss_error *error);

#endif
