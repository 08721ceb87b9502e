#include "base/threads.h"

#include "base/resident.h"

#include <omp.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/resource.h>

int gn_threads_of(int64_t asked) {
    const int64_t limit = omp_get_thread_limit();
    int64_t threads = asked > 0 ? asked : omp_get_num_procs();
    if (threads > limit) threads = limit;
    return threads < GN_THREADS_MAX ? (int)threads : GN_THREADS_MAX;
}

static void *pass(void *gate) {
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

static bool has_memory_for_stack(void) {
    struct rlimit stack;
    const size_t least = (size_t)2 << 20; /* smallest stack of glibc, used if there is no limit */
    if (getrlimit(RLIMIT_STACK, &stack) != 0) return true;
    return gn_memory_is_left(stack.rlim_cur == RLIM_INFINITY ? least : (size_t)stack.rlim_cur);
}

/* Returns the number of threads, up to `wanted`, that can exist at once; `memory`: there was enough
 * memory for one more. */
static int create_and_join(int wanted, pthread_t *list, bool *memory) {
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    int count = 0;
    pthread_mutex_lock(&gate);
    while (count < wanted && pthread_create(&list[count], NULL, pass, &gate) == 0) count++;
    *memory = count == wanted || has_memory_for_stack();
    pthread_mutex_unlock(&gate);
    for (int k = 0; k < count; k++) pthread_join(list[k], NULL);
    return count;
}

gneiss_status gn_threads_find(int64_t asked, int *threads, gneiss_error *error) {
    gn_resident process = {.threads = 1};
    (void)gn_resident_read(&process);
    /* Threads of earlier parallel regions exist already and wait for the next one. */
    const int before = process.threads, most = gn_threads_of(asked), wanted = most - before;
    *threads = most;
    if (wanted <= 0) return GNEISS_OK;
    pthread_t *list = calloc((size_t)wanted, sizeof *list);
    if (!list) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %d threads", most);
    bool memory;
    *threads = before + create_and_join(wanted, list, &memory);
    free(list);
    if (*threads == most || asked == 0) return GNEISS_OK;
    if (!memory)
        return gn_fail(error, GNEISS_ERROR_MEMORY,
                       "no memory for the stacks of %d threads, only for those of %d: give fewer "
                       "by --threads or run.threads",
                       most, *threads);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected at most %d threads, which is what the system lets this process have, "
                   "found %d: give fewer by --threads or run.threads",
                   *threads, most);
}
