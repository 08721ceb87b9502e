#include "cli/generate.h"
#include "scene/manifest.h"

#include <string.h>

/* ---- parts of the texts of options ---- */

/* Calls `print` for each option, such as "--out" of "--out DIR"; `value`: the option takes one. */
static void each_option(const gn_command *command,
                        void (*print)(const char *name, int length, bool value,
                                      const gn_option_text *option)) {
    for (const gn_option_text *o = gn_option_texts; o->name; o++) {
        if (!gn_command_takes(command, o)) continue;
        const int length = (int)strcspn(o->name, " ");
        print(o->name, length, o->name[length] != '\0', o);
    }
}

/* Returns the words that an option accepts; "": a file, a number or a key. */
static const char *words_of(const char *name) {
    static const char *const words[][2] = {{"--log", "json text"},
                                           {"--precision", "double mixed"},
                                           {"--reading", "strength stiffness"},
                                           {"--particles", "any"}};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strncmp(name, words[k][0], strlen(words[k][0])) == 0) return words[k][1];
    return "";
}

/* Prints a text in single quotes for a shell; a quote inside becomes a comma. */
static void put_quoted(const char *text) {
    putchar('\'');
    for (; *text && *text != '\n'; text++) putchar(*text == '\'' ? ',' : *text);
    putchar('\'');
}

static void print_name(const char *name, int length, bool value, const gn_option_text *option) {
    (void)value, (void)option;
    printf(" %.*s", length, name);
}

static void print_all_names(void) {
    for (size_t k = 0; gn_command_at(k); k++) printf(" %s", gn_command_at(k)->name);
}

/* ---- bash ---- */

static void print_bash(void) {
    fputs("# Completions of gneiss for bash, printed by `gneiss completion bash`.\n"
          "_gneiss() {\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options=\n"
          "    COMPREPLY=()\n"
          "    if ((COMP_CWORD == 1)); then\n"
          "        COMPREPLY=($(compgen -W '",
          stdout);
    print_all_names();
    fputs("' -- \"$word\"))\n        return\n    fi\n    case $before in\n", stdout);
    for (const gn_option_text *o = gn_option_texts; o->name; o++)
        if (*words_of(o->name) && (o == gn_option_texts || strcmp(o->name, o[-1].name) != 0))
            printf("    %.*s) COMPREPLY=($(compgen -W '%s' -- \"$word\")); return ;;\n",
                   (int)strcspn(o->name, " "), o->name, words_of(o->name));
    fputs("    --set | explain)\n"
          "        COMPREPLY=($(compgen -W \"$(gneiss completion keys)\" -- \"$word\"))\n"
          "        return ;;\n"
          "    help) COMPREPLY=($(compgen -W 'exit-codes ",
          stdout);
    print_all_names();
    fputs("' -- \"$word\")); return ;;\n"
          "    schema) COMPREPLY=($(compgen -W 'scene pack sweep calibrate' -- \"$word\")); return "
          ";;\n"
          "    completion) COMPREPLY=($(compgen -W 'bash zsh fish' -- \"$word\")); return ;;\n"
          "    esac\n    case ${COMP_WORDS[1]} in\n",
          stdout);
    for (size_t k = 0; gn_command_at(k); k++) {
        printf("    %s) options='", gn_command_at(k)->name);
        each_option(gn_command_at(k), print_name);
        fputs("' ;;\n", stdout);
    }
    fputs("    esac\n"
          "    if [[ $word == -* ]]; then\n"
          "        COMPREPLY=($(compgen -W \"$options --help\" -- \"$word\"))\n"
          "    else\n"
          "        compopt -o filenames 2>/dev/null\n"
          "        COMPREPLY=($(compgen -f -- \"$word\"))\n"
          "    fi\n"
          "}\n"
          "complete -F _gneiss gneiss\n",
          stdout);
}

/* ---- zsh ---- */

/* Prints such as "--out[output folder]:DIR:_files". */
static void print_zsh_option(const char *name, int length, bool value,
                             const gn_option_text *option) {
    const bool key = strncmp(name, "--set", 5) == 0;
    printf(" '%s%.*s[", key ? "*" : "", length, name);
    for (const char *c = option->text; *c && *c != '\n'; c++)
        putchar(*c == '\'' || *c == '[' || *c == ']' ? ',' : *c);
    putchar(']');
    if (value && *words_of(name))
        printf(":value:(%s)", words_of(name));
    else if (value)
        printf(":value:%s", key ? "_gneiss_keys" : "_files");
    putchar('\'');
}

static void print_zsh(void) {
    fputs("#compdef gneiss\n"
          "# Completions of gneiss for zsh, printed by `gneiss completion zsh`.\n"
          "_gneiss_keys() { compadd -- ${(f)\"$(gneiss completion keys)\"} }\n"
          "_gneiss() {\n"
          "  if ((CURRENT == 2)); then\n"
          "    local -a commands=(",
          stdout);
    for (size_t k = 0; gn_command_at(k); k++) {
        char text[256];
        snprintf(text, sizeof text, "%s:%s", gn_command_at(k)->name, gn_command_at(k)->text);
        putchar(' ');
        put_quoted(text);
    }
    fputs(")\n    _describe command commands\n    return\n  fi\n"
          "  local command=${words[2]}\n  shift words\n  ((CURRENT--))\n  case $command in\n",
          stdout);
    for (size_t k = 0; gn_command_at(k); k++) {
        const char *name = gn_command_at(k)->name;
        printf("  %s) _arguments", name);
        each_option(gn_command_at(k), print_zsh_option);
        printf(" '*:argument:%s' ;;\n", strcmp(name, "explain") == 0 ? "_gneiss_keys"
                                        : strcmp(name, "schema") == 0
                                            ? "(scene pack sweep calibrate)"
                                            : "_files");
    }
    fputs(
        "  esac\n}\n[[ ${funcstack[1]} == _gneiss ]] && _gneiss \"$@\" || compdef _gneiss gneiss\n",
        stdout);
}

/* ---- fish ---- */

static void print_fish(void) {
    fputs("# Completions of gneiss for fish, printed by `gneiss completion fish`.\n", stdout);
    for (size_t k = 0; gn_command_at(k); k++) {
        const gn_command *command = gn_command_at(k);
        printf("complete -c gneiss -n __fish_use_subcommand -f -a %s -d ", command->name);
        put_quoted(command->text);
        putchar('\n');
    }
    for (const gn_option_text *o = gn_option_texts; o->name; o++) {
        if (!*o->commands) continue;
        const int length = (int)strcspn(o->name, " ");
        printf("complete -c gneiss -n '__fish_seen_subcommand_from %s' -l %.*s", o->commands,
               length - 2, o->name + 2);
        if (o->name[length] && o->name[length + 1] != '[') fputs(" -r", stdout);
        if (strncmp(o->name, "--set ", 6) == 0) fputs(" -f -a '(gneiss completion keys)'", stdout);
        if (*words_of(o->name)) printf(" -f -a '%s'", words_of(o->name));
        fputs(" -d ", stdout);
        put_quoted(o->text);
        putchar('\n');
    }
    fputs("complete -c gneiss -n '__fish_seen_subcommand_from explain' -f -a "
          "'(gneiss completion keys)'\n",
          stdout);
}

/* ---- the command ---- */

static void print_path(void *context, const char *path, const gn_key *key) {
    (void)context, (void)key;
    for (; *path; path++)
        if (*path != '[' && *path != ']') putchar(*path);
    putchar('\n');
}

gneiss_status gn_command_completion(const gn_options *options, gneiss_error *error) {
    if (strcmp(options->target, "bash") == 0)
        print_bash();
    else if (strcmp(options->target, "zsh") == 0)
        print_zsh();
    else if (strcmp(options->target, "fish") == 0)
        print_fish();
    else if (strcmp(options->target, "keys") == 0)
        gn_scene_visit_keys(print_path, NULL);
    else
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss completion: expected bash, zsh or fish, found '%s'",
                       options->target);
    return GNEISS_OK;
}
