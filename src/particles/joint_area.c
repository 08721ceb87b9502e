/* Areas of the faces of joints inside of the specimen. */
#include "particles/joint_faces.h"

#include "base/new.h"
#include "base/vec3.h"
#include "soa/particle_state.h"

#include <math.h>
#include <string.h>

/* Computes how far a packed shape reaches in a direction, m; false: it is given by its particles
 * alone. */
static bool shape_reach(const gn_pack_def *shape, const double n[3], double *reach) {
    const double round = 0.5 * shape->diameter * hypot(n[0], n[1]);
    *reach = gn_dot3(n, shape->origin);
    switch (shape->shape) {
    case GN_SHAPE_RECTANGLE:
    case GN_SHAPE_BOX:
        for (int a = 0; a < 3; a++) *reach += fmax(0.0, n[a] * shape->size[a]);
        return true;
    case GN_SHAPE_DISC:
        *reach += round;
        return true;
    case GN_SHAPE_CYLINDER:
        *reach += round + fmax(0.0, n[2] * shape->height);
        return true;
    case GN_SHAPE_NONE:
    case GN_SHAPE_POLYGON:
    case GN_SHAPE_SURFACE:
    case GN_SHAPE_MESH:
        return false;
    }
    return false;
}

static double spheres_reach(const gn_particles *particles, const double n[3]) {
    double most = -INFINITY;
    for (size_t p = 0; p < particles->soa.count; p++)
        if (gn_particle_is_active(particles, p))
            most = fmax(most, gn_dot3(n, particles->start + 4 * p) + particles->pos[4 * p + 3]);
    return most;
}

void gn_outline_find(const gn_scene *scene, const gn_particles *particles, gn_outline *outline) {
    const int dimension = (int)scene->dimension;
    outline->dimension = dimension;
    outline->count = dimension == 3 ? GN_OUTLINE_MOST : GN_OUTLINE_TURNS;
    for (size_t k = 0; k < outline->count; k++) {
        const size_t axis = k / GN_OUTLINE_TURNS; /* of the circle of directions; 0: about z */
        const int turn = (int)(k % GN_OUTLINE_TURNS), quarter = GN_OUTLINE_TURNS / 4;
        const double angle = 2.0 * M_PI * turn / GN_OUTLINE_TURNS;
        double *n = outline->normal[k];
        n[0] = n[1] = n[2] = 0.0;
        /* Directions along the axes are exact. */
        n[axis] = turn % (2 * quarter) == quarter ? 0.0 : cos(angle);
        n[(axis + 1) % 3] = turn % (2 * quarter) == 0 ? 0.0 : sin(angle);
        if (!shape_reach(&scene->specimen.pack, n, &outline->reach[k]))
            outline->reach[k] = spheres_reach(particles, n);
    }
}

/* A polygon in the plane of a face, [count][2] m. */
typedef struct polygon {
    size_t count;
    double *corner;
} polygon;

enum { DISC_SIDES = 128 };

/* Clips by n.x <= reach (Sutherland and Hodgman 1974); `to` has room for twice as many corners. */
static void clip(const polygon *from, const double n[2], double reach, polygon *to) {
    to->count = 0;
    for (size_t k = 0; k < from->count; k++) {
        const double *a = from->corner + 2 * k, *b = from->corner + 2 * ((k + 1) % from->count);
        const double out_a = n[0] * a[0] + n[1] * a[1] - reach,
                     out_b = n[0] * b[0] + n[1] * b[1] - reach;
        if (out_a <= 0.0) memcpy(to->corner + 2 * to->count++, a, 2 * sizeof *a);
        if ((out_a <= 0.0) == (out_b <= 0.0)) continue;
        const double share = out_a / (out_a - out_b);
        for (int c = 0; c < 2; c++)
            to->corner[2 * to->count + (size_t)c] = a[c] + share * (b[c] - a[c]);
        to->count++;
    }
}

static double area_of(const polygon *p) {
    double twice = 0.0;
    for (size_t k = 0; k < p->count; k++) {
        const double *a = p->corner + 2 * k, *b = p->corner + 2 * ((k + 1) % p->count);
        twice += a[0] * b[1] - b[0] * a[1];
    }
    return 0.5 * fabs(twice);
}

/* Writes the corners of a face: of a disc those of a polygon of its area, of a plane those of a
 * square that contains the specimen. */
static void set_corners(const gn_joint_faces *faces, const gn_joint_face *face, double half,
                        polygon *p) {
    if (face->corner_count) {
        p->count = (size_t)face->corner_count;
        memcpy(p->corner, faces->corner + 2 * (size_t)face->first_corner,
               2 * p->count * sizeof *p->corner);
        return;
    }
    const bool plane = face->radius >= GN_JOINT_ENDLESS;
    const double turn = 2.0 * M_PI / DISC_SIDES;
    p->count = plane ? 4 : DISC_SIDES;
    const double radius = plane ? sqrt(2.0) * half : face->radius * sqrt(turn / sin(turn));
    for (size_t k = 0; k < p->count; k++) {
        const double angle = 2.0 * M_PI * ((double)k + 0.5) / (double)p->count;
        p->corner[2 * k] = radius * cos(angle);
        p->corner[2 * k + 1] = radius * sin(angle);
    }
}

/* Returns the length of a line in the plane inside of the outline. */
static double length_inside(const gn_joint_face *face, const gn_outline *outline) {
    double low = -face->radius, high = face->radius;
    for (size_t k = 0; k < outline->count; k++) {
        const double slope = gn_dot3(outline->normal[k], face->along);
        const double left = outline->reach[k] - gn_dot3(outline->normal[k], face->point);
        if (slope > 0.0) high = fmin(high, left / slope);
        if (slope < 0.0) low = fmax(low, left / slope);
        if (slope == 0.0 && left < 0.0) return 0.0;
    }
    return fmax(0.0, high - low);
}

gneiss_status gn_joint_face_area(const gn_joint_faces *faces, const gn_joint_face *face,
                                 const gn_outline *outline, double *area, gneiss_error *error) {
    const size_t room = (size_t)face->corner_count + DISC_SIDES + GN_OUTLINE_MOST;
    GN_FREED double *block = NULL;
    *area = outline->dimension == 2 ? length_inside(face, outline) : 0.0;
    if (outline->dimension == 2) return GNEISS_OK;
    GN_TRY(gn_new(&block, 8 * room, "corners of joints", error));
    polygon now = {0, block}, next = {0, block + 4 * room};
    double half = 0.0;
    for (size_t k = 0; k < outline->count; k++)
        half = fmax(half, fabs(outline->reach[k]) + sqrt(gn_dot3(face->point, face->point)));
    set_corners(faces, face, 2.0 * half, &now);
    for (size_t k = 0; k < outline->count; k++) {
        const double n[2] = {gn_dot3(outline->normal[k], face->along),
                             gn_dot3(outline->normal[k], face->up)};
        const double left = outline->reach[k] - gn_dot3(outline->normal[k], face->point);
        if (left >= hypot(n[0], n[1]) * face->radius * (1.0 + 2.0 / DISC_SIDES)) continue;
        clip(&now, n, left, &next);
        const polygon swap = now;
        now = next;
        next = swap;
    }
    *area = area_of(&now);
    return GNEISS_OK;
}
