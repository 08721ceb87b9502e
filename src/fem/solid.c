/* Construction of nodes and elements from a mesh. */
#include "fem/fem.h"

#include "base/new.h"
#include "base/threads.h"
#include "fem/internal.h"
#include "neigh/neigh.h"
#include "soa/single.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Temporary data of the construction. */
typedef struct builder {
    gn_fem_solid *solid;
    const gn_fem_spec *spec;
    gn_mesh_elements *solids;
    int32_t *place;    /* [nodes of the given mesh] place in the solid, -1: unused */
    int32_t *material; /* [solids] index of the material */
} builder;

static gneiss_status out_of_memory(const builder *maker, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu nodes and %zu elements",
                   maker->solid->name, maker->solid->mesh.node_count, maker->solids->count);
}

/* --- materials --- */

static gneiss_status check_material(const gn_fem_solid *solid, const gn_fem_material *material,
                                    gneiss_error *error) {
    const char *group = material->group ? material->group : "all elements";
    if (!(material->young > 0.0 && material->young < INFINITY && material->density > 0.0 &&
          material->density < INFINITY))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: material of %s: expected Young's modulus and density > 0, found %g Pa "
                       "and %g kg/m3",
                       solid->name, group, material->young, material->density);
    if (material->poisson > -1.0 && material->poisson < 0.5) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: material of %s: expected Poisson's ratio > -1 and < 0.5, because the "
                   "explicit %s form has no stable step for an incompressible material, found %g",
                   solid->name, group, solid->form == GN_FEM_PRESSURE ? "mixed" : "displacement",
                   material->poisson);
}

/* Marks the elements of one material; fails if there are none. */
static gneiss_status give_material(builder *maker, int32_t index, gneiss_error *error) {
    const gn_fem_material *m = &maker->spec->materials[index];
    gn_fem_solid *solid = maker->solid;
    GN_TRY(check_material(solid, m, error));
    solid->density[index] = m->density;
    uint8_t *in = gn_alloc_array(maker->solids->count + 1, sizeof *in);
    if (!in) return out_of_memory(maker, error);
    const gn_mesh_group *group =
        m->group ? gn_fem_find_group(&solid->mesh, m->group, solid->dimension) : NULL;
    if (group)
        gn_fem_mark_group(maker->solids, group->tag, in);
    else
        memset(in, m->group == NULL, maker->solids->count);
    size_t marked = 0;
    for (size_t e = 0; e < maker->solids->count; e++) {
        if (!in[e]) continue;
        maker->material[e] = index;
        marked++;
    }
    gn_free(in);
    if (marked) return GNEISS_OK;
    return gn_fem_no_group(solid->name, &solid->mesh, m->group, solid->dimension, error);
}

static gneiss_status give_materials(builder *maker, gneiss_error *error) {
    maker->material = gn_alloc_array(maker->solids->count + 1, sizeof *maker->material);
    maker->solid->density =
        gn_alloc_array(maker->spec->material_count + 1, sizeof *maker->solid->density);
    if (!maker->material || !maker->solid->density) return out_of_memory(maker, error);
    for (size_t e = 0; e < maker->solids->count; e++) maker->material[e] = -1;
    for (size_t m = 0; m < maker->spec->material_count; m++)
        GN_TRY(give_material(maker, (int32_t)m, error));
    for (size_t e = 0; e < maker->solids->count; e++)
        if (maker->material[e] < 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected a material for every %s, found none for number %zu (base "
                           "0) in group %d",
                           maker->solid->name, gn_fem_kind(maker->solid->dimension), e,
                           maker->solids->group[e]);
    return GNEISS_OK;
}

/* --- nodes --- */

static gneiss_status check_plane(const gn_fem_solid *solid, const gn_mesh_elements *solids,
                                 gneiss_error *error) {
    const double *x = solid->mesh.node, *first = x + 3 * (size_t)solids->node[0];
    for (size_t k = 0; solid->dimension == 2 && k < 3 * solids->count; k++) {
        const double *p = x + 3 * (size_t)solids->node[k];
        if (p[2] != first[2])
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected all nodes in one plane z = %g m, found node %d (base 0) "
                           "at z = %g m",
                           solid->name, first[2], solids->node[k], p[2]);
    }
    return GNEISS_OK;
}

/* Makes particles of the used nodes in the order of the mesh. */
static gneiss_status take_nodes(builder *maker, gn_particles *nodes, gneiss_error *error) {
    gn_fem_solid *solid = maker->solid;
    const gn_mesh *mesh = &solid->mesh;
    maker->place = gn_alloc_array(mesh->node_count + 1, sizeof *maker->place);
    if (!maker->place) return out_of_memory(maker, error);
    for (size_t k = 0; k < maker->solids->count * (size_t)maker->solids->nodes; k++)
        maker->place[maker->solids->node[k]] = 1;
    size_t used = 0;
    for (size_t n = 0; n < mesh->node_count; n++) used += maker->place[n] == 1;
    solid->unused_nodes = mesh->node_count - used;
    GN_TRY(gn_soa_create(&gn_particle_record, nodes, used, solid->effects, error));
    used = 0;
    for (size_t n = 0; n < mesh->node_count; n++) {
        if (!maker->place[n]) continue;
        for (int k = 0; k < solid->dimension; k++) nodes->pos[4 * used + k] = mesh->node[3 * n + k];
        nodes->slot[used] = -1;
        nodes->id[used++] = (int32_t)n;
    }
    return GNEISS_OK;
}

/* Sorts the solid's nodes along the Morton curve, and records the new place of each node of the
 * mesh. */
static gneiss_status order_nodes(builder *maker, const gn_particles *given, gneiss_error *error) {
    gn_fem_solid *solid = maker->solid;
    size_t count = given->soa.count;
    GN_FREED int32_t *order = NULL;
    GN_TRY(gn_new(&order, count, "nodes", error));
    GN_TRY(gn_morton_order(given, solid->dimension, order, error));
    GN_TRY(gn_soa_create(&gn_particle_record, &solid->nodes, count, solid->effects, error));
    gn_soa_permute(&gn_particle_record, &solid->nodes, given, order);
    memcpy(solid->nodes.start, solid->nodes.pos, 4 * count * sizeof(double));
    gn_particles_set_null(&solid->nodes, 1.0);
    for (size_t n = 0; n < solid->mesh.node_count; n++) maker->place[n] = -1;
    for (size_t n = 0; n < count; n++) maker->place[solid->nodes.id[n]] = (int32_t)n;
    return GNEISS_OK;
}

/* Renumbers facets (or solids) to the solid's nodes; those with an unused node are dropped. */
static void renumber_elements(const int32_t *place, gn_mesh_elements *list) {
    size_t kept = 0, also = 0, next = 0, nodes = (size_t)list->nodes;
    for (size_t e = 0; e < list->count; e++) {
        bool used = true;
        for (size_t k = 0; k < nodes; k++) {
            int32_t node = place[list->node[nodes * e + k]];
            used = used && node >= 0;
            list->node[nodes * kept + k] = node;
        }
        for (; next < list->also_count && list->also[next].element == e; next++)
            if (used) list->also[also++] = (gn_mesh_membership){kept, list->also[next].group};
        list->group[kept] = list->group[e];
        kept += used;
    }
    list->count = kept;
    list->also_count = also;
}

static gneiss_status renumber_mesh(builder *maker, gneiss_error *error) {
    gn_mesh *mesh = &maker->solid->mesh;
    size_t count = maker->solid->nodes.soa.count;
    double *node = gn_alloc_array(count + 1, 3 * sizeof *node);
    if (!node) return out_of_memory(maker, error);
    for (size_t n = 0; n < count; n++)
        memcpy(node + 3 * n, mesh->node + 3 * (size_t)maker->solid->nodes.id[n], 3 * sizeof *node);
    gn_free(mesh->node);
    mesh->node = node;
    mesh->node_count = count;
    for (int d = 0; d <= 3; d++) renumber_elements(maker->place, gn_fem_elements_of(mesh, d));
    return GNEISS_OK;
}

/* --- elements --- */

/* The places of an element's nodes in ascending order, and its own number. */
typedef struct sorted_element {
    int32_t node[4], id;
} sorted_element;

static int by_nodes(const void *a, const void *b) {
    const sorted_element *x = a, *y = b;
    for (int k = 0; k < 4; k++)
        if (x->node[k] != y->node[k]) return x->node[k] < y->node[k] ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

static int by_number(const void *a, const void *b) {
    const int32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static sorted_element *sort_elements(const builder *maker) {
    const gn_mesh_elements *list = maker->solids;
    sorted_element *s = gn_alloc_array(list->count + 1, sizeof *s);
    for (size_t e = 0; s && e < list->count; e++) {
        s[e] = (sorted_element){.id = (int32_t)e};
        for (int k = 0; k < list->nodes; k++)
            s[e].node[k] = list->node[(size_t)list->nodes * e + (size_t)k];
        qsort(s[e].node, (size_t)list->nodes, sizeof *s[e].node, by_number);
    }
    if (s) qsort(s, list->count, sizeof *s, by_nodes);
    return s;
}

static double cross_part(const double *a, const double *b, int k) {
    return a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Computes the gradients of the shape functions of all nodes but the first, and returns the volume,
 * which is negative for an inverted element. The gradient of node a is normal to the opposite face:
 * the gradients are rows of the inverse matrix of edges. */
static double gradients(int dimension, const double *const x[4], double gradient[3][3]) {
    double edge[3][3] = {{0.0}, {0.0}, {0.0, 0.0, 1.0}};
    for (int a = 0; a < dimension; a++)
        for (int k = 0; k < dimension; k++) edge[a][k] = x[a + 1][k] - x[0][k];
    double det = 0.0;
    for (int k = 0; k < 3; k++) det += edge[0][k] * cross_part(edge[1], edge[2], k);
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++)
            gradient[a][k] = cross_part(edge[(a + 1) % 3], edge[(a + 2) % 3], k) / det;
    return dimension == 3 ? det / 6.0 : det / 2.0;
}

static double longest_edge(int dimension, const double *const x[4]) {
    double most = 0.0;
    for (int a = 0; a <= dimension; a++)
        for (int c = 0; c < a; c++) {
            double d2 = 0.0;
            for (int k = 0; k < dimension; k++) d2 += (x[a][k] - x[c][k]) * (x[a][k] - x[c][k]);
            most = fmax(most, d2);
        }
    return sqrt(most);
}

/* The shape function of a node decreases from 1 to 0 over the height of the element at that node.
 */
static double least_height(int dimension, const double gradient[3][3]) {
    double first[3] = {0.0}, steepest2 = 0.0;
    for (int a = 0; a < dimension; a++) {
        double size2 = 0.0;
        for (int k = 0; k < dimension; k++) {
            size2 += gradient[a][k] * gradient[a][k];
            first[k] -= gradient[a][k];
        }
        steepest2 = fmax(steepest2, size2);
    }
    steepest2 = fmax(steepest2, first[0] * first[0] + first[1] * first[1] + first[2] * first[2]);
    return 1.0 / sqrt(steepest2);
}

static gneiss_status no_volume(const builder *maker, int32_t id, const int32_t node[4],
                               double volume, gneiss_error *error) {
    char at[GN_POINT_SIZE];
    gn_point_text(maker->solid->origin, maker->solid->nodes.start + 4 * (size_t)node[0], at);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected elements with a volume, found %s %d (base 0) at %s m with %g m%d",
                   maker->solid->name, gn_fem_kind(maker->solid->dimension), id, at, volume,
                   maker->solid->dimension);
}

/* Least weight of an element, which gives mass to nodes whose weight is zero. */
static const double share_least = 1e-6;

static double share_of(const gn_fem_spec *spec, int dimension, const double *const x[4]) {
    double sum = 0.0;
    if (!spec->share) return 1.0;
    for (int a = 0; a <= dimension; a++) sum += spec->share(spec->share_of, x[a]);
    return fmax(sum / (dimension + 1), share_least);
}

/* Makes element e of the solid from element `id` of the mesh; nodes are in the mesh's order, the
 * last two exchanged if it is inverted. */
static gneiss_status make_element(builder *maker, size_t e, int32_t id, gneiss_error *error) {
    enum { ROUND_OFF = 64 };
    gn_fem_solid *solid = maker->solid;
    const int d = solid->dimension;
    gn_elements *q = &solid->elements;
    const double *x[4];
    int32_t node[4] = {0};
    memcpy(node, maker->solids->node + (size_t)(d + 1) * (size_t)id,
           (size_t)(d + 1) * sizeof *node);
    double gradient[3][3], volume = 0.0;
    for (int turn = 0; turn < 2; turn++) {
        for (int a = 0; a <= d; a++) x[a] = solid->nodes.start + 4 * (size_t)node[a];
        volume = gradients(d, x, gradient);
        if (turn || !(volume < 0.0)) break;
        int32_t last = node[d];
        node[d] = node[d - 1];
        node[d - 1] = last;
        solid->turned_elements++;
    }
    if (!(volume > ROUND_OFF * 2.2e-16 * pow(longest_edge(d, x), d)))
        return no_volume(maker, id, node, volume, error);
    const gn_fem_material *m = &maker->spec->materials[maker->material[id]];
    solid->height = fmin(solid->height, least_height(d, (const double(*)[3])gradient));
    volume *= share_of(maker->spec, d, x);
    q->id[e] = id;
    q->material[e] = maker->material[id];
    q->volume[e] = volume;
    q->mu[e] = 0.5 * m->young / (1.0 + m->poisson);
    q->lambda[e] = 2.0 * q->mu[e] * m->poisson / (1.0 - 2.0 * m->poisson);
    for (int a = 0; a <= d; a++) {
        gn_elements_node(q, a)[e] = node[a];
        for (int k = 0; a && k < d; k++) gn_elements_gradient(q, a, k)[e] = gradient[a - 1][k];
        solid->nodes.vel[4 * (size_t)node[a] + 3] += m->density * volume / (d + 1);
    }
    solid->volume += volume;
    solid->mass += m->density * volume;
    return GNEISS_OK;
}

static gneiss_status make_elements(builder *maker, gneiss_error *error) {
    gn_fem_solid *solid = maker->solid;
    GN_TRY(gn_soa_create(&gn_element_record, &solid->elements, maker->solids->count, solid->effects,
                         error));
    sorted_element *order = sort_elements(maker);
    solid->height = INFINITY;
    gneiss_status status = order ? GNEISS_OK : out_of_memory(maker, error);
    for (size_t e = 0; e < maker->solids->count && status == GNEISS_OK; e++)
        status = make_element(maker, e, order[e].id, error);
    gn_free(order);
    GN_TRY(status);
    /* Converts the sums of masses to inverse masses. */
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        solid->nodes.vel[4 * n + 3] = 1.0 / solid->nodes.vel[4 * n + 3];
    for (size_t n = 0; solid->nodes.blend && n < solid->nodes.soa.count; n++) {
        solid->nodes.blend[2 * n] = 1.0;
        solid->nodes.blend[2 * n + 1] = GN_FEM_FAR;
    }
    bool uniform = maker->spec->material_count == 1;
    solid->uniform.lambda = solid->uniform.mu = uniform ? ~(size_t)0 : 0;
    gn_elements_pad(&solid->elements, &solid->nodes);
    return GNEISS_OK;
}

/* --- the solid --- */

gneiss_status gn_fem_set_environment(gn_fem_solid *solid, const double gravity[3],
                                     gn_effects damping, double coefficient, gneiss_error *error) {
    const gn_effects own =
        GN_FX_GRAVITY | GN_FX_VISCOUS | GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT;
    solid->effects = (solid->effects & ~own) | damping;
    solid->damping_coefficient = coefficient;
    for (int k = 0; k < solid->dimension; k++) {
        solid->gravity[k] = gravity[k];
        if (gravity[k] != 0.0) solid->effects |= GN_FX_GRAVITY;
    }
    if (solid->nodes.soa.capacity) solid->nodes.soa.effects = solid->effects;
    if (solid->elements.soa.capacity) solid->elements.soa.effects = solid->effects;
    return gn_motion_kernel_choose(solid->kernels, solid->effects, &solid->motion_kernel, error);
}

static gneiss_status prepare(gn_fem_solid *solid, const gn_fem_spec *spec, gneiss_error *error) {
    bool space = spec->dimension == 3;
    snprintf(solid->name, sizeof solid->name, "%s", spec->name ? spec->name : "mesh");
    memcpy(solid->origin, spec->origin, sizeof solid->origin);
    solid->dimension = spec->dimension;
    solid->form = spec->form;
    solid->single = spec->single;
    solid->threads = spec->threads > 0 ? spec->threads : 1;
    if (solid->threads > GN_THREADS_MAX) solid->threads = GN_THREADS_MAX;
    solid->effects = GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_ENERGY;
    if (space) solid->effects |= GN_FX_SPACE;
    const bool pressure = solid->form == GN_FEM_PRESSURE;
    if (pressure) solid->effects |= GN_FX_PRESSURE;
    if (solid->single) solid->effects |= GN_FX_MIXED;
    if (spec->shrinks) solid->effects |= GN_FX_OVERLAP;
    GN_TRY(gn_kernel_set_choose(spec->isa, &solid->kernels, error));
    for (int measure = 0; measure < 2; measure++)
        solid->element_kernel[measure] =
            solid->kernels->element[gn_element_variant(space, measure, pressure)];
    if (solid->single) solid->element_kernel[0] = solid->kernels->single[space];
    return gn_fem_set_environment(solid, spec->gravity, spec->damping, spec->damping_coefficient,
                                  error);
}

static gneiss_status make_sums(builder *maker, gneiss_error *error) {
    gn_fem_solid *solid = maker->solid;
    size_t nodes = solid->nodes.soa.count;
    GN_TRY(gn_element_partials_build(&solid->elements, nodes, solid->threads, &solid->partials,
                                     error));
    solid->motion_blocks = (nodes + GN_PARTICLE_BLOCK - 1) / GN_PARTICLE_BLOCK;
    solid->element_sums = gn_alloc_array(solid->partials.blocks + 1, sizeof *solid->element_sums);
    solid->motion_sums = gn_alloc_array(solid->motion_blocks + 1, sizeof *solid->motion_sums);
    if (!solid->element_sums || !solid->motion_sums) return out_of_memory(maker, error);
    GN_TRY(gn_hold_create(&solid->hold, solid->motion_blocks, error));
    GN_TRY(gn_deal_create(&solid->deal, solid->threads, error));
    const gn_deal_list elements = {.partials = &solid->partials};
    return gn_deal_lists(&solid->deal, &elements, 1, solid->motion_blocks, error);
}

static gneiss_status build(builder *maker, gneiss_error *error) {
    gn_fem_solid *solid = maker->solid;
    if (maker->spec->dimension != 2 && maker->spec->dimension != 3)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "finite elements: expected dimension 2 or 3, found %d",
                       maker->spec->dimension);
    if (maker->spec->form != GN_FEM_DISPLACEMENT && maker->spec->form != GN_FEM_PRESSURE)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "finite elements: expected the displacement or the mixed form, found form "
                       "%d",
                       (int)maker->spec->form);
    if (maker->spec->single && maker->spec->form == GN_FEM_PRESSURE)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "finite elements: expected double precision with the mixed form, found "
                       "single, which only the displacement form has");
    GN_TRY(prepare(solid, maker->spec, error));
    if (!maker->solids->count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a mesh with %s elements, found none (%zu lines, %zu "
                       "triangles, %zu tetrahedra)",
                       solid->name, gn_fem_kind(solid->dimension), solid->mesh.lines.count,
                       solid->mesh.triangles.count, solid->mesh.tetrahedra.count);
    GN_TRY(check_plane(solid, maker->solids, error));
    GN_TRY(give_materials(maker, error));
    gn_particles given = {0};
    gneiss_status status = take_nodes(maker, &given, error);
    if (status == GNEISS_OK) status = order_nodes(maker, &given, error);
    gn_soa_destroy(&gn_particle_record, &given);
    GN_TRY(status);
    GN_TRY(renumber_mesh(maker, error));
    GN_TRY(make_elements(maker, error));
    GN_TRY(make_sums(maker, error));
    gn_fem_to_single(solid);
    return solid->form == GN_FEM_PRESSURE ? gn_fem_pressure_prepare(solid, error) : GNEISS_OK;
}

gneiss_status gn_fem_solid_create(const gn_fem_spec *spec, gn_mesh *mesh, gn_fem_solid *solid,
                                  gneiss_error *error) {
    memset(solid, 0, sizeof *solid);
    solid->mesh = *mesh;
    memset(mesh, 0, sizeof *mesh);
    builder b = {.solid = solid, .spec = spec};
    b.solids = gn_fem_elements_of(&solid->mesh, spec->dimension);
    gneiss_status status = build(&b, error);
    gn_free(b.place);
    gn_free(b.material);
    if (status != GNEISS_OK) gn_fem_solid_free(solid);
    return status;
}

void gn_fem_to_single(gn_fem_solid *solid) {
    gn_particles_to_single(&solid->nodes, solid->nodes.start, solid->threads);
    gn_elements_to_single(&solid->elements);
}

void gn_fem_solid_free(gn_fem_solid *solid) {
    gn_prescription *q = &solid->prescribed;
    void *blocks[] = {q->set,
                      q->mask,
                      q->velocity,
                      q->load,
                      solid->channel,
                      solid->element_sums,
                      solid->motion_sums,
                      solid->density,
                      solid->carried,
                      solid->growth_row,
                      solid->slope_row,
                      solid->pressure,
                      solid->pressure_sums};
    gn_mesh_free(&solid->mesh);
    gn_soa_destroy(&gn_particle_record, &solid->nodes);
    gn_soa_destroy(&gn_element_record, &solid->elements);
    gn_partials_free(&solid->partials);
    gn_deal_free(&solid->deal);
    gn_hold_free(&solid->hold);
    gn_fem_known_free(solid->bound_cache);
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    memset(solid, 0, sizeof *solid);
}

uint64_t gn_fem_hash(const gn_fem_solid *solid) {
    uint64_t h = gn_soa_hash(&gn_particle_record, &solid->nodes, GN_HASH_SEED);
    h = gn_soa_hash(&gn_element_record, &solid->elements, h);
    h = gn_hash_bytes(&solid->time, sizeof solid->time, h);
    return gn_hash_bytes(&solid->step, sizeof solid->step, h);
}
