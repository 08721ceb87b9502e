/* Fields of displacements and velocities, conversions by hand, and what a body of elements and
 * particles has as a whole: for the tests of what converts. */
#ifndef GN_TESTS_CONVERSION_HELPERS_H
#define GN_TESTS_CONVERSION_HELPERS_H

#include "couple/front.h"
#include "sim/conversion.h"
#include "sim/coupling.h"
#include "sim/exchange.h"
#include "world_helpers.h"

typedef void field(const double *x, const void *of, double u[3], double v[3]);

static inline void set_field(gn_particles *q, field *at, const void *of) {
    for (size_t p = 0; p < q->soa.count; p++) {
        double u[3] = {0}, v[3] = {0};
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        at(q->start + 4 * p, of, u, v);
        for (size_t k = 0; k < 3; k++) {
            q->pos[4 * p + k] = q->start[4 * p + k] + u[k];
            q->vel[4 * p + k] = v[k];
        }
    }
}

/* Of what is there: elements, as long as all particles sleep. */
static inline void set_elements(gn_world *w, field *at, const void *of) {
    set_field(&w->elements[0]->solid.nodes, at, of);
    gn_fem_moved(&w->elements[0]->solid);
    gn_fem_to_single(&w->elements[0]->solid);
}

/* Converts the elements of which all nodes start between two corners. */
static inline gneiss_status convert_box(gn_world *w, const double low[3], const double high[3],
                                        gneiss_error *error) {
    const gn_fem_solid *b = &w->elements[0]->solid;
    uint8_t *kind = calloc(b->elements.soa.count + 1, 1);
    gneiss_status status = gn_conversion_kinds(w, kind, error);
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        bool in = kind[e] == GN_FRONT_READY;
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < b->dimension; k++) {
                double x =
                    b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e] + (size_t)k];
                in = in && x >= low[k] - 1e-9 && x <= high[k] + 1e-9;
            }
        if (in) kind[e] = GN_FRONT_LEAVING;
    }
    if (status == GNEISS_OK) status = gn_conversion_convert(w, kind, error);
    free(kind);
    return status;
}

static inline void convert(gn_world *w, double from, double to, double low, double high) {
    gneiss_error error = {0};
    const double a[3] = {from, low, 0.0}, b[3] = {to, high, 1.0};
    if (convert_box(w, a, b, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static inline bool is_awake(const gn_world *w, size_t p) {
    return w->dem.particles.vel[4 * p + 3] > 0.0;
}

static inline bool is_tied(const gn_world *w, size_t p) {
    return gn_coupled_has(w->exchange[0].context, w->dem.particles.id[p]);
}

/* Mass, its first moment, momenta about the origin, moments of inertia about the axis z. */
typedef struct whole {
    double mass, moment[3], momentum[3], turning[3], inertia, energy;
} whole;

static inline void add_points(const gn_world *w, const gn_particles *q, bool particles, whole *s) {
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p, *v = q->vel + 4 * p;
        if (!(v[3] > 0.0)) continue;
        const double m = particles && is_tied(w, p) ? 0.0 : 1.0 / v[3];
        s->mass += m;
        s->inertia += m * (x[0] * x[0] + x[1] * x[1]);
        s->energy += 0.5 * m * gn_dot3(v, v);
        for (int a = 0; a < 3; a++) {
            int c = (a + 1) % 3, d = (a + 2) % 3;
            s->moment[a] += m * x[a];
            s->momentum[a] += m * v[a];
            s->turning[a] += m * (x[c] * v[d] - x[d] * v[c]);
        }
        if (!q->spin) continue;
        const double *o = q->spin + 4 * p;
        s->inertia += 1.0 / o[3];
        s->energy += 0.5 * gn_dot3(o, o) / o[3];
        for (int a = 0; a < 3; a++) s->turning[a] += o[a] / o[3];
    }
}

static inline whole whole_of(const gn_world *w) {
    whole s = {0};
    add_points(w, &w->dem.particles, true, &s);
    add_points(w, &w->elements[0]->solid.nodes, false, &s);
    return s;
}

#endif
