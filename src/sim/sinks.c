/* Sinks that are thin: what passes through them between two lists, and what never fits. */
#include "sim/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

double gn_sink_width(const gn_world *w, size_t sink) {
    const gn_flow_region *r = &w->scene.sinks[sink].region;
    const gn_domain *region = w->dem.flow.region[w->scene.source_count + sink];
    double lower[3], upper[3], width = INFINITY, around = 0.0;
    if (!region) return INFINITY;
    gn_domain_bounds(region, lower, upper);
    for (int a = 0; a < gn_domain_dimension(region); a++) width = fmin(width, upper[a] - lower[a]);
    for (size_t k = 0; k < r->corner_count; k++) {
        const double *x = r->corners + 2 * k, *y = r->corners + 2 * ((k + 1) % r->corner_count);
        around += hypot(y[0] - x[0], y[1] - x[1]);
    }
    /* A long strip has 2 A/P, any other polygon less than its width. */
    return around > 0.0 ? fmin(width, 2.0 * gn_domain_volume(region) / around) : width;
}

static double largest_radius(const gn_world *w) {
    double most = gn_flow_largest_radius(w);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        most = fmax(most, w->dem.particles.pos[4 * p + 3]);
    return most;
}

/* Whether a particle can be wholly in it for hardly longer than lists may stand: the skin grows to
 * six times that of the start. */
static bool is_thin(const gn_world *w, size_t sink) {
    return w->scene.sinks[sink].remove &&
           gn_sink_width(w, sink) - 2.0 * w->dem.flow.largest < 12.0 * w->dem.verlet.skin_start;
}

enum { PLACES = 16 };

/* The way of the last step is at most half of the smallest radius (paths.c). */
static bool passed(const gn_world *w, size_t sink, size_t particle) {
    const gn_particles *q = &w->dem.particles;
    const double *x = q->pos + 4 * particle, *v = q->vel + 4 * particle;
    for (int k = 1; k < PLACES; k++) {
        double back = w->dt_past * k / PLACES, at[4] = {x[0], x[1], x[2], x[3]};
        for (int a = 0; a < 3; a++) at[a] -= back * v[a];
        if (gn_sink_has(w, sink, at)) return true;
    }
    return false;
}

bool gn_sink_takes(const gn_world *w, size_t sink, size_t particle) {
    return gn_sink_has(w, sink, w->dem.particles.pos + 4 * particle) ||
           (is_thin(w, sink) && passed(w, sink, particle));
}

/* Whether its centre is in the box about the region, the last way added. */
static bool is_near(const gn_world *w, const double lower[3], const double upper[3], size_t p) {
    const double *x = w->dem.particles.pos + 4 * p, *v = w->dem.particles.vel + 4 * p;
    for (int a = 0; a < (int)w->scene.dimension; a++) {
        const double way = w->dt_past * fabs(v[a]);
        if (x[a] + way < lower[a] || x[a] - way > upper[a]) return false;
    }
    return v[3] > 0.0;
}

bool gn_sinks_are_due(const gn_world *w) {
    for (size_t k = 0; k < w->scene.sink_count; k++) {
        const gn_domain *region = w->dem.flow.region[w->scene.source_count + k];
        double lower[3], upper[3];
        if (!region || !is_thin(w, k)) continue;
        gn_domain_bounds(region, lower, upper);
        for (size_t p = 0; p < w->dem.particles.soa.count; p++)
            if (is_near(w, lower, upper, p) && gn_sink_takes(w, k, p)) return true;
    }
    return false;
}

void gn_sinks_listed(gn_world *w) {
    if (w->scene.sink_count) w->dem.flow.largest = largest_radius(w);
}

bool gn_sink_is_too_thin(const gn_world *w, size_t sink, char *text, size_t size) {
    const double width = gn_sink_width(w, sink), most = 2.0 * largest_radius(w),
                 least = 2.0 * w->dem.radius_min;
    if (!w->scene.sinks[sink].remove || !(width < most)) return false;
    snprintf(text, size, "sink '%s' is %.4g m thick, and removes what is wholly inside: %s",
             w->scene.sinks[sink].name, width,
             width < least ? "it is thinner than any particle, and never removes one"
                           : "it is thinner than the largest particles, and never removes these");
    if (strlen(text) + 40 < size)
        snprintf(text + strlen(text), size - strlen(text), " (diameters of %.4g to %.4g m)", least,
                 most);
    return true;
}
