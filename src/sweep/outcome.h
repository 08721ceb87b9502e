/* What became of a run: its folder tells, so that a sweep can be killed at any time. */
#ifndef GN_SWEEP_OUTCOME_H
#define GN_SWEEP_OUTCOME_H

#include "sweep/sweep.h"

typedef enum gn_run_state {
    GN_RUN_NEW,         /* nothing that could be used */
    GN_RUN_INTERRUPTED, /* a checkpoint to go on from */
    GN_RUN_DONE,
    GN_RUN_FAILED
} gn_run_state;

const char *gn_run_state_name(gn_run_state state);

enum { GN_OUTCOME_MESSAGE = 600 };

typedef struct gn_outcome {
    gn_run_state state;
    bool lost;     /* what it left is damaged or of another run */
    bool replaced; /* its results are whole, but not those that it ended with: what is in its folder
                      was computed otherwise, checkpoints as well */
    int code;      /* exit code of the run; 128 + n: ended by signal n */
    char message[GN_OUTCOME_MESSAGE]; /* why it failed; in a summary also warnings of one that is
                                         done */
} gn_outcome;

/* DIRECTORY/<hash, 16 hex digits>; false: it is too long. */
bool gn_run_folder(const char *directory, uint64_t hash, char folder[GN_PATH_SIZE]);

/* From outcome.json, else from what the run left. An outcome.json that cannot be read counts as
 * none, and so does that of a run that is done but whose results are not there, are damaged
 * anywhere, are not those that it ended with or are those of another run: `lost` and the message
 * say so. Checkpoints of another run count as none. */
gneiss_status gn_outcome_read(const char *folder, gn_outcome *outcome, gneiss_error *error);
gneiss_status gn_outcome_write(const char *folder, const gn_outcome *outcome, gneiss_error *error);
/* Renames checkpoints of another run in the folder, as damaged ones are. */
gneiss_status gn_outcome_set_aside(const char *folder, gneiss_error *error);
/* Takes outcome.json away, and results that cannot be read. */
void gn_outcome_forget(const char *folder, bool lost);

/* A run that would end the same way again: it went bad. What failed for want of memory, disk space
 * or by a signal is tried again by the next sweep. */
bool gn_outcome_stands(const gn_outcome *outcome);

#endif
