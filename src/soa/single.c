#include "soa/single.h"

#include "base/vec3.h"

#include <math.h>

static void row_to_single(float *to, const double *from, const double *origin, double last) {
    for (int a = 0; a < 3; a++) to[a] = (float)(from[a] - (origin ? origin[a] : 0.0));
    to[3] = (float)last;
}

void gn_particles_to_single(const gn_particles *particles, const double *origin, int threads) {
    const gn_particles *q = particles;
    if (!q->travel_f) return;
    size_t count = q->soa.count + 2; /* includes the null particles, whose origin is 0 */
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t p = 0; p < count; p++) {
        row_to_single(q->travel_f + 4 * p, q->pos + 4 * p, origin + 4 * p, q->pos[4 * p + 3]);
        row_to_single(q->vel_f + 4 * p, q->vel + 4 * p, NULL, q->vel[4 * p + 3]);
        if (q->spin_f) row_to_single(q->spin_f + 4 * p, q->spin + 4 * p, NULL, 0.0);
    }
}

static void contact_to_single(gn_contacts *list, const gn_particles *particles,
                              const double period[3], size_t c) {
    const double *xi = particles->ref + 4 * (int64_t)list->i[c],
                 *xj = particles->ref + 4 * (int64_t)list->j[c];
    double square = 0.0;
    for (size_t a = 0; a < 3; a++) {
        double d = gn_nearest(xj[a] - xi[a], period[a]);
        list->branch_f[c + a * list->soa.capacity] = (float)d;
        square += d * d;
    }
    double free =
        particles->pos[4 * (int64_t)list->i[c] + 3] + particles->pos[4 * (int64_t)list->j[c] + 3];
    if (list->length0) free = list->length0[c];
    list->stretch_f[c] = (float)(sqrt(square) - free);
}

/* Finds a column in single precision and the double column from which it is converted. Returns
 * false if either is absent; the double column is absent if the single one replaces it. */
static bool find_twins(const gn_record *record, const gn_field *field, const void *single_holder,
                       const void *double_holder, float **single, double **wide) {
    if (!field->single_of) return false;
    *single = gn_field_data(field, single_holder);
    *wide = NULL;
    for (size_t f = 0; f < record->field_count; f++)
        if (record->fields[f].offset == field->single_of)
            *wide = gn_field_data(&record->fields[f], double_holder);
    return *single && *wide;
}

static void columns_to_single(const gn_record *record, const void *soa, int threads) {
    const gn_soa *head = soa;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        size_t count = (size_t)field->components * head->capacity; /* includes the padding */
        float *to;
        double *from;
        if (!find_twins(record, field, soa, soa, &to, &from)) continue;
#pragma omp parallel for schedule(static) num_threads(threads)
        for (size_t k = 0; k < count; k++) to[k] = (float)from[k];
    }
}

void gn_contacts_to_single(gn_contacts *contacts, const gn_particles *particles,
                           const double period[3], int threads) {
    if (!contacts->kn_f) return;
    columns_to_single(&gn_contact_record, contacts, threads);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t c = 0; c < contacts->soa.count; c++)
        contact_to_single(contacts, particles, period, c);
    for (size_t c = contacts->soa.count; c < contacts->soa.capacity; c++)
        contacts->branch_f[c] = 1.0F; /* padding: separated */
}

void gn_contacts_from_single(gn_contacts *to, const gn_contacts *from) {
    const gn_record *record = &gn_contact_record;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        float *single;
        double *wide, *unused_as_it_is;
        if (find_twins(record, field, from, from, &single, &unused_as_it_is)) continue;
        if (!find_twins(record, field, from, to, &single, &wide)) continue;
        for (size_t a = 0; a < (size_t)field->components; a++)
            for (size_t c = 0; c < from->soa.count; c++)
                wide[c + a * to->soa.capacity] = single[c + a * from->soa.capacity];
    }
}

void gn_elements_to_single(gn_elements *elements) {
    if (elements->volume_f) columns_to_single(&gn_element_record, elements, 1);
}
