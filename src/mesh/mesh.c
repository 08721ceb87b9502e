#include "mesh/mesh_private.h"

#include "base/new.h"

#include <string.h>

typedef struct gn_mesh_slot {
    gn_mesh_key key;
    int64_t held; /* value + 1, 0: free */
} gn_mesh_slot;

/* The finaliser of MurmurHash3 (Appleby, 2011) over both halves. */
static uint64_t mix(gn_mesh_key key) {
    uint64_t h = key.a * UINT64_C(0x9e3779b97f4a7c15) + key.b;
    h = (h ^ (h >> 33)) * UINT64_C(0xff51afd7ed558ccd);
    h = (h ^ (h >> 33)) * UINT64_C(0xc4ceb9fe1a85ec53);
    return h ^ (h >> 33);
}

static gn_mesh_slot *slot_of(const gn_mesh_table *table, gn_mesh_key key) {
    size_t k = mix(key) & (table->slots - 1);
    for (;; k = (k + 1) & (table->slots - 1)) {
        gn_mesh_slot *slot = &table->slot[k];
        if (slot->held == 0 || (slot->key.a == key.a && slot->key.b == key.b)) return slot;
    }
}

static bool grow_table(gn_mesh_table *table) {
    gn_mesh_table more = {.count = table->count, .slots = table->slots ? 2 * table->slots : 64};
    more.slot = gn_alloc_array(more.slots, sizeof *more.slot);
    if (!more.slot) return false;
    for (size_t k = 0; k < table->slots; k++)
        if (table->slot[k].held) *slot_of(&more, table->slot[k].key) = table->slot[k];
    gn_free(table->slot);
    *table = more;
    return true;
}

bool gn_mesh_table_add(gn_mesh_table *table, gn_mesh_key key, int64_t value, int64_t *held) {
    if (3 * (table->count + 1) > 2 * table->slots && !grow_table(table)) return false;
    gn_mesh_slot *slot = slot_of(table, key);
    if (slot->held == 0) {
        *slot = (gn_mesh_slot){key, value + 1};
        table->count++;
    }
    *held = slot->held - 1;
    return true;
}

int64_t gn_mesh_table_find(const gn_mesh_table *table, gn_mesh_key key) {
    return table->slots ? slot_of(table, key)->held - 1 : -1;
}

void gn_mesh_table_free(gn_mesh_table *table) {
    gn_free(table->slot);
    *table = (gn_mesh_table){0};
}

gn_mesh_key gn_mesh_face_key(const int32_t *node, int count) {
    uint32_t a = (uint32_t)node[0], b = (uint32_t)node[1], swap;
    uint32_t c = count == 3 ? (uint32_t)node[2] : UINT32_MAX;
    if (a > b) swap = a, a = b, b = swap;
    if (b > c) swap = b, b = c, c = swap;
    if (a > b) swap = a, a = b, b = swap;
    return (gn_mesh_key){(uint64_t)a << 32 | b, c};
}

gn_mesh_key gn_mesh_element_key(const int32_t *node, int count) {
    uint32_t sorted[4] = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX};
    for (int k = 0; k < count; k++) {
        int at = k;
        for (; at > 0 && sorted[at - 1] > (uint32_t)node[k]; at--) sorted[at] = sorted[at - 1];
        sorted[at] = (uint32_t)node[k];
    }
    return (gn_mesh_key){(uint64_t)sorted[0] << 32 | sorted[1],
                         (uint64_t)sorted[2] << 32 | sorted[3]};
}

bool gn_mesh_grow(void **block, size_t *capacity, size_t used, size_t need, size_t size) {
    return gn_grow_array(block, used, need, capacity, size, "parts of a mesh", NULL) == GNEISS_OK;
}

bool gn_mesh_add_membership(gn_mesh_list *list, size_t element, int32_t group) {
    gn_mesh_elements *e = list->elements;
    void *also = e->also;
    if (!gn_mesh_grow(&also, &list->also_capacity, e->also_count, e->also_count + 1,
                      sizeof *e->also))
        return false;
    e->also = also;
    e->also[e->also_count++] = (gn_mesh_membership){element, group};
    return true;
}

bool gn_mesh_add_element(gn_mesh_list *list, const int32_t *node, const int32_t *groups,
                         size_t group_count) {
    gn_mesh_elements *e = list->elements;
    size_t row = (size_t)e->nodes * sizeof *node, count = e->count;
    void *nodes = e->node, *group = e->group;
    bool room = gn_mesh_grow(&nodes, &list->capacity, count, count + 1, row);
    e->node = nodes;
    room = room && gn_mesh_grow(&group, &list->group_capacity, count, count + 1, sizeof *groups);
    e->group = group;
    if (!room) return false;
    memcpy(e->node + (size_t)e->nodes * count, node, row);
    e->group[count] = group_count ? groups[0] : 0;
    e->count++;
    for (size_t k = 1; k < group_count; k++)
        if (!gn_mesh_add_membership(list, count, groups[k])) return false;
    return true;
}

void gn_mesh_elements_free(gn_mesh_elements *elements) {
    gn_free(elements->node);
    gn_free(elements->group);
    gn_free(elements->also);
    *elements = (gn_mesh_elements){0};
}

void gn_mesh_free(gn_mesh *mesh) {
    gn_free(mesh->node);
    gn_free(mesh->groups);
    gn_mesh_elements_free(&mesh->points);
    gn_mesh_elements_free(&mesh->lines);
    gn_mesh_elements_free(&mesh->triangles);
    gn_mesh_elements_free(&mesh->tetrahedra);
    *mesh = (gn_mesh){0};
}
