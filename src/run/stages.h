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

/* Tells whether a largest stress may be called a peak. While the pressure of a cell is applied,
 * platens are touched now and then, and that is not a peak of the deviator; neither are
 * fluctuations of the shear stress while a normal stress is applied: spheres without friction still
 * carry a tenth of it. */
bool gn_run_loaded(const gn_run *run, double peak);
/* Tells whether stages are left, or the last one has not reached the end that it specifies. */
bool gn_run_stages_left(const gn_run *run);

/* gn_run_stage_row evaluates the end of the stage after a row of the history, gn_run_stage_time
 * after a step; the end of the last stage ends the run. */
void gn_run_stage_row(gn_run *run);
void gn_run_stage_time(gn_run *run);
/* Ends the present stage because a program asks for it, unless it has ended. */
void gn_run_end_stage(gn_run *run);
/* Enters the next stage, before a step, when the present one has ended, and skips stages without
 * steps. */
gneiss_status gn_run_stages_go(gn_run *run, bool *entered, gneiss_error *error);

/* The force on the servo of a wall (N), or the stress on a pair of sides of a periodic box (Pa), in
 * a row, and its target. A stage with the end `held` evaluates this number of samples. */
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

/* Tells whether the last row of `rows` shows forces in balance to a ratio: some contact carries a
 * load, nothing falls freely, and the unbalanced force ratio is below the limit, after 20 rows.
 * Limit 0: false. */
bool gn_run_balanced(const gn_run *run, size_t rows, double limit);
/* Writes the reason as text: "unbalanced force ratio fell below 0.01". */
const char *gn_stage_reason(const gn_stage *stage, gn_stage_cause cause, char *text, size_t size);
/* Computes the readings of a stage from its rows alone; strain is counted from its start. */
gneiss_status gn_run_stage_readings(const gn_run *run, size_t stage, gn_readings *readings,
                                    gneiss_error *error);

#endif
