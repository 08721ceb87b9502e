#include "base/point.h"

#include "boundary/boundary.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "mesh/joints.h"
#include "particles/particles.h"
#include "solids/solids.h"

#include <math.h>
#include <stdio.h>

/* Returns the overlap, m, beyond which a sphere presses more than GN_PATCH_FACETS triangles: of
 * triangles with the area f = h^2/2 and the perimeter (2 + sqrt 2) h, a circle of radius c
 * intersects (pi c^2 + (2 + sqrt 2) h c)/f + 1 on average. */
static double full_overlap(double radius, double h) {
    const double pi = 3.14159265358979323846, perimeter = 2.0 + sqrt(2.0);
    const double area = 0.5 * (GN_PATCH_FACETS - 1);
    const double circle = (sqrt(perimeter * perimeter + 4.0 * pi * area) - perimeter) / (2.0 * pi);
    return 0.5 * circle * h * (circle * h / radius);
}

/* Finds the largest particle for which an overlap of a hundredth of its radius presses more facets
 * than its list can hold: the run would end at that overlap. */
static size_t doubt_facets(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, char *text, size_t size) {
    const double usual = 0.01;
    if (boundary->surface_count == ctx->scene.body_count) return 0;
    const gn_surface *s = &boundary->surfaces[ctx->scene.body_count];
    size_t largest = 0;
    const double *pos = dem->particles.pos;
    for (size_t p = 1; p < dem->particles.soa.count; p++)
        if (pos[4 * p + 3] > pos[4 * largest + 3]) largest = p;
    if (!dem->particles.soa.count || s->facets.corners != 3) return 0;
    const double radius = pos[4 * largest + 3], overlap = full_overlap(radius, s->facet_size);
    if (!gn_surface_patched(s, radius) || overlap > usual * radius) return 0;
    return (size_t)snprintf(
        text, size,
        "particle %d (radius %.4g m, %.3g times the mean size of facets) presses "
        "%d facets of the elements at once from an overlap of some %.2g m on, "
        "where the run ends: larger elements at the surface, or a smaller radius",
        (int)dem->particles.id[largest], radius, radius / s->facet_size, GN_PATCH_FACETS, overlap);
}

const char *gn_elements_doubts(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_solids *solids, char *text,
                               size_t size) {
    char place[GN_POINT_SIZE];
    *text = '\0';
    size_t used = doubt_facets(ctx, dem, boundary, text, size);
    for (size_t k = 0; k < solids->count; k++) {
        const gn_mesh_joints *j = &solids->elements[k]->joints;
        const char *name = solids->elements[k]->solid.name;
        if (j->together && used < size)
            used += (size_t)snprintf(
                text + used, size - used,
                "%s%s: two nodes at one place in %zu place%s, the first at %s m: elements are not "
                "joined there, as at a crack of no width",
                used ? "; " : "", name, j->together, j->together == 1 ? "" : "s",
                gn_point_text(ctx->scene.origin, j->together_at, place));
        if (j->hanging && used < size)
            used += (size_t)snprintf(
                text + used, size - used,
                "%s%s: %zu hanging node%s on sides of elements that do not have them, the first at "
                "%s m: elements are not joined there",
                used ? "; " : "", name, j->hanging, j->hanging == 1 ? "" : "s",
                gn_point_text(ctx->scene.origin, j->hanging_at, place));
    }
    return text;
}
