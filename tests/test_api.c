/* The public API as users see it: this program uses the public headers and the shared library only.
 * */
#include "api_helpers.h"

#include <dirent.h>
#include <pthread.h>
#include <stdbool.h>
#include <unistd.h>

/* A bonded block between a wall that closes on it and a held foot: every record has items. */
static const char block[] =
    "specimen:\n"
    "  lattice: {kind: cubic, radius: 1 mm, cells: [4, 4, 4], jitter: 0.1}\n"
    "materials:\n"
    "  - name: rock\n"
    "    density: 2000\n"
    "    normal_stiffness: 1 MN/m\n"
    "    kratio: 2\n"
    "    friction: 0.4\n"
    "    bond_tension_limit: 6 N\n"
    "    bond_shear_limit: 6 N\n"
    "law: {stiffness: uniform}\n"
    "bonds: {interaction_range: 0.05}\n"
    "sets:\n"
    "  - name: foot\n"
    "    select: {end: {axis: z, side: lower, depth: 1.5 mm, by: surface}}\n"
    "    motion: {vx: 0, vy: 0, vz: 0}\n"
    "walls:\n"
    "  - {name: top, point: [0, 0, 8.1 mm], normal: [0, 0, -1],\n"
    "     stiffness: 1 MN/m, motion: {vz: -3 m/s}}\n"
    "test: {kind: compression, axis: z, lower: foot, upper: top}\n"
    "time: {end: 0.2 ms, stop: none}\n"
    "output: {history_rows: 20, snapshots: 2, checkpoint: off}\n"
    "neighbours: {skin: 0.5 mm}\n"
    "run: {threads: 1}\n";

/* Two loose spheres without contact: all optional records are absent. */
static const char loose[] = "specimen:\n"
                            "  particles: [[0, 0, 0, 1 mm], [5 mm, 0, 0, 2 mm]]\n"
                            "materials:\n"
                            "  - {name: ball, density: 2000, normal_stiffness: 1 MN/m, kratio: 0}\n"
                            "law: {stiffness: uniform, rotation: off}\n"
                            "time: {end: 1 ms}\n"
                            "output: {energy: off, history_rows: 10}\n"
                            "run: {threads: 1}\n";

/* A temporary folder that is removed with its contents. */
typedef struct place {
    char path[256];
} place;

static place make_place(void) {
    place p;
    snprintf(p.path, sizeof p.path, "/tmp/gneiss-api-XXXXXX");
    assert_non_null(mkdtemp(p.path));
    return p;
}

static char *inside(const place *p, const char *name) {
    static char path[4][600];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", p->path, name);
    return path[turn];
}

static int count_files(const char *folder, const char *prefix, bool remove_them) {
    int count = 0;
    char path[1024];
    DIR *d = opendir(folder);
    for (struct dirent *e = d ? readdir(d) : NULL; e; e = readdir(d)) {
        if (strncmp(e->d_name, prefix, strlen(prefix)) != 0 || e->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        if (remove_them) unlink(path);
        count++;
    }
    if (d) closedir(d);
    return count;
}

static void remove_place(const place *p) {
    count_files(p->path, "", true);
    rmdir(p->path);
}

/* World of a text with at most one override; `folder` as for gneiss_world_create. */
static gneiss_world *world_of(const char *text, const char *change, const char *folder) {
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    must(gneiss_scene_parse(text, "block.yaml", NULL, &change, change != NULL, &scene, &error),
         &error);
    must(gneiss_world_create(scene, folder, &world, &error), &error);
    gneiss_scene_free(scene);
    return world;
}

static void step(gneiss_world *world, int64_t steps) {
    gneiss_error error = {0};
    must(gneiss_world_step(world, steps, &error), &error);
}

static gneiss_view field(const gneiss_world *world, gneiss_record record, const char *name) {
    gneiss_error error = {0};
    gneiss_view view;
    must(gneiss_world_field(world, record, name, &view, &error), &error);
    return view;
}

static gneiss_counts counts_of(const gneiss_world *world) {
    gneiss_counts counts;
    must(gneiss_world_counts(world, &counts, NULL), &(gneiss_error){0});
    return counts;
}

static gneiss_progress progress_of(const gneiss_world *world) {
    gneiss_progress progress;
    must(gneiss_world_progress(world, &progress, NULL), &(gneiss_error){0});
    return progress;
}

static double energy(const gneiss_world *world, const char *name) {
    gneiss_quantity q;
    gneiss_error error = {0};
    must(gneiss_world_energy(world, name, &q, &error), &error);
    return q.value;
}

/* --- scenes --- */

static void scenes_load_from_a_file_with_overrides(void **state) {
    (void)state;
    char path[4096];
    const char *overrides[] = {"time.end=7 ms", "title=other = one"};
    gneiss_scene *scene = NULL;
    gneiss_error error = {0};
    snprintf(path, sizeof path, "%s/examples/two_spheres.yaml", test_source());
    must(gneiss_scene_load(path, overrides, 2, &scene, &error), &error);
    assert_non_null(strstr(gneiss_scene_text(scene), "0.007"));
    assert_non_null(strstr(gneiss_scene_text(scene), "other = one"));
    gneiss_scene_free(scene);
}

static void scene_errors_say_where(void **state) {
    (void)state;
    gneiss_scene *scene = (gneiss_scene *)&scene;
    gneiss_error error = {0};
    assert_int_equal(
        gneiss_scene_parse("dimension: 3\ntimes: 1\n", "odd.yaml", NULL, NULL, 0, &scene, &error),
        GNEISS_ERROR_INPUT);
    assert_message(&error, GNEISS_ERROR_INPUT, "odd.yaml:2:1");
    assert_null(scene);
    assert_int_equal(gneiss_scene_load("/nowhere/at/all.yaml", NULL, 0, &scene, &error),
                     GNEISS_ERROR_INPUT);
    assert_message(&error, GNEISS_ERROR_INPUT, "/nowhere/at/all.yaml");
}

/* The geometry is invalid: if gmsh were called, its own message or its absence would be reported.
 * */
static void geometries_are_not_given_to_gmsh_unless_that_is_allowed(void **state) {
    (void)state;
    static const char text[] =
        "dimension: 2\nspecimen: {mesh: body.geo, particles: 30}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
        "law: {stiffness: uniform}\ntime: {end: 1e-5}\n";
    char folder[] = "/tmp/gneiss-api-XXXXXX", path[64];
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    gneiss_error error = {0};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/body.geo", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("nothing;\n", file);
    fclose(file);
    must(gneiss_scene_parse(text, "s.yaml", folder, NULL, 0, &scene, &error), &error);
    assert_int_equal(gneiss_world_create(scene, NULL, &world, &error), GNEISS_ERROR_INPUT);
    assert_message(&error, GNEISS_ERROR_INPUT, "gneiss_scene_allow_gmsh");
    gneiss_scene_allow_gmsh(scene, 1);
    error = (gneiss_error){0};
    assert_int_equal(gneiss_world_create(scene, NULL, &world, &error), GNEISS_ERROR_INPUT);
    assert_message(&error, GNEISS_ERROR_INPUT, "gmsh");
    assert_null(strstr(error.message, "gneiss_scene_allow_gmsh"));
    gneiss_scene_allow_gmsh(NULL, 1);
    gneiss_scene_free(scene);
    remove(path);
    rmdir(folder);
}

static void empty_overrides_are_refused(void **state) {
    (void)state;
    const char *const bad[] = {"time.end", "=3", "", NULL, "no.such.key=1"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        const char *overrides[] = {"time.end=1 ms", bad[k]};
        gneiss_scene *scene = NULL;
        gneiss_error error = {0};
        assert_int_equal(gneiss_scene_parse(block, NULL, NULL, overrides, 2, &scene, &error),
                         GNEISS_ERROR_INPUT);
        assert_true(strlen(error.message) > 10);
        assert_null(scene);
    }
}

/* --- misuse --- */

#define REFUSED(call)                                                                              \
    do {                                                                                           \
        error = (gneiss_error){0};                                                                 \
        assert_int_equal((call), GNEISS_ERROR_INPUT);                                              \
        assert_message(&error, GNEISS_ERROR_INPUT, "expected");                                    \
    } while (0)

static void null_scenes_and_makers_are_refused(void **state) {
    (void)state;
    gneiss_error error;
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    REFUSED(gneiss_scene_load(NULL, NULL, 0, &scene, &error));
    REFUSED(gneiss_scene_load("a.yaml", NULL, 0, NULL, &error));
    REFUSED(gneiss_scene_load("a.yaml", NULL, 1, &scene, &error));
    REFUSED(gneiss_scene_parse(NULL, NULL, NULL, NULL, 0, &scene, &error));
    REFUSED(gneiss_scene_parse(block, NULL, NULL, NULL, 0, NULL, &error));
    REFUSED(gneiss_world_create(NULL, NULL, &world, &error));
    must(gneiss_scene_parse(block, NULL, NULL, NULL, 0, &scene, &error), &error);
    REFUSED(gneiss_world_create(scene, NULL, NULL, &error));
    gneiss_scene_free(scene);
    REFUSED(gneiss_world_load(NULL, NULL, 0, &world, &error));
    REFUSED(gneiss_world_load("a.h5", NULL, 0, NULL, &error));
    REFUSED(gneiss_world_resume(NULL, NULL, 0, &world, &error));
    assert_null(world);
}

static void null_worlds_are_refused(void **state) {
    (void)state;
    gneiss_error error;
    gneiss_view view;
    gneiss_quantity q;
    gneiss_progress progress;
    gneiss_limits limits;
    gneiss_counts counts;
    REFUSED(gneiss_world_step(NULL, 1, &error));
    REFUSED(gneiss_world_advance(NULL, 1.0, &error));
    REFUSED(gneiss_world_run(NULL, &error));
    REFUSED(gneiss_world_finish(NULL, &error));
    REFUSED(gneiss_world_save(NULL, "a.h5", &error));
    REFUSED(gneiss_world_checkpoint(NULL, &error));
    REFUSED(gneiss_world_progress(NULL, &progress, &error));
    REFUSED(gneiss_world_limits(NULL, &limits, &error));
    REFUSED(gneiss_world_counts(NULL, &counts, &error));
    REFUSED(gneiss_world_element_counts(NULL, &(gneiss_element_counts){0}, &error));
    REFUSED(gneiss_world_field(NULL, GNEISS_PARTICLES, "pos", &view, &error));
    REFUSED(gneiss_world_field_at(NULL, GNEISS_PARTICLES, 0, &view, &error));
    REFUSED(gneiss_world_history(NULL, "time", &view, &error));
    REFUSED(gneiss_world_history_at(NULL, 0, &view, &error));
    REFUSED(gneiss_world_reading(NULL, "peak_stress", &q, &error));
    REFUSED(gneiss_world_reading_at(NULL, 0, &q, &error));
    REFUSED(gneiss_world_energy(NULL, "kinetic", &q, &error));
    REFUSED(gneiss_world_energy_at(NULL, 0, &q, &error));
    REFUSED(gneiss_world_energy_instant(NULL, &(int64_t){0}, &(double){0}, &error));
}

static void null_results_and_names_are_refused(void **state) {
    (void)state;
    gneiss_error error;
    gneiss_view view;
    gneiss_quantity q;
    gneiss_world *w = world_of(loose, NULL, NULL);
    REFUSED(gneiss_world_save(w, NULL, &error));
    REFUSED(gneiss_world_progress(w, NULL, &error));
    REFUSED(gneiss_world_limits(w, NULL, &error));
    REFUSED(gneiss_world_counts(w, NULL, &error));
    REFUSED(gneiss_world_element_counts(w, NULL, &error));
    REFUSED(gneiss_world_field(w, GNEISS_PARTICLES, NULL, &view, &error));
    REFUSED(gneiss_world_field(w, GNEISS_PARTICLES, "pos", NULL, &error));
    REFUSED(gneiss_world_field_at(w, GNEISS_PARTICLES, 0, NULL, &error));
    REFUSED(gneiss_world_history(w, NULL, &view, &error));
    REFUSED(gneiss_world_history(w, "time", NULL, &error));
    REFUSED(gneiss_world_history_at(w, 0, NULL, &error));
    REFUSED(gneiss_world_reading(w, NULL, &q, &error));
    REFUSED(gneiss_world_reading(w, "peak_stress", NULL, &error));
    REFUSED(gneiss_world_reading_at(w, 0, NULL, &error));
    REFUSED(gneiss_world_energy(w, NULL, &q, &error));
    REFUSED(gneiss_world_energy_at(w, 0, NULL, &error));
    REFUSED(gneiss_world_energy_instant(w, NULL, &(double){0}, &error));
    REFUSED(gneiss_world_energy_instant(w, &(int64_t){0}, NULL, &error));
    gneiss_world_free(w);
}

static void unknown_names_and_indices_are_refused(void **state) {
    (void)state;
    gneiss_error error;
    gneiss_view view;
    gneiss_quantity q;
    gneiss_world *w = world_of(block, NULL, NULL);
    REFUSED(gneiss_world_step(w, -1, &error));
    REFUSED(gneiss_world_advance(w, -1.0, &error));
    REFUSED(gneiss_world_advance(w, NAN, &error));
    REFUSED(gneiss_world_field(w, (gneiss_record)6, "pos", &view, &error));
    REFUSED(gneiss_world_field(w, (gneiss_record)-1, "pos", &view, &error));
    REFUSED(gneiss_world_field(w, GNEISS_PARTICLES, "colour", &view, &error));
    assert_message(&error, GNEISS_ERROR_INPUT, "pos, vel");
    size_t fields = gneiss_world_field_count(w, GNEISS_PARTICLES);
    REFUSED(gneiss_world_field_at(w, GNEISS_PARTICLES, fields, &view, &error));
    REFUSED(gneiss_world_history(w, "colour", &view, &error));
    REFUSED(gneiss_world_history_at(w, gneiss_world_history_count(w), &view, &error));
    REFUSED(gneiss_world_reading(w, "colour", &q, &error));
    assert_message(&error, GNEISS_ERROR_INPUT, "poisson_ratio");
    REFUSED(gneiss_world_reading_at(w, gneiss_reading_count(), &q, &error));
    REFUSED(gneiss_world_energy(w, "colour", &q, &error));
    REFUSED(gneiss_world_energy_at(w, gneiss_energy_count(), &q, &error));
    REFUSED(gneiss_world_checkpoint(w, &error));
    gneiss_world_free(w);
}

static void paths_that_are_too_long_are_refused(void **state) {
    (void)state;
    static char path[6000];
    gneiss_error error;
    gneiss_scene *scene = NULL;
    gneiss_world *w = world_of(loose, NULL, NULL), *other = NULL;
    memset(path, 'x', sizeof path - 1);
    must(gneiss_scene_parse(loose, NULL, NULL, NULL, 0, &scene, &error), &error);
    REFUSED(gneiss_world_create(scene, path, &other, &error));
    REFUSED(gneiss_world_save(w, path, &error));
    REFUSED(gneiss_world_load(path, NULL, 0, &other, &error));
    REFUSED(gneiss_world_resume(path, NULL, 0, &other, &error));
    gneiss_scene_free(scene);
    gneiss_world_free(w);
}

static void null_is_nothing_to_free_and_counts_nothing(void **state) {
    (void)state;
    gneiss_scene_free(NULL);
    gneiss_world_free(NULL);
    assert_null(gneiss_scene_text(NULL));
    assert_string_equal(gneiss_world_note(NULL), "");
    assert_int_equal(gneiss_world_steps(NULL), 0);
    assert_true(gneiss_world_time(NULL) == 0.0);
    assert_int_equal(gneiss_world_hash(NULL), 0);
    assert_int_equal(gneiss_world_field_count(NULL, GNEISS_PARTICLES), 0);
    assert_int_equal(gneiss_world_history_count(NULL), 0);
    assert_true(isnan(gneiss_view_value(NULL, 0, 0)));
    assert_null(gneiss_record_name((gneiss_record)6));
}

static void the_error_may_be_null(void **state) {
    (void)state;
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    assert_int_equal(gneiss_scene_parse("a: [", NULL, NULL, NULL, 0, &scene, NULL),
                     GNEISS_ERROR_INPUT);
    assert_int_equal(gneiss_world_step(NULL, 1, NULL), GNEISS_ERROR_INPUT);
    assert_int_equal(gneiss_world_load("/nowhere/x.h5", NULL, 0, &world, NULL), GNEISS_ERROR_IO);
    assert_int_equal(gneiss_world_resume("/nowhere", NULL, 0, &world, NULL), GNEISS_ERROR_INPUT);
    const char *wild[] = {"time.step=0.1 ms"};
    must(gneiss_scene_parse(block, NULL, NULL, wild, 1, &scene, NULL), &(gneiss_error){0});
    assert_int_equal(gneiss_world_create(scene, NULL, &world, NULL), GNEISS_ERROR_INPUT);
    assert_null(world);
    gneiss_scene_free(scene);
}

static void success_leaves_the_error_as_it_was(void **state) {
    (void)state;
    gneiss_error error = {GNEISS_ERROR_MEMORY, "from before"};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    assert_int_equal(gneiss_scene_parse(block, NULL, NULL, NULL, 0, &scene, &error), GNEISS_OK);
    assert_int_equal(gneiss_world_create(scene, NULL, &world, &error), GNEISS_OK);
    assert_int_equal(gneiss_world_run(world, &error), GNEISS_OK);
    assert_int_equal(error.status, GNEISS_ERROR_MEMORY);
    assert_string_equal(error.message, "from before");
    gneiss_scene_free(scene);
    gneiss_world_free(world);
}

/* --- looking --- */

static void particle_views_show_the_specimen(void **state) {
    (void)state;
    gneiss_world *w = world_of(loose, NULL, NULL);
    gneiss_view id = field(w, GNEISS_PARTICLES, "id"), pos = field(w, GNEISS_PARTICLES, "pos");
    gneiss_view vel = field(w, GNEISS_PARTICLES, "vel");
    assert_int_equal(pos.count, 2);
    assert_int_equal(pos.components, 4);
    assert_int_equal(id.type, GNEISS_I32);
    for (size_t k = 0; k < 2; k++) {
        double second = gneiss_view_value(&id, k, 0), radius = 1e-3 * (1.0 + second);
        double mass = 2000.0 * 4.0 / 3.0 * M_PI * radius * radius * radius;
        assert_close(gneiss_view_value(&pos, k, 0), 5e-3 * second, 1e-15);
        assert_close(gneiss_view_value(&pos, k, 3), radius, 1e-15);
        assert_close(gneiss_view_value(&vel, k, 3), 1.0 / mass, 1e-14);
    }
    assert_true(isnan(gneiss_view_value(&pos, 2, 0)));
    assert_true(isnan(gneiss_view_value(&pos, 0, 4)));
    gneiss_world_free(w);
}

/* A bond's stress-free length is the distance of its ends at the start. */
static void contact_views_lead_to_particles(void **state) {
    (void)state;
    gneiss_world *w = world_of(block, NULL, NULL);
    gneiss_view i = field(w, GNEISS_BONDS, "i"), j = field(w, GNEISS_BONDS, "j");
    gneiss_view pos = field(w, GNEISS_PARTICLES, "pos");
    gneiss_view length = field(w, GNEISS_BONDS, "length0");
    assert_true(length.count >= 3 * 16);
    for (size_t c = 0; c < length.count; c++) {
        size_t a = (size_t)gneiss_view_value(&i, c, 0), b = (size_t)gneiss_view_value(&j, c, 0);
        double d2 = 0.0;
        for (size_t k = 0; k < 3; k++) {
            double d = gneiss_view_value(&pos, b, k) - gneiss_view_value(&pos, a, k);
            d2 += d * d;
        }
        assert_close(gneiss_view_value(&length, c, 0), sqrt(d2), 1e-14);
    }
    gneiss_world_free(w);
}

/* The tangential force, stored by component, is perpendicular to the normal and at most the
 * strength of a bond: only the right strides satisfy both. */
static void column_views_stride_by_component(void **state) {
    (void)state;
    gneiss_world *w = world_of(block, "walls.top.motion.vz=-0.3", NULL);
    step(w, 60);
    gneiss_view i = field(w, GNEISS_BONDS, "i"), j = field(w, GNEISS_BONDS, "j");
    gneiss_view pos = field(w, GNEISS_PARTICLES, "pos");
    gneiss_view shear = field(w, GNEISS_BONDS, "shear");
    assert_int_equal(shear.components, 3);
    assert_int_equal(shear.item_stride, sizeof(double));
    assert_true(shear.component_stride >= shear.count * sizeof(double));
    double along = 0.0, across = 0.0;
    for (size_t c = 0; c < shear.count; c++) {
        size_t a = (size_t)gneiss_view_value(&i, c, 0), b = (size_t)gneiss_view_value(&j, c, 0);
        double dot = 0.0, t2 = 0.0, d2 = 0.0;
        for (size_t k = 0; k < 3; k++) {
            double d = gneiss_view_value(&pos, b, k) - gneiss_view_value(&pos, a, k);
            double t = gneiss_view_value(&shear, c, k);
            dot += d * t;
            t2 += t * t;
            d2 += d * d;
        }
        along += fabs(dot) / sqrt(d2);
        across += sqrt(t2);
    }
    assert_true(across > 0.0);
    /* Positions are a step ahead of forces: 0.3 m/s x 2 us rotates a normal of 2 mm by 3e-4. */
    assert_true(along < 1e-3 * across);
    gneiss_world_free(w);
}

static void every_field_is_found_by_index_and_by_name(void **state) {
    (void)state;
    static const size_t sizes[] = {8, 8, 4, 1, 4};
    gneiss_world *w = world_of(block, NULL, NULL);
    step(w, 60);
    for (int record = 0; record < 4; record++) {
        size_t count = gneiss_world_field_count(w, (gneiss_record)record);
        assert_true(count >= 4); /* these fields exist under no condition */
        for (size_t k = 0; k < count; k++) {
            gneiss_view at;
            must(gneiss_world_field_at(w, (gneiss_record)record, k, &at, NULL), &(gneiss_error){0});
            gneiss_view named = field(w, (gneiss_record)record, at.name);
            assert_ptr_equal(named.data, at.data);
            assert_true(at.count > 0 && strlen(at.unit) > 0 && strlen(at.description) > 0);
            assert_true(at.item_stride >= sizes[at.type]);
            double last = gneiss_view_value(&at, at.count - 1, (size_t)at.components - 1);
            assert_true(isfinite(last)); /* the last item is memory that may be read */
        }
    }
    gneiss_world_free(w);
}

static void a_scene_has_only_the_fields_it_needs(void **state) {
    (void)state;
    gneiss_view view;
    gneiss_world *w = world_of(loose, NULL, NULL);
    assert_int_equal(gneiss_world_field(w, GNEISS_PARTICLES, "spin", &view, NULL),
                     GNEISS_ERROR_INPUT);
    assert_int_equal(gneiss_world_field_count(w, GNEISS_WALL_CONTACTS), 0);
    gneiss_counts c = counts_of(w);
    assert_int_equal(c.particles, 2);
    assert_int_equal(c.bonds, 0);
    assert_int_equal(c.wall_contacts, 0);
    gneiss_world_free(w);
}

static double *output_of(const gneiss_world *w, gneiss_record record, size_t index,
                         gneiss_view *what) {
    gneiss_error error = {0};
    must(gneiss_world_output_at(w, record, index, what, &error), &error);
    size_t count = what->count * (size_t)what->components;
    double *values = calloc(count + 1, sizeof *values);
    values[count] = -7.0;
    must(gneiss_world_output(w, record, what->name, values, count, &error), &error);
    assert_true(values[count] == -7.0);
    return values;
}

static void nodes_and_elements_have_fields(void **state) {
    (void)state;
    static const char bar[] = "dimension: 2\n"
                              "elements:\n"
                              "  rectangle: {size: [4 cm, 1 cm], cells: [4, 1]}\n"
                              "  materials: [{young: 30 GPa, poisson: 0.2, density: 2400 kg/m3}]\n"
                              "  motions: [{name: end, group: x_upper, motion: {vx: 1 m/s}}]\n"
                              "time: {end: 1 ms}\n"
                              "run: {threads: 1}\n";
    gneiss_world *w = world_of(bar, NULL, NULL);
    gneiss_limits limits;
    must(gneiss_world_limits(w, &limits, NULL), &(gneiss_error){0});
    assert_true(limits.bound > 0.0 && limits.bound <= limits.sharp && isfinite(limits.sharp));
    step(w, 3);
    gneiss_view pos = field(w, GNEISS_NODES, "pos"), vel = field(w, GNEISS_NODES, "vel");
    assert_int_equal(pos.count, 10);
    assert_int_equal(field(w, GNEISS_ELEMENTS, "node").count, 8);
    gneiss_view what;
    for (size_t k = 0; k < gneiss_world_output_count(w, GNEISS_NODES); k++)
        free(output_of(w, GNEISS_NODES, k, &what));
    assert_int_equal(what.count, 10);
    for (size_t k = 0; k < gneiss_world_output_count(w, GNEISS_ELEMENTS); k++)
        free(output_of(w, GNEISS_ELEMENTS, k, &what));
    assert_int_equal(what.count, 8);
    for (size_t k = 0; k < pos.count; k++)
        if (gneiss_view_value(&pos, k, 0) > 0.04) assert_true(gneiss_view_value(&vel, k, 0) == 1.0);
    assert_int_equal(counts_of(w).particles, 0);
    gneiss_world_free(w);
    w = world_of(loose, NULL, NULL);
    assert_int_equal(gneiss_world_field_count(w, GNEISS_NODES), 0);
    assert_int_equal(gneiss_world_field_count(w, GNEISS_ELEMENTS), 0);
    gneiss_world_free(w);
}

static gneiss_element_counts elements_of(const gneiss_world *world) {
    gneiss_element_counts counts;
    must(gneiss_world_element_counts(world, &counts, NULL), &(gneiss_error){0});
    return counts;
}

static double sum_of(const gneiss_world *w, const char *name, size_t *count) {
    gneiss_error error = {0};
    gneiss_view what;
    for (size_t k = 0; k < gneiss_world_output_count(w, GNEISS_PARTICLES); k++) {
        must(gneiss_world_output_at(w, GNEISS_PARTICLES, k, &what, &error), &error);
        if (strcmp(what.name, name) != 0) continue;
        double *values = output_of(w, GNEISS_PARTICLES, k, &what), sum = 0.0;
        for (size_t p = 0; p < what.count; p++) sum += values[p];
        *count = what.count;
        free(values);
        return sum;
    }
    fail_msg("no output %s", name);
    return 0.0;
}

#define LATTICE                                                                                    \
    "dimension: 2\n"                                                                               \
    "materials: [{name: m, density: 9931, normal_stiffness: 24e9, kratio: 1, friction: 0, "        \
    "bond_tension_limit: 1e12, bond_shear_limit: 1e12}]\n"                                         \
    "law: {stiffness: uniform}\n"                                                                  \
    "bonds: {interaction_range: 0.01}\n"                                                           \
    "output: {history_rows: 20, snapshots: 0, checkpoint: off}\n"                                  \
    "run: {threads: 1}\n"

/* A strip in tension: elements convert, particles become active; a saved world gives the same. */
static void elements_that_convert_are_counted(void **state) {
    (void)state;
    static const char strip[] =
        LATTICE "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [30, 8]}}\n"
                "elements:\n"
                "  rectangle: {size: [30 mm, 8 mm], cells: [15, 4]}\n"
                "  materials: [{young: 24e9, poisson: 0, density: 7800}]\n"
                "  motions:\n"
                "    - {name: left, group: x_lower, motion: {vx: 0}}\n"
                "    - {name: right, group: x_upper, motion: {vx: 0.1}}\n"
                "couple: {convert: {box: {min: [3 mm, -1], max: [27 mm, 1]}, width: 6 mm, stress: "
                "1.2 MPa, every: 5, most: 0.01}}\n"
                "time: {end: 0.1 ms}\n";
    gneiss_world *w = world_of(strip, NULL, NULL), *again = NULL;
    gneiss_error error = {0};
    size_t particles = 0;
    gneiss_element_counts first = elements_of(w), then = first;
    assert_int_equal(first.elements, 120);
    assert_int_equal(first.nodes, 16 * 5);
    assert_int_equal(first.asleep, 240);
    assert_int_equal(counts_of(w).particles, 240);
    for (int k = 0; k < 400 && then.elements == first.elements; k++) {
        step(w, 1);
        then = elements_of(w);
    }
    assert_true(then.elements < 120 && then.elements > 0);
    assert_true(then.asleep < 240 && then.asleep > 0);
    assert_int_equal(field(w, GNEISS_ELEMENTS, "node").count, then.elements);
    assert_true(sum_of(w, "asleep", &particles) == (double)then.asleep);
    assert_int_equal(particles, 240);
    place p = make_place();
    must(gneiss_world_save(w, inside(&p, "a.h5"), &error), &error);
    must(gneiss_world_load(inside(&p, "a.h5"), NULL, 0, &again, &error), &error);
    step(w, 20);
    step(again, 20);
    assert_int_equal(elements_of(again).elements, elements_of(w).elements);
    assert_int_equal(elements_of(again).asleep, elements_of(w).asleep);
    assert_true(gneiss_world_hash(again) == gneiss_world_hash(w));
    gneiss_world_free(w);
    gneiss_world_free(again);
    remove_place(&p);
}

/* A scene with a zone has particles and elements, and the returned energy is a reading. */
static void zones_have_elements_and_a_reading(void **state) {
    (void)state;
    static const char strip[] =
        LATTICE "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [20, 8], "
                "origin: [11.5 mm, 0]}}\n"
                "elements: {rectangle: {size: [20 mm, 8 mm], cells: [10, 4]}, materials: [{young: "
                "24e9, poisson: 0, density: 7800}]}\n"
                "couple: {zones: [{edges: [{from: [20 mm, 0], to: [12 mm, 0]}]}]}\n"
                "initial: {pulse: {direction: [1, 0], centre: [5 mm, 0], length: 8 mm, size: 1 um, "
                "speed: 1754}}\n"
                "time: {end: 8 us}\n";
    gneiss_world *w = world_of(strip, NULL, NULL);
    gneiss_error error = {0};
    gneiss_quantity returned;
    must(gneiss_world_run(w, &error), &error);
    assert_int_equal(elements_of(w).elements, 80);
    assert_int_equal(elements_of(w).asleep, 0);
    assert_int_equal(counts_of(w).particles, 160);
    must(gneiss_world_reading(w, "returned_energy", &returned, &error), &error);
    assert_true(returned.value > 0.0 && returned.value < 0.5);
    gneiss_world_free(w);
}

/* Derived outputs follow the state as well: damage is that of the broken bonds, and broken bonds
 * have the largest criterion. */
static void outputs_are_those_of_the_files(void **state) {
    (void)state;
    gneiss_world *w = world_of(block, NULL, NULL);
    double damage = 0.0, broken = 0.0, criterion = 0.0;
    step(w, 600);
    assert_true(counts_of(w).broken_tension + counts_of(w).broken_shear > 0);
    gneiss_view what, cause = field(w, GNEISS_BONDS, "cause");
    for (size_t c = 0; c < cause.count; c++) broken += gneiss_view_value(&cause, c, 0) > 0.0;
    for (size_t k = 0; k < gneiss_world_output_count(w, GNEISS_PARTICLES); k++) {
        double *values = output_of(w, GNEISS_PARTICLES, k, &what);
        for (size_t p = 0; p < what.count; p++)
            damage += strcmp(what.name, "damage") == 0 && values[p] > 0.0;
        assert_true(strcmp(what.name, "radius") != 0 || values[0] == 1e-3);
        free(values);
    }
    for (size_t k = 0; k < gneiss_world_output_count(w, GNEISS_BONDS); k++) {
        double *values = output_of(w, GNEISS_BONDS, k, &what);
        for (size_t c = 0; c < what.count; c++)
            criterion += strcmp(what.name, "criterion") == 0 && values[c] == 1.0;
        free(values);
    }
    assert_true(damage > 0.0 && damage <= 2.0 * broken);
    assert_true(criterion == broken);
    gneiss_world_free(w);
}

static void unknown_outputs_are_refused(void **state) {
    (void)state;
    gneiss_error error;
    gneiss_view what;
    double values[8];
    gneiss_world *w = world_of(loose, NULL, NULL);
    must(gneiss_world_output(w, GNEISS_PARTICLES, "position", values, 6, &error), &error);
    assert_true(values[3] == 5e-3);
    REFUSED(gneiss_world_output(w, GNEISS_PARTICLES, "position", values, 5, &error));
    REFUSED(gneiss_world_output(w, GNEISS_PARTICLES, "colour", values, 2, &error));
    REFUSED(gneiss_world_output(w, GNEISS_BONDS, "criterion", values, 0, &error));
    REFUSED(gneiss_world_output(w, GNEISS_NODES, "stress", values, 0, &error));
    REFUSED(gneiss_world_output(w, GNEISS_PARTICLES, NULL, values, 2, &error));
    REFUSED(gneiss_world_output(w, GNEISS_PARTICLES, "radius", NULL, 2, &error));
    REFUSED(gneiss_world_output(NULL, GNEISS_PARTICLES, "radius", values, 2, &error));
    size_t count = gneiss_world_output_count(w, GNEISS_PARTICLES);
    REFUSED(gneiss_world_output_at(w, GNEISS_PARTICLES, count, &what, &error));
    REFUSED(gneiss_world_output_at(w, GNEISS_PAIRS, 0, &what, &error));
    REFUSED(gneiss_world_output_at(w, GNEISS_PARTICLES, 0, NULL, &error));
    REFUSED(gneiss_world_output_at(NULL, GNEISS_PARTICLES, 0, &what, &error));
    assert_int_equal(gneiss_world_output_count(w, (gneiss_record)-1), 0);
    assert_int_equal(gneiss_world_output_count(NULL, GNEISS_PARTICLES), 0);
    gneiss_world_free(w);
}

static void views_show_positions_from_the_origin(void **state) {
    (void)state;
    static const char far[] = "dimension: 2\n"
                              "elements:\n"
                              "  rectangle: {size: [4 mm, 1 mm], cells: [4, 1], origin: [1e6, 0]}\n"
                              "  materials: [{young: 30 GPa, poisson: 0.2, density: 2400 kg/m3}]\n"
                              "time: {end: 1 ms}\n"
                              "run: {threads: 1}\n";
    double origin[3] = {-1, -1, -1};
    gneiss_error error = {0};
    gneiss_world *w = world_of(far, NULL, NULL);
    must(gneiss_world_origin(w, origin, &error), &error);
    assert_true(origin[0] == 1e6 && origin[1] == 0.0 && origin[2] == 0.0);
    gneiss_view pos = field(w, GNEISS_NODES, "pos");
    for (size_t k = 0; k < pos.count; k++) {
        double x = gneiss_view_value(&pos, k, 0);
        assert_true(x >= 0.0 && x <= 4e-3);
    }
    gneiss_world_free(w);
    w = world_of(far, "elements.rectangle.origin=[3, 0]", NULL);
    must(gneiss_world_origin(w, origin, &error), &error);
    assert_true(origin[0] == 0.0 && origin[1] == 0.0 && origin[2] == 0.0);
    assert_int_equal(gneiss_world_origin(NULL, origin, NULL), GNEISS_ERROR_INPUT);
    assert_int_equal(gneiss_world_origin(w, NULL, NULL), GNEISS_ERROR_INPUT);
    gneiss_world_free(w);
}

static void counts_follow_the_views(void **state) {
    (void)state;
    gneiss_world *w = world_of(block, NULL, NULL);
    gneiss_error error = {0};
    must(gneiss_world_run(w, &error), &error);
    gneiss_counts c = counts_of(w);
    gneiss_view cause = field(w, GNEISS_BONDS, "cause");
    int64_t broken[3] = {0};
    for (size_t k = 0; k < cause.count; k++) broken[(int)gneiss_view_value(&cause, k, 0)]++;
    assert_int_equal(c.particles, 64);
    assert_int_equal(c.walls, 1);
    assert_int_equal(c.sets, 1);
    assert_int_equal(c.bonds, cause.count);
    assert_true(c.broken_tension + c.broken_shear > 0);
    assert_int_equal(c.broken_tension, broken[1]);
    assert_int_equal(c.broken_shear, broken[2]);
    assert_int_equal(c.wall_contacts, field(w, GNEISS_WALL_CONTACTS, "i").count);
    gneiss_world_free(w);
}

static void the_history_has_a_row_every_interval(void **state) {
    (void)state;
    /* The block is loaded slowly, so that it does not break and the step does not change. */
    gneiss_world *w = world_of(block, "walls.top.motion.vz=-0.3", NULL);
    gneiss_error error = {0};
    must(gneiss_world_run(w, &error), &error);
    gneiss_view time, steps;
    must(gneiss_world_history(w, "time", &time, &error), &error);
    must(gneiss_world_history(w, "step", &steps, &error), &error);
    assert_string_equal(time.unit, "s");
    assert_int_equal(time.count, counts_of(w).history_rows);
    assert_true(time.count >= 20 && time.count <= 25); /* 20 requested, whole steps between them */
    double interval = gneiss_view_value(&steps, 1, 0);
    for (size_t k = 0; k < time.count; k++)
        assert_true(gneiss_view_value(&steps, k, 0) == interval * (double)k);
    for (size_t k = 0; k < gneiss_world_history_count(w); k++) {
        gneiss_view at, named;
        must(gneiss_world_history_at(w, k, &at, &error), &error);
        must(gneiss_world_history(w, at.name, &named, &error), &error);
        assert_ptr_equal(at.data, named.data);
    }
    gneiss_world_free(w);
}

/* Two bonded spheres pulled apart: E = k_n L/A and strength R_n/A exactly, up to the interval
 * between rows: 0.1 m/s x 1.5 ms/1000 x 1 MN/m = 0.15 N of 100 N, and as much again for a step. */
static void readings_are_those_of_the_closed_form(void **state) {
    (void)state;
    char path[4096];
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *w = NULL;
    gneiss_quantity modulus, peak;
    snprintf(path, sizeof path, "%s/examples/two_spheres.yaml", test_source());
    must(gneiss_scene_load(path, NULL, 0, &scene, &error), &error);
    must(gneiss_world_create(scene, NULL, &w, &error), &error);
    must(gneiss_world_run(w, &error), &error);
    must(gneiss_world_reading(w, "young_modulus", &modulus, &error), &error);
    must(gneiss_world_reading(w, "peak_stress", &peak, &error), &error);
    assert_string_equal(modulus.unit, "Pa");
    assert_close(modulus.value, 0.5e9, 1e-6);
    assert_true(peak.value <= 25e6 && peak.value > 0.994 * 25e6);
    for (size_t k = 0; k < gneiss_reading_count(); k++) {
        gneiss_quantity at, named;
        must(gneiss_world_reading_at(w, k, &at, &error), &error);
        must(gneiss_world_reading(w, at.name, &named, &error), &error);
        assert_string_equal(at.name, named.name);
    }
    gneiss_scene_free(scene);
    gneiss_world_free(w);
}

static void readings_without_a_test_are_nan(void **state) {
    (void)state;
    gneiss_quantity q;
    gneiss_world *w = world_of(loose, NULL, NULL);
    step(w, 10);
    must(gneiss_world_reading(w, "peak_stress", &q, NULL), &(gneiss_error){0});
    assert_true(isnan(q.value));
    gneiss_world_free(w);
}

static void energies_balance(void **state) {
    (void)state;
    gneiss_world *w = world_of(block, NULL, NULL);
    assert_true(isnan(energy(w, "kinetic"))); /* no reading has been taken yet */
    gneiss_error error = {0};
    must(gneiss_world_run(w, &error), &error);
    gneiss_quantity q;
    double stored = 0.0, in = 0.0, lost = 0.0;
    for (size_t k = 0; k < gneiss_energy_count(); k++) {
        must(gneiss_world_energy_at(w, k, &q, &error), &error);
        if (strcmp(q.name, "residual") == 0) continue;
        assert_string_equal(q.unit, "J");
        if (strncmp(q.name, "work_", 5) == 0 || strcmp(q.name, "step_change") == 0)
            in += q.value;
        else if (strncmp(q.name, "elastic", 7) == 0 || strcmp(q.name, "kinetic") == 0 ||
                 strcmp(q.name, "rotational") == 0)
            stored += q.value;
        else if (strcmp(q.name, "stored_at_start") == 0)
            stored -= q.value;
        else
            lost += q.value;
    }
    assert_true(in > 0.0 && lost > 0.0);
    double residual = energy(w, "residual");
    assert_true(fabs((stored - in + lost) / in - residual) < 1e-12);
    assert_true(fabs(residual - progress_of(w).energy_residual) == 0.0);
    gneiss_world_free(w);
}

static void energies_without_a_ledger_are_nan(void **state) {
    (void)state;
    gneiss_world *w = world_of(loose, NULL, NULL);
    step(w, 1);
    assert_true(isnan(energy(w, "kinetic")));
    assert_true(isnan(progress_of(w).energy_residual));
    gneiss_world_free(w);
}

static void the_step_is_a_share_of_the_limit(void **state) {
    (void)state;
    gneiss_limits l;
    gneiss_world *w = world_of(block, "time.safety=0.5", NULL);
    must(gneiss_world_limits(w, &l, NULL), &(gneiss_error){0});
    assert_close(l.dt, 0.5 * l.stable, 1e-15);
    assert_true(l.bound > 0.0 && l.bound <= l.sharp);
    assert_true(l.dt == progress_of(w).dt);
    gneiss_world_free(w);
}

/* --- advancing --- */

static void step_takes_exactly_as_many_also_past_the_end(void **state) {
    (void)state;
    gneiss_world *w = world_of(block, NULL, NULL);
    step(w, 0);
    assert_int_equal(gneiss_world_steps(w), 0);
    step(w, 7);
    assert_int_equal(gneiss_world_steps(w), 7);
    assert_close(gneiss_world_time(w), 7 * progress_of(w).dt, 1e-14);
    assert_int_equal(progress_of(w).finished, 0);
    assert_string_equal(progress_of(w).stop_reason, "");
    gneiss_error error = {0};
    must(gneiss_world_run(w, &error), &error);
    gneiss_progress end = progress_of(w);
    assert_int_equal(end.finished, 1);
    assert_non_null(strstr(end.stop_reason, "reached"));
    assert_true(fabs(end.time - 0.2e-3) <= 0.5 * end.dt);
    must(gneiss_world_run(w, &error), &error); /* the world is already at that time */
    assert_int_equal(gneiss_world_steps(w), end.step);
    step(w, 5);
    assert_int_equal(gneiss_world_steps(w), end.step + 5);
    gneiss_world_free(w);
}

/* Queries objects by index and name, existing or not; no query may change a world. */
static void ask(const gneiss_world *w, unsigned pick) {
    static const char *const names[] = {"position",      "force", "time", "kinetic",
                                        "young_modulus", "",      "x",    "%s%n"};
    static const size_t indices[] = {0, 1, 7, 12, 99, (size_t)INT32_MAX + 1, SIZE_MAX};
    const char *name = names[pick % 8];
    size_t index = indices[pick / 8 % 7];
    gneiss_record record = (gneiss_record)((int)(pick / 64 % 9) - 1); /* -1, 6 and 7 are invalid */
    gneiss_view view = {0};
    gneiss_quantity quantity;
    gneiss_progress progress;
    gneiss_counts counts;
    (void)gneiss_world_field_count(w, record);
    (void)gneiss_record_name(record);
    (void)gneiss_world_field_at(w, record, index, &view, NULL);
    (void)gneiss_view_value(&view, index, index);
    (void)gneiss_view_value(&view, 0, SIZE_MAX);
    (void)gneiss_world_field(w, record, name, &view, NULL);
    (void)gneiss_world_output_at(w, record, index, &view, NULL);
    (void)gneiss_world_history(w, name, &view, NULL);
    (void)gneiss_view_value(&view, index, 0);
    (void)gneiss_world_history_at(w, index, &view, NULL);
    (void)gneiss_world_reading(w, name, &quantity, NULL);
    (void)gneiss_world_reading_at(w, index, &quantity, NULL);
    (void)gneiss_world_energy(w, name, &quantity, NULL);
    (void)gneiss_world_energy_at(w, index, &quantity, NULL);
    (void)gneiss_world_progress(w, &progress, NULL);
    (void)gneiss_world_counts(w, &counts, NULL);
}

/* A call that must be refused or must have no effect. */
static void misuse(gneiss_world *w, const place *p, unsigned pick) {
    switch (pick % 8) {
    case 0:
        assert_int_equal(gneiss_world_step(w, -1 - (int64_t)pick, NULL), GNEISS_ERROR_INPUT);
        break;
    case 1:
        assert_int_equal(gneiss_world_advance(w, NAN, NULL), GNEISS_ERROR_INPUT);
        break;
    case 2:
        assert_int_equal(gneiss_world_advance(w, -1.0, NULL), GNEISS_ERROR_INPUT);
        break;
    case 3:
        assert_int_equal(gneiss_world_checkpoint(w, NULL),
                         GNEISS_ERROR_INPUT); /* the world has no folder */
        break;
    case 4:
        assert_int_equal(gneiss_world_finish(w, NULL),
                         GNEISS_OK); /* without a folder the call does nothing */
        break;
    case 5:
        assert_int_equal(gneiss_world_save(w, p->path, NULL), GNEISS_ERROR_IO); /* a folder */
        break;
    case 6:
        assert_int_equal(gneiss_world_step(w, 0, NULL), GNEISS_OK);
        break;
    case 7:
        assert_int_equal(gneiss_world_save(w, inside(p, "saved.h5"), NULL), GNEISS_OK);
        break;
    }
}

static void calls_in_any_order_leave_the_world_as_it_is(void **state) {
    (void)state;
    place p = make_place();
    gneiss_world *w = world_of(block, NULL, NULL), *same = world_of(block, NULL, NULL);
    unsigned random = 7;
    for (int k = 0; k < 400; k++) {
        random = random * 1664525u + 1013904223u;
        if (k % 10 == 0) {
            step(w, 1);
            step(same, 1);
        }
        misuse(w, &p, random >> 8);
        ask(w, random >> 8);
    }
    assert_true(gneiss_world_hash(w) == gneiss_world_hash(same));
    gneiss_world_free(w);
    gneiss_world_free(same);
    remove_place(&p);
}

static void slices_of_wall_time_come_to_the_same_end(void **state) {
    (void)state;
    gneiss_world *a = world_of(block, NULL, NULL), *b = world_of(block, NULL, NULL);
    gneiss_error error = {0};
    must(gneiss_world_run(a, &error), &error);
    int slices = 0;
    for (; !progress_of(b).finished; slices++) must(gneiss_world_advance(b, 0.0, &error), &error);
    assert_true(slices > 1);
    assert_int_equal(gneiss_world_hash(a), gneiss_world_hash(b));
    gneiss_world_free(a);
    gneiss_world_free(b);
}

static void two_worlds_advanced_in_turns_do_not_affect_each_other(void **state) {
    (void)state;
    gneiss_world *alone = world_of(block, NULL, NULL);
    step(alone, 90);
    gneiss_world *a = world_of(block, NULL, NULL), *b = world_of(block, "run.seed=2", NULL);
    for (int k = 0; k < 30; k++) {
        step(a, 3);
        step(b, 2);
    }
    assert_int_equal(gneiss_world_hash(a), gneiss_world_hash(alone));
    assert_int_not_equal(gneiss_world_hash(b), gneiss_world_hash(alone));
    assert_int_equal(gneiss_world_steps(b), 60);
    gneiss_world_free(b);
    step(a, 1);
    gneiss_world_free(a);
    gneiss_world_free(alone);
}

static void *step_in_a_thread(void *world) {
    return gneiss_world_step(world, 90, NULL) == GNEISS_OK ? world : NULL;
}

static void two_worlds_in_two_threads_give_the_same_bits(void **state) {
    (void)state;
    gneiss_world *w[3];
    pthread_t thread[2];
    for (int k = 0; k < 3; k++) w[k] = world_of(block, NULL, NULL);
    for (int k = 0; k < 2; k++)
        assert_int_equal(pthread_create(&thread[k], NULL, step_in_a_thread, w[k]), 0);
    for (int k = 0; k < 2; k++) {
        void *done = NULL;
        pthread_join(thread[k], &done);
        assert_non_null(done);
    }
    step(w[2], 90);
    assert_int_equal(gneiss_world_hash(w[0]), gneiss_world_hash(w[2]));
    assert_int_equal(gneiss_world_hash(w[1]), gneiss_world_hash(w[2]));
    for (int k = 0; k < 3; k++) gneiss_world_free(w[k]);
}

/* A world with the same step, deliberately far above the limit. */
static gneiss_world *unstable_world(const char *folder) {
    const char *overrides[] = {"time.step=0.1 ms", "time.on_unstable=warn", "time.end=1 s"};
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    must(gneiss_scene_parse(block, NULL, NULL, overrides, 3, &scene, &error), &error);
    must(gneiss_world_create(scene, folder, &world, &error), &error);
    gneiss_scene_free(scene);
    return world;
}

static void a_failed_run_can_only_be_read(void **state) {
    (void)state;
    place p = make_place();
    gneiss_world *w = unstable_world(inside(&p, "out"));
    gneiss_error error = {0}, again = {0};
    assert_int_equal(gneiss_world_run(w, &error), GNEISS_ERROR_UNSTABLE);
    assert_message(&error, GNEISS_ERROR_UNSTABLE, "failed_*.hdf");
    assert_int_equal(count_files(inside(&p, "out"), "failed_particles", false), 1);
    assert_int_equal(field(w, GNEISS_PARTICLES, "pos").count, 64);
    assert_int_equal(gneiss_world_step(w, 1, &again), GNEISS_ERROR_UNSTABLE);
    assert_string_equal(again.message, error.message);
    assert_int_equal(gneiss_world_save(w, inside(&p, "bad.h5"), &again), GNEISS_ERROR_UNSTABLE);
    assert_int_equal(gneiss_world_checkpoint(w, &again), GNEISS_ERROR_UNSTABLE);
    assert_int_equal(count_files(p.path, "bad", false), 0);
    gneiss_world_free(w);
    w = unstable_world(NULL);
    assert_int_equal(gneiss_world_run(w, NULL), GNEISS_ERROR_UNSTABLE);
    gneiss_world_free(w);
    count_files(inside(&p, "out"), "", true);
    rmdir(inside(&p, "out"));
    remove_place(&p);
}

/* --- files --- */

static void a_saved_world_resumes_to_the_same_bits(void **state) {
    (void)state;
    place p = make_place();
    gneiss_error error = {0};
    gneiss_world *a = world_of(block, NULL, NULL), *b = NULL;
    step(a, 83);
    must(gneiss_world_save(a, inside(&p, "here.h5"), &error), &error);
    must(gneiss_world_load(inside(&p, "here.h5"), NULL, 0, &b, &error), &error);
    assert_int_equal(gneiss_world_hash(a), gneiss_world_hash(b));
    assert_int_equal(gneiss_world_steps(b), 83);
    must(gneiss_world_run(a, &error), &error);
    must(gneiss_world_run(b, &error), &error);
    assert_int_equal(gneiss_world_hash(a), gneiss_world_hash(b));
    assert_int_equal(counts_of(a).history_rows, counts_of(b).history_rows);
    assert_true(energy(a, "friction") == energy(b, "friction"));
    assert_int_equal(count_files(p.path, "", false),
                     1); /* the run made no folder and no other file */
    gneiss_world_free(a);
    gneiss_world_free(b);
    remove_place(&p);
}

static void a_loaded_world_takes_a_later_end(void **state) {
    (void)state;
    place p = make_place();
    gneiss_error error = {0};
    gneiss_world *a = world_of(block, NULL, NULL), *b = NULL;
    must(gneiss_world_run(a, &error), &error);
    must(gneiss_world_save(a, inside(&p, "end.h5"), &error), &error);
    const char *later[] = {"time.end=0.22 ms"}, *other[] = {"materials.rock.friction=0"};
    must(gneiss_world_load(inside(&p, "end.h5"), later, 1, &b, &error), &error);
    must(gneiss_world_run(b, &error), &error);
    assert_true(gneiss_world_time(b) > 0.21e-3);
    gneiss_world_free(b);
    assert_int_equal(gneiss_world_load(inside(&p, "end.h5"), other, 1, &b, &error),
                     GNEISS_ERROR_INPUT);
    assert_null(b);
    gneiss_world_free(a);
    remove_place(&p);
}

static void a_file_that_is_no_checkpoint_is_refused(void **state) {
    (void)state;
    place p = make_place();
    gneiss_error error = {0};
    gneiss_world *w = NULL;
    FILE *file = fopen(inside(&p, "text.h5"), "w");
    fputs("not a checkpoint\n", file);
    fclose(file);
    assert_int_equal(gneiss_world_load(inside(&p, "text.h5"), NULL, 0, &w, &error),
                     GNEISS_ERROR_INPUT);
    assert_message(&error, GNEISS_ERROR_INPUT, "text.h5");
    assert_int_equal(gneiss_world_load(inside(&p, "none.h5"), NULL, 0, &w, &error),
                     GNEISS_ERROR_IO);
    assert_int_equal(gneiss_world_resume(p.path, NULL, 0, &w, &error), GNEISS_ERROR_INPUT);
    assert_null(w);
    remove_place(&p);
}

static void a_run_in_a_folder_leaves_its_files(void **state) {
    (void)state;
    place p = make_place();
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, p.path);
    must(gneiss_world_run(w, &error), &error);
    gneiss_world_free(w);
    assert_int_equal(count_files(p.path, "results.h5", false), 1);
    assert_int_equal(count_files(p.path, "summary.json", false), 1);
    assert_int_equal(count_files(p.path, "checkpoint_", false), 1);
    assert_int_equal(count_files(p.path, "particles.hdf.series", false), 1);
    remove_place(&p);
}

static void a_run_resumes_in_its_folder(void **state) {
    (void)state;
    place p = make_place();
    gneiss_error error = {0};
    gneiss_world *whole = world_of(block, NULL, NULL), *w = world_of(block, NULL, p.path);
    must(gneiss_world_run(whole, &error), &error);
    step(w, 50);
    must(gneiss_world_checkpoint(w, &error), &error);
    step(w, 3); /* lost with the world */
    gneiss_world_free(w);
    must(gneiss_world_resume(p.path, NULL, 0, &w, &error), &error);
    assert_int_equal(gneiss_world_steps(w), 50);
    assert_string_equal(gneiss_world_note(w), "");
    must(gneiss_world_run(w, &error), &error);
    assert_int_equal(gneiss_world_hash(w), gneiss_world_hash(whole));
    gneiss_world_free(w);
    gneiss_world_free(whole);
    remove_place(&p);
}

static void a_folder_belongs_to_one_world_at_a_time(void **state) {
    (void)state;
    place p = make_place();
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *a = world_of(block, NULL, p.path), *b = NULL;
    must(gneiss_scene_parse(block, "block.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_int_equal(gneiss_world_create(scene, p.path, &b, &error), GNEISS_ERROR_INPUT);
    assert_null(b);
    gneiss_world_free(a);
    must(gneiss_world_create(scene, p.path, &b, &error), &error);
    gneiss_world_free(b);
    gneiss_scene_free(scene);
    remove_place(&p);
}

static void a_folder_that_cannot_be_made_is_a_file_error(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *w = NULL;
    must(gneiss_scene_parse(block, NULL, NULL, NULL, 0, &scene, &error), &error);
    assert_int_equal(gneiss_world_create(scene, "/dev/null/out", &w, &error), GNEISS_ERROR_IO);
    assert_message(&error, GNEISS_ERROR_IO, "/dev/null");
    assert_null(w);
    must(gneiss_world_create(scene, NULL, &w, &error), &error);
    assert_int_equal(gneiss_world_save(w, "/dev/null/x.h5", &error), GNEISS_ERROR_IO);
    step(w, 1); /* the error has no further effect */
    gneiss_world_free(w);
    gneiss_scene_free(scene);
}

static void the_library_says_what_it_is(void **state) {
    (void)state;
    int major = -1, minor = -1;
    assert_int_equal(sscanf(gneiss_version(), "%d.%d", &major, &minor), 2);
    assert_true(strlen(gneiss_build()) > 0);
    assert_string_equal(gneiss_status_name(GNEISS_OK), "ok");
    assert_string_equal(gneiss_status_name((gneiss_status)99), "unknown status");
    assert_string_equal(gneiss_record_name(GNEISS_WALL_CONTACTS), "wall_contacts");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_load_from_a_file_with_overrides),
        cmocka_unit_test(scene_errors_say_where),
        cmocka_unit_test(geometries_are_not_given_to_gmsh_unless_that_is_allowed),
        cmocka_unit_test(empty_overrides_are_refused),
        cmocka_unit_test(null_scenes_and_makers_are_refused),
        cmocka_unit_test(null_worlds_are_refused),
        cmocka_unit_test(null_results_and_names_are_refused),
        cmocka_unit_test(unknown_names_and_indices_are_refused),
        cmocka_unit_test(paths_that_are_too_long_are_refused),
        cmocka_unit_test(null_is_nothing_to_free_and_counts_nothing),
        cmocka_unit_test(the_error_may_be_null),
        cmocka_unit_test(success_leaves_the_error_as_it_was),
        cmocka_unit_test(particle_views_show_the_specimen),
        cmocka_unit_test(contact_views_lead_to_particles),
        cmocka_unit_test(column_views_stride_by_component),
        cmocka_unit_test(every_field_is_found_by_index_and_by_name),
        cmocka_unit_test(a_scene_has_only_the_fields_it_needs),
        cmocka_unit_test(nodes_and_elements_have_fields),
        cmocka_unit_test(elements_that_convert_are_counted),
        cmocka_unit_test(zones_have_elements_and_a_reading),
        cmocka_unit_test(outputs_are_those_of_the_files),
        cmocka_unit_test(unknown_outputs_are_refused),
        cmocka_unit_test(views_show_positions_from_the_origin),
        cmocka_unit_test(counts_follow_the_views),
        cmocka_unit_test(the_history_has_a_row_every_interval),
        cmocka_unit_test(readings_are_those_of_the_closed_form),
        cmocka_unit_test(readings_without_a_test_are_nan),
        cmocka_unit_test(energies_balance),
        cmocka_unit_test(energies_without_a_ledger_are_nan),
        cmocka_unit_test(the_step_is_a_share_of_the_limit),
        cmocka_unit_test(step_takes_exactly_as_many_also_past_the_end),
        cmocka_unit_test(calls_in_any_order_leave_the_world_as_it_is),
        cmocka_unit_test(slices_of_wall_time_come_to_the_same_end),
        cmocka_unit_test(two_worlds_advanced_in_turns_do_not_affect_each_other),
        cmocka_unit_test(two_worlds_in_two_threads_give_the_same_bits),
        cmocka_unit_test(a_failed_run_can_only_be_read),
        cmocka_unit_test(a_saved_world_resumes_to_the_same_bits),
        cmocka_unit_test(a_loaded_world_takes_a_later_end),
        cmocka_unit_test(a_file_that_is_no_checkpoint_is_refused),
        cmocka_unit_test(a_run_in_a_folder_leaves_its_files),
        cmocka_unit_test(a_run_resumes_in_its_folder),
        cmocka_unit_test(a_folder_belongs_to_one_world_at_a_time),
        cmocka_unit_test(a_folder_that_cannot_be_made_is_a_file_error),
        cmocka_unit_test(the_library_says_what_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
