#include "cli/options.h"

#include "base/instruction_sets.h"
#include "base/names.h"
#include "cli/help.h"
#include "run/run.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static gneiss_status add_override(gn_options *options, const char *option, const char *key,
                                  const char *value, gneiss_error *error) {
    if (options->override_count == GN_MAX_OVERRIDES)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected at most %d overrides",
                       GN_MAX_OVERRIDES);
    options->option[options->override_count] = option;
    options->overrides[options->override_count++] = (gn_override){key, value};
    return GNEISS_OK;
}

/* Adds an override "key=value". */
static gneiss_status add_set(gn_options *options, const char *text, gneiss_error *error) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set: expected KEY=VALUE, found '%s'", text);
    char *key = strndup(text, (size_t)(equals - text));
    if (!key) return gn_fail(error, GNEISS_ERROR_MEMORY, "--set: no memory");
    if (options->held_count == GN_MAX_OVERRIDES) {
        free(key);
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set: too many overrides");
    }
    options->held[options->held_count++] = key;
    return add_override(options, NULL, key, equals + 1, error);
}

gneiss_status gn_no_command(const char *name, gneiss_error *error) {
    char advice[GN_ADVICE_SIZE] = "";
    gn_names names = gn_names_for(name);
    for (size_t k = 0; gn_command_at(k); k++) gn_names_add(&names, gn_command_at(k)->name);
    if (names.nearest) gn_names_advice(&names, advice, sizeof advice);
    return gn_fail(error, GNEISS_ERROR_INPUT, "unknown command '%s'%s (gneiss --help lists them)",
                   name, advice);
}

/* Refuses options of sweeps for other commands. */
static gneiss_status check_sweep_options(const gn_options *options, const gn_command *command,
                                         gneiss_error *error) {
    bool sweep = strcmp(command->name, "sweep") == 0, run = strcmp(command->name, "run") == 0;
    bool several = sweep || run; /* for a run the scene decides this: gn_command_several */
    const char *only_sweep = options->array     ? "--array"
                             : options->collect ? "--collect"
                                                : NULL,
               *only_several = options->jobs      ? "--jobs"
                               : options->dry_run ? "--dry-run"
                                                  : NULL;
    if (only_sweep && !sweep)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s is for gneiss sweep",
                       command->name, only_sweep);
    if (only_several && !several)
        return gn_fail(error, GNEISS_ERROR_INPUT, GN_ONLY_SEVERAL, command->name, only_several);
    if (options->seeds && !several && strcmp(command->name, "calibrate") != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: --seeds is for gneiss sweep, gneiss run and gneiss calibrate",
                       command->name);
    if (options->array && options->collect)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss sweep: expected --array or --collect, found both");
    return GNEISS_OK;
}

/* Refuses the options of `plan --error` if --error is missing. */
static gneiss_status check_plan_options(const gn_options *options, const gn_command *command,
                                        gneiss_error *error) {
    const char *given = options->error > 0.0     ? "--error"
                        : options->reading       ? "--reading"
                        : options->write         ? "--write"
                        : options->any_particles ? "--particles"
                                                 : NULL;
    if (given && strcmp(command->name, "plan") != 0 && strcmp(command->name, "run") != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s is for gneiss plan and gneiss run",
                       command->name, given);
    if (given && !(options->error > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s: expected --error beside it",
                       command->name, given);
    return GNEISS_OK;
}

/* Refuses options of `stiffness` for other commands. */
static gneiss_status check_stiffness_options(const gn_options *options, const gn_command *command,
                                             gneiss_error *error) {
    const char *given = options->strain ? "--strain" : options->one_json ? "--json" : NULL;
    if (!given || strcmp(command->name, "stiffness") == 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s is for gneiss stiffness%s",
                   command->name, given, options->one_json ? "; --log json prints JSON lines" : "");
}

/* Refuses options of `view` for other commands. */
static gneiss_status check_view_options(const gn_options *options, const gn_command *command,
                                        gneiss_error *error) {
    const char *given = options->instants   ? "--instants"
                        : options->fields   ? "--fields"
                        : options->paraview ? "--paraview"
                                            : NULL;
    if (!given || strcmp(command->name, "view") == 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s is for gneiss view", command->name,
                   given);
}

static bool is_among(const gn_command *command, const char *const *names) {
    for (; *names; names++)
        if (strcmp(command->name, *names) == 0) return true;
    return false;
}

static gneiss_status check_files(const gn_options *options, const gn_command *command,
                                 gneiss_error *error) {
    static const char *const no_scene[] = {"calibrate", "report",  "view",   "keys",       "info",
                                           "status",    "explain", "schema", "completion", "help",
                                           "version",   "convert", NULL},
                             *const writing[] = {"run", "pack", "sweep", "calibrate", NULL};
    if (options->out && strcmp(command->name, "resume") == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss resume: --out: a resumed run stays in its folder");
    if (options->out && !is_among(command, writing))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: --out is for gneiss run, pack, sweep and calibrate",
                       command->name);
    if (options->allow_gmsh && is_among(command, no_scene))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: --allow-gmsh is for commands that read a scene", command->name);
    return GNEISS_OK;
}

static gneiss_status check_target(const gn_options *options, int argc, char **argv, int first,
                                  gneiss_error *error) {
    const gn_command *command = gn_command_named(options->command);
    if (!command) return gn_no_command(options->command, error);
    if (command->needs_target && !options->target)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: expected %s", command->name,
                       command->arguments);
    if (!*command->arguments && options->target)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: expected no argument, found '%s'",
                       command->name, options->target);
    GN_TRY(check_files(options, command, error));
    GN_TRY(check_sweep_options(options, command, error));
    GN_TRY(check_plan_options(options, command, error));
    GN_TRY(check_stiffness_options(options, command, error));
    const bool converts = strcmp(command->name, "convert") == 0;
    if (options->passed_count && !converts)
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %.*s is for gneiss convert",
                       command->name, (int)strcspn(options->passed[0], "="), options->passed[0]);
    if (converts && argc - first != 2)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss convert: expected two arguments, %s, found %d", command->arguments,
                       argc - first);
    GN_TRY(check_view_options(options, command, error));
    if (first + 1 < argc && !command->several)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss %s: expected one argument, found also '%s'", command->name,
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
    OPT_MAN,
    OPT_SEEDS,
    OPT_JOBS,
    OPT_DRY_RUN,
    OPT_ARRAY,
    OPT_COLLECT,
    OPT_ERROR,
    OPT_READING,
    OPT_PARTICLES,
    OPT_WRITE,
    OPT_STRAIN,
    OPT_JSON,
    OPT_LENGTH,
    OPT_DENSITY,
    OPT_AS,
    OPT_COLUMNS,
    OPT_FRAME,
    OPT_INSTANTS,
    OPT_FIELDS,
    OPT_PARAVIEW,
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
    {"man", no_argument, 0, OPT_MAN},
    {"seeds", required_argument, 0, OPT_SEEDS},
    {"jobs", required_argument, 0, OPT_JOBS},
    {"dry-run", no_argument, 0, OPT_DRY_RUN},
    {"array", optional_argument, 0, OPT_ARRAY},
    {"collect", no_argument, 0, OPT_COLLECT},
    {"error", required_argument, 0, OPT_ERROR},
    {"reading", required_argument, 0, OPT_READING},
    {"particles", required_argument, 0, OPT_PARTICLES},
    {"write", required_argument, 0, OPT_WRITE},
    {"strain", required_argument, 0, OPT_STRAIN},
    {"json", no_argument, 0, OPT_JSON},
    {"length", required_argument, 0, OPT_LENGTH},
    {"density", required_argument, 0, OPT_DENSITY},
    {"as", required_argument, 0, OPT_AS},
    {"columns", required_argument, 0, OPT_COLUMNS},
    {"frame", required_argument, 0, OPT_FRAME},
    {"instants", required_argument, 0, OPT_INSTANTS},
    {"fields", required_argument, 0, OPT_FIELDS},
    {"paraview", no_argument, 0, OPT_PARAVIEW},
    {"help", no_argument, 0, OPT_HELP},
    {"version", no_argument, 0, OPT_VERSION},
    {0, 0, 0, 0},
};

/* Reads "5%", "5 %" or "0.05". */
static gneiss_status read_error(const char *text, double *wanted, gneiss_error *error) {
    char *rest;
    *wanted = strtod(text, &rest);
    bool number = rest != text;
    rest += strspn(rest, " ");
    if (*rest == '%') {
        *wanted /= 100.0;
        rest++;
    }
    if (number && !*rest && *wanted > 0.0 && *wanted <= 1.0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "--error: expected a share in (0, 1] or (0, 100] %% such as 5%%, found '%s'",
                   text);
}

static gneiss_status apply_to_view(gn_options *options, int option, const char *value,
                                   gneiss_error *error) {
    switch (option) {
    case OPT_INSTANTS:
        options->instants = value;
        return GNEISS_OK;
    case OPT_FIELDS:
        options->fields = value;
        return GNEISS_OK;
    case OPT_PARAVIEW:
        options->paraview = true;
        return GNEISS_OK;
    default:
        return gn_fail(error, GNEISS_ERROR_INPUT, "unknown option (gneiss --help lists them)");
    }
}

static gneiss_status apply_to_plan(gn_options *options, int option, const char *value,
                                   gneiss_error *error) {
    switch (option) {
    case OPT_ERROR:
        return read_error(value, &options->error, error);
    case OPT_READING:
        if (strcmp(value, "strength") != 0 && strcmp(value, "stiffness") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--reading: expected strength or stiffness, found '%s'", value);
        options->reading = value;
        return GNEISS_OK;
    case OPT_PARTICLES:
        if (strcmp(value, "any") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--particles: expected any (a number is given with --set "
                           "specimen.particles=), found '%s'",
                           value);
        options->any_particles = true;
        return GNEISS_OK;
    case OPT_WRITE:
        if (!*value)
            return gn_fail(error, GNEISS_ERROR_INPUT, "--write: expected a file, found ''");
        options->write = value;
        return GNEISS_OK;
    case OPT_STRAIN:
        options->strain = value;
        return GNEISS_OK;
    case OPT_JSON:
        options->json = options->one_json = true;
        return GNEISS_OK;
    default:
        return apply_to_view(options, option, value, error);
    }
}

/* Keeps an option of `convert` as the text --name=value. */
static gneiss_status pass_on(gn_options *options, int option, const char *value,
                             gneiss_error *error) {
    const char *name = "";
    for (const struct option *o = long_options; o->name; o++)
        if (o->val == option) name = o->name;
    if (options->held_count == GN_MAX_OVERRIDES)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--%s: expected at most %d options", name,
                       GN_MAX_OVERRIDES);
    const size_t size = strlen(name) + strlen(value) + sizeof "--=";
    char *text = malloc(size);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the options");
    snprintf(text, size, "--%s=%s", name, value);
    options->held[options->held_count++] = text;
    options->passed[options->passed_count++] = text;
    return GNEISS_OK;
}

static gneiss_status apply_to_sweep(gn_options *options, int option, const char *value,
                                    gneiss_error *error) {
    switch (option) {
    case OPT_SEEDS:
        options->seeds = value;
        return GNEISS_OK;
    case OPT_JOBS:
        options->jobs = value;
        return GNEISS_OK;
    case OPT_DRY_RUN:
        options->dry_run = true;
        return GNEISS_OK;
    case OPT_ARRAY:
        options->array = value ? value : "";
        return GNEISS_OK;
    case OPT_COLLECT:
        options->collect = true;
        return GNEISS_OK;
    default:
        return apply_to_plan(options, option, value, error);
    }
}

static gneiss_status apply(gn_options *options, int option, const char *value,
                           gneiss_error *error) {
    switch (option) {
    case OPT_OUT:
        if (!*value)
            return gn_fail(error, GNEISS_ERROR_INPUT, "--out: expected a folder, found ''");
        options->out = value;
        return GNEISS_OK;
    case OPT_SET:
        return add_set(options, value, error);
    case OPT_THREADS:
        return add_override(options, "--threads", "run.threads", value, error);
    case OPT_SEED:
        return add_override(options, "--seed", "run.seed", value, error);
    case OPT_PRECISION:
        return add_override(options, "--precision", "run.precision", value, error);
    case OPT_ISA:
        return add_override(options, "--isa", "run.isa", value, error);
    case OPT_FORCE:
        options->force = true;
        return GNEISS_OK;
    case OPT_ALLOW_GMSH:
        options->allow_gmsh = true;
        return GNEISS_OK;
    case OPT_QUIET:
        options->quiet = true;
        return GNEISS_OK;
    case OPT_MAN:
        options->manual = true;
        return GNEISS_OK;
    case OPT_MARKDOWN:
        options->markdown = true;
        return GNEISS_OK;
    case OPT_LOG:
        if (strcmp(value, "json") != 0 && strcmp(value, "text") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT, "--log: expected json or text, found '%s'",
                           value);
        options->log = strcmp(value, "json") == 0;
        options->json = options->log || options->one_json;
        return GNEISS_OK;
    case OPT_LENGTH:
    case OPT_DENSITY:
    case OPT_AS:
    case OPT_COLUMNS:
    case OPT_FRAME:
        return pass_on(options, option, value, error);
    default:
        return apply_to_sweep(options, option, value, error);
    }
}

/* Reports the option at which getopt stopped, and the option that was probably intended. */
static gneiss_status no_option(char **argv, gneiss_error *error) {
    const char *given = argv[optind - 1];
    char name[96], advice[GN_ADVICE_SIZE] = "";
    if (optopt >= OPT_OUT) /* a long option without a value was given one */
        return gn_fail(error, GNEISS_ERROR_INPUT, "%.*s: expected no value, found '%.200s'",
                       (int)strcspn(given, "="), given, given + strcspn(given, "=") + 1);
    if (optopt) /* a short option, perhaps one of several */
        return gn_fail(error, GNEISS_ERROR_INPUT, "unknown option '-%c' (gneiss --help lists them)",
                       optopt);
    snprintf(name, sizeof name, "%.*s", (int)strcspn(given + 2, "="), given + 2);
    gn_names names = gn_names_for(name);
    for (const struct option *o = long_options; o->name; o++) gn_names_add(&names, o->name);
    if (names.nearest) snprintf(advice, sizeof advice, "; did you mean '--%s'?", names.nearest);
    return gn_fail(error, GNEISS_ERROR_INPUT, "unknown option '--%s'%s (gneiss --help lists them)",
                   name, advice);
}

/* Returns the first argument that is the name of a command; NULL: none. */
static const gn_command *command_among(int argc, char **argv) {
    for (int k = 1; k < argc; k++)
        if (gn_command_named(argv[k])) return gn_command_named(argv[k]);
    return NULL;
}

gneiss_status gn_options_parse(int argc, char **argv, gn_options *options, bool *done,
                               gneiss_error *error) {
    memset(options, 0, sizeof *options);
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
        /* getopt accepts an optional value only after "=". */
        bool shard = option == OPT_ARRAY && !optarg && optind < argc && argv[optind][0] &&
                     strspn(argv[optind], "0123456789/") == strlen(argv[optind]);
        GN_TRY(apply(options, option, shard ? argv[optind++] : optarg, error));
    }
    if (optind == argc)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected a command (gneiss --help lists them)");
    options->command = argv[optind];
    int first = optind + 1;
    options->target = first < argc ? argv[first] : NULL;
    options->words = first < argc ? argv + first : NULL;
    options->word_count = (size_t)(argc - first);
    return check_target(options, argc, argv, first, error);
}

void gn_options_free(gn_options *options) {
    for (size_t k = 0; k < options->held_count; k++) free(options->held[k]);
}
