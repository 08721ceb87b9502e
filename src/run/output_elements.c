/* Finite elements as files: snapshots and their groups in results.h5 (docs/results.md). */
#include "base/eigen.h"
#include "base/new.h"
#include "base/point.h"
#include "run/part_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

const char *gn_output_elements_path(size_t solid, const char *name, char path[GN_ELEMENT_PATH]) {
    if (solid)
        snprintf(path, GN_ELEMENT_PATH, "elements_%zu/%s", solid + 1, name);
    else
        snprintf(path, GN_ELEMENT_PATH, "%s", name);
    return path;
}

const char *gn_output_elements_file(size_t solid, const char *name, char file[GN_ELEMENT_PATH]) {
    int length = snprintf(file, GN_ELEMENT_PATH, "%s", name);
    if (solid) snprintf(file + length, (size_t)(GN_ELEMENT_PATH - length), "_%zu", solid + 1);
    return file;
}

/* The data from which fields are read; rows of the files follow the mesh. */
typedef struct view {
    const gn_fem_solid *solid;
    size_t number;                /* number of the solid */
    char prefix[GN_ELEMENT_PATH]; /* prefix of its groups; "" for the first */
    int32_t *node_row;            /* [nodes] */
    int32_t *element_row;         /* [elements] the remaining ones, in the order of the mesh */
    double (*element)[6];         /* [elements] Pa, stresses */
    double (*nodal)[6];           /* [nodes] Pa */
    double *pressure;             /* [nodes] Pa, tension positive */
} view;

static void free_view(view *shown) {
    gn_free(shown->node_row);
    gn_free(shown->element_row);
    gn_free(shown->element);
    gn_free(shown->nodal);
    gn_free(shown->pressure);
}

typedef struct numbered {
    int32_t id, place;
} numbered;

static int by_id(const void *a, const void *b) {
    const numbered *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

/* Writes the rank of each id. */
static gneiss_status number_rows(const int32_t *id, size_t count, int32_t *row,
                                 gneiss_error *error) {
    GN_FREED numbered *order = NULL;
    GN_TRY(gn_new(&order, count, "nodes or elements", error));
    for (size_t n = 0; n < count; n++) order[n] = (numbered){id[n], (int32_t)n};
    qsort(order, count, sizeof *order, by_id);
    for (size_t r = 0; r < count; r++) row[order[r].place] = (int32_t)r;
    return GNEISS_OK;
}

static gneiss_status find_stresses(view *shown, gneiss_error *error) {
    const gn_fem_solid *b = shown->solid;
    gn_fem_element_stress(b, shown->element);
    GN_TRY(gn_fem_nodal_stress(b, (const double(*)[6])shown->element, shown->nodal, error));
    GN_TRY(gn_fem_nodal_pressure(b, shown->pressure, error));
    GN_TRY(number_rows(b->nodes.id, b->nodes.soa.count, shown->node_row, error));
    return number_rows(b->elements.id, b->elements.soa.count, shown->element_row, error);
}

static gneiss_status make_view(const gn_fem_solid *solid, size_t number, view *shown,
                               gneiss_error *error) {
    size_t nodes = solid->nodes.soa.count + 1, elements = solid->elements.soa.count + 1;
    *shown = (view){.solid = solid, .number = number};
    gn_output_elements_path(number, "", shown->prefix);
    shown->node_row = gn_alloc_array(nodes, sizeof *shown->node_row);
    shown->element_row = gn_alloc_array(elements, sizeof *shown->element_row);
    shown->element = gn_alloc_array(elements, sizeof *shown->element);
    shown->nodal = gn_alloc_array(nodes, sizeof *shown->nodal);
    shown->pressure = gn_alloc_array(nodes, sizeof *shown->pressure);
    gneiss_status status = GNEISS_OK;
    if (!shown->node_row || !shown->element_row || !shown->element || !shown->nodal ||
        !shown->pressure)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu elements",
                         solid->elements.soa.count);
    if (status == GNEISS_OK) status = find_stresses(shown, error);
    if (status != GNEISS_OK) free_view(shown);
    return status;
}

/* Reads a scalar of item k; v is the view, b its solid. */
#define READ(name, expression)                                                                     \
    static void read_##name(const void *of, size_t k, double *value) {                             \
        const view *v = of;                                                                        \
        const gn_fem_solid *b = v->solid;                                                          \
        (void)b;                                                                                   \
        *value = (expression);                                                                     \
    }

enum { BOTH = GN_IN_RESULTS | GN_IN_SNAPSHOT };

/* --- nodes --- */

READ(id, b->nodes.id[k])
READ(nodal_pressure, -v->pressure[k])

static const gn_particles *nodes_of(const void *of) {
    return &((const view *)of)->solid->nodes;
}
static void read_position(const void *of, size_t k, double *value) {
    const gn_fem_solid *b = ((const view *)of)->solid;
    for (size_t a = 0; a < 3; a++) value[a] = gn_point_out(b->origin[a], b->nodes.pos[4 * k + a]);
}
static void read_displacement(const void *of, size_t k, double *value) {
    const gn_particles *q = nodes_of(of);
    for (size_t a = 0; a < 3; a++) value[a] = q->pos[4 * k + a] - q->start[4 * k + a];
}
static void read_velocity(const void *of, size_t k, double *value) {
    memcpy(value, nodes_of(of)->vel + 4 * k, 3 * sizeof *value);
}
static void read_nodal_stress(const void *of, size_t k, double *value) {
    memcpy(value, ((const view *)of)->nodal[k], 6 * sizeof *value);
}

static const gn_output_field of_nodes[] = {
    {"id", "1", "index in the mesh, base 0", BOTH, GN_F64, false, 1, read_id, 0},
    {"position", "m", "place", GN_IN_RESULTS, GN_F64, false, 3, read_position, 0},
    {"displacement", "m", "from the start", BOTH, GN_F64, false, 3, read_displacement, 0},
    {"velocity", "m/s", "velocity", BOTH, GN_F64, false, 3, read_velocity, 0},
    {"stress", "Pa",
     "xx yy zz xy yz xz, tension positive; mean over the elements at the node by volume", BOTH,
     GN_F64, false, 6, read_nodal_stress, 0},
    {"pressure", "Pa",
     "compression positive; pressure of the nodal stress, in the mixed form that of the node", BOTH,
     GN_F64, false, 1, read_nodal_pressure, 0},
};

/* --- elements --- */

/* Returns the pressure, compression positive. */
static double pressure_of(const double s[6]) {
    return -(s[0] + s[1] + s[2]) / 3.0;
}

/* Returns the equivalent stress of von Mises (1913). */
static double mises_of(const double s[6]) {
    double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

READ(von_mises, mises_of(v->element[k]))
READ(pressure, pressure_of(v->element[k]))
READ(material, b->elements.material[k])
READ(volume_ratio, gn_fem_volume_ratio(b, k))

static void read_stress(const void *of, size_t k, double *value) {
    memcpy(value, ((const view *)of)->element[k], 6 * sizeof *value);
}
static void read_principal(const void *of, size_t k, double *value) {
    const double *s = ((const view *)of)->element[k];
    double a[9] = {s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]}, vectors[9];
    gn_eigen_symmetric(3, a, value, vectors);
}

static const gn_output_field of_elements[] = {
    {"stress", "Pa", "xx yy zz xy yz xz, tension positive", BOTH, GN_F64, false, 6, read_stress, 0},
    {"von_mises", "Pa", "von Mises' equivalent stress", BOTH, GN_F64, false, 1, read_von_mises, 0},
    {"principal_stress", "Pa", "principal stresses, the largest first", BOTH, GN_F64, false, 3,
     read_principal, 0},
    {"pressure", "Pa", "compression positive", BOTH, GN_F64, false, 1, read_pressure, 0},
    {"material", "1", "index in elements.materials, base 0", BOTH, GN_I32, false, 1, read_material,
     0},
    {"volume_ratio", "1", "volume over the volume at the start", BOTH, GN_F64, false, 1,
     read_volume_ratio, 0},
};

_Static_assert(COUNT(of_nodes) <= GN_OUTPUT_FIELDS_MOST &&
                   COUNT(of_elements) <= GN_OUTPUT_FIELDS_MOST,
               "room for the arrays of a snapshot");
const gn_output_table gn_node_outputs = {"nodes", of_nodes, COUNT(of_nodes)},
                      gn_element_outputs = {"elements", of_elements, COUNT(of_elements)};

static gn_output_source nodes_source(const view *shown) {
    return (gn_output_source){&gn_node_outputs, shown,         0, shown->solid->nodes.soa.count,
                              shown->node_row,  shown->prefix, 0};
}

static gn_output_source elements_source(const view *shown) {
    return (gn_output_source){
        &gn_element_outputs, shown,         0, shown->solid->elements.soa.count,
        shown->element_row,  shown->prefix, 0};
}

/* --- files --- */

/* Returns the rows of the nodes, [elements][dimension + 1]; NULL: no memory. */
static int32_t *corners_of(const view *shown) {
    const gn_elements *q = &shown->solid->elements;
    const size_t corners = (size_t)shown->solid->dimension + 1;
    int32_t *node = gn_alloc_array(q->soa.count + 1, corners * sizeof *node);
    for (size_t e = 0; node && e < q->soa.count; e++)
        for (size_t a = 0; a < corners; a++)
            node[corners * (size_t)shown->element_row[e] + a] =
                shown->node_row[gn_elements_node(q, (int)a)[e]];
    return node;
}

/* Returns positions in the order of the files; NULL: no memory. */
static double *places_of(const view *shown) {
    double *place = gn_alloc_array(shown->solid->nodes.soa.count + 1, 3 * sizeof *place);
    for (size_t n = 0; place && n < shown->solid->nodes.soa.count; n++)
        read_position(shown, n, place + 3 * (size_t)shown->node_row[n]);
    return place;
}

static gneiss_status write_snapshot(const gn_world *world, const view *shown, const char *directory,
                                    const char *name, gneiss_error *error) {
    const gn_output_source nodes = nodes_source(shown), elements = elements_source(shown);
    GN_FREED_BY(gn_output_arrays_free) gn_output_arrays points = {0}, cells = {0};
    GN_FREED int32_t *corners = corners_of(shown);
    GN_FREED double *places = places_of(shown);
    if (!corners || !places) return gn_no_memory(error, "the output of elements");
    GN_TRY(gn_output_arrays_read(&nodes, &points, error));
    GN_TRY(gn_output_arrays_read(&elements, &cells, error));
    const gn_snapshot s = {.bad = world->outcome.bad,
                           .time = world->ctx.time,
                           .step = world->ctx.step,
                           .point_count = nodes.count,
                           .points = places,
                           .line_count = elements.count,
                           .lines = corners,
                           .line_points = (size_t)shown->solid->dimension + 1,
                           .point_array_count = points.count,
                           .line_array_count = cells.count,
                           .point_arrays = points.of,
                           .line_arrays = cells.of};
    return gn_snapshot_write(directory, name, &s, error);
}

gneiss_status gn_output_elements_snapshot(const gn_world *world, const char *directory,
                                          const char *name, gneiss_error *error) {
    for (size_t k = 0; k < world->solids.count; k++) {
        char file[GN_ELEMENT_PATH];
        view v;
        GN_TRY(make_view(&world->solids.elements[k]->solid, k, &v, error));
        gneiss_status status =
            write_snapshot(world, &v, directory, gn_output_elements_file(k, name, file), error);
        free_view(&v);
        GN_TRY(status);
    }
    return GNEISS_OK;
}

static gneiss_status put_view(const view *shown, gn_h5 *file, gneiss_error *error) {
    const gn_output_source nodes = nodes_source(shown), elements = elements_source(shown);
    char path[GN_ELEMENT_PATH];
    GN_TRY(gn_output_put(&nodes, file, error));
    GN_TRY(gn_output_put(&elements, file, error));
    GN_FREED int32_t *corners = corners_of(shown);
    if (!corners) return gn_no_memory(error, "the output of elements");
    return gn_h5_put(file, gn_output_elements_path(shown->number, "elements/node", path), GN_I32,
                     elements.count, (size_t)shown->solid->dimension + 1, 0, corners, "1",
                     "rows of /nodes, base 0", error);
}

static gneiss_status put_body(size_t number, const gn_fem_solid *solid, gn_h5 *file,
                              gneiss_error *error) {
    view v;
    GN_TRY(make_view(solid, number, &v, error));
    gneiss_status status = put_view(&v, file, error);
    free_view(&v);
    return status;
}

gneiss_status gn_output_elements_read(const gn_world *world, size_t solid, bool nodes,
                                      const gn_output_field *field, double *values,
                                      gneiss_error *error) {
    view v;
    GN_TRY(make_view(&world->solids.elements[solid]->solid, solid, &v, error));
    const gn_output_source source = nodes ? nodes_source(&v) : elements_source(&v);
    gn_output_read(&source, field, values);
    free_view(&v);
    return GNEISS_OK;
}

gneiss_status gn_output_elements_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < world->solids.count; k++)
        GN_TRY(put_body(k, &world->solids.elements[k]->solid, file, error));
    return GNEISS_OK;
}
