#include "surfaces/patch.h"

#include "base/vec3.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- in space --- */

/* Integrals over the part of a triangle inside the particle, in the triangle's plane with the foot
 * of the particle's centre as origin. */
typedef struct integrals {
    double angle;     /* solid angle, int y/s^3 dA */
    double across[2]; /* int x/s^3 dA */
    double potential; /* m2, int (R - s)/s dA */
} integrals;

typedef struct disc {
    /* m: radius of the particle, distance of the plane, radius of the cut */
    double radius, y, circle;
} disc;

/* Part of a line through two corners, at the distance `off` from the foot, which is positive if the
 * foot is on its left. `from` and `to` are positions along the line, relative to the point nearest
 * to the foot. */
typedef struct piece {
    double along[2], off, from, to;
} piece;

static void find_point(const piece *line, double place, double point[2]) {
    point[0] = place * line->along[0] + line->off * line->along[1];
    point[1] = place * line->along[1] - line->off * line->along[0];
}

/* Adds an arc of the circle from the direction of a to that of b, negative if it runs backwards. It
 * is less than half of the circle, because a side that leaves the circle there does not contain the
 * foot. */
static void add_arc(const disc *cut, const double a[2], const double b[2], integrals *sum) {
    const double size_a = hypot(a[0], a[1]), size_b = hypot(b[0], b[1]);
    if (!(size_a > 0.0) || !(size_b > 0.0)) return;
    const double turn = atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    const double depth = cut->radius - cut->y;
    sum->angle += turn * depth / cut->radius;
    sum->potential += 0.5 * turn * depth * depth;
    sum->across[0] -= cut->circle / cut->radius * (b[1] / size_b - a[1] / size_a);
    sum->across[1] += cut->circle / cut->radius * (b[0] / size_b - a[0] / size_a);
}

/* Adds the region between a straight piece of the boundary and the foot. Its solid angle is that of
 * a triangle by one arctangent (van Oosterom and Strackee 1983). The second argument of the
 * arctangent is positive, so that it is regular where the foot lies on the line or at an end of the
 * piece. */
static void add_piece(const disc *cut, const piece *line, integrals *sum) {
    const double q = line->off, y = cut->y, length = line->to - line->from;
    const double flat = hypot(q, y);
    const double a = hypot(flat, line->from), b = hypot(flat, line->to);
    const double reach = asinh(line->to / flat) - asinh(line->from / flat);
    const double angle =
        2.0 * atan2(q * length, a * b + line->from * line->to + flat * flat + y * (a + b));
    sum->angle += angle;
    sum->potential += q * (cut->radius * reach - 0.5 * length) - cut->radius * y * angle;
    sum->across[0] -= line->along[1] * reach;
    sum->across[1] += line->along[0] * reach;
}

/* Adds the side from p to q of a triangle, cut where it leaves the circle; sets *line unless the
 * corners coincide. */
static void add_side(const disc *cut, const double p[2], const double q[2], piece *line,
                     integrals *sum) {
    const double side[2] = {q[0] - p[0], q[1] - p[1]}, length = hypot(side[0], side[1]);
    if (!(length > 0.0)) return;
    for (int k = 0; k < 2; k++) line->along[k] = side[k] / length;
    line->off = p[0] * line->along[1] - p[1] * line->along[0];
    const double begin = p[0] * line->along[0] + p[1] * line->along[1], end = begin + length;
    const double square = (cut->circle - fabs(line->off)) * (cut->circle + fabs(line->off));
    const double half = sqrt(fmax(0.0, square));
    line->from = fmax(begin, -half);
    line->to = fmin(end, half);
    if (!(line->from < line->to)) {
        add_arc(cut, p, q, sum);
        return;
    }
    double a[2], b[2];
    find_point(line, line->from, a);
    find_point(line, line->to, b);
    if (line->from > begin) add_arc(cut, p, a, sum);
    add_piece(cut, line, sum);
    if (line->to < end) add_arc(cut, b, q, sum);
}

/* Finds two unit vectors normal to n that form a right-handed system with it. */
static void find_across(const double n[3], double first[3], double second[3]) {
    int least = 0;
    double unit[3] = {0.0, 0.0, 0.0};
    for (int k = 1; k < 3; k++)
        if (fabs(n[k]) < fabs(n[least])) least = k;
    unit[least] = 1.0;
    gn_cross3(n, unit, first);
    const double size = sqrt(gn_dot3(first, first));
    for (int k = 0; k < 3; k++) first[k] /= size;
    gn_cross3(n, first, second);
}

/* Computes the barycentric coordinates of a point of the plane; the point and the corners are
 * relative to the centre. */
static void weigh_corners(double x[3][3], const double normal[3], double area2,
                          gn_facet_near *near) {
    double sum = 0.0;
    for (int c = 0; c < 3; c++) {
        double a[3], b[3], part[3];
        for (int k = 0; k < 3; k++) {
            a[k] = x[(c + 1) % 3][k] - near->away[k];
            b[k] = x[(c + 2) % 3][k] - near->away[k];
        }
        gn_cross3(a, b, part);
        near->weight[c] = fmax(0.0, gn_dot3(part, normal) / area2);
        sum += near->weight[c];
    }
    for (int c = 0; c < 3; c++) near->weight[c] /= sum;
    for (int k = 0; k < 3; k++) {
        near->away[k] = 0.0;
        for (int c = 0; c < 3; c++) near->away[k] += near->weight[c] * x[c][k];
    }
}

/* Tells whether a triangle is certainly outside of the circle. */
static bool is_far(double corner[3][2], double circle) {
    double middle[2] = {0.0, 0.0}, reach = 0.0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 2; k++) middle[k] += corner[c][k] / 3.0;
    for (int c = 0; c < 3; c++)
        reach = fmax(reach, hypot(corner[c][0] - middle[0], corner[c][1] - middle[1]));
    return hypot(middle[0], middle[1]) > circle + reach;
}

/* Finds the centre of pressure in the plane, which lies in the part inside the particle. If the
 * centre is nearly in the plane, both angle and y vanish, and the bounds of that part limit their
 * quotient. */
static void find_mean(const disc *cut, const piece lines[3], const integrals *sum, double mean[2]) {
    const double across = hypot(sum->across[0], sum->across[1]);
    double least = 0.0, most = cut->circle;
    mean[0] = mean[1] = 0.0;
    if (!(across > 0.0)) return;
    const double way[2] = {sum->across[0] / across, sum->across[1] / across};
    for (int c = 0; c < 3; c++) {
        const piece *l = &lines[c];
        const double leaves = way[0] * l->along[1] - way[1] * l->along[0];
        if (leaves > 0.0) most = fmin(most, l->off / leaves);
        if (leaves < 0.0) least = fmax(least, l->off / leaves);
    }
    double far = most;
    if (cut->y * across < far * sum->angle) far = cut->y * across / sum->angle;
    far = fmax(far, fmin(least, cut->circle));
    for (int k = 0; k < 2; k++) mean[k] = far * way[k];
}

static bool press_triangle(double x[3][3], double radius, gn_facet_near *near,
                           gn_patch_facet *facet) {
    double e[2][3], normal[3], n[3], first[3], second[3], corner[3][2], mean[2];
    for (int k = 0; k < 3; k++) {
        e[0][k] = x[1][k] - x[0][k];
        e[1][k] = x[2][k] - x[0][k];
    }
    gn_cross3(e[0], e[1], normal);
    const double area2 = gn_dot3(normal, normal), size = sqrt(area2);
    if (!(size > 0.0)) return false;
    const double away = gn_dot3(x[0], normal) / size, sign = away < 0.0 ? -1.0 : 1.0;
    const double y = fmax(fabs(away), 1e-12 * radius);
    const disc d = {radius, y, sqrt(fmax(0.0, (radius - y) * (radius + y)))};
    if (!(d.circle > 0.0)) return false;
    for (int k = 0; k < 3; k++) n[k] = sign * normal[k] / size;
    find_across(n, first, second);
    for (int c = 0; c < 3; c++) {
        corner[c][0] = gn_dot3(x[c], first);
        corner[c][1] = gn_dot3(x[c], second);
    }
    if (is_far(corner, d.circle)) return false;
    /* The orientation is counter-clockwise about n; it is reversed if the facet faces away. */
    integrals sum = {0};
    piece lines[3] = {{{0.0, 0.0}, 0.0, 0.0, 0.0}};
    for (int c = 0; c < 3; c++) {
        const int from = sign > 0.0 ? c : (c + 1) % 3, to = sign > 0.0 ? (c + 1) % 3 : c;
        add_side(&d, corner[from], corner[to], &lines[c], &sum);
    }
    const double pressure =
        sqrt(sum.angle * sum.angle + sum.across[0] * sum.across[0] + sum.across[1] * sum.across[1]);
    if (!(pressure > 1e-15)) return false; /* within rounding the facet is outside */
    find_mean(&d, lines, &sum, mean);
    for (int k = 0; k < 3; k++)
        near->away[k] = d.y * n[k] + mean[0] * first[k] + mean[1] * second[k];
    weigh_corners(x, normal, area2, near);
    facet->force = radius / (2.0 * pi) * pressure;
    facet->potential = fmax(0.0, sum.potential / (2.0 * pi));
    return true;
}

/* --- in the plane --- */

/* Adds antiderivatives along a line at the distance y, at the position t from the foot, without
 * differences of nearly equal angles: atan2(t R, y v) is the sum of `turn` and `rest`. */
static void add_end(double radius, double y, double t, double sign, double force[2],
                    double *potential) {
    const double half2 = (radius - y) * (radius + y), v = sqrt(fmax(0.0, half2 - t * t));
    const double turn = atan2(t, v); /* rounded like v, so that both cancel where v is small */
    const double gap = radius - y, rest = atan2(t * v * gap, y * v * v + radius * t * t);
    const double depth = radius * asinh(v / hypot(t, y)) - v; /* pi G */
    force[0] += sign * (radius * rest + gap * turn) / pi;
    force[1] -= sign * depth / pi;
    *potential += sign * (t * depth + 0.5 * (t * v + gap * gap * turn) - y * radius * rest) / pi;
}

static bool press_segment(double x[3][3], double radius, gn_facet_near *near,
                          gn_patch_facet *facet) {
    double along[3], n[3], force[2] = {0.0, 0.0};
    for (int k = 0; k < 3; k++) along[k] = x[1][k] - x[0][k];
    const double length = sqrt(gn_dot3(along, along));
    if (!(length > 0.0)) return false;
    for (int k = 0; k < 3; k++) along[k] /= length;
    const double place = gn_dot3(x[0], along);
    for (int k = 0; k < 3; k++) n[k] = x[0][k] - place * along[k];
    const double y = fmax(sqrt(gn_dot3(n, n)), 1e-12 * radius);
    if (!(y < radius)) return false;
    const double half = sqrt((radius - y) * (radius + y));
    const double begin = fmax(-half, place), end = fmin(half, place + length);
    if (!(begin < end)) return false;
    facet->potential = 0.0;
    add_end(radius, y, end, 1.0, force, &facet->potential);
    add_end(radius, y, begin, -1.0, force, &facet->potential);
    facet->force = hypot(force[0], force[1]);
    if (!(facet->force > 1e-15 * radius)) return false; /* within rounding the facet is outside */
    double at = force[1] < 0.0 ? begin : end;
    if (force[0] > 0.0) at = fmax(begin, fmin(end, y * force[1] / force[0]));
    near->weight[1] = (at - place) / length;
    near->weight[0] = 1.0 - near->weight[1];
    near->weight[2] = 0.0;
    for (int k = 0; k < 3; k++)
        near->away[k] = near->weight[0] * x[0][k] + near->weight[1] * x[1][k];
    facet->potential = fmax(0.0, facet->potential);
    return true;
}

/* --- pressure and contacts --- */

bool gn_patch_press(int corners, const double *const x[3], const double centre[3], double radius,
                    gn_facet_near *near, gn_patch_facet *facet) {
    double relative[3][3] = {{0.0}};
    for (int c = 0; c < corners; c++)
        for (int k = 0; k < 3; k++) relative[c][k] = x[c][k] - centre[k];
    const bool inside = corners == 3 ? press_triangle(relative, radius, near, facet)
                                     : press_segment(relative, radius, near, facet);
    if (!inside) return false;
    near->distance = sqrt(gn_dot3(near->away, near->away));
    near->feature = corners == 3 ? 7U : 3U;
    memset(near->along, 0, sizeof near->along);
    return near->distance > 0.0;
}

double gn_patch_share(double cosine) {
    static const double none = 0.5;
    const double x = (cosine - none) / (cos(GN_FACET_SHARE) - none);
    if (x >= 1.0) return 1.0;
    return x > 0.0 ? x * x * (3.0 - 2.0 * x) : 0.0;
}

/* With the sums over k of the forces, V, and of the potentials, U, of all facets of a contact, the
 * overlap is D = 2 U/V, and the fractions V_i/D of the stiffness reproduce both. By Hertz's law the
 * potential is proportional to U^(5/4), and the forces are (2 U)^(1/4) times the linear ones. If
 * the surface has adapted to the shape of the particle, V exceeds D. */
void gn_patch_contacts(const gn_facet_near *near, const gn_patch_facet *facet, size_t count,
                       bool hertz, gn_facet_contact *contacts) {
    const double least = 1e-9; /* relative to the radius: a smaller U is rounding of coordinates */
    for (size_t i = 0; i < count; i++) {
        gn_facet_contact *out = &contacts[i];
        *out = (gn_facet_contact){.member = (int)i};
        for (int k = 0; k < 3; k++) {
            out->arm[k] = near[i].away[k];
            out->n[k] = near[i].away[k] / near[i].distance;
        }
    }
    for (size_t i = 0; i < count; i++) {
        double force = 0.0, potential = 0.0;
        for (size_t j = 0; j < count; j++) {
            const double share = gn_patch_share(gn_dot3(contacts[i].n, contacts[j].n));
            force += share * facet[j].force;
            potential += share * facet[j].potential;
        }
        const double overlap = fmax(2.0 * potential / force, least * near[i].distance);
        contacts[i].overlap = -overlap;
        contacts[i].part = facet[i].force / overlap;
        contacts[i].crowd = fmax(1.0, force / overlap);
        /* Twice the potential of that overlap is used, which is positive even if U is rounding. */
        if (hertz) contacts[i].part *= sqrt(sqrt(force * overlap) / overlap);
    }
}
