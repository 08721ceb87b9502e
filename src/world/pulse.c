/* A plane wave that exists at the start (initial.pulse). */
#include "base/error.h"
#include "base/vec3.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/couple_def.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "world/world.h"
#include "zones/zones.h"

#include <math.h>

static void start(const gn_scene *scene, gn_particles *particles) {
    const gn_pulse *p = &scene->pulse;
    double n[3] = {0.0}, size2 = 0.0;
    for (int a = 0; a < (int)scene->dimension; a++) size2 += p->direction[a] * p->direction[a];
    for (int a = 0; a < (int)scene->dimension; a++) n[a] = p->direction[a] / sqrt(size2);
    for (size_t k = 0; k < particles->soa.count; k++) {
        double at = 0.0, u, v;
        for (size_t a = 0; a < 3; a++) at += n[a] * (particles->start[4 * k + a] - p->centre[a]);
        if (!(fabs(at) < 0.5 * p->length)) continue;
        u = 0.5 * p->size * (1.0 + cos(2.0 * M_PI * at / p->length));
        v = p->speed * p->size * M_PI / p->length * sin(2.0 * M_PI * at / p->length);
        for (size_t a = 0; a < 3; a++) {
            particles->pos[4 * k + a] += u * n[a];
            particles->vel[4 * k + a] += v * n[a];
        }
    }
}

/* Shears bonds by the displacements of the pulse, because tangential springs are incremental and do
 * not follow from positions. Otherwise a disordered packing would keep a part of the pulse at its
 * place, held between normal and tangential springs. */
static void shear_bonds(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const gn_contacts *b = &dem->bonds.contacts;
    for (size_t c = 0; (b->shear || b->shear_f) && b->kt && c < b->soa.count; c++) {
        const size_t i = 4 * (size_t)b->i[c], j = 4 * (size_t)b->j[c];
        double n[3], u[3];
        if (!gn_contact_bonded(b, c)) continue;
        double length = sqrt(gn_branch(ctx, q->pos + i, q->pos + j, n));
        for (size_t a = 0; a < 3; a++) {
            n[a] /= length;
            u[a] = (q->pos[j + a] - q->start[j + a]) - (q->pos[i + a] - q->start[i + a]);
        }
        const double along = gn_dot3(u, n);
        for (size_t a = 0; a < 3; a++) {
            const double force = b->kt[c] * (u[a] - along * n[a]);
            const size_t at = c + a * b->soa.capacity;
            if (b->shear) b->shear[at] = force;
            if (b->shear_f) b->shear_f[at] = (float)force;
        }
    }
}

/* Refuses zones in the pulse: their particles follow nodes, between which a pulse would be linear.
 */
static gneiss_status check_zones(const gn_step_context *ctx, const gn_dem *dem,
                                 gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    for (size_t p = 0; q->blend && p < q->soa.count; p++) {
        double moved[3];
        for (int a = 0; a < 3; a++) moved[a] = q->pos[4 * p + a] - q->start[4 * p + a];
        if (q->blend[2 * p] < 1.0 && gn_dot3(moved, moved) > 0.0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected one that starts outside of zones, "
                           "found particle %d of a zone in it",
                           gn_scene_at(&ctx->scene, ctx->scene.couple.where, "initial.pulse").text,
                           q->id[p]);
    }
    return GNEISS_OK;
}

static void start_elements(const gn_step_context *ctx, gn_solids *solids) {
    for (size_t k = 0; k < solids->count; k++) {
        start(&ctx->scene, &solids->elements[k]->solid.nodes);
        gn_fem_positions_changed(&solids->elements[k]->solid);
        gn_fem_to_single(&solids->elements[k]->solid);
    }
}

/* Bonds were made at the positions without the pulse. Elements that reach into a zone may have
 * nodes in it whose elements contain no particle of the zone; zones follow these nodes too. */
gneiss_status gn_pulse_start(gn_world *world, gneiss_error *error) {
    const bool particles = world->dem.particles.soa.count > 0;
    if (!world->ctx.scene.has_pulse) return GNEISS_OK;
    if (particles) start(&world->ctx.scene, &world->dem.particles);
    GN_TRY(check_zones(&world->ctx, &world->dem, error));
    start_elements(&world->ctx, &world->solids);
    if (world->ctx.scene.has_couple)
        gn_coupled_begin(&world->ctx, &world->dem, &world->solids, &world->zones);
    if (particles) shear_bonds(&world->ctx, &world->dem);
    return particles ? gn_world_rebuild(world, error) : GNEISS_OK;
}
