/* Bodies of finite elements with a static reference (references/fem.json), relaxed to rest by the
 * explicit code. Used by the program fem_static and by tests/test_fem_reference.c. */
#ifndef GN_VALIDATE_FEM_CASES_H
#define GN_VALIDATE_FEM_CASES_H

#include "fem/solid.h"

typedef struct fem_case_spec {
    const char *name;     /* cook, block */
    const char *material; /* compressible, incompressible */
    gn_fem_form form;
    int cells;    /* per side; those of the block's height are half as many; a multiple of 6 for
                     pressures of the block */
    bool slanted; /* diagonals all one way, not like the colours of a chess-board */
    int threads;  /* 0: one */
} fem_case_spec;

enum { FEM_CASE_READINGS = 6 };

/* Displacements are of the full load: what was computed under a small part of it (strains of about
 * 1e-6, where the total Lagrangian law is linear) times its inverse. */
typedef struct fem_case {
    gn_fem_solid body;
    double scale; /* part of the full load that is applied */
    int64_t steps;
    double unrest; /* square root of (v M v)/(u f): about the relative error of u that is left of
                      the relaxation */
    int count;
    const char *reading[FEM_CASE_READINGS]; /* as in references/fem.json */
    double value[FEM_CASE_READINGS];
} fem_case;

/* GNEISS_ERROR_INPUT for a case, material or number of cells that there is not. */
gneiss_status fem_case_create(const fem_case_spec *spec, fem_case *c, gneiss_error *error);
/* Steps until `unrest` stays below `tolerance`, then reads. The viscous damping follows Rayleigh's
 * quotient of the displacement, w^2 = u f/(u M u), at 2 w (Underwood 1983, in Belytschko and
 * Hughes, Computational methods for transient analysis, sec. 5). GNEISS_ERROR_UNSTABLE when it does
 * not come to rest in `most` steps. */
gneiss_status fem_case_relax(fem_case *c, double tolerance, int64_t most, gneiss_error *error);
/* Displacement of the full load at a node, by its place in the body. */
void fem_case_displacement(const fem_case *c, size_t node, double u[3]);
/* Pa, compression positive, of the full load, per element by place: gn_alloc'ed. */
gneiss_status fem_case_pressure(const fem_case *c, double **pressure, gneiss_error *error);
void fem_case_free(fem_case *c);

#endif
