/* Strips of elements and particles that are one body. */
#ifndef GN_TESTS_COUPLING_HELPERS_H
#define GN_TESTS_COUPLING_HELPERS_H

#include "world_helpers.h"
#include "zones/zones.h"

/* A strip along x: elements of side h up to the middle of its length and half a zone farther,
 * particles of a square lattice (spacing 1 mm) from half a zone before it to the other end. Columns
 * of centres are on both edges of the zone, rows between rows of nodes or symmetric about them. The
 * lattice has the moduli M = k_n and nu = 0 along its axes. */
typedef struct strip {
    double length, zone, side; /* m */
    int rows;                  /* number of rows of particles; a multiple of the side in mm */
    bool mirrored;             /* particles before elements */
    bool space;                /* three-dimensional, as deep as high */
    const char *more;          /* keys of couple */
    const char *time;          /* keys of time */
    const char *rest;          /* further sections of the scene */
} strip;

static const double modulus = 24e9, density = 7800.0, spacing = 1e-3;

static inline void add_particles(text *t, const strip *s, double lower, int columns) {
    const double solid = s->space ? pi / 6.0 : pi / 4.0;
    add(t, "dimension: %d\n", s->space ? 3 : 2);
    if (s->space)
        add(t,
            "specimen: {group: 1, lattice: {kind: cubic, radius: 0.5 mm, cells: [%d, %d, %d], "
            "origin: [%.17g, 0, 0]}}\n",
            columns, s->rows, s->rows, lower - 0.5e-3);
    else
        add(t,
            "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [%d, %d], origin: "
            "[%.17g, 0]}}\n",
            columns, s->rows, lower - 0.5e-3);
    add(t,
        "materials: [{name: m, density: %.17g, normal_stiffness: %g, kratio: 4, friction: 0.2, "
        "bond_tension_limit: 1e15, bond_shear_limit: 1e15}]\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n",
        density / solid, s->space ? modulus * spacing : modulus);
}

static inline void add_elements(text *t, const strip *s, double lower, double size) {
    const int along = (int)lround(size / s->side),
              across = (int)lround(s->rows * spacing / s->side);
    if (s->space)
        add(t,
            "elements: {box: {origin: [%.17g, 0, 0], size: [%.17g, %.17g, %.17g], cells: [%d, %d, "
            "%d]}, ",
            lower, size, s->rows * spacing, s->rows * spacing, along, across, across);
    else
        add(t,
            "elements: {rectangle: {origin: [%.17g, 0], size: [%.17g, %.17g], cells: [%d, %d], "
            "diagonals: parallel}, ",
            lower, size, s->rows * spacing, along, across);
    add(t, "materials: [{young: %g, poisson: 0, density: %g}]}\n", modulus, density);
}

static inline text *text_of(const strip *s) {
    text *t = calloc(1, sizeof *t);
    const double middle = 0.5 * s->length, half = 0.5 * s->zone;
    const double from = s->mirrored ? middle - half : middle + half;
    const double to = s->mirrored ? middle + half : middle - half;
    const char *flat = s->space ? ", 0, 0" : ", 0";
    add_particles(t, s, s->mirrored ? 0.0 : to,
                  1 + (int)lround((s->mirrored ? to : s->length - to) / spacing));
    add_elements(t, s, s->mirrored ? from : 0.0, s->mirrored ? s->length - from : from);
    add(t, "couple: {zones: [{edges: [{from: [%.17g%s], to: [%.17g%s]}]}]%s%s}\n", from, flat, to,
        flat, s->more ? ", " : "", s->more ? s->more : "");
    add(t, "time: {end: 1%s%s}\n%s", s->time ? ", " : "", s->time ? s->time : "",
        s->rest ? s->rest : "run: {threads: 1}\n");
    return t;
}

static inline gn_world *strip_of(const strip *s) {
    text *t = text_of(s);
    gn_world *w = world_of("%s", t->s);
    free(t);
    return w;
}

/* Returns true for a particle of a zone. */
static inline bool tied_by_zone(const gn_world *w, size_t p) {
    return gn_coupled_has(w->zones.coupled, w->dem.particles.id[p]);
}

typedef void field(const double *x, const void *of, double u[3], double v[3]);

static inline void set_field(gn_particles *q, field *at, const void *of) {
    for (size_t p = 0; p < q->soa.count; p++) {
        double u[3] = {0}, v[3] = {0};
        at(q->start + 4 * p, of, u, v);
        for (size_t k = 0; k < 3; k++) {
            q->pos[4 * p + k] = q->start[4 * p + k] + u[k];
            q->vel[4 * p + k] = v[k];
        }
    }
}

/* Sets all points of a world to a field. */
static inline void set_fields(gn_world *w, field *at, const void *of) {
    set_field(&w->dem.particles, at, of);
    set_field(&w->solids.elements[0]->solid.nodes, at, of);
    gn_fem_positions_changed(&w->solids.elements[0]->solid);
}

static inline void stir(const double *x, const void *of, double u[3], double v[3]) {
    const double *space = of;
    (void)u;
    v[0] = 2e-3 * sin(900.0 * x[1] + 300.0 * x[0]);
    v[1] = 3e-3 * cos(700.0 * x[0]);
    v[2] = *space * 2e-3 * sin(500.0 * x[0] + 800.0 * x[1]);
}

/* Waves in all directions, with all wavelengths of the mesh and the lattice. */
static inline gn_world *stirred(const strip *s) {
    const double space = s->space ? 1.0 : 0.0;
    gn_world *w = strip_of(s);
    set_fields(w, stir, &space);
    run_steps(w, 1); /* particles of the zone have the velocity of the nodes */
    return w;
}

static inline strip small_strip(bool space) {
    return (strip){.length = space ? 16e-3 : 20e-3,
                   .zone = space ? 4e-3 : 6e-3,
                   .side = space ? 1e-3 : 2e-3,
                   .rows = space ? 3 : 6,
                   .space = space};
}

#endif
