/* The contact lists of a model. Code that does not depend on the meaning of a list loops over them:
 * the sweep, the step limit, checkpoints, the state hash, the removal and renumbering of particles.
 * */
#ifndef GN_PARTICLES_CONTACT_LISTS_H
#define GN_PARTICLES_CONTACT_LISTS_H

#include "frame/parts.h"

#include "base/effects.h"
#include "base/error.h"
#include "kernels/contact.h"
#include "kernels/partials.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* X(NAME, name): the lists, in the order in which their forces and sums are added up. Each is a
 * member `name` of gn_dem, and gn_dem.list[GN_LIST_<NAME>]. */
#define GN_CONTACT_LISTS(X)                                                                        \
    X(BONDS, bonds)                                                                                \
    X(PAIRS, pairs)                                                                                \
    X(JOINTS, joints)

typedef enum gn_list_number {
#define X(NAME, name) GN_LIST_##NAME,
    GN_CONTACT_LISTS(X)
#undef X
        GN_LIST_COUNT
} gn_list_number;

typedef struct gn_contact_list {
    gn_contacts contacts;
    gn_partials partials;
    gn_contact_sums *sums; /* [partials.blocks] of the last step */
    gn_uniform uniform;
    gn_contact_kernel *kernel;
} gn_contact_list;

/* The properties of a list. */
typedef struct gn_list_kind {
    const char *record; /* name of its record in checkpoints */
    /* Its contacts stay in the list when the neighbour lists are rebuilt; otherwise the list is
     * rebuilt with them. */
    bool persistent;
    bool of_materials; /* its parameters follow from the materials of both ends and the law */
    /* Tells whether a scene has the list; NULL: all scenes. Elsewhere it stays empty. */
    bool (*used)(const gn_scene *scene);
    /* Returns the effects of the list, which select its law and its kernel. */
    gn_effects (*effects_of)(gn_effects scene_effects);
    /* Forms the contacts at the start, when particles are sorted, and sorts them; NULL: the list is
     * empty then. */
    gneiss_status (*form)(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
} gn_list_kind;

/* Each list defines its own kind. */
#define X(NAME, name) extern const gn_list_kind gn_list_kind_##name;
GN_CONTACT_LISTS(X)
#undef X

extern const gn_list_kind *const gn_list_kinds[GN_LIST_COUNT];

/* Tells whether the scene has list number `list`. */
bool gn_list_used(const gn_scene *scene, int list);

/* Forms the contacts of all lists at the start. */
gneiss_status gn_lists_form(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Creates a list that the scene has and that has no contacts. */
gneiss_status gn_list_create_empty(const gn_step_context *ctx, gn_dem *dem, int list,
                                   gneiss_error *error);

/* Completes a list whose contacts have changed: its padding and partial sums; the sums of its
 * blocks are allocated again with the neighbour lists. */
gneiss_status gn_list_changed(const gn_step_context *ctx, const gn_dem *dem, gn_contact_list *list,
                              gneiss_error *error);

/* Adapts all lists to other rows of particles: place[old] is the new row; NULL: rows have only been
 * added. Lists that are not persistent get their partial sums when they are rebuilt. */
gneiss_status gn_lists_follow_rows(const gn_step_context *ctx, gn_dem *dem, const int32_t *place,
                                   gneiss_error *error);

/* Chooses the kernels of all lists. */
gneiss_status gn_lists_choose_kernels(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Sets the effects of all lists to those of the stage; storage does not change. */
void gn_lists_set_effects(const gn_step_context *ctx, gn_dem *dem);

/* Returns the number of contacts in all lists. */
size_t gn_lists_count(const gn_dem *dem);

void gn_contact_list_free(gn_contact_list *list);

#endif
