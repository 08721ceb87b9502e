#include "static/network.h"

#include "base/ball.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "limit/equilibrium.h"
#include "limit/springs.h"
#include "measure/delaunay.h"
#include "scene/scene.h"
#include "world/space.h"

#include <math.h>
#include <string.h>

enum { N = GN_COMPONENTS, SOLUTIONS_MOST = 60, ROUNDING = 2 };

/* Tolerance of each linear solution, as a fraction of its load. The iteration ends when the
 * residual load in double precision, relative to the forces of bonds, is below the second number;
 * above the third one it is an error. */
static const double solved = 1e-4, balanced = 1e-11, balanced_most = 1e-6;

typedef struct network {
    const gn_world *w;
    gn_assembly assembly;
    gn_spectrum spectrum;
    gn_springs y;
    uint8_t *fixed;      /* [particles] components of boundary particles */
    gn_stiff_bond *bond; /* [springs] */
    /* [particles][6]: displacements relative to the strain, loads, solution for the loads,
     * direction of search, and its loads */
    double *u, *load, *solution, *search, *pull;
    gn_preconditioner made;
} network;

static void free_network(network *x) {
    gn_springs_free(&x->y);
    gn_preconditioner_free(&x->made);
    gn_free(x->fixed);
    gn_free(x->bond);
    gn_free(x->u);
    gn_free(x->load);
    gn_free(x->solution);
    gn_free(x->search);
    gn_free(x->pull);
}

/* --- the springs --- */

static gneiss_status allocate(network *x, gneiss_error *error) {
    const size_t n = x->assembly.particles->soa.count;
    double **const array[] = {&x->u, &x->load, &x->solution, &x->search, &x->pull};
    for (int k = 0; k < 5; k++) GN_TRY(gn_new(array[k], N * n + 1, "a network of bonds", error));
    return gn_new(&x->fixed, n + 1, "a network of bonds", error);
}

static gneiss_status build(network *x, gneiss_error *error) {
    const gn_world *w = x->w;
    x->assembly = gn_assembly_of(&w->ctx, &w->dem, &w->boundary);
    x->assembly.wall_contacts = NULL;
    for (int l = 0; l < GN_LISTS_MOST; l++)
        if (x->assembly.list[l] != &w->dem.bonds.contacts) x->assembly.list[l] = NULL;
    GN_TRY(allocate(x, error));
    x->spectrum =
        (gn_spectrum){.assembly = &x->assembly,
                      .arm_factor = w->ctx.scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0,
                      .fixed = x->fixed,
                      .bonds_alone = true,
                      .threads = w->ctx.threads};
    GN_TRY(gn_springs_build(&x->spectrum, NULL, &x->y, error));
    if (!x->y.springs)
        return gn_fail(error, GNEISS_ERROR_INPUT, "stiffness: expected bonds, found none");
    GN_TRY(gn_new(&x->bond, x->y.springs, "a network of bonds", error));
    for (size_t s = 0; s < x->y.springs; s++) {
        const gn_spring *p = &x->y.spring[s];
        gn_stiff_bond *b = &x->bond[s];
        const double *pos = x->assembly.particles->pos;
        gn_branch(&w->ctx, pos + 4 * (size_t)p->i, pos + 4 * (size_t)p->j, b->l);
        memcpy(b->n, p->n, sizeof b->n);
        b->kn = p->kn;
        b->kt = p->kt;
    }
    return GNEISS_OK;
}

/* --- the boundary --- */

static bool is_bonded(const network *x, size_t p) {
    return x->y.first[p] < x->y.first[p + 1];
}

/* Computes the plane of a face of the hull: n.x = offset. Returns false if it has no area. */
static bool plane_of(const double *points, const int32_t *corner, int d, double n[3],
                     double *offset) {
    double u[3] = {0.0}, v[3] = {0.0, 0.0, 1.0};
    const double *o = points + (size_t)corner[0] * (size_t)d;
    for (int a = 0; a < d; a++) {
        u[a] = points[(size_t)corner[1] * (size_t)d + (size_t)a] - o[a];
        if (d == 3) v[a] = points[(size_t)corner[2] * (size_t)d + (size_t)a] - o[a];
    }
    gn_cross3(u, v, n);
    const double size = sqrt(gn_dot3(n, n));
    *offset = 0.0;
    for (int a = 0; a < 3; a++) n[a] = size > 0.0 ? n[a] / size : 0.0;
    for (int a = 0; a < d; a++) *offset += n[a] * o[a];
    return size > 0.0;
}

/* Marks the bonded particles whose centre is within `depth` of a face of the hull. */
static void mark_near(network *x, const gn_triangulation *hull, const double *points, int d,
                      gn_network *found) {
    const double *pos = x->assembly.particles->pos;
    for (size_t f = 0; f < hull->count; f++) {
        double n[3], offset;
        if (!plane_of(points, hull->vertex + f * (size_t)d, d, n, &offset)) continue;
        for (size_t p = 0; p < x->y.particles; p++) {
            const double *c = pos + 4 * p;
            double away = n[0] * c[0] + n[1] * c[1] + (d == 3 ? n[2] * c[2] : 0.0) - offset;
            if (x->fixed[p] || fabs(away) > found->depth || !is_bonded(x, p)) continue;
            x->fixed[p] = 0x7;
            found->boundary++;
        }
    }
}

static gneiss_status mark_boundary(network *x, gn_network *found, gneiss_error *error) {
    const int d = x->assembly.dimension;
    const gn_particles *q = x->assembly.particles;
    gn_triangulation hull = {0};
    size_t count = 0;
    GN_FREED double *points = NULL;
    GN_TRY(gn_new(&points, q->soa.count * (size_t)d + 1, "the hull of the particles", error));
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!is_bonded(x, p)) continue;
        for (int a = 0; a < d; a++)
            points[count * (size_t)d + (size_t)a] = q->pos[4 * p + (size_t)a];
        found->depth = fmax(found->depth, q->pos[4 * p + 3]);
        count++;
    }
    found->depth *= 1.0 + 1e-9; /* equal particles on a plane all belong to the boundary */
    GN_TRY(gn_hull_triangles(points, count, d, &hull, error));
    if (hull.count) mark_near(x, &hull, points, d, found);
    const bool none = !hull.count;
    gn_triangulation_free(&hull);
    if (none)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "stiffness: expected bonded particles that span the space, found all of "
                       "them on a %s",
                       d == 3 ? "plane" : "line");
    return GNEISS_OK;
}

static gneiss_status hold_boundary(network *x, gn_network *found, gneiss_error *error) {
    const int d = x->assembly.dimension;
    int periodic = 0;
    for (int a = 0; a < d; a++) periodic += x->assembly.periodic && x->assembly.period[a] > 0.0;
    if (periodic == d) return GNEISS_OK;
    if (periodic > 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "stiffness: expected a box that is periodic along all axes, or none, found "
                       "%d of %d",
                       periodic, d);
    GN_TRY(mark_boundary(x, found, error));
    /* The springs are rebuilt, because they store which degrees of freedom are fixed. */
    gn_springs_free(&x->y);
    return gn_springs_build(&x->spectrum, NULL, &x->y, error);
}

/* --- equilibrium --- */

/* Computes the force of a spring on its first particle, and the moment by its bending, for a
 * uniform strain of its branch (row < 0: none) plus the displacements u relative to it. */
static void spring_force(const network *x, size_t s, int row, const double *u, double q[3],
                         double m[3]) {
    const gn_spring *p = &x->y.spring[s];
    const double *a = u + N * (size_t)p->i, *b = u + N * (size_t)p->j;
    double e[3] = {0.0}, w[3], turn[3], across[3];
    if (row >= 0) gn_voigt_stretch(x->assembly.dimension, row, x->bond[s].l, e);
    for (int k = 0; k < 3; k++) {
        e[k] += b[k] - a[k];
        w[k] = p->arm_i * a[3 + k] + p->arm_j * b[3 + k];
        turn[k] = b[3 + k] - a[3 + k];
    }
    gn_cross3(w, p->n, across);
    for (int k = 0; k < 3; k++) e[k] -= across[k];
    const double along = (p->kn - p->kt) * gn_dot3(e, p->n),
                 twist = (p->twist - p->bend) * gn_dot3(turn, p->n);
    for (int k = 0; k < 3; k++) {
        q[k] = p->kt * e[k] + along * p->n[k];
        m[k] = p->bend * turn[k] + twist * p->n[k];
    }
}

/* Computes the unbalanced loads of all free components; returns their root mean square, N, and that
 * of the bonds' forces. */
static double unbalanced(const network *x, int row, const double *u, double *load, double *force) {
    const gn_particles *particles = x->assembly.particles;
    double forces = 0.0, loads = 0.0;
    memset(load, 0, N * x->y.particles * sizeof *load);
    for (size_t s = 0; s < x->y.springs; s++) {
        const gn_spring *p = &x->y.spring[s];
        double *i = load + N * (size_t)p->i, *j = load + N * (size_t)p->j, q[3], m[3], c[3];
        spring_force(x, s, row, u, q, m);
        gn_cross3(p->n, q, c);
        for (int k = 0; k < 3; k++) {
            i[k] += q[k];
            j[k] -= q[k];
            i[3 + k] += p->arm_i * c[k] + m[k];
            j[3 + k] += p->arm_j * c[k] - m[k];
        }
        forces += gn_dot3(q, q);
    }
    for (size_t at = 0; at < N * x->y.particles; at++) {
        const size_t p = at / N, k = at % N;
        const bool turns = particles->spin && (x->y.space || k == 5);
        if ((k < 3 && x->fixed[p]) || (k >= 3 && !turns)) load[at] = 0.0;
        const double arm = k < 3 ? 1.0 : particles->pos[4 * p + 3];
        loads += load[at] * load[at] / (arm * arm);
    }
    *force = sqrt(forces / (double)x->y.springs);
    return sqrt(loads / (double)x->y.particles);
}

static double dot(const network *x, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t at = 0; at < N * x->y.particles; at++) sum += a[at] * b[at];
    return sum;
}

/* Solves for the loads, and moves along the solution after it was made conjugate to the last
 * direction. */
static gneiss_status correct(network *x, gn_network *found, gneiss_error *error) {
    gn_equilibrium linear;
    double unused, before = -dot(x, x->search, x->pull);
    GN_TRY(gn_equilibrium_solve(&x->spectrum, (gn_viscosity){0}, x->load, solved, &x->made,
                                x->solution, &linear, error));
    found->solutions++;
    found->iterations += linear.iterations;
    const double part = before > 0.0 ? dot(x, x->solution, x->pull) / before : 0.0;
    for (size_t at = 0; at < N * x->y.particles; at++)
        x->search[at] = x->solution[at] + part * x->search[at];
    (void)unbalanced(x, -1, x->search, x->pull, &unused);
    const double curvature = -dot(x, x->search, x->pull);
    const double step = curvature > 0.0 ? dot(x, x->search, x->load) / curvature : 0.0;
    for (size_t at = 0; at < N * x->y.particles; at++) x->u[at] += step * x->search[at];
    return GNEISS_OK;
}

/* Finds the displacements relative to a uniform strain. Linear solutions are those of a system in
 * single precision with a small resistance to every motion; they precondition conjugate gradients
 * in double precision, which need one or two of them for most packings. */
static gneiss_status relax(network *x, int row, gn_network *found, gneiss_error *error) {
    const size_t bytes = N * x->y.particles * sizeof *x->u;
    double scale, force, left, least = INFINITY;
    memset(x->u, 0, bytes);
    memset(x->search, 0, bytes);
    memset(x->pull, 0, bytes);
    left = unbalanced(x, row, x->u, x->load, &scale);
    for (int k = 0, since = 0; k < SOLUTIONS_MOST && left > balanced * scale; k++) {
        since = left < 0.5 * least ? 0 : since + 1;
        least = fmin(least, left);
        if (since == ROUNDING && least <= balanced_most * scale) break;
        GN_TRY(correct(x, found, error));
        left = unbalanced(x, row, x->u, x->load, &force);
    }
    if (scale > 0.0) found->residual = fmax(found->residual, left / scale);
    if (left <= balanced_most * scale) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "stiffness: expected an equilibrium of the bonds, found loads of %.2g of their "
                   "forces after %d solutions (almost a mechanism)",
                   left / scale, SOLUTIONS_MOST);
}

/* Computes the mean stresses of the present state as a row of the stiffness, by the works of the
 * forces on uniform strains. */
static void add_stresses(const network *x, int row, double volume, double *c) {
    const int n = gn_voigt_size(x->assembly.dimension);
    for (size_t s = 0; s < x->y.springs; s++) {
        double q[3], m[3], e[3];
        spring_force(x, s, row, x->u, q, m);
        for (int a = 0; a < n; a++) {
            gn_voigt_stretch(x->assembly.dimension, a, x->bond[s].l, e);
            /* symmetric except for the remaining residual */
            c[n * row + a] += 0.5 * gn_dot3(q, e) / volume;
            c[n * a + row] += 0.5 * gn_dot3(q, e) / volume;
        }
    }
}

/* --- constants of the network --- */

static void count_particles(const network *x, gn_network *found) {
    const gn_particles *q = x->assembly.particles;
    for (size_t p = 0; p < x->y.particles; p++) {
        if (!is_bonded(x, p)) continue;
        const double r = q->pos[4 * p + 3];
        found->solid += gn_ball_volume(x->assembly.dimension, r);
        found->particles++;
        found->radius_square += r * r;
        found->radius_cube += r * r * r;
    }
    found->radius_square /= (double)found->particles;
    found->radius_cube /= (double)found->particles;
}

static gneiss_status solve(network *x, gn_network *found, gneiss_error *error) {
    const gn_world *w = x->w;
    const int d = (int)w->ctx.scene.dimension;
    GN_TRY(build(x, error));
    count_particles(x, found);
    found->volume = gn_space_volume(&w->ctx, &w->dem, &w->membrane, &w->boundary, &w->solids,
                                    &w->box, &w->approach);
    if (!(found->volume > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "stiffness: expected a specimen with a volume, found %g m3", found->volume);
    found->fabric = gn_bond_fabric_of(d, x->bond, x->y.springs, found->volume);
    found->strained = gn_stiffness_by_strain(d, x->bond, x->y.springs, found->volume);
    found->has_stressed =
        gn_stiffness_by_stress(d, x->bond, x->y.springs, found->volume, &found->stressed);
    GN_TRY(hold_boundary(x, found, error));
    found->network.dimension = d;
    for (int row = 0; row < gn_voigt_size(d); row++) {
        GN_TRY(relax(x, row, found, error));
        add_stresses(x, row, found->volume, found->network.c);
    }
    return GNEISS_OK;
}

gneiss_status gn_network_stiffness(const gn_world *world, gn_network *found, gneiss_error *error) {
    network x = {.w = world};
    *found = (gn_network){0};
    gneiss_status status = solve(&x, found, error);
    free_network(&x);
    return status;
}
