/* The error budget of a finished run: what each of its readings may be off by, cause by cause;
 * measured in the run where it tells, else estimated by the laws of the study of accuracy. */
#ifndef GN_RUN_BUDGET_H
#define GN_RUN_BUDGET_H

#include "accuracy/causes.h"
#include "frame/parts.h"
#include "io/files.h"
#include "io/h5.h"
#include "io/h5_private.h"
#include "test_kinds/readings.h"
#include "world/world.h"

typedef struct gn_budget {
    char absent[GN_REASON_SIZE]; /* why there is none; "": there is one */
    double speed;                /* the group of the velocity's law, as this run had it */
    double imbalance, kinetic;   /* of the ends; kinetic over elastic energy; NaN: not known */
    gn_error_causes of[GN_READING_COUNT]; /* count 0: none for this reading */
} gn_budget;

/* `readings`: of the world and its history. To be freed with free(): it is too large for a stack.
 */
gneiss_status gn_budget_create(const gn_world *world, const gn_history *history,
                               const gn_readings *readings, gn_budget **budget,
                               gneiss_error *error);

/* "(packing 2.4 estimated, step 0.1 measured)" in the unit of `value`, the reading. */
const char *gn_budget_text(const gn_error_causes *causes, double value, char *text, size_t size);

void gn_budget_summary(const gn_budget *budget, const gn_readings *readings, gn_json *json);
/* Attributes of /readings, which are there. */
gneiss_status gn_budget_results(const gn_budget *budget, const gn_readings *readings, gn_h5 *file,
                                gneiss_error *error);

#endif
