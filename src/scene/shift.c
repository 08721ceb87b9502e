/* Shift of a scene to coordinates relative to its origin. Every key that is a point in space has a
 * line here, except the boxes that select particles and nodes. */
#include "scene/scene.h"

static void shift(const gn_scene *scene, double *point) {
    for (int64_t a = 0; a < scene->dimension; a++) point[a] -= scene->origin[a];
}

static void shift_rows(const gn_scene *scene, double *rows, size_t count, size_t width) {
    for (size_t k = 0; rows && k < count; k++)
        for (size_t a = 0; a < (size_t)scene->dimension; a++)
            rows[width * k + a] -= scene->origin[a];
}

static void shift_specimen(gn_scene *scene) {
    gn_specimen *specimen = &scene->specimen;
    shift(scene, specimen->lattice.origin);
    shift_rows(scene, specimen->particles, specimen->particle_count, 4);
    if (specimen->pack.shape == GN_SHAPE_NONE) return;
    shift_rows(scene, specimen->pack.corners, specimen->pack.corner_count, 2);
    if (specimen->pack.shape != GN_SHAPE_POLYGON) shift(scene, specimen->pack.origin);
    for (size_t k = 0; k < specimen->pack.refinement_count; k++) {
        if (!specimen->pack.refinements[k].has_region) continue;
        shift(scene, specimen->pack.refinements[k].lower);
        shift(scene, specimen->pack.refinements[k].upper);
    }
}

/* The points of a body's shape are relative to the body's own origin. */
static void shift_bodies(gn_scene *scene) {
    for (size_t k = 0; k < scene->body_count; k++) {
        shift(scene, scene->bodies[k].origin);
        if (scene->bodies[k].has_reference) shift(scene, scene->bodies[k].reference);
    }
}

static void shift_region(const gn_scene *scene, gn_flow_region *region) {
    shift_rows(scene, region->corners, region->corner_count, 2);
    if (!region->corner_count) shift(scene, region->origin);
}

static void shift_flow(gn_scene *scene) {
    for (size_t k = 0; k < scene->source_count; k++) shift_region(scene, &scene->sources[k].region);
    for (size_t k = 0; k < scene->sink_count; k++) {
        shift_region(scene, &scene->sinks[k].region);
        if (scene->sinks[k].has_plane) shift(scene, scene->sinks[k].point);
    }
}

static void shift_clumps(gn_scene *scene) {
    for (size_t k = 0; k < scene->clumps.placed_count; k++)
        shift(scene, scene->clumps.placed[k].centre);
    for (size_t k = 0; k < scene->clumps.filled_count; k++) {
        shift(scene, scene->clumps.filled[k].box_min);
        shift(scene, scene->clumps.filled[k].box_max);
    }
}

void gn_scene_shift(gn_scene *scene) {
    if (scene->has_specimen) shift_specimen(scene);
    shift_flow(scene);
    shift_clumps(scene);
    if (scene->has_elements) {
        shift(scene, scene->elements.origin);
        shift(scene, scene->elements.beam.origin);
    }
    for (size_t z = 0; z < scene->couple.zone_count; z++)
        for (size_t e = 0; e < scene->couple.zones[z].edge_count; e++) {
            shift(scene, scene->couple.zones[z].edges[e].from);
            shift(scene, scene->couple.zones[z].edges[e].to);
        }
    if (scene->has_pulse) shift(scene, scene->pulse.centre);
    if (scene->has_periodic) {
        shift(scene, scene->periodic_min);
        shift(scene, scene->periodic_max);
    }
    if (scene->has_structure) {
        shift(scene, scene->structure_min);
        shift(scene, scene->structure_max);
    }
    if (scene->has_domain) {
        shift(scene, scene->domain_min);
        shift(scene, scene->domain_max);
    }
    for (size_t k = 0; k < scene->wall_count; k++) shift(scene, scene->walls[k].point);
    for (size_t k = 0; k < scene->joint_count; k++) {
        if (scene->joints[k].has_point) shift(scene, scene->joints[k].point);
        shift_rows(scene, scene->joints[k].trace, scene->joints[k].trace_count, 2);
    }
    shift_bodies(scene);
}
