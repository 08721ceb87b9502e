#include "pack/seeds.h"

#include "base/ball.h"
#include "base/new.h"
#include "base/random.h"
#include "neigh/neigh.h"
#include "pack/sizes.h"
#include "pack/spheres.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* Memory of the fit and its neighbour lists per particle, measured. */
enum { BYTES_PER_PARTICLE = 2000 };

typedef struct source {
    const gn_scene *scene;
    const gn_pack_shape *body;
    int dimension;
    uint64_t drawn; /* number of random numbers used */
    double spread;  /* sigma of the logarithm of the radius */
    double widest;  /* bound of the logarithm of the radius */
    double lower[3], upper[3];
    const gn_mesh_elements *elements; /* elements of a mesh shape; NULL: none */
    double *weight;                   /* [elements->count] running sum of wanted particles */
} source;

/* Returns a number uniformly distributed in [0, 1). */
static double draw(source *generator) {
    return 0.5 * (1.0 + gn_random_symmetric(generator->scene->seed, generator->drawn++));
}

/* Draws a size of the requested distribution, in any unit. */
static double draw_asked(source *generator) {
    const gn_pack_def *def = &generator->scene->specimen.pack;
    const gn_sizes sizes = {def->sizes,       def->size_ratio, def->size_variation,
                            def->sieve_count, def->sieve,      generator->dimension};
    gn_drawn drawn = {generator->scene->seed, generator->drawn};
    double size = gn_sizes_draw(&sizes, &drawn);
    generator->drawn = drawn.count;
    return size;
}

/* Draws the ratio of a radius to the median, log-normal within its bounds. */
static double draw_size(source *generator) {
    if (generator->scene->specimen.pack.sizes != GN_SIZES_FITTED) return draw_asked(generator);
    if (generator->spread <= 0.0) return 1.0;
    for (;;) {
        double u = 1.0 - draw(generator), v = draw(generator);
        double g = generator->spread * sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
        if (fabs(g) <= generator->widest) return exp(g);
    }
}

/* Sets the initial range of sizes: half to three quarters of the requested one on a logarithmic
 * scale, because the fit widens a distribution (small particles in pores stay small). */
static void set_sizes(source *generator) {
    const double widening = 0.7, deviations = 2.2;
    const gn_pack_def *def = &generator->scene->specimen.pack;
    generator->widest = 0.5 * widening * log(def->size_ratio);
    generator->spread = def->size_variation >= 0.0
                            ? sqrt(log(1.0 + def->size_variation * def->size_variation))
                            : generator->widest / deviations;
}

/* ---- random points ---- */

static double corner_size(const source *generator, size_t element) {
    const gn_mesh_elements *e = generator->elements;
    double sum = 0.0;
    for (int a = 0; a < e->nodes; a++)
        sum += generator->body->node_size[e->node[element * e->nodes + a]];
    return sum / e->nodes;
}

static double element_volume(const source *generator, size_t element) {
    const gn_mesh_elements *e = generator->elements;
    double edge[3][3] = {{0}};
    const double *x = generator->body->mesh.node + 3 * e->node[element * e->nodes];
    for (int a = 1; a < e->nodes; a++)
        for (int d = 0; d < 3; d++)
            edge[a - 1][d] =
                generator->body->mesh.node[3 * e->node[element * e->nodes + a] + d] - x[d];
    if (generator->dimension == 2)
        return 0.5 * fabs(edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]);
    double c[3] = {edge[0][1] * edge[1][2] - edge[0][2] * edge[1][1],
                   edge[0][2] * edge[1][0] - edge[0][0] * edge[1][2],
                   edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]};
    return fabs(c[0] * edge[2][0] + c[1] * edge[2][1] + c[2] * edge[2][2]) / 6.0;
}

/* Gives elements equal weights, so that particles are finer where the mesh is. */
static gneiss_status weigh_elements(source *generator, gneiss_error *error) {
    if (generator->scene->specimen.pack.shape != GN_SHAPE_MESH) return GNEISS_OK;
    generator->elements = generator->dimension == 3 ? &generator->body->mesh.tetrahedra
                                                    : &generator->body->mesh.triangles;
    GN_TRY(gn_new(&generator->weight, generator->elements->count, "elements of a mesh", error));
    double sum = 0.0;
    for (size_t k = 0; k < generator->elements->count; k++) {
        sum += element_volume(generator, k) / pow(corner_size(generator, k), generator->dimension);
        generator->weight[k] = sum;
    }
    return GNEISS_OK;
}

/* Draws a point uniformly in an element of the mesh, and returns the size of the mesh there. */
static double draw_in_mesh(source *generator, double x[3]) {
    const gn_mesh_elements *e = generator->elements;
    double at = draw(generator) * generator->weight[e->count - 1], share[4], sum = 0.0, size = 0.0;
    size_t low = 0, high = e->count - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (generator->weight[middle] > at)
            high = middle;
        else
            low = middle + 1;
    }
    for (int a = 0; a < e->nodes; a++) sum += share[a] = -log(1.0 - draw(generator));
    memset(x, 0, 3 * sizeof *x);
    for (int a = 0; a < e->nodes; a++) {
        int32_t node = e->node[low * e->nodes + a];
        for (int d = 0; d < generator->dimension; d++)
            x[d] += share[a] / sum * generator->body->mesh.node[3 * node + d];
        size += share[a] / sum * generator->body->node_size[node];
    }
    return size * gn_pack_shape_size(generator->body, x);
}

/* Draws a point of the body's box with a density that suits the sizes there; 0: it was rejected. */
static double draw_in_box(source *generator, double finest, double x[3]) {
    for (int d = 0; d < generator->dimension; d++)
        x[d] = generator->lower[d] + (generator->upper[d] - generator->lower[d]) * draw(generator);
    if (generator->dimension == 2) x[2] = 0.0;
    if (generator->body->refinement_count == 0) return 1.0;
    double size = gn_pack_shape_size(generator->body, x);
    return draw(generator) < pow(finest / size, generator->dimension) ? size : 0.0;
}

static double finest_size(const gn_pack_shape *body) {
    double size = 1.0;
    for (size_t k = 0; k < body->refinement_count; k++)
        size = fmin(size, body->refinements[k].size);
    return size;
}

static gneiss_status draw_points(source *generator, gn_seeds *seeds, gneiss_error *error) {
    double finest = finest_size(generator->body);
    uint64_t tries = 0, limit = 100000000 + 2000 * (uint64_t)seeds->count;
    for (size_t k = 0; k < seeds->count; tries++) {
        double *row = seeds->row + 4 * k;
        double size = generator->elements ? draw_in_mesh(generator, row)
                                          : draw_in_box(generator, finest, row);
        if (tries > limit)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%zu of %zu particles found a place: the body fills too "
                           "little of its box, or is refined too much",
                           k, seeds->count);
        if (size == 0.0 ||
            (!generator->elements && gn_domain_depth(generator->body->domain, row) <= 0.0))
            continue;
        row[3] = size * draw_size(generator);
        k++;
    }
    return GNEISS_OK;
}

/* ---- nodes of the mesh ---- */

static bool is_inner(const source *generator, const double *x, double size) {
    return size > 0.0 && gn_domain_depth(generator->body->domain, x) > 0.1 * size;
}

static size_t count_inner(const source *generator) {
    size_t count = 0;
    for (size_t k = 0; k < generator->body->mesh.node_count; k++)
        count +=
            is_inner(generator, generator->body->mesh.node + 3 * k, generator->body->node_size[k]);
    return count;
}

static void take_nodes(source *generator, gn_seeds *seeds) {
    double jiggle = 0.5 * generator->scene->specimen.pack.jiggle;
    double *row = seeds->row;
    for (size_t k = 0; k < generator->body->mesh.node_count; k++) {
        const double *x = generator->body->mesh.node + 3 * k;
        double size = generator->body->node_size[k], moved[3] = {x[0], x[1], x[2]};
        if (!is_inner(generator, x, size)) continue;
        for (int d = 0; d < generator->dimension; d++)
            moved[d] += jiggle * size * (2.0 * draw(generator) - 1.0);
        bool stays = gn_domain_depth(generator->body->domain, moved) > 0.0;
        memcpy(row, stays ? moved : x, 3 * sizeof *row);
        if (generator->dimension == 2) row[2] = 0.0;
        row[3] = size * draw_size(generator);
        row += 4;
    }
}

/* ---- number and size ---- */

/* Computes the mean of size^-d over the body, the factor by which refinement increases the number
 * of particles. */
static gneiss_status refinement_factor(const source *generator, double *factor,
                                       gneiss_error *error) {
    enum { POINTS = 20000, TRIES = 20000000 };
    *factor = 1.0;
    if (generator->body->refinement_count == 0 || generator->elements) return GNEISS_OK;
    double sum = 0.0, x[3] = {0};
    int found = 0;
    for (uint64_t k = 0; found < POINTS && k < TRIES; k++) {
        for (int d = 0; d < generator->dimension; d++)
            x[d] = generator->lower[d] +
                   (generator->upper[d] - generator->lower[d]) * 0.5 *
                       (1.0 + gn_random_symmetric(~generator->scene->seed, 3 * k + d));
        if (gn_domain_depth(generator->body->domain, x) <= 0.0) continue;
        sum += pow(gn_pack_shape_size(generator->body, x), -generator->dimension);
        found++;
    }
    if (found == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "the body fills too little of its box to place particles");
    *factor = sum / found;
    return GNEISS_OK;
}

/* Computes the means of r and r^d over radii in units of the median, by the quantiles of the
 * distribution; for a requested distribution, over drawn radii. */
static void size_moments(const source *generator, double *first, double *last) {
    enum { POINTS = 2001, DRAWN = 100000 };
    if (generator->scene->specimen.pack.sizes != GN_SIZES_FITTED) {
        source own = *generator;
        own.drawn = UINT64_C(1) << 62; /* separate from the random numbers of the packing */
        *first = *last = 0.0;
        for (int k = 0; k < DRAWN; k++) {
            double size = draw_asked(&own);
            *first += size / DRAWN;
            *last += pow(size, generator->dimension) / DRAWN;
        }
        return;
    }
    double weight = 0.0, sum1 = 0.0, sum_d = 0.0;
    for (int k = 0; k < POINTS; k++) {
        double g =
            generator->spread > 0.0 ? generator->widest * (2.0 * k / (POINTS - 1.0) - 1.0) : 0.0;
        double p = generator->spread > 0.0
                       ? exp(-0.5 * g * g / (generator->spread * generator->spread))
                       : 1.0;
        weight += p;
        sum1 += p * exp(g);
        sum_d += p * exp(generator->dimension * g);
    }
    *first = sum1 / weight;
    *last = sum_d / weight;
}

/* Tells whether the body is from a file whose lengths may have another unit. */
static bool takes_metres(const gn_scene *scene) {
    const gn_shape_kind shape = scene->specimen.pack.shape;
    return (shape == GN_SHAPE_SURFACE || shape == GN_SHAPE_MESH) && !scene->specimen.scale_given;
}

static gneiss_status choose_count(source *generator, size_t *count, gneiss_error *error) {
    const gn_pack_def *def = &generator->scene->specimen.pack;
    double number = (double)def->count, first, last, factor;
    if (def->start == GN_START_NODES) {
        number = (double)count_inner(generator);
        if (number < 4.0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected a mesh with at least 4 inner nodes to start from, found "
                           "%.0f: refine it, or use packing.start: random",
                           def->mesh_path, number);
    } else if (def->mean_radius > 0.0) {
        size_moments(generator, &first, &last);
        GN_TRY(refinement_factor(generator, &factor, error));
        double median = def->mean_radius / first;
        number = ceil(factor * gn_packed_fraction(generator->dimension) *
                      gn_domain_volume(generator->body->domain) /
                      (gn_ball_volume(generator->dimension, median) * last));
    }
    double have = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    if (number * BYTES_PER_PARTICLE > have || number > 1e9)
        return gn_fail(error, GNEISS_ERROR_MEMORY,
                       "%.4g particles need about %.3g GB to be packed; this machine "
                       "has %.3g GB%s",
                       number, number * BYTES_PER_PARTICLE / 1e9, have / 1e9,
                       takes_metres(generator->scene)
                           ? " (without a scale the lengths of the file count as metres; scale: "
                             "0.001 if they are millimetres)"
                           : "");
    if (number < 4.0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected at least 4 particles in the body, found %.0f: the "
                       "mean radius is too large",
                       number);
    *count = (size_t)number;
    return GNEISS_OK;
}

/* Scales the radii so that the particles have the total volume of a dense packing. */
static void scale_radii(const source *generator, gn_seeds *seeds) {
    double sum = 0.0;
    for (size_t k = 0; k < seeds->count; k++)
        sum += gn_ball_volume(generator->dimension, seeds->row[4 * k + 3]);
    double wanted =
        gn_packed_fraction(generator->dimension) * gn_domain_volume(generator->body->domain);
    double factor = pow(wanted / sum, 1.0 / generator->dimension);
    for (size_t k = 0; k < seeds->count; k++) seeds->row[4 * k + 3] *= factor;
}

static gneiss_status sort_rows(const source *generator, gn_seeds *seeds, gneiss_error *error) {
    gn_particles p = {0};
    GN_FREED int32_t *order = NULL;
    GN_TRY(gn_new(&order, seeds->count, "particles", error));
    gneiss_status status = gn_particles_of_spheres(seeds->row, seeds->count, &p, error);
    if (status == GNEISS_OK) status = gn_morton_order(&p, generator->dimension, order, error);
    for (size_t k = 0; k < seeds->count && status == GNEISS_OK; k++)
        memcpy(seeds->row + 4 * k, p.pos + 4 * order[k], 4 * sizeof(double));
    gn_soa_destroy(&gn_particle_record, &p);
    return status;
}

static gneiss_status make(source *generator, gn_seeds *seeds, gneiss_error *error) {
    GN_TRY(weigh_elements(generator, error));
    GN_TRY(choose_count(generator, &seeds->count, error));
    GN_TRY(gn_new(&seeds->row, 4 * seeds->count, "coordinates of particles", error));
    if (generator->scene->specimen.pack.start == GN_START_NODES)
        take_nodes(generator, seeds);
    else
        GN_TRY(draw_points(generator, seeds, error));
    scale_radii(generator, seeds);
    return sort_rows(generator, seeds, error);
}

gneiss_status gn_seeds_create(const gn_scene *scene, const gn_pack_shape *body, gn_seeds *seeds,
                              gneiss_error *error) {
    *seeds = (gn_seeds){0};
    source s = {.scene = scene, .body = body, .dimension = (int)scene->dimension};
    gn_domain_bounds(body->domain, s.lower, s.upper);
    set_sizes(&s);
    gneiss_status status = make(&s, seeds, error);
    gn_free(s.weight);
    if (status != GNEISS_OK) gn_seeds_free(seeds);
    return status;
}

void gn_seeds_free(gn_seeds *seeds) {
    gn_free(seeds->row);
    *seeds = (gn_seeds){0};
}
