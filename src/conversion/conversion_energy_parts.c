/* What a conversion books, by what made it: between the elements that give up their part and the
 * springs that take it stand what these hold as an even strain would have it. Parts are differences
 * of states that follow each other, so that their sum is what is booked whatever they are called.
 *
 * With dw_p the part of the body that particle p takes, V_p its part of the specimen's volume, W_e
 * what its element holds per volume and w_b(F) what bond b holds where both ends go with the
 * gradient F of the element of p:
 *     sampled    what elements lose                 - sum_p dw_p V_p W_e
 *     stiffness  sum_p dw_p V_p W_e                 - sum_p dw_p sum_b 1/2 w_b(F_p)
 *     uneven     sum_p dw_p sum_b 1/2 w_b(F_p)      - what contacts gain
 *     balance    what contacts hold less once who is free is in balance
 * and beside these kinetic energy, and half a step of the powers of springs (conversion_energy.c),
 * with what new velocities do to forces across contacts, which stand half a step back.
 */
#include "base/ball.h"
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "fem/solid.h"
#include "frame/ledger.h"
#include "particles/dem.h"
#include "particles/observe.h"
#include "soa/records.h"
#include "world/world.h"
#include "zones/zone_state.h"
#include "zones/zones_private.h"

#include <math.h>

/* By how much more of the body a particle has; 0 of who is in no element. */
static double taken_by(const gn_conversion *c, size_t p) {
    return gn_home_of(c, p) < 0 ? 0.0 : c->world->dem.particles.blend[2 * p] - c->part[2 * p];
}

/* F and R of elements that were asked for last; bonds of a particle lie together. */
typedef struct gradients {
    int32_t element;
    double f[3][3], turn[3][3];
} gradients;

static void gradient_at(const gn_conversion *c, size_t p, gradients *g) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const int32_t e = gn_home_of(c, p);
    if (g->element == e) return;
    g->element = e;
    gn_fem_gradient_of(b, (size_t)e, g->f);
    gn_fem_rotation(b, (size_t)e, g->turn);
}

/* J, of a whole bond of which both ends go with an element (as conversion_contacts.c has it). */
static double bond_energy(const gn_conversion *c, size_t k, const gradients *g) {
    const gn_contacts *all = &c->world->dem.prepared;
    const double *start = c->world->dem.particles.start;
    double l[3], d[3] = {0.0}, slip[3], along = 0.0;
    const double rest = sqrt(
        gn_branch(&c->world->ctx, start + 4 * (size_t)all->i[k], start + 4 * (size_t)all->j[k], l));
    for (int r = 0; r < 3; r++) {
        slip[r] = 0.0;
        for (int m = 0; m < 3; m++) {
            d[r] += g->f[r][m] * l[m];
            slip[r] += (g->f[r][m] - g->turn[r][m]) * l[m];
        }
    }
    const double length = sqrt(gn_dot3(d, d)), stretch = length - rest;
    for (int r = 0; r < 3; r++) along += slip[r] * d[r] / length;
    const double across2 = fmax(gn_dot3(slip, slip) - along * along, 0.0);
    return 0.5 * (all->kn[k] * stretch * stretch + (all->kt ? all->kt[k] * across2 : 0.0));
}

static double springs_alike(const gn_conversion *c) {
    const gn_contacts *all = &c->world->dem.prepared;
    gradients g[2] = {{.element = -1}, {.element = -1}};
    double sum = 0.0;
    for (size_t k = 0; k < all->soa.count; k++)
        for (int end = 0; end < 2; end++) {
            const size_t p = (size_t)(end ? all->j[k] : all->i[k]);
            const double taken = taken_by(c, p);
            if (taken == 0.0) continue;
            gradient_at(c, p, &g[end]);
            sum += 0.5 * taken * bond_energy(c, k, &g[end]);
        }
    return sum;
}

static double elements_alike(const gn_conversion *c) {
    const gn_world *w = c->world;
    const gn_fem_solid *b = gn_coupled_solid(&w->solids);
    const double solid = 1.0 - gn_dem_porosity(&w->ctx, &w->dem);
    double sum = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const double taken = taken_by(c, p);
        if (taken == 0.0) continue;
        sum += taken * gn_ball_volume(b->dimension, w->dem.particles.pos[4 * p + 3]) / solid *
               gn_fem_energy_density(b, (size_t)gn_home_of(c, p));
    }
    return sum;
}

void gn_conversion_find_alike(const gn_conversion *c, double alike[2]) {
    alike[0] = elements_alike(c);
    alike[1] = springs_alike(c);
}

void gn_conversion_book(gn_zones *zones, gn_ledger *ledger, const gn_held_stages *held,
                        double kinetic) {
    gn_conversion_parts *parts = &zones->state.parts;
    const double *alike = held->alike;
    parts->sampled += held->before.elements - held->after.elements - alike[0];
    parts->stiffness += alike[0] - alike[1];
    parts->uneven += alike[1] - (held->woken[0] - held->before.contacts);
    parts->balance += held->woken[0] - held->woken[1];
    parts->motion += kinetic;
    parts->step += held->woken[1] - held->after.contacts + held->before.step - held->after.step;
    parts->alike[0] += alike[0];
    parts->alike[1] += alike[1];
    zones->state.corrected.energy += kinetic;
    ledger->energy.conversion += kinetic + gn_held_sum(&held->before) - gn_held_sum(&held->after);
}
