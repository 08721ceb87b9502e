/* Quantities: a number with a unit, or a plain number in SI. UDUNITS-2 knows the units. */
#ifndef GN_SCENE_UNITS_H
#define GN_SCENE_UNITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_units gn_units;

/* Units of keys that UDUNITS-2 alone would take for others of the same dimension: a coefficient of
 * friction, which may also be given as the angle of friction; a number that is no share ("50 %");
 * a number of events in a time, which is no spin ("600 rpm") and no strain rate ("5 %/s"). A strain
 * takes ratios of lengths ("5 mm/m", "500 ppm") as well as "0.5 %". */
#define GN_SLOPE        "1|deg"
#define GN_PLAIN_NUMBER "count"
#define GN_STRAIN       "m/m"
#define GN_EVENT_RATE   "count/s"

/* The unit system is read on the first quantity that needs it. NULL: out of memory. UDUNITS-2 keeps
 * state of its own for the whole process: one thread at a time. */
gn_units *gn_units_new(void);
void gn_units_free(gn_units *units);

/* Tells whether UDUNITS-2 has lacked memory: a quantity that was not understood may be right. */
bool gn_units_exhausted(const gn_units *units);

/* Reads "23 mm" as 0.023 when `unit` is "m". `unit` is one of the units of gn_unit_text; "1" stands
 * for dimensionless, where "5 %" is understood. Units of the same dimension and another kind are
 * refused: angles where none are asked for and the reverse, frequencies of spins and of rates of
 * damping and strain. False: `reason` says why in a few words. */
bool gn_units_read(gn_units *units, const char *text, const char *unit, double *value, char *reason,
                   size_t reason_size);

/* A coefficient of friction: a number, or an angle such as "30 deg", whose tangent it is. */
bool gn_units_read_slope(gn_units *units, const char *text, double *value, char *reason,
                         size_t reason_size);

/* A whole number: digits with a sign, if any, or with an exponent that is none below 0 (1e9).
 * False: it is none, or has no room. */
bool gn_units_read_whole(const char *text, int64_t *value);

/* "a length such as '23 mm'" for "m". */
const char *gn_unit_text(const char *unit);

/* Tells whether the unit has a name that is written behind numbers; "1", GN_PLAIN_NUMBER and
 * GN_STRAIN have none. */
bool gn_unit_is_shown(const char *unit);

/* A sentence about a quantity whose unit has another meaning for many; NULL: there is none. */
const char *gn_unit_note(const char *text);

#endif
