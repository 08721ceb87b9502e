/* Update of the skin at a fixed interval of steps. The surface consists of its patches at the
 * start, each carried by a particle beneath it, and of the faces that detached particles exposed;
 * together they bound the remaining body. In a deforming body every patch rotates and stretches
 * with the particles around its bearer. */
#include "base/new.h"
#include "membrane/membrane.h"

#include "base/error.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "membrane/cells.h"
#include "particles/fragments.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* Sizes in mean radii: radius of the surroundings of a particle; cells of the grid. */
static const double around = 5.0, cell_size = 2.5;

/* Fraction of the difference to the present areas by which an update changes the areas. Larger
 * changes would follow waves of some hundred steps with a delay and excite them. */
static const double pace = 1.0 / 8.0;

/* Body number of open surfaces; number and factor of enlargements of surroundings with too few
 * particles. */
enum { OPEN = -1, WIDENED = 3 };
static const double wider = 1.5;

/* Limits of the stretch of a patch relative to that of the whole skin. */
static const double stretch_most = 3.0;

/* --- how the surroundings have moved --- */

typedef struct view {
    const gn_particles *particles;
    const int32_t *group; /* [particles] body; NULL: there is only one */
    size_t middle;
    double reach;
    gn_gradient_fit fit;
} view;

static void see(void *context, int32_t particle) {
    view *v = context;
    const gn_particles *q = v->particles;
    const size_t p = (size_t)particle;
    double from[3], to[3];
    if (v->group && v->group[p] != v->group[v->middle]) return;
    for (int a = 0; a < 3; a++) from[a] = q->start[4 * p + a] - q->start[4 * v->middle + a];
    const double weight = 1.0 - gn_dot3(from, from) / (v->reach * v->reach);
    if (!(weight > 0.0)) return;
    for (int a = 0; a < 3; a++) to[a] = q->pos[4 * p + a] - q->pos[4 * v->middle + a];
    gn_gradient_add(&v->fit, weight, from, to);
}

/* Tells whether the surroundings determine a deformation along all axes. If their extent along one
 * of them is small, a single displaced particle would rotate and stretch the patches beside it. */
static bool determines_gradient(const view *v, double radius, double gradient[9]) {
    const double enough = 1.5;
    double cofactor[9];
    if (!(gn_gradient_spread(&v->fit) >= enough * radius * radius)) return false;
    if (!gn_gradient_of(&v->fit, gradient)) return false;
    gn_cofactor3(gradient, cofactor);
    return gn_dot3(gradient, cofactor) > 0.0;
}

/* State of an update: bodies, the grid of particles that determine the deformation, and the
 * deformation of the skin of each body. */
typedef struct look {
    const int32_t *group;        /* NULL: all particles are one body */
    const gn_start_grid *around; /* particles that determine the deformation; NULL: the deformation
                                    is that of the start */
    double radius;
    double (*whole)[9]; /* [particles] deformation of the skin, at the leading particle of a body;
                           only with several bodies */
} look;

static const double *whole_of(const gn_membrane *membrane, const look *l, size_t p) {
    return l->whole ? l->whole[l->group[p]] : membrane->state->gradient;
}

/* Finds the gradient of the surroundings, which are widened if few particles remain or the body is
 * thin; the last resort is the gradient of the whole skin. */
static void gradient_around(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_membrane *membrane, const look *l, size_t p,
                            double gradient[9]) {
    for (int k = 0; k <= WIDENED; k++) {
        view v = {.particles = &dem->particles,
                  .group = l->group,
                  .middle = p,
                  .reach = around * l->radius * pow(wider, k),
                  .fit = {.dimension = (int)ctx->scene.dimension}};
        gn_start_grid_visit(l->around, dem->particles.start + 4 * p, v.reach, see, &v);
        if (determines_gradient(&v, l->radius, gradient)) return;
    }
    memcpy(gradient, whole_of(membrane, l, p), 9 * sizeof *gradient);
}

/* Fits the skin of each of several bodies, relative to its leading particle. */
static gneiss_status fit_bodies(const gn_step_context *ctx, const gn_dem *dem, look *l,
                                gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const size_t n = q->soa.count;
    gn_gradient_fit *fit = gn_alloc_array(n + 1, sizeof *fit);
    l->whole = gn_alloc_array(n + 1, sizeof *l->whole);
    for (size_t p = 0; fit && l->whole && p < n; p++) {
        const size_t lead = (size_t)l->group[p];
        double from[3], to[3];
        if (!gn_is_loaded(q, p)) continue;
        for (int a = 0; a < 3; a++) {
            from[a] = q->start[4 * p + a] - q->start[4 * lead + a];
            to[a] = q->pos[4 * p + a] - q->pos[4 * lead + a];
        }
        fit[lead].dimension = (int)ctx->scene.dimension;
        gn_gradient_add(&fit[lead], 1.0, from, to);
    }
    for (size_t p = 0; fit && l->whole && p < n; p++) gn_gradient_of(&fit[p], l->whole[p]);
    const bool made = fit && l->whole;
    gn_free(fit);
    return made ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the bodies of a skin");
}

/* --- areas --- */

static double size_of(const gn_patch *patch) {
    return patch->size > 0.0 ? patch->size : sqrt(gn_dot3(patch->area, patch->area));
}

/* Adds a patch to the area of its bearer, and its arm to `arms`. An exposed face is also added to
 * `bared`, whose resultant determines its size, an original patch to the size of the bearer's area.
 */
static void add_patch(gn_dem *dem, const gn_patch *patch, size_t p, const double gradient[9],
                      double bared[3], double arms[9]) {
    gn_particles *q = &dem->particles;
    double turn[9], area[3], start[3], way[3], half[9], rest[9];
    gn_cofactor3(gradient, turn);
    gn_product3(turn, patch->rest, half);
    gn_product3_bt(half, gradient, rest);
    for (int a = 0; a < 3; a++) {
        area[a] = gn_dot3(turn + 3 * a, patch->area);
        start[a] = patch->point[a] - q->start[4 * p + a];
        q->skin[4 * p + a] += area[a];
        if (patch->size == 0.0) bared[a] += area[a];
    }
    for (int a = 0; a < 3; a++) way[a] = gn_dot3(gradient + 3 * a, start);
    for (int k = 0; k < 9; k++) arms[k] += area[k / 3] * way[k % 3] + rest[k];
    const double size = gn_dot3(patch->area, patch->area);
    q->skin[4 * p + 3] += patch->size * (size > 0.0 ? sqrt(gn_dot3(area, area) / size) : 1.0);
}

/* Returns the ratio of the sizes of a patch deformed with its surroundings and with the whole skin.
 */
static double stretch_of(const gn_patch *patch, const double turn[9], const double whole[9]) {
    double here = 0.0, all = 0.0;
    for (int a = 0; a < 3; a++) {
        const double x = gn_dot3(turn + 3 * a, patch->area),
                     y = gn_dot3(whole + 3 * a, patch->area);
        here += x * x;
        all += y * y;
    }
    return all > 0.0 ? sqrt(here / all) : 1.0;
}

/* Replaces the deformation of a patch by that of the skin of its body if the surroundings would
 * stretch it much more or less than that skin. Returns the size of such patches, counted from patch
 * k, else 0. */
static double limit_stretch(const double as_whole[9], const gn_membrane *membrane, size_t k,
                            double gradient[9]) {
    const int32_t owner = membrane->patches[k].owner;
    double turn[9], whole[9], size = 0.0;
    bool holds = true;
    gn_cofactor3(gradient, turn);
    gn_cofactor3(as_whole, whole);
    for (; k < membrane->patch_count && membrane->patches[k].owner == owner; k++) {
        const double stretch = stretch_of(&membrane->patches[k], turn, whole);
        holds = holds && stretch < stretch_most && stretch * stretch_most > 1.0;
        size += size_of(&membrane->patches[k]);
    }
    if (holds) return 0.0;
    memcpy(gradient, as_whole, 9 * sizeof *gradient);
    return size;
}

/* Adds all patches, which are sorted by their particles, either deformed with their surroundings or
 * as at the start. */
static void add_patches(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                        const look *l, double arms[9]) {
    gn_particles *q = &dem->particles;
    double gradient[9], unlike = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (!gn_is_detached(q, p)) memset(q->skin + 4 * p, 0, 4 * sizeof(double));
    for (size_t k = 0; k < membrane->patch_count;) {
        const int32_t owner = membrane->patches[k].owner;
        const int32_t at = gn_patch_bearer(dem, &membrane->patches[k]);
        double bared[3] = {0};
        memcpy(gradient, membrane->state->gradient, sizeof gradient);
        if (l->around && at >= 0) {
            gradient_around(ctx, dem, membrane, l, (size_t)at, gradient);
            unlike += limit_stretch(whole_of(membrane, l, (size_t)at), membrane, k, gradient);
        }
        for (; k < membrane->patch_count && membrane->patches[k].owner == owner; k++)
            if (at >= 0) add_patch(dem, &membrane->patches[k], (size_t)at, gradient, bared, arms);
        if (at >= 0) q->skin[4 * at + 3] += sqrt(gn_dot3(bared, bared));
    }
    if (membrane->state->pressure > 0.0)
        membrane->state->unlike = fmax(membrane->state->unlike, unlike / gn_membrane_area(dem));
}

/* Sums up the patches of a body, deformed with the whole skin: area, and area times position
 * relative to a particle `base`. For a closed surface the first is 0 and the second is the volume.
 */
static void surface_sums(const gn_dem *dem, const gn_membrane *membrane, gn_skin_body body,
                         size_t base, double area[3], double tensor[9]) {
    const gn_dem *d = dem;
    const gn_membrane_state *m = membrane->state;
    const double *start = d->particles.start + 4 * base;
    double turn[9], half[9], sum[3] = {0}, all[9] = {0};
    const bool closed = body.group && body.is != OPEN;
    if (!closed) memcpy(sum, m->missing, sizeof sum);
    for (int c = 0; !closed && c < 9; c++) all[c] = m->rest[c] - m->missing[c / 3] * start[c % 3];
    for (size_t k = 0; k < membrane->patch_count; k++) {
        const gn_patch *patch = &membrane->patches[k];
        const int32_t at = gn_patch_bearer(d, patch);
        if (at < 0) continue;
        if (body.group && body.group[at] != body.is) continue;
        for (int a = 0; a < 3; a++) sum[a] += patch->area[a];
        for (int c = 0; c < 9; c++)
            all[c] += patch->area[c / 3] * (patch->point[c % 3] - start[c % 3]) + patch->rest[c];
    }
    gn_cofactor3(m->gradient, turn);
    for (int a = 0; a < 3; a++) area[a] = gn_dot3(turn + 3 * a, sum);
    gn_product3(turn, all, half);
    gn_product3_bt(half, m->gradient, tensor);
}

/* Converts a moment about `base` to one about 0. */
static void moment_of(const double base[3], const double area[3], const double tensor[9],
                      double moment[3]) {
    gn_cross3(base, area, moment);
    for (int a = 0; a < 3; a++)
        moment[a] +=
            tensor[3 * ((a + 2) % 3) + (a + 1) % 3] - tensor[3 * ((a + 1) % 3) + (a + 2) % 3];
}

void gn_membrane_rebalance(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_membrane *membrane, double *area) {
    const gn_particles *q = &dem->particles;
    const gn_skin_body all = {0};
    double sum[3], tensor[9], moment[3];
    size_t base = 0;
    while (base < q->soa.count && !gn_is_loaded(q, base)) base++;
    if (base == q->soa.count) return;
    surface_sums(dem, membrane, all, base, sum, tensor);
    moment_of(q->pos + 4 * base, sum, tensor, moment);
    gn_membrane_balance(ctx, dem, all, q->pos, moment, area);
}

/* Distributes the difference between the sum of areas and that of the surface over all areas by
 * their size, and then restores the moment. Both differences vanish for a closed surface. */
static void bring_into_balance(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                               gn_skin_body body, const double *place) {
    gn_particles *q = &dem->particles;
    double area[3], tensor[9], moment[3];
    const double sum = gn_membrane_area_of(dem, body);
    size_t base = 0;
    if (!(sum > 0.0)) return;
    while (!gn_is_loaded_of(q, body, base)) base++;
    surface_sums(dem, membrane, body, base, area, tensor);
    if (body.group && body.is != OPEN) {
        memset(area, 0, sizeof area);
        memset(tensor, 0, sizeof tensor);
    }
    moment_of(place + 4 * base, area, tensor, moment);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            if (gn_is_loaded_of(q, body, p)) area[a] -= q->skin[4 * p + a];
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            if (gn_is_loaded_of(q, body, p))
                q->skin[4 * p + a] += q->skin[4 * p + 3] / sum * area[a];
    gn_membrane_balance(ctx, dem, body, place, moment, q->skin);
}

/* Sets the group of bodies whose surface is not closed to OPEN. */
static void find_open(const gn_dem *dem, const gn_membrane *membrane, int32_t *group,
                      double (*sums)[4]) {
    const gn_dem *d = dem;
    const double nearly = 0.03;
    const size_t n = d->particles.soa.count;
    for (size_t k = 0; k < membrane->patch_count; k++) {
        const int32_t at = gn_patch_bearer(d, &membrane->patches[k]);
        if (at < 0) continue;
        for (int a = 0; a < 3; a++) sums[group[at]][a] += membrane->patches[k].area[a];
        sums[group[at]][3] += size_of(&membrane->patches[k]);
    }
    for (size_t p = 0; p < n; p++) {
        const double *s = sums[group[p]];
        if (gn_dot3(s, s) >= nearly * nearly * s[3] * s[3]) group[p] = OPEN;
    }
}

/* Numbers closed bodies from 0 on; all others get the last number. Returns the count. `number`
 * [particles] is scratch. */
static int64_t number_bodies(gn_dem *dem, gn_membrane *membrane, const int32_t *group,
                             int32_t *number) {
    gn_dem *d = dem;
    int32_t count = 0;
    bool open = false;
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (group[p] == (int32_t)p) number[p] = count++;
    for (size_t k = 0; k < membrane->patch_count; k++) {
        const int32_t p = gn_patch_bearer(d, &membrane->patches[k]);
        if (p < 0) continue;
        open = open || group[p] == OPEN;
        membrane->patches[k].body = group[p] == OPEN ? count : number[group[p]];
    }
    return (int64_t)count + open;
}

/* Balances every body with a closed surface separately; otherwise separate bodies would push and
 * rotate each other. Bodies with open surfaces, as on the two sides of a crack, are balanced
 * together. */
static gneiss_status balance_bodies(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                    int32_t *group, const double *place, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    if (!group) {
        bring_into_balance(ctx, dem, membrane, (gn_skin_body){0}, place);
        membrane->state->bodies = 1;
        return GNEISS_OK;
    }
    double(*sums)[4] = gn_alloc_array(n + 1, sizeof *sums);
    if (!sums) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the bodies of a skin");
    find_open(dem, membrane, group, sums);
    for (size_t p = 0; p < n; p++)
        if (group[p] == (int32_t)p)
            bring_into_balance(ctx, dem, membrane, (gn_skin_body){group, (int32_t)p}, place);
    bring_into_balance(ctx, dem, membrane, (gn_skin_body){group, OPEN}, place);
    membrane->state->bodies = number_bodies(dem, membrane, group, (int32_t *)sums);
    gn_free(sums);
    return GNEISS_OK;
}

/* Computes J^-1 F^T, which maps deformed area vectors back. */
static void back_of(const double gradient[9], double back[9]) {
    double cofactor[9];
    gn_cofactor3(gradient, cofactor);
    const double det = gn_dot3(gradient, cofactor);
    for (int k = 0; k < 9; k++) back[k] = gradient[k % 3 * 3 + k / 3] / det;
}

/* Converts areas to the undeformed state of their body, and arms to that of the skin; steps deform
 * them again. */
static gneiss_status reference_areas(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                     double arms[9], gneiss_error *error) {
    gn_particles *q = &dem->particles;
    gn_membrane_state *m = membrane->state;
    double cofactor[9], inverse[9], back[9], half[9];
    gn_cofactor3(m->gradient, cofactor);
    back_of(m->gradient, back);
    const double det = gn_dot3(m->gradient, cofactor);
    for (int k = 0; k < 9; k++) inverse[k] = cofactor[k % 3 * 3 + k / 3] / det;
    gn_product3(back, arms, half);
    gn_product3_bt(half, inverse, m->arms);
    GN_TRY(gn_membrane_fit_bodies(ctx, dem, membrane, error));
    for (size_t p = 0; p < q->soa.count; p++) {
        double *s = q->skin + 4 * p;
        if (!gn_is_loaded(q, p)) continue;
        const double now[3] = {s[0], s[1], s[2]};
        back_of(gn_membrane_gradient_at(ctx, membrane, p), back);
        for (int a = 0; a < 3; a++) s[a] = gn_dot3(back + 3 * a, now);
    }
    return GNEISS_OK;
}

/* Deforms the areas and arms of the last update with the mean motion of their bodies since; area
 * [particles][4], arms [9]. */
static void advance_areas(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_membrane *membrane, double *area, double arms[9]) {
    const gn_particles *q = &dem->particles;
    const gn_membrane_state *m = membrane->state;
    double turn[9], half[9];
    gn_cofactor3(m->gradient, turn);
    gn_product3(turn, m->arms, half);
    gn_product3_bt(half, m->gradient, arms);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_loaded(q, p)) continue;
        gn_cofactor3(gn_membrane_gradient_at(ctx, membrane, p), turn);
        for (int a = 0; a < 3; a++) area[4 * p + a] = gn_dot3(turn + 3 * a, q->skin + 4 * p);
    }
}

/* Moves areas and arms from the former to the present ones by a fraction of the difference. */
static void blend(gn_dem *dem, const double *was, const double had[9], double arms[9]) {
    gn_particles *q = &dem->particles;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3 && gn_is_loaded(q, p); a++)
            q->skin[4 * p + a] = was[4 * p + a] + pace * (q->skin[4 * p + a] - was[4 * p + a]);
    for (int k = 0; k < 9; k++) arms[k] = had[k] + pace * (arms[k] - had[k]);
}

/* Makes a grid of the particles that bonds hold, because grains that roll independently do not show
 * how a body moves. */
static gneiss_status grid_of_held(const gn_step_context *ctx, const gn_dem *dem, double cell,
                                  gn_start_grid *grid, gneiss_error *error) {
    bool *held = NULL;
    GN_TRY(gn_new(&held, dem->particles.soa.count + 1, "the skin of a specimen", error));
    gneiss_status status = gn_membrane_find_supported(ctx, dem, held, error);
    if (status == GNEISS_OK) status = gn_start_grid_make(ctx, dem, cell, held, grid, error);
    gn_free(held);
    return status;
}

/* Adds the patches, deformed with the surroundings of their bearers. */
static gneiss_status add_moved(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                               const int32_t *group, double arms[9], gneiss_error *error) {
    gn_start_grid grid = {0};
    look l = {.group = group, .radius = gn_dem_mean_radius(dem)};
    gneiss_status status = grid_of_held(ctx, dem, cell_size * l.radius, &grid, error);
    if (status != GNEISS_OK) return status;
    l.around = &grid;
    if (group) status = fit_bodies(ctx, dem, &l, error);
    if (status == GNEISS_OK) add_patches(ctx, dem, membrane, &l, arms);
    gn_start_grid_free(&grid);
    gn_free(l.whole);
    return status;
}

/* Computes the areas from patches and moves towards them from `was` (the areas before, used as
 * scratch), or sets them at once if it is NULL. */
static gneiss_status lay(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                         int32_t *group, double *was, gneiss_error *error) {
    const gn_membrane_state *m = membrane->state;
    const bool follow = ctx->scene.membrane.follow && ctx->step > 0;
    double arms[9], had[9], turn[9], half[9];
    if (was) advance_areas(ctx, dem, membrane, was, had);
    gn_cofactor3(m->gradient, turn);
    gn_product3(turn, m->rest, half);
    gn_product3_bt(half, m->gradient, arms);
    if (follow) GN_TRY(add_moved(ctx, dem, membrane, group, arms, error));
    if (!follow) add_patches(ctx, dem, membrane, &(look){0}, arms);
    if (was) blend(dem, was, had, arms);
    GN_TRY(balance_bodies(ctx, dem, membrane, group,
                          ctx->scene.membrane.follow ? dem->particles.pos : dem->particles.start,
                          error));
    return reference_areas(ctx, dem, membrane, arms, error);
}

gneiss_status gn_membrane_update_areas(const gn_step_context *ctx, gn_dem *dem,
                                       gn_membrane *membrane, bool anew, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    const bool carries = !anew && ctx->scene.membrane.follow && ctx->step > 0;
    int32_t *group = gn_alloc_array(n + 1, sizeof *group);
    double *was = carries ? gn_alloc_array(4 * n + 1, sizeof *was) : NULL;
    gneiss_status status =
        group && (was || !carries)
            ? gn_membrane_fit_bodies(ctx, dem, membrane, error)
            : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the bodies of a skin");
    if (status == GNEISS_OK) {
        const size_t bodies = gn_dem_body_groups(ctx, dem, GN_CHIP, group);
        status = lay(ctx, dem, membrane, bodies > 1 ? group : NULL, was, error);
    }
    gn_free(group);
    gn_free(was);
    return status;
}
