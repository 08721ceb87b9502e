/* Messages of a step, and the state of all ranks. */
#include "base/new.h"
#include "ranks/ranks.h"
#include "ranks/ranks_private.h"

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

void gn_ranks_send_rows(gn_ranks *r) {
    for (int k = 0; k < r->count; k++) copy_rows(r, &r->peer[k].out, r->peer[k].rows_out, true);
    r->transport->begin(r->rows_out);
}

void gn_ranks_take_rows(gn_ranks *r) {
    r->transport->end(r->rows_in);
    for (int k = 0; k < r->count; k++) copy_rows(r, &r->peer[k].in, r->peer[k].rows_in, false);
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
    r->transport->end(r->rows_out);
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

static void copy_parts(const gn_rank_share *share, const gn_rank_part *part, size_t parts, int rank,
                       bool out) {
    unsigned char *buffer = share->buffer + share->first[rank];
    for (size_t k = 0; k < parts; k++) buffer = copy_part(&part[k], rank, buffer, out);
}

/* Returns the size of the buffer. */
static size_t lay_out(const gn_ranks *r, gn_rank_share *share, const gn_rank_part *part,
                      size_t parts) {
    share->first[0] = 0;
    for (int k = 0; k < r->count; k++) {
        share->first[k + 1] = share->first[k];
        for (size_t n = 0; n < parts; n++) share->first[k + 1] += part_size(&part[n], k);
    }
    return share->first[r->count];
}

/* Own items go to every other rank, and theirs come to their places in the buffer. */
static gneiss_status open_share(gn_ranks *r, gn_rank_share *share, gneiss_error *error) {
    gn_message out[GN_RANKS_DIRECT], in[GN_RANKS_DIRECT];
    const int tag = share == &r->sums ? GN_TAG_SUMS : GN_TAG_FORCES;
    const size_t own = share->first[r->rank + 1] - share->first[r->rank];
    size_t outs = 0, ins = 0;
    for (int k = 0; k < r->count; k++) {
        const size_t size = share->first[k + 1] - share->first[k];
        if (k == r->rank) continue;
        if (own) out[outs++] = (gn_message){k, share->buffer + share->first[r->rank], own};
        if (size) in[ins++] = (gn_message){k, share->buffer + share->first[k], size};
    }
    share->out = r->transport->open(out, outs, GN_SENT, tag);
    share->in = r->transport->open(in, ins, GN_RECEIVED, tag);
    return share->out && share->in ? GNEISS_OK : gn_no_memory(error, "messages");
}

gneiss_status gn_ranks_plan_share(gn_ranks *r, gn_rank_share *share, const gn_rank_part *part,
                                  size_t parts, gneiss_error *error) {
    gn_ranks_free_share(r, share);
    GN_TRY(gn_new(&share->first, (size_t)r->count + 1, "ranks", error));
    const size_t size = lay_out(r, share, part, parts);
    GN_TRY(gn_new(&share->buffer, size + 1, "bytes of a message", error));
    return r->count <= GN_RANKS_DIRECT ? open_share(r, share, error) : GNEISS_OK;
}

void gn_ranks_free_share(const gn_ranks *r, gn_rank_share *share) {
    if (share->out) r->transport->close(share->out);
    if (share->in) r->transport->close(share->in);
    gn_free(share->buffer);
    gn_free(share->first);
    *share = (gn_rank_share){0};
}

void gn_ranks_begin_share(gn_ranks *r, gn_rank_share *share, const gn_rank_part *part,
                          size_t parts) {
    if (share->in) r->transport->begin(share->in);
    copy_parts(share, part, parts, r->rank, true);
    if (share->out) r->transport->begin(share->out);
}

void gn_ranks_end_share(gn_ranks *r, gn_rank_share *share, const gn_rank_part *part, size_t parts) {
    if (share->in) r->transport->end(share->in);
    if (!share->in) r->transport->gather(share->buffer, share->first);
    for (int k = 0; k < r->count; k++)
        if (k != r->rank) copy_parts(share, part, parts, k, false);
    if (share->out) r->transport->end(share->out);
}

static bool is_in(const char *name, const char *const *list) {
    for (; *list; list++)
        if (strcmp(name, *list) == 0) return true;
    return false;
}

void gn_ranks_gather_record(gn_ranks *r, const gn_record *record, const void *soa,
                            const size_t *first, const char *const *but) {
    const gn_soa *head = soa;
    size_t *range = r->bytes;
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
