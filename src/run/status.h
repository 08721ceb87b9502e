/* status.json of an output folder: how far its run is. */
#ifndef GN_RUN_STATUS_H
#define GN_RUN_STATUS_H

#include "run/run.h"

/* Seconds from one status file to the next, and seconds without a new one after which a run counts
 * as lost. */
enum { GN_STATUS_EVERY = 5, GN_STATUS_LOST = 60 };

/* Replaces status.json in the folder of the run; a failure has no effect. `message`: of the error
 * that ended the run, "" without one. */
void gn_status_write(const gn_run *run, gneiss_status code, const char *message);

/* Returns the time at which a process began, in clock ticks of the kernel since boot; 0: there is
 * no such process. */
int64_t gn_process_start(int64_t pid);

/* Returns false if the folder has a status.json that gneiss did not write. */
bool gn_status_is_own(const char *directory);
void gn_status_path(const char *directory, char path[GN_PATH_SIZE + 32]);

#endif
