/* A solid of explicit finite elements: linear triangles in plane strain (1 m thick) or tetrahedra,
 * linear elastic, large rotations, plain displacement form.
 *
 * Flow: gn_fem_solid_create (mesh -> nodes, elements), loads.c (sets, loads), gn_fem_limits (time
 * step), gn_fem_step, stress.c (readings), gn_fem_solid_free. Nodes are a particle record, so that
 * the motion kernels move them; the elements' kernel is kernels/element_template.c. */
#ifndef GN_FEM_SOLID_H
#define GN_FEM_SOLID_H

#include "kernels/dispatch.h"
#include "mesh/mesh.h"
#include "sched/deal.h"
#include "sched/hold.h"

typedef struct gn_fem_material {
    const char *group;              /* of elements, by name or tag; NULL: all elements */
    double young, poisson, density; /* Pa, -, kg/m3 */
} gn_fem_material;

/* What the pressure comes from: each element's own volume, or nodes: the pressure form, which the
 * literature and scenes call mixed (see docs/fem.md). In the code `mixed` is a precision. */
typedef enum gn_fem_form { GN_FEM_DISPLACEMENT, GN_FEM_PRESSURE } gn_fem_form;

typedef struct gn_fem_spec {
    const char *name; /* of the mesh, for messages */
    double origin[3]; /* m: what the places of nodes are relative to */
    int dimension;    /* 2: the mesh's triangles, all z equal; 3: its tetrahedra */
    gn_fem_form form;
    bool single; /* forces in single precision, sums and state in double; displacement form only */
    const gn_fem_material *materials;
    size_t material_count; /* an element has the last material that names it */
    double gravity[3];     /* m/s2; in 2D the third is ignored */
    gn_effects damping;    /* 0 or one kind of background damping, GN_FX_VISCOUS ... */
    double damping_coefficient;
    int threads;     /* 0: one */
    const char *isa; /* instruction set, NULL: automatic */
    /* The part of the body at a place [3] that elements are, 0 to 1, where something else is there
     * as well; NULL: all of it. Elements have the mean over their nodes of their volume, and with
     * it of stiffness and mass; stresses know nothing of it. */
    double (*share)(const void *of, const double *place);
    const void *share_of;
    bool shrinks; /* elements may be taken out (shrink.c): nodes know their part */
} gn_fem_spec;

/* J. Works are trapezoidal; kinetic is 1/2 m v(-) v(+), see docs/design.md. In the pressure form
 * `elastic` has the energy of the stabilising pressure, its inertia included. */
typedef struct gn_fem_energy {
    double kinetic, elastic;                            /* of the last measured instant */
    double work_prescribed, work_applied, work_gravity; /* done on the solid so far */
    double damping;                                     /* dissipated so far */
    double stored_at_start;
} gn_fem_energy;

typedef struct gn_fem_solid {
    char name[128];
    double origin[3]; /* m: what the places of nodes are relative to */
    int dimension, threads;
    gn_fem_form form;
    bool single;
    gn_effects effects;
    gn_mesh mesh;       /* its nodes and all its elements in the solid's numbering of nodes; facets
                           without solid elements behind them left out */
    gn_particles nodes; /* along a Morton curve; id: node of the mesh as it was given */
    gn_elements elements; /* sorted by nodes; id: place in the mesh's list */
    gn_element_uniform uniform;
    gn_partials partials, none;
    size_t unused_nodes;    /* nodes of the mesh that no element uses: dropped */
    size_t turned_elements; /* elements that were turned inside out in the mesh: turned back */
    double volume, mass;    /* m3, kg, at the start, of which `carried` is no part */
    double *carried;        /* [nodes] kg that move with a node beside its own mass; NULL: none */
    double height;          /* m, least of any element at the start */
    double path;            /* m, that no node can have exceeded since elements were looked at */
    double *density;        /* [materials] kg/m3 */

    /* Rows of force on nodes from outside, as of contacts with walls (borrowed); NULL: none.
     * contact_first[nodes + 1]: rows of each node. */
    const gn_wall_contacts *contacts;
    const int32_t *contact_first;

    const gn_kernel_set *kernels;
    gn_element_kernel *element_kernel[2]; /* plain, measuring; in single precision the measuring one
                                             is that in double, whose forces do not count */
    gn_motion_kernel *motion_kernel;
    double gravity[3], damping_coefficient;
    gn_prescription prescribed;
    int32_t (*channel)[3]; /* [prescribed.count] motion that drives a component, -1: free */
    int32_t motion_count;

    /* Pressure form (pressure.c); NULL and zero in the other. */
    gn_dilation_kernel *dilation_kernel;
    double *growth_row, *slope_row; /* further rows of the partial sums, [2] each */
    double *pressure;               /* [nodes] scratch of readings */
    double rate2;                   /* 1/s2: how fast the stabilising pressure follows */
    gn_pressure_kernel *const *pressure_kernel; /* [GN_PRESSURE_PASSES] */
    gn_pressure_sums *pressure_sums;            /* per block of nodes */

    gn_element_sums *element_sums; /* per block of elements */
    gn_motion_sums *motion_sums;   /* per block of nodes */
    size_t motion_blocks;

    gn_deal deal;               /* of steps among the threads */
    gn_hold hold;               /* nodes that wait for an exchange */
    struct gn_fem_known *known; /* from the last gn_fem_bound_again (bound.c); NULL: none yet */
    bool measured;              /* the step between gn_fem_forces and gn_fem_move */

    int64_t step;
    double time, dt_past;
    gn_fem_energy energy;    /* running */
    gn_fem_energy reading;   /* at the last measured instant */
    gn_element_sums elastic; /* of the last measured instant, all elements; `element` by place */
} gn_fem_solid;

/* Takes over the contents of `mesh` (also on failure, when they are freed). Errors are
 * GNEISS_ERROR_INPUT: material out of range (the explicit displacement form needs nu < 0.5), no
 * elements, an element without volume or material, a missing group. */
gneiss_status gn_fem_solid_create(const gn_fem_spec *spec, gn_mesh *mesh, gn_fem_solid *solid,
                                  gneiss_error *error);
/* Other gravity and background damping from now on, as gn_fem_spec has them. */
gneiss_status gn_fem_surround(gn_fem_solid *solid, const double gravity[3], gn_effects damping,
                              double coefficient, gneiss_error *error);
void gn_fem_solid_free(gn_fem_solid *solid);

/* Bytes held by nodes, elements and partial sums. */
size_t gn_fem_bytes(const gn_fem_solid *solid);

/* --- elements that go (shrink.c) --- */

#define GN_FEM_FAR 1e100 /* m: distance where nothing was taken out */

/* The element of the mesh with that number; -1: it was taken out. [*count] gn_alloc'ed, by number;
 * NULL: no memory. */
int32_t *gn_fem_places(const gn_fem_solid *solid, size_t *count);
/* Leaves the elements that are marked. Nodes without any are at rest from then on, without mass. */
gneiss_status gn_fem_keep(gn_fem_solid *solid, const uint8_t *keep, gneiss_error *error);
/* Volumes of elements, and masses of nodes with what they carry, from the parts at the nodes
 * (blend). */
void gn_fem_weigh(gn_fem_solid *solid);
/* What a step keeps by blocks of elements, after their record was replaced. */
gneiss_status gn_fem_elements_changed(gn_fem_solid *solid, gneiss_error *error);
/* J, of some elements [count] where nodes are after `ahead` s at their velocities; displacement
 * form. */
double gn_fem_stored(const gn_fem_solid *solid, const int32_t *element, size_t count, double ahead);
/* N, [corners]: what an element does to its nodes at the present positions, of the part of the body
 * that it has; displacement form. */
void gn_fem_force_of(const gn_fem_solid *solid, size_t element, double force[4][3]);
/* J/m3 that an element holds at the present positions, displacement form; its F. */
double gn_fem_held_density(const gn_fem_solid *solid, size_t element);
void gn_fem_gradient_of(const gn_fem_solid *solid, size_t element, double f[3][3]);
/* The turn of an element, R of F = R U, at the present positions; the number of the element by
 * place. */
void gn_fem_turn(const gn_fem_solid *solid, size_t element, double turn[3][3]);

/* --- sets and loads (loads.c) --- */

/* Nodes by their places in the solid. */
typedef struct gn_fem_set {
    size_t count;
    int32_t *node; /* [count] ascending; gn_alloc'ed */
} gn_fem_set;

/* Whether a mesh has a group of that dimension (-1: of any), by name or tag. */
bool gn_fem_has_group(const gn_mesh *mesh, const char *group, int dimension);
/* GNEISS_ERROR_INPUT with the groups there are when it has not; `name` is that of the mesh. */
gneiss_status gn_fem_check_group(const char *name, const gn_mesh *mesh, const char *group,
                                 int dimension, gneiss_error *error);
/* The nodes of a physical group of any dimension, by name or tag. GNEISS_ERROR_INPUT names the
 * groups there are. */
gneiss_status gn_fem_nodes_of_group(const gn_fem_solid *solid, const char *group, gn_fem_set *set,
                                    gneiss_error *error);
/* The nodes that start in a box, boundary included; corners as the user sees them.
 * GNEISS_ERROR_INPUT when there are none. */
gneiss_status gn_fem_nodes_in_box(const gn_fem_solid *solid, const double lower[3],
                                  const double upper[3], gn_fem_set *set, gneiss_error *error);
void gn_fem_set_free(gn_fem_set *set);

/* Prescribes components (mask, bit k: x y z) of the velocity; later calls win. *motion is the
 * number under which the velocity is changed and the reaction asked for. To be called before the
 * first step: nodes start with what is prescribed. */
gneiss_status gn_fem_prescribe(gn_fem_solid *solid, const gn_fem_set *set, unsigned mask,
                               const double velocity[3], int32_t *motion, gneiss_error *error);
void gn_fem_set_velocity(gn_fem_solid *solid, int32_t motion, const double velocity[3]);
/* N: what the prescription supplied at the instant the last step started from. */
void gn_fem_reaction(const gn_fem_solid *solid, int32_t motion, double force[3]);

/* N, to every node of a set, on top of what is there. */
void gn_fem_add_force(gn_fem_solid *solid, const gn_fem_set *set, const double force[3]);
/* Pa, of fixed direction, on the facets of a group (lines in 2D), lumped to their nodes, on top. */
gneiss_status gn_fem_add_traction(gn_fem_solid *solid, const char *group, const double traction[3],
                                  gneiss_error *error);

/* A load whose size may follow time (timed_loads.c): nodes and what each has of it. */
typedef struct gn_fem_load {
    size_t count;
    int32_t *node; /* [count]; gn_alloc'ed, as below */
    double *share; /* [count] m2 of a traction, or parts of 1 of a force */
} gn_fem_load;

/* Shares of the facets of a group (of dimension - 1) or, with `group` NULL, of the mesh's facets
 * whose nodes all start in a box, boundary included: m2, lumped to their nodes. GNEISS_ERROR_INPUT
 * when there are none. */
gneiss_status gn_fem_load_on_facets(const gn_fem_solid *solid, const char *group,
                                    const double lower[3], const double upper[3], gn_fem_load *load,
                                    gneiss_error *error);
/* Shares by mass; they add up to 1. */
gneiss_status gn_fem_load_on_nodes(const gn_fem_solid *solid, const gn_fem_set *set,
                                   gn_fem_load *load, gneiss_error *error);
/* Scales the shares so that they add up to 1. */
void gn_fem_load_normalise(gn_fem_load *load);
void gn_fem_load_free(gn_fem_load *load);
/* The forces on all nodes of the loads become the sum of share x value; no other force is left on
 * them. */
void gn_fem_set_loads(gn_fem_solid *solid, const gn_fem_load *load, const double (*value)[3],
                      size_t count);

/* Facets that others can touch (surface.c): those of a group, by name or tag, or, with `group`
 * NULL, the whole boundary. Nodes by their places in the solid; *corner [*count][dimension],
 * gn_alloc'ed. GNEISS_ERROR_INPUT names the groups there are. */
gneiss_status gn_fem_surface(const gn_fem_solid *solid, const char *group, int32_t **corner,
                             size_t *count, gneiss_error *error);

/* --- time step (limit.c) --- */

typedef struct gn_fem_limit {
    double bound;          /* s, never above the limit of the linearised solid at the start */
    int32_t bound_element; /* that sets it, by its id */
    double sharp;          /* s: 2/w_max by Lanczos */
    double sharp_low;      /* s: 2/sqrt(Ritz value + residual), never below `bound` */
    int32_t sharp_element; /* with the largest share of the energy of the fastest mode, by its id */
    int32_t sharp_node;    /* with the largest share in it, by its id */
    int iterations;        /* Lanczos vectors */
    double frequency;      /* w_max, rad/s */
} gn_fem_limit;

/* About the reference state, prescribed components immovable, of the elements by themselves: nodes
 * without what they carry. Non-viscous background damping a
 * takes 1/sqrt(1 + a) of the limit (see docs/design.md), viscous none; both are left out here.
 * Without anything that can move both limits are INFINITY. `tolerance`: as gn_step_limits. The same
 * for any number of threads. */
gneiss_status gn_fem_limits(gn_fem_solid *solid, double tolerance, gn_fem_limit *limit,
                            gneiss_error *error);
/* Only the bound and the element that sets it. */
gneiss_status gn_fem_bound(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error);
/* The same of a body of which *limit has the bound of before; from the second time on at little
 * cost where most of it is as it was. */
gneiss_status gn_fem_bound_again(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error);

/* By what strain and tension may have divided the limit since the start (measures.c): it is now at
 * least `bound`/factor, to first order in the strain. 1 without strain, whatever the rotation. */
double gn_fem_stiffening(const gn_fem_solid *solid);

/* --- step (step.c) --- */

/* Advances by one step. Forces, reactions and, with `measure`, `reading` and `elastic` are those of
 * the instant at which the step starts; positions, velocities and time those at its end.
 * GNEISS_ERROR_UNSTABLE: an element inside out (looked for in measured steps, every
 * GN_FEM_CHECK_EVERY steps and where nodes are fast enough for one between two looks), or a
 * velocity that is not finite; the state is the last computed. */
enum { GN_FEM_CHECK_EVERY = 64 };
gneiss_status gn_fem_step(gn_fem_solid *solid, double dt, bool measure, gneiss_error *error);

/* The same in two parts: forces, and the motion of all nodes that are not held; then, when an
 * exchange has added to the loads of the others (solid->hold), these. */
void gn_fem_forces(gn_fem_solid *solid, double dt, bool measure);
gneiss_status gn_fem_move(gn_fem_solid *solid, double dt, gneiss_error *error);

/* To be called after positions were changed other than by steps: the pressure form and single
 * precision keep copies. */
void gn_fem_moved(gn_fem_solid *solid);
/* Makes all that single precision keeps anew, if the solid has it: after records were read. */
void gn_fem_to_single(gn_fem_solid *solid);

/* Stored energy less what it was and what came in, plus what was lost: of `reading`, in J. */
double gn_fem_energy_residual(const gn_fem_energy *energy);

/* Hash of the state: nodes, elements, time. */
uint64_t gn_fem_hash(const gn_fem_solid *solid);

/* --- readings (stress.c) --- */

/* Pa, Cauchy, tension positive, of the present positions: xx yy zz xy yz zx per element, by place.
 */
void gn_fem_element_stress(const gn_fem_solid *solid, double (*stress)[6]);
/* The same of one element; of the pressure form with the pressures last found. */
void gn_fem_stress_of(const gn_fem_solid *solid, size_t element, double stress[6]);
/* Stress at nodes: mean over the elements at the node, weighted by their volumes. */
gneiss_status gn_fem_nodal_stress(const gn_fem_solid *solid, const double (*element)[6],
                                  double (*nodal)[6], gneiss_error *error);
/* Pa, tension positive, per node, by place: the pressure form's own; in the displacement form that
 * of the nodal stress. */
gneiss_status gn_fem_nodal_pressure(const gn_fem_solid *solid, double *pressure,
                                    gneiss_error *error);

/* det F of an element at the present positions (measures.c). */
double gn_fem_volume_ratio(const gn_fem_solid *solid, size_t element);

/* s: 2/sqrt of the trace of M_e^-1 K_e of every element alone, by place: how elements compare in
 * what step they allow (measures.c). */
void gn_fem_step_scales(const gn_fem_solid *solid, double *scale);

/* --- averages (measures.c) --- */

/* The mean displacement gradient over the solid is linear in the displacements: <du_a/dX_b> = sum_n
 * u_a(n) w_b(n), with w(n) = sum_e V_e grad N_n / sum_e V_e. weight[nodes][3], 1/m. */
void gn_fem_strain_weights(const gn_fem_solid *solid, double (*weight)[3]);
/* gradient[3 a + b] = <du_a/dX_b> of the present positions. */
void gn_fem_mean_gradient(const gn_fem_solid *solid, const double (*weight)[3], double gradient[9]);

/* N: mean size of the forces V sigma grad N_a that elements exert on their nodes, from Cauchy
 * stresses; what a mean resultant is to be compared with. */
double gn_fem_mean_force(const gn_fem_solid *solid, const double (*stress)[6]);

#endif
