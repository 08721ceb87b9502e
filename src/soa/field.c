#include "soa/field.h"

#include "base/memory.h"

#include <assert.h>
#include <string.h>

size_t gn_type_size(gn_type type) {
    switch (type) {
    case GN_F64:
    case GN_I64:
        return 8;
    case GN_I32:
    case GN_F32:
        return 4;
    case GN_U8:
        return 1;
    }
    return 0;
}

bool gn_field_active(const gn_field *field, gn_effects effects) {
    if ((effects & field->needs) != field->needs) return false;
    return field->unless == 0 || (effects & field->unless) != field->unless;
}

static void **field_slot(const gn_field *field, const void *record) {
    return (void **)((char *)(uintptr_t)record + field->offset);
}

void *gn_field_data(const gn_field *field, const void *record) {
    const gn_soa *soa = record;
    return gn_field_active(field, soa->effects) ? *field_slot(field, record) : NULL;
}

size_t gn_record_bytes(const gn_record *record, gn_effects effects) {
    size_t bytes = 0;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        if (gn_field_active(field, effects))
            bytes += gn_type_size(field->type) * (size_t)field->components;
    }
    return bytes;
}

static gneiss_status create(const gn_record *record, void *soa, size_t count, gn_effects effects,
                            void *(*alloc)(size_t, size_t), gneiss_error *error) {
    gn_soa *head = soa;
    head->count = count;
    head->effects = effects;
    head->capacity = (count / GN_LANES_MAX + 2) * GN_LANES_MAX;
    for (size_t f = 0; f < record->field_count; f++) *field_slot(&record->fields[f], soa) = NULL;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        if (!gn_field_active(field, effects)) continue;
        size_t item = gn_type_size(field->type) * (size_t)field->components;
        void *data = alloc(head->capacity, item);
        if (!data) {
            gn_soa_destroy(record, soa);
            return gn_fail(error, GNEISS_ERROR_MEMORY,
                           "no memory for %zu %s (field %s, %zu bytes each)", count, record->name,
                           field->name, item);
        }
        *field_slot(field, soa) = data;
    }
    return GNEISS_OK;
}

gneiss_status gn_soa_create(const gn_record *record, void *soa, size_t count, gn_effects effects,
                            gneiss_error *error) {
    return create(record, soa, count, effects, gn_alloc_array, error);
}

void gn_soa_destroy(const gn_record *record, void *soa) {
    gn_soa *head = soa;
    for (size_t f = 0; f < record->field_count; f++) {
        void **slot = field_slot(&record->fields[f], soa);
        gn_free(*slot);
        *slot = NULL;
    }
    head->count = head->capacity = 0;
}

/* One component of a field in memory: its start, the distance between items and their size. */
typedef struct stream {
    size_t base, stride, size;
} stream;

static stream field_stream(const gn_field *field, const gn_soa *soa, int component) {
    size_t size = gn_type_size(field->type);
    if (field->layout == GN_ROWS)
        return (stream){0, size * (size_t)field->components, size * (size_t)field->components};
    return (stream){size * (size_t)component * soa->capacity, size, size};
}

static int stream_count(const gn_field *field) {
    return field->layout == GN_ROWS ? 1 : field->components;
}

void gn_soa_permute(const gn_record *record, void *dst, const void *src, const int32_t *order) {
    gn_soa *to = dst;
    const gn_soa *from = src;
    assert(to->effects == from->effects);
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        char *out = gn_field_data(field, dst);
        const char *in = gn_field_data(field, src);
        if (!out) continue;
        for (int c = 0; c < stream_count(field); c++) {
            stream o = field_stream(field, to, c), s = field_stream(field, from, c);
            for (size_t k = 0; k < to->count; k++) {
                char *item = out + o.base + k * o.stride;
                if (order[k] < 0)
                    memset(item, 0, o.size);
                else
                    memcpy(item, in + s.base + (size_t)order[k] * s.stride, s.size);
            }
        }
    }
}

static inline void gather_items(char *to, const char *from, size_t size, const int32_t *place,
                                size_t count) {
    for (size_t k = 0; k < count; k++)
        if (place[k] >= 0) memcpy(to + k * size, from + (size_t)place[k] * size, size);
}

/* Copies items; if `size` is constant, the compiler turns each copy into one move. */
static void gather(char *to, const char *from, size_t size, const int32_t *place, size_t count) {
    switch (size) {
    case 8:
        gather_items(to, from, 8, place, count);
        break;
    case 4:
        gather_items(to, from, 4, place, count);
        break;
    default:
        gather_items(to, from, size, place, count);
    }
}

void gn_soa_keep(const gn_record *record, void *now, size_t begin, size_t count, const void *old,
                 const int32_t *from) {
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        if (!(field->care & GN_KEPT)) continue;
        char *out = gn_field_data(field, now);
        const char *in = gn_field_data(field, old);
        if (!out || !in) continue;
        for (int c = 0; c < stream_count(field); c++) {
            stream o = field_stream(field, now, c), s = field_stream(field, old, c);
            gather(out + o.base + begin * o.stride, in + s.base, s.size, from, count);
        }
    }
}

void gn_soa_mirror(const gn_record *record, void *soa, const int32_t *swapped, size_t count) {
    const gn_soa *head = soa;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        void *data = field->care & GN_ODD ? gn_field_data(field, soa) : NULL;
        if (!data) continue;
        assert(field->layout == GN_COLUMNS && (field->type == GN_F64 || field->type == GN_F32));
        double *wide = field->type == GN_F64 ? data : NULL;
        float *narrow = field->type == GN_F32 ? data : NULL;
        for (size_t c = 0; c < (size_t)field->components; c++)
            for (size_t k = 0; k < count; k++) {
                size_t at = (size_t)swapped[k] + c * head->capacity;
                if (wide) wide[at] = -wide[at];
                if (narrow) narrow[at] = -narrow[at];
            }
    }
}

/* Copies fields; with `fresh`, the rest of dst is uninitialised and is zeroed. */
static void take(const gn_record *record, void *dst, const void *src, bool fresh) {
    const gn_soa *from = src, *to = dst;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        char *out = gn_field_data(field, dst);
        const char *in = gn_field_data(field, src);
        if (!out) continue;
        for (int c = 0; c < stream_count(field); c++) {
            stream o = field_stream(field, to, c), s = field_stream(field, from, c);
            size_t kept = in ? s.stride * from->count : 0;
            if (in) memcpy(out + o.base, in + s.base, kept);
            if (fresh) memset(out + o.base + kept, 0, o.stride * to->capacity - kept);
        }
    }
}

void gn_soa_take(const gn_record *record, void *dst, const void *src) {
    take(record, dst, src, false);
}

gneiss_status gn_soa_copy(const gn_record *record, void *dst, const void *src, gn_effects effects,
                          gneiss_error *error) {
    const gn_soa *from = src;
    GN_TRY(create(record, dst, from->count, effects, gn_alloc_array_raw, error));
    take(record, dst, src, true);
    return GNEISS_OK;
}

uint64_t gn_hash_bytes(const void *bytes, size_t size, uint64_t seed) {
    const unsigned char *p = bytes;
    for (size_t k = 0; k < size; k++) seed = (seed ^ p[k]) * UINT64_C(0x100000001b3);
    return seed;
}

uint64_t gn_soa_hash(const gn_record *record, const void *soa, uint64_t seed) {
    const gn_soa *head = soa;
    for (size_t f = 0; f < record->field_count; f++) {
        const gn_field *field = &record->fields[f];
        const char *data = gn_field_data(field, soa);
        if (!data || field->role != GN_STATE) continue;
        seed = gn_hash_bytes(field->name, strlen(field->name), seed);
        for (int c = 0; c < stream_count(field); c++) {
            stream s = field_stream(field, head, c);
            seed = gn_hash_bytes(data + s.base, s.stride * head->count, seed);
        }
    }
    return seed;
}
