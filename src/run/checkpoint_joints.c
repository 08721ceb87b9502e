/* The part of a checkpoint for the faces of joints; their contacts are a list of particles. */
#include "run/checkpoint_internal.h"

#include "base/new.h"
#include "particles/joint_faces.h"
#include "particles/particles.h"

enum { ARRAYS = 4, NUMBERS = offsetof(gn_joint_face, joint) / 8, INDICES = 4 };

static void list_joints(gn_joint_faces *faces, gn_checkpoint_array out[ARRAYS]) {
    out[0] = GN_CHECKPOINT_MEMBERS("joint_faces", GN_F64, faces->count, NUMBERS, &faces->face,
                                   gn_joint_face, point);
    out[1] = GN_CHECKPOINT_MEMBERS("joint_indices", GN_I32, faces->count, INDICES, &faces->face,
                                   gn_joint_face, joint);
    out[2] = GN_CHECKPOINT_ARRAY("joint_corners", GN_F64, faces->corner_count, 2, &faces->corner);
    out[3] = GN_CHECKPOINT_MEMBERS("joint_patches", GN_F64, faces->patch_count,
                                   sizeof(gn_joint_patch) / 8, &faces->patch, gn_joint_patch, area);
}

gneiss_status gn_checkpoint_put_joints(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_checkpoint_array arrays[ARRAYS];
    if (!world->dem.joint_faces) return GNEISS_OK;
    list_joints(world->dem.joint_faces, arrays);
    return gn_checkpoint_put_arrays(file, arrays, ARRAYS, error);
}

/* Tells whether the indices of a face are within the arrays that they refer to. */
static bool is_sound(const gn_joint_faces *faces, const gn_joint_face *f, size_t joints) {
    return f->joint >= 0 && (size_t)f->joint < joints && f->patch >= 0 &&
           (size_t)f->patch < faces->patch_count && f->corner_count >= 0 && f->first_corner >= 0 &&
           (size_t)f->first_corner + (size_t)f->corner_count <= faces->corner_count;
}

gneiss_status gn_checkpoint_get_joints(gn_world *world, const gn_h5 *file, const char *path,
                                       gneiss_error *error) {
    gn_dem *dem = &world->dem;
    gn_checkpoint_array arrays[ARRAYS];
    const size_t joints = world->ctx.scene.joint_count;
    if (!joints) return GNEISS_OK;
    GN_TRY(gn_new(&dem->joint_faces, 1, "joints", error));
    gn_joint_faces *f = dem->joint_faces;
    GN_TRY(gn_h5_rows(file, "arrays/joint_faces", &f->count, error));
    GN_TRY(gn_h5_rows(file, "arrays/joint_corners", &f->corner_count, error));
    GN_TRY(gn_h5_rows(file, "arrays/joint_patches", &f->patch_count, error));
    list_joints(f, arrays);
    GN_TRY(gn_checkpoint_get_arrays(file, arrays, ARRAYS, error));
    bool sound = true;
    for (size_t k = 0; k < f->count; k++) sound = sound && is_sound(f, &f->face[k], joints);
    const gn_contacts *list = &dem->joints.contacts;
    for (size_t c = 0; c < list->soa.count; c++)
        sound = sound && list->joint[c] >= 0 && (size_t)list->joint[c] < f->count;
    if (sound) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected numbers of faces of joints, found others", path);
}
