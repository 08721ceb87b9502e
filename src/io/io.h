/* Small text files, which are written atomically; folders; JSON text. */
#ifndef GN_IO_IO_H
#define GN_IO_IO_H

#include "io/atomic_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Creates the folder and its parents; checks that it is writable. On failure the folders that it
 * created are removed. */
gneiss_status gn_make_directory(const char *path, gneiss_error *error);

/* Writes `text` to path.tmp and commits it. */
gneiss_status gn_write_text_file(const char *path, const char *text, gn_durability durability,
                                 gneiss_error *error);

/* Reads a whole file into a NUL-terminated malloc'ed string. GNEISS_ERROR_INPUT: it is a folder,
 * has more than `limit` bytes, or contains a zero byte; GNEISS_ERROR_IO: it cannot be opened or
 * read. */
gneiss_status gn_read_text_file(const char *path, size_t limit, char **text, gneiss_error *error);

/* Reads a whole file, malloc'ed. GNEISS_ERROR_IO: it cannot be opened or read; GNEISS_ERROR_INPUT:
 * it is empty or ends before its size. */
gneiss_status gn_read_bytes(const char *path, void **bytes, size_t *size, gneiss_error *error);

/* gn_text_open opens a stream into a text; gn_text_close closes it. *text then points to the *size
 * bytes, which the caller frees. `what` names the text in the message if memory is lacking. */
gneiss_status gn_text_open(char **text, size_t *size, FILE **out, const char *what,
                           gneiss_error *error);
gneiss_status gn_text_close(FILE *out, const char *what, gneiss_error *error);

/* A minimal JSON writer: numbers in full precision, NaN and infinity as null, strings escaped. */
typedef struct gn_json gn_json;
gn_json *gn_json_begin(void);                        /* opens an object */
void gn_json_object(gn_json *json, const char *key); /* nested object; key is NULL inside arrays */
void gn_json_array(gn_json *json, const char *key);
void gn_json_end(gn_json *json); /* closes the innermost object or array */
void gn_json_number(gn_json *json, const char *key, double value);
void gn_json_integer(gn_json *json, const char *key, int64_t value);
void gn_json_text(gn_json *json, const char *key, const char *value);
void gn_json_bool(gn_json *json, const char *key, bool value);
/* Writes numbers, including integers: GN_JSON_NUMBERS(json, {"steps", steps}, {"seconds",
 * seconds}); */
typedef struct gn_json_pair {
    const char *key;
    double value;
} gn_json_pair;
void gn_json_numbers(gn_json *json, const gn_json_pair *pairs, size_t count);
#define GN_JSON_NUMBERS(JSON, ...)                                                                 \
    gn_json_numbers((JSON), (const gn_json_pair[]){__VA_ARGS__},                                   \
                    sizeof((const gn_json_pair[]){__VA_ARGS__}) / sizeof(gn_json_pair))
/* Closes open objects, returns the malloc'ed text (NULL: out of memory) and frees the builder. With
 * `pretty` the text is indented, otherwise it is one line. */
char *gn_json_finish(gn_json *json, bool pretty);

#endif
