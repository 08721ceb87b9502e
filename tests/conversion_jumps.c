/* conversion_jumps SCENE: runs a scene whose elements convert to its end, and prints of the steps
 * in which some do, the largest of
 * - the largest speed after over the largest before, of nodes and of particles that are awake,
 * surfaces of those that spin included,
 * - the energy that the conversion made, over what the body held before or moved with,
 * how many there were, and what the ledger misses in the end, of all energy. For random_zones.py.
 */
#include "world_helpers.h"

#include "conversion/conversion.h"

static double fastest(const gn_world *w) {
    const gn_particles *of[2] = {&w->dem.particles, &w->solids.elements[0]->solid.nodes};
    double most = 0.0;
    for (int k = 0; k < 2; k++)
        for (size_t p = 0; p < of[k]->soa.count; p++) {
            const double *v = of[k]->vel + 4 * p, *spin = of[k]->spin ? of[k]->spin + 4 * p : NULL;
            if (!(v[3] > 0.0)) continue;
            most = fmax(most, sqrt(gn_dot3(v, v)));
            if (!k && spin) most = fmax(most, of[k]->pos[4 * p + 3] * sqrt(gn_dot3(spin, spin)));
        }
    return most;
}

static double there(const gn_energy *e) {
    return e->kinetic + e->rotational + e->elastic_normal + e->elastic_shear + e->elastic_elements;
}

int main(int count, char **argument) {
    gn_scene scene;
    gn_world w = {0};
    gneiss_error error = {0};
    double faster = 0.0, made = 0.0, times = 0.0;
    if (count < 2) return 2;
    gneiss_status status = gn_scene_load(argument[1], NULL, 0, &scene, &error);
    if (status == GNEISS_OK) status = gn_world_create(&scene, &w, &error);
    while (status == GNEISS_OK && w.ctx.time < w.ctx.scene.end && !*w.outcome.halt) {
        const uint64_t every = w.ctx.scene.couple.convert.every;
        const size_t elements = gn_conversion_elements(&w.solids);
        const bool may = w.ctx.step > 0 && w.ctx.step % every == 0;
        const double before = may ? fastest(&w) : 0.0, booked = w.ledger.energy.conversion;
        if (may) status = gn_conversion_look(&w, &error);
        if (status == GNEISS_OK && gn_conversion_elements(&w.solids) != elements) {
            const double held = there(&w.ledger.reading), after = fastest(&w);
            if (count > 2)
                printf("step %llu: %g -> %g m/s, %g of %g J\n", (unsigned long long)w.ctx.step,
                       before, after, w.ledger.energy.conversion - booked, held);
            faster = fmax(faster, after / before);
            made = fmax(made, (booked - w.ledger.energy.conversion) / held);
            times += 1.0;
        }
        if (status == GNEISS_OK)
            status = gn_world_step(&w, w.ctx.step == 0 || w.ctx.step % every == every - 1, &error);
    }
    if (status == GNEISS_OK) status = gn_world_step(&w, true, &error);
    printf("%.3g %.3g %.0f %.3g %s\n", faster, made, times, gn_energy_residual(&w.ledger.reading),
           status == GNEISS_OK ? "" : error.message);
    gn_world_free(&w);
    return status != GNEISS_OK;
}
