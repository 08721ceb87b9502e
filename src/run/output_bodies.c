/* Rigid bodies as files: snapshots and their group in results.h5 (docs/results.md). */
#include "base/memory.h"
#include "io/snapshot.h"
#include "sim/parts.h"

#include <string.h>

typedef struct fields {
    double *point, *velocity; /* [vertices][3] */
    double *body;             /* [facets] */
    int32_t *corner;          /* [facets][corners], all vertices counted through */
    size_t points, facets, corners;
} fields;

static void free_fields(fields *f) {
    gn_free(f->point);
    gn_free(f->velocity);
    gn_free(f->body);
    gn_free(f->corner);
}

static gneiss_status allocate(const gn_world *w, fields *f, gneiss_error *error) {
    *f = (fields){.points = w->boundary.body_vertex_count, .corners = (size_t)w->scene.dimension};
    f->facets = w->boundary.body_corner_count / f->corners;
    f->point = gn_alloc_array(f->points + 1, 3 * sizeof *f->point);
    f->velocity = gn_alloc_array(f->points + 1, 3 * sizeof *f->velocity);
    f->body = gn_alloc_array(f->facets + 1, sizeof *f->body);
    f->corner = gn_alloc_array(w->boundary.body_corner_count + 1, sizeof *f->corner);
    if (f->point && f->velocity && f->body && f->corner) return GNEISS_OK;
    free_fields(f);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu facets", f->facets);
}

/* v + spin x (x - position) */
static void velocity_at(const gn_rigid *b, const double *x, double *v) {
    for (int a = 0; a < 3; a++) {
        int p = (a + 1) % 3, q = (a + 2) % 3;
        v[a] = b->velocity[a] + b->spin[p] * (x[q] - b->position[q]) -
               b->spin[q] * (x[p] - b->position[p]);
    }
}

static void fill(const gn_world *w, fields *f) {
    size_t vertex = 0, facet = 0;
    for (size_t k = 0; k < w->scene.body_count; k++) {
        const int64_t *shape = w->boundary.body_shape[k];
        size_t corners = f->corners * (size_t)shape[1], first = f->corners * facet;
        for (size_t c = first; c < first + corners; c++)
            f->corner[c] = (int32_t)vertex + w->boundary.body_corner[c];
        for (size_t c = 0; c < (size_t)shape[1]; c++) f->body[facet + c] = (double)k;
        for (size_t v = vertex; v < vertex + (size_t)shape[0]; v++) {
            gn_rigid_place(&w->boundary.bodies[k], w->boundary.body_vertex + 4 * v,
                           f->point + 3 * v);
            velocity_at(&w->boundary.bodies[k], f->point + 3 * v, f->velocity + 3 * v);
            gn_world_point_out(w, f->point + 3 * v, f->point + 3 * v);
        }
        vertex += (size_t)shape[0];
        facet += (size_t)shape[1];
    }
}

gneiss_status gn_bodies_snapshot(const gn_world *w, const char *directory, const char *name,
                                 gneiss_error *error) {
    fields f;
    if (!w->scene.body_count) return GNEISS_OK;
    GN_TRY(allocate(w, &f, error));
    fill(w, &f);
    const gn_snapshot_array points[] = {{"velocity", "m/s", 3, f.velocity}};
    const gn_snapshot_array cells[] = {{"body", "1", 1, f.body}};
    gn_snapshot s = {.bad = w->bad,
                     .time = w->time,
                     .step = w->step,
                     .point_count = f.points,
                     .points = f.point};
    s.line_count = f.facets;
    s.lines = f.corner;
    s.line_points = f.corners;
    s.point_arrays = points;
    s.point_array_count = 1;
    s.line_arrays = cells;
    s.line_array_count = 1;
    gneiss_status status = gn_snapshot_write(directory, name, &s, error);
    free_fields(&f);
    return status;
}

/* Places as the user sees them, and orientations. */
static gneiss_status put_places(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    size_t count = w->scene.body_count, stride = 10 * sizeof(double);
    double *row = gn_alloc_array(count, stride);
    if (!row) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu bodies", count);
    for (size_t k = 0; k < count; k++) {
        gn_world_point_out(w, w->boundary.bodies[k].position, row + 10 * k);
        gn_world_point_out(w, w->boundary.bodies[k].start, row + 10 * k + 3);
        gn_rigid_orientation(&w->boundary.bodies[k], row + 10 * k + 6);
    }
    gneiss_status status = gn_h5_put(file, "bodies/position", GN_F64, count, 3, stride, row, "m",
                                     "reference point; free: centre of mass", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "bodies/start", GN_F64, count, 3, stride, row + 3, "m",
                           "the same at the start", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "bodies/orientation", GN_F64, count, 4, stride, row + 6, "1",
                           "quaternion w x y z from the start", error);
    gn_free(row);
    return status;
}

static gneiss_status put_rows(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    size_t count = w->scene.body_count, stride = sizeof(gn_rigid);
    const gn_rigid *b = w->boundary.bodies;
    const struct {
        const char *name, *unit, *text;
        size_t components;
        const double *data;
    } columns[] = {
        {"bodies/velocity", "m/s", "of the reference point, at the last half step", 3, b->velocity},
        {"bodies/spin", "rad/s", "angular velocity", 3, b->spin},
        {"bodies/force", "N", "of the particles on the body", 3, b->force},
        {"bodies/moment", "N m", "of the particles about the reference point", 3, b->moment},
        {"bodies/mass", "kg", "0: not free", 1, &b->mass},
        {"bodies/inertia", "kg m2", "about the principal axes; 2D: the third; 0: not free", 3,
         b->inertia},
    };
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
        GN_TRY(gn_h5_put(file, columns[k].name, GN_F64, count, columns[k].components, stride,
                         columns[k].data, columns[k].unit, columns[k].text, error));
    return put_places(w, file, error);
}

gneiss_status gn_bodies_results(const gn_world *w, gn_h5 *file, gneiss_error *error) {
    fields f;
    size_t used = 0, size = w->scene.body_count * (GN_NAME_SIZE + 1) + 1;
    if (!w->scene.body_count) return GNEISS_OK;
    GN_TRY(put_rows(w, file, error));
    char *names = gn_alloc(size);
    if (!names) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for names of bodies");
    for (size_t k = 0; k < w->scene.body_count; k++)
        used += (size_t)snprintf(names + used, size - used, "%s%s", k ? "\n" : "",
                                 w->scene.bodies[k].name);
    gneiss_status status = gn_h5_put_text(file, "bodies/name", names, error);
    gn_free(names);
    GN_TRY(status);
    GN_TRY(allocate(w, &f, error));
    fill(w, &f);
    status = gn_h5_put(file, "bodies/vertex", GN_F64, f.points, 3, 0, f.point, "m",
                       "vertices of all bodies", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "bodies/facet", GN_I32, f.facets, f.corners, 0, f.corner, "1",
                           "rows of vertex", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "bodies/facet_body", GN_F64, f.facets, 1, 0, f.body, "1",
                           "place of the body of a facet", error);
    free_fields(&f);
    return status;
}
