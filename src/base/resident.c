#include "base/resident.h"

#include <stdio.h>

/* getrusage does not serve: its peak includes that of the parent before the fork. */
bool gn_resident_read(gn_resident *resident) {
    char line[256];
    double peak = 0.0, now = 0.0;
    FILE *file = fopen("/proc/self/status", "r");
    if (!file) return false;
    while (fgets(line, sizeof line, file)) {
        (void)sscanf(line, "VmHWM: %lf", &peak);
        (void)sscanf(line, "VmRSS: %lf", &now);
    }
    fclose(file);
    *resident = (gn_resident){1024.0 * peak, 1024.0 * now};
    return peak > 0.0 && now > 0.0;
}
