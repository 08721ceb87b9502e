#include "conversion/conversion.h"

#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "kernels/partials.h"
#include "neigh/neigh.h"
#include "particles/dormant.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "particles/refresh.h"
#include "scene/couple_def.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

gneiss_status gn_conversion_no_memory(gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to convert elements");
}

/* --- kinds --- */

gneiss_status gn_conversion_kinds(const gn_step_context *ctx, const gn_solids *solids,
                                  uint8_t *kind, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    uint8_t *driven = gn_alloc(b->nodes.soa.count + 1);
    if (!driven) return gn_conversion_no_memory(error);
    gn_elements_driven(solids->elements[0], driven);
    gn_front_kinds(b, &ctx->scene.couple.convert, driven, kind);
    gn_free(driven);
    return GNEISS_OK;
}

/* --- activation --- */

#define GN_PART_ROUNDING  1e-12
#define GN_SHAPE_ROUNDING 1e-9

/* Tells whether an element contains the position of a tie: all nodes on which the position depends
 * belong to it. */
static bool shares_place(const gn_fem_solid *solid, const gn_tie *tie, size_t e) {
    for (int a = 0; a <= solid->dimension; a++) {
        bool found = fabs(tie->shape[a]) < GN_SHAPE_ROUNDING;
        for (int k = 0; k <= solid->dimension && !found; k++)
            found = gn_elements_node(&solid->elements, k)[e] == tie->node[a];
        if (!found) return false;
    }
    return true;
}

size_t gn_conversion_around(const gn_fem_solid *solid, const gn_tie *tie,
                            int32_t element[GN_AROUND_MOST]) {
    bool on_face = false;
    size_t count = 0;
    for (int a = 0; a <= solid->dimension; a++)
        on_face = on_face || fabs(tie->shape[a]) < GN_SHAPE_ROUNDING;
    if (!on_face) {
        element[0] = tie->element;
        return 1;
    }
    for (size_t e = 0; e < solid->elements.soa.count && count < GN_AROUND_MOST; e++)
        if (shares_place(solid, tie, e)) element[count++] = (int32_t)e;
    return count;
}

/* Computes the spin of the body at a position, 1/s: half of the curl of velocities, averaged over
 * the elements there. */
static void find_spin(const gn_fem_solid *solid, const gn_tie *tie, double spin[3]) {
    int32_t element[GN_AROUND_MOST];
    const size_t count = gn_conversion_around(solid, tie, element);
    spin[0] = spin[1] = spin[2] = 0.0;
    for (size_t e = 0; e < count; e++) {
        gn_tie at = gn_tie_at(solid, element[e], solid->nodes.start);
        const gn_ties one = {.corners = solid->dimension + 1, .count = 1, .tie = &at};
        double g[4][3];
        gn_tie_gradients(&one, 0, &solid->nodes, g);
        for (int a = 0; a < one.corners; a++) {
            double of[3];
            gn_cross3(g[a], solid->nodes.vel + 4 * (size_t)at.node[a], of);
            for (int k = 0; k < 3; k++) spin[k] += 0.5 * of[k] / (double)count;
        }
    }
}

/* Activates a particle with the motion of its element. */
static void activate(const gn_conversion *conversion, size_t p) {
    gn_particles *q = &conversion->model->dem->particles;
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    gn_tie tie = gn_tie_at(b, gn_home_of(conversion, p), q->start + 4 * p);
    const gn_ties one = {.corners = b->dimension + 1, .count = 1, .tie = &tie};
    double u[3], v[3], spin[3];
    gn_tie_travel(&one, 0, &b->nodes, u);
    gn_tie_mean(&one, 0, b->nodes.vel, v);
    for (size_t k = 0; k < (size_t)b->dimension; k++) {
        q->pos[4 * p + k] = q->start[4 * p + k] + u[k];
        q->vel[4 * p + k] = v[k];
    }
    if (!q->spin) return;
    find_spin(b, &tie, spin);
    for (size_t k = b->dimension == 3 ? 0 : 2; k < 3; k++) q->spin[4 * p + k] = spin[k];
}

/* Returns the weight of a particle: 1 less the weight of the elements at its position. */
static double part_at(const gn_conversion *conversion, size_t p) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const int32_t e = gn_home_of(conversion, p);
    double part = 0.0;
    if (e < 0 || conversion->kind[e] == GN_FRONT_LEAVING) return 1.0;
    const gn_tie tie = gn_tie_at(b, e, conversion->model->dem->particles.start + 4 * p);
    for (int a = 0; a <= b->dimension; a++)
        part += tie.shape[a] * b->nodes.blend[2 * (size_t)tie.node[a]];
    /* Rounding may give a weight to a particle on a face of an element. */
    return part > 1.0 - GN_PART_ROUNDING ? 0.0 : fmin(fmax(1.0 - part, 0.0), 1.0);
}

/* Marks the elements that are removed or whose weight changes. */
static void find_touched(gn_conversion *conversion) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const double *before = conversion->node_part;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        bool touched = conversion->kind[e] == GN_FRONT_LEAVING;
        for (int a = 0; a <= b->dimension; a++) {
            const size_t n = (size_t)gn_elements_node(&b->elements, a)[e];
            touched = touched || before[2 * n] != b->nodes.blend[2 * n];
        }
        conversion->touched[e] = touched;
    }
}

/* Marks the prepared bonds that act: those with an end of nonzero weight. */
static void find_active(gn_conversion *conversion) {
    const gn_contacts *all = &conversion->model->dem->prepared;
    double *blend = conversion->model->dem->particles.blend;
    for (size_t b = 0; b < all->soa.count; b++) {
        const size_t i = (size_t)all->i[b], j = (size_t)all->j[b];
        if (!(blend[2 * i] + blend[2 * j] > 0.0)) continue;
        conversion->active[b] = 1;
        conversion->acting++;
        blend[2 * i + 1] = blend[2 * j + 1] = 1.0;
    }
}

/* Finds the weights of particles. A particle is active if its weight or that of a bonded neighbour
 * is nonzero, because both ends of a bond must exist. Masses have a least weight, so that none
 * vanishes (zones.c). */
static void find_parts(gn_conversion *conversion) {
    const gn_convertible *model = conversion->model;
    gn_particles *q = &model->dem->particles;
    memcpy(conversion->part, q->blend, 2 * q->soa.count * sizeof *conversion->part);
    for (size_t p = 0; p < q->soa.count; p++) {
        const int32_t e = gn_home_of(conversion, p);
        conversion->freed[p] = e >= 0 && conversion->kind[e] == GN_FRONT_LEAVING;
        if (e >= 0 && conversion->touched[e]) q->blend[2 * p] = part_at(conversion, p);
    }
    find_active(conversion);
    for (size_t p = 0; p < q->soa.count; p++) {
        double *part = q->blend + 2 * p;
        if (!(part[0] > 0.0) && !(part[1] > 0.0)) continue;
        const double least = fmin(q->pos[4 * p + 3] / model->ctx->scene.couple.convert.width, 1.0);
        part[1] = gn_home_of(conversion, p) < 0 ? part[1] : fmax(part[0], least);
    }
}

static void activate_all(gn_conversion *conversion) {
    gn_particles *q = &conversion->model->dem->particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double part = q->blend[2 * p + 1], before = conversion->part[2 * p + 1];
        if (part == before) continue;
        /* The marks of intact bonds do not change, but these particles have other springs than at
         * the last check of the step. */
        q->marks[2 * p] = q->marks[2 * p + 1] = 1;
        if (before > 0.0) {
            q->vel[4 * p + 3] *= before / part;
            if (q->spin) q->spin[4 * p + 3] *= before / part;
            continue;
        }
        activate(conversion, p);
        gn_dormant_particle *own = gn_dormant_of(conversion->model->dem, p);
        q->vel[4 * p + 3] = own->inverse_mass / part;
        if (q->spin) q->spin[4 * p + 3] = own->inverse_inertia / part;
        own->inverse_mass = own->inverse_inertia = 0.0;
    }
}

/* --- converting --- */

/* Moves the front. *stuck: the conversion was halted, and nothing has changed. */
static gneiss_status advance_front(gn_conversion *conversion, bool *stuck, gneiss_error *error) {
    const gn_convert_def *def = &conversion->model->ctx->scene.couple.convert;
    gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const size_t size = 2 * b->nodes.soa.count * sizeof *b->nodes.blend;
    int64_t element;
    memcpy(conversion->node_part, b->nodes.blend, size);
    GN_TRY(gn_front_advance(b, def->width, conversion->kind, &element, error));
    *stuck = element >= 0;
    if (*stuck) memcpy(b->nodes.blend, conversion->node_part, size);
    if (*stuck)
        gn_conversion_halt_at(conversion, element);
    else
        find_touched(conversion);
    return GNEISS_OK;
}

/* Makes the lists again, which must not take the conversion for fast particles. Released particles
 * are brought to equilibrium with the masses of the packing; the invariants of the body are then
 * restored at their new positions, so that no position and no mass changes afterwards. */
static gneiss_status make_lists(gn_conversion *conversion, const gn_tally *before,
                                gneiss_error *error) {
    const gn_convertible *model = conversion->model;
    gn_dem_keep_skin(model->ctx, model->dem);
    GN_TRY(model->rebuild(model->world, error));
    conversion->released[0] = gn_conversion_held_in_contacts(conversion);
    GN_TRY(gn_conversion_relax(conversion, error));
    conversion->released[1] = gn_conversion_held_in_contacts(conversion);
    GN_TRY(gn_conversion_keep_invariants(conversion, before, error));
    gn_dem_masses_changed(model->ctx, model->dem);
    GN_TRY(gn_elements_converted(model->solids->elements[0], error));
    GN_TRY(gn_timestep_check(model->ctx, model->dem, model->boundary, model->solids, model->zones,
                             model->ledger, false, error));
    return gn_timestep_check_lists(model->ctx, model->dem, model->boundary, model->solids,
                                   model->zones, model->ledger, error);
}

static void put_back(gn_conversion *conversion) {
    gn_particles *q = &conversion->model->dem->particles,
                 *nodes = &gn_coupled_solid(conversion->model->solids)->nodes;
    memcpy(nodes->blend, conversion->node_part, 2 * nodes->soa.count * sizeof *nodes->blend);
    memcpy(q->blend, conversion->part, 2 * q->soa.count * sizeof *q->blend);
    memset(conversion->active, 0, conversion->model->dem->prepared.soa.count);
    conversion->acting = 0;
}

/* Finds a front and weights with which particles can take the mass of the converting elements.
 * Elements that contain too few particles, as in a mesh that is fine relative to them, convert
 * together with the elements around them. */
static gneiss_status advance(gn_conversion *conversion, bool *stuck, gneiss_error *error) {
    enum { RINGS = 3 };
    double missing[2];
    for (conversion->rings = 0;; conversion->rings++) {
        GN_TRY(advance_front(conversion, stuck, error));
        if (*stuck) return GNEISS_OK;
        find_parts(conversion);
        const bool fits = gn_conversion_fits(conversion, missing);
        if (fits) GN_TRY(gn_conversion_find_light_nodes(conversion, stuck, error));
        if (fits && !*stuck) return GNEISS_OK;
        put_back(conversion);
        if (*stuck) return GNEISS_OK;
        if (conversion->rings < RINGS && gn_conversion_add_ring(conversion)) continue;
        *stuck = true;
        gn_conversion_halt_without_mass(conversion, missing);
        return GNEISS_OK;
    }
}

static gneiss_status go(gn_conversion *conversion, gneiss_error *error) {
    const gn_convertible *model = conversion->model;
    gn_fem_solid *b = gn_coupled_solid(model->solids);
    bool stuck = false;
    GN_TRY(advance(conversion, &stuck, error));
    if (stuck) return GNEISS_OK;
    if (conversion->dry_run) put_back(conversion);
    if (conversion->dry_run) return GNEISS_OK;
    const gn_tally before = gn_conversion_tally(conversion);
    gn_held_stages held = {.before = gn_conversion_held(conversion)};
    gn_conversion_find_alike(conversion, held.alike);
    GN_TRY(gn_conversion_find_rates(conversion, error));
    activate_all(conversion);
    GN_TRY(gn_conversion_activate_bonds(conversion, error));
    for (size_t e = 0; e < b->elements.soa.count; e++)
        conversion->kind[e] = conversion->kind[e] != GN_FRONT_LEAVING;
    GN_TRY(gn_fem_keep(b, conversion->kind, error));
    GN_TRY(gn_coupled_recreate(model->ctx, model->dem, model->solids, model->zones, error));
    GN_TRY(make_lists(conversion, &before, error));
    const gn_tally now = gn_conversion_tally(conversion);
    gn_conversion_note_jumps(conversion, &before, &now);
    memcpy(held.released, conversion->released, sizeof held.released);
    held.after = gn_conversion_held(conversion);
    gn_conversion_book(model->converted, model->ledger, &held, before.energy - now.energy);
    return GNEISS_OK;
}

static gneiss_status convert(const gn_convertible *model, uint8_t *kind, int *dry_run,
                             gneiss_error *error) {
    const size_t n = model->dem->particles.soa.count + 1,
                 elements = gn_elements_left_count(model->solids) + 1;
    const size_t nodes = gn_coupled_solid(model->solids)->nodes.soa.count + 1;
    size_t count;
    gn_conversion c = {.model = model,
                       .kind = kind,
                       .dry_run = dry_run != NULL,
                       .place = gn_fem_places(gn_coupled_solid(model->solids), &count),
                       .part = gn_alloc_array_raw(n, 2 * sizeof *c.part),
                       .node_part = gn_alloc_array_raw(nodes, 2 * sizeof *c.node_part),
                       .freed = gn_alloc_array_raw(n, 1),
                       .touched = gn_alloc_array_raw(elements, 1),
                       .some = gn_alloc_array_raw(elements, sizeof *c.some),
                       .active = gn_alloc(model->dem->prepared.soa.count + 1),
                       .tied = gn_alloc_array_raw(n, 1),
                       .reached = gn_alloc_array_raw(nodes, 1),
                       .rate = gn_alloc_array_raw(n, 3 * sizeof *c.rate)};
    void *blocks[] = {c.place, c.part,   c.node_part, c.freed,   c.touched,
                      c.some,  c.active, c.tied,      c.reached, c.rate};
    bool held = true;
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) held = held && blocks[k];
    gneiss_status status = held ? go(&c, error) : gn_conversion_no_memory(error);
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    if (dry_run) *dry_run = c.rings;
    return status;
}

gneiss_status gn_conversion_convert(const gn_convertible *model, uint8_t *kind,
                                    gneiss_error *error) {
    return convert(model, kind, NULL, error);
}

gneiss_status gn_conversion_dry_run(const gn_convertible *model, uint8_t *kind, int *rings,
                                    gneiss_error *error) {
    return convert(model, kind, rings, error);
}
