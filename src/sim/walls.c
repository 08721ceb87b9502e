/* Plane walls: contacts with particles (few, so plain scalar code), motion, servo, work. */
#include "base/memory.h"
#include "sim/parts.h"

#include <math.h>
#include <string.h>

/* Normal from the particle into the wall, as for a second particle of infinite mass. */
typedef struct wall_state {
    double n[3], gap, arm, speed, relative[3];
} wall_state;

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *r) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

gneiss_status gn_walls_create(gn_world *w, gneiss_error *error) {
    size_t count = w->scene.wall_count;
    w->walls = gn_alloc_array(count + 1, sizeof *w->walls);
    w->wall_normals = gn_alloc_array(count + 1, 4 * sizeof *w->wall_normals);
    if (!w->walls || !w->wall_normals)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for walls");
    for (size_t k = 0; k < count; k++) {
        gn_wall *wall = &w->walls[k];
        const gn_wall_def *def = &w->scene.walls[k];
        memcpy(wall->point, def->point, sizeof wall->point);
        memcpy(wall->start, def->point, sizeof wall->start);
        memcpy(wall->normal, def->normal, sizeof wall->normal);
        memcpy(w->wall_normals + 4 * k, def->normal, sizeof def->normal);
        for (int a = 0; a < 3; a++) wall->velocity[a] = gn_table_at(&def->motion.velocity[a], 0.0);
    }
    return GNEISS_OK;
}

static double wall_gap(const gn_world *w, size_t particle, size_t wall) {
    const double *x = w->particles.pos + 4 * particle;
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = x[a] - w->walls[wall].point[a];
    return dot(d, w->walls[wall].normal) - x[3];
}

static bool near_wall(const gn_world *w, size_t p, size_t k) {
    return w->particles.vel[4 * p + 3] > 0.0 && wall_gap(w, p, k) <= w->verlet.skin;
}

/* Old and new list are both sorted by (particle, wall); the old one is already renumbered. */
static void carry_over(gn_wall_contacts *now, const gn_wall_contacts *old, size_t c) {
    size_t low = 0, high = old->soa.count;
    while (low < high) {
        size_t mid = (low + high) / 2;
        bool before =
            old->i[mid] < now->i[c] || (old->i[mid] == now->i[c] && old->wall[mid] < now->wall[c]);
        if (before)
            low = mid + 1;
        else
            high = mid;
    }
    if (low == old->soa.count || old->i[low] != now->i[c] || old->wall[low] != now->wall[c]) return;
    for (int a = 0; now->shear && a < 3; a++)
        now->shear[c + (size_t)a * now->soa.capacity] =
            old->shear[low + (size_t)a * old->soa.capacity];
    now->gap0[c] = old->gap0[low];
    if (now->fd) now->fd[c] = old->fd[low];
}

gneiss_status gn_wall_contacts_find(gn_world *w, gneiss_error *error) {
    size_t n = w->particles.soa.count, walls = w->scene.wall_count, count = 0;
    if (!(w->effects & GN_FX_WALLS)) return GNEISS_OK;
    if (!w->wall_first) w->wall_first = gn_alloc_array(n + 2, sizeof *w->wall_first);
    if (!w->wall_first) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for wall contacts");
    for (size_t p = 0; p < n; p++) {
        w->wall_first[p] = (int32_t)count;
        for (size_t k = 0; k < walls; k++) count += near_wall(w, p, k);
    }
    w->wall_first[n] = (int32_t)count;
    gn_wall_contacts old = w->wall_contacts, now = {0};
    GN_TRY(gn_soa_create(&gn_wall_contact_record, &now, count, w->effects, error));
    bool first = w->verlet.rebuilds == 0;
    for (size_t p = 0, c = 0; p < n; p++)
        for (size_t k = 0; k < walls; k++) {
            if (!near_wall(w, p, k)) continue;
            now.i[c] = (int32_t)p;
            now.wall[c] = (int32_t)k;
            if (first && w->scene.walls[k].passive) now.gap0[c] = fmin(0.0, wall_gap(w, p, k));
            carry_over(&now, &old, c++);
        }
    gn_soa_destroy(&gn_wall_contact_record, &old);
    w->wall_contacts = now;
    for (size_t k = 0; k < walls; k++) w->walls[k].travel = 0.0;
    return GNEISS_OK;
}

static wall_state kinematics(const gn_world *w, size_t p, size_t k) {
    const gn_particles *q = &w->particles;
    const gn_wall *wall = &w->walls[k];
    wall_state s;
    s.gap = wall_gap(w, p, k);
    s.arm = q->pos[4 * p + 3] + (w->scene.contact_arm == GN_ARM_MIDPOINT ? s.gap : 0.0);
    double v[3], turn[3] = {0, 0, 0};
    for (int a = 0; a < 3; a++) {
        s.n[a] = -wall->normal[a];
        v[a] = wall->velocity[a] - q->vel[4 * p + a];
    }
    s.speed = dot(v, s.n);
    if (q->spin) cross(q->spin + 4 * p, s.n, turn);
    for (int a = 0; a < 3; a++) s.relative[a] = v[a] - s.speed * s.n[a] - s.arm * turn[a];
    return s;
}

/* Coulomb friction with radial return; returns the dissipated energy. The normal of a plane does
 * not turn, so the old force only follows the spin about the normal. */
static double friction(const gn_world *w, const wall_state *s, size_t c, double kt, double limit,
                       double t[3], double *elastic) {
    gn_wall_contacts *q = (gn_wall_contacts *)(uintptr_t)&w->wall_contacts;
    size_t stride = q->soa.capacity;
    double old[3], trial[3], side[3], size2 = 0.0;
    for (int a = 0; a < 3; a++) old[a] = q->shear[c + (size_t)a * stride];
    if (w->particles.spin && w->effects & GN_FX_SPACE) {
        double angle = 0.5 * w->dt_past * dot(w->particles.spin + 4 * (int64_t)q->i[c], s->n);
        cross(s->n, old, side);
        for (int a = 0; a < 3; a++) old[a] += angle * side[a] - 0.5 * angle * angle * old[a];
    }
    for (int a = 0; a < 3; a++) {
        trial[a] = old[a] + kt * w->dt_past * s->relative[a];
        size2 += trial[a] * trial[a];
    }
    double size = sqrt(size2), scale = size > limit ? limit / size : 1.0, lost = 0.0, now2 = 0.0;
    for (int a = 0; a < 3; a++) {
        t[a] = scale * trial[a];
        q->shear[c + (size_t)a * stride] = t[a];
        if (scale < 1.0) lost += 0.5 * (old[a] + t[a]) * (trial[a] - t[a]) / kt;
        now2 += t[a] * t[a];
    }
    *elastic += 0.5 * now2 / kt;
    return lost;
}

static void wall_contact(const gn_world *w, size_t c, gn_contact_sums *sums) {
    const gn_wall_contacts *q = &w->wall_contacts;
    size_t p = (size_t)q->i[c], k = (size_t)q->wall[c];
    const gn_wall_def *def = &w->scene.walls[k];
    wall_state s = kinematics(w, p, k);
    double overlap = s.gap - q->gap0[c]; /* negative while it presses */
    bool touching = overlap < 0.0;
    double normal = touching ? def->stiffness * overlap : 0.0, viscous = 0.0, t[3] = {0, 0, 0},
           elastic = 0.0;
    if (w->effects & GN_FX_CONTACT_DAMPING) {
        double alpha = w->damping_fraction;
        if (touching)
            viscous = 2.0 * alpha * sqrt(def->stiffness / w->particles.vel[4 * p + 3]) * s.speed;
        if (q->fd) {
            sums->contact_damping += 0.5 * (q->fd[c] + viscous) * s.speed * w->dt_past;
            q->fd[c] = viscous;
        }
    }
    double total = normal + viscous;
    if (q->shear && def->kratio > 0.0)
        sums->friction += friction(w, &s, c, def->stiffness / def->kratio,
                                   touching ? def->friction * fmax(-total, 0.0) : 0.0, t, &elastic);
    sums->elastic_normal += 0.5 * normal * overlap * touching + elastic;
    double *row = q->row + 8 * c, moment[3];
    cross(s.n, t, moment);
    for (int a = 0; a < 3; a++) {
        row[a] = total * s.n[a] + t[a];
        row[4 + a] = s.arm * moment[a];
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) sums->stress[3 * a + b] += row[a] * s.arm * s.n[b];
}

void gn_wall_contacts_work(const gn_world *w, size_t begin, size_t end, gn_contact_sums *sums) {
    for (size_t c = begin; c < end; c++) wall_contact(w, c, sums);
}

/* Force that a wall contact gives for a path of the wall made in one step, over that path: the
 * spring, and the dashpot that sees the path as a velocity. (Without it a servo overshoots at small
 * steps.) */
static double step_stiffness(const gn_world *w, size_t c) {
    double k = w->scene.walls[w->wall_contacts.wall[c]].stiffness;
    double inverse_mass = w->particles.vel[4 * (int64_t)w->wall_contacts.i[c] + 3];
    if (!(inverse_mass > 0.0)) return k;
    return k + 2.0 * w->damping_fraction * sqrt(k / inverse_mass) / w->dt;
}

void gn_walls_sum(gn_world *w) {
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        gn_wall *wall = &w->walls[k];
        for (int a = 0; a < 3; a++) wall->force[a] = 0.0;
        wall->stiffness = 0.0;
    }
    for (size_t c = 0; c < w->wall_contacts.soa.count; c++) {
        const double *row = w->wall_contacts.row + 8 * c;
        gn_wall *wall = &w->walls[w->wall_contacts.wall[c]];
        for (int a = 0; a < 3; a++) wall->force[a] -= row[a];
        if (dot(row, row) > 0.0) wall->stiffness += step_stiffness(w, c);
    }
    /* The path that led here closes with the force it led to (trapezoidal work of the walls). */
    for (size_t k = 0; k < w->scene.wall_count; k++)
        w->energy.work_walls -= 0.5 * w->dt_past * dot(w->walls[k].force, w->walls[k].velocity);
}

/* Servo: the wall is moved along its normal by the share `relaxation` of what the touching springs
 * need to take up the missing force. */
static void servo_velocity(gn_world *w, size_t k) {
    const gn_servo *servo = &w->scene.walls[k].servo;
    gn_wall *wall = &w->walls[k];
    double missing = gn_table_at(&servo->force, w->time) + dot(wall->force, wall->normal);
    double stiffness = wall->stiffness > 0.0 ? wall->stiffness : w->scene.walls[k].stiffness;
    double speed = servo->relaxation * missing / (stiffness * w->dt);
    speed = fmax(-servo->max_velocity, fmin(servo->max_velocity, speed));
    for (int a = 0; a < 3; a++) wall->velocity[a] = speed * wall->normal[a];
}

void gn_walls_move(gn_world *w) {
    for (size_t k = 0; k < w->scene.wall_count; k++) {
        gn_wall *wall = &w->walls[k];
        const gn_motion *motion = &w->scene.walls[k].motion;
        if (w->scene.walls[k].servo.active)
            servo_velocity(w, k);
        else
            for (int a = 0; a < 3; a++)
                wall->velocity[a] = gn_table_at(&motion->velocity[a], w->time + 0.5 * w->dt);
        for (int a = 0; a < 3; a++) wall->point[a] += w->dt * wall->velocity[a];
        wall->travel += w->dt * fabs(dot(wall->velocity, wall->normal));
        w->energy.work_walls -= 0.5 * w->dt * dot(wall->force, wall->velocity);
    }
}
