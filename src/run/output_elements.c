/* Finite elements as files: snapshots and their groups in results.h5 (docs/results.md). */
#include "base/eigen.h"
#include "base/memory.h"
#include "base/point.h"
#include "io/snapshot.h"
#include "sim/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fields in the order of the mesh. */
typedef struct node_fields {
    size_t count;
    int32_t *row; /* [nodes by place] row of the files */
    double *position, *displacement, *velocity, *stress, *pressure, *id;
} node_fields;

typedef struct element_fields {
    size_t count;
    int32_t *node; /* [count][corners] rows of node_fields */
    double *stress, *pressure, *mises, *principal, *material, *ratio;
} element_fields;

typedef struct fields {
    node_fields nodes;
    element_fields elements;
} fields;

static void free_fields(fields *f) {
    void *all[] = {f->nodes.row,         f->nodes.position, f->nodes.displacement,
                   f->nodes.velocity,    f->nodes.stress,   f->nodes.pressure,
                   f->nodes.id,          f->elements.node,  f->elements.stress,
                   f->elements.pressure, f->elements.mises, f->elements.principal,
                   f->elements.material, f->elements.ratio};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) gn_free(all[k]);
}

static bool allocate(const gn_fem_body *b, fields *f) {
    size_t n = b->nodes.soa.count + 1, e = b->elements.soa.count + 1;
    *f = (fields){.nodes.count = n - 1, .elements.count = e - 1};
    f->nodes.row = gn_alloc_array(n, sizeof *f->nodes.row);
    f->elements.node = gn_alloc_array(e, ((size_t)b->dimension + 1) * sizeof *f->elements.node);
    struct {
        double **place;
        size_t rows, components;
    } all[] = {
        {&f->nodes.position, n, 3},     {&f->nodes.displacement, n, 3}, {&f->nodes.velocity, n, 3},
        {&f->nodes.stress, n, 6},       {&f->nodes.pressure, n, 1},     {&f->nodes.id, n, 1},
        {&f->elements.stress, e, 6},    {&f->elements.pressure, e, 1},  {&f->elements.mises, e, 1},
        {&f->elements.principal, e, 3}, {&f->elements.material, e, 1},  {&f->elements.ratio, e, 1}};
    bool held = f->nodes.row && f->elements.node;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        *all[k].place = gn_alloc_array(all[k].rows, all[k].components * sizeof(double));
        held = held && *all[k].place;
    }
    return held;
}

/* --- nodes --- */

typedef struct numbered {
    int32_t id, place;
} numbered;

static int by_id(const void *a, const void *b) {
    const numbered *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

static gneiss_status number_rows(const gn_fem_body *b, int32_t *row, gneiss_error *error) {
    size_t count = b->nodes.soa.count;
    numbered *order = gn_alloc_array(count + 1, sizeof *order);
    if (!order) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to number %zu nodes", count);
    for (size_t n = 0; n < count; n++) order[n] = (numbered){b->nodes.id[n], (int32_t)n};
    qsort(order, count, sizeof *order, by_id);
    for (size_t r = 0; r < count; r++) row[order[r].place] = (int32_t)r;
    gn_free(order);
    return GNEISS_OK;
}

/* Compression positive. */
static double pressure_of(const double s[6]) {
    return -(s[0] + s[1] + s[2]) / 3.0;
}

static void fill_nodes(const gn_fem_body *b, const double (*stress)[6], const double *pressure,
                       node_fields *f) {
    const gn_particles *q = &b->nodes;
    for (size_t n = 0; n < f->count; n++) {
        size_t r = (size_t)f->row[n];
        f->id[r] = q->id[n];
        memcpy(f->stress + 6 * r, stress[n], sizeof *stress);
        f->pressure[r] = -pressure[n];
        for (size_t a = 0; a < 3; a++) {
            f->position[3 * r + a] = gn_point_out(b->origin[a], q->pos[4 * n + a]);
            f->displacement[3 * r + a] = q->pos[4 * n + a] - q->start[4 * n + a];
            f->velocity[3 * r + a] = q->vel[4 * n + a];
        }
    }
}

/* --- elements --- */

/* von Mises (1913). */
static double mises_of(const double s[6]) {
    double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

static void principal_of(const double s[6], double values[3]) {
    double a[9] = {s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]}, vectors[9];
    gn_eigen_symmetric(3, a, values, vectors);
}

static void fill_elements(const gn_fem_body *b, const double (*stress)[6], const int32_t *row,
                          element_fields *f) {
    const gn_elements *q = &b->elements;
    const size_t corners = (size_t)b->dimension + 1;
    for (size_t e = 0; e < f->count; e++) {
        size_t r = (size_t)q->id[e];
        for (size_t a = 0; a < corners; a++)
            f->node[corners * r + a] = row[gn_elements_node(q, (int)a)[e]];
        memcpy(f->stress + 6 * r, stress[e], sizeof *stress);
        f->pressure[r] = pressure_of(stress[e]);
        f->mises[r] = mises_of(stress[e]);
        principal_of(stress[e], f->principal + 3 * r);
        f->material[r] = q->material[e];
        f->ratio[r] = gn_fem_volume_ratio(b, e);
    }
}

static gneiss_status make_fields(const gn_fem_body *b, fields *f, gneiss_error *error) {
    double(*element)[6] = gn_alloc_array(b->elements.soa.count + 1, sizeof *element);
    double(*nodal)[6] = gn_alloc_array(b->nodes.soa.count + 1, sizeof *nodal);
    double *pressure = gn_alloc_array(b->nodes.soa.count + 1, sizeof *pressure);
    gneiss_status status = GNEISS_OK;
    if (!allocate(b, f) || !element || !nodal || !pressure)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu elements",
                         b->elements.soa.count);
    if (status == GNEISS_OK) {
        gn_fem_element_stress(b, element);
        status = gn_fem_nodal_stress(b, (const double(*)[6])element, nodal, error);
    }
    if (status == GNEISS_OK) status = gn_fem_nodal_pressure(b, pressure, error);
    if (status == GNEISS_OK) status = number_rows(b, f->nodes.row, error);
    if (status == GNEISS_OK) {
        fill_nodes(b, (const double(*)[6])nodal, pressure, &f->nodes);
        fill_elements(b, (const double(*)[6])element, f->nodes.row, &f->elements);
    }
    gn_free(element);
    gn_free(nodal);
    gn_free(pressure);
    if (status != GNEISS_OK) free_fields(f);
    return status;
}

/* --- files --- */

const char *gn_elements_path(size_t body, const char *name, char path[GN_ELEMENT_PATH]) {
    if (body)
        snprintf(path, GN_ELEMENT_PATH, "elements_%zu/%s", body + 1, name);
    else
        snprintf(path, GN_ELEMENT_PATH, "%s", name);
    return path;
}

const char *gn_elements_file(size_t body, const char *name, char file[GN_ELEMENT_PATH]) {
    int length = snprintf(file, GN_ELEMENT_PATH, "%s", name);
    if (body) snprintf(file + length, (size_t)(GN_ELEMENT_PATH - length), "_%zu", body + 1);
    return file;
}

static gneiss_status write_snapshot(const gn_world *w, const gn_fem_body *b, const char *directory,
                                    const char *name, gneiss_error *error) {
    fields f;
    GN_TRY(make_fields(b, &f, error));
    const gn_snapshot_array points[] = {
        {"id", "1", 1, f.nodes.id},
        {"displacement", "m", 3, f.nodes.displacement},
        {"velocity", "m/s", 3, f.nodes.velocity},
        {"stress", "Pa", 6, f.nodes.stress},
        {"pressure", "Pa", 1, f.nodes.pressure},
    };
    const gn_snapshot_array cells[] = {
        {"stress", "Pa", 6, f.elements.stress},
        {"von_mises", "Pa", 1, f.elements.mises},
        {"principal_stress", "Pa", 3, f.elements.principal},
        {"pressure", "Pa", 1, f.elements.pressure},
        {"material", "1", 1, f.elements.material},
        {"volume_ratio", "1", 1, f.elements.ratio},
    };
    const gn_snapshot s = {.bad = w->bad,
                           .time = w->time,
                           .step = w->step,
                           .point_count = f.nodes.count,
                           .points = f.nodes.position,
                           .line_count = f.elements.count,
                           .lines = f.elements.node,
                           .line_points = (size_t)b->dimension + 1,
                           .point_array_count = sizeof points / sizeof *points,
                           .line_array_count = sizeof cells / sizeof *cells,
                           .point_arrays = points,
                           .line_arrays = cells};
    gneiss_status status = gn_snapshot_write(directory, name, &s, error);
    free_fields(&f);
    return status;
}

gneiss_status gn_elements_snapshot(const gn_world *w, const char *directory, const char *name,
                                   gneiss_error *error) {
    for (size_t k = 0; k < w->element_count; k++) {
        char file[GN_ELEMENT_PATH];
        GN_TRY(write_snapshot(w, &w->elements[k]->body, directory, gn_elements_file(k, name, file),
                              error));
    }
    return GNEISS_OK;
}

typedef struct data_set {
    const char *name, *unit, *text;
    size_t rows, components;
    const double *data;
} data_set;

static gneiss_status put_fields(size_t body, const fields *f, gn_h5 *file, gneiss_error *error) {
    char path[GN_ELEMENT_PATH];
    const node_fields *n = &f->nodes;
    const element_fields *e = &f->elements;
    const data_set all[] = {
        {"nodes/id", "1", "place in the mesh, base 0", n->count, 1, n->id},
        {"nodes/position", "m", "place", n->count, 3, n->position},
        {"nodes/displacement", "m", "from the start", n->count, 3, n->displacement},
        {"nodes/velocity", "m/s", "velocity", n->count, 3, n->velocity},
        {"nodes/stress", "Pa",
         "xx yy zz xy yz xz, tension positive; mean over the elements at the node by volume",
         n->count, 6, n->stress},
        {"nodes/pressure", "Pa",
         "compression positive; that of the nodes' stress, in the mixed form the node's own",
         n->count, 1, n->pressure},
        {"elements/stress", "Pa", "xx yy zz xy yz xz, tension positive", e->count, 6, e->stress},
        {"elements/von_mises", "Pa", "von Mises' equivalent stress", e->count, 1, e->mises},
        {"elements/principal_stress", "Pa", "principal stresses, the largest first", e->count, 3,
         e->principal},
        {"elements/pressure", "Pa", "compression positive", e->count, 1, e->pressure},
        {"elements/volume_ratio", "1", "volume over that at the start", e->count, 1, e->ratio},
    };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        GN_TRY(gn_h5_put(file, gn_elements_path(body, all[k].name, path), GN_F64, all[k].rows,
                         all[k].components, 0, all[k].data, all[k].unit, all[k].text, error));
    return GNEISS_OK;
}

/* What is numbers of things: materials and nodes. */
static gneiss_status put_numbers(size_t body, const fields *f, const gn_fem_body *b, gn_h5 *file,
                                 gneiss_error *error) {
    const element_fields *e = &f->elements;
    char path[GN_ELEMENT_PATH];
    int32_t *material = gn_alloc_array(e->count + 1, sizeof *material);
    if (!material) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output");
    for (size_t k = 0; k < e->count; k++) material[k] = (int32_t)e->material[k];
    gneiss_status status =
        gn_h5_put(file, gn_elements_path(body, "elements/material", path), GN_I32, e->count, 1, 0,
                  material, "1", "place in elements.materials, base 0", error);
    gn_free(material);
    GN_TRY(status);
    return gn_h5_put(file, gn_elements_path(body, "elements/node", path), GN_I32, e->count,
                     (size_t)b->dimension + 1, 0, e->node, "1", "rows of /nodes, base 0", error);
}

static gneiss_status put_body(size_t body, const gn_fem_body *b, gn_h5 *file, gneiss_error *error) {
    fields f;
    GN_TRY(make_fields(b, &f, error));
    gneiss_status status = put_fields(body, &f, file, error);
    if (status == GNEISS_OK) status = put_numbers(body, &f, b, file, error);
    free_fields(&f);
    return status;
}

static gneiss_status put_motion(const gn_world *w, size_t k, gn_h5 *file, gneiss_error *error) {
    double value[3];
    char path[160];
    const char *name = gn_elements_motion_name(w, k);
    gn_elements_travel(w, k, value);
    snprintf(path, sizeof path, "motions/%s/displacement", name);
    GN_TRY(gn_h5_put(file, path, GN_F64, 3, 1, 0, value, "m", "mean displacement of the nodes",
                     error));
    if (!gn_elements_motion_drives(w, k)) return GNEISS_OK;
    gn_elements_reaction(w, k, value);
    snprintf(path, sizeof path, "motions/%s/reaction", name);
    return gn_h5_put(file, path, GN_F64, 3, 1, 0, value, "N",
                     "force that the prescribed motion supplied in the last step", error);
}

gneiss_status gn_elements_results(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < w->element_count; k++)
        GN_TRY(put_body(k, &w->elements[k]->body, file, error));
    for (size_t k = 0; k < gn_elements_motions(w); k++) GN_TRY(put_motion(w, k, file, error));
    return GNEISS_OK;
}
