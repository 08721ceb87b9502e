#include "base/names.h"

#include <stdio.h>
#include <string.h>

/* Returns the optimal string alignment distance of two names (Levenshtein with transpositions). */
static size_t edit_distance(const char *a, const char *b) {
    enum { LIMIT = 32 };
    size_t rows[3][LIMIT + 1], la = strlen(a), lb = strlen(b);
    if (la > LIMIT || lb > LIMIT) return LIMIT;
    size_t *before = rows[0], *last = rows[1], *now = rows[2];
    for (size_t j = 0; j <= lb; j++) last[j] = j;
    for (size_t i = 1; i <= la; i++) {
        now[0] = i;
        for (size_t j = 1; j <= lb; j++) {
            size_t best = last[j - 1] + (a[i - 1] != b[j - 1]);
            if (last[j] + 1 < best) best = last[j] + 1;
            if (now[j - 1] + 1 < best) best = now[j - 1] + 1;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                before[j - 2] + 1 < best)
                best = before[j - 2] + 1;
            now[j] = best;
        }
        size_t *spare = before;
        before = last;
        last = now;
        now = spare;
    }
    return last[lb];
}

gn_names gn_names_for(const char *wanted) {
    return (gn_names){.wanted = wanted, .least = strlen(wanted) / 3 + 2};
}

void gn_names_add(gn_names *names, const char *name) {
    static const char more[] = ", ...";
    size_t distance = edit_distance(names->wanted, name), used = strlen(names->known);
    if (distance < names->least && distance < strlen(name)) {
        names->least = distance;
        names->nearest = name;
    }
    if (used + strlen(name) + 2 + sizeof more <= sizeof names->known)
        snprintf(names->known + used, sizeof names->known - used, "%s%s", used ? ", " : "", name);
    else if (!strstr(names->known, more))
        memcpy(names->known + used, more, sizeof more);
}

const char *gn_names_advice(const gn_names *names, char *text, size_t size) {
    if (names->nearest)
        snprintf(text, size, "; did you mean '%s'?", names->nearest);
    else if (names->known[0])
        snprintf(text, size, "; there %s %s", strchr(names->known, ',') ? "are" : "is",
                 names->known);
    else
        snprintf(text, size, "; there is none");
    return text;
}
