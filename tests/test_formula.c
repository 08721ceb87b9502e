/* Formulas of t: they give what the same table gives, motions and loads follow closed forms, and
 * what is wrong in a formula is refused with its place. */
#include "run_helpers.h"
#include "scene/formula.h"

/* --- reading --- */

static void a_text_with_the_name_t_is_a_formula(void **state) {
    (void)state;
    const char *const formulas[] = {"t",     "2*t", "sin(2*pi*5*t)", "(t > 1 ? 1 : t)",
                                    "1e3*t", "-t^2"};
    const char *const others[] = {"1", "23 mm/s", "1e3t", "tan(1)", "time", "t2", "2t", "x_t", ""};
    for (size_t k = 0; k < sizeof formulas / sizeof *formulas; k++)
        if (!gn_formula_is(formulas[k])) fail_msg("'%s' is no formula", formulas[k]);
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (gn_formula_is(others[k])) fail_msg("'%s' is a formula", others[k]);
}

static void formulas_have_the_values_of_mathematics(void **state) {
    (void)state;
    const struct {
        const char *text;
        double t, value;
    } rows[] = {
        {"0.1*sin(2*pi*5*t)", 0.05, 0.1},     {"t < 2 ? t^3 : 8", 1.5, 3.375},
        {"t < 2 ? t^3 : 8", 3.0, 8.0},        {"exp(-t/2)*cos(0)", 2.0, 0.36787944117144233},
        {"min(t, 1, 0.5) + ln(e)", 3.0, 1.5}, {"sqrt(abs(-4*t))", 4.0, 4.0}};
    char reason[96];
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        gn_formula *list = NULL,
                   *f = gn_formula_add(&list, rows[k].text, "key", reason, sizeof reason);
        if (!f) fail_msg("'%s'%s", rows[k].text, reason);
        assert_close(gn_formula_at(f, rows[k].t), rows[k].value, 1e-15);
        gn_formula *other = NULL, *copy = gn_formula_copy(f, &other);
        assert_true(gn_formula_at(copy, 0.3) == gn_formula_at(f, 0.3));
        gn_formulas_free(list);
        gn_formulas_free(other);
    }
}

/* A floor, a ball above it, and a wall whose motion is replaced. */
static const char ball[] =
    "dimension: 3\nspecimen: {particles: [[0, 0, 5 mm, 1 mm]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-1, -1, -1], max: [1, 1, 1]}\nwalls:\n"
    "- {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5, motion: {vz: 0}}\n"
    "time: {step: 1e-5, end: 0.1}\nrun: {threads: 1}\n";

static void what_is_wrong_in_a_formula_is_refused_at_its_place(void **state) {
    (void)state;
    const char *const wrong[][2] = {{"vz: 0.1*sni(t)", "unexpected 'sni' at character 5"},
                                    {"vz: sin(t", "not complete at character"},
                                    {"vz: 2*t +", "not complete at character"},
                                    {"vz: t*x", "unexpected 'x' at character 3"},
                                    {"vz: t = 3", "unexpected '=' at character 3"},
                                    {"vz: '1, t'", "unexpected ',' at character 2"},
                                    {"vz: 20 mm/s*t", "unexpected 'mm' at character 4"},
                                    {"vz: 1e10*t", "which is"}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        assert_change_refused(ball, "vz: 0", wrong[k][0], "s.yaml:7:");
        assert_change_refused(ball, "vz: 0", wrong[k][0], "walls[0].motion.vz");
        assert_change_refused(ball, "vz: 0", wrong[k][0], wrong[k][1]);
    }
}

/* --- motions --- */

static gn_world *changed(const char *from, const char *to) {
    const char *at = strstr(ball, from);
    assert_non_null(at);
    return world_of("%.*s%s%s", (int)(at - ball), ball, to, at + strlen(from));
}

static double floor_at(const gn_world *w) {
    return w->boundary.walls[0].point[2];
}

static void a_formula_is_evaluated_where_a_table_is(void **state) {
    (void)state;
    gn_world *table = changed("vz: 0", "vz: [[0, 0], [0.01, 0.1], [0.02, 0.1], [0.03, -0.1]]"),
             *formula = changed("vz: 0", "vz: 't < 0.01 ? 10*t : t < 0.02 ? 0.1 : t < 0.03 ? "
                                         "0.1 - 20*(t - 0.02) : -0.1'");
    for (int k = 0; k < 4000; k++) {
        run_steps(table, 1);
        run_steps(formula, 1);
        assert_near(formula->boundary.walls[0].velocity[2], table->boundary.walls[0].velocity[2],
                    1e-15);
    }
    assert_near(floor_at(formula), floor_at(table), 1e-15);
    world_end(table);
    world_end(formula);
}

/* The path is the sum of velocities at the middles of steps: of a cosine the sine times x/sin(x), x
 * = w dt/2, which is 1 + (w dt)^2/24. */
static void the_path_of_a_cosine_is_the_sine_to_second_order(void **state) {
    (void)state;
    gn_world *w = changed("vz: 0", "vz: 0.01*cos(2*pi*100*t)");
    const double x = pi * 100.0 * 1e-5, steps[] = {250, 260, 740};
    for (int k = 0; k < 3; k++) {
        while (w->ctx.step < (int64_t)steps[k]) run_steps(w, 1);
        const double sine = 0.01 / (2.0 * pi * 100.0) * sin(2.0 * pi * 100.0 * w->ctx.time);
        assert_near(floor_at(w), sine * x / sin(x), 1e-16);
        assert_true(fabs(floor_at(w) / sine - 1.0 - x * x / 6.0) < 1e-2 * x * x);
    }
    world_end(w);
}

/* Predictions integrate formulas by Gauss's rule. */
static void the_integral_of_a_formula_is_that_of_mathematics(void **state) {
    (void)state;
    gn_world *w = changed("vz: 0", "vz: 0.01*cos(2*pi*100*t)");
    const gn_table *t = &w->ctx.scene.walls[0].motion.velocity[2];
    for (int k = 1; k < 10; k++) {
        const double from = 0.0021 * k, to = 0.0117 * k, w100 = 2.0 * pi * 100.0;
        assert_near(gn_table_between(t, from, to),
                    0.01 / w100 * (sin(w100 * to) - sin(w100 * from)), 1e-16);
    }
    assert_true(gn_table_between(t, 0.01, 0.01) == 0.0);
    world_end(w);
}

/* Checks see motions by samples, of which there are 1024 in the time of the scene. */
static void an_oscillation_with_the_frequency_of_the_samples_is_a_motion(void **state) {
    (void)state;
    gn_world *w = changed("vz: 0", "vz: 0.01*sin(2*pi*10240*t)");
    const gn_table *t = &w->ctx.scene.walls[0].motion.velocity[2];
    double most = 0.0;
    for (size_t k = 1; k < t->count; k++) {
        assert_true(t->time[k] > t->time[k - 1]);
        most = fmax(most, fabs(t->value[k]));
    }
    assert_true(most > 0.0099 && t->time[0] == 0.0 && t->time[t->count - 1] == 0.1);
    world_end(w);
}

/* --- loads --- */

/* Free fall in g sin(w t): v = g/w (1 - cos w t), x = g/w (t - sin(w t)/w). The error of leap-frog
 * falls with the square of the step. */
static void free_fall_in_an_oscillating_gravity_has_the_closed_form(void **state) {
    (void)state;
    double wrong[2];
    for (int k = 0; k < 2; k++) {
        text *t = calloc(1, sizeof *t);
        const char *at = strstr(ball, "step: 1e-5");
        add(t, "%.*sgravity: [0, 0, 9.81*sin(2*pi*20*t)]\ntime: {step: %g, end: 0.1}\n",
            (int)(at - ball) - (int)strlen("time: {"), ball, k ? 1e-5 : 2e-5);
        gn_world *w = world_of("%s", t->s);
        run_until(w, 0.03);
        const double n = 2.0 * pi * 20.0, now = w->ctx.time;
        wrong[k] = pos_of(w, 0)[2] - 5e-3 - 9.81 / n * (now - sin(n * now) / n);
        assert_near(wrong[k], 0.0, 1e-8);
        measured_step(w);
        const double speed = 9.81 / n * (1.0 - cos(n * now));
        assert_near(w->ledger.reading.work_gravity / (0.5 * mass_of(w, 0) * speed * speed), 1.0,
                    1e-3);
        free(t);
        world_end(w);
    }
    assert_near(wrong[0] / wrong[1], 4.0, 0.1);
}

/* A particle on a bond to a held one: x'' = -w0^2 x + (F/m) sin(w t) from rest has the solution
 * F/m/(w0^2 - w^2) (sin w t - w/w0 sin w0 t). */
static void a_sinusoidal_force_on_a_spring_has_the_closed_form(void **state) {
    (void)state;
    double wrong[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w =
            world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]}\n"
                     "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0, "
                     "bond_tension_limit: 1e12, bond_shear_limit: 1e12}]\n"
                     "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\nsets:\n"
                     "- {name: held, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0}}\n"
                     "- {name: driven, select: {ids: [1]}, force: ['0.1*sin(2*pi*1000*t)', 0, 0]}\n"
                     "time: {step: %g, end: 0.01}\nrun: {threads: 1}\n",
                     k ? 5e-7 : 1e-6);
        const double mass = mass_of(w, 1), w0 = sqrt(1e5 / mass), n = 2.0 * pi * 1000.0;
        wrong[k] = 0.0;
        while (w->ctx.time < 2e-3) {
            run_steps(w, 1);
            const double at = w->ctx.time,
                         x = 0.1 / mass / (w0 * w0 - n * n) * (sin(n * at) - n / w0 * sin(w0 * at));
            wrong[k] = fmax(wrong[k], fabs(pos_of(w, 1)[0] - 2e-3 - x));
        }
        assert_true(wrong[k] < 2e-2 * 0.1 / 1e5);
        measured_step(w);
        assert_true(fabs(w->ledger.reading.work_applied) > 0.0);
        assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-9);
        world_end(w);
    }
    assert_near(wrong[0] / wrong[1], 4.0, 0.2);
}

static void a_table_and_a_formula_push_sets_and_bodies_alike(void **state) {
    (void)state;
    const char *const force[] = {"[[0, 0], [1e-3, 2e-5]]", "'min(t/1e-3, 1)*2e-5'"};
    double speed[2][2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm], [9 mm, 0, 0, 1 mm]], group: 0}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
            "law: {stiffness: uniform}\n"
            "sets: [{name: a, select: {ids: [1]}, force: [0, %s, 0]}]\n"
            "bodies: [{name: b, box: {size: [1 mm, 1 mm, 1 mm]}, origin: [0, 0, 9 mm], stiffness: "
            "1e5, free: true, mass: 1 kg, force: [0, %s, 1 N]}]\n"
            "time: {step: 1e-6, end: 0.01}\nrun: {threads: 1}\n",
            force[k], force[k]);
        run_until(w, 2e-3);
        speed[k][0] = vel_of(w, 1)[1];
        speed[k][1] = w->boundary.bodies[0].velocity[1];
        if (k == 0) {
            const double impulse = 2e-5 * (0.5e-3 + 1e-3); /* N s, up to half a step */
            assert_near(speed[k][0] * mass_of(w, 1), impulse, 2e-5 * 1e-6);
            assert_near(speed[k][1], impulse, 2e-5 * 1e-6);
            assert_near(w->boundary.bodies[0].velocity[2], 2e-3, 1e-6);
        }
        world_end(w);
    }
    for (int k = 0; k < 2; k++) assert_close(speed[1][k], speed[0][k], 1e-12);
}

/* --- errors of a run, copies and stages --- */

static void a_value_that_is_no_number_stops_the_run_with_its_name(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_world *w = changed("vz: 0", "vz: 0.01*sqrt(1 - 100*t)");
    gneiss_status status = GNEISS_OK;
    while (status == GNEISS_OK && w->ctx.time < 0.05) status = gn_world_step(w, false, &error);
    assert_int_equal(status, GNEISS_ERROR_UNSTABLE);
    assert_near(w->ctx.time, 0.01, 2e-5);
    if (!strstr(error.message, "walls[0].motion.vz") || !strstr(error.message, "sqrt(1 - 100*t)") ||
        !strstr(error.message, "nan at t = 0.01"))
        fail_msg("%s", error.message);
    world_end(w);
}

static void a_formula_survives_writing_and_copying(void **state) {
    (void)state;
    gn_world *w = changed("vz: 0", "vz: \"0.1*sin(2*pi*t) + (t > 1 ? 1 : 0)\"");
    char *written = gn_scene_write(&w->ctx.given);
    gneiss_error error = {0};
    gn_scene *read = calloc(2, sizeof *read);
    assert_non_null(strstr(written, "\"0.1*sin(2*pi*t) + (t > 1 ? 1 : 0)\""));
    if (gn_scene_parse(written, "again", NULL, NULL, 0, read, &error))
        fail_msg("%s", error.message);
    assert_int_equal(gn_scene_copy(read, read + 1, &error), GNEISS_OK);
    gn_scene_free(read);
    const gn_table *own = &w->ctx.scene.walls[0].motion.velocity[2],
                   *copy = &read[1].walls[0].motion.velocity[2];
    for (int k = 0; k < 20; k++)
        assert_true(gn_table_at(own, 0.013 * k) == gn_table_at(copy, 0.013 * k));
    gn_scene_free(read + 1);
    free(read);
    free(written);
    world_end(w);
}

/* A shaken box of grains: gravity, a floor, a servo and the force of a set follow formulas. */
static gn_run *shaken(int threads) {
    return run_of(
        "dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: "
        "1.02, jitter: 0.05, origin: [0, 0, 0]}, group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 2, friction: 0.4}]\n"
        "law: {stiffness: uniform}\ndamping: {contact: {restitution: 0.5}}\n"
        "gravity: [3*sin(300*t), 0, -9.81*(1 + 0.5*cos(200*t))]\n"
        "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
        "sets: [{name: s, select: {ids: [7, 20]}, force: [0, '1e-3*sin(500*t)', 0]}]\nwalls:\n"
        "- {name: x0, point: [-1 mm, 0, 0], normal: [1, 0, 0], stiffness: 1e5}\n"
        "- {name: x1, point: [12 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5}\n"
        "- {name: y0, point: [0, -1 mm, 0], normal: [0, 1, 0], stiffness: 1e5}\n"
        "- {name: y1, point: [0, 12 mm, 0], normal: [0, -1, 0], stiffness: 1e5}\n"
        "- {name: z0, point: [0, 0, -1 mm], normal: [0, 0, 1], stiffness: 1e5, motion: {vz: "
        "0.02*sin(400*t)}}\n"
        "- {name: z1, point: [0, 0, 12 mm], normal: [0, 0, -1], stiffness: 1e5, servo: {force: "
        "'0.1 + 0.05*sin(100*t)', max_velocity: 0.5}}\n"
        "time: {end: 1}\nrun: {threads: %d}\n",
        threads);
}

static void a_resumed_run_has_the_same_bits(void **state) {
    (void)state;
    const gn_energy e = end_alike(shaken(1), shaken(2), 400, 400, 1e-3);
    assert_true(fabs(e.work_gravity) > 0.0 && fabs(e.work_applied) > 0.0 && e.work_walls != 0.0);
}

/* A body of elements that falls in g cos(w t) as a whole: its momentum is m g/w sin(w t). */
static void elements_fall_in_a_gravity_that_varies(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\ngravity: [0, 0, -9.81*cos(2*pi*50*t)]\n"
                 "elements: {box: {size: [1 mm, 1 mm, 1 mm], cells: [1, 1, 1]}, materials: "
                 "[{young: 1e8, poisson: 0.2, density: 2500}]}\n"
                 "time: {end: 1}\nrun: {threads: 1}\n");
    run_until(w, 5e-3);
    const double n = 2.0 * pi * 50.0, middle = w->ctx.time - 0.5 * w->ctx.dt_past;
    const gn_particles *q = &w->solids.elements[0]->solid.nodes;
    for (size_t k = 0; k < q->soa.count; k++)
        assert_near(q->vel[4 * k + 2], -9.81 / n * sin(n * middle), 1e-5 * 9.81 / n);
    world_end(w);
}

static void in_a_stage_t_counts_from_its_start(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_world *w = world_of("%sstages:\n- {name: a, end: {time: 2 ms}}\n"
                           "- {name: b, walls: {floor: {motion: {vz: 3*t}}}, end: {time: 2 ms}}\n",
                           ball);
    run_until(w, 2e-3);
    const double begun = w->ctx.time;
    assert_int_equal(gn_world_enter(w, 1, &error), GNEISS_OK);
    run_steps(w, 50);
    assert_near(w->boundary.walls[0].velocity[2], 3.0 * (w->ctx.time - 0.5e-5 - begun), 1e-12);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_text_with_the_name_t_is_a_formula),
        cmocka_unit_test(formulas_have_the_values_of_mathematics),
        cmocka_unit_test(what_is_wrong_in_a_formula_is_refused_at_its_place),
        cmocka_unit_test(a_formula_is_evaluated_where_a_table_is),
        cmocka_unit_test(the_path_of_a_cosine_is_the_sine_to_second_order),
        cmocka_unit_test(the_integral_of_a_formula_is_that_of_mathematics),
        cmocka_unit_test(an_oscillation_with_the_frequency_of_the_samples_is_a_motion),
        cmocka_unit_test(free_fall_in_an_oscillating_gravity_has_the_closed_form),
        cmocka_unit_test(a_sinusoidal_force_on_a_spring_has_the_closed_form),
        cmocka_unit_test(a_table_and_a_formula_push_sets_and_bodies_alike),
        cmocka_unit_test(a_value_that_is_no_number_stops_the_run_with_its_name),
        cmocka_unit_test(a_formula_survives_writing_and_copying),
        cmocka_unit_test(a_resumed_run_has_the_same_bits),
        cmocka_unit_test(elements_fall_in_a_gravity_that_varies),
        cmocka_unit_test(in_a_stage_t_counts_from_its_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
