#define _GNU_SOURCE /* fopencookie */
#include "cli/log.h"

#include "io/io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LINE_FIRST = 1 << 10, ID_SIZE = 64 };

/* A stream whose lines are printed as JSON objects. */
typedef struct line_stream {
    gn_log *log;
    FILE *stream, *former;
    bool errors; /* standard error */
    size_t used, capacity;
    char *line; /* [capacity] */
} line_stream;

struct gn_log {
    const char *command;
    char level[16],
        id[ID_SIZE]; /* level and id of the last message; lines that continue it get the same */
    line_stream out, errors;
};

/* ---- the parts of a message ---- */

static bool starts(const char **text, const char *with) {
    const size_t length = strlen(with);
    if (strncmp(*text, with, length) != 0) return false;
    *text += length;
    return true;
}

/* Moves past "name: " if the name has only characters that keys may have. */
static bool take_name(const char **text, char *name, size_t size) {
    const size_t length = strspn(*text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                        "0123456789_.[]-");
    if (!length || length >= size || strncmp(*text + length, ": ", 2) != 0) return false;
    snprintf(name, size, "%.*s", (int)length, *text);
    *text += length + 2;
    return true;
}

static bool take_level(gn_log *log, const char **text) {
    if (!starts(text, "gneiss: ")) return false;
    snprintf(log->level, sizeof log->level, "info");
    snprintf(log->id, sizeof log->id, "%s", log->command);
    for (int code = GNEISS_ERROR_INTERNAL; code <= GNEISS_INTERRUPTED; code++) {
        const char *name = gn_status_name((gneiss_status)code);
        const size_t length = strlen(name);
        if (strncmp(*text, name, length) != 0 || strncmp(*text + length, ": ", 2) != 0) continue;
        *text += length + 2;
        snprintf(log->level, sizeof log->level, "error");
        snprintf(log->id, sizeof log->id, "%s", name);
        for (char *c = log->id; *c; c++)
            if (*c == ' ') *c = '_';
        return true;
    }
    const bool warning = starts(text, "warning: ");
    if (!warning && !starts(text, "note: ")) return true;
    snprintf(log->level, sizeof log->level, "%s", warning ? "warning" : "note");
    if (!warning || !take_name(text, log->id, sizeof log->id))
        snprintf(log->id, sizeof log->id, "%s", log->level);
    return true;
}

/* Writes file, line and column of "FILE:LINE:COLUMN: ", or the option of "--set KEY: ". */
static void write_place(gn_json *json, const char **text) {
    char option[512];
    const char *rest = *text;
    if (starts(&rest, "--set ")) {
        const size_t length = strcspn(rest, ":");
        if (strncmp(rest + length, ": ", 2) != 0 || length >= sizeof option) return;
        snprintf(option, sizeof option, "%.*s", (int)length, rest);
        gn_json_text(json, "set", option);
        *text = rest + length + 2;
        return;
    }
    for (const char *at = strchr(*text, ':'); at; at = strchr(at + 1, ':')) {
        int line = 0, column = 0, used = 0;
        if (sscanf(at, ":%9d:%9d: %n", &line, &column, &used) != 2 || !used) continue;
        char *file = strndup(*text, (size_t)(at - *text));
        if (file) gn_json_text(json, "file", file);
        free(file);
        gn_json_integer(json, "line", line);
        gn_json_integer(json, "column", column);
        *text = at + used;
        return;
    }
}

/* Writes a part of a message, without quotation marks that enclose it. */
static void write_part(gn_json *json, const char *key, const char *text, size_t length) {
    const bool quoted = length > 1 && text[0] == '\'' && text[length - 1] == '\'' &&
                        !memchr(text + 1, '\'', length - 2);
    char *part = strndup(text + quoted, length - 2 * quoted);
    if (part) gn_json_text(json, key, part);
    free(part);
}

/* Writes the parts of "expected X, found Y", "needs X; found Y", "unknown key 'X'; did you mean
 * 'Y'?" and "unknown key 'X'; X of PROGRAM is Y: ...". */
static void write_expectation(gn_json *json, const char *text) {
    const char *wanted = strstr(text, "expected "), *meant = strstr(text, "did you mean '"),
               *other = strstr(text, " is "), *found = wanted ? strstr(wanted, ", found ") : NULL;
    if (wanted) wanted += sizeof "expected " - 1;
    if (!wanted && strncmp(text, "needs ", 6) == 0) wanted = text + 6;
    if (wanted && !found) found = strstr(wanted, "; found ");
    if (found) {
        write_part(json, "expected", wanted, (size_t)(found - wanted));
        write_part(json, "found", found + 8, strlen(found + 8));
    } else if (strncmp(text, "required, but not given", 23) == 0) {
        gn_json_text(json, "expected", "a value");
        gn_json_text(json, "found", "nothing");
    } else if (strncmp(text, "unknown ", 8) == 0 && strchr(text, '\'')) {
        const char *name = strchr(text, '\'') + 1;
        if (meant)
            write_part(json, "expected", meant + 14, strcspn(meant + 14, "'"));
        else if (wanted)
            write_part(json, "expected", wanted, strlen(wanted));
        else if (other)
            write_part(json, "expected", other + 4, strcspn(other + 4, ": "));
        write_part(json, "found", name, strcspn(name, "'"));
    }
}

/* ---- objects ---- */

static gn_json *begin(const char *level, const char *id) {
    char text[64], all[80];
    struct timespec now;
    struct tm utc;
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
    snprintf(all, sizeof all, "%s.%03ldZ", text, now.tv_nsec / 1000000);
    gn_json *json = gn_json_begin();
    gn_json_text(json, "time", all);
    gn_json_text(json, "level", level);
    gn_json_text(json, "id", id);
    return json;
}

/* `more`: further members after those of `json`, and the closing brace; NULL: none. */
static bool print_and_free(gn_log *log, gn_json *json, const char *more) {
    char *text = gn_json_finish(json, false);
    if (!text) return false;
    FILE *out = log->out.former;
    const int length = (int)strlen(text);
    fprintf(out, "%.*s%s%s\n", more ? length - 1 : length, text, more ? "," : "", more ? more : "");
    free(text);
    return fflush(out) == 0 && !ferror(out);
}

static bool print_message(gn_log *log, const char *line) {
    char key[512];
    const char *text = line;
    take_level(log, &text);
    text += strspn(text, " ");
    gn_json *json = begin(log->level, log->id);
    gn_json_text(json, "text", text);
    write_place(json, &text);
    if (strcmp(log->level, "info") != 0 && take_name(&text, key, sizeof key))
        gn_json_text(json, "key", key);
    write_expectation(json, text);
    return print_and_free(log, json, NULL);
}

static bool print_line(line_stream *s, const char *line) {
    gn_log *log = s->log;
    line += strspn(line, "\r");
    if (!line[strspn(line, " ")]) return true;
    if (s->errors) return print_message(log, line);
    const bool progress = strncmp(line, "{\"progress\":", 12) == 0;
    if (progress || strncmp(line, "{\"result\":", 10) == 0)
        return print_and_free(log, begin(progress ? "progress" : "result", log->command), line + 1);
    gn_json *json = begin("info", log->command);
    gn_json_text(json, "text", line);
    return print_and_free(log, json, NULL);
}

/* Returns false if there is no memory: the line is then cut. */
static bool append(line_stream *s, char byte) {
    if (s->used + 1 >= s->capacity) {
        const size_t capacity = s->capacity ? 2 * s->capacity : LINE_FIRST;
        char *more = realloc(s->line, capacity);
        if (!more) return false;
        s->line = more;
        s->capacity = capacity;
    }
    s->line[s->used++] = byte;
    s->line[s->used] = '\0';
    return true;
}

static ssize_t write_lines(void *cookie, const char *bytes, size_t size) {
    line_stream *s = cookie;
    bool good = true;
    if (s->errors) good = fwrite(bytes, 1, size, s->former) == size;
    for (size_t k = 0; k < size; k++) {
        if (bytes[k] != '\n') {
            good = append(s, bytes[k]) && good;
            continue;
        }
        if (s->used) good = print_line(s, s->line) && good;
        s->used = 0;
    }
    return good ? (ssize_t)size : 0;
}

static bool open_stream(gn_log *log, line_stream *s, FILE *former, bool errors) {
    s->log = log;
    s->former = former;
    s->errors = errors;
    s->stream = fopencookie(s, "w", (cookie_io_functions_t){.write = write_lines});
    if (!s->stream) return false;
    setvbuf(s->stream, NULL, errors ? _IONBF : _IOLBF, 0);
    return true;
}

gn_log *gn_log_begin(const char *command) {
    gn_log *log = calloc(1, sizeof *log);
    if (!log) return NULL;
    log->command = command;
    snprintf(log->level, sizeof log->level, "info");
    snprintf(log->id, sizeof log->id, "%s", command);
    if (!open_stream(log, &log->out, stdout, false) ||
        !open_stream(log, &log->errors, stderr, true)) {
        if (log->out.stream) fclose(log->out.stream);
        free(log);
        return NULL;
    }
    stdout = log->out.stream;
    stderr = log->errors.stream;
    return log;
}

bool gn_log_end(gn_log *log, gneiss_status status) {
    if (!log) return true;
    bool good = !ferror(stdout);
    if (log->out.used) good = fputc('\n', stdout) != EOF && good;
    if (log->errors.used) fputc('\n', stderr);
    gn_json *json = begin("end", log->command);
    gn_json_integer(json, "code", status);
    gn_json_text(json, "text", gn_exit_code_text((int)status));
    good = print_and_free(log, json, NULL) && good;
    stdout = log->out.former;
    stderr = log->errors.former;
    fclose(log->out.stream);
    fclose(log->errors.stream);
    free(log->out.line);
    free(log->errors.line);
    free(log);
    return good;
}

void gn_print_object(const char *kind, char *text) {
    printf("{\"%s\":", kind);
    for (const char *at = text; at && *at;) {
        const size_t length = strcspn(at, "\n");
        fwrite(at, 1, length, stdout);
        at += length;
        at += strspn(at, "\n ");
    }
    fputs(text ? "}\n" : "null}\n", stdout);
    free(text);
    fflush(stdout);
}

const char *gn_exit_code_text(int code) {
    static const char *const texts[] = {
        "done",
        "a defect of gneiss",
        "the input cannot be used, or a named scene, folder or file does not exist",
        "a file could not be read or written",
        "out of memory",
        "unstable run: not a number, a lost particle, a step too long, an open energy balance",
        "interrupted; a checkpoint was written if the run had begun",
    };
    return code >= 0 && code < (int)(sizeof texts / sizeof *texts) ? texts[code] : NULL;
}
