/* Checks of fields that files hold on request. */
#include "base/asked.h"
#include "base/names.h"
#include "scene/check.h"

#include <string.h>

#define X(name, needs, lacks) {#name, needs, lacks},
static const struct {
    const char *name;
    gn_effects needs;
    const char *lacks;
} fields[GN_ASKED_COUNT] = {GN_ASKED_FIELDS(X)};
#undef X

static int find(const char *name) {
    for (int k = 0; k < GN_ASKED_COUNT; k++)
        if (strcmp(fields[k].name, name) == 0) return k;
    return -1;
}

static gneiss_status unknown(const check *section, const char *name) {
    char advice[GN_ADVICE_SIZE];
    gn_names names = gn_names_for(name);
    for (int k = 0; k < GN_ASKED_COUNT; k++) gn_names_add(&names, fields[k].name);
    return gn_check_fail(section, "output.fields", "expected the name of a field, found '%s'%s",
                         name, gn_names_advice(&names, advice, sizeof advice));
}

gneiss_status gn_check_output(const check *section, gn_scene *scene) {
    scene->asked = 0;
    if (scene->contact_rows == GN_SWITCH_ON && !scene->has_specimen)
        return gn_check_fail(section, "output.contacts",
                             "expected a specimen beside it, whose particles have contacts, found "
                             "elements only");
    if (scene->field_count && !scene->has_specimen)
        return gn_check_fail(section, "output.fields",
                             "expected a specimen beside it, whose particles and bonds have them, "
                             "found elements only");
    for (size_t k = 0; k < scene->field_count; k++) {
        int f = find(scene->fields[k]);
        if (f < 0) return unknown(section, scene->fields[k]);
        if (scene->asked >> f & 1)
            return gn_check_fail(section, "output.fields",
                                 "expected every name once, found '%s' again", fields[f].name);
        scene->asked |= 1u << f;
    }
    return scene->stage_count ? GNEISS_OK : gn_check_requested_fields(section, scene);
}

gneiss_status gn_check_requested_fields(const check *section, const gn_scene *scene) {
    const gn_effects has = gn_scene_effects(scene);
    for (int f = 0; f < GN_ASKED_COUNT; f++)
        if (scene->asked >> f & 1 && (has & fields[f].needs) != fields[f].needs)
            return gn_check_fail(section, "output.fields", "expected %s beside '%s', found none%s",
                                 fields[f].lacks, fields[f].name,
                                 scene->stage_count ? " in any stage" : "");
    return GNEISS_OK;
}
