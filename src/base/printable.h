/* Sanitising text of foreign files before it is printed on a terminal. */
#ifndef GN_BASE_PRINTABLE_H
#define GN_BASE_PRINTABLE_H

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a text has Unicode control characters other than line breaks and tabs: C0, DEL and,
 * in UTF-8, C1 (0xc2 0x80 to 0xc2 0x9f), which a terminal interprets as commands, and characters
 * that reorder text, separate lines or are invisible (U+061C, U+200B, U+200E, U+200F, U+2028 to
 * U+202E, U+2060 to U+2069). */
bool gn_has_control(const char *text);
/* Replaces each byte of control characters by a question mark; returns `text`. */
char *gn_make_printable(char *text);

/* Writes a printable copy of `text` to `out`, truncated to `size`, and returns `out`. */
const char *gn_printable(const char *text, char *out, size_t size);

#endif
