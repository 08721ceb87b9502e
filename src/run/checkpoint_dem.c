/* The part of a checkpoint for particles. */
#include "base/effects.h"
#include "base/error.h"
#include "base/new.h"
#include "conversion/conversion.h"
#include "io/h5_pieces.h"
#include "particles/active_pairs.h"
#include "particles/particles.h"
#include "run/checkpoint_internal.h"
#include "run/part_files.h"
#include "soa/field.h"
#include "soa/records.h"
#include "world/world.h"

#include <math.h>
#include <stdint.h>

#define DOUBLES(member) GN_PIECE_DOUBLES("world.dem.", gn_dem, member)
#define INTEGER(member) GN_PIECE_INTEGER("world.dem.", gn_dem, member)
#define CHOSEN(member)  GN_PIECE_DOUBLES("world.dem.", gn_step_choice, member)
#define LIMIT(member)   GN_PIECE_ANY("world.dem.", gn_step_choice, member)

static const gn_piece pieces[] = {
    INTEGER(broken_tension),
    INTEGER(broken_shear),
    INTEGER(broken_joints),
    INTEGER(bonds_at_start),
    INTEGER(lost),
    INTEGER(ids),
    INTEGER(made),
    INTEGER(contact_steps),
    DOUBLES(verlet.skin),
    DOUBLES(verlet.skin_start),
    DOUBLES(verlet.widened),
    DOUBLES(verlet.drift),
    DOUBLES(verlet.closed),
    DOUBLES(verlet.reach),
    INTEGER(verlet.rebuilds),
    INTEGER(verlet.last_step),
    DOUBLES(derived),
    GN_PIECE_ANY("world.dem.", gn_dem, radius_min),
    GN_PIECE_ANY("world.dem.", gn_dem, done.motion.speed2),
    DOUBLES(depth),
};
static const gn_piece choice_pieces[] = {
    LIMIT(listed),
    LIMIT(listed_holds),
    LIMIT(resolution.step),
    LIMIT(resolution.contact),
    GN_PIECE_INTEGER("world.dem.", gn_step_choice, resolution.first),
    GN_PIECE_INTEGER("world.dem.", gn_step_choice, resolution.second),
    LIMIT(stable),
    LIMIT(limit.bound),
    LIMIT(limit.sharp),
    LIMIT(limit.sharp_low),
    LIMIT(limit.frequency),
    LIMIT(limit.literature),
    CHOSEN(whole),
    CHOSEN(surface_rate),
    CHOSEN(vertex_rate),
    CHOSEN(push),
    CHOSEN(scaling.unscaled),
    CHOSEN(scaling.step),
    CHOSEN(scaling.reached),
};
enum {
    PIECES = sizeof pieces / sizeof *pieces,
    CHOICE_PIECES = sizeof choice_pieces / sizeof *choice_pieces,
    MOST_ARRAYS = 14
};

static size_t list_arrays(gn_world *world, gn_checkpoint_array out[MOST_ARRAYS]) {
    size_t n = 0;
    gn_prescription *f = &world->dem.prescribed;
    if (world->ctx.effects & GN_FX_MEMBRANE) {
        out[n++] =
            GN_CHECKPOINT_MEMBERS("membrane", GN_F64, 1, offsetof(gn_membrane_state, bodies) / 8,
                                  &world->membrane.state, gn_membrane_state, pressure);
        out[n++] = GN_CHECKPOINT_MEMBERS("membrane_bodies", GN_I64, 1, 1, &world->membrane.state,
                                         gn_membrane_state, bodies);
        out[n++] = GN_CHECKPOINT_MEMBERS("patches", GN_F64, world->membrane.patch_count,
                                         offsetof(gn_patch, owner) / 8, &world->membrane.patches,
                                         gn_patch, point);
        out[n++] = GN_CHECKPOINT_MEMBERS("patch_owners", GN_I32, world->membrane.patch_count, 2,
                                         &world->membrane.patches, gn_patch, owner);
    }
    if (world->ctx.effects & GN_FX_CLUMPS) {
        gn_clumps *c = &world->dem.clumps;
        out[n++] = GN_CHECKPOINT_ARRAY("clumps", GN_F64, c->count, sizeof(gn_clump) / 8, &c->clump);
        out[n++] = GN_CHECKPOINT_ARRAY("clump_members", GN_F64, c->member_count,
                                       sizeof(gn_clump_member) / 8, &c->member);
    }
    if (world->ctx.effects & GN_FX_HERTZ && world->ctx.scene.has_specimen)
        out[n++] = GN_CHECKPOINT_ARRAY("driven", GN_F64,
                                       world->ctx.scene.wall_count + world->ctx.scene.body_count +
                                           world->ctx.scene.set_count,
                                       1, &world->dem.driven);
    if (!(world->ctx.effects & GN_FX_PRESCRIBED)) return n;
    out[n++] = GN_CHECKPOINT_ARRAY("prescribed_set", GN_I32, f->count, 1, &f->set);
    out[n++] = GN_CHECKPOINT_ARRAY("prescribed_mask", GN_U8, f->count, 1, &f->mask);
    out[n++] = GN_CHECKPOINT_ARRAY("prescribed_velocity", GN_F64, f->count, 6, &f->velocity);
    out[n++] = GN_CHECKPOINT_ARRAY("prescribed_load", GN_F64, f->count, 6, &f->load);
    out[n++] = GN_CHECKPOINT_ARRAY("channel_set", GN_I32, f->count, 6, &world->dem.channel_set);
    out[n++] = GN_CHECKPOINT_ARRAY("set_reaction", GN_F64, world->ctx.scene.set_count, 6,
                                   &world->dem.set_reaction);
    return n;
}

enum { PATH = sizeof(gn_near_path) / 8 };

enum { DORMANT_ARRAYS = 2 };

static void list_dormant(gn_dormant_particle **rows, size_t count,
                         gn_checkpoint_array out[DORMANT_ARRAYS]) {
    out[0] =
        GN_CHECKPOINT_MEMBERS("sleepers", GN_F64, count, offsetof(gn_dormant_particle, element) / 8,
                              rows, gn_dormant_particle, inverse_mass);
    out[1] = GN_CHECKPOINT_MEMBERS("sleeper_elements", GN_I32, count, 1, rows, gn_dormant_particle,
                                   element);
}

static gneiss_status put_dormant(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_dormant_particle *rows = world->dem.dormant;
    gn_checkpoint_array arrays[DORMANT_ARRAYS];
    list_dormant(&rows, world->dem.particles.soa.count, arrays);
    GN_TRY(gn_h5_put_record(file, "prepared", &gn_contact_record, &world->dem.prepared, error));
    return gn_checkpoint_put_arrays(file, arrays, DORMANT_ARRAYS, error);
}

void gn_checkpoint_pass_particles(const gn_world *world) {
    gn_world *w = (gn_world *)(uintptr_t)world;
    size_t groups;
    (void)gn_active_pairs_keep(&w->ctx, &w->dem, &groups);
}

gneiss_status gn_checkpoint_put_particles(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_world *w =
        (gn_world *)(uintptr_t)world; /* list_arrays returns pointers that are not const */
    gn_checkpoint_array arrays[MOST_ARRAYS];
    size_t count = list_arrays(w, arrays);
    size_t groups;
    const gn_active_pairs_kept kept = gn_active_pairs_keep(&w->ctx, &w->dem, &groups);
    GN_TRY(gn_h5_put_record(file, "particles", &gn_particle_record, &w->dem.particles, error));
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_used(&w->ctx.scene, l))
            GN_TRY(gn_h5_put_record(file, gn_list_kinds[l]->record, &gn_contact_record,
                                    &w->dem.list[l].contacts, error));
    GN_TRY(gn_h5_put(file, "near", GN_F64, 1, sizeof kept / 8, 0, &kept, NULL, NULL, error));
    GN_TRY(gn_h5_put(file, "near_paths", GN_F64, w->dem.near.path_count, PATH, 0, w->dem.near.paths,
                     NULL, NULL, error));
    if (groups)
        GN_TRY(
            gn_h5_put(file, "near_act", GN_U8, groups, 1, 0, w->dem.near.act, NULL, NULL, error));
    if (gn_converts(&w->ctx)) GN_TRY(put_dormant(w, file, error));
    GN_TRY(gn_h5_put_pieces(file, "run", pieces, PIECES, &w->dem, error));
    GN_TRY(gn_h5_put_pieces(file, "run", choice_pieces, CHOICE_PIECES, &w->ctx.choice, error));
    GN_TRY(gn_checkpoint_put_events(w, file, error));
    GN_TRY(gn_checkpoint_put_flow(w, file, error));
    GN_TRY(gn_checkpoint_put_joints(w, file, error));
    return gn_checkpoint_put_arrays(file, arrays, count, error);
}

/* --- reading --- */

/* Checks indices that kernels follow without a check; they must be in range even if the file was
 * tampered with. */
static bool good_contacts(const gn_contacts *list, size_t n) {
    bool good = true;
    for (size_t c = 0; c < list->soa.count; c++) {
        int32_t i = list->i[c], j = list->j[c];
        good = good && i >= 0 && i < j && (size_t)j < n;
    }
    return good;
}

static bool good_particles(const gn_world *world) {
    const gn_particles *q = &world->dem.particles;
    bool good = true;
    for (size_t p = 0; p < q->soa.count; p++) {
        good = good && q->id[p] >= 0 && q->id[p] < world->dem.ids && q->material[p] >= 0 &&
               (size_t)q->material[p] < world->ctx.scene.material_count;
        if (q->slot)
            good = good && q->slot[p] >= -1 && q->slot[p] < (int32_t)world->dem.prescribed.count;
    }
    return good;
}

static bool good_prescription(const gn_world *world) {
    const gn_prescription *f = &world->dem.prescribed;
    bool good = true;
    for (size_t s = 0; s < f->count; s++) {
        good = good && f->set[s] >= 0 && (size_t)f->set[s] < world->ctx.scene.set_count;
        for (size_t c = 6 * s; c < 6 * s + 6; c++)
            good = good && world->dem.channel_set[c] >= -1 &&
                   world->dem.channel_set[c] < (int64_t)world->ctx.scene.set_count;
    }
    return good;
}

static bool good_patches(const gn_world *world) {
    const gn_membrane_state *m = world->membrane.state;
    bool good = !m || (m->bodies >= 0 && m->bodies <= world->dem.ids + 1);
    for (size_t k = 0; k < world->membrane.patch_count; k++) {
        const gn_patch *patch = &world->membrane.patches[k];
        good = good && patch->owner >= -1 && patch->owner < world->dem.ids && patch->body >= 0 &&
               (patch->body == 0 || patch->body < m->bodies);
    }
    return good;
}

/* Checks that the members of clumps follow each other and that their particles belong to them. */
static bool good_clumps(const gn_world *world) {
    const gn_dem *dem = &world->dem;
    const gn_clumps *all = &dem->clumps;
    const gn_particles *q = &dem->particles;
    double next = 0.0;
    bool good = true;
    for (size_t k = 0; k < all->count; k++) {
        good = good && all->clump[k].first == next && all->clump[k].count >= 1.0 &&
               all->clump[k].count <= (double)all->member_count;
        next += all->clump[k].count;
    }
    good = good && next == (double)all->member_count;
    for (size_t m = 0; m < all->member_count; m++)
        good = good && all->member[m].id >= 0.0 && all->member[m].id < (double)dem->ids &&
               all->member[m].id == floor(all->member[m].id) && all->member[m].material >= 0.0 &&
               all->member[m].material < (double)world->ctx.scene.material_count;
    for (size_t p = 0; q->clump && p < q->soa.count; p++)
        good = good && q->clump[p] >= -1 && q->clump[p] < (int64_t)all->count;
    return good;
}

static gneiss_status check_records(const gn_dem *dem, const char *path, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    GN_TRY(gn_checkpoint_check_record("particles", &gn_particle_record, q, path, error));
    GN_TRY(gn_checkpoint_check_numbers("particles", q->id, q->soa.count, (size_t)dem->ids, path,
                                       error));
    for (int l = 0; l < GN_LIST_COUNT; l++)
        GN_TRY(gn_checkpoint_check_record(gn_list_kinds[l]->record, &gn_contact_record,
                                          &dem->list[l].contacts, path, error));
    return gn_checkpoint_check_record("prepared", &gn_contact_record, &dem->prepared, path, error);
}

static gneiss_status check(const gn_world *world, const char *path, gneiss_error *error) {
    const gn_dem *d = &world->dem;
    size_t n = d->particles.soa.count;
    GN_TRY(check_records(d, path, error));
    if (!(d->verlet.skin > 0.0 && isfinite(d->verlet.skin) && isfinite(d->verlet.drift) &&
          isfinite(d->verlet.closed)))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected positive steps and intervals, found others", path);
    bool good = good_contacts(&d->prepared, n);
    for (int l = 0; l < GN_LIST_COUNT; l++) good = good && good_contacts(&d->list[l].contacts, n);
    if (good && good_particles(world) && good_prescription(world) && good_patches(world) &&
        good_clumps(world))
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected particle numbers below %zu, found others", path, n);
}

/* Reads the dormant particles. Elements are loaded later, so that the elements' indices are not
 * compared with their number here. */
static gneiss_status get_dormant(gn_world *world, const gn_h5 *file, const char *path,
                                 gneiss_error *error) {
    gn_dem *d = &world->dem;
    const size_t count = d->particles.soa.count;
    gn_checkpoint_array arrays[DORMANT_ARRAYS];
    GN_TRY(gn_h5_get_record(file, "prepared", &gn_contact_record, &d->prepared,
                            gn_contact_list_effects(world->ctx.effects, true), error));
    list_dormant(&d->dormant, count, arrays);
    GN_TRY(gn_checkpoint_get_arrays(file, arrays, DORMANT_ARRAYS, error));
    for (size_t p = 0; p < count; p++)
        if (d->dormant[p].element < 0)
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected numbers of elements, found %d",
                           path, d->dormant[p].element);
    return GNEISS_OK;
}

/* Reads which pairs were packed; they are applied when there are neighbour lists. */
static gneiss_status get_near(gn_world *world, const gn_h5 *file, const char *path,
                              gneiss_error *error) {
    gn_active_pairs *n = &world->dem.near;
    GN_TRY(gn_h5_get(file, "near", GN_F64, 1, sizeof n->kept / 8, 0, &n->kept, error));
    const double whole[] = {n->kept.known, n->kept.worked, n->kept.steps};
    for (int k = 0; k < 3; k++)
        if (!(whole[k] >= 0.0 && whole[k] < INT32_MAX))
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected numbers of steps, found %g",
                           path, whole[k]);
    GN_TRY(gn_h5_rows(file, "near_paths", &n->kept_path_count, error));
    GN_TRY(gn_new(&n->kept_paths, n->kept_path_count + 1, "paths", error));
    GN_TRY(
        gn_h5_get(file, "near_paths", GN_F64, n->kept_path_count, PATH, 0, n->kept_paths, error));
    n->kept_groups = 0;
    if (n->kept.packed > 0.0) GN_TRY(gn_h5_rows(file, "near_act", &n->kept_groups, error));
    n->kept_act = gn_alloc(n->kept_groups + 1);
    if (!n->kept_act) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for marks of pairs");
    return n->kept_groups
               ? gn_h5_get(file, "near_act", GN_U8, n->kept_groups, 1, 0, n->kept_act, error)
               : GNEISS_OK;
}

gneiss_status gn_checkpoint_get_particles(gn_world *world, const gn_h5 *file, const char *path,
                                          gneiss_error *error) {
    gn_dem *d = &world->dem;
    gn_checkpoint_array arrays[MOST_ARRAYS];
    GN_TRY(gn_h5_get_pieces(file, "run", pieces, PIECES, d, error));
    GN_TRY(gn_h5_get_pieces(file, "run", choice_pieces, CHOICE_PIECES, &world->ctx.choice, error));
    if (!(d->ids >= 0 && d->ids <= INT32_MAX && d->made >= 0 && d->made <= d->ids))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a number of particles, found %lld",
                       path, (long long)d->ids);
    GN_TRY(gn_checkpoint_get_flow(world, file, path, error));
    if (world->ctx.effects & GN_FX_PRESCRIBED)
        GN_TRY(gn_h5_rows(file, "arrays/prescribed_set", &d->prescribed.count, error));
    if (world->ctx.effects & GN_FX_MEMBRANE)
        GN_TRY(gn_h5_rows(file, "arrays/patches", &world->membrane.patch_count, error));
    if (world->ctx.effects & GN_FX_CLUMPS) {
        GN_TRY(gn_h5_rows(file, "arrays/clumps", &d->clumps.count, error));
        GN_TRY(gn_h5_rows(file, "arrays/clump_members", &d->clumps.member_count, error));
    }
    size_t count = list_arrays(world, arrays);
    GN_TRY(gn_checkpoint_get_arrays(file, arrays, count, error));
    GN_TRY(gn_h5_get_record(file, "particles", &gn_particle_record, &d->particles,
                            world->ctx.effects, error));
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_used(&world->ctx.scene, l))
            GN_TRY(gn_h5_get_record(file, gn_list_kinds[l]->record, &gn_contact_record,
                                    &d->list[l].contacts,
                                    gn_list_kinds[l]->effects_of(world->ctx.effects), error));
    GN_TRY(get_near(world, file, path, error));
    if (gn_converts(&world->ctx)) GN_TRY(get_dormant(world, file, path, error));
    GN_TRY(gn_checkpoint_get_events(world, file, path, error));
    GN_TRY(gn_checkpoint_get_joints(world, file, path, error));
    return check(world, path, error);
}
