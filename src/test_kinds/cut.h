/* Data of a cut, which its readings use, and closed-form expressions for forces on tools. */
#ifndef GN_TEST_KINDS_CUT_H
#define GN_TEST_KINDS_CUT_H

typedef enum gn_cut_tool {
    GN_CUT_OTHER, /* no closed form is known */
    GN_CUT_DISC,
    GN_CUT_CHISEL,
    GN_CUT_PICK
} gn_cut_tool;

/* Sizes in m, angles in rad, strengths in Pa; 0: not given. */
typedef struct gn_cut {
    gn_cut_tool tool;
    double depth, spacing;
    double begin, end;           /* m, range of the path over which means are taken */
    double window;               /* m, length of path over which a peak is averaged */
    int blocks;                  /* number of parts of that range */
    double radius, tip_width;    /* of a disc cutter */
    double rake, width;          /* of a chisel; width in 2D 1 m */
    double half_angle;           /* of a pick: half of the angle of its cone */
    double friction;             /* angle of friction between tool and rock */
    double compressive, tensile; /* strengths of the rock */
    double exponent;             /* exponent psi of the pressure along the rim (gn_csm) */
    double damage_depth;         /* m; NaN: no bond is broken */
    double contact_area;         /* m2; NaN: it was not sampled */
    double removed;              /* m3, volume of rock removed along the range of the means */
    double removed_beside; /* m3, part of it whose particles began beside the track of the tool */
} gn_cut;

/* Computes forces on a disc cutter by the model of the Colorado School of Mines (Rostami 1997, PhD
 * thesis, eq. 4.1 to 4.6): arc = acos((R - p)/R), P(theta) = P0 (theta/arc)^psi with P0 = 2.12
 * (sigma_c^2 sigma_t s/(arc sqrt(R T)))^(1/3), F = T R arc P0/(1 + psi), which acts at arc/2. */
typedef struct gn_csm {
    double arc;             /* rad */
    double pressure;        /* Pa, P0 */
    double total;           /* N */
    double normal, rolling; /* N */
    double
        coefficient; /* ratio of rolling to normal force, which requires neither s nor strengths */
} gn_csm;
gn_csm gn_csm_of(const gn_cut *cut);

#endif
