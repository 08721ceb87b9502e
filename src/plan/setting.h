/* A proposal as keys of the scene and their values. */
#ifndef GN_PLAN_SETTING_H
#define GN_PLAN_SETTING_H

#include "plan/propose.h"

enum { GN_SETTINGS_MAX = 192 };

typedef struct gn_settings {
    size_t count;
    gn_override setting[GN_SETTINGS_MAX]; /* both texts are owned */
} gn_settings;

/* Lists the settings that differ from the scene of the world. */
gneiss_status gn_settings_make(const gn_step_context *ctx, const gn_plan *plan,
                               const gn_proposal *proposal, gn_settings *settings,
                               gneiss_error *error);
gneiss_status gn_settings_add(gn_settings *settings, const char *key, const char *value,
                              gneiss_error *error);
void gn_settings_free(gn_settings *settings);

/* Returns the end of the run, s: that of the scene, but early enough that the peak lies between
 * rows of the history. */
double gn_plan_end(const gn_plan *plan, const gn_scene *scene, double pace);
/* Returns the rows of the history: those of the scene, and enough up to the peak to resolve it. */
double gn_plan_history_rows(const gn_plan *plan, const gn_scene *scene, double pace);

/* Returns the reason why the loading speed must not change, which is that another part of the scene
 * varies with time; NULL: it may change. */
const char *gn_plan_pace_refusal(const gn_scene *scene);

#endif
