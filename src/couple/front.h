/* The front of progressive conversion of elements into particles: which elements are converted, and
 * the weights of those that remain. The weight at a node is alpha = min(1, d/width), where d is its
 * initial distance to the nearest node of a converted element: 0 along the front, 1 where particles
 * have no weight. It only decreases, so that conversion is irreversible. At a crest, which is a
 * local maximum of alpha below 1, there is not enough room for a zone, and the elements there are
 * converted as well. */
#ifndef GN_COUPLE_FRONT_H
#define GN_COUPLE_FRONT_H

#include "fem/fem.h"
#include "scene/scene.h"

/* The state of an element with respect to conversion. */
typedef enum gn_front_kind {
    GN_FRONT_FIXED, /* outside of the prepared packing */
    /* may be part of a zone, but is never converted: its nodes have a motion or a load */
    GN_FRONT_HELD,
    GN_FRONT_READY,  /* may be converted */
    GN_FRONT_LEAVING /* is converted now */
} gn_front_kind;

/* Sets kind [elements], in the order of the record. Prepared elements have all nodes initially in
 * the box of the scene. `driven` [nodes] marks nodes of motions and loads. */
void gn_front_kinds(const gn_fem_solid *solid, const gn_convert_def *def, const uint8_t *driven,
                    uint8_t *kind);

/* Marks all elements that must be converted together with those marked as leaving, and sets the
 * weights at the nodes. *stuck: an element that would have to be converted, or to be part of a
 * zone, but may not; -1: none. */
gneiss_status gn_front_advance(gn_fem_solid *solid, double width, uint8_t *kind, int64_t *stuck,
                               gneiss_error *error);

/* Finds *room, m: the largest width of a zone at which one element can be converted without weights
 * at unprepared elements. It is that of the element with the largest room, or of the first element
 * with at least `enough`. INFINITY: packings are prepared for all elements. */
gneiss_status gn_front_room(const gn_fem_solid *solid, const uint8_t *kind, double enough,
                            double *room, gneiss_error *error);

/* Returns the ratio of a stress, Pa, xx yy zz xy yz zx, to the nearest limit; 0 if the norm of the
 * stress shows that the ratio is below `least`. */
double gn_front_excess(const gn_convert_def *def, const double s[6], double least);

#endif
