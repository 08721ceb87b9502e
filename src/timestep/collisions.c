/* A stable step need not resolve a collision. Contacts of particles that were not bonded to each
 * other at the start must last a required number of steps, and the shortest contact limits the
 * step. Dense groups without dashpots need more steps. Contacts of bonded particles do not limit
 * the step, except in four cases: half of the required steps are needed on a wall that is stiffer
 * than the bonds, and where softening bonds open and close undamped; all of them are needed once
 * the specimen has disintegrated, and for wedged debris (debris.c). */
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/body_pairs.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "boundary/contact_rows.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "kernels/dashpot.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

double gn_timestep_contact_steps(const gn_step_context *ctx) {
    if (ctx->scene.contact_steps > 0.0) return ctx->scene.contact_steps;
    return ctx->effects & GN_FX_HERTZ ? GN_STEPS_PER_HERTZ : GN_STEPS_PER_CONTACT;
}

static bool loose(const gn_dem *dem, size_t p) {
    return dem->loose[dem->particles.id[p]];
}

/* Returns the inverse mass, 1/kg; 0 for a particle that cannot move. A particle that is held along
 * some axes only counts as free. */
static double inverse_mass(const gn_step_context *ctx, const gn_dem *dem, size_t p) {
    const gn_particles *q = &dem->particles;
    unsigned all = ctx->effects & GN_FX_SPACE ? 7 : 3;
    bool held =
        dem->prescribed.count && q->slot[p] >= 0 && (dem->prescribed.mask[q->slot[p]] & all) == all;
    return held ? 0.0 : q->vel[4 * p + 3];
}

/* Properties of particles that follow from their bonds. */
typedef struct ties {
    double *stiffest; /* N/m [particles]: the stiffest bond of each particle, broken or not; NULL:
                         there are no bonds */
    double *inverse;  /* 1/kg [particles]: inverse masses */
    bool apart;       /* most bonded particles have lost all of their bonds */
    uint8_t *wedged;  /* [particles] 1: debris whose collisions have to be resolved; NULL: none */
    double share; /* fraction of the required steps that contacts of bonded particles must last; 0:
                     stability suffices */
} ties;

/* A damaged bond is softer in tension than in compression, so that within an intact body any such
 * bond opens and closes like a contact at every oscillation. Partial steps are accurate up to (w
 * dt)^2 of 1/2, which half of the required steps ensure (0.4); at 0.9 of the limit of lattices
 * (1.4), the energy of a body that oscillates undamped was wrong by 2 to 15 %. Close packings have
 * that many steps anyway. */
static double share_of_bonds(const gn_step_context *ctx, const gn_dem *dem) {
    return ctx->effects & GN_FX_SOFTENING && gn_timestep_is_underdamped(ctx, dem) ? 0.5 : 0.0;
}

/* Marks in `adrift` the particles that have lost all or all but one of their bonds. Returns whether
 * most bonded particles have lost all. */
static bool come_apart(const gn_dem *dem, const double *stiffest, uint8_t *adrift) {
    size_t had = 0, lost = 0;
    gn_bonds_left(dem, adrift);
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        had += stiffest[p] > 0.0;
        lost += stiffest[p] > 0.0 && adrift[p] == 0;
        adrift[p] = stiffest[p] > 0.0 && adrift[p] < 2;
    }
    return 2 * lost >= had;
}

static void free_ties(ties *t) {
    gn_free(t->stiffest);
    gn_free(t->inverse);
    gn_free(t->wedged);
}

/* Sets the inverse masses. A particle of a zone yields to other particles as its nodes do; with its
 * own mass, which is small at the edge of the zone, contacts there would need vanishing steps.
 * Walls act on it with their whole stiffness, so that its contacts with them are checked with its
 * own mass. */
static void find_inverse(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                         const gn_zones *zones, double *inverse) {
    for (size_t p = 0; p < dem->particles.soa.count; p++) inverse[p] = inverse_mass(ctx, dem, p);
    gn_coupled_inverse_masses(ctx, dem, solids, zones, inverse);
}

static gneiss_status find_ties(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, const gn_zones *zones, ties *t,
                               gneiss_error *error) {
    const gn_contacts *b = &dem->bonds.contacts;
    size_t n = dem->particles.soa.count;
    *t = (ties){.share = share_of_bonds(ctx, dem)};
    GN_TRY(gn_new(&t->inverse, n + 1, "particles", error));
    find_inverse(ctx, dem, solids, zones, t->inverse);
    if (!b->soa.count) return GNEISS_OK;
    t->wedged = gn_alloc(n + 1);
    t->stiffest = gn_alloc_array(n, sizeof *t->stiffest);
    bool held = t->wedged && t->stiffest, any = false;
    for (size_t c = 0; held && c < b->soa.count; c++) {
        double kn = gn_contact_spring(dem, b, c).kn;
        t->stiffest[b->i[c]] = fmax(t->stiffest[b->i[c]], kn);
        t->stiffest[b->j[c]] = fmax(t->stiffest[b->j[c]], kn);
    }
    gneiss_status status = GNEISS_OK;
    if (!held)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for bonds of %zu particles", n);
    if (held) t->apart = come_apart(dem, t->stiffest, t->wedged);
    if (held && !t->apart) status = gn_wedged_find(ctx, dem, t->wedged, &any, error);
    if (!any) {
        gn_free(t->wedged);
        t->wedged = NULL;
    }
    if (status != GNEISS_OK) free_ties(t);
    return status;
}

/* Tells whether a particle is loose. All particles of a disintegrated specimen are. Until then
 * debris does not change the step: a smaller one changes the energy of bonded vibrations that the
 * step hardly resolves (a ledger that closed to 5 % was then wrong by 25 %), while collisions of
 * few debris particles change little. */
static bool is_loose(const gn_dem *dem, const ties *t, size_t p) {
    return t->apart || loose(dem, p) || (t->wedged && t->wedged[p]);
}

/* --- the shortest contact --- */

/* The contact that requires the smallest step so far: its w^2, the fraction of the required steps
 * that it must last, and its two ends; second < 0: see gn_resolution. */
typedef struct fastest {
    double square, share;
    int64_t first, second;
    double *factor; /* [particles] receives the factors of own masses with which w^2 is at most
                       `most`; NULL: not requested */
    double most;    /* 1/s2, largest w^2 of a contact that must last all required steps */
} fastest;

/* Raises the factors of both masses; if both are multiplied by x, w^2 is divided by x. */
static void ask_mass(const fastest *f, const gn_dem *dem, size_t p, double square) {
    const gn_particles *q = &dem->particles;
    f->factor[p] = fmax(f->factor[p], square / (f->most * q->own_share[p]));
}

static void consider(fastest *f, double square, double share, const gn_dem *dem, size_t p,
                     int64_t second) {
    if (f->factor) {
        ask_mass(f, dem, p, square * share * share);
        if (second >= 0) ask_mass(f, dem, (size_t)dem->index_of_id[second], square * share * share);
    }
    if (square * share * share <= f->square * f->share * f->share) return;
    f->square = square;
    f->share = share;
    f->first = dem->particles.id[p];
    f->second = second;
}

/* Steps are counted over half a period of the undamped contact. */
static gn_resolution resolution_of(const gn_step_context *ctx, const fastest *f) {
    double contact = M_PI / sqrt(f->square);
    double steps = f->share * gn_timestep_contact_steps(ctx);
    return (gn_resolution){contact / steps, contact, f->first, f->second};
}

/* Tells whether collisions are only slightly damped: the restitution c is 0.95 or more, so that the
 * errors of thousands of collisions add up. Non-viscous damping of coefficient a multiplies the
 * force by 1 + a during approach and by 1 - a during separation: c^2 = (1 - a)/(1 + a). */
bool gn_timestep_is_underdamped(const gn_step_context *ctx, const gn_dem *dem) {
    bool active = ctx->effects & (GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT);
    return dem->damping_least < 0.0163 && !(active && ctx->scene.background_coefficient > 0.051);
}

/* Tells whether a contact may open or close while other contacts of its particles are closed: its
 * gap or overlap is at most the path of the two in a collision. */
static bool rattles(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                    double square) {
    const double *a = dem->particles.pos + 4 * i, *b = dem->particles.pos + 4 * j;
    const double *v = dem->particles.vel + 4 * i, *u = dem->particles.vel + 4 * j;
    double d[3], gap = sqrt(gn_branch(ctx, a, b, d)) - a[3] - b[3];
    return fabs(gap) <= (sqrt(gn_dot3(v, v)) + sqrt(gn_dot3(u, u))) * M_PI / sqrt(square);
}

/* Computes for each particle the sum of k/m over the contacts that may open or close: with all of
 * them closed, it is the number of dimensions times the mean squared frequency. *sum is NULL if
 * collisions are damped. */
static gneiss_status find_crowds(const gn_step_context *ctx, const gn_dem *dem, const ties *t,
                                 double **sum, gneiss_error *error) {
    const gn_contacts *k = &dem->pairs.contacts;
    *sum = NULL;
    if (!gn_timestep_is_underdamped(ctx, dem) || !k->soa.count) return GNEISS_OK;
    GN_TRY(gn_new(sum, dem->particles.soa.count, "crowds", error));
    for (size_t c = 0; c < k->soa.count; c++) {
        size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        double kn = gn_contact_spring(dem, k, c).kn;
        double mine = kn * t->inverse[i], other = kn * t->inverse[j];
        if (!rattles(ctx, dem, i, j, mine + other)) continue;
        (*sum)[i] += mine;
        (*sum)[j] += other;
    }
    return GNEISS_OK;
}

/* Returns the factor on the number of steps of a contact in a group. The partial step of a contact
 * that opens or closes is computed as if the contact were alone; the error is of third order in y =
 * w dt, w the frequency of the whole group. Dense lattices without dashpots lost 30 % of their
 * energy after some thousand steps, and 4 % with this factor; 1 % would need three times as many
 * steps. */
static double share_in(const gn_step_context *ctx, const double *crowd, size_t i, size_t j,
                       double square) {
    if (!crowd) return 1.0;
    double together = (crowd[i] + crowd[j]) / (double)ctx->scene.dimension;
    return square > 0.0 && together > square ? sqrt(together / square) : 1.0;
}

static void consider_pairs(const gn_step_context *ctx, const gn_dem *dem, const ties *t,
                           const gn_contacts *k, const double *crowd, fastest *f) {
    for (size_t c = 0; c < k->soa.count; c++) {
        size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        bool free = !gn_contact_bonded(k, c) && (is_loose(dem, t, i) || is_loose(dem, t, j));
        if (!free && t->share == 0.0) continue;
        double square = gn_contact_spring(dem, k, c).kn * (t->inverse[i] + t->inverse[j]);
        double share = free ? share_in(ctx, crowd, i, j, square) : t->share;
        consider(f, square, share, dem, i, dem->particles.id[j]);
    }
}

/* Returns the fraction of the required steps that a contact with a wall or surface of this
 * stiffness must last. Bonded particles yield by their bonds, whose frequencies limit the step. In
 * a close packing, at 0.9 of the limit, a contact no stiffer than one bond lasts some 7 steps, 3 if
 * it is 4 times as stiff, and 2.5 if 7 times, with errors of 0.6 and 30 % in the energy of a body
 * that bounces. Half of the required steps keep the error within 0.2 %. Platens (passive walls)
 * mostly stay in contact, and three steps are enough for late or single contacts; with two and a
 * half a gently loaded specimen became unstable. */
static double share_with(const gn_dem *dem, const ties *t, size_t p, double stiffness,
                         bool platen) {
    if (is_loose(dem, t, p)) return 1.0;
    double bond = t->stiffest ? t->stiffest[p] : 0.0;
    return bond > 0.0 && stiffness > bond ? (platen ? 0.32 : 0.5) : platen ? 0.0 : t->share;
}

/* Returns the inverse mass, 1/kg, that a surface adds at the contact of a particle. */
static double give(const gn_dem *dem, const gn_boundary *boundary, const gn_surface_contact *c) {
    const gn_surface *s = c->surface;
    double sum = 0.0, at[3], lever[3];
    if (s->body < 0) {
        for (int v = 0; v < c->parts; v++)
            sum +=
                c->weight[v] * c->weight[v] * gn_vertex_inverse_mass(s, c->vertex[v], c->contact.n);
        return sum;
    }
    const gn_rigid *b = &boundary->bodies[s->body];
    const double *x = dem->particles.pos + 4 * c->particle, *n = c->contact.n;
    for (int a = 0; a < 3; a++) {
        at[a] = x[a] + c->contact.arm[a] - b->position[a];
        sum += n[a] * n[a] * b->inverse_mass[a];
    }
    gn_cross3(at, n, lever);
    return sum + gn_rigid_compliance(b, lever);
}

static int64_t surface_number(const gn_step_context *ctx, const gn_boundary *boundary,
                              const gn_surface *s) {
    return -1 - (int64_t)ctx->scene.wall_count - (s - boundary->surfaces);
}

/* Returns the largest stiffness of a contact with a wall or a surface before the lists are rebuilt.
 */
static gn_law_spring wall_spring(const gn_step_context *ctx, const gn_dem *dem, size_t p,
                                 size_t wall) {
    gn_touch_side side = gn_wall_side(ctx, dem, wall, p);
    return gn_touch_spring(ctx, dem, &side, inverse_mass(ctx, dem, p),
                           gn_touch_reach(ctx, dem, p, 0.0));
}
static gn_law_spring surface_spring(const gn_step_context *ctx, const gn_dem *dem, size_t p,
                                    const gn_surface *s) {
    gn_touch_side side = gn_surface_side(ctx, dem, s, p, 1.0);
    return gn_touch_spring(ctx, dem, &side, inverse_mass(ctx, dem, p),
                           gn_touch_reach(ctx, dem, p, 0.0));
}

/* Considers the contacts of one particle with the facets of a surface, from row c; returns the row
 * after them. */
static size_t consider_surface(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const ties *t, size_t c, fastest *f) {
    size_t p = (size_t)boundary->contacts.i[c], many = 0;
    const gn_surface *s = gn_surface_of_row(ctx, boundary, c);
    double inverse = inverse_mass(ctx, dem, p), kn = surface_spring(ctx, dem, p, s).kn;
    double share = share_with(dem, t, p, kn, false);
    if (share == 0.0) return c + 1;
    if (!gn_surface_yields(boundary, s)) {
        consider(f, kn * inverse, share, dem, p, surface_number(ctx, boundary, s));
        return c + 1;
    }
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    c = gn_surface_contacts_at(ctx, dem, boundary, c, dem->verlet.skin, found, &many);
    for (size_t m = 0; m < many; m++) {
        double square = kn * (inverse + give(dem, boundary, &found[m]));
        consider(f, square, share, dem, p, surface_number(ctx, boundary, s));
    }
    return c;
}

static void consider_walls(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const ties *t, fastest *f) {
    const gn_wall_contacts *k = &boundary->contacts;
    for (size_t c = 0; ctx->effects & GN_FX_WALLS && c < k->soa.count;) {
        if ((size_t)k->wall[c] >= ctx->scene.wall_count) {
            c = consider_surface(ctx, dem, boundary, t, c, f);
            continue;
        }
        const gn_wall_def *def = &ctx->scene.walls[k->wall[c]];
        size_t p = (size_t)k->i[c];
        double kn = wall_spring(ctx, dem, p, (size_t)k->wall[c]).kn,
               share = share_with(dem, t, p, kn, def->passive);
        kn += gn_boundary_held_stiffness(boundary, p); /* wall and spring act together */
        consider(f, kn * inverse_mass(ctx, dem, p), share, dem, p, -1 - (int64_t)k->wall[c]);
        c++;
    }
}

/* Factor on the required steps for a rotating body. Its lever arms change while it is pressed, so
 * that the works of a step differ from the energy of the springs by force times path times a
 * quarter of the rotation. A body that separates with another spin than that of its approach keeps
 * some of that error: with ten steps per contact the energy of 18 of 140 random bodies on walls was
 * wrong by 0.1 to 0.8 %, with forty that of none. For two bodies the bound is two to four times
 * their frequency, but friction between sliding and rotating bodies lost 0.1 % with 1.5 times the
 * steps: they get 2.5 times. */
static double share_of_turning(const gn_boundary *boundary, size_t body) {
    const gn_rigid *b = &boundary->bodies[body];
    double give = b->inverse_inertia[0] + b->inverse_inertia[1] + b->inverse_inertia[2];
    return give > 0.0 ? 4.0 : 1.0;
}

/* Considers contacts of bodies with walls and with each other; masses of bodies are not raised. */
static void consider_bodies(const gn_step_context *ctx, const gn_boundary *boundary, fastest *f) {
    for (size_t c = 0; !f->factor && c < boundary->body_contacts.soa.count;) {
        gn_body_wall k = gn_body_wall_at(ctx, boundary, c);
        double square = gn_body_walls_square(ctx, boundary, &c),
               share = share_of_turning(boundary, k.body);
        if (square * share * share <= f->square * f->share * f->share) continue;
        f->square = square;
        f->share = share;
        f->first = -1 - (int64_t)k.body;
        f->second = -1 - (int64_t)k.wall;
    }
    const gn_body_pairs *p = &boundary->pairs;
    for (size_t c = 0; !f->factor && c < p->count; c++) {
        size_t a = (size_t)p->pair[c].first, b = (size_t)p->pair[c].second;
        double square = gn_body_pair_square(ctx, boundary, a, b), share = 2.5;
        if (square * share * share <= f->square * f->share * f->share) continue;
        f->square = square;
        f->share = share;
        f->first = -1 - (int64_t)a;
        f->second = -1 - (int64_t)(ctx->scene.wall_count + b);
    }
}

static gneiss_status consider_listed(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids,
                                     const gn_zones *zones, fastest *f, gneiss_error *error) {
    double *crowd = NULL;
    ties t;
    GN_TRY(find_ties(ctx, dem, solids, zones, &t, error));
    gneiss_status status = find_crowds(ctx, dem, &t, &crowd, error);
    if (status == GNEISS_OK) {
        consider_pairs(ctx, dem, &t, &dem->pairs.contacts, crowd, f);
        if (t.apart || t.share > 0.0 || t.wedged)
            consider_pairs(ctx, dem, &t, &dem->bonds.contacts, crowd, f);
        consider_walls(ctx, dem, boundary, &t, f);
        consider_bodies(ctx, boundary, f);
    }
    gn_free(crowd);
    free_ties(&t);
    return status;
}

gneiss_status gn_resolution_listed(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, gn_resolution *resolution,
                                   gneiss_error *error) {
    fastest f = {0.0, 1.0, -1, -1, NULL, 0.0};
    GN_TRY(consider_listed(ctx, dem, boundary, solids, zones, &f, error));
    *resolution = resolution_of(ctx, &f);
    return GNEISS_OK;
}

gneiss_status gn_resolution_masses(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, double step, double *factor,
                                   gneiss_error *error) {
    double wave = M_PI / (gn_timestep_contact_steps(ctx) * step);
    fastest f = {0.0, 1.0, -1, -1, factor, wave * wave};
    return consider_listed(ctx, dem, boundary, solids, zones, &f, error);
}

/* --- pairs of the whole scene --- */

/* The smallest two and the largest two particles of a class (material, loose, held). For a given
 * partner w^2 = k (1/m_i + 1/m_j) has its maximum at the least or the greatest radius, which every
 * law must ensure (gn_law.meeting). The extremes of two classes therefore contain the pair with the
 * largest w^2; two particles of each kind are kept, so that the pair consists of distinct
 * particles. */
typedef struct extremes {
    size_t count, place[4]; /* indices of the two smallest and the two largest */
} extremes;

static double radius(const gn_dem *dem, size_t p) {
    return dem->particles.pos[4 * p + 3];
}

static void keep_extremes(const gn_dem *dem, extremes *e, size_t p) {
    double r = radius(dem, p);
    if (e->count < 4) {
        size_t at = e->count++;
        for (; at > 0 && radius(dem, e->place[at - 1]) > r; at--) e->place[at] = e->place[at - 1];
        e->place[at] = p;
        return;
    }
    if (r < radius(dem, e->place[1])) {
        bool first = r < radius(dem, e->place[0]);
        e->place[1] = first ? e->place[0] : p;
        if (first) e->place[0] = p;
    } else if (r > radius(dem, e->place[2])) {
        bool last = r > radius(dem, e->place[3]);
        e->place[2] = last ? e->place[3] : p;
        if (last) e->place[3] = p;
    }
}

/* Largest w^2 of a pair with the dashpot, and of shear and rolling without it. */
typedef struct flight {
    double normal, shear;
    fastest resolved;
} flight;

/* Returns the velocity v + w x arm at the contact per unit of force across the normal: 1/m + r^2/I.
 */
static double inverse_across(const gn_step_context *ctx, const gn_dem *dem, size_t p) {
    const gn_particles *q = &dem->particles;
    double r = radius(dem, p);
    unsigned spins = ctx->effects & GN_FX_SPACE ? 0x38 : 0x20;
    bool held = dem->prescribed.count && q->slot[p] >= 0 &&
                (dem->prescribed.mask[q->slot[p]] & spins) == spins;
    return inverse_mass(ctx, dem, p) + (q->spin && !held ? r * r * q->spin[4 * p + 3] : 0.0);
}

static void flight_of_pair(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                           flight *f) {
    gn_law_spring c = gn_pair_spring(ctx, dem, (int32_t)i, (int32_t)j);
    double square = c.kn * (inverse_mass(ctx, dem, i) + inverse_mass(ctx, dem, j));
    f->normal = fmax(f->normal, square);
    if (ctx->effects & GN_FX_SHEAR)
        f->shear =
            fmax(f->shear, c.kt * (inverse_across(ctx, dem, i) + inverse_across(ctx, dem, j)));
    if (loose(dem, i) || loose(dem, j))
        consider(&f->resolved, square, 1.0, dem, i, dem->particles.id[j]);
}

static void flight_of_pairs(const gn_step_context *ctx, const gn_dem *dem, const extremes *classes,
                            size_t count, flight *f) {
    for (size_t a = 0; a < count; a++)
        for (size_t b = a; b < count; b++)
            for (size_t i = 0; i < classes[a].count; i++)
                for (size_t j = a == b ? i + 1 : 0; j < classes[b].count; j++)
                    flight_of_pair(ctx, dem, classes[a].place[i], classes[b].place[j], f);
}

static void flight_of_walls(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, size_t p, flight *f) {
    double inverse = inverse_mass(ctx, dem, p);
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        gn_law_spring c = wall_spring(ctx, dem, p, k);
        f->normal = fmax(f->normal, c.kn * inverse);
        f->shear = fmax(f->shear, c.kt * inverse_across(ctx, dem, p));
        if (loose(dem, p)) consider(&f->resolved, c.kn * inverse, 1.0, dem, p, -1 - (int64_t)k);
    }
    for (size_t k = 0; k < boundary->surface_count; k++) {
        const gn_surface *s = &boundary->surfaces[k];
        gn_law_spring c = surface_spring(ctx, dem, p, s);
        double square = c.kn * (inverse + gn_surface_give(boundary, s));
        f->normal = fmax(f->normal, square);
        f->shear = fmax(f->shear, c.kt * inverse_across(ctx, dem, p));
        if (loose(dem, p))
            consider(&f->resolved, square, 1.0, dem, p, surface_number(ctx, boundary, s));
    }
}

static gneiss_status find_flight(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, flight *f, gneiss_error *error) {
    size_t count = 4 * ctx->scene.material_count;
    extremes *classes = NULL;
    GN_TRY(gn_new(&classes, count + 1, "classes", error));
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        if (!gn_particle_is_active(&dem->particles, p)) continue;
        size_t held = inverse_mass(ctx, dem, p) == 0.0, kind = 2 * held + loose(dem, p);
        keep_extremes(dem, &classes[4 * (size_t)dem->particles.material[p] + kind], p);
        if (!held) flight_of_walls(ctx, dem, boundary, p, f);
    }
    flight_of_pairs(ctx, dem, classes, count, f);
    /* A single particle is combined with an equal one, so that there is a step. */
    for (size_t p = 0; f->normal == 0.0 && p < dem->particles.soa.count; p++)
        f->normal =
            2.0 * gn_pair_spring(ctx, dem, (int32_t)p, (int32_t)p).kn * inverse_mass(ctx, dem, p);
    if (f->normal == 0.0)
        f->normal = fmax(gn_body_walls_bound(ctx, boundary), gn_body_pairs_bound(ctx, boundary));
    gn_free(classes);
    return GNEISS_OK;
}

gneiss_status gn_flight_limits(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, double *stable,
                               gn_resolution *resolution, gneiss_error *error) {
    flight f = {.resolved = {0.0, 1.0, -1, -1, NULL, 0.0}};
    GN_TRY(find_flight(ctx, dem, boundary, &f, error));
    double alpha = dem->damping_fraction / gn_nonviscous_share(ctx);
    *stable = fmin(2.0 / sqrt(f.normal) * (sqrt(1.0 + alpha * alpha) - alpha), 2.0 / sqrt(f.shear));
    *resolution = resolution_of(ctx, &f.resolved);
    return GNEISS_OK;
}

/* --- text --- */

const char *gn_resolution_text(const gn_step_context *ctx, char *text, size_t size) {
    const gn_resolution *r = &ctx->choice.resolution;
    int64_t walls = (int64_t)ctx->scene.wall_count, bodies = (int64_t)ctx->scene.body_count,
            k = -1 - r->second;
    if (r->first < 0 && (-1 - r->first >= bodies || k < 0 || k >= walls + bodies))
        snprintf(text, size, "nothing that has a name"); /* none, or read from a file */
    else if (r->first < 0 && k >= walls)
        snprintf(text, size, "bodies '%.60s' and '%.60s'", ctx->scene.bodies[-1 - r->first].name,
                 ctx->scene.bodies[k - walls].name);
    else if (r->first < 0)
        snprintf(text, size, "body '%.60s' and wall '%.60s'", ctx->scene.bodies[-1 - r->first].name,
                 ctx->scene.walls[k].name);
    else if (r->second >= 0)
        snprintf(text, size, "particles %lld and %lld", (long long)r->first, (long long)r->second);
    else if (k < walls)
        snprintf(text, size, "particle %lld and wall '%.60s'", (long long)r->first,
                 ctx->scene.walls[k].name);
    else if (k - walls < bodies)
        snprintf(text, size, "particle %lld and body '%.60s'", (long long)r->first,
                 ctx->scene.bodies[k - walls].name);
    else
        snprintf(text, size, "particle %lld and the finite elements", (long long)r->first);
    return text;
}
