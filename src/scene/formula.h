/* Formulas of the time t for values that a scene prescribes, such as "0.1*sin(2*pi*5*t)", evaluated
 * by muParser. Values are in SI units and t in seconds. A formula may be evaluated by one thread at
 * a time, because muParser reads t from a variable of the formula. */
#ifndef GN_SCENE_FORMULA_H
#define GN_SCENE_FORMULA_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_formula gn_formula;

/* Number of points, from 0 to the end of the scene, at which a formula is sampled when it is read:
 * bounds, and checks that only know tables, use these samples. */
enum { GN_FORMULA_POINTS = 1025 };

/* Tells whether a text is meant as a formula: the name t stands in it by itself. */
bool gn_formula_is(const char *text);

/* Appends the formula of a text to a list, whose owner frees it by gn_formulas_free. `key` is the
 * path of the key, for messages. If the text is not a formula the result is NULL and `reason`
 * states what is wrong at which character, base 1; NULL with an empty reason: out of memory. */
gn_formula *gn_formula_add(gn_formula **list, const char *text, const char *key, char *reason,
                           size_t size);
/* Appends the same formula to another list; NULL: out of memory. */
gn_formula *gn_formula_copy(const gn_formula *formula, gn_formula **list);
void gn_formulas_free(gn_formula *list);

const char *gn_formula_text(const gn_formula *formula);

/* Returns the value at t, s. A value that is not finite is kept for gn_formulas_check, and the
 * result is then 0. */
double gn_formula_at(gn_formula *formula, double t);

/* gn_formulas_forget drops the kept values of a list. gn_formulas_check fails with the key and the
 * text of the first formula that has had a value that is not finite since. */
void gn_formulas_forget(gn_formula *list);
gneiss_status gn_formulas_check(const gn_formula *list, gneiss_error *error);

#endif
