#include "boundary/overlap.h"

#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/surface.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "pack/domain.h"
#include "particles/bonds.h"
#include "particles/particles.h"
#include "scene/acts.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "surfaces/body_shape.h"
#include "surfaces/facet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- closed surfaces --- */

/* A common edge of two facets; in the plane a point, stored twice. */
typedef struct rim {
    int32_t low, high;
} rim;

static int by_corners(const void *a, const void *b) {
    const rim *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    return (x->high > y->high) - (x->high < y->high);
}

static void fill_rims(const gn_facet_set *s, rim *rims) {
    const size_t corners = (size_t)s->corners;
    for (size_t k = 0; k < corners * s->count; k++) {
        const int32_t *corner = s->corner + k / corners * corners;
        int32_t a = corner[k % corners], b = corners == 3 ? corner[(k + 1) % corners] : a;
        rims[k] = a < b ? (rim){a, b} : (rim){b, a};
    }
}

/* Tells whether a surface is closed: every edge belongs to an even number of facets. */
static gneiss_status is_closed(const gn_facet_set *s, bool *closed, gneiss_error *error) {
    const size_t count = (size_t)s->corners * s->count;
    rim *rims = NULL;
    GN_TRY(gn_new(&rims, count + 1, "edges", error));
    fill_rims(s, rims);
    qsort(rims, count, sizeof *rims, by_corners);
    *closed = true;
    for (size_t k = 0, next; k < count && *closed; k = next) {
        for (next = k + 1; next < count && by_corners(&rims[k], &rims[next]) == 0;) next++;
        *closed = (next - k) % 2 == 0;
    }
    gn_free(rims);
    return GNEISS_OK;
}

/* --- inside --- */

/* Direction of a ray, which no face or edge of a usual body has. */
static const double ray[3] = {0.6317, 0.5143, 0.5800};

static const double *corner_of(const gn_facet_set *s, int32_t facet, int c) {
    return s->pos + 4 * (int64_t)s->corner[s->corners * (int64_t)facet + c];
}

/* Tells whether the ray crosses a triangle (Moller and Trumbore 1997, J. Graphics Tools 2, 21-28).
 */
static bool crosses_triangle(const gn_facet_set *s, int32_t facet, const double from[3]) {
    double side[2][3], to[3], p[3], q[3];
    const double *x = corner_of(s, facet, 0);
    for (int a = 0; a < 3; a++) {
        for (int c = 0; c < 2; c++) side[c][a] = corner_of(s, facet, c + 1)[a] - x[a];
        to[a] = from[a] - x[a];
    }
    gn_cross3(ray, side[1], p);
    gn_cross3(to, side[0], q);
    double size = gn_dot3(side[0], p);
    double u = gn_dot3(to, p) / size, v = gn_dot3(ray, q) / size;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && gn_dot3(side[1], q) / size > 0.0;
}

/* Tells whether the ray, which runs along y in the plane, crosses a segment; a corner belongs to
 * one of the two segments that share it. */
static bool crosses_segment(const gn_facet_set *s, int32_t facet, const double from[3]) {
    const double *x = corner_of(s, facet, 0), *y = corner_of(s, facet, 1);
    if ((x[0] > from[0]) == (y[0] > from[0])) return false;
    double part = (from[0] - x[0]) / (y[0] - x[0]);
    return x[1] + part * (y[1] - x[1]) > from[1];
}

static bool ray_meets_box(const gn_facet_box *box, const double from[3]) {
    double begin = 0.0, end = INFINITY;
    for (int a = 0; a < 3; a++) {
        begin = fmax(begin, (box->lower[a] - from[a]) / ray[a]);
        end = fmin(end, (box->upper[a] - from[a]) / ray[a]);
    }
    return begin <= end * (1.0 + 1e-12);
}

static bool line_meets_box(const gn_facet_box *box, const double from[3]) {
    return box->lower[0] <= from[0] && from[0] <= box->upper[0] && from[1] <= box->upper[1];
}

/* Counts the facets of box `at` and of the boxes in it that the ray crosses. */
static size_t crossings(const gn_surface *s, int32_t at, const double from[3]) {
    const gn_facet_box *box = &s->tree.box[at];
    bool space = s->facets.corners == 3;
    size_t count = 0;
    if (!(space ? ray_meets_box(box, from) : line_meets_box(box, from))) return 0;
    if (!box->count) return crossings(s, at + 1, from) + crossings(s, box->right, from);
    for (int32_t k = box->begin; k < box->begin + box->count; k++) {
        int32_t facet = s->tree.order[k];
        count += space ? crosses_triangle(&s->facets, facet, from)
                       : crosses_segment(&s->facets, facet, from);
    }
    return count;
}

/* Counts the particles with their centre inside a surface; *first: the first of them. */
static size_t count_inside(const gn_dem *dem, const gn_boundary *boundary, const gn_surface *s,
                           size_t *first) {
    size_t inside = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        const double *x = dem->particles.pos + 4 * p;
        const gn_rigid *b = s->body >= 0 ? &boundary->bodies[s->body] : NULL;
        double d[3], centre[3];
        for (int a = 0; a < 3; a++) centre[a] = d[a] = b ? x[a] - b->position[a] : x[a];
        if (b) gn_rigid_local(b, d, centre);
        if (crossings(s, 0, centre) % 2 == 0) continue;
        if (!inside++) *first = p;
    }
    return inside;
}

gneiss_status gn_body_holds(const gn_dem *dem, const gn_boundary *boundary, size_t body,
                            size_t *count, size_t *first, gneiss_error *error) {
    const gn_surface *s = &boundary->surfaces[body]; /* the surfaces of bodies are the first ones */
    bool closed = false;
    *count = 0;
    GN_TRY(is_closed(&s->facets, &closed, error));
    if (closed) *count = count_inside(dem, boundary, s, first);
    return GNEISS_OK;
}

/* --- touching --- */

/* Evaluates the overlaps in the lists, which contain every particle near a surface. */
static void measure_touches(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, gn_overlap *overlap) {
    gn_surface_contact contacts[GN_SURFACE_CONTACTS];
    size_t row = 0, count;
    while (gn_surface_contacts_next(ctx, dem, boundary, &row, 0.0, contacts, &count)) {
        if (!count) continue;
        gn_overlap *o = &overlap[contacts[0].surface - boundary->surfaces];
        o->touching++;
        for (size_t k = 0; k < count; k++)
            o->deepest = fmax(o->deepest, -contacts[k].contact.overlap);
    }
}

gneiss_status gn_boundary_overlaps(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, gn_overlap *overlap,
                                   gneiss_error *error) {
    memset(overlap, 0, boundary->surface_count * sizeof *overlap);
    if (!(ctx->effects & GN_FX_FACETS)) return GNEISS_OK;
    measure_touches(ctx, dem, boundary, overlap);
    for (size_t k = 0; k < boundary->surface_count; k++) {
        bool closed = false;
        GN_TRY(is_closed(&boundary->surfaces[k].facets, &closed, error));
        size_t first;
        if (closed) overlap[k].inside = count_inside(dem, boundary, &boundary->surfaces[k], &first);
    }
    return GNEISS_OK;
}

gn_overlap gn_wall_overlap(const gn_dem *dem, const gn_boundary *boundary, size_t wall) {
    const gn_particles *q = &dem->particles;
    gn_overlap o = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        double centre = gn_wall_distance(&boundary->walls[wall], q->pos + 4 * p);
        o.touching += centre <= q->pos[4 * p + 3];
        o.inside += centre < 0.0;
        o.deepest = fmax(o.deepest, q->pos[4 * p + 3] - centre);
    }
    return o;
}

/* Overlap over the smallest radius beyond which particles are pushed apart; packings and the weight
 * of a few layers cause smaller overlaps. */
static const double bursting = 0.02;

bool gn_overlap_bursts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_periodic_box *box, const gn_overlap *overlap, char *text,
                       size_t size) {
    const gn_scene *s = &ctx->scene;
    const size_t walls = s->wall_count, bodies = s->body_count;
    const char *name = NULL, *kind = "";
    double deepest = bursting * dem->radius_min;
    /* Particles from another run may rest on their supports. */
    if (!s->has_specimen || *s->specimen.from ||
        gn_stored_matters(ctx, dem, gn_contacts_stored(ctx, dem, box)))
        return false;
    for (size_t k = 0; k < walls + boundary->surface_count; k++) {
        const bool wall = k < walls, body = !wall && k - walls < bodies;
        const char *of = wall ? s->walls[k].name : body ? s->bodies[k - walls].name : "elements";
        const gn_overlap o = wall ? gn_wall_overlap(dem, boundary, k) : overlap[k - walls];
        if ((wall && s->walls[k].passive) || gn_scene_is_end(s, of) || !(o.deepest > deepest))
            continue;
        deepest = o.deepest;
        name = of;
        kind = wall ? "wall" : body ? "body" : "surface";
    }
    if (name)
        snprintf(text, size,
                 "%s '%.60s' overlaps particles at the start by up to %.3g m, %.3g of the smallest "
                 "radius: it pushes them away at once, and may break bonds; a place farther out, "
                 "or passive: true of a wall, avoids it",
                 kind, name, deepest, deepest / dem->radius_min);
    return name;
}

/* If a surface intersects itself, its volume is not the enclosed one, because common parts count
 * twice. */

/* Joins repeated points of a polygon, as where it closes, into one node. */
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
