/* Checks of stages (check_stages.c). */
#ifndef GN_SCENE_STAGES_CHECK_H
#define GN_SCENE_STAGES_CHECK_H

#include "scene/read.h"

/* What the list says by itself: names, ends. */
gneiss_status gn_check_stages(const gn_reader *reader, const gn_node *root);

/* What it says of particles that sleep: before it is read with the scene, so that what is wrong is
 * told of its own keys. */
gneiss_status gn_check_stage_asleep(const gn_reader *reader, const gn_node *root, size_t stage);

/* A stage as a whole, after the one before it (NULL: none): that it can end, and that it changes
 * nothing that the world cannot. */
gneiss_status gn_check_stage(const gn_reader *reader, const gn_node *root, const gn_scene *before,
                             const gn_scene *now, size_t stage);

/* Reads and checks all stages of reader->scene, the base, which has been; with
 * reader->wanted_stage the scene of that stage takes the place of the base. Changes the tree. */
gneiss_status gn_read_stages(gn_reader *reader, gn_tree *tree);

/* A membrane that begins in a later stage is there from the start on, without pressure: that of the
 * first stage that has one is laid under them. Before the scene is read. Changes the tree. */
gneiss_status gn_stages_lay_membrane(const gn_reader *reader, gn_tree *tree);

/* The scene of a stage, base 0, from what gn_scene_write wrote. */
gneiss_status gn_scene_parse_stage(const char *text, const char *name, size_t stage,
                                   gn_scene *scene, gneiss_error *error);

#endif
