#include "world/structure.h"

#include "base/ball.h"
#include "frame/frame.h"
#include "measure/structure.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "world/space.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

gn_structure_box gn_structure_box_of(const gn_scene *scene) {
    gn_structure_box box = {.used = true, .whole = !scene->has_structure};
    for (int a = 0; a < 3; a++) {
        const bool limited = scene->has_structure && a < (int)scene->dimension;
        box.low[a] = limited ? scene->structure_min[a] : -INFINITY;
        box.high[a] = limited ? scene->structure_max[a] : INFINITY;
    }
    return box;
}

bool gn_structure_has_volume(const gn_world *world) {
    const gn_scene *s = &world->ctx.scene;
    const bool whole = world->ctx.effects & GN_FX_PERIODIC && !gn_scene_half_periodic(s);
    return s->has_structure || whole || (s->specimen_given && !s->source_count);
}

/* Returns the volume of a particle and of its periodic images in the box. */
static double part_in_box(const gn_step_context *ctx, const double *row,
                          const gn_structure_box *box) {
    int images[3];
    double sum = 0.0;
    if (box->whole) return gn_ball_volume((int)ctx->scene.dimension, row[3]);
    for (int a = 0; a < 3; a++) images[a] = ctx->period[a] > 0.0 && isfinite(box->low[a]);
    for (int i = -images[0]; i <= images[0]; i++)
        for (int j = -images[1]; j <= images[1]; j++)
            for (int k = -images[2]; k <= images[2]; k++) {
                const double x[3] = {row[0] + i * ctx->period[0], row[1] + j * ctx->period[1],
                                     row[2] + k * ctx->period[2]};
                sum += gn_ball_in_box((int)ctx->scene.dimension, x, row[3], box->low, box->high);
            }
    return sum;
}

double gn_structure_porosity(const gn_world *world) {
    const gn_particles *q = &world->dem.particles;
    const gn_structure_box box = gn_structure_box_of(&world->ctx.scene);
    double solid = 0.0, volume = 1.0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_particle_is_active(q, p)) solid += part_in_box(&world->ctx, q->pos + 4 * p, &box);
    if (!world->ctx.scene.has_structure)
        volume = gn_space_volume(&world->ctx, &world->dem, &world->membrane, &world->boundary,
                                 &world->solids, &world->box, &world->approach);
    for (int a = 0; world->ctx.scene.has_structure && a < (int)world->ctx.scene.dimension; a++)
        volume *= box.high[a] - box.low[a];
    return 1.0 - solid / volume;
}

double gn_structure_coordination(const gn_world *world) {
    const gn_particles *q = &world->dem.particles;
    const gn_structure_box box = gn_structure_box_of(&world->ctx.scene);
    double count = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        count += gn_particle_is_active(q, p) && gn_in_structure(&box, q->pos + 4 * p);
    return count > 0.0 ? world->dem.done.contacts.ends / count : 0.0;
}

void gn_structure_fabric(const gn_world *world, double fabric[9]) {
    const gn_contact_sums *s = &world->dem.done.contacts;
    memcpy(fabric, s->fabric, sizeof s->fabric);
    for (int k = 0; k < 9; k++) fabric[k] = s->ends > 0.0 ? fabric[k] / s->ends : 0.0;
}

double gn_structure_sliding(const gn_world *world) {
    const gn_contact_sums *s = &world->dem.done.contacts;
    return s->loose_ends > 0.0 ? s->sliding_ends / s->loose_ends : 0.0;
}
