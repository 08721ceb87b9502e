/* Texts of files that others wrote, on their way to a terminal. */
#ifndef GN_BASE_PRINTABLE_H
#define GN_BASE_PRINTABLE_H

#include <stdbool.h>

/* Whether a text has control characters of Unicode besides line breaks and tabs: C0, DEL and, in
 * UTF-8, C1 (0xc2 0x80 to 0xc2 0x9f). A terminal takes them for commands. */
bool gn_has_control(const char *text);
/* Puts a question mark in the place of each byte of theirs; returns `text`. */
char *gn_make_printable(char *text);

#endif
