/* Reading of a tree into the struct, in two steps: each key separately (read.c), then cross-key
 * checks (check.c). Messages state the place in the file. */
#ifndef GN_SCENE_READ_H
#define GN_SCENE_READ_H

#include "scene/manifest.h"
#include "scene/problems.h"
#include "scene/tree.h"
#include "scene/units.h"

typedef struct gn_reader {
    const char *name; /* name of the scene in messages */
    /* folder in which relative paths start; NULL: paths are absolute and files need not exist */
    const char *folder;
    size_t wanted_stage; /* number of the stage, from 1, see gn_read_stages; 0: the base */
    bool specimen_only;  /* see gn_scene_load_specimen */
    double end;          /* s: time.end, up to which formulas are sampled */
    gn_units *units;
    gn_scene *scene;
    gneiss_error *error;
    gn_problems *problems; /* problems found so far; borrowed */
    size_t path_length;
    char path[GN_KEY_PATH_SIZE]; /* path of the key being read */
} gn_reader;

/* Fills reader->scene, which is zeroed before, from the tree; after a failure it still owns arrays.
 * Like gn_check_scene, it continues after a problem and keeps it in reader->problems. */
gneiss_status gn_read_scene(gn_reader *reader, const gn_node *root);

/* Reads another table of keys into its struct, from the whole tree or from a section at the
 * reader's path. `reader->scene` gives the dimension; a problem is kept and not returned. */
gneiss_status gn_read_keys(gn_reader *reader, const gn_section *section, const gn_node *map,
                           void *base);

/* Checks keys against each other and sets the values that follow from others. Checks that could
 * only repeat an earlier problem are skipped. */
gneiss_status gn_check_scene(gn_reader *reader, const gn_node *root);

/* Checks a scene that was read with specimen_only. */
gneiss_status gn_check_shape(gn_reader *reader, const gn_node *root);

/* Fails with the message "file:line:column: path: ..." or "--set key: ...". */
gneiss_status gn_read_fail(const gn_reader *reader, const gn_node *node, gn_scene_place where,
                           const char *path, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Keeps a note about the value of a node in the scene (gn_scene_notes). */
void gn_read_note(const gn_reader *reader, const gn_node *node, const char *path, bool idle,
                  const char *text);

/* Adds the notes of one scene to those of another, without repeating any. */
void gn_notes_merge(gn_scene_notes *to, const gn_scene_notes *from);
/* Adds the notes of a stage; a key that changes something in the stage is not idle. */
void gn_notes_merge_stage(gn_scene_notes *base, const gn_scene_notes *stage);

/* Finds a file of a scene: `file` relative to `folder` (NULL: as written, and it need not exist).
 * If it is a folder, the result is the file `in_folder` in it or, with `in_folder` NULL, the
 * packing in it. Returns NULL and path[GN_PATH_SIZE], or the reason why the file cannot be read. */
const char *gn_find_file(const char *folder, const char *file, const char *in_folder, char *path);

/* Keeps an input error so that reading continues; returns any other failure. */
gneiss_status gn_read_keep_problem(const gn_reader *reader, gneiss_status status);

/* Reads a number with one of the units of `unit` ("1/s|1"); with GN_SLOPE, also an angle, as its
 * tangent. Returns false with a reason on failure. */
bool gn_read_quantity(const gn_reader *reader, const char *text, const char *unit, double *value,
                      char *reason, size_t reason_size);

/* Parses as gn_scene_parse does, with a unit system that several calls share. */
gneiss_status gn_scene_parse_with(gn_units *units, const char *text, size_t length,
                                  const char *name, const char *folder,
                                  const gn_override *overrides, size_t override_count,
                                  gn_scene *scene, gneiss_error *error);

#endif
