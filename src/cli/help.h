/* The commands of the program, and what is said of them. */
#ifndef GN_CLI_HELP_H
#define GN_CLI_HELP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct gn_command {
    const char *name, *arguments, *text;
    bool needs_target;
    bool several;         /* takes several words */
    const char *more;     /* paragraphs of its own help */
    const char *examples; /* a line each */
} gn_command;

/* NULL: there is none of that name, or no more. */
const gn_command *gn_command_named(const char *name);
const gn_command *gn_command_at(size_t index);

/* Of all commands (NULL), or of one: its usage, options and examples. */
void gn_print_help(FILE *out, const gn_command *command);

/* "gneiss 0.1.0 (commit 0123abcd, gcc 12.2.0 release)" */
void gn_print_version(FILE *out);

#endif
