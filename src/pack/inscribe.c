#include "pack/inscribe.h"

#include "base/new.h"

#include <math.h>
#include <string.h>

enum { CELLS = 32, HALVINGS = 20 };

/* Points of the grid that are inside and that no sphere contains: x y z depth. */
typedef struct points {
    size_t count, room;
    double *at; /* [count][4] */
    double spacing;
} points;

static gneiss_status add_point(const gn_domain *domain, const double x[3], points *p,
                               gneiss_error *error) {
    const double depth = gn_domain_depth(domain, x);
    if (!(depth > 0.0)) return GNEISS_OK;
    GN_TRY(gn_grow(&p->at, 4 * p->count, 4 * p->count + 4, &p->room, "points", error));
    memcpy(p->at + 4 * p->count, x, 3 * sizeof *x);
    p->at[4 * p->count++ + 3] = depth;
    return GNEISS_OK;
}

static gneiss_status fill_grid(const gn_domain *domain, points *p, gneiss_error *error) {
    double lower[3], upper[3];
    int n[3];
    gn_domain_bounds(domain, lower, upper);
    for (int a = 0; a < 3; a++) p->spacing = fmax(p->spacing, (upper[a] - lower[a]) / CELLS);
    for (int a = 0; a < 3; a++) n[a] = (int)ceil((upper[a] - lower[a]) / p->spacing - 1e-9);
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int i = 0; i < n[0]; i++) {
                const int at[3] = {i, j, k};
                double x[3];
                for (int a = 0; a < 3; a++)
                    x[a] = lower[a] + (upper[a] - lower[a]) * (at[a] + 0.5) / n[a];
                GN_TRY(add_point(domain, x, p, error));
            }
    return GNEISS_OK;
}

/* Moves a centre uphill along the axes, in steps that become shorter. */
static void climb(const gn_domain *domain, double spacing, double sphere[4]) {
    double step = 0.5 * spacing;
    for (int halving = 0; halving < HALVINGS;) {
        bool better = false;
        for (int side = 0; side < 6; side++) {
            double x[3] = {sphere[0], sphere[1], sphere[2]};
            x[side / 2] += side % 2 ? step : -step;
            const double depth = gn_domain_depth(domain, x);
            if (!(depth > sphere[3] * (1.0 + 1e-12))) continue;
            memcpy(sphere, x, sizeof x);
            sphere[3] = depth;
            better = true;
        }
        if (better) continue;
        step *= 0.5;
        halving++;
    }
}

static void drop_covered(points *p, const double sphere[4]) {
    size_t kept = 0;
    for (size_t k = 0; k < p->count; k++) {
        const double *x = p->at + 4 * k;
        const double d[3] = {x[0] - sphere[0], x[1] - sphere[1], x[2] - sphere[2]};
        if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < sphere[3] * sphere[3]) continue;
        memmove(p->at + 4 * kept++, x, 4 * sizeof *x);
    }
    p->count = kept;
}

gneiss_status gn_domain_inscribe(const gn_domain *domain, size_t count, double *sphere,
                                 size_t *found, gneiss_error *error) {
    points p = {0};
    gneiss_status status = fill_grid(domain, &p, error);
    for (*found = 0; status == GNEISS_OK && *found < count && p.count;) {
        size_t best = 0;
        for (size_t k = 1; k < p.count; k++)
            if (p.at[4 * k + 3] > p.at[4 * best + 3]) best = k;
        double *to = sphere + 4 * (*found)++;
        memcpy(to, p.at + 4 * best, 4 * sizeof *to);
        climb(domain, p.spacing, to);
        /* The point itself is covered in any case, so that the search ends. */
        p.at[4 * best + 3] = 0.0;
        memmove(p.at + 4 * best, p.at + 4 * (p.count - 1), 4 * sizeof *to);
        p.count--;
        drop_covered(&p, to);
    }
    gn_free(p.at);
    return status;
}
