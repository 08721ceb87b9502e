/* The structure of a packing: porosity, coordination, and the fabric of its contacts. */
#ifndef GN_MEASURE_STRUCTURE_H
#define GN_MEASURE_STRUCTURE_H

/* Returns the volume of the part of a sphere (2D: the area of a disc) that lies in the box `low` to
 * `high`, m: exact if at most one face cuts it, otherwise to 1e-4 of its own volume (in 2D always
 * exact). Sides may be infinite. */
double gn_ball_in_box(int dimension, const double centre[3], double radius, const double low[3],
                      const double high[3]);

/* The anisotropy of a fabric tensor <n_a n_b> of trace 1 (Satake 1982): `degree` is the largest
 * principal value minus the smallest, 0 if contacts have no preferred direction and 1 if all have
 * the same; `direction` is the unit vector of the largest, with its largest component positive. In
 * 2D the third row and column are not read. */
typedef struct gn_anisotropy {
    double degree, direction[3];
} gn_anisotropy;
gn_anisotropy gn_fabric_anisotropy(int dimension, const double fabric[9]);

#endif
