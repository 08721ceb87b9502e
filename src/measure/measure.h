/* From particles to material: average stress and strain, fabric, damage, laboratory readings.
 * Tension is positive in all stresses and strains here; readings of compression tests (peak_stress,
 * peak_strain) are positive in compression, as is usual in laboratories. */
#ifndef GN_MEASURE_MEASURE_H
#define GN_MEASURE_MEASURE_H

#include "soa/records.h"

#include <stdbool.h>

/* The parts of a state that carry forces. Any list may be empty (count 0); `walls` may be NULL. */
typedef struct gn_assembly {
    int dimension; /* 2 or 3 */
    const gn_particles *particles;
    const gn_contacts *list[GN_LISTS_MOST]; /* NULL: none */
    const gn_wall_contacts *wall_contacts;  /* may be NULL */
    const double *wall_normals;             /* [walls][4], unit vectors towards the particles */
    bool periodic;
    double period[3];  /* m, with `periodic` */
    size_t wall_count; /* larger values of gn_wall_contacts.wall are facets */
} gn_assembly;

/* --- strain (Bagi 1996) --- */

/* A strain gauge. The volume average of the displacement gradient over a Delaunay triangulation of
 * the reference centres is linear in the displacements: <du_a/dx_b> = sum_p u_a(p) w_b(p). The
 * weights of inner particles vanish (divergence theorem), so that a reading needs the surface
 * particles only. In a bonded body only particles that have more initial bonds than dimensions
 * count, unless fewer than half of all particles do. */
typedef struct gn_strain_gauge {
    size_t count;
    int32_t *id;    /* [count] particle ids with a non-zero weight */
    double *weight; /* [count][3], 1/m */
    double volume;  /* m3 (2D: m2, per unit thickness), volume of the triangulation */
} gn_strain_gauge;

/* Selects the particles that count at the start: counts[p] is 1 or 0, [particles]. */
void gn_strain_gauge_select(const gn_particles *particles, int dimension, uint8_t *counts);

/* Triangulates `particles->start` of the particles that count. Fewer than dimension + 1 particles,
 * or all on a plane (line): count 0 and GNEISS_OK, and readings are NaN. */
gneiss_status gn_strain_gauge_of(const gn_particles *particles, const uint8_t *counts,
                                 int dimension, gn_strain_gauge *gauge, gneiss_error *error);
/* Makes a strain gauge without a triangulation, if one would be needed, as for lattices: it uses
 * another surface through the outer particles, which measures a uniform gradient equally exactly,
 * in a tenth of the time. */
gneiss_status gn_strain_gauge_fast(const gn_particles *particles, const uint8_t *counts,
                                   int dimension, gn_strain_gauge *gauge, gneiss_error *error);
void gn_strain_gauge_free(gn_strain_gauge *gauge);

/* Computes the displacement gradient g[3*a + b] = <du_a/dx_b>, a, b = x y z; `index_of_id[id]` is
 * the present index of a particle (negative: removed, its displacement counts as zero). NaN with an
 * empty gauge. */
void gn_strain_gauge_read(const gn_strain_gauge *gauge, const gn_particles *particles,
                          const int32_t *index_of_id, double gradient[9]);

/* Computes from a displacement gradient the strain that is invariant to rotation: U - 1 with U^2 =
 * F^T F, F = 1 + g (Biot 1965). For small gradients it is the symmetric part. */
void gn_strain_of(const double gradient[9], double strain[9]);

/* --- stress --- */

/* Computes the stress of each particle: the sum over its contacts of the force on it times the
 * vector from its centre to the contact point, over V_p/(1 - porosity). `sigma` [count][6]: xx yy
 * zz xy yz xz, symmetric part, in the present order of the particles. */
void gn_stress_particles(const gn_assembly *assembly, double porosity, double *sigma);

/* --- packing --- */

typedef struct gn_packing_figures {
    size_t particles;
    size_t contacts;     /* number of pairs with gap <= tolerance (r_i + r_j) */
    double coordination; /* 2 contacts/particles */
    double fabric[9];    /* (1/N_c) sum n n */
    double radius_min, radius_max, radius_mean;
    double solid_volume;          /* sum of particle volumes, m3 */
    double porosity;              /* 1 - solid/volume; NaN without a volume */
    double overlap_max;           /* largest overlap over r_i + r_j */
    double overlap_mean;          /* mean over overlapping pairs */
    int32_t overlap_i, overlap_j; /* ids of the pair with the largest overlap, -1: none */
} gn_packing_figures;

/* Computes figures of the packing. `pairs` [pair_count][2] are candidate pairs (present indices),
 * which must include every pair within the tolerance. `volume` 0: unknown. */
void gn_packing_measure(const gn_assembly *assembly, const int32_t *pairs, size_t pair_count,
                        double tolerance, double volume, gn_packing_figures *figures);

/* Computes the volume (2D: area) of the convex hull of the particles as spheres or discs, to some
 * 1e-4 for any rotation; it is the specimen's volume if the scene gives none. Also computes the
 * extent along each axis (largest and smallest coordinate, radii included). */
gneiss_status gn_packing_hull(const gn_particles *particles, int dimension, double *volume,
                              double lower[3], double upper[3], gneiss_error *error);

/* Computes the damage of each particle, D = 1 - bonds now / bonds at the start (Rojek et al. 2012,
 * eq. 60); 0 for particles that had no bonds. Bonds that were removed with the other particle count
 * as intact. `damage` [count]. */
void gn_damage_particles(const gn_particles *particles, const gn_contacts *bonds, double *damage);

#endif
