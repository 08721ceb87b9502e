#include "io/packing.h"

#include "base/memory.h"
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

enum { LINE_LIMIT = 65536 };

typedef struct reader {
    FILE *file;
    const char *path;
    gneiss_error *error;
    int dimension;
    double scale;
    size_t line;    /* number of the line, from 1 */
    size_t columns; /* number of columns of the first particle, 0: none yet */
    double plane;   /* 2D with z: z of the first particle */
    size_t capacity;
    size_t length;
    char text[LINE_LIMIT + 1];
} reader;

/* Reports an error; `at` is the position in the line, from 0. */
__attribute__((format(printf, 3, 4))) static gneiss_status refuse(reader *in, size_t at,
                                                                  const char *format, ...) {
    char what[256];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s:%zu:%zu: %s", in->path, in->line, at + 1,
                   what);
}

/* Reads a line, which ends with LF, CR LF or CR. *found is false at the end of the file. */
static gneiss_status next_line(reader *in, bool *found) {
    in->length = 0;
    in->line++;
    for (int c; (c = getc_unlocked(in->file)) != EOF;) {
        *found = true;
        if (c == '\r' && (c = getc_unlocked(in->file)) != '\n') {
            if (c != EOF) ungetc(c, in->file);
            c = '\n';
        }
        if (c == '\n') break;
        if (c == '\0') return refuse(in, in->length, "expected text, found a zero byte");
        if (in->length == LINE_LIMIT)
            return refuse(in, in->length, "expected a line of at most %d bytes, found a longer one",
                          LINE_LIMIT);
        in->text[in->length++] = (char)c;
    }
    in->text[in->length] = '\0';
    if (!ferror(in->file)) return GNEISS_OK;
    return gn_fail(in->error, GNEISS_ERROR_IO, "%s: cannot be read: %s", in->path, strerror(errno));
}

static gneiss_status strip_byte_order_mark(reader *in) {
    unsigned char first = (unsigned char)in->text[0], second = (unsigned char)in->text[1];
    if ((first == 0xff && second == 0xfe) || (first == 0xfe && second == 0xff))
        return refuse(in, 0, "expected plain text, found UTF-16");
    if (in->length < 3 || memcmp(in->text, "\xef\xbb\xbf", 3) != 0) return GNEISS_OK;
    in->length -= 3;
    memmove(in->text, in->text + 3, in->length + 1);
    return GNEISS_OK;
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/* Returns up to 40 printable characters of the text. */
static const char *shown(const char *text, size_t length, char out[48]) {
    size_t most = length < 40 ? length : 40;
    for (size_t k = 0; k < most; k++) out[k] = isprint((unsigned char)text[k]) ? text[k] : '?';
    strcpy(out + most, length > 40 ? "..." : "");
    return out;
}

static gneiss_status read_number(reader *in, size_t at, size_t length, double *value) {
    char seen[48];
    const char *text = in->text + at;
    if (length == 0) return refuse(in, at, "expected a number, found nothing beside the comma");
    if (!gn_is_decimal(text, length))
        return refuse(in, at, "expected a finite decimal number, found '%s'",
                      shown(text, length, seen));
    *value = strtod(text, NULL) * in->scale;
    if (!isfinite(*value))
        return refuse(in, at, "expected a finite number, found '%s' (too large)",
                      shown(text, length, seen));
    return GNEISS_OK;
}

/* Splits a line into fields, which are separated by blanks or by one comma with blanks around it.
 * `at[columns]` is the end of the data. */
static gneiss_status split(reader *in, size_t at[5], double value[4], size_t *columns) {
    const char *text = in->text;
    size_t k = 0;
    bool comma = false;
    *columns = 0;
    at[0] = 0;
    for (;;) {
        while (is_blank(text[k])) k++;
        size_t length = strcspn(text + k, " \t\v\f,");
        if (length == 0 && text[k] == '\0' && !comma) break;
        if (*columns == 4)
            return refuse(in, k, "expected %s, found a column more",
                          in->dimension == 3 ? "x y z r" : "x y r");
        at[*columns] = k;
        GN_TRY(read_number(in, k, length, &value[*columns]));
        k += length;
        at[++*columns] = k;
        while (is_blank(text[k])) k++;
        comma = text[k] == ',';
        if (comma) k++;
    }
    return GNEISS_OK;
}

static gneiss_status check_columns(reader *in, const size_t at[5], const double value[4],
                                   size_t columns) {
    size_t least = in->dimension == 3 ? 4 : 3;
    const char *expected = in->dimension == 3 ? "4 columns x y z r" : "3 columns x y r";
    if (in->columns) least = in->columns;
    if (in->columns && in->dimension == 2 && columns != in->columns)
        return refuse(in, at[columns < least ? columns : least],
                      "expected %zu columns as in the lines above, found %zu", in->columns,
                      columns);
    if (columns < least)
        return refuse(in, at[columns], "expected %s, found %zu", expected, columns);
    if (in->columns == 0) {
        in->columns = columns;
        in->plane = value[2];
    }
    if (in->dimension == 2 && columns == 4 && value[2] != in->plane)
        return refuse(in, at[2], "expected z = %g as above (two dimensions), found %g",
                      in->plane / in->scale, value[2] / in->scale);
    if (!(value[columns - 1] > 0.0))
        return refuse(in, at[columns - 1], "expected a radius > 0, found %g",
                      value[columns - 1] / in->scale);
    return GNEISS_OK;
}

static gneiss_status push(reader *in, gn_packing *packing, const double row[4]) {
    if (packing->count == in->capacity) {
        size_t capacity = in->capacity ? 2 * in->capacity : 1024;
        double *more = gn_alloc_array(capacity, 4 * sizeof *more);
        if (!more)
            return gn_fail(in->error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu particles",
                           in->path, capacity);
        if (packing->count) memcpy(more, packing->sphere, 4 * sizeof *more * packing->count);
        gn_free(packing->sphere);
        packing->sphere = more;
        in->capacity = capacity;
    }
    memcpy(packing->sphere + 4 * packing->count++, row, 4 * sizeof *row);
    return GNEISS_OK;
}

static gneiss_status read_line(reader *in, gn_packing *packing) {
    double value[4] = {0};
    size_t at[5], columns;
    if (in->line == 1) GN_TRY(strip_byte_order_mark(in));
    in->length = strcspn(in->text, "#");
    in->text[in->length] = '\0';
    GN_TRY(split(in, at, value, &columns));
    if (columns == 0) return GNEISS_OK;
    GN_TRY(check_columns(in, at, value, columns));
    double radius = value[columns - 1], z = in->dimension == 3 ? value[2] : 0.0;
    return push(in, packing, (double[4]){value[0], value[1], z, radius});
}

static gneiss_status read_lines(reader *in, gn_packing *packing) {
    struct stat info;
    if (fstat(fileno(in->file), &info) == 0 && S_ISDIR(info.st_mode))
        return gn_fail(in->error, GNEISS_ERROR_INPUT, "%s: expected a packing, found a folder",
                       in->path);
    for (;;) {
        bool found = false;
        GN_TRY(next_line(in, &found));
        if (!found) break;
        GN_TRY(read_line(in, packing));
    }
    if (packing->count == 0)
        return refuse(in, 0, "no particles: expected lines %s, found the end of the file",
                      in->dimension == 3 ? "x y z r" : "x y r");
    return GNEISS_OK;
}

gneiss_status gn_packing_read(const char *path, int dimension, double scale, gn_packing *packing,
                              gneiss_error *error) {
    *packing = (gn_packing){0};
    if (dimension != 2 && dimension != 3)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "%s: expected 2 or 3 dimensions, found %d",
                       path, dimension);
    if (!(isfinite(scale) && scale > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a scale > 0, found %g", path,
                       scale);
    reader *in = calloc(1, sizeof *in);
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    gneiss_status status = GNEISS_OK;
    if (!in || !plain) {
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read it", path);
    } else if (!(in->file = fopen(path, "re"))) {
        /* A path that does not exist is an input error; any other failure is an error of the
         * machine. */
        bool wrong_name = errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG;
        status = gn_fail(error, wrong_name ? GNEISS_ERROR_INPUT : GNEISS_ERROR_IO,
                         "%s: cannot be opened: %s", path, strerror(errno));
    } else {
        in->path = path;
        in->error = error;
        in->dimension = dimension;
        in->scale = scale;
        locale_t before = uselocale(plain); /* the calling program may have set a decimal comma */
        status = read_lines(in, packing);
        uselocale(before);
        fclose(in->file);
    }
    if (status != GNEISS_OK) gn_packing_free(packing);
    if (plain) freelocale(plain);
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
    *packing = (gn_packing){0};
}
