/* The finite elements of a world: the body, what drives it, what is read off it. */
#ifndef GN_SIM_ELEMENTS_H
#define GN_SIM_ELEMENTS_H

#include "fem/body.h"
#include "io/h5.h"
#include "measure/history.h"

typedef struct gn_world gn_world;

/* What particles do to the surface (element_contact.c). */
typedef struct gn_element_contact {
    int32_t *corner;       /* of facets, by places of nodes */
    double *force;         /* [nodes][4], N */
    gn_wall_contacts rows; /* the same, of the nodes of facets, as the motion kernel takes it */
    int32_t *first;        /* [nodes + 1] */
    double travel;         /* m, as gn_rigid.travel */
} gn_element_contact;

typedef struct gn_element_model {
    gn_fem_body body;
    gn_element_contact contact;
    gn_fem_set *motion_set;  /* [motions of the scene] nodes */
    int32_t *motion;         /* [motions] number in the body, -1: only watched */
    gn_fem_load *load;       /* [loads of the scene] */
    double (*load_value)[3]; /* [loads] Pa or N, at present */
    bool loads_vary;
    double (*weight)[3]; /* [nodes] of the mean strain */

    gn_fem_limit limit; /* of the body at its start */
    double stiffening;  /* what has divided it since (gn_fem_stiffening), when last acted on */
    double stable;      /* s: sharp limit or bound, divided by it */

    double stress[9];  /* Pa, mean over the body at the last measured step, tension positive */
    double unbalanced; /* mean resultant on a free node over the mean force of an element on one */
} gn_element_model;

/* Makes world->elements with its mesh, motions and loads; `mesh` NULL: a built-in one, else
 * taken over (also on failure), relative to the origin. Errors say where in the scene. */
gneiss_status gn_elements_create(gn_world *world, gn_mesh *mesh, gneiss_error *error);
void gn_elements_free(gn_world *world);

/* A step of world->dt in two parts. Velocities, loads, forces, and the motion of nodes that do not
 * wait for an exchange; */
void gn_elements_forces(gn_world *world, bool measure);
/* then that of the others; with `measure` also stress and unbalanced. */
gneiss_status gn_elements_move(gn_world *world, bool measure, gneiss_error *error);

/* Makes the surface that particles touch, if the scene wants it: after bodies. */
gneiss_status gn_element_contact_create(gn_world *world, gneiss_error *error);
/* Hands the forces of particles over to the nodes; notes how far nodes came. */
void gn_element_contact_load(gn_world *world);
void gn_element_contact_moved(gn_world *world);
void gn_element_contact_free(gn_element_contact *k);

/* Adds the body's ledger to world->reading. */
void gn_elements_book(gn_world *world);

/* Looks at the body's stability limit (dt.c): `full` from its start on, otherwise only at what
 * strain has done since. *due: `stable` has changed. */
gneiss_status gn_elements_limit(gn_world *world, bool full, bool *due, gneiss_error *error);

/* Of the whole world: the lesser of particles and elements, s. */
double gn_world_sharp_limit(const gn_world *world);
double gn_world_bound(const gn_world *world);
/* Whether the elements set the step, and which: "element 12 at (x, y, z) m". */
bool gn_elements_lead(const gn_world *world);
const char *gn_elements_culprit(const gn_world *world, char *text, size_t size);

/* Mean displacement of the nodes of a motion, m, and the force that it supplies, N. */
void gn_elements_travel(const gn_world *world, size_t motion, double travel[3]);
void gn_elements_reaction(const gn_world *world, size_t motion, double force[3]);

/* --- files (output_elements.c, checkpoint_elements.c) --- */

gneiss_status gn_elements_snapshot(const gn_world *world, const char *directory, const char *name,
                                   gneiss_error *error);
/* /nodes, /elements, /motions of results.h5. */
gneiss_status gn_elements_results(const gn_world *world, gn_h5 *file, gneiss_error *error);
gneiss_status gn_elements_save(const gn_world *world, gn_h5 *file, gneiss_error *error);
/* Makes world->elements from a checkpoint; `path` stands in messages. */
gneiss_status gn_elements_load(gn_world *world, const gn_h5 *file, const char *path,
                               gneiss_error *error);

#endif
