/* Sets of nodes, prescribed motions and loads. */
#include "fem/internal.h"

#include "base/names.h"
#include "base/new.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- groups --- */

const gn_mesh_group *gn_fem_find_group(const gn_mesh *mesh, const char *name, int dimension) {
    for (size_t k = 0; k < mesh->group_count; k++) {
        const gn_mesh_group *g = &mesh->groups[k];
        char tag[16];
        snprintf(tag, sizeof tag, "%d", g->tag);
        bool named = strcmp(g->name, name) == 0 || strcmp(tag, name) == 0;
        if (*name && named && (dimension < 0 || g->dimension == dimension)) return g;
    }
    return NULL;
}

bool gn_fem_has_group(const gn_mesh *mesh, const char *group, int dimension) {
    return gn_fem_find_group(mesh, group, dimension) != NULL;
}

gneiss_status gn_fem_check_group(const char *name, const gn_mesh *mesh, const char *group,
                                 int dimension, gneiss_error *error) {
    if (gn_fem_has_group(mesh, group, dimension)) return GNEISS_OK;
    return gn_fem_no_group(name, mesh, group, dimension, error);
}

/* Reports a group that exists in the file, but without elements of the body. */
static gneiss_status empty_group(const char *mesh_name, const gn_mesh_group *group,
                                 const char *name, int dimension, gneiss_error *error) {
    if (dimension >= 0 && group->dimension != dimension)
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: expected a physical group '%s' of %s elements, found one of %s elements",
            mesh_name, name, gn_fem_kind(dimension), gn_fem_kind(group->dimension));
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected elements of the body in the physical group '%s' (tag %d, %dD), "
                   "found none: the file only names it, or its elements lie apart from the body",
                   mesh_name, name, group->tag, group->dimension);
}

gneiss_status gn_fem_no_group(const char *mesh_name, const gn_mesh *mesh, const char *name,
                              int dimension, gneiss_error *error) {
    char there[512] = "none", advice[GN_ADVICE_SIZE] = "";
    size_t used = 0;
    const gn_mesh_group *own = gn_fem_find_group(mesh, name, dimension);
    if (!own) own = gn_fem_find_group(mesh, name, -1);
    if (own) return empty_group(mesh_name, own, name, dimension, error);
    gn_names names = gn_names_for(name);
    for (size_t k = 0; k < mesh->group_count && used < sizeof there; k++) {
        const gn_mesh_group *g = &mesh->groups[k];
        used += (size_t)snprintf(there + used, sizeof there - used, "%s'%s' (tag %d, %dD)",
                                 k ? ", " : "", g->name, g->tag, g->dimension);
        if (dimension < 0 || g->dimension == dimension) gn_names_add(&names, g->name);
    }
    if (names.nearest) gn_names_advice(&names, advice, sizeof advice);
    char kind[32] = "";
    if (dimension >= 0) snprintf(kind, sizeof kind, " of %s elements", gn_fem_kind(dimension));
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a physical group '%s'%s with elements, found %s%s", mesh_name,
                   name, kind, there, advice);
}

void gn_fem_mark_group(const gn_mesh_elements *list, int32_t tag, uint8_t *in) {
    for (size_t e = 0; e < list->count; e++) in[e] = list->group[e] == tag;
    for (size_t k = 0; k < list->also_count; k++)
        if (list->also[k].group == tag) in[list->also[k].element] = 1;
}

/* --- sets --- */

static gneiss_status collect(const uint8_t *chosen, size_t nodes, gn_fem_set *set,
                             gneiss_error *error) {
    size_t count = 0;
    for (size_t n = 0; n < nodes; n++) count += chosen[n];
    set->count = 0;
    GN_TRY(gn_new(&set->node, count, "nodes of a set", error));
    for (size_t n = 0; n < nodes; n++)
        if (chosen[n]) set->node[set->count++] = (int32_t)n;
    return GNEISS_OK;
}

static gneiss_status chosen_nodes(const gn_fem_solid *solid, const gn_mesh_group *group,
                                  gn_fem_set *set, gneiss_error *error) {
    gn_mesh mesh = solid->mesh;
    const gn_mesh_elements *list = gn_fem_elements_of(&mesh, group->dimension);
    const size_t nodes = (size_t)list->nodes;
    GN_FREED uint8_t *chosen = NULL, *in = NULL;
    GN_TRY(gn_new(&chosen, solid->nodes.soa.count, "nodes", error));
    GN_TRY(gn_new(&in, list->count, "elements", error));
    gn_fem_mark_group(list, group->tag, in);
    for (size_t k = 0; k < list->count * nodes; k++)
        if (in[k / nodes]) chosen[list->node[k]] = 1;
    return collect(chosen, solid->nodes.soa.count, set, error);
}

gneiss_status gn_fem_nodes_of_group(const gn_fem_solid *solid, const char *group, gn_fem_set *set,
                                    gneiss_error *error) {
    *set = (gn_fem_set){0};
    const gn_mesh_group *found = gn_fem_find_group(&solid->mesh, group, -1);
    if (found) GN_TRY(chosen_nodes(solid, found, set, error));
    if (set->count) return GNEISS_OK;
    gn_fem_set_free(set);
    return gn_fem_no_group(solid->name, &solid->mesh, group, -1, error);
}

gneiss_status gn_fem_nodes_in_box(const gn_fem_solid *solid, const double lower[3],
                                  const double upper[3], gn_fem_set *set, gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count;
    GN_FREED uint8_t *chosen = NULL;
    *set = (gn_fem_set){0};
    GN_TRY(gn_new(&chosen, nodes, "nodes", error));
    for (size_t n = 0; n < nodes; n++) {
        const double *x = solid->nodes.start + 4 * n;
        chosen[n] = 1;
        for (int k = 0; k < solid->dimension; k++)
            chosen[n] &= gn_fem_between(solid, x, k, lower[k], upper[k]);
    }
    GN_TRY(collect(chosen, nodes, set, error));
    if (set->count) return GNEISS_OK;
    gn_fem_set_free(set);
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected nodes in the box from (%.12g, %.12g, %.12g) to (%.12g, %.12g, %.12g) m, "
        "found none",
        solid->name, lower[0], lower[1], lower[2], upper[0], upper[1], upper[2]);
}

void gn_fem_set_free(gn_fem_set *set) {
    gn_free(set->node);
    *set = (gn_fem_set){0};
}

/* --- prescribed motion --- */

/* Enlarges an array to `count` items of `size` and frees the old one. */
static bool grow(void **array, size_t had, size_t count, size_t size) {
    void *larger = gn_alloc_array(count + 1, size);
    if (!larger) return false;
    if (had) memcpy(larger, *array, had * size);
    gn_free(*array);
    *array = larger;
    return true;
}

static gneiss_status add_slots(gn_fem_solid *solid, const gn_fem_set *set, gneiss_error *error) {
    gn_prescription *q = &solid->prescribed;
    size_t had = q->count, count = had;
    for (size_t k = 0; k < set->count; k++) count += solid->nodes.slot[set->node[k]] < 0;
    bool held = grow((void **)&q->set, had, count, sizeof *q->set) &&
                grow((void **)&q->mask, had, count, sizeof *q->mask) &&
                grow((void **)&q->velocity, had, count, 6 * sizeof *q->velocity) &&
                grow((void **)&q->load, had, count, 6 * sizeof *q->load) &&
                grow((void **)&solid->channel, had, count, sizeof *solid->channel);
    if (!held)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu prescribed nodes", count);
    for (size_t k = 0; k < set->count; k++) {
        int32_t *slot = &solid->nodes.slot[set->node[k]];
        if (*slot >= 0) continue;
        *slot = (int32_t)q->count++;
        for (int a = 0; a < 3; a++) solid->channel[*slot][a] = -1;
    }
    return GNEISS_OK;
}

gneiss_status gn_fem_prescribe(gn_fem_solid *solid, const gn_fem_set *set, unsigned mask,
                               const double velocity[3], int32_t *motion, gneiss_error *error) {
    GN_TRY(add_slots(solid, set, error));
    *motion = solid->motion_count++;
    for (size_t k = 0; k < set->count; k++) {
        int32_t slot = solid->nodes.slot[set->node[k]];
        for (int a = 0; a < solid->dimension; a++) {
            if (!(mask >> a & 1)) continue;
            solid->prescribed.mask[slot] |= (uint8_t)(1u << a);
            solid->prescribed.set[slot] = *motion;
            solid->channel[slot][a] = *motion;
        }
    }
    gn_fem_set_velocity(solid, *motion, velocity);
    return GNEISS_OK;
}

/* Gives prescribed components their prescribed value at the start, which avoids a jump. */
static void start_prescribed(gn_fem_solid *solid) {
    for (size_t n = 0; n < solid->nodes.soa.count; n++) {
        int32_t slot = solid->nodes.slot[n];
        for (size_t a = 0; slot >= 0 && a < 3; a++)
            if (solid->prescribed.mask[slot] >> a & 1)
                solid->nodes.vel[4 * n + a] = solid->prescribed.velocity[6 * (size_t)slot + a];
    }
}

void gn_fem_set_velocity(gn_fem_solid *solid, int32_t motion, const double velocity[3]) {
    for (size_t slot = 0; slot < solid->prescribed.count; slot++)
        for (size_t a = 0; a < 3; a++)
            if (solid->channel[slot][a] == motion)
                solid->prescribed.velocity[6 * slot + a] = velocity[a];
    if (solid->step == 0) start_prescribed(solid);
}

void gn_fem_reaction(const gn_fem_solid *solid, int32_t motion, double force[3]) {
    for (int a = 0; a < 3; a++) force[a] = 0.0;
    for (size_t slot = 0; slot < solid->prescribed.count; slot++)
        for (size_t a = 0; a < 3; a++)
            if (solid->channel[slot][a] == motion) force[a] += solid->prescribed.load[6 * slot + a];
}

/* --- forces --- */

/* Returns the initial area of a facet, m2; a line is 1 m thick. */
static double facet_area(const gn_fem_solid *solid, const int32_t *node) {
    const double *x = solid->mesh.node + 3 * (size_t)node[0];
    const double *y = solid->mesh.node + 3 * (size_t)node[1];
    double a[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    if (solid->dimension == 2) return sqrt(a[0] * a[0] + a[1] * a[1]);
    const double *z = solid->mesh.node + 3 * (size_t)node[2];
    double b[3] = {z[0] - x[0], z[1] - x[1], z[2] - x[2]}, sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double n = a[k] * b[(k + 1) % 3] - a[(k + 1) % 3] * b[k];
        sum += n * n;
    }
    return 0.5 * sqrt(sum);
}

/* ---- loads that may vary with time ---- */

/* Collects the nodes whose weight is above zero. */
static gneiss_status collect_load(const double *weight, size_t nodes, gn_fem_load *load,
                                  gneiss_error *error) {
    size_t count = 0;
    for (size_t n = 0; n < nodes; n++) count += weight[n] > 0.0;
    *load = (gn_fem_load){0};
    GN_TRY(gn_new(&load->node, count, "nodes of a load", error));
    if (gn_new(&load->share, count, "nodes of a load", error) != GNEISS_OK) {
        gn_fem_load_free(load);
        return GNEISS_ERROR_MEMORY;
    }
    for (size_t n = 0; n < nodes; n++) {
        if (!(weight[n] > 0.0)) continue;
        load->node[load->count] = (int32_t)n;
        load->share[load->count++] = weight[n];
    }
    return GNEISS_OK;
}

static bool starts_in(const gn_fem_solid *solid, const int32_t *node, size_t nodes,
                      const double lower[3], const double upper[3]) {
    for (size_t k = 0; k < nodes; k++)
        for (int a = 0; a < solid->dimension; a++) {
            const double *x = solid->nodes.start + 4 * (size_t)node[k];
            if (!gn_fem_between(solid, x, a, lower[a], upper[a])) return false;
        }
    return true;
}

static gneiss_status no_facets(const gn_fem_solid *solid, const char *group, const double lower[3],
                               const double upper[3], gneiss_error *error) {
    int facets = solid->dimension - 1;
    if (group) return gn_fem_no_group(solid->name, &solid->mesh, group, facets, error);
    gn_mesh mesh = solid->mesh;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected facets in the box from (%.12g, %.12g, %.12g) to (%.12g, %.12g, %.12g) "
        "m, found none among the %zu %ss that the mesh lists",
        solid->name, lower[0], lower[1], lower[2], upper[0], upper[1], upper[2],
        gn_fem_elements_of(&mesh, facets)->count, gn_fem_kind(facets));
}

gneiss_status gn_fem_load_on_facets(const gn_fem_solid *solid, const char *group,
                                    const double lower[3], const double upper[3], gn_fem_load *load,
                                    gneiss_error *error) {
    gn_mesh mesh = solid->mesh;
    const gn_mesh_elements *list = gn_fem_elements_of(&mesh, solid->dimension - 1);
    const gn_mesh_group *found =
        group ? gn_fem_find_group(&solid->mesh, group, solid->dimension - 1) : NULL;
    size_t nodes = (size_t)solid->dimension, chosen = 0;
    GN_FREED uint8_t *in = NULL;
    GN_FREED double *area = NULL;
    *load = (gn_fem_load){0};
    GN_TRY(gn_new(&in, list->count, "facets", error));
    GN_TRY(gn_new(&area, solid->nodes.soa.count, "nodes", error));
    if (found) gn_fem_mark_group(list, found->tag, in);
    for (size_t f = 0; f < list->count; f++) {
        const int32_t *node = list->node + nodes * f;
        if (!(group ? in[f] : starts_in(solid, node, nodes, lower, upper))) continue;
        double part = facet_area(solid, node) / (double)nodes;
        for (size_t k = 0; k < nodes; k++) area[node[k]] += part;
        chosen++;
    }
    return chosen ? collect_load(area, solid->nodes.soa.count, load, error)
                  : no_facets(solid, group, lower, upper, error);
}

gneiss_status gn_fem_load_on_nodes(const gn_fem_solid *solid, const gn_fem_set *set,
                                   gn_fem_load *load, gneiss_error *error) {
    GN_FREED double *mass = NULL;
    *load = (gn_fem_load){0};
    GN_TRY(gn_new(&mass, solid->nodes.soa.count, "nodes", error));
    for (size_t k = 0; k < set->count; k++) {
        size_t n = (size_t)set->node[k];
        mass[n] = 1.0 / solid->nodes.vel[4 * n + 3];
    }
    GN_TRY(collect_load(mass, solid->nodes.soa.count, load, error));
    gn_fem_load_normalise(load);
    return GNEISS_OK;
}

void gn_fem_load_normalise(gn_fem_load *load) {
    double total = 0.0;
    for (size_t k = 0; k < load->count; k++) total += load->share[k];
    for (size_t k = 0; k < load->count; k++) load->share[k] /= total;
}

void gn_fem_load_free(gn_fem_load *load) {
    gn_free(load->node);
    gn_free(load->share);
    *load = (gn_fem_load){0};
}

void gn_fem_set_loads(gn_fem_solid *solid, const gn_fem_load *load, const double (*value)[3],
                      size_t count) {
    double *applied = solid->nodes.applied;
    for (size_t l = 0; l < count; l++)
        for (size_t k = 0; k < load[l].count; k++)
            for (size_t a = 0; a < 3; a++) applied[4 * (size_t)load[l].node[k] + a] = 0.0;
    for (size_t l = 0; l < count; l++)
        for (size_t k = 0; k < load[l].count; k++)
            for (size_t a = 0; a < (size_t)solid->dimension; a++)
                applied[4 * (size_t)load[l].node[k] + a] += load[l].share[k] * value[l][a];
}
