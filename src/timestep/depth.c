#include "timestep/depth.h"

#include "world/internal.h"

#include <math.h>

/* Looks cost a third of a step. */
enum { LOOK_INTERVAL = 50 };

/* m: a smaller overlap is less than what is known. */
static double least(const gn_world *w, double radius) {
    return w->dem.depth.excess * GN_DEPTH_LOOSE * radius;
}

static void note(gn_world *w, double overlap, double radius, size_t p, double second) {
    gn_depth *d = &w->dem.depth;
    const double id = w->dem.particles.id[p];
    bool loose = w->dem.loose[(size_t)id] || (second >= 0.0 && w->dem.loose[(size_t)second]);
    double excess = overlap / radius / (loose ? GN_DEPTH_LOOSE : GN_DEPTH_BONDED);
    if (!(excess > d->excess)) return;
    *d = (gn_depth){excess,
                    overlap / radius,
                    overlap,
                    w->time,
                    second >= 0.0 ? fmin(id, second) : id,
                    second >= 0.0 ? fmax(id, second) : second,
                    d->looked};
}

static void look_at_pairs(gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    const gn_contacts *k = &w->dem.pairs;
    for (size_t c = 0; c < k->soa.count; c++) {
        const size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        const double *a = q->pos + 4 * i, *b = q->pos + 4 * j;
        const double radius = fmin(a[3], b[3]), most = a[3] + b[3] - least(w, radius);
        double d[3], d2 = gn_branch(w, a, b, d);
        if (!(most > 0.0 && d2 < most * most)) continue;
        if (!(gn_inverse_mass_along(w, i, d) + gn_inverse_mass_along(w, j, d) > 0.0)) continue;
        /* Elements stand for their bond as yet: the packing's own overlap, without force. */
        if (q->blend && !(q->blend[2 * i] + q->blend[2 * j] > 0.0)) continue;
        note(w, a[3] + b[3] - sqrt(d2), radius, i, q->id[j]);
    }
}

static size_t look_at_surface(gn_world *w, size_t row) {
    const size_t p = (size_t)w->boundary.contacts.i[row];
    const double radius = w->dem.particles.pos[4 * p + 3];
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    size_t count = 0;
    row = gn_surface_contacts_at(w, row, 0.0, found, &count);
    for (size_t k = 0; k < count; k++) {
        const gn_surface *s = found[k].surface;
        const double overlap = -found[k].contact.overlap;
        if (!(overlap > least(w, radius))) continue;
        if (!(gn_inverse_mass_along(w, p, found[k].contact.n) > 0.0 || gn_surface_yields(w, s)))
            continue;
        note(w, overlap, radius, p,
             -1.0 - (double)w->scene.wall_count - (double)(s - w->boundary.surfaces));
    }
    return row;
}

static void look_at_walls(gn_world *w) {
    const gn_wall_contacts *k = &w->boundary.contacts;
    for (size_t c = 0; w->effects & GN_FX_WALLS && c < k->soa.count;) {
        const size_t wall = (size_t)k->wall[c], p = (size_t)k->i[c];
        if (wall >= w->scene.wall_count) {
            c = look_at_surface(w, c);
            continue;
        }
        const gn_wall *of = &w->boundary.walls[wall];
        const double *x = w->dem.particles.pos + 4 * p;
        const double overlap = x[3] + k->gap0[c] - gn_wall_distance(of, x);
        if (overlap > least(w, x[3]) && gn_inverse_mass_along(w, p, of->normal) > 0.0)
            note(w, overlap, x[3], p, -1.0 - (double)wall);
        c++;
    }
}

gneiss_status gn_depth_look(gn_world *w, gneiss_error *error) {
    GN_TRY(gn_loose_find(w, error));
    look_at_pairs(w);
    look_at_walls(w);
    w->dem.depth.looked = (double)w->step;
    return GNEISS_OK;
}

gneiss_status gn_depth_look_again(gn_world *w, gneiss_error *error) {
    bool due = (double)w->step - w->dem.depth.looked >= LOOK_INTERVAL;
    return due && w->scene.has_specimen ? gn_depth_look(w, error) : GNEISS_OK;
}

const char *gn_depth_text(const gn_world *w, char *text, size_t size) {
    const gn_depth *d = &w->dem.depth;
    const size_t walls = w->scene.wall_count, k = d->second < 0.0 ? (size_t)(-1.0 - d->second) : 0;
    if (d->second >= 0.0)
        snprintf(text, size, "particles %.0f and %.0f", d->first, d->second);
    else if (k < walls)
        snprintf(text, size, "particle %.0f and wall '%.60s'", d->first, w->scene.walls[k].name);
    else if (k - walls < w->scene.body_count)
        snprintf(text, size, "particle %.0f and body '%.60s'", d->first,
                 w->scene.bodies[k - walls].name);
    else
        snprintf(text, size, "particle %.0f and the finite elements", d->first);
    return text;
}
