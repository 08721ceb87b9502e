#include "limit/damped.h"

#include "base/memory.h"
#include "limit/springs.h"

/* Returns a number uniformly distributed in [-1, 1) that depends on the index only. */
static double noise(size_t place) {
    return (double)((int64_t)gn_hash_place(place) >> 11) * 0x1p-52;
}

/* Argument of the operator A + 2 tau B for one tau. */
typedef struct instant {
    const gn_damped *system;
    double viscosity;
} instant;

static void apply_at(const void *context, const double *x, double *out) {
    const instant *at = context;
    at->system->apply(at->system->context, 1.0, at->viscosity, x, out);
}

static void metric_at(const void *context, const double *x, double *out) {
    const instant *at = context;
    at->system->metric(at->system->context, x, out);
}

static gn_eigen_system eigen_system(const gn_damped *system, const instant *at) {
    return (gn_eigen_system){.n = system->count,
                             .apply = apply_at,
                             .metric = system->metric ? metric_at : NULL,
                             .context = at,
                             .place = system->place,
                             .threads = system->threads};
}

/* Returns x . S x for S = stiffness A + viscosity B and unit x. */
static double quotient(const gn_damped *system, double stiffness, double viscosity, const double *x,
                       double *scratch) {
    double *weighed = scratch + system->count;
    system->apply(system->context, stiffness, viscosity, x, scratch);
    if (system->metric) system->metric(system->context, x, weighed);
    const gn_eigen_system sums = eigen_system(system, NULL);
    return gn_eigen_dot_of(&sums, system->metric ? weighed : x, scratch);
}

/* Finds the largest eigenvalue for one tau, starting with the vector x; top->rate is the resulting
 * rate. */
static gneiss_status search(const gn_damped *damped, double tau, double tolerance, double *x,
                            double *scratch, gn_damped_top *top, gneiss_error *error) {
    const instant at = {damped, 2.0 * tau};
    gn_eigen_top found;
    const gn_eigen_system system = eigen_system(damped, &at);
    GN_TRY(gn_eigen_largest(&system, tolerance, x, &found, error));
    double a = found.value, b = 0.0;
    if (damped->damped) {
        a = tau == 0.0 ? found.value : quotient(damped, 1.0, 0.0, x, scratch);
        b = quotient(damped, 0.0, 1.0, x, scratch);
    }
    if (tau == 0.0) top->frequency = sqrt(found.value);
    top->vectors += found.vectors;
    top->rate = gn_damped_rate(a, b);
    top->rate_most = gn_damped_rate(a + found.residual, b);
    return GNEISS_OK;
}

/* Returns the index in the longer vector, so that the result does not depend on which entries are
 * selected. */
static size_t place_of(const gn_damped *system, size_t k) {
    return system->place ? system->place[k] : k;
}

static gneiss_status climb(const gn_damped *system, double tolerance, double *x, double *scratch,
                           gn_damped_top *top, gneiss_error *error) {
    const size_t n = system->count, whole = system->place ? system->whole : n;
    double tau = 0.0;
    for (size_t k = 0; k < n; k++) x[k] = system->moves[k] > 0.0 ? noise(place_of(system, k)) : 0.0;
    GN_TRY(search(system, 0.0, tolerance, x, scratch, top, error));
    /* In each round the rate increases and its error is squared, so that a dozen rounds are never
     * needed. */
    for (int round = 0;
         system->damped && round < 12 && fabs(top->rate - tau) > 0.1 * tolerance * top->rate;
         round++) {
        tau = top->rate;
        /* Noise excites all modes, because another mode may have a larger rate than the one found
         * so far. */
        for (size_t k = 0; k < n; k++)
            x[k] += system->moves[k] > 0.0
                        ? 1e-2 / sqrt((double)whole) *
                              noise(place_of(system, k) + whole * (size_t)(round + 1))
                        : 0.0;
        GN_TRY(search(system, tau, tolerance, x, scratch, top, error));
    }
    return GNEISS_OK;
}

gneiss_status gn_damped_largest(const gn_damped *system, double tolerance, double *mode,
                                gn_damped_top *top, gneiss_error *error) {
    double *scratch = gn_alloc_array(system->count + 1, 2 * sizeof *scratch);
    *top = (gn_damped_top){0};
    if (!scratch)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mode of %zu components",
                       system->count);
    gneiss_status status = climb(system, tolerance, mode, scratch, top, error);
    gn_free(scratch);
    return status;
}
