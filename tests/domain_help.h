/* Helpers of the tests of bodies. */
#ifndef GN_TESTS_DOMAIN_HELP_H
#define GN_TESTS_DOMAIN_HELP_H

#include "test.h"

#include "base/random.h"
#include "pack/domain.h"

#include <stdbool.h>

static gneiss_error failure;

static inline void make_ok(gneiss_status status) {
    if (status != GNEISS_OK) fail_msg("%s", failure.message);
}

static inline double uniform(uint64_t seed, uint64_t index, double lower, double upper) {
    return lower + (upper - lower) * 0.5 * (gn_random_symmetric(seed, index) + 1);
}

/* Checks that there is one plane: normal to 1e-12, depth to 1e-12 m. */
static inline void assert_plane(const gn_domain_plane *p, double nx, double ny, double nz,
                                double depth) {
    double n[3] = {nx, ny, nz};
    for (int k = 0; k < 3; k++) assert_true(fabs(p->normal[k] - n[k]) <= 1e-12);
    assert_true(fabs(p->depth - depth) <= 1e-12);
}

/* Meshes by hand. */

typedef struct builder {
    gn_mesh mesh;
    size_t node_room, element_room;
} builder;

static inline int32_t add_node(builder *b, double x, double y, double z) {
    if (b->mesh.node_count == b->node_room) {
        b->node_room = 2 * b->node_room + 64;
        b->mesh.node = realloc(b->mesh.node, b->node_room * 3 * sizeof(double));
    }
    double *at = b->mesh.node + 3 * b->mesh.node_count;
    at[0] = x, at[1] = y, at[2] = z;
    return (int32_t)b->mesh.node_count++;
}

static inline void add_triangle(builder *b, int32_t i, int32_t j, int32_t k) {
    gn_mesh_elements *e = &b->mesh.triangles;
    if (e->count == b->element_room) {
        b->element_room = 2 * b->element_room + 64;
        e->node = realloc(e->node, b->element_room * 3 * sizeof(int32_t));
    }
    int32_t *node = e->node + 3 * e->count++;
    node[0] = i, node[1] = j, node[2] = k;
    e->nodes = 3;
}

static inline void drop(builder *b) {
    free(b->mesh.node);
    free(b->mesh.triangles.node);
    *b = (builder){0};
}

static inline gn_domain *surface(builder *b) {
    gn_domain *d = NULL;
    make_ok(gn_domain_surface(&b->mesh, 3, "surface", &d, &failure));
    drop(b);
    return d;
}

#endif
