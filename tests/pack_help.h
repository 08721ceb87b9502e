/* Helpers of the tests of packings: scenes of one shape, mesh files, and common assertions. */
#ifndef GN_TESTS_PACK_HELP_H
#define GN_TESTS_PACK_HELP_H

#include "io_helpers.h"

#include "pack/quality.h"
#include "pack/shape.h"

/* A scene of that specimen; its files are in `folder`. */
__attribute__((format(printf, 3, 4))) static inline gn_scene
scene_in(const char *folder, int dimension, const char *specimen, ...) {
    char shape[2048], text[4096];
    va_list args;
    va_start(args, specimen);
    vsnprintf(shape, sizeof shape, specimen, args);
    va_end(args);
    snprintf(text, sizeof text,
             "dimension: %d\nspecimen:\n  %s\n"
             "materials: [{name: rock, density: 1, normal_stiffness: 1, kratio: 0},\n"
             "            {name: clay, density: 1, normal_stiffness: 1, kratio: 0}]\n"
             "law: {stiffness: uniform}\ntime: {end: 1}\nrun: {threads: 1}\n",
             dimension, shape);
    const gn_override material = {"specimen.material", "rock"};
    gn_scene scene;
    gneiss_error error = {0};
    if (gn_scene_parse(text, "scene.yaml", folder, &material, 1, &scene, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    return scene;
}

static inline gn_pack_result packed(const gn_scene *scene) {
    gn_pack_result result;
    ok(gn_pack_make(scene, NULL, NULL, &result, error));
    return result;
}

static inline bool same_bits(const gn_pack_result *a, const gn_pack_result *b) {
    return a->packing.count == b->packing.count &&
           memcmp(a->packing.sphere, b->packing.sphere, a->packing.count * 4 * sizeof(double)) == 0;
}

/* ---- files ---- */

static inline FILE *open_beside(const fixture *f, const char *name) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", f->dir, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    return file;
}

/* The first `triangles` of the 12 of a cube [0, side]^3. */
static inline void write_cube(const fixture *f, const char *name, double side, int triangles) {
    static const int face[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                    {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                    {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    FILE *out = open_beside(f, name);
    fprintf(out, "solid cube\n");
    for (int t = 0; t < triangles; t++) {
        fprintf(out, "facet normal 0 0 0\nouter loop\n");
        for (int k = 0; k < 3; k++) {
            int c = face[t][k];
            fprintf(out, "vertex %.17g %.17g %.17g\n", (c & 1) * side, (c >> 1 & 1) * side,
                    (c >> 2) * side);
        }
        fprintf(out, "endloop\nendfacet\n");
    }
    fprintf(out, "endsolid cube\n");
    fclose(out);
}

/* A square or cube [0, side]^d of `cells` a side, cut into triangles or tetrahedra; gmsh 2.2. */
static inline void write_mesh(const fixture *f, const char *name, int dimension, double side,
                              int cells) {
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    int n = cells + 1, layers = dimension == 3 ? n : 1, depth = dimension == 3 ? cells : 1;
    int stride[3] = {1, n, n * n}, parts = dimension == 3 ? 6 : 2, tag = 0;
    FILE *out = open_beside(f, name);
    fprintf(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", n * n * layers);
    for (int k = 0; k < n * n * layers; k++)
        fprintf(out, "%d %.17g %.17g %.17g\n", k + 1, side * (k % n) / cells,
                side * (k / n % n) / cells, side * (k / n / n) / cells);
    fprintf(out, "$EndNodes\n$Elements\n%d\n", parts * cells * cells * depth);
    for (int c = 0; c < cells * cells * depth; c++)
        for (int p = 0; p < parts; p++) {
            /* Kuhn's cut: from corner to corner along the axes in every order. */
            const int *axis = order[dimension == 3 ? p : 2 * p];
            int node = c % cells + n * (c / cells % cells) + n * n * (c / cells / cells);
            fprintf(out, "%d %d 2 1 1 %d", ++tag, dimension == 3 ? 4 : 2, node + 1);
            for (int a = 0; a < dimension; a++) fprintf(out, " %d", (node += stride[axis[a]]) + 1);
            fprintf(out, "\n");
        }
    fprintf(out, "$EndElements\n");
    fclose(out);
}

/* ---- required properties ---- */

/* All particles inside the body and, brute force, no two overlapping. */
static inline void check_whole(const gn_scene *scene, const gn_pack_result *r) {
    gn_pack_shape body;
    ok(gn_pack_shape_create(scene, &body, error));
    for (size_t i = 0; i < r->packing.count; i++) {
        const double *a = r->packing.sphere + 4 * i;
        assert_true(a[3] > 0 && isfinite(a[0] + a[1] + a[2] + a[3]));
        assert_true(scene->dimension == 3 || a[2] == 0);
        double depth = gn_domain_depth(body.domain, a);
        if (!(depth >= a[3] * (1 - 1e-9)))
            fail_msg("particle %zu at (%g, %g, %g): radius %g, depth %g", i, a[0], a[1], a[2], a[3],
                     depth);
        for (size_t j = 0; j < i; j++) {
            const double *b = r->packing.sphere + 4 * j;
            double d = sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
            if (!(d >= (a[3] + b[3]) * (1 - 1e-9)))
                fail_msg("particles %zu and %zu overlap by %g", i, j, 1 - d / (a[3] + b[3]));
        }
    }
    gn_pack_shape_free(&body);
}

static inline gn_pack_quality quality_of(const gn_scene *scene, const gn_pack_result *r) {
    gn_pack_shape body;
    gn_pack_quality q;
    ok(gn_pack_shape_create(scene, &body, error));
    ok(gn_pack_measure(&r->packing, (int)scene->dimension, body.domain, r->volume, 1, &q, error));
    gn_pack_shape_free(&body);
    return q;
}

#endif
