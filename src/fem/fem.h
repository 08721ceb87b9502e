/* A solid of explicit finite elements: linear triangles in plane strain (1 m thick) or tetrahedra,
 * linear elastic, large rotations, plain displacement form.
 *
 * Flow: gn_fem_solid_create (mesh -> nodes, elements), loads.c (sets, loads), gn_fem_limits (time
 * step), gn_fem_step, stress.c (readings), gn_fem_solid_free. Nodes are a particle record, so that
 * the motion kernels move them; the elements' kernel is kernels/element_template.c. */
#ifndef GN_FEM_FEM_H
#define GN_FEM_FEM_H

#include "kernels/dispatch.h"
#include "mesh/mesh.h"
#include "sched/deal.h"
#include "sched/hold.h"

typedef struct gn_fem_material {
    const char *group;              /* group of elements, by name or tag; NULL: all elements */
    double young, poisson, density; /* Pa, -, kg/m3 */
} gn_fem_material;

/* Source of the pressure: each element's own change of volume, or values at nodes. The latter is
 * the pressure form, which the literature and scenes call mixed (see docs/fem.md). In the code
 * `mixed` is a precision. */
typedef enum gn_fem_form { GN_FEM_DISPLACEMENT, GN_FEM_PRESSURE } gn_fem_form;

typedef struct gn_fem_spec {
    const char *name; /* name of the mesh, for messages */
    double origin[3]; /* m: origin to which node positions are relative */
    int dimension;    /* 2: the mesh's triangles, all z equal; 3: its tetrahedra */
    gn_fem_form form;
    bool single; /* forces in single precision, sums and state in double; displacement form only */
    const gn_fem_material *materials;
    size_t material_count; /* if several groups contain an element, it has the last material */
    double gravity[3];     /* m/s2; in 2D the third is ignored */
    gn_effects damping;    /* 0 or one kind of background damping, GN_FX_VISCOUS ... */
    double damping_coefficient;
    int threads;     /* 0: one */
    const char *isa; /* instruction set, NULL: automatic */
    /* Returns the weight of the elements, 0 to 1, at a position [3], for coupling zones; NULL: 1.
     * The volume of an element, and with it stiffness and mass, is multiplied by the mean over its
     * nodes; stresses do not depend on it. */
    double (*share)(const void *of, const double *place);
    const void *share_of;
    bool shrinks; /* elements may be removed (shrink.c): nodes store their weights */
} gn_fem_spec;

/* Energies, J. Works are trapezoidal; the kinetic energy is 1/2 m v(-) v(+), see
 * docs/results-h5.md. In the pressure form `elastic` includes the energy and the inertia of the
 * stabilising pressure. */
typedef struct gn_fem_energy {
    double kinetic, elastic;                            /* energies at the last measured instant */
    double work_prescribed, work_applied, work_gravity; /* J, work done on the solid so far */
    double damping;                                     /* J, energy dissipated so far */
    double stored_at_start;
} gn_fem_energy;

typedef struct gn_fem_solid {
    char name[128];
    double origin[3]; /* m: origin to which node positions are relative */
    int dimension, threads;
    gn_fem_form form;
    bool single;
    gn_effects effects;
    /* all nodes and elements in the solid's numbering, and facets of the solid's elements */
    gn_mesh mesh;
    gn_particles nodes;   /* sorted along a Morton curve; id: node of the given mesh */
    gn_elements elements; /* sorted by nodes; id: index in the mesh's list */
    gn_element_uniform uniform;
    gn_partials partials;
    size_t unused_nodes;    /* number of nodes of the mesh without elements, which were dropped */
    size_t turned_elements; /* number of inverted elements of the mesh, which were reversed */
    double volume, mass;    /* m3, kg, at the start, without `carried` */
    double *carried;        /* [nodes] additional mass that moves with a node, kg; NULL: none */
    double height;          /* m, least height of any element at the start */
    double path;            /* m, bound of nodal paths since the last check of elements */
    double *density;        /* [materials] kg/m3 */

    /* Rows of external forces on nodes, like those of contacts with walls (borrowed); NULL: none.
     * contact_first[nodes + 1]: first row of each node. */
    const gn_wall_contacts *contacts;
    const int32_t *contact_first;

    const gn_kernel_set *kernels;
    /* the plain and the measuring one; with single precision the measuring kernel computes in
     * double, and its forces are discarded */
    gn_element_kernel *element_kernel[2];
    gn_motion_kernel *motion_kernel;
    double gravity[3], damping_coefficient;
    gn_prescription prescribed;
    int32_t (*channel)[3]; /* [prescribed.count] motion that drives a component, -1: free */
    int32_t motion_count;

    /* Pressure form (pressure.c); NULL and zero in the displacement form. */
    gn_dilation_kernel *dilation_kernel;
    double *growth_row, *slope_row; /* further rows of the partial sums, two numbers each */
    double *pressure;               /* [nodes] scratch of readings */
    double rate2; /* 1/s2: squared rate at which the stabilising pressure follows */
    gn_pressure_kernel *const *pressure_kernel; /* [GN_PRESSURE_PASSES] */
    gn_pressure_sums *pressure_sums;            /* per block of nodes */

    gn_element_sums *element_sums; /* per block of elements */
    gn_motion_sums *motion_sums;   /* per block of nodes */
    size_t motion_blocks;

    gn_deal deal; /* work distribution of steps */
    gn_hold hold; /* blocks of nodes that wait for features */
    /* result of the last gn_fem_bound_update; NULL: none yet */
    struct gn_fem_bound_cache *bound_cache;
    bool measured; /* the step between gn_fem_forces and gn_fem_move is measured */

    int64_t step;
    double time, dt_past;
    gn_fem_energy energy;    /* running totals */
    gn_fem_energy reading;   /* energies at the last measured instant */
    gn_element_sums elastic; /* sums over all elements at the last measured instant; `element`: its
                                place in the record */
} gn_fem_solid;

/* Creates a solid and takes ownership of the contents of `mesh` (freed on failure).
 * GNEISS_ERROR_INPUT: a material is out of range (the displacement form needs nu < 0.5), there are
 * no elements, an element has no volume or no material, or a group is missing. */
gneiss_status gn_fem_solid_create(const gn_fem_spec *spec, gn_mesh *mesh, gn_fem_solid *solid,
                                  gneiss_error *error);
/* Changes gravity and background damping, as gn_fem_spec has them. */
gneiss_status gn_fem_set_environment(gn_fem_solid *solid, const double gravity[3],
                                     gn_effects damping, double coefficient, gneiss_error *error);
void gn_fem_solid_free(gn_fem_solid *solid);

/* Returns the bytes held by nodes, elements and partial sums. */
size_t gn_fem_bytes(const gn_fem_solid *solid);

/* --- removal of elements (shrink.c) --- */

#define GN_FEM_FAR 1e100 /* m, distance to the nearest removed element if none was removed */

/* Returns the place in the record of each element of the mesh, gn_alloc'ed [*count]; -1: the
 * element was removed. NULL: no memory. */
int32_t *gn_fem_places(const gn_fem_solid *solid, size_t *count);
/* Keeps the marked elements and removes the others. Nodes without elements are at rest and without
 * mass from then on. */
gneiss_status gn_fem_keep(gn_fem_solid *solid, const uint8_t *keep, gneiss_error *error);
/* Recomputes volumes of elements, and masses of nodes including those that they carry, from the
 * weights at the nodes (blend). */
void gn_fem_apply_weights(gn_fem_solid *solid);
/* Rebuilds the data of a step by blocks of elements after their record was replaced. */
gneiss_status gn_fem_elements_changed(gn_fem_solid *solid, gneiss_error *error);
/* Returns the elastic energy, J, of some elements [count] after nodes have moved for `ahead` s at
 * their velocities; displacement form only. */
double gn_fem_elastic_energy(const gn_fem_solid *solid, const int32_t *element, size_t count,
                             double ahead);
/* Computes the forces [corners], N, of an element on its nodes at the present positions, with its
 * weight; displacement form only. */
void gn_fem_force_of(const gn_fem_solid *solid, size_t element, double force[4][3]);
/* Returns the elastic energy density, J/m3, of an element at the present positions, from its F;
 * displacement form only. */
double gn_fem_energy_density(const gn_fem_solid *solid, size_t element);
void gn_fem_gradient_of(const gn_fem_solid *solid, size_t element, double f[3][3]);
/* Computes the rotation R of F = R U of an element at the present positions; `element`: place in
 * the record. */
void gn_fem_rotation(const gn_fem_solid *solid, size_t element, double turn[3][3]);

/* --- sets and loads (loads.c) --- */

/* Nodes, by their places in the solid. */
typedef struct gn_fem_set {
    size_t count;
    int32_t *node; /* [count] ascending; gn_alloc'ed */
} gn_fem_set;

/* Tells whether a mesh has a group of that dimension (-1: any), by name or tag. */
bool gn_fem_has_group(const gn_mesh *mesh, const char *group, int dimension);
/* Returns GNEISS_ERROR_INPUT, with a list of the existing groups, if the mesh has no such group;
 * `name`: of the mesh. */
gneiss_status gn_fem_check_group(const char *name, const gn_mesh *mesh, const char *group,
                                 int dimension, gneiss_error *error);
/* Collects the nodes of a physical group of any dimension, by name or tag. GNEISS_ERROR_INPUT lists
 * the existing groups. */
gneiss_status gn_fem_nodes_of_group(const gn_fem_solid *solid, const char *group, gn_fem_set *set,
                                    gneiss_error *error);
/* Collects the nodes initially in a box, boundary included; corners are absolute coordinates.
 * GNEISS_ERROR_INPUT if there are none. */
gneiss_status gn_fem_nodes_in_box(const gn_fem_solid *solid, const double lower[3],
                                  const double upper[3], gn_fem_set *set, gneiss_error *error);
void gn_fem_set_free(gn_fem_set *set);

/* Prescribes the components of the velocity in `mask` (bit k: x y z); later calls override. *motion
 * is the number of the motion, by which its velocity is changed and its reaction read. To be called
 * before the first step, because nodes start with their prescribed velocity. */
gneiss_status gn_fem_prescribe(gn_fem_solid *solid, const gn_fem_set *set, unsigned mask,
                               const double velocity[3], int32_t *motion, gneiss_error *error);
void gn_fem_set_velocity(gn_fem_solid *solid, int32_t motion, const double velocity[3]);
/* Computes the force, N, that a prescribed motion required at the start of the last step. */
void gn_fem_reaction(const gn_fem_solid *solid, int32_t motion, double force[3]);

/* A load that may vary with time (loads.c): its nodes and their shares. */
typedef struct gn_fem_load {
    size_t count;
    int32_t *node; /* [count]; gn_alloc'ed, as below */
    double *share; /* [count] m2 of a traction, or fractions of a force */
} gn_fem_load;

/* Computes shares from the facets of a group (of dimension - 1) or, with `group` NULL, of the
 * facets of the mesh all of whose nodes are initially in a box, boundary included: areas, m2,
 * lumped to their nodes. GNEISS_ERROR_INPUT if there are no such facets. */
gneiss_status gn_fem_load_on_facets(const gn_fem_solid *solid, const char *group,
                                    const double lower[3], const double upper[3], gn_fem_load *load,
                                    gneiss_error *error);
/* Computes shares proportional to mass; their sum is 1. */
gneiss_status gn_fem_load_on_nodes(const gn_fem_solid *solid, const gn_fem_set *set,
                                   gn_fem_load *load, gneiss_error *error);
/* Scales the shares to a sum of 1. */
void gn_fem_load_normalise(gn_fem_load *load);
void gn_fem_load_free(gn_fem_load *load);
/* Sets the forces on all nodes of the loads to the sum of share times value; other forces on these
 * nodes are dropped. */
void gn_fem_set_loads(gn_fem_solid *solid, const gn_fem_load *load, const double (*value)[3],
                      size_t count);

/* Lists contact facets: those of a group, by name or tag, or, with `group` NULL, the whole
 * boundary. Nodes are numbered by their index in the solid; *corner [*count][dimension],
 * gn_alloc'ed. GNEISS_ERROR_INPUT lists the existing groups. */
gneiss_status gn_fem_surface(const gn_fem_solid *solid, const char *group, int32_t **corner,
                             size_t *count, gneiss_error *error);

/* --- time step (limit.c) --- */

typedef struct gn_fem_limit {
    double bound;          /* s, never above the limit of the solid linearised at its start */
    int32_t bound_element; /* id of the element that determines the bound */
    double sharp;          /* s: 2/w_max by Lanczos */
    double sharp_low;      /* s: 2/sqrt(Ritz value + residual), never below `bound` */
    /* id of the element with the largest share of the energy of the fastest mode */
    int32_t sharp_element;
    int32_t sharp_node; /* id of the node with the largest share of that energy */
    int iterations;     /* Lanczos vectors */
    double frequency;   /* w_max, rad/s */
} gn_fem_limit;

/* Computes the limits at the reference state, with prescribed components fixed, for the elements
 * alone: masses carried by nodes are left out. Non-viscous background damping a multiplies the
 * limit by 1/sqrt(1 + a) (see docs/timestep.md), viscous damping leaves it unchanged; both are
 * ignored here. If nothing can move, both limits are INFINITY. `tolerance`: see gn_step_limits. The
 * result is the same for any number of threads. */
gneiss_status gn_fem_limits(gn_fem_solid *solid, double tolerance, gn_fem_limit *limit,
                            gneiss_error *error);
/* Computes the bound alone, and the element that determines it. */
gneiss_status gn_fem_bound(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error);
/* Updates the bound in *limit after changes of the body; from the second call on this costs little
 * if most of the body is unchanged. */
gneiss_status gn_fem_bound_update(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error);

/* Returns a factor of at least 1 by which strain and tension may have reduced the limit since the
 * start (stress.c): the limit is at least `bound`/factor, to first order in the strain. Without
 * strain the factor is 1 for any rotation. */
double gn_fem_stiffening(const gn_fem_solid *solid);

/* --- step (step.c) --- */

/* Advances by one step. Forces, reactions and, with `measure`, `reading` and `elastic` are those at
 * the start of the step; positions, velocities and time are those at its end.
 * GNEISS_ERROR_UNSTABLE: an element is inverted (checked in measured steps, every
 * GN_FEM_CHECK_EVERY steps, and if nodes are fast enough to invert one between two checks), or a
 * velocity is not finite; the state is the last computed one. */
enum { GN_FEM_CHECK_EVERY = 64 };
gneiss_status gn_fem_step(gn_fem_solid *solid, double dt, bool measure, gneiss_error *error);

/* A step in two parts. gn_fem_forces computes forces and moves all nodes that are not held; other
 * parts of the model then add to the loads of the held nodes (solid->hold), and gn_fem_move moves
 * these. */
void gn_fem_forces(gn_fem_solid *solid, double dt, bool measure);
gneiss_status gn_fem_move(gn_fem_solid *solid, double dt, gneiss_error *error);

/* Updates the copies of positions in the pressure form and single precision; to be called after
 * positions were changed outside of steps. */
void gn_fem_positions_changed(gn_fem_solid *solid);
/* Recomputes all single precision data, if the solid has them, after records were read. */
void gn_fem_to_single(gn_fem_solid *solid);

/* Returns a hash of the state: nodes, elements, time. */
uint64_t gn_fem_hash(const gn_fem_solid *solid);

/* --- readings (stress.c) --- */

/* Computes the Cauchy stress of each element at the present positions, in the order of the record:
 * xx yy zz xy yz zx, Pa, tension positive. */
void gn_fem_element_stress(const gn_fem_solid *solid, double (*stress)[6]);
/* Computes the stress of one element; in the pressure form with the last computed pressures. */
void gn_fem_stress_of(const gn_fem_solid *solid, size_t element, double stress[6]);
/* Computes stresses at nodes: means over their elements, weighted by volume. */
gneiss_status gn_fem_nodal_stress(const gn_fem_solid *solid, const double (*element)[6],
                                  double (*nodal)[6], gneiss_error *error);
/* Computes the pressure at each node, in the order of the record, Pa, tension positive: the
 * variable of the pressure form; in the displacement form the mean of the normal nodal stresses. */
gneiss_status gn_fem_nodal_pressure(const gn_fem_solid *solid, double *pressure,
                                    gneiss_error *error);

/* Returns det F of an element at the present positions (stress.c). */
double gn_fem_volume_ratio(const gn_fem_solid *solid, size_t element);

/* Computes for every single element, in the order of the record, 2/sqrt of the trace of M_e^-1 K_e,
 * s, which shows how the steps that the elements allow compare (stress.c). */
void gn_fem_step_scales(const gn_fem_solid *solid, double *scale);

/* --- averages (stress.c) --- */

/* Computes the weights w of the mean displacement gradient over the solid, which is linear in the
 * displacements: <du_a/dX_b> = sum_n u_a(n) w_b(n), with w(n) = sum_e V_e grad N_n / sum_e V_e.
 * weight[nodes][3], 1/m. */
void gn_fem_strain_weights(const gn_fem_solid *solid, double (*weight)[3]);
/* Computes gradient[3 a + b] = <du_a/dX_b> at the present positions. */
void gn_fem_mean_gradient(const gn_fem_solid *solid, const double (*weight)[3], double gradient[9]);

/* Returns the mean magnitude, N, of the forces V sigma grad N_a of elements on their nodes, from
 * Cauchy stresses; mean resultants are compared with it. */
double gn_fem_mean_force(const gn_fem_solid *solid, const double (*stress)[6]);

#endif
