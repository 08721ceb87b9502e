/* Digests detect and name data sets, attributes and objects that were changed after the file was
 * written. HDF5's own checksums guard chunks of bytes: a tool that writes another value also writes
 * its new checksum.
 *
 * Three attributes contain them, as 64-bit integers. `digest` of a data set covers its name, type,
 * shape and values; `digest_of_attributes` of every object its other attributes; `digest_of_names`
 * of the root the names and attributes of all objects, so that none can be missing or new. They
 * guard against accidents and edits, but not against recomputed digests. For that purpose values
 * that index or count are checked against their ranges where they are used. Files of earlier
 * versions have none. tools/report_digest.py has the same algorithm. */
#include "io/h5_private.h"

#include <stdlib.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "digests are of little-endian values");

static const char of_values[] = "digest", of_attributes[] = "digest_of_attributes",
                  of_names[] = "digest_of_names";
enum { ATTRIBUTE_BYTES_MOST = 1 << 24 };

/* Mixes by the finaliser of splitmix64 (Steele et al. 2014), a bijection. */
static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* Mixes every word of eight bytes with its position and adds the results. The terms are
 * independent, so that the sum runs at the speed of memory, and a single changed word always
 * changes it. */
static uint64_t h5_digest(const void *bytes, size_t size, uint64_t seed) {
    const unsigned char *from = bytes;
    uint64_t sum = 0, place = 0;
    for (size_t k = 0; k < size; k += 8) {
        uint64_t word = 0;
        if (size - k >= 8)
            memcpy(&word, from + k, 8);
        else
            memcpy(&word, from + k, size - k);
        sum += mix(word + (place += UINT64_C(0x9e3779b97f4a7c15)));
    }
    return mix(sum ^ mix(seed ^ size));
}

static uint64_t digest_of_text(const char *text) {
    return h5_digest(text, strlen(text), 0);
}

/* Writes "f8", "i4", "u1", "S12": the type names of NumPy. */
static void type_code(hid_t type, char out[32]) {
    H5T_class_t kind = H5Tget_class(type);
    char letter = kind == H5T_FLOAT     ? 'f'
                  : kind == H5T_STRING  ? 'S'
                  : kind != H5T_INTEGER ? '?'
                                        : (H5Tget_sign(type) == H5T_SGN_NONE ? 'u' : 'i');
    snprintf(out, 32, "%c%zu", letter, H5Tget_size(type));
}

/* ---- values ---- */

static uint64_t digest_of_values(const char *name, hid_t set, const void *bytes, size_t size) {
    char head[768], code[32] = "";
    hsize_t extent[H5S_MAX_RANK] = {0};
    hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    int rank = space < 0 ? 0 : H5Sget_simple_extent_dims(space, extent, NULL);
    if (type >= 0) type_code(type, code);
    int used = snprintf(head, sizeof head, "%.600s %s", name + (*name == '/'), code);
    for (int k = 0; k < rank && k < 4; k++)
        used += snprintf(head + used, sizeof head - (size_t)used, " %llu",
                         (unsigned long long)extent[k]);
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    return h5_digest(bytes, size, digest_of_text(head));
}

/* Returns the name of an object, which is its path within the file; that of the root is ".". */
static const char *shown(const char *name) {
    return strcmp(name, ".") == 0 ? "/" : name;
}

/* Returns an error with the message of HDF5, because lack of memory is no damage. */
static gneiss_status unreadable(const gn_h5 *file, const char *name, gneiss_error *error) {
    return gn_h5_fail(file, error, file->writing ? GNEISS_ERROR_INTERNAL : GNEISS_ERROR_INPUT,
                      "attributes of %s cannot be read", shown(name));
}

/* Reads attribute `name` of an object; `of` names the object. */
static gneiss_status read_number(const gn_h5 *file, hid_t object, const char *of, const char *name,
                                 uint64_t *value, gneiss_error *error) {
    int64_t found = 0;
    hid_t id = H5Aopen(object, name, H5P_DEFAULT);
    gneiss_status status = id >= 0 && H5Aread(id, H5T_NATIVE_INT64, &found) >= 0
                               ? GNEISS_OK
                               : unreadable(file, of, error);
    if (id >= 0) H5Aclose(id);
    *value = (uint64_t)found;
    return status;
}

static bool write_number(hid_t object, const char *name, uint64_t value) {
    if (H5Aexists(object, name) > 0) (void)H5Adelete(object, name);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t id = H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    bool written = id >= 0 && H5Awrite(id, H5T_NATIVE_INT64, &(int64_t){(int64_t)value}) >= 0;
    if (id >= 0) H5Aclose(id);
    if (space >= 0) H5Sclose(space);
    return written;
}

gneiss_status gn_h5_put_digest(gn_h5 *file, const char *name, hid_t set, const void *bytes,
                               size_t size, gneiss_error *error) {
    if (!file->digested || write_number(set, of_values, digest_of_values(name, set, bytes, size)))
        return GNEISS_OK;
    file->failed = true;
    return gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL, "the digest of %s cannot be written",
                      name);
}

static gneiss_status changed(const gn_h5 *file, bool attributes, const char *name,
                             gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: %s %s %s changed: %s digest is not the one that was written", file->path,
                   attributes ? "attributes of" : "data set", shown(name),
                   attributes ? "are damaged or were" : "is damaged or was",
                   attributes ? "their" : "its");
}

gneiss_status gn_h5_check_digest(const gn_h5 *file, const char *name, hid_t set, const void *bytes,
                                 size_t size, gneiss_error *error) {
    uint64_t written;
    if (!file->digested) return GNEISS_OK;
    GN_TRY(read_number(file, set, name, of_values, &written, error));
    if (written == digest_of_values(name, set, bytes, size)) return GNEISS_OK;
    return changed(file, false, name, error);
}

/* ---- attributes ---- */

static bool is_own(const char *name) {
    return strcmp(name, of_attributes) == 0 || strcmp(name, of_names) == 0;
}

typedef struct attribute_sum {
    const gn_h5 *file;
    const char *object;
    uint64_t sum;
    gneiss_status status;
    gneiss_error *error;
} attribute_sum;

static gneiss_status add_values(attribute_sum *sum, const char *name, hid_t id, hid_t type,
                                hsize_t points) {
    char head[512], code[32] = "";
    size_t size = 0, item = H5Tis_variable_str(type) != 0 ? 0 : H5Tget_size(type);
    if (!item || __builtin_mul_overflow((size_t)points, item, &size) || size > ATTRIBUTE_BYTES_MOST)
        return gn_fail(sum->error, GNEISS_ERROR_INPUT,
                       "%s: attribute %s of %s: expected values of fixed length, found others",
                       sum->file->path, name, shown(sum->object));
    void *bytes = calloc(size + 1, 1);
    if (!bytes)
        return gn_fail(sum->error, GNEISS_ERROR_MEMORY, "%s: no memory to read attribute %s",
                       sum->file->path, name);
    gneiss_status status = !points || H5Aread(id, type, bytes) >= 0
                               ? GNEISS_OK
                               : unreadable(sum->file, sum->object, sum->error);
    type_code(type, code);
    snprintf(head, sizeof head, "%.400s %s %llu", name, code, (unsigned long long)points);
    sum->sum += mix(h5_digest(bytes, size, digest_of_text(head)));
    free(bytes);
    return status;
}

static herr_t add_attribute(hid_t object, const char *name, const H5A_info_t *info, void *data) {
    (void)info;
    attribute_sum *s = data;
    if (is_own(name)) return 0;
    hid_t id = H5Aopen(object, name, H5P_DEFAULT);
    hid_t type = id < 0 ? -1 : H5Aget_type(id), space = type < 0 ? -1 : H5Aget_space(id);
    hssize_t points = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    s->status = points < 0 ? unreadable(s->file, s->object, s->error)
                           : add_values(s, name, id, type, (hsize_t)points);
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    if (id >= 0) H5Aclose(id);
    return s->status == GNEISS_OK ? 0 : -1;
}

static gneiss_status digest_attributes(const gn_h5 *file, hid_t object, const char *name,
                                       uint64_t *digest, gneiss_error *error) {
    attribute_sum s = {.file = file, .object = name, .sum = digest_of_text(name), .error = error};
    herr_t ended = H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, NULL, add_attribute, &s);
    if (ended < 0 && s.status == GNEISS_OK) s.status = unreadable(file, name, error);
    *digest = mix(s.sum);
    return s.status;
}

static gneiss_status check_object(const gn_h5 *file, hid_t object, const char *name,
                                  uint64_t *digest, gneiss_error *error) {
    uint64_t written;
    GN_TRY(digest_attributes(file, object, name, digest, error));
    GN_TRY(read_number(file, object, name, of_attributes, &written, error));
    return written == *digest ? GNEISS_OK : changed(file, true, name, error);
}

gneiss_status gn_h5_check_attributes(const gn_h5 *file, const char *object, gneiss_error *error) {
    uint64_t digest;
    if (!file->digested) return GNEISS_OK;
    const char *name = strcmp(object, "/") == 0 ? "." : object + (*object == '/');
    hid_t id = H5Oopen(file->id, object, H5P_DEFAULT);
    if (id < 0) return unreadable(file, name, error);
    gneiss_status status = check_object(file, id, name, &digest, error);
    H5Oclose(id);
    return status;
}

/* ---- all objects ---- */

typedef struct walk {
    gn_h5 *file;
    uint64_t names;
    gneiss_status status;
    gneiss_error *error;
} walk;

static gneiss_status seal_object(gn_h5 *file, hid_t object, const char *name, uint64_t *digest,
                                 gneiss_error *error) {
    GN_TRY(digest_attributes(file, object, name, digest, error));
    if (write_number(object, of_attributes, *digest)) return GNEISS_OK;
    return gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL, "the digest of %s cannot be written",
                      name);
}

static herr_t visit(hid_t root, const char *name, const H5O_info_t *info, void *data) {
    walk *w = data;
    uint64_t digest = 0;
    hid_t object = H5Oopen(root, name, H5P_DEFAULT);
    w->status = object < 0         ? unreadable(w->file, name, w->error)
                : w->file->writing ? seal_object(w->file, object, name, &digest, w->error)
                                   : check_object(w->file, object, name, &digest, w->error);
    if (object >= 0) H5Oclose(object);
    w->names += mix(digest ^ (uint64_t)info->type);
    return w->status == GNEISS_OK ? 0 : -1;
}

static gneiss_status walk_all(walk *visitor) {
    herr_t ended =
        H5Ovisit2(visitor->file->id, H5_INDEX_NAME, H5_ITER_NATIVE, visit, visitor, H5O_INFO_BASIC);
    if (visitor->status != GNEISS_OK || ended >= 0) return visitor->status;
    return gn_h5_fail(visitor->file, visitor->error,
                      visitor->file->writing ? GNEISS_ERROR_INTERNAL : GNEISS_ERROR_INPUT,
                      "its objects cannot be listed");
}

gneiss_status gn_h5_seal(gn_h5 *file, gneiss_error *error) {
    walk w = {.file = file, .error = error};
    GN_TRY(walk_all(&w));
    hid_t root = H5Oopen(file->id, "/", H5P_DEFAULT);
    bool written = root >= 0 && write_number(root, of_names, w.names);
    if (root >= 0) H5Oclose(root);
    return written ? GNEISS_OK
                   : gn_h5_fail(file, error, GNEISS_ERROR_INTERNAL,
                                "the digest of its names cannot be written");
}

bool gn_h5_is_sealed(hid_t file) {
    return H5Aexists_by_name(file, "/", of_attributes, H5P_DEFAULT) > 0;
}

bool gn_h5_has_digests(const gn_h5 *file) {
    return file->digested;
}

gneiss_status gn_h5_check_names(gn_h5 *file, bool demanded, gneiss_error *error) {
    gn_h5_quiet();
    uint64_t written = 0;
    if (!file->digested && !demanded) return GNEISS_OK;
    if (!file->digested)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected digests of its contents, found none", file->path);
    walk w = {.file = file, .error = error};
    GN_TRY(walk_all(&w));
    hid_t root = H5Oopen(file->id, "/", H5P_DEFAULT);
    gneiss_status status = root < 0 ? unreadable(file, "/", error)
                                    : read_number(file, root, "/", of_names, &written, error);
    if (root >= 0) H5Oclose(root);
    if (status != GNEISS_OK || written == w.names) return status;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected the data sets that were written, found one more or one less",
                   file->path);
}
