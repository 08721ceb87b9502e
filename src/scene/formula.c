#include "scene/formula.h"

#include "base/memory.h"

#include <ctype.h>
#include <math.h>
#include <muParserDLL.h>
#include <stdio.h>
#include <string.h>

struct gn_formula {
    gn_formula *next;
    muParserHandle_t parser;
    double t; /* s: the variable of the parser */
    char *text, *key;
    double wrong, wrong_at; /* the first value that was not finite, and its t, s */
    bool failed;
};

static bool begins_name(char c) {
    return isalpha((unsigned char)c) || c == '_';
}

static bool belongs_to_name(char c) {
    return begins_name(c) || isdigit((unsigned char)c);
}

bool gn_formula_is(const char *text) {
    for (const char *c = text; *c;) {
        const char *from = c;
        /* A number and the letters that follow it, as in 1e3, are no name. */
        while (belongs_to_name(*c) || (c > from && *c == '.')) c++;
        if (c - from == 1 && *from == 't') return true;
        if (c == from) c++;
    }
    return false;
}

/* ---- reading ---- */

/* muParser's assignments would change t, and of several values separated by commas it would return
 * the last one. */
static int not_a_value(const char *text) {
    int depth = 0;
    for (const char *c = text; *c; c++) {
        depth += (*c == '(') - (*c == ')');
        if (*c == ',' && depth == 0) return (int)(c - text) + 1;
        if (*c != '=') continue;
        const bool compares = c[1] == '=' || (c > text && strchr("=<>!", c[-1]));
        if (!compares) return (int)(c - text) + 1;
    }
    return 0;
}

static bool is_valid(gn_formula *f, char *reason, size_t size) {
    int at = not_a_value(f->text);
    if (at) {
        snprintf(reason, size, " (unexpected '%c' at character %d)", f->text[at - 1], at);
        return false;
    }
    mupDefineVar(f->parser, "t", &f->t);
    mupDefineConst(f->parser, "pi", M_PI);
    mupDefineConst(f->parser, "e", M_E);
    mupSetExpr(f->parser, f->text);
    (void)mupEval(f->parser);
    if (!mupError(f->parser)) return true;
    at = mupGetErrorPos(f->parser);
    const char *token = mupGetErrorToken(f->parser);
    const int last = (int)strlen(f->text);
    if (token && *token && at >= 0 && at < last)
        snprintf(reason, size, " (unexpected '%.40s' at character %d)", token, at + 1);
    else
        snprintf(reason, size, " (it is not complete at character %d)", at >= 0 ? at + 1 : last);
    return false;
}

static char *own_text(const char *text) {
    char *own = gn_alloc(strlen(text) + 1);
    if (own) memcpy(own, text, strlen(text) + 1);
    return own;
}

static void free_one(gn_formula *f) {
    if (f->parser) mupRelease(f->parser);
    gn_free(f->text);
    gn_free(f->key);
    gn_free(f);
}

gn_formula *gn_formula_add(gn_formula **list, const char *text, const char *key, char *reason,
                           size_t size) {
    *reason = '\0';
    gn_formula *f = gn_alloc(sizeof *f);
    if (!f) return NULL;
    f->text = own_text(text);
    f->key = own_text(key);
    f->parser = mupCreate(muBASETYPE_FLOAT);
    if (!f->text || !f->key || !f->parser || !is_valid(f, reason, size)) {
        free_one(f);
        return NULL;
    }
    f->next = *list;
    *list = f;
    return f;
}

gn_formula *gn_formula_copy(const gn_formula *formula, gn_formula **list) {
    char reason[96];
    return gn_formula_add(list, formula->text, formula->key, reason, sizeof reason);
}

void gn_formulas_free(gn_formula *list) {
    while (list) {
        gn_formula *next = list->next;
        free_one(list);
        list = next;
    }
}

const char *gn_formula_text(const gn_formula *formula) {
    return formula->text;
}

/* ---- values ---- */

double gn_formula_at(gn_formula *formula, double t) {
    formula->t = t;
    const double value = mupEval(formula->parser);
    if (isfinite(value)) return value;
    if (!formula->failed) {
        formula->failed = true;
        formula->wrong = value;
        formula->wrong_at = t;
    }
    return 0.0;
}

void gn_formulas_forget(gn_formula *list) {
    for (; list; list = list->next) list->failed = false;
}

gneiss_status gn_formulas_check(const gn_formula *list, gneiss_error *error) {
    for (; list; list = list->next)
        if (list->failed)
            return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                           "%s: expected a finite value of the formula '%.200s', found %g at t = "
                           "%.10g s",
                           list->key, list->text, list->wrong, list->wrong_at);
    return GNEISS_OK;
}
