/* The part of a checkpoint for finite elements: the mesh, from which the solid is created again,
 * and the state that is copied into it. */
#include "base/memory.h"
#include "mesh/h5_mesh.h"
#include "run/checkpoint_internal.h"
#include "run/part_files.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define DOUBLES(member) GN_PIECE_DOUBLES("", gn_element_model, member)
#define LIMIT(member)   GN_PIECE_ANY("", gn_element_model, member)
#define INTEGER(member) GN_PIECE_INTEGER("", gn_element_model, member)

static const gn_piece pieces[] = {
    INTEGER(solid.step),    DOUBLES(solid.time),         DOUBLES(solid.dt_past),
    DOUBLES(solid.energy),  INTEGER(solid.unused_nodes), INTEGER(solid.turned_elements),
    LIMIT(limit.bound),     LIMIT(limit.sharp),          LIMIT(limit.sharp_low),
    LIMIT(limit.frequency), DOUBLES(stiffening),         LIMIT(stable),
    DOUBLES(stress),        DOUBLES(unbalanced),         DOUBLES(contact.travel),
};
enum { PIECES = sizeof pieces / sizeof *pieces };

_Static_assert(sizeof(gn_fem_energy) % 8 == 0 && sizeof(size_t) == 8, "pieces of eight bytes");

static gneiss_status save_body(size_t solid, const gn_element_model *model, gn_h5 *file,
                               gneiss_error *error) {
    const gn_fem_solid *b = &model->solid;
    char path[GN_ELEMENT_PATH];
    GN_TRY(gn_h5_put_mesh(file, gn_output_elements_path(solid, "mesh", path), &b->mesh, error));
    GN_TRY(gn_h5_put_record(file, gn_output_elements_path(solid, "mesh_nodes", path),
                            &gn_particle_record, &b->nodes, error));
    GN_TRY(gn_h5_put_record(file, gn_output_elements_path(solid, "mesh_elements", path),
                            &gn_element_record, &b->elements, error));
    GN_TRY(gn_h5_put_pieces(file, gn_output_elements_path(solid, "elements", path), pieces, PIECES,
                            model, error));
    int64_t culprits[3] = {model->limit.bound_element, model->limit.sharp_element,
                           model->limit.iterations};
    GN_TRY(gn_h5_put(file, gn_output_elements_path(solid, "elements/culprits", path), GN_I64, 3, 1,
                     0, culprits, NULL, NULL, error));
    return gn_h5_put(file, gn_output_elements_path(solid, "elements/load", path), GN_F64,
                     b->prescribed.count, 6, 0, b->prescribed.load, NULL, NULL, error);
}

gneiss_status gn_checkpoint_put_elements(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < world->solids.count; k++)
        GN_TRY(save_body(k, world->solids.elements[k], file, error));
    return GNEISS_OK;
}

/* --- reading --- */

/* Checks indices that kernels follow without a check; they must be in range even if the file was
 * tampered with. */
static bool indices_are_good(const gn_fem_solid *solid, int32_t materials) {
    const gn_elements *e = &solid->elements;
    bool good = true;
    for (int a = 0; a <= solid->dimension; a++)
        for (size_t k = 0; k < e->soa.count; k++) {
            int32_t node = gn_elements_node(e, a)[k];
            good = good && node >= 0 && (size_t)node < solid->nodes.soa.count;
        }
    const size_t all =
        (solid->dimension == 3 ? &solid->mesh.tetrahedra : &solid->mesh.triangles)->count;
    for (size_t k = 0; k < e->soa.count; k++)
        good = good && e->material[k] >= 0 && e->material[k] < materials && e->id[k] >= 0 &&
               (size_t)e->id[k] < all;
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        good = good && solid->nodes.slot[n] >= -1 &&
               solid->nodes.slot[n] < (int64_t)solid->prescribed.count;
    return good;
}

static gneiss_status check_records(size_t solid, const gn_fem_solid *body, const char *path,
                                   gneiss_error *error) {
    const size_t all =
        (body->dimension == 3 ? &body->mesh.tetrahedra : &body->mesh.triangles)->count;
    char at[GN_ELEMENT_PATH];
    gn_output_elements_path(solid, "mesh_nodes", at);
    GN_TRY(gn_checkpoint_check_record(at, &gn_particle_record, &body->nodes, path, error));
    GN_TRY(gn_checkpoint_check_numbers(at, body->nodes.id, body->nodes.soa.count,
                                       body->mesh.node_count, path, error));
    gn_output_elements_path(solid, "mesh_elements", at);
    GN_TRY(gn_checkpoint_check_record(at, &gn_element_record, &body->elements, path, error));
    return gn_checkpoint_check_numbers(at, body->elements.id, body->elements.soa.count, all, path,
                                       error);
}

/* Replaces the records that were created from the mesh by the saved ones, which have the same
 * counts and order. */
static gneiss_status take_records(size_t solid, gn_fem_solid *body, const gn_h5 *file,
                                  const char *path, gneiss_error *error) {
    gn_particles nodes = {0};
    gn_elements elements = {0};
    char at[GN_ELEMENT_PATH];
    GN_TRY(gn_h5_get_record(file, gn_output_elements_path(solid, "mesh_nodes", at),
                            &gn_particle_record, &nodes, body->effects, error));
    gneiss_status status =
        gn_h5_get_record(file, gn_output_elements_path(solid, "mesh_elements", at),
                         &gn_element_record, &elements, body->effects, error);
    const bool fewer = body->nodes.blend && elements.soa.count < body->elements.soa.count;
    bool same = status == GNEISS_OK && nodes.soa.count == body->nodes.soa.count &&
                (fewer || elements.soa.count == body->elements.soa.count);
    if (!same) {
        gn_soa_destroy(&gn_particle_record, &nodes);
        gn_soa_destroy(&gn_element_record, &elements);
        if (status != GNEISS_OK) return status;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected %zu nodes and %zu elements as in its mesh, found others", path,
                       body->nodes.soa.count, body->elements.soa.count);
    }
    int32_t materials = 0;
    for (size_t k = 0; k < body->elements.soa.count; k++)
        materials =
            body->elements.material[k] < materials ? materials : body->elements.material[k] + 1;
    gn_soa_destroy(&gn_particle_record, &body->nodes);
    gn_soa_destroy(&gn_element_record, &body->elements);
    body->nodes = nodes;
    body->elements = elements;
    gn_particles_set_null(&body->nodes, 1.0);
    gn_elements_pad(&body->elements, &body->nodes);
    gn_fem_to_single(body);
    GN_TRY(check_records(solid, body, path, error));
    if (indices_are_good(body, materials))
        return fewer ? gn_fem_elements_changed(body, error) : GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected nodes below %zu and elements below %zu, found others", path,
                   body->nodes.soa.count, body->elements.soa.count);
}

static gneiss_status load_body(size_t solid, gn_element_model *model, const gn_h5 *file,
                               const char *path, gneiss_error *error) {
    char at[GN_ELEMENT_PATH];
    int64_t culprits[3];
    GN_TRY(take_records(solid, &model->solid, file, path, error));
    GN_TRY(gn_h5_get_pieces(file, gn_output_elements_path(solid, "elements", at), pieces, PIECES,
                            model, error));
    GN_TRY(gn_h5_get(file, gn_output_elements_path(solid, "elements/culprits", at), GN_I64, 3, 1, 0,
                     culprits, error));
    for (int k = 0; k < 3; k++)
        if (culprits[k] < -1 || culprits[k] > INT32_MAX)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: %s: expected whole numbers in [-1, 2^31), found %lld", path, at,
                           (long long)culprits[k]);
    model->limit.bound_element = (int32_t)culprits[0];
    model->limit.sharp_element = (int32_t)culprits[1];
    model->limit.iterations = (int)culprits[2];
    if (!(isfinite(model->solid.time) && isfinite(model->solid.dt_past) && model->solid.step >= 0))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected finite times, found others", path);
    return gn_h5_get(file, gn_output_elements_path(solid, "elements/load", at), GN_F64,
                     model->solid.prescribed.count, 6, 0, model->solid.prescribed.load, error);
}

/* The scene determines the number of solids. */
gneiss_status gn_checkpoint_get_elements(gn_world *world, const gn_h5 *file, const char *path,
                                         gneiss_error *error) {
    gn_mesh mesh = {0};
    if (world->ctx.scene.has_elements) GN_TRY(gn_h5_get_mesh(file, "mesh", &mesh, error));
    GN_TRY(gn_elements_create(&world->ctx, &world->solids, &mesh, error));
    for (size_t k = 0; k < world->solids.count; k++)
        GN_TRY(load_body(k, world->solids.elements[k], file, path, error));
    return GNEISS_OK;
}
