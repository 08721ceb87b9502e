#include "conversion/conversion.h"

#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "base/timer.h"
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "couple/ties.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "kernels/partials.h"
#include "neigh/pairs.h"
#include "particles/dem.h"
#include "particles/lists.h"
#include "scene/couple_def.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "timestep/step_limit.h"
#include "world/world.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

static gneiss_status no_memory(gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to convert elements");
}

static gneiss_status refuse(const gn_step_context *ctx, gn_scene_place where, const char *key,
                            const char *message, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s", gn_scene_at(&ctx->scene, where, key).text,
                   message);
}

/* --- at the start --- */

/* Springs between particles that a strain of the body does not determine. */
static gneiss_status check_law(const gn_step_context *ctx, gneiss_error *error) {
    const gn_effects without = GN_FX_BOND_MOMENTS | GN_FX_ROLLING | GN_FX_HERTZ | GN_FX_CONFINED;
    if (!(ctx->effects & GN_FX_BONDS))
        return refuse(ctx, ctx->scene.couple.convert.where, "bonds",
                      "expected bonds beside couple.convert, found none", error);
    if (!(ctx->effects & without)) return GNEISS_OK;
    const bool moments = ctx->effects & GN_FX_BOND_MOMENTS, rolling = ctx->effects & GN_FX_ROLLING;
    return refuse(ctx, moments ? ctx->scene.couple.convert.where : ctx->scene.law_where,
                  moments   ? "bonds.radius_multiplier"
                  : rolling ? "materials"
                            : "law",
                  "expected linear contacts without moments, resistance to rolling and confined "
                  "friction beside couple.convert, found others",
                  error);
}

/* Where a zone is as wide as the body no element is left with the first conversion. */
static gneiss_status check_width(const gn_step_context *ctx, const gn_solids *solids,
                                 gneiss_error *error) {
    const double side = gn_elements_longest_side(ctx, solids);
    char message[160];
    if (ctx->scene.couple.convert.width < side) return GNEISS_OK;
    snprintf(message, sizeof message,
             "expected a zone that is narrower than the body of %g m, found %g m", side,
             ctx->scene.couple.convert.width);
    return refuse(ctx, ctx->scene.couple.convert.where, "couple.convert.width", message, error);
}

static gneiss_status find_homes(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                                const gn_ties *ties, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    const gn_elements *elements = &gn_coupled_solid(solids)->elements;
    char at[GN_POINT_SIZE], message[256];
    for (size_t p = 0; p < q->soa.count; p++) gn_dormant_of(dem, p)->element = -1;
    for (size_t k = 0; k < ties->count; k++) /* particles have the order of their ids as yet */
        dem->dormant[ties->tie[k].id].element = elements->id[ties->tie[k].element];
    for (size_t p = 0; p < q->soa.count; p++) {
        q->blend[2 * p] = q->blend[2 * p + 1] = 1.0;
        if (gn_dormant_of(dem, p)->element >= 0) continue;
        snprintf(message, sizeof message,
                 "expected every particle in an element, found particle %d at %s m in none",
                 q->id[p], gn_point_text(ctx->scene.origin, q->start + 4 * p, at));
        return refuse(ctx, ctx->scene.specimen.where, "specimen", message, error);
    }
    return GNEISS_OK;
}

/* Elements can become particles only where these are. */
static gneiss_status check_filled(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  gneiss_error *error) {
    gn_conversion_figures f;
    char message[200];
    GN_TRY(gn_conversion_measure(ctx, dem, boundary, solids, &f, error));
    if (!f.elements)
        return refuse(ctx, ctx->scene.couple.convert.where, "couple.convert.box",
                      "expected elements of which all nodes start in the box, found none", error);
    if (fabs(f.mass - 1.0) <= 0.1) return GNEISS_OK;
    snprintf(message, sizeof message,
             "expected particles that weigh what the elements in the box do (to a tenth: a packing "
             "that fills it, density_basis bulk, one density), found %g times as much",
             f.mass);
    return refuse(ctx, ctx->scene.specimen.where, "specimen", message, error);
}

/* Where a zone comes to what is outside of the box whatever converts, the first conversion would
 * end the run. What only motions and loads keep from converting is another matter. */
static gneiss_status check_room(const gn_step_context *ctx, const gn_solids *solids,
                                gneiss_error *error) {
    const double width = ctx->scene.couple.convert.width, enough = (1.0 - 1e-9) * width;
    char message[256];
    double room = 0.0;
    size_t ready = 0;
    uint8_t *kind = gn_alloc(gn_conversion_elements(solids) + 1);
    gneiss_status status = kind ? gn_conversion_kinds(ctx, solids, kind, error) : no_memory(error);
    if (status == GNEISS_OK)
        status = gn_front_room(gn_coupled_solid(solids), kind, enough, &room, error);
    for (size_t e = 0; status == GNEISS_OK && e < gn_conversion_elements(solids); e++)
        ready += kind[e] == GN_FRONT_READY;
    gn_free(kind);
    if (status != GNEISS_OK || !ready || room >= enough) return status;
    snprintf(
        message, sizeof message,
        "expected a zone that is no wider than the %.4g m that are left between some element "
        "and what is outside of couple.convert.box (or a larger box, with a packing that fills "
        "it), found %g m",
        room, width);
    return refuse(ctx, ctx->scene.couple.convert.where, "couple.convert.width", message, error);
}

gneiss_status gn_conversion_prepare(const gn_step_context *ctx, gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gneiss_error *error) {
    gn_ties ties;
    GN_TRY(check_law(ctx, error));
    GN_TRY(check_width(ctx, solids, error));
    dem->dormant = gn_alloc_array(dem->particles.soa.count + 1, sizeof *dem->dormant);
    if (!dem->dormant) return no_memory(error);
    GN_TRY(gn_ties_find(gn_coupled_solid(solids), &dem->particles, &ties, error));
    gneiss_status status = find_homes(ctx, dem, solids, &ties, error);
    gn_ties_free(&ties);
    if (status == GNEISS_OK) status = check_filled(ctx, dem, boundary, solids, error);
    return status == GNEISS_OK ? check_room(ctx, solids, error) : status;
}

/* Once all has converted there is nothing left to compare. */
static gneiss_status keep_difference(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids,
                                     gn_zones *zones, gneiss_error *error) {
    gn_conversion_figures f;
    GN_TRY(gn_conversion_measure(ctx, dem, boundary, solids, &f, error));
    for (size_t k = f.materials; k-- > 0;) {
        const gn_zone_material *m = &f.material[k];
        if (!gn_zone_differs(m)) continue;
        memcpy(zones->state.differs.modulus, m->modulus, sizeof m->modulus);
        memcpy(zones->state.differs.density, m->density, sizeof m->density);
        memcpy(zones->state.differs.tension, m->tension, sizeof m->tension);
    }
    return GNEISS_OK;
}

gneiss_status gn_conversion_lay_down(const gn_step_context *ctx, gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids,
                                     gn_zones *zones, gneiss_error *error) {
    gn_dem *d = dem;
    gn_particles *q = &d->particles;
    GN_TRY(gn_conversion_check_neighbours(ctx, dem, error));
    d->prepared = d->bonds.contacts;
    d->bonds.contacts = (gn_contacts){0};
    GN_TRY(
        gn_soa_create(&gn_contact_record, &d->bonds.contacts, 0, d->prepared.soa.effects, error));
    for (size_t p = 0; p < q->soa.count; p++) {
        gn_dormant_of(dem, p)->inverse_mass = q->vel[4 * p + 3];
        gn_dormant_of(dem, p)->inverse_inertia = q->spin ? q->spin[4 * p + 3] : 0.0;
        memset(q->vel + 4 * p, 0, 4 * sizeof *q->vel);
        if (q->spin) memset(q->spin + 4 * p, 0, 4 * sizeof *q->spin);
        q->blend[2 * p] = q->blend[2 * p + 1] = 0.0;
    }
    GN_TRY(gn_list_changed(ctx, dem, &d->bonds, error));
    return keep_difference(ctx, dem, boundary, solids, zones, error);
}

gneiss_status gn_conversion_find_still(gn_dem *dem, gneiss_error *error) {
    gn_dem *d = dem;
    if (!d->still) d->still = gn_alloc(d->motion_blocks + 1);
    if (!d->still) return no_memory(error);
    memset(d->still, 1, d->motion_blocks);
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (!gn_particle_is_dormant(dem, p)) d->still[p / GN_PARTICLE_BLOCK] = 0;
    return GNEISS_OK;
}

/* --- who is where --- */

gneiss_status gn_conversion_ties(const gn_dem *dem, const gn_solids *solids, gn_ties *ties,
                                 gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    size_t count;
    int32_t *place = gn_fem_places(gn_coupled_solid(solids), &count);
    int32_t *element = gn_alloc_array(q->soa.count + 1, sizeof *element);
    gneiss_status status = place && element ? GNEISS_OK : no_memory(error);
    for (size_t p = 0; status == GNEISS_OK && p < q->soa.count; p++) {
        const bool awake = dem->prepared.soa.capacity && gn_particle_is_active(q, p);
        if (gn_dormant_element(dem, p) >= count)
            status = gn_fail(error, GNEISS_ERROR_INPUT,
                             "expected particles in the %zu elements of the mesh, found number %zu",
                             count, gn_dormant_element(dem, p));
        else
            element[p] = awake ? place[gn_dormant_element(dem, p)] : -1;
    }
    if (status == GNEISS_OK)
        status = gn_ties_take(gn_coupled_solid(solids), q, element, ties, error);
    gn_free(place);
    gn_free(element);
    return status;
}

size_t gn_conversion_elements(const gn_solids *solids) {
    return gn_coupled_solid(solids)->elements.soa.count;
}

gneiss_status gn_conversion_kinds(const gn_step_context *ctx, const gn_solids *solids,
                                  uint8_t *kind, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    uint8_t *driven = gn_alloc(b->nodes.soa.count + 1);
    if (!driven) return no_memory(error);
    gn_elements_driven(solids->elements[0], driven);
    gn_front_kinds(b, &ctx->scene.couple.convert, driven, kind);
    gn_free(driven);
    return GNEISS_OK;
}

/* --- waking --- */

#define GN_PART_ROUNDING  1e-12
#define GN_SHAPE_ROUNDING 1e-9

/* Tells whether an element has all nodes that the place of a tie depends on: the place is in it. */
static bool shares_place(const gn_fem_solid *b, const gn_tie *tie, size_t e) {
    for (int a = 0; a <= b->dimension; a++) {
        bool found = fabs(tie->shape[a]) < GN_SHAPE_ROUNDING;
        for (int k = 0; k <= b->dimension && !found; k++)
            found = gn_elements_node(&b->elements, k)[e] == tie->node[a];
        if (!found) return false;
    }
    return true;
}

size_t gn_conversion_around(const gn_fem_solid *b, const gn_tie *tie,
                            int32_t element[GN_AROUND_MOST]) {
    bool on_face = false;
    size_t count = 0;
    for (int a = 0; a <= b->dimension; a++)
        on_face = on_face || fabs(tie->shape[a]) < GN_SHAPE_ROUNDING;
    if (!on_face) {
        element[0] = tie->element;
        return 1;
    }
    for (size_t e = 0; e < b->elements.soa.count && count < GN_AROUND_MOST; e++)
        if (shares_place(b, tie, e)) element[count++] = (int32_t)e;
    return count;
}

/* The spin of the body at a place, 1/s: half of the curl of velocities, the mean of the elements
 * there. */
static void find_spin(const gn_fem_solid *b, const gn_tie *tie, double spin[3]) {
    int32_t element[GN_AROUND_MOST];
    const size_t count = gn_conversion_around(b, tie, element);
    spin[0] = spin[1] = spin[2] = 0.0;
    for (size_t e = 0; e < count; e++) {
        gn_tie at = gn_tie_at(b, element[e], b->nodes.start);
        const gn_ties one = {.corners = b->dimension + 1, .count = 1, .tie = &at};
        double g[4][3];
        gn_tie_gradients(&one, 0, &b->nodes, g);
        for (int a = 0; a < one.corners; a++) {
            double of[3];
            gn_cross3(g[a], b->nodes.vel + 4 * (size_t)at.node[a], of);
            for (int k = 0; k < 3; k++) spin[k] += 0.5 * of[k] / (double)count;
        }
    }
}

/* With the motion of the element that it is in. */
static void wake(const gn_conversion *c, size_t p) {
    gn_particles *q = &c->world->dem.particles;
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    gn_tie tie = gn_tie_at(b, gn_home_of(c, p), q->start + 4 * p);
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

/* What part of the body a particle is now: 1 less what the elements have at its place. */
static double part_at(const gn_conversion *c, size_t p) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const int32_t e = gn_home_of(c, p);
    double part = 0.0;
    if (e < 0 || c->kind[e] == GN_FRONT_LEAVING) return 1.0;
    const gn_tie tie = gn_tie_at(b, e, c->world->dem.particles.start + 4 * p);
    for (int a = 0; a <= b->dimension; a++)
        part += tie.shape[a] * b->nodes.blend[2 * (size_t)tie.node[a]];
    /* Of what lies on a side of an element rounding may say that it has some. */
    return part > 1.0 - GN_PART_ROUNDING ? 0.0 : fmin(fmax(1.0 - part, 0.0), 1.0);
}

/* What elements go, or have another part of the body than before. */
static void find_touched(gn_conversion *c) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const double *before = c->node_part;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        bool touched = c->kind[e] == GN_FRONT_LEAVING;
        for (int a = 0; a <= b->dimension; a++) {
            const size_t n = (size_t)gn_elements_node(&b->elements, a)[e];
            touched = touched || before[2 * n] != b->nodes.blend[2 * n];
        }
        c->touched[e] = touched;
    }
}

/* Bonds act with an end that has a part. */
static void find_active(gn_conversion *c) {
    const gn_contacts *all = &c->world->dem.prepared;
    double *blend = c->world->dem.particles.blend;
    for (size_t b = 0; b < all->soa.count; b++) {
        const size_t i = (size_t)all->i[b], j = (size_t)all->j[b];
        if (!(blend[2 * i] + blend[2 * j] > 0.0)) continue;
        c->active[b] = 1;
        c->acting++;
        blend[2 * i + 1] = blend[2 * j + 1] = 1.0;
    }
}

/* Awake is who has a part, and who is bonded to one that has: the ends of bonds have to be where
 * they are. Masses have a part at least, so that none vanishes (zones.c). */
static void find_parts(gn_conversion *c) {
    gn_world *w = c->world;
    gn_particles *q = &w->dem.particles;
    memcpy(c->part, q->blend, 2 * q->soa.count * sizeof *c->part);
    for (size_t p = 0; p < q->soa.count; p++) {
        const int32_t e = gn_home_of(c, p);
        c->freed[p] = e >= 0 && c->kind[e] == GN_FRONT_LEAVING;
        if (e >= 0 && c->touched[e]) q->blend[2 * p] = part_at(c, p);
    }
    find_active(c);
    for (size_t p = 0; p < q->soa.count; p++) {
        double *part = q->blend + 2 * p;
        if (!(part[0] > 0.0) && !(part[1] > 0.0)) continue;
        const double least = fmin(q->pos[4 * p + 3] / w->ctx.scene.couple.convert.width, 1.0);
        part[1] = gn_home_of(c, p) < 0 ? part[1] : fmax(part[0], least);
    }
}

static void wake_all(gn_conversion *c) {
    gn_particles *q = &c->world->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double part = q->blend[2 * p + 1], before = c->part[2 * p + 1];
        if (part == before) continue;
        /* Intact bonds leave 0: its springs are others than at the last look at the step. */
        q->marks[2 * p] = q->marks[2 * p + 1] = 1;
        if (before > 0.0) {
            q->vel[4 * p + 3] *= before / part;
            if (q->spin) q->spin[4 * p + 3] *= before / part;
            continue;
        }
        wake(c, p);
        gn_dormant_particle *own = gn_dormant_of(&c->world->dem, p);
        q->vel[4 * p + 3] = own->inverse_mass / part;
        if (q->spin) q->spin[4 * p + 3] = own->inverse_inertia / part;
        own->inverse_mass = own->inverse_inertia = 0.0;
    }
}

/* --- converting --- */

/* *stuck: halted, nothing has changed. */
static gneiss_status advance_front(gn_conversion *c, bool *stuck, gneiss_error *error) {
    const gn_convert_def *def = &c->world->ctx.scene.couple.convert;
    gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const size_t size = 2 * b->nodes.soa.count * sizeof *b->nodes.blend;
    int64_t element;
    memcpy(c->node_part, b->nodes.blend, size);
    GN_TRY(gn_front_advance(b, def->width, c->kind, &element, error));
    *stuck = element >= 0;
    if (*stuck) memcpy(b->nodes.blend, c->node_part, size);
    if (*stuck)
        gn_conversion_halt_at(c, element);
    else
        find_touched(c);
    return GNEISS_OK;
}

/* Lists anew, which must not take the conversion for particles that move fast. Who is free is
 * balanced with the mass of the packing and where it is then keeps what the body has as a whole, so
 * that no place and no mass changes after that. */
static gneiss_status make_lists(gn_conversion *c, const gn_tally *before, gneiss_error *error) {
    enum { NEITHER_SHORT_NOR_LONG = 1000 };
    gn_world *w = c->world;
    w->dem.verlet.last_step = w->ctx.step - NEITHER_SHORT_NOR_LONG;
    GN_TRY(gn_world_rebuild(w, error));
    c->woken[0] = gn_conversion_held_in_contacts(c);
    GN_TRY(gn_conversion_relax(c, error));
    c->woken[1] = gn_conversion_held_in_contacts(c);
    GN_TRY(gn_conversion_keep(c, before, error));
    gn_dem_masses_changed(&w->ctx, &w->dem);
    GN_TRY(gn_elements_converted(w->solids.elements[0], error));
    GN_TRY(gn_world_check_step(w, false, error));
    return gn_world_check_lists(w, error);
}

static void put_back(gn_conversion *c) {
    gn_particles *q = &c->world->dem.particles,
                 *nodes = &gn_coupled_solid(&c->world->solids)->nodes;
    memcpy(nodes->blend, c->node_part, 2 * nodes->soa.count * sizeof *nodes->blend);
    memcpy(q->blend, c->part, 2 * q->soa.count * sizeof *q->blend);
    memset(c->active, 0, c->world->dem.prepared.soa.count);
    c->acting = 0;
}

/* Front and parts, of particles that can have the mass of what goes: elements without such, as of a
 * mesh that is fine beside them, take those around them along. */
static gneiss_status advance(gn_conversion *c, bool *stuck, gneiss_error *error) {
    enum { RINGS = 3 };
    double missing[2];
    for (c->rings = 0;; c->rings++) {
        GN_TRY(advance_front(c, stuck, error));
        if (*stuck) return GNEISS_OK;
        find_parts(c);
        const bool fits = gn_conversion_fits(c, missing);
        if (fits) GN_TRY(gn_conversion_look_for_bare(c, stuck, error));
        if (fits && !*stuck) return GNEISS_OK;
        put_back(c);
        if (*stuck) return GNEISS_OK;
        if (c->rings < RINGS && gn_conversion_take_along(c)) continue;
        *stuck = true;
        gn_conversion_halt_thin(c, missing);
        return GNEISS_OK;
    }
}

static gneiss_status go(gn_conversion *c, gneiss_error *error) {
    gn_world *w = c->world;
    gn_fem_solid *b = gn_coupled_solid(&w->solids);
    bool stuck = false;
    GN_TRY(advance(c, &stuck, error));
    if (stuck) return GNEISS_OK;
    if (c->rehearsed) put_back(c);
    if (c->rehearsed) return GNEISS_OK;
    const gn_tally before = gn_conversion_tally(c);
    gn_held_stages held = {.before = gn_conversion_held(c)};
    gn_conversion_find_alike(c, held.alike);
    GN_TRY(gn_conversion_find_rates(c, error));
    wake_all(c);
    GN_TRY(gn_conversion_take_bonds(c, error));
    for (size_t e = 0; e < b->elements.soa.count; e++) c->kind[e] = c->kind[e] != GN_FRONT_LEAVING;
    GN_TRY(gn_fem_keep(b, c->kind, error));
    GN_TRY(gn_coupled_again(&w->ctx, &w->dem, &w->solids, &w->zones, error));
    GN_TRY(make_lists(c, &before, error));
    const gn_tally now = gn_conversion_tally(c);
    gn_conversion_note_jumps(c, &before, &now);
    memcpy(held.woken, c->woken, sizeof held.woken);
    held.after = gn_conversion_held(c);
    gn_conversion_book(&w->zones, &w->ledger, &held, before.energy - now.energy);
    return GNEISS_OK;
}

static gneiss_status convert(gn_world *w, uint8_t *kind, int *rehearsed, gneiss_error *error) {
    const size_t n = w->dem.particles.soa.count + 1,
                 elements = gn_conversion_elements(&w->solids) + 1;
    const size_t nodes = gn_coupled_solid(&w->solids)->nodes.soa.count + 1;
    size_t count;
    gn_conversion c = {.world = w,
                       .kind = kind,
                       .rehearsed = rehearsed != NULL,
                       .place = gn_fem_places(gn_coupled_solid(&w->solids), &count),
                       .part = gn_alloc_array_raw(n, 2 * sizeof *c.part),
                       .node_part = gn_alloc_array_raw(nodes, 2 * sizeof *c.node_part),
                       .freed = gn_alloc_array_raw(n, 1),
                       .touched = gn_alloc_array_raw(elements, 1),
                       .some = gn_alloc_array_raw(elements, sizeof *c.some),
                       .active = gn_alloc(w->dem.prepared.soa.count + 1),
                       .tied = gn_alloc_array_raw(n, 1),
                       .reached = gn_alloc_array_raw(nodes, 1),
                       .rate = gn_alloc_array_raw(n, 3 * sizeof *c.rate)};
    void *blocks[] = {c.place, c.part,   c.node_part, c.freed,   c.touched,
                      c.some,  c.active, c.tied,      c.reached, c.rate};
    bool held = true;
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) held = held && blocks[k];
    gneiss_status status = held ? go(&c, error) : no_memory(error);
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    if (rehearsed) *rehearsed = c.rings;
    return status;
}

gneiss_status gn_conversion_convert(gn_world *w, uint8_t *kind, gneiss_error *error) {
    return convert(w, kind, NULL, error);
}

gneiss_status gn_conversion_rehearse(gn_world *w, uint8_t *kind, int *rings, gneiss_error *error) {
    return convert(w, kind, rings, error);
}

/* --- what converts --- */

/* Below this part of the limits nothing has to be known: what was loaded as much already is not the
 * most. */
static double least_share(const gn_most_loaded *most_loaded) {
    return fmin(1.0, most_loaded->share);
}

/* By stresses that are means over the elements at the nodes, and over the nodes of an element. */
static gneiss_status find_excess_by_nodes(const gn_step_context *ctx, const gn_solids *solids,
                                          const gn_most_loaded *most_loaded, const uint8_t *kind,
                                          double *excess, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const double least = least_share(most_loaded);
    const size_t elements = b->elements.soa.count, nodes = b->nodes.soa.count;
    double(*stress)[6] = gn_alloc_array(elements + nodes + 1, sizeof *stress);
    if (!stress) return no_memory(error);
    double(*nodal)[6] = stress + elements;
    gn_fem_element_stress(b, stress);
    gneiss_status status = gn_fem_nodal_stress(b, (const double(*)[6])stress, nodal, error);
    for (size_t e = 0; status == GNEISS_OK && e < elements; e++) {
        double mean[6] = {0.0};
        if (kind[e] != GN_FRONT_READY) continue;
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < 6; k++)
                mean[k] += nodal[gn_elements_node(&b->elements, a)[e]][k] / (b->dimension + 1);
        excess[e] = gn_front_excess_above(&ctx->scene.couple.convert, mean, least);
    }
    gn_free(stress);
    return status;
}

/* [elements] how far those that may go are beyond the limits; below 1: not at all, 0 as well where
 * they may not. */
static gneiss_status find_excess(const gn_step_context *ctx, const gn_solids *solids,
                                 const gn_most_loaded *most_loaded, const uint8_t *kind,
                                 double *excess, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const gn_convert_def *def = &ctx->scene.couple.convert;
    const double least = least_share(most_loaded);
    if (def->by == GN_CONVERT_NODES)
        return find_excess_by_nodes(ctx, solids, most_loaded, kind, excess, error);
#pragma omp parallel for schedule(static) num_threads(ctx->threads)
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double stress[6];
        if (kind[e] != GN_FRONT_READY) continue;
        gn_fem_stress_of(b, e, stress);
        excess[e] = gn_front_excess_above(def, stress, least);
    }
    return GNEISS_OK;
}

/* Bonds that break where elements hold on: these go. */
static void mark_broken(const gn_dem *dem, const int32_t *place, uint8_t *kind) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    for (size_t c = 0; c < bonds->soa.count; c++) {
        if (!gn_broken(bonds->cause[c])) continue;
        for (int end = 0; end < 2; end++) {
            const int32_t p = end ? bonds->j[c] : bonds->i[c],
                          e = place[gn_dormant_element(dem, (size_t)p)];
            if (e >= 0 && kind[e] == GN_FRONT_READY) kind[e] = GN_FRONT_LEAVING;
        }
    }
}

/* The first READY element of the largest excess that is at least `least`; count: there is none. */
static size_t most_stressed(size_t count, const double *excess, double least, const uint8_t *kind) {
    size_t first = count;
    for (size_t e = 0; e < count; e++)
        if (kind[e] == GN_FRONT_READY && excess[e] >= least &&
            (first == count || excess[e] > excess[first]))
            first = e;
    return first;
}

/* Marks the elements that are loaded as the last marked one but for rounding, as on either side of
 * a plane of symmetry, so that the share of a look does not part them. Where more are alike than
 * were marked, as in a body under one stress, the share decides. */
static void mark_alike(size_t count, const double *excess, double last, size_t marked,
                       uint8_t *kind) {
    const double least = (1.0 - 1e-6) * last;
    size_t alike = 0;
    for (size_t e = 0; e < count; e++) alike += kind[e] == GN_FRONT_READY && excess[e] >= least;
    for (size_t e = 0; e < count && alike <= marked; e++)
        if (kind[e] == GN_FRONT_READY && excess[e] >= least) kind[e] = GN_FRONT_LEAVING;
}

/* Marks the elements beyond the limits, the farthest first, up to the share that one look converts.
 * Few looks find any, and then few. */
static void mark_stressed(const gn_convert_def *def, size_t count, const double *excess,
                          uint8_t *kind) {
    size_t ready = 0, marked = 0, e;
    double last = INFINITY;
    for (e = 0; e < count; e++) ready += kind[e] == GN_FRONT_READY;
    const double most = fmax(1.0, def->most * (double)ready);
    while ((double)marked + 1.0 <= most && (e = most_stressed(count, excess, 1.0, kind)) < count) {
        last = excess[e];
        kind[e] = GN_FRONT_LEAVING;
        marked++;
    }
    mark_alike(count, excess, last, marked, kind);
}

/* Whether an element is beyond a limit, or a bond broke where elements hold on: mostly not. */
static bool is_due(const gn_dem *dem, const gn_solids *solids, const double *excess) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    const double *part = dem->particles.blend;
    bool due = false;
    for (size_t e = 0; e < gn_conversion_elements(solids); e++) due = due || excess[e] >= 1.0;
    for (size_t c = 0; c < bonds->soa.count && !due; c++)
        due = gn_broken(bonds->cause[c]) &&
              (part[2 * (size_t)bonds->i[c]] < 1.0 || part[2 * (size_t)bonds->j[c]] < 1.0);
    return due;
}

static gneiss_status act(gn_world *w, const double *excess, uint8_t *kind, gneiss_error *error) {
    const size_t elements = gn_conversion_elements(&w->solids);
    size_t count;
    bool any = false;
    int32_t *place = gn_fem_places(gn_coupled_solid(&w->solids), &count);
    if (!place) return no_memory(error);
    mark_stressed(&w->ctx.scene.couple.convert, elements, excess, kind);
    mark_broken(&w->dem, place, kind);
    gn_free(place);
    for (size_t e = 0; e < elements; e++) any = any || kind[e] == GN_FRONT_LEAVING;
    return any ? gn_conversion_convert(w, kind, error) : GNEISS_OK;
}

static void note_most_loaded(const gn_step_context *ctx, const gn_solids *solids,
                             const double *excess, gn_most_loaded *most) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    size_t at = 0;
    for (size_t e = 1; e < b->elements.soa.count; e++)
        if (excess[e] > excess[at]) at = e;
    if (!b->elements.soa.count || !(excess[at] > most->share)) return;
    *most = (gn_most_loaded){.share = excess[at], .time = ctx->time, .element = b->elements.id[at]};
    gn_conversion_centre(b, at, most->place);
}

gneiss_status gn_conversion_look_around(const gn_step_context *ctx, const gn_solids *solids,
                                        const gn_most_loaded *most_loaded, uint8_t **kind,
                                        double **excess, gneiss_error *error) {
    const size_t elements = gn_conversion_elements(solids);
    *kind = gn_alloc(elements + 1);
    *excess = gn_alloc_array(elements + 1, sizeof **excess);
    if (!*kind || !*excess) return no_memory(error);
    GN_TRY(gn_conversion_kinds(ctx, solids, *kind, error));
    return find_excess(ctx, solids, most_loaded, *kind, *excess, error);
}

gneiss_status gn_conversion_convert_above(gn_world *w, double part, gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    bool any = false;
    w->most_loaded.share = 0.0; /* loads below the largest so far count as well */
    gneiss_status status =
        gn_conversion_look_around(&w->ctx, &w->solids, &w->most_loaded, &kind, &excess, error);
    for (size_t e = 0; status == GNEISS_OK && e < gn_conversion_elements(&w->solids); e++)
        if (kind[e] == GN_FRONT_READY && excess[e] > 0.0 && excess[e] >= part) {
            kind[e] = GN_FRONT_LEAVING;
            any = true;
        }
    if (any) status = gn_conversion_convert(w, kind, error);
    gn_free(kind);
    gn_free(excess);
    return status;
}

static gneiss_status look(gn_world *w, gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    gneiss_status status =
        gn_conversion_look_around(&w->ctx, &w->solids, &w->most_loaded, &kind, &excess, error);
    if (status == GNEISS_OK) note_most_loaded(&w->ctx, &w->solids, excess, &w->most_loaded);
    if (status == GNEISS_OK && is_due(&w->dem, &w->solids, excess))
        status = act(w, excess, kind, error);
    gn_free(kind);
    gn_free(excess);
    return status;
}

gneiss_status gn_conversion_most_loaded(const gn_step_context *ctx, const gn_solids *solids,
                                        const gn_most_loaded *most_loaded, gn_most_loaded *most,
                                        gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    gneiss_status status =
        gn_conversion_look_around(ctx, solids, most_loaded, &kind, &excess, error);
    *most = *most_loaded;
    if (status == GNEISS_OK) note_most_loaded(ctx, solids, excess, most);
    gn_free(kind);
    gn_free(excess);
    return status;
}

/* What books itself on the way. */
static double other_seconds(const double *seconds) {
    return seconds[GN_PHASE_lists] + seconds[GN_PHASE_step_limit];
}

gneiss_status gn_conversion_look(gn_world *w, gneiss_error *error) {
    if (w->ctx.step == 0 || w->ctx.step % w->ctx.scene.couple.convert.every != 0) return GNEISS_OK;
    const double start = gn_now(), others = other_seconds(w->seconds);
    gneiss_status status = look(w, error);
    w->seconds[GN_PHASE_conversion] += gn_now() - start - (other_seconds(w->seconds) - others);
    return status;
}
