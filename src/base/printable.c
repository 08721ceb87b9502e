#include "base/printable.h"

#include <stdio.h>

/* Recognises U+200B, U+200E, U+200F, U+2028 to U+202E and U+2060 to U+2069 by the two bytes after
 * 0xe2; these characters reorder text, break lines or are invisible. Joiners (U+200C, U+200D) are
 * parts of words. */
static bool is_format(unsigned char second, unsigned char third) {
    if (second == 0x81) return third >= 0xa0 && third <= 0xa9;
    if (second != 0x80) return false;
    return third == 0x8b || third == 0x8e || third == 0x8f || (third >= 0xa8 && third <= 0xae);
}

/* Returns the length in bytes of the control character that begins here; 0: there is none. */
static size_t control_length(const unsigned char *c) {
    if (*c == '\n' || *c == '\t') return 0;
    if (*c < 0x20 || *c == 0x7f) return 1;
    if (*c == 0xc2) return c[1] >= 0x80 && c[1] < 0xa0 ? 2 : 0;
    if (*c == 0xd8) return c[1] == 0x9c ? 2 : 0; /* U+061C */
    return *c == 0xe2 && c[1] && is_format(c[1], c[2]) ? 3 : 0;
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

const char *gn_printable(const char *text, char *out, size_t size) {
    snprintf(out, size, "%s", text);
    return gn_make_printable(out);
}
