/* Functions that traverse the table of keys: the echo of a scene, its effects, ranges, and the key
 * reference. */
#include "scene_text.h"

#include "scene/manifest.h"

/* ---- writing ---- */

static void same_section(const gn_section *section, const char *a, const char *b);

static void same_bits(const gn_key *key, const char *a, const char *b, size_t size) {
    if (memcmp(a, b, size) != 0) fail_msg("'%s' changed on its way through a file", key->name);
}

static void same_array(const gn_key *key, const char *a, const char *b, size_t size) {
    const char *first, *second;
    size_t count = *(const size_t *)(a + key->second);
    assert_int_equal(count, *(const size_t *)(b + key->second));
    memcpy(&first, a + key->offset, sizeof first);
    memcpy(&second, b + key->offset, sizeof second);
    for (size_t k = 0; k < count; k++)
        if (key->section)
            same_section(key->section, first + k * size, second + k * size);
        else
            same_bits(key, first + k * size, second + k * size, size);
}

static void same_key(const gn_key *key, const char *a, const char *b) {
    const char *x = a + key->offset, *y = b + key->offset;
    const gn_table *t = (const gn_table *)x, *u = (const gn_table *)y;
    switch (key->type) {
    case GN_KEY_TEXT:
    case GN_KEY_NAME:
        assert_string_equal(x, y);
        break;
    case GN_KEY_FILE:
        assert_string_equal(a + key->second, b + key->second);
        break;
    case GN_KEY_SECTION:
        same_section(key->section, x, y);
        break;
    case GN_KEY_LIST:
        same_array(key, a, b, key->section->size);
        break;
    case GN_KEY_PARTICLES:
        same_bits(key, a + key->number, b + key->number, sizeof(int64_t));
        same_array(key, a, b, gn_key_element_size(key));
        break;
    case GN_KEY_IDS:
    case GN_KEY_CHANGES:
    case GN_KEY_NAMES:
    case GN_KEY_POINTS:
        same_array(key, a, b, gn_key_element_size(key));
        break;
    case GN_KEY_TABLE:
        assert_int_equal(t->count, u->count);
        if (t->count) same_bits(key, (char *)t->time, (char *)u->time, t->count * sizeof(double));
        if (t->count) same_bits(key, (char *)t->value, (char *)u->value, t->count * sizeof(double));
        break;
    default:
        same_bits(key, x, y, key->size);
    }
}

static void same_section(const gn_section *section, const char *a, const char *b) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        assert_int_equal(gn_key_present(key, a), gn_key_present(key, b));
        same_key(key, a, b);
    }
}

static void comes_back(gn_scene *scene) {
    gneiss_error error = {0};
    gn_scene again;
    char *text = gn_scene_write(scene);
    assert_non_null(text);
    if (gn_scene_parse(text, "echo", "/", NULL, 0, &again, &error))
        fail_msg("%s\n%s", error.message, text);
    same_section(&gn_scene_section, (char *)scene, (char *)&again);
    char *twice = gn_scene_write(&again);
    assert_string_equal(text, twice);
    free(text);
    free(twice);
    gn_scene_free(&again);
    gn_scene_free(scene);
}

static void a_written_scene_comes_back_bit_for_bit(void **state) {
    (void)state;
    static const char *const files[] = {"scenes/ucs-rock.yaml",     "tests/scenes/everything.yaml",
                                        "tests/scenes/plane.yaml",  "tests/scenes/polygon.yaml",
                                        "scenes/block-on-bed.yaml", "scenes/pour-into-hopper.yaml",
                                        "scenes/stages.yaml",       "scenes/bending.yaml",
                                        "scenes/triaxial.yaml",     "scenes/hydrostatic.yaml",
                                        "scenes/shear.yaml",        "scenes/hopper.yaml",
                                        "scenes/drum.yaml",         "scenes/penetration.yaml",
                                        "tests/scenes/flow.yaml",   "scenes/simple-shear.yaml",
                                        "scenes/periodic-box.yaml"};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        gn_scene scene = loaded(files[k]);
        comes_back(&scene);
    }
    gn_scene scene = parsed(small);
    comes_back(&scene);
}

static void every_shape_comes_back_bit_for_bit(void **state) {
    (void)state;
    static const struct {
        int dimension;
        const char *specimen;
    } cases[] = {
        {2, "rectangle: {width: 0.1, height: 0.3}\n  origin: [-0.0, 1e-9]\n  particles: 4"},
        {2, "disc: {diameter: 0.7}\n  mean_radius: 0.011"},
        {2,
         "disc: {diameter: 0.7}\n  particles: 9\n  packing: {sizes: sieve, sieve: [[0.1, 0], [0.3, "
         "0.7], [1, 1]]}"},
        {3, "box: {size: [0.1, 0.2, 0.3]}\n  particles: 100000000"},
        {3, "surface: ../meson.build\n  scale: 1e-3\n  particles: 50"},
        {3, "mesh: test.h\n  packing: {start: nodes}"},
        {2, "mesh: test.h\n  mean_radius: 1 um"},
        {2, "lattice: {kind: square, radius: 1, cells: [1, 1]}\n  origin: [-0.0, 0]"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_scene scene;
        gneiss_error error = {0};
        char text[1024], folder[4096];
        snprintf(folder, sizeof folder, "%s/tests", test_source());
        snprintf(text, sizeof text,
                 "dimension: %d\nspecimen:\n  %s\nmaterials:\n  - {name: a, density: 1, kratio: 0, "
                 "normal_stiffness: 1}\nlaw: {stiffness: uniform}\ntime: {end: 1}\n",
                 cases[k].dimension, cases[k].specimen);
        if (gn_scene_parse(text, "s.yaml", folder, NULL, 0, &scene, &error))
            fail_msg("refused: %s", error.message);
        comes_back(&scene);
    }
}

static void a_scene_without_a_shape_says_nothing_of_packing(void **state) {
    (void)state;
    gn_scene scene = parsed(small);
    char *text = gn_scene_write(&scene);
    assert_non_null(text);
    assert_null(strstr(text, "packing"));
    assert_null(strstr(text, "origin"));
    free(text);
    gn_scene_free(&scene);
}

static void a_copy_is_independent_of_its_original(void **state) {
    (void)state;
    static const char *const files[] = {"tests/scenes/everything.yaml", "tests/scenes/polygon.yaml",
                                        "scenes/block-on-bed.yaml"};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        gn_scene scene = loaded(files[k]), copy;
        gneiss_error error = {0};
        assert_int_equal(gn_scene_copy(&scene, &copy, &error), GNEISS_OK);
        same_section(&gn_scene_section, (char *)&scene, (char *)&copy);
        char *text = gn_scene_write(&scene);
        for (size_t c = 0; c < 2 * scene.specimen.pack.corner_count; c++)
            scene.specimen.pack.corners[c] = -1;
        for (size_t r = 0; r < scene.specimen.pack.refinement_count; r++)
            scene.specimen.pack.refinements[r].size = -1;
        gn_scene_free(&scene);
        char *later = gn_scene_write(&copy);
        assert_string_equal(text, later);
        free(text);
        free(later);
        gn_scene_free(&copy);
    }
}

static void awkward_numbers_come_back_bit_for_bit(void **state) {
    (void)state;
    uint64_t draw = 1;
    for (int k = 0; k < 200; k++) {
        char normal[96], velocity[96];
        double v[4];
        for (int c = 0; c < 4; c++) {
            draw = draw * 6364136223846793005u + 1442695040888963407u;
            v[c] = ldexp((double)(draw >> 11) - 0x1p52, (int)(draw % 40) - 70);
        }
        snprintf(normal, sizeof normal, "[%.17g, %.17g, %.17g]", v[0], v[1], v[2]);
        snprintf(velocity, sizeof velocity, "[[%.17g, -0.0]]", v[3]);
        gn_override overrides[] = {{"walls.floor.normal", normal},
                                   {"walls.floor.motion.vz", velocity}};
        gn_scene scene;
        gneiss_error error = {0};
        if (gn_scene_parse(small, "s", NULL, overrides, 2, &scene, &error))
            fail_msg("%s", error.message);
        comes_back(&scene);
    }
}

/* ---- effects ---- */

static gn_effects effects_of(gn_scene scene) {
    gn_effects mask = gn_scene_effects(&scene);
    gn_scene_free(&scene);
    return mask;
}

static void effects_are_those_that_the_scene_needs(void **state) {
    (void)state;
    assert_int_equal(effects_of(loaded("scenes/ucs-rock.yaml")),
                     GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_SHEAR | GN_FX_FRICTION |
                         GN_FX_BONDS | GN_FX_EVENTS | GN_FX_NONVISCOUS_VECTOR | GN_FX_WALLS |
                         GN_FX_ENERGY);
    assert_int_equal(effects_of(loaded("tests/scenes/everything.yaml")),
                     GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_SHEAR | GN_FX_FRICTION |
                         GN_FX_BONDS | GN_FX_EVENTS | GN_FX_CONTACT_DAMPING | GN_FX_VISCOUS |
                         GN_FX_GRAVITY | GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_WALLS |
                         GN_FX_WALL_SHEAR | GN_FX_PERIODIC | GN_FX_ORIENTATION | GN_FX_MIXED |
                         GN_FX_ELEMENTS);
    assert_int_equal(effects_of(loaded("tests/scenes/plane.yaml")),
                     GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_NONVISCOUS_COMPONENT | GN_FX_GRAVITY |
                         GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_WALLS | GN_FX_ENERGY);
    gn_effects base = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_WALLS | GN_FX_ENERGY;
    assert_int_equal(effects_of(parsed(small)), base | GN_FX_SHEAR | GN_FX_FRICTION);
    assert_int_equal(effects_of(parsed(variant("friction: 0.5", "friction: 0"))), base);
    assert_int_equal(effects_of(parsed(variant("kratio: 2\n    friction: 0.5", "kratio: 0"))),
                     base);
    assert_int_equal(effects_of(parsed(with("output: {energy: off, orientation: on}\n"))),
                     (base & ~(gn_effects)GN_FX_ENERGY) | GN_FX_SHEAR | GN_FX_FRICTION |
                         GN_FX_ORIENTATION);
}

static void bonds_need_a_group(void **state) {
    (void)state;
    const char *bonded =
        "    friction: 0\n    bond_tension_limit: 1\n    bond_shear_limit: 1\nbonds:\n";
    gn_effects mask = effects_of(parsed(variant("    friction: 0.5\n", bonded)));
    assert_true((mask & GN_FX_BONDS) && (mask & GN_FX_SHEAR) && !(mask & GN_FX_FRICTION));
    gn_override none = {"specimen.group", "0"}, off = {"bonds.enabled", "off"};
    const gn_override *each[] = {&none, &off};
    for (int k = 0; k < 2; k++) {
        gn_scene scene;
        gneiss_error error = {0};
        assert_int_equal(gn_scene_parse(variant("    friction: 0.5\n", bonded), "s", NULL, each[k],
                                        1, &scene, &error),
                         0);
        assert_false(effects_of(scene) & (GN_FX_BONDS | GN_FX_SHEAR));
    }
}

/* ---- the manifest ---- */

typedef void (*key_check)(const gn_key *key, const char *path, void *context);

static size_t each_key(const gn_section *section, const char *above, key_check check,
                       void *context) {
    size_t count = 0;
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char path[256];
        snprintf(path, sizeof path, "%s%s%s", above, *above ? "." : "", key->name);
        check(key, path, context);
        count++;
        if (!key->section) continue;
        if (key->type == GN_KEY_LIST) strcat(path, "[0]");
        count += each_key(key->section, path, check, context);
    }
    return count;
}

static void is_documented(const gn_key *key, const char *path, void *context) {
    (void)context;
    if (!key->text || strlen(key->text) < 8) fail_msg("%s has no text", path);
    bool optional = key->fallback || key->presence != GN_PRESENT_ALWAYS ||
                    key->type == GN_KEY_SECTION || key->type == GN_KEY_LIST;
    if (key->required == optional && key->type != GN_KEY_SECTION && key->type != GN_KEY_LIST)
        fail_msg("%s is neither required nor has a default, or both", path);
    bool numeric =
        key->type == GN_KEY_REAL || key->type == GN_KEY_TABLE || key->type == GN_KEY_VECTOR;
    if (numeric && !key->unit) fail_msg("%s has no unit", path);
    if (key->section) assert_true(key->section->key_count <= GN_SECTION_KEYS_MAX);
    if (key->type == GN_KEY_CHOICE && !key->choices) fail_msg("%s has no choices", path);
}

static void every_key_is_documented(void **state) {
    (void)state;
    assert_true(gn_scene_section.key_count <= GN_SECTION_KEYS_MAX);
    assert_true(each_key(&gn_scene_section, "", is_documented, NULL) > 100);
}

/* Values just outside the interval, as the scene file would have them. */
static int outside(const char *range, bool whole, char values[2][32]) {
    gn_range r = gn_range_read(range);
    int count = 0;
    double below = whole ? 1 : r.low != 0 ? fabs(r.low) * 1e-9 : 1e-9;
    double above = whole ? 1 : r.high != 0 ? fabs(r.high) * 1e-9 : 1e-9;
    if (isfinite(r.low))
        snprintf(values[count++], 32, whole ? "%.0f" : "%.17g", r.low_open ? r.low : r.low - below);
    if (isfinite(r.high))
        snprintf(values[count++], 32, whole ? "%.0f" : "%.17g",
                 r.high_open ? r.high : r.high + above);
    return count;
}

/* Keys of sources and sinks that only a 2D scene has, or that are tested in one. */
static bool is_flat(const char *path) {
    return strstr(path, ".rectangle") || strstr(path, ".disc") || strstr(path, ".polygon") ||
           strstr(path, ".sieve");
}

/* A shape that the key at a path belongs to and that no scene file has; NULL otherwise. */
static const gn_override *shape_of(const char *path) {
    static const gn_override shapes[] = {{"specimen.rectangle", "{width: 1, height: 1}"},
                                         {"specimen.disc", "{diameter: 1}"},
                                         {"specimen.box", "{size: [1, 1, 1]}"},
                                         {"elements.rectangle", "{size: [1, 1], cells: [1, 1]}"},
                                         {"elements.beam", "{length: 1, height: 1, cell: 1}"},
                                         {"elements.box", "{size: [1, 1, 1], cells: [1, 1, 1]}"},
                                         {"elements.contact", "{stiffness: 1}"},
                                         {"stages", "[{name: a}]"},
                                         {"clumps",
                                          "{shapes: [{name: a, spheres: [[0, 0, 0, 1]]}], "
                                          "placed: [{shape: a, centre: [0, 0, 0]}], "
                                          "filled: [{shapes: a, box: {min: [0, 0, 0], "
                                          "max: [1, 1, 1]}, count: 1}]}"},
                                         {"joints", "[{name: j, network: {intensity: 1}}]"},
                                         {"couple", "{zones: [{edges: [{from: [0, 0, 0], to: [1, "
                                                    "0, 0]}]}]}"},
                                         {"bodies", "[{name: b, box: {size: [1, 1, 1]}, cylinder: "
                                                    "{diameter: 1, height: 1}, stiffness: 1}]"}};
    static const gn_override line = {"bodies", "[{name: b, stiffness: 1}]"};
    static const gn_override sources[] = {
        {"sources", "[{name: s, mean_radius: 1, box: {size: [1, 1, 1]}, cylinder: {diameter: 1, "
                    "height: 1}}]"},
        {"sources", "[{name: s, mean_radius: 1, rectangle: {width: 1, height: 1}, disc: "
                    "{diameter: 1}}]"}};
    static const gn_override sinks[] = {
        {"sinks", "[{name: s, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, box: {size: [1, 1, "
                  "1]}, cylinder: {diameter: 1, height: 1}}]"},
        {"sinks", "[{name: s, rectangle: {width: 1, height: 1}, disc: {diameter: 1}}]"}};
    if (strncmp(path, "sources[0]", 10) == 0) return &sources[is_flat(path)];
    if (strncmp(path, "sinks[0]", 8) == 0) return &sinks[is_flat(path)];
    if (strncmp(path, "bodies[0].poly", 14) == 0) return &line;
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
        if (strncmp(path, shapes[k].key, strlen(shapes[k].key)) == 0) return &shapes[k];
    return NULL;
}

static void refuses_outside_values(const gn_key *key, const char *path, void *context) {
    size_t *checked = context;
    bool whole = key->type == GN_KEY_INTEGER || key->type == GN_KEY_CELLS ||
                 key->type == GN_KEY_IDS || key->type == GN_KEY_PARTICLES;
    if (!key->range || key->type == GN_KEY_LIST) return;
    char at[256];
    bool servo = strstr(path, ".servo.") != NULL; /* only the second wall has a servo */
    snprintf(at, sizeof at, servo ? "walls[1]%s" : "%s", path + (servo ? 8 : 0));
    char values[2][32], text[128], file[4096];
    const gn_override *shape = shape_of(path);
    bool flows = strncmp(path, "sources", 7) == 0 || strncmp(path, "sinks", 5) == 0;
    bool plane = strncmp(path, "specimen.lattice", 16) == 0 ||
                 (key->type == GN_KEY_POINTS && !strstr(path, "joints[0].polygon")) ||
                 (flows && is_flat(path)) ||
                 (shape && !flows && !strstr(shape->key, ".box") && !strstr(shape->key, ".beam") &&
                  !strstr(shape->key, ".contact") && !strstr(shape->key, "couple") &&
                  strcmp(shape->key, "stages") != 0 && strcmp(shape->key, "clumps") != 0 &&
                  strcmp(shape->key, "joints") != 0 && strcmp(shape->key, "bodies") != 0);
    snprintf(file, sizeof file, "%s/tests/scenes/%s.yaml", test_source(),
             plane ? "plane" : "everything");
    int count = outside(key->range, whole, values);
    assert_true(count > 0);
    for (int k = 0; k < count; k++) {
        bool vector = key->type == GN_KEY_CELLS || key->type == GN_KEY_VECTOR ||
                      (key->type == GN_KEY_SPIN && !plane);
        snprintf(text, sizeof text,
                 vector                       ? "[%s, %s, %s]"
                 : key->type == GN_KEY_POINTS ? "[[%s, 0], [%s, 0], [%s, 1]]"
                 : key->type == GN_KEY_IDS    ? "[%s]"
                                              : "%s",
                 values[k], values[k], values[k]);
        gn_override overrides[] = {shape ? *shape : (gn_override){"title", "t"}, {at, text}};
        gn_scene scene;
        gneiss_error error = {0};
        gneiss_status status = gn_scene_load(file, overrides, 2, &scene, &error);
        if (status == GNEISS_OK) fail_msg("%s = %s was accepted, range %s", path, text, key->range);
        if (!strstr(error.message, key->range)) fail_msg("%s = %s: %s", path, text, error.message);
        (*checked)++;
    }
}

static void every_range_is_checked(void **state) {
    (void)state;
    size_t checked = 0;
    each_key(&gn_scene_section, "", refuses_outside_values, &checked);
    assert_true(checked > 50);
}

static void words_are_accepted_and_written(void **state) {
    (void)state;
    gn_scene s =
        parsed(with("output: {checkpoint: off}\nrun: {threads: auto}\nneighbours: {skin: auto}\n"));
    assert_true(s.checkpoint_wall == 0 && s.threads == 0 && s.skin == 0);
    char *text = gn_scene_write(&s);
    assert_non_null(strstr(text, "checkpoint: off"));
    free(text);
    gn_scene_free(&s);
}

/* ---- the key reference ---- */

static char *key_text(bool markdown, const char *sought, size_t *count) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    *count = gn_scene_print_keys(out, markdown, &sought, sought ? 1 : 0);
    fclose(out);
    return text;
}

static void the_key_reference_has_every_key(void **state) {
    (void)state;
    size_t all, some;
    char *text = key_text(false, NULL, &all), *part = key_text(false, "time.s", &some);
    assert_non_null(strstr(text, "materials[].density\n"));
    assert_non_null(strstr(text, "walls[].servo.max_velocity\n"));
    assert_int_equal(some, 8); /* step, safety, start and its fraction, stop and its three */
    assert_null(strstr(part, "time.end"));
    assert_true(all > 100);
    free(text);
    free(part);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_written_scene_comes_back_bit_for_bit),
        cmocka_unit_test(every_shape_comes_back_bit_for_bit),
        cmocka_unit_test(a_scene_without_a_shape_says_nothing_of_packing),
        cmocka_unit_test(a_copy_is_independent_of_its_original),
        cmocka_unit_test(awkward_numbers_come_back_bit_for_bit),
        cmocka_unit_test(effects_are_those_that_the_scene_needs),
        cmocka_unit_test(bonds_need_a_group),
        cmocka_unit_test(every_key_is_documented),
        cmocka_unit_test(every_range_is_checked),
        cmocka_unit_test(words_are_accepted_and_written),
        cmocka_unit_test(the_key_reference_has_every_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
