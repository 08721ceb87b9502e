/* Packing figures and damage of particles. */
#include "base/memory.h"
#include "measure/assembly.h"
#include "soa/bond_causes.h"
#include "soa/particle_state.h"

#include <string.h>

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

/* Rojek et al. (2012), eq. 60. A bond that left with its other particle is no damage to this
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
