#include "base/resident.h"

#include <stdio.h>
#include <sys/mman.h>

/* getrusage is not suitable: its peak includes that of the parent before the fork. */
bool gn_resident_read(gn_resident *resident) {
    char line[256];
    double peak = 0.0, now = 0.0;
    int threads = 1;
    FILE *file = fopen("/proc/self/status", "r");
    if (!file) return false;
    while (fgets(line, sizeof line, file)) {
        (void)sscanf(line, "VmHWM: %lf", &peak);
        (void)sscanf(line, "VmRSS: %lf", &now);
        (void)sscanf(line, "Threads: %d", &threads);
    }
    fclose(file);
    if (!(peak > 0.0 && now > 0.0)) return false;
    *resident = (gn_resident){1024.0 * peak, 1024.0 * now, threads};
    return true;
}

/* The test does not use malloc: freeing a large block changes the size from which glibc maps blocks
 * separately. */
bool gn_memory_is_left(size_t bytes) {
    void *block = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED) return false;
    (void)munmap(block, bytes);
    return true;
}
