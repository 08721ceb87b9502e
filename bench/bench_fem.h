/* A block of finite elements for the benches. The header serves C and C++, as bench_world.h. */
#ifndef GN_BENCH_FEM_H
#define GN_BENCH_FEM_H

#include "bench_world.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_fem bench_fem;

/* The displacement form in double and with forces in single precision, and the pressure form. */
typedef enum bench_fem_kind {
    BENCH_FEM_DOUBLE,
    BENCH_FEM_SINGLE,
    BENCH_FEM_PRESSURE
} bench_fem_kind;

/* Creates a square (dimension 2) or cube of side 1 m with `cells` per side, 2 triangles or 5
 * tetrahedra per cell, under gravity; `isa` as bench_world_use. NULL with a message on failure. */
bench_fem *bench_fem_create(int dimension, bench_fem_kind kind, int cells, int threads,
                            const char *isa, char message[BENCH_MESSAGE_SIZE]);
void bench_fem_free(bench_fem *fem);

/* Takes `steps` steps at 0.9 of the rigorous bound; every 64th step measures energies. */
bool bench_fem_steps(bench_fem *fem, int steps, char message[BENCH_MESSAGE_SIZE]);

size_t bench_fem_elements(const bench_fem *fem);
size_t bench_fem_nodes(const bench_fem *fem);
const char *bench_fem_isa(const bench_fem *fem);

/* Runs the element kernel of the displacement form over the first `blocks` blocks, or all if there
 * are fewer; returns the number of elements. */
size_t bench_fem_kernel(bench_fem *fem, size_t blocks);

/* Computes per element the bytes of columns and of rows (nodes read, partial sums read and written)
 * that the kernel moves, and its additions and multiplications. Rows are shared between elements as
 * in the blocks. */
void bench_fem_traffic(const bench_fem *fem, double *columns, double *rows, double *operations);

#ifdef __cplusplus
}
#endif

#endif
