#include "particles/body_springs.h"

#include "kernels/law.h"
#include "particles/law.h"
#include "scene/scene.h"
#include "scene/sides.h"

#include <math.h>

/* N/m; infinite: rigid, by Hertz's law only. */
static double stiffness_of(const gn_scene *s, size_t place) {
    bool wall = place < s->wall_count, hertz = gn_scene_hertz(s);
    double own = wall ? s->walls[place].stiffness : s->bodies[place - s->wall_count].stiffness;
    return hertz && (wall || !(own > 0.0)) ? (double)INFINITY : own;
}

static double kratio_of(const gn_scene *s, size_t place) {
    return place < s->wall_count ? s->walls[place].kratio : s->bodies[place - s->wall_count].kratio;
}

static const gn_material *material_of(const gn_scene *s, size_t place) {
    const char *name = gn_scene_surface_at(s, place).material;
    return gn_scene_hertz(s) && *name ? &s->materials[gn_scene_find_material(s, name)] : NULL;
}

/* With a material its own friction and restitution, without one those of the side and the scene. */
static double friction_of(const gn_scene *s, size_t place) {
    const gn_material *m = material_of(s, place);
    return m ? m->friction : gn_scene_surface_at(s, place).friction;
}
static double damping_of(const gn_scene *s, size_t place) {
    const gn_material *m = material_of(s, place);
    return m && m->restitution >= 0.0 ? gn_restitution_fraction(m->restitution)
                                      : gn_contact_damping_fraction(s);
}

/* Combines the springs of two bodies; two rigid ones have none. */
static gn_touch_side springs_of(const gn_scene *s, size_t a, size_t b) {
    double p = stiffness_of(s, a), q = stiffness_of(s, b), sum = p + q;
    double pk = kratio_of(s, a), qk = kratio_of(s, b);
    gn_touch_side side = {.part = 1.0};
    if (!(sum > 0.0) || (isinf(p) && isinf(q))) return side;
    if (isinf(sum)) {
        side.stiffness = isinf(p) ? q : p;
        side.kratio = fmax(0.0, isinf(p) ? qk : pk);
        return side;
    }
    side.stiffness = p * (q / sum);
    if (pk > 0.0 && qk > 0.0) side.kratio = (pk * q + qk * p) / sum;
    return side;
}

gn_body_spring gn_body_spring_of(const gn_scene *s, size_t place, size_t other) {
    const gn_material *p = material_of(s, place), *q = material_of(s, other);
    const gn_contact_def *own = p && q ? gn_scene_find_contact(s, p, q) : NULL;
    gn_body_spring spring = {springs_of(s, place, other),
                             fmax(damping_of(s, place), damping_of(s, other))};
    spring.side.friction = fmin(friction_of(s, place), friction_of(s, other));
    if (own && own->friction != GN_COMBINED) spring.side.friction = own->friction;
    if (own && own->restitution != GN_COMBINED)
        spring.damping = gn_restitution_fraction(own->restitution);
    return spring;
}

double gn_body_damping_most(const gn_scene *s) {
    double most = 0.0;
    for (size_t k = 0; k < s->body_count; k++)
        for (size_t n = 0; n < s->wall_count + k; n++) {
            gn_body_spring spring = gn_body_spring_of(s, s->wall_count + k, n);
            if (spring.side.stiffness > 0.0) most = fmax(most, spring.damping);
        }
    return most;
}
