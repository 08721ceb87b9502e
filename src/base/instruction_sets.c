#include "base/instruction_sets.h"

#include <stddef.h>

const char *gn_isa_name(gn_isa isa) {
#define X(name) [GN_ISA_##name] = #name,
    static const char *const names[GN_ISA_COUNT] = {[GN_ISA_AUTO] = "auto",
                                                    GN_KNOWN_INSTRUCTION_SETS(X)};
#undef X
    return isa < GN_ISA_COUNT ? names[isa] : NULL;
}
