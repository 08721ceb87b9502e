/* Energy of the springs and elements that a conversion changes, before and after it; all others
 * would only add the rounding of large sums. Leap-frog conserves 1/2 v(-) M v(+) plus the energy of
 * springs at the instant; the first term is 1/2 v(-) M v(-) plus half a step of the power of all
 * forces at v(-). Between two steps tangential forces are those of the instant before; the coming
 * step adds the increment of the last interval. The power at driven nodes is not part of the
 * conserved sum, but of the work of their reactions. The work of the interval before the conversion
 * is computed with the mean of the reactions at its two ends, the later of which is evaluated after
 * the conversion: the jump of the reactions causes an error of half a step of its power. */
#include "base/ball.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "conversion/conversion_private.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/lists.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* Advances the tangential force of a contact to the instant, N, and computes the rate at which its
 * ends separate, m/s. */
static void advance_shear(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                          size_t c, double length, const double n[3], const double shear[3],
                          double now[3], double rate[3]) {
    gn_contact_rate(ctx, dem, list->i[c], list->j[c], length, n, rate);
    const double kt = list->kt ? list->kt[c] : 0.0, along = gn_dot3(rate, n);
    for (int a = 0; a < 3; a++) now[a] = shear[a] + kt * ctx->dt_past * (rate[a] - along * n[a]);
}

/* Open contacts have no force, and sliding contacts have at most the force of their limit. */
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

/* Tells whether the conversion changes the weight of a particle or releases it. */
static bool is_other(const gn_conversion *conversion, int32_t p) {
    const size_t k = 2 * (size_t)p;
    const double *part = conversion->model->dem->particles.blend;
    return conversion->freed[p] || part[k] != conversion->part[k] ||
           part[k + 1] != conversion->part[k + 1];
}

static void add_contacts(const gn_conversion *conversion, const gn_contacts *list, bool other,
                         gn_held *sum) {
    const gn_convertible *model = conversion->model;
    const gn_contacts *bonds = &model->dem->bonds.contacts;
    for (size_t k = 0; k < list->soa.count; k++) {
        const int32_t i = list->i[k], j = list->j[k];
        if ((is_other(conversion, i) || is_other(conversion, j)) != other) continue;
        const size_t at = list == bonds ? 0 : gn_contacts_from(bonds, i, j);
        const bool known =
            list != bonds && at < bonds->soa.count && bonds->i[at] == i && bonds->j[at] == j;
        if (!known) add_contact(model->ctx, model->dem, list, k, sum);
    }
}

/* Adds the springs of walls at particles that relaxation moves. Contacts with bodies keep their
 * energy where particles do not move. */
static void add_walls(const gn_conversion *conversion, bool other, gn_held *sum) {
    const gn_wall_contacts *q = &conversion->model->boundary->contacts;
    const size_t walls = conversion->model->ctx->scene.wall_count;
    for (size_t k = 0; walls && k < q->soa.count; k++)
        if ((size_t)q->wall[k] < walls && is_other(conversion, q->i[k]) == other)
            sum->contacts += gn_wall_held(conversion->model->ctx, conversion->model->dem,
                                          conversion->model->boundary, k);
}

/* Adds the elements that the conversion changes, or the other remaining ones; scratch:
 * conversion->some. */
static void add_elements(const gn_conversion *conversion, bool touched, gn_held *sum) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const double half = 0.5 * conversion->model->ctx->dt_past;
    size_t count = 0;
    for (size_t e = 0; e < b->elements.soa.count; e++)
        if (conversion->touched[conversion->place[b->elements.id[e]]] == touched)
            conversion->some[count++] = (int32_t)e;
    /* The power times half a step is found as half the difference of the energies half a step
     * before and after. */
    sum->elements += gn_fem_elastic_energy(b, conversion->some, count, 0.0);
    sum->step += 0.5 * (gn_fem_elastic_energy(b, conversion->some, count, -half) -
                        gn_fem_elastic_energy(b, conversion->some, count, half));
}

static gn_held held(const gn_conversion *conversion, bool changes) {
    gn_held sum = {0};
    add_elements(conversion, changes, &sum);
    add_contacts(conversion, &conversion->model->dem->bonds.contacts, changes, &sum);
    add_contacts(conversion, &conversion->model->dem->pairs.contacts, changes, &sum);
    add_walls(conversion, changes, &sum);
    return sum;
}

gn_held gn_conversion_held(const gn_conversion *conversion) {
    return held(conversion, true);
}

double gn_conversion_held_beside(const gn_conversion *conversion) {
    const gn_held beside = held(conversion, false);
    return gn_held_sum(&beside);
}

double gn_conversion_held_in_contacts(const gn_conversion *conversion) {
    gn_held sum = {0};
    add_contacts(conversion, &conversion->model->dem->bonds.contacts, true, &sum);
    add_contacts(conversion, &conversion->model->dem->pairs.contacts, true, &sum);
    add_walls(conversion, true, &sum);
    return sum.contacts;
}

/* --- parts of the booked energy --- */

/* Energy that a conversion books, by cause. Between the elements that lose weight and the springs
 * that gain it is the energy that both would have in an even strain. Parts are differences between
 * successive states, so that they add up to the booked energy exactly.
 *
 * With dw_p the weight that particle p gains, V_p its part of the specimen's volume, W_e the energy
 * density of its element and w_b(F) the energy of bond b if both ends move with the gradient F of
 * the element of p:
 *     sampled    loss of elements                   - sum_p dw_p V_p W_e
 *     stiffness  sum_p dw_p V_p W_e                 - sum_p dw_p sum_b 1/2 w_b(F_p)
 *     uneven     sum_p dw_p sum_b 1/2 w_b(F_p)      - gain of contacts
 *     balance    loss of contacts by the relaxation of released particles
 * The other parts are kinetic energy, and half a step of the power of springs (above), with the
 * effect of new velocities on forces across contacts, which are half a step behind.
 */
/* Returns the increase of the weight of a particle; 0 outside of elements. */
static double taken_by(const gn_conversion *conversion, size_t p) {
    return gn_home_of(conversion, p) < 0
               ? 0.0
               : conversion->model->dem->particles.blend[2 * p] - conversion->part[2 * p];
}

/* F and R of the elements of the last queries; bonds of a particle are adjacent in the list. */
typedef struct gradients {
    int32_t element;
    double f[3][3], turn[3][3];
} gradients;

static void gradient_at(const gn_conversion *conversion, size_t p, gradients *g) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const int32_t e = gn_home_of(conversion, p);
    if (g->element == e) return;
    g->element = e;
    gn_fem_gradient_of(b, (size_t)e, g->f);
    gn_fem_rotation(b, (size_t)e, g->turn);
}

/* Returns the energy, J, of a bond of full weight if both of its ends moved with an element (see
 * conversion_contacts.c). */
static double bond_energy(const gn_conversion *conversion, size_t k, const gradients *g) {
    const gn_contacts *all = &conversion->model->dem->prepared;
    const double *start = conversion->model->dem->particles.start;
    double l[3], d[3] = {0.0}, slip[3], along = 0.0;
    const double rest = sqrt(gn_branch(conversion->model->ctx, start + 4 * (size_t)all->i[k],
                                       start + 4 * (size_t)all->j[k], l));
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

static double springs_alike(const gn_conversion *conversion) {
    const gn_contacts *all = &conversion->model->dem->prepared;
    gradients g[2] = {{.element = -1}, {.element = -1}};
    double sum = 0.0;
    for (size_t k = 0; k < all->soa.count; k++)
        for (int end = 0; end < 2; end++) {
            const size_t p = (size_t)(end ? all->j[k] : all->i[k]);
            const double taken = taken_by(conversion, p);
            if (taken == 0.0) continue;
            gradient_at(conversion, p, &g[end]);
            sum += 0.5 * taken * bond_energy(conversion, k, &g[end]);
        }
    return sum;
}

static double elements_alike(const gn_conversion *conversion) {
    const gn_convertible *model = conversion->model;
    const gn_fem_solid *b = gn_coupled_solid(model->solids);
    const double solid = 1.0 - gn_dem_porosity(model->ctx, model->dem);
    double sum = 0.0;
    for (size_t p = 0; p < model->dem->particles.soa.count; p++) {
        const double taken = taken_by(conversion, p);
        if (taken == 0.0) continue;
        sum += taken * gn_ball_volume(b->dimension, model->dem->particles.pos[4 * p + 3]) / solid *
               gn_fem_energy_density(b, (size_t)gn_home_of(conversion, p));
    }
    return sum;
}

void gn_conversion_find_alike(const gn_conversion *conversion, double alike[2]) {
    alike[0] = elements_alike(conversion);
    alike[1] = springs_alike(conversion);
}

void gn_conversion_book(gn_conversions *converted, gn_ledger *ledger, const gn_held_stages *held,
                        double kinetic) {
    gn_conversion_parts *parts = &converted->parts;
    const double *alike = held->alike;
    parts->sampled += held->before.elements - held->after.elements - alike[0];
    parts->stiffness += alike[0] - alike[1];
    parts->uneven += alike[1] - (held->released[0] - held->before.contacts);
    parts->balance += held->released[0] - held->released[1];
    parts->motion += kinetic;
    parts->step += held->released[1] - held->after.contacts + held->before.step - held->after.step;
    parts->alike[0] += alike[0];
    parts->alike[1] += alike[1];
    converted->corrected.energy += kinetic;
    ledger->energy.conversion += kinetic + gn_held_sum(&held->before) - gn_held_sum(&held->after);
}
