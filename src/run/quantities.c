#include "run/quantities.h"

#include "inflow/sources.h"
#include "laboratory/cutting.h"
#include "laboratory/ends.h"
#include "laboratory/laboratory.h"
#include "membrane/membrane.h"
#include "soa/bond_causes.h"
#include "solids/dormant_places.h"
#include "timestep/timestep.h"
#include "world/space.h"
#include "zones/zones.h"

#include <string.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

static void copy3(double *to, const double *from) {
    memcpy(to, from, 3 * sizeof *to);
}

static void difference3(double *to, const double *a, const double *b) {
    for (int k = 0; k < 3; k++) to[k] = a[k] - b[k];
}

/* --- conditions --- */

#define HOLDS(name, expression)                                                                    \
    static bool name(const gn_world *world, size_t k) {                                            \
        (void)k;                                                                                   \
        return expression;                                                                         \
    }

HOLDS(has_stages, world->ctx.scene.stage_count > 0)
HOLDS(has_test, gn_scene_tested(&world->ctx.scene))
HOLDS(has_opening, gn_scene_tested(&world->ctx.scene) && world->ctx.scene.test.has_opening)
HOLDS(has_control, gn_scene_tested(&world->ctx.scene) && world->ctx.scene.test.has_control)
HOLDS(has_membrane, world->ctx.effects &GN_FX_MEMBRANE)
HOLDS(has_specimen, world->ctx.scene.has_specimen)
HOLDS(has_bonds, world->ctx.effects &GN_FX_BONDS)
HOLDS(has_joints, world->ctx.scene.joint_count > 0)
HOLDS(has_ledger, world->ctx.effects &GN_FX_ENERGY)
HOLDS(is_periodic, world->ctx.effects &GN_FX_PERIODIC)
HOLDS(has_added_mass, world->ctx.effects &GN_FX_MASS_SCALING)
HOLDS(is_counted, gn_scene_has_flow(&world->ctx.scene) || gn_converts(&world->ctx))
HOLDS(has_elements_beside_particles, world->solids.count && world->ctx.scene.has_specimen)
HOLDS(has_zones, world->ctx.scene.has_couple && world->ctx.scene.couple.zone_count)
HOLDS(converts, gn_converts(&world->ctx))
/* There is an average strain unless particles enter and leave, which have no positions at the
 * start; in a box that is periodic in all directions the strain is that of its sides in any case.
 */
HOLDS(has_average_strain,
      !gn_scene_has_flow(&world->ctx.scene) ||
          (world->ctx.effects & GN_FX_PERIODIC && !gn_scene_half_periodic(&world->ctx.scene)))

static bool set_moves(const gn_world *world, size_t k) {
    const gn_set_def *s = &world->ctx.scene.sets[k];
    size_t points = 0;
    for (int a = 0; a < 3; a++) points += s->motion.velocity[a].count + s->motion.spin[a].count;
    return points > 0 || (world->ctx.scene.stage_count && world->ctx.effects & GN_FX_PRESCRIBED);
}
static bool motion_drives(const gn_world *world, size_t k) {
    return gn_elements_motion_drives(&world->solids, k);
}

#define OF_KIND(name, expression)                                                                  \
    static bool name(const gn_test_descriptor *d) {                                                \
        return expression;                                                                         \
    }

OF_KIND(has_ends, d->ends)
OF_KIND(is_confined, d->confined)
OF_KIND(has_volume, d->confined || d->isotropic || d->enclosed)
OF_KIND(is_sheared, d->sheared)
OF_KIND(is_disc, d->disc)

static const gn_condition always = {"always", NULL, NULL}, tests = {"with a test", has_test, NULL},
                          ended = {"with a test that has ends", NULL, has_ends},
                          confined = {"in %s tests", NULL, is_confined},
                          voluminous = {"in %s tests", NULL, has_volume},
                          sheared = {"in %s tests", NULL, is_sheared},
                          pressed = {"with a membrane", has_membrane, NULL},
                          gauged = {"with `test.opening`", has_opening, NULL},
                          controlled = {"with `test.control`", has_control, NULL},
                          strained = {"without sources and sinks", has_average_strain, NULL},
                          central = {"in %s tests of particles", has_specimen, is_disc},
                          staged = {"with stages", has_stages, NULL},
                          bonded = {"with bonds", has_bonds, NULL},
                          jointed = {"with joints", has_joints, NULL},
                          booked = {"with the energy ledger", has_ledger, NULL},
                          raised = {"with mass scaling", has_added_mass, NULL},
                          boxed = {"in a periodic box", is_periodic, NULL},
                          counted = {"with sources, sinks or couple.convert", is_counted, NULL},
                          beside = {"finite elements beside particles",
                                    has_elements_beside_particles, NULL},
                          zoned = {"with couple.zones", has_zones, NULL},
                          converted = {"with couple.convert", converts, NULL},
                          moving = {"unless the set has no motion", set_moves, NULL},
                          driven = {"unless it only records", motion_drives, NULL};

/* --- quantities of the whole model --- */

#define READ(name, expression)                                                                     \
    static void read_##name(const gn_world *world, size_t k, double *value) {                      \
        (void)k;                                                                                   \
        *value = (expression);                                                                     \
    }

READ(step, (double)world->ctx.step)
READ(time, world->ctx.time)
READ(stage, (double)world->stages.now)

READ(deflection, gn_ends_deflection(&world->ctx, &world->dem, &world->boundary, &world->solids))

/* Computes the strain of the particles, in a fully periodic box that of its sides, and without
 * particles that of the elements. */
static void mean_strain(const gn_world *world, double strain[9]) {
    double gradient[9];
    if (!world->ctx.scene.has_specimen) {
        gn_elements_strain(&world->solids, gradient);
        gn_strain_of(gradient, strain);
        return;
    }
    if (!(world->ctx.effects & GN_FX_PERIODIC) || gn_scene_half_periodic(&world->ctx.scene)) {
        gn_gauge_gradient(&world->ctx, &world->dem, &world->solids, &world->gauge, gradient);
        gn_strain_of(gradient, strain);
        return;
    }
    memset(strain, 0, 9 * sizeof *strain);
    for (int a = 0; a < (int)world->ctx.scene.dimension; a++)
        strain[4 * a] = gn_box_strain(&world->ctx, &world->box, a);
}

/* Returns minus the trace of the average strain, the loss of volume. */
static double lost_volume(const gn_world *world) {
    double g[9];
    mean_strain(world, g);
    return -(g[0] + g[4] + g[8]);
}
/* Returns the mean over the directions across the axis, compression positive. */
static double lateral_strain(const gn_world *world) {
    double g[9], sum = 0.0;
    int dimension = (int)world->ctx.scene.dimension;
    mean_strain(world, g);
    for (int a = 0; a < dimension; a++)
        if (a != (int)world->ctx.scene.test.axis) sum -= g[4 * a];
    return sum / (dimension - 1);
}
READ(lateral_strain, lateral_strain(world))

/* Returns the loss of volume given by walls, by a periodic box or by the positions of the
 * particles. */
static double hydrostatic_strain(const gn_world *world) {
    double now, start, stretch[9], cofactor[9];
    if (gn_space_closed(&world->ctx, &world->dem, &world->boundary, &world->box, &now, &start))
        return 1.0 - now / start;
    mean_strain(world, stretch);
    for (int a = 0; a < 3; a++) stretch[4 * a] += 1.0;
    gn_cofactor3(stretch, cofactor);
    return 1.0 - gn_dot3(stretch, cofactor);
}

READ(volumetric_strain,
     gn_scene_test(&world->ctx.scene)->enclosed ? hydrostatic_strain(world) : lost_volume(world))

/* Returns the shortening of walls or box along the axis, else that of the average strain. */
static double enclosed_strain(const gn_world *world) {
    const int axis = (int)world->ctx.scene.test.axis;
    const double walls = gn_space_shortening(&world->ctx, &world->boundary, &world->box, axis);
    double strain[9];
    if (!isnan(walls)) return walls;
    mean_strain(world, strain);
    return -strain[4 * axis];
}

READ(test_strain,
     gn_scene_test(&world->ctx.scene)->isotropic  ? hydrostatic_strain(world)
     : gn_scene_test(&world->ctx.scene)->enclosed ? enclosed_strain(world)
     : gn_scene_test(&world->ctx.scene)->tool
         ? gn_cutting_path(&world->ctx, &world->boundary, &world->cutting) / world->ctx.test_length
         : gn_ends_shortening(&world->ctx, &world->dem, &world->boundary, &world->solids,
                              &world->approach) /
               world->ctx.test_length)

static double mean_pressure(const gn_world *world) {
    const double *s = world->ledger.stress;
    return -(s[0] + s[4] + s[8]) / (double)world->ctx.scene.dimension;
}

/* Returns the stress along the axis less the mean of the others, compression positive. */
static double deviator(const gn_world *world) {
    const double *s = world->ledger.stress, d = (double)world->ctx.scene.dimension,
                 along = -s[4 * world->ctx.scene.test.axis];
    return along - (d * mean_pressure(world) - along) / (d - 1.0);
}

/* Returns the stress at an end. For confined specimens it is the deviator: the pressure on the part
 * of an end that the membrane does not cover is subtracted. */
static double end_stress(const gn_world *world, bool upper_end) {
    double lower, upper;
    gn_ends_forces(&world->ctx, &world->dem, &world->boundary, &world->solids, &lower, &upper);
    bool bare = gn_scene_test(&world->ctx.scene)->confined &&
                world->ctx.scene.membrane.faces == GN_FACES_SIDES;
    return (upper_end ? upper : lower) /
               gn_space_area(&world->ctx, &world->dem, &world->boundary, &world->box) -
           (bare ? gn_membrane_pressure(&world->membrane) : 0.0);
}
READ(test_lower, end_stress(world, false))
READ(test_upper, end_stress(world, true))
static double cut_stress(const gn_world *world) {
    double force[GN_CUT_AXES];
    gn_cutting_force(&world->ctx, &world->boundary, &world->cutting, force);
    return force[GN_CUT_ROLLING] / world->ctx.test_area;
}
READ(test_stress, gn_scene_test(&world->ctx.scene)->isotropic  ? mean_pressure(world)
                  : gn_scene_test(&world->ctx.scene)->enclosed ? deviator(world)
                  : gn_scene_test(&world->ctx.scene)->tool
                      ? cut_stress(world)
                      : 0.5 * (end_stress(world, false) + end_stress(world, true)))
READ(membrane_pressure, gn_membrane_pressure(&world->membrane))
READ(membrane_area, gn_membrane_area(&world->dem))
static double normal_stress(const gn_world *world, double of_lower, double of_upper) {
    double lower, upper;
    gn_ends_normals(&world->ctx, &world->dem, &world->boundary, &world->solids, &lower, &upper);
    return (of_lower * lower + of_upper * upper) /
           gn_space_area(&world->ctx, &world->dem, &world->boundary, &world->box);
}
READ(normal_stress, normal_stress(world, 0.5, 0.5))
READ(normal_lower, normal_stress(world, 1.0, 0.0))
READ(normal_upper, normal_stress(world, 0.0, 1.0))
READ(dilation, gn_ends_dilation(&world->ctx, &world->dem, &world->boundary, &world->solids))
static void read_test_force(const gn_world *world, size_t k, double *value) {
    double lower, upper;
    (void)k;
    gn_ends_forces(&world->ctx, &world->dem, &world->boundary, &world->solids, &lower, &upper);
    *value = 0.5 * (lower + upper);
}

READ(machine, world->ctx.machine.factor)
READ(opening, gn_ends_opening(&world->ctx, &world->dem, &world->boundary, &world->solids))
static void read_centre_stress(const gn_world *world, size_t k, double *value) {
    (void)k;
    gn_test_centre_stress(&world->ctx, &world->dem, &world->boundary, &world->solids, &world->box,
                          value);
}

static void read_elements_strain(const gn_world *world, size_t k, double *value) {
    (void)k;
    double gradient[9];
    gn_elements_strain(&world->solids, gradient);
    gn_strain_of(gradient, value);
}
static void read_elements_stress(const gn_world *world, size_t k, double *value) {
    (void)k;
    gn_elements_stress(&world->solids, value);
}
static void read_strain(const gn_world *world, size_t k, double *value) {
    (void)k;
    mean_strain(world, value);
}
/* Tells whether the average strain is undefined: too few particles are left, or all are in a plane.
 */
static bool no_strain(const gn_world *world) {
    bool box = is_periodic(world, 0) && !gn_scene_half_periodic(&world->ctx.scene);
    return world->ctx.scene.has_specimen && !world->gauge.weights.count && !box;
}
static bool no_test_strain(const gn_world *world) {
    double now, start;
    return gn_scene_test(&world->ctx.scene)->isotropic && no_strain(world) &&
           !gn_space_closed(&world->ctx, &world->dem, &world->boundary, &world->box, &now, &start);
}
static void read_stress(const gn_world *world, size_t k, double *value) {
    (void)k;
    memcpy(value, world->ledger.stress, sizeof world->ledger.stress);
}
static void read_box(const gn_world *world, size_t k, double *value) {
    (void)k;
    copy3(value, world->ctx.period);
}
READ(unbalanced, world->ledger.unbalanced)
READ(particles, (double)gn_dem_present_count(&world->dem))
READ(added_kinetic, gn_timestep_added_kinetic(&world->dem))

static double broken(const gn_world *world) {
    return (double)(world->dem.broken_tension + world->dem.broken_shear);
}
/* Returns the number of bonds that are still held: bonds that were removed with particles or
 * dissolved are neither intact nor broken. */
static double bonds_left(const gn_world *world) {
    size_t left = 0;
    for (size_t c = 0;
         (world->dem.lost || world->ctx.scene.stage_count || world->ctx.scene.sink_count) &&
         c < world->dem.bonds.contacts.soa.count;
         c++)
        left += world->dem.bonds.contacts.cause[c] >= GN_BOND_LEFT &&
                world->dem.bonds.contacts.cause[c] != GN_BOND_NEVER;
    return (double)left;
}
READ(bonds_intact, (double)world->dem.bonds_at_start - broken(world) - bonds_left(world))
READ(broken_tension, (double)world->dem.broken_tension)
READ(broken_shear, (double)world->dem.broken_shear)
READ(broken_joints, (double)world->dem.broken_joints)
READ(damage,
     world->dem.bonds_at_start > 0 ? broken(world) / (double)world->dem.bonds_at_start : 0.0)

#define X(name, kind, text) READ(energy_##name, world->ledger.reading.name)
GN_ENERGY_TERMS(X)
#undef X
READ(energy_residual, gn_energy_residual(&world->ledger.reading))

static void read_returned_energy(const gn_world *world, size_t k, double *value) {
    const double share = gn_coupled_returned_share(&world->ctx, &world->solids, &world->ledger, k);
    *value = isnan(share) ? 0.0 : share;
}

READ(elements, (double)gn_elements_left_count(&world->solids))

#define SCALAR_UNLESS(absent, when, instant, name, unit, read, text)                               \
    { name, unit, text, GN_SCALAR, instant, &when, read, absent }
#define SCALAR(when, instant, name, unit, read, text)                                              \
    SCALAR_UNLESS(NULL, when, instant, name, unit, read, text)

static const gn_quantity of_the_model[] = {
    SCALAR(always, GN_BEFORE_STEP, "step", "1", read_step, "steps done"),
    SCALAR(always, GN_BEFORE_STEP, "time", "s", read_time, "time"),
    SCALAR(staged, GN_BEFORE_STEP, "stage", "1", read_stage, "stage of the scene, base 0"),
    SCALAR_UNLESS(
        no_test_strain, tests, GN_BEFORE_STEP, "strain", "1", read_test_strain,
        "travel of the ends over the length since contact of both (grains: since the start), in "
        "the test's sense; hydrostatic: loss of volume; polyaxial: shortening"),
    SCALAR(tests, GN_AFTER_STEP, "stress", "Pa", read_test_stress,
           "mean force of both ends over the area (initial; in a box of walls present), in the "
           "test's sense; confined, polyaxial: deviator; hydrostatic: mean pressure"),
    SCALAR(ended, GN_AFTER_STEP, "stress_lower", "Pa", read_test_lower,
           "force on the lower end over the area"),
    SCALAR(ended, GN_AFTER_STEP, "stress_upper", "Pa", read_test_upper,
           "force on the upper end over the area"),
    SCALAR(ended, GN_AFTER_STEP, "force", "N", read_test_force,
           "mean of both ends' force, positive in the test's sense"),
    SCALAR(ended, GN_BEFORE_STEP, "deflection", "m", read_deflection,
           "change of the distance of the ends, positive in the test's sense"),
    SCALAR_UNLESS(
        no_strain, voluminous, GN_BEFORE_STEP, "volumetric_strain", "1", read_volumetric_strain,
        "trace of the average strain, the change of volume over volume while strains are small, "
        "compression positive; polyaxial: loss of volume of the walls or box"),
    SCALAR_UNLESS(no_strain, confined, GN_BEFORE_STEP, "lateral_strain", "1", read_lateral_strain,
                  "average strain across the axis, mean of the directions, compression positive"),
    SCALAR(pressed, GN_AFTER_STEP, "membrane_pressure", "Pa", read_membrane_pressure,
           "pressure of the membrane"),
    SCALAR(pressed, GN_AFTER_STEP, "membrane_area", "m2", read_membrane_area,
           "area that the membrane covers, at its last update"),
    SCALAR(sheared, GN_AFTER_STEP, "normal_stress", "Pa", read_normal_stress,
           "force across the sheared plane over the area, compression positive: mean of both ends"),
    SCALAR(sheared, GN_AFTER_STEP, "normal_stress_lower", "Pa", read_normal_lower,
           "force on the lower end across the sheared plane over the area, compression positive"),
    SCALAR(sheared, GN_AFTER_STEP, "normal_stress_upper", "Pa", read_normal_upper,
           "force on the upper end across the sheared plane over the area, compression positive; "
           "for a set that is loaded by a force that force"),
    SCALAR(sheared, GN_BEFORE_STEP, "dilation", "m", read_dilation,
           "growth of the distance of the ends across the sheared plane"),
    SCALAR(gauged, GN_BEFORE_STEP, "opening", "m", read_opening,
           "growth of the distance of the two sides of the gauge of the test"),
    SCALAR(controlled, GN_BEFORE_STEP, "control", "1", read_machine,
           "factor of the prescribed motion of the ends"),
    {"centre_stress", "Pa", "mean stress about the middle of the disc, tension positive", GN_TENSOR,
     GN_AFTER_STEP, &central, read_centre_stress, NULL},
    {"strain", "1", "average strain of the remaining specimen, tension positive", GN_TENSOR,
     GN_BEFORE_STEP, &strained, read_strain, no_strain},
    {"stress", "Pa",
     "average stress of the specimen, tension positive; over the volume that walls, a membrane or "
     "a box enclose now, else over the volume at the start",
     GN_TENSOR, GN_AFTER_STEP, &always, read_stress, NULL},
    {"box", "m", "lengths of the periodic box; 0 along an axis without sides", GN_VECTOR,
     GN_BEFORE_STEP, &boxed, read_box, NULL},
    SCALAR(always, GN_AFTER_STEP, "unbalanced", "1", read_unbalanced,
           "mean resultant on a free particle over the mean force of loaded contacts, walls "
           "included; if larger, that of elements or free bodies; at most 1000; 0: none"),
    SCALAR(counted, GN_AFTER_STEP, "particles", "1", read_particles,
           "number of particles; with couple.convert of the active ones: those of converted "
           "elements and of the zone around them"),
    SCALAR(raised, GN_AFTER_STEP, "added_kinetic", "1", read_added_kinetic,
           "share of added mass in the particles' kinetic energy"),
    SCALAR(bonded, GN_AFTER_STEP, "bonds_intact", "1", read_bonds_intact, "intact bonds"),
    SCALAR(bonded, GN_AFTER_STEP, "broken_tension", "1", read_broken_tension,
           "bonds broken in tension"),
    SCALAR(bonded, GN_AFTER_STEP, "broken_shear", "1", read_broken_shear, "bonds broken in shear"),
    SCALAR(jointed, GN_AFTER_STEP, "broken_joints", "1", read_broken_joints,
           "contacts across joints that have broken"),
    SCALAR(bonded, GN_AFTER_STEP, "damage", "1", read_damage,
           "broken bonds over bonds at the start"),
#define X(name, kind, text)                                                                        \
    SCALAR(booked, GN_AFTER_STEP, "energy_" #name, "J", read_energy_##name, text),
    GN_ENERGY_TERMS(X)
#undef X
        SCALAR(booked, GN_AFTER_STEP, "energy_residual", "1", read_energy_residual,
               GN_ENERGY_RESIDUAL_TEXT)};

/* --- of walls, bodies, sets --- */

static size_t one(const gn_world *world) {
    (void)world;
    return 1;
}

static size_t wall_count(const gn_world *world) {
    return world->ctx.scene.wall_count;
}
static const char *wall_name(const gn_world *world, size_t k) {
    return world->ctx.scene.walls[k].name;
}
static void read_wall_force(const gn_world *world, size_t k, double *value) {
    copy3(value, world->boundary.walls[k].force);
}
static void read_wall_displacement(const gn_world *world, size_t k, double *value) {
    difference3(value, world->boundary.walls[k].point, world->boundary.walls[k].start);
}

static const gn_quantity of_walls[] = {{"force", "N", "force of particles and bodies on the wall",
                                        GN_VECTOR, GN_AFTER_STEP, &always, read_wall_force, NULL},
                                       {"displacement", "m", "path of the wall from its start",
                                        GN_VECTOR, GN_BEFORE_STEP, &always, read_wall_displacement,
                                        NULL}};

static size_t body_count(const gn_world *world) {
    return world->ctx.scene.body_count;
}
static const char *body_name(const gn_world *world, size_t k) {
    return world->ctx.scene.bodies[k].name;
}
static void read_body_force(const gn_world *world, size_t k, double *value) {
    copy3(value, world->boundary.bodies[k].force);
}
static void read_body_moment(const gn_world *world, size_t k, double *value) {
    copy3(value, world->boundary.bodies[k].moment);
}
static void read_body_displacement(const gn_world *world, size_t k, double *value) {
    difference3(value, world->boundary.bodies[k].position, world->boundary.bodies[k].start);
}
static void read_body_velocity(const gn_world *world, size_t k, double *value) {
    copy3(value, world->boundary.bodies[k].velocity);
}

static const gn_quantity of_bodies[] = {
    {"force", "N", "force of particles and walls on the body", GN_VECTOR, GN_AFTER_STEP, &always,
     read_body_force, NULL},
    {"moment", "N m", "moment of these forces about the reference point of the body", GN_TURN,
     GN_AFTER_STEP, &always, read_body_moment, NULL},
    {"displacement", "m", "path of the reference point from its start", GN_VECTOR, GN_BEFORE_STEP,
     &always, read_body_displacement, NULL},
    {"velocity", "m/s", "velocity of the reference point at the last half step", GN_VECTOR,
     GN_BEFORE_STEP, &always, read_body_velocity, NULL}};

static size_t set_count(const gn_world *world) {
    return world->ctx.scene.set_count;
}
static const char *set_name(const gn_world *world, size_t k) {
    return world->ctx.scene.sets[k].name;
}
static void read_set_reaction(const gn_world *world, size_t k, double *value) {
    copy3(value, world->dem.set_reaction + 6 * k);
}

static const gn_quantity of_sets[] = {{"reaction", "N",
                                       "force that the prescribed motion supplies to the set",
                                       GN_VECTOR, GN_AFTER_STEP, &moving, read_set_reaction, NULL}};

/* --- of sources and sinks --- */

static size_t source_count(const gn_world *world) {
    return world->ctx.scene.source_count;
}
static const char *source_name(const gn_world *world, size_t k) {
    return world->ctx.scene.sources[k].name;
}
static size_t sink_count(const gn_world *world) {
    return world->ctx.scene.sink_count;
}
static const char *sink_name(const gn_world *world, size_t k) {
    return world->ctx.scene.sinks[k].name;
}

/* Defines a function that reads a quantity of one source (sink). */
#define READ_ONE(what, name, expression)                                                           \
    static void read_##what##_##name(const gn_world *world, size_t k, double *value) {             \
        const gn_##what##_state *s = &world->dem.flow.what##s[k];                                  \
        (void)s;                                                                                   \
        *value = (expression);                                                                     \
    }
READ_ONE(source, number, s->number)
READ_ONE(source, mass, s->mass)
READ_ONE(source, behind, gn_flow_behind(&world->ctx, &world->dem, k))
READ_ONE(sink, number, s->number)
READ_ONE(sink, mass, s->mass)
/* Rate since the last row; the first row has none. */
READ_ONE(sink, rate,
         world->ctx.time > s->row_time ? (s->mass - s->row_mass) / (world->ctx.time - s->row_time)
                                       : 0.0)
static void read_source_momentum(const gn_world *world, size_t k, double *value) {
    copy3(value, world->dem.flow.sources[k].momentum);
}
static void read_sink_momentum(const gn_world *world, size_t k, double *value) {
    copy3(value, world->dem.flow.sinks[k].momentum);
}

static const gn_quantity of_sources[] = {
    SCALAR(always, GN_AFTER_STEP, "number", "1", read_source_number, "particles inserted"),
    SCALAR(always, GN_AFTER_STEP, "mass", "kg", read_source_mass, "mass inserted"),
    {"momentum", "N s", "momentum inserted", GN_VECTOR, GN_AFTER_STEP, &always,
     read_source_momentum, NULL},
    SCALAR(always, GN_AFTER_STEP, "behind", "s", read_source_behind,
           "delay of the inserted mass behind its rate, for lack of space")};

static const gn_quantity of_sinks[] = {
    SCALAR(
        always, GN_AFTER_STEP, "number", "1", read_sink_number,
        "particles removed; for a plane that only counts, passages forwards less those backwards"),
    SCALAR(always, GN_AFTER_STEP, "mass", "kg", read_sink_mass, "mass removed"),
    SCALAR(always, GN_AFTER_STEP, "rate", "kg/s", read_sink_rate,
           "mass removed since the last row, over the time"),
    {"momentum", "N s", "momentum removed", GN_VECTOR, GN_AFTER_STEP, &always, read_sink_momentum,
     NULL}};

/* --- of finite elements --- */

static const gn_quantity of_elements[] = {
    {"elements_strain", "1", "average strain of the finite elements, tension positive", GN_TENSOR,
     GN_BEFORE_STEP, &beside, read_elements_strain, NULL},
    {"elements_stress", "Pa", "average stress of the finite elements, tension positive", GN_TENSOR,
     GN_AFTER_STEP, &beside, read_elements_stress, NULL},
    SCALAR(converted, GN_AFTER_STEP, "elements", "1", read_elements,
           "number of remaining finite elements"),
    SCALAR(zoned, GN_AFTER_STEP, "returned_energy", "1", read_returned_energy,
           "energy of plane waves that travel away from the particles of the first zone, in "
           "elements outside of zones, over the initial energy and the energy supplied")};

static size_t motion_count(const gn_world *world) {
    return gn_elements_motions(&world->solids);
}

static const char *motion_name(const gn_world *world, size_t k) {
    return gn_elements_motion_name(&world->solids, k);
}

static void read_motion_travel(const gn_world *world, size_t k, double *value) {
    gn_elements_travel(&world->solids, k, value);
}

static void read_motion_reaction(const gn_world *world, size_t k, double *value) {
    gn_elements_reaction(&world->solids, k, value);
}

static const gn_quantity of_motions[] = {
    {"displacement", "m", "mean displacement of the nodes", GN_VECTOR, GN_BEFORE_STEP, &always,
     read_motion_travel, NULL},
    {"reaction", "N", "force that the prescribed motion supplies to the nodes", GN_VECTOR,
     GN_AFTER_STEP, &driven, read_motion_reaction, NULL}};

/* --- the whole list --- */

const gn_quantity_group gn_quantity_groups[GN_QUANTITY_GROUPS] = {
    {NULL, one, NULL, of_the_model, COUNT(of_the_model), NULL, false},
    {NULL, one, NULL, gn_grain_quantities, GN_GRAIN_QUANTITIES, NULL, false},
    {"wall", wall_count, wall_name, of_walls, COUNT(of_walls), NULL, false},
    {"body", body_count, body_name, of_bodies, COUNT(of_bodies), "bodies", true},
    {"set", set_count, set_name, of_sets, COUNT(of_sets), NULL, false},
    {"source", source_count, source_name, of_sources, COUNT(of_sources), NULL, false},
    {"sink", sink_count, sink_name, of_sinks, COUNT(of_sinks), NULL, false},
    {"joint", gn_joint_quantity_count, gn_joint_quantity_owner, gn_joint_quantities,
     GN_JOINT_QUANTITIES, NULL, false},
    {NULL, one, NULL, gn_cut_quantities, GN_CUT_QUANTITIES, NULL, false},
    {NULL, one, NULL, of_elements, COUNT(of_elements), NULL, false},
    {"motion", motion_count, motion_name, of_motions, COUNT(of_motions), "motions", false}};
