/* Evaluation of the limits at which elements convert, and readings of dormant particles. */
#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/timer.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "neigh/neigh.h"
#include "particles/dormant.h"
#include "particles/particles.h"
#include "scene/couple_def.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "solids/solids.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* --- elements to convert --- */

/* Returns the fraction of the limits below which an element needs no evaluation, because the most
 * loaded element so far exceeds it. */
static double least_share(const gn_most_loaded *most_loaded) {
    return fmin(1.0, most_loaded->share);
}

/* Evaluates stresses averaged over the elements at each node, and then over the nodes of an
 * element. */
static gneiss_status find_excess_by_nodes(const gn_step_context *ctx, const gn_solids *solids,
                                          const gn_most_loaded *most_loaded, const uint8_t *kind,
                                          double *excess, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const double least = least_share(most_loaded);
    const size_t elements = b->elements.soa.count, nodes = b->nodes.soa.count;
    double(*stress)[6] = gn_alloc_array(elements + nodes + 1, sizeof *stress);
    if (!stress) return gn_conversion_no_memory(error);
    double(*nodal)[6] = stress + elements;
    gn_fem_element_stress(b, stress);
    gneiss_status status = gn_fem_nodal_stress(b, (const double(*)[6])stress, nodal, error);
    for (size_t e = 0; status == GNEISS_OK && e < elements; e++) {
        double mean[6] = {0.0};
        if (kind[e] != GN_FRONT_READY) continue;
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < 6; k++)
                mean[k] += nodal[gn_elements_node(&b->elements, a)[e]][k] / (b->dimension + 1);
        excess[e] = gn_front_excess(&ctx->scene.couple.convert, mean, least);
    }
    gn_free(stress);
    return status;
}

/* Computes the ratio of stress to limit [elements]; 0 for elements that may not convert, and for
 * ratios below `least`. */
static gneiss_status find_excess(const gn_step_context *ctx, const gn_solids *solids,
                                 const gn_most_loaded *most_loaded, const uint8_t *kind,
                                 double *excess, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const gn_convert_def *def = &ctx->scene.couple.convert;
    const double least = least_share(most_loaded);
    if (def->by == GN_CONVERT_NODES)
        return find_excess_by_nodes(ctx, solids, most_loaded, kind, excess, error);
#pragma omp parallel for schedule(static) num_threads(ctx->threads)
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double stress[6];
        if (kind[e] != GN_FRONT_READY) continue;
        gn_fem_stress_of(b, e, stress);
        excess[e] = gn_front_excess(def, stress, least);
    }
    return GNEISS_OK;
}

/* Marks elements that contain an end of a broken bond; they convert. */
static void mark_broken(const gn_dem *dem, const int32_t *place, uint8_t *kind) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    for (size_t c = 0; c < bonds->soa.count; c++) {
        if (!gn_broken(bonds->cause[c])) continue;
        for (int end = 0; end < 2; end++) {
            const int32_t p = end ? bonds->j[c] : bonds->i[c],
                          e = place[gn_dormant_element(dem, (size_t)p)];
            if (e >= 0 && kind[e] == GN_FRONT_READY) kind[e] = GN_FRONT_LEAVING;
        }
    }
}

/* Tells whether any part of an element may be nearer to a body than `reach`. */
static bool is_near_body(const gn_step_context *ctx, const gn_boundary *boundary,
                         const gn_fem_solid *b, size_t e, double reach) {
    double centre[3], radius = 0.0;
    gn_conversion_centre(b, e, centre);
    for (int c = 0; c <= b->dimension; c++) {
        double d[3], square = 0.0;
        const double *x = b->nodes.pos + 4 * (size_t)gn_elements_node(&b->elements, c)[e];
        for (int a = 0; a < 3; a++) d[a] = x[a] - centre[a];
        square = gn_dot3(d, d);
        radius = fmax(radius, sqrt(square));
    }
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_surface *s =
            &boundary->surfaces[k]; /* the surfaces of bodies are the first ones */
        double d[3], local[3];
        for (int a = 0; a < 3; a++) d[a] = centre[a] - boundary->bodies[k].position[a];
        gn_rigid_local(&boundary->bodies[k], d, local);
        if (gn_facet_tree_near(&s->tree, &s->facets, local, reach + radius, NULL)) return true;
    }
    return false;
}

/* Marks the elements near bodies, because bodies have no contact with elements; tells whether there
 * are any. */
static bool mark_near(const gn_convertible *model, uint8_t *kind) {
    const double reach = model->ctx->scene.couple.convert.near_bodies;
    bool any = false;
    for (size_t e = 0; reach > 0.0 && e < gn_elements_left_count(model->solids); e++) {
        if (kind[e] != GN_FRONT_READY ||
            !is_near_body(model->ctx, model->boundary, gn_coupled_solid(model->solids), e, reach))
            continue;
        kind[e] = GN_FRONT_LEAVING;
        any = true;
    }
    return any;
}

/* Returns the READY element with the largest excess of at least `least`; `count`: there is none. */
static size_t most_stressed(size_t count, const double *excess, double least, const uint8_t *kind) {
    size_t first = count;
    for (size_t e = 0; e < count; e++)
        if (kind[e] == GN_FRONT_READY && excess[e] >= least &&
            (first == count || excess[e] > excess[first]))
            first = e;
    return first;
}

/* Marks the elements whose load equals that of the last marked one up to rounding, as on both sides
 * of a plane of symmetry, so that the fraction per evaluation does not separate them. If more
 * elements are equal than were marked, as under uniform stress, only that fraction converts. */
static void mark_alike(size_t count, const double *excess, double last, size_t marked,
                       uint8_t *kind) {
    const double least = (1.0 - 1e-6) * last;
    size_t alike = 0;
    for (size_t e = 0; e < count; e++) alike += kind[e] == GN_FRONT_READY && excess[e] >= least;
    for (size_t e = 0; e < count && alike <= marked; e++)
        if (kind[e] == GN_FRONT_READY && excess[e] >= least) kind[e] = GN_FRONT_LEAVING;
}

/* Marks the elements beyond the limits, beginning with the most loaded one, up to the fraction that
 * may convert per evaluation. Few evaluations find any, and these find few. */
static void mark_stressed(const gn_convert_def *def, size_t count, const double *excess,
                          uint8_t *kind) {
    size_t ready = 0, marked = 0, e;
    double last = INFINITY;
    for (e = 0; e < count; e++) ready += kind[e] == GN_FRONT_READY;
    const double most = fmax(1.0, def->most * (double)ready);
    while ((double)marked + 1.0 <= most && (e = most_stressed(count, excess, 1.0, kind)) < count) {
        last = excess[e];
        kind[e] = GN_FRONT_LEAVING;
        marked++;
    }
    mark_alike(count, excess, last, marked, kind);
}

/* Tells whether an element is beyond a limit or, which is rare, a bond broke within elements. */
static bool is_due(const gn_dem *dem, const gn_solids *solids, const double *excess) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    const double *part = dem->particles.blend;
    bool due = false;
    for (size_t e = 0; e < gn_elements_left_count(solids); e++) due = due || excess[e] >= 1.0;
    for (size_t c = 0; c < bonds->soa.count && !due; c++)
        due = gn_broken(bonds->cause[c]) &&
              (part[2 * (size_t)bonds->i[c]] < 1.0 || part[2 * (size_t)bonds->j[c]] < 1.0);
    return due;
}

static gneiss_status act(const gn_convertible *model, const double *excess, uint8_t *kind,
                         gneiss_error *error) {
    const size_t elements = gn_elements_left_count(model->solids);
    size_t count;
    bool any = false;
    int32_t *place = gn_fem_places(gn_coupled_solid(model->solids), &count);
    if (!place) return gn_conversion_no_memory(error);
    mark_stressed(&model->ctx->scene.couple.convert, elements, excess, kind);
    mark_broken(model->dem, place, kind);
    gn_free(place);
    for (size_t e = 0; e < elements; e++) any = any || kind[e] == GN_FRONT_LEAVING;
    return any ? gn_conversion_convert(model, kind, error) : GNEISS_OK;
}

static void note_most_loaded(const gn_step_context *ctx, const gn_solids *solids,
                             const double *excess, gn_most_loaded *most) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    size_t at = 0;
    for (size_t e = 1; e < b->elements.soa.count; e++)
        if (excess[e] > excess[at]) at = e;
    if (!b->elements.soa.count || !(excess[at] > most->share)) return;
    *most = (gn_most_loaded){.share = excess[at], .time = ctx->time, .element = b->elements.id[at]};
    gn_conversion_centre(b, at, most->place);
}

/* Computes for each element [elements] its gn_front_kind, and the load relative to the nearest
 * limit if it may convert; the caller frees both in any case. */
static gneiss_status conversion_evaluate_limits(const gn_step_context *ctx, const gn_solids *solids,
                                                const gn_most_loaded *most_loaded, uint8_t **kind,
                                                double **excess, gneiss_error *error) {
    const size_t elements = gn_elements_left_count(solids);
    *kind = gn_alloc(elements + 1);
    *excess = gn_alloc_array(elements + 1, sizeof **excess);
    if (!*kind || !*excess) return gn_conversion_no_memory(error);
    GN_TRY(gn_conversion_kinds(ctx, solids, *kind, error));
    return find_excess(ctx, solids, most_loaded, *kind, *excess, error);
}

gneiss_status gn_conversion_convert_above(const gn_convertible *model, double part,
                                          gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    bool any = false;
    model->most_loaded->share = 0.0; /* loads below the largest one so far count as well */
    gneiss_status status = conversion_evaluate_limits(model->ctx, model->solids, model->most_loaded,
                                                      &kind, &excess, error);
    for (size_t e = 0; status == GNEISS_OK && e < gn_elements_left_count(model->solids); e++)
        if (kind[e] == GN_FRONT_READY && excess[e] > 0.0 && excess[e] >= part) {
            kind[e] = GN_FRONT_LEAVING;
            any = true;
        }
    if (any) status = gn_conversion_convert(model, kind, error);
    gn_free(kind);
    gn_free(excess);
    return status;
}

static gneiss_status look(const gn_convertible *model, gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    gneiss_status status = conversion_evaluate_limits(model->ctx, model->solids, model->most_loaded,
                                                      &kind, &excess, error);
    if (status == GNEISS_OK)
        note_most_loaded(model->ctx, model->solids, excess, model->most_loaded);
    const bool near = status == GNEISS_OK && mark_near(model, kind);
    if (status == GNEISS_OK && (near || is_due(model->dem, model->solids, excess)))
        status = act(model, excess, kind, error);
    gn_free(kind);
    gn_free(excess);
    return status;
}

gneiss_status gn_conversion_most_loaded(const gn_step_context *ctx, const gn_solids *solids,
                                        const gn_most_loaded *most_loaded, gn_most_loaded *most,
                                        gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    gneiss_status status =
        conversion_evaluate_limits(ctx, solids, most_loaded, &kind, &excess, error);
    *most = *most_loaded;
    if (status == GNEISS_OK) note_most_loaded(ctx, solids, excess, most);
    gn_free(kind);
    gn_free(excess);
    return status;
}

/* Returns the time of phases that are booked separately within a conversion. */
static double other_seconds(const double *seconds) {
    return seconds[GN_PHASE_lists] + seconds[GN_PHASE_step_limit];
}

gneiss_status gn_conversion_check_limits(const gn_convertible *model, gneiss_error *error) {
    if (model->ctx->step == 0 || model->ctx->step % model->ctx->scene.couple.convert.every != 0)
        return GNEISS_OK;
    const double start = gn_now(), others = other_seconds(model->ctx->seconds);
    gneiss_status status = look(model, error);
    model->ctx->seconds[GN_PHASE_conversion] +=
        gn_now() - start - (other_seconds(model->ctx->seconds) - others);
    return status;
}

/* --- places --- */

static gneiss_status see(const gn_convertible *model, const uint8_t *ready, size_t e, uint8_t *kind,
                         gn_conversion_places_checked *seen, gneiss_error *error) {
    int rings;
    memcpy(kind, ready, gn_elements_left_count(model->solids));
    kind[e] = GN_FRONT_LEAVING;
    GN_TRY(gn_conversion_dry_run(model, kind, &rings, error));
    const bool thin = gn_conversion_lacked_mass(model->outcome), halted = *model->outcome->halt;
    *model->outcome->halt = '\0';
    if (halted && !thin) return GNEISS_OK;
    seen->looked++;
    seen->too_few += thin;
    seen->along += rings > 0 && !thin;
    return GNEISS_OK;
}

/* Checks places that are evenly distributed over the list; large bodies get fewer of them, because
 * each place visits all elements. */
gneiss_status gn_conversion_check_places(const gn_convertible *model,
                                         gn_conversion_places_checked *seen, gneiss_error *error) {
    const size_t elements = gn_elements_left_count(model->solids),
                 size = elements + model->dem->particles.soa.count;
    const size_t most = size < 100000 ? 100 : size < 1000000 ? 25 : 6;
    uint8_t *ready = gn_alloc(elements + 1), *kind = gn_alloc(elements + 1);
    size_t count = 0, at = 0;
    *seen = (gn_conversion_places_checked){0};
    gneiss_status status = ready && kind
                               ? gn_conversion_kinds(model->ctx, model->solids, ready, error)
                               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to check elements");
    for (size_t e = 0; status == GNEISS_OK && e < elements; e++)
        count += ready[e] == GN_FRONT_READY;
    const size_t stride = count > most ? (count + most - 1) / most : 1;
    for (size_t e = 0; status == GNEISS_OK && e < elements; e++)
        if (ready[e] == GN_FRONT_READY && at++ % stride == 0)
            status = see(model, ready, e, kind, seen, error);
    gn_free(ready);
    gn_free(kind);
    return status;
}
