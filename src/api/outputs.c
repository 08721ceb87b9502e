/* Public API: the fields of every particle, bond, node and element that files contain. */
#include "api/handles.h"

#include "particles/observe.h"
#include "run/output_fields.h"
#include "run/part_files.h"
#include "solids/solids.h"

#include <string.h>

/* The outputs of a record: its fields and its number of items. Without a table there are none. */
typedef struct outputs {
    const gn_output_table *table;
    gn_effects effects;
    unsigned asked;
    size_t count;
} outputs;

static outputs find_outputs(const gn_world *world, gneiss_record record) {
    const gn_fem_solid *solid = world->solids.count ? &world->solids.elements[0]->solid : NULL;
    const bool bonds = world->ctx.effects & GN_FX_BONDS;
    switch (record) {
    case GNEISS_PARTICLES:
        return (outputs){&gn_particle_outputs, world->ctx.effects, world->ctx.scene.asked,
                         world->dem.particles.soa.count};
    case GNEISS_BONDS:
        return (outputs){bonds ? &gn_bond_outputs : NULL, world->ctx.effects,
                         world->ctx.scene.asked, world->dem.bonds.contacts.soa.count};
    case GNEISS_NODES:
        return (outputs){solid ? &gn_node_outputs : NULL, 0, 0, solid ? solid->nodes.soa.count : 0};
    case GNEISS_ELEMENTS:
        return (outputs){solid ? &gn_element_outputs : NULL, 0, 0,
                         solid ? solid->elements.soa.count : 0};
    default:
        return (outputs){0};
    }
}

size_t gneiss_world_output_count(const gneiss_world *world, gneiss_record record) {
    if (!world) return 0;
    const outputs o = find_outputs(&world->run.world, record);
    size_t count = 0;
    while (o.table && gn_output_field_at(o.table, o.effects, o.asked, count)) count++;
    return count;
}

gneiss_status gneiss_world_output_at(const gneiss_world *world, gneiss_record record, size_t index,
                                     gneiss_view *what, gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(what, "what", error));
    const outputs o = find_outputs(&world->run.world, record);
    const gn_output_field *field =
        o.table ? gn_output_field_at(o.table, o.effects, o.asked, index) : NULL;
    if (!field)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument index: expected less than %zu, the outputs of the record, found "
                       "%zu",
                       gneiss_world_output_count(world, record), index);
    *what = (gneiss_view){.name = field->name,
                          .unit = field->unit,
                          .description = field->text,
                          .type = GNEISS_F64,
                          .components = (int32_t)field->components,
                          .count = o.count,
                          .item_stride = field->components * sizeof(double),
                          .component_stride = sizeof(double)};
    return GNEISS_OK;
}

static gneiss_status read_particles_or_bonds(const gn_world *world, bool particles,
                                             const gn_output_field *field, double *values,
                                             gneiss_error *error) {
    gn_observed seen;
    gn_output_view view;
    GN_TRY(gn_dem_observe(&world->ctx, &world->dem, &world->box, &seen, error));
    gneiss_status status = gn_output_view_make(world, &seen, &view, error);
    if (status == GNEISS_OK) {
        const gn_output_source of = particles ? gn_output_particles(&view) : gn_output_bonds(&view);
        gn_output_read(&of, field, values);
        gn_output_view_free(&view);
    }
    gn_observed_free(&seen);
    return status;
}

gneiss_status gneiss_world_output(const gneiss_world *world, gneiss_record record, const char *name,
                                  double *values, size_t count, gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(name, "name", error));
    GN_TRY(gn_api_require(values, "values", error));
    const gn_world *w = &world->run.world;
    const outputs o = find_outputs(w, record);
    const gn_output_field *field = NULL;
    for (size_t k = 0; o.table && (field = gn_output_field_at(o.table, o.effects, o.asked, k)); k++)
        if (strcmp(field->name, name) == 0) break;
    if (!field)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected an output of the record in this scene "
                       "(gneiss_world_output_at), found '%.80s'",
                       name);
    if (count != o.count * field->components)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument count: expected %zu numbers (%zu x %zu of %s), found %zu",
                       o.count * field->components, o.count, field->components, name, count);
    if (record == GNEISS_NODES || record == GNEISS_ELEMENTS)
        return gn_output_elements_read(w, 0, record == GNEISS_NODES, field, values, error);
    return read_particles_or_bonds(w, record == GNEISS_PARTICLES, field, values, error);
}
