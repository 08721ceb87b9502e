/* The faces of joints, and which of them lies between two particles. */
#include "particles/joint_faces.h"

#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "mesh/mesh.h"
#include "particles/particles.h"

#include <math.h>
#include <string.h>

void gn_joint_faces_free(gn_joint_faces **faces) {
    gn_joint_faces *f = *faces;
    if (!f) return;
    gn_free(f->face);
    gn_free(f->corner);
    gn_free(f->patch);
    gn_free(f->first_near);
    gn_free(f->near);
    gn_free(f);
    *faces = NULL;
}

/* --- faces of the scene --- */

static bool widen(void *place, size_t count, size_t size) {
    /* Capacities are powers of two. */
    if (count & (count - 1)) return true;
    return gn_widen(place, count, count ? 2 * count : 1, size);
}

gn_joint_face *gn_joint_faces_add(gn_joint_faces *faces, const double point[3],
                                  const double normal[3], int dimension) {
    if (!widen(&faces->face, faces->count, sizeof *faces->face)) return NULL;
    gn_joint_face *f = &faces->face[faces->count++];
    *f = (gn_joint_face){.radius = GN_JOINT_ENDLESS, .first_corner = (int32_t)faces->corner_count};
    memcpy(f->point, point, sizeof f->point);
    memcpy(f->normal, normal, sizeof f->normal);
    const double across = hypot(normal[0], normal[1]);
    if (dimension == 2) {
        f->along[0] = normal[1];
        f->along[1] = -normal[0];
    } else if (across > 0.0) {
        f->along[0] = -normal[1] / across;
        f->along[1] = normal[0] / across;
    } else {
        f->along[0] = 1.0;
    }
    gn_cross3(normal, f->along, f->up);
    return f;
}

static bool add_corner(gn_joint_faces *faces, gn_joint_face *face, double along, double up) {
    void *place = &faces->corner;
    if (!widen(place, faces->corner_count, 2 * sizeof *faces->corner)) return false;
    faces->corner[2 * faces->corner_count] = along;
    faces->corner[2 * faces->corner_count++ + 1] = up;
    face->radius = fmax(face->corner_count++ ? face->radius : 0.0, hypot(along, up));
    return true;
}

static bool add_plane(const gn_scene *scene, int32_t joint, gn_joint_faces *faces) {
    const gn_joint_def *def = &scene->joints[joint];
    gn_joint_face *f = gn_joint_faces_add(faces, def->point, def->normal, (int)scene->dimension);
    if (!f) return false;
    f->joint = joint;
    if (def->radius > 0.0) f->radius = def->radius;
    for (size_t k = 0; k < def->corner_count; k++)
        if (!add_corner(faces, f, def->corners[2 * k], def->corners[2 * k + 1])) return false;
    return true;
}

static bool add_trace(const gn_scene *scene, int32_t joint, gn_joint_faces *faces) {
    const gn_joint_def *def = &scene->joints[joint];
    for (size_t k = 0; k + 1 < def->trace_count; k++) {
        const double *a = def->trace + 2 * k, *b = a + 2, d[2] = {b[0] - a[0], b[1] - a[1]};
        const double length = hypot(d[0], d[1]);
        if (!(length > 0.0)) continue;
        gn_joint_face *f =
            gn_joint_faces_add(faces, (double[3]){0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.0},
                               (double[3]){-d[1] / length, d[0] / length, 0.0}, 2);
        if (!f) return false;
        f->joint = joint;
        f->radius = 0.5 * length;
    }
    return true;
}

static bool add_triangle(gn_joint_faces *faces, int32_t joint, const double *corner[3]) {
    double e[3], g[3], n[3], middle[3];
    for (int a = 0; a < 3; a++) {
        e[a] = corner[1][a] - corner[0][a];
        g[a] = corner[2][a] - corner[0][a];
        middle[a] = (corner[0][a] + corner[1][a] + corner[2][a]) / 3.0;
    }
    gn_cross3(e, g, n);
    const double size = sqrt(gn_dot3(n, n));
    if (!(size > 0.0)) return true;
    for (int a = 0; a < 3; a++) n[a] /= size;
    gn_joint_face *f = gn_joint_faces_add(faces, middle, n, 3);
    if (!f) return false;
    f->joint = joint;
    for (int k = 0; k < 3; k++) {
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = corner[k][a] - middle[a];
        if (!add_corner(faces, f, gn_dot3(d, f->along), gn_dot3(d, f->up))) return false;
    }
    return true;
}

static gneiss_status add_surface(const gn_scene *scene, int32_t joint, gn_joint_faces *faces,
                                 gneiss_error *error) {
    GN_FREED_BY(gn_mesh_free) gn_mesh mesh = {0};
    GN_TRY(gn_mesh_read_surface(scene->joints[joint].surface_path, 1.0, &mesh, error));
    for (size_t k = 0; k < mesh.node_count; k++)
        for (size_t a = 0; a < 3; a++) mesh.node[3 * k + a] -= scene->origin[a];
    for (size_t k = 0; k < mesh.triangles.count; k++) {
        const int32_t *node = mesh.triangles.node + 3 * k;
        const double *corner[3];
        for (int a = 0; a < 3; a++) corner[a] = mesh.node + 3 * (size_t)node[a];
        if (!add_triangle(faces, joint, corner)) return gn_no_memory(error, "joints");
    }
    return GNEISS_OK;
}

static gneiss_status add_joint(const gn_step_context *ctx, const gn_dem *dem, int32_t joint,
                               gn_joint_faces *faces, gneiss_error *error) {
    const gn_joint_def *def = &ctx->scene.joints[joint];
    if (*def->surface) return add_surface(&ctx->scene, joint, faces, error);
    if (*def->discs) return gn_joint_discs_read(&ctx->scene, joint, faces, error);
    if (def->network.given) return gn_joint_network_draw(ctx, dem, joint, faces, error);
    const bool held = def->trace_count ? add_trace(&ctx->scene, joint, faces)
                                       : add_plane(&ctx->scene, joint, faces);
    return held ? GNEISS_OK : gn_no_memory(error, "joints");
}

/* Numbers the patches, and finds their areas inside of the specimen. */
static gneiss_status measure_patches(const gn_step_context *ctx, const gn_dem *dem,
                                     gn_joint_faces *faces, gneiss_error *error) {
    GN_FREED gn_outline *outline = NULL;
    GN_TRY(gn_new(&outline, 1, "the outline of the specimen", error));
    gn_outline_find(&ctx->scene, &dem->particles, outline);
    for (size_t k = 0; k < faces->count; k++) {
        gn_joint_face *f = &faces->face[k];
        const gn_joint_def *def = &ctx->scene.joints[f->joint];
        const bool goes_on =
            k > 0 && f->joint == f[-1].joint && (*def->surface || def->trace_count);
        f->patch = goes_on ? f[-1].patch : (int32_t)faces->patch_count++;
    }
    GN_TRY(gn_new(&faces->patch, faces->patch_count + 1, "joints", error));
    for (size_t k = 0; k < faces->count; k++) {
        double area;
        GN_TRY(gn_joint_face_area(faces, &faces->face[k], outline, &area, error));
        gn_joint_patch *patch = &faces->patch[faces->face[k].patch];
        patch->area += area;
        patch->dilation = ctx->scene.joints[faces->face[k].joint].dilation;
        patch->dilation_end = ctx->scene.joints[faces->face[k].joint].dilation_end;
    }
    return GNEISS_OK;
}

gneiss_status gn_joint_faces_make(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    if (!ctx->scene.joint_count) return GNEISS_OK;
    GN_TRY(gn_new(&dem->joint_faces, 1, "joints", error));
    for (size_t k = 0; k < ctx->scene.joint_count; k++)
        GN_TRY(add_joint(ctx, dem, (int32_t)k, dem->joint_faces, error));
    GN_TRY(measure_patches(ctx, dem, dem->joint_faces, error));
    return gn_joint_faces_list_near(ctx, dem, error);
}

/* --- near faces --- */

/* Returns the coordinates of a point in the frame of a face, m: along, up, along the normal. */
static void place_in(const gn_joint_face *f, const double x[3], double at[3]) {
    const double d[3] = {x[0] - f->point[0], x[1] - f->point[1], x[2] - f->point[2]};
    at[0] = gn_dot3(d, f->along);
    at[1] = gn_dot3(d, f->up);
    at[2] = gn_dot3(d, f->normal);
}

static bool is_near(const gn_joint_face *f, const double x[3], double reach, int dimension) {
    double at[3];
    place_in(f, x, at);
    if (dimension == 2) at[1] = 0.0;
    return fabs(at[2]) <= reach && hypot(at[0], at[1]) <= f->radius + reach;
}

double gn_joint_reach(const gn_step_context *ctx, const gn_joint_faces *faces) {
    double reach = 1.0 + ctx->scene.interaction_range;
    for (size_t k = 0; k < faces->patch_count; k++) reach = fmax(reach, faces->patch[k].reach);
    return reach;
}

gneiss_status gn_joint_faces_list_near(const gn_step_context *ctx, gn_dem *dem,
                                       gneiss_error *error) {
    gn_joint_faces *f = dem->joint_faces;
    const gn_particles *q = &dem->particles;
    double most = 0.0;
    size_t room = 0, used = 0;
    if (!f) return GNEISS_OK;
    const double range = gn_joint_reach(ctx, f);
    GN_FREED int32_t *row = NULL;
    f->ids = (size_t)dem->ids;
    GN_TRY(gn_new(&row, f->ids + 1, "particles at joints", error));
    gn_free(f->first_near);
    f->first_near = NULL;
    GN_TRY(gn_new(&f->first_near, f->ids + 1, "particles at joints", error));
    for (size_t p = 0; p < q->soa.count; p++) {
        most = fmax(most, q->pos[4 * p + 3]);
        row[q->id[p]] = (int32_t)p + 1;
    }
    for (size_t id = 0; id < f->ids; id++) {
        f->first_near[id + 1] = used;
        if (!row[id]) continue;
        const double *x = q->start + 4 * (size_t)(row[id] - 1);
        const double reach = range * (q->pos[4 * (size_t)(row[id] - 1) + 3] + most);
        for (size_t k = 0; k < f->count; k++) {
            if (!is_near(&f->face[k], x, reach, (int)ctx->scene.dimension)) continue;
            GN_TRY(gn_grow(&f->near, used, used + 1, &room, "faces near particles", error));
            f->near[used++] = (int32_t)k;
        }
        f->first_near[id + 1] = used;
    }
    return GNEISS_OK;
}

/* --- between two particles --- */

/* Tells whether a point of the plane belongs to the face; a polygon by the number of its sides
 * that a line from the point crosses. */
static bool contains(const gn_joint_faces *faces, const gn_joint_face *f, double along, double up) {
    if (!f->corner_count) return hypot(along, up) <= f->radius;
    const double *corner = faces->corner + 2 * (size_t)f->first_corner;
    bool inside = false;
    for (int32_t k = 0, l = f->corner_count - 1; k < f->corner_count; l = k++) {
        const double *a = corner + 2 * k, *b = corner + 2 * l;
        if ((a[1] > up) == (b[1] > up)) continue;
        inside ^= along < a[0] + (up - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    }
    return inside;
}

/* Rows of two particles: their places at the start, and how far the second went away from the
 * first. */
typedef struct ends {
    const double *start[2];
    double parted[3];
} ends;

static ends ends_of(const gn_dem *dem, int32_t i, int32_t j) {
    const gn_particles *q = &dem->particles;
    ends e = {.start = {q->start + 4 * (int64_t)i, q->start + 4 * (int64_t)j}};
    for (int a = 0; a < 3; a++)
        e.parted[a] = (q->pos[4 * (int64_t)j + a] - e.start[1][a]) -
                      (q->pos[4 * (int64_t)i + a] - e.start[0][a]);
    return e;
}

/* Returns the position of the crossing between both ends, 0 to 1, below 0: they do not cross the
 * face. Sides are those at the start; along the face the branch is where it is now, less the mean
 * displacement of both. */
static double crossing_at(const gn_joint_faces *faces, const gn_joint_face *f, const ends *e,
                          int dimension) {
    double at[2][3], away[3];
    for (int k = 0; k < 2; k++) place_in(f, e->start[k], at[k]);
    if ((at[0][2] >= 0.0) == (at[1][2] >= 0.0)) return -1.0;
    away[0] = 0.5 * gn_dot3(e->parted, f->along);
    away[1] = 0.5 * gn_dot3(e->parted, f->up);
    const double low = fabs(at[0][2]), share = low / (low + fabs(at[1][2]));
    double point[2];
    for (int a = 0; a < 2; a++)
        point[a] = (1.0 - share) * (at[0][a] - away[a]) + share * (at[1][a] + away[a]);
    return contains(faces, f, point[0], dimension == 2 ? 0.0 : point[1]) ? share : -1.0;
}

double gn_joint_sense(const gn_dem *dem, const gn_joint_face *face, int32_t i, int32_t j) {
    const ends e = ends_of(dem, i, j);
    double at[3];
    place_in(face, e.start[1], at);
    return at[2] >= 0.0 ? 1.0 : -1.0;
}

double gn_joint_dilation(const gn_dem *dem, const gn_joint_face *face, double slip) {
    const gn_joint_patch *patch = &dem->joint_faces->patch[face->patch];
    return patch->dilation * fmin(slip, patch->dilation_end);
}

int32_t gn_joint_between(const gn_dem *dem, int32_t i, int32_t j, gn_joint_shift *shift) {
    const gn_joint_faces *f = dem->joint_faces;
    const int32_t id = dem->particles.id[i];
    const int dimension = dem->particles.soa.effects & GN_FX_SPACE ? 3 : 2;
    if (!f || (size_t)id >= f->ids || f->first_near[id] == f->first_near[id + 1]) return -1;
    const double *pos = dem->particles.pos,
                 least = fmin(pos[4 * (int64_t)i + 3], pos[4 * (int64_t)j + 3]);
    const ends e = ends_of(dem, i, j);
    int32_t found = -1;
    double best = INFINITY;
    for (size_t k = f->first_near[id]; k < f->first_near[id + 1]; k++) {
        const gn_joint_face *face = &f->face[f->near[k]];
        const double at = crossing_at(f, face, &e, dimension), off = fabs(at - 0.5);
        if (at < 0.0 || off >= best) continue;
        const double opened = gn_joint_sense(dem, face, i, j) * gn_dot3(e.parted, face->normal);
        const double slid = sqrt(fmax(0.0, gn_dot3(e.parted, e.parted) - opened * opened));
        best = off;
        found = f->near[k];
        *shift = (gn_joint_shift){opened, slid,
                                  fabs(opened - gn_joint_dilation(dem, face, slid)) >= least};
    }
    return found;
}

bool gn_joint_between_several(const gn_dem *dem, int32_t i, int32_t j) {
    const gn_joint_faces *f = dem->joint_faces;
    const int32_t id = dem->particles.id[i];
    const int dimension = dem->particles.soa.effects & GN_FX_SPACE ? 3 : 2;
    const ends e = ends_of(dem, i, j);
    int32_t patch = -1;
    for (size_t k = f->first_near[id]; k < f->first_near[id + 1]; k++) {
        const gn_joint_face *face = &f->face[f->near[k]];
        if (face->patch == patch || crossing_at(f, face, &e, dimension) < 0.0) continue;
        if (patch >= 0) return true;
        patch = face->patch;
    }
    return false;
}
