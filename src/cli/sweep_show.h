/* Output of a sweep. */
#ifndef GN_CLI_SWEEP_SHOW_H
#define GN_CLI_SWEEP_SHOW_H

#include "cli/options.h"
#include "sweep/summary.h"
#include "sweep/work.h"

typedef struct gn_sweep_display {
    const gn_options *options;
    const gn_sweep *sweep;
    bool shown;  /* a line is on the terminal */
    double next; /* time of the next line, by gn_now() */
} gn_sweep_display;

/* Prints the plan of the sweep and from then on its progress: one line on a terminal, otherwise a
 * line for every run, or JSON lines on standard output. */
void gn_sweep_display_begin(gn_sweep_display *display, const gn_options *options,
                            const gn_sweep *sweep, gn_sweep_way *way);
void gn_sweep_display_end(gn_sweep_display *display);

void gn_sweep_print_summary(const gn_options *options, const gn_summary *summary);

/* Prints every run with its state and its seconds, NaN if unknown. */
void gn_sweep_print_plan(const gn_sweep *sweep, const gn_summary *summary, const gn_sweep_way *way,
                         const double *seconds);

#endif
