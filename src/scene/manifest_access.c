/* Interpretation of the tables of manifest.c: ranges, presence, words. */
#include "scene/manifest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

gn_range gn_range_read(const char *text) {
    gn_range range = {-INFINITY, INFINITY, true, true};
    if (!text) return range;
    char *rest;
    range.low_open = text[0] == '(';
    range.low = strtod(text + 1, &rest);
    range.high = strtod(rest + 1, &rest);
    range.high_open = rest[0] == ')';
    return range;
}

bool gn_range_holds(const char *text, double value) {
    gn_range range = gn_range_read(text);
    if (!isfinite(value)) return false;
    if (range.low_open ? value <= range.low : value < range.low) return false;
    return range.high_open ? value < range.high : value <= range.high;
}

bool gn_key_present(const gn_key *key, const void *base) {
    const char *at = (const char *)base + key->present_at;
    switch (key->presence) {
    case GN_PRESENT_ALWAYS:
        return true;
    case GN_PRESENT_BOOL:
        return *(const bool *)at;
    case GN_PRESENT_ENUM:
    case GN_PRESENT_BESIDE:
        return *(const uint32_t *)at != 0;
    case GN_PRESENT_SHAPE:
        return *(const gn_shape_kind *)at == key->shape;
    case GN_PRESENT_ROWS:
        return *(const size_t *)at != 0 ||
               *(const int64_t *)((const char *)base + key->number) != 0;
    case GN_PRESENT_AXIS:
        return *(const int64_t *)at >= 0;
    case GN_PRESENT_COUNT:
        return *(const size_t *)at != 0;
    case GN_PRESENT_NONE:
        return *(const size_t *)at == 0;
    case GN_PRESENT_TEXT:
        return *at != '\0';
    }
    return true;
}

size_t gn_key_element_size(const gn_key *key) {
    switch (key->type) {
    case GN_KEY_LIST:
        return key->section->size;
    case GN_KEY_PARTICLES:
        return 4 * sizeof(double);
    case GN_KEY_POINTS:
        return 2 * sizeof(double);
    case GN_KEY_IDS:
        return sizeof(int64_t);
    case GN_KEY_NAMES:
        return GN_NAME_SIZE;
    case GN_KEY_CHANGES:
        return 1;
    default:
        return 0;
    }
}

size_t gn_key_tables(const gn_key *key, void *base, gn_table **first) {
    const bool varies = key->type == GN_KEY_VECTOR && key->second;
    *first = (gn_table *)(void *)((char *)base + (varies ? key->second : key->offset));
    return varies ? 3 : key->type == GN_KEY_TABLE;
}

void gn_shape_names(int64_t dimension, char names[GN_SHAPE_NAMES_SIZE]) {
    names[0] = '\0';
    for (size_t k = 0; k < gn_specimen_section.key_count; k++) {
        const gn_key *key = &gn_specimen_section.keys[k];
        if (!key->shape || (key->shape_dimension && key->shape_dimension != dimension)) continue;
        size_t used = strlen(names);
        snprintf(names + used, GN_SHAPE_NAMES_SIZE - used, "%s%s", used ? ", " : "", key->name);
    }
}

int64_t gn_choice_load(const gn_key *key, const void *at) {
    if (key->size == sizeof(bool)) return *(const bool *)at;
    if (key->size == sizeof(int64_t)) return *(const int64_t *)at;
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return value;
}

void gn_choice_store(const gn_key *key, void *at, int64_t value) {
    uint32_t narrow = (uint32_t)value;
    if (key->size == sizeof(bool))
        *(bool *)at = value != 0;
    else if (key->size == sizeof(int64_t))
        *(int64_t *)at = value;
    else
        memcpy(at, &narrow, sizeof narrow);
}

const char *gn_choice_name(const gn_choice *choices, int64_t value) {
    for (; choices->name; choices++)
        if (choices->value == value) return choices->name;
    return "";
}

_Static_assert(sizeof(gn_stiffness_model) == 4 && sizeof(gn_switch) == 4 && sizeof(bool) == 1,
               "choices are stored by size");
