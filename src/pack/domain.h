/* A body to be filled, given by its boundary. */
#ifndef GN_PACK_DOMAIN_H
#define GN_PACK_DOMAIN_H

#include "base/error.h"
#include "mesh/mesh.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_domain gn_domain;

/* Make bodies. Bodies in 2D lie in the plane z = 0 and have unit thickness. All lengths are in m.
 */
gneiss_status gn_domain_rectangle(const double lower[2], const double upper[2], gn_domain **domain,
                                  gneiss_error *error);
gneiss_status gn_domain_disc(const double centre[2], double radius, gn_domain **domain,
                             gneiss_error *error);
/* Makes a polygon from corners [count][2] of either orientation. GNEISS_ERROR_INPUT: fewer than 3
 * corners, coincident corners, edges that cross or touch (the message gives the two edges with
 * their coordinates), or no area. */
gneiss_status gn_domain_polygon(const double *corners, size_t count, gn_domain **domain,
                                gneiss_error *error);
gneiss_status gn_domain_box(const double lower[3], const double upper[3], gn_domain **domain,
                            gneiss_error *error);
/* Makes a cylinder with its axis along z from `base`, the centre of the lower end. */
gneiss_status gn_domain_cylinder(const double base[3], double radius, double height,
                                 gn_domain **domain, gneiss_error *error);
/* Makes a body from a closed surface that gn_mesh_close_surface or gn_mesh_boundary has oriented
 * outward (dimension 3: its triangles; 2: its lines, with the body on their left; holes are allowed
 * and z is ignored). The data are copied; `name` is the prefix of messages. Triangles with a height
 * below 1e-7 of the extent are treated as lines. GNEISS_ERROR_INPUT: the surface is not closed, is
 * not oriented outward, has no volume, or two triangles without a common node intersect by more
 * than 1e-6 of the extent (lines: cross or touch), with their positions. */
gneiss_status gn_domain_surface(const gn_mesh *mesh, int dimension, const char *name,
                                gn_domain **domain, gneiss_error *error);
/* Checks only that facets [count][corners] (3 corners: triangles; 2: edges in 2D) do not intersect,
 * as gn_domain_surface does; they need not be oriented outward. node [node_count][3]. */
gneiss_status gn_domain_check_cuts(const double *node, size_t node_count, const int32_t *element,
                                   size_t count, int corners, const char *name,
                                   gneiss_error *error);
void gn_domain_free(gn_domain *domain);

int gn_domain_dimension(const gn_domain *domain);
/* Returns the volume, m3; m2 in 2D. */
double gn_domain_volume(const gn_domain *domain);
void gn_domain_bounds(const gn_domain *domain, double lower[3], double upper[3]);

/* Returns the distance to the boundary, positive inside. Thread-safe. */
double gn_domain_depth(const gn_domain *domain, const double x[3]);

enum { GN_DOMAIN_PLANES = 8 };

/* A tangent plane of the boundary. x is at `depth` from the plane, along the unit normal, which
 * points into the body; a sphere of that radius about x touches the boundary there. */
typedef struct gn_domain_plane {
    double normal[3];
    double depth; /* m; negative outside */
} gn_domain_plane;

/* Finds the boundary near x. For x inside the body: the local minima of the distance of the
 * boundary from x that are within `reach` and visible from x through the body (not beyond a slot),
 * the nearest first, at most GN_DOMAIN_PLANES; none if x is deeper than `reach`. The foot of a
 * minimum inside a facet gives the facet's normal. A foot on an edge or corner counts only if no
 * adjacent facet is nearer (a re-entrant edge, a notch tip); the normal then points from the foot
 * to x. Planes that differ by less than 1e-3 in direction and by less than 1e-6 of the extent in
 * depth count once, so that divided faces count once. The round side of a cylinder or disc gives
 * one tangent plane. For x outside, at any distance: the nearest boundary point alone, with
 * negative depth and the normal into the body. Returns the number of planes. Thread-safe: it
 * allocates nothing and depends on its arguments alone. */
int gn_domain_planes(const gn_domain *domain, const double x[3], double reach,
                     gn_domain_plane planes[GN_DOMAIN_PLANES]);

#endif
