/* The cache of packings: content of the key, and treatment of damaged caches. */
#include "pack_help.h"

#include "pack/store.h"

#include <sys/stat.h>

/* The cache is a folder of the test's own. */
static int setup(void **state) {
    if (make_fixture(state, "cache")) return -1;
    const fixture *f = *state;
    unsetenv("XDG_CACHE_HOME");
    setenv("HOME", f->dir, 1);
    return setenv("GNEISS_CACHE", f->path, 1);
}

static gn_pack_result obtained(const gn_scene *scene, const char *expected_note) {
    gn_pack_result result;
    char note[512] = "?";
    ok(gn_pack_obtain(scene, NULL, NULL, &result, note, sizeof note, error));
    if (*expected_note ? !strstr(note, expected_note) : *note)
        fail_msg("note '%s', expected '%s'", note, expected_note);
    return result;
}

static bool from_cache(const gn_scene *scene) {
    gn_pack_result r = obtained(scene, "");
    bool was = r.from_cache;
    gn_pack_result_free(&r);
    return was;
}

static bool specimen_from_cache(const fixture *f, int dimension, const char *specimen) {
    gn_scene s = scene_in(f->dir, dimension, "%s", specimen);
    bool was = from_cache(&s);
    gn_scene_free(&s);
    return was;
}

static int cached(const fixture *f) {
    return access(f->path, F_OK) ? 0 : entries(f->path, false);
}

/* The one file in the cache. */
static void find_file(const char *folder, char *path, size_t size) {
    DIR *d = opendir(folder);
    *path = '\0';
    for (struct dirent *e; (e = readdir(d));)
        if (e->d_name[0] != '.')
            assert_true(snprintf(path, size, "%s/%s", folder, e->d_name) < (int)size);
    closedir(d);
    assert_true(*path);
}

static unsigned char *read_whole(const char *path, size_t *size) {
    FILE *in = fopen(path, "rb");
    assert_non_null(in);
    unsigned char *bytes = malloc(1 << 20);
    *size = fread(bytes, 1, 1 << 20, in);
    fclose(in);
    assert_in_range(*size, 1, (1 << 20) - 1);
    return bytes;
}

static void write_whole(const char *path, const void *bytes, size_t size) {
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, size, out), size);
    fclose(out);
}

static const char disc[] = "disc: {diameter: 1}\n  particles: 60";

/* ---- the key ---- */

static void the_second_call_gives_the_same_packing_from_the_cache(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    gn_pack_result one = obtained(&s, ""), two = obtained(&s, "");
    assert_false(one.from_cache);
    assert_true(two.from_cache && two.in_time);
    assert_true(same_bits(&one, &two));
    assert_true(one.volume == two.volume && one.seconds == two.seconds);
    assert_int_equal(one.trace_count, two.trace_count);
    for (size_t k = 0; k < one.trace_count; k++) {
        const gn_pack_trace *a = &one.trace[k], *b = &two.trace[k];
        assert_int_equal(a->stage, b->stage);
        assert_int_equal(a->state.iteration, b->state.iteration);
        assert_int_equal(a->state.pairs, b->state.pairs);
        assert_true(a->state.energy == b->state.energy && a->state.gap_rms == b->state.gap_rms &&
                    a->state.overlap_max == b->state.overlap_max);
    }
    assert_int_equal(cached(f), 1);
    gn_pack_result_free(&one);
    gn_pack_result_free(&two);
    gn_scene_free(&s);
}

static void what_does_not_change_the_packing_finds_it_again(void **state) {
    const fixture *f = *state;
    assert_false(specimen_from_cache(f, 2, disc));
    static const char *const same[] = {
        "disc: {diameter: 1000 mm}\n  particles: 60",
        "disc: {diameter: 1}\n  particles: 60\n  group: 7",
        "disc: {diameter: 1}\n  particles: 60\n  density_basis: bulk\n  porosity: 0.1",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {time: 1000}"};
    for (size_t k = 0; k < sizeof same / sizeof *same; k++)
        assert_true(specimen_from_cache(f, 2, same[k]));
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    strcpy(s.specimen.material, "clay");
    assert_true(from_cache(&s));
    s.threads = 2;
    assert_true(from_cache(&s));
    gn_scene_free(&s);
    assert_int_equal(cached(f), 1);
}

static void every_key_of_the_shape_and_of_packing_makes_another_packing(void **state) {
    const fixture *f = *state;
    static const char *const other[] = {
        "disc: {diameter: 1}\n  particles: 61",
        "disc: {diameter: 1.01}\n  particles: 60",
        "disc: {diameter: 1}\n  particles: 60\n  origin: [0, 1]",
        "disc: {diameter: 1}\n  mean_radius: 0.06",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {size_ratio: 4}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {size_variation: 0.2}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {gap: 0.01}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {iterations: 20}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {residual: 0.5}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {overlap: passive}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {overlap: passive, overlap_size: 0.01}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {refine: [{boundary: true, size: 0.5, "
        "distance: 0.1}]}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {refine: [{boundary: true, size: 0.6, "
        "distance: 0.1}]}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {refine: [{boundary: true, size: 0.5, "
        "distance: 0.2}]}",
        "disc: {diameter: 1}\n  particles: 60\n  packing: {refine: [{from: [0, 0], to: [0, 1], "
        "size: 0.5, distance: 0.2}]}",
        "rectangle: {width: 1, height: 1}\n  particles: 60",
        "rectangle: {width: 1, height: 1.01}\n  particles: 60",
        "polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]\n  particles: 60",
        "polygon: [[0, 0], [1, 0], [1, 1], [0, 1.01]]\n  particles: 60"};
    enum { OTHER = sizeof other / sizeof *other };
    assert_false(specimen_from_cache(f, 2, disc));
    for (int k = 0; k < OTHER; k++)
        if (specimen_from_cache(f, 2, other[k])) fail_msg("taken for another: %s", other[k]);
    assert_int_equal(cached(f), OTHER + 1);
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    s.seed++;
    assert_false(from_cache(&s));
    gn_scene_free(&s);
}

static void the_contents_of_a_surface_count_and_not_its_name(void **state) {
    const fixture *f = *state;
    static const char *const specimen = "surface: %s\n  scale: %s\n  particles: 40";
    const struct {
        const char *file, *scale;
        double side;
        bool hit;
    } cases[] = {{"a.stl", "1", 1, false},
                 {"a.stl", "1", 1, true},
                 {"b.stl", "1", 1, true},
                 {"a.stl", "1", 1.1, false},
                 {"a.stl", "2", 1, false}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        write_cube(f, cases[k].file, cases[k].side, 12);
        gn_scene s = scene_in(f->dir, 3, specimen, cases[k].file, cases[k].scale);
        assert_int_equal(from_cache(&s), cases[k].hit);
        gn_scene_free(&s);
    }
}

static void the_contents_of_a_mesh_count_and_not_its_name(void **state) {
    const fixture *f = *state;
    write_mesh(f, "a.msh", 2, 1, 3);
    write_mesh(f, "b.msh", 2, 1, 3);
    write_mesh(f, "c.msh", 2, 1, 4);
    assert_false(specimen_from_cache(f, 2, "mesh: a.msh\n  particles: 60"));
    assert_true(specimen_from_cache(f, 2, "mesh: b.msh\n  particles: 60"));
    assert_false(specimen_from_cache(f, 2, "mesh: c.msh\n  particles: 60"));
    assert_false(specimen_from_cache(f, 2, "mesh: c.msh\n  packing: {start: nodes}"));
    assert_false(specimen_from_cache(f, 2, "mesh: c.msh\n  packing: {start: nodes, jiggle: 0.1}"));
}

/* ---- a cache that is no good ---- */

/* The file is not used, the note reports it, and a new packing replaces the file. */
static void check_replaced(const gn_scene *s, const gn_pack_result *good, const char *path,
                           const char *why) {
    char expected[512];
    snprintf(expected, sizeof expected, "%s: not used: ", path);
    gn_pack_result r = obtained(s, expected);
    assert_false(r.from_cache);
    assert_true(same_bits(good, &r));
    gn_pack_result_free(&r);
    r = obtained(s, "");
    if (!r.from_cache) fail_msg("%s: not replaced", why);
    assert_true(same_bits(good, &r));
    gn_pack_result_free(&r);
}

static void a_damaged_file_is_not_used_and_is_replaced(void **state) {
    const fixture *f = *state;
    char path[512];
    size_t size, used = 0, trials = 0;
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    gn_pack_result good = obtained(&s, "");
    find_file(f->path, path, sizeof path);
    unsigned char *bytes = read_whole(path, &size);
    for (size_t at = 5; at < size; at += size / 23, trials++) {
        bytes[at] ^= 0x10;
        write_whole(path, bytes, size);
        bytes[at] ^= 0x10;
        gn_pack_result r;
        char note[512];
        ok(gn_pack_obtain(&s, NULL, NULL, &r, note, sizeof note, error));
        /* Unused bytes may change undetected; numbers may not. */
        if (!same_bits(&good, &r) || r.trace_count != good.trace_count)
            fail_msg("byte %zu of %zu changed unseen", at, size);
        assert_true(r.from_cache == !*note);
        used += r.from_cache;
        gn_pack_result_free(&r);
    }
    assert_true(used < trials);
    free(bytes);
    assert_true(from_cache(&s));
    gn_pack_result_free(&good);
    gn_scene_free(&s);
}

static void a_file_of_which_a_part_is_missing_is_replaced(void **state) {
    const fixture *f = *state;
    char path[512];
    size_t size;
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    gn_pack_result good = obtained(&s, "");
    find_file(f->path, path, sizeof path);
    unsigned char *bytes = read_whole(path, &size);
    const size_t left[] = {0, 1, 100, size / 2, size - 1};
    for (int k = 0; k < 5; k++) {
        write_whole(path, bytes, left[k]);
        check_replaced(&s, &good, path, "truncated");
    }
    free(bytes);
    gn_pack_result_free(&good);
    gn_scene_free(&s);
}

static void a_file_of_something_else_is_replaced(void **state) {
    const fixture *f = *state;
    char path[512], other[128];
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    gn_pack_result good = obtained(&s, "");
    find_file(f->path, path, sizeof path);
    write_whole(path, "notes of mine\n", 14);
    check_replaced(&s, &good, path, "a text");
    /* Another HDF5 file, and the packing of another request. */
    gn_h5 *file = NULL;
    ok(gn_h5_create(path, &file, error));
    ok(gn_h5_attribute_text(file, "/", "kind", "something else", error));
    ok(gn_h5_commit(&file, GN_DURABLE, error));
    check_replaced(&s, &good, path, "another kind");
    snprintf(other, sizeof other, "%s/other", f->dir);
    setenv("GNEISS_CACHE", other, 1);
    assert_false(specimen_from_cache(f, 2, "disc: {diameter: 1}\n  particles: 61"));
    char from[512];
    find_file(other, from, sizeof from);
    assert_int_equal(rename(from, path), 0);
    setenv("GNEISS_CACHE", f->path, 1);
    check_replaced(&s, &good, path, "another packing");
    gn_pack_result_free(&good);
    gn_scene_free(&s);
}

static void a_folder_in_the_place_of_the_file_gives_a_note_and_a_packing(void **state) {
    const fixture *f = *state;
    char path[512];
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    gn_pack_result good = obtained(&s, "");
    find_file(f->path, path, sizeof path);
    unlink(path);
    assert_int_equal(mkdir(path, 0700), 0);
    gn_pack_result r = obtained(&s, "packing not cached: ");
    assert_true(!r.from_cache && same_bits(&good, &r));
    assert_int_equal(entries(path, false), 0);
    rmdir(path);
    gn_pack_result_free(&r);
    gn_pack_result_free(&good);
    gn_scene_free(&s);
}

static void a_cache_that_cannot_be_written_gives_a_note_and_a_packing(void **state) {
    const fixture *f = *state;
    char below[128];
    write_whole(f->path, "in the way", 10);
    snprintf(below, sizeof below, "%s/below", f->path);
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    const char *const places[] = {f->path, below};
    for (int k = 0; k < 2; k++) {
        setenv("GNEISS_CACHE", places[k], 1);
        gn_pack_result r = obtained(&s, "packing not cached: ");
        assert_true(!r.from_cache && r.packing.count == 60);
        gn_pack_result_free(&r);
    }
    gn_scene_free(&s);
}

static void a_packing_that_cannot_be_made_leaves_nothing(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 2, "disc: {diameter: 1}\n  mean_radius: 7");
    gn_pack_result r;
    char note[512];
    fails(gn_pack_obtain(&s, NULL, NULL, &r, note, sizeof note, error), GNEISS_ERROR_INPUT,
          "too large");
    assert_int_equal(cached(f), 0);
    gn_scene_free(&s);
}

static void a_surface_that_is_gone_is_an_error_that_names_it(void **state) {
    const fixture *f = *state;
    write_cube(f, "gone.stl", 1, 12);
    gn_scene s = scene_in(f->dir, 3, "surface: gone.stl\n  particles: 20");
    assert_int_equal(unlink(s.specimen.pack.surface_path), 0);
    gn_pack_result r;
    char note[512];
    fails(gn_pack_obtain(&s, NULL, NULL, &r, note, sizeof note, error), GNEISS_ERROR_IO,
          "gone.stl");
    gn_scene_free(&s);
}

/* ---- contents and place of the cache ---- */

static void off_writes_nothing(void **state) {
    const fixture *f = *state;
    setenv("GNEISS_CACHE", "off", 1);
    assert_false(specimen_from_cache(f, 2, disc));
    assert_false(specimen_from_cache(f, 2, disc));
    assert_int_equal(entries(f->dir, false), 0);
    assert_int_not_equal(access("off", F_OK), 0);
}

static void a_packing_cut_short_by_time_is_not_kept(void **state) {
    const fixture *f = *state;
    static const char hurried[] = "disc: {diameter: 1}\n  particles: 60\n  packing: {time: 1e-9}";
    assert_false(specimen_from_cache(f, 2, hurried));
    assert_int_equal(cached(f), 0);
    assert_false(specimen_from_cache(f, 2, hurried));
}

static bool give_up(void *context, const gn_pack_progress *progress) {
    (void)context;
    return progress->state.iteration < 5;
}

static void a_packing_given_up_is_not_kept(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 2, "%s", disc);
    gn_pack_result r;
    char note[512];
    fails(gn_pack_obtain(&s, give_up, NULL, &r, note, sizeof note, error), GNEISS_INTERRUPTED, "");
    assert_int_equal(cached(f), 0);
    gn_scene_free(&s);
}

static void without_a_wish_the_cache_is_that_of_the_user(void **state) {
    const fixture *f = *state;
    char place[128];
    unsetenv("GNEISS_CACHE");
    assert_false(specimen_from_cache(f, 2, disc));
    snprintf(place, sizeof place, "%s/.cache/gneiss", f->dir);
    assert_int_equal(entries(place, false), 1);
    setenv("XDG_CACHE_HOME", "relative", 1); /* a relative path must be ignored */
    assert_true(specimen_from_cache(f, 2, disc));
    snprintf(place, sizeof place, "%s/xdg", f->dir);
    setenv("XDG_CACHE_HOME", place, 1);
    assert_false(specimen_from_cache(f, 2, disc));
    strcat(place, "/gneiss");
    assert_int_equal(entries(place, false), 1);
    unsetenv("XDG_CACHE_HOME");
    unsetenv("HOME");
    assert_false(specimen_from_cache(f, 2, disc));
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, setup, teardown)
        FACT(the_second_call_gives_the_same_packing_from_the_cache),
        FACT(what_does_not_change_the_packing_finds_it_again),
        FACT(every_key_of_the_shape_and_of_packing_makes_another_packing),
        FACT(the_contents_of_a_surface_count_and_not_its_name),
        FACT(the_contents_of_a_mesh_count_and_not_its_name),
        FACT(a_damaged_file_is_not_used_and_is_replaced),
        FACT(a_file_of_which_a_part_is_missing_is_replaced),
        FACT(a_file_of_something_else_is_replaced),
        FACT(a_folder_in_the_place_of_the_file_gives_a_note_and_a_packing),
        FACT(a_cache_that_cannot_be_written_gives_a_note_and_a_packing),
        FACT(a_packing_that_cannot_be_made_leaves_nothing),
        FACT(a_surface_that_is_gone_is_an_error_that_names_it),
        FACT(off_writes_nothing),
        FACT(a_packing_cut_short_by_time_is_not_kept),
        FACT(a_packing_given_up_is_not_kept),
        FACT(without_a_wish_the_cache_is_that_of_the_user),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
