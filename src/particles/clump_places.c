/* Creation of clumps: one by one, from a file, and at random in a box. */
#include "base/new.h"
#include "base/random.h"
#include "base/rotation.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/clump_shapes.h"
#include "particles/clumps.h"
#include "scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A clump that is to be made. */
typedef struct place {
    int shape;
    double centre[3], turn[4], velocity[3], spin[3]; /* turn: from the frame of the shape's rows */
} place;

/* The clumps made so far, and a grid of the spheres, in cells that are hashed to a table. */
typedef struct maker {
    const gn_scene *scene;
    gn_clump_shape *shape; /* [scene.clumps.shape_count] */
    gn_packing *packing;
    gn_clumps *clumps;
    size_t clump_room, member_room, sphere_room;
    int32_t *head, *next; /* [heads], [spheres]; made when a box is filled */
    size_t heads, next_room, filed;
    double cell, most; /* m: side of a cell, largest radius */
    uint64_t drawn;    /* count of random numbers */
} maker;

/* --- one clump --- */

static void set_clump(const gn_clump_shape *shape, const place *at, size_t first, gn_clump *c) {
    double local[3];
    *c = (gn_clump){.mass = shape->mass,
                    .inverse_mass = 1.0 / shape->mass,
                    .first = (double)first,
                    .count = (double)shape->count,
                    .present = 1.0};
    memcpy(c->position, at->centre, sizeof c->position);
    gn_turn_product(at->turn, shape->turn, c->turn);
    gn_turn_settle(c->turn, c->axes);
    memcpy(c->turn_start, c->turn, sizeof c->turn);
    memcpy(c->velocity, at->velocity, sizeof c->velocity);
    memcpy(c->inertia, shape->inertia, sizeof c->inertia);
    memcpy(c->spin, at->spin, sizeof c->spin);
    memcpy(c->mean_spin, at->spin, sizeof c->mean_spin);
    gn_axes_local(c->axes, c->spin, local);
    for (int a = 0; a < 3; a++) {
        if (c->inertia[a] > 0.0) c->inverse_inertia[a] = 1.0 / c->inertia[a];
        local[a] *= c->inertia[a];
    }
    gn_axes_direct(c->axes, local, c->momentum);
}

static void put_sphere(const gn_clump *c, const double sphere[4], double out[4]) {
    gn_axes_direct(c->axes, sphere, out);
    for (int a = 0; a < 3; a++) out[a] += c->position[a];
    out[3] = sphere[3];
}

static gneiss_status add_clump(maker *m, const place *at, gneiss_error *error) {
    gn_clumps *all = m->clumps;
    const gn_clump_shape *shape = &m->shape[at->shape];
    double weight = 0.0;
    GN_TRY(gn_grow(&all->clump, all->count, all->count + 1, &m->clump_room, "clumps", error));
    GN_TRY(gn_grow(&all->member, all->member_count, all->member_count + shape->count,
                   &m->member_room, "members of clumps", error));
    gn_packing *p = m->packing;
    GN_TRY(gn_grow(&p->sphere, 4 * p->count, 4 * (p->count + shape->count), &m->sphere_room,
                   "particles", error));
    gn_clump *c = &all->clump[all->count++];
    set_clump(shape, at, all->member_count, c);
    for (size_t k = 0; k < shape->count; k++) weight += gn_clump_ball_mass(m->scene, shape, k);
    for (size_t k = 0; k < shape->count; k++, all->member_count++, p->count++) {
        const double mass = gn_clump_ball_mass(m->scene, shape, k);
        gn_clump_member *to = &all->member[all->member_count];
        memcpy(to->local, shape->sphere + 4 * k, sizeof to->local);
        to->part = mass / weight;
        to->inverse_mass = 1.0 / (shape->share * mass);
        to->inverse_inertia = 1.0 / (shape->share * gn_clump_ball_inertia(m->scene, shape, k));
        to->id = (double)p->count;
        to->material = shape->material;
        put_sphere(c, shape->sphere + 4 * k, p->sphere + 4 * p->count);
        m->most = fmax(m->most, shape->sphere[4 * k + 3]);
    }
    return GNEISS_OK;
}

static gneiss_status add_placed(maker *m, gneiss_error *error) {
    for (size_t k = 0; k < m->scene->clumps.placed_count; k++) {
        const gn_placed_clump_def *def = &m->scene->clumps.placed[k];
        place at = {.shape = gn_scene_find_clump_shape(m->scene, def->shape)};
        memcpy(at.centre, def->centre, sizeof at.centre);
        memcpy(at.velocity, def->velocity, sizeof at.velocity);
        memcpy(at.spin, def->spin, sizeof at.spin);
        gn_turn_of_vector(def->rotation, at.turn);
        GN_TRY(add_clump(m, &at, error));
    }
    return GNEISS_OK;
}

/* --- a file --- */

enum { LINE = 1024, NUMBERS = 13 };

/* Reads the numbers of a row after its name; returns their count, -1: a word is no finite number.
 */
static int read_numbers(char *rest, double value[NUMBERS]) {
    int count = 0;
    char *word = strtok_r(NULL, " \t\r\n,", &rest);
    for (; word; word = strtok_r(NULL, " \t\r\n,", &rest)) {
        char *end;
        if (count == NUMBERS) return -1;
        value[count] = strtod(word, &end);
        if (*end || !isfinite(value[count++])) return -1;
    }
    return count;
}

static gneiss_status bad_row(const gn_scene *scene, int line, const char *expected,
                             const char *found, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s:%d:1: expected %s, found %s", scene->clumps.path,
                   line, expected, found);
}

static gneiss_status read_row(const gn_scene *scene, char *text, int line, place *at,
                              gneiss_error *error) {
    double v[NUMBERS] = {0, 0, 0, 1};
    char *rest, *name = strtok_r(text, " \t\r\n,", &rest), found[128];
    const int count = read_numbers(rest, v);
    *at = (place){.shape = gn_scene_find_clump_shape(scene, name), .turn = {1.0}};
    snprintf(found, sizeof found, "'%.60s'", name);
    if (at->shape < 0) return bad_row(scene, line, "the name of a shape of clumps", found, error);
    if (count != 3 && count != 7 && count != 10 && count != 13)
        return bad_row(scene, line,
                       "a name and 3, 7, 10 or 13 finite numbers (centre, quaternion, velocity, "
                       "spin)",
                       "others", error);
    const double size = count > 3 ? sqrt(v[3] * v[3] + gn_dot3(v + 4, v + 4)) : 1.0;
    snprintf(found, sizeof found, "one of length %g", size);
    if (fabs(size - 1.0) > 1e-3) return bad_row(scene, line, "a unit quaternion", found, error);
    if (scene->dimension == 2 && (v[2] != 0 || v[4] != 0 || v[5] != 0 || v[9] != 0 || v[10] != 0))
        return bad_row(scene, line, "nothing out of the plane of a 2D scene", "others", error);
    for (int a = 0; a < 3; a++) {
        at->centre[a] = v[a] - scene->origin[a];
        at->velocity[a] = v[7 + a];
        at->spin[a] = v[10 + a];
    }
    for (int a = 0; count > 3 && a < 4; a++) at->turn[a] = v[3 + a] / size;
    return GNEISS_OK;
}

static gneiss_status add_rows(maker *m, FILE *file, gneiss_error *error) {
    char text[LINE];
    for (int line = 1; fgets(text, sizeof text, file); line++) {
        place at;
        const size_t begin = strspn(text, " \t\r\n");
        if (!text[begin] || text[begin] == '#') continue;
        if (!strchr(text, '\n') && !feof(file))
            return bad_row(m->scene, line, "a line of at most 1022 bytes", "a longer one", error);
        GN_TRY(read_row(m->scene, text, line, &at, error));
        GN_TRY(add_clump(m, &at, error));
    }
    if (!ferror(file)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot read: %s", m->scene->clumps.path,
                   strerror(errno));
}

static gneiss_status add_file(maker *m, gneiss_error *error) {
    if (!*m->scene->clumps.file) return GNEISS_OK;
    FILE *file = fopen(m->scene->clumps.path, "r");
    if (!file)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot open: %s", m->scene->clumps.path,
                       strerror(errno));
    const size_t before = m->clumps->count;
    gneiss_status status = add_rows(m, file, error);
    fclose(file);
    if (status == GNEISS_OK && m->clumps->count == before)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected rows of clumps, found none",
                       m->scene->clumps.path);
    return status;
}

/* --- random places --- */

static double draw(maker *m) {
    return 0.5 * (1.0 + gn_random_symmetric(m->scene->seed ^ UINT64_C(0x636c756d70), m->drawn++));
}

/* Draws a rotation, uniform over all of them (Shoemake 1992, Graphics Gems III, 124). */
static void draw_turn(maker *m, double turn[4]) {
    const double u = draw(m), a = 2.0 * pi * draw(m), b = 2.0 * pi * draw(m);
    const double s = sqrt(1.0 - u), c = sqrt(u);
    const double space[4] = {c * cos(b), s * sin(a), s * cos(a), c * sin(b)},
                 plane[4] = {cos(0.5 * a), 0.0, 0.0, sin(0.5 * a)};
    memcpy(turn, m->scene->dimension == 3 ? space : plane, sizeof space);
}

static void cell_at(const maker *m, const double *x, double reach, int64_t cell[3]) {
    for (int a = 0; a < 3; a++) cell[a] = (int64_t)floor((x[a] + reach) / m->cell);
}

static size_t head_of(const maker *m, const int64_t cell[3]) {
    const uint64_t mixed = (uint64_t)cell[0] * UINT64_C(0x9e3779b97f4a7c15) ^
                           (uint64_t)cell[1] * UINT64_C(0xc2b2ae3d27d4eb4f) ^
                           (uint64_t)cell[2] * UINT64_C(0x165667b19e3779f9);
    return (size_t)(gn_random_bits(mixed, 0) & (m->heads - 1));
}

/* Files the spheres that the grid does not have yet. */
static gneiss_status file_spheres(maker *m, gneiss_error *error) {
    GN_TRY(gn_grow(&m->next, m->filed, m->packing->count + 1, &m->next_room, "particles", error));
    for (; m->filed < m->packing->count; m->filed++) {
        int64_t cell[3];
        cell_at(m, m->packing->sphere + 4 * m->filed, 0.0, cell);
        const size_t head = head_of(m, cell);
        m->next[m->filed] = m->head[head];
        m->head[head] = (int32_t)m->filed;
    }
    return GNEISS_OK;
}

static gneiss_status make_grid(maker *m, gneiss_error *error) {
    double count = (double)m->packing->count;
    for (size_t k = 0; k < m->packing->count; k++)
        m->most = fmax(m->most, m->packing->sphere[4 * k + 3]);
    for (size_t k = 0; k < m->scene->clumps.shape_count; k++)
        for (size_t s = 0; s < m->shape[k].count; s++)
            m->most = fmax(m->most, m->shape[k].sphere[4 * s + 3]);
    for (size_t k = 0; k < m->scene->clumps.filled_count; k++)
        count += (double)m->scene->clumps.filled[k].count;
    for (m->heads = 1024; (double)m->heads < 4.0 * count;) m->heads *= 2;
    m->cell = 2.0 * m->most;
    GN_TRY(gn_new(&m->head, m->heads, "cells", error));
    for (size_t k = 0; k < m->heads; k++) m->head[k] = -1;
    return file_spheres(m, error);
}

static bool meets(const maker *m, const double s[4]) {
    int64_t low[3], high[3], cell[3];
    cell_at(m, s, -(s[3] + m->most), low);
    cell_at(m, s, s[3] + m->most, high);
    for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
        for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
            for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++)
                for (int32_t k = m->head[head_of(m, cell)]; k >= 0; k = m->next[k]) {
                    const double *x = m->packing->sphere + 4 * (int64_t)k, reach = x[3] + s[3],
                                 d[3] = {x[0] - s[0], x[1] - s[1], x[2] - s[2]};
                    if (gn_dot3(d, d) < reach * reach) return true;
                }
    return false;
}

/* Tells whether the clump is inside the box and free of other particles. */
static bool fits(const maker *m, const gn_filled_clumps_def *def, const place *at) {
    const gn_clump_shape *shape = &m->shape[at->shape];
    gn_clump c;
    set_clump(shape, at, 0, &c);
    for (size_t k = 0; k < shape->count; k++) {
        double s[4];
        put_sphere(&c, shape->sphere + 4 * k, s);
        for (int a = 0; a < (int)m->scene->dimension; a++)
            if (s[a] - s[3] < def->box_min[a] || s[a] + s[3] > def->box_max[a]) return false;
        if (meets(m, s)) return false;
    }
    return true;
}

static gneiss_status add_random(maker *m, size_t index, gneiss_error *error) {
    enum { TRIES = 2000 };
    const gn_filled_clumps_def *def = &m->scene->clumps.filled[index];
    for (int64_t made = 0; made < def->count; made++) {
        place at = {.shape = gn_scene_find_clump_shape(
                        m->scene, def->shapes[(size_t)((double)def->shape_count * draw(m))])};
        memcpy(at.velocity, def->velocity, sizeof at.velocity);
        bool found = false;
        for (int t = 0; t < TRIES && !found; t++) {
            draw_turn(m, at.turn);
            for (int a = 0; a < (int)m->scene->dimension; a++)
                at.centre[a] = def->box_min[a] + (def->box_max[a] - def->box_min[a]) * draw(m);
            found = fits(m, def, &at);
        }
        if (!found && !made)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s:%d:%d: clumps.filled[%zu].box: expected a box with room for a "
                           "clump, found none in %d random places",
                           m->scene->source, def->where.line, def->where.column, index, TRIES);
        if (!found)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s:%d:%d: clumps.filled[%zu].count: expected at most some %lld clumps, "
                           "for which random places were found, found %lld (a larger box, or fewer "
                           "clumps)",
                           m->scene->source, def->where.line, def->where.column, index,
                           (long long)made, (long long)def->count);
        GN_TRY(add_clump(m, &at, error));
        GN_TRY(file_spheres(m, error));
    }
    return GNEISS_OK;
}

/* --- all clumps --- */

/* Returns the largest distance between two points of the spheres of a shape, m. */
static double length_of(const gn_clump_shape *shape) {
    double most = 0.0;
    for (size_t k = 0; k < shape->count; k++)
        for (size_t i = 0; i <= k; i++) {
            const double *a = shape->sphere + 4 * i, *b = shape->sphere + 4 * k,
                         d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
            most = fmax(most, sqrt(gn_dot3(d, d)) + a[3] + b[3]);
        }
    return most;
}

/* Refuses a shape that could meet its own images in a periodic box. */
static gneiss_status check_length(const gn_step_context *ctx, size_t index,
                                  const gn_clump_shape *shape, gneiss_error *error) {
    const gn_clump_shape_def *def = &ctx->scene.clumps.shapes[index];
    char path[48];
    for (int a = 0; a < (int)ctx->scene.dimension; a++) {
        const double half = 0.5 * ctx->period[a];
        if (!(half > 0.0) || 2.0 * shape->reach <= half || length_of(shape) <= half) continue;
        snprintf(path, sizeof path, "clumps.shapes[%zu]", index);
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s (%s): expected a clump of at most half the length of the periodic box "
                       "along %c, which is %.6g m, found one of %.6g m",
                       gn_scene_at(&ctx->scene, def->where, path).text, def->name, "xyz"[a], half,
                       length_of(shape));
    }
    return GNEISS_OK;
}

static gneiss_status make_all(const gn_step_context *ctx, maker *m, gneiss_error *error) {
    GN_TRY(gn_new(&m->shape, m->scene->clumps.shape_count, "shapes of clumps", error));
    for (size_t k = 0; k < m->scene->clumps.shape_count; k++) {
        GN_TRY(gn_clump_shape_make(m->scene, k, &m->shape[k], error));
        GN_TRY(check_length(ctx, k, &m->shape[k], error));
    }
    GN_TRY(add_placed(m, error));
    GN_TRY(add_file(m, error));
    if (m->scene->clumps.filled_count) GN_TRY(make_grid(m, error));
    for (size_t k = 0; k < m->scene->clumps.filled_count; k++) GN_TRY(add_random(m, k, error));
    return GNEISS_OK;
}

gneiss_status gn_clumps_make(const gn_step_context *ctx, gn_packing *packing, gn_clumps *clumps,
                             gneiss_error *error) {
    maker m = {.scene = &ctx->scene,
               .packing = packing,
               .clumps = clumps,
               .sphere_room = 4 * packing->count};
    if (!ctx->scene.has_clumps) return GNEISS_OK;
    gneiss_status status = make_all(ctx, &m, error);
    for (size_t k = 0; m.shape && k < ctx->scene.clumps.shape_count; k++)
        gn_clump_shape_free(&m.shape[k]);
    gn_free(m.shape);
    gn_free(m.head);
    gn_free(m.next);
    return status;
}
