#include "test_kinds/history.h"

#include "base/new.h"

#include <string.h>

static const gn_column *find(const gn_history *history, const char *name) {
    for (size_t c = 0; c < history->column_count; c++)
        if (strcmp(history->columns[c].name, name) == 0) return &history->columns[c];
    return NULL;
}

static gneiss_status check_text(const char *what, const char *text, size_t size,
                                gneiss_error *error) {
    if (strlen(text) < size) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INTERNAL,
                   "history column: expected a %s of at most %zu characters, found '%s'", what,
                   size - 1, text);
}

gneiss_status gn_history_add_column(gn_history *history, const char *name, const char *unit,
                                    const char *text, gneiss_error *error) {
    gn_column column = {0};
    if (history->row_count > 0)
        return gn_fail(error, GNEISS_ERROR_INTERNAL,
                       "history column '%s': expected no rows yet, found %zu", name,
                       history->row_count);
    if (name[0] == 0)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "history column: expected a name");
    if (find(history, name))
        return gn_fail(error, GNEISS_ERROR_INTERNAL,
                       "history column '%s': expected a new name, found it in use", name);
    GN_TRY(check_text("name", name, sizeof column.name, error));
    GN_TRY(check_text("unit", unit, sizeof column.unit, error));
    GN_TRY(check_text("text", text, sizeof column.text, error));
    strcpy(column.name, name);
    strcpy(column.unit, unit);
    strcpy(column.text, text);
    if (history->row_capacity > 0) column.value = gn_alloc_array(history->row_capacity, 8);
    if ((history->row_capacity > 0 && !column.value) ||
        !gn_widen(&history->columns, history->column_count, history->column_count + 1,
                  sizeof column)) {
        gn_free(column.value);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for history column '%s'", name);
    }
    history->columns[history->column_count++] = column;
    return GNEISS_OK;
}

/* Enlarges all columns, or none if memory is lacking for one of them. */
static gneiss_status grow(gn_history *history, gneiss_error *error) {
    size_t capacity = history->row_capacity ? 2 * history->row_capacity : 256, c;
    double **value = gn_alloc_array(history->column_count, sizeof *value);
    for (c = 0; value && c < history->column_count; c++)
        if (!(value[c] = gn_alloc_array(capacity, sizeof **value))) break;
    if (!value || c < history->column_count) {
        for (size_t k = 0; value && k < c; k++) gn_free(value[k]);
        gn_free(value);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu history rows of %zu columns",
                       capacity, history->column_count);
    }
    for (c = 0; c < history->column_count; c++) {
        gn_column *column = &history->columns[c];
        if (history->row_count)
            memcpy(value[c], column->value, history->row_count * sizeof **value);
        gn_free(column->value);
        column->value = value[c];
    }
    gn_free(value);
    history->row_capacity = capacity;
    return GNEISS_OK;
}

gneiss_status gn_history_append(gn_history *history, const double *row, gneiss_error *error) {
    if (history->row_count == history->row_capacity) GN_TRY(grow(history, error));
    for (size_t c = 0; c < history->column_count; c++)
        history->columns[c].value[history->row_count] = row[c];
    history->row_count++;
    return GNEISS_OK;
}

void gn_history_keep(gn_history *history, size_t begin, const bool *keep) {
    size_t rows = begin;
    for (size_t r = begin; r < history->row_count; r++) {
        if (!keep[r]) continue;
        for (size_t c = 0; c < history->column_count; c++)
            history->columns[c].value[rows] = history->columns[c].value[r];
        rows++;
    }
    if (rows < history->row_count) history->row_count = rows;
}

const double *gn_history_column(const gn_history *history, const char *name) {
    const gn_column *column = find(history, name);
    return column ? column->value : NULL;
}

void gn_history_free(gn_history *history) {
    for (size_t c = 0; c < history->column_count; c++) gn_free(history->columns[c].value);
    gn_free(history->columns);
    *history = (gn_history){0};
}
