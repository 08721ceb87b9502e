/* Sections of bonds (Santasusana 2013, 4.5 and 4.6.2). If they fill the body, sum A L = d V, then
 * uniform strain gives the bulk modulus alpha E/d, and a pressure p on the body gives the stress p
 * in every bond: with f = p A the virial sum is sum f L = d V p. */
#include "particles/bond_sections.h"

#include "base/error.h"
#include "base/memory.h"
#include "frame/frame.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "particles/polyhedron.h"
#include "scene/scene.h"
#include "soa/bond_causes.h"
#include "soa/records.h"

#include <string.h>

/* Tells whether a contact has a section: the list also holds stress-free overlaps that were never
 * bonds and fill no part of the body. */
static bool is_section(const gn_contacts *bonds, size_t c) {
    return bonds->cause[c] != GN_BOND_NEVER;
}

static size_t count_sections(const gn_contacts *bonds) {
    size_t count = 0;
    for (size_t c = 0; c < bonds->soa.count; c++) count += is_section(bonds, c);
    return count;
}

/* --- sections by Dempack --- */

static double dempack_area(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j) {
    const double *pos = dem->particles.pos;
    return gn_dempack_area((int)ctx->scene.dimension, pos[4 * (int64_t)i + 3],
                           pos[4 * (int64_t)j + 3]);
}

static double porosity_gamma(const gn_step_context *ctx, const gn_dem *dem) {
    const double bonds = (double)count_sections(&dem->bonds.contacts);
    if (bonds == 0.0) return 0.0;
    return 20.0 * gn_dem_porosity(ctx, dem) * (double)dem->particles.soa.count / bonds;
}

static double filled_by_dempack(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_contacts *b = &dem->bonds.contacts;
    double sum = 0.0;
    for (size_t c = 0; c < b->soa.count; c++)
        if (is_section(b, c)) sum += dempack_area(ctx, dem, b->i[c], b->j[c]) * b->length0[c];
    return sum;
}

/* Returns the factor gamma of the sections; 1 without bonds, because there is no body to measure.
 */
static double gamma_of(const gn_step_context *ctx, const gn_dem *dem) {
    if (ctx->scene.gamma > 0.0) return ctx->scene.gamma;
    if (!count_sections(&dem->bonds.contacts)) return 1.0;
    if (ctx->scene.gamma_rule == GN_GAMMA_POROSITY) return porosity_gamma(ctx, dem);
    return (double)ctx->scene.dimension * ctx->volume / filled_by_dempack(ctx, dem);
}

/* --- polyhedra --- */

/* The faces of the cells of all particles. */
typedef struct faces {
    int32_t *start, *bond; /* [particles + 1] into [2 bonds]: the bonds of each particle */
    double *scale;         /* [particles] factor of Dempack's sections */
    double *free;          /* [particles] area of faces without a bond, m2 (2D: m x 1 m) */
    uint8_t *open;         /* [particles] 1: some faces are missing */
    double (*direction)[3];
} faces;

static void free_faces(faces *f) {
    gn_free(f->start);
    gn_free(f->bond);
    gn_free(f->scale);
    gn_free(f->free);
    gn_free(f->open);
    gn_free(f->direction);
}

static gneiss_status list_bonds(const gn_dem *dem, faces *f, gneiss_error *error) {
    const gn_contacts *b = &dem->bonds.contacts;
    size_t n = dem->particles.soa.count, most = 0;
    f->start = gn_alloc_array(n + 2, sizeof *f->start);
    f->bond = gn_alloc_array(2 * b->soa.count + 1, sizeof *f->bond);
    f->scale = gn_alloc_array(n + 1, sizeof *f->scale);
    f->free = gn_alloc_array(n + 1, sizeof *f->free);
    f->open = gn_alloc(n + 1);
    bool held = f->start && f->bond && f->scale && f->free && f->open;
    /* Counts are stored two places ahead, so that filling the lists turns them into the starts. */
    for (size_t c = 0; held && c < b->soa.count; c++) {
        if (!is_section(b, c)) continue;
        f->start[b->i[c] + 2]++;
        f->start[b->j[c] + 2]++;
    }
    for (size_t p = 2; held && p < n + 2; p++) {
        most = (size_t)f->start[p] > most ? (size_t)f->start[p] : most;
        f->start[p] += f->start[p - 1];
    }
    for (size_t c = 0; held && c < b->soa.count; c++) {
        if (!is_section(b, c)) continue;
        f->bond[f->start[b->i[c] + 1]++] = (int32_t)c;
        f->bond[f->start[b->j[c] + 1]++] = (int32_t)c;
    }
    f->direction = gn_alloc_array(most + 1, sizeof *f->direction);
    if (held && f->direction) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for sections of %zu bonds", b->soa.count);
}

/* Finds the directions to the bonded neighbours of p; returns the sum of Dempack's sections. */
static double look_round(const gn_step_context *ctx, const gn_dem *dem, const faces *f, size_t p) {
    const gn_contacts *b = &dem->bonds.contacts;
    double sum = 0.0;
    for (int32_t k = f->start[p]; k < f->start[p + 1]; k++) {
        int32_t c = f->bond[k], other = (size_t)b->i[c] == p ? b->j[c] : b->i[c];
        double *d = f->direction[k - f->start[p]];
        double length = sqrt(
            gn_branch(ctx, dem->particles.pos + 4 * p, dem->particles.pos + 4 * (int64_t)other, d));
        for (int a = 0; a < 3; a++) d[a] /= length;
        sum += dempack_area(ctx, dem, b->i[c], b->j[c]);
    }
    return sum;
}

static gneiss_status find_faces(const gn_step_context *ctx, const gn_dem *dem, faces *f,
                                gneiss_error *error) {
    const int dimension = (int)ctx->scene.dimension;
    *f = (faces){0};
    GN_TRY(list_bonds(dem, f, error));
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        size_t n = (size_t)(f->start[p + 1] - f->start[p]);
        if (!n) continue;
        double sum = look_round(ctx, dem, f, p), r = dem->particles.pos[4 * p + 3];
        gn_polyhedron shape = gn_polyhedron_about(dimension, n, f->direction);
        double ball = dimension == 3 ? 4.0 * M_PI * r * r : 2.0 * M_PI * r;
        double whole = gn_polyhedron_ratio(dimension, shape.whole) * ball;
        double share = (double)n / shape.whole;
        f->scale[p] = whole * share / sum;
        f->free[p] = whole * (1.0 - share);
        f->open[p] = shape.open;
    }
    return GNEISS_OK;
}

/* Sets a section to the mean of the values at both ends; if only one end has missing neighbours, to
 * the value at the other end. */
static void set_polyhedra(const gn_step_context *ctx, gn_dem *dem, const faces *f) {
    gn_contacts *b = &dem->bonds.contacts;
    for (size_t c = 0; c < b->soa.count; c++) {
        int32_t i = b->i[c], j = b->j[c];
        double si = f->scale[i], sj = f->scale[j];
        double scale = f->open[i] == f->open[j] ? 0.5 * (si + sj) : f->open[i] ? sj : si;
        b->area[c] = scale * dempack_area(ctx, dem, i, j);
    }
}

gneiss_status gn_areas_find(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_contacts *b = &dem->bonds.contacts;
    faces f;
    if (!gn_scene_by_area(&ctx->scene)) return GNEISS_OK;
    dem->derived.gamma = gamma_of(ctx, dem);
    if (!(dem->derived.gamma > 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a specimen with pores for porosity, "
                       "found a porosity of %.4g",
                       gn_scene_at(&ctx->scene, ctx->scene.law_where, "law.gamma_rule").text,
                       gn_dem_porosity(ctx, dem));
    if (!b->area) return GNEISS_OK;
    if (ctx->scene.stiffness == GN_STIFFNESS_DEMPACK) {
        for (size_t c = 0; c < b->soa.count; c++)
            b->area[c] = dem->derived.gamma * dempack_area(ctx, dem, b->i[c], b->j[c]);
        return GNEISS_OK;
    }
    gneiss_status status = find_faces(ctx, dem, &f, error);
    if (status == GNEISS_OK) set_polyhedra(ctx, dem, &f);
    free_faces(&f);
    return status;
}

/* --- check --- */

gneiss_status gn_areas_check(const gn_step_context *ctx, const gn_dem *dem, gn_area_check *check,
                             gneiss_error *error) {
    const gn_contacts *b = &dem->bonds.contacts;
    const double all = (double)ctx->scene.dimension * ctx->volume;
    faces f;
    *check = (gn_area_check){.dempack_gamma = porosity_gamma(ctx, dem)};
    for (size_t c = 0; b->area && c < b->soa.count; c++)
        if (is_section(b, c)) check->filled += b->area[c] * b->length0[c] / all;
    if (ctx->scene.stiffness != GN_STIFFNESS_POLYHEDRON) return GNEISS_OK;
    gneiss_status status = find_faces(ctx, dem, &f, error);
    for (size_t p = 0; status == GNEISS_OK && p < dem->particles.soa.count; p++) {
        check->free += f.free[p] * dem->particles.pos[4 * p + 3] / all;
        check->open += f.open[p];
    }
    free_faces(&f);
    return status;
}
