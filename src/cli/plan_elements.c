#include "cli/plan_elements.h"

#include "base/point.h"
#include "cli/plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void print_kernels(const gn_world *world, const gn_fem_solid *solid) {
    char name[200];
    bool refused = world->ctx.effects & GN_FX_MIXED && !solid->single;
    printf("  element %s, %s form, %s\n",
           solid->dimension == 3 ? "tetrahedron" : "triangle, plane strain",
           solid->form == GN_FEM_PRESSURE ? "mixed" : "displacement",
           solid->single ? "forces in single precision"
           : refused     ? "double precision (run.precision: mixed is for the displacement form)"
                         : "double precision");
    gn_motion_variant_name(gn_motion_variant(solid->effects), name, sizeof name);
    printf("  nodes   %s\n", name);
}

void gn_print_element_kernels(const gn_world *world) {
    for (size_t k = 0; k < world->solids.count; k++)
        print_kernels(world, &world->solids.elements[k]->solid);
}

static void print_limits(const gn_world *world, const gn_element_model *model) {
    char text[160];
    const gn_fem_limit *limit = &model->limit;
    printf("  elements%s\n",
           gn_elements_lead(&world->ctx, &world->dem, &world->solids, &world->zones) == model
               ? ", which set the step"
               : "");
    if (limit->iterations == 0)
        printf(
            "  sharp limit      not computed: the rigorous bound suffices and replaces it below\n");
    else
        printf("  sharp limit      %.6g s  (Lanczos, %d vectors)\n", limit->sharp,
               limit->iterations);
    printf("  rigorous bound   %.6g s  = %.3f of the sharp limit (element %d)\n", limit->bound,
           limit->bound / limit->sharp, limit->bound_element);
    printf("  set by           %s\n", gn_elements_culprit(&world->ctx, model, text, sizeof text));
}

void gn_print_element_limits(const gn_world *world) {
    for (size_t k = 0; k < world->solids.count; k++) print_limits(world, world->solids.elements[k]);
}

/* --- check --- */

static void print_groups(const gn_mesh *mesh) {
    for (size_t k = 0; k < mesh->group_count; k++) {
        const gn_mesh_group *g = &mesh->groups[k];
        const gn_mesh_elements *lists[] = {&mesh->points, &mesh->lines, &mesh->triangles,
                                           &mesh->tetrahedra};
        static const char *const kinds[] = {"points", "lines", "triangles", "tetrahedra"};
        const gn_mesh_elements *list = lists[g->dimension];
        size_t count = 0;
        for (size_t e = 0; e < list->count; e++) count += list->group[e] == g->tag;
        for (size_t e = 0; e < list->also_count; e++) count += list->also[e].group == g->tag;
        printf("  group %-14s %zu %s (number %d)\n", g->name[0] ? g->name : "-", count,
               kinds[g->dimension], g->tag);
    }
}

static void print_parts(const gn_world *world, const gn_mesh_joints *joints, const char *indent) {
    char place[GN_POINT_SIZE];
    if (joints->parts < 2) return;
    printf("%snote: %zu parts that share no node; the smallest has %zu of %zu elements, one at %s "
           "m\n",
           indent, joints->parts, joints->least, joints->elements,
           gn_point_text(world->ctx.scene.origin, joints->least_at, place));
}

static void print_notes(const gn_world *world, const gn_element_model *model, const char *indent) {
    const gn_fem_solid *solid = &model->solid;
    print_parts(world, &model->joints, indent);
    if (solid->unused_nodes)
        printf("%snote: left out %zu node%s of the mesh that belong%s to no element\n", indent,
               solid->unused_nodes, solid->unused_nodes == 1 ? "" : "s",
               solid->unused_nodes == 1 ? "s" : "");
    if (solid->turned_elements)
        printf("%snote: reoriented %zu element%s with nodes in the opposite order (inside out)\n",
               indent, solid->turned_elements, solid->turned_elements == 1 ? "" : "s");
}

void gn_print_element_notes(const gn_world *world, const char *indent) {
    for (size_t k = 0; k < world->solids.count; k++)
        print_notes(world, world->solids.elements[k], indent);
}

static int by_size(const void *left, const void *right) {
    const double *x = left, *y = right;
    return (*x > *y) - (*x < *y);
}

/* A few slivers make the whole run slow. */
static void print_slivers(const gn_world *world, const gn_element_model *model, int *warnings) {
    const gn_fem_solid *solid = &model->solid;
    size_t count = solid->elements.soa.count;
    char text[160];
    double *scale = calloc(count + 1, sizeof *scale);
    if (!scale) return; /* a hint only */
    gn_fem_step_scales(solid, scale);
    qsort(scale, count, sizeof *scale, by_size);
    double ratio = scale[0] / scale[count / 2];
    free(scale);
    if (ratio > 0.3) return;
    printf("  warning: the step is limited by a sliver, %.2g of the step that half of the elements "
           "allow: %s\n",
           ratio, gn_elements_culprit(&world->ctx, model, text, sizeof text));
    (*warnings)++;
}

static void print_check(const gn_world *world, const gn_element_model *model, int *warnings) {
    const gn_fem_solid *solid = &model->solid;
    const gn_element_def *elements = model->def;
    double lower[3], upper[3];
    printf("elements\n  mesh             %s: %zu nodes, %zu %s\n", solid->name,
           solid->nodes.soa.count, solid->elements.soa.count,
           solid->dimension == 3 ? "tetrahedra" : "triangles");
    for (size_t a = 0; a < (size_t)solid->dimension; a++) {
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
        for (size_t n = 0; n < solid->nodes.soa.count; n++) {
            lower[a] = fmin(lower[a], solid->nodes.start[4 * n + a]);
            upper[a] = fmax(upper[a], solid->nodes.start[4 * n + a]);
        }
        gn_print_range(world, (int)a, lower[a], upper[a], "");
    }
    printf("  volume           %.6g m3, mass %.6g kg%s\n", solid->volume, solid->mass,
           solid->dimension == 2 ? " (1 m thick)" : "");
    print_groups(&solid->mesh);
    for (size_t k = 0; k < elements->motion_count; k++)
        printf("  motion %-13s %zu nodes%s\n", elements->motions[k].name,
               model->motion_set[k].count, model->motion[k] < 0 ? ", only observed" : "");
    for (size_t k = 0; k < elements->load_count; k++)
        printf("  load %-15s %zu nodes\n",
               elements->loads[k].name[0] ? elements->loads[k].name : "-", model->load[k].count);
    print_notes(world, model, "  ");
    print_slivers(world, model, warnings);
}

void gn_print_element_check(const gn_world *world, int *warnings) {
    char doubts[GNEISS_MESSAGE_SIZE];
    for (size_t k = 0; k < world->solids.count; k++)
        print_check(world, world->solids.elements[k], warnings);
    if (!*gn_elements_doubts(&world->ctx, &world->dem, &world->boundary, &world->solids, doubts,
                             sizeof doubts))
        return;
    printf("  warning: %s\n", doubts);
    (*warnings)++;
}
