/* The part of a world that consists of finite elements: its solids, their prescribed motions and
 * loads, and their readings. Functions of the part visit all solids, in their order. */
#ifndef GN_SOLIDS_SOLIDS_H
#define GN_SOLIDS_SOLIDS_H

#include "frame/parts.h"

#include "base/error.h"
#include "fem/fem.h"
#include "frame/balance.h"
#include "measure/energy.h"
#include "mesh/joints.h"
#include "mesh/mesh.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/element_bodies.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Contacts of particles with the surface (element_contact.c). */
typedef struct gn_element_contact {
    int32_t *corner;     /* corners of facets, by indices of nodes */
    const double *force; /* [nodes][4], N, forces on the surface; NULL: no particle can touch it */
    gn_wall_contacts
        rows;       /* Contacts of particles with the surface of a solid (element_contact.c). */
    int32_t *first; /* [nodes + 1] */
    double travel;  /* m, see gn_rigid.travel */
    int32_t *body;  /* [nodes] index in `bodies` */
    struct gn_element_body *bodies;
} gn_element_contact;

/* A solid. */
typedef struct gn_element_model {
    const gn_element_def *def; /* its definition in the scene; borrowed */
    gn_fem_solid solid;
    gn_mesh_joints joints; /* messages about the mesh from when its file was read */
    gn_element_contact contact;
    gn_fem_set *motion_set;  /* [def->motion_count] nodes */
    int32_t *motion;         /* [motions] index in `solid`, -1: the motion only records */
    gn_fem_load *load;       /* [def->load_count] */
    double (*load_value)[3]; /* [loads] Pa or N, present value of each */
    bool loads_vary;
    double (*weight)[3]; /* [nodes] weights in the mean strain */

    gn_fem_limit limit; /* limits of the solid at its start */
    double stiffening; /* factor by which the limit has decreased since (gn_fem_stiffening), as last
                          applied */
    double stable;     /* s: sharp limit or bound, divided by `stiffening` */

    double *vel_past; /* [nodes][4] velocities before a step whose length differs from the last;
                         else NULL */
    double stress[9]; /* Pa, mean over the solid at the last measured step, tension positive */
    double
        unbalanced; /* mean resultant on a free node over the mean force of an element on a node */
    bool carries, falls; /* see gn_balance */
} gn_element_model;

/* The solids of finite elements of a world. */
struct gn_solids {
    gn_element_model **elements; /* [count] */
    size_t count;
};

/* Creates the elements of the scene, with mesh, motions and loads; `mesh` NULL: a built-in one,
 * else taken over (also on failure), relative to the origin. Messages give the place in the scene.
 * */
gneiss_status gn_elements_create(const gn_step_context *ctx, gn_solids *solids, gn_mesh *mesh,
                                 gneiss_error *error);
/* Adds a solid; `def` must exist as long as the world. */
gneiss_status gn_elements_add(const gn_step_context *ctx, gn_solids *solids,
                              const gn_element_def *def, gn_mesh *mesh, gneiss_error *error);
/* Takes motions, loads, gravity and damping from the scene of another stage. */
/* Takes the gravity and the background damping of the scene. */
gneiss_status gn_elements_set_gravity(const gn_step_context *ctx, gn_solids *solids,
                                      gneiss_error *error);
gneiss_status gn_elements_enter(const gn_step_context *ctx, gn_solids *solids, gneiss_error *error);
void gn_elements_free(gn_solids *solids);

/* A step of ctx->dt in two parts. gn_elements_forces computes velocities, loads and forces, and
 * moves the nodes that no feature holds; */
void gn_elements_forces(const gn_step_context *ctx, gn_solids *solids, double *seconds,
                        bool measure);
/* gn_elements_move moves the held nodes; with `measure` it also computes stress and unbalanced
 * forces. */
gneiss_status gn_elements_move(const gn_step_context *ctx, gn_solids *solids, gn_ledger *ledger,
                               double *seconds, bool measure, gneiss_error *error);
/* Adds the energies of the solids at the last measured step. */
void gn_elements_book(const gn_solids *solids, gn_energy *ledger);

/* Updates the stability limits: with `full` from the start, otherwise only by the effect of strain
 * since then. *due: a limit has changed. */
gneiss_status gn_elements_limit(const gn_step_context *ctx, gn_solids *solids, bool full, bool *due,
                                gneiss_error *error);
/* To be called after elements were removed: the bound still holds for the remaining ones, for any
 * weights. */
gneiss_status gn_elements_converted(gn_element_model *q, gneiss_error *error);
/* Use of a node by motions and loads; gn_elements_driven writes the strongest one for each node
 * [nodes], where 0 stood before. */
typedef enum gn_node_use { GN_NODE_FREE, GN_NODE_WATCHED, GN_NODE_DRIVEN } gn_node_use;
void gn_elements_driven(const gn_element_model *q, uint8_t *driven);
/* Returns the smallest limit, s; INFINITY: there are no solids. */
double gn_elements_stable(const gn_solids *solids);
/* Writes warnings: points where elements of one part touch without being joined (one sentence for
 * double nodes and one for hanging nodes, in meshes from files), and particles that may touch more
 * facets than their list can hold; "": none. Returns `text`. */
const char *gn_elements_doubts(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_solids *solids, char *text,
                               size_t size);
const char *gn_elements_culprit(const gn_step_context *ctx, const gn_element_model *q, char *text,
                                size_t size);

uint64_t gn_elements_hash(const gn_solids *solids, uint64_t h);
size_t gn_elements_bytes(const gn_solids *solids);

typedef struct gn_element_totals {
    size_t nodes, elements;
    double mass, volume; /* kg, m3 at the start */
} gn_element_totals;
gn_element_totals gn_elements_totals(const gn_solids *solids);

/* Compute means over all solids by volume, of the displacement gradient and of the stress at the
 * last measured step; the last function returns the largest of the solids' `unbalanced`. */
void gn_elements_strain(const gn_solids *solids, double gradient[9]);
void gn_elements_stress(const gn_solids *solids, double stress[9]);
void gn_elements_balance(const gn_solids *solids, gn_balance *balance);
/* Extends a box to all nodes at the start, m. */
void gn_elements_extent(const gn_solids *solids, double lower[3], double upper[3]);
/* Returns the sides of the smallest box around all elements, m. */
void gn_elements_sides(const gn_solids *solids, double side[3]);
double gn_elements_longest_side(const gn_step_context *ctx, const gn_solids *solids);

/* Motions are numbered over all solids. The functions return the mean displacement of a motion's
 * nodes, m, and the force that it supplies, N, unless it only records. */
size_t gn_elements_motions(const gn_solids *solids);
const char *gn_elements_motion_name(const gn_solids *solids, size_t motion);
bool gn_elements_motion_drives(const gn_solids *solids, size_t motion);
/* Returns the nodes of a motion and their positions. */
const gn_fem_set *gn_elements_motion_set(const gn_solids *solids, size_t motion,
                                         const gn_particles **nodes);
void gn_elements_travel(const gn_solids *solids, size_t motion, double travel[3]);
void gn_elements_reaction(const gn_solids *solids, size_t motion, double force[3]);

/* --- contact with particles (element_contact.c) --- */

/* Creates the surfaces that particles touch, where the scene requests them; solids must exist. */
gneiss_status gn_element_contact_create(const gn_step_context *ctx, gn_boundary *boundary,
                                        gn_solids *solids, gneiss_error *error);
/* Transfers the forces of particles to the nodes, and records how far nodes moved in a step. */
void gn_element_contact_load(gn_element_model *q);
void gn_element_contact_moved(gn_element_model *q, double dt);
/* Returns the speed of the fastest node in the last step, m/s; 0 if no particle can touch the
 * solid. */
double gn_element_contact_speed(const gn_element_model *q);
void gn_element_contact_free(gn_element_contact *k);

/* Returns the body of elements that shares its zones with particles. */
static inline gn_fem_solid *gn_coupled_solid(const gn_solids *solids) {
    return &solids->elements[0]->solid;
}

#endif
