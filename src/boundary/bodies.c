/* Rigid bodies: creation from the scene and motion. Velocities belong to half steps and positions
 * to whole steps, as those of particles; for the free rotation see base/rotation.h. */
#include "base/error.h"
#include "base/new.h"
#include "base/rotation.h"
#include "base/vec3.h"
#include "boundary/body_pairs.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/overlap.h"
#include "boundary/surface.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "surfaces/body_shape.h"
#include "surfaces/facet.h"

#include <math.h>
#include <string.h>

/* --- orientation --- */

void gn_rigid_orientation(const gn_rigid *b, double turn[4]) {
    const double *s = b->turn_start, back[4] = {s[0], -s[1], -s[2], -s[3]};
    gn_turn_product(b->turn, back, turn);
    /* q and -q are the same rotation: either all four components change sign or none. */
    double sign = turn[0] < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 4; k++) turn[k] *= sign;
}

/* Rotates a body by a rotation vector. */
static void turn_by(gn_rigid *b, const double vector[3]) {
    double angle = sqrt(gn_dot3(vector, vector));
    if (!(angle > 0.0)) return;
    double s = sin(0.5 * angle) / angle;
    const double q[4] = {cos(0.5 * angle), s * vector[0], s * vector[1], s * vector[2]};
    gn_turn_product(q, b->turn, b->turn);
    gn_turn_settle(b->turn, b->axes);
}

static gn_rotor rotor_of(gn_rigid *b) {
    return (gn_rotor){b->turn, b->axes, b->momentum, b->inverse_inertia};
}

static bool turns_freely(const gn_rigid *b) {
    return b->inverse_inertia[2] > 0.0;
}

static bool is_held(const gn_rigid *b) {
    return b->held[0] + b->held[1] + b->held[2] > 0.0;
}

/* Computes the inertia of the body in its orientation, about the axes of space. */
static void inertia_of(const gn_rigid *b, double inertia[9]) {
    for (int p = 0; p < 9; p++) {
        inertia[p] = 0.0;
        for (int k = 0; k < 3; k++)
            inertia[p] += b->axes[3 * (p / 3) + k] * b->inertia[k] * b->axes[3 * (p % 3) + k];
    }
}

/* Computes the spin from an angular momentum, or the spin per second from a moment, about the free
 * axes: I_FF w_F = L_F - I_FP w_P. F are the one or two free axes and P those about which bearings
 * rotate the body, with the spin w_P of `led`. The moment of the bearings has no component about F.
 */
static void turn_held(const gn_rigid *b, const double momentum[3], const double led[3],
                      double spin[3]) {
    double inertia[9], left[3];
    int axis[3] = {0}, count = 0;
    inertia_of(b, inertia);
    for (int a = 0; a < 3; a++) {
        left[a] = momentum[a];
        for (int c = 0; c < 3; c++)
            if (b->held[c] > 0.0) left[a] -= inertia[3 * a + c] * led[c];
    }
    for (int a = 0; a < 3; a++) {
        spin[a] = b->held[a] > 0.0 ? led[a] : 0.0;
        if (!(b->held[a] > 0.0)) axis[count++] = a;
    }
    int p = axis[0], q = axis[count - 1];
    if (count == 1) {
        spin[p] = left[p] / inertia[4 * p];
        return;
    }
    double across = inertia[3 * p + q];
    double determinant = inertia[4 * p] * inertia[4 * q] - across * across;
    spin[p] = (inertia[4 * q] * left[p] - across * left[q]) / determinant;
    spin[q] = (inertia[4 * p] * left[q] - across * left[p]) / determinant;
}

/* Returns w.I.v, N m s, with v = `led` about the axes P and 0 about the others. */
static double along_led(const gn_rigid *b, const double spin[3], const double led[3]) {
    double inertia[9], sum = 0.0;
    inertia_of(b, inertia);
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++)
            if (b->held[a] > 0.0) sum += led[a] * inertia[3 * a + c] * spin[c];
    return sum;
}

/* Tells whether bearings rotate the body beside free spins. */
static bool is_led(const gn_rigid *b, const double spin[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) sum += b->held[a] * fabs(spin[a]);
    return sum > 0.0;
}

/* Computes the angular acceleration by a moment, rad/s2. */
static void spin_up(const gn_rigid *b, const double moment[3], double turn[3]) {
    const double none[3] = {0, 0, 0};
    double local[3];
    if (is_held(b)) {
        turn_held(b, moment, none, turn);
        return;
    }
    gn_rigid_local(b, moment, local);
    for (int a = 0; a < 3; a++) local[a] *= b->inverse_inertia[a];
    gn_rigid_direct(b, local, turn);
}

double gn_rigid_compliance(const gn_rigid *b, const double v[3]) {
    double local[3], sum = 0.0;
    if (is_held(b)) {
        spin_up(b, v, local);
        return gn_dot3(v, local);
    }
    gn_rigid_local(b, v, local);
    for (int a = 0; a < 3; a++) sum += b->inverse_inertia[a] * local[a] * local[a];
    return sum;
}

double gn_rigid_accelerates(const gn_step_context *ctx, const gn_rigid *b, const double force[3],
                            const double moment[3], const double lever[3], const double n[3]) {
    double turn[3], push[3], round[3], centre[3], sum = 0.0;
    spin_up(b, moment, turn);
    gn_cross3(turn, lever, push);
    gn_cross3(b->spin, lever, round);
    gn_cross3(b->spin, round, centre);
    for (int a = 0; a < 3; a++) {
        double fall = b->inverse_mass[a] > 0.0 ? ctx->scene.gravity[a] : 0.0;
        sum += (fall + force[a] * b->inverse_mass[a] + push[a] + centre[a]) * n[a];
    }
    return sum;
}

/* Computes the spin from the angular momentum at the present orientation; prescribed components
 * stay. */
static void spin_from_momentum(gn_rigid *b) {
    double local[3];
    if (is_held(b)) {
        memcpy(local, b->spin, sizeof local);
        turn_held(b, b->momentum, local, b->spin);
        return;
    }
    const gn_rotor rotor = rotor_of(b);
    gn_rotor_spin(&rotor, b->spin);
}

/* Computes the spin after half of the rotation of the step. */
static void half_way(const gn_rigid *b, double dt, double spin[3]) {
    gn_rigid middle = *b;
    double part[3];
    for (int a = 0; a < 3; a++) part[a] = 0.5 * dt * spin[a];
    turn_by(&middle, part);
    spin_from_momentum(&middle);
    memcpy(spin, middle.spin, sizeof middle.spin);
}

/* Rotates by the spin at the middle of the step, which is exact about one axis and of second order
 * about two. With bearings the momentum is computed from the spin at the middle of the resulting
 * rotation, so that the scheme is reversible in time and gains no energy over many turns. */
static void rotate_held(gn_rigid *b, double dt) {
    enum { MOST = 20 };
    double spin[3], before[3], part[3];
    spin_from_momentum(b);
    memcpy(spin, b->spin, sizeof spin);
    half_way(b, dt, spin);
    for (int k = 0; k < MOST && is_led(b, spin); k++) {
        memcpy(before, spin, sizeof before);
        half_way(b, dt, spin);
        if (spin[0] == before[0] && spin[1] == before[1] && spin[2] == before[2]) break;
    }
    for (int a = 0; a < 3; a++) part[a] = dt * spin[a];
    turn_by(b, part);
    spin_from_momentum(b);
}

static void rotate_freely(gn_rigid *b, double dt, bool space) {
    const gn_rotor rotor = rotor_of(b);
    if (is_held(b)) {
        rotate_held(b, dt);
        return;
    }
    gn_rotor_advance(&rotor, dt * sqrt(gn_dot3(b->spin, b->spin)), dt, space);
    spin_from_momentum(b);
}

/* --- from the scene --- */

/* Sets the inertia about the principal axes, and the orientation of these. */
static void set_principal(const gn_body_def *def, const gn_body_shape *shape, bool space,
                          gn_rigid *b) {
    double density = def->mass > 0.0 ? def->mass / shape->volume : def->density;
    if (def->has_inertia) {
        memcpy(b->inertia, def->inertia, sizeof b->inertia);
        return;
    }
    double values[3];
    gn_principal_axes(shape->moment, space, values, b->turn);
    for (int k = space ? 0 : 2; k < 3; k++) b->inertia[k] = density * values[k];
    gn_turn_axes(b->turn, b->axes);
}

static void set_motion_at_start(const gn_body_def *def, gn_rigid *b) {
    for (int a = 0; a < 3; a++) {
        b->velocity[a] = def->motion.velocity[a].count || !def->free
                             ? gn_table_at(&def->motion.velocity[a], 0.0)
                             : def->initial_velocity[a];
        b->spin[a] = !turns_freely(b)   ? gn_table_at(&def->motion.spin[a], 0.0)
                     : b->held[a] > 0.0 ? gn_table_at(&def->motion.spin[a], 0.0)
                                        : def->initial_spin[a];
    }
    if (!turns_freely(b)) return;
    double local[3];
    gn_rigid_local(b, b->spin, local);
    for (int a = 0; a < 3; a++) local[a] *= b->inertia[a];
    gn_rigid_direct(b, local, b->momentum);
    for (int a = 0; a < 3; a++)
        if (b->held[a] > 0.0) b->momentum[a] = 0.0;
}

static void set_body(const gn_scene *s, size_t k, const gn_body_shape *shape, gn_rigid *b) {
    const gn_body_def *def = &s->bodies[k];
    bool space = s->dimension == 3;
    gn_spins spins = gn_body_spin_kind(s, def);
    b->turn[0] = 1.0;
    gn_turn_axes(b->turn, b->axes);
    const double *at = def->has_reference ? def->reference
                       : def->free        ? shape->centre
                                          : def->origin;
    memcpy(b->position, at, sizeof b->position);
    if (def->free) {
        b->volume = shape->volume;
        b->mass = def->mass > 0.0 ? def->mass : def->density * shape->volume;
        set_principal(def, shape, space, b);
        for (int a = 0; a < (space ? 3 : 2); a++)
            if (!def->motion.velocity[a].count) b->inverse_mass[a] = 1.0 / b->mass;
        for (int a = space ? 0 : 2; a < 3; a++)
            if (spins != GN_SPINS_PRESCRIBED) b->inverse_inertia[a] = 1.0 / b->inertia[a];
        for (int a = 0; spins == GN_SPINS_SOME && a < 3; a++)
            b->held[a] = def->motion.spin[a].count ? 1.0 : 0.0;
    }
    memcpy(b->start, b->position, sizeof b->start);
    memcpy(b->turn_start, b->turn, sizeof b->turn);
    set_motion_at_start(def, b);
}

/* Transforms vertices into the body's frame. */
static void put_vertices(const gn_body_shape *shape, gn_rigid *b, double *out) {
    for (size_t v = 0; v < shape->vertices; v++) {
        double d[3];
        for (size_t a = 0; a < 3; a++) d[a] = shape->vertex[4 * v + a] - b->position[a];
        gn_rigid_local(b, d, out + 4 * v);
        b->reach = fmax(b->reach, sqrt(gn_dot3(d, d)));
    }
}

static gneiss_status put_shapes(const gn_step_context *ctx, gn_boundary *boundary,
                                const gn_body_shape *shapes, gneiss_error *error) {
    size_t corners = (size_t)ctx->scene.dimension, vertices = 0, facets = 0;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        vertices += shapes[k].vertices;
        facets += shapes[k].facets;
    }
    if (facets > INT32_MAX / 4 || vertices > INT32_MAX / 4)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "bodies: expected fewer than %d facets, found %zu", INT32_MAX / 4, facets);
    boundary->body_vertex_count = vertices;
    boundary->body_corner_count = corners * facets;
    boundary->body_shape = gn_alloc_array(ctx->scene.body_count, sizeof *boundary->body_shape);
    boundary->body_vertex = gn_alloc_array(vertices, 4 * sizeof *boundary->body_vertex);
    boundary->body_corner = gn_alloc_array(corners * facets, sizeof *boundary->body_corner);
    if (!boundary->body_shape || !boundary->body_vertex || !boundary->body_corner)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu facets of bodies", facets);
    size_t vertex = 0, corner = 0;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_body_shape *shape = &shapes[k];
        boundary->body_shape[k][0] = (int64_t)shape->vertices;
        boundary->body_shape[k][1] = (int64_t)shape->facets;
        boundary->body_shape[k][2] = (int64_t)shape->dropped;
        put_vertices(shape, &boundary->bodies[k], boundary->body_vertex + 4 * vertex);
        memcpy(boundary->body_corner + corner, shape->corner,
               corners * shape->facets * sizeof(int32_t));
        vertex += shape->vertices;
        corner += corners * shape->facets;
    }
    return GNEISS_OK;
}

gneiss_status gn_bodies_create(const gn_step_context *ctx, gn_boundary *boundary, size_t deforming,
                               gneiss_error *error) {
    size_t count = ctx->scene.body_count;
    if (!count) return gn_bodies_surfaces(ctx, boundary, deforming, error);
    boundary->bodies = gn_alloc_array(count, sizeof *boundary->bodies);
    gn_body_shape *shapes = gn_alloc_array(count, sizeof *shapes);
    gneiss_status status = boundary->bodies && shapes
                               ? GNEISS_OK
                               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for bodies");
    for (size_t k = 0; status == GNEISS_OK && k < count; k++) {
        status = gn_body_shape_make(&ctx->scene, k, &shapes[k], error);
        if (status == GNEISS_OK) status = gn_body_check_cuts(&ctx->scene, k, &shapes[k], error);
        if (status == GNEISS_OK) set_body(&ctx->scene, k, &shapes[k], &boundary->bodies[k]);
    }
    if (status == GNEISS_OK) status = put_shapes(ctx, boundary, shapes, error);
    for (size_t k = 0; shapes && k < count; k++) gn_body_shape_free(&shapes[k]);
    gn_free(shapes);
    return status == GNEISS_OK ? gn_bodies_surfaces(ctx, boundary, deforming, error) : status;
}

gneiss_status gn_bodies_surfaces(const gn_step_context *ctx, gn_boundary *boundary,
                                 size_t deforming, gneiss_error *error) {
    size_t corners = (size_t)ctx->scene.dimension, vertex = 0, corner = 0;
    if (!(ctx->effects & GN_FX_FACETS)) return GNEISS_OK;
    GN_TRY(gn_new(&boundary->surfaces, ctx->scene.body_count + deforming + 1, "surfaces", error));
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_body_def *def = &ctx->scene.bodies[k];
        const int64_t *shape = boundary->body_shape[k];
        gn_surface s = {.body = (int32_t)k,
                        .vertices = (size_t)shape[0],
                        .stiffness = def->stiffness,
                        .kratio = def->kratio,
                        .friction = def->friction};
        s.facets = (gn_facet_set){(int)corners, (size_t)shape[1], boundary->body_corner + corner,
                                  boundary->body_vertex + 4 * vertex};
        GN_TRY(gn_boundary_add_surface(boundary, &s, error));
        vertex += s.vertices;
        corner += corners * s.facets.count;
    }
    GN_TRY(gn_body_walls_prepare(ctx, boundary, error));
    return gn_body_pairs_prepare(ctx, boundary, error);
}

/* --- motion --- */

/* Books the works of prescribed motion, of gravity and of the applied force over half an interval.
 */
static void book(const gn_step_context *ctx, const gn_body_def *def, const gn_rigid *b, double dt,
                 gn_energy *ledger) {
    double prescribed = 0.0, weight = 0.0, applied = 0.0;
    for (int a = 0; a < 3; a++) {
        if (b->inverse_mass[a] > 0.0) {
            weight += b->mass * ctx->scene.gravity[a] * b->velocity[a];
            applied += def->force[a] * b->velocity[a];
        } else {
            prescribed -= b->force[a] * b->velocity[a];
        }
    }
    if (def->has_force) ledger->work_applied += 0.5 * dt * applied;
    if (!turns_freely(b)) prescribed -= gn_dot3(b->moment, b->spin);
    for (int a = 0; is_held(b) && a < 3; a++)
        if (b->held[a] > 0.0) prescribed -= b->moment[a] * b->spin[a];
    ledger->work_walls += 0.5 * dt * prescribed;
    ledger->work_gravity += 0.5 * dt * weight;
}

void gn_bodies_book(const gn_step_context *ctx, const gn_boundary *boundary, double dt,
                    gn_energy *ledger) {
    for (size_t k = 0; k < ctx->scene.body_count; k++)
        book(ctx, &ctx->scene.bodies[k], &boundary->bodies[k], dt, ledger);
}

/* Adds the change of the kinetic energy of a body due to a change of the step
 * (gn_rows_add_step_change), rotation about free axes included. */
static void follow_change(const gn_step_context *ctx, const gn_rigid *b, double halves[2]) {
    const double factor = 0.5 * (ctx->dt_past - ctx->dt) / (ctx->dt_past + ctx->dt);
    double gain[3];
    for (int a = 0; a < 3; a++) {
        gain[a] = turns_freely(b) ? b->momentum[a] - b->momentum_past[a] : 0.0;
        halves[GN_HALF_BEFORE] -= factor * gain[a] * b->spin_past[a];
        halves[GN_HALF_AFTER] += factor * gain[a] * b->spin[a];
        if (!(b->inverse_mass[a] > 0.0)) continue;
        double change = factor * b->mass * (b->velocity[a] - b->velocity_past[a]);
        halves[GN_HALF_BEFORE] -= change * b->velocity_past[a];
        halves[GN_HALF_AFTER] += change * b->velocity[a];
    }
}

/* Returns the work of bearings, J: from step to step they change the momentum about their axes as
 * w_P requires. With the moments M_P of contacts their work in a step is w_P.(l(+) - l(-)) less
 * that of M_P, where l is the mean of the momenta L_P before and after a kick: the half that ends
 * with a kick, or begins with it. */
static double led_work(const gn_rigid *b, bool start, gn_half half) {
    double spin[2][3], sum = 0.0;
    const double *led = half == GN_HALF_BEFORE ? b->spin_past : b->spin;
    if (!is_held(b) || !is_led(b, led)) return 0.0;
    turn_held(b, b->momentum_past, b->spin_past, spin[0]);
    turn_held(b, start ? b->momentum_past : b->momentum, start ? b->spin_past : b->spin, spin[1]);
    for (int k = 0; k < 2; k++) sum += 0.5 * along_led(b, spin[k], led);
    return half == GN_HALF_BEFORE ? sum : -sum;
}

static void kick(const gn_step_context *ctx, size_t k, gn_rigid *b) {
    double interval = 0.5 * (ctx->dt_past + ctx->dt), middle = ctx->time + 0.5 * ctx->dt;
    const gn_motion *motion = &ctx->scene.bodies[k].motion;
    for (int a = 0; a < 3; a++) {
        if (b->inverse_mass[a] > 0.0)
            b->velocity[a] +=
                interval * ((b->force[a] + ctx->scene.bodies[k].force[a]) * b->inverse_mass[a] +
                            ctx->scene.gravity[a]);
        else
            b->velocity[a] = gn_control_of(ctx, ctx->scene.bodies[k].name, a) *
                             gn_table_at(&motion->velocity[a], middle);
        if (!turns_freely(b) || b->held[a] > 0.0)
            b->spin[a] = gn_table_at(&motion->spin[a], middle);
        else
            b->momentum[a] += interval * b->moment[a];
    }
}

void gn_bodies_kick(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                    gn_ledger *ledger) {
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        gn_rigid *b = &boundary->bodies[k];
        memcpy(b->velocity_past, b->velocity, sizeof b->velocity);
        memcpy(b->spin_past, b->spin, sizeof b->spin);
        memcpy(b->momentum_past, b->momentum, sizeof b->momentum);
        kick(ctx, k, b);
        if (!(ctx->effects & GN_FX_SPACE)) b->momentum[0] = b->momentum[1] = 0.0;
        if (turns_freely(b)) spin_from_momentum(b);
        if (ctx->dt_past > 0.0 && ctx->dt != ctx->dt_past && ctx->effects & GN_FX_ENERGY)
            follow_change(ctx, b, dem->done.step_change);
        if (ctx->dt_past > 0.0) ledger->energy.work_walls += led_work(b, false, GN_HALF_BEFORE);
    }
}

/* Returns the kinetic energy 1/2 w(-).I.w(+), with the rotation that bearings prescribe. */
static double turning_energy(const gn_rigid *b, const double before[3], bool start) {
    double first[3], second[3], inertia[9], led[3], sum = 0.0;
    for (int a = 0; a < 3; a++)
        led[a] = start ? 2.0 * b->spin_past[a] - b->spin[a] : b->spin_past[a];
    turn_held(b, before, led, first);
    if (!is_led(b, led) && !is_led(b, b->spin)) return 0.5 * gn_dot3(first, b->momentum);
    turn_held(b, b->momentum, b->spin, second);
    inertia_of(b, inertia);
    for (int a = 0; a < 9; a++) sum += 0.5 * first[a / 3] * inertia[a] * second[a % 3];
    return sum;
}

/* The kinetic energies are 1/2 v(-) m v(+), as for particles, and 1/2 L(-) . I^-1 L(+); at the
 * start (-) is the state a full kick earlier. */
void gn_bodies_kinetic(const gn_step_context *ctx, const gn_boundary *boundary, double *translation,
                       double *rotation) {
    *translation = *rotation = 0.0;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_rigid *b = &boundary->bodies[k];
        double before[3], first[3], second[3];
        bool start = !(ctx->dt_past > 0.0);
        for (int a = 0; a < 3; a++) {
            double v = start ? 2.0 * b->velocity_past[a] - b->velocity[a] : b->velocity_past[a];
            if (b->inverse_mass[a] > 0.0) *translation += 0.5 * b->mass * v * b->velocity[a];
            before[a] = start ? 2.0 * b->momentum_past[a] - b->momentum[a] : b->momentum_past[a];
        }
        if (is_held(b)) {
            *rotation += turning_energy(b, before, start);
            continue;
        }
        gn_rigid_local(b, before, first);
        gn_rigid_local(b, b->momentum, second);
        for (int a = 0; a < 3; a++) *rotation += 0.5 * first[a] * b->inverse_inertia[a] * second[a];
    }
}

/* Returns a bound, rad/s, of a spin, which changes within the step: the largest that its momentum
 * allows, plus the effect of bearings; |I_FP| is at most half of the difference of two moments of
 * inertia. */
static double fastest_turn(const gn_rigid *b) {
    const double *i = b->inertia;
    double most = fmax(b->inverse_inertia[0], fmax(b->inverse_inertia[1], b->inverse_inertia[2]));
    double spin = most * sqrt(gn_dot3(b->momentum, b->momentum)), led = 0.0;
    if (!is_held(b) || !is_led(b, b->spin)) return spin;
    for (int a = 0; a < 3; a++) led += b->held[a] * b->spin[a] * b->spin[a];
    double across = 0.5 * (fmax(i[0], fmax(i[1], i[2])) - fmin(i[0], fmin(i[1], i[2])));
    return spin + sqrt(led) * (1.0 + most * across);
}

void gn_bodies_drift(const gn_step_context *ctx, gn_boundary *boundary, gn_ledger *ledger) {
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        gn_rigid *b = &boundary->bodies[k];
        ledger->energy.work_walls += led_work(b, !(ctx->dt_past > 0.0), GN_HALF_AFTER);
        double speed = sqrt(gn_dot3(b->velocity, b->velocity)), turn[3];
        for (int a = 0; a < 3; a++) {
            b->position[a] += ctx->dt * b->velocity[a];
            turn[a] = ctx->dt * b->spin[a];
        }
        if (turns_freely(b))
            rotate_freely(b, ctx->dt, ctx->effects & GN_FX_SPACE);
        else
            turn_by(b, turn);
        double spin = turns_freely(b) ? fastest_turn(b) : sqrt(gn_dot3(b->spin, b->spin));
        b->travel += ctx->dt * (speed + spin * b->reach);
    }
}
