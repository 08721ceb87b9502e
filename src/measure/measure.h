/* From particles to material: average stress and strain, fabric, damage, laboratory readings.
 * Tension is positive in every stress and strain here; laboratory readings are positive in
 * compression tests (peak_stress, peak_strain) as reported in the field. */
#ifndef GN_MEASURE_MEASURE_H
#define GN_MEASURE_MEASURE_H

#include "soa/records.h"

#include <stdbool.h>

/* The force-carrying parts of a state. Any list may be empty (count 0); `walls` may be NULL. */
typedef struct gn_assembly {
    int dimension; /* 2 or 3 */
    const gn_particles *particles;
    const gn_contacts *list[GN_LISTS_MOST]; /* NULL: none */
    const gn_wall_contacts *wall_contacts;  /* may be NULL */
    const double *wall_normals;             /* [walls][4], unit, pointing to the particles */
    bool periodic;
    double period[3];  /* m, with `periodic` */
    size_t wall_count; /* larger values of gn_wall_contacts.wall are facets */
} gn_assembly;

/* --- strain (Bagi 1996) --- */

/* A strain gauge. The volume average of the displacement gradient over a Delaunay triangulation of
 * the reference centres is linear in the displacements: <du_a/dx_b> = sum_p u_a(p) w_b(p). The
 * weights of inner particles vanish (divergence theorem), so that a reading costs only the surface
 * particles. In a bonded body only particles with more initial bonds than dimensions count, unless
 * fewer than half of all have them. */
typedef struct gn_strain_gauge {
    size_t count;
    int32_t *id;    /* [count] particle ids with a non-zero weight */
    double *weight; /* [count][3], 1/m */
    double volume;  /* volume of the triangulation, m3 (m2 in 2D, per unit thickness) */
} gn_strain_gauge;

/* Selects the particles that count initially: counts[p] 1 or 0, [particles]. */
void gn_strain_gauge_select(const gn_particles *particles, int dimension, uint8_t *counts);

/* Triangulates `particles->start` of those that count. Fewer than dimension + 1 particles or all on
 * a plane (line): count 0 and GNEISS_OK, readings are then NaN. */
gneiss_status gn_strain_gauge_of(const gn_particles *particles, const uint8_t *counts,
                                 int dimension, gn_strain_gauge *gauge, gneiss_error *error);
/* Makes such a gauge in a tenth of the time where a triangulation would be needed, as for lattices:
 * by another surface through the outer particles, which reads a uniform gradient as exactly. */
gneiss_status gn_strain_gauge_fast(const gn_particles *particles, const uint8_t *counts,
                                   int dimension, gn_strain_gauge *gauge, gneiss_error *error);
void gn_strain_gauge_free(gn_strain_gauge *gauge);

/* Computes the displacement gradient g[3*a + b] = <du_a/dx_b>, a, b = x y z; `index_of_id[id]` is
 * the particle's present place (negative: removed, its last displacement counts as zero). NaN with
 * an empty gauge. */
void gn_strain_gauge_read(const gn_strain_gauge *gauge, const gn_particles *particles,
                          const int32_t *index_of_id, double gradient[9]);

/* Computes the strain of a displacement gradient that is invariant to rotation: U - 1 with U^2 =
 * F^T F, F = 1 + g (Biot 1965). For small gradients it is the symmetric part. */
void gn_strain_of(const double gradient[9], double strain[9]);

/* --- stress --- */

/* Computes the stress per particle: the sum over its contacts of the force on it times the vector
 * from its centre to the contact point, over V_p/(1 - porosity). `sigma` [count][6]: xx yy zz xy yz
 * xz, symmetric part, in the particles' present order. */
void gn_stress_particles(const gn_assembly *assembly, double porosity, double *sigma);

/* --- packing --- */

typedef struct gn_packing_figures {
    size_t particles;
    size_t contacts;     /* pairs with gap <= tolerance (r_i + r_j) */
    double coordination; /* 2 contacts/particles */
    double fabric[9];    /* (1/N_c) sum n n */
    double radius_min, radius_max, radius_mean;
    double solid_volume;          /* sum of particle volumes, m3 */
    double porosity;              /* 1 - solid/volume; NaN without a volume */
    double overlap_max;           /* largest overlap over r_i + r_j */
    double overlap_mean;          /* mean over overlapping pairs */
    int32_t overlap_i, overlap_j; /* ids of the pair with the largest overlap, -1: none */
} gn_packing_figures;

/* Computes packing figures. `pairs` [pair_count][2] are candidate pairs (present indices) that
 * include every pair within tolerance. `volume` 0: unknown. */
void gn_packing_measure(const gn_assembly *assembly, const int32_t *pairs, size_t pair_count,
                        double tolerance, double volume, gn_packing_figures *figures);

/* Computes the volume (2D: area) of the convex hull of the particles, spheres or discs, to some
 * 1e-4 for any rotation; it is the specimen's volume if the scene gives none. Also computes the
 * extent (largest and smallest coordinate including radii) along each axis. */
gneiss_status gn_packing_hull(const gn_particles *particles, int dimension, double *volume,
                              double lower[3], double upper[3], gneiss_error *error);

/* Computes damage D = 1 - bonds now / bonds at the start per particle (Rojek et al. 2012, eq. 60),
 * 0 for particles that had no bonds; bonds that left with removed particles count as intact.
 * `damage` [count]. */
void gn_damage_particles(const gn_particles *particles, const gn_contacts *bonds, double *damage);

#endif
