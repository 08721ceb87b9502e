#include "couple/front.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "fem/internal.h"

#include <math.h>
#include <string.h>

/* --- states of elements --- */

void gn_front_kinds(const gn_fem_solid *solid, const gn_convert_def *def, const uint8_t *driven,
                    uint8_t *kind) {
    for (size_t e = 0; e < solid->elements.soa.count; e++) {
        bool inside = true, held = false;
        for (int a = 0; a <= solid->dimension && inside; a++) {
            const size_t n = (size_t)gn_elements_node(&solid->elements, a)[e];
            for (int k = 0; k < solid->dimension; k++)
                inside = inside && gn_fem_between(solid, solid->nodes.start + 4 * n, k,
                                                  def->box_min[k], def->box_max[k]);
            held = held || driven[n];
        }
        kind[e] = !inside ? GN_FRONT_FIXED : held ? GN_FRONT_HELD : GN_FRONT_READY;
    }
}

/* --- the front --- */

typedef struct front {
    gn_fem_solid *solid;
    double width;
    uint8_t *kind, *counted; /* [elements] counted: the distances include its nodes */
    int32_t *fresh;          /* [nodes] of elements that were not counted before */
    size_t fresh_count;
    uint8_t *reached, *crest; /* [nodes] */
} front;

static double *part_of(const front *advance, size_t n) {
    return advance->solid->nodes.blend + 2 * n;
}

static size_t corner(const front *advance, size_t e, int a) {
    return (size_t)gn_elements_node(&advance->solid->elements, a)[e];
}

static void find_fresh(front *advance) {
    advance->fresh_count = 0;
    for (size_t e = 0; e < advance->solid->elements.soa.count; e++) {
        if (advance->kind[e] != GN_FRONT_LEAVING || advance->counted[e]) continue;
        advance->counted[e] = 1;
        for (int a = 0; a <= advance->solid->dimension; a++) {
            const size_t n = corner(advance, e, a);
            if (advance->reached[n]) continue;
            advance->reached[n] = 1;
            advance->fresh[advance->fresh_count++] = (int32_t)n;
        }
    }
}

/* Relative tolerance of distances. Distances that are equal by geometry, to each other or to the
 * width, differ by rounding, and differently on the two sides of a plane of symmetry. Such a
 * difference must change no weight and create no crest, so that a symmetric front stays symmetric.
 */
#define DISTANCE_ROUNDING 1e-9

/* Updates the distances from the front and the weights that follow from them. A distance that would
 * decrease only by rounding is kept, because nothing has changed for the nodes and particles there.
 */
static void spread(front *advance) {
    const gn_particles *q = &advance->solid->nodes;
#pragma omp parallel for schedule(static) num_threads(advance->solid->threads)
    for (size_t n = 0; n < q->soa.count; n++) {
        const double before = part_of(advance, n)[1] * part_of(advance, n)[1];
        double least = before;
        for (size_t k = 0; k < advance->fresh_count; k++) {
            const double *x = q->start + 4 * n, *y = q->start + 4 * (size_t)advance->fresh[k];
            double d2 = 0.0;
            for (int a = 0; a < 3; a++) d2 += (x[a] - y[a]) * (x[a] - y[a]);
            least = fmin(least, d2);
        }
        if (!(least < (1.0 - DISTANCE_ROUNDING) * before)) continue;
        part_of(advance, n)[1] = sqrt(least);
        const double part = part_of(advance, n)[1] / advance->width;
        part_of(advance, n)[0] = part < 1.0 - DISTANCE_ROUNDING ? part : 1.0;
    }
}

/* Finds the crests: nodes of remaining elements where the weight is below 1 and a local maximum. */
static void find_crests(front *advance) {
    for (size_t n = 0; n < advance->solid->nodes.soa.count; n++)
        advance->crest[n] = part_of(advance, n)[0] < 1.0;
    for (size_t e = 0; e < advance->solid->elements.soa.count; e++) {
        double highest = 0.0;
        if (advance->kind[e] == GN_FRONT_LEAVING) continue;
        for (int a = 0; a <= advance->solid->dimension; a++)
            highest = fmax(highest, part_of(advance, corner(advance, e, a))[0]);
        for (int a = 0; a <= advance->solid->dimension; a++)
            if (part_of(advance, corner(advance, e, a))[0] < (1.0 - DISTANCE_ROUNDING) * highest)
                advance->crest[corner(advance, e, a)] = 0;
    }
}

/* Tells whether there is no room for a zone at an element: it is at a crest, or all of its nodes
 * are on the front. */
static bool is_remnant(const front *advance, size_t e) {
    bool at_crest = false;
    double highest = 0.0;
    for (int a = 0; a <= advance->solid->dimension; a++) {
        const size_t n = corner(advance, e, a);
        at_crest = at_crest || advance->crest[n];
        highest = fmax(highest, part_of(advance, n)[0]);
    }
    return at_crest || !(highest > 0.0);
}

static bool is_shared(const front *advance, size_t e) {
    bool shared = false;
    for (int a = 0; a <= advance->solid->dimension; a++)
        shared = shared || part_of(advance, corner(advance, e, a))[0] < 1.0;
    return shared;
}

/* Marks such elements for conversion as well; returns false if there are none. */
static bool mark_remnants(front *advance, int64_t *stuck) {
    bool more = false;
    find_crests(advance);
    for (size_t e = 0; e < advance->solid->elements.soa.count; e++) {
        if (advance->kind[e] == GN_FRONT_LEAVING) continue;
        const bool goes = is_remnant(advance, e);
        const bool may = advance->kind[e] == GN_FRONT_READY;
        if (*stuck < 0 &&
            ((goes && !may) || (advance->kind[e] == GN_FRONT_FIXED && is_shared(advance, e))))
            *stuck = (int64_t)e;
        if (!goes || !may) continue;
        advance->kind[e] = GN_FRONT_LEAVING;
        more = true;
    }
    return more;
}

static void free_front(front *advance) {
    gn_free(advance->counted);
    gn_free(advance->fresh);
    gn_free(advance->reached);
    gn_free(advance->crest);
}

gneiss_status gn_front_advance(gn_fem_solid *solid, double width, uint8_t *kind, int64_t *stuck,
                               gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count + 1;
    front f = {.solid = solid,
               .width = width,
               .kind = kind,
               .counted = gn_alloc(solid->elements.soa.count + 1),
               .fresh = gn_alloc_array(nodes, sizeof *f.fresh),
               .reached = gn_alloc(nodes),
               .crest = gn_alloc(nodes)};
    *stuck = -1;
    const bool held = f.counted && f.fresh && f.reached && f.crest;
    for (bool more = held; more && *stuck < 0;) {
        find_fresh(&f);
        spread(&f);
        more = mark_remnants(&f, stuck);
    }
    free_front(&f);
    if (held) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the front of %zu elements",
                   solid->elements.soa.count);
}

/* --- room for a zone --- */

/* Returns the distance from a node to the nearest node of elements that may not be part of a zone,
 * m. */
static double free_way(const gn_particles *nodes, size_t n, const uint8_t *closed) {
    double least = INFINITY;
    for (size_t m = 0; m < nodes->soa.count; m++) {
        const double *x = nodes->start + 4 * n, *y = nodes->start + 4 * m;
        double d2 = 0.0;
        for (int a = 0; a < 3 && closed[m]; a++) d2 += (x[a] - y[a]) * (x[a] - y[a]);
        if (closed[m]) least = fmin(least, d2);
    }
    return sqrt(least);
}

/* Finds the largest room. The search starts with the element in the middle of the list, which is as
 * good a guess as any other. */
static double most_room(const gn_fem_solid *solid, const uint8_t *kind, double enough,
                        const uint8_t *closed, double *way) {
    const size_t count = solid->elements.soa.count;
    double most = 0.0;
    for (size_t k = 0; k < count && most < enough; k++) {
        const size_t e = (k + count / 2) % count;
        double room = INFINITY;
        for (int a = 0; a <= solid->dimension && kind[e] == GN_FRONT_READY && room > most; a++) {
            const size_t n = (size_t)gn_elements_node(&solid->elements, a)[e];
            if (way[n] < 0.0) way[n] = free_way(&solid->nodes, n, closed);
            room = fmin(room, way[n]);
        }
        if (kind[e] == GN_FRONT_READY) most = fmax(most, room);
    }
    return most;
}

gneiss_status gn_front_room(const gn_fem_solid *solid, const uint8_t *kind, double enough,
                            double *room, gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count;
    uint8_t *closed = gn_alloc(nodes + 1);
    double *way = gn_alloc_array(nodes + 1, sizeof *way);
    const bool held = closed && way;
    for (size_t n = 0; held && n < nodes; n++) way[n] = -1.0;
    for (size_t e = 0; held && e < solid->elements.soa.count; e++)
        for (int a = 0; a <= solid->dimension && kind[e] == GN_FRONT_FIXED; a++)
            closed[gn_elements_node(&solid->elements, a)[e]] = 1;
    if (held) *room = most_room(solid, kind, enough, closed, way);
    gn_free(closed);
    gn_free(way);
    return held
               ? GNEISS_OK
               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for distances of %zu nodes", nodes);
}

/* --- limits --- */

/* With principal stresses s1 >= s3 the Mohr-Coulomb ratio is that of (s1 - s3)/2 + (s1 + s3)/2
 * sin(phi) to c cos(phi); with t = tan(phi), sin = t/sqrt(1 + t2) and cos = 1/sqrt(1 + t2). */
double gn_front_excess(const gn_convert_def *def, const double s[6], double least) {
    const double pull = least * def->stress, shear = least * def->cohesion;
    double a[9] = {s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]}, principal[3], vectors[9];
    double excess = 0.0, t = def->friction, root = sqrt(1.0 + t * t), size2 = 0.0;
    for (int k = 0; k < 6; k++) size2 += (k < 3 ? 1.0 : 2.0) * s[k] * s[k];
    /* The magnitude of a principal stress is at most the root of the sum of squares. */
    const bool below = !(def->stress > 0.0 && size2 >= pull * pull) &&
                       !(def->has_mohr && size2 * (root + t) * (root + t) >= shear * shear);
    if (below) return 0.0;
    gn_eigen_symmetric(3, a, principal, vectors);
    if (def->stress > 0.0) excess = principal[0] / def->stress;
    if (!def->has_mohr) return excess;
    double half = 0.5 * (principal[0] - principal[2]), mean = 0.5 * (principal[0] + principal[2]);
    return fmax(excess, (half * root + mean * t) / def->cohesion);
}
