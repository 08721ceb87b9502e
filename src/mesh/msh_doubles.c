/* Merging of elements that a file lists more than once.
 *
 * Format 2.2 writes an element of several groups once for each of them; not every writer puts these
 * in sequence, and parts of format 4.1 may share elements. Elements with the same nodes become one
 * with all their groups, so that nothing is loaded or weighted twice. A solid element that only
 * repeats another one, without a group of its own, is kept twice, and computing volumes from it is
 * refused (gn_mesh_boundary, gn_mesh_check_joints). */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <stdlib.h>

/* A group of an element; `row` is the element into which it is merged. */
typedef struct named_group {
    int64_t row, element, order; /* order: among the groups of this element */
    int32_t group;
} named_group;

typedef struct doubles {
    const gn_mesh_elements *from;
    int64_t *row;      /* [from->count] the first element with the same nodes */
    bool *brings;      /* [from->count] adds a group that earlier elements lack */
    named_group *name; /* [name_count] */
    size_t name_count, found;
} doubles;

static int compare(int64_t a, int64_t b) {
    return (a > b) - (a < b);
}

static int by_row_and_group(const void *a, const void *b) {
    const named_group *p = a, *q = b;
    int order = compare(p->row, q->row);
    if (!order) order = compare(p->group, q->group);
    if (!order) order = compare(p->element, q->element);
    return order ? order : compare(p->order, q->order);
}

static int by_place(const void *a, const void *b) {
    const named_group *p = a, *q = b;
    int order = compare(p->row, q->row);
    if (!order) order = compare(p->element, q->element);
    return order ? order : compare(p->order, q->order);
}

/* Finds the rows; returns false without memory. */
static bool find_rows(doubles *merging) {
    gn_mesh_table table = {0};
    bool room = true;
    for (size_t k = 0; k < merging->from->count && room; k++) {
        const int32_t *node = merging->from->node + (size_t)merging->from->nodes * k;
        room = gn_mesh_table_add(&table, gn_mesh_element_key(node, merging->from->nodes),
                                 (int64_t)k, &merging->row[k]);
        merging->found += room && merging->row[k] != (int64_t)k;
    }
    gn_mesh_table_free(&table);
    return room;
}

/* Collects every group of a row once, from the first element that has it. */
static void collect_names(doubles *merging) {
    const gn_mesh_elements *e = merging->from;
    size_t kept = 0;
    merging->name_count = 0;
    for (size_t k = 0; k < e->count; k++)
        if (e->group[k])
            merging->name[merging->name_count++] =
                (named_group){merging->row[k], (int64_t)k, -1, e->group[k]};
    for (size_t k = 0; k < e->also_count; k++)
        merging->name[merging->name_count++] =
            (named_group){merging->row[e->also[k].element], (int64_t)e->also[k].element, (int64_t)k,
                          e->also[k].group};
    qsort(merging->name, merging->name_count, sizeof *merging->name, by_row_and_group);
    for (size_t k = 0; k < merging->name_count; k++) {
        const named_group *n = &merging->name[k], *last = kept ? &merging->name[kept - 1] : NULL;
        if (last && last->row == n->row && last->group == n->group) continue;
        merging->brings[n->element] = e->group[n->row] != 0;
        merging->name[kept++] = *n;
    }
    merging->name_count = kept;
    qsort(merging->name, merging->name_count, sizeof *merging->name, by_place);
}

static void let_repeated_stand(doubles *merging) {
    for (size_t k = 0; k < merging->from->count; k++)
        if (!merging->brings[k]) merging->row[k] = (int64_t)k;
    collect_names(merging);
}

/* Appends element `row` with its groups, which begin at name *next. */
static bool add_merged(const doubles *merging, size_t row, size_t *next, gn_mesh_list *list) {
    const gn_mesh_elements *e = merging->from;
    size_t number = list->elements->count;
    bool grouped = *next < merging->name_count && merging->name[*next].row == (int64_t)row;
    int32_t group = grouped ? merging->name[(*next)++].group : 0;
    if (!gn_mesh_add_element(list, e->node + (size_t)e->nodes * row, &group, 1)) return false;
    for (; *next < merging->name_count && merging->name[*next].row == (int64_t)row; ++*next)
        if (!gn_mesh_add_membership(list, number, merging->name[*next].group)) return false;
    return true;
}

static bool rebuild(doubles *merging, bool solid, gn_mesh_list *list) {
    const size_t names = merging->from->count + merging->from->also_count;
    gn_mesh_elements merged = {.nodes = merging->from->nodes};
    gn_mesh_list out = {.elements = &merged};
    size_t next = 0;
    merging->name = gn_alloc_array(names + 1, sizeof *merging->name);
    merging->brings = gn_alloc_array(merging->from->count + 1, sizeof *merging->brings);
    bool room = merging->name && merging->brings;
    if (room) collect_names(merging);
    if (room && solid) let_repeated_stand(merging);
    for (size_t k = 0; k < merging->from->count && room; k++)
        if (merging->row[k] == (int64_t)k) room = add_merged(merging, k, &next, &out);
    gn_mesh_elements_free(room ? list->elements : &merged);
    if (!room) return false;
    out.elements = list->elements;
    *list->elements = merged;
    *list = out;
    return true;
}

static bool merge(gn_mesh_list *list, bool solid) {
    doubles d = {.from = list->elements};
    d.row = gn_alloc_array(d.from->count + 1, sizeof *d.row);
    bool room = d.row && find_rows(&d);
    if (room && d.found) room = rebuild(&d, solid, list);
    gn_free(d.row);
    gn_free(d.name);
    gn_free(d.brings);
    return room;
}

gneiss_status gn_msh_merge_doubles(gn_msh *msh) {
    const int highest = msh->mesh->tetrahedra.count ? 3 : 2;
    for (int dimension = 0; dimension <= 3; dimension++)
        if (!merge(&msh->list[dimension], dimension == highest)) return gn_mesh_no_memory(&msh->in);
    return GNEISS_OK;
}
