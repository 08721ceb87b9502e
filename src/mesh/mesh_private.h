/* Tools of the mesh readers: a file in memory with a reading position, a hash table, and a mesh
 * that grows. */
#ifndef GN_MESH_MESH_PRIVATE_H
#define GN_MESH_MESH_PRIVATE_H

#include "mesh/mesh.h"

#include <stdbool.h>

/* A file in memory; [at, end) is the rest of the section that is being read. */
typedef struct gn_mesh_source {
    const char *path;
    gneiss_error *error;
    double scale;
    unsigned char *bytes; /* followed by a zero byte */
    size_t size;
    size_t at, end;
    const char *section; /* name for messages, "" before the first section */
    bool binary;         /* the fields are binary, not text */
    bool by_offset;      /* messages give byte offsets instead of lines */
} gn_mesh_source;

/* Opens and reads the whole file, and checks `scale`. The source must be closed also on failure. */
gneiss_status gn_mesh_source_open(gn_mesh_source *in, const char *path, double scale,
                                  gneiss_error *error);
void gn_mesh_source_close(gn_mesh_source *in);

/* Fails with GNEISS_ERROR_INPUT and the place of offset `at`: path:line:column, or path, section
 * and byte. */
gneiss_status gn_mesh_refuse(const gn_mesh_source *in, size_t at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
gneiss_status gn_mesh_no_memory(const gn_mesh_source *in);

/* Up to 40 printable characters of the text at `at`, at most up to the next blank. */
typedef struct gn_mesh_shown {
    char text[48];
} gn_mesh_shown;
gn_mesh_shown gn_mesh_show(const gn_mesh_source *in, size_t at);

bool gn_mesh_is_blank(unsigned char c); /* tells whether c is a blank within a line */
bool gn_mesh_is_space(unsigned char c); /* blank or end of a line */

/* Advances to the next row of fields. In text a row is within a line, and rows are separated by any
 * white space; binary rows are contiguous. */
void gn_mesh_next_row(gn_mesh_source *in);
/* Returns the offset of the next field of this line, for messages about its value. */
size_t gn_mesh_field_start(gn_mesh_source *in);
/* Takes the next field of this line of text. `what` names it in messages. */
gneiss_status gn_mesh_take_field(gn_mesh_source *in, const char *what, size_t *start,
                                 size_t *length);
/* Takes an integer of `width` bytes (4 or 8, binary) in [least, most]. */
gneiss_status gn_mesh_take_integer(gn_mesh_source *in, const char *what, size_t width,
                                   int64_t least, int64_t most, int64_t *value);
/* Takes three finite numbers and multiplies them by the scale. */
gneiss_status gn_mesh_take_coordinates(gn_mesh_source *in, double x[3]);
gneiss_status gn_mesh_skip_numbers(gn_mesh_source *in, const char *what, size_t count);
/* Refuses a count for which the rest of the section is too short, so that no memory is allocated
 * for a false header. An item has at least `bytes` bytes. */
gneiss_status gn_mesh_check_count(const gn_mesh_source *in, const char *what, int64_t count,
                                  size_t text_bytes, size_t binary_bytes);
gneiss_status gn_mesh_end_section(gn_mesh_source *in);

/* A hash table with open addressing from 128-bit keys to values >= 0; zeroed, it is empty. */
typedef struct gn_mesh_key {
    uint64_t a, b;
} gn_mesh_key;
typedef struct gn_mesh_table {
    size_t count, slots;
    struct gn_mesh_slot *slot;
} gn_mesh_table;

/* Adds a value unless the key has one; *held is the value that the key then has. Returns false
 * without memory. */
bool gn_mesh_table_add(gn_mesh_table *table, gn_mesh_key key, int64_t value, int64_t *held);
int64_t gn_mesh_table_find(const gn_mesh_table *table, gn_mesh_key key); /* -1: absent */
void gn_mesh_table_free(gn_mesh_table *table);
/* Returns a key that is the same for every order of `count` (2 or 3) nodes. */
gn_mesh_key gn_mesh_face_key(const int32_t *node, int count);
/* Returns a key that is the same for every order of 1 to 4 nodes. */
gn_mesh_key gn_mesh_element_key(const int32_t *node, int count);

/* Makes room for `need` items of `size` bytes, at least doubling it, and keeps the first `used`
 * items. Returns false without memory. */
bool gn_mesh_grow(void **block, size_t *capacity, size_t used, size_t need, size_t size);

/* A list of elements and the room it has. */
typedef struct gn_mesh_list {
    gn_mesh_elements *elements;
    size_t capacity, group_capacity, also_capacity;
} gn_mesh_list;
/* Appends an element with its groups (tags > 0). Returns false without memory. */
bool gn_mesh_add_element(gn_mesh_list *list, const int32_t *node, const int32_t *groups,
                         size_t group_count);
bool gn_mesh_add_membership(gn_mesh_list *list, size_t element, int32_t group);
void gn_mesh_elements_free(gn_mesh_elements *elements);

/* Triangles that a reader of surfaces collects. */
typedef struct gn_mesh_soup {
    double *corner; /* [count][3], m, three per triangle */
    size_t count, capacity;
    double *point; /* [points][3], m: vertices that faces refer to */
    size_t points, point_capacity;
    size_t polygons; /* faces that were divided into triangles */
} gn_mesh_soup;
gneiss_status gn_mesh_obj_corners(gn_mesh_source *in, gn_mesh_soup *soup);
gneiss_status gn_mesh_ply_corners(gn_mesh_source *in, gn_mesh_soup *soup);

/* Welds corner[count][3] (three per triangle) into mesh->node and mesh->triangles. */
gneiss_status gn_mesh_weld(const double *corner, size_t count, const char *name, gn_mesh *mesh,
                           gneiss_error *error);

/* The state of a reader of both formats of $Nodes and $Elements. */
typedef struct gn_msh {
    gn_mesh_source in;
    gn_mesh *mesh;
    int version;              /* 10 times that of the file: 20, 21, 22, 40, 41 */
    unsigned char *inner;     /* [node_count] a node on an edge or face, or inside; NULL: none */
    gn_mesh_table node_index; /* tag -> index */
    gn_mesh_list list[4];     /* lists by dimension */
    gn_mesh_table entity;     /* (dimension, tag) -> 2 * row of entity_first + reversed */
    size_t *entity_first;     /* [entities + 1] into entity_group */
    int32_t *entity_group;    /* > 0 */
    size_t entity_capacity, pool_capacity;
    bool has_entities;
} gn_msh;
/* Entities of $Entities or $PartitionedEntities. */
gneiss_status gn_msh_read_entities(gn_msh *msh, bool partitioned);
gneiss_status gn_msh_read_nodes(gn_msh *msh);
gneiss_status gn_msh_read_elements(gn_msh *msh);

/* A type of elements of gmsh; its corners come first. */
typedef struct gn_msh_type {
    const char *name;
    int dimension, corners, nodes;
} gn_msh_type;
/* NULL: gmsh has no such type, or it is not read. */
const gn_msh_type *gn_msh_type_of(int64_t number);
/* Adds an element, split into triangles or tetrahedra if it is neither; counts what was changed.
 * Returns false without memory. */
bool gn_msh_add(gn_msh *msh, const gn_msh_type *type, const int32_t *node, const int32_t *groups,
                size_t group_count);
/* Exchanges nodes as gmsh does, so that the element is oriented the other way. */
void gn_msh_reverse(const gn_msh_type *type, int32_t *node);
bool gn_msh_mark_inner(gn_msh *msh, int32_t node);
/* Removes nodes that only elements of higher order use, between their corners. */
bool gn_msh_drop_inner(gn_msh *msh);

static inline void gn_mesh_between(const double *from, const double *to, double out[3]) {
    for (int d = 0; d < 3; d++) out[d] = to[d] - from[d];
}

static inline void gn_mesh_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double gn_mesh_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
