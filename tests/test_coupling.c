/* Particles and finite elements as one body, in zones that both share. */
#include "coupling_helpers.h"

#include "run_helpers.h"

/* --- patches --- */

static void pull(const double *x, const void *of, double u[3], double v[3]) {
    (void)v;
    u[0] = *(const double *)of * x[0];
}

/* The largest force, N, on any point other than particles of zones, which are one with the nodes.
 * `columns`: summed over all points with the same x. */
static double largest_force(gn_world *w, double low, double high, bool columns) {
    const gn_particles *all[2] = {&w->dem.particles, &w->solids.elements[0]->solid.nodes};
    double most = 0.0, *sum = calloc(4096, sizeof *sum);
    run_steps(w, 1);
    for (int k = 0; k < 2; k++)
        for (size_t p = 0; p < all[k]->soa.count; p++) {
            const double *v = all[k]->vel + 4 * p, *x = all[k]->start + 4 * p;
            const bool tied = k == 0 && tied_by_zone(w, p);
            if (tied || x[0] < low || x[0] > high) continue;
            for (size_t a = 0; a < 2; a++) {
                double force = v[a] / (0.5 * w->ctx.dt * v[3]);
                most = columns ? most : fmax(most, fabs(force));
                sum[2 * lround((x[0] - low) / (0.5 * spacing)) + a] += force;
            }
        }
    for (int k = 0; columns && k < 4096; k++) most = fmax(most, fabs(sum[k]));
    free(sum);
    return most;
}

/* Nodes get the load of the particles around them, not its integral over their elements, so that
 * triangles that all lean one way leave forces between the nodes of a column; together these are in
 * equilibrium. The remaining error is the square of the strain, which elements have and bonds do
 * not, and the rounding of positions over the displacement of one spacing. */
static void a_patch_of_a_lattice_is_in_equilibrium_to_rounding(void **state) {
    (void)state;
    const double strain = 1e-7;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        strip s = {.length = 20e-3, .zone = 4e-3, .side = 1e-3, .rows = 4, .mirrored = mirrored};
        gn_world *w = strip_of(&s);
        set_fields(w, pull, &strain);
        double force = largest_force(w, 0.6e-3, 19.4e-3, true);
        double whole = s.rows * modulus * strain * spacing;
        assert_near(force / whole, 0.0, 4.0 * strain + 8.0 * 2.2e-16 * 20e-3 / (strain * spacing));
        world_end(w);
    }
}

static void move_rigidly(const double *x, const void *of, double u[3], double v[3]) {
    const double *how = of, c = cos(how[2]) - 1.0, s = sin(how[2]); /* shift x y, angle, spin */
    u[0] = how[0] + c * x[0] - s * x[1];
    u[1] = how[1] + s * x[0] + c * x[1];
    v[0] = -how[3] * (x[1] + u[1]);
    v[1] = how[3] * (x[0] + u[0]);
}

/* Velocities are left out: their contribution is the centripetal force of the spin. */
static void moving_and_turning_as_a_whole_costs_no_force(void **state) {
    (void)state;
    const double how[4] = {2e-4, -1e-4, 0.3, 0.0};
    strip s = {.length = 20e-3, .zone = 4e-3, .side = 1e-3, .rows = 4};
    gn_world *w = strip_of(&s);
    set_fields(w, move_rigidly, how);
    /* Rounding of coordinates of 2 cm. */
    assert_true(largest_force(w, -1e-3, 21e-3, false) < modulus * 32.0 * 2.2e-16 * 20e-3);
    world_end(w);
}

/* --- waves --- */

typedef struct pulse {
    double size, centre, length, speed; /* m, m, m, m/s along x */
} pulse;

static void pulse_at(const double *x, const void *of, double u[3], double v[3]) {
    const pulse *q = of;
    double at = (x[0] - q->centre) / q->length;
    if (fabs(at) >= 0.5) return;
    u[0] = 0.5 * q->size * (1.0 + cos(2.0 * pi * at));
    v[0] = q->speed * pi * q->size / q->length * sin(2.0 * pi * at);
}

/* The energy of gn_coupled_returned, J, without that of the particles of the lattice before the
 * zone. */
static double returned_in_lattice(const gn_world *w, double end) {
    const gn_particles *q = &w->dem.particles;
    const double c = sqrt(modulus / density), back = 0.5 * w->ctx.dt_past;
    double sum = 0.0;
    for (size_t b = 0; b < w->dem.bonds.contacts.soa.count; b++) {
        size_t i = 4 * (size_t)w->dem.bonds.contacts.i[b],
               j = 4 * (size_t)w->dem.bonds.contacts.j[b];
        double length = q->start[j] - q->start[i];
        if (fabs(length) < 0.5 * spacing || fmax(q->start[i], q->start[j]) > end) continue;
        double grown = (q->pos[j] - q->start[j] - back * q->vel[j]) -
                       (q->pos[i] - q->start[i] - back * q->vel[i]);
        double wave = 0.5 * (0.5 * (q->vel[i] + q->vel[j]) + c * grown / length);
        sum += wave * wave / q->vel[i + 3];
    }
    return sum;
}

/* Returns the reflected energy over the energy of the pulse, after it has passed the zone. */
static double returned_of(double zone, double length, bool mirrored) {
    strip s = {.length = 0.6, .zone = zone, .side = 5e-3, .rows = 5, .mirrored = mirrored};
    pulse p = {1e-6, 0.12, length, sqrt(modulus / density)};
    gn_world *w = strip_of(&s);
    set_fields(w, pulse_at, &p);
    gn_energy e = measured_step(w);
    const double whole = gn_energy_stored(&e);
    while (w->ctx.time < 205e-6) run_steps(w, 1);
    double back = mirrored ? returned_in_lattice(w, 0.3 - 0.5 * zone)
                           : gn_coupled_returned(&w->ctx, &w->solids, 0);
    e = measured_step(w);
    print_message("# zone %g, wave %g: %.4f %% returned, residual %g\n", zone, length,
                  100.0 * back / whole, gn_energy_residual(&e));
    world_end(w);
    return back / whole;
}

/* Waves of twelve elements, zones of four and eight. */
static void a_wave_passes_from_elements_to_particles(void **state) {
    (void)state;
    double thin = returned_of(20e-3, 60e-3, false), wide = returned_of(40e-3, 60e-3, false);
    assert_true(thin <= 1e-3);
    assert_true(wide < thin);
}

/* A pulse in the lattice contains waves that no element can follow (the curvature of 1 + cos has a
 * kink at both ends), which are reflected: 3e-4 of the energy of a pulse of 60 mm is in waves
 * shorter than two elements. For a pulse twice as long the share is an eighth of that. */
static void a_wave_passes_from_particles_to_elements(void **state) {
    (void)state;
    assert_true(returned_of(20e-3, 120e-3, true) <= 1e-3);
}

/* --- conserved quantities --- */

static void add_momentum(const gn_world *w, bool nodes, double sum[6], double *size) {
    const bool lumped = w->ctx.scene.couple.constraint == GN_COUPLE_LUMPED,
               slaved = w->ctx.scene.couple.spins == GN_COUPLE_SLAVED;
    const gn_particles *q = nodes ? &w->solids.elements[0]->solid.nodes : &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p, *v = q->vel + 4 * p;
        const double *carried = w->solids.elements[0]->solid.carried;
        double m = 1.0 / v[3];
        if (lumped && !nodes && tied_by_zone(w, p)) m = 0.0; /* the nodes carry the particle */
        if (!lumped && nodes && carried) m -= carried[p];
        for (int a = 0; a < 3; a++) {
            int c = (a + 1) % 3, d = (a + 2) % 3;
            sum[a] += m * v[a];
            sum[3 + a] += m * (x[c] * v[d] - x[d] * v[c]);
            const bool counts = q->spin && !(slaved && tied_by_zone(w, p));
            if (counts) sum[3 + a] += q->spin[4 * p + a] / q->spin[4 * p + 3];
            *size += m * fabs(v[a]);
        }
    }
}

static void momentum_of(const gn_world *w, double sum[6], double *size) {
    memset(sum, 0, 6 * sizeof *sum);
    *size = 0.0;
    add_momentum(w, false, sum, size);
    add_momentum(w, true, sum, size);
}

/* Relative to the energy that passes through the zone. */
static double worst_residual(gn_world *w, int steps) {
    double worst = 0.0;
    for (int k = 0; k < steps; k++) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    return worst;
}

static void keeps_momentum_and_energy(const char *more, bool space, int steps) {
    strip s = small_strip(space);
    s.more = more;
    gn_world *w = stirred(&s);
    double before[6], after[6], size;
    momentum_of(w, before, &size);
    assert_true(worst_residual(w, steps) < 1e-5);
    momentum_of(w, after, &size);
    for (int a = 0; a < 6; a++)
        assert_near(after[a], before[a], 1e-12 * size * (a < 3 ? 1.0 : s.length));
    world_end(w);
}

static void a_coupled_body_keeps_momentum_and_energy(void **state) {
    (void)state;
    keeps_momentum_and_energy(NULL, false, 3000);
    keeps_momentum_and_energy(NULL, true, 1000);
    keeps_momentum_and_energy("constraint: consistent", false, 1000);
    keeps_momentum_and_energy("constraint: consistent", true, 300);
    keeps_momentum_and_energy("spins: slaved", false, 1000);
    keeps_momentum_and_energy("spins: slaved, constraint: consistent", true, 300);
    keeps_momentum_and_energy("constraint: penalty", false, 1000);
    keeps_momentum_and_energy("constraint: penalty, penalty_damping: 0.2", true, 300);
    keeps_momentum_and_energy("constraint: penalty, penalty_damping: 0.5", false, 1000);
}

static uint64_t hash_after(bool space, const char *rest, int steps) {
    strip s = small_strip(space);
    s.rest = rest;
    gn_world *w = stirred(&s);
    run_steps(w, steps);
    uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    world_end(w);
    return hash;
}

static void a_coupled_body_gives_the_same_bits_on_any_number_of_threads(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++) {
        uint64_t one = hash_after(space, "run: {threads: 1}\n", 200);
        assert_true(hash_after(space, "run: {threads: 2}\n", 200) == one);
        assert_true(hash_after(space, "run: {threads: 3}\n", 200) == one);
    }
}

static void a_coupled_body_gives_the_same_bits_on_every_instruction_set(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++)
        assert_true(hash_after(space, "run: {threads: 1, isa: scalar}\n", 200) ==
                    hash_after(space, "run: {threads: 1}\n", 200));
}

/* A run with every other option beside a zone: dashpots, background damping, gravity, walls, single
 * precision; then on another number of threads, and resumed. */
static gn_run *busy_run(bool space, int threads, const char *precision, const char *more) {
    char rest[512];
    strip s = small_strip(space);
    snprintf(rest, sizeof rest,
             "damping: {contact: {restitution: 0.8}, background: {model: %s}}\n"
             "gravity: [0, -9.81%s]\n"
             "walls: [{name: end, point: [%g, 0%s], normal: [-1, 0%s], stiffness: 1e6}]\n"
             "run: {threads: %d, precision: %s}\n",
             strstr(more, "consistent") ? "none" : "nonviscous_component, coefficient: 0.1",
             space ? ", 0" : "", s.length + 0.5e-3, space ? ", 0" : "", space ? ", 0" : "", threads,
             precision);
    s.rest = rest;
    s.more = more;
    text *t = text_of(&s);
    gn_run *run = run_of("%s", t->s);
    free(t);
    const double depth = space ? 1.0 : 0.0;
    set_fields(&run->world, stir, &depth);
    return run;
}

static void beside_all_else_threads_and_resumption_give_the_same_bits(void **state) {
    (void)state;
    const char *more[] = {"constraint: lumped", "constraint: consistent, spins: slaved",
                          "constraint: penalty, penalty_damping: 0.1", "spins: slaved"};
    for (int k = 0; k < 8; k++) {
        const char *precision = k % 2 ? "mixed" : "double", *how = more[(k + k / 4) % 4];
        end_alike(busy_run(k / 4, 1, precision, how), busy_run(k / 4, 2, precision, how), 150, 100,
                  1e-5);
    }
}

/* --- refusals --- */

/* The first `from` in the text turned into `to`. */
static void assert_refused(const strip *s, const char *from, const char *to, const char *words) {
    text *t = text_of(s);
    assert_change_refused(t->s, from, to, words);
    free(t);
}

/* --- waves in a scene --- */

/* The pulse starts in elements (0 to 7 mm), or in particles (13 to 20 mm), beside a zone. */
static void a_pulse_is_under_way_at_the_start(void **state) {
    (void)state;
    strip s = small_strip(false);
    for (int side = 0; side < 2; side++) {
        pulse p = {1e-6, side ? 17e-3 : 3e-3, 6e-3, 1700.0};
        s.rest = side ? "initial: {pulse: {direction: [2, 0], centre: [17 mm, 1], length: 6 mm, "
                        "size: 1 um, speed: 1700}}\n"
                      : "initial: {pulse: {direction: [2, 0], centre: [3 mm, 1], length: 6 mm, "
                        "size: 1 um, speed: 1700}}\n";
        gn_world *w = strip_of(&s);
        const gn_particles *all[2] = {&w->dem.particles, &w->solids.elements[0]->solid.nodes};
        for (int k = 0; k < 2; k++)
            for (size_t n = 0; n < all[k]->soa.count; n++) {
                double u[3] = {0}, v[3] = {0};
                if (k == 0 && tied_by_zone(w, n))
                    continue; /* particles of the zone follow the nodes */
                pulse_at(all[k]->start + 4 * n, &p, u, v);
                for (size_t a = 0; a < 3; a++) {
                    assert_near(all[k]->pos[4 * n + a], all[k]->start[4 * n + a] + u[a], 1e-17);
                    assert_near(all[k]->vel[4 * n + a], v[a], 1e-14 * p.speed);
                }
            }
        world_end(w);
    }
    assert_refused(&s, "direction: [2, 0]", "direction: [0, 0]",
                   "expected a direction, found none");
    assert_refused(&s, "centre: [17 mm, 1]", "centre: [14 mm, 1]",
                   "expected one that starts outside of zones");
}

/* Nodes of elements that reach into a zone may be inside a pulse that contains no particle of the
 * zone: the particles follow them, or the energy of their bonds would have no source. */
static void a_pulse_beside_a_zone_takes_its_particles_along(void **state) {
    (void)state;
    static const char *const more[] = {"constraint: lumped", "constraint: consistent",
                                       "constraint: lumped, spins: slaved", "constraint: penalty"};
    for (size_t k = 0; k < sizeof more / sizeof *more; k++) {
        strip s = small_strip(false);
        s.more = more[k];
        s.side = 2e-3;
        s.rest = "initial: {pulse: {direction: [1, 0], centre: [4.6 mm, 0], length: 4.7 mm, "
                 "size: 1 um, speed: 1754}}\n";
        gn_world *w = strip_of(&s);
        const gn_particles *q = &w->dem.particles;
        size_t moved = 0;
        for (size_t p = 0; p < q->soa.count; p++) moved += q->pos[4 * p] != q->start[4 * p];
        assert_true(moved > 0);
        run_steps(w, 200);
        (void)measured_step(w);
        /* The waves are short and have a strain of 7e-4: the residual is of second order in the
         * step. */
        assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-4);
        world_end(w);
    }
}

/* Viscous damping of consistent masses is proportional to these: a rigidly moving body decelerates
 * as a particle does, and the ledger of waves closes. */
static void consistent_masses_are_damped(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++) {
        strip s = small_strip(space);
        s.more = "constraint: consistent";
        s.rest = "damping: {background: {model: viscous, coefficient: 2e4}}\nrun: {threads: 1}\n";
        gn_world *w = stirred(&s);
        const double start = gn_energy_stored(&w->ledger.reading);
        run_steps(w, 400);
        gn_energy e = measured_step(w);
        assert_true(gn_energy_stored(&e) < 0.5 * start);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-8);
        world_end(w);
    }
}

/* An inner node carries a third of each of six triangles, or a quarter of each of 24 tetrahedra;
 * nodes on sides carry half of that. */
static void parallel_diagonals_give_inner_nodes_one_mass(void **state) {
    (void)state;
    static const char *const body[] = {"dimension: 2\nelements: {rectangle: {size: [4, 3]",
                                       "dimension: 3\nelements: {box: {size: [4, 3, 2]"};
    for (int d = 2; d <= 3; d++) {
        char scene[512];
        snprintf(scene, sizeof scene,
                 "%s, cells: [4, 3%s], diagonals: parallel}, materials: [{young: 1e9, poisson: "
                 "0.2, density: 1000}]}\ntime: {end: 1}\n",
                 body[d - 2], d == 3 ? ", 2" : "");
        gn_world *w = world_of("%s", scene);
        const gn_particles *q = &w->solids.elements[0]->solid.nodes;
        size_t inside = 0;
        for (size_t n = 0; n < q->soa.count; n++) {
            const double *x = q->start + 4 * n, size[3] = {4.0, 3.0, 2.0};
            int on = 0;
            for (int k = 0; k < d; k++) on += x[k] == 0.0 || x[k] == size[k];
            inside += on == 0;
            if (on < 2) assert_near(1.0 / q->vel[4 * n + 3], on ? 500.0 : 1000.0, 1e-9);
        }
        assert_int_equal(inside, 3 * 2 * 1);
        world_end(w);
    }
}

static void unknown_diagonals_are_refused(void **state) {
    (void)state;
    strip s = small_strip(true);
    assert_refused(
        &s, "elements: {box: {", "elements: {box: {diagonals: crossed, ",
        "elements.box.diagonals: expected one of alternating, parallel, found 'crossed'");
}

/* --- figures --- */

static void a_zone_is_measured(void **state) {
    (void)state;
    strip s = small_strip(false);
    gn_world *w = strip_of(&s);
    gn_zone_figures f;
    gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, 0, &f);
    assert_near(f.width, 6e-3, 1e-15);
    assert_near(f.element, 0.5 * (13e-3 / 7.0 + 2e-3), 1e-12); /* lines along x and along y */
    assert_near(f.diameter, 1e-3, 1e-15);
    assert_int_equal(f.particles, 7 * 6);
    assert_int_equal(f.beyond, 0);
    assert_near(f.least, 0.0, 1e-9);
    const gn_zone_material *m = f.material;
    assert_int_equal(f.materials, 1);
    assert_in_range(1e9 * f.edge, 0,
                    1e9 * 0.25 * f.element / f.width); /* the load has a kink in an element */
    assert_near(m->modulus[1], modulus, 1e-6 * modulus);
    assert_near(m->density[1], density, 1e-9 * density);
    /* The hull of a strip of 14 by 6 discs lacks its corners. */
    assert_near(m->modulus[0], modulus, 0.01 * modulus);
    assert_near(m->density[0], density, 0.01 * density);
    assert_true(m->returned < 1e-4);
    assert_int_equal(gn_coupled_broken(&w->dem), 0);
    for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++)
        if (tied_by_zone(w, (size_t)w->dem.bonds.contacts.i[c]) &&
            tied_by_zone(w, (size_t)w->dem.bonds.contacts.j[c])) {
            w->dem.bonds.contacts.cause[c] = GN_BROKEN_TENSION;
            break;
        }
    assert_int_equal(gn_coupled_broken(&w->dem), 1);
    world_end(w);
}

/* Columns from edge to edge have 0, 1/6 .. 1 of their mass, elements leave half of it to them. */
static void a_zone_is_weighed(void **state) {
    (void)state;
    strip s = small_strip(false);
    s.length = 18e-3;
    s.side = 2e-3;
    gn_world *w = strip_of(&s);
    gn_zone_figures f;
    gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, 0, &f);
    assert_near(f.mass, 3.5 / 3.0, 1e-12);
    assert_false(gn_zone_is_off(&f));
    world_end(w);
}

/* --- refused input --- */

static void invalid_zones_are_refused(void **state) {
    (void)state;
    strip s = small_strip(false);
    assert_refused(&s, "from: [0.013", "from: [0.011", "expected elements that end on the plane");
    assert_refused(&s, "from: [0.0130", "from: [0.0145", "found particle");
    assert_refused(&s, "from: [0.013000000000000001", "from: [0.0070000000000000001",
                   "edges[0].to: expected a point");
    assert_refused(&s, "couple: {", "couple: {spin: free, ", "unknown key");
    assert_refused(&s, "materials: [{young", "contact: {stiffness: 1e9}, materials: [{young",
                   "needs a scene without elements.contact; found one");
    s.rest = "damping: {background: {model: nonviscous_vector, coefficient: 0.1}}\n";
    assert_refused(&s, "couple: {", "couple: {constraint: consistent, ",
                   "expected lumped or penalty beside background damping that is not viscous");
    s.more = "constraint: consistent";
    s.rest = "damping: {background: {model: viscous, coefficient: 1}}\n";
    assert_refused(&s, "materials: [{young",
                   "motions: [{name: m, box: {min: [8 mm, -1], max: [12 mm, 1]}, motion: {vx: "
                   "1}}], materials: [{young",
                   "expected no driven nodes in zones of consistent masses");
    s.more = NULL;
    s.rest = "sets: [{name: a, select: {all: true}, force: [1, 0]}]\n";
    assert_refused(&s, "time:", "time:", "that no set pushes or moves");
    s.rest = "sets: [{name: a, select: {all: true}, initial_velocity: [1, 0]}]\n";
    assert_refused(&s, "time:", "time:", "couple: expected particles of zones that start at rest");
    s.rest = "initial: {random_velocity: 1}\n";
    assert_refused(&s, "time:", "time:", "couple: expected particles of zones that start at rest");
    s.rest = "sets: [{name: a, select: {all: true}, initial_spin: [0, 0, 1]}]\n";
    s.more = "spins: slaved";
    assert_refused(&s, "time:", "time:", "couple: expected particles of zones that start at rest");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_patch_of_a_lattice_is_in_equilibrium_to_rounding),
        cmocka_unit_test(moving_and_turning_as_a_whole_costs_no_force),
        cmocka_unit_test(a_wave_passes_from_elements_to_particles),
        cmocka_unit_test(a_wave_passes_from_particles_to_elements),
        cmocka_unit_test(a_coupled_body_keeps_momentum_and_energy),
        cmocka_unit_test(a_coupled_body_gives_the_same_bits_on_any_number_of_threads),
        cmocka_unit_test(a_coupled_body_gives_the_same_bits_on_every_instruction_set),
        cmocka_unit_test(beside_all_else_threads_and_resumption_give_the_same_bits),
        cmocka_unit_test(a_pulse_is_under_way_at_the_start),
        cmocka_unit_test(consistent_masses_are_damped),
        cmocka_unit_test(a_pulse_beside_a_zone_takes_its_particles_along),
        cmocka_unit_test(parallel_diagonals_give_inner_nodes_one_mass),
        cmocka_unit_test(unknown_diagonals_are_refused),
        cmocka_unit_test(a_zone_is_measured),
        cmocka_unit_test(a_zone_is_weighed),
        cmocka_unit_test(invalid_zones_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
