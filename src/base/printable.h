/* Texts of files that others wrote, on their way to a terminal. */
#ifndef GN_BASE_PRINTABLE_H
#define GN_BASE_PRINTABLE_H

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a text has control characters of Unicode besides line breaks and tabs: C0, DEL and,
 * in UTF-8, C1 (0xc2 0x80 to 0xc2 0x9f), which a terminal takes for commands, and those that
 * reorder text, separate lines or are invisible (U+061C, U+200B, U+200E, U+200F, U+2028 to U+202E,
 * U+2060 to U+2069). */
bool gn_has_control(const char *text);
/* Puts a question mark in the place of each byte of theirs; returns `text`. */
char *gn_make_printable(char *text);

/* A printable copy of `text` in `out`, cut where it is longer. */
const char *gn_printable(const char *text, char *out, size_t size);

#endif
