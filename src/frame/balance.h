/* Imbalance of forces over all parts of a world. */
#ifndef GN_FRAME_BALANCE_H
#define GN_FRAME_BALANCE_H

#include <stdbool.h>

/* Largest reported ratio; bodies that fall and hardly touch have larger ones. */
#define GN_UNBALANCED_MOST 1000.0

/* Balance of forces. Every part adds its values; particles come first, because the others use their
 * mean contact force. */
typedef struct gn_balance {
    double ratio; /* mean resultant over mean contact force, the largest value of any part */
    double force; /* N, mean over contacts that carry load; 0: no contact does */
    bool carries; /* a contact carries load, or elements are stressed */
    bool falls;   /* some object accelerates without any contact that could support it */
} gn_balance;

#endif
