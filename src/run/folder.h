/* The output folder of a run: which it is, whose it is, and what an earlier run left there. */
#ifndef GN_RUN_FOLDER_H
#define GN_RUN_FOLDER_H

#include "scene/scene.h"

/* `wanted`, else the scene's output.directory, else runs/<name of the scene file without folder and
 * ending>. A path that leaves no room for the names of files is GNEISS_ERROR_INPUT. */
gneiss_status gn_folder_choose(const gn_scene *scene, const char *wanted, char out[GN_PATH_SIZE],
                               gneiss_error *error);

/* Whoever writes into a folder (run, resume, pack) holds this lock: it keeps others out until the
 * descriptor is closed (also by the death of the process). *lock is 0 on file systems that cannot
 * lock. GNEISS_ERROR_INPUT when another holds it. */
gneiss_status gn_folder_lock(const char *directory, int *lock, gneiss_error *error);

/* The same for those that do not get in each other's way (shards of a sweep): they keep out whoever
 * asks for the folder alone. */
gneiss_status gn_folder_share(const char *directory, int *lock, gneiss_error *error);

/* Wall time of the finished run whose results are there, s; 0: there are none, or they are of a run
 * that did not come to its end. */
gneiss_status gn_folder_finished(const char *directory, double *seconds, gneiss_error *error);

/* A folder that holds files under names of this program's, but neither results nor a checkpoint nor
 * snapshots of it, is somebody else's: GNEISS_ERROR_INPUT names the first of them. That of a sweep
 * is none for a run either. */
gneiss_status gn_folder_check(const char *directory, gneiss_error *error);
/* The same of the files that a packing replaces: packing.h5, packing.txt and its snapshot. */
gneiss_status gn_folder_check_packing(const char *directory, gneiss_error *error);
bool gn_folder_holds_sweep(const char *directory);

/* Makes way for a new run: removes what an earlier run of the same scene file left, whoever wrote
 * it (gn_folder_check comes before). Results of another scene are not touched:
 * GNEISS_ERROR_INPUT. */
gneiss_status gn_folder_clear(const char *directory, const gn_scene *scene, gneiss_error *error);

/* Refuses a checkpoint of another run than the one that wrote results.h5 and the other checkpoints
 * in the folder: by the scene file and the scene without what a resumed run may change. Files that
 * cannot be read say nothing. */
gneiss_status gn_folder_check_checkpoint(const char *directory, int64_t step, const int64_t *others,
                                         size_t count, gneiss_error *error);

#endif
