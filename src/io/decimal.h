/* Numbers in text files. */
#ifndef GN_IO_DECIMAL_H
#define GN_IO_DECIMAL_H

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>

/* Tells whether a text has the form [+-] digits [. digits] [e [+-] digits]: strtod alone would
 * accept nan, inf and hexadecimal. */
static inline bool gn_is_decimal(const char *text, size_t length) {
    size_t k = length && (text[0] == '+' || text[0] == '-'), digits = 0;
    for (; k < length && isdigit((unsigned char)text[k]); k++) digits++;
    if (k < length && text[k] == '.')
        for (k++; k < length && isdigit((unsigned char)text[k]); k++) digits++;
    if (digits == 0) return false;
    if (k == length) return true;
    if (text[k] != 'e' && text[k] != 'E') return false;
    k++;
    if (k < length && (text[k] == '+' || text[k] == '-')) k++;
    if (k == length) return false;
    while (k < length && isdigit((unsigned char)text[k])) k++;
    return k == length;
}

#endif
