/* Active contacts in files: intact bonds, and all touching particles, walls, bodies and finite
 * elements. */
#ifndef GN_RUN_OUTPUT_CONTACTS_H
#define GN_RUN_OUTPUT_CONTACTS_H

#include "run/output_fields.h"

typedef struct gn_output_contact {
    int32_t i, j; /* rows of particles in files, the smaller one first; j -1: not a particle */
    int32_t with, side;
    int32_t state;
    int32_t joint;    /* entry of joints that it crosses; -1: none */
    double force[3];  /* N, on i */
    double branch[3]; /* m, from the centre of i to that of j, or to the point of the force */
    double normal;    /* N, tension positive */
    double overlap;   /* m */
    double slip;      /* m, along a joint */
    double area;      /* m2, in 2D over 1 m of thickness */
} gn_output_contact;

typedef struct gn_output_contacts {
    gn_output_contact *row;
    size_t count, surfaces; /* the last `surfaces` of them are contacts with walls and surfaces */
} gn_output_contacts;

/* Writes DIR/NAME_<step>.hdf: lines between the centres, or to the points of the forces of walls
 * and surfaces. `points` holds the centres by row and nothing else. */
gneiss_status gn_output_contacts_snapshot(const gn_output_view *view, const char *directory,
                                          const char *name, const gn_snapshot *points,
                                          gneiss_error *error);
/* Writes the group /contacts. */
gneiss_status gn_output_contacts_put(const gn_output_view *view, gn_h5 *file, gneiss_error *error);

#endif
