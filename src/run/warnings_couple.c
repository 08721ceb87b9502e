/* Warnings about the coupling of particles and elements. */
#include "base/point.h"
#include "conversion/conversion.h"
#include "run/warnings.h"
#include "solids/dormant_places.h"
#include "solids/element_walls.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

static void warn_of_lost(const gn_run *run, gn_warnings *list) {
    size_t count = gn_coupled_removed_count(&run->world.ctx, &run->world.zones);
    if (!count) return;
    gn_warning *to = gn_warnings_add(list, "zones_lost");
    snprintf(to->text, sizeof to->text,
             "%zu particles left coupling zones; the elements there still represent only their "
             "share of the material",
             count);
}

static void warn_of_zones(const gn_run *run, gn_warnings *list) {
    size_t count = gn_coupled_broken(&run->world.dem);
    if (!count) return;
    gn_warning *to = gn_warnings_add(list, "zones_broken");
    snprintf(to->text, sizeof to->text,
             "%zu bonds broke in coupling zones, where elements remain intact: the zone must be "
             "farther away from the crack",
             count);
}

/* Warns of elements behind walls at the end of the run. */
static void warn_of_walls(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    size_t count = 0;
    gn_warning *to = NULL;
    for (size_t k = 0; w->ctx.scene.has_couple && k < w->ctx.scene.wall_count; k++) {
        const gn_wall_passed passed = gn_wall_passed_now(&w->ctx, &w->boundary, &w->solids, k);
        if (!passed.behind || count++) continue;
        to = gn_warnings_add(list, "elements_pass_walls");
        snprintf(to->text, sizeof to->text,
                 "%zu nodes of elements are behind wall '%.60s', by at most %.3g m: elements and "
                 "walls have no contact with each other; support or load elements by a motion or a "
                 "load of their own",
                 passed.behind, w->ctx.scene.walls[k].name, passed.deepest);
    }
    const size_t used = to ? strlen(to->text) : 0;
    if (count > 1)
        snprintf(to->text + used, sizeof to->text - used, " (and behind %zu more walls)",
                 count - 1);
}

static void warn_of_zone_masses(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    for (size_t k = 0; w->ctx.scene.has_couple && k < w->ctx.scene.couple.zone_count; k++) {
        gn_zone_figures f;
        gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, k, &f);
        if (!gn_zone_is_off(&f)) continue;
        gn_warning *to = gn_warnings_add(list, "zones_masses");
        snprintf(to->text, sizeof to->text,
                 "the particles of couple.zones[%zu] have %.2f times the mass that the elements "
                 "leave them: they must fill the zone from side to side, with the elements' "
                 "density (density_basis bulk)",
                 k, f.mass);
        return;
    }
}

static void warn_of_zone_ends(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    for (size_t k = 0; w->ctx.scene.has_couple && k < w->ctx.scene.couple.zone_count; k++) {
        gn_zone_figures f;
        gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, k, &f);
        if (!f.beyond) continue;
        gn_warning *to = gn_warnings_add(list, "zones_beyond");
        snprintf(to->text, sizeof to->text,
                 "%zu of the %zu particles of couple.zones[%zu] are beyond the plane through its "
                 "`to`, where elements carry the whole load: the plane must pass through the "
                 "outermost centres",
                 f.beyond, f.particles, k);
        return;
    }
}

static void warn_of_packing(const gn_run *run, gn_warnings *list) {
    const gn_packing_differs *d = &run->world.zones.state.differs;
    if (!(d->modulus[0] > 0.0)) return;
    gn_warning *to = gn_warnings_add(list, "packing_differs");
    const bool space = run->world.ctx.scene.dimension == 3;
    char last[32] = "";
    if (space) snprintf(last, sizeof last, ", %.4g", d->tension[2]);
    snprintf(to->text, sizeof to->text,
             "the packing has a modulus of %.4g Pa (confined; along the axes with free sides %.4g, "
             "%.4g%s Pa) and a density of %.4g kg/m3, under an affine strain; elements that "
             "convert to it have %.4g Pa (%.4g Pa) and %.4g kg/m3: conversion changes the "
             "material; calibrate the particles to the elements' E and nu",
             d->modulus[0], d->tension[0], d->tension[1], last, d->density[0], d->modulus[1],
             d->tension[3], d->density[1]);
}

/* The largest share of the energy throughput that conversions may generate. The difference between
 * the strain energy of elements and the energy of the springs that replace them is a loss or a
 * gain, which the ledger contains. */
static const double made_most = 0.03;

/* Writes the largest contribution to the gain. */
static void say_what_made(const gn_conversion_parts *p, char *text, size_t size) {
    const double parts[] = {p->stiffness, p->sampled, p->uneven, p->motion, p->step};
    const char *const why[] = {
        "", "volume: particles represent more than the elements that they replace (a thin zone)",
        "strains that vary along a bond, or contacts that had slid or broken",
        "motion: masses and velocities differ from those before",
        "the step: the power of springs over half a step (a smaller time.safety)"};
    size_t worst = 0;
    for (size_t k = 1; k < sizeof parts / sizeof *parts; k++)
        if (parts[k] < parts[worst]) worst = k;
    if (worst > 0)
        snprintf(text, size, "%.3g J of it due to %s", -parts[worst], why[worst]);
    else
        snprintf(text, size,
                 "%.3g J of it due to stiffness: the particles stored %.3g times as much at the "
                 "same strain as the elements (calibrate their E and nu to those; small packings "
                 "vary between places and axes)",
                 -parts[0], p->alike[1] / p->alike[0]);
}

static void warn_of_conversion(const gn_run *run, gn_warnings *list) {
    const gn_energy *e = &run->world.ledger.reading;
    const double made = -e->conversion;
    if (!(run->world.ctx.effects & GN_FX_ENERGY && made > made_most * gn_energy_scale(e))) return;
    gn_warning *to = gn_warnings_add(list, "energy_conversion");
    char what[320];
    say_what_made(&run->world.zones.state.parts, what, sizeof what);
    snprintf(
        to->text, sizeof to->text,
        "conversion of elements to particles generated %.3g of the energy throughput of %.4g J: %s",
        made / gn_energy_scale(e), gn_energy_scale(e), what);
}

/* The largest change, relative to the largest angular momentum of the body or to m v r of its
 * vibration (gn_tally_turns). */
static const double turned_most = 0.01;

static void warn_of_jumps(const gn_run *run, gn_warnings *list) {
    const gn_corrections *c = &run->world.zones.state.corrected;
    if (!(c->most > turned_most * c->scale)) return;
    gn_warning *to = gn_warnings_add(list, "conversion_missed");
    snprintf(to->text, sizeof to->text,
             "conversion of elements to particles changed the body's angular momentum by up to "
             "%.3g kg m2/s in total, %.2g %% of its largest value (or of m v r of its vibration), "
             "its moment of inertia by %.2g %% and the position of its centre of mass by %.2g m, "
             "which the zones could not correct; zones of more elements (couple.convert.width), "
             "and elements of two particle diameters and more, reduce this",
             c->most, 100.0 * c->most / c->scale, 100.0 * c->inertia,
             sqrt(gn_dot3(c->centre, c->centre)));
}

static void warn_of_relaxation(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_relaxations *r = &w->zones.state.relaxed;
    const char *const why[] = {
        "bonds would have broken, so their ends were not moved (lower limits convert sooner)",
        "some particles had no support and were not moved",
        "couple.convert.relax_iterations were used up",
        "contacts close and open, and no step reduces the energy further"};
    const double times[] = {r->stopped_by_bond_failure, r->unsupported, r->hit_iteration_limit,
                            r->missed - r->stopped_by_bond_failure - r->unsupported -
                                r->hit_iteration_limit};
    if (!(r->missed > 0.0)) return;
    gn_warning *to = gn_warnings_add(list, "relaxation");
    int used = snprintf(to->text, sizeof to->text,
                        "%.0f of %.0f relaxations of converted particles left more than %g of the "
                        "mean contact force out of balance, at most %.2g (t = %.4g s)",
                        r->missed, r->count, w->ctx.scene.couple.convert.relax, r->worst, r->time);
    for (int k = 0; k < 4; k++)
        if (times[k] > 0.0 && used < (int)sizeof to->text)
            used += snprintf(to->text + used, sizeof to->text - (size_t)used, "; in %.0f %s",
                             times[k], why[k]);
}

/* Warns of a run without conversions, unless the model ended the run, which has a warning of its
 * own. */
static gneiss_status warn_of_rest(const gn_run *run, gn_warnings *list, gneiss_error *error) {
    const gn_world *w = &run->world;
    char at[GN_POINT_SIZE];
    gn_most_loaded n;
    if (!gn_converts(&w->ctx) || !run->finished || w->outcome.halt[0] ||
        gn_elements_have_left(&w->solids))
        return GNEISS_OK;
    GN_TRY(gn_conversion_most_loaded(&w->ctx, &w->solids, &w->most_loaded, &n, error));
    gn_warning *to = gn_warnings_add(list, "nothing_converted");
    char where[GN_POINT_SIZE + 96] = "";
    if (n.share > 0.0)
        snprintf(where, sizeof where, " in element %d at %.90s m at t = %.4g s", n.element,
                 gn_point_text(w->ctx.scene.origin, n.place, at), n.time);
    snprintf(to->text, sizeof to->text,
             "no element was converted: the highest stress was %.3g %% of a limit%s; %s",
             100.0 * n.share, where,
             n.share < 1.0 ? "lower limits (couple.convert) or more load would convert some"
                           : "no check followed (couple.convert.every)");
    return GNEISS_OK;
}

gneiss_status gn_warn_of_coupling(const gn_run *run, gn_warnings *list, gneiss_error *error) {
    if (!run->world.ctx.scene.has_couple) return GNEISS_OK;
    warn_of_zones(run, list);
    warn_of_lost(run, list);
    warn_of_walls(run, list);
    warn_of_zone_masses(run, list);
    warn_of_zone_ends(run, list);
    warn_of_packing(run, list);
    warn_of_conversion(run, list);
    warn_of_jumps(run, list);
    warn_of_relaxation(run, list);
    return warn_of_rest(run, list, error);
}
