/* The error budget of a finished run: the possible error of each of its readings, by cause. An
 * error is measured in the run if it shows there, and else estimated by the laws of the accuracy
 * study. */
#ifndef GN_RUN_BUDGET_H
#define GN_RUN_BUDGET_H

#include "accuracy/accuracy.h"
#include "frame/parts.h"
#include "io/h5.h"
#include "io/io.h"
#include "test_kinds/readings.h"
#include "world/world.h"

typedef struct gn_budget {
    char absent[GN_REASON_SIZE]; /* why there is no budget; "": there is one */
    double speed; /* speed of the test as defined by the accuracy laws, for this run */
    double imbalance,
        kinetic; /* imbalance of the ends; kinetic over elastic energy; NaN: not known */
    gn_error_causes of[GN_READING_COUNT]; /* count 0: there are no laws for this reading */
} gn_budget;

/* `readings` are those of the world and its history. The caller frees the budget with free(); it is
 * too large for a stack. */
gneiss_status gn_budget_create(const gn_world *world, const gn_history *history,
                               const gn_readings *readings, gn_budget **budget,
                               gneiss_error *error);

/* Writes "(packing 2.4 estimated, step 0.1 measured)" in the unit of `value`, the reading. */
const char *gn_budget_text(const gn_error_causes *causes, double value, char *text, size_t size);

void gn_budget_summary(const gn_budget *budget, const gn_readings *readings, gn_json *json);
/* Writes the budget as attributes of the group /readings, which exists already. */
gneiss_status gn_budget_results(const gn_budget *budget, const gn_readings *readings, gn_h5 *file,
                                gneiss_error *error);

#endif
