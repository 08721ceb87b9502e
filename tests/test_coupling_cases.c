/* Zones that overlap, that are at other places, of several materials, that lose particles or bonds;
 * and their readings. */
#include "coupling_helpers.h"
#include "particles/observe.h"
#include "run/output_fields.h"
#include "run/run.h"

#include <unistd.h>

/* --- readings --- */

static void stretch(const double *x, const void *of, double u[3], double v[3]) {
    const double *strain = of;
    (void)v;
    for (int a = 0; a < 3; a++) u[a] = strain[a] * x[a];
}

/* Stress of particles along x, Pa, by their numbers; the caller frees. */
static double (*stresses(gn_world *w))[6] {
    gneiss_error error = {0};
    gn_observed seen;
    gn_output_view view;
    double(*stress)[6] = calloc(w->dem.particles.soa.count + 1, sizeof *stress);
    if (gn_dem_observe(&w->ctx, &w->dem, &w->box, &seen, &error) != GNEISS_OK ||
        gn_output_view_make(w, &seen, &view, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        memcpy(stress[w->dem.particles.id[p]], view.stress + 6 * p, sizeof *stress);
    gn_output_view_free(&view);
    gn_observed_free(&seen);
    return stress;
}

/* Contacts have the mean weight of their ends: at both edges of a zone, where the weight has a
 * kink, the sum of a particle has an error of a quarter of the spacing over the width. Particles
 * fill the part `solid` of their nominal volume, for which the hull of a small strip is a little
 * small. Those at the free end, 20 mm, have bonds at one side. */
static void stress_is_whole_through_a_zone(void **state) {
    (void)state;
    const double strain[3] = {1e-6, 0.0, 0.0};
    for (int space = 0; space < 2; space++) {
        strip s = {
            .length = 20e-3, .zone = 6e-3, .side = 1e-3, .rows = space ? 3 : 6, .space = space};
        gn_world *w = strip_of(&s);
        const double solid = (1.0 - gn_dem_porosity(&w->ctx, &w->dem)) * (space ? 6.0 : 4.0) / pi;
        set_fields(w, stretch, strain);
        double(*stress)[6] = stresses(w);
        size_t tied = 0;
        for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
            const double *x = w->dem.particles.start + 4 * p, part = w->dem.particles.blend[2 * p];
            if (x[0] > 19.6e-3) continue;
            tied += tied_by_zone(w, p);
            assert_near(stress[w->dem.particles.id[p]][0] / (modulus * strain[0]),
                        part * solid + 1.0 - part, 0.25 * solid * spacing / s.zone + 1e-5);
        }
        assert_int_equal(tied, space ? 7 * 9 : 7 * 6);
        free(stress);
        world_end(w);
    }
}

/* --- a pulse in a packing --- */

/* A pulse of 20 mm has left the first 30 mm after 40 mm of travel. If the tangential springs of
 * bonds did not contain the pulse at the start, they would retain a part of it, because normal
 * springs act against them: a fifth if both are equal. Disorder scatters some per cent. */
static void a_pulse_in_a_packing_leaves_nothing_where_it_began(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 2\n"
        "specimen: {group: 1, rectangle: {width: 80 mm, height: 8 mm}, mean_radius: 0.5 mm, "
        "density_basis: bulk, packing: {overlap: passive, size_variation: 0.1}}\n"
        "materials: [{name: m, density: 7800, contact_modulus: 14.5e9, kratio: 1, friction: 0, "
        "tensile_strength: 1e15, shear_strength: 1e15}]\n"
        "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.1, passive_gaps: true}\n"
        "initial: {pulse: {direction: [1, 0], centre: [15 mm, 0], length: 20 mm, size: 1 um, "
        "speed: 1754}}\ntime: {end: 1}\nrun: {threads: 1}\n");
    const gn_particles *q = &w->dem.particles;
    while (w->ctx.time < 40e-3 / 1754.0) run_steps(w, 1);
    double left = 0.0, ahead = 0.0;
    size_t count[2] = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        const double x = q->start[4 * p], u = q->pos[4 * p] - x;
        if (fabs(x - 15e-3) < 3e-3) left += u, count[0]++;
        if (fabs(x - 55e-3) < 3e-3) ahead += u, count[1]++;
    }
    left /= (double)count[0];
    ahead /= (double)count[1];
    print_message("# %.3f of the crest stayed, %.3f went on\n", left / 1e-6, ahead / 1e-6);
    assert_true(fabs(left) < 0.05e-6);
    assert_true(ahead > 0.6e-6);
    world_end(w);
}

/* --- zones --- */

static void assert_refused(const char *scene, const char *words) {
    gn_world w;
    gneiss_error error = {0};
    if (world_try(&w, scene, NULL, &error) == GNEISS_OK) fail_msg("accepted");
    if (!strstr(error.message, words)) fail_msg("%s", error.message);
}

static void a_zone_without_elements_or_particles_is_refused_with_its_place(void **state) {
    (void)state;
    strip s = small_strip(false);
    const char *zones[] = {"{edges: [{from: [1, 0], to: [0.9, 0]}]}", "found no element",
                           "{edges: [{from: [4 mm, 0], to: [1 mm, 0]}]}", "elements that end on"};
    for (int k = 0; k < 2; k++) {
        text *t = text_of(&s), *changed = calloc(1, sizeof *changed);
        char *at = strstr(t->s, "]}]}]");
        assert_non_null(at);
        add(changed, "%.*s, %s%s", (int)(at + 4 - t->s), t->s, zones[2 * k], at + 4);
        assert_refused(changed->s, zones[2 * k + 1]);
        assert_refused(changed->s, "s.yaml:");
        free(t);
        free(changed);
    }
}

/* A square block of elements in the corner of a square lattice: one zone along each of two sides,
 * which overlap where these meet. */
static gn_world *corner(const char *rest) {
    const double solid = pi / 4.0;
    return world_of(
        "dimension: 2\n"
        "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [17, 17], origin: "
        "[-0.5 mm, -0.5 mm]}}\n"
        "materials: [{name: m, density: %.17g, normal_stiffness: %g, kratio: 4, friction: 0.2, "
        "bond_tension_limit: 1e15, bond_shear_limit: 1e15}]\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
        "elements: {rectangle: {size: [8 mm, 8 mm], cells: [8, 8]}, materials: [{young: %g, "
        "poisson: 0, density: %g}]}\n"
        "sets: [{name: deep, select: {box: {min: [-1, -1], max: [3.5 mm, 3.5 mm]}}, material: m}]\n"
        "couple: {zones: [{edges: [{from: [8 mm, 0], to: [4 mm, 0]}]}, {edges: [{from: [0, 8 mm], "
        "to: [0, 4 mm]}]}]}\n"
        "time: {end: 1}\n%s",
        density / solid, modulus, modulus, density, rest);
}

/* The weights of elements and particles add up to one everywhere, and in several zones the elements
 * have the smallest of the weights. */
static void where_zones_overlap_both_have_the_whole_of_the_body(void **state) {
    (void)state;
    gn_world *w = corner("run: {threads: 1}\n");
    const gn_particles *q = &w->dem.particles;
    gn_zone_figures f;
    size_t both = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->start + 4 * p;
        if (!tied_by_zone(w, p)) continue;
        double right = (8e-3 - x[0]) / 4e-3, top = (8e-3 - x[1]) / 4e-3;
        double share = fmin(fmin(right, top), 1.0);
        assert_near(q->blend[2 * p], 1.0 - share, 1e-12);
        both += right < 1.0 - 1e-9 && top < 1.0 - 1e-9;
    }
    assert_int_equal(both, 4 * 4);
    gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, 0, &f);
    assert_int_equal(f.shared, 4 * 4);
    assert_int_equal(f.other, 1);
    world_end(w);
}

static void overlapping_zones_keep_energy_and_turn_without_force(void **state) {
    (void)state;
    const double none = 0.0;
    gn_world *w = corner("run: {threads: 1}\n");
    set_fields(w, stir, &none);
    run_steps(w, 1);
    for (int k = 0; k < 500; k++) {
        gn_energy e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
    }
    world_end(w);
}

/* --- two materials --- */

/* A mesh of 13 x 6 squares of 1 mm, of two groups: below 3 mm and above. */
static void write_mesh(const char *path) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(f, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"lower\"\n2 2 "
               "\"upper\"\n$EndPhysicalNames\n$Nodes\n98\n");
    for (int n = 0; n < 98; n++) fprintf(f, "%d %g %g 0\n", n + 1, n % 14 * 1e-3, n / 14 * 1e-3);
    fprintf(f, "$EndNodes\n$Elements\n156\n");
    for (int e = 0; e < 156; e++) {
        const int cell = e / 2, n = cell / 13 * 14 + cell % 13 + 1;
        fprintf(f, "%d 2 2 %d 1 %d %d %d\n", e + 1, cell / 13 < 3 ? 1 : 2, n,
                e % 2 ? n + 15 : n + 1, e % 2 ? n + 14 : n + 15);
    }
    fprintf(f, "$EndElements\n");
    fclose(f);
}

/* Elements of the upper half are twice as stiff as those below, and so are the particles. */
static gn_world *two_materials(const char *rest) {
    char path[] = "/tmp/gneiss-zone-XXXXXX.msh";
    close(mkstemps(path, 4));
    write_mesh(path);
    gn_world *w = world_of(
        "dimension: 2\n"
        "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [14, 6], origin: "
        "[6.5 mm, 0]}}\n"
        "materials: [{name: m, density: %.17g, normal_stiffness: %g, kratio: 4, friction: 0.2, "
        "bond_tension_limit: 1e15, bond_shear_limit: 1e15}]\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
        "elements: {mesh: %s, materials: [{group: lower, young: %g, poisson: 0, density: %g}, "
        "{group: upper, young: %g, poisson: 0, density: %g}]}\n"
        "couple: {zones: [{edges: [{from: [13 mm, 0], to: [7 mm, 0]}]}]}\ntime: {end: 1}\n%s",
        density / (pi / 4.0), modulus, path, modulus, density, 2.0 * modulus, density, rest);
    unlink(path);
    return w;
}

static void a_zone_across_two_materials_uses_both(void **state) {
    (void)state;
    gn_world *w = two_materials("run: {threads: 1}\n");
    gn_zone_figures f;
    gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, 0, &f);
    assert_int_equal(f.materials, 2);
    assert_int_equal(f.material[0].particles, 21);
    assert_int_equal(f.material[1].particles, 21);
    for (size_t k = 0; k < 2; k++) {
        const gn_zone_material *m = &f.material[k];
        assert_near(m->modulus[1], (m->material + 1) * modulus, 1e-9 * modulus);
        assert_near(m->modulus[0], modulus, 0.02 * modulus); /* the hull lacks its corners */
        const double z = sqrt(m->modulus[0] * m->density[0] / (m->modulus[1] * m->density[1]));
        assert_near(m->returned, pow((1.0 - z) / (1.0 + z), 2.0), 1e-12);
    }
    world_end(w);
}

static void a_zone_across_two_materials_keeps_energy(void **state) {
    (void)state;
    const double none = 0.0;
    gn_world *w = two_materials("run: {threads: 1}\n");
    set_fields(w, stir, &none);
    run_steps(w, 1);
    for (int k = 0; k < 1000; k++) {
        gn_energy e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
    }
    world_end(w);
}

/* --- lost particles and bonds --- */

/* A strip that flies through the end of the domain: particles are at its front. */
static gn_run *flying(const char *couple, int threads) {
    char rest[512];
    strip s = {.length = 12e-3, .zone = 4e-3, .side = 2e-3, .rows = 4, .mirrored = true};
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    gn_scene scene;
    snprintf(rest, sizeof rest,
             "domain: {min: [-2.2 mm, -1], max: [1, 1], lost: remove}\nrun: {threads: %d}\n",
             threads);
    s.rest = rest;
    s.more = couple;
    text *t = text_of(&s);
    if (gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    free(t);
    return run;
}

static void fly(const double *x, const void *of, double u[3], double v[3]) {
    (void)u;
    v[0] = -*(const double *)of;
    v[1] = 0.05 * sin(900.0 * x[1] + 300.0 * x[0]);
}

static double momentum_of_elements(const gn_world *w) {
    const gn_particles *nodes = &w->solids.elements[0]->solid.nodes;
    double sum = 0.0;
    for (size_t n = 0; n < nodes->soa.count; n++) sum += nodes->vel[4 * n] / nodes->vel[4 * n + 3];
    return sum;
}

static void fly_on(gn_world *w, size_t wanted, int most) {
    for (int k = 0; k < most && gn_coupled_removed_count(&w->ctx, &w->zones) < wanted; k += 50) {
        run_steps(w, 50);
        gn_energy e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
    }
    assert_int_equal(gn_coupled_removed_count(&w->ctx, &w->zones), wanted);
}

/* Nodes lose the mass that they carried: at the end they have their own mass, and the ledger closes
 * on the way. */
static void a_zone_may_lose_all_its_particles(void **state) {
    (void)state;
    const char *couple[] = {NULL, "constraint: consistent", "constraint: penalty", "spins: slaved"};
    const double speed = 60.0;
    for (int k = 0; k < 4; k++) {
        gn_run *run = flying(couple[k], 1);
        gn_world *w = &run->world;
        set_fields(w, fly, &speed);
        fly_on(w, 20, 100000);
        const gn_fem_solid *b = &w->solids.elements[0]->solid;
        for (size_t n = 0; b->carried && n < b->nodes.soa.count; n++)
            assert_near(b->carried[n], 0.0, 0.0);
        double mass = 0.0;
        for (size_t n = 0; n < b->nodes.soa.count; n++) mass += 1.0 / b->nodes.vel[4 * n + 3];
        assert_near(mass, b->mass, 1e-12 * b->mass);
        assert_true(fabs(momentum_of_elements(w) / (b->mass * speed) + 1.0) < 0.05);
        gn_warnings warnings;
        assert_int_equal(gn_run_warnings(run, &warnings, NULL), GNEISS_OK);
        bool reported = false;
        for (size_t i = 0; i < warnings.count; i++)
            reported = reported || !strcmp(warnings.warning[i].name, "zones_lost");
        assert_true(reported);
        gn_run_free(run);
        free(run);
    }
}

static void a_zone_that_has_lost_particles_resumes_with_the_same_bits(void **state) {
    (void)state;
    const char *couple[] = {NULL, "constraint: consistent", "constraint: penalty"};
    const double speed = 60.0;
    char path[] = "/tmp/gneiss-coupling-XXXXXX";
    close(mkstemp(path));
    for (int k = 0; k < 3; k++) {
        gneiss_error error = {0};
        gn_run *all[3] = {flying(couple[k], 1), flying(couple[k], 2), calloc(1, sizeof *all[2])};
        for (int r = 0; r < 2; r++) {
            gn_world *w = &all[r]->world;
            set_fields(w, fly, &speed);
            for (int n = 0; n < 100000 && gn_coupled_removed_count(&w->ctx, &w->zones) < 8; n += 10)
                run_steps(w, 10);
            assert_in_range(gn_coupled_removed_count(&w->ctx, &w->zones), 8, 19);
        }
        if (gn_checkpoint_write(all[0], path, &error) != GNEISS_OK ||
            gn_checkpoint_load(path, NULL, 0, all[2], &error) != GNEISS_OK)
            fail_msg("%s", error.message);
        for (int r = 0; r < 3; r++) run_steps(&all[r]->world, 200);
        for (int r = 1; r < 3; r++)
            assert_true(
                gn_world_hash(&all[r]->world.ctx, &all[r]->world.dem, &all[r]->world.boundary,
                              &all[r]->world.solids, &all[r]->world.box) ==
                gn_world_hash(&all[0]->world.ctx, &all[0]->world.dem, &all[0]->world.boundary,
                              &all[0]->world.solids, &all[0]->world.box));
        for (int r = 0; r < 3; r++) {
            gn_run_free(all[r]);
            free(all[r]);
        }
    }
    unlink(path);
}

/* The strip is pulled apart, and breaks in the zone, where bonds are weakest. */
static void bonds_that_break_in_a_zone_cause_a_warning(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_scene scene;
    gn_run *run = calloc(1, sizeof *run);
    strip s = small_strip(false);
    text *t = text_of(&s);
    char *at = strstr(t->s, "bond_tension_limit: 1e15");
    assert_non_null(at);
    memcpy(at, "bond_tension_limit: 24e1", 24); /* the weakened bonds break at a strain of 1e-5 */
    if (gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    free(t);
    const double strain[3] = {1.1e-5, 0.0, 0.0};
    set_fields(&run->world, stretch, strain);
    run_steps(&run->world, 2);
    /* An equal stretch breaks a bond, whatever its weight. */
    assert_int_equal(gn_coupled_broken(&run->world.dem), 6 * 6);
    gn_warnings warnings;
    assert_int_equal(gn_run_warnings(run, &warnings, NULL), GNEISS_OK);
    bool reported = false;
    for (size_t k = 0; k < warnings.count; k++)
        reported = reported || !strcmp(warnings.warning[k].name, "zones_broken");
    assert_true(reported);
    gn_run_free(run);
    free(run);
}

/* The default length and section of a test are those of the whole body, whatever part of it is
 * packed; those of a beam are compared with it. */
static void a_test_takes_its_sizes_from_all_of_the_body(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++) {
        gn_world *w = world_of(
            "dimension: %d\n"
            "specimen: {group: 1, %s, mean_radius: 1 mm, density_basis: bulk, material: m, "
            "packing: "
            "{overlap: passive, region: {min: [12 mm, 0%s], max: [28 mm, 10 mm%s]}}}\n"
            "materials: [{name: m, density: 2400, contact_modulus: 20e9, kratio: 3, friction: 0.5, "
            "tensile_strength: 4e6, shear_strength: 12e6}]\n"
            "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.1, passive_gaps: true}\n"
            "elements: {%s, materials: [{young: 20e9, poisson: 0.2, density: 2400}], motions: "
            "[{name: "
            "a, group: x_lower, motion: {vx: 0}}, {name: b, group: x_upper, motion: {vx: 1 "
            "mm/s}}]}\n"
            "couple: {convert: {box: {min: [12 mm, -1 mm%s], max: [28 mm, 11 mm%s]}, width: 4 mm, "
            "stress: 1 MPa}}\n"
            "test: {kind: tension, axis: x, lower: a, upper: b}\ntime: {end: 1 ms}\n",
            space ? 3 : 2,
            space ? "box: {size: [40 mm, 10 mm, 8 mm]}"
                  : "rectangle: {width: 40 mm, height: 10 mm}",
            space ? ", 0" : "", space ? ", 8 mm" : "",
            space ? "box: {size: [40 mm, 10 mm, 8 mm], cells: [20, 5, 4]}"
                  : "rectangle: {size: [40 mm, 10 mm], cells: [20, 5]}",
            space ? ", -1 mm" : "", space ? ", 9 mm" : "");
        print_message("# length %g m, area %g m2\n", w->ctx.test_length, w->ctx.test_area);
        assert_near(w->ctx.test_length, 40e-3, 0.1e-3);
        assert_near(w->ctx.test_area, space ? 80e-6 : 10e-3, space ? 1e-6 : 0.1e-3);
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_is_whole_through_a_zone),
        cmocka_unit_test(a_pulse_in_a_packing_leaves_nothing_where_it_began),
        cmocka_unit_test(a_zone_without_elements_or_particles_is_refused_with_its_place),
        cmocka_unit_test(where_zones_overlap_both_have_the_whole_of_the_body),
        cmocka_unit_test(overlapping_zones_keep_energy_and_turn_without_force),
        cmocka_unit_test(a_zone_across_two_materials_uses_both),
        cmocka_unit_test(a_zone_across_two_materials_keeps_energy),
        cmocka_unit_test(a_zone_may_lose_all_its_particles),
        cmocka_unit_test(a_zone_that_has_lost_particles_resumes_with_the_same_bits),
        cmocka_unit_test(bonds_that_break_in_a_zone_cause_a_warning),
        cmocka_unit_test(a_test_takes_its_sizes_from_all_of_the_body),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
