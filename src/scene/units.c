#include "scene/units.h"

#include "base/memory.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <udunits2.h>

enum { CACHE_SIZE = 16, UNIT_SIZE = 32 };

typedef struct conversion {
    char from[UNIT_SIZE];
    const char *to;
    double factor;
} conversion;

struct gn_units {
    ut_system *system;
    bool tried, exhausted;
    size_t cached;
    conversion cache[CACHE_SIZE];
};

static const struct {
    const char *unit, *text;
} kinds[] = {
    {"1", "a number such as '0.5' or '50 %'"},
    {"m", "a length such as '23 mm'"},
    {"m2", "an area such as '4 cm2'"},
    {"s", "a time such as '5 ms'"},
    {"kg/m3", "a density such as '2650 kg/m3'"},
    {"Pa", "a stress or modulus such as '10 GPa'"},
    {"N/m", "a stiffness such as '15 MN/m'"},
    {"J/m2", "an energy per area such as '80 J/m2'"},
    {"N", "a force such as '2 kN'"},
    {"m/s", "a velocity such as '0.1 m/s'"},
    {"m/s2", "an acceleration such as '9.81 m/s2'"},
    {"rad/s", "a spin such as '30 deg/s'"},
    {"1/s", "a rate such as '50 1/s'"},
    {"deg", "a coefficient such as '0.5' or an angle of friction such as '30 deg'"},
};

bool gn_units_read_whole(const char *text, int64_t *value) {
    char *rest;
    errno = 0;
    *value = 0;
    if (!*text || !strchr("+-0123456789", *text)) return false;
    const long long number = strtoll(text, &rest, 10);
    if (rest == text || errno) return false;
    *value = number;
    if (!*rest) return true;
    if (*rest != 'e' && *rest != 'E') return false;
    const char *power = rest + 1 + (rest[1] == '+');
    if (!*power || strspn(power, "0123456789") != strlen(power)) return false;
    for (long k = strtol(power, NULL, 10); k > 0 && *value != 0; k--)
        if (__builtin_mul_overflow(*value, 10, value)) return false;
    return true;
}

const char *gn_unit_text(const char *unit) {
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (strcmp(kinds[k].unit, unit) == 0) return kinds[k].text;
    return "a quantity";
}

gn_units *gn_units_new(void) {
    return gn_alloc(sizeof(gn_units));
}

void gn_units_free(gn_units *units) {
    if (!units) return;
    if (units->system) ut_free_system(units->system);
    gn_free(units);
}

bool gn_units_exhausted(const gn_units *units) {
    return units->exhausted;
}

/* The factor between two units; false and a reason for an unknown one, another dimension, or a
 * scale with an offset or a logarithm, which a factor cannot express. */
static bool find_factor(ut_system *system, const char *from, const char *to, double *factor,
                        const char **reason) {
    ut_unit *source = ut_parse(system, from, UT_UTF8);
    ut_unit *target = ut_parse(system, to, UT_UTF8);
    cv_converter *converter = NULL;
    bool ok = false;
    if (source && target && ut_are_convertible(source, target))
        converter = ut_get_converter(source, target);
    if (converter) {
        *factor = cv_convert_double(converter, 1.0);
        ok = cv_convert_double(converter, 0.0) == 0.0 && isfinite(*factor) && *factor > 0;
        cv_free(converter);
    }
    if (!ok) *reason = source ? "another dimension" : "unknown unit";
    ut_free(source);
    ut_free(target);
    return ok;
}

/* The database has "degree" but not the "deg" that everybody writes. Without memory the library may
 * leave units out and call that a success: min would be a milli-inch. Only errno tells. */
static ut_system *open_system(bool *exhausted) {
    errno = 0;
    ut_system *system = ut_read_xml(NULL);
    ut_unit *degree = system ? ut_parse(system, "degree", UT_ASCII) : NULL;
    if (degree) ut_map_name_to_unit("deg", UT_ASCII, degree);
    ut_free(degree);
    *exhausted = errno == ENOMEM;
    if (!*exhausted || !system) return system;
    ut_free_system(system);
    return NULL;
}

static void unit_factor(gn_units *units, const char *from, const char *to, double *factor,
                        const char **reason) {
    for (size_t k = 0; k < units->cached; k++)
        if (strcmp(units->cache[k].to, to) == 0 && strcmp(units->cache[k].from, from) == 0) {
            *factor = units->cache[k].factor;
            return;
        }
    ut_error_message_handler previous = ut_set_error_message_handler(ut_ignore);
    if (!units->tried) units->system = open_system(&units->exhausted);
    units->tried = true;
    bool ok = false;
    errno = 0;
    if (units->system)
        ok = find_factor(units->system, from, to, factor, reason);
    else
        *reason = "the unit database of UDUNITS-2 cannot be read";
    units->exhausted = units->exhausted || (!ok && errno == ENOMEM);
    ut_set_error_message_handler(previous);
    if (ok && units->cached < CACHE_SIZE) {
        conversion *entry = &units->cache[units->cached++];
        memcpy(entry->from, from, strlen(from) + 1);
        entry->to = to;
        entry->factor = *factor;
    }
}

static bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (unsigned char)c >= 0x80 ||
           c == '%' || c == '_';
}

/* One factor of a unit, "mm" or "m-3" or "s^2": what comes behind it, NULL when there is none. */
static const char *skip_factor(const char *s) {
    static const char *const words[] = {"since", "after", "from", "ref", "per"};
    const char *start = s;
    while (is_letter(*s)) s++;
    size_t length = (size_t)(s - start);
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strlen(words[k]) == length && strncasecmp(start, words[k], length) == 0) return NULL;
    if (length == 0) return NULL;
    bool sign = *s == '^';
    if (sign) s++;
    if (*s == '-' || *s == '+') s++, sign = true;
    if (sign && !(*s >= '1' && *s <= '9')) return NULL;
    if (*s >= '1' && *s <= '9') s++;
    return s;
}

/* Only products and quotients of powers reach the parser of UDUNITS-2: "23 10 mm" is a slip, not
 * 230 mm; times since a date are of no use here; and the parser loses memory over bad syntax. */
static bool looks_like_unit(const char *s) {
    if (strlen(s) >= UNIT_SIZE) return false;
    if (strncmp(s, "1/", 2) == 0) s += 2;
    for (;;) {
        s = skip_factor(s);
        if (!s) return false;
        if (!*s) return true;
        const char *gap = s;
        while (*s == ' ') s++;
        bool joined = *s == '/' || *s == '.' || *s == '*';
        if (joined) s++;
        if (!joined && gap == s) return false;
        while (*s == ' ') s++;
    }
}

static bool starts_a_number(const char *text) {
    if (*text == '+' || *text == '-') text++;
    if (text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) return false;
    if (*text == '.') text++;
    return *text >= '0' && *text <= '9';
}

/* The factor comes with rounding of its own. 46 mm shall be the double nearest to 0.046, and 2.65
 * g/cm3 be 2650: factors that are whole numbers, or one over them, are taken as such. */
static double scaled(double number, double factor) {
    double whole = nearbyint(factor), inverse = nearbyint(1.0 / factor);
    if (factor > 0.5 && fabs(whole / factor - 1.0) < 1e-14) return number * whole;
    if (factor < 0.5 && inverse < 1e15 && fabs(inverse * factor - 1.0) < 1e-14)
        return number / inverse;
    return number * factor;
}

bool gn_units_read(gn_units *units, const char *text, const char *unit, double *value, char *reason,
                   size_t reason_size) {
    snprintf(reason, reason_size, "%s", "");
    while (*text == ' ') text++;
    if (!starts_a_number(text)) return false;
    char *rest;
    double number = strtod(text, &rest), factor = 1.0;
    while (*rest == ' ') rest++;
    char given[UNIT_SIZE + 1];
    int length = snprintf(given, sizeof given, "%s", rest);
    while (length > 0 && length <= UNIT_SIZE && given[length - 1] == ' ') given[--length] = '\0';
    const char *why = NULL;
    if (strcmp(unit, "1") == 0) {
        if (strcmp(given, "%") == 0)
            factor = 0.01;
        else if (*given)
            why = "another dimension: expected no unit or %";
    } else if (*given) {
        /* Hz and rad/s have the same dimension, and differ by 2 pi. */
        if (strcmp(unit, "rad/s") == 0 && strstr(given, "Hz"))
            why = "write rad/s, deg/s or rpm";
        else if (!looks_like_unit(given))
            why = "unknown unit";
        else
            unit_factor(units, given, unit, &factor, &why);
    }
    if (why) {
        snprintf(reason, reason_size, " (%s)", why);
        return false;
    }
    *value = scaled(number, factor);
    if (!isfinite(*value)) {
        snprintf(reason, reason_size, " (too large)");
        return false;
    }
    return true;
}

bool gn_units_read_slope(gn_units *units, const char *text, double *value, char *reason,
                         size_t reason_size) {
    double angle;
    if (gn_units_read(units, text, "1", value, reason, reason_size)) return true;
    if (!gn_units_read(units, text, "rad", &angle, reason, reason_size)) return false;
    *value = tan(angle);
    if (angle >= 0.0 && angle < 0.5 * M_PI) return true;
    snprintf(reason, reason_size, " (expected an angle in [0, 90) deg)");
    return false;
}
