/* A program that is one of several ranks of MPI, and their messages. Errors of MPI end all ranks
 * (MPI_ERRORS_ARE_FATAL, the default). The first thread alone calls MPI. */
#include "ranks/program.h"
#include "ranks/transport.h"

#include "base/error.h"
#include "base/memory.h"

#include "base/memory.h"

#include <fcntl.h>
#include <limits.h>
#include <mpi.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static gn_transport transport;

struct gn_messages {
    int count;
    MPI_Request request[];
};

/* Waits for requests. MPI itself would only spin; on a machine with other load the rank that is
 * waited for may need this core. */
static void finish(int count, MPI_Request *request) {
    enum { SPINS = 200, YIELDS = 200, PAUSE = 20 };
    int done = 0;
    for (int k = 0; !done; k++) {
        MPI_Testall(count, request, &done, MPI_STATUSES_IGNORE);
        if (done || k < SPINS) continue;
        if (k < SPINS + YIELDS)
            (void)sched_yield();
        else
            (void)usleep(PAUSE);
    }
}

/* Arrays are sent in pieces of less than 2 GB, as lengths are of type int. */
static void send_from(int root, unsigned char *bytes, size_t size) {
    enum { PIECE = 1 << 30 };
    for (size_t at = 0; at < size; at += PIECE)
        MPI_Bcast(bytes + at, (int)(size - at < PIECE ? size - at : PIECE), MPI_BYTE, root,
                  MPI_COMM_WORLD);
}

static void gather_large(unsigned char *bytes, const size_t *first) {
    for (int k = 0; k < transport.count; k++)
        send_from(k, bytes + first[k], first[k + 1] - first[k]);
}

static void gather(void *data, const size_t *first) {
    static int *length; /* [2][count] */
    const size_t count = (size_t)transport.count;
    MPI_Request request;
    if (first[count] > INT_MAX) {
        gather_large(data, first);
        return;
    }
    if (!length) length = calloc(2 * count, sizeof *length);
    if (!length) MPI_Abort(MPI_COMM_WORLD, GNEISS_ERROR_MEMORY);
    int *place = length + count;
    for (size_t k = 0; k < count; k++) {
        length[k] = (int)(first[k + 1] - first[k]);
        place[k] = (int)first[k];
    }
    MPI_Iallgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, data, length, place, MPI_BYTE,
                    MPI_COMM_WORLD, &request);
    finish(1, &request);
}

static void most(int64_t *value, int count) {
    MPI_Request request;
    MPI_Iallreduce(MPI_IN_PLACE, value, count, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD, &request);
    finish(1, &request);
}

static void open_one(const gn_message *m, gn_way way, int tag, MPI_Request *request) {
    if (m->size > INT_MAX) MPI_Abort(MPI_COMM_WORLD, GNEISS_ERROR_MEMORY);
    if (way == GN_SENT)
        MPI_Send_init(m->bytes, (int)m->size, MPI_BYTE, m->peer, tag, MPI_COMM_WORLD, request);
    else
        MPI_Recv_init(m->bytes, (int)m->size, MPI_BYTE, m->peer, tag, MPI_COMM_WORLD, request);
}

static gn_messages *open_messages(const gn_message *message, size_t count, gn_way way, int tag) {
    gn_messages *group = gn_alloc(sizeof *group + count * sizeof *group->request);
    if (!group) return NULL;
    group->count = (int)count;
    for (size_t k = 0; k < count; k++) open_one(&message[k], way, tag, &group->request[k]);
    return group;
}

static void begin_messages(gn_messages *group) {
    if (group->count) MPI_Startall(group->count, group->request);
}

static void end_messages(gn_messages *group) {
    if (group->count) finish(group->count, group->request);
}

static void close_messages(gn_messages *group) {
    for (int k = 0; k < group->count; k++) MPI_Request_free(&group->request[k]);
    gn_free(group);
}

/* --- the program --- */

static FILE *errors; /* standard error of a rank that prints nothing else */

/* The ends of the pipes to mpirun stay open: mpirun 4.1.4 may crash after one was closed. */
static void be_silent(void) {
    (void)dup(STDOUT_FILENO);
    const int copy = dup(STDERR_FILENO), none = open("/dev/null", O_WRONLY);
    errors = copy >= 0 ? fdopen(copy, "w") : NULL;
    if (none < 0) return;
    (void)dup2(none, STDOUT_FILENO);
    (void)dup2(none, STDERR_FILENO);
    (void)close(none);
}

void gn_program_begin(int *argc, char ***argv) {
    int given = 0;
    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &given);
    transport = (gn_transport){.gather = gather,
                               .most = most,
                               .open = open_messages,
                               .begin = begin_messages,
                               .end = end_messages,
                               .close = close_messages};
    MPI_Comm_rank(MPI_COMM_WORLD, &transport.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &transport.count);
    gn_transport_set(&transport);
    if (transport.rank > 0) be_silent();
}

void gn_program_end(int code, const char *message) {
    enum { PATIENCE = 20 };
    const bool alone = code == GNEISS_ERROR_MEMORY || code == GNEISS_ERROR_IO;
    if (code != 0) {
        (void)fflush(NULL);
        (void)signal(SIGTERM, SIG_DFL); /* by which the end of rank 0 ends the others */
        if (transport.rank > 0 && !alone) (void)sleep(PATIENCE);
        if (transport.rank > 0 && errors) {
            fprintf(errors, "gneiss: rank %d: %s\n", transport.rank, message);
            (void)fflush(errors);
        }
        MPI_Abort(MPI_COMM_WORLD, code);
    }
    MPI_Finalize();
}
