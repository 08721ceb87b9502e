/* Quantities: a number with a unit, or a plain number in SI. UDUNITS-2 supplies the units. */
#ifndef GN_SCENE_UNITS_H
#define GN_SCENE_UNITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_units gn_units;

/* Kinds of units that UDUNITS-2 alone would confuse with others of the same dimension: a
 * coefficient of friction, which may also be the angle of friction; a number that is not a fraction
 * ("50 %" is refused); a frequency of events, which is neither a spin ("600 rpm") nor a strain rate
 * ("5 %/s"). A strain may be a ratio of lengths ("5 mm/m", "500 ppm") as well as "0.5 %". */
#define GN_SLOPE        "1|deg"
#define GN_PLAIN_NUMBER "count"
#define GN_STRAIN       "m/m"
#define GN_EVENT_RATE   "count/s"

/* Makes a unit system; its database is read when the first quantity needs it. NULL: out of memory.
 * UDUNITS-2 has global state, so that only one thread at a time may use it. */
gn_units *gn_units_new(void);
void gn_units_free(gn_units *units);

/* True if UDUNITS-2 ran out of memory: a quantity that was not understood may be correct. */
bool gn_units_exhausted(const gn_units *units);

/* Reads "23 mm" as 0.023 if `unit` is "m". `unit` is one of the units of gn_unit_text; "1" stands
 * for dimensionless, where "5 %" is accepted. Units of the same dimension but another kind are
 * refused: angles where none are expected and vice versa, and frequencies as spins, damping rates
 * or strain rates. Returns false, with a short `reason`, if the quantity is refused. */
bool gn_units_read(gn_units *units, const char *text, const char *unit, double *value, char *reason,
                   size_t reason_size);

/* Reads a coefficient of friction: a number, or an angle such as "30 deg", of which it is the
 * tangent. */
bool gn_units_read_slope(gn_units *units, const char *text, double *value, char *reason,
                         size_t reason_size);

/* Reads a whole number: digits with an optional sign, or with a non-negative exponent (1e9).
 * Returns false if it is not whole, or out of range. */
bool gn_units_read_whole(const char *text, int64_t *value);

/* Returns "a length such as '23 mm'" for "m". */
const char *gn_unit_text(const char *unit);

/* True if the unit has a symbol that follows numbers; "1", GN_PLAIN_NUMBER and GN_STRAIN have none.
 */
bool gn_unit_is_shown(const char *unit);

/* Returns a sentence about a quantity whose unit is often misunderstood; NULL: none. */
const char *gn_unit_note(const char *text);

#endif
