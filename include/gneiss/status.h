/* Status codes and messages that cross every boundary of gneiss. */
#ifndef GNEISS_STATUS_H
#define GNEISS_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* What a call came to. The numbers are also the exit codes of the `gneiss` program. */
typedef enum gneiss_status {
    GNEISS_OK = 0,
    GNEISS_ERROR_INTERNAL = 1, /* a defect of gneiss itself */
    GNEISS_ERROR_INPUT = 2,    /* scene, specimen, checkpoint or argument cannot be used */
    GNEISS_ERROR_IO = 3,       /* a file could not be read or written (permission, disk full) */
    GNEISS_ERROR_MEMORY = 4,   /* not enough memory */
    GNEISS_ERROR_UNSTABLE = 5, /* the run went bad: NaN, lost particle, step above its limit,
                                  an energy ledger that does not close */
    GNEISS_INTERRUPTED = 6     /* stopped by a signal after a checkpoint; `gneiss resume` goes on */
} gneiss_status;

enum { GNEISS_MESSAGE_SIZE = 2048 };

/* Filled by a call that fails; untouched by one that succeeds. The caller owns it. The message is
 * one line or more of plain text: where (file:line:column), what was expected and what was found.
 */
typedef struct gneiss_error {
    gneiss_status status;
    char message[GNEISS_MESSAGE_SIZE];
} gneiss_error;

#ifdef __cplusplus
}
#endif
#endif
