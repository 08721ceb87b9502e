/* What Ctrl-C, SIGTERM and a lost terminal do. What the caller ignores (nohup) stays ignored. */
#ifndef GN_CLI_SIGNALS_H
#define GN_CLI_SIGNALS_H

#include <signal.h>

/* While there is nothing to save (reading, meshing, packing, the first lists) a signal ends the
 * program at once, wherever it is: `message` on standard error, exit code 6. `folder` (may be NULL)
 * is removed if it is still empty. Both must stay as they are until the next call. */
void gn_signals_end_at_once(const char *message, const char *folder);

/* From here on there is something to save: a signal only sets the flag, which is looked at between
 * steps; a second one ends the program. */
const volatile sig_atomic_t *gn_signals_set_flag(void);

#endif
