#include "world/ranks.h"

#include "base/new.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "particles/active_pairs.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "ranks/ranks.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "soa/records.h"
#include "world/world.h"

#include <string.h>

/* --- what ranks cannot do --- */

static gneiss_status refuse(const gn_scene *scene, gn_scene_place where, const char *key,
                            const char *what, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a scene for several ranks of MPI, found %s, which run in a single "
                   "process only",
                   gn_scene_at(scene, where, key).text, what);
}

static gneiss_status check_box(const gn_scene *s, gneiss_error *error) {
    static const char *const key[] = {"periodic.x", "periodic.y", "periodic.z"};
    for (int a = 0; a < 3; a++)
        if (s->box[a].rate.count || s->box[a].stress.count)
            return refuse(s, s->periodic_where, key[a], "periodic boxes that move", error);
    return GNEISS_OK;
}

static gneiss_status check_scene(const gn_scene *s, gneiss_error *error) {
    if (s->has_elements) return refuse(s, s->elements.where, "elements", "finite elements", error);
    if (s->has_clumps) return refuse(s, s->clumps.where, "clumps", "clumps", error);
    if (s->has_membrane) return refuse(s, s->membrane.where, "membrane", "membranes", error);
    if (gn_scene_test(s)->tool) return refuse(s, s->test.where, "test", "tests of tools", error);
    if (s->confinement == GN_CONFINEMENT_MEAN)
        return refuse(s, s->law_where, "law.confinement", "bonds under the mean pressure", error);
    if (s->cohesion == GN_COHESION_LIQUID)
        return refuse(s, s->law_where, "law.cohesion", "liquid bridges", error);
    if (s->start == GN_START_FIRST_BREAK)
        return refuse(s, s->start_where, "time.start", "starts at the first break", error);
    return check_box(s, error);
}

gneiss_status gn_world_check_ranks(const gn_step_context *ctx, gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    if (!ctx->ranks) return GNEISS_OK;
    GN_TRY(check_scene(&ctx->scene, error));
    for (size_t k = 1; k < ctx->given.stage_count; k++) {
        gn_scene_delete(&scene);
        GN_TRY(gn_new(&scene, 1, "a stage", error));
        GN_TRY(gn_scene_stage(&ctx->given, k, scene, error));
        GN_TRY(check_scene(scene, error));
    }
    return GNEISS_OK;
}

/* --- what all ranks know in a step --- */

enum { SUM_PARTS = GN_LIST_COUNT + 3, FORCE_PARTS = 10 };

/* Sums of blocks. */
static size_t parts_of_sums(gn_world *world, gn_rank_part *part) {
    const gn_ranks *r = world->ctx.ranks;
    gn_dem *d = &world->dem;
    gn_boundary *b = &world->boundary;
    size_t n = 0;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        part[n++] = (gn_rank_part){d->list[l].sums, sizeof *d->list[l].sums, r->item_block[l], 0};
    part[n++] = (gn_rank_part){d->motion_sums, sizeof *d->motion_sums, r->block, NULL};
    if (d->near.on)
        part[n++] = (gn_rank_part){d->near.count, sizeof *d->near.count,
                                   r->item_block[GN_LIST_PAIRS], NULL};
    if (world->ctx.effects & GN_FX_WALLS)
        part[n++] = (gn_rank_part){b->sums, sizeof *b->sums, r->wall_block_first, r->wall_block};
    return n;
}

/* The points where particles touch rigid bodies, and the moments of rolling resistance there. */
static size_t parts_of_bodies(gn_world *world, gn_rank_part *part) {
    const gn_ranks *r = world->ctx.ranks;
    const gn_wall_contacts *q = &world->boundary.contacts;
    double *const columns[] = {q->touch, q->roll};
    size_t n = 0;
    for (size_t k = 0; k < 2; k++)
        for (size_t a = 0; columns[k] && a < 3; a++)
            part[n++] = (gn_rank_part){columns[k] + a * q->soa.capacity, sizeof(double),
                                       r->wall_contact, NULL};
    return n;
}

/* Positions and velocities of the particles near walls, which servos read. */
static size_t parts_of_servos(gn_world *world, gn_rank_part *part) {
    const gn_ranks *r = world->ctx.ranks;
    const gn_particles *q = &world->dem.particles;
    bool any = false;
    for (size_t k = 0; k < world->ctx.scene.wall_count; k++)
        any |= world->ctx.scene.walls[k].servo.active;
    if (!any) return 0;
    part[0] =
        (gn_rank_part){q->pos, 4 * sizeof *q->pos, r->wall_contact, world->boundary.contacts.i};
    part[1] =
        (gn_rank_part){q->vel, 4 * sizeof *q->vel, r->wall_contact, world->boundary.contacts.i};
    return 2;
}

/* Forces of walls and bodies, loads of prescribed particles. */
static size_t parts_of_forces(gn_world *world, gn_rank_part *part) {
    const gn_ranks *r = world->ctx.ranks;
    const gn_wall_contacts *q = &world->boundary.contacts;
    gn_prescription *f = &world->dem.prescribed;
    size_t n = 0;
    if (world->ctx.effects & GN_FX_WALLS) {
        part[n++] = (gn_rank_part){q->row, 8 * sizeof *q->row, r->wall_contact, NULL};
        n += parts_of_servos(world, part + n);
        n += parts_of_bodies(world, part + n);
    }
    if (f->count)
        part[n++] =
            (gn_rank_part){f->load, 6 * sizeof *f->load, r->prescribed_first, r->prescribed};
    return n;
}

/* Without readings, forces on walls at rest have no effect. */
static bool needs_forces(const gn_world *world) {
    const gn_scene *s = &world->ctx.scene;
    bool moves = false;
    for (size_t k = 0; k < s->wall_count; k++) {
        const gn_wall_def *wall = &s->walls[k];
        moves |= wall->servo.active;
        for (int a = 0; a < 3; a++) moves |= wall->motion.velocity[a].count > 0;
    }
    return moves || s->body_count || gn_scene_tested(s) || world->ctx.measure || world->ctx.sums;
}

/* Sorts the slots of prescribed particles by ranks. */
static gneiss_status list_prescribed(gn_ranks *r, const gn_dem *dem, gneiss_error *error) {
    size_t n = 0;
    gn_free(r->prescribed);
    GN_TRY(gn_new(&r->prescribed, dem->prescribed.count + 1, "prescribed particles", error));
    for (int k = 0; k < r->count; k++) {
        for (size_t p = r->particle[k]; p < r->particle[k + 1]; p++)
            if (dem->particles.slot[p] >= 0) r->prescribed[n++] = dem->particles.slot[p];
        r->prescribed_first[k + 1] = n;
    }
    return GNEISS_OK;
}

/* Lists the blocks of particles that have contacts with walls; the sums of the others are zero. */
static gneiss_status list_walls(gn_ranks *r, gn_boundary *boundary, gneiss_error *error) {
    const int32_t *first = boundary->first;
    gn_contact_sums *sums = boundary->sums;
    size_t n = 0;
    gn_free(r->wall_block);
    GN_TRY(gn_new(&r->wall_block, r->block[r->count] + 1, "blocks near walls", error));
    r->wall_contact[0] = 0;
    for (int k = 0; k < r->count; k++) {
        for (size_t b = r->block[k]; b < r->block[k + 1]; b++) {
            const size_t p = b * GN_PARTICLE_BLOCK, end = p + GN_PARTICLE_BLOCK;
            sums[b] = (gn_contact_sums){0};
            if (first[end < r->particles ? end : r->particles] > first[p])
                r->wall_block[n++] = (int32_t)b;
        }
        r->wall_block_first[k + 1] = n;
        r->wall_contact[k + 1] = (size_t)first[r->particle[k + 1]];
    }
    return GNEISS_OK;
}

gneiss_status gn_world_share_lists(gn_world *world, gneiss_error *error) {
    gn_ranks *r = world->ctx.ranks;
    gn_rank_part sums[SUM_PARTS], forces[FORCE_PARTS];
    if (world->ctx.effects & GN_FX_WALLS) GN_TRY(list_walls(r, &world->boundary, error));
    if (world->dem.prescribed.count) GN_TRY(list_prescribed(r, &world->dem, error));
    GN_TRY(gn_ranks_plan_share(r, &r->sums, sums, parts_of_sums(world, sums), error));
    return gn_ranks_plan_share(r, &r->forces, forces, parts_of_forces(world, forces), error);
}

/* --- the whole state --- */

/* Columns that are the same on all ranks, or that the next evaluation fills. */
static const char *const known[] = {"i", "j", "happened", "released", "row4", "row8", NULL};
static const char *const known_of_particles[] = {"start",  "ref",  "id",    "material", "group",
                                                 "bonds0", "slot", "marks", NULL};
static const char *const known_of_walls[] = {"i", "wall", NULL};

/* Columns of packed pairs are in place on the rank of their block. */
static void settle_pairs(gn_world *world) {
    gn_ranks *r = world->ctx.ranks;
    gn_active_pairs *n = &world->dem.near;
    size_t *bytes = r->range;
    if (!n->on) return;
    for (int k = 0; k <= r->count; k++)
        bytes[k] = r->item_block[GN_LIST_PAIRS][k] * (n->stride / GN_NEAR_GROUP);
    r->transport->gather(n->act, bytes);
    gn_active_pairs_settle(&world->ctx, &world->dem);
}

/* Finds what gn_boundary_forces and the sum of reactions found from outdated rows. */
static void find_forces(gn_world *world) {
    gn_ranks *r = world->ctx.ranks;
    gn_rank_part part[FORCE_PARTS];
    const size_t parts = parts_of_forces(world, part);
    gn_ranks_begin_share(r, &r->forces, part, parts);
    gn_ranks_end_share(r, &r->forces, part, parts);
    gn_boundary_forces(&world->ctx, &world->dem, &world->boundary);
    if (world->ctx.effects & GN_FX_PRESCRIBED) gn_reactions_sum(&world->ctx, &world->dem);
    r->forces_known = true;
}

static void gather_all(void *context) {
    gn_world *world = context;
    gn_ranks *r = world->ctx.ranks;
    gn_dem *d = &world->dem;
    settle_pairs(world);
    gn_ranks_gather_record(r, &gn_particle_record, &d->particles, r->particle, known_of_particles);
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contacts *list = &d->list[l].contacts;
        const size_t length = d->list[l].partials.length;
        for (int k = 0; k <= r->count; k++) {
            const size_t first = r->item_block[l][k] * length;
            r->range[k] = first < list->soa.count ? first : list->soa.count;
        }
        gn_ranks_gather_record(r, &gn_contact_record, list, r->range, known);
    }
    if (world->ctx.effects & GN_FX_WALLS)
        gn_ranks_gather_record(r, &gn_wall_contact_record, &world->boundary.contacts,
                               r->wall_contact, known_of_walls);
    r->whole = true;
    if (!r->forces_known) find_forces(world);
}

/* --- a step --- */

void gn_world_begin_exchange(gn_world *world) {
    gn_ranks *r = world->ctx.ranks;
    r->gather = gather_all;
    r->context = world;
    gn_ranks_begin_step(r);
}

/* Pairs of other ranks were not searched: none of them is packed here. */
static void clear_pairs_of_others(const gn_ranks *r, gn_active_pairs *near) {
    const size_t bytes = near->stride / GN_NEAR_GROUP;
    const size_t *own = r->item_block[GN_LIST_PAIRS] + r->rank;
    if (!near->on || !near->look) return;
    memset(near->act, 0, own[0] * bytes);
    memset(near->act + own[1] * bytes, 0, (near->blocks - own[1]) * bytes);
}

void gn_world_take_rows(gn_world *world) {
    clear_pairs_of_others(world->ctx.ranks, &world->dem.near);
    gn_ranks_take_rows(world->ctx.ranks);
}

void gn_world_share_step(gn_world *world) {
    gn_ranks *r = world->ctx.ranks;
    gn_rank_part sums[SUM_PARTS], forces[FORCE_PARTS];
    const size_t sum_count = parts_of_sums(world, sums),
                 force_count = parts_of_forces(world, forces);
    r->forces_known = needs_forces(world);
    gn_ranks_begin_share(r, &r->sums, sums, sum_count);
    if (r->forces_known) gn_ranks_begin_share(r, &r->forces, forces, force_count);
    gn_ranks_exchange_places(r);
    gn_ranks_end_share(r, &r->sums, sums, sum_count);
    if (r->forces_known) gn_ranks_end_share(r, &r->forces, forces, force_count);
}
