/* Bodies of finite elements with a static reference (references/fem.json), relaxed to rest by the
 * explicit code. Used by the program fem_static and by tests/test_fem_reference.c. */
#ifndef GN_VALIDATE_FEM_CASES_H
#define GN_VALIDATE_FEM_CASES_H

#include "fem/fem.h"

typedef struct fem_case_spec {
    const char *name;     /* cook, block */
    const char *material; /* compressible, incompressible */
    gn_fem_form form;
    int cells;    /* cells per side; the height of the block has half as many; a multiple of 6 for
                     pressures of the block */
    bool slanted; /* diagonals all in one direction, not alternating */
    int threads;  /* 0: one */
} fem_case_spec;

enum { FEM_CASE_READINGS = 6 };

/* A case under a small part of its load (strains of about 1e-6, at which the total Lagrangian law
 * is linear). Displacements are scaled to the full load. */
typedef struct fem_case {
    gn_fem_solid body;
    double scale; /* part of the full load that is applied */
    int64_t steps;
    double unrest; /* square root of (v M v)/(u f): about the relative error of u that remains after
                      the relaxation */
    int count;
    const char *reading[FEM_CASE_READINGS]; /* names as in references/fem.json */
    double value[FEM_CASE_READINGS];
} fem_case;

/* GNEISS_ERROR_INPUT for an unknown case, material or number of cells. */
gneiss_status fem_case_create(const fem_case_spec *spec, fem_case *c, gneiss_error *error);
/* Takes steps until `unrest` stays below `tolerance`, then reads the results. The viscous damping
 * follows Rayleigh's quotient of the displacement, w^2 = u f/(u M u), at 2 w (Underwood 1983, in
 * Belytschko and Hughes, Computational methods for transient analysis, sec. 5).
 * GNEISS_ERROR_UNSTABLE if the body is not at rest after `most` steps. */
gneiss_status fem_case_relax(fem_case *c, double tolerance, int64_t most, gneiss_error *error);
/* Returns the displacement under the full load at a node, by its index in the body. */
void fem_case_displacement(const fem_case *c, size_t node, double u[3]);
/* Computes the pressure (Pa, compression positive) under the full load per element, by index:
 * gn_alloc'ed. */
gneiss_status fem_case_pressure(const fem_case *c, double **pressure, gneiss_error *error);
void fem_case_free(fem_case *c);

#endif
