/* Removal of elements from a moving solid, and the weights of the remaining elements in coupling
 * zones. */
#include "base/memory.h"
#include "fem/internal.h"
#include "neigh/neigh.h"
#include "soa/single.h"

#include <math.h>
#include <string.h>

static gneiss_status no_memory(const gn_fem_solid *solid, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu elements", solid->name,
                   solid->elements.soa.count);
}

int32_t *gn_fem_places(const gn_fem_solid *solid, size_t *count) {
    gn_mesh mesh = solid->mesh;
    *count = gn_fem_elements_of(&mesh, solid->dimension)->count;
    int32_t *place = gn_alloc_array(*count + 1, sizeof *place);
    for (size_t k = 0; place && k < *count; k++) place[k] = -1;
    for (size_t e = 0; place && e < solid->elements.soa.count; e++)
        place[solid->elements.id[e]] = (int32_t)e;
    return place;
}

static void measure(gn_fem_solid *solid) {
    const gn_elements *q = &solid->elements;
    solid->volume = solid->mass = 0.0;
    for (size_t e = 0; e < q->soa.count; e++) {
        solid->volume += q->volume[e];
        solid->mass += solid->density[q->material[e]] * q->volume[e];
    }
}

gneiss_status gn_fem_elements_changed(gn_fem_solid *solid, gneiss_error *error) {
    measure(solid);
    gn_elements_pad(&solid->elements, &solid->nodes);
    gn_elements_to_single(&solid->elements);
    gn_partials_free(&solid->partials);
    solid->partials = (gn_partials){0};
    GN_TRY(gn_element_partials_build(&solid->elements, solid->nodes.soa.count, solid->threads,
                                     &solid->partials, error));
    gn_free(solid->element_sums);
    solid->element_sums = gn_alloc_array(solid->partials.blocks + 1, sizeof *solid->element_sums);
    if (!solid->element_sums) return no_memory(solid, error);
    const gn_deal_list elements = {.partials = &solid->partials};
    return gn_deal_lists(&solid->deal, &elements, 1, solid->motion_blocks, error);
}

static void lay_to_rest(gn_fem_solid *solid, const uint8_t *used) {
    gn_particles *q = &solid->nodes;
    for (size_t n = 0; n < q->soa.count; n++) {
        if (used[n]) continue;
        memset(q->vel + 4 * n, 0, 4 * sizeof *q->vel);
        q->blend[2 * n] = 0.0;
        if (solid->carried) solid->carried[n] = 0.0;
    }
}

static gneiss_status take_out(gn_fem_solid *solid, const uint8_t *keep, int32_t *order,
                              uint8_t *used, gneiss_error *error) {
    gn_elements now = {0}, *q = &solid->elements;
    size_t kept = 0;
    for (size_t e = 0; e < q->soa.count; e++) {
        if (!keep[e]) continue;
        order[kept++] = (int32_t)e;
        for (int a = 0; a <= solid->dimension; a++) used[gn_elements_node(q, a)[e]] = 1;
    }
    GN_TRY(gn_soa_create(&gn_element_record, &now, kept, q->soa.effects, error));
    gn_soa_permute(&gn_element_record, &now, q, order);
    gn_soa_destroy(&gn_element_record, q);
    *q = now;
    lay_to_rest(solid, used);
    return gn_fem_elements_changed(solid, error);
}

gneiss_status gn_fem_keep(gn_fem_solid *solid, const uint8_t *keep, gneiss_error *error) {
    int32_t *order = gn_alloc_array(solid->elements.soa.count + 1, sizeof *order);
    uint8_t *used = gn_alloc(solid->nodes.soa.count + 1);
    gneiss_status status =
        order && used ? take_out(solid, keep, order, used, error) : no_memory(solid, error);
    gn_free(order);
    gn_free(used);
    return status;
}

/* Returns the full volume of an element, m3, from its gradients, which are those of its edges
 * inverted. */
static double whole_volume(const gn_elements *elements, size_t e, int dimension) {
    double g[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int a = 1; a <= dimension; a++)
        for (int k = 0; k < dimension; k++) g[a - 1][k] = gn_elements_gradient(elements, a, k)[e];
    double det = g[0][0] * (g[1][1] * g[2][2] - g[1][2] * g[2][1]) -
                 g[0][1] * (g[1][0] * g[2][2] - g[1][2] * g[2][0]) +
                 g[0][2] * (g[1][0] * g[2][1] - g[1][1] * g[2][0]);
    return 1.0 / (fabs(det) * (dimension == 3 ? 6.0 : 2.0));
}

void gn_fem_apply_weights(gn_fem_solid *solid) {
    gn_elements *q = &solid->elements;
    gn_particles *nodes = &solid->nodes;
    const int d = solid->dimension;
    for (size_t n = 0; n < nodes->soa.count; n++) {
        double *mass = nodes->vel + 4 * n + 3;
        if (*mass > 0.0) *mass = solid->carried ? solid->carried[n] : 0.0;
    }
    for (size_t e = 0; e < q->soa.count; e++) {
        double part = 0.0;
        for (int a = 0; a <= d; a++)
            part += nodes->blend[2 * (size_t)gn_elements_node(q, a)[e]] / (d + 1);
        if (part < 1.0) q->volume[e] = part * whole_volume(q, e, d);
        const double mass = solid->density[q->material[e]] * q->volume[e];
        for (int a = 0; a <= d; a++)
            nodes->vel[4 * (size_t)gn_elements_node(q, a)[e] + 3] += mass / (d + 1);
    }
    measure(solid);
    for (size_t n = 0; n < nodes->soa.count; n++) {
        double *mass = nodes->vel + 4 * n + 3;
        if (*mass > 0.0) *mass = 1.0 / *mass;
    }
    gn_fem_to_single(solid);
}

static double inverse3(double a[3][3], double out[3][3]) {
    double det = 0.0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            out[c][r] = a[(r + 1) % 3][(c + 1) % 3] * a[(r + 2) % 3][(c + 2) % 3] -
                        a[(r + 1) % 3][(c + 2) % 3] * a[(r + 2) % 3][(c + 1) % 3];
    for (int c = 0; c < 3; c++) det += a[0][c] * out[c][0];
    for (int k = 0; k < 9; k++) out[k / 3][k % 3] /= det;
    return det;
}

/* Computes the polar decomposition by Newton's iteration X <- (X + X^-T)/2, which converges
 * quadratically from F (Higham 1986). */
void gn_fem_rotation(const gn_fem_solid *solid, size_t element, double turn[3][3]) {
    enum { ROUNDS = 40 };
    gn_fem_deformation(solid, element, turn);
    for (int round = 0; round < ROUNDS; round++) {
        double inverse[3][3], change = 0.0;
        inverse3(turn, inverse);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) {
                double next = 0.5 * (turn[r][c] + inverse[c][r]);
                change = fmax(change, fabs(next - turn[r][c]));
                turn[r][c] = next;
            }
        if (change < 1e-15) return;
    }
}
