/* What a sweep prints. */
#ifndef GN_CLI_SWEEP_SHOW_H
#define GN_CLI_SWEEP_SHOW_H

#include "cli/options.h"
#include "sweep/summary.h"
#include "sweep/work.h"

typedef struct gn_sweep_display {
    const gn_options *options;
    const gn_sweep *sweep;
    bool shown;  /* a line stands on the terminal */
    double next; /* gn_now() of the next line */
} gn_sweep_display;

/* Says what will be done, and from then on what is; one line on a terminal, a line for every run
 * where there is none, JSON lines on standard output. */
void gn_sweep_display_begin(gn_sweep_display *display, const gn_options *options,
                            const gn_sweep *sweep, gn_sweep_way *way);
void gn_sweep_display_end(gn_sweep_display *display);

void gn_sweep_print_summary(const gn_options *options, const gn_summary *summary);

/* Every run with its state and its seconds, NaN where they are not known. */
void gn_sweep_print_plan(const gn_sweep *sweep, const gn_summary *summary, const gn_sweep_way *way,
                         const double *seconds);

#endif
