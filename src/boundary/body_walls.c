#include "boundary/body_walls.h"

#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "kernels/dashpot.h"
#include "particles/body_springs.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "scene/sides.h"
#include "soa/field.h"
#include "soa/records.h"
#include "surfaces/facet.h"

#include <math.h>
#include <string.h>

/* --- parts of the stiffness --- */

/* Returns the angle, rad, between the two sides of a facet at corner c. */
static double angle_at(const gn_facet_set *s, size_t facet, size_t c) {
    const int32_t *corner = s->corner + 3 * facet;
    double a[3], b[3], cross[3];
    for (int k = 0; k < 3; k++) {
        double x = s->pos[4 * (int64_t)corner[c] + k];
        a[k] = s->pos[4 * (int64_t)corner[(c + 1) % 3] + k] - x;
        b[k] = s->pos[4 * (int64_t)corner[(c + 2) % 3] + k] - x;
    }
    gn_cross3(a, b, cross);
    return atan2(sqrt(gn_dot3(cross, cross)), gn_dot3(a, b));
}

/* Computes the fraction of a full turn by which the angles around each vertex fall short. */
static void space_parts(const gn_facet_set *s, size_t vertices, double *part) {
    for (size_t v = 0; v < vertices; v++) part[v] = 1.0;
    for (size_t f = 0; f < s->count; f++)
        for (size_t c = 0; c < 3; c++)
            part[s->corner[3 * f + c]] -= angle_at(s, f, c) / (2.0 * M_PI);
}

static double turn_between(const double a[2], const double b[2]) {
    return atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]) / M_PI;
}

/* Computes the exterior angle of the outline at each vertex, positive in the sense of the whole
 * outline. */
static void plane_parts(const gn_facet_set *s, size_t vertices, double *part) {
    double round = 0.0;
    for (size_t f = 0; f < s->count; f++)
        for (size_t g = 0; g < s->count; g++) {
            const int32_t *in = s->corner + 2 * f, *out = s->corner + 2 * g;
            const double *x = s->pos + 4 * (int64_t)in[0], *y = s->pos + 4 * (int64_t)in[1],
                         *z = s->pos + 4 * (int64_t)out[1];
            const double a[2] = {y[0] - x[0], y[1] - x[1]}, b[2] = {z[0] - y[0], z[1] - y[1]};
            if (in[1] != out[0]) continue;
            part[in[1]] = turn_between(a, b);
            round += part[in[1]];
        }
    for (size_t v = 0; v < vertices && round < 0.0; v++) part[v] = -part[v];
}

/* Tells whether a body can touch walls: it is free and, by Hertz's law, has a stiffness of its
 * own. */
static bool body_meets_walls(const gn_step_context *ctx, const gn_boundary *boundary, size_t k) {
    bool springs = !(ctx->effects & GN_FX_HERTZ) || ctx->scene.bodies[k].stiffness > 0.0;
    return ctx->scene.wall_count && ctx->scene.bodies[k].free && springs &&
           gn_surface_yields(boundary, &boundary->surfaces[k]);
}

bool gn_body_passes_walls(const gn_step_context *ctx, const gn_boundary *boundary, size_t k) {
    const gn_rigid *b = &boundary->bodies[k];
    if (!ctx->scene.bodies[k].free || body_meets_walls(ctx, boundary, k)) return false;
    for (size_t n = 0; n < ctx->scene.wall_count; n++)
        if (fmin(gn_wall_distance(&boundary->walls[n], b->position),
                 gn_wall_distance(&boundary->walls[n], b->start)) <= b->reach)
            return gn_surface_yields(boundary, &boundary->surfaces[k]);
    return false;
}

/* Returns the first vertex of a body; vertices are stored in the order of the bodies. */
static size_t first_vertex(const gn_step_context *ctx, const gn_boundary *boundary, size_t body) {
    if (body == ctx->scene.body_count) return boundary->body_vertex_count;
    return (size_t)(boundary->surfaces[body].facets.pos - boundary->body_vertex) / 4;
}

gneiss_status gn_body_walls_prepare(const gn_step_context *ctx, gn_boundary *boundary,
                                    gneiss_error *error) {
    const double rounding = 1e-12; /* rounding of the angles around a vertex inside a face */
    gn_boundary *b = boundary;
    size_t first = 0;
    GN_TRY(gn_new(&b->vertex_part, b->body_vertex_count + 1, "vertices", error));
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_surface *s = &b->surfaces[k];
        double *part = b->vertex_part + first;
        if (body_meets_walls(ctx, boundary, k))
            (s->facets.corners == 3 ? space_parts : plane_parts)(&s->facets, s->vertices, part);
        for (size_t v = 0; v < s->vertices; v++)
            if (!(part[v] > rounding)) part[v] = 0.0;
        first += s->vertices;
    }
    return GNEISS_OK;
}

gneiss_status gn_body_walls_check(const gn_step_context *ctx, const gn_boundary *boundary,
                                  gneiss_error *error) {
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_body_def *def = &ctx->scene.bodies[k];
        const gn_rigid *b = &boundary->bodies[k];
        char at[GN_POINT_SIZE];
        for (size_t n = 0; n < ctx->scene.wall_count && body_meets_walls(ctx, boundary, k); n++) {
            double distance = gn_wall_distance(&boundary->walls[n], b->position);
            if (!(distance < 0.0)) continue;
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s:%d:%d: bodies: expected the free body '%s' in front of wall '%s', "
                           "found its centre of mass %s m behind it by %.6g m",
                           ctx->scene.source, def->where.line, def->where.column, def->name,
                           ctx->scene.walls[n].name,
                           gn_point_text(ctx->scene.origin, b->position, at), -distance);
        }
    }
    return GNEISS_OK;
}

/* --- lists --- */

static size_t body_of_vertex(const gn_step_context *ctx, const gn_boundary *boundary,
                             int32_t vertex) {
    size_t low = 0, high = ctx->scene.body_count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        *(first_vertex(ctx, boundary, middle) <= (size_t)vertex ? &low : &high) = middle;
    }
    return low;
}

/* Returns the distance, m, of a point of a body from the plane. */
static double distance_of(const gn_boundary *boundary, size_t wall, const gn_rigid *b,
                          int32_t vertex, double lever[3]) {
    double x[3];
    gn_rigid_direct(b, boundary->body_vertex + 4 * (int64_t)vertex, lever);
    for (int a = 0; a < 3; a++) x[a] = b->position[a] + lever[a];
    return gn_wall_distance(&boundary->walls[wall], x);
}

/* Writes the vertices of a body near a wall, ascending, into rows from `row` on (NULL: only counts
 * them). Both body and wall may move by as much as the lists allow before they are rebuilt. */
static size_t near_wall(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t k, size_t wall, bool first, gn_wall_contacts *to, size_t row) {
    const gn_rigid *b = &boundary->bodies[k];
    double reach = 2.0 * dem->verlet.skin, lever[3];
    size_t count = 0, begin = first_vertex(ctx, boundary, k);
    if (gn_wall_distance(&boundary->walls[wall], b->position) - b->reach > reach) return 0;
    for (size_t v = begin; v < begin + (size_t)boundary->body_shape[k][0]; v++) {
        if (!(boundary->vertex_part[v] > 0.0)) continue;
        double gap = distance_of(boundary, wall, b, (int32_t)v, lever);
        if (!(gap <= reach)) continue;
        if (to) {
            to->i[row + count] = (int32_t)v;
            to->wall[row + count] = (int32_t)wall;
            if (first && ctx->scene.walls[wall].passive) to->gap0[row + count] = fmin(0.0, gap);
        }
        count++;
    }
    return count;
}

static size_t near_walls(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         bool first, gn_wall_contacts *to) {
    size_t count = 0;
    for (size_t k = 0; k < ctx->scene.body_count; k++)
        for (size_t n = 0; body_meets_walls(ctx, boundary, k) && n < ctx->scene.wall_count; n++)
            count += near_wall(ctx, dem, boundary, k, n, first, to, count);
    return count;
}

/* Tells whether row a of one list precedes row b of another in the order (body, wall, vertex). */
static bool before(const gn_step_context *ctx, const gn_boundary *boundary,
                   const gn_wall_contacts *x, size_t a, const gn_wall_contacts *y, size_t b) {
    size_t k = body_of_vertex(ctx, boundary, x->i[a]), m = body_of_vertex(ctx, boundary, y->i[b]);
    if (k != m) return k < m;
    if (x->wall[a] != y->wall[b]) return x->wall[a] < y->wall[b];
    return x->i[a] < y->i[b];
}

gneiss_status gn_body_walls_find(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, bool first, gneiss_error *error) {
    gn_wall_contacts old = boundary->body_contacts, now = {0};
    if (!ctx->scene.body_count || !ctx->scene.wall_count) return GNEISS_OK;
    size_t count = near_walls(ctx, dem, boundary, first, NULL), at = 0;
    if (!count && !old.soa.count) return GNEISS_OK;
    GN_TRY(gn_soa_create(&gn_wall_contact_record, &now, count, gn_body_wall_effects(ctx), error));
    near_walls(ctx, dem, boundary, first, &now);
    for (size_t c = 0; c < count; c++) {
        while (at < old.soa.count && before(ctx, boundary, &old, at, &now, c)) at++;
        if (at == old.soa.count || before(ctx, boundary, &now, c, &old, at)) continue;
        int32_t from = (int32_t)at;
        gn_soa_keep(&gn_wall_contact_record, &now, c, 1, &old, &from);
    }
    gn_soa_destroy(&gn_wall_contact_record, &old);
    boundary->body_contacts = now;
    return GNEISS_OK;
}

/* --- springs --- */

static gn_body_spring spring_of(const gn_step_context *ctx, size_t body, size_t wall) {
    return gn_body_spring_of(&ctx->scene, ctx->scene.wall_count + body, wall);
}

/* Returns the side of a contact of one vertex, which has the fraction `part` of the stiffness. */
static gn_touch_side side_of(const gn_body_spring *spring, double part) {
    gn_touch_side side = spring->side;
    side.stiffness *= part;
    return side;
}

gn_body_wall gn_body_wall_at(const gn_step_context *ctx, const gn_boundary *boundary, size_t row) {
    const gn_wall_contacts *q = &boundary->body_contacts;
    gn_body_wall c = {.body = body_of_vertex(ctx, boundary, q->i[row]),
                      .wall = (size_t)q->wall[row]};
    c.part = boundary->vertex_part[q->i[row]];
    gn_body_spring spring = spring_of(ctx, c.body, c.wall);
    c.side = side_of(&spring, c.part);
    c.damping = spring.damping;
    gn_rigid_direct(&boundary->bodies[c.body], boundary->body_vertex + 4 * (int64_t)q->i[row],
                    c.lever);
    return c;
}

/* The parts of a body add up to 2, or to more if it is not convex. */
double gn_body_walls_bound(const gn_step_context *ctx, const gn_boundary *boundary) {
    double most = 0.0;
    for (size_t k = 0, v = 0; k < ctx->scene.body_count; k++) {
        double parts = 0.0;
        for (size_t end = v + (size_t)boundary->body_shape[k][0]; v < end; v++)
            parts += boundary->vertex_part[v];
        for (size_t n = 0; parts > 0.0 && n < ctx->scene.wall_count; n++)
            most = fmax(most, parts * spring_of(ctx, k, n).side.stiffness *
                                  gn_surface_give(boundary, &boundary->surfaces[k]));
    }
    return most;
}

/* --- forces --- */

/* The contacts of a body with a wall and their common values. */
typedef struct group {
    const gn_wall *wall;
    gn_rigid *body;
    size_t wall_at, begin, end;
    gn_body_spring spring;
    double part;              /* sum over the contacts that press, or pressed in the last step */
    double inverse_mass;      /* 1/kg, along the normal if all of them press together */
    double force[3], turn[3]; /* N, N m: loads on the body without these contacts */
} group;

static group group_at(const gn_step_context *ctx, gn_boundary *boundary, size_t begin) {
    const gn_wall_contacts *q = &boundary->body_contacts;
    size_t body = body_of_vertex(ctx, boundary, q->i[begin]),
           past = first_vertex(ctx, boundary, body + 1);
    size_t wall = (size_t)q->wall[begin];
    group g = {.wall = &boundary->walls[wall],
               .body = &boundary->bodies[body],
               .wall_at = wall,
               .spring = spring_of(ctx, body, wall),
               .begin = begin,
               .end = begin + 1};
    while (g.end < q->soa.count && q->wall[g.end] == q->wall[begin] && (size_t)q->i[g.end] < past)
        g.end++;
    memcpy(g.force, g.body->force, sizeof g.force);
    memcpy(g.turn, g.body->moment, sizeof g.turn);
    return g;
}

/* The velocity of a vertex is that of the middle of the step, so that the path of a rotating body
 * is correct to second order. */
static gn_touch touch_of(const gn_step_context *ctx, const gn_boundary *boundary, const group *g,
                         size_t c, double lever[3]) {
    const gn_wall_contacts *q = &boundary->body_contacts;
    const gn_rigid *b = g->body;
    double turn[3], middle[3], v[3];
    gn_touch s = {.rounding = GN_OVERLAP_ROUNDING * b->reach};
    s.gap = distance_of(boundary, g->wall_at, b, q->i[c], lever) - q->gap0[c];
    gn_cross3(b->spin, lever, turn);
    for (int a = 0; a < 3; a++) middle[a] = lever[a] - 0.5 * ctx->dt_past * turn[a];
    gn_cross3(b->spin, middle, turn);
    for (int a = 0; a < 3; a++) {
        s.n[a] = -g->wall->normal[a];
        v[a] = g->wall->velocity[a] - b->velocity[a] - turn[a];
    }
    s.speed = gn_dot3(v, s.n);
    for (int a = 0; a < 3; a++) s.relative[a] = v[a] - s.speed * s.n[a];
    s.twist = gn_dot3(b->spin, s.n);
    return s;
}

static bool presses(const gn_step_context *ctx, const gn_touch *s) {
    return s->gap < -s->rounding || gn_touch_crosses(s, s->speed * ctx->dt_past);
}

static double compliance_at(const gn_rigid *b, const double lever[3], const double n[3]) {
    double turn[3];
    gn_cross3(lever, n, turn);
    return gn_rigid_compliance(b, turn);
}

/* Computes common values: corners of a face in contact with a wall share one effective mass, as if
 * the wall pressed at their middle. */
static void join(const gn_step_context *ctx, const gn_boundary *boundary, group *g) {
    double middle[3] = {0, 0, 0}, lever[3], turning = 0.0, along = 0.0;
    const double *n = g->wall->normal;
    for (size_t c = g->begin; c < g->end; c++) {
        gn_touch s = touch_of(ctx, boundary, g, c, lever);
        if (!presses(ctx, &s)) continue;
        double part = boundary->vertex_part[boundary->body_contacts.i[c]];
        g->part += part;
        for (int a = 0; a < 3; a++) middle[a] += part * lever[a];
        turning += part * compliance_at(g->body, lever, n);
    }
    if (!(g->part > 0.0)) return;
    for (int a = 0; a < 3; a++) {
        middle[a] /= g->part;
        along += n[a] * n[a] * g->body->inverse_mass[a];
    }
    /* A body that only rotates has no inverse mass for a contact on its axis. */
    g->inverse_mass = along > 0.0 ? along + compliance_at(g->body, middle, n) : turning / g->part;
}

static void load(gn_boundary *boundary, const group *g, size_t c, const double force[3],
                 const double lever[3]) {
    double moment[3], *row = boundary->body_contacts.row + 8 * c;
    gn_cross3(lever, force, moment);
    for (int a = 0; a < 3; a++) {
        row[a] = force[a];
        row[4 + a] = moment[a];
        g->body->force[a] += force[a];
        g->body->moment[a] += moment[a];
        boundary->walls[g->wall_at].force[a] -= force[a];
    }
}

static bool holds_nothing(const gn_wall_contacts *q, size_t c) {
    const size_t stride = q->soa.capacity;
    if (q->fd && q->fd[c] != 0.0) return false;
    for (size_t a = 0; q->shear && a < 3; a++)
        if (q->shear[c + a * stride] != 0.0) return false;
    return true;
}

static void contact(const gn_step_context *ctx, gn_boundary *boundary, const group *g, size_t c) {
    gn_wall_contacts *q = &boundary->body_contacts;
    double lever[3], t[3], force[3], part = boundary->vertex_part[q->i[c]];
    gn_touch s = touch_of(ctx, boundary, g, c, lever);
    bool pressed = presses(ctx, &s);
    memset(q->row + 8 * c, 0, 8 * sizeof *q->row);
    if (!pressed && holds_nothing(q, c)) return;
    gn_touch_side side = side_of(&g->spring, part);
    gn_touch_step step = {.dt = ctx->dt_past,
                          .damping_fraction = g->spring.damping,
                          .damping = ctx->effects & GN_FX_CONTACT_DAMPING,
                          .space = ctx->effects & GN_FX_SPACE,
                          .spins = true};
    if (pressed) {
        s.inverse_mass = g->inverse_mass * (g->part / part);
        s.other_acceleration =
            gn_rigid_accelerates(ctx, g->body, g->force, g->turn, lever, g->wall->normal);
    }
    double total =
        gn_linear_touch(&step, &side, &s, q->fd ? q->fd + c : NULL, q->shear ? q->shear + c : NULL,
                        q->soa.capacity, t, &boundary->body_sums);
    for (int a = 0; a < 3; a++) force[a] = total * s.n[a] + t[a];
    load(boundary, g, c, force, lever);
}

void gn_body_walls_work(const gn_step_context *ctx, gn_boundary *boundary) {
    boundary->body_sums = (gn_contact_sums){0};
    for (size_t c = 0; c < boundary->body_contacts.soa.count;) {
        group g = group_at(ctx, boundary, c);
        join(ctx, boundary, &g);
        for (; c < g.end; c++) contact(ctx, boundary, &g, c);
    }
    for (size_t n = 0; boundary->body_contacts.soa.count && n < ctx->scene.wall_count; n++)
        if (ctx->scene.walls[n].servo.active)
            boundary->walls[n].stiffness += gn_body_walls_pressing(ctx, boundary, n, true);
}

/* --- stiffness for servo walls --- */

static bool is_loaded(const gn_wall_contacts *q, size_t c) {
    return gn_dot3(q->row + 8 * c, q->row + 8 * c) > 0.0;
}

static double stiffness_of(const gn_step_context *ctx, const gn_boundary *boundary, size_t c,
                           bool dashpots) {
    gn_body_wall k = gn_body_wall_at(ctx, boundary, c);
    const gn_rigid *b = &boundary->bodies[k.body];
    const double *n = boundary->walls[k.wall].normal;
    double inverse = compliance_at(b, k.lever, n), kn = k.side.stiffness;
    for (int a = 0; a < 3; a++) inverse += n[a] * n[a] * b->inverse_mass[a];
    return dashpots ? kn + gn_dashpot(kn, inverse, k.damping, ctx->dt) / ctx->dt : kn;
}

double gn_body_walls_pressing(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                              bool dashpots) {
    const gn_wall_contacts *q = &boundary->body_contacts;
    double sum = 0.0;
    for (size_t c = 0; c < q->soa.count; c++)
        if ((size_t)q->wall[c] == wall && is_loaded(q, c))
            sum += stiffness_of(ctx, boundary, c, dashpots);
    return sum;
}

double gn_body_walls_within(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                            double path) {
    const gn_wall_contacts *q = &boundary->body_contacts;
    double sum = 0.0, lever[3], turn[3];
    for (size_t c = 0; c < q->soa.count; c++) {
        if ((size_t)q->wall[c] != wall || is_loaded(q, c)) continue;
        const gn_rigid *b = &boundary->bodies[body_of_vertex(ctx, boundary, q->i[c])];
        double gap = distance_of(boundary, wall, b, q->i[c], lever) - q->gap0[c];
        gn_cross3(b->spin, lever, turn);
        double along = gn_dot3(b->velocity, boundary->walls[wall].normal) +
                       gn_dot3(turn, boundary->walls[wall].normal);
        if (gap + ctx->dt * fmin(0.0, along) < path) sum += stiffness_of(ctx, boundary, c, true);
    }
    return sum;
}

/* --- overlaps for checks --- */

gn_body_overlap gn_body_walls_overlap(const gn_step_context *ctx, const gn_boundary *boundary,
                                      size_t body, size_t wall) {
    gn_body_overlap o = {0};
    const gn_wall_contacts *q = &boundary->body_contacts;
    double lever[3];
    for (size_t c = 0; c < q->soa.count; c++) {
        if ((size_t)q->wall[c] != wall || body_of_vertex(ctx, boundary, q->i[c]) != body) continue;
        double gap = distance_of(boundary, wall, &boundary->bodies[body], q->i[c], lever);
        if (!(gap < 0.0)) continue;
        o.vertices++;
        o.deepest = fmax(o.deepest, -gap);
        o.force += gn_body_wall_at(ctx, boundary, c).side.stiffness * fmax(0.0, q->gap0[c] - gap);
    }
    return o;
}
