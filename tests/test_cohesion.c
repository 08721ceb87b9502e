/* Attraction of loose grains against closed forms: JKR, DMT and liquid bridges, between spheres and
 * at walls; the ledger, the liquid, and what scenes may ask for. */
#include "frame/feature.h"
#include "kernels/law.h"
#include "particles/bridges.h"
#include "world_helpers.h"

static const double r = 1e-3, young = 1e7, poisson = 0.3, density = 2500, work = 0.2;

/* E* of two equal spheres, or of one at a rigid wall. */
static double modulus_of(bool wall) {
    return young / (1.0 - poisson * poisson) * (wall ? 1.0 : 0.5);
}
static double radius_of(bool wall) {
    return wall ? r : 0.5 * r;
}

#define MATTER "materials: [{name: m, density: 2500, young: 1e7, poisson: 0.3%s}]\n"
static const char jkr[] = ", cohesion: jkr", dmt[] = ", cohesion: dmt",
                  liquid[] = ", cohesion: liquid, surface_tension: 0.07, contact_angle: 20 deg, "
                             "liquid_content: 0.05";

/* A sphere whose surface is `gap` away from another one below it, or from a wall, and which moves
 * by the table `vz`. The sphere below stands still. */
static gn_world *moved(const char *law, bool wall, double gap, const char *vz, const char *vx,
                       double step, const char *matter) {
    text t = {0};
    add(&t, "dimension: 3\nspecimen: {particles: [[0, 0, %.17g, %.17g]", r + gap, r);
    if (!wall) add(&t, ", [0, 0, %.17g, %.17g]", -r, r);
    add(&t, "], group: 0}\n" MATTER "law: {stiffness: hertz%s}\n", matter, law);
    add(&t,
        "sets:\n  - {name: a, select: {ids: [0]}, motion: {vx: %s, vy: 0, vz: %s, wx: 0, wy: 0, "
        "wz: 0}}\n",
        vx, vz);
    if (wall)
        add(&t, "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], friction: %s}]\n",
            strstr(matter, "friction") ? "0.3" : "0");
    else
        add(&t, "  - {name: b, select: {ids: [1]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, "
                "wz: 0}}\n");
    add(&t, "time: {step: %.17g, end: 1}\nrun: {threads: 1}\n", step);
    return world_of("%s", t.s);
}

/* The force on the upper sphere, N, at the instant before the step, upwards positive; that of
 * prescribed motion is the opposite. */
static double force_up(gn_world *w, bool wall) {
    run_steps(w, 1);
    const double force = wall ? -w->boundary.walls[0].force[2] : -w->dem.set_reaction[2];
    return fabs(force) > 1e-15 ? force : 0.0; /* the reaction has the rounding of the motion */
}

/* Tells whether the motion turned in the last step, so that the reaction has its inertia. */
static bool turns(const gn_world *w, double from, double to) {
    return w->ctx.time > from - w->ctx.dt && w->ctx.time < to + 3.0 * w->ctx.dt;
}

static double gap_of(const gn_world *w) {
    return pos_of(w, 0)[2] - r;
}

/* --- JKR --- */

typedef struct circle {
    double overlap, force; /* m, N, compression positive */
} circle;

/* The contact of radius a (Johnson, Kendall and Roberts 1971). */
static circle circle_of(double a, bool wall) {
    const double e = modulus_of(wall), R = radius_of(wall);
    return (circle){a * a / R - sqrt(2.0 * pi * work * a / e),
                    4.0 * e * a * a * a / (3.0 * R) - sqrt(8.0 * pi * work * e * a * a * a)};
}

/* The radius at which a contact separates. */
static double least_radius(bool wall) {
    return cbrt(pi * work * radius_of(wall) * radius_of(wall) / (8.0 * modulus_of(wall)));
}

/* The radius of a contact at an overlap, by bisection. */
static double radius_at(double overlap, bool wall) {
    double low = least_radius(wall), high = r;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (low + high);
        *(circle_of(middle, wall).overlap < overlap ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

/* The work, J, to pull a contact from u = 0 to its separation: the integral of the force over the
 * radius of the contact, in which it is smooth (Simpson). */
static double work_of_separation(bool wall) {
    enum { PARTS = 20000 };
    const double from = radius_at(0.0, wall), to = least_radius(wall), h = (to - from) / PARTS;
    double sum = 0.0;
    for (int k = 0; k <= PARTS; k++) {
        const double a = from + k * h, R = radius_of(wall);
        const double slope =
            2.0 * a / R - 0.5 * sqrt(2.0 * pi * work / (modulus_of(wall) * a)); /* du/da */
        sum += (k == 0 || k == PARTS ? 1.0 : k % 2 ? 4.0 : 2.0) * circle_of(a, wall).force * slope;
    }
    return sum * h / 3.0;
}

static double span_of(bool wall) {
    return -circle_of(least_radius(wall), wall).overlap;
}

/* The sphere is pressed by five spans and pulled off slowly. */
static void a_jkr_contact_pulls_off_by_its_closed_forms(void **state) {
    (void)state;
    for (int wall = 0; wall < 2; wall++) {
        const double span = span_of(wall), v = 1e-3, step = span / v / 5000.0;
        char table[256];
        snprintf(table, sizeof table, "[[0, %g], [%.17g, %g], [%.17g, %g], [1, %g]]", -v,
                 6.0 * span / v, -v, 6.001 * span / v, v, v);
        const double turn = 6.0 * span / v;
        gn_world *w = moved(jkr, wall, span, table, "0", step, ", adhesion: 0.2");
        double most = 0.0, closed = 0.0, opened = 0.0, last = 0.0;
        for (int k = 0; k < 80000 && opened == 0.0; k++) {
            const double gap = gap_of(w), force = force_up(w, wall);
            if (closed == 0.0 && force != 0.0) closed = gap;
            if (closed != 0.0 && k > 1) {
                const bool joined = last == 0.0, parted = gap > span;
                if (!joined && !parted && !turns(w, turn, 1.001 * turn))
                    assert_near(force, circle_of(radius_at(-gap, wall), wall).force,
                                1e-9 * work * r);
                if (parted && opened == 0.0) opened = gap;
            }
            if (last != 0.0 && !turns(w, turn, 1.001 * turn)) most = fmax(most, -force);
            if (opened == 0.0) last = force;
        }
        assert_near(closed, 0.0, 1.001 * v * step); /* no force before the surfaces touch */
        assert_near(most, 1.5 * pi * work * radius_of(wall), 1e-6 * most);
        assert_near(opened, span, 1.001 * v * step);
        assert_near(-last, 5.0 / 6.0 * pi * work * radius_of(wall), 0.03 * -last);
        assert_true(force_up(w, wall) == 0.0);
        const gn_energy e = measured_step(w);
        assert_near(e.cohesion, work_of_separation(wall), 1e-6 * e.cohesion);
        assert_true(e.elastic_normal == 0.0 && e.elastic_wall == 0.0);
        world_end(w);
    }
}

static double mass_of_pair(bool wall) {
    return sphere_mass(density, r) * (wall ? 1.0 : 0.5);
}

/* A free sphere just above another one, or a wall, that approaches with the speed v. */
static gn_world *thrown(const char *law, bool wall, double gap, double v, double step,
                        const char *matter) {
    text t = {0};
    add(&t, "dimension: 3\nspecimen: {particles: [[0, 0, %.17g, %.17g]", r + gap, r);
    if (!wall) add(&t, ", [0, 0, %.17g, %.17g]", -r, r);
    add(&t, "], group: 0}\n" MATTER "law: {stiffness: hertz%s}\n", matter, law);
    add(&t, "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [0, 0, %.17g]}\n", -v);
    if (wall) add(&t, "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1]}]\n");
    add(&t, "time: {step: %.17g, end: 1}\nrun: {threads: 1}\n", step);
    return world_of("%s", t.s);
}

static double kinetic_of(const gn_world *w, bool wall) {
    const double v = vel_of(w, 0)[2] - (wall ? 0.0 : vel_of(w, 1)[2]);
    return 0.5 * mass_of_pair(wall) * v * v;
}

/* Thornton and Ning 1998: an elastic impact loses the work 7.09 (w^5 R^4/E*^2)^(1/3), and a sphere
 * slower than that sticks. */
static void a_jkr_impact_loses_the_work_of_separation(void **state) {
    (void)state;
    for (int wall = 0; wall < 2; wall++) {
        const double lost = work_of_separation(wall), m = mass_of_pair(wall);
        const double R = radius_of(wall), e = modulus_of(wall);
        const double slow = sqrt(2.0 * lost / m), step = 2e-8;
        assert_near(lost, 7.09 * cbrt(pow(work, 5.0) * pow(R, 4.0) / (e * e)), 1e-3 * lost);
        for (int k = 0; k < 3; k++) {
            const double v = slow * (k == 0 ? 0.99 : k == 1 ? 1.01 : 4.0);
            gn_world *w = thrown(jkr, wall, 1.3 * v * step, v, step, ", adhesion: 0.2");
            measured_step(w);
            run_steps(w, k == 2 ? 20000 : 60000);
            const gn_energy after = measured_step(w);
            const double away = pos_of(w, 0)[2] - r - (wall ? 0.0 : pos_of(w, 1)[2] + r);
            if (k == 0) {
                assert_true(away < span_of(wall));
            } else {
                assert_true(away > span_of(wall));
                assert_near(kinetic_of(w, wall), 0.5 * m * v * v - lost, 1e-5 * lost);
                assert_near(after.cohesion, lost, 1e-9 * lost);
            }
            assert_true(fabs(gn_energy_residual(&after)) < 1e-5);
            world_end(w);
        }
    }
}

/* The step of the sum over steps is long; the phase at which it begins varies. */
static void a_jkr_impact_in_few_steps_hardly_depends_on_their_phase(void **state) {
    (void)state;
    enum { PHASES = 10 };
    const double lost = work_of_separation(true), m = mass_of_pair(true);
    const double v = 3.0 * sqrt(2.0 * lost / m), step = 4e-6; /* some forty steps in contact */
    for (int k = 0; k < PHASES; k++) {
        gn_world *w = thrown(jkr, true, 2.0 * v * step, v, step, ", adhesion: 0.2");
        w->dem.particles.pos[2] += k * v * step / PHASES;
        run_steps(w, 300);
        assert_true(gap_of(w) > span_of(true));
        assert_near(kinetic_of(w, true), 0.5 * m * v * v - lost, 0.05 * lost);
        world_end(w);
    }
}

/* --- DMT --- */

static void a_dmt_contact_adds_a_constant_to_hertz(void **state) {
    (void)state;
    for (int wall = 0; wall < 2; wall++) {
        const double v = 1e-3, step = 1e-6, R = radius_of(wall);
        gn_world *w = moved(dmt, wall, 1e-7, "[[0, -1e-3], [2e-3, -1e-3], [2.01e-3, 1e-3]]", "0",
                            step, ", adhesion: 0.2");
        double most = 0.0;
        int seen = 0;
        for (int k = 0; k < 5000; k++) {
            const double gap = gap_of(w), force = force_up(w, wall), u = fmax(-gap, 0.0);
            const double hertz = 4.0 / 3.0 * modulus_of(wall) * sqrt(R) * pow(u, 1.5);
            if (turns(w, 2e-3, 2.01e-3)) continue;
            most = fmax(most, u > 2.0 * v * step ? -force : 0.0);
            if (u > 2.0 * v * step)
                assert_near(force, hertz - 2.0 * pi * work * R, 1e-9 * work * r);
            if (gap > 2.0 * v * step) assert_true(force == 0.0);
            seen += u > 2.0 * v * step;
        }
        assert_true(seen > 3000);
        assert_near(most, 2.0 * pi * work * R, 1e-4 * most); /* less Hertz's force of two steps */
        world_end(w);
    }
}

/* There is no neck, so that no work is lost. */
static void a_dmt_impact_is_elastic(void **state) {
    (void)state;
    for (int wall = 0; wall < 2; wall++)
        for (int k = 0; k < 4; k++) {
            const double step = 2e-7, v = 0.05;
            gn_world *w =
                thrown(dmt, wall, (1.0 + 0.25 * k) * v * step, v, step, ", adhesion: 0.02");
            measured_step(w);
            run_steps(w, 4000);
            const gn_energy e = measured_step(w);
            assert_true(vel_of(w, 0)[2] > (wall ? 0.0 : vel_of(w, 1)[2]));
            assert_near(kinetic_of(w, wall), 0.5 * mass_of_pair(wall) * v * v,
                        1e-5 * mass_of_pair(wall) * v * v);
            assert_true(e.cohesion == 0.0 && fabs(gn_energy_residual(&e)) < 1e-5);
            world_end(w);
        }
}

/* --- liquid bridges --- */

static double content_of(void) {
    return 0.05 * 4.0 / 3.0 * pi * r * r * r;
}

/* The volume of the first bridge: of both films the cap within the touching cone of 30 degrees; at
 * a wall half of the film. */
static double first_volume(bool wall) {
    return wall ? 0.5 * content_of() : (1.0 - cos(pi / 6.0)) * content_of();
}

/* Willett et al. 2000, eq. 12, with half the separation; Derjaguin's approximation at walls. */
static double bridge_force(double gap, double volume, bool wall) {
    const double sphere = 2.0 * radius_of(wall);
    const double s = 0.5 * gap / sqrt(volume / sphere);
    return 2.0 * pi * sphere * 0.07 * cos(20.0 * pi / 180.0) / (1.0 + 2.1 * s + 10.0 * s * s);
}

static double rupture_of(double volume) {
    return (1.0 + 0.5 * 20.0 * pi / 180.0) * cbrt(volume);
}

static double bridge_work(double volume, bool wall) {
    enum { PARTS = 20000 };
    const double h = rupture_of(volume) / PARTS;
    double sum = 0.0;
    for (int k = 0; k <= PARTS; k++)
        sum += (k == 0 || k == PARTS ? 1.0 : k % 2 ? 4.0 : 2.0) * bridge_force(k * h, volume, wall);
    return sum * h / 3.0;
}

static double all_liquid(const gn_world *w) {
    const gn_liquid l = gn_bridges_sum(&w->ctx, &w->dem);
    double sum = l.bridged + l.films;
    for (size_t c = 0; c < w->boundary.contacts.soa.count; c++)
        sum += w->boundary.contacts.bridge[c];
    return sum;
}

static double bridge_now(gn_world *w, bool wall) {
    gn_active_pairs_settle(&w->ctx, &w->dem);
    return wall ? w->boundary.contacts.bridge[0] : w->dem.pairs.contacts.bridge[0];
}

static void a_bridge_forms_on_touch_and_ruptures_at_its_distance(void **state) {
    (void)state;
    for (int wall = 0; wall < 2; wall++) {
        const double volume = first_volume(wall), far = rupture_of(volume), v = 0.1;
        const double step = far / v / 5000.0;
        char table[256];
        snprintf(table, sizeof table, "[[0, %g], [%.17g, %g], [%.17g, %g], [1, %g]]", -v,
                 0.02 * far / v, -v, 0.0201 * far / v, v, v);
        gn_world *w = moved(liquid, wall, 0.01 * far, table, "0", step, "");
        const double total = all_liquid(w);
        assert_near(total, (wall ? 1.0 : 2.0) * content_of(), 1e-15 * total);
        double opened = 0.0, most = 0.0;
        bool bridged = false;
        int compared = 0;
        for (int k = 0; k < 8000 && opened == 0.0; k++) {
            const double gap = gap_of(w), held = k ? bridge_now(w, wall) : 0.0;
            const double force = force_up(w, wall);
            if (!bridged && held == 0.0 && gap > 0.0) assert_true(force == 0.0);
            if (held > 0.0 && bridged && gap < far && gap > 0.0 &&
                !turns(w, 0.02 * far / v, 0.0201 * far / v)) {
                assert_near(-force, bridge_force(gap, volume, wall),
                            1e-9 * bridge_force(0, volume, wall));
                compared++;
            }
            most = fmax(most, -force);
            if (bridged && gap > far) opened = gap;
            bridged = held > 0.0;
            if (bridged) assert_near(held, volume, 1e-14 * volume);
            assert_near(all_liquid(w), total, 4e-16 * total);
        }
        assert_true(compared > 4000);
        assert_near(opened, far, 1.001 * v * step);
        run_steps(w, 2);
        assert_true(bridge_now(w, wall) == 0.0 && force_up(w, wall) == 0.0);
        const gn_energy e = measured_step(w);
        assert_near(e.cohesion, bridge_work(volume, wall), 1e-6 * e.cohesion);
        assert_true(e.elastic_normal == 0.0 && e.elastic_wall == 0.0);
        /* The sphere has its liquid back, half of that of a bridge between two. */
        assert_near(w->dem.particles.film[0], content_of(), 1e-15 * content_of());
        world_end(w);
    }
}

/* The shares of two unequal grains differ, and a rupture gives half to each. */
static void unequal_grains_exchange_liquid(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [0, 0, 3.0001e-3, 2e-3]], group: "
        "0}\n" MATTER "law: {stiffness: hertz%s}\nsets:\n"
        "  - {name: a, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: [[0, 0.1], [2e-3, 0.1], "
        "[2.1e-3, -0.5]], wx: 0, wy: 0, wz: 0}}\n"
        "  - {name: b, select: {ids: [1]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
        "time: {step: 1e-5, end: 1}\nrun: {threads: 1}\n",
        "", liquid);
    const double first = content_of(), second = 8.0 * first;
    const double one = 0.5 * (1.0 - sqrt(1.0 - 4.0 / 9.0)) * first,
                 two = 0.5 * (1.0 - sqrt(1.0 - 1.0 / 9.0)) * second;
    run_steps(w, 150);
    assert_near(bridge_now(w, false), one + two, 1e-14 * (one + two));
    run_steps(w, 1000);
    assert_true(bridge_now(w, false) == 0.0);
    const int32_t at = w->dem.index_of_id[0], to = w->dem.index_of_id[1];
    assert_near(w->dem.particles.film[at], first - one + 0.5 * (one + two), 1e-15 * second);
    assert_near(w->dem.particles.film[to], second - two + 0.5 * (one + two), 1e-15 * second);
    world_end(w);
}

/* --- friction --- */

/* Pressed by nothing but the attraction, a sphere that is dragged slides at mu (f + P). On another
 * sphere the line of the centres turns by 1.5e-3. */
static void friction_follows_the_force_between_the_solids(void **state) {
    (void)state;
    const char *const laws[] = {jkr, dmt, liquid};
    for (int k = 0; k < 3; k++)
        for (int wall = 0; wall < 2; wall++) {
            gn_world *w = moved(laws[k], wall, -1e-6, "0", "[[0, 0], [1e-5, 0.01]]", 1e-6,
                                k < 2 ? ", friction: 0.3, adhesion: 0.2" : ", friction: 0.3");
            run_steps(w, 300);
            const double u = 1e-6 - 0.25 * pow(pos_of(w, 0)[0], 2.0) / r * !wall;
            const double up = force_up(w, wall), across = w->dem.set_reaction[0];
            const double R = radius_of(wall), neck = circle_of(radius_at(u, wall), wall).force;
            const double hertz = 4.0 / 3.0 * modulus_of(wall) * sqrt(R) * pow(u, 1.5);
            const double pressed = k == 0 ? neck + 3.0 * pi * work * R : hertz;
            const double volume = 0.5 * content_of();
            const double total = k == 0   ? neck
                                 : k == 1 ? hertz - 2.0 * pi * work * R
                                          : hertz - bridge_force(0.0, volume, wall);
            const double slack = (wall ? 1e-9 : 3e-3) * (pressed + fabs(total));
            assert_near(up, total, slack);
            assert_near(across, 0.3 * pressed, slack);
            world_end(w);
        }
}

/* --- many grains --- */

/* Grains of two sizes that collide in a periodic box. */
static gn_world *gas(const char *law, const char *more, int threads) {
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [6, 6, 6], spacing: "
        "1.03, jitter: 0.02}, group: 0}\n"
        "materials: [{name: m, density: 2500, young: 1e7, poisson: 0.3, friction: 0.3%s}]\n"
        "law: {stiffness: hertz%s}\ninitial: {random_velocity: 0.03}\n"
        "periodic: {min: [-1e-3, -1e-3, -1e-3], max: [11.4e-3, 11.4e-3, 11.4e-3]}\n"
        "time: {end: 1}\nrun: {threads: %d}\n",
        more, law, threads);
    return w;
}

static const struct {
    const char *law, *matter;
} kinds[] = {{jkr, ", adhesion: 0.2"},
             {dmt, ", adhesion: 0.2"},
             {liquid, ""},
             {jkr, ", adhesion: 0.2, rolling_friction: 0.2, restitution: 0.8"},
             {liquid, ", rolling_friction: 0.2, twisting_friction: 0.1, restitution: 0.8"}};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void the_ledger_closes_and_liquid_is_kept(void **state) {
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        gn_world *w = gas(kinds[k].law, kinds[k].matter, 1);
        measured_step(w);
        const double total = all_liquid(w);
        run_steps(w, 3000);
        const gn_energy e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 2e-3);
        if (kinds[k].law != dmt) assert_true(e.cohesion > 0.05 * e.stored_at_start);
        assert_near(all_liquid(w), total, 1e-14 * total);
        if (kinds[k].law == liquid) assert_true(gn_bridges_sum(&w->ctx, &w->dem).bridges > 50);
        world_end(w);
    }
}

static void threads_change_no_bit(void **state) {
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        gn_world *one = gas(kinds[k].law, kinds[k].matter, 1),
                 *two = gas(kinds[k].law, kinds[k].matter, 2);
        run_steps(one, 500);
        run_steps(two, 500);
        assert_true(gn_world_hash(&one->ctx, &one->dem, &one->boundary, &one->solids, &one->box) ==
                    gn_world_hash(&two->ctx, &two->dem, &two->boundary, &two->solids, &two->box));
        world_end(one);
        world_end(two);
    }
}

/* --- steps and keys --- */

/* The stiffness of a pressed contact is below that for which the step is checked. */
static void no_contact_is_stiffer_than_the_step_allows_for(void **state) {
    (void)state;
    const gn_scene scene = {.cohesion = GN_COHESION_JKR, .dimension = 3, .restitution = -1.0};
    const gn_material m = {
        .young = young, .poisson = poisson, .adhesion = work, .restitution = -1.0};
    const gn_law_model model = {.scene = &scene};
    const gn_law_pair pair = {.a = &m, .b = &m, .ri = r, .rj = r};
    const gn_law *law = gn_law_of(GN_FX_HERTZ | GN_FX_COHESION);
    const double span = span_of(false);
    for (double u = -0.999 * span; u < 20.0 * span; u += 0.01 * span) {
        const double h = 1e-4 * span;
        const double slope = (circle_of(radius_at(u + h, false), false).force -
                              circle_of(radius_at(u - h, false), false).force) /
                             (2.0 * h);
        const gn_law_spring most = law->meeting(&model, &pair, fmax(u, 1e-9 * span));
        assert_true(slope < most.kn);
        /* Far above the span it is Hertz's stiffness. */
        if (u > 15.0 * span) assert_true(most.kn < 1.3 * slope);
    }
}

static void scenes_without_attraction_have_no_part_of_it(void **state) {
    (void)state;
    gn_world *w = gas("", "", 1);
    run_steps(w, 1);
    assert_null(w->dem.pairs.contacts.adhesion);
    assert_null(w->dem.pairs.contacts.bridge);
    assert_null(w->dem.particles.film);
    assert_true(w->dem.verlet.reach == 0.0);
    assert_false(gn_feature_bridges.used(w));
    assert_ptr_equal(gn_law_of(w->dem.pairs.contacts.soa.effects), &gn_law_hertz);
    world_end(w);
}

static void scenes_say_what_attraction_needs(void **state) {
    (void)state;
    static const char scene[] =
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3]], group: 0}\n"
        "materials: [{name: m, density: 2500, young: 1e7, poisson: 0.3, adhesion: 0.1}]\n"
        "law: {stiffness: hertz, cohesion: jkr}\ntime: {end: 1}\n";
    assert_change_refused(scene, ", adhesion: 0.1", "", "adhesion above 0");
    assert_change_refused(scene, "cohesion: jkr", "cohesion: liquid", "law.surface_tension");
    assert_change_refused(scene, "cohesion: jkr", "cohesion: liquid, surface_tension: 0.07",
                          "law.liquid_content");
    assert_change_refused(scene, "cohesion: jkr", "cohesion: jkr, liquid_content: 0.1",
                          "law.liquid_content");
    assert_change_refused(scene, "cohesion: jkr",
                          "cohesion: liquid, surface_tension: 0.07, liquid_content: 0.1, "
                          "contact_angle: 60 deg",
                          "law.contact_angle");
    assert_change_refused(scene, "time:", "run: {precision: mixed}\ntime:", "law.cohesion");
    assert_change_refused(
        scene, "time:", "elements: {mesh: {box: {size: [1, 1, 1], cells: [1, 1, 1]}}}\ntime:", "");
    assert_change_refused(
        scene, "young: 1e7, poisson: 0.3, adhesion: 0.1}]\nlaw: {stiffness: hertz",
        "normal_stiffness: 1e5, kratio: 2}]\nlaw: {stiffness: uniform", "law.cohesion");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_jkr_contact_pulls_off_by_its_closed_forms),
        cmocka_unit_test(a_jkr_impact_loses_the_work_of_separation),
        cmocka_unit_test(a_jkr_impact_in_few_steps_hardly_depends_on_their_phase),
        cmocka_unit_test(a_dmt_contact_adds_a_constant_to_hertz),
        cmocka_unit_test(a_dmt_impact_is_elastic),
        cmocka_unit_test(a_bridge_forms_on_touch_and_ruptures_at_its_distance),
        cmocka_unit_test(unequal_grains_exchange_liquid),
        cmocka_unit_test(friction_follows_the_force_between_the_solids),
        cmocka_unit_test(the_ledger_closes_and_liquid_is_kept),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(no_contact_is_stiffer_than_the_step_allows_for),
        cmocka_unit_test(scenes_without_attraction_have_no_part_of_it),
        cmocka_unit_test(scenes_say_what_attraction_needs),
    };
    return cmocka_run_group_tests_name("cohesion", tests, NULL, NULL);
}
