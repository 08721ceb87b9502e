#include "particles/clumps.h"

#include "base/new.h"
#include "base/rotation.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "sched/hold.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* Number of clumps whose sums are formed together; groups are added in their order, so that the
 * result does not depend on the number of threads. */
enum { GROUP = GN_ROTORS };

/* --- rows of members --- */

const gn_clump *gn_clump_of(const gn_dem *dem, size_t row) {
    const int32_t *clump = dem->particles.clump;
    return clump && clump[row] >= 0 ? &dem->clumps.clump[clump[row]] : NULL;
}

bool gn_clump_binds(const gn_dem *dem, int32_t i, int32_t j) {
    const int32_t *clump = dem->particles.clump;
    return clump && clump[i] >= 0 && clump[i] == clump[j];
}

/* Returns the row of a member, also between the removal of rows and the next lists. */
static size_t row_of(const gn_dem *dem, size_t member) {
    return (size_t)dem->index_of_id[(size_t)dem->clumps.member[member].id];
}

double gn_clump_mass_of(const gn_dem *dem, size_t row) {
    const gn_clump *clump = gn_clump_of(dem, row);
    return clump->mass * dem->clumps.member[dem->clumps.member_of_row[row]].part;
}

size_t gn_clumps_bound(const gn_clumps *clumps) {
    size_t bound = 0;
    for (size_t k = 0; k < clumps->count; k++)
        if (clumps->clump[k].present > 0.0) bound += (size_t)clumps->clump[k].count - 1;
    return bound;
}

void gn_clumps_enter(gn_dem *dem) {
    gn_particles *q = &dem->particles;
    for (size_t p = 0; q->clump && p < q->soa.count; p++) q->clump[p] = -1;
    for (size_t k = 0; k < dem->clumps.count; k++) {
        const gn_clump *c = &dem->clumps.clump[k];
        for (size_t m = (size_t)c->first; m < (size_t)(c->first + c->count); m++) {
            const size_t row = (size_t)dem->clumps.member[m].id;
            q->clump[row] = (int32_t)k;
            q->material[row] = (int32_t)dem->clumps.member[m].material;
            q->group[row] = 0;
        }
    }
}

/* Sets velocity and spin of a row to those of its clump at the row's place. */
static void set_motion(const gn_clump *c, const gn_clump_member *m, gn_particles *q, size_t row) {
    double arm[3], turning[3];
    gn_axes_direct(c->axes, m->local, arm);
    gn_cross3(c->spin, arm, turning);
    for (size_t a = 0; a < 3; a++) {
        q->vel[4 * row + a] = c->velocity[a] + turning[a];
        q->spin[4 * row + a] = c->spin[a];
    }
    q->vel[4 * row + 3] = m->inverse_mass;
    q->spin[4 * row + 3] = m->inverse_inertia;
}

void gn_clumps_complete(gn_dem *dem) {
    for (size_t k = 0; k < dem->clumps.count; k++) {
        const gn_clump *c = &dem->clumps.clump[k];
        for (size_t m = (size_t)c->first; m < (size_t)(c->first + c->count); m++)
            set_motion(c, &dem->clumps.member[m], &dem->particles,
                       (size_t)dem->clumps.member[m].id);
    }
}

void gn_clumps_free(gn_clumps *clumps) {
    void *blocks[] = {clumps->apart, clumps->clump,         clumps->member,
                      clumps->row,   clumps->member_of_row, clumps->sums};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *clumps = (gn_clumps){0};
}

static gneiss_status number_rows(gn_dem *dem, gneiss_error *error) {
    gn_clumps *all = &dem->clumps;
    const size_t rows = dem->particles.soa.count;
    gn_free(all->member_of_row);
    all->member_of_row = NULL;
    GN_TRY(gn_new(&all->member_of_row, rows + 1, "members of clumps", error));
    for (size_t p = 0; p < rows; p++) all->member_of_row[p] = dem->particles.clump[p] = -1;
    if (!all->row) GN_TRY(gn_new(&all->row, all->member_count, "members of clumps", error));
    if (!all->sums) GN_TRY(gn_new(&all->sums, all->count / GROUP + 1, "clumps", error));
    for (size_t k = 0; k < all->count; k++) {
        const gn_clump *c = &all->clump[k];
        for (size_t m = (size_t)c->first; m < (size_t)(c->first + c->count); m++) {
            const int32_t row = all->row[m] = dem->index_of_id[(size_t)all->member[m].id];
            if (row < 0) continue;
            all->member_of_row[row] = (int32_t)m;
            dem->particles.clump[row] = (int32_t)k;
        }
    }
    return GNEISS_OK;
}

static gneiss_status count_apart(gn_dem *dem, gneiss_error *error) {
    gn_clumps *all = &dem->clumps;
    gn_free(all->apart);
    all->apart = NULL;
    GN_TRY(gn_new(&all->apart, dem->motion_blocks + 1, "blocks", error));
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        const gn_clump *c = gn_clump_of(dem, p);
        all->apart[p / GN_PARTICLE_BLOCK] += !c || !(c->present > 0.0);
    }
    return GNEISS_OK;
}

gneiss_status gn_clumps_follow_rows(gn_dem *dem, gneiss_error *error) {
    gn_clumps *all = &dem->clumps;
    GN_TRY(number_rows(dem, error));
    GN_TRY(count_apart(dem, error));
    for (size_t k = 0; k < all->count; k++) {
        const gn_clump *c = &all->clump[k];
        for (size_t m = (size_t)c->first; m < (size_t)(c->first + c->count); m++)
            if (c->present > 0.0) GN_TRY(gn_hold_particle(&dem->hold, (size_t)all->row[m], error));
    }
    return GNEISS_OK;
}

/* --- motion of clumps --- */

/* Values of a step that all clumps share. */
typedef struct step {
    const gn_step_context *ctx;
    gn_dem *dem;
    double interval; /* s, of the kick */
    bool space, measure, first, changed, damped;
} step;

/* Leaves a member without load and mass, so that the kernel neither moves it nor counts it; blocks
 * of members alone do not come to it. */
static void disarm(gn_dem *dem, size_t row, double *load, int width) {
    if (gn_clumps_fill(&dem->clumps, row / GN_PARTICLE_BLOCK)) return;
    memset(load, 0, (size_t)width * sizeof *load);
    dem->particles.vel[4 * row + 3] = dem->particles.spin[4 * row + 3] = 0.0;
}

/* Sums up the loads of the members, in their order. */
static void take_loads(const step *s, const gn_clump *c, double force[3], double moment[3],
                       double stress[9]) {
    gn_dem *d = s->dem;
    const int width = gn_row_width(s->space, true);
    double axes[9], sum[6] = {0, 0, 0, 0, 0, 0};
    memcpy(axes, c->axes, sizeof axes);
    for (size_t m = (size_t)c->first; m < (size_t)(c->first + c->count); m++) {
        const size_t row = (size_t)d->clumps.row[m];
        double *load = gn_hold_load(&d->hold, width, row), own[8] = {0}, arm[3], turning[3];
        memcpy(own, load, 4 * sizeof *own);
        if (s->space) {
            memcpy(own + 4, load + 4, 4 * sizeof *own);
        } else {
            own[6] = own[2];
            own[2] = 0.0;
        }
        gn_axes_direct(axes, d->clumps.member[m].local, arm);
        gn_cross3(arm, own, turning);
        for (int a = 0; a < 3; a++) {
            sum[a] += own[a];
            sum[3 + a] += turning[a] + own[4 + a];
        }
        for (int k = 0; s->measure && k < 9; k++) stress[k] += arm[k / 3] * own[k % 3];
        disarm(d, row, load, width);
    }
    memcpy(force, sum, 3 * sizeof *force);
    memcpy(moment, sum + 3, 3 * sizeof *moment);
}

/* Computes non-viscous damping of a load by the velocity (or spin) v; `gain` is the change of v in
 * a kick, see `kick` of kernels/motion_template.c. */
static void damp(const step *s, double coefficient, const double load[3], const double v[3],
                 const double gain[3], double d[3]) {
    const gn_effects effects = s->ctx->effects;
    const double lead = s->ctx->scene.background_velocity == GN_VELOCITY_INSTANT ? 0.5 : 0.0;
    const double speed = sqrt(gn_dot3(v, v)), size = sqrt(gn_dot3(load, load));
    for (int a = 0; a < 3; a++) {
        const double along = v[a] + lead * gain[a];
        d[a] = 0.0;
        if (effects & GN_FX_NONVISCOUS_VECTOR && speed > 0.0)
            d[a] = -coefficient * size / speed * v[a];
        if (effects & GN_FX_NONVISCOUS_COMPONENT && along != 0.0)
            d[a] = -copysign(coefficient * fabs(load[a]), along);
    }
}

/* A kick of a velocity v and its momentum p, or of a spin and its momentum, by a load f with
 * background damping d; 0: before, 1: after. */
typedef struct change {
    double f[3], v[2][3], p[2][3], d[3];
} change;

/* Computes the momentum after the kick. `gain` is the change of v without damping. */
static inline void kick(const step *s, double coefficient, const double gain[3], change *k) {
    if (s->ctx->effects & GN_FX_VISCOUS) {
        const double half = 0.5 * coefficient * s->interval;
        for (int a = 0; a < 3; a++) {
            k->p[1][a] = ((1.0 - half) * k->p[0][a] + s->interval * k->f[a]) / (1.0 + half);
            k->d[a] = -0.5 * coefficient * (k->p[0][a] + k->p[1][a]);
        }
        return;
    }
    if (s->damped) damp(s, coefficient, k->f, k->v[0], gain, k->d);
    for (int a = 0; a < 3; a++) k->p[1][a] = k->p[0][a] + s->interval * (k->f[a] + k->d[a]);
}

static inline void book(const step *s, const change *k, double *kinetic, gn_clump_sums *sums) {
    const gn_step_context *ctx = s->ctx;
    if (s->damped) {
        sums->motion.damping[0] -= 0.5 * ctx->dt_past * gn_dot3(k->d, k->v[0]);
        sums->motion.damping[1] -= 0.5 * ctx->dt * gn_dot3(k->d, k->v[1]);
    }
    for (int a = 0; s->measure && a < 3; a++)
        *kinetic += 0.5 * (s->first ? 2.0 * k->v[0][a] - k->v[1][a] : k->v[0][a]) * k->p[1][a];
    if (!s->changed) return;
    const double factor = 0.5 * (ctx->dt_past - ctx->dt) / (ctx->dt_past + ctx->dt);
    for (int a = 0; a < 3; a++) {
        const double gain = factor * (k->p[1][a] - k->p[0][a]);
        sums->step_change[GN_HALF_BEFORE] -= gain * k->v[0][a];
        sums->step_change[GN_HALF_AFTER] += gain * k->v[1][a];
    }
}

static void kick_centre(const step *s, gn_clump *c, const double force[3], gn_clump_sums *sums) {
    const gn_step_context *ctx = s->ctx;
    const double *g = ctx->scene.gravity;
    double gain[3];
    change k;
    memset(k.d, 0, sizeof k.d);
    for (int a = 0; a < 3; a++) {
        k.f[a] = force[a] + c->mass * g[a];
        k.v[0][a] = c->velocity[a];
        k.p[0][a] = c->mass * c->velocity[a];
        gain[a] = s->interval * c->inverse_mass * k.f[a];
    }
    kick(s, ctx->scene.background_coefficient, gain, &k);
    for (int a = 0; a < 3; a++) k.v[1][a] = c->velocity[a] = c->inverse_mass * k.p[1][a];
    sums->motion.gravity[0] += 0.5 * ctx->dt_past * c->mass * gn_dot3(g, k.v[0]);
    sums->motion.gravity[1] += 0.5 * ctx->dt * c->mass * gn_dot3(g, k.v[1]);
    book(s, &k, &sums->motion.kinetic, sums);
    if (s->measure) sums->motion.resultant += sqrt(gn_dot3(k.f, k.f));
}

static void kick_turning(const step *s, gn_clump *c, const double moment[3], gn_clump_sums *sums) {
    const gn_rotor rotor = {c->turn, c->axes, c->momentum, c->inverse_inertia};
    double gain[3] = {0, 0, 0};
    change k;
    memset(k.d, 0, sizeof k.d);
    for (int a = 0; a < 3; a++) k.f[a] = s->space || a == 2 ? moment[a] : 0.0;
    memcpy(k.v[0], c->spin, sizeof k.v[0]);
    memcpy(k.p[0], c->momentum, sizeof k.p[0]);
    if (s->damped) {
        const gn_rotor gained = {c->turn, c->axes, k.f, c->inverse_inertia};
        gn_rotor_spin(&gained, gain);
        for (int a = 0; a < 3; a++) gain[a] *= s->interval;
    }
    kick(s, gn_scene_spin_damping(&s->ctx->scene), gain, &k);
    memcpy(c->momentum, k.p[1], sizeof k.p[1]);
    gn_rotor_spin(&rotor, k.v[1]);
    memcpy(c->spin, k.v[1], sizeof k.v[1]);
    book(s, &k, &sums->motion.rotational, sums);
    if (s->measure) sums->motion.spin2 = fmax(sums->motion.spin2, gn_dot3(c->spin, c->spin));
}

/* Rotates a clump that turns far in the step, or in the plane. */
static void turn_alone(const step *s, gn_clump *c, double turn) {
    const gn_rotor rotor = {c->turn, c->axes, c->momentum, c->inverse_inertia};
    gn_rotor_advance(&rotor, turn, s->ctx->dt, s->space);
    gn_rotor_spin(&rotor, c->spin);
}

static void copy_rotor(gn_rotors *r, size_t n, const gn_clump *c) {
    for (int a = 0; a < 4; a++) r->turn[a][n] = c->turn[a];
    for (int a = 0; a < 9; a++) r->axes[a][n] = c->axes[a];
    for (int a = 0; a < 3; a++) {
        r->momentum[a][n] = c->momentum[a];
        r->inverse_inertia[a][n] = c->inverse_inertia[a];
    }
}

static void take_rotor(const gn_rotors *r, size_t n, gn_clump *c) {
    for (int a = 0; a < 4; a++) c->turn[a] = r->turn[a][n];
    for (int a = 0; a < 9; a++) c->axes[a] = r->axes[a][n];
    for (int a = 0; a < 3; a++) c->spin[a] = r->spin[a][n];
}

/* Moves the clumps of a group over the step; those that turn little are rotated together. */
static void drift(const step *s, gn_clump *clump, size_t count) {
    const double dt = s->ctx->dt;
    size_t place[GROUP], few = 0;
    gn_rotors rotors;
    for (size_t k = 0; k < count; k++) {
        gn_clump *c = &clump[k];
        if (!(c->present > 0.0)) continue;
        const double turn = dt * sqrt(gn_dot3(c->spin, c->spin));
        memcpy(c->mean_spin, c->spin, sizeof c->mean_spin);
        for (int a = 0; a < 3; a++) c->position[a] += dt * c->velocity[a];
        if (s->space && turn <= GN_TURN_PLAIN)
            copy_rotor(&rotors, few, c), place[few++] = k;
        else
            turn_alone(s, c, turn);
    }
    gn_rotors_advance(&rotors, few, dt);
    for (size_t n = 0; n < few; n++) take_rotor(&rotors, n, &clump[place[n]]);
    for (size_t k = 0; k < count; k++)
        for (int a = 0; a < 3; a++)
            clump[k].mean_spin[a] = 0.5 * (clump[k].mean_spin[a] + clump[k].spin[a]);
}

static void move_group(const step *s, size_t group) {
    gn_clumps *all = &s->dem->clumps;
    gn_clump_sums *sums = &all->sums[group];
    const size_t begin = group * GROUP, rest = all->count - begin,
                 count = rest < GROUP ? rest : GROUP;
    *sums = (gn_clump_sums){.motion.bad = -1};
    for (size_t k = begin; k < begin + count; k++) {
        gn_clump *c = &all->clump[k];
        double force[3], moment[3];
        if (!(c->present > 0.0)) continue;
        take_loads(s, c, force, moment, sums->stress);
        kick_centre(s, c, force, sums);
        kick_turning(s, c, moment, sums);
    }
    drift(s, all->clump + begin, count);
}

void gn_clumps_move(const gn_step_context *ctx, gn_dem *dem, bool measure) {
    gn_clumps *all = &dem->clumps;
    if (!all->count) return;
    const step s = {.ctx = ctx,
                    .dem = dem,
                    .interval = 0.5 * (ctx->dt_past + ctx->dt),
                    .space = ctx->effects & GN_FX_SPACE,
                    .measure = measure,
                    .first = !(ctx->dt_past > 0.0),
                    .damped = ctx->effects & (GN_FX_VISCOUS | GN_FX_NONVISCOUS_VECTOR |
                                              GN_FX_NONVISCOUS_COMPONENT),
                    .changed = ctx->dt_past > 0.0 && ctx->dt != ctx->dt_past};
    const size_t groups = (all->count + GROUP - 1) / GROUP;
#pragma omp parallel for schedule(static) num_threads(dem->deal.team)
    for (size_t g = 0; g < groups; g++) move_group(&s, g);
    all->done = (gn_clump_sums){.motion.bad = -1};
    for (size_t g = 0; g < groups; g++) {
        gn_motion_sums_add(&all->done.motion, &all->sums[g].motion);
        for (int h = 0; h < 2; h++) all->done.step_change[h] += all->sums[g].step_change[h];
        for (int k = 0; k < 9; k++) all->done.stress[k] += all->sums[g].stress[k];
    }
}

/* --- motion of members --- */

static void to_single(gn_particles *q, size_t p) {
    if (!GN_BUILT(MIXED) || !q->travel_f) return;
    for (size_t a = 0; a < 3; a++) {
        q->travel_f[4 * p + a] = (float)(q->pos[4 * p + a] - q->ref[4 * p + a]);
        q->vel_f[4 * p + a] = (float)q->vel[4 * p + a];
        q->spin_f[4 * p + a] = (float)q->spin[4 * p + a];
    }
    q->vel_f[4 * p + 3] = (float)q->vel[4 * p + 3];
}

/* Sets position and motion of a member. Its velocity is that of the middle of the interval, which
 * the arm there, r - dt/2 w x r, gives to second order. */
static void move_member(const gn_step_context *ctx, gn_dem *dem, size_t p, gn_motion_sums *sums) {
    gn_particles *q = &dem->particles;
    const gn_clump_member *m = &dem->clumps.member[dem->clumps.member_of_row[p]];
    const gn_clump *c = &dem->clumps.clump[q->clump[p]];
    const double spin[4] = {c->mean_spin[0], c->mean_spin[1], c->mean_spin[2], m->inverse_inertia};
    double arm[3], turning[3], middle[3], place[4], v[4], change2 = 0.0;
    gn_axes_direct(c->axes, m->local, arm);
    gn_cross3(spin, arm, turning);
    for (int a = 0; a < 3; a++) middle[a] = arm[a] - 0.5 * ctx->dt * turning[a];
    gn_cross3(spin, middle, turning);
    memcpy(place, q->pos + 4 * p, sizeof place);
    memcpy(v, q->vel + 4 * p, sizeof v);
    for (int a = 0; a < 3; a++) {
        const double at = c->position[a] + arm[a], now = c->velocity[a] + turning[a];
        /* The member stays in its image of a periodic box. */
        const double images = place[a] - at - gn_nearest(place[a] - at, ctx->period[a]);
        place[a] = ctx->period[a] > 0.0 ? at + images : at;
        change2 += (now - v[a]) * (now - v[a]);
        v[a] = now;
    }
    v[3] = m->inverse_mass;
    memcpy(q->pos + 4 * p, place, sizeof place);
    memcpy(q->vel + 4 * p, v, sizeof v);
    memcpy(q->spin + 4 * p, spin, sizeof spin);
    if (dem->vel_past) memcpy(dem->vel_past + 4 * p, v, sizeof v);
    if (dem->spin_past) memcpy(dem->spin_past + 4 * p, spin, sizeof spin);
    if (GN_BUILT(ORIENTATION) && q->orientation) {
        const double *t = c->turn_start, back[4] = {t[0], -t[1], -t[2], -t[3]};
        gn_turn_product(c->turn, back, q->orientation + 4 * p);
    }
    to_single(q, p);
    /* The straight path of the step is longer than that velocity by a part of (w dt)^2/12. */
    const double w2 = 1.0 + ctx->dt * ctx->dt * gn_dot3(spin, spin);
    const double speed2 = gn_dot3(v, v) * w2 * w2;
    if (speed2 > sums->speed2) sums->speed2 = speed2;
    if (change2 > sums->change2) sums->change2 = change2;
    if (!(speed2 < 1e300) && sums->bad < 0) sums->bad = (int64_t)p;
}

void gn_clumps_move_members(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    if (!dem->clumps.count) return;
#pragma omp parallel for schedule(static) num_threads(dem->deal.team)
    for (size_t h = 0; h < dem->hold.count; h++) {
        const size_t block = (size_t)dem->hold.block[h], first = block * GN_PARTICLE_BLOCK;
        for (size_t p = first; p < first + GN_PARTICLE_BLOCK && p < q->soa.count; p++) {
            const gn_clump *c = gn_clump_of(dem, p);
            if (c && c->present > 0.0) move_member(ctx, dem, p, &dem->motion_sums[block]);
        }
    }
}

/* --- removal --- */

void gn_clumps_leave_whole(const gn_dem *dem, int32_t *gone) {
    const gn_clumps *all = &dem->clumps;
    for (size_t k = 0; k < all->count; k++) {
        const gn_clump *c = &all->clump[k];
        const size_t first = (size_t)c->first, end = (size_t)(c->first + c->count);
        int32_t fate = 0;
        for (size_t m = first; c->present > 0.0 && m < end; m++)
            if (gone[row_of(dem, m)]) fate = gone[row_of(dem, m)];
        for (size_t m = first; fate && m < end; m++) gone[row_of(dem, m)] = fate;
    }
}

double gn_clumps_remove(gn_dem *dem, size_t row) {
    gn_clump *c = &dem->clumps.clump[dem->particles.clump[row]];
    if (!(c->present > 0.0)) return 0.0;
    c->present = 0.0;
    const double energy =
        0.5 * c->mass * gn_dot3(c->velocity, c->velocity) + 0.5 * gn_dot3(c->momentum, c->spin);
    memset(c->velocity, 0, sizeof c->velocity);
    memset(c->momentum, 0, sizeof c->momentum);
    memset(c->spin, 0, sizeof c->spin);
    memset(c->mean_spin, 0, sizeof c->mean_spin);
    return energy;
}

uint64_t gn_clumps_hash(const gn_clumps *clumps, uint64_t hash) {
    return gn_hash_bytes(clumps->clump, clumps->count * sizeof *clumps->clump, hash);
}
