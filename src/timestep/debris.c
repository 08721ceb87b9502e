/* Debris that is wedged: a particle whose bonds have all broken, between others that it meets in
 * turns. A contact that opens or closes gets its part of the step as if it were alone
 * (gn_linear_cross). Where another one presses with F meanwhile, the path p of the next step is
 * another by F dt^2/m than that part was made for, and the works miss
 *
 *     dE = 1/4 s (1 - s) y^2 p F,   y = w dt,   1/24 y^2 p F in the mean over the share s,
 *
 * of the same sign whenever what presses is on the other side: it gains in every opening and every
 * closing, in a slot the faster the more it has. A light particle has the largest y of all (a
 * stable step allows 1.27 on either side), and hands what it gains on to the neighbours. At ten
 * steps a contact, y = 0.31, that is some 40 times less than at y = 1.
 *
 * Most debris flies free or lies still and costs nothing at the step as it is. So the ledger is
 * asked first: only where it misses more than TOLD of what has gone through while such a particle
 * collides with energy that can be the reason its contacts are resolved as those of loose particles
 * are. */
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "frame/ledger.h"
#include "frame/step_context.h"
#include "measure/energy.h"
#include "particles/dem.h"
#include "particles/law.h"
#include "soa/records.h"
#include "timestep/step_limit.h"
#include "timestep/timestep_private.h"

#include <math.h>

static const double TOLD = 3e-5;

/* Of what the bonds of the scene hold before they break: with less a particle is left alone. What
 * it may gain until it is looked at again is some tens of times its own energy. */
static const double MATTERS = 1e-6;

/* J: of normal springs at their strength, broken ones as well, so that the measure stays. */
static double held_at_most(const gn_dem *dem) {
    const gn_contacts *b = &dem->bonds.contacts;
    double sum = 0.0;
    for (size_t c = 0; c < b->soa.count; c++) {
        const double kn = gn_contact_spring(dem, b, c).kn;
        if (kn > 0.0) sum += 0.5 * b->rn[c] * b->rn[c] / kn;
    }
    return sum;
}

/* What is asked of a contact without a bond. */
typedef struct meeting {
    bool near;     /* pressed, or open by no more than the two move in a collision */
    double energy; /* J: kinetic, of one towards the other */
} meeting;

static meeting meet(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *k, size_t c) {
    const size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
    const double *a = dem->particles.pos + 4 * i, *b = dem->particles.pos + 4 * j;
    const double *v = dem->particles.vel + 4 * i, *u = dem->particles.vel + 4 * j;
    const double kn = gn_contact_spring(dem, k, c).kn, give = v[3] + u[3];
    double d[3], apart[3] = {v[0] - u[0], v[1] - u[1], v[2] - u[2]};
    if (!(kn * give > 0.0)) return (meeting){0};
    const double gap = sqrt(gn_branch(ctx, a, b, d)) - a[3] - b[3], speed2 = gn_dot3(apart, apart);
    return (meeting){gap <= M_PI * sqrt(speed2 / (kn * give)), 0.5 * speed2 / give};
}

/* What is near a particle. */
typedef struct slot {
    int sides;     /* contacts that are near */
    double energy; /* J, the largest */
} slot;

static void look(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *k,
                 const uint8_t *adrift, slot *of) {
    for (size_t c = 0; c < k->soa.count; c++) {
        const size_t ends[2] = {(size_t)k->i[c], (size_t)k->j[c]};
        if (!adrift[ends[0]] && !adrift[ends[1]]) continue;
        const meeting m = meet(ctx, dem, k, c);
        for (int e = 0; m.near && e < 2; e++) {
            of[ends[e]].sides++;
            of[ends[e]].energy = fmax(of[ends[e]].energy, m.energy);
        }
    }
}

void gn_bonds_left(const gn_dem *dem, uint8_t *left) {
    const gn_contacts *b = &dem->bonds.contacts;
    for (size_t c = 0; c < b->soa.count; c++) {
        if (!gn_contact_bonded(b, c)) continue;
        left[b->i[c]] = (uint8_t)(left[b->i[c]] > 0 ? 2 : 1);
        left[b->j[c]] = (uint8_t)(left[b->j[c]] > 0 ? 2 : 1);
    }
}

static int64_t broken(const gn_dem *dem) {
    return dem->broken_tension + dem->broken_shear;
}

gneiss_status gn_debris_find(const gn_step_context *ctx, gn_dem *dem, bool *some,
                             gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    *some = false;
    if (broken(dem) == dem->broken_without_debris || ctx->scene.step > 0.0 ||
        !gn_world_rings(ctx, dem))
        return GNEISS_OK;
    uint8_t *left = gn_alloc(n + 1);
    if (!left) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    gn_bonds_left(dem, left);
    for (size_t p = 0; p < n && !*some; p++) *some = left[p] < 2 && dem->particles.bonds0[p] > 0;
    gn_free(left);
    if (!*some) dem->broken_without_debris = broken(dem);
    return GNEISS_OK;
}

bool gn_debris_suspected(const gn_ledger *ledger) {
    const gn_energy *e = &ledger->reading;
    return fabs(gn_energy_residual(e)) * gn_energy_scale(e) > TOLD * gn_energy_throughput(e);
}

gneiss_status gn_wedged_find(const gn_step_context *ctx, const gn_dem *dem, uint8_t *adrift,
                             bool *any, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    bool some = false;
    *any = false;
    for (size_t p = 0; p < n && !some; p++) some = adrift[p];
    if (!some || !dem->debris_suspected) return GNEISS_OK;
    const double least = MATTERS * held_at_most(dem);
    if (!(least > 0.0 && least < INFINITY)) return GNEISS_OK;
    slot *of = gn_alloc_array(n + 1, sizeof *of);
    if (!of) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    look(ctx, dem, &dem->pairs.contacts, adrift, of);
    look(ctx, dem, &dem->bonds.contacts, adrift, of);
    for (size_t p = 0; p < n; p++) {
        adrift[p] = adrift[p] && of[p].sides > 1 && of[p].energy >= least;
        *any |= adrift[p];
    }
    gn_free(of);
    return GNEISS_OK;
}
