/* Functions that several files of checks share. */
#ifndef GN_SCENE_CHECK_H
#define GN_SCENE_CHECK_H

#include "scene/read.h"

/* Scope of a check: an element of a list with its prefix ("walls[2]."), or the whole scene. */
typedef struct check {
    const gn_reader *reader;
    const gn_node *map;
    char prefix[64];
} check;

/* Returns the scope of element `index` of the list at a path such as "elements.motions". */
check gn_check_element(const gn_reader *reader, const gn_node *root, const char *list,
                       size_t index);

/* Checks an element of a list. gn_check_list calls it for those that were read without problems,
 * and keeps their problems. */
typedef gneiss_status gn_check_one(const check *section, const gn_scene *scene, size_t index);
gneiss_status gn_check_list(const check *section, const char *list, size_t count,
                            gn_check_one *one);

/* Fails with the place of the value of `key`, or, if it is not given, of the section around it; ""
 * stands for the checked element. */
gneiss_status gn_check_fail(const check *section, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Fails because `key` has no meaning without something else: "KEY: needs a specimen; found
 * elements only". `format` and its arguments give what it needs. */
gneiss_status gn_check_needs(const check *section, const char *key, const char *found,
                             const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Refuses the name of an element if it is taken. */
gneiss_status gn_check_name(const check *section, bool taken, const char *name);

bool gn_check_given(const check *section, const char *key);

/* Keeps a problem if a value is not above 0 although `reason` ("by softening energy") requires it,
 * so that all missing keys are reported together. */
gneiss_status gn_check_required(const check *section, double value, const char *key,
                                const char *reason);

/* Keeps an input error so that checking continues; returns any other failure. */
gneiss_status gn_check_keep_problem(const check *section, gneiss_status status);

/* gn_check_is_valid: true if no problem was found with a key of the scene, nor with a key above or
 * below it. gn_check_names_are_valid: true if all names of a list were read. Keys with problems are
 * not checked further. */
bool gn_check_is_valid(const check *section, const char *path);
bool gn_check_names_are_valid(const check *section, const char *list);
/* True if no problem was found with the checked element of a list. */
bool gn_check_element_is_valid(const check *section);

/* Checks that `name` is the name of a material. */
gneiss_status gn_check_material_name(const check *section, const gn_scene *scene, const char *key,
                                     const char *name);

/* Check a key of a material that is drawn for each bond, an element of `contacts`, and gamma of
 * `law` (check_law.c). */
gneiss_status gn_check_scatter(const check *section, const char *key, const gn_scatter *scatter);
gneiss_status gn_check_contact(const check *section, const gn_scene *scene, size_t index);
gneiss_status gn_check_gamma(const check *section, const gn_scene *scene);

/* Checks that the corners are in order; `key` is that of the upper corner. */
gneiss_status gn_check_box(const check *section, const gn_scene *scene, const char *key,
                           const double *low, const double *high);

/* Checks the motion of the sides of a periodic box (check_law.c). */
gneiss_status gn_check_box_sides(const check *section, const gn_scene *scene);
/* Tells whether two tables have the same values. */
bool gn_targets_agree(const gn_table *first, const gn_table *second);

/* Checks that no motion is prescribed out of the plane of a 2D scene. */
gneiss_status gn_check_plane_motion(const check *section, const gn_scene *scene,
                                    const gn_motion *motion);

/* Checks softening and yield of the bonds of a material and their combination with other keys. */
gneiss_status gn_check_bonds_of(const check *section, const gn_scene *scene,
                                const gn_material *material);
gneiss_status gn_check_coupling(const check *section, const gn_scene *scene);
/* Checks Hertz's law, resistance to rolling, and the keys of a material for them. */
gneiss_status gn_check_hertz(const check *section, const gn_scene *scene);
gneiss_status gn_check_hertz_material(const check *section, const gn_material *material);
/* Contact parameters of a wall, a body or the surface of elements; `prefix` is that of their keys.
 */
typedef struct gn_side_keys {
    double stiffness, kratio, friction, rolling, twisting;
    const char *material;
    bool body; /* by Hertz's law the object may also have a stiffness */
} gn_side_keys;
gneiss_status gn_check_side(const check *section, const gn_scene *scene, const char *prefix,
                            gn_side_keys side);
/* Checks bonds that carry moments. */
gneiss_status gn_check_moments(const check *section, const gn_scene *scene);

/* Checks the section `test` and the conditions that end a test (check_test.c). */
gneiss_status gn_check_test(const check *section, gn_scene *scene);
/* Refuses a test of one stage whose ends only move against its sense while nothing else can cause a
 * stress (check_stages.c). */
gneiss_status gn_check_separating_ends(const check *section, const gn_scene *scene);

/* Checks that something presses on the specimen of a hydrostatic test in some stage. */
gneiss_status gn_check_hydrostatic_load(const check *section, bool presses);
/* Checks the section `membrane`. */
gneiss_status gn_check_membrane(const check *section, const gn_scene *scene);

/* Checks `output.fields` (check_lists.c). */
gneiss_status gn_check_output(const check *section, gn_scene *scene);
/* Checks that the scene, or one of its stages, has the records of the requested fields. */
gneiss_status gn_check_requested_fields(const check *section, const gn_scene *scene);
/* Checks the steps of `time` (check_lists.c). */
gneiss_status gn_check_time(const check *section, const gn_scene *scene);
/* Returns the first given key of time.stop; NULL: none. */
const char *gn_check_stop(const gn_scene *scene);

/* Normalises the vector; returns false if it has no direction. */
bool gn_check_direction(double vector[3]);

/* Adds notes on keys that change nothing in a scene without problems (check_idle.c). */
void gn_note_idle_keys(const gn_reader *reader, const gn_node *root);

/* True if some contacts of a material have a tangential spring (check_law.c); friction that
 * none can carry is refused. */
bool gn_material_has_spring(const gn_scene *scene, const gn_material *material);
gneiss_status gn_check_grip(const check *section, const gn_scene *scene,
                            const gn_material *material);

/* Checks a sieve curve, which `sizes` requires if `wanted`: sizes increase, and shares do not
 * decrease, from a share of 0 to [1, 1]. `section` is the prefix of its keys (check_lists.c). */
gneiss_status gn_check_sieve(const check *checked, const char *section, bool wanted,
                             const double *row, size_t count);

/* Checks the lists `sources` and `sinks`, which may be empty (check_lists.c). */
gneiss_status gn_check_flow(const gn_reader *reader, const gn_node *root);

/* Checks the list `joints`, which may be empty (check_joints.c). */
gneiss_status gn_check_joints(const gn_reader *reader, const gn_node *root);

/* Checks the section `clumps` if it is given (check_clumps.c). */
gneiss_status gn_check_clumps(const gn_reader *reader, const gn_node *root);

/* Checks the list `bodies`, which may be empty. */
gneiss_status gn_check_bodies(const gn_reader *reader, const gn_node *root);

/* Checks the section `couple` and the initial wave if they are given (check_elements.c). */
gneiss_status gn_check_couple(const gn_reader *reader, const gn_node *root);

/* Checks the section `elements`, which is given. */
gneiss_status gn_check_elements(const gn_reader *reader, const gn_node *root);

#endif
