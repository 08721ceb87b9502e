/* The volume of a surface that cuts itself is not what it encloses: what parts have in common would
 * be weighed twice. */
#include "boundary/self_intersection.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "pack/domain.h"
#include "scene/scene.h"
#include "surfaces/body_shape.h"

#include <stdio.h>
#include <string.h>

/* A polygon may name a point again behind itself, as where it closes: one node. */
static void join_repeated(const gn_body_shape *shape, const double *node, int32_t *corner) {
    for (size_t f = 0; f < shape->facets; f++) {
        const size_t next = f + 1 < shape->facets ? f + 1 : 0;
        const int32_t end = corner[2 * f + 1], start = corner[2 * next];
        const double *a = node + 3 * (size_t)end, *b = node + 3 * (size_t)start;
        if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) corner[2 * f + 1] = start;
    }
}

gneiss_status gn_body_check_cuts(const gn_scene *s, size_t index, const gn_body_shape *shape,
                                 gneiss_error *error) {
    const size_t corners = (size_t)s->dimension, count = corners * shape->facets;
    const gn_body_def *def = &s->bodies[index];
    const double *o = s->origin;
    char path[32], place[GN_POINT_SIZE], from[GN_POINT_SIZE + 40] = "";
    if (!gn_body_mass_is_from_surface(def)) return GNEISS_OK;
    double *node = gn_alloc_array(shape->vertices + 1, 3 * sizeof *node);
    int32_t *corner = gn_alloc_array(count + 1, sizeof *corner);
    gneiss_status status = node && corner ? GNEISS_OK
                                          : gn_fail(error, GNEISS_ERROR_MEMORY,
                                                    "no memory for %zu facets", shape->facets);
    for (size_t v = 0; status == GNEISS_OK && v < shape->vertices; v++)
        memcpy(node + 3 * v, shape->vertex + 4 * v, 3 * sizeof *node);
    if (status == GNEISS_OK) {
        memcpy(corner, shape->corner, count * sizeof *corner);
        if (corners == 2) join_repeated(shape, node, corner);
        status = gn_domain_check_cuts(node, shape->vertices, corner, shape->facets, (int)corners,
                                      corners == 2 ? "polygon" : "surface", error);
    }
    gn_free(node);
    gn_free(corner);
    if (status != GNEISS_ERROR_INPUT || !error) return status;
    snprintf(path, sizeof path, "bodies[%zu]", index);
    if (o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0)
        snprintf(from, sizeof from, "(places are from the origin %s m) ",
                 gn_point_text(o, (const double[3]){0, 0, 0}, place));
    char said[GNEISS_MESSAGE_SIZE];
    memcpy(said, error->message, sizeof said);
    return gn_fail(error, status,
                   "%s (%s): %s%.1200s: the mass of a free body is that of what it encloses, and "
                   "what parts have in common would count twice; unite the parts, or give mass, "
                   "inertia and reference",
                   gn_scene_at(s, def->where, path).text, def->name, from, said);
}

size_t gn_body_cavities(const gn_scene *s, size_t index) {
    gn_body_shape shape;
    if (!s->bodies[index].surface[0] || !gn_body_mass_is_from_surface(&s->bodies[index])) return 0;
    if (gn_body_shape_make(s, index, &shape, NULL) != GNEISS_OK) return 0;
    const size_t cavities = shape.cavities;
    gn_body_shape_free(&shape);
    return cavities;
}
