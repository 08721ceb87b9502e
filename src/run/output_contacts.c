/* The tables state what fields require, independent of the build. */
#define GN_EVERY_EFFECT
#include "run/output_contacts.h"

#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "io/snapshot.h"
#include "particles/joint_faces.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "soa/field.h"
#include "soa/records.h"
#include "world/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WITH_PARTICLE, WITH_WALL, WITH_BODY, WITH_ELEMENTS };
enum { NEVER_BONDED = 7 }; /* in addition to the states of bonds */

/* --- one contact --- */

static void split(gn_output_contact *contact) {
    const double length = sqrt(gn_dot3(contact->branch, contact->branch));
    contact->normal = length > 0.0 ? gn_dot3(contact->force, contact->branch) / length : 0.0;
}

static double shear_of(const gn_output_contact *contact) {
    return sqrt(
        fmax(0.0, gn_dot3(contact->force, contact->force) - contact->normal * contact->normal));
}

/* Returns a contact between particles. Its force is that of the evaluated copy; all other columns
 * are the world's. */
static gn_output_contact between(const gn_output_view *view, const gn_contacts *list,
                                 const gn_contacts *seen, size_t c) {
    const gn_world *w = view->world;
    const double *x = w->dem.particles.pos + 4 * (int64_t)list->i[c],
                 *y = w->dem.particles.pos + 4 * (int64_t)list->j[c];
    const double *row = gn_contacts_row(seen) + (size_t)gn_contacts_row_width(seen) * c;
    const int32_t i = view->row[list->i[c]], j = view->row[list->j[c]];
    const double turn = i < j ? 1.0 : -1.0;
    gn_output_contact k = {.i = i < j ? i : j,
                           .j = i < j ? j : i,
                           .with = WITH_PARTICLE,
                           .side = -1,
                           .joint = -1,
                           .state = list->cause ? gn_output_bond_state(list, c) : NEVER_BONDED};
    const double length = sqrt(gn_branch(&w->ctx, x, y, k.branch));
    for (int a = 0; a < (int)w->ctx.scene.dimension; a++) k.force[a] = turn * row[a];
    for (int a = 0; a < 3; a++) k.branch[a] *= turn;
    k.overlap = (list->length0 ? list->length0[c] : x[3] + y[3]) - length;
    if (list->plane) {
        k.overlap = -list->apart[c];
        k.joint = w->dem.joint_faces->face[list->joint[c]].joint;
        k.slip = list->slip[c];
    }
    k.area = list->patch ? list->patch[c] : gn_contact_area(&w->ctx, &w->dem, list, c, k.overlap);
    split(&k);
    return k;
}

/* Sets the branch to the radius in the direction of the point of the force, which is the length
 * that the mean stress assumes. */
static void reach_for(const gn_world *world, size_t c, gn_output_contact *contact) {
    const gn_wall_contacts *list = &world->boundary.contacts;
    const double *x = world->dem.particles.pos + 4 * (size_t)list->i[c];
    const size_t wall = (size_t)list->wall[c];
    double gap;
    if (contact->with == WITH_WALL) {
        const gn_wall *plane = &world->boundary.walls[wall];
        for (int a = 0; a < 3; a++) contact->branch[a] = -x[3] * plane->normal[a];
        gap = gn_wall_distance(plane, x) - x[3] - list->gap0[c];
    } else {
        double size2 = 0.0;
        for (size_t a = 0; a < (size_t)world->ctx.scene.dimension; a++) {
            contact->branch[a] = list->touch[c + a * list->soa.capacity] - x[a];
            size2 += contact->branch[a] * contact->branch[a];
        }
        for (int a = 0; a < 3 && size2 > 0.0; a++) contact->branch[a] *= x[3] / sqrt(size2);
        gap = sqrt(size2) - x[3];
    }
    contact->overlap = -gap;
}

static gn_output_contact with_surface(const gn_output_view *view, size_t c) {
    const gn_world *w = view->world;
    const gn_wall_contacts *list = &w->boundary.contacts;
    const size_t wall = (size_t)list->wall[c], p = (size_t)list->i[c];
    gn_output_contact k = {.i = view->row[p],
                           .j = -1,
                           .with = WITH_WALL,
                           .side = (int32_t)wall,
                           .joint = -1,
                           .state = NEVER_BONDED};
    if (wall >= w->ctx.scene.wall_count) {
        const gn_surface *s = gn_surface_of_row(&w->ctx, &w->boundary, c);
        k.with = s->body >= 0 ? WITH_BODY : WITH_ELEMENTS;
        k.side = s->body >= 0 ? s->body : (int32_t)(wall - w->ctx.scene.wall_count) - s->first;
    }
    for (size_t a = 0; a < (size_t)w->ctx.scene.dimension; a++) k.force[a] = list->row[8 * c + a];
    reach_for(w, c, &k);
    k.area = gn_touch_area(&w->ctx, &w->dem, p, k.overlap);
    split(&k);
    return k;
}

/* --- the whole list --- */

static bool acts(const gn_contacts *list, const gn_contacts *seen, size_t c) {
    /* Joints are shown where they are open, too. */
    return gn_contact_bonded(list, c) || gn_contact_carries(seen, c) || list->plane;
}

static bool pressed(const gn_world *world, size_t c) {
    const double *row = world->boundary.contacts.row + 8 * c;
    return row[0] != 0.0 || row[1] != 0.0 || row[2] != 0.0;
}

/* Counts the contacts, and writes them to `to` unless it is NULL. */
static size_t list_contacts(const gn_output_view *view, gn_output_contact *to) {
    const gn_world *w = view->world;
    size_t count = 0;
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contacts *list = &w->dem.list[l].contacts, *seen = &view->seen->list[l];
        for (size_t c = 0; c < list->soa.count; c++) {
            if (!acts(list, seen, c)) continue;
            if (to) to[count] = between(view, list, seen, c);
            count++;
        }
    }
    return count;
}

static size_t list_surfaces(const gn_output_view *view, gn_output_contact *to) {
    const gn_world *w = view->world;
    size_t count = 0;
    for (size_t c = 0; w->ctx.effects & GN_FX_WALLS && c < w->boundary.contacts.soa.count; c++) {
        if (!pressed(w, c)) continue;
        if (to) to[count] = with_surface(view, c);
        count++;
    }
    return count;
}

/* Collects the contacts of a view. */
static gneiss_status contacts_make(const gn_output_view *view, gn_output_contacts *all,
                                   gneiss_error *error) {
    const size_t particles = list_contacts(view, NULL);
    *all = (gn_output_contacts){.surfaces = list_surfaces(view, NULL)};
    all->count = particles + all->surfaces;
    all->row = calloc(all->count + 1, sizeof *all->row);
    if (!all->row)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu contacts",
                       all->count);
    list_contacts(view, all->row);
    list_surfaces(view, all->row + particles);
    return GNEISS_OK;
}

static void contacts_free(gn_output_contacts *all) {
    free(all->row);
    *all = (gn_output_contacts){0};
}

/* --- fields --- */

#define READ(name, expression)                                                                     \
    static void read_##name(const void *view, size_t c, double *value) {                           \
        const gn_output_contact *k = &((const gn_output_contacts *)view)->row[c];                  \
        *value = (expression);                                                                     \
    }
READ(first, k->i)
READ(second, k->j)
READ(with, k->with)
READ(side, k->side)
READ(joint, k->joint)
READ(slip, k->slip)
READ(state, k->state)
READ(normal_force, k->normal)
READ(shear_force, shear_of(k))
READ(overlap, k->overlap)
READ(area, k->area)
READ(normal_stress, k->area > 0.0 ? k->normal / k->area : 0.0)
READ(shear_stress, k->area > 0.0 ? shear_of(k) / k->area : 0.0)

static void read_force(const void *view, size_t c, double *value) {
    memcpy(value, ((const gn_output_contacts *)view)->row[c].force, 3 * sizeof *value);
}
static void read_branch(const void *view, size_t c, double *value) {
    memcpy(value, ((const gn_output_contacts *)view)->row[c].branch, 3 * sizeof *value);
}

enum { BOTH = GN_IN_RESULTS | GN_IN_SNAPSHOT };

static const gn_output_field of_contacts[] = {
    {"i", "1", "first particle, base 0: row of particles", BOTH, GN_I32, false, 1, read_first, 0},
    {"j", "1", "second particle; -1: a wall, a body or finite elements", BOTH, GN_I32, false, 1,
     read_second, 0},
    {"with", "1",
     "object in contact with i: 0 a particle, 1 a wall, 2 a rigid body, 3 finite elements", BOTH,
     GN_U8, false, 1, read_with, 0},
    {"side", "1",
     "index of the wall or body in the scene, or of the facet of finite elements; -1: a particle",
     BOTH, GN_I32, false, 1, read_side, 0},
    {"state", "1",
     "state as of bonds (0, 4 and 5 intact, 1 and 2 broken and in contact); 7: never bonded", BOTH,
     GN_U8, false, 1, read_state, 0},
    {"force", "N", "force on i; for walls and surfaces that of the last step", BOTH, GN_F64, false,
     3, read_force, 0},
    {"branch", "m",
     "vector from the centre of i to that of j, the nearest image; for walls and surfaces the "
     "radius toward the point of the force",
     BOTH, GN_F64, false, 3, read_branch, 0},
    {"normal_force", "N", "force along the branch, tension positive", BOTH, GN_F64, false, 1,
     read_normal_force, 0},
    {"shear_force", "N", "magnitude of the force across the branch", BOTH, GN_F64, false, 1,
     read_shear_force, 0},
    {"overlap", "m",
     "rest length of a bond, or sum of the radii, less the distance of the centres; for walls and "
     "surfaces the radius less their distance (passive walls: less the overlap at the start); "
     "below 0: a gap; across a joint its closure without dilation",
     BOTH, GN_F64, false, 1, read_overlap, 0},
    {"area", "m2",
     "section to which strengths of the pair refer, bonded or not: (2 r)^2 with the radius r that "
     "the law defines for it, in 2D 2 r x 1 m, for laws with areas their area, against walls and "
     "surfaces as between two equal particles; by Hertz's law the circle of contact, pi times "
     "overlap times reduced radius",
     BOTH, GN_F64, false, 1, read_area, 0},
    {"normal_stress", "Pa", "normal force over that area, tension positive; 0 without one", BOTH,
     GN_F64, false, 1, read_normal_stress, 0},
    {"shear_stress", "Pa", "shear force over it", BOTH, GN_F64, false, 1, read_shear_stress, 0},
    {"joint", "1", "index of the joint in the scene that the contact crosses; -1: none", BOTH,
     GN_I32, false, 1, read_joint, 0},
    {"slip", "m", "path of sliding along the joint; else 0", BOTH, GN_F64, false, 1, read_slip, 0},
};
_Static_assert(sizeof of_contacts / sizeof *of_contacts <= GN_OUTPUT_FIELDS_MOST,
               "room for the arrays of a snapshot");
const gn_output_table gn_contact_outputs = {"contacts", of_contacts,
                                            sizeof of_contacts / sizeof *of_contacts};

static gn_output_source contact_source(const gn_output_contacts *all) {
    return (gn_output_source){&gn_contact_outputs, all, 0, all->count, NULL, NULL, 0};
}

/* --- files --- */

/* Appends the points of the forces of walls and surfaces to the centres. */
static void place_ends(const gn_output_contacts *all, const gn_snapshot *points, double *place,
                       int32_t *ends) {
    size_t next = points->point_count;
    memcpy(place, points->points, 3 * next * sizeof *place);
    for (size_t c = 0; c < all->count; c++) {
        const gn_output_contact *k = &all->row[c];
        ends[2 * c] = k->i;
        ends[2 * c + 1] = k->j >= 0 ? k->j : (int32_t)next;
        if (k->j >= 0) continue;
        for (size_t a = 0; a < 3; a++)
            place[3 * next + a] = place[3 * (size_t)k->i + a] + k->branch[a];
        next++;
    }
}

static gneiss_status write_lines(const gn_output_contacts *all, const char *directory,
                                 const char *name, const gn_snapshot *points, double *place,
                                 int32_t *ends, gneiss_error *error) {
    const gn_output_source source = contact_source(all);
    gn_output_arrays lines;
    GN_TRY(gn_output_arrays_read(&source, &lines, error));
    gn_snapshot s = *points;
    place_ends(all, points, place, ends);
    s.point_count += all->surfaces;
    s.points = place;
    s.point_array_count = 0;
    s.line_count = all->count;
    s.lines = ends;
    s.line_arrays = lines.of;
    s.line_array_count = lines.count;
    gneiss_status status = gn_snapshot_write(directory, name, &s, error);
    gn_output_arrays_free(&lines);
    return status;
}

gneiss_status gn_output_contacts_snapshot(const gn_output_view *view, const char *directory,
                                          const char *name, const gn_snapshot *points,
                                          gneiss_error *error) {
    GN_FREED_BY(contacts_free) gn_output_contacts all = {0};
    GN_FREED double *place = NULL;
    GN_FREED int32_t *ends = NULL;
    GN_TRY(contacts_make(view, &all, error));
    GN_TRY(gn_new(&place, 3 * (points->point_count + all.surfaces), "coordinates", error));
    GN_TRY(gn_new(&ends, 2 * all.count, "ends of contacts", error));
    return write_lines(&all, directory, name, points, place, ends, error);
}

gneiss_status gn_output_contacts_put(const gn_output_view *view, gn_h5 *file, gneiss_error *error) {
    gn_output_contacts all;
    GN_TRY(contacts_make(view, &all, error));
    const gn_output_source source = contact_source(&all);
    gneiss_status status = gn_output_put(&source, file, error);
    contacts_free(&all);
    return status;
}
