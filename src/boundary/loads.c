/* Loads on every particle for output: the sums of motion_template.c in plain C. */
#include "boundary/loads.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "kernels/partials.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* --- contacts and walls --- */

/* Creates rows for a list's blocks, in double whatever the precision of the steps. */
static gneiss_status own_rows(const gn_partials *of, gn_partials *own, gneiss_error *error) {
    *own = *of;
    own->row_f = NULL;
    own->row =
        gn_alloc_array((size_t)of->first[of->blocks] + 1, (size_t)of->width * sizeof *own->row);
    if (own->row) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the forces of %d rows",
                   of->first[of->blocks]);
}

/* Adds up the rows in the order of particles and then blocks, as the steps do. */
static void add_rows(const gn_step_context *ctx, const gn_partials *of, double *load) {
    const bool space = ctx->effects & GN_FX_SPACE;
    for (int32_t k = 0; k < of->first[of->blocks]; k++) {
        const double *row = of->row + (size_t)of->width * (size_t)of->share[k].row;
        double *to = load + 6 * (size_t)of->share[k].particle;
        for (int a = 0; a < 2 + space; a++) to[a] += row[a];
        for (int a = 0; of->width == 8 && a < 3; a++) to[3 + a] += row[4 + a];
        if (!space && ctx->effects & GN_FX_ROTATION) to[5] += row[2];
    }
}

static gneiss_status add_list(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_periodic_box *box, const gn_contact_list *list, double *load,
                              gneiss_error *error) {
    gn_partials own;
    gn_contacts copy = {0};
    if (!list->contacts.soa.count) return GNEISS_OK;
    GN_TRY(own_rows(&list->partials, &own, error));
    gneiss_status status = gn_contacts_evaluate(ctx, dem, box, &list->contacts, &own, &copy, error);
    if (status == GNEISS_OK) add_rows(ctx, &own, load);
    gn_soa_destroy(&gn_contact_record, &copy);
    gn_free(own.row);
    return status;
}

static void add_walls(const gn_step_context *ctx, const gn_boundary *boundary, double *load) {
    const gn_wall_contacts *walls = &boundary->contacts;
    const int dimension = (int)ctx->scene.dimension;
    for (size_t c = 0; ctx->effects & GN_FX_WALLS && c < walls->soa.count; c++) {
        double *to = load + 6 * (size_t)walls->i[c];
        for (int a = 0; a < dimension; a++) to[a] += walls->row[8 * c + (size_t)a];
        for (int a = dimension == 3 ? 0 : 2; ctx->effects & GN_FX_ROTATION && a < 3; a++)
            to[3 + a] += walls->row[8 * c + 4 + (size_t)a];
    }
}

/* --- background damping --- */

/* Returns the magnitude of a vector over its free components. */
static double free_size(const double *v, unsigned held) {
    double square = 0.0;
    for (int a = 0; a < 3; a++) square += held >> a & 1 ? 0.0 : v[a] * v[a];
    return sqrt(square);
}

/* Damps a force or moment f by the velocity or spin v, with 1/m in v[3]; `held`: driven components,
 * which are not damped. See `kick` and `damp_free` of motion_template.c. */
static void damp(const gn_step_context *ctx, double coefficient, unsigned held, const double *f,
                 const double *v, double *out) {
    const double interval = 0.5 * (ctx->dt_past + ctx->dt), inverse = v[3];
    const double lead = ctx->scene.background_velocity == GN_VELOCITY_INSTANT ? 0.5 : 0.0;
    const double speed = free_size(v, held), size = free_size(f, held);
    for (int a = 0; a < 3; a++) {
        if (held >> a & 1) continue;
        if (ctx->effects & GN_FX_VISCOUS) {
            double half = 0.5 * coefficient * interval;
            double after = (v[a] * (1.0 - half) + interval * inverse * f[a]) / (1.0 + half);
            out[a] = -0.5 * coefficient * (v[a] + after) / inverse;
        } else if (ctx->effects & GN_FX_NONVISCOUS_VECTOR) {
            out[a] = speed > 0.0 ? -coefficient * size / speed * v[a] : 0.0;
        } else if (ctx->effects & GN_FX_NONVISCOUS_COMPONENT) {
            double along = v[a] + lead * interval * inverse * f[a];
            out[a] = along != 0.0 ? -copysign(coefficient * fabs(f[a]), along) : 0.0;
        }
    }
}

static unsigned driven(const gn_dem *dem, size_t p) {
    if (!dem->prescribed.count || dem->particles.slot[p] < 0) return 0;
    return dem->prescribed.mask[dem->particles.slot[p]];
}

/* --- loads of all particles --- */

static void complete(const gn_step_context *ctx, const gn_dem *dem, size_t p, double *total,
                     double *damping) {
    const gn_particles *q = &dem->particles;
    const double *v = q->vel + 4 * p, *spin = q->spin ? q->spin + 4 * p : NULL;
    memset(damping, 0, 6 * sizeof *damping);
    if (!gn_particle_is_active(q, p)) {
        memset(total, 0, 6 * sizeof *total);
        return;
    }
    const bool bound = gn_clump_of(dem, p) != NULL;
    const double mass = bound ? gn_clump_mass_of(dem, p) : gn_own_share(q, p) / v[3];
    for (size_t a = 0; a < 3; a++) {
        total[a] += mass * ctx->scene.gravity[a];
        if (q->applied) total[a] += q->applied[4 * p + a];
    }
    if (bound) return; /* background damping acts on the clump */
    const unsigned held = driven(dem, p);
    damp(ctx, ctx->scene.background_coefficient, held, total, v, damping);
    if (spin && spin[3] > 0.0)
        damp(ctx, gn_scene_spin_damping(&ctx->scene), held >> 3, total + 3, spin, damping + 3);
    for (int k = 0; k < 6; k++) total[k] += damping[k];
}

gneiss_status gn_boundary_write_loads(const gn_step_context *ctx, const gn_dem *dem,
                                      const gn_boundary *boundary, const gn_periodic_box *box,
                                      double *total, double *damping, gneiss_error *error) {
    const gn_dem *d = dem;
    memset(total, 0, 6 * d->particles.soa.count * sizeof *total);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        GN_TRY(add_list(ctx, dem, box, &d->list[l], total, error));
    add_walls(ctx, boundary, total);
    for (size_t p = 0; p < d->particles.soa.count; p++)
        complete(ctx, dem, p, total + 6 * p, damping + 6 * p);
    return GNEISS_OK;
}
