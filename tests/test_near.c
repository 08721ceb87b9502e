/* Processing active pairs alone leaves every bit of a run unchanged. */
#include "world_helpers.h"

#include "run/run.h"

#include <unistd.h>

typedef struct near_case {
    const char *name, *scene;
} near_case;

#define FALL(dimension, specimen, gravity)                                                         \
    "dimension: " dimension "\nspecimen: {lattice: {" specimen                                     \
    ", spacing: 1.1, jitter: 0.05}, group: 0}\ngravity: " gravity "\n"                             \
    "initial: {random_velocity: 0.5}\nneighbours: {skin: 3e-4}\n"
#define SPHERES                                                                                    \
    FALL("3", "kind: cubic, radius: 1e-3, cells: [8, 8, 8]", "[0.5, 0, -9.81]")                    \
    "periodic: {min: [-1e-3, -1e-3, -5e-3], max: [16.7e-3, 16.7e-3, 40e-3]}\n"
#define LINEAR   "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 2"
#define STIFF    "law: {stiffness: uniform}\n"
#define BOUNCES  "damping: {contact: {restitution: 0.6}}\n"
#define MATERIAL "materials: [{name: m, density: 2500, young: 1e7, poisson: 0.2, friction: 0.4"
#define END      "time: {end: 1}\n"

static const near_case cases[] = {
    {"friction", SPHERES LINEAR ", friction: 0.4}]\n" STIFF BOUNCES END},
    {"neither friction nor dashpot", SPHERES LINEAR "}]\n" STIFF END},
    {"without a ledger",
     SPHERES LINEAR ", friction: 0.4}]\n" STIFF BOUNCES "output: {energy: off}\n" END},
    {"rolling", SPHERES LINEAR ", friction: 0.4, rolling_friction: 0.2}]\n" STIFF BOUNCES END},
    {"Hertz", SPHERES MATERIAL ", restitution: 0.6}]\nlaw: {stiffness: hertz}\n" END},
    {"Hertz, rolling, no pull",
     SPHERES MATERIAL ", restitution: 0.6, rolling_friction: 0.2, twisting_friction: 0.1}]\n"
                      "law: {stiffness: hertz, pull: false}\n" END},
    {"JKR", SPHERES MATERIAL ", adhesion: 0.05, restitution: 0.9}]\n"
                             "law: {stiffness: hertz, cohesion: jkr}\n" END},
    {"liquid", SPHERES MATERIAL ", restitution: 0.9}]\nlaw: {stiffness: hertz, cohesion: liquid, "
                                "surface_tension: 1e-3, liquid_content: 1e-3}\n" END},
    {"by the radii",
     SPHERES "materials: [{name: m, density: 2500, contact_modulus: 1e8, kratio: 2, "
             "friction: 0.4}]\nlaw: {stiffness: harmonic}\n" BOUNCES END},
    {"discs on a floor",
     FALL("2", "kind: hexagonal, radius: 1e-3, cells: [20, 12]", "[0, -9.81]") LINEAR
     ", friction: 0.4}]\n" STIFF BOUNCES
     "walls: [{name: w, point: [0, -2e-3], normal: [0, 1], stiffness: 1e5}]\n" END}};

static gn_world *made(const near_case *c, int threads) {
    gn_world *w = world_of("%srun: {threads: %d}\n", c->scene, threads);
    for (size_t p = 0; p < w->dem.particles.soa.count; p += 3) /* sizes differ */
        w->dem.particles.pos[4 * p + 3] *= 0.97;
    return w;
}

static void assert_same(const char *name, const char *what, const double *a, const double *b,
                        size_t count) {
    for (size_t k = 0; a && k < count; k++)
        if (!(a[k] == b[k])) fail_msg("%s: %s %zu: %.17g and %.17g", name, what, k, a[k], b[k]);
}

static void assert_same_worlds(const char *name, const gn_world *a, const gn_world *b) {
    const gn_dem *d = &a->dem, *e = &b->dem;
    const size_t n = d->particles.soa.count, c = d->pairs.contacts.soa.count,
                 room = d->pairs.contacts.soa.capacity;
    assert_int_equal(c, e->pairs.contacts.soa.count);
    assert_same(name, "place", d->particles.pos, e->particles.pos, 4 * n);
    assert_same(name, "velocity", d->particles.vel, e->particles.vel, 4 * n);
    assert_same(name, "spin", d->particles.spin, e->particles.spin, 4 * n);
    for (size_t k = 0; k < 3 && d->pairs.contacts.shear; k++)
        assert_same(name, "force across", d->pairs.contacts.shear + k * room,
                    e->pairs.contacts.shear + k * room, c);
    for (size_t k = 0; k < 3 && d->pairs.contacts.roll; k++)
        assert_same(name, "moment", d->pairs.contacts.roll + k * room,
                    e->pairs.contacts.roll + k * room, c);
    assert_same(name, "dashpot", d->pairs.contacts.fd, e->pairs.contacts.fd, c);
    assert_same(name, "bridge", d->pairs.contacts.bridge, e->pairs.contacts.bridge, c);
    assert_same(name, "onset", d->pairs.contacts.onset, e->pairs.contacts.onset, c);
    assert_same(name, "film", d->particles.film, e->particles.film, n);
    assert_same(name, "closeness", d->pairs.contacts.closeness, e->pairs.contacts.closeness, c);
}

static void omitting_distant_pairs_changes_no_bit(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_world *packed = made(&cases[k], 2), *whole = made(&cases[k], 1);
        size_t on = 0, held = 0;
        whole->dem.near.disabled = true;
        whole->dem.near.on = false;
        for (int n = 0; n < 40; n++) {
            run_steps(packed, 25);
            run_steps(whole, 25);
            assert_false(whole->dem.near.on);
            on += packed->dem.near.on;
            held += packed->dem.near.span.steps > 1;
            assert_same_worlds(cases[k].name, packed, whole);
        }
        assert_true(on > 20 && held > 10 && packed->dem.verlet.rebuilds > 2);
        world_end(packed);
        world_end(whole);
    }
}

/* Readers of the world find an up-to-date list, and the run continues with the same bits. */
static void reading_the_world_changes_no_bit(void **state) {
    (void)state;
    gn_world *read = made(&cases[4], 1), *left = made(&cases[4], 1);
    gneiss_error error = {0};
    for (int n = 0; n < 400; n++) {
        if (gn_world_step(read, n == 0, &error) != GNEISS_OK) fail_msg("%s", error.message);
        if (gn_world_step(left, n == 0, &error) != GNEISS_OK) fail_msg("%s", error.message);
        if (n % 3 == 0)
            gn_world_hash(&read->ctx, &read->dem, &read->boundary, &read->solids, &read->box);
    }
    assert_true(left->dem.near.unsettled && left->dem.near.on);
    assert_true(gn_world_hash(&read->ctx, &read->dem, &read->boundary, &read->solids, &read->box) ==
                gn_world_hash(&left->ctx, &left->dem, &left->boundary, &left->solids, &left->box));
    assert_same_worlds("read", read, left);
    world_end(read);
    world_end(left);
}

/* Pairs of grains at random positions and velocities: the bits of every instruction set are
 * those of the scalar one, and an omitted pair does not touch, even nearly, at any time of the
 * interval. */
static void acting_pairs_are_found(void **state) {
    (void)state;
    enum { PAIRS = 8 * 200 };
    static double pos[2 * PAIRS][4], vel[2 * PAIRS][4];
    static int32_t i[PAIRS + GN_LANES_MAX], j[PAIRS + GN_LANES_MAX], own[2 * PAIRS + GN_LANES_MAX];
    uint8_t first[PAIRS / 8] = {0}, act[PAIRS / 8];
    static gn_near_path paths[2 * PAIRS / GN_PARTICLE_BLOCK + 1];
    for (size_t b = 0; b < sizeof paths / sizeof *paths; b++)
        paths[b].margin = 0.005 * (double)(1 + b % 3);
    gn_near_args a = {pos[0],
                      vel[0],
                      NULL,
                      i,
                      j,
                      own,
                      PAIRS - 3,
                      2 * PAIRS,
                      1.0,
                      paths,
                      0.3,
                      0.1,
                      true,
                      {3.0, 3.0, 3.0},
                      {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}};
    size_t left_out = 0, found = 0;
    for (int32_t k = 0; k < 2 * PAIRS; k++) {
        own[k] = k;
        if (k < PAIRS) i[k] = k;
        if (k >= PAIRS) j[2 * PAIRS - 1 - k] = k; /* the other end is in another block */
        for (uint64_t n = 0; n < 3; n++) {
            pos[k][n] = 1.5 * gn_random_symmetric(7 + n, (uint64_t)k);
            vel[k][n] = gn_random_symmetric(17 + n, (uint64_t)k);
        }
        pos[k][3] = 0.45;
    }
    for (int s = 0; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!gn_kernel_set_supported(set)) continue;
        const size_t count = set->near->find(&a, act);
        if (!found) memcpy(first, act, sizeof first);
        if (!found) found = count;
        assert_true(count == found && memcmp(first, act, sizeof first) == 0);
    }
    for (int32_t k = 0; k < PAIRS - 3; k++) {
        const double margin =
            paths[i[k] / GN_PARTICLE_BLOCK].margin + paths[j[k] / GN_PARTICLE_BLOCK].margin;
        for (int t = -10; !(first[k / 8] >> k % 8 & 1) && t <= 30; t++) {
            double d2 = 0.0;
            for (int n = 0; n < 3; n++) {
                double d = pos[j[k]][n] - pos[i[k]][n];
                d -= 3.0 * rint(d / 3.0);
                d += 0.01 * t * (vel[j[k]][n] - vel[i[k]][n]);
                d2 += d * d;
            }
            if (!(sqrt(d2) > 0.9 + margin - 1e-9)) fail_msg("pair %d at %d: %g", k, t, sqrt(d2));
            left_out += t == 0;
        }
    }
    assert_true(found > 100 && left_out > 100 && found + left_out == PAIRS - 3);
}

/* Losses are summed over other lanes: the same but for the order of sums. */
static void losses_are_the_same_to_rounding(void **state) {
    (void)state;
    gn_world *packed = made(&cases[3], 1), *whole = made(&cases[3], 1);
    whole->dem.near.disabled = true;
    whole->dem.near.on = false;
    run_steps(packed, 600);
    run_steps(whole, 600);
    assert_true(whole->ledger.energy.friction > 0.0 && whole->ledger.energy.contact_damping > 0.0);
    assert_close(packed->ledger.energy.friction, whole->ledger.energy.friction, 1e-12);
    assert_close(packed->ledger.energy.contact_damping, whole->ledger.energy.contact_damping,
                 1e-12);
    assert_close(packed->ledger.energy.rolling, whole->ledger.energy.rolling, 1e-12);
    world_end(packed);
    world_end(whole);
}

/* If every listed pair is in contact, none can be omitted. */
static void a_lattice_that_touches_is_worked_on_whole(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1e-3, cells: [3, 3, 3], spacing: "
        "0.999}, group: 0}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: "
        "2}]\nlaw: {stiffness: uniform}\nneighbours: {skin: 1e-4}\ntime: {end: 1}\n");
    assert_true(w->dem.pairs.contacts.soa.count > 100);
    assert_false(w->dem.near.on);
    world_end(w);
}

/* Every set, at every phase of the groups of eight and with all kinds of bits. */
static void packed_columns_are_restored(void **state) {
    (void)state;
    enum { GROUPS = 40, MOST = GN_NEAR_GROUP * (GROUPS + 1) };
    for (int s = 0; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!gn_kernel_set_supported(set)) continue;
        double from[MOST], to[MOST], back[MOST], others[MOST];
        int32_t name[MOST], kept[MOST];
        uint8_t act[GROUPS], then[GROUPS];
        size_t n = 0;
        for (int k = 0; k < MOST; k++) {
            from[k] = k % 5 ? 1.0 + k : -0.0;
            back[k] = -1.0;
            name[k] = k;
        }
        for (int g = 0; g < GROUPS; g++) act[g] = (uint8_t)(g < 2 ? 255 * g : g * 37);
        for (int g = 0; g < GROUPS; g++) then[g] = (uint8_t)(g % 5 ? g * 91 : 255 * (g % 2));
        set->near->pack(to, from, act, GROUPS);
        set->near->pack32(kept, name, act, GROUPS);
        set->near->unpack(back, to, act, GROUPS);
        for (int k = 0; k < GN_NEAR_GROUP * GROUPS; k++) {
            bool in = act[k / GN_NEAR_GROUP] >> k % GN_NEAR_GROUP & 1;
            if (in) assert_true(to[n] == from[k] && kept[n] == k);
            assert_true(back[k] == (in ? from[k] : 0.0) && !signbit(back[k]));
            n += in;
        }
        assert_true(n > 100);
        n = 0;
        set->near->repack(others, to, act, then, GROUPS);
        for (int k = 0; k < GN_NEAR_GROUP * GROUPS; k++)
            if (then[k / GN_NEAR_GROUP] >> k % GN_NEAR_GROUP & 1) {
                assert_true(others[n] == back[k] && !signbit(others[n]));
                n++;
            }
        assert_true(n > 100);
    }
}

/* Sums of losses depend on which pairs are packed next to each other. Writing a checkpoint may not
 * change any bit, and a resumed run may not differ in its state. */
static void checkpoints_do_not_show_in_the_ledger(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gneiss_error error = {0};
        gn_run *run = calloc(3, sizeof *run);
        gn_scene scene;
        char path[] = "/tmp/gneiss_near_XXXXXX", yaml[2048];
        int file = mkstemp(path);
        assert_true(file >= 0);
        close(file);
        snprintf(yaml, sizeof yaml, "%srun: {threads: 1}\n", cases[k].scene);
        for (int r = 0; r < 2; r++) {
            assert_int_equal(gn_scene_parse(yaml, "s.yaml", NULL, NULL, 0, &scene, &error),
                             GNEISS_OK);
            assert_int_equal(gn_run_create(&scene, &run[r], &error), GNEISS_OK);
            assert_int_equal(gn_run_steps(&run[r], 107, &error), GNEISS_OK);
        }
        assert_true(run[1].world.dem.near.packed);
        assert_int_equal(gn_checkpoint_write(&run[1], path, &error), GNEISS_OK);
        if (gn_run_load(path, NULL, 0, &run[2], &error) != GNEISS_OK) fail_msg("%s", error.message);
        for (int r = 0; r < 3; r++) assert_int_equal(gn_run_steps(&run[r], 700, &error), GNEISS_OK);
        for (int r = 1; r < 3; r++) {
            /* In a resumed run the last digit of the losses may differ. */
            const double *a = (const double *)&run[0].world.ledger.energy;
            const double *b = (const double *)&run[r].world.ledger.energy;
            for (size_t e = 0; e < sizeof(gn_energy) / sizeof *a; e++)
                if (r == 1 ? a[e] != b[e] : fabs(a[e] - b[e]) > 1e-14 * fabs(a[e]))
                    fail_msg("%s: term %zu of the ledger of run %d has other bits", cases[k].name,
                             e, r);
            assert_true(gn_world_hash(&run[0].world.ctx, &run[0].world.dem, &run[0].world.boundary,
                                      &run[0].world.solids, &run[0].world.box) ==
                        gn_world_hash(&run[r].world.ctx, &run[r].world.dem, &run[r].world.boundary,
                                      &run[r].world.solids, &run[r].world.box));
            assert_same_worlds(cases[k].name, &run[0].world, &run[r].world);
        }
        for (int r = 0; r < 3; r++) gn_run_free(&run[r]);
        free(run);
        unlink(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(omitting_distant_pairs_changes_no_bit),
        cmocka_unit_test(reading_the_world_changes_no_bit),
        cmocka_unit_test(acting_pairs_are_found),
        cmocka_unit_test(losses_are_the_same_to_rounding),
        cmocka_unit_test(a_lattice_that_touches_is_worked_on_whole),
        cmocka_unit_test(packed_columns_are_restored),
        cmocka_unit_test(checkpoints_do_not_show_in_the_ledger),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
