#include "cli/plan.h"

#include "base/new.h"
#include "base/point.h"
#include "base/timer.h"
#include "boundary/body_walls.h"
#include "boundary/boundary.h"
#include "boundary/overlap.h"
#include "cli/plan_convert.h"
#include "cli/plan_cost.h"
#include "cli/plan_parts.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
#include "conversion/conversion.h"
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "laboratory/cutting.h"
#include "laboratory/ends.h"
#include "laboratory/laboratory.h"
#include "membrane/membrane.h"
#include "particles/bonds.h"
#include "particles/dormant.h"
#include "particles/observe.h"
#include "particles/specimen.h"
#include "scene/stages.h"
#include "timestep/timestep.h"
#include "world/scale.h"

#include <math.h>
#include <stdlib.h>

static void print_effects(const gn_world *world) {
    printf("effects\n");
    for (int k = 0; k < GN_EFFECT_COUNT; k++)
        printf("  %c %-22s %s\n", world->ctx.effects >> k & 1 ? '+' : '-',
               gn_effect_name((gn_effect_index)k), gn_effect_text((gn_effect_index)k));
}

static void print_record(const gn_record *record, const char *name, gn_effects effects,
                         size_t count) {
    printf("  %-18s %10zu x %4zu bytes:", name, count, gn_record_bytes(record, effects));
    for (size_t f = 0; f < record->field_count; f++)
        if (gn_field_active(&record->fields[f], effects)) printf(" %s", record->fields[f].name);
    printf("\n");
}

/* Prints how forces are summed on particles, and which parameters are equal for all contacts. */
static void print_sums(const char *name, const gn_partials *partials, const gn_uniform *same) {
    if (!partials->blocks) return;
    printf("  forces of %-8s %10d rows of %zu bytes, in %zu blocks of %zu contacts", name,
           partials->first[partials->blocks], gn_partials_row_bytes(partials), partials->blocks,
           partials->length);
    size_t any = 0;
    printf("; the same for all:");
#define X(name)                                                                                    \
    if (same->name) printf(" " #name);                                                             \
    any |= same->name;
    GN_UNIFORM_COLUMNS(X)
#undef X
    printf("%s\n", any ? "" : " nothing");
}

static void print_particle_storage(const gn_world *world) {
    print_record(&gn_particle_record, "particles", world->ctx.effects,
                 world->dem.particles.soa.count);
    if (world->dem.bonds.contacts.soa.count)
        print_record(&gn_contact_record, "bonds", world->dem.bonds.contacts.soa.effects,
                     world->dem.bonds.contacts.soa.count);
    print_record(&gn_contact_record, "pairs", world->dem.pairs.contacts.soa.effects,
                 world->dem.pairs.contacts.soa.count);
    if (world->ctx.effects & GN_FX_WALLS)
        print_record(&gn_wall_contact_record, "wall contacts", world->ctx.effects,
                     world->boundary.contacts.soa.count);
    print_sums("bonds", &world->dem.bonds.partials, &world->dem.bonds.uniform);
    print_sums("pairs", &world->dem.pairs.partials, &world->dem.pairs.uniform);
}

static void print_particle_kernels(const gn_world *world) {
    char name[200];
    if (world->dem.bonds.contacts.soa.count) {
        gn_contact_variant_name(gn_contact_variant(world->dem.bonds.contacts.soa.effects), name,
                                sizeof name);
        printf("  bonds   %s\n", name);
    }
    gn_contact_variant_name(gn_contact_variant(world->dem.pairs.contacts.soa.effects), name,
                            sizeof name);
    printf("  pairs   %s\n", name);
    gn_motion_variant_name(gn_motion_variant(world->ctx.effects), name, sizeof name);
    printf("  motion  %s\n", name);
}

static void print_kernels(const gn_world *world) {
    bool mixed = world->ctx.effects & GN_FX_MIXED;
    int lanes = mixed && world->ctx.kernels->lanes > 1 ? 2 * world->ctx.kernels->lanes
                                                       : world->ctx.kernels->lanes;
    printf("kernels (%s, %d lanes, %s)\n", world->ctx.kernels->name, lanes,
           mixed ? "mixed" : "double");
    if (world->ctx.scene.has_specimen) print_particle_kernels(world);
    gn_print_element_kernels(world);
}

/* Prints why the limit of the step is below that of the springs in contact. */
static void print_lowered(const gn_world *world) {
    double share = gn_nonviscous_share(&world->ctx), particles = world->ctx.choice.stable;
    if (world->solids.count) return;
    if (share < 1.0)
        printf("                   less %.3f for non-viscous damping, which stiffens the fastest "
               "mode\n",
               share);
    if (world->ctx.stable < 0.999 * share * particles)
        printf("                   less %.3f for bodies that yield to particles\n",
               world->ctx.stable / (share * particles));
}

static void print_particle_limits(const gn_world *world) {
    double sharp = world->ctx.choice.limit.sharp;
    if (world->solids.count) printf("  particles\n");
    if (world->ctx.choice.limit.bound == INFINITY && world->ctx.choice.stable == INFINITY) {
        printf("  contacts         none that could limit the step: no particle can move\n");
        return;
    }
    if (world->ctx.choice.limit.bound == INFINITY) {
        printf("  contacts to come %.6g s, as there are no contacts yet\n",
               world->ctx.choice.stable);
        print_lowered(world);
        return;
    }
    if (world->ctx.choice.limit.iterations == 0)
        printf(
            "  sharp limit      not computed: the rigorous bound suffices and replaces it below\n");
    else
        printf("  sharp limit      %.6g s  (Lanczos, %d vectors; fastest mode at particle %d)\n",
               sharp, world->ctx.choice.limit.iterations, world->ctx.choice.limit.sharp_id);
    print_lowered(world);
    printf("  rigorous bound   %.6g s  = %.3f of the sharp limit (particle %d)\n",
           world->ctx.choice.limit.bound, world->ctx.choice.limit.bound / sharp,
           world->ctx.choice.limit.bound_id);
    printf("  literature       %.6g s  = %.3f of the sharp limit (min 2 sqrt(m/k), one spring); "
           "with its factor "
           "%.2f: %.3f\n",
           world->ctx.choice.limit.literature, world->ctx.choice.limit.literature / sharp,
           world->ctx.scene.dimension == 3 ? 0.17 : 0.3,
           (world->ctx.scene.dimension == 3 ? 0.17 : 0.3) * world->ctx.choice.limit.literature /
               sharp);
}

/* Prints the limits of the step from collisions, and from particles that may touch before the lists
 * are rebuilt. */
static void print_contacts_to_come(const gn_world *world) {
    const gn_resolution *r = &world->ctx.choice.resolution;
    char text[GNEISS_MESSAGE_SIZE];
    if (r->step < INFINITY)
        printf("  collisions       %.6g s resolves the shortest, %.6g s between %s, in %.4g steps; "
               "it gets %.4g\n",
               r->step, r->contact, gn_resolution_text(&world->ctx, text, sizeof text),
               r->contact / r->step, r->contact / world->ctx.dt);
    else
        printf("  collisions       none that need to be resolved\n");
    if (world->ctx.effects & GN_FX_BONDS && world->ctx.effects & GN_FX_ENERGY &&
        world->ctx.scene.step == 0.0 && gn_timestep_is_underdamped(&world->ctx, &world->dem))
        printf("  debris           undamped: once bonds have broken, wedged particles may need "
               "steps up to four times shorter\n");
    if (world->ctx.choice.listed < INFINITY)
        printf("  near contacts    %.6g s is the stability limit with all of them in contact\n",
               world->ctx.choice.listed);
    if (*gn_timestep_warning(&world->ctx, text, sizeof text)) printf("  warning: %s\n", text);
}

static void print_mass_scaling(const gn_world *world) {
    const gn_mass_scaling *s = &world->ctx.choice.scaling;
    const gn_raised_masses *raised = &world->dem.raised;
    if (!(world->ctx.effects & GN_FX_MASS_SCALING)) return;
    if (s->step == 0.0) {
        printf("  mass scaling     none needed: the step is %.6g s without\n", s->unscaled);
        return;
    }
    printf("  mass scaling     %.6g s = %.3f of the step without (%.6g s), for %.4g kg = %.3g %% "
           "more mass, in %lld particles of %zu, at most %.3g times their own\n",
           world->ctx.dt, world->ctx.dt / s->unscaled, s->unscaled, raised->added,
           100.0 * raised->added / world->dem.mass, (long long)raised->count,
           world->dem.particles.soa.count, raised->largest);
    if (world->ctx.dt < (1.0 - 1e-9) * s->step)
        printf("  warning: time.mass_scaling: added mass does not give %.6g s\n", s->step);
}

/* Prints the servo-controlled walls whose relaxation is lowered by the step. */
static void print_servos(const gn_world *world) {
    for (size_t k = 0; k < world->ctx.scene.wall_count; k++) {
        const gn_wall_def *wall = &world->ctx.scene.walls[k];
        double most = gn_wall_servo_relaxation(&world->ctx, &world->dem, &world->boundary, k);
        if (!wall->servo.active || wall->servo.relaxation <= most) continue;
        printf("  servo            wall '%.60s': relaxation %.3g%s instead of %g, which would be "
               "unstable with this step (a smaller time.safety allows more)\n",
               wall->name, most, world->dem.damping_fraction > 0.0 ? " or less" : "",
               wall->servo.relaxation);
    }
}

static void print_step(const gn_world *world) {
    printf("step\n  dt               %.6g s%s", world->ctx.dt,
           world->ctx.scene.step > 0.0 ? " (given)" : "");
    if (world->ctx.stable < INFINITY)
        printf(" = %.3f of the stability limit %.6g s", world->ctx.dt / world->ctx.stable,
               world->ctx.stable);
    else if (world->ctx.scene.step == 0.0)
        printf(": limited by the motion of bodies per step, as there are no contacts");
    printf("\n");
    print_mass_scaling(world);
    if (world->ctx.scene.has_specimen) print_contacts_to_come(world);
    if (world->ctx.scene.has_specimen) print_particle_limits(world);
    gn_print_element_limits(world);
    gn_print_whole_limit(world);
    print_servos(world);
    if (world->solids.count && gn_nonviscous_share(&world->ctx) < 1.0)
        printf("  less             %.3f for non-viscous damping, which stiffens the fastest mode\n",
               gn_nonviscous_share(&world->ctx));
}

gneiss_status gn_plan_seconds(gn_world *world, double *seconds, gneiss_error *error) {
    gn_first_break found;
    double start = gn_now(), before = 0.0, per_step = 0.0;
    if (gn_converts(&world->ctx)) return gn_plan_converting(world, false, seconds, error);
    if (world->ctx.scene.start == GN_START_FIRST_BREAK) {
        GN_TRY(gn_first_break_start(world, NULL, &found, error));
        before = gn_now() - start;
    }
    if (world->ctx.scene.source_count) {
        gn_plan_flow flow;
        GN_TRY(gn_plan_flow_try(world, &flow, error));
        *seconds = flow.seconds;
        return GNEISS_OK;
    }
    double steps = gn_plan_steps(world);
    GN_TRY(gn_time_steps(world, world->ctx.scene.end, &per_step, error));
    *seconds = before + steps * per_step;
    return GNEISS_OK;
}

/* Finds the state of first break. All states before it are computed, because no cheaper way gives
 * it. */
static gneiss_status find_start(gn_world *world, gneiss_error *error) {
    gn_first_break found;
    if (world->ctx.scene.start != GN_START_FIRST_BREAK) return GNEISS_OK;
    double start = gn_now();
    GN_TRY(gn_first_break_start(world, NULL, &found, error));
    gn_print_first_break(world, &found);
    printf("  found in %.1f s; the step there is %.6g s\n", gn_now() - start, world->ctx.dt);
    return GNEISS_OK;
}

static gneiss_status print_all_but_memory(gn_world *world, double *coming, gneiss_error *error) {
    char text[32];
    double seconds;
    print_effects(world);
    if (!world->ctx.scene.stage_count) gn_print_idle(world); /* another stage may need the effect */
    printf("storage\n");
    if (world->ctx.scene.has_specimen) print_particle_storage(world);
    for (size_t k = 0; k < world->solids.count; k++) {
        const gn_fem_solid *solid = &world->solids.elements[k]->solid;
        print_record(&gn_particle_record, "nodes", solid->effects, solid->nodes.soa.count);
        print_record(&gn_element_record, "elements", solid->effects, solid->elements.soa.count);
    }
    print_kernels(world);
    print_step(world);
    if (gn_converts(&world->ctx)) return gn_plan_converting(world, true, &seconds, error);
    GN_TRY(find_start(world, error));
    if (world->ctx.scene.source_count) {
        gn_plan_flow flow;
        GN_TRY(gn_plan_flow_try(world, &flow, error));
        gn_print_plan_flow(world, &flow);
        *coming = fmax(0.0, flow.most - (double)flow.present);
        return GNEISS_OK;
    }
    double steps = gn_plan_steps(world), per_step = 0.0;
    double contacts = (double)gn_lists_count(&world->dem);
    GN_TRY(gn_time_steps(world, world->ctx.scene.end, &per_step, error));
    char stop[160];
    const char *stops = world->ctx.scene.stage_count
                            ? "the end of its stages"
                            : gn_stops_text(&world->ctx.scene, stop, sizeof stop);
    printf("cost\n  steps            %.0f to t = %g s%s%s\n", steps,
           world->ctx.scene.stage_count ? fmin(world->ctx.scene.end, steps * world->ctx.dt)
                                        : world->ctx.scene.end,
           *stops ? " or, if that comes first, " : "", stops);
    printf("  per step         %.1f us with %d thread%s", per_step * 1e6, world->ctx.threads,
           world->ctx.threads > 1 ? "s" : "");
    if (contacts > 0.0)
        printf(": %s contact-steps/s", gn_format_count(contacts / per_step, text, sizeof text));
    if (world->solids.count)
        printf("%s %s element-steps/s", contacts > 0.0 ? "," : ":",
               gn_format_count((double)gn_elements_totals(&world->solids).elements / per_step, text,
                               sizeof text));
    printf("\n");
    printf("  time             %s\n", gn_format_seconds(per_step * steps, text, sizeof text));
    gn_print_stages(world, per_step);
    return GNEISS_OK;
}

gneiss_status gn_print_plan(gn_world *world, gneiss_error *error) {
    double coming = 0.0;
    GN_TRY(print_all_but_memory(world, &coming, error));
    gn_print_plan_memory(world, coming);
    return GNEISS_OK;
}

void gn_print_range(const gn_world *world, int axis, double lower, double upper, const char *note) {
    double origin = world->ctx.scene.origin[axis];
    int digits = origin != 0.0 ? 12 : 6;
    printf("  %c                %.*g to %.*g m%s\n", "xyz"[axis], digits,
           gn_point_out(origin, lower), digits, gn_point_out(origin, upper), note);
}

/* --- check --- */

/* Prints radius and stiffnesses of the beams of bonds, and the factor of moments in their strength.
 */
static void print_beams(const gn_world *world) {
    const gn_contacts *b = &world->dem.bonds.contacts;
    const double n[3] = {1.0, 0.0, 0.0};
    double radius[2] = {INFINITY, 0.0}, bend[2] = {INFINITY, 0.0}, twist[2] = {INFINITY, 0.0};
    if (!b->beam || !b->soa.count) return;
    for (size_t c = 0; c < b->soa.count; c++) {
        if (!gn_contact_bonded(b, c)) continue;
        gn_law_moments m = gn_law_of(b->soa.effects)->moments(b, c, n);
        const double now[3] = {b->beam[c], m.bend, m.twist};
        double *range[3] = {radius, bend, twist};
        for (int k = 0; k < 3; k++) {
            range[k][0] = fmin(range[k][0], now[k]);
            range[k][1] = fmax(range[k][1], now[k]);
        }
    }
    printf(
        "  moments          beams of radius %.4g to %.4g m, stiffness %.4g to %.4g N m in bending",
        radius[0], radius[1], bend[0], bend[1]);
    if (world->ctx.effects & GN_FX_SPACE) printf(", %.4g to %.4g in twist", twist[0], twist[1]);
    printf("; share in strength %g\n", world->ctx.scene.bond_moment_share);
}

static void print_bond_numbers(const gn_world *world, int *warnings) {
    /* A later stage may form the bonds. */
    if (!world->dem.particles.bonds0 || world->ctx.scene.bonds != GN_SWITCH_ON) return;
    size_t none = 0, few = 0, n = world->dem.particles.soa.count;
    int most = 0;
    for (size_t p = 0; p < n; p++) {
        int b = world->dem.particles.bonds0[p];
        none += b == 0;
        few += b < (world->ctx.scene.dimension == 3 ? 4 : 3);
        most = b > most ? b : most;
    }
    printf("  bonds            %zu, %.2f per particle (2 bonds/particles), at most %d\n",
           (size_t)world->dem.bonds_at_start, 2.0 * (double)world->dem.bonds_at_start / (double)n,
           most);
    if (world->dem.bonds.contacts.soa.count > (size_t)world->dem.bonds_at_start)
        printf("  free overlaps    %zu pairs without a bond overlap, free of stress "
               "(bonds.passive_gaps)\n",
               world->dem.bonds.contacts.soa.count - (size_t)world->dem.bonds_at_start);
    print_beams(world);
    if (few)
        printf("  loosely held     %zu particles with fewer than %d bonds, %zu of them with none\n",
               few, world->ctx.scene.dimension == 3 ? 4 : 3, none);
    if (none) {
        printf("  warning: %zu particles are not bonded to anything\n", none);
        (*warnings)++;
    }
}

static void print_touching(size_t count, double deepest) {
    if (!count)
        printf("no particle touches it");
    else
        printf("%zu particle%s it, deepest %.3g m", count, count == 1 ? " touches" : "s touch",
               deepest);
}

static void print_walls(const gn_world *world, int *warnings) {
    for (size_t k = 0; k < world->ctx.scene.wall_count; k++) {
        gn_overlap overlap = gn_wall_overlap(&world->dem, &world->boundary, k);
        printf("  wall %-12s ", world->ctx.scene.walls[k].name);
        print_touching(overlap.touching, overlap.deepest);
        printf("\n");
        if (overlap.inside) {
            printf("  warning: %zu particle%s centre behind wall '%s'\n", overlap.inside,
                   overlap.inside == 1 ? " has its" : "s have their",
                   world->ctx.scene.walls[k].name);
            (*warnings)++;
        }
    }
}

/* Prints how many particles touch a surface and how deep, in the line that names it; warns of
 * particles whose centre is inside it. */
static void print_overlap(const gn_world *world, const gn_overlap *overlap, const char *name,
                          int *warnings) {
    if (world->ctx.scene.has_specimen) {
        printf("; ");
        print_touching(overlap->touching, overlap->deepest);
    }
    printf("\n");
    if (!overlap->inside) return;
    printf("  warning: %zu particle%s centre inside %s\n", overlap->inside,
           overlap->inside == 1 ? " has its" : "s have their", name);
    (*warnings)++;
}

/* A body placed without overlap presses on walls with at most twice its weight. */
static void print_on_walls(const gn_world *world, size_t body, int *warnings) {
    const double *g = world->ctx.scene.gravity;
    double most = 2.0 * world->boundary.bodies[body].mass * sqrt(gn_dot3(g, g));
    if (world->ctx.scene.bodies[body].free && world->ctx.effects & GN_FX_HERTZ &&
        !(world->ctx.scene.bodies[body].stiffness > 0.0) &&
        (world->ctx.scene.wall_count || world->ctx.scene.body_count > 1))
        printf("  body %-12s has no stiffness, and passes through walls and bodies without one\n",
               world->ctx.scene.bodies[body].name);
    for (size_t n = 0; n < world->ctx.scene.wall_count; n++) {
        gn_body_overlap o = gn_body_walls_overlap(&world->ctx, &world->boundary, body, n);
        if (!o.vertices) continue;
        printf("  body %-12s %zu vertices behind wall '%s', deepest %.3g m\n",
               world->ctx.scene.bodies[body].name, o.vertices, world->ctx.scene.walls[n].name,
               o.deepest);
        if (!(o.force > most)) continue;
        printf("  warning: wall '%s' pushes out body '%s' with %.3g N at the start\n",
               world->ctx.scene.walls[n].name, world->ctx.scene.bodies[body].name, o.force);
        (*warnings)++;
    }
}

/* Prints overlaps of two bodies; each pair is printed once. */
static gneiss_status print_on_bodies(const gn_world *world, size_t body, int *warnings,
                                     gneiss_error *error) {
    if (gn_body_misses_bodies(&world->ctx, &world->boundary, body))
        printf("  body %-12s passes through other bodies: it is not closed and convex\n",
               world->ctx.scene.bodies[body].name);
    for (size_t k = 0; k < body; k++) {
        gn_bodies_overlap o;
        GN_TRY(gn_bodies_overlap_of(&world->ctx, &world->boundary, k, body, &o, error));
        if (!(o.depth > 0.0)) continue;
        printf("  body %-12s overlaps body '%s', %.3g m on average\n",
               world->ctx.scene.bodies[body].name, world->ctx.scene.bodies[k].name, o.depth);
        if (!(o.force > o.rest)) continue;
        printf("  warning: bodies '%s' and '%s' push each other apart with %.3g N at the start\n",
               world->ctx.scene.bodies[k].name, world->ctx.scene.bodies[body].name, o.force);
        (*warnings)++;
    }
    return GNEISS_OK;
}

static gneiss_status print_bodies(const gn_world *world, const gn_overlap *overlaps, int *warnings,
                                  gneiss_error *error) {
    for (size_t k = 0; k < world->ctx.scene.body_count; k++) {
        const gn_rigid *b = &world->boundary.bodies[k];
        const int64_t *shape = world->boundary.body_shape[k];
        char at[GN_POINT_SIZE], name[GN_NAME_SIZE + 16];
        printf("  body %-12s %lld facets, %lld vertices", world->ctx.scene.bodies[k].name,
               (long long)shape[1], (long long)shape[0]);
        if (shape[2]) printf("; %lld facets without area dropped", (long long)shape[2]);
        if (world->ctx.scene.bodies[k].free) {
            printf("; free: ");
            if (b->volume > 0.0)
                printf("%.6g m3, ",
                       b->volume); /* the volume is not computed if the mass is given */
            printf("%.6g kg, centre of mass %s m", b->mass,
                   gn_point_text(world->ctx.scene.origin, b->position, at));
        }
        const size_t cavities = gn_body_cavities(&world->ctx.scene, k);
        if (cavities)
            printf("; note: %zu closed part%s in another one count%s as %s", cavities,
                   cavities == 1 ? "" : "s", cavities == 1 ? "s" : "",
                   cavities == 1 ? "a cavity" : "cavities");
        snprintf(name, sizeof name, "body '%s'", world->ctx.scene.bodies[k].name);
        print_overlap(world, &overlaps[k], name, warnings);
        print_on_walls(world, k, warnings);
        GN_TRY(print_on_bodies(world, k, warnings, error));
    }
    char light[GNEISS_MESSAGE_SIZE];
    if (*gn_timestep_light_body(&world->ctx, &world->dem, &world->boundary, light, sizeof light)) {
        printf("  warning: %s\n", light);
        (*warnings)++;
    }
    /* The surface of the elements is the last of the surfaces, after those of bodies. */
    if (world->boundary.surface_count == world->ctx.scene.body_count) return GNEISS_OK;
    const gn_surface *s = &world->boundary.surfaces[world->ctx.scene.body_count];
    printf("  elements         %zu facets for contact with particles", s->facets.count);
    print_overlap(world, &overlaps[world->ctx.scene.body_count], "the elements", warnings);
    return GNEISS_OK;
}

static gneiss_status check_surfaces(const gn_world *world, int *warnings, gneiss_error *error) {
    char text[GNEISS_MESSAGE_SIZE];
    GN_FREED gn_overlap *overlaps = NULL;
    GN_TRY(gn_new(&overlaps, world->boundary.surface_count, "surfaces", error));
    GN_TRY(gn_boundary_overlaps(&world->ctx, &world->dem, &world->boundary, overlaps, error));
    GN_TRY(print_bodies(world, overlaps, warnings, error));
    if (gn_overlap_bursts(&world->ctx, &world->dem, &world->boundary, &world->box, overlaps, text,
                          sizeof text)) {
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
    return GNEISS_OK;
}

/* Unbonded particles have gaps to the ends of the specimen as they have to each other. These gaps
 * count as strain, which is reported if it is above a thousandth. */
static void print_loose_gap(const gn_world *world) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(&world->ctx, &world->dem, &world->boundary, &world->solids, &lower, &upper, away);
    const double gap = (away[0] ? 0.0 : lower) + (away[1] ? 0.0 : upper);
    if (world->ctx.effects & GN_FX_BONDS || !(gap > 1e-3 * world->ctx.test_length)) return;
    printf("  ends             begin %.4g m in total away from the outermost unbonded particles: "
           "strain counts from the start, up to %.2g before contact at both ends\n",
           gap, gap / world->ctx.test_length);
}

/* Prints which definitions the moduli and strains of the test follow. */
static void print_section(const gn_world *world) {
    const gn_bar_section *x = &world->section;
    if (x->mean > 0.0 && x->guessed != 0.0)
        printf("  section          varies along %c, %.3g of the mean at the narrowest section, and "
               "no shape gives it: moduli are read as for a prism, over %.4g m2\n",
               "xyz"[world->ctx.scene.test.axis], x -> narrowest / x -> mean,
               world -> ctx.test_area);
    else if (x->mean > 0.0)
        printf("  section          %.4g m2 on average, %.4g m2 at the narrowest section: %s, "
               "stresses over %.4g m2\n",
               x->mean, x->narrowest,
               isnan(gn_section_by_ends(&world->ctx, x)) ? "no modulus is read"
                                                         : "moduli are read by the mean of 1/area",
               world->ctx.test_area);
    if (x->mean > 0.0 && x->guessed == 0.0 && x->spread > 0.02)
        printf("  section          changes fast relative to its width: moduli are read about %.2g "
               "%% too low, as stresses spread gradually\n",
               100.0 * x->spread);
    const gn_test *test = &world->ctx.scene.test;
    const double mean = world->ctx.volume / gn_tested_side(&world->ctx, &world->solids,
                                                           test->axis < 0 ? 0 : (int)test->axis);
    const bool given = gn_scene_test(&world->ctx.scene)->prism &&
                       (test->given.area > 0.0 || test->given.diameter > 0.0);
    if (given && !world->ctx.scene.has_couple && fabs(world->ctx.test_area / mean - 1.0) > 0.02)
        printf("  area             %.4g m2 is given, where volume over length is %.4g m2\n",
               world->ctx.test_area, mean);
    if (world->approach.gap > 0.0)
        printf("  ends             begin %.4g m in total away from the specimen: strain counts "
               "from contact\n",
               world->approach.gap);
    print_loose_gap(world);
}

static void print_volume(const gn_world *world) {
    bool space = world->ctx.scene.dimension == 3;
    printf(
        "  volume           %.6g m3%s, of %s; mass %.6g kg\n", world->ctx.volume,
        space ? "" : " (1 m thick)",
        gn_volume_source_text(&world->ctx, gn_volume_source_of(&world->ctx, &world->dem,
                                                               &world->boundary, &world->solids)),
        gn_world_mass(&world->dem, &world->solids));
    if (!gn_scene_tested(&world->ctx.scene)) return;
    const char *source = gn_test_area_source(&world->ctx);
    printf("  test             length %.6g m, area %.6g %s%s%s\n", world->ctx.test_length,
           world->ctx.test_area, space ? "m2" : "m2 (1 m thick)", *source ? ", " : "", source);
}

static void print_membrane(const gn_world *world) {
    size_t skin = 0;
    if (!(world->ctx.effects & GN_FX_MEMBRANE)) return;
    for (size_t p = 0; p < world->dem.particles.soa.count; p++)
        skin += world->dem.particles.skin[4 * p + 3] > 0.0;
    const bool on_shape = gn_scene_membrane_on_shape(&world->ctx.scene);
    printf("  membrane         %.6g m2 of the surface of the %s on %zu particles\n",
           gn_membrane_area(&world->dem), on_shape ? "shape" : "particles", skin);
    printf("  within it        %.6g m3%s, to which the mean stress refers%s\n",
           gn_membrane_volume(&world->ctx, &world->membrane),
           world->ctx.scene.dimension == 3 ? "" : " (1 m thick)",
           on_shape ? ": all of the shape" : "");
}

/* Removes pairs within clumps, which have no contact. */
static void drop_bound(const gn_dem *dem, gn_pair_list *pairs) {
    size_t kept = 0;
    for (size_t c = 0; dem->clumps.count && c < pairs->count; c++) {
        const int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        if (gn_clump_binds(dem, i, j)) continue;
        pairs->pair[kept][0] = i;
        pairs->pair[kept++][1] = j;
    }
    if (dem->clumps.count) pairs->count = kept;
}

static void print_porosity(const gn_world *world, double porosity) {
    const gn_clumps *clumps = &world->dem.clumps;
    if (!clumps->count) {
        printf("  porosity         %.2f %% (overlapping volume counted twice)\n", 100.0 * porosity);
        return;
    }
    printf("  clumps           %zu of %zu particles\n", clumps->count, clumps->member_count);
    const double once = gn_dem_porosity(&world->ctx, &world->dem);
    if (once < 0.0)
        printf("  porosity         none: clumps and particles fill more than their extent, as "
               "overlap between them counts twice\n");
    else
        printf("  porosity         %.2f %% (overlap within clumps counted once)\n", 100.0 * once);
}

static gneiss_status check_particles(const gn_world *world, int *warnings, gneiss_error *error) {
    gn_pair_query query = {&world->dem.particles,
                           (int)world->ctx.scene.dimension,
                           0.0,
                           0.05,
                           world->ctx.effects & GN_FX_PERIODIC,
                           {world->ctx.period[0], world->ctx.period[1], world->ctx.period[2]},
                           world->ctx.threads};
    gn_pair_list pairs = {0};
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    drop_bound(&world->dem, &pairs);
    gn_assembly assembly = gn_assembly_of(&world->ctx, &world->dem, &world->boundary);
    gn_packing_figures at1, at5;
    char narrow[GNEISS_MESSAGE_SIZE];
    gn_packing_measure(&assembly, (const int32_t *)pairs.pair, pairs.count, 0.01, world->ctx.volume,
                       &at1);
    gn_packing_measure(&assembly, (const int32_t *)pairs.pair, pairs.count, 0.05, world->ctx.volume,
                       &at5);
    gn_pair_list_free(&pairs);
    printf("specimen\n  particles        %zu, radius %.4g to %.4g m, mean %.4g m\n", at5.particles,
           at5.radius_min, at5.radius_max, at5.radius_mean);
    for (int a = 0; a < (int)world->ctx.scene.dimension; a++)
        gn_print_range(world, a, world->ctx.lower[a], world->ctx.upper[a], " (surfaces)");
    print_volume(world);
    print_membrane(world);
    if (gn_specimen_is_narrow(&world->ctx, &world->dem, narrow, sizeof narrow)) {
        printf("  warning: %s\n", narrow);
        (*warnings)++;
    }
    print_porosity(world, at5.porosity);
    printf("  coordination     %.2f at gaps up to 1 %%, %.2f up to 5 %% of r_i + r_j\n",
           at1.coordination, at5.coordination);
    printf("  fabric           %.4f %.4f %.4f\n", at5.fabric[0], at5.fabric[4], at5.fabric[8]);
    if (at5.overlap_i < 0)
        printf("  overlaps         none\n");
    else
        printf(
            "  overlaps         at most %.2f %% of r_i + r_j (particles %d and %d), mean %.2f %%\n",
            100.0 * at5.overlap_max, at5.overlap_i, at5.overlap_j, 100.0 * at5.overlap_mean);
    const double stored = gn_contacts_stored(&world->ctx, &world->dem, &world->box);
    if (at5.overlap_max > 0.02 && gn_stored_matters(&world->ctx, &world->dem, stored)) {
        printf("  warning: overlaps are not stress-free in this scene: contacts store %.3g J, and "
               "the specimen will expand abruptly\n",
               stored);
        (*warnings)++;
    }
    print_bond_numbers(world, warnings);
    GN_TRY(gn_print_law(world, warnings, error));
    print_walls(world, warnings);
    return GNEISS_OK;
}

/* Warns of sources that feed too fast for the length of the run, and of sinks that are too thin for
 * the particles. */
static void print_flow(const gn_world *world, int *warnings) {
    char text[GNEISS_MESSAGE_SIZE];
    for (size_t k = 0; k < world->ctx.scene.sink_count; k++) {
        if (!gn_sink_is_too_thin(&world->ctx, &world->dem, k, text, sizeof text)) continue;
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
    for (size_t k = 0; k < world->ctx.scene.source_count; k++) {
        const double late = gn_flow_late(&world->ctx, &world->dem, k);
        if (!(late > 0.0)) continue;
        printf("  warning: source '%s' creates particles at most every 50 steps (%.4g s), and is "
               "still active at time.end: up to %.0f of %.0f will be missing then; a longer run, a "
               "shorter step or an end of the source avoids it\n",
               world->ctx.scene.sources[k].name, 50.0 * world->ctx.dt, late,
               gn_flow_expected(&world->ctx, &world->dem, k));
        (*warnings)++;
    }
}

static void print_origin(const gn_world *world) {
    const double *o = world->ctx.scene.origin, none[3] = {0, 0, 0};
    char at[GN_POINT_SIZE];
    if (o[0] == 0.0 && o[1] == 0.0 && o[2] == 0.0) return;
    printf("origin             %s m: positions are computed relative to it\n",
           gn_point_text(o, none, at));
}

static void print_end(const gn_world *world) {
    char stops[160];
    gn_stops_text(&world->ctx.scene, stops, sizeof stops);
    if (world->ctx.scene.stage_count) return; /* each stage has its own end */
    printf("end                t = %g s%s%s\n", world->ctx.scene.end, *stops ? " or " : "", stops);
}

static void print_cut(const gn_world *world, int *warnings) {
    char text[GNEISS_MESSAGE_SIZE];
    if (!gn_scene_test(&world->ctx.scene)->tool) return;
    for (gn_cutting_doubt d = GN_CUT_LOCKED; d < GN_CUT_DOUBTS; d++) {
        if (!gn_cutting_doubts(&world->ctx, &world->dem, &world->boundary, &world->cutting, d, text,
                               sizeof text))
            continue;
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
}

gneiss_status gn_print_check(gn_world *world, int *warnings, gneiss_error *error) {
    *warnings = 0;
    char doubts[GNEISS_MESSAGE_SIZE];
    print_origin(world);
    gn_dormant_swap(&world->ctx,
                    &world->dem); /* dormant particles are described in their released state */
    gneiss_status status =
        world->ctx.scene.has_specimen ? check_particles(world, warnings, error) : GNEISS_OK;
    gn_dormant_swap(&world->ctx, &world->dem);
    GN_TRY(status);
    if (gn_scale_doubts(&world->ctx, &world->dem, &world->boundary, &world->solids, doubts,
                        sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    if (gn_geometry_doubts(&world->ctx, &world->dem, &world->boundary, &world->solids, doubts,
                           sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    print_cut(world, warnings);
    if (gn_ends_doubts(&world->ctx, &world->dem, &world->solids, doubts, sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    if (!world->ctx.scene.stage_count &&
        gn_shear_is_unsupported(&world->ctx, &world->dem, doubts, sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    print_flow(world, warnings);
    GN_TRY(check_surfaces(world, warnings, error));
    gn_print_element_check(world, warnings);
    print_section(world);
    gn_print_zones(world, warnings);
    gn_print_conversion(world, warnings);
    GN_TRY(gn_print_walls_passed(world, warnings, error));
    print_end(world);
    return GNEISS_OK;
}
