/* The pressure around bonds, for `law.confinement: mean` (in Santasusana 2013 friction uses the
 * normal force of the bond alone, so that bonds across the direction of pressure gain no strength).
 * The stress of a particle is 1/V sum f (x) l over its bonds, with l its share of the branch, of
 * length r, and V = sum A r/d: its mean, tr/d, is sum f_n/sum A for any dimension d. A bond uses
 * the mean of its two particles times its own section. Broken bonds count with their pressure;
 * other contacts have no section and do not count. */
#include "frame/frame.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "soa/records.h"

static double pressure_of(const double around[2]) {
    return around[1] > 0.0 ? -around[0] / around[1] : 0.0;
}

static double normal_of(const gn_step_context *ctx, const gn_dem *dem, const gn_law *law,
                        const gn_contacts *contacts, size_t c) {
    const double *pos = dem->particles.pos;
    double d[3];
    double length = sqrt(
        gn_branch(ctx, pos + 4 * (int64_t)contacts->i[c], pos + 4 * (int64_t)contacts->j[c], d));
    return law->held(contacts, c, length, length - contacts->length0[c]).normal;
}

static void put(const gn_contacts *contacts, size_t c, double value) {
    if (contacts->confined) contacts->confined[c] = value;
    if (contacts->confined_f) contacts->confined_f[c] = (float)value;
}

static double get(const gn_contacts *contacts, size_t c) {
    return contacts->confined ? contacts->confined[c] : (double)contacts->confined_f[c];
}

/* Sums are formed in the order of the list, on one thread, so that they are the same for any number
 * of threads. */
static void add_up(const gn_dem *dem, const gn_contacts *contacts, double *around) {
    for (size_t p = 0; p < 2 * dem->particles.soa.count; p++) around[p] = 0.0;
    for (size_t c = 0; c < contacts->soa.count; c++) {
        double force = get(contacts, c), section = contacts->section[c];
        double *i = around + 2 * (int64_t)contacts->i[c], *j = around + 2 * (int64_t)contacts->j[c];
        i[0] += force;
        i[1] += section;
        j[0] += force;
        j[1] += section;
    }
}

void gn_dem_confine(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *contacts) {
    double *around = dem->around;
    const size_t count = contacts->soa.count;
    if (!(contacts->soa.effects & GN_FX_CONFINED) || !count) return;
    const gn_law *law = gn_law_of(contacts->soa.effects);
#pragma omp parallel for schedule(static) num_threads(ctx->threads)
    for (size_t c = 0; c < count; c++) put(contacts, c, normal_of(ctx, dem, law, contacts, c));
    add_up(dem, contacts, around);
#pragma omp parallel for schedule(static) num_threads(ctx->threads)
    for (size_t c = 0; c < count; c++) {
        double pi = pressure_of(around + 2 * (int64_t)contacts->i[c]);
        double pj = pressure_of(around + 2 * (int64_t)contacts->j[c]);
        put(contacts, c, 0.5 * (pi + pj) * contacts->section[c]);
    }
}
