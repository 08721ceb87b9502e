/* Columns of the history about the packing of particles: structure, and liquid between them. */
#include "measure/structure.h"
#include "particles/bridges.h"
#include "run/quantities.h"
#include "world/structure.h"

#include <string.h>

#define HOLDS(name, expression)                                                                    \
    static bool name(const gn_world *world, size_t k) {                                            \
        (void)k;                                                                                   \
        return expression;                                                                         \
    }
HOLDS(has_grains, world->ctx.scene.has_specimen)
HOLDS(has_volume, world->ctx.scene.has_specimen &&gn_structure_has_volume(world))
HOLDS(has_friction, world->ctx.effects &GN_FX_FRICTION)
HOLDS(has_liquid,
      world->ctx.effects &GN_FX_COHESION && world->ctx.scene.cohesion == GN_COHESION_LIQUID)

static const gn_condition of_grains = {"with particles", has_grains, NULL},
                          porous = {"with output.structure, or without sources", has_volume, NULL},
                          rubbing = {"with friction between particles", has_friction, NULL},
                          moist = {"with law.cohesion liquid", has_liquid, NULL};

#define READ(name, expression)                                                                     \
    static void read_##name(const gn_world *world, size_t k, double *value) {                      \
        (void)k;                                                                                   \
        *value = (expression);                                                                     \
    }
READ(porosity, gn_structure_porosity(world))
READ(coordination, gn_structure_coordination(world))
READ(sliding, gn_structure_sliding(world))
static void read_fabric(const gn_world *world, size_t k, double *value) {
    (void)k;
    gn_structure_fabric(world, value);
}
static gn_anisotropy anisotropy_of(const gn_world *world) {
    double fabric[9];
    gn_structure_fabric(world, fabric);
    return gn_fabric_anisotropy((int)world->ctx.scene.dimension, fabric);
}
READ(anisotropy, anisotropy_of(world).degree)
static void read_fabric_direction(const gn_world *world, size_t k, double *value) {
    (void)k;
    const gn_anisotropy a = anisotropy_of(world);
    memcpy(value, a.direction, sizeof a.direction);
}

/* Returns the liquid of bridges with walls, m3. */
static double liquid_at_walls(const gn_world *world) {
    const gn_wall_contacts *list = &world->boundary.contacts;
    double sum = 0.0;
    for (size_t c = 0; c < list->soa.count; c++) sum += list->bridge[c];
    return sum;
}
static double liquid_in_bridges(const gn_world *world) {
    return gn_bridges_sum(&world->ctx, &world->dem).bridged + liquid_at_walls(world);
}
READ(bridges, (double)gn_bridges_sum(&world->ctx, &world->dem).bridges)
READ(bridge_liquid, liquid_in_bridges(world))
READ(liquid, liquid_in_bridges(world) + gn_bridges_sum(&world->ctx, &world->dem).films)

#define SCALAR(when, instant, name, unit, read, text)                                              \
    { name, unit, text, GN_SCALAR, instant, &when, read, NULL }

const gn_quantity gn_grain_quantities[GN_GRAIN_QUANTITIES] = {
    SCALAR(porous, GN_BEFORE_STEP, "porosity", "1", read_porosity,
           "1 - volume of the particles (overlaps count twice) over that of output.structure, or "
           "over that to which stress refers"),
    SCALAR(of_grains, GN_AFTER_STEP, "coordination", "1", read_coordination,
           "mean number of contacts of a particle with others that carry a force or are intact "
           "bonds; of the particles in output.structure"),
    {"fabric", "1", "mean of n_a n_b over these contacts, n their normals; its trace is 1",
     GN_TENSOR, GN_AFTER_STEP, &of_grains, read_fabric, NULL},
    SCALAR(of_grains, GN_AFTER_STEP, "anisotropy", "1", read_anisotropy,
           "largest principal value of the fabric minus the smallest: 0 without a preferred "
           "direction, 1 if all contacts have the same"),
    {"fabric_direction", "1", "unit vector of the largest principal value of the fabric", GN_VECTOR,
     GN_AFTER_STEP, &of_grains, read_fabric_direction, NULL},
    SCALAR(rubbing, GN_AFTER_STEP, "sliding", "1", read_sliding,
           "share of contacts at their limit of friction in those that are not intact bonds"),
    SCALAR(moist, GN_AFTER_STEP, "bridges", "1", read_bridges, "liquid bridges between particles"),
    SCALAR(moist, GN_AFTER_STEP, "bridge_liquid", "m3", read_bridge_liquid,
           "liquid in bridges, also with walls"),
    SCALAR(moist, GN_AFTER_STEP, "liquid", "m3", read_liquid,
           "liquid in bridges and films; constant but for rounding")};
