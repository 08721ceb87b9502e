/* The part of a checkpoint for walls, bodies and the contacts with them. */
#include "base/error.h"
#include "base/memory.h"
#include "boundary/body_pairs.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "io/h5_pieces.h"
#include "run/checkpoint_internal.h"
#include "run/part_files.h"
#include "soa/field.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "world/world.h"

#include <stdint.h>
#include <string.h>

#define DOUBLES(member) GN_PIECE_DOUBLES("world.boundary.", gn_boundary, member)

static const gn_piece pieces[] = {DOUBLES(pairs.deepest), DOUBLES(pairs.pushed)};
enum { PIECES = sizeof pieces / sizeof *pieces, MOST_ARRAYS = 6 };

_Static_assert(sizeof(gn_wall) % 8 == 0 && sizeof(gn_rigid) % 8 == 0 &&
                   sizeof(gn_body_pair) % 8 == 0,
               "made of doubles only");

static size_t list_arrays(gn_world *world, gn_checkpoint_array out[MOST_ARRAYS]) {
    gn_boundary *b = &world->boundary;
    size_t n = 0, bodies = world->ctx.scene.body_count;
    out[n++] = GN_CHECKPOINT_ARRAY("walls", GN_F64, world->ctx.scene.wall_count,
                                   sizeof(gn_wall) / 8, &b->walls);
    if (!bodies) return n;
    out[n++] = GN_CHECKPOINT_ARRAY("bodies", GN_F64, bodies, sizeof(gn_rigid) / 8, &b->bodies);
    out[n++] = GN_CHECKPOINT_ARRAY("body_shape", GN_I64, bodies, 3, &b->body_shape);
    out[n++] = GN_CHECKPOINT_ARRAY("body_vertex", GN_F64, b->body_vertex_count, 4, &b->body_vertex);
    out[n++] = GN_CHECKPOINT_ARRAY("body_corner", GN_I32, b->body_corner_count, 1, &b->body_corner);
    if (b->pairs.count)
        out[n++] = GN_CHECKPOINT_ARRAY("body_pairs", GN_F64, b->pairs.count,
                                       sizeof(gn_body_pair) / 8, &b->pairs.pair);
    return n;
}

gneiss_status gn_checkpoint_put_boundary(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_world *w =
        (gn_world *)(uintptr_t)world; /* list_arrays returns pointers that are not const */
    gn_checkpoint_array arrays[MOST_ARRAYS];
    size_t count = list_arrays(w, arrays);
    GN_TRY(gn_h5_put_pieces(file, "run", pieces, PIECES, &w->boundary, error));
    GN_TRY(gn_checkpoint_put_arrays(file, arrays, count, error));
    if (!(w->ctx.effects & GN_FX_WALLS)) return GNEISS_OK;
    GN_TRY(gn_h5_put_record(file, "wall_contacts", &gn_wall_contact_record, &w->boundary.contacts,
                            error));
    if (!w->boundary.body_contacts.soa.count) return GNEISS_OK;
    return gn_h5_put_record(file, "body_contacts", &gn_wall_contact_record,
                            &w->boundary.body_contacts, error);
}

/* --- reading --- */

/* Checks that the facets of each body use its own vertices, and that all of them are within the
 * arrays. */
static bool good_bodies(const gn_world *world) {
    size_t corners = (size_t)world->ctx.scene.dimension, vertices = 0, facets = 0;
    for (size_t k = 0; k < world->ctx.scene.body_count; k++) {
        const int64_t *shape = world->boundary.body_shape[k];
        if (shape[0] < 0 || shape[0] > INT32_MAX || shape[1] < 1 || shape[1] > INT32_MAX)
            return false;
        size_t begin = corners * facets, end = begin + corners * (size_t)shape[1];
        vertices += (size_t)shape[0];
        facets += (size_t)shape[1];
        if (end > world->boundary.body_corner_count) return false;
        for (size_t c = begin; c < end; c++)
            if (world->boundary.body_corner[c] < 0 || world->boundary.body_corner[c] >= shape[0])
                return false;
    }
    return vertices == world->boundary.body_vertex_count &&
           corners * facets == world->boundary.body_corner_count;
}

static bool good_contacts(const gn_world *world) {
    const gn_wall_contacts *q = &world->boundary.contacts;
    bool good = true;
    for (size_t c = 0; c < q->soa.count; c++)
        good = good && q->i[c] >= 0 && (size_t)q->i[c] < world->dem.particles.soa.count &&
               q->wall[c] >= 0; /* check_facets compares it with the number of walls */
    q = &world->boundary.body_contacts;
    for (size_t c = 0; c < q->soa.count; c++)
        good = good && q->i[c] >= 0 && (size_t)q->i[c] < world->boundary.body_vertex_count &&
               q->wall[c] >= 0 && (size_t)q->wall[c] < world->ctx.scene.wall_count;
    const gn_body_pairs *p = &world->boundary.pairs;
    const double named[] = {p->deepest.first, p->deepest.second, p->pushed.first, p->pushed.second};
    for (size_t k = 0; k < 4; k++)
        good = good && named[k] >= 0.0 && named[k] <= (double)world->ctx.scene.body_count &&
               (named[k] < (double)world->ctx.scene.body_count || named[k] == 0.0);
    for (size_t k = 0; k < p->count; k++)
        good = good && p->pair[k].first >= 0.0 && p->pair[k].first < p->pair[k].second &&
               p->pair[k].second < (double)world->ctx.scene.body_count;
    return good;
}

gneiss_status gn_checkpoint_get_boundary(gn_world *world, const gn_h5 *file, const char *path,
                                         gneiss_error *error) {
    gn_boundary *b = &world->boundary;
    gn_checkpoint_array arrays[MOST_ARRAYS];
    GN_TRY(gn_h5_get_pieces(file, "run", pieces, PIECES, b, error));
    if (world->ctx.scene.body_count) {
        GN_TRY(gn_h5_rows(file, "arrays/body_vertex", &b->body_vertex_count, error));
        GN_TRY(gn_h5_rows(file, "arrays/body_corner", &b->body_corner_count, error));
        if (gn_h5_has(file, "arrays/body_pairs"))
            GN_TRY(gn_h5_rows(file, "arrays/body_pairs", &b->pairs.count, error));
    }
    size_t count = list_arrays(world, arrays);
    GN_TRY(gn_checkpoint_get_arrays(file, arrays, count, error));
    if (world->ctx.effects & GN_FX_WALLS)
        GN_TRY(gn_h5_get_record(file, "wall_contacts", &gn_wall_contact_record, &b->contacts,
                                world->ctx.effects, error));
    if (gn_h5_has(file, "body_contacts"))
        GN_TRY(gn_h5_get_record(file, "body_contacts", &gn_wall_contact_record, &b->body_contacts,
                                gn_body_wall_effects(&world->ctx), error));
    if (good_bodies(world) && good_contacts(world)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected particle numbers below %zu, found others", path,
                   world->dem.particles.soa.count);
}

static gneiss_status check_facets(const gn_world *world, const char *path, gneiss_error *error) {
    size_t all = world->ctx.scene.wall_count;
    bool good = true;
    for (size_t k = 0; k < world->boundary.surface_count; k++)
        all += world->boundary.surfaces[k].facets.count;
    for (size_t c = 0; c < world->boundary.contacts.soa.count; c++)
        good = good && (size_t)world->boundary.contacts.wall[c] < all;
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: expected walls and facets below %zu, found others", path, all);
}

gneiss_status gn_checkpoint_get_surfaces(gn_world *world, const char *path, gneiss_error *error) {
    GN_TRY(gn_bodies_surfaces(&world->ctx, &world->boundary, world->solids.count, error));
    GN_TRY(gn_element_contact_create(&world->ctx, &world->boundary, &world->solids, error));
    return check_facets(world, path, error);
}
