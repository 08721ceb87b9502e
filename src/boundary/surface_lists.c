/* Surfaces: frames of bodies, facets near particles, and the history of contacts from one step to
 * the next. */
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "surfaces/facet.h"
#include "surfaces/patch.h"

#include <math.h>
#include <string.h>

/* --- frames --- */

void gn_rigid_direct(const gn_rigid *b, const double local[3], double direction[3]) {
    for (int a = 0; a < 3; a++) direction[a] = gn_dot3(b->axes + 3 * a, local);
}

void gn_rigid_place(const gn_rigid *b, const double local[3], double point[3]) {
    gn_rigid_direct(b, local, point);
    for (int a = 0; a < 3; a++) point[a] += b->position[a];
}

void gn_rigid_local(const gn_rigid *b, const double direction[3], double local[3]) {
    for (int a = 0; a < 3; a++)
        local[a] = b->axes[a] * direction[0] + b->axes[3 + a] * direction[1] +
                   b->axes[6 + a] * direction[2];
}

void gn_surface_centre(const gn_dem *dem, const gn_boundary *boundary, const gn_surface *s,
                       size_t p, double centre[3]) {
    const double *x = dem->particles.pos + 4 * p;
    const gn_rigid *b = s->body >= 0 ? &boundary->bodies[s->body] : NULL;
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = b ? x[a] - b->position[a] : x[a];
    if (b)
        gn_rigid_local(b, d, centre);
    else
        memcpy(centre, d, sizeof d);
}

/* --- lists --- */

size_t gn_surfaces_near(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t p, int32_t *found) {
    size_t count = 0;
    if (!gn_particle_is_active(&dem->particles, p)) return 0;
    for (size_t k = 0; k < boundary->surface_count; k++) {
        const gn_surface *s = &boundary->surfaces[k];
        double centre[3], reach = dem->particles.pos[4 * p + 3] + dem->verlet.skin;
        gn_surface_centre(dem, boundary, s, p, centre);
        int32_t *mine = found ? found + count : NULL;
        size_t more = gn_facet_tree_near(&s->tree, &s->facets, centre, reach, mine);
        for (size_t c = 0; mine && c < more; c++)
            mine[c] += (int32_t)ctx->scene.wall_count + s->first;
        count += more;
    }
    return count;
}

void gn_surfaces_refer(gn_boundary *boundary) {
    for (size_t k = 0; k < boundary->surface_count; k++) {
        gn_surface *s = &boundary->surfaces[k];
        if (s->body >= 0) {
            gn_rigid *b = &boundary->bodies[s->body];
            b->travel = 0.0;
            memcpy(b->ref_position, b->position, sizeof b->position);
            memcpy(b->ref_axes, b->axes, sizeof b->axes);
        } else {
            gn_facet_tree_refit(&s->facets, &s->tree);
            s->deforming->refer(s->elements);
        }
    }
}

/* Returns a bound on the path of the vertices of a body: |R X - R' X| <= 2 sin(angle/2) |X|, and
 * the Frobenius norm of R - R' is 2 sqrt(2) sin(angle/2). */
static double body_travel(const gn_rigid *b) {
    double d2 = 0.0, f2 = 0.0;
    for (int a = 0; a < 3; a++)
        d2 += (b->position[a] - b->ref_position[a]) * (b->position[a] - b->ref_position[a]);
    for (int a = 0; a < 9; a++) f2 += (b->axes[a] - b->ref_axes[a]) * (b->axes[a] - b->ref_axes[a]);
    return sqrt(d2) + sqrt(0.5 * f2) * b->reach;
}

double gn_surfaces_travel(gn_boundary *boundary, bool exact) {
    double most = 0.0;
    for (size_t k = 0; k < boundary->surface_count; k++) {
        gn_surface *s = &boundary->surfaces[k];
        gn_rigid *b = s->body >= 0 ? &boundary->bodies[s->body] : NULL;
        if (b && exact) b->travel = body_travel(b);
        most = fmax(most, b ? b->travel : s->deforming->travel(s->elements, exact));
    }
    return most;
}

size_t gn_surface_of_facet(const gn_boundary *boundary, int32_t facet) {
    size_t k = 0;
    while (k + 1 < boundary->surface_count && facet >= boundary->surfaces[k + 1].first) k++;
    return k;
}

const gn_surface *gn_surface_of_row(const gn_step_context *ctx, const gn_boundary *boundary,
                                    size_t row) {
    int32_t facet = boundary->contacts.wall[row] - (int32_t)ctx->scene.wall_count;
    return &boundary->surfaces[gn_surface_of_facet(boundary, facet)];
}

/* Splits the normal of a row, which is multiplied by the part; that of a contact that does not
 * share is unchanged. */
static void split_normal(gn_touch_memory *m, double size) {
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

size_t gn_touch_recall(gn_wall_contacts *rows, size_t begin, size_t end, gn_touch_memory *old) {
    size_t count = 0, stride = rows->soa.capacity;
    for (size_t c = begin; c < end; c++) {
        memset(rows->row + 8 * c, 0, 8 * sizeof *rows->row);
        double *n = rows->normal + c, x = n[0], y = n[stride], z = n[2 * stride];
        if (x == 0.0 && y == 0.0 && z == 0.0) continue;
        gn_touch_memory *m = &old[count < GN_SURFACE_CONTACTS ? count++ : GN_SURFACE_CONTACTS];
        m->row = c;
        m->taken = false;
        take_columns(n, stride, m->n);
        split_normal(m, sqrt(x * x + y * y + z * z));
        if (rows->shear) take_columns(rows->shear + c, stride, m->shear);
        if (rows->roll) take_columns(rows->roll + c, stride, m->roll);
        m->still = !rows->shear && !rows->roll;
        if (!rows->shear) memset(m->shear, 0, sizeof m->shear);
        if (!rows->roll) memset(m->roll, 0, sizeof m->roll);
        m->fd = rows->fd ? rows->fd[c] : 0.0;
        if (rows->fd) rows->fd[c] = 0.0;
        m->closeness = rows->closeness ? rows->closeness[c] : 0.0;
        if (rows->closeness) rows->closeness[c] = 0.0;
    }
    return count;
}

void gn_touch_match(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                    size_t count, int *from) {
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

void gn_touch_follow(const double from[3], const double to[3], double force[3]) {
    double axis[3], once[3], twice[3], c = gn_dot3(from, to);
    gn_cross3(from, to, axis);
    gn_cross3(axis, force, once);
    gn_cross3(axis, once, twice);
    for (int a = 0; a < 3; a++) force[a] += once[a] + twice[a] / (1.0 + c);
}

/* --- pressure over many facets --- */

static void add_part(gn_touch_memory *sum, const gn_touch_memory *m, const double to[3],
                     double share) {
    double shear[3], roll[3];
    sum->fd += share * m->fd;
    if (m->still) return;
    memcpy(shear, m->shear, sizeof shear);
    memcpy(roll, m->roll, sizeof roll);
    gn_touch_follow(m->n, to, shear);
    gn_touch_follow(m->n, to, roll);
    for (int a = 0; a < 3; a++) {
        sum->shear[a] += share * shear[a];
        sum->roll[a] += share * roll[a];
    }
}

/* The history of a contact is distributed among contacts of about its direction in proportion to
 * their loads: on a plane they form one contact together, whatever facets they are on. */
void gn_touch_hand_over(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                        size_t count, gn_touch_memory *before) {
    double load[GN_PATCH_FACETS], weight[GN_PATCH_FACETS];
    for (size_t k = 0; k < contacts; k++) {
        before[k] = (gn_touch_memory){.row = SIZE_MAX};
        memcpy(before[k].n, now[k].n, sizeof before[k].n);
        weight[k] = 0.0;
    }
    for (size_t m = 0; m < count; m++) {
        double sum = 0.0;
        for (size_t k = 0; k < contacts; k++)
            sum += load[k] = gn_patch_share(gn_dot3(now[k].n, old[m].n)) * now[k].part;
        old[m].taken = sum > 0.0;
        for (size_t k = 0; k < contacts && sum > 0.0; k++) {
            const double share = load[k] / sum;
            if (!(share > 0.0)) continue;
            add_part(&before[k], &old[m], now[k].n, share);
            before[k].closeness += share * old[m].part * old[m].closeness;
            weight[k] += share * old[m].part;
        }
    }
    for (size_t k = 0; k < contacts; k++)
        if (weight[k] > 0.0) before[k].closeness /= weight[k];
}

/* Takes the first remaining history and adds all later ones of about the same direction. */
bool gn_touch_gather(gn_touch_memory *old, size_t count, gn_touch_memory *sum) {
    size_t first = 0;
    while (first < count && old[first].taken) first++;
    if (first == count) return false;
    double n[3] = {0.0, 0.0, 0.0};
    *sum = old[first];
    sum->part = sum->fd = 0.0;
    memset(sum->shear, 0, sizeof sum->shear);
    memset(sum->roll, 0, sizeof sum->roll);
    for (size_t m = first; m < count; m++) {
        if (old[m].taken || !(gn_patch_share(gn_dot3(old[m].n, old[first].n)) > 0.0)) continue;
        old[m].taken = true;
        sum->part += old[m].part;
        add_part(sum, &old[m], old[first].n, 1.0);
        for (int a = 0; a < 3; a++) n[a] += old[m].part * old[m].n[a];
    }
    const double size = sqrt(gn_dot3(n, n));
    for (int a = 0; a < 3; a++) n[a] /= size;
    gn_touch_follow(sum->n, n, sum->shear);
    gn_touch_follow(sum->n, n, sum->roll);
    memcpy(sum->n, n, sizeof n);
    return true;
}
