/* The active contacts as springs of the linearised system, and their incidence lists. */
#include "limit/springs.h"

#include "base/memory.h"
#include "base/vec3.h"
#include "kernels/law.h"

#include <math.h>
#include <string.h>

enum { CONTACT_BLOCK = 8192 };

/* --- the springs --- */

static bool removed(const gn_particles *p, int32_t i) {
    return p->vel[4 * (size_t)i + 3] == 0.0;
}

static void nearest_image(const gn_assembly *a, double d[3]) {
    for (int k = 0; a->periodic && k < a->dimension; k++) d[k] = gn_nearest(d[k], a->period[k]);
}

static void take(gn_spring *s, gn_law_spring law) {
    s->kn = law.kn;
    s->kt = law.kt;
    s->cn = law.cn;
}

static bool contact_spring(const gn_spectrum *spectrum, const gn_contacts *list, size_t c,
                           gn_spring *s) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    const int32_t i = list->i[c], j = list->j[c];
    if (removed(p, i) || removed(p, j)) return false;
    const double *x = p->pos + 4 * (size_t)i, *y = p->pos + 4 * (size_t)j;
    double d[3] = {y[0] - x[0], y[1] - x[1], a->dimension == 3 ? y[2] - x[2] : 0.0};
    nearest_image(a, d);
    double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    bool intact = gn_contact_bonded(list, c);
    double rest = list->length0 ? list->length0[c] : x[3] + y[3], most = rest + spectrum->reach;
    /* most contacts need no square root */
    if (!intact && square > 1.000001 * most * most) return false;
    double distance = sqrt(square);
    /* Not (distance >= rest), so that a NaN is an active spring and is detected. */
    if (!intact && distance >= most) return false;
    *s = (gn_spring){.i = i, .j = j};
    double at = intact ? distance : fmin(distance, rest); /* the distance at which it closes */
    double half = spectrum->arm_factor * (at - x[3] - y[3]);
    s->arm_i = x[3] + half;
    s->arm_j = y[3] + half;
    /* Coincident centres have no direction and, as in the kernel, no normal force. */
    for (int k = 0; k < 3; k++) s->n[k] = distance == 0.0 ? 0.0 : d[k] / distance;
    const gn_law *law = gn_law_of(list->soa.effects);
    take(s, law->spring(list, c, rest - at + spectrum->reach));
    if (!law->moments) return true;
    gn_law_moments m = law->moments(list, c, s->n);
    s->bend = m.bend;
    s->twist = m.twist;
    return true;
}

static bool wall_spring(const gn_spectrum *spectrum, const gn_wall_contacts *list, size_t c,
                        gn_spring *s) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    size_t wall = (size_t)list->wall[c];
    if (list->touch && wall >= a->wall_count) return false; /* a facet: see `extra` */
    *s = (gn_spring){.i = list->i[c], .j = -1};
    if (removed(p, s->i)) return false;
    const double *x = p->pos + 4 * (size_t)s->i;
    const double *normal = a->wall_normals + 4 * wall, *point = spectrum->wall_point + 4 * wall;
    double gap = -x[3];
    for (int k = 0; k < a->dimension; k++) {
        s->n[k] = -normal[k];
        gap += normal[k] * (x[k] - point[k]);
    }
    /* A passive contact starts at gap0 and is active. */
    if (gap > list->gap0[c] + spectrum->reach) return false;
    /* The wall is rigid: its contact point is on the plane, or at r as between particles. */
    s->arm_i = x[3] + 2.0 * spectrum->arm_factor * fmin(gap, list->gap0[c]);
    gn_touch_side side = spectrum->wall_side[(size_t)p->material[s->i] * a->wall_count + wall];
    double reach = fmax(list->gap0[c] - gap, 0.0) + spectrum->reach;
    side.radius = x[3];
    if (p->pressed) reach = p->pressed[s->i] * x[3];
    take(s, gn_law_of(list->soa.effects)
                ->touch_spring(&side, p->vel[4 * (size_t)s->i + 3],
                               spectrum->wall_damping ? spectrum->wall_damping[wall] : 0.0, reach));
    double turns = (s->kt > 0.0 ? s->kt : s->kn) * x[3] * x[3];
    if (list->roll && side.rolling > 0.0) s->bend = turns;
    if (list->roll && side.twisting > 0.0) s->twist = turns;
    if (!list->shear) s->kt = 0.0;
    return true;
}

static bool extra_spring(const gn_spectrum *spectrum, size_t k, gn_spring *s) {
    const gn_extra_spring *e = &spectrum->extra[k];
    *s = (gn_spring){
        .i = e->particle, .j = -1, .arm_i = e->arm, .kn = e->kn, .kt = e->kt, .cn = e->cn};
    memcpy(s->n, e->n, sizeof s->n);
    return !removed(spectrum->assembly->particles, s->i);
}

static size_t wall_contact_count(const gn_assembly *a) {
    return a->wall_contacts ? a->wall_contacts->soa.count : 0;
}

static size_t list_count(const gn_contacts *list) {
    return list ? list->soa.count : 0;
}

static bool make(const gn_spectrum *spectrum, size_t k, gn_spring *s) {
    const gn_assembly *a = spectrum->assembly;
    if (k < list_count(a->bonds)) return contact_spring(spectrum, a->bonds, k, s);
    k -= list_count(a->bonds);
    if (k < list_count(a->pairs)) return contact_spring(spectrum, a->pairs, k, s);
    k -= list_count(a->pairs);
    if (k < wall_contact_count(a)) return wall_spring(spectrum, a->wall_contacts, k, s);
    return extra_spring(spectrum, k - wall_contact_count(a), s);
}

bool gn_spring_make(const gn_spectrum *spectrum, size_t k, gn_spring *s) {
    if (!make(spectrum, k, s)) return false;
    if (spectrum->slips && k < gn_spring_count(spectrum) - spectrum->extra_count &&
        spectrum->slips[k])
        s->kt = 0.0;
    if (spectrum->dashpots > 0.0) s->cn *= spectrum->dashpots;
    return true;
}

size_t gn_spring_pairs(const gn_spectrum *spectrum) {
    return list_count(spectrum->assembly->bonds) + list_count(spectrum->assembly->pairs);
}

size_t gn_spring_count(const gn_spectrum *spectrum) {
    return gn_spring_pairs(spectrum) + wall_contact_count(spectrum->assembly) +
           spectrum->extra_count;
}

void gn_spring_ends(const gn_spectrum *spectrum, size_t k, int32_t *i, int32_t *j) {
    const gn_assembly *a = spectrum->assembly;
    size_t bonds = list_count(a->bonds);
    *i = k < bonds ? a->bonds->i[k] : a->pairs->i[k - bonds];
    *j = k < bonds ? a->bonds->j[k] : a->pairs->j[k - bonds];
}

/* Converts to places among the members; returns false for a spring between particles outside. */
static bool take_inside(const gn_springs *y, gn_spring *s) {
    if (!y->local) return true;
    int32_t i = y->local[s->i], j = s->j < 0 ? -1 : y->local[s->j];
    if (i < 0 && j < 0) return false;
    bool leads_out = s->j >= 0 && (i < 0 || j < 0);
    double factor = 1.0;
    int32_t in = i < 0 ? s->j : s->i, out = i < 0 ? s->i : s->j;
    if (leads_out && gn_spectrum_can_move(y->spectrum, out))
        factor = y->all_weights ? 1.0 + y->all_weights[out] / y->all_weights[in] : 2.0;
    if (i < 0) { /* seen from j */
        s->arm_i = s->arm_j;
        for (int k = 0; k < 3; k++) s->n[k] = -s->n[k];
        i = j;
        j = -1;
    }
    s->i = i;
    s->j = j;
    s->kn *= factor;
    s->kt *= factor;
    s->cn *= factor;
    s->bend *= factor;
    s->twist *= factor;
    return true;
}

static bool member_spring(const gn_springs *y, size_t k, gn_spring *s) {
    int32_t i, j;
    if (y->local && k < gn_spring_pairs(y->spectrum)) { /* a cheap test excludes most contacts */
        gn_spring_ends(y->spectrum, k, &i, &j);
        if (y->local[i] < 0 && y->local[j] < 0) return false;
    }
    return gn_spring_make(y->spectrum, k, s) && take_inside(y, s);
}

/* Counts the active springs of each block of contacts, then writes them in order. */
static gneiss_status collect_springs(gn_springs *y, gneiss_error *error) {
    size_t contacts = gn_spring_count(y->spectrum);
    size_t blocks = (contacts + CONTACT_BLOCK - 1) / CONTACT_BLOCK;
    size_t *start = gn_alloc_array(blocks + 1, sizeof *start);
    if (!start)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu blocks of contacts", blocks);
    for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for num_threads(y->threads) schedule(static) if (blocks > 1)
        for (size_t b = 0; b < blocks; b++) {
            size_t end = (b + 1) * CONTACT_BLOCK < contacts ? (b + 1) * CONTACT_BLOCK : contacts;
            size_t at = pass ? start[b] : 0;
            for (size_t k = b * CONTACT_BLOCK; k < end; k++) {
                gn_spring s;
                if (!member_spring(y, k, &s)) continue;
                if (pass) y->spring[at] = s;
                at++;
            }
            if (!pass) start[b] = at;
        }
        if (pass) break;
        for (size_t b = 0; b < blocks; b++) {
            size_t found = start[b];
            start[b] = y->springs;
            y->springs += found;
        }
        y->spring = gn_alloc_array(y->springs, sizeof *y->spring);
        if (!y->spring) break;
    }
    gn_free(start);
    if (!y->spring || y->springs > INT32_MAX)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu active contacts", y->springs);
    return GNEISS_OK;
}

/* Lists the springs of each particle in their order. */
static gneiss_status list_incidence(gn_springs *y, gneiss_error *error) {
    y->first = gn_alloc_array(y->particles + 2, sizeof *y->first);
    y->entry = gn_alloc_array(2 * y->springs, sizeof *y->entry);
    if (!y->first || !y->entry)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the contacts of %zu particles",
                       y->particles);
    /* Starts are shifted by two, so that the cursors of the second loop end at the starts. */
    for (size_t s = 0; s < y->springs; s++) {
        y->first[y->spring[s].i + 2]++;
        if (y->spring[s].j >= 0) y->first[y->spring[s].j + 2]++;
    }
    for (size_t p = 2; p < y->particles + 2; p++) y->first[p] += y->first[p - 1];
    for (size_t s = 0; s < y->springs; s++) {
        y->entry[y->first[y->spring[s].i + 1]++] = (uint32_t)(2 * s);
        if (y->spring[s].j >= 0) y->entry[y->first[y->spring[s].j + 1]++] = (uint32_t)(2 * s + 1);
    }
    return GNEISS_OK;
}

/* --- degrees of freedom --- */

int gn_springs_component(const gn_springs *y, int dof) {
    if (y->space) return dof;
    return dof < 2 ? dof : 5;
}

static gneiss_status scale_dofs(gn_springs *y, gneiss_error *error) {
    const gn_particles *p = y->spectrum->assembly->particles;
    const uint8_t *fixed = y->spectrum->fixed;
    size_t count = y->particles * (size_t)y->dofs;
    y->scale = gn_alloc_array(count, sizeof *y->scale);
    y->moved = gn_alloc_array(count, sizeof *y->moved);
    if (!y->scale || !y->moved)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu degrees of freedom", count);
    for (size_t i = 0; i < y->particles; i++)
        for (int d = 0; d < y->dofs; d++) {
            int component = gn_springs_component(y, d);
            size_t at = gn_springs_place(y, i);
            double inverse = component < 3 ? p->vel[4 * at + 3] : p->spin[4 * at + 3];
            bool free = !fixed || !(fixed[at] >> component & 1);
            y->scale[i * (size_t)y->dofs + (size_t)d] = free ? sqrt(inverse) : 0.0;
        }
    return GNEISS_OK;
}

bool gn_spectrum_can_move(const gn_spectrum *spectrum, int32_t i) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    if (i < 0 || p->vel[4 * (size_t)i + 3] == 0.0) return false;
    unsigned space = a->dimension == 3,
             free = spectrum->fixed ? ~(unsigned)spectrum->fixed[i] : ~0u;
    unsigned turns = p->spin && p->spin[4 * (size_t)i + 3] > 0.0 ? (space ? 0x38u : 0x20u) : 0u;
    return free & ((space ? 0x7u : 0x3u) | turns);
}

bool gn_springs_can_move(const gn_springs *y, int32_t i) {
    for (int d = 0; i >= 0 && d < y->dofs; d++)
        if (y->scale[(size_t)i * (size_t)y->dofs + (size_t)d] > 0.0) return true;
    return false;
}

void gn_springs_free(gn_springs *y) {
    gn_free(y->member);
    gn_free(y->local);
    gn_free(y->weight);
    gn_free(y->spring);
    gn_free(y->first);
    gn_free(y->entry);
    gn_free(y->scale);
    gn_free(y->moved);
}

static gneiss_status number_members(gn_springs *y, const uint8_t *inside, gneiss_error *error) {
    size_t all = y->particles, members = 0;
    y->member = gn_alloc_array(all + 1, sizeof *y->member);
    y->local = gn_alloc_array(all + 1, sizeof *y->local);
    if (!y->member || !y->local)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", all);
    for (size_t p = 0; p < all; p++) {
        y->local[p] = inside[p] ? (int32_t)members : -1;
        if (inside[p]) y->member[members++] = (int32_t)p;
    }
    y->particles = members;
    return GNEISS_OK;
}

gneiss_status gn_springs_build(const gn_spectrum *spectrum, const uint8_t *inside, gn_springs *y,
                               gneiss_error *error) {
    return gn_springs_build_weighed(spectrum, inside, NULL, y, error);
}

gneiss_status gn_springs_build_weighed(const gn_spectrum *spectrum, const uint8_t *inside,
                                       const double *weights, gn_springs *y, gneiss_error *error) {
    const gn_assembly *a = spectrum->assembly;
    *y = (gn_springs){.spectrum = spectrum,
                      .all_weights = weights,
                      .threads = spectrum->threads > 0 ? spectrum->threads : 1};
    y->space = a->dimension == 3;
    y->rotation = a->particles->spin != NULL;
    y->dofs = y->space ? (y->rotation ? 6 : 3) : (y->rotation ? 3 : 2);
    y->particles = a->particles->soa.count;
    if (inside) GN_TRY(number_members(y, inside, error));
    GN_TRY(collect_springs(y, error));
    GN_TRY(list_incidence(y, error));
    GN_TRY(scale_dofs(y, error));
    for (size_t s = 0; s < y->springs && !y->damped; s++) y->damped = y->spring[s].cn != 0.0;
    for (size_t s = 0; s < y->springs && y->rotation && !y->bends; s++)
        y->bends = y->spring[s].bend != 0.0 || y->spring[s].twist != 0.0;
    return GNEISS_OK;
}

gneiss_status gn_springs_pick(const gn_springs *all, const uint8_t *inside, gn_springs *y,
                              gneiss_error *error) {
    *y = (gn_springs){.spectrum = all->spectrum,
                      .threads = all->threads,
                      .dofs = all->dofs,
                      .space = all->space,
                      .rotation = all->rotation,
                      .damped = all->damped,
                      .bends = all->bends,
                      .particles = all->particles,
                      .springs = all->springs};
    GN_TRY(number_members(y, inside, error));
    y->spring = gn_alloc_array_raw(all->springs + 1, sizeof *y->spring);
    if (!y->spring)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu active contacts",
                       all->springs);
    for (size_t s = 0; s < all->springs; s++) {
        y->spring[s] = all->spring[s];
        y->spring[s].i = y->local[all->spring[s].i];
        if (all->spring[s].j >= 0) y->spring[s].j = y->local[all->spring[s].j];
    }
    GN_TRY(list_incidence(y, error));
    return scale_dofs(y, error);
}
