/* Contacts of particles with surfaces, worked on particle by particle. */
#include "base/memory.h"
#include "sim/element_bodies.h"
#include "sim/internal.h"
#include "sim/touch.h"
#include "surfaces/facet.h"

#include <math.h>
#include <string.h>

static const gn_rigid *body_of(const gn_world *w, const gn_surface *s) {
    return s->body >= 0 ? &w->boundary.bodies[s->body] : NULL;
}

/* --- history --- */

/* A contact of the last step. */
typedef struct memory {
    size_t row;
    double n[3], fd, closeness;
    double part;              /* of the stiffness that it had */
    double shear[3], roll[3]; /* where the contacts have them */
    bool taken;
} memory;

/* Rows hold the normal times the part; one of a contact that shared nothing is left as it is. */
static void split_normal(memory *m, double size) {
    m->part = 1.0;
    if (fabs(size - 1.0) < 1e-12) return;
    m->part = size;
    for (int a = 0; a < 3; a++) m->n[a] /= size;
}

static void take_columns(double *column, size_t stride, double out[3]) {
    for (size_t a = 0; a < 3; a++) {
        out[a] = column[a * stride];
        column[a * stride] = 0.0;
    }
}

/* Takes the histories out of the rows and empties them. `old` has room for one more than
 * GN_FACET_TOUCHES, where what is beyond them goes. */
static size_t recall(gn_wall_contacts *q, size_t begin, size_t end, memory *old) {
    size_t count = 0, stride = q->soa.capacity;
    for (size_t c = begin; c < end; c++) {
        memset(q->row + 8 * c, 0, 8 * sizeof *q->row);
        double *n = q->normal + c, x = n[0], y = n[stride], z = n[2 * stride];
        if (x == 0.0 && y == 0.0 && z == 0.0) continue;
        memory *m = &old[count < GN_FACET_TOUCHES ? count++ : GN_FACET_TOUCHES];
        m->row = c;
        m->taken = false;
        take_columns(n, stride, m->n);
        split_normal(m, sqrt(x * x + y * y + z * z));
        if (q->shear) take_columns(q->shear + c, stride, m->shear);
        if (q->roll) take_columns(q->roll + c, stride, m->roll);
        m->fd = q->fd ? q->fd[c] : 0.0;
        if (q->fd) q->fd[c] = 0.0;
        m->closeness = q->closeness ? q->closeness[c] : 0.0;
        if (q->closeness) q->closeness[c] = 0.0;
    }
    return count;
}

/* Which contact of the last step a contact goes on from: the pairs whose normals agree best, one
 * after the other. -1: none within 60 degrees. */
static void match(const gn_facet_contact *now, size_t contacts, memory *old, size_t count,
                  int *from) {
    for (size_t k = 0; k < contacts; k++) from[k] = -1;
    for (;;) {
        double best = 0.5;
        size_t contact = 0;
        int which = -1;
        for (size_t k = 0; k < contacts; k++)
            for (size_t m = 0; from[k] < 0 && m < count; m++) {
                double cosine = gn_dot3(now[k].n, old[m].n);
                if (old[m].taken || !(cosine > best)) continue;
                best = cosine;
                contact = k;
                which = (int)m;
            }
        if (which < 0) return;
        from[contact] = which;
        old[which].taken = true;
    }
}

/* Turns a force with the normal: the shortest rotation from one unit vector to the other. */
static void follow_normal(const double from[3], const double to[3], double force[3]) {
    double axis[3], once[3], twice[3], c = gn_dot3(from, to);
    gn_cross3(from, to, axis);
    gn_cross3(axis, force, once);
    gn_cross3(axis, once, twice);
    for (int a = 0; a < 3; a++) force[a] += once[a] + twice[a] / (1.0 + c);
}

/* --- contacts --- */

/* The facets of one surface and one particle. */
typedef struct group {
    const gn_world *w;
    const gn_surface *s;
    const gn_rigid *body;
    size_t particle, begin, end;
} group;

static int32_t facet_of(const group *g, size_t row) {
    return g->w->boundary.contacts.wall[row] - (int32_t)g->w->scene.wall_count - g->s->first;
}

static void near_of_row(const group *g, const double centre[3], size_t row, gn_facet_near *near) {
    const gn_facet_set *f = &g->s->facets;
    const int32_t *corner = f->corner + f->corners * (int64_t)facet_of(g, row);
    const double *x[3] = {0};
    *near = (gn_facet_near){.corner = {-1, -1, -1}, .row = row};
    for (int k = 0; k < f->corners; k++) {
        near->corner[k] = corner[k];
        x[k] = f->pos + 4 * (int64_t)corner[k];
    }
    gn_facet_nearest(f->corners, x, centre, near);
}

/* Row of a facet on which the centre of its particle lies, to rounding: there is no direction in
 * which to push it. SIZE_MAX: none. */
static size_t row_on_facet(const gn_world *w) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    size_t found = SIZE_MAX;
#pragma omp parallel for schedule(dynamic, 1024) num_threads(w->threads) reduction(min : found)
    for (size_t c = 0; c < q->soa.count; c++) {
        if ((size_t)q->wall[c] < w->scene.wall_count) continue;
        const gn_surface *s = gn_surface_of_row(w, c);
        group g = {w, s, body_of(w, s), (size_t)q->i[c], c, c + 1};
        gn_facet_near near;
        double centre[3];
        gn_surface_centre(w, s, g.particle, centre);
        near_of_row(&g, centre, c, &near);
        bool on = near.distance <= 0x1p-40 * w->dem.particles.pos[4 * g.particle + 3];
        if (on && c < found) found = c;
    }
    return found;
}

gneiss_status gn_surfaces_check_centres(const gn_world *w, gneiss_error *error) {
    if (!(w->effects & GN_FX_FACETS)) return GNEISS_OK;
    size_t row = row_on_facet(w);
    if (row == SIZE_MAX) return GNEISS_OK;
    const gn_surface *s = gn_surface_of_row(w, row);
    const char *name = s->body >= 0 ? w->scene.bodies[s->body].name : NULL;
    gneiss_status status = w->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT;
    return gn_fail(error, status,
                   "particle %d: centre on the surface of %s%s%s: which side it is on cannot be "
                   "told%s",
                   (int)w->dem.particles.id[w->boundary.contacts.i[row]],
                   name ? "body '" : "the elements", name ? name : "", name ? "'" : "",
                   w->step > 0 ? " (pressed through? stiffer contacts or slower motion)" : "");
}

static void away_in_space(const group *g, gn_facet_near *near) {
    double world[3], along[3];
    if (!g->body) return;
    gn_rigid_direct(g->body, near->away, world);
    gn_rigid_direct(g->body, near->along, along);
    memcpy(near->away, world, sizeof world);
    memcpy(near->along, along, sizeof along);
}

/* Minima of the distance that are nearer than `reach`, nearest first. */
static size_t minima_within(const group *g, double reach, gn_facet_near *minima) {
    double centre[3];
    size_t count = 0;
    gn_surface_centre(g->w, g->s, g->particle, centre);
    for (size_t c = g->begin; c < g->end; c++) {
        gn_facet_near near;
        near_of_row(g, centre, c, &near);
        if (near.distance < reach) gn_facet_add(minima, &count, &near);
    }
    count = gn_facet_minima(minima, count);
    for (size_t k = 0; k < count; k++) away_in_space(g, &minima[k]);
    return count;
}

/* Velocity of a rigid surface at a point that lies `arm` from the particle's centre. */
static void rigid_velocity(const group *g, const double arm[3], double v[3]) {
    double at[3], turn[3];
    const double *x = g->w->dem.particles.pos + 4 * g->particle;
    for (int a = 0; a < 3; a++) at[a] = x[a] + arm[a] - g->body->position[a];
    gn_cross3(g->body->spin, at, turn);
    for (int a = 0; a < 3; a++) v[a] = g->body->velocity[a] + turn[a];
}

/* How much of a vertex moves with a contact. */
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

/* Velocity of the surface at the contact and 1/mass with which it gives way along n. */
static double surface_motion(const group *g, const gn_facet_near *minima, const gn_facet_contact *k,
                             const double arm[3], double v[3]) {
    if (g->body) {
        double lever[3], at[3], inverse = 0.0;
        const double *x = g->w->dem.particles.pos + 4 * g->particle;
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

/* 1/kg of a particle and of the body of finite elements that it hits, both as wholes, for the
 * dashpot: single nodes would let a heavy particle rebound undamped. 0: none of them gives way, or
 * the surface is rigid. A particle that is driven counts with its own mass, beyond which the step
 * limit knows of no dashpot. */
static double inverse_mass_as_wholes(const group *g, const gn_facet_near *near, const gn_touch *s) {
    if (g->body || !(s->inverse_mass > 0.0)) return 0.0;
    double own = gn_inverse_mass_along(g->w, g->particle, s->n);
    double whole = gn_element_body_inverse_mass(g->s, facet_of(g, near->row), near->weight, s->n);
    return fmax(own + whole, g->w->dem.particles.vel[4 * g->particle + 3]);
}

/* Relative motion at a contact whose normal, overlap and arm are known. */
static gn_touch touch_of(const group *g, const gn_facet_near *minima, const gn_facet_contact *k,
                         const double arm[3]) {
    const gn_particles *q = &g->w->dem.particles;
    const double *vp = q->vel + 4 * g->particle, *spin = q->spin ? q->spin + 4 * g->particle : NULL;
    gn_touch s = {.gap = k->overlap, .rounding = GN_OVERLAP_ROUNDING * q->pos[4 * g->particle + 3]};
    double v[3], turn[3] = {0, 0, 0};
    memcpy(s.n, k->n, sizeof s.n);
    s.inverse_mass =
        gn_inverse_mass_along(g->w, g->particle, s.n) + surface_motion(g, minima, k, arm, v);
    if (g->w->effects & GN_FX_CONTACT_DAMPING)
        s.whole = inverse_mass_as_wholes(g, &minima[k->member], &s);
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

/* What turns against each other at a contact, and the moment of the last step: `roll` [3]. */
static void take_roll(const group *g, double *roll, double *couple, gn_touch *s) {
    const double *spin = g->w->dem.particles.spin + 4 * g->particle;
    for (int a = 0; a < 3; a++) s->spin[a] = (g->body ? g->body->spin[a] : 0.0) - spin[a];
    s->roll = roll;
    s->roll_stride = 1;
    s->couple = couple;
}

/* One contact: force and history into its row. */
static void contact(const group *g, gn_wall_contacts *q, const gn_facet_near *minima,
                    const gn_facet_contact *k, const memory *before, gn_contact_sums *sums) {
    size_t stride = q->soa.capacity, own = minima[k->member].row;
    const double *x = g->w->dem.particles.pos + 4 * g->particle;
    double arm[3], t[3], force[3], fd = before ? before->fd : 0.0;
    double scale =
        g->w->scene.contact_arm == GN_ARM_MIDPOINT ? 1.0 : x[3] / sqrt(gn_dot3(k->arm, k->arm));
    for (int a = 0; a < 3; a++) arm[a] = scale * k->arm[a];
    double old[3] = {0, 0, 0}, roll[3] = {0, 0, 0}, couple[3] = {0, 0, 0};
    if (before && q->shear) {
        memcpy(old, before->shear, sizeof old);
        follow_normal(before->n, k->n, old);
    }
    if (before && q->roll) {
        memcpy(roll, before->roll, sizeof roll);
        follow_normal(before->n, k->n, roll);
    }
    gn_touch s = touch_of(g, minima, k, arm);
    /* Contacts that share have parts of the stiffness and of the mass behind it, so that their
     * dashpots add up as well. Across, friction bounds what each carries. */
    gn_touch_side law = gn_surface_side(g->w, g->s, g->particle, k->part);
    if (q->closeness) {
        q->closeness[own] = before ? before->closeness : 0.0;
        s.closeness = q->closeness + own;
    }
    s.inverse_mass /= k->part;
    s.whole /= k->part;
    if (q->roll) take_roll(g, roll, couple, &s);
    double total =
        gn_touch_force(g->w, &law, own, &s, q->fd ? &fd : NULL, q->shear ? old : NULL, 1, t, sums);
    for (size_t a = 0; a < 3; a++) {
        force[a] = total * s.n[a] + t[a];
        q->row[8 * own + a] = force[a];
        q->touch[own + a * stride] = x[a] + arm[a];
    }
    /* Along one facet's normal the spring has no lever. */
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

/* Where a particle that let go of the surface is nearest to it now, in the direction of the contact
 * that it had; false: nowhere within half its radius. */
static bool left_behind(const group *g, const memory *m, gn_facet_near *near) {
    gn_facet_near minima[GN_FACET_TOUCHES];
    size_t count = minima_within(g, 1.5 * g->w->dem.particles.pos[4 * g->particle + 3], minima);
    double best = 0.5;
    for (size_t k = 0; k < count; k++) {
        double cosine = gn_dot3(minima[k].away, m->n) / minima[k].distance;
        if (!(cosine > best)) continue;
        best = cosine;
        *near = minima[k];
    }
    return best > 0.5;
}

/* A contact that opened in this step: its spring across and its dashpot let go, and what the last
 * force did beyond the opening is taken back, as at a wall. One that was joined to another is not
 * open. */
static void open_contact(const group *g, gn_wall_contacts *q, memory *m, gn_contact_sums *sums) {
    double t[3];
    const double *x = g->w->dem.particles.pos + 4 * g->particle;
    gn_facet_near near;
    gn_facet_contact k;
    bool behind = left_behind(g, m, &near);
    if (!behind) {
        double centre[3];
        gn_surface_centre(g->w, g->s, g->particle, centre);
        near_of_row(g, centre, m->row, &near);
        away_in_space(g, &near);
    }
    gn_facet_single(&near, 0, x[3], &k);
    if (!behind) memcpy(k.n, m->n, sizeof k.n);
    gn_touch s = touch_of(g, &near, &k, k.arm);
    if (!behind || s.gap <= 0.0) s.gap = INFINITY;
    gn_touch_side law = gn_surface_side(g->w, g->s, g->particle, m->part);
    s.closeness = &m->closeness;
    double couple[3];
    if (q->roll) take_roll(g, m->roll, couple, &s); /* lets go */
    s.inverse_mass /= m->part;
    s.whole /= m->part;
    double total = gn_touch_force(g->w, &law, m->row, &s, q->fd ? &m->fd : NULL,
                                  q->shear ? m->shear : NULL, 1, t, sums);
    if (total == 0.0) return;
    double *row = q->row + 8 * near.row;
    size_t stride = q->soa.capacity;
    bool used = row[0] != 0.0 || row[1] != 0.0 || row[2] != 0.0;
    for (size_t a = 0; a < 3; a++) {
        row[a] += total * s.n[a];
        if (!used) q->touch[near.row + a * stride] = x[a] + k.arm[a];
        for (size_t b = 0; b < 3; b++) sums->stress[3 * a + b] += total * s.n[a] * k.arm[b];
    }
    /* The dashpot's work closes with the next step. */
    if (used || m->fd == 0.0) return;
    for (size_t a = 0; a < 3; a++) q->normal[near.row + a * stride] = m->part * s.n[a];
    q->fd[near.row] = m->fd;
}

/* The group that begins with a row, up to `end`. */
static group group_at(const gn_world *w, size_t begin, size_t end) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    const gn_surface *s = gn_surface_of_row(w, begin);
    int32_t last = (int32_t)w->scene.wall_count + s->first + (int32_t)s->facets.count;
    size_t past = begin + 1;
    while (past < end && q->i[past] == q->i[begin] && q->wall[past] < last) past++;
    return (group){w, s, body_of(w, s), (size_t)q->i[begin], begin, past};
}

size_t gn_surface_contacts_at(const gn_world *w, size_t begin, double skin,
                              gn_surface_contact *contacts, size_t *count) {
    group g = group_at(w, begin, w->boundary.contacts.soa.count);
    gn_facet_near minima[GN_FACET_TOUCHES];
    gn_facet_contact now[GN_FACET_TOUCHES];
    double r = w->dem.particles.pos[4 * g.particle + 3];
    size_t near = minima_within(&g, r + skin, minima);
    *count = skin > 0.0 ? near : gn_facet_contacts(minima, near, r, now);
    for (size_t k = 0; k < *count; k++) {
        vertex_part part[3];
        gn_surface_contact *out = &contacts[k];
        *out = (gn_surface_contact){.surface = g.s, .particle = g.particle};
        if (skin > 0.0) gn_facet_single(minima, k, r, &now[k]);
        out->contact = now[k];
        if (g.body) continue;
        out->parts = vertex_parts(&minima[now[k].member], part);
        for (int v = 0; v < out->parts; v++) {
            out->vertex[v] = part[v].vertex;
            out->weight[v] = part[v].weight;
        }
    }
    return g.end;
}

size_t gn_surface_contacts_work(gn_world *w, size_t begin, size_t end, gn_contact_sums *sums) {
    gn_wall_contacts *rows = &w->boundary.contacts;
    group g = group_at(w, begin, end);
    double r = w->dem.particles.pos[4 * g.particle + 3];
    memory old[GN_FACET_TOUCHES + 1];
    gn_facet_near minima[GN_FACET_TOUCHES];
    size_t remembered = recall(rows, begin, g.end, old);
    size_t count = minima_within(&g, r, minima);
    if (!remembered && !count) return g.end;
    gn_facet_contact now[GN_FACET_TOUCHES];
    int from[GN_FACET_TOUCHES];
    size_t contacts = gn_facet_contacts(minima, count, r, now);
    match(now, contacts, old, remembered, from);
    for (size_t k = 0; k < contacts; k++)
        contact(&g, rows, minima, &now[k], from[k] >= 0 ? &old[from[k]] : NULL, sums);
    for (size_t m = 0; m < remembered; m++)
        if (!old[m].taken) open_contact(&g, rows, &old[m], sums);
    return g.end;
}

size_t gn_surface_presses(const gn_world *w, size_t begin, size_t end, const double *but,
                          double force[3]) {
    group g = group_at(w, begin, end);
    gn_facet_near minima[GN_FACET_TOUCHES];
    gn_facet_contact now[GN_FACET_TOUCHES];
    const gn_touch_step step = gn_touch_step_of(w);
    double r = w->dem.particles.pos[4 * g.particle + 3];
    size_t count = minima_within(&g, r, minima);
    count = gn_facet_contacts(minima, count, r, now);
    for (size_t k = 0; k < count; k++) {
        if (but && gn_dot3(but, now[k].n) > cos(GN_FACET_SHARE)) continue;
        gn_touch s = touch_of(&g, minima, &now[k], now[k].arm);
        const gn_touch_side law = gn_surface_side(w, g.s, g.particle, now[k].part);
        s.inverse_mass /= now[k].part;
        s.whole /= now[k].part;
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
    const int32_t *corner = s->facets.corner + s->facets.corners * (int64_t)facet;
    const double *x[3] = {0};
    gn_facet_near near;
    for (int c = 0; c < s->facets.corners; c++) x[c] = s->facets.pos + 4 * (int64_t)corner[c];
    gn_facet_nearest(s->facets.corners, x, touch, &near);
    for (int c = 0; c < s->facets.corners; c++)
        for (int a = 0; a < 3; a++)
            s->force[4 * (int64_t)corner[c] + a] -= near.weight[c] * force[a];
}

void gn_surface_velocity(const gn_world *w, size_t row, double v[3]) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    const gn_surface *s = gn_surface_of_row(w, row);
    const gn_rigid *b = body_of(w, s);
    double touch[3], lever[3];
    for (size_t a = 0; a < 3; a++) touch[a] = q->touch[row + a * q->soa.capacity];
    if (b) {
        for (int a = 0; a < 3; a++)
            lever[a] = touch[a] - (b->position[a] - w->dt_past * b->velocity[a]);
        gn_cross3(b->spin, lever, v);
        for (int a = 0; a < 3; a++) v[a] += b->velocity[a];
        return;
    }
    int32_t facet = q->wall[row] - (int32_t)w->scene.wall_count - s->first;
    const int32_t *corner = s->facets.corner + s->facets.corners * (int64_t)facet;
    const double *x[3] = {0};
    gn_facet_near near;
    for (int c = 0; c < s->facets.corners; c++) x[c] = s->facets.pos + 4 * (int64_t)corner[c];
    gn_facet_nearest(s->facets.corners, x, touch, &near);
    v[0] = v[1] = v[2] = 0.0;
    for (int c = 0; c < s->facets.corners; c++)
        for (int a = 0; a < 3; a++)
            v[a] += near.weight[c] * s->velocity[4 * (int64_t)corner[c] + a];
}

void gn_surfaces_sum(gn_world *w) {
    const gn_wall_contacts *q = &w->boundary.contacts;
    if (!(w->effects & GN_FX_FACETS)) return;
    for (size_t k = 0; k < w->scene.body_count; k++) {
        memset(w->boundary.bodies[k].force, 0, sizeof w->boundary.bodies[k].force);
        memset(w->boundary.bodies[k].moment, 0, sizeof w->boundary.bodies[k].moment);
    }
    for (size_t k = 0; k < w->boundary.surface_count; k++)
        if (w->boundary.surfaces[k].force)
            memset(w->boundary.surfaces[k].force, 0,
                   w->boundary.surfaces[k].vertices * 4 * sizeof(double));
    for (size_t c = 0; c < q->soa.count; c++) {
        const double *force = q->row + 8 * c;
        int32_t facet = q->wall[c] - (int32_t)w->scene.wall_count;
        if (facet < 0 || !(force[0] != 0.0 || force[1] != 0.0 || force[2] != 0.0)) continue;
        gn_surface *s = &w->boundary.surfaces[gn_surface_of_facet(w, facet)];
        double touch[3];
        for (size_t a = 0; a < 3; a++) touch[a] = q->touch[c + a * q->soa.capacity];
        if (s->body < 0) {
            load_vertices(s, facet - s->first, touch, force);
            continue;
        }
        gn_rigid *b = &w->boundary.bodies[s->body];
        load_body(b, touch, force);
        for (size_t a = 0; q->roll && a < 3; a++) b->moment[a] -= q->roll[c + a * q->soa.capacity];
    }
}
