/* Intervention in a run through the public API: calls, fields of force, velocities, motions, pinned
 * views, prepared specimens. The program uses only the public headers and the shared library. */
#include "api_helpers.h"

#include <stdbool.h>
#include <unistd.h>

/* Two distant spheres without any restraint. */
static const char pair[] = "specimen:\n"
                           "  material: a\n"
                           "  particles: [[0, 0, 0, 1 mm], [9 mm, 0, 0, 1 mm]]\n"
                           "materials:\n"
                           "  - {name: a, density: 2000, normal_stiffness: 1 MN/m, kratio: 2}\n"
                           "  - {name: b, density: 4000, normal_stiffness: 1 MN/m, kratio: 2}\n"
                           "law: {stiffness: uniform}\n"
                           "gravity: [0, 0, -10]\n"
                           "time: {end: 10 ms}\n"
                           "output: {history_rows: 100}\n"
                           "run: {threads: 1}\n";

/* A bonded block between a wall that closes on it and a held foot. */
static const char block[] =
    "specimen:\n"
    "  group: 1\n"
    "  lattice: {kind: cubic, radius: 1 mm, cells: [4, 4, 4], jitter: 0.1}\n"
    "materials:\n"
    "  - {name: rock, density: 2000, normal_stiffness: 1 MN/m, kratio: 2, friction: 0.4,\n"
    "     bond_tension_limit: 60 N, bond_shear_limit: 60 N}\n"
    "law: {stiffness: uniform}\n"
    "bonds: {interaction_range: 0.05}\n"
    "sets:\n"
    "  - name: foot\n"
    "    select: {end: {axis: z, side: lower, depth: 1.5 mm, by: surface}}\n"
    "    motion: {vx: 0, vy: 0, vz: 0}\n"
    "walls:\n"
    "  - {name: top, point: [0, 0, 8.1 mm], normal: [0, 0, -1],\n"
    "     stiffness: 1 MN/m, motion: {vz: -1 m/s}}\n"
    "time: {end: 0.4 ms}\n"
    "output: {history_rows: 50}\n"
    "run: {threads: 1}\n";

/* |a - b| <= allowed; prints both when not. */
#define assert_near(a, b, allowed)                                                                 \
    do {                                                                                           \
        double gn_a = (a), gn_b = (b);                                                             \
        if (!(fabs(gn_a - gn_b) <= (allowed)))                                                     \
            fail_msg("%s = %.17g, expected %.17g within %g", #a, gn_a, gn_b, (double)(allowed));   \
    } while (0)

static void refused(gneiss_status status, const gneiss_error *error, const char *part) {
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    assert_message(error, GNEISS_ERROR_INPUT, part);
}

static gneiss_world *world_of(const char *text, gneiss_prepare *prepare, void *context) {
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *world = NULL;
    must(gneiss_scene_parse(text, "t.yaml", NULL, NULL, 0, &scene, &error), &error);
    gneiss_scene_prepare(scene, prepare, context);
    must(gneiss_world_create(scene, NULL, &world, &error), &error);
    gneiss_scene_free(scene);
    return world;
}

static double energy(const gneiss_world *world, const char *name) {
    gneiss_quantity q;
    gneiss_error error = {0};
    must(gneiss_world_energy(world, name, &q, &error), &error);
    return q.value;
}

static const double *rows_of(const gneiss_world *world, const char *name, size_t *count) {
    gneiss_view view;
    gneiss_error error = {0};
    must(gneiss_world_field(world, GNEISS_PARTICLES, name, &view, &error), &error);
    if (count) *count = view.count;
    return view.data;
}

/* Returns the path of a file of this process. */
static const char *temporary(void) {
    static char path[64];
    snprintf(path, sizeof path, "/tmp/gneiss-hooks-%d.h5", (int)getpid());
    return path;
}

static double step_of(const gneiss_world *world) {
    gneiss_limits limits;
    must(gneiss_world_limits(world, &limits, NULL), &(gneiss_error){0});
    return limits.dt;
}

/* --- keys --- */

static void keys_are_listed_with_their_values(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_key key;
    size_t count = 0, required = 0;
    bool friction = false, walls = false;
    while (gneiss_key_at(count, &key, &error) == GNEISS_OK) {
        assert_true(key.path[0] && key.value[0] && key.text[0] && key.kind[0]);
        if (strcmp(key.path, "materials[].friction") == 0)
            friction = strcmp(key.kind, "number") == 0 && strcmp(key.fallback, "0") == 0;
        if (strcmp(key.path, "walls") == 0) walls = strcmp(key.kind, "list") == 0;
        required += key.required == 1;
        count++;
    }
    assert_true(count > 200 && required > 20 && friction && walls);
    refused(gneiss_key_at(count, &key, &error), &error, "index");
    refused(gneiss_key_at(0, NULL, &error), &error, "key");
}

/* --- views --- */

static void a_pinned_view_keeps_its_values_when_the_world_is_gone(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, NULL);
    gneiss_view view, none = {0};
    must(gneiss_world_field(w, GNEISS_PARTICLES, "pos", &view, &error), &error);
    must(gneiss_view_pin(&view, &error), &error);
    must(gneiss_view_pin(&view, &error), &error);
    gneiss_view_unpin(view.data);
    const double radius = gneiss_view_value(&view, 3, 3);
    gneiss_world_free(w);
    gneiss_world_free(world_of(block, NULL, NULL)); /* takes the next free block of memory */
    assert_true(gneiss_view_value(&view, 3, 3) == radius);
    gneiss_view_unpin(view.data);
    refused(gneiss_view_pin(&none, &error), &error, "view->data");
    refused(gneiss_view_pin(NULL, &error), &error, "view");
}

/* --- calls --- */

typedef struct diary {
    int64_t calls, last, stop_at;
    gneiss_status advanced;
    const char *path; /* path of the file to save to; NULL: none */
} diary;

static int note(void *context, gneiss_world *world) {
    diary *d = context;
    gneiss_error error = {0};
    d->calls++;
    d->last = gneiss_world_steps(world);
    d->advanced = gneiss_world_step(world, 1, &error);
    if (d->path) must(gneiss_world_save(world, d->path, &error), &error);
    return d->last == d->stop_at;
}

static void calls_come_between_steps_and_can_stop_the_advance(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, NULL), *plain = world_of(block, NULL, NULL);
    int64_t hook, timed;
    diary every = {.stop_at = 20}, at = {.stop_at = -1};
    must(gneiss_world_add_call(w, 5, NULL, 0, note, &every, &hook, &error), &error);
    const double dt = step_of(w), times[] = {2.4 * dt, 11.0 * dt, 11.6 * dt};
    must(gneiss_world_add_call(w, 0, times, 3, note, &at, &timed, &error), &error);
    assert_int_equal(gneiss_world_step(w, 50, &error), GNEISS_INTERRUPTED);
    assert_int_equal(gneiss_world_steps(w), 20);
    assert_int_equal(every.calls, 4);
    assert_int_equal(every.advanced,
                     GNEISS_ERROR_INPUT); /* a world cannot be advanced inside a call */
    assert_int_equal(at.calls, 3);
    assert_int_equal(at.last, 12); /* the step that ends nearest to 11.6 steps */
    must(gneiss_world_step(w, 30, &error), &error);
    assert_int_equal(every.calls, 10);
    must(gneiss_world_remove_hook(w, hook, &error), &error);
    refused(gneiss_world_remove_hook(w, hook, &error), &error, "hook");
    must(gneiss_world_step(w, 10, &error), &error);
    assert_int_equal(every.calls, 10);
    must(gneiss_world_step(plain, 60, &error), &error);
    assert_int_equal(gneiss_world_hash(w), gneiss_world_hash(plain)); /* every bit is equal */
    gneiss_world_free(w);
    gneiss_world_free(plain);
}

static void a_world_that_a_call_saved_goes_on_with_the_same_bits(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, NULL), *loaded = NULL;
    int64_t hook;
    diary d = {.stop_at = -1, .path = temporary()};
    must(gneiss_world_add_call(w, 40, NULL, 0, note, &d, &hook, &error), &error);
    must(gneiss_world_step(w, 60, &error), &error);
    must(gneiss_world_load(d.path, NULL, 0, &loaded, &error), &error);
    unlink(d.path);
    assert_int_equal(gneiss_world_steps(loaded), 40);
    must(gneiss_world_step(loaded, 20, &error), &error);
    assert_int_equal(gneiss_world_hash(w), gneiss_world_hash(loaded));
    gneiss_view a, b;
    must(gneiss_world_history(w, "time", &a, &error), &error);
    must(gneiss_world_history(loaded, "time", &b, &error), &error);
    assert_int_equal(a.count, b.count);
    gneiss_world_free(w);
    gneiss_world_free(loaded);
}

static void bad_calls_are_refused(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(pair, NULL, NULL);
    int64_t hook = 7;
    const double falling[] = {2.0, 1.0};
    refused(gneiss_world_add_call(w, -1, NULL, 0, note, NULL, &hook, &error), &error, "every");
    refused(gneiss_world_add_call(w, 0, falling, 2, note, NULL, &hook, &error), &error, "rise");
    refused(gneiss_world_add_call(w, 1, NULL, 0, NULL, NULL, &hook, &error), &error, "call");
    refused(gneiss_world_add_call(NULL, 1, NULL, 0, note, NULL, &hook, &error), &error, "world");
    assert_int_equal(hook, 7);
    gneiss_world_free(w);
}

/* --- fields of force --- */

typedef struct spring {
    double stiffness, centre[3];
    int first; /* coordinate from which on it acts */
    int result;
    double wrong; /* added to the force */
} spring;

static int pull(void *context, const gneiss_points *points) {
    const spring *s = context;
    for (size_t p = 0; p < points->count; p++)
        for (int a = s->first; a < 3; a++)
            points->force[3 * p + a] =
                -s->stiffness * (points->position[4 * p + a] - s->centre[a]) + s->wrong;
    return s->result;
}

/* Leap-frog conserves 1/2 m v(-) v(+) and the energy of a linear spring exactly, whatever the step:
 * the ledger closes to rounding. Its path is a cosine up to (w dt)^2/24 of its phase. */
static void a_spring_swings_as_its_closed_form_and_the_ledger_closes(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(pair, NULL, NULL);
    spring s = {50.0, {4.5e-3, 20e-3, 3e-3}, 0, 0, 0.0};
    int64_t hook;
    must(gneiss_world_add_force(w, GNEISS_PARTICLES, s.stiffness, pull, &s, &hook, &error), &error);
    must(gneiss_world_step(w, 1, &error), &error);
    const double mass = 1.0 / rows_of(w, "vel", NULL)[3], rate = sqrt(s.stiffness / mass);
    must(gneiss_world_step(w, (int64_t)(1.2 / (rate * step_of(w))), &error), &error);
    const double *x = rows_of(w, "pos", NULL);
    const double t = gneiss_world_time(w); /* the particles touch at acos(2/9) = 1.35 */
    const double phase = rate * t * (1.0 + rate * rate * step_of(w) * step_of(w) / 24.0);
    const double sag = 10.0 * mass / s.stiffness;
    assert_true(rate * t > 1.0);
    assert_near(x[1], s.centre[1] * (1.0 - cos(phase)), 1e-9 * s.centre[1]);
    assert_near(x[2], (s.centre[2] - sag) * (1.0 - cos(phase)), 1e-9 * s.centre[2]);
    assert_true(fabs(energy(w, "work_user")) > 1e-6);
    assert_near(energy(w, "residual"), 0.0, 1e-12);
    gneiss_world_free(w);
}

/* The field has a stiffness that determines the step: w dt = 2 safety/sqrt(2 safety^2 + ...)
 * remains below 2. */
static void a_stiff_field_lowers_the_step(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(pair, NULL, NULL);
    const double before = step_of(w);
    spring s = {1e9, {0, 0, 1e-6}, 2, 0, 0.0};
    int64_t hook;
    must(gneiss_world_add_force(w, GNEISS_PARTICLES, s.stiffness, pull, &s, &hook, &error), &error);
    must(gneiss_world_step(w, 3000, &error), &error);
    const double *v = rows_of(w, "vel", NULL);
    const double turn = step_of(w) * sqrt(s.stiffness * v[3]);
    assert_true(step_of(w) < 0.5 * before);
    assert_true(turn < 2.0 && turn > 0.2);
    assert_near(energy(w, "residual"), 0.0, 1e-9);
    assert_true(fabs(rows_of(w, "pos", NULL)[2]) < 1e-4);
    gneiss_world_free(w);
}

static void fields_act_beside_contacts_walls_and_motions(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, NULL);
    spring s = {400.0, {20e-3, 4e-3, 4e-3}, 0, 0, 0.0};
    int64_t first, second;
    must(gneiss_world_add_force(w, GNEISS_PARTICLES, s.stiffness, pull, &s, &first, &error),
         &error);
    must(gneiss_world_add_force(w, GNEISS_PARTICLES, s.stiffness, pull, &s, &second, &error),
         &error);
    must(gneiss_world_step(w, 200, &error), &error);
    must(gneiss_world_remove_hook(w, second, &error), &error);
    must(gneiss_world_run(w, &error), &error);
    assert_true(fabs(energy(w, "work_user")) > 0.01 * energy(w, "work_walls"));
    /* The bound is the same as without a field: contacts and breaks are not linear. */
    assert_near(energy(w, "residual"), 0.0, 2e-3);
    gneiss_world_free(w);
}

/* A clamped block of elements oscillates on springs to a plane beside it. The ledger closes to
 * second order of the step, as it does for elements with a nonlinear law. */
static void fields_act_on_nodes_of_elements(void **state) {
    (void)state;
    static const char elastic[] =
        "elements:\n"
        "  box: {size: [1 cm, 1 cm, 3 cm], cells: [3, 3, 9]}\n"
        "  materials: [{young: 1 GPa, poisson: 0.2, density: 2000}]\n"
        "  motions: [{name: foot, box: {min: [-1, -1, -1], max: [1, 1, 1 mm]},\n"
        "             motion: {vx: 0, vy: 0, vz: 0}}]\n"
        "time: {end: 1 ms}\n"
        "output: {history_rows: 200}\n"
        "run: {threads: 1}\n";
    gneiss_error error = {0};
    gneiss_world *w = world_of(elastic, NULL, NULL);
    spring s = {2e3, {2e-2, 5e-3, 1.5e-2}, 0, 0, 0.0};
    int64_t hook;
    refused(gneiss_world_add_force(w, GNEISS_PARTICLES, 0.0, pull, &s, &hook, &error), &error,
            "particles");
    must(gneiss_world_add_force(w, GNEISS_NODES, s.stiffness, pull, &s, &hook, &error), &error);
    must(gneiss_world_run(w, &error), &error);
    assert_true(energy(w, "work_user") > 1e-4);
    assert_close(energy(w, "work_user"), energy(w, "kinetic") + energy(w, "elastic_elements"),
                 1e-3);
    assert_near(energy(w, "residual"), 0.0, 1e-4);
    gneiss_world_free(w);
}

static void a_field_that_fails_ends_the_world(void **state) {
    (void)state;
    gneiss_error error = {0};
    for (int kind = 0; kind < 2; kind++) {
        gneiss_world *w = world_of(pair, NULL, NULL);
        spring s = {1.0, {0, 0, 0}, 0, kind == 0, kind == 0 ? 0.0 : (double)NAN};
        int64_t hook;
        must(gneiss_world_add_force(w, GNEISS_PARTICLES, 0.0, pull, &s, &hook, &error), &error);
        refused(gneiss_world_step(w, 1, &error), &error, kind ? "particle 0" : "failed");
        s = (spring){0};
        refused(gneiss_world_step(w, 1, &error), &error, "field of force");
        gneiss_world_free(w);
    }
}

typedef struct meddler {
    gneiss_world *world;
    int64_t hook;
    gneiss_status found[5];
} meddler;

static int meddle(void *context, const gneiss_points *points) {
    meddler *m = context;
    gneiss_error error = {0};
    int64_t other;
    m->found[0] = gneiss_world_step(m->world, 1, &error);
    m->found[1] = gneiss_world_remove_hook(m->world, m->hook, &error);
    m->found[2] = gneiss_world_add_call(m->world, 1, NULL, 0, note, NULL, &other, &error);
    m->found[3] = gneiss_world_set_velocities(m->world, points->force, NULL, points->count, &error);
    m->found[4] = gneiss_world_save(m->world, temporary(), &error);
    return 0;
}

static void a_field_may_only_read(void **state) {
    (void)state;
    gneiss_error error = {0};
    meddler m = {.world = world_of(pair, NULL, NULL)};
    must(gneiss_world_add_force(m.world, GNEISS_PARTICLES, 0.0, meddle, &m, &m.hook, &error),
         &error);
    must(gneiss_world_step(m.world, 3, &error), &error);
    for (int k = 0; k < 5; k++) assert_int_equal(m.found[k], GNEISS_ERROR_INPUT);
    must(gneiss_world_remove_hook(m.world, m.hook, &error), &error);
    gneiss_world_free(m.world);
}

static void bad_fields_are_refused(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(pair, NULL, NULL), *given;
    spring s = {0};
    int64_t hook;
    refused(gneiss_world_add_force(w, GNEISS_BONDS, 0.0, pull, &s, &hook, &error), &error,
            "record");
    refused(gneiss_world_add_force(w, GNEISS_NODES, 0.0, pull, &s, &hook, &error), &error, "nodes");
    refused(gneiss_world_add_force(w, GNEISS_PARTICLES, -1.0, pull, &s, &hook, &error), &error,
            "stiffness");
    refused(gneiss_world_add_force(w, GNEISS_PARTICLES, 0.0, NULL, &s, &hook, &error), &error,
            "force");
    gneiss_world_free(w);
    char text[2048];
    snprintf(text, sizeof text, "%.*s%s", (int)(strstr(pair, "time:") - pair), pair,
             "time: {end: 1 ms, step: 1 us}\nrun: {threads: 1}\n");
    given = world_of(text, NULL, NULL);
    refused(gneiss_world_add_force(given, GNEISS_PARTICLES, 1e9, pull, &s, &hook, &error), &error,
            "time.step");
    must(gneiss_world_add_force(given, GNEISS_PARTICLES, 1.0, pull, &s, &hook, &error), &error);
    gneiss_world_free(given);
}

/* --- velocities and motions --- */

static void velocities_that_are_set_move_particles_and_are_booked(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(pair, NULL, NULL);
    double velocity[6] = {1.0, 0, 0, -1.0, 2.0, 0}, bad[6] = {0, 0, NAN, 0, 0, 0};
    must(gneiss_world_step(w, 10, &error), &error);
    const double *v = rows_of(w, "vel", NULL), mass = 1.0 / v[3];
    const double before = 0.5 * mass * 2.0 * v[2] * v[2], x = rows_of(w, "pos", NULL)[0];
    must(gneiss_world_set_velocities(w, velocity, NULL, 2, &error), &error);
    must(gneiss_world_step(w, 2000, &error), &error);
    assert_near(rows_of(w, "pos", NULL)[0] - x, 2000.0 * step_of(w), 1e-12);
    assert_close(energy(w, "work_user"), 0.5 * mass * (1.0 + 5.0) - before, 1e-9);
    assert_near(energy(w, "residual"), 0.0, 1e-5); /* gravity in a step: g dt v beside v^2/2 */
    refused(gneiss_world_set_velocities(w, velocity, NULL, 3, &error), &error, "count");
    refused(gneiss_world_set_velocities(w, bad, NULL, 2, &error), &error, "row 0");
    gneiss_world_free(w);
}

/* The velocities are so large that a step would carry particles beyond lists made for slow ones. */
static void a_fast_particle_meets_what_was_not_listed(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(pair, NULL, NULL);
    double velocity[6] = {0, 0, 0, -60.0, 0, 0};
    must(gneiss_world_step(w, 10, &error), &error);
    must(gneiss_world_set_velocities(w, velocity, NULL, 2, &error), &error);
    must(gneiss_world_step(w, 400, &error), &error);
    const double *v = rows_of(w, "vel", NULL);
    assert_near(v[0], -60.0, 0.6); /* equal masses exchange their velocities */
    assert_near(v[4], 0.0, 0.6);
    gneiss_world_free(w);
}

static void prescribed_particles_keep_their_velocities(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, NULL);
    size_t count, moved = 0;
    must(gneiss_world_step(w, 10, &error), &error);
    rows_of(w, "vel", &count);
    double *velocity = calloc(3 * count, sizeof *velocity);
    for (size_t k = 0; k < 3 * count; k++) velocity[k] = 0.25;
    must(gneiss_world_set_velocities(w, velocity, NULL, count, &error), &error);
    const double *v = rows_of(w, "vel", NULL);
    for (size_t k = 0; k < count; k++) moved += v[4 * k] == 0.25;
    assert_int_equal(moved, count - 16); /* the foot is the lowest of four layers */
    free(velocity);
    gneiss_world_free(w);
}

static void a_motion_that_is_set_is_part_of_a_saved_world(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_world *w = world_of(block, NULL, NULL), *loaded = NULL;
    must(gneiss_world_step(w, 50, &error), &error);
    must(gneiss_world_set_motion(w, "top", 2, 0.5, &error), &error);
    must(gneiss_world_set_motion(w, "foot", 2, 0.25, &error), &error);
    const char *path = temporary();
    must(gneiss_world_save(w, path, &error), &error);
    must(gneiss_world_load(path, NULL, 0, &loaded, &error), &error);
    unlink(path);
    must(gneiss_world_step(w, 100, &error), &error);
    must(gneiss_world_step(loaded, 100, &error), &error);
    assert_int_equal(gneiss_world_hash(w), gneiss_world_hash(loaded));
    gneiss_view height;
    must(gneiss_world_history(w, "wall_top_displacement_z", &height, &error), &error);
    /* 50 steps down, 100 up at half the speed; the last row is some steps before the end. */
    assert_near(((const double *)height.data)[height.count - 1], 0.0, 6.0 * step_of(w));
    assert_near(energy(w, "residual"), 0.0, 1e-3);
    refused(gneiss_world_set_motion(w, "top", 0, 1.0, &error), &error, "vx free");
    refused(gneiss_world_set_motion(w, "side", 0, 1.0, &error), &error, "'side'");
    refused(gneiss_world_set_motion(w, "top", 6, 1.0, &error), &error, "[0, 5]");
    refused(gneiss_world_set_motion(w, "top", 2, 1e5, &error), &error, "twentieth");
    gneiss_world_free(w);
    gneiss_world_free(loaded);
}

/* --- stages --- */

static void a_stage_ends_when_a_program_asks_for_it(void **state) {
    (void)state;
    char text[2048];
    gneiss_error error = {0};
    gneiss_progress progress;
    snprintf(text, sizeof text, "%s%s", pair,
             "stages:\n"
             "  - {name: fall, end: {time: 1 ms}}\n"
             "  - {name: rise, gravity: [0, 0, 10]}\n");
    gneiss_world *w = world_of(text, NULL, NULL), *none = world_of(pair, NULL, NULL);
    must(gneiss_world_step(w, 100, &error), &error);
    must(gneiss_world_progress(w, &progress, &error), &error);
    assert_true(progress.stages == 2 && progress.stage == 0);
    assert_string_equal(progress.stage_name, "fall");
    const double down = rows_of(w, "vel", NULL)[2];
    must(gneiss_world_end_stage(w, &error), &error);
    must(gneiss_world_step(w, 100, &error), &error);
    must(gneiss_world_progress(w, &progress, &error), &error);
    assert_string_equal(progress.stage_name, "rise");
    assert_true(down < 0.0);
    assert_near(rows_of(w, "vel", NULL)[2], 10.0 * 0.5 * step_of(w), 1e-3 * fabs(down));
    must(gneiss_world_end_stage(w, &error), &error);
    must(gneiss_world_progress(w, &progress, &error), &error);
    assert_int_equal(progress.finished, 1);
    assert_non_null(strstr(progress.stop_reason, "a program ended it"));
    refused(gneiss_world_end_stage(none, &error), &error, "stages");
    gneiss_world_free(w);
    gneiss_world_free(none);
}

/* --- specimens --- */

static int double_first(void *context, gneiss_specimen *specimen) {
    specimen->position[3] *= 2.0;
    specimen->material[1] = 1;
    return *(const int *)context;
}

static void prepared_particles_have_the_masses_of_their_radii_and_materials(void **state) {
    (void)state;
    int result = 0;
    gneiss_world *w = world_of(pair, double_first, &result);
    const double *v = rows_of(w, "vel", NULL), ball = 4.0 / 3.0 * 3.14159265358979323846 * 1e-9;
    assert_close(1.0 / v[3], 8.0 * 2000.0 * ball, 1e-12);
    assert_close(1.0 / v[7], 4000.0 * ball, 1e-12);
    gneiss_world_free(w);
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    must(gneiss_scene_parse(pair, "t.yaml", NULL, NULL, 0, &scene, &error), &error);
    result = 1;
    gneiss_scene_prepare(scene, double_first, &result);
    refused(gneiss_world_create(scene, NULL, &w, &error), &error, "refused");
    assert_null(w);
    gneiss_scene_free(scene);
}

static int break_one(void *context, gneiss_specimen *specimen) {
    switch (*(const int *)context) {
    case 0:
        specimen->position[3] = -1.0;
        break;
    case 1:
        specimen->position[0] = NAN;
        break;
    case 2:
        specimen->material[0] = 2;
        break;
    default:
        specimen->group[0] = -1;
    }
    return 0;
}

static void badly_prepared_particles_are_refused(void **state) {
    (void)state;
    gneiss_error error = {0};
    gneiss_scene *scene = NULL;
    gneiss_world *w;
    must(gneiss_scene_parse(pair, "t.yaml", NULL, NULL, 0, &scene, &error), &error);
    for (int kind = 0; kind < 4; kind++) {
        gneiss_scene_prepare(scene, break_one, &kind);
        refused(gneiss_world_create(scene, NULL, &w, &error), &error, "particle 0");
        assert_non_null(strstr(error.message, "t.yaml:1:1"));
    }
    gneiss_scene_free(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_listed_with_their_values),
        cmocka_unit_test(a_pinned_view_keeps_its_values_when_the_world_is_gone),
        cmocka_unit_test(calls_come_between_steps_and_can_stop_the_advance),
        cmocka_unit_test(a_world_that_a_call_saved_goes_on_with_the_same_bits),
        cmocka_unit_test(bad_calls_are_refused),
        cmocka_unit_test(a_spring_swings_as_its_closed_form_and_the_ledger_closes),
        cmocka_unit_test(a_stiff_field_lowers_the_step),
        cmocka_unit_test(fields_act_beside_contacts_walls_and_motions),
        cmocka_unit_test(fields_act_on_nodes_of_elements),
        cmocka_unit_test(a_field_that_fails_ends_the_world),
        cmocka_unit_test(a_field_may_only_read),
        cmocka_unit_test(bad_fields_are_refused),
        cmocka_unit_test(velocities_that_are_set_move_particles_and_are_booked),
        cmocka_unit_test(a_fast_particle_meets_what_was_not_listed),
        cmocka_unit_test(prescribed_particles_keep_their_velocities),
        cmocka_unit_test(a_motion_that_is_set_is_part_of_a_saved_world),
        cmocka_unit_test(a_stage_ends_when_a_program_asks_for_it),
        cmocka_unit_test(prepared_particles_have_the_masses_of_their_radii_and_materials),
        cmocka_unit_test(badly_prepared_particles_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
