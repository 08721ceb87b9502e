#include "scene/units.h"

#include "base/memory.h"
#include "base/resident.h"

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

/* Units of keys. If only this table has the name of a unit, `si` is its name in UDUNITS-2. A number
 * whose unit has the same dimension but is of another kind is refused with `hint`: angles are
 * recognised by the power of the radian, others by a word in `refused`. */
typedef struct unit_kind {
    const char *unit, *text, *si, *hint;
    const char *refused[8];
} unit_kind;

#define KIND(UNIT, TEXT, ...)                                                                      \
    { .unit = UNIT, .text = TEXT, __VA_ARGS__ }
#define FREQUENCIES "hz", "hertz", "bq", "becquerel", "curie", "ci"
static const unit_kind kinds[] = {
    KIND("1", "a number such as '0.5' or '50 %'", ),
    KIND(GN_STRAIN, "a strain such as '0.005', '0.5 %' or '5 mm/m'", ),
    KIND(GN_PLAIN_NUMBER, "a number such as '20'", ),
    KIND("m", "a length such as '23 mm'", ),
    KIND("m2", "an area such as '4 cm2'", ),
    KIND("s", "a time such as '5 ms'", ),
    KIND("kg", "a mass such as '2 kg'", ),
    KIND("kg/s", "a mass per time such as '2 kg/s'", ),
    KIND("kg m2", "a moment of inertia such as '0.1 kg m2'", ),
    KIND("kg/m3", "a density such as '2650 kg/m3'", ),
    KIND("Pa", "a stress or modulus such as '10 GPa'", ),
    KIND("N/m", "a stiffness such as '15 MN/m'", ),
    KIND("J/m2", "an energy per area such as '80 J/m2'", ),
    KIND("N", "a force such as '2 kN'", ),
    KIND("m/s", "a velocity such as '0.1 m/s'", ),
    KIND("m/s2", "an acceleration such as '9.81 m/s2'", ),
    KIND("rad", "an angle such as '30 deg'", .hint = "write rad or deg"),
    KIND("rad/s", "a spin such as '30 deg/s'", .hint = "write rad/s, deg/s or rpm",
         .refused = {FREQUENCIES}),
    KIND("1/s", "a rate such as '50 1/s'", .hint = "write 1/s", .refused = {FREQUENCIES}),
    KIND(GN_EVENT_RATE, "a number per time such as '50 1/s' or '50 Hz'", .si = "1/s",
         .hint = "write 1/s, 1/min or Hz", .refused = {"%", "percent", "ppm", "ppt", "ppb", "ppv"}),
    KIND("1/s|1",
         "a rate such as '50 1/s' with model viscous, a fraction such as '0.5' or '50 %' with "
         "others", ),
    KIND(GN_SLOPE, "a coefficient such as '0.5' or an angle of friction such as '30 deg'", ),
};

static const unit_kind *kind_of(const char *unit) {
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (strcmp(kinds[k].unit, unit) == 0) return &kinds[k];
    return NULL;
}

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
    const unit_kind *kind = kind_of(unit);
    return kind ? kind->text : "a quantity";
}

bool gn_unit_is_shown(const char *unit) {
    return strcmp(unit, "1") != 0 && strcmp(unit, GN_PLAIN_NUMBER) != 0 &&
           strcmp(unit, GN_STRAIN) != 0;
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

/* ---- the power of the radian in a unit ---- */

static ut_status visit_basic(const ut_unit *unit, void *power) {
    const char *name = ut_get_name(unit, UT_ASCII);
    if (name && strcmp(name, "radian") == 0) *(int *)power = 1;
    return UT_SUCCESS;
}

static ut_status visit_product(const ut_unit *unit, int count, const ut_unit *const *basic,
                               const int *powers, void *power) {
    (void)unit;
    for (int k = 0; k < count; k++) {
        int radian = 0;
        visit_basic(basic[k], &radian);
        *(int *)power += radian * powers[k];
    }
    return UT_SUCCESS;
}

static int angle_power(const ut_unit *unit);

static ut_status visit_galilean(const ut_unit *unit, double scale, const ut_unit *under,
                                double offset, void *power) {
    (void)unit, (void)scale, (void)offset;
    *(int *)power = angle_power(under);
    return UT_SUCCESS;
}

static ut_status visit_timestamp(const ut_unit *unit, const ut_unit *second, double origin,
                                 void *power) {
    (void)unit, (void)second, (void)origin, (void)power;
    return UT_SUCCESS;
}

static ut_status visit_logarithmic(const ut_unit *unit, double base, const ut_unit *reference,
                                   void *power) {
    (void)unit, (void)base, (void)reference, (void)power;
    return UT_SUCCESS;
}

static int angle_power(const ut_unit *unit) {
    static const ut_visitor visitor = {visit_basic, visit_product, visit_galilean, visit_timestamp,
                                       visit_logarithmic};
    int power = 0;
    ut_accept_visitor(unit, &visitor, &power);
    return power;
}

/* ---- factors ---- */

/* Finds the factor between two units; returns false and a reason for an unknown unit, another
 * dimension, or a scale with an offset or a logarithm, which no factor can express. */
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
    if (ok && angle_power(source) != angle_power(target)) {
        ok = false;
        *reason = angle_power(source) ? "it contains an angle" : "it contains no angle";
    }
    ut_free(source);
    ut_free(target);
    return ok;
}

/* Memory that must be available, because the library crashes without it. Its database takes 0.6 MB.
 */
enum { SYSTEM_BYTES = 2 << 20, PARSER_BYTES = 1 << 17 };

/* Opens the system of units. The database has "degree" but not the common "deg". If memory is
 * lacking, the library may omit units and report success, so that "min" would be a milli-inch; only
 * errno shows this. */
static ut_system *open_system(bool *exhausted) {
    *exhausted = !gn_memory_is_left(SYSTEM_BYTES);
    if (*exhausted) return NULL;
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
    if (!units->system)
        *reason = "the unit database of UDUNITS-2 cannot be read";
    else if (!gn_memory_is_left(PARSER_BYTES)) {
        units->exhausted = true;
        *reason = "no memory to read it";
    } else
        ok = find_factor(units->system, from, to, factor, reason);
    units->exhausted = units->exhausted || (!ok && errno == ENOMEM);
    ut_set_error_message_handler(previous);
    if (ok && units->cached < CACHE_SIZE) {
        conversion *entry = &units->cache[units->cached++];
        memcpy(entry->from, from, strlen(from) + 1);
        entry->to = to;
        entry->factor = *factor;
    }
}

static bool is_letter(char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           (unsigned char)letter >= 0x80 || letter == '%' || letter == '_';
}

/* Skips one factor of a unit, "mm" or "m-3" or "s^2", and returns its end; NULL: there is no
 * factor. */
static const char *skip_factor(const char *text) {
    static const char *const words[] = {"since", "after", "from", "ref", "per"};
    const char *start = text;
    while (is_letter(*text)) text++;
    size_t length = (size_t)(text - start);
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strlen(words[k]) == length && strncasecmp(start, words[k], length) == 0) return NULL;
    if (length == 0) return NULL;
    bool sign = *text == '^';
    if (sign) text++;
    if (*text == '-' || *text == '+') text++, sign = true;
    if (sign && !(*text >= '1' && *text <= '9')) return NULL;
    if (*text >= '1' && *text <= '9') text++;
    return text;
}

/* Tells whether a text is a product or quotient of powers, which alone reach the parser of
 * UDUNITS-2: "23 10 mm" is a mistake, not 230 mm; times since a date are of no use here; and the
 * parser leaks memory on bad syntax. */
static bool looks_like_unit(const char *text) {
    if (strlen(text) >= UNIT_SIZE) return false;
    if (strncmp(text, "1/", 2) == 0) text += 2;
    for (;;) {
        text = skip_factor(text);
        if (!text) return false;
        if (!*text) return true;
        const char *gap = text;
        while (*text == ' ') text++;
        bool joined = *text == '/' || *text == '.' || *text == '*';
        if (joined) text++;
        if (!joined && gap == text) return false;
        while (*text == ' ') text++;
    }
}

static bool starts_a_number(const char *text) {
    if (*text == '+' || *text == '-') text++;
    if (text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) return false;
    if (*text == '.') text++;
    return *text >= '0' && *text <= '9';
}

/* Returns a number times a factor. The factor itself is rounded, but 46 mm must give the double
 * nearest to 0.046, and 2.65 g/cm3 must give 2650: a factor near a whole number, or near the
 * inverse of one, is replaced by it. */
static double scaled(double number, double factor) {
    double whole = nearbyint(factor), inverse = nearbyint(1.0 / factor);
    if (factor > 0.5 && fabs(whole / factor - 1.0) < 1e-14) return number * whole;
    if (factor < 0.5 && inverse < 1e15 && fabs(inverse * factor - 1.0) < 1e-14)
        return number / inverse;
    return number * factor;
}

/* True if `word` occurs in the text of a unit, alone or after a prefix ("kHz"). */
static bool has_word(const char *text, const char *word) {
    for (; *text; text++) {
        if (!is_letter(*text)) continue;
        const char *end = text;
        while (is_letter(*end)) end++;
        size_t length = (size_t)(end - text), own = strlen(word);
        bool ends = length >= own && strncasecmp(end - own, word, own) == 0;
        bool plural = length > own && strncasecmp(end - own - 1, word, own) == 0 && end[-1] == 's';
        if (ends || plural) return true;
        text = end - 1;
    }
    return false;
}

static const char *refused_word(const unit_kind *kind, const char *given) {
    for (size_t k = 0; kind && k < sizeof kind->refused / sizeof *kind->refused; k++)
        if (kind->refused[k] && has_word(given, kind->refused[k])) return kind->hint;
    return NULL;
}

static const char *dimensionless(const char *given, bool count, double *factor) {
    if (!*given) return NULL;
    if (count) return "another dimension: expected no unit";
    if (strcmp(given, "%") != 0) return "another dimension: expected no unit or %";
    *factor = 0.01;
    return NULL;
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
    const unit_kind *kind = kind_of(unit);
    if (!gn_unit_is_shown(unit) && strcmp(unit, GN_STRAIN) != 0) {
        why = dimensionless(given, strcmp(unit, GN_PLAIN_NUMBER) == 0, &factor);
    } else if (*given) {
        why = refused_word(kind, given);
        if (!why && !looks_like_unit(given))
            why = "unknown unit";
        else if (!why)
            unit_factor(units, given, kind && kind->si ? kind->si : unit, &factor, &why);
    }
    if (why && kind && kind->hint && strstr(why, "angle")) {
        snprintf(reason, reason_size, " (%s: %s)", why, kind->hint);
        return false;
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
    if (!gn_units_read(units, text, "rad", &angle, reason, reason_size)) {
        if (*reason)
            snprintf(reason, reason_size,
                     " (expected no unit, %% or one of angles; a slope of 0.5 m/m is 0.5)");
        return false;
    }
    *value = tan(angle);
    if (angle >= 0.0 && angle < 0.5 * M_PI) return true;
    snprintf(reason, reason_size, " (expected an angle in [0, 90) deg)");
    return false;
}

/* True if a word of a unit is `name`, possibly with a prefix or in the plural. */
static bool is_named(const char *word, size_t length, const char *name) {
    static const char *const prefixes[] = {"", "k", "M", "kilo", "mega"};
    size_t own = strlen(name);
    if (length > own && word[length - 1] == 's') length--;
    for (size_t k = 0; k < sizeof prefixes / sizeof *prefixes; k++) {
        size_t before = strlen(prefixes[k]);
        if (length == before + own && strncmp(word, prefixes[k], before) == 0 &&
            strncmp(word + before, name, own) == 0)
            return true;
    }
    return false;
}

const char *gn_unit_note(const char *text) {
    for (const char *at = text, *end; *at; at = end) {
        for (end = at; is_letter(*end);) end++;
        size_t length = (size_t)(end - at);
        if (is_named(at, length, "ton"))
            return "ton is the short ton of 907.185 kg; the metric one, 1000 kg, is t or tonne";
        if (is_named(at, length, "ton_force") || is_named(at, length, "force_ton"))
            return "ton_force is that of a short ton, 8896.44 N; that of 1000 kg is 9.80665 kN";
        if (!length) end++;
    }
    return NULL;
}
