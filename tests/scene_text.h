/* Scenes that the tests of src/scene start from. */
#ifndef GN_TESTS_SCENE_TEXT_H
#define GN_TESTS_SCENE_TEXT_H

#include "test.h"

#include "scene/scene.h"

static const char small[] = "dimension: 3\n"                                       /* line 1 */
                            "specimen:\n"                                          /* 2 */
                            "  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n" /* 3 */
                            "materials:\n"                                         /* 4 */
                            "  - name: rock\n"                                     /* 5 */
                            "    density: 2650 kg/m3\n"                            /* 6 */
                            "    normal_stiffness: 1 MN/m\n"                       /* 7 */
                            "    kratio: 2\n"                                      /* 8 */
                            "    friction: 0.5\n"                                  /* 9 */
                            "law:\n"                                               /* 10 */
                            "  stiffness: uniform\n"                               /* 11 */
                            "walls:\n"                                             /* 12 */
                            "  - name: floor\n"                                    /* 13 */
                            "    point: [0, 0, -1 mm]\n"                           /* 14 */
                            "    normal: [0, 0, 4]\n"                              /* 15 */
                            "    stiffness: 2 MN/m\n"                              /* 16 */
                            "    motion: {vz: 1 mm/s}\n"                           /* 17 */
                            "time:\n"                                              /* 18 */
                            "  end: 5 ms\n";                                       /* 19 */

/* The small scene with the first `from` turned into `to`. */
static inline char *variant(const char *from, const char *to) {
    static char text[8192];
    const char *at = strstr(small, from);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - small), small, to, at + strlen(from));
    return text;
}

static inline char *with(const char *more) {
    static char text[8192];
    snprintf(text, sizeof text, "%s%s", small, more);
    return text;
}

static inline gn_scene parsed(const char *text) {
    gn_scene scene;
    gneiss_error error = {0};
    if (gn_scene_parse(text, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK)
        fail_msg("refused: %s", error.message);
    return scene;
}

static inline gn_scene loaded(const char *file) {
    char path[4096];
    gn_scene scene;
    gneiss_error error = {0};
    snprintf(path, sizeof path, "%s/%s", test_source(), file);
    if (gn_scene_load(path, NULL, 0, &scene, &error) != GNEISS_OK)
        fail_msg("refused: %s", error.message);
    return scene;
}

#endif
