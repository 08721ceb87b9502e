/* Random values of single bonds, and contacts between two materials with values of their own. */
#include "kernels/combine.h"

#include "world_helpers.h"

#include <string.h>

/* --- numbers --- */

enum { DRAWS = 100000 };

static void drawn(const gn_scatter *scatter, uint64_t seed, double *mean, double *deviation) {
    double sum = 0.0, square = 0.0;
    for (uint64_t lot = 1; lot <= DRAWS; lot++) {
        double x = gn_scatter_factor(scatter, seed, lot, 1);
        assert_true(x > 0.0 && isfinite(x));
        sum += x;
        square += x * x;
    }
    *mean = sum / DRAWS;
    *deviation = sqrt(square / DRAWS - *mean * *mean);
}

/* Four standard errors: of the mean s/sqrt(n), of the deviation s sqrt((kurtosis - 1)/(4 n)), with
 * a kurtosis of 9 at most (the exponential distribution, modulus 1). */
static void weibull_numbers_have_mean_one_and_the_deviation_of_their_modulus(void **state) {
    (void)state;
    const double moduli[] = {1.0, 2.0, 8.0, 50.0};
    for (int k = 0; k < 4; k++) {
        const gn_scatter scatter = {GN_SCATTER_WEIBULL, moduli[k], 0.0};
        double m = moduli[k], mean, s, one = tgamma(1.0 + 1.0 / m);
        double want = sqrt(tgamma(1.0 + 2.0 / m) / (one * one) - 1.0);
        drawn(&scatter, 3 + (uint64_t)k, &mean, &s);
        assert_near(mean, 1.0, 4.0 * want / sqrt(DRAWS));
        assert_near(s, want, 4.0 * want * sqrt(2.0 / DRAWS));
    }
}

static void normal_numbers_have_the_deviation_asked_for(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double deviation[] = {0.01, 0.1, 0.33}, cut = 1.0 / deviation[k];
        const gn_scatter scatter = {GN_SCATTER_NORMAL, 0.0, deviation[k]};
        double mean, s;
        drawn(&scatter, 5, &mean, &s);
        /* The distribution is cut at 0 and 2, which matters if these are three deviations away. */
        double density = exp(-0.5 * cut * cut) / sqrt(2.0 * pi), inside = erf(cut / sqrt(2.0));
        double want = deviation[k] * sqrt(1.0 - 2.0 * cut * density / inside);
        assert_near(mean, 1.0, 4.0 * want / sqrt(DRAWS));
        assert_near(s, want, 4.0 * want * sqrt(0.5 / DRAWS));
    }
}

/* The largest distance of the distributions function (Kolmogorov), 1 in 1e5 by chance. */
static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void weibull_numbers_have_their_distribution(void **state) {
    (void)state;
    enum { N = 20000 };
    static double x[N];
    const gn_scatter scatter = {GN_SCATTER_WEIBULL, 4.0, 0.0};
    double most = 0.0;
    for (int k = 0; k < N; k++) x[k] = gn_scatter_factor(&scatter, 11, 1 + (uint64_t)k, 1);
    qsort(x, N, sizeof *x, ascending);
    for (int k = 0; k < N; k++)
        most = fmax(most, fabs(1.0 - exp(-pow(x[k] * tgamma(1.25), 4.0)) - (k + 0.5) / N));
    assert_true(most < 2.47 / sqrt(N));
}

/* The correlation of n independent pairs scatters by 1/sqrt(n). */
static void strength_and_stiffness_are_drawn_apart(void **state) {
    (void)state;
    const gn_scatter kinds[] = {{GN_SCATTER_WEIBULL, 4.0, 0.0}, {GN_SCATTER_NORMAL, 0.0, 0.2}};
    for (int k = 0; k < 4; k++) {
        double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
        for (uint64_t lot = 1; lot <= DRAWS; lot++) {
            double a = gn_scatter_factor(&kinds[k / 2], 2, lot, 1) - 1.0,
                   b = gn_scatter_factor(&kinds[k % 2], 2, lot, 2) - 1.0;
            x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
        }
        double sx = sqrt(xx / DRAWS - x * x / DRAWS / DRAWS),
               sy = sqrt(yy / DRAWS - y * y / DRAWS / DRAWS);
        assert_near((xy / DRAWS - x / DRAWS * y / DRAWS) / (sx * sy), 0.0, 4.0 / sqrt(DRAWS));
    }
}

static void pairs_without_a_bond_draw_no_random_number(void **state) {
    (void)state;
    const gn_scatter scatter = {GN_SCATTER_WEIBULL, 4.0, 0.0}, none = {0};
    assert_true(gn_scatter_factor(&scatter, 1, 0, 1) == 1.0);
    assert_true(gn_scatter_factor(&none, 1, 7, 1) == 1.0);
}

/* --- bonds --- */

/* A row of bonded spheres along x; the last one is pulled. */
static gn_world *chain(int count, const char *material, const char *law, const char *more) {
    text *t = calloc(1, sizeof *t);
    add(t, "specimen: {particles: [");
    for (int k = 0; k < count; k++) add(t, "%s[%g, 0, 0, 1e-3]", k ? ", " : "", 2e-3 * k);
    add(t, "]}\nmaterials: [{name: m, density: 2500, %s}]\nlaw: %s\nbonds: {}\n%s", material, law,
        more);
    gn_world *w = world_of("%s", t->s);
    free(t);
    return w;
}

static const char *const linear = "contact_modulus: 8e9, kratio: 2.5, tensile_strength: 3e6, "
                                  "shear_strength: 5e6",
                         *const area = "young: 8e9, poisson: 0.2, tensile_strength: 3e6, "
                                       "shear_strength: 5e6",
                         *const ends = "time: {end: 1}\nrun: {threads: 1, seed: 9}\n";

/* A bond's factors depend on the ids of its ends, for any law, and are the same for both strengths.
 * */
static void bonds_draw_by_the_ids_of_their_ends(void **state) {
    (void)state;
    const char *scatters = ", strength_scatter: {distribution: weibull, modulus: 5}, "
                           "stiffness_scatter: {distribution: normal, deviation: 0.2}";
    for (int law = 0; law < 2; law++) {
        char material[512];
        snprintf(material, sizeof material, "%s%s", law ? area : linear, scatters);
        const char *name = law ? "{stiffness: dempack}" : "{stiffness: harmonic}";
        gn_world *plain = chain(20, law ? area : linear, name, ends),
                 *w = chain(20, material, name, ends);
        const gn_contacts *a = &plain->dem.bonds.contacts, *b = &w->dem.bonds.contacts;
        assert_int_equal(b->soa.count, 19);
        for (size_t c = 0; c < 19; c++) {
            int32_t i = w->dem.particles.id[b->i[c]], j = w->dem.particles.id[b->j[c]];
            uint64_t low = (uint64_t)(i < j ? i : j), high = (uint64_t)(i < j ? j : i);
            double strength = gn_scatter_factor(&w->ctx.scene.materials[0].strength_scatter, 9,
                                                1 + (low << 32 | high), 1);
            double stiffness = gn_scatter_factor(&w->ctx.scene.materials[0].stiffness_scatter, 9,
                                                 1 + (low << 32 | high), 2);
            assert_close(b->rn[c], a->rn[c] * strength, 1e-15);
            assert_close(b->rt[c], a->rt[c] * strength, 1e-15);
            assert_close(b->kn[c], a->kn[c] * stiffness, 1e-15);
            assert_close(b->kt[c], a->kt[c] * stiffness, 1e-15);
            assert_true(strength != 1.0 && stiffness != 1.0);
        }
        /* The step is that of the stiffest bond: the limit decreases with it. */
        assert_true(w->ctx.choice.limit.sharp < plain->ctx.choice.limit.sharp);
        world_end(plain);
        world_end(w);
    }
}

/* The dashpots of bonds use the drawn stiffness, at the start and when the step changes. */
static void dashpots_are_those_of_the_drawn_stiffness(void **state) {
    (void)state;
    char material[512];
    snprintf(material, sizeof material,
             "%s, stiffness_scatter: {distribution: weibull, modulus: 2}", area);
    gn_world *w = chain(10, material, "{stiffness: polyhedron}",
                        "damping: {contact: {fraction: 0.3}}\ntime: {step: 1e-9, end: 1}\n"
                        "run: {threads: 1}\n");
    const gn_contacts *b = &w->dem.bonds.contacts;
    for (size_t c = 0; c < b->soa.count; c++) {
        double mass = mass_of(w, 0) / 2.0, most = 0.6 * sqrt(mass * b->kn[c]);
        /* The dashpot is reduced by the correction for a step of that many radians, see
         * kernels/dashpot.h. */
        double turn = sqrt(b->kn[c] / mass) * w->ctx.dt;
        assert_true(b->cn[c] <= most && b->cn[c] >= most * (1.0 - turn));
    }
    world_end(w);
}

static gn_world *shaken(double step) {
    char time[64] = "{end: 1}";
    if (step > 0.0) snprintf(time, sizeof time, "{end: 1, step: %.17g, on_unstable: warn}", step);
    return world_of(
        "specimen: {lattice: {kind: fcc, radius: 1e-3, cells: [2, 2, 2], jitter: 0.03}}\n"
        "materials: [{name: m, density: 2500, young: 8e9, poisson: 0.2, tensile_strength: 1e90, "
        "shear_strength: 1e90, stiffness_scatter: {distribution: weibull, modulus: 1}}]\n"
        "law: {stiffness: polyhedron}\nbonds: {interaction_range: 0.1}\n"
        "initial: {random_velocity: 1e-6}\ntime: %s\nrun: {threads: 1}\n",
        time);
}

/* Bonds of drawn stiffness, exponentially distributed: below the limit the energy stays, above it
 * multiplies, at 1.05 times the limit by exp(2 acosh(2 1.05^2 - 1)) = 3.6 in two steps. */
static void the_limit_is_that_of_the_drawn_stiffness(void **state) {
    (void)state;
    gn_world *w = shaken(0.0);
    double limit = w->ctx.choice.limit.sharp;
    world_end(w);
    const double shares[] = {0.99, 1.05};
    for (int k = 0; k < 2; k++) {
        w = shaken(shares[k] * limit);
        double first = measured_step(w).kinetic, most = 0.0;
        for (int step = 0; step < 300 && most < 1e6 * first; step++)
            most = fmax(most, fabs(measured_step(w).kinetic)); /* v(-) v(+): negative above */
        if (k == 0) assert_true(most < 10.0 * first);          /* 50 in the fastest of many modes */
        if (k == 1) assert_true(most >= 1e6 * first);
        world_end(w);
    }
}

/* A chain is as strong as its weakest bond. With Weibull's numbers of modulus m and n bonds its
 * strength has the mean n^(-1/m), and the same relative scatter as one bond. */
static void a_chain_is_weaker_by_the_modulus_root_of_its_length(void **state) {
    (void)state;
    enum { CHAINS = 60, BONDS = 40 };
    const double m = 6.0, one = tgamma(1.0 + 1.0 / m);
    double sum = 0.0, whole = 0.0;
    for (int seed = 1; seed <= CHAINS; seed++) {
        char material[512], more[128];
        snprintf(material, sizeof material,
                 "%s, strength_scatter: {distribution: weibull, modulus: 6}", linear);
        snprintf(more, sizeof more, "time: {end: 1}\nrun: {threads: 1, seed: %d}\n", seed);
        gn_world *w = chain(BONDS + 1, material, "{stiffness: harmonic}", more);
        double least = INFINITY;
        for (size_t c = 0; c < BONDS; c++) least = fmin(least, w->dem.bonds.contacts.rn[c]);
        sum += least;
        whole = 4.0 * 3e6 * 1e-6;
        world_end(w);
    }
    double want = pow(BONDS, -1.0 / m), cv = sqrt(tgamma(1.0 + 2.0 / m) / (one * one) - 1.0);
    assert_close(sum / CHAINS / whole, want, 4.0 * cv / sqrt(CHAINS));
}

/* The chain is pulled slowly, with damping: a wave crosses it five times before the break. */
static void a_chain_breaks_where_it_is_weakest(void **state) {
    (void)state;
    char material[512];
    snprintf(material, sizeof material, "%s, strength_scatter: {distribution: weibull, modulus: 3}",
             area);
    gn_world *w = chain(8, material, "{stiffness: dempack, gamma: 1}",
                        "damping: {background: {model: nonviscous_component, coefficient: 0.5}}\n"
                        "sets:\n  - {name: a, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0}}\n"
                        "  - {name: b, select: {ids: [7]}, motion: {vx: 0.01, vy: 0, vz: 0}}\n"
                        "time: {end: 1}\nrun: {threads: 1}\n");
    const gn_contacts *b = &w->dem.bonds.contacts;
    size_t weakest = 0;
    for (size_t c = 0; c < b->soa.count; c++)
        if (b->rn[c] < b->rn[weakest]) weakest = c;
    double strength = b->rn[weakest], stretch = 7.0 * strength / b->kn[0];
    while (w->dem.broken_tension == 0 && w->ctx.time * 0.01 < 2.0 * stretch) run_steps(w, 1);
    assert_int_equal(w->dem.broken_tension, 1);
    assert_int_equal(b->cause[weakest], GN_BROKEN_TENSION);
    assert_close(w->ctx.time * 0.01, stretch, 0.05); /* waves: v/c over the strain at the break */
    world_end(w);
}

/* --- contacts between materials --- */

/* Three bonded spheres in a row: rock, rock, steel. */
static gneiss_status try_three(const char *law, const char *contacts, gn_world *w,
                               gneiss_error *error) {
    char scene[2048];
    snprintf(
        scene, sizeof scene,
        "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [4e-3, 0, 0, 1e-3]], "
        "material: rock}\nmaterials:\n"
        "  - {name: rock, density: 2500, contact_modulus: 8e9, normal_stiffness: 1e7, young: 8e9, "
        "poisson: 0.2, kratio: 2, friction: 0.5, tensile_strength: 3e6, shear_strength: 5e6, "
        "bond_tension_limit: 3, bond_shear_limit: 5}\n"
        "  - {name: steel, density: 7800, contact_modulus: 24e9, normal_stiffness: 3e7, "
        "young: 24e9, poisson: 0.3, kratio: 3, friction: 0.7, tensile_strength: 4e6, "
        "shear_strength: 6e6, bond_tension_limit: 4, bond_shear_limit: 6}\n"
        "law: {stiffness: %s}\nbonds: {}\n%s"
        "sets: [{name: s, select: {ids: [2]}, material: steel}]\ntime: {end: 1}\n"
        "run: {threads: 1}\n",
        law, contacts);
    return world_try(w, scene, NULL, error);
}

static void three(const char *law, const char *contacts, gn_world *w) {
    gneiss_error error = {0};
    if (try_three(law, contacts, w, &error) != GNEISS_OK) fail_msg("%s", error.message);
    assert_int_equal(w->dem.bonds.contacts.soa.count, 2);
}

/* Returns the bond of particle 0, or that of particle 2. */
static size_t bond_of(const gn_world *w, int id) {
    for (size_t c = 0; c < 2; c++)
        if (w->dem.particles.id[w->dem.bonds.contacts.i[c]] == id ||
            w->dem.particles.id[w->dem.bonds.contacts.j[c]] == id)
            return c;
    fail();
    return 0;
}

static void a_pair_has_its_own_values_and_combines_the_others(void **state) {
    (void)state;
    gn_world w, plain;
    three("harmonic", "", &plain);
    const char *orders[] = {"[rock, steel]", "[steel, rock]"};
    for (int k = 0; k < 2; k++) {
        char contacts[256];
        snprintf(contacts, sizeof contacts,
                 "contacts: [{between: %s, friction: 0.2, kratio: 4, tensile_strength: 1e6}]\n",
                 orders[k]);
        three("harmonic", contacts, &w);
        size_t own = bond_of(&w, 2), other = bond_of(&w, 0), was = bond_of(&plain, 2);
        const gn_contacts *b = &w.dem.bonds.contacts, *p = &plain.dem.bonds.contacts;
        assert_true(b->kn[own] == p->kn[was] && b->rt[own] == p->rt[was]);
        assert_close(b->kt[own], b->kn[own] / 4.0, 1e-15);
        assert_true(b->mu[own] == 0.2);
        assert_close(b->rn[own], 4.0 * 1e6 * 1e-6, 1e-15);
        was = bond_of(&plain, 0);
        assert_true(b->kn[other] == p->kn[was] && b->kt[other] == p->kt[was] &&
                    b->mu[other] == p->mu[was] && b->rn[other] == p->rn[was] &&
                    b->rt[other] == p->rt[was]);
        gn_world_free(&w);
    }
    gn_world_free(&plain);
}

static void every_law_reads_values_of_a_pair(void **state) {
    (void)state;
    gn_world w;
    three("uniform",
          "contacts: [{between: [rock, steel], normal_stiffness: 5e6, "
          "bond_tension_limit: 1, bond_shear_limit: 2}]\n",
          &w);
    size_t c = bond_of(&w, 2);
    assert_true(w.dem.bonds.contacts.kn[c] == 5e6 && w.dem.bonds.contacts.rn[c] == 1.0 &&
                w.dem.bonds.contacts.rt[c] == 2.0);
    gn_world_free(&w);
    three("mean_radius", "contacts: [{between: rock, contact_modulus: 1e9}]\n", &w);
    assert_close(w.dem.bonds.contacts.kn[bond_of(&w, 0)], 2e9 * 1e-3, 1e-15);
    assert_close(w.dem.bonds.contacts.kn[bond_of(&w, 2)], 2.0 * 12e9 * 1e-3, 1e-15);
    gn_world_free(&w);
    three("dempack, gamma: 1",
          "contacts: [{between: [steel, rock], young: 4e9, poisson: 0, alpha: 2, beta: 3}]\n", &w);
    c = bond_of(&w, 2);
    double bar = pi * 1e-6 / 2e-3;
    assert_close(w.dem.bonds.contacts.kn[c], 2.0 * 4e9 * bar, 1e-14);
    assert_close(w.dem.bonds.contacts.kt[c], 3.0 * 2e9 * bar, 1e-14);
    gn_world_free(&w);
}

/* If only a pair has friction in its strength, the scene has such bonds. */
static void bonds_of_a_pair_have_a_friction_of_their_own(void **state) {
    (void)state;
    gn_world w;
    three("harmonic", "contacts: [{between: [rock, steel], bond_friction: 0.7}]\n", &w);
    assert_true(w.ctx.effects & GN_FX_MOHR);
    assert_true(w.dem.bonds.contacts.mu1[bond_of(&w, 2)] == 0.7 &&
                w.dem.bonds.contacts.mu1[bond_of(&w, 0)] == 0.0);
    gn_world_free(&w);
}

/* Friction or a tangential spring given only for a pair of materials counts as friction of the
 * scene. */
static void friction_of_a_pair_alone_is_friction(void **state) {
    (void)state;
    gn_world *w =
        world_of("specimen: {particles: [[0, 0, 0, 1e-3], [2.1e-3, 0, 0, 1e-3]]}\n"
                 "materials: [{name: m, density: 1, normal_stiffness: 1e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\ncontacts: [{between: m, friction: 0.3, kratio: 2}]\n"
                 "neighbours: {skin: 1e-3}\ntime: {end: 1}\nrun: {threads: 1}\n");
    assert_true(w->ctx.effects & GN_FX_SHEAR && w->ctx.effects & GN_FX_FRICTION);
    assert_int_equal(w->dem.pairs.contacts.soa.count, 1);
    assert_true(w->dem.pairs.contacts.mu[0] == 0.3 && w->dem.pairs.contacts.kt[0] == 5e5);
    world_end(w);
}

/* Loose particles far apart: the first step is that of the stiffest pair that can meet. */
static void the_first_step_includes_the_stiffness_of_pairs(void **state) {
    (void)state;
    double stable[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = world_of(
            "specimen: {particles: [[0, 0, 0, 1e-3], [1, 0, 0, 1e-3]], material: a}\n"
            "materials: [{name: a, density: 1, normal_stiffness: 1e6, kratio: 0}, "
            "{name: b, density: 1, normal_stiffness: 1e6, kratio: 0}]\nlaw: {stiffness: uniform}\n"
            "%ssets: [{name: s, select: {ids: [1]}, material: b}]\ntime: {end: 1}\n"
            "run: {threads: 1}\n",
            k ? "contacts: [{between: [b, a], normal_stiffness: 4e6}]\n" : "");
        stable[k] = w->ctx.choice.stable;
        world_end(w);
    }
    assert_close(stable[1], 0.5 * stable[0], 1e-12);
}

static void refuse(const char *law, const char *contacts, const char *expected) {
    gneiss_error error = {0};
    gn_world w;
    assert_int_equal(try_three(law, contacts, &w, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, expected)) fail_msg("%s", error.message);
}

static void wrong_keys_of_a_pair_are_refused_at_their_line(void **state) {
    (void)state;
    refuse("harmonic", "contacts: [{between: [rock, stel]}]\n",
           "s.yaml:7:22: contacts[0].between: expected the name of a material, found 'stel'; did "
           "you mean 'steel'?");
    refuse("harmonic", "contacts: [{between: [rock, steel, rock]}]\n",
           "contacts[0].between: expected one or two materials, found 3");
    refuse("harmonic", "contacts: [{between: [rock, steel]}, {between: [steel, rock]}]\n",
           "contacts[1].between: expected a unique pair, found 'steel' and 'rock' a second time");
    refuse("harmonic", "contacts: [{friction: 1}, {between: rock}]\n",
           "contacts[0].between: required, but not given");
    refuse("harmonic", "contacts: [{between: rock, young: 1}]\n",
           "s.yaml:7:35: contacts[0].young: expected a value that this law.stiffness and "
           "law.softening read, found one that they ignore");
    refuse("harmonic", "contacts: [{between: rock, fracture_energy: 1}]\n",
           "contacts[0].fracture_energy: expected a value that this law.stiffness and "
           "law.softening read");
    refuse("harmonic", "contacts: [{between: rock, friction: -1}]\n",
           "contacts[0].friction: expected a value in [0, 1e30] or 'combined', found '-1'");
    refuse("harmonic", "contacts: [{between: rock, kratio: 1e-9}]\n",
           "contacts[0].kratio: expected 0 (no tangential spring) or at least 1e-6, found 1e-09");
}

static void parameters_of_a_distribution_are_required(void **state) {
    (void)state;
    const char *const wrong[][2] = {
        {"{distribution: weibull}", "materials[0].strength_scatter.modulus: required by the "
                                    "distribution, but not given"},
        {"{distribution: normal, modulus: 3}",
         "materials[0].strength_scatter.deviation: required by the distribution, but not given"},
        {"{distribution: normal, deviation: 0.1, modulus: 3}",
         "materials[0].strength_scatter.modulus: expected to be left out with this distribution"},
        {"{distribution: normal, deviation: 0.5}",
         "strength_scatter.deviation: expected a value in [1e-6, 0.33]"},
        {"{distribution: weibul, modulus: 3}", "did you mean 'weibull'?"},
        {"{modulus: 3}", "strength_scatter.distribution: required, but not given"}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        char scene[1024];
        gneiss_error error = {0};
        gn_world w;
        snprintf(scene, sizeof scene,
                 "specimen: {particles: [[0, 0, 0, 1], [2, 0, 0, 1]]}\n"
                 "materials: [{name: m, density: 1, %s, strength_scatter: %s}]\n"
                 "law: {stiffness: harmonic}\nbonds: {}\ntime: {end: 1}\n",
                 linear, wrong[k][0]);
        assert_int_equal(world_try(&w, scene, NULL, &error), GNEISS_ERROR_INPUT);
        if (!strstr(error.message, wrong[k][1])) fail_msg("%s", error.message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weibull_numbers_have_mean_one_and_the_deviation_of_their_modulus),
        cmocka_unit_test(normal_numbers_have_the_deviation_asked_for),
        cmocka_unit_test(weibull_numbers_have_their_distribution),
        cmocka_unit_test(strength_and_stiffness_are_drawn_apart),
        cmocka_unit_test(pairs_without_a_bond_draw_no_random_number),
        cmocka_unit_test(bonds_draw_by_the_ids_of_their_ends),
        cmocka_unit_test(dashpots_are_those_of_the_drawn_stiffness),
        cmocka_unit_test(the_limit_is_that_of_the_drawn_stiffness),
        cmocka_unit_test(a_chain_is_weaker_by_the_modulus_root_of_its_length),
        cmocka_unit_test(a_chain_breaks_where_it_is_weakest),
        cmocka_unit_test(a_pair_has_its_own_values_and_combines_the_others),
        cmocka_unit_test(every_law_reads_values_of_a_pair),
        cmocka_unit_test(bonds_of_a_pair_have_a_friction_of_their_own),
        cmocka_unit_test(friction_of_a_pair_alone_is_friction),
        cmocka_unit_test(the_first_step_includes_the_stiffness_of_pairs),
        cmocka_unit_test(wrong_keys_of_a_pair_are_refused_at_their_line),
        cmocka_unit_test(parameters_of_a_distribution_are_required),
    };
    return cmocka_run_group_tests_name("scatter", tests, NULL, NULL);
}
