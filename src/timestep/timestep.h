/* Choice and supervision of the time step. */
#ifndef GN_TIMESTEP_TIMESTEP_H
#define GN_TIMESTEP_TIMESTEP_H

#include "base/effects.h"
#include "base/error.h"
#include "boundary/surface.h"
#include "frame/parts.h"
#include "limit/equilibrium.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "zones/zones.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns the step limit of all parts together, s; `particles` is the limit of the particles alone
 * (step_limit.c). */
double gn_limit_of_all(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_zones *zones, double particles);
/* Return the least of the limits, s, of the particles and of all bodies of elements, each alone and
 * undamped. */
double gn_timestep_sharp_limit(const gn_step_context *ctx, const gn_solids *solids);
double gn_timestep_bound(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                         const gn_zones *zones);
/* Checks the stability limit and lowers an automatic step (step_limit.c). `full`: uses Lanczos even
 * if the rigorous bound is above the step. */
gneiss_status gn_timestep_check(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                gn_solids *solids, gn_zones *zones, gn_ledger *ledger, bool full,
                                gneiss_error *error);
/* Updates the limit of unbonded grains at the end of a run for the output, after the state has been
 * saved. The step is unchanged. */
gneiss_status gn_timestep_update_reported_limit(gn_step_context *ctx, gn_dem *dem,
                                                gn_boundary *boundary, gn_solids *solids,
                                                gn_zones *zones, gn_ledger *ledger,
                                                gneiss_error *error);
/* Checks the step, as gn_timestep_check does, after a step in which bonds broke and the specimen
 * may have disintegrated. */
gneiss_status gn_timestep_check_after_breaks(gn_step_context *ctx, gn_dem *dem,
                                             gn_boundary *boundary, gn_solids *solids,
                                             gn_zones *zones, int64_t broken_before,
                                             gneiss_error *error);
/* Checks the step after one that was measured because of debris, which needs smaller steps if it
 * creates energy. */
gneiss_status gn_timestep_check_debris(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       gneiss_error *error);
/* Checks the step against all events that are possible until the lists are made again. */
gneiss_status gn_timestep_check_lists(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                      gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                      gneiss_error *error);
/* Lowers an automatic step to at most `dt`, s; a given one stays. */
void gn_timestep_lower(gn_step_context *ctx, gn_dem *dem, double dt);
/* Lowers an automatic step for bodies that move far in it. */
void gn_timestep_follow_bodies(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary);
/* Writes the warning about a given step: that it does not resolve collisions, or that contacts
 * which may form need a smaller one. "": there is no warning. */
const char *gn_timestep_warning(const gn_step_context *ctx, char *text, size_t size);

/* Lowers *dt (s) of the coming step such that no vertex of a body moves farther than a quarter of
 * the smallest radius, and no body rotates by more than a quarter of a radian, or 0.01 with
 * bearings about some of its axes. */
void gn_bodies_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      double *dt);

/* Lowers *dt for walls that move away from particles pressed against them: such a wall moves by at
 * most a twentieth of the smallest radius. */
void gn_walls_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     double *dt);

/* Returns the step, s, of a scene in which only bodies limit it: by the largest prescribed velocity
 * of bodies at any time, and at most a hundredth of the rest of the run. INFINITY: no body moves.
 */
double gn_bodies_step(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary);

/* Checks that no initial or prescribed spin moves a vertex faster than light, which bounds
 * velocities in scenes. */
gneiss_status gn_bodies_check_speeds(const gn_step_context *ctx, const gn_boundary *boundary,
                                     gneiss_error *error);

/* Finds the shortest contact that can begin before the lists are rebuilt. */
gneiss_status gn_resolution_listed(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, gn_resolution *resolution,
                                   gneiss_error *error);
/* Tells whether collisions are only slightly damped. */
bool gn_timestep_is_underdamped(const gn_step_context *ctx, const gn_dem *dem);
/* Returns the number of steps that a collision must last. */
double gn_timestep_contact_steps(const gn_step_context *ctx);
/* Writes the names of the two bodies of the shortest collision. */
const char *gn_resolution_text(const gn_step_context *ctx, char *text, size_t size);

/* Sets *some if the step is automatic, collisions are only slightly damped
 * (gn_timestep_is_underdamped), and a particle has lost all or all but one of its bonds. */
gneiss_status gn_debris_find(gn_step_context *ctx, gn_dem *dem, bool *some, gneiss_error *error);

/* Writes the name of the free body whose contacts need steps a thousand times shorter than those of
 * all other parts, because it is light or stiff. "": there is none. */
const char *gn_timestep_light_body(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, char *text, size_t size);

/* Finds the displacements that bring the linearised system into equilibrium with `load`, see
 * gn_equilibrium_solve. `slips`: see gn_spectrum, `rate`: gn_viscosity. */
gneiss_status gn_timestep_relax(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const uint8_t *slips, double rate,
                                const double *load, double tolerance, gn_preconditioner *made,
                                double *u, gn_equilibrium *found, gneiss_error *error);
/* Finds the limit of the particles alone (particle_limit.c), by the springs that have become active
 * since the last check or, with `full`, by all active springs. *due: the limit has changed, or that
 * of the objects that particles touch. */
gneiss_status gn_timestep_particle_limit(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                         gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                         bool full, bool *due, gneiss_error *error);
/* Finds the limit for contacts that have rotated since the last check. */
gneiss_status gn_timestep_limit_turned(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       bool *due, gneiss_error *error);
/* Tells whether the step of the world is stable with all listed contacts closed; if not,
 * choice.listed is a stable one. `full`: checks all listed contacts, not only those that have
 * changed. */
gneiss_status gn_timestep_limit_listed(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       bool full, bool *fine, gneiss_error *error);
/* Tells whether the step is so short that row sums over the listed contacts prove it stable,
 * without a search for changes. */
gneiss_status gn_timestep_limit_far(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    const gn_zones *zones, bool *far, gneiss_error *error);
/* Finds the shortest collision among listed pairs (resolve_listed), or of the whole scene if no
 * listed pair collides (resolve_flight). *shorter: it is shorter than known before. */
gneiss_status gn_timestep_resolve_listed(gn_step_context *ctx, gn_dem *dem,
                                         const gn_boundary *boundary, const gn_solids *solids,
                                         const gn_zones *zones, bool *shorter, gneiss_error *error);
gneiss_status gn_timestep_resolve_flight(gn_step_context *ctx, gn_dem *dem,
                                         const gn_boundary *boundary, bool *shorter,
                                         gneiss_error *error);
/* Discards the results about lists and collisions. */
void gn_timestep_limit_anew(gn_step_context *ctx);

/* Raises masses, if the scene requests it, starting from the step that the world has found without
 * raised masses. */
gneiss_status gn_timestep_scale_masses(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       gneiss_error *error);
/* Predicts the effect of mass scaling for a step (s, safety included) with time.estimate: bound.
 * *of_bound: ratio of the step to that of the bound with the particles' own masses; *added: ratio
 * of added to own mass; INFINITY: other parts of the model do not allow this step. */
gneiss_status gn_timestep_predict_masses(const gn_step_context *ctx, const gn_dem *dem,
                                         const gn_boundary *boundary, const gn_solids *solids,
                                         const gn_zones *zones, double step, double *of_bound,
                                         double *added, gneiss_error *error);
/* Returns the share of added mass in the kinetic energy, with the velocities of the last half
 * step. */
double gn_timestep_added_kinetic(const gn_dem *dem);

/* Checks that velocities of particles are finite and their paths in the step short enough
 * (paths.c). */
gneiss_status gn_timestep_check_particle_paths(const gn_step_context *ctx, const gn_dem *dem,
                                               const gn_boundary *boundary, bool measure,
                                               gneiss_error *error);

/* Returns the largest squared frequency, 1/s2, of the body of a row on the springs of its wall,
 * with all listed ones closed; moves *row to the first row of the next body or wall
 * (surface_limit.c). */
double gn_body_walls_square(const gn_step_context *ctx, const gn_boundary *boundary, size_t *row);

/* Checks that no wall or body moved too far in the step (paths.c). */
gneiss_status gn_timestep_check_boundary_paths(const gn_step_context *ctx, const gn_dem *dem,
                                               const gn_boundary *boundary, gneiss_error *error);

/* Limits by bodies and vertices of elements that particles can displace (surface_limit.c). The
 * first function tells whether their rates have risen by more than a fiftieth; the second also
 * stores them in that case, or if `anew`. */
gneiss_status gn_timestep_surfaces_yield_more(const gn_step_context *ctx, const gn_dem *dem,
                                              const gn_boundary *boundary, bool *more,
                                              gneiss_error *error);

gneiss_status gn_timestep_boundary_limit(gn_step_context *ctx, const gn_dem *dem,
                                         gn_boundary *boundary, bool anew, bool *due,
                                         gneiss_error *error);

/* Checks that no node in contact with particles moved too far in the step (paths.c). */
gneiss_status gn_timestep_check_element_paths(const gn_step_context *ctx, const gn_dem *dem,
                                              const gn_solids *solids, gneiss_error *error);

/* gn_coupled_limit computes the sharp limit of the coupled system, with the active springs or, with
 * `listed`, with all listed ones. gn_coupled_has_limit tells whether there is such a limit: not
 * with the pressure form, nor if the scene requests bounds only. */
bool gn_coupled_has_limit(const gn_step_context *ctx, const gn_solids *solids);

gneiss_status gn_coupled_limit(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_solids *solids,
                               const gn_zones *zones, bool listed, gn_whole_limit *limit,
                               gneiss_error *error);

/* Returns the last result of gn_coupled_limit; NULL: there is none. */
const gn_whole_limit *gn_coupled_whole(const gn_step_context *ctx, const gn_zones *zones);

/* gn_side_text names the side ("particles", "elements", "zone"); the second function names its
 * member ("particle 12", "a node of the mesh, 12"). */
const char *gn_side_text(gn_side side);

const char *gn_whole_culprit(const gn_whole_limit *limit, char *text, size_t size);

/* Returns the body of elements that determines the step; NULL: none does. */
const gn_element_model *gn_timestep_elements_lead(const gn_step_context *ctx,
                                                  const gn_solids *solids, const gn_zones *zones);

#endif
