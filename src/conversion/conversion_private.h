/* Declarations that the files of the conversion share. */
#ifndef GN_CONVERSION_CONVERSION_PRIVATE_H
#define GN_CONVERSION_CONVERSION_PRIVATE_H

#include "base/error.h"
#include "conversion/conversion.h"
#include "conversion/records.h"
#include "fem/fem.h"
#include "frame/parts.h"
#include "particles/dormant.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* State before a conversion, and scratch. */
typedef struct gn_conversion {
    const gn_convertible *model;
    uint8_t *kind;  /* [elements before] gn_front_kind */
    int32_t *place; /* [elements of the mesh] index before the conversion; -1: converted earlier */
    double *part;   /* [particles][2] weights before, 0 if it was dormant */
    double *node_part; /* [nodes][2] weights and distances before (couple/front.h) */
    uint8_t *freed;    /* [particles] 1: it moves independently from this conversion on */
    uint8_t *touched;  /* [elements before] 1: it converts or its weight changes */
    int32_t *some;     /* [elements before] temporary list of elements */
    uint8_t *active;   /* [prepared bonds] 1: it acts from now on */
    size_t acting;     /* number of these bonds */
    uint8_t *tied;     /* [particles] 1: it followed nodes at the last tally */
    uint8_t *reached;  /* [nodes] scratch */
    bool dry_run;      /* the conversion is only tested, and all is restored */
    int rings;         /* rings of neighbours that convert with the marked elements */
    double *rate; /* [particles][3] m/s2, acceleration of particles in `freed` by their elements */
    double released[2]; /* J, energy of changed contacts, before and after relaxation */
} gn_conversion;

/* Returns the element (index before the conversion) that contains a particle; -1: converted
 * earlier. */
static inline int32_t gn_home_of(const gn_conversion *conversion, size_t p) {
    return conversion->place[gn_dormant_element(conversion->model->dem, p)];
}

/* Scales the present contacts to their new weight and adds the bonds of activated particles, with
 * the forces that the strain of the elements causes (conversion_contacts.c). Must precede the
 * removal of elements. */
gneiss_status gn_conversion_activate_bonds(const gn_conversion *conversion, gneiss_error *error);

/* Computes the relative velocity of the ends of a contact at the contact point, along and across n,
 * m/s. */
void gn_contact_rate(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j,
                     double length, const double n[3], double rate[3]);

/* Computes the force of a contact's springs on its first particle at the instant, N, in the sense
 * of leap-frog, and the distance of the centres, m. Returns the force component along n, which
 * points from the first to the second particle (conversion_energy.c). */
double gn_contact_held(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c, double n[3], double *length, double force[3]);

/* Computes the accelerations of the particles that will be released, before anything changes
 * (conversion_relaxation.c). */
gneiss_status gn_conversion_find_rates(const gn_conversion *conversion, gneiss_error *error);
/* Relaxes the released particles after the lists were rebuilt (conversion_relaxation.c). */
gneiss_status gn_conversion_relax(const gn_conversion *conversion, gneiss_error *error);

/* J: energy of elements and springs at the instant, springs of walls included. `step`: half a step
 * of the power of their forces; the sum is the quantity that leap-frog conserves. */
typedef struct gn_held {
    double elements, contacts, step;
} gn_held;
static inline double gn_held_sum(const gn_held *held) {
    return held->elements + held->contacts + held->step;
}
/* Returns the energy of everything that the conversion changes, J (conversion_energy.c). Weights
 * and `freed` must be known. */
gn_held gn_conversion_held(const gn_conversion *conversion);
double gn_conversion_held_in_contacts(const gn_conversion *conversion);
/* Returns the energy of everything that the conversion does not change, J. */
double gn_conversion_held_beside(const gn_conversion *conversion);

/* Computes the energy, J, of the weight that particles take over: that of the elements, and that of
 * the springs in their place if these moved with the strains of the elements (conversion_energy.c).
 * Weights must be known, and elements not removed yet. */
void gn_conversion_find_alike(const gn_conversion *conversion, double alike[2]);
/* Energies before and during a conversion, from which it is booked by cause. */
typedef struct gn_held_stages {
    double alike[2], released[2];
    gn_held before, after;
} gn_held_stages;
void gn_conversion_book(gn_conversions *converted, gn_ledger *ledger, const gn_held_stages *held,
                        double kinetic);

/* End the run with the model unchanged (conversion_halt.c): gn_conversion_halt_at at an element
 * that would have to convert or to join a zone, but may not; the second function where particles
 * cannot take the mass. */
void gn_conversion_halt_at(const gn_conversion *conversion, int64_t element);
void gn_conversion_halt_without_mass(const gn_conversion *conversion, const double missing[2]);
/* Sets *found if a node of elements that may not convert would be left with less than r/width of
 * the mass of these elements at full weight: almost nothing would support it. This occurs with
 * elements that are smaller than particles and contain none. Halts at the lightest such node.
 * Weights must be known. */
gneiss_status gn_conversion_find_light_nodes(const gn_conversion *conversion, bool *found,
                                             gneiss_error *error);
/* Computes the centre of an element at the start, m. */
void gn_conversion_centre(const gn_fem_solid *solid, size_t e, double centre[3]);

/* Largest change of a mass that counts as within the scatter of the packing. */
#define GN_MASS_SCALED_MOST 0.5
/* Tells whether particles can compensate for the change of the body's mass. `missing`, kg: that
 * change, and the mass of the particles. Weights must be known. */
bool gn_conversion_fits(const gn_conversion *conversion, double missing[2]);
/* Marks the neighbours of the converting elements that may convert as well; returns false if there
 * are none. */
bool gn_conversion_add_ring(const gn_conversion *conversion);

/* Mass, momentum and moments of both, summed over the nodes and free particles of the model
 * (conversion_masses.c). */
typedef struct gn_tally {
    double mass, moment[3], momentum[3]; /* kg, kg m, kg m/s */
    double turning[3];                   /* kg m2/s, angular momentum, spins included */
    double second[6]; /* kg m2, second moments xx yy zz xy yz zx, spins included, which determine
                         the moments of inertia; in 2D only that about z */
    double energy;    /* J, kinetic */
} gn_tally;
gn_tally gn_conversion_tally(const gn_conversion *conversion);
gn_tally gn_tally_less(const gn_tally *now, const gn_tally *before);
/* Returns the tally with moments, second moments and angular momentum about another point, m. */
gn_tally gn_tally_about(const gn_tally *of, size_t dimension, const double x[3]);

/* Multiplies the masses of particles whose weight changes by a function of position, so that mass,
 * centre of mass and inertia are those of `before`; then changes velocities, so that momentum and
 * angular momentum are. */
gneiss_status gn_conversion_keep_invariants(const gn_conversion *conversion, const gn_tally *before,
                                            gneiss_error *error);

/* Selection of the particles whose masses are scaled: those whose weight changes; or those of a
 * zone if the former are too few, as at an element at the edge that contains no particle. */
typedef enum gn_scaled { GN_SCALED_CHANGED, GN_SCALED_TIED } gn_scaled;
bool gn_conversion_scales(const gn_conversion *conversion, gn_scaled scaled, size_t particle);

/* Solves m x = f in place, for a symmetric positive definite m [n][n]; returns false if m is
 * numerically singular. */
enum { GN_BASIS_MOST = 10 };
bool gn_solve_positive(size_t n, double m[GN_BASIS_MOST][GN_BASIS_MOST], double *f);

/* Restores momentum by changes of velocities (conversion_momentum.c) after masses were scaled. */
void gn_conversion_keep_momentum(const gn_conversion *conversion, const gn_tally *before,
                                 gn_scaled scaled);

/* Adds up the changes of angular momentum, centre of mass and inertia that remain after a
 * conversion. To be called when the conversion is complete. */
void gn_conversion_note_jumps(const gn_conversion *conversion, const gn_tally *before,
                              const gn_tally *now);

/* Finds the elements that contain the position of a tie: one, or those that share the face, edge or
 * node on which it lies, at most GN_AROUND_MOST. Gradients are discontinuous there; with a mean
 * over these elements, results do not depend on their order and are symmetric under reflection. */
enum { GN_AROUND_MOST = 64 };
size_t gn_conversion_around(const gn_fem_solid *solid, const gn_tie *tie,
                            int32_t element[GN_AROUND_MOST]);

gneiss_status gn_conversion_no_memory(gneiss_error *error);

#endif
