#include "pack/domain.h"

#include "base/new.h"
#include "pack/domain_facets.h"

#include <math.h>

/* Kinds of bodies; the dimension distinguishes a rectangle from a box and a disc from a
 * cylinder. */
typedef enum domain_kind { DOMAIN_BOX, DOMAIN_ROUND, DOMAIN_FACETS } domain_kind;

struct gn_domain {
    domain_kind kind;
    int dimension;
    double lower[3], upper[3]; /* bounds; z is 0 in 2D */
    double centre[2], radius;  /* for round bodies */
    double volume;
    gn_facets *facets;
};

static const double pi = 3.14159265358979323846;

static gneiss_status new_domain(const gn_domain *from, gn_domain **domain, gneiss_error *error) {
    GN_TRY(gn_new(domain, 1, "a body", error));
    **domain = *from;
    return GNEISS_OK;
}

static gneiss_status make_box(const double *lower, const double *upper, int dimension,
                              const char *name, gn_domain **domain, gneiss_error *error) {
    gn_domain d = {.kind = DOMAIN_BOX, .dimension = dimension, .volume = 1};
    for (int k = 0; k < dimension; k++) {
        double side = upper[k] - lower[k];
        if (!isfinite(lower[k]) || !isfinite(upper[k]) || !isfinite(side) || !(side > 0))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected finite corners with lower < upper, found %g to %g m along "
                           "%c",
                           name, lower[k], upper[k], "xyz"[k]);
        d.lower[k] = lower[k];
        d.upper[k] = upper[k];
        d.volume *= side;
    }
    return new_domain(&d, domain, error);
}

static gneiss_status make_round(const double *base, double radius, double height, int dimension,
                                const char *name, gn_domain **domain, gneiss_error *error) {
    for (int k = 0; k < dimension; k++)
        if (!isfinite(base[k]))
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a finite centre, found %c = %g",
                           name, "xyz"[k], base[k]);
    if (!(radius > 0) || !isfinite(radius))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a finite radius above 0, found %g m", name, radius);
    if (!(height > 0) || !isfinite(height))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a finite height above 0, found %g m", name, height);
    gn_domain d = {.kind = DOMAIN_ROUND, .dimension = dimension, .radius = radius};
    for (int k = 0; k < 2; k++) {
        d.centre[k] = base[k];
        d.lower[k] = base[k] - radius;
        d.upper[k] = base[k] + radius;
    }
    d.volume = pi * radius * radius * height;
    if (dimension == 3) {
        d.lower[2] = base[2];
        d.upper[2] = base[2] + height;
    }
    return new_domain(&d, domain, error);
}

static gneiss_status make_faceted(const double *node, size_t node_count, const int32_t *element,
                                  size_t count, int dimension, const char *name, gn_domain **domain,
                                  gneiss_error *error) {
    gn_facets *facets = NULL;
    GN_TRY(gn_facets_create(node, node_count, element, count, dimension, name, &facets, error));
    gn_domain d = {
        .kind = DOMAIN_FACETS, .dimension = dimension, .volume = facets->volume, .facets = facets};
    for (int k = 0; k < 3; k++) {
        d.lower[k] = facets->lower[k];
        d.upper[k] = facets->upper[k];
    }
    gneiss_status status = new_domain(&d, domain, error);
    if (status != GNEISS_OK) gn_facets_free(facets);
    return status;
}

gneiss_status gn_domain_rectangle(const double lower[2], const double upper[2], gn_domain **domain,
                                  gneiss_error *error) {
    return make_box(lower, upper, 2, "rectangle", domain, error);
}

gneiss_status gn_domain_box(const double lower[3], const double upper[3], gn_domain **domain,
                            gneiss_error *error) {
    return make_box(lower, upper, 3, "box", domain, error);
}

gneiss_status gn_domain_disc(const double centre[2], double radius, gn_domain **domain,
                             gneiss_error *error) {
    return make_round(centre, radius, 1, 2, "disc", domain, error);
}

gneiss_status gn_domain_cylinder(const double base[3], double radius, double height,
                                 gn_domain **domain, gneiss_error *error) {
    return make_round(base, radius, height, 3, "cylinder", domain, error);
}

/* Returns twice the signed area about the first corner, positive if the body is on the left of the
 * edges. */
static double turned_area(const double *corners, size_t count) {
    double sum = 0;
    for (size_t i = 1; i + 1 < count; i++) {
        const double *a = corners + 2 * i, *b = a + 2;
        sum +=
            (a[0] - corners[0]) * (b[1] - corners[1]) - (a[1] - corners[1]) * (b[0] - corners[0]);
    }
    return sum;
}

gneiss_status gn_domain_polygon(const double *corners, size_t count, gn_domain **domain,
                                gneiss_error *error) {
    GN_FREED double *node = NULL;
    GN_FREED int32_t *edge = NULL;
    if (count < 3 || count > INT32_MAX / 16)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "polygon: expected 3 corners or more (at most %d), found %zu",
                       INT32_MAX / 16, count);
    GN_TRY(gn_new(&node, 3 * count, "coordinates of a polygon", error));
    GN_TRY(gn_new(&edge, 2 * count, "edges of a polygon", error));
    int last = turned_area(corners, count) < 0 ? 0 : 1;
    for (size_t i = 0; i < count; i++) {
        node[3 * i] = corners[2 * i];
        node[3 * i + 1] = corners[2 * i + 1];
        edge[2 * i + (size_t)(1 - last)] = (int32_t)i;
        edge[2 * i + (size_t)last] = (int32_t)((i + 1) % count);
    }
    return make_faceted(node, count, edge, count, 2, "polygon", domain, error);
}

gneiss_status gn_domain_surface(const gn_mesh *mesh, int dimension, const char *name,
                                gn_domain **domain, gneiss_error *error) {
    if (dimension != 2 && dimension != 3)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected 2 or 3 dimensions, found %d", name,
                       dimension);
    const gn_mesh_elements *elements = dimension == 3 ? &mesh->triangles : &mesh->lines;
    return make_faceted(mesh->node, mesh->node_count, elements->node, elements->count, dimension,
                        name, domain, error);
}

void gn_domain_free(gn_domain *domain) {
    if (!domain) return;
    gn_facets_free(domain->facets);
    gn_free(domain);
}

int gn_domain_dimension(const gn_domain *domain) {
    return domain->dimension;
}

double gn_domain_volume(const gn_domain *domain) {
    return domain->volume;
}

void gn_domain_bounds(const gn_domain *domain, double lower[3], double upper[3]) {
    for (int k = 0; k < 3; k++) {
        lower[k] = domain->lower[k];
        upper[k] = domain->upper[k];
    }
}

/* Returns the first axis across which the sides are flat; the sides across later axes are flat,
 * too. A disc has none. */
static int first_flat_axis(const gn_domain *domain) {
    return domain->kind == DOMAIN_ROUND ? 2 : 0;
}

/* Returns the distance from the axis and the unit direction away from it; on the axis the direction
 * is arbitrary. */
static double off_axis(const gn_domain *domain, const double x[3], double away[2]) {
    double u = x[0] - domain->centre[0], v = x[1] - domain->centre[1], r = hypot(u, v);
    away[0] = r > 0 ? u / r : 1;
    away[1] = r > 0 ? v / r : 0;
    return r;
}

/* Computes the vector from the nearest point of the closed body to x, which is 0 inside, and
 * returns its length. */
static double excess(const gn_domain *domain, const double x[3], double step[3]) {
    step[0] = step[1] = step[2] = 0;
    for (int k = first_flat_axis(domain); k < domain->dimension; k++)
        step[k] =
            x[k] < domain->lower[k] ? x[k] - domain->lower[k] : fmax(x[k] - domain->upper[k], 0);
    if (domain->kind == DOMAIN_ROUND) {
        double away[2], over = off_axis(domain, x, away) - domain->radius;
        for (int k = 0; k < 2 && over > 0; k++) step[k] = over * away[k];
    }
    return hypot(hypot(step[0], step[1]), step[2]);
}

/* Returns the depth below the nearest flat or round side; x must be inside. */
static double least_depth(const gn_domain *domain, const double x[3]) {
    double away[2], depth = INFINITY;
    if (domain->kind == DOMAIN_ROUND) depth = domain->radius - off_axis(domain, x, away);
    for (int k = first_flat_axis(domain); k < domain->dimension; k++)
        depth = fmin(depth, fmin(x[k] - domain->lower[k], domain->upper[k] - x[k]));
    return depth;
}

double gn_domain_depth(const gn_domain *domain, const double x[3]) {
    if (domain->kind == DOMAIN_FACETS) return gn_facets_depth(domain->facets, x);
    double step[3], outside = excess(domain, x, step);
    return outside > 0 ? -outside : least_depth(domain, x);
}

/* Inserts a plane in the order of depth; planes of equal depth keep their order. */
static int insert(gn_domain_plane *planes, int count, gn_domain_plane plane) {
    int at = count;
    for (; at > 0 && planes[at - 1].depth > plane.depth; at--) planes[at] = planes[at - 1];
    planes[at] = plane;
    return count + 1;
}

int gn_domain_planes(const gn_domain *domain, const double x[3], double reach,
                     gn_domain_plane planes[GN_DOMAIN_PLANES]) {
    if (domain->kind == DOMAIN_FACETS) return gn_facets_planes(domain->facets, x, reach, planes);
    double step[3], away[2], outside = excess(domain, x, step);
    if (outside > 0) {
        planes[0].depth = -outside;
        for (int k = 0; k < 3; k++) planes[0].normal[k] = -step[k] / outside;
        return 1;
    }
    int count = 0;
    for (int k = first_flat_axis(domain); k < domain->dimension; k++) {
        for (int side = 0; side < 2; side++) {
            gn_domain_plane plane = {.depth =
                                         side ? domain->upper[k] - x[k] : x[k] - domain->lower[k]};
            plane.normal[k] = side ? -1 : 1;
            if (plane.depth <= reach) count = insert(planes, count, plane);
        }
    }
    if (domain->kind == DOMAIN_ROUND) {
        double depth = domain->radius - off_axis(domain, x, away);
        if (depth <= reach)
            count = insert(planes, count, (gn_domain_plane){{-away[0], -away[1], 0}, depth});
    }
    return count;
}
