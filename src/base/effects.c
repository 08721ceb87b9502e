#include "base/effects.h"

#include <stdio.h>

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

const char *gn_effect_names(gn_effects effects, const char *between,
                            char text[GN_EFFECT_NAMES_SIZE]) {
    size_t used = 0;
    text[0] = '\0';
    for (int k = 0; k < GN_EFFECT_COUNT && used < GN_EFFECT_NAMES_SIZE; k++)
        if (effects >> k & 1)
            used += (size_t)snprintf(text + used, GN_EFFECT_NAMES_SIZE - used, "%s%s",
                                     used ? between : "", names[k]);
    return text;
}
