/* status.json of an output folder: how far its run is. */
#ifndef GN_RUN_STATUS_H
#define GN_RUN_STATUS_H

#include "run/run.h"

/* Seconds between two files during a run, and until a run that writes none counts as lost. */
enum { GN_STATUS_EVERY = 5, GN_STATUS_LOST = 60 };

/* Replaces status.json in the folder of the run; a failure has no effect. `message`: of the error
 * that ended the run, "" without one. */
void gn_status_write(const gn_run *run, gneiss_status code, const char *message);

/* Returns the time at which a process began, in units of the kernel since it started; 0: there is
 * no such process. */
int64_t gn_process_start(int64_t pid);

/* False: there is a file status.json that gneiss did not write. */
bool gn_status_is_own(const char *directory);
void gn_status_path(const char *directory, char path[GN_PATH_SIZE + 32]);

#endif
