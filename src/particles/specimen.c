#include "particles/specimen.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/random.h"
#include "frame/frame.h"
#include "io/packing.h"
#include "mesh/gmsh.h"
#include "mesh/mesh.h"
#include "pack/pack.h"
#include "pack/store.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* A unit cell: edge lengths over the nearest-neighbour distance, and centres in units of the edges.
 */
typedef struct unit_cell {
    double edge[3];
    int count;
    double centre[4][3];
} unit_cell;

static unit_cell cell_of(gn_lattice_kind kind) {
    const double s3 = sqrt(3.0), s2 = sqrt(2.0), c = sqrt(8.0 / 3.0);
    switch (kind) {
    case GN_LATTICE_SQUARE:
        return (unit_cell){{1, 1, 1}, 1, {{0, 0, 0}}};
    case GN_LATTICE_HEXAGONAL:
        return (unit_cell){{1, s3, 1}, 2, {{0, 0, 0}, {.5, .5, 0}}};
    case GN_LATTICE_CUBIC:
        return (unit_cell){{1, 1, 1}, 1, {{0, 0, 0}}};
    case GN_LATTICE_FCC:
        return (unit_cell){{s2, s2, s2}, 4, {{0, 0, 0}, {.5, .5, 0}, {.5, 0, .5}, {0, .5, .5}}};
    case GN_LATTICE_HCP:
        return (unit_cell){
            {1, s3, c}, 4, {{0, 0, 0}, {.5, .5, 0}, {.5, 1. / 6, .5}, {0, 2. / 3, .5}}};
    case GN_LATTICE_NONE:
        break;
    }
    return (unit_cell){{1, 1, 1}, 0, {{0, 0, 0}}};
}

static gneiss_status allocate(const gn_scene *scene, gn_packing *packing, double count,
                              gneiss_error *error) {
    if (count > 1e9)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected at most 1e9 particles, found %g",
                       gn_scene_at(scene, scene->specimen.where, "specimen").text, count);
    packing->count = (size_t)count;
    packing->sphere = gn_alloc_array(packing->count + 1, 4 * sizeof(double));
    if (!packing->sphere)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %.0f particles", count);
    return GNEISS_OK;
}

static gneiss_status make_lattice(const gn_scene *scene, gn_packing *packing, gneiss_error *error) {
    const gn_lattice *l = &scene->specimen.lattice;
    unit_cell cell = cell_of(l->kind);
    double a = 2.0 * l->radius * l->spacing;
    int64_t nz = scene->dimension == 3 ? l->cells[2] : 1;
    GN_TRY(allocate(scene, packing,
                    (double)l->cells[0] * (double)l->cells[1] * (double)nz * cell.count, error));
    size_t k = 0;
    for (int64_t z = 0; z < nz; z++)
        for (int64_t y = 0; y < l->cells[1]; y++)
            for (int64_t x = 0; x < l->cells[0]; x++)
                for (int c = 0; c < cell.count; c++, k++) {
                    double at[3] = {(double)x, (double)y, (double)z};
                    double *s = packing->sphere + 4 * k;
                    for (int d = 0; d < scene->dimension; d++) {
                        double jitter = l->jitter * l->radius *
                                        gn_random_symmetric(scene->seed, 3 * k + (uint64_t)d);
                        s[d] = l->origin[d] +
                               a * (0.5 + (at[d] + cell.centre[c][d]) * cell.edge[d]) + jitter;
                    }
                    s[3] = l->radius;
                }
    return GNEISS_OK;
}

static gneiss_status pack(const gn_scene *scene, gn_packing *packing, double *volume,
                          gneiss_error *error) {
    gn_pack_result result;
    char note[512];
    GN_TRY(gn_pack_obtain(scene, NULL, NULL, &result, note, sizeof note, error));
    *packing = result.packing;
    *volume = result.volume;
    result.packing = (gn_packing){0};
    gn_pack_result_free(&result);
    return GNEISS_OK;
}

/* Refuses particles of a size that no key allows, as files, scales, cells and rows may give
 * together although each is valid. */
static gneiss_status check_sizes(const gn_scene *scene, const gn_packing *packing,
                                 gneiss_error *error) {
    for (size_t p = 0; p < packing->count; p++) {
        const double *s = packing->sphere + 4 * p;
        double far = fmax(fabs(s[0]), fmax(fabs(s[1]), fabs(s[2])));
        if (far <= GN_PLACE_MOST && s[3] >= GN_LENGTH_LEAST && s[3] <= GN_PLACE_MOST) continue;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected coordinates up to %g m and radii of %g to %g m, "
                       "found particle %zu (base 0) at (%g, %g, %g) m with radius %g m",
                       gn_scene_at(scene, scene->specimen.where, "specimen").text, GN_PLACE_MOST,
                       GN_LENGTH_LEAST, GN_PLACE_MOST, p, s[0], s[1], s[2], s[3]);
    }
    return GNEISS_OK;
}

static gneiss_status make(const gn_scene *scene, gn_packing *packing, double *volume,
                          gneiss_error *error) {
    const gn_specimen *s = &scene->specimen;
    if (s->packed) {
        *volume = s->packed_volume;
        GN_TRY(allocate(scene, packing, (double)s->packed_count, error));
        memcpy(packing->sphere, s->packed, s->packed_count * 4 * sizeof(double));
        return GNEISS_OK;
    }
    if (s->lattice.kind != GN_LATTICE_NONE) return make_lattice(scene, packing, error);
    if (s->pack.shape != GN_SHAPE_NONE) return pack(scene, packing, volume, error);
    GN_TRY(allocate(scene, packing, (double)s->particle_count, error));
    memcpy(packing->sphere, s->particles, s->particle_count * 4 * sizeof(double));
    return GNEISS_OK;
}

/* --- extent of the specimen --- */

void gn_extent_add(gn_extent *extent, const double point[3], double radius) {
    for (int a = 0; a < 3; a++) {
        extent->lower[a] = fmin(extent->lower[a], point[a] - radius);
        extent->upper[a] = fmax(extent->upper[a], point[a] + radius);
    }
}

static void add_lattice(const gn_lattice *lattice, gn_extent *extent) {
    unit_cell cell = cell_of(lattice->kind);
    double upper[3], a = 2.0 * lattice->radius * lattice->spacing;
    for (int d = 0; d < 3; d++)
        upper[d] = lattice->origin[d] + a * cell.edge[d] * (double)lattice->cells[d];
    gn_extent_add(extent, lattice->origin, 0.0);
    gn_extent_add(extent, upper, 0.0);
}

static void add_file(const gn_scene *scene, gn_extent *extent) {
    const gn_pack_def *p = &scene->specimen.pack;
    double scale = scene->specimen.scale;
    gn_mesh mesh = {0};
    if (p->shape == GN_SHAPE_SURFACE)
        gn_mesh_read_surface(p->surface_path, scale, &mesh, NULL);
    else if (!gn_is_geometry(p->mesh_path))
        gn_mesh_read_msh(p->mesh_path, scale, &mesh, NULL);
    for (size_t n = 0; n < mesh.node_count; n++) gn_extent_add(extent, mesh.node + 3 * n, 0.0);
    gn_mesh_free(&mesh);
}

static void add_shape(const gn_scene *scene, gn_extent *extent) {
    const gn_pack_def *p = &scene->specimen.pack;
    double upper[3];
    if (p->shape == GN_SHAPE_SURFACE || p->shape == GN_SHAPE_MESH) add_file(scene, extent);
    for (size_t k = 0; p->shape == GN_SHAPE_POLYGON && k < p->corner_count; k++)
        gn_extent_add(extent, (const double[3]){p->corners[2 * k], p->corners[2 * k + 1], 0.0},
                      0.0);
    if (p->shape == GN_SHAPE_DISC || p->shape == GN_SHAPE_CYLINDER)
        gn_extent_add(extent, p->origin, 0.5 * p->diameter);
    if (p->shape != GN_SHAPE_RECTANGLE && p->shape != GN_SHAPE_BOX && p->shape != GN_SHAPE_CYLINDER)
        return;
    bool sides = p->shape != GN_SHAPE_CYLINDER;
    for (int a = 0; a < 3; a++) upper[a] = p->origin[a] + (sides ? p->size[a] : 0.0);
    if (!sides) upper[2] += p->height;
    gn_extent_add(extent, p->origin, 0.0);
    gn_extent_add(extent, upper, 0.0);
}

static void add_clumps(const gn_clumps_def *clumps, gn_extent *extent) {
    for (size_t k = 0; k < clumps->placed_count; k++)
        gn_extent_add(extent, clumps->placed[k].centre, 0.0);
    for (size_t k = 0; k < clumps->filled_count; k++) {
        gn_extent_add(extent, clumps->filled[k].box_min, 0.0);
        gn_extent_add(extent, clumps->filled[k].box_max, 0.0);
    }
}

void gn_specimen_extent(const gn_scene *scene, gn_extent *extent) {
    add_clumps(&scene->clumps, extent);
    const gn_specimen *s = &scene->specimen;
    const bool read = s->file[0] || s->from[0];
    const double *rows = read ? s->packed : s->particles;
    size_t count = read ? s->packed_count : s->particle_count;
    for (size_t k = 0; rows && k < count; k++) gn_extent_add(extent, rows + 4 * k, rows[4 * k + 3]);
    if (s->lattice.kind != GN_LATTICE_NONE) add_lattice(&s->lattice, extent);
    if (s->pack.shape != GN_SHAPE_NONE) add_shape(scene, extent);
}

/* Checks that a generated packing is inside the box; rows of a file may be outside, because their
 * particles have passed through its sides. */
static gneiss_status check_box(const gn_scene *scene, const gn_packing *packing,
                               gneiss_error *error) {
    const gn_specimen *s = &scene->specimen;
    const bool made = s->lattice.kind != GN_LATTICE_NONE || s->pack.shape != GN_SHAPE_NONE;
    for (int a = 0; made && a < (int)scene->dimension; a++) {
        const double length = scene->periodic_max[a] - scene->periodic_min[a];
        double low = INFINITY, high = -INFINITY;
        if (!scene->has_periodic || !gn_scene_periodic_along(scene, a)) continue;
        for (size_t p = 0; p < packing->count; p++) {
            low = fmin(low, packing->sphere[4 * p + a]);
            high = fmax(high, packing->sphere[4 * p + a]);
        }
        if (high - low < length) continue;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a box longer along %c than the centres of the specimen are "
                       "apart, %g m, found %g m",
                       gn_scene_at(scene, scene->periodic_where, "periodic").text, "xyz"[a],
                       high - low, length);
    }
    return GNEISS_OK;
}

gneiss_status gn_specimen_make(const gn_scene *scene, gn_packing *packing, double *volume,
                               gneiss_error *error) {
    *packing = (gn_packing){0};
    *volume = 0.0;
    GN_TRY(make(scene, packing, volume, error));
    gneiss_status status = check_sizes(scene, packing, error);
    if (status == GNEISS_OK) status = check_box(scene, packing, error);
    if (status != GNEISS_OK) gn_packing_free(packing);
    return status;
}

static gneiss_status check_prepared(const gn_step_context *ctx, const gn_particles *q,
                                    gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p;
        const double far = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
        const bool placed = isfinite(x[0] + x[1] + x[2]) && far <= GN_PLACE_MOST &&
                            x[3] >= GN_LENGTH_LEAST && x[3] <= GN_PLACE_MOST &&
                            (s->dimension == 3 || x[2] == 0.0);
        const bool known = q->material[p] >= 0 && (size_t)q->material[p] < s->material_count;
        if (placed && known && q->group[p] >= 0) continue;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected coordinates up to %g m (2D: z = 0), radii of %g to %g m, "
                       "materials below %zu and groups of at least 0, found particle %zu (base 0) "
                       "prepared at (%g, %g, %g) m with radius %g m, material %d, group %d",
                       gn_scene_at(s, s->specimen.where, "specimen").text, GN_PLACE_MOST,
                       GN_LENGTH_LEAST, GN_PLACE_MOST, s->material_count, p, x[0], x[1], x[2], x[3],
                       q->material[p], q->group[p]);
    }
    return GNEISS_OK;
}

gneiss_status gn_specimen_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    const gn_preparation *own = &ctx->given.preparation;
    const gn_particles *q = &dem->particles;
    const size_t count = q->soa.count;
    if (!own->act || !count) return GNEISS_OK;
    if (dem->clumps.count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a scene without clumps, whose particles a program prepares, "
                       "found one with them",
                       gn_scene_at(&ctx->scene, ctx->scene.clumps.where, "clumps").text);
    GN_TRY(own->act(own->context, count, q->pos, q->material, q->group, ctx->scene.origin, error));
    GN_TRY(check_prepared(ctx, q, error));
    memcpy(q->start, q->pos, count * 4 * sizeof(double));
    dem->radius_min = gn_flow_least_radius(ctx, dem);
    for (size_t p = 0; p < count; p++) dem->radius_min = fmin(dem->radius_min, q->pos[4 * p + 3]);
    return GNEISS_OK;
}

bool gn_specimen_is_narrow(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size) {
    const gn_particles *q = &dem->particles;
    double least = INFINITY, most = 0.0;
    if (ctx->scene.source_count || ctx->scene.sink_count) return false;
    for (size_t p = 0; p < q->soa.count; p++) {
        least = fmin(least, q->pos[4 * p + 3]);
        most = fmax(most, q->pos[4 * p + 3]);
    }
    return gn_pack_is_narrow(&ctx->scene, least, most, q->soa.count, text, size);
}
