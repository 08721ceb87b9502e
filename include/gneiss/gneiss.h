/* gneiss: bonded discrete elements for rock and concrete. The public C API.
 *
 * Three kinds of reader:
 *   users of the API    this header is all there is to know; examples/ shows it at work
 *   writers of laws     src/kernels/contact_law.h, and "Add a contact law" in CONTRIBUTING.md
 *   the core            docs/design.md, then src/world/world.h and src/world/step.c
 *
 * In short:
 *     gneiss_scene_load(path, ...)      what the scene file says, checked and resolved
 *     gneiss_world_create(scene, ...)   particles, bonds, lists, time step
 *     gneiss_world_step / _run          advance it
 *     gneiss_world_field / _reading / _energy / _history    look at it
 *     gneiss_world_free, gneiss_scene_free
 *
 * Units are SI throughout. 2D models are of unit thickness. Tension is positive in stresses,
 * strains and bond forces; laboratory readings are positive in the sense of their test.
 *
 * Errors: a call that can fail returns a gneiss_status and, unless `error` is NULL, fills it with a
 * message (gneiss/status.h). A call that fails holds nothing and leaves its outputs at NULL or
 * untouched. A NULL where one is not allowed is GNEISS_ERROR_INPUT. Calls that return a number
 * instead of a status return 0 for a NULL handle.
 *
 * Threads: nothing is shared between worlds, so that different threads may step different worlds at
 * the same time. Calls that read or write files (scenes, checkpoints, and every advance of a world
 * that has an output folder) must not overlap: HDF5 and UDUNITS-2 are not made for it. One world is
 * used by one thread at a time. How many threads a world uses itself is its scene's run.threads. */
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

/* "0.1.0"; compiler and kind of build; "input error" for GNEISS_ERROR_INPUT. Never NULL. */
GNEISS_API const char *gneiss_version(void);
GNEISS_API const char *gneiss_build(void);
GNEISS_API const char *gneiss_status_name(gneiss_status status);

/* --- scenes ------------------------------------------------------------------------------------
 */

/* Reads a scene file. `overrides` [override_count]: "key=value" strings as for `gneiss run --set`,
 * such as "time.end=2 ms" or "walls.top.motion.vz=-0.05"; NULL with a count of 0. Relative paths in
 * the file are taken from its folder.
 * GNEISS_ERROR_IO: a file that is there cannot be opened or read. GNEISS_ERROR_INPUT: it is not
 * there; or it, or an override, cannot be used: the message says file:line:column, key, expected,
 * found, a line for each thing that is wrong, up to the length of a message. The caller frees
 * *scene. */
GNEISS_API gneiss_status gneiss_scene_load(const char *path, const char *const *overrides,
                                           size_t override_count, gneiss_scene **scene,
                                           gneiss_error *error);

/* The same from text in memory. `name` stands in messages and, like the name of a scene file, for
 * whose results lie in an output folder; NULL: "scene". `folder`: where relative paths start; NULL:
 * the working folder. */
GNEISS_API gneiss_status gneiss_scene_parse(const char *text, const char *name, const char *folder,
                                            const char *const *overrides, size_t override_count,
                                            gneiss_scene **scene, gneiss_error *error);

/* The resolved scene as YAML: SI, every default filled in. Belongs to the scene. NULL for NULL. */
GNEISS_API const char *gneiss_scene_text(const gneiss_scene *scene);

/* Whether gmsh may mesh a specimen that is a geometry (.geo, .step, .brep, .iges). Not unless this
 * is called with 1: a geometry can make gmsh execute any command. NULL is allowed. */
GNEISS_API void gneiss_scene_allow_gmsh(gneiss_scene *scene, int allow);

/* NULL is allowed. Worlds made from the scene go on without it. */
GNEISS_API void gneiss_scene_free(gneiss_scene *scene);

/* --- worlds ------------------------------------------------------------------------------------
 */

/* Builds particles, bonds and lists, and chooses the time step. The scene is copied.
 * `folder`: where results, snapshots and checkpoints go (docs/results.md); "": the scene's
 * output.directory, else runs/<scene name>; NULL: nothing is written. What an earlier run of the
 * same scene file left in the folder is removed; the folder is locked until gneiss_world_free.
 * GNEISS_ERROR_INPUT: the specimen or a given time step cannot be used, the folder is in use or
 * holds results of another scene or files of somebody else where the run's would go.
 * GNEISS_ERROR_IO: the specimen cannot be read, the folder not be written. The caller frees
 * *world. */
GNEISS_API gneiss_status gneiss_world_create(const gneiss_scene *scene, const char *folder,
                                             gneiss_world **world, gneiss_error *error);

/* NULL is allowed. Writes nothing. */
GNEISS_API void gneiss_world_free(gneiss_world *world);

/* Takes exactly `steps` >= 0 steps, also past time.end and the stop conditions. History rows are
 * taken and, with an output folder, snapshots and checkpoints written as they fall due.
 * GNEISS_ERROR_UNSTABLE: the run went bad (NaN, lost particle, step above its limit, energy
 * ledger beyond run.residual_limit); with an output folder the bad state is in failed_*.hdf and
 * results.h5. The world can still be looked at, but every further advance or save is refused with
 * the same message. GNEISS_ERROR_IO: an output could not be written; the world is good and the call
 * may be repeated. */
GNEISS_API gneiss_status gneiss_world_step(gneiss_world *world, int64_t steps, gneiss_error *error);

/* Runs for about `seconds` >= 0 of wall time, or until time.end or a stop condition is reached
 * (gneiss_progress.finished), for programs that show progress. Errors as gneiss_world_step. */
GNEISS_API gneiss_status gneiss_world_advance(gneiss_world *world, double seconds,
                                              gneiss_error *error);

/* Writes last snapshot, checkpoint, results.h5 and summary.json to the output folder, if there is
 * one. GNEISS_ERROR_UNSTABLE: all is written, but the run has ended with an energy ledger beyond
 * run.residual_limit. */
GNEISS_API gneiss_status gneiss_world_finish(gneiss_world *world, gneiss_error *error);

/* Runs until time.end or a stop condition is reached, then as gneiss_world_finish. */
GNEISS_API gneiss_status gneiss_world_run(gneiss_world *world, gneiss_error *error);

/* --- saving and going on -----------------------------------------------------------------------
 */

/* Writes the whole state to one file, under a temporary name first. The saved world goes on to the
 * same bits as this one. */
GNEISS_API gneiss_status gneiss_world_save(const gneiss_world *world, const char *path,
                                           gneiss_error *error);

/* The same into the world's output folder, where the newest two checkpoints are kept; results.h5 is
 * brought up to date. GNEISS_ERROR_INPUT without an output folder. */
GNEISS_API gneiss_status gneiss_world_checkpoint(gneiss_world *world, gneiss_error *error);

/* Goes on from a file of gneiss_world_save or a checkpoint of a run; without an output folder.
 * Neither scene nor specimen file is needed. `overrides`: time.*, output.* and run.* only; all but
 * run.threads may change what follows.
 * GNEISS_ERROR_IO: the file cannot be opened. GNEISS_ERROR_INPUT: it is not a checkpoint, or
 * damaged. */
GNEISS_API gneiss_status gneiss_world_load(const char *path, const char *const *overrides,
                                           size_t override_count, gneiss_world **world,
                                           gneiss_error *error);

/* Goes on from the newest readable checkpoint in the output folder of a run, in that folder.
 * GNEISS_ERROR_INPUT: there is no such folder, or no checkpoint in it. */
GNEISS_API gneiss_status gneiss_world_resume(const char *folder, const char *const *overrides,
                                             size_t override_count, gneiss_world **world,
                                             gneiss_error *error);

/* Of gneiss_world_resume: which newer checkpoint was damaged and passed over; "": none, or NULL.
 * Belongs to the world. */
GNEISS_API const char *gneiss_world_note(const gneiss_world *world);

/* --- where it stands ---------------------------------------------------------------------------
 */

typedef struct gneiss_progress {
    int64_t step;        /* steps taken */
    double time, end;    /* s; now and time.end */
    double dt;           /* s; the coming step */
    double wall_seconds; /* in all sittings */
    double eta;          /* s of wall time to `end`, or to the strain that ends a test; NaN before
                            the first step */
    double unbalanced;   /* mean resultant over mean contact force, as in the history */
    double
        energy_residual;   /* what the ledger does not explain, over the work; NaN without ledger */
    double stress, strain; /* Pa, 1: of the test, last history row; NaN without */
    int32_t finished;      /* 1: time.end or a stop condition was reached */
    const char *stop_reason; /* "" while it goes on; belongs to the world */
} gneiss_progress;

/* `unbalanced`, `energy_residual`, `stress` and `strain` are those of the last history row. */
GNEISS_API gneiss_status gneiss_world_progress(const gneiss_world *world, gneiss_progress *progress,
                                               gneiss_error *error);

typedef struct gneiss_limits {
    double dt;         /* s; the step in use */
    double stable;     /* s; what the step is held against */
    double sharp;      /* s; 2/w_max by Lanczos iteration, contact damping included */
    double bound;      /* s; rigorous bound, never above the true limit */
    double literature; /* s; min_i 2 sqrt(m_i/k_i), one spring per particle: not safe */
} gneiss_limits;

/* Of the last estimate; INFINITY where nothing touches. */
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

/* Of finite elements, and of what they turn into (couple.convert). */
typedef struct gneiss_element_counts {
    int64_t nodes, elements; /* that are there */
    int64_t asleep;          /* particles prepared for elements that are there; of gneiss_counts */
} gneiss_element_counts;

GNEISS_API gneiss_status gneiss_world_element_counts(const gneiss_world *world,
                                                     gneiss_element_counts *counts,
                                                     gneiss_error *error);

/* Steps taken; s; hash of the state, equal for equal bits (any number of threads, any instruction
 * set, saved and loaded or not). 0 for NULL. */
GNEISS_API int64_t gneiss_world_steps(const gneiss_world *world);
GNEISS_API double gneiss_world_time(const gneiss_world *world);
GNEISS_API uint64_t gneiss_world_hash(const gneiss_world *world);

/* --- fields ------------------------------------------------------------------------------------
 */

typedef enum gneiss_record {
    GNEISS_PARTICLES = 0,
    GNEISS_BONDS = 1,         /* formed at the start; a broken one stays in the list */
    GNEISS_PAIRS = 2,         /* near each other and not bonded: touching or not */
    GNEISS_WALL_CONTACTS = 3, /* particles near walls */
    GNEISS_NODES = 4,         /* of finite elements */
    GNEISS_ELEMENTS = 5       /* triangles or tetrahedra */
} gneiss_record;

typedef enum gneiss_type {
    GNEISS_F64 = 0, /* double */
    GNEISS_I64 = 1, /* int64_t */
    GNEISS_I32 = 2, /* int32_t */
    GNEISS_U8 = 3,  /* uint8_t */
    GNEISS_F32 = 4  /* float */
} gneiss_type;

/* A look at an array. Component c of item k is at
 *     (const char *)data + k * item_stride + c * component_stride
 * `data` is valid until the world is advanced or freed, the texts until it is freed. It is the
 * state itself and not a copy: it must not be written to. Items may have another order after an
 * advance; the particles' field `id` is their place in the specimen, base 0, and stays. */
typedef struct gneiss_view {
    const char *name;        /* "pos" */
    const char *unit;        /* "m"; several where components differ */
    const char *description; /* "centre x y z, radius" */
    gneiss_type type;
    int32_t components;
    size_t count;                         /* items */
    size_t item_stride, component_stride; /* bytes */
    const void *data;
} gneiss_view;

/* "particles", "bonds", "pairs", "wall_contacts", "nodes", "elements"; NULL for anything else. */
GNEISS_API const char *gneiss_record_name(gneiss_record record);

/* How many fields a record has in this world: only those that its scene calls for. 0 for NULL or no
 * such record. */
GNEISS_API size_t gneiss_world_field_count(const gneiss_world *world, gneiss_record record);

/* m: what positions are computed relative to (key `origin`; docs/scene.md). Views of positions
 * (`pos`, `start`, `ref`) show what the world computes with: add this for the coordinates of the
 * scene file. Zero unless the model lies far from 0 or its scene says so. */
GNEISS_API gneiss_status gneiss_world_origin(const gneiss_world *world, double origin[3],
                                             gneiss_error *error);

/* A field by name, or by index in [0, gneiss_world_field_count). Particles always have `pos`
 * [4] (x y z from the origin, radius, m), `vel` [4] (velocity at the last half step, m/s, and
 * inverse mass, 1/kg; 0 mass: removed) and `id`; contacts `i`, `j` (particles, in their present
 * order) and `kn` (N/m). The rest depends on the scene. GNEISS_ERROR_INPUT: no such record or
 * field; the message lists those there are. */
GNEISS_API gneiss_status gneiss_world_field(const gneiss_world *world, gneiss_record record,
                                            const char *name, gneiss_view *view,
                                            gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_field_at(const gneiss_world *world, gneiss_record record,
                                               size_t index, gneiss_view *view,
                                               gneiss_error *error);

/* Element (item, component) of a view as a double, whatever its type; NaN outside of it or for
 * NULL. For a first look; loops go faster over `data`. */
GNEISS_API double gneiss_view_value(const gneiss_view *view, size_t item, size_t component);

/* --- outputs -----------------------------------------------------------------------------------
 */

/* What results.h5 has of every particle, bond, node or element (docs/quantities.md): "damage",
 * "stress", "coordination", "criterion", ... Of pairs and wall contacts there is none. By index in
 * [0, gneiss_world_output_count): *what says name, unit, meaning, components and items, without
 * data. GNEISS_ERROR_INPUT: no such output. */
GNEISS_API size_t gneiss_world_output_count(const gneiss_world *world, gneiss_record record);
GNEISS_API gneiss_status gneiss_world_output_at(const gneiss_world *world, gneiss_record record,
                                                size_t index, gneiss_view *what,
                                                gneiss_error *error);

/* Finds one of the state as it is and writes it into values[items][components], `count` numbers in
 * all; particles in the order of the specimen, nodes and elements in that of the mesh. Forces and
 * stresses are those of the present positions. GNEISS_ERROR_INPUT: no such output, or another
 * count. */
GNEISS_API gneiss_status gneiss_world_output(const gneiss_world *world, gneiss_record record,
                                             const char *name, double *values, size_t count,
                                             gneiss_error *error);

/* --- history, readings, energy -----------------------------------------------------------------
 */

/* Columns of the history: "step", "time", "stress", "wall_top_force_z", ... (docs/results.md), as
 * views of doubles with one component and a row per item. Rows are taken every so many steps, as
 * output.history_rows says, from the first step on; in a run that a condition may end there are
 * more, and every second one is removed when there are twice as many as are wanted. By name, or by
 * index in [0, column count). The name in the view belongs to the world. GNEISS_ERROR_INPUT: no
 * such column. */
GNEISS_API size_t gneiss_world_history_count(const gneiss_world *world);
GNEISS_API gneiss_status gneiss_world_history(const gneiss_world *world, const char *name,
                                              gneiss_view *view, gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_history_at(const gneiss_world *world, size_t index,
                                                 gneiss_view *view, gneiss_error *error);

/* A number with its name. The texts live as long as the program. */
typedef struct gneiss_quantity {
    const char *name, *unit, *description;
    double value;
} gneiss_quantity;

/* Laboratory readings of the history so far: "young_modulus", "poisson_ratio", "peak_stress", ...;
 * value NaN where there is nothing to read (no test, too few rows). By name, or by index in [0,
 * gneiss_reading_count). GNEISS_ERROR_INPUT: no such reading; the message lists them. */
GNEISS_API size_t gneiss_reading_count(void);
GNEISS_API gneiss_status gneiss_world_reading(const gneiss_world *world, const char *name,
                                              gneiss_quantity *reading, gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_reading_at(const gneiss_world *world, size_t index,
                                                 gneiss_quantity *reading, gneiss_error *error);

/* Terms of the energy ledger at the last history row, J: "kinetic", "elastic_normal", "friction",
 * ...; "stored_at_start"; and "residual" (1). Values are NaN with output.energy off or before the
 * first row. GNEISS_ERROR_INPUT: no such term. */
GNEISS_API size_t gneiss_energy_count(void);
GNEISS_API gneiss_status gneiss_world_energy(const gneiss_world *world, const char *name,
                                             gneiss_quantity *term, gneiss_error *error);
GNEISS_API gneiss_status gneiss_world_energy_at(const gneiss_world *world, size_t index,
                                                gneiss_quantity *term, gneiss_error *error);

#ifdef __cplusplus
}
#endif
#endif
