#include "particles/from_run.h"

#include "base/error.h"
#include "base/new.h"
#include "base/sort.h"
#include "io/h5.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double light = 299792458.0, far = 1e30; /* m/s, m: bounds of values in a file */

/* Data of all particles in the file; removed ones are left out of *from. */
typedef struct source {
    gn_h5 *file;
    size_t all, bonds;
    uint8_t *removed;
    int32_t *place; /* [all] index among the remaining particles, -1: removed */
    double *vector; /* [all][3] the vector read last */
} source;

/* Reads a data set into the columns from `first` to `first + components` of the rows of `out`
 * [count][width]. */
static gneiss_status take(source *s, const char *name, size_t components, double *out, size_t width,
                          size_t first, gneiss_error *error) {
    GN_TRY(gn_h5_get(s->file, name, GN_F64, s->all, components, 0, s->vector, error));
    for (size_t p = 0; p < s->all; p++)
        for (size_t a = 0; s->place[p] >= 0 && a < components; a++)
            out[width * (size_t)s->place[p] + first + a] = s->vector[components * p + a];
    return GNEISS_OK;
}

/* Reports a row of a data set that is impossible for a particle, a bond or a volume. */
static gneiss_status refuse(const char *name, const char *expected, double found, size_t row,
                            gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "data set %s: expected %s, found %g in row %zu (base 0)", name, expected, found,
                   row);
}

static gneiss_status number(source *s, gn_from_run *from, gneiss_error *error) {
    GN_TRY(gn_h5_rows(s->file, "particles/position", &s->all, error));
    s->removed = gn_alloc(s->all + 1);
    s->place = gn_alloc_array(s->all + 1, sizeof *s->place);
    s->vector = gn_alloc_array(s->all + 1, 3 * sizeof *s->vector);
    if (!s->removed || !s->place || !s->vector)
        return gn_no_memory(error, "the particles of another run");
    if (gn_h5_has(s->file, "particles/removed"))
        GN_TRY(gn_h5_get(s->file, "particles/removed", GN_U8, s->all, 1, 0, s->removed, error));
    else
        memset(s->removed, 0, s->all);
    if (s->all > INT32_MAX)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected fewer than 2^31 particles, found %zu",
                       s->all);
    for (size_t p = 0; p < s->all; p++)
        if (s->removed[p] > 1)
            return refuse("particles/removed", "0 or 1", s->removed[p], p, error);
    for (size_t p = 0; p < s->all; p++) s->place[p] = s->removed[p] ? -1 : (int32_t)from->count++;
    return GNEISS_OK;
}

/* Refuses members of clumps, which overlap and would be free particles here. */
static gneiss_status check_free(const source *s, gneiss_error *error) {
    size_t members = 0;
    if (!gn_h5_has(s->file, "particles/clump")) return GNEISS_OK;
    int32_t *clump = gn_alloc_array(s->all + 1, sizeof *clump);
    if (!clump) return gn_no_memory(error, "the particles of another run");
    gneiss_status status =
        gn_h5_get(s->file, "particles/clump", GN_I32, s->all, 1, 0, clump, error);
    for (size_t p = 0; status == GNEISS_OK && p < s->all; p++)
        members += s->place[p] >= 0 && clump[p] >= 0;
    gn_free(clump);
    if (status != GNEISS_OK || !members) return status;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected a run without clumps, whose members would become free particles, "
                   "found %zu members of clumps (gneiss resume goes on with such a run)",
                   members);
}

static gneiss_status take_motion(source *s, gn_from_run *from, gneiss_error *error) {
    from->motion = gn_alloc_array(from->count + 1, 6 * sizeof *from->motion);
    if (!from->motion) return gn_no_memory(error, "the particles of another run");
    GN_TRY(take(s, "particles/velocity", 3, from->motion, 6, 0, error));
    for (size_t p = 0; p < from->count; p++)
        for (size_t a = 0; a < 3; a++)
            if (!(fabs(from->motion[6 * p + a]) < light))
                return refuse("particles/velocity", "less than the speed of light",
                              from->motion[6 * p + a], p, error);
    if (!gn_h5_has(s->file, "particles/spin")) return GNEISS_OK;
    return take(s, "particles/spin", 3, from->motion, 6, 3, error);
}

/* Tells whether a bond is intact; bonds that have softened or yielded are. */
static bool holds(int32_t state) {
    return state == 0 || state == 4 || state == 5;
}

static gneiss_status check_bond(const source *s, int32_t *const ends[3], const double *rest,
                                size_t b, gneiss_error *error) {
    static const char *const names[] = {"bonds/i", "bonds/j"};
    for (int k = 0; k < 2; k++)
        if (ends[k][b] < 0 || (size_t)ends[k][b] >= s->all)
            return refuse(names[k], "the place of a particle", ends[k][b], b, error);
    if (ends[0][b] == ends[1][b])
        return refuse("bonds/j", "another particle than that of bonds/i", ends[1][b], b, error);
    if (holds(ends[2][b]) && !(rest[b] > 0.0))
        return refuse("bonds/rest_length", "a length > 0", rest[b], b, error);
    return GNEISS_OK;
}

static gneiss_status take_bonds(source *s, gn_from_run *from, gneiss_error *error) {
    if (!gn_h5_has(s->file, "bonds/i")) return GNEISS_OK;
    GN_TRY(gn_h5_rows(s->file, "bonds/i", &s->bonds, error));
    int32_t *ends[3];
    for (int k = 0; k < 3; k++) ends[k] = gn_alloc_array(s->bonds + 1, sizeof *ends[k]);
    double *rest = gn_alloc_array(s->bonds + 1, sizeof *rest);
    from->bond = gn_alloc_array(s->bonds + 1, sizeof *from->bond);
    from->rest_length = gn_alloc_array(s->bonds + 1, sizeof *from->rest_length);
    from->holds = gn_alloc(s->bonds + 1);
    bool held =
        ends[0] && ends[1] && ends[2] && rest && from->bond && from->rest_length && from->holds;
    gneiss_status status = held ? GNEISS_OK : gn_no_memory(error, "the particles of another run");
    const char *const names[] = {"bonds/i", "bonds/j", "bonds/state"};
    for (int k = 0; status == GNEISS_OK && k < 3; k++)
        status = gn_h5_get(s->file, names[k], GN_I32, s->bonds, 1, 0, ends[k], error);
    if (status == GNEISS_OK)
        status = gn_h5_get(s->file, "bonds/rest_length", GN_F64, s->bonds, 1, 0, rest, error);
    for (size_t b = 0; status == GNEISS_OK && b < s->bonds; b++) {
        status = check_bond(s, ends, rest, b, error);
        if (status != GNEISS_OK) continue;
        int32_t i = s->place[ends[0][b]], j = s->place[ends[1][b]];
        if (i < 0 || j < 0) continue;
        from->bond[from->bonds][0] = i;
        from->bond[from->bonds][1] = j;
        from->holds[from->bonds] = holds(ends[2][b]);
        from->rest_length[from->bonds++] = rest[b];
    }
    for (int k = 0; k < 3; k++) gn_free(ends[k]);
    gn_free(rest);
    return status;
}

static gneiss_status check_dimension(const gn_scene *scene, const source *s, const char *what,
                                     gneiss_error *error) {
    int64_t dimension = 0;
    GN_TRY(gn_h5_get_attribute_i64(s->file, "/", "dimension", &dimension, 1, error));
    if (dimension == scene->dimension) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected a %s of a %dD scene, found one of a %dD scene", what,
                   (int)scene->dimension, (int)dimension);
}

/* Refuses a particle whose size differs from all others by orders of magnitude: steps would be as
 * short as the smallest particle requires, and lists as long as the largest one. */
static gneiss_status check_sizes(const gn_from_run *from, gneiss_error *error) {
    const double apart = 1e4;
    double *radius = gn_alloc_array(from->count + 1, sizeof *radius);
    if (!radius) return gn_no_memory(error, "the particles of another run");
    for (size_t p = 0; p < from->count; p++) radius[p] = from->sphere[4 * p + 3];
    gn_sort_numbers(radius, from->count);
    const double median = from->count ? radius[from->count / 2] : 0.0;
    gn_free(radius);
    for (size_t p = 0; p < from->count; p++) {
        const double r = from->sphere[4 * p + 3];
        if (r > apart * median || r < median / apart)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "data set particles/radius: expected radii from 1e-4 to 1e4 of their "
                           "median, %g m, found %g",
                           median, r);
    }
    return GNEISS_OK;
}

static gneiss_status take_spheres(source *s, gn_from_run *from, gneiss_error *error) {
    from->sphere = gn_alloc_array(from->count + 1, 4 * sizeof *from->sphere);
    if (!from->sphere) return gn_no_memory(error, "the particles of another run");
    GN_TRY(take(s, "particles/position", 3, from->sphere, 4, 0, error));
    GN_TRY(take(s, "particles/radius", 1, from->sphere, 4, 3, error));
    for (size_t p = 0; p < from->count; p++) {
        const double *sphere = from->sphere + 4 * p;
        for (size_t a = 0; a < 3; a++)
            if (!(fabs(sphere[a]) < far))
                return refuse("particles/position", "a place within 1e30 m", sphere[a], p, error);
        if (!(sphere[3] > 0.0 && sphere[3] < far))
            return refuse("particles/radius", "a radius > 0, below 1e30 m", sphere[3], p, error);
    }
    return check_sizes(from, error);
}

/* Reads a packing, which holds all of its particles, at rest. */
static gneiss_status read_packing(const gn_scene *scene, source *s, gn_from_run *from,
                                  gneiss_error *error) {
    if (scene->specimen.from_bonds)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected the folder of a run beside from_bonds: keep, found that of a "
                       "packing, which has no bonds");
    char *kind = NULL;
    GN_TRY(gn_h5_get_attribute_text(s->file, "/", "kind", &kind, error));
    const bool packing = strcmp(kind, "packing") == 0;
    free(kind);
    if (!packing)
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected a packing, found another file");
    GN_TRY(check_dimension(scene, s, "packing", error));
    GN_TRY(gn_h5_get_attribute_f64(s->file, "/", "volume", &from->volume, 1, error));
    if (!(from->volume > 0.0 && from->volume < INFINITY))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "attribute volume: expected a volume > 0, found %g", from->volume);
    GN_TRY(number(s, from, error));
    return take_spheres(s, from, error);
}

static gneiss_status read_all(const gn_scene *scene, source *s, gn_from_run *from,
                              gneiss_error *error) {
    int64_t finished = 0;
    if (gn_scene_from_packing(scene)) return read_packing(scene, s, from, error);
    GN_TRY(gn_h5_get_attribute_i64(s->file, "/", "finished", &finished, 1, error));
    if (!finished)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected a run that came to its end, found one that did not (gneiss resume "
                       "goes on with it)");
    if (!gn_h5_has(s->file, "particles/position"))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected the results of a run with particles, found none of them");
    GN_TRY(check_dimension(scene, s, "run", error));
    GN_TRY(number(s, from, error));
    GN_TRY(check_free(s, error));
    GN_TRY(take_spheres(s, from, error));
    if (scene->specimen.from_velocities) GN_TRY(take_motion(s, from, error));
    return scene->specimen.from_bonds ? take_bonds(s, from, error) : GNEISS_OK;
}

gneiss_status gn_from_run_read(const gn_scene *scene, gn_from_run *from, gneiss_error *error) {
    const gn_scene_place where = scene->specimen.from_where;
    source s = {0};
    *from = (gn_from_run){0};
    gneiss_status status = gn_h5_open_whole(scene->specimen.from_path, &s.file, error);
    if (status == GNEISS_OK) status = gn_h5_check_names(s.file, false, error);
    if (status == GNEISS_OK) gn_h5_demand_finite(s.file, true);
    if (status == GNEISS_OK) status = read_all(scene, &s, from, error);
    if (status != GNEISS_OK)
        gn_fail_context(error, "%s: ", gn_scene_at(scene, where, "specimen.from").text);
    gn_h5_close(s.file);
    gn_free(s.removed);
    gn_free(s.place);
    gn_free(s.vector);
    if (status != GNEISS_OK) gn_from_run_free(from);
    return status;
}

void gn_from_run_free(gn_from_run *from) {
    gn_free(from->sphere);
    gn_free(from->motion);
    gn_free(from->bond);
    gn_free(from->rest_length);
    gn_free(from->holds);
    *from = (gn_from_run){0};
}
