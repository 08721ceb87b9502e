/* With what acceleration elements take the particles along that a conversion frees, just before: a
 * = sum_a N_a f_a/m_a of the forces at their nodes, those of elements and of the particles that the
 * nodes carry, without weight and drag, which are proportional to masses. */
#include "base/error.h"
#include "base/memory.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "couple/ties.h"
#include "fem/solid.h"
#include "soa/records.h"
#include "zones/zones_private.h"

#include <string.h>

typedef struct pull {
    uint8_t *node, *element; /* corners of what leaves; elements there */
    double *force;           /* [nodes][3] N */
} pull;

static void find_nodes(const gn_conversion *c, pull *q) {
    const gn_elements *elements = &gn_coupled_solid(&c->world->solids)->elements;
    const int corners = gn_coupled_solid(&c->world->solids)->dimension + 1;
    for (size_t e = 0; e < elements->soa.count; e++)
        for (int a = 0; a < corners && c->kind[e] == GN_FRONT_LEAVING; a++)
            q->node[gn_elements_node(elements, a)[e]] = 1;
    for (size_t e = 0; e < elements->soa.count; e++)
        for (int a = 0; a < corners; a++)
            q->element[e] |= q->node[gn_elements_node(elements, a)[e]];
}

static void add_elements(const gn_conversion *c, const pull *q) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    double force[4][3];
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        if (!q->element[e]) continue;
        gn_fem_force_of(b, e, force);
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < 3; k++)
                q->force[3 * gn_elements_node(&b->elements, a)[e] + k] += force[a][k];
    }
}

static void hand_to_nodes(const gn_conversion *c, const pull *q, int32_t p, double side,
                          const double force[3]) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const gn_tie tie =
        gn_tie_at(b, gn_home_of(c, (size_t)p), c->world->dem.particles.start + 4 * (size_t)p);
    for (int a = 0; a <= b->dimension; a++)
        for (int k = 0; k < 3; k++) q->force[3 * tie.node[a] + k] += side * tie.shape[a] * force[k];
}

/* Of particles of the zone. */
static void add_contacts(const gn_conversion *c, const pull *q, const gn_contacts *list) {
    for (size_t k = 0; k < list->soa.count; k++) {
        const int32_t end[2] = {list->i[k], list->j[k]};
        bool in[2];
        double n[3], force[3], length;
        for (int m = 0; m < 2; m++)
            in[m] = c->tied[end[m]] && q->element[gn_home_of(c, (size_t)end[m])];
        if (!in[0] && !in[1]) continue;
        gn_contact_held(&c->world->ctx, &c->world->dem, list, k, n, &length, force);
        for (int m = 0; m < 2; m++)
            if (in[m]) hand_to_nodes(c, q, end[m], m ? -1.0 : 1.0, force);
    }
}

static void take_rates(const gn_conversion *c, const pull *q) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    const gn_particles *p = &c->world->dem.particles;
    for (size_t k = 0; k < p->soa.count; k++) {
        if (!c->freed[k]) continue;
        const gn_tie tie = gn_tie_at(b, gn_home_of(c, k), p->start + 4 * k);
        memset(c->rate + 3 * k, 0, 3 * sizeof *c->rate);
        for (int a = 0; a <= b->dimension; a++)
            for (int m = 0; m < 3; m++)
                c->rate[3 * k + (size_t)m] += tie.shape[a] * q->force[3 * tie.node[a] + m] *
                                              b->nodes.vel[4 * (size_t)tie.node[a] + 3];
    }
}

gneiss_status gn_conversion_find_rates(const gn_conversion *c, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(&c->world->solids);
    if (!(c->world->ctx.scene.couple.convert.relax > 0.0)) return GNEISS_OK;
    pull q = {.node = gn_alloc(b->nodes.soa.count + 1),
              .element = gn_alloc(b->elements.soa.count + 1),
              .force = gn_alloc_array(b->nodes.soa.count + 1, 3 * sizeof *q.force)};
    const bool held = q.node && q.element && q.force;
    if (held) {
        find_nodes(c, &q);
        add_elements(c, &q);
        add_contacts(c, &q, &c->world->dem.bonds.contacts);
        add_contacts(c, &q, &c->world->dem.pairs.contacts);
        take_rates(c, &q);
    }
    gn_free(q.node);
    gn_free(q.element);
    gn_free(q.force);
    return held ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to convert elements");
}
