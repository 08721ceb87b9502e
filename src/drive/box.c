#include "drive/box.h"

#include "drive/servo.h"
#include "world/internal.h"

#include <math.h>
#include <string.h>

/* No step may strain the box by more: first-order motion of places and branches would show. */
static const double most_strain = 1e-3;

bool gn_box_moved(const gn_world *w) {
    for (int a = 0; a < 3; a++)
        if (w->box.flow[a] != 0.0) return true;
    return false;
}

bool gn_box_moves(const gn_world *w) {
    return w->effects & GN_FX_PERIODIC && (gn_scene_box_moves(&w->scene) || gn_box_moved(w));
}

void gn_box_create(gn_world *w) {
    memcpy(w->box.start, w->period, sizeof w->box.start);
}

double gn_box_strain(const gn_world *w, int axis) {
    double start = w->box.start[axis];
    return start > 0.0 ? w->period[axis] / start - 1.0 : 0.0;
}

double gn_box_section(const gn_world *w) {
    double area = 1.0;
    for (int a = 0; a < (int)w->scene.dimension; a++)
        if (gn_scene_periodic_along(&w->scene, a)) area *= w->period[a];
    return area;
}

/* --- how contacts answer --- */

void gn_box_listed(gn_world *w) {
    const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double radius = 0.0, range = w->effects & GN_FX_BONDS ? w->scene.interaction_range : 0.0;
    w->box.path = 0.0;
    if (!gn_box_moves(w)) return;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        radius = fmax(radius, w->dem.particles.pos[4 * p + 3]);
    w->box.reach = 2.0 * radius * (1.0 + range) + w->dem.verlet.skin;
    gn_servo_answers(w, true, (size_t)w->scene.dimension, axes, w->box.spring, w->box.dashpot);
}

double gn_box_speed(const gn_world *w) {
    double most = 0.0;
    for (int a = 0; a < 3; a++) most = fmax(most, fabs(w->box.flow[a]));
    return most * w->box.reach;
}

/* --- the stress --- */

void gn_box_sum_stress(const gn_world *w, const gn_contacts *list, size_t begin, size_t end,
                       double sum[9]) {
    const size_t width = (size_t)gn_contacts_row_width(list);
    const int dimension = (int)w->scene.dimension;
    for (int k = 0; k < 9; k++) sum[k] = 0.0;
    for (size_t c = begin; c < end; c++) {
        const double *x = w->dem.particles.pos + 4 * (size_t)list->i[c],
                     *y = w->dem.particles.pos + 4 * (size_t)list->j[c];
        const double *f = gn_contacts_row(list) + width * c;
        double l[3];
        gn_branch(w, x, y, l);
        for (int a = 0; a < dimension; a++)
            for (int b = 0; b < dimension; b++) sum[3 * a + b] += f[a] * l[b];
    }
}

/* --- the strain of the coming step --- */

/* Sum of f_a l_a over all contacts: the mean stress times the volume, tension positive. */
static double strained_by(const gn_world *w, int a) {
    const gn_dem_sums *s = &w->dem.done;
    return s->bonds.stress[4 * a] + s->pairs.stress[4 * a];
}

/* The servo asks for a strain of which the contacts would make up the missing stress, times a
 * share. Stability: let u be what particles do besides, e the strains of the sides that follow a
 * stress, B e what these do to branches, K the springs. The stress answers with T = B^T K (u + B
 * e), the servo with D de = -rho T per step, D diagonal. Without e the springs become K - rho K B
 * ((z - 1) D + rho B^T K B)^-1 B^T K. D - B^T K B has no negative eigenvalue: of one contact B^T K
 * B has the entries k l_a^2 n_a^2 and, beside them, k l^2 n_a^2 n_b^2 at most, so that rows sum up
 * to what `spring` has. So at z = -1, the only place where the unit circle is crossed, it is at
 * most K/(1 - rho/2), as for a wall (gn_world_servo_relaxation), and the same share is stable. */
static double follow_stress(gn_world *w, int a) {
    const gn_box_side *side = &w->scene.box[a];
    const double answer = w->box.spring[a] + 2.0 * w->box.dashpot[a] / w->dt;
    const double most = fmin(side->max_rate * w->dt, most_strain);
    const double share = side->relaxation > 0.0 ? side->relaxation : 0.1;
    const double taken = fmin(share, gn_servo_share(w));
    gn_servo_look look = {.wanted = -gn_table_at(&side->stress, w->time) * w->volume,
                          .found = strained_by(w, a),
                          .pace = taken / (answer * w->dt),
                          .answer = gn_servo_answer(taken, w->box.spring[a] / answer),
                          .most = most / w->dt};
    if (answer > 0.0) return w->dt * gn_servo_speed(&w->box.servo[a], &look);
    w->box.servo[a] = (gn_servo_state){0};
    return look.wanted != look.found ? copysign(most, look.wanted - look.found) : 0.0;
}

static double strain_of(gn_world *w, int a) {
    const gn_box_side *side = &w->scene.box[a];
    if (side->stress.count) return follow_stress(w, a);
    w->box.servo[a] = (gn_servo_state){0};
    return w->dt * gn_table_at(&side->rate, w->time + 0.5 * w->dt);
}

/* --- motion --- */

void gn_box_book(gn_world *w) {
    if (!gn_box_moved(w)) return;
    for (int a = 0; a < (int)w->scene.dimension; a++)
        w->energy.work_walls += 0.5 * w->dt_past * w->box.flow[a] * strained_by(w, a);
}

/* Places, velocities; what the latter take, J. */
static double carry_along(gn_world *w, const double grown[3]) {
    gn_particles *q = &w->dem.particles;
    double taken = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        double inverse_mass = q->vel[4 * p + 3];
        for (int a = 0; a < (int)w->scene.dimension; a++) {
            double *x = q->pos + 4 * p + a, *ref = q->ref + 4 * p + a, *v = q->vel + 4 * p + a;
            double before = *v, corner = w->scene.periodic_min[a];
            *x = corner + grown[a] * (*x - corner);
            *ref = corner + grown[a] * (*ref - corner);
            *v /= grown[a];
            if (inverse_mass > 0.0) taken += 0.5 * (*v * *v - before * before) / inverse_mass;
        }
    }
    return taken;
}

static gneiss_status too_fast(const gn_world *w, int a, double strain, gneiss_error *error) {
    char key[] = "periodic.x.rate";
    key[9] = "xyz"[a];
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a strain of at most %g in a step of %g s, "
                   "found %g",
                   gn_scene_at(&w->scene, w->scene.box[a].rate_where, key).text, most_strain, w->dt,
                   strain);
}

gneiss_status gn_box_narrowed(const gn_world *w, gneiss_status found, gneiss_error *error) {
    char was[GNEISS_MESSAGE_SIZE];
    int least = -1;
    if (found != GNEISS_ERROR_INPUT || w->step == 0 || !gn_box_moved(w)) return found;
    for (int a = 0; a < (int)w->scene.dimension; a++)
        if (w->period[a] > 0.0 && (least < 0 || w->period[a] < w->period[least])) least = a;
    if (least < 0) return found;
    const bool servo = w->scene.box[least].stress.count > 0;
    snprintf(was, sizeof was, "%s", error->message);
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "step %lld, t = %g s: %s of side '%c' has shrunk the box to %.3g of its length "
                   "(%s)%s",
                   (long long)w->step, w->time, servo ? "the servo" : "the rate", "xyz"[least],
                   1.0 + gn_box_strain(w, least), was,
                   servo ? ": what it presses on does not bear the stress" : "");
}

gneiss_status gn_box_move(gn_world *w, gneiss_error *error) {
    double grown[3] = {1.0, 1.0, 1.0}, widest = 0.0;
    if (!gn_box_moves(w)) return GNEISS_OK;
    for (int a = 0; a < (int)w->scene.dimension; a++) {
        double strain = strain_of(w, a);
        if (fabs(strain) > most_strain) return too_fast(w, a, strain, error);
        grown[a] = 1.0 + strain;
        w->energy.work_walls += 0.5 * strain * strained_by(w, a);
        w->box.flow[a] = strain / (grown[a] * w->dt);
        widest = fmax(widest, fabs(strain));
    }
    w->energy.work_walls += carry_along(w, grown);
    for (int a = 0; a < (int)w->scene.dimension; a++) {
        w->period[a] *= grown[a];
        w->volume *= grown[a];
    }
    w->box.path += widest * w->box.reach;
    return GNEISS_OK;
}
