/* Rigid bodies as files: snapshots and their group in results.h5 (docs/results.md). */
#include "base/error.h"
#include "base/memory.h"
#include "boundary/surface.h"
#include "io/h5.h"
#include "io/snapshot.h"
#include "run/output_table.h"
#include "run/parts.h"
#include "scene/values.h"
#include "soa/field.h"
#include "world/world.h"

#include <string.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* The data from which fields of bodies, and of their vertices and facets numbered through, are
 * read. */
typedef struct view {
    const gn_world *world;
    double *place;        /* [vertices][3], in the user's coordinates */
    int32_t *vertex_body; /* [vertices] */
    int32_t *facet_body;  /* [facets] */
    int32_t *corner;      /* [facets][corners], vertices of all bodies numbered through */
    size_t vertices, facets, corners;
} view;

static void free_view(view *v) {
    gn_free(v->place);
    gn_free(v->vertex_body);
    gn_free(v->facet_body);
    gn_free(v->corner);
}

static void fill(view *v) {
    const gn_world *w = v->world;
    size_t vertex = 0, facet = 0;
    for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
        const int64_t *shape = w->boundary.body_shape[k];
        size_t end = facet + (size_t)shape[1];
        for (size_t c = v->corners * facet; c < v->corners * end; c++)
            v->corner[c] = (int32_t)vertex + w->boundary.body_corner[c];
        for (; facet < end; facet++) v->facet_body[facet] = (int32_t)k;
        for (end = vertex + (size_t)shape[0]; vertex < end; vertex++) {
            double *place = v->place + 3 * vertex;
            v->vertex_body[vertex] = (int32_t)k;
            gn_rigid_place(&w->boundary.bodies[k], w->boundary.body_vertex + 4 * vertex, place);
            gn_world_point_out(&w->ctx, place, place);
        }
    }
}

static gneiss_status make_view(const gn_world *w, view *v, gneiss_error *error) {
    *v = (view){.world = w,
                .vertices = w->boundary.body_vertex_count,
                .corners = (size_t)w->ctx.scene.dimension};
    v->facets = w->boundary.body_corner_count / v->corners;
    v->place = gn_alloc_array(v->vertices + 1, 3 * sizeof *v->place);
    v->vertex_body = gn_alloc_array(v->vertices + 1, sizeof *v->vertex_body);
    v->facet_body = gn_alloc_array(v->facets + 1, sizeof *v->facet_body);
    v->corner = gn_alloc_array(w->boundary.body_corner_count + 1, sizeof *v->corner);
    if (!v->place || !v->vertex_body || !v->facet_body || !v->corner) {
        free_view(v);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu facets",
                       v->facets);
    }
    fill(v);
    return GNEISS_OK;
}

/* Reads `components` numbers from an expression of the body b. */
#define READ(name, components, from)                                                               \
    static void read_##name(const void *of, size_t k, double *value) {                             \
        const gn_rigid *b = &((const view *)of)->world->boundary.bodies[k];                        \
        memcpy(value, from, components * sizeof *value);                                           \
    }

enum { RESULTS = GN_IN_RESULTS, SNAPSHOT = GN_IN_SNAPSHOT };

/* --- bodies --- */

READ(spin, 3, b->spin)
READ(mass, 1, &b->mass)
READ(inertia, 3, b->inertia)

static void read_position(const void *of, size_t k, double *value) {
    const gn_world *w = ((const view *)of)->world;
    gn_world_point_out(&w->ctx, w->boundary.bodies[k].position, value);
}
static void read_start(const void *of, size_t k, double *value) {
    const gn_world *w = ((const view *)of)->world;
    gn_world_point_out(&w->ctx, w->boundary.bodies[k].start, value);
}
static void read_orientation(const void *of, size_t k, double *value) {
    gn_rigid_orientation(&((const view *)of)->world->boundary.bodies[k], value);
}

/* Fields in addition to those that the history has of bodies (quantities.c). */
static const gn_output_field of_bodies[] = {
    {"position", "m", "reference point; free: centre of mass", RESULTS, GN_F64, false, 3,
     read_position, 0},
    {"start", "m", "reference point at the start", RESULTS, GN_F64, false, 3, read_start, 0},
    {"orientation", "1",
     "unit quaternion w x y z of the rotation from the start, w >= 0: the smaller angle", RESULTS,
     GN_F64, false, 4, read_orientation, 0},
    {"spin", "rad/s", "angular velocity", RESULTS, GN_F64, false, 3, read_spin, 0},
    {"mass", "kg", "0: not free", RESULTS, GN_F64, false, 1, read_mass, 0},
    {"inertia", "kg m2", "about the principal axes; 2D: the third; 0: not free", RESULTS, GN_F64,
     false, 3, read_inertia, 0},
};

/* --- their vertices and facets --- */

static void read_vertex(const void *of, size_t k, double *value) {
    memcpy(value, ((const view *)of)->place + 3 * k, 3 * sizeof *value);
}

/* v + spin x (x - position) */
static void read_vertex_velocity(const void *of, size_t k, double *value) {
    const view *v = of;
    const gn_rigid *b = &v->world->boundary.bodies[v->vertex_body[k]];
    double x[3];
    gn_rigid_place(b, v->world->boundary.body_vertex + 4 * k, x);
    for (int a = 0; a < 3; a++) {
        int p = (a + 1) % 3, q = (a + 2) % 3;
        value[a] = b->velocity[a] + b->spin[p] * (x[q] - b->position[q]) -
                   b->spin[q] * (x[p] - b->position[p]);
    }
}

static void read_facet_body(const void *of, size_t k, double *value) {
    *value = ((const view *)of)->facet_body[k];
}

static const gn_output_field of_vertices[] = {
    {"vertex", "m", "vertices of all bodies", RESULTS, GN_F64, false, 3, read_vertex, 0},
    {"velocity", "m/s", "velocity of a vertex", SNAPSHOT, GN_F64, false, 3, read_vertex_velocity,
     0},
};
static const gn_output_field of_facets[] = {
    {"facet_body", "1", "index of the body of a facet, base 0", RESULTS, GN_F64, false, 1,
     read_facet_body, 0},
    {"body", "1", "index of the body of a facet, base 0", SNAPSHOT, GN_F64, false, 1,
     read_facet_body, 0},
};

_Static_assert(COUNT(of_bodies) <= GN_OUTPUT_FIELDS_MOST, "room for the arrays of a snapshot");
const gn_output_table gn_body_outputs = {"bodies", of_bodies, COUNT(of_bodies)},
                      gn_vertex_outputs = {"bodies", of_vertices, COUNT(of_vertices)},
                      gn_facet_outputs = {"bodies", of_facets, COUNT(of_facets)};

static gn_output_source vertices_of(const view *v) {
    return (gn_output_source){&gn_vertex_outputs, v, 0, v->vertices, NULL, NULL, 0};
}

static gn_output_source facets_of(const view *v) {
    return (gn_output_source){&gn_facet_outputs, v, 0, v->facets, NULL, NULL, 0};
}

/* --- files --- */

static gneiss_status write_snapshot(const view *v, const char *directory, const char *name,
                                    gneiss_error *error) {
    const gn_world *w = v->world;
    const gn_output_source vertices = vertices_of(v), facets = facets_of(v);
    gn_output_arrays points = {0}, cells = {0};
    gneiss_status status = gn_output_arrays_read(&vertices, &points, error);
    if (status == GNEISS_OK) status = gn_output_arrays_read(&facets, &cells, error);
    const gn_snapshot s = {.bad = w->outcome.bad,
                           .time = w->ctx.time,
                           .step = w->ctx.step,
                           .point_count = v->vertices,
                           .points = v->place,
                           .line_count = v->facets,
                           .lines = v->corner,
                           .line_points = v->corners,
                           .point_array_count = points.count,
                           .line_array_count = cells.count,
                           .point_arrays = points.of,
                           .line_arrays = cells.of};
    if (status == GNEISS_OK) status = gn_snapshot_write(directory, name, &s, error);
    gn_output_arrays_free(&points);
    gn_output_arrays_free(&cells);
    return status;
}

gneiss_status gn_bodies_snapshot(const gn_world *w, const char *directory, const char *name,
                                 gneiss_error *error) {
    view v;
    if (!w->ctx.scene.body_count) return GNEISS_OK;
    GN_TRY(make_view(w, &v, error));
    gneiss_status status = write_snapshot(&v, directory, name, error);
    free_view(&v);
    return status;
}

/* Writes the names, one per line. */
static gneiss_status put_names(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    size_t used = 0, size = w->ctx.scene.body_count * (GN_NAME_SIZE + 1) + 1;
    char *names = gn_alloc(size);
    if (!names) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for names of bodies");
    for (size_t k = 0; k < w->ctx.scene.body_count; k++)
        used += (size_t)snprintf(names + used, size - used, "%s%s", k ? "\n" : "",
                                 w->ctx.scene.bodies[k].name);
    gneiss_status status = gn_h5_put_text(file, "bodies/name", names, error);
    gn_free(names);
    return status;
}

static gneiss_status put_view(const view *v, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = v->world;
    const gn_output_source
        bodies = {&gn_body_outputs, v, w->ctx.effects, w->ctx.scene.body_count, NULL, NULL, 0},
        vertices = vertices_of(v), facets = facets_of(v);
    GN_TRY(put_names(w, file, error));
    GN_TRY(gn_output_put(&bodies, file, error));
    GN_TRY(gn_output_put(&vertices, file, error));
    GN_TRY(gn_output_put(&facets, file, error));
    return gn_h5_put(file, "bodies/facet", GN_I32, v->facets, v->corners, 0, v->corner, "1",
                     "rows of vertex", error);
}

gneiss_status gn_bodies_results(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    view v;
    if (!w->ctx.scene.body_count) return GNEISS_OK;
    GN_TRY(make_view(w, &v, error));
    gneiss_status status = put_view(&v, file, error);
    free_view(&v);
    return status;
}
