/* gmsh .msh: the bodies of $Entities, $Nodes and $Elements in formats 2.0 to 4.1. */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* ---- merging of elements that a file lists more than once.  Format 2.2 writes an element of
 * several groups once for each of them; not every writer puts these in sequence, and parts of
 * format 4.1 may share elements. Elements with the same nodes become one with all their groups, so
 * that nothing is loaded or weighted twice. A solid element that only repeats another one, without
 * a group of its own, is kept twice, and computing volumes from it is refused (gn_mesh_boundary,
 * gn_mesh_check_joints) ---- */

/* A group of an element; `row` is the element with which it is merged. */
typedef struct named_group {
    int64_t row, element, order; /* order among the groups of this element */
    int32_t group;
} named_group;

typedef struct doubles {
    const gn_mesh_elements *from;
    int64_t *row;      /* [from->count] index of the first element with the same nodes */
    bool *brings;      /* [from->count] true: adds a group that earlier elements lack */
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

/* Finds `row`; returns false without memory. */
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

/* Merges elements with the same nodes into one with all their groups. */
static gneiss_status merge_doubles(gn_msh *msh) {
    const int highest = msh->mesh->tetrahedra.count ? 3 : 2;
    for (int dimension = 0; dimension <= 3; dimension++)
        if (!merge(&msh->list[dimension], dimension == highest)) return gn_mesh_no_memory(&msh->in);
    return GNEISS_OK;
}

static gneiss_status refuse_type(const gn_mesh_source *in, size_t at, int64_t type) {
    return gn_mesh_refuse(
        in, at,
        "expected points, lines, triangles, quadrangles, tetrahedra, hexahedra, prisms "
        "or pyramids, found an element of type %lld",
        (long long)type);
}

static gneiss_status take_type(gn_mesh_source *in, const gn_msh_type **type, int64_t *number) {
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "type of elements", 4, INT32_MIN, INT32_MAX, number));
    *type = gn_msh_type_of(*number);
    return *type ? GNEISS_OK : refuse_type(in, start, *number);
}

static gneiss_status allocate_nodes(gn_msh *msh, int64_t count) {
    gn_mesh_source *in = &msh->in;
    GN_TRY(gn_mesh_check_count(in, "nodes", count, sizeof "1 0 0 0", 28));
    if (count == 0) return gn_mesh_refuse(in, in->at, "expected nodes, found a count of 0");
    msh->mesh->node = gn_alloc_array((size_t)count, 3 * sizeof *msh->mesh->node);
    return msh->mesh->node ? GNEISS_OK : gn_mesh_no_memory(in);
}

/* Reads the tag of node number `index`, from 0. */
static gneiss_status take_node_tag(gn_msh *msh, size_t width, size_t index) {
    gn_mesh_source *in = &msh->in;
    int64_t tag, held;
    gn_mesh_next_row(in);
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "tag of a node", width, 1, INT64_MAX, &tag));
    if (!gn_mesh_table_add(&msh->node_index, (gn_mesh_key){(uint64_t)tag, 0}, (int64_t)index,
                           &held))
        return gn_mesh_no_memory(in);
    if (held != (int64_t)index)
        return gn_mesh_refuse(in, start, "expected every node once, found node %lld again",
                              (long long)tag);
    return GNEISS_OK;
}

/* Reads a count; in format 2.2 it is a line of text even in binary files. */
static gneiss_status take_count_line(gn_mesh_source *in, const char *what, int64_t *count) {
    bool binary = in->binary;
    in->binary = false;
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_integer(in, what, 4, 0, INT64_MAX, count));
    in->binary = binary;
    if (!binary) return GNEISS_OK;
    if (in->at < in->end && in->bytes[in->at] == '\r') in->at++;
    if (in->at < in->end && in->bytes[in->at] == '\n') in->at++;
    return GNEISS_OK;
}

static gneiss_status read_nodes_2(gn_msh *msh) {
    gn_mesh *mesh = msh->mesh;
    int64_t count;
    GN_TRY(take_count_line(&msh->in, "number of nodes", &count));
    GN_TRY(allocate_nodes(msh, count));
    for (size_t k = 0; k < (size_t)count; k++) {
        GN_TRY(take_node_tag(msh, 4, k));
        GN_TRY(gn_mesh_take_coordinates(&msh->in, mesh->node + 3 * k));
    }
    mesh->node_count = (size_t)count;
    return GNEISS_OK;
}

/* Reads dimension and tag of the entity of a block; format 4.0 has them in the other order. */
static gneiss_status take_entity(gn_msh *msh, int64_t *dimension, int64_t *tag) {
    gn_mesh_source *in = &msh->in;
    if (msh->version == 40)
        GN_TRY(gn_mesh_take_integer(in, "tag of an entity", 4, INT32_MIN, INT32_MAX, tag));
    GN_TRY(gn_mesh_take_integer(in, "dimension of an entity", 4, 0, 3, dimension));
    if (msh->version == 40) return GNEISS_OK;
    return gn_mesh_take_integer(in, "tag of an entity", 4, INT32_MIN, INT32_MAX, tag);
}

/* Reads node number `index`; in format 4.1 all tags of a block stand before its coordinates. */
static gneiss_status take_block_node(gn_msh *msh, size_t index, size_t parameters) {
    gn_mesh_source *in = &msh->in;
    if (msh->version == 40)
        GN_TRY(take_node_tag(msh, 4, index));
    else
        gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_coordinates(in, msh->mesh->node + 3 * index));
    return gn_mesh_skip_numbers(in, "coordinate on the entity", parameters);
}

static gneiss_status read_node_block(gn_msh *msh, int64_t total) {
    gn_mesh_source *in = &msh->in;
    gn_mesh *mesh = msh->mesh;
    int64_t dimension, tag, parametric, count;
    gn_mesh_next_row(in);
    GN_TRY(take_entity(msh, &dimension, &tag));
    GN_TRY(gn_mesh_take_integer(in, "parametric (0 or 1)", 4, 0, 1, &parametric));
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "number of nodes in the block", 8, 0, INT64_MAX, &count));
    if (count > total - (int64_t)mesh->node_count)
        return gn_mesh_refuse(in, start, "expected %lld nodes in all, found %zu and %lld more",
                              (long long)total, mesh->node_count, (long long)count);
    size_t first = mesh->node_count, parameters = parametric ? (size_t)dimension : 0;
    for (size_t k = 0; msh->version != 40 && k < (size_t)count; k++)
        GN_TRY(take_node_tag(msh, 8, first + k));
    for (size_t k = 0; k < (size_t)count; k++) GN_TRY(take_block_node(msh, first + k, parameters));
    mesh->node_count += (size_t)count;
    return GNEISS_OK;
}

/* Reads number of blocks and total; in format 4.1 also the least and greatest tag, which are not
 * used. */
static gneiss_status take_block_header(gn_msh *msh, const char *what, int64_t *blocks,
                                       int64_t *total) {
    gn_mesh_source *in = &msh->in;
    int64_t ignored;
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_integer(in, "number of blocks", 8, 0, INT64_MAX, blocks));
    GN_TRY(gn_mesh_take_integer(in, what, 8, 0, INT64_MAX, total));
    for (int k = 0; msh->version != 40 && k < 2; k++)
        GN_TRY(
            gn_mesh_take_integer(in, k ? "greatest tag" : "least tag", 8, 0, INT64_MAX, &ignored));
    return gn_mesh_check_count(in, "blocks", *blocks, sizeof "0 1 0 0", 20);
}

static gneiss_status read_nodes_4(gn_msh *msh) {
    int64_t blocks, total;
    GN_TRY(take_block_header(msh, "number of nodes", &blocks, &total));
    GN_TRY(allocate_nodes(msh, total));
    for (int64_t b = 0; b < blocks; b++) GN_TRY(read_node_block(msh, total));
    if ((int64_t)msh->mesh->node_count != total)
        return gn_mesh_refuse(&msh->in, msh->in.at, "expected %lld nodes in all, found %zu",
                              (long long)total, msh->mesh->node_count);
    return GNEISS_OK;
}

gneiss_status gn_msh_read_nodes(gn_msh *msh) {
    GN_TRY(msh->version >= 40 ? read_nodes_4(msh) : read_nodes_2(msh));
    return gn_mesh_end_section(&msh->in);
}

static gneiss_status take_physical_tags(gn_msh *msh, size_t *used, bool *reversed) {
    gn_mesh_source *in = &msh->in;
    int64_t count, tag;
    GN_TRY(gn_mesh_take_integer(in, "number of physical tags", 8, 0, INT64_MAX, &count));
    GN_TRY(gn_mesh_check_count(in, "physical tags", count, sizeof "1", 4));
    void *pool = msh->entity_group;
    if (!gn_mesh_grow(&pool, &msh->pool_capacity, *used, *used + (size_t)count,
                      sizeof *msh->entity_group))
        return gn_mesh_no_memory(in);
    msh->entity_group = pool;
    for (int64_t k = 0; k < count; k++) {
        GN_TRY(gn_mesh_take_integer(in, "physical tag", 4, -INT32_MAX, INT32_MAX, &tag));
        if (tag == 0) continue;
        if (msh->entity_first[msh->entity.count] == *used) *reversed = tag < 0;
        msh->entity_group[(*used)++] = (int32_t)(tag < 0 ? -tag : tag);
    }
    return GNEISS_OK;
}

/* Reads the dimension of the parent of an entity of a partitioned mesh, and skips its partitions.
 */
static gneiss_status take_parent(gn_mesh_source *in, int64_t *dimension) {
    int64_t ignored, count;
    GN_TRY(gn_mesh_take_integer(in, "dimension of the parent", 4, -1, 3, dimension));
    GN_TRY(gn_mesh_take_integer(in, "tag of the parent", 4, INT32_MIN, INT32_MAX, &ignored));
    GN_TRY(gn_mesh_take_integer(in, "number of partitions", 8, 0, INT64_MAX, &count));
    GN_TRY(gn_mesh_check_count(in, "partitions", count, sizeof "1", 4));
    for (int64_t k = 0; k < count; k++)
        GN_TRY(gn_mesh_take_integer(in, "partition", 4, INT32_MIN, INT32_MAX, &ignored));
    return GNEISS_OK;
}

static gneiss_status read_entity(gn_msh *msh, int dimension, bool partitioned, size_t *used) {
    gn_mesh_source *in = &msh->in;
    int64_t tag, held, bounding, parent = dimension;
    size_t row = msh->entity.count;
    bool reversed = false;
    gn_mesh_next_row(in);
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "tag of an entity", 4, INT32_MIN, INT32_MAX, &tag));
    if (partitioned) GN_TRY(take_parent(in, &parent));
    GN_TRY(gn_mesh_skip_numbers(in, "side of the entity's box",
                                dimension || msh->version == 40 ? 6 : 3));
    const size_t before = *used;
    GN_TRY(take_physical_tags(msh, used, &reversed));
    /* An interface of partitions has the number of its parent's group, which is another group in
     * its own dimension. */
    if (parent != dimension) *used = before, reversed = false;
    int64_t value = 2 * (int64_t)row + reversed;
    if (!gn_mesh_table_add(&msh->entity, (gn_mesh_key){(uint64_t)dimension, (uint64_t)tag}, value,
                           &held))
        return gn_mesh_no_memory(in);
    if (msh->entity.count == row)
        return gn_mesh_refuse(in, start,
                              "expected every entity once, found entity %lld of "
                              "dimension %d again",
                              (long long)tag, dimension);
    void *first = msh->entity_first;
    if (!gn_mesh_grow(&first, &msh->entity_capacity, row + 1, row + 2, sizeof *msh->entity_first))
        return gn_mesh_no_memory(in);
    msh->entity_first = first;
    msh->entity_first[row + 1] = *used;
    if (dimension == 0) return GNEISS_OK;
    GN_TRY(gn_mesh_take_integer(in, "number of bounding entities", 8, 0, INT64_MAX, &bounding));
    GN_TRY(gn_mesh_check_count(in, "bounding entities", bounding, sizeof "1", 4));
    for (int64_t k = 0; k < bounding; k++)
        GN_TRY(gn_mesh_take_integer(in, "bounding entity", 4, INT32_MIN, INT32_MAX, &tag));
    return GNEISS_OK;
}

/* Reads the numbers of partitions and of ghost entities, and skips the latter. */
static gneiss_status skip_ghosts(gn_mesh_source *in) {
    int64_t count, ignored;
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_integer(in, "number of partitions", 8, 0, INT64_MAX, &ignored));
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_integer(in, "number of ghost entities", 8, 0, INT64_MAX, &count));
    GN_TRY(gn_mesh_check_count(in, "ghost entities", count, sizeof "1 1", 8));
    for (int64_t k = 0; k < 2 * count; k++) {
        gn_mesh_next_row(in);
        GN_TRY(gn_mesh_take_integer(in, "ghost entity", 4, INT32_MIN, INT32_MAX, &ignored));
    }
    return GNEISS_OK;
}

gneiss_status gn_msh_read_entities(gn_msh *msh, bool partitioned) {
    gn_mesh_source *in = &msh->in;
    int64_t counts[4];
    size_t used = msh->has_entities ? msh->entity_first[msh->entity.count] : 0;
    void *first = msh->entity_first;
    if (!gn_mesh_grow(&first, &msh->entity_capacity, msh->entity.count, msh->entity.count + 1,
                      sizeof *msh->entity_first))
        return gn_mesh_no_memory(in);
    msh->entity_first = first;
    msh->has_entities = true;
    if (partitioned) GN_TRY(skip_ghosts(in));
    gn_mesh_next_row(in);
    for (int d = 0; d < 4; d++)
        GN_TRY(gn_mesh_take_integer(in, "number of entities", 8, 0, INT64_MAX, &counts[d]));
    for (int d = 0; d < 4; d++) {
        GN_TRY(gn_mesh_check_count(in, "entities", counts[d], sizeof "1 0 0 0 0", 36));
        for (int64_t k = 0; k < counts[d]; k++) GN_TRY(read_entity(msh, d, partitioned, &used));
    }
    return gn_mesh_end_section(in);
}

static gneiss_status take_node(gn_msh *msh, size_t width, int32_t *node, int64_t *tag) {
    gn_mesh_source *in = &msh->in;
    size_t start = gn_mesh_field_start(in);
    GN_TRY(gn_mesh_take_integer(in, "node of an element", width, 1, INT64_MAX, tag));
    int64_t index = gn_mesh_table_find(&msh->node_index, (gn_mesh_key){(uint64_t)*tag, 0});
    if (index < 0)
        return gn_mesh_refuse(in, start, "expected a node of $Nodes, found node %lld",
                              (long long)*tag);
    *node = (int32_t)index;
    return GNEISS_OK;
}

/* Reads the corners of an element as indices; nodes on its edges, faces and inside follow them and
 * are marked. `node` has room for 8. */
static gneiss_status take_element_nodes(gn_msh *msh, size_t width, const gn_msh_type *type,
                                        int32_t *node) {
    gn_mesh_source *in = &msh->in;
    for (int k = 0; k < type->nodes; k++) {
        int64_t tag;
        int32_t other = 0, *at = k < type->corners ? &node[k] : &other;
        size_t start = gn_mesh_field_start(in);
        GN_TRY(take_node(msh, width, at, &tag));
        if (k >= type->corners && !gn_msh_mark_inner(msh, other)) return gn_mesh_no_memory(in);
        for (int m = 0; k < type->corners && m < k; m++)
            if (node[m] == node[k])
                return gn_mesh_refuse(in, start,
                                      "expected different nodes in an element, found node %lld "
                                      "twice",
                                      (long long)tag);
    }
    return GNEISS_OK;
}

/* Reads tags and nodes of one element of format 2.2. */
static gneiss_status read_element_2(gn_msh *msh, const gn_msh_type *type, int64_t tags) {
    gn_mesh_source *in = &msh->in;
    int64_t group = 0, other;
    int32_t node[8];
    for (int64_t k = 0; k < tags; k++)
        GN_TRY(gn_mesh_take_integer(in, k ? "tag of an element" : "physical tag of an element", 4,
                                    -INT32_MAX, INT32_MAX, k ? &other : &group));
    GN_TRY(take_element_nodes(msh, 4, type, node));
    if (type->dimension == 0 && group == 0) return GNEISS_OK;
    const int32_t tag = (int32_t)(group < 0 ? -group : group);
    return gn_msh_add(msh, type, node, &tag, 1) ? GNEISS_OK : gn_mesh_no_memory(in);
}

static gneiss_status read_text_element_2(gn_msh *msh) {
    gn_mesh_source *in = &msh->in;
    const gn_msh_type *type;
    int64_t number, tags;
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_integer(in, "number of an element", 4, INT64_MIN, INT64_MAX, &number));
    GN_TRY(take_type(in, &type, &number));
    GN_TRY(gn_mesh_take_integer(in, "number of tags", 4, 0, INT32_MAX, &tags));
    return read_element_2(msh, type, tags);
}

/* Reads a run of elements of one type; reduces *left. */
static gneiss_status read_binary_run_2(gn_msh *msh, int64_t *left) {
    gn_mesh_source *in = &msh->in;
    const gn_msh_type *type;
    int64_t count, tags, number;
    GN_TRY(take_type(in, &type, &number));
    GN_TRY(gn_mesh_take_integer(in, "number of elements that follow", 4, 1, *left, &count));
    GN_TRY(gn_mesh_take_integer(in, "number of tags", 4, 0, INT32_MAX, &tags));
    GN_TRY(gn_mesh_check_count(in, "elements", count, 1,
                               4 * ((size_t)tags + (size_t)type->nodes + 1)));
    for (int64_t k = 0; k < count; k++) {
        GN_TRY(gn_mesh_take_integer(in, "number of an element", 4, INT32_MIN, INT32_MAX, &number));
        GN_TRY(read_element_2(msh, type, tags));
    }
    *left -= count;
    return GNEISS_OK;
}

static gneiss_status read_elements_2(gn_msh *msh) {
    gn_mesh_source *in = &msh->in;
    int64_t left;
    GN_TRY(take_count_line(in, "number of elements", &left));
    GN_TRY(gn_mesh_check_count(in, "elements", left, sizeof "1 15 0 1", 8));
    while (in->binary && left > 0) GN_TRY(read_binary_run_2(msh, &left));
    for (; left > 0; left--) GN_TRY(read_text_element_2(msh));
    return GNEISS_OK;
}

/* The groups of an entity's elements, and whether these are reversed. */
typedef struct entity_groups {
    const int32_t *tag;
    size_t count;
    bool reversed;
} entity_groups;

static gneiss_status find_groups(const gn_msh *msh, size_t at, int64_t dimension, int64_t tag,
                                 entity_groups *groups) {
    if (!msh->has_entities) return GNEISS_OK;
    gn_mesh_key key = {(uint64_t)dimension, (uint64_t)tag};
    int64_t held = gn_mesh_table_find(&msh->entity, key);
    if (held < 0)
        return gn_mesh_refuse(&msh->in, at,
                              "expected an entity of $Entities, found entity %lld of dimension "
                              "%lld",
                              (long long)tag, (long long)dimension);
    size_t first = msh->entity_first[held / 2];
    groups->tag =
        msh->entity_group ? msh->entity_group + first : NULL; /* no entity is in a group */
    groups->count = msh->entity_first[held / 2 + 1] - first;
    groups->reversed = held % 2;
    return GNEISS_OK;
}

static gneiss_status take_element_block(gn_msh *msh, int64_t *left, const gn_msh_type **type,
                                        int64_t *count, entity_groups *groups) {
    gn_mesh_source *in = &msh->in;
    int64_t dimension, tag, number;
    gn_mesh_next_row(in);
    size_t start = gn_mesh_field_start(in);
    GN_TRY(take_entity(msh, &dimension, &tag));
    GN_TRY(take_type(in, type, &number));
    if ((*type)->dimension != dimension)
        return gn_mesh_refuse(in, start,
                              "expected elements of dimension %lld, found type %lld (%s)",
                              (long long)dimension, (long long)number, (*type)->name);
    GN_TRY(gn_mesh_take_integer(in, "number of elements in the block", 8, 0, *left, count));
    *left -= *count;
    return find_groups(msh, start, dimension, tag, groups);
}

static gneiss_status read_element_block(gn_msh *msh, int64_t *left) {
    gn_mesh_source *in = &msh->in;
    const size_t width = msh->version == 40 ? 4 : 8;
    const gn_msh_type *type;
    int64_t count = 0, number;
    entity_groups groups = {0};
    GN_TRY(take_element_block(msh, left, &type, &count, &groups));
    for (int64_t k = 0; k < count; k++) {
        int32_t node[8];
        gn_mesh_next_row(in);
        GN_TRY(gn_mesh_take_integer(in, "tag of an element", width, 0, INT64_MAX, &number));
        GN_TRY(take_element_nodes(msh, width, type, node));
        if (type->dimension == 0 && groups.count == 0) continue;
        if (groups.reversed) gn_msh_reverse(type, node);
        if (!gn_msh_add(msh, type, node, groups.tag, groups.count)) return gn_mesh_no_memory(in);
    }
    return GNEISS_OK;
}

static gneiss_status read_elements_4(gn_msh *msh) {
    gn_mesh_source *in = &msh->in;
    int64_t blocks, left;
    GN_TRY(take_block_header(msh, "number of elements", &blocks, &left));
    GN_TRY(gn_mesh_check_count(in, "elements", left, sizeof "1 1", msh->version == 40 ? 8 : 16));
    for (int64_t b = 0; b < blocks; b++) GN_TRY(read_element_block(msh, &left));
    if (left == 0) return GNEISS_OK;
    return gn_mesh_refuse(in, in->at, "expected %lld elements more, found the last block",
                          (long long)left);
}

gneiss_status gn_msh_read_elements(gn_msh *msh) {
    const gn_mesh *mesh = msh->mesh;
    gn_mesh_source *in = &msh->in;
    size_t start = in->at;
    GN_TRY(msh->version >= 40 ? read_elements_4(msh) : read_elements_2(msh));
    GN_TRY(gn_mesh_end_section(in));
    GN_TRY(merge_doubles(msh));
    if (!gn_msh_drop_inner(msh)) return gn_mesh_no_memory(in);
    if (mesh->lines.count + mesh->triangles.count + mesh->tetrahedra.count == 0)
        return gn_mesh_refuse(in, start,
                              "expected lines, triangles or tetrahedra, found none of them");
    return GNEISS_OK;
}
