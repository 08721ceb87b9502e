/* Elastic constants of a packing from its bonds alone: fabric, and the stiffness tensor by uniform
 * strain and by uniform stress. Tensors are Voigt matrices [n][n] with n = 6, order xx yy zz xy yz
 * xz (2D: n = 3, xx yy xy), that give stresses from strains with engineering shear. */
#ifndef GN_MEASURE_STIFFNESS_H
#define GN_MEASURE_STIFFNESS_H

#include <stdbool.h>
#include <stddef.h>

enum { GN_VOIGT_MOST = 6 };

/* A bond: the vector l between the centres, m, its unit vector n, and its stiffnesses, N/m. */
typedef struct gn_stiff_bond {
    double l[3], n[3], kn, kt;
} gn_stiff_bond;

typedef struct gn_elastic {
    int dimension;
    double c[GN_VOIGT_MOST * GN_VOIGT_MOST]; /* Pa, [n][n] */
} gn_elastic;

/* The isotropic tensor nearest to a given one (in the norm |C|^2 = C_ijkl C_ijkl), and the relative
 * distance between them. In 2D it is one of plane strain; NaN without stiffness. */
typedef struct gn_isotropic {
    double young, poisson; /* Pa, 1 */
    double anisotropy;     /* |C - C_iso|/|C| */
} gn_isotropic;

typedef struct gn_bond_fabric {
    size_t bonds;
    double second[9];                             /* <n_i n_j>, [3][3] */
    double fourth[GN_VOIGT_MOST * GN_VOIGT_MOST]; /* <n_i n_j n_k n_l>, Voigt, [n][n] */
    double length, square;                        /* m, m2: <l>, <l^2> */
    double kn, kt;                                /* N/m: means */
    double modulus;                               /* Pa: sum of k_n l^2 over the volume */
} gn_bond_fabric;

static inline int gn_voigt_size(int dimension) {
    return dimension == 3 ? 6 : 3;
}

/* Multiplies the strain of a row (xx: 1, shear: 1/2 twice) by l. */
void gn_voigt_stretch(int dimension, int row, const double l[3], double e[3]);

gn_bond_fabric gn_bond_fabric_of(int dimension, const gn_stiff_bond *bond, size_t count,
                                 double volume);

/* Returns the stiffness if all particles follow a uniform strain and do not rotate: (1/V) sum l_i
 * k_jk l_l, symmetrised in (ij) and (kl), which excludes the strain of bonds by rigid rotation
 * (Liao et al. 1997, Int. J. Solids Struct. 34, 4087-4100). It is an upper bound. `volume` m3 (2D:
 * m2 x 1 m). */
gn_elastic gn_stiffness_by_strain(int dimension, const gn_stiff_bond *bond, size_t count,
                                  double volume);

/* Computes the stiffness if the force of every bond is f_i = s_ij A_jk l_k, with A^-1 = (1/V) sum l
 * l (Liao et al. 1997): it is a lower bound where these forces balance on all particles, as in
 * lattices of equal particles, and otherwise an estimate. Returns false, and zeros, if there is no
 * such stiffness: a bond lacks one of its stiffnesses, or the bonds do not span the space. */
bool gn_stiffness_by_stress(int dimension, const gn_stiff_bond *bond, size_t count, double volume,
                            gn_elastic *found);

gn_isotropic gn_isotropic_of(const gn_elastic *tensor);

#endif
