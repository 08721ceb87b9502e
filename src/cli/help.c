#include "cli/help.h"

#include "base/instruction_sets.h"
#include "base/version.h"
#include "cli/commit.h"
#include "cli/log.h"

#include <string.h>

#define ALL_COMMANDS                                                                               \
    "run check plan stiffness pack sweep calibrate resume status report view convert keys "        \
    "explain schema info "                                                                         \
    "help "                                                                                        \
    "version"

static const gn_command commands[] = {
    {"run", "SCENE", "run a scene", true, false,
     "Writes results.h5, summary.json and snapshots to runs/<scene name>. Ctrl-C writes "
     "a\ncheckpoint first; gneiss resume continues from it. With --seeds, or with several values "
     "of\ntest.confinement, it makes one run for each value, side by side. "
     "With\n--error it plans first, as gneiss plan does: the planned scene is "
     "runs/<scene\nname>-planned.yaml, its results are in the folder of that name without .yaml.\n",
     "gneiss run scenes/ucs-rock.yaml\n"
     "gneiss run scenes/ucs-rock.yaml --out runs/fast --set walls.top.motion.vz=-1\n"
     "gneiss run scenes/ucs-packed.yaml --seeds 5\n"
     "gneiss run scenes/ucs-packed.yaml --error 4%\n"},
    {"check", "SCENE", "read a scene and check its specimen, run nothing", true, false,
     "Builds the specimen, reports problems by file, line and column, and prints contacts "
     "and\noverlaps. It writes nothing.\n",
     "gneiss check scenes/ucs-rock.yaml\n"},
    {"plan", "SCENE", "print computation, memory and cost of a run", true, false,
     "With --error it finds the cheapest settings that give the strength, or the stiffness,\nwith "
     "at most this error.\n",
     "gneiss plan scenes/ucs-rock.yaml\n"
     "gneiss plan scenes/ucs-rock.yaml --error 5% --write cheaper.yaml\n"},
    {"stiffness", "SCENE", "print elastic constants of a bonded packing, without a run", true,
     false,
     "Solves for the equilibrium of the bonds as springs: E and nu of the scene's test, the "
     "stiffness\ntensor of the packing, and estimates by uniform strain and stress. It writes "
     "nothing.\n",
     "gneiss stiffness scenes/compression.yaml\n"
     "gneiss stiffness scenes/compression.yaml --set materials.rock.kratio=5 --json\n"},
    {"pack", "FILE", "fill the shape of a specimen with particles, print and store its quality",
     true, false, "The file is a scene, or the part `specimen` of one alone.\n",
     "gneiss pack scenes/pack-uniform.yaml --out runs/pack-uniform\n"},
    {"sweep", "FILE", "run a scene with several values of its keys, side by side", true, false,
     "The file names a scene and the values of some of its keys (docs/sweep.md). Repeating "
     "the\ncommand completes the missing runs.\n",
     "gneiss sweep scenes/sweep-strength.yaml --dry-run\n"
     "gneiss sweep scenes/sweep-strength.yaml --jobs 2\n"},
    {"calibrate", "TARGETS", "find the parameters that give a material the wanted readings", true,
     false,
     "The file names a specimen and wanted readings with tolerances (docs/calibrate.md). "
     "Repeating\nthe command continues an interrupted calibration.\n",
     "gneiss calibrate scenes/calibrate-sandstone.yaml --out runs/sandstone\n"},
    {"resume", "DIR", "continue from the newest checkpoint in an output folder", true, false,
     "--set takes keys of time, output and run, and ends of stages. A later time.end prolongs a\n"
     "finished run.\n",
     "gneiss resume runs/ucs-rock\n"
     "gneiss resume runs/ucs-rock --set time.end=8ms\n"},
    {"status", "DIR", "print how far the run in an output folder is", true, false,
     "Reads status.json, which a run replaces every five seconds, and looks whether its process is "
     "still\nthere: running, finished, stopped, failed or killed.\n",
     "gneiss status runs/ucs-rock\n"},
    {"report", "DIR", "make report.html from the results of a run, a packing or a sweep", true,
     false, "It can be made during the run.\n", "gneiss report runs/ucs-rock\n"},
    {"view", "DIR", "make view.html, in which a run turns and moves in a browser", true, false,
     "One file from the snapshots: particles, bonds, cracks, elements and tools over time, colours "
     "by\nfield, cuts, curves of the history (docs/view.md). It can be made during the run.\n",
     "gneiss view runs/ucs-rock\n"
     "gneiss view runs/ucs-rock --instants 40 --fields damage,velocity,force\n"
     "gneiss view runs/ucs-rock --paraview\n"},
    {"convert", "IN OUT",
     "write particles or a mesh of another program as a file that gneiss reads, or back", true,
     true,
     "IN: a run or packing; text with columns (CSV, YADE), data or dump of LAMMPS and LIGGGHTS,\n"
     "geometry of ESyS-Particle, points of VTK. OUT: .txt or .csv (for specimen.file), .yade,\n"
     ".data, .dump, .geo, .vtp. It prints number and volume, and what OUT has no place for\n"
     "(docs/files.md).\n",
     "gneiss convert dump.granular particles.txt\n"
     "gneiss convert runs/ucs-rock ucs-rock.vtp\n"},
    {"keys", "[TEXT ...]",
     "print the keys of a scene file, or those that contain a text (--markdown for docs)", false,
     true,
     "Each of several words must occur in the path, the text or the values of a key. Terms of "
     "the\nfield and of other programs are known as well: CMOD, confining, restart, vtk, clump, "
     "joint.\n",
     "gneiss keys friction\n"
     "gneiss keys bond strength\n"},
    {"explain", "KEY", "print text, values, example and pages of one key", true, false,
     "The key is a path, or the end of one: walls.motion.vz, motion.vz, skin. Names of elements "
     "may\nstand in it: walls.top.motion.vz.\n",
     "gneiss explain time.step\n"
     "gneiss explain friction\n"},
    {"schema", "[FILE KIND]", "print the JSON Schema of scene files, or of another kind of file",
     false, false,
     "The kinds are scene, pack, sweep and calibrate. Editors complete and check files by it\n"
     "(docs/schema.md).\n",
     "gneiss schema\n"
     "gneiss schema sweep\n"},
    {"completion", "SHELL", "print completions for bash, zsh or fish", true, false,
     "They complete commands, options, files, and keys after --set and explain.\n",
     "gneiss completion bash > ~/.local/share/bash-completion/completions/gneiss\n"},
    {"info", "", "print version, instruction sets, threads", false, false, "", "gneiss info\n"},
    {"help", "[COMMAND]", "print this, the options of a command, or exit-codes", false, false, "",
     "gneiss help run\n"},
    {"version", "", "print the version, the commit and the compiler", false, false, "",
     "gneiss version\n"},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

#define LISTED(set, lanes, has) #set ", "
#define SETS_LISTED             GN_INSTRUCTION_SETS(LISTED) "auto"

const gn_option_text gn_option_texts[] = {
    {"run check plan pack sweep calibrate", "--out DIR",
     "output folder (default: runs/ and the name of the scene or sweep file)"},
    {"run check plan stiffness pack sweep resume", "--set KEY=VALUE",
     "override a key of the scene: --set time.end=2ms, --set\nwalls.top.friction=0.2"},
    {"run check plan stiffness pack sweep calibrate resume", "--threads N",
     "threads (default, and 0: all cores)"},
    {"run check plan stiffness pack sweep", "--seed N", "seed of all random numbers"},
    {"run check plan sweep", "--precision P", "double or mixed"},
    {"run check plan sweep resume", "--isa NAME",
     SETS_LISTED " (default: GNEISS_ISA, else the widest)"},
    {"run pack plan sweep calibrate convert", "--force",
     "run: replace also the results of a run of more than a minute; run,\npack: files not written "
     "by gneiss; sweep: compute everything anew;\nconvert: OUT"},
    {"run check plan stiffness pack sweep resume", "--allow-gmsh",
     "let gmsh mesh a specimen given as geometry (.geo, .step, ...), which can\nmake it execute "
     "any command: only for trusted files"},
    {"run sweep calibrate", "--seeds N",
     "run, sweep: number of seeds (or a list: 3,7,11); mean and 95 % interval\nof every reading; "
     "run writes to runs/<scene name>-seeds"},
    {"run sweep", "--jobs N",
     "sweep, run of several seeds or confinements: simultaneous runs (default:\nnumber of "
     "threads)"},
    {"run sweep", "--dry-run",
     "sweep, run of several: list the runs and their estimated cost, run nothing"},
    {"sweep", "--array [I/N]", "sweep: only shard I of N, or that of Slurm's job array"},
    {"sweep", "--collect", "sweep: only summarise the existing runs"},
    {"run plan", "--error E",
     "plan: the cheapest settings for an error of 5%, its causes, and seconds;\nrun: runs the "
     "scene with them, as many packings as it takes"},
    {"run plan", "--reading R", "--error: error of the strength (default) or the stiffness"},
    {"run plan", "--particles any",
     "--error: the number of particles may change as well, with\nrecalibrated contacts"},
    {"plan", "--write FILE",
     "plan --error: write the scene with the proposed settings (--force replaces\nFILE)"},
    {"stiffness", "--json", "stiffness: one JSON object on standard output"},
    {"stiffness", "--strain E",
     "stiffness: strain up to which the test is loaded (default 1e-5;\nbetween walls that of the "
     "predicted peak)"},
    {"view", "--instants N", "view: most snapshots that it shows (default 20)"},
    {"view", "--fields LIST",
     "view: colours to choose from: damage,velocity,stress_zz,force or all\n(default: those that "
     "tell most; force: of bonds)"},
    {"view", "--paraview",
     "view: write paraview_state.py, which opens the run in ParaView, and\nrun.vtkhdf, all "
     "snapshots in "
     "one file for ParaView 5.13 and later"},
    {"convert", "--length UNIT", "convert: unit of lengths in IN that states none (default m)"},
    {"convert", "--density D", "convert: density in kg/m3 of particles that have none"},
    {"convert", "--columns 'X ...'", "convert: names of columns of a text without a header"},
    {"convert", "--as NAME=COLUMN", "convert: takes a column of IN as another one: tag=group"},
    {"convert", "--frame N", "convert: frame of a dump, base 1 (default: the last)"},
    {"run check plan pack sweep calibrate convert resume", "--quiet",
     "only results: readings and warnings, no progress and no profile"},
    {ALL_COMMANDS, "--log json", "JSON objects on standard output, one a line (docs/log.md)"},
    {"keys", "--markdown", "keys: as Markdown"},
    {"help", "--man", "as a page of the manual, in the format of man"},
    {"", "--help (-h), --version", ""},
    {NULL, NULL, NULL},
};

const gn_command *gn_command_named(const char *name) {
    for (size_t k = 0; k < COMMANDS; k++)
        if (strcmp(commands[k].name, name) == 0) return &commands[k];
    return NULL;
}

const gn_command *gn_command_at(size_t index) {
    return index < COMMANDS ? &commands[index] : NULL;
}

bool gn_command_takes(const gn_command *command, const gn_option_text *option) {
    const size_t length = strlen(command->name);
    const char *list = option->commands;
    for (const char *at = strstr(list, command->name); at; at = strstr(at + 1, command->name))
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || !at[length])) return true;
    return false;
}

/* Prints the lines of a text, the first of them after the name. */
static void print_option(FILE *out, const char *name, const char *text) {
    fprintf(out, *text ? "  %-18s " : "  %s", name);
    for (; *text; text++) {
        fputc(*text, out);
        if (*text == '\n') fprintf(out, "%21s", "");
    }
    fputc('\n', out);
}

static void print_options(FILE *out, const gn_command *command) {
    bool any = false;
    for (const gn_option_text *o = gn_option_texts; o->name; o++) {
        if (command && !gn_command_takes(command, o)) continue;
        if (!any) fputs("\noptions:\n", out);
        any = true;
        print_option(out, o->name, o->text);
    }
}

static void print_one(FILE *out, const gn_command *command) {
    fprintf(out, "gneiss %s%s%s: %s\n", command->name, *command->arguments ? " " : "",
            command->arguments, command->text);
    if (*command->more) fprintf(out, "\n%s", command->more);
    print_options(out, command);
    fprintf(out, "\nexample%s:\n", strchr(command->examples, '\n')[1] ? "s" : "");
    for (const char *line = command->examples; *line; line = strchr(line, '\n') + 1)
        fprintf(out, "  %.*s\n", (int)strcspn(line, "\n"), line);
}

void gn_print_help(FILE *out, const gn_command *command) {
    if (command) {
        print_one(out, command);
        return;
    }
    fprintf(out,
            "gneiss %s: bonded discrete and finite elements for rock and concrete\n\nusage: gneiss "
            "COMMAND [options]\n\ncommands:\n",
            gn_version());
    for (size_t k = 0; k < COMMANDS; k++)
        fprintf(out, "  %-10s %-11s %s\n", commands[k].name, commands[k].arguments,
                commands[k].text);
    print_options(out, NULL);
    fputs("\nexit codes:\n", out);
    gn_print_exit_codes(out);
    fputs("\ngneiss help COMMAND: options of a command, with an example\n", out);
}

void gn_print_exit_codes(FILE *out) {
    for (int code = 0; gn_exit_code_text(code); code++)
        fprintf(out, "  %d %s\n", code, gn_exit_code_text(code));
}

void gn_print_version(FILE *out) {
    const char *commit = gn_commit();
    fprintf(out, "gneiss %s (%s%s%s%s)\n", gn_version(), *commit ? "commit " : "", commit,
            *commit ? ", " : "", gn_build());
}
