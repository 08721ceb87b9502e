#include "plan/estimate.h"

#include "accuracy/accuracy.h"
#include "base/new.h"
#include "base/sort.h"
#include "particles/particles.h"
#include "scene/stages.h"

#include <math.h>
#include <stdlib.h>

/* --- bonds in uniform strain --- */

/* Returns the direction cosine of a bond with the axis. */
static double direction_cosine(const gn_step_context *ctx, const gn_dem *dem, size_t c,
                               double *length) {
    const gn_contacts *b = &dem->bonds.contacts;
    const double *x = dem->particles.pos + 4 * (size_t)b->i[c],
                 *y = dem->particles.pos + 4 * (size_t)b->j[c];
    double d[3], square = 0.0;
    for (int a = 0; a < 3; a++) {
        d[a] = a < ctx->scene.dimension ? y[a] - x[a] : 0.0;
        square += d[a] * d[a];
    }
    *length = sqrt(square);
    return d[ctx->scene.test.axis] / *length;
}

/* Computes moduli in uniform strain. The elastic energy density with the strain e along the axis
 * and f across it is 1/2 (A e^2 + 2 B e f + D f^2), from k_n with the strain component along each
 * bond and k_t with that across it. If the sides are free of stress, f = -B/D e and E = A - B^2/D.
 */
static void uniform_strain(const gn_step_context *ctx, const gn_dem *dem, gn_estimate *estimate) {
    const gn_contacts *b = &dem->bonds.contacts;
    double A = 0.0, B = 0.0, D = 0.0;
    for (size_t c = 0; c < b->soa.count; c++) {
        double length, n = direction_cosine(ctx, dem, c, &length), square = n * n,
                       rest = 1.0 - square;
        double kn = b->kn[c] * length * length, kt = b->kt ? b->kt[c] * length * length : 0.0;
        A += kn * square * square + kt * square * rest;
        B += (kn - kt) * square * rest;
        D += kn * rest * rest + kt * rest * square;
    }
    estimate->poisson = B / D;
    estimate->uniform_modulus = (A - B * estimate->poisson) / ctx->volume;
}

/* Computes the strains at which bond c reaches its strength in tension and in shear; INFINITY:
 * never. Its normal strain is sign (n^2 - nu (1 - n^2)); its shear follows from the transverse
 * displacement of its ends. */
static void breaking_strains(const gn_step_context *ctx, const gn_dem *dem, size_t c,
                             double poisson, double *tension, double *slip) {
    const gn_contacts *b = &dem->bonds.contacts;
    double sign = gn_scene_test(&ctx->scene)->sign;
    double length, n = direction_cosine(ctx, dem, c, &length), square = n * n, rest = 1.0 - square;
    double normal = sign * (square - poisson * rest);
    double shear = sqrt(fmax(0.0, square + poisson * poisson * rest - normal * normal));
    *tension = normal > 0.0 ? b->rn[c] / (b->kn[c] * length * normal) : INFINITY;
    *slip = INFINITY;
    if (!b->kt || !b->rt || !(b->kt[c] > 0.0)) return;
    /* With pressure the shear strength increases by mu_1 of the intact bond. */
    double gain = b->mu1 ? b->mu1[c] * b->kn[c] * length * normal : 0.0;
    double need = b->kt[c] * length * shear + gain;
    if (need > 0.0) *slip = b->rt[c] / need;
}

/* Returns the strain at failure. A test in tension fails by stretched bonds. A compression test
 * fails by bonds stretched laterally and sheared bonds together, at the geometric mean of both
 * strains, whose ratio is bounded. */
static double combined_breaking_strain(const gn_scene *scene, double tension, double slip) {
    const double most = 4.0;
    if (gn_scene_test(scene)->sign > 0) return fmin(tension, slip);
    return sqrt(fmin(tension, most * slip) * fmin(slip, most * tension));
}

/* Finds the strain at which a twentieth of the bonds has reached its strength in tension or shear.
 */
static gneiss_status find_breaking(const gn_step_context *ctx, const gn_dem *dem,
                                   gn_estimate *estimate, gneiss_error *error) {
    const double share = 0.05;
    const size_t count = dem->bonds.contacts.soa.count;
    GN_FREED double *tension = NULL, *slip = NULL;
    size_t holding = 0;
    GN_TRY(gn_new(&tension, count + 1, "bonds", error));
    GN_TRY(gn_new(&slip, count + 1, "bonds", error));
    for (size_t c = 0; c < count; c++) {
        if (!gn_contact_bonded(&dem->bonds.contacts, c)) continue;
        breaking_strains(ctx, dem, c, estimate->poisson, &tension[holding], &slip[holding]);
        holding++;
    }
    const size_t place = (size_t)(share * (double)holding);
    gn_sort_numbers(tension, holding);
    gn_sort_numbers(slip, holding);
    estimate->breaking_strain = combined_breaking_strain(&ctx->scene, tension[place], slip[place]);
    return GNEISS_OK;
}

/* --- ends --- */

/* Counts the particles that will soon press on a wall: their gap is below a twentieth of their
 * radius. */
static double near_wall(const gn_step_context *ctx, const gn_dem *dem, const gn_wall_def *wall) {
    const double soon = 0.05;
    const gn_particles *q = &dem->particles;
    double count = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        double gap = -q->pos[4 * p + 3];
        for (int a = 0; a < ctx->scene.dimension; a++)
            gap += (q->pos[4 * p + (size_t)a] - wall->point[a]) * wall->normal[a];
        count += gap <= soon * q->pos[4 * p + 3];
    }
    return count;
}

/* Returns the strain between the ends that walls add under a stress of 1 Pa, by particles that
 * press on their springs. */
static double wall_compliance(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_scene *scene = &ctx->scene;
    const gn_test_end *ends[] = {&scene->test.lower, &scene->test.upper};
    double sum = 0.0;
    for (int k = 0; k < 2; k++) {
        double springs = 0.0;
        for (size_t p = 0; p < ends[k]->count; p++) {
            int wall = gn_scene_find_wall(scene, ends[k]->name[p]);
            if (wall >= 0)
                springs += scene->walls[wall].stiffness * near_wall(ctx, dem, &scene->walls[wall]);
        }
        if (springs > 0.0) sum += ctx->test_area / springs / ctx->test_length;
    }
    return sum;
}

/* --- the test --- */

/* Returns the end of the run: at its time, at the strain that stops it, or after the peak. */
static double predicted_end(const gn_step_context *ctx, const gn_estimate *estimate) {
    const gn_scene *scene = &ctx->scene;
    const gn_stops stops = gn_scene_stops(scene);
    double end = estimate->path_strain;
    if (stops.strain > 0.0) end = fmin(end, stops.strain);
    if (stops.peak_drop > 0.0)
        end = fmin(end, estimate->strain * gn_slope_base_of(estimate->study, "end over peak"));
    return end;
}

/* Predicts the peak; with more particles, a test fails at a smaller fraction of the estimate. */
static void predict_peak(const gn_dem *dem, gn_estimate *estimate) {
    double finer =
        (double)dem->particles.soa.count / gn_slope_base_of(estimate->study, "particles");
    double secant = gn_slope_base_of(estimate->study, "strength over modulus and strain");
    estimate->body_strain =
        estimate->breaking_strain *
        gn_slope_base_of(estimate->study, "strain at the peak over breaking strain") *
        pow(finer, gn_slope_base_of(estimate->study, "power of strain over particles"));
    estimate->strength = secant * estimate->modulus * estimate->body_strain;
    estimate->strain = estimate->body_strain + estimate->strength * estimate->predicted_compliance;
    estimate->first_break =
        estimate->strain * gn_slope_base_of(estimate->study, "first break over peak");
}

/* Predicts a test of elements. The loading of a bending test is not related to a strain of its
 * material. */
static void predict_elements(const gn_step_context *ctx, gn_estimate *estimate) {
    estimate->elements = true;
    estimate->body_strain = estimate->strain = estimate->strength = INFINITY;
    estimate->end_strain = estimate->path_strain;
    if (ctx->scene.stop_strain > 0.0)
        estimate->end_strain = fmin(estimate->end_strain, ctx->scene.stop_strain);
}

gneiss_status gn_estimate_make(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, gn_estimate *estimate,
                               gneiss_error *error) {
    const gn_scene *scene = &ctx->scene;
    gn_test_groups groups;
    *estimate = (gn_estimate){.speed = NAN, .across = NAN};
    estimate->absent = gn_study_find_case(ctx, dem, &groups);
    if (estimate->absent) return GNEISS_OK;
    estimate->study = groups.study;
    estimate->closing_velocity = gn_test_fastest(scene);
    estimate->path_strain = gn_test_path(scene, scene->end) / ctx->test_length;
    if (!(estimate->closing_velocity > 0.0) || !(estimate->path_strain > 0.0))
        estimate->absent =
            "the ends of the test do not move in its sense (servos and loads cannot be planned)";
    if (estimate->absent) return GNEISS_OK;
    if (groups.mesh) {
        predict_elements(ctx, estimate);
        return GNEISS_OK;
    }
    estimate->across = groups.across;
    estimate->radius = gn_dem_mean_radius(dem);
    estimate->bulk_density = gn_test_bulk_density(ctx, dem, solids);
    estimate->compliance = wall_compliance(ctx, dem);
    if (estimate->compliance > 0.0)
        estimate->predicted_compliance =
            estimate->compliance *
            gn_slope_base_of("compression", "strain of the ends over that foretold");
    uniform_strain(ctx, dem, estimate);
    estimate->modulus = estimate->uniform_modulus *
                        gn_slope_base_of(estimate->study, "modulus over uniform strain");
    estimate->wave_speed = sqrt(estimate->modulus / estimate->bulk_density);
    GN_TRY(find_breaking(ctx, dem, estimate, error));
    predict_peak(dem, estimate);
    estimate->end_strain = predicted_end(ctx, estimate);
    estimate->speed = estimate->closing_velocity /
                      (estimate->wave_speed * fmin(estimate->strain, estimate->end_strain));
    return GNEISS_OK;
}

/* The end is found by bisection, because the path of the ends increases with time. */
double gn_estimate_end(const gn_step_context *ctx, const gn_estimate *estimate) {
    double low = 0.0, high = ctx->scene.end;
    if (estimate->absent || !isfinite(estimate->end_strain) || !(estimate->end_strain > 0.0))
        return 0.0;
    for (int k = 0; k < 60; k++) {
        const double middle = 0.5 * (low + high);
        if (gn_test_path(&ctx->scene, middle) < estimate->end_strain * ctx->test_length)
            low = middle;
        else
            high = middle;
    }
    return high;
}
