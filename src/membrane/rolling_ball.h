/* The surface over which a ball rolls, divided among the particles that it touches. */
#ifndef GN_MEMBRANE_ROLLING_BALL_H
#define GN_MEMBRANE_ROLLING_BALL_H

#include "base/error.h"
#include "neigh/neigh.h"
#include "soa/records.h"

/* Distances from the ball's centre, over its radius, at which surfaces are found: at 1 it touches.
 */
enum { GN_ROLLED_LAYERS = 4 };
static const double gn_rolled_layer[GN_ROLLED_LAYERS] = {0.25, 0.75, 1.25, 1.75};

/* A ball that rolls about particles is bounded by the touched parts of their surfaces, by rings
 * where it touches two, and by caps of its own where it is held by three (Connolly 1983, J. Appl.
 * Cryst. 16, 548-558; in 2D by arcs): together a closed surface. Each particle gets the part that
 * is nearest to it. For parallel surfaces areas and arms are polynomials of second and third degree
 * in the distance. */
typedef struct gn_rolled {
    const gn_particles *particles;
    int dimension;
    double ball;               /* m, radius of the ball */
    const gn_pair_list *pairs; /* all pairs with a gap below twice the ball's radius */
    /* [particles] of each layer: m2 outward, as a vector; 2D: 1 m thick */
    double (*area[GN_ROLLED_LAYERS])[3];
    /* [particles] m3, trace of areas times arms from the centre; the enclosed volume is (sum of
     * area x + arms) / dimension */
    double *arms[GN_ROLLED_LAYERS];
    double *cell; /* [particles] m3, volume of the cells of deep particles or, if these are too few,
                     of particles that the ball does not touch; 0 for all others, and for some if
                     there are very many */
} gn_rolled;

/* Sets `area`, `arms` and `cell`, which are 0. */
gneiss_status gn_rolled_find(const gn_rolled *rolled, gneiss_error *error);

#endif
