#include "cli/line.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

gn_line_field *gn_line_add(gn_line *line, int rank, const char *format, ...) {
    gn_line_field *field = &line->field[line->count < GN_LINE_FIELDS ? line->count++ : 0];
    va_list args;
    va_start(args, format);
    *field = (gn_line_field){.rank = rank};
    vsnprintf(field->text, sizeof field->text, format, args);
    va_end(args);
    return field;
}

void gn_line_brief(gn_line_field *field, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(field->brief, sizeof field->brief, format, args);
    va_end(args);
}

/* Joins the fields with two blanks between them. */
static void join(const gn_line *line, char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (size_t k = 0; k < line->count && used < size; k++) {
        const gn_line_field *f = &line->field[k];
        if (f->dropped) continue;
        int more = snprintf(out + used, size - used, "%s%s", used ? "  " : "",
                            f->shortened ? f->brief : f->text);
        if (more > 0) used += (size_t)more;
    }
}

/* Returns the least important field that can still be shortened, or with `by_dropping` be dropped;
 * NULL: none. */
static gn_line_field *next_to_give_way(gn_line *line, bool by_dropping) {
    gn_line_field *found = NULL;
    for (size_t k = 0; k < line->count; k++) {
        gn_line_field *f = &line->field[k];
        bool can = by_dropping ? !f->dropped && f->rank > 0 : !f->shortened && f->brief[0];
        if (can && (!found || f->rank > found->rank)) found = f;
    }
    return found;
}

void gn_line_fit(gn_line *line, size_t width, char *out, size_t size) {
    join(line, out, size);
    for (int by_dropping = 0; width && by_dropping < 2; by_dropping++)
        for (gn_line_field *f; strlen(out) > width && (f = next_to_give_way(line, by_dropping));) {
            *(by_dropping ? &f->dropped : &f->shortened) = true;
            join(line, out, size);
        }
    if (width && width < size && strlen(out) > width) out[width] = '\0';
}

/* Returns the columns of the terminal less one, because some terminals wrap at the last column. */
static size_t room(void) {
    struct winsize window = {0};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0) return 79;
    return window.ws_col > 1 ? window.ws_col - 1U : 1U;
}

void gn_line_show(gn_line *line, bool last) {
    char text[GN_LINE_FIELDS * (GN_LINE_TEXT + 2)];
    bool terminal = isatty(STDERR_FILENO);
    gn_line_fit(line, terminal ? room() : 0, text, sizeof text);
    fprintf(stderr, "%s%s%s", terminal ? "\r\033[K" : "", text, terminal && !last ? "" : "\n");
    fflush(stderr);
}
