/* The structure of the packing in the last measured step: porosity, coordination, fabric, sliding
 * contacts, in the whole specimen or in the box of `output.structure`. */
#ifndef GN_WORLD_STRUCTURE_H
#define GN_WORLD_STRUCTURE_H

#include "frame/parts.h"
#include "kernels/contact.h"
#include "scene/scene.h"

#include <stdbool.h>

/* Returns the box of the scene, without limits if there is none, marked as used. */
gn_structure_box gn_structure_box_of(const gn_scene *scene);

/* Tells whether the volume is known to which the porosity refers: with sources there is
 * none without a box or periodic sides all round. */
bool gn_structure_has_volume(const gn_world *world);

/* Returns 1 - volume of the particles over that of the box, or over that to which the mean stress
 * refers; overlaps count twice. */
double gn_structure_porosity(const gn_world *world);

/* Returns the mean number of contacts of a particle with others that carry a force or are intact
 * bonds; 0 without particles. */
double gn_structure_coordination(const gn_world *world);

/* Computes the fabric tensor <n_a n_b> of these contacts, of trace 1; 0 without contacts. */
void gn_structure_fabric(const gn_world *world, double fabric[9]);

/* Returns the share of contacts at their limit of friction in those that are not intact bonds; 0
 * without such contacts. */
double gn_structure_sliding(const gn_world *world);

#endif
