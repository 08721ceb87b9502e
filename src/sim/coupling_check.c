/* Figures of zones for who checks a scene. */
#include "base/ball.h"
#include "couple/zone.h"
#include "sim/coupling_internal.h"

#include <math.h>

/* The mean side of the boxes about a zone's elements; the least weight of a node. */
static void measure_elements(const gn_world *w, size_t zone, gn_zone_figures *f) {
    const gn_fem_solid *b = gn_coupled_solid(w);
    const gn_couple_zone *z = &w->scene.couple.zones[zone];
    double sum = 0.0;
    size_t count = 0;
    f->least = 1.0;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double lower[3] = {INFINITY, INFINITY, INFINITY},
               upper[3] = {-INFINITY, -INFINITY, -INFINITY};
        double place = INFINITY;
        for (int a = 0; a <= b->dimension; a++) {
            const double *x = b->nodes.start + 4 * (size_t)gn_elements_node(&b->elements, a)[e];
            place = fmin(place, gn_zone_place(z, b->dimension, x));
            for (int k = 0; k < b->dimension; k++) {
                lower[k] = fmin(lower[k], x[k]);
                upper[k] = fmax(upper[k], x[k]);
            }
        }
        if (place < -GN_ZONE_ROUNDING || place >= 1.0 - GN_ZONE_ROUNDING) continue;
        f->least = fmin(f->least, fmax(place, 0.0));
        for (int k = 0; k < b->dimension; k++) sum += (upper[k] - lower[k]) / b->dimension;
        count++;
        const gn_elements *q = &b->elements;
        f->modulus[1] = q->lambda[e] + 2.0 * q->mu[e];
        f->density[1] = b->density[q->material[e]];
    }
    f->element = count ? sum / (double)count : 0.0;
}

/* Weights of forces and masses cancel in these means; springs count half for each end. */
static void measure_particles(const gn_world *w, size_t zone, gn_zone_figures *f) {
    const gn_coupled *c = w->exchange[0].context;
    const gn_particles *q = &w->dem.particles;
    const gn_contacts *bonds = &w->dem.bonds;
    const double solid = 1.0 - gn_world_porosity(w);
    double n[3], volume = 0.0, stiffness = 0.0, mass = 0.0, radius = 0.0;
    gn_zone_direction(&w->scene.couple.zones[zone], (int)w->scene.dimension, n);
    for (size_t k = 0; k < c->ties.count; k++) {
        const size_t p = (size_t)w->dem.index_of_id[c->ties.tie[k].id];
        const double *blend = q->blend + 2 * p, r = q->pos[4 * p + 3];
        volume += blend[0] * gn_ball_volume((int)w->scene.dimension, r) / solid;
        mass += blend[0] / (q->vel[4 * p + 3] * blend[1]);
        radius += r / (double)c->ties.count;
        double place =
            gn_zone_place(&w->scene.couple.zones[zone], (int)w->scene.dimension, q->start + 4 * p);
        f->beyond += (place - 1.0) * f->width > 0.5 * r; /* outermost centres scatter */
    }
    for (size_t s = 0; s < bonds->soa.count; s++) {
        double d[3], length2, along, ends = 0.0;
        const int32_t end[2] = {bonds->i[s], bonds->j[s]};
        length2 = gn_branch(w, q->start + 4 * (size_t)end[0], q->start + 4 * (size_t)end[1], d);
        /* Particles that are in no element have all of their mass and lie beyond the last node. */
        for (int k = 0; k < 2; k++) ends += gn_coupled_has(c, q->id[end[k]]) ? 0.5 : 0.0;
        along = gn_dot3(d, n) * gn_dot3(d, n) / length2;
        stiffness += ends * length2 * along *
                     (bonds->kn[s] * along + (bonds->kt ? bonds->kt[s] * (1.0 - along) : 0.0));
    }
    f->diameter = 2.0 * radius;
    f->particles = c->ties.count;
    f->modulus[0] = stiffness / volume;
    f->density[0] = mass / volume;
}

size_t gn_coupled_broken(const gn_world *w) {
    const gn_contacts *bonds = &w->dem.bonds;
    const double *blend = w->dem.particles.blend;
    size_t count = 0;
    for (size_t c = 0; blend && bonds->cause && c < bonds->soa.count; c++)
        count += gn_broken(bonds->cause[c]) && blend[2 * (size_t)bonds->i[c]] < 1.0 &&
                 blend[2 * (size_t)bonds->j[c]] < 1.0;
    return count;
}

void gn_zone_measure(const gn_world *w, size_t k, gn_zone_figures *f) {
    *f = (gn_zone_figures){.width =
                               gn_zone_width(&w->scene.couple.zones[k], (int)w->scene.dimension)};
    measure_elements(w, k, f);
    measure_particles(w, k, f);
    double z = sqrt(f->modulus[0] * f->density[0] / (f->modulus[1] * f->density[1]));
    f->returned = (1.0 - z) * (1.0 - z) / ((1.0 + z) * (1.0 + z));
}
