/* The surface over which a ball rolls, divided among the particles that it touches. */
#ifndef GN_MEMBRANE_ROLLING_BALL_H
#define GN_MEMBRANE_ROLLING_BALL_H

#include "base/error.h"
#include "neigh/neigh.h"
#include "soa/records.h"

/* Number of layers: distances from the ball's centre, over its radius, at which surfaces are found.
 * At 1 the surface touches the ball. */
enum { GN_ROLLED_LAYERS = 4 };
static const double gn_rolled_layer[GN_ROLLED_LAYERS] = {0.25, 0.75, 1.25, 1.75};

/* A ball that rolls about particles is bounded by the parts of their surfaces that it touches, by
 * rings where it touches two particles, and by caps of the ball where three particles hold it
 * (Connolly 1983, J. Appl. Cryst. 16, 548-558; in 2D by arcs). Together they form a closed surface.
 * Each particle gets the part that is nearest to it. For surfaces parallel to this one, areas are
 * polynomials of second degree in the distance, arms of third degree. */
typedef struct gn_rolled {
    const gn_particles *particles;
    int dimension;
    double ball;               /* m, radius of the ball */
    const gn_pair_list *pairs; /* all pairs with a gap below twice the ball's radius */
    /* [particles] per layer: area vector, m2, outward; 2D: 1 m thick */
    double (*area[GN_ROLLED_LAYERS])[3];
    /* [particles] per layer: trace of areas times arms from the centre, m3; the enclosed volume is
     * (sum of area x + arms) / dimension */
    double *arms[GN_ROLLED_LAYERS];
    double *cell; /* [particles] m3, volume of the cells of deep particles or, if these are too few,
                     of all that the ball does not touch; 0 for the others, and for some of them if
                     there are very many */
} gn_rolled;

/* Computes `area`, `arms` and `cell`, which must be 0. */
gneiss_status gn_rolled_find(const gn_rolled *rolled, gneiss_error *error);

#endif
