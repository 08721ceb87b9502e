/* Average stress from contact forces and branch vectors: Rojek et al. (2012), sec. 5; Labra et al.
 * (2012); in 2D Kruyt and Rothenburg (1996), J. Appl. Mech. 63, 706-711. Only forces enter: the
 * moments of a contact do no work on a homogeneous displacement gradient. */
#include "measure/assembly.h"
#include "soa/bond_causes.h"
#include "soa/particle_state.h"

#include <string.h>

/* A contact: force on the first particle, unit normal towards the second, and branch vector. */
typedef struct contact {
    size_t i, j;
    double f[3], n[3], l[3], length;
} contact;

static contact contact_at(const gn_assembly *assembly, const gn_contacts *list, size_t c) {
    contact x = {.i = (size_t)list->i[c], .j = (size_t)list->j[c]};
    const double *row = gn_contacts_row(list) + c * (size_t)gn_contacts_row_width(list);
    for (int a = 0; a < assembly->dimension; a++) x.f[a] = row[a];
    x.length = gn_assembly_branch(assembly, x.i, x.j, x.l);
    /* Coincident centres have no normal, and the arm of their force is zero. */
    for (int a = 0; a < 3; a++) x.n[a] = x.length > 0 ? x.l[a] / x.length : 0;
    return x;
}

/* Computes the force on the particle and the vector from its centre to the wall. The arm does not
 * include the overlap: walls are stiff, and their distance is not part of an assembly. */
static void wall_contact_at(const gn_assembly *assembly, size_t c, double f[3], double l[3]) {
    const gn_wall_contacts *list = assembly->wall_contacts;
    const double *x = assembly->particles->pos + 4 * (size_t)list->i[c];
    size_t wall = (size_t)list->wall[c], stride = list->soa.capacity;
    bool facet = list->touch && wall >= assembly->wall_count;
    double away[3] = {0}, size2 = 0;
    for (size_t a = 0; a < (size_t)assembly->dimension; a++) {
        f[a] = list->row[8 * c + a];
        away[a] =
            facet ? list->touch[c + a * stride] - x[a] : -assembly->wall_normals[4 * wall + a];
        size2 += away[a] * away[a];
    }
    double scale = !facet ? x[3] : size2 > 0 ? x[3] / sqrt(size2) : 0;
    for (int a = 0; a < 3; a++) l[a] = scale * away[a];
    for (int a = assembly->dimension; a < 3; a++) f[a] = 0;
}

/* Adds the symmetric part of f arm n, order xx yy zz xy yz xz. */
static void add_symmetric(double sigma[6], const double f[3], const double n[3], double arm) {
    for (int a = 0; a < 3; a++) sigma[a] += arm * f[a] * n[a];
    sigma[3] += 0.5 * arm * (f[0] * n[1] + f[1] * n[0]);
    sigma[4] += 0.5 * arm * (f[1] * n[2] + f[2] * n[1]);
    sigma[5] += 0.5 * arm * (f[0] * n[2] + f[2] * n[0]);
}

/* Adds the contributions of a contact. Its point is half of the gap outside of each particle. Force
 * and normal both change sign from the first particle to the second. */
static void add_pair(const gn_assembly *assembly, const contact *one, double *sigma) {
    const double *pos = assembly->particles->pos;
    double ri = pos[4 * one->i + 3], rj = pos[4 * one->j + 3], gap = one->length - ri - rj;
    add_symmetric(sigma + 6 * one->i, one->f, one->n, ri + 0.5 * gap);
    add_symmetric(sigma + 6 * one->j, one->f, one->n, rj + 0.5 * gap);
}

void gn_stress_particles(const gn_assembly *assembly, double porosity, double *sigma) {
    const gn_particles *particles = assembly->particles;
    memset(sigma, 0, 6 * particles->soa.count * sizeof *sigma);
    for (int l = 0; l < GN_LISTS_MOST; l++) {
        const gn_contacts *list = assembly->list[l];
        for (size_t c = 0; list && c < list->soa.count; c++) {
            contact x = contact_at(assembly, list, c);
            add_pair(assembly, &x, sigma);
        }
    }
    size_t walls = assembly->wall_contacts ? assembly->wall_contacts->soa.count : 0;
    for (size_t c = 0; c < walls; c++) {
        double f[3], l[3];
        wall_contact_at(assembly, c, f, l);
        add_symmetric(sigma + 6 * (size_t)assembly->wall_contacts->i[c], f, l, 1);
    }
    for (size_t p = 0; p < particles->soa.count; p++) {
        double volume = gn_particle_volume(particles, p, assembly->dimension);
        double scale = volume > 0 ? (1 - porosity) / volume : 0;
        for (int k = 0; k < 6; k++) sigma[6 * p + k] *= scale;
    }
}

/* --- figures of a packing, and damage of particles --- */

/* --- packing figures --- */

static void count_particles(const gn_assembly *assembly, double volume,
                            gn_packing_figures *figures) {
    const gn_particles *particles = assembly->particles;
    double sum = 0;
    for (size_t p = 0; p < particles->soa.count; p++) {
        if (!gn_particle_is_active(particles, p)) continue;
        double r = particles->pos[4 * p + 3];
        if (figures->particles == 0) figures->radius_min = figures->radius_max = r;
        figures->radius_min = fmin(figures->radius_min, r);
        figures->radius_max = fmax(figures->radius_max, r);
        figures->solid_volume += gn_particle_volume(particles, p, assembly->dimension);
        figures->particles++;
        sum += r;
    }
    if (figures->particles) figures->radius_mean = sum / (double)figures->particles;
    figures->porosity = volume > 0 ? 1 - figures->solid_volume / volume : NAN;
}

static void count_overlap(const gn_particles *particles, size_t i, size_t j, double overlap,
                          gn_packing_figures *figures) {
    if (overlap <= figures->overlap_max) return;
    figures->overlap_max = overlap;
    figures->overlap_i = particles->id[i];
    figures->overlap_j = particles->id[j];
}

void gn_packing_measure(const gn_assembly *assembly, const int32_t *pairs, size_t pair_count,
                        double tolerance, double volume, gn_packing_figures *figures) {
    const gn_particles *particles = assembly->particles;
    gn_packing_figures g = {.overlap_i = -1, .overlap_j = -1};
    size_t overlaps = 0;
    count_particles(assembly, volume, &g);
    for (size_t k = 0; k < pair_count; k++) {
        size_t i = (size_t)pairs[2 * k], j = (size_t)pairs[2 * k + 1];
        if (!gn_particle_is_active(particles, i) || !gn_particle_is_active(particles, j)) continue;
        double l[3], length = gn_assembly_branch(assembly, i, j, l);
        double reach = particles->pos[4 * i + 3] + particles->pos[4 * j + 3];
        if (length - reach > tolerance * reach) continue;
        g.contacts++;
        /* Coincident centres count as a contact without direction. */
        for (int a = 0; a < 9 && length > 0; a++)
            g.fabric[a] += l[a / 3] * l[a % 3] / (length * length);
        if (length >= reach) continue;
        double overlap = (reach - length) / reach;
        overlaps++;
        g.overlap_mean += overlap;
        count_overlap(particles, i, j, overlap, &g);
    }
    for (int a = 0; a < 9 && g.contacts; a++) g.fabric[a] /= (double)g.contacts;
    if (overlaps) g.overlap_mean /= (double)overlaps;
    if (g.particles) g.coordination = 2 * (double)g.contacts / (double)g.particles;
    *figures = g;
}

/* --- damage --- */

/* Rojek et al. (2012), eq. 60. A bond that was removed with its other particle is no damage to this
 * one. */
void gn_damage_particles(const gn_particles *particles, const gn_contacts *bonds, double *damage) {
    memset(damage, 0, particles->soa.count * sizeof *damage);
    if (!particles->bonds0) return;
    size_t count = bonds ? bonds->soa.count : 0;
    for (size_t c = 0; c < count; c++) {
        if (gn_broken(bonds->cause[c]) || bonds->cause[c] == GN_BOND_NEVER) continue;
        damage[bonds->i[c]] += 1;
        damage[bonds->j[c]] += 1;
    }
    for (size_t p = 0; p < particles->soa.count; p++)
        damage[p] = particles->bonds0[p] > 0 ? 1 - damage[p] / particles->bonds0[p] : 0;
}
