/* The membrane in a step: which particles it still holds, how they have moved together, and the
 * forces. All of it follows from the state, so that a run that goes on has the same bits. */
#include "sim/membrane.h"

#include "base/memory.h"
#include "sim/internal.h"

#include <math.h>
#include <string.h>

/* Steps between looks for particles that broke off. */
enum { LOOK_INTERVAL = 100 };

double gn_membrane_pressure(const gn_world *w) {
    return w->dem.membrane ? w->dem.membrane->pressure : 0.0;
}

static bool pressed(const gn_particles *q, size_t p) {
    return q->skin[4 * p + 3] > 0.0;
}

double gn_membrane_area(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double sum = 0.0;
    for (size_t p = 0; q->skin && p < q->soa.count; p++)
        if (pressed(q, p)) sum += q->skin[4 * p + 3];
    return sum;
}

void gn_membrane_stress(const gn_world *w, double stress[9]) {
    if (!(w->effects & GN_FX_MEMBRANE)) return;
    double share = gn_membrane_area(w) / w->dem.membrane->area;
    for (int k = 0; k < 9; k++)
        stress[k] -= gn_membrane_pressure(w) * share * w->dem.membrane->arms[k] / w->volume;
}

/* --- what broke off --- */

/* Sum of the areas as they were at the start, and their moment about 0. */
static void exerted(const gn_particles *q, double area[3], double moment[3]) {
    double turn[3];
    for (int a = 0; a < 3; a++) area[a] = moment[a] = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!pressed(q, p)) continue;
        gn_cross3(q->start + 4 * p, q->skin + 4 * p, turn);
        for (int a = 0; a < 3; a++) area[a] += q->skin[4 * p + a], moment[a] += turn[a];
    }
}

/* What lay beneath a particle that came off is pressed as it was, and so the body stays in balance:
 * what is missing of the force goes to all others by their areas, then the moment is restored. */
static void hand_on(gn_world *w, const double area[3], const double moment[3]) {
    gn_particles *q = &w->dem.particles;
    const double sum = gn_membrane_area(w);
    double left[3], turn[3];
    if (!(sum > 0.0)) return;
    exerted(q, left, turn);
    for (size_t p = 0; p < q->soa.count; p++) {
        double share = q->skin[4 * p + 3] / sum;
        if (!pressed(q, p)) continue;
        for (int a = 0; a < 3; a++) q->skin[4 * p + a] += share * (area[a] - left[a]);
    }
    gn_membrane_balance(w, moment);
}

/* A particle that had bonds and has none that holds has come off the body, and the membrane with
 * it. */
static void drop(gn_world *w) {
    gn_particles *q = &w->dem.particles;
    const gn_contacts *bonds = &w->dem.bonds;
    double area[3], moment[3];
    bool dropped = false;
    if (!(w->effects & GN_FX_BONDS) || !(w->dem.broken_tension + w->dem.broken_shear > 0)) return;
    uint8_t *holds = gn_alloc_array(q->soa.count + 1, sizeof *holds);
    if (!holds) return; /* looked at again */
    for (size_t c = 0; c < bonds->soa.count; c++)
        if (gn_contact_bonded(bonds, c)) holds[bonds->i[c]] = holds[bonds->j[c]] = 1;
    exerted(q, area, moment);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!pressed(q, p) || holds[p] || q->bonds0[p] == 0) continue;
        q->skin[4 * p + 3] = -q->skin[4 * p + 3];
        memcpy(q->applied + 4 * p, q->load + 4 * p, 4 * sizeof(double));
        dropped = true;
    }
    if (dropped) hand_on(w, area, moment);
    gn_free(holds);
}

/* --- the deformation --- */

void gn_cofactor3(const double a[9], double c[9]) {
    gn_cross3(a + 3, a + 6, c);
    gn_cross3(a + 6, a, c + 3);
    gn_cross3(a, a + 3, c + 6);
}

/* Means of the places at the start and now, weighted with the areas. */
static double means(const gn_particles *q, double start[3], double now[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) start[a] = now[a] = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!pressed(q, p)) continue;
        double weight = q->skin[4 * p + 3];
        sum += weight;
        for (int a = 0; a < 3; a++) {
            start[a] += weight * q->start[4 * p + a];
            now[a] += weight * q->pos[4 * p + a];
        }
    }
    for (int a = 0; a < 3 && sum > 0.0; a++) start[a] /= sum, now[a] /= sum;
    return sum;
}

/* x = F X fitted to the skin by least squares: F = sum(x X) sum(X X)^-1, from the means on. The
 * identity where the skin does not span space. */
static void fit_gradient(const gn_world *w, double gradient[9]) {
    const gn_particles *q = &w->dem.particles;
    double start[3], now[3], moved[9] = {0}, spread[9] = {0}, inverse[9];
    double sum = means(q, start, now), size = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!pressed(q, p)) continue;
        double weight = q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                double from = q->start[4 * p + b] - start[b];
                moved[3 * a + b] += weight * (q->pos[4 * p + a] - now[a]) * from;
                spread[3 * a + b] += weight * (q->start[4 * p + a] - start[a]) * from;
            }
    }
    if (w->scene.dimension == 2) moved[8] = spread[8] = sum;
    for (int a = 0; a < (int)w->scene.dimension; a++) size = fmax(size, spread[4 * a]);
    gn_cofactor3(spread, inverse);
    double det = gn_dot3(spread, inverse);
    bool spans =
        w->scene.dimension == 2 ? det > 1e-9 * size * size * sum : det > 1e-9 * size * size * size;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double f = 0.0;
            for (int k = 0; k < 3; k++) f += moved[3 * a + k] * inverse[3 * k + b];
            gradient[3 * a + b] = spans ? f / det : a == b;
        }
}

/* --- forces --- */

void gn_membrane_press(gn_world *w) {
    gn_particles *q = &w->dem.particles;
    const gn_membrane_def *m = &w->scene.membrane;
    if (!(w->effects & GN_FX_MEMBRANE)) return;
    const double share = w->time < m->ramp ? w->time / m->ramp : 1.0;
    const double pressure = share * gn_table_at(&m->pressure, w->time);
    w->dem.membrane->pressure = pressure;
    double gradient[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, turn[9];
    if (w->step % LOOK_INTERVAL == 0) drop(w);
    if (m->follow) fit_gradient(w, gradient);
    gn_cofactor3(gradient, turn);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!pressed(q, p)) continue;
        for (int a = 0; a < 3; a++)
            q->applied[4 * p + a] =
                q->load[4 * p + a] - pressure * gn_dot3(turn + 3 * a, q->skin + 4 * p);
    }
}
