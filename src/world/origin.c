#include "world/origin.h"

#include "base/error.h"
#include "base/point.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "io/packing.h"
#include "mesh/gmsh.h"
#include "mesh/mesh.h"
#include "particles/from_run.h"
#include "particles/particles.h"
#include "particles/specimen.h"
#include "scene/mesh_def.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "scene/units.h"
#include "scene/values.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* Limit of the spacing of doubles over the smallest radius or height. Rock breaks at strains of
 * 1e-4 to 1e-3; rounding then changes them by less than 1e-4 of their value. */

/* --- choice of the origin --- */

static void add_elements(const gn_scene *scene, const gn_mesh *mesh, gn_extent *extent) {
    const gn_element_def *e = &scene->elements;
    const gn_beam_def *b = &e->beam;
    const double beam[3] = {b->length, b->height, b->thickness};
    const double *lower = e->has_beam ? b->origin : e->origin, *size = e->has_beam ? beam : e->size;
    for (size_t n = 0; e->mesh[0] && n < mesh->node_count; n++)
        gn_extent_add(extent, mesh->node + 3 * n, 0.0);
    if (e->mesh[0]) return;
    double upper[3];
    for (int a = 0; a < 3; a++) upper[a] = lower[a] + size[a];
    gn_extent_add(extent, lower, 0.0);
    gn_extent_add(extent, upper, 0.0);
}

/* Gives an axis an origin of more than a small multiple of the model's extent only if the model is
 * far from 0 along it. */
static void settle(gn_scene *scene, const gn_extent *extent) {
    double size = 0.0, far = 0.0, middle[3] = {0, 0, 0};
    int exponent;
    for (int64_t a = 0; a < scene->dimension; a++) {
        middle[a] = 0.5 * extent->lower[a] + 0.5 * extent->upper[a];
        size = fmax(size, extent->upper[a] - extent->lower[a]);
        far = fmax(far, fabs(middle[a]));
    }
    scene->has_origin = true;
    memset(scene->origin, 0, sizeof scene->origin);
    if (!isfinite(far) || !(far > 1000.0 * size)) return;
    frexp(size, &exponent);
    double unit = ldexp(1.0, exponent);
    for (int64_t a = 0; a < scene->dimension; a++) {
        double whole = unit * nearbyint(middle[a] / unit);
        scene->origin[a] =
            fabs(whole) <= GN_PLACE_MOST ? whole : middle[a]; /* bound of the range of the key */
    }
}

static gneiss_status read_elements(const gn_scene *scene, gn_mesh *mesh, gneiss_error *error) {
    const gn_element_def *e = &scene->elements;
    gneiss_status status = GNEISS_OK;
    if (gn_is_geometry(e->mesh_path)) {
        char command[GN_PATH_SIZE + 128];
        gn_mesh_geometry_command(e->mesh_path, (int)scene->dimension, command, sizeof command);
        status = gn_fail(error, GNEISS_ERROR_INPUT,
                         "expected a mesh of elements (.msh), found the geometry '%.300s'; %.700s, "
                         "with Mesh.ElementOrder = 1; in LINEAR.geo, meshes it, which runs what it "
                         "asks for",
                         e->mesh, command);
    } else {
        status = gn_mesh_read_msh(e->mesh_path, e->scale, mesh, error);
    }
    if (status == GNEISS_OK) return status;
    gn_scene_place where = e->mesh_where.line ? e->mesh_where : e->where;
    return gn_fail_context(error, "%s: ", gn_scene_at(scene, where, "elements.mesh").text);
}

gneiss_status gn_origin_choose(gn_scene *scene, const gn_mesh *mesh, gneiss_error *error) {
    gn_extent extent = GN_EXTENT_NONE;
    gn_mesh own = {0};
    if (scene->has_origin) return GNEISS_OK;
    if (scene->has_specimen) gn_specimen_extent(scene, &extent);
    if (scene->has_elements && scene->elements.mesh[0] && !mesh)
        GN_TRY(read_elements(scene, &own, error));
    if (scene->has_elements) add_elements(scene, mesh ? mesh : &own, &extent);
    gn_mesh_free(&own);
    settle(scene, &extent);
    return GNEISS_OK;
}

/* --- change to the origin --- */

static void take_off(const gn_scene *scene, double *rows, size_t count, size_t width) {
    for (size_t k = 0; k < count; k++)
        for (size_t a = 0; a < (size_t)scene->dimension; a++)
            rows[width * k + a] -= scene->origin[a];
}

gneiss_status gn_origin_shift(gn_world *world, gneiss_error *error) {
    if (world->ctx.given.stage_count) {
        GN_TRY(gn_stages_scene(world, &world->ctx.scene, error));
    } else {
        GN_TRY(gn_scene_copy(&world->ctx.given, &world->ctx.scene, error));
        gn_scene_shift(&world->ctx.scene);
    }
    world->ctx.scene.specimen.packed = world->ctx.given.specimen.packed;
    world->ctx.scene.specimen.packed_count = world->ctx.given.specimen.packed_count;
    world->ctx.scene.specimen.packed_volume = world->ctx.given.specimen.packed_volume;
    world->ctx.scene.specimen.packed_columns = world->ctx.given.specimen.packed_columns;
    world->ctx.given.specimen.packed_columns = (gn_particle_columns){0};
    world->ctx.given.specimen.packed = NULL;
    world->ctx.given.specimen.packed_count = 0;
    return GNEISS_OK;
}

/* Reads positions only; velocities and bonds are read when they are needed. */
static gneiss_status read_run(gn_scene *scene, gneiss_error *error) {
    gn_from_run from;
    GN_TRY(gn_from_run_read(scene, &from, error));
    scene->specimen.packed = from.sphere;
    scene->specimen.packed_count = from.count;
    scene->specimen.packed_volume = from.volume;
    from.sphere = NULL;
    gn_from_run_free(&from);
    return GNEISS_OK;
}

static bool read_unit(void *units, const char *text, const char *unit, double *value, char *reason,
                      size_t size) {
    return gn_units_read(units, text, unit, value, reason, size);
}

static int material_of(const void *scene, const char *name) {
    return gn_scene_find_material(scene, name);
}

/* Checks that columns of a file state what the scene leaves out, and the ids by which it selects.
 */
static gneiss_status check_columns(const gn_scene *scene, const gn_particle_columns *columns,
                                   gneiss_error *error) {
    if (!columns->material && !scene->specimen.material[0])
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected specimen.material, or a column material in %s, found neither "
                       "and %zu materials",
                       gn_scene_at(scene, scene->specimen.where, "specimen").text,
                       scene->specimen.file, scene->material_count);
    for (size_t k = 0; columns->renumbered && k < scene->set_count; k++)
        if (scene->sets[k].id_count)
            return gn_fail(
                error, GNEISS_ERROR_INPUT,
                "%s: set '%s': select.ids: expected ids 0, 1, 2, ... in %s, found others, "
                "which are replaced by these",
                gn_scene_at(scene, scene->sets[k].where, "sets").text, scene->sets[k].name,
                scene->specimen.file);
    return GNEISS_OK;
}

static gneiss_status read_file(gn_scene *scene, gneiss_error *error) {
    gn_packing packing;
    gn_units *units = gn_units_new();
    if (!units) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for units");
    const gn_packing_words words = {.units = units,
                                    .unit = read_unit,
                                    .materials = scene,
                                    .material = material_of,
                                    .material_count = scene->material_count};
    gneiss_status status = gn_packing_read_columns(scene->specimen.path, (int)scene->dimension,
                                                   scene->specimen.scale, &words, &packing, error);
    gn_units_free(units);
    GN_TRY(status);
    scene->specimen.packed = packing.sphere;
    scene->specimen.packed_count = packing.count;
    scene->specimen.packed_columns = packing.columns;
    return check_columns(scene, &packing.columns, error);
}

static gneiss_status read_specimen(gn_scene *scene, gneiss_error *error) {
    if (!scene->has_specimen) return GNEISS_OK;
    if (scene->specimen.from[0]) return read_run(scene, error);
    return scene->specimen.file[0] ? read_file(scene, error) : GNEISS_OK;
}

gneiss_status gn_origin_enter(gn_world *world, gn_mesh *mesh, gneiss_error *error) {
    gn_scene *s = &world->ctx.given;
    *mesh = (gn_mesh){0};
    GN_TRY(read_specimen(s, error));
    if (s->has_elements && s->elements.mesh[0]) GN_TRY(read_elements(s, mesh, error));
    GN_TRY(gn_origin_choose(s, mesh, error));
    if (s->specimen.file[0] || s->specimen.from[0])
        take_off(s, s->specimen.packed, s->specimen.packed_count, 4);
    take_off(s, mesh->node, mesh->node_count, 3);
    return gn_origin_shift(world, error);
}

/* --- remaining rounding --- */

/* Returns the spacing of doubles at x. */
static double rounding(double x) {
    return nextafter(fabs(x), INFINITY) - fabs(x);
}

static double largest(const double x[3]) {
    return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

/* Finds the largest coordinates of a record of particles or nodes at the start. */
static void reach_of(const gn_particles *particles, double reach[3]) {
    for (size_t a = 0; a < 3; a++) {
        reach[a] = 0.0;
        for (size_t p = 0; p < particles->soa.count; p++)
            reach[a] = fmax(reach[a], fabs(particles->start[4 * p + a]));
    }
}

static gneiss_status too_coarse(const gn_step_context *ctx, gn_scene_place where, const char *what,
                                const double reach[3], const char *of, double length,
                                gneiss_error *error) {
    char at[GN_POINT_SIZE];
    double far = largest(reach);
    if (!(rounding(far) > GN_COARSE * length)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected places with a rounding below %g of %s (%g m), found a rounding of "
                   "%g m, because they are up to %g m away from %s m, the origin of the "
                   "computation (key origin): forces would be lost in it",
                   gn_scene_at(&ctx->scene, where, what).text, GN_COARSE, of, length, rounding(far),
                   far, gn_point_text(ctx->scene.origin, (const double[3]){0, 0, 0}, at));
}

/* Refuses a displacement per step that is too short. Components far below the largest one count as
 * round-off. A constant velocity is rounded in the same way in every step, by up to half the
 * spacing. */
static gneiss_status too_slow(const gn_step_context *ctx, gn_scene_place where, const char *what,
                              const double velocity[3], const double reach[3],
                              gneiss_error *error) {
    char at[GN_POINT_SIZE];
    for (int a = 0; a < 3; a++) {
        double speed = fabs(velocity[a]);
        if (!(speed > 1e-3 * largest(velocity)) || speed * ctx->dt >= 50.0 * rounding(reach[a]))
            continue;
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: expected a velocity with a path per step of at least 50 times the "
            "rounding of places, found %g m/s along %c: %.3g m in %.3g s, and a rounding of "
            "%.3g m, because places are up to %g m away from %s m, the origin of the "
            "computation (key origin): its motion would be lost",
            gn_scene_at(&ctx->scene, where, what).text, speed, "xyz"[a], speed * ctx -> dt,
            ctx -> dt, rounding(reach[a]), fabs(reach[a]),
            gn_point_text(ctx->scene.origin, (const double[3]){0, 0, 0}, at));
    }
    return GNEISS_OK;
}

static void fastest(const gn_table tables[3], double velocity[3]) {
    for (int a = 0; a < 3; a++) {
        velocity[a] = 0.0;
        for (size_t k = 0; k < tables[a].count; k++)
            velocity[a] = fmax(velocity[a], fabs(tables[a].value[k]));
    }
}

gneiss_status gn_origin_check_specimen(const gn_step_context *ctx, const gn_dem *dem,
                                       gneiss_error *error) {
    double reach[3];
    reach_of(&dem->particles, reach);
    return too_coarse(ctx, ctx->scene.specimen.where, "specimen", reach, "the smallest radius",
                      dem->radius_min, error);
}

static gneiss_status check_sets(const gn_step_context *ctx, const gn_dem *dem,
                                gneiss_error *error) {
    char what[GN_NAME_SIZE + 16];
    double reach[3], velocity[3];
    reach_of(&dem->particles, reach);
    for (size_t k = 0; k < ctx->scene.set_count; k++) {
        const gn_set_def *s = &ctx->scene.sets[k];
        snprintf(what, sizeof what, "set '%s'", s->name);
        fastest(s->motion.velocity, velocity);
        GN_TRY(too_slow(ctx, s->where, what, velocity, reach, error));
        if (s->has_initial_velocity && ctx->step == 0)
            GN_TRY(too_slow(ctx, s->where, what, s->initial_velocity, reach, error));
    }
    return GNEISS_OK;
}

static gneiss_status check_walls(const gn_step_context *ctx, const gn_boundary *boundary,
                                 gneiss_error *error) {
    char what[GN_NAME_SIZE + 16];
    double velocity[3];
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        snprintf(what, sizeof what, "wall '%s'", ctx->scene.walls[k].name);
        fastest(ctx->scene.walls[k].motion.velocity, velocity);
        GN_TRY(too_slow(ctx, ctx->scene.walls[k].where, what, velocity, boundary->walls[k].point,
                        error));
    }
    return GNEISS_OK;
}

static gneiss_status check_bodies(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, gneiss_error *error) {
    char what[GN_NAME_SIZE + 80];
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_rigid *b = &boundary->bodies[k];
        double velocity[3];
        snprintf(what, sizeof what, "body '%s': its reference point (key reference)",
                 ctx->scene.bodies[k].name);
        if (ctx->scene.has_specimen)
            GN_TRY(too_coarse(ctx, ctx->scene.bodies[k].where, what, b->position,
                              "the smallest radius", dem->radius_min, error));
        fastest(ctx->scene.bodies[k].motion.velocity, velocity);
        GN_TRY(too_slow(ctx, ctx->scene.bodies[k].where, what, velocity, b->position, error));
        if (ctx->step == 0) /* velocities may be arbitrarily small after the start */
            GN_TRY(
                too_slow(ctx, ctx->scene.bodies[k].where, what, b->velocity, b->position, error));
    }
    return GNEISS_OK;
}

static gneiss_status check_elements(const gn_step_context *ctx, const gn_element_model *model,
                                    gneiss_error *error) {
    const gn_element_def *e = model->def;
    const gn_fem_solid *b = &model->solid;
    char what[GN_NAME_SIZE + 32];
    double reach[3], velocity[3];
    reach_of(&b->nodes, reach);
    GN_TRY(too_coarse(ctx, e->where, "elements", reach, "the least height of an element", b->height,
                      error));
    for (size_t k = 0; k < e->motion_count; k++) {
        snprintf(what, sizeof what, "elements: motion '%s'", e->motions[k].name);
        fastest(e->motions[k].motion.velocity, velocity);
        GN_TRY(too_slow(ctx, e->motions[k].where, what, velocity, reach, error));
    }
    return GNEISS_OK;
}

gneiss_status gn_origin_check(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids,
                              gneiss_error *error) {
    GN_TRY(check_sets(ctx, dem, error));
    for (size_t k = 0; k < solids->count; k++)
        GN_TRY(check_elements(ctx, solids->elements[k], error));
    GN_TRY(check_walls(ctx, boundary, error));
    return check_bodies(ctx, dem, boundary, error);
}
