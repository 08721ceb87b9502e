/* What contacts of particles with surfaces keep from one step to the next. */
#include "base/vec3.h"
#include "boundary/surface_contacts.h"
#include "boundary/surfaces.h"
#include "soa/records.h"
#include "surfaces/facet.h"
#include "surfaces/patch.h"

#include <math.h>
#include <string.h>

/* Rows hold the normal times the part; one of a contact that shared nothing is left as it is. */
static void split_normal(gn_touch_memory *m, double size) {
    m->part = 1.0;
    if (fabs(size - 1.0) < 1e-12) return;
    m->part = size;
    for (int a = 0; a < 3; a++) m->n[a] /= size;
}

static void take_columns(double *column, size_t stride, double out[3]) {
    for (size_t a = 0; a < 3; a++) {
        out[a] = column[a * stride];
        column[a * stride] = 0.0;
    }
}

size_t gn_touch_recall(gn_wall_contacts *rows, size_t begin, size_t end, gn_touch_memory *old) {
    size_t count = 0, stride = rows->soa.capacity;
    for (size_t c = begin; c < end; c++) {
        memset(rows->row + 8 * c, 0, 8 * sizeof *rows->row);
        double *n = rows->normal + c, x = n[0], y = n[stride], z = n[2 * stride];
        if (x == 0.0 && y == 0.0 && z == 0.0) continue;
        gn_touch_memory *m = &old[count < GN_SURFACE_CONTACTS ? count++ : GN_SURFACE_CONTACTS];
        m->row = c;
        m->taken = false;
        take_columns(n, stride, m->n);
        split_normal(m, sqrt(x * x + y * y + z * z));
        if (rows->shear) take_columns(rows->shear + c, stride, m->shear);
        if (rows->roll) take_columns(rows->roll + c, stride, m->roll);
        m->still = !rows->shear && !rows->roll;
        if (!rows->shear) memset(m->shear, 0, sizeof m->shear);
        if (!rows->roll) memset(m->roll, 0, sizeof m->roll);
        m->fd = rows->fd ? rows->fd[c] : 0.0;
        if (rows->fd) rows->fd[c] = 0.0;
        m->closeness = rows->closeness ? rows->closeness[c] : 0.0;
        if (rows->closeness) rows->closeness[c] = 0.0;
    }
    return count;
}

void gn_touch_match(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                    size_t count, int *from) {
    for (size_t k = 0; k < contacts; k++) from[k] = -1;
    for (;;) {
        double best = 0.5;
        size_t contact = 0;
        int which = -1;
        for (size_t k = 0; k < contacts; k++)
            for (size_t m = 0; from[k] < 0 && m < count; m++) {
                double cosine = gn_dot3(now[k].n, old[m].n);
                if (old[m].taken || !(cosine > best)) continue;
                best = cosine;
                contact = k;
                which = (int)m;
            }
        if (which < 0) return;
        from[contact] = which;
        old[which].taken = true;
    }
}

void gn_touch_follow(const double from[3], const double to[3], double force[3]) {
    double axis[3], once[3], twice[3], c = gn_dot3(from, to);
    gn_cross3(from, to, axis);
    gn_cross3(axis, force, once);
    gn_cross3(axis, once, twice);
    for (int a = 0; a < 3; a++) force[a] += once[a] + twice[a] / (1.0 + c);
}

/* --- pressure over many facets --- */

static void add_part(gn_touch_memory *sum, const gn_touch_memory *m, const double to[3],
                     double share) {
    double shear[3], roll[3];
    sum->fd += share * m->fd;
    if (m->still) return;
    memcpy(shear, m->shear, sizeof shear);
    memcpy(roll, m->roll, sizeof roll);
    gn_touch_follow(m->n, to, shear);
    gn_touch_follow(m->n, to, roll);
    for (int a = 0; a < 3; a++) {
        sum->shear[a] += share * shear[a];
        sum->roll[a] += share * roll[a];
    }
}

/* The parts of what a contact held go to those of about its direction, by what they bear: on a
 * plane all of them together are one contact, whatever facets they are on. */
void gn_touch_hand_over(const gn_facet_contact *now, size_t contacts, gn_touch_memory *old,
                        size_t count, gn_touch_memory *before) {
    double load[GN_PATCH_FACETS], weight[GN_PATCH_FACETS];
    for (size_t k = 0; k < contacts; k++) {
        before[k] = (gn_touch_memory){.row = SIZE_MAX};
        memcpy(before[k].n, now[k].n, sizeof before[k].n);
        weight[k] = 0.0;
    }
    for (size_t m = 0; m < count; m++) {
        double sum = 0.0;
        for (size_t k = 0; k < contacts; k++)
            sum += load[k] = gn_patch_share(gn_dot3(now[k].n, old[m].n)) * now[k].part;
        old[m].taken = sum > 0.0;
        for (size_t k = 0; k < contacts && sum > 0.0; k++) {
            const double share = load[k] / sum;
            if (!(share > 0.0)) continue;
            add_part(&before[k], &old[m], now[k].n, share);
            before[k].closeness += share * old[m].part * old[m].closeness;
            weight[k] += share * old[m].part;
        }
    }
    for (size_t k = 0; k < contacts; k++)
        if (weight[k] > 0.0) before[k].closeness /= weight[k];
}

/* The first of those that nobody took, with all of about its direction that follow added. */
bool gn_touch_gather(gn_touch_memory *old, size_t count, gn_touch_memory *sum) {
    size_t first = 0;
    while (first < count && old[first].taken) first++;
    if (first == count) return false;
    double n[3] = {0.0, 0.0, 0.0};
    *sum = old[first];
    sum->part = sum->fd = 0.0;
    memset(sum->shear, 0, sizeof sum->shear);
    memset(sum->roll, 0, sizeof sum->roll);
    for (size_t m = first; m < count; m++) {
        if (old[m].taken || !(gn_patch_share(gn_dot3(old[m].n, old[first].n)) > 0.0)) continue;
        old[m].taken = true;
        sum->part += old[m].part;
        add_part(sum, &old[m], old[first].n, 1.0);
        for (int a = 0; a < 3; a++) n[a] += old[m].part * old[m].n[a];
    }
    const double size = sqrt(gn_dot3(n, n));
    for (int a = 0; a < 3; a++) n[a] /= size;
    gn_touch_follow(sum->n, n, sum->shear);
    gn_touch_follow(sum->n, n, sum->roll);
    memcpy(sum->n, n, sizeof n);
    return true;
}
