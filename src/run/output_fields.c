/* Needed because the tables name all effects, also those that this build leaves out. */
#define GN_EVERY_EFFECT
#include "run/output_fields.h"

#include "base/asked.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/loads.h"
#include "conversion/conversion.h"
#include "measure/measure.h"
#include "particles/dormant.h"
#include "particles/fragments.h"
#include "particles/particles.h"
#include "soa/bond_causes.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "world/space.h"
#include "world/world.h"
#include "zones/zones.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* Reads a scalar of item k of the view v; the world is w. */
#define READ(name, expression)                                                                     \
    static void read_##name(const void *view, size_t k, double *value) {                           \
        const gn_output_view *v = view;                                                            \
        const gn_world *w = v->world;                                                              \
        (void)w;                                                                                   \
        *value = (expression);                                                                     \
    }

/* --- particles --- */

READ(id, w->dem.particles.id[k])
READ(radius, w->dem.particles.pos[4 * k + 3])
READ(damage, v->damage[k])
READ(coordination, v->coordination[k])
READ(bonds_at_start, w->dem.particles.bonds0 ? w->dem.particles.bonds0[k] : 0)
static double mass_of(const gn_dem *dem, size_t k) {
    if (!gn_particle_is_active(&dem->particles, k)) return 0.0;
    return gn_clump_of(dem, k) ? gn_clump_mass_of(dem, k) : 1.0 / dem->particles.vel[4 * k + 3];
}

READ(mass, mass_of(&w->dem, k))
READ(clump, w->dem.particles.clump[k])
READ(removed, !gn_particle_is_active(&w->dem.particles, k) && !gn_is_dormant(&w->dem, k))
READ(dormant, gn_is_dormant(&w->dem, k))
READ(membrane_area, fmax(w->dem.particles.skin[4 * k + 3], 0.0))

static const gn_world *world_of(const void *view) {
    return ((const gn_output_view *)view)->world;
}

/* The displacement of a dormant particle is that of its element at its position. */
static void read_displacement(const void *view, size_t k, double *value) {
    const gn_output_view *v = view;
    gn_particle_travel(&v->world->dem, &v->world->solids, v->places, k, value);
}
void gn_output_place(const gn_output_view *view, size_t p, double place[3]) {
    const gn_particles *q = &view->world->dem.particles;
    double now[3], travel[3];
    memcpy(now, q->pos + 4 * p, sizeof now);
    if (gn_is_dormant(&view->world->dem, p)) {
        gn_particle_travel(&view->world->dem, &view->world->solids, view->places, p, travel);
        for (size_t a = 0; a < 3; a++) now[a] = q->start[4 * p + a] + travel[a];
    }
    gn_user_point(&view->world->ctx, now, place);
}
static void read_position(const void *view, size_t k, double *value) {
    gn_output_place(view, k, value);
}
static void read_velocity(const void *view, size_t k, double *value) {
    const gn_output_view *v = view;
    gn_particle_velocity(&v->world->dem, &v->world->solids, v->places, k, value);
}
static void read_spin(const void *view, size_t k, double *value) {
    const double *spin = world_of(view)->dem.particles.spin;
    for (size_t a = 0; a < 3; a++) value[a] = spin ? spin[4 * k + a] : 0.0;
}
/* Writes the rotation as a quaternion; of the two opposite quaternions of a rotation, that with the
 * smaller angle. */
static void read_orientation(const void *view, size_t k, double *value) {
    const double *turn = world_of(view)->dem.particles.orientation + 4 * k;
    for (int a = 0; a < 4; a++) value[a] = turn[0] < 0.0 ? -turn[a] : turn[a];
}
static void read_applied(const void *view, size_t k, double *value) {
    memcpy(value, world_of(view)->dem.particles.applied + 4 * k, 3 * sizeof *value);
}
READ(material, w->dem.particles.material[k])
READ(group, w->dem.particles.group[k])
READ(fragment, v->fragments.of[k])
READ(fragment_size, v->fragments.of[k] < 0 ? 0 : v->fragments.row[v->fragments.of[k]].particles)
READ(skin, w->dem.particles.skin[4 * k + 3] > 0.0)
static void read_total_force(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_output_view *)view)->total + 6 * k, 3 * sizeof *value);
}
static void read_total_moment(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_output_view *)view)->total + 6 * k + 3, 3 * sizeof *value);
}
static void read_damping_force(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_output_view *)view)->damping + 6 * k, 3 * sizeof *value);
}
static void read_damping_moment(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_output_view *)view)->damping + 6 * k + 3, 3 * sizeof *value);
}
static void read_stress(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_output_view *)view)->stress + 6 * k, 6 * sizeof *value);
}

enum { BOTH = GN_IN_RESULTS | GN_IN_SNAPSHOT };

static const gn_output_field of_particles[] = {
    {"id", "1",
     "index in the specimen file (by its ids, if it has them), base 0; particles of sources follow "
     "in the order of their "
     "insertion",
     BOTH, GN_I32, false, 1, read_id, 0},
    {"position", "m", "centre", GN_IN_RESULTS, GN_F64, false, 3, read_position, 0},
    {"radius", "m", "radius", BOTH, GN_F64, false, 1, read_radius, 0},
    {"displacement", "m", "from the start", BOTH, GN_F64, false, 3, read_displacement, 0},
    {"velocity", "m/s", "velocity, half a step before the instant", BOTH, GN_F64, false, 3,
     read_velocity, 0},
    {"spin", "rad/s", "angular velocity, half a step before the instant",
     GN_IN_RESULTS | GN_ON_REQUEST(spin), GN_F64, false, 3, read_spin, 0},
    {"mass", "kg",
     "inertial mass, including that added by mass scaling; 0: removed; of a member of a clump its "
     "part of the clump's mass, by volume of the spheres",
     GN_IN_RESULTS, GN_F64, false, 1, read_mass, 0},
    {"damage", "1", "broken bonds over bonds at the start", BOTH, GN_F64, false, 1, read_damage, 0},
    {"stress", "Pa", "xx yy zz xy yz xz, tension positive", BOTH, GN_F64, false, 6, read_stress, 0},
    {"coordination", "1", "contacts that carry a force, and intact bonds", BOTH, GN_F64, false, 1,
     read_coordination, 0},
    {"bonds_at_start", "1", "bonds at the start", GN_IN_RESULTS, GN_I32, false, 1,
     read_bonds_at_start, 0},
    {"removed", "1", "1: removed by the domain or a sink; its position is that of its removal",
     BOTH, GN_U8, false, 1, read_removed, 0},
    {"asleep", "1", "1: dormant, moving with its element; in bodies that convert", BOTH, GN_U8,
     false, 1, read_dormant, GN_FX_OVERLAP},
    {"applied_force", "N",
     "force of sets and of the membrane on it in the last step; with `sets.force` or `membrane`",
     BOTH, GN_F64, false, 3, read_applied, GN_FX_APPLIED},
    {"membrane_area", "m2",
     "area of it that the membrane covers; 0: it is not in the skin, or has detached; with "
     "`membrane`",
     BOTH, GN_F64, false, 1, read_membrane_area, GN_FX_MEMBRANE},
    {"clump", "1", "its clump, base 0; -1: none", BOTH, GN_I32, false, 1, read_clump, GN_FX_CLUMPS},
    {"orientation", "1",
     "unit quaternion w x y z of the rotation from the start, w >= 0: the smaller angle; with "
     "`output.orientation: on`",
     BOTH, GN_F64, false, 4, read_orientation, GN_FX_ORIENTATION},
    {"group", "1", "cohesive group, 0: none; without a request if particles have several",
     GN_ON_REQUEST(group), GN_I32, false, 1, read_group, 0},
    {"material", "1",
     "index in the scene's materials, base 0; without a request if there are several",
     GN_ON_REQUEST(material), GN_I32, false, 1, read_material, 0},
    {"skin", "1", "1: the membrane presses on it", GN_ON_REQUEST(skin), GN_U8, false, 1, read_skin,
     GN_FX_MEMBRANE},
    {"fragment", "1", "row of its fragment, the largest first; -1: removed or dormant",
     GN_ON_REQUEST(fragment), GN_I32, false, 1, read_fragment, GN_FX_BONDS},
    {"fragment_size", "1", "particles connected with it by intact bonds, including itself",
     GN_ON_REQUEST(fragment_size), GN_I32, false, 1, read_fragment_size, GN_FX_BONDS},
    {"total_force", "N",
     "total force of contacts, walls, surfaces, weight, applied loads and background damping; that "
     "of walls and surfaces in the last step; without forces of coupling zones and of the "
     "prescribed motion of sets",
     GN_ON_REQUEST(total_force), GN_F64, false, 3, read_total_force, 0},
    {"total_moment", "N m",
     "total moment of the same forces about the centre; applied loads have none",
     GN_ON_REQUEST(total_moment), GN_F64, false, 3, read_total_moment, GN_FX_ROTATION},
    {"damping_force", "N", "force of background damping; 0 along prescribed directions",
     GN_ON_REQUEST(damping_force), GN_F64, false, 3, read_damping_force, 0},
    {"damping_moment", "N m", "moment of background damping; 0 for prescribed spins",
     GN_ON_REQUEST(damping_moment), GN_F64, false, 3, read_damping_moment, GN_FX_ROTATION},
};

/* --- bonds --- */

void gn_output_bond_ends(const gn_output_view *view, size_t bond, int32_t ends[2]) {
    const gn_contacts *b = &view->world->dem.bonds.contacts;
    int32_t i = view->row[b->i[bond]], j = view->row[b->j[bond]];
    ends[0] = i < j ? i : j;
    ends[1] = i < j ? j : i;
}

/* Returns the force on the particle that comes first in files. State and strengths of a bond are
 * the world's; the copy only has the forces. */
static void force_on_first(const gn_output_view *view, size_t c, double force[3]) {
    const gn_contacts *seen = &view->seen->list[GN_LIST_BONDS];
    const double *row = gn_contacts_row(seen) + (size_t)gn_contacts_row_width(seen) * c;
    force[0] = row[0];
    force[1] = row[1];
    force[2] = view->world->ctx.effects & GN_FX_SPACE ? row[2] : 0.0;
}

static double normal_of(const gn_output_view *view, size_t c, const double force[3]) {
    const gn_world *w = view->world;
    const double *x = w->dem.particles.pos + 4 * (int64_t)w->dem.bonds.contacts.i[c],
                 *y = w->dem.particles.pos + 4 * (int64_t)w->dem.bonds.contacts.j[c];
    double d[3], d2 = gn_branch(&w->ctx, x, y, d), along = 0.0;
    for (int a = 0; a < 3; a++) along += force[a] * d[a];
    return d2 > 0.0 ? along / sqrt(d2) : 0.0;
}

/* Computes normal and shear forces, which three fields use. */
static void split_forces(gn_output_view *view) {
    const size_t count = view->world->dem.bonds.contacts.soa.count;
#pragma omp parallel for schedule(static) num_threads(view->world->ctx.threads)
    for (size_t c = 0; c < count; c++) {
        double force[3], square = 0.0;
        force_on_first(view, c, force);
        double normal = view->normal[c] = normal_of(view, c, force);
        for (int a = 0; a < 3; a++) square += force[a] * force[a];
        view->shear[c] = sqrt(fmax(0.0, square - normal * normal));
    }
}

/* Returns the moments of a bond about its normal at the present positions. */
static gn_law_moments moments_of(const gn_output_view *view, size_t c) {
    const gn_world *w = view->world;
    const gn_contacts *b = &w->dem.bonds.contacts;
    const gn_law *law = gn_law_of(b->soa.effects);
    double n[3], n2 = gn_branch(&w->ctx, w->dem.particles.pos + 4 * (int64_t)b->i[c],
                                w->dem.particles.pos + 4 * (int64_t)b->j[c], n);
    if (!law->moments || !(n2 > 0.0)) return (gn_law_moments){0};
    for (int a = 0; a < 3; a++) n[a] /= sqrt(n2);
    return law->moments(b, c, n);
}

static double criterion_of(const gn_output_view *view, size_t c) {
    const gn_contacts *b = &view->world->dem.bonds.contacts;
    if (b->cause[c]) return gn_broken(b->cause[c]) ? 1.0 : 0.0;
    const gn_law *law = gn_law_of(b->soa.effects);
    gn_law_moments m = moments_of(view, c);
    gn_contacts now = *b; /* the pressure around bonds must belong to these forces */
    now.confined = view->seen->list[GN_LIST_BONDS].confined;
    now.confined_f = NULL;
    double share = law->criterion(&now, c, view->normal[c], m.normal, view->shear[c] + m.shear);
    /* Forces are those of the present positions, to which a softening bond has not responded yet;
     * its load ratio may be above 1, and is infinite without remaining strength. Only broken bonds
     * have the value 1. */
    return fmin(fmax(0.0, share), 1.0 - 0x1p-53);
}

enum { BOND_SOFTENING = 4, BOND_YIELDED = 5 }; /* states of intact bonds, in addition to gn_cause */

int32_t gn_output_bond_state(const gn_contacts *bonds, size_t bond) {
    if (bonds->cause[bond] != GN_INTACT || !(bonds->soa.effects & GN_FX_SOFTENING))
        return bonds->cause[bond];
    gn_bond_condition is = gn_softening_condition(bonds, bond);
    if (is.tension > 0.0 || is.shear > 0.0) return BOND_SOFTENING;
    return is.permanent != 0.0 ? BOND_YIELDED : GN_INTACT;
}

static double end_of(const gn_output_view *view, size_t c, int end) {
    int32_t ends[2];
    gn_output_bond_ends(view, c, ends);
    return ends[end];
}

READ(first, end_of(v, k, 0))
READ(second, end_of(v, k, 1))
READ(state, gn_output_bond_state(&w->dem.bonds.contacts, k))
READ(tension_damage, gn_softening_condition(&w->dem.bonds.contacts, k).tension)
READ(shear_damage, gn_softening_condition(&w->dem.bonds.contacts, k).shear)
READ(permanent, gn_softening_condition(&w->dem.bonds.contacts, k).permanent)
static bool was_bonded(const gn_contacts *bonds, size_t c) {
    return bonds->cause[c] != GN_INTACT && bonds->cause[c] != GN_BOND_NEVER;
}

READ(broken_time,
     was_bonded(&w->dem.bonds.contacts, k) ? w->dem.bonds.contacts.broken_time[k] : NAN)
READ(normal_force, v->normal[k])
READ(shear_force, v->shear[k])
READ(criterion, criterion_of(v, k))

READ(rest_length, w->dem.bonds.contacts.length0[k])
READ(area, w->dem.bonds.contacts.area[k])
READ(contact_stress, v->normal[k] / w->dem.bonds.contacts.area[k])
READ(shear_stress, v->shear[k] / w->dem.bonds.contacts.area[k])

/* Returns 1 if the first end has the smaller id and so comes first in files, else -1. */
static double turn_of(const gn_world *world, size_t c) {
    return world->dem.particles.id[world->dem.bonds.contacts.i[c]] <
                   world->dem.particles.id[world->dem.bonds.contacts.j[c]]
               ? 1.0
               : -1.0;
}

static void read_force(const void *view, size_t c, double *value) {
    force_on_first(view, c, value);
    for (int a = 0; a < 3; a++) value[a] *= turn_of(world_of(view), c);
}
static void read_moment(const void *view, size_t c, double *value) {
    gn_law_moments m = moments_of(view, c);
    for (int a = 0; a < 3; a++) value[a] = m.couple[a] * turn_of(world_of(view), c);
}

static const gn_output_field of_bonds[] = {
    {"i", "1", "first particle, base 0: row of particles", GN_IN_RESULTS, GN_I32, false, 1,
     read_first, 0},
    {"j", "1", "second particle", GN_IN_RESULTS, GN_I32, false, 1, read_second, 0},
    {"state", "1",
     "0 intact, 1 broken in tension, 2 broken in shear, 3 removed with a particle; intact: 4 "
     "softening, 5 yielded; 6 dissolved by a stage; 7 never bonded, and free of stress at the "
     "overlap at the start (bonds.passive_gaps)",
     BOTH, GN_I32, false, 1, read_state, 0},
    {"rest_length", "m", "distance of the centres without a normal force", GN_IN_RESULTS, GN_F64,
     false, 1, read_rest_length, 0},
    {"tension_damage", "1", "damage d of softening bonds; 1: broken in tension", BOTH, GN_F64,
     false, 1, read_tension_damage, GN_FX_SOFTENING},
    {"shear_damage", "1", "kappa of softening bonds; 1: broken in shear", BOTH, GN_F64, false, 1,
     read_shear_damage, GN_FX_SOFTENING},
    {"permanent_stretch", "m", "stretch of yielding bonds without a normal force", BOTH, GN_F64,
     false, 1, read_permanent, GN_FX_YIELD},
    {"broken_time", "s", "time of its break or removal; NaN: intact", BOTH, GN_F64, true, 1,
     read_broken_time, 0},
    {"force", "N", "force on i", GN_IN_RESULTS, GN_F64, false, 3, read_force, 0},
    {"force", "N", "normal force, tension positive", GN_IN_SNAPSHOT, GN_F64, false, 1,
     read_normal_force, 0},
    {"shear_force", "N", "magnitude of the tangential force", GN_IN_SNAPSHOT, GN_F64, false, 1,
     read_shear_force, 0},
    {"moment", "N m",
     "moment on i in addition to that of the force: bending and twist of bonds that carry them "
     "(`bonds.radius_multiplier`)",
     BOTH, GN_F64, false, 3, read_moment, GN_FX_BOND_MOMENTS},
    {"criterion", "1",
     "largest ratio of force to strength (softening in tension: of stretch to the one at its end); "
     "1: broken; 0: removed",
     BOTH, GN_F64, false, 1, read_criterion, 0},
    {"area", "m2", "section (2D: width times 1 m); with `law.stiffness: dempack` or `polyhedron`",
     GN_IN_RESULTS | GN_ON_REQUEST(area), GN_F64, false, 1, read_area, GN_FX_AREA},
    {"contact_stress", "Pa",
     "normal force over section, tension positive; with `law.stiffness: dempack` or `polyhedron`",
     BOTH, GN_F64, false, 1, read_contact_stress, GN_FX_AREA},
    {"shear_stress", "Pa",
     "tangential force over section; with `law.stiffness: dempack` or `polyhedron`",
     GN_ON_REQUEST(shear_stress), GN_F64, false, 1, read_shear_stress, GN_FX_AREA},
};

_Static_assert(COUNT(of_particles) <= GN_OUTPUT_FIELDS_MOST &&
                   COUNT(of_bonds) <= GN_OUTPUT_FIELDS_MOST,
               "room for the arrays of a snapshot");
const gn_output_table gn_particle_outputs = {"particles", of_particles, COUNT(of_particles)},
                      gn_bond_outputs = {"bonds", of_bonds, COUNT(of_bonds)};

/* Returns the fields that the scene requests, and those that tell its particles apart. */
static unsigned asked_of_particles(const gn_world *world) {
    const gn_particles *p = &world->dem.particles;
    unsigned asked = world->ctx.scene.asked;
    if (world->ctx.scene.material_count > 1) asked |= GN_ASKED(material);
    for (size_t k = 1; k < p->soa.count && !(asked & GN_ASKED(group)); k++)
        if (p->group[k] != p->group[0]) asked |= GN_ASKED(group);
    return asked;
}

gn_output_source gn_output_particles(const gn_output_view *view) {
    const gn_world *w = view->world;
    return (gn_output_source){&gn_particle_outputs,       view,      w->ctx.effects,
                              w->dem.particles.soa.count, view->row, NULL,
                              asked_of_particles(w)};
}

gn_output_source gn_output_bonds(const gn_output_view *view) {
    const gn_world *w = view->world;
    return (gn_output_source){
        &gn_bond_outputs,  view, w->ctx.effects, w->dem.bonds.contacts.soa.count, NULL, NULL,
        w->ctx.scene.asked};
}

/* --- quantities of several particles --- */

/* Counts the intact contacts of each particle. The world determines whether a bond is intact; the
 * copy may have broken it at the present positions. */
static void count_contacts(const gn_contacts *list, const gn_contacts *seen, double *coordination) {
    for (size_t c = 0; c < list->soa.count; c++) {
        if (!gn_contact_bonded(list, c) && !gn_contact_carries(seen, c)) continue;
        coordination[list->i[c]] += 1.0;
        coordination[list->j[c]] += 1.0;
    }
}

/* Computes the damage of active particles. Bonds of dormant particles are stored separately and are
 * not broken, so that they do not count as damage. */
static void damage_of_active(const gn_world *world, double *damage) {
    const gn_contacts *b = &world->dem.bonds.contacts;
    const int32_t *bonds0 = world->dem.particles.bonds0;
    memset(damage, 0, world->dem.particles.soa.count * sizeof *damage);
    for (size_t c = 0; bonds0 && c < b->soa.count; c++) {
        if (!gn_broken(b->cause[c])) continue;
        damage[b->i[c]] += 1.0 / fmax(1.0, bonds0[b->i[c]]);
        damage[b->j[c]] += 1.0 / fmax(1.0, bonds0[b->j[c]]);
    }
}

static gneiss_status read_fragments(gn_output_view *view, gneiss_error *error) {
    const unsigned wanted = GN_ASKED(fragment) | GN_ASKED(fragment_size);
    if (!(view->world->ctx.scene.asked & wanted)) return GNEISS_OK;
    return gn_fragments_list(&view->world->ctx, &view->world->dem, &view->fragments, error);
}

/* Computes loads only if they are requested. */
static gneiss_status read_loads(gn_output_view *view, gneiss_error *error) {
    const size_t n = view->world->dem.particles.soa.count;
    if (!(view->world->ctx.scene.asked & GN_ASKED_LOADS)) return GNEISS_OK;
    view->total = calloc(n + 1, 6 * sizeof(double));
    view->damping = calloc(n + 1, 6 * sizeof(double));
    if (!view->total || !view->damping)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the forces on %zu particles", n);
    return gn_boundary_write_loads(&view->world->ctx, &view->world->dem, &view->world->boundary,
                                   &view->world->box, view->total, view->damping, error);
}

gneiss_status gn_output_view_make(const gn_world *world, const gn_observed *seen,
                                  gn_output_view *view, gneiss_error *error) {
    size_t n = world->dem.particles.soa.count, bonds = seen->list[GN_LIST_BONDS].soa.count;
    *view = (gn_output_view){.world = world,
                             .seen = seen,
                             .damage = calloc(n + 1, sizeof(double)),
                             .stress = calloc(n + 1, 6 * sizeof(double)),
                             .coordination = calloc(n + 1, sizeof(double)),
                             .normal = calloc(bonds + 1, sizeof(double)),
                             .shear = calloc(bonds + 1, sizeof(double)),
                             .row = calloc(n + 1, sizeof(int32_t)),
                             .places = gn_element_places(&world->ctx, &world->solids)};
    if ((gn_converts(&world->ctx) && !view->places) || !view->row || !view->damage ||
        !view->stress || !view->coordination || !view->normal || !view->shear) {
        gn_output_view_free(view);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu particles", n);
    }
    int32_t row = 0;
    for (int64_t id = 0; id < world->dem.ids; id++)
        if (world->dem.index_of_id[id] >= 0) view->row[world->dem.index_of_id[id]] = row++;
    gn_assembly assembly = gn_assembly_of(&world->ctx, &world->dem, &world->boundary);
    for (int l = 0; l < GN_LIST_COUNT; l++) assembly.list[l] = &seen->list[l];
    const double solid =
        (1.0 - gn_dem_porosity(&world->ctx, &world->dem)) * world->ctx.volume /
        gn_space_volume(&world->ctx, &world->dem, &world->membrane, &world->boundary,
                        &world->solids, &world->box, &world->approach);
    gn_stress_particles(&assembly, 1.0 - solid, view->stress);
    gneiss_status status = gn_coupled_add_stress(&world->ctx, &world->dem, &world->solids,
                                                 &world->zones, view->stress, error);
    if (status == GNEISS_OK) status = read_loads(view, error);
    if (status == GNEISS_OK) status = read_fragments(view, error);
    if (status != GNEISS_OK) {
        gn_output_view_free(view);
        return status;
    }
    if (world->ctx.effects & GN_FX_BONDS)
        gn_damage_particles(&world->dem.particles, &world->dem.bonds.contacts, view->damage);
    if (gn_converts(&world->ctx)) damage_of_active(world, view->damage);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        count_contacts(&world->dem.list[l].contacts, &seen->list[l], view->coordination);
    split_forces(view);
    return GNEISS_OK;
}

void gn_output_view_free(gn_output_view *view) {
    free(view->damage);
    free(view->stress);
    free(view->coordination);
    free(view->normal);
    free(view->shear);
    free(view->total);
    free(view->damping);
    gn_fragments_free(&view->fragments);
    free(view->row);
    gn_free(view->places);
    *view = (gn_output_view){0};
}
