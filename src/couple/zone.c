#include "couple/zone.h"

#include <math.h>

static double width2(const gn_couple_edge *edge, int dimension) {
    double sum = 0.0;
    for (int a = 0; a < dimension; a++)
        sum += (edge->to[a] - edge->from[a]) * (edge->to[a] - edge->from[a]);
    return sum;
}

double gn_zone_place(const gn_couple_zone *zone, int dimension, const double x[3]) {
    double most = -INFINITY;
    for (size_t k = 0; k < zone->edge_count; k++) {
        const gn_couple_edge *e = &zone->edges[k];
        double along = 0.0;
        for (int a = 0; a < dimension; a++) along += (x[a] - e->from[a]) * (e->to[a] - e->from[a]);
        most = fmax(most, along / width2(e, dimension));
    }
    return most;
}

double gn_zones_share(const void *scene, const double *x) {
    const gn_scene *s = scene;
    double least = 1.0;
    for (size_t k = 0; k < s->couple.zone_count; k++) {
        double at = gn_zone_place(&s->couple.zones[k], (int)s->dimension, x);
        /* Another zone may begin on the far side of the particles. */
        if (at < -GN_ZONE_ROUNDING) continue;
        least = fmin(least, fmax(at, 0.0));
    }
    return least;
}

double gn_zone_width(const gn_couple_zone *zone, int dimension) {
    double least = INFINITY;
    for (size_t k = 0; k < zone->edge_count; k++)
        least = fmin(least, width2(&zone->edges[k], dimension));
    return sqrt(least);
}

double gn_zones_width(const gn_scene *scene) {
    double least = INFINITY;
    for (size_t k = 0; k < scene->couple.zone_count; k++)
        least = fmin(least, gn_zone_width(&scene->couple.zones[k], (int)scene->dimension));
    return least;
}

void gn_zone_direction(const gn_couple_zone *zone, int dimension, double n[3]) {
    const gn_couple_edge *e = &zone->edges[0];
    double scale = 1.0 / sqrt(width2(e, dimension));
    n[0] = n[1] = n[2] = 0.0;
    for (int a = 0; a < dimension; a++) n[a] = scale * (e->from[a] - e->to[a]);
}
