#include "kernels/dispatch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define X(set, lanes, has)                                                                         \
    static bool machine_has_##set(void) {                                                          \
        return has;                                                                                \
    }
GN_INSTRUCTION_SETS(X)
#undef X

#define X(set, lanes, has)                                                                         \
    {#set,                                                                                         \
     lanes,                                                                                        \
     machine_has_##set,                                                                            \
     gn_contact_table_##set,                                                                       \
     gn_contact_table_##set##_mixed,                                                               \
     gn_motion_table_##set,                                                                        \
     gn_element_table_##set,                                                                       \
     gn_element_table_##set##_mixed,                                                               \
     gn_dilation_table_##set,                                                                      \
     gn_pressure_table_##set,                                                                      \
     &gn_near_table_##set},
static const gn_kernel_set sets[GN_KERNEL_SETS] = {GN_INSTRUCTION_SETS(X)};
#undef X

const gn_kernel_set *gn_kernel_set_at(int index) {
    return &sets[index];
}

bool gn_kernel_set_supported(const gn_kernel_set *set) {
    return set->supported();
}

static void supported_names(char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < GN_KERNEL_SETS && used < size; k++)
        if (gn_kernel_set_supported(&sets[k]))
            used +=
                (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "", sets[k].name);
}

gneiss_status gn_kernel_set_choose(const char *name, const gn_kernel_set **set,
                                   gneiss_error *error) {
    const char *origin = "isa";
    if (!name || strcmp(name, "auto") == 0) {
        name = getenv("GNEISS_ISA");
        origin = "GNEISS_ISA";
    }
    bool automatic = !name || !*name || strcmp(name, "auto") == 0;
    for (int k = GN_KERNEL_SETS - 1; k >= 0; k--) {
        if (!automatic && strcmp(name, sets[k].name) != 0) continue;
        if (!gn_kernel_set_supported(&sets[k])) continue;
        *set = &sets[k];
        return GNEISS_OK;
    }
    char names[64];
    supported_names(names, sizeof names);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected an instruction set that this machine runs (%s), found '%s'",
                   origin, names, name);
}

/* --- variants --- */

typedef struct effect_bit {
    unsigned bit;
    gn_effects effect;
    gn_effect_index index;
} effect_bit;

#define X(bit, NAME) {bit, GN_FX_##NAME, GN_FX_INDEX_##NAME},
static const effect_bit option_bits[] = {GN_CONTACT_OPTIONS(X)};
static const effect_bit motion_bits[] = {GN_MOTION_EFFECTS(X)};
#undef X

#define COUNT(table) (sizeof(table) / sizeof *(table))

static unsigned variant_of(const effect_bit *bits, size_t count, gn_effects effects) {
    unsigned variant = 0;
    for (size_t k = 0; k < count; k++)
        if (effects & bits[k].effect) variant |= 1u << bits[k].bit;
    return variant;
}

static gn_effects effects_of(const effect_bit *bits, size_t count, unsigned variant) {
    gn_effects effects = 0;
    for (size_t k = 0; k < count; k++)
        if (variant >> bits[k].bit & 1) effects |= bits[k].effect;
    return effects;
}

static void name_of(const char *stem, const effect_bit *bits, size_t count, unsigned variant,
                    char *name, size_t size) {
    size_t used = (size_t)snprintf(name, size, "%s", stem);
    for (size_t k = 0; k < count && used < size; k++)
        if (variant >> bits[k].bit & 1)
            used +=
                (size_t)snprintf(name + used, size - used, "_%s", gn_effect_name(bits[k].index));
}

/* Effects that distinguish kinds of lists. */
#define X(name, effect, lists) | (effect)
static const gn_effects makers = GN_FX_SHEAR | GN_FX_FRICTION | GN_FX_BONDS GN_LAWS(X);
#undef X

#define X(name, effect, lists) law_##name = (effect),
enum { GN_LAWS(X) };
#undef X

static const struct {
    const char *stem;
    gn_effects effects;
} kinds[] = {
#define X(number, name, body, law, shear, friction, bonds)                                         \
    {"contact_" #name, law_##law | (shear ? GN_FX_SHEAR : 0U) | (friction ? GN_FX_FRICTION : 0U) | \
                           (bonds ? GN_FX_BONDS : 0U)},
    GN_CONTACT_KINDS(X)
#undef X
};
enum { OPTIONS = 32 };
_Static_assert(COUNT(kinds) * OPTIONS == GN_CONTACT_VARIANTS,
               "variants are all kinds with all options");
_Static_assert(1 << COUNT(option_bits) == OPTIONS, "options are bits of a variant's number");

/* Bonds with moments include the friction of other bonds if there is a column for it. */
unsigned gn_contact_variant(gn_effects effects) {
    if (effects & GN_FX_BOND_MOMENTS) effects &= ~(gn_effects)GN_FX_MOHR;
    for (unsigned k = 0; k < COUNT(kinds); k++)
        if (kinds[k].effects == (effects & makers))
            return OPTIONS * k + variant_of(option_bits, COUNT(option_bits), effects);
    return GN_CONTACT_VARIANTS;
}
gn_effects gn_contact_variant_effects(unsigned variant) {
    return kinds[variant / OPTIONS].effects |
           effects_of(option_bits, COUNT(option_bits), variant % OPTIONS);
}
void gn_contact_variant_name(unsigned variant, char *name, size_t size) {
    name_of(kinds[variant / OPTIONS].stem, option_bits, COUNT(option_bits), variant % OPTIONS, name,
            size);
}
unsigned gn_motion_variant(gn_effects effects) {
    return variant_of(motion_bits, COUNT(motion_bits), effects);
}
gn_effects gn_motion_variant_effects(unsigned variant) {
    return effects_of(motion_bits, COUNT(motion_bits), variant);
}
void gn_motion_variant_name(unsigned variant, char *name, size_t size) {
    name_of("motion", motion_bits, COUNT(motion_bits), variant, name, size);
}

gn_effects gn_contact_list_effects(gn_effects effects, bool bonds) {
    effects &= ~(gn_effects)GN_FX_JOINTS;
    if (!bonds) {
        effects &= ~(gn_effects)GN_FX_BONDS;
#define X(name, effect, lists)                                                                     \
    if ((lists) == GN_LAW_OF_BONDS) effects &= ~(gn_effects)(effect);
        GN_LAWS(X)
#undef X
        if (!(effects & GN_FX_FRICTION)) effects &= ~(gn_effects)GN_FX_SHEAR;
    } else {
#define X(name, effect, lists)                                                                     \
    if ((lists) == GN_LAW_OF_PAIRS) effects &= ~(gn_effects)(effect);
        GN_LAWS(X)
#undef X
    }
    return effects;
}

gneiss_status gn_contact_kernel_choose(const gn_kernel_set *set, gn_effects list_effects,
                                       gn_contact_kernel **kernel, gneiss_error *error) {
    bool mixed = list_effects & GN_FX_MIXED;
    /* the initial branch contains the image */
    if (mixed) list_effects &= ~(gn_effects)GN_FX_PERIODIC;
    unsigned variant = gn_contact_variant(list_effects);
    *kernel = variant < GN_CONTACT_VARIANTS ? (mixed ? set->mixed : set->contact)[variant] : NULL;
    if (*kernel) return GNEISS_OK;
    char names[GN_EFFECT_NAMES_SIZE];
    return gn_fail(error, GNEISS_ERROR_INTERNAL,
                   "no contact kernel of %s for a list with these effects: %s (the kinds of lists "
                   "that have one are in src/kernels/laws.h)",
                   set->name, gn_effect_names(list_effects, ", ", names));
}

gneiss_status gn_motion_kernel_choose(const gn_kernel_set *set, gn_effects effects,
                                      gn_motion_kernel **kernel, gneiss_error *error) {
    unsigned variant = gn_motion_variant(effects);
    *kernel = set->motion[variant];
    if (*kernel) return GNEISS_OK;
    char name[160];
    gn_motion_variant_name(variant, name, sizeof name);
    return gn_fail(error, GNEISS_ERROR_INTERNAL, "no kernel %s for %s", name, set->name);
}
