/* Reactions to Ctrl-C, SIGTERM and a lost terminal. Signals that the caller ignores (nohup) stay
 * ignored. */
#ifndef GN_CLI_SIGNALS_H
#define GN_CLI_SIGNALS_H

#include <signal.h>

/* For the time before there are results to save (reading, meshing, packing, the first lists): a
 * signal ends the program immediately; it prints `message` on standard error and exits with code 6.
 * `folder` (may be NULL) is removed if it is still empty. Both must stay valid until the next call.
 */
void gn_signals_end_at_once(const char *message, const char *folder);

/* After this call the first signal only sets the flag, which a run reads between steps; a second
 * signal ends the program. */
const volatile sig_atomic_t *gn_signals_set_flag(void);

#endif
