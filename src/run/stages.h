/* Stages of a run (scene/stages.h): when one ends, and the next begins. */
#ifndef GN_RUN_STAGES_H
#define GN_RUN_STAGES_H

#include "run/run.h"
#include "scene/stages.h"

/* What ended a stage; gn_stage_state.ended. */
typedef enum gn_stage_cause {
    GN_STAGE_RUNS,
    GN_STAGE_TIME,
    GN_STAGE_STEPS,
    GN_STAGE_STRAIN,
    GN_STAGE_STRESS,
    GN_STAGE_PEAK_DROP,
    GN_STAGE_UNBALANCED,
    GN_STAGE_HELD,
    GN_STAGE_PRESSED
} gn_stage_cause;

bool gn_run_staged(const gn_run *run);

/* Whether a largest stress may be called a peak: while a cell's pressure comes and rests, platens
 * are touched now and then, and that is none of a deviator; nor is what wobbles while a normal
 * stress comes a shear stress: spheres without friction still bear a tenth of it. */
bool gn_run_loaded(const gn_run *run, double peak);
/* Whether stages are left, or the last one did not come to the end that it names. */
bool gn_run_stages_left(const gn_run *run);

/* After a row of the history, after a step: whether the stage is over; with the last one the run
 * is. */
void gn_run_stage_row(gn_run *run);
void gn_run_stage_time(gn_run *run);
/* Before a step: goes on to the next stage when one is over, past those of no steps. */
gneiss_status gn_run_stages_go(gn_run *run, bool *entered, gneiss_error *error);

/* What the servo of a wall (N), or of a pair of sides of a periodic box (Pa), found in a row and
 * what it was to hold; a stage whose end is `held` looks at so many. */
enum { GN_ROWS_HELD = 10 };
typedef struct gn_servo_row {
    double found, wanted;
} gn_servo_row;
gn_servo_row gn_run_wall_servo(const gn_run *run, size_t wall, size_t row);
gn_servo_row gn_run_side_servo(const gn_run *run, int axis, size_t row);

/* s: the most that the stage may last. */
double gn_run_stage_duration(const gn_run *run);
/* s to the end of the run, at most. */
double gn_run_time_left(const gn_run *run);
/* time.end ends the run, in whichever stage. */
void gn_run_out_of_time(gn_run *run);

/* Tells whether the last row of `rows` shows forces in balance to a ratio: some contact carries,
 * nothing falls freely, and the unbalanced force ratio is below the limit, after 20 rows. 0: no
 * limit. */
bool gn_run_balanced(const gn_run *run, size_t rows, double limit);
/* "unbalanced force ratio fell below 0.01" */
const char *gn_stage_reason(const gn_stage *e, gn_stage_cause cause, char *text, size_t size);
/* Of its rows alone, strain counted from its start. */
gneiss_status gn_run_stage_readings(const gn_run *run, size_t stage, gn_readings *readings,
                                    gneiss_error *error);

#endif
