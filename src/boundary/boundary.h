/* The part of a world that particles touch in addition to each other: plane walls, rigid bodies and
 * surfaces of finite elements, and the contacts with them. */
#ifndef GN_BOUNDARY_BOUNDARY_H
#define GN_BOUNDARY_BOUNDARY_H

#include "base/error.h"
#include "base/vec3.h"
#include "boundary/body_pairs.h"
#include "boundary/surface.h"
#include "frame/balance.h"
#include "frame/parts.h"
#include "frame/periodic_box.h"
#include "measure/energy.h"
#include "measure/measure.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_wall {
    double point[3], start[3]; /* m: a point of the plane; its position at the start */
    double normal[3];          /* unit vector towards the particles */
    double velocity[3];        /* m/s, over the last interval */
    double force[3];           /* N, force of the particles on the wall at the last evaluation */
    double stiffness;          /* N/m, sum over the touching contacts; only with a servo */
    double behind; /* N/m, stiffness of the pressed material in uniform strain; only with a servo;
                      0: unknown */
    gn_servo_state servo;
    double travel; /* m, path since the lists were made */
} gn_wall;

/* Distance, m, of a centre from the plane; negative: behind it. */
static inline double gn_wall_distance(const gn_wall *wall, const double x[3]) {
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = x[a] - wall->point[a];
    return gn_dot3(d, wall->normal);
}

/* A part that holds particles by springs registers as the holder (gn_boundary_set_holder), so that
 * contacts of these particles with walls take the springs into account; without such a part the
 * functions are NULL. */
typedef struct gn_holder {
    const void *context;
    /* Stiffness, N/m, of the spring that holds a particle; 0: no spring holds it. */
    double (*stiffness)(const void *context, size_t particle);
    /* Acceleration, m/s2, with which that spring moves the particle against n. */
    double (*acceleration)(const void *context, size_t particle, const double n[3]);
} gn_holder;

struct gn_boundary {
    gn_wall_contacts contacts; /* contacts of particles with walls and facets */
    int32_t *first;            /* [particles + 1] first row of each particle */
    gn_contact_sums *sums;     /* per block of particles */

    gn_wall *walls;       /* [scene.wall_count] */
    double *wall_normals; /* [walls][4], for code that measures */
    gn_rigid *bodies;     /* [scene.body_count] */
    size_t surface_count;
    gn_surface *surfaces;     /* surfaces of bodies first, in their order */
    size_t body_vertex_count; /* number of vertices of all bodies */
    size_t body_corner_count; /* number of facet corners of all bodies */
    int64_t (*body_shape)[3]; /* [bodies] numbers of vertices, of facets, and of facets that were
                                 dropped */
    double *body_vertex;      /* [body_vertex_count][4], m, in the body's frame */
    int32_t *body_corner;     /* [body_corner_count] index of a vertex within its body */
    double *vertex_part;      /* [body_vertex_count] part of the stiffness against walls */
    gn_wall_contacts body_contacts; /* contacts of vertices of free bodies (column i) with walls */
    gn_contact_sums body_sums;      /* sums of body_contacts */
    gn_body_pairs pairs;            /* contacts of bodies with each other */

    gn_holder holder;
};

/* Creates walls, bodies and their surfaces; those of finite elements are added later
 * (solids/element_contact.c). */
gneiss_status gn_boundary_create(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, size_t deforming, gneiss_error *error);
/* Takes the properties of surfaces from the scene of another stage; walls and bodies read the scene
 * in every step. */
void gn_boundary_enter(const gn_step_context *ctx, gn_boundary *boundary);
/* Adds a surface and creates its `first`, `tree` and `force`. */
gneiss_status gn_boundary_add_surface(gn_boundary *boundary, const gn_surface *surface,
                                      gneiss_error *error);
void gn_boundary_free(gn_boundary *boundary);
void gn_boundary_set_holder(gn_boundary *boundary, gn_holder holder);
/* Stiffness, N/m, of the spring that holds a particle; 0: no spring holds it. */
static inline double gn_boundary_held_stiffness(const gn_boundary *boundary, size_t particle) {
    const gn_holder *holder = &boundary->holder;
    return holder->stiffness ? holder->stiffness(holder->context, particle) : 0.0;
}

/* Lists walls and facets near each particle, in the order of the particles. `first`: at the start,
 * where overlap with passive walls is free of stress. */
gneiss_status gn_boundary_refresh(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  bool first, gneiss_error *error);
/* Frees arrays that depend on the number of particles; they are created again with the next lists.
 */
void gn_boundary_resized(gn_boundary *boundary);
/* Rebuilds the data that follow from contacts that were read. */
gneiss_status gn_boundary_restore(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gneiss_error *error);
/* Renumbers particles: place[old] is the new number. */
gneiss_status gn_boundary_renumber(gn_boundary *boundary, const int32_t *place,
                                   gneiss_error *error);
/* Returns a bound, m, on the path of any wall, body or vertex since the lists were made. `exact`:
 * from the present positions. */
double gn_boundary_travel(const gn_step_context *ctx, gn_boundary *boundary, bool exact);

/* Evaluates the contacts of a block of particles in the sweep; tells whether there are any. */
bool gn_boundary_work(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, size_t block,
                      size_t first, size_t last);
/* Sums up the forces on walls, bodies and vertices after the sweep. */
void gn_boundary_forces(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
/* gn_boundary_kick computes new velocities of bodies; gn_boundary_move computes new velocities of
 * walls, and new positions of walls and bodies. */
void gn_boundary_kick(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                      gn_ledger *ledger);
void gn_boundary_move(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary,
                      gn_ledger *ledger);
/* gn_boundary_book books works: those of the half interval before the kick, and of the half after
 * the motion. gn_boundary_measure, between kick and motion, adds the kinetic energy of free bodies.
 */
void gn_boundary_book(const gn_step_context *ctx, const gn_boundary *boundary, gn_half half,
                      gn_energy *ledger);
void gn_boundary_measure(const gn_step_context *ctx, const gn_boundary *boundary,
                         gn_energy *ledger);
/* Adds the largest ratio of the resultant on a free body to the sum of its weight, its load and a
 * mean contact force. */
void gn_boundary_balance(const gn_step_context *ctx, const gn_boundary *boundary,
                         gn_balance *balance);

uint64_t gn_boundary_hash(const gn_step_context *ctx, const gn_boundary *boundary, uint64_t h);
size_t gn_boundary_bytes(const gn_step_context *ctx, const gn_boundary *boundary);

/* Returns the view of contacts on which measures and the step limit work. */
gn_assembly gn_assembly_of(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary);

/* Returns the target force of a servo wall, N, and the part of the difference from it that the
 * servo may make up, beyond its relaxation. */
double gn_wall_wanted(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                      double time, double *part);
/* Finds the stiffness behind servo walls after lists have been made. */
void gn_walls_listed(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
/* Sets the velocities of walls to those that their tables prescribe at the present time. */
void gn_walls_take_velocities(const gn_step_context *ctx, gn_boundary *boundary);
/* Returns the energy, J, of the spring of a contact with a wall, less half a step of its power on
 * particle and wall at the velocities of the last interval; linear law. */
double gn_wall_held(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    size_t row);
/* Returns the largest share of the missing force that a servo wall can take up in a step without
 * instability. */
double gn_wall_servo_relaxation(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t wall);

#endif
