/* Lists that are wide enough: bounds on the approach of pairs that were not listed. */
#include "particles/lists.h"
#include "particles/particles.h"
#include "world_helpers.h"

/* Grains in a periodic box, loose and thinly spread, that stream along x and have random velocities
 * of `own` m/s; with `opposed` the upper half streams in the other direction. */
static gn_world *stream(double speed, double own, bool opposed, const char *more) {
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [8, 6, 10], "
        "spacing: 1.15, jitter: 0.05}, group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e4, kratio: 2, friction: 0.4}]\n"
        "law: {stiffness: uniform}\ndamping: {contact: {restitution: 0.6}}\n"
        "initial: {random_velocity: %g}\n"
        "%sneighbours: {skin: 4e-4}\ntime: {step: 4e-6, end: 1}\nrun: {threads: 1}\n",
        own, more);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const bool back = opposed && w->dem.particles.pos[4 * p + 2] > 12e-3;
        w->dem.particles.vel[4 * p] += back ? -speed : speed;
    }
    return w;
}

static const char box[] = "periodic: {min: [-2e-3, -2e-3, -2e-3], max: [22e-3, 16e-3, 26e-3]}\n";

/* Every pair that touches is listed, whatever was left out of the lists. */
static void look_at_all_pairs(const gn_world *w, size_t *touching) {
    const gn_particles *q = &w->dem.particles;
    for (size_t i = 0; i < q->soa.count; i++)
        for (size_t j = i + 1; j < q->soa.count; j++) {
            const double *x = q->pos + 4 * i, *y = q->pos + 4 * j;
            double d[3], gap = sqrt(gn_branch(&w->ctx, x, y, d)) - x[3] - y[3];
            if (gap >= 0.0) continue;
            size_t c = gn_contacts_from(&w->dem.pairs.contacts, (int32_t)i, (int32_t)j);
            ++*touching;
            if (c >= w->dem.pairs.contacts.soa.count || w->dem.pairs.contacts.i[c] != (int32_t)i ||
                w->dem.pairs.contacts.j[c] != (int32_t)j)
                fail_msg("step %lld: %zu and %zu overlap by %g m and are not listed",
                         (long long)w->ctx.step, i, j, -gap);
        }
}

static int64_t lists_of(gn_world *w, int steps) {
    size_t touching = 0;
    for (int k = 0; k < steps; k += 25) {
        run_steps(w, 25);
        look_at_all_pairs(w, &touching);
    }
    assert_true(touching > 100); /* otherwise the test proves nothing */
    return w->dem.verlet.rebuilds;
}

/* 5 m/s is 20 skins in 400 steps for twice the travel of one particle; at a relative speed of 0.3
 * m/s one or two. */
static void a_uniform_stream_keeps_its_lists(void **state) {
    (void)state;
    gn_world *still = stream(0.0, 0.3, false, box), *flows = stream(5.0, 0.3, false, box);
    int64_t few = lists_of(still, 800), more = lists_of(flows, 800);
    const double way = 800 * 4e-6 * 5.0;
    print_message("# lists: %lld at rest, %lld in a stream that goes %g skins far\n",
                  (long long)few, (long long)more, way / 4e-4);
    /* Lists are made at most 8 skins of path apart, in addition to those that the specimen needs at
     * rest. */
    assert_true(more <= few + (int64_t)(way / (7.2 * 4e-4)) + 1);
    assert_true((double)more < 0.25 * 2.0 * way / 4e-4);
    world_end(still);
    world_end(flows);
}

/* Where two streams pass each other, lists are rebuilt once for every skin of relative travel. */
static void streams_that_pass_each_other_have_their_lists_made(void **state) {
    (void)state;
    gn_world *w = stream(2.0, 0.2, true, box);
    const double way = 800 * 4e-6 * 4.0;
    int64_t lists = lists_of(w, 800);
    print_message("# lists: %lld where streams pass each other by %g skins\n", (long long)lists,
                  way / 4e-4);
    /* Collisions dissipate most of the energy in the end. */
    assert_true((double)lists > 0.25 * way / 4e-4);
    world_end(w);
}

/* Two particles that are not in the list collide head on, wherever the boundaries of the cells are
 * and along any axis; neither has moved relative to its own neighbours. */
static void two_distant_particles_are_listed_before_they_touch(void **state) {
    (void)state;
    for (int k = 0; k < 36; k++) {
        const int axis = k % 3;
        const char *at[3] = {"[0, 0, 0, 1e-3], [3e-3, 0, 0, 1e-3]",
                             "[0, 0, 0, 1e-3], [0, 3e-3, 0, 1e-3]",
                             "[0, 0, 0, 1e-3], [0, 0, 3e-3, 1e-3]"};
        const double low = -5e-3 - 3e-4 * (k / 3);
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [%s, [%g, %g, %g, 1e-3], [20e-3, 20e-3, 20e-3, "
            "1e-3]], group: 0}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e4, "
            "kratio: "
            "0}]\nlaw: {stiffness: uniform}\nneighbours: {skin: 4e-4}\ntime: {step: 4e-6, end: "
            "1}\nrun: {threads: 1}\n",
            at[axis], low, low, low);
        w->ctx.scene.has_domain = false; /* the sides of a domain would cause new lists */
        for (size_t p = 0; p < 4; p++) {
            const double *x = w->dem.particles.pos + 4 * p;
            const double speed = fabs(x[axis]) < 1e-4 ? 2.0 : 3e-3 - x[axis] < 1e-4 ? -2.0 : 0.0;
            if (fabs(x[axis]) < 4e-3) w->dem.particles.vel[4 * p + axis] = speed;
        }
        assert_int_equal(w->dem.pairs.contacts.soa.count, 0);
        size_t touching = 0;
        for (int n = 0; n < 80; n++) {
            run_steps(w, 1);
            look_at_all_pairs(w, &touching);
        }
        assert_true(touching > 5);
        world_end(w);
    }
}

/* Lists are rebuilt for every skin of a particle's own travel if there is a domain, or walls are
 * near. */
static void walls_and_domains_are_checked_after_each_skin_of_path(void **state) {
    (void)state;
    static const char *const more[] = {
        "walls: [{name: w, point: [0, 0, -1], normal: [0, 0, 1], stiffness: 1e4}]\n",
        "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = stream(5.0, 0.0, false, more[k]);
        run_steps(w, 400);
        const double skins = 400 * 4e-6 * 5.0 / 4e-4;
        assert_true(fabs((double)w->dem.verlet.rebuilds - skins) < 0.2 * skins);
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_uniform_stream_keeps_its_lists),
        cmocka_unit_test(streams_that_pass_each_other_have_their_lists_made),
        cmocka_unit_test(two_distant_particles_are_listed_before_they_touch),
        cmocka_unit_test(walls_and_domains_are_checked_after_each_skin_of_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
