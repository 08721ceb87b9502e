/* Commands of the program and their help texts. */
#ifndef GN_CLI_HELP_H
#define GN_CLI_HELP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct gn_command {
    const char *name, *arguments, *text;
    bool needs_target;
    bool several;         /* takes several words */
    const char *more;     /* paragraphs of the command's own help */
    const char *examples; /* one per line */
} gn_command;

/* Returns the command of this name, or at this index; NULL: none. */
const gn_command *gn_command_named(const char *name);
const gn_command *gn_command_at(size_t index);

/* Text of an option, with the commands that take it, separated by blanks; the array ends with a
 * NULL name. */
typedef struct gn_option_text {
    const char *commands, *name, *text;
} gn_option_text;
extern const gn_option_text gn_option_texts[];
bool gn_command_takes(const gn_command *command, const gn_option_text *option);

/* Prints the help of all commands (NULL), or usage, options and examples of one. */
void gn_print_help(FILE *out, const gn_command *command);

/* Prints the exit codes with their meanings. */
void gn_print_exit_codes(FILE *out);

/* Prints "gneiss 0.1.0 (commit 0123abcd, gcc 12.2.0 release)". */
void gn_print_version(FILE *out);

#endif
