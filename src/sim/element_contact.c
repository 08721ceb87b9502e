/* Particles on the surface of a body of finite elements: its facets become a surface of the world,
 * and what particles do to the nodes joins their forces as contacts with walls join those of
 * particles. */
#include "base/memory.h"
#include "sim/parts.h"

#include <math.h>
#include <string.h>

/* A row of force for each node of a facet, in the order of the nodes. */
static gneiss_status make_rows(gn_element_model *q, const gn_facet_set *f, gneiss_error *error) {
    size_t n = q->body.nodes.soa.count, count = 0;
    gn_element_contact *k = &q->contact;
    k->first = gn_alloc_array(n + 2, sizeof *k->first);
    k->force = gn_alloc_array(n + 1, 4 * sizeof *k->force);
    if (!k->first || !k->force)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for contacts of %zu nodes", n);
    for (size_t c = 0; c < (size_t)f->corners * f->count; c++) k->first[f->corner[c] + 1] = 1;
    for (size_t v = 0; v < n; v++) k->first[v + 1] += k->first[v];
    count = (size_t)k->first[n];
    GN_TRY(gn_soa_create(&gn_wall_contact_record, &k->rows, count, 0, error));
    for (size_t v = 0; v < n; v++)
        if (k->first[v + 1] > k->first[v]) k->rows.i[k->first[v]] = (int32_t)v;
    q->body.contacts = &k->rows;
    q->body.contact_first = k->first;
    return GNEISS_OK;
}

gneiss_status gn_element_contact_create(gn_world *w, gneiss_error *error) {
    gn_element_model *q = w->elements;
    if (!q || !w->scene.elements.has_contact || !w->scene.has_specimen) return GNEISS_OK;
    const gn_element_contact_def *def = &w->scene.elements.contact;
    gn_surface *s = &w->boundary.surfaces[w->boundary.surface_count];
    size_t corners = (size_t)w->scene.dimension, count = 0;
    gneiss_status status = gn_fem_surface(&q->body, def->group[0] ? def->group : NULL,
                                          &q->contact.corner, &count, error);
    if (status == GNEISS_ERROR_INPUT) {
        bool named = def->group_where.line > 0;
        gn_scene_place where = named ? def->group_where : w->scene.elements.where;
        gn_fail_context(error, "%s:%d:%d: elements.contact%s: ", w->scene.source, where.line,
                        where.column, def->group[0] ? ".group" : "");
        return status;
    }
    GN_TRY(status);
    s->facets = (gn_facet_set){(int)corners, count, q->contact.corner, q->body.nodes.pos};
    s->velocity = q->body.nodes.vel;
    s->slot = q->body.nodes.slot;
    s->prescribed = &q->body.prescribed;
    s->vertices = q->body.nodes.soa.count;
    s->body = -1;
    s->first = (int32_t)(w->boundary.body_corner_count / corners);
    s->stiffness = def->stiffness;
    s->kratio = def->kratio;
    s->friction = def->friction;
    s->travel = &q->contact.travel;
    s->ref = q->body.nodes.ref;
    GN_TRY(make_rows(q, &s->facets, error));
    s->force = q->contact.force;
    GN_TRY(gn_facet_tree_build(&s->facets, &s->tree, error));
    w->boundary.surface_count++;
    return GNEISS_OK;
}

void gn_element_contact_load(gn_world *w) {
    gn_element_contact *k = &w->elements->contact;
    if (!k->force) return;
    for (size_t c = 0; c < k->rows.soa.count; c++)
        memcpy(k->rows.row + 8 * c, k->force + 4 * (int64_t)k->rows.i[c], 3 * sizeof(double));
}

void gn_element_contact_moved(gn_world *w) {
    gn_element_contact *k = &w->elements->contact;
    const gn_fem_body *b = &w->elements->body;
    double speed2 = 0.0;
    if (!k->force) return;
    for (size_t p = 0; p < b->motion_blocks; p++) speed2 = fmax(speed2, b->motion_sums[p].speed2);
    k->travel += w->dt * sqrt(speed2);
}

void gn_element_contact_free(gn_element_contact *k) {
    gn_soa_destroy(&gn_wall_contact_record, &k->rows);
    gn_free(k->first);
    gn_free(k->force);
    gn_free(k->corner);
    *k = (gn_element_contact){0};
}
