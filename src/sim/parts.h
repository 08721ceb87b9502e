/* Pieces of the world that its own files share. */
#ifndef GN_SIM_PARTS_H
#define GN_SIM_PARTS_H

#include "io/packing.h"
#include "sim/world.h"

/* Particles of the scene's specimen, from whichever source (specimen.c). */
gneiss_status gn_specimen_make(const gn_scene *scene, gn_packing *packing, gneiss_error *error);

/* Parameters of one contact between particles (law.c; Rojek et al. 2012, sec. 2). */
typedef struct gn_contact_parameters {
    double kn, kt, mu, cn;
    double rn, rt; /* bonds */
} gn_contact_parameters;
gn_contact_parameters gn_contact_law(const gn_world *world, int32_t i, int32_t j);

/* Uniform parameters from the packing (models 3a, 3b, 3c); `pairs` are the contacts to average
 * over. */
gneiss_status gn_law_derive(gn_world *world, const gn_pair_list *pairs, gneiss_error *error);

/* Damping fraction alpha of the contacts, 0 for none. */
double gn_contact_damping_fraction(const gn_scene *scene);

/* Bonds between the pairs at the start that lie in the interaction range (bonds.c). */
gneiss_status gn_bonds_form(gn_world *world, gneiss_error *error);

/* Sets (sets.c): first materials and groups, then, when masses are known, motions and forces. */
gneiss_status gn_sets_assign(gn_world *world, gneiss_error *error);
gneiss_status gn_sets_apply(gn_world *world, gneiss_error *error);
/* Velocities of prescribed particles and sums of the reactions. */
void gn_prescription_update(gn_world *world, double time);
void gn_reactions_sum(gn_world *world);

/* Walls (walls.c). */
gneiss_status gn_walls_create(gn_world *world, gneiss_error *error);
gneiss_status gn_wall_contacts_find(gn_world *world, gneiss_error *error);
/* Forces of wall contacts [begin, end), into their rows; adds to *sums. Reads of particles only
 * those that touch. */
void gn_wall_contacts_work(const gn_world *world, size_t begin, size_t end, gn_contact_sums *sums);

/* sweep.c: walls, contacts and motion of one step, in parallel. Prepare when threads change. */
void gn_sweep_prepare(gn_world *world);
void gn_sweep(gn_world *world, const gn_contact_args *bonds, const gn_contact_args *pairs,
              const gn_motion_args *motion);
/* Sums the forces on the walls, books their work, moves them over the coming step. */
void gn_walls_sum(gn_world *world);
void gn_walls_move(gn_world *world);

/* What the kernels get in the coming step (step.c). */
gn_contact_args gn_world_contact_args(const gn_world *world, const gn_contacts *list, bool measure);
gn_motion_args gn_world_motion_args(gn_world *world, bool measure);

size_t gn_blocks(size_t count, size_t block);

#endif
