#include "solids/element_bodies.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "base/vec3.h"
#include "fem/fem.h"
#include "soa/records.h"
#include "solids/solids.h"

#include <math.h>
#include <string.h>

/* --- nodes of a body --- */

/* Numbers the bodies of nodes [nodes] from 0 in ascending order; *count: number of bodies. */
static void number_bodies(const gn_fem_solid *b, int32_t *body, size_t *count) {
    const size_t n = b->nodes.soa.count;
    for (size_t v = 0; v < n; v++) body[v] = (int32_t)v;
    for (size_t e = 0; e < b->elements.soa.count; e++)
        for (int a = 1; a <= b->dimension; a++)
            gn_set_unite(body, gn_elements_node(&b->elements, 0)[e],
                         gn_elements_node(&b->elements, a)[e]);
    for (size_t v = 0; v < n; v++) body[v] = gn_set_root(body, (int32_t)v);
    *count = 0;
    /* A root has the smallest index of its set, so that it is numbered before the other nodes refer
     * to it. */
    for (size_t v = 0; v < n; v++)
        body[v] = body[v] == (int32_t)v ? (int32_t)(*count)++ : body[body[v]];
}

/* --- masses --- */

typedef struct body_sums {
    double mass, first[3], second[9]; /* kg, kg m, kg m2 about the centre */
    unsigned driven;                  /* bit k: a motion drives component k of a node */
} body_sums;

static void add_masses(const gn_fem_solid *b, const int32_t *body, body_sums *sums) {
    for (size_t v = 0; v < b->nodes.soa.count; v++) {
        const double inverse = b->nodes.vel[4 * v + 3], *x = b->nodes.start + 4 * v;
        const int32_t slot = b->prescribed.count ? b->nodes.slot[v] : -1;
        body_sums *s = &sums[body[v]];
        if (slot >= 0) s->driven |= b->prescribed.mask[slot];
        if (!(inverse > 0.0)) continue;
        s->mass += 1.0 / inverse;
        for (int a = 0; a < 3; a++) s->first[a] += x[a] / inverse;
    }
}

static void add_moments(const gn_fem_solid *b, const int32_t *body, body_sums *sums) {
    for (size_t v = 0; v < b->nodes.soa.count; v++) {
        const double inverse = b->nodes.vel[4 * v + 3], *x = b->nodes.start + 4 * v;
        body_sums *s = &sums[body[v]];
        double d[3];
        if (!(inverse > 0.0)) continue;
        for (int a = 0; a < 3; a++) d[a] = x[a] - s->first[a] / s->mass;
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++) s->second[3 * a + c] += d[a] * d[c] / inverse;
    }
}

/* Inverts the inertia tr(S) 1 - S; in 2D only that about z. */
static void invert_inertia(const double s[9], int dimension, double inverse[9]) {
    const double trace = s[0] + s[4] + s[8];
    double m[9], cofactor[9], determinant = 0.0;
    memset(inverse, 0, 9 * sizeof *inverse);
    if (!(trace > 0.0)) return;
    if (dimension == 2) {
        inverse[8] = 1.0 / trace;
        return;
    }
    for (int a = 0; a < 9; a++) m[a] = (a % 4 == 0 ? trace : 0.0) - s[a];
    for (int a = 0; a < 3; a++)
        gn_cross3(m + 3 * ((a + 1) % 3), m + 3 * ((a + 2) % 3), cofactor + 3 * a);
    for (int a = 0; a < 3; a++) determinant += m[a] * cofactor[a];
    for (int a = 0; determinant > 0.0 && a < 9; a++) inverse[a] = cofactor[a] / determinant;
}

static void make_body(const body_sums *s, int dimension, gn_element_body *b) {
    *b = (gn_element_body){0};
    if (!(s->mass > 0.0)) return;
    for (int a = 0; a < 3; a++) b->centre[a] = s->first[a] / s->mass;
    for (int a = 0; a < dimension; a++)
        if (!(s->driven >> a & 1)) b->inverse_mass[a] = 1.0 / s->mass;
    if (!s->driven) invert_inertia(s->second, dimension, b->inverse_inertia);
}

gneiss_status gn_element_bodies_find(gn_element_model *q, gneiss_error *error) {
    const gn_fem_solid *b = &q->solid;
    size_t count = 0;
    int32_t *body = gn_alloc_array(b->nodes.soa.count + 1, sizeof *body);
    q->contact.body = body;
    if (body) number_bodies(b, body, &count);
    body_sums *sums = gn_alloc_array(count + 1, sizeof *sums);
    q->contact.bodies = gn_alloc_array(count + 1, sizeof *q->contact.bodies);
    const bool held = body && sums && q->contact.bodies;
    if (held) {
        add_masses(b, body, sums);
        add_moments(b, body, sums);
        for (size_t k = 0; k < count; k++) make_body(&sums[k], b->dimension, &q->contact.bodies[k]);
    }
    gn_free(sums);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for bodies of %zu nodes",
                          b->nodes.soa.count);
}

/* --- frames of facets --- */

/* Computes unit vectors along the first side of a facet, along its normal, and across both; returns
 * false if the facet has no area. */
static bool find_frame(const double *const x[3], int corners, double frame[9]) {
    double side[2][3] = {{0}, {0}};
    for (int a = 0; a < 3; a++) {
        side[0][a] = x[1][a] - x[0][a];
        side[1][a] = corners == 3 ? x[2][a] - x[0][a] : (a == 2 ? 1.0 : 0.0);
    }
    memcpy(frame, side[0], sizeof side[0]);
    gn_cross3(side[0], side[1], frame + 3);
    for (int k = 0; k < 2; k++) {
        const double size = sqrt(gn_dot3(frame + 3 * k, frame + 3 * k));
        if (!(size > 0.0)) return false;
        for (int a = 0; a < 3; a++) frame[3 * k + a] /= size;
    }
    gn_cross3(frame, frame + 3, frame + 6);
    return true;
}

/* Rotates a direction back, as the facet has rotated since the start. */
static void turn_back(const gn_surface *s, const int32_t *corner, const double n[3],
                      double turned[3]) {
    const gn_particles *nodes = &s->elements->solid.nodes;
    const double *now[3] = {0}, *start[3] = {0};
    double to[9], from[9];
    for (int k = 0; k < s->facets.corners; k++) {
        now[k] = nodes->pos + 4 * (int64_t)corner[k];
        start[k] = nodes->start + 4 * (int64_t)corner[k];
    }
    memcpy(turned, n, 3 * sizeof *n);
    if (!find_frame(now, s->facets.corners, from) || !find_frame(start, s->facets.corners, to))
        return;
    for (int a = 0; a < 3; a++) {
        turned[a] = 0.0;
        for (int k = 0; k < 3; k++) turned[a] += to[3 * k + a] * gn_dot3(from + 3 * k, n);
    }
}

double gn_element_body_inverse_mass(const gn_surface *s, int32_t facet, const double weight[3],
                                    const double n[3]) {
    const int32_t *corner = s->facets.corner + s->facets.corners * (int64_t)facet;
    const gn_element_contact *contact = &s->elements->contact;
    const gn_element_body *b = &contact->bodies[contact->body[corner[0]]];
    double lever[3], direction[3], turn[3], sum = 0.0;
    for (int a = 0; a < 3; a++) sum += n[a] * n[a] * b->inverse_mass[a];
    if (!(b->inverse_inertia[8] > 0.0)) return sum;
    for (int a = 0; a < 3; a++) {
        lever[a] = -b->centre[a];
        for (int k = 0; k < s->facets.corners; k++)
            lever[a] += weight[k] * s->elements->solid.nodes.start[4 * (int64_t)corner[k] + a];
    }
    turn_back(s, corner, n, direction);
    gn_cross3(lever, direction, turn);
    for (int a = 0; a < 3; a++) sum += turn[a] * gn_dot3(b->inverse_inertia + 3 * a, turn);
    return sum;
}
