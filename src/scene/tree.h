/* A YAML text as a tree of nodes that know where they stand, and overrides put on top of it. Only
 * the part of YAML that a scene needs: one document, no aliases, no tags. */
#ifndef GN_SCENE_TREE_H
#define GN_SCENE_TREE_H

#include "scene/scene.h"

typedef enum gn_node_kind { GN_NODE_NULL, GN_NODE_SCALAR, GN_NODE_LIST, GN_NODE_MAP } gn_node_kind;

typedef struct gn_node {
    gn_node_kind kind;
    const char *key;  /* NULL unless the parent is a map */
    const char *text; /* of a scalar */
    const char *set;  /* the key of the override it comes from; NULL: from the file */
    /* key_where: of the key in a map, otherwise the same as where */
    gn_scene_place where, key_where;
    size_t stage; /* that it stands in, base 1; 0: none */
    size_t count; /* children */
    struct gn_node *first, *last, *next;
} gn_node;

typedef struct gn_tree gn_tree;

/* `name` stands in messages. On success *tree is to be freed by the caller. */
gneiss_status gn_tree_read(const char *text, size_t length, const char *name, gn_tree **tree,
                           gneiss_error *error);
void gn_tree_free(gn_tree *tree);
const gn_node *gn_tree_root(const gn_tree *tree);

/* A map without children at the end of another one, or a value with the children of `value`; NULL:
 * out of memory. */
gn_node *gn_tree_add(gn_tree *tree, gn_node *map, const gn_node *value);
gn_node *gn_tree_add_map(gn_tree *tree, gn_node *map, const gn_node *like);

/* Replaces or adds the value at a key such as walls.top.motion.vz, materials[0].friction or
 * gravity[2]. Elements of lists go by index, base 0, or by their `name`. */
gneiss_status gn_tree_override(gn_tree *tree, const gn_override *override, gneiss_error *error);

/* The place that an override of this key writes, in one spelling for all of them:
 * materials.0.friction of materials[0].friction and of materials.rock.friction. Steps to what is
 * not there stand as they are written. */
void gn_tree_place(const gn_tree *tree, const char *key, char *place, size_t size);

/* NULL when there is none, or `map` is NULL or not a map. */
const gn_node *gn_node_child(const gn_node *map, const char *key);

/* The node at a path of map keys such as "damping.contact.fraction"; NULL when there is none. */
const gn_node *gn_node_find(const gn_node *map, const char *path);

/* The element of a list by its index, base 0, or its `name`; NULL when there is none. */
gn_node *gn_node_element(const gn_node *list, const char *name);

/* The children of a map but those that `without` has, a line of YAML each; to be freed with free().
 * NULL: out of memory. */
struct gn_section;
char *gn_node_write(const gn_node *map, const struct gn_section *without);

/* The element of a list; NULL when there is none. */
const gn_node *gn_node_item(const gn_node *list, size_t index);

#endif
