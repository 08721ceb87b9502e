/* From a tree to the struct, in two steps: every key by itself (read.c), then what keys must hold
 * together (check.c). Messages name the place in the file. */
#ifndef GN_SCENE_READ_H
#define GN_SCENE_READ_H

#include "scene/manifest.h"
#include "scene/problems.h"
#include "scene/tree.h"
#include "scene/units.h"

typedef struct gn_reader {
    const char *name; /* of the scene, in messages */
    /* relative paths start here; NULL: paths are absolute, files need not be there */
    const char *folder;
    bool staged;         /* one of several stages is read: a test may be driven in another */
    size_t wanted_stage; /* base 1, see gn_read_stages; 0: the base */
    bool specimen_only;  /* see gn_scene_load_specimen */
    gn_units *units;
    gn_scene *scene;
    gneiss_error *error;
    gn_problems *problems; /* found so far; borrowed */
    size_t path_length;
    char path[GN_KEY_PATH_SIZE]; /* of the key being read */
} gn_reader;

/* Fills reader->scene, zeroed before, from the tree; what was allocated stays in it on failure.
 * Goes on behind what is wrong, as gn_check_scene does: it is in reader->problems. */
gneiss_status gn_read_scene(gn_reader *reader, const gn_node *root);

/* The same of another table of keys, into its struct: of the whole tree, or of a section of it
 * whose path is the reader's. `reader->scene` says the dimension; a wrong key is kept, not
 * returned. */
gneiss_status gn_read_keys(gn_reader *reader, const gn_section *section, const gn_node *map,
                           void *base);

/* Checks what concerns several keys and completes what follows from others. Leaves out what could
 * only repeat a problem that was found before. */
gneiss_status gn_check_scene(gn_reader *reader, const gn_node *root);

/* The same of a scene read with specimen_only. */
gneiss_status gn_check_shape(gn_reader *reader, const gn_node *root);

/* "file:line:column: path: ..." or "--set key: ...". */
gneiss_status gn_read_fail(const gn_reader *reader, const gn_node *node, gn_scene_place where,
                           const char *path, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Keeps a note about the value of a node in the scene that is read (gn_scene_notes). */
void gn_read_note(const gn_reader *reader, const gn_node *node, const char *path, bool idle,
                  const char *text);

/* Adds the notes of one scene to those of another that does not have them. */
void gn_notes_unite(gn_scene_notes *to, const gn_scene_notes *from);
/* The same of a stage; a key that changes something in it is not idle. */
void gn_notes_of_stage(gn_scene_notes *base, const gn_scene_notes *stage);

/* Where a file of a scene is: `file` from `folder` on (NULL: as it stands, and it need not be
 * there), and in it `in_folder` (NULL: none), else a packing, if it is a folder. NULL and
 * path[GN_PATH_SIZE], or why it cannot be read. */
const char *gn_find_file(const char *folder, const char *file, const char *in_folder, char *path);

/* Keeps what is wrong and goes on; returns what cannot be gone on from. */
gneiss_status gn_read_keep(const gn_reader *reader, gneiss_status status);

/* Reads a number with one of the units of `unit` ("1/s|1"), of GN_SLOPE the tangent of an angle;
 * false with a reason otherwise. */
bool gn_read_quantity(const gn_reader *reader, const char *text, const char *unit, double *value,
                      char *reason, size_t reason_size);

/* gn_scene_parse with a unit system of the caller's, which many calls can share. */
gneiss_status gn_scene_parse_with(gn_units *units, const char *text, size_t length,
                                  const char *name, const char *folder,
                                  const gn_override *overrides, size_t override_count,
                                  gn_scene *scene, gneiss_error *error);

#endif
