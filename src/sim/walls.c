/* Plane walls: contacts with particles (few, so plain scalar code), motion, servo, work. */
#include "base/memory.h"
#include "kernels/dashpot.h"
#include "scene/facing.h"
#include "sim/body_walls.h"
#include "sim/conversion.h"
#include "sim/internal.h"
#include "sim/origin.h"
#include "sim/servo.h"
#include "sim/touch.h"

#include <math.h>
#include <string.h>

/* A plane may be given by a point far along it, whose coordinates would round the gap and the
 * motion of the wall; then the foot of the perpendicular from the origin takes its place. */
static void take_near_point(const gn_world *w, gn_wall *wall) {
    const double *p = wall->point;
    double far = fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2])));
    if (far <= gn_origin_reach(w->dem.radius_min)) return;
    double distance = gn_dot3(p, wall->normal);
    for (int a = 0; a < 3; a++) wall->point[a] = distance * wall->normal[a];
}

gneiss_status gn_walls_create(gn_world *w, gneiss_error *error) {
    size_t count = w->scene.wall_count;
    w->boundary.walls = gn_alloc_array(count + 1, sizeof *w->boundary.walls);
    w->boundary.wall_normals = gn_alloc_array(count + 1, 4 * sizeof *w->boundary.wall_normals);
    if (!w->boundary.walls || !w->boundary.wall_normals)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for walls");
    for (size_t k = 0; k < count; k++) {
        gn_wall *wall = &w->boundary.walls[k];
        const gn_wall_def *def = &w->scene.walls[k];
        memcpy(wall->point, def->point, sizeof wall->point);
        memcpy(wall->normal, def->normal, sizeof wall->normal);
        take_near_point(w, wall);
        memcpy(wall->start, wall->point, sizeof wall->start);
        memcpy(w->boundary.wall_normals + 4 * k, def->normal, sizeof def->normal);
        for (int a = 0; a < 3; a++) wall->velocity[a] = gn_table_at(&def->motion.velocity[a], 0.0);
    }
    return GNEISS_OK;
}

static double wall_gap(const gn_world *w, size_t particle, size_t wall) {
    const double *x = w->dem.particles.pos + 4 * particle;
    return gn_wall_distance(&w->boundary.walls[wall], x) - x[3];
}

/* What overlaps with passive walls as the run begins is free of stress, and so is who wakes in a
 * wall of any kind: the elements that it comes from did not feel it. Who is awake is listed before
 * it touches. */
static double free_gap(const gn_world *w, size_t particle, size_t wall, bool first) {
    const bool is_free = first ? w->scene.walls[wall].passive : gn_converts(w);
    return is_free ? fmin(0.0, wall_gap(w, particle, wall)) : 0.0;
}

static bool near_wall(const gn_world *w, size_t p, size_t k) {
    return w->dem.particles.vel[4 * p + 3] > 0.0 && wall_gap(w, p, k) <= w->dem.verlet.skin;
}

/* Old and new list are both sorted by (particle, wall); the old one is already renumbered. -1: it
 * was not there. */
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

static void carry_over(gn_wall_contacts *now, const gn_wall_contacts *old, size_t c) {
    int32_t from = place_before(old, now->i[c], now->wall[c]);
    if (from >= 0) gn_soa_keep(&gn_wall_contact_record, now, c, 1, old, &from);
}

/* Walls and facets near a particle, ascending, into `found` (NULL: only counted). */
static size_t neighbours(const gn_world *w, size_t p, int32_t *found) {
    size_t count = 0;
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        if (!near_wall(w, p, k)) continue;
        if (found) found[count] = (int32_t)k;
        count++;
    }
    if (w->effects & GN_FX_FACETS) count += gn_surfaces_near(w, p, found ? found + count : NULL);
    return count;
}

static gneiss_status count_rows(gn_world *w, size_t *count, gneiss_error *error) {
    size_t n = w->dem.particles.soa.count;
    int64_t sum = 0;
#pragma omp parallel for schedule(dynamic, 256) num_threads(w->threads)
    for (size_t p = 0; p < n; p++) w->boundary.first[p + 1] = (int32_t)neighbours(w, p, NULL);
    w->boundary.first[0] = 0;
    for (size_t p = 0; p < n; p++) {
        sum += w->boundary.first[p + 1];
        if (sum > INT32_MAX)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "expected fewer than %d contacts with walls and facets, found more",
                           INT32_MAX);
        w->boundary.first[p + 1] = (int32_t)sum;
    }
    *count = (size_t)sum;
    return GNEISS_OK;
}

gneiss_status gn_wall_contacts_find(gn_world *w, bool first, gneiss_error *error) {
    size_t n = w->dem.particles.soa.count, count = 0;
    if (!(w->effects & GN_FX_WALLS)) return GNEISS_OK;
    if (!w->boundary.first) w->boundary.first = gn_alloc_array(n + 2, sizeof *w->boundary.first);
    if (!w->boundary.first)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for wall contacts");
    gn_surfaces_refer(w);
    GN_TRY(count_rows(w, &count, error));
    gn_wall_contacts old = w->boundary.contacts, now = {0};
    GN_TRY(gn_soa_create(&gn_wall_contact_record, &now, count, w->effects, error));
#pragma omp parallel for schedule(dynamic, 256) num_threads(w->threads)
    for (size_t p = 0; p < n; p++) {
        size_t begin = (size_t)w->boundary.first[p], end = (size_t)w->boundary.first[p + 1];
        if (begin < end) neighbours(w, p, now.wall + begin);
        for (size_t c = begin; c < end; c++) {
            size_t k = (size_t)now.wall[c];
            now.i[c] = (int32_t)p;
            if (k < w->scene.wall_count) now.gap0[c] = free_gap(w, p, k, first);
            carry_over(&now, &old, c);
        }
    }
    gn_soa_destroy(&gn_wall_contact_record, &old);
    w->boundary.contacts = now;
    for (size_t k = 0; k < w->scene.wall_count; k++) w->boundary.walls[k].travel = 0.0;
    return gn_surfaces_check_centres(w, error);
}

/* What moves along the normal; the gap and the arm of the contact force are given back as well. */
static gn_touch touch_of(const gn_world *w, size_t c, double v[3], double *arm) {
    const gn_particles *q = &w->dem.particles;
    const gn_wall_contacts *list = &w->boundary.contacts;
    size_t p = (size_t)list->i[c], k = (size_t)list->wall[c];
    const gn_wall *wall = &w->boundary.walls[k];
    double gap = wall_gap(w, p, k);
    gn_touch s = {.gap = gap - list->gap0[c], .rounding = GN_OVERLAP_ROUNDING * q->pos[4 * p + 3]};
    *arm = q->pos[4 * p + 3] + (w->scene.contact_arm == GN_ARM_MIDPOINT ? gap : 0.0);
    for (int a = 0; a < 3; a++) {
        s.n[a] = -wall->normal[a];
        v[a] = wall->velocity[a] - q->vel[4 * p + a];
    }
    s.speed = gn_dot3(v, s.n);
    /* A contact that stays without a dashpot needs no mass. */
    if (w->effects & GN_FX_CONTACT_DAMPING || gn_touch_crosses(&s, s.speed * w->dt_past))
        s.inverse_mass = gn_inverse_mass_along(w, p, s.n);
    return s;
}

/* What moves across it. */
static void touch_across(const gn_world *w, size_t p, const double v[3], double arm, gn_touch *s) {
    const gn_particles *q = &w->dem.particles;
    double turn[3] = {0, 0, 0};
    if (q->spin) {
        gn_cross3(q->spin + 4 * p, s->n, turn);
        s->twist = gn_dot3(q->spin + 4 * p, s->n);
    }
    for (int a = 0; a < 3; a++) s->relative[a] = v[a] - s->speed * s->n[a] - arm * turn[a];
}

/* Most listed contacts do not touch, and hold nothing from when they did. */
static bool idle(const gn_wall_contacts *q, size_t c, const gn_touch *s, double path) {
    if (s->gap < 0.0 || s->gap < path || (q->fd && q->fd[c] != 0.0)) return false;
    size_t stride = q->soa.capacity;
    for (size_t a = 0; a < 3; a++)
        if ((q->shear && q->shear[c + a * stride] != 0.0) ||
            (q->roll && q->roll[c + a * stride] != 0.0))
            return false;
    return true;
}

static void wall_contact(gn_world *w, size_t c, gn_contact_sums *sums) {
    gn_wall_contacts *q = &w->boundary.contacts;
    double arm, v[3], t[3], *row = q->row + 8 * c, moment[3], couple[3] = {0, 0, 0};
    gn_touch s = touch_of(w, c, v, &arm);
    if (idle(q, c, &s, s.speed * w->dt_past)) {
        memset(row, 0, 8 * sizeof *row);
        return;
    }
    const gn_touch_side law = gn_wall_side(w, (size_t)q->wall[c], (size_t)q->i[c]);
    if (q->shear) touch_across(w, (size_t)q->i[c], v, arm, &s);
    if (q->closeness) s.closeness = q->closeness + c;
    if (q->roll) {
        s.roll = q->roll + c;
        s.roll_stride = q->soa.capacity;
        s.couple = couple;
        const double *spin = w->dem.particles.spin + 4 * (int64_t)q->i[c];
        for (int a = 0; a < 3; a++) s.spin[a] = -spin[a];
    }
    double total = gn_touch_force(w, &law, c, &s, q->fd ? q->fd + c : NULL,
                                  q->shear ? q->shear + c : NULL, q->soa.capacity, t, sums);
    gn_cross3(s.n, t, moment);
    for (int a = 0; a < 3; a++) {
        row[a] = total * s.n[a] + t[a];
        row[4 + a] = arm * moment[a] + couple[a];
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) sums->stress[3 * a + b] += row[a] * arm * s.n[b];
}

void gn_wall_presses(const gn_world *w, size_t row, double force[3]) {
    double arm, v[3];
    gn_touch s = touch_of(w, row, v, &arm);
    const gn_touch_step step = gn_touch_step_of(w);
    const gn_touch_side law = gn_wall_side(w, (size_t)w->boundary.contacts.wall[row],
                                           (size_t)w->boundary.contacts.i[row]);
    double total = gn_linear_press(&step, &law, &s);
    for (int a = 0; a < 3; a++) force[a] += total * s.n[a];
}

void gn_wall_contacts_work(gn_world *w, size_t begin, size_t end, gn_contact_sums *sums) {
    for (size_t c = begin; c < end;) {
        if ((size_t)w->boundary.contacts.wall[c] < w->scene.wall_count)
            wall_contact(w, c++, sums);
        else
            c = gn_surface_contacts_work(w, c, end, sums);
    }
}

/* By Hertz's law of one that is pressed as far as is expected: a servo moves a wall the less, the
 * stiffer it finds the contacts. */
static double expected_stiffness(const gn_world *w, size_t k, size_t p) {
    gn_touch_side side = gn_wall_side(w, k, p);
    return gn_touch_spring(w, &side, w->dem.particles.vel[4 * p + 3], gn_pressed_touch(w, p)).kn;
}

/* Of the spring of a wall contact as far as it is pressed. */
static double spring_stiffness(const gn_world *w, size_t c) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    size_t p = (size_t)q->i[c], k = (size_t)q->wall[c];
    if (w->effects & GN_FX_HERTZ) return expected_stiffness(w, k, p);
    gn_touch_side side = gn_wall_side(w, k, p);
    return gn_touch_spring(w, &side, w->dem.particles.vel[4 * p + 3],
                           fmax(q->gap0[c] - wall_gap(w, p, k), 0.0))
        .kn;
}

double gn_wall_held(const gn_world *w, size_t row) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    const size_t p = (size_t)q->i[row], k = (size_t)q->wall[row];
    const gn_wall *wall = &w->boundary.walls[k];
    const double *v = w->dem.particles.vel + 4 * p;
    const double overlap = fmax(q->gap0[row] - wall_gap(w, p, k), 0.0);
    const double force = overlap > 0.0 ? spring_stiffness(w, row) * overlap : 0.0;
    double away = 0.0;
    for (int a = 0; a < 3; a++) away += (v[a] - wall->velocity[a]) * wall->normal[a];
    return 0.5 * force * (overlap + w->dt_past * away);
}

/* Force that a wall contact gives for a path of the wall made in one step, over that path: the
 * spring, and the dashpot that sees the path as a velocity. (Without it a servo overshoots at small
 * steps.) */
static double step_stiffness(const gn_world *w, size_t c) {
    double k = spring_stiffness(w, c);
    double inverse_mass = w->dem.particles.vel[4 * (int64_t)w->boundary.contacts.i[c] + 3];
    if (!(inverse_mass > 0.0)) return k;
    return k + gn_dashpot(k, inverse_mass, w->dem.damping_fraction, w->dt) / w->dt;
}

void gn_walls_sum(gn_world *w) {
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        gn_wall *wall = &w->boundary.walls[k];
        for (int a = 0; a < 3; a++) wall->force[a] = 0.0;
        wall->stiffness = 0.0;
    }
    for (size_t c = 0; c < w->boundary.contacts.soa.count; c++) {
        if ((size_t)w->boundary.contacts.wall[c] >= w->scene.wall_count) continue;
        const double *row = w->boundary.contacts.row + 8 * c;
        gn_wall *wall = &w->boundary.walls[w->boundary.contacts.wall[c]];
        for (int a = 0; a < 3; a++) wall->force[a] -= row[a];
        bool servo = w->scene.walls[w->boundary.contacts.wall[c]].servo.active;
        if (servo && gn_dot3(row, row) > 0.0) wall->stiffness += step_stiffness(w, c);
    }
}

/* The path that led here closes with the force it led to, the coming one begins with it. */
void gn_walls_book(const gn_world *w, double dt, gn_energy *ledger) {
    for (size_t k = 0; k < w->scene.wall_count; k++)
        ledger->work_walls -=
            0.5 * dt * gn_dot3(w->boundary.walls[k].force, w->boundary.walls[k].velocity);
}

/* Sum of the springs alone that press the wall. */
static double springs_of(const gn_world *w, size_t k) {
    double sum = 0.0;
    for (size_t c = 0; c < w->boundary.contacts.soa.count; c++) {
        const double *row = w->boundary.contacts.row + 8 * c;
        if ((size_t)w->boundary.contacts.wall[c] == k && gn_dot3(row, row) > 0.0)
            sum += spring_stiffness(w, c);
    }
    return sum + gn_body_walls_pressing(w, k, false);
}

/* The largest relaxation that leaves the loop of wall and particles stable. The wall moves by
 * rho (F* - F)/K with K = sum k + c/dt; the force F answers with sum g (w - x), g(z) = k + c (1 -
 * 1/z)/dt, the displacements x with M (z - 2 + 1/z)/dt^2 x = forces. Eliminating w leaves the
 * particles as with a wall at rest, but for the springs at the wall, which are in series with a
 * dashpot, the servo: their part G = sum g along (g) becomes G (z - 1)/(z - 1 + rho G/K). On the
 * unit circle its imaginary part has one sign, so that nothing crosses it but at z = -1, and there
 * the part is 1/(1 - r/2) times that of the wall at rest, with r = rho (sum k + 2 c/dt)/K.
 * Stiffness times that factor must stay below 4 M/dt^2. With a wall at rest it may be 4 M/limit^2
 * at most, of which dashpots are felt as 2 c/dt: so with s = dt/limit r <= 2 (1 - s^2), with
 * dashpots r <= 2 (1 - s). Whether it is one particle or many does not matter: the bound takes all
 * of the fastest mode to be at the wall. r = 1 takes up all that is missing in one step; more than
 * that is never of use. Where the step is at its limit a little has to be left to move the wall. */
double gn_servo_share(const gn_world *w) {
    double share = fmin(1.0, w->dt / w->stable);
    bool dashpots = w->dem.damping_fraction > 0.0;
    return fmax(0.01, fmin(1.0, 2.0 * (1.0 - (dashpots ? share : share * share))));
}

double gn_world_servo_relaxation(const gn_world *w, size_t wall) {
    double stiffness = w->boundary.walls[wall].stiffness, most = gn_servo_share(w);
    bool dashpots = w->dem.damping_fraction > 0.0;
    if (!dashpots || !(stiffness > 0.0)) return most;
    return most * stiffness / (2.0 * stiffness - springs_of(w, wall));
}

/* Stiffness of the contacts that do not press yet but would within `path` of the wall, if their
 * particles go on as they do. */
static double stiffness_within(const gn_world *w, size_t k, double path) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    double sum = 0.0;
    for (size_t c = 0; c < q->soa.count; c++) {
        const double *row = q->row + 8 * c;
        if ((size_t)q->wall[c] != k || gn_dot3(row, row) > 0.0) continue;
        size_t p = (size_t)q->i[c];
        double along = gn_dot3(w->dem.particles.vel + 4 * p, w->boundary.walls[k].normal);
        if (wall_gap(w, p, k) - q->gap0[c] + w->dt * fmin(0.0, along) < path)
            sum += step_stiffness(w, c);
    }
    return sum + gn_body_walls_within(w, k, path);
}

/* K by which the wall goes force/K in a step for `force` more, at most the path `most`: of what
 * presses (one contact's if nothing does) and of what is reached on the way, with the longest way
 * d, to a thousandth, for which d K(d) <= force. So a crowd that is met in one step takes no more
 * than the force that is missing, and the wall goes on as it came: a path for what presses alone
 * would be too long by the number of particles, at any step. */
static double servo_stiffness(const gn_world *w, size_t k, double force, double most) {
    double pressed = w->boundary.walls[k].stiffness;
    double alone =
        w->effects & GN_FX_HERTZ ? expected_stiffness(w, k, 0) : w->scene.walls[k].stiffness;
    double least = pressed > 0.0 ? pressed : alone;
    double high = fmin(force / least, most);
    if (!(high > 0.0)) return least;
    double over = pressed + stiffness_within(w, k, high);
    if (high * over <= force) return least;
    double low = force / over, under = pressed + stiffness_within(w, k, low);
    while (low < 0.999 * high && under != over) {
        double middle = 0.5 * (low + high), found = pressed + stiffness_within(w, k, middle);
        bool fits = middle * found <= force;
        *(fits ? &low : &high) = middle;
        *(fits ? &under : &over) = found;
    }
    return under == over ? over : force / low;
}

double gn_wall_area(const gn_world *w, size_t wall) {
    gn_facing f;
    double area = w->scene.walls[wall].servo.area;
    if (!(area > 0.0) && gn_wall_covers_open_axis(&w->scene, wall)) return gn_box_section(w);
    if (area > 0.0 || !gn_facing_find(&w->scene, wall, &f)) return area;
    area = 1.0;
    for (size_t k = 0; k < f.count; k++) {
        const gn_wall *to = &w->boundary.walls[f.pair[k][1]];
        area *= fabs(gn_wall_distance(&w->boundary.walls[f.pair[k][0]], to->point));
    }
    return area;
}

double gn_wall_wanted(const gn_world *w, size_t wall, double time) {
    const gn_servo *servo = &w->scene.walls[wall].servo;
    if (servo->force.count) return gn_table_at(&servo->force, time);
    return gn_table_at(&servo->stress, time) * gn_wall_area(w, wall);
}

/* Servo: the wall is moved along its normal by the share `relaxation`, if that is stable, of what
 * the springs need to take up the missing force. */
static void servo_velocity(gn_world *w, size_t k) {
    const gn_servo *servo = &w->scene.walls[k].servo;
    gn_wall *wall = &w->boundary.walls[k];
    double relaxation = fmin(servo->relaxation, gn_world_servo_relaxation(w, k));
    gn_servo_look look = {.wanted = gn_wall_wanted(w, k, w->time),
                          .found = -gn_dot3(wall->force, wall->normal),
                          .most = servo->max_velocity};
    double stiffness =
        servo_stiffness(w, k, relaxation * (look.wanted - look.found), servo->max_velocity * w->dt);
    /* Springs at the wall and behind them, one after the other. */
    double uniform = wall->behind > 0.0 ? 1.0 / (1.0 + stiffness / wall->behind) : 1.0;
    look.pace = relaxation / (stiffness * w->dt);
    look.answer = gn_servo_answer(relaxation, uniform);
    if (!(wall->stiffness > 0.0)) { /* it approaches, and follows nothing */
        wall->servo = (gn_servo_state){0};
        look.answer = 0.0;
    }
    double speed = gn_servo_speed(&wall->servo, &look);
    for (int a = 0; a < 3; a++) wall->velocity[a] = speed * wall->normal[a];
}

/* m: how far centres reach along a direction. */
static double extent_along(const gn_world *w, const double n[3]) {
    double low = INFINITY, high = -INFINITY;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        double at = gn_dot3(w->dem.particles.pos + 4 * p, n);
        low = fmin(low, at);
        high = fmax(high, at);
    }
    return high - low;
}

void gn_walls_listed(gn_world *w) {
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        gn_wall *wall = &w->boundary.walls[k];
        const double n[1][3] = {{wall->normal[0], wall->normal[1], wall->normal[2]}};
        double spring, dashpot, length;
        if (!w->scene.walls[k].servo.active) continue;
        gn_servo_answers(w, false, 1, n, &spring, &dashpot);
        length = extent_along(w, n[0]);
        wall->behind = length > 0.0 && spring > 0.0 ? spring / (length * length) : 0.0;
    }
}

void gn_walls_move(gn_world *w) {
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        gn_wall *wall = &w->boundary.walls[k];
        const gn_motion *motion = &w->scene.walls[k].motion;
        if (w->scene.walls[k].servo.active)
            servo_velocity(w, k);
        else
            wall->servo = (gn_servo_state){0};
        for (int a = 0; a < 3 && !w->scene.walls[k].servo.active; a++)
            wall->velocity[a] = gn_control_of(w, w->scene.walls[k].name, a) *
                                gn_table_at(&motion->velocity[a], w->time + 0.5 * w->dt);
        for (int a = 0; a < 3; a++) wall->point[a] += w->dt * wall->velocity[a];
        wall->travel += w->dt * fabs(gn_dot3(wall->velocity, wall->normal));
    }
}
