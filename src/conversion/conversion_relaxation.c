/* Released particles inherit the affine displacement of their element, which in a disordered
 * packing is no state of equilibrium of each particle. Within the instant of the conversion they
 * are moved into equilibrium, all others held (Labra 2012, 5.3, by pseudo steps): a linear
 * equilibrium of the springs that hold them, solved again while contacts close and open or rotate.
 *
 * Equilibrium includes inertia. Just before, each particle followed its element with an
 * acceleration a (first section below); it continues with F_i = m_i a. A wave that passes the
 * converted region therefore stays a wave, and weight and drag act on both sides alike. Only the
 * forces that elements do not have are removed.
 *
 * No bond reaches its strength by it: both ends of such a bond are held, and so is a particle that
 * would move farther than a spring that holds it would allow. Contacts close and open on the way,
 * which no linear system contains: only the part of the solution that lowers the energy, of the
 * springs as they are then less the work of m a, is applied, or none. Velocities and hence momentum
 * are unchanged; the energy that springs lose is booked with the conversion. */
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "couple/held_springs.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/active_pairs.h"
#include "particles/particles.h"
#include "particles/refresh.h"
#include "scene/couple_def.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* --- accelerations before the conversion --- */

/* Acceleration that elements give to the particles which are about to be released: a = sum_a N_a
 * f_a/m_a, with the forces f_a at their nodes from elements and from the particles that the nodes
 * carry. Weight and drag are proportional to masses and are not included. */
typedef struct pull {
    uint8_t *node, *element; /* nodes of converting elements; converting elements */
    double *force;           /* [nodes][3] N */
} pull;

static void find_nodes(const gn_conversion *conversion, pull *q) {
    const gn_elements *elements = &gn_coupled_solid(conversion->model->solids)->elements;
    const int corners = gn_coupled_solid(conversion->model->solids)->dimension + 1;
    for (size_t e = 0; e < elements->soa.count; e++)
        for (int a = 0; a < corners && conversion->kind[e] == GN_FRONT_LEAVING; a++)
            q->node[gn_elements_node(elements, a)[e]] = 1;
    for (size_t e = 0; e < elements->soa.count; e++)
        for (int a = 0; a < corners; a++)
            q->element[e] |= q->node[gn_elements_node(elements, a)[e]];
}

static void add_element_forces(const gn_conversion *conversion, const pull *q) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    double force[4][3];
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        if (!q->element[e]) continue;
        gn_fem_force_of(b, e, force);
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < 3; k++)
                q->force[3 * gn_elements_node(&b->elements, a)[e] + k] += force[a][k];
    }
}

static void add_force_to_nodes(const gn_conversion *conversion, const pull *q, int32_t p,
                               double side, const double force[3]) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const gn_tie tie = gn_tie_at(b, gn_home_of(conversion, (size_t)p),
                                 conversion->model->dem->particles.start + 4 * (size_t)p);
    for (int a = 0; a <= b->dimension; a++)
        for (int k = 0; k < 3; k++) q->force[3 * tie.node[a] + k] += side * tie.shape[a] * force[k];
}

/* Adds the forces of contacts at the particles of zones. */
static void add_contact_forces(const gn_conversion *conversion, const pull *q,
                               const gn_contacts *list) {
    for (size_t k = 0; k < list->soa.count; k++) {
        const int32_t end[2] = {list->i[k], list->j[k]};
        bool in[2];
        double n[3], force[3], length;
        for (int m = 0; m < 2; m++)
            in[m] = conversion->tied[end[m]] && q->element[gn_home_of(conversion, (size_t)end[m])];
        if (!in[0] && !in[1]) continue;
        gn_contact_held(conversion->model->ctx, conversion->model->dem, list, k, n, &length, force);
        for (int m = 0; m < 2; m++)
            if (in[m]) add_force_to_nodes(conversion, q, end[m], m ? -1.0 : 1.0, force);
    }
}

static void take_rates(const gn_conversion *conversion, const pull *q) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    const gn_particles *p = &conversion->model->dem->particles;
    for (size_t k = 0; k < p->soa.count; k++) {
        if (!conversion->freed[k]) continue;
        const gn_tie tie = gn_tie_at(b, gn_home_of(conversion, k), p->start + 4 * k);
        memset(conversion->rate + 3 * k, 0, 3 * sizeof *conversion->rate);
        for (int a = 0; a <= b->dimension; a++)
            for (int m = 0; m < 3; m++)
                conversion->rate[3 * k + (size_t)m] += tie.shape[a] *
                                                       q->force[3 * tie.node[a] + m] *
                                                       b->nodes.vel[4 * (size_t)tie.node[a] + 3];
    }
}

gneiss_status gn_conversion_find_rates(const gn_conversion *conversion, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(conversion->model->solids);
    if (!(conversion->model->ctx->scene.couple.convert.relax > 0.0)) return GNEISS_OK;
    pull q = {.node = gn_alloc(b->nodes.soa.count + 1),
              .element = gn_alloc(b->elements.soa.count + 1),
              .force = gn_alloc_array(b->nodes.soa.count + 1, 3 * sizeof *q.force)};
    const bool held = q.node && q.element && q.force;
    if (held) {
        find_nodes(conversion, &q);
        add_element_forces(conversion, &q);
        add_contact_forces(conversion, &q, &conversion->model->dem->bonds.contacts);
        add_contact_forces(conversion, &q, &conversion->model->dem->pairs.contacts);
        take_rates(conversion, &q);
    }
    gn_free(q.node);
    gn_free(q.element);
    gn_free(q.force);
    return held ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to convert elements");
}

enum { N = GN_HELD_DOFS, PASSES = 20 };

/* Tolerance of a linear solve, as a fraction of that of the relaxation. */
static const double solved = 0.3;
/* Largest displacement in one solve of a particle that contacts hold, in radii. */
static const double farthest = 0.02;
/* Largest number of halvings of a step that does not decrease the energy. */
enum { HALVINGS = 8 };
/* Energy changes below this fraction of the sum of magnitudes are rounding. */
static const double least_energy = 1e-13;
/* Forces of contacts that are below this number times the rounding of positions count as zero. */
static const double roundings = 64.0;

typedef struct link {
    gn_contacts *list;
    size_t at;
    double force[3], normal, worst; /* N, force on its first particle; its component along n;
                                       largest ratio to its strength */
    bool bonded;
} link;

typedef struct relaxation {
    const gn_step_context *ctx;
    gn_dem *dem;
    gn_boundary *boundary;
    gn_solids *solids;
    gn_ledger *ledger;
    const gn_conversion *c;
    size_t count, links;
    int32_t *particle,
        *local; /* [count] released particles; [particles] index among them, -1: held */
    link *link;
    gn_held_spring *spring; /* [links] */
    uint8_t *moves, *kept;  /* [count] components that may move; 1: particle is held, because a bond
                               would break */
    double *load, *u, *work;
    double *moved;         /* [count][3] m, since the start */
    double *place, *shear; /* [count][7] positions and orientations, [links][3] tangential forces,
                              N: values before a step */
    unsigned components;
    double ratio, moving; /* mean load over mean contact force; number of movable particles */
    double rounding;      /* N */
    double energy,
        size; /* J: energy of the links minus the work of m a; sum of the magnitudes of its terms */
    int iterations;
    bool stopped_by_bond_failure, unsupported; /* particles are held because a bond would break;
                                                  because they have no support */
} relaxation;

/* --- particles and their contacts --- */

static bool allocate(relaxation *r, size_t links) {
    const size_t n = r->count + 1;
    r->link = gn_alloc_array(links + 1, sizeof *r->link);
    r->spring = gn_alloc_array(links + 1, sizeof *r->spring);
    r->moves = gn_alloc(n);
    r->kept = gn_alloc(n);
    r->load = gn_alloc_array(n, N * sizeof *r->load);
    r->u = gn_alloc_array(n, N * sizeof *r->u);
    r->work = gn_alloc_array(gn_held_work(r->count), sizeof *r->work);
    r->moved = gn_alloc_array(n, 3 * sizeof *r->moved);
    r->place = gn_alloc_array(n, 7 * sizeof *r->place);
    r->shear = gn_alloc_array(links + 1, 3 * sizeof *r->shear);
    return r->link && r->spring && r->moves && r->kept && r->load && r->u && r->work && r->moved &&
           r->place && r->shear;
}

static void release(relaxation *r) {
    void *blocks[] = {r->particle, r->local, r->link, r->spring, r->moves, r->kept,
                      r->load,     r->u,     r->work, r->place,  r->shear, r->moved};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
}

static bool find_particles(relaxation *r) {
    const size_t n = r->dem->particles.soa.count;
    r->local = gn_alloc_array_raw(n + 1, sizeof *r->local);
    r->particle = gn_alloc_array_raw(n + 1, sizeof *r->particle);
    for (size_t p = 0; r->local && r->particle && p < n; p++) {
        r->local[p] = r->c->freed[p] ? (int32_t)r->count : -1;
        if (r->c->freed[p]) r->particle[r->count++] = (int32_t)p;
    }
    return r->local && r->particle;
}

/* Counts, or with `take` collects, the contacts of a list that have a released particle. */
static size_t find_links(relaxation *r, gn_contacts *list, bool take) {
    size_t found = 0;
    for (size_t k = 0; k < list->soa.count; k++) {
        if (!r->c->freed[list->i[k]] && !r->c->freed[list->j[k]]) continue;
        found++;
        if (!take) continue;
        r->spring[r->links].i = r->local[list->i[k]];
        r->spring[r->links].j = r->local[list->j[k]];
        r->link[r->links++] = (link){.list = list, .at = k};
    }
    return found;
}

static gneiss_status begin(relaxation *r, gneiss_error *error) {
    gn_dem *d = r->dem;
    bool held = find_particles(r);
    if (held && r->count)
        held = allocate(r, find_links(r, &d->bonds.contacts, false) +
                               find_links(r, &d->pairs.contacts, false));
    if (!held) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to relax particles");
    if (!r->count) return GNEISS_OK;
    find_links(r, &d->bonds.contacts, true);
    find_links(r, &d->pairs.contacts, true);
    r->components = r->ctx->scene.dimension == 3 ? 0x7u : 0x3u;
    if (d->particles.spin) r->components |= r->ctx->scene.dimension == 3 ? 0x38u : 0x20u;
    memset(r->moves, (int)r->components, r->count);
    return GNEISS_OK;
}

/* --- forces --- */

/* Returns the energy, J, of a contact; for a sliding contact, that of its springs at the limit of
 * friction. */
static double stored_in(const relaxation *r, size_t k, double length, double rest) {
    const link *l = &r->link[k];
    const double *n = r->spring[k].n;
    const gn_law_held h =
        gn_law_of(l->list->soa.effects)->held(l->list, l->at, length, length - rest);
    const double kt = l->list->kt ? l->list->kt[l->at] : 0.0;
    double across[3];
    if (!l->bonded && l->normal == 0.0) return 0.0;
    for (int a = 0; a < 3; a++) across[a] = l->force[a] - l->normal * n[a];
    return h.stored +
           (kt > 0.0 ? (gn_dot3(across, across) - gn_dot3(h.shear, h.shear)) / (2.0 * kt) : 0.0);
}

/* Computes the force and the stiffness of contact k. */
static void look_at(relaxation *r, size_t k) {
    link *l = &r->link[k];
    gn_held_spring *s = &r->spring[k];
    const gn_contacts *list = l->list;
    const gn_law *law = gn_law_of(list->soa.effects);
    const gn_particles *q = &r->dem->particles;
    const double *i = q->pos + 4 * (size_t)list->i[l->at], *j = q->pos + 4 * (size_t)list->j[l->at];
    const double half = r->ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    double length, across[3];
    l->normal = gn_contact_held(r->ctx, r->dem, list, l->at, s->n, &length, l->force);
    for (int a = 0; a < 3; a++) across[a] = l->force[a] - l->normal * s->n[a];
    const double rest = list->length0 ? list->length0[l->at] : i[3] + j[3];
    const double shear = sqrt(gn_dot3(across, across));
    const gn_law_spring spring = law->spring(list, l->at, fmax(rest - length, 0.0));
    l->bonded = gn_contact_bonded(list, l->at);
    l->worst = l->bonded ? law->criterion(list, l->at, l->normal, 0.0, shear) : 0.0;
    const bool acts = l->bonded || l->normal != 0.0;
    const bool sticks = l->bonded || !law->slips(list, l->at, l->normal, shear);
    s->arm_i = i[3] + half * (length - i[3] - j[3]);
    s->arm_j = j[3] + half * (length - i[3] - j[3]);
    s->kn = acts ? spring.kn : 0.0;
    s->kt = acts && sticks ? spring.kt : 0.0;
    const double stored = stored_in(r, k, length, rest);
    r->energy += stored;
    r->size += fabs(stored);
}

static void add_load(relaxation *r, int32_t p, double side, double arm, const double n[3],
                     const double force[3]) {
    double moment[3];
    if (p < 0) return;
    gn_cross3(n, force, moment);
    for (int a = 0; a < 3; a++) {
        r->load[N * (size_t)p + (size_t)a] += side * force[a];
        r->load[N * (size_t)p + 3 + (size_t)a] += arm * moment[a];
    }
}

/* Returns the size of the residual force on a particle, N; moments are divided by its radius. */
static double left_on(const relaxation *r, size_t k) {
    const double radius = r->dem->particles.pos[4 * (size_t)r->particle[k] + 3];
    double square = 0.0;
    for (size_t a = 0; a < N; a++) {
        const double f = a < 3 ? r->load[N * k + a] : r->load[N * k + a] / radius;
        if (r->components >> a & 1) square += f * f;
    }
    return sqrt(square);
}

static void weigh_loads(relaxation *r, double force) {
    double sum[2] = {0.0};
    size_t moving = 0;
    for (size_t k = 0; k < r->count; k++) {
        const double left = left_on(r, k);
        sum[0] += left;
        if (!r->kept[k]) sum[1] += left;
        moving += !r->kept[k];
    }
    const double least = fmax(force, r->rounding);
    r->ratio = least > 0.0 ? sum[0] / (double)r->count / least : 0.0;
    r->moving = least > 0.0 && moving ? sum[1] / (double)moving / least : 0.0;
}

static void evaluate(relaxation *r) {
    const gn_particles *q = &r->dem->particles;
    double force = 0.0, stiffness = 0.0, reach = 0.0;
    size_t carry = 0;
    memset(r->load, 0, N * r->count * sizeof *r->load);
    r->energy = r->size = 0.0;
    for (size_t k = 0; k < r->links; k++) {
        look_at(r, k);
        const gn_held_spring *s = &r->spring[k];
        const double size = sqrt(gn_dot3(r->link[k].force, r->link[k].force));
        add_load(r, s->i, 1.0, s->arm_i, s->n, r->link[k].force);
        add_load(r, s->j, -1.0, s->arm_j, s->n, r->link[k].force);
        force += size;
        carry += size > 0.0;
        stiffness = fmax(stiffness, s->kn);
    }
    for (size_t k = 0; k < r->count; k++) {
        const size_t p = (size_t)r->particle[k];
        for (size_t a = 0; a < 3; a++) {
            const double carried = r->c->rate[3 * p + a] / q->vel[4 * p + 3];
            r->load[N * k + a] -= carried;
            r->energy += carried * r->moved[3 * k + a];
            r->size += fabs(carried * r->moved[3 * k + a]);
            reach = fmax(reach, fabs(q->pos[4 * p + a]));
        }
    }
    r->rounding = roundings * 2.3e-16 * stiffness * reach / r->ctx->scene.couple.convert.relax;
    weigh_loads(r, carry ? force / (double)carry : 0.0);
}

/* --- displacements --- */

/* Computes the relative displacement of the two ends of a contact at the contact point. */
static void parting(const relaxation *r, size_t k, double e[3]) {
    const gn_held_spring *s = &r->spring[k];
    memset(e, 0, 3 * sizeof *e);
    for (int end = 0; end < 2; end++) {
        const int32_t p = end ? s->j : s->i;
        double turned[3];
        if (p < 0) continue;
        const double *u = r->u + N * (size_t)p;
        gn_cross3(u + 3, s->n, turned);
        for (int a = 0; a < 3; a++)
            e[a] += (end ? u[a] : -u[a]) - (end ? s->arm_j : s->arm_i) * turned[a];
    }
}

/* Holds the ends of bonds that would reach their strength; returns false if there is no such bond.
 */
static bool hold_at_bonds(relaxation *r) {
    bool any = false;
    for (size_t k = 0; k < r->links; k++) {
        const link *l = &r->link[k];
        const gn_held_spring *s = &r->spring[k];
        double e[3], t[3];
        if (!l->bonded) continue;
        parting(r, k, e);
        const double along = gn_dot3(e, s->n);
        for (int a = 0; a < 3; a++)
            t[a] = l->force[a] - l->normal * s->n[a] + s->kt * (e[a] - along * s->n[a]);
        const double then =
            gn_law_of(l->list->soa.effects)
                ->criterion(l->list, l->at, l->normal + s->kn * along, 0.0, sqrt(gn_dot3(t, t)));
        if (then < 1.0 - 1e-6 || then <= l->worst) continue;
        for (int end = 0; end < 2; end++) {
            const int32_t p = end ? s->j : s->i;
            if (p < 0 || r->kept[p]) continue;
            r->kept[p] = 1;
            r->moves[p] = 0;
            r->stopped_by_bond_failure = any = true;
        }
    }
    return any;
}

/* Holds particles that would move farther than the springs that support them allow; returns false
 * if there are none. */
static bool hold_unsupported(relaxation *r) {
    bool any = false;
    for (size_t k = 0; k < r->count; k++) {
        const double *u = r->u + N * k,
                     most = farthest * r->dem->particles.pos[4 * (size_t)r->particle[k] + 3];
        if ((gn_dot3(u, u) <= most * most && gn_dot3(u + 3, u + 3) <= farthest * farthest) ||
            r->kept[k])
            continue;
        r->kept[k] = 1;
        r->moves[k] = 0;
        r->unsupported = any = true;
    }
    return any;
}

static void turn(double *o, const double *by) {
    const double x = 0.5 * by[0], y = 0.5 * by[1], z = 0.5 * by[2];
    const double q[4] = {
        o[0] - x * o[1] - y * o[2] - z * o[3], o[1] + x * o[0] + y * o[3] - z * o[2],
        o[2] + y * o[0] + z * o[1] - x * o[3], o[3] + z * o[0] + x * o[2] - y * o[1]};
    const double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; k++) o[k] = q[k] / size;
}

/* Stores the state that a step changes, or restores it. */
static void keep_state(relaxation *r, bool back) {
    gn_particles *q = &r->dem->particles;
    for (size_t k = 0; k < r->links; k++) {
        gn_contacts *list = r->link[k].list;
        for (size_t a = 0; a < 3; a++) {
            const size_t at = r->link[k].at + a * list->soa.capacity;
            double *kept = &r->shear[3 * k + a];
            if (!back) *kept = list->shear_f ? (double)list->shear_f[at] : 0.0;
            if (!back && list->shear) *kept = list->shear[at];
            if (back && list->shear) list->shear[at] = *kept;
            if (back && list->shear_f) list->shear_f[at] = (float)*kept;
        }
    }
    for (size_t k = 0; k < r->count; k++) {
        const size_t p = 4 * (size_t)r->particle[k];
        double *kept = r->place + 7 * k;
        memcpy(back ? q->pos + p : kept, back ? kept : q->pos + p, 3 * sizeof *kept);
        if (q->orientation)
            memcpy(back ? q->orientation + p : kept + 3, back ? kept + 3 : q->orientation + p,
                   4 * sizeof *kept);
    }
}

/* Moves particles by the fraction `part` of the search direction. */
static void move(relaxation *r, double part) {
    gn_particles *q = &r->dem->particles;
    for (size_t k = 0; k < r->links; k++) {
        gn_contacts *list = r->link[k].list;
        const gn_held_spring *s = &r->spring[k];
        double e[3];
        parting(r, k, e);
        const double along = gn_dot3(e, s->n);
        for (size_t a = 0; a < 3; a++) {
            const size_t at = r->link[k].at + a * list->soa.capacity;
            const double more = part * s->kt * (e[a] - along * s->n[a]);
            if (list->shear) list->shear[at] += more;
            if (list->shear_f) list->shear_f[at] = (float)((double)list->shear_f[at] + more);
        }
    }
    for (size_t k = 0; k < r->count; k++) {
        const size_t p = 4 * (size_t)r->particle[k];
        double turned[3];
        for (size_t a = 0; a < 3; a++) {
            q->pos[p + a] += part * r->u[N * k + a];
            r->moved[3 * k + a] += part * r->u[N * k + a];
            turned[a] = part * r->u[N * k + 3 + a];
            if (q->travel_f) q->travel_f[p + a] = (float)(q->pos[p + a] - q->ref[p + a]);
        }
        if (q->orientation) turn(q->orientation + p, turned);
    }
}

static void move_back(relaxation *r, double part) {
    gn_particles *q = &r->dem->particles;
    keep_state(r, true);
    for (size_t k = 0; k < r->count; k++)
        for (size_t a = 0; a < 3; a++) {
            const size_t p = 4 * (size_t)r->particle[k] + a;
            r->moved[3 * k + a] -= part * r->u[N * k + a];
            if (q->travel_f) q->travel_f[p] = (float)(q->pos[p] - q->ref[p]);
        }
}

/* Performs a line search by halving until the energy decreases; returns false if it never does. The
 * direction is that of the springs before, because `evaluate` recomputes them. */
static bool descend(relaxation *r) {
    const double before = r->energy, rounding = least_energy * r->size;
    double part = 1.0;
    keep_state(r, false);
    for (int k = 0; k <= HALVINGS; k++, part *= 0.5) {
        move(r, part);
        evaluate(r);
        if (r->energy <= before + rounding) return true;
        move_back(r, part);
        evaluate(r); /* also recomputes the springs, and with them the next direction */
    }
    return false;
}

/* Solves until no particle moves too far and no bond would break; returns false if the iterations
 * are used up. */
static bool solve_displacements(relaxation *r, double wanted, int most) {
    const gn_held_system system = {.particles = r->count,
                                   .springs = r->links,
                                   .spring = r->spring,
                                   .moves = r->moves,
                                   .work = r->work};
    const double tolerance = fmin(solved * wanted / r->moving, 0.5);
    while (r->iterations < most) {
        r->iterations += gn_held_solve(&system, r->load, tolerance, most - r->iterations, r->u);
        if (hold_unsupported(r)) continue;
        if (!hold_at_bonds(r)) return true;
    }
    return false;
}

/* Returns the ratio of load to mean contact force before relaxation. */
static double relax(relaxation *r) {
    const gn_convert_def *def = &r->ctx->scene.couple.convert;
    evaluate(r);
    const double before = r->ratio;
    for (int k = 0; k < PASSES && r->moving > def->relax; k++) {
        if (!solve_displacements(r, def->relax, (int)def->relax_iterations) || !descend(r)) break;
    }
    return before;
}

static void note(const relaxation *r, double before) {
    gn_relaxations *all = &r->c->model->converted->relaxed;
    const double wanted = r->ctx->scene.couple.convert.relax;
    if (!(before > wanted)) return;
    all->count += 1.0;
    all->iterations += r->iterations;
    for (size_t k = 0; k < r->count; k++) all->kept += r->kept[k];
    if (!(r->ratio > wanted)) return;
    const bool hit_limit = r->iterations >= (int)r->ctx->scene.couple.convert.relax_iterations;
    all->missed += 1.0;
    if (r->stopped_by_bond_failure)
        all->stopped_by_bond_failure += 1.0;
    else if (r->unsupported)
        all->unsupported += 1.0;
    else if (hit_limit)
        all->hit_iteration_limit += 1.0;
    if (!(r->ratio > all->worst)) return;
    all->worst = r->ratio;
    all->time = r->ctx->time;
}

/* Updates the displacement bounds of the lists. */
static void update_drift(relaxation *r) {
    const gn_particles *q = &r->dem->particles;
    double most = 0.0;
    for (size_t k = 0; k < r->count; k++) {
        const size_t p = 4 * (size_t)r->particle[k];
        double d[3];
        for (size_t a = 0; a < 3; a++) d[a] = q->pos[p + a] - q->ref[p + a];
        most = fmax(most, gn_dot3(d, d));
    }
    gn_dem_set_paths(r->dem, sqrt(most));
}

gneiss_status gn_conversion_relax(const gn_conversion *conversion, gneiss_error *error) {
    const gn_convertible *model = conversion->model;
    relaxation r = {.ctx = model->ctx,
                    .dem = model->dem,
                    .boundary = model->boundary,
                    .solids = model->solids,
                    .ledger = model->ledger,
                    .c = conversion};
    if (!(model->ctx->scene.couple.convert.relax > 0.0)) return GNEISS_OK;
    gneiss_status status = begin(&r, error);
    if (status == GNEISS_OK && r.count) {
        note(&r, relax(&r));
        update_drift(&r);
        gn_active_pairs_forget(model->ctx, model->dem);
    }
    release(&r);
    return status;
}
