/* What the checks of several files share. */
#ifndef GN_SCENE_CHECK_H
#define GN_SCENE_CHECK_H

#include "scene/read.h"

/* Where a check is: an element of a list with its prefix ("walls[2]."), or the whole scene. */
typedef struct check {
    const gn_reader *reader;
    const gn_node *map;
    char prefix[64];
} check;

/* Element `index` of the list at a path such as "elements.motions". */
check gn_check_element(const gn_reader *reader, const gn_node *root, const char *list,
                       size_t index);

/* Fails at the value of `key`, or, when it is not given, at the section around it; "" is the
 * element that the check is about. */
gneiss_status gn_check_fail(const check *section, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

bool gn_check_given(const check *section, const char *key);

/* Fails when a value that `reason` ("by softening energy") asks for is not above 0. */
gneiss_status gn_check_need(const check *section, double value, const char *key,
                            const char *reason);

/* Keeps what is wrong and goes on; returns what cannot be gone on from. */
gneiss_status gn_check_keep(const check *section, gneiss_status status);

/* Whether nothing was found to be wrong with a key of the scene, or with anything above or below
 * it; whether all names of a list were read. What is not sound is not checked further. */
bool gn_check_sound(const check *section, const char *path);
bool gn_check_named(const check *section, const char *list);
/* Of the element of a list that the check is about. */
bool gn_check_element_sound(const check *section);

/* The name of a material. */
gneiss_status gn_check_material_name(const check *section, const gn_scene *scene, const char *key,
                                     const char *name);

/* What is drawn for bonds, `key` of a material; an element of `contacts`; gamma of `law`
 * (check_contacts.c). */
gneiss_status gn_check_scatter(const check *section, const char *key, const gn_scatter *scatter);
gneiss_status gn_check_contact(const check *section, const gn_scene *scene, size_t index);
gneiss_status gn_check_gamma(const check *section, const gn_scene *scene);

/* Corners in order; `key` is that of the upper one. */
gneiss_status gn_check_box(const check *section, const gn_scene *scene, const char *key,
                           const double *low, const double *high);

/* How the sides of a periodic box move (check_box.c). */
gneiss_status gn_check_box_sides(const check *section, const gn_scene *scene);

/* Nothing prescribed out of the plane of a 2D scene. */
gneiss_status gn_check_plane_motion(const check *section, const gn_scene *scene,
                                    const gn_motion *motion);

/* How bonds of a material soften and yield, with bonds; and what does not go with that. */
gneiss_status gn_check_bonds_of(const check *section, const gn_scene *scene,
                                const gn_material *material);
gneiss_status gn_check_coupling(const check *section, const gn_scene *scene);
/* Of an element of `contacts`: a tangential spring where the law of bonds needs one. */
gneiss_status gn_check_shear_of_pair(const check *section, const gn_scene *scene,
                                     const gn_contact_def *contact);
/* Hertz's law, and resistance to rolling: what goes beside them; of a material. */
gneiss_status gn_check_hertz(const check *section, const gn_scene *scene);
gneiss_status gn_check_hertz_material(const check *section, const gn_material *material);
/* What a wall, a body or the surface of elements says of its contacts; `prefix` of its keys. */
typedef struct gn_side_keys {
    double stiffness, kratio, friction, rolling, twisting;
    const char *material;
    bool body; /* with Hertz's law it may have a stiffness besides */
} gn_side_keys;
gneiss_status gn_check_side(const check *section, const gn_scene *scene, const char *prefix,
                            gn_side_keys side);
/* Bonds that carry moments. */
gneiss_status gn_check_moments(const check *section, const gn_scene *scene);

/* The section `test` and the conditions that end one (check_test.c). */
gneiss_status gn_check_test(const check *section, gn_scene *scene);
/* Of a test of one stage: ends that only ever go against its sense, where nothing else could give
 * it a stress (check_stages.c). */
gneiss_status gn_check_parting(const check *section, const gn_scene *scene);

/* Of a hydrostatic test: whether anything presses, in any stage. */
gneiss_status gn_check_pressed(const check *section, bool presses);
/* The section `membrane`. */
gneiss_status gn_check_membrane(const check *section, const gn_scene *scene);

/* What `output.fields` asks for (check_output.c). */
gneiss_status gn_check_output(const check *section, gn_scene *scene);
/* Whether the scene, or any of its stages, has what the fields that were asked for are of. */
gneiss_status gn_check_asked(const check *section, const gn_scene *scene);
/* What `time` says of steps (check_time.c). */
gneiss_status gn_check_time(const check *section, const gn_scene *scene);
/* The first key of time.stop that is given; NULL: none. */
const char *gn_check_stop(const gn_scene *scene);

/* Makes a unit vector of it; false: it has no direction. */
bool gn_check_direction(double vector[3]);

/* Keeps notes of keys that change nothing in a scene in which nothing is wrong (check_idle.c). */
void gn_note_idle_keys(const gn_reader *reader, const gn_node *root);

/* Tells whether some contacts of a material have a tangential spring (check_contacts.c); friction
 * that none can carry is refused. */
bool gn_material_has_spring(const gn_scene *scene, const gn_material *material);
gneiss_status gn_check_grip(const check *section, const gn_scene *scene,
                            const gn_material *material);

/* A sieve curve, `wanted` by `sizes`: sizes and shares grow, from a share of 0 to [1, 1]; `section`
 * is what stands before its keys (check_flow.c). */
gneiss_status gn_check_sieve(const check *checked, const char *section, bool wanted,
                             const double *row, size_t count);

/* The lists `sources` and `sinks`, which may be empty (check_flow.c). */
gneiss_status gn_check_flow(const gn_reader *reader, const gn_node *root);

/* The list `bodies`, which may be empty. */
gneiss_status gn_check_bodies(const gn_reader *reader, const gn_node *root);

/* The section `couple` and the wave at the start, if they are given (check_couple.c). */
gneiss_status gn_check_couple(const gn_reader *reader, const gn_node *root);

/* The section `elements`, which is given. */
gneiss_status gn_check_elements(const gn_reader *reader, const gn_node *root);

#endif
