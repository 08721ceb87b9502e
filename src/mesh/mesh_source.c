#include "mesh/mesh_private.h"

#include "base/memory.h"
#include "io/decimal.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static gneiss_status read_whole(gn_mesh_source *in, FILE *file) {
    struct stat info;
    if (fstat(fileno(file), &info) != 0)
        return gn_fail(in->error, GNEISS_ERROR_IO, "%s: cannot be read: %s", in->path,
                       strerror(errno));
    if (!S_ISREG(info.st_mode))
        return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s: expected a mesh file, found %s",
                       in->path, S_ISDIR(info.st_mode) ? "a folder" : "no regular file");
    size_t size = (size_t)info.st_size;
    in->bytes = gn_alloc(size + 1);
    if (!in->bytes) return gn_mesh_no_memory(in);
    in->size = fread(in->bytes, 1, size, file);
    in->end = in->size;
    if (ferror(file))
        return gn_fail(in->error, GNEISS_ERROR_IO, "%s: cannot be read: %s", in->path,
                       strerror(errno));
    return GNEISS_OK;
}

static gneiss_status check_encoding(gn_mesh_source *in) {
    static const unsigned char utf8_mark[] = {0xef, 0xbb, 0xbf};
    const unsigned char *b = in->bytes;
    if (in->size == 0)
        return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s: expected a mesh, found an empty file",
                       in->path);
    if (in->size >= 2 && ((b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff)))
        return gn_fail(in->error, GNEISS_ERROR_INPUT,
                       "%s: expected plain text or binary, found UTF-16", in->path);
    if (in->size >= 3 && memcmp(b, utf8_mark, 3) == 0) in->at = 3;
    return GNEISS_OK;
}

gneiss_status gn_mesh_source_open(gn_mesh_source *in, const char *path, double scale,
                                  gneiss_error *error) {
    *in = (gn_mesh_source){.path = path, .error = error, .scale = scale, .section = ""};
    if (!(isfinite(scale) && scale > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a scale > 0, found %g", path,
                       scale);
    FILE *file = fopen(path, "re");
    if (!file) {
        /* A path that does not exist is an input error; any other failure is an error of the
         * machine. */
        bool wrong_name = errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG;
        return gn_fail(error, wrong_name ? GNEISS_ERROR_INPUT : GNEISS_ERROR_IO,
                       "%s: cannot be opened: %s", path, strerror(errno));
    }
    gneiss_status status = read_whole(in, file);
    fclose(file);
    return status == GNEISS_OK ? check_encoding(in) : status;
}

void gn_mesh_source_close(gn_mesh_source *in) {
    gn_free(in->bytes);
    in->bytes = NULL;
}

gneiss_status gn_mesh_no_memory(const gn_mesh_source *in) {
    return gn_fail(in->error, GNEISS_ERROR_MEMORY, "%s: no memory for this mesh", in->path);
}

/* Lines are counted here and not during reading, because only messages need them. */
static void locate(const gn_mesh_source *in, size_t at, size_t *line, size_t *column) {
    size_t start = 0;
    *line = 1;
    for (size_t k = 0; k < at && k < in->size; k++) {
        bool ends = in->bytes[k] == '\n' || (in->bytes[k] == '\r' && in->bytes[k + 1] != '\n');
        if (!ends) continue;
        ++*line;
        start = k + 1;
    }
    *column = at - start + 1;
}

gneiss_status gn_mesh_refuse(const gn_mesh_source *in, size_t at, const char *format, ...) {
    char what[512];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    if (in->by_offset)
        return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s: %s%sbyte %zu: %s", in->path, in->section,
                       in->section[0] ? ", " : "", at, what);
    size_t line, column;
    locate(in, at, &line, &column);
    return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s:%zu:%zu: %s", in->path, line, column, what);
}

bool gn_mesh_is_blank(unsigned char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

bool gn_mesh_is_space(unsigned char c) {
    return gn_mesh_is_blank(c) || c == '\n' || c == '\r';
}

gn_mesh_shown gn_mesh_show(const gn_mesh_source *in, size_t at) {
    gn_mesh_shown out = {0};
    size_t k = 0;
    for (; k < 40 && at + k < in->size && !gn_mesh_is_space(in->bytes[at + k]); k++)
        out.text[k] = (char)(isprint(in->bytes[at + k]) ? in->bytes[at + k] : '?');
    if (k == 40) strcpy(out.text + k, "...");
    return out;
}

void gn_mesh_next_row(gn_mesh_source *in) {
    if (in->binary) return;
    while (in->at < in->end && gn_mesh_is_space(in->bytes[in->at])) in->at++;
}

size_t gn_mesh_field_start(gn_mesh_source *in) {
    while (!in->binary && in->at < in->end && gn_mesh_is_blank(in->bytes[in->at])) in->at++;
    return in->at;
}

gneiss_status gn_mesh_take_field(gn_mesh_source *in, const char *what, size_t *start,
                                 size_t *length) {
    *start = gn_mesh_field_start(in);
    if (in->at == in->end)
        return gn_mesh_refuse(in, in->at, "expected %s, found the end of %s", what,
                              in->end == in->size ? "the file" : in->section);
    while (in->at < in->end && !gn_mesh_is_space(in->bytes[in->at])) in->at++;
    *length = in->at - *start;
    if (*length == 0)
        return gn_mesh_refuse(in, in->at, "expected %s, found the end of the line", what);
    return GNEISS_OK;
}

static gneiss_status take_bytes(gn_mesh_source *in, const char *what, void *out, size_t width) {
    if (in->end - in->at < width)
        return gn_mesh_refuse(in, in->at, "expected %s, found the end of the section", what);
    memcpy(out, in->bytes + in->at, width);
    in->at += width;
    return GNEISS_OK;
}

/* Parses [+-] digits within int64: strtoll would accept blanks and require a bounded copy. */
static bool parse_integer(const unsigned char *text, size_t length, int64_t *value) {
    size_t k = text[0] == '+' || text[0] == '-';
    if (k == length) return false;
    *value = 0;
    for (; k < length; k++) {
        int digit = text[k] - '0';
        if (digit < 0 || digit > 9) return false;
        if (text[0] == '-') digit = -digit;
        if (__builtin_mul_overflow(*value, (int64_t)10, value) ||
            __builtin_add_overflow(*value, (int64_t)digit, value))
            return false;
    }
    return true;
}

gneiss_status gn_mesh_take_integer(gn_mesh_source *in, const char *what, size_t width,
                                   int64_t least, int64_t most, int64_t *value) {
    size_t start = in->at, length;
    if (in->binary && width == 4) {
        int32_t narrow = 0;
        GN_TRY(take_bytes(in, what, &narrow, 4));
        *value = narrow;
    } else if (in->binary) {
        GN_TRY(take_bytes(in, what, value, 8));
    } else {
        GN_TRY(gn_mesh_take_field(in, what, &start, &length));
        if (!parse_integer(in->bytes + start, length, value))
            return gn_mesh_refuse(in, start, "expected %s, found '%s'", what,
                                  gn_mesh_show(in, start).text);
    }
    if (*value >= least && *value <= most) return GNEISS_OK;
    if (most == INT64_MAX)
        return gn_mesh_refuse(in, start, "expected %s of at least %lld, found %lld", what,
                              (long long)least, (long long)*value);
    return gn_mesh_refuse(in, start, "expected %s from %lld to %lld, found %lld", what,
                          (long long)least, (long long)most, (long long)*value);
}

gneiss_status gn_mesh_take_coordinates(gn_mesh_source *in, double x[3]) {
    static const char *const what[] = {"coordinate x (a finite number)",
                                       "coordinate y (a finite number)",
                                       "coordinate z (a finite number)"};
    for (int d = 0; d < 3; d++) {
        size_t start = in->at, length;
        if (in->binary) {
            GN_TRY(take_bytes(in, what[d], &x[d], sizeof x[d]));
        } else {
            GN_TRY(gn_mesh_take_field(in, what[d], &start, &length));
            if (!gn_is_decimal((const char *)in->bytes + start, length))
                return gn_mesh_refuse(in, start, "expected %s, found '%s'", what[d],
                                      gn_mesh_show(in, start).text);
            x[d] = strtod((const char *)in->bytes + start, NULL);
        }
        if (!isfinite(x[d] * in->scale))
            return gn_mesh_refuse(in, start, "expected %s, found %g times a scale of %g", what[d],
                                  x[d], in->scale);
        x[d] *= in->scale;
    }
    return GNEISS_OK;
}

gneiss_status gn_mesh_skip_numbers(gn_mesh_source *in, const char *what, size_t count) {
    for (size_t k = 0; k < count; k++) {
        size_t start, length;
        double ignored;
        if (in->binary)
            GN_TRY(take_bytes(in, what, &ignored, sizeof ignored));
        else
            GN_TRY(gn_mesh_take_field(in, what, &start, &length));
    }
    return GNEISS_OK;
}

gneiss_status gn_mesh_check_count(const gn_mesh_source *in, const char *what, int64_t count,
                                  size_t text_bytes, size_t binary_bytes) {
    /* The last row of a text need not end with white space, so that one more byte is allowed. */
    size_t room =
        in->binary ? (in->end - in->at) / binary_bytes : (in->end - in->at + 1) / text_bytes;
    if (count <= INT32_MAX && (size_t)count <= room) return GNEISS_OK;
    return gn_mesh_refuse(in, in->at, "expected at most %zu %s (%s), found a count of %lld",
                          room < INT32_MAX ? room : (size_t)INT32_MAX, what,
                          room < INT32_MAX ? "what the section has room for" : "32-bit numbers",
                          (long long)count);
}

gneiss_status gn_mesh_end_section(gn_mesh_source *in) {
    while (in->at < in->end && gn_mesh_is_space(in->bytes[in->at])) in->at++;
    if (in->at == in->end) return GNEISS_OK;
    if (in->binary)
        return gn_mesh_refuse(in, in->at, "expected the end of the section, found %zu bytes more",
                              in->end - in->at);
    return gn_mesh_refuse(in, in->at, "expected the end of %s, found '%s'", in->section,
                          gn_mesh_show(in, in->at).text);
}
