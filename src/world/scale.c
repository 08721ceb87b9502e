#include "world/scale.h"

#include "base/error.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "particles/specimen.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* m: sizes that are large for a specimen, for one in a laboratory test (a beam may be as long as
 * `large`), and for a tool. Parts of an object count as large from a thousandth of these. */
static const double large = 5.0, large_in_test = 2.0, large_tool = 1.0;
/* Smallest ratio of displacement to size at which a specimen is loaded noticeably; rock breaks at
 * 1e-4 to 1e-2. */
static const double next_to_nothing = 1e-4;
/* kg/m3: densities of materials given in kg and m are above this. */
static const double density_least = 10.0, density_most = 3e4;
/* Number of times that waves cross a body before it is loaded as a whole. */
static const double crossings = 3.0;
/* Largest size of a tool or container over that of its contents. */
static const double size_ratio = 50.0;

/* Sizes in a file: of the whole content, and of its parts (radii, heights of elements). */
typedef struct file_size {
    const char *key;
    gn_scene_place where;
    double longest, part; /* m; part 0: unknown */
} file_size;

static double longest_side(const double *pos, size_t count, bool radii, int dimension) {
    double longest = 0.0;
    for (int a = 0; a < dimension; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < count; k++) {
            const double *x = pos + 4 * k, reach = radii ? x[3] : 0.0;
            low = fmin(low, x[a] - reach);
            high = fmax(high, x[a] + reach);
        }
        if (high > low) longest = fmax(longest, high - low);
    }
    return longest;
}

static double specimen_size(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    return longest_side(q->pos, q->soa.count, true, (int)ctx->scene.dimension);
}

/* Returns the key of the file that a specimen is read from if it states neither scale nor units,
 * else NULL. */
static const char *specimen_key(const gn_step_context *ctx) {
    const gn_specimen *s = &ctx->scene.specimen;
    const char *key = s->file[0]                           ? "specimen.file"
                      : s->pack.shape == GN_SHAPE_SURFACE  ? "specimen.surface"
                      : s->pack.shape == GN_SHAPE_MESH     ? "specimen.mesh"
                      : gn_scene_from_packing(&ctx->scene) ? "specimen.from"
                                                           : NULL;
    return ctx->scene.has_specimen && !s->scale_given && !s->packed_columns.states_units ? key
                                                                                         : NULL;
}

static bool specimen_file(const gn_step_context *ctx, const gn_dem *dem, file_size *file) {
    const char *key = specimen_key(ctx);
    if (!key) return false;
    const gn_specimen *s = &ctx->scene.specimen;
    *file = (file_size){key, s->where, specimen_size(ctx, dem), dem->radius_min};
    return true;
}

static bool element_file(const gn_step_context *ctx, const gn_solids *solids, file_size *file) {
    const gn_element_def *e = &ctx->scene.elements;
    if (!solids->count || !e->mesh[0] || e->scale_given) return false;
    const gn_fem_solid *b = &solids->elements[0]->solid;
    *file = (file_size){"elements.mesh", e->where,
                        longest_side(b->nodes.start, b->nodes.soa.count, false, b->dimension),
                        0.5 * b->height};
    return true;
}

static void fastest(const gn_table velocity[3], double *most) {
    for (int a = 0; a < 3; a++)
        for (size_t k = 0; k < velocity[a].count; k++)
            *most = fmax(*most, fabs(velocity[a].value[k]));
}

static double length_of(const double v[3]) {
    return sqrt(gn_dot3(v, v));
}

/* Returns the largest prescribed speed, m/s; NaN: the model is not driven by speeds. */
static double largest_speed(const gn_scene *scene) {
    double most = scene->random_velocity;
    if (scene->source_count || scene->has_membrane || scene->has_pulse ||
        gn_scene_box_moves(scene) || scene->elements.load_count)
        return NAN;
    for (size_t k = 0; k < scene->set_count; k++) {
        fastest(scene->sets[k].motion.velocity, &most);
        most = fmax(most, length_of(scene->sets[k].initial_velocity));
        if (scene->sets[k].has_force) return NAN;
    }
    for (size_t k = 0; k < scene->wall_count; k++) {
        fastest(scene->walls[k].motion.velocity, &most);
        if (scene->walls[k].servo.active) return NAN;
    }
    for (size_t k = 0; k < scene->body_count; k++) {
        fastest(scene->bodies[k].motion.velocity, &most);
        most = fmax(most, length_of(scene->bodies[k].initial_velocity));
        if (length_of(scene->bodies[k].initial_spin) > 0.0) return NAN;
        for (int a = 0; a < 3; a++)
            if (scene->bodies[k].motion.spin[a].count) return NAN;
    }
    for (size_t k = 0; scene->has_elements && k < scene->elements.motion_count; k++)
        fastest(scene->elements.motions[k].motion.velocity, &most);
    return most;
}

/* Writes the reason why this size is implausible; "": there is none. */
static void reason(const gn_step_context *ctx, const file_size *file, char *text, size_t size) {
    const gn_scene *s = &ctx->scene;
    const double speed = ctx->given.stage_count ? NAN : largest_speed(s),
                 fall = length_of(s->gravity);
    const double way = speed * s->end, steps = s->end / ctx->dt,
                 across = file->part > 0.0 ? file->longest / (2.0 * file->part) : 0.0;
    const bool solid = file->key[0] == 'e' || s->bonds == GN_SWITCH_ON;
    *text = '\0';
    if (gn_scene_tested(s))
        snprintf(text, size, "it is tested as in a laboratory");
    else if (speed > 0.0 && way < next_to_nothing * file->longest)
        snprintf(text, size,
                 "the largest speed of %.3g m/s gives a path of %.2g m, %.1g of that, in the %.3g "
                 "s of the run",
                 speed, way, way / file->longest, s->end);
    else if (solid && !s->has_mass_scaling && steps < crossings * across)
        snprintf(text, size,
                 "the %.3g s of the run are %.2g steps, and a wave needs %.2g to cross it", s->end,
                 steps, across);
    else if (speed == 0.0 && fall > 0.0 && 0.5 * fall * s->end * s->end < 0.01 * file->longest)
        snprintf(text, size, "gravity moves it by no more than %.2g m in the %.3g s of the run",
                 0.5 * fall * s->end * s->end, s->end);
}

static bool is_in_kilograms(const gn_scene *scene) {
    for (size_t k = 0; k < scene->material_count; k++)
        if (!(scene->materials[k].density >= density_least &&
              scene->materials[k].density <= density_most))
            return false;
    for (size_t k = 0; scene->has_elements && k < scene->elements.material_count; k++)
        if (!(scene->elements.materials[k].density >= density_least &&
              scene->elements.materials[k].density <= density_most))
            return false;
    return true;
}

static bool tell(const gn_step_context *ctx, const file_size *file, const char *why, char *text,
                 size_t size) {
    char part[64] = "";
    if (file->part > 0.0)
        snprintf(part, sizeof part,
                 file->key[0] == 'e' ? ", elements down to %.3g m high"
                                     : ", particles from %.3g m in diameter on",
                 2.0 * file->part);
    snprintf(text, size,
             "%s: %.4g m long%s, without a scale, which takes the file's lengths for metres, and "
             "%s; %sscale: 0.001 if they are millimetres, scale: 1 if they are metres",
             gn_scene_at(&ctx->scene, file->where, file->key).text, file->longest, part, why,
             strcmp(file->key, "specimen.from") == 0 ? "pack it with " : "");
    return true;
}

/* Reports a tool or container that is far larger than the objects in contact with it. */
static bool body_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        char *text, size_t size) {
    const double specimen = specimen_size(ctx, dem);
    char key[64], why[120];
    size_t first = 0;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_body_def *def = &ctx->scene.bodies[k];
        const size_t vertices = (size_t)boundary->body_shape[k][0];
        const double longest = longest_side(boundary->body_vertex + 4 * first, vertices, false,
                                            (int)ctx->scene.dimension);
        file_size f = {key, def->where, longest, 0.0};
        first += vertices;
        if (!def->surface[0] || def->scale_given || f.longest < large_tool || !(specimen > 0.0) ||
            ctx->scene.source_count || f.longest < size_ratio * specimen)
            continue;
        snprintf(key, sizeof key, "bodies[%zu].surface", k);
        snprintf(why, sizeof why, "the specimen is %.3g m long", specimen);
        return tell(ctx, &f, why, text, size);
    }
    return false;
}

static bool is_tested(const gn_scene *scene) {
    return gn_scene_tested(scene) && !gn_scene_test(scene)->beam;
}

bool gn_scale_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_solids *solids, char *text, size_t size) {
    file_size f;
    char why[200];
    *text = '\0';
    if (!is_in_kilograms(&ctx->scene)) return false;
    const double least = is_tested(&ctx->scene) ? large_in_test : large;
    for (int k = 0; k < 2; k++) {
        if (!(k ? element_file(ctx, solids, &f) : specimen_file(ctx, dem, &f)) || f.longest < least)
            continue;
        reason(ctx, &f, why, sizeof why);
        if (*why) return tell(ctx, &f, why, text, size);
    }
    return body_doubts(ctx, dem, boundary, text, size);
}

/* Returns the size of a specimen that may not have its particles yet. */
static double size_of_scene(const gn_scene *scene) {
    gn_extent extent = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    double longest = 0.0;
    gn_specimen_extent(scene, &extent);
    for (int a = 0; a < (int)scene->dimension; a++)
        longest = fmax(longest, extent.upper[a] - extent.lower[a]);
    return isfinite(longest) ? longest : 0.0;
}

void gn_scale_explain(const gn_step_context *ctx, const gn_solids *solids, gneiss_error *error) {
    char first[GNEISS_MESSAGE_SIZE];
    file_size f = {0};
    if (!error || !is_in_kilograms(&ctx->scene)) return;
    const char *key = specimen_key(ctx);
    if (key)
        f = (file_size){.key = key, .longest = size_of_scene(&ctx->scene)};
    else if (!element_file(ctx, solids, &f))
        return;
    if (f.longest < (is_tested(&ctx->scene) ? large_in_test : large)) return;
    memcpy(first, error->message, sizeof first);
    gn_fail(error, error->status,
            "%.1500s\n  %s is %.4g m long without a scale: with scale: 0.001 its lengths are "
            "millimetres",
            first, f.key, f.longest);
}
