#include "base/memory.h"
#include "base/vec3.h"
#include "surfaces/convex.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* --- work space --- */

/* A face of the overlap: its range among all points, and the plane of its body that contains it. */
typedef struct face {
    size_t begin, count;
    int32_t plane;
} face;

/* One of the bodies in its pose, and the part of its surface that lies in the other body. */
typedef struct side {
    const gn_convex *shape;
    double *plane, *corner; /* planes and corners as in the shape */
    face *faces;
    size_t count;
    int32_t *near; /* planes that are the nearest ones for some point of the overlap */
    size_t near_count;
} side;

typedef struct work {
    side of[2];
    double *point;
    size_t points, most;
    double *buffer[2];
    double origin[3]; /* a point of the overlap, the origin of the integrals */
    double reach;     /* m, largest distance of the overlap from the origin */
    int dimension;
} work;

/* Room for the points of all faces: twelve per facet; faces of triangles in space have six points
 * on average. */
enum { MOST_POINTS = 12, MORE_POINTS = 64 };

static size_t buffer_points(const gn_convex_room *room) {
    return 2 * room->planes + 16;
}
static size_t room_doubles(const gn_convex_room *room) {
    size_t own = 4 * room->planes + 12 * room->polygons;
    return 2 * own + 6 * buffer_points(room) + 3 * (2 * MOST_POINTS * room->polygons + MORE_POINTS);
}

gneiss_status gn_convex_room_make(size_t planes, size_t polygons, gn_convex_room *room,
                                  gneiss_error *error) {
    *room = (gn_convex_room){.planes = planes, .polygons = polygons};
    room->memory = gn_alloc(room_doubles(room) * sizeof(double) + 2 * polygons * sizeof(face) +
                            2 * planes * sizeof(int32_t));
    return room->memory ? GNEISS_OK
                        : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for overlaps of bodies");
}

void gn_convex_room_free(gn_convex_room *room) {
    gn_free(room->memory);
    *room = (gn_convex_room){0};
}

static void share_out(gn_convex_room *room, work *task) {
    double *at = room->memory;
    face *faces = (face *)(void *)(room->memory + room_doubles(room));
    int32_t *near = (int32_t *)(void *)(faces + 2 * room->polygons);
    for (size_t k = 0; k < 2; k++) {
        task->of[k].plane = at;
        task->of[k].corner = at + 4 * room->planes;
        at += 4 * room->planes + 12 * room->polygons;
        task->buffer[k] = at;
        at += 3 * buffer_points(room);
        task->of[k].faces = faces + k * room->polygons;
        task->of[k].near = near + k * room->planes;
    }
    task->point = at;
    task->most = 2 * MOST_POINTS * room->polygons + MORE_POINTS;
}

/* --- bodies in their pose --- */

static void turn(const double axes[9], const double x[3], double y[3]) {
    for (int a = 0; a < 3; a++) y[a] = gn_dot3(axes + 3 * a, x);
}

static void put(const gn_convex *shape, const gn_convex_pose *at, const double from[3],
                side *body) {
    double d[3];
    *body = (side){shape, body->plane, body->corner, body->faces, 0, body->near, 0};
    for (int a = 0; a < 3; a++) d[a] = at->place[a] - from[a];
    for (size_t k = 0; k < shape->planes; k++) {
        turn(at->axes, shape->plane + 4 * k, body->plane + 4 * k);
        body->plane[4 * k + 3] = shape->plane[4 * k + 3] + gn_dot3(body->plane + 4 * k, d);
    }
    for (size_t k = 0; k < shape->polygons * (size_t)shape->corners; k++) {
        turn(at->axes, shape->corner + 3 * k, body->corner + 3 * k);
        for (size_t a = 0; a < 3; a++) body->corner[3 * k + a] += d[a];
    }
}

/* --- cutting --- */

size_t gn_polygon_cut(const double *from, size_t count, const double n[3], double at, double *to) {
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        const double *x = from + 3 * k, *y = from + 3 * ((k + 1) % count);
        double dx = gn_dot3(n, x) - at, dy = gn_dot3(n, y) - at;
        if (dx <= 0.0) memcpy(to + 3 * kept++, x, 3 * sizeof *to);
        if ((dx <= 0.0) == (dy <= 0.0)) continue;
        for (int a = 0; a < 3; a++)
            to[3 * kept + (size_t)a] = x[a] + dx / (dx - dy) * (y[a] - x[a]);
        kept++;
    }
    return kept > 2 ? kept : 0;
}

/* Cuts the polygon in buffer[*in]; the result is in the other buffer, and *in changes, if a part
 * was cut off. */
static size_t cut_there(work *task, int *in, size_t count, const double n[3], double at) {
    bool cuts = false;
    for (size_t k = 0; k < count && !cuts; k++) cuts = gn_dot3(n, task->buffer[*in] + 3 * k) > at;
    if (!cuts) return count;
    count = gn_polygon_cut(task->buffer[*in], count, n, at, task->buffer[1 - *in]);
    *in = 1 - *in;
    return count;
}

/* Computes the half space n.x <= at to which a plane of one body cuts a face of the other. Two
 * faces of the same direction are separated where the distances of their planes are equal; the
 * second one is moved inward by `slack`, m, so that exactly one of two coincident faces counts. For
 * both bodies this is the same plane to the bit: if each face were cut at the plane of the other,
 * faces that differ by rounding would be separated at arbitrary places, and the surface of the
 * overlap would have gaps or count twice. */
static void part_at(const double mine[4], const double other[4], double slack, double n[3],
                    double *at) {
    bool same_way = gn_dot3(mine, other) > 0.9;
    for (int a = 0; a < 3; a++) n[a] = same_way ? other[a] - mine[a] : other[a];
    *at = same_way ? other[3] - mine[3] + slack : other[3];
}

/* Finds the faces of one body in the other; `slack` is positive for the first body and negative for
 * the second. */
static void find_faces(work *task, int mine, double slack) {
    side *s = &task->of[mine], *other = &task->of[1 - mine];
    size_t corners = (size_t)s->shape->corners, planes = other->shape->planes, last = 0;
    for (size_t f = 0; f < s->shape->polygons; f++) {
        int in = 0;
        size_t count = corners;
        memcpy(task->buffer[0], s->corner + 3 * corners * f, 3 * corners * sizeof(double));
        for (size_t k = 0; k < planes && count; k++) {
            size_t p =
                (last + k) % planes; /* the plane that cut off the last face is tried first */
            double n[3], at;
            part_at(s->plane + 4 * s->shape->on[f], other->plane + 4 * p, slack, n, &at);
            count = cut_there(task, &in, count, n, at);
            if (!count) last = p;
        }
        if (!count || task->points + count > task->most) continue;
        s->faces[s->count++] = (face){task->points, count, s->shape->on[f]};
        memcpy(task->point + 3 * task->points, task->buffer[in], 3 * count * sizeof(double));
        task->points += count;
    }
}

/* --- nearest planes --- */

static double depth_at(const side *body, size_t plane, const double x[3]) {
    return body->plane[4 * plane + 3] - gn_dot3(body->plane + 4 * plane, x);
}

/* Tells whether plane a is farther away than plane b at every corner of the overlap, and therefore
 * everywhere in it. */
static bool is_behind(const work *task, const side *body, size_t a, size_t b) {
    for (size_t v = 0; v < task->points; v++)
        if (depth_at(body, a, task->point + 3 * v) < depth_at(body, b, task->point + 3 * v))
            return false;
    return true;
}

static void find_near(const work *task, side *body) {
    double least = (double)INFINITY;
    for (int pass = 0; pass < 2; pass++)
        for (size_t p = 0; p < body->shape->planes; p++) {
            double low = (double)INFINITY, high = -(double)INFINITY;
            for (size_t v = 0; v < task->points; v++) {
                double d = depth_at(body, p, task->point + 3 * v);
                low = fmin(low, d);
                high = fmax(high, d);
            }
            if (pass == 0) least = fmin(least, high);
            if (pass == 1 && low <= least) body->near[body->near_count++] = (int32_t)p;
        }
    size_t kept = 0;
    for (size_t a = 0; a < body->near_count; a++) {
        bool behind = false;
        for (size_t b = 0; b < body->near_count && !behind; b++)
            behind =
                b != a && is_behind(task, body, (size_t)body->near[a], (size_t)body->near[b]) &&
                (b < a || !is_behind(task, body, (size_t)body->near[b], (size_t)body->near[a]));
        if (!behind) body->near[kept++] = body->near[a];
    }
    body->near_count = kept;
}

/* --- integrals --- */

/* Derivatives by the displacement of the second body and by its rotation about the origin. */
typedef struct sums {
    double volume, whole; /* V, W */
    double by_volume[6], by_whole[6];
    double weight, first[3], second[9]; /* integrals over faces, weighted by depth */
} sums;

/* A point of a triangle with its weight. The midpoints of the sides integrate quadratic functions
 * exactly. */
typedef struct spot {
    double x[3], area; /* position relative to the origin; m2 */
} spot;

static void spots_of(const work *task, const double *point, size_t k, spot spots[3]) {
    const double *c[3] = {point, point + 3 * k, point + 3 * (k + 1)};
    double u[3], v[3], n[3];
    for (int a = 0; a < 3; a++) {
        u[a] = c[1][a] - c[0][a];
        v[a] = c[2][a] - c[0][a];
    }
    gn_cross3(u, v, n);
    for (int m = 0; m < 3; m++) {
        spots[m].area = sqrt(gn_dot3(n, n)) / 6.0;
        for (int a = 0; a < 3; a++)
            spots[m].x[a] = 0.5 * (c[m][a] + c[(m + 1) % 3][a]) - task->origin[a];
    }
}

static void add_swept(double sum[6], const double n[3], const double x[3], double value) {
    double about[3];
    gn_cross3(x, n, about);
    for (int a = 0; a < 3; a++) {
        sum[a] += value * n[a];
        sum[3 + a] += value * about[a];
    }
}

/* Adds a face of the overlap. */
static void add_face(const work *task, int mine, const face *polygon, sums *total) {
    const double *n = task->of[mine].plane + 4 * polygon->plane;
    spot spots[3];
    for (size_t k = 1; k + 1 < polygon->count; k++) {
        spots_of(task, task->point + 3 * polygon->begin, k, spots);
        for (int m = 0; m < 3; m++) {
            total->volume += gn_dot3(n, spots[m].x) * spots[m].area / task->dimension;
            if (mine == 1) add_swept(total->by_volume, n, spots[m].x, spots[m].area);
        }
    }
}

/* Returns the depth, m, below a plane of a point that is given relative to the origin. */
static double depth_of(const work *task, const double plane[4], const double x[3]) {
    return plane[3] - gn_dot3(plane, task->origin) - gn_dot3(plane, x);
}

/* Adds the second moment of a triangle, weighted by depth. The integrand is of third order, so that
 * corners and the centroid are used as well, which makes it exact. With the midpoints of sides
 * alone it would depend on how faces are divided into triangles. */
static void add_second(const work *task, const double plane[4], const spot spots[3],
                       double sum[9]) {
    double x[7][3];
    for (int a = 0; a < 3; a++) {
        const double all = spots[0].x[a] + spots[1].x[a] + spots[2].x[a];
        for (int m = 0; m < 3; m++) {
            x[m][a] = spots[m].x[a];
            x[3 + m][a] = all - 2.0 * spots[m].x[a];
        }
        x[6][a] = all / 3.0;
    }
    for (int m = 0; m < 7; m++) {
        const double weight = m < 3 ? 2.0 / 15.0 : m < 6 ? 1.0 / 20.0 : 9.0 / 20.0;
        const double part = 3.0 * weight * spots[0].area * depth_of(task, plane, x[m]);
        for (int a = 0; a < 9; a++) sum[a] += part * x[m][a / 3] * x[m][a % 3];
    }
}

/* Adds the part of a face for which plane `p` of the other body is the nearest one. */
static void add_part(const work *task, int mine, const face *polygon, const double *point,
                     size_t count, size_t p, sums *total) {
    const double *n = task->of[mine].plane + 4 * polygon->plane,
                 *q = task->of[1 - mine].plane + 4 * p;
    double out = -gn_dot3(q, n), sign = mine == 1 ? 1.0 : -1.0;
    spot spots[3];
    for (size_t k = 1; k + 1 < count; k++) {
        spots_of(task, point, k, spots);
        for (int m = 0; m < 3; m++) {
            const double *x = spots[m].x;
            double depth = depth_of(task, q, x), part = depth * spots[m].area;
            total->whole += 0.5 * out * depth * part;
            add_swept(total->by_whole, n, x, sign * part);
            total->weight += part;
            for (int a = 0; a < 3; a++) total->first[a] += part * x[a];
        }
        add_second(task, q, spots, total->second);
    }
}

/* Cuts the polygon in buffer[*in] to the region where plane `p` of a body is the nearest one. */
static size_t cut_to_nearest(work *task, const side *body, size_t p, size_t but, int *in,
                             size_t count) {
    const double *mine = body->plane + 4 * p;
    for (size_t k = 0; k < body->near_count && count; k++) {
        const double *q = body->plane + 4 * body->near[k];
        double n[3];
        if ((size_t)body->near[k] == p || (size_t)body->near[k] == but) continue;
        for (int a = 0; a < 3; a++) n[a] = q[a] - mine[a];
        count = cut_there(task, in, count, n, q[3] - mine[3]);
    }
    return count;
}

static void add_parts(work *task, int mine, const face *polygon, sums *total) {
    const side *other = &task->of[1 - mine];
    for (size_t k = 0; k < other->near_count; k++) {
        size_t p = (size_t)other->near[k];
        int in = 0;
        memcpy(task->buffer[0], task->point + 3 * polygon->begin,
               3 * polygon->count * sizeof(double));
        size_t count = cut_to_nearest(task, other, p, p, &in, polygon->count);
        if (count) add_part(task, mine, polygon, task->buffer[in], count, p, total);
    }
}

/* Places a square on the plane n.x = at that covers the overlap; n need not be a unit vector. */
static void put_square(work *task, const double n[3], double at) {
    double size2 = gn_dot3(n, n), off = (at - gn_dot3(n, task->origin)) / size2, e[2][3] = {{0}};
    int least = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(n[a]) < fabs(n[least])) least = a;
    e[0][task->dimension == 2 ? 2 : least] = 1.0;
    gn_cross3(n, e[0], e[1]);
    gn_cross3(e[1], n, e[0]);
    for (int k = 0; k < 2; k++) {
        double size = sqrt(gn_dot3(e[k], e[k]));
        double half = k == 0 && task->dimension == 2 ? 0.5 : 2.0 * task->reach;
        for (int a = 0; a < 3; a++) e[k][a] *= half / size;
    }
    for (int c = 0; c < 4; c++)
        for (int a = 0; a < 3; a++) {
            double middle = task->dimension == 2 && a == 2 ? 0.0 : task->origin[a] + off * n[a];
            task->buffer[0][3 * c + a] =
                middle + (c == 0 || c == 3 ? -1.0 : 1.0) * e[0][a] + (c < 2 ? -1.0 : 1.0) * e[1][a];
        }
}

/* Tells whether the overlap has points on both sides of the bisector of two planes. */
static bool parts_overlap(const work *task, const double n[3], double at) {
    bool below = false, above = false;
    for (size_t v = 0; v < task->points; v++) {
        double d = gn_dot3(n, task->point + 3 * v) - at;
        below = below || d < 0.0;
        above = above || d > 0.0;
    }
    return below && above;
}

/* Adds the contribution of a fold, where two planes of a body are equally near and the gradient of
 * the depth jumps. The depth is the divergence of 1/2 depth^2 times its gradient; its integral over
 * the volume therefore contains an integral over the fold. */
static void add_fold(work *task, int mine, size_t p, size_t q, sums *total) {
    const side *me = &task->of[mine], *other = &task->of[1 - mine];
    const double *a = me->plane + 4 * p, *b = me->plane + 4 * q;
    double n[3], at = b[3] - a[3];
    int in = 0;
    size_t count = 4;
    for (int k = 0; k < 3; k++) n[k] = b[k] - a[k];
    if (!(gn_dot3(n, n) > 1e-18) || !parts_overlap(task, n, at)) return;
    put_square(task, n, at);
    count = cut_there(task, &in, count, a, a[3]);
    count = cut_to_nearest(task, me, p, q, &in, count);
    for (size_t k = 0; k < other->near_count && count; k++) {
        const double *c = other->plane + 4 * other->near[k];
        count = cut_there(task, &in, count, c, c[3]);
    }
    spot spots[3];
    for (size_t k = 1; k + 1 < count; k++) {
        spots_of(task, task->buffer[in], k, spots);
        for (int m = 0; m < 3; m++) {
            double depth = depth_of(task, a, spots[m].x);
            total->whole += 0.5 * depth * depth * sqrt(gn_dot3(n, n)) * spots[m].area;
        }
    }
}

static void add_all(work *task, sums *total) {
    for (int mine = 0; mine < 2; mine++) {
        const side *me = &task->of[mine];
        for (size_t k = 0; k < me->count; k++) {
            add_face(task, mine, &me->faces[k], total);
            add_parts(task, mine, &me->faces[k], total);
        }
        for (size_t p = 0; p < me->near_count; p++)
            for (size_t q = p + 1; q < me->near_count; q++)
                add_fold(task, mine, (size_t)me->near[p], (size_t)me->near[q], total);
    }
}

/* --- all terms --- */

/* Places the point of the contact force; a small couple about the line of the force remains. */
static void put_point(const work *task, const sums *total, const double moment[3],
                      gn_convex_overlap *overlap) {
    double across[3], at[3], size2 = gn_dot3(overlap->along, overlap->along);
    gn_cross3(overlap->along, moment, across);
    for (int a = 0; a < 3; a++) at[a] = total->first[a] / total->weight;
    if (size2 > 1e-12) {
        double off = gn_dot3(overlap->along, at) / size2;
        for (int a = 0; a < 3; a++) at[a] = across[a] / size2 + off * overlap->along[a];
    }
    gn_cross3(at, overlap->along, across);
    for (int a = 0; a < 3; a++) {
        overlap->about[a] = moment[a] - across[a];
        overlap->point[a] = task->origin[a] + at[a];
    }
    for (int a = 0; a < 9; a++) {
        int p = a / 3, q = a % 3;
        overlap->spread[a] =
            (total->second[a] - total->first[p] * at[q] - at[p] * total->first[q]) / total->weight +
            at[p] * at[q];
    }
}

static void in_plane(sums *total) {
    double *rows[] = {total->by_volume, total->by_whole};
    for (int k = 0; k < 2; k++) rows[k][2] = rows[k][3] = rows[k][4] = 0.0;
    total->first[2] = 0.0;
    for (int a = 0; a < 9; a++)
        if (a / 3 == 2 || a % 3 == 2) total->second[a] = 0.0;
}

static bool read_sums(const work *task, sums *total, double least, gn_convex_overlap *overlap) {
    double moment[3];
    /* If only one body has faces in the other, it lies inside the other; otherwise two faces
     * coincide. */
    bool all = task->of[0].count && task->of[1].count;
    if (!all && !(total->volume > 1e-6 * pow(task->reach, task->dimension))) return false;
    if (!(total->volume > 0.0) || !(total->whole > least * total->volume) || !(total->weight > 0.0))
        return false;
    if (task->dimension == 2) in_plane(total);
    overlap->volume = total->volume;
    overlap->depth = total->whole / total->volume;
    for (int a = 0; a < 3; a++) {
        overlap->along[a] =
            (total->by_whole[a] - overlap->depth * total->by_volume[a]) / total->volume;
        moment[a] =
            (total->by_whole[3 + a] - overlap->depth * total->by_volume[3 + a]) / total->volume;
    }
    put_point(task, total, moment, overlap);
    if (task->dimension == 2) overlap->point[2] = 0.0;
    return true;
}

bool gn_convex_meet(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                    const gn_convex_pose *at_b, double least, gn_convex_room *room,
                    gn_convex_overlap *overlap) {
    work w = {.dimension = a->corners == 3 ? 3 : 2};
    sums s = {0};
    share_out(room, &w);
    put(a, at_a, at_a->place, &w.of[0]);
    put(b, at_b, at_a->place, &w.of[1]);
    find_faces(&w, 1, 0.1 * least);
    find_faces(&w, 0, -0.1 * least);
    if (!w.points) return false;
    memcpy(w.origin, w.point, sizeof w.origin);
    for (size_t v = 0; v < w.points; v++)
        for (size_t k = 0; k < 3; k++)
            w.reach = fmax(w.reach, 2.0 * fabs(w.point[3 * v + k] - w.origin[k]));
    find_near(&w, &w.of[0]);
    find_near(&w, &w.of[1]);
    add_all(&w, &s);
    return read_sums(&w, &s, least, overlap);
}

/* --- distance of separate bodies --- */

/* Returns the largest distance, m, of any plane of a to the corner of b that is nearest to the
 * plane. */
static double apart_by(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                       const gn_convex_pose *at_b) {
    double most = -(double)INFINITY;
    for (size_t p = 0; p < a->planes; p++) {
        double n[3], local[3], off = 0.0, least = (double)INFINITY;
        turn(at_a->axes, a->plane + 4 * p, n);
        for (int k = 0; k < 3; k++) {
            local[k] = 0.0;
            off += n[k] * (at_b->place[k] - at_a->place[k]);
            for (int m = 0; m < 3; m++) local[k] += at_b->axes[3 * m + k] * n[m];
        }
        for (size_t c = 0; c < b->polygons * (size_t)b->corners; c++)
            least = fmin(least, gn_dot3(local, b->corner + 3 * c));
        most = fmax(most, least + off - a->plane[4 * p + 3]);
    }
    return most;
}

double gn_convex_apart(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                       const gn_convex_pose *at_b) {
    return fmax(apart_by(a, at_a, b, at_b), apart_by(b, at_b, a, at_a));
}
