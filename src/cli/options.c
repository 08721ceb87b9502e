#include "cli/options.h"

#include "base/instruction_sets.h"
#include "base/names.h"
#include "cli/help.h"
#include "run/run.h"

#include <getopt.h>
#include <stddef.h>
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
        return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss %s: %s: needs --error", command->name,
                       given);
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

/* The ways in which options are read: TEXT keeps the value in a member of gn_options, FLAG sets a
 * member, KEY overrides the key run.<name>, PASSED is handed on, and OWN has code of its own. */
typedef enum way { TEXT, FLAG, KEY, PASSED, OWN } way;

/* X(NAME, name, argument, way, member); `command` where there is no member. */
#define OPTIONS(X)                                                                                 \
    X(OUT, "out", required_argument, OWN, out)                                                     \
    X(SET, "set", required_argument, OWN, command)                                                 \
    X(THREADS, "threads", required_argument, KEY, command)                                         \
    X(SEED, "seed", required_argument, KEY, command)                                               \
    X(PRECISION, "precision", required_argument, KEY, command)                                     \
    X(ISA, "isa", required_argument, KEY, command)                                                 \
    X(FORCE, "force", no_argument, FLAG, force)                                                    \
    X(ALLOW_GMSH, "allow-gmsh", no_argument, FLAG, allow_gmsh)                                     \
    X(QUIET, "quiet", no_argument, FLAG, quiet)                                                    \
    X(LOG, "log", required_argument, OWN, command)                                                 \
    X(MARKDOWN, "markdown", no_argument, FLAG, markdown)                                           \
    X(MAN, "man", no_argument, FLAG, manual)                                                       \
    X(SEEDS, "seeds", required_argument, TEXT, seeds)                                              \
    X(JOBS, "jobs", required_argument, TEXT, jobs)                                                 \
    X(DRY_RUN, "dry-run", no_argument, FLAG, dry_run)                                              \
    X(ARRAY, "array", optional_argument, TEXT, array)                                              \
    X(COLLECT, "collect", no_argument, FLAG, collect)                                              \
    X(ERROR, "error", required_argument, OWN, command)                                             \
    X(READING, "reading", required_argument, OWN, command)                                         \
    X(PARTICLES, "particles", required_argument, OWN, command)                                     \
    X(WRITE, "write", required_argument, OWN, command)                                             \
    X(STRAIN, "strain", required_argument, TEXT, strain)                                           \
    X(JSON, "json", no_argument, OWN, command)                                                     \
    X(LENGTH, "length", required_argument, PASSED, command)                                        \
    X(DENSITY, "density", required_argument, PASSED, command)                                      \
    X(AS, "as", required_argument, PASSED, command)                                                \
    X(COLUMNS, "columns", required_argument, PASSED, command)                                      \
    X(FRAME, "frame", required_argument, PASSED, command)                                          \
    X(INSTANTS, "instants", required_argument, TEXT, instants)                                     \
    X(FIELDS, "fields", required_argument, TEXT, fields)                                           \
    X(PARAVIEW, "paraview", no_argument, FLAG, paraview)                                           \
    X(HELP, "help", no_argument, OWN, command)                                                     \
    X(VERSION, "version", no_argument, OWN, command)

enum {
    OPT_BEFORE = 255, /* short options are characters */
#define X(NAME, ...) OPT_##NAME,
    OPTIONS(X)
#undef X
        OPT_FIRST = OPT_BEFORE + 1
};

static const struct option long_options[] = {
#define X(NAME, name, argument, way, member) {name, argument, 0, OPT_##NAME},
    OPTIONS(X)
#undef X
        {0, 0, 0, 0},
};

static const struct {
    way way;
    size_t offset; /* of the member of gn_options */
    const char *given, *key;
} readings[] = {
#define X(NAME, name, argument, way, member)                                                       \
    {way, offsetof(gn_options, member), "--" name, "run." name},
    OPTIONS(X)
#undef X
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

/* Keeps an option of `convert` as the text --name=value. */
static gneiss_status pass_on(gn_options *options, const char *given, const char *value,
                             gneiss_error *error) {
    if (options->held_count == GN_MAX_OVERRIDES)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected at most %d options", given,
                       GN_MAX_OVERRIDES);
    const size_t size = strlen(given) + strlen(value) + sizeof "=";
    char *text = malloc(size);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the options");
    snprintf(text, size, "%s=%s", given, value);
    options->held[options->held_count++] = text;
    options->passed[options->passed_count++] = text;
    return GNEISS_OK;
}

static gneiss_status read_log(gn_options *options, const char *value, gneiss_error *error) {
    if (strcmp(value, "json") != 0 && strcmp(value, "text") != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--log: expected json or text, found '%s'",
                       value);
    options->log = strcmp(value, "json") == 0;
    options->json = options->log || options->one_json;
    return GNEISS_OK;
}

static gneiss_status read_particles(gn_options *options, const char *value, gneiss_error *error) {
    if (strcmp(value, "any") != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "--particles: expected any (a number is given with --set "
                       "specimen.particles=), found '%s'",
                       value);
    options->any_particles = true;
    return GNEISS_OK;
}

static gneiss_status read_reading(gn_options *options, const char *value, gneiss_error *error) {
    if (strcmp(value, "strength") != 0 && strcmp(value, "stiffness") != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "--reading: expected strength or stiffness, found '%s'", value);
    options->reading = value;
    return GNEISS_OK;
}

static gneiss_status keep_path(const char **path, const char *option, const char *expected,
                               const char *value, gneiss_error *error) {
    if (!*value)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a %s, found ''", option, expected);
    *path = value;
    return GNEISS_OK;
}

static gneiss_status apply_own(gn_options *options, int option, const char *value,
                               gneiss_error *error) {
    switch (option) {
    case OPT_OUT:
        return keep_path(&options->out, "--out", "folder", value, error);
    case OPT_WRITE:
        return keep_path(&options->write, "--write", "file", value, error);
    case OPT_SET:
        return add_set(options, value, error);
    case OPT_LOG:
        return read_log(options, value, error);
    case OPT_ERROR:
        return read_error(value, &options->error, error);
    case OPT_READING:
        return read_reading(options, value, error);
    case OPT_PARTICLES:
        return read_particles(options, value, error);
    case OPT_JSON:
        options->json = options->one_json = true;
        return GNEISS_OK;
    default:
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "an option without a reading");
    }
}

static gneiss_status apply(gn_options *options, int option, const char *value,
                           gneiss_error *error) {
    const int k = option - OPT_FIRST;
    void *member = (char *)options + readings[k].offset;
    switch (readings[k].way) {
    case TEXT:
        *(const char **)member = value ? value : "";
        return GNEISS_OK;
    case FLAG:
        *(bool *)member = true;
        return GNEISS_OK;
    case KEY:
        return add_override(options, readings[k].given, readings[k].key, value, error);
    case PASSED:
        return pass_on(options, readings[k].given, value, error);
    case OWN:
        break;
    }
    return apply_own(options, option, value, error);
}

/* Reports the option at which getopt stopped, and the option that was probably intended. */
static gneiss_status no_option(char **argv, gneiss_error *error) {
    const char *given = argv[optind - 1];
    char name[96], advice[GN_ADVICE_SIZE] = "";
    if (optopt >= OPT_FIRST) /* a long option without a value was given one */
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
