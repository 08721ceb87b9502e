#define _GNU_SOURCE /* memmem */
#include "io_helpers.h"

#include "io/h5.h"
#include "soa/records.h"

#include <dirent.h>
#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* HDF5 1.10 loses a few hundred bytes for each object header whose checksum is wrong. (test_io,
 * which writes through the same code, suppresses nothing.) */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
    return "leak:libhdf5\n";
}

static int setup(void **state) {
    return make_fixture(state, "a.h5");
}

enum { ROWS = 3000, WIDE = 200000 };

/* Data sets of every kind: compact, chunked, several chunks, texts, attributes. */
static void write_sample(const char *path) {
    gn_h5 *file;
    ok(gn_h5_create(path, &file, error));
    static double table[3 * ROWS];
    static int32_t wide[WIDE];
    for (int k = 0; k < 3 * ROWS; k++) table[k] = sin(k);
    for (int k = 0; k < WIDE; k++) wide[k] = k * 2654435761u;
    const uint8_t bytes[5] = {1, 2, 3, 4, 255};
    const int64_t whole[2] = {INT64_MIN, 7};
    const double tau = 6.25;
    ok(gn_h5_put(file, "history/table", GN_F64, ROWS, 3, 0, table, "m", "a table", error));
    ok(gn_h5_put(file, "wide", GN_I32, WIDE, 1, 0, wide, NULL, NULL, error));
    ok(gn_h5_put(file, "small/bytes", GN_U8, 5, 1, 0, bytes, NULL, NULL, error));
    ok(gn_h5_put(file, "empty", GN_F64, 0, 3, 0, NULL, "m", NULL, error));
    ok(gn_h5_put_text(file, "note", "a \xc2\xb5m b", error));
    ok(gn_h5_attribute_i64(file, "/", "whole", whole, 2, error));
    ok(gn_h5_attribute_f64(file, "small", "tau", &tau, 1, error));
    ok(gn_h5_attribute_text(file, "made/here", "empty", "", error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
}

#define check(condition)                                                                           \
    if (!(condition)) return #condition " does not hold"

/* `changes` NULL: all as written. *status is that of the first failed call. */
static const char *read_sample(const char *path, gneiss_status *status, gneiss_error *error) {
    static double table[3 * ROWS];
    static int32_t wide[WIDE];
    uint8_t bytes[5];
    int64_t whole[2];
    double tau;
    char *note = NULL, *text = NULL;
    gn_h5 *file = NULL;
    gneiss_status s = gn_h5_open(path, &file, error);
    if (!s) s = gn_h5_get(file, "history/table", GN_F64, ROWS, 3, 0, table, error);
    if (!s) s = gn_h5_get(file, "wide", GN_I32, WIDE, 1, 0, wide, error);
    if (!s) s = gn_h5_get(file, "small/bytes", GN_U8, 5, 1, 0, bytes, error);
    if (!s) s = gn_h5_get(file, "empty", GN_F64, 0, 3, 0, NULL, error);
    if (!s) s = gn_h5_get_text(file, "note", &note, error);
    if (!s) s = gn_h5_get_attribute_i64(file, "/", "whole", whole, 2, error);
    if (!s) s = gn_h5_get_attribute_f64(file, "small", "tau", &tau, 1, error);
    if (!s) s = gn_h5_get_attribute_text(file, "made/here", "empty", &text, error);
    gn_h5_close(file);
    *status = s;
    bool texts = !s && !strcmp(note, "a \xc2\xb5m b") && !strcmp(text, "");
    free(note);
    free(text);
    if (s) return "an error";
    check(texts);
    for (int k = 0; k < 3 * ROWS; k++) check(table[k] == sin(k));
    for (int k = 0; k < WIDE; k++) check(wide[k] == (int32_t)(k * 2654435761u));
    check(bytes[0] == 1 && bytes[4] == 255 && whole[0] == INT64_MIN && whole[1] == 7 &&
          tau == 6.25);
    return NULL;
}

static unsigned char *slurp(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    *size = (size_t)ftell(f);
    rewind(f);
    unsigned char *bytes = malloc(*size + 1);
    assert_int_equal(fread(bytes, 1, *size, f), *size);
    fclose(f);
    return bytes;
}

static void spill(const char *path, const void *bytes, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    if (size) assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

static void what_is_written_is_read(void **state) {
    fixture *f = *state;
    gneiss_error error = {0};
    gneiss_status status;
    write_sample(f->path);
    const char *wrong = read_sample(f->path, &status, &error);
    if (wrong) fail_msg("%s %s", wrong, error.message);
    assert_int_equal(entries(f->dir, false), 1);
}

static void the_same_data_give_the_same_file_a_second_later(void **state) {
    const fixture *f = *state;
    write_sample(f->path);
    size_t first_size, second_size;
    unsigned char *first = slurp(f->path, &first_size);
    const time_t start = time(NULL);
    while (time(NULL) == start) usleep(20000);
    write_sample(f->path);
    unsigned char *second = slurp(f->path, &second_size);
    assert_int_equal(first_size, second_size);
    assert_memory_equal(first, second, first_size);
    free(first);
    free(second);
}

static void rows_with_a_stride_are_packed_and_unpacked(void **state) {
    fixture *f = *state;
    struct item {
        double x, y;
        int32_t id, other;
    } in[700], out[700] = {0};
    for (int k = 0; k < 700; k++) in[k] = (struct item){k, -k, 3 * k, 5};
    gn_h5 *file;
    ok(gn_h5_create(f->path, &file, error));
    ok(gn_h5_put(file, "xy", GN_F64, 700, 2, sizeof *in, &in[0].x, "m", NULL, error));
    ok(gn_h5_put(file, "id", GN_I32, 700, 1, sizeof *in, &in[0].id, NULL, NULL, error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
    ok(gn_h5_open(f->path, &file, error));
    ok(gn_h5_get(file, "xy", GN_F64, 700, 2, sizeof *out, &out[0].x, error));
    ok(gn_h5_get(file, "id", GN_I32, 700, 1, sizeof *out, &out[0].id, error));
    size_t rows = 0;
    ok(gn_h5_rows(file, "xy", &rows, error));
    assert_int_equal(rows, 700);
    for (int k = 0; k < 700; k++)
        assert_true(out[k].x == k && out[k].y == -k && out[k].id == 3 * k && out[k].other == 0);
    gn_h5_close(file);
}

static void long_texts_are_kept_and_checked(void **state) {
    fixture *f = *state;
    enum { LENGTH = 200000 };
    char *text = malloc(LENGTH + 1), *back;
    for (int k = 0; k < LENGTH; k++) text[k] = (char)('a' + k % 23);
    text[LENGTH] = '\0';
    gn_h5 *file;
    ok(gn_h5_create(f->path, &file, error));
    ok(gn_h5_put_text(file, "scene", text, error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
    ok(gn_h5_open(f->path, &file, error));
    ok(gn_h5_get_text(file, "scene", &back, error));
    assert_string_equal(back, text);
    gn_h5_close(file);
    free(back);

    size_t size;
    unsigned char *bytes = slurp(f->path, &size);
    unsigned char *place = memmem(bytes, size, text + 100000, 100);
    assert_non_null(place);
    *place ^= 4;
    spill(f->path, bytes, size);
    ok(gn_h5_open(f->path, &file, error));
    fails(gn_h5_get_text(file, "scene", &back, error), GNEISS_ERROR_INPUT, "scene is damaged");
    assert_null(back);
    gn_h5_close(file);
    free(bytes);
    free(text);
}

static void mismatches_are_named(void **state) {
    fixture *f = *state;
    double value[9000];
    char *text;
    int64_t whole;
    write_sample(f->path);
    gn_h5 *file;
    ok(gn_h5_open(f->path, &file, error));
    assert_true(gn_h5_has(file, "history/table"));
    assert_false(gn_h5_has(file, "history/table2"));
    assert_false(gn_h5_has(file, "nothing/table"));
    fails(gn_h5_get(file, "gone", GN_F64, 1, 1, 0, value, error), GNEISS_ERROR_INPUT,
          "a.h5: data set gone is missing");
    fails(gn_h5_get(file, "history/table", GN_F64, 2999, 3, 0, value, error), GNEISS_ERROR_INPUT,
          "expected shape [2999][3], found [3000][3]");
    fails(gn_h5_get(file, "history/table", GN_F64, 9000, 1, 0, value, error), GNEISS_ERROR_INPUT,
          "expected shape [9000], found [3000][3]");
    fails(gn_h5_get(file, "history/table", GN_I64, ROWS, 3, 0, value, error), GNEISS_ERROR_INPUT,
          "expected int64, found float64");
    fails(gn_h5_get(file, "history", GN_F64, 1, 1, 0, value, error), GNEISS_ERROR_INPUT,
          "history is not a readable data set");
    fails(gn_h5_get_text(file, "wide", &text, error), GNEISS_ERROR_INPUT, "expected one text");
    fails(gn_h5_get_attribute_i64(file, "/", "whole", &whole, 1, error), GNEISS_ERROR_INPUT,
          "expected 1 x int64, found 2 x int64");
    fails(gn_h5_get_attribute_i64(file, "/", "gone", &whole, 1, error), GNEISS_ERROR_INPUT,
          "attribute gone of / is missing");
    gn_h5_close(file);
}

static void foreign_files_are_refused(void **state) {
    fixture *f = *state;
    gn_h5 *file;
    fails(gn_h5_open(f->path, &file, error), GNEISS_ERROR_IO, "No such file");
    fails(gn_h5_open(f->dir, &file, error), GNEISS_ERROR_INPUT, "found a folder");
    spill(f->path, "", 0);
    fails(gn_h5_open(f->path, &file, error), GNEISS_ERROR_INPUT, "found an empty one");
    spill(f->path, "hello, this is not it", 21);
    fails(gn_h5_open(f->path, &file, error), GNEISS_ERROR_INPUT, "no HDF5 signature");
    hid_t old = H5Fcreate(f->path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(old);
    fails(gn_h5_open(f->path, &file, error), GNEISS_ERROR_INPUT, "superblock 3");
    assert_null(file);
}

static void truncated_files_are_refused(void **state) {
    fixture *f = *state;
    write_sample(f->path);
    size_t size;
    unsigned char *bytes = slurp(f->path, &size);
    for (size_t k = 0; k <= 200; k++) {
        size_t kept = k < 100 ? k * 11 : k < 200 ? size * (k - 100) / 100 : size - 1;
        gneiss_error error = {0};
        gneiss_status status = GNEISS_OK;
        spill(f->path, bytes, kept);
        read_sample(f->path, &status, &error);
        if (status != GNEISS_ERROR_INPUT || !strstr(error.message, f->path))
            fail_msg("%zu of %zu bytes: status %d '%s'", kept, size, status, error.message);
    }
    free(bytes);
}

/* An unused byte may change; a change of any other is detected. */
static void a_damaged_byte_is_never_read_as_data(void **state) {
    fixture *f = *state;
    write_sample(f->path);
    size_t size;
    unsigned char *bytes = slurp(f->path, &size);
    uint64_t seed = 12345;
    int noticed = 0;
    for (size_t k = 0; k < 600; k++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        size_t at = k < 300 ? (seed >> 20) % 4096
                            : (seed >> 20) % size; /* object headers are at the start of the file */
        unsigned char saved = bytes[at];
        bytes[at] ^= (unsigned char)(1u << (seed >> 60) % 8);
        spill(f->path, bytes, size);
        bytes[at] = saved;
        gneiss_error error = {0};
        gneiss_status status;
        const char *wrong = read_sample(f->path, &status, &error);
        if (wrong && status == GNEISS_OK) fail_msg("byte %zu: %s", at, wrong);
        if (status != GNEISS_OK) assert_int_equal(status, GNEISS_ERROR_INPUT);
        noticed += status != GNEISS_OK;
    }
    if (noticed < 300) fail_msg("only %d of 600 flips were noticed", noticed);
    free(bytes);
}

static void set_file_limit(rlim_t bytes) {
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/* RLIMIT_FSIZE stops writes as a full disk does, without privileges. */
static void a_full_disk_leaves_the_old_file(void **state) {
    fixture *f = *state;
    write_sample(f->path);
    size_t size, after;
    unsigned char *old = slurp(f->path, &size);
    static double data[100000];
    struct rlimit before;
    getrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_IGN);
    for (rlim_t limit = 0; limit < sizeof data; limit = 7 * limit + 100) {
        gn_h5 *file;
        gneiss_error why = {0};
        set_file_limit(limit);
        gneiss_status status = gn_h5_create(f->path, &file, &why);
        if (!status) status = gn_h5_put(file, "d", GN_F64, 100000, 1, 0, data, "m", NULL, &why);
        if (!status) status = gn_h5_commit(&file, GN_DURABLE, &why);
        set_file_limit(before.rlim_cur);
        assert_int_equal(status, GNEISS_ERROR_IO);
        assert_non_null(strstr(why.message, "File too large"));
        assert_non_null(strstr(why.message, f->path));
        assert_int_equal(entries(f->dir, false), 1);
    }
    signal(SIGXFSZ, SIG_DFL);
    unsigned char *now = slurp(f->path, &after);
    assert_int_equal(after, size);
    assert_memory_equal(now, old, size);
    free(now);
    free(old);
}

static void unwritable_places_are_refused_at_once(void **state) {
    fixture *f = *state;
    char path[160];
    gn_h5 *file;
    snprintf(path, sizeof path, "%s/no/such/a.h5", f->dir);
    fails(gn_h5_create(path, &file, error), GNEISS_ERROR_IO, "No such file or directory");
    fails(gn_h5_create(f->dir, &file, error), GNEISS_ERROR_IO, "found a folder");
    fails(gn_h5_create("/dev/null", &file, error), GNEISS_ERROR_IO, "found a device");
    spill(f->path, "x", 1);
    snprintf(path, sizeof path, "%s/b.h5", f->path);
    fails(gn_h5_create(path, &file, error), GNEISS_ERROR_IO, "Not a directory");
    if (geteuid() != 0) {
        chmod(f->dir, 0500);
        snprintf(path, sizeof path, "%s/b.h5", f->dir);
        fails(gn_h5_create(path, &file, error), GNEISS_ERROR_IO, "Permission denied");
        chmod(f->dir, 0700);
    }
}

static void closing_without_commit_leaves_nothing(void **state) {
    fixture *f = *state;
    gn_h5 *file;
    const double one = 1;
    ok(gn_h5_create(f->path, &file, error));
    assert_int_equal(entries(f->dir, false), 1);
    ok(gn_h5_put(file, "one", GN_F64, 1, 1, 0, &one, NULL, NULL, error));
    gn_h5_close(file);
    assert_int_equal(entries(f->dir, false), 0);
    gn_h5_close(NULL);
}

static void a_failed_write_cannot_be_committed(void **state) {
    fixture *f = *state;
    gn_h5 *file;
    const double one = 1;
    ok(gn_h5_create(f->path, &file, error));
    ok(gn_h5_put(file, "one", GN_F64, 1, 1, 0, &one, NULL, NULL, error));
    fails(gn_h5_put(file, "one", GN_F64, 1, 1, 0, &one, NULL, NULL, error), GNEISS_ERROR_INTERNAL,
          "data set one cannot be written");
    fails(gn_h5_commit(&file, GN_DURABLE, error), GNEISS_ERROR_INTERNAL, "a write into it failed");
    assert_int_equal(entries(f->dir, false), 0);
}

/* Fills every byte of the record that counts, also of the fields that are not saved. */
static void fill_record(const gn_record *record, void *soa) {
    gn_soa *head = soa;
    unsigned next = 1;
    for (size_t k = 0; k < record->field_count; k++) {
        unsigned char *data = gn_field_data(&record->fields[k], soa);
        size_t bytes = head->capacity * (size_t)record->fields[k].components *
                       gn_type_size(record->fields[k].type);
        for (size_t b = 0; data && b < bytes; b++)
            data[b] = (unsigned char)((next = next * 1103515245 + 12345) >> 16);
    }
}

/* First `count` items of the field are equal bit for bit. */
static bool same_field(const gn_field *field, const void *a, const void *b) {
    const gn_soa *x = a, *y = b;
    size_t size = gn_type_size(field->type), n = x->count;
    const char *p = gn_field_data(field, a), *q = gn_field_data(field, b);
    if (field->layout == GN_ROWS) return !memcmp(p, q, size * (size_t)field->components * n);
    for (int c = 0; c < field->components; c++)
        if (memcmp(p + (size_t)c * x->capacity * size, q + (size_t)c * y->capacity * size,
                   n * size))
            return false;
    return true;
}

static void check_record(const char *path, const gn_record *record, void *a, void *b, size_t count,
                         gn_effects effects) {
    gn_h5 *file;
    ok(gn_soa_create(record, a, count, effects, error));
    fill_record(record, a);
    ok(gn_h5_create(path, &file, error));
    ok(gn_h5_put_record(file, "group/r", record, a, error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
    ok(gn_h5_open(path, &file, error));
    ok(gn_h5_get_record(file, "group/r", record, b, effects, error));
    for (size_t k = 0; k < record->field_count; k++) {
        const gn_field *field = &record->fields[k];
        char name[96];
        snprintf(name, sizeof name, "group/r/%s", field->name);
        bool kept = field->role != GN_SCRATCH && gn_field_active(field, effects);
        assert_int_equal(gn_h5_has(file, name), kept);
        if (kept && !same_field(field, a, b)) fail_msg("%s of %zu differs", field->name, count);
    }
    assert_true(gn_soa_hash(record, a, GN_HASH_SEED) == gn_soa_hash(record, b, GN_HASH_SEED));
    gn_h5_close(file);
    gn_soa_destroy(record, a);
    gn_soa_destroy(record, b);
}

static void records_are_restored_bit_for_bit(void **state) {
    fixture *f = *state;
    const gn_effects all = (UINT64_C(1) << GN_EFFECT_COUNT) - 1;
    const gn_effects masks[] = {0, all, GN_FX_BONDS | GN_FX_SHEAR, GN_FX_ROTATION | GN_FX_SPACE};
    const size_t counts[] = {0, 1, 2, 17, 40000};
    for (size_t m = 0; m < 4; m++)
        for (size_t c = 0; c < 5; c++) {
            gn_particles p, p2;
            gn_contacts q, q2;
            gn_wall_contacts w, w2;
            check_record(f->path, &gn_particle_record, &p, &p2, counts[c], masks[m]);
            check_record(f->path, &gn_contact_record, &q, &q2, counts[c], masks[m]);
            check_record(f->path, &gn_wall_contact_record, &w, &w2, counts[c], masks[m]);
        }
}

static void columns_are_stored_by_component(void **state) {
    fixture *f = *state;
    gn_contacts q;
    gn_h5 *file;
    double shear[3][5];
    ok(gn_soa_create(&gn_contact_record, &q, 5, GN_FX_SHEAR, error));
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 5; k++) q.shear[c * q.soa.capacity + k] = 10 * c + k;
    ok(gn_h5_create(f->path, &file, error));
    ok(gn_h5_put_record(file, "pairs", &gn_contact_record, &q, error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
    ok(gn_h5_open(f->path, &file, error));
    ok(gn_h5_get(file, "pairs/shear", GN_F64, 3, 5, 0, shear, error));
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 5; k++) assert_true(shear[c][k] == 10 * c + k);
    gn_h5_close(file);
    gn_soa_destroy(&gn_contact_record, &q);
}

static void a_record_that_does_not_fit_is_refused(void **state) {
    fixture *f = *state;
    gn_particles p, back;
    gn_h5 *file;
    ok(gn_soa_create(&gn_particle_record, &p, 6, GN_FX_ROTATION, error));
    ok(gn_h5_create(f->path, &file, error));
    ok(gn_h5_put_record(file, "good", &gn_particle_record, &p, error));
    ok(gn_h5_put_record(file, "wrong", &gn_particle_record, &p, error));
    const int64_t seven = 7, huge = INT64_MAX, negative = -1;
    ok(gn_h5_attribute_i64(file, "wrong", "count", &seven, 1, error));
    ok(gn_h5_put_record(file, "huge", &gn_particle_record, &p, error));
    ok(gn_h5_attribute_i64(file, "huge", "count", &huge, 1, error));
    ok(gn_h5_put_record(file, "negative", &gn_particle_record, &p, error));
    ok(gn_h5_attribute_i64(file, "negative", "count", &negative, 1, error));
    ok(gn_h5_attribute_i64(file, "bare", "count", &seven, 1, error));
    ok(gn_h5_attribute_text(file, "bare", "effects", "rotation", error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
    ok(gn_h5_open(f->path, &file, error));
    const gn_record *record = &gn_particle_record;
    fails(gn_h5_get_record(file, "good", record, &back, GN_FX_ROTATION | GN_FX_BONDS, error),
          GNEISS_ERROR_INPUT, "expected the effects rotation,bonds, found rotation");
    fails(gn_h5_get_record(file, "wrong", record, &back, GN_FX_ROTATION, error), GNEISS_ERROR_INPUT,
          "wrong/pos: expected shape [7][4], found [6][4]");
    fails(gn_h5_get_record(file, "huge", record, &back, GN_FX_ROTATION, error), GNEISS_ERROR_INPUT,
          "huge/pos: expected shape");
    fails(gn_h5_get_record(file, "negative", record, &back, GN_FX_ROTATION, error),
          GNEISS_ERROR_INPUT, "expected >= 0, found -1");
    fails(gn_h5_get_record(file, "bare", record, &back, GN_FX_ROTATION, error), GNEISS_ERROR_INPUT,
          "bare/pos is missing");
    fails(gn_h5_get_record(file, "gone", record, &back, GN_FX_ROTATION, error), GNEISS_ERROR_INPUT,
          "gone is missing");
    gn_h5_close(file);
    gn_soa_destroy(&gn_particle_record, &p);
}

/* A header that promises chunks which were never written would read as zeros. */
static void missing_chunks_are_refused(void **state) {
    fixture *f = *state;
    hid_t access = H5Pcreate(H5P_FILE_ACCESS), list = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    hid_t id = H5Fcreate(f->path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    hsize_t size = (hsize_t)1 << 45, chunk = 1000;
    H5Pset_chunk(list, 1, &chunk);
    hid_t space = H5Screate_simple(1, &size, NULL);
    hid_t set = H5Dcreate2(id, "promise", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    assert_true(set >= 0);
    H5Dclose(set), H5Sclose(space), H5Pclose(list), H5Pclose(access), H5Fclose(id);
    gn_h5 *file;
    double value;
    ok(gn_h5_open(f->path, &file, error));
    fails(gn_h5_get(file, "promise", GN_F64, size, 1, 0, &value, error), GNEISS_ERROR_INPUT,
          "part of it is not in the file");
    gn_h5_close(file);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
    const struct CMUnitTest tests[] = {
        WITH(what_is_written_is_read),
        WITH(the_same_data_give_the_same_file_a_second_later),
        WITH(rows_with_a_stride_are_packed_and_unpacked),
        WITH(long_texts_are_kept_and_checked),
        WITH(mismatches_are_named),
        WITH(foreign_files_are_refused),
        WITH(truncated_files_are_refused),
        WITH(a_damaged_byte_is_never_read_as_data),
        WITH(a_full_disk_leaves_the_old_file),
        WITH(unwritable_places_are_refused_at_once),
        WITH(closing_without_commit_leaves_nothing),
        WITH(a_failed_write_cannot_be_committed),
        WITH(records_are_restored_bit_for_bit),
        WITH(columns_are_stored_by_component),
        WITH(a_record_that_does_not_fit_is_refused),
        WITH(missing_chunks_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
