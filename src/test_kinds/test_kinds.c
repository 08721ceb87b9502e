/* The table of the kinds of tests. */
#include "test_kinds/curves.h"

#include <stdio.h>

static const gn_test_descriptor none = {
    .name = "none",
    .sign = -1,
    .shape = gn_test_prism,
    .area_source = "",
    .readings = GN_READS_PEAK | GN_READS_PRISM | GN_READS(end_imbalance),
};

#define X(NAME, name, text) extern const gn_test_descriptor gn_test_##name;
GN_TEST_KIND_LIST(X)
#undef X

#define X(NAME, name, text) [GN_TEST_##NAME] = &gn_test_##name,
const gn_test_descriptor *const gn_test_kinds[GN_TEST_KINDS] = {&none, GN_TEST_KIND_LIST(X)};
#undef X

_Static_assert(GN_READING_COUNT <= 128, "sets of readings have 128 bits");
_Static_assert(GN_TEST_KEY_COUNT <= 32, "sets of keys have 32 bits");
_Static_assert(GN_TEST_KINDS <= 32, "sets of kinds have 32 bits");

const char *gn_test_names(unsigned kinds, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (unsigned k = 0; k < GN_TEST_KINDS && used < size; k++) {
        if (!(kinds >> k & 1)) continue;
        const char *between = !used ? "" : kinds >> k > 1 ? ", " : " and ";
        int more = snprintf(text + used, size - used, "%s%s", between, gn_test_kinds[k]->name);
        used += more > 0 ? (size_t)more : 0;
    }
    return text;
}

gn_tested_shape gn_test_prism(const gn_test_sizes *given, const gn_tested_specimen *specimen) {
    const bool known = given->area > 0.0 || given->diameter > 0.0;
    return (gn_tested_shape){.length = specimen->length,
                             .area = specimen->section,
                             .section = specimen->section,
                             .volume = known ? specimen->height * specimen->section : 0.0};
}
