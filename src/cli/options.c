#include "cli/options.h"

#include "base/instruction_sets.h"
#include "base/names.h"
#include "cli/help.h"
#include "run/run.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static gneiss_status add_override(gn_options *o, const char *key, const char *value,
                                  gneiss_error *error) {
    if (o->override_count == GN_MAX_OVERRIDES)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected at most %d overrides",
                       GN_MAX_OVERRIDES);
    o->overrides[o->override_count++] = (gn_override){key, value};
    return GNEISS_OK;
}

/* "key=value" */
static gneiss_status add_set(gn_options *o, const char *text, gneiss_error *error) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set: expected KEY=VALUE, found '%s'", text);
    char *key = strndup(text, (size_t)(equals - text));
    if (!key) return gn_fail(error, GNEISS_ERROR_MEMORY, "--set: no memory");
    if (o->held_count == GN_MAX_OVERRIDES) {
        free(key);
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set: too many overrides");
    }
    o->held[o->held_count++] = key;
    return add_override(o, key, equals + 1, error);
}

gneiss_status gn_no_command(const char *name, gneiss_error *error) {
    char advice[GN_ADVICE_SIZE] = "";
    gn_names names = gn_names_for(name);
    for (size_t k = 0; gn_command_at(k); k++) gn_names_add(&names, gn_command_at(k)->name);
    if (names.nearest) gn_names_advice(&names, advice, sizeof advice);
    return gn_fail(error, GNEISS_ERROR_INPUT, "unknown command '%s'%s (gneiss --help lists them)",
                   name, advice);
}

/* Options that only sweeps have. */
static gneiss_status check_sweep_options(const gn_options *o, const gn_command *c,
                                         gneiss_error *error) {
    bool sweep = strcmp(c->name, "sweep") == 0, run = strcmp(c->name, "run") == 0;
    bool several = sweep || run; /* of a run the scene says: gn_command_several */
    const char *only_sweep = o->array     ? "--array"
                             : o->collect ? "--collect"
                                          : NULL,
               *only_several = o->jobs      ? "--jobs"
                               : o->dry_run ? "--dry-run"
                                            : NULL;
    if (only_sweep && !sweep)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s is for gneiss sweep", c->name,
                       only_sweep);
    if (only_several && !several)
        return gn_fail(error, GNEISS_ERROR_INPUT, GN_ONLY_SEVERAL, c->name, only_several);
    if (o->seeds && !several)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: --seeds is for gneiss sweep and gneiss run", c->name);
    if (o->array && o->collect)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss sweep: expected --array or --collect, found both");
    return GNEISS_OK;
}

/* Options of `plan --error`. */
static gneiss_status check_plan_options(const gn_options *o, const gn_command *c,
                                        gneiss_error *error) {
    const char *given = o->error           ? "--error"
                        : o->reading       ? "--reading"
                        : o->write         ? "--write"
                        : o->any_particles ? "--particles"
                                           : NULL;
    if (given && strcmp(c->name, "plan") != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s is for gneiss plan", c->name,
                       given);
    if (given && !o->error)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss plan: %s: expected --error beside it",
                       given);
    return GNEISS_OK;
}

static bool reads_scenes(const gn_command *c) {
    static const char *const without[] = {"report", "keys", "info"};
    for (size_t k = 0; k < sizeof without / sizeof *without; k++)
        if (strcmp(c->name, without[k]) == 0) return false;
    return true;
}

static gneiss_status check_target(const gn_options *o, int argc, char **argv, int first,
                                  gneiss_error *error) {
    const gn_command *c = gn_command_named(o->command);
    if (!c) return gn_no_command(o->command, error);
    if (c->needs_target && !o->target)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: expected %s", c->name, c->arguments);
    if (!*c->arguments && o->target)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: expected no argument, found '%s'",
                       c->name, o->target);
    if (o->out && strcmp(c->name, "resume") == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss resume: --out: a resumed run stays in its folder");
    if (o->allow_gmsh && !reads_scenes(c))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: --allow-gmsh is for commands that read a scene", c->name);
    GN_TRY(check_sweep_options(o, c, error));
    GN_TRY(check_plan_options(o, c, error));
    if (first + 1 < argc && !c->several)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: expected one argument, found also '%s'", c->name,
                       argv[first + 1]);
    return GNEISS_OK;
}

enum {
    OPT_OUT = 256,
    OPT_SET,
    OPT_THREADS,
    OPT_SEED,
    OPT_PRECISION,
    OPT_ISA,
    OPT_FORCE,
    OPT_ALLOW_GMSH,
    OPT_QUIET,
    OPT_LOG,
    OPT_MARKDOWN,
    OPT_SEEDS,
    OPT_JOBS,
    OPT_DRY_RUN,
    OPT_ARRAY,
    OPT_COLLECT,
    OPT_ERROR,
    OPT_READING,
    OPT_PARTICLES,
    OPT_WRITE,
    OPT_HELP,
    OPT_VERSION
};

static const struct option long_options[] = {
    {"out", required_argument, 0, OPT_OUT},
    {"set", required_argument, 0, OPT_SET},
    {"threads", required_argument, 0, OPT_THREADS},
    {"seed", required_argument, 0, OPT_SEED},
    {"precision", required_argument, 0, OPT_PRECISION},
    {"isa", required_argument, 0, OPT_ISA},
    {"force", no_argument, 0, OPT_FORCE},
    {"allow-gmsh", no_argument, 0, OPT_ALLOW_GMSH},
    {"quiet", no_argument, 0, OPT_QUIET},
    {"log", required_argument, 0, OPT_LOG},
    {"markdown", no_argument, 0, OPT_MARKDOWN},
    {"seeds", required_argument, 0, OPT_SEEDS},
    {"jobs", required_argument, 0, OPT_JOBS},
    {"dry-run", no_argument, 0, OPT_DRY_RUN},
    {"array", optional_argument, 0, OPT_ARRAY},
    {"collect", no_argument, 0, OPT_COLLECT},
    {"error", required_argument, 0, OPT_ERROR},
    {"reading", required_argument, 0, OPT_READING},
    {"particles", required_argument, 0, OPT_PARTICLES},
    {"write", required_argument, 0, OPT_WRITE},
    {"help", no_argument, 0, OPT_HELP},
    {"version", no_argument, 0, OPT_VERSION},
    {0, 0, 0, 0},
};

static gneiss_status apply_to_plan(gn_options *o, int option, const char *value,
                                   gneiss_error *error) {
    switch (option) {
    case OPT_ERROR:
        o->error = value;
        return GNEISS_OK;
    case OPT_READING:
        if (strcmp(value, "strength") != 0 && strcmp(value, "stiffness") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--reading: expected strength or stiffness, found '%s'", value);
        o->reading = value;
        return GNEISS_OK;
    case OPT_PARTICLES:
        if (strcmp(value, "any") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--particles: expected any (a number is given with --set "
                           "specimen.particles=), found '%s'",
                           value);
        o->any_particles = true;
        return GNEISS_OK;
    case OPT_WRITE:
        if (!*value)
            return gn_fail(error, GNEISS_ERROR_INPUT, "--write: expected a file, found ''");
        o->write = value;
        return GNEISS_OK;
    default:
        return gn_fail(error, GNEISS_ERROR_INPUT, "unknown option (gneiss --help lists them)");
    }
}

static gneiss_status apply_to_sweep(gn_options *o, int option, const char *value,
                                    gneiss_error *error) {
    switch (option) {
    case OPT_SEEDS:
        o->seeds = value;
        return GNEISS_OK;
    case OPT_JOBS:
        o->jobs = value;
        return GNEISS_OK;
    case OPT_DRY_RUN:
        o->dry_run = true;
        return GNEISS_OK;
    case OPT_ARRAY:
        o->array = value ? value : "";
        return GNEISS_OK;
    case OPT_COLLECT:
        o->collect = true;
        return GNEISS_OK;
    default:
        return apply_to_plan(o, option, value, error);
    }
}

static gneiss_status apply(gn_options *o, int option, const char *value, gneiss_error *error) {
    switch (option) {
    case OPT_OUT:
        if (!*value)
            return gn_fail(error, GNEISS_ERROR_INPUT, "--out: expected a folder, found ''");
        o->out = value;
        return GNEISS_OK;
    case OPT_SET:
        return add_set(o, value, error);
    case OPT_THREADS:
        return add_override(o, "run.threads", value, error);
    case OPT_SEED:
        return add_override(o, "run.seed", value, error);
    case OPT_PRECISION:
        return add_override(o, "run.precision", value, error);
    case OPT_ISA:
        return add_override(o, "run.isa", value, error);
    case OPT_FORCE:
        o->force = true;
        return GNEISS_OK;
    case OPT_ALLOW_GMSH:
        o->allow_gmsh = true;
        return GNEISS_OK;
    case OPT_QUIET:
        o->quiet = true;
        return GNEISS_OK;
    case OPT_MARKDOWN:
        o->markdown = true;
        return GNEISS_OK;
    case OPT_LOG:
        if (strcmp(value, "json") != 0 && strcmp(value, "text") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT, "--log: expected json or text, found '%s'",
                           value);
        o->json = strcmp(value, "json") == 0;
        return GNEISS_OK;
    default:
        return apply_to_sweep(o, option, value, error);
    }
}

/* What getopt stopped at, and what may have been meant. */
static gneiss_status no_option(char **argv, gneiss_error *error) {
    const char *given = argv[optind - 1];
    char name[96], advice[GN_ADVICE_SIZE] = "";
    if (optopt >= OPT_OUT) /* one of the list: it was given a value */
        return gn_fail(error, GNEISS_ERROR_INPUT, "%.*s: expected no value, found '%.200s'",
                       (int)strcspn(given, "="), given, given + strcspn(given, "=") + 1);
    if (optopt) /* a letter, perhaps one of several */
        return gn_fail(error, GNEISS_ERROR_INPUT, "unknown option '-%c' (gneiss --help lists them)",
                       optopt);
    snprintf(name, sizeof name, "%.*s", (int)strcspn(given + 2, "="), given + 2);
    gn_names names = gn_names_for(name);
    for (const struct option *o = long_options; o->name; o++) gn_names_add(&names, o->name);
    if (names.nearest) snprintf(advice, sizeof advice, "; did you mean '--%s'?", names.nearest);
    return gn_fail(error, GNEISS_ERROR_INPUT, "unknown option '--%s'%s (gneiss --help lists them)",
                   name, advice);
}

/* The first argument that is a command; NULL: none. */
static const gn_command *command_among(int argc, char **argv) {
    for (int k = 1; k < argc; k++)
        if (gn_command_named(argv[k])) return gn_command_named(argv[k]);
    return NULL;
}

gneiss_status gn_options_parse(int argc, char **argv, gn_options *o, bool *done,
                               gneiss_error *error) {
    memset(o, 0, sizeof *o);
    *done = false;
    opterr = 0;
    for (;;) {
        int option = getopt_long(argc, argv, ":h", long_options, NULL);
        if (option < 0) break;
        if (option == 'h' || option == OPT_HELP || option == OPT_VERSION) {
            *done = true;
            if (option != OPT_VERSION)
                gn_print_help(stdout, command_among(argc, argv));
            else
                gn_print_version(stdout);
            return GNEISS_OK;
        }
        if (option == ':')
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a value (gneiss --help)",
                           argv[optind - 1]);
        if (option == '?') return no_option(argv, error);
        /* A value that may be left out counts as one only behind "=" to getopt. */
        bool shard = option == OPT_ARRAY && !optarg && optind < argc && argv[optind][0] &&
                     strspn(argv[optind], "0123456789/") == strlen(argv[optind]);
        GN_TRY(apply(o, option, shard ? argv[optind++] : optarg, error));
    }
    if (optind == argc)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected a command (gneiss --help lists them)");
    o->command = argv[optind];
    int first = optind + 1;
    o->target = first < argc ? argv[first] : NULL;
    o->words = first < argc ? argv + first : NULL;
    o->word_count = (size_t)(argc - first);
    return check_target(o, argc, argv, first, error);
}

void gn_options_free(gn_options *o) {
    for (size_t k = 0; k < o->held_count; k++) free(o->held[k]);
}
