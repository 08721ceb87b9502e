#include "particles/body_springs.h"

#include "particles/law.h"
#include "scene/scene.h"
#include "scene/sides.h"

#include <math.h>

/* N/m; infinite: rigid, by Hertz's law only. */
static double stiffness_of(const gn_scene *scene, size_t place) {
    bool wall = place < scene->wall_count, hertz = gn_scene_hertz(scene);
    double own =
        wall ? scene->walls[place].stiffness : scene->bodies[place - scene->wall_count].stiffness;
    return hertz && (wall || !(own > 0.0)) ? (double)INFINITY : own;
}

static double kratio_of(const gn_scene *scene, size_t place) {
    return place < scene->wall_count ? scene->walls[place].kratio
                                     : scene->bodies[place - scene->wall_count].kratio;
}

static const gn_material *material_of(const gn_scene *scene, size_t place) {
    const char *name = gn_scene_surface_at(scene, place).material;
    return gn_scene_hertz(scene) && *name ? &scene->materials[gn_scene_find_material(scene, name)]
                                          : NULL;
}

/* Returns the friction of a material, or that of the side if the material has none. */
static double friction_of(const gn_scene *scene, size_t place) {
    const gn_material *m = material_of(scene, place);
    return m ? m->friction : gn_scene_surface_at(scene, place).friction;
}
static double damping_of(const gn_scene *scene, size_t place) {
    const gn_material *m = material_of(scene, place);
    return m && m->restitution >= 0.0 ? gn_restitution_fraction(m->restitution)
                                      : gn_contact_damping_fraction(scene);
}

/* Combines the springs of two bodies; two rigid ones have none. */
static gn_touch_side springs_of(const gn_scene *scene, size_t a, size_t b) {
    double p = stiffness_of(scene, a), q = stiffness_of(scene, b), sum = p + q;
    double pk = kratio_of(scene, a), qk = kratio_of(scene, b);
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

gn_body_spring gn_body_spring_of(const gn_scene *scene, size_t place, size_t other) {
    const gn_material *p = material_of(scene, place), *q = material_of(scene, other);
    const gn_contact_def *own = p && q ? gn_scene_find_contact(scene, p, q) : NULL;
    gn_body_spring spring = {springs_of(scene, place, other),
                             fmax(damping_of(scene, place), damping_of(scene, other))};
    spring.side.friction = fmin(friction_of(scene, place), friction_of(scene, other));
    if (own && own->friction != GN_COMBINED) spring.side.friction = own->friction;
    if (own && own->restitution != GN_COMBINED)
        spring.damping = gn_restitution_fraction(own->restitution);
    return spring;
}

double gn_body_damping_most(const gn_scene *scene) {
    double most = 0.0;
    for (size_t k = 0; k < scene->body_count; k++)
        for (size_t n = 0; n < scene->wall_count + k; n++) {
            gn_body_spring spring = gn_body_spring_of(scene, scene->wall_count + k, n);
            if (spring.side.stiffness > 0.0) most = fmax(most, spring.damping);
        }
    return most;
}
