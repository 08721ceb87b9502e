#include "plan/estimate.h"

#include "accuracy/covers.h"
#include "base/memory.h"
#include "sim/overlap.h"

#include <math.h>
#include <stdlib.h>

/* --- bonds in uniform strain --- */

/* The direction of a bond against the axis. */
static double along(const gn_world *w, size_t c, double *length) {
    const gn_contacts *b = &w->dem.bonds;
    const double *x = w->dem.particles.pos + 4 * (size_t)b->i[c],
                 *y = w->dem.particles.pos + 4 * (size_t)b->j[c];
    double d[3], square = 0.0;
    for (int a = 0; a < 3; a++) {
        d[a] = a < w->scene.dimension ? y[a] - x[a] : 0.0;
        square += d[a] * d[a];
    }
    *length = sqrt(square);
    return d[w->scene.test.axis] / *length;
}

/* Elastic energy of uniform strain, stretched by e along the axis and by f across it, over the
 * volume: 1/2 (A e^2 + 2 B e f + D f^2), from k_n of the part of the strain along each bond and k_t
 * of that across it. Sides without stress: f = -B/D e, and E = A - B^2/D. */
static void uniform_strain(const gn_world *w, gn_estimate *e) {
    const gn_contacts *b = &w->dem.bonds;
    double A = 0.0, B = 0.0, D = 0.0;
    for (size_t c = 0; c < b->soa.count; c++) {
        double length, n = along(w, c, &length), square = n * n, rest = 1.0 - square;
        double kn = b->kn[c] * length * length, kt = b->kt ? b->kt[c] * length * length : 0.0;
        A += kn * square * square + kt * square * rest;
        B += (kn - kt) * square * rest;
        D += kn * rest * rest + kt * rest * square;
    }
    e->poisson = B / D;
    e->uniform = (A - B * e->poisson) / w->volume;
}

/* The strain at which bond c has its strength: normal strain sign (n^2 - nu (1 - n^2)), and what is
 * across it of the displacement of its end. */
static double breaking_strain(const gn_world *w, size_t c, double poisson) {
    const gn_contacts *b = &w->dem.bonds;
    double sign = w->scene.test.kind == GN_TEST_COMPRESSION ? -1.0 : 1.0;
    double length, n = along(w, c, &length), square = n * n, rest = 1.0 - square;
    double normal = sign * (square - poisson * rest);
    double shear = sqrt(fmax(0.0, square + poisson * poisson * rest - normal * normal));
    double tension = normal > 0.0 ? b->rn[c] / (b->kn[c] * length * normal) : INFINITY,
           slip = INFINITY;
    if (b->kt && b->rt && b->kt[c] > 0.0) {
        /* Strength in shear that grows with the pressure: mu_1 of the intact bond. */
        double gain = b->mu1 ? b->mu1[c] * b->kn[c] * length * normal : 0.0;
        double need = b->kt[c] * length * shear + gain;
        slip = need > 0.0 ? b->rt[c] / need : INFINITY;
    }
    return fmin(tension, slip);
}

static int by_size(const void *a, const void *b) {
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* All of them, in their order; at least one. */
static gneiss_status sorted_strains(const gn_world *w, double poisson, double **strain,
                                    gneiss_error *error) {
    size_t count = w->dem.bonds.soa.count;
    *strain = gn_alloc_array(count + 1, sizeof **strain);
    if (!*strain) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu bonds", count);
    for (size_t c = 0; c < count; c++) (*strain)[c] = breaking_strain(w, c, poisson);
    if (!count) **strain = INFINITY;
    qsort(*strain, count, sizeof **strain, by_size);
    return GNEISS_OK;
}

gneiss_status gn_estimate_breaking(const gn_world *w, double poisson, size_t count, double *strain,
                                   gneiss_error *error) {
    double *all;
    size_t bonds = w->dem.bonds.soa.count;
    GN_TRY(sorted_strains(w, poisson, &all, error));
    for (size_t k = 0; k < count; k++) strain[k] = all[bonds * k / count];
    gn_free(all);
    return GNEISS_OK;
}

/* Between two bonds in a straight line. */
static double strain_of_share(const double *all, size_t count, double share) {
    double at = share * (double)count;
    size_t k = at > 0.0 ? (size_t)at : 0;
    if (k + 1 >= count) return all[count ? count - 1 : 0];
    return all[k] + (at - (double)k) * (all[k + 1] - all[k]);
}

/* --- ends --- */

/* Strain between the ends that walls take for themselves under a stress of 1 Pa: their particles
 * press on springs. */
static double wall_compliance(const gn_world *w) {
    const gn_scene *s = &w->scene;
    const gn_test_end *ends[] = {&s->test.lower, &s->test.upper};
    double sum = 0.0;
    for (int k = 0; k < 2; k++) {
        double springs = 0.0;
        for (size_t p = 0; p < ends[k]->count; p++) {
            int wall = gn_scene_find_wall(s, ends[k]->name[p]);
            if (wall >= 0)
                springs +=
                    s->walls[wall].stiffness * (double)gn_wall_overlap(w, (size_t)wall).touching;
        }
        if (springs > 0.0) sum += w->test_area / springs / w->test_length;
    }
    return sum;
}

static double mean_radius(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) sum += q->pos[4 * p + 3];
    return sum / (double)q->soa.count;
}

/* --- the test --- */

/* Where the run ends: at its time, at the strain that it is to stop at, or behind the peak. */
static double end_of(const gn_world *w, const gn_estimate *e) {
    const gn_scene *s = &w->scene;
    double end = e->path;
    if (s->stop_strain > 0.0) end = fmin(end, s->stop_strain);
    if (s->stop_peak_drop > 0.0)
        end = fmin(end, e->strain * gn_slope_base_of(e->study, "end over peak"));
    return end;
}

static gneiss_status foretell_peak(const gn_world *w, gn_estimate *e, gneiss_error *error) {
    double share = gn_slope_base_of(e->study, "share of bonds at the peak"),
           secant = gn_slope_base_of(e->study, "strength over modulus and strain");
    double *all;
    GN_TRY(sorted_strains(w, e->poisson, &all, error));
    e->body_strain = isnan(share) ? NAN : strain_of_share(all, w->dem.bonds.soa.count, share);
    gn_free(all);
    e->strength = secant * e->modulus * e->body_strain;
    e->strain = e->body_strain + e->strength * e->ends;
    e->first_break = e->strain * gn_slope_base_of(e->study, "first break over peak");
    return GNEISS_OK;
}

/* What bends is loaded over a strain that is none of its material's. */
static void foretell_elements(const gn_world *w, gn_estimate *e) {
    e->elements = true;
    e->body_strain = e->strain = e->strength = INFINITY;
    e->end = e->path;
    if (w->scene.stop_strain > 0.0) e->end = fmin(e->end, w->scene.stop_strain);
}

gneiss_status gn_estimate_make(const gn_world *w, gn_estimate *e, gneiss_error *error) {
    const gn_scene *s = &w->scene;
    gn_test_groups groups;
    *e = (gn_estimate){.speed = NAN, .across = NAN};
    e->absent = gn_study_covers(w, &groups);
    if (e->absent) return GNEISS_OK;
    e->study = groups.study;
    e->closing = gn_test_closing(s, s->end);
    e->path = gn_test_path(s, s->end) / w->test_length;
    if (!(e->closing > 0.0) || !(e->path > 0.0))
        e->absent = "the ends of the test are not moved in its sense (servos and loads are not "
                    "planned)";
    if (e->absent) return GNEISS_OK;
    if (groups.mesh) {
        foretell_elements(w, e);
        return GNEISS_OK;
    }
    e->across = groups.across;
    e->radius = mean_radius(w);
    e->bulk = gn_test_bulk(w);
    e->compliance = wall_compliance(w);
    if (e->compliance > 0.0)
        e->ends = e->compliance *
                  gn_slope_base_of("compression", "strain of the ends over that foretold");
    uniform_strain(w, e);
    e->modulus = e->uniform * gn_slope_base_of(e->study, "modulus over uniform strain");
    e->wave = sqrt(e->modulus / e->bulk);
    GN_TRY(foretell_peak(w, e, error));
    e->end = end_of(w, e);
    e->speed = e->closing / (e->wave * fmin(e->strain, e->end));
    return GNEISS_OK;
}
