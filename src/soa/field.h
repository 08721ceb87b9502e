/* Records as structures of arrays, described by manifests.
 *
 * A record (particles, contacts, wall contacts) is one X-macro list of fields. The list generates
 * the struct of pointers and a table of gn_field; the functions here work from the table, so that a
 * field is declared in one place and is then allocated, padded, permuted, kept, mirrored,
 * converted, hashed, saved, restored and shown.
 *
 * Layouts: ROWS is [n][components] (a particle's position and radius are one 32-byte row, loaded
 * whole and transposed in registers), COLUMNS is [components][capacity] (contact data, streamed).
 */
#ifndef GN_SOA_FIELD_H
#define GN_SOA_FIELD_H

#include "base/effects.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum gn_type { GN_F64, GN_I64, GN_I32, GN_U8, GN_F32 } gn_type;
typedef enum gn_layout { GN_ROWS, GN_COLUMNS } gn_layout;

/* STATE determines the future: it is hashed and saved. SAVED is stored in checkpoints (reference
 * positions, last forces for output). SCRATCH is rebuilt from the others. */
typedef enum gn_role { GN_STATE, GN_SAVED, GN_SCRATCH } gn_role;

/* Flags for columns of contacts: how lists treat them, see records.h. */
enum { GN_KEPT = 1, GN_ODD = 2, GN_WRITTEN = 4 };

typedef struct gn_field {
    const char *name;
    gn_type type;
    gn_layout layout;
    gn_role role;
    unsigned care; /* set of GN_KEPT, GN_ODD and GN_WRITTEN */
    int components;
    gn_effects needs;  /* present only if all of these are active */
    gn_effects unless; /* absent if all of these are active (0: no such condition) */
    const char *unit;
    const char *text;
    size_t offset; /* offset of the pointer in the struct */
    /* offset of the double column of which this is the copy in single precision; 0: none */
    size_t single_of;
} gn_field;

/* First member of every record. */
typedef struct gn_soa {
    size_t count;       /* valid items */
    size_t capacity;    /* allocated items, a multiple of GN_LANES_MAX above count */
    gn_effects effects; /* determine which fields exist */
} gn_soa;

typedef struct gn_record {
    const char *name;
    const gn_field *fields;
    size_t field_count;
} gn_record;

/* The least number of padding items beyond `count`, so that kernels need no remainder loop. */
enum { GN_LANES_MAX = 16 };

/* The largest number of contact lists of a model. */
enum { GN_LISTS_MOST = 4 };

size_t gn_type_size(gn_type type);
bool gn_field_active(const gn_field *field, gn_effects effects);

/* Returns the array of a field; NULL if the field is inactive. */
void *gn_field_data(const gn_field *field, const void *record);

/* Returns the bytes per item of all active fields. */
size_t gn_record_bytes(const gn_record *record, gn_effects effects);

/* Allocates all active fields for `count` items, zeroed. gn_soa is the first member of `soa`. */
gneiss_status gn_soa_create(const gn_record *record, void *soa, size_t count, gn_effects effects,
                            gneiss_error *error);
void gn_soa_destroy(const gn_record *record, void *soa);

/* dst[k] = src[order[k]] for k in [0, count) and every field; order[k] < 0 gives zeros. Both
 * records have the same effects; dst->count items are written. */
void gn_soa_permute(const gn_record *record, void *dst, const void *src, const int32_t *order);

/* Copies kept columns into a rebuilt list: now[begin + k] = old[from[k]] for k in [0, count).
 * from[k] < 0 means a new contact, which is left unchanged. */
void gn_soa_keep(const gn_record *record, void *now, size_t begin, size_t count, const void *old,
                 const int32_t *from);

/* Negates the odd columns of the contacts `swapped` [count], whose ends change places. */
void gn_soa_mirror(const gn_record *record, void *soa, const int32_t *swapped, size_t count);

/* Copies src to a new record with the fields of `effects`. Fields that src lacks are zero. */
gneiss_status gn_soa_copy(const gn_record *record, void *dst, const void *src, gn_effects effects,
                          gneiss_error *error);

/* Copies the values of all fields that src has into the existing arrays of dst; the counts are
 * equal. */
void gn_soa_take(const gn_record *record, void *dst, const void *src);

/* Returns the FNV-1a hash of all STATE fields of the first `count` items, chained from `seed`. */
uint64_t gn_soa_hash(const gn_record *record, const void *soa, uint64_t seed);

/* Returns the FNV-1a hash of bytes. The first link of a chain is GN_HASH_SEED. */
#define GN_HASH_SEED UINT64_C(0xcbf29ce484222325)
uint64_t gn_hash_bytes(const void *bytes, size_t size, uint64_t seed);

#endif
