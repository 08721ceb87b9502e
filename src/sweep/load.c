/* Reads a sweep file into parameters and their values. Their combinations are made in expand.c. */
#include "base/memory.h"
#include "base/names.h"
#include "io/io.h"
#include "sweep/expand.h"
#include "sweep/range.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const size_t size_limit = (size_t)16 << 20;

/* ---- readings ---- */

/* Returns node k of a list of names, or the single one. */
static const gn_node *name_node(const gn_node *node, size_t k) {
    return node->kind == GN_NODE_LIST ? gn_node_item(node, k) : node;
}

/* Returns the index of the same name among the first k; k: there is none. */
static size_t named_before(const gn_sweep_file *file, size_t k) {
    size_t first = 0;
    while (strcmp(file->readings[first], file->readings[k]) != 0) first++;
    return first;
}

static gneiss_status check_readings(gn_reader *reader, const gn_node *root,
                                    const gn_sweep_file *file) {
    char advice[GN_ADVICE_SIZE];
    const gn_node *node = gn_node_child(root, "readings");
    for (size_t k = 0; node && k < file->reading_count; k++) {
        const gn_node *at = name_node(node, k);
        gneiss_status status = GNEISS_OK;
        if (!gn_reading_known(file->readings[k], advice, sizeof advice))
            status = gn_read_fail(reader, at, at->where, "readings", "unknown reading '%s'%s",
                                  file->readings[k], advice);
        else if (named_before(file, k) < k)
            status = gn_read_fail(reader, at, at->where, "readings",
                                  "expected '%s' once, found it again", file->readings[k]);
        GN_TRY(gn_read_keep_problem(reader, status));
    }
    return GNEISS_OK;
}

/* ---- seeds ---- */

static bool whole(const char *text, size_t length, uint64_t *value) {
    char digits[32], *rest = NULL;
    if (length == 0 || length >= sizeof digits || strspn(text, "0123456789") < length) return false;
    memcpy(digits, text, length);
    digits[length] = '\0';
    errno = 0;
    *value = strtoull(digits, &rest, 10);
    return !errno;
}

/* Reads seeds. "5" is a number of seeds without a start: count is set and seeds is NULL. "3, 7" and
 * "[3]" are seeds. */
static bool read_seed_text(const char *text, size_t *count, uint64_t **seeds) {
    uint64_t value;
    size_t length = strlen(text);
    *seeds = NULL;
    if (whole(text, length, &value)) {
        *count = value;
        return value >= 1 && value <= GN_SWEEP_RUNS_MAX;
    }
    *seeds = gn_alloc_array(length + 1, sizeof **seeds);
    *count = 0;
    for (text += strspn(text, " ["); *seeds && *text; text += strspn(text, ", ]")) {
        length = strcspn(text, ", ]");
        if (!whole(text, length, &value)) return false;
        for (size_t k = 0; k < *count; k++)
            if ((*seeds)[k] == value) return false;
        (*seeds)[(*count)++] = value;
        text += length;
    }
    return *seeds && *count > 0;
}

static gneiss_status read_seeds(gn_reader *reader, const gn_node *node, gn_sweep *sweep) {
    char text[1 << 12] = "";
    if (!node) return GNEISS_OK;
    for (const gn_node *item = node->kind == GN_NODE_LIST ? node->first : NULL;
         item && strlen(text) + 32 < sizeof text; item = item->next) {
        bool plain = item->kind == GN_NODE_SCALAR && strlen(item->text) < 24;
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%s", used ? ", " : "[",
                 plain ? item->text : "?");
    }
    if (node->kind == GN_NODE_SCALAR) snprintf(text, sizeof text, "%s", node->text);
    if (read_seed_text(text, &sweep->seed_count, &sweep->seeds)) return GNEISS_OK;
    return gn_read_keep_problem(
        reader, gn_read_fail(reader, node, node->where, "seeds",
                             "expected a number of seeds in [1, %d] or a list of different seeds",
                             GN_SWEEP_RUNS_MAX));
}

/* Replaces the seeds of the file by those of the command line. */
static gneiss_status seeds_from_line(const char *text, gn_sweep *sweep, gneiss_error *error) {
    gn_free(sweep->seeds);
    sweep->seeds = NULL;
    if (read_seed_text(text, &sweep->seed_count, &sweep->seeds)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "--seeds: expected a number of seeds in [1, %d] or different seeds such as "
                   "3,7,11, found '%s'",
                   GN_SWEEP_RUNS_MAX, text);
}

/* ---- parameters ---- */

static void set_path(gn_reader *reader, const char *key) {
    snprintf(reader->path, sizeof reader->path, "parameters.%s", key);
    reader->path_length = strlen(reader->path);
}

/* Returns the reason why a key is refused: it does not concern the physics of a run, or the sweep
 * sets it by other keys; NULL: it is accepted. */
static const char *refused(const gn_sweep *sweep, const char *key) {
    static const char *const own[] = {"title", "output.directory", "output.checkpoint"};
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
        if (strcmp(key, own[k]) == 0) return "cannot be varied";
    if (strcmp(key, "run.seed") == 0 && sweep->seed_count) return "given by seeds as well";
    for (size_t k = 0; k < sweep->override_count; k++)
        if (strcmp(key, sweep->overrides[k].key) == 0) return "given on the command line as well";
    for (size_t k = 0; k < sweep->parameter_count; k++)
        if (strcmp(key, sweep->parameters[k].key) == 0) return "expected once, found again";
    return NULL;
}

/* Writes a key in brackets, such as run[seed], with a dot instead: only numbers keep their
 * brackets. */
static void normalise_key(const char *written, char *key, size_t size) {
    bool open = false;
    size_t used = 0;
    for (const char *c = written; *c && used + 1 < size; c++) {
        bool word = *c == '[' && c > written && !strchr("0123456789]", c[1]) && strchr(c, ']');
        if (word)
            key[used++] = '.';
        else if (*c != ']' || !open)
            key[used++] = *c;
        open = word || (open && *c != ']');
    }
    key[used] = '\0';
}

static gneiss_status read_parameter(gn_reader *reader, const gn_node *node, gn_drawing *drawing,
                                    gn_sweep *sweep) {
    enum { KEY_MOST = 180 };
    if (strlen(node->key) >= KEY_MOST)
        return gn_read_fail(reader, node, node->key_where, "parameters",
                            "expected a key of less than %d bytes", KEY_MOST);
    char key[KEY_MOST];
    normalise_key(node->key, key, sizeof key);
    set_path(reader, key);
    const char *reason = refused(sweep, key);
    if (reason) return gn_read_fail(reader, node, node->key_where, reader->path, "%s", reason);
    if (sweep->parameter_count == GN_SWEEP_PARAMETERS_MAX)
        return gn_read_fail(reader, node, node->key_where, reader->path,
                            "expected at most %d parameters", GN_SWEEP_PARAMETERS_MAX);
    gn_sweep_parameter *parameter = &sweep->parameters[sweep->parameter_count++];
    snprintf(parameter->key, sizeof parameter->key, "%s", key);
    parameter->where = node->key_where;
    parameter->meant = gn_scene_key_at(parameter->key);
    if (!parameter->meant || parameter->meant->type == GN_KEY_SECTION) {
        char nearest[GN_KEY_PATH_SIZE];
        const char *dot = strrchr(parameter->key, '.');
        bool known = gn_scene_nearest_key(dot ? dot + 1 : parameter->key, nearest, sizeof nearest);
        return gn_read_fail(reader, node, node->key_where, reader->path,
                            parameter->meant ? "expected a key with a value, found a section%s%s%s"
                                             : "unknown key%s%s%s",
                            known && !parameter->meant ? "; did you mean '" : "",
                            known && !parameter->meant ? nearest : "",
                            known && !parameter->meant ? "'?" : "");
    }
    gneiss_status status = gn_parameter_read(reader, node, drawing, parameter);
    drawing->dimension += parameter->sampled;
    return status;
}

static gneiss_status read_parameters(gn_reader *reader, const gn_node *root,
                                     const gn_sweep_file *file, gn_sweep *sweep) {
    gn_drawing drawing = {file->sampling, file->sample_seed, 0, (size_t)file->sample_count};
    const gn_node *map = file->parameters;
    if (map && map->kind != GN_NODE_MAP)
        return gn_read_keep_problem(
            reader, gn_read_fail(reader, map, map->where, "parameters",
                                 "expected keys of the scene, each with its values"));
    for (const gn_node *node = map ? map->first : NULL; node; node = node->next)
        GN_TRY(gn_read_keep_problem(reader, read_parameter(reader, node, &drawing, sweep)));
    const gn_node *sampling = gn_node_child(root, "sampling");
    if (sampling && !drawing.dimension && !reader->problems->count)
        return gn_read_keep_problem(
            reader, gn_read_fail(reader, sampling, sampling->key_where, "sampling",
                                 "expected a distribution among the parameters, found none"));
    return GNEISS_OK;
}

/* Checks that zipped lists with more than one value have equal lengths. */
static gneiss_status check_lengths(gn_reader *reader, const gn_sweep_file *file,
                                   const gn_sweep *sweep) {
    size_t wanted = 0;
    const gn_sweep_parameter *first = NULL;
    if (file->combine != GN_COMBINE_ZIPPED || reader->problems->count) return GNEISS_OK;
    for (size_t k = 0; k < sweep->parameter_count; k++) {
        const gn_sweep_parameter *parameter = &sweep->parameters[k];
        if (parameter->sampled || parameter->count < 2) continue;
        if (!first) first = parameter, wanted = parameter->count;
        if (parameter->count == wanted) continue;
        set_path(reader, parameter->key);
        return gn_read_keep_problem(
            reader, gn_read_fail(reader, NULL, parameter->where, reader->path,
                                 "expected %zu values, as zipped with %s, found %zu", wanted,
                                 first->key, parameter->count));
    }
    return GNEISS_OK;
}

/* ---- the file ---- */

static gneiss_status read_file(gn_reader *reader, const gn_node *root, gn_sweep_file *file,
                               gn_sweep *sweep) {
    GN_TRY(gn_read_keys(reader, &gn_sweep_section, root, file));
    if (!gn_problem_near(reader->problems, "seeds")) GN_TRY(read_seeds(reader, file->seeds, sweep));
    if (!gn_problem_near(reader->problems, "sampling"))
        GN_TRY(read_parameters(reader, root, file, sweep));
    GN_TRY(check_lengths(reader, file, sweep));
    GN_TRY(check_readings(reader, root, file));
    if (!file->parameters && !sweep->seed_count)
        GN_TRY(gn_read_keep_problem(reader,
                                    gn_read_fail(reader, NULL, (gn_scene_place){1, 1}, "",
                                                 "expected parameters or seeds, found neither")));
    return gn_problems_status(reader->problems, reader->error);
}

/* Copies what is needed from the file before its tree is freed. */
static void take_over(gn_sweep_file *file, gn_sweep *sweep) {
    memcpy(sweep->title, file->title, sizeof sweep->title);
    memcpy(sweep->scene, file->scene_path, sizeof sweep->scene);
    memcpy(sweep->directory, file->directory, sizeof sweep->directory);
    sweep->readings = file->readings;
    sweep->reading_count = file->reading_count;
    file->readings = NULL;
}

/* Parses with a temporary scene, from which the reader takes the dimension. */
static gneiss_status parse(gn_reader *reader, const gn_tree *tree, gn_sweep *sweep,
                           gn_combine *combine) {
    gneiss_error own = {0}, *error = reader->error;
    gn_sweep_file *file = gn_alloc(sizeof *file);
    reader->scene = gn_alloc(sizeof *reader->scene);
    reader->problems = gn_alloc(sizeof *reader->problems);
    gneiss_status status = GNEISS_ERROR_MEMORY;
    reader->error = &own;
    if (!file || !reader->scene || !reader->problems) {
        gn_fail(&own, status, "%s: out of memory", reader->name);
    } else {
        reader->scene->dimension = 3;
        status = read_file(reader, gn_tree_root(tree), file, sweep);
        *combine = file->combine;
        if (status == GNEISS_OK) take_over(file, sweep);
        if (status == GNEISS_ERROR_INPUT && gn_units_exhausted(sweep->units))
            status = gn_fail(&own, GNEISS_ERROR_MEMORY, "%s: out of memory while reading units",
                             reader->name);
        gn_notes_merge(&sweep->notes, &reader->scene->notes);
        gn_free(file->readings);
    }
    if (status != GNEISS_OK && error) *error = own;
    gn_free(reader->problems);
    gn_free(reader->scene);
    gn_free(file);
    reader->error = error;
    reader->problems = NULL;
    reader->scene = NULL;
    return status;
}

static void folder_of(const char *path, char folder[GN_PATH_SIZE]) {
    const char *slash = strrchr(path, '/');
    int keep = !slash ? 1 : slash == path ? 1 : (int)(slash - path);
    snprintf(folder, GN_PATH_SIZE, "%.*s", keep, slash ? path : ".");
}

static gneiss_status read_text(const char *path, const char *what, char **text,
                               gneiss_error *error) {
    if (strlen(path) >= GN_PATH_SIZE)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%.80s...: the path is too long", path);
    if (access(path, F_OK) != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: cannot open the %s: %s", path, what,
                       strerror(errno));
    GN_TRY(gn_read_text_file(path, size_limit, text, error));
    if ((*text)[strspn(*text, " \t\r\n")]) return GNEISS_OK;
    free(*text);
    *text = NULL;
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s:1:1: expected a %s, found an empty file", path,
                   what);
}

static const char confining[] = "membrane.pressure";

/* Finds the key of the only membrane pressure of a scene, in the scene itself or in a stage.
 * Returns the number of pressures. */
static size_t find_pressure(const gn_node *root, char *key, size_t size) {
    const gn_node *stages = gn_node_child(root, "stages");
    const bool list = stages && stages->kind == GN_NODE_LIST;
    size_t count = gn_node_find(root, confining) != NULL;
    snprintf(key, size, "%s", confining);
    for (size_t k = 0; list && k < stages->count; k++) {
        if (!gn_node_find(gn_node_item(stages, k), confining)) continue;
        if (!count) snprintf(key, size, "stages.%zu.%s", k, confining);
        count++;
    }
    return count;
}

static bool is_given(const gn_sweep *sweep, const gn_tree *tree, const char *key) {
    char place[GN_KEY_PATH_SIZE];
    for (size_t k = 0; k < sweep->override_count; k++) {
        gn_tree_place(tree, sweep->overrides[k].key, place, sizeof place);
        if (strcmp(place, key) == 0) return true;
    }
    for (size_t k = 0; k < sweep->parameter_count; k++)
        if (strcmp(sweep->parameters[k].key, key) == 0) return true;
    return false;
}

/* Converts the confinements of a test to values of the membrane pressure, unless the command line
 * gives it. */
static gneiss_status read_confinements(gn_reader *reader, const gn_tree *tree, gn_sweep *sweep) {
    const gn_node *root = gn_tree_root(tree);
    const gn_node *list = gn_node_find(root, "test.confinement");
    const gn_drawing none = {0};
    char key[64];
    const size_t pressures = find_pressure(root, key, sizeof key);
    if (is_given(sweep, tree, confining) || is_given(sweep, tree, key)) return GNEISS_OK;
    if (!list || list->kind != GN_NODE_LIST || list->count < 2) return GNEISS_OK;
    gn_sweep_parameter *parameter = &sweep->parameters[sweep->parameter_count++];
    snprintf(parameter->key, sizeof parameter->key, "%s", key);
    snprintf(reader->path, sizeof reader->path, "test.confinement");
    parameter->where = list->key_where;
    parameter->meant = gn_scene_key_at(confining);
    if (!pressures)
        return gn_fail(reader->error, GNEISS_ERROR_INPUT,
                       "%s:%d:%d: test.confinement: expected a scene with a membrane for a list of "
                       "pressures, each of which it takes in a run of its own, found none",
                       sweep->scene, list->key_where.line, list->key_where.column);
    if (pressures > 1)
        return gn_fail(
            reader->error, GNEISS_ERROR_INPUT,
            "%s:%d:%d: test.confinement: expected one membrane pressure, of the scene or "
            "of a stage, that takes each value of the list, found %zu",
            sweep->scene, list->key_where.line, list->key_where.column, pressures);
    return gn_parameter_read(reader, list, &none, parameter);
}

/* Reads the confinements of a scene. An invalid scene has none here; reading it as a scene reports
 * the reason. */
static gneiss_status confinements_of(const char *text, gn_sweep *sweep, gneiss_error *error) {
    gn_tree *tree = NULL;
    gneiss_error unsaid = {0};
    gneiss_status status = gn_tree_read(text, strlen(text), sweep->scene, &tree, &unsaid);
    if (status == GNEISS_ERROR_MEMORY) return gn_fail(error, status, "%s", unsaid.message);
    if (status != GNEISS_OK) return GNEISS_OK;
    for (size_t k = 0; status == GNEISS_OK && k < sweep->override_count; k++)
        if (strcmp(sweep->overrides[k].key, "test.confinement") == 0)
            status = gn_tree_override(tree, &sweep->overrides[k], error);
    gn_reader reader = {.name = sweep->scene, .units = sweep->units, .error = error};
    if (status == GNEISS_OK) status = read_confinements(&reader, tree, sweep);
    gn_tree_free(tree);
    return status;
}

/* Refuses a list of confinements in a scene that a sweep varies. */
static gneiss_status check_confinements(gn_sweep *sweep, gneiss_error *error) {
    const size_t before = sweep->parameter_count;
    if (before == GN_SWEEP_PARAMETERS_MAX) return GNEISS_OK;
    GN_TRY(confinements_of(sweep->scene_text, sweep, error));
    if (sweep->parameter_count == before) return GNEISS_OK;
    const gn_scene_place where = sweep->parameters[before].where;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s:%d:%d: test.confinement: expected none in a scene that a sweep varies, found "
        "a list: its pressures belong to parameters of the sweep, as membrane.pressure",
        sweep->scene, where.line, where.column);
}

static gneiss_status load(const char *path, const char *seeds, gn_sweep *sweep,
                          gneiss_error *error) {
    gn_tree *tree = NULL;
    gn_combine combine = GN_COMBINE_CROSSED;
    char folder[GN_PATH_SIZE];
    GN_TRY(read_text(path, "sweep", &sweep->text, error));
    folder_of(path, folder);
    GN_TRY(gn_tree_read(sweep->text, strlen(sweep->text), path, &tree, error));
    gn_reader reader = {.name = path, .folder = folder, .units = sweep->units, .error = error};
    gneiss_status status = parse(&reader, tree, sweep, &combine);
    gn_tree_free(tree);
    if (status == GNEISS_OK && seeds) status = seeds_from_line(seeds, sweep, error);
    GN_TRY(status);
    GN_TRY(read_text(sweep->scene, "scene", &sweep->scene_text, error));
    GN_TRY(check_confinements(sweep, error));
    return gn_sweep_expand(sweep, combine, error);
}

static gneiss_status begin(const char *source, const gn_override *overrides, size_t override_count,
                           gn_sweep *sweep, gneiss_error *error) {
    memset(sweep, 0, sizeof *sweep);
    sweep->overrides = overrides;
    sweep->override_count = override_count;
    snprintf(sweep->source, sizeof sweep->source, "%s", source);
    sweep->units = gn_units_new();
    return sweep->units ? GNEISS_OK
                        : gn_fail(error, GNEISS_ERROR_MEMORY, "%s: out of memory", source);
}

gneiss_status gn_sweep_load(const char *path, const gn_override *overrides, size_t override_count,
                            const char *seeds, gn_sweep *sweep, gneiss_error *error) {
    GN_TRY(begin(path, overrides, override_count, sweep, error));
    gneiss_status status = load(path, seeds, sweep, error);
    if (status != GNEISS_OK) gn_sweep_free(sweep);
    return status;
}

gneiss_status gn_sweep_of_scene(const char *scene, const gn_override *overrides,
                                size_t override_count, const char *seeds, gn_sweep *sweep,
                                bool *wanted, gneiss_error *error) {
    *wanted = false;
    GN_TRY(begin(scene, overrides, override_count, sweep, error));
    snprintf(sweep->scene, sizeof sweep->scene, "%s", scene);
    gneiss_status status = read_text(scene, "scene", &sweep->scene_text, error);
    if (status == GNEISS_OK && seeds) status = seeds_from_line(seeds, sweep, error);
    if (status == GNEISS_OK) status = confinements_of(sweep->scene_text, sweep, error);
    *wanted = seeds || sweep->parameter_count;
    if (status == GNEISS_OK && *wanted) status = gn_sweep_expand(sweep, GN_COMBINE_CROSSED, error);
    if (status != GNEISS_OK || !*wanted) gn_sweep_free(sweep);
    return status;
}

void gn_sweep_free(gn_sweep *sweep) {
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        for (size_t k = 0; k < sweep->parameters[p].count; k++)
            gn_free(sweep->parameters[p].values[k].text);
        gn_free(sweep->parameters[p].values);
    }
    free(sweep->text);
    free(sweep->scene_text);
    gn_free(sweep->seeds);
    gn_free(sweep->readings);
    gn_free(sweep->runs);
    gn_free(sweep->chosen);
    gn_units_free(sweep->units);
    memset(sweep, 0, sizeof *sweep);
}
