#include "soa/single.h"

#include <math.h>

static void row_to_single(float *to, const double *from, const double *origin, double last) {
    for (int a = 0; a < 3; a++) to[a] = (float)(from[a] - (origin ? origin[a] : 0.0));
    to[3] = (float)last;
}

void gn_particles_to_single(const gn_particles *particles, const double *origin, int threads) {
    const gn_particles *q = particles;
    if (!q->travel_f) return;
    size_t count = q->soa.count + 2; /* with the null particles, whose origin is 0 */
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t p = 0; p < count; p++) {
        row_to_single(q->travel_f + 4 * p, q->pos + 4 * p, origin + 4 * p, q->pos[4 * p + 3]);
        row_to_single(q->vel_f + 4 * p, q->vel + 4 * p, NULL, q->vel[4 * p + 3]);
        if (q->spin_f) row_to_single(q->spin_f + 4 * p, q->spin + 4 * p, NULL, 0.0);
    }
}

static void contact_to_single(gn_contacts *k, const gn_particles *q, const double period[3],
                              size_t c) {
    const double *xi = q->ref + 4 * (int64_t)k->i[c], *xj = q->ref + 4 * (int64_t)k->j[c];
    double square = 0.0;
    for (size_t a = 0; a < 3; a++) {
        double d = xj[a] - xi[a];
        if (period[a] > 0.0) d -= period[a] * nearbyint(d / period[a]);
        k->branch_f[c + a * k->soa.capacity] = (float)d;
        square += d * d;
    }
    double free = q->pos[4 * (int64_t)k->i[c] + 3] + q->pos[4 * (int64_t)k->j[c] + 3];
    if (k->length0) free = k->length0[c];
    k->stretch_f[c] = (float)(sqrt(square) - free);
    k->kn_f[c] = (float)k->kn[c];
    if (k->length0_f) k->length0_f[c] = (float)k->length0[c];
    if (k->kt_f) k->kt_f[c] = (float)k->kt[c];
    if (k->mu_f) k->mu_f[c] = (float)k->mu[c];
    if (k->cn_f) k->cn_f[c] = (float)k->cn[c];
    if (k->rn_f) k->rn_f[c] = (float)k->rn[c];
    if (k->rt_f) k->rt_f[c] = (float)k->rt[c];
}

void gn_contacts_to_single(gn_contacts *contacts, const gn_particles *particles,
                           const double period[3], int threads) {
    if (!contacts->kn_f) return;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t c = 0; c < contacts->soa.count; c++)
        contact_to_single(contacts, particles, period, c);
    for (size_t c = contacts->soa.count; c < contacts->soa.capacity; c++)
        contacts->branch_f[c] = 1.0F; /* padding: apart */
}

void gn_contacts_from_single(gn_contacts *to, const gn_contacts *from) {
    for (size_t c = 0; c < from->soa.count; c++) {
        for (size_t a = 0; to->shear && from->shear_f && a < 3; a++)
            to->shear[c + a * to->soa.capacity] = from->shear_f[c + a * from->soa.capacity];
        if (to->fd && from->fd_f) to->fd[c] = from->fd_f[c];
    }
}

static void column_to_single(float *to, const double *from, size_t count) {
    for (size_t k = 0; k < count; k++) to[k] = (float)from[k];
}

void gn_elements_to_single(gn_elements *q) {
    const size_t stride = q->soa.capacity, dimension = (size_t)gn_elements_dimension(q);
    if (!q->volume_f) return;
    const bool space = dimension == 3;
    column_to_single(space ? q->gradient3_f : q->gradient2_f, space ? q->gradient3 : q->gradient2,
                     dimension * dimension * stride);
    column_to_single(q->volume_f, q->volume, stride);
    column_to_single(q->lambda_f, q->lambda, stride);
    column_to_single(q->mu_f, q->mu, stride);
}
