/* Outcome of a run, read from its folder, so that a sweep can be killed at any time. */
#ifndef GN_SWEEP_OUTCOME_H
#define GN_SWEEP_OUTCOME_H

#include "sweep/sweep.h"

typedef enum gn_run_state {
    GN_RUN_NEW,         /* nothing usable */
    GN_RUN_INTERRUPTED, /* a checkpoint to resume from */
    GN_RUN_DONE,
    GN_RUN_FAILED
} gn_run_state;

const char *gn_run_state_name(gn_run_state state);

enum { GN_OUTCOME_MESSAGE = 600 };

typedef struct gn_outcome {
    gn_run_state state;
    bool lost;     /* its results are damaged or of another run */
    bool replaced; /* its results are intact, but not those with which it ended: they and the
                      checkpoints in its folder come from other computations */
    int code;      /* exit code of the run; 128 + n: ended by signal n */
    char message[GN_OUTCOME_MESSAGE]; /* reason of failure; in a summary also warnings of a
                                         completed run */
} gn_outcome;

/* Writes DIRECTORY/<hash, 16 hex digits>; false: it is too long. */
bool gn_run_folder(const char *directory, uint64_t hash, char folder[GN_PATH_SIZE]);

/* Reads the outcome from outcome.json, else from the files of the run. An unreadable outcome.json
 * counts as missing, and so does that of a completed run whose results are missing, damaged, of
 * another run, or not those with which it ended: `lost` and the message state this. Checkpoints of
 * another run do not count. */
gneiss_status gn_outcome_read(const char *folder, gn_outcome *outcome, gneiss_error *error);
gneiss_status gn_outcome_write(const char *folder, const gn_outcome *outcome, gneiss_error *error);
/* Renames checkpoints of another run in the folder, as damaged ones are renamed. */
gneiss_status gn_outcome_rename_foreign(const char *folder, gneiss_error *error);
/* Removes outcome.json, and unreadable results. */
void gn_outcome_remove(const char *folder, bool lost);

/* True if the run would end the same way again, because it became invalid. The next sweep repeats
 * runs that failed for lack of memory or disk space or by a signal. */
bool gn_outcome_is_final(const gn_outcome *outcome);

#endif
