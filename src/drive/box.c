#include "drive/box.h"

#include "base/error.h"
#include "drive/servo.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* Largest strain of the box in a step. Larger strains would show that positions and branches are
 * only of first order. */
static const double most_strain = 1e-3;

void gn_box_create(const gn_step_context *ctx, gn_periodic_box *box) {
    memcpy(box->start, ctx->period, sizeof box->start);
}

/* --- response of contacts --- */

void gn_box_listed(const gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box) {
    const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double radius = 0.0, range = ctx->effects & GN_FX_BONDS ? ctx->scene.interaction_range : 0.0;
    box->path = 0.0;
    if (!gn_box_moves(ctx, box)) return;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        radius = fmax(radius, dem->particles.pos[4 * p + 3]);
    box->reach = 2.0 * radius * (1.0 + range) + dem->verlet.skin;
    gn_servo_answers(ctx, dem, true, (size_t)ctx->scene.dimension, axes, box->spring, box->dashpot);
}

/* --- the stress --- */

void gn_box_sum_stress(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t begin, size_t end, double sum[9]) {
    const size_t width = (size_t)gn_contacts_row_width(list);
    const int dimension = (int)ctx->scene.dimension;
    for (int k = 0; k < 9; k++) sum[k] = 0.0;
    for (size_t c = begin; c < end; c++) {
        const double *x = dem->particles.pos + 4 * (size_t)list->i[c],
                     *y = dem->particles.pos + 4 * (size_t)list->j[c];
        const double *f = gn_contacts_row(list) + width * c;
        double l[3];
        gn_branch(ctx, x, y, l);
        for (int a = 0; a < dimension; a++)
            for (int b = 0; b < dimension; b++) sum[3 * a + b] += f[a] * l[b];
    }
}

/* --- the strain of the coming step --- */

/* Returns the sum of f_a l_a over all contacts: the mean stress times the volume, tension positive.
 */
static double strained_by(const gn_dem *dem, int a) {
    const gn_dem_sums *s = &dem->done;
    return s->contacts.stress[4 * a];
}

/* Returns the target of a side's sum of f_a l_a. Sides that hold the mean stress p share what the
 * other axes leave of it: in d dimensions m of them have the target (d p - sum of the other
 * stresses)/m each. The difference from the target then contains (1 + (d - m)/m) = d/m times the
 * response of one axis if all axes respond alike, so that their share of the difference is reduced
 * by m/d: *part. */
static double wanted_along(const gn_step_context *ctx, const gn_dem *dem, int a, double *part) {
    const int dimension = (int)ctx->scene.dimension;
    const gn_box_side *sides = ctx->scene.box;
    const double wanted = -gn_table_at(&sides[a].stress, ctx->time) * ctx->volume;
    double left = dimension * wanted, count = 0.0;
    *part = 1.0;
    if (!sides[a].of_mean) return wanted;
    for (int b = 0; b < dimension; b++) {
        if (sides[b].of_mean)
            count += 1.0;
        else
            left -= strained_by(dem, b);
    }
    *part = count / dimension;
    return left / count;
}

/* Returns the strain of the coming step: a fraction of the strain at which the contacts would
 * supply the missing stress. Stability: let u be the other motions of particles, e the strains of
 * the sides that follow a stress, B e their effect on branches, and K the springs. The stress
 * responds with T = B^T K (u + B e), and the servo with D de = -rho T per step, D diagonal.
 * Eliminating e replaces the springs by K - rho K B ((z - 1) D + rho B^T K B)^-1 B^T K. D - B^T K B
 * has no negative eigenvalue: for one contact B^T K B has the entries k l_a^2 n_a^2 and, off the
 * diagonal, at most k l^2 n_a^2 n_b^2, so that row sums are at most the value of `spring`. At z =
 * -1, the only place where the unit circle is crossed, the springs are therefore at most K/(1 -
 * rho/2), as for a wall (gn_wall_servo_relaxation), and the same fraction is stable. */
static double follow_stress(const gn_step_context *ctx, const gn_dem *dem, gn_periodic_box *box,
                            int a) {
    const gn_box_side *side = &ctx->scene.box[a];
    const double answer = box->spring[a] + 2.0 * box->dashpot[a] / ctx->dt;
    const double most = fmin(side->max_rate * ctx->dt, most_strain);
    const double share = side->relaxation > 0.0 ? side->relaxation : 0.1;
    double part = 1.0;
    const double wanted = wanted_along(ctx, dem, a, &part);
    const double taken = part * fmin(share, gn_servo_share(ctx, dem));
    gn_servo_look look = {.wanted = wanted,
                          .found = strained_by(dem, a),
                          .pace = taken / (answer * ctx->dt),
                          .answer = gn_servo_answer(taken, box->spring[a] / answer),
                          .most = most / ctx->dt};
    if (answer > 0.0) return ctx->dt * gn_servo_speed(&box->servo[a], &look);
    box->servo[a] = (gn_servo_state){0};
    return look.wanted != look.found ? copysign(most, look.wanted - look.found) : 0.0;
}

static double strain_of(const gn_step_context *ctx, const gn_dem *dem, gn_periodic_box *box,
                        int a) {
    const gn_box_side *side = &ctx->scene.box[a];
    if (side->stress.count) return follow_stress(ctx, dem, box, a);
    box->servo[a] = (gn_servo_state){0};
    return ctx->dt * gn_table_at(&side->rate, ctx->time + 0.5 * ctx->dt);
}

/* --- motion --- */

void gn_box_book(const gn_step_context *ctx, const gn_dem *dem, gn_periodic_box *box,
                 gn_ledger *ledger) {
    if (!gn_box_moved(box)) return;
    for (int a = 0; a < (int)ctx->scene.dimension; a++)
        ledger->energy.work_walls += 0.5 * ctx->dt_past * box->flow[a] * strained_by(dem, a);
}

/* Moves particles with the box: scales positions and velocities; returns the energy, J, that the
 * change of velocities requires. */
static double carry_along(const gn_step_context *ctx, gn_dem *dem, const double grown[3]) {
    gn_particles *q = &dem->particles;
    double taken = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        double inverse_mass = q->vel[4 * p + 3];
        for (int a = 0; a < (int)ctx->scene.dimension; a++) {
            double *x = q->pos + 4 * p + a, *ref = q->ref + 4 * p + a, *v = q->vel + 4 * p + a;
            double before = *v, corner = ctx->scene.periodic_min[a];
            *x = corner + grown[a] * (*x - corner);
            *ref = corner + grown[a] * (*ref - corner);
            *v /= grown[a];
            if (inverse_mass > 0.0) taken += 0.5 * (*v * *v - before * before) / inverse_mass;
        }
    }
    return taken;
}

static gneiss_status too_fast(const gn_step_context *ctx, int a, double strain,
                              gneiss_error *error) {
    char key[] = "periodic.x.rate";
    key[9] = "xyz"[a];
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a strain of at most %g in a step of %g s, "
                   "found %g",
                   gn_scene_at(&ctx->scene, ctx->scene.box[a].rate_where, key).text, most_strain,
                   ctx->dt, strain);
}

gneiss_status gn_box_move(gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box,
                          gn_ledger *ledger, gneiss_error *error) {
    double grown[3] = {1.0, 1.0, 1.0}, widest = 0.0;
    if (!gn_box_moves(ctx, box)) return GNEISS_OK;
    for (int a = 0; a < (int)ctx->scene.dimension; a++) {
        double strain = strain_of(ctx, dem, box, a);
        if (fabs(strain) > most_strain) return too_fast(ctx, a, strain, error);
        grown[a] = 1.0 + strain;
        ledger->energy.work_walls += 0.5 * strain * strained_by(dem, a);
        box->flow[a] = strain / (grown[a] * ctx->dt);
        widest = fmax(widest, fabs(strain));
    }
    ledger->energy.work_walls += carry_along(ctx, dem, grown);
    for (int a = 0; a < (int)ctx->scene.dimension; a++) {
        ctx->period[a] *= grown[a];
        ctx->volume *= grown[a];
    }
    box->path += widest * box->reach;
    return GNEISS_OK;
}
