/* Rigid bodies as files: snapshots and their group in results.h5 (docs/results.md). */
#include "inflow/sources.h"
#include "run/output_table.h"

#include "base/error.h"
#include "base/new.h"
#include "io/io.h"
#include "io/listing.h"
#include "io/snapshot.h"
#include "run/part_files.h"
#include "run/quantities.h"
#include "run/run.h"
#include "scene/values.h"
#include "soa/field.h"
#include "world/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* The data from which fields of bodies are read, and those of their vertices and facets, which are
 * numbered through all bodies. */
typedef struct view {
    const gn_world *world;
    double *place;        /* [vertices][3], in the user's coordinates */
    int32_t *vertex_body; /* [vertices] */
    int32_t *facet_body;  /* [facets] */
    int32_t *corner;      /* [facets][corners], vertices of all bodies numbered consecutively */
    size_t vertices, facets, corners;
} view;

static void free_view(view *shown) {
    gn_free(shown->place);
    gn_free(shown->vertex_body);
    gn_free(shown->facet_body);
    gn_free(shown->corner);
}

static void fill(view *shown) {
    const gn_world *w = shown->world;
    size_t vertex = 0, facet = 0;
    for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
        const int64_t *shape = w->boundary.body_shape[k];
        size_t end = facet + (size_t)shape[1];
        for (size_t c = shown->corners * facet; c < shown->corners * end; c++)
            shown->corner[c] = (int32_t)vertex + w->boundary.body_corner[c];
        for (; facet < end; facet++) shown->facet_body[facet] = (int32_t)k;
        for (end = vertex + (size_t)shape[0]; vertex < end; vertex++) {
            double *place = shown->place + 3 * vertex;
            shown->vertex_body[vertex] = (int32_t)k;
            gn_rigid_place(&w->boundary.bodies[k], w->boundary.body_vertex + 4 * vertex, place);
            gn_user_point(&w->ctx, place, place);
        }
    }
}

static gneiss_status make_view(const gn_world *world, view *shown, gneiss_error *error) {
    const size_t corners = world->boundary.body_corner_count;
    *shown = (view){.world = world,
                    .vertices = world->boundary.body_vertex_count,
                    .corners = (size_t)world->ctx.scene.dimension};
    shown->facets = corners / shown->corners;
    GN_TRY(gn_new(&shown->place, 3 * shown->vertices, "coordinates of vertices", error));
    GN_TRY(gn_new(&shown->vertex_body, shown->vertices, "vertices", error));
    GN_TRY(gn_new(&shown->facet_body, shown->facets, "facets", error));
    GN_TRY(gn_new(&shown->corner, corners, "corners", error));
    fill(shown);
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
    gn_user_point(&w->ctx, w->boundary.bodies[k].position, value);
}
static void read_start(const void *of, size_t k, double *value) {
    const gn_world *w = ((const view *)of)->world;
    gn_user_point(&w->ctx, w->boundary.bodies[k].start, value);
}
static void read_orientation(const void *of, size_t k, double *value) {
    gn_rigid_orientation(&((const view *)of)->world->boundary.bodies[k], value);
}

/* Fields in addition to those of bodies in the history (quantities.c). */
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

static gn_output_source vertices_of(const view *shown) {
    return (gn_output_source){&gn_vertex_outputs, shown, 0, shown->vertices, NULL, NULL, 0};
}

static gn_output_source facets_of(const view *shown) {
    return (gn_output_source){&gn_facet_outputs, shown, 0, shown->facets, NULL, NULL, 0};
}

/* --- files --- */

static gneiss_status write_snapshot(const view *shown, const char *directory, const char *name,
                                    gneiss_error *error) {
    const gn_world *w = shown->world;
    const gn_output_source vertices = vertices_of(shown), facets = facets_of(shown);
    GN_FREED_BY(gn_output_arrays_free) gn_output_arrays points = {0}, cells = {0};
    GN_TRY(gn_output_arrays_read(&vertices, &points, error));
    GN_TRY(gn_output_arrays_read(&facets, &cells, error));
    const gn_snapshot s = {.bad = w->outcome.bad,
                           .time = w->ctx.time,
                           .step = w->ctx.step,
                           .point_count = shown->vertices,
                           .points = shown->place,
                           .line_count = shown->facets,
                           .lines = shown->corner,
                           .line_points = shown->corners,
                           .point_array_count = points.count,
                           .line_array_count = cells.count,
                           .point_arrays = points.of,
                           .line_arrays = cells.of};
    return gn_snapshot_write(directory, name, &s, error);
}

/* Tells whether a body is at rest where it began. */
static bool is_at_start(const gn_rigid *body) {
    for (int i = 0; i < 3; i++) {
        if (body->position[i] != body->start[i] || body->velocity[i] != 0.0 || body->spin[i] != 0.0)
            return false;
    }
    for (size_t i = 0; i < sizeof body->turn / sizeof *body->turn; i++) {
        if (body->turn[i] != body->turn_start[i]) return false;
    }
    return true;
}

static bool are_at_start(const gn_world *world) {
    for (size_t k = 0; k < world->ctx.scene.body_count; k++) {
        if (!is_at_start(&world->boundary.bodies[k])) return false;
    }
    return true;
}

/* Surfaces that have never moved are written once: the first file of their series shows them. */
static gneiss_status is_superfluous(const gn_world *world, const char *directory, const char *name,
                                    bool *superfluous, gneiss_error *error) {
    GN_FREED int64_t *steps = NULL;
    size_t count = 0;
    *superfluous = false;
    if (!are_at_start(world)) return GNEISS_OK;
    GN_TRY(gn_step_list(directory, name, ".hdf", &steps, &count, error));
    *superfluous = count == 1 && steps[0] < world->ctx.step;
    return GNEISS_OK;
}

gneiss_status gn_bodies_snapshot(const gn_world *world, const char *directory, const char *name,
                                 gneiss_error *error) {
    if (!gn_rank_writes()) return GNEISS_OK;
    GN_FREED_BY(free_view) view v = {0};
    bool superfluous;
    if (!world->ctx.scene.body_count) return GNEISS_OK;
    GN_TRY(is_superfluous(world, directory, name, &superfluous, error));
    if (superfluous) return GNEISS_OK;
    GN_TRY(make_view(world, &v, error));
    return write_snapshot(&v, directory, name, error);
}

/* Writes the names, one per line. */
static gneiss_status put_names(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    size_t used = 0, size = world->ctx.scene.body_count * (GN_NAME_SIZE + 1) + 1;
    GN_FREED char *names = NULL;
    GN_TRY(gn_new(&names, size, "bytes of the names of bodies", error));
    for (size_t k = 0; k < world->ctx.scene.body_count; k++)
        used += (size_t)snprintf(names + used, size - used, "%s%s", k ? "\n" : "",
                                 world->ctx.scene.bodies[k].name);
    return gn_h5_put_text(file, "bodies/name", names, error);
}

static gneiss_status put_view(const view *shown, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = shown->world;
    const gn_output_source
        bodies = {&gn_body_outputs, shown, w->ctx.effects, w->ctx.scene.body_count, NULL, NULL, 0},
        vertices = vertices_of(shown), facets = facets_of(shown);
    GN_TRY(put_names(w, file, error));
    GN_TRY(gn_output_put(&bodies, file, error));
    GN_TRY(gn_output_put(&vertices, file, error));
    GN_TRY(gn_output_put(&facets, file, error));
    return gn_h5_put(file, "bodies/facet", GN_I32, shown->facets, shown->corners, 0, shown->corner,
                     "1", "rows of vertex", error);
}

gneiss_status gn_bodies_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    GN_FREED_BY(free_view) view v = {0};
    if (!world->ctx.scene.body_count) return GNEISS_OK;
    GN_TRY(make_view(world, &v, error));
    return put_view(&v, file, error);
}

/* ---- final values of the quantities that the history has of each body or motion, in their groups
 * of results.h5 ---- */

/* Reads the components in space, which all arrays of results.h5 have; returns their number. */
static size_t read_parts(const gn_world *world, const gn_quantity *quantity, size_t owner,
                         double *to) {
    gn_shape_component part[GN_SHAPE_MOST];
    size_t parts = gn_shape_components(quantity->shape, 3, part);
    double value[9];
    quantity->read(world, owner, value);
    gn_shape_take(value, part, parts, to);
    return parts;
}

/* Writes GROUP/<quantity>, a row for every owner. */
static gneiss_status put_rows(const gn_world *world, const gn_quantity_group *group,
                              const gn_quantity *quantity, gn_h5 *file, gneiss_error *error) {
    char path[160];
    size_t owners = group->count(world), parts = 1;
    GN_FREED double *rows = NULL;
    GN_TRY(gn_new(&rows, owners * GN_SHAPE_MOST, quantity->name, error));
    for (size_t k = 0; k < owners; k++) parts = read_parts(world, quantity, k, rows + parts * k);
    snprintf(path, sizeof path, "%s/%s", group->ends, quantity->name);
    return gn_h5_put(file, path, GN_F64, owners, parts, 0, rows, quantity->unit, quantity->text,
                     error);
}

/* Writes GROUP/<owner>/<quantity>. */
static gneiss_status put_each(const gn_world *world, const gn_quantity_group *group,
                              const gn_quantity *quantity, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < group->count(world); k++) {
        char path[160];
        double value[GN_SHAPE_MOST];
        if (!gn_condition_holds(quantity->when, world, k)) continue;
        size_t parts = read_parts(world, quantity, k, value);
        snprintf(path, sizeof path, "%s/%s/%s", group->ends, group->owner(world, k),
                 quantity->name);
        GN_TRY(gn_h5_put(file, path, GN_F64, parts, 1, 0, value, quantity->unit, quantity->text,
                         error));
    }
    return GNEISS_OK;
}

gneiss_status gn_owners_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    for (size_t k = 0; k < GN_QUANTITY_GROUPS; k++) {
        const gn_quantity_group *g = &gn_quantity_groups[k];
        if (!g->ends || !g->count(world)) continue;
        for (size_t i = 0; i < g->quantity_count; i++)
            GN_TRY((g->in_rows ? put_rows : put_each)(world, g, &g->quantities[i], file, error));
    }
    return GNEISS_OK;
}

/* ---- sources, sinks and lost particles in files ---- */

/* --- lost particles --- */

gneiss_status gn_output_lost(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    const gn_flow *f = &world->dem.flow;
    const size_t row = sizeof(gn_lost);
    if (!f->lost_count) return GNEISS_OK;
    GN_TRY(gn_h5_put(file, "lost/id", GN_F64, f->lost_count, 1, row, &f->lost->id, "1",
                     "particle that left the domain, base 0", error));
    GN_TRY(gn_h5_put(file, "lost/time", GN_F64, f->lost_count, 1, row, &f->lost->time, "s",
                     "time at which that was detected", error));
    GN_TRY(gn_h5_put(file, "lost/position", GN_F64, f->lost_count, 3, row, f->lost->place, "m",
                     "centre then", error));
    return gn_h5_put(file, "lost/velocity", GN_F64, f->lost_count, 3, row, f->lost->velocity, "m/s",
                     "velocity then", error);
}

/* --- flow through sources and sinks --- */

/* Returns the slope of a straight line through rows [begin, end). */
static double slope(const double *t, const double *m, size_t begin, size_t end) {
    double n = (double)(end - begin), st = 0.0, sm = 0.0, stt = 0.0, stm = 0.0;
    for (size_t r = begin; r < end; r++) {
        st += t[r] / n;
        sm += m[r] / n;
    }
    for (size_t r = begin; r < end; r++) {
        stt += (t[r] - st) * (t[r] - st);
        stm += (t[r] - st) * (m[r] - sm);
    }
    return stm / stt;
}

/* Rows of the first quarter contain the onset of the flow, those of the last quarter the end of the
 * supply. */
double gn_sink_steady_rate(const gn_history *history, const char *sink) {
    enum { ROWS_LEAST = 5 };
    char name[192];
    snprintf(name, sizeof name, "sink_%s_mass", sink);
    const double *mass = gn_history_column(history, name),
                 *time = gn_history_column(history, "time");
    size_t begin = 0, end = history->row_count;
    if (!mass || !time || end == 0) return NAN;
    double all = mass[end - 1];
    while (begin < end && mass[begin] < 0.25 * all) begin++;
    while (end > begin && mass[end - 1] > 0.75 * all) end--;
    if (!(all > 0.0) || end < begin + ROWS_LEAST) return NAN;
    return slope(time, mass, begin, end);
}

/* Writes the keys that sources and sinks share; the entry stays open. */
static void begin_entry(gn_json *json, const char *name, double number, double mass,
                        double energy) {
    gn_json_object(json, NULL);
    gn_json_text(json, "name", name);
    GN_JSON_NUMBERS(json, {"number", (double)number}, {"mass", mass}, {"energy", energy});
}

void gn_output_flow(const gn_run *run, gn_json *json) {
    const gn_world *w = &run->world;
    if (!gn_scene_has_flow(&w->ctx.scene)) return;
    gn_json_array(json, "sources");
    for (size_t k = 0; k < w->ctx.scene.source_count; k++) {
        const gn_source_state *s = &w->dem.flow.sources[k];
        begin_entry(json, w->ctx.scene.sources[k].name, s->number, s->mass, s->energy);
        GN_JSON_NUMBERS(json, {"behind", gn_flow_behind(&w->ctx, &w->dem, k)},
                        {"without_room", (double)s->full});
        gn_json_end(json);
    }
    gn_json_end(json);
    gn_json_array(json, "sinks");
    for (size_t k = 0; k < w->ctx.scene.sink_count; k++) {
        const gn_sink_state *s = &w->dem.flow.sinks[k];
        begin_entry(json, w->ctx.scene.sinks[k].name, s->number, s->mass, s->energy);
        gn_json_number(json, "steady_rate",
                       gn_sink_steady_rate(&run->history, w->ctx.scene.sinks[k].name));
        gn_json_end(json);
    }
    gn_json_end(json);
}
