/* A YAML text as a tree of nodes with their places, and overrides applied to it. Only the part of
 * YAML that a scene needs is read: one document, no aliases, no tags. */
#ifndef GN_SCENE_TREE_H
#define GN_SCENE_TREE_H

#include "scene/scene.h"

typedef enum gn_node_kind { GN_NODE_NULL, GN_NODE_SCALAR, GN_NODE_LIST, GN_NODE_MAP } gn_node_kind;

typedef struct gn_node {
    gn_node_kind kind;
    const char *key;  /* NULL unless the parent is a map */
    const char *text; /* text of a scalar */
    const char *set;  /* key of the override that gave it; NULL: it is from the file */
    /* key_where: place of the key in a map, else equal to `where` */
    gn_scene_place where, key_where;
    size_t stage; /* number of the stage, from 1, that gave it; 0: none */
    size_t count; /* number of children */
    struct gn_node *first, *last, *next;
} gn_node;

typedef struct gn_tree gn_tree;

/* Parses a text; `name` appears in messages. On success the caller frees *tree. */
gneiss_status gn_tree_read(const char *text, size_t length, const char *name, gn_tree **tree,
                           gneiss_error *error);
void gn_tree_free(gn_tree *tree);
const gn_node *gn_tree_root(const gn_tree *tree);

/* gn_tree_add_map appends an empty map to another one; gn_tree_add appends a value with the
 * children of `value`; NULL: out of memory. */
gn_node *gn_tree_add(gn_tree *tree, gn_node *map, const gn_node *value);
gn_node *gn_tree_add_map(gn_tree *tree, gn_node *map, const gn_node *like);

/* Replaces or adds the value at a key such as walls.top.motion.vz, materials[0].friction or
 * gravity[2]. Elements of lists are addressed by index, base 0, or by their `name`. */
gneiss_status gn_tree_override(gn_tree *tree, const gn_override *override, gneiss_error *error);

/* Writes in a canonical spelling the place that an override of this key changes:
 * materials.0.friction for materials[0].friction and for materials.rock.friction. Steps to missing
 * nodes stay as written. */
void gn_tree_place(const gn_tree *tree, const char *key, char *place, size_t size);

/* Returns the child of a key; NULL if there is none, or `map` is NULL or not a map. */
const gn_node *gn_node_child(const gn_node *map, const char *key);

/* Returns the node at a path of map keys such as "damping.contact.fraction"; NULL: none. */
const gn_node *gn_node_find(const gn_node *map, const char *path);

/* Returns the element of a list by its index, base 0, or its `name`; NULL: none. */
gn_node *gn_node_element(const gn_node *list, const char *name);

/* Writes the children of a map except those that are keys of `without`, one line of YAML each; the
 * caller frees the text with free(). NULL: out of memory. */
struct gn_section;
char *gn_node_write(const gn_node *map, const struct gn_section *without);

/* Returns the element of a list; NULL: none. */
const gn_node *gn_node_item(const gn_node *list, size_t index);

#endif
