/* Start and end of a program that may be one of several ranks. gneiss is linked with alone.c,
 * gneiss-mpi with mpi.c; everything else of the two is the same. */
#ifndef GN_RANKS_PROGRAM_H
#define GN_RANKS_PROGRAM_H

/* Joins the other ranks and sets the transport. Ranks other than 0 print nothing from here on. */
void gn_program_begin(int *argc, char ***argv);

/* Leaves the other ranks, before the process exits with `code`. With a code other than 0 all ranks
 * end, and the function does not return: rank 0 has printed its message. Another rank waits for the
 * end by rank 0, which has usually failed in the same way, and prints `message` if that does not
 * come; at once if it lacks memory or a disk. */
void gn_program_end(int code, const char *message);

#endif
