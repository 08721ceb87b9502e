/* The active contacts as springs of the linearised system, and their incidence lists. */
#include "limit/springs.h"

#include "base/new.h"
#include "base/vec3.h"
#include "soa/particle_state.h"

#include <math.h>
#include <string.h>

enum { CONTACT_BLOCK = 8192 };

/* --- the springs --- */

static bool removed(const gn_particles *particles, int32_t i) {
    return !gn_particle_is_active(particles, i);
}

static void nearest_image(const gn_assembly *assembly, double d[3]) {
    for (int k = 0; assembly->periodic && k < assembly->dimension; k++)
        d[k] = gn_nearest(d[k], assembly->period[k]);
}

static void take(gn_spring *out, gn_law_spring law) {
    out->kn = law.kn;
    out->kt = law.kt;
    out->cn = law.cn;
}

static bool contact_spring(const gn_spectrum *spectrum, const gn_contacts *list, size_t c,
                           gn_spring *out) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    const int32_t i = list->i[c], j = list->j[c];
    if (removed(p, i) || removed(p, j)) return false;
    if (spectrum->bonds_alone && !gn_contact_bonded(list, c)) return false;
    const double *x = p->pos + 4 * (size_t)i, *y = p->pos + 4 * (size_t)j;
    double d[3] = {y[0] - x[0], y[1] - x[1], a->dimension == 3 ? y[2] - x[2] : 0.0};
    nearest_image(a, d);
    double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    bool intact = gn_contact_bonded(list, c) || list->plane; /* a joint acts at any distance */
    double rest = list->length0 ? list->length0[c] : x[3] + y[3], most = rest + spectrum->reach;
    /* most contacts need no square root */
    if (!intact && square > 1.000001 * most * most) return false;
    double distance = sqrt(square);
    /* The condition is not written as distance < rest, so that a NaN gives an active spring and is
     * detected. */
    if (!intact && distance >= most) return false;
    *out = (gn_spring){.i = i, .j = j};
    double at = intact ? distance : fmin(distance, rest); /* distance at which the contact closes */
    double half = spectrum->arm_factor * (at - x[3] - y[3]);
    out->arm_i = x[3] + half;
    out->arm_j = y[3] + half;
    /* Coincident centres have no direction and, as in the kernel, no normal force. */
    for (int k = 0; k < 3; k++) out->n[k] = distance == 0.0 ? 0.0 : d[k] / distance;
    const gn_law *law = gn_law_of(list->soa.effects);
    take(out, law->spring(list, c, rest - at + spectrum->reach));
    if (!law->moments) return true;
    gn_law_moments m = law->moments(list, c, out->n);
    out->bend = m.bend;
    out->twist = m.twist;
    return true;
}

static bool wall_spring(const gn_spectrum *spectrum, const gn_wall_contacts *list, size_t c,
                        gn_spring *out) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    size_t wall = (size_t)list->wall[c];
    if (list->touch && wall >= a->wall_count) return false; /* the object is a facet: see `extra` */
    *out = (gn_spring){.i = list->i[c], .j = -1};
    if (removed(p, out->i)) return false;
    const double *x = p->pos + 4 * (size_t)out->i;
    const double *normal = a->wall_normals + 4 * wall, *point = spectrum->wall_point + 4 * wall;
    double gap = -x[3];
    for (int k = 0; k < a->dimension; k++) {
        out->n[k] = -normal[k];
        gap += normal[k] * (x[k] - point[k]);
    }
    /* A passive contact starts at gap0 and is active. */
    if (gap > list->gap0[c] + spectrum->reach) return false;
    /* The wall is rigid: its contact point is on the plane, or at r as between particles. */
    out->arm_i = x[3] + 2.0 * spectrum->arm_factor * fmin(gap, list->gap0[c]);
    gn_touch_side side = spectrum->wall_side[(size_t)p->material[out->i] * a->wall_count + wall];
    double reach = fmax(list->gap0[c] - gap, 0.0) + spectrum->reach;
    side.radius = x[3];
    if (p->pressed) reach = p->pressed[out->i] * x[3];
    take(out,
         gn_law_of(list->soa.effects)
             ->touch_spring(&side, p->vel[4 * (size_t)out->i + 3],
                            spectrum->wall_damping ? spectrum->wall_damping[wall] : 0.0, reach));
    double turns = (out->kt > 0.0 ? out->kt : out->kn) * x[3] * x[3];
    if (list->roll && side.rolling > 0.0) out->bend = turns;
    if (list->roll && side.twisting > 0.0) out->twist = turns;
    if (!list->shear) out->kt = 0.0;
    return true;
}

static bool extra_spring(const gn_spectrum *spectrum, size_t k, gn_spring *out) {
    const gn_extra_spring *e = &spectrum->extra[k];
    *out = (gn_spring){
        .i = e->particle, .j = -1, .arm_i = e->arm, .kn = e->kn, .kt = e->kt, .cn = e->cn};
    memcpy(out->n, e->n, sizeof out->n);
    return !removed(spectrum->assembly->particles, out->i);
}

static size_t wall_contact_count(const gn_assembly *assembly) {
    return assembly->wall_contacts ? assembly->wall_contacts->soa.count : 0;
}

static size_t list_count(const gn_contacts *list) {
    return list ? list->soa.count : 0;
}

const gn_contacts *gn_spring_list(const gn_spectrum *spectrum, size_t *k) {
    for (int l = 0; l < GN_LISTS_MOST; l++) {
        const gn_contacts *list = spectrum->assembly->list[l];
        const size_t count = list_count(list);
        if (*k < count) return list;
        *k -= count;
    }
    return NULL;
}

static bool make(const gn_spectrum *spectrum, size_t k, gn_spring *out) {
    const gn_assembly *a = spectrum->assembly;
    const gn_contacts *list = gn_spring_list(spectrum, &k);
    if (list) return contact_spring(spectrum, list, k, out);
    if (k < wall_contact_count(a)) return wall_spring(spectrum, a->wall_contacts, k, out);
    return extra_spring(spectrum, k - wall_contact_count(a), out);
}

bool gn_spring_make(const gn_spectrum *spectrum, size_t k, gn_spring *out) {
    if (!make(spectrum, k, out)) return false;
    if (spectrum->slips && k < gn_spring_count(spectrum) - spectrum->extra_count &&
        spectrum->slips[k])
        out->kt = 0.0;
    if (spectrum->dashpots > 0.0) out->cn *= spectrum->dashpots;
    return true;
}

size_t gn_spring_pairs(const gn_spectrum *spectrum) {
    size_t count = 0;
    for (int l = 0; l < GN_LISTS_MOST; l++) count += list_count(spectrum->assembly->list[l]);
    return count;
}

size_t gn_spring_count(const gn_spectrum *spectrum) {
    return gn_spring_pairs(spectrum) + wall_contact_count(spectrum->assembly) +
           spectrum->extra_count;
}

void gn_spring_ends(const gn_spectrum *spectrum, size_t k, int32_t *i, int32_t *j) {
    const gn_contacts *list = gn_spring_list(spectrum, &k);
    *i = list->i[k];
    *j = list->j[k];
}

/* Converts the ends to indices among the members; returns false for a spring between particles
 * outside. */
static bool take_inside(const gn_springs *system, gn_spring *member) {
    if (!system->local) return true;
    int32_t i = system->local[member->i], j = member->j < 0 ? -1 : system->local[member->j];
    if (i < 0 && j < 0) return false;
    bool leads_out = member->j >= 0 && (i < 0 || j < 0);
    double factor = 1.0;
    int32_t in = i < 0 ? member->j : member->i, out = i < 0 ? member->i : member->j;
    if (leads_out && gn_spectrum_can_move(system->spectrum, out))
        factor =
            system->all_weights ? 1.0 + system->all_weights[out] / system->all_weights[in] : 2.0;
    if (i < 0) { /* the spring is reversed, because only its end j is inside */
        member->arm_i = member->arm_j;
        for (int k = 0; k < 3; k++) member->n[k] = -member->n[k];
        i = j;
        j = -1;
    }
    member->i = i;
    member->j = j;
    member->kn *= factor;
    member->kt *= factor;
    member->cn *= factor;
    member->bend *= factor;
    member->twist *= factor;
    return true;
}

static bool member_spring(const gn_springs *system, size_t k, gn_spring *out) {
    int32_t i, j;
    if (system->local &&
        k < gn_spring_pairs(system->spectrum)) { /* a cheap test excludes most contacts */
        gn_spring_ends(system->spectrum, k, &i, &j);
        if (system->local[i] < 0 && system->local[j] < 0) return false;
    }
    return gn_spring_make(system->spectrum, k, out) && take_inside(system, out);
}

/* Counts the active springs of each block of contacts, then writes them in order. */
static gneiss_status collect_springs(gn_springs *system, gneiss_error *error) {
    size_t contacts = gn_spring_count(system->spectrum);
    size_t blocks = (contacts + CONTACT_BLOCK - 1) / CONTACT_BLOCK;
    size_t *start = NULL;
    GN_TRY(gn_new(&start, blocks + 1, "blocks of contacts", error));
    for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for num_threads(system->threads) schedule(static) if (blocks > 1)
        for (size_t b = 0; b < blocks; b++) {
            size_t end = (b + 1) * CONTACT_BLOCK < contacts ? (b + 1) * CONTACT_BLOCK : contacts;
            size_t at = pass ? start[b] : 0;
            for (size_t k = b * CONTACT_BLOCK; k < end; k++) {
                gn_spring s;
                if (!member_spring(system, k, &s)) continue;
                if (pass) system->spring[at] = s;
                at++;
            }
            if (!pass) start[b] = at;
        }
        if (pass) break;
        for (size_t b = 0; b < blocks; b++) {
            size_t found = start[b];
            start[b] = system->springs;
            system->springs += found;
        }
        system->spring = gn_alloc_array(system->springs, sizeof *system->spring);
        if (!system->spring) break;
    }
    gn_free(start);
    if (!system->spring || system->springs > INT32_MAX)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu active contacts",
                       system->springs);
    return GNEISS_OK;
}

/* Lists the springs of each particle in their order. */
static gneiss_status list_incidence(gn_springs *system, gneiss_error *error) {
    GN_TRY(gn_new(&system->first, system->particles + 2, "the contacts of particles", error));
    GN_TRY(gn_new(&system->entry, 2 * system->springs, "the contacts of particles", error));
    /* Starts are stored two places ahead, so that the second loop, which advances them, leaves each
     * at its place. */
    for (size_t s = 0; s < system->springs; s++) {
        system->first[system->spring[s].i + 2]++;
        if (system->spring[s].j >= 0) system->first[system->spring[s].j + 2]++;
    }
    for (size_t p = 2; p < system->particles + 2; p++) system->first[p] += system->first[p - 1];
    for (size_t s = 0; s < system->springs; s++) {
        system->entry[system->first[system->spring[s].i + 1]++] = (uint32_t)(2 * s);
        if (system->spring[s].j >= 0)
            system->entry[system->first[system->spring[s].j + 1]++] = (uint32_t)(2 * s + 1);
    }
    return GNEISS_OK;
}

/* --- degrees of freedom --- */

int gn_springs_component(const gn_springs *system, int dof) {
    if (system->space) return dof;
    return dof < 2 ? dof : 5;
}

static gneiss_status scale_dofs(gn_springs *system, gneiss_error *error) {
    const gn_particles *p = system->spectrum->assembly->particles;
    const uint8_t *fixed = system->spectrum->fixed;
    size_t count = system->particles * (size_t)system->dofs;
    GN_TRY(gn_new(&system->scale, count, "degrees of freedom", error));
    GN_TRY(gn_new(&system->moved, count, "degrees of freedom", error));
    for (size_t i = 0; i < system->particles; i++)
        for (int d = 0; d < system->dofs; d++) {
            int component = gn_springs_component(system, d);
            size_t at = gn_springs_place(system, i);
            double inverse = component < 3 ? p->vel[4 * at + 3] : p->spin[4 * at + 3];
            bool free = !fixed || !(fixed[at] >> component & 1);
            system->scale[i * (size_t)system->dofs + (size_t)d] = free ? sqrt(inverse) : 0.0;
        }
    return GNEISS_OK;
}

bool gn_spectrum_can_move(const gn_spectrum *spectrum, int32_t i) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    if (i < 0 || !gn_particle_is_active(p, i)) return false;
    unsigned space = a->dimension == 3,
             free = spectrum->fixed ? ~(unsigned)spectrum->fixed[i] : ~0u;
    unsigned turns = p->spin && p->spin[4 * (size_t)i + 3] > 0.0 ? (space ? 0x38u : 0x20u) : 0u;
    return free & ((space ? 0x7u : 0x3u) | turns);
}

bool gn_springs_can_move(const gn_springs *system, int32_t i) {
    for (int d = 0; i >= 0 && d < system->dofs; d++)
        if (system->scale[(size_t)i * (size_t)system->dofs + (size_t)d] > 0.0) return true;
    return false;
}

void gn_springs_free(gn_springs *system) {
    gn_free(system->member);
    gn_free(system->local);
    gn_free(system->weight);
    gn_free(system->spring);
    gn_free(system->first);
    gn_free(system->entry);
    gn_free(system->scale);
    gn_free(system->moved);
}

static gneiss_status number_members(gn_springs *system, const uint8_t *inside,
                                    gneiss_error *error) {
    size_t all = system->particles, members = 0;
    GN_TRY(gn_new(&system->member, all + 1, "particles", error));
    GN_TRY(gn_new(&system->local, all + 1, "particles", error));
    for (size_t p = 0; p < all; p++) {
        system->local[p] = inside[p] ? (int32_t)members : -1;
        if (inside[p]) system->member[members++] = (int32_t)p;
    }
    system->particles = members;
    return GNEISS_OK;
}

gneiss_status gn_springs_build(const gn_spectrum *spectrum, const uint8_t *inside,
                               gn_springs *system, gneiss_error *error) {
    return gn_springs_build_weighed(spectrum, inside, NULL, system, error);
}

gneiss_status gn_springs_build_weighed(const gn_spectrum *spectrum, const uint8_t *inside,
                                       const double *weights, gn_springs *system,
                                       gneiss_error *error) {
    const gn_assembly *a = spectrum->assembly;
    *system = (gn_springs){.spectrum = spectrum,
                           .all_weights = weights,
                           .threads = spectrum->threads > 0 ? spectrum->threads : 1};
    system->space = a->dimension == 3;
    system->rotation = a->particles->spin != NULL;
    system->dofs = system->space ? (system->rotation ? 6 : 3) : (system->rotation ? 3 : 2);
    system->particles = a->particles->soa.count;
    if (inside) GN_TRY(number_members(system, inside, error));
    GN_TRY(collect_springs(system, error));
    GN_TRY(list_incidence(system, error));
    GN_TRY(scale_dofs(system, error));
    for (size_t s = 0; s < system->springs && !system->damped; s++)
        system->damped = system->spring[s].cn != 0.0;
    for (size_t s = 0; s < system->springs && system->rotation && !system->bends; s++)
        system->bends = system->spring[s].bend != 0.0 || system->spring[s].twist != 0.0;
    return GNEISS_OK;
}

gneiss_status gn_springs_pick(const gn_springs *all, const uint8_t *inside, gn_springs *system,
                              gneiss_error *error) {
    *system = (gn_springs){.spectrum = all->spectrum,
                           .threads = all->threads,
                           .dofs = all->dofs,
                           .space = all->space,
                           .rotation = all->rotation,
                           .damped = all->damped,
                           .bends = all->bends,
                           .particles = all->particles,
                           .springs = all->springs};
    GN_TRY(number_members(system, inside, error));
    system->spring = gn_alloc_array_raw(all->springs + 1, sizeof *system->spring);
    if (!system->spring)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu active contacts",
                       all->springs);
    for (size_t s = 0; s < all->springs; s++) {
        system->spring[s] = all->spring[s];
        system->spring[s].i = system->local[all->spring[s].i];
        if (all->spring[s].j >= 0) system->spring[s].j = system->local[all->spring[s].j];
    }
    GN_TRY(list_incidence(system, error));
    return scale_dofs(system, error);
}
