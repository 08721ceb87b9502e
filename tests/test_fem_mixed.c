/* The mixed form of finite elements. */
#include "cook.h"
static void cook_converges(void **state) {
    (void)state;
    for (int form = 0; form < 2; form++)
        for (int n = 4; n <= 32; n *= 2) {
            cook c = {.form = form, .poisson = 0.4999, .scale = 1e-4, .cells = n, .slanted = false};
            gn_fem_body *body = cook_at_rest(&c);
            gn_fem_limit l = fem_limits(body);
            print_message("# form %d cells %d: %.4f steps %ld time %g bound/sharp %.3f sharp %g it %d resid %.2g e %.4g\n", form, n, cook_deflection(body, &c), (long)body->step, body->time, l.bound/l.sharp, l.sharp, l.iterations, gn_fem_energy_residual(&body->reading)/body->reading.work_applied, body->reading.damping/body->reading.work_applied);
            body_end(body);
        }
}
int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cook_converges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
