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

/* A box is followed by its first half, so that children have larger numbers. */
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

/* Splits at the median along the longest side of the box. */
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
