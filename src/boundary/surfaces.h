/* Contacts of particles with surfaces. */
#ifndef GN_BOUNDARY_SURFACES_H
#define GN_BOUNDARY_SURFACES_H

#include "base/error.h"
#include "boundary/surface.h"
#include "frame/parts.h"
#include "surfaces/facet.h"
#include "surfaces/patch.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Refuses a particle whose centre is on a surface, because it cannot be pushed off: at the start as
 * an error of the scene, later as a failure of the run. */
gneiss_status gn_surfaces_check_centres(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, gneiss_error *error);
/* Finds the contacts of the particle of row `begin` with the facets of one surface at the present
 * positions; returns the first row after them. `skin` 0: closed contacts. Otherwise: the minima of
 * the distance that are within `skin` of the particle, each as a separate contact; of a patch the
 * facets within that distance, with parts of the stiffness that add up to at least all of it. */
enum { GN_SURFACE_CONTACTS = GN_PATCH_FACETS };
typedef struct gn_surface_contact {
    const gn_surface *surface;
    size_t particle;
    gn_facet_contact contact;
    bool patch; /* see gn_surface_patched */
    int parts;  /* number of vertices of the facet, if they move independently */
    int32_t vertex[3];
    double weight[3];
} gn_surface_contact;
size_t gn_surface_contacts_at(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, size_t begin, double skin,
                              gn_surface_contact *contacts, size_t *count);
/* Finds the contacts of the next group of rows, from *row on, which is advanced beyond it; rows of
 * plane walls are skipped. Returns false after the last group. */
bool gn_surface_contacts_next(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, size_t *row, double skin,
                              gn_surface_contact *contacts, size_t *count);
/* Checks that the list of a particle can hold all facets that it can touch at the same time
 * (patch.h). */
gneiss_status gn_surfaces_check_patches(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, gneiss_error *error);
/* Returns the inverse mass, 1/kg, along a unit vector of a vertex that moves independently, without
 * its prescribed components. */
double gn_vertex_inverse_mass(const gn_surface *surface, int32_t vertex, const double n[3]);

/* gn_surface_yields tells whether particles can move a surface; the second function returns its
 * largest inverse mass, 1/kg. */
bool gn_surface_yields(const gn_boundary *boundary, const gn_surface *surface);

double gn_surface_give(const gn_boundary *boundary, const gn_surface *surface);

#endif
