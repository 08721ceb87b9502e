/* A proposal as keys of the scene with their values. */
#ifndef GN_PLAN_SETTING_H
#define GN_PLAN_SETTING_H

#include "plan/propose.h"

enum { GN_SETTINGS_MAX = 192 };

typedef struct gn_settings {
    size_t count;
    gn_override setting[GN_SETTINGS_MAX]; /* both texts are owned */
} gn_settings;

/* What differs from the scene of the world. */
gneiss_status gn_settings_make(const gn_world *world, const gn_plan *plan,
                               const gn_proposal *proposal, gn_settings *settings,
                               gneiss_error *error);
gneiss_status gn_settings_add(gn_settings *settings, const char *key, const char *value,
                              gneiss_error *error);
void gn_settings_free(gn_settings *settings);

/* s: as far as the scene goes, but not so far that the peak falls between the rows of the history.
 */
double gn_plan_end(const gn_plan *plan, const gn_scene *scene, double pace);
/* As many as the scene has, and enough up to the peak that it does not fall between two of them. */
double gn_plan_history_rows(const gn_plan *plan, const gn_scene *scene, double pace);

/* Why the speed of the loading is not to be changed: something in the scene has a course of its own
 * in time. NULL: it may be. */
const char *gn_plan_no_pace(const gn_scene *scene);

#endif
