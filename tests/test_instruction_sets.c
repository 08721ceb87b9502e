/* The list of instruction sets: the choice from it, and messages about unsupported sets. */
#include "test.h"

#include "kernels/dispatch.h"

static bool is_built(const char *name) {
    for (int k = 0; k < GN_KERNEL_SETS; k++)
        if (strcmp(gn_kernel_set_at(k)->name, name) == 0) return true;
    return false;
}

static void every_set_of_this_build_can_be_named(void **state) {
    (void)state;
    int named = 0;
    for (gn_isa isa = GN_ISA_AUTO + 1; isa < GN_ISA_COUNT; isa++)
        named += is_built(gn_isa_name(isa));
    assert_int_equal(named, GN_KERNEL_SETS);
}

static void sets_are_ordered_from_narrow_to_wide(void **state) {
    (void)state;
    assert_string_equal(gn_kernel_set_at(0)->name, "scalar");
    assert_int_equal(gn_kernel_set_at(0)->lanes, 1);
    for (int k = 1; k < GN_KERNEL_SETS; k++)
        assert_true(gn_kernel_set_at(k)->lanes > gn_kernel_set_at(k - 1)->lanes);
}

static void every_set_of_this_machine_is_found_by_its_name(void **state) {
    (void)state;
    for (int k = 0; k < GN_KERNEL_SETS; k++) {
        const gn_kernel_set *set = gn_kernel_set_at(k), *chosen = NULL;
        gneiss_error error;
        if (!gn_kernel_set_supported(set)) continue;
        assert_int_equal(gn_kernel_set_choose(set->name, &chosen, &error), GNEISS_OK);
        assert_ptr_equal(chosen, set);
    }
}

/* A scene may name any instruction set that exists, wherever the scene was written. */
static void an_unavailable_set_is_refused_and_available_ones_are_named(void **state) {
    (void)state;
    for (gn_isa isa = GN_ISA_AUTO + 1; isa < GN_ISA_COUNT; isa++) {
        const gn_kernel_set *chosen = NULL;
        gneiss_error error;
        const char *name = gn_isa_name(isa);
        if (is_built(name)) continue;
        assert_int_equal(gn_kernel_set_choose(name, &chosen, &error), GNEISS_ERROR_INPUT);
        assert_non_null(strstr(error.message, name));
        assert_non_null(strstr(error.message, "(scalar"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_set_of_this_build_can_be_named),
        cmocka_unit_test(sets_are_ordered_from_narrow_to_wide),
        cmocka_unit_test(every_set_of_this_machine_is_found_by_its_name),
        cmocka_unit_test(an_unavailable_set_is_refused_and_available_ones_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
