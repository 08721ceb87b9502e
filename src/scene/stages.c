/* Stages: the changes of a stage are merged into the tree of the previous scene, and the result is
 * read as a whole. A key that may change therefore keeps its meaning, its checks and its place in
 * the file. */
#include "scene/stages.h"

#include "base/memory.h"
#include "base/names.h"
#include "scene/acts.h"
#include "scene/check.h"
#include "scene/scene.h"
#include "scene/stages_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- conditions that end a run of one stage before time.end ---- */

gn_stops gn_scene_stops(const gn_scene *scene) {
    gn_stops stops = {.peak_drop = scene->stop_peak_drop > 0.0 ? scene->stop_peak_drop : 0.0,
                      .strain = scene->stop_strain};
    /* Conditions are evaluated in rows of the history, so that there is none without a history. A
     * controlled test continues past its peak. */
    if (scene->stop_peak_drop >= 0.0 || scene->stage_count || !scene->history_rows ||
        scene->test.has_control)
        return stops;
    const gn_test_descriptor *by_kind = gn_scene_test(scene);
    const bool said = scene->stop_strain > 0.0 || scene->stop_unbalanced > 0.0;
    stops.peak_drop = by_kind->peak_drop;
    if (!said) stops.strain = by_kind->strain;
    stops.by_kind = by_kind->peak_drop > 0.0;
    stops.strain_by_kind = !said && by_kind->strain > 0.0;
    return stops;
}

double gn_scene_peak_drop(const gn_scene *scene) {
    const double asked = gn_scene_stops(scene).peak_drop, by_kind = gn_scene_test(scene)->peak_drop;
    return asked > 0.0 ? asked : by_kind > 0.0 ? by_kind : 0.5;
}

bool gn_scene_may_end_early(const gn_scene *scene, size_t stage) {
    if (scene->stage_count) {
        const gn_stage *e = &scene->stages[stage];
        return e->strain > 0.0 || e->stress > 0.0 || e->peak_drop > 0.0 || e->unbalanced > 0.0 ||
               e->held > 0.0;
    }
    const gn_stops stops = gn_scene_stops(scene);
    const bool tested = gn_scene_tested(scene);
    return stops.peak_drop > 0.0 || (tested && stops.strain > 0.0) || scene->stop_unbalanced > 0.0;
}

const char *gn_stops_text(const gn_scene *scene, char *text, size_t size) {
    const gn_stops stops = gn_scene_stops(scene);
    const bool said = scene->stop_strain > 0.0 || scene->stop_unbalanced > 0.0;
    int used = 0;
    *text = '\0';
    if (stops.peak_drop > 0.0)
        used = snprintf(text, size, "stress %g below its peak", stops.peak_drop);
    if (stops.by_kind && said && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, ", as %s tests end,",
                         gn_scene_test(scene)->name);
    if (stops.strain > 0.0 && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sstrain %g", used ? " or " : "",
                         stops.strain);
    if (scene->stop_unbalanced > 0.0 && !scene->stage_count && (size_t)used < size)
        used += snprintf(text + used, size - (size_t)used, "%sunbalanced < %g", used ? " or " : "",
                         scene->stop_unbalanced);
    if (stops.by_kind && !said && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, " (as %s tests end; time.stop says otherwise)",
                 gn_scene_test(scene)->name);
    return text;
}

/* ---- keys that may change ---- */

/* Paths that may change are those that begin with one of these; a star stands for any component. */
static const char *const may_change[] = {
    "gravity",
    "damping",
    "materials.*.friction",
    "materials.*.rolling_friction",
    "materials.*.twisting_friction",
    "materials.*.contact_modulus",
    "materials.*.normal_stiffness",
    "materials.*.kratio",
    "materials.*.young",
    "materials.*.poisson",
    "materials.*.alpha",
    "materials.*.beta",
    "materials.*.tensile_strength",
    "materials.*.shear_strength",
    "materials.*.bond_tension_limit",
    "materials.*.bond_shear_limit",
    "materials.*.bond_friction",
    "bonds.enabled",
    "bonds.interaction_range",
    "bonds.overlap_range",
    "bonds.passive_gaps",
    "contacts.*.friction",
    "contacts.*.rolling_friction",
    "contacts.*.twisting_friction",
    "sets.*.motion",
    "sets.*.force",
    "walls.*.motion",
    "walls.*.servo",
    "walls.*.friction",
    "walls.*.rolling_friction",
    "walls.*.twisting_friction",
    "bodies.*.motion",
    "bodies.*.friction",
    "bodies.*.rolling_friction",
    "bodies.*.twisting_friction",
    "membrane.pressure",
    "membrane.ramp",
    "membrane.surface",
    "membrane.faces", /* must stay as at the start, see check_stages.c */
    "membrane.axis",
    "membrane.follow",
    "elements.motions.*.motion",
    "elements.loads.*.force",
    "elements.loads.*.traction",
    "periodic.x",
    "periodic.y",
    "periodic.z",
    "time.step",
    "time.safety",
    "time.contact_steps",
    "time.estimate",
    "time.on_unstable",
    "output.history_rows",
    "output.snapshots",
    "output.fields",
};

static const struct {
    const char *path, *reason;
} fixed[] = {
    {"specimen", "particles are created once, when the run begins"},
    {"sources", "sources hold for the whole run; each has its start and end"},
    {"sinks", "sinks hold for the whole run"},
    {"joints", "joints hold for the whole run"},
    {"elements", "elements are created once, when the run begins; motions and loads may change"},
    {"time.end", "it bounds the whole run; a stage ends by the conditions under its end"},
    {"time.stop", "a stage ends by the conditions under its end"},
    {"time.mass_scaling", "masses are raised once, when the run begins"},
    {"time", "it is the initial state of the run"},
    {"initial", "it is the state at the start of the run"},
    {"walls", "of a wall, motion, servo and friction may change"},
    {"bodies", "of a body, motion and friction may change"},
    {"sets", "of a set, motion and force may change"},
    {"materials", "of a material, friction, stiffness and strength may change"},
    {"contacts", "of a pair of materials, friction may change"},
    {"periodic", "of a periodic box, stress and rate of its sides may change"},
    {"membrane", "it covers the specimen for the whole run; pressure and ramp may change"},
    {"bonds", "the law of bonds is fixed for the whole run"},
    {"test", "all stages belong to one test"},
    {"output", "it is fixed for the whole run; history_rows, snapshots and fields may change"},
    {"", "it is fixed for the whole run"},
};

/* True if a path and a pattern agree over the length of the shorter one; advances both beyond the
 * common part. */
static bool alike(const char **path, const char **pattern) {
    while (**path && **pattern) {
        size_t step = strcspn(*path, "."), wanted = strcspn(*pattern, ".");
        bool any = wanted == 1 && **pattern == '*';
        if (!any && (step != wanted || strncmp(*path, *pattern, step) != 0)) return false;
        *path += step + ((*path)[step] == '.');
        *pattern += wanted + ((*pattern)[wanted] == '.');
    }
    return true;
}

static bool begins_with(const char *path, const char *pattern) {
    return alike(&path, &pattern) && !*pattern;
}

bool gn_stage_may_change(const char *path) {
    for (size_t k = 0; k < sizeof may_change / sizeof *may_change; k++)
        if (begins_with(path, may_change[k])) return true;
    return false;
}

bool gn_stage_may_hold(const char *path) {
    for (size_t k = 0; k < sizeof may_change / sizeof *may_change; k++) {
        const char *own = path, *pattern = may_change[k];
        if (alike(&own, &pattern)) return true;
    }
    return false;
}

static const char *reason_of(const char *path) {
    size_t k = 0;
    while (!begins_with(path, fixed[k].path)) k++;
    return fixed[k].reason;
}

/* ---- merging a stage into the scene ---- */

typedef struct stage_layer {
    gn_reader *reader;
    gn_tree *tree;
    size_t stage; /* index from 0 */
    char path[GN_KEY_PATH_SIZE];
} stage_layer;

static gneiss_status no_memory(const gn_reader *reader) {
    return gn_fail(reader->error, GNEISS_ERROR_MEMORY, "%s: out of memory while reading stages",
                   reader->name);
}

/* Fails with a message that gives the stage in addition to the place. */
static gneiss_status fail_at_key(const stage_layer *layer, const gn_node *node, const char *format,
                                 const char *what, const char *more) {
    char path[GN_KEY_PATH_SIZE + 32], text[512];
    snprintf(path, sizeof path, "stages[%zu].%s", layer->stage, layer->path);
    snprintf(text, sizeof text, format, what, more);
    return gn_read_keep_problem(
        layer->reader, gn_read_fail(layer->reader, node, node->key_where, path, "%s", text));
}

static size_t push(stage_layer *layer, const char *name) {
    size_t before = strlen(layer->path);
    snprintf(layer->path + before, sizeof layer->path - before, "%s%s", before ? "." : "", name);
    return before;
}

static void drop(gn_node *map, const char *key) {
    gn_node **at = &map->first, *last = NULL;
    while (*at) {
        if (strcmp((*at)->key, key) == 0) {
            *at = (*at)->next;
            map->count--;
        } else {
            last = *at;
            at = &last->next;
        }
    }
    map->last = last;
}

static gneiss_status merge_map(stage_layer *layer, gn_node *base, const gn_node *over);

/* Merges elements by name: in a map by their keys, in a list by the value of `name`. */
static gneiss_status merge_list(stage_layer *layer, gn_node *base, const gn_node *over) {
    for (const gn_node *item = over->first; item; item = item->next) {
        const gn_node *said = over->kind == GN_NODE_LIST ? gn_node_child(item, "name") : NULL;
        bool named = said && said->kind == GN_NODE_SCALAR;
        const char *name = over->kind == GN_NODE_MAP ? item->key : named ? said->text : "";
        gn_node *element = base && *name ? (gn_node *)gn_node_element(base, name) : NULL;
        if (!element || item->kind != GN_NODE_MAP) {
            const char *nameless = "expected a name (an element without one is addressed by its "
                                   "number, as in contacts: {0: {friction: 0.3}}), found none%s%s";
            GN_TRY(fail_at_key(layer, item,
                               !*name ? nameless
                               : element
                                   ? "expected a section with the changed keys of '%s'%s"
                                   : "expected the name of an element of the scene, found '%s'%s",
                               name, ""));
            continue;
        }
        size_t mark = push(layer, name);
        GN_TRY(merge_map(layer, element, item));
        layer->path[mark] = '\0';
    }
    return GNEISS_OK;
}

static gneiss_status merge_value(stage_layer *layer, gn_node *base, const gn_node *over,
                                 const gn_key *key) {
    gn_node *old = (gn_node *)gn_node_child(base, over->key);
    if (key && !gn_stage_may_change(layer->path))
        return fail_at_key(layer, over, "expected a key that a stage may change, found '%s': %s",
                           layer->path, reason_of(layer->path));
    bool off = over->kind == GN_NODE_SCALAR && strcmp(over->text, "off") == 0;
    if (off && key && key->type == GN_KEY_SECTION) {
        drop(base, over->key);
        return GNEISS_OK;
    }
    if (!old) {
        old = gn_tree_add(layer->tree, base, over);
        if (!old) return no_memory(layer->reader);
    } else {
        gn_node *next = old->next;
        *old = *over;
        old->next = next;
    }
    return GNEISS_OK;
}

static gneiss_status merge_section(stage_layer *layer, gn_node *base, const gn_node *over) {
    gn_node *old = (gn_node *)gn_node_child(base, over->key);
    if (!old || old->kind != GN_NODE_MAP) {
        drop(base, over->key);
        old = gn_tree_add_map(layer->tree, base, over);
    }
    return old ? merge_map(layer, old, over) : no_memory(layer->reader);
}

/* Removes the alternative of a new key: a wall has either `motion` or `servo`, and a servo either
 * `force` or `stress`. */
static void drop_alternative(gn_node *base, const gn_node *over) {
    const gn_node *motion = gn_node_child(over, "motion"), *servo = gn_node_child(over, "servo");
    if (motion && !servo) drop(base, "servo");
    if (servo && !motion && servo->kind == GN_NODE_MAP) drop(base, "motion");
}

/* Removes the alternative of a new key: sides of a periodic box follow either a stress or a rate.
 */
static void drop_box_alternative(gn_node *base, const gn_node *over) {
    const gn_node *stress = gn_node_child(over, "stress"), *rate = gn_node_child(over, "rate");
    if (stress && !rate) drop(base, "rate");
    if (stress || !rate) return;
    drop(base, "stress");
    drop(base, "stress_of");
    drop(base, "max_rate");
    drop(base, "relaxation");
}

static void drop_servo_alternative(gn_node *base, const gn_node *over) {
    const gn_node *force = gn_node_child(over, "force"), *stress = gn_node_child(over, "stress");
    if (stress && !force) drop(base, "force");
    if (stress || !force) return;
    drop(base, "stress");
    drop(base, "stress_of");
    drop(base, "area");
}

/* Tells whether a key has occurred before: the first of several keys of one name counts, and the
 * others are reported. */
static bool seen(const gn_node *map, const gn_node *child) {
    for (const gn_node *other = map->first; other != child; other = other->next)
        if (strcmp(other->key, child->key) == 0) return true;
    return false;
}

static gneiss_status merge_child(stage_layer *layer, gn_node *base, const gn_node *child) {
    const gn_key *key = gn_scene_key_at(layer->path);
    bool map = child->kind == GN_NODE_MAP, list = child->kind == GN_NODE_LIST;
    const bool empty = key && (map || list) && !child->first && key->type != GN_KEY_TREE;
    if (empty && !gn_stage_may_hold(layer->path)) return merge_value(layer, base, child, key);
    if (key && key->type == GN_KEY_LIST && (map || list))
        return merge_list(layer, (gn_node *)gn_node_child(base, child->key), child);
    if (key && key->type == GN_KEY_SECTION && map) return merge_section(layer, base, child);
    return merge_value(layer, base, child, key);
}

static gneiss_status merge_map(stage_layer *layer, gn_node *base, const gn_node *over) {
    if (begins_with(layer->path, "walls.*")) drop_alternative(base, over);
    if (begins_with(layer->path, "walls.*.servo")) drop_servo_alternative(base, over);
    if (begins_with(layer->path, "periodic.*")) drop_box_alternative(base, over);
    for (const gn_node *child = over->first; child; child = child->next) {
        if (strcmp(child->key, "name") == 0) continue;
        size_t mark = push(layer, child->key);
        if (seen(over, child))
            GN_TRY(fail_at_key(layer, child, "expected once, found '%s' again%s", child->key, ""));
        else
            GN_TRY(merge_child(layer, base, child));
        layer->path[mark] = '\0';
    }
    return GNEISS_OK;
}

/* Merges a stage; its own keys (name, end) are not changes. */
static gneiss_status merge_stage(stage_layer *layer, gn_node *root, const gn_node *stage) {
    for (const gn_node *child = stage->first; child; child = child->next) {
        if (strcmp(child->key, "name") == 0 || strcmp(child->key, "end") == 0) continue;
        snprintf(layer->path, sizeof layer->path, "%s", child->key);
        if (seen(stage, child))
            GN_TRY(fail_at_key(layer, child, "expected once, found '%s' again%s", child->key, ""));
        else
            GN_TRY(merge_child(layer, root, child));
    }
    return GNEISS_OK;
}

static void mark_stage(gn_node *node, size_t stage) {
    node->stage = stage;
    for (gn_node *child = node->first; child; child = child->next) mark_stage(child, stage);
}

/* ---- reading ---- */

static gneiss_status keep_changes(gn_reader *reader, const gn_node *node, gn_stage *stage) {
    char *text = gn_node_write(node, &gn_stage_section);
    if (!text) return no_memory(reader);
    size_t size = strlen(text) + 1;
    if (size > 1) {
        stage->changes = gn_alloc(size);
        if (stage->changes) memcpy(stage->changes, text, size);
        stage->change_size = size;
    }
    free(text);
    return size == 1 || stage->changes ? GNEISS_OK : no_memory(reader);
}

/* Reads the present tree as a scene. Its messages concern keys that the stage changed, or that
 * conflict with these. */
static gneiss_status read_whole(const gn_reader *reader, const gn_node *root, gn_scene *scene) {
    gn_reader own = *reader;
    memset(scene, 0, sizeof *scene);
    snprintf(scene->source, sizeof scene->source, "%s", reader->name);
    own.scene = scene;
    own.path_length = 0;
    own.path[0] = '\0';
    GN_TRY(gn_read_scene(&own, root));
    return gn_check_scene(&own, root);
}

static void point_at(const gn_section *section, const char *from, char *to, gn_scene_place stage);

static void point_at_elements(const gn_key *key, const char *from, char *to, gn_scene_place stage) {
    char *given, *array;
    memcpy(&given, from + key->offset, sizeof given);
    memcpy(&array, to + key->offset, sizeof array);
    const size_t count = *(const size_t *)(const void *)(from + key->second),
                 own = *(const size_t *)(const void *)(to + key->second);
    for (size_t k = 0; given && array && k < count && k < own; k++)
        point_at(key->section, given + k * key->section->size, array + k * key->section->size,
                 stage);
}

/* Copies the places in the file to the scene of a stage, which was read from other text; values
 * that only stages have get the place of the stage. */
static void point_at(const gn_section *section, const char *from, char *to, gn_scene_place stage) {
    if (section->where != GN_NO_WHERE) {
        gn_scene_place given, own;
        memcpy(&given, from + section->where, sizeof given);
        memcpy(&own, to + section->where, sizeof own);
        if (given.line == 0 && own.line > 0) given = stage;
        memcpy(to + section->where, &given, sizeof given);
    }
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        if (key->place_at) memcpy(to + key->place_at, from + key->place_at, sizeof(gn_scene_place));
        if (key->type == GN_KEY_SECTION)
            point_at(key->section, from + key->offset, to + key->offset, stage);
        if (key->type == GN_KEY_LIST) point_at_elements(key, from, to, stage);
    }
}

/* Sets the places used by messages during the run to that of the stage. */
static void point_at_stage(gn_scene *scene, gn_scene_place where) {
    scene->time_where = where;
    for (size_t k = 0; k < scene->wall_count; k++) scene->walls[k].where = where;
    for (size_t k = 0; k < scene->body_count; k++) scene->bodies[k].where = where;
    for (size_t k = 0; k < scene->set_count; k++) scene->sets[k].where = where;
    for (size_t k = 0; k < scene->elements.motion_count; k++)
        scene->elements.motions[k].where = where;
}

/* Returns the number of the last stage that gave a value below the node. */
static size_t last_stage_in(const gn_node *node) {
    size_t stage = node ? node->stage : 0;
    for (const gn_node *child = node ? node->first : NULL; child; child = child->next) {
        size_t inside = last_stage_in(child);
        stage = inside > stage ? inside : stage;
    }
    return stage;
}

static gneiss_status read_stage(const gn_reader *reader, gn_tree *tree, gn_scene *before,
                                size_t stage, gn_scene *now) {
    gn_node *root = (gn_node *)gn_tree_root(tree);
    gn_node *node = (gn_node *)gn_node_item(gn_node_child(root, "stages"), stage);
    gn_reader own = *reader;
    stage_layer l = {.reader = &own, .tree = tree, .stage = stage};
    mark_stage(node, stage + 1);
    GN_TRY(merge_stage(&l, root, node));
    memset(now, 0, sizeof *now);
    GN_TRY(gn_check_stage_dormant(&own, root, stage));
    if (own.problems->count) return GNEISS_OK;
    GN_TRY(read_whole(reader, root, now));
    now->bonds_stage = last_stage_in(gn_node_child(root, "bonds"));
    now->membrane_stage = last_stage_in(gn_node_child(root, "membrane"));
    if (own.problems->count) return GNEISS_OK;
    return gn_check_stage(reader, root, before, now, stage);
}

/* Reads all stages. The base has been checked separately. Problems that a later stage inherits are
 * not repeated, because the first stage with a problem ends the loop. */
static gneiss_status read_all(gn_reader *reader, gn_tree *tree, gn_scene *before, gn_scene *now) {
    gn_scene *base = reader->scene;
    const gn_node *list = gn_node_child(gn_tree_root(tree), "stages");
    gneiss_status status = GNEISS_OK;
    gn_effects united = 0;
    bool presses = false;
    size_t count = base->stage_count;
    for (size_t k = 0; status == GNEISS_OK && k < count; k++)
        status = keep_changes(reader, gn_node_item(list, k), &base->stages[k]);
    if (status == GNEISS_OK) status = gn_check_stages(reader, gn_tree_root(tree));
    for (size_t k = 0; status == GNEISS_OK && !reader->problems->count && k < count; k++) {
        status = read_stage(reader, tree, k ? before : NULL, k, now);
        if (status == GNEISS_OK) { /* otherwise lists may be missing */
            united |= gn_scene_effects(now);
            presses |= gn_scene_may_compress(now);
            gn_notes_merge_stage(&base->notes, &now->notes);
        }
        gn_scene_free(before);
        *before = *now;
        memset(now, 0, sizeof *now);
        if (!reader->wanted_stage || k + 1 != reader->wanted_stage) continue;
        if (status == GNEISS_OK) status = gn_scene_copy(before, now, reader->error);
        if (status != GNEISS_OK) break;
        gn_effects known = base->united;
        const gn_scene_notes notes = base->notes;
        gn_scene_free(base);
        *base = *now;
        base->united = known;
        base->notes = notes;
        memset(now, 0, sizeof *now);
    }
    gn_scene_free(before);
    base->united = united;
    if (status != GNEISS_OK || reader->problems->count || !count) return status;
    const check whole = {.reader = reader, .map = gn_tree_root(tree)};
    GN_TRY(gn_check_keep_problem(&whole, gn_check_requested_fields(&whole, base)));
    return gn_check_keep_problem(&whole, gn_check_hydrostatic_load(&whole, presses));
}

gneiss_status gn_read_stages(gn_reader *reader, gn_tree *tree) {
    gn_scene *both = calloc(2, sizeof *both); /* too large for a stack */
    if (!both) return no_memory(reader);
    gneiss_status status = read_all(reader, tree, &both[0], &both[1]);
    free(both);
    return status;
}

/* ---- a membrane that begins in a later stage ---- */

static const gn_node *first_membrane(const gn_node *stages) {
    for (size_t k = 0; stages && stages->kind == GN_NODE_LIST && k < stages->count; k++) {
        const gn_node *found = gn_node_child(gn_node_item(stages, k), "membrane");
        if (found && found->kind == GN_NODE_MAP) return found;
    }
    return NULL;
}

gneiss_status gn_stages_add_membrane(const gn_reader *reader, gn_tree *tree) {
    static const char *const kept[] = {"pressure", "surface", "faces", "axis", "follow"};
    gn_node *root = (gn_node *)gn_tree_root(tree);
    const gn_node *first = first_membrane(gn_node_child(root, "stages"));
    if (!first || gn_node_child(root, "membrane")) return GNEISS_OK;
    gn_node *base = gn_tree_add_map(tree, root, first);
    if (!base) return no_memory(reader);
    for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
        const gn_node *said = gn_node_child(first, kept[k]);
        if (!said) continue; /* the check reports the missing pressure */
        gn_node *own = gn_tree_add(tree, base, said);
        if (!own) return no_memory(reader);
        if (k > 0) continue;
        own->kind = GN_NODE_SCALAR;
        own->text = "0";
        own->first = own->last = NULL;
        own->count = 0;
    }
    return GNEISS_OK;
}

/* ---- one stage ---- */

typedef struct section_visit {
    void (*visit)(void *context, gn_table *table);
    void *context;
} section_visit;

static void visit_section(const gn_section *section, char *base, const section_visit *visit) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char *at = base + key->offset;
        if (key->type == GN_KEY_SECTION) visit_section(key->section, at, visit);
        gn_table *table;
        for (size_t t = gn_key_tables(key, base, &table); t > 0; t--, table++)
            visit->visit(visit->context, table);
        if (key->type != GN_KEY_LIST) continue;
        char *array;
        memcpy(&array, at, sizeof array);
        size_t count = array ? *(size_t *)(base + key->second) : 0;
        for (size_t item = 0; item < count; item++)
            visit_section(key->section, array + item * key->section->size, visit);
    }
}

void gn_scene_tables(gn_scene *scene, void (*visit_one)(void *context, gn_table *table),
                     void *context) {
    const section_visit v = {visit_one, context};
    visit_section(&gn_scene_section, (char *)scene, &v);
}

gneiss_status gn_scene_stage(const gn_scene *scene, size_t stage, gn_scene *out,
                             gneiss_error *error) {
    char *text = gn_scene_write(scene);
    memset(out, 0, sizeof *out);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the scene of a stage");
    gneiss_status status = gn_scene_parse_stage(text, scene->source, stage, out, error);
    free(text);
    if (status != GNEISS_OK) return status;
    out->allow_gmsh = scene->allow_gmsh;
    point_at(&gn_scene_section, (const char *)scene, (char *)out, scene->stages[stage].where);
    point_at_stage(out, scene->stages[stage].where);
    return GNEISS_OK;
}
