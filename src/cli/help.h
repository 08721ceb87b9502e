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

/* Prints the help of all commands (NULL), or usage, options and examples of one. */
void gn_print_help(FILE *out, const gn_command *command);

/* Prints "gneiss 0.1.0 (commit 0123abcd, gcc 12.2.0 release)". */
void gn_print_version(FILE *out);

#endif
