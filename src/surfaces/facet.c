#include "surfaces/facet.h"

#include "base/memory.h"
#include "base/vec3.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative tolerance of the distances of the same point computed from two facets. */
static const double same = 1e-10;

/* --- nearest point --- */

static void set_point(gn_facet_near *near, const double p[3], unsigned feature) {
    memcpy(near->away, p, 3 * sizeof *p);
    near->distance = sqrt(gn_dot3(p, p));
    near->feature = feature;
}

/* Finds the nearest point on the side from corner i to corner j, ends included; corners are
 * relative to the centre. */
static void on_side(const double a[3], const double b[3], int i, int j, gn_facet_near *near) {
    double side[3], p[3];
    for (int k = 0; k < 3; k++) side[k] = b[k] - a[k];
    double t = -gn_dot3(a, side) / gn_dot3(side, side);
    unsigned feature = (1U << i) | (1U << j);
    if (!(t > 0.0)) {
        t = 0.0;
        feature = 1U << i;
    } else if (t >= 1.0) {
        t = 1.0;
        feature = 1U << j;
    }
    for (int k = 0; k < 3; k++) p[k] = t < 1.0 ? a[k] + t * side[k] : b[k];
    near->weight[0] = near->weight[1] = near->weight[2] = 0.0;
    near->weight[i] = 1.0 - t;
    near->weight[j] = t;
    memcpy(near->along, side, sizeof side);
    set_point(near, p, feature);
}

/* Finds the nearest point of a triangle. If it is inside, it lies along the normal, so that a
 * slender triangle does not tilt it. Barycentric coordinates are ratios of areas; if one of them is
 * not positive, the nearest point of those sides counts. */
static void on_triangle(double x[3][3], gn_facet_near *near) {
    double e1[3], e2[3], normal[3], part[3], weight[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = x[1][k] - x[0][k];
        e2[k] = x[2][k] - x[0][k];
    }
    gn_cross3(e1, e2, normal);
    double area2 = gn_dot3(normal, normal);
    bool inside = area2 > 0.0;
    for (int k = 0; k < 3; k++) {
        gn_cross3(x[(k + 1) % 3], x[(k + 2) % 3], part);
        weight[k] = gn_dot3(part, normal);
        inside = inside && weight[k] > 0.0;
    }
    if (inside) {
        double along = gn_dot3(x[0], normal) / area2, p[3];
        for (int k = 0; k < 3; k++) p[k] = along * normal[k];
        double sum = weight[0] + weight[1] + weight[2];
        for (int k = 0; k < 3; k++) near->weight[k] = weight[k] / sum;
        set_point(near, p, 7U);
        return;
    }
    gn_facet_near best = {.distance = INFINITY}, side;
    for (int k = 0; k < 3; k++) {
        if (area2 > 0.0 && weight[k] > 0.0) continue;
        on_side(x[(k + 1) % 3], x[(k + 2) % 3], (k + 1) % 3, (k + 2) % 3, &side);
        if (side.distance < best.distance) best = side;
    }
    memcpy(near->away, best.away, sizeof best.away);
    memcpy(near->weight, best.weight, sizeof best.weight);
    memcpy(near->along, best.along, sizeof best.along);
    near->distance = best.distance;
    near->feature = best.feature;
}

void gn_facet_nearest(int corners, const double *const x[3], const double centre[3],
                      gn_facet_near *near) {
    double y[3][3] = {{0.0}};
    for (int c = 0; c < corners; c++)
        for (int k = 0; k < 3; k++) y[c][k] = x[c][k] - centre[k];
    if (corners == 3)
        on_triangle(y, near);
    else
        on_side(y[0], y[1], 0, 1, near);
}

void gn_facet_set_nearest(const gn_facet_set *set, int32_t facet, const double centre[3],
                          gn_facet_near *near) {
    const int32_t *corner = set->corner + set->corners * (int64_t)facet;
    const double *x[3] = {0};
    for (int k = 0; k < 3; k++) near->corner[k] = k < set->corners ? corner[k] : -1;
    for (int k = 0; k < set->corners; k++) x[k] = set->pos + 4 * (int64_t)corner[k];
    gn_facet_nearest(set->corners, x, centre, near);
}

void gn_facet_add(gn_facet_near *list, size_t *count, const gn_facet_near *item) {
    if (*count < GN_FACET_TOUCHES) {
        list[(*count)++] = *item;
        return;
    }
    /* A minimum that suppresses another is at least as near, so that the farthest item can be
     * dropped. */
    size_t worst = 0;
    for (size_t k = 1; k < *count; k++)
        if (list[k].distance > list[worst].distance) worst = k;
    if (item->distance < list[worst].distance) list[worst] = *item;
}

/* --- minima --- */

static int size_of(unsigned feature) {
    return __builtin_popcount(feature);
}

/* Tells whether all corners of a's feature are corners of b. */
static bool holds(const gn_facet_near *b, const gn_facet_near *a) {
    for (int k = 0; k < 3; k++) {
        if (!(a->feature >> k & 1)) continue;
        bool found = false;
        for (int m = 0; m < 3; m++) found = found || b->corner[m] == a->corner[k];
        if (!found) return false;
    }
    return true;
}

/* Tells whether b, which contains a's feature, is nearer, or takes precedence at the same point. */
static bool suppresses(const gn_facet_near *b, const gn_facet_near *a, bool b_first) {
    if (!holds(b, a)) return false;
    if (b->distance < a->distance * (1.0 - same)) return true;
    if (b->distance > a->distance * (1.0 + same)) return false;
    int more = size_of(b->feature) - size_of(a->feature);
    return more > 0 || (more == 0 && b_first);
}

size_t gn_facet_minima(gn_facet_near *list, size_t count) {
    if (count < 2) return count;
    bool keep[GN_FACET_TOUCHES];
    for (size_t a = 0; a < count; a++) {
        keep[a] = true;
        for (size_t b = 0; b < count && keep[a]; b++)
            keep[a] = b == a || !suppresses(&list[b], &list[a], b < a);
    }
    size_t kept = 0;
    for (size_t a = 0; a < count; a++) {
        if (!keep[a]) continue;
        gn_facet_near item = list[a];
        size_t at = kept++;
        for (; at > 0 && list[at - 1].distance > item.distance; at--) list[at] = list[at - 1];
        list[at] = item;
    }
    return kept;
}

/* --- sharing --- */

enum { ACTIVE = 40 }; /* largest number of overlapping minima that share stiffness */

/* The complementarity problem of facet.h. */
typedef struct sharing {
    size_t count;
    double m[GN_FACET_TOUCHES][3]; /* unit normals from the surface to the centre */
    double depth[GN_FACET_TOUCHES], lambda[GN_FACET_TOUCHES];
    double slack;
    size_t actives, active[ACTIVE];
} sharing;

/* Returns f of two unit normals and its derivative by their cosine. The angle from the chord is
 * exact for small angles. */
static double share_of(const double a[3], const double b[3], double *slope) {
    double chord2 = 0.0;
    for (int k = 0; k < 3; k++) chord2 += (a[k] - b[k]) * (a[k] - b[k]);
    *slope = 0.0;
    if (chord2 >= GN_FACET_SHARE * GN_FACET_SHARE) return 0.0;
    double half = asin(0.5 * sqrt(chord2)), angle = 2.0 * half, x = angle / GN_FACET_SHARE;
    if (x >= 1.0) return 0.0;
    double rest = 1.0 - x, cube = rest * rest * rest;
    double arc = angle > 1e-8 ? angle / sin(angle) : 1.0;
    *slope = 20.0 * cube * arc / (GN_FACET_SHARE * GN_FACET_SHARE);
    return (1.0 + 4.0 * x) * rest * cube;
}

static double share(const sharing *problem, size_t i, size_t j) {
    double slope;
    return i == j ? 1.0 : share_of(problem->m[i], problem->m[j], &slope);
}

/* Returns the part of an overlap for which the active minima do not account yet. */
static double missing(const sharing *problem, size_t i) {
    double sum = problem->depth[i];
    for (size_t k = 0; k < problem->actives; k++) {
        size_t j = problem->active[k];
        sum -= share(problem, i, j) * problem->lambda[j];
    }
    return sum;
}

/* Solves for the values z of the active minima by Cholesky; returns false if two of them have the
 * same normal. */
static bool solve_active(const sharing *problem, double z[ACTIVE]) {
    double low[ACTIVE][ACTIVE];
    size_t n = problem->actives;
    for (size_t r = 0; r < n; r++) {
        double value = problem->depth[problem->active[r]];
        for (size_t c = 0; c <= r; c++) {
            double sum = share(problem, problem->active[r], problem->active[c]);
            for (size_t k = 0; k < c; k++) sum -= low[r][k] * low[c][k];
            if (c == r && !(sum > 1e-10)) return false;
            low[r][c] = c == r ? sqrt(sum) : sum / low[c][c];
            if (c < r) value -= low[r][c] * z[c];
        }
        z[r] = value / low[r][r];
    }
    for (size_t r = n; r-- > 0;) {
        for (size_t k = r + 1; k < n; k++) z[r] -= low[k][r] * z[k];
        z[r] /= low[r][r];
    }
    return true;
}

/* Moves lambda towards z until the first value reaches zero, and removes its minimum from the
 * active set; returns false if z is reached. */
static bool step_back(sharing *problem, const double z[ACTIVE]) {
    double way = 1.0;
    for (size_t k = 0; k < problem->actives; k++) {
        double old = problem->lambda[problem->active[k]];
        if (!(z[k] > 0.0)) way = fmin(way, old > z[k] ? old / (old - z[k]) : 0.0);
    }
    bool left = false;
    size_t kept = 0;
    for (size_t k = 0; k < problem->actives; k++) {
        size_t i = problem->active[k];
        problem->lambda[i] += way * (z[k] - problem->lambda[i]);
        bool leaves = !(z[k] > 0.0) && !(problem->lambda[i] > problem->slack);
        if (leaves)
            problem->lambda[i] = 0.0;
        else
            problem->active[kept++] = i;
        left = left || leaves;
    }
    problem->actives = kept;
    return left;
}

/* Solves the problem by active sets (Lawson and Hanson 1974, chapter 23): the minimum with the
 * largest deficit joins the set, then those that would pull leave it. */
static void solve(sharing *problem) {
    bool refused[GN_FACET_TOUCHES] = {false};
    for (size_t round = 0; round < 4 * problem->count + 8 && problem->actives < ACTIVE; round++) {
        double most = problem->slack, z[ACTIVE];
        size_t next = problem->count;
        for (size_t i = 0; i < problem->count; i++) {
            if (refused[i] || problem->lambda[i] > 0.0) continue;
            double lacks = missing(problem, i);
            if (lacks > most) {
                most = lacks;
                next = i;
            }
        }
        if (next == problem->count) return;
        problem->active[problem->actives++] = next;
        if (!solve_active(problem, z)) {
            refused[next] = true; /* a deeper minimum has the same normal */
            problem->actives--;
            continue;
        }
        while (step_back(problem, z))
            if (!solve_active(problem, z)) return;
    }
}

void gn_facet_single(const gn_facet_near *minima, size_t k, double radius, gn_facet_contact *out) {
    const gn_facet_near *m = &minima[k];
    *out = (gn_facet_contact){
        .overlap = m->distance - radius, .part = 1.0, .crowd = 1.0, .member = (int)k};
    for (int a = 0; a < 3; a++) {
        out->n[a] = m->away[a] / m->distance;
        out->arm[a] = m->away[a];
    }
}

/* Splits the part of v across the normal m into two: the component along the feature of a minimum
 * (along an edge, or in a face), and the rest, by which its normal rotates when the particle moves
 * by v. */
static void across(const gn_facet_near *near, const double m[3], const double v[3], double along[3],
                   double turning[3]) {
    double normal = gn_dot3(m, v), edge = 0.0, size2 = gn_dot3(near->along, near->along);
    int corners = size_of(near->feature);
    if (corners == 2 && size2 > 0.0) edge = gn_dot3(near->along, v) / size2;
    for (int a = 0; a < 3; a++) {
        double flat = v[a] - normal * m[a];
        along[a] = corners == 3 ? flat : edge * near->along[a];
        turning[a] = flat - along[a];
    }
}

/* Adds the forces due to rotating normals. If a normal rotates when the particle moves, f changes
 * and so does the potential: with w_i = sum_j f'_ij lambda_j m_j the gradient is k lambda_i (m_i +
 * (rotation of m_i by w_i)/distance). The forces act on the surface at the contact point displaced
 * by the component of w_i along the feature; there they do the work that would otherwise be missing
 * when the surface rotates. Together they have no moment about the centre. */
static void lean(const sharing *problem, size_t i, const gn_facet_near *near,
                 gn_facet_contact *out) {
    double w[3] = {0, 0, 0}, along[3], turning[3], slope;
    for (size_t k = 0; k < problem->actives; k++) {
        size_t j = problem->active[k];
        if (j == i) continue;
        out->crowd += share_of(problem->m[i], problem->m[j], &slope);
        for (int a = 0; a < 3; a++) w[a] += slope * problem->lambda[j] * problem->m[j][a];
    }
    across(near, problem->m[i], w, along, turning);
    for (int a = 0; a < 3; a++) {
        out->n[a] -= turning[a] / near->distance;
        out->arm[a] += along[a];
    }
    double size = sqrt(gn_dot3(out->n, out->n));
    for (int a = 0; a < 3; a++) out->n[a] /= size;
}

/* Sets up the problem; returns whether any two minima share stiffness. */
static bool set_up(const gn_facet_near *minima, size_t count, double radius, sharing *problem) {
    bool any = false;
    problem->count = count;
    problem->actives = 0;
    problem->slack = 1e-12 * (radius - minima[0].distance) + 8.0 * DBL_EPSILON * radius;
    for (size_t i = 0; i < count; i++) {
        problem->lambda[i] = 0.0;
        problem->depth[i] = radius - minima[i].distance;
        for (int a = 0; a < 3; a++) problem->m[i][a] = -minima[i].away[a] / minima[i].distance;
        for (size_t j = 0; j < i && !any; j++) any = share(problem, i, j) > 0.0;
    }
    return any;
}

size_t gn_facet_contacts(const gn_facet_near *minima, size_t count, double radius,
                         gn_facet_contact *contacts) {
    size_t first = 0, found = 0;
    while (first < count && !(minima[first].distance > 0.0)) first++;
    sharing s;
    bool shared = count - first > 1 && set_up(minima + first, count - first, radius, &s);
    if (shared) solve(&s);
    for (size_t k = first; k < count; k++) {
        double lambda = shared ? s.lambda[k - first] : 0.0;
        if (shared && !(lambda > 0.0)) continue;
        gn_facet_contact *out = &contacts[found++];
        gn_facet_single(minima, k, radius, out);
        if (!shared || lambda == s.depth[k - first]) continue;
        out->part = fmin(1.0, lambda / s.depth[k - first]);
        lean(&s, k - first, &minima[k], out);
    }
    return found;
}

enum { LEAF = 4, DEPTH_MAX = 64 };

typedef struct keyed {
    double key;
    int32_t facet;
} keyed;

typedef struct builder {
    const gn_facet_set *set;
    gn_facet_tree *tree;
    keyed *work;
} builder;

static const double *vertex(const gn_facet_set *set, int32_t facet, int c) {
    return set->pos + 4 * (int64_t)set->corner[set->corners * (int64_t)facet + c];
}

static void grow(gn_facet_box *box, const double *x) {
    for (int a = 0; a < 3; a++) {
        box->lower[a] = fmin(box->lower[a], x[a]);
        box->upper[a] = fmax(box->upper[a], x[a]);
    }
}

static void fit_leaf(const gn_facet_set *set, const gn_facet_tree *tree, gn_facet_box *box) {
    for (int a = 0; a < 3; a++) {
        box->lower[a] = INFINITY;
        box->upper[a] = -INFINITY;
    }
    for (int32_t k = box->begin; k < box->begin + box->count; k++)
        for (int c = 0; c < set->corners; c++) grow(box, vertex(set, tree->order[k], c));
}

/* A box is followed by the box of its first half, so that children have larger numbers. */
void gn_facet_tree_refit(const gn_facet_set *set, gn_facet_tree *tree) {
    for (size_t b = tree->boxes; b-- > 0;) {
        gn_facet_box *box = &tree->box[b];
        if (box->count) {
            fit_leaf(set, tree, box);
            continue;
        }
        const gn_facet_box *half[2] = {box + 1, &tree->box[box->right]};
        for (int a = 0; a < 3; a++) {
            box->lower[a] = fmin(half[0]->lower[a], half[1]->lower[a]);
            box->upper[a] = fmax(half[0]->upper[a], half[1]->upper[a]);
        }
    }
}

static int by_key(const void *a, const void *b) {
    const keyed *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

/* Splits the facets at the median along the longest side of the box. */
static void split(builder *build, int32_t begin, int32_t count) {
    gn_facet_tree *t = build->tree;
    size_t me = t->boxes++;
    t->box[me] = (gn_facet_box){.begin = begin, .count = count};
    if (count <= LEAF) return;
    fit_leaf(build->set, t, &t->box[me]);
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (t->box[me].upper[a] - t->box[me].lower[a] >
            t->box[me].upper[axis] - t->box[me].lower[axis])
            axis = a;
    for (int32_t f = 0; f < count; f++) {
        keyed *w = &build->work[f];
        *w = (keyed){0.0, t->order[begin + f]};
        for (int c = 0; c < build->set->corners; c++)
            w->key += vertex(build->set, w->facet, c)[axis];
    }
    qsort(build->work, (size_t)count, sizeof *build->work, by_key);
    for (int32_t f = 0; f < count; f++) t->order[begin + f] = build->work[f].facet;
    t->box[me].count = 0;
    split(build, begin, count / 2);
    t->box[me].right = (int32_t)t->boxes;
    split(build, begin + count / 2, count - count / 2);
}

gneiss_status gn_facet_tree_build(const gn_facet_set *set, gn_facet_tree *tree,
                                  gneiss_error *error) {
    *tree = (gn_facet_tree){0};
    tree->box = gn_alloc_array(2 * set->count + 1, sizeof *tree->box);
    tree->order = gn_alloc_array(set->count + 1, sizeof *tree->order);
    builder k = {set, tree, gn_alloc_array(set->count + 1, sizeof *k.work)};
    bool held = tree->box && tree->order && k.work;
    if (held) {
        for (size_t f = 0; f < set->count; f++) tree->order[f] = (int32_t)f;
        split(&k, 0, (int32_t)set->count);
        gn_facet_tree_refit(set, tree);
    }
    gn_free(k.work);
    if (held) return GNEISS_OK;
    gn_facet_tree_free(tree);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a tree of %zu facets", set->count);
}

void gn_facet_tree_free(gn_facet_tree *tree) {
    gn_free(tree->box);
    gn_free(tree->order);
    *tree = (gn_facet_tree){0};
}

static bool box_near(const gn_facet_box *box, const double centre[3], double reach) {
    double d2 = 0.0;
    for (int a = 0; a < 3; a++) {
        double d = fmax(0.0, fmax(box->lower[a] - centre[a], centre[a] - box->upper[a]));
        d2 += d * d;
    }
    return d2 <= reach * reach;
}

static int by_number(const void *a, const void *b) {
    return (*(const int32_t *)a > *(const int32_t *)b) -
           (*(const int32_t *)a < *(const int32_t *)b);
}

size_t gn_facet_tree_near(const gn_facet_tree *tree, const gn_facet_set *set,
                          const double centre[3], double reach, int32_t *found) {
    int32_t stack[DEPTH_MAX];
    int top = 0;
    size_t count = 0;
    stack[top++] = 0;
    while (top > 0) {
        int32_t at = stack[--top];
        const gn_facet_box *box = &tree->box[at];
        if (!box_near(box, centre, reach)) continue;
        if (!box->count) {
            stack[top++] = box->right;
            stack[top++] = at + 1;
            continue;
        }
        for (int32_t k = box->begin; k < box->begin + box->count; k++) {
            const double *x[3] = {0};
            gn_facet_near near;
            for (int c = 0; c < set->corners; c++) x[c] = vertex(set, tree->order[k], c);
            gn_facet_nearest(set->corners, x, centre, &near);
            if (!(near.distance <= reach)) continue;
            if (found) found[count] = tree->order[k];
            count++;
        }
    }
    if (found && count > 1) qsort(found, count, sizeof *found, by_number);
    return count;
}
