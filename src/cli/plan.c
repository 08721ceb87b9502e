#include "cli/plan.h"

#include "base/memory.h"
#include "base/point.h"
#include "base/timer.h"
#include "boundary/body_walls.h"
#include "boundary/overlap.h"
#include "boundary/self_intersection.h"
#include "cli/idle.h"
#include "cli/plan_convert.h"
#include "cli/plan_couple.h"
#include "cli/plan_elements.h"
#include "cli/plan_flow.h"
#include "cli/plan_law.h"
#include "cli/plan_memory.h"
#include "cli/plan_stages.h"
#include "cli/plan_time.h"
#include "cli/progress.h"
#include "conversion/conversion.h"
#include "laboratory/ends.h"
#include "laboratory/geometry.h"
#include "laboratory/laboratory.h"
#include "membrane/membrane.h"
#include "scene/stops.h"
#include "world/scale.h"

#include <math.h>
#include <stdlib.h>

static void print_effects(const gn_world *w) {
    printf("effects\n");
    for (int k = 0; k < GN_EFFECT_COUNT; k++)
        printf("  %c %-22s %s\n", w->ctx.effects >> k & 1 ? '+' : '-',
               gn_effect_name((gn_effect_index)k), gn_effect_text((gn_effect_index)k));
}

static void print_record(const gn_record *record, const char *name, gn_effects effects,
                         size_t count) {
    printf("  %-18s %10zu x %4zu bytes:", name, count, gn_record_bytes(record, effects));
    for (size_t f = 0; f < record->field_count; f++)
        if (gn_field_active(&record->fields[f], effects)) printf(" %s", record->fields[f].name);
    printf("\n");
}

/* How forces reach the particles, and which parameters are not streamed. */
static void print_sums(const char *name, const gn_partials *q, const gn_uniform *same) {
    if (!q->blocks) return;
    printf("  forces of %-8s %10d rows of %zu bytes, in %zu blocks of %zu contacts", name,
           q->first[q->blocks], gn_partials_row_bytes(q), q->blocks, q->length);
    size_t any = 0;
    printf("; the same for all:");
#define X(name)                                                                                    \
    if (same->name) printf(" " #name);                                                             \
    any |= same->name;
    GN_UNIFORM_COLUMNS(X)
#undef X
    printf("%s\n", any ? "" : " nothing");
}

static void print_particle_storage(const gn_world *w) {
    print_record(&gn_particle_record, "particles", w->ctx.effects, w->dem.particles.soa.count);
    if (w->dem.bonds.soa.count)
        print_record(&gn_contact_record, "bonds", w->dem.bonds.soa.effects, w->dem.bonds.soa.count);
    print_record(&gn_contact_record, "pairs", w->dem.pairs.soa.effects, w->dem.pairs.soa.count);
    if (w->ctx.effects & GN_FX_WALLS)
        print_record(&gn_wall_contact_record, "wall contacts", w->ctx.effects,
                     w->boundary.contacts.soa.count);
    print_sums("bonds", &w->dem.bond_partials, &w->dem.bond_uniform);
    print_sums("pairs", &w->dem.pair_partials, &w->dem.pair_uniform);
}

static void print_particle_kernels(const gn_world *w) {
    char name[200];
    if (w->dem.bonds.soa.count) {
        gn_contact_variant_name(gn_contact_variant(w->dem.bonds.soa.effects), name, sizeof name);
        printf("  bonds   %s\n", name);
    }
    gn_contact_variant_name(gn_contact_variant(w->dem.pairs.soa.effects), name, sizeof name);
    printf("  pairs   %s\n", name);
    gn_motion_variant_name(gn_motion_variant(w->ctx.effects), name, sizeof name);
    printf("  motion  %s\n", name);
}

static void print_kernels(const gn_world *w) {
    bool mixed = w->ctx.effects & GN_FX_MIXED;
    int lanes =
        mixed && w->ctx.kernels->lanes > 1 ? 2 * w->ctx.kernels->lanes : w->ctx.kernels->lanes;
    printf("kernels (%s, %d lanes, %s)\n", w->ctx.kernels->name, lanes, mixed ? "mixed" : "double");
    if (w->ctx.scene.has_specimen) print_particle_kernels(w);
    gn_print_element_kernels(w);
}

/* Why the step's limit lies below that of the springs that touch now. */
static void print_lowered(const gn_world *w) {
    double share = gn_world_nonviscous_share(&w->ctx), particles = w->dem.stable;
    if (w->solids.count) return;
    if (share < 1.0)
        printf("                   less %.3f for non-viscous damping, which stiffens the fastest "
               "mode\n",
               share);
    if (w->ctx.stable < 0.999 * share * particles)
        printf("                   less %.3f for bodies that give way to particles\n",
               w->ctx.stable / (share * particles));
}

static void print_particle_limits(const gn_world *w) {
    double sharp = w->dem.limit.sharp;
    if (w->solids.count) printf("  particles\n");
    if (w->dem.limit.bound == INFINITY && w->dem.stable == INFINITY) {
        printf("  contacts         none that could limit the step: no particle can move\n");
        return;
    }
    if (w->dem.limit.bound == INFINITY) {
        printf("  contacts to come %.6g s, since nothing touches yet\n", w->dem.stable);
        print_lowered(w);
        return;
    }
    if (w->dem.limit.iterations == 0)
        printf("  sharp limit      not computed: the rigorous bound settles it and stands for it "
               "below\n");
    else
        printf("  sharp limit      %.6g s  (Lanczos, %d vectors; fastest mode at particle %d)\n",
               sharp, w->dem.limit.iterations, w->dem.limit.sharp_id);
    print_lowered(w);
    printf("  rigorous bound   %.6g s  = %.3f of the sharp limit (particle %d)\n",
           w->dem.limit.bound, w->dem.limit.bound / sharp, w->dem.limit.bound_id);
    printf("  literature       %.6g s  = %.3f of the sharp limit (min 2 sqrt(m/k), one spring); "
           "with its factor "
           "%.2f: %.3f\n",
           w->dem.limit.literature, w->dem.limit.literature / sharp,
           w->ctx.scene.dimension == 3 ? 0.17 : 0.3,
           (w->ctx.scene.dimension == 3 ? 0.17 : 0.3) * w->dem.limit.literature / sharp);
}

/* What collisions ask for, and what may touch before the lists are made again. */
static void print_contacts_to_come(const gn_world *w) {
    const gn_resolution *r = &w->dem.resolution;
    char text[GNEISS_MESSAGE_SIZE];
    if (r->step < INFINITY)
        printf("  collisions       %.6g s resolves the shortest, %.6g s between %s, in %.4g steps; "
               "it gets %.4g\n",
               r->step, r->contact, gn_resolution_text(&w->ctx, &w->dem, text, sizeof text),
               r->contact / r->step, r->contact / w->ctx.dt);
    else
        printf("  collisions       none that would have to be resolved\n");
    if (w->ctx.effects & GN_FX_BONDS && w->ctx.effects & GN_FX_ENERGY && w->ctx.scene.step == 0.0 &&
        gn_world_rings(&w->ctx, &w->dem))
        printf(
            "  debris           undamped: once bonds have broken, what is wedged may ask for steps "
            "up to four times shorter\n");
    if (w->dem.listed < INFINITY)
        printf("  near contacts    %.6g s is the stability limit with all of them in touch\n",
               w->dem.listed);
    if (*gn_world_step_warning(&w->ctx, &w->dem, text, sizeof text))
        printf("  warning: %s\n", text);
}

static void print_mass_scaling(const gn_world *w) {
    const gn_mass_scaling *s = &w->dem.scaling;
    if (!(w->ctx.effects & GN_FX_MASS_SCALING)) return;
    if (s->step == 0.0) {
        printf("  mass scaling     none needed: the step is %.6g s without\n", s->unscaled);
        return;
    }
    printf("  mass scaling     %.6g s = %.3f of the step without (%.6g s), for %.4g kg = %.3g %% "
           "more mass, in %lld particles of %zu, at most %.3g times their own\n",
           w->ctx.dt, w->ctx.dt / s->unscaled, s->unscaled, s->added,
           100.0 * s->added / w->dem.mass, (long long)s->raised, w->dem.particles.soa.count,
           s->largest);
    if (w->ctx.dt < (1.0 - 1e-9) * s->step)
        printf("  warning: time.mass_scaling: more mass does not give %.6g s\n", s->step);
}

/* Servo walls that the step makes slower than they are asked to be. */
static void print_servos(const gn_world *w) {
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) {
        const gn_wall_def *wall = &w->ctx.scene.walls[k];
        double most = gn_world_servo_relaxation(&w->ctx, &w->dem, &w->boundary, k);
        if (!wall->servo.active || wall->servo.relaxation <= most) continue;
        printf("  servo            wall '%.60s': relaxation %.3g%s instead of %g, which would not "
               "be stable with this step (a smaller time.safety leaves more)\n",
               wall->name, most, w->dem.damping_fraction > 0.0 ? " or less" : "",
               wall->servo.relaxation);
    }
}

static void print_step(const gn_world *w) {
    printf("step\n  dt               %.6g s%s", w->ctx.dt,
           w->ctx.scene.step > 0.0 ? " (given)" : "");
    if (w->ctx.stable < INFINITY)
        printf(" = %.3f of the stability limit %.6g s", w->ctx.dt / w->ctx.stable, w->ctx.stable);
    else if (w->ctx.scene.step == 0.0)
        printf(": how far bodies go in it, since nothing can touch");
    printf("\n");
    print_mass_scaling(w);
    if (w->ctx.scene.has_specimen) print_contacts_to_come(w);
    if (w->ctx.scene.has_specimen) print_particle_limits(w);
    gn_print_element_limits(w);
    gn_print_whole_limit(w);
    print_servos(w);
    if (w->solids.count && gn_world_nonviscous_share(&w->ctx) < 1.0)
        printf("  less             %.3f for non-viscous damping, which stiffens the fastest mode\n",
               gn_world_nonviscous_share(&w->ctx));
}

gneiss_status gn_plan_seconds(gn_world *w, double *seconds, gneiss_error *error) {
    gn_first_break found;
    double start = gn_now(), before = 0.0, per_step = 0.0;
    if (gn_converts(&w->ctx)) return gn_plan_converting(w, false, seconds, error);
    if (w->ctx.scene.start == GN_START_FIRST_BREAK) {
        GN_TRY(gn_first_break_start(w, NULL, &found, error));
        before = gn_now() - start;
    }
    if (w->ctx.scene.source_count) {
        gn_plan_flow flow;
        GN_TRY(gn_plan_flow_try(w, &flow, error));
        *seconds = flow.seconds;
        return GNEISS_OK;
    }
    double steps = gn_plan_steps(w);
    GN_TRY(gn_time_steps(w, w->ctx.scene.end, &per_step, error));
    *seconds = before + steps * per_step;
    return GNEISS_OK;
}

/* The states on the way are looked for in earnest: nothing less tells where they end. */
static gneiss_status find_start(gn_world *w, gneiss_error *error) {
    gn_first_break found;
    if (w->ctx.scene.start != GN_START_FIRST_BREAK) return GNEISS_OK;
    double start = gn_now();
    GN_TRY(gn_first_break_start(w, NULL, &found, error));
    gn_print_first_break(w, &found);
    printf("  found in %.1f s; the step there is %.6g s\n", gn_now() - start, w->ctx.dt);
    return GNEISS_OK;
}

static gneiss_status print_all_but_memory(gn_world *w, gn_plan_growth *growth,
                                          gneiss_error *error) {
    char text[32];
    double seconds;
    print_effects(w);
    if (!w->ctx.scene.stage_count) gn_print_idle(w); /* another stage may need it */
    printf("storage\n");
    if (w->ctx.scene.has_specimen) print_particle_storage(w);
    for (size_t k = 0; k < w->solids.count; k++) {
        const gn_fem_solid *b = &w->solids.elements[k]->solid;
        print_record(&gn_particle_record, "nodes", b->effects, b->nodes.soa.count);
        print_record(&gn_element_record, "elements", b->effects, b->elements.soa.count);
    }
    print_kernels(w);
    print_step(w);
    if (gn_converts(&w->ctx)) return gn_plan_converting(w, true, &seconds, error);
    GN_TRY(find_start(w, error));
    if (w->ctx.scene.source_count) {
        gn_plan_flow flow;
        const double first = w->ctx.dt;
        GN_TRY(gn_plan_flow_try(w, &flow, error));
        gn_print_plan_flow(w, &flow);
        *growth = (gn_plan_growth){fmax(0.0, flow.most - (double)flow.present),
                                   fmax(1.0, first / flow.step)};
        return GNEISS_OK;
    }
    double steps = gn_plan_steps(w), per_step = 0.0;
    double contacts = (double)(w->dem.bonds.soa.count + w->dem.pairs.soa.count);
    GN_TRY(gn_time_steps(w, w->ctx.scene.end, &per_step, error));
    char stop[160];
    const char *stops = w->ctx.scene.stage_count ? "the end of its stages"
                                                 : gn_stops_text(&w->ctx.scene, stop, sizeof stop);
    printf("cost\n  steps            %.0f to t = %g s%s%s\n", steps,
           w->ctx.scene.stage_count ? fmin(w->ctx.scene.end, steps * w->ctx.dt) : w->ctx.scene.end,
           *stops ? " or, if that comes first, " : "", stops);
    printf("  per step         %.1f us with %d thread%s", per_step * 1e6, w->ctx.threads,
           w->ctx.threads > 1 ? "s" : "");
    if (contacts > 0.0)
        printf(": %s contact-steps/s", gn_format_count(contacts / per_step, text, sizeof text));
    if (w->solids.count)
        printf("%s %s element-steps/s", contacts > 0.0 ? "," : ":",
               gn_format_count((double)gn_elements_totals(&w->solids).elements / per_step, text,
                               sizeof text));
    printf("\n");
    printf("  time             %s\n", gn_format_seconds(per_step * steps, text, sizeof text));
    gn_print_stages(w, per_step);
    return GNEISS_OK;
}

gneiss_status gn_print_plan(gn_world *w, gneiss_error *error) {
    gn_plan_growth growth = {0.0, 1.0};
    GN_TRY(print_all_but_memory(w, &growth, error));
    gn_print_plan_memory(w, &growth);
    return GNEISS_OK;
}

void gn_print_range(const gn_world *w, int axis, double lower, double upper, const char *note) {
    double origin = w->ctx.scene.origin[axis];
    int digits = origin != 0.0 ? 12 : 6;
    printf("  %c                %.*g to %.*g m%s\n", "xyz"[axis], digits,
           gn_point_out(origin, lower), digits, gn_point_out(origin, upper), note);
}

/* --- check --- */

/* Stiffness and radius of the beams that bonds are, and what strength takes of their moments. */
static void print_beams(const gn_world *w) {
    const gn_contacts *b = &w->dem.bonds;
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
    if (w->ctx.effects & GN_FX_SPACE) printf(", %.4g to %.4g in twist", twist[0], twist[1]);
    printf("; share in strength %g\n", w->ctx.scene.bond_moment_share);
}

static void print_bond_numbers(const gn_world *w, int *warnings) {
    /* Of several stages a later one may form them. */
    if (!w->dem.particles.bonds0 || w->ctx.scene.bonds != GN_SWITCH_ON) return;
    size_t none = 0, few = 0, n = w->dem.particles.soa.count;
    int most = 0;
    for (size_t p = 0; p < n; p++) {
        int b = w->dem.particles.bonds0[p];
        none += b == 0;
        few += b < (w->ctx.scene.dimension == 3 ? 4 : 3);
        most = b > most ? b : most;
    }
    printf("  bonds            %zu, %.2f per particle (2 bonds/particles), at most %d\n",
           (size_t)w->dem.bonds_at_start, 2.0 * (double)w->dem.bonds_at_start / (double)n, most);
    if (w->dem.bonds.soa.count > (size_t)w->dem.bonds_at_start)
        printf(
            "  free overlaps    %zu pairs without a bond overlap, and are free of stress as they "
            "are (bonds.passive_gaps)\n",
            w->dem.bonds.soa.count - (size_t)w->dem.bonds_at_start);
    print_beams(w);
    if (few)
        printf("  loosely held     %zu particles with fewer than %d bonds, %zu of them with none\n",
               few, w->ctx.scene.dimension == 3 ? 4 : 3, none);
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

static void print_walls(const gn_world *w, int *warnings) {
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) {
        gn_overlap overlap = gn_wall_overlap(&w->dem, &w->boundary, k);
        printf("  wall %-12s ", w->ctx.scene.walls[k].name);
        print_touching(overlap.touching, overlap.deepest);
        printf("\n");
        if (overlap.inside) {
            printf("  warning: %zu particle%s centre behind wall '%s'\n", overlap.inside,
                   overlap.inside == 1 ? " has its" : "s have their", w->ctx.scene.walls[k].name);
            (*warnings)++;
        }
    }
}

/* Particles on a surface, behind what was said of it in the same line. */
static void print_overlap(const gn_world *w, const gn_overlap *overlap, const char *name,
                          int *warnings) {
    if (w->ctx.scene.has_specimen) {
        printf("; ");
        print_touching(overlap->touching, overlap->deepest);
    }
    printf("\n");
    if (!overlap->inside) return;
    printf("  warning: %zu particle%s centre inside %s\n", overlap->inside,
           overlap->inside == 1 ? " has its" : "s have their", name);
    (*warnings)++;
}

/* One that is put down without an overlap presses with twice its weight at most. */
static void print_on_walls(const gn_world *w, size_t body, int *warnings) {
    const double *g = w->ctx.scene.gravity;
    double most = 2.0 * w->boundary.bodies[body].mass * sqrt(gn_dot3(g, g));
    if (w->ctx.scene.bodies[body].free && w->ctx.effects & GN_FX_HERTZ &&
        !(w->ctx.scene.bodies[body].stiffness > 0.0) &&
        (w->ctx.scene.wall_count || w->ctx.scene.body_count > 1))
        printf("  body %-12s passes through walls and bodies without a stiffness, as it has none\n",
               w->ctx.scene.bodies[body].name);
    for (size_t n = 0; n < w->ctx.scene.wall_count; n++) {
        gn_body_overlap o = gn_body_walls_overlap(&w->ctx, &w->boundary, body, n);
        if (!o.vertices) continue;
        printf("  body %-12s %zu vertices behind wall '%s', deepest %.3g m\n",
               w->ctx.scene.bodies[body].name, o.vertices, w->ctx.scene.walls[n].name, o.deepest);
        if (!(o.force > most)) continue;
        printf("  warning: wall '%s' pushes body '%s' out with %.3g N at the start\n",
               w->ctx.scene.walls[n].name, w->ctx.scene.bodies[body].name, o.force);
        (*warnings)++;
    }
}

/* The same of two bodies; each pair is said once. */
static gneiss_status print_on_bodies(const gn_world *w, size_t body, int *warnings,
                                     gneiss_error *error) {
    if (gn_body_misses_bodies(&w->ctx, &w->boundary, body))
        printf("  body %-12s passes through other bodies: it is not closed and convex\n",
               w->ctx.scene.bodies[body].name);
    for (size_t k = 0; k < body; k++) {
        gn_bodies_overlap o;
        GN_TRY(gn_bodies_overlap_of(&w->ctx, &w->boundary, k, body, &o, error));
        if (!(o.depth > 0.0)) continue;
        printf("  body %-12s overlaps body '%s', %.3g m in the mean\n",
               w->ctx.scene.bodies[body].name, w->ctx.scene.bodies[k].name, o.depth);
        if (!(o.force > o.rest)) continue;
        printf("  warning: bodies '%s' and '%s' push each other apart with %.3g N at the start\n",
               w->ctx.scene.bodies[k].name, w->ctx.scene.bodies[body].name, o.force);
        (*warnings)++;
    }
    return GNEISS_OK;
}

static gneiss_status print_bodies(const gn_world *w, const gn_overlap *overlaps, int *warnings,
                                  gneiss_error *error) {
    for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
        const gn_rigid *b = &w->boundary.bodies[k];
        const int64_t *shape = w->boundary.body_shape[k];
        char at[GN_POINT_SIZE], name[GN_NAME_SIZE + 16];
        printf("  body %-12s %lld facets, %lld vertices", w->ctx.scene.bodies[k].name,
               (long long)shape[1], (long long)shape[0]);
        if (shape[2]) printf("; %lld facets without area dropped", (long long)shape[2]);
        if (w->ctx.scene.bodies[k].free) {
            printf("; free: ");
            if (b->volume > 0.0) printf("%.6g m3, ", b->volume); /* not found where mass is given */
            printf("%.6g kg, centre of mass %s m", b->mass,
                   gn_point_text(w->ctx.scene.origin, b->position, at));
        }
        const size_t cavities = gn_body_cavities(&w->ctx.scene, k);
        if (cavities)
            printf("; note: %zu closed part%s in another one count%s as %s", cavities,
                   cavities == 1 ? "" : "s", cavities == 1 ? "s" : "",
                   cavities == 1 ? "a cavity" : "cavities");
        snprintf(name, sizeof name, "body '%s'", w->ctx.scene.bodies[k].name);
        print_overlap(w, &overlaps[k], name, warnings);
        print_on_walls(w, k, warnings);
        GN_TRY(print_on_bodies(w, k, warnings, error));
    }
    char light[GNEISS_MESSAGE_SIZE];
    if (*gn_world_light_body(&w->ctx, &w->dem, &w->boundary, light, sizeof light)) {
        printf("  warning: %s\n", light);
        (*warnings)++;
    }
    /* The last surface, behind those of bodies, is that of elements. */
    if (w->boundary.surface_count == w->ctx.scene.body_count) return GNEISS_OK;
    const gn_surface *s = &w->boundary.surfaces[w->ctx.scene.body_count];
    printf("  elements         %zu facets that particles may touch", s->facets.count);
    print_overlap(w, &overlaps[w->ctx.scene.body_count], "the elements", warnings);
    return GNEISS_OK;
}

static gneiss_status check_surfaces(const gn_world *w, int *warnings, gneiss_error *error) {
    gn_overlap *overlaps = gn_alloc_array(w->boundary.surface_count + 1, sizeof *overlaps);
    if (!overlaps)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu surfaces",
                       w->boundary.surface_count);
    gneiss_status status =
        gn_world_overlaps(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->zones, overlaps, error);
    if (status == GNEISS_OK) status = print_bodies(w, overlaps, warnings, error);
    char text[GNEISS_MESSAGE_SIZE];
    if (status == GNEISS_OK &&
        gn_overlap_bursts(&w->ctx, &w->dem, &w->boundary, &w->box, overlaps, text, sizeof text)) {
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
    gn_free(overlaps);
    return status;
}

/* Grains that nothing bonds have gaps to the ends as they have to each other: those count as
 * strain, which is worth a line from a thousandth on. */
static void print_loose_gap(const gn_world *w) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(&w->ctx, &w->dem, &w->boundary, &w->solids, &lower, &upper, away);
    const double gap = (away[0] ? 0.0 : lower) + (away[1] ? 0.0 : upper);
    if (w->ctx.effects & GN_FX_BONDS || !(gap > 1e-3 * w->ctx.test_length)) return;
    printf("  ends             begin %.4g m in all away from the outermost grains, which nothing "
           "bonds: strain counts from the start, up to %.2g before both ends touch\n",
           gap, gap / w->ctx.test_length);
}

/* What moduli and strains of the test are read by. */
static void print_section(const gn_world *w) {
    const gn_bar_section *x = &w->section;
    if (x->mean > 0.0 && x->guessed != 0.0)
        printf(
            "  section          varies along %c, %.3g of the mean at the narrowest place, and no "
            "shape measures it: moduli are read as of a prism, over %.4g m2\n",
            "xyz"[w->ctx.scene.test.axis], x -> narrowest / x -> mean, w -> ctx.test_area);
    else if (x->mean > 0.0)
        printf("  section          %.4g m2 in the mean, %.4g m2 at the narrowest place: moduli are "
               "read by the mean of 1/area, stresses over %.4g m2\n",
               x->mean, x->narrowest, w->ctx.test_area);
    if (x->mean > 0.0 && x->guessed == 0.0 && x->spread > 0.02)
        printf("  section          changes fast beside its width: moduli are read some %.2g %% too "
               "low, as stresses spread gradually\n",
               100.0 * x->spread);
    const gn_test *t = &w->ctx.scene.test;
    const double mean =
        w->ctx.volume / gn_world_side(&w->ctx, &w->solids, t->axis < 0 ? 0 : (int)t->axis);
    const bool given =
        gn_scene_test(&w->ctx.scene)->prism && (t->given.area > 0.0 || t->given.diameter > 0.0);
    if (given && !w->ctx.scene.has_couple && fabs(w->ctx.test_area / mean - 1.0) > 0.02)
        printf("  area             %.4g m2 is given, where volume over length is %.4g m2\n",
               w->ctx.test_area, mean);
    if (w->approach.gap > 0.0)
        printf("  ends             begin %.4g m in all away from the specimen: strain counts from "
               "contact\n",
               w->approach.gap);
    print_loose_gap(w);
}

static void print_volume(const gn_world *w) {
    bool space = w->ctx.scene.dimension == 3;
    printf("  volume           %.6g m3%s, of %s; mass %.6g kg\n", w->ctx.volume,
           space ? "" : " (1 m thick)",
           gn_world_volume_source(&w->ctx, &w->dem, &w->boundary, &w->solids),
           gn_world_mass(&w->dem, &w->solids));
    if (!gn_scene_tested(&w->ctx.scene)) return;
    const char *source = gn_test_area_source(&w->ctx);
    printf("  test             length %.6g m, area %.6g %s%s%s\n", w->ctx.test_length,
           w->ctx.test_area, space ? "m2" : "m2 (1 m thick)", *source ? ", " : "", source);
}

static void print_membrane(const gn_world *w) {
    size_t skin = 0;
    if (!(w->ctx.effects & GN_FX_MEMBRANE)) return;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        skin += w->dem.particles.skin[4 * p + 3] > 0.0;
    const bool on_shape = gn_scene_membrane_on_shape(&w->ctx.scene);
    printf("  membrane         %.6g m2 of the surface of the %s on %zu particles\n",
           gn_membrane_area(&w->dem), on_shape ? "shape" : "particles", skin);
    printf("  within it        %.6g m3%s, to which the mean stress refers%s\n",
           gn_membrane_volume(&w->ctx, &w->dem), w->ctx.scene.dimension == 3 ? "" : " (1 m thick)",
           on_shape ? ": all of the shape" : "");
}

static gneiss_status check_particles(const gn_world *w, int *warnings, gneiss_error *error) {
    gn_pair_query query = {&w->dem.particles,
                           (int)w->ctx.scene.dimension,
                           0.0,
                           0.05,
                           w->ctx.effects & GN_FX_PERIODIC,
                           {w->ctx.period[0], w->ctx.period[1], w->ctx.period[2]},
                           w->ctx.threads};
    gn_pair_list pairs = {0};
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    gn_assembly assembly = gn_world_assembly(&w->ctx, &w->dem, &w->boundary);
    gn_packing_figures at1, at5;
    char narrow[GNEISS_MESSAGE_SIZE];
    gn_packing_measure(&assembly, (const int32_t *)pairs.pair, pairs.count, 0.01, w->ctx.volume,
                       &at1);
    gn_packing_measure(&assembly, (const int32_t *)pairs.pair, pairs.count, 0.05, w->ctx.volume,
                       &at5);
    gn_pair_list_free(&pairs);
    printf("specimen\n  particles        %zu, radius %.4g to %.4g m, mean %.4g m\n", at5.particles,
           at5.radius_min, at5.radius_max, at5.radius_mean);
    for (int a = 0; a < (int)w->ctx.scene.dimension; a++)
        gn_print_range(w, a, w->ctx.lower[a], w->ctx.upper[a], " (surfaces)");
    print_volume(w);
    print_membrane(w);
    if (gn_specimen_is_narrow(&w->ctx, &w->dem, narrow, sizeof narrow)) {
        printf("  warning: %s\n", narrow);
        (*warnings)++;
    }
    printf("  porosity         %.2f %% (overlapping volume counted twice)\n", 100.0 * at5.porosity);
    printf("  coordination     %.2f at gaps up to 1 %%, %.2f up to 5 %% of r_i + r_j\n",
           at1.coordination, at5.coordination);
    printf("  fabric           %.4f %.4f %.4f\n", at5.fabric[0], at5.fabric[4], at5.fabric[8]);
    if (at5.overlap_i < 0)
        printf("  overlaps         none\n");
    else
        printf(
            "  overlaps         at most %.2f %% of r_i + r_j (particles %d and %d), mean %.2f %%\n",
            100.0 * at5.overlap_max, at5.overlap_i, at5.overlap_j, 100.0 * at5.overlap_mean);
    const double stored = gn_contacts_stored(&w->ctx, &w->dem, &w->box);
    if (at5.overlap_max > 0.02 && gn_stored_matters(&w->ctx, &w->dem, stored)) {
        printf("  warning: overlaps are not stress-free in this scene: contacts hold %.3g J, and "
               "the specimen will spring apart\n",
               stored);
        (*warnings)++;
    }
    print_bond_numbers(w, warnings);
    GN_TRY(gn_print_law(w, warnings, error));
    print_walls(w, warnings);
    return GNEISS_OK;
}

/* Sources that feed too fast for the length of the run, sinks too thin for the particles. */
static void print_flow(const gn_world *w, int *warnings) {
    char text[GNEISS_MESSAGE_SIZE];
    for (size_t k = 0; k < w->ctx.scene.sink_count; k++) {
        if (!gn_sink_is_too_thin(&w->ctx, &w->dem, k, text, sizeof text)) continue;
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
    for (size_t k = 0; k < w->ctx.scene.source_count; k++) {
        const double late = gn_flow_late(&w->ctx, &w->dem, k);
        if (!(late > 0.0)) continue;
        printf(
            "  warning: source '%s' lets particles in every 50 steps at most (%.4g s), and still "
            "feeds at time.end: up to %.0f will lack there, of %.0f; a longer run, a shorter "
            "step or an end of the source avoids it\n",
            w->ctx.scene.sources[k].name, 50.0 * w->ctx.dt, late,
            gn_flow_expected(&w->ctx, &w->dem, k));
        (*warnings)++;
    }
}

static void print_origin(const gn_world *w) {
    const double *o = w->ctx.scene.origin, none[3] = {0, 0, 0};
    char at[GN_POINT_SIZE];
    if (o[0] == 0.0 && o[1] == 0.0 && o[2] == 0.0) return;
    printf("origin             %s m: positions are computed relative to it\n",
           gn_point_text(o, none, at));
}

static void print_end(const gn_world *w) {
    char stops[160];
    gn_stops_text(&w->ctx.scene, stops, sizeof stops);
    if (w->ctx.scene.stage_count) return; /* each says when it is over */
    printf("end                t = %g s%s%s\n", w->ctx.scene.end, *stops ? " or " : "", stops);
}

gneiss_status gn_print_check(gn_world *w, int *warnings, gneiss_error *error) {
    *warnings = 0;
    char doubts[GNEISS_MESSAGE_SIZE];
    print_origin(w);
    gn_conversion_turn_over(&w->ctx,
                            &w->dem); /* particles that sleep are described as they will be */
    gneiss_status status =
        w->ctx.scene.has_specimen ? check_particles(w, warnings, error) : GNEISS_OK;
    gn_conversion_turn_over(&w->ctx, &w->dem);
    GN_TRY(status);
    if (gn_scale_doubts(&w->ctx, &w->dem, &w->boundary, &w->solids, doubts, sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    if (gn_geometry_doubts(&w->ctx, &w->dem, &w->boundary, &w->solids, doubts, sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    if (gn_ends_doubts(&w->ctx, &w->dem, &w->solids, doubts, sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    if (!w->ctx.scene.stage_count && gn_shear_is_loose(&w->ctx, &w->dem, doubts, sizeof doubts)) {
        printf("  warning: %s\n", doubts);
        (*warnings)++;
    }
    print_flow(w, warnings);
    GN_TRY(check_surfaces(w, warnings, error));
    gn_print_element_check(w, warnings);
    print_section(w);
    gn_print_zones(w, warnings);
    gn_print_conversion(w, warnings);
    GN_TRY(gn_print_walls_passed(w, warnings, error));
    print_end(w);
    return GNEISS_OK;
}
