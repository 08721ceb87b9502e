/* Functions that the files of this folder share. */
#ifndef GN_BOUNDARY_BOUNDARY_PRIVATE_H
#define GN_BOUNDARY_BOUNDARY_PRIVATE_H

#include "base/error.h"
#include "boundary/surface.h"
#include "frame/parts.h"
#include "kernels/contact.h"
#include "measure/energy.h"
#include "soa/records.h"
#include "surfaces/facet.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns the acceleration, m/s2, with which all loads of a particle except the contact of a row
 * open the gap of that contact along n, the unit vector into the wall or surface (contact_rows.c).
 * It uses the forces of the instant and is valid once the forces of all pairs are known. The
 * acceleration of a rigid body is that by its weight alone; background damping is neglected. */
double gn_other_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, size_t row, const double n[3]);
/* Returns the acceleration, m/s2, with which the holder of the particle of a row (gn_holder) opens
 * the gap of that contact along n. kn, N/m, is the stiffness of the contact; the result is 0 if the
 * step does not resolve both springs together. */
double gn_held_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, double kn, size_t row, const double n[3]);
/* Walls (walls.c). */
gneiss_status gn_walls_create(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary,
                              gneiss_error *error);
/* Writes wall_normals, which measures read. */
gneiss_status gn_walls_list_normals(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error);
gneiss_status gn_wall_contacts_find(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                    bool first, gneiss_error *error);
/* Computes the forces of wall contacts [begin, end), writes them to their rows, and adds to *sums.
 * Reads only particles that touch walls. */
void gn_wall_contacts_work(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                           size_t begin, size_t end, gn_contact_sums *sums);
/* Adds to `force` the part of the normal force of a wall contact by the linear law that follows
 * from positions and velocities alone. */
void gn_wall_presses(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     size_t row, double force[3]);
/* Surfaces (surface_lists.c). gn_surfaces_near finds the facets within reach of a particle,
 * numbered as in gn_wall_contacts.wall, ascending, and writes them to `found` (NULL: only counts
 * them). */
size_t gn_surfaces_near(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t particle, int32_t *found);
/* Returns the centre of a particle in the coordinates of the surface's vertices. */
void gn_surface_centre(const gn_dem *dem, const gn_boundary *boundary, const gn_surface *surface,
                       size_t particle, double centre[3]);
/* Returns the index of the surface that a facet belongs to. */
size_t gn_surface_of_facet(const gn_boundary *boundary, int32_t facet);
/* Stores the positions of the surfaces when the lists are made. */
void gn_surfaces_refer(gn_boundary *boundary);
/* Returns an upper bound of the path of any vertex since gn_surfaces_refer, m. `exact`: from the
 * present positions. */
double gn_surfaces_travel(gn_boundary *boundary, bool exact);
/* Does the same as gn_wall_contacts_work for the contacts with the facets of one surface, of the
 * particle of row `begin`; returns the first row after them. */
size_t gn_surface_contacts_work(const gn_step_context *ctx, const gn_dem *dem,
                                gn_boundary *boundary, size_t begin, size_t end,
                                gn_contact_sums *sums);
/* Adds to `force` the normal forces of the contacts that gn_surface_contacts_work computes, and
 * returns the first row after them. Contacts that share their stiffness with one of normal `but`
 * are left out; NULL: none is. */
size_t gn_surface_presses(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, size_t begin, size_t end, const double *but,
                          double force[3]);
/* Sums up the forces on bodies and vertices. */
void gn_surfaces_sum(const gn_step_context *ctx, gn_boundary *boundary);
/* Computes the velocity of a surface, m/s, over the last step at the point where the force of a row
 * acted. */
void gn_surface_velocity(const gn_step_context *ctx, const gn_boundary *boundary, size_t row,
                         double v[3]);
/* Returns the acceleration of a point of a body along n, m/s2, by gravity, a force and a moment. */
double gn_rigid_accelerates(const gn_step_context *ctx, const gn_rigid *body, const double force[3],
                            const double moment[3], const double lever[3], const double n[3]);
/* Rigid bodies (bodies.c). */
gneiss_status gn_bodies_create(const gn_step_context *ctx, gn_boundary *boundary, size_t deforming,
                               gneiss_error *error);
/* Computes the new velocities from the forces. */
void gn_bodies_kick(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                    gn_ledger *ledger);
/* Computes the kinetic energy of free motions at the instant of the kick. */
void gn_bodies_kinetic(const gn_step_context *ctx, const gn_boundary *boundary, double *translation,
                       double *rotation);
/* Computes the new positions. */
void gn_bodies_drift(const gn_step_context *ctx, gn_boundary *boundary, gn_ledger *ledger);
/* Books the works over half an interval, with the velocities of that half. */
void gn_bodies_book(const gn_step_context *ctx, const gn_boundary *boundary, double dt,
                    gn_energy *ledger);
/* Walls: gn_walls_sum sums up the forces; the other functions compute the motion over the coming
 * step and the works over half an interval. */
void gn_walls_sum(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
void gn_walls_move(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
void gn_walls_book(const gn_step_context *ctx, const gn_boundary *boundary, double dt,
                   gn_energy *ledger);

/* History of a contact, as of the last step. */
typedef struct gn_touch_memory {
    size_t row;
    double n[3], fd, closeness;
    double part;              /* the contact's fraction of the stiffness */
    double shear[3], roll[3]; /* only valid if the contacts have these columns */
    bool taken, still; /* taken: the history was transferred; still: shear and roll are 0 in every
                          contact */
} gn_touch_memory;

/* Moves the histories from the rows to `old`, which has room for one more than GN_SURFACE_CONTACTS,
 * for those that exceed it. */
size_t gn_touch_recall(gn_wall_contacts *rows, size_t begin, size_t end, gn_touch_memory *old);

/* Finds the contact of the last step that each contact continues, beginning with the pair whose
 * normals agree best; -1: none within 60 degrees. */
void gn_touch_match(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                    size_t count, int *from);

/* Rotates a force with its normal, by the shortest rotation from one unit vector to the other. */
void gn_touch_follow(const double from[3], const double to[3], double force[3]);

/* Pressure over many facets: gives each contact a history before[contacts], rotated to its normal.
 * Transferred histories are marked as taken. */
void gn_touch_hand_over(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                        size_t count, gn_touch_memory *before);

/* Sums up the histories that were not taken and have about the same direction, and marks them;
 * returns false if there are none. */
bool gn_touch_gather(gn_touch_memory *old, size_t count, gn_touch_memory *sum);

#endif
