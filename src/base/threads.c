#include "base/threads.h"

#include <omp.h>

int gn_threads_of(int64_t asked) {
    const int64_t limit = omp_get_thread_limit();
    int64_t threads = asked > 0 ? asked : omp_get_num_procs();
    if (threads > limit) threads = limit;
    return threads < GN_THREADS_MAX ? (int)threads : GN_THREADS_MAX;
}
