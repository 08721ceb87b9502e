/* Effects that scenes need are named even if this build omits them. */
#define GN_EVERY_EFFECT
#include "scene/scene.h"
#include "scene/sides.h"

#include "base/memory.h"
#include "scene/formula.h"
#include "scene/read.h"
#include "scene/stages_check.h"

#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const size_t size_limit = (size_t)64 << 20;

/* ---- reading ---- */

static const char *key_of(const gn_override *override) {
    return override->key ? override->key : "";
}

static gneiss_status note_overrides(gn_scene *scene, const gn_override *overrides, size_t count,
                                    gneiss_error *error) {
    size_t size = 1, used = 0;
    for (size_t k = 0; k < count; k++) size += strlen(key_of(&overrides[k])) + 1;
    scene->overridden = gn_alloc(size);
    if (!scene->overridden)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: out of memory", scene->source);
    for (size_t k = 0; k < count; k++)
        used +=
            (size_t)snprintf(scene->overridden + used, size - used, "%s\n", key_of(&overrides[k]));
    return GNEISS_OK;
}

/* True if the path of a key is `top` or below it. */
static bool within(const char *path, size_t length, const char *top, size_t top_length) {
    if (length < top_length || memcmp(path, top, top_length) != 0) return false;
    return length == top_length || strchr(".[", path[top_length]);
}

/* Finds the key on the command line that gave the value at a path or around it, or below it if no
 * file gave one; returns the length of the key, 0: none. */
static size_t overriding(const gn_scene *scene, bool filed, const char *path, const char **key) {
    const size_t length = strlen(path);
    const bool below = !filed || strchr(path, '.');
    for (const char *at = scene->overridden; at && *at; at += strcspn(at, "\n") + 1) {
        const size_t size = strcspn(at, "\n");
        *key = at;
        if (within(path, length, at, size) || (below && within(at, size, path, length)))
            return size;
    }
    return 0;
}

gn_place_text gn_scene_at(const gn_scene *scene, gn_scene_place where, const char *path) {
    gn_place_text place;
    const char *key = "";
    size_t size = overriding(scene, where.line > 0, path, &key);
    if (size && strlen(path) == size && memcmp(path, key, size) == 0)
        snprintf(place.text, sizeof place.text, "--set %s", path);
    else if (size)
        snprintf(place.text, sizeof place.text, "--set %.*s: %s", (int)size, key, path);
    else if (where.line > 0)
        snprintf(place.text, sizeof place.text, "%s:%d:%d: %s", scene->source, where.line,
                 where.column, path);
    else
        snprintf(place.text, sizeof place.text, "%s: %s", scene->source, path);
    return place;
}

static gneiss_status parse_tree(gn_reader *reader, gn_tree *tree, const gn_override *overrides,
                                size_t override_count) {
    GN_TRY(note_overrides(reader->scene, overrides, override_count, reader->error));
    for (size_t k = 0; k < override_count; k++) {
        gn_problem_place(reader->problems, (gn_scene_place){INT_MAX, 0}, key_of(&overrides[k]));
        GN_TRY(gn_read_keep_problem(reader, gn_tree_override(tree, &overrides[k], reader->error)));
    }
    const gn_node *root = gn_tree_root(tree);
    GN_TRY(gn_stages_add_membrane(reader, tree));
    GN_TRY(gn_read_scene(reader, root));
    GN_TRY(reader->specimen_only ? gn_check_shape(reader, root) : gn_check_scene(reader, root));
    bool sound = !reader->problems->count && !reader->specimen_only;
    if (sound && reader->scene->stage_count) GN_TRY(gn_read_stages(reader, tree));
    return gn_problems_status(reader->problems, reader->error);
}

/* The reader has to store messages, even if the caller does not ask for them. */
static gneiss_status parse_all(gn_reader *reader, gn_tree *tree, const gn_override *overrides,
                               size_t override_count) {
    gneiss_error own = {0}, *error = reader->error;
    gn_problems *problems = gn_alloc(sizeof *problems);
    if (!problems) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: out of memory", reader->name);
    reader->error = &own;
    reader->problems = problems;
    gneiss_status status = parse_tree(reader, tree, overrides, override_count);
    if (status == GNEISS_ERROR_INPUT && gn_units_exhausted(reader->units))
        status = gn_fail(&own, GNEISS_ERROR_MEMORY, "%s: out of memory while reading units",
                         reader->name);
    reader->error = error;
    reader->problems = NULL;
    gn_free(problems);
    if (status != GNEISS_OK && error) *error = own;
    return status;
}

static gneiss_status check_length(const char *text, size_t length, const char *name,
                                  gneiss_error *error) {
    if (length > size_limit)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a scene of at most %zu MB, found more", name,
                       size_limit >> 20);
    if (strspn(text, " \t\r\n") == length)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s:1:1: expected a scene, found an empty file",
                       name);
    return GNEISS_OK;
}

/* Fills reader->scene; all other fields of the reader are set. */
static gneiss_status parse(gn_reader *reader, const char *text, size_t length,
                           const gn_override *overrides, size_t override_count) {
    const char *name = reader->name;
    gn_scene *scene = reader->scene;
    memset(scene, 0, sizeof *scene);
    GN_TRY(check_length(text, length, name, reader->error));
    snprintf(scene->source, sizeof scene->source, "%s", name);
    gn_tree *tree = NULL;
    /* During parsing numbers have a decimal point, whatever the locale of the calling program. */
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale) return gn_fail(reader->error, GNEISS_ERROR_MEMORY, "%s: out of memory", name);
    locale_t previous = uselocale(c_locale);
    gneiss_status status = gn_tree_read(text, length, name, &tree, reader->error);
    if (status == GNEISS_OK) status = parse_all(reader, tree, overrides, override_count);
    gn_tree_free(tree);
    uselocale(previous);
    freelocale(c_locale);
    if (status != GNEISS_OK) gn_scene_free(scene);
    return status;
}

gneiss_status gn_scene_parse_with(gn_units *units, const char *text, size_t length,
                                  const char *name, const char *folder,
                                  const gn_override *overrides, size_t override_count,
                                  gn_scene *scene, gneiss_error *error) {
    gn_reader reader = {
        .name = name, .folder = folder, .units = units, .scene = scene, .error = error};
    return parse(&reader, text, length, overrides, override_count);
}

/* Parses with a separate unit system. */
static gneiss_status parse_alone(gn_reader *reader, const char *text, size_t length,
                                 const gn_override *overrides, size_t override_count) {
    memset(reader->scene, 0, sizeof *reader->scene);
    reader->units = gn_units_new();
    if (!reader->units)
        return gn_fail(reader->error, GNEISS_ERROR_MEMORY, "%s: out of memory", reader->name);
    gneiss_status status = parse(reader, text, length, overrides, override_count);
    gn_units_free(reader->units);
    return status;
}

gneiss_status gn_scene_parse(const char *text, const char *name, const char *folder,
                             const gn_override *overrides, size_t override_count, gn_scene *scene,
                             gneiss_error *error) {
    if (!folder || !*folder) folder = ".";
    gn_reader reader = {.name = name, .folder = folder, .scene = scene, .error = error};
    return parse_alone(&reader, text, strlen(text), overrides, override_count);
}

gneiss_status gn_scene_parse_saved(const char *text, const char *name, const gn_override *overrides,
                                   size_t override_count, gn_scene *scene, gneiss_error *error) {
    gn_reader reader = {.name = name, .scene = scene, .error = error};
    return parse_alone(&reader, text, strlen(text), overrides, override_count);
}

gneiss_status gn_scene_parse_stage(const char *text, const char *name, size_t stage,
                                   gn_scene *scene, gneiss_error *error) {
    gn_reader reader = {.name = name, .wanted_stage = stage + 1, .scene = scene, .error = error};
    return parse_alone(&reader, text, strlen(text), NULL, 0);
}

/* Reads the whole file and appends a NUL; stops one byte above the limit. */
static gneiss_status read_all(FILE *file, const char *path, char **text, size_t *length,
                              gneiss_error *error) {
    size_t capacity = 1 << 16;
    char *buffer = malloc(capacity + 1);
    *length = 0;
    while (buffer) {
        *length += fread(buffer + *length, 1, capacity - *length, file);
        if (*length < capacity || *length > size_limit) break;
        capacity *= 2;
        char *larger = realloc(buffer, capacity + 1);
        if (!larger) free(buffer);
        buffer = larger;
    }
    if (!buffer) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: out of memory", path);
    if (ferror(file)) {
        int reason = errno;
        free(buffer);
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot read: %s", path, strerror(reason));
    }
    buffer[*length] = '\0';
    *text = buffer;
    return GNEISS_OK;
}

static gneiss_status read_scene_file(const char *path, char **text, size_t *length,
                                     gneiss_error *error) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        /* A missing scene is an input error, not an I/O error. */
        bool absent = errno == ENOENT || errno == ENOTDIR;
        return gn_fail(error,
                       absent            ? GNEISS_ERROR_INPUT
                       : errno == ENOMEM ? GNEISS_ERROR_MEMORY
                                         : GNEISS_ERROR_IO,
                       "%s: cannot open the scene: %s", path, strerror(errno));
    }
    struct stat about;
    gneiss_status status = GNEISS_OK;
    if (fstat(fileno(file), &about) == 0 && S_ISDIR(about.st_mode))
        status =
            gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a scene file, found a folder", path);
    else
        status = read_all(file, path, text, length, error);
    fclose(file);
    return status;
}

static gneiss_status load(gn_reader reader, const gn_override *overrides, size_t override_count) {
    const char *path = reader.name;
    memset(reader.scene, 0, sizeof *reader.scene);
    if (strlen(path) >= GN_PATH_SIZE)
        return gn_fail(reader.error, GNEISS_ERROR_INPUT,
                       "%.80s...: the path of the scene is too long", path);
    char *text = NULL, folder[GN_PATH_SIZE] = ".";
    size_t length = 0;
    GN_TRY(read_scene_file(path, &text, &length, reader.error));
    const char *slash = strrchr(path, '/');
    if (slash) {
        size_t keep = slash == path ? 1 : (size_t)(slash - path);
        memcpy(folder, path, keep);
        folder[keep] = '\0';
    }
    reader.folder = folder;
    gneiss_status status = parse_alone(&reader, text, length, overrides, override_count);
    free(text);
    return status;
}

gneiss_status gn_scene_load(const char *path, const gn_override *overrides, size_t override_count,
                            gn_scene *scene, gneiss_error *error) {
    gn_reader reader = {.name = path, .scene = scene, .error = error};
    return load(reader, overrides, override_count);
}

gneiss_status gn_scene_load_specimen(const char *path, const gn_override *overrides,
                                     size_t override_count, gn_scene *scene, gneiss_error *error) {
    gn_reader reader = {.name = path, .specimen_only = true, .scene = scene, .error = error};
    return load(reader, overrides, override_count);
}

/* ---- freeing ---- */

static void free_section(const gn_section *section, char *base) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char *at = base + key->offset;
        if (key->type == GN_KEY_SECTION) free_section(key->section, at);
        gn_table *table;
        for (size_t t = gn_key_tables(key, base, &table); t > 0; t--, table++) {
            gn_free(table->time);
            gn_free(table->value);
        }
        if (!gn_key_element_size(key)) continue;
        char *array;
        memcpy(&array, at, sizeof array);
        size_t count = array ? *(size_t *)(base + key->second) : 0;
        if (key->type == GN_KEY_LIST)
            for (size_t item = 0; item < count; item++)
                free_section(key->section, array + item * key->section->size);
        gn_free(array);
    }
}

void gn_scene_free(gn_scene *scene) {
    if (!scene) return;
    free_section(&gn_scene_section, (char *)scene);
    gn_formulas_free(scene->formulas);
    gn_free(scene->specimen.packed);
    gn_particle_columns_free(&scene->specimen.packed_columns);
    gn_free(scene->overridden);
    memset(scene, 0, sizeof *scene);
}

void gn_scene_delete(gn_scene **scene) {
    gn_scene_free(*scene);
    gn_free(*scene);
}

/* ---- copying ---- */

/* Replaces the array at *slot by a copy; by NULL if it is empty or memory is lacking. */
static bool own_array(void *slot, size_t count, size_t size) {
    void *from, *own = NULL;
    memcpy(&from, slot, sizeof from);
    if (from && count) own = gn_alloc_array(count, size);
    if (own) memcpy(own, from, count * size);
    memcpy(slot, &own, sizeof own);
    return own || !from || !count;
}

static bool own_table(gn_table *table, gn_formula **formulas) {
    bool held = own_array(&table->time, table->count, sizeof(double));
    held &= own_array(&table->value, table->count, sizeof(double));
    if (!table->formula) return held;
    table->formula = gn_formula_copy(table->formula, formulas);
    return held && table->formula;
}

static bool own_section(const gn_section *section, char *base, gn_formula **formulas) {
    bool held = true;
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char *at = base + key->offset;
        if (key->type == GN_KEY_SECTION) held &= own_section(key->section, at, formulas);
        gn_table *table;
        for (size_t t = gn_key_tables(key, base, &table); t > 0; t--, table++)
            held &= own_table(table, formulas);
        size_t size = gn_key_element_size(key);
        if (!size) continue;
        size_t count = *(size_t *)(base + key->second);
        held &= own_array(at, count, size);
        char *array;
        memcpy(&array, at, sizeof array);
        for (size_t item = 0; key->type == GN_KEY_LIST && array && item < count; item++)
            held &= own_section(key->section, array + item * size, formulas);
    }
    return held;
}

gneiss_status gn_scene_copy(const gn_scene *from, gn_scene *to, gneiss_error *error) {
    *to = *from;
    to->specimen.packed = NULL;
    to->specimen.packed_count = 0;
    to->formulas = NULL;
    to->specimen.packed_columns = (gn_particle_columns){0};
    const size_t size = from->overridden ? strlen(from->overridden) + 1 : 0;
    const bool held = own_array(&to->overridden, size, 1);
    if (own_section(&gn_scene_section, (char *)to, &to->formulas) && held) return GNEISS_OK;
    gn_scene_free(to);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for a copy of the scene",
                   from->source);
}

/* ---- effects ---- */

static bool bonds_possible(const gn_scene *scene) {
    if (scene->bonds != GN_SWITCH_ON) return false;
    bool some = scene->specimen.group != 0;
    for (size_t k = 0; k < scene->set_count; k++) some = some || scene->sets[k].group > 0;
    return some;
}

/* Returns the effects of bonds with tangential springs. */
static gn_effects strength_effects(const gn_scene *scene) {
    bool frictional = false, yields = false;
    for (size_t k = 0; k < scene->material_count; k++) {
        frictional = frictional || scene->materials[k].bond_friction > 0;
        yields = yields || scene->materials[k].yield_stress[0] > 0;
    }
    for (size_t k = 0; k < scene->contact_count; k++)
        frictional = frictional || scene->contacts[k].bond_friction > 0;
    bool softens = scene->softening != GN_SOFTENING_NONE || yields;
    if (!softens && !frictional && scene->coupling != GN_COUPLING_QUADRATIC) return 0;
    gn_effects mask = GN_FX_MOHR;
    if (softens) mask |= GN_FX_SOFTENING | (yields ? GN_FX_YIELD : 0U);
    if (scene->coupling == GN_COUPLING_QUADRATIC) mask |= GN_FX_COUPLED_QUADRATIC;
    if (scene->coupling == GN_COUPLING_LINEAR) mask |= GN_FX_COUPLED_LINEAR;
    if (frictional && scene->confinement == GN_CONFINEMENT_MEAN) mask |= GN_FX_CONFINED;
    return mask;
}

bool gn_scene_has_rolling(const gn_scene *scene) {
    bool rolls = false;
    for (size_t k = 0; k < scene->material_count; k++)
        rolls = rolls || scene->materials[k].rolling_friction > 0 ||
                scene->materials[k].twisting_friction > 0;
    for (size_t k = 0; k < scene->contact_count; k++)
        rolls = rolls || scene->contacts[k].rolling_friction > 0 ||
                scene->contacts[k].twisting_friction > 0;
    for (size_t k = 0; k < gn_scene_sides(scene); k++) {
        gn_scene_surface side = gn_scene_surface_at(scene, k);
        rolls = rolls || side.rolling > 0 || side.twisting > 0;
    }
    return rolls;
}

/* Returns the effects of friction and damping for Hertz's law, for any pair of materials. */
static gn_effects hertz_effects(const gn_scene *scene) {
    bool friction = false, damping = scene->restitution >= 0 || scene->damping_fraction > 0;
    for (size_t k = 0; k < scene->material_count; k++) {
        friction = friction || scene->materials[k].friction > 0;
        damping = damping || scene->materials[k].restitution >= 0;
    }
    for (size_t k = 0; k < scene->contact_count; k++) {
        friction = friction || scene->contacts[k].friction > 0;
        damping = damping || scene->contacts[k].restitution >= 0;
    }
    return GN_FX_PAIRS | GN_FX_HERTZ | (scene->pull ? 0U : GN_FX_NO_PULL) |
           (scene->cohesion != GN_COHESION_NONE ? GN_FX_COHESION : 0U) |
           (friction ? GN_FX_SHEAR | GN_FX_FRICTION : 0U) | (damping ? GN_FX_CONTACT_DAMPING : 0U);
}

static gn_effects contact_effects(const gn_scene *scene) {
    if (gn_scene_hertz(scene)) return hertz_effects(scene);
    bool bonds = bonds_possible(scene), area = gn_scene_by_area(scene), friction = false,
         shear = false;
    for (size_t k = 0; k < scene->material_count; k++) {
        const gn_material *material = &scene->materials[k];
        friction = friction || material->friction > 0;
        shear = shear || (area ? material->beta : material->kratio) > 0;
    }
    for (size_t k = 0; k < scene->contact_count; k++) {
        const gn_contact_def *contact = &scene->contacts[k];
        friction = friction || contact->friction > 0;
        shear = shear || (area ? contact->beta : contact->kratio) > 0;
    }
    shear = shear && (friction || bonds);
    gn_effects mask = GN_FX_PAIRS;
    if (bonds) mask |= GN_FX_BONDS | (area ? GN_FX_AREA : 0U);
    if (shear) mask |= GN_FX_SHEAR;
    if (shear && friction) mask |= GN_FX_FRICTION;
    if (bonds && shear && scene->rotation != GN_SWITCH_OFF && scene->bond_radius_multiplier > 0)
        mask |= GN_FX_BOND_MOMENTS;
    if (shear && bonds) mask |= strength_effects(scene);
    if (bonds && scene->events != GN_SWITCH_OFF) mask |= GN_FX_EVENTS;
    if (scene->restitution >= 0 || scene->damping_fraction > 0) mask |= GN_FX_CONTACT_DAMPING;
    return mask;
}

static gn_effects background_effect(const gn_scene *scene) {
    switch (scene->background) {
    case GN_BACKGROUND_NONE:
        return 0;
    case GN_BACKGROUND_VISCOUS:
        return GN_FX_VISCOUS;
    case GN_BACKGROUND_NONVISCOUS_VECTOR:
        return GN_FX_NONVISCOUS_VECTOR;
    case GN_BACKGROUND_NONVISCOUS_COMPONENT:
        return GN_FX_NONVISCOUS_COMPONENT;
    }
    return 0;
}

static bool is_prescribed(const gn_motion *motion) {
    size_t points = 0;
    for (int k = 0; k < 3; k++) points += motion->velocity[k].count + motion->spin[k].count;
    return points > 0;
}

gn_effects gn_scene_effects(const gn_scene *scene) {
    gn_effects mask = scene->has_specimen ? contact_effects(scene) : GN_FX_PAIRS;
    if (scene->dimension == 3) mask |= GN_FX_SPACE;
    if (scene->has_specimen && scene->rotation != GN_SWITCH_OFF) mask |= GN_FX_ROTATION;
    if (scene->has_elements) mask |= GN_FX_ELEMENTS;
    if (gn_scene_has_gravity(scene)) mask |= GN_FX_GRAVITY;
    for (size_t k = 0; k < scene->set_count; k++) {
        if (scene->sets[k].has_force) mask |= GN_FX_APPLIED;
        if (is_prescribed(&scene->sets[k].motion)) mask |= GN_FX_PRESCRIBED;
    }
    if (scene->has_membrane) mask |= GN_FX_APPLIED | GN_FX_MEMBRANE;
    if (scene->wall_count) mask |= GN_FX_WALLS;
    for (size_t k = 0; k < scene->wall_count; k++)
        if (scene->walls[k].friction > 0) mask |= GN_FX_WALL_SHEAR;
    bool touched = scene->has_elements && scene->elements.has_contact && scene->has_specimen;
    if (scene->body_count || touched) mask |= GN_FX_WALLS | GN_FX_FACETS;
    if (touched && scene->elements.contact.friction > 0) mask |= GN_FX_WALL_SHEAR;
    for (size_t k = 0; k < scene->body_count; k++)
        if (scene->bodies[k].friction > 0) mask |= GN_FX_WALL_SHEAR;
    for (size_t k = 0; k < gn_scene_sides(scene); k++)
        if (mask & GN_FX_FRICTION && *gn_scene_surface_at(scene, k).material)
            mask |= GN_FX_WALL_SHEAR;
    /* Moments of rolling need the storage of tangential forces, even if these are zero. */
    if (scene->has_specimen && gn_scene_has_rolling(scene))
        mask |= GN_FX_ROLLING | GN_FX_SHEAR | GN_FX_FRICTION |
                (mask & GN_FX_WALLS ? GN_FX_WALL_SHEAR : 0U);
    if (scene->has_couple) mask |= GN_FX_OVERLAP;
    if (scene->has_periodic) mask |= GN_FX_PERIODIC;
    if (gn_scene_box_moves(scene)) mask |= GN_FX_CONTACT_FORCES;
    if (scene->has_mass_scaling) mask |= GN_FX_MASS_SCALING;
    if (scene->has_clumps) mask |= GN_FX_CLUMPS;
    if (scene->joint_count) mask |= GN_FX_JOINTS;
    if (scene->orientation == GN_SWITCH_ON && (mask & GN_FX_ROTATION)) mask |= GN_FX_ORIENTATION;
    if (scene->energy != GN_SWITCH_OFF) mask |= GN_FX_ENERGY;
    if (scene->precision == GN_PRECISION_MIXED) mask |= GN_FX_MIXED;
    /* The world stores data for the effects of all stages; background damping needs none. */
    const gn_effects background =
        GN_FX_VISCOUS | GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT;
    return mask | (scene->united & ~background) | background_effect(scene);
}

gn_effects gn_scene_not_built(const gn_scene *scene) {
    gn_effects mask = gn_scene_effects(scene);
    if (scene->has_elements) mask |= GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_ENERGY;
    if (scene->has_elements && scene->elements.formulation == GN_FORMULATION_PRESSURE)
        mask |= GN_FX_PRESSURE;
    return mask & (gn_effects)(GN_WITHOUT);
}

/* ---- looking up ---- */

double gn_table_at(const gn_table *table, double time) {
    size_t count = table->count;
    if (table->formula) return gn_formula_at(table->formula, time - table->start);
    if (count == 0) return 0.0;
    if (count == 1 || time <= table->time[0]) return table->value[0];
    if (time >= table->time[count - 1]) return table->value[count - 1];
    size_t low = 0, high = count - 1;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (table->time[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    double share = (time - table->time[low]) / (table->time[high] - table->time[low]);
    return (1.0 - share) * table->value[low] + share * table->value[high];
}

/* Integrates a formula on intervals of at most the distance of its samples. */
static double formula_between(const gn_table *table, double from, double to) {
    static const double place[3] = {-0.77459666924148337704, 0.0, 0.77459666924148337704};
    const double most = 4.0 * GN_FORMULA_POINTS,
                 spacing =
                     (table->time[table->count - 1] - table->time[0]) / (double)(table->count - 1);
    const double parts = fmin(fmax(ceil((to - from) / spacing), 1.0), most);
    const double half = 0.5 * (to - from) / parts;
    double sum = 0.0;
    for (double k = 0.0; k < parts && to > from; k++)
        for (int p = 0; p < 3; p++)
            sum += half * (p == 1 ? 8.0 : 5.0) / 9.0 *
                   gn_table_at(table, from + half * (2.0 * k + 1.0 + place[p]));
    return sum;
}

double gn_table_between(const gn_table *table, double from, double to) {
    double sum = 0.0, at = from;
    if (table->formula) return formula_between(table, from, to);
    for (size_t k = 0; k <= table->count; k++) {
        double next = k < table->count ? fmin(to, table->time ? table->time[k] : to) : to;
        if (!(next > at)) continue;
        sum += 0.5 * (next - at) * (gn_table_at(table, at) + gn_table_at(table, next));
        at = next;
    }
    return sum;
}

void gn_table_set_constant(gn_table *table, double value) {
    table->count = 1;
    table->value[0] = value;
    table->formula = NULL;
}

void gn_table_delay(gn_table *table, double start) {
    for (size_t k = 0; k < table->count; k++) table->time[k] += start;
    table->start += start;
}

static void take_values(const gn_table over_time[3], double value[3], double time) {
    for (int a = 0; a < 3; a++)
        if (over_time[a].count) value[a] = gn_table_at(&over_time[a], time);
}

void gn_scene_set_time(gn_scene *scene, double time) {
    if (!scene->loads_vary) return;
    take_values(scene->gravity_over_time, scene->gravity, time);
    for (size_t k = 0; k < scene->set_count; k++)
        take_values(scene->sets[k].force_over_time, scene->sets[k].force, time);
    for (size_t k = 0; k < scene->body_count; k++)
        take_values(scene->bodies[k].force_over_time, scene->bodies[k].force, time);
}

int gn_scene_find_wall(const gn_scene *scene, const char *name) {
    for (size_t k = 0; k < scene->wall_count; k++)
        if (strcmp(scene->walls[k].name, name) == 0) return (int)k;
    return -1;
}

gn_spins gn_body_spin_kind(const gn_scene *scene, const gn_body_def *body) {
    int first = scene->dimension == 3 ? 0 : 2, led = 0;
    if (!body->free) return GN_SPINS_PRESCRIBED;
    for (int a = first; a < 3; a++) led += body->motion.spin[a].count > 0;
    return led == 0 ? GN_SPINS_FREE : led == 3 - first ? GN_SPINS_PRESCRIBED : GN_SPINS_SOME;
}

bool gn_body_mass_is_from_surface(const gn_body_def *body) {
    return body->free && !(body->has_reference && body->mass > 0 && body->has_inertia);
}

int gn_scene_find_body(const gn_scene *scene, const char *name) {
    for (size_t k = 0; k < scene->body_count; k++)
        if (strcmp(scene->bodies[k].name, name) == 0) return (int)k;
    return -1;
}

int gn_scene_find_set(const gn_scene *scene, const char *name) {
    for (size_t k = 0; k < scene->set_count; k++)
        if (strcmp(scene->sets[k].name, name) == 0) return (int)k;
    return -1;
}

int gn_scene_find_element_motion(const gn_scene *scene, const char *name) {
    for (size_t k = 0; k < scene->elements.motion_count; k++)
        if (strcmp(scene->elements.motions[k].name, name) == 0) return (int)k;
    return -1;
}

static bool names(const gn_contact_def *contact, const char *name, const char *other) {
    if (!contact->between_count) return false; /* could not be read */
    const char *first = contact->between[0], *second = contact->between[contact->between_count - 1];
    return (strcmp(first, name) == 0 && strcmp(second, other) == 0) ||
           (strcmp(first, other) == 0 && strcmp(second, name) == 0);
}

const gn_contact_def *gn_scene_find_contact(const gn_scene *scene, const gn_material *first,
                                            const gn_material *second) {
    for (size_t k = 0; k < scene->contact_count; k++)
        if (names(&scene->contacts[k], first->name, second->name)) return &scene->contacts[k];
    return NULL;
}

bool gn_scene_from_packing(const gn_scene *scene) {
    const char *path = scene->specimen.from_path, *last = strrchr(path, '/');
    return strcmp(last ? last + 1 : path, GN_PACKING_FILE) == 0;
}

bool gn_scene_end_drives(const gn_scene *scene, const gn_test_end *end) {
    int64_t axis = scene->test.axis;
    for (size_t k = 0; k < end->count; k++) {
        int motion = gn_scene_find_element_motion(scene, end->name[k]),
            set = gn_scene_find_set(scene, end->name[k]);
        if (motion < 0 && set < 0) return true;
        if (motion >= 0 && scene->elements.motions[motion].motion.velocity[axis].count) return true;
        if (set >= 0 && scene->sets[set].motion.velocity[axis].count) return true;
        if (set >= 0 && scene->sets[set].has_force && scene->sets[set].force[axis] != 0.0)
            return true;
    }
    return false;
}

/* Nodes do not rotate, so that finite elements do not resist rolling. */
gn_scene_surface gn_scene_surface_at(const gn_scene *scene, size_t place) {
    const size_t walls = scene->wall_count, bodies = walls + scene->body_count;
    const gn_wall_def *wall = place < walls ? &scene->walls[place] : NULL;
    const gn_body_def *body = !wall && place < bodies ? &scene->bodies[place - walls] : NULL;
    if (wall)
        return (gn_scene_surface){wall->material, wall->friction, wall->rolling_friction,
                                  wall->twisting_friction};
    if (body)
        return (gn_scene_surface){body->material, body->friction, body->rolling_friction,
                                  body->twisting_friction};
    return (gn_scene_surface){scene->elements.contact.material, scene->elements.contact.friction,
                              0.0, 0.0};
}

int gn_scene_find_material(const gn_scene *scene, const char *name) {
    for (size_t k = 0; k < scene->material_count; k++)
        if (strcmp(scene->materials[k].name, name) == 0) return (int)k;
    return -1;
}
