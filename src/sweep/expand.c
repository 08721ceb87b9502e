/* Makes a run of every combination of values; all scenes are read and hashed before anything is
 * computed. */
#include "sweep/expand.h"

#include "base/new.h"
#include "base/printable.h"
#include "base/version.h"
#include "io/io.h"
#include "soa/field.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Version, to be increased whenever the meaning of the contents of a run's folder changes. */
enum { FOLDER_FORMAT = 1 };

/* ---- the scene of a run ---- */

enum { OVERRIDES_MAX = 64 + GN_SWEEP_PARAMETERS_MAX + 1 };

const gn_sweep_value *gn_sweep_value_of(const gn_sweep *sweep, size_t run, size_t parameter) {
    return &sweep->parameters[parameter]
                .values[sweep->chosen[sweep->runs[run].first_value + parameter]];
}

/* Reads the scene of a run. `seeded`: the seeds have their numbers already. */
static gneiss_status read_scene(const gn_sweep *sweep, size_t run, bool seeded, bool varied,
                                gn_scene *scene, gneiss_error *error) {
    gn_override all[OVERRIDES_MAX];
    char seed[24], folder[GN_PATH_SIZE];
    size_t count = 0;
    for (size_t k = 0; k < sweep->override_count && k < 64; k++) all[count++] = sweep->overrides[k];
    for (size_t p = 0; varied && p < sweep->parameter_count; p++)
        all[count++] =
            (gn_override){sweep->parameters[p].key, gn_sweep_value_of(sweep, run, p)->text};
    snprintf(seed, sizeof seed, "%" PRIu64, sweep->runs[run].seed);
    if (seeded && sweep->seed_count) all[count++] = (gn_override){"run.seed", seed};
    const char *slash = strrchr(sweep->scene, '/');
    int keep = !slash || slash == sweep->scene ? 1 : (int)(slash - sweep->scene);
    snprintf(folder, sizeof folder, "%.*s", keep, slash ? sweep->scene : ".");
    return gn_scene_parse_with(sweep->units, sweep->scene_text, strlen(sweep->scene_text),
                               sweep->scene, folder, all, count, scene, error);
}

gneiss_status gn_sweep_scene(const gn_sweep *sweep, size_t run, gn_scene *scene,
                             gneiss_error *error) {
    return read_scene(sweep, run, true, true, scene, error);
}

/* Returns the unit to be written after a value: numbers of ranges are in SI and without a unit;
 * written values keep their unit. */
static const char *unit_behind(const gn_sweep_parameter *parameter, const char *text) {
    bool bare = parameter->numeric && text[strspn(text, "+-.0123456789eE")] == '\0';
    return bare ? parameter->unit : "";
}

/* Appends "key = value" of a parameter. */
static size_t add_label(const gn_sweep *sweep, size_t run, size_t p, char *text, size_t size,
                        size_t used) {
    const char *value = gn_sweep_value_of(sweep, run, p)->text;
    const char *unit = unit_behind(&sweep->parameters[p], value);
    return used + (size_t)snprintf(text + used, size - used, "%s%s = %s%s%s", used ? ", " : "",
                                   sweep->parameters[p].key, value, *unit ? " " : "", unit);
}

const char *gn_sweep_label_of(const gn_sweep *sweep, size_t run, const bool *shown, char *text,
                              size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (size_t p = 0; p < sweep->parameter_count && used < size; p++)
        if (shown[p] && sweep->parameters[p].count > 1)
            used = add_label(sweep, run, p, text, size, used);
    return text;
}

const char *gn_sweep_label(const gn_sweep *sweep, size_t run, bool seed, char *text, size_t size) {
    size_t used = 0, varied = sweep->seed_count > 1;
    text[0] = '\0';
    for (size_t p = 0; p < sweep->parameter_count; p++) varied += sweep->parameters[p].count > 1;
    for (size_t p = 0; p < sweep->parameter_count && used < size; p++) {
        if (varied && sweep->parameters[p].count == 1) continue;
        used = add_label(sweep, run, p, text, size, used);
    }
    if (seed && sweep->seed_count && used < size)
        snprintf(text + used, size - used, "%sseed %" PRIu64, used ? ", " : "",
                 sweep->runs[run].seed);
    return gn_make_printable(text);
}

/* ---- messages ---- */

/* Returns the parameter value that a line "--set KEY: ..." concerns; NULL: none. */
static const gn_sweep_value *parameter_of_message(const gn_sweep *sweep, size_t run,
                                                  const char *line,
                                                  const gn_sweep_parameter **parameter) {
    if (strncmp(line, "--set ", 6) != 0) return NULL;
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        size_t length = strlen(sweep->parameters[p].key);
        if (strncmp(line + 6, sweep->parameters[p].key, length) != 0 || line[6 + length] != ':')
            continue;
        *parameter = &sweep->parameters[p];
        return gn_sweep_value_of(sweep, run, p);
    }
    return NULL;
}

/* Gives notes about values of the sweep file the place of their key in it, so that many values give
 * one note. */
static void place_notes(const gn_sweep *sweep, size_t run, gn_scene_notes *notes) {
    for (size_t k = 0; sweep->text && k < notes->count; k++) {
        const gn_sweep_parameter *parameter = NULL;
        char text[GN_SCENE_NOTE_SIZE];
        if (!parameter_of_message(sweep, run, notes->text[k], &parameter)) continue;
        snprintf(text, sizeof text, "%s", notes->text[k] + strlen("--set "));
        const int at = snprintf(notes->text[k], GN_SCENE_NOTE_SIZE, "%.200s:%d:%d: parameters.",
                                sweep->source, parameter->where.line, parameter->where.column);
        snprintf(notes->text[k] + at, (size_t)(GN_SCENE_NOTE_SIZE - at), "%.*s",
                 GN_SCENE_NOTE_SIZE - at - 1, text);
        notes->key_at[k] = at;
    }
}

/* Replaces overrides in messages of the scene reader by their places in the sweep file. */
static gneiss_status relocate_messages(const gn_sweep *sweep, size_t run, gneiss_error *error) {
    char said[GNEISS_MESSAGE_SIZE], text[GNEISS_MESSAGE_SIZE] = "", label[512];
    size_t used = 0;
    memcpy(said, error->message, sizeof said);
    for (char *rest = said, *line; (line = strsep(&rest, "\n")) && used + 1 < sizeof text;) {
        const gn_sweep_parameter *parameter = NULL;
        const gn_sweep_value *value = parameter_of_message(sweep, run, line, &parameter);
        const char *gap = used ? "\n" : "";
        int more;
        if (value)
            more = snprintf(text + used, sizeof text - used, "%s%s:%d:%d: %s%s%s", gap,
                            sweep->source, value->where.line, value->where.column,
                            sweep->text ? "parameters." : "test.confinement: ", parameter->key,
                            line + 6 + strlen(parameter->key));
        else if (sweep->parameter_count)
            more = snprintf(text + used, sizeof text - used, "%s%s:%d:%d: with %s: %s", gap,
                            sweep->source, sweep->parameters[0].where.line,
                            sweep->parameters[0].where.column,
                            gn_sweep_label(sweep, run, true, label, sizeof label), line);
        else
            more = snprintf(text + used, sizeof text - used, "%s%s", gap, line);
        if (more > 0) used += (size_t)more;
    }
    return gn_fail(error, error->status, "%s", text);
}

/* Reads the scene without the parameters first, so that its own errors are reported as such. */
static gneiss_status checked_scene(const gn_sweep *sweep, size_t run, bool seeded, gn_scene *scene,
                                   gneiss_error *error) {
    gneiss_error own = {0}, alone = {0};
    gneiss_status status = read_scene(sweep, run, seeded, true, scene, &own);
    if (status == GNEISS_OK) return GNEISS_OK;
    bool same = false;
    if (status == GNEISS_ERROR_INPUT) {
        if (read_scene(sweep, run, seeded, false, scene, &alone) == GNEISS_OK)
            gn_scene_free(scene);
        else
            same = strcmp(alone.message, own.message) == 0;
        if (!same) relocate_messages(sweep, run, &own);
    }
    return gn_fail(error, status, "%s", own.message);
}

/* ---- hashes ---- */

/* Number of files whose hash is stored, so that each is read once. */
enum { FILES_KEPT = 64 };
typedef struct file_hashes {
    size_t count;
    struct {
        char *path;
        uint64_t hash;
    } file[FILES_KEPT];
} file_hashes;

static void free_hashes(file_hashes *known) {
    for (size_t k = 0; k < known->count; k++) free(known->file[k].path);
}

static gneiss_status hash_file(file_hashes *known, const char *path, uint64_t *hash,
                               gneiss_error *error) {
    void *bytes = NULL;
    size_t size = 0;
    for (size_t k = 0; k < known->count; k++)
        if (strcmp(known->file[k].path, path) == 0) {
            *hash = known->file[k].hash;
            return GNEISS_OK;
        }
    GN_TRY(gn_read_bytes(path, &bytes, &size, error));
    *hash = gn_hash_bytes(bytes, size, GN_HASH_SEED);
    free(bytes);
    char *own = known->count < FILES_KEPT ? strdup(path) : NULL;
    if (own) {
        known->file[known->count].path = own;
        known->file[known->count++].hash = *hash;
    }
    return GNEISS_OK;
}

/* Adds to the hash the contents of every file that a section of the scene names. */
static gneiss_status hash_files(file_hashes *known, const gn_section *section, const char *base,
                                uint64_t *hash, gneiss_error *error) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        if (!gn_key_present(key, base)) continue;
        if (key->type == GN_KEY_SECTION)
            GN_TRY(hash_files(known, key->section, base + key->offset, hash, error));
        if (key->type == GN_KEY_FILE && base[key->second]) {
            uint64_t contents = 0;
            GN_TRY(hash_file(known, base + key->second, &contents, error));
            *hash = gn_hash_bytes(&contents, sizeof contents, *hash);
        }
        if (key->type != GN_KEY_LIST) continue;
        const char *array;
        memcpy(&array, base + key->offset, sizeof array);
        size_t count = *(const size_t *)(base + key->second);
        for (size_t item = 0; item < count; item++)
            GN_TRY(hash_files(known, key->section, array + item * key->section->size, hash, error));
    }
    return GNEISS_OK;
}

static bool varies(const gn_sweep *sweep, const char *key) {
    for (size_t p = 0; p < sweep->parameter_count; p++)
        if (strcmp(sweep->parameters[p].key, key) == 0) return true;
    return false;
}

/* Removes paths, because files enter the hash by their contents and not by their paths. */
static void forget_paths(const gn_section *section, char *base) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        if (key->type == GN_KEY_SECTION) forget_paths(key->section, base + key->offset);
        if (key->type == GN_KEY_FILE) base[key->second] = '\0';
        if (key->type != GN_KEY_LIST) continue;
        char *array;
        memcpy(&array, base + key->offset, sizeof array);
        size_t count = *(const size_t *)(base + key->second);
        for (size_t item = 0; item < count; item++)
            forget_paths(key->section, array + item * key->section->size);
    }
}

/* Writes the scene without the keys that do not change results: its name, the output folder, and
 * the number of threads (unless the sweep varies it). */
static gneiss_status plain_text(const gn_sweep *sweep, const gn_scene *scene, char **text,
                                gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *plain = NULL;
    *text = NULL;
    GN_TRY(gn_new(&plain, 1, "a scene", error));
    GN_TRY(gn_scene_copy(scene, plain, error));
    plain->title[0] = plain->output_directory[0] = '\0';
    plain->checkpoint_wall = 0.0;
    if (!varies(sweep, "run.threads")) plain->threads = 0;
    forget_paths(&gn_scene_section, (char *)plain);
    *text = gn_scene_write(plain);
    return *text ? GNEISS_OK : gn_no_memory(error, "the text of a scene");
}

static gneiss_status hash_scene(const gn_sweep *sweep, const gn_scene *scene, file_hashes *known,
                                gn_sweep_run *run, gneiss_error *error) {
    char version[64];
    int length = snprintf(version, sizeof version, "%s %d", gn_version(), FOLDER_FORMAT);
    GN_FREED char *text = NULL, *specimen = gn_scene_write_specimen(scene);
    GN_TRY(plain_text(sweep, scene, &text, error));
    if (!specimen) return gn_no_memory(error, "the text of a specimen");
    run->hash = gn_hash_bytes(version, (size_t)length, GN_HASH_SEED);
    run->hash = gn_hash_bytes(text, strlen(text), run->hash);
    GN_TRY(hash_files(known, &gn_scene_section, (const char *)scene, &run->hash, error));
    if (scene->specimen.pack.shape != GN_SHAPE_NONE)
        run->packing = gn_hash_bytes(specimen, strlen(specimen), GN_HASH_SEED) | 1U;
    return GNEISS_OK;
}

/* ---- runs ---- */

static bool has_random_numbers(const gn_scene *scene) {
    for (size_t k = 0; k < scene->material_count; k++)
        if (scene->materials[k].strength_scatter.kind != GN_SCATTER_NONE ||
            scene->materials[k].stiffness_scatter.kind != GN_SCATTER_NONE)
            return true;
    return scene->specimen.pack.shape != GN_SHAPE_NONE || scene->specimen.lattice.jitter > 0.0 ||
           scene->random_velocity > 0.0 ||
           (scene->has_elements && scene->elements.distortion > 0.0);
}

/* Gives numbers to seeds that were given by their count; they begin at the seed of the scene. */
static gneiss_status number_seeds(gn_sweep *sweep, gn_scene *scene, gneiss_error *error) {
    if (!sweep->seed_count || sweep->seeds) return GNEISS_OK;
    GN_TRY(checked_scene(sweep, 0, false, scene, error));
    uint64_t first = scene->seed;
    gn_scene_free(scene);
    GN_TRY(gn_new(&sweep->seeds, sweep->seed_count, "seeds", error));
    for (size_t k = 0; k < sweep->seed_count; k++) sweep->seeds[k] = first + k;
    return GNEISS_OK;
}

/* Counts the combinations of lists and the points of distributions. */
static gneiss_status count_runs(gn_sweep *sweep, gn_combine combine, size_t *lists, size_t *points,
                                gneiss_error *error) {
    *lists = *points = 1;
    size_t seeds = sweep->seed_count ? sweep->seed_count : 1;
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        size_t count = sweep->parameters[p].count;
        if (sweep->parameters[p].sampled)
            *points = count;
        else if (combine == GN_COMBINE_CROSSED)
            *lists *= count;
        else
            *lists = count > *lists ? count : *lists;
        if (*lists > GN_SWEEP_RUNS_MAX || *lists * *points * seeds > GN_SWEEP_RUNS_MAX)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s:%d:%d: parameters.%s: expected at most %d runs, found more",
                           sweep->source, sweep->parameters[p].where.line,
                           sweep->parameters[p].where.column, sweep->parameters[p].key,
                           GN_SWEEP_RUNS_MAX);
    }
    sweep->combination_count = *lists * *points;
    sweep->run_count = sweep->combination_count * seeds;
    return GNEISS_OK;
}

/* Chooses the values of every run. The last list varies fastest; zipped lists vary together. */
static void choose_values(gn_sweep *sweep, gn_combine combine, size_t points) {
    for (size_t run = 0; run < sweep->run_count; run++) {
        gn_sweep_run *r = &sweep->runs[run];
        r->combination = sweep->seed_count ? run / sweep->seed_count : run;
        r->first_value = run * sweep->parameter_count;
        size_t list = r->combination / points, rest = list;
        for (size_t p = sweep->parameter_count; p-- > 0;) {
            size_t count = sweep->parameters[p].count, place;
            if (sweep->parameters[p].sampled) {
                place = r->combination % points;
            } else if (combine == GN_COMBINE_ZIPPED) {
                place = count > 1 ? list : 0;
            } else {
                place = rest % count;
                rest /= count;
            }
            sweep->chosen[r->first_value + p] = (uint32_t)place;
        }
    }
}

static int by_hash(const void *left, const void *right) {
    const gn_sweep_run *x = *(gn_sweep_run *const *)left, *y = *(gn_sweep_run *const *)right;
    if (x->hash != y->hash) return x->hash < y->hash ? -1 : 1;
    return (x > y) - (x < y);
}

static gneiss_status find_originals(gn_sweep *sweep, gneiss_error *error) {
    GN_FREED gn_sweep_run **order = NULL;
    GN_TRY(gn_new(&order, sweep->run_count, "runs", error));
    for (size_t k = 0; k < sweep->run_count; k++) order[k] = &sweep->runs[k];
    qsort(order, sweep->run_count, sizeof *order, by_hash);
    for (size_t k = 0; k < sweep->run_count; k++)
        order[k]->original = k && order[k - 1]->hash == order[k]->hash
                                 ? order[k - 1]->original
                                 : (size_t)(order[k] - sweep->runs);
    return GNEISS_OK;
}

static gneiss_status read_runs(gn_sweep *sweep, gn_scene *scene, gneiss_error *error) {
    file_hashes known = {0};
    gneiss_status status = number_seeds(sweep, scene, error);
    for (size_t k = 0; status == GNEISS_OK && k < sweep->run_count; k++) {
        gn_sweep_run *r = &sweep->runs[k];
        if (sweep->seed_count) r->seed = sweep->seeds[k % sweep->seed_count];
        status = checked_scene(sweep, k, true, scene, error);
        if (status != GNEISS_OK) break;
        status = hash_scene(sweep, scene, &known, r, error);
        r->threads = scene->threads;
        r->seed = scene->seed;
        sweep->draws |= has_random_numbers(scene);
        place_notes(sweep, k, &scene->notes);
        gn_notes_merge(&sweep->notes, &scene->notes);
        if (!sweep->title[0]) snprintf(sweep->title, sizeof sweep->title, "%.200s", scene->title);
        gn_scene_free(scene);
    }
    free_hashes(&known);
    return status;
}

/* ---- places in the scene that the parameters change; a key may be spelt in several ways ---- */

enum { OVERRIDES_MOST = 64, PLACES_MOST = OVERRIDES_MOST + GN_SWEEP_PARAMETERS_MAX };

typedef struct writer {
    const char *key;
    const gn_sweep_parameter *parameter; /* NULL: from the command line */
    char place[GN_KEY_PATH_SIZE];
} writer;

/* True if `part` equals `whole` or is contained in it. */
static bool holds(const char *whole, const char *part) {
    size_t length = strlen(whole);
    return strncmp(whole, part, length) == 0 && (part[length] == '.' || !part[length]);
}

/* Tells whether two overrides conflict. A part of a value that is the same in every run may be
 * varied: --set gravity=[0, 0, 0] and gravity[2]. */
static bool conflicts(const writer *before, const writer *now) {
    if (holds(now->place, before->place)) return true;
    return before->parameter && before->parameter->count > 1 && holds(before->place, now->place);
}

static gneiss_status refuse(const gn_sweep *sweep, const writer *before, const writer *now,
                            gneiss_error *error) {
    const gn_sweep_parameter *parameter = now->parameter, *other = before->parameter;
    if (!other)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s:%d:%d: parameters.%s: given on the command line as well: --set %s",
                       sweep->source, parameter->where.line, parameter->where.column,
                       parameter->key, before->key);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s:%d:%d: parameters.%s: expected once, found again; first given as %s in line "
                   "%d, column %d",
                   sweep->source, parameter->where.line, parameter->where.column, parameter->key,
                   other->key, other->where.line, other->where.column);
}

static gneiss_status check_one(const gn_sweep *sweep, const gn_tree *tree, writer *all,
                               size_t count, gneiss_error *error) {
    writer *now = &all[count];
    gn_tree_place(tree, now->key, now->place, sizeof now->place);
    for (size_t k = 0; now->parameter && k < count; k++)
        if (conflicts(&all[k], now)) return refuse(sweep, &all[k], now, error);
    return GNEISS_OK;
}

/* Checks a run for conflicts. Overrides are applied in their order, so that names are those at that
 * moment. An override that cannot be applied is reported when the scene is read. */
static gneiss_status check_run(const gn_sweep *sweep, size_t run, gneiss_error *error) {
    writer all[PLACES_MOST];
    gn_tree *tree = NULL;
    size_t first = sweep->override_count < OVERRIDES_MOST ? sweep->override_count : OVERRIDES_MOST;
    if (gn_tree_read(sweep->scene_text, strlen(sweep->scene_text), sweep->scene, &tree, NULL) !=
        GNEISS_OK)
        return GNEISS_OK;
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; status == GNEISS_OK && k < first + sweep->parameter_count; k++) {
        const gn_sweep_parameter *parameter = k < first ? NULL : &sweep->parameters[k - first];
        gn_override put = parameter ? (gn_override){parameter->key,
                                                    gn_sweep_value_of(sweep, run, k - first)->text}
                                    : sweep->overrides[k];
        all[k] = (writer){.key = put.key ? put.key : "", .parameter = parameter};
        status = check_one(sweep, tree, all, k, error);
        if (status == GNEISS_OK && gn_tree_override(tree, &put, NULL) != GNEISS_OK) break;
    }
    gn_tree_free(tree);
    return status;
}

/* Checks all runs for conflicts; places differ between runs only if names do. */
static gneiss_status check_places(const gn_sweep *sweep, gneiss_error *error) {
    bool names = false;
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        const char *dot = strrchr(sweep->parameters[p].key, '.');
        names |= dot && strcmp(dot, ".name") == 0;
    }
    for (size_t run = 0; run < (names ? sweep->run_count : 1); run++)
        GN_TRY(check_run(sweep, run, error));
    return GNEISS_OK;
}

gneiss_status gn_sweep_expand(gn_sweep *sweep, gn_combine combine, gneiss_error *error) {
    size_t lists, points;
    GN_FREED gn_scene *scene = NULL; /* too large for a small stack */
    GN_TRY(count_runs(sweep, combine, &lists, &points, error));
    GN_TRY(gn_new(&sweep->runs, sweep->run_count, "runs", error));
    GN_TRY(gn_new(&sweep->chosen, sweep->run_count * sweep->parameter_count, "values", error));
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    choose_values(sweep, combine, points);
    GN_TRY(check_places(sweep, error));
    GN_TRY(read_runs(sweep, scene, error));
    return find_originals(sweep, error);
}
