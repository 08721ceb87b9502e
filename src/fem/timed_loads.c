/* Loads that may vary with time. */
#include "base/memory.h"
#include "fem/internal.h"

/* Collects nodes with a weight above zero. */
static gneiss_status collect(const double *weight, size_t nodes, gn_fem_load *load,
                             gneiss_error *error) {
    *load = (gn_fem_load){0};
    for (size_t n = 0; n < nodes; n++) load->count += weight[n] > 0.0;
    load->node = gn_alloc_array(load->count + 1, sizeof *load->node);
    load->share = gn_alloc_array(load->count + 1, sizeof *load->share);
    if (!load->node || !load->share) {
        gn_fem_load_free(load);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a load on %zu nodes", nodes);
    }
    size_t k = 0;
    for (size_t n = 0; n < nodes; n++) {
        if (!(weight[n] > 0.0)) continue;
        load->node[k] = (int32_t)n;
        load->share[k++] = weight[n];
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
    uint8_t *in = gn_alloc_array(list->count + 1, sizeof *in);
    double *area = gn_alloc_array(solid->nodes.soa.count + 1, sizeof *area);
    gneiss_status status = GNEISS_OK;
    *load = (gn_fem_load){0};
    if (!in || !area)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to choose facets");
    else {
        if (found) gn_fem_mark_group(list, found->tag, in);
        for (size_t f = 0; f < list->count; f++) {
            const int32_t *node = list->node + nodes * f;
            if (!(group ? in[f] : starts_in(solid, node, nodes, lower, upper))) continue;
            double part = gn_fem_facet_area(solid, node) / (double)nodes;
            for (size_t k = 0; k < nodes; k++) area[node[k]] += part;
            chosen++;
        }
        status = chosen ? collect(area, solid->nodes.soa.count, load, error)
                        : no_facets(solid, group, lower, upper, error);
    }
    gn_free(in);
    gn_free(area);
    return status;
}

gneiss_status gn_fem_load_on_nodes(const gn_fem_solid *solid, const gn_fem_set *set,
                                   gn_fem_load *load, gneiss_error *error) {
    size_t nodes = solid->nodes.soa.count;
    double *mass = gn_alloc_array(nodes + 1, sizeof *mass);
    *load = (gn_fem_load){0};
    if (!mass) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a load");
    for (size_t k = 0; k < set->count; k++) {
        size_t n = (size_t)set->node[k];
        mass[n] = 1.0 / solid->nodes.vel[4 * n + 3];
    }
    gneiss_status status = collect(mass, nodes, load, error);
    gn_free(mass);
    if (status == GNEISS_OK) gn_fem_load_normalise(load);
    return status;
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
