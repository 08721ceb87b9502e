/* Walls, rigid bodies and surfaces as one part of the world. */
#include "boundary/boundary.h"

#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/body_pairs.h"
#include "boundary/body_walls.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "frame/balance.h"
#include "frame/frame.h"
#include "kernels/partials.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "soa/field.h"
#include "soa/records.h"
#include "surfaces/facet.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* --- create, free --- */

gneiss_status gn_boundary_create(const gn_step_context *ctx, const gn_dem *dem,
                                 gn_boundary *boundary, size_t deforming, gneiss_error *error) {
    GN_TRY(gn_walls_create(ctx, dem, boundary, error));
    GN_TRY(gn_bodies_create(ctx, boundary, deforming, error));
    GN_TRY(gn_body_walls_check(ctx, boundary, error));
    return gn_body_pairs_check(ctx, boundary, error);
}

void gn_boundary_enter(const gn_step_context *ctx, gn_boundary *boundary) {
    for (size_t k = 0; k < boundary->surface_count; k++) {
        gn_surface *s = &boundary->surfaces[k];
        if (s->body >= 0) s->friction = ctx->scene.bodies[s->body].friction;
        if (s->body >= 0) s->kratio = ctx->scene.bodies[s->body].kratio;
    }
}

gneiss_status gn_boundary_add_surface(gn_boundary *boundary, const gn_surface *surface,
                                      gneiss_error *error) {
    gn_boundary *b = boundary;
    gn_surface *s = &b->surfaces[b->surface_count], *last = b->surface_count ? s - 1 : NULL;
    *s = *surface;
    s->first = last ? last->first + (int32_t)last->facets.count : 0;
    b->surface_count++;
    if (s->body < 0) {
        s->force = gn_alloc_array(s->vertices + 1, 4 * sizeof *s->force);
        if (!s->force)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu vertices", s->vertices);
    }
    return gn_facet_tree_build(&s->facets, &s->tree, error);
}

void gn_boundary_free(gn_boundary *b) {
    gn_soa_destroy(&gn_wall_contact_record, &b->contacts);
    gn_soa_destroy(&gn_wall_contact_record, &b->body_contacts);
    gn_body_pairs_free(&b->pairs);
    for (size_t k = 0; k < b->surface_count; k++) {
        gn_facet_tree_free(&b->surfaces[k].tree);
        gn_free(b->surfaces[k].force);
    }
    void *blocks[] = {b->first,    b->sums,       b->walls,       b->wall_normals, b->bodies,
                      b->surfaces, b->body_shape, b->body_vertex, b->body_corner,  b->vertex_part};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *b = (gn_boundary){0};
}

void gn_boundary_set_holder(gn_boundary *boundary, gn_holder holder) {
    boundary->holder = holder;
}

/* --- lists --- */

void gn_boundary_resized(gn_boundary *b) {
    gn_free(b->first);
    gn_free(b->sums);
    b->first = NULL;
    b->sums = NULL;
}

static gneiss_status ready_sums(gn_dem *dem, gn_boundary *boundary, gneiss_error *error) {
    size_t blocks = gn_blocks(dem->particles.soa.count, GN_PARTICLE_BLOCK);
    gn_boundary *b = boundary;
    if (!b->sums) b->sums = gn_alloc_array(blocks + 1, sizeof *b->sums);
    return b->sums ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for block sums");
}

gneiss_status gn_boundary_refresh(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  bool first, gneiss_error *error) {
    GN_TRY(ready_sums(dem, boundary, error));
    GN_TRY(gn_wall_contacts_find(ctx, dem, boundary, first, error));
    GN_TRY(gn_body_walls_find(ctx, dem, boundary, first, error));
    return gn_body_pairs_find(ctx, dem, boundary, first, error);
}

gneiss_status gn_boundary_restore(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gneiss_error *error) {
    size_t n = dem->particles.soa.count;
    gn_boundary *b = boundary;
    GN_TRY(gn_new(&b->first, n + 2, "wall contacts", error));
    for (size_t c = 0; c < b->contacts.soa.count; c++) b->first[b->contacts.i[c] + 1]++;
    for (size_t p = 1; p <= n; p++) b->first[p] += b->first[p - 1];
    GN_TRY(gn_walls_list_normals(ctx, boundary, error));
    return ready_sums(dem, boundary, error);
}

gneiss_status gn_boundary_renumber(gn_boundary *boundary, const int32_t *place,
                                   gneiss_error *error) {
    gn_wall_contacts *list = &boundary->contacts, now = {0};
    size_t count = list->soa.count;
    if (!count) return GNEISS_OK;
    gn_renamed *keys = gn_alloc_array(count + 1, sizeof *keys);
    if (!keys) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu contacts", count);
    for (size_t c = 0; c < count; c++)
        keys[c] = (gn_renamed){place[list->i[c]], list->wall[c], (int32_t)c, false};
    gneiss_status status = gn_sort_renamed(&gn_wall_contact_record, list, &now, keys, error);
    for (size_t c = 0; status == GNEISS_OK && c < count; c++) now.i[c] = keys[c].i;
    if (status == GNEISS_OK) *list = now;
    gn_free(keys);
    return status;
}

double gn_boundary_travel(const gn_step_context *ctx, gn_boundary *boundary, bool exact) {
    double wall = 0.0;
    for (size_t k = 0; k < ctx->scene.wall_count; k++) wall = fmax(wall, boundary->walls[k].travel);
    return fmax(wall, gn_surfaces_travel(boundary, exact));
}

/* --- step --- */

bool gn_boundary_work(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, size_t block,
                      size_t first, size_t last) {
    gn_boundary *b = boundary;
    size_t begin = (size_t)b->first[first], end = (size_t)b->first[last];
    b->sums[block] = (gn_contact_sums){0};
    gn_wall_contacts_work(ctx, dem, boundary, begin, end, &b->sums[block]);
    return begin < end;
}

void gn_boundary_forces(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary) {
    gn_walls_sum(ctx, dem, boundary);
    gn_surfaces_sum(ctx, boundary);
    gn_body_walls_work(ctx, boundary);
    gn_body_pairs_work(ctx, boundary);
}

void gn_boundary_kick(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                      gn_ledger *ledger) {
    gn_bodies_kick(ctx, dem, boundary, ledger);
}

void gn_boundary_move(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary,
                      gn_ledger *ledger) {
    gn_walls_move(ctx, dem, boundary);
    gn_bodies_drift(ctx, boundary, ledger);
}

void gn_boundary_book(const gn_step_context *ctx, const gn_boundary *boundary, gn_half half,
                      gn_energy *ledger) {
    double dt = half == GN_HALF_BEFORE ? ctx->dt_past : ctx->dt;
    gn_walls_book(ctx, boundary, dt, ledger);
    gn_bodies_book(ctx, boundary, dt, ledger);
}

void gn_boundary_measure(const gn_step_context *ctx, const gn_boundary *boundary,
                         gn_energy *ledger) {
    double translation, rotation;
    gn_bodies_kinetic(ctx, boundary, &translation, &rotation);
    ledger->kinetic += translation;
    ledger->rotational += rotation;
}

/* Adds the balance of a body along its free directions. */
static void add_body(const gn_step_context *ctx, const gn_body_def *def, const gn_rigid *b,
                     gn_balance *balance) {
    double resultant[3] = {0}, weight[3] = {0}, pressed[3] = {0};
    bool is_free = false;
    for (int a = 0; a < 3; a++) {
        if (!(b->inverse_mass[a] > 0.0)) continue;
        is_free = true;
        weight[a] = b->mass * ctx->scene.gravity[a] + def->force[a];
        pressed[a] = b->force[a];
        resultant[a] = weight[a] + pressed[a];
    }
    const double rest = sqrt(gn_dot3(resultant, resultant)),
                 touch = sqrt(gn_dot3(b->force, b->force));
    if (!is_free) return;
    balance->carries |= touch > 0.0;
    balance->falls |= touch == 0.0 && rest > 0.0;
    if (touch > 0.0)
        balance->ratio =
            fmax(balance->ratio, rest / (sqrt(gn_dot3(weight, weight)) +
                                         sqrt(gn_dot3(pressed, pressed)) + balance->force));
}

void gn_boundary_balance(const gn_step_context *ctx, const gn_boundary *boundary,
                         gn_balance *balance) {
    for (size_t k = 0; k < ctx->scene.body_count; k++)
        add_body(ctx, &ctx->scene.bodies[k], &boundary->bodies[k], balance);
}

/* --- hash and sums of the part --- */

uint64_t gn_boundary_hash(const gn_step_context *ctx, const gn_boundary *boundary, uint64_t h) {
    h = gn_soa_hash(&gn_wall_contact_record, &boundary->contacts, h);
    if (boundary->body_contacts.soa.count)
        h = gn_soa_hash(&gn_wall_contact_record, &boundary->body_contacts, h);
    h = gn_body_pairs_hash(&boundary->pairs, h);
    for (size_t k = 0; k < ctx->scene.wall_count; k++)
        h = gn_hash_bytes(boundary->walls[k].point, sizeof boundary->walls[k].point, h);
    for (size_t k = 0; k < ctx->scene.body_count; k++)
        h = gn_hash_bytes(&boundary->bodies[k], offsetof(gn_rigid, mass), h);
    return h;
}

size_t gn_boundary_bytes(const gn_step_context *ctx, const gn_boundary *boundary) {
    return boundary->contacts.soa.capacity *
               gn_record_bytes(&gn_wall_contact_record, ctx->effects) +
           boundary->body_contacts.soa.capacity *
               gn_record_bytes(&gn_wall_contact_record, gn_body_wall_effects(ctx));
}

gn_assembly gn_assembly_of(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary) {
    gn_assembly a = {0};
    gn_ranks_whole(ctx->ranks);
    gn_active_pairs_settle(ctx, dem);
    a.dimension = (int)ctx->scene.dimension;
    a.particles = &dem->particles;
    for (int l = 0; l < GN_LIST_COUNT; l++) a.list[l] = &dem->list[l].contacts;
    a.wall_contacts = ctx->effects & GN_FX_WALLS ? &boundary->contacts : NULL;
    a.wall_count = ctx->scene.wall_count;
    a.wall_normals = boundary->wall_normals;
    a.periodic = ctx->effects & GN_FX_PERIODIC;
    memcpy(a.period, ctx->period, sizeof a.period);
    return a;
}
