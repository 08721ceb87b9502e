/* Small assemblies for the tests of the stable step. */
#ifndef GN_TESTS_TIMESTEP_SPECIMEN_H
#define GN_TESTS_TIMESTEP_SPECIMEN_H

#include "test.h"

#include "base/eigen.h"
#include "limit/step_limits.h"
#include "soa/records.h"

static const double pi = 3.14159265358979323846;

typedef struct specimen {
    gn_particles p;
    gn_contacts bonds;
    gn_wall_contacts walls;
    gn_assembly assembly;
    gn_spectrum spectrum;
    uint8_t *fixed;
} specimen;

static const gn_effects all_effects =
    GN_FX_ROTATION | GN_FX_SHEAR | GN_FX_BONDS | GN_FX_CONTACT_DAMPING;

/* Particles without contacts; `xyzr` [count][4]; density 2650. Disc: mass per unit thickness. */
static inline specimen *make(int dimension, size_t count, const double *xyzr, gn_effects effects) {
    specimen *s = calloc(1, sizeof *s);
    if (dimension == 3) effects |= GN_FX_SPACE;
    assert_int_equal(gn_soa_create(&gn_particle_record, &s->p, count, effects, NULL), GNEISS_OK);
    for (size_t i = 0; i < count; i++) {
        const double r = xyzr[4 * i + 3];
        double m = 2650.0 * (dimension == 3 ? 4.0 / 3.0 * pi * r * r * r : pi * r * r);
        memcpy(s->p.pos + 4 * i, xyzr + 4 * i, 4 * sizeof(double));
        s->p.vel[4 * i + 3] = 1.0 / m;
        if (s->p.spin) s->p.spin[4 * i + 3] = 1.0 / ((dimension == 3 ? 0.4 : 0.5) * m * r * r);
        s->p.id[i] = (int32_t)(count - 1 - i); /* the id differs from the index, so that a confusion
                                                  of the two is found */
    }
    s->fixed = calloc(count + 1, 1);
    s->assembly = (gn_assembly){.dimension = dimension, .particles = &s->p};
    s->spectrum =
        (gn_spectrum){.assembly = &s->assembly, .arm_factor = 0.5, .fixed = s->fixed, .threads = 2};
    return s;
}

static inline void destroy(specimen *s) {
    gn_soa_destroy(&gn_particle_record, &s->p);
    gn_soa_destroy(&gn_contact_record, &s->bonds);
    gn_soa_destroy(&gn_wall_contact_record, &s->walls);
    free(s->fixed);
    free(s);
}

static inline double separation(const specimen *s, size_t i, size_t j, double d[3]) {
    for (int k = 0; k < 3; k++) {
        d[k] = s->p.pos[4 * j + k] - s->p.pos[4 * i + k];
        double period = s->assembly.period[k];
        if (s->assembly.periodic && period > 0.0) d[k] -= period * round(d[k] / period);
    }
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static inline double inverse_mass(const specimen *s, size_t i) {
    return s->p.vel[4 * i + 3];
}

/* Bonds all pairs with a gap up to `range` (r_i + r_j): harmonic stiffness of modulus 10 GPa,
 * k_t = k_n/kratio (0: none), damping fraction alpha. */
static inline void bond(specimen *s, double range, double kratio, double alpha) {
    for (int pass = 0; pass < 2; pass++) {
        size_t at = 0;
        for (size_t i = 0; i < s->p.soa.count; i++)
            for (size_t j = i + 1; j < s->p.soa.count; j++) {
                double d[3], ri = s->p.pos[4 * i + 3], rj = s->p.pos[4 * j + 3];
                double distance = separation(s, i, j, d);
                if (distance > (1.0 + range) * (ri + rj) * (1.0 + 1e-9)) continue;
                if (pass) {
                    gn_contacts *b = &s->bonds;
                    b->i[at] = (int32_t)i;
                    b->j[at] = (int32_t)j;
                    b->kn[at] = 2.0 * 10e9 * 2.0 * ri * rj / (ri + rj);
                    if (b->kt) b->kt[at] = kratio > 0.0 ? b->kn[at] / kratio : 0.0;
                    if (b->cn)
                        b->cn[at] = 2.0 * alpha *
                                    sqrt(b->kn[at] / (inverse_mass(s, i) + inverse_mass(s, j)));
                    if (b->rn) b->rn[at] = 1.0;
                    if (b->length0) b->length0[at] = distance;
                }
                at++;
            }
        if (pass) break;
        assert_int_equal(gn_soa_create(&gn_contact_record, &s->bonds, at, s->p.soa.effects, NULL),
                         GNEISS_OK);
        s->assembly.list[0] = &s->bonds;
    }
}

static inline gn_step_limit limits_of(const specimen *s, double tolerance) {
    gn_step_limit limit, only;
    gneiss_error error = {0};
    if (gn_step_limits(&s->spectrum, tolerance, &limit, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    assert_int_equal(gn_step_limits(&s->spectrum, 0.0, &only, &error), GNEISS_OK);
    assert_memory_equal(&only.bound, &limit.bound, sizeof only.bound);
    if (!(limit.bound <= limit.sharp_low && limit.sharp_low <= limit.sharp * (1.0 + 1e-12)))
        fail_msg("bound %.17g <= sharp_low %.17g <= sharp %.17g does not hold", limit.bound,
                 limit.sharp_low, limit.sharp);
    return limit;
}

/* `count` particles of radius 1 mm in a row along x, just touching, bonded. */
static inline specimen *chain(size_t count, double kratio, double alpha, gn_effects effects) {
    double *x = calloc(count, 4 * sizeof *x);
    for (size_t i = 0; i < count; i++) {
        x[4 * i] = 2e-3 * (double)i;
        x[4 * i + 3] = 1e-3;
    }
    specimen *s = make(3, count, x, effects);
    free(x);
    bond(s, 0.0, kratio, alpha);
    return s;
}

/* The spheres of rock-b whose centres are in the lower `height` metres. */
static inline specimen *rock(double height, gn_effects effects) {
    char path[4096], line[512];
    snprintf(path, sizeof path, "%s/scenes/specimens/rock-b.txt", test_source());
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    double *x = calloc(20000, 4 * sizeof *x);
    size_t count = 0;
    while (fgets(line, sizeof line, file)) {
        double *row = x + 4 * count;
        if (sscanf(line, "%lf %lf %lf %lf", row, row + 1, row + 2, row + 3) == 4 && row[2] < height)
            count++;
    }
    fclose(file);
    specimen *s = make(3, count, x, effects);
    free(x);
    return s;
}

#endif
