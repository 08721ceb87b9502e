/* Parsing of the command line of all commands. */
#ifndef GN_CLI_OPTIONS_H
#define GN_CLI_OPTIONS_H

#include "scene/scene.h"

/* Options that only several runs side by side read: command, option. */
#define GN_ONLY_SEVERAL                                                                            \
    "gneiss %s: %s is for gneiss sweep and gneiss run --seeds, or of a test.confinement"

enum { GN_MAX_OVERRIDES = 64 };

typedef struct gn_options {
    const char *command;
    const char *target; /* scene file or output folder; NULL when not given */
    char **words;       /* [word_count] all words after the command */
    size_t word_count;
    const char *out;  /* --out */
    bool quiet, json; /* --quiet, --log json and --json */
    bool log;         /* --log json: standard output consists of JSON objects only (log.h) */
    bool force;       /* run: replaces a finished long run */
    bool markdown;    /* keys --markdown */
    bool manual;      /* help --man */
    bool allow_gmsh;  /* --allow-gmsh: a geometry may be meshed, which may execute commands */
    /* sweep; the first, seeds, also for run: --seeds, --jobs, --array ("": from Slurm); NULL: not
     * given */
    const char *seeds, *jobs, *array;
    bool dry_run, collect;       /* sweep */
    double error;                /* plan and run: --error, a share; 0: not given */
    const char *reading, *write; /* plan: --reading, --write; NULL: not given */
    bool any_particles;          /* plan: --particles any */
    double reached; /* run --error: the error of the plan for which this run is made; 0: no plan */
    bool one_json;  /* stiffness: --json */
    const char *passed[GN_MAX_OVERRIDES]; /* convert: --length=mm and others, in `held` */
    size_t passed_count;
    const char *strain;   /* stiffness: --strain; NULL: not given */
    const char *instants; /* view: --instants; NULL: not given */
    const char *fields;   /* view: --fields; NULL: not given */
    bool paraview;        /* view: --paraview */
    gn_override overrides[GN_MAX_OVERRIDES];
    const char *option[GN_MAX_OVERRIDES]; /* option that gave the override, such as --threads; NULL:
                                             --set */
    size_t override_count;
    char *held[GN_MAX_OVERRIDES]; /* copies of the keys of --set key=value */
    size_t held_count;
} gn_options;

/* Parses the arguments. *done is set if the program has nothing more to do (--help, --version). */
gneiss_status gn_options_parse(int argc, char **argv, gn_options *options, bool *done,
                               gneiss_error *error);
void gn_options_free(gn_options *options);

/* Fails with GNEISS_ERROR_INPUT and the command that was probably intended. */
gneiss_status gn_no_command(const char *name, gneiss_error *error);

#endif
