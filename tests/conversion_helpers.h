/* Blocks of elements with a dormant lattice inside. */
#ifndef GN_TESTS_CONVERSION_HELPERS_H
#define GN_TESTS_CONVERSION_HELPERS_H

#include "conversion/conversion.h"
#include "couple/front.h"
#include "world_helpers.h"
#include "zones/zones.h"

/* A block of elements of 2 mm, and a square lattice (3D: cubic) of spacing 1 mm in all of it, with
 * k_n = k_t: along its axes and across them it has the moduli M = k_n and G = M/2 of the elements,
 * nu = 0. */
typedef struct block {
    int cells[3]; /* number of elements along each axis */
    bool space;
    const char *convert; /* further keys of the scene */
    const char *box;     /* NULL: all */
    const char *elements, *rest;
    const char *couple, *time; /* further keys of the sections `couple` and `time` */
    double distortion;         /* distortion of the mesh */
    int finer;                 /* number of elements per 2 mm along each axis; 0: one */
    double thin;               /* m, of a zone; 0: `width` */
} block;

static const double modulus = 24e9, density = 7800.0, spacing = 1e-3, width = 6e-3;

static inline text *text_of(const block *s) {
    text *t = calloc(1, sizeof *t);
    const double solid = s->space ? pi / 6.0 : pi / 4.0;
    char cells[64], count[64], size[96];
    const int finer = s->finer ? s->finer : 1;
    snprintf(cells, sizeof cells, s->space ? "%d, %d, %d" : "%d, %d", finer * s->cells[0],
             finer * s->cells[1], finer * s->cells[2]);
    snprintf(count, sizeof count, s->space ? "%d, %d, %d" : "%d, %d", 2 * s->cells[0],
             2 * s->cells[1], 2 * s->cells[2]);
    snprintf(size, sizeof size, s->space ? "%d mm, %d mm, %d mm" : "%d mm, %d mm", 2 * s->cells[0],
             2 * s->cells[1], 2 * s->cells[2]);
    add(t, "dimension: %d\n", s->space ? 3 : 2);
    add(t, "specimen: {group: 1, lattice: {kind: %s, radius: 0.5 mm, cells: [%s]}}\n",
        s->space ? "cubic" : "square", count);
    add(t,
        "materials: [{name: m, density: %.17g, normal_stiffness: %g, kratio: 1, friction: 0.2, "
        "bond_tension_limit: 1e15, bond_shear_limit: 1e15}]\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n",
        density / solid, s->space ? modulus * spacing : modulus);
    add(t,
        "elements: {%s: {size: [%s], cells: [%s], distortion: %g}, materials: [{young: %g, "
        "poisson: "
        "0, density: %g}]%s}\n",
        s->space ? "box" : "rectangle", size, cells, s->distortion, modulus, density,
        s->elements ? s->elements : "");
    add(t, "couple: {convert: {box: %s, width: %g, %s}%s}\ntime: {end: 1%s}\n%s",
        s->box     ? s->box
        : s->space ? "{min: [-1, -1, -1], max: [1, 1, 1]}"
                   : "{min: [-1, -1], max: [1, 1]}",
        s->thin > 0.0 ? s->thin : width, s->convert ? s->convert : "stress: 1e30",
        s->couple ? s->couple : "", s->time ? s->time : "",
        s->rest ? s->rest : "run: {threads: 1}\n");
    return t;
}

static inline gn_world *block_of(const block *s) {
    text *t = text_of(s);
    gn_world *w = world_of("%s", t->s);
    free(t);
    return w;
}

static const block plate = {.cells = {15, 8, 0}};
static const block cube = {.cells = {10, 4, 4}, .space = true};

/* --- fields, and conversions by hand --- */

typedef void field(const double *x, const void *of, double u[3], double v[3]);

static inline void set_field(gn_particles *q, field *at, const void *of) {
    for (size_t p = 0; p < q->soa.count; p++) {
        double u[3] = {0}, v[3] = {0};
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        at(q->start + 4 * p, of, u, v);
        for (size_t k = 0; k < 3; k++) {
            q->pos[4 * p + k] = q->start[4 * p + k] + u[k];
            q->vel[4 * p + k] = v[k];
        }
    }
}

/* Sets all elements to a field, while all particles are dormant. */
static inline void set_elements(gn_world *w, field *at, const void *of) {
    set_field(&w->solids.elements[0]->solid.nodes, at, of);
    gn_fem_positions_changed(&w->solids.elements[0]->solid);
    gn_fem_to_single(&w->solids.elements[0]->solid);
}

/* Converts the elements all nodes of which start between two corners. */
static inline gneiss_status convert_box(gn_world *w, const double low[3], const double high[3],
                                        gneiss_error *error) {
    const gn_fem_solid *b = &w->solids.elements[0]->solid;
    const gn_convertible model = gn_world_convertible(w);
    uint8_t *kind = calloc(b->elements.soa.count + 1, 1);
    gneiss_status status = gn_conversion_kinds(&w->ctx, &w->solids, kind, error);
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        bool in = kind[e] == GN_FRONT_READY;
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < b->dimension; k++) {
                double x =
                    b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e] + (size_t)k];
                in = in && x >= low[k] - 1e-9 && x <= high[k] + 1e-9;
            }
        if (in) kind[e] = GN_FRONT_LEAVING;
    }
    if (status == GNEISS_OK) status = gn_conversion_convert(&model, kind, error);
    free(kind);
    return status;
}

static inline void convert(gn_world *w, double from, double to, double low, double high) {
    gneiss_error error = {0};
    const double a[3] = {from, low, 0.0}, b[3] = {to, high, 1.0};
    if (convert_box(w, a, b, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static inline bool is_active(const gn_world *w, size_t p) {
    return w->dem.particles.vel[4 * p + 3] > 0.0;
}

static inline bool is_tied(const gn_world *w, size_t p) {
    return gn_coupled_has(w->zones.coupled, w->dem.particles.id[p]);
}

/* Particles of zones with slaved spins have no inertia of their own. */
static inline bool spins_freely(const gn_world *w, size_t p) {
    const gn_coupled *q = w->zones.coupled;
    return !q->turn || !is_tied(w, p);
}

/* Mass, its first moment, momenta about the origin, moments of inertia about the axis z. */
typedef struct whole {
    double mass, moment[3], momentum[3], turning[3], inertia, energy;
} whole;

static inline void add_points(const gn_world *w, const gn_particles *q, bool particles, whole *s) {
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p, *v = q->vel + 4 * p;
        if (!(v[3] > 0.0)) continue;
        const double m = particles && is_tied(w, p) ? 0.0 : 1.0 / v[3];
        s->mass += m;
        s->inertia += m * (x[0] * x[0] + x[1] * x[1]);
        s->energy += 0.5 * m * gn_dot3(v, v);
        for (int a = 0; a < 3; a++) {
            int c = (a + 1) % 3, d = (a + 2) % 3;
            s->moment[a] += m * x[a];
            s->momentum[a] += m * v[a];
            s->turning[a] += m * (x[c] * v[d] - x[d] * v[c]);
        }
        if (!q->spin || !spins_freely(w, p)) continue;
        const double *o = q->spin + 4 * p;
        s->inertia += 1.0 / o[3];
        s->energy += 0.5 * gn_dot3(o, o) / o[3];
        for (int a = 0; a < 3; a++) s->turning[a] += o[a] / o[3];
    }
}

static inline whole whole_of(const gn_world *w) {
    whole s = {0};
    add_points(w, &w->dem.particles, true, &s);
    add_points(w, &w->solids.elements[0]->solid.nodes, false, &s);
    return s;
}

/* --- motions --- */

static const double turned[4] = {2e-3, -1e-3, 0.7, 50.0}; /* shift x y, angle, spin */

static inline void move_rigidly(const double *x, const void *of, double u[3], double v[3]) {
    const double *how = of, c = cos(how[2]) - 1.0, s = sin(how[2]);
    u[0] = how[0] + c * x[0] - s * x[1];
    u[1] = how[1] + s * x[0] + c * x[1];
    v[0] = 3.0 - how[3] * (x[1] + u[1]);
    v[1] = -2.0 + how[3] * (x[0] + u[0]);
}

static inline void stir(const double *x, const void *of, double u[3], double v[3]) {
    const double *space = of;
    (void)u;
    v[0] = 2e-3 * sin(900.0 * x[1] + 300.0 * x[0]);
    v[1] = 3e-3 * cos(700.0 * x[0]);
    v[2] = *space * 2e-3 * sin(500.0 * x[0] + 800.0 * x[1]);
}

static inline void turn_and_stretch(const double *x, const void *of, double u[3], double v[3]) {
    move_rigidly(x, turned, u, v);
    stir(x, of, u, v);
    for (int a = 0; a < 3; a++) u[a] += 1e-5 * x[a];
    v[0] += 3.0;
}

static inline void strain(const double *x, const void *of, double u[3], double v[3]) {
    const double *gradient = of;
    (void)v;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) u[a] += gradient[3 * a + b] * x[b];
}

#endif
