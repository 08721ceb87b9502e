#include "boundary/body_pairs.h"

#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "kernels/dashpot.h"
#include "particles/body_springs.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "surfaces/convex.h"

#include <math.h>
#include <string.h>

/* --- pairs that can touch --- */

static bool yield(const gn_boundary *boundary, size_t a, size_t b) {
    const gn_surface *s = boundary->surfaces;
    return a != b && (gn_surface_yields(boundary, &s[a]) || gn_surface_yields(boundary, &s[b]));
}

static gn_body_spring spring_of(const gn_step_context *ctx, size_t a, size_t b) {
    return gn_body_spring_of(&ctx->scene, ctx->scene.wall_count + a, ctx->scene.wall_count + b);
}
static gn_touch_side side_of(const gn_step_context *ctx, size_t a, size_t b) {
    return spring_of(ctx, a, b).side;
}

static bool may_meet(const gn_step_context *ctx, const gn_boundary *boundary, size_t a, size_t b) {
    return yield(boundary, a, b) && side_of(ctx, a, b).stiffness > 0.0;
}

bool gn_bodies_meet(const gn_step_context *ctx, const gn_boundary *boundary, size_t a, size_t b) {
    const gn_convex *c = boundary->pairs.convex;
    return c && c[a].planes && c[b].planes && may_meet(ctx, boundary, a, b);
}

bool gn_body_misses_bodies(const gn_step_context *ctx, const gn_boundary *boundary, size_t k) {
    const gn_convex *c = boundary->pairs.convex;
    for (size_t m = 0; c && !c[k].planes && m < ctx->scene.body_count; m++)
        if (may_meet(ctx, boundary, k, m)) return true;
    return false;
}

/* Tells whether two bodies can touch at their positions: the distance is within the sum of both
 * reaches. */
static bool reach_each_other(const gn_rigid *a, const gn_rigid *b, const double x[3],
                             const double y[3]) {
    const double d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    return sqrt(gn_dot3(d, d)) <= a->reach + b->reach;
}

static bool are_near(const gn_boundary *boundary, size_t a, size_t b) {
    const gn_rigid *p = &boundary->bodies[a], *q = &boundary->bodies[b];
    return reach_each_other(p, q, p->start, q->start) ||
           reach_each_other(p, q, p->position, q->position);
}

bool gn_body_passes_bodies(const gn_step_context *ctx, const gn_boundary *boundary, size_t k) {
    const gn_convex *c = boundary->pairs.convex;
    for (size_t m = 0; c && !c[k].planes && m < ctx->scene.body_count; m++)
        if (may_meet(ctx, boundary, k, m) && are_near(boundary, k, m)) return true;
    return false;
}

bool gn_body_lacks_stiffness(const gn_step_context *ctx, const gn_boundary *boundary, size_t k) {
    for (size_t m = 0; ctx->scene.bodies[k].free && m < ctx->scene.body_count; m++)
        if (yield(boundary, k, m) && !(side_of(ctx, k, m).stiffness > 0.0) &&
            are_near(boundary, k, m))
            return true;
    return gn_body_passes_walls(ctx, boundary, k);
}

gneiss_status gn_body_pairs_prepare(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error) {
    gn_body_pairs *p = &boundary->pairs;
    size_t bodies = ctx->scene.body_count, planes = 0, polygons = 0;
    bool any = false;
    for (size_t a = 0; a < bodies && !any; a++)
        for (size_t b = 0; b < a && !any; b++) any = may_meet(ctx, boundary, a, b);
    if (!any) return GNEISS_OK;
    GN_TRY(gn_new(&p->convex, bodies, "bodies", error));
    p->bodies = bodies;
    for (size_t k = 0; k < bodies; k++) {
        const gn_surface *s = &boundary->surfaces[k];
        GN_TRY(gn_convex_make(&s->facets, s->vertices, &p->convex[k], error));
        planes = p->convex[k].planes > planes ? p->convex[k].planes : planes;
        polygons = p->convex[k].polygons > polygons ? p->convex[k].polygons : polygons;
    }
    return gn_convex_room_make(planes, polygons, &p->room, error);
}

void gn_body_pairs_free(gn_body_pairs *p) {
    for (size_t k = 0; k < p->bodies; k++) gn_convex_free(&p->convex[k]);
    gn_free(p->convex);
    gn_convex_room_free(&p->room);
    gn_free(p->pair);
    *p = (gn_body_pairs){0};
}

static gn_convex_pose pose_of(const gn_rigid *b) {
    gn_convex_pose p;
    memcpy(p.place, b->position, sizeof p.place);
    memcpy(p.axes, b->axes, sizeof p.axes);
    return p;
}

/* Returns the depth, m, below which an overlap is rounding of positions. */
static double rounding_of(const gn_rigid *a, const gn_rigid *b) {
    return 64.0 * GN_OVERLAP_ROUNDING * (a->reach + b->reach);
}

static bool meet(const gn_boundary *boundary, size_t a, size_t b, gn_convex_room *room,
                 gn_convex_overlap *o) {
    const gn_rigid *p = &boundary->bodies[a], *q = &boundary->bodies[b];
    const gn_convex *c = boundary->pairs.convex;
    if (!reach_each_other(p, q, p->position, q->position)) return false;
    gn_convex_pose at_a = pose_of(p), at_b = pose_of(q);
    return gn_convex_meet(&c[a], &at_a, &c[b], &at_b, rounding_of(p, q), room, o);
}

/* Tells whether the reference point of a free body, its centre of mass, is in another body. */
static bool holds(const gn_step_context *ctx, const gn_boundary *boundary, size_t a, size_t b) {
    const gn_convex *c = &boundary->pairs.convex[a];
    const gn_rigid *p = &boundary->bodies[a], *q = &boundary->bodies[b];
    double d[3], local[3];
    for (int k = 0; k < 3; k++) d[k] = q->position[k] - p->position[k];
    gn_rigid_local(p, d, local);
    for (size_t k = 0; k < c->planes; k++)
        if (!(gn_dot3(c->plane + 4 * k, local) < c->plane[4 * k + 3])) return false;
    return ctx->scene.bodies[b].free;
}

gneiss_status gn_body_pairs_check(const gn_step_context *ctx, const gn_boundary *boundary,
                                  gneiss_error *error) {
    for (size_t a = 0; a < ctx->scene.body_count; a++)
        for (size_t b = 0; b < ctx->scene.body_count; b++) {
            if (!gn_bodies_meet(ctx, boundary, a, b) || !holds(ctx, boundary, a, b)) continue;
            const gn_body_def *def = &ctx->scene.bodies[b];
            char at[GN_POINT_SIZE];
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s:%d:%d: bodies: expected the centre of mass of the free body '%s' "
                           "outside body '%s', found it inside, at %s m (a surface with a hole "
                           "meets no bodies)",
                           ctx->scene.source, def->where.line, def->where.column, def->name,
                           ctx->scene.bodies[a].name,
                           gn_point_text(ctx->scene.origin, boundary->bodies[b].position, at));
        }
    return GNEISS_OK;
}

/* --- springs --- */

/* Bound of the second derivative of h^2/2 along a path: it is 1 between faces and 4/3 where one of
 * them begins to separate; edges and corners have less (tests/test_convex.c). */
static const double stiffest = 2.0;

double gn_body_pair_square(const gn_step_context *ctx, const gn_boundary *boundary, size_t a,
                           size_t b) {
    const gn_surface *s = boundary->surfaces;
    return stiffest * side_of(ctx, a, b).stiffness *
           (gn_surface_give(boundary, &s[a]) + gn_surface_give(boundary, &s[b]));
}

/* For each contact |x - y|^2 <= (1 + s)|x|^2 + (1 + 1/s)|y|^2; with s the ratio of the inverse
 * masses of y and x, each of both bodies gets the frequency of the pair. Dashpots are 2 alpha
 * sqrt(k m), with the mass that both have along their motion. */
void gn_body_pairs_rates(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                         double *stiff, double *damp) {
    const gn_body_pairs *p = &boundary->pairs;
    for (size_t k = 0; k < p->count; k++) {
        size_t a = (size_t)p->pair[k].first, b = (size_t)p->pair[k].second;
        if (a != body && b != body) continue;
        gn_body_spring spring = spring_of(ctx, a, b);
        gn_touch_side side = spring.side;
        double alpha = spring.damping / gn_nonviscous_share(ctx);
        double square = gn_body_pair_square(ctx, boundary, a, b), across = 0.0, whole = 0.0;
        double give = square / (stiffest * side.stiffness);
        if (side.friction > 0.0 && side.kratio > 0.0) across = side.stiffness / side.kratio * give;
        for (int c = 0; c < 3; c++)
            whole = fmax(whole,
                         boundary->bodies[a].inverse_mass[c] + boundary->bodies[b].inverse_mass[c]);
        *stiff += square + across;
        *damp += 2.0 * alpha * sqrt(side.stiffness / (whole > 0.0 ? whole : give)) * give;
    }
}

double gn_body_pairs_bound(const gn_step_context *ctx, const gn_boundary *boundary) {
    double most = 0.0;
    for (size_t a = 0; a < ctx->scene.body_count; a++)
        for (size_t b = 0; b < a; b++)
            if (gn_bodies_meet(ctx, boundary, a, b))
                most = fmax(most, gn_body_pair_square(ctx, boundary, a, b));
    return most;
}

/* --- lists --- */

/* Tells whether a pair is listed: both bodies may move by as much as the lists allow before they
 * are rebuilt. */
static bool is_near(const gn_dem *dem, const gn_boundary *boundary, size_t a, size_t b) {
    const gn_rigid *p = &boundary->bodies[a], *q = &boundary->bodies[b];
    const gn_convex *c = boundary->pairs.convex;
    double skin = 2.0 * dem->verlet.skin, reach = p->reach + q->reach + skin, far2 = 0.0;
    for (int k = 0; k < 3; k++) {
        double d = q->position[k] - p->position[k];
        far2 += d * d;
    }
    if (far2 > reach * reach) return false;
    gn_convex_pose at_a = pose_of(p), at_b = pose_of(q);
    return gn_convex_apart(&c[a], &at_a, &c[b], &at_b) <= skin;
}

static void keep_worst(gn_bodies_worst *worst, double value, const gn_body_pair *p) {
    if (value > worst->value) *worst = (gn_bodies_worst){value, p->first, p->second};
}

static gn_bodies_overlap pressed_by(const gn_step_context *ctx, const gn_boundary *boundary,
                                    size_t a, size_t b, const gn_convex_overlap *o) {
    const double *g = ctx->scene.gravity;
    double mass = boundary->bodies[a].mass + boundary->bodies[b].mass;
    return (gn_bodies_overlap){.depth = o->depth,
                               .force = side_of(ctx, a, b).stiffness * o->depth *
                                        sqrt(gn_dot3(o->along, o->along)),
                               .rest = 2.0 * mass * sqrt(gn_dot3(g, g))};
}

/* Updates the deepest overlap; beyond half of a thickness the other side would be nearer. */
static void look_how_deep(gn_boundary *boundary, const gn_body_pair *p, const double along[3]) {
    gn_body_pairs *all = &boundary->pairs;
    double size = sqrt(gn_dot3(along, along)), thin = (double)INFINITY;
    const double body[2] = {p->first, p->second};
    if (!(size > 0.0)) return;
    for (int k = 0; k < 2; k++) {
        const gn_convex *c = &all->convex[(size_t)body[k]];
        double n[3], low = (double)INFINITY, high = -(double)INFINITY;
        gn_rigid_local(&boundary->bodies[(size_t)body[k]], along, n);
        for (size_t m = 0; m < c->polygons * (size_t)c->corners; m++) {
            double x = gn_dot3(n, c->corner + 3 * m) / size;
            low = fmin(low, x);
            high = fmax(high, x);
        }
        thin = fmin(thin, high - low);
    }
    keep_worst(&all->deepest, p->depth / thin, p);
}

static gn_body_pair new_pair(const gn_step_context *ctx, gn_boundary *boundary, bool first,
                             size_t a, size_t b) {
    gn_body_pair now = {.first = (double)a, .second = (double)b};
    gn_convex_overlap o;
    if (!first || !meet(boundary, a, b, &boundary->pairs.room, &o)) return now;
    gn_bodies_overlap push = pressed_by(ctx, boundary, a, b, &o);
    if (push.force > push.rest) keep_worst(&boundary->pairs.pushed, push.force, &now);
    now.depth = o.depth;
    look_how_deep(boundary, &now, o.along);
    return now;
}

static gneiss_status list_pairs(const gn_step_context *ctx, const gn_dem *dem,
                                gn_boundary *boundary, bool first, const gn_body_pairs *old,
                                gneiss_error *error) {
    gn_body_pairs *p = &boundary->pairs;
    size_t at = 0;
    for (size_t a = 0; a < ctx->scene.body_count; a++)
        for (size_t b = a + 1; b < ctx->scene.body_count; b++) {
            const gn_body_pair *q = old->pair;
            while (at < old->count && (q[at].first < (double)a ||
                                       (q[at].first == (double)a && q[at].second < (double)b)))
                at++;
            if (!gn_bodies_meet(ctx, boundary, a, b) || !is_near(dem, boundary, a, b)) continue;
            bool listed = at < old->count && q[at].first == (double)a && q[at].second == (double)b;
            GN_TRY(gn_grow(&p->pair, p->count, p->count + 1, &p->most, "pairs of bodies", error));
            p->pair[p->count++] = listed ? q[at] : new_pair(ctx, boundary, first, a, b);
        }
    return GNEISS_OK;
}

gneiss_status gn_body_pairs_find(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, bool first, gneiss_error *error) {
    gn_body_pairs *p = &boundary->pairs, old = *p;
    if (!p->convex) return GNEISS_OK;
    p->pair = NULL;
    p->count = p->most = 0;
    gneiss_status status = list_pairs(ctx, dem, boundary, first, &old, error);
    gn_free(old.pair);
    return status;
}

/* --- forces --- */

/* A pair in a step; arms are from both reference points to the contact point. */
typedef struct step {
    gn_rigid *a, *b;
    double lever[2][3],
        middle[2][3]; /* lever arms at the present instant, and in the middle of the step */
    double turn[3];   /* rad/s, rotation of the second body relative to the first */
    double size;      /* magnitude of the gradient of h */
    gn_touch touch;
    gn_touch_side side;
    double damping; /* fraction of the critical damping */
    bool pressed;
} step;

static void set_levers(const gn_step_context *ctx, const gn_body_pair *p, step *s) {
    const gn_rigid *body[2] = {s->a, s->b};
    for (int k = 0; k < 3; k++) {
        s->lever[0][k] = p->point[k];
        s->lever[1][k] = p->point[k] + s->a->position[k] - s->b->position[k];
        s->turn[k] = s->b->spin[k] - s->a->spin[k];
    }
    for (int m = 0; m < 2; m++) {
        double turn[3];
        gn_cross3(body[m]->spin, s->lever[m], turn);
        for (int k = 0; k < 3; k++) s->middle[m][k] = s->lever[m][k] - 0.5 * ctx->dt_past * turn[k];
    }
}

/* Computes the velocity, m/s, of the second body relative to the first at the point of contact. */
static void velocity_at(const step *s, double v[3]) {
    double turn[2][3];
    gn_cross3(s->a->spin, s->middle[0], turn[0]);
    gn_cross3(s->b->spin, s->middle[1], turn[1]);
    for (int k = 0; k < 3; k++)
        v[k] = s->b->velocity[k] + turn[1][k] - s->a->velocity[k] - turn[0][k];
}

static double inverse_mass_of(const gn_body_pair *p, const step *s) {
    const gn_rigid *body[2] = {s->a, s->b};
    double sum = 0.0, moment[3];
    for (int m = 0; m < 2; m++) {
        gn_cross3(s->lever[m], p->along, moment);
        for (int k = 0; k < 3; k++) {
            moment[k] += p->about[k];
            sum += p->along[k] * p->along[k] * body[m]->inverse_mass[k];
        }
        sum += gn_rigid_compliance(body[m], moment);
    }
    return sum;
}

/* Sets the path of h in the step: its change or, in steps in which a contact begins or ends, the
 * path along its gradient. */
static void set_path(const gn_step_context *ctx, gn_body_pair *p, double depth, step *s) {
    gn_touch *t = &s->touch;
    double v[3], dt = ctx->dt_past, rate, along;
    velocity_at(s, v);
    rate = gn_dot3(p->along, v) + gn_dot3(p->about, s->turn);
    double path = -rate * dt;
    if (depth > 0.0 && p->depth > 0.0)
        path = p->depth - depth;
    else if (depth > 0.0)
        path = fmin(path, -depth);
    else
        path = fmax(path, p->depth);
    t->gap = depth > 0.0 ? -depth : path - p->depth;
    t->speed = dt > 0.0 ? path / dt : -rate;
    s->size = sqrt(gn_dot3(p->along, p->along));
    for (int k = 0; k < 3; k++) t->n[k] = s->size > 0.0 ? -p->along[k] / s->size : 0.0;
    along = gn_dot3(v, t->n);
    for (int k = 0; k < 3; k++) t->relative[k] = v[k] - along * t->n[k];
    t->twist = gn_dot3(s->a->spin, t->n) + gn_dot3(s->b->spin, t->n);
}

/* Rotates the stored friction, so that it stays perpendicular to the normal. */
static void turn_shear(const double n[3], double shear[3]) {
    double size2 = gn_dot3(shear, shear), along = gn_dot3(shear, n), rest2;
    for (int k = 0; k < 3; k++) shear[k] -= along * n[k];
    rest2 = gn_dot3(shear, shear);
    for (int k = 0; k < 3; k++) shear[k] *= rest2 > 0.0 ? sqrt(size2 / rest2) : 0.0;
}

static void push(gn_rigid *b, const double force[3], const double moment[3], const double lever[3],
                 double sign) {
    double turn[3];
    gn_cross3(lever, force, turn);
    for (int k = 0; k < 3; k++) {
        b->force[k] += sign * force[k];
        b->moment[k] += sign * (turn[k] + moment[k]);
    }
}

/* Resists rocking. Faces that rock on each other change h to second order only; the dashpot
 * therefore also acts as if distributed over the faces, M = c sum (r x n)((r x n).w). */
static void rock(const gn_step_context *ctx, gn_body_pair *p, const step *s, const double spread[9],
                 double moment[3], gn_contact_sums *sums) {
    const double *n = s->touch.n;
    double c = 0.0, across[3], spun[3], now[3] = {0, 0, 0};
    if (s->pressed && ctx->effects & GN_FX_CONTACT_DAMPING)
        c = s->size * s->size *
            gn_dashpot(s->side.stiffness, s->touch.inverse_mass, s->damping, ctx->dt_past);
    if (c > 0.0) {
        gn_cross3(n, s->turn, across);
        for (int k = 0; k < 3; k++) spun[k] = c * gn_dot3(spread + 3 * k, across);
        gn_cross3(spun, n, now);
    }
    for (int k = 0; k < 3; k++) {
        sums->contact_damping += 0.5 * ctx->dt_past * (p->rocking[k] + now[k]) * s->turn[k];
        p->rocking[k] = now[k];
        moment[k] += now[k];
    }
}

/* Friction against twisting about the normal. */
typedef struct twist {
    double spring, radius; /* N m/rad; m: radius of a ring with the same friction */
    double turn, trial;    /* rad, rotation in this step; N m, moment without slip */
    double share; /* fraction of the limit of friction that remains for the moment if slip and twist
                     act together */
} twist;

/* The spring of twisting is that of friction distributed over the faces. Uniformly loaded faces
 * transmit at most 0.943 mu N times the radius of gyration (discs; squares 0.937). If the spring
 * changes, either its moment or its angle is kept, whichever gives the smaller moment. If faces
 * slide and twist at the same time, the limit applies to the vector of the force and of the moment
 * over that radius. */
static twist twist_of(const gn_step_context *ctx, const gn_body_pair *p, step *s,
                      const double spread[9]) {
    const double *n = s->touch.n;
    double square = spread[0] + spread[4] + spread[8], kt = 0.0, slide2 = 0.0;
    twist t = {.turn = ctx->dt_past * gn_dot3(s->turn, n), .trial = p->twisting, .share = 0.0};
    for (int k = 0; k < 3; k++) square -= n[k] * gn_dot3(spread + 3 * k, n);
    if (!s->pressed || !(s->side.kratio > 0.0) || !(ctx->effects & GN_FX_SPACE) ||
        !(square > 0.0)) {
        t.trial = 0.0;
        return t;
    }
    kt = s->side.stiffness / s->side.kratio;
    t.spring = kt * square;
    t.radius = 0.943 * sqrt(square);
    if (t.spring < p->twisting_spring) t.trial *= t.spring / p->twisting_spring;
    t.trial += t.spring * t.turn;
    for (int k = 0; k < 3; k++) {
        double slide = p->shear[k] + kt * ctx->dt_past * s->touch.relative[k];
        slide2 += slide * slide;
    }
    double whole = sqrt(slide2 + t.trial * t.trial / (t.radius * t.radius));
    if (!(whole > 0.0)) return t;
    t.share = fabs(t.trial) / t.radius / whole;
    s->side.friction *= sqrt(slide2) / whole;
    return t;
}

/* Applies the moment of twisting; `most`, N: total friction. */
static void act_twist(gn_body_pair *p, const twist *t, const double n[3], double most,
                      double moment[3], gn_contact_sums *sums) {
    double old = p->twisting, limit = most * t->share * t->radius;
    double stored = p->twisting_spring > 0.0 ? 0.5 * old * old / p->twisting_spring : 0.0;
    double now = fmax(-limit, fmin(limit, t->trial));
    double left = t->spring > 0.0 ? 0.5 * now * now / t->spring : 0.0;
    sums->friction += stored + 0.5 * (old + now) * t->turn - left;
    sums->elastic_normal += left;
    p->twisting = now;
    p->twisting_spring = t->spring;
    for (int k = 0; k < 3; k++) moment[k] += now * n[k];
}

/* Returns the acceleration of the gap by all loads except this contact. */
static double other_acceleration(const gn_step_context *ctx, const gn_body_pair *p, const step *s) {
    return gn_rigid_accelerates(ctx, s->a, s->a->force, s->a->moment, s->lever[0], p->along) -
           gn_rigid_accelerates(ctx, s->b, s->b->force, s->b->moment, s->lever[1], p->along);
}

static void act(const gn_step_context *ctx, gn_boundary *boundary, gn_body_pair *p, step *s,
                const double spread[9]) {
    gn_contact_sums *sums = &boundary->pairs.sums;
    gn_touch_step of = {.dt = ctx->dt_past,
                        .damping_fraction = s->damping,
                        .damping = ctx->effects & GN_FX_CONTACT_DAMPING,
                        .space = ctx->effects & GN_FX_SPACE,
                        .spins = true};
    double t[3], force[3], moment[3];
    s->touch.inverse_mass = inverse_mass_of(p, s);
    s->touch.other_acceleration = other_acceleration(ctx, p, s);
    s->side.friction *= s->size; /* the contact force is the force along h times the gradient */
    double friction = s->side.friction;
    turn_shear(s->touch.n, p->shear);
    twist turning = twist_of(ctx, p, s, spread);
    double total = gn_linear_touch(&of, &s->side, &s->touch, &p->viscous, p->shear, 1, t, sums);
    for (int k = 0; k < 3; k++) {
        force[k] = t[k] - total * p->along[k];
        moment[k] = -total * p->about[k];
    }
    rock(ctx, p, s, spread, moment, sums);
    act_twist(p, &turning, s->touch.n, friction * fmax(-total, 0.0), moment, sums);
    const double size = sqrt(gn_dot3(force, force));
    sums->force += size;
    sums->carrying += size > 0.0;
    push(s->a, force, moment, s->lever[0], 1.0);
    push(s->b, force, moment, s->lever[1], -1.0);
}

static bool holds_nothing(const gn_body_pair *p) {
    return p->depth == 0.0 && p->viscous == 0.0 && p->twisting == 0.0 &&
           gn_dot3(p->shear, p->shear) == 0.0 && gn_dot3(p->rocking, p->rocking) == 0.0;
}

static void contact(const gn_step_context *ctx, gn_boundary *boundary, gn_body_pair *p) {
    size_t a = (size_t)p->first, b = (size_t)p->second;
    gn_convex_overlap o = {0};
    gn_body_spring spring = spring_of(ctx, a, b);
    step s = {.a = &boundary->bodies[a],
              .b = &boundary->bodies[b],
              .side = spring.side,
              .damping = spring.damping};
    s.pressed = meet(boundary, a, b, &boundary->pairs.room, &o);
    if (!s.pressed && holds_nothing(p)) return;
    if (s.pressed) {
        memcpy(p->along, o.along, sizeof p->along);
        memcpy(p->about, o.about, sizeof p->about);
        memcpy(p->point, o.point, sizeof p->point);
    }
    s.touch.rounding = 0.0;
    set_levers(ctx, p, &s);
    set_path(ctx, p, o.depth, &s);
    act(ctx, boundary, p, &s, o.spread);
    bool deeper = o.depth > p->depth;
    p->depth = o.depth;
    if (deeper) look_how_deep(boundary, p, p->along);
}

void gn_body_pairs_work(const gn_step_context *ctx, gn_boundary *boundary) {
    gn_body_pairs *p = &boundary->pairs;
    p->sums = (gn_contact_sums){0};
    for (size_t k = 0; k < p->count; k++) contact(ctx, boundary, &p->pair[k]);
}

/* --- overlaps for checks --- */

gneiss_status gn_bodies_overlap_of(const gn_step_context *ctx, const gn_boundary *boundary,
                                   size_t a, size_t b, gn_bodies_overlap *to, gneiss_error *error) {
    const gn_convex_room *have = &boundary->pairs.room;
    gn_convex_room room;
    gn_convex_overlap o = {0};
    *to = (gn_bodies_overlap){0};
    if (!gn_bodies_meet(ctx, boundary, a, b)) return GNEISS_OK;
    GN_TRY(gn_convex_room_make(have->planes, have->polygons, &room, error));
    if (meet(boundary, a, b, &room, &o)) *to = pressed_by(ctx, boundary, a, b, &o);
    gn_convex_room_free(&room);
    return GNEISS_OK;
}

uint64_t gn_body_pairs_hash(const gn_body_pairs *p, uint64_t h) {
    return p->count ? gn_hash_bytes(p->pair, p->count * sizeof *p->pair, h) : h;
}
