#include "base/printable.h"

#include <stddef.h>

/* Bytes of the control character that begins here; 0: none does. */
static size_t control_length(const unsigned char *c) {
    if (*c == '\n' || *c == '\t') return 0;
    if (*c < 0x20 || *c == 0x7f) return 1;
    return *c == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0 ? 2 : 0;
}

bool gn_has_control(const char *text) {
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (control_length(c)) return true;
    return false;
}

char *gn_make_printable(char *text) {
    for (unsigned char *c = (unsigned char *)text; *c; c++)
        for (size_t left = control_length(c); left; left--, c += left > 0) *c = '?';
    return text;
}
