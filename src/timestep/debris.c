/* Wedged debris: a particle without intact bonds, between others that it touches alternately. The
 * partial step of a contact that opens or closes is computed as if the contact were alone
 * (gn_linear_cross). If another contact meanwhile presses with F, the path p of the next step
 * differs by F dt^2/m from the assumed one, and the works miss dE = 1/4 s (1 - s) y^2 p F, y = w
 * dt, or 1/24 y^2 p F averaged over the fraction s. The sign is always the same if the other
 * contact is on the opposite side: between two neighbours the energy grows at every opening and
 * closing, and the faster the larger it is. A light particle has the largest y of all (a stable
 * step allows 1.27 on either side) and passes its gain on to the neighbours. At ten steps per
 * contact, y = 0.31, the gain is some 40 times less than at y = 1. Most debris is in free flight or
 * at rest and needs no smaller step. The ledger is therefore checked first: contacts of such a
 * particle are resolved like those of loose particles only if the residual exceeds LEDGER_ERROR of
 * the throughput while the particle collides with a relevant energy. */
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "soa/records.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"

#include <math.h>

static const double LEDGER_ERROR = 3e-5;

/* Ratio of a particle's energy to that of all bonds at their strength below which it is ignored;
 * until the next check the energy may grow by some tens of times. */
static const double MATTERS = 1e-6;

/* Returns the energy, J, of all normal springs at their strength, including those of broken bonds,
 * so that the measure stays constant. */
static double held_at_most(const gn_dem *dem) {
    const gn_contacts *b = &dem->bonds.contacts;
    double sum = 0.0;
    for (size_t c = 0; c < b->soa.count; c++) {
        const double kn = gn_contact_spring(dem, b, c).kn;
        if (kn > 0.0) sum += 0.5 * b->rn[c] * b->rn[c] / kn;
    }
    return sum;
}

/* A contact without a bond. */
typedef struct encounter {
    bool near;     /* closed, or open by no more than the path of the two in a collision */
    double energy; /* J: kinetic energy of the relative motion */
} encounter;

static encounter encounter_of(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *k,
                              size_t c) {
    const size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
    const double *a = dem->particles.pos + 4 * i, *b = dem->particles.pos + 4 * j;
    const double *v = dem->particles.vel + 4 * i, *u = dem->particles.vel + 4 * j;
    const double kn = gn_contact_spring(dem, k, c).kn, give = v[3] + u[3];
    double d[3], apart[3] = {v[0] - u[0], v[1] - u[1], v[2] - u[2]};
    if (!(kn * give > 0.0)) return (encounter){0};
    const double gap = sqrt(gn_branch(ctx, a, b, d)) - a[3] - b[3], speed2 = gn_dot3(apart, apart);
    return (encounter){gap <= M_PI * sqrt(speed2 / (kn * give)), 0.5 * speed2 / give};
}

/* Contacts near a particle. */
typedef struct surroundings {
    int sides;     /* number of near contacts */
    double energy; /* J, largest energy of one of them */
} surroundings;

static void find_surroundings(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *k,
                              const uint8_t *adrift, surroundings *of) {
    for (size_t c = 0; c < k->soa.count; c++) {
        const size_t ends[2] = {(size_t)k->i[c], (size_t)k->j[c]};
        if (!adrift[ends[0]] && !adrift[ends[1]]) continue;
        const encounter m = encounter_of(ctx, dem, k, c);
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

gneiss_status gn_debris_find(gn_step_context *ctx, gn_dem *dem, bool *some, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    *some = false;
    if (broken(dem) == ctx->choice.broken_without_debris || ctx->scene.step > 0.0 ||
        !gn_timestep_is_underdamped(ctx, dem))
        return GNEISS_OK;
    gn_ranks_whole(ctx->ranks);
    uint8_t *left = gn_alloc(n + 1);
    if (!left) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    gn_bonds_left(dem, left);
    for (size_t p = 0; p < n && !*some; p++) *some = left[p] < 2 && dem->particles.bonds0[p] > 0;
    gn_free(left);
    if (!*some) ctx->choice.broken_without_debris = broken(dem);
    return GNEISS_OK;
}

bool gn_debris_exceeds_ledger(const gn_ledger *ledger) {
    const gn_energy *e = &ledger->reading;
    return fabs(gn_energy_residual(e)) * gn_energy_scale(e) >
           LEDGER_ERROR * gn_energy_throughput(e);
}

gneiss_status gn_wedged_find(const gn_step_context *ctx, const gn_dem *dem, uint8_t *adrift,
                             bool *any, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    bool some = false;
    *any = false;
    for (size_t p = 0; p < n && !some; p++) some = adrift[p];
    if (!some || !ctx->choice.debris_reported) return GNEISS_OK;
    const double least = MATTERS * held_at_most(dem);
    if (!(least > 0.0 && least < INFINITY)) return GNEISS_OK;
    surroundings *of = NULL;
    GN_TRY(gn_new(&of, n + 1, "particles", error));
    find_surroundings(ctx, dem, &dem->pairs.contacts, adrift, of);
    find_surroundings(ctx, dem, &dem->bonds.contacts, adrift, of);
    for (size_t p = 0; p < n; p++) {
        adrift[p] = adrift[p] && of[p].sides > 1 && of[p].energy >= least;
        *any |= adrift[p];
    }
    gn_free(of);
    return GNEISS_OK;
}
