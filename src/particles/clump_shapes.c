#include "particles/clump_shapes.h"

#include "base/ball.h"
#include "base/eigen.h"
#include "base/new.h"
#include "base/rotation.h"
#include "base/vec3.h"
#include "mesh/mesh.h"
#include "pack/domain.h"
#include "pack/inscribe.h"
#include "surfaces/body_shape.h"
#include "surfaces/sphere_union.h"

#include <math.h>
#include <string.h>

double gn_clump_ball_mass(const gn_scene *scene, const gn_clump_shape *shape, size_t sphere) {
    return scene->materials[shape->material].density *
           gn_ball_volume((int)scene->dimension, shape->sphere[4 * sphere + 3]);
}

double gn_clump_ball_inertia(const gn_scene *scene, const gn_clump_shape *shape, size_t sphere) {
    const double r = shape->sphere[4 * sphere + 3];
    return (scene->dimension == 3 ? 0.4 : 0.5) * gn_clump_ball_mass(scene, shape, sphere) * r * r;
}

/* --- spheres --- */

static gneiss_status too_few(const gn_clump_shape_def *def, size_t found, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected at most %zu spheres, which is what the surface has room for, found "
                   "%lld",
                   found, (long long)def->fill);
}

/* Fills a closed surface, and computes the volume and the moments of the surface. */
static gneiss_status fill_mesh(const gn_clump_shape_def *def, gn_mesh *mesh, gn_clump_shape *shape,
                               gn_sphere_union *body, gneiss_error *error) {
    gn_domain *domain = NULL;
    gn_body_shape solid = {0};
    size_t found = 0;
    GN_TRY(gn_mesh_close_surface(mesh, def->surface, &body->volume, error));
    GN_TRY(gn_domain_surface(mesh, 3, def->surface, &domain, error));
    gneiss_status status = gn_domain_inscribe(domain, shape->count, shape->sphere, &found, error);
    gn_domain_free(domain);
    if (status == GNEISS_OK && found < shape->count) status = too_few(def, found, error);
    if (status == GNEISS_OK) status = gn_body_shape_of_mesh(mesh, &solid, error);
    body->volume = solid.volume;
    memcpy(body->centre, solid.centre, sizeof body->centre);
    memcpy(body->moment, solid.moment, sizeof body->moment);
    gn_body_shape_free(&solid);
    return status;
}

static gneiss_status fill_surface(const gn_clump_shape_def *def, gn_clump_shape *shape,
                                  gn_sphere_union *body, gneiss_error *error) {
    gn_mesh mesh = {0};
    GN_TRY(gn_mesh_read_surface(def->surface_path, def->scale, &mesh, error));
    gneiss_status status = fill_mesh(def, &mesh, shape, body, error);
    gn_mesh_free(&mesh);
    return status;
}

static gneiss_status make_spheres(const gn_scene *scene, const gn_clump_shape_def *def,
                                  gn_clump_shape *shape, gn_sphere_union *body,
                                  gneiss_error *error) {
    shape->count = def->sphere_count ? def->sphere_count : (size_t)def->fill;
    GN_TRY(gn_new(&shape->sphere, 4 * shape->count, "spheres of a clump", error));
    if (*def->surface) return fill_surface(def, shape, body, error);
    for (size_t k = 0; k < 4 * shape->count; k++) shape->sphere[k] = def->scale * def->spheres[k];
    return gn_sphere_union_measure(shape->sphere, shape->count, (int)scene->dimension, body, error);
}

/* --- mass --- */

static void put_in_frame(const gn_sphere_union *body, gn_clump_shape *shape) {
    double axes[9], local[3];
    gn_turn_axes(shape->turn, axes);
    for (size_t k = 0; k < shape->count; k++) {
        double *s = shape->sphere + 4 * k;
        for (int a = 0; a < 3; a++) s[a] -= body->centre[a];
        gn_axes_local(axes, s, local);
        memcpy(s, local, sizeof local);
        shape->reach = fmax(shape->reach, sqrt(gn_dot3(s, s)) + s[3]);
    }
}

/* Adds the quadratic form of a free sphere in the rigid motion (v, w): m |v + w x r|^2 + I |w|^2,
 * with v over the root of the mass and w over the roots of the inertia of the clump. */
static void add_form(const double unit[6], const double r[3], double mass, double inertia,
                     double form[36]) {
    const double arm[9] = {0, r[2], -r[1], -r[2], 0, r[0], r[1], -r[0], 0}; /* w x r = arm w */
    double motion[3][6] = {{0}};
    for (int a = 0; a < 3; a++) {
        motion[a][a] = unit[a];
        for (int b = 0; b < 3; b++) motion[a][3 + b] = arm[3 * a + b] * unit[3 + b];
    }
    for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++)
            for (int a = 0; a < 3; a++) form[6 * p + q] += mass * motion[a][p] * motion[a][q];
    for (int p = 3; p < 6; p++) form[7 * p] += inertia * unit[p] * unit[p];
}

/* Returns the largest factor of the masses of free spheres with which their quadratic form in any
 * rigid motion is at most that of the clump. */
static double share_of(const gn_scene *scene, const gn_clump_shape *shape) {
    double form[36] = {0}, values[6], vectors[36], unit[6];
    for (int a = 0; a < 3; a++) {
        unit[a] = a < (int)scene->dimension ? 1.0 / sqrt(shape->mass) : 0.0;
        unit[3 + a] = shape->inertia[a] > 0.0 ? 1.0 / sqrt(shape->inertia[a]) : 0.0;
    }
    for (size_t k = 0; k < shape->count; k++)
        add_form(unit, shape->sphere + 4 * k, gn_clump_ball_mass(scene, shape, k),
                 gn_clump_ball_inertia(scene, shape, k), form);
    gn_eigen_symmetric(6, form, values, vectors);
    return 1.0 / values[0];
}

gneiss_status gn_clump_shape_make(const gn_scene *scene, size_t index, gn_clump_shape *shape,
                                  gneiss_error *error) {
    const gn_clump_shape_def *def = &scene->clumps.shapes[index];
    gn_sphere_union body = {0};
    *shape = (gn_clump_shape){.material = gn_scene_find_material(scene, def->material)};
    gneiss_status status = make_spheres(scene, def, shape, &body, error);
    if (status != GNEISS_OK) {
        char path[48];
        snprintf(path, sizeof path, "clumps.shapes[%zu]", index);
        gn_fail_context(error, "%s (%s): ", gn_scene_at(scene, def->where, path).text, def->name);
        gn_clump_shape_free(shape);
        return status;
    }
    const double density = scene->materials[shape->material].density;
    shape->mass = density * body.volume;
    gn_principal_axes(body.moment, scene->dimension == 3, shape->inertia, shape->turn);
    for (int a = 0; a < 3; a++) shape->inertia[a] *= density;
    if (scene->dimension == 2) shape->inertia[0] = shape->inertia[1] = 0.0;
    put_in_frame(&body, shape);
    shape->share = share_of(scene, shape);
    return GNEISS_OK;
}

void gn_clump_shape_free(gn_clump_shape *shape) {
    gn_free(shape->sphere);
    *shape = (gn_clump_shape){0};
}
