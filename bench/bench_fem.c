#include "bench_fem.h"

#include "fem/fem.h"
#include "fem/structured.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct bench_fem {
    gn_fem_solid solid;
    double dt;
};

static gneiss_status make(bench_fem *f, int dimension, bench_fem_kind kind, int cells, int threads,
                          const char *isa, gneiss_error *error) {
    const gn_structured block = {.size = {1.0, 1.0, 1.0}, .cells = {cells, cells, cells}};
    const gn_fem_material rock = {NULL, 20e9, 0.2, 2650.0};
    const gn_fem_spec spec = {.name = "block",
                              .dimension = dimension,
                              .form = kind == BENCH_FEM_PRESSURE ? GN_FEM_PRESSURE
                                                                 : GN_FEM_DISPLACEMENT,
                              .single = kind == BENCH_FEM_SINGLE,
                              .materials = &rock,
                              .material_count = 1,
                              .gravity = {0.0, -9.81, 0.0},
                              .threads = threads,
                              .isa = isa};
    gn_mesh mesh;
    gn_fem_limit limit;
    GN_TRY(dimension == 3 ? gn_mesh_box(&block, &mesh, error)
                          : gn_mesh_rectangle(&block, &mesh, error));
    GN_TRY(gn_fem_solid_create(&spec, &mesh, &f->solid, error));
    gneiss_status status = gn_fem_bound(&f->solid, &limit, error);
    if (status != GNEISS_OK)
        gn_fem_solid_free(&f->solid);
    else
        f->dt = 0.9 * limit.bound;
    return status;
}

bench_fem *bench_fem_create(int dimension, bench_fem_kind kind, int cells, int threads,
                            const char *isa, char message[BENCH_MESSAGE_SIZE]) {
    gneiss_error error = {0};
    bench_fem *f = calloc(1, sizeof *f);
    if (f && make(f, dimension, kind, cells, threads, isa, &error) == GNEISS_OK) return f;
    snprintf(message, BENCH_MESSAGE_SIZE, "%s", f ? error.message : "no memory");
    free(f);
    return NULL;
}

void bench_fem_free(bench_fem *fem) {
    if (!fem) return;
    gn_fem_solid_free(&fem->solid);
    free(fem);
}

bool bench_fem_steps(bench_fem *fem, int steps, char message[BENCH_MESSAGE_SIZE]) {
    gneiss_error error = {0};
    for (int k = 0; k < steps; k++)
        if (gn_fem_step(&fem->solid, fem->dt, false, &error) != GNEISS_OK) {
            snprintf(message, BENCH_MESSAGE_SIZE, "%s", error.message);
            return false;
        }
    return true;
}

size_t bench_fem_elements(const bench_fem *fem) {
    return fem->solid.elements.soa.count;
}

size_t bench_fem_nodes(const bench_fem *fem) {
    return fem->solid.nodes.soa.count;
}

const char *bench_fem_isa(const bench_fem *fem) {
    return fem->solid.kernels->name;
}

size_t bench_fem_kernel(bench_fem *fem, size_t blocks) {
    const gn_fem_solid *b = &fem->solid;
    const gn_element_args args = {.pos = b->nodes.pos,
                                  .elements = &b->elements,
                                  .uniform = b->uniform,
                                  .partials = &b->partials,
                                  .travel = b->nodes.travel_f};
    size_t length = b->partials.length, count = b->elements.soa.count;
    if (blocks > b->partials.blocks) blocks = b->partials.blocks;
    for (size_t k = 0; k < blocks; k++) {
        gn_element_sums sums = GN_ELEMENT_SUMS_ZERO;
        size_t end = (k + 1) * length < count ? (k + 1) * length : count;
        b->element_kernel[0](&args, k * length, end, &sums);
    }
    return blocks * length < count ? blocks * length : count;
}

/* Operations by the kernel's source, a fused product as two. In space: edges 9, F 45, strain 33,
 * stress 16, F S 45, forces 54, sums 12; in the plane 4, 12, 11, 11, 12, 16, 6. Single precision
 * has 12 (6) more: two sums for every strain, and 1 added to the diagonal of H. */
void bench_fem_traffic(const bench_fem *fem, double *columns, double *rows, double *operations) {
    const gn_fem_solid *b = &fem->solid;
    const bool space = b->dimension == 3;
    const double nodes = b->dimension + 1, row = 4 * sizeof(double);
    const double real = b->single ? sizeof(float) : sizeof(double);
    double shared = (double)b->partials.first[b->partials.blocks] / (double)b->elements.soa.count;
    *columns =
        nodes * (sizeof(int32_t) + sizeof(uint16_t)) + real * (b->dimension * b->dimension + 1.0);
    *rows = shared * (2.0 * row + 4.0 * real); /* a node read, a partial sum cleared and written */
    *operations = space ? 214.0 : 72.0;
    if (b->single) *operations += space ? 12.0 : 6.0;
}
