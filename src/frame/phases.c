#include "frame/phases.h"

static const char *const phase_names[] = {
#define X(name, text) #name,
    GN_PHASES(X)
#undef X
};
static const char *const phase_texts[] = {
#define X(name, text) text,
    GN_PHASES(X)
#undef X
};

const char *gn_phase_name(gn_phase phase) {
    return phase_names[phase];
}
const char *gn_phase_text(gn_phase phase) {
    return phase_texts[phase];
}
