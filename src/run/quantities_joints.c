/* Columns of the history about joints. */
#include "particles/joints.h"
#include "particles/particles.h"
#include "run/quantities.h"

static const gn_condition always = {"always", NULL, NULL};

size_t gn_joint_quantity_count(const gn_world *world) {
    return world->ctx.scene.joint_count;
}
const char *gn_joint_quantity_owner(const gn_world *world, size_t k) {
    return world->ctx.scene.joints[k].name;
}

#define READ(name)                                                                                 \
    static void read_##name(const gn_world *world, size_t k, double *value) {                      \
        *value = gn_joint_read(&world->dem, k).name;                                               \
    }
READ(area)
READ(broken)
READ(opened)
READ(sliding)
READ(normal)
READ(shear)
READ(gap)
READ(slip)

#define SCALAR(name, unit, text)                                                                   \
    { #name, unit, text, GN_SCALAR, GN_AFTER_STEP, &always, read_##name, NULL }

const gn_quantity gn_joint_quantities[GN_JOINT_QUANTITIES] = {
    SCALAR(area, "m2", "area of the contacts of the joint; in 2D length times 1 m"),
    SCALAR(broken, "m2", "area without cohesion and tensile strength"),
    SCALAR(opened, "m2", "area without force"),
    SCALAR(sliding, "m2", "area at the limit of friction"),
    SCALAR(normal, "N", "sum of the normal forces, compression positive"),
    SCALAR(shear, "N", "magnitude of the sum of the shear forces"),
    SCALAR(gap, "m", "mean opening of the joint over its area; below 0: closure"),
    SCALAR(slip, "m", "mean path of sliding over its area")};
