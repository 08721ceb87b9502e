/* Contact geometry of a particle and facets: triangles in space, segments in 2D.
 *
 * A facet's nearest point to the centre lies inside it, on an edge or at a corner. If facets share
 * that feature and one of them comes nearer, the point is no minimum of the distance to the surface
 * and no contact: a face suppresses its edges and corners, an edge its corners, so that nothing
 * counts twice (the hierarchy of Horner et al. 2001 and Santasusana et al. 2016, here by the
 * corners that facets share).
 *
 * Minima whose normals differ by less than GN_FACET_SHARE (shallow concave edges, overlapping
 * layers, plates) compress overlapping parts of the particle, and share its stiffness there. With
 * the unit normals m_i, the overlaps d_i and f_ij = f(angle of m_i, m_j) that falls from 1 for
 * equal normals to 0 at GN_FACET_SHARE, the lambda_i >= 0 satisfy d_i <= sum_j f_ij lambda_j, with
 * equality where lambda_i > 0, and the forces are k lambda_i. That is the maximum of d.lambda - 1/2
 * lambda.f lambda; k times it is a potential. f is C2-Wendland's (1 + 4 x)(1 - x)^4, which is
 * positive definite on the sphere (Gneiting 2013, Bernoulli 19, 1327, table 1), so that the lambda
 * are unique and continuous for any number of contacts: forces do not jump when contacts appear,
 * vanish or rotate. Of equal normals the deepest acts alone; steeper concave edges are two
 * contacts, like two walls. */
#ifndef GN_SURFACES_FACET_H
#define GN_SURFACES_FACET_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GN_FACET_TOUCHES = 96 }; /* largest number of contacts of a particle with a surface */
/* rad (34 degrees): angle of normals below which stiffness is shared */
static const double GN_FACET_SHARE = 0.6;

/* The nearest point of a facet. */
typedef struct gn_facet_near {
    double away[3];    /* m, from the centre to the point */
    double distance;   /* m */
    double weight[3];  /* weights of the corners in the interpolation of the point */
    double along[3];   /* m, vector along the edge that contains the point */
    int32_t corner[3]; /* indices of the vertices */
    unsigned feature;  /* bit k is set if corner k belongs to the feature that contains the point */
    size_t row;        /* for use by the caller */
} gn_facet_near;

/* A minimum that overlaps the particle. */
typedef struct gn_facet_contact {
    /* unit vector from the centre into the surface; the force on the particle has the opposite
     * direction */
    double n[3];
    double overlap; /* m, negative */
    double arm[3];  /* m, from the centre to the point of contact, on the surface */
    double part;    /* fraction of the surface's stiffness: lambda/d, 1 where nothing is shared */
    /* sum of f over all active minima, itself included; for a patch (patch.h) the sum of parts, at
     * least 1 */
    double crowd;
    int member; /* index among the minima */
} gn_facet_contact;

/* Finds the point of the facet with `corners` (2, 3) vertices at x that is nearest to `centre`;
 * sets all members but `corner` and `row`. */
void gn_facet_nearest(int corners, const double *const x[3], const double centre[3],
                      gn_facet_near *near);

/* Adds an item to the list, which keeps the nearest GN_FACET_TOUCHES. */
void gn_facet_add(gn_facet_near *list, size_t *count, const gn_facet_near *item);

/* Removes all but the minima and sorts them, nearest first; returns their number. */
size_t gn_facet_minima(gn_facet_near *list, size_t count);

/* Makes the contact of minimum k, without sharing. */
void gn_facet_single(const gn_facet_near *minima, size_t k, double radius, gn_facet_contact *out);

/* Finds the active minima of a particle, all of which overlap it, and their fractions of the
 * stiffness, the deepest first; returns their number, at most `count`. */
size_t gn_facet_contacts(const gn_facet_near *minima, size_t count, double radius,
                         gn_facet_contact *contacts);

typedef struct gn_facet_box {
    double lower[3], upper[3];
    /* range of `order` in a leaf; count 0: no leaf, the children are the next box and `right` */
    int32_t begin, count;
    int32_t right;
} gn_facet_box;

typedef struct gn_facet_tree {
    size_t boxes;
    gn_facet_box *box;
    int32_t *order; /* [facets] */
} gn_facet_tree;

/* The facets of a tree (borrowed). */
typedef struct gn_facet_set {
    int corners; /* number of corners of a facet: 2 for segments in the plane, 3 for triangles */
    size_t count;
    const int32_t *corner; /* [count][corners] */
    const double *pos;     /* [vertices][4] */
} gn_facet_set;

/* Sets the corners of a facet of the set, and its nearest point, as gn_facet_nearest does. */
void gn_facet_set_nearest(const gn_facet_set *set, int32_t facet, const double centre[3],
                          gn_facet_near *near);

gneiss_status gn_facet_tree_build(const gn_facet_set *set, gn_facet_tree *tree,
                                  gneiss_error *error);
/* Updates the boxes after vertices have moved. */
void gn_facet_tree_refit(const gn_facet_set *set, gn_facet_tree *tree);
void gn_facet_tree_free(gn_facet_tree *tree);

/* Finds the facets that are nearer to the centre than `reach`, in ascending order; with `found`
 * NULL only counts them. */
size_t gn_facet_tree_near(const gn_facet_tree *tree, const gn_facet_set *set,
                          const double centre[3], double reach, int32_t *found);

#endif
