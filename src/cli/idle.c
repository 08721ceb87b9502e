#include "cli/idle.h"

#include <stdio.h>

/* --- certain cases --- */

static bool turns(const gn_motion *motion) {
    return motion->spin[0].count || motion->spin[1].count || motion->spin[2].count;
}

static bool sets_turn(const gn_scene *scene) {
    bool any = false;
    for (size_t k = 0; k < scene->set_count; k++)
        any = any || scene->sets[k].has_initial_spin || turns(&scene->sets[k].motion);
    return any;
}

static bool held_at_rest(const gn_table *channel) {
    bool rests = channel->count > 0;
    for (size_t k = 0; k < channel->count; k++) rests = rests && channel->value[k] == 0.0;
    return rests;
}

/* The first set of a particle drives it: later ones have no effect. */
static bool all_spins_held(const gn_scene *scene) {
    const gn_set_def *set = scene->sets;
    bool held = scene->set_count > 0 && set->all && !set->has_initial_spin;
    for (int a = scene->dimension == 3 ? 0 : 2; a < 3; a++)
        held = held && held_at_rest(&set->motion.spin[a]);
    return held && scene->set_count == 1;
}

/* Only tangential forces turn a sphere. Forces on facets are distributed over points beside the one
 * below its centre. */
static const char *idle_rotation(const gn_world *world) {
    bool tangential = world->ctx.effects & (GN_FX_SHEAR | GN_FX_WALL_SHEAR);
    if (all_spins_held(&world->ctx.scene))
        return "all spins are prescribed as 0: the same to rounding (law.rotation: off)";
    if (tangential || world->ctx.effects & GN_FX_FACETS || sets_turn(&world->ctx.scene))
        return NULL;
    return "no tangential force and no set turns anything (law.rotation: off)";
}

static const char *idle_friction(const gn_world *world) {
    const gn_particles *q = &world->dem.particles;
    if (world->ctx.effects & GN_FX_ROLLING)
        return NULL; /* moments need the storage of tangential forces */
    for (size_t p = 0; p < q->soa.count; p++)
        if (world->ctx.scene.materials[q->material[p]].friction > 0.0) return NULL;
    return "no particle has a material with friction";
}

static const char *idle_contact_damping(const gn_world *world) {
    return world->dem.damping_fraction > 0.0
               ? NULL
               : "a restitution of 1 dissipates nothing (damping.contact)";
}

static const char *idle_background(const gn_world *world) {
    return world->ctx.scene.background_coefficient > 0.0 || world->ctx.scene.background_spin > 0.0
               ? NULL
               : "its coefficient is 0 (damping.background.model: none)";
}

static const char *idle_applied(const gn_world *world) {
    if (world->ctx.effects & GN_FX_MEMBRANE) return NULL;
    for (size_t k = 0; k < world->ctx.scene.set_count; k++)
        for (int a = 0; world->ctx.scene.sets[k].has_force && a < 3; a++)
            if (world->ctx.scene.sets[k].force[a] != 0.0) return NULL;
    return "all forces of sets are 0 (sets[].force)";
}

static const char *idle_mass_scaling(const gn_world *world) {
    return world->dem.scaling.raised ? NULL : "no mass has to be raised (time.mass_scaling)";
}

/* Effects that only output reads. */
static const char *idle_energy(const gn_world *world) {
    (void)world;
    return "read only by output and its warning, no motion depends on it (output.energy: off)";
}
static const char *idle_orientation(const gn_world *world) {
    (void)world;
    return "read only by output, no motion depends on it (output.orientation: off)";
}

/* --- words --- */

static const struct {
    gn_effect effect;
    gn_effect_index index;
    const char *(*idle)(const gn_world *world); /* the reason; NULL: it may change something */
} idle_effects[] = {
#define IDLE(NAME, find)                                                                           \
    { GN_FX_##NAME, GN_FX_INDEX_##NAME, find }
    IDLE(ROTATION, idle_rotation),
    IDLE(FRICTION, idle_friction),
    IDLE(CONTACT_DAMPING, idle_contact_damping),
    IDLE(VISCOUS, idle_background),
    IDLE(NONVISCOUS_VECTOR, idle_background),
    IDLE(NONVISCOUS_COMPONENT, idle_background),
    IDLE(APPLIED, idle_applied),
    IDLE(MASS_SCALING, idle_mass_scaling),
    IDLE(ENERGY, idle_energy),
    IDLE(ORIENTATION, idle_orientation),
#undef IDLE
};

void gn_print_idle(const gn_world *world) {
    bool any = false;
    for (size_t k = 0; k < sizeof idle_effects / sizeof *idle_effects; k++) {
        bool active = world->ctx.effects & idle_effects[k].effect;
        const char *why = active ? idle_effects[k].idle(world) : NULL;
        if (!why) continue;
        if (!any) printf("could be switched off\n");
        printf("  %-24s %s\n", gn_effect_name(idle_effects[k].index), why);
        any = true;
    }
}
