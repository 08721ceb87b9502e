/* Surfaces: from the frames of bodies to space and back, and which facets are near which particle.
 */
#include "boundary/surface_lists.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "frame/step_context.h"
#include "particles/dem.h"
#include "soa/particle_state.h"
#include "solids/elements.h"
#include "surfaces/facet_tree.h"

#include <math.h>
#include <string.h>

/* --- frames --- */

void gn_rigid_direct(const gn_rigid *b, const double local[3], double direction[3]) {
    for (int a = 0; a < 3; a++) direction[a] = gn_dot3(b->axes + 3 * a, local);
}

void gn_rigid_place(const gn_rigid *b, const double local[3], double point[3]) {
    gn_rigid_direct(b, local, point);
    for (int a = 0; a < 3; a++) point[a] += b->position[a];
}

void gn_rigid_local(const gn_rigid *b, const double direction[3], double local[3]) {
    for (int a = 0; a < 3; a++)
        local[a] = b->axes[a] * direction[0] + b->axes[3 + a] * direction[1] +
                   b->axes[6 + a] * direction[2];
}

void gn_surface_centre(const gn_dem *dem, const gn_boundary *boundary, const gn_surface *s,
                       size_t p, double centre[3]) {
    const double *x = dem->particles.pos + 4 * p;
    const gn_rigid *b = s->body >= 0 ? &boundary->bodies[s->body] : NULL;
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = b ? x[a] - b->position[a] : x[a];
    if (b)
        gn_rigid_local(b, d, centre);
    else
        memcpy(centre, d, sizeof d);
}

/* --- lists --- */

size_t gn_surfaces_near(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t p, int32_t *found) {
    size_t count = 0;
    if (!gn_particle_is_active(&dem->particles, p)) return 0;
    for (size_t k = 0; k < boundary->surface_count; k++) {
        const gn_surface *s = &boundary->surfaces[k];
        double centre[3], reach = dem->particles.pos[4 * p + 3] + dem->verlet.skin;
        gn_surface_centre(dem, boundary, s, p, centre);
        int32_t *mine = found ? found + count : NULL;
        size_t more = gn_facet_tree_near(&s->tree, &s->facets, centre, reach, mine);
        for (size_t c = 0; mine && c < more; c++)
            mine[c] += (int32_t)ctx->scene.wall_count + s->first;
        count += more;
    }
    return count;
}

void gn_surfaces_refer(gn_boundary *boundary) {
    for (size_t k = 0; k < boundary->surface_count; k++) {
        gn_surface *s = &boundary->surfaces[k];
        if (s->body >= 0) {
            gn_rigid *b = &boundary->bodies[s->body];
            b->travel = 0.0;
            memcpy(b->ref_position, b->position, sizeof b->position);
            memcpy(b->ref_axes, b->axes, sizeof b->axes);
        } else {
            gn_facet_tree_refit(&s->facets, &s->tree);
            gn_element_contact_refer(s->elements);
        }
    }
}

/* |R X - R' X| <= 2 sin(angle/2) |X|, and the Frobenius norm of R - R' is 2 sqrt(2) sin(angle/2).
 */
static double body_travel(const gn_rigid *b) {
    double d2 = 0.0, f2 = 0.0;
    for (int a = 0; a < 3; a++)
        d2 += (b->position[a] - b->ref_position[a]) * (b->position[a] - b->ref_position[a]);
    for (int a = 0; a < 9; a++) f2 += (b->axes[a] - b->ref_axes[a]) * (b->axes[a] - b->ref_axes[a]);
    return sqrt(d2) + sqrt(0.5 * f2) * b->reach;
}

double gn_surfaces_travel(gn_boundary *boundary, bool exact) {
    double most = 0.0;
    for (size_t k = 0; k < boundary->surface_count; k++) {
        gn_surface *s = &boundary->surfaces[k];
        gn_rigid *b = s->body >= 0 ? &boundary->bodies[s->body] : NULL;
        if (b && exact) b->travel = body_travel(b);
        most = fmax(most, b ? b->travel : gn_element_contact_travel(s->elements, exact));
    }
    return most;
}

size_t gn_surface_of_facet(const gn_boundary *boundary, int32_t facet) {
    size_t k = 0;
    while (k + 1 < boundary->surface_count && facet >= boundary->surfaces[k + 1].first) k++;
    return k;
}

const gn_surface *gn_surface_of_row(const gn_step_context *ctx, const gn_boundary *boundary,
                                    size_t row) {
    int32_t facet = boundary->contacts.wall[row] - (int32_t)ctx->scene.wall_count;
    return &boundary->surfaces[gn_surface_of_facet(boundary, facet)];
}
