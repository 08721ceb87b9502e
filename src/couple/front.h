/* Where elements turn into particles while a run goes on: which go, and what part of the body those
 * have that stay. The part at a node is alpha = min(1, d/width), d being its distance at the start
 * to the nearest node of an element that went: 0 along the front, 1 where no particle has a part.
 * It only falls, so that what has become particles stays so. Where alpha ends below 1, at a crest
 * without a neighbour that is higher, there is no room for a zone: what is there goes as well. */
#ifndef GN_COUPLE_FRONT_H
#define GN_COUPLE_FRONT_H

#include "fem/solid.h"
#include "scene/scene.h"

/* What an element may do. */
typedef enum gn_front_kind {
    GN_FRONT_FIXED,  /* no packing is ready for it */
    GN_FRONT_HELD,   /* may be of a zone, but stays: of a motion or a load */
    GN_FRONT_READY,  /* may go */
    GN_FRONT_LEAVING /* goes */
} gn_front_kind;

/* [elements] by place: prepared are those of which all nodes start in the box of the scene.
 * `driven` [nodes]: nodes of motions and loads. */
void gn_front_kinds(const gn_fem_solid *solid, const gn_convert_def *def, const uint8_t *driven,
                    uint8_t *kind);

/* Marks what goes with those that are marked as leaving, and sets the parts at the nodes. *stuck:
 * an element that would have to go, or be of a zone, and may not; -1: none. */
gneiss_status gn_front_advance(gn_fem_solid *solid, double width, uint8_t *kind, int64_t *stuck,
                               gneiss_error *error);

/* *room, m: how wide a zone may be at most so that one element can go without a part of the zone at
 * those that no packing is ready for; of the element with the most, or of one with `enough`.
 * INFINITY: packings are ready for all. */
gneiss_status gn_front_room(const gn_fem_solid *solid, const uint8_t *kind, double enough,
                            double *room, gneiss_error *error);

/* What part of the nearest limit a stress is, Pa, xx yy zz xy yz zx; 0 where its size alone says
 * that it is below all of them, or below `least` of them. */
double gn_front_excess(const gn_convert_def *def, const double s[6]);
double gn_front_excess_above(const gn_convert_def *def, const double s[6], double least);

#endif
