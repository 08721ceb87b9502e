/* Sections of bonds, for laws by area; they are computed once, when the bonds are made. */
#ifndef GN_PARTICLES_BOND_SECTIONS_H
#define GN_PARTICLES_BOND_SECTIONS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

/* Finds the sections of the bonds, whose ends and lengths are known, and gamma. Does nothing for
 * other laws. */
gneiss_status gn_areas_find(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Check of the sections: the volume of the bonds over that of the body. */
typedef struct gn_area_check {
    double filled; /* sum of section times length, over dimension times volume; should be 1 */
    double free;   /* the same ratio for the faces of polyhedra without a bond */
    size_t open;   /* particles with such faces */
    double dempack_gamma; /* 40 e/n_c, the value that the source gives for gamma */
} gn_area_check;
gneiss_status gn_areas_check(const gn_step_context *ctx, const gn_dem *dem, gn_area_check *check,
                             gneiss_error *error);

/* Returns the area of bonds, of any law, that a plane through the specimen cuts, over the area of
 * the plane, averaged over directions (law.c). */
double gn_law_cut(const gn_step_context *ctx, const gn_dem *dem);

#endif
