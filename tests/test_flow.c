/* Sources, sinks, planes that count, and particles that were lost. */
#include "inflow/sources.h"
#include "world_helpers.h"

#include "particles/particles.h"
#include "particles/sets.h"
#include "run/run.h"

#include <unistd.h>

static void ok(gneiss_status status, const gneiss_error *error) {
    if (status != GNEISS_OK) fail_msg("%s", error->message);
}

/* Grains of glass with a reduced stiffness; a distant floor. */
#define GRAINS                                                                                     \
    "materials: [{name: m, density: 2500, young: 10 MPa, poisson: 0.25, friction: 0.5, "           \
    "rolling_friction: 0.1, restitution: 0.5}]\nlaw: {stiffness: hertz}\n"
#define DOMAIN "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
/* Free grains in a domain; a scene that never ends by itself, on one thread. */
#define LOOSE   "dimension: 3\n" GRAINS DOMAIN
#define ENDLESS "time: {end: 1}\nrun: {threads: 1}\n"

static void no_two_touch(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    for (size_t i = 0; i < q->soa.count; i++)
        for (size_t j = 0; j < i; j++) {
            double d[3], gap = sqrt(gn_branch(&w->ctx, q->pos + 4 * i, q->pos + 4 * j, d)) -
                               q->pos[4 * i + 3] - q->pos[4 * j + 3];
            bool there = q->vel[4 * i + 3] > 0.0 && q->vel[4 * j + 3] > 0.0;
            if (there && gap < 0.0) fail_msg("%zu and %zu overlap by %g", i, j, -gap);
        }
}

/* --- sources --- */

/* The first particle enters at the start, one more every millisecond. All have the same velocity,
 * so that none may ever touch another. */
static void a_source_keeps_its_rate_and_nothing_overlaps(void **state) {
    (void)state;
    gn_world *w = world_of(
        LOOSE "sources: [{name: s, box: {size: [0.02, 0.02, 0.02]}, rate: 1000, mean_radius: 1 mm, "
              "velocity: [0, 0, -2]}]\n" ENDLESS);
    for (double t = 0.01; t < 0.155; t += 0.03) {
        run_until(w, t);
        /* Checks are 50 steps apart. */
        double due = floor(1000 * w->ctx.time) + 1, late = 1000 * 51 * w->ctx.dt;
        assert_true(w->dem.flow.sources[0].number <= due);
        assert_true(w->dem.flow.sources[0].number >= due - 1 - late);
        no_two_touch(w);
    }
    assert_true(w->dem.flow.sources[0].full == 0.0);
    assert_int_equal(gn_dem_present_count(&w->dem), (int)w->dem.flow.sources[0].number);
    world_end(w);
}

/* The mass, not the number, follows the rate, to the mass of the largest particle. */
static void a_source_keeps_its_rate_of_mass(void **state) {
    (void)state;
    gn_world *w =
        world_of(LOOSE "sources: [{name: s, box: {size: [0.05, 0.05, 0.05]}, mass_rate: 0.02, "
                       "mean_radius: 1 mm, size_ratio: 3, velocity: [0, 0, -2]}]\n" ENDLESS);
    run_until(w, 0.1);
    double late = 0.02 * 51 * w->ctx.dt;
    assert_near(w->dem.flow.sources[0].mass, 0.02 * w->ctx.time, late + sphere_mass(2500, 1.5e-3));
    world_end(w);
}

static void a_source_stops_at_its_end_and_total(void **state) {
    (void)state;
    gn_world *w = world_of(
        LOOSE
        "sources:\n"
        "  - {name: a, box: {size: [0.05, 0.05, 0.05]}, rate: 1000, mean_radius: 1 mm, end: 20 ms, "
        "velocity: [0, 0, -2]}\n"
        "  - {name: b, box: {size: [0.05, 0.05, 0.05]}, rate: 1000, mean_radius: 1 mm, total: 7, "
        "start: 5 ms, velocity: [0, 0, -2]}\n" ENDLESS);
    run_until(w, 4e-3);
    assert_true(w->dem.flow.sources[1].number == 0.0);
    run_until(w, 0.06);
    assert_in_range((int)w->dem.flow.sources[0].number, 18, 21);
    assert_true(w->dem.flow.sources[1].number == 7.0);
    assert_true(gn_flow_behind(&w->ctx, &w->dem, 1) == 0.0);
    world_end(w);
}

/* Radii are within the range, and their mean is the requested one to five standard errors. */
static void sizes_are_those_of_the_distribution(void **state) {
    (void)state;
    static const char *const sizes[] = {"size_ratio: 2", "sizes: normal, size_ratio: 2",
                                        "sizes: sieve, sieve: [[0.5, 0], [0.7, 0.4], [1, 1]]"};
    for (int k = 0; k < 3; k++) {
        gn_world *w = world_of(
            LOOSE
            "sources: [{name: s, box: {size: [0.5, 0.5, 0.5]}, origin: [-0.25, -0.25, -0.25], "
            "rate: 1e9, total: 2000, mean_radius: 1 mm, %s}]\ntime: {end: 1 us, step: 1e-7}\n"
            "run: {threads: 1}\n",
            sizes[k]);
        run_steps(w, 10);
        w->dem.verlet.last_step -= 1000; /* makes the next check due */
        run_steps(w, 151);
        const gn_particles *q = &w->dem.particles;
        double n = (double)q->soa.count, mean = 0.0, square = 0.0, least = 1.0, most = 0.0;
        for (size_t p = 0; p < q->soa.count; p++) {
            double r = q->pos[4 * p + 3];
            mean += r / n;
            square += r * r / n;
            least = fmin(least, r);
            most = fmax(most, r);
        }
        assert_true(n == 2000.0);
        assert_true(most / least <= 2.0 * (1.0 + 1e-12) && most / least > 1.8);
        assert_near(mean, 1e-3, 5.0 * sqrt((square - mean * mean) / n));
        world_end(w);
    }
}

/* A cube of 20 mm is filled by at most 38 % of spheres that are inserted one after the other. */
static void a_source_without_space_falls_behind_and_warns(void **state) {
    (void)state;
    gn_world *w = world_of(LOOSE "sources: [{name: s, box: {size: [0.02, 0.02, 0.02]}, rate: 1e6, "
                                 "mean_radius: 2 mm}]\n" ENDLESS);
    run_steps(w, 400);
    double number = w->dem.flow.sources[0].number;
    no_two_touch(w);
    assert_true(w->dem.flow.sources[0].full > 0.0);
    assert_true(number > 50.0 && number * 4.0 / 3.0 * pi * 8e-9 < 0.384 * pow(0.024, 3));
    assert_near(gn_flow_behind(&w->ctx, &w->dem, 0), w->ctx.time - number / 1e6, 1e-12);
    world_end(w);
}

static void a_run_warns_of_a_source_that_is_behind(void **state) {
    (void)state;
    gn_scene scene;
    gn_run run;
    gneiss_error error = {0};
    ok(gn_scene_parse(LOOSE "sources: [{name: s, box: {size: [4 mm, 4 mm, 4 mm]}, rate: 1e6, "
                            "mean_radius: 2 mm}]\n" ENDLESS,
                      "s.yaml", NULL, NULL, 0, &scene, &error),
       &error);
    ok(gn_run_create(&scene, &run, &error), &error);
    ok(gn_run_steps(&run, 2000, &error), &error);
    gn_warnings list;
    assert_int_equal(gn_run_warnings(&run, &list, NULL), GNEISS_OK);
    assert_int_equal(list.count, 1);
    assert_string_equal(list.warning[0].name, "source_behind");
    gn_run_free(&run);
}

/* If a wall blocks the inflow, neither a larger region nor a faster velocity makes room. */
static void a_run_warns_of_a_source_behind_a_wall(void **state) {
    (void)state;
    static const char *const sources =
        "sources: [{name: a, box: {size: [4 mm, 4 mm, 4 mm]}, rate: 1e3, total: 1, mean_radius: 1 "
        "mm}, "
        "{name: b, box: {size: [4 mm, 4 mm, 4 mm]}, origin: [0, 0, %s], rate: 1e6, "
        "mean_radius: 1 mm}]\n";
    static const char *const at[] = {"-10 mm", "10 mm"};
    static const char *const says[] = {
        "; wall 'floor' has the whole region of the source behind it",
        "; walls, bodies or particles fill its region"};
    for (int k = 0; k < 2; k++) {
        char scene_text[2048], tail[512];
        gn_scene scene;
        gn_run run;
        gn_warnings list;
        gneiss_error error = {0};
        snprintf(tail, sizeof tail, sources, at[k]);
        snprintf(scene_text, sizeof scene_text,
                 LOOSE "walls: [{name: floor, point: [0, 0, -1 mm], normal: [0, 0, 1], material: "
                       "m}]\nbodies: [{name: b, box: {size: [8 mm, 8 mm, 2 mm]}, origin: [-2 mm, "
                       "-2 mm, 11 mm], material: m}]\n%s" ENDLESS,
                 tail);
        ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
        ok(gn_run_create(&scene, &run, &error), &error);
        ok(gn_run_steps(&run, 2000, &error), &error);
        assert_int_equal(gn_run_warnings(&run, &list, NULL), GNEISS_OK);
        assert_true(list.count >= 1);
        if (!strstr(list.warning[0].text, says[k])) fail_msg("%s", list.warning[0].text);
        gn_run_free(&run);
    }
}

/* There is no room behind the plane of a wall, nor at a body's surface. */
static void nothing_comes_in_where_walls_and_bodies_are(void **state) {
    (void)state;
    gn_world *w = world_of(
        LOOSE
        "walls: [{name: w, point: [0, 0, 0.005], normal: [0, 0, 1], material: m}]\n"
        "bodies: [{name: b, box: {size: [0.01, 0.01, 0.01]}, origin: [0, 0, 0.01], material: m}]\n"
        "sources: [{name: s, box: {size: [0.02, 0.02, 0.02]}, rate: 1e6, mean_radius: 1 "
        "mm}]\n" ENDLESS);
    run_steps(w, 1600);
    const gn_particles *q = &w->dem.particles;
    assert_true(q->soa.count > 20);
    for (size_t p = 0; p < q->soa.count; p++) assert_true(q->pos[4 * p + 2] >= 0.006);
    for (size_t c = 0; c < w->boundary.contacts.soa.count; c++)
        for (int a = 0; a < 3; a++) assert_true(w->boundary.contacts.row[8 * c + (size_t)a] == 0.0);
    world_end(w);
}

/* The distance to a nearest image counts like any other. */
static void nothing_overlaps_across_a_periodic_box(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\n" GRAINS "periodic: {min: [0, 0, 0], max: [0.02, 0.02, 0.02]}\n"
                 "sources: [{name: s, box: {size: [0.02, 0.02, 0.02]}, rate: 1e6, mean_radius: 2 "
                 "mm}]\n" ENDLESS);
    run_steps(w, 1600);
    assert_true(w->dem.particles.soa.count > 40);
    no_two_touch(w);
    world_end(w);
}

static void in_the_plane_discs_come_in(void **state) {
    (void)state;
    static const char *const regions[] = {"disc: {diameter: 40 mm}",
                                          "rectangle: {width: 40 mm, height: 20 mm}",
                                          "polygon: [[0, 0], [40 mm, 0], [20 mm, 30 mm]]"};
    for (int k = 0; k < 3; k++) {
        gn_world *w =
            world_of("dimension: 2\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e5, "
                     "kratio: 2, friction: 0.5}]\nlaw: {stiffness: uniform}\n"
                     "domain: {min: [-1, -1], max: [1, 1]}\n"
                     "sources: [{name: s, %s, rate: 1e6, mean_radius: 1 mm}]\n" ENDLESS,
                     regions[k]);
        run_steps(w, 1000);
        assert_true(w->dem.particles.soa.count > 40);
        no_two_touch(w);
        for (size_t p = 0; p < w->dem.particles.soa.count; p++)
            assert_true(w->dem.particles.pos[4 * p + 2] == 0.0);
        world_end(w);
    }
}

/* --- sinks --- */

/* Without forces every particle of a source is in the box or was removed by the sink. */
static void momentum_and_energy_pass_from_source_to_sink(void **state) {
    (void)state;
    gn_world *w = world_of(
        LOOSE "sources: [{name: s, box: {size: [0.02, 0.02, 0.02]}, rate: 2000, mean_radius: 1 mm, "
              "size_ratio: 2, velocity: [0.5, 0, -2]}]\n"
              "sinks: [{name: o, plane: {point: [0, 0, -0.1], normal: [0, 0, -3]}}]\n" ENDLESS);
    measured_step(w);
    run_until(w, 0.2);
    gn_energy e = measured_step(w);
    const gn_source_state *s = &w->dem.flow.sources[0];
    const gn_sink_state *o = &w->dem.flow.sinks[0];
    double mass = 0.0, v2 = 4.25;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        if (w->dem.particles.vel[4 * p + 3] > 0.0) mass += 1.0 / w->dem.particles.vel[4 * p + 3];
    assert_true(o->number > 250.0 &&
                s->number == o->number + (double)gn_dem_present_count(&w->dem));
    /* Sums of some 400 terms. */
    assert_close(s->mass, o->mass + mass, 1e-13);
    assert_close(s->momentum[2], o->momentum[2] - 2.0 * mass, 1e-12);
    assert_close(s->momentum[0], o->momentum[0] + 0.5 * mass, 1e-12);
    assert_close(o->energy, 0.5 * o->mass * v2, 1e-12);
    assert_close(e.removed, o->energy, 1e-12);
    /* The first particle existed at the start. */
    assert_close(e.inserted + e.stored_at_start, s->energy, 1e-12);
    assert_near(gn_energy_residual(&e), 0.0, 1e-12);
    world_end(w);
}

/* A particle is in a region if it is entirely inside. */
static void a_region_removes_particles_that_are_wholly_inside(void **state) {
    (void)state;
    gn_world *w = world_of(
        LOOSE "specimen: {particles: [[0.05, 0.05, 0.05, 1e-3], [0.05, 0.05, 0.0095, 1e-3], "
              "[0.2, 0, 0, 1e-3]], group: 0}\n"
              "sinks: [{name: o, box: {size: [0.1, 0.1, 0.1]}, origin: [0, 0, 0.009]}]\n"
              "sets: [{name: a, select: {all: true}, initial_velocity: [0, 0, 0.01]}]\n" ENDLESS);
    assert_true(w->dem.flow.sinks[0].number ==
                1.0); /* the sink removes one particle at the start */
    assert_int_equal(gn_dem_present_count(&w->dem), 2);
    run_until(w, 0.04);
    assert_true(w->dem.flow.sinks[0].number == 1.0);
    run_until(w, 0.08); /* 0.5 mm left at 10 mm/s; checked when lists are made */
    assert_true(w->dem.flow.sinks[0].number == 2.0);
    assert_int_equal(w->dem.lost, 0);
    world_end(w);
}

/* A contact row of a particle that is near but does not touch has no share of the surface, and
 * therefore no stiffness. */
static void a_grain_of_hertzs_law_leaves_beside_a_body_that_it_does_not_touch(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nlaw: {stiffness: hertz}\ngravity: [0, 0, -9.81]\n"
        "materials: [{name: g, density: 2500, friction: 0.5, young: 5 MPa, poisson: 0.25, "
        "restitution: 0.5}]\n"
        "specimen: {particles: [[1.55 mm, 0, 10 mm, 1.5 mm], [30 mm, 0, 150 mm, 1.5 mm]]}\n"
        "bodies: [{name: b, box: {size: [10 mm, 200 mm, 200 mm]}, origin: [-10 mm, -100 mm, -100 "
        "mm], friction: 0.3}]\n"
        "sinks: [{name: k, plane: {point: [0, 0, 0], normal: [0, 0, -1]}}]\n"
        "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\ntime: {end: 0.1}\nrun: {threads: 1}\n");
    run_until(w, 0.06);
    assert_true(w->dem.flow.sinks[0].number == 1.0);
    gn_energy e = measured_step(w);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    world_end(w);
}

/* A grain flies up and down through a plane, through which another one falls. */
static void a_plane_that_counts_removes_nothing(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\n" GRAINS "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
        "specimen: {particles: [[0, 0, 0.05, 1e-3], [0.1, 0, -0.05, 1e-3]], group: 0}\n"
        "sinks: [{name: g, plane: {point: [0, 0, 0], normal: [0, 0, -1]}, remove: false}]\n"
        "sets: [{name: a, select: {ids: [0]}, initial_velocity: [0, 0, -1]},\n"
        "       {name: b, select: {ids: [1]}, initial_velocity: [0, 0, 2]}]\n"
        "gravity: [0, 0, -10]\n" ENDLESS);
    measured_step(w);
    run_until(w, 0.038); /* only b has passed, upwards since 0.027 */
    assert_true(w->dem.flow.sinks[0].number == -1.0 && w->dem.flow.sinks[0].mass < 0.0);
    run_until(w, 0.45); /* all particles are below */
    assert_true(w->dem.flow.sinks[0].number == 1.0);
    assert_int_equal(gn_dem_present_count(&w->dem), 2);
    world_end(w);
}

/* Three bonded particles in a row; the sink removes the last one with its bond. */
static void a_sink_takes_bonded_particles(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\n"
        "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [4e-3, 0, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
        "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\n"
        "law: {stiffness: uniform}\nbonds: {}\n"
        "sets: [{name: a, select: {all: true}, initial_velocity: [1, 0, 0]}]\n"
        "sinks: [{name: o, plane: {point: [6e-3, 0, 0], normal: [1, 0, 0]}}]\n" DOMAIN ENDLESS);
    measured_step(w);
    while (w->dem.flow.sinks[0].number < 1.0 && w->ctx.step < 100000) run_steps(w, 1);
    run_steps(w, 10);
    gn_energy e = measured_step(w);
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_INTACT);
    assert_int_equal(w->dem.bonds.contacts.cause[1], GN_BOND_LEFT);
    assert_close(e.removed, 0.5 * sphere_mass(2500, 1e-3), 1e-9);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    world_end(w);
}

static void lost_particles_are_known_by_id_and_place(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\n" GRAINS
                 "specimen: {particles: [[0, 0, 0, 1e-3], [0.05, 0, 0, 1e-3]], group: 0}\n"
                 "sets: [{name: a, select: {ids: [1]}, initial_velocity: [1, 0, 0]}]\n"
                 "domain: {min: [-1, -1, -1], max: [0.06, 1, 1], lost: remove}\n" ENDLESS);
    run_until(w, 0.02);
    const gn_lost *lost = w->dem.flow.lost;
    assert_int_equal(w->dem.flow.lost_count, 1);
    assert_true(lost->id == 1.0 && lost->velocity[0] == 1.0);
    /* The sink is evaluated when lists are made: the skin is 0.15 mm, or wider. */
    assert_true(lost->place[0] > 0.06 && lost->place[0] < 0.062);
    assert_close(lost->place[0], 0.05 + lost->time, 1e-9);
    world_end(w);
}

/* --- identity --- */

/* A stream through a sink: rows of removed particles are reused, ids are not. */
static void ids_stay_unique_and_rows_do_not_pile_up(void **state) {
    (void)state;
    gn_world *w = world_of(
        LOOSE "sources: [{name: s, box: {size: [0.03, 0.03, 0.03]}, rate: 5000, mean_radius: 1 mm, "
              "velocity: [0, 0, -3]}]\n"
              "sinks: [{name: o, plane: {point: [0, 0, -0.02], normal: [0, 0, -1]}}]\n" ENDLESS);
    run_until(w, 0.25);
    const gn_particles *q = &w->dem.particles;
    size_t present = gn_dem_present_count(&w->dem);
    assert_true(w->dem.flow.sinks[0].number > 1000.0);
    assert_true(q->soa.count < 2 * present);
    assert_true((double)w->dem.ids == w->dem.flow.sources[0].number);
    for (size_t p = 0; p < q->soa.count; p++) assert_int_equal(w->dem.index_of_id[q->id[p]], p);
    world_end(w);
}

/* --- with all other options --- */

/* A block on a floor, bonded or of grains that resist rolling (which exclude each other); grains of
 * different sizes fall on it, roll off and leave. */
typedef enum kind { BONDED, ROLLING, KINDS } kind;

static const char *busy(kind of, int threads, const char *precision) {
    static const char *const laws[] = {
        "materials:\n"
        "  - {name: rock, density: 2500, normal_stiffness: 1e5, kratio: 2, friction: 0.5, "
        "bond_tension_limit: 100, bond_shear_limit: 100}\n"
        "  - {name: grain, density: 2500, normal_stiffness: 2e4, kratio: 2, friction: 0.5, "
        "bond_tension_limit: 1, bond_shear_limit: 1}\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
        "damping: {contact: {restitution: 0.5}}\n",
        "materials:\n"
        "  - {name: rock, density: 2500, young: 20 MPa, poisson: 0.2, friction: 0.5, "
        "rolling_friction: 0.2, restitution: 0.5}\n"
        "  - {name: grain, density: 2500, young: 10 MPa, poisson: 0.2, friction: 0.5, "
        "rolling_friction: 0.1, restitution: 0.5}\n"
        "law: {stiffness: hertz}\n"};
    static const char *const sides[] = {"stiffness: 1e5, kratio: 2, friction: 0.5",
                                        "friction: 0.5, rolling_friction: 0.1"};
    static char scene[4096];
    snprintf(scene, sizeof scene,
             "dimension: 3\n"
             "specimen: {lattice: {kind: cubic, radius: 2 mm, cells: [4, 4, 2], "
             "origin: [-8 mm, -8 mm, 0]}, material: rock}\n"
             "%s"
             "gravity: [0, 0, -9.81]\n"
             "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], %s}]\n"
             "bodies: [{name: b, box: {size: [4 mm, 30 mm, 8 mm]}, origin: [9 mm, -15 mm, 0.1 mm], "
             "%s}]\n"
             "sources:\n"
             "  - {name: s, cylinder: {diameter: 20 mm, height: 10 mm}, origin: [0, 0, 15 mm], "
             "rate: 4000, mean_radius: 1 mm, size_ratio: 2, material: grain, "
             "velocity: [-0.5, 0, -1], random_velocity: 0.1}\n"
             "  - {name: late, box: {size: [5 mm, 5 mm, 5 mm]}, origin: [-20 mm, 0, 20 mm], "
             "mass_rate: 0.02, mean_radius: 1.5 mm, material: grain, start: 10 ms}\n"
             "sinks:\n"
             "  - {name: o, plane: {point: [-12 mm, 0, 0], normal: [-1, 0, 0]}}\n"
             "  - {name: side, box: {size: [0.2, 0.2, 0.2]}, origin: [-0.1, 12 mm, -0.1]}\n"
             "  - {name: g, plane: {point: [0, 0, 10 mm], normal: [0, 0, -1]}, remove: false}\n"
             "domain: {min: [-0.1, -0.1, -0.1], max: [0.1, 0.1, 0.1], lost: remove}\n"
             "time: {end: 1}\nrun: {threads: %d, precision: %s}\n",
             laws[of], sides[of], sides[of], threads, precision);
    return scene;
}

static gn_world *busy_world(kind of, int threads, const char *precision) {
    return world_of("%s", busy(of, threads, precision));
}

enum { BUSY_STEPS = 6000 };

/* The bonds are still those of the block, whose particles have the first 32 ids. */
static void bonds_are_those_of_the_block(const gn_world *w) {
    const gn_contacts *b = &w->dem.bonds.contacts;
    assert_int_equal(b->soa.count, 2 * 2 * 3 * 4 + 16);
    for (size_t c = 0; c < b->soa.count; c++) {
        assert_true(w->dem.particles.id[b->i[c]] < 32 && w->dem.particles.id[b->j[c]] < 32);
        assert_int_equal(b->cause[c], GN_INTACT);
    }
}

static void the_ledger_closes_beside_everything(void **state) {
    (void)state;
    for (int k = 0; k < 2 * KINDS; k++) {
        gn_world *w = busy_world((kind)(k / 2), 1, k % 2 ? "mixed" : "double");
        measured_step(w);
        run_steps(w, BUSY_STEPS);
        gn_energy e = measured_step(w);
        assert_true(e.inserted > 0.0 && e.removed > 0.0 && e.friction > 0.0);
        assert_true((e.rolling > 0.0) == (k / 2 == ROLLING));
        assert_true(w->dem.flow.sinks[0].number > 5.0 && w->dem.flow.sources[1].number > 5.0);
        assert_true(w->dem.flow.sinks[2].number > 5.0);
        /* The bound is the same as for collisions that a step resolves (docs/physics.md). */
        assert_near(gn_energy_residual(&e), 0.0, 0.005);
        if (k / 2 == BONDED) bonds_are_those_of_the_block(w);
        world_end(w);
    }
}

static void threads_have_the_same_bits(void **state) {
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        gn_world *a = busy_world((kind)k, 1, "double"), *b = busy_world((kind)k, 2, "double");
        run_steps(a, BUSY_STEPS);
        run_steps(b, BUSY_STEPS);
        assert_true(gn_world_hash(&a->ctx, &a->dem, &a->boundary, &a->solids, &a->box) ==
                    gn_world_hash(&b->ctx, &b->dem, &b->boundary, &b->solids, &b->box));
        assert_true(memcmp(a->dem.flow.sinks, b->dem.flow.sinks, 3 * sizeof(gn_sink_state)) == 0);
        assert_true(a->ctx.dt == b->ctx.dt);
        world_end(a);
        world_end(b);
    }
}

static void resumes(kind of) {
    gneiss_error error = {0};
    gn_scene scene;
    gn_run whole, resumed;
    char path[] = "/tmp/flow_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    ok(gn_scene_parse(busy(of, 1, "mixed"), "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    ok(gn_run_create(&scene, &whole, &error), &error);
    ok(gn_run_steps(&whole, 3333, &error), &error);
    ok(gn_checkpoint_write(&whole, path, &error), &error);
    ok(gn_run_load(path, NULL, 0, &resumed, &error), &error);
    ok(gn_run_steps(&whole, 3000, &error), &error);
    ok(gn_run_steps(&resumed, 3000, &error), &error);
    assert_true(whole.world.dem.flow.sinks[0].number > 5.0);
    assert_true(gn_world_hash(&whole.world.ctx, &whole.world.dem, &whole.world.boundary,
                              &whole.world.solids, &whole.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    assert_true(whole.world.ctx.dt == resumed.world.ctx.dt);
    assert_true(
        memcmp(&whole.world.ledger.energy, &resumed.world.ledger.energy, sizeof(gn_energy)) == 0);
    assert_int_equal(whole.history.row_count, resumed.history.row_count);
    gn_run_free(&whole);
    gn_run_free(&resumed);
    unlink(path);
}

static void a_resumed_run_has_the_same_bits(void **state) {
    (void)state;
    for (int k = 0; k < KINDS; k++) resumes((kind)k);
}

/* The second stage keeps the particles of stage and source; sets still are parts of the specimen.
 * */
static void stages_continue_with_inserted_particles(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_scene scene;
    gn_run run;
    ok(gn_scene_parse(
           LOOSE
           "specimen: {particles: [[0, 0, 0.03, 1e-3]], group: 0}\n"
           "sources: [{name: s, box: {size: [0.02, 0.02, 0.01]}, rate: 2000, mean_radius: 1 mm, "
           "velocity: [0, 0, -1]}]\n"
           "sets: [{name: held, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
           "walls: [{name: f, point: [0, 0, -0.02], normal: [0, 0, 1], friction: 0.5}]\n"
           "stages:\n  - {name: fall, end: {time: 30 ms}}\n"
           "  - {name: rise, gravity: [0, 0, 5], sets: {held: {motion: {vz: 1}}}}\n"
           "time: {end: 60 ms}\nrun: {threads: 1}\n",
           "s.yaml", NULL, NULL, 0, &scene, &error),
       &error);
    ok(gn_run_create(&scene, &run, &error), &error);
    gn_world *w = &run.world;
    while (w->ctx.time < 0.06) ok(gn_run_steps(&run, 10, &error), &error);
    assert_int_equal(w->stages.now, 1);
    assert_true(gn_dem_present_count(&w->dem) > 100);
    assert_int_equal(w->dem.prescribed.count, 1);
    assert_near(gn_set_travel(&w->ctx, &w->dem, &w->solids, 0, 2), 0.03,
                0.002); /* the source inserts from the first step of the stage on */
    assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 0.005);
    gn_run_free(&run);
}

/* Grains upon a plate of finite elements, with no specimen to begin with. */
static void grains_fall_on_finite_elements(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 2, "
        "friction: 0.5}]\nlaw: {stiffness: uniform}\ndamping: {contact: {restitution: 0.5}}\n"
        "elements: {box: {size: [0.02, 0.02, 0.01], cells: [2, 2, 1], origin: [0, 0, -0.01]}, "
        "materials: [{young: 1e8, poisson: 0.2, density: 1000}], "
        "motions: [{name: foot, group: z_lower, motion: {vx: 0, vy: 0, vz: 0}}], "
        "contact: {stiffness: 1e5, kratio: 2, friction: 0.3}}\n"
        "sources: [{name: s, box: {size: [0.02, 0.02, 0.02]}, origin: [0, 0, -0.0005], rate: "
        "20000, "
        "mean_radius: 1 mm, velocity: [0, 0, -0.5]}]\ngravity: [0, 0, -9.81]\n" DOMAIN ENDLESS);
    measured_step(w);
    run_until(w, 0.02);
    gn_energy e = measured_step(w);
    assert_true(w->dem.flow.sources[0].number > 50.0 && e.elastic_elements > 0.0);
    for (size_t p = 0; p < w->dem.particles.soa.count;
         p++) /* no particle entered below the surface */
        assert_true(w->dem.particles.start[4 * p + 2] > 0.0);
    assert_near(gn_energy_residual(&e), 0.0, 0.01);
    world_end(w);
}

/* --- slips --- */

static void refuses(const char *from, const char *to, const char *message) {
    static const char scene[] =
        "dimension: 3\n" GRAINS "sources:\n"
        "  - name: s\n"
        "    box: {size: [10 mm, 10 mm, 10 mm]}\n"
        "    rate: 100\n"
        "    mean_radius: 1 mm\n"
        "sinks: [{name: o, plane: {point: [0, 0, -1], normal: [0, 0, -1]}}]\n"
        "domain: {min: [-1, -1, -2], max: [1, 1, 1]}\n"
        "time: {end: 1}\n";
    char changed[sizeof scene + 512];
    const char *at = strstr(scene, from);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - scene), scene, to, at + strlen(from));
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    gneiss_status status = world_try(w, changed, NULL, &error);
    if (status == GNEISS_OK) gn_world_free(w);
    free(w);
    if (!message) {
        if (status != GNEISS_OK) fail_msg("%s", error.message);
        return;
    }
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    if (!strstr(error.message, message)) fail_msg("%s\nexpected %s", error.message, message);
}

static void typing_errors_are_refused_at_their_place(void **state) {
    (void)state;
    refuses("rate", "rate", NULL);
    refuses("rate: 100", "rate: 0", "s.yaml:7:11: sources[0].rate: expected a value in [1e-12, ");
    refuses("    rate: 100\n", "",
            "s.yaml:5:5: sources[0].rate: expected either rate or mass_rate, found none");
    refuses("rate: 100", "rate: 100\n    mass_rate: 1",
            "s.yaml:8:16: sources[0].mass_rate: expected either rate or mass_rate, found both");
    refuses("1 mm", "0", "s.yaml:8:18: sources[0].mean_radius: expected a value in [1e-9, 1e9] m");
    refuses("10 mm]}", "0]}", "s.yaml:6:");
    refuses("box: {size: [10 mm, 10 mm, 10 mm]}", "origin: [0, 0, 0]",
            "s.yaml:5:5: sources[0]: expected one of box, cylinder in it, found none");
    refuses("rate: 100", "cylinder: {diameter: 1, height: 1}\n    rate: 1",
            "s.yaml:7:5: sources[0].cylinder: expected one of box, cylinder in it, found box, "
            "cylinder");
    refuses("rate: 100", "rate: 1\n    origin: [5, 0, 0]",
            "s.yaml:6:5: sources[0].box: expected a region inside the domain, found 5 to 5.01 m "
            "along x, outside of -1 to 1 m");
    refuses("rate: 100", "rate: 1\n    start: 1\n    end: 0.5",
            "s.yaml:9:10: sources[0].end: expected an end after the start, 1 s, found 0.5 s");
    refuses("rate: 100", "rate: 1\n    start: 1 ms",
            "expected a specimen, or a source with start 0, found neither");
    refuses("time:", "sets: [{name: a, select: {ids: [0]}, initial_velocity: [1, 0, 0]}]\ntime:",
            "s.yaml:11:7: sets: needs a specimen, whose particles sets select; found");
    refuses("rate: 100", "rate: 1\n    material: x",
            "sources[0].material: expected the name of a material, found 'x'");
    refuses("rate: 100", "rate: 1\n    sizes: sieve", "sources[0].sizes: needs a key sieve");
    refuses("rate: 100",
            "rate: 1\n    sizes: sieve\n    sieve: [[0.5, 0], [1, 1]]\n    size_ratio: 2",
            "s.yaml:10:17: sources[0].size_ratio: needs sizes: uniform or normal; found sieve");
    refuses("rate: 100", /* the key is refused also if the value is the default */
            "rate: 1\n    sizes: sieve\n    sieve: [[0.5, 0], [1, 1]]\n    size_ratio: 1",
            "s.yaml:10:17: sources[0].size_ratio: needs sizes: uniform or normal; found sieve");
    refuses("rate: 100", "rate: 1\n    total: 1e9", NULL);
    refuses("rate: 100", "rate: 1\n    total: 2e9",
            "s.yaml:8:12: sources[0].total: expected a whole number in [1, 1e9] or 'none', found "
            "'2e9'");
    refuses("rate: 100", "rate: 1\n    total: 1e-1", "expected a whole number in [1, 1e9]");
    refuses("rate: 100", "rate: 1\n    total: 1e400", "expected a whole number in [1, 1e9]");
    refuses("rate: 100", "rate: 1\n    sizes: fitted", "expected one of uniform, normal, sieve");
    refuses("normal: [0, 0, -1]", "normal: [0, 0, 0]",
            "sinks[0].plane.normal: expected a direction, found [0, 0, 0]");
    refuses("{name: o, plane", "{name: o, remove: false, box: {size: [1, 1, 1]}}, {name: p, plane",
            "sinks[0].remove: expected plane beside false, found a region");
    refuses("{name: o", "{name: o, box: {size: [1, 1, 1]}", "found plane, box");
    refuses("{name: o", "{name: o, plane: {point: [0, 0, 0], normal: [1, 0, 0]}}, {name: o",
            "sinks[1].name: expected a unique name, found 'o' a second time");
    refuses("time: {end: 1}", "time: {end: 1, mass_scaling: {factor: 2}}",
            "sources: expected a scene without time.mass_scaling, found one with it");
    refuses("time:", "walls: [{name: w, point: [0, 0, 1], normal: [0, 0, 1], material: m}]\ntime:",
            "s.yaml:5:5: sources: expected room for a first particle, radius 0.001 m");
}

static void a_specimen_wholly_in_a_sink_causes_a_warning(void **state) {
    (void)state;
    static const char *const steps[] = {"", ", step: 1 us"};
    for (int k = 0; k < 2; k++) {
        char scene[1024];
        gneiss_error error = {0};
        gn_world *w = calloc(1, sizeof *w);
        snprintf(scene, sizeof scene,
                 "dimension: 3\n" GRAINS "specimen: {particles: [[0, 0, 0, 1e-3], [1, 0, 0, "
                 "1e-3]]}\nsinks: [{name: o, plane: {point: [-1, 0, 0], normal: [1, 0, 0]}}]\n"
                 "domain: {min: [-2, -2, -2], max: [2, 2, 2]}\ntime: {end: 1%s}\n",
                 steps[k]);
        assert_int_equal(world_try(w, scene, NULL, &error), GNEISS_ERROR_INPUT);
        assert_non_null(strstr(error.message,
                               "s.yaml:5:9: sinks: expected a specimen of which something lies "
                               "outside of them, found all of its 2 particles inside"));
        free(w);
    }
}

/* --- examples --- */

/* Runs the beginning of an example. */
static void example(const char *name, double time) {
    char path[4096];
    gn_scene scene;
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    const gn_override fewer[] = {{"run.threads", "1"}};
    snprintf(path, sizeof path, "%s/scenes/%s", test_source(), name);
    ok(gn_scene_load(path, fewer, 1, &scene, &error), &error);
    ok(gn_world_create(&scene, w, &error), &error);
    run_until(w, time);
    gn_energy e = measured_step(w);
    assert_int_equal(w->dem.lost, 0);
    assert_true(w->dem.flow.sources[0].number > 200.0 && e.friction > 0.0);
    assert_true(fabs(gn_energy_residual(&e)) < 0.005);
    world_end(w);
}

static void the_examples_begin(void **state) {
    (void)state;
    example("hopper.yaml", 0.06);
    example("drum.yaml", 0.06);
}

/* penetration.yaml with fewer and larger grains, in less time: the sphere is held while grains
 * arrive, falls freely, and comes to rest below the surface of the bed, which supports it. */
static void a_sphere_comes_to_rest_in_a_bed(void **state) {
    (void)state;
    const gn_override smaller[] = {{"run.threads", "1"},
                                   {"sources.feed.total", "400"},
                                   {"sources.feed.mean_radius", "3 mm"},
                                   {"sources.feed.rate", "4000"},
                                   {"sources.feed.velocity", "[0, 0, -1]"},
                                   {"stages.fill.end.time", "0.2"},
                                   {"time.end", "1"}};
    char path[4096];
    gn_scene scene;
    gn_run run;
    gneiss_error error = {0};
    snprintf(path, sizeof path, "%s/scenes/penetration.yaml", test_source());
    ok(gn_scene_load(path, smaller, sizeof smaller / sizeof *smaller, &scene, &error), &error);
    ok(gn_run_create(&scene, &run, &error), &error);
    gn_world *w = &run.world;
    while (w->ctx.time < 0.25) ok(gn_run_steps(&run, 1, &error), &error);
    double fallen = w->ctx.time - w->stages.state[1].time, weight = 0.0, top = 0.0, count = 0.0;
    assert_near(pos_of(w, 0)[2], 0.1 - 0.5 * 9.81 * fallen * fallen, 1e-4);
    for (int id = 1; id <= 400; id++) top = fmax(top, pos_of(w, id)[2]);
    while (w->ctx.time < 0.6) ok(gn_run_steps(&run, 1, &error), &error);
    gn_energy e = measured_step(w);
    for (int id = 0; id <= 400; id++) weight += 9.81 * mass_of(w, id);
    for (int id = 1; id <= 400; id++) count += pos_of(w, id)[2] > pos_of(w, 0)[2] - 8e-3;
    print_message("# sphere at %.3g m, bed up to %.3g m, %g of %zu grains higher than its lowest "
                  "point, floor %.4g of %.4g N, residual %.2g\n",
                  pos_of(w, 0)[2], top, count, w->dem.particles.soa.count - 1,
                  -w->boundary.walls[0].force[2], weight, gn_energy_residual(&e));
    assert_int_equal(w->dem.particles.soa.count, 401);
    assert_true(pos_of(w, 0)[2] > 8e-3 && pos_of(w, 0)[2] < top);
    assert_true(count > 40.0);
    assert_true(length3(vel_of(w, 0)) < 0.02);
    assert_near(-w->boundary.walls[0].force[2], weight, 0.2 * weight); /* sides carry the rest */
    assert_true(fabs(gn_energy_residual(&e)) < 0.005);
    gn_run_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_source_keeps_its_rate_and_nothing_overlaps),
        cmocka_unit_test(a_source_keeps_its_rate_of_mass),
        cmocka_unit_test(a_source_stops_at_its_end_and_total),
        cmocka_unit_test(sizes_are_those_of_the_distribution),
        cmocka_unit_test(a_source_without_space_falls_behind_and_warns),
        cmocka_unit_test(a_run_warns_of_a_source_that_is_behind),
        cmocka_unit_test(a_run_warns_of_a_source_behind_a_wall),
        cmocka_unit_test(nothing_comes_in_where_walls_and_bodies_are),
        cmocka_unit_test(nothing_overlaps_across_a_periodic_box),
        cmocka_unit_test(in_the_plane_discs_come_in),
        cmocka_unit_test(momentum_and_energy_pass_from_source_to_sink),
        cmocka_unit_test(a_region_removes_particles_that_are_wholly_inside),
        cmocka_unit_test(a_plane_that_counts_removes_nothing),
        cmocka_unit_test(a_grain_of_hertzs_law_leaves_beside_a_body_that_it_does_not_touch),
        cmocka_unit_test(a_sink_takes_bonded_particles),
        cmocka_unit_test(lost_particles_are_known_by_id_and_place),
        cmocka_unit_test(ids_stay_unique_and_rows_do_not_pile_up),
        cmocka_unit_test(the_ledger_closes_beside_everything),
        cmocka_unit_test(threads_have_the_same_bits),
        cmocka_unit_test(a_resumed_run_has_the_same_bits),
        cmocka_unit_test(stages_continue_with_inserted_particles),
        cmocka_unit_test(grains_fall_on_finite_elements),
        cmocka_unit_test(typing_errors_are_refused_at_their_place),
        cmocka_unit_test(a_specimen_wholly_in_a_sink_causes_a_warning),
        cmocka_unit_test(the_examples_begin),
        cmocka_unit_test(a_sphere_comes_to_rest_in_a_bed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
