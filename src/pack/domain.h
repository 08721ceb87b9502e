/* The body that is to be filled: where its boundary is. */
#ifndef GN_PACK_DOMAIN_H
#define GN_PACK_DOMAIN_H

#include "base/error.h"
#include "mesh/mesh.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_domain gn_domain;

/* 2D bodies lie in the plane z = 0 with unit thickness. All lengths in m. */
gneiss_status gn_domain_rectangle(const double lower[2], const double upper[2], gn_domain **domain,
                                  gneiss_error *error);
gneiss_status gn_domain_disc(const double centre[2], double radius, gn_domain **domain,
                             gneiss_error *error);
/* Corners [count][2] in either sense. GNEISS_ERROR_INPUT: fewer than 3, two that coincide, edges
 * that cross or touch (which two, with their coordinates), no area. */
gneiss_status gn_domain_polygon(const double *corners, size_t count, gn_domain **domain,
                                gneiss_error *error);
gneiss_status gn_domain_box(const double lower[3], const double upper[3], gn_domain **domain,
                            gneiss_error *error);
/* Axis along z from `base`, the centre of the lower end. */
gneiss_status gn_domain_cylinder(const double base[3], double radius, double height,
                                 gn_domain **domain, gneiss_error *error);
/* A closed surface turned outward by gn_mesh_close_surface or gn_mesh_boundary (dimension 3: its
 * triangles; 2: its lines with the body on their left, holes allowed, z ignored). Copies what it
 * needs; `name` starts the messages. Triangles lower than 1e-7 of the extent are taken as lines.
 * GNEISS_ERROR_INPUT: not closed, not turned outward, no volume, or two triangles that share no
 * node cut each other by more than 1e-6 of the extent (lines: cross or touch): which, and where. */
gneiss_status gn_domain_surface(const gn_mesh *mesh, int dimension, const char *name,
                                gn_domain **domain, gneiss_error *error);
/* That facets [count][corners] (3 corners: triangles; 2: edges in the plane) do not cut each other,
 * as above, and nothing else: they need not be turned outward. node [node_count][3]. */
gneiss_status gn_domain_check_cuts(const double *node, size_t node_count, const int32_t *element,
                                   size_t count, int corners, const char *name,
                                   gneiss_error *error);
void gn_domain_free(gn_domain *domain);

int gn_domain_dimension(const gn_domain *domain);
/* m3; m2 in 2D. */
double gn_domain_volume(const gn_domain *domain);
void gn_domain_bounds(const gn_domain *domain, double lower[3], double upper[3]);

/* Distance to the boundary, positive inside. Thread-safe. */
double gn_domain_depth(const gn_domain *domain, const double x[3]);

enum { GN_DOMAIN_PLANES = 8 };

/* A tangent plane of the boundary: x is at `depth` from it along the unit normal, which points into
 * the body; a sphere round x of that radius touches the boundary there. */
typedef struct gn_domain_plane {
    double normal[3];
    double depth; /* m; negative outside */
} gn_domain_plane;

/* The boundary near x. For x inside: the local minima of its distance from x within `reach` that x
 * sees through the body (not what lies behind a slot), the nearest first, at most GN_DOMAIN_PLANES;
 * none when x is deeper than reach. A foot inside a facet gives the facet's normal; a foot on an
 * edge or corner counts only when no facet that meets there is nearer (a re-entrant edge, a notch
 * tip), and then the normal points from the foot to x. Planes that differ by less than 1e-3 in
 * direction and 1e-6 of the extent in depth count once, so that split faces do. The round side of a
 * cylinder or disc gives one tangent plane. For x outside, however far: the nearest boundary point
 * alone, with negative depth and the normal into the body. Returns their number. Thread-safe,
 * allocates nothing, and is a function of its arguments alone. */
int gn_domain_planes(const gn_domain *domain, const double x[3], double reach,
                     gn_domain_plane planes[GN_DOMAIN_PLANES]);

#endif
