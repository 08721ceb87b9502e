/* Worlds from scene texts, for the tests of the physics. */
#ifndef GN_TESTS_WORLD_HELPERS_H
#define GN_TESTS_WORLD_HELPERS_H

#include "test.h"

#include "base/random.h"
#include "frame/parts.h"
#include "particles/active_pairs.h"
#include "world/world.h"

/* |a - b| <= allowed, in the unit of a and b; prints both when not. */
#define assert_near(a, b, allowed)                                                                 \
    do {                                                                                           \
        double gn_x = (a), gn_y = (b), gn_most = (allowed);                                        \
        if (!(fabs(gn_x - gn_y) <= gn_most))                                                       \
            fail_msg("%s = %.17g, %s = %.17g, difference %.3g > %.3g", #a, gn_x, #b, gn_y,         \
                     fabs(gn_x - gn_y), gn_most);                                                  \
    } while (0)

static const double pi = 3.14159265358979323846;

/* A scene text that is being composed. */
typedef struct text {
    size_t used;
    char s[65536];
} text;

__attribute__((format(printf, 2, 3))) static inline void add(text *t, const char *format, ...) {
    va_list args;
    va_start(args, format);
    t->used += (size_t)vsnprintf(t->s + t->used, sizeof t->s - t->used, format, args);
    va_end(args);
    assert_true(t->used < sizeof t->s);
}

/* Creates the world of a scene text; `folder` has its files (NULL: none). */
static inline gneiss_status world_try(gn_world *w, const char *scene_text, const char *folder,
                                      gneiss_error *error) {
    gn_scene scene;
    memset(w, 0, sizeof *w);
    gneiss_status status = gn_scene_parse(scene_text, "s.yaml", folder, NULL, 0, &scene, error);
    return status == GNEISS_OK ? gn_world_create(&scene, w, error) : status;
}

__attribute__((format(printf, 1, 2))) static inline gn_world *world_of(const char *format, ...) {
    text *t = calloc(1, sizeof *t);
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    va_list args;
    va_start(args, format);
    int length = vsnprintf(t->s, sizeof t->s, format, args);
    va_end(args);
    assert_in_range(length, 1, sizeof t->s - 1);
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/scenes", test_source());
    if (world_try(w, t->s, folder, &error) != GNEISS_OK) fail_msg("%s", error.message);
    free(t);
    return w;
}

/* Asserts that a scene with its first `from` replaced by `to` is refused with these words. */
static inline void assert_change_refused(const char *scene_text, const char *from, const char *to,
                                         const char *words) {
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    text *changed = calloc(1, sizeof *changed);
    const char *at = strstr(scene_text, from);
    assert_non_null(at);
    add(changed, "%.*s%s%s", (int)(at - scene_text), scene_text, to, at + strlen(from));
    if (world_try(w, changed->s, NULL, &error) == GNEISS_OK) fail_msg("accepted: %s", to);
    if (!strstr(error.message, words)) fail_msg("%s", error.message);
    free(changed);
    free(w);
}

static inline void world_end(gn_world *w) {
    gn_world_free(w);
    free(w);
}

/* One step, measured; returns the ledger at the instant at which it starts. */
static inline gn_energy measured_step(gn_world *w) {
    gneiss_error error = {0};
    if (gn_world_step(w, true, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return w->ledger.reading;
}

/* Takes `count` steps; the first one of a run is measured, so that the ledger has the initially
 * stored energy. */
static inline void run_steps(gn_world *w, int64_t count) {
    gneiss_error error = {0};
    for (int64_t k = 0; k < count; k++)
        if (gn_world_step(w, w->ctx.step == 0, &error) != GNEISS_OK) fail_msg("%s", error.message);
    gn_active_pairs_settle(&w->ctx, &w->dem);
}

static inline void run_until(gn_world *w, double time) {
    while (w->ctx.time < time) run_steps(w, 1);
}

/* Returns true if this machine has an instruction set, and prints a message if not. */
static inline bool runs_here(const gn_kernel_set *set) {
    bool runs = gn_kernel_set_supported(set);
    if (!runs) print_message("# %s: not on this machine, skipped\n", set->name);
    return runs;
}

/* Rows of a particle by its number in the scene. */
static inline double *pos_of(const gn_world *w, int id) {
    return w->dem.particles.pos + 4 * (int64_t)w->dem.index_of_id[id];
}
static inline double *vel_of(const gn_world *w, int id) {
    return w->dem.particles.vel + 4 * (int64_t)w->dem.index_of_id[id];
}
static inline double *spin_of(const gn_world *w, int id) {
    return w->dem.particles.spin + 4 * (int64_t)w->dem.index_of_id[id];
}
static inline double mass_of(const gn_world *w, int id) {
    return 1.0 / vel_of(w, id)[3];
}

/* Positions by number in the scene, [count][3]; the caller frees. */
static inline double *positions(const gn_world *w) {
    size_t n = w->dem.particles.soa.count;
    double *x = calloc(n + 1, 3 * sizeof *x);
    for (size_t k = 0; k < n; k++) memcpy(x + 3 * k, pos_of(w, (int)k), 3 * sizeof *x);
    return x;
}

static inline double sphere_mass(double density, double r) {
    return density * 4.0 / 3.0 * pi * r * r * r;
}
static inline double disc_mass(double density, double r) {
    return density * pi * r * r;
}

static inline double length3(const double *a) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Shear force of a contact (three columns) into t; returns its size. */
static inline double shear_of(const gn_contacts *k, size_t c, double t[3]) {
    for (size_t a = 0; a < 3; a++) t[a] = k->shear[c + a * k->soa.capacity];
    return length3(t);
}

/* The next number of a stream, uniform in [low, high). */
static inline double uniform(uint64_t *at, double low, double high) {
    return low + (high - low) * 0.5 * (gn_random_symmetric(7, (*at)++) + 1.0);
}

static inline double dot3(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross3(const double *a, const double *b, double *r) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
