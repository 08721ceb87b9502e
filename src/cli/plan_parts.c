#include "cli/plan_parts.h"

#include "base/new.h"
#include "base/point.h"
#include "base/sort.h"
#include "cli/plan.h"
#include "frame/parts.h"
#include "particles/bond_sections.h"
#include "particles/joints.h"
#include "solids/element_walls.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/world.h"
#include "zones/zones.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void print_kernels(const gn_world *world, const gn_fem_solid *solid) {
    char name[200];
    bool refused = world->ctx.effects & GN_FX_MIXED && !solid->single;
    printf("  element %s, %s form, %s\n",
           solid->dimension == 3 ? "tetrahedron" : "triangle, plane strain",
           solid->form == GN_FEM_PRESSURE ? "mixed" : "displacement",
           solid->single ? "forces in single precision"
           : refused     ? "double precision (run.precision: mixed is for the displacement form)"
                         : "double precision");
    gn_motion_variant_name(gn_motion_variant(solid->effects), name, sizeof name);
    printf("  nodes   %s\n", name);
}

void gn_print_element_kernels(const gn_world *world) {
    for (size_t k = 0; k < world->solids.count; k++)
        print_kernels(world, &world->solids.elements[k]->solid);
}

static void print_limits(const gn_world *world, const gn_element_model *model) {
    char text[160];
    const gn_fem_limit *limit = &model->limit;
    printf("  elements%s\n",
           gn_timestep_elements_lead(&world->ctx, &world->solids, &world->zones) == model
               ? ", which set the step"
               : "");
    if (limit->iterations == 0)
        printf(
            "  sharp limit      not computed: the rigorous bound suffices and replaces it below\n");
    else
        printf("  sharp limit      %.6g s  (Lanczos, %d vectors)\n", limit->sharp,
               limit->iterations);
    printf("  rigorous bound   %.6g s  = %.3f of the sharp limit (element %d)\n", limit->bound,
           limit->bound / limit->sharp, limit->bound_element);
    printf("  set by           %s\n", gn_elements_culprit(&world->ctx, model, text, sizeof text));
}

void gn_print_element_limits(const gn_world *world) {
    for (size_t k = 0; k < world->solids.count; k++) print_limits(world, world->solids.elements[k]);
}

/* --- check --- */

static void print_groups(const gn_mesh *mesh) {
    for (size_t k = 0; k < mesh->group_count; k++) {
        const gn_mesh_group *g = &mesh->groups[k];
        const gn_mesh_elements *lists[] = {&mesh->points, &mesh->lines, &mesh->triangles,
                                           &mesh->tetrahedra};
        static const char *const kinds[] = {"points", "lines", "triangles", "tetrahedra"};
        const gn_mesh_elements *list = lists[g->dimension];
        size_t count = 0;
        for (size_t e = 0; e < list->count; e++) count += list->group[e] == g->tag;
        for (size_t e = 0; e < list->also_count; e++) count += list->also[e].group == g->tag;
        printf("  group %-14s %zu %s (number %d)\n", g->name[0] ? g->name : "-", count,
               kinds[g->dimension], g->tag);
    }
}

static void print_parts(const gn_world *world, const gn_mesh_joints *joints, const char *indent) {
    char place[GN_POINT_SIZE];
    if (joints->parts < 2) return;
    printf("%snote: %zu parts that share no node; the smallest has %zu of %zu elements, one at %s "
           "m\n",
           indent, joints->parts, joints->least, joints->elements,
           gn_point_text(world->ctx.scene.origin, joints->least_at, place));
}

static void print_notes(const gn_world *world, const gn_element_model *model, const char *indent) {
    const gn_fem_solid *solid = &model->solid;
    print_parts(world, &model->joints, indent);
    if (solid->unused_nodes)
        printf("%snote: left out %zu node%s of the mesh that belong%s to no element\n", indent,
               solid->unused_nodes, solid->unused_nodes == 1 ? "" : "s",
               solid->unused_nodes == 1 ? "s" : "");
    if (solid->turned_elements)
        printf("%snote: reoriented %zu element%s with nodes in the opposite order (inside out)\n",
               indent, solid->turned_elements, solid->turned_elements == 1 ? "" : "s");
}

void gn_print_element_notes(const gn_world *world, const char *indent) {
    for (size_t k = 0; k < world->solids.count; k++)
        print_notes(world, world->solids.elements[k], indent);
}

/* Warns of slivers: a few of them make the whole run slow. */
static void print_slivers(const gn_world *world, const gn_element_model *model, int *warnings) {
    const gn_fem_solid *solid = &model->solid;
    size_t count = solid->elements.soa.count;
    char text[160];
    double *scale = calloc(count + 1, sizeof *scale);
    if (!scale) return; /* this is a note and no check */
    gn_fem_step_scales(solid, scale);
    gn_sort_numbers(scale, count);
    double ratio = scale[0] / scale[count / 2];
    free(scale);
    if (ratio > 0.3) return;
    printf("  warning: the step is limited by a sliver, %.2g of the step that half of the elements "
           "allow: %s\n",
           ratio, gn_elements_culprit(&world->ctx, model, text, sizeof text));
    (*warnings)++;
}

static void print_check(const gn_world *world, const gn_element_model *model, int *warnings) {
    const gn_fem_solid *solid = &model->solid;
    const gn_element_def *elements = model->def;
    double lower[3], upper[3];
    char changes[GN_MESH_CHANGES_SIZE];
    printf("elements\n  mesh             %s: %zu nodes, %zu %s\n", solid->name,
           solid->nodes.soa.count, solid->elements.soa.count,
           solid->dimension == 3 ? "tetrahedra" : "triangles");
    if (gn_mesh_changed(&solid->mesh, changes, sizeof changes))
        printf("  of the file      %s\n", changes);
    for (size_t a = 0; a < (size_t)solid->dimension; a++) {
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
        for (size_t n = 0; n < solid->nodes.soa.count; n++) {
            lower[a] = fmin(lower[a], solid->nodes.start[4 * n + a]);
            upper[a] = fmax(upper[a], solid->nodes.start[4 * n + a]);
        }
        gn_print_range(world, (int)a, lower[a], upper[a], "");
    }
    printf("  volume           %.6g m3, mass %.6g kg%s\n", solid->volume, solid->mass,
           solid->dimension == 2 ? " (1 m thick)" : "");
    print_groups(&solid->mesh);
    for (size_t k = 0; k < elements->motion_count; k++)
        printf("  motion %-13s %zu nodes%s\n", elements->motions[k].name,
               model->motion_set[k].count, model->motion[k] < 0 ? ", only observed" : "");
    for (size_t k = 0; k < elements->load_count; k++)
        printf("  load %-15s %zu nodes\n",
               elements->loads[k].name[0] ? elements->loads[k].name : "-", model->load[k].count);
    print_notes(world, model, "  ");
    print_slivers(world, model, warnings);
}

void gn_print_element_check(const gn_world *world, int *warnings) {
    char doubts[GNEISS_MESSAGE_SIZE];
    for (size_t k = 0; k < world->solids.count; k++)
        print_check(world, world->solids.elements[k], warnings);
    if (!*gn_elements_doubts(&world->ctx, &world->dem, &world->boundary, &world->solids, doubts,
                             sizeof doubts))
        return;
    printf("  warning: %s\n", doubts);
    (*warnings)++;
}

/* ---- output of `gneiss check` on coupling zones ---- */

static void warn(int *warnings, const char *text) {
    printf("  warning: %s\n", text);
    (*warnings)++;
}

double gn_zone_advised_width(double element, double diameter) {
    return fmax(3.0 * element, 6.0 * diameter);
}

bool gn_zone_is_thin(double width, double advised) {
    return width < advised * (1.0 - 1e-6);
}

static void print_tension(const gn_zone_material *material) {
    if (!(material->tension[3] > 0.0)) return;
    printf("  tension          %.4g", material->tension[0]);
    for (int a = 1; a < 3 && material->tension[a] > 0.0; a++)
        printf(", %.4g", material->tension[a]);
    printf(" Pa of these particles along the axes with free sides, %.4g Pa of the elements\n",
           material->tension[3]);
}

void gn_print_zone_material(const gn_zone_material *material, bool several, int *warnings) {
    if (several)
        printf("  material         %d of the elements, with %zu particles\n",
               (int)material->material, material->particles);
    if (!(material->modulus[0] > 0.0))
        return; /* without bonds there is no initial modulus of particles */
    printf("  modulus          %.4g Pa of particles that follow elements, %.4g Pa of these "
           "(confined)\n",
           material->modulus[0], material->modulus[1]);
    print_tension(material);
    printf("  density          %.4g kg/m3, %.4g kg/m3 of the elements\n", material->density[0],
           material->density[1]);
    printf("  returned         %.2g %% of the energy of a wave, by this difference alone\n",
           100.0 * material->returned);
    if (gn_zone_differs(material))
        warn(warnings, "particles and elements differ: calibrate the particles to the elements' E "
                       "and nu, and their density");
}

static void warn_of_edges(const gn_zone_figures *figures, int *warnings) {
    char text[192];
    if (figures->least > 1e-6) {
        snprintf(text, sizeof text,
                 "the elements end where they still have a weight of %.2g: `from` "
                 "is beyond their end",
                 figures->least);
        warn(warnings, text);
    }
    /* Half a spacing of neighbours around the middle plane leaves unbalanced weights of that
     * fraction of the width; a plane through the middle of elements adds up to a quarter of their
     * size. */
    if (figures->edge * figures->width > figures->diameter + 0.25 * figures->element &&
        !figures->shared) {
        snprintf(text, sizeof text,
                 "the particles end where they still have a weight of %.2g: `to` is beyond their "
                 "outermost centres",
                 figures->edge);
        warn(warnings, text);
    }
    if (figures->beyond)
        warn(warnings, "particles reach beyond the plane through `to`, where elements carry all");
}

static void print_zone(const gn_world *world, size_t k, int *warnings) {
    gn_zone_figures f;
    gn_zone_measure(&world->ctx, &world->dem, &world->solids, &world->zones, k, &f);
    double elements = f.width / f.element, diameters = f.width / f.diameter;
    printf("zone %zu\n  width            %.6g m = %.3g elements = %.3g particles\n", k, f.width,
           elements, diameters);
    printf("  particles        %zu in elements, %zu of them where they have no weight\n",
           f.particles, f.beyond);
    if (f.shared)
        printf(
            "  overlaps         zone %zu: %zu particles are in both, where the smaller weight of "
            "the elements holds\n",
            f.other, f.shared);
    printf("  masses           %.4g times the share that the elements leave\n", f.mass);
    if (gn_zone_is_off(&f))
        warn(
            warnings,
            "the mass of the particles is not the share that the elements leave to them: they have "
            "to fill the zone from side to side, with the elements' density (density_basis bulk)");
    for (size_t m = 0; m < f.materials; m++)
        gn_print_zone_material(&f.material[m], f.materials > 1, warnings);
    if (gn_zone_is_thin(f.width, gn_zone_advised_width(f.element, f.diameter)))
        warn(warnings, "the zone is thin: three elements and six particles across are advised");
    warn_of_edges(&f, warnings);
}

void gn_print_whole_limit(const gn_world *world) {
    const gn_whole_limit *whole = gn_coupled_whole(&world->ctx, &world->zones);
    char text[96];
    if (!whole) return;
    printf("  both together\n  sharp limit      %.6g s  (Lanczos, %d vectors)\n", whole->sharp,
           whole->iterations);
    printf("  rigorous bound   %.6g s  = %.3f of the sharp limit\n",
           gn_timestep_bound(&world->ctx, &world->dem, &world->solids, &world->zones),
           gn_timestep_bound(&world->ctx, &world->dem, &world->solids, &world->zones) /
               whole->sharp);
    printf("  set by           %s; its mode lies to %.0f %% in particles, to %.0f %% in elements, "
           "to %.0f %% in zones\n",
           gn_whole_culprit(whole, text, sizeof text), 100.0 * whole->share[GN_SIDE_PARTICLES],
           100.0 * whole->share[GN_SIDE_ELEMENTS], 100.0 * whole->share[GN_SIDE_ZONE]);
}

static void print_step(const gn_world *world) {
    const gn_whole_limit *whole = gn_coupled_whole(&world->ctx, &world->zones);
    bool elements =
        whole ? whole->side == GN_SIDE_ELEMENTS
              : gn_timestep_elements_lead(&world->ctx, &world->solids, &world->zones) != NULL;
    printf("step of the coupled model\n  dt               %.6g s, set by the %s\n", world->ctx.dt,
           whole      ? gn_side_text(whole->side)
           : elements ? "elements"
                      : "particles");
}

/* Notes diagonals in the mesh of a coupling zone, which scatter its waves:
 * docs/evidence/coupling.md. */
static void note_diagonals(const gn_world *world) {
    const gn_element_def *elements = &world->ctx.scene.elements;
    const gn_diagonals diagonals =
        elements->has_beam ? elements->beam.diagonals : elements->diagonals;
    if (elements->mesh[0] || diagonals == GN_DIAGONALS_PARALLEL) return;
    printf("  note             diagonals alternate: neighbouring nodes have masses of %s, which "
           "scatter waves only some elements long (elements.%s.diagonals: parallel)\n",
           world->ctx.scene.dimension == 3 ? "5 : 1" : "2 : 1",
           elements->has_beam  ? "beam"
           : elements->has_box ? "box"
                               : "rectangle");
}

void gn_print_zones(const gn_world *world, int *warnings) {
    const size_t zones = world->ctx.scene.has_couple ? world->ctx.scene.couple.zone_count : 0;
    for (size_t k = 0; k < zones; k++) print_zone(world, k, warnings);
    if (zones > 0) note_diagonals(world);
    if (world->ctx.scene.has_couple) print_step(world);
}

/* A sentence that concerns all walls is printed once. */
static const char no_contact[] = "elements have no contact with walls and pass through them; hold "
                                 "or load elements by motions or loads of elements";

static void print_passed(const char *wall, const gn_wall_passed *passed, int *warnings) {
    char text[512];
    if (passed->behind && passed->time > 0.0)
        snprintf(text, sizeof text,
                 "wall '%.60s' goes through elements from t = %.3g s on (%zu nodes, at most %.3g m "
                 "deep): %s",
                 wall, passed->time, passed->behind, passed->deepest, no_contact);
    else if (passed->behind)
        snprintf(text, sizeof text,
                 "wall '%.60s' goes through elements from the start on (%zu nodes, at most %.3g m "
                 "deep): %s",
                 wall, passed->behind, passed->deepest, no_contact);
    else
        snprintf(text, sizeof text, "wall '%.60s' touches %zu nodes of elements: %s", wall,
                 passed->touching, no_contact);
    if (passed->behind || passed->touching) warn(warnings, text);
}

gneiss_status gn_print_walls_passed(gn_world *world, int *warnings, gneiss_error *error) {
    const size_t count = world->ctx.scene.wall_count;
    GN_FREED gn_wall_passed *passed = NULL;
    if (!world->ctx.scene.has_couple || !count) return GNEISS_OK;
    GN_TRY(gn_new(&passed, count, "walls", error));
    GN_TRY(gn_wall_predict_passed(&world->ctx, &world->solids, passed, error));
    for (size_t k = 0; k < count; k++)
        print_passed(world->ctx.scene.walls[k].name, &passed[k], warnings);
    return GNEISS_OK;
}

/* ---- contact parameters from the materials of a scene, for `gneiss check` ---- */

/* Prints the smallest, mean and largest value of a column over the bonds. */
static void print_range(const char *name, const double *column, const gn_contacts *bonds,
                        const char *unit) {
    double least = INFINITY, most = 0.0, sum = 0.0;
    size_t count = 0;
    for (size_t c = 0; column && c < bonds->soa.count; c++) {
        if (!gn_contact_bonded(bonds, c)) continue;
        count++;
        least = fmin(least, column[c]);
        most = fmax(most, column[c]);
        sum += column[c];
    }
    if (!count) return;
    printf("  %-16s %.6g to %.6g, mean %.6g %s\n", name, least, most, sum / (double)count, unit);
}

static void print_area(const gn_world *world, const gn_area_check *check) {
    bool polyhedron = world->ctx.scene.stiffness == GN_STIFFNESS_POLYHEDRON;
    int d = (int)world->ctx.scene.dimension;
    print_range("section A", world->dem.bonds.contacts.area, &world->dem.bonds.contacts,
                d == 3 ? "m2" : "m2 (1 m thick)");
    printf("  sections fill    %.4f of the body: sum(A L)/(%d V)", check->filled, d);
    if (polyhedron)
        printf(", %.4f with the free faces of %zu particles that have some",
               check->filled + check->free, check->open);
    printf("\n  gamma            %.4g%s%s", world->dem.derived.gamma,
           world->ctx.scene.gamma > 0.0                       ? " (given)"
           : world->ctx.scene.gamma_rule == GN_GAMMA_POROSITY ? " = 40 e/n_c"
                                                              : " fills it with Dempack's sections",
           polyhedron ? ", for pairs that come into contact later" : "");
    if (world->ctx.scene.gamma > 0.0 || world->ctx.scene.gamma_rule == GN_GAMMA_VOLUME)
        printf("; 40 e/n_c would be %.4g", check->dempack_gamma);
    printf("\n");
}

/* Prints Young's modulus and Poisson's ratio of the body under uniform strain, for an isotropic
 * packing whose sections fill the body; see docs/physics.md. */
static void print_body(const gn_world *world, const gn_area_check *check) {
    const gn_material *material = &world->ctx.scene.materials[0];
    double rho = material->beta / material->alpha / (2.0 * (1.0 + material->poisson)), e, nu;
    bool space = world->ctx.scene.dimension == 3;
    if (world->ctx.scene.material_count > 1) return;
    if (space) {
        e = (2.0 + 3.0 * rho) / (4.0 + rho);
        nu = (1.0 - rho) / (4.0 + rho);
    } else {
        e = 2.0 * (1.0 + rho) / (3.0 + rho);
        nu = (1.0 - rho) / (3.0 + rho);
    }
    printf("  uniform strain   E%s %.6g Pa, nu%s %.4f, of an isotropic packing filled so far\n",
           space ? "" : "'", e * material->alpha * material->young * check->filled,
           space ? "" : "'", nu);
}

/* A simple cubic lattice has 1.3, and about half more at its surface. */
static const double gamma_most = 3.0;

gneiss_status gn_print_law(const gn_world *world, int *warnings, gneiss_error *error) {
    const gn_contacts *b = &world->dem.bonds.contacts;
    size_t n = b->soa.count;
    gn_area_check check;
    if (!n) return GNEISS_OK;
    if (gn_scene_by_area(&world->ctx.scene)) {
        GN_TRY(gn_areas_check(&world->ctx, &world->dem, &check, error));
        print_area(world, &check);
        print_body(world, &check);
    }
    print_range("k_n of bonds", b->kn, b, "N/m");
    print_range("k_t", b->kt, b, "N/m");
    print_range("R_n", b->rn, b, "N");
    print_range("R_t", b->rt, b, "N");
    if (world->ctx.scene.softening == GN_SOFTENING_ENERGY)
        printf("  plane cuts       %.4f of its section in bonds: fracture energies refer to %s\n",
               gn_law_cut(&world->ctx, &world->dem),
               world->ctx.scene.fracture_energy_of == GN_FRACTURE_BODY
                   ? "the body, and those of contacts are lower by this factor"
                   : "contacts, and that of the body is higher by this factor");
    if (!gn_scene_by_area(&world->ctx.scene)) return GNEISS_OK;
    if (world->ctx.scene.gamma == 0.0 && world->dem.derived.gamma > gamma_most) {
        printf("  warning: gamma is %.3g: the volume contains more than the bonded particles (set "
               "law.gamma)\n",
               world->dem.derived.gamma);
        (*warnings)++;
    }
    if (fabs(check.filled + check.free - 1.0) <= 0.1) return GNEISS_OK;
    printf("  warning: sections fill %.3g of the body instead of 1: stiffness and strength deviate "
           "by about this factor\n",
           check.filled + check.free);
    (*warnings)++;
    return GNEISS_OK;
}

/* ---- idle effects ---- */

/* --- certain cases --- */

static bool turns(const gn_motion *motion) {
    return motion->spin[0].count || motion->spin[1].count || motion->spin[2].count;
}

static bool sets_turn(const gn_scene *scene) {
    bool any = false;
    for (size_t k = 0; k < scene->set_count; k++)
        any = any || scene->sets[k].has_initial_spin || turns(&scene->sets[k].motion);
    return any;
}

static bool held_at_rest(const gn_table *channel) {
    bool rests = channel->count > 0;
    for (size_t k = 0; k < channel->count; k++) rests = rests && channel->value[k] == 0.0;
    return rests;
}

/* True if motions hold the spins of all particles. The first set that contains a particle drives
 * it; later sets have no effect on it. */
static bool all_spins_held(const gn_scene *scene) {
    const gn_set_def *set = scene->sets;
    bool held = scene->set_count > 0 && set->all && !set->has_initial_spin;
    for (int a = scene->dimension == 3 ? 0 : 2; a < 3; a++)
        held = held && held_at_rest(&set->motion.spin[a]);
    return held && scene->set_count == 1;
}

/* Returns why rotation is idle. Only tangential forces turn a sphere. Forces on facets are
 * distributed over points beside the one below the centre of the sphere. */
static const char *idle_rotation(const gn_world *world) {
    bool tangential = world->ctx.effects & (GN_FX_SHEAR | GN_FX_WALL_SHEAR);
    if (all_spins_held(&world->ctx.scene))
        return "all spins are prescribed as 0: the same to rounding (law.rotation: off)";
    if (tangential || world->ctx.effects & GN_FX_FACETS || sets_turn(&world->ctx.scene))
        return NULL;
    return "no tangential force and no set turns anything (law.rotation: off)";
}

static const char *idle_friction(const gn_world *world) {
    const gn_particles *q = &world->dem.particles;
    if (world->ctx.effects & GN_FX_ROLLING)
        return NULL; /* moments use the storage of tangential forces */
    for (size_t p = 0; p < q->soa.count; p++)
        if (world->ctx.scene.materials[q->material[p]].friction > 0.0) return NULL;
    return "no particle has a material with friction";
}

static const char *idle_contact_damping(const gn_world *world) {
    return world->dem.damping_fraction > 0.0
               ? NULL
               : "a restitution of 1 dissipates nothing (damping.contact)";
}

static const char *idle_background(const gn_world *world) {
    return world->ctx.scene.background_coefficient > 0.0 || world->ctx.scene.background_spin > 0.0
               ? NULL
               : "its coefficient is 0 (damping.background.model: none)";
}

static const char *idle_applied(const gn_world *world) {
    if (world->ctx.effects & GN_FX_MEMBRANE) return NULL;
    for (size_t k = 0; k < world->ctx.scene.set_count; k++)
        for (int a = 0; world->ctx.scene.sets[k].has_force && a < 3; a++)
            if (world->ctx.scene.sets[k].force[a] != 0.0) return NULL;
    return "all forces of sets are 0 (sets[].force)";
}

static const char *idle_mass_scaling(const gn_world *world) {
    return world->dem.raised.count ? NULL : "no mass has to be raised (time.mass_scaling)";
}

/* Returns why sums of energy are idle: only output reads them. */
static const char *idle_energy(const gn_world *world) {
    (void)world;
    return "read only by output and its warning, no motion depends on it (output.energy: off)";
}
static const char *idle_orientation(const gn_world *world) {
    (void)world;
    return "read only by output, no motion depends on it (output.orientation: off)";
}

/* --- words --- */

static const struct {
    gn_effect effect;
    gn_effect_index index;
    const char *(*idle)(const gn_world *world); /* returns the reason why the effect is idle; NULL:
                                                   it is not idle */
} idle_effects[] = {
#define IDLE(NAME, find)                                                                           \
    { GN_FX_##NAME, GN_FX_INDEX_##NAME, find }
    IDLE(ROTATION, idle_rotation),
    IDLE(FRICTION, idle_friction),
    IDLE(CONTACT_DAMPING, idle_contact_damping),
    IDLE(VISCOUS, idle_background),
    IDLE(NONVISCOUS_VECTOR, idle_background),
    IDLE(NONVISCOUS_COMPONENT, idle_background),
    IDLE(APPLIED, idle_applied),
    IDLE(MASS_SCALING, idle_mass_scaling),
    IDLE(ENERGY, idle_energy),
    IDLE(ORIENTATION, idle_orientation),
#undef IDLE
};

void gn_print_idle(const gn_world *world) {
    bool any = false;
    for (size_t k = 0; k < sizeof idle_effects / sizeof *idle_effects; k++) {
        bool active = world->ctx.effects & idle_effects[k].effect;
        const char *why = active ? idle_effects[k].idle(world) : NULL;
        if (!why) continue;
        if (!any) printf("could be switched off\n");
        printf("  %-24s %s\n", gn_effect_name(idle_effects[k].index), why);
        any = true;
    }
}

void gn_print_joint_check(const gn_world *world, int *warnings) {
    const gn_step_context *ctx = &world->ctx;
    char text[GNEISS_MESSAGE_SIZE] = "";
    for (size_t k = 0; k < ctx->scene.joint_count; k++) {
        const gn_joint_start start = gn_joint_at_start(&world->dem, k);
        printf("  joint            '%.60s': %.0f contacts, area %.4g m2 of %.4g m2 wanted\n",
               ctx->scene.joints[k].name, start.contacts, start.reached, start.wanted);
    }
    if (gn_joints_are_close(ctx, &world->dem, text, sizeof text)) {
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
    if (gn_joints_lack_area(ctx, &world->dem, text, sizeof text)) {
        printf("  warning: %s\n", text);
        (*warnings)++;
    }
}
