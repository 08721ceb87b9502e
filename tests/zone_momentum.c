/* zone_momentum SCENE: runs a scene of particles and elements that are one body to its end, and
 * prints by how much its momentum has changed, over the sum of sizes. For random_zones.py. */
#include "world_helpers.h"

#include "zones/zones.h"

/* The share of particles that nodes carry is counted with the nodes; particles that are tied by
 * springs have a momentum of their own. */
static void add_momentum(const gn_world *w, const gn_particles *q, bool particles, double sum[4]) {
    const gn_coupled *z = w->zones.coupled;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *v = q->vel + 4 * p;
        if (!(v[3] > 0.0) || (particles && !z->stiffness && gn_coupled_has(z, q->id[p]))) continue;
        for (int a = 0; a < 3; a++) sum[a] += v[a] / v[3];
        sum[3] += sqrt(gn_dot3(v, v)) / v[3];
    }
}

static void find(const gn_world *w, double sum[4]) {
    memset(sum, 0, 4 * sizeof *sum);
    add_momentum(w, &w->dem.particles, true, sum);
    add_momentum(w, &w->solids.elements[0]->solid.nodes, false, sum);
}

int main(int count, char **argument) {
    gn_scene scene;
    gn_world w = {0};
    gneiss_error error = {0};
    double first[4], last[4], change = 0.0, most;
    if (count != 2) return 2;
    gneiss_status status = gn_scene_load(argument[1], NULL, 0, &scene, &error);
    if (status == GNEISS_OK) status = gn_world_create(&scene, &w, &error);
    if (status == GNEISS_OK) find(&w, first);
    most = first[3];
    while (status == GNEISS_OK && w.ctx.time < w.ctx.scene.end && !*w.outcome.halt) {
        status = gn_world_step(&w, w.ctx.step == 0, &error);
        find(&w, last);
        most = fmax(most, last[3]);
    }
    if (status != GNEISS_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    for (int a = 0; a < 3; a++) change = fmax(change, fabs(last[a] - first[a]));
    printf("%.3g\n", most > 0.0 ? change / most : 0.0);
    gn_world_free(&w);
    return 0;
}
