/* Pieces of the world that its own files share. */
#ifndef GN_WORLD_INTERNAL_H
#define GN_WORLD_INTERNAL_H

#include "base/vec3.h"
#include "io/packing.h"
#include "surfaces/patch.h"
#include "world/world.h"

#include <math.h>

/* Particles of the scene's specimen, from whichever source (specimen.c); of a file those in
 * specimen.packed. `volume`: of the shape that they fill, m3 (2D: m2); 0 when they come without
 * one. */
gneiss_status gn_specimen_make(const gn_scene *scene, gn_packing *packing, double *volume,
                               gneiss_error *error);

/* A box about points. */
typedef struct gn_extent {
    double lower[3], upper[3]; /* m */
} gn_extent;
#define GN_EXTENT_NONE                                                                             \
    {                                                                                              \
        {INFINITY, INFINITY, INFINITY}, {                                                          \
            -INFINITY, -INFINITY, -INFINITY                                                        \
        }                                                                                          \
    }
void gn_extent_add(gn_extent *extent, const double point[3], double radius);
/* About where the specimen will be. Nothing is added for a geometry that gmsh has to mesh first,
 * nor for a file that cannot be read: packing it will tell why. */
void gn_specimen_extent(const gn_scene *scene, gn_extent *extent);

/* The contact law, asked of the world (law.c). Writes the parameters of a new contact, whose ends
 * are known; of all contacts of a list those that follow the step. */
void gn_contact_set(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list, size_t c);
void gn_contacts_set_dashpots(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list);
/* The largest stiffness that two particles can show which meet, and that a contact can show, before
 * the lists are made again. */
gn_law_spring gn_pair_spring(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j);
gn_law_spring gn_contact_spring(const gn_dem *dem, const gn_contacts *list, size_t c);

/* From x to the nearest image of y, m; returns the square of its length. */
static inline double gn_branch(const gn_step_context *ctx, const double *x, const double *y,
                               double d[3]) {
    double d2 = 0.0;
    for (int a = 0; a < 3; a++) {
        d[a] = gn_nearest(y[a] - x[a], ctx->period[a]);
        d2 += d[a] * d[a];
    }
    return d2;
}

/* The part of a particle's mass that is its own: the rest was added for a longer step and has no
 * weight. */
static inline double gn_own_share(const gn_particles *particles, size_t p) {
    return particles->own_share ? particles->own_share[p] : 1.0;
}

/* Share of a unit vector's square along components that are free: bit k of `mask` holds k. */
static inline double gn_free_share(uint8_t mask, const double n[3]) {
    double free = 0.0;
    for (int a = 0; a < 3; a++)
        if (!(mask >> a & 1)) free += n[a] * n[a];
    return free;
}

/* 1/kg with which a particle gives way along a unit vector: prescribed components do not. */
double gn_inverse_mass_along(const gn_dem *dem, size_t particle, const double n[3]);

/* m/s2 by which what acts on a particle besides the contact of a row opens its gap along n, the
 * unit vector into the wall or surface (crossing.c). Of the forces of the instant, so when those of
 * all pairs are found. Of a body only its weight, and background damping is left out. */
double gn_other_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids,
                             const gn_zones *zones, size_t row, const double n[3]);
/* The same of the spring of a zone that holds its particle, beside a contact of the stiffness kn,
 * N/m; 0 where the step does not resolve both together. */
double gn_held_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            const gn_zones *zones, double kn, size_t row, const double n[3]);

/* What parameters need of the packing as a whole; `pairs` are the contacts to average over. */
gneiss_status gn_law_derive(const gn_step_context *ctx, gn_dem *dem, const gn_pair_list *pairs,
                            gneiss_error *error);

/* What particles are by Hertz's law to each other and to what they touch (law.c). */
gneiss_status gn_hertz_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Damping fraction alpha of a restitution, and of the scene's contacts; 0: none. */
double gn_restitution_fraction(double restitution);
double gn_contact_damping_fraction(const gn_scene *scene);

/* The scene of world->stage, relative to the origin, from world->given; room for what the stages
 * come to (stages.c). */
gneiss_status gn_stages_scene(gn_world *world, gn_scene *scene, gneiss_error *error);
gneiss_status gn_stages_create(const gn_step_context *ctx, gn_stages *stages, gneiss_error *error);
/* GNEISS_ERROR_INPUT where the first stage waits for what no pressed contact can bring. */
gneiss_status gn_stages_check_first(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_stages *stages,
                                    gneiss_error *error);
/* Parameters of all contacts of a list from the materials as they are now, but not what they have
 * gone through. */
gneiss_status gn_contacts_take_materials(const gn_step_context *ctx, const gn_dem *dem,
                                         gn_contacts *list, gneiss_error *error);
/* Motions and forces of sets as the scene has them now. */
gneiss_status gn_sets_enter(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Bonds between the pairs at the start that lie in the interaction range (bonds.c). */
gneiss_status gn_bonds_form(const gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                            const gn_solids *solids, gneiss_error *error);
/* The same of pairs as they stand now, beside the bonds that are there; all that hold, undone. The
 * lists have to be made anew. */
gneiss_status gn_bonds_add(const gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                           const gn_solids *solids, gneiss_error *error);
void gn_bonds_dissolve(const gn_step_context *ctx, gn_dem *dem);
/* J, what the springs of all contacts between particles hold. */
double gn_contacts_stored(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_periodic_box *box);
/* Tells whether that is more than rounding, and lets particles at rest spring apart. */
bool gn_stored_matters(const gn_step_context *ctx, const gn_dem *dem, double stored);

/* Numbers of particles (lists.c): null particles behind the last one, index_of_id, and the ends of
 * contacts, which are sorted again; place[old] is the new one. */
void gn_dem_null_particles(const gn_step_context *ctx, gn_dem *dem);
void gn_dem_number_ids(gn_dem *dem);
gneiss_status gn_contacts_rename(gn_contacts *list, const int32_t *place, gneiss_error *error);

/* Particles outside the domain (removal.c) fail the run or leave the model, those in sinks leave:
 * without mass and contacts, and what they and their contacts held is booked as carried away. Call
 * with the lists as the last step left them. */
gneiss_status gn_dem_check_domain(gn_world *world, gneiss_error *error);

/* Sets (sets.c): first materials and groups, then, when masses are known, motions and forces. */
gneiss_status gn_sets_assign(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gneiss_status gn_sets_apply(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Velocities of prescribed particles and sums of the reactions. */
void gn_prescription_update(const gn_step_context *ctx, gn_dem *dem, double time);
void gn_reactions_sum(const gn_step_context *ctx, gn_dem *dem);
/* Whether a particle, by where it was at the start, is one of a set's. */
bool gn_set_selected(const gn_step_context *ctx, const gn_dem *dem, size_t set, size_t particle);
/* Mean displacement of a set from the start along an axis, m. */
double gn_set_travel(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     size_t set, int axis);

/* A step of no length on a copy of a list, in double (observe.c): whatever limits it would reach
 * stays in the copy, which is the caller's, also on failure. `partials`: of the list, with rows of
 * double; NULL: forces stand in the rows of the copy alone. */
gneiss_status gn_contacts_evaluate(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_periodic_box *box, const gn_contacts *list,
                                   const gn_partials *partials, gn_contacts *copy,
                                   gneiss_error *error);
/* Some contacts of a list (observe.c), with the forces of the present places in their rows; the
 * caller's, also on failure. */
gneiss_status gn_contacts_observe(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_periodic_box *box, const gn_contacts *list,
                                  const int32_t *chosen, size_t count, gn_contacts *seen,
                                  gneiss_error *error);

/* m2, in 2D m x 1 m, that stresses of a contact are over (law.c): of two particles, `overlap` m;
 * of one with walls and surfaces. */
double gn_contact_area(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c, double overlap);
double gn_touch_area(const gn_step_context *ctx, const gn_dem *dem, size_t particle,
                     double overlap);

/* Walls (walls.c). */
gneiss_status gn_walls_create(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary,
                              gneiss_error *error);
gneiss_status gn_wall_contacts_find(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                    const gn_solids *solids, const gn_zones *zones, bool first,
                                    gneiss_error *error);
/* Forces of wall contacts [begin, end), into their rows; adds to *sums. Reads of particles only
 * those that touch. */
void gn_wall_contacts_work(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                           const gn_solids *solids, const gn_zones *zones, size_t begin, size_t end,
                           gn_contact_sums *sums);

/* Adds what presses along the normal of a wall contact by the linear law, as far as it follows from
 * places and velocities alone. */
void gn_wall_presses(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     size_t row, double force[3]);

/* m2 (2D: m x 1 m) that the stress of a servo wall acts on. */
double gn_wall_area(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall);
/* N, with which a servo wall shall be pressed. */
double gn_wall_wanted(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                      double time);

/* Surfaces (surface_lists.c): facets within reach of a particle, as gn_wall_contacts.wall counts
 * them, ascending into `found` (NULL: only counted). */
size_t gn_surfaces_near(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t particle, int32_t *found);
/* The centre of a particle as the surface's vertices see it. */
void gn_surface_centre(const gn_dem *dem, const gn_boundary *boundary, const gn_surface *surface,
                       size_t particle, double centre[3]);
/* Place of the surface that a facet belongs to. */
size_t gn_surface_of_facet(const gn_boundary *boundary, int32_t facet);
/* Contacts with them (surfaces.c). A particle whose centre is on a surface cannot be pushed off it:
 * refused at the start, later the run has gone bad. */
gneiss_status gn_surfaces_check_centres(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, const gn_solids *solids,
                                        const gn_zones *zones, gneiss_error *error);
/* Notes where surfaces are when the lists are made. */
void gn_surfaces_refer(gn_boundary *boundary);
/* Bound on the path of any vertex since then. `exact`: looks where they are. */
double gn_surfaces_travel(gn_boundary *boundary, bool exact);
/* As gn_wall_contacts_work, of the facets of one surface that the particle of row `begin` has;
 * returns the first row behind them. */
size_t gn_surface_contacts_work(const gn_step_context *ctx, const gn_dem *dem,
                                gn_boundary *boundary, const gn_solids *solids,
                                const gn_zones *zones, size_t begin, size_t end,
                                gn_contact_sums *sums);
/* The same as gn_wall_presses, of what gn_surface_contacts_work does; without contacts that share
 * with one of the normal `but` (NULL: all). */
size_t gn_surface_presses(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, const gn_solids *solids,
                          const gn_zones *zones, size_t begin, size_t end, const double *but,
                          double force[3]);
/* Sums the forces on bodies and vertices. */
void gn_surfaces_sum(const gn_step_context *ctx, gn_boundary *boundary);
/* Contacts of the facets of one surface that the particle of row `begin` has, at the present
 * positions; returns the first row behind them. `skin` 0: those that touch; else minima of the
 * distance up to that far from the particle, each for itself, or of a patch the facets up to that
 * far, with parts of the stiffness that add up to all of it. */
enum { GN_SURFACE_CONTACTS = GN_PATCH_FACETS };
typedef struct gn_surface_contact {
    const gn_surface *surface;
    size_t particle;
    gn_facet_contact contact;
    bool patch; /* see gn_surface_patched */
    int parts;  /* of a surface whose vertices move by themselves */
    int32_t vertex[3];
    double weight[3];
} gn_surface_contact;
size_t gn_surface_contacts_at(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids,
                              const gn_zones *zones, size_t begin, double skin,
                              gn_surface_contact *contacts, size_t *count);
/* That there is room for all facets that a particle presses at once (patch.h). */
gneiss_status gn_surfaces_check_patches(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, const gn_solids *solids,
                                        const gn_zones *zones, gneiss_error *error);
/* 1/kg with which a vertex that moves by itself gives way along a unit vector: prescribed
 * components do not. */
double gn_vertex_inverse_mass(const gn_surface *surface, int32_t vertex, const double n[3]);
/* Springs of the particles that touch surfaces, or are up to `reach` from them, for the stability
 * limit; the caller frees them. */
gneiss_status gn_surface_springs(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 const gn_zones *zones, double reach, gn_extra_spring **springs,
                                 size_t *count, gneiss_error *error);
/* Whether it gives way to particles; the most by which it may, as 1/kg. */
bool gn_surface_yields(const gn_boundary *boundary, const gn_surface *surface);
double gn_surface_give(const gn_boundary *boundary, const gn_surface *surface);
/* The surface that a row belongs to. */
const gn_surface *gn_surface_of_row(const gn_step_context *ctx, const gn_boundary *boundary,
                                    size_t row);
/* Its velocity over the last step where the row's force acted. */
void gn_surface_velocity(const gn_step_context *ctx, const gn_boundary *boundary, size_t row,
                         double v[3]);
/* A point, a direction from the body's frame, and back. */
void gn_rigid_place(const gn_rigid *body, const double local[3], double point[3]);
void gn_rigid_direct(const gn_rigid *body, const double local[3], double direction[3]);
void gn_rigid_local(const gn_rigid *body, const double direction[3], double local[3]);
/* v . I^-1 v about the centre. */
double gn_rigid_compliance(const gn_rigid *body, const double v[3]);
/* m/s2 along n, with which a point of a body goes under gravity, a force and a moment. */
double gn_rigid_accelerates(const gn_step_context *ctx, const gn_rigid *body, const double force[3],
                            const double moment[3], const double lever[3], const double n[3]);

/* How far contacts of Hertz's law are expected to be pressed (indentation.c), m: of two particles
 * whose stiffness is kn sqrt(overlap), and of one with walls and surfaces. */
double gn_pressed_meeting(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                          double kn);
double gn_pressed_touch(const gn_dem *dem, size_t particle);
/* Looks at what there is; and again, with the step, when a kernel has found more. */
void gn_pressed_look(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                     const gn_solids *solids, const gn_zones *zones);
gneiss_status gn_pressed_check(gn_world *world, gneiss_error *error);

/* Collisions in steps (collisions.c): particles that were not bonded at the start, into
 * world->dem.loose. */
gneiss_status gn_loose_find(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* The shortest contact that can begin before the lists are made again. */
gneiss_status gn_resolution_listed(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, gn_resolution *resolution,
                                   gneiss_error *error);
/* Whether hardly anything damps a collision. */
bool gn_world_rings(const gn_step_context *ctx, const gn_dem *dem);
/* Whether, where that is so and the step is automatic, any particle has lost all bonds that it had,
 * or all but one. Whether the ledger of a step that was measured misses more than that may. */
gneiss_status gn_debris_find(const gn_step_context *ctx, gn_dem *dem, bool *some,
                             gneiss_error *error);
bool gn_debris_told(const gn_ledger *ledger);
/* Bonds that hold, of each particle [particles], which are 0: 0, 1, 2 for more. */
void gn_bonds_left(const gn_dem *dem, uint8_t *left);
/* Of particles that hang on one bond at most (`adrift` 1, [particles]) leaves those that are wedged
 * with energy that matters, where world->dem.debris_told; *any: there are some, else `adrift` may
 * be what it was. */
gneiss_status gn_wedged_find(const gn_step_context *ctx, const gn_dem *dem, uint8_t *adrift,
                             bool *any, gneiss_error *error);
/* By what factor own masses [particles] have to be multiplied for `step` to resolve these contacts:
 * the larger of that and `factor`. */
gneiss_status gn_resolution_masses(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, double step, double *factor,
                                   gneiss_error *error);
/* The same for the springs of particles to be stable (gn_step_masses): of those that act, or of all
 * that are listed. */
/* Calls `use` with the linearised system of the particles: of the springs that act or, with
 * `listed`, of all that the lists hold. */
typedef gneiss_status gn_spectrum_user(const gn_spectrum *spectrum, void *context,
                                       gneiss_error *error);
gneiss_status gn_dem_with_spectrum(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, bool listed, gn_spectrum_user *use,
                                   void *context, gneiss_error *error);

gneiss_status gn_dem_masses(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            const gn_zones *zones, bool listed, double step, const uint8_t *changed,
                            double *factor, gneiss_error *error);
/* After springs have come that ask for a smaller step than masses were raised for, of those that
 * act or of all that are listed: raises the masses of these particles [particles] and their
 * neighbours as far as their own blocks ask for more, at the velocities that they have (their
 * kinetic energy is booked as step_change). Nothing happens without time.mass_scaling and before
 * the first step.
 * `held`: s, the step at which their blocks hold then; 0: not known. */
gneiss_status gn_dem_follow_masses(gn_world *world, bool listed, const uint8_t *changed,
                                   double *held, gneiss_error *error);
/* After masses have changed (lists.c); what they sum up to (mass_scaling.c). */
void gn_dem_masses_changed(const gn_step_context *ctx, gn_dem *dem);
void gn_dem_sum_masses(gn_dem *dem);
/* The shortest contact of any two distinct particles of the scene, walls and surfaces, wherever
 * they are; and the stability limit of one such contact by itself, s. */
gneiss_status gn_flight_limits(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, double *stable,
                               gn_resolution *resolution, gneiss_error *error);

/* The wave that the scene begins with, when lists have been made (pulse.c). */
gneiss_status gn_pulse_start(gn_world *world, gneiss_error *error);

/* Rigid bodies (bodies.c). */
gneiss_status gn_bodies_create(const gn_step_context *ctx, gn_boundary *boundary, gn_solids *solids,
                               gneiss_error *error);
/* Surfaces of bodies from the arrays that a checkpoint stores as well. */
gneiss_status gn_bodies_surfaces(const gn_step_context *ctx, gn_boundary *boundary,
                                 gn_solids *solids, gneiss_error *error);
/* New velocities from the forces. */
void gn_bodies_kick(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                    gn_ledger *ledger);
/* Kinetic energy of free motions at the instant of the kick. */
void gn_bodies_kinetic(const gn_step_context *ctx, const gn_boundary *boundary, double *translation,
                       double *rotation);
/* New positions. */
void gn_bodies_drift(const gn_step_context *ctx, gn_boundary *boundary, gn_ledger *ledger);
/* Works over half an interval, with the velocities of that. */
void gn_bodies_book(const gn_step_context *ctx, const gn_boundary *boundary, double dt,
                    gn_energy *ledger);

/* Orientation from the start, w x y z with w >= 0. */
void gn_rigid_orientation(const gn_rigid *body, double turn[4]);

/* sweep.c: walls, contacts and motion of one step, in parallel; the lists that are shared out. */
gneiss_status gn_dem_deal(gn_dem *dem, gneiss_error *error);
void gn_sweep(gn_world *world, const gn_contact_args *bonds, const gn_contact_args *pairs,
              const gn_motion_args *motion);
/* Moves the particles that an exchange had wait. */
void gn_sweep_held(gn_dem *dem, const gn_motion_args *motion);
/* Sums the forces on the walls, moves them over the coming step; works as those of bodies. */
void gn_walls_sum(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
/* After lists have been made: what servos press. */
void gn_walls_listed(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
void gn_walls_move(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
void gn_walls_book(const gn_step_context *ctx, const gn_boundary *boundary, double dt,
                   gn_energy *ledger);
/* J: what the spring of a contact with a wall holds, less half a step of what it gives to the
 * particle and takes of the wall, at the velocities that led here; linear law. */
double gn_wall_held(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    size_t row);

/* The share of what is missing that a servo may make up in a step (walls.c). */
double gn_servo_share(const gn_step_context *ctx, const gn_dem *dem);

/* Seconds are booked under phases in one step of so many, which counts for the others: looking at
 * the clock after every block takes a percent of a step. Prime, so that it keeps no time with
 * readings. */
enum { GN_BOOKED = 7 };

/* The limits of the parts together (step_limit.c), s: of all, from that of the particles alone; of
 * particles and the surfaces that give way to them; and the other way round, the limit of the
 * particles at which `step` is that of all, INFINITY: none would do. */
double gn_limit_of_all(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_zones *zones, double particles);
double gn_limit_beside_surfaces(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, double particles);
double gn_limit_needed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_zones *zones, double step);
/* What has turned may leave so much of the step that it had until the next lists. */
#define GN_TURNED_SHARE 0.95

/* Contacts whose particles have other numbers: i, j and where the contact was. Sorts the keys and
 * puts the items of *list in their order, into *now; *list is freed (lists.c). */
typedef struct gn_renamed {
    int32_t i, j, place;
    bool swapped;
} gn_renamed;
gneiss_status gn_sort_renamed(const gn_record *record, void *list, void *now, gn_renamed *keys,
                              gneiss_error *error);

/* The first contact of a sorted list that does not come before (i, j) (lists.c). */
size_t gn_contacts_from(const gn_contacts *list, int32_t i, int32_t j);

/* Of a step of another length than the last (dem_step.c): rows [.][4] as they are before it, NULL:
 * no memory; what the change adds to the energy, in halves. */
double *gn_dem_kept(const gn_particles *of, const double *rows);
void gn_dem_add_change(const gn_step_context *ctx, const double *past, const double *now,
                       size_t count, double halves[2]);

/* What the kernels get in the coming step (dem_step.c). */
gn_contact_args gn_dem_contact_args(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_periodic_box *box, const gn_contacts *list,
                                    bool measure);
gn_motion_args gn_dem_motion_args(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  bool measure);

/* The pressure around bonds whose friction sees it, before their forces (confinement.c). */
void gn_dem_confine(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *bonds);

size_t gn_blocks(size_t count, size_t block);

#endif
