/* Calls of the features, and the descriptors of those whose functions take parts of a world. */
#include "world/features.h"

#include "base/new.h"
#include "base/timer.h"
#include "conversion/conversion.h"
#include "drive/box.h"
#include "laboratory/cutting.h"
#include "laboratory/ends.h"
#include "laboratory/strain_gauge.h"
#include "membrane/membrane.h"
#include "particles/bridges.h"
#include "particles/events.h"
#include "particles/particles.h"
#include "sched/hold.h"
#include "timestep/indentation.h"
#include "timestep/timestep.h"
#include "world/world.h"
#include "zones/zones.h"

#include <string.h>

static const gn_feature *const all[] = {
#define X(name) &gn_feature_##name,
    GN_FEATURES(X)
#undef X
};

static size_t count_of(const gn_features *features) {
    return features->used_count + features->added_count;
}

static const gn_feature *feature_at(const gn_features *features, size_t k) {
    return k < features->used_count ? features->used[k]
                                    : &features->added[k - features->used_count];
}

void gn_features_choose(gn_world *world) {
    gn_features *f = &world->features;
    f->used_count = 0;
    for (size_t k = 0; k < GN_FEATURE_COUNT; k++)
        if (!all[k]->used || all[k]->used(world)) f->used[f->used_count++] = all[k];
    f->holds = false;
    for (size_t k = 0; k < count_of(f); k++)
        f->holds |= feature_at(f, k)->hook[GN_HOOK_LISTS] != NULL;
}

gneiss_status gn_features_run(gn_world *world, gn_hook_place place, gneiss_error *error) {
    const gn_features *f = &world->features;
    for (size_t k = 0; k < count_of(f); k++) {
        const gn_feature *one = feature_at(f, k);
        if (one->hook[place]) GN_TRY(one->hook[place](one->context, world, error));
    }
    return GNEISS_OK;
}

gneiss_status gn_features_follow_lists(gn_world *world, gneiss_error *error) {
    gn_features_choose(world);
    gn_hold_clear(&world->dem.hold);
    for (size_t k = 0; k < world->solids.count; k++)
        gn_hold_clear(&world->solids.elements[k]->solid.hold);
    return gn_features_run(world, GN_HOOK_LISTS, error);
}

gneiss_status gn_feature_add(gn_world *world, gn_feature feature, gneiss_error *error) {
    gn_features *f = &world->features;
    if (!gn_widen(&f->added, f->added_count, f->added_count + 1, sizeof feature))
        return gn_no_memory(error, "a feature");
    f->added[f->added_count++] = feature;
    gneiss_status status =
        world->dem.motion_sums ? gn_features_follow_lists(world, error) : GNEISS_OK;
    if (status != GNEISS_OK) f->added_count--;
    return status;
}

void gn_features_free(gn_features *features) {
    for (size_t k = 0; k < features->added_count; k++)
        if (features->added[k].end) features->added[k].end(features->added[k].context);
    gn_free(features->added);
}

/* --- elements that turn into particles --- */

static bool converts(const gn_world *world) {
    return gn_converts(&world->ctx);
}

GN_HOOK(convert) {
    const gn_convertible model = gn_world_convertible(world);
    return gn_conversion_check_limits(&model, error);
}

const gn_feature gn_feature_conversion = {
    .name = "conversion",
    .used = converts,
    .hook = {[GN_HOOK_BEFORE_LISTS] = convert},
};

/* --- the length of the step --- */

static bool is_hertz(const gn_world *world) {
    return world->ctx.effects & GN_FX_HERTZ;
}

GN_HOOK(check_indentation) {
    return gn_pressed_check(&world->ctx, &world->dem, &world->boundary, &world->solids,
                            &world->zones, &world->ledger, error);
}

const gn_feature gn_feature_indentation = {
    .name = "indentation",
    .used = is_hertz,
    .hook = {[GN_HOOK_LIMIT] = check_indentation},
};

static bool has_automatic_step(const gn_world *world) {
    return world->ctx.scene.step == 0.0 && world->ctx.scene.has_specimen;
}

GN_HOOK(follow_bodies) {
    gn_timestep_follow_bodies(&world->ctx, &world->dem, &world->boundary);
    return GNEISS_OK;
}

const gn_feature gn_feature_bodies = {
    .name = "bodies",
    .used = has_automatic_step,
    .hook = {[GN_HOOK_LIMIT] = follow_bodies},
};

/* Wedged debris gains some tenths of its energy in every collision, which takes a few steps. The
 * interval between checks is counted in steps, so that it does not depend on output or a resume. */
enum { DEBRIS_EVERY = 20 };

static bool may_have_debris(const gn_world *world) {
    return world->ctx.effects & GN_FX_ENERGY && has_automatic_step(world);
}

GN_HOOK(find_debris) {
    world->ctx.choice.debris_read = false;
    if ((world->ctx.step + 1) % DEBRIS_EVERY != 0) return GNEISS_OK;
    GN_TRY(gn_debris_find(&world->ctx, &world->dem, &world->ctx.choice.debris_read, error));
    world->ctx.measure |= world->ctx.choice.debris_read;
    return GNEISS_OK;
}

GN_HOOK(check_debris) {
    return world->ctx.choice.debris_read
               ? gn_timestep_check_debris(&world->ctx, &world->dem, &world->boundary,
                                          &world->solids, &world->zones, &world->ledger, error)
               : GNEISS_OK;
}

const gn_feature gn_feature_debris = {
    .name = "debris",
    .used = may_have_debris,
    .hook = {[GN_HOOK_REQUEST_READING] = find_debris, [GN_HOOK_AFTER_STEP] = check_debris},
};

/* --- readings --- */

static bool has_specimen(const gn_world *world) {
    return world->ctx.scene.has_specimen;
}

GN_HOOK(look_at_depth) {
    if (!world->ctx.measure) return GNEISS_OK;
    return gn_depth_update_when_due(&world->ctx, &world->dem, &world->boundary, error);
}

const gn_feature gn_feature_depth = {
    .name = "depth",
    .used = has_specimen,
    .hook = {[GN_HOOK_BEFORE_FORCES] = look_at_depth},
};

GN_HOOK(look_at_gauge) {
    return gn_gauge_update(&world->ctx, &world->dem, &world->gauge, error);
}

const gn_feature gn_feature_gauge = {
    .name = "gauge",
    .used = has_specimen,
    .hook = {[GN_HOOK_BEFORE_FORCES] = look_at_gauge},
};

static bool has_ends(const gn_world *world) {
    return gn_scene_tested(&world->ctx.scene);
}

GN_HOOK(look_at_ends) {
    gn_ends_note_contact(&world->ctx, &world->dem, &world->boundary, &world->solids,
                         &world->approach, false);
    return GNEISS_OK;
}

const gn_feature gn_feature_ends = {
    .name = "ends",
    .used = has_ends,
    .hook = {[GN_HOOK_ACT] = look_at_ends},
};

static bool cuts(const gn_world *world) {
    return gn_scene_test(&world->ctx.scene)->tool;
}

GN_HOOK(add_cut) {
    (void)error;
    gn_cutting_add(&world->ctx, &world->dem, &world->boundary, &world->cutting);
    return GNEISS_OK;
}

const gn_feature gn_feature_cutting = {
    .name = "cutting",
    .used = cuts,
    .hook = {[GN_HOOK_WORK] = add_cut},
};

static bool has_events(const gn_world *world) {
    return world->ctx.effects & GN_FX_EVENTS;
}

GN_HOOK(note_events) {
    return gn_events_note(&world->ctx, &world->dem, error);
}

const gn_feature gn_feature_events = {
    .name = "events",
    .used = has_events,
    .hook = {[GN_HOOK_MOVED] = note_events},
};

/* --- actions on the specimen --- */

static bool is_controlled(const gn_world *world) {
    return world->ctx.scene.test.has_control;
}

GN_HOOK(control_ends) {
    gn_control_update(&world->ctx, &world->dem, &world->boundary, &world->solids, &world->gauge);
    return GNEISS_OK;
}

const gn_feature gn_feature_control = {
    .name = "control",
    .used = is_controlled,
    .hook = {[GN_HOOK_BEFORE_FORCES] = control_ends},
};

static bool has_membrane(const gn_world *world) {
    return world->ctx.effects & GN_FX_MEMBRANE;
}

GN_HOOK(press) {
    return gn_membrane_apply(&world->ctx, &world->dem, &world->membrane, error);
}

const gn_feature gn_feature_membrane = {
    .name = "membrane",
    .used = has_membrane,
    .hook = {[GN_HOOK_BEFORE_FORCES] = press},
};

static bool is_periodic(const gn_world *world) {
    return world->ctx.effects & GN_FX_PERIODIC;
}

/* A servo needs the stress in every step. */
GN_HOOK(ask_for_sums) {
    world->ctx.sums |= gn_box_moves(&world->ctx, &world->box);
    return GNEISS_OK;
}

GN_HOOK(book_box) {
    gn_box_book(&world->ctx, &world->dem, &world->box, &world->ledger);
    return GNEISS_OK;
}

GN_HOOK(move_box) {
    return gn_box_move(&world->ctx, &world->dem, &world->box, &world->ledger, error);
}

const gn_feature gn_feature_box = {
    .name = "box",
    .used = is_periodic,
    .hook = {[GN_HOOK_REQUEST_READING] = ask_for_sums,
             [GN_HOOK_WORK] = book_box,
             [GN_HOOK_MOVED] = move_box},
};

static bool has_clumps(const gn_world *world) {
    return world->dem.clumps.count > 0;
}

GN_HOOK(hold_clumps) {
    return gn_clumps_follow_rows(&world->dem, error);
}

const gn_feature gn_feature_clumps = {
    .name = "clumps",
    .used = has_clumps,
    .hook = {[GN_HOOK_LISTS] = hold_clumps},
};

static bool has_zones(const gn_world *world) {
    return world->zones.coupled != NULL;
}

GN_HOOK(hold_zones) {
    return gn_zones_hold(&world->ctx, &world->dem, &world->solids, &world->zones, error);
}

/* The stress of the elements is that at the present positions, before the elements have their
 * loads. */
GN_HOOK(read_zones) {
    if (!world->ctx.measure) return GNEISS_OK;
    const double begin = gn_now();
    gneiss_status status = gn_coupled_mean_stress(&world->ctx, &world->dem, &world->solids,
                                                  &world->zones, world->zones.state.stress, error);
    world->ctx.seconds[GN_PHASE_measure] += gn_now() - begin;
    return status;
}

GN_HOOK(act_on_zones) {
    gn_zones_act(&world->ctx, &world->dem, &world->solids, &world->zones, &world->ledger);
    return GNEISS_OK;
}

GN_HOOK(follow_elements) {
    return gn_zones_elements_moved(&world->ctx, &world->dem, &world->solids, &world->zones,
                                   &world->ledger, error);
}

GN_HOOK(add_zones) {
    gn_zones_add_to_reading(&world->zones, &world->ledger);
    return GNEISS_OK;
}

const gn_feature gn_feature_zones = {
    .name = "zones",
    .used = has_zones,
    .hook = {[GN_HOOK_LISTS] = hold_zones,
             [GN_HOOK_BEFORE_FORCES] = read_zones,
             [GN_HOOK_ACT] = act_on_zones,
             [GN_HOOK_ELEMENTS_MOVED] = follow_elements,
             [GN_HOOK_ADD_TO_READING] = add_zones},
};

/* --- liquid bridges --- */

/* Pairs that were dry when they touched get a bridge when they are looked at again. The interval is
 * counted in steps, so that it does not depend on output or a resume. */
enum { DRY_PAIRS_EVERY = 500 };

static bool has_liquid(const gn_world *world) {
    return world->ctx.effects & GN_FX_COHESION && world->ctx.scene.cohesion == GN_COHESION_LIQUID;
}

GN_HOOK(form_bridges) {
    if (world->ctx.step % DRY_PAIRS_EVERY == 0)
        world->ledger.energy.cohesion += gn_bridges_form(&world->ctx, &world->dem);
    return GNEISS_OK;
}

GN_HOOK(settle_bridges) {
    world->ledger.energy.cohesion += gn_bridges_settle(&world->ctx, &world->dem);
    return GNEISS_OK;
}

const gn_feature gn_feature_bridges = {
    .name = "bridges",
    .used = has_liquid,
    .hook = {[GN_HOOK_BEFORE_FORCES] = form_bridges, [GN_HOOK_AFTER_STEP] = settle_bridges},
};
