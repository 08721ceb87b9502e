/* Causes of a bond in addition to those of gn_cause (records.h). Files use the same numbers, and 4
 * and 5 for intact bonds. */
#ifndef GN_SOA_BOND_CAUSES_H
#define GN_SOA_BOND_CAUSES_H

enum {
    GN_BOND_DISSOLVED = 6, /* dissolved by a stage */
    GN_BOND_NEVER = 7      /* never bonded: an initial overlap that is free of stress */
};

#endif
