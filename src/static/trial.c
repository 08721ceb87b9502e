#include "static/trial.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/balance.h"
#include "frame/frame.h"
#include "limit/equilibrium.h"
#include "particles/active_pairs.h"
#include "particles/particles.h"
#include "soa/field.h"
#include "soa/records.h"
#include "soa/single.h"
#include "timestep/timestep.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

enum { N = GN_COMPONENTS };

/* --- create, free --- */

static gneiss_status allocate(gn_trial *t, gneiss_error *error) {
    size_t walls = t->world->ctx.scene.wall_count;
    t->pos = gn_alloc_array(t->count + 1, 4 * sizeof *t->pos);
    t->load = gn_alloc_array(t->count + 1, N * sizeof *t->load);
    t->supplied = gn_alloc_array(t->world->dem.prescribed.count + 1, N * sizeof *t->supplied);
    t->wall = gn_alloc_array(walls + 1, sizeof *t->wall);
    t->wall_force = gn_alloc_array(walls + 1, sizeof *t->wall_force);
    if (t->pos && t->load && t->supplied && t->wall && t->wall_force) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the equilibrium of %zu particles",
                   t->count);
}

static void free_lists(gn_trial *t) {
    for (int l = 0; l < GN_LIST_COUNT; l++) gn_soa_destroy(&gn_contact_record, &t->contacts[l]);
    gn_soa_destroy(&gn_wall_contact_record, &t->touches);
}

void gn_trial_free(gn_trial *t) {
    free_lists(t);
    gn_preconditioner_free(&t->made);
    gn_free(t->pos);
    gn_free(t->load);
    gn_free(t->supplied);
    gn_free(t->wall);
    gn_free(t->wall_force);
    *t = (gn_trial){0};
}

/* --- the reference state --- */

static gneiss_status copy_lists(gn_trial *t, gneiss_error *error) {
    const gn_world *w = t->world;
    gn_active_pairs_settle(&w->ctx, &w->dem);
    free_lists(t);
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contacts *list = &w->dem.list[l].contacts;
        if (list->soa.capacity)
            GN_TRY(
                gn_soa_copy(&gn_contact_record, &t->contacts[l], list, list->soa.effects, error));
    }
    if (!(w->ctx.effects & GN_FX_WALLS)) return GNEISS_OK;
    return gn_soa_copy(&gn_wall_contact_record, &t->touches, &w->boundary.contacts,
                       w->boundary.contacts.soa.effects, error);
}

static gneiss_status go_out_from_here(gn_trial *t, gneiss_error *error) {
    const gn_world *w = t->world;
    memcpy(t->pos, w->dem.particles.pos, t->count * 4 * sizeof *t->pos);
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) {
        const gn_wall *wall = &w->boundary.walls[k];
        memcpy(t->wall[k], wall->point, sizeof wall->point);
        t->wall[k][3] = wall->travel;
        memcpy(t->wall_force[k], wall->force, sizeof wall->force);
    }
    if (w->dem.prescribed.count)
        memcpy(t->supplied, w->dem.prescribed.load,
               w->dem.prescribed.count * N * sizeof *t->supplied);
    return copy_lists(t, error);
}

static void restore_lists(gn_trial *t) {
    gn_world *w = t->world;
    gn_active_pairs_repack(&w->ctx, &w->dem);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (t->contacts[l].soa.capacity)
            gn_soa_take(&gn_contact_record, &w->dem.list[l].contacts, &t->contacts[l]);
    if (w->ctx.effects & GN_FX_WALLS)
        gn_soa_take(&gn_wall_contact_record, &w->boundary.contacts, &t->touches);
}

/* --- positions and velocities --- */

static void put_particles(gn_trial *t, const double *path, double rate) {
    gn_world *w = t->world;
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < t->count; p++)
        for (size_t a = 0; a < 3; a++) {
            q->pos[4 * p + a] = t->pos[4 * p + a] + path[N * p + a];
            q->vel[4 * p + a] = rate * path[N * p + a];
            if (q->spin) q->spin[4 * p + a] = rate * path[N * p + 3 + a];
        }
    gn_particles_to_single(q, q->ref, w->ctx.threads);
}

static void wall_path(const gn_step_context *ctx, size_t k, double span, double d[3]) {
    const gn_motion *motion = &ctx->scene.walls[k].motion;
    for (int a = 0; a < 3; a++)
        d[a] = gn_table_between(&motion->velocity[a], ctx->time, ctx->time + span);
}

static void put_walls(gn_trial *t, double span, double rate) {
    gn_world *w = t->world;
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) {
        gn_wall *wall = &w->boundary.walls[k];
        double d[3];
        wall_path(&w->ctx, k, span, d);
        for (int a = 0; a < 3; a++) {
            wall->point[a] = t->wall[k][a] + d[a];
            wall->velocity[a] = rate * d[a];
        }
        wall->travel = t->wall[k][3] + fabs(gn_dot3(d, wall->normal));
    }
}

static const gn_table *channel(const gn_step_context *ctx, const gn_dem *dem, size_t slot, int k) {
    int32_t set = dem->channel_set[N * slot + (size_t)k];
    if (set < 0) return NULL;
    const gn_motion *motion = &ctx->scene.sets[set].motion;
    return k < 3 ? &motion->velocity[k] : &motion->spin[k - 3];
}

void gn_trial_prescribe(const gn_trial *t, double span, double *path) {
    const gn_world *w = t->world;
    for (size_t p = 0; w->dem.prescribed.count && p < t->count; p++) {
        int32_t slot = w->dem.particles.slot[p];
        for (int k = 0; slot >= 0 && k < N; k++) {
            const gn_table *table = channel(&w->ctx, &w->dem, (size_t)slot, k);
            if (table)
                path[N * p + (size_t)k] = gn_table_between(table, w->ctx.time, w->ctx.time + span);
        }
    }
}

/* --- loads at the end of a path --- */

static unsigned held_mask(const gn_dem *dem, size_t p) {
    int32_t slot = dem->prescribed.count ? dem->particles.slot[p] : -1;
    return slot < 0 ? 0u : dem->prescribed.mask[slot];
}

/* Computes the loads from the velocities that they cause in a step of one second, without those of
 * the path; viscous damping acts on the velocities of the path. */
static void read_loads(gn_trial *t, const double *path, double rate) {
    gn_world *w = t->world;
    const gn_particles *q = &w->dem.particles;
    double drag = w->ctx.effects & GN_FX_VISCOUS ? w->ctx.scene.background_coefficient : 0.0;
    for (size_t p = 0; p < t->count; p++) {
        unsigned held = held_mask(&w->dem, p);
        for (size_t k = 0; k < N; k++) {
            const double *now = k < 3 ? q->vel : q->spin;
            double v = rate * path[N * p + k], *load = &t->load[N * p + k];
            *load = 0.0;
            if (!now || held >> k & 1 || !(now[4 * p + 3] > 0.0)) continue;
            *load = (now[4 * p + k % 3] - v - drag * v) / now[4 * p + 3];
        }
    }
}

/* Computes means of loads and of contact forces. */
static void weigh_loads(gn_trial *t) {
    const gn_world *w = t->world;
    const gn_dem_sums *s = &w->dem.done;
    double sum = 0.0, most = -1.0, contacts = s->contacts.carrying;
    const unsigned places = w->ctx.effects & GN_FX_SPACE ? 0x7u : 0x3u;
    size_t free = 0; /* number of particles that are free along some direction */
    for (size_t p = 0; p < t->count; p++) {
        double square = 0.0, r = w->dem.particles.pos[4 * p + 3];
        for (size_t k = 0; k < N; k++) {
            double f = k < 3 ? t->load[N * p + k] : t->load[N * p + k] / r;
            square += f * f;
        }
        sum += sqrt(square);
        free += (held_mask(&w->dem, p) & places) != places;
        if (square > most) t->worst = w->dem.particles.id[p];
        most = fmax(most, square);
    }
    t->mean_load = free ? sum / (double)free : 0.0;
    t->most_load = sqrt(fmax(most, 0.0));
    t->mean_force = contacts > 0.0 ? s->contacts.force / contacts : 0.0;
}

static void note_losses(gn_trial *t) {
    const gn_dem_sums *s = &t->world->dem.done;
    t->friction += s->contacts.friction + s->walls.friction;
    t->contact_damping += s->contacts.contact_damping + s->walls.contact_damping;
    t->broken += s->contacts.broken_tension + s->contacts.broken_shear;
}

/* Forces are evaluated along the path first: the tangential springs are loaded along its length,
 * and contacts that closed or opened on it act for a part of it. Then
 * the forces of the end state alone are evaluated. */
void gn_trial_go(gn_trial *t, const double *path, double span, bool loads) {
    gn_world *w = t->world;
    const double walls = loads ? 0.0 : span, rate = loads ? 0.0 : 1.0 / span;
    t->friction = t->contact_damping = 0.0;
    t->rate = rate;
    t->broken = 0;
    restore_lists(t);
    put_particles(t, path, 1.0 / span);
    put_walls(t, walls, rate);
    gn_world_evaluate_particles(w, span, 0.0, false);
    note_losses(t);
    put_particles(t, path, rate);
    gn_world_evaluate_particles(w, 0.0, 2.0, true);
    note_losses(t);
    read_loads(t, path, rate);
    put_particles(t, path, rate);
    weigh_loads(t);
}

/* --- towards equilibrium --- */

bool gn_trial_bond(const gn_trial *t, size_t c, double *normal, double shear[3]) {
    const gn_world *w = t->world;
    const gn_contacts *list = &w->dem.bonds.contacts;
    if (!gn_contact_bonded(list, c)) return false;
    double d[3];
    double length = sqrt(gn_branch(&w->ctx, w->dem.particles.pos + 4 * (int64_t)list->i[c],
                                   w->dem.particles.pos + 4 * (int64_t)list->j[c], d));
    gn_law_held h = gn_law_of(list->soa.effects)->held(list, c, length, length - list->length0[c]);
    *normal = h.normal;
    memcpy(shear, h.shear, sizeof h.shear);
    return true;
}

static bool pair_slips(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c) {
    double d[3];
    if (gn_contact_bonded(list, c)) return false;
    const double *x = dem->particles.pos + 4 * (int64_t)list->i[c];
    const double *y = dem->particles.pos + 4 * (int64_t)list->j[c];
    double length = sqrt(gn_branch(ctx, x, y, d));
    double free = list->length0 ? list->length0[c] : x[3] + y[3];
    const gn_law *law = gn_law_of(list->soa.effects);
    gn_law_held h = law->held(list, c, length, length - free);
    return law->slips(list, c, h.normal + h.viscous, sqrt(gn_dot3(h.shear, h.shear)));
}

static bool touch_slips(const gn_step_context *ctx, const gn_boundary *boundary, size_t c) {
    const gn_wall_contacts *list = &boundary->contacts;
    const double *row = list->row + 8 * c;
    const gn_wall *wall = &boundary->walls[list->wall[c]];
    double along = gn_dot3(row, wall->normal), across2 = gn_dot3(row, row) - along * along;
    double limit = ctx->scene.walls[list->wall[c]].friction * fmax(along, 0.0) * (1.0 - 1e-6);
    return list->shear && across2 > 0.0 && across2 >= limit * limit;
}

static uint8_t *find_slips(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary) {
    const size_t contacts = gn_lists_count(dem);
    size_t touches = ctx->effects & GN_FX_WALLS ? boundary->contacts.soa.count : 0;
    uint8_t *slips = gn_alloc(contacts + touches + 1), *to = slips;
    if (!slips) return NULL;
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contacts *list = &dem->list[l].contacts;
        for (size_t c = 0; c < list->soa.count; c++) *to++ = pair_slips(ctx, dem, list, c);
    }
    for (size_t c = 0; c < touches; c++) *to++ = touch_slips(ctx, boundary, c);
    return slips;
}

/* Adds corrections to the path. An unsupported particle may be displaced without bound, so that no
 * particle moves by more than a part of its radius at a time. */
static void add_corrections(const gn_trial *t, const double *u, double *path,
                            gn_equilibrium *found) {
    const double part = 0.02;
    const gn_particles *q = &t->world->dem.particles;
    double most = 0.0;
    for (size_t p = 0; p < t->count; p++) {
        const double *d = u + N * p, r = q->pos[4 * p + 3];
        double size = fmax(sqrt(gn_dot3(d, d)) / r, sqrt(gn_dot3(d + 3, d + 3)));
        double share = size > part ? part / size : 1.0;
        for (size_t k = 0; k < N; k++) path[N * p + k] += share * d[k];
        if (size > part && size > most) found->unsupported = q->id[p];
        most = fmax(most, size);
    }
}

gneiss_status gn_trial_correct(gn_trial *t, double tolerance, double *path, gn_equilibrium *found,
                               gneiss_error *error) {
    uint8_t *slips = find_slips(&t->world->ctx, &t->world->dem, &t->world->boundary);
    double *u = gn_alloc_array(t->count + 1, N * sizeof *u);
    gneiss_status status = GNEISS_OK;
    if (!slips || !u)
        status = gn_fail(error, GNEISS_ERROR_MEMORY,
                         "no memory for the equilibrium of %zu particles", t->count);
    if (status == GNEISS_OK)
        status = gn_timestep_relax(&t->world->ctx, &t->world->dem, &t->world->boundary, slips,
                                   t->rate, t->load, tolerance, &t->made, u, found, error);
    if (status == GNEISS_OK) add_corrections(t, u, path, found);
    gn_free(slips);
    gn_free(u);
    return status;
}

/* --- the ledger --- */

/* Evaluates stored energies and the readings of the state. */
static void read_state(gn_world *w) {
    gn_world_evaluate_particles(w, 0.0, 0.0, true);
    gn_boundary_forces(&w->ctx, &w->dem, &w->boundary);
    gn_world_measure_particles(w, &w->ledger.energy, w->ledger.stress);
    gn_boundary_measure(&w->ctx, &w->boundary, &w->ledger.energy);
    w->ledger.balance = (gn_balance){0};
    gn_world_balance_particles(&w->dem, &w->boundary, &w->ledger.balance);
    w->ledger.unbalanced = fmin(w->ledger.balance.ratio, GN_UNBALANCED_MOST);
}

static double work_of_walls(const gn_trial *t, double span) {
    const gn_world *w = t->world;
    double sum = 0.0, d[3];
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) {
        wall_path(&w->ctx, k, span, d);
        for (int a = 0; a < 3; a++)
            sum -= 0.5 * d[a] * (t->wall_force[k][a] + w->boundary.walls[k].force[a]);
    }
    return sum;
}

static double work_prescribed(const gn_trial *t, const double *path) {
    const gn_world *w = t->world;
    double sum = 0.0;
    for (size_t p = 0; w->dem.prescribed.count && p < t->count; p++) {
        int32_t slot = w->dem.particles.slot[p];
        for (size_t k = 0; slot >= 0 && k < N; k++) {
            if (!(w->dem.prescribed.mask[slot] >> k & 1)) continue;
            size_t at = N * (size_t)slot + k;
            sum += 0.5 * path[N * p + k] * (t->supplied[at] + w->dem.prescribed.load[at]);
        }
    }
    return sum;
}

/* Books the works of gravity and applied forces and the loss of viscous damping. */
static void book_loads(const gn_trial *t, const double *path, double span, bool loads) {
    gn_world *w = t->world;
    const gn_particles *q = &w->dem.particles;
    bool viscous = w->ctx.effects & GN_FX_VISCOUS && !loads;
    double drag = viscous ? w->ctx.scene.background_coefficient / span : 0.0;
    for (size_t p = 0; p < t->count; p++) {
        const double *u = path + N * p, inverse = q->vel[4 * p + 3];
        if (!(inverse > 0.0)) continue;
        w->ledger.energy.work_gravity +=
            gn_own_share(q, p) * gn_dot3(w->ctx.scene.gravity, u) / inverse;
        if (q->applied) w->ledger.energy.work_applied += gn_dot3(q->applied + 4 * p, u);
        if (drag == 0.0) continue;
        double turn = q->spin ? gn_dot3(u + 3, u + 3) / q->spin[4 * p + 3] : 0.0;
        w->ledger.energy.background_damping += drag * (gn_dot3(u, u) / inverse + turn);
    }
}

/* Returns the energy that the terms of the ledger do not explain yet. */
static double missing(const gn_trial *t) {
    const gn_energy *e = &t->world->ledger.energy;
    double in = 0.0, lost = 0.0;
#define INPUT(name) in += e->name;
#define LOST(name)  lost += e->name;
#define STORED(name)
#define X(name, kind, text) kind(name)
    GN_ENERGY_TERMS(X)
#undef X
#undef INPUT
#undef LOST
#undef STORED
    return gn_energy_stored(e) - t->stored + lost - in;
}

/* Closes the ledger. In equilibrium prescribed motions supply the stored and lost energy.
 * Trapezoidal sums of their works miss a part of it if contacts close on the path; the difference
 * is distributed in the proportions of the sums. Dead loads supply more than is stored; the excess
 * counts as damping, as if the system came to rest under them. */
static void close_ledger(gn_trial *t, double walls, double prescribed, bool loads) {
    gn_energy *e = &t->world->ledger.energy;
    e->work_walls += walls;
    e->work_prescribed += prescribed;
    double rest = missing(t), all = fabs(walls) + fabs(prescribed);
    if (loads) {
        e->background_damping -= rest;
        return;
    }
    double share = all > 0.0 ? fabs(walls) / all : (t->world->dem.prescribed.count ? 0.0 : 1.0);
    e->work_walls += share * rest;
    e->work_prescribed += (1.0 - share) * rest;
    t->shortfall += fabs(rest);
}

gneiss_status gn_trial_begin(gn_world *w, gn_trial *t, gneiss_error *error) {
    *t = (gn_trial){.world = w, .count = w->dem.particles.soa.count};
    GN_TRY(allocate(t, error));
    read_state(w);
    t->stored = w->ledger.energy.stored_at_start = gn_energy_stored(&w->ledger.energy);
    w->ledger.reading = w->ledger.energy;
    return go_out_from_here(t, error);
}

/* --- continuation by steps --- */

static void turn_orientations(gn_particles *q, const double *path) {
    for (size_t p = 0; q->orientation && p < q->soa.count; p++) {
        double *o = q->orientation + 4 * p, sum = 0.0;
        double x = 0.5 * path[N * p + 3], y = 0.5 * path[N * p + 4], z = 0.5 * path[N * p + 5];
        const double r[4] = {
            o[0] - x * o[1] - y * o[2] - z * o[3], o[1] + x * o[0] + y * o[3] - z * o[2],
            o[2] + y * o[0] + z * o[1] - x * o[3], o[3] + z * o[0] + x * o[2] - y * o[1]};
        for (int k = 0; k < 4; k++) sum += r[k] * r[k];
        for (int k = 0; k < 4; k++) o[k] = r[k] / sqrt(sum);
    }
}

gneiss_status gn_trial_take(gn_trial *t, const double *path, double span, bool loads,
                            gneiss_error *error) {
    gn_world *w = t->world;
    gn_boundary_forces(&w->ctx, &w->dem, &w->boundary);
    w->ledger.energy.friction += t->friction;
    if (!loads) w->ledger.energy.contact_damping += t->contact_damping;
    book_loads(t, path, span, loads);
    double walls = loads ? 0.0 : work_of_walls(t, span);
    double prescribed = loads ? 0.0 : work_prescribed(t, path);
    if (!loads) w->ctx.time += span;
    turn_orientations(&w->dem.particles, path);
    read_state(w);
    close_ledger(t, walls, prescribed, loads);
    w->ledger.reading = w->ledger.energy;
    /* The next increment may be as long as the lists allow. */
    gn_dem_look_at_travel(&w->ctx, &w->dem, &w->box);
    double own = w->dem.verlet.drift, other = gn_boundary_travel(&w->ctx, &w->boundary, true);
    if (fmax(2.0 * own, own + other) > 0.5 * w->dem.verlet.skin) {
        gn_preconditioner_free(&t->made);
        GN_TRY(gn_world_renew_lists(w, error));
    }
    return go_out_from_here(t, error);
}

gneiss_status gn_trial_leave(gn_trial *t, const double *path, double span, gneiss_error *error) {
    gn_world *w = t->world;
    gn_particles *q = &w->dem.particles;
    restore_lists(t);
    put_walls(t, 0.0, 0.0);
    gn_walls_take_velocities(&w->ctx, &w->boundary);
    for (size_t p = 0; p < t->count; p++)
        for (size_t a = 0; a < 3; a++) {
            q->pos[4 * p + a] = t->pos[4 * p + a];
            q->vel[4 * p + a] = path[N * p + a] / span;
            if (q->spin) q->spin[4 * p + a] = path[N * p + 3 + a] / span;
        }
    gn_particles_to_single(q, q->ref, w->ctx.threads);
    read_state(w);
    close_ledger(t, 0.0, 0.0, false);
    w->ledger.reading = w->ledger.energy;
    gn_dem_look_at_travel(&w->ctx, &w->dem, &w->box);
    w->ctx.dt_past = 0.0;
    return gn_timestep_check(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->zones, &w->ledger,
                             true, error);
}
