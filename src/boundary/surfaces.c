/* Contacts of particles with surfaces, evaluated particle by particle. */
#include "boundary/surfaces.h"
#include "base/error.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/contact_rows.h"
#include "boundary/surface.h"
#include "frame/frame.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "surfaces/facet.h"
#include "surfaces/patch.h"

#include <math.h>
#include <string.h>

static const gn_rigid *body_of(const gn_boundary *boundary, const gn_surface *s) {
    return s->body >= 0 ? &boundary->bodies[s->body] : NULL;
}

/* --- contacts --- */

/* The facets of one surface near one particle. */
typedef struct group {
    const gn_step_context *ctx;
    const gn_dem *dem;
    const gn_boundary *boundary;
    const gn_surface *s;
    const gn_rigid *body;
    size_t particle, begin, end;
} group;

static int32_t facet_of(const group *g, size_t row) {
    return g->boundary->contacts.wall[row] - (int32_t)g->ctx->scene.wall_count - g->s->first;
}

static void near_of_row(const group *g, const double centre[3], size_t row, gn_facet_near *near) {
    *near = (gn_facet_near){.row = row};
    gn_facet_set_nearest(&g->s->facets, facet_of(g, row), centre, near);
}

/* Returns the row of a facet that contains the centre of its particle, within rounding; there is no
 * direction in which to push such a particle. SIZE_MAX: none. */
static size_t row_on_facet(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary) {
    const gn_wall_contacts *q = &boundary->contacts;
    size_t found = SIZE_MAX;
#pragma omp parallel for schedule(dynamic, 1024) num_threads(ctx->threads) reduction(min : found)
    for (size_t c = 0; c < q->soa.count; c++) {
        if ((size_t)q->wall[c] < ctx->scene.wall_count) continue;
        const gn_surface *s = gn_surface_of_row(ctx, boundary, c);
        group g = {ctx, dem, boundary, s, body_of(boundary, s), (size_t)q->i[c], c, c + 1};
        gn_facet_near near;
        double centre[3];
        gn_surface_centre(dem, boundary, s, g.particle, centre);
        near_of_row(&g, centre, c, &near);
        bool on = near.distance <= 0x1p-40 * dem->particles.pos[4 * g.particle + 3];
        if (on && c < found) found = c;
    }
    return found;
}

gneiss_status gn_surfaces_check_centres(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, gneiss_error *error) {
    if (!(ctx->effects & GN_FX_FACETS)) return GNEISS_OK;
    size_t row = row_on_facet(ctx, dem, boundary);
    if (row == SIZE_MAX) return GNEISS_OK;
    const gn_surface *s = gn_surface_of_row(ctx, boundary, row);
    const char *name = s->body >= 0 ? ctx->scene.bodies[s->body].name : NULL;
    gneiss_status status = ctx->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT;
    return gn_fail(error, status,
                   "particle %d: centre on the surface of %s%s%s, so that its side cannot be "
                   "determined%s",
                   (int)dem->particles.id[boundary->contacts.i[row]],
                   name ? "body '" : "the elements", name ? name : "", name ? "'" : "",
                   ctx->step > 0 ? " (pressed through? stiffer contacts or slower motion)" : "");
}

static void away_in_space(const group *g, gn_facet_near *near) {
    double world[3], along[3];
    if (!g->body) return;
    gn_rigid_direct(g->body, near->away, world);
    gn_rigid_direct(g->body, near->along, along);
    memcpy(near->away, world, sizeof world);
    memcpy(near->along, along, sizeof along);
}

/* Finds the minima of the distance below `reach`, the nearest first. */
static size_t minima_within(const group *g, double reach, gn_facet_near *minima) {
    double centre[3];
    size_t count = 0;
    gn_surface_centre(g->dem, g->boundary, g->s, g->particle, centre);
    for (size_t c = g->begin; c < g->end; c++) {
        gn_facet_near near;
        near_of_row(g, centre, c, &near);
        if (near.distance < reach) gn_facet_add(minima, &count, &near);
    }
    count = gn_facet_minima(minima, count);
    for (size_t k = 0; k < count; k++) away_in_space(g, &minima[k]);
    return count;
}

/* Finds the facets of a deformable surface that have a part within `radius` of the centre, in the
 * order of the rows. */
static size_t patch_within(const group *g, double radius, bool hertz, gn_facet_near *near,
                           gn_facet_contact *contacts) {
    const gn_facet_set *f = &g->s->facets;
    const double *centre = g->dem->particles.pos + 4 * g->particle;
    gn_patch_facet facet[GN_PATCH_FACETS];
    size_t count = 0;
    for (size_t c = g->begin; c < g->end && count < GN_PATCH_FACETS; c++) {
        const int32_t *corner = f->corner + f->corners * (int64_t)facet_of(g, c);
        const double *x[3] = {0};
        near[count] = (gn_facet_near){.corner = {-1, -1, -1}, .row = c};
        for (int k = 0; k < f->corners; k++) {
            near[count].corner[k] = corner[k];
            x[k] = f->pos + 4 * (int64_t)corner[k];
        }
        count += gn_patch_press(f->corners, x, centre, radius, &near[count], &facet[count]);
    }
    gn_patch_contacts(near, facet, count, hertz, contacts);
    return count;
}

static bool is_patch(const group *g) {
    return gn_surface_patched(g->s, g->dem->particles.pos[4 * g->particle + 3]);
}

/* Finds the closed contacts and their positions. */
static size_t contacts_of(const group *g, gn_facet_near *near, gn_facet_contact *contacts) {
    const double radius = g->dem->particles.pos[4 * g->particle + 3];
    if (is_patch(g)) return patch_within(g, radius, g->ctx->effects & GN_FX_HERTZ, near, contacts);
    const size_t count = minima_within(g, radius, near);
    return gn_facet_contacts(near, count, radius, contacts);
}

/* Computes the velocity of a rigid surface at a point `arm` from the particle's centre. */
static void rigid_velocity(const group *g, const double arm[3], double v[3]) {
    double at[3], turn[3];
    const double *x = g->dem->particles.pos + 4 * g->particle;
    for (int a = 0; a < 3; a++) at[a] = x[a] + arm[a] - g->body->position[a];
    gn_cross3(g->body->spin, at, turn);
    for (int a = 0; a < 3; a++) v[a] = g->body->velocity[a] + turn[a];
}

/* Weight of a vertex in a contact. */
typedef struct vertex_part {
    int32_t vertex;
    double weight;
} vertex_part;

static int vertex_parts(const gn_facet_near *near, vertex_part part[3]) {
    int count = 0;
    for (int c = 0; c < 3; c++)
        if (near->feature >> c & 1) part[count++] = (vertex_part){near->corner[c], near->weight[c]};
    return count;
}

double gn_vertex_inverse_mass(const gn_surface *s, int32_t vertex, const double n[3]) {
    double inverse = s->velocity[4 * (int64_t)vertex + 3];
    int32_t slot = s->slot ? s->slot[vertex] : -1;
    return slot < 0 ? inverse : gn_free_share(s->prescribed->mask[slot], n) * inverse;
}

/* Computes the velocity of the surface at the contact; returns its inverse mass along n. */
static double surface_motion(const group *g, const gn_facet_near *minima, const gn_facet_contact *k,
                             const double arm[3], double v[3]) {
    if (g->body) {
        double lever[3], at[3], inverse = 0.0;
        const double *x = g->dem->particles.pos + 4 * g->particle;
        rigid_velocity(g, arm, v);
        for (int a = 0; a < 3; a++) {
            at[a] = x[a] + arm[a] - g->body->position[a];
            inverse += g->body->inverse_mass[a] * k->n[a] * k->n[a];
        }
        gn_cross3(at, k->n, lever);
        return inverse + gn_rigid_compliance(g->body, lever);
    }
    vertex_part part[3];
    int parts = vertex_parts(&minima[k->member], part);
    double inverse = 0.0;
    v[0] = v[1] = v[2] = 0.0;
    for (int c = 0; c < parts; c++) {
        const double *u = g->s->velocity + 4 * (int64_t)part[c].vertex;
        for (int a = 0; a < 3; a++) v[a] += part[c].weight * u[a];
        inverse +=
            part[c].weight * part[c].weight * gn_vertex_inverse_mass(g->s, part[c].vertex, k->n);
    }
    return inverse;
}

/* Returns the inverse mass, 1/kg, of a particle and the whole body of finite elements in contact
 * with it, for the dashpot: with the mass of single nodes a heavy particle would rebound undamped.
 * 0: neither can move, or the surface is rigid. A prescribed particle counts with its own mass,
 * because the step limit covers no stronger dashpot. */
static double inverse_mass_as_wholes(const group *g, const gn_facet_near *near, const gn_touch *s) {
    if (g->body || !(s->inverse_mass > 0.0)) return 0.0;
    double own = gn_inverse_mass_along(g->dem, g->particle, s->n);
    double whole = g->s->deforming->inverse_mass(g->s, facet_of(g, near->row), near->weight, s->n);
    return fmax(own + whole, g->dem->particles.vel[4 * g->particle + 3]);
}

/* Returns the relative motion at a contact whose normal, overlap and arm are known. */
static gn_touch touch_of(const group *g, const gn_facet_near *minima, const gn_facet_contact *k,
                         const double arm[3]) {
    const gn_particles *q = &g->dem->particles;
    const double *vp = q->vel + 4 * g->particle, *spin = q->spin ? q->spin + 4 * g->particle : NULL;
    gn_touch s = {.gap = k->overlap, .rounding = GN_OVERLAP_ROUNDING * q->pos[4 * g->particle + 3]};
    double v[3], turn[3] = {0, 0, 0};
    memcpy(s.n, k->n, sizeof s.n);
    s.inverse_mass =
        gn_inverse_mass_along(g->dem, g->particle, s.n) + surface_motion(g, minima, k, arm, v);
    if (g->ctx->effects & GN_FX_CONTACT_DAMPING)
        s.body_inverse_mass = inverse_mass_as_wholes(g, &minima[k->member], &s);
    if (spin) {
        gn_cross3(spin, arm, turn);
        s.twist = gn_dot3(spin, s.n);
    }
    if (g->body) s.twist += gn_dot3(g->body->spin, s.n);
    for (int a = 0; a < 3; a++) v[a] -= vp[a] + turn[a];
    s.speed = gn_dot3(v, s.n);
    for (int a = 0; a < 3; a++) s.relative[a] = v[a] - s.speed * s.n[a];
    return s;
}

/* Sets the relative spin at a contact and the moment of the last step, `roll` [3]. */
static void take_roll(const group *g, double *roll, double *couple, gn_touch *s) {
    const double *spin = g->dem->particles.spin + 4 * g->particle;
    for (int a = 0; a < 3; a++) s->spin[a] = (g->body ? g->body->spin[a] : 0.0) - spin[a];
    s->roll = roll;
    s->roll_stride = 1;
    s->couple = couple;
}

/* Returns the fraction of a contact in the mass behind it, such that the dashpots of contacts that
 * share a stiffness add up to one. In a patch the fraction is by load, whatever the sum of their
 * stiffnesses. */
static double mass_share(const group *g, const gn_facet_contact *k) {
    return is_patch(g) ? k->part / (k->crowd * k->crowd) : k->part;
}

/* Evaluates one contact and writes its force and history to its row. */
static void contact(const group *g, gn_wall_contacts *q, const gn_facet_near *minima,
                    const gn_facet_contact *k, const gn_touch_memory *before,
                    gn_contact_sums *sums) {
    size_t stride = q->soa.capacity, own = minima[k->member].row;
    const double *x = g->dem->particles.pos + 4 * g->particle;
    double arm[3], t[3], force[3], fd = before ? before->fd : 0.0;
    double scale =
        g->ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 1.0 : x[3] / sqrt(gn_dot3(k->arm, k->arm));
    for (int a = 0; a < 3; a++) arm[a] = scale * k->arm[a];
    double old[3] = {0, 0, 0}, roll[3] = {0, 0, 0}, couple[3] = {0, 0, 0};
    if (before && q->shear) {
        memcpy(old, before->shear, sizeof old);
        gn_touch_follow(before->n, k->n, old);
    }
    if (before && q->roll) {
        memcpy(roll, before->roll, sizeof roll);
        gn_touch_follow(before->n, k->n, roll);
    }
    gn_touch s = touch_of(g, minima, k, arm);
    /* Contacts that share a stiffness have parts of the stiffness and of the mass, so that their
     * dashpots add up as well. Friction limits the tangential force of each of them. */
    gn_touch_side law = gn_surface_side(g->ctx, g->dem, g->s, g->particle, k->part);
    if (q->closeness) {
        q->closeness[own] = before ? before->closeness : 0.0;
        s.closeness = q->closeness + own;
    }
    s.inverse_mass /= k->part;
    s.body_inverse_mass /= mass_share(g, k);
    if (q->roll) take_roll(g, roll, couple, &s);
    double total = gn_touch_force(g->ctx, g->dem, g->boundary, &law, own, &s, q->fd ? &fd : NULL,
                                  q->shear ? old : NULL, 1, t, sums);
    for (size_t a = 0; a < 3; a++) {
        force[a] = total * s.n[a] + t[a];
        q->row[8 * own + a] = force[a];
        q->touch[own + a * stride] = x[a] + arm[a];
    }
    /* The spring force has no lever arm if it acts along the normal of a single facet, or towards
     * one of many points. */
    gn_cross3(arm, k->part < 1.0 ? force : t, q->row + 8 * own + 4);
    for (int a = 0; a < 3; a++) q->row[8 * own + 4 + (size_t)a] += couple[a];
    for (size_t a = 0; a < 3; a++) {
        q->normal[own + a * stride] = k->part * s.n[a];
        if (q->shear) q->shear[own + a * stride] = old[a];
        if (q->roll) q->roll[own + a * stride] = roll[a];
    }
    if (q->fd) q->fd[own] = fd;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) sums->stress[3 * a + b] += force[a] * arm[b];
}

/* Finds the point of the surface nearest to a particle that has separated from it, in the direction
 * of its former contact; returns false if there is none within half its radius. */
static bool left_behind(const group *g, const gn_touch_memory *m, gn_facet_near *near) {
    gn_facet_near minima[GN_FACET_TOUCHES];
    size_t count = minima_within(g, 1.5 * g->dem->particles.pos[4 * g->particle + 3], minima);
    double best = 0.5;
    for (size_t k = 0; k < count; k++) {
        double cosine = gn_dot3(minima[k].away, m->n) / minima[k].distance;
        if (!(cosine > best)) continue;
        best = cosine;
        *near = minima[k];
    }
    return best > 0.5;
}

/* Completes a contact that opened in this step: its tangential spring and its dashpot end, and the
 * work of the last force beyond the opening is subtracted, as at a wall. A contact that was joined
 * to another one has not opened. */
static void open_contact(const group *g, gn_wall_contacts *q, gn_touch_memory *m,
                         gn_contact_sums *sums) {
    double t[3];
    const double *x = g->dem->particles.pos + 4 * g->particle;
    gn_facet_near near;
    gn_facet_contact k;
    bool behind = left_behind(g, m, &near);
    if (!behind) {
        double centre[3];
        gn_surface_centre(g->dem, g->boundary, g->s, g->particle, centre);
        near_of_row(g, centre, m->row, &near);
        away_in_space(g, &near);
    }
    gn_facet_single(&near, 0, x[3], &k);
    if (!behind) memcpy(k.n, m->n, sizeof k.n);
    gn_touch s = touch_of(g, &near, &k, k.arm);
    if (!behind || s.gap <= 0.0) s.gap = INFINITY;
    gn_touch_side law = gn_surface_side(g->ctx, g->dem, g->s, g->particle, m->part);
    s.closeness = &m->closeness;
    double couple[3];
    if (q->roll) take_roll(g, m->roll, couple, &s); /* the rolling moment ends */
    s.inverse_mass /= m->part;
    s.body_inverse_mass /= is_patch(g) && m->part > 1.0 ? 1.0 / m->part : m->part;
    double total = gn_touch_force(g->ctx, g->dem, g->boundary, &law, m->row, &s,
                                  q->fd ? &m->fd : NULL, q->shear ? m->shear : NULL, 1, t, sums);
    if (total == 0.0) return;
    double *row = q->row + 8 * near.row;
    size_t stride = q->soa.capacity;
    bool used = row[0] != 0.0 || row[1] != 0.0 || row[2] != 0.0;
    for (size_t a = 0; a < 3; a++) {
        row[a] += total * s.n[a];
        if (!used) q->touch[near.row + a * stride] = x[a] + k.arm[a];
        for (size_t b = 0; b < 3; b++) sums->stress[3 * a + b] += total * s.n[a] * k.arm[b];
    }
    /* The dashpot's work is closed in the next step. */
    if (used || m->fd == 0.0) return;
    for (size_t a = 0; a < 3; a++) q->normal[near.row + a * stride] = m->part * s.n[a];
    q->fd[near.row] = m->fd;
}

/* Returns the group that begins with a row and ends at `end` at the latest. */
static group group_at(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      size_t begin, size_t end) {
    const gn_wall_contacts *q = &boundary->contacts;
    const gn_surface *s = gn_surface_of_row(ctx, boundary, begin);
    int32_t last = (int32_t)ctx->scene.wall_count + s->first + (int32_t)s->facets.count;
    size_t past = begin + 1;
    while (past < end && q->i[past] == q->i[begin] && q->wall[past] < last) past++;
    return (group){ctx, dem, boundary, s, body_of(boundary, s), (size_t)q->i[begin], begin, past};
}

/* Finds the contacts of a particle with all facets within reach, each with its part of k; the parts
 * add up to at least k. If there is not enough room, the nearest facets suffice for a bound. */
static size_t patch_near(const group *g, double skin, gn_facet_near *near,
                         gn_facet_contact *contacts) {
    const double radius = g->dem->particles.pos[4 * g->particle + 3];
    double reach = skin, sum = 0.0;
    size_t count = patch_within(g, radius + reach, false, near, contacts);
    for (int k = 0; k < 20 && count == GN_PATCH_FACETS; k++) {
        reach *= 0.5;
        count = patch_within(g, radius + reach, false, near, contacts);
    }
    for (size_t k = 0; k < count; k++) sum += contacts[k].part;
    for (size_t k = 0; k < count; k++) {
        contacts[k].overlap += reach;
        if (sum < 1.0) contacts[k].part /= sum;
    }
    return count;
}

/* Finds the minima of the distance within `skin` of the particle, each as a separate contact. */
static size_t singles_near(const group *g, double skin, gn_facet_near *near,
                           gn_facet_contact *contacts) {
    const double radius = g->dem->particles.pos[4 * g->particle + 3];
    if (is_patch(g)) return patch_near(g, skin, near, contacts);
    const size_t count = minima_within(g, radius + skin, near);
    for (size_t k = 0; k < count; k++) gn_facet_single(near, k, radius, &contacts[k]);
    return count;
}

size_t gn_surface_contacts_at(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, size_t begin, double skin,
                              gn_surface_contact *contacts, size_t *count) {
    group g = group_at(ctx, dem, boundary, begin, boundary->contacts.soa.count);
    gn_facet_near near[GN_SURFACE_CONTACTS];
    gn_facet_contact now[GN_SURFACE_CONTACTS];
    *count = skin > 0.0 ? singles_near(&g, skin, near, now) : contacts_of(&g, near, now);
    for (size_t k = 0; k < *count; k++) {
        vertex_part part[3];
        gn_surface_contact *out = &contacts[k];
        *out = (gn_surface_contact){
            .surface = g.s, .particle = g.particle, .contact = now[k], .patch = is_patch(&g)};
        if (g.body) continue;
        out->parts = vertex_parts(&near[now[k].member], part);
        for (int v = 0; v < out->parts; v++) {
            out->vertex[v] = part[v].vertex;
            out->weight[v] = part[v].weight;
        }
    }
    return g.end;
}

bool gn_surface_contacts_next(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, size_t *row, double skin,
                              gn_surface_contact *contacts, size_t *count) {
    const gn_wall_contacts *q = &boundary->contacts;
    while (*row < q->soa.count && (size_t)q->wall[*row] < ctx->scene.wall_count) (*row)++;
    if (*row == q->soa.count) return false;
    *row = gn_surface_contacts_at(ctx, dem, boundary, *row, skin, contacts, count);
    return true;
}

gneiss_status gn_surfaces_check_patches(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, gneiss_error *error) {
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    size_t row = 0, count;
    while (gn_surface_contacts_next(ctx, dem, boundary, &row, 0.0, found, &count)) {
        if (count < GN_PATCH_FACETS) continue;
        return gn_fail(error, ctx->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT,
                       "particle %d: expected fewer than %d facets of the elements in it at once, "
                       "found more (larger elements, or stiffer contacts)",
                       (int)dem->particles.id[found->particle], GN_PATCH_FACETS);
    }
    return GNEISS_OK;
}

/* Evaluates a patch. Its contacts open and close like others, but their histories pass from facet
 * to facet. */
static void work_on_patch(const group *g, gn_wall_contacts *rows, const gn_facet_near *near,
                          const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                          size_t remembered, gn_contact_sums *sums) {
    gn_touch_memory before[GN_PATCH_FACETS], opened;
    gn_touch_hand_over(now, contacts, old, remembered, before);
    for (size_t k = 0; k < contacts; k++) contact(g, rows, near, &now[k], &before[k], sums);
    while (gn_touch_gather(old, remembered, &opened)) open_contact(g, rows, &opened, sums);
}

size_t gn_surface_contacts_work(const gn_step_context *ctx, const gn_dem *dem,
                                gn_boundary *boundary, size_t begin, size_t end,
                                gn_contact_sums *sums) {
    gn_wall_contacts *rows = &boundary->contacts;
    group g = group_at(ctx, dem, boundary, begin, end);
    gn_touch_memory old[GN_SURFACE_CONTACTS + 1];
    gn_facet_near near[GN_SURFACE_CONTACTS];
    gn_facet_contact now[GN_SURFACE_CONTACTS];
    size_t remembered = gn_touch_recall(rows, begin, g.end, old);
    size_t contacts = contacts_of(&g, near, now);
    if (!remembered && !contacts) return g.end;
    if (is_patch(&g)) {
        work_on_patch(&g, rows, near, now, contacts, old, remembered, sums);
        return g.end;
    }
    int from[GN_FACET_TOUCHES];
    gn_touch_match(now, contacts, old, remembered, from);
    for (size_t k = 0; k < contacts; k++)
        contact(&g, rows, near, &now[k], from[k] >= 0 ? &old[from[k]] : NULL, sums);
    for (size_t m = 0; m < remembered; m++)
        if (!old[m].taken) open_contact(&g, rows, &old[m], sums);
    return g.end;
}

size_t gn_surface_presses(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, size_t begin, size_t end, const double *but,
                          double force[3]) {
    group g = group_at(ctx, dem, boundary, begin, end);
    gn_facet_near near[GN_SURFACE_CONTACTS];
    gn_facet_contact now[GN_SURFACE_CONTACTS];
    const gn_touch_step step = gn_touch_step_of(ctx, dem);
    const size_t count = contacts_of(&g, near, now);
    for (size_t k = 0; k < count; k++) {
        if (but && gn_dot3(but, now[k].n) > cos(GN_FACET_SHARE)) continue;
        gn_touch s = touch_of(&g, near, &now[k], now[k].arm);
        const gn_touch_side law = gn_surface_side(ctx, dem, g.s, g.particle, now[k].part);
        s.inverse_mass /= now[k].part;
        s.body_inverse_mass /= mass_share(&g, &now[k]);
        double total = gn_linear_press(&step, &law, &s);
        for (int a = 0; a < 3; a++) force[a] += total * s.n[a];
    }
    return g.end;
}

/* --- forces on surfaces --- */

static void load_body(gn_rigid *b, const double touch[3], const double force[3]) {
    double lever[3], moment[3];
    for (int a = 0; a < 3; a++) lever[a] = touch[a] - b->position[a];
    gn_cross3(lever, force, moment);
    for (int a = 0; a < 3; a++) {
        b->force[a] -= force[a];
        b->moment[a] -= moment[a];
    }
}

static void load_vertices(gn_surface *s, int32_t facet, const double touch[3],
                          const double force[3]) {
    gn_facet_near near;
    gn_facet_set_nearest(&s->facets, facet, touch, &near);
    for (int c = 0; c < s->facets.corners; c++)
        for (int a = 0; a < 3; a++)
            s->force[4 * (int64_t)near.corner[c] + a] -= near.weight[c] * force[a];
}

void gn_surface_velocity(const gn_step_context *ctx, const gn_boundary *boundary, size_t row,
                         double v[3]) {
    const gn_wall_contacts *q = &boundary->contacts;
    const gn_surface *s = gn_surface_of_row(ctx, boundary, row);
    const gn_rigid *b = body_of(boundary, s);
    double touch[3], lever[3];
    for (size_t a = 0; a < 3; a++) touch[a] = q->touch[row + a * q->soa.capacity];
    if (b) {
        for (int a = 0; a < 3; a++)
            lever[a] = touch[a] - (b->position[a] - ctx->dt_past * b->velocity[a]);
        gn_cross3(b->spin, lever, v);
        for (int a = 0; a < 3; a++) v[a] += b->velocity[a];
        return;
    }
    gn_facet_near near;
    gn_facet_set_nearest(&s->facets, q->wall[row] - (int32_t)ctx->scene.wall_count - s->first,
                         touch, &near);
    v[0] = v[1] = v[2] = 0.0;
    for (int c = 0; c < s->facets.corners; c++)
        for (int a = 0; a < 3; a++)
            v[a] += near.weight[c] * s->velocity[4 * (int64_t)near.corner[c] + a];
}

void gn_surfaces_sum(const gn_step_context *ctx, gn_boundary *boundary) {
    const gn_wall_contacts *q = &boundary->contacts;
    if (!(ctx->effects & GN_FX_FACETS)) return;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        memset(boundary->bodies[k].force, 0, sizeof boundary->bodies[k].force);
        memset(boundary->bodies[k].moment, 0, sizeof boundary->bodies[k].moment);
    }
    for (size_t k = 0; k < boundary->surface_count; k++)
        if (boundary->surfaces[k].force)
            memset(boundary->surfaces[k].force, 0,
                   boundary->surfaces[k].vertices * 4 * sizeof(double));
    for (size_t c = 0; c < q->soa.count; c++) {
        const double *force = q->row + 8 * c;
        int32_t facet = q->wall[c] - (int32_t)ctx->scene.wall_count;
        if (facet < 0 || !(force[0] != 0.0 || force[1] != 0.0 || force[2] != 0.0)) continue;
        gn_surface *s = &boundary->surfaces[gn_surface_of_facet(boundary, facet)];
        double touch[3];
        for (size_t a = 0; a < 3; a++) touch[a] = q->touch[c + a * q->soa.capacity];
        if (s->body < 0) {
            load_vertices(s, facet - s->first, touch, force);
            continue;
        }
        gn_rigid *b = &boundary->bodies[s->body];
        load_body(b, touch, force);
        for (size_t a = 0; q->roll && a < 3; a++) b->moment[a] -= q->roll[c + a * q->soa.capacity];
    }
}

bool gn_surface_yields(const gn_boundary *boundary, const gn_surface *s) {
    if (s->body < 0) return true;
    const gn_rigid *b = &boundary->bodies[s->body];
    double sum = 0.0;
    for (int a = 0; a < 3; a++) sum += b->inverse_mass[a] + b->inverse_inertia[a];
    return sum > 0.0;
}

double gn_surface_give(const gn_boundary *boundary, const gn_surface *s) {
    double most = 0.0, turn = 0.0;
    if (s->body < 0) {
        for (size_t v = 0; v < s->vertices; v++) most = fmax(most, s->velocity[4 * v + 3]);
        return most;
    }
    const gn_rigid *b = &boundary->bodies[s->body];
    for (int a = 0; a < 3; a++) {
        most = fmax(most, b->inverse_mass[a]);
        turn = fmax(turn, b->inverse_inertia[a]);
    }
    return most + b->reach * b->reach * turn;
}
