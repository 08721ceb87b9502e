/* The output folder of a run: its choice, its lock, and the files that an earlier run left in
 * it. */
#ifndef GN_RUN_FOLDER_H
#define GN_RUN_FOLDER_H

#include "scene/scene.h"

/* Chooses `wanted`, else the scene's output.directory, else runs/<name of the scene file without
 * folder and ending>. A path that leaves no room for the names of files is GNEISS_ERROR_INPUT. */
gneiss_status gn_folder_choose(const gn_scene *scene, const char *wanted, char out[GN_PATH_SIZE],
                               gneiss_error *error);

/* A program that writes into a folder (run, resume, pack) holds this lock, which excludes other
 * writers until the descriptor is closed (also by the end of the process). *lock is 0 on file
 * systems without locks. GNEISS_ERROR_INPUT: another process holds the lock. */
gneiss_status gn_folder_lock(const char *directory, int *lock, gneiss_error *error);

/* Takes a shared lock, for writers that do not disturb each other (shards of a sweep); it excludes
 * only writers that need the folder alone. */
gneiss_status gn_folder_share(const char *directory, int *lock, gneiss_error *error);

/* Returns the wall time (s) of the finished run that wrote the results; 0: there are no
 * results, or their run did not finish. */
gneiss_status gn_folder_finished(const char *directory, double *seconds, gneiss_error *error);

/* Refuses a folder with files named like those of this program but without its results, checkpoints
 * or snapshots, because they were not written by it: GNEISS_ERROR_INPUT names the first of them.
 * The folder of several runs is refused as well. */
gneiss_status gn_folder_check(const char *directory, gneiss_error *error);
/* Checks the files that a packing replaces in the same way: packing.h5, packing.txt and its
 * snapshot. */
gneiss_status gn_folder_check_packing(const char *directory, gneiss_error *error);
bool gn_folder_holds_sweep(const char *directory);

/* Uses of a folder that exclude each other: otherwise files of one would seem to belong to the
 * other, and a run that is to be continued would lose files. */
typedef enum gn_folder_use {
    GN_FOLDER_OF_RUN,
    GN_FOLDER_OF_RUNS,
    GN_FOLDER_OF_PACKING
} gn_folder_use;
/* Refuses a folder that is in another use: GNEISS_ERROR_INPUT. */
gneiss_status gn_folder_check_use(const char *directory, gn_folder_use use, gneiss_error *error);

/* Removes the files of an earlier run of the same scene file, whatever program wrote them
 * (gn_folder_check is called before). Results of another scene are kept: GNEISS_ERROR_INPUT. */
gneiss_status gn_folder_clear(const char *directory, const gn_scene *scene, gneiss_error *error);

/* Refuses a checkpoint of another run than the one that wrote results.h5 and the other checkpoints
 * in the folder. Runs are compared by the scene file and by the scene without the keys that a
 * resumed run may change. Unreadable files are skipped. */
gneiss_status gn_folder_check_checkpoint(const char *directory, int64_t step, const int64_t *others,
                                         size_t count, gneiss_error *error);

#endif
