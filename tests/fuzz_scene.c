/* Mutates valid scenes by bytes and tokens, reproducibly, and reads them: every input is refused
 * with a message, or gives a scene with finite numbers that equals its own echo. */
#include "test.h"

#include "scene/read.h"

#include <ctype.h>

enum { TEXT_SIZE = 1 << 14, ROUNDS = 4000, OVERRIDES = 4000 };

static uint64_t draw(uint64_t *state) { /* splitmix64 (Steele et al. 2014) */
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static size_t below(uint64_t *state, size_t bound) {
    return bound ? (size_t)(draw(state) % bound) : 0;
}

static const char *const tokens[] = {"-",
                                     "[",
                                     "]",
                                     "{",
                                     "}",
                                     ":",
                                     ": ",
                                     ",",
                                     "\n",
                                     "  ",
                                     "#",
                                     "'",
                                     "\"",
                                     "|",
                                     ">",
                                     "&a",
                                     "*a",
                                     "!!str",
                                     "---\n",
                                     "...\n",
                                     "%",
                                     "?",
                                     "\t",
                                     "~",
                                     "null",
                                     "true",
                                     "off",
                                     "auto",
                                     "free",
                                     "none",
                                     "nan",
                                     ".inf",
                                     "-1",
                                     "0",
                                     "1e999",
                                     "-0.0",
                                     "1e-320",
                                     "0x10",
                                     "1e308",
                                     "99999999999999999999",
                                     "5 mm",
                                     "3 kg",
                                     "5 %",
                                     "1 Gm",
                                     "m",
                                     "1 1/s",
                                     "2 degC",
                                     "[0, 0, 0]",
                                     "[]",
                                     "{}",
                                     "[[0,1]]",
                                     "[1, 2]",
                                     "\xff",
                                     "\\0",
                                     "\xc3\xbc",
                                     "2",
                                     "z",
                                     "x",
                                     "[[[[[[",
                                     "<<: *a",
                                     "name",
                                     "rock",
                                     "harmonic",
                                     "polyhedron",
                                     "contacts: [{between: rock}]",
                                     "combined",
                                     "uniform",
                                     "fcc",
                                     "square",
                                     "lattice:",
                                     "file: /",
                                     "file: /dev/null",
                                     "surface: /dev/null",
                                     "mesh: /dev/null",
                                     "box: {size: [1, 2, 3]}",
                                     "disc: {diameter: 1}",
                                     "rectangle: {width: 1, height: 2}",
                                     "[[0, 0], [1, 0], [0, 1]]",
                                     "nodes",
                                     "100",
                                     "elements:",
                                     "group: body",
                                     "beam: {length: 1, height: 1, cell: 1}",
                                     "mixed",
                                     "bodies:",
                                     "free: true",
                                     "polyline: [[0, 0], [1, 0]]",
                                     "cylinder: {diameter: 1, height: 1, sides: 3}",
                                     "contact: {stiffness: 1}",
                                     "motion: {wz: [[0, 0], [1, 1]]}",
                                     "0.5",
                                     "\x01"};

static char *read_file(const char *file) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", test_source(), file);
    FILE *in = fopen(path, "r");
    assert_non_null(in);
    char *text = calloc(1, TEXT_SIZE);
    assert_true(fread(text, 1, TEXT_SIZE - 1, in) > 100);
    fclose(in);
    return text;
}

/* Replaces `cut` bytes at `at` by `insert`. */
static void splice(char *text, size_t at, size_t cut, const char *insert, size_t length) {
    size_t size = strlen(text);
    if (at > size) at = size;
    if (cut > size - at) cut = size - at;
    if (size - cut + length >= TEXT_SIZE) return;
    memmove(text + at + length, text + at + cut, size - at - cut + 1);
    memcpy(text + at, insert, length);
}

/* Finds the word at or after a position. */
static size_t word_at(const char *text, size_t *at) {
    while (text[*at] && !isalnum((unsigned char)text[*at])) ++*at;
    size_t length = 0;
    while (isalnum((unsigned char)text[*at + length]) || text[*at + length] == '.') length++;
    return length;
}

static void mutate(char *text, uint64_t *state) {
    size_t size = strlen(text), at = below(state, size + 1), other = below(state, size + 1);
    const char *token = tokens[below(state, sizeof tokens / sizeof *tokens)];
    char byte[2] = {(char)(1 + below(state, 255)), 0}, copy[64];
    size_t length;
    switch (below(state, 8)) {
    case 0:
        splice(text, at, 1, byte, 1);
        break;
    case 1:
        splice(text, at, 1 + below(state, 20), "", 0);
        break;
    case 2:
        splice(text, at, 0, token, strlen(token));
        break;
    case 3:
    case 4:
    case 5: /* largest number of tokens that replace a word */
        length = word_at(text, &at);
        splice(text, at, length, token, strlen(token));
        break;
    case 6: /* a word from elsewhere */
        length = word_at(text, &other);
        if (length > sizeof copy) length = sizeof copy;
        memcpy(copy, text + other, length);
        other = word_at(text, &at);
        splice(text, at, other, copy, length);
        break;
    default:
        text[at] = '\0';
        break;
    }
}

static bool finite_section(const gn_section *section, const char *base);

static bool finite_array(const double *values, size_t count) {
    for (size_t k = 0; k < count; k++)
        if (!isfinite(values[k])) return false;
    return true;
}

static bool finite_key(const gn_key *key, const char *base) {
    const char *at = base + key->offset;
    const gn_table *table = (const gn_table *)at;
    const char *array = NULL;
    size_t count = 0;
    if (gn_key_element_size(key)) {
        memcpy(&array, at, sizeof array);
        count = *(const size_t *)(base + key->second);
    }
    switch (key->type) {
    case GN_KEY_REAL:
        return finite_array((const double *)at, 1);
    case GN_KEY_VECTOR:
    case GN_KEY_SPIN:
        return finite_array((const double *)at, 3);
    case GN_KEY_TABLE:
        return finite_array(table->time, table->count) && finite_array(table->value, table->count);
    case GN_KEY_PARTICLES:
        return finite_array((const double *)array, 4 * count);
    case GN_KEY_POINTS:
        return finite_array((const double *)array, 2 * count);
    case GN_KEY_SECTION:
        return finite_section(key->section, at);
    case GN_KEY_LIST:
        for (size_t k = 0; k < count; k++)
            if (!finite_section(key->section, array + k * key->section->size)) return false;
        return true;
    default:
        return true;
    }
}

static bool finite_section(const gn_section *section, const char *base) {
    for (size_t k = 0; k < section->key_count; k++)
        if (!finite_key(&section->keys[k], base)) return false;
    return true;
}

/* Returns true if the text was a valid scene after all. */
static bool survives(gn_units *units, const char *text, const gn_override *override) {
    gn_scene scene, again;
    gneiss_error error = {0};
    gneiss_status status = gn_scene_parse_with(units, text, strlen(text), "fuzz", "/nowhere",
                                               override, override ? 1 : 0, &scene, &error);
    if (status != GNEISS_OK) {
        if (status != GNEISS_ERROR_INPUT || strlen(error.message) < 10)
            fail_msg("status %d, '%s' for\n%s", status, error.message, text);
        return false;
    }
    if (!finite_section(&gn_scene_section, (const char *)&scene)) fail_msg("not finite:\n%s", text);
    char *echo = gn_scene_write(&scene);
    assert_non_null(echo);
    if (gn_scene_parse_with(units, echo, strlen(echo), "echo", "/", NULL, 0, &again, &error))
        fail_msg("%s\n%s\nfrom\n%s", error.message, echo, text);
    gn_scene_free(&again);
    gn_scene_free(&scene);
    free(echo);
    return true;
}

static const char *const seeds[] = {"tests/scenes/everything.yaml", "tests/scenes/plane.yaml",
                                    "tests/scenes/polygon.yaml",    "scenes/ucs-rock.yaml",
                                    "tests/scenes/beam-small.yaml", "scenes/block-on-bed.yaml"};

static void mutated_scenes_are_refused_or_sound(void **state) {
    (void)state;
    gn_units *units = gn_units_new();
    char *copy = malloc(TEXT_SIZE);
    uint64_t random = 1;
    size_t accepted = 0;
    for (size_t s = 0; s < sizeof seeds / sizeof *seeds; s++) {
        char *text = read_file(seeds[s]);
        for (int round = 0; round < ROUNDS; round++) {
            memcpy(copy, text, TEXT_SIZE);
            for (size_t n = 1 + below(&random, 3); n > 0; n--) mutate(copy, &random);
            accepted += survives(units, copy, NULL);
        }
        free(text);
    }
    /* A fuzzer all texts of which fail in the YAML parser would test nothing else. */
    assert_true(accepted > ROUNDS / 20);
    free(copy);
    gn_units_free(units);
}

static void mutated_overrides_are_refused_or_sound(void **state) {
    (void)state;
    static const char *const keys[] = {"walls.floor.motion.vz",
                                       "materials[0].friction",
                                       "time.end",
                                       "gravity[2]",
                                       "sets[1].select.ids",
                                       "test",
                                       "specimen.packing.refine[0].size",
                                       "specimen.particles",
                                       "run.seed",
                                       "title",
                                       "elements.materials[1].poisson",
                                       "elements.motions.foot.motion.vz",
                                       "elements.loads.wind.traction.tx",
                                       "elements.box.cells"};
    gn_units *units = gn_units_new();
    char *text = read_file(seeds[0]), *key = malloc(TEXT_SIZE), *value = malloc(TEXT_SIZE);
    uint64_t random = 2;
    size_t accepted = 0;
    for (int round = 0; round < OVERRIDES; round++) {
        strcpy(key, keys[below(&random, sizeof keys / sizeof *keys)]);
        strcpy(value, tokens[below(&random, sizeof tokens / sizeof *tokens)]);
        if (below(&random, 2)) mutate(key, &random);
        if (below(&random, 2)) mutate(value, &random);
        gn_override override = {key, value};
        accepted += survives(units, text, &override);
    }
    assert_true(accepted > OVERRIDES / 50);
    free(text);
    free(key);
    free(value);
    gn_units_free(units);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mutated_scenes_are_refused_or_sound),
        cmocka_unit_test(mutated_overrides_are_refused_or_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
