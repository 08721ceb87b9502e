/* Messages of a step, and the state of all ranks. */
#include "base/memory.h"
#include "ranks/ranks.h"

#include <assert.h>
#include <string.h>

/* --- rows of partial sums --- */

static unsigned char *row_at(const gn_partials *q, int32_t row) {
    unsigned char *rows = q->row_f ? (unsigned char *)q->row_f : (unsigned char *)q->row;
    return rows + (size_t)row * gn_partials_row_bytes(q);
}

/* Copies rows to a buffer, or from it. */
static void copy_rows(const gn_ranks *r, const gn_rank_rows *rows, unsigned char *buffer,
                      bool out) {
    for (int l = 0; l < r->lists; l++) {
        const gn_partials *q = r->partials[l];
        const size_t size = q->blocks ? gn_partials_row_bytes(q) : 0;
        for (size_t k = rows->first[l]; k < rows->first[l + 1]; k++, buffer += size)
            if (out)
                memcpy(buffer, row_at(q, rows->row[k]), size);
            else
                memcpy(row_at(q, rows->row[k]), buffer, size);
    }
}

void gn_ranks_begin_step(gn_ranks *r) {
    r->whole = false;
    r->transport->begin(r->rows_in);
    r->transport->begin(r->places_in);
}

void gn_ranks_exchange_rows(gn_ranks *r) {
    for (int k = 0; k < r->count; k++) copy_rows(r, &r->peer[k].out, r->peer[k].rows_out, true);
    r->transport->begin(r->rows_out);
    r->transport->end(r->rows_in);
    for (int k = 0; k < r->count; k++) copy_rows(r, &r->peer[k].in, r->peer[k].rows_in, false);
    r->transport->end(r->rows_out);
}

/* --- rows of particles --- */

static void copy_places(const gn_ranks *r, const gn_rank_rows *rows, unsigned char *buffer,
                        bool out) {
    for (int f = 0; f < r->fields; f++) {
        const size_t size = r->field[f].bytes;
        for (size_t k = 0; k < rows->particles; k++, buffer += size) {
            unsigned char *place = r->field[f].data + size * (size_t)rows->particle[k];
            if (out)
                memcpy(buffer, place, size);
            else
                memcpy(place, buffer, size);
        }
    }
}

void gn_ranks_exchange_places(gn_ranks *r) {
    for (int k = 0; k < r->count; k++) copy_places(r, &r->peer[k].in, r->peer[k].places_out, true);
    r->transport->begin(r->places_out);
    r->transport->end(r->places_in);
    for (int k = 0; k < r->count; k++) copy_places(r, &r->peer[k].out, r->peer[k].places_in, false);
    r->transport->end(r->places_out);
}

/* --- what all ranks have --- */

static size_t part_size(const gn_rank_part *part, int rank) {
    return (part->first[rank + 1] - part->first[rank]) * part->bytes;
}

/* Copies the items of a rank to the buffer, or from it; returns the place behind them. */
static unsigned char *copy_part(const gn_rank_part *part, int rank, unsigned char *buffer,
                                bool out) {
    unsigned char *data = part->data;
    const size_t size = part_size(part, rank), begin = part->first[rank];
    if (!part->item && out) memcpy(buffer, data + begin * part->bytes, size);
    if (!part->item && !out) memcpy(data + begin * part->bytes, buffer, size);
    if (!part->item) return buffer + size;
    for (size_t k = begin; k < part->first[rank + 1]; k++, buffer += part->bytes) {
        unsigned char *place = data + part->bytes * (size_t)part->item[k];
        if (out)
            memcpy(buffer, place, part->bytes);
        else
            memcpy(place, buffer, part->bytes);
    }
    return buffer;
}

static void copy_parts(const gn_ranks *r, const gn_rank_part *part, size_t parts, int rank,
                       bool out) {
    unsigned char *buffer = r->shared + r->shared_first[rank];
    for (size_t k = 0; k < parts; k++) buffer = copy_part(&part[k], rank, buffer, out);
}

/* Places of the ranks in the buffer; returns its size. */
static size_t lay_out(gn_ranks *r, const gn_rank_part *part, size_t parts) {
    r->shared_first[0] = 0;
    for (int k = 0; k < r->count; k++) {
        r->shared_first[k + 1] = r->shared_first[k];
        for (size_t n = 0; n < parts; n++) r->shared_first[k + 1] += part_size(&part[n], k);
    }
    return r->shared_first[r->count];
}

gneiss_status gn_ranks_reserve(gn_ranks *r, const gn_rank_part *part, size_t parts,
                               gneiss_error *error) {
    const size_t size = lay_out(r, part, parts) + 1;
    if (size <= r->shared_room) return GNEISS_OK;
    gn_free(r->shared);
    r->shared = gn_alloc_array_raw(size, 1);
    r->shared_room = r->shared ? size : 0;
    if (r->shared) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a message of %zu bytes", size);
}

void gn_ranks_begin_sharing(gn_ranks *r, const gn_rank_part *part, size_t parts) {
    const size_t size = lay_out(r, part, parts);
    assert(size < r->shared_room);
    (void)size;
    copy_parts(r, part, parts, r->rank, true);
    r->transport->begin_gather(r->shared, r->shared_first);
}

void gn_ranks_end_sharing(gn_ranks *r, const gn_rank_part *part, size_t parts) {
    r->transport->end_gather();
    for (int k = 0; k < r->count; k++)
        if (k != r->rank) copy_parts(r, part, parts, k, false);
}

static bool is_in(const char *name, const char *const *list) {
    for (; *list; list++)
        if (strcmp(name, *list) == 0) return true;
    return false;
}

void gn_ranks_gather_record(gn_ranks *r, const gn_record *record, const void *soa,
                            const size_t *first, const char *const *but) {
    const gn_soa *head = soa;
    size_t *range = r->shared_first;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        unsigned char *data = gn_field_data(field, soa);
        if (!data || is_in(field->name, but)) continue;
        const size_t size = gn_type_size(field->type), parts = (size_t)field->components;
        const size_t streams = field->layout == GN_ROWS ? 1 : parts,
                     bytes = field->layout == GN_ROWS ? size * parts : size;
        for (int k = 0; k <= r->count; k++) range[k] = first[k] * bytes;
        for (size_t c = 0; c < streams; c++)
            r->transport->gather(data + c * head->capacity * bytes, range);
    }
}
