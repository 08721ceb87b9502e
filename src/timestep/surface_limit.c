/* Contribution of surfaces to the stability limit. */
#include "base/eigen.h"
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/body_pairs.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "boundary/contact_rows.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "limit/step_limits.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "scene/sides.h"
#include "soa/records.h"
#include "surfaces/facet.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"

#include <math.h>
#include <string.h>

/* Returns the largest stiffness of a contact before the lists are rebuilt. For a facet of a patch
 * it is that of the facet's part, with the same part of the particle's mass. */
static gn_law_spring law_spring(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_surface_contact *c, double part) {
    gn_touch_side side = gn_surface_side(ctx, dem, c->surface, c->particle, part);
    return gn_touch_spring(ctx, dem, &side, dem->particles.vel[4 * c->particle + 3] / part,
                           gn_touch_reach(ctx, dem, c->particle, fmax(-c->contact.overlap, 0.0)));
}

static gn_extra_spring spring_of(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_surface_contact *c, bool joined) {
    const gn_facet_contact *k = &c->contact;
    gn_law_spring s = law_spring(ctx, dem, c, c->patch ? k->part : 1.0);
    /* The dashpot of a surface that yields is weaker than this. */
    gn_extra_spring e = {.particle = (int32_t)c->particle, .kn = s.kn, .kt = s.kt, .cn = s.cn};
    memcpy(e.n, k->n, sizeof e.n);
    e.arm = ctx->scene.contact_arm == GN_ARM_MIDPOINT ? sqrt(gn_dot3(k->arm, k->arm))
                                                      : dem->particles.pos[4 * c->particle + 3];
    /* Rolling adds k_t r^2/I, which is 2.5 k_t/m of the total 3.5 k_t/m of a tangential spring. */
    if (ctx->effects & GN_FX_ROLLING) e.kt += fmax(e.kt, e.kn);
    if (joined) e.kt += e.kn;
    /* Contacts that share a stiffness resist in every direction in which one of them does. With the
     * normals M the resistance is M f^-1 M^T, whose largest eigenvalue never exceeded the sum of
     * min(1, 2/crowd) over 60 000 random sets of normals of all spreads. */
    if (!c->patch && k->part < 1.0) {
        e.kn *= fmin(1.0, 2.0 / k->crowd);
        e.kt += e.kn;
    }
    return e;
}

gneiss_status gn_surface_springs(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, double reach,
                                 gn_extra_spring **springs, size_t *count, gneiss_error *error) {
    size_t rows = boundary->contacts.soa.count;
    *springs = NULL;
    *count = 0;
    if (!boundary->surface_count) return GNEISS_OK;
    GN_TRY(gn_surfaces_check_centres(ctx, dem, boundary, error));
    GN_TRY(gn_surfaces_check_patches(ctx, dem, boundary, error));
    GN_TRY(gn_new(springs, rows + 1, "springs", error));
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    size_t row = 0, many;
    while (gn_surface_contacts_next(ctx, dem, boundary, &row, reach, found, &many)) {
        /* The facets near a particle may still join into one contact. */
        for (size_t k = 0; k < many; k++)
            (*springs)[(*count)++] = spring_of(
                ctx, dem, &found[k], reach > 0.0 && many > 1 && k == 0 && !found[k].patch);
    }
    return GNEISS_OK;
}

/* --- light bodies --- */

/* Returns the largest stiffness, N/m, by Hertz's law at an overlap of a hundredth of the radius. */
static double hertz_stiffness(const gn_step_context *ctx, const gn_dem *dem) {
    const size_t sides = gn_scene_sides(&ctx->scene);
    const gn_particles *q = &dem->particles;
    double modulus = 0.0, radius = 0.0;
    for (size_t k = 0; k < ctx->scene.material_count * sides; k++)
        modulus = fmax(modulus, dem->hertz[k].modulus);
    for (size_t p = 0; p < q->soa.count; p++) radius = fmax(radius, q->pos[4 * p + 3]);
    return 0.2 * modulus * radius;
}

/* Returns the squared frequency, 1/s2, of a body on its contacts; `hertz`: stiffness of Hertz
 * contacts, which is added to its own. */
static double square_of(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                        double hertz) {
    const gn_surface *s = &boundary->surfaces[body];
    double stiffness = fmax(hertz, ctx->scene.bodies[body].stiffness);
    return gn_surface_yields(boundary, s) ? stiffness * gn_surface_give(boundary, s) : 0.0;
}

/* Returns the squared frequency, 1/s2, of particles on each other and on the stiffest object that
 * they may touch. */
static double particle_square(const gn_step_context *ctx, const gn_dem *dem, double stiffness) {
    const gn_particles *q = &dem->particles;
    bool hertz = ctx->effects & GN_FX_HERTZ;
    double give = 0.0, bound = ctx->choice.limit.bound;
    for (size_t k = 0; k < ctx->scene.body_count && !hertz; k++)
        stiffness = fmax(stiffness, ctx->scene.bodies[k].stiffness);
    for (size_t k = 0; k < ctx->scene.wall_count && !hertz; k++)
        stiffness = fmax(stiffness, ctx->scene.walls[k].stiffness);
    for (size_t p = 0; p < q->soa.count; p++) give = fmax(give, q->vel[4 * p + 3]);
    return fmax(stiffness * give, !hertz && bound > 0.0 ? 4.0 / (bound * bound) : 0.0);
}

const char *gn_timestep_light_body(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, char *text, size_t size) {
    const double far = 1e3;
    double hertz = ctx->effects & GN_FX_HERTZ ? hertz_stiffness(ctx, dem) : 0.0;
    double particles = particle_square(ctx, dem, hertz);
    *text = '\0';
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        double square = square_of(ctx, boundary, k, hertz), others = particles;
        for (size_t m = 0; m < ctx->scene.body_count; m++)
            if (m != k) others = fmax(others, square_of(ctx, boundary, m, hertz));
        if (!(others > 0.0) || !(square > far * far * others)) continue;
        const gn_body_def *def = &ctx->scene.bodies[k];
        char stiff[48] = "";
        if (def->stiffness > 0.0) snprintf(stiff, sizeof stiff, " on %.4g N/m", def->stiffness);
        snprintf(text, size,
                 "body '%.60s' of %.4g kg%s asks, where it touches, for steps %.1g times shorter "
                 "than all else: more mass, or less stiffness, makes the run shorter",
                 def->name, boundary->bodies[k].mass, stiff, sqrt(square / others));
        break;
    }
    return text;
}

/* --- rigid bodies --- */

/* Sums over contacts of B^T k B and of the dashpots, scaled by the masses: 6 x 6. */
typedef struct body_block {
    double stiff[36], damp[36];
} body_block;

/* Adds value row^T row; row . (velocity, spin) is the velocity component of the surface at the
 * contact. */
static void add_row(double *block, const double row[6], double value) {
    for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++) block[6 * p + q] += value * row[p] * row[q];
}

/* Computes the row of a velocity component: the velocity of a point along a direction per unit of
 * each scaled degree of freedom. */
static void scaled_row(const gn_rigid *b, const double at[3], const double direction[3],
                       double row[6]) {
    double lever[3], local[3];
    gn_cross3(at, direction, lever);
    gn_rigid_local(b, lever, local);
    for (int a = 0; a < 3; a++) {
        row[a] = direction[a] * sqrt(b->inverse_mass[a]);
        row[3 + a] = local[a] * sqrt(b->inverse_inertia[a]);
    }
}

/* Adds the rolling resistance: a moment of k_r = k_t r^2 per unit rotation about any axis. */
static void add_rolling(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_surface_contact *c, double k, body_block *block) {
    const gn_rigid *b = &boundary->bodies[c->surface->body];
    double r = dem->particles.pos[4 * c->particle + 3], local[3];
    for (int a = 0; ctx->effects & GN_FX_ROLLING && a < 3; a++) {
        const double unit[3] = {a == 0, a == 1, a == 2};
        double row[6] = {0};
        gn_rigid_local(b, unit, local);
        for (int d = 0; d < 3; d++) row[3 + d] = local[d] * sqrt(b->inverse_inertia[d]);
        add_row(block->stiff, row, k * r * r);
    }
}

static void add_contact(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_surface_contact *c, body_block *block) {
    const gn_rigid *b = &boundary->bodies[c->surface->body];
    const double *x = dem->particles.pos + 4 * c->particle;
    gn_law_spring s = law_spring(ctx, dem, c, 1.0);
    double k = fmax(s.kn, s.kt), at[3], row[6];
    double mass =
        1.0 /
        dem->particles.vel[4 * c->particle + 3]; /* the effective mass of the dashpot is smaller */
    for (int a = 0; a < 3; a++) at[a] = x[a] + c->contact.arm[a] - b->position[a];
    for (int a = 0; a < 3; a++) {
        const double unit[3] = {a == 0, a == 1, a == 2};
        scaled_row(b, at, unit, row);
        add_row(block->stiff, row, k);
    }
    add_rolling(ctx, dem, boundary, c, k, block);
    scaled_row(b, at, c->contact.n, row);
    add_row(block->damp, row,
            2.0 * dem->damping_fraction / gn_nonviscous_share(ctx) * sqrt(s.kn * mass));
}

static double largest(const double block[36]) {
    double a[36], values[6], vectors[36], trace = 0.0;
    memcpy(a, block, sizeof a);
    for (int k = 0; k < 6; k++) trace += a[7 * k];
    if (!(trace > 0.0)) return trace;
    gn_eigen_symmetric(6, a, values, vectors);
    return values[0] + 1e-13 * trace;
}

/* --- bodies on walls --- */

/* Returns the inverse mass, 1/kg, at a contact with a wall along the normal, including that by
 * rotation. */
static double give_along(const gn_rigid *b, const gn_body_wall *c, const double n[3],
                         double *whole) {
    double turn[3];
    *whole = 0.0;
    for (int a = 0; a < 3; a++) *whole += n[a] * n[a] * b->inverse_mass[a];
    gn_cross3(c->lever, n, turn);
    return *whole + gn_rigid_compliance(b, turn);
}

/* Adds the spring of a wall contact along the normal; with `across`, also friction in all
 * directions. */
static void add_wall_contact(const gn_boundary *boundary, const gn_body_wall *c, bool across,
                             body_block *block) {
    const gn_rigid *b = &boundary->bodies[c->body];
    const double *n = boundary->walls[c->wall].normal, kn = c->side.stiffness;
    double kt =
        across && c->side.friction > 0.0 && c->side.kratio > 0.0 ? kn / c->side.kratio : 0.0;
    double row[6], part[3];
    for (int a = 0; kt > 0.0 && a < 3; a++) {
        const double unit[3] = {a == 0, a == 1, a == 2};
        scaled_row(b, c->lever, unit, row);
        add_row(block->stiff, row, kt);
    }
    memcpy(part, n, sizeof part);
    scaled_row(b, c->lever, part, row);
    add_row(block->stiff, row, fmax(kn - kt, 0.0));
}

/* Dashpots of simultaneous contacts with one wall. Each is 2 alpha sqrt(m/k) times its spring, with
 * k of one contact and the mass m of all of them together, 1/m >= `whole`. Their largest eigenvalue
 * is that factor times that of the springs, which is k times the largest inverse mass of one of
 * them. */
typedef struct wall_damping {
    double stiffness, most, whole, fraction;
} wall_damping;

static double damping_of(const gn_step_context *ctx, const wall_damping *d) {
    double alpha = d->fraction / gn_nonviscous_share(ctx);
    double least = d->whole > 0.0 ? d->whole : d->most;
    return least > 0.0 ? 2.0 * alpha * sqrt(d->stiffness / least) * d->most : 0.0;
}

/* Adds the contacts of a body with walls, with all listed vertices closed; returns the rate of
 * their dashpots, 1/s. */
static double add_walls(const gn_step_context *ctx, const gn_boundary *boundary, int32_t body,
                        body_block *block) {
    double damping = 0.0;
    wall_damping d = {0};
    size_t wall = 0;
    for (size_t c = 0; c < boundary->body_contacts.soa.count; c++) {
        gn_body_wall k = gn_body_wall_at(ctx, boundary, c);
        if (k.body != (size_t)body) continue;
        if (k.wall != wall) {
            damping += damping_of(ctx, &d);
            d = (wall_damping){0};
            wall = k.wall;
        }
        const gn_rigid *b = &boundary->bodies[body];
        d.most = fmax(d.most, give_along(b, &k, boundary->walls[wall].normal, &d.whole));
        d.stiffness += k.side.stiffness;
        d.fraction = k.damping;
        add_wall_contact(boundary, &k, true, block);
    }
    return damping + damping_of(ctx, &d);
}

double gn_body_walls_square(const gn_step_context *ctx, const gn_boundary *boundary, size_t *row) {
    body_block block = {0};
    const gn_body_wall first = gn_body_wall_at(ctx, boundary, *row);
    for (; *row < boundary->body_contacts.soa.count; (*row)++) {
        gn_body_wall k = gn_body_wall_at(ctx, boundary, *row);
        if (k.body != first.body || k.wall != first.wall) break;
        add_wall_contact(boundary, &k, false, &block);
    }
    return largest(block.stiff);
}

/* --- one surface --- */

/* Returns the root of 4 tau^2 = a + 2 tau b. */
static double rate_of(double a, double b) {
    return (b + sqrt(b * b + 4.0 * a)) / 4.0;
}

/* Sums over the contacts of one surface. */
typedef struct rate_sums {
    body_block body;
    double walls;         /* 1/s, dashpots at walls and other bodies */
    double pairs;         /* 1/s2, springs of other bodies */
    double *stiff, *damp; /* [vertices]: sums of k weight and c weight; NULL: rigid */
} rate_sums;

static void add(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                const gn_surface_contact *c, rate_sums *sums) {
    if (c->surface->body >= 0) {
        add_contact(ctx, dem, boundary, c, &sums->body);
        return;
    }
    gn_law_spring s = law_spring(ctx, dem, c, 1.0);
    double k = fmax(s.kn, s.kt), damp = s.cn;
    for (int v = 0; v < c->parts; v++) {
        sums->stiff[c->vertex[v]] += k * c->weight[v];
        sums->damp[c->vertex[v]] += damp * c->weight[v];
    }
}

/* Tells whether one of the first `count` facets has a vertex. */
static bool has_vertex(const gn_surface_contact *found, size_t count, int32_t vertex) {
    for (size_t k = 0; k < count; k++)
        for (int v = 0; v < found[k].parts; v++)
            if (found[k].vertex[v] == vertex) return true;
    return false;
}

/* Returns the part of a patch that acts on a vertex: the sum of shape functions times parts over
 * the patch's facets. */
static double part_on(const gn_surface_contact *found, size_t count, int32_t vertex) {
    double sum = 0.0;
    for (size_t k = 0; k < count; k++)
        for (int v = 0; v < found[k].parts; v++)
            if (found[k].vertex[v] == vertex) sum += found[k].contact.part * found[k].weight[v];
    return sum;
}

/* Finds the facet nearest to the particle and its shape functions there. */
static size_t find_nearest(const gn_dem *dem, const gn_surface_contact *found, size_t count,
                           gn_facet_near *nearest) {
    const gn_facet_set *f = &found->surface->facets;
    size_t which = 0;
    nearest->distance = INFINITY;
    for (size_t k = 0; k < count; k++) {
        const double *x[3] = {0};
        gn_facet_near near;
        for (int v = 0; v < f->corners; v++) x[v] = f->pos + 4 * (int64_t)found[k].vertex[v];
        gn_facet_nearest(f->corners, x, dem->particles.pos + 4 * found->particle, &near);
        if (!(near.distance < nearest->distance)) continue;
        *nearest = near;
        which = k;
    }
    return which;
}

/* Adds a patch. It begins at the nearest point; a grown patch has its stiffness at its rim, whose
 * part on a vertex is at most twice the part over the area. */
static void add_patch(const gn_step_context *ctx, const gn_dem *dem,
                      const gn_surface_contact *found, size_t count, rate_sums *sums) {
    const gn_law_spring s = law_spring(ctx, dem, found, 1.0);
    gn_facet_near nearest;
    const gn_surface_contact *first = found + find_nearest(dem, found, count, &nearest);
    for (size_t k = 0; k < count; k++)
        for (int v = 0; v < found[k].parts; v++) {
            const int32_t vertex = found[k].vertex[v];
            if (has_vertex(found, k, vertex)) continue;
            double part = fmin(1.0, 2.0 * part_on(found + k, count - k, vertex));
            for (int c = 0; c < first->parts; c++)
                if (first->vertex[c] == vertex) part = fmax(part, nearest.weight[c]);
            sums->stiff[vertex] += part * fmax(s.kn, s.kt);
            sums->damp[vertex] += part * s.cn;
        }
}

/* Tells whether every component of a vertex is prescribed. */
static bool is_held(const gn_surface *s, size_t vertex) {
    const int32_t slot = s->prescribed->count ? s->slot[vertex] : -1;
    const unsigned all = (1U << s->facets.corners) - 1U;
    return slot >= 0 && (s->prescribed->mask[slot] & all) == all;
}

/* Returns the rate from the sums. For vertices the entries of M^-1 sum k N^T N are not negative, so
 * that row sums bound its eigenvalues; the weights of a contact add up to one. */
static double rate_of_sums(const gn_surface *s, const rate_sums *sums) {
    double most = 0.0;
    if (s->body >= 0)
        return rate_of(largest(sums->body.stiff) + sums->pairs,
                       largest(sums->body.damp) + sums->walls);
    for (size_t v = 0; v < s->vertices; v++) {
        if (is_held(s, v)) continue;
        double inverse = s->velocity[4 * v + 3];
        most = fmax(most, rate_of(sums->stiff[v] * inverse, sums->damp[v] * inverse));
    }
    return most;
}

static gneiss_status surface_rate(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, const gn_surface *s, double *rate,
                                  gneiss_error *error) {
    const int32_t *wall = boundary->contacts.wall;
    int32_t begin = (int32_t)ctx->scene.wall_count + s->first,
            end = begin + (int32_t)s->facets.count;
    rate_sums sums = {0};
    if (s->body < 0) {
        sums.stiff = gn_alloc_array(s->vertices, sizeof(double));
        sums.damp = gn_alloc_array(s->vertices, sizeof(double));
    }
    bool held = s->body >= 0 || (sums.stiff && sums.damp);
    for (size_t c = 0; held && c < boundary->contacts.soa.count;) {
        gn_surface_contact found[GN_SURFACE_CONTACTS];
        size_t many = 0;
        if (wall[c] < begin || wall[c] >= end) {
            c++;
            continue;
        }
        c = gn_surface_contacts_at(ctx, dem, boundary, c, dem->verlet.skin, found, &many);
        if (many && found[0].patch)
            add_patch(ctx, dem, found, many, &sums);
        else
            for (size_t k = 0; k < many; k++) add(ctx, dem, boundary, &found[k], &sums);
    }
    if (s->body >= 0) {
        sums.walls = add_walls(ctx, boundary, s->body, &sums.body);
        gn_body_pairs_rates(ctx, boundary, (size_t)s->body, &sums.pairs, &sums.walls);
    }
    if (held) *rate = fmax(*rate, rate_of_sums(s, &sums));
    gn_free(sums.stiff);
    gn_free(sums.damp);
    return held ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu vertices", s->vertices);
}

/* Finds upper bounds of the rates 1/dt, 1/s, at which free bodies and vertices reach their limit,
 * with all particles near them fixed and in contact; the stiffness of the elements at vertices is
 * not included. */
static gneiss_status find_rates(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, double *bodies, double *vertices,
                                gneiss_error *error) {
    *bodies = *vertices = 0.0;
    for (size_t k = 0; k < boundary->surface_count; k++) {
        const gn_surface *s = &boundary->surfaces[k];
        if (!gn_surface_yields(boundary, s)) continue;
        GN_TRY(surface_rate(ctx, dem, boundary, s, s->body >= 0 ? bodies : vertices, error));
    }
    return GNEISS_OK;
}

static bool are_more(const gn_step_choice *known, double bodies, double vertices) {
    return bodies > 1.02 * known->surface_rate || vertices > 1.02 * known->vertex_rate;
}

gneiss_status gn_timestep_surfaces_yield_more(const gn_step_context *ctx, const gn_dem *dem,
                                              const gn_boundary *boundary, bool *more,
                                              gneiss_error *error) {
    double bodies, vertices;
    GN_TRY(find_rates(ctx, dem, boundary, &bodies, &vertices, error));
    *more = are_more(&ctx->choice, bodies, vertices);
    return GNEISS_OK;
}

gneiss_status gn_timestep_boundary_limit(gn_step_context *ctx, const gn_dem *dem,
                                         gn_boundary *boundary, bool anew, bool *due,
                                         gneiss_error *error) {
    double bodies, vertices;
    GN_TRY(find_rates(ctx, dem, boundary, &bodies, &vertices, error));
    *due = anew || are_more(&ctx->choice, bodies, vertices);
    if (!*due) return GNEISS_OK;
    ctx->choice.surface_rate = bodies;
    ctx->choice.vertex_rate = vertices;
    return GNEISS_OK;
}
