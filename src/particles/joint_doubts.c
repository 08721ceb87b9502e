/* Doubts about joints that a packing does not resolve. */
#include "particles/joints.h"

#include "frame/frame.h"
#include "particles/joint_faces.h"
#include "particles/particles.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Shares of contacts that cross several joints, and of missing area, that matter: strength and
 * stiffness of a joint are off by about as much. */
static const double matters = 0.05;

gn_joint_start gn_joint_at_start(const gn_dem *dem, size_t joint) {
    const gn_joint_faces *f = dem->joint_faces;
    gn_joint_start sum = {0};
    for (size_t k = 0; k < f->count; k++) {
        if (f->face[k].joint != (int32_t)joint) continue;
        if (k > 0 && f->face[k - 1].patch == f->face[k].patch) continue;
        const gn_joint_patch *patch = &f->patch[f->face[k].patch];
        sum.wanted += patch->area;
        if (patch->share > 0.0) sum.reached += patch->area;
        sum.contacts += patch->contacts;
        sum.shared += patch->shared;
    }
    return sum;
}

bool gn_joints_are_close(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size) {
    double contacts = 0.0, shared = 0.0;
    for (size_t k = 0; k < ctx->scene.joint_count; k++) {
        const gn_joint_start start = gn_joint_at_start(dem, k);
        contacts += start.contacts;
        shared += start.shared;
    }
    if (!(shared > matters * contacts)) return false;
    snprintf(text, size,
             "%.0f of %.0f contacts across joints (%.0f %%) cross more than one: joints closer to "
             "each other than particles act side by side and not one behind the other, which is "
             "too stiff and too strong; smaller particles separate them",
             shared, contacts, 100.0 * shared / contacts);
    return true;
}

bool gn_joints_lack_area(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size) {
    size_t used = 0;
    for (size_t k = 0; k < ctx->scene.joint_count; k++) {
        const gn_joint_start start = gn_joint_at_start(dem, k);
        if (!(start.reached < (1.0 - matters) * start.wanted) || used >= size) continue;
        used +=
            (size_t)snprintf(text + used, size - used, "%s'%.60s' %.4g m2 of %.4g m2 (-%.0f %%)",
                             used ? ", " : "joint ", ctx->scene.joints[k].name, start.reached,
                             start.wanted, 100.0 * (1.0 - start.reached / start.wanted));
    }
    if (used && used < size)
        snprintf(text + used, size - used,
                 ": contacts cross this part of the area; discs between particles that no contact "
                 "crosses have no effect, smaller particles reach them");
    return used > 0;
}
