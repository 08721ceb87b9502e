/* A sweep varies some keys of one scene; every combination is a run in a folder named by a hash of
 * its input. A sweep file describes it (docs/sweep.md). */
#ifndef GN_SWEEP_SWEEP_H
#define GN_SWEEP_SWEEP_H

#include "scene/read.h"

typedef enum gn_combine { GN_COMBINE_CROSSED, GN_COMBINE_ZIPPED } gn_combine;
typedef enum gn_sampling { GN_SAMPLING_NONE, GN_SAMPLING_LATIN, GN_SAMPLING_SOBOL } gn_sampling;
typedef enum gn_spacing { GN_SPACING_LINEAR, GN_SPACING_LOG } gn_spacing;

enum { GN_SWEEP_PARAMETERS_MAX = 32, GN_SWEEP_RUNS_MAX = 100000 };

/* The file as written, read by gn_sweep_section (keys.c). */
typedef struct gn_sweep_file {
    char title[256];
    char scene[GN_PATH_SIZE], scene_path[GN_PATH_SIZE]; /* as written; absolute path */
    const gn_node *parameters, *seeds;                  /* NULL: not given */
    gn_combine combine;
    gn_sampling sampling;
    int64_t sample_count;
    uint64_t sample_seed;
    size_t reading_count;
    char (*readings)[GN_NAME_SIZE];
    char directory[GN_PATH_SIZE];
} gn_sweep_file;

extern const gn_section gn_sweep_section;
/* Keys of a parameter's values that are not given as a list. */
extern const gn_section gn_range_section;

/* A value of a parameter, in the form of an override. */
typedef struct gn_sweep_value {
    char *text;           /* gn_alloc'ed */
    double number;        /* in SI; NaN: the value is not a number */
    gn_scene_place where; /* place in the sweep file */
} gn_sweep_value;

typedef struct gn_sweep_parameter {
    char key[GN_KEY_PATH_SIZE]; /* key in the form of an override */
    const gn_key *meant;
    const char *unit;     /* SI unit; "": none, or values are not numbers */
    bool numeric;         /* every value is a number */
    bool sampled;         /* the parameter is sampled, together with all others that are */
    gn_scene_place where; /* place of the key in the file */
    size_t count;
    gn_sweep_value *values; /* gn_alloc'ed */
} gn_sweep_parameter;

typedef struct gn_sweep_run {
    size_t first_value; /* index in gn_sweep.chosen of its first value */
    size_t combination; /* combination of values; the runs of one combination differ only in the
                           seed */
    size_t original;    /* the first run with the same hash, which may be the run itself */
    uint64_t seed;
    uint64_t hash;    /* hash of the resolved scene, the files that it names, and the version */
    uint64_t packing; /* hash of its packing; 0: it has none */
    int64_t threads;  /* threads of its scene; 0: any */
} gn_sweep_run;

typedef struct gn_sweep {
    char title[256];
    char source[GN_PATH_SIZE];    /* the sweep file; or, for a sweep over seeds alone, the scene */
    char scene[GN_PATH_SIZE];     /* path of the scene, for messages */
    char directory[GN_PATH_SIZE]; /* folder that the file requests; "": none */
    char *text;                   /* text of the sweep file; NULL without one */
    char *scene_text;
    size_t override_count; /* overrides of the command line, borrowed; they are applied before the
                              parameters */
    const gn_override *overrides;
    size_t parameter_count;
    gn_sweep_parameter parameters[GN_SWEEP_PARAMETERS_MAX];
    size_t seed_count; /* 0: the seed is not varied */
    uint64_t *seeds;
    size_t reading_count; /* 0: all available */
    char (*readings)[GN_NAME_SIZE];
    size_t run_count, combination_count;
    gn_sweep_run *runs;
    uint32_t *chosen; /* [run_count][parameter_count]: indices of the values */
    gn_units *units;
    bool draws;           /* some scene uses random numbers */
    gn_scene_notes notes; /* notes on all scenes */
} gn_sweep;

/* Reads the file and all its scenes, so that a sweep with an invalid scene is not begun.
 * `overrides` are for the scene, borrowed; `seeds` (may be NULL), as text, replaces the file's
 * seeds. Messages give file:line:column. On failure nothing is allocated. */
gneiss_status gn_sweep_load(const char *path, const gn_override *overrides, size_t override_count,
                            const char *seeds, gn_sweep *sweep, gneiss_error *error);

/* Creates a sweep over the seeds of one scene (NULL: none), and over the confinements of its test.
 * *wanted: the scene has seeds or confinements; otherwise nothing is allocated. */
gneiss_status gn_sweep_of_scene(const char *scene, const gn_override *overrides,
                                size_t override_count, const char *seeds, gn_sweep *sweep,
                                bool *wanted, gneiss_error *error);

void gn_sweep_free(gn_sweep *sweep);

/* Returns the scene of a run, which was checked before. */
gneiss_status gn_sweep_scene(const gn_sweep *sweep, size_t run, gn_scene *scene,
                             gneiss_error *error);

/* Returns the value of a parameter in a run. */
const gn_sweep_value *gn_sweep_value_of(const gn_sweep *sweep, size_t run, size_t parameter);

/* Writes the varied parameters of a run, with the seed or without: "friction = 0.3, seed 2". */
const char *gn_sweep_label(const gn_sweep *sweep, size_t run, bool seed, char *text, size_t size);

/* Writes those varied parameters for which `shown` [parameter_count] is true. */
const char *gn_sweep_label_of(const gn_sweep *sweep, size_t run, const bool *shown, char *text,
                              size_t size);

/* True if a name is a possible reading: that of a test, energy.<term>, or history.<column>, where
 * walls and other objects may have any name. If it is not, `advice` proposes the name that was
 * probably intended. */
bool gn_reading_known(const char *name, char *advice, size_t size);

#endif
