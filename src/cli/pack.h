/* The command `gneiss pack`, and packing of the specimen of a run before it starts. */
#ifndef GN_CLI_PACK_H
#define GN_CLI_PACK_H

#include "cli/options.h"

/* Packs the specimen of a scene file into an output folder and prints its quality. */
gneiss_status gn_command_pack(const gn_options *options, gneiss_error *error);

/* Packs with a progress line and stores the particles in scene->specimen.packed. Does nothing if
 * the specimen is not given by a shape. */
gneiss_status gn_pack_ahead(const gn_options *options, gn_scene *scene, gneiss_error *error);

#endif
