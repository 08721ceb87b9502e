/* Checks of stages (check_stages.c). */
#ifndef GN_SCENE_STAGES_CHECK_H
#define GN_SCENE_STAGES_CHECK_H

#include "scene/read.h"

/* Checks the list of stages: names and ends. */
gneiss_status gn_check_stages(const gn_reader *reader, const gn_node *root);

/* Checks the keys that concern dormant particles before the stage is read as a scene, so that
 * messages name the stage's own keys. */
gneiss_status gn_check_stage_dormant(const gn_reader *reader, const gn_node *root, size_t stage);

/* Checks a stage as a whole after the previous one (NULL: there is none): that it can end, and that
 * it changes only what a world can change. */
gneiss_status gn_check_stage(const gn_reader *reader, const gn_node *root, const gn_scene *before,
                             const gn_scene *now, size_t stage);

/* Reads and checks all stages of reader->scene, the base, which has been checked. With
 * reader->wanted_stage the scene of that stage replaces the base. Changes the tree. */
gneiss_status gn_read_stages(gn_reader *reader, gn_tree *tree);

/* Adds a membrane without pressure to the base if a later stage has one, with the keys of the first
 * such stage. Called before the scene is read. Changes the tree. */
gneiss_status gn_stages_add_membrane(const gn_reader *reader, gn_tree *tree);

/* Reads the scene of a stage, index from 0, from text that gn_scene_write wrote. */
gneiss_status gn_scene_parse_stage(const char *text, const char *name, size_t stage,
                                   gn_scene *scene, gneiss_error *error);

#endif
