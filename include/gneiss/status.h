/* Status codes and messages of all parts of gneiss. */
#ifndef GNEISS_STATUS_H
#define GNEISS_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* Result of a call. The numbers are also the exit codes of the `gneiss` program. */
typedef enum gneiss_status {
    GNEISS_OK = 0,
    GNEISS_ERROR_INTERNAL = 1, /* a defect of gneiss itself */
    GNEISS_ERROR_INPUT = 2,    /* invalid scene, specimen, checkpoint or argument */
    GNEISS_ERROR_IO = 3,       /* a file could not be read or written (permission, disk full) */
    GNEISS_ERROR_MEMORY = 4,   /* not enough memory */
    GNEISS_ERROR_UNSTABLE = 5, /* the run became invalid: NaN, lost particle, step above its limit,
                                  an energy ledger that does not close */
    GNEISS_INTERRUPTED = 6 /* stopped by a signal after a checkpoint; `gneiss resume` continues; or
                              by a call of a program (gneiss_world_add_call) */
} gneiss_status;

enum { GNEISS_MESSAGE_SIZE = 2048 };

/* Filled by a call that fails, unchanged by one that succeeds. The caller owns it. The message is
 * one or more lines of plain text: the place (file:line:column), the expected and the found value.
 */
typedef struct gneiss_error {
    gneiss_status status;
    char message[GNEISS_MESSAGE_SIZE];
} gneiss_error;

#ifdef __cplusplus
}
#endif
#endif
