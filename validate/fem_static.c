/* fem_static CASE MATERIAL FORM CELLS[s] [THREADS [FIELDS]]: computes one case of
 * references/fem.json by relaxation with the explicit code; JSON on stdout. CELLS with an s: all
 * diagonals in one direction. FIELDS: a file for rows of nodes (x y z ux uy uz) and elements
 * (nodes, pressure). */
#include "fem_cases.h"

#include "base/memory.h"
#include "base/timer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gneiss_status write_fields(const fem_case *c, const char *path, gneiss_error *error) {
    double *pressure, u[3];
    GN_TRY(fem_case_pressure(c, &pressure, error));
    FILE *f = fopen(path, "w");
    if (!f) {
        gn_free(pressure);
        return gn_fail(error, GNEISS_ERROR_IO, "%s: expected a file that can be written", path);
    }
    const gn_elements *q = &c->body.elements;
    fprintf(f, "%zu %zu\n", c->body.nodes.soa.count, q->soa.count);
    for (size_t n = 0; n < c->body.nodes.soa.count; n++) {
        const double *x = c->body.nodes.start + 4 * n;
        fem_case_displacement(c, n, u);
        fprintf(f, "%.17g %.17g %.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], u[0], u[1], u[2]);
    }
    for (size_t e = 0; e < q->soa.count; e++) {
        for (int a = 0; a <= c->body.dimension; a++) fprintf(f, "%d ", gn_elements_node(q, a)[e]);
        fprintf(f, "%.17g\n", pressure[e]);
    }
    gn_free(pressure);
    if (fclose(f) == 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: expected room for the fields", path);
}

static gneiss_status run(const fem_case_spec *spec, const char *fields, gneiss_error *error) {
    const double begin = gn_now();
    fem_case c;
    GN_TRY(fem_case_create(spec, &c, error));
    gneiss_status status = fem_case_relax(&c, 1e-5, 20000000, error);
    if (status == GNEISS_OK && fields) status = write_fields(&c, fields, error);
    if (status == GNEISS_OK) {
        printf("{\"cells\": %d, \"elements\": %zu, \"nodes\": %zu, \"steps\": %lld, \"unrest\": "
               "%.3g, \"seconds\": %.3g, "
               "\"readings\": {",
               spec->cells, c.body.elements.soa.count, c.body.nodes.soa.count, (long long)c.steps,
               c.unrest, gn_now() - begin);
        for (int k = 0; k < c.count; k++)
            printf("%s\"%s\": %.12g", k ? ", " : "", c.reading[k], c.value[k]);
        printf("}}\n");
    }
    fem_case_free(&c);
    return status;
}

int main(int count, char **argument) {
    if (count < 5 || count > 7 ||
        (strcmp(argument[3], "displacement") && strcmp(argument[3], "mixed"))) {
        fprintf(stderr, "usage: fem_static cook|block compressible|incompressible "
                        "displacement|mixed CELLS [THREADS "
                        "[FIELDS]]\n");
        return 2;
    }
    const fem_case_spec spec = {.name = argument[1],
                                .material = argument[2],
                                .form = strcmp(argument[3], "mixed") ? GN_FEM_DISPLACEMENT
                                                                     : GN_FEM_PRESSURE,
                                .cells = atoi(argument[4]),
                                .slanted = strchr(argument[4], 's') != NULL,
                                .threads = count > 5 ? atoi(argument[5]) : 1};
    gneiss_error error = {0};
    gneiss_status status = run(&spec, count > 6 ? argument[6] : NULL, &error);
    if (status != GNEISS_OK) fprintf(stderr, "fem_static: %s\n", error.message);
    return status == GNEISS_OK ? 0 : 1;
}
