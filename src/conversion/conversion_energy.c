/* What springs and elements hold before and after a conversion, of those alone which it changes:
 * the rest would only add the rounding of large sums.
 *
 * What leap-frog conserves is 1/2 v(-) M v(+) and what springs hold at the instant: 1/2 v(-) M v(-)
 * and half a step of the power of their forces at v(-). Tangential forces between two steps are
 * those of the instant before; the step to come adds what the last interval did. That power at
 * nodes that are driven is no part of what is conserved, but the work of their reactions, of which
 * the interval that led here has the mean of its two ends, takes the one after the conversion for
 * that end: what it misses is half a step of the power of what the reactions jump by. */
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "conversion/conversion_private.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "kernels/law.h"
#include "particles/dem.h"
#include "particles/lists.h"
#include "soa/records.h"
#include "world/world.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

/* N, of a contact across n, of the instant; the rate at which its ends part, m/s. */
static void advance_shear(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                          size_t c, double length, const double n[3], const double shear[3],
                          double now[3], double rate[3]) {
    gn_contact_rate(ctx, dem, list->i[c], list->j[c], length, n, rate);
    const double kt = list->kt ? list->kt[c] : 0.0, along = gn_dot3(rate, n);
    for (int a = 0; a < 3; a++) now[a] = shear[a] + kt * ctx->dt_past * (rate[a] - along * n[a]);
}

/* What does not act has no force of its springs, and what slides none beyond its limit. */
double gn_contact_held(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c, double n[3], double *length, double force[3]) {
    const gn_law *law = gn_law_of(list->soa.effects);
    const double *a = dem->particles.pos + 4 * (size_t)list->i[c],
                 *b = dem->particles.pos + 4 * (size_t)list->j[c];
    double shear[3], rate[3];
    *length = sqrt(gn_branch(ctx, a, b, n));
    const double rest = list->length0 ? list->length0[c] : a[3] + b[3];
    for (int k = 0; k < 3; k++) n[k] /= *length;
    gn_law_held h = law->held(list, c, *length, *length - rest);
    advance_shear(ctx, dem, list, c, *length, n, h.shear, shear, rate);
    const bool bonded = gn_contact_bonded(list, c), acts = bonded || h.normal != 0.0;
    if (!bonded && law->slips(list, c, h.normal, sqrt(gn_dot3(shear, shear))))
        memcpy(shear, h.shear, sizeof shear);
    for (int k = 0; k < 3; k++) force[k] = acts ? h.normal * n[k] + shear[k] : 0.0;
    return h.normal;
}

static void add_contact(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                        size_t c, gn_held *sum) {
    const double *a = dem->particles.pos + 4 * (size_t)list->i[c],
                 *b = dem->particles.pos + 4 * (size_t)list->j[c];
    double n[3], shear[3], rate[3], length = sqrt(gn_branch(ctx, a, b, n));
    const double rest = list->length0 ? list->length0[c] : a[3] + b[3];
    for (int k = 0; k < 3; k++) n[k] /= length;
    const gn_law_held h = gn_law_of(list->soa.effects)->held(list, c, length, length - rest);
    advance_shear(ctx, dem, list, c, length, n, h.shear, shear, rate);
    double stored = h.stored, power = h.normal * gn_dot3(rate, n) + gn_dot3(shear, rate);
    if (list->kt && list->kt[c] > 0.0)
        stored += (gn_dot3(shear, shear) - gn_dot3(h.shear, h.shear)) / (2.0 * list->kt[c]);
    sum->contacts += stored;
    sum->step -= 0.5 * ctx->dt_past * power;
}

/* Whether it has, weighs or does something else than before. */
static bool is_other(const gn_conversion *c, int32_t p) {
    const size_t k = 2 * (size_t)p;
    const double *part = c->world->dem.particles.blend;
    return c->freed[p] || part[k] != c->part[k] || part[k + 1] != c->part[k + 1];
}

static void add_contacts(const gn_conversion *c, const gn_contacts *list, bool other,
                         gn_held *sum) {
    const gn_world *w = c->world;
    const gn_contacts *bonds = &w->dem.bonds.contacts;
    for (size_t k = 0; k < list->soa.count; k++) {
        const int32_t i = list->i[k], j = list->j[k];
        if ((is_other(c, i) || is_other(c, j)) != other) continue;
        const size_t at = list == bonds ? 0 : gn_contacts_from(bonds, i, j);
        const bool known =
            list != bonds && at < bonds->soa.count && bonds->i[at] == i && bonds->j[at] == j;
        if (!known) add_contact(&w->ctx, &w->dem, list, k, sum);
    }
}

/* Of who changes place as it is brought into balance. */
static void add_walls(const gn_conversion *c, bool other, gn_held *sum) {
    const gn_wall_contacts *q = &c->world->boundary.contacts;
    for (size_t k = 0; c->world->ctx.scene.wall_count && k < q->soa.count; k++)
        if (is_other(c, q->i[k]) == other)
            sum->contacts += gn_wall_held(&c->world->ctx, &c->world->dem, &c->world->boundary, k);
}

/* Those that the conversion touches, or does not, of the elements that there are; scratch: c->some.
 */
static void add_elements(const gn_conversion *c, bool touched, gn_held *sum) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const double half = 0.5 * c->world->ctx.dt_past;
    size_t count = 0;
    for (size_t e = 0; e < b->elements.soa.count; e++)
        if (c->touched[c->place[b->elements.id[e]]] == touched) c->some[count++] = (int32_t)e;
    /* Half a step of the power is what the difference of two energies gives. */
    sum->elements += gn_fem_elastic_energy(b, c->some, count, 0.0);
    sum->step += 0.5 * (gn_fem_elastic_energy(b, c->some, count, -half) -
                        gn_fem_elastic_energy(b, c->some, count, half));
}

static gn_held held(const gn_conversion *c, bool changes) {
    gn_held sum = {0};
    add_elements(c, changes, &sum);
    add_contacts(c, &c->world->dem.bonds.contacts, changes, &sum);
    add_contacts(c, &c->world->dem.pairs.contacts, changes, &sum);
    add_walls(c, changes, &sum);
    return sum;
}

gn_held gn_conversion_held(const gn_conversion *c) {
    return held(c, true);
}

double gn_conversion_held_beside(const gn_conversion *c) {
    const gn_held beside = held(c, false);
    return gn_held_sum(&beside);
}

double gn_conversion_held_in_contacts(const gn_conversion *c) {
    gn_held sum = {0};
    add_contacts(c, &c->world->dem.bonds.contacts, true, &sum);
    add_contacts(c, &c->world->dem.pairs.contacts, true, &sum);
    add_walls(c, true, &sum);
    return sum.contacts;
}
