/* The skin of particles without a given shape. A ball of the mean radius rolls over the particles
 * (rolling_ball.h); the skin is that surface parallel to the rolled one which bounds a body loaded
 * by the pressure everywhere. The mean stress of the specimen then refers to the enclosed volume.
 * Bodies between which the ball passes have separate surfaces. The pressure on a single particle
 * has no resultant. Neither has that on particles in a row or (in space) in one layer, whose
 * positions determine neither a rotation nor a strain. */
#include "membrane/membrane.h"

#include "base/ball.h"
#include "base/eigen.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "laboratory/laboratory.h"
#include "membrane/rolling_ball.h"
#include "neigh/neigh.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

typedef struct view {
    int32_t *body; /* [particles] representative of the body; the ball cannot pass through a body */
    int32_t *members; /* [particles] number of particles of the body, for representatives */
    size_t bodies;
    gn_rolled rolled;
    double *
        borne; /* [particles] m3: section times half length, summed over contacts that carry load */
} view;

static int32_t standing_for(int32_t *body, int32_t p) {
    while (body[p] != p) p = body[p] = body[body[p]];
    return p;
}

static void join(view *v, int32_t i, int32_t j) {
    const int32_t a = standing_for(v->body, i), b = standing_for(v->body, j);
    v->body[a > b ? a : b] = a > b ? b : a;
}

static void count_bodies(view *v, size_t n) {
    for (size_t p = 0; p < n; p++) v->members[v->body[p] = standing_for(v->body, (int32_t)p)]++;
    for (size_t p = 0; p < n; p++) v->bodies += v->members[p] > 0;
}

/* Adds a contact that is a bond, may become one, or touches. */
static void add_borne(const gn_step_context *ctx, const gn_dem *dem, view *v, size_t i, size_t j) {
    const double *x = dem->particles.pos + 4 * i, *y = dem->particles.pos + 4 * j;
    const double way[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    const double length = sqrt(gn_dot3(way, way)), radius = fmin(x[3], y[3]);
    const double range =
        fmax(ctx->scene.bonds == GN_SWITCH_ON ? ctx->scene.interaction_range : 0.0, 0.01);
    if (length > (1.0 + range) * (x[3] + y[3])) return;
    const double half = 0.5 * length * (ctx->scene.dimension == 3 ? radius * radius : radius);
    v->borne[i] += half;
    v->borne[j] += half;
}

static gneiss_status make_view(view *v, size_t n, gneiss_error *error) {
    bool all = true;
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
        v->rolled.area[k] = gn_alloc_array(n + 1, sizeof *v->rolled.area[k]);
        v->rolled.arms[k] = gn_alloc_array(n + 1, sizeof *v->rolled.arms[k]);
        all = all && v->rolled.area[k] && v->rolled.arms[k];
    }
    v->rolled.cell = gn_alloc_array(n + 1, sizeof *v->rolled.cell);
    v->borne = gn_alloc_array(n + 1, sizeof *v->borne);
    v->body = gn_alloc_array(n + 1, sizeof *v->body);
    v->members = gn_alloc_array(n + 1, sizeof *v->members);
    if (all && v->rolled.cell && v->borne && v->body && v->members) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a skin");
}

static void free_view(view *v) {
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
        gn_free(v->rolled.area[k]);
        gn_free(v->rolled.arms[k]);
    }
    gn_free(v->rolled.cell);
    gn_free(v->borne);
    gn_free(v->body);
    gn_free(v->members);
}

static gneiss_status look(const gn_step_context *ctx, const gn_dem *dem, view *v, double ball,
                          gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const int dimension = (int)ctx->scene.dimension;
    gn_pair_query query = {
        .particles = q, .dimension = dimension, .margin = 2.0 * ball, .threads = ctx->threads};
    gn_pair_list pairs = {0};
    GN_TRY(make_view(v, q->soa.count, error));
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    for (size_t p = 0; p < q->soa.count; p++) v->body[p] = (int32_t)p;
    for (size_t c = 0; c < pairs.count; c++) {
        join(v, pairs.pair[c][0], pairs.pair[c][1]);
        add_borne(ctx, dem, v, (size_t)pairs.pair[c][0], (size_t)pairs.pair[c][1]);
    }
    count_bodies(v, q->soa.count);
    v->rolled.particles = q;
    v->rolled.dimension = dimension;
    v->rolled.ball = ball;
    v->rolled.pairs = &pairs;
    gneiss_status status = gn_rolled_find(&v->rolled, error);
    v->rolled.pairs = NULL;
    gn_pair_list_free(&pairs);
    return status;
}

/* Removes the rounding error of the surface where more than three particles hold the ball. */
static void close_surface(gn_particles *q, gn_skin_body body) {
    double left[3] = {0}, size = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_in_body(body, p)) continue;
        size += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) left[a] += q->skin[4 * p + a];
    }
    for (size_t p = 0; p < q->soa.count && size > 0.0; p++)
        for (int a = 0; a < 3 && gn_is_in_body(body, p); a++)
            q->skin[4 * p + a] -= q->skin[4 * p + 3] / size * left[a];
}

/* Computes the weights of the layers for the surface at a distance from the centre of the ball, in
 * radii of the ball. */
static void weigh_layers(double at, double weight[GN_ROLLED_LAYERS]) {
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
        weight[k] = 1.0;
        for (int l = 0; l < GN_ROLLED_LAYERS; l++)
            if (l != k)
                weight[k] *= (at - gn_rolled_layer[l]) / (gn_rolled_layer[k] - gn_rolled_layer[l]);
    }
}

/* Sums over the particles of a body, for each layer: areas times positions, and the enclosed
 * volume, m3. */
typedef struct volumes {
    double at_centres[GN_ROLLED_LAYERS], enclosed[GN_ROLLED_LAYERS];
} volumes;

static volumes volumes_of(const gn_step_context *ctx, const gn_dem *dem, const view *v,
                          gn_skin_body body) {
    const gn_particles *q = &dem->particles;
    const double d = (double)ctx->scene.dimension, *base = NULL;
    volumes sums = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        double way[3];
        if (!gn_is_in_body(body, p)) continue;
        if (!base) base = q->start + 4 * p;
        for (int a = 0; a < 3; a++) way[a] = q->start[4 * p + a] - base[a];
        for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
            const double work = gn_dot3(v->rolled.area[k][p], way) / d;
            sums.at_centres[k] += work;
            sums.enclosed[k] += work + v->rolled.arms[k][p] / d;
        }
    }
    return sums;
}

static double sum_at(const double sums[GN_ROLLED_LAYERS], double at) {
    double weight[GN_ROLLED_LAYERS], sum = 0.0;
    weigh_layers(at, weight);
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) sum += weight[k] * sums[k];
    return sum;
}

/* Returns the distance at which a sum, which decreases with the distance, is `wanted`; it is at
 * most half a radius of the ball from the touched surface. */
static double layer_at(const double sums[GN_ROLLED_LAYERS], double wanted) {
    double low = 0.5, high = 1.5;
    for (int k = 0; k < 50; k++) {
        const double middle = 0.5 * (low + high);
        *(sum_at(sums, middle) > wanted ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

/* Volumes of a body from the cells of its inner particles, m3; 0: it has too few of them. */
typedef struct body_space {
    double bearing; /* volume in which the contacts transmit a uniform pressure */
    double filled;  /* volume filled by its particles */
} body_space;

static body_space space_of(const gn_step_context *ctx, const gn_dem *dem, const view *v,
                           gn_skin_body body) {
    const gn_particles *q = &dem->particles;
    const int few = 8;
    double borne[2] = {0}, solid[2] = {0}, space = 0.0;
    int count = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_in_body(body, p)) continue;
        const double ball = gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
        const bool inside = v->rolled.cell[p] > 0.0;
        for (int k = 0; k <= (int)inside; k++) borne[k] += v->borne[p], solid[k] += ball;
        space += v->rolled.cell[p];
        count += inside;
    }
    if (count < few || !(borne[1] > 0.0)) return (body_space){0};
    return (body_space){borne[0] / borne[1] * space, solid[0] / solid[1] * space};
}

/* Returns the position of a body's surface, as a distance from the centre of the ball in radii of
 * the ball. The touched surface is not the boundary of the body that carries load: the ball sinks
 * in between particles of a lattice, and it rests on single particles that protrude from a cut and
 * have few contacts. If the test determines the volume (`given`), the position follows from it
 * alone. */
static double surface_at(const gn_step_context *ctx, const gn_dem *dem, const view *v,
                         gn_skin_body body, double given, double bearing) {
    const volumes sums = volumes_of(ctx, dem, v, body);
    if (given > 0.0) return layer_at(sums.enclosed, given);
    return bearing > 0.0 ? layer_at(sums.at_centres, bearing) : 1.0;
}

static void set_surface(gn_dem *dem, const view *v, gn_skin_body body, double at, double *arms) {
    gn_particles *q = &dem->particles;
    double weight[GN_ROLLED_LAYERS];
    weigh_layers(at, weight);
    for (size_t p = 0; p < q->soa.count; p++) {
        double *skin = q->skin + 4 * p;
        if (!gn_is_in_body(body, p)) continue;
        for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
            for (int a = 0; a < 3; a++) skin[a] += weight[k] * v->rolled.area[k][p][a];
            arms[p] += weight[k] * v->rolled.arms[k][p];
        }
        skin[3] = sqrt(gn_dot3(skin, skin));
    }
}

/* Computes the surface of a body and balances it with the particles at their centres. Arms end
 * where the surface encloses the volume of the body. */
static void finish(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                   const gn_boundary *boundary, const gn_solids *solids, const view *v,
                   gn_skin_body body, double *arms) {
    gn_particles *q = &dem->particles;
    const double none[3] = {0}, d = (double)ctx->scene.dimension;
    const bool shaped = ctx->scene.specimen.pack.shape != GN_SHAPE_NONE;
    const bool tested = !body.group && !shaped && gn_scene_tested(&ctx->scene);
    const double given = tested ? gn_test_shape(ctx, dem, boundary, solids).volume : 0.0;
    const body_space space = space_of(ctx, dem, v, body);
    double at_centres = 0.0, ways = 0.0;
    set_surface(dem, v, body, surface_at(ctx, dem, v, body, given, space.bearing), arms);
    close_surface(q, body);
    gn_membrane_balance(ctx, dem, body, q->start, none, q->skin);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_in_body(body, p)) continue;
        at_centres += gn_dot3(q->skin + 4 * p, q->start + 4 * p) / d;
        ways += arms[p] / d;
    }
    const double volume =
        given > 0.0 || !(space.filled > at_centres) ? at_centres + ways : space.filled;
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_is_in_body(body, p)) arms[p] *= (volume - at_centres) / ways;
    membrane->state->enclosed += volume;
}

/* Tells whether a body is more than a row of particles (2D) or a layer (3D). */
static bool spans(const gn_step_context *ctx, const gn_dem *dem, gn_skin_body body) {
    const gn_particles *q = &dem->particles;
    const int d = (int)ctx->scene.dimension;
    double count = 0.0, mean[3] = {0}, second[9] = {0}, values[3], vectors[9];
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_in_body(body, p)) continue;
        for (int a = 0; a < d; a++) mean[a] += q->start[4 * p + a];
        count += 1.0;
    }
    for (size_t p = 0; p < q->soa.count; p++)
        for (int k = 0; k < d * d && gn_is_in_body(body, p); k++)
            second[k] += (q->start[4 * p + k / d] - mean[k / d] / count) *
                         (q->start[4 * p + k % d] - mean[k % d] / count);
    gn_eigen_symmetric(d, second, values, vectors);
    return values[d - 1] > 1e-6 * values[0];
}

static gneiss_status finish_all(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                const gn_boundary *boundary, const gn_solids *solids, const view *v,
                                double *arms, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    bool pressed = false;
    for (size_t p = 0; p < n; p++) {
        const gn_skin_body body = {v->bodies == 1 ? NULL : v->body, (int32_t)p};
        if (!v->members[p]) continue;
        if (!spans(ctx, dem, body)) continue;
        finish(ctx, dem, membrane, boundary, solids, v, body, arms);
        pressed = true;
    }
    if (pressed || !n) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT, "%s: expected particles that enclose a volume, found %s",
        gn_scene_at(&ctx->scene, ctx->scene.membrane.where, "membrane").text,
        ctx->scene.dimension == 3 ? "none but such by themselves, in rows or in one layer"
                                  : "none but such by themselves or in rows");
}

gneiss_status gn_membrane_free_skin(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    double ball, double *arms, gneiss_error *error) {
    view v = {0};
    gneiss_status status = look(ctx, dem, &v, ball, error);
    if (status == GNEISS_OK)
        status = finish_all(ctx, dem, membrane, boundary, solids, &v, arms, error);
    free_view(&v);
    return status;
}
