#include "kernels/law.h"

static const struct {
    gn_effects effect;
    const gn_law *law;
} laws[] = {
#define X(name, effect, lists) {effect, &gn_law_##name},
    GN_LAWS(X)
#undef X
};

const gn_law *gn_law_of(gn_effects effects) {
    size_t k = sizeof laws / sizeof *laws - 1;
    while (k > 0 && !(effects & laws[k].effect)) k--;
    return laws[k].law;
}
