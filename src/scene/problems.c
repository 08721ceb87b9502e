#include "scene/problems.h"

#include "scene/read.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gn_problem_place(gn_problems *problems, gn_scene_place where, const char *path) {
    problems->at = where;
    snprintf(problems->path, sizeof problems->path, "%s", path);
}

/* Keeps the message in `error` if the status is GNEISS_ERROR_INPUT, so that reading can continue;
 * returns any other status unchanged. */
static gneiss_status problem_keep(gn_problems *problems, gneiss_status status,
                                  const gneiss_error *error) {
    if (status != GNEISS_ERROR_INPUT) return status;
    if (problems->count < GN_PROBLEMS_MAX) {
        gn_problem *next = &problems->problem[problems->count];
        next->where = problems->at;
        memcpy(next->path, problems->path, sizeof next->path);
        memcpy(next->text, error->message, sizeof next->text);
    }
    problems->count++;
    return GNEISS_OK;
}

static size_t kept(const gn_problems *problems) {
    return problems->count < GN_PROBLEMS_MAX ? problems->count : GN_PROBLEMS_MAX;
}

/* --- the message --- */

static int by_place(const void *left, const void *right) {
    const gn_problem *x = *(gn_problem *const *)left, *y = *(gn_problem *const *)right;
    if (x->where.line != y->where.line) return x->where.line < y->where.line ? -1 : 1;
    if (x->where.column != y->where.column) return x->where.column < y->where.column ? -1 : 1;
    return (x > y) - (x < y);
}

/* Each message takes a line; those for which there is no room are counted. */
gneiss_status gn_problems_status(gn_problems *problems, gneiss_error *error) {
    enum { REST = 48 };
    const gn_problem *order[GN_PROBLEMS_MAX];
    char text[GNEISS_MESSAGE_SIZE] = "";
    size_t shown = 0, used = 0;
    if (!problems->count) return GNEISS_OK;
    for (size_t k = 0; k < kept(problems); k++) order[k] = &problems->problem[k];
    qsort(order, kept(problems), sizeof *order, by_place);
    for (; shown < kept(problems); shown++) {
        size_t more = strlen(order[shown]->text) + 1;
        if (shown && used + more + REST > sizeof text) break;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", shown ? "\n" : "",
                                 order[shown]->text);
    }
    if (shown < problems->count && used + REST <= sizeof text)
        snprintf(text + used, sizeof text - used, "\nand %zu more", problems->count - shown);
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s", text);
}

/* Writes "FILE:LINE:COLUMN: PATH: text", or "--set KEY: text"; returns the offset of PATH or KEY.
 */
static int write_place(const gn_reader *reader, const gn_node *node, gn_scene_place where,
                       const char *path, const char *text, char *out, size_t size) {
    char place[GN_PATH_SIZE + 64], stage[32] = "";
    bool same = node && node->set && strcmp(node->set, path) == 0;
    if (node && node->set)
        snprintf(place, sizeof place, "--set %.200s", node->set);
    else
        snprintf(place, sizeof place, "%.*s:%d:%d", GN_PATH_SIZE, reader->name, where.line,
                 where.column);
    /* Keys inside a stage are those of a scene. */
    if (node && node->stage && *path && strncmp(path, "stages", 6) != 0)
        snprintf(stage, sizeof stage, "stages[%zu].", node->stage - 1);
    snprintf(out, size, "%s: %s%.*s%s%s", place, same ? "" : stage, GN_KEY_PATH_SIZE,
             same ? "" : path, same || !*path ? "" : ": ", text);
    return same ? (int)strlen("--set ") : (int)strlen(place) + 2;
}

gneiss_status gn_read_fail(const gn_reader *reader, const gn_node *node, gn_scene_place where,
                           const char *path, const char *format, ...) {
    char text[1024], message[2 * GN_PATH_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    gn_scene_place at = node && node->set ? (gn_scene_place){INT_MAX, 0} : where;
    gn_problem_place(reader->problems, at, path);
    write_place(reader, node, where, path, text, message, sizeof message);
    return gn_fail(reader->error, GNEISS_ERROR_INPUT, "%s", message);
}

/* --- notes --- */

static void add_note(gn_scene_notes *notes, bool idle, int key_at, const char *text) {
    for (size_t k = 0; k < notes->count; k++)
        if (strcmp(notes->text[k], text) == 0) return;
    if (notes->count == GN_SCENE_NOTES_MAX || key_at >= GN_SCENE_NOTE_SIZE) return;
    notes->idle[notes->count] = idle;
    notes->key_at[notes->count] = key_at;
    snprintf(notes->text[notes->count++], GN_SCENE_NOTE_SIZE, "%.*s", GN_SCENE_NOTE_SIZE - 1, text);
}

void gn_read_note(const gn_reader *reader, const gn_node *node, const char *path, bool idle,
                  const char *text) {
    char note[2 * GN_PATH_SIZE];
    int key_at = write_place(reader, node, node->where, path, text, note, sizeof note);
    add_note(&reader->scene->notes, idle, key_at, note);
}

void gn_notes_merge(gn_scene_notes *to, const gn_scene_notes *from) {
    for (size_t k = 0; k < from->count; k++)
        add_note(to, from->idle[k], from->key_at[k], from->text[k]);
}

static bool has_note(const gn_scene_notes *notes, const char *text) {
    for (size_t k = 0; k < notes->count; k++)
        if (strcmp(notes->text[k], text) == 0) return true;
    return false;
}

void gn_notes_merge_stage(gn_scene_notes *base, const gn_scene_notes *stage) {
    const gn_scene_notes before = *base;
    base->count = 0;
    for (size_t k = 0; k < before.count; k++)
        if (!before.idle[k] || has_note(stage, before.text[k]))
            add_note(base, before.idle[k], before.key_at[k], before.text[k]);
    for (size_t k = 0; k < stage->count; k++)
        if (!stage->idle[k]) add_note(base, false, stage->key_at[k], stage->text[k]);
}

gneiss_status gn_read_keep_problem(const gn_reader *reader, gneiss_status status) {
    return problem_keep(reader->problems, status, reader->error);
}

/* --- keys that may have been misread --- */

/* True if a path is `top`, or below it. */
static bool below(const char *path, const char *top) {
    size_t length = strlen(top);
    return strncmp(path, top, length) == 0 && (!path[length] || strchr(".[", path[length]));
}

bool gn_problem_at(const gn_problems *problems, const char *path) {
    for (size_t k = 0; k < kept(problems); k++)
        if (strcmp(problems->problem[k].path, path) == 0) return true;
    return false;
}

bool gn_problem_near(const gn_problems *problems, const char *path) {
    if (problems->count > GN_PROBLEMS_MAX) return true;
    for (size_t k = 0; k < kept(problems); k++)
        if (below(problems->problem[k].path, path) || below(path, problems->problem[k].path))
            return true;
    return false;
}

bool gn_problem_names(const gn_problems *problems, const char *list) {
    if (problems->count > GN_PROBLEMS_MAX) return true;
    for (size_t k = 0; k < kept(problems); k++) {
        const char *path = problems->problem[k].path;
        if (below(list, path)) return true; /* the list itself, or its parent */
        if (!below(path, list)) continue;
        const char *rest = strchr(path + strlen(list), ']');
        if (!rest || !rest[1] || strcmp(rest, "].name") == 0) return true;
    }
    return false;
}
