/* gneiss: bonded discrete elements for rock and concrete. The public C API.
 *
 * Three kinds of reader:
 *   users of the API    this header is all there is to know; examples/ shows it at work
 *   writers of laws     src/kernels/contact_law.h, and "Add a contact law" in CONTRIBUTING.md
 *   the core            docs/design.md, then src/world/world.h and src/world/step.c
 *
 * Order of calls:
 *     gneiss_scene_load(path, ...)      reads, checks and resolves a scene file
 *     gneiss_world_create(scene, ...)   makes particles, bonds, lists and the time step
 *     gneiss_world_step / _run          advance the world
 *     gneiss_world_field / _reading / _energy / _history    read it
 *     gneiss_world_add_call / _add_force / _set_*           act on it
 *     gneiss_world_free, gneiss_scene_free
 *
 * Units are SI throughout. 2D models are of unit thickness. Tension is positive in stresses,
 * strains and bond forces; laboratory readings are positive in the sense of their test.
 *
 * Errors: a call that can fail returns a gneiss_status and, unless `error` is NULL, fills it with a
 * message (gneiss/status.h). A call that fails allocates nothing and leaves its outputs NULL or
 * unchanged. A NULL that is not allowed is GNEISS_ERROR_INPUT. Calls that return a number instead
 * of a status return 0 for a NULL handle.
 *
 * Threads: worlds share nothing, so that different threads may step different worlds at the same
 * time. Calls that read or write files (scenes, checkpoints, and every advance of a world that has
 * an output folder) must not overlap: HDF5 and UDUNITS-2 are not thread-safe. Only one thread at a
 * time may use a world. run.threads of its scene is the number of threads that a world uses. */
#ifndef GNEISS_GNEISS_H
#define GNEISS_GNEISS_H

#include "gneiss/status.h"

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define GNEISS_API __attribute__((visibility("default")))
#else
#define GNEISS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gneiss_scene gneiss_scene;
typedef struct gneiss_world gneiss_world;

/* The version, "0.1.0"; compiler and kind of build; name of a status, "input error" for
 * GNEISS_ERROR_INPUT. Never NULL. */
GNEISS_API const char *gneiss_version(void);
GNEISS_API const char *gneiss_build(void);
GNEISS_API const char *gneiss_status_name(gneiss_status status);

/* --- scenes ------------------------------------------------------------------------------------
 */

/* Reads a scene file. `overrides` [override_count]: "key=value" strings as for `gneiss run --set`,
 * such as "time.end=2 ms" or "walls.top.motion.vz=-0.05"; NULL with a count of 0. Relative paths in
 * the file start at its folder. GNEISS_ERROR_IO: an existing file cannot be opened or read.
 * GNEISS_ERROR_INPUT: the file is missing; or it, or an override, is invalid: the message states
 * file:line:column, key, expected and found value, one line per problem, up to the length of a
 * message. The caller frees *scene. */
GNEISS_API gneiss_status gneiss_scene_load(const char *path, const char *const *overrides,
                                           size_t override_count, gneiss_scene **scene,
                                           gneiss_error *error);

/* Reads a scene from text in memory, with overrides and errors as gneiss_scene_load. `name` appears
 * in messages and, like the name of a scene file, identifies the owner of results in an output
 * folder; NULL: "scene". `folder`: start of relative paths; NULL: the working folder. The caller
 * frees *scene. */
GNEISS_API gneiss_status gneiss_scene_parse(const char *text, const char *name, const char *folder,
                                            const char *const *overrides, size_t override_count,
                                            gneiss_scene **scene, gneiss_error *error);

/* Returns the resolved scene as YAML: SI units, every default filled in. The text belongs to the
 * scene. NULL for NULL. */
GNEISS_API const char *gneiss_scene_text(const gneiss_scene *scene);

/* Permits (1) or forbids (0, the default) that gmsh meshes a specimen given as geometry (.geo,
 * .step, .brep, .iges): a geometry can make gmsh execute any command. NULL is allowed. */
GNEISS_API void gneiss_scene_allow_gmsh(gneiss_scene *scene, int allow);

/* Frees a scene. NULL is allowed. Worlds made from the scene do not need it. */
GNEISS_API void gneiss_scene_free(gneiss_scene *scene);

/* A key of scene files. */
typedef struct gneiss_key {
    char path[128];    /* "materials[].friction"; [] stands for an element of a list */
    char value[256];   /* accepted values, in words: "number, Pa, in (0, inf)", "on, off" */
    char fallback[64]; /* default as written in a file; "": none */
    const char
        *kind;        /* "number", "integer", "text", "choice", "vector", "tables" (a vector of
                         tables), "spin", "table", "numbers", "rows", "names", "tree", "section", "list" */
    const char *unit; /* SI unit of numbers; "1": none */
    const char *word; /* word accepted instead of a value, such as "auto"; "": none */
    const char *text; /* meaning, one line */
    int32_t required; /* 1: a section without the key is an error */
} gneiss_key;

/* Writes the key at a place in the list of all, sections before the keys in them. The texts are
 * static. GNEISS_ERROR_INPUT: there are no more. */
GNEISS_API gneiss_status gneiss_key_at(size_t index, gneiss_key *key, gneiss_error *error);

/* --- worlds ------------------------------------------------------------------------------------
 */

/* Builds particles, bonds and lists, and chooses the time step. The scene is copied. `folder`:
 * place of results, snapshots and checkpoints (docs/results.md); "": the scene's output.directory,
 * else runs/<scene name>; NULL: nothing is written. Files that an earlier run of the same scene
 * file left in the folder are removed; the folder is locked until gneiss_world_free.
 * GNEISS_ERROR_INPUT: the specimen or a given time step is invalid, the folder is in use, holds
 * results of another scene, or holds files of other programs under names of the run's files.
 * GNEISS_ERROR_IO: the specimen cannot be read, or the folder cannot be written. The caller frees
 * *world. */
GNEISS_API gneiss_status gneiss_world_create(const gneiss_scene *scene, const char *folder,
                                             gneiss_world **world, gneiss_error *error);

/* Frees a world without writing anything. NULL is allowed. */
GNEISS_API void gneiss_world_free(gneiss_world *world);

/* Takes exactly `steps` >= 0 steps, also beyond time.end and the stop conditions; fewer only if a
 * hook ends the advance (GNEISS_INTERRUPTED). History rows, and
 * with an output folder snapshots and checkpoints, are made when due. GNEISS_ERROR_UNSTABLE: the
 * run became invalid (NaN, lost particle, step above its limit, residual of the energy ledger above
 * run.residual_limit); with an output folder the invalid state is in failed_*.hdf and results.h5.
 * The world can still be read, but every further advance or save is refused with the same message.
 * GNEISS_ERROR_IO: an output could not be written; the world is valid and the call may be repeated.
 */
GNEISS_API gneiss_status gneiss_world_step(gneiss_world *world, int64_t steps, gneiss_error *error);

/* Runs for about `seconds` >= 0 of wall time, or until time.end or a stop condition is reached
 * (gneiss_progress.finished), for programs that show progress. Errors are those of
 * gneiss_world_step. */
GNEISS_API gneiss_status gneiss_world_advance(gneiss_world *world, double seconds,
                                              gneiss_error *error);

/* Writes the last snapshot, a checkpoint, results.h5 and summary.json to the output folder, if
 * there is one. GNEISS_ERROR_UNSTABLE: all files are written, but the residual of the energy ledger
 * is above run.residual_limit. */
GNEISS_API gneiss_status gneiss_world_finish(gneiss_world *world, gneiss_error *error);

/* Runs until time.end or a stop condition is reached, and then finishes as gneiss_world_finish. */
GNEISS_API gneiss_status gneiss_world_run(gneiss_world *world, gneiss_error *error);

/* --- saving and resuming -----------------------------------------------------------------------
 */

/* Writes the whole state to one file, under a temporary name first. A world loaded from it
 * continues with the same bits as this one. */
GNEISS_API gneiss_status gneiss_world_save(const gneiss_world *world, const char *path,
                                           gneiss_error *error);

/* Writes a checkpoint into the world's output folder, which keeps the newest two, and updates
 * results.h5. GNEISS_ERROR_INPUT: there is no output folder. */
GNEISS_API gneiss_status gneiss_world_checkpoint(gneiss_world *world, gneiss_error *error);

/* Continues from a file of gneiss_world_save or a checkpoint of a run, without an output folder.
 * Neither the scene nor the specimen file is needed. `overrides`: only time.*, output.* and run.*;
 * all but run.threads may change the continuation. GNEISS_ERROR_IO: the file cannot be opened.
 * GNEISS_ERROR_INPUT: it is not a checkpoint, or damaged. The caller frees *world. */
GNEISS_API gneiss_status gneiss_world_load(const char *path, const char *const *overrides,
                                           size_t override_count, gneiss_world **world,
                                           gneiss_error *error);

/* Continues from the newest readable checkpoint in the output folder of a run, in that folder, with
 * overrides as gneiss_world_load. GNEISS_ERROR_INPUT: there is no such folder, or no checkpoint in
 * it. The caller frees *world. */
GNEISS_API gneiss_status gneiss_world_resume(const char *folder, const char *const *overrides,
                                             size_t override_count, gneiss_world **world,
                                             gneiss_error *error);

/* Returns the name of a newer but damaged checkpoint that gneiss_world_resume skipped; "": none, or
 * NULL. The text belongs to the world. */
GNEISS_API const char *gneiss_world_note(const gneiss_world *world);

/* --- progress and counts -----------------------------------------------------------------------
 */

typedef struct gneiss_progress {
    int64_t step;        /* steps taken */
    double time, end;    /* s; now and time.end */
    double dt;           /* s; the coming step */
    double wall_seconds; /* s, including the time before a resume */
    double eta;          /* s of wall time to `end`, or to the strain that ends a test; NaN before
                            the first step */
    double unbalanced;   /* mean resultant over mean contact force, as in the history */
    double energy_residual;  /* unexplained part of the ledger over the work; NaN without ledger */
    double stress, strain;   /* Pa, 1: of the test; NaN without */
    int32_t finished;        /* 1: time.end or a stop condition was reached */
    const char *stop_reason; /* "" while the run is unfinished; belongs to the world */
    int32_t stage, stages;   /* present stage, base 0, and their number; 0 and 0: none */
    const char *stage_name;  /* ""; belongs to the world */
} gneiss_progress;

/* Returns the progress of a run. `unbalanced`, `energy_residual`, `stress` and `strain` are those
 * of the last history row. */
GNEISS_API gneiss_status gneiss_world_progress(const gneiss_world *world, gneiss_progress *progress,
                                               gneiss_error *error);

typedef struct gneiss_limits {
    double dt;         /* s; the step in use */
    double stable;     /* s; limit that the step is compared with */
    double sharp;      /* s; 2/w_max by Lanczos iteration, contact damping included */
    double bound;      /* s; rigorous bound, never above the true limit */
    double literature; /* s; min_i 2 sqrt(m_i/k_i), one spring per particle: not safe */
} gneiss_limits;

/* Returns the limits of the last estimate; INFINITY without contacts. */
GNEISS_API gneiss_status gneiss_world_limits(const gneiss_world *world, gneiss_limits *limits,
                                             gneiss_error *error);

typedef struct gneiss_counts {
    int64_t particles, bonds, pairs,
        wall_contacts; /* items of the records; broken bonds included */
    int64_t walls, sets;
    int64_t broken_tension, broken_shear; /* bonds */
    int64_t removed;                      /* particles that left the domain */
    int64_t list_rebuilds;
    int64_t history_rows;
} gneiss_counts;

GNEISS_API gneiss_status gneiss_world_counts(const gneiss_world *world, gneiss_counts *counts,
                                             gneiss_error *error);

/* Finite elements, and particles that replace them (couple.convert). */
typedef struct gneiss_element_counts {
    int64_t nodes, elements; /* present ones */
    int64_t asleep; /* dormant particles inside present elements; included in gneiss_counts */
} gneiss_element_counts;

GNEISS_API gneiss_status gneiss_world_element_counts(const gneiss_world *world,
                                                     gneiss_element_counts *counts,
                                                     gneiss_error *error);

/* Steps taken; time in s; hash of the state, equal for equal bits (for any number of threads and
 * any instruction set, saved and loaded or not). 0 for NULL. */
GNEISS_API int64_t gneiss_world_steps(const gneiss_world *world);
GNEISS_API double gneiss_world_time(const gneiss_world *world);
GNEISS_API uint64_t gneiss_world_hash(const gneiss_world *world);

/* --- fields ------------------------------------------------------------------------------------
 */

typedef enum gneiss_record {
    GNEISS_PARTICLES = 0,
    GNEISS_BONDS = 1,         /* formed by the scene; a broken one stays in the list */
    GNEISS_PAIRS = 2,         /* neighbours without a bond, in contact or not */
    GNEISS_WALL_CONTACTS = 3, /* particles near walls */
    GNEISS_NODES = 4,         /* nodes of finite elements */
    GNEISS_ELEMENTS = 5       /* triangles or tetrahedra */
} gneiss_record;

typedef enum gneiss_type {
    GNEISS_F64 = 0, /* double */
    GNEISS_I64 = 1, /* int64_t */
    GNEISS_I32 = 2, /* int32_t */
    GNEISS_U8 = 3,  /* uint8_t */
    GNEISS_F32 = 4  /* float */
} gneiss_type;

/* A view of an array. Component c of item k is at
 *     (const char *)data + k * item_stride + c * component_stride
 * `data` is valid until the world is advanced or freed, the texts until it is freed. It is the
 * state itself, not a copy, and must not be written to. An advance may reorder items; the field
 * `id` of particles, their index in the specimen, base 0, is constant. */
typedef struct gneiss_view {
    const char *name;        /* "pos" */
    const char *unit;        /* "m"; several units if components differ */
    const char *description; /* "centre x y z, radius" */
    gneiss_type type;
    int32_t components;
    size_t count;                         /* items */
    size_t item_stride, component_stride; /* bytes */
    const void *data;
} gneiss_view;

/* "particles", "bonds", "pairs", "wall_contacts", "nodes", "elements"; NULL for anything else. */
GNEISS_API const char *gneiss_record_name(gneiss_record record);

/* Number of fields of a record in this world, which depends on the scene. 0 for NULL or an invalid
 * record. */
GNEISS_API size_t gneiss_world_field_count(const gneiss_world *world, gneiss_record record);

/* Writes the origin of the computation, m (key `origin`; docs/scene.md). Views of positions (`pos`,
 * `start`, `ref`) are relative to it: add it to get coordinates of the scene file. It is zero
 * unless the model lies far from 0 or the scene gives it. */
GNEISS_API gneiss_status gneiss_world_origin(const gneiss_world *world, double origin[3],
                                             gneiss_error *error);

/* Returns a field by name, or by index in [0, gneiss_world_field_count). Particles always have
 * `pos` [4] (x y z relative to the origin, radius, m), `vel` [4] (velocity at the last half step,
 * m/s, and inverse mass, 1/kg; 0: removed) and `id`; contacts `i`, `j` (particles, in their present
 * order) and `kn` (N/m). Other fields depend on the scene. GNEISS_ERROR_INPUT: no such record or
 * field; the message lists the existing ones. */
GNEISS_API gneiss_status gneiss_world_field(const gneiss_world *world, gneiss_record record,
                                            const char *name, gneiss_view *view,
                                            gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_field_at(const gneiss_world *world, gneiss_record record,
                                               size_t index, gneiss_view *view,
                                               gneiss_error *error);

/* Keeps the memory at view->data readable also after the world was advanced or freed: once the
 * world has moved its items to other memory, it keeps the values that it had then. To be undone by
 * gneiss_view_unpin(data), once for each pin. GNEISS_ERROR_INPUT: there is no data. */
GNEISS_API gneiss_status gneiss_view_pin(const gneiss_view *view, gneiss_error *error);
GNEISS_API void gneiss_view_unpin(const void *data);

/* Returns element (item, component) of a view of any type as a double; NaN outside of it or for
 * NULL. Loops are faster over `data`. */
GNEISS_API double gneiss_view_value(const gneiss_view *view, size_t item, size_t component);

/* --- acting on a run ---------------------------------------------------------------------------
 */

/* Particles of a specimen before masses, bonds and lists are made. */
typedef struct gneiss_specimen {
    size_t count;
    double *position;  /* [count][4] m: centre x y z (2D: z = 0) relative to `origin`; radius > 0 */
    int32_t *material; /* [count] place in the scene's list of materials, base 0 */
    int32_t *group;    /* [count] cohesive group, at least 0; 0: without bonds */
    double origin[3];  /* m: position + origin is where the scene file has the particle */
} gneiss_specimen;

/* Changes a specimen in place. Returns 0; anything else refuses it. */
typedef int gneiss_prepare(void *context, gneiss_specimen *specimen);

/* Has `prepare` called by gneiss_world_create for worlds made from the scene, before sets assign
 * materials and groups; NULL: no longer. Checks of the scene apply to what it leaves:
 * gneiss_world_create returns GNEISS_ERROR_INPUT for a radius or place that is not finite or out of
 * range, an unknown material, a negative group, and where `prepare` returns another number than 0.
 */
GNEISS_API void gneiss_scene_prepare(gneiss_scene *scene, gneiss_prepare *prepare, void *context);

/* A function that is called between two steps. It may read, save and set the world, and add and
 * remove hooks, but not advance, finish or free it. Returns 0 to go on. After any other number the
 * advance returns GNEISS_INTERRUPTED, and the world may be advanced again. */
typedef int gneiss_call(void *context, gneiss_world *world);

/* Has `call` called after every step whose number (gneiss_world_steps) is a multiple of `every`
 * (0: none), and after the step that ends nearest to each of times[time_count], s, rising (copied);
 * past times are left out. *hook: for gneiss_world_remove_hook. Hooks are not part of the state: a
 * saved world has none. GNEISS_ERROR_INPUT: every < 0, or times that do not rise. */
GNEISS_API gneiss_status gneiss_world_add_call(gneiss_world *world, int64_t every,
                                               const double *times, size_t time_count,
                                               gneiss_call *call, void *context, int64_t *hook,
                                               gneiss_error *error);

/* Particles or nodes at the instant of the forces, in their present order. */
typedef struct gneiss_points {
    size_t count;
    double time;            /* s */
    const double *position; /* [count][4] m: centre x y z relative to the origin, radius */
    const double *velocity; /* [count][4] m/s, 1/kg: of the last half step, inverse mass */
    const double *spin;     /* [count][4] rad/s, 1/(kg m2); NULL without rotation */
    const int32_t *id;      /* [count]; of nodes the node of the given mesh, base 0 */
    double *force;          /* [count][3] N, zeros on entry */
    double *moment;         /* [count][3] N m, zeros on entry; NULL without rotation */
} gneiss_points;

/* Writes forces, and moments, on these points: `force` and `moment` of `points`. It is called once
 * in every step and may read the world, but not change it. Returns 0; after any other number the
 * world has failed. */
typedef int gneiss_force(void *context, const gneiss_points *points);

/* Adds a field of force on the items of a record: GNEISS_PARTICLES, or GNEISS_NODES of finite
 * elements. Its work is the term `work_user` of the energy ledger, trapezoidal as all works. Forces
 * on removed particles and, in 2D, out of the plane are ignored. `stiffness`, N/m, at least 0: the
 * largest by which the field stiffens the motion of an item (of a spring to a point its constant);
 * an automatic time step is lowered for it. GNEISS_ERROR_INPUT: the scene has no such items,
 * couples particles and elements, or has a periodic box that moves; a given time step is too long
 * for the stiffness; or a bad argument. */
GNEISS_API gneiss_status gneiss_world_add_force(gneiss_world *world, gneiss_record record,
                                                double stiffness, gneiss_force *force,
                                                void *context, int64_t *hook, gneiss_error *error);

/* Removes a call or a force. GNEISS_ERROR_INPUT: there is no such hook. */
GNEISS_API gneiss_status gneiss_world_remove_hook(gneiss_world *world, int64_t hook,
                                                  gneiss_error *error);

/* Sets the velocities of all particles, velocity[count][3] in m/s, and, unless NULL, their spins,
 * spin[count][3] in rad/s; in the order of the field `vel`. Prescribed components and removed
 * particles keep theirs. Lists follow, which may reorder items. The change of kinetic energy
 * is booked as `work_user`; before the first step it belongs to the initial state.
 * GNEISS_ERROR_INPUT: a wrong count, a number that is not finite or above 3e8, spins without
 * rotation, or particles that follow elements. */
GNEISS_API gneiss_status gneiss_world_set_velocities(gneiss_world *world, const double *velocity,
                                                     const double *spin, size_t count,
                                                     gneiss_error *error);

/* Sets one component of the motion of a wall, set or body (`name`) from the coming step on, instead
 * of what the scene says: component 0 1 2: velocity x y z, m/s; 3 4 5: spin, rad/s. It is part of
 * saved worlds. GNEISS_ERROR_INPUT: no such name; a wall under a servo; a component that the scene
 * leaves free (a velocity of 0 in the scene prescribes it); a scene with stages, which state
 * motions themselves; or a value that is not finite, or that moves it by more than a twentieth of
 * the smallest radius in a step. */
GNEISS_API gneiss_status gneiss_world_set_motion(gneiss_world *world, const char *name,
                                                 int component, double value, gneiss_error *error);

/* Ends the present stage of a scene with stages, whatever its conditions: the next one begins with
 * the coming step, and after the last one the run is finished. GNEISS_ERROR_INPUT: the scene has no
 * stages. */
GNEISS_API gneiss_status gneiss_world_end_stage(gneiss_world *world, gneiss_error *error);

/* --- outputs -----------------------------------------------------------------------------------
 */

/* Fields of every particle, bond, node or element in results.h5 (docs/quantities.md): "damage",
 * "stress", "coordination", "criterion", ... Pairs and wall contacts have none. By index in [0,
 * gneiss_world_output_count): *what gives name, unit, meaning, components and items, without data.
 * GNEISS_ERROR_INPUT: no such output. */
GNEISS_API size_t gneiss_world_output_count(const gneiss_world *world, gneiss_record record);
GNEISS_API gneiss_status gneiss_world_output_at(const gneiss_world *world, gneiss_record record,
                                                size_t index, gneiss_view *what,
                                                gneiss_error *error);

/* Computes an output for the present state and writes it into values[items][components], `count`
 * numbers in total; particles are in the order of the specimen, nodes and elements in that of the
 * mesh. Forces and stresses are those of the present positions. GNEISS_ERROR_INPUT: no such output,
 * or a wrong count. */
GNEISS_API gneiss_status gneiss_world_output(const gneiss_world *world, gneiss_record record,
                                             const char *name, double *values, size_t count,
                                             gneiss_error *error);

/* --- history, readings, energy -----------------------------------------------------------------
 */

/* Columns of the history: "step", "time", "stress", "wall_top_force_z", ... (docs/results.md), as
 * views of doubles with one component and a row per item. Rows are equally spaced in steps by
 * output.history_rows, from the first step on; in a run that a condition may end there are more,
 * and every second one is removed when there are twice as many as requested. By name, or by index
 * in [0, column count). The name in the view belongs to the world. GNEISS_ERROR_INPUT: no such
 * column. */
GNEISS_API size_t gneiss_world_history_count(const gneiss_world *world);
GNEISS_API gneiss_status gneiss_world_history(const gneiss_world *world, const char *name,
                                              gneiss_view *view, gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_history_at(const gneiss_world *world, size_t index,
                                                 gneiss_view *view, gneiss_error *error);

/* A number with its name. The texts are static. */
typedef struct gneiss_quantity {
    const char *name, *unit, *description;
    double value;
} gneiss_quantity;

/* Laboratory readings of the history so far: "young_modulus", "poisson_ratio", "peak_stress", ...;
 * the value is NaN if it cannot be read (no test, too few rows). By name, or by index in [0,
 * gneiss_reading_count). GNEISS_ERROR_INPUT: no such reading; the message lists them. */
GNEISS_API size_t gneiss_reading_count(void);
GNEISS_API gneiss_status gneiss_world_reading(const gneiss_world *world, const char *name,
                                              gneiss_quantity *reading, gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_reading_at(const gneiss_world *world, size_t index,
                                                 gneiss_quantity *reading, gneiss_error *error);

/* Terms of the energy ledger at the last measured instant, J: "kinetic", "elastic_normal",
 * "friction", ...; "stored_at_start"; and "residual" (1). History rows, the last step of a run and
 * few others are measured. Values are NaN with output.energy off or before the first row.
 * GNEISS_ERROR_INPUT: no such term. */
GNEISS_API size_t gneiss_energy_count(void);
GNEISS_API gneiss_status gneiss_world_energy(const gneiss_world *world, const char *name,
                                             gneiss_quantity *term, gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_energy_at(const gneiss_world *world, size_t index,
                                                gneiss_quantity *term, gneiss_error *error);
/* Steps done and time, s, at the instant of these terms, as the columns "step" and "time" of the
 * history. -1 and NaN: the terms are NaN, or a loaded world was last measured between two rows. */
GNEISS_API gneiss_status gneiss_world_energy_instant(const gneiss_world *world, int64_t *step,
                                                     double *time, gneiss_error *error);

#ifdef __cplusplus
}
#endif
#endif
