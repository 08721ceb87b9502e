/* How the tables of keys are written: private to the files that hold them. */
#ifndef GN_SCENE_MANIFEST_KEYS_H
#define GN_SCENE_MANIFEST_KEYS_H

#include "scene/manifest.h"

/* A key TYPE called NAME for FIELD of STRUCT. */
#define KEY(NAME, TYPE, STRUCT, FIELD, ...)                                                        \
    {                                                                                              \
        .name = NAME, .type = GN_KEY_##TYPE, .offset = offsetof(STRUCT, FIELD),                    \
        .size = sizeof(((STRUCT *)0)->FIELD), __VA_ARGS__                                          \
    }
/* An array of which FIELD points to the first element and COUNT is the number. */
#define ARRAY(NAME, TYPE, STRUCT, FIELD, COUNT, ...)                                               \
    KEY(NAME, TYPE, STRUCT, FIELD, .second = offsetof(STRUCT, COUNT), __VA_ARGS__)
/* Keys one level down whose fields lie in the same struct. */
#define SECTION(NAME, TABLE, ...)                                                                  \
    { .name = NAME, .type = GN_KEY_SECTION, .section = &TABLE, __VA_ARGS__ }
#define PRESENT(KIND, STRUCT, FIELD)                                                               \
    .presence = GN_PRESENT_##KIND, .present_at = offsetof(STRUCT, FIELD)
/* One of the bodies that can be packed. */
#define SHAPE(KIND, DIMENSION)                                                                     \
    .shape = GN_SHAPE_##KIND, .shape_dimension = (DIMENSION),                                      \
    PRESENT(SHAPE, gn_scene, specimen.pack.shape)
#define TABLE_OF(NAME)                                                                             \
    static const gn_section NAME##_section = {NAME##_keys, sizeof NAME##_keys / sizeof(gn_key), 0, \
                                              GN_NO_WHERE}
#define ELEMENTS_OF(NAME, STRUCT)                                                                  \
    static const gn_section NAME##_section = {NAME##_keys, sizeof NAME##_keys / sizeof(gn_key),    \
                                              sizeof(STRUCT), offsetof(STRUCT, where)}

/* The section `elements` (manifest_elements.c); its fields lie in gn_scene. */
extern const gn_section gn_elements_section;

#endif
