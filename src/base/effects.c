#include "base/effects.h"

static const char *const names[] = {
#define X(NAME, name, text) #name,
    GN_EFFECTS(X)
#undef X
};

static const char *const texts[] = {
#define X(NAME, name, text) text,
    GN_EFFECTS(X)
#undef X
};

const char *gn_effect_name(gn_effect_index index) {
    return names[index];
}
const char *gn_effect_text(gn_effect_index index) {
    return texts[index];
}
