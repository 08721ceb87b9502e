/* One step of the model: lists, forces of all parts, exchanges between them, motion, and what it
 * all sums up to. */
#include "base/point.h"
#include "sim/exchange.h"
#include "sim/parts.h"
#include "soa/single.h"

#include <math.h>
#include <string.h>

gn_contact_args gn_world_contact_args(const gn_world *w, const gn_contacts *list, bool measure) {
    gn_contact_args a = {0};
    a.pos = w->dem.particles.pos;
    a.vel = w->dem.particles.vel;
    a.spin = w->dem.particles.spin;
    a.pos_f = w->dem.particles.travel_f;
    a.vel_f = w->dem.particles.vel_f;
    a.spin_f = w->dem.particles.spin_f;
    a.contacts = list;
    a.uniform = list == &w->dem.bonds ? w->dem.bond_uniform : w->dem.pair_uniform;
    a.partials = list == &w->dem.bonds ? &w->dem.bond_partials : &w->dem.pair_partials;
    a.dt = w->dt_past;
    a.speed_most = w->dem.speed_most;
    a.arm_factor = w->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    memcpy(a.period, w->period, sizeof a.period);
    for (int k = 0; k < 3; k++) a.inverse_period[k] = w->period[k] > 0.0 ? 1.0 / w->period[k] : 0.0;
    a.time = w->time;
    a.measure = measure;
    return a;
}

gn_motion_args gn_world_motion_args(gn_world *w, bool measure) {
    gn_motion_args a = {0};
    a.particles = &w->dem.particles;
    a.bonds = &w->dem.bond_partials;
    a.pairs = &w->dem.pair_partials;
    a.wall_contacts = w->effects & GN_FX_WALLS ? &w->boundary.contacts : NULL;
    a.wall_first = w->boundary.first;
    a.prescribed = w->effects & GN_FX_PRESCRIBED ? &w->dem.prescribed : NULL;
    a.dt_past = w->dt_past;
    a.dt = w->dt;
    memcpy(a.gravity, w->scene.gravity, sizeof a.gravity);
    a.damping = w->scene.background_coefficient;
    a.hold = w->dem.hold.count ? &w->dem.hold : NULL;
    a.damping_lead = w->scene.background_velocity == GN_VELOCITY_INSTANT ? 0.5 : 0.0;
    a.measure = measure;
    return a;
}

/* --- merging, in block order --- */

static void add_contact_sums(gn_contact_sums *total, const gn_contact_sums *blocks, size_t count) {
    for (size_t b = 0; b < count; b++) gn_contact_sums_add(total, &blocks[b]);
}

static gn_motion_sums add_motion_sums(const gn_motion_sums *blocks, size_t count) {
    gn_motion_sums s = {.bad = -1};
    for (size_t b = 0; b < count; b++) gn_motion_sums_add(&s, &blocks[b]);
    return s;
}

/* Mean resultant on a particle over the mean contact force: small when the model is quasi-static.
 */
static double unbalanced_ratio(const gn_world *w, double resultant, double force, double contacts) {
    size_t particles = w->dem.particles.soa.count - w->dem.prescribed.count;
    if (force <= 0.0 || !particles) return 0.0;
    return resultant / (double)particles / (force / contacts);
}

/* First halves of the works close the interval that led here; the reading lies between the halves.
 */
static void merge_before(gn_world *w, const gn_motion_sums *m, bool measure) {
    gn_contact_sums bonds = {0}, pairs = {0}, walls = {0};
    if (w->dem.bonds.soa.count)
        add_contact_sums(&bonds, w->dem.bond_sums, w->dem.bond_partials.blocks);
    if (w->dem.pairs.soa.count)
        add_contact_sums(&pairs, w->dem.pair_sums, w->dem.pair_partials.blocks);
    add_contact_sums(&walls, w->boundary.sums, w->effects & GN_FX_WALLS ? w->dem.motion_blocks : 0);
    gn_energy *e = &w->energy;
    e->friction += bonds.friction + pairs.friction + walls.friction;
    e->contact_damping += bonds.contact_damping + pairs.contact_damping + walls.contact_damping;
    e->bond_breaking += bonds.bond_breaking;
    w->dem.broken_tension += bonds.broken_tension;
    w->dem.broken_shear += bonds.broken_shear;
    e->background_damping += m->damping[0];
    e->work_gravity += m->gravity[0];
    e->work_applied += m->applied[0];
    e->work_prescribed += m->prescribed[0];
    if (!measure) return;
    double translation, rotation;
    gn_bodies_kinetic(w, &translation, &rotation);
    e->kinetic = m->kinetic + translation;
    e->rotational = m->rotational + rotation;
    e->elastic_normal = bonds.elastic_normal + pairs.elastic_normal;
    e->elastic_shear = bonds.elastic_shear + pairs.elastic_shear;
    e->elastic_wall = walls.elastic_normal;
    /* Bonds that are made beyond their strength break in the first evaluation: what they release
     * was stored. */
    if (w->step == 0) e->stored_at_start = gn_energy_stored(e) + e->bond_breaking;
    w->unbalanced = unbalanced_ratio(w, m->resultant, bonds.force + pairs.force,
                                     bonds.carrying + pairs.carrying);
    for (int k = 0; k < 9; k++)
        w->stress[k] = (bonds.stress[k] + pairs.stress[k] + walls.stress[k]) / w->volume;
}

static void merge_after(gn_world *w, const gn_motion_sums *m) {
    w->energy.background_damping += m->damping[1];
    w->energy.work_gravity += m->gravity[1];
    w->energy.work_applied += m->applied[1];
    w->energy.work_prescribed += m->prescribed[1];
}

/* --- going bad --- */

static gneiss_status fail_particle(const gn_world *w, size_t p, const char *what,
                                   gneiss_error *error) {
    const gn_particles *q = &w->dem.particles;
    const double *x = q->pos + 4 * p, *v = q->vel + 4 * p;
    char at[GN_POINT_SIZE], behind[GN_NAME_SIZE + 128] = "";
    for (size_t k = 0; k < w->scene.wall_count && !*behind; k++)
        if (!w->scene.walls[k].passive && gn_wall_distance(&w->boundary.walls[k], x) < 0.0)
            snprintf(behind, sizeof behind,
                     "; its centre is behind wall '%s', which pushes it out (gneiss check says how "
                     "many are)",
                     w->scene.walls[k].name);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: particle %d %s: position %s m, velocity (%g, %g, %g) m/s, radius %g "
        "m; the step is %.3g s, its stability limit was estimated as %.3g s%s",
        (long long)w->step, w->time, q->id[p], what, gn_point_text(w->scene.origin, x, at), v[0],
        v[1], v[2], x[3], w->dt, w->stable, behind);
}

static gneiss_status check_motion(const gn_world *w, const gn_motion_sums *m, gneiss_error *error) {
    if (m->bad >= 0)
        return fail_particle(w, (size_t)m->bad, "has a velocity that is not finite", error);
    double path = w->dt * sqrt(m->speed2);
    if (path <= 0.5 * w->dem.radius_min) return GNEISS_OK;
    size_t worst = 0;
    double most = -1.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const double *v = w->dem.particles.vel + 4 * p;
        double v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        if (v2 > most) {
            most = v2;
            worst = p;
        }
    }
    return fail_particle(w, worst, "moved farther in one step than half the smallest radius",
                         error);
}

/* A step of no length on a copy, in double: whatever limits it would reach stays in the copy. */
static gneiss_status observe(const gn_world *w, const gn_contacts *list, gn_contacts *copy,
                             gneiss_error *error) {
    gn_effects effects = (list->soa.effects & ~(gn_effects)GN_FX_MIXED) | GN_FX_CONTACT_FORCES;
    gn_contact_kernel *kernel;
    GN_TRY(gn_contact_kernel_choose(w->kernels, effects, &kernel, error));
    GN_TRY(gn_soa_copy(&gn_contact_record, copy, list, effects, error));
    gn_contacts_from_single(copy, list);
    gn_contacts_pad(copy, &w->dem.particles);
    gn_contact_args args = gn_world_contact_args(w, copy, false);
    args.partials = NULL;
    args.uniform = (gn_uniform){0};
    args.dt = 0.0;
    size_t count = copy->soa.count; /* without partial sums, any cut into blocks will do */
#pragma omp parallel for schedule(static) num_threads(w->threads)
    for (size_t c = 0; c < count; c += GN_CONTACT_BLOCK) {
        gn_contact_sums sums = {0};
        kernel(&args, c, c + GN_CONTACT_BLOCK < count ? c + GN_CONTACT_BLOCK : count, &sums);
    }
    return GNEISS_OK;
}

gneiss_status gn_world_observe(const gn_world *w, gn_observed *observed, gneiss_error *error) {
    *observed = (gn_observed){0};
    gneiss_status status = observe(w, &w->dem.bonds, &observed->bonds, error);
    if (status == GNEISS_OK) status = observe(w, &w->dem.pairs, &observed->pairs, error);
    if (status != GNEISS_OK) gn_observed_free(observed);
    return status;
}

void gn_observed_free(gn_observed *observed) {
    gn_soa_destroy(&gn_contact_record, &observed->bonds);
    gn_soa_destroy(&gn_contact_record, &observed->pairs);
}

/* Forces of the instant, and the motion of all that does not wait for an exchange. */
static void find_forces(gn_world *w, const gn_motion_args *motion, bool measure) {
    gn_contact_args bonds = gn_world_contact_args(w, &w->dem.bonds, measure);
    gn_contact_args pairs = gn_world_contact_args(w, &w->dem.pairs, measure);
    if (w->dem.particles.soa.count) gn_sweep(w, &bonds, &pairs, motion);
    gn_walls_sum(w);
    gn_surfaces_sum(w);
    if (w->elements) gn_elements_forces(w, measure);
}

/* Elements beside particles are no part of the specimen; alone they are it. */
static void measure_elements(gn_world *w) {
    const gn_element_model *q = w->elements;
    bool alone = !w->scene.has_specimen;
    if (alone) memcpy(w->stress, q->stress, sizeof w->stress);
    w->unbalanced = alone ? q->unbalanced : fmax(w->unbalanced, q->unbalanced);
    gn_elements_book(w);
}

/* What waited, and what moves as a whole. */
static gneiss_status move(gn_world *w, const gn_motion_args *motion, bool measure,
                          gneiss_error *error) {
    if (w->dem.hold.count) gn_sweep_held(w, motion);
    gn_motion_sums moved = add_motion_sums(w->dem.motion_sums, w->dem.motion_blocks);
    gn_bodies_kick(w);
    merge_before(w, &moved, measure);
    if (measure) w->reading = w->energy;
    if (w->effects & GN_FX_PRESCRIBED) gn_reactions_sum(w);
    merge_after(w, &moved);
    gn_walls_move(w);
    gn_bodies_drift(w);
    w->dem.speed_most = sqrt(moved.speed2) * (1.0 + 1e-6);
    w->dem.verlet.drift += w->dt * sqrt(moved.speed2);
    GN_TRY(check_motion(w, &moved, error));
    GN_TRY(gn_paths_check(w, error));
    if (measure) GN_TRY(gn_paths_check_spins(w, error));
    if (!w->elements) return GNEISS_OK;
    GN_TRY(gn_elements_move(w, measure, error));
    if (measure) measure_elements(w);
    return gn_paths_check_nodes(w, error);
}

gneiss_status gn_world_step(gn_world *w, bool measure, gneiss_error *error) {
    GN_TRY(gn_world_refresh_lists(w, error));
    if (w->effects & GN_FX_PRESCRIBED) gn_prescription_update(w, w->time + 0.5 * w->dt);
    gn_motion_args motion = gn_world_motion_args(w, measure);
    find_forces(w, &motion, measure);
    GN_TRY(gn_exchanges_act(w, error));
    gneiss_status status = move(w, &motion, measure, error);
    w->dem.contact_steps += (int64_t)(w->dem.bonds.soa.count + w->dem.pairs.soa.count);
    w->time += w->dt;
    w->dt_past = w->dt;
    w->step++;
    return status;
}
