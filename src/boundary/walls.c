/* Plane walls: contacts with particles (few, so plain scalar code), motion, servo, work. */
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/contact_rows.h"
#include "boundary/surfaces.h"
#include "drive/servo.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "kernels/dashpot.h"
#include "particles/expected_overlap.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "scene/acts.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* Replaces the point of the plane by the foot of the perpendicular from the origin: the coordinates
 * of a distant point would round the gap and the motion of the wall. */
static void take_near_point(const gn_dem *dem, gn_wall *wall) {
    const double *p = wall->point;
    double far = fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2])));
    if (far <= gn_finest_reach(dem->radius_min)) return;
    double distance = gn_dot3(p, wall->normal);
    for (int a = 0; a < 3; a++) wall->point[a] = distance * wall->normal[a];
}

gneiss_status gn_walls_list_normals(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error) {
    const size_t count = ctx->scene.wall_count;
    boundary->wall_normals = gn_alloc_array(count + 1, 4 * sizeof *boundary->wall_normals);
    if (!boundary->wall_normals) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for walls");
    for (size_t k = 0; k < count; k++)
        memcpy(boundary->wall_normals + 4 * k, boundary->walls[k].normal, 3 * sizeof(double));
    return GNEISS_OK;
}

gneiss_status gn_walls_create(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary,
                              gneiss_error *error) {
    size_t count = ctx->scene.wall_count;
    GN_TRY(gn_new(&boundary->walls, count + 1, "walls", error));
    for (size_t k = 0; k < count; k++) {
        gn_wall *wall = &boundary->walls[k];
        const gn_wall_def *def = &ctx->scene.walls[k];
        memcpy(wall->point, def->point, sizeof wall->point);
        memcpy(wall->normal, def->normal, sizeof wall->normal);
        take_near_point(dem, wall);
        memcpy(wall->start, wall->point, sizeof wall->start);
        for (int a = 0; a < 3; a++) wall->velocity[a] = gn_table_at(&def->motion.velocity[a], 0.0);
    }
    return gn_walls_list_normals(ctx, boundary, error);
}

static double wall_gap(const gn_dem *dem, const gn_boundary *boundary, size_t particle,
                       size_t wall) {
    const double *x = dem->particles.pos + 4 * particle;
    return gn_wall_distance(&boundary->walls[wall], x) - x[3];
}

/* Returns the overlap that is free of stress: that with passive walls at the start; also that of a
 * particle that becomes active within any wall, because the wall did not act on its element. An
 * active particle is listed before it touches. */
static double free_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       size_t particle, size_t wall, bool first) {
    const bool is_free = first ? ctx->scene.walls[wall].passive : gn_converts(ctx);
    return is_free ? fmin(0.0, wall_gap(dem, boundary, particle, wall)) : 0.0;
}

/* Finds the row in the old list; both lists are sorted by (particle, wall), and the old one has
 * been renumbered. -1: there is none. */
static int32_t place_before(const gn_wall_contacts *old, int32_t i, int32_t wall) {
    size_t low = 0, high = old->soa.count;
    while (low < high) {
        size_t mid = (low + high) / 2;
        bool before = old->i[mid] < i || (old->i[mid] == i && old->wall[mid] < wall);
        if (before)
            low = mid + 1;
        else
            high = mid;
    }
    if (low == old->soa.count || old->i[low] != i || old->wall[low] != wall) return -1;
    return (int32_t)low;
}

/* Tells whether a particle adheres to the wall, at any gap. */
static bool adheres(const gn_wall_contacts *old, size_t p, size_t k) {
    if (!old->bridge) return false;
    int32_t from = place_before(old, (int32_t)p, (int32_t)k);
    return from >= 0 && old->bridge[from] > 0.0;
}

static bool near_wall(const gn_dem *dem, const gn_boundary *boundary, size_t p, size_t k) {
    return gn_particle_is_active(&dem->particles, p) &&
           (wall_gap(dem, boundary, p, k) <= dem->verlet.skin ||
            adheres(&boundary->contacts, p, k));
}

static void carry_over(gn_wall_contacts *now, const gn_wall_contacts *old, size_t c) {
    int32_t from = place_before(old, now->i[c], now->wall[c]);
    if (from >= 0) gn_soa_keep(&gn_wall_contact_record, now, c, 1, old, &from);
}

/* Writes the walls and facets near a particle, ascending, into `found` (NULL: only counts them). */
static size_t neighbours(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         size_t p, int32_t *found) {
    size_t count = 0;
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        if (!near_wall(dem, boundary, p, k)) continue;
        if (found) found[count] = (int32_t)k;
        count++;
    }
    if (ctx->effects & GN_FX_FACETS)
        count += gn_surfaces_near(ctx, dem, boundary, p, found ? found + count : NULL);
    return count;
}

static gneiss_status count_rows(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                size_t *count, gneiss_error *error) {
    size_t n = dem->particles.soa.count;
    int64_t sum = 0;
#pragma omp parallel for schedule(dynamic, 256) num_threads(ctx->threads)
    for (size_t p = 0; p < n; p++)
        boundary->first[p + 1] = (int32_t)neighbours(ctx, dem, boundary, p, NULL);
    boundary->first[0] = 0;
    for (size_t p = 0; p < n; p++) {
        sum += boundary->first[p + 1];
        if (sum > INT32_MAX)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "expected fewer than %d contacts with walls and facets, found more",
                           INT32_MAX);
        boundary->first[p + 1] = (int32_t)sum;
    }
    *count = (size_t)sum;
    return GNEISS_OK;
}

gneiss_status gn_wall_contacts_find(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                    bool first, gneiss_error *error) {
    size_t n = dem->particles.soa.count, count = 0;
    if (!(ctx->effects & GN_FX_WALLS)) return GNEISS_OK;
    if (!boundary->first) boundary->first = gn_alloc_array(n + 2, sizeof *boundary->first);
    if (!boundary->first) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for wall contacts");
    gn_surfaces_refer(boundary);
    GN_TRY(count_rows(ctx, dem, boundary, &count, error));
    gn_wall_contacts old = boundary->contacts, now = {0};
    GN_TRY(gn_soa_create(&gn_wall_contact_record, &now, count, ctx->effects, error));
#pragma omp parallel for schedule(dynamic, 256) num_threads(ctx->threads)
    for (size_t p = 0; p < n; p++) {
        size_t begin = (size_t)boundary->first[p], end = (size_t)boundary->first[p + 1];
        if (begin < end) neighbours(ctx, dem, boundary, p, now.wall + begin);
        for (size_t c = begin; c < end; c++) {
            size_t k = (size_t)now.wall[c];
            now.i[c] = (int32_t)p;
            if (k < ctx->scene.wall_count) now.gap0[c] = free_gap(ctx, dem, boundary, p, k, first);
            carry_over(&now, &old, c);
        }
    }
    gn_soa_destroy(&gn_wall_contact_record, &old);
    boundary->contacts = now;
    for (size_t k = 0; k < ctx->scene.wall_count; k++) boundary->walls[k].travel = 0.0;
    return gn_surfaces_check_centres(ctx, dem, boundary, error);
}

/* Computes the relative motion along the normal, and also the relative velocity and the arm of the
 * contact force. */
static gn_touch touch_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         size_t c, double v[3], double *arm) {
    const gn_particles *q = &dem->particles;
    const gn_wall_contacts *list = &boundary->contacts;
    size_t p = (size_t)list->i[c], k = (size_t)list->wall[c];
    const gn_wall *wall = &boundary->walls[k];
    double gap = wall_gap(dem, boundary, p, k);
    gn_touch s = {.gap = gap - list->gap0[c], .rounding = GN_OVERLAP_ROUNDING * q->pos[4 * p + 3]};
    *arm = q->pos[4 * p + 3] + (ctx->scene.contact_arm == GN_ARM_MIDPOINT ? gap : 0.0);
    for (int a = 0; a < 3; a++) {
        s.n[a] = -wall->normal[a];
        v[a] = wall->velocity[a] - q->vel[4 * p + a];
    }
    s.speed = gn_dot3(v, s.n);
    /* A contact that stays closed and has no dashpot requires no mass. */
    if (ctx->effects & GN_FX_CONTACT_DAMPING || gn_touch_crosses(&s, s.speed * ctx->dt_past))
        s.inverse_mass = gn_inverse_mass_along(dem, p, s.n);
    return s;
}

/* Computes the relative motion across the normal. */
static void touch_across(const gn_dem *dem, size_t p, const double v[3], double arm, gn_touch *s) {
    const gn_particles *q = &dem->particles;
    double turn[3] = {0, 0, 0};
    if (q->spin) {
        gn_cross3(q->spin + 4 * p, s->n, turn);
        s->twist = gn_dot3(q->spin + 4 * p, s->n);
    }
    for (int a = 0; a < 3; a++) s->relative[a] = v[a] - s->speed * s->n[a] - arm * turn[a];
}

/* Tells whether a contact needs no work: most listed contacts are open and have no history. */
static bool idle(const gn_wall_contacts *q, size_t c, const gn_touch *s, double path) {
    if (s->gap < 0.0 || s->gap < path || (q->fd && q->fd[c] != 0.0)) return false;
    if (q->bridge && q->bridge[c] > 0.0) return false;
    size_t stride = q->soa.capacity;
    for (size_t a = 0; a < 3; a++)
        if ((q->shear && q->shear[c + a * stride] != 0.0) ||
            (q->roll && q->roll[c + a * stride] != 0.0))
            return false;
    return true;
}

static void wall_contact(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, size_t c,
                         gn_contact_sums *sums) {
    gn_wall_contacts *q = &boundary->contacts;
    double arm, v[3], t[3], *row = q->row + 8 * c, moment[3], couple[3] = {0, 0, 0};
    gn_touch s = touch_of(ctx, dem, boundary, c, v, &arm);
    if (idle(q, c, &s, s.speed * ctx->dt_past)) {
        memset(row, 0, 8 * sizeof *row);
        return;
    }
    const gn_touch_side law = gn_wall_side(ctx, dem, (size_t)q->wall[c], (size_t)q->i[c]);
    if (q->shear) touch_across(dem, (size_t)q->i[c], v, arm, &s);
    if (q->closeness) s.closeness = q->closeness + c;
    if (q->bridge) {
        s.bridge = q->bridge + c;
        s.film = dem->particles.film + q->i[c];
    }
    if (q->roll) {
        s.roll = q->roll + c;
        s.roll_stride = q->soa.capacity;
        s.couple = couple;
        const double *spin = dem->particles.spin + 4 * (int64_t)q->i[c];
        for (int a = 0; a < 3; a++) s.spin[a] = -spin[a];
    }
    double total = gn_touch_force(ctx, dem, boundary, &law, c, &s, q->fd ? q->fd + c : NULL,
                                  q->shear ? q->shear + c : NULL, q->soa.capacity, t, sums);
    gn_cross3(s.n, t, moment);
    for (int a = 0; a < 3; a++) {
        row[a] = total * s.n[a] + t[a];
        row[4 + a] = arm * moment[a] + couple[a];
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) sums->stress[3 * a + b] += row[a] * arm * s.n[b];
}

void gn_wall_presses(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     size_t row, double force[3]) {
    double arm, v[3];
    gn_touch s = touch_of(ctx, dem, boundary, row, v, &arm);
    const gn_touch_step step = gn_touch_step_of(ctx, dem);
    const gn_touch_side law = gn_wall_side(ctx, dem, (size_t)boundary->contacts.wall[row],
                                           (size_t)boundary->contacts.i[row]);
    double total = gn_linear_press(&step, &law, &s);
    for (int a = 0; a < 3; a++) force[a] += total * s.n[a];
}

void gn_wall_contacts_work(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                           size_t begin, size_t end, gn_contact_sums *sums) {
    for (size_t c = begin; c < end;) {
        if ((size_t)boundary->contacts.wall[c] < ctx->scene.wall_count)
            wall_contact(ctx, dem, boundary, c++, sums);
        else
            c = gn_surface_contacts_work(ctx, dem, boundary, c, end, sums);
    }
}

/* Returns the stiffness by Hertz's law at the expected overlap; a servo moves a wall less if the
 * contacts are stiffer. */
static double expected_stiffness(const gn_step_context *ctx, const gn_dem *dem, size_t k,
                                 size_t p) {
    gn_touch_side side = gn_wall_side(ctx, dem, k, p);
    return gn_touch_spring(ctx, dem, &side, dem->particles.vel[4 * p + 3], gn_pressed_touch(dem, p))
        .kn;
}

/* Returns the stiffness of the spring of a wall contact at its overlap. */
static double spring_stiffness(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, size_t c) {
    const gn_wall_contacts *q = &boundary->contacts;
    size_t p = (size_t)q->i[c], k = (size_t)q->wall[c];
    if (ctx->effects & GN_FX_HERTZ) return expected_stiffness(ctx, dem, k, p);
    gn_touch_side side = gn_wall_side(ctx, dem, k, p);
    return gn_touch_spring(ctx, dem, &side, dem->particles.vel[4 * p + 3],
                           fmax(q->gap0[c] - wall_gap(dem, boundary, p, k), 0.0))
        .kn;
}

double gn_wall_held(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    size_t row) {
    const gn_wall_contacts *q = &boundary->contacts;
    const size_t p = (size_t)q->i[row], k = (size_t)q->wall[row];
    const gn_wall *wall = &boundary->walls[k];
    const double *v = dem->particles.vel + 4 * p;
    const double overlap = fmax(q->gap0[row] - wall_gap(dem, boundary, p, k), 0.0);
    const double force = overlap > 0.0 ? spring_stiffness(ctx, dem, boundary, row) * overlap : 0.0;
    double away = 0.0;
    for (int a = 0; a < 3; a++) away += (v[a] - wall->velocity[a]) * wall->normal[a];
    return 0.5 * force * (overlap + ctx->dt_past * away);
}

/* Returns the ratio of the force of a wall contact to a path of the wall in one step: the stiffness
 * of the spring plus the effect of the dashpot, for which the path is a velocity. (Without the
 * latter a servo overshoots at small steps.) */
static double step_stiffness(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, size_t c) {
    double k = spring_stiffness(ctx, dem, boundary, c);
    double inverse_mass = dem->particles.vel[4 * (int64_t)boundary->contacts.i[c] + 3];
    if (!(inverse_mass > 0.0)) return k;
    return k + gn_dashpot(k, inverse_mass, dem->damping_fraction, ctx->dt) / ctx->dt;
}

void gn_walls_sum(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary) {
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        gn_wall *wall = &boundary->walls[k];
        for (int a = 0; a < 3; a++) wall->force[a] = 0.0;
        wall->stiffness = 0.0;
    }
    for (size_t c = 0; c < boundary->contacts.soa.count; c++) {
        if ((size_t)boundary->contacts.wall[c] >= ctx->scene.wall_count) continue;
        const double *row = boundary->contacts.row + 8 * c;
        gn_wall *wall = &boundary->walls[boundary->contacts.wall[c]];
        for (int a = 0; a < 3; a++) wall->force[a] -= row[a];
        bool servo = ctx->scene.walls[boundary->contacts.wall[c]].servo.active;
        if (servo && gn_dot3(row, row) > 0.0)
            wall->stiffness += step_stiffness(ctx, dem, boundary, c);
    }
}

/* Adds the work of walls. Work is trapezoidal: half of the present force belongs to the last path,
 * and half to the coming one. */
void gn_walls_book(const gn_step_context *ctx, const gn_boundary *boundary, double dt,
                   gn_energy *ledger) {
    for (size_t k = 0; k < ctx->scene.wall_count; k++)
        ledger->work_walls -=
            0.5 * dt * gn_dot3(boundary->walls[k].force, boundary->walls[k].velocity);
}

/* Returns the sum of the springs that press the wall, without dashpots. */
static double springs_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         size_t k) {
    double sum = 0.0;
    for (size_t c = 0; c < boundary->contacts.soa.count; c++) {
        const double *row = boundary->contacts.row + 8 * c;
        if ((size_t)boundary->contacts.wall[c] == k && gn_dot3(row, row) > 0.0)
            sum += spring_stiffness(ctx, dem, boundary, c);
    }
    return sum + gn_body_walls_pressing(ctx, boundary, k, false);
}

double gn_wall_servo_relaxation(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t wall) {
    double stiffness = boundary->walls[wall].stiffness, most = gn_servo_share(ctx, dem);
    bool dashpots = dem->damping_fraction > 0.0;
    if (!dashpots || !(stiffness > 0.0)) return most;
    return most * stiffness / (2.0 * stiffness - springs_of(ctx, dem, boundary, wall));
}

/* Returns the stiffness of the open contacts that would close within a path `path` of the wall if
 * their particles continued to move as they do. */
static double stiffness_within(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, size_t k, double path) {
    const gn_wall_contacts *q = &boundary->contacts;
    double sum = 0.0;
    for (size_t c = 0; c < q->soa.count; c++) {
        const double *row = q->row + 8 * c;
        if ((size_t)q->wall[c] != k || gn_dot3(row, row) > 0.0) continue;
        size_t p = (size_t)q->i[c];
        double along = gn_dot3(dem->particles.vel + 4 * p, boundary->walls[k].normal);
        if (wall_gap(dem, boundary, p, k) - q->gap0[c] + ctx->dt * fmin(0.0, along) < path)
            sum += step_stiffness(ctx, dem, boundary, c);
    }
    return sum + gn_body_walls_within(ctx, boundary, k, path);
}

/* Returns the stiffness K such that the wall moves by force/K in a step for an additional `force`,
 * but at most by the path `most`. K is that of the closed contacts (of one contact if there are
 * none) plus that of the contacts that close on the path d, where d is the longest path, to a
 * thousandth, for which d K(d) <= force. Many contacts that close in one step therefore take no
 * more than the missing force together. A path computed from the closed contacts alone would be too
 * long by a factor of the number of particles, at any step. */
static double servo_stiffness(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, size_t k, double force, double most) {
    double pressed = boundary->walls[k].stiffness;
    double alone = ctx->effects & GN_FX_HERTZ ? expected_stiffness(ctx, dem, k, 0)
                                              : ctx->scene.walls[k].stiffness;
    double least = pressed > 0.0 ? pressed : alone;
    double high = fmin(force / least, most);
    if (!(high > 0.0)) return least;
    double over = pressed + stiffness_within(ctx, dem, boundary, k, high);
    if (high * over <= force) return least;
    double low = force / over, under = pressed + stiffness_within(ctx, dem, boundary, k, low);
    while (low < 0.999 * high && under != over) {
        double middle = 0.5 * (low + high),
               found = pressed + stiffness_within(ctx, dem, boundary, k, middle);
        bool fits = middle * found <= force;
        *(fits ? &low : &high) = middle;
        *(fits ? &under : &over) = found;
    }
    return under == over ? over : force / low;
}

/* Returns the area on which the stress of a servo wall acts, m2 (2D: m x 1 m). */
static double wall_area(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall) {
    gn_facing f;
    double area = ctx->scene.walls[wall].servo.area;
    if (!(area > 0.0) && gn_wall_covers_open_axis(&ctx->scene, wall)) return gn_box_section(ctx);
    if (area > 0.0 || !gn_facing_find(&ctx->scene, wall, &f)) return area;
    area = 1.0;
    for (size_t k = 0; k < f.count; k++) {
        const gn_wall *to = &boundary->walls[f.pair[k][1]];
        area *= fabs(gn_wall_distance(&boundary->walls[f.pair[k][0]], to->point));
    }
    return area;
}

/* Returns the stress, Pa, compression positive, on the first two walls that face each other across
 * an axis: the mean of both; `held`: whether one of them holds the mean stress. */
static double stress_along(const gn_step_context *ctx, const gn_boundary *boundary, int axis,
                           bool *held) {
    double sum = 0.0;
    *held = false;
    for (int sense = -1; sense <= 1; sense += 2) {
        const int k = gn_scene_wall_facing(&ctx->scene, axis, sense);
        const gn_wall *wall = &boundary->walls[k];
        sum -= 0.5 * gn_dot3(wall->force, wall->normal) / wall_area(ctx, boundary, (size_t)k);
        *held = *held || ctx->scene.walls[k].servo.of_mean;
    }
    return sum;
}

/* Returns the target of the stress of a servo wall, and the part of the difference that it may make
 * up; walls that hold the mean stress share what the other axes leave of it, as sides of a periodic
 * box do (drive/box.c). */
static double stress_wanted(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                            double time, double *part) {
    const gn_servo *servo = &ctx->scene.walls[wall].servo;
    const int dimension = (int)ctx->scene.dimension;
    const double wanted = gn_table_at(&servo->stress, time);
    double left = dimension * wanted, count = 0.0;
    *part = 1.0;
    if (!servo->of_mean) return wanted;
    for (int a = 0; a < dimension; a++) {
        bool held;
        const double found = stress_along(ctx, boundary, a, &held);
        if (held)
            count += 1.0;
        else
            left -= found;
    }
    *part = count / dimension;
    return left / count;
}

double gn_wall_wanted(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                      double time, double *part) {
    const gn_servo *servo = &ctx->scene.walls[wall].servo;
    *part = 1.0;
    if (servo->force.count) return gn_table_at(&servo->force, time);
    return stress_wanted(ctx, boundary, wall, time, part) * wall_area(ctx, boundary, wall);
}

/* Sets the velocity of a servo wall: along its normal it moves by the fraction `relaxation`, which
 * must be stable, of the path in which the springs take up the missing force. */
static void servo_velocity(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary,
                           size_t k) {
    const gn_servo *servo = &ctx->scene.walls[k].servo;
    gn_wall *wall = &boundary->walls[k];
    double part;
    const double wanted = gn_wall_wanted(ctx, boundary, k, ctx->time, &part);
    double relaxation =
        part * fmin(servo->relaxation, gn_wall_servo_relaxation(ctx, dem, boundary, k));
    gn_servo_look look = {.wanted = wanted,
                          .found = -gn_dot3(wall->force, wall->normal),
                          .most = servo->max_velocity};
    double stiffness =
        servo_stiffness(ctx, dem, boundary, k, relaxation * (look.wanted - look.found),
                        servo->max_velocity * ctx->dt);
    /* The springs at the wall and the material behind it act in series. */
    double uniform = wall->behind > 0.0 ? 1.0 / (1.0 + stiffness / wall->behind) : 1.0;
    look.pace = relaxation / (stiffness * ctx->dt);
    look.answer = gn_servo_answer(relaxation, uniform);
    if (!(wall->stiffness > 0.0)) { /* without contact the wall approaches */
        wall->servo = (gn_servo_state){0};
        look.answer = 0.0;
    }
    double speed = gn_servo_speed(&wall->servo, &look);
    for (int a = 0; a < 3; a++) wall->velocity[a] = speed * wall->normal[a];
}

/* Returns the extent of the centres along a direction, m. */
static double extent_along(const gn_dem *dem, const double n[3]) {
    double low = INFINITY, high = -INFINITY;
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        double at = gn_dot3(dem->particles.pos + 4 * p, n);
        low = fmin(low, at);
        high = fmax(high, at);
    }
    return high - low;
}

void gn_walls_listed(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary) {
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        gn_wall *wall = &boundary->walls[k];
        const double n[1][3] = {{wall->normal[0], wall->normal[1], wall->normal[2]}};
        double spring, dashpot, length;
        if (!ctx->scene.walls[k].servo.active) continue;
        gn_servo_answers(ctx, dem, false, 1, n, &spring, &dashpot);
        length = extent_along(dem, n[0]);
        wall->behind = length > 0.0 && spring > 0.0 ? spring / (length * length) : 0.0;
    }
}

void gn_walls_move(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary) {
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        gn_wall *wall = &boundary->walls[k];
        const gn_motion *motion = &ctx->scene.walls[k].motion;
        if (ctx->scene.walls[k].servo.active)
            servo_velocity(ctx, dem, boundary, k);
        else
            wall->servo = (gn_servo_state){0};
        for (int a = 0; a < 3 && !ctx->scene.walls[k].servo.active; a++)
            wall->velocity[a] = gn_control_of(ctx, ctx->scene.walls[k].name, a) *
                                gn_table_at(&motion->velocity[a], ctx->time + 0.5 * ctx->dt);
        for (int a = 0; a < 3; a++) wall->point[a] += ctx->dt * wall->velocity[a];
        wall->travel += ctx->dt * fabs(gn_dot3(wall->velocity, wall->normal));
    }
}

void gn_walls_take_velocities(const gn_step_context *ctx, gn_boundary *boundary) {
    for (size_t k = 0; k < ctx->scene.wall_count; k++)
        for (int a = 0; a < 3; a++)
            boundary->walls[k].velocity[a] =
                gn_table_at(&ctx->scene.walls[k].motion.velocity[a], ctx->time);
}
