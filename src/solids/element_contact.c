/* Contacts of particles with the surface of a solid of finite elements. Its facets become a surface
 * of the world, and the forces of particles on nodes are added to the loads of nodes, as wall
 * forces are added to those of particles. */
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/records.h"
#include "solids/element_bodies.h"
#include "solids/solids.h"
#include "surfaces/facet.h"

#include <math.h>
#include <string.h>

/* Makes a row of force for each node of a facet, in the order of the nodes. */
static gneiss_status make_rows(gn_element_model *q, const gn_facet_set *f, gneiss_error *error) {
    size_t n = q->solid.nodes.soa.count, count = 0;
    gn_element_contact *k = &q->contact;
    GN_TRY(gn_new(&k->first, n + 2, "contacts of nodes", error));
    for (size_t c = 0; c < (size_t)f->corners * f->count; c++) k->first[f->corner[c] + 1] = 1;
    for (size_t v = 0; v < n; v++) k->first[v + 1] += k->first[v];
    count = (size_t)k->first[n];
    GN_TRY(gn_soa_create(&gn_wall_contact_record, &k->rows, count, 0, error));
    for (size_t v = 0; v < n; v++)
        if (k->first[v + 1] > k->first[v]) k->rows.i[k->first[v]] = (int32_t)v;
    q->solid.contacts = &k->rows;
    q->solid.contact_first = k->first;
    return GNEISS_OK;
}

/* Returns the mean size of facets at the start, m: their length, for triangles the side of a square
 * of twice the area. */
static double facet_size(const gn_fem_solid *b, const gn_facet_set *f) {
    double sum = 0.0;
    for (size_t k = 0; k < f->count; k++) {
        const int32_t *corner = f->corner + (size_t)f->corners * k;
        double side[2][3] = {{0}}, normal[3];
        for (int c = 1; c < f->corners; c++)
            for (int a = 0; a < 3; a++)
                side[c - 1][a] = b->nodes.start[4 * (int64_t)corner[c] + a] -
                                 b->nodes.start[4 * (int64_t)corner[0] + a];
        gn_cross3(side[0], side[1], normal);
        sum += sqrt(f->corners == 3 ? sqrt(gn_dot3(normal, normal)) : gn_dot3(side[0], side[0]));
    }
    return f->count ? sum / (double)f->count : 0.0;
}

/* Stores the positions of nodes when the lists are made. */
static void refer(gn_element_model *q) {
    gn_particles *nodes = &q->solid.nodes;
    q->contact.travel = 0.0;
    memcpy(nodes->ref, nodes->pos, nodes->soa.count * 4 * sizeof *nodes->ref);
}

/* Returns a bound on the path of any node since the lists were made, m; `exact`: from the present
 * positions. */
static double travel(gn_element_model *q, bool exact) {
    const gn_particles *nodes = &q->solid.nodes;
    double most = 0.0;
    if (!exact) return q->contact.travel;
    for (size_t v = 0; v < nodes->soa.count; v++) {
        double d2 = 0.0;
        for (size_t a = 4 * v; a < 4 * v + 3; a++)
            d2 += (nodes->pos[a] - nodes->ref[a]) * (nodes->pos[a] - nodes->ref[a]);
        most = fmax(most, d2);
    }
    return q->contact.travel = sqrt(most);
}

static const gn_deforming_body deforming = {
    .refer = refer, .travel = travel, .inverse_mass = gn_element_body_inverse_mass};

static gneiss_status make_surface(const gn_step_context *ctx, gn_boundary *boundary,
                                  gn_element_model *q, gneiss_error *error) {
    const gn_element_contact_def *def = &q->def->contact;
    gn_surface s = {.body = -1,
                    .elements = q,
                    .deforming = &deforming,
                    .velocity = q->solid.nodes.vel,
                    .slot = q->solid.nodes.slot,
                    .prescribed = &q->solid.prescribed,
                    .vertices = q->solid.nodes.soa.count,
                    .stiffness = def->stiffness,
                    .kratio = def->kratio,
                    .friction = def->friction};
    size_t count = 0;
    gneiss_status status = gn_fem_surface(&q->solid, def->group[0] ? def->group : NULL,
                                          &q->contact.corner, &count, error);
    if (status == GNEISS_ERROR_INPUT) {
        bool named = def->group_where.line > 0;
        gn_scene_place where = named ? def->group_where : q->def->where;
        const char *key = def->group[0] ? "elements.contact.group" : "elements.contact";
        gn_fail_context(error, "%s: ", gn_scene_at(&ctx->scene, where, key).text);
        return status;
    }
    GN_TRY(status);
    s.facets = (gn_facet_set){q->solid.dimension, count, q->contact.corner, q->solid.nodes.pos};
    s.facet_size = facet_size(&q->solid, &s.facets);
    GN_TRY(make_rows(q, &s.facets, error));
    GN_TRY(gn_element_bodies_find(q, error));
    GN_TRY(gn_boundary_add_surface(boundary, &s, error));
    q->contact.force = boundary->surfaces[boundary->surface_count - 1].force;
    return GNEISS_OK;
}

gneiss_status gn_element_contact_create(const gn_step_context *ctx, gn_boundary *boundary,
                                        gn_solids *solids, gneiss_error *error) {
    for (size_t k = 0; ctx->scene.has_specimen && k < solids->count; k++)
        if (solids->elements[k]->def->has_contact)
            GN_TRY(make_surface(ctx, boundary, solids->elements[k], error));
    return GNEISS_OK;
}

void gn_element_contact_load(gn_element_model *q) {
    gn_element_contact *k = &q->contact;
    if (!k->force) return;
    for (size_t c = 0; c < k->rows.soa.count; c++)
        memcpy(k->rows.row + 8 * c, k->force + 4 * (int64_t)k->rows.i[c], 3 * sizeof(double));
}

double gn_element_contact_speed(const gn_element_model *q) {
    const gn_fem_solid *b = &q->solid;
    double speed2 = 0.0;
    for (size_t k = 0; q->contact.force && k < b->motion_blocks; k++)
        speed2 = fmax(speed2, b->motion_sums[k].speed2);
    return sqrt(speed2);
}

void gn_element_contact_moved(gn_element_model *q, double dt) {
    q->contact.travel += dt * gn_element_contact_speed(q);
}

void gn_element_contact_free(gn_element_contact *k) {
    gn_soa_destroy(&gn_wall_contact_record, &k->rows);
    gn_free(k->first);
    gn_free(k->corner);
    gn_free(k->body);
    gn_free(k->bodies);
    *k = (gn_element_contact){0};
}
