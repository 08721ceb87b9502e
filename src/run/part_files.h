/* The parts of a world in files: snapshots, their groups in results.h5, their shares of a
 * checkpoint. */
#ifndef GN_RUN_PART_FILES_H
#define GN_RUN_PART_FILES_H

#include "frame/parts.h"
#include "run/output_table.h"
#include "world/world.h"

/* --- solids of finite elements --- */

/* Length of the path of a group or data set of a solid in a file: the plain name for the first
 * solid, then elements_2/name and so on. */
enum { GN_ELEMENT_PATH = 160 };
const char *gn_output_elements_path(size_t solid, const char *name, char path[GN_ELEMENT_PATH]);
/* The name of a solid's file: `name`, then name_2 and so on. */
const char *gn_output_elements_file(size_t solid, const char *name, char file[GN_ELEMENT_PATH]);

gneiss_status gn_output_elements_snapshot(const gn_world *world, const char *directory,
                                          const char *name, gneiss_error *error);
/* Writes /nodes and /elements. */
gneiss_status gn_output_elements_results(const gn_world *world, gn_h5 *file, gneiss_error *error);
/* Reads one field of results.h5 of the nodes or of the elements of a solid. */
gneiss_status gn_output_elements_read(const gn_world *world, size_t solid, bool nodes,
                                      const gn_output_field *field, double *values,
                                      gneiss_error *error);

/* --- rigid bodies --- */

/* Writes one grid of all facets. */
gneiss_status gn_bodies_snapshot(const gn_world *world, const char *directory, const char *name,
                                 gneiss_error *error);
/* Writes /bodies, except the quantities that the history has of them. */
gneiss_status gn_bodies_results(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* --- the scene, with all of its keys (output.c) --- */

gneiss_status gn_scene_results(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* --- final values of bodies and motions --- */

/* Writes /bodies and /motions. */
gneiss_status gn_owners_results(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* --- events of bonds (events.c) --- */

/* Writes /events and /bursts. */
gneiss_status gn_events_results(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* --- fragments --- */

/* Writes /fragments. */
gneiss_status gn_fragments_results(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* --- cutting tests (output_cutting.c) --- */

/* Writes /rim, of disc cutters that have been in the rock. */
gneiss_status gn_rim_results(const gn_world *world, gn_h5 *file, gneiss_error *error);

/* --- checkpoints (checkpoint_dem.c, checkpoint_boundary.c, checkpoint_elements.c) --- */

/* Loading creates the part; `path` is named in messages. The boundary is loaded after the
 * particles, and surfaces after everything that has them. */
gneiss_status gn_checkpoint_put_particles(const gn_world *world, gn_h5 *file, gneiss_error *error);
/* Continues as a run that saved its particles, without a file: another rank writes it. */
void gn_checkpoint_pass_particles(const gn_world *world);
gneiss_status gn_checkpoint_get_particles(gn_world *world, const gn_h5 *file, const char *path,
                                          gneiss_error *error);
gneiss_status gn_checkpoint_put_boundary(const gn_world *world, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_boundary(gn_world *world, const gn_h5 *file, const char *path,
                                         gneiss_error *error);
gneiss_status gn_checkpoint_get_surfaces(gn_world *world, const char *path, gneiss_error *error);
gneiss_status gn_checkpoint_put_elements(const gn_world *world, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_elements(gn_world *world, const gn_h5 *file, const char *path,
                                         gneiss_error *error);

#endif
