/* Particle sets: their particles, the properties that they change, their motion. */
#include "particles/sets.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "frame/frame.h"
#include "kernels/motion.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

static bool selected(const gn_step_context *ctx, const gn_dem *dem, const gn_set_def *set_def,
                     size_t p) {
    return gn_set_selects(ctx, set_def, dem->particles.pos + 4 * p, dem->particles.id[p]);
}

bool gn_set_selected_in_box(const gn_step_context *ctx, const gn_dem *dem, size_t set, size_t p) {
    const gn_particles *q = &dem->particles;
    double x[4];
    memcpy(x, q->start + 4 * p, sizeof x);
    for (int a = 0; a < (int)ctx->scene.dimension; a++)
        if (gn_scene_periodic_along(&ctx->scene, a))
            x[a] -= ctx->period[a] * floor((x[a] - ctx->scene.periodic_min[a]) / ctx->period[a]);
    return gn_set_selects(ctx, &ctx->scene.sets[set], x, q->id[p]);
}

static bool starts_in(const gn_step_context *ctx, const gn_dem *dem, size_t set, size_t p) {
    const gn_particles *q = &dem->particles;
    if (!gn_particle_is_active(q, p)) return false; /* the particle was removed */
    if (q->id[p] >= dem->made)
        return false; /* the particle is from a source: sets are parts of the specimen */
    return gn_set_selected(ctx, dem, set, p);
}

static const gn_table *channel(const gn_motion *motion, int k) {
    return k < 3 ? &motion->velocity[k] : &motion->spin[k - 3];
}

static uint8_t motion_mask(const gn_motion *motion) {
    uint8_t mask = 0;
    for (int k = 0; k < 6; k++)
        if (channel(motion, k)->count) mask |= (uint8_t)(1u << k);
    return mask;
}

static size_t count_selected(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_set_def *set_def) {
    size_t count = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++) count += selected(ctx, dem, set_def, p);
    return count;
}

static gneiss_status check_ids(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_set_def *set_def, gneiss_error *error) {
    for (size_t k = 0; k < set_def->id_count; k++)
        if (set_def->ids[k] < 0 || set_def->ids[k] >= (int64_t)dem->particles.soa.count)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: set '%s': select.ids: expected numbers from 0 to %zu, found %lld",
                           gn_scene_at(&ctx->scene, set_def->where, "sets").text, set_def->name,
                           dem->particles.soa.count - 1, (long long)set_def->ids[k]);
    if (count_selected(ctx, dem, set_def) == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: set '%s': select: expected particles, found none in this selection",
                       gn_scene_at(&ctx->scene, set_def->where, "sets").text, set_def->name);
    return GNEISS_OK;
}

gneiss_status gn_sets_assign(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    for (size_t k = 0; k < ctx->scene.set_count; k++) {
        const gn_set_def *s = &ctx->scene.sets[k];
        GN_TRY(check_ids(ctx, dem, s, error));
        int material = s->material[0] ? gn_scene_find_material(&ctx->scene, s->material) : -1;
        for (size_t p = 0; p < q->soa.count; p++) {
            if (!selected(ctx, dem, s, p)) continue;
            if (material >= 0) q->material[p] = material;
            if (s->group >= 0) q->group[p] = (int32_t)s->group;
        }
    }
    return GNEISS_OK;
}

/* Sets the initial motion and force of one set; the total force is distributed by mass. */
static void apply_set(const gn_step_context *ctx, gn_dem *dem, const gn_set_def *set_def) {
    gn_particles *q = &dem->particles;
    double mass = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (selected(ctx, dem, set_def, p)) mass += 1.0 / q->vel[4 * p + 3];
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!selected(ctx, dem, set_def, p)) continue;
        for (int k = 0; k < 3; k++) {
            if (set_def->has_initial_velocity) q->vel[4 * p + k] = set_def->initial_velocity[k];
            if (set_def->has_initial_spin && q->spin) q->spin[4 * p + k] = set_def->initial_spin[k];
            if (set_def->has_force && q->applied)
                q->applied[4 * p + k] += set_def->force[k] / q->vel[4 * p + 3] / mass;
        }
    }
}

/* Returns the own mass of a particle; removed ones have none. */
static double own_mass(const gn_particles *particles, size_t p) {
    double inverse = particles->vel[4 * p + 3];
    return inverse > 0.0 ? gn_own_share(particles, p) / inverse : 0.0;
}

static void share_force(const gn_step_context *ctx, gn_dem *dem, size_t set) {
    gn_particles *q = &dem->particles;
    const double *force = ctx->scene.sets[set].force;
    double mass = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (starts_in(ctx, dem, set, p)) mass += own_mass(q, p);
    for (size_t p = 0; p < q->soa.count && mass > 0.0; p++) {
        if (!starts_in(ctx, dem, set, p)) continue;
        for (size_t k = 0; k < 3; k++) q->applied[4 * p + k] += force[k] * own_mass(q, p) / mass;
    }
}

static void free_slots(gn_dem *dem) {
    gn_prescription *f = &dem->prescribed;
    void *blocks[] = {f->set, f->mask, f->velocity, f->load, dem->channel_set, dem->set_reaction};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *f = (gn_prescription){0};
    dem->channel_set = NULL;
    dem->set_reaction = NULL;
}

static gneiss_status allocate_slots(const gn_step_context *ctx, gn_dem *dem, size_t count,
                                    gneiss_error *error) {
    gn_prescription *f = &dem->prescribed;
    f->count = count;
    f->set = gn_alloc_array(count + 1, sizeof *f->set);
    f->mask = gn_alloc_array(count + 1, sizeof *f->mask);
    f->velocity = gn_alloc_array(count + 1, 6 * sizeof *f->velocity);
    f->load = gn_alloc_array(count + 1, 6 * sizeof *f->load);
    dem->channel_set = gn_alloc_array(count + 1, 6 * sizeof *dem->channel_set);
    dem->set_reaction = gn_alloc_array(ctx->scene.set_count + 1, 6 * sizeof *dem->set_reaction);
    if (!f->set || !f->mask || !f->velocity || !f->load || !dem->channel_set || !dem->set_reaction)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu prescribed particles", count);
    return GNEISS_OK;
}

/* Assigns each prescribed component of a particle to the last set that prescribes it. */
static gneiss_status make_slots(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    size_t count = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        q->slot[p] = -1;
        for (size_t s = 0; s < ctx->scene.set_count && q->slot[p] < 0; s++)
            if (motion_mask(&ctx->scene.sets[s].motion) && starts_in(ctx, dem, s, p))
                q->slot[p] = (int32_t)count++;
    }
    GN_TRY(allocate_slots(ctx, dem, count, error));
    for (size_t k = 0; k < 6 * count; k++) dem->channel_set[k] = -1;
    for (size_t p = 0; p < q->soa.count; p++) {
        int32_t slot = q->slot[p];
        for (size_t s = 0; slot >= 0 && s < ctx->scene.set_count; s++) {
            uint8_t mask = motion_mask(&ctx->scene.sets[s].motion);
            if (!mask || !starts_in(ctx, dem, s, p)) continue;
            dem->prescribed.set[slot] = (int32_t)s;
            dem->prescribed.mask[slot] |= mask;
            for (int k = 0; k < 6; k++)
                if (mask >> k & 1) dem->channel_set[6 * slot + k] = (int32_t)s;
        }
    }
    return GNEISS_OK;
}

static double prescribed_velocity(const gn_step_context *ctx, int32_t set, int k, double time) {
    const gn_set_def *s = &ctx->scene.sets[set];
    const double factor = k < 3 ? gn_control_of(ctx, s->name, k) : 1.0;
    return factor * gn_table_at(channel(&s->motion, k), time);
}

/* Particles of one set are consecutive. */
void gn_prescription_update(const gn_step_context *ctx, gn_dem *dem, double time) {
    gn_prescription *f = &dem->prescribed;
    for (int k = 0; k < 6; k++) {
        int32_t last = -1;
        double velocity = 0.0;
        for (size_t slot = 0; slot < f->count; slot++) {
            const int32_t s = dem->channel_set[6 * slot + (size_t)k];
            if (s < 0) continue;
            if (s != last) velocity = prescribed_velocity(ctx, s, k, time);
            last = s;
            f->velocity[6 * slot + (size_t)k] = velocity;
        }
    }
}

void gn_reactions_sum(const gn_step_context *ctx, gn_dem *dem) {
    memset(dem->set_reaction, 0, ctx->scene.set_count * 6 * sizeof *dem->set_reaction);
    for (size_t slot = 0; slot < dem->prescribed.count; slot++)
        for (int k = 0; k < 6; k++) {
            int32_t s =
                dem->channel_set[6 * slot + k]; /* the set, of several, that drives the component */
            if (s >= 0) dem->set_reaction[6 * s + k] += dem->prescribed.load[6 * slot + k];
        }
}

/* Gives prescribed components their prescribed value at the start, which avoids a jump. */
static void start_prescribed(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    gn_prescription_update(ctx, dem, 0.0);
    for (size_t p = 0; p < q->soa.count; p++) {
        int32_t slot = q->slot[p];
        for (int k = 0; slot >= 0 && k < 6; k++) {
            if (!(dem->prescribed.mask[slot] >> k & 1)) continue;
            double *target = k < 3 ? q->vel : q->spin;
            if (target) target[4 * p + k % 3] = dem->prescribed.velocity[6 * slot + k];
        }
    }
}

gneiss_status gn_sets_apply(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    for (size_t s = 0; s < ctx->scene.set_count; s++) apply_set(ctx, dem, &ctx->scene.sets[s]);
    if (!(ctx->effects & GN_FX_PRESCRIBED)) return GNEISS_OK;
    GN_TRY(make_slots(ctx, dem, error));
    start_prescribed(ctx, dem);
    return GNEISS_OK;
}

void gn_sets_push(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    if (q->applied) memset(q->applied, 0, q->soa.count * 4 * sizeof *q->applied);
    for (size_t k = 0; q->applied && k < ctx->scene.set_count; k++)
        if (ctx->scene.sets[k].has_force) share_force(ctx, dem, k);
    if (q->load)
        memcpy(q->load, q->applied,
               q->soa.count * 4 * sizeof *q->load); /* load is added to the pressure */
}

gneiss_status gn_sets_enter(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_sets_push(ctx, dem);
    if (!(ctx->effects & GN_FX_PRESCRIBED)) return GNEISS_OK;
    free_slots(dem);
    /* A jump of a velocity requires an impulse, whose work the kernel books. */
    GN_TRY(make_slots(ctx, dem, error));
    gn_prescription_update(ctx, dem, ctx->time);
    return GNEISS_OK;
}
