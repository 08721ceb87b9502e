#include "io/packing.h"
#include "io/packing_private.h"

#include "base/new.h"
#include "io/decimal.h"
#include "io/io.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

gneiss_status gn_packing_refuse(const gn_packing_reader *in, size_t at, const char *format, ...) {
    char what[512];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s:%zu:%zu: %s", in->path, in->line, at + 1,
                   what);
}

/* Reads a line, which ends with LF, CR LF or CR. *found is false at the end of the file. */
static gneiss_status next_line(gn_packing_reader *in, bool *found) {
    in->length = 0;
    in->line++;
    for (int c; (c = getc_unlocked(in->file)) != EOF;) {
        *found = true;
        if (c == '\r' && (c = getc_unlocked(in->file)) != '\n') {
            if (c != EOF) ungetc(c, in->file);
            c = '\n';
        }
        if (c == '\n') break;
        if (c == '\0') return gn_packing_refuse(in, in->length, "expected text, found a zero byte");
        if (in->length == GN_PACKING_LINE)
            return gn_packing_refuse(in, in->length,
                                     "expected a line of at most %d bytes, found a longer one",
                                     GN_PACKING_LINE);
        in->text[in->length++] = (char)c;
    }
    in->text[in->length] = '\0';
    if (!ferror(in->file)) return GNEISS_OK;
    return gn_fail(in->error, GNEISS_ERROR_IO, "%s: cannot be read: %s", in->path, strerror(errno));
}

static gneiss_status strip_byte_order_mark(gn_packing_reader *in) {
    unsigned char first = (unsigned char)in->text[0], second = (unsigned char)in->text[1];
    if ((first == 0xff && second == 0xfe) || (first == 0xfe && second == 0xff))
        return gn_packing_refuse(in, 0, "expected plain text, found UTF-16");
    if (in->length < 3 || memcmp(in->text, "\xef\xbb\xbf", 3) != 0) return GNEISS_OK;
    in->length -= 3;
    memmove(in->text, in->text + 3, in->length + 1);
    return GNEISS_OK;
}

bool gn_packing_is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

const char *gn_packing_shown(const char *text, size_t length, char out[48]) {
    size_t most = length < 40 ? length : 40;
    for (size_t k = 0; k < most; k++) out[k] = isprint((unsigned char)text[k]) ? text[k] : '?';
    strcpy(out + most, length > 40 ? "..." : "");
    return out;
}

gneiss_status gn_packing_number(const gn_packing_reader *in, gn_packing_field field,
                                double *value) {
    char seen[48];
    const char *text = in->text + field.at;
    if (field.length == 0)
        return gn_packing_refuse(in, field.at, "expected a number, found nothing beside the comma");
    if (!gn_is_decimal(text, field.length))
        return gn_packing_refuse(in, field.at, "expected a finite decimal number, found '%s'",
                                 gn_packing_shown(text, field.length, seen));
    *value = strtod(text, NULL);
    if (!isfinite(*value))
        return gn_packing_refuse(in, field.at, "expected a finite number, found '%s' (too large)",
                                 gn_packing_shown(text, field.length, seen));
    return GNEISS_OK;
}

/* Returns the length of a field; a quoted field ends at its second quotation mark, if it has one.
 */
static size_t field_length(const char *text) {
    const char *close = *text == '"' ? strchr(text + 1, '"') : NULL;
    return close ? (size_t)(close - text) + 1 : strcspn(text, " \t\v\f,");
}

gneiss_status gn_packing_split(const gn_packing_reader *in, gn_packing_field *field, size_t most,
                               size_t *count) {
    const char *text = in->text;
    bool comma = false;
    *count = 0;
    for (size_t k = 0;;) {
        while (gn_packing_is_blank(text[k])) k++;
        size_t length = field_length(text + k);
        if (length == 0 && text[k] == '\0' && !comma) return GNEISS_OK;
        if (*count < most + 1) field[(*count)++] = (gn_packing_field){k, length};
        if (*count == most + 1) return GNEISS_OK;
        k += length;
        while (gn_packing_is_blank(text[k])) k++;
        comma = text[k] == ',';
        if (comma) k++;
    }
}

static gneiss_status check_columns(gn_packing_reader *in, const size_t at[5], const double value[4],
                                   size_t columns) {
    size_t least = in->dimension == 3 ? 4 : 3;
    const char *expected = in->dimension == 3 ? "4 columns x y z r" : "3 columns x y r";
    if (in->columns) least = in->columns;
    if (in->columns && in->dimension == 2 && columns != in->columns)
        return gn_packing_refuse(in, at[columns < least ? columns : least],
                                 "expected %zu columns as in the lines above, found %zu",
                                 in->columns, columns);
    if (columns < least)
        return gn_packing_refuse(in, at[columns], "expected %s, found %zu", expected, columns);
    if (in->columns == 0) {
        in->columns = columns;
        in->plane = value[2];
    }
    if (in->dimension == 2 && columns == 4 && value[2] != in->plane)
        return gn_packing_refuse(in, at[2], "expected z = %g as above (two dimensions), found %g",
                                 in->plane / in->scale, value[2] / in->scale);
    if (!(value[columns - 1] > 0.0))
        return gn_packing_refuse(in, at[columns - 1], "expected a radius > 0, found %g",
                                 value[columns - 1] / in->scale);
    return GNEISS_OK;
}

gneiss_status gn_packing_grow(gn_packing_reader *in, gn_packing *packing) {
    if (packing->count < in->capacity) return GNEISS_OK;
    gn_particle_columns *c = &packing->columns;
    const size_t capacity = in->capacity ? 2 * in->capacity : 1024, used = packing->count;
    bool room = gn_widen(&packing->sphere, used, capacity, 4 * sizeof(double));
    room = room && (!c->material || gn_widen(&c->material, used, capacity, sizeof(int32_t)));
    room = room && (!c->group || gn_widen(&c->group, used, capacity, sizeof(int32_t)));
    room = room && (!c->density || gn_widen(&c->density, used, capacity, sizeof(double)));
    room = room && (!c->motion || gn_widen(&c->motion, used, capacity, 6 * sizeof(double)));
    room = room && (!in->id || gn_widen(&in->id, used, capacity, sizeof *in->id));
    if (!room)
        return gn_fail(in->error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu particles", in->path,
                       capacity);
    in->capacity = capacity;
    return GNEISS_OK;
}

/* Reads a row x y z r or x y r. */
static gneiss_status read_row(gn_packing_reader *in, const gn_packing_field *field, size_t columns,
                              gn_packing *packing) {
    double value[4] = {0};
    size_t at[5];
    char seen[48];
    for (size_t k = 0; k < columns && k < 4; k++) {
        GN_TRY(gn_packing_number(in, field[k], &value[k]));
        value[k] *= in->scale;
        if (!isfinite(value[k]))
            return gn_packing_refuse(
                in, field[k].at, "expected a finite number, found '%s' (too large)",
                gn_packing_shown(in->text + field[k].at, field[k].length, seen));
    }
    if (columns > 4)
        return gn_packing_refuse(in, field[4].at, "expected %s, found a column more",
                                 in->dimension == 3 ? "x y z r" : "x y r");
    for (size_t k = 0; k < columns; k++) at[k] = field[k].at;
    at[columns] = field[columns - 1].at + field[columns - 1].length;
    GN_TRY(check_columns(in, at, value, columns));
    GN_TRY(gn_packing_grow(in, packing));
    double *sphere = packing->sphere + 4 * packing->count++;
    memcpy(sphere, value, 2 * sizeof *value);
    sphere[2] = in->dimension == 3 ? value[2] : 0.0;
    sphere[3] = value[columns - 1];
    return GNEISS_OK;
}

static gneiss_status read_line(gn_packing_reader *in, gn_packing *packing) {
    gn_packing_field field[5];
    size_t columns;
    bool is_header = false, may_name = in->words && !packing->count && !in->named;
    if (in->line == 1) GN_TRY(strip_byte_order_mark(in));
    if (may_name && in->text[strspn(in->text, " \t\v\f")] == '#')
        return gn_packing_comment_header(in);
    in->length = strcspn(in->text, "#");
    in->text[in->length] = '\0';
    if (in->named) return gn_packing_named_row(in, packing);
    GN_TRY(gn_packing_split(in, field, 4, &columns));
    if (columns == 0) return GNEISS_OK;
    if (may_name) GN_TRY(gn_packing_row_header(in, &is_header));
    return is_header ? GNEISS_OK : read_row(in, field, columns, packing);
}

static gneiss_status read_lines(gn_packing_reader *in, gn_packing *packing) {
    struct stat info;
    if (fstat(fileno(in->file), &info) == 0 && S_ISDIR(info.st_mode))
        return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s: expected a packing, found a folder",
                       in->path);
    if (in->words) GN_TRY(gn_packing_refuse_foreign(in));
    for (;;) {
        bool found = false;
        GN_TRY(next_line(in, &found));
        if (!found) break;
        GN_TRY(read_line(in, packing));
    }
    if (packing->count == 0)
        return gn_packing_refuse(in, 0,
                                 "no particles: expected lines %s, found the end of the file",
                                 in->named            ? "below the header"
                                 : in->dimension == 3 ? "x y z r"
                                                      : "x y r");
    return gn_packing_sort(in, packing);
}

gneiss_status gn_packing_read(const char *path, int dimension, double scale, gn_packing *packing,
                              gneiss_error *error) {
    return gn_packing_read_columns(path, dimension, scale, NULL, packing, error);
}

static gneiss_status open_and_read(gn_packing_reader *in, gn_packing *packing) {
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain) return gn_fail(in->error, GNEISS_ERROR_MEMORY, "%s: no memory", in->path);
    gneiss_status status;
    if (!(in->file = fopen(in->path, "re"))) {
        /* A path that does not exist is an input error; any other failure is an error of the
         * machine. */
        bool wrong_name = errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG;
        status = gn_fail(in->error, wrong_name ? GNEISS_ERROR_INPUT : GNEISS_ERROR_IO,
                         "%s: cannot be opened: %s", in->path, strerror(errno));
    } else {
        locale_t before = uselocale(plain); /* the calling program may have set a decimal comma */
        status = read_lines(in, packing);
        uselocale(before);
        fclose(in->file);
    }
    freelocale(plain);
    gn_free(in->id);
    if (status != GNEISS_OK) gn_packing_free(packing);
    return status;
}

gneiss_status gn_packing_read_columns(const char *path, int dimension, double scale,
                                      const gn_packing_words *words, gn_packing *packing,
                                      gneiss_error *error) {
    *packing = (gn_packing){0};
    if (dimension != 2 && dimension != 3)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "%s: expected 2 or 3 dimensions, found %d",
                       path, dimension);
    if (!(isfinite(scale) && scale > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a scale > 0, found %g", path,
                       scale);
    gn_packing_reader *in = calloc(1, sizeof *in);
    if (!in) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read it", path);
    in->path = path;
    in->error = error;
    in->dimension = dimension;
    in->scale = scale;
    in->words = words;
    gneiss_status status = open_and_read(in, packing);
    free(in);
    return status;
}

static void print_rows(FILE *out, int dimension, const gn_packing *packing, const char *header) {
    fprintf(out, "# %s\n# %s [m]\n", header, dimension == 3 ? "x y z r" : "x y r");
    for (size_t k = 0; k < packing->count; k++) {
        const double *x = packing->sphere + 4 * k;
        fprintf(out, "%.17g %.17g ", x[0], x[1]);
        if (dimension == 3) fprintf(out, "%.17g ", x[2]);
        fprintf(out, "%.17g\n", x[3]);
    }
}

gneiss_status gn_packing_write(const char *path, int dimension, const gn_packing *packing,
                               const char *header, gneiss_error *error) {
    char *text = NULL;
    size_t size = 0;
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    FILE *out = plain ? open_memstream(&text, &size) : NULL;
    bool failed = !out;
    if (out) {
        locale_t before = uselocale(plain);
        print_rows(out, dimension, packing, header);
        failed = ferror(out) != 0;
        failed = fclose(out) != 0 || failed;
        uselocale(before);
    }
    if (plain) freelocale(plain);
    gneiss_status status =
        failed ? gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to write it", path)
               : gn_write_text_file(path, text, GN_DURABLE, error);
    free(text);
    return status;
}

void gn_packing_free(gn_packing *packing) {
    gn_free(packing->sphere);
    gn_particle_columns_free(&packing->columns);
    *packing = (gn_packing){0};
}
