/* `gneiss explain KEY`: all that is known of one key. */
#ifndef GN_CLI_EXPLAIN_H
#define GN_CLI_EXPLAIN_H

#include "cli/options.h"
#include "scene/manifest.h"

/* Prints the key options->target: its text, value, default, lines of a scene, pages. */
gneiss_status gn_command_explain(const gn_options *options, gneiss_error *error);

/* Writes a value that the key accepts in a scene of the dimension, as YAML on one line. */
void gn_key_example(const gn_key *key, int dimension, char *text, size_t size);

/* A page of the documentation and the full path of a key that it mentions; made when the program
 * is built, in the order of the paths; ends with NULL. */
typedef struct gn_key_page {
    const char *key, *page;
} gn_key_page;
extern const gn_key_page gn_key_pages[];

#endif
