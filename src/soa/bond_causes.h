/* Causes of a bond beside those of gn_cause (records.h); files number them alike, and have 4 and 5
 * for bonds that hold. */
#ifndef GN_SOA_BOND_CAUSES_H
#define GN_SOA_BOND_CAUSES_H

enum {
    GN_BOND_DISSOLVED = 6, /* by a stage */
    GN_BOND_NEVER = 7      /* no bond: an overlap of the start that is free of stress */
};

#endif
