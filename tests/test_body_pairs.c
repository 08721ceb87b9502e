/* Contacts between convex rigid bodies. */
#include "body_helpers.h"
#include "parts.h"
#include "run_helpers.h"

#include "boundary/body_pairs.h"
#include "boundary/surface.h"
#include "surfaces/body_shape.h"

static gn_rigid *body(gn_world *w, size_t k) {
    return &w->boundary.bodies[k];
}

/* Steps, all measured, up to a time; the largest residual. */
static double run_to(gn_world *w, double time) {
    double worst = 0.0;
    while (w->ctx.time < time) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    return worst;
}

/* Linear and angular momentum about the origin of all bodies, at the half step. */
static void momentum_of(const gn_world *w, double p[3], double l[3]) {
    for (int a = 0; a < 3; a++) p[a] = l[a] = 0.0;
    for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
        const gn_rigid *b = &w->boundary.bodies[k];
        double turn[3];
        cross3(b->position, b->velocity, turn);
        for (int a = 0; a < 3; a++) {
            p[a] += b->mass * b->velocity[a];
            l[a] += b->mass * turn[a] + b->momentum[a];
        }
    }
}

/* A box about a centre, turned by a vector, as a line of the scene. */
static const char *box(const char *name, const double size[3], const double centre[3],
                       const double turn[3], const char *more) {
    static char lines[8][1024];
    static int next;
    char *line = lines[next++ % 8];
    double m[9], at[3];
    gn_rotation_matrix(turn, m);
    for (int a = 0; a < 3; a++) at[a] = centre[a] - 0.5 * dot3(m + 3 * a, size);
    snprintf(line, sizeof lines[0],
             "  - {name: %s, box: {size: [%.17g, %.17g, %.17g]}, origin: [%.17g, %.17g, %.17g], "
             "rotation: [%.17g, %.17g, %.17g], %s}\n",
             name, size[0], size[1], size[2], at[0], at[1], at[2], turn[0], turn[1], turn[2], more);
    return line;
}

/* --- head on --- */

static const double flat[3] = {0, 0, 0}, aside[3] = {0, 0, 0.3};
/* The diagonal of a cube along z, and an edge downward. */
static const double on_a_corner[3] = {0.675510858856, -0.675510858856, 0};
static const double on_an_edge[3] = {0.785398163397448, 0, 0};
static const double on_other_edge[3] = {0, 0.785398163397448, 0};

/* A cube of 2 kg flies down at 1 m/s onto another one of half the side and 1 kg. */
static gn_world *head_on(const double upper[3], const double lower[3], double restitution) {
    const double large[3] = {0.1, 0.1, 0.1}, small[3] = {0.05, 0.05, 0.05};
    return world_of("%sdamping: {contact: {restitution: %g}}\nbodies:\n%s%stime: {end: 1}\n", head3,
                    restitution,
                    box("a", large, (const double[3]){0.01, 0.02, 0.3}, upper,
                        "stiffness: 2e6, free: true, density: 2000, initial_velocity: [0, 0, -1]"),
                    box("b", small, (const double[3]){0.01, 0.02, 0.0}, lower,
                        "stiffness: 2e6, free: true, density: 8000"));
}

static void cubes_rebound_with_the_restitution(void **state) {
    (void)state;
    const double *const turns[][2] = {{flat, aside},
                                      {on_a_corner, flat},
                                      {flat, on_a_corner},
                                      {on_an_edge, on_other_edge},
                                      {on_a_corner, on_a_corner}};
    const double wanted[] = {1.0, 0.8, 0.5};
    for (size_t k = 0; k < 3 * sizeof turns / sizeof *turns; k++) {
        double e = wanted[k % 3], p[3], l[3];
        gn_world *w = head_on(turns[k / 3][0], turns[k / 3][1], e);
        double worst = run_to(w, 0.4), apart = body(w, 0)->velocity[2] - body(w, 1)->velocity[2];
        momentum_of(w, p, l);
        assert_near(apart, e, 0.01);
        assert_near(p[2], -2.0, 1e-12);
        assert_true(worst < 1e-3);
        world_end(w);
    }
}

/* --- at random --- */

typedef struct collision {
    double residual, momentum, turn,
        change; /* `change`: change of the kinetic energy, over itself */
    bool met;
} collision;

/* A box, a prism or a cone hits another one off the centre, both rotating. */
static collision collide(uint64_t seed, double friction, double restitution) {
    uint64_t at = 100 * seed;
    double p[2][3], l[2][3], turn[2][3], more[4], start = 0.0;
    collision c = {0};
    text *lines = calloc(1, sizeof *lines);
    for (int k = 0; k < 2; k++) {
        double size[3], centre[3] = {0, 0, k ? 0.0 : 0.25};
        for (int a = 0; a < 3; a++) {
            size[a] = uniform(&at, 0.04, 0.16);
            turn[k][a] = uniform(&at, -2, 2);
            if (k == 0 && a < 2) centre[a] = uniform(&at, -0.05, 0.05);
        }
        for (int a = 0; a < 4; a++) more[a] = uniform(&at, -8, 8);
        char text_of[512];
        snprintf(text_of, sizeof text_of,
                 "stiffness: 2e6, kratio: 2, friction: %g, free: true, density: %g, "
                 "initial_velocity: [0, 0, %g], initial_spin: [%g, %g, %g]",
                 friction, uniform(&at, 1000, 4000), k ? 0.0 : -uniform(&at, 0.5, 2), more[0],
                 more[1], more[2]);
        if (seed % 2 == (uint64_t)k)
            add(lines, "%s", box(k ? "b" : "a", size, centre, turn[k], text_of));
        else
            add(lines,
                "  - {name: %s, cylinder: {diameter: %g, upper_diameter: %g, height: %g, sides: "
                "%d}, origin: [%g, %g, %g], rotation: [%g, %g, %g], %s}\n",
                k ? "b" : "a", size[0], seed % 3 ? size[0] : size[1], size[2], 3 + (int)(seed % 7),
                centre[0], centre[1], centre[2], turn[k][0], turn[k][1], turn[k][2], text_of);
    }
    gn_world *w = world_of("%sdamping: {contact: {restitution: %g}}\nbodies:\n%stime: {end: 1}\n",
                           head3, restitution, lines->s);
    momentum_of(w, p[0], l[0]);
    while (w->ctx.time < 0.3) {
        gn_energy e = measured_step(w);
        if (w->ctx.step == 1) start = e.kinetic + e.rotational;
        c.residual = fmax(c.residual, fabs(gn_energy_residual(&e)));
        c.met = c.met || e.elastic_wall > 0.0;
        c.change = (e.kinetic + e.rotational) / start - 1.0;
    }
    momentum_of(w, p[1], l[1]);
    for (int a = 0; a < 3; a++) {
        c.momentum = fmax(c.momentum, fabs(p[1][a] - p[0][a]) / length3(p[0]));
        c.turn = fmax(c.turn, fabs(l[1][a] - l[0][a]) / length3(l[0]));
    }
    world_end(w);
    free(lines);
    return c;
}

static void momentum_and_energy_stay_in_random_collisions(void **state) {
    (void)state;
    collision most = {0};
    int met = 0;
    for (uint64_t seed = 0; seed < 40; seed++) {
        collision c = collide(seed, 0.0, 1.0);
        met += c.met;
        most.residual = fmax(most.residual, c.residual);
        most.change = fmax(most.change, fabs(c.change));
        most.momentum = fmax(most.momentum, c.momentum);
        most.turn = fmax(most.turn, c.turn);
    }
    print_message("# %d of 40 met: residual %.2g, energy %.2g, momentum %.2g, of turning %.2g\n",
                  met, most.residual, most.change, most.momentum, most.turn);
    assert_true(met >= 30);
    assert_true(most.momentum < 1e-12 && most.turn < 1e-9);
    assert_true(most.residual < 1e-3 && most.change < 1e-3);
}

static void the_ledger_closes_with_friction_and_dashpots(void **state) {
    (void)state;
    double worst = 0.0, gain = -1.0, turn = 0.0;
    for (uint64_t seed = 0; seed < 40; seed++) {
        collision c = collide(seed, 0.1 * (double)(seed % 8), 0.2 + 0.2 * (double)(seed % 5));
        worst = fmax(worst, c.residual);
        if (c.met) gain = fmax(gain, c.change);
        turn = fmax(turn, fmax(c.turn, c.momentum));
    }
    print_message("# residual %.2g, energy at most %.2g, momentum %.2g\n", worst, gain, turn);
    assert_true(worst < 1e-3 && gain < 1e-4 && turn < 1e-9);
}

/* --- at rest --- */

/* Three cubes on a floor, the second turned a little and the third aside. */
static void a_stack_of_cubes_stays(void **state) {
    (void)state;
    const double size[3] = {0.1, 0.1, 0.1};
    const char *const more = "stiffness: 2e7, kratio: 2, friction: 0.5, free: true, density: 2000";
    for (int k = 0; k < 2; k++) {
        double skew = 0.2 * k, off = 0.02 * k;
        gn_world *w = world_of(
            "%sgravity: [0, 0, -9.81]\ndamping: {contact: {restitution: 0.3}}\n"
            "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e7, kratio: 2, "
            "friction: 0.5}]\nbodies:\n%s%s%stime: {end: 9}\n",
            head3, box("a", size, (const double[3]){0, 0, 0.05}, flat, more),
            box("b", size, (const double[3]){0, off, 0.15}, (const double[3]){0, 0, skew}, more),
            box("c", size, (const double[3]){off, 0, 0.25}, flat, more));
        double worst = run_to(w, 1.0), weight = 2.0 * 9.81, was[3][3];
        for (int b = 0; b < 3; b++) memcpy(was[b], body(w, (size_t)b)->position, sizeof was[b]);
        worst = fmax(worst, run_to(w, 2.0));
        assert_close(-w->boundary.walls[0].force[2], 3.0 * weight, 1e-4);
        assert_int_equal(w->boundary.pairs.count, 2);
        for (size_t b = 0; b < 3; b++) {
            double moved[3];
            for (int a = 0; a < 3; a++) moved[a] = body(w, b)->position[a] - was[b][a];
            assert_near(length3(moved), 0.0, 1e-6);
            assert_near(length3(body(w, b)->spin), 0.0, 1e-2);
        }
        for (size_t p = 0; p < 2; p++) {
            const gn_body_pair *q = &w->boundary.pairs.pair[p];
            assert_close(1e7 * q->depth * length3(q->along), (2.0 - (double)p) * weight, 1e-3);
        }
        assert_true(worst < 1e-3);
        world_end(w);
    }
}

/* Two blocks of 2 cm with sides aligned up to rounding: cubes, of one density and of a ratio of a
 * hundred, displaced by a quarter of a brick, and on a longer one. They come to rest in their
 * places. */
static void blocks_with_sides_in_line_stay(void **state) {
    (void)state;
    static const double lower[4] = {0.02, 0.02, 0.04, 0.03}, upper[4] = {0.02, 0.02, 0.04, 0.02},
                        aside_by[4] = {0, 0, 0.01, 0}, density[4] = {2500, 250000, 2500, 2500};
    for (int k = 0; k < 4; k++) {
        char more[2][128];
        for (int b = 0; b < 2; b++)
            snprintf(more[b], sizeof more[b],
                     "stiffness: 1e7, kratio: 2, friction: 0.5, free: true, density: %g",
                     b ? density[k] : 2500.0);
        const double sizes[2][3] = {{lower[k], 0.02, 0.02}, {upper[k], 0.02, 0.02}};
        const double off[2] = {aside_by[k] * cos(aside[2]), aside_by[k] * sin(aside[2])};
        gn_world *w = world_of(
            "%sgravity: [0, 0, -9.81]\ndamping: {contact: {restitution: 0.3}}\n"
            "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e7, kratio: 2, "
            "friction: 0.5}]\nbodies:\n%s%stime: {end: 9}\n",
            head3, box("a", sizes[0], (const double[3]){0, 0, 0.01}, aside, more[0]),
            box("b", sizes[1], (const double[3]){off[0], off[1], 0.03}, aside, more[1]));
        double worst = run_to(w, 0.3), weight[2], moved = 0.0;
        const gn_body_pair *q = &w->boundary.pairs.pair[0];
        for (size_t b = 0; b < 2; b++) weight[b] = 9.81 * body(w, b)->mass;
        for (int a = 0; a < 2; a++)
            moved = fmax(moved, fabs(body(w, 1)->position[a] - body(w, 0)->position[a] - off[a]));
        print_message("# residual %.2g, moved %.2g m\n", worst, moved);
        assert_close(5e6 * q->depth * length3(q->along), weight[1], 1e-3);
        assert_close(-w->boundary.walls[0].force[2], weight[0] + weight[1], 1e-3);
        assert_true(worst < 1e-5 && moved < 1e-6);
        world_end(w);
    }
}

/* --- friction --- */

/* A cube slides on a fixed slab, and on one driven at 1 m/s until both have the same velocity; or
 * rotates on it about the vertical. */
static void a_sliding_cube_stops_by_friction(void **state) {
    (void)state;
    const double size[3] = {0.1, 0.1, 0.05}, slab[3] = {2, 2, 0.1};
    for (int k = 0; k < 3; k++) {
        const char *const motion[] = {"initial_velocity: [1, 0, 0]", "initial_velocity: [0, 0, 0]",
                                      "initial_spin: [0, 0, 10]"};
        char more[256];
        snprintf(more, sizeof more,
                 "stiffness: 2e7, kratio: 2, friction: 0.3, free: true, density: 2000, %s",
                 motion[k]);
        gn_world *w = world_of(
            "%sgravity: [0, 0, -9.81]\ndamping: {contact: {fraction: 0.3}}\nbodies:\n%s%stime: "
            "{end: 9}\n",
            head3,
            box("s", slab, (const double[3]){0, 0, -0.05}, aside,
                k == 1 ? "stiffness: 2e7, kratio: 2, friction: 0.9, motion: {vx: -1}"
                       : "stiffness: 2e7, kratio: 2, friction: 0.9"),
            box("b", size, (const double[3]){0, 0, 0.025}, flat, more));
        double worst = run_to(w, 0.6), q[4];
        double path = 1.0 / (2.0 * 0.3 * 9.81);
        const gn_rigid *b = body(w, 1);
        gn_rigid_orientation(b, q);
        if (k == 0) assert_close(b->position[0], path, 1e-3);
        if (k == 0) assert_close(w->ledger.reading.friction, 0.5, 0.01);
        if (k == 1) assert_close(b->position[0] + 0.6, path, 2e-3);
        if (k < 2) assert_near(b->velocity[0], -k, 1e-6);
        /* I = m a^2/6, M = mu m g a 0.3826 for a square with uniform pressure. */
        double about = 0.5 * 100.0 * (0.01 / 6.0) / (0.3 * 9.81 * 0.1 * 0.3826);
        if (k == 2) assert_close(2.0 * atan2(q[3], q[0]), about, 0.02);
        assert_near(length3(b->spin), 0.0, k == 2 ? 0.05 : 1e-4);
        assert_true(worst < 1e-3);
        world_end(w);
    }
}

/* --- in the plane --- */

/* A square falls on a fixed hexagon, rolls off and comes to rest beside it on a polygon that is the
 * floor, in whichever sense their corners are given. */
static void polygons_meet_in_the_plane(void **state) {
    (void)state;
    double first[2];
    for (int sense = 0; sense < 2; sense++) {
        gn_world *w = world_of(
            "%sgravity: [0, -9.81]\ndamping: {contact: {restitution: 0.5}}\nbodies:\n"
            "  - {name: floor, polygon: [[-1, -0.2], [1, -0.2], [1, 0], [-1, 0]], stiffness: 2e6, "
            "kratio: 2, friction: 0.4}\n"
            "  - {name: six, polygon: [[0.1, 0.01], [0.05, 0.0966], [-0.05, 0.0966], [-0.1, 0.01], "
            "[-0.05, -0.0766], [0.05, -0.0766]], stiffness: 2e6, kratio: 2, friction: 0.1}\n"
            "  - {name: b, polygon: %s, rotation: 0.3, origin: [0.04, 0.12], stiffness: 2e6, "
            "kratio: 2, friction: 0.4, free: true, density: 200}\ntime: {end: 9}\n",
            head2,
            sense ? "[[0, 0], [0, 0.1], [0.1, 0.1], [0.1, 0]]"
                  : "[[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]]");
        double worst = run_to(w, 3.0);
        const gn_rigid *b = body(w, 2);
        assert_true(worst < 1e-3);
        assert_near(length3(b->velocity), 0.0, 1e-3);
        const double *floor_at = body(w, 0)->position;
        assert_near(b->position[1] - floor_at[1], 0.05, 1e-3);
        assert_true(b->position[0] - floor_at[0] > 0.1);
        if (sense) assert_near(b->position[0], first[0], 1e-6);
        memcpy(first, b->position, sizeof first);
        world_end(w);
    }
}

/* --- pairs without contact --- */

static void bodies_that_pass_through_bodies_are_known(void **state) {
    (void)state;
    const double size[3] = {0.1, 0.1, 0.1};
    const char *const more = "stiffness: 2e6, free: true, density: 2000";
    gn_world *w = world_of("%sbodies:\n%s%s  - {name: tube, cylinder: {diameter: 1, height: 1, "
                           "open: true}, stiffness: "
                           "2e6}\n%stime: {end: 9}\n",
                           head3, box("a", size, (const double[3]){0, 0, 0.05}, flat, more),
                           box("b", size, (const double[3]){0, 0, 0.149}, flat, more),
                           box("c", size, (const double[3]){3, 0, 0.15}, flat, "stiffness: 2e6"));
    gn_bodies_overlap o;
    gneiss_error error = {0};
    assert_true(gn_bodies_meet(&w->ctx, &w->boundary, 0, 1) &&
                gn_bodies_meet(&w->ctx, &w->boundary, 3, 1) &&
                !gn_bodies_meet(&w->ctx, &w->boundary, 3, 3));
    assert_true(gn_body_misses_bodies(&w->ctx, &w->boundary, 2) &&
                !gn_body_misses_bodies(&w->ctx, &w->boundary, 0));
    assert_ok(gn_bodies_overlap_of(&w->ctx, &w->boundary, 0, 1, &o, &error), &error);
    assert_close(o.depth, 1e-3, 0.02);
    assert_close(o.force, 1e3,
                 0.05); /* near the sides of the box the sides are nearer than the face */
    world_end(w);
    gn_world refused;
    char scene_text[4096];
    snprintf(scene_text, sizeof scene_text, "%sbodies:\n%s%stime: {end: 9}\n", head3,
             box("a", size, (const double[3]){0, 0, 0.05}, flat, more),
             box("b", size, (const double[3]){0, 0, 0.09}, flat, more));
    assert_true(world_try(&refused, scene_text, "/tmp", &error) == GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "free body 'b' outside body 'a'"));
}

static bool warns(const gn_run *run, const char *name) {
    gn_warnings list;
    gneiss_error error = {0};
    assert_ok(gn_run_warnings(run, &list, &error), &error);
    for (size_t k = 0; k < list.count; k++)
        if (strcmp(list.warning[k].name, name) == 0) return true;
    return false;
}

/* A cube of 0.02 kg hits a held plate of 1 mm thickness at 1 m/s or 30 m/s, on half of 1e6 N/m: it
 * penetrates by v sqrt(m/k), 0.2 mm, or passes through. A cube that starts inside is pushed with k
 * h. The result is kept over a checkpoint. */
static void bodies_too_deep_in_each_other_cause_a_warning(void **state) {
    (void)state;
    const char *const saved = "/tmp/gneiss-body-depth.h5";
    const double cube[3] = {0.02, 0.02, 0.02}, plate[3] = {0.1, 0.1, 1e-3}, speed[3] = {1, 30, 0},
                 gap[3] = {1e-4, 1e-4, -1e-4};
    for (int k = 0; k < 3; k++) {
        gn_scene scene;
        gn_run run, resumed;
        gneiss_error error = {0};
        text *lines = calloc(1, sizeof *lines);
        char more[128];
        snprintf(more, sizeof more,
                 "stiffness: 1e6, free: true, density: 2500, initial_velocity: [0, 0, %g]",
                 -speed[k]);
        add(lines, "%sgravity: [0, 0, -10]\nbodies:\n%s%stime: {end: 1}\n", head3,
            box("a", plate, (const double[3]){0, 0, 0}, flat, "stiffness: 1e6"),
            box("b", cube, (const double[3]){0, 0, 0.0105 + gap[k]}, flat, more));
        assert_ok(gn_scene_parse(lines->s, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
        assert_ok(gn_run_create(&scene, &run, &error), &error);
        run_to(&run.world, 1e-3);
        const gn_body_pairs *p = &run.world.boundary.pairs;
        print_message("# %.3g of the thickness, %.3g N\n", p->deepest.value, p->pushed.value);
        if (k == 0) assert_close(p->deepest.value, 0.2, 0.03);
        if (k == 2) assert_close(p->deepest.value, 0.1, 0.03);
        if (k == 2) assert_close(p->pushed.value, 50.0, 0.03);
        assert_int_equal(warns(&run, "bodies_too_deep"), k == 1);
        assert_int_equal(warns(&run, "bodies_pushed"), k == 2);
        assert_ok(gn_checkpoint_write(&run, saved, &error), &error);
        assert_ok(gn_checkpoint_load(saved, NULL, 0, &resumed, &error), &error);
        assert_int_equal(warns(&resumed, "bodies_too_deep"), k == 1);
        assert_int_equal(warns(&resumed, "bodies_pushed"), k == 2);
        gn_run_free(&run);
        gn_run_free(&resumed);
        free(lines);
        unlink(saved);
    }
}

/* --- threads, resume --- */

/* Blocks fall on each other and on spheres between walls. */
static void pile(text *lines, int threads) {
    uint64_t at = 3;
    add(lines,
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 5e-3, cells: [6, 6, 1], origin: "
        "[6e-3, 6e-3, 6e-3], jitter: 0.2, spacing: 1.1}, group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 2e4, kratio: 2, friction: 0.3}]\n"
        "law: {stiffness: uniform}\ngravity: [0, 0, -10]\n"
        "damping: {contact: {restitution: 0.4}}\nwalls:\n");
    static const char *const wall[] = {
        "0, 0, 0], normal: [0, 0, 1", "0, 0, 0], normal: [1, 0, 0", "0, 0, 0], normal: [0, 1, 0",
        "0.07, 0, 0], normal: [-1, 0, 0", "0, 0.07, 0], normal: [0, -1, 0"};
    for (int k = 0; k < 5; k++)
        add(lines, "  - {name: w%d, point: [%s], stiffness: 2e4, kratio: 2, friction: 0.3}\n", k,
            wall[k]);
    add(lines, "bodies:\n");
    for (int k = 0; k < 8; k++) {
        double size[3], turn[3],
            centre[3] = {0.02 + 0.03 * (k & 1), 0.02 + 0.03 * (k >> 1 & 1),
                         0.035 + 0.035 * (k >> 2)};
        char name[8];
        for (int a = 0; a < 3; a++) {
            size[a] = uniform(&at, 0.012, 0.02);
            turn[a] = uniform(&at, -2, 2);
        }
        snprintf(name, sizeof name, "b%d", k);
        add(lines, "%s",
            box(name, size, centre, turn,
                "stiffness: 2e4, kratio: 2, friction: 0.3, free: true, density: 2000"));
    }
    add(lines, "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {end: 1}\nrun: {threads: %d}\n",
        threads);
}

static gn_run *pile_run(int threads) {
    text *lines = calloc(1, sizeof *lines);
    pile(lines, threads);
    gn_run *run = run_of("%s", lines->s);
    free(lines);
    return run;
}

static void threads_and_a_resumed_run_give_the_same_bits(void **state) {
    (void)state;
    gn_run *straight = pile_run(3), *stopped = pile_run(1);
    double held = 0.0; /* energy that a resumed run has to restore */
    while (held == 0.0 && stopped->world.ctx.step < 9000) {
        run_steps(&stopped->world, 7);
        const gn_body_pairs *q = &stopped->world.boundary.pairs;
        for (size_t c = 0; c < q->count; c++)
            held += length3(q->pair[c].shear) * fabs(q->pair[c].twisting);
    }
    assert_true(held > 0.0);
    end_resumed_alike(straight, stopped, 700);
}

static void blocks_come_to_rest_on_each_other(void **state) {
    (void)state;
    text *lines = calloc(1, sizeof *lines);
    pile(lines, 1);
    gn_world *w = world_of("%s", lines->s);
    double worst = run_to(w, 1.0), weight = 0.0, speed = 0.0, lowest = 1.0;
    for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
        weight += 10.0 * body(w, k)->mass;
        speed = fmax(speed, length3(body(w, k)->velocity));
        lowest = fmin(lowest, body(w, k)->position[2]);
    }
    for (int p = 0; p < 36; p++) weight += 10.0 * mass_of(w, p);
    assert_near(-w->boundary.walls[0].force[2], weight,
                0.1 * weight); /* the sides carry a part of the weight */
    assert_true(worst < 1e-3 && speed < 0.01 && lowest > 0.0);
    world_end(w);
    free(lines);
}

int main(int argc, char **argv) {
    (void)argv;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_rebound_with_the_restitution),
        cmocka_unit_test(momentum_and_energy_stay_in_random_collisions),
        cmocka_unit_test(the_ledger_closes_with_friction_and_dashpots),
        cmocka_unit_test(a_sliding_cube_stops_by_friction),
        cmocka_unit_test(polygons_meet_in_the_plane),
        cmocka_unit_test(bodies_that_pass_through_bodies_are_known),
        cmocka_unit_test(bodies_too_deep_in_each_other_cause_a_warning),
        cmocka_unit_test(threads_and_a_resumed_run_give_the_same_bits),
        cmocka_unit_test(blocks_come_to_rest_on_each_other),
    };
    const struct CMUnitTest long_tests[] = {
        cmocka_unit_test(a_stack_of_cubes_stays),
        cmocka_unit_test(blocks_with_sides_in_line_stay),
    };
    return run_part(argc, tests, long_tests);
}
