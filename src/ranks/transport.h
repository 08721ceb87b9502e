/* Messages between the processes (ranks) of one run. The engine calls the functions of a transport;
 * src/ranks/mpi.c has those of MPI, which only the program gneiss-mpi contains. Without a transport
 * the process is alone. A transport does not return after an error: it ends all processes. */
#ifndef GN_RANKS_TRANSPORT_H
#define GN_RANKS_TRANSPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One message of a step, in a buffer that stays in place. */
typedef struct gn_message {
    int peer; /* the other rank */
    void *bytes;
    size_t size;
} gn_message;

/* Messages that begin and end together and are repeated in every step (persistent requests). */
typedef struct gn_messages gn_messages;

typedef enum gn_way { GN_SENT, GN_RECEIVED } gn_way;

typedef struct gn_transport {
    int rank, count;
    /* Every rank has bytes [first[rank], first[rank + 1]) of `data`; afterwards each has all. */
    void (*gather)(void *data, const size_t *first);
    /* Replaces each of `count` integers by the largest of all ranks. */
    void (*most)(int64_t *value, int count);
    /* `tag` tells groups between the same two ranks apart. NULL: no memory. */
    gn_messages *(*open)(const gn_message *message, size_t count, gn_way way, int tag);
    void (*begin)(gn_messages *messages);
    void (*end)(gn_messages *messages);
    void (*close)(gn_messages *messages);
} gn_transport;

/* Returns the transport of this process, which the program sets before anything else; NULL: the
 * process is alone. */
const gn_transport *gn_transport_now(void);
void gn_transport_set(const gn_transport *transport);

/* Tells whether this process writes the files of the run: rank 0, or the only one. */
bool gn_rank_writes(void);

#endif
