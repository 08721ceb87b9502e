/* Creation of a solid of finite elements from the scene, and its part of a step. */
#include "solids/solids.h"

#include "base/effects.h"
#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/timer.h"
#include "couple/zone.h"
#include "fem/fem.h"
#include "fem/structured.h"
#include "frame/balance.h"
#include "frame/frame.h"
#include "frame/step_change.h"
#include "mesh/joints.h"
#include "mesh/mesh.h"
#include "particles/particles.h"
#include "scene/mesh_def.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/records.h"
#include "solids/dormant_places.h"

#include <math.h>
#include <string.h>

/* --- messages --- */

/* Writes the place in the scene before a message about the mesh; `group`: place of the group that
 * the message is about, NULL: it is about the whole section. */
static gneiss_status at(const gn_step_context *ctx, gn_scene_place where,
                        const gn_scene_place *group, const char *list, size_t index,
                        gneiss_status status, gneiss_error *error) {
    char text[GNEISS_MESSAGE_SIZE], item[64] = "elements";
    if (status != GNEISS_ERROR_INPUT || !error) return status;
    memcpy(text, error->message, sizeof text);
    if (list) snprintf(item, sizeof item, "elements.%s[%zu]%s", list, index, group ? ".group" : "");
    if (group && group->line) where = *group;
    return gn_fail(error, status, "%.400s:%d:%d: %s: %.1400s", ctx->scene.source, where.line,
                   where.column, item, text);
}

/* --- mesh --- */

static gneiss_status make_block(const gn_step_context *ctx, const gn_element_def *e, gn_mesh *mesh,
                                gneiss_error *error) {
    gn_structured s = {.distortion = e->distortion,
                       .seed = ctx->scene.seed,
                       .parallel = e->diagonals == GN_DIAGONALS_PARALLEL};
    for (int k = 0; k < 3; k++) {
        s.lower[k] = e->origin[k];
        s.size[k] = e->size[k];
        s.cells[k] = (int32_t)e->cells[k];
    }
    return e->has_box ? gn_mesh_box(&s, mesh, error) : gn_mesh_rectangle(&s, mesh, error);
}

static gneiss_status make_beam(const gn_beam_def *b, gn_mesh *mesh, gneiss_error *error) {
    gn_structured_beam s = {.lower = {b->origin[0], b->origin[1], b->origin[2]},
                            .length = b->length,
                            .height = b->height,
                            .thickness = b->thickness,
                            .span = b->span > 0.0 ? b->span : b->length,
                            .notch_width = b->notch_width,
                            .notch_depth = b->notch_depth,
                            .cell = b->cell,
                            .notch_cells = b->notch_cells,
                            .growth = b->growth,
                            .parallel = b->diagonals == GN_DIAGONALS_PARALLEL};
    return gn_mesh_beam(&s, mesh, error);
}

static gneiss_status make_mesh(const gn_step_context *ctx, const gn_element_def *e, gn_mesh *mesh,
                               gneiss_error *error) {
    gneiss_status status =
        e->has_beam ? make_beam(&e->beam, mesh, error) : make_block(ctx, e, mesh, error);
    return at(ctx, e->where, NULL, NULL, 0, status, error);
}

/* Checks positions, because files, origins and scales that are each valid may together give some
 * that no key allows. */
static gneiss_status check_places(const gn_step_context *ctx, const gn_element_def *e,
                                  const gn_mesh *mesh, gneiss_error *error) {
    for (size_t n = 0; n < mesh->node_count; n++) {
        const double *x = mesh->node + 3 * n;
        if (fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))) <= GN_PLACE_MOST) continue;
        gneiss_status status =
            gn_fail(error, GNEISS_ERROR_INPUT,
                    "expected coordinates up to %g m, found a node at (%g, %g, %g) m",
                    GN_PLACE_MOST, x[0], x[1], x[2]);
        return at(ctx, e->where, NULL, NULL, 0, status, error);
    }
    return GNEISS_OK;
}

static const char *mesh_name(const gn_element_def *e) {
    const char *slash = strrchr(e->mesh, '/');
    if (slash) return slash + 1;
    return e->mesh[0] ? e->mesh : e->has_beam ? "beam" : e->has_box ? "box" : "rectangle";
}

static gneiss_status check_joints(const gn_step_context *ctx, const gn_element_def *e,
                                  const gn_mesh *mesh, gn_mesh_joints *joints,
                                  gneiss_error *error) {
    const gn_scene_place where = e->mesh_where.line ? e->mesh_where : e->where;
    *joints = (gn_mesh_joints){0};
    if (!e->mesh[0]) return GNEISS_OK;
    gneiss_status status = gn_mesh_check_joints(mesh, (int)ctx->scene.dimension, ctx->scene.origin,
                                                mesh_name(e), joints, error);
    return at(ctx, where, NULL, NULL, 0, status, error);
}

/* --- solid --- */

static gneiss_status check_groups(const gn_step_context *ctx, const gn_element_def *e,
                                  const gn_mesh *mesh, gneiss_error *error) {
    for (size_t k = 0; k < e->material_count; k++) {
        const gn_element_material *m = &e->materials[k];
        if (!m->group[0]) continue;
        gneiss_status status =
            gn_fem_check_group(mesh_name(e), mesh, m->group, (int)ctx->scene.dimension, error);
        GN_TRY(at(ctx, m->where, &m->group_where, "materials", k, status, error));
    }
    return GNEISS_OK;
}

/* Creates the solid and takes over the mesh. */
static gneiss_status make_body(const gn_step_context *ctx, gn_element_model *q, gn_mesh *mesh,
                               gneiss_error *error) {
    const gn_element_def *e = q->def;
    gn_fem_material *materials = gn_alloc_array(e->material_count + 1, sizeof *materials);
    if (!materials) {
        gn_mesh_free(mesh);
        return gn_no_memory(error, "finite elements");
    }
    for (size_t k = 0; k < e->material_count; k++) {
        const gn_element_material *m = &e->materials[k];
        materials[k] =
            (gn_fem_material){m->group[0] ? m->group : NULL, m->young, m->poisson, m->density};
    }
    gn_fem_spec spec = {
        .name = mesh_name(e),
        .dimension = (int)ctx->scene.dimension,
        .form = e->formulation == GN_FORMULATION_PRESSURE ? GN_FEM_PRESSURE : GN_FEM_DISPLACEMENT,
        .single = ctx->effects & GN_FX_MIXED && e->formulation != GN_FORMULATION_PRESSURE,
        .materials = materials,
        .material_count = e->material_count,
        .damping =
            ctx->effects & (GN_FX_VISCOUS | GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT),
        .damping_coefficient = ctx->scene.background_coefficient,
        .threads = ctx->threads,
        .isa = ctx->kernels->name};
    if (ctx->scene.has_couple) {
        spec.share = gn_zones_share;
        spec.share_of = &ctx->scene;
        spec.shrinks = ctx->scene.couple.has_convert;
    }
    memcpy(spec.gravity, ctx->scene.gravity, sizeof spec.gravity);
    memcpy(spec.origin, ctx->scene.origin, sizeof spec.origin);
    gneiss_status status = gn_fem_solid_create(&spec, mesh, &q->solid, error);
    gn_free(materials);
    return at(ctx, e->where, NULL, NULL, 0, status, error);
}

/* --- motions and loads --- */

static gneiss_status nodes_of(const gn_fem_solid *solid, const gn_region *r, gn_fem_set *set,
                              gneiss_error *error) {
    return r->has_box ? gn_fem_nodes_in_box(solid, r->box_min, r->box_max, set, error)
                      : gn_fem_nodes_of_group(solid, r->group, set, error);
}

static const gn_scene_place *group_of(const gn_region *r) {
    return r->has_box ? NULL : &r->group_where;
}

static void velocity_at(const gn_step_context *ctx, const gn_element_motion *m, double time,
                        double velocity[3]) {
    for (int a = 0; a < 3; a++)
        velocity[a] = gn_control_of(ctx, m->name, a) * gn_table_at(&m->motion.velocity[a], time);
}

static gneiss_status make_motion(const gn_step_context *ctx, gn_element_model *q, size_t k,
                                 gneiss_error *error) {
    const gn_element_motion *m = &q->def->motions[k];
    unsigned mask = 0;
    double velocity[3];
    for (int a = 0; a < 3; a++) mask |= m->motion.velocity[a].count ? 1u << a : 0;
    q->motion[k] = -1;
    gneiss_status status = nodes_of(&q->solid, &m->region, &q->motion_set[k], error);
    GN_TRY(at(ctx, m->where, group_of(&m->region), "motions", k, status, error));
    if (!mask) return GNEISS_OK;
    velocity_at(ctx, m, 0.0, velocity);
    return gn_fem_prescribe(&q->solid, &q->motion_set[k], mask, velocity, &q->motion[k], error);
}

/* Makes a load. A force on a group of facets is distributed by area, on other nodes by mass. */
static gneiss_status make_load(gn_element_model *q, size_t k, gneiss_error *error) {
    const gn_element_load *l = &q->def->loads[k];
    const gn_region *r = &l->region;
    int facets = q->solid.dimension - 1;
    bool by_area =
        l->has_traction || (!r->has_box && gn_fem_has_group(&q->solid.mesh, r->group, facets));
    if (by_area) {
        GN_TRY(gn_fem_load_on_facets(&q->solid, r->has_box ? NULL : r->group, r->box_min,
                                     r->box_max, &q->load[k], error));
        if (l->has_force) gn_fem_load_normalise(&q->load[k]);
        return GNEISS_OK;
    }
    gn_fem_set set;
    GN_TRY(nodes_of(&q->solid, r, &set, error));
    gneiss_status status = gn_fem_load_on_nodes(&q->solid, &set, &q->load[k], error);
    gn_fem_set_free(&set);
    return status;
}

static void set_loads(gn_element_model *q, double time) {
    const gn_element_def *e = q->def;
    for (size_t k = 0; k < e->load_count; k++) {
        const gn_table *value = e->loads[k].has_force ? e->loads[k].force : e->loads[k].traction;
        for (int a = 0; a < 3; a++) q->load_value[k][a] = gn_table_at(&value[a], time);
    }
    gn_fem_set_loads(&q->solid, q->load, (const double(*)[3])q->load_value, e->load_count);
}

static bool varies(const gn_table tables[3]) {
    return tables[0].count > 1 || tables[1].count > 1 || tables[2].count > 1;
}

/* Sets the velocities of motions at a time. Constant ones are set once (`all`), unless the test is
 * controlled. */
static void set_velocities(const gn_step_context *ctx, gn_element_model *q, double time, bool all) {
    const gn_element_def *e = q->def;
    for (size_t k = 0; k < e->motion_count; k++) {
        double velocity[3];
        if (q->motion[k] < 0 ||
            !(all || ctx->scene.test.has_control || varies(e->motions[k].motion.velocity)))
            continue;
        velocity_at(ctx, &e->motions[k], time, velocity);
        gn_fem_set_velocity(&q->solid, q->motion[k], velocity);
    }
}

static void look_at_loads(gn_element_model *q) {
    q->loads_vary = false;
    for (size_t k = 0; k < q->def->load_count; k++) {
        const gn_element_load *l = &q->def->loads[k];
        q->loads_vary = q->loads_vary || varies(l->has_force ? l->force : l->traction);
    }
}

static gneiss_status make_drives(const gn_step_context *ctx, gn_element_model *q,
                                 gneiss_error *error) {
    const gn_element_def *e = q->def;
    q->motion_set = gn_alloc_array(e->motion_count + 1, sizeof *q->motion_set);
    q->motion = gn_alloc_array(e->motion_count + 1, sizeof *q->motion);
    q->load = gn_alloc_array(e->load_count + 1, sizeof *q->load);
    q->load_value = gn_alloc_array(e->load_count + 1, sizeof *q->load_value);
    if (!q->motion_set || !q->motion || !q->load || !q->load_value)
        return gn_no_memory(error, "finite elements");
    for (size_t k = 0; k < e->motion_count; k++) GN_TRY(make_motion(ctx, q, k, error));
    for (size_t k = 0; k < e->load_count; k++) {
        const gn_element_load *l = &e->loads[k];
        gneiss_status status = make_load(q, k, error);
        GN_TRY(at(ctx, l->where, group_of(&l->region), "loads", k, status, error));
    }
    look_at_loads(q);
    set_loads(q, 0.0);
    return GNEISS_OK;
}

/* --- create, free --- */

/* Appends an empty solid to the solids of the world. */
static gn_element_model *append(gn_solids *solids) {
    gn_element_model **all = gn_alloc_array(solids->count + 1, sizeof *all);
    gn_element_model *q = gn_alloc_array(1, sizeof *q);
    if (!all || !q) {
        gn_free(all);
        gn_free(q);
        return NULL;
    }
    for (size_t k = 0; k < solids->count; k++) all[k] = solids->elements[k];
    gn_free(solids->elements);
    solids->elements = all;
    return solids->elements[solids->count++] = q;
}

gneiss_status gn_elements_add(const gn_step_context *ctx, gn_solids *solids,
                              const gn_element_def *def, gn_mesh *mesh, gneiss_error *error) {
    gn_mesh own = {0};
    gn_mesh_joints joints = {0};
    gn_element_model *q = NULL;
    if (mesh) {
        own = *mesh;
        *mesh = (gn_mesh){0};
    }
    gneiss_status status = mesh ? GNEISS_OK : make_mesh(ctx, def, &own, error);
    if (status == GNEISS_OK) status = check_places(ctx, def, &own, error);
    if (status == GNEISS_OK) status = check_groups(ctx, def, &own, error);
    if (status == GNEISS_OK) status = check_joints(ctx, def, &own, &joints, error);
    if (status == GNEISS_OK && !(q = append(solids)))
        status = gn_no_memory(error, "finite elements");
    if (status != GNEISS_OK) {
        gn_mesh_free(&own);
        return status;
    }
    q->def = def;
    q->stiffening = 1.0;
    q->joints = joints;
    GN_TRY(make_body(ctx, q, &own, error));
    q->weight = gn_alloc_array(q->solid.nodes.soa.count + 1, sizeof *q->weight);
    if (!q->weight) return gn_no_memory(error, "finite elements");
    gn_fem_strain_weights(&q->solid, q->weight);
    return make_drives(ctx, q, error);
}

gneiss_status gn_elements_create(const gn_step_context *ctx, gn_solids *solids, gn_mesh *mesh,
                                 gneiss_error *error) {
    return ctx->scene.has_elements ? gn_elements_add(ctx, solids, &ctx->scene.elements, mesh, error)
                                   : GNEISS_OK;
}

gneiss_status gn_elements_set_gravity(const gn_step_context *ctx, gn_solids *solids,
                                      gneiss_error *error) {
    const gn_effects damping =
        ctx->effects & (GN_FX_VISCOUS | GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT);
    for (size_t k = 0; k < solids->count; k++)
        GN_TRY(gn_fem_set_environment(&solids->elements[k]->solid, ctx->scene.gravity, damping,
                                      ctx->scene.background_coefficient, error));
    return GNEISS_OK;
}

gneiss_status gn_elements_enter(const gn_step_context *ctx, gn_solids *solids,
                                gneiss_error *error) {
    GN_TRY(gn_elements_set_gravity(ctx, solids, error));
    for (size_t k = 0; k < solids->count; k++) {
        gn_element_model *q = solids->elements[k];
        look_at_loads(q);
        set_loads(q, ctx->time);
        set_velocities(ctx, q, ctx->time, true);
    }
    return GNEISS_OK;
}

static void free_model(gn_element_model *q) {
    for (size_t k = 0; q->motion_set && k < q->def->motion_count; k++)
        gn_fem_set_free(&q->motion_set[k]);
    for (size_t k = 0; q->load && k < q->def->load_count; k++) gn_fem_load_free(&q->load[k]);
    void *blocks[] = {q->motion_set, q->motion, q->load, q->load_value, q->weight, q->vel_past};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    gn_element_contact_free(&q->contact);
    gn_fem_solid_free(&q->solid);
    gn_free(q);
}

void gn_elements_free(gn_solids *solids) {
    for (size_t k = 0; k < solids->count; k++) free_model(solids->elements[k]);
    gn_free(solids->elements);
    solids->elements = NULL;
    solids->count = 0;
}

uint64_t gn_elements_hash(const gn_solids *solids, uint64_t h) {
    for (size_t k = 0; k < solids->count; k++) {
        uint64_t solid = gn_fem_hash(&solids->elements[k]->solid);
        h = gn_hash_bytes(&solid, sizeof solid, h);
    }
    return h;
}

size_t gn_elements_bytes(const gn_solids *solids) {
    size_t bytes = 0;
    for (size_t k = 0; k < solids->count; k++) bytes += gn_fem_bytes(&solids->elements[k]->solid);
    return bytes;
}

gn_element_totals gn_elements_totals(const gn_solids *solids) {
    gn_element_totals t = {0};
    for (size_t k = 0; k < solids->count; k++) {
        const gn_fem_solid *b = &solids->elements[k]->solid;
        t.nodes += b->nodes.soa.count;
        t.elements += b->elements.soa.count;
        t.mass += b->mass;
        t.volume += b->volume;
    }
    return t;
}

/* --- step --- */

/* Computes forces after the step; stresses are those at its end. */
static gneiss_status measure_forces(gn_element_model *q, gneiss_error *error) {
    const gn_fem_solid *b = &q->solid;
    double(*stress)[6] = gn_alloc_array(b->elements.soa.count + 1, sizeof *stress);
    if (!stress) return gn_no_memory(error, "finite elements");
    gn_fem_element_stress(b, stress);
    double force = gn_fem_mean_force(b, (const double(*)[6])stress), resultant = 0.0;
    gn_free(stress);
    for (size_t k = 0; k < b->motion_blocks; k++) resultant += b->motion_sums[k].resultant;
    size_t nodes = b->nodes.soa.count - b->prescribed.count;
    q->unbalanced = force > 0.0 && nodes ? resultant / (double)nodes / force : 0.0;
    q->carries = force > 0.0;
    q->falls = nodes && !q->carries && resultant > 0.0;
    return GNEISS_OK;
}

void gn_elements_forces(const gn_step_context *ctx, gn_solids *solids, double *seconds,
                        bool measure) {
    for (size_t k = 0; k < solids->count; k++) {
        gn_element_model *q = solids->elements[k];
        double start = gn_now();
        set_velocities(ctx, q, ctx->time + 0.5 * ctx->dt, false);
        if (q->loads_vary) set_loads(q, ctx->time);
        gn_element_contact_load(q);
        if (ctx->dt_past > 0.0 && ctx->dt != ctx->dt_past && ctx->effects & GN_FX_ENERGY)
            q->vel_past = gn_rows_copy(&q->solid.nodes, q->solid.nodes.vel);
        gn_fem_forces(&q->solid, ctx->dt, measure);
        seconds[GN_PHASE_elements] += gn_now() - start;
    }
}

static gneiss_status move_body(gn_element_model *q, double dt, bool measure, gneiss_error *error) {
    gneiss_status status = gn_fem_move(&q->solid, dt, error);
    gn_element_contact_moved(q, dt);
    if (status != GNEISS_OK || !measure) return status;
    const double volume = q->solid.elastic.volume; /* 0: all elements were converted */
    for (int k = 0; k < 9; k++)
        q->stress[k] = volume > 0.0 ? q->solid.elastic.stress[k] / volume : 0.0;
    return measure_forces(q, error);
}

/* Adds the energy of a change of the step (frame/step_change.h). In a measured step the reading has
 * been taken before. */
static void book_change(const gn_step_context *ctx, gn_ledger *ledger, gn_element_model *q,
                        bool measure) {
    double halves[2] = {0.0, 0.0};
    if (!q->vel_past) return;
    gn_rows_add_step_change(ctx, q->vel_past, q->solid.nodes.vel, q->solid.nodes.soa.count, halves);
    if (measure) ledger->reading.step_change += halves[GN_HALF_BEFORE];
    ledger->energy.step_change += halves[GN_HALF_BEFORE] + halves[GN_HALF_AFTER];
    gn_free(q->vel_past);
    q->vel_past = NULL;
}

gneiss_status gn_elements_move(const gn_step_context *ctx, gn_solids *solids, gn_ledger *ledger,
                               double *seconds, bool measure, gneiss_error *error) {
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; status == GNEISS_OK && k < solids->count; k++) {
        double start = gn_now();
        status = move_body(solids->elements[k], ctx->dt, measure, error);
        book_change(ctx, ledger, solids->elements[k], measure);
        seconds[GN_PHASE_elements] += gn_now() - start;
    }
    return status;
}

void gn_elements_book(const gn_solids *solids, gn_energy *ledger) {
    for (size_t k = 0; k < solids->count; k++) {
        const gn_fem_energy *e = &solids->elements[k]->solid.reading;
        ledger->kinetic += e->kinetic;
        ledger->elastic_elements += e->elastic;
        ledger->work_prescribed += e->work_prescribed;
        ledger->work_applied += e->work_applied;
        ledger->work_gravity += e->work_gravity;
        ledger->background_damping += e->damping;
        ledger->stored_at_start += e->stored_at_start;
    }
}

/* --- readings --- */

/* Returns the weight of a solid in averages, by volume; 0 if all elements were converted. */
static double share_of(const gn_solids *solids, size_t k) {
    const double all = gn_elements_totals(solids).volume;
    return all > 0.0 ? solids->elements[k]->solid.volume / all : 0.0;
}

void gn_elements_stress(const gn_solids *solids, double stress[9]) {
    memset(stress, 0, 9 * sizeof *stress);
    for (size_t k = 0; k < solids->count; k++)
        for (int c = 0; c < 9; c++)
            stress[c] += share_of(solids, k) * solids->elements[k]->stress[c];
}

void gn_elements_strain(const gn_solids *solids, double gradient[9]) {
    memset(gradient, 0, 9 * sizeof *gradient);
    for (size_t k = 0; k < solids->count; k++) {
        const gn_element_model *q = solids->elements[k];
        double own[9];
        gn_fem_mean_gradient(&q->solid, (const double(*)[3])q->weight, own);
        for (int c = 0; c < 9; c++) gradient[c] += share_of(solids, k) * own[c];
    }
}

void gn_elements_balance(const gn_solids *solids, gn_balance *balance) {
    for (size_t k = 0; k < solids->count; k++) {
        balance->ratio = fmax(balance->ratio, solids->elements[k]->unbalanced);
        balance->carries |= solids->elements[k]->carries;
        balance->falls |= solids->elements[k]->falls;
    }
}

void gn_elements_extent(const gn_solids *solids, double lower[3], double upper[3]) {
    for (size_t k = 0; k < solids->count; k++) {
        const gn_particles *nodes = &solids->elements[k]->solid.nodes;
        for (size_t n = 0; n < 4 * nodes->soa.count; n += 4)
            for (size_t a = 0; a < 3; a++) {
                lower[a] = fmin(lower[a], nodes->start[n + a]);
                upper[a] = fmax(upper[a], nodes->start[n + a]);
            }
    }
}

void gn_elements_sides(const gn_solids *solids, double side[3]) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    gn_elements_extent(solids, lower, upper);
    for (int a = 0; a < 3; a++) side[a] = upper[a] - lower[a];
}

double gn_elements_longest_side(const gn_step_context *ctx, const gn_solids *solids) {
    double side[3], most = 0.0;
    gn_elements_sides(solids, side);
    for (int a = 0; a < (int)ctx->scene.dimension; a++) most = fmax(most, side[a]);
    return most;
}

/* --- motions --- */

size_t gn_elements_motions(const gn_solids *solids) {
    size_t count = 0;
    for (size_t k = 0; k < solids->count; k++) count += solids->elements[k]->def->motion_count;
    return count;
}

/* Finds the solid of a motion; *motion becomes its index in that solid. */
static const gn_element_model *owner_of(const gn_solids *solids, size_t *motion) {
    size_t k = 0;
    for (; *motion >= solids->elements[k]->def->motion_count; k++)
        *motion -= solids->elements[k]->def->motion_count;
    return solids->elements[k];
}

const char *gn_elements_motion_name(const gn_solids *solids, size_t motion) {
    const gn_element_model *q = owner_of(solids, &motion);
    return q->def->motions[motion].name;
}

bool gn_elements_motion_drives(const gn_solids *solids, size_t motion) {
    const gn_element_model *q = owner_of(solids, &motion);
    return q->motion[motion] >= 0;
}

const gn_fem_set *gn_elements_motion_set(const gn_solids *solids, size_t motion,
                                         const gn_particles **nodes) {
    const gn_element_model *owner = owner_of(solids, &motion);
    *nodes = &owner->solid.nodes;
    return &owner->motion_set[motion];
}

void gn_elements_travel(const gn_solids *solids, size_t motion, double travel[3]) {
    const gn_element_model *owner = owner_of(solids, &motion);
    const gn_fem_set *set = &owner->motion_set[motion];
    const gn_particles *q = &owner->solid.nodes;
    memset(travel, 0, 3 * sizeof *travel);
    for (size_t k = 0; k < set->count; k++)
        for (size_t a = 0; a < 3; a++) {
            size_t n = 4 * (size_t)set->node[k] + a;
            travel[a] += (q->pos[n] - q->start[n]) / (double)set->count;
        }
}

void gn_elements_reaction(const gn_solids *solids, size_t motion, double force[3]) {
    const gn_element_model *q = owner_of(solids, &motion);
    memset(force, 0, 3 * sizeof *force);
    if (q->motion[motion] >= 0) gn_fem_reaction(&q->solid, q->motion[motion], force);
}

/* --- stability --- */

static gneiss_status full_limit(const gn_step_context *ctx, gn_element_model *q,
                                gneiss_error *error) {
    GN_TRY(gn_fem_bound(&q->solid, &q->limit, error));
    bool settled = ctx->scene.estimate == GN_STEP_BOUND ||
                   (ctx->scene.step > 0.0 && ctx->scene.step <= 0.5 * q->limit.bound);
    if (!settled) return gn_fem_limits(&q->solid, 1e-3, &q->limit, error);
    q->limit.sharp = q->limit.sharp_low = q->limit.bound;
    q->limit.sharp_element = q->limit.bound_element;
    return GNEISS_OK;
}

/* Stores the parts of the bound, so that the first conversion need not evaluate all elements. */
static gneiss_status know_bound(gn_element_model *q, gneiss_error *error) {
    gn_fem_limit same = q->limit;
    return gn_fem_bound_update(&q->solid, &same, error);
}

static gneiss_status body_limit(const gn_step_context *ctx, const gn_solids *solids,
                                gn_element_model *q, bool full, bool *due, gneiss_error *error) {
    const double factor = ctx->step > 0 ? gn_fem_stiffening(&q->solid) : 1.0;
    bool changed = full || factor > 1.02 * q->stiffening;
    /* The remaining elements of a converted solid are checked against the bound, also in later
     * stages. */
    const bool begun = full && gn_converts(ctx) && gn_elements_have_left(solids);
    if (begun) GN_TRY(gn_elements_converted(q, error));
    if (full && !begun) GN_TRY(full_limit(ctx, q, error));
    if (full && gn_converts(ctx)) GN_TRY(know_bound(q, error));
    if (!changed) return GNEISS_OK;
    *due = true;
    q->stiffening = factor;
    q->stable = (ctx->scene.estimate == GN_STEP_BOUND ? q->limit.bound : q->limit.sharp) / factor;
    return GNEISS_OK;
}

gneiss_status gn_elements_limit(const gn_step_context *ctx, gn_solids *solids, bool full, bool *due,
                                gneiss_error *error) {
    *due = false;
    for (size_t k = 0; k < solids->count; k++)
        GN_TRY(body_limit(ctx, solids, solids->elements[k], full, due, error));
    return GNEISS_OK;
}

gneiss_status gn_elements_converted(gn_element_model *q, gneiss_error *error) {
    GN_TRY(gn_fem_bound_update(&q->solid, &q->limit, error));
    q->limit.sharp = q->limit.sharp_low = q->limit.bound;
    q->limit.sharp_element = q->limit.bound_element;
    q->stiffening = 0.0; /* the next check finds which bodies have to be evaluated */
    return GNEISS_OK;
}

static void mark(const int32_t *node, size_t count, uint8_t as, uint8_t *driven) {
    for (size_t n = 0; n < count; n++)
        if (driven[node[n]] < as) driven[node[n]] = as;
}

void gn_elements_driven(const gn_element_model *q, uint8_t *driven) {
    for (size_t k = 0; k < q->def->motion_count; k++)
        mark(q->motion_set[k].node, q->motion_set[k].count,
             q->motion[k] < 0 ? GN_NODE_WATCHED : GN_NODE_DRIVEN, driven);
    for (size_t k = 0; k < q->def->load_count; k++)
        mark(q->load[k].node, q->load[k].count, GN_NODE_DRIVEN, driven);
}

double gn_elements_stable(const gn_solids *solids) {
    double limit = INFINITY;
    for (size_t k = 0; k < solids->count; k++) limit = fmin(limit, solids->elements[k]->stable);
    return limit;
}

/* Writes the id of the element and its position at the start. */
const char *gn_elements_culprit(const gn_step_context *ctx, const gn_element_model *q, char *text,
                                size_t size) {
    const gn_fem_solid *b = &q->solid;
    int32_t id =
        ctx->scene.estimate == GN_STEP_BOUND ? q->limit.bound_element : q->limit.sharp_element;
    double centre[3] = {0.0};
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        if (b->elements.id[e] != id) continue;
        for (int a = 0; a <= b->dimension; a++)
            for (size_t k = 0; k < 3; k++)
                centre[k] += b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e] + k] /
                             (b->dimension + 1);
    }
    char at[GN_POINT_SIZE];
    snprintf(text, size, "element %d at %s m", id, gn_point_text(b->origin, centre, at));
    return text;
}
