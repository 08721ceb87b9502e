/* A column added to the manifest of contacts alone is treated like all others: it is kept when
 * lists are rebuilt, under an exchange of i and j, in a checkpoint, in the hash, and converted
 * between the two precisions. The columns are those of more_columns.h. */
#include "world_helpers.h"

#include "particles/active_pairs.h"
#include "particles/observe.h"
#include "run/run.h"
#include "soa/single.h"

#include <unistd.h>

static const char *const precisions[] = {"double", "mixed"};

/* A heap on a floor: contacts of all kinds of pairs of ids, walls, no bonds. */
static const char heap[] =
    "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [4, 4, 4], spacing: "
    "0.99, "
    "jitter: 0.005}}\n"
    "materials: [{name: m, density: 2650, normal_stiffness: 1e4, kratio: 2, friction: 0.4}]\n"
    "law: {stiffness: uniform}\ndamping: {contact: {restitution: 0.5}}\n"
    "walls:\n  - {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e4, kratio: 2, "
    "friction: 0.4}\n"
    "time: {end: 1}\n";
/* Spheres of which fewer than three of five listed pairs touch, so that these are packed. */
static const char loose[] =
    "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [5, 5, 5], spacing: 1, "
    "jitter: 0.02}}\n"
    "materials: [{name: m, density: 2650, normal_stiffness: 1e4, kratio: 2, friction: 0.4}]\n"
    "law: {stiffness: uniform}\ntime: {end: 1}\n";
static const char glued[] =
    "dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1e-3, cells: [3, 3, 3]}}\n"
    "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
    "time: {end: 1}\n";

static gn_run *run_of(const char *scene_text, const char *precision) {
    text *t = calloc(1, sizeof *t);
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    gn_scene scene;
    add(t, "%srun: {threads: 1, precision: %s}\n", scene_text, precision);
    if (gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    free(t);
    return run;
}

static void run_end(gn_run *run) {
    gn_run_free(run);
    free(run);
}

/* Returns a value of a contact of two particles, independent of their order: whole numbers, which
 * both precisions represent. The sign is that of the first particle. */
static double even_of(int32_t a, int32_t b) {
    return a * b + a + b + 1;
}
static double odd_of(int32_t a, int32_t b, int component) {
    return (a < b ? 1 : -1) * (even_of(a, b) + 7 * component);
}

static void set_column(double *wide, float *narrow, size_t at, double value) {
    if (wide) wide[at] = value;
    if (narrow) narrow[at] = (float)value;
}

static void mark_contacts(gn_world *w, gn_contacts *k) {
    for (size_t c = 0; c < k->soa.count; c++) {
        int32_t a = w->dem.particles.id[k->i[c]], b = w->dem.particles.id[k->j[c]];
        set_column(k->worn, k->worn_f, c, even_of(a, b));
        for (int x = 0; x < 2; x++)
            set_column(k->lean, k->lean_f, c + (size_t)x * k->soa.capacity, odd_of(a, b, x));
        set_column(k->hard, k->hard_f, c, -even_of(a, b));
        k->mark[c] = (uint8_t)(a * b);
        k->fresh[c] = 1.0;
    }
}

static void mark_walls(gn_world *w) {
    gn_wall_contacts *k = &w->boundary.contacts;
    for (size_t c = 0; c < k->soa.count; c++)
        for (size_t x = 0; x < 2; x++)
            k->worn[c + x * k->soa.capacity] =
                10.0 * w->dem.particles.id[k->i[c]] + (double)x + 1.0;
}

static double column(const double *wide, const float *narrow, size_t at) {
    assert_true(!wide != !narrow);
    return wide ? wide[at] : (double)narrow[at];
}

/* Checks that every column of a contact has the values that mark_contacts gave to its particles;
 * new contacts have zeros. */
static size_t check_contacts(const gn_world *w, const gn_contacts *k, double fresh) {
    size_t marked = 0;
    for (size_t c = 0; c < k->soa.count; c++) {
        int32_t a = w->dem.particles.id[k->i[c]], b = w->dem.particles.id[k->j[c]];
        if (column(k->worn, k->worn_f, c) == 0.0) continue;
        marked++;
        assert_true(column(k->worn, k->worn_f, c) == even_of(a, b));
        for (int x = 0; x < 2; x++)
            assert_true(column(k->lean, k->lean_f, c + (size_t)x * k->soa.capacity) ==
                        odd_of(a, b, x));
        assert_true(k->hard[c] == -even_of(a, b));
        if (k->hard_f) assert_true(k->hard_f[c] == (float)-even_of(a, b));
        assert_int_equal(k->mark[c], (uint8_t)(a * b));
        assert_true(k->fresh[c] == fresh);
    }
    return marked;
}

static size_t check_walls(const gn_world *w) {
    const gn_wall_contacts *k = &w->boundary.contacts;
    size_t marked = 0;
    for (size_t c = 0; c < k->soa.count; c++) {
        if (k->worn[c] == 0.0) continue;
        marked++;
        for (size_t x = 0; x < 2; x++)
            assert_true(k->worn[c + x * k->soa.capacity] ==
                        10.0 * w->dem.particles.id[k->i[c]] + (double)x + 1.0);
    }
    return marked;
}

static void a_new_column_is_kept_when_the_lists_are_made_anew(void **state) {
    (void)state;
    gneiss_error error = {0};
    for (int p = 0; p < 2; p++) {
        gn_run *run = run_of(heap, precisions[p]);
        gn_world *w = &run->world;
        mark_contacts(w, &w->dem.pairs.contacts);
        mark_walls(w);
        size_t pairs = w->dem.pairs.contacts.soa.count, walls = w->boundary.contacts.soa.count;
        assert_true(pairs > 100 && walls >= 16);
        assert_int_equal(gn_world_rebuild(w, &error), GNEISS_OK);
        assert_int_equal(check_contacts(w, &w->dem.pairs.contacts, 0.0), pairs);
        assert_int_equal(check_walls(w), walls);
        run_end(run);
    }
}

/* Writes to packed pairs in place of a kernel. */
static void write_packed(gn_active_pairs *near, size_t offset, double value) {
    bool found = false;
    for (int k = 0; k < near->columns; k++) {
        if (near->column[k].offset != offset) continue;
        for (size_t c = 0; c < near->room; c++)
            near->data[near->column[k].stream * near->room + c] = value;
        found = true;
    }
    assert_true(found);
}

static void packed_pairs_hand_back_a_new_column_that_is_state(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_run *run = run_of(loose, "double");
    gn_world *w = &run->world;
    for (int k = 0; k < 10; k++) assert_int_equal(gn_world_step(w, false, &error), GNEISS_OK);
    assert_true(w->dem.near.on && w->dem.near.packed);
    write_packed(&w->dem.near, offsetof(gn_contacts, worn), 7.0);
    write_packed(&w->dem.near, offsetof(gn_contacts, hard), 7.0);
    w->dem.near.unsettled = true;
    gn_active_pairs_settle(&w->ctx, &w->dem);
    size_t written = 0;
    for (size_t c = 0; c < w->dem.pairs.contacts.soa.count; c++) {
        written += w->dem.pairs.contacts.worn[c] == 7.0;
        assert_true(w->dem.pairs.contacts.hard[c] == 0.0);
    }
    assert_true(written > 20);
    run_end(run);
}

/* Rotated by 180 degrees about z, the particles have another order along the Morton curve. */
static void turn_by_180_degrees(gn_world *w) {
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        for (size_t a = 0; a < 2; a++) w->dem.particles.pos[4 * p + a] *= -1.0;
}

static size_t ends_in_reverse(const gn_world *w, const gn_contacts *k) {
    size_t count = 0;
    for (size_t c = 0; c < k->soa.count; c++)
        count += w->dem.particles.id[k->i[c]] > w->dem.particles.id[k->j[c]];
    return count;
}

static void an_odd_column_changes_sign_with_the_ends_and_an_even_one_does_not(void **state) {
    (void)state;
    gneiss_error error = {0};
    for (int p = 0; p < 2; p++) {
        gn_run *run = run_of(heap, precisions[p]);
        gn_world *w = &run->world;
        mark_contacts(w, &w->dem.pairs.contacts);
        mark_walls(w);
        size_t pairs = w->dem.pairs.contacts.soa.count,
               before = ends_in_reverse(w, &w->dem.pairs.contacts);
        turn_by_180_degrees(w);
        w->dem.verlet.rebuilds = 16; /* the sixteenth sorts */
        assert_int_equal(gn_world_rebuild(w, &error), GNEISS_OK);
        size_t after = ends_in_reverse(w, &w->dem.pairs.contacts);
        assert_true(after > before + 20 || before > after + 20);
        assert_int_equal(check_contacts(w, &w->dem.pairs.contacts, 0.0), pairs);
        assert_true(check_walls(w) >= 16);
        run_end(run);
    }
}

/* The state of a run that is read back, lists and all. */
static void a_new_column_is_in_a_checkpoint(void **state) {
    (void)state;
    char path[] = "/tmp/gneiss-more-columns-XXXXXX";
    gneiss_error error = {0};
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    for (int p = 0; p < 2; p++) {
        const char *const scenes[] = {heap, glued};
        for (int s = 0; s < 2; s++) {
            gn_run *run = run_of(scenes[s], precisions[p]), *again = calloc(1, sizeof *again);
            gn_world *w = &run->world;
            gn_contacts *k = s ? &w->dem.bonds.contacts : &w->dem.pairs.contacts;
            mark_contacts(w, k);
            if (!s) mark_walls(w);
            if (gn_checkpoint_write(run, path, &error) != GNEISS_OK ||
                gn_checkpoint_load(path, NULL, 0, again, &error) != GNEISS_OK)
                fail_msg("%s", error.message);
            gn_world *r = &again->world;
            assert_int_equal(
                check_contacts(r, s ? &r->dem.bonds.contacts : &r->dem.pairs.contacts, 1.0),
                k->soa.count);
            if (!s) assert_int_equal(check_walls(r), w->boundary.contacts.soa.count);
            assert_true(gn_world_hash(&r->ctx, &r->dem, &r->boundary, &r->solids, &r->box) ==
                        gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box));
            run_end(run);
            run_end(again);
        }
    }
    unlink(path);
}

static void a_new_column_that_is_state_is_hashed(void **state) {
    (void)state;
    for (int p = 0; p < 2; p++) {
        gn_run *run = run_of(heap, precisions[p]);
        gn_world *w = &run->world;
        gn_contacts *k = &w->dem.pairs.contacts;
        uint64_t start = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
        k->mark[3] ^= 1;
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) != start);
        k->mark[3] ^= 1;
        set_column(k->lean, k->lean_f, 5, 1.0);
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) != start);
        set_column(k->lean, k->lean_f, 5, 0.0);
        w->boundary.contacts.worn[1] = 1.0;
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) != start);
        w->boundary.contacts.worn[1] = 0.0;
        k->hard[0] = 1.0; /* saved only */
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == start);
        run_end(run);
    }
}

/* Output uses a copy in double. */
static void a_new_column_goes_from_one_precision_to_the_other(void **state) {
    (void)state;
    gn_run *run = run_of(heap, "mixed");
    gn_world *w = &run->world;
    gn_observed seen;
    gneiss_error error = {0};
    assert_true(w->dem.pairs.contacts.worn_f && !w->dem.pairs.contacts.worn &&
                w->dem.pairs.contacts.hard_f && w->dem.pairs.contacts.hard);
    mark_contacts(w, &w->dem.pairs.contacts);
    memset(w->dem.pairs.contacts.hard_f, 0,
           w->dem.pairs.contacts.soa.count * sizeof *w->dem.pairs.contacts.hard_f);
    gn_contacts_to_single(&w->dem.pairs.contacts, &w->dem.particles, (const double[3]){0, 0, 0}, 1);
    assert_int_equal(check_contacts(w, &w->dem.pairs.contacts, 1.0),
                     w->dem.pairs.contacts.soa.count);
    assert_int_equal(gn_dem_observe(&w->ctx, &w->dem, &w->box, &seen, &error), GNEISS_OK);
    assert_true(seen.list[GN_LIST_PAIRS].worn && !seen.list[GN_LIST_PAIRS].worn_f);
    assert_int_equal(check_contacts(w, &seen.list[GN_LIST_PAIRS], 1.0),
                     w->dem.pairs.contacts.soa.count);
    gn_observed_free(&seen);
    run_end(run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_column_is_kept_when_the_lists_are_made_anew),
        cmocka_unit_test(packed_pairs_hand_back_a_new_column_that_is_state),
        cmocka_unit_test(an_odd_column_changes_sign_with_the_ends_and_an_even_one_does_not),
        cmocka_unit_test(a_new_column_is_in_a_checkpoint),
        cmocka_unit_test(a_new_column_that_is_state_is_hashed),
        cmocka_unit_test(a_new_column_goes_from_one_precision_to_the_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
