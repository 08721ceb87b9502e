#include "surfaces/facet_tree.h"

#include "base/memory.h"
#include "surfaces/facet.h"

#include <math.h>
#include <stdlib.h>

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

static const double *vertex(const gn_facet_set *s, int32_t facet, int c) {
    return s->pos + 4 * (int64_t)s->corner[s->corners * (int64_t)facet + c];
}

static void grow(gn_facet_box *box, const double *x) {
    for (int a = 0; a < 3; a++) {
        box->lower[a] = fmin(box->lower[a], x[a]);
        box->upper[a] = fmax(box->upper[a], x[a]);
    }
}

static void fit_leaf(const gn_facet_set *s, const gn_facet_tree *t, gn_facet_box *box) {
    for (int a = 0; a < 3; a++) {
        box->lower[a] = INFINITY;
        box->upper[a] = -INFINITY;
    }
    for (int32_t k = box->begin; k < box->begin + box->count; k++)
        for (int c = 0; c < s->corners; c++) grow(box, vertex(s, t->order[k], c));
}

/* A box is followed by its first half, so that children have larger numbers. */
void gn_facet_tree_refit(const gn_facet_set *s, gn_facet_tree *t) {
    for (size_t b = t->boxes; b-- > 0;) {
        gn_facet_box *box = &t->box[b];
        if (box->count) {
            fit_leaf(s, t, box);
            continue;
        }
        const gn_facet_box *half[2] = {box + 1, &t->box[box->right]};
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

/* Splits at the median along the longest side of the box. */
static void split(builder *k, int32_t begin, int32_t count) {
    gn_facet_tree *t = k->tree;
    size_t me = t->boxes++;
    t->box[me] = (gn_facet_box){.begin = begin, .count = count};
    if (count <= LEAF) return;
    fit_leaf(k->set, t, &t->box[me]);
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (t->box[me].upper[a] - t->box[me].lower[a] >
            t->box[me].upper[axis] - t->box[me].lower[axis])
            axis = a;
    for (int32_t f = 0; f < count; f++) {
        keyed *w = &k->work[f];
        *w = (keyed){0.0, t->order[begin + f]};
        for (int c = 0; c < k->set->corners; c++) w->key += vertex(k->set, w->facet, c)[axis];
    }
    qsort(k->work, (size_t)count, sizeof *k->work, by_key);
    for (int32_t f = 0; f < count; f++) t->order[begin + f] = k->work[f].facet;
    t->box[me].count = 0;
    split(k, begin, count / 2);
    t->box[me].right = (int32_t)t->boxes;
    split(k, begin + count / 2, count - count / 2);
}

gneiss_status gn_facet_tree_build(const gn_facet_set *s, gn_facet_tree *t, gneiss_error *error) {
    *t = (gn_facet_tree){0};
    t->box = gn_alloc_array(2 * s->count + 1, sizeof *t->box);
    t->order = gn_alloc_array(s->count + 1, sizeof *t->order);
    builder k = {s, t, gn_alloc_array(s->count + 1, sizeof *k.work)};
    bool held = t->box && t->order && k.work;
    if (held) {
        for (size_t f = 0; f < s->count; f++) t->order[f] = (int32_t)f;
        split(&k, 0, (int32_t)s->count);
        gn_facet_tree_refit(s, t);
    }
    gn_free(k.work);
    if (held) return GNEISS_OK;
    gn_facet_tree_free(t);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a tree of %zu facets", s->count);
}

void gn_facet_tree_free(gn_facet_tree *t) {
    gn_free(t->box);
    gn_free(t->order);
    *t = (gn_facet_tree){0};
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

size_t gn_facet_tree_near(const gn_facet_tree *t, const gn_facet_set *s, const double centre[3],
                          double reach, int32_t *found) {
    int32_t stack[DEPTH_MAX];
    int top = 0;
    size_t count = 0;
    stack[top++] = 0;
    while (top > 0) {
        int32_t at = stack[--top];
        const gn_facet_box *box = &t->box[at];
        if (!box_near(box, centre, reach)) continue;
        if (!box->count) {
            stack[top++] = box->right;
            stack[top++] = at + 1;
            continue;
        }
        for (int32_t k = box->begin; k < box->begin + box->count; k++) {
            const double *x[3] = {0};
            gn_facet_near near;
            for (int c = 0; c < s->corners; c++) x[c] = vertex(s, t->order[k], c);
            gn_facet_nearest(s->corners, x, centre, &near);
            if (!(near.distance <= reach)) continue;
            if (found) found[count] = t->order[k];
            count++;
        }
    }
    if (found && count > 1) qsort(found, count, sizeof *found, by_number);
    return count;
}
